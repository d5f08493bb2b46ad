"""The fields of samples, from pairs of a normal and one of its patches."""

from __future__ import annotations

import numpy as np

from ...directions.kernels.vectors import STEP, TILE, row_vector
from ...machine_code.jit import jit
from .lists import NUMBER
from .tile import NORMAL, copy_patch, fill_tile, load_patch, put

__all__ = ["fill_samples"]


@jit
def fill_samples(
    mu, scale, normals, frame, keys, first, last, tile, indices,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Fill the samples first, …, last − 1 of keys (N,), number of the normal << 32 | patch.

    frame = (u0, v0, du, dv): the corner of the domain and the size of a cell in the parameters.
    Absent ones of points (N, 3), directions (N, 3), uv (N, 2), support, gaussian, mean and the two
    indices (N,) are empty. `tile` and `indices` are work arrays, see `new_tile`.
    """
    for begin in range(first, last, TILE):
        count = min(TILE, last - begin)
        for k in range(count):
            key = keys[np.uint64(begin + k)]
            number, patch = key >> 32, key & NUMBER
            indices[k], indices[STEP + k] = number, patch
            put(tile, NORMAL, k, row_vector(normals, np.uint64(number)))
            # Neighbouring normals mostly have the same patches, often two.
            if k > 1 and indices[STEP + k - 2] == patch:
                copy_patch(tile, k, k - 2)
            else:
                load_patch(mu, patch, scale, tile, k)
        fill_tile(
            tile, indices, count, begin, scale, frame,
            points, directions, uv, support, gaussian, mean, normal_index, patch_index,
        )  # fmt: skip
