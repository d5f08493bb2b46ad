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
    ACCURATE,
    TILE,
    TILE_STEP,
    bound_of_forms,
    box_of,
    classify,
    cone_of_normals,
    control_normals,
    count_open,
    empty,
    face_window,
    fill_tile,
    inner,
    is_developable,
    largest_tangent,
    load_patch,
    look_again,
    map_net,
    new_tile,
    patch_vectors,
    spans_of_hull,
    whole_vectors,
)

OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False}


def jit(function):
    """Compile on the first call; keep the machine code on disk where a folder can be written."""
    try:
        return numba.njit(cache=True, **OPTIONS)(function)
    except RuntimeError:  # no writable cache folder
        return numba.njit(**OPTIONS)(function)


# sampler.py, digest 7155b6a15fe4f9ff: Numba's cache looks at this file alone.

# The icosahedron. LINES hold, for each face, its first corner and the steps from there to the others:
# the coordinates a + b φ as a, b. POSITIONS are the corners, FACES their numbers. BARS map a normal to
# α, β, γ, with which the corners of a face are added to give it, and LENGTHS are those of their rows.
# FRAMES map it to 2γ − h, 2β − h and h = α + β + γ, and STRETCHES are their largest lengths. The points
# of frequency ν on a face are (ν − s − t, s, t): s counts its rows, t its columns. Corners are looked
# up on one face, at t/ν and s/ν; edges too, on a side of it: t = 0, s = 0 or s + t = ν.
PHI = 1.618033988749895
FACE_RADIUS = 0.7639320225002103
LINES = np.array(
    [
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 1.0, 0.0, -1.0, 1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 1.0, 0.0, -1.0, 1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, -1.0],
            [-1.0, 0.0, 1.0, -1.0, 0.0, 1.0],
            [1.0, 0.0, 1.0, -1.0, 0.0, 1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, -1.0],
            [-1.0, 0.0, 1.0, -1.0, 0.0, 1.0],
            [0.0, -1.0, 1.0, 0.0, -1.0, 1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, -1.0],
            [1.0, 0.0, 1.0, -1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0, 0.0, -1.0, 1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 1.0, 0.0, 1.0, -1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 2.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 1.0, 0.0, 1.0, -1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
            [-1.0, 0.0, 1.0, -1.0, 0.0, -1.0],
            [1.0, 0.0, 1.0, -1.0, 0.0, -1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
            [-1.0, 0.0, 1.0, -1.0, 0.0, -1.0],
            [0.0, -1.0, 1.0, 0.0, 1.0, -1.0],
        ],
        [
            [0.0, 0.0, -1.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0, -1.0, 0.0, -1.0],
            [0.0, 1.0, 1.0, 0.0, 1.0, -1.0],
        ],
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
            [-1.0, 0.0, -1.0, 1.0, 0.0, 1.0],
            [1.0, 0.0, -1.0, 1.0, 0.0, 1.0],
        ],
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
            [-1.0, 0.0, -1.0, 1.0, 0.0, 1.0],
            [0.0, -1.0, -1.0, 0.0, -1.0, 1.0],
        ],
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
            [1.0, 0.0, -1.0, 1.0, 0.0, 1.0],
            [0.0, 1.0, -1.0, 0.0, -1.0, 1.0],
        ],
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
            [-1.0, 0.0, -1.0, 1.0, 0.0, -1.0],
            [1.0, 0.0, -1.0, 1.0, 0.0, -1.0],
        ],
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
            [-1.0, 0.0, -1.0, 1.0, 0.0, -1.0],
            [0.0, -1.0, -1.0, 0.0, 1.0, -1.0],
        ],
        [
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, -1.0, 1.0, 0.0, -1.0],
            [0.0, 1.0, -1.0, 0.0, 1.0, -1.0],
        ],
        [
            [-1.0, 0.0, 0.0, -1.0, 0.0, 0.0],
            [1.0, -1.0, 0.0, 1.0, -1.0, 0.0],
            [1.0, -1.0, 0.0, 1.0, 1.0, 0.0],
        ],
        [
            [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [1.0, -1.0, 0.0, -1.0, -1.0, 0.0],
            [1.0, -1.0, 0.0, -1.0, 1.0, 0.0],
        ],
        [
            [1.0, 0.0, 0.0, -1.0, 0.0, 0.0],
            [-1.0, 1.0, 0.0, 1.0, -1.0, 0.0],
            [-1.0, 1.0, 0.0, 1.0, 1.0, 0.0],
        ],
        [
            [1.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            [-1.0, 1.0, 0.0, -1.0, -1.0, 0.0],
            [-1.0, 1.0, 0.0, -1.0, 1.0, 0.0],
        ],
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
            [-0.6180339887498949, 1.0, 0.0],
            [0.0, -0.6180339887498949, 1.0],
            [-0.38196601125010515, -0.38196601125010515, -0.38196601125010515],
        ],
        [
            [0.6180339887498949, 1.0, 0.0],
            [0.0, -0.6180339887498949, 1.0],
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
            [-0.6180339887498949, 1.0, 0.0],
            [0.0, -0.6180339887498949, -1.0],
            [-0.38196601125010515, -0.38196601125010515, 0.38196601125010515],
        ],
        [
            [0.6180339887498949, 1.0, 0.0],
            [0.0, -0.6180339887498949, -1.0],
            [0.38196601125010515, -0.38196601125010515, 0.38196601125010515],
        ],
        [
            [1.0, 0.0, 0.6180339887498949],
            [-1.0, 0.0, 0.6180339887498949],
            [0.0, 0.6180339887498949, -0.2360679774997897],
        ],
        [
            [-0.6180339887498949, -1.0, 0.0],
            [0.0, 0.6180339887498949, 1.0],
            [-0.38196601125010515, 0.38196601125010515, -0.38196601125010515],
        ],
        [
            [0.6180339887498949, -1.0, 0.0],
            [0.0, 0.6180339887498949, 1.0],
            [0.38196601125010515, 0.38196601125010515, -0.38196601125010515],
        ],
        [
            [1.0, 0.0, -0.6180339887498949],
            [-1.0, 0.0, -0.6180339887498949],
            [0.0, 0.6180339887498949, 0.2360679774997897],
        ],
        [
            [-0.6180339887498949, -1.0, 0.0],
            [0.0, 0.6180339887498949, -1.0],
            [-0.38196601125010515, 0.38196601125010515, 0.38196601125010515],
        ],
        [
            [0.6180339887498949, -1.0, 0.0],
            [0.0, 0.6180339887498949, -1.0],
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

# The square of the length of the corners.
SQUARE = 1.0 + PHI * PHI
# Where a box has no more points than this, it is not cut to the hull that is inside.
SMALL_BOX = 192
# The forms of a point as they are computed from those of the corners, relative to their square.
LATTICE_ERROR = math.ldexp(1.0, -44)
# A patch with so many samples begins a tile.
MANY = 32

# A run of samples, as a note: number of the first normal << 32 | how many << SIZE | face << ROW | row.
# The face is 20 for a single normal that is not inside a face.
SIZE, ROW = 18, 13
LONGEST, BEFORE_SIZE, BEFORE_ROW = (1 << 32 - SIZE) - 1, (1 << SIZE) - 1, (1 << ROW) - 1
MOST_FREQUENT = 1 << ROW


# --- where the points are -------------------------------------------------------------------------


@inner
def row_start(face, s, frequency):
    """Return the number of the point (s, 0) of a face, which is that of (s, 1) less one.

    The 12 corners come first, then the points inside the edges, then those inside the faces, row by
    row.
    """
    rows = s - 1
    inside = (frequency - 1) * (frequency - 2) >> 1
    before = rows * (frequency - 1) - (rows * (rows + 1) >> 1)
    return 12 + 30 * (frequency - 1) + face * inside + before - 1


@inner
def write_normals(face, frequency, places, first, count, tile):
    """Write the unit normals of points of a face to a tile, from place `first` on; and up to 15 more.

    `places` holds their rows and columns. What is before the square root is exact but for the rounding
    of b φ and of one sum: points that mirror each other are so bit for bit, and a point of two faces is
    the same on both.
    """
    a_x, b_x, a_y, b_y, a_z, b_z = LINES[face, 0]
    p_x, q_x, p_y, q_y, p_z, q_z = LINES[face, 1]
    f_x, g_x, f_y, g_y, f_z, g_z = LINES[face, 2]
    r = float(frequency)
    tile, places = tile[first:], places[first:]
    for k in range(whole_vectors(count)):
        s = float(places[k])
        t = float(places[TILE_STEP + k])
        x = (r * a_x + s * p_x + t * f_x) + (r * b_x + s * q_x + t * g_x) * PHI
        y = (r * a_y + s * p_y + t * f_y) + (r * b_y + s * q_y + t * g_y) * PHI
        z = (r * a_z + s * p_z + t * f_z) + (r * b_z + s * q_z + t * g_z) * PHI
        length = math.sqrt(x * x + y * y + z * z)
        tile[k] = x / length
        tile[TILE_STEP + k] = y / length
        tile[2 * TILE_STEP + k] = z / length


@inner
def write_line(face, frequency, s, t, s_step, t_step, count, places, tile):
    """Write the unit normals (s, t), (s + s_step, t + t_step), … of a face to a tile."""
    for k in range(whole_vectors(count)):
        places[k] = s + k * s_step
        places[TILE_STEP + k] = t + k * t_step
    write_normals(face, frequency, places, 0, count, tile)


@inner
def lines_of(part, frequency):
    """Return how many lines there are in the corners (0), an edge (1 … 30) or a face (31 … 50)."""
    return 12 if part == 0 else 1 if part <= 30 else frequency - 2


@inner
def line_of(part, k, frequency):
    """Return a line of a part: the number of its first normal, how many, and the beginning of those of `write_line`."""
    inner = frequency - 1
    if part == 0:
        face, t, s = CORNER_PLACES[k]
        return k, 1, face, s * frequency, t * frequency, 0, 0
    if part <= 30:
        face, side = EDGE_PLACES[part - 1]
        first = 12 + (part - 1) * inner
        if side == 0:
            return first, inner, face, 1, 0, 1, 0
        if side == 1:
            return first, inner, face, 0, 1, 0, 1
        return first, inner, face, inner, 1, -1, 1
    face, s = part - 31, k + 1
    return row_start(face, s, frequency) + 1, inner - s, face, s, 1, 0, 1


@jit
def write_points(frequency, first, last, normals):
    """Write the unit normals (S, 3) of the parts first, …, last − 1."""
    places, tile = np.empty(2 * TILE_STEP, np.int64), np.empty(3 * TILE_STEP)
    for part in range(first, last):
        for line in range(lines_of(part, frequency)):
            number, count, face, s, t, s_step, t_step = line_of(part, line, frequency)
            for begin in range(0, count, TILE):
                size = min(TILE, count - begin)
                write_line(
                    face, frequency, s + begin * s_step, t + begin * t_step, s_step, t_step,
                    size, places, tile,
                )  # fmt: skip
                for k in range(size):
                    at = np.uint64(number + begin + k)
                    normals[at, 0] = tile[k]
                    normals[at, 1] = tile[TILE_STEP + k]
                    normals[at, 2] = tile[2 * TILE_STEP + k]


@jit
def is_icosphere(normals, frequency, first, last):
    """Say whether the parts first, …, last − 1 of normals (S, 3) are those points, bit for bit."""
    places, tile = np.empty(2 * TILE_STEP, np.int64), np.empty(3 * TILE_STEP)
    for part in range(first, last):
        for line in range(lines_of(part, frequency)):
            number, count, face, s, t, s_step, t_step = line_of(part, line, frequency)
            for begin in range(0, count, TILE):
                size = min(TILE, count - begin)
                write_line(
                    face, frequency, s + begin * s_step, t + begin * t_step, s_step, t_step,
                    size, places, tile,
                )  # fmt: skip
                others = False
                for k in range(size):
                    at = np.uint64(number + begin + k)
                    others |= normals[at, 0] != tile[k]
                    others |= normals[at, 1] != tile[TILE_STEP + k]
                    others |= normals[at, 2] != tile[2 * TILE_STEP + k]
                if others:
                    return False
    return True


# --- which points a patch may have ----------------------------------------------------------------


@inner
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


@inner
def reaches(face, axis, slack):
    """Say whether a unit vector lies in a face, or farther outside by less than the slack (a sine)."""
    for k in range(3):
        towards = (
            BARS[face, k, 0] * axis[0] + BARS[face, k, 1] * axis[1] + BARS[face, k, 2] * axis[2]
        )
        if towards < -LENGTHS[face, k] * slack:
            return False
    return True


@inner
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
    if error == math.inf or (last - first + 1) * (right - left + 1) <= SMALL_BOX:
        for row in range(first, last + 1):
            spans[0, row] = left
            spans[1, row] = min(right, frequency - row)
            total += max(0, spans[1, row] - left + 1)
        return first, last, total
    spans_of_hull(hull, size, error, 0, first, last, low, high)
    here = spans[:, first:]
    for row in range(last - first + 1):
        left = max(low[row] - error, 0.0)
        right = min(high[row] + error, frequency - first - row)
        here[0, row], here[1, row] = (
            (math.ceil(left), math.floor(right)) if left <= right else (0, -1)
        )
        total += max(0, here[1, row] - here[0, row] + 1)
    return first, last, total


@inner
def on_border(spans, first, last, frequency):
    """Say whether rows of a face reach its border."""
    if first <= 0:
        return True
    for row in range(first, last + 1):
        if spans[0, row] <= 0 or spans[1, row] >= frequency - row:
            return True
    return False


@inner
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
            low, high = first[face], last[face]
            if side == 1:
                low, high = (spans[face, 0, 0], spans[face, 1, 0]) if low <= 0 else (0, -1)
            elif side == 2:
                low, high = frequency - high, frequency - low
            for k in range(max(low, 1), min(high, frequency - 1) + 1):
                row = k if side == 0 else 0 if side == 1 else frequency - k
                column = 0 if side == 0 else k
                places[count] = start + k
                count += spans[face, 0, row] <= column <= spans[face, 1, row]
    return count


@inner
def note_inside(spans, first, last, frequency, s, t):
    """Write the rows and columns (s, t) of the points inside a face that a patch may have.

    Before, between and behind rows there is a NaN. Returns how many entries there are.
    """
    t[0] = math.nan
    count = 1
    for row in range(max(first, 1), min(last, frequency - 2) + 1):
        left = max(spans[0, row], 1)
        size = min(spans[1, row], frequency - row - 1) - left + 1
        for k in range(size):
            at = np.uint64(count + k)  # so that nobody asks whether it is negative
            s[at] = row
            t[at] = left + k
        if size > 0:
            count += size + 1
            t[count - 1] = math.nan
    for k in range(16):
        t[count + k] = math.nan
    return count


@inner
def look_up(normals, places, first, count, tile):
    """Write the normals of the numbers places[first], … to a tile."""
    for k in range(count):
        for x in range(3):
            tile[x * TILE_STEP + k] = normals[places[first + k], x]


# --- which points a patch has ---------------------------------------------------------------------


@jit
def scan_patches(
    mu, scale, noise, border, normals, frequency, first_patch, last_patch,
    found, doubtful, bounds, counts,
):  # fmt: skip
    """Find the points of an icosphere that are normals of patches, in ascending order for each.

    As `search_patches` for normals (S, 3) that are the points of frequency ν, but row by row: found
    (…, 2) and doubtful (…, 2) hold the patch and the note of runs.
    """
    columns = mu.shape[1] - 2
    net, unit, shown = np.empty((6, 3)), np.empty((6, 3)), np.empty((6, 3))
    errors, angles = np.empty(6), np.empty(6)
    window, hull, axis = np.empty(4, np.int64), np.empty((12, 2)), np.empty(3)
    met, first, last = np.empty(21, np.int64), np.zeros(20, np.int64), np.full(20, -1)
    spans = np.empty((20, 2, frequency + 1), np.int64)
    low, high = np.empty(frequency + 17), np.empty(frequency + 17)
    forms, tile = np.empty(18), np.zeros(3 * TILE_STEP)
    row_and_column, tile_codes = np.empty(2 * TILE_STEP, np.int64), np.empty(TILE_STEP, np.int8)
    places, s, t, codes, marks = candidates(256)
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
        if total == 0:
            last[met[:faces]] = -1
            continue
        if counts[0] + total + 1 > found.shape[0] or counts[1] + total + 1 > doubtful.shape[0]:
            return patch, total + 1
        if total + frequency + 64 > s.size:
            places, s, t, codes, marks = candidates(2 * total + frequency + 64)
        bound = bound_of_forms(
            mu, i, j, turn, scale, noise, border, axis, sine,
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
        )  # fmt: skip
        doubts = counts[1]
        if at_border:
            count = note_border(spans, first, last, frequency, places)
            for begin in range(0, count, TILE):
                size = min(TILE, count - begin)
                look_up(normals, places, begin, size, tile)
                classify_tile(
                    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                    axis, sine, bound, tile, tile_codes, codes, begin, size,
                )  # fmt: skip
            store_border(codes, places, count, patch, found, doubtful, counts)
        for k in range(faces):
            face = met[k]
            count = note_inside(spans[face], first[face], last[face], frequency, s, t)
            last[face] = -1
            forms_on_face(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                axis, sine, face, frequency, forms,
            )  # fmt: skip
            unsure = classify_points(
                forms, bound if sine < math.inf else math.inf, frequency, s, t, count, codes
            )
            if unsure > 0:
                settle(
                    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                    axis, sine, bound, face, frequency, s, t, count, row_and_column, tile, tile_codes, codes,
                )  # fmt: skip
                counts[1] = store_open(
                    face, frequency, s, t, count, codes, patch, doubtful, counts[1]
                )
            counts[0] = store_runs(
                face, frequency, s, t, count, codes, marks, places, patch, found, counts[0]
            )
        bounds[doubts : counts[1]] = bound
    return last_patch, 0


@jit
def candidates(size):
    """Return arrays for the points that a patch may have: numbers, rows, columns, codes, marks."""
    codes, marks = np.zeros(size, np.int8), np.zeros((size + 7) // 8 * 8, np.int8)
    return np.empty(size, np.int64), np.empty(size), np.empty(size), codes, marks


@inner
def forms_on_face(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
    axis, sine, face, frequency, forms,
):  # fmt: skip
    """Write the linear forms at the point (0, 0) of a face, and their steps along its rows and columns.

    So many for each of A, B, C, P, Q and for the height over the axis, which is 1 without a cone.
    """
    i = FACES[face, 0]
    n_x = POSITIONS[i, 0]
    n_y = POSITIONS[i, 1]
    n_z = POSITIONS[i, 2]
    # linear_forms (eq. (9)): 25 operations as written, 25 here
    A = a_x * n_x + a_y * n_y + a_z * n_z
    B = b_x * n_x + b_y * n_y + b_z * n_z
    C = c_x * n_x + c_y * n_y + c_z * n_z
    P = d_x * n_x + d_y * n_y + d_z * n_z
    Q = e_x * n_x + e_y * n_y + e_z * n_z
    forms[0] = A * frequency
    forms[1] = B * frequency
    forms[2] = C * frequency
    forms[3] = P * frequency
    forms[4] = Q * frequency
    for side in range(2):
        k = FACES[face, 1 + side]
        n_x = POSITIONS[k, 0] - POSITIONS[i, 0]
        n_y = POSITIONS[k, 1] - POSITIONS[i, 1]
        n_z = POSITIONS[k, 2] - POSITIONS[i, 2]
        # linear_forms (eq. (9)): 25 operations as written, 25 here
        A = a_x * n_x + a_y * n_y + a_z * n_z
        B = b_x * n_x + b_y * n_y + b_z * n_z
        C = c_x * n_x + c_y * n_y + c_z * n_z
        P = d_x * n_x + d_y * n_y + d_z * n_z
        Q = e_x * n_x + e_y * n_y + e_z * n_z
        forms[6 + 6 * side] = A
        forms[7 + 6 * side] = B
        forms[8 + 6 * side] = C
        forms[9 + 6 * side] = P
        forms[10 + 6 * side] = Q
        forms[11 + 6 * side] = n_x * axis[0] + n_y * axis[1] + n_z * axis[2]
    forms[5] = frequency * (
        POSITIONS[i, 0] * axis[0] + POSITIONS[i, 1] * axis[1] + POSITIONS[i, 2] * axis[2]
    )
    if sine == math.inf:
        forms[5], forms[11], forms[17] = 1.0, 0.0, 0.0


@inner
def classify_points(forms, bound, frequency, s, t, count, codes):
    """Write for the points of a face whether the patch has them, as `classify` does; count the open.

    Their normals are not normalized and their forms have other errors: what is sure is so by more than
    twice the bound. Where the column is NaN the code is 0.
    """
    largest = 0.0
    for k in range(5):
        largest = max(
            largest, abs(forms[k]) + frequency * max(abs(forms[6 + k]), abs(forms[12 + k]))
        )
    error = LATTICE_ERROR * largest * largest
    bound = 2.0 * bound * SQUARE * frequency * frequency
    least = ACCURATE * bound + error
    bound += error
    A_0, B_0, C_0, P_0, Q_0, T_0 = forms[0], forms[1], forms[2], forms[3], forms[4], forms[5]
    A_s, B_s, C_s, P_s, Q_s, T_s = forms[6], forms[7], forms[8], forms[9], forms[10], forms[11]
    A_t, B_t, C_t, P_t, Q_t, T_t = forms[12], forms[13], forms[14], forms[15], forms[16], forms[17]
    for begin in range(0, count + 1, 16):
        rows, columns, here = s[begin:], t[begin:], codes[begin:]
        for k in range(16):
            p = rows[k]
            q = columns[k]
            A = A_0 + p * A_s + q * A_t
            B = B_0 + p * B_s + q * B_t
            C = C_0 + p * C_s + q * C_t
            P = P_0 + p * P_s + q * P_t
            Q = Q_0 + p * Q_s + q * Q_t
            towards = T_0 + p * T_s + q * T_t
            # eliminated_forms (eq. (9) and Sect. 3.2): 11 operations as written, 11 here
            D = A * C - B * B
            U = B * Q - C * P
            V = B * P - A * Q
            W = D - U - V
            low = U if U < V else V
            low = low if low < W else W
            high = U if U > V else V
            high = high if high > W else W
            outside = ((low < -bound) & (high > bound)) | (not (towards > 0.0))
            sure = ((low > bound) | (high < -bound)) & (abs(D) > least)
            here[k] = np.int8(0) if outside else np.int8(1) if sure else np.int8(2)
    return count_open(codes, count)


@inner
def settle(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
    axis, sine, bound, face, frequency, s, t, count, row_and_column, tile, tile_codes, codes,
):  # fmt: skip
    """Classify the open points of a face by their normals."""
    k = 0
    while k < count:
        size = 0
        while codes[k + size] == 2 and size < TILE:
            size += 1
        if size > 0:
            write_line(face, frequency, int(s[k]), int(t[k]), 0, 1, size, row_and_column, tile)
            classify_tile(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                axis, sine, bound, tile, tile_codes, codes, k, size,
            )  # fmt: skip
        k += max(size, 1)


@inner
def classify_tile(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
    axis, sine, bound, tile, tile_codes, codes, first, size,
):  # fmt: skip
    """Write the codes of the normals of a tile from codes[first] on; see `classify`."""
    full = whole_vectors(size)
    x, y, z = tile[:full], tile[TILE_STEP:][:full], tile[2 * TILE_STEP :][:full]
    classify(
        a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
        axis, sine, bound, x, y, z, tile_codes,
    )  # fmt: skip
    if sine == math.inf:
        look_again(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
            x, y, z, tile_codes[:size],
        )  # fmt: skip
    for k in range(size):
        codes[first + k] = tile_codes[k]


@inner
def note_of(face, s, t, count, frequency):
    """Return the note of a run of points (s, t), (s, t + 1), … inside a face."""
    row = int(s)
    number = row_start(face, row, frequency) + int(t)
    return number << 32 | count << SIZE | face << ROW | row


@inner
def store_runs(face, frequency, s, t, count, codes, marks, turns, patch, found, at):
    """Write patch and note of the runs of points with the code 1 to `found` from `at` on; return the end.

    Runs begin and end, in turn, where codes change; most words of eight of them do not.
    """
    for k in range(whole_vectors(count)):
        marks[k + 1] = (codes[k] == 1) != (codes[k + 1] == 1)
    words = marks.view(np.int64)
    size = 0
    for word in range((count >> 3) + 1):
        if words[word] != 0:
            for k in range(8 * word, 8 * word + 8):
                turns[size] = k
                size += marks[k] & (k <= count)
    for k in range(size >> 1):
        start, end = turns[2 * k], turns[2 * k + 1]
        found[at + k, 0] = patch
        found[at + k, 1] = note_of(face, s[start], t[start], end - start, frequency)
    return at + (size >> 1)


@inner
def store_open(face, frequency, s, t, count, codes, patch, doubtful, at):
    """Write patch and note of each open point to `doubtful` from `at` on; return the end."""
    for k in range(count):
        if codes[k] == 2:
            doubtful[at, 0] = patch
            doubtful[at, 1] = note_of(face, s[k], t[k], 1, frequency)
            at += 1
    return at


@inner
def store_border(codes, numbers, count, patch, found, doubtful, counts):
    """Write patch and note of the single normals with the code 1 to `found`, of open ones to `doubtful`."""
    for k in range(count):
        note = numbers[k] << 32 | 1 << SIZE | 20 << ROW
        if codes[k] == 1:
            found[counts[0], 0] = patch
            found[counts[0], 1] = note
            counts[0] += 1
        elif codes[k] == 2:
            doubtful[counts[1], 0] = patch
            doubtful[counts[1], 1] = note
            counts[1] += 1


# --- what a sample holds --------------------------------------------------------------------------


@jit
def fill_runs(
    mu, scale, normals, frame, frequency, runs, start,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Fill the samples of runs (k, 2), the first of which is number `start`; see `fill_samples`."""
    columns = mu.shape[1] - 2
    tile, indices = new_tile(), np.zeros(2 * TILE_STEP, np.int64)
    places = np.zeros(2 * TILE_STEP, np.int64)
    at = known = first = 0
    face = 20  # of the samples of the tile whose normals are not yet known
    while first < runs.shape[0]:
        patch = runs[first, 0]
        last, total = first, 0
        while last < runs.shape[0] and runs[last, 0] == patch:
            total += runs[last, 1] >> SIZE & LONGEST
            last += 1
        if at > 0 and (total >= MANY or at + total > TILE):
            write_normals(face % 20, frequency, places, known, at - known, tile)
            fill_tile(
                tile, indices, at, start, scale, frame,
                points, directions, uv, support, gaussian, mean, normal_index, patch_index,
            )  # fmt: skip
            start += at
            at = known = 0
        end = TILE if total >= MANY else at + total
        load_patch(mu, patch // 4 // columns, patch // 4 % columns, patch % 4, scale, tile, at, end)
        for k in range(first, last):
            note = runs[k, 1]
            number, left, row = note >> 32, note >> SIZE & LONGEST, note & BEFORE_ROW
            if (note & BEFORE_SIZE) >> ROW != face:
                write_normals(face % 20, frequency, places, known, at - known, tile)
                known = at
                face = (note & BEFORE_SIZE) >> ROW
            while left > 0:
                size = min(left, TILE - at)
                write_run(
                    patch,
                    number,
                    row,
                    number - row_start(face, row, frequency),
                    at,
                    size,
                    indices,
                    places,
                )
                if face == 20:
                    for x in range(3):
                        tile[x * TILE_STEP + at] = normals[number, x]
                    known += 1
                at, number, left = at + size, number + size, left - size
                if at == TILE:
                    write_normals(face % 20, frequency, places, known, at - known, tile)
                    fill_tile(
                        tile, indices, at, start, scale, frame,
                        points, directions, uv, support, gaussian, mean, normal_index, patch_index,
                    )  # fmt: skip
                    start += at
                    at = known = 0
        first = last
    write_normals(face % 20, frequency, places, known, at - known, tile)
    fill_tile(
        tile, indices, at, start, scale, frame,
        points, directions, uv, support, gaussian, mean, normal_index, patch_index,
    )  # fmt: skip


@inner
def write_run(patch, number, row, column, at, count, indices, places):
    """Write the indices and the places of a run of samples from `at` on."""
    for k in range(count):
        here, beyond = np.uint64(at + k), np.uint64(at + TILE_STEP + k)
        indices[here] = number + k
        indices[beyond] = patch
        places[here] = row
        places[beyond] = column + k
