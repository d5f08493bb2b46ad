"""Meshes of trimmed surfaces: vertices on the border, and triangles inside of it.

The whole domain is triangulated, with further points outside of the border that fill it; then the
triangles outside are left out. Where an edge crosses the border, points of the border are added,
until none does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import Boundary
from ...runtime.spline.spline import Spline
from .border import border_lines, wrapped
from .links import edge_numbers, neighbours
from .vertices import CLOSE, Vertices, before_offset, points_at, spacings_at

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from ...runtime.samples.samples import Samples

__all__ = ["trimmed_triangles"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Triangulate = Callable[[Vertices], tuple[Indices, Indices, Indices]]

# What stands for the number of the sample at a vertex on the border, and outside of it.
ON_BORDER, OUTSIDE = -2, -3
# A polyline is measured in steps of at most this part of the spacing, and in at most this number.
FINE, MOST_STEPS = 0.125, 200_000
# A sample that is closer than this part of the spacing lies on it: chords are as close to curves.
ON_LINE = 5e-3
# It has a corner where it turns by more than this within a spacing.
CORNER = math.radians(30.0)
# Outside there is about one point for each sample, between these numbers; they keep this distance
# from the border, in spacings.
FEWEST, MOST, AWAY = 400, 4000, 0.7
# Points are added to the border at most this number of times.
ROUNDS = 8


def trimmed_triangles(
    vertices: Vertices,
    samples: Samples,
    spline: Spline,
    boundary: Boundary,
    lengths: Array,
    triangulate: Triangulate,
) -> tuple[Vertices, Indices, Indices, Indices, bool]:
    """Return vertices and triangles inside the trim of a spline, sides, and neighbours.

    And whether they have no other border than that of the surface. `vertices` are those of the
    whole domain, `lengths` (2,) those of the surface along u and v; `triangulate` returns what
    `_triangles` of meshing does.
    """
    tree = tree_of(before_offset(samples) * spline.scale)
    lines = [_Line.of(x, spline, tree) for x in border_lines(spline)]
    for line in lines:
        line.to_samples(tree)
    trimmed = _Trimmed(spline, boundary, lengths, vertices, lines)
    whole, numbers = trimmed.vertices()
    triangles, sides, _ = triangulate(whole)
    for _ in range(ROUNDS):
        if not trimmed.refine(whole, triangles, numbers):
            break
        whole, numbers = trimmed.vertices()
        triangles, sides, _ = triangulate(whole)
    kept = trimmed.is_inside(whole, triangles)
    triangles, sides = triangles[kept], sides[kept]
    on_border = whole.sample == ON_BORDER
    sample = np.where(on_border, trimmed.samples_on_border(len(on_border)), whole.sample)
    found = Vertices(whole.positions, np.maximum(sample, -1), whole.is_free & ~on_border)
    adjacent, is_closed = neighbours(triangles, ~found.is_free)
    return found, triangles, sides, adjacent, is_closed


@dataclass(eq=False)
class _Line:
    """A polyline of the border, measured by its length relative to the spacing of its points.

    `t` (k,) are the measures at its vertices; `fixed` (k,) says which are ends and corners;
    `sample` (k,) are the numbers of the samples that lie there, or −1.
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
    def of(cls, positions: Array, spline: Spline, tree: KDTree) -> _Line:
        """Measure a polyline (k, 2), and put vertices on it."""
        points, spacings, steps = _measured(positions, spline, tree)
        finer = math.ceil(float(steps.max(initial=0.0)) / FINE)
        finer = min(finer, MOST_STEPS // len(positions))
        if finer > 1:
            at = np.arange(finer * (len(positions) - 1) + 1) / finer
            number = np.arange(len(positions))
            positions = np.stack([np.interp(at, number, x) for x in positions.T], axis=1)
            points, spacings, steps = _measured(positions, spline, tree)
        measure = np.concatenate([[0.0], np.cumsum(steps)])
        closed = bool(np.abs(points[0] - points[-1]).max() <= 1e-9 * np.ptp(points, axis=0).max())
        t, fixed = _divided(points, measure, closed)
        none = np.full(len(t), -1)
        return cls(positions, points, spacings, measure, closed, t, fixed, none)

    def to_samples(self, tree: KDTree) -> None:
        """Move vertices next to the samples that are close to the line."""
        distance, found = tree_of(self.points).query(tree.data, workers=-1)
        nearest = np.asarray(found)
        near = np.flatnonzero(distance < CLOSE * self.spacings[nearest])
        near = near[np.argsort(-distance[near], kind="stable")]  # the closest one comes last
        at, distance = self._feet(np.asarray(tree.data)[near], nearest[near])
        slots = np.searchsorted((self.t[1:] + self.t[:-1]) / 2.0, at)
        free = ~self.fixed[slots]
        self.t[slots[free]] = at[free]
        is_on = distance <= ON_LINE * self.spacings[nearest[near]]
        if is_on.any():
            steps = np.abs(self.t[:, None] - at[is_on]).min(axis=1)
            kept = self.fixed | (steps > CLOSE)
            count = int(is_on.sum())
            self.t = np.append(self.t[kept], at[is_on])
            self.fixed = np.append(self.fixed[kept], np.ones(count, dtype=bool))
            self.sample = np.append(self.sample[kept], near[is_on])
        order = np.argsort(self.t, kind="stable")
        self.t, self.fixed = self.t[order], self.fixed[order]
        self.sample = self.sample[order]

    def _feet(self, points: Array, nearest: Indices) -> tuple[Array, Array]:
        """Return the measures of the feet of points (k, 3), and the distances from there.

        `nearest` (k,) are the vertices of the polyline that are nearest to the points.
        """
        at, distance = self.measure[nearest], np.full(len(points), np.inf)
        for begin in (nearest - 1, nearest):
            first = np.clip(begin, 0, len(self.points) - 2)
            start, along = self.points[first], self.points[first + 1] - self.points[first]
            square = np.einsum("kx,kx->k", along, along)
            share = np.einsum("kx,kx->k", points - start, along)
            share = np.clip(share / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
            apart = np.linalg.norm(start + share[:, None] * along - points, axis=1)
            foot = self.measure[first] + share * (self.measure[first + 1] - self.measure[first])
            at, distance = np.where(apart < distance, foot, at), np.minimum(apart, distance)
        return at, distance

    def insert(self, segments: Flags) -> None:
        """Bisect segments between vertices."""
        middles = (self.t[1:] + self.t[:-1])[segments] / 2.0
        at = np.flatnonzero(segments) + 1
        self.t, self.fixed = np.insert(self.t, at, middles), np.insert(self.fixed, at, False)
        self.sample = np.insert(self.sample, at, -1)

    def at_vertices(self) -> Array:
        """Return the positions of the vertices; a closed line repeats the first one at its end."""
        return np.stack([np.interp(self.t, self.measure, x) for x in self.positions.T], axis=1)


def _measured(positions: Array, spline: Spline, tree: KDTree) -> tuple[Array, Array, Array]:
    """Return points and spacings at positions, and the steps in between relative to the spacing."""
    points = points_at(spline, wrapped(positions, spline.boundary))
    spacings = spacings_at(tree, points)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shortest = float(lengths.sum()) / max(len(lengths), 1) * 1e-3 or 1.0
    return points, spacings, lengths / np.maximum((spacings[1:] + spacings[:-1]) / 2.0, shortest)


def _divided(points: Array, measure: Array, closed: bool) -> tuple[Array, Flags]:
    """Return measures about 1 apart from corner to corner; and which are corners or ends."""
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
    """Return the measures of the corners, no two of them within half a spacing."""
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


@dataclass(eq=False)
class _Trimmed:
    """The vertices of a trimmed surface, which are triangulated again and again."""

    spline: Spline
    boundary: Boundary
    lengths: Array
    given: Vertices
    lines: list[_Line]

    def __post_init__(self) -> None:
        """Find out which given vertices are outside, and fill the domain there."""
        self.extra = np.empty((0, 2))
        border = self._on_lines()
        inside = (self.given.sample >= 0) | self._contains(self.given.positions)
        sample = np.where(inside, self.given.sample, OUTSIDE)
        kept = np.ones(len(sample), dtype=bool)
        if len(border):
            # Vertices of open sides next to the ends of the border.
            near = tree_of(border * self.lengths)
            added = np.flatnonzero(self.given.sample < 0)
            distance, nearest = near.query(self.given.positions[added] * self.lengths)
            kept[added] = distance > 0.3 * self._gaps(border)[nearest]
        for line in self.lines:
            kept &= ~np.isin(sample, line.sample[line.sample >= 0])
        self.given = Vertices(self.given.positions[kept], sample[kept], self.given.is_free[kept])
        self.outside = self._filling(border)

    def vertices(self) -> tuple[Vertices, list[Indices]]:
        """Return all vertices, and for each line the numbers of those on it, in turn."""
        parts, numbers, first = [self.given], [], len(self.given.positions)
        self.on_border = [np.full(first, -1)]
        for line in self.lines:
            positions = line.at_vertices()
            count = len(positions) - line.closed
            number = first + np.arange(len(positions))
            number[count:] = first
            numbers.append(number)
            parts.append(self._border(positions[:count]))
            self.on_border.append(line.sample[:count])
            first += count
        parts += [self._border(self.extra), self.outside]
        return Vertices.joined(parts), numbers

    def samples_on_border(self, count: int) -> Indices:
        """Return the numbers (count,) of the samples at vertices of lines, −1 at others."""
        known = np.concatenate(self.on_border)
        return np.append(known, np.full(count - len(known), -1))

    def refine(self, whole: Vertices, triangles: Indices, numbers: list[Indices]) -> bool:
        """Add points of the border where it is not made of edges; say whether there are any."""
        count = len(whole.positions)
        edges = np.unique(edge_numbers(triangles, count))
        added = False
        for line, number in zip(self.lines, numbers, strict=True):
            ends = np.sort(np.stack([number[:-1], number[1:]], axis=1), axis=1)
            missing = ~np.isin(ends[:, 0] * count + ends[:, 1], edges) & (ends[:, 0] != ends[:, 1])
            if missing.any():
                line.insert(missing)
                added = True
        first, second = np.divmod(edges, count)
        a, b = whole.sample[first], whole.sample[second]
        crosses = ((a >= 0) & (b == OUTSIDE)) | ((b >= 0) & (a == OUTSIDE))
        if not added and crosses.any():
            start = np.where(a >= 0, first, second)[crosses]
            end = np.where(a >= 0, second, first)[crosses]
            self._add_crossings(whole.positions[start], whole.positions[end])
            added = True
        return added

    def is_inside(self, whole: Vertices, triangles: Indices) -> Flags:
        """Say which triangles are inside: those at samples, if the border is made of edges.

        And triangles between points of the border, if their centroids are.
        """
        kept = (whole.sample[triangles] != OUTSIDE).all(axis=1)
        unsure = np.flatnonzero(kept & (whole.sample[triangles] < 0).all(axis=1))
        corners = self._near_first(whole.positions[triangles[unsure]])
        kept[unsure] = self._contains(corners.mean(axis=1))
        return kept

    def _on_lines(self) -> Array:
        """Return the positions of all vertices of lines."""
        found = [wrapped(x.at_vertices(), self.spline.boundary) for x in self.lines]
        return np.concatenate([np.empty((0, 2)), *found])

    def _border(self, positions: Array) -> Vertices:
        """Return vertices on the border; those on open sides are not displaced."""
        positions = wrapped(positions, self.spline.boundary)
        is_free = np.ones(len(positions), dtype=bool)
        for axis, ends in enumerate(self.boundary):
            if ends[0] not in ("periodic", "mirrored"):
                is_free &= (positions[:, axis] > 0.0) & (positions[:, axis] < 1.0)
        return Vertices(positions, np.full(len(positions), ON_BORDER), is_free)

    def _gaps(self, border: Array) -> Array:
        """Return the distances (k,) of vertices on lines from those before and after them."""
        gaps = []
        for line in self.lines:
            steps = np.linalg.norm(np.diff(line.at_vertices(), axis=0) * self.lengths, axis=1)
            first, last = (steps[-1:], steps[:1]) if line.closed else (steps[:1], steps[-1:])
            gaps.append(np.maximum(np.append(first, steps), np.append(steps, last)))
        return np.concatenate(gaps) if gaps else np.empty(0)

    def _filling(self, border: Array) -> Vertices:
        """Return vertices that fill the domain outside, away from the border."""
        number = min(max(len(self.given.positions), FEWEST), MOST)
        size = math.sqrt(float(self.lengths.prod()) / number)
        counts = np.maximum(np.ceil(self.lengths / size), 3).astype(np.int64)
        i, j = (x.ravel() for x in np.indices(tuple(counts.tolist())))
        places = np.stack(
            [(i + 0.5 + 0.25 * (j % 2 * 2 - 1)) / counts[0], (j + 0.5) / counts[1]], 1
        )
        places = places[~self._contains(places)]
        if len(border) and len(places):
            distance, nearest = tree_of(border * self.lengths).query(places * self.lengths)
            places = places[distance > AWAY * self._gaps(border)[nearest]]
        return Vertices(places, np.full(len(places), OUTSIDE), np.ones(len(places), dtype=bool))

    def _contains(self, positions: Array) -> Flags:
        assert self.spline.trim is not None
        low, high = np.array(self.spline.domain).T
        return self.spline.trim.contains(low + wrapped(positions, self.boundary) * (high - low))

    def _near_first(self, corners: Array) -> Array:
        """Move positions (k, c, 2) across seams to the copies nearest to the first of each c."""
        first, best = corners[:, :1], corners
        copies = [corners]
        for axis, ends in enumerate(self.boundary):
            if ends[0] not in ("periodic", "mirrored"):
                continue
            for copy in list(copies):
                for step in (-1.0, 1.0):
                    moved = copy.copy()
                    moved[..., axis] += step
                    if ends[0] == "mirrored":
                        moved[..., 1 - axis] = 1.0 - moved[..., 1 - axis]
                    copies.append(moved)
        for copy in copies:
            squares = [(((x - first) * self.lengths) ** 2).sum(axis=2) for x in (copy, best)]
            best = np.where((squares[0] < squares[1])[..., None], copy, best)
        return best

    def _add_crossings(self, inside: Array, outside: Array) -> None:
        """Add points of the border between positions inside and outside, by bisection."""
        low, high = np.moveaxis(self._near_first(np.stack([inside, outside], axis=1)), 1, 0)
        low, high = low.copy(), high.copy()
        for _ in range(40):
            middle = (low + high) / 2.0
            within = self._contains(middle)
            low[within], high[~within] = middle[within], middle[~within]
        self.extra = np.concatenate([self.extra, (low + high) / 2.0])
