"""Candidates for samples in spatial hash grids, one grid for each power of two of 1/√density.

The width of gaps varies with the sizing function 1/√w: a search in cells of one size would visit
far too many candidates or cells. The buckets of all grids share one array.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ....runtime.machine_code.jit import inline, jit

# The width of the cells of a grid, relative to the widest gap that is searched in it.
CELL = 2.0
# The number of grids, one for each power of two that 1/√density can have.
LEVELS = 1100
# The columns of candidates: point, unit normal, density, squared distance.
NORMAL, DENSITY, SQUARE = 3, 6, 7


class HashGrids(NamedTuple):
    """Candidates, sorted by the buckets of their cells.

    candidates: (M, 8) float64, point, unit normal, density w, and w times the squared distance to
        the nearest sample so far, or −1 for a candidate without a normal.
    starts: (buckets + 1,) int32, the index of the first candidate of each bucket; `buckets` is a
        power of two.
    sizes: (grids,) the largest 1/√w of each grid.
    box: (2, 3) the smallest and largest coordinates of the points.
    radius: the cells of a grid are CELL * radius * size wide, for the size of the grid.
    """

    candidates: np.ndarray
    starts: np.ndarray
    sizes: np.ndarray
    box: np.ndarray
    radius: float


@inline
def level_of(density):
    """Return the index of the grid for a density; cells of the next grid are twice as wide."""
    return LEVELS // 2 - (math.frexp(density)[1] >> 1)


@inline
def bucket_of(level, i, j, k, buckets):
    """Return the index of the bucket of the cell (i, j, k) of a grid; several cells may share it.

    The buckets of 4 × 4 × 4 cells are consecutive: neighbours in space are close in memory.
    """
    block = (i >> 2) * 73856093 ^ (j >> 2) * 19349663 ^ (k >> 2) * 83492791 ^ level * 49979687
    return ((block << 6) + ((i & 3) << 4) + ((j & 3) << 2) + (k & 3)) & (buckets - 1)


@jit
def measure(rows, box, sizes):
    """Write the bounding box of rows (M, 8), and the largest 1/√w of each grid to sizes (LEVELS,).

    Returns the indices of the finest and of the coarsest grid.
    """
    finest = LEVELS
    coarsest = 0
    for x in range(3):
        box[0, x] = box[1, x] = rows[0, x] if rows.shape[0] > 0 else 0.0
    for k in range(rows.shape[0]):
        level = level_of(rows[k, DENSITY])
        finest = min(finest, level)
        coarsest = max(coarsest, level)
        sizes[level] = max(sizes[level], 1.0 / math.sqrt(rows[k, DENSITY]))
        for x in range(3):
            box[0, x] = min(box[0, x], rows[k, x])
            box[1, x] = max(box[1, x], rows[k, x])
    return finest, coarsest


@jit
def sort_candidates(rows, finest, grids, buckets, order):
    """Sort rows (M, 8) by their buckets into the candidates of grids: a counting sort.

    The starts must be 0 on entry. After sorting, candidate k is row order[k] of `rows`. `buckets`
    (M,) is a work array.
    """
    starts = grids.starts
    for k in range(rows.shape[0]):
        level = level_of(rows[k, DENSITY]) - finest
        cell = CELL * grids.radius * grids.sizes[level]
        buckets[k] = bucket_of(
            level,
            int(math.floor(rows[k, 0] / cell)),
            int(math.floor(rows[k, 1] / cell)),
            int(math.floor(rows[k, 2] / cell)),
            starts.size - 1,
        )
        starts[buckets[k]] += 1
    total = 0
    for bucket in range(starts.size):
        total += starts[bucket]
        starts[bucket] = total
    for k in range(rows.shape[0] - 1, -1, -1):
        starts[buckets[k]] -= 1
        at = starts[buckets[k]]
        order[at] = k
        for x in range(SQUARE):
            grids.candidates[at, x] = rows[k, x]
        regular = rows[k, 3] != 0.0 or rows[k, 4] != 0.0 or rows[k, 5] != 0.0
        grids.candidates[at, SQUARE] = math.inf if regular else -1.0
