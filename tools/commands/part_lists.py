"""The parts that a command names: surfaces, files, folders, patterns, and lists of these."""

import glob
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from ...runtime.base.advice import CAD_SUFFIXES, RASTER_SUFFIXES
from ...runtime.base.errors import FileError, InputError
from ...runtime.surface.surfaces import CATALOGUE
from ..files.paths import reason_of

# The suffixes of the files that are taken from folders.
SUFFIXES = (*CAD_SUFFIXES, ".npz", ".npy", *RASTER_SUFFIXES)


def listed(named: Iterable[str], list_file: str | None) -> list[str]:
    """Return the names of parts in `named` and in the lines of a file; "-" is standard input.

    A folder stands for the files of known suffixes in the folder and its subfolders, a pattern for
    all files that match it, in the order of their names.

    Raises InputError for a folder or a pattern without files, FileError if a list cannot be read.
    """
    return [part for text in [*named, *_lines(list_file)] for part in _expanded(text)]


def _lines(list_file: str | None) -> Iterator[str]:
    """Yield the lines of a list that are neither empty nor comments."""
    if list_file is None:
        return
    try:
        text = sys.stdin.read() if list_file == "-" else Path(list_file).read_text("utf-8")
    except OSError as error:
        raise FileError(f"'{list_file}' cannot be read: {reason_of(error)}.") from error
    except ValueError as error:
        raise FileError(f"'{list_file}' is no list: it is not a text in UTF-8.") from error
    for line in text.splitlines():
        if (part := line.strip()) and not part.startswith("#"):
            yield part


def _expanded(text: str) -> list[str]:
    if text in CATALOGUE:
        return [text]
    path = Path(text)
    if path.is_dir():
        files = (x for x in path.rglob("*") if x.suffix.lower() in SUFFIXES and x.is_file())
        found = sorted(str(x) for x in files)
        if not found:
            raise InputError(f"'{text}' has no files of parts: {', '.join(SUFFIXES)}.")
        return found
    if glob.has_magic(text) and not path.exists():
        found = sorted(glob.glob(text, recursive=True))
        if not found:
            raise InputError(f"'{text}' matches no files.")
        return found
    return [text]
