"""The writing limit: a compiled loop that stores constants into the arrays of samples.

It is a limit for samplers on the same number of threads.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from types import TracebackType

import numba
import numpy as np
from gaussmap.runtime.base.threads import thread_count

Arrays = tuple[np.ndarray, ...]


@numba.njit(nogil=True, error_model="numpy")
def write(
    first, last, number, index,
    points, normals, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Store the same number everywhere in the samples [first, last)."""
    for k in range(first, last):
        points[k, 0] = number
        points[k, 1] = number
        points[k, 2] = number
        normals[k, 0] = number
        normals[k, 1] = number
        normals[k, 2] = number
        uv[k, 0] = number
        uv[k, 1] = number
        support[k] = number
        gaussian[k] = number
        mean[k] = number
        normal_index[k] = index
        patch_index[k] = index


def new_arrays(count: int) -> Arrays:
    """Return points, normals, uv, support, K, H, and two indices of `count` samples, unset."""
    floats = [np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 2))]
    floats += [np.empty(count) for _ in range(3)]
    return *floats, np.empty(count, np.int64), np.empty(count, np.int64)


class Writers:
    """A context manager with threads that write samples; it is called with their arrays."""

    def __init__(self, threads: int | None = None) -> None:
        """Use `threads` threads, by default the number that `gm.sample` uses."""
        self.threads = thread_count(threads)

    def __enter__(self) -> Writers:
        """Start the threads."""
        self.pool = ThreadPoolExecutor(self.threads)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """End them."""
        self.pool.shutdown()

    def __call__(self, arrays: Arrays) -> Arrays:
        """Fill the arrays."""
        count = len(arrays[0])
        ends = [count * k // self.threads for k in range(self.threads + 1)]
        list(self.pool.map(lambda a, b: write(a, b, 1.0, 1, *arrays), ends, ends[1:]))
        return arrays
