"""A part, a face and an edge as numbers and arrays, before they are packed.

The process that reads CAD files imports this module: nothing here needs Numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ...runtime.surface.surface import Surface

Array = NDArray[np.float64]
# The edges along a loop, in order: (edge, index among its sides, whether traversed backwards).
Wire = list[tuple[int, int, bool]]

# The reason of failure for faces without area. Volumes and meshes do not need these faces.
NO_AREA = "its area is zero"


class Kind(NamedTuple):
    """A kind of face: how many numbers it has (see `saving`), and which of them are lengths.

    `u` and `v` say whether these parameters are lengths, angles, or neither.
    """

    numbers: int
    lengths: tuple[int, ...] = ()
    u: str = ""
    v: str = ""


# The kinds of faces. Append only, since files store indices into this list. "unknown" is for failed
# faces of unknown kind, "surface" for faces that have a `Surface` in memory, which files cannot
# hold. The parameters of an offset are those of its basis.
KINDS = {
    "plane": Kind(12, (0, 1, 2), "length", "length"),
    "cylinder": Kind(13, (0, 1, 2, 12), "angle", "length"),
    "cone": Kind(14, (0, 1, 2, 12), "angle", "length"),
    "sphere": Kind(13, (0, 1, 2, 12), "angle", "angle"),
    "torus": Kind(14, (0, 1, 2, 12, 13), "angle", "angle"),
    "nurbs": Kind(0),
    "revolution": Kind(6, (0, 1, 2), "angle"),
    "extrusion": Kind(3, v="length"),
    "offset": Kind(1, (0,)),
    "unknown": Kind(0),
    "surface": Kind(0),
}


@dataclass(frozen=True, eq=False)
class Net:
    """A NURBS surface or curve; for a curve, `degrees` and `knots` have one entry.

    The control points `points` (m, n, 3) or (m, 3) are not multiplied by the `weights` (m, n) or
    (m,). `weights` is None if all weights are 1.
    """

    degrees: tuple[int, ...]
    knots: tuple[Array, ...]
    points: Array
    weights: Array | None = None


@dataclass(frozen=True, eq=False)
class Geometry:
    """A surface without its trim: its kind and the data of that kind.

    `net` is the NURBS, or the curve of a revolution or an extrusion; `basis` is the surface of
    which an offset is taken. A face of the kind "surface" has a `surface` instead of numbers.
    """

    kind: str
    numbers: Array = field(default_factory=lambda: np.empty(0))
    net: Net | None = None
    basis: Geometry | None = None
    surface: Surface | None = None


@dataclass(frozen=True, eq=False)
class FaceRecord:
    """A face; `reason` says why it failed, and is empty if it did not.

    `domain` is ((u0, u1), (v0, v1)), the bounding box of the loops; `periods` are the periods of
    the surface in u and v, 0 where not periodic. `loops` are closed polygons (k, 2), the first
    point not repeated. `wires` are the edges along each loop, in order: (edge, index among its
    sides, whether traversed from its end to its beginning). The face lies to the left of a wire,
    seen from where x_u × x_v points.
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
    wires: Sequence[Wire] = ()


@dataclass(frozen=True, eq=False)
class EdgeRecord:
    """An edge: its parameters on the adjacent faces, and its end vertices.

    `faces` are the indices of the faces on its m sides: usually two, one at a boundary, and the
    same face twice at a seam. `parameters` (k, 2 m) are u and v on each of these faces, at equal
    steps of a parameter of the edge from 0 to 1, NaN where unknown. `slopes` (k, 2 m) are the
    derivatives of u and v by that parameter, by default finite differences. `vertices` are the
    indices of the first and the last vertex of the edge; −1 if unknown. An edge that is collapsed
    to a point, as at a pole, is `degenerate`.
    """

    faces: tuple[int, ...]
    parameters: Array
    slopes: Array | None = None
    vertices: tuple[int, int] = (-1, -1)
    degenerate: bool = False


@dataclass(frozen=True, eq=False)
class PartRecord:
    """A part; `metres` is the length of its unit, `oriented` whether all normals point outward.

    `vertices` (V, 3) are the points at the ends of edges. `source_indices` are the indices that
    selected faces had in the part that was read or made.
    """

    name: str
    unit: str
    metres: float
    oriented: bool
    faces: Sequence[FaceRecord]
    solid_names: Sequence[str] = ()
    edges: Sequence[EdgeRecord] = ()
    vertices: Array = field(default_factory=lambda: np.empty((0, 3)))
    warnings: Sequence[str] = ()
    source_indices: Sequence[int] = ()
