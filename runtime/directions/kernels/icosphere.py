"""The points of the icosphere, a refined icosahedron: their indices and unit normals.

The points of a face, at frequency ν, have the barycentric coordinates (ν − s − t, s, t)/ν, with the
row s and the column t. The 12 corners come first, then the points inside the 30 edges, then the
points inside the 20 faces, row by row.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ....generated.icosahedron import CORNER_PLACES, EDGE_PLACES, LINES, PHI
from ...machine_code.jit import inline, jit, long_vectors, loop
from .vectors import STEP, TILE, whole_vectors

# Typed, since Numba compiles a function anew for each literal number in its arguments.
ZERO = np.int64(0)


def new_line() -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return work arrays for rows and columns of points, and for their normals."""
    return np.zeros(2 * STEP, np.int64), np.zeros(3 * STEP)


@inline
def row_start(face, s, frequency):
    """Return one less than the index of the point (s, 1), the first inner point of row s."""
    rows = s - 1
    inside = (frequency - 1) * (frequency - 2) >> 1
    before = rows * (frequency - 1) - (rows * (rows + 1) >> 1)
    return 12 + 30 * (frequency - 1) + face * inside + before - 1


@loop
def write_normals(face, frequency, places, first, count, tile):
    """Write the unit normals of points of a face to the first three rows of a tile.

    `places` (2 STEP) lists the rows of points, then their columns. The normals of `count` points
    are written, from position `first` of the lists on, and those of up to VECTOR − 1 further
    points. A point has coordinates a + b φ with integers a and b; the normal is this vector divided
    by its length. In a coordinate only b φ and the sum are rounded, so that mirror images agree bit
    for bit, and a point on an edge has the same normal in both faces.
    """
    long_vectors()
    a_x, b_x, a_y, b_y, a_z, b_z = line(face, 0)
    p_x, q_x, p_y, q_y, p_z, q_z = line(face, 1)
    f_x, g_x, f_y, g_y, f_z, g_z = line(face, 2)
    r = float(frequency)
    tile, places = tile[first:], places[first:]
    for k in range(whole_vectors(count)):
        s = float(places[k])
        t = float(places[STEP + k])
        x = (r * a_x + s * p_x + t * f_x) + (r * b_x + s * q_x + t * g_x) * PHI
        y = (r * a_y + s * p_y + t * f_y) + (r * b_y + s * q_y + t * g_y) * PHI
        z = (r * a_z + s * p_z + t * f_z) + (r * b_z + s * q_z + t * g_z) * PHI
        length = math.sqrt(x * x + y * y + z * z)
        tile[k] = x / length
        tile[STEP + k] = y / length
        tile[2 * STEP + k] = z / length


@inline
def line(face, k):
    """Return the first corner of a face (k = 0), or the step to the next row (1) or column (2).

    The coordinates of this vector are a + b φ. The result is a and b for x, for y, and for z.
    """
    return (
        LINES[face, k, 0],
        LINES[face, k, 1],
        LINES[face, k, 2],
        LINES[face, k, 3],
        LINES[face, k, 4],
        LINES[face, k, 5],
    )


@loop
def write_line(face, frequency, s, t, s_step, t_step, count, places, tile):
    """Write unit normals of `count` points of a face to a tile.

    The points are in row s and column t, in row s + s_step and column t + t_step, and so on.
    """
    for k in range(whole_vectors(count)):
        places[k] = s + k * s_step
        places[STEP + k] = t + k * t_step
    write_normals(face, frequency, places, ZERO, count, tile)


@inline
def line_count(part, frequency):
    """Return the number of lines of points in a part of the icosphere.

    Part 0 has all corners, each a line; parts 1 … 30 are edges, and parts 31 … 50 faces.
    """
    return 12 if part == 0 else 1 if part <= 30 else frequency - 2


@loop
def line_of(part, k, frequency):
    """Return line k of a part: the index of its first point, and its number of points.

    The other results are the arguments of `write_line`: face, s, t, s_step and t_step.
    """
    inner = frequency - 1
    if part == 0:
        face, t, s = CORNER_PLACES[k, 0], CORNER_PLACES[k, 1], CORNER_PLACES[k, 2]
        return k, 1, face, s * frequency, t * frequency, 0, 0
    if part <= 30:
        face, side = EDGE_PLACES[part - 1, 0], EDGE_PLACES[part - 1, 1]
        first = 12 + (part - 1) * inner
        if side == 0:
            return first, inner, face, 1, 0, 1, 0
        if side == 1:
            return first, inner, face, 0, 1, 0, 1
        return first, inner, face, inner, 1, -1, 1
    face, s = part - 31, k + 1
    return row_start(face, s, frequency) + 1, inner - s, face, s, 1, 0, 1


@jit
def write_points(frequency, first, last, normals, places, tile):
    """Write the unit normals (S, 3) of the parts [first, last); work arrays by `new_line`."""
    for part in range(first, last):
        for k in range(line_count(part, frequency)):
            number, count, face, s, t, s_step, t_step = line_of(part, k, frequency)
            for begin in range(0, count, TILE):
                size = min(TILE, count - begin)
                write_line(
                    face, frequency, s + begin * s_step, t + begin * t_step, s_step, t_step,
                    size, places, tile,
                )  # fmt: skip
                for row in range(size):
                    at = np.uint64(number + begin + row)
                    normals[at, 0] = tile[row]
                    normals[at, 1] = tile[STEP + row]
                    normals[at, 2] = tile[2 * STEP + row]
