"""The fields of samples, from pairs of a patch and one of its normals."""

from __future__ import annotations

import numpy as np

from ..machine_code.jit import inline, jit, loop
from .tile import NORMAL, STEP, TILE, fill_tile, load_patch, put
from .vectors import row_vector

__all__ = ["fill_samples"]

# Normals of consecutive hits are scattered in memory; this many are prefetched.
PREFETCH_DISTANCE = 512
# The bits of a packed hit with the position of its normal in the order of the bins.
PLACE = 0xFFFFFFFF
# Typed, since Numba compiles a function anew for each literal number in its arguments.
ZERO = np.int64(0)


@jit
def fill_samples(
    mu, scale, normals, frame, pairs, start, tile, indices,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Fill the samples from number `start` on from pairs (k, 2) of patch and packed hit.

    normals (S, 4) are in the order of the bins. frame = (u0, v0, du, dv): the corner of the domain
    and the size of a cell in the parameters. Absent ones of points (k, 3), directions (k, 3),
    uv (k, 2), support, gaussian, mean and the two indices (k,) are empty. `tile` and `indices` are
    work arrays, see `new_tile`.
    """
    loaded = -1
    for begin in range(0, pairs.shape[0], TILE):
        count = min(TILE, pairs.shape[0] - begin)
        if pairs[begin, 0] != loaded or pairs[begin + count - 1, 0] != loaded:
            loaded = load_patches(mu, scale, pairs, begin, count, tile)
        if begin % PREFETCH_DISTANCE == 0:
            tile[STEP - 1] = prefetch(normals, pairs, begin + PREFETCH_DISTANCE)
        for k in range(count):
            indices[k] = pairs[begin + k, 1] >> 32
            indices[STEP + k] = pairs[begin + k, 0]
            put(tile, NORMAL, k, row_vector(normals, np.uint64(pairs[begin + k, 1] & PLACE)))
        fill_tile(
            tile, indices, count, start + begin, scale, frame,
            points, directions, uv, support, gaussian, mean, normal_index, patch_index,
        )  # fmt: skip


@inline
def prefetch(normals, pairs, first):
    """Read PREFETCH_DISTANCE normals to bring them into the cache ahead of their use."""
    total = 0.0
    for k in range(first, min(first + PREFETCH_DISTANCE, pairs.shape[0])):
        total += normals[np.uint64(pairs[np.uint64(k), 1] & PLACE), 0]
    return total


@loop
def load_patches(mu, scale, pairs, begin, count, tile):
    """Write the patches of the samples of a tile; return the patch if all have the same, or −1."""
    first, last = pairs[begin, 0], pairs[begin + count - 1, 0]
    end = ZERO
    while end < count:
        start = end
        number = pairs[begin + start, 0]
        while end < count and pairs[begin + end, 0] == number:
            end += 1
        load_patch(mu, number, scale, tile, start, TILE if first == last else end)
    return first if first == last else -1
