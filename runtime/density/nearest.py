"""The samples nearest to places on the same side of the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.threads import over_ranges
from ..base.trees import tree_of
from ..kernels.hash_grids import CELL, HashGrids, measure, sort_candidates
from ..kernels.hash_grids import LEVELS as POWERS
from ..kernels.nearest import nearest_samples

__all__ = ["NearestSamples"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Cells are about as wide as samples are apart. Samples are searched in RINGS of them around each
# place; where that is not enough, in cells that are wider by WIDER.
RINGS, WIDER = 2, 4.0
ROWS_AT_A_TIME = 1 << 11


class NearestSamples:
    """Samples (N, 6), point and unit normal, among which those nearest to places are searched."""

    def __init__(self, samples: Array, threads: int | None) -> None:
        """Sort the samples into a grid."""
        self.samples, self.threads = np.empty((len(samples), 8)), threads
        self.samples[:, :6], self.samples[:, 6] = samples, 1.0
        box, sizes = np.empty((2, 3)), np.zeros(POWERS)
        self._level = measure(self.samples, box, sizes)[0]
        self._box, self._sizes = box, sizes[self._level : self._level + 1].copy()
        self._grids = [self._grid(self._spacing())]

    def nearest(self, rows: Array, distance: float) -> tuple[Array, Indices]:
        """Return the distances and the numbers of the samples nearest to rows (M, 8).

        Samples count on the same side of the surface only: the angle between the normals is 90
        degrees at most. Only where there is none within a distance, any nearest sample is taken.
        """
        squares, numbers = np.empty(len(rows)), np.empty(len(rows), dtype=np.int64)
        left, level, reach = np.arange(len(rows)), 0, 0.0
        while len(left) and reach < distance and len(self.samples):
            reach = RINGS * self._cell(level)
            squares[left], numbers[left] = self._in_rings(rows[left], level)
            left, level = left[numbers[left] < 0], level + 1
        distances = np.sqrt(squares)
        left = np.flatnonzero((numbers < 0) | (distances > distance))
        if len(left):
            distances[left], numbers[left] = tree_of(self.samples[:, :3]).query(rows[left, :3])
        return distances, numbers

    def _in_rings(self, rows: Array, level: int) -> tuple[Array, Indices]:
        """Return the squared distances and the numbers, −1 where they are not known."""
        squares, numbers = np.empty(len(rows)), np.empty(len(rows), dtype=np.int64)
        grids, order = self._grids[level]

        def work(first: int, last: int) -> None:
            nearest_samples(grids, order, RINGS, rows, first, last, squares, numbers)

        for _ in over_ranges(work, len(rows), ROWS_AT_A_TIME, self.threads):
            pass
        return squares, numbers

    def _cell(self, level: int) -> float:
        """Return the width of the cells of a level, and make its grid if there is none yet."""
        width = WIDER**level * CELL * self._grids[0][0].radius
        if level == len(self._grids):
            self._grids.append(self._grid(width))
        return width

    def _grid(self, cell: float) -> tuple[HashGrids, NDArray[np.int32]]:
        """Sort the samples into a grid of cells of a width."""
        count = len(self.samples)
        starts = np.zeros((1 << max(count - 1, 1).bit_length()) + 1, dtype=np.int32)
        order, buckets = np.empty(count, dtype=np.int32), np.empty(count, dtype=np.int32)
        grids = HashGrids(np.empty((count, 8)), order, starts, self._sizes, self._box, cell / CELL)
        sort_candidates(self.samples, self._level, grids, buckets, order)
        return grids, order

    def _spacing(self) -> float:
        """Return about how far samples are apart that are all over the sides of their box."""
        a, b, c = self._box[1] - self._box[0]
        count = max(len(self.samples), 1)
        return float(max(np.sqrt((a * b + b * c + c * a) / count), (a + b + c) / count)) or 1.0
