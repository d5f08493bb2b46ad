"""A polyline of the boundary, with vertices spaced like the samples near it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import Boundary
from ...runtime.spline.spline import Spline
from .places import points_at, spacings_at, wrapped

if TYPE_CHECKING:
    from scipy.spatial import KDTree

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

# The largest step in the measurement of a polyline, relative to the spacing of samples, and the
# largest number of steps.
FINE, MOST_STEPS = 0.125, 200_000
# To get the measure of a step, its length is divided by the spacing, or by SHORTEST times the mean
# length of a step if this is larger. A measure is at least LEAST.
SHORTEST, LEAST = 1e-3, 1e-12
# A polyline has a corner where it turns by more than this within one spacing.
CORNER = math.radians(30.0)
# A sample closer to the boundary than this, relative to the spacing there, gets a vertex opposite
# to it, so that no triangle of a sample and two boundary vertices is flat.
CLOSE = 0.25
# A close sample gets a vertex opposite to it only if it is also closer to the boundary than this in
# the domain, scaled to the unit square: in space, another part of the surface may be near.
DEEPEST = 0.125
# Measures that differ by less than this belong to one vertex.
EQUAL = 1e-6


@dataclass(eq=False)
class MeasuredLine:
    """A polyline of the boundary, measured by its length relative to the spacing of samples.

    `measure` (N,) are the relative lengths from the start of the line to its `points` (N, 3). There
    are k vertices of the mesh on the line: `t` (k,) are their measures; `fixed` (k,) marks vertices
    that are ends, corners or samples; `sample` (k,) are the indices of the samples at vertices, or
    −1.
    """

    positions: Array
    points: Array
    spacings: Array
    measure: Array
    closed: bool
    t: Array
    fixed: Flags
    sample: Indices

    @classmethod
    def of(cls, positions: Array, spline: Spline, tree: KDTree) -> MeasuredLine:
        """Measure a polyline (k, 2) by the spacing of samples, and put vertices on it.

        The tree holds the points of the samples.
        """
        points, spacings, steps = _measured(positions, spline, tree)
        finer = math.ceil(float(steps.max(initial=0.0)) / FINE)
        finer = min(finer, MOST_STEPS // len(positions))
        if finer > 1:
            at = np.arange(finer * (len(positions) - 1) + 1) / finer
            number = np.arange(len(positions))
            positions = np.stack([np.interp(at, number, x) for x in positions.T], axis=1)
            points, spacings, steps = _measured(positions, spline, tree)
        measure = np.concatenate([[0.0], np.cumsum(np.maximum(steps, LEAST))])
        closed = bool(np.abs(points[0] - points[-1]).max() < 1e-9 * np.ptp(points, axis=0).max())
        t, fixed = _divided(points, measure, closed)
        return cls(positions, points, spacings, measure, closed, t, fixed, np.full(len(t), -1))

    def to_samples(
        self,
        tree: KDTree,
        samples: tuple[Array, Indices],
        boundary: Boundary,
        lengths: Array,
        on_line: float,
    ) -> None:
        """Move vertices to the feet of close samples; samples within `on_line` become vertices.

        `samples` are the positions and the indices of the samples in the tree. A vertex moves to
        the foot of the perpendicular from a sample, in the domain scaled by `lengths` (2,), the
        lengths of the surface along u and v. `on_line` is relative to the spacing.
        """
        reach = CLOSE * self.spacings
        distance, nearest = tree_of(self.points).query(
            tree.data, distance_upper_bound=float(reach.max()) or 1.0, workers=-1
        )
        found = np.asarray(nearest)
        near = np.flatnonzero(found < len(self.points))
        near = near[distance[near] < reach[found[near]]]
        near = near[np.argsort(-distance[near], kind="stable")]  # the closest sample comes last
        around = self.positions[found[near]]
        positions, numbers = samples
        places = wrapped(positions[near], boundary, around)
        beside = np.abs(places - around).max(axis=1) < DEEPEST
        near, places = near[beside], places[beside]
        at, distance = self._feet(tree.data[near], places, found[near], lengths)
        slots = np.searchsorted((self.t[1:] + self.t[:-1]) / 2.0, at)
        free = ~self.fixed[slots]
        self.t[slots[free]] = at[free]
        self._take(at, numbers[near], distance <= on_line * self.spacings[found[near]])

    def _take(self, at: Array, numbers: Indices, is_on: Flags) -> None:
        """Make vertices of the samples on the line; they replace other vertices near them."""
        for t, number in zip(at[is_on].tolist(), numbers[is_on].tolist(), strict=True):
            apart = np.abs(self.t - t)
            ends = np.flatnonzero(self.fixed & (apart <= EQUAL))
            t = float(self.t[ends[0]]) if len(ends) else t
            kept = (apart > CLOSE) | (self.fixed & (apart > EQUAL))
            place = int(np.searchsorted(self.t[kept], t))
            self.t = np.insert(self.t[kept], place, t)
            self.fixed = np.insert(self.fixed[kept], place, True)
            self.sample = np.insert(self.sample[kept], place, number)

    def _feet(
        self, points: Array, places: Array, nearest: Indices, lengths: Array
    ) -> tuple[Array, Array]:
        """Return the measures (k,) of the feet of perpendiculars from points, and distances (k,).

        The points (k, 3) are at positions `places` (k, 2). `nearest` (k,) are the indices of the
        points of the polyline nearest to them.
        """
        at, distance = self.measure[nearest], np.full(len(points), np.inf)
        for begin in (nearest - 1, nearest):
            first = np.clip(begin, 0, len(self.points) - 2)
            along = (self.positions[first + 1] - self.positions[first]) * lengths
            square = np.einsum("kx,kx->k", along, along)
            share = np.einsum("kx,kx->k", along, (places - self.positions[first]) * lengths)
            share = np.clip(share / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
            start, end = self.points[first], self.points[first + 1]
            apart = np.linalg.norm(start + share[:, None] * (end - start) - points, axis=1)
            foot = self.measure[first] + share * (self.measure[first + 1] - self.measure[first])
            at, distance = np.where(apart < distance, foot, at), np.minimum(apart, distance)
        return at, distance

    def insert(self, segments: Flags) -> None:
        """Insert a vertex in the middle of each chosen segment between vertices."""
        middles = (self.t[1:] + self.t[:-1])[segments] / 2.0
        at = np.flatnonzero(segments) + 1
        self.t, self.fixed = np.insert(self.t, at, middles), np.insert(self.fixed, at, False)
        self.sample = np.insert(self.sample, at, -1)

    def at_vertices(self) -> Array:
        """Return the positions of the vertices; on a closed line, the last repeats the first."""
        return np.stack([np.interp(self.t, self.measure, x) for x in self.positions.T], axis=1)


def _measured(positions: Array, spline: Spline, tree: KDTree) -> tuple[Array, Array, Array]:
    """Return points and spacings at positions, and the relative lengths of the steps between them.

    The length of a step is relative to the mean spacing at its ends.
    """
    points = points_at(spline, wrapped(positions, spline.boundary))
    spacings = spacings_at(tree, points)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shortest = float(lengths.sum()) / max(len(lengths), 1) * SHORTEST or 1.0
    return points, spacings, lengths / np.maximum((spacings[1:] + spacings[:-1]) / 2.0, shortest)


def _divided(points: Array, measure: Array, closed: bool) -> tuple[Array, Flags]:
    """Return the measures of vertices, about 1 apart, and a mask of those at corners and ends."""
    total = float(measure[-1])
    corners = _corners(points, measure, closed)
    ends = np.unique(np.concatenate([[0.0], corners, [total]]))
    parts = [
        a + (b - a) * np.arange(k) / k
        for a, b in pairwise(ends.tolist())
        for k in [max(round(b - a), 3 if closed and len(ends) == 2 else 1)]
    ]
    t = np.concatenate([*parts, [total]])
    fixed = np.isin(t, ends)
    return t, fixed


def _corners(points: Array, measure: Array, closed: bool) -> Array:
    """Return the measures of the corners, at least half a spacing apart."""
    total = float(measure[-1])

    def at(t: Array) -> Array:
        t = np.mod(t, total) if closed and total > 0.0 else np.clip(t, 0.0, total)
        return np.stack([np.interp(t, measure, x) for x in points.T], axis=1)

    before, after = points - at(measure - 0.5), at(measure + 0.5) - points
    cosines = np.einsum("kx,kx->k", before, after)
    sines = np.linalg.norm(np.cross(before, after), axis=1)
    angles = np.arctan2(sines, cosines)
    if not closed:
        angles[(measure < 0.5) | (measure > total - 0.5)] = 0.0
    found: list[float] = []
    candidates = np.flatnonzero(angles > CORNER)
    for k in candidates[np.argsort(-angles[candidates], kind="stable")]:
        if all(abs(measure[k] - x) > 0.5 for x in found):
            found.append(float(measure[k]))
    return np.array(found)
