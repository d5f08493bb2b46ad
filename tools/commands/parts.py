"""CAD parts in files: STEP, IGES and BREP, and those that gaussmap saved."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace

from ...runtime.base.advice import CAD_SUFFIXES
from ...runtime.base.errors import InputError
from ..cad.part import Part, read_part
from ..cad.part_files import is_part_file

__all__ = ["LIMITS", "read_part_file", "refuse"]

# The options of `read_cad`.
LIMITS = ("unit", "time_limit", "memory_limit")


def read_part_file(source: str, options: SimpleNamespace) -> Part:
    """Read a part. Raises what `read_cad` and `read_part` raise, InputError for other files."""
    limits = {name: getattr(options, name) for name in LIMITS}
    given = {name: value for name, value in limits.items() if value is not None}
    if Path(source).suffix.lower() == ".npz":
        refuse(given, "is for STEP, IGES and BREP files", source)
        return read_part(source)
    if not is_part_file(source):
        raise InputError(
            f"'{source}' is no CAD part by its suffix; use one of {', '.join(CAD_SUFFIXES)}, or an "
            ".npz file of part.save."
        )
    from ..cad.reader import read_cad

    return read_cad(source, **given, progress=not getattr(options, "quiet", False))


def refuse(given: Iterable[str], purpose: str, source: str) -> None:
    """Raise InputError for the first of the options that were given, and are not for a source."""
    for name in given:
        raise InputError(f"--{name.replace('_', '-')} {purpose}, and '{source}' is none.")
