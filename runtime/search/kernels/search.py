"""The search for the pieces of a surface that have given normals.

The normals are sorted by bins of the sphere. A tile is a group of up to LANES normals of one bin.
Those pieces of the bin whose cones meet a cap around the tile are tested for all of its normals.
For a patch of a spline, the signs of the forms U, V, W and D decide; a cell of a surface is either
excluded, or left to the proof.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.patch import forms, parameters
from ....generated.proved import excesses
from ....generated.vectors import Patch, Vector
from ...base.tolerances import ACCURATE
from ...directions.kernels.vectors import dot, row_vector
from ...machine_code.jit import inline, jit, loop
from ...spline.kernels.patch import normal_of_patch
from .lists import FINEST, NUMBER, meets
from .pieces import BOUND, CHORD, DATA_BOUND, EVERYTHING, REST_S, REST_T, WIDTH

# The kinds of pieces.
PATCHES, CELLS = 0, 1

# The number of normals of a tile, and the number of normals that are tested at a time.
LANES, STEP = 64, 8
# Rows of a tile: x, y, z of the normals, and their codes.
Y, Z, CODE = (np.uint64(k * LANES) for k in range(1, 4))
# The codes of a normal and a piece: the piece lacks the normal, has it, or may have it.
NO, YES, UNDECIDED = 0.0, 1.0, 2.0


class Memory(NamedTuple):
    """Work arrays: a tile of normals, a cap (4,) around it, and the pieces that meet the cap."""

    tile: NDArray[np.float64]
    cap: NDArray[np.float64]
    near: NDArray[np.int64]

    @classmethod
    def new(cls, members: int) -> Memory:
        """Return new work arrays, for bins that list up to `members` pieces."""
        return cls(np.zeros(4 * LANES), np.zeros(4), np.empty(members + 1, np.int64))


class Pairs(NamedTuple):
    """Pairs of a normal and a piece that has it, or may have it, as keys.

    A key is (index of the normal) << 32 | index of the piece. The first counts[0] keys of `certain`
    and the first counts[1] keys of `undecided` are used.
    """

    certain: NDArray[np.int64]
    undecided: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, room: int) -> Pairs:
        """Return empty arrays for up to `room` certain and `room` undecided keys."""
        return cls(np.empty(room, np.int64), np.empty(room, np.int64), np.zeros(2, np.int64))


@jit
def search(kind, pieces, lists, normals, order, first, last, memory, found):
    """Write the pairs of the normals order[first], …, order[last − 1] and pieces to `found`.

    All pieces are of one kind; `order` (S,) are keys of `order_normals`. Return `last` and 0. If
    `found` has no room for a tile, return the position in `order` at which the tile begins, and the
    capacity that the tile needs.
    """
    tile, cap, near = memory
    cones, starts, members = pieces.cones, lists.starts, lists.members
    shift = 32 + 2 * (FINEST - lists.level)
    found.counts[0] = found.counts[1] = 0
    at = first
    while at < last:
        square = order[at] >> shift
        end = at + 1
        while end < last and end - at < LANES and order[end] >> shift == square:
            end += 1
        count = end - at
        load_tile(tile, normals, order, at, end, cap)
        size = near_pieces(cones, members, starts[square], starts[square + 1], cap, near)
        if max(found.counts[0], found.counts[1]) + size * count > found.certain.size:
            return at, size * count
        for m in range(size):
            j = near[m]
            if kind == CELLS:
                exclude_tile(cones[j], pieces.patches[j], tile, count)
            else:
                test_tile(cones[j], pieces.patches[j], tile, count)
                if cones[j, WIDTH] >= EVERYTHING:
                    look_again(pieces.patches[j], tile, count)
            store(tile, count, order, at, j, found)
        at = end
    return last, 0


@loop
def load_tile(tile, normals, order, first, last, cap):
    """Write the normals of the keys order[first:last] to a tile, and a cap that contains them."""
    x = y = z = square = 0.0
    count = last - first
    for k in range(count):
        i = np.uint64(k)
        n = row_vector(normals, np.uint64(order[first + k] & NUMBER))
        tile[i], tile[i + Y], tile[i + Z] = n.x, n.y, n.z
        x, y, z = x + n.x, y + n.y, z + n.z
    share = 1.0 / count
    x, y, z = x * share, y * share, z * share
    for k in range(count):
        i = np.uint64(k)
        square = max(square, (tile[i] - x) ** 2 + (tile[i + Y] - y) ** 2 + (tile[i + Z] - z) ** 2)
    cap[0], cap[1], cap[2], cap[3] = x, y, z, math.sqrt(square) * (1.0 + 1e-12) + 1e-15
    for k in range(count, (count + STEP - 1) // STEP * STEP):
        i = np.uint64(k)
        tile[i], tile[i + Y], tile[i + Z] = x, y, z


@loop
def near_pieces(cones, members, first, last, cap, near):
    """Write the indices of the pieces of a bin whose cones meet a cap; return their number."""
    count = np.int64(0)
    for m in range(first, last):
        j = np.int64(members[m])
        near[count] = j
        count += meets(cones[j], cap)
    return count


@inline
def patch_in(row):
    """Return the patch with the vectors a, b, c, d, e in a row of `Pieces.patches`.

    The row does not have p₀, which is set to 0.
    """
    return Patch(
        Vector(row[0], row[1], row[2]),
        Vector(row[3], row[4], row[5]),
        Vector(row[6], row[7], row[8]),
        Vector(row[9], row[10], row[11]),
        Vector(row[12], row[13], row[14]),
        Vector(0.0, 0.0, 0.0),
    )


@loop
def test_tile(cone, row, tile, count):
    """Write the codes of the normals of a tile for one patch.

    The patch has a normal if its forms U, V, W and D have the same sign there (paper, Sect. 3.2),
    and if the normal is in the cone. The forms alone do not distinguish a normal from its opposite.
    A normal is also undecided if, up to the rounding of coordinates, a line of the patch may have
    it.
    """
    patch = patch_in(row)
    axis, square = Vector(cone[0], cone[1], cone[2]), cone[CHORD] * cone[CHORD]
    bound, wide = row[BOUND], row[DATA_BOUND]
    least = max(ACCURATE * bound, wide)
    for start in range(0, count, STEP):
        for c in range(STEP):
            i = np.uint64(start + c)  # unsigned: no check for negative indices
            n = Vector(tile[i], tile[i + Y], tile[i + Z])
            D, U, V, W = forms(patch, n)
            low = U if U < V else V
            low = low if low < W else W
            high = U if U > V else V
            high = high if high > W else W
            x, y, z = n.x - axis.x, n.y - axis.y, n.z - axis.z
            out = ((low < -wide) & (high > wide)) | (x * x + y * y + z * z > square)
            sure = ((low > bound) | (high < -bound)) & (abs(D) > least)
            tile[i + CODE] = NO if out else YES if sure else UNDECIDED


@loop
def exclude_tile(cone, row, tile, count):
    """Write the codes of the normals of a tile for one cell of a surface.

    The code is NO where bounds of the cell exclude the normal. Elsewhere it is YES, or UNDECIDED if
    the cone does not distinguish a normal from its opposite.
    """
    patch, rest_s, rest_t = patch_in(row), row[REST_S], row[REST_T]
    axis, square = Vector(cone[0], cone[1], cone[2]), cone[CHORD] * cone[CHORD]
    code = UNDECIDED if cone[WIDTH] >= EVERYTHING else YES
    for start in range(0, count, STEP):
        for c in range(STEP):
            i = np.uint64(start + c)
            n = Vector(tile[i], tile[i + Y], tile[i + Z])
            e1, e2, e3, e4 = excesses(
                dot(patch.a, n), dot(patch.b, n), dot(patch.c, n), dot(patch.d, n),
                dot(patch.e, n), rest_s, rest_t,
            )  # fmt: skip
            x, y, z = n.x - axis.x, n.y - axis.y, n.z - axis.z
            largest = max(max(e1, e2), max(e3, e4))
            tile[i + CODE] = NO if (largest > 0.0) | (x * x + y * y + z * z > square) else code


@loop
def look_again(row, tile, count):
    """Reject normals of a tile of which the patch has only the opposites.

    A patch without a narrow cone needs this, since the forms do not distinguish a normal from its
    opposite. Each normal with the code YES is compared with the oriented normal of the patch at the
    parameters of the hit.
    """
    patch = patch_in(row)
    for k in range(count):
        i = np.uint64(k)
        if tile[i + CODE] == YES:
            n = Vector(tile[i], tile[i + Y], tile[i + Z])
            D, U, V, _ = forms(patch, n)
            u, v = parameters(D, U, V)
            N = normal_of_patch(patch, u, v)
            towards = dot(n, N)
            size = abs(N.x) + abs(N.y) + abs(N.z)
            sure = abs(towards) > 0.25 * size and size > 0.0
            tile[i + CODE] = UNDECIDED if not sure else NO if towards < 0.0 else YES


@loop
def store(tile, count, order, first, j, found):
    """Write a key for each normal of a tile that piece j has or may have."""
    certain, undecided, counts = found
    a, b = counts[0], counts[1]
    for k in range(count):
        code = tile[np.uint64(k) + CODE]
        if code != NO:  # a branch: most pieces lack the normal, and storing always would be slower
            key = (order[np.uint64(first + k)] & NUMBER) << 32 | j
            if code == YES:
                certain[np.uint64(a)] = key
                a += 1
            else:
                undecided[np.uint64(b)] = key
                b += 1
    counts[0], counts[1] = a, b
