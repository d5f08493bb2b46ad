"""Discrete Voronoi cells of samples, on points finer than the candidates."""

from __future__ import annotations

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.threads import over_ranges
from .candidates import Block, Candidates
from .cells import SIDES, Cells
from .kernels.centres import FINER, add_moments, begin_lists, find_nearest, find_widest
from .kernels.greedy import Lists, note_samples

__all__ = ["Voronoi"]

# The list of a candidate has at most this many samples, which may be the nearest ones in its cell.
MOST = 16


class Voronoi:
    """The nearest samples of a fine grid of points in the cells of candidates.

    The distances of the candidates from the samples (N, 6) are known. The fine points are those of
    kernels/centres.py, linear in the parameters. In a cell that a boundary intersects, or without a
    sample within radius/√w, only the place counts. The lists remain valid for samples that move by
    less than margin/√w.
    """

    def __init__(
        self, candidates: Candidates, cells: Cells, samples: Array, radius: float, margin: float
    ) -> None:
        self.cells, numbers = cells, cells.numbers
        numbers[~cells.whole, SIDES] = 0.0  # nothing else reads these arrays, and a copy is large
        samples = np.ascontiguousarray(samples)

        def listed(first: int, last: int) -> tuple[Block, Lists]:
            part, count = candidates.parts[first], len(candidates.parts[first].order)
            near, counts = np.empty((count, MOST), np.int32), np.zeros(count, np.int32)
            lists = Lists(near, counts, np.empty(count), part.order, numbers)
            begin_lists(part.grids, lists, margin)
            note_samples(part.grids, radius, lists, samples)
            return part, lists

        self._parts = list(over_ranges(listed, len(candidates.parts), 1, candidates.threads))

    def centres(self, samples: Array, first: int) -> tuple[Indices, Indices, Array]:
        """Return the samples from index `first` on that have a Voronoi cell, with its centre.

        The centre is given by a cell of the candidates, and parameters (k, 2) in it.
        """
        moments, work = np.zeros((len(samples), 4)), np.empty((5, FINER**2))
        for part, lists in self._parts:
            add_moments(part.grids.candidates, lists, samples, work, moments)
        found = np.full((len(moments), 2), -1, dtype=np.int64)
        squares = np.where(moments[:, 3] > 0.0, np.inf, -1.0)
        squares[:first] = -1.0
        points = moments[:, :3] / np.where(squares > 0.0, moments[:, 3], 1.0)[:, None]
        for part, lists in self._parts:
            find_nearest(part.grids.candidates, lists, points, found, squares)
        moved = np.flatnonzero(found[:, 0] >= 0)
        return moved, found[moved, 0], self._parameters(*found[moved].T)

    def widest(self, samples: Array, least: float) -> tuple[Indices, Array]:
        """Return the cells with a point at least least/√w from all samples.

        Also return the farthest such point of each cell, by its parameters (k, 2).
        """
        rows, places, work = list[Indices](), list[Indices](), np.empty((5, FINER**2))
        for part, lists in self._parts:
            found = np.empty(len(part.order), np.int64)
            find_widest(part.grids.candidates, lists, samples, least, work, found)
            far = found > -2
            rows.append(part.order[far].astype(np.int64))
            places.append(found[far])
        chosen = np.concatenate(rows)
        return chosen, self._parameters(chosen, np.concatenate(places))

    def _parameters(self, rows: Indices, numbers: Indices) -> Array:
        """Return the parameters (k, 2) of fine points in cells, by their indices (k,)."""
        cells = self.cells[rows]
        finer = cells.whole & (numbers >= 0)
        steps = (np.stack(np.divmod(numbers, FINER), axis=1) + 0.5) / FINER - 0.5
        offsets = np.where(finer[:, None], steps, 0.0)
        return cells.places + offsets * (cells.boxes[:, 2:] - cells.boxes[:, :2])
