"""Which files hold CAD parts."""

from __future__ import annotations

import zipfile
from pathlib import Path

from ...runtime.base.advice import CAD_SUFFIXES
from ..files.arrays import array_file

__all__ = ["is_part_file"]

# Among the names of the arrays of a part.
NAMES = {"about.npy", "face_loops.npy"}


def is_part_file(source: str | None) -> bool:
    """Say whether a text names a file that holds a part, by its suffix or its arrays."""
    if source is None:
        return False
    suffix = Path(source).suffix.lower()
    if suffix != ".npz":
        return suffix in CAD_SUFFIXES
    try:
        with zipfile.ZipFile(array_file(source)) as archive:
            return set(archive.namelist()) >= NAMES
    except (OSError, zipfile.BadZipFile):
        return False
