"""The process that reads a CAD file: `python -m gaussmap.tools.cad.worker`.

It imports Open CASCADE and NumPy, and never Numba. Its standard output is discarded, since readers
print to it; the results are files in the given folder: `part.npz`, or `error.txt` with a sentence
that continues "'path' …".
"""

import json
import os
import sys
from pathlib import Path

from ..files.processes import end_with_parent, limit

PART, ERROR = "part.npz", "error.txt"


def main(text: str) -> None:
    """Read a file into a part; the request is a JSON object with the file and the limits."""
    request = json.loads(text)
    folder = Path(request["folder"])
    end_with_parent("SIGTERM")
    # A limit of processor time, in case the parent process has ended.
    limit(RLIMIT_AS=int(request["memory"]), RLIMIT_CPU=int(request["seconds"]) + 5)
    try:
        message = _read(request, folder)
    except MemoryError:
        message = "needs more memory than memory_limit; raise it."
    if message:
        (folder / ERROR).write_text(message, encoding="utf-8")


def _read(request: dict[str, str], folder: Path) -> str:
    """Write the part; return the reason if it cannot be read, else ""."""
    from ..files.reading import UnusableError
    from .source import prepared

    try:  # before Open CASCADE is loaded, which takes a second
        source = prepared(Path(request["path"]), folder)
    except UnusableError as error:
        return str(error)
    except OSError as error:
        return f"cannot be read: {error.strerror or type(error).__name__}."
    try:
        from .opencascade.parts import part_record
    except ImportError as error:
        return f"cannot be read: Open CASCADE does not load ({error})."
    from .part_arrays import packed
    from .saving import write_arrays

    try:
        record = part_record(source, request["name"], request["unit"])
        write_arrays(packed(record), folder / PART)
    except UnusableError as error:
        return str(error)
    except MemoryError:
        raise
    except Exception as error:  # raised by Open CASCADE
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:200].rstrip(".")
        return f"cannot be read: Open CASCADE fails on it ({reason})."
    return ""


if __name__ == "__main__":
    main(sys.argv[1])
    os._exit(0)  # everything is written, and unloading Open CASCADE takes a third of a second
