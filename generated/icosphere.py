"""Sampling by the points of a refined icosahedron, row by row.

Written by `make generate` (python -m gaussmap.symbolic): do not edit, change symbolic/ instead.
SymPy 1.14.0. Passes: common subexpressions of all outputs together, in canonical order;
temporaries that are used once or are another name with a sign written back. float64, no
fast-math.
"""

import math

import numba
import numpy as np

from .sampler import (
    bound_of_forms,
    box_of,
    classify,
    cone_of_normals,
    control_normals,
    empty,
    face_window,
    is_developable,
    largest_tangent,
    look_again,
    map_net,
    patch_vectors,
    spans_of_hull,
)

OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False}


def jit(function):
    """Compile on the first call; keep the machine code on disk where a folder can be written."""
    try:
        return numba.njit(cache=True, **OPTIONS)(function)
    except RuntimeError:  # no writable cache folder
        return numba.njit(**OPTIONS)(function)


# sampler.py, digest 2f0dc1e6169f85d7: Numba's cache looks at this file alone.

# The icosahedron: corners as pairs (a, b) of coordinates a + b φ; edges and faces as numbers of
# corners. BARS map a normal to α, β, γ, with which the corners of a face are added to give it, and
# LENGTHS are those of their rows. FRAMES map it to 2γ − h, 2β − h and h = α + β + γ, and STRETCHES are
# their largest lengths. The points of frequency ν on a face are (ν − s − t, s, t): s counts its rows, t
# its columns. Corners are looked up on one face, at t/ν and s/ν; edges too, on a side of it: t = 0,
# s = 0 or s + t = ν.
CORNERS = np.array(
    [
        [(0, 0), (-1, 0), (0, -1)],
        [(0, 0), (-1, 0), (0, 1)],
        [(0, 0), (1, 0), (0, -1)],
        [(0, 0), (1, 0), (0, 1)],
        [(-1, 0), (0, -1), (0, 0)],
        [(-1, 0), (0, 1), (0, 0)],
        [(1, 0), (0, -1), (0, 0)],
        [(1, 0), (0, 1), (0, 0)],
        [(0, -1), (0, 0), (-1, 0)],
        [(0, -1), (0, 0), (1, 0)],
        [(0, 1), (0, 0), (-1, 0)],
        [(0, 1), (0, 0), (1, 0)],
    ]
)
POSITIONS = np.array(
    [
        [0.0, -1.0, -1.618033988749895],
        [0.0, -1.0, 1.618033988749895],
        [0.0, 1.0, -1.618033988749895],
        [0.0, 1.0, 1.618033988749895],
        [-1.0, -1.618033988749895, 0.0],
        [-1.0, 1.618033988749895, 0.0],
        [1.0, -1.618033988749895, 0.0],
        [1.0, 1.618033988749895, 0.0],
        [-1.618033988749895, 0.0, -1.0],
        [-1.618033988749895, 0.0, 1.0],
        [1.618033988749895, 0.0, -1.0],
        [1.618033988749895, 0.0, 1.0],
    ]
)
EDGES = np.array(
    [
        (0, 2),
        (0, 4),
        (0, 6),
        (0, 8),
        (0, 10),
        (1, 3),
        (1, 4),
        (1, 6),
        (1, 9),
        (1, 11),
        (2, 5),
        (2, 7),
        (2, 8),
        (2, 10),
        (3, 5),
        (3, 7),
        (3, 9),
        (3, 11),
        (4, 6),
        (4, 8),
        (4, 9),
        (5, 7),
        (5, 8),
        (5, 9),
        (6, 10),
        (6, 11),
        (7, 10),
        (7, 11),
        (8, 9),
        (10, 11),
    ]
)
FACES = np.array(
    [
        (0, 2, 8),
        (0, 2, 10),
        (0, 4, 6),
        (0, 4, 8),
        (0, 6, 10),
        (1, 3, 9),
        (1, 3, 11),
        (1, 4, 6),
        (1, 4, 9),
        (1, 6, 11),
        (2, 5, 7),
        (2, 5, 8),
        (2, 7, 10),
        (3, 5, 7),
        (3, 5, 9),
        (3, 7, 11),
        (4, 8, 9),
        (5, 8, 9),
        (6, 10, 11),
        (7, 10, 11),
    ]
)
CORNER_PLACES = np.array(
    [
        (0, 0, 0),
        (5, 0, 0),
        (0, 0, 1),
        (5, 0, 1),
        (2, 0, 1),
        (10, 0, 1),
        (2, 1, 0),
        (10, 1, 0),
        (0, 1, 0),
        (5, 1, 0),
        (1, 1, 0),
        (6, 1, 0),
    ]
)
EDGE_PLACES = np.array(
    [
        (0, 0),
        (2, 0),
        (2, 1),
        (0, 1),
        (1, 1),
        (5, 0),
        (7, 0),
        (7, 1),
        (5, 1),
        (6, 1),
        (10, 0),
        (10, 1),
        (0, 2),
        (1, 2),
        (13, 0),
        (13, 1),
        (5, 2),
        (6, 2),
        (2, 2),
        (3, 2),
        (8, 2),
        (10, 2),
        (11, 2),
        (14, 2),
        (4, 2),
        (9, 2),
        (12, 2),
        (15, 2),
        (16, 2),
        (18, 2),
    ]
)
BARS = np.array(
    [
        [
            [0.19098300562505258, -0.5, -0.30901699437494745],
            [0.19098300562505258, 0.5, -0.30901699437494745],
            [-0.6180339887498949, 0.0, 0.0],
        ],
        [
            [-0.19098300562505258, -0.5, -0.30901699437494745],
            [-0.19098300562505258, 0.5, -0.30901699437494745],
            [0.6180339887498949, 0.0, 0.0],
        ],
        [
            [0.0, 0.0, -0.6180339887498949],
            [-0.5, -0.30901699437494745, 0.19098300562505258],
            [0.5, -0.30901699437494745, 0.19098300562505258],
        ],
        [
            [0.30901699437494745, -0.19098300562505258, -0.5],
            [-0.19098300562505258, -0.5, 0.30901699437494745],
            [-0.5, 0.30901699437494745, -0.19098300562505258],
        ],
        [
            [-0.30901699437494745, -0.19098300562505258, -0.5],
            [0.19098300562505258, -0.5, 0.30901699437494745],
            [0.5, 0.30901699437494745, -0.19098300562505258],
        ],
        [
            [0.19098300562505258, -0.5, 0.30901699437494745],
            [0.19098300562505258, 0.5, 0.30901699437494745],
            [-0.6180339887498949, 0.0, 0.0],
        ],
        [
            [-0.19098300562505258, -0.5, 0.30901699437494745],
            [-0.19098300562505258, 0.5, 0.30901699437494745],
            [0.6180339887498949, 0.0, 0.0],
        ],
        [
            [0.0, 0.0, 0.6180339887498949],
            [-0.5, -0.30901699437494745, -0.19098300562505258],
            [0.5, -0.30901699437494745, -0.19098300562505258],
        ],
        [
            [0.30901699437494745, -0.19098300562505258, 0.5],
            [-0.19098300562505258, -0.5, -0.30901699437494745],
            [-0.5, 0.30901699437494745, 0.19098300562505258],
        ],
        [
            [-0.30901699437494745, -0.19098300562505258, 0.5],
            [0.19098300562505258, -0.5, -0.30901699437494745],
            [0.5, 0.30901699437494745, 0.19098300562505258],
        ],
        [
            [0.0, 0.0, -0.6180339887498949],
            [-0.5, 0.30901699437494745, 0.19098300562505258],
            [0.5, 0.30901699437494745, 0.19098300562505258],
        ],
        [
            [0.30901699437494745, 0.19098300562505258, -0.5],
            [-0.19098300562505258, 0.5, 0.30901699437494745],
            [-0.5, -0.30901699437494745, -0.19098300562505258],
        ],
        [
            [-0.30901699437494745, 0.19098300562505258, -0.5],
            [0.19098300562505258, 0.5, 0.30901699437494745],
            [0.5, -0.30901699437494745, -0.19098300562505258],
        ],
        [
            [0.0, 0.0, 0.6180339887498949],
            [-0.5, 0.30901699437494745, -0.19098300562505258],
            [0.5, 0.30901699437494745, -0.19098300562505258],
        ],
        [
            [0.30901699437494745, 0.19098300562505258, 0.5],
            [-0.19098300562505258, 0.5, -0.30901699437494745],
            [-0.5, -0.30901699437494745, 0.19098300562505258],
        ],
        [
            [-0.30901699437494745, 0.19098300562505258, 0.5],
            [0.19098300562505258, 0.5, -0.30901699437494745],
            [0.5, -0.30901699437494745, 0.19098300562505258],
        ],
        [
            [0.0, -0.6180339887498949, 0.0],
            [-0.30901699437494745, 0.19098300562505258, -0.5],
            [-0.30901699437494745, 0.19098300562505258, 0.5],
        ],
        [
            [0.0, 0.6180339887498949, 0.0],
            [-0.30901699437494745, -0.19098300562505258, -0.5],
            [-0.30901699437494745, -0.19098300562505258, 0.5],
        ],
        [
            [0.0, -0.6180339887498949, 0.0],
            [0.30901699437494745, 0.19098300562505258, -0.5],
            [0.30901699437494745, 0.19098300562505258, 0.5],
        ],
        [
            [0.0, 0.6180339887498949, 0.0],
            [0.30901699437494745, -0.19098300562505258, -0.5],
            [0.30901699437494745, -0.19098300562505258, 0.5],
        ],
    ]
)
LENGTHS = np.array(
    [
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
        [0.6180339887498949, 0.6180339887498949, 0.6180339887498949],
    ]
)
FRAMES = np.array(
    [
        [
            [-1.0, 0.0, 0.6180339887498949],
            [0.6180339887498949, 1.0, 0.0],
            [-0.2360679774997897, 0.0, -0.6180339887498949],
        ],
        [
            [1.0, 0.0, 0.6180339887498949],
            [-0.6180339887498949, 1.0, 0.0],
            [0.2360679774997897, 0.0, -0.6180339887498949],
        ],
        [
            [1.0, 0.0, 0.6180339887498949],
            [-1.0, 0.0, 0.6180339887498949],
            [0.0, -0.6180339887498949, -0.2360679774997897],
        ],
        [
            [-0.6180339887498949, 1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, -0.6180339887498949, 1.0],
            [-0.38196601125010515, -0.38196601125010515, -0.38196601125010515],
        ],
        [
            [0.6180339887498949, 1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, -0.6180339887498949, 1.0],
            [0.38196601125010515, -0.38196601125010515, -0.38196601125010515],
        ],
        [
            [-1.0, 0.0, -0.6180339887498949],
            [0.6180339887498949, 1.0, 0.0],
            [-0.2360679774997897, 0.0, 0.6180339887498949],
        ],
        [
            [1.0, 0.0, -0.6180339887498949],
            [-0.6180339887498949, 1.0, 0.0],
            [0.2360679774997897, 0.0, 0.6180339887498949],
        ],
        [
            [1.0, 0.0, -0.6180339887498949],
            [-1.0, 0.0, -0.6180339887498949],
            [0.0, -0.6180339887498949, 0.2360679774997897],
        ],
        [
            [-0.6180339887498949, 1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, -0.6180339887498949, -1.0],
            [-0.38196601125010515, -0.38196601125010515, 0.38196601125010515],
        ],
        [
            [0.6180339887498949, 1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, -0.6180339887498949, -1.0],
            [0.38196601125010515, -0.38196601125010515, 0.38196601125010515],
        ],
        [
            [1.0, 0.0, 0.6180339887498949],
            [-1.0, 0.0, 0.6180339887498949],
            [0.0, 0.6180339887498949, -0.2360679774997897],
        ],
        [
            [-0.6180339887498949, -1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, 0.6180339887498949, 1.0],
            [-0.38196601125010515, 0.38196601125010515, -0.38196601125010515],
        ],
        [
            [0.6180339887498949, -1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, 0.6180339887498949, 1.0],
            [0.38196601125010515, 0.38196601125010515, -0.38196601125010515],
        ],
        [
            [1.0, 0.0, -0.6180339887498949],
            [-1.0, 0.0, -0.6180339887498949],
            [0.0, 0.6180339887498949, 0.2360679774997897],
        ],
        [
            [-0.6180339887498949, -1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, 0.6180339887498949, -1.0],
            [-0.38196601125010515, 0.38196601125010515, 0.38196601125010515],
        ],
        [
            [0.6180339887498949, -1.0, 3.234539689561756e-173],
            [3.234539689561756e-173, 0.6180339887498949, -1.0],
            [0.38196601125010515, 0.38196601125010515, 0.38196601125010515],
        ],
        [
            [0.0, 0.6180339887498949, 1.0],
            [0.0, 0.6180339887498949, -1.0],
            [-0.6180339887498949, -0.2360679774997897, 0.0],
        ],
        [
            [0.0, -0.6180339887498949, 1.0],
            [0.0, -0.6180339887498949, -1.0],
            [-0.6180339887498949, 0.2360679774997897, 0.0],
        ],
        [
            [0.0, 0.6180339887498949, 1.0],
            [0.0, 0.6180339887498949, -1.0],
            [0.6180339887498949, -0.2360679774997897, 0.0],
        ],
        [
            [0.0, -0.6180339887498949, 1.0],
            [0.0, -0.6180339887498949, -1.0],
            [0.6180339887498949, 0.2360679774997897, 0.0],
        ],
    ]
)
STRETCHES = np.array(
    [
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
        1.1755705045849463,
    ]
)
FACE_RADIUS = 0.7639320225002103

# A normal is one of the icosahedron if it is as near to it as this angle.
NEAR = math.ldexp(1.0, -48)
# Where so few rows may hold a normal of a patch, they are all taken as long as the longest.
FEW_ROWS = 4


# --- where the points are -------------------------------------------------------------------------


@jit
def row_start(face, s, frequency):
    """Return the number of the point (s, 0) of a face, which is that of (s, 1) less one.

    The 12 corners come first, then the points inside the edges, then those inside the faces, row by
    row.
    """
    rows = s - 1
    inside = (frequency - 1) * (frequency - 2) // 2
    before = rows * (frequency - 1) - rows * (rows + 1) // 2
    return 12 + 30 * (frequency - 1) + face * inside + before - 1


@jit
def are_points(normals, first, count, x, y, z, x_step, y_step, z_step):
    """Say whether normals lie in the directions of points along a line."""
    far = 0
    for k in range(count):
        p_x = x + k * x_step
        p_y = y + k * y_step
        p_z = z + k * z_step
        n_x = normals[first + k, 0]
        n_y = normals[first + k, 1]
        n_z = normals[first + k, 2]
        square = p_x * p_x + p_y * p_y + p_z * p_z
        s = n_y * p_z - n_z * p_y
        t = n_z * p_x - n_x * p_z
        w = n_x * p_y - n_y * p_x
        towards = n_x * p_x + n_y * p_y + n_z * p_z
        far += (s * s + t * t + w * w > NEAR * NEAR * square) | (towards <= 0.0)
    return far == 0


@jit
def corner(k):
    """Return a corner of the icosahedron."""
    return POSITIONS[k, 0], POSITIONS[k, 1], POSITIONS[k, 2]


@jit
def is_icosphere(normals, frequency, first, last):
    """Say whether the corners (0), the edges (1 … 30) or the faces (31 … 50) of normals are its points.

    Does so for first, …, last − 1.
    """
    for part in range(first, last):
        if part == 0:
            for k in range(12):
                x, y, z = corner(k)
                if not are_points(normals, k, 1, x, y, z, 0.0, 0.0, 0.0):
                    return False
        elif part <= 30:
            edge = part - 1
            x, y, z = corner(EDGES[edge, 0])
            p, q, r = corner(EDGES[edge, 1])
            inner = frequency - 1
            if not are_points(
                normals, 12 + edge * inner, inner,
                inner * x + p, inner * y + q, inner * z + r, p - x, q - y, r - z,
            ):  # fmt: skip
                return False
        else:
            face = part - 31
            x, y, z = corner(FACES[face, 0])
            a, b, c = corner(FACES[face, 1])
            p, q, r = corner(FACES[face, 2])
            for s in range(1, frequency - 1):
                rest = frequency - s - 1
                if not are_points(
                    normals, row_start(face, s, frequency) + 1, rest,
                    rest * x + s * a + p, rest * y + s * b + q, rest * z + s * c + r,
                    p - x, q - y, r - z,
                ):  # fmt: skip
                    return False
    return True


# --- which points a patch may have ----------------------------------------------------------------


@jit
def faces_met(axis, sine, met):
    """Write which faces a cone of normals may meet, in ascending order; return how many.

    Most cones are narrow and lie within the face that is nearest to their axis.
    """
    slack = 1.01 * sine + 1e-9
    if sine < math.inf:
        nearest = 0
        highest = -math.inf
        for face in range(20):
            height = (
                FRAMES[face, 2, 0] * axis[0]
                + FRAMES[face, 2, 1] * axis[1]
                + FRAMES[face, 2, 2] * axis[2]
            )
            if height > highest:
                nearest, highest = face, height
        if reaches(nearest, axis, -slack):
            met[0] = nearest
            return 1
    count = 0
    for face in range(20):
        met[count] = face
        count += sine == math.inf or reaches(face, axis, slack)
    return count


@jit
def reaches(face, axis, slack):
    """Say whether a unit vector lies in a face, or farther outside by less than the slack (a sine)."""
    for k in range(3):
        towards = (
            BARS[face, k, 0] * axis[0] + BARS[face, k, 1] * axis[1] + BARS[face, k, 2] * axis[2]
        )
        if towards < -LENGTHS[face, k] * slack:
            return False
    return True


@jit
def spans_of_face(
    face, unit, errors, sine, frequency, shown, angles, window, hull, low, high, spans
):
    """Write the first and the last column of each row of a face that a patch may have to spans.

    Returns the first row, the last one, and how many points there are.
    """
    map_net(unit, errors, FRAMES[face], shown, angles, STRETCHES[face])
    empty(window)
    error, size = face_window(shown, angles, sine < math.inf, 4, frequency, window, hull)
    if window[1] < window[0]:
        return 0, -1, 0
    first, last, left, right = 0, frequency, 0, frequency
    if error < math.inf:
        west, east, south, north = box_of(hull, size, error)
        first, last = math.ceil(max(south, 0.0)), math.floor(min(north, frequency))
        left, right = math.ceil(max(west, 0.0)), math.floor(min(east, frequency))
    total = 0
    if error == math.inf or last - first < FEW_ROWS:
        for row in range(first, last + 1):
            spans[0, row] = left
            spans[1, row] = min(right, frequency - row)
            total += max(0, spans[1, row] - left + 1)
        return first, last, total
    spans_of_hull(hull, size, error, 0, first, last, low, high)
    for row in range(first, last + 1):
        left, right = (
            max(low[row - first] - error, 0.0),
            min(high[row - first] + error, frequency - row),
        )
        spans[0, row], spans[1, row] = (
            (math.ceil(left), math.floor(right)) if left <= right else (0, -1)
        )
        total += max(0, spans[1, row] - spans[0, row] + 1)
    return first, last, total


@jit
def on_border(spans, first, last, frequency):
    """Say whether rows of a face reach its border."""
    if first <= 0:
        return True
    for row in range(first, last + 1):
        if spans[0, row] <= 0 or spans[1, row] >= frequency - row:
            return True
    return False


@jit
def note_border(spans, first, last, frequency, places):
    """Write the corners, then the points inside edges that a patch may have; return how many.

    Each is looked up on one of its faces; those that are not met have no rows.
    """
    count = 0
    for k in range(12):
        face, t, s = CORNER_PLACES[k]
        row = s * frequency
        if first[face] <= row <= last[face]:
            places[count] = k
            count += spans[face, 0, row] <= t * frequency <= spans[face, 1, row]
    for edge in range(30):
        face, side = EDGE_PLACES[edge]
        if first[face] <= last[face]:
            start = 12 + edge * (frequency - 1) - 1
            for k in range(1, frequency):
                row = k if side == 0 else 0 if side == 1 else frequency - k
                column = 0 if side == 0 else k
                if first[face] <= row <= last[face]:
                    places[count] = start + k
                    count += spans[face, 0, row] <= column <= spans[face, 1, row]
    return count


@jit
def note_inside(face, spans, first, last, frequency, places, x, y, z, count):
    """Write the points inside a face that a patch may have after `count` others; return how many.

    Writes their numbers, and where they are on the face.
    """
    i_x, i_y, i_z = corner(FACES[face, 0])
    j_x, j_y, j_z = corner(FACES[face, 1])
    k_x, k_y, k_z = corner(FACES[face, 2])
    for s in range(max(first, 1), min(last, frequency - 2) + 1):
        start = row_start(face, s, frequency)
        left = max(spans[0, s], 1)
        size = min(spans[1, s], frequency - s - 1) - left + 1
        rest = frequency - s - left
        begin_x = rest * i_x + s * j_x + left * k_x
        begin_y = rest * i_y + s * j_y + left * k_y
        begin_z = rest * i_z + s * j_z + left * k_z
        for t in range(size):
            places[count + t] = start + left + t
            x[count + t] = begin_x + t * (k_x - i_x)
            y[count + t] = begin_y + t * (k_y - i_y)
            z[count + t] = begin_z + t * (k_z - i_z)
        count += max(size, 0)
    return count


@jit
def look_up(normals, places, x, y, z):
    """Write the normals of these numbers."""
    for k in range(x.size):
        x[k] = normals[places[k], 0]
        y[k] = normals[places[k], 1]
        z[k] = normals[places[k], 2]


@jit
def normalize(x, y, z):
    """Divide vectors by their lengths."""
    for k in range(x.size):
        inverse = 1.0 / math.sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k])
        x[k] *= inverse
        y[k] *= inverse
        z[k] *= inverse


# --- which points a patch has ---------------------------------------------------------------------


@jit
def scan_patches(
    mu, scale, noise, border, normals, frequency, first_patch, last_patch,
    found, doubtful, bounds, counts,
):  # fmt: skip
    """Find the points of an icosphere that are normals of patches, in ascending order for each.

    As `search_patches` for normals (S, 3) that are the points of frequency ν, but row by row.
    """
    columns = mu.shape[1] - 2
    net, unit, shown = np.empty((6, 3)), np.empty((6, 3)), np.empty((6, 3))
    errors, angles = np.empty(6), np.empty(6)
    window, hull, axis = np.empty(4, np.int64), np.empty((12, 2)), np.empty(3)
    met, first, last = np.empty(21, np.int64), np.zeros(20, np.int64), np.full(20, -1)
    spans = np.empty((20, 2, frequency + 1), np.int64)
    low, high = np.empty(frequency + 1), np.empty(frequency + 1)
    places, codes, which, few_codes, x, y, z = candidates(256)
    for patch in range(first_patch, last_patch):
        cell = patch // 4
        turn = patch % 4
        i = cell // columns
        j = cell % columns
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(mu, i + 1, j + 1, turn, scale)  # fmt: skip
        (
            net[0, 0],
            net[0, 1],
            net[0, 2],
            net[1, 0],
            net[1, 1],
            net[1, 2],
            net[2, 0],
            net[2, 1],
            net[2, 2],
            net[3, 0],
            net[3, 1],
            net[3, 2],
            net[4, 0],
            net[4, 1],
            net[4, 2],
            net[5, 0],
            net[5, 1],
            net[5, 2],
        ) = control_normals(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
        )
        counts[2] += is_developable(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, net, noise
        )

        # Which normals may the patch have?
        tangents = largest_tangent(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
        )
        sine = cone_of_normals(net, tangents, unit, errors, axis)

        total = 0
        at_border = False
        faces = faces_met(axis, sine, met)
        for k in range(faces):
            face = met[k]
            first[face], last[face], count = spans_of_face(
                face,
                unit,
                errors,
                sine,
                frequency,
                shown,
                angles,
                window,
                hull,
                low,
                high,
                spans[face],
            )
            total += count
            at_border = at_border or on_border(spans[face], first[face], last[face], frequency)
        if counts[0] + total + 1 > found.shape[1] or counts[1] + total + 1 > doubtful.shape[1]:
            return patch, total + 1
        if total + 16 > x.size:
            places, codes, which, few_codes, x, y, z = candidates(total + 16)
        count = 0
        if at_border:
            count = note_border(spans, first, last, frequency, places)
            look_up(normals, places, x[:count], y[:count], z[:count])
        for k in range(faces):
            face = met[k]
            count = note_inside(
                face, spans[face], first[face], last[face], frequency, places, x, y, z, count
            )
            last[face] = -1
        bound = bound_of_forms(
            mu, i, j, turn, scale, noise, border, axis, sine,
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
        )  # fmt: skip
        if sine == math.inf:
            look_up(normals, places, x[:count], y[:count], z[:count])
            classify(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                axis, sine, bound, x[:count], y[:count], z[:count], codes,
            )  # fmt: skip
            look_again(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                x, y, z, codes[:count],
            )  # fmt: skip
        else:
            # What is computed differs from the normals by rounding, and their forms by less than the
            # bound: they are looked up where twice the bound leaves something open.
            # A few more are computed, so that vectors are full.
            full = (count | 15) + 1
            normalize(x[:full], y[:full], z[:full])
            classify(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                axis, sine, 2.0 * bound, x[:full], y[:full], z[:full], codes,
            )  # fmt: skip
            if has_open(codes[:count]):
                unsure = look_up_open(normals, codes, places, count, which, x, y, z)
                classify(
                    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                    axis, sine, bound, x[:unsure], y[:unsure], z[:unsure], few_codes,
                )  # fmt: skip
                for k in range(unsure):
                    codes[which[k]] = few_codes[k]
        counts[0] = store_in_order(codes, 1, places, count, patch, found, counts[0])
        if has_open(codes[:count]):
            doubts = counts[1]
            counts[1] = store_in_order(codes, 2, places, count, patch, doubtful, counts[1])
            bounds[doubts : counts[1]] = bound
    return last_patch, 0


@jit
def candidates(size):
    """Return arrays for the points that a patch may have."""
    places, which = np.empty(size, np.int64), np.empty(size, np.int64)
    codes, few_codes = np.empty(size, np.int8), np.empty(size, np.int8)
    return places, codes, which, few_codes, np.ones(size), np.ones(size), np.ones(size)


@jit
def has_open(codes):
    """Say whether there is a 2 among codes."""
    count = 0
    for k in range(codes.size):
        count += codes[k] == 2
    return count > 0


@jit
def look_up_open(normals, codes, places, count, which, x, y, z):
    """Write which of the points are open, and their normals; return how many are."""
    size = 0
    for k in range(count):
        which[size] = k
        size += codes[k] == 2
    for k in range(size):
        x[k] = normals[places[which[k]], 0]
        y[k] = normals[places[which[k]], 1]
        z[k] = normals[places[which[k]], 2]
    return size


@jit
def store_in_order(codes, code, places, count, patch, pairs, at):
    """Write patch and normal of each candidate that has the code to pairs from `at` on; return the end."""
    for k in range(count):
        pairs[0, at] = patch
        pairs[1, at] = places[k]
        pairs[2, at] = places[k]
        at += codes[k] == code
    return at
