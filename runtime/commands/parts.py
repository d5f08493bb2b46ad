"""CAD parts in files: STEP, IGES and BREP, and those that gaussmap saved."""

from __future__ import annotations

import zipfile
from pathlib import Path

from ..cad.part import Part, read_part
from ..errors import InputError
from ..extras import check_extra
from .arrays import array_file

__all__ = ["CAD_SUFFIXES", "is_part_file", "read_part_file"]

CAD_SUFFIXES = (".step", ".stp", ".iges", ".igs", ".brep", ".brp")
# Among the names of the arrays of a part.
NAMES = {"about.npy", "face_loops.npy"}


def is_part_file(source: str) -> bool:
    """Say whether a text names a file that holds a part, by its suffix or its arrays."""
    suffix = Path(source).suffix.lower()
    if suffix != ".npz":
        return suffix in CAD_SUFFIXES
    try:
        with zipfile.ZipFile(array_file(source)) as archive:
            return set(archive.namelist()) >= NAMES
    except (OSError, zipfile.BadZipFile):
        return False


def read_part_file(source: str) -> Part:
    """Read a part. Raises what `read_cad` and `read_part` raise, InputError for other files."""
    if Path(source).suffix.lower() == ".npz":
        return read_part(source)
    if not is_part_file(source):
        raise InputError(
            f"'{source}' is no CAD part by its suffix; use one of {', '.join(CAD_SUFFIXES)}, or an "
            ".npz file of part.save."
        )
    check_extra("OCP", "cad", "reading CAD files")
    from ..cad.reader import read_cad

    return read_cad(source)
