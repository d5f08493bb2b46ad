"""Meshes of trimmed surfaces: vertices on the boundary, and triangles inside.

The whole domain is triangulated, with additional points that fill it outside of the boundary; then
the triangles outside are left out. Points are added to the boundary until it consists of edges.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import closes
from ...runtime.spline.spline import Spline
from .border import border_lines
from .links import edge_numbers, neighbours
from .measured_line import MeasuredLine
from .places import uv_at, wrapped
from .vertices import Vertices

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Triangulate = Callable[[Vertices], tuple[Indices, Indices, Indices]]

# A sample closer to the boundary than this, relative to the spacing of samples, counts as a sample
# on the boundary: the chords of the boundary are about as close to its curves.
ON_LINE = 5e-3
# The domain outside of the boundary is filled with points of a lattice. In the whole domain the
# lattice has about as many points as there are vertices, but at least FEWEST and at most MOST.
# Lattice points within AWAY gaps of a boundary vertex are left out, as are added vertices within
# ASIDE gaps (see `_is_away`).
FEWEST, MOST, AWAY, ASIDE = 400, 4000, 0.7, 0.3
# The largest number of times that points are added to the boundary.
ROUNDS = 8


def trimmed_triangles(
    vertices: Vertices, points: Array, spline: Spline, lengths: Array, triangulate: Triangulate
) -> tuple[Vertices, Indices, Indices, Indices, bool]:
    """Return the vertices of a mesh, its triangles inside the trim, and their sides and neighbours.

    Also return whether the triangles are complete: they end only at the boundary of the surface.
    `vertices` cover the whole domain, `points` are the points of the samples, `lengths` (2,) the
    lengths of the surface along u and v; `triangulate` is like `_triangles` of `meshing.py`.
    """
    own = vertices.chosen(vertices.sample >= 0)
    tree = tree_of(points[own.sample] * spline.scale)
    lines = [MeasuredLine.of(x, spline, tree) for x in border_lines(spline)]
    for line in lines:
        line.to_samples(tree, (own.positions, own.sample), spline.boundary, lengths, ON_LINE)
    trim = _Trim(spline, lengths, lines)
    inner, outside = trim.cut(vertices)
    rounds = 0
    while True:
        border = trim.border()
        whole = Vertices.joined([inner, border, outside])
        triangles, sides, _ = triangulate(whole)
        rounds += 1
        if rounds > ROUNDS or not trim.refine(triangles, len(inner.sample), len(whole.sample)):
            break
    number = np.arange(len(whole.sample))
    within = number < len(inner.sample)
    on_border = ~within & (number < len(inner.sample) + len(border.sample))
    kept = trim.is_inside(whole, triangles, within | on_border, within & (whole.sample >= 0))
    triangles, sides = triangles[kept], sides[kept]
    found = Vertices(whole.positions, whole.sample, whole.is_free & ~on_border)
    return found, triangles, sides, *neighbours(triangles, ~found.is_free)


@dataclass(eq=False)
class _Trim:
    """The trim of a spline, with the vertices on its boundary."""

    spline: Spline
    lengths: Array
    lines: list[MeasuredLine]

    def cut(self, given: Vertices) -> tuple[Vertices, Vertices]:
        """Return vertices inside the trim, and vertices outside, none of them on its boundary.

        The vertices inside are vertices of `given`. The vertices outside are vertices of `given` on
        open sides and at poles, and new points that fill the domain, away from the boundary.
        """
        is_added = given.sample < 0
        inside = ~is_added | self._contains(given.positions)
        kept = ~is_added | self._is_away(given.positions, ASIDE)
        for line in self.lines:
            kept &= is_added | ~np.isin(given.sample, line.sample)
        inner, outside = given.chosen(kept & inside), given.chosen(kept & ~inside)
        number = min(max(int(kept.sum()), FEWEST), MOST)
        size = math.sqrt(float(self.lengths.prod()) / number)
        counts = np.maximum(np.ceil(self.lengths / size), 3).astype(np.int64)
        i, j = (x.ravel() for x in np.indices(tuple(counts.tolist())))
        places = np.stack(
            [(i + 0.5 + 0.25 * (j % 2 * 2 - 1)) / counts[0], (j + 0.5) / counts[1]], 1
        )
        places = places[~self._contains(places) & self._is_away(places, AWAY)]
        filling = Vertices(places, np.full(len(places), -1), np.ones(len(places), dtype=bool))
        return inner, Vertices.joined([outside, filling])

    def border(self) -> Vertices:
        """Return the vertices of all boundary lines, in order; on open sides they are not free."""
        ends = [len(x.t) - x.closed for x in self.lines]
        found = [x.at_vertices()[:end] for x, end in zip(self.lines, ends, strict=True)]
        sample = [x.sample[:end] for x, end in zip(self.lines, ends, strict=True)]
        positions = wrapped(np.concatenate([np.empty((0, 2)), *found]), self.spline.boundary)
        is_free = np.ones(len(positions), dtype=bool)
        for axis, ends in enumerate(self.spline.boundary):
            if not closes(ends):
                is_free &= (positions[:, axis] > 0.0) & (positions[:, axis] < 1.0)
        return Vertices(positions, np.concatenate([np.empty(0, dtype=np.int64), *sample]), is_free)

    def refine(self, triangles: Indices, first: int, count: int) -> bool:
        """Add boundary points where the boundary has no edges; return True if any was added.

        The boundary vertices start at index `first`, `count` is the number of all vertices.
        """
        edges = np.unique(edge_numbers(triangles, count))
        added = False
        for line in self.lines:
            last = len(line.t) - line.closed
            number = first + np.arange(len(line.t)) % last
            ends = np.sort(np.stack([number[:-1], number[1:]], axis=1), axis=1)
            missing = ~np.isin(ends[:, 0] * count + ends[:, 1], edges) & (ends[:, 0] != ends[:, 1])
            if missing.any():
                line.insert(missing)
                added = True
            first += last
        return added

    def is_inside(self, whole: Vertices, triangles: Indices, possible: Flags, sure: Flags) -> Flags:
        """Return a mask of the triangles inside the trim.

        `possible` and `sure` are masks of the vertices. A triangle is inside if all its vertices
        are `possible` and, in addition, one of them is `sure` or the centroid is inside the trim.
        """
        kept = np.asarray(possible[triangles].all(axis=1))
        unsure = np.flatnonzero(kept & ~sure[triangles].any(axis=1))
        corners = whole.positions[triangles[unsure]]
        corners = wrapped(corners, self.spline.boundary, around=corners[:, :1])
        kept[unsure] = self._contains(corners.mean(axis=1))
        return kept

    def _is_away(self, positions: Array, gaps: float) -> Flags:
        """Return whether positions are more than `gaps` gaps away from the boundary vertices.

        A gap is the length of the longer one of the two steps at the nearest boundary vertex.
        """
        if not self.lines:
            return np.ones(len(positions), dtype=bool)
        places, around = [], []
        for line in self.lines:
            at = line.at_vertices()
            steps = np.linalg.norm(np.diff(at, axis=0) * self.lengths, axis=1)
            steps = np.pad(steps, 1, mode="wrap" if line.closed else "edge")
            places.append(wrapped(at, self.spline.boundary))
            around.append(np.maximum(steps[1:], steps[:-1]))
        tree = tree_of(np.concatenate(places) * self.lengths)
        distance, nearest = tree.query(positions * self.lengths)
        return distance > gaps * np.concatenate(around)[nearest]

    def _contains(self, positions: Array) -> Flags:
        assert self.spline.trim is not None
        return self.spline.trim.contains(uv_at(self.spline, positions))
