"""What is known of a part, a face and an edge: numbers and arrays, before they are packed.

The process that reads CAD files imports this module and `layout`: nothing here needs Numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["KINDS", "EdgeRecord", "FaceRecord", "Geometry", "Net", "PartRecord"]

Array = NDArray[np.float64]

# The kinds of faces, with the lengths of their numbers (see `saving`). Append only: files hold
# places in this list. The last is that of failed faces whose kind is not known.
KINDS: dict[str, int] = {
    "plane": 12,
    "cylinder": 13,
    "cone": 14,
    "sphere": 13,
    "torus": 14,
    "nurbs": 0,
    "revolution": 6,
    "extrusion": 3,
    "offset": 1,
    "unknown": 0,
}


@dataclass(frozen=True, eq=False)
class Net:
    """A NURBS surface, or a NURBS curve, whose degrees, knots and shape have one entry.

    Control points are (m, n, 3) or (m, 3), not multiplied by their weights (m, n) or (m,), which
    are None where all are 1.
    """

    degrees: tuple[int, ...]
    knots: tuple[Array, ...]
    points: Array
    weights: Array | None = None


@dataclass(frozen=True, eq=False)
class Geometry:
    """A surface without its trim: its kind and what that needs.

    `net` is the NURBS, or the curve of a revolution or an extrusion; `basis` is the surface that an
    offset has its distance from.
    """

    kind: str
    numbers: Array = field(default_factory=lambda: np.empty(0))
    net: Net | None = None
    basis: Geometry | None = None


@dataclass(frozen=True, eq=False)
class FaceRecord:
    """A face; `reason` says why it failed, and is empty if it did not.

    `domain` is ((u0, u1), (v0, v1)), the bounds of the loops; `periods` are those of the surface in
    u and v, 0 where it has none. `loops` are closed polygons (k, 2), the first point not repeated.
    """

    geometry: Geometry
    domain: Sequence[Sequence[float]] = ((0.0, 0.0), (0.0, 0.0))
    periods: Sequence[float] = (0.0, 0.0)
    loops: Sequence[Array] = ()
    reversed: bool = False
    area: float = 0.0
    name: str = ""
    color: Sequence[float] | None = None
    solid_index: int = -1
    reason: str = ""


@dataclass(frozen=True, eq=False)
class EdgeRecord:
    """An edge between two faces: parameters (k, 4) along it, u and v on each of them."""

    faces: tuple[int, int]
    parameters: Array


@dataclass(frozen=True, eq=False)
class PartRecord:
    """A part; `metres` is the length of its unit, `oriented` whether all normals point outward.

    `source_indices` are the places of the faces in the part that they were selected from.
    """

    name: str
    unit: str
    metres: float
    oriented: bool
    faces: Sequence[FaceRecord]
    solid_names: Sequence[str] = ()
    edges: Sequence[EdgeRecord] = ()
    warnings: Sequence[str] = ()
    source_indices: Sequence[int] = ()
