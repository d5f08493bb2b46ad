"""`gaussmap faces`."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

from ...runtime.base.wording import plural
from ..cad.part import Face
from ..sources.named import Named
from ..sources.parts import read_part_file
from .console import say

__all__ = ["run"]


def run(options: SimpleNamespace) -> None:
    """Print a line for each face of a part."""
    part = read_part_file(replace(Named.of(options), surface=options.part))
    kinds = max([len(x.kind) for x in part.faces], default=0)
    digits = len(str(len(part)))
    for face in part.faces:
        say(_line(face, digits, kinds))


def _line(face: Face, digits: int, kinds: int) -> str:
    loops = plural(len(face.loops), "loop")
    name = f"  {face.name}" if face.name else ""
    failed = f"  failed: {face.reason}" if face.reason else ""
    known = f"{face.index:{digits}}  {face.kind:{kinds}}  {face.area:12.6g}  {loops:8}"
    return f"{known}{name}{failed}".rstrip()
