"""The parabolic curves of a spline: lines inside patches, and edges where K changes sign."""

from __future__ import annotations

from collections.abc import Hashable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...generated import spline as grid
from ...runtime.spline.spline import Spline
from .chains import Segment, joined
from .classes import PatchClass, classes_of
from .parabolic_lines import lines_of, pieces_of
from .patches import Patches

__all__ = ["polylines_of"]

Array = NDArray[np.float64]
# The corners of the triangle by their parameters, and its edges.
CORNERS = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
EDGES = ((0, 1), (1, 2), (2, 0))
# A point of an edge within this distance of a corner, relative to the edge, is the corner.
AT_CORNER = 1e-9
SIGNS = {PatchClass.ELLIPTIC: 1, PatchClass.HYPERBOLIC: -1}


def polylines_of(spline: Spline) -> list[tuple[Array, bool]]:
    """Return the polylines (k, 2) where the Gaussian curvature vanishes or changes sign.

    They are exact: in each patch and along its edges these curves are straight in the parameters.
    """
    patches = Patches.of_spline(spline)
    classes = classes_of(patches)
    plane = _Plane(spline)
    splits = {
        int(k): _Split(patches[k : k + 1]) for k in np.flatnonzero(classes == PatchClass.MIXED)
    }
    segments = [
        segment
        for patch, split in splits.items()
        for ends in split.segments
        for segment in [plane.segment(patch, ends)]
    ]
    segments += _edges(plane, classes, splits)
    return [(spline.frame[:2] + x * spline.frame[2:], closed) for x, closed in joined(segments)]


class _Split:
    """A mixed patch: its parabolic segments, and the sign of K along its edges."""

    def __init__(self, patch: Patches) -> None:
        lines = lines_of(patch)
        self.segments = [line.segment for line in lines if line.segment is not None]
        self.pieces = pieces_of(patch)

    def breaks(self, edge: int) -> list[float]:
        """Return the ends of segments on an edge, as parameters between 0 and 1."""
        start, end = CORNERS[list(EDGES[edge])]
        found = []
        for place in (place for ends in self.segments for place in ends):
            share = float((place - start) @ (end - start) / ((end - start) @ (end - start)))
            apart = np.abs(start + share * (end - start) - place).max()
            if apart <= AT_CORNER and AT_CORNER < share < 1.0 - AT_CORNER:
                found.append(share)
        return found

    def sign(self, place: Array) -> int:
        """Return the sign of K at a point: that of the piece in which it lies deepest."""
        return max(self.pieces, key=lambda piece: _depth(piece.corners, place)).sign


def _depth(polygon: Array, place: Array) -> float:
    """Return the least distance of a point from the sides of a convex polygon, negative outside."""
    along = np.roll(polygon, -1, axis=0) - polygon
    to = place - polygon
    heights = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]
    return float((heights / np.linalg.norm(along, axis=1)).min())


class _Plane:
    """The parameter plane of a spline in units of cells, with keys for its vertices and edges."""

    def __init__(self, spline: Spline) -> None:
        self.columns = spline.cells[1]
        self.corners = grid.CORNERS
        self.periods = [
            2 * count if ends[0] == "periodic" else 0
            for count, ends in zip(spline.cells, spline.boundary, strict=True)
        ]

    def place(self, patch: int, local: Array) -> Array:
        """Return points (..., 2), in cells, from their parameters in a patch."""
        i, j = divmod(patch // 4, self.columns)
        return np.array([i + 0.5, j + 0.5]) + local @ self.corners[patch % 4]

    def vertex(self, patch: int, corner: int) -> tuple[int, ...]:
        """Return the key of a corner: its coordinates in half cells, modulo the periods."""
        x = np.round(2.0 * self.place(patch, CORNERS[corner])).astype(int).tolist()
        return tuple(a % period if period else a for a, period in zip(x, self.periods, strict=True))

    def edge(self, patch: int, edge: int) -> tuple[Hashable, bool]:
        """Return the key of an edge, and whether this patch traverses it in reverse.

        In a periodic direction with few cells two edges may have the same ends; the middle in the
        key distinguishes them.
        """
        first, last = EDGES[edge]
        ends = self.vertex(patch, first), self.vertex(patch, last)
        middle = 4.0 * self.place(patch, CORNERS[[first, last]].mean(axis=0))
        name = tuple(
            a % (2 * period) if period else a
            for a, period in zip(np.round(middle).astype(int).tolist(), self.periods, strict=True)
        )
        step = self.place(patch, CORNERS[last]) - self.place(patch, CORNERS[first])
        return ("edge", name, tuple(sorted(ends))), tuple(step.tolist()) < (0.0, 0.0)

    def node(self, patch: int, local: Array) -> Hashable:
        """Return the key of a point on the border of a patch."""
        weights = np.array([local[0], local[1], 1.0 - local[0] - local[1]])
        corner = int(weights.argmax())
        if weights[corner] >= 1.0 - AT_CORNER:
            return self.vertex(patch, corner)
        opposite = int(weights.argmin())
        edge = {2: 0, 0: 1, 1: 2}[opposite]
        first, last = EDGES[edge]
        name, turned = self.edge(patch, edge)
        share = weights[last] / (weights[first] + weights[last])
        return name, round(float(1.0 - share if turned else share) / AT_CORNER)

    def segment(self, patch: int, ends: Array) -> Segment:
        """Return the segment between two points on the border of a patch."""
        return self.node(patch, ends[0]), self.node(patch, ends[1]), self.place(patch, ends)


def _edges(plane: _Plane, classes: NDArray[np.int8], splits: dict[int, _Split]) -> list[Segment]:
    """Return the parts of edges across which the curvature changes its sign."""
    sides: dict[Hashable, list[tuple[int, int]]] = {}
    for patch, edge in _interesting(plane, classes):
        sides.setdefault(plane.edge(patch, edge)[0], []).append((patch, edge))
    segments = []
    for both in sides.values():
        if len(both) != 2:
            continue
        (patch, edge), (other, other_edge) = both
        turned = plane.edge(patch, edge)[1] != plane.edge(other, other_edge)[1]
        breaks = {0.0, 1.0}
        if patch in splits:
            breaks |= set(splits[patch].breaks(edge))
        if other in splits:
            breaks |= {1.0 - x if turned else x for x in splits[other].breaks(other_edge)}
        shares = sorted(breaks)
        for low, high in pairwise(shares):
            middle = 0.5 * (low + high)
            here = _sign(classes, splits, patch, _on_edge(edge, middle))
            there = _sign(
                classes, splits, other, _on_edge(other_edge, 1.0 - middle if turned else middle)
            )
            if here * there < 0 and high - low > AT_CORNER:
                ends = np.array([_on_edge(edge, low), _on_edge(edge, high)])
                segments.append(plane.segment(patch, ends))
    return segments


def _interesting(plane: _Plane, classes: NDArray[np.int8]) -> list[tuple[int, int]]:
    """Return the edges (patch, edge) that are not surrounded by patches of one sign."""
    curved = np.isin(classes, (PatchClass.ELLIPTIC, PatchClass.HYPERBOLIC, PatchClass.MIXED))
    if len(np.unique(classes[curved])) < 2 and PatchClass.MIXED not in classes:
        return []
    grid = classes.reshape(-1, plane.columns, 4)
    around = np.pad(grid, [(1, 1), (1, 1), (0, 0)], mode="wrap")
    alike = np.ones(grid.shape[:2], dtype=bool)
    for di in range(3):
        for dj in range(3):
            shifted = around[di : di + grid.shape[0], dj : dj + grid.shape[1]]
            alike &= (shifted == grid[..., :1]).all(axis=2)
    alike &= grid[..., 0] != PatchClass.MIXED
    cells = np.flatnonzero(~alike.ravel())
    return [
        (int(4 * cell + turn), edge) for cell in cells for turn in range(4) for edge in range(3)
    ]


def _on_edge(edge: int, share: float) -> Array:
    first, last = EDGES[edge]
    return (1.0 - share) * CORNERS[first] + share * CORNERS[last]


def _sign(classes: NDArray[np.int8], splits: dict[int, _Split], patch: int, place: Array) -> int:
    if patch in splits:
        return splits[patch].sign(place)
    return SIGNS.get(PatchClass(int(classes[patch])), 0)
