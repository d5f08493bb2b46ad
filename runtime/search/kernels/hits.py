"""The fields of samples at hits, which are pairs of a normal and a patch that has it.

A tile is a batch of samples, stored by rows of one array for vectorized loops. Its rows are the
normal, the coefficients around the patch, the position of the patch, and the resulting fields.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.patch import sample
from ....generated.spline import CORNERS, NEIGHBOURS, SCALE, triangle
from ....generated.vectors import Vector
from ...directions.kernels.vectors import STEP, TILE, dot, row_vector, set_row, whole_vectors
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import jit, long_vectors, loop
from ...spline.kernels.patch import (
    curvatures_of_patch,
    normal_of_patch,
    patch_vectors,
    point_of_patch,
    vector_at,
)
from .lists import NUMBER

# The number of rows of a tile, of STEP entries each, and where its parts start. The starts are
# typed, since Numba compiles a function anew for each literal number in its arguments.
ROWS = 38
ONE_ROW, TWO_ROWS = np.uint64(STEP), np.uint64(2 * STEP)
NORMAL, COEFFICIENTS, PLACE, POINT, U, V, SUPPORT, GAUSSIAN, MEAN = (
    np.int64(STEP * row) for row in (0, 3, 21, 30, 33, 34, 35, 36, 37)
)
NORMAL_INDEX, PATCH_INDEX, THREE_ROWS = np.int64(0), np.int64(STEP), np.int64(3 * STEP)
# For each patch of a cell, the rows and columns of the coefficients that `triangle` takes, relative
# to the first of the nine coefficients around the cell. The array is contiguous, since machine code
# that refers to other arrays cannot be cached.
AROUND = np.ascontiguousarray(NEIGHBOURS[:, [0, 1, 2, 3, 5, 7]] + 1, np.uint64)


class Place(NamedTuple):
    """The position of a patch in space and in the domain.

    `centre` is the coefficient of its cell, (cell_u, cell_v) the centre of the cell in the domain,
    in cells. The vectors (u_s, u_t) and (v_s, v_t) lead from this centre to the corners of the
    patch where its own parameters are u = 1 and v = 1.
    """

    centre: Vector
    cell_u: float
    cell_v: float
    u_s: float
    u_t: float
    v_s: float
    v_t: float


def new_tile() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return arrays for a tile: one with all its rows, and one with two rows of indices."""
    return np.zeros(ROWS * STEP), np.zeros(2 * STEP, np.int64)


@loop
def vector_in(tile, row, k):
    """Return the vector of sample k in three rows of a tile, from `row` on."""
    at = np.uint64(row + k)  # unsigned: no check for negative indices
    return Vector(tile[at], tile[at + ONE_ROW], tile[at + TWO_ROWS])


@loop
def put(tile, row, k, v):
    """Write the vector of sample k to three rows of a tile, from `row` on."""
    at = np.uint64(row + k)
    tile[at] = v.x
    tile[at + ONE_ROW] = v.y
    tile[at + TWO_ROWS] = v.z


@loop
def place_in(mu, i, j, turn):
    """Return the position of the patch `turn` of the cell (i, j)."""
    return Place(
        vector_at(mu, i + 1, j + 1),
        i + 0.5,
        j + 0.5,
        CORNERS[turn, 0, 0],
        CORNERS[turn, 0, 1],
        CORNERS[turn, 1, 0],
        CORNERS[turn, 1, 1],
    )


@loop
def load_patch(mu, number, scale, tile, k):
    """Write the coefficients around the patch of sample k of a tile, and its position."""
    columns, patch = np.uint64(mu.shape[1] - 2), np.uint64(number)  # unsigned divisions are faster
    cell, turn = patch >> np.uint64(2), patch & np.uint64(3)
    i = cell // columns
    j = cell - i * columns
    place = place_in(mu, np.int64(i), np.int64(j), turn)
    c = place.centre
    for m in range(6):
        p, q = i + AROUND[turn, m, 0], j + AROUND[turn, m, 1]
        v = Vector(
            scale * (mu[p, q, 0] - c.x), scale * (mu[p, q, 1] - c.y), scale * (mu[p, q, 2] - c.z)
        )
        put(tile, COEFFICIENTS + m * THREE_ROWS, k, v)
    put(tile, PLACE, k, c)
    tile[PLACE + 3 * STEP + k] = place.cell_u
    tile[PLACE + 4 * STEP + k] = place.cell_v
    tile[PLACE + 5 * STEP + k] = place.u_s
    tile[PLACE + 6 * STEP + k] = place.u_t
    tile[PLACE + 7 * STEP + k] = place.v_s
    tile[PLACE + 8 * STEP + k] = place.v_t


@loop
def copy_patch(tile, k, source):
    """Copy the patch of the sample `source` of a tile to sample k; see `load_patch`."""
    for row in range(COEFFICIENTS, POINT, STEP):
        tile[np.uint64(row + k)] = tile[np.uint64(row + source)]


@loop
def on_surface(place, frame, size, n, u, v, x, K, H):
    """Return point, parameters, support and curvatures of a sample on the unscaled surface.

    `x`, `K` and `H` are those of the patch scaled by `size`; u and v are the patch's parameters.
    """
    unit = 1.0 / size
    point = Vector(
        place.centre.x + x.x * unit, place.centre.y + x.y * unit, place.centre.z + x.z * unit
    )
    s = frame[0] + frame[2] * (place.cell_u + u * place.u_s + v * place.v_s)
    t = frame[1] + frame[3] * (place.cell_v + u * place.u_t + v * place.v_t)
    return point, s, t, dot(n, point), K * size * size, H * size


@loop
def evaluate_tile(tile, count, frame, size, curved):
    """Evaluate `count` samples of a tile. The loop has no branches, so that it is vectorized.

    If `curved` is None, the code is compiled without curvatures.
    """
    long_vectors()
    frame = (frame[0], frame[1], frame[2], frame[3])
    for k in range(count):
        n = vector_in(tile, NORMAL, k)
        patch = triangle(
            vector_in(tile, COEFFICIENTS, k),
            vector_in(tile, COEFFICIENTS + 3 * STEP, k),
            vector_in(tile, COEFFICIENTS + 6 * STEP, k),
            vector_in(tile, COEFFICIENTS + 9 * STEP, k),
            vector_in(tile, COEFFICIENTS + 12 * STEP, k),
            vector_in(tile, COEFFICIENTS + 15 * STEP, k),
        )
        place = Place(
            vector_in(tile, PLACE, k),
            tile[PLACE + 3 * STEP + k],
            tile[PLACE + 4 * STEP + k],
            tile[PLACE + 5 * STEP + k],
            tile[PLACE + 6 * STEP + k],
            tile[PLACE + 7 * STEP + k],
            tile[PLACE + 8 * STEP + k],
        )
        u, v, x, _, K, H = sample(patch, n)
        point, s, t, h, K, H = on_surface(place, frame, size, n, u, v, x, K, H)
        put(tile, POINT, k, point)
        tile[U + k] = s
        tile[V + k] = t
        tile[SUPPORT + k] = h
        if curved is not None:
            tile[GAUSSIAN + k] = K
            tile[MEAN + k] = H


@loop
def store(k, point, n, s, t, h, K, H, points, directions, uv, support, gaussian, mean):
    """Write the fields of sample k to the arrays; empty arrays are left out."""
    if len(points) > 0:
        set_row(points, k, point)
    if len(directions) > 0:
        set_row(directions, k, n)
    if len(uv) > 0:
        uv[k, 0] = s
        uv[k, 1] = t
    if len(support) > 0:
        support[k] = h
    if len(gaussian) > 0:
        gaussian[k] = K
    if len(mean) > 0:
        mean[k] = H


@loop
def fill_tile(
    tile, indices, count, start, scale, frame,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Evaluate `count` samples of a tile, and store them from index `start` on."""
    # The loop works on whole SIMD vectors; additional samples in the last one are not stored.
    full = whole_vectors(count)
    if len(gaussian) + len(mean) > 0:
        evaluate_tile(tile, full, frame, SCALE * scale, True)
    elif len(points) + len(uv) + len(support) > 0:
        evaluate_tile(tile, full, frame, SCALE * scale, None)
    write_vectors(tile, POINT, count, start, points)
    write_vectors(tile, NORMAL, count, start, directions)
    if len(uv) > 0:
        write_numbers(tile, U, count, start, uv[:, 0])
        write_numbers(tile, V, count, start, uv[:, 1])
    write_numbers(tile, SUPPORT, count, start, support)
    write_numbers(tile, GAUSSIAN, count, start, gaussian)
    write_numbers(tile, MEAN, count, start, mean)
    write_numbers(indices, NORMAL_INDEX, count, start, normal_index)
    write_numbers(indices, PATCH_INDEX, count, start, patch_index)


@loop
def write_vectors(tile, row, count, start, field):
    """Write the vectors in three rows of a tile to a field, from index `start` on."""
    if len(field) > 0:
        for k in range(count):
            set_row(field, np.uint64(start + k), vector_in(tile, row, k))


@loop
def write_numbers(tile, row, count, start, field):
    """Write the numbers in a row of a tile to a field, from index `start` on."""
    if len(field) > 0:
        for k in range(count):
            field[np.uint64(start + k)] = tile[np.uint64(row + k)]


@jit
def fill_samples(
    mu, scale, normals, frame, keys, first, last, tile, indices,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Write the fields of the samples with the keys [first, last).

    A key is (index of the normal) << 32 | index of the patch. `frame` is (u0, v0, du, dv): the
    corner of the domain and the size of a cell. The fields are points (N, 3), directions (N, 3), uv
    (N, 2), support, gaussian, mean and two indices (N,); arrays that are not requested are empty.
    `tile` and `indices` are work arrays, see `new_tile`.
    """
    for begin in range(first, last, TILE):
        count = min(TILE, last - begin)
        for k in range(count):
            key = keys[np.uint64(begin + k)]
            number, patch = key >> 32, key & NUMBER
            indices[k], indices[STEP + k] = number, patch
            put(tile, NORMAL, k, row_vector(normals, np.uint64(number)))
            # If normals have two hits each, samples k and k − 2 often have the same patch.
            if k > 1 and indices[STEP + k - 2] == patch:
                copy_patch(tile, k, k - 2)
            else:
                load_patch(mu, patch, scale, tile, k)
        fill_tile(
            tile, indices, count, begin, scale, frame,
            points, directions, uv, support, gaussian, mean, normal_index, patch_index,
        )  # fmt: skip


@jit
def fill_known(
    mu, scale, normals, frame, which, keys, local,
    points, directions, uv, support, gaussian, mean,
):  # fmt: skip
    """Write the fields of the samples `which` (k,) at known parameters; see `fill_samples`.

    `keys` (k,) are the keys of the samples. The first columns of `local` (k, 6) are u, v, the sign
    of K, and the parameters at which curvatures are evaluated: u, v, or those of a nearby point if
    the point is singular.
    """
    columns = mu.shape[1] - 2
    frame = (frame[0], frame[1], frame[2], frame[3])
    for row in range(which.size):
        i, j, turn = place_of(keys[row] & NUMBER, columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        u, v = local[row, 3], local[row, 4]
        _, K, H = curvatures_of_patch(patch, normal_of_patch(patch, u, v), u, v)
        K = math.copysign(K, local[row, 2])
        u, v = local[row, 0], local[row, 1]
        n = row_vector(normals, keys[row] >> 32)
        x = point_of_patch(patch, u, v)
        place = place_in(mu, i, j, turn)
        point, s, t, h, K, H = on_surface(place, frame, SCALE * scale, n, u, v, x, K, H)
        k = np.uint64(which[row])
        store(k, point, n, s, t, h, K, H, points, directions, uv, support, gaussian, mean)
