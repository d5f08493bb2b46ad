"""Distances from edges and boundaries: the condition that samples keep a distance from them.

Curves are cut into short arcs, whose middles are in a k-d tree. The distance from the nearest
middle decides most points. For the other points, Newton's method finds the nearest points on the
arcs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..runtime.base.aliases import Array, Flags, Indices
from ..runtime.base.repeats import repeated
from ..runtime.base.trees import tree_of
from .density.cells import grouped
from .support_points import Segments

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# The length of an arc is about the distance divided by ARCS_A_DISTANCE; there are about MOST_ARCS
# arcs at most.
ARCS_A_DISTANCE, MOST_ARCS = 16.0, 100_000
# The length of a segment is measured by CHORDS chords. Let r be the largest distance between the
# middle and an end of an arc: each arc is assumed to be within BULGE r of its middle.
CHORDS, BULGE = 8, 1.1
# Newton's method takes at most STEPS steps. A Gauss-Newton step replaces a Newton step if half the
# second derivative of the squared distance is at most CONVEX |dx/dt|². The steps end when they are
# shorter than FINE times the distance; the error of a distance is of second order in the last step.
STEPS, CONVEX, FINE = 8, 0.1, 1e-8
# Distances are compared up to this multiple of the largest coordinate, for rounding errors.
ROUNDING = 32.0 * np.finfo(np.float64).eps


@dataclass(frozen=True, eq=False)
class AwayFrom:
    """The condition that points have at least a `distance` from curves.

    Arc i is the part of segment `rows`[i] of `parts`[`part`[i]] with parameters from `first`[i] to
    `last`[i]. It is within `radius` of its middle, a point of the `tree`, and the exact edge is
    within `errors`[i] of the arc.
    """

    parts: Sequence[Segments]
    part: Indices
    rows: Indices
    first: Array
    last: Array
    errors: Array
    tree: KDTree
    radius: float
    distance: float

    @classmethod
    def of(cls, parts: Sequence[Segments], distance: float) -> AwayFrom | None:
        """Return the condition for a distance from curves; None if there are no curves."""
        lengths = [_lengths(x) for x in parts]
        total = sum(float(x.sum()) for x in lengths)
        step = max(distance / ARCS_A_DISTANCE, total / MOST_ARCS)
        found, middles, radius, size = list[tuple[Any, ...]](), [np.empty((0, 3))], 0.0, 0.0
        for k, (part, along) in enumerate(zip(parts, lengths, strict=True)):
            counts = np.where(along > 0.0, np.ceil(along / step), 0.0).astype(np.int64)
            rows, number = repeated(counts)
            first, last = number / counts[rows], (number + 1) / counts[rows]
            ends = [part.at(rows, t)[1] for t in (first, (first + last) / 2.0, last)]
            away = [np.linalg.norm(ends[1] - x, axis=1).max(initial=0.0) for x in ends]
            radius, size = max(radius, *away), max(size, np.abs(ends[1]).max(initial=0.0))
            errors = np.zeros(len(part.starts)) + part.errors
            found.append((np.full(len(rows), k), rows, first, last, errors[rows]))
            middles.append(ends[1])
        if not total > 0.0:
            return None
        part, rows, first, last, errors = map(np.concatenate, zip(*found, strict=True))
        tree = tree_of(np.concatenate(middles))
        errors += ROUNDING * size
        return cls(parts, part, rows, first, last, errors, tree, BULGE * radius, distance)

    @property
    def error(self) -> float:
        """The largest error of an arc."""
        return float(self.errors.max())

    @property
    def most(self) -> float:
        """The largest distance from an arc's middle at which a point may be too near to the arc."""
        return self.distance + self.radius + self.error

    def holds(self, points: Array, normals: Array) -> Flags:
        """Return a mask of the points (k, 3) that are far enough from all curves.

        `normals` are not used.
        """
        near = self.tree.query(points, distance_upper_bound=self.most)[0]
        found = np.isinf(near)
        open_ = np.flatnonzero(~found & (near >= self.distance))
        arcs = self.tree.query_ball_point(points[open_], self.most)
        owner = np.repeat(np.arange(len(open_)), [len(x) for x in arcs])
        pairs = np.array([k for x in arcs for k in x], np.int64)
        distances = self._distances(points[open_][owner], pairs)
        too_near = distances < self.distance + self.errors[pairs]
        found[open_] = np.bincount(owner, too_near, len(open_)) == 0
        return found

    def may_change(self, points: Array, radii: Array) -> Flags:
        """Return a mask (k,) of balls that may contain both allowed and excluded points.

        The balls have centres `points` (k, 3) and `radii` (k,).
        """
        most = self.most + float(radii.max(initial=0.0))
        near = self.tree.query(points, distance_upper_bound=most)[0]
        return (near - radii <= self.most) & (near + radii >= self.distance)

    def _distances(self, points: Array, arcs: Indices) -> Array:
        """Return the distance (k,) of each point (k, 3) from the arc of the same row."""
        first, last = self.first[arcs], self.last[arcs]
        t, found = (first + last) / 2.0, np.full(len(arcs), np.inf)
        for _ in range(STEPS):
            x, d, dd = self._at(arcs, t)
            x -= points
            np.minimum(found, np.linalg.norm(x, axis=1), out=found)
            square = np.einsum("kx,kx->k", d, d)
            bend = square + np.einsum("kx,kx->k", x, dd)
            bend = np.where(bend > CONVEX * square, bend, square)
            step = np.einsum("kx,kx->k", x, d) / np.where(bend > 0.0, bend, 1.0)
            moved = np.clip(t - step, first, last)
            if (np.abs(moved - t) * np.sqrt(square) <= FINE * self.distance).all():
                break
            t = moved
        return found

    def _at(self, arcs: Indices, t: Array) -> tuple[Array, Array, Array]:
        """Return x, dx/dt and d²x/dt² (k, 3) at parameters (k,) of arcs, given by indices (k,)."""
        found = np.empty((3, len(arcs), 3))
        for k, some in grouped(self.part[arcs]):
            found[:, some] = self.parts[k].at(self.rows[arcs[some]], t[some])[1:]
        return found[0], found[1], found[2]


def _lengths(part: Segments) -> Array:
    """Return the lengths (M,) of segments, measured by chords; 0 where a length is not finite."""
    count = len(part.starts)
    rows, t = np.repeat(np.arange(count), CHORDS + 1), np.linspace(0.0, 1.0, CHORDS + 1)
    points = part.at(rows, np.tile(t, count))[1].reshape(count, CHORDS + 1, 3)
    found = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1)
    return np.where(np.isfinite(found), found, 0.0)
