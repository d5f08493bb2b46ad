"""Polylines through samples of a contour generator, the curve with N·d = 0 on a spline.

In each patch N·d is a quadratic in the parameters, and continuous over the spline. The criss-cross
grid is refined, and in each of its triangles that has both signs at its corners the curve is a
segment: linked, segments make curves that are closed or end at open sides. Zero counts as positive,
so that a curve may follow edges of the grid, and cross a pole. Samples are sorted along these
curves by their feet in the parameter plane; where a curve leaves the trim of the spline it is cut.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.spline.spline import Spline

__all__ = ["polylines_of"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# A cell of the spline is divided into the largest of these numbers of parts along u and along v for
# which there are at most as many cells as this; patches are unions of triangles.
PARTS, MOST_CELLS = (4, 2, 1), 1 << 15
# The foot of a sample is sought on this number of segments, those with the nearest midpoints.
CANDIDATES = 8


def polylines_of(spline: Spline, axis: Array, uv: Array) -> tuple[Indices, ...]:
    """Return samples (numbers) in their order along each curve with N·axis = 0.

    `uv` are the parameters of the samples. A closed curve ends with the sample with which it
    begins. Each sample is in one polyline.
    """
    if not len(uv):
        return ()
    curves = _Curves.of(spline, axis)
    curve, place = curves.places(spline.in_cells(uv.copy()) * curves.parts)
    order = np.lexsort((place, curve))
    found = np.split(order, np.flatnonzero(np.diff(curve[order])) + 1)
    return tuple(
        part
        for numbers in found
        for part in curves.cut(int(curve[numbers[0]]), numbers, place[numbers])
    )


@dataclass(frozen=True, eq=False)
class _Curves:
    """Linked segments: their ends (k, 2, 2) in refined cells, in the order of their curves.

    `curve` and `place` (k,) are the number of the curve of a segment and its place in that curve.
    `closed` says which curves are closed. `outside` are the places at which a curve leaves the
    trim, by curves.
    """

    ends: Array
    curve: Indices
    place: Array
    closed: list[bool]
    outside: dict[int, Array]
    parts: int

    @classmethod
    def of(cls, spline: Spline, axis: Array) -> _Curves:
        """Trace the curves of a spline."""
        fitting = [x for x in PARTS if x * x * spline.patches <= 4 * MOST_CELLS]
        parts = fitting[0] if fitting else PARTS[-1]
        grid = _Grid.of(spline, axis, parts)
        edges, ends = grid.segments()
        order, turned, curve, closed = _linked(edges)
        ends = np.where(turned[:, None, None], ends[order][:, ::-1], ends[order])
        starts = np.searchsorted(curve, np.arange(len(closed)))
        place = (np.arange(len(curve)) - starts[curve]).astype(np.float64)
        outside: dict[int, Array] = {}
        if spline.trim is not None and len(ends):
            middles = spline.frame[:2] + ends.mean(axis=1) / parts * spline.frame[2:]
            left = ~spline.trim.contains(middles)
            for x in np.unique(curve[left]):
                outside[int(x)] = np.asarray(place[left & (curve == x)] + 0.5)
        ends, curve, place = grid.with_copies(ends, curve, place)
        return cls(ends, curve, place, closed, outside, parts)

    def places(self, positions: Array) -> tuple[Indices, Array]:
        """Return the curves of positions (k, 2), and the places of their feet on these."""
        if not len(self.ends):  # a curve in a corner of a cell that is too small to be seen
            return np.zeros(len(positions), dtype=np.int64), np.zeros(len(positions))
        number = min(CANDIDATES, len(self.ends))
        near = tree_of(self.ends.mean(axis=1)).query(positions, k=number)[1]
        near = near.reshape(len(positions), number)
        start, step = self.ends[near, 0], self.ends[near, 1] - self.ends[near, 0]
        from_start = positions[:, None] - start
        squares = (step * step).sum(axis=2)
        with np.errstate(invalid="ignore", divide="ignore"):
            t = np.clip((from_start * step).sum(axis=2) / squares, 0.0, 1.0)
        t = np.where(squares > 0.0, t, 0.0)
        gaps = ((from_start - t[..., None] * step) ** 2).sum(axis=2)
        best = gaps.argmin(axis=1)
        rows = np.arange(len(positions))
        chosen = near[rows, best]
        return self.curve[chosen], np.asarray(self.place[chosen] + t[rows, best])

    def cut(self, curve: int, numbers: Indices, place: Array) -> list[Indices]:
        """Cut the samples of a curve, in order, where it is outside the trim."""
        outside = self.outside.get(curve)
        is_closed = bool(self.closed) and self.closed[curve]
        if outside is None:
            return [np.append(numbers, numbers[0]) if is_closed and len(numbers) > 1 else numbers]
        gaps = np.searchsorted(outside, place)
        pieces = np.split(numbers, np.flatnonzero(np.diff(gaps)) + 1)
        if is_closed and len(pieces) > 1 and gaps[0] == 0 and gaps[-1] == len(outside):
            pieces[0] = np.concatenate([pieces.pop(), pieces[0]])
        return pieces


@dataclass(frozen=True, eq=False)
class _Grid:
    """The values of N·axis at the vertices, then at the centres, of a criss-cross grid."""

    spline: Spline
    cells: tuple[int, int]
    values: Array

    @classmethod
    def of(cls, spline: Spline, axis: Array, parts: int) -> _Grid:
        """Evaluate N·axis; at poles N vanishes."""
        m, n = (x * parts for x in spline.cells)
        i, j = np.arange(m + 1.0), np.arange(n + 1.0)
        places = np.concatenate([_pairs(i, j), _pairs(i[:-1] + 0.5, j[:-1] + 0.5)])
        grid = cls(spline, (m, n), spline.normals_in_cells(places / parts) @ axis)
        for low, high, sign in grid.seams():  # equal up to rounding
            grid.values[high] = sign * grid.values[low]
        return grid

    @property
    def numbers(self) -> Indices:
        """The numbers of the vertices (m + 1, n + 1)."""
        m, n = self.cells
        return np.arange((m + 1) * (n + 1)).reshape(m + 1, n + 1)

    def segments(self) -> tuple[Indices, Array]:
        """Return the segments: the two edges (k, 2) that each crosses, and its ends (k, 2, 2)."""
        numbers, same = self.numbers, self._same()
        corners = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
        centres = numbers.size + np.arange(len(same) - numbers.size)
        cells = np.stack([*(x.ravel() for x in corners), centres], axis=1)
        positive = self.values >= 0.0
        is_mixed = positive[cells].any(axis=1) & ~positive[cells].all(axis=1)
        cells = cells[is_mixed]
        triangles = np.concatenate([cells[:, [k, (k + 1) % 4, 4]] for k in range(4)])
        number = positive[triangles].sum(axis=1)
        mixed = (number == 1) | (number == 2)
        triangles, is_single = triangles[mixed], number[mixed] == 1
        # Two edges of a triangle are crossed: those at the corner that has a sign of its own.
        corner = (positive[triangles] == is_single[:, None]).argmax(axis=1)
        rows = np.arange(len(triangles))[:, None]
        apex = triangles[rows, corner[:, None]].repeat(2, axis=1)
        others = triangles[rows, (corner[:, None] + [1, 2]) % 3]
        with np.errstate(invalid="ignore", divide="ignore"):
            t = self.values[apex] / (self.values[apex] - self.values[others])
        t = np.where(np.isfinite(t), t, 0.5)[..., None]
        ends = (1.0 - t) * self._place(apex) + t * self._place(others)
        edges = np.sort(np.stack([same[apex], same[others]]), axis=0)
        return edges[0] * len(same) + edges[1], ends

    def _place(self, vertices: Indices) -> Array:
        """Return the places (..., 2) of vertices and centres in cells."""
        m, n = self.cells
        centres = vertices - (m + 1) * (n + 1)
        at_centres = np.stack(np.divmod(centres, n), axis=-1) + 0.5
        at_vertices = np.stack(np.divmod(vertices, n + 1), axis=-1)
        return np.where((centres >= 0)[..., None], at_centres, at_vertices)

    def seams(self) -> Iterator[tuple[Indices, Indices, float]]:
        """Yield for each seam its vertices on both sides, and −1 if the normal changes sides."""
        for axis in (0, 1):
            kind = self.spline.boundary[axis][0]
            low, high = (np.take(self.numbers, x, axis) for x in (0, -1))
            if kind == "periodic":
                yield low, high, 1.0
            elif kind == "mirrored":
                yield low[::-1], high, -1.0

    def _same(self) -> Indices:
        """Return for each vertex or centre the one that is the same point of the surface."""
        same = np.arange(len(self.values))
        for low, high, _ in self.seams():
            same[high] = same[low]
        return same

    def with_copies(
        self, ends: Array, curve: Indices, place: Array
    ) -> tuple[Array, Indices, Array]:
        """Add copies of segments next to seams, beyond them."""
        for axis in (0, 1):
            kind, size = self.spline.boundary[axis][0], self.cells[axis]
            if kind not in ("periodic", "mirrored"):
                continue
            middle = ends.mean(axis=1)[:, axis]
            for shift, near in ((size, middle < 2.0), (-size, middle > size - 2.0)):
                copy = ends[: len(near)][near]
                copy[..., axis] += shift
                if kind == "mirrored":
                    copy[..., 1 - axis] = self.cells[1 - axis] - copy[..., 1 - axis]
                ends = np.concatenate([ends, copy])
                curve = np.concatenate([curve, curve[: len(near)][near]])
                place = np.concatenate([place, place[: len(near)][near]])
        return ends, curve, place


def _pairs(u: Array, v: Array) -> Array:
    """Return all pairs (k, 2) of numbers."""
    return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)


def _linked(edges: Indices) -> tuple[Indices, NDArray[np.bool_], Indices, list[bool]]:
    """Link segments (k, 2), given by the edges that they cross, to curves.

    Returns their order, which of them are turned, their curves, and which curves are closed.
    """
    pairs = edges.tolist()
    at: dict[int, list[int]] = defaultdict(list)
    for number, pair in enumerate(pairs):
        for edge in pair:
            at[edge].append(number)
    begins = {x[0]: edge for edge, x in at.items() if len(x) == 1}  # of open curves
    order: list[int] = []
    turned: list[bool] = []
    curve: list[int] = []
    closed: list[bool] = []
    is_left = [True] * len(pairs)
    for start in [*begins, *range(len(pairs))]:
        number, came = start, begins.get(start, pairs[start][0])
        while is_left[number]:
            is_left[number] = False
            order.append(number)
            curve.append(len(closed))
            first, last = pairs[number]
            turned.append(first != came)
            came = last if first == came else first
            number = next((x for x in at[came] if is_left[x]), number)
        if curve and curve[-1] == len(closed):
            closed.append(start not in begins)
    return np.array(order, dtype=int), np.array(turned, dtype=bool), np.array(curve, int), closed
