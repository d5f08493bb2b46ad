"""The tree of cones of normals of a spline: the search for few normals, in few of its patches."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..base.threads import over_ranges
from ..kernels import cone_tree as kernels
from ..kernels.search import Coefficients
from ..kernels.strips import Strip

__all__ = ["ConeTree"]

# Nodes are rounded to single precision; cones are wider by more than its rounding.
SINGLE_ERROR = 2.0**-22
CELLS_AT_A_TIME, NORMALS_AT_A_TIME = 1 << 12, 1 << 12
# The initial room for keys, for each normal and in all.
ROOM, LEAST_ROOM = 8, 64


@dataclass(frozen=True, eq=False)
class ConeTree:
    """Cones that hold all normals of patches, of cells, and of blocks of cells.

    `flat` are the patches that may be developable.
    """

    coefficients: Coefficients
    tree: kernels.Tree
    flat: NDArray[np.int64]

    @classmethod
    def of(cls, coefficients: Coefficients, threads: int | None) -> ConeTree:
        """Return the tree of a spline."""
        rows, columns = (x - 2 for x in coefficients.mu.shape[:2])
        cells, levels = rows * columns, [(4 * rows * columns, rows, columns)]
        while rows * columns > 1:
            start = levels[-1][0] + rows * columns
            rows, columns = (rows + 1) // 2, (columns + 1) // 2
            levels.append((start, rows, columns))
        cones, bounds = np.empty((levels[-1][0] + 1, 4)), np.empty(4 * cells)
        flat = np.empty(4 * cells, dtype=np.bool_)

        def work(first: int, last: int) -> None:
            kernels.cones_of_cells(coefficients, first, last, Strip.new(), cones, bounds, flat)

        list(over_ranges(work, cells, CELLS_AT_A_TIME, threads))
        for (start, m, n), (at, _, _) in pairwise(levels):
            kernels.cones_of_blocks(cones, start, m, n, at)
        half = cones[:, 3]
        cones[:, 3] = np.where(half < np.pi, np.cos(half) - SINGLE_ERROR, kernels.EVERYTHING)
        tree = kernels.Tree(cones.astype(np.float32), np.array(levels), bounds)
        return cls(coefficients, tree, np.flatnonzero(flat))

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The errors (P,) of the forms of the patches."""
        return self.tree.bounds

    def search(
        self, normals: NDArray[np.float64], threads: int | None
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the hits at normals (S, 3), certain and undecided ones, in ascending order.

        They are keys, number of the patch << 32 | number of the normal.
        """

        def work(first: int, last: int) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
            stack = np.empty((4 * len(self.tree.levels), 3), np.int64)
            parts, room = [], ROOM * (last - first) + LEAST_ROOM
            while first < last:
                found = kernels.Keys.new(room)
                first = kernels.search_tree(
                    self.coefficients, self.tree, normals, first, last, stack, found
                )
                certain, undecided = found.counts
                parts.append((found.certain[:certain], found.undecided[:undecided]))
                room *= 2
            return parts

        ranges = over_ranges(work, len(normals), NORMALS_AT_A_TIME, threads)
        certain, undecided = zip(*(part for parts in ranges for part in parts), strict=True)
        return np.sort(np.concatenate(certain)), np.sort(np.concatenate(undecided))
