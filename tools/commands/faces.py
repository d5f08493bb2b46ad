"""The command `gaussmap faces`."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from ...runtime.base.errors import printable
from ...runtime.base.wording import plural
from ..cad.part import Face, Part
from ..sources.named import Named
from ..sources.parts import read_part_file
from .console import say


def run(options: SimpleNamespace) -> None:
    """Print a line for each face of a part, or the properties of all faces as a JSON object."""
    part = read_part_file(replace(Named.of(options), surface=options.part))
    if options.json:
        say(json.dumps(_as_json(part)))
        return
    kinds = max([len(x.kind) for x in part.faces], default=0)
    digits = len(str(part.faces[-1].source_index)) if len(part) else 1
    for face in part.faces:
        say(_line(face, digits, kinds))


def _line(face: Face, digits: int, kinds: int) -> str:
    loops = plural(len(face.loops), "loop")
    name = f"  {face.name}" if face.name else ""
    failed = f"  failed: {face.reason}" if face.reason else ""
    known = f"{face.source_index:{digits}}  {face.kind:{kinds}}  {face.area:12.6g}  {loops:8}"
    return printable(f"{known}{name}{failed}".rstrip())


def _as_json(part: Part) -> dict[str, Any]:
    faces = [_face(part, x) for x in part.faces]
    return {"part": part.name, "unit": part.unit, "metres": part.metres, "faces": faces}


def _face(part: Part, face: Face) -> dict[str, Any]:
    dimensions = {
        name: value.tolist() if isinstance(value, np.ndarray) else value
        for name, value in face.dimensions.items()
    }
    return {
        "index": face.source_index,
        "kind": face.kind,
        "name": face.name,
        "color": face.color,
        "area": face.area if math.isfinite(face.area) else None,
        "solid": part.solids[face.solid_index].name if face.solid_index >= 0 else None,
        "reason": face.reason,
        **dimensions,
    }
