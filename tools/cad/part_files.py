"""Which files hold CAD parts."""

from __future__ import annotations

import zipfile
from pathlib import Path

from ...runtime.base.advice import CAD_SUFFIXES
from ..files.numpy_files import array_file
from .inspection import HEAD, format_of

__all__ = ["is_part_file"]

# Among the names of the arrays of a part.
NAMES = {"about.npy", "face_loops.npy"}


def is_part_file(source: str | None) -> bool:
    """Say whether a text names a file that holds a part, by its suffix, beginning or arrays.

    `read_cad` goes by the content of files, and takes any suffix.
    """
    if source is None:
        return False
    suffix = Path(source).suffix.lower()
    if suffix in CAD_SUFFIXES:
        return True
    try:
        if suffix != ".npz":
            if not Path(source).is_file():
                return False
            with open(source, "rb") as file:
                return format_of(file.read(HEAD)) is not None
        with zipfile.ZipFile(array_file(source)) as archive:
            return set(archive.namelist()) >= NAMES
    except (OSError, ValueError, zipfile.BadZipFile):
        return False
