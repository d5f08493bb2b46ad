"""Columns in tables of samples that describe the face of each sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...runtime.samples.whole import FaceColumn

if TYPE_CHECKING:
    from .part import Part


def face_columns(part: Part) -> list[FaceColumn]:
    """Return the face number in the file, the name, the kind and the radius of all faces.

    Only cylinders, spheres and tori have a radius; for a torus, it is the minor radius.
    """
    sizes = (x.dimensions for x in part.faces)
    radii = [x.get("radius", x.get("minor_radius")) for x in sizes]
    return [
        FaceColumn("source_index", int, [x.source_index for x in part.faces]),
        FaceColumn("face_name", str, [x.name for x in part.faces]),
        FaceColumn("face_kind", str, [x.kind for x in part.faces]),
        FaceColumn("face_radius", float, radii, "L"),
    ]
