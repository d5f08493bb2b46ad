"""`read_cad`: parts from STEP, IGES and BREP files, read by a separate process.

Open CASCADE hangs on some files and crashes on others; its process is killed after a time limit.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

from ...runtime.base.checks import positive_number
from ...runtime.base.errors import FileError, GaussmapWarning, InputError
from ...runtime.base.extras import check_extra
from ...runtime.base.memory import GIB
from ...runtime.base.progress import busy
from ..files.lengths import checked_unit
from ..files.paths import PathLike, checked_path, reason_of
from ..files.reading import UnusableError, regular_file
from .part import Part, read_part
from .worker import ERROR, PART

# The least memory limit, in GiB; Open CASCADE itself takes about a quarter of it.
LEAST_MEMORY = 1.0
MOST_SECONDS = 1e6
# The largest number of failed faces that a warning names.
MOST_NAMED = 3
MODULE = "gaussmap.tools.cad.worker"


def read_cad(
    path: PathLike,
    unit: str | None = None,
    time_limit: float = 120.0,
    memory_limit: float = 4.0,
    *,
    progress: bool = False,
) -> Part:
    """Read a part from a STEP, IGES or BREP file.

    Open CASCADE reads it, in a separate process. `Part.save` stores the result, so that each file
    is read only once. Faces of solids, faces of shells and loose faces are read, with their
    placements in assemblies. Loose faces are sewn; normals of faces that enclose a solid point out
    of it. A face that cannot be used is listed in `failed`, and the other faces are read.

    Parameters
    ----------
    path : str or os.PathLike
        Name of the file. Its content, not its suffix, decides which format it has.
    unit : str, optional
        The unit L of all lengths of the part: "mm", "cm", "m", "in", "ft", … By default that of the
        file. BREP files state none, and are in mm.
    time_limit : float
        The time limit for reading, in seconds.
    memory_limit : float
        The memory limit for reading, in GiB.
    progress : bool, default False
        Show the progress on a terminal, after the first second.

    Returns
    -------
    Part
        The part.

    Raises
    ------
    FileError
        If the file is missing, empty, truncated, damaged, or of another format, has no faces, or
        cannot be read within the limits.
    InputError
        For an unknown unit and limits that are not positive.
    MissingExtraError
        If Open CASCADE is not installed; the extra `cad` installs it.

    Warns
    -----
    GaussmapWarning
        If faces cannot be used, and if the unit of lengths is not known from the file.

    See Also
    --------
    read_part : read a part that was saved.

    Examples
    --------
    >>> import gaussmap as gm
    >>> part = gm.read_cad("crank.step", unit="mm")  # doctest: +SKIP
    >>> part.faces[0].kind, part.unit, part.oriented  # doctest: +SKIP
    ('plane', 'mm', True)

    """
    path = checked_path(path)
    unit = None if unit is None else checked_unit(unit)
    seconds = positive_number(time_limit, "time_limit", "seconds", MOST_SECONDS)
    gib = positive_number(memory_limit, "memory_limit", "GiB", MOST_SECONDS)
    if gib < LEAST_MEMORY:
        raise InputError(f"memory_limit must be at least {LEAST_MEMORY:g} GiB, not {gib:g}.")
    _check_file(path)
    check_extra("OCP", "cad", "reading CAD files")
    with tempfile.TemporaryDirectory(prefix="gaussmap-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        request = {
            "path": str(_plain(path.absolute(), folder)),
            "name": path.name,
            "folder": name,
            "unit": unit,
            "memory": gib * GIB,
            "seconds": seconds,
        }
        with busy(f"reading {path.name}", progress):
            end = _run(request, seconds)
        with suppress(FileNotFoundError):
            raise FileError(f"'{path}' {(folder / ERROR).read_text(encoding='utf-8')}")
        if not (folder / PART).exists():
            raise FileError(f"'{path}' {_why(end, seconds, gib)}")
        part = read_part(folder / PART)
    _warn(part)
    return part


def _check_file(path: Path) -> None:
    try:
        with regular_file(path):
            pass
    except UnusableError as error:
        raise FileError(f"'{path}' {error}") from error
    except IsADirectoryError:
        raise FileError(f"'{path}' is a folder.") from None
    except FileNotFoundError:
        raise FileError(f"'{path}' does not exist.") from None
    except (OSError, ValueError) as error:
        reason = reason_of(error) if isinstance(error, OSError) else str(error)
        raise FileError(f"'{path}' cannot be read: {reason}.") from error


def _plain(path: Path, folder: Path) -> Path:
    """Return a path to the same file with a name that Open CASCADE can read: valid UTF-8."""
    try:
        str(path).encode("utf-8")
    except UnicodeEncodeError:
        link = folder / "file"
        link.symlink_to(path)
        return link
    return path


# --- the process ----------------------------------------------------------------------------------


def _run(request: dict[str, object], seconds: float) -> int | None:
    """Run the process; return its exit code, or None if it reached the time limit."""
    try:
        process = subprocess.Popen(
            command_of_reader(request),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env=_environment(),
        )
    except OSError as error:
        raise FileError(
            f"the process that reads CAD files does not start: {reason_of(error)}."
        ) from error
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        return None
    finally:
        _end(process)


def command_of_reader(request: dict[str, object]) -> list[str]:
    """Return the command that starts the process which reads a part."""
    return [sys.executable, "-P", "-m", MODULE, json.dumps(request)]


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a process and all its child processes, and wait until it has ended."""
    if process.poll() is None:
        with suppress(OSError, AttributeError):
            os.killpg(process.pid, signal.SIGKILL)
        process.kill()
    process.wait()


def _environment() -> dict[str, str]:
    """Return an environment with the same module path; OpenBLAS and OpenMP get one thread each.

    Further threads would need memory.
    """
    paths = [os.path.abspath(x) for x in sys.path if isinstance(x, str)]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(paths),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }


def _why(end: int | None, seconds: float, gib: float) -> str:
    """Return the reason why a process wrote no result."""
    if end is None:
        return (
            f"was not read within {seconds:g} s: Open CASCADE may hang on it, or needs more time; "
            "raise time_limit, or export the file again."
        )
    signals = (name for name in signal.Signals if name == -end)
    name = next((x.name for x in signals), f"exit code {end}")
    return (
        f"made Open CASCADE crash ({name}); export the file again, or raise memory_limit, which "
        f"is {gib:g} GiB."
    )


def _warn(part: Part) -> None:
    for text in part.warnings:
        warnings.warn(f"{part.name}: {text}", GaussmapWarning, stacklevel=3)
    failed = part.failed
    if failed:
        named = [f"face {x.index} ({x.name}): {x.reason}" if x.name else f"face {x.index}: "
                 f"{x.reason}" for x in failed[:MOST_NAMED]]  # fmt: skip
        if len(failed) > MOST_NAMED:
            named.append(f"and {len(failed) - MOST_NAMED} more")
        warnings.warn(
            f"{len(failed)} of {len(part)} faces of '{part.name}' cannot be used: "
            f"{'; '.join(named)}.",
            GaussmapWarning,
            stacklevel=3,
        )
