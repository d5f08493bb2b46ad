"""The spacing of vertices in a mesh of a part, and the planes in which faces are triangulated.

For well-shaped triangles, the vertices follow the target density of the space, proportional to the
curvature κ = max(|κ₁|, |κ₂|). For triangles close to the normals of the part, each parameter of a
face is replaced by the angle through which the normal turns along it, and vertices are evenly
spaced in the plane of these two angles. Rulings, and the interior of planes, then need no vertices.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.surface.derivatives import normals_of_jets
from ..density.kernels.sizing import TargetDensity
from ..density.space import Space
from .edge_sampling import step_of
from .face_pieces import FacePiece
from .results import PartSpace

# Normals are compared at this number of values of each parameter, and at all knots.
PLACES = 33
# An angle in radians. A face counts as ruled if its normals turn by less than this along u or along
# v. A straight edge that is as long as the part counts as a turn of normals by this angle.
RULED = 1e-6
# Between two values of a parameter, the normal counts as turning by at least LEAST times the larger
# one of the total angles along u and along v, times the difference of the values relative to the
# domain.
LEAST = 1e-3
# The weight of the turning angle of an edge, relative to the angles of normals.
CURVED = 0.5
# The largest step in the plane of a face, relative to the mean step of all faces.
LONGEST = 3.0
# The planes of faces are parallel to one another, at this distance; lengths in them are radians.
APART = 100.0


@dataclass(frozen=True, eq=False)
class Spacing:
    """Spacing of `count` vertices by the target density of a space.

    Faces are triangulated in the plane of their parameters, scaled by mean lengths of x_u and x_v.
    """

    space: PartSpace
    count: int
    # Whether triangles are to be well shaped, rather than close to the normals.
    by_shape: ClassVar[bool] = True
    # The density is κ^(2 · exponent). A triangle of size h is κ h²/8 from the surface; this is
    # constant if 1/h² is proportional to κ.
    exponent: ClassVar[float] = 0.5

    @cached_property
    def covered(self) -> tuple[Space, Indices]:
        """The space to cover with vertices, and the indices of its pieces in the part's space."""
        return self.space, np.arange(len(self.space.pieces))

    @property
    def smallest_step(self) -> float:
        """The smallest step along edges."""
        return step_of(self.space, self.count)

    def inside(self, step: float, around: Indices) -> float:
        """Return the number of vertices to reserve for the interior of faces, spaced by `step`.

        `around` (P,) are the numbers of steps on the boundaries of the pieces.
        """
        return 0.0

    def costs(self, pieces: Indices, uv: Array) -> Array:
        """Return the lengths (S, n − 1) between consecutive positions (S, n, 2) on sides of edges.

        They are relative to the sizing function 1/√w, with the target density w. `pieces` (S,) are
        the indices of the pieces that the sides bound.
        """
        owner = np.repeat(pieces, uv.shape[1])
        rows = self.space.at(owner, uv.reshape(-1, 2), keep=True).rows
        rows = rows.reshape(*uv.shape[:2], 8)
        rates = np.sqrt(rows[..., 6])
        lengths = np.linalg.norm(np.diff(rows[..., :3], axis=1), axis=2)
        return np.maximum(rates[:, 1:], rates[:, :-1]) * lengths

    def plane(self, piece: int, uv: Array, tangents: Array) -> Array:
        """Return planar coordinates (k, 2) of parameters on a piece.

        `tangents` (k, 2, 3) are x_u and x_v.
        """
        lengths = np.sqrt((tangents**2).sum(axis=2).mean(axis=0))
        return uv * np.where(lengths > 0.0, lengths, 1.0)


class ByNormals(Spacing):
    """Spacing by the angles through which the normal of a face turns along u and along v."""

    by_shape: ClassVar[bool] = False
    exponent: ClassVar[float] = 1.0

    @cached_property
    def pieces(self) -> list[TurnedPiece]:
        """The planes of all pieces, in units of their steps; they do not overlap."""
        planes = [TurnedPiece.of_piece(x, k) for k, x in enumerate(self.space.pieces)]
        steps = _best_steps(planes, self.space.areas, self.count).tolist()
        return [x.in_steps(y) for x, y in zip(planes, steps, strict=True)]

    @cached_property
    def covered(self) -> tuple[Space, Indices]:
        """The space of the planes of faces that are not ruled, and the indices of these pieces."""
        numbers = [k for k, x in enumerate(self.pieces) if not x.is_ruled]
        pieces = tuple(self.pieces[k] for k in numbers)
        space = Space(self.space.label, pieces, TargetDensity(floor=1.0), self.space.threads)
        return space, np.array(numbers, dtype=np.int64)

    @property
    def smallest_step(self) -> float:
        """The smallest step along edges is 0: all vertices may be on edges."""
        return 0.0

    def inside(self, step: float, around: Indices) -> float:
        """Return the number of interior vertices: area over step², less half the boundary steps."""
        space, numbers = self.covered
        if not len(numbers):
            return 0.0
        samples = (step_of(space, 1) / (space.unit * step)) ** 2
        return max(samples - around[numbers].sum() / 2.0, 0.0)

    def costs(self, pieces: Indices, uv: Array) -> Array:
        """Return distances (S, n − 1) between consecutive positions (S, n, 2), in steps.

        A distance is the angle by which the normal turns or, if this is larger, `CURVED` times the
        angle by which the edge turns.
        """
        owner = np.repeat(pieces, uv.shape[1])
        points = self.space.at(owner, uv.reshape(-1, 2), keep=True).rows[:, :3]
        lengths, turns = _lengths_and_turns(points.reshape(*uv.shape[:2], 3))
        straight = RULED * lengths / self.space.size
        steps = np.array([self.pieces[k].step for k in pieces.tolist()])
        planes = [self.pieces[k].jets(*x.T)[:, 0] for k, x in zip(pieces.tolist(), uv, strict=True)]
        costs = np.linalg.norm(np.diff(np.array(planes), axis=1), axis=2)
        return np.maximum(costs, np.maximum(CURVED * turns, straight) / steps[:, None])

    def plane(self, piece: int, uv: Array, tangents: Array) -> Array:
        """Return planar coordinates (k, 2) of parameters; for plane faces, as `Spacing` does."""
        turned = self.pieces[piece]
        return turned.turned(uv) if turned.turns else super().plane(piece, uv, tangents)


def _best_steps(planes: list[TurnedPiece], areas: Array, count: int) -> Array:
    """Return the steps in the planes of faces that minimize the mean angle for `count` vertices.

    The angle between triangles and normals is proportional to the step s. A face with perimeter p
    and area F in its plane has p/s vertices on its boundary and F/s² inside. At the minimum, the
    area of a face in space times the derivative of its mean angle by s is the derivative of its
    number of vertices by s, up to a factor that all faces share. No step exceeds `LONGEST` times
    the mean step. `areas` are the areas of the faces in space.
    """
    around = np.array([x.perimeter if x.turns else 0.0 for x in planes])
    inside = np.array([0.0 if x.is_ruled else x.size**2 for x in planes])
    curved = around > 0.0
    if not curved.any():
        return np.ones(len(planes))
    areas, around, inside = areas[curved], around[curved], inside[curved]

    def steps_for(factor: float) -> Array:
        steps = np.maximum(np.sqrt(factor * around / areas), np.cbrt(2.0 * factor * inside / areas))
        return np.minimum(steps, LONGEST * np.average(steps, weights=areas))

    def is_enough(factor: float) -> bool:
        steps = steps_for(factor)
        return bool((around / steps + inside / steps**2).sum() <= count)

    low = high = float(areas.sum())
    while is_enough(low):
        low /= 2.0
    while not is_enough(high):
        high *= 2.0
    steps = steps_for(least_enough(is_enough, low, high))
    found = np.full(len(planes), steps.max())
    found[curved] = steps
    return found


def least_enough(is_enough: Callable[[float], bool], low: float, high: float) -> float:
    """Return the least number for which `is_enough` is true, up to rounding.

    It is between `low`, for which `is_enough` is false, and `high`, for which it is true.
    """
    while low < (middle := math.sqrt(low * high)) < high:
        low, high = (low, middle) if is_enough(middle) else (middle, high)
    return high


def _lengths_and_turns(points: Array) -> tuple[Array, Array]:
    """Return lengths (S, n − 1) and turning angles (S, n − 1) of segments of polylines (S, n, 3).

    The turning angle at a vertex is divided equally between the two segments there.
    """
    steps = np.diff(points, axis=1)
    lengths = np.linalg.norm(steps, axis=2)
    along = steps / np.where(lengths > 0.0, lengths, 1.0)[..., None]
    turns = np.linalg.norm(np.diff(along, axis=1), axis=2) / 2.0
    return lengths, np.pad(turns, ((0, 0), (0, 1))) + np.pad(turns, ((0, 0), (1, 0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class TurnedPiece(FacePiece):
    """A face mapped to a plane: the coordinates are angles of the normal along u and along v.

    `knots` are values of u and of v, and `lengths` the coordinates of these values. The difference
    of two successive coordinates is the largest angle, over all parameter lines, between the
    normals at the two values. `turns` is the larger one of the total angles along u and along v,
    and `measure` the area in the plane. A sphere is not mapped to a plane, but to a sphere of
    radius 1.
    """

    number: int
    knots: tuple[Array, Array]
    lengths: tuple[Array, Array]
    turns: float
    is_ruled: bool
    measure: float
    step: float = 1.0

    @classmethod
    def of_piece(cls, piece: FacePiece, number: int) -> TurnedPiece:
        """Return the plane of a face."""
        knots = tuple(_places(piece, axis) for axis in (0, 1))
        places = np.stack(np.meshgrid(*knots, indexing="ij"), axis=-1)
        inside = piece.contains(places.reshape(-1, 2)).reshape(places.shape[:2])
        jets = piece.jets(*places.reshape(-1, 2).T.copy())
        normals = normals_of_jets(jets).reshape(*places.shape[:2], 3)
        angles = [_angles(normals, inside, axis) for axis in (0, 1)]
        totals = [float(x.sum()) for x in angles]
        turns = max(totals)
        lengths = []
        for steps, values in zip(angles, knots, strict=True):
            least = LEAST * turns * np.diff(values) / np.ptp(values)
            lengths.append(np.concatenate([[0.0], np.cumsum(np.maximum(steps, least))]))
        return cls(
            **{x.name: getattr(piece, x.name) for x in fields(FacePiece)},
            number=number, knots=(knots[0], knots[1]), lengths=(lengths[0], lengths[1]),
            turns=turns if turns > RULED else 0.0, is_ruled=min(totals) <= RULED,
            measure=_area(piece, knots, lengths),
        )  # fmt: skip

    def in_steps(self, step: float) -> TurnedPiece:
        """Return this plane in units of a step."""
        return replace(
            self, lengths=(self.lengths[0] / step, self.lengths[1] / step),
            measure=self.measure / step**2, step=step,
        )  # fmt: skip

    @property
    def perimeter(self) -> float:
        """The length of the boundary in the plane."""
        around = [self.turned(np.concatenate([x, x[:1]])) for x in self.polygons]
        return float(sum(np.linalg.norm(np.diff(x, axis=0), axis=1).sum() for x in around))

    def turned(self, uv: Array) -> Array:
        """Return planar coordinates (k, 2) of parameters (k, 2)."""
        return np.stack(
            [np.interp(uv[:, k], self.knots[k], self.lengths[k]) for k in (0, 1)], axis=1
        )

    def jets(self, u: Array, v: Array) -> Array:
        """Return 2-jets (k, 6, 3) of the plane, or of the sphere."""
        found, places = np.zeros((len(u), 6, 3)), np.stack([u, v], axis=1)
        if self._radius:
            found = super().jets(u, v)
            found[:, 0] -= super().jets(*self.middle)[0, 0]
            found /= self._radius * self.step
        else:
            found[:, 0, :2] = self.turned(places)
            for k in (0, 1):
                rates = np.diff(self.lengths[k]) / np.diff(self.knots[k])
                at = np.searchsorted(self.knots[k], places[:, k], side="right") - 1
                found[:, 1 + k, k] = rates[np.clip(at, 0, len(rates) - 1)]
        found[:, 0, 2] += APART * self.number
        return found

    @property
    def _radius(self) -> float:
        """The radius of a sphere, 0 for other faces."""
        return self.face.dimensions["radius"] if self.face.kind == "sphere" else 0.0

    @cached_property
    def size(self) -> float:
        """The square root of the area in the plane, or on the sphere."""
        size = super().size / (self._radius * self.step) if self._radius else 0.0
        return size or math.sqrt(self.measure)


def _places(piece: FacePiece, axis: int) -> Array:
    """Return values of u (axis 0) or v (axis 1): equally spaced, and at bounds of smooth parts."""
    return np.unique(np.concatenate([np.linspace(*piece.domain[axis], PLACES), piece.lines(axis)]))


def _angles(normals: Array, inside: Flags, axis: int) -> Array:
    """Return, for each step along an axis of a grid, the largest angle between normals, (k − 1,).

    `normals` (k, l, 3) are the normals at the grid points. A pair of neighbours along the axis
    counts if one of them is inside the trim.
    """
    n = np.moveaxis(normals, axis, 0)
    here = np.moveaxis(inside if inside.any() else np.ones_like(inside), axis, 0)
    known = np.asarray(n.any(axis=2))
    chords = np.linalg.norm(np.diff(n, axis=0), axis=2)
    counts = known[1:] & known[:-1] & (here[1:] | here[:-1])
    return (2.0 * np.arcsin(np.minimum(np.where(counts, chords, 0.0) / 2.0, 1.0))).max(axis=1)


def _area(piece: FacePiece, knots: Sequence[Array], lengths: Sequence[Array]) -> float:
    """Return the area of a face in its plane: the sum over cells with midpoints inside the trim."""
    middles = np.meshgrid(*((x[1:] + x[:-1]) / 2.0 for x in knots), indexing="ij")
    inside = piece.contains(np.stack(middles, axis=-1).reshape(-1, 2))
    areas = np.outer(np.diff(lengths[0]), np.diff(lengths[1])).ravel()
    return float((inside @ areas) or areas.sum())
