"""For each bin of the sphere, a list of the pieces whose cones of normals meet it.

Bins are squares on the faces of a cube around the sphere. If all cones lie in a cap, only the face
+z has bins, and a linear map, the frame (3, 3), takes the cap to this face. On each face, bins are
numbered along a Morton curve, so that the leading bits of a number are that of a coarser bin.
Keys are sorted by their leading bits with a stable counting sort.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.vectors import Vector
from ...directions.kernels.vectors import row_vector, set_row
from ...machine_code.jit import inline, jit, loop
from .pieces import CHORD, SLAB, WIDTH

# The number of times that faces are halved along both directions, for the bins in keys of normals.
FINEST = np.int64(12)
# The bit mask of the index in a key.
NUMBER = (1 << 32) - 1
# For cones with a larger chord, all bins are tested.
WIDE = 0.5
ZENITH = np.int64(4)  # the face +z


class Lists(NamedTuple):
    """The bins and their lists of pieces.

    `frame` (3, 3) maps directions to the cube, and `inverse` back; `faces` is the number of its
    faces with bins, `level` the number of times that these are halved along both directions. Bin b
    lists the pieces with the indices members[starts[b]:starts[b + 1]].
    """

    frame: NDArray[np.float64]
    inverse: NDArray[np.float64]
    faces: int
    level: int
    starts: NDArray[np.int64]
    members: NDArray[np.int32]


@inline
def cube_face(n):
    """Return the face of the cube that a ray n meets, and the coordinates there (in −1 … 1).

    The faces are +x, −x, +y, −y, +z, −z.
    """
    x, y, z = abs(n.x), abs(n.y), abs(n.z)
    axis = 0 if x >= y and x >= z else 1 if y >= z else 2
    height = n[axis]
    size = abs(height)
    face = 2 * axis if height > 0.0 else 2 * axis + 1
    return face, n[(axis + 1) % 3] / size, n[(axis + 2) % 3] / size


@loop
def nearest_bin(position, grid):
    """Return the row or column of the grid that contains a position, clamped to the grid."""
    return min(max(int(position), 0), grid - 1)


@inline
def bin_index(s, grid):
    """Return the row or column of a face coordinate s in −1 … 1.

    It is a monotonic function of s, rounding included.
    """
    return nearest_bin((s + 1.0) * (0.5 * grid), grid)


@loop
def mapped(frame, n):
    """Return the image of a vector under a linear map (3, 3)."""
    return Vector(
        frame[0, 0] * n.x + frame[0, 1] * n.y + frame[0, 2] * n.z,
        frame[1, 0] * n.x + frame[1, 1] * n.y + frame[1, 2] * n.z,
        frame[2, 0] * n.x + frame[2, 1] * n.y + frame[2, 2] * n.z,
    )


@inline
def spread_bits(x):
    """Return the bits of a 16-bit number, with a zero inserted before each bit."""
    x = (x | x << 8) & 0x00FF00FF
    x = (x | x << 4) & 0x0F0F0F0F
    x = (x | x << 2) & 0x33333333
    return (x | x << 1) & 0x55555555


@loop
def bin_number(face, row, column, level):
    """Return the number of a bin along the Morton curve of its face."""
    return (face << 2 * level) + (spread_bits(row) << 1) + spread_bits(column)


@jit
def order_normals(normals, frame, faces, first, last, keys):
    """For each of the normals [first, last), write the key bin << 32 | index of the normal.

    The key is −1 for a normal without a bin.
    """
    grid = np.int64(1) << FINEST
    for k in range(first, last):
        face, s, t = cube_face(mapped(frame, row_vector(normals, k)))
        if faces == 1:
            if face != ZENITH:
                keys[k] = -1
                continue
            face = np.int64(0)
        row, column = np.int64(bin_index(t, grid)), np.int64(bin_index(s, grid))
        keys[k] = bin_number(np.int64(face), row, column, FINEST) << 32 | k


@inline
def face_of(faces, k):
    """Return the number of the k-th face with bins: all six faces have bins, or only +z."""
    return ZENITH if faces == 1 else np.int64(k)


@loop
def direction(inverse, face, s, t):
    """Return the unit vector at (s, t) of a face of the cube."""
    axis, high = face >> 1, 1.0 if face & 1 == 0 else -1.0
    x, y, z = (high, s, t) if axis == 0 else (t, high, s) if axis == 1 else (s, t, high)
    n = mapped(inverse, Vector(x, y, z))
    size = 1.0 / math.sqrt(n.x * n.x + n.y * n.y + n.z * n.z)
    return Vector(n.x * size, n.y * size, n.z * size)


@jit
def write_caps(inverse, faces, level, caps):
    """For each bin, write a cap that contains the bin: axis and radius, the latter as a chord."""
    grid = np.int64(1) << level
    half = 1.0 / grid
    for k in range(faces):
        face = face_of(faces, k)
        for row in range(grid):
            for column in range(grid):
                s, t = (2 * column + 1) * half - 1.0, (2 * row + 1) * half - 1.0
                middle = direction(inverse, face, s, t)
                square = 0.0
                for corner in range(4):
                    x = half if corner & 1 else -half
                    y = half if corner & 2 else -half
                    n = direction(inverse, face, s + x, t + y)
                    x, y, z = n.x - middle.x, n.y - middle.y, n.z - middle.z
                    square = max(square, x * x + y * y + z * z)
                at = bin_number(np.int64(k), row, column, level)
                set_row(caps, at, middle)
                caps[at, 3] = math.sqrt(square) * (1.0 + 1e-12) + 1e-15


@inline
def meets(cone, cap):
    """Return whether a cap may contain a direction that is both in a cone and in its slab."""
    x, y, z = cone[0] - cap[0], cone[1] - cap[1], cone[2] - cap[2]
    reach = cone[CHORD] + cap[3]
    across = cone[SLAB] * cap[0] + cone[SLAB + 1] * cap[1] + cone[SLAB + 2] * cap[2]
    return (x * x + y * y + z * z <= reach * reach) & (abs(across) <= cone[WIDTH] + cap[3])


@jit
def list_pieces(cones, caps, frame, faces, level, stretch, least, keys):
    """Write a key bin << 32 | piece for each bin that the cone of a piece meets.

    Return the number of keys, including those for which `keys` has no room. `stretch` is the norm
    of the frame, `least` the least cosine between a direction and the axis of the face that it
    meets.
    """
    count = 0
    grid = np.int64(1) << level
    for j in range(cones.shape[0]):
        cone = cones[j]
        chord = cone[CHORD]
        axis = mapped(frame, row_vector(cones, j))
        for k in range(faces):
            face = face_of(faces, k)
            left, right, bottom, top = np.int64(0), grid - 1, np.int64(0), grid - 1
            if chord < WIDE:
                height = axis[face >> 1] if face & 1 == 0 else -axis[face >> 1]
                if height + chord < least:
                    continue
                # If a direction changes by at most the chord, its position s = x / height on the
                # face changes by at most ds, since heights are at least `least` there.
                x, y = axis[((face >> 1) + 1) % 3], axis[((face >> 1) + 2) % 3]
                step = chord * stretch / (height * max(least, height - chord))
                s, ds = x / height, step * math.sqrt((x / stretch) ** 2 + height * height)
                t, dt = y / height, step * math.sqrt((y / stretch) ** 2 + height * height)
                if abs(s) > 1.0 + ds or abs(t) > 1.0 + dt:
                    continue
                left, right = bin_index(s - ds, grid), bin_index(s + ds, grid)
                bottom, top = bin_index(t - dt, grid), bin_index(t + dt, grid)
            for row in range(bottom, top + 1):
                for column in range(left, right + 1):
                    b = bin_number(np.int64(k), np.int64(row), np.int64(column), level)
                    if meets(cone, caps[b]):
                        if count < keys.size:
                            keys[count] = b << 32 | j
                        count += 1
    return count


# --- keys sorted by their leading bits ------------------------------------------------------------


@jit
def count_keys(keys, shift, starts):
    """For each value b of leading bits, add the number of keys with these bits to starts[b + 1]."""
    for k in range(keys.size):
        starts[np.uint64((keys[k] >> shift) + 1)] += 1


@jit
def place_keys(keys, shift, starts, ordered):
    """Write each key to the next free position for its leading bits, and advance `starts`.

    starts[b] is the next free position for keys with the leading bits b.
    """
    for k in range(keys.size):
        b = np.uint64(keys[k] >> shift)
        ordered[np.uint64(starts[b])] = keys[k]
        starts[b] += 1


@jit
def order_few(keys):
    """Sort nearly sorted keys in place (insertion sort)."""
    for k in range(1, keys.size):
        key, at = keys[k], k
        while at > 0 and keys[at - 1] > key:
            keys[at] = keys[at - 1]
            at -= 1
        keys[at] = key
