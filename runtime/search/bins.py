"""Normals sorted by direction into bins, so that neighbouring normals are close in memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.threads import over_ranges, thread_count
from ..kernels import bins as kernels

__all__ = ["sorted_normals"]

# The least number of normals for each thread that sorts them, and the largest number of threads.
FEWEST_NORMALS, MOST_COUNTS = 1 << 16, 8


def sorted_normals(
    normals: NDArray[np.float64], frame: NDArray[np.float64], grid: int, threads: int | None
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the starts of bins (6 grid² + 1,); normals and their numbers (S, 4), in their order.

    The bins are those of a linear map (3, 3), the frame, on the faces of a cube.
    """
    total, count = len(normals), 6 * grid**2
    size = max(FEWEST_NORMALS, -(-total // min(thread_count(threads), MOST_COUNTS)))
    bins = np.empty(total, dtype=np.int32)
    counts = np.empty((-(-total // size), count), dtype=np.int64)
    starts, ordered = np.empty(count + 1, dtype=np.int64), np.empty((total, 4))

    def count_bins(first: int, last: int) -> None:
        kernels.count_bins(normals, frame, grid, first, last, bins, counts[first // size])

    def place(first: int, last: int) -> None:
        kernels.place_normals(normals, bins, first, last, counts[first // size], ordered)

    list(over_ranges(count_bins, total, size, threads))
    kernels.start_bins(counts, starts)
    list(over_ranges(place, total, size, threads))
    return starts, ordered
