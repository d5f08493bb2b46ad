"""Compare the list of signatures with the kernels compiled here, or rewrite it.

    python -m gaussmap.runtime.machine_code.listing [--write | --usual] [FOLDER]

Kernels that the package's file lacks are compiled when they are called, and cached in FOLDER (by
default the cache of this machine), so that after a run of all tests, FOLDER contains the kernels
that the list lacks. They are printed, and the exit code is 1 if there are any. With --write, the
kernels in FOLDER become the list; with --usual, they become the list of kernels that usual calls
need.
"""

import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import signatures
from .disk import entries_in, kept_folder
from .entries import signature_in

PACKAGE = signatures.__name__.partition(".")[0]  # this module may be __main__


def compiled_in(folder: Path) -> dict[str, list[Any]]:
    """Return the signatures of this package's kernels in a folder, by the kernel's name."""
    found: dict[str, list[Any]] = defaultdict(list)
    for entry in entries_in(folder):
        name, kinds = signature_in(entry) or ("", [])
        if _is_named(name) and kinds not in found[name]:
            found[name].append(kinds)
    return {name: kinds for name, kinds in found.items() if kinds}


def _is_named(name: str) -> bool:
    """Return whether a name is that of a kernel of this package, not of a test or a user."""
    if not name.startswith(f"{PACKAGE}."):
        return False
    try:
        return signatures.named(name) is not None
    except (ImportError, AttributeError):
        return False


def missing(folder: Path) -> list[str]:
    """Return the kernels, with types of arguments, that are in a folder and not in the list."""
    listed = signatures.read()
    found = compiled_in(folder).items()
    return [f"{name}{x}" for name, kinds in found for x in kinds if x not in listed.get(name, ())]


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    names = [x for x in arguments if not x.startswith("--")]
    folder = Path(names[0]) if names else kept_folder()
    if folder is None:
        return 0  # nothing can be cached
    if "--write" in arguments:
        signatures.write(compiled_in(folder))
        return 0
    if "--usual" in arguments:
        signatures.write_usual(compiled_in(folder))
        return 0
    lacking = missing(folder)
    for each in lacking:
        print(f"{signatures.SIGNATURES.name} lacks {each}: make kernels", file=sys.stderr)
    return 1 if lacking else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
