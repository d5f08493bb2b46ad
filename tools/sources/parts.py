"""CAD parts in files: STEP, IGES and BREP, and those that gaussmap saved."""

from __future__ import annotations

from pathlib import Path

from ...runtime.base.advice import CAD_SUFFIXES
from ...runtime.base.errors import InputError
from ..cad.inspection import is_part_file
from ..cad.part import Part, read_part
from .named import Named

__all__ = ["LIMITS", "read_part_file"]

# The options of `read_cad`.
LIMITS = ("unit", "time_limit", "memory_limit")


def read_part_file(named: Named) -> Part:
    """Read a part. Raises the errors of `read_cad` and `read_part`, InputError for other files."""
    source = named.surface or ""
    if Path(source).suffix.lower() == ".npz":
        named.refuse(LIMITS, "is for STEP, IGES and BREP files, and {} is none.")
        return read_part(source)
    if not is_part_file(source):
        raise InputError(
            f"'{source}' is no STEP, IGES or BREP file ({', '.join(CAD_SUFFIXES)}), and no .npz "
            "file of a part that gaussmap saved."
        )
    from ..cad.reader import read_cad

    given = {name: value for name, value in named.given().items() if name in LIMITS}
    return read_cad(source, **given, progress=not named.quiet)
