"""Cells of the parameters of a surface, with proved bounds of its derivatives.

Each cell has parameters s and t in [−1, 1]: u = u₀ + h_u s, v = v₀ + h_v t. Derivatives are taken
with respect to s and t, so that all derivatives in a cell have the same unit, as have those of the
height n·x for a unit normal n. `symbolic/proved.py` derives the bounds.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.proved import contraction, normal_ordinates, remainders
from ....generated.vectors import Patch, Vector
from ...directions.kernels.vectors import dot, length, set_row
from ...machine_code.jit import inline, jit, loop
from ...search.kernels.pieces import REST_S, REST_T
from ...tape.kernels.balls import BALL, evaluate_boxes
from ...tape.kernels.points import LANES, POINT, UU, UV, VV, U, V, evaluate_points
from ...tape.kernels.rounding import rounding_of_points

# Twice the unit roundoff.
EPS = 2.0**-52
# Bounds hold beyond the sides of a cell, so that neighbours share the points near a common side.
INFLATED = 1.0 + 1.0 / 16.0
# The columns of `hot`: five vectors of the patch, then bounds of its remainders.
HOT = 17
# The columns of `noise`: rounding errors of x_s, of x_t, and of second derivatives; how far bounds
# hold; the tolerances of n·x_s and of n·x_t at joints.
FIRST_S, FIRST_T, SECOND, REACH, TOLERANCE_S, TOLERANCE_T = range(6)
# In `noise`: the first of the three columns with bounds of the remainder of x_s, and the first of
# the three columns for x_t.
LEFT_S, LEFT_T = 6, 9
NOISE = 12
# Normals of both sides of a joint differ by at most this angle, in radians.
SMOOTH = 1e-9
# Chords of cones: above WIDE, the half angle is too wide to tell n from −n; OPEN means that normals
# have no bound.
WIDE, OPEN = 1.3, 2.1
# A cell counts as regular if the contraction factors of Newton's simplified method are below this,
# for five normals n: the directions of the Bernstein ordinates of x_s × x_t at the corners and in
# the middle.
REGULAR = 0.8
# A Hessian whose determinant is smaller than this, relative to its entries, counts as singular.
FLAT = 1e-9


class CellBounds(NamedTuple):
    """Bounds over cells; all arrays have one row for each cell.

    place (k, 4): u₀, v₀, h_u, h_v.
    hot (k, 17): the vectors a, b, c, d, e of the patch that osculates at the centre, and bounds of
    the remainders of x_s and x_t beyond it.
    thirds (k, 24): midpoints of x_sss, x_sst, x_stt, x_ttt over the cell, then bounds of the
    differences from these.
    noise (k, 12): the rounding errors of x_s, of x_t, and of second derivatives; the largest |s|,
    |t| for which all bounds hold (0 if there are no bounds, 1 if bounds end at a joint); the
    tolerances of n·x_s and n·x_t. At a joint the normals of both sides differ a little: there,
    |n·x_s| and |n·x_t| of a point with the normal n are not 0, but at most these tolerances. Then
    bounds of the coordinates of the remainders of x_s and x_t beyond the patch.
    cone (k, 4): the axis of a cone that holds the normals of the cell, and its chord, the distance
    of its border on the sphere from the axis.
    """

    place: NDArray[np.float64]
    hot: NDArray[np.float64]
    thirds: NDArray[np.float64]
    noise: NDArray[np.float64]
    cone: NDArray[np.float64]

    @classmethod
    def new(cls, count: int) -> CellBounds:
        """Return arrays for `count` cells."""
        return cls(*(np.zeros((count, columns)) for columns in (4, HOT, 24, NOISE, 4)))


class Work(NamedTuple):
    """Work arrays for tapes: registers of points and boxes, and the parameters of a tile."""

    registers: NDArray[np.float64]
    middles: NDArray[np.float64]
    radii: NDArray[np.float64]
    errors: NDArray[np.float64]
    ends: NDArray[np.float64]
    centres: NDArray[np.float64]
    half_widths: NDArray[np.float64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]
    levels: NDArray[np.float64]

    @classmethod
    def new(cls, rows: int) -> Work:
        """Return work arrays for tapes with this number of rows."""
        middles, radii, errors = np.zeros((3, BALL * (rows + 1)))
        centres, half_widths = np.zeros((2, LANES, 2))
        u, v, levels = np.zeros((3, LANES))
        registers, ends = np.zeros(POINT * rows), np.zeros((2, 4))
        return cls(registers, middles, radii, errors, ends, centres, half_widths, u, v, levels)


@inline
def gap_of(u, v, h_u, h_v):
    """Return a bound of the gap between the sides of neighbouring cells, due to rounding."""
    return 8.0 * EPS * (1.0 + max(abs(u) / h_u, abs(v) / h_v))


@inline
def patch_of(hot, j):
    """Return the patch that osculates the surface at the centre of cell j."""
    return Patch(
        Vector(hot[j, 0], hot[j, 1], hot[j, 2]),
        Vector(hot[j, 3], hot[j, 4], hot[j, 5]),
        Vector(hot[j, 6], hot[j, 7], hot[j, 8]),
        Vector(hot[j, 9], hot[j, 10], hot[j, 11]),
        Vector(hot[j, 12], hot[j, 13], hot[j, 14]),
        Vector(0.0, 0.0, 0.0),
    )


@inline
def linear_forms_of(patch, n):
    """Return A, B, C, P, Q of a patch and a normal."""
    return dot(patch.a, n), dot(patch.b, n), dot(patch.c, n), dot(patch.d, n), dot(patch.e, n)


@inline
def thirds_of(thirds, j, n):
    """Return midpoints and radii of the third derivatives of n·x over a cell."""
    x, y, z = abs(n.x), abs(n.y), abs(n.z)
    return (
        thirds[j, 0] * n.x + thirds[j, 1] * n.y + thirds[j, 2] * n.z,
        thirds[j, 3] * n.x + thirds[j, 4] * n.y + thirds[j, 5] * n.z,
        thirds[j, 6] * n.x + thirds[j, 7] * n.y + thirds[j, 8] * n.z,
        thirds[j, 9] * n.x + thirds[j, 10] * n.y + thirds[j, 11] * n.z,
        thirds[j, 12] * x + thirds[j, 13] * y + thirds[j, 14] * z,
        thirds[j, 15] * x + thirds[j, 16] * y + thirds[j, 17] * z,
        thirds[j, 18] * x + thirds[j, 19] * y + thirds[j, 20] * z,
        thirds[j, 21] * x + thirds[j, 22] * y + thirds[j, 23] * z,
    )


@inline
def inverse_of(a, b, c, t0, t1, t2, t3, r0, r1, r2, r3, second):
    """Return the inverse of the Hessian of n·x at the centre of a cell, and two bounds.

    They bound the difference from 1 of the product of this inverse and any Hessian of the cell: the
    first one for the change of the Hessian over the cell, the second one for rounding.
    """
    y11, y12, y22, q1, q2 = contraction(a, b, c, t0, t1, t2, t3, r0, r1, r2, r3)
    i11, i12, i22 = abs(y11), abs(y12), abs(y22)
    left, right = abs(a) + abs(b), abs(b) + abs(c)
    most = max(i11 + i12, i12 + i22)
    noise = 2.0 * second * most + 8.0 * EPS * max(
        i11 * left + i12 * right, i12 * left + i22 * right
    )
    return y11, y12, y22, max(q1, q2) * (1.0 + 16.0 * EPS), noise


@loop
def write_cells(tape, work, reach, cells, count):
    """Write bounds over the first `count` cells, at most LANES; their `place` is given.

    Bounds hold for |s|, |t| up to `reach`, or if this fails, up to 1, the sides of the cell. A cell
    without bounds gets the reach 0.
    """
    write_bounds(tape, work, reach, cells, count)
    for j in range(count):
        if cells.noise[j, REACH] == 0.0:
            write_bounds(tape, work, 1.0, cells, count)
            break
    for j in range(count):
        if cells.noise[j, REACH] == 0.0:
            cells.cone[j, 0], cells.cone[j, 1], cells.cone[j, 2], cells.cone[j, 3] = (
                0.0,
                0.0,
                1.0,
                OPEN,
            )
            cells.hot[j, REST_S] = cells.hot[j, REST_T] = math.inf
        else:
            write_rest(cells, j)
            write_cone(cells, j)


@loop
def write_rest(cells, j):
    """Write bounds of the remainders of x_s and x_t beyond the patch of cell j."""
    hot, noise, place = cells.hot, cells.noise, cells.place
    patch = patch_of(hot, j)
    # Neighbouring cells meet up to the rounding of their sides.
    gap = gap_of(place[j, 0], place[j, 1], place[j, 2], place[j, 3])
    left_s, left_t = rests_in(cells, j, 1.0 + 2.0 * gap, 1.0 + 2.0 * gap)
    a, b, c = length(patch.a), length(patch.b), length(patch.c)
    d, e = length(patch.d), length(patch.e)
    rest_s = length(left_s) * (1.0 + 4.0 * EPS) + gap * (a + b + d)
    rest_t = length(left_t) * (1.0 + 4.0 * EPS) + gap * (b + c + e)
    at_joint = noise[j, REACH] == 1.0
    noise[j, TOLERANCE_S] = SMOOTH * (d + a + b + rest_s) if at_joint else 0.0
    noise[j, TOLERANCE_T] = SMOOTH * (e + b + c + rest_t) if at_joint else 0.0
    hot[j, REST_S] = rest_s + noise[j, TOLERANCE_S]
    hot[j, REST_T] = rest_t + noise[j, TOLERANCE_T]
    write_left(noise, j, LEFT_S, widened(left_s, gap * (a + b + d) + noise[j, TOLERANCE_S]))
    write_left(noise, j, LEFT_T, widened(left_t, gap * (b + c + e) + noise[j, TOLERANCE_T]))


@inline
def write_left(noise, j, column, bounds):
    """Write bounds of the coordinates of a remainder to three columns of `noise`; see `left_of`."""
    noise[j, column], noise[j, column + 1], noise[j, column + 2] = bounds.x, bounds.y, bounds.z


@inline
def widened(bounds, slack):
    """Return bounds of coordinates, each enlarged by `slack`."""
    return Vector(bounds.x + slack, bounds.y + slack, bounds.z + slack)


@loop
def rests_in(cells, j, size_u, size_v):
    """Return bounds of the coordinates of the remainders of x_s and x_t in a part of cell j.

    The patch osculates the surface at the centre of the part. `size_u` and `size_v` are the sizes
    of the part, relative to the cell.
    """
    x0, x1, x2, x3 = thirds_along(cells.thirds, j, 0)
    y0, y1, y2, y3 = thirds_along(cells.thirds, j, 1)
    z0, z1, z2, z3 = thirds_along(cells.thirds, j, 2)
    x_s, x_t = remainders(x0, x1, x2, x3)
    y_s, y_t = remainders(y0, y1, y2, y3)
    z_s, z_t = remainders(z0, z1, z2, z3)
    square = max(size_u, size_v) ** 2
    second = 2.0 * square * cells.noise[j, SECOND]
    slack_s = size_u * cells.noise[j, FIRST_S] + second
    slack_t = size_v * cells.noise[j, FIRST_T] + second
    cubic_s, cubic_t = size_u * square * (1.0 + 4.0 * EPS), size_v * square * (1.0 + 4.0 * EPS)
    return (
        widened(Vector(cubic_s * x_s, cubic_s * y_s, cubic_s * z_s), slack_s),
        widened(Vector(cubic_t * x_t, cubic_t * y_t, cubic_t * z_t), slack_t),
    )


@inline
def thirds_along(thirds, j, x):
    """Return bounds of the coordinate with index `x` (0, 1 or 2) of x_sss, x_sst, x_stt, x_ttt."""
    return (
        abs(thirds[j, x]) + thirds[j, 12 + x],
        abs(thirds[j, 3 + x]) + thirds[j, 15 + x],
        abs(thirds[j, 6 + x]) + thirds[j, 18 + x],
        abs(thirds[j, 9 + x]) + thirds[j, 21 + x],
    )


@loop
def third_sizes(thirds, j):
    """Return bounds of the lengths of x_sss, x_sst, x_stt, x_ttt."""
    x0, x1, x2, x3 = thirds_along(thirds, j, 0)
    y0, y1, y2, y3 = thirds_along(thirds, j, 1)
    z0, z1, z2, z3 = thirds_along(thirds, j, 2)
    more = 1.0 + 4.0 * EPS
    return (
        length(Vector(x0, y0, z0)) * more,
        length(Vector(x1, y1, z1)) * more,
        length(Vector(x2, y2, z2)) * more,
        length(Vector(x3, y3, z3)) * more,
    )


@loop
def write_bounds(tape, work, reach, cells, count):
    """Write derivatives at centres, bounds as far as `reach`, and rounding errors.

    Cells without bounds get the reach 0. If `reach` is 1, cells that already have bounds are left
    unchanged.
    """
    place = cells.place
    # Where bounds end at the sides of cells, derivatives may jump there.
    wide = reach + 8.0 * EPS if reach > 1.0 else 1.0 - 8.0 * EPS
    for j in range(count):
        for k in range(2):
            work.centres[j, k], work.half_widths[j, k] = place[j, k], wide * place[j, 2 + k]
        work.u[j], work.v[j] = place[j, 0], place[j, 1]
    evaluate_points(tape, work.u, work.v, count, work.registers)
    for j in range(count):
        if reach > 1.0 or cells.noise[j, REACH] == 0.0:
            write_patch(tape, work.registers, cells, j)
    evaluate_boxes(
        tape, 3, work.centres, work.half_widths, count, work.middles, work.radii, work.ends
    )
    for j in range(count):
        if reach > 1.0 or cells.noise[j, REACH] == 0.0:
            write_thirds(tape, work, cells, j)
    rounding_of_points(
        tape,
        work.centres,
        work.half_widths,
        count,
        work.middles,
        work.radii,
        work.errors,
        work.ends,
    )
    for j in range(count):
        if reach > 1.0 or cells.noise[j, REACH] == 0.0:
            write_noise(tape, work.errors, reach, cells, j)


@loop
def write_patch(tape, registers, cells, j):
    """Write the derivatives at the centre of cell j, from lane j of registers."""
    hot, h_u, h_v = cells.hot, cells.place[j, 2], cells.place[j, 3]
    for x in range(3):
        at = np.uint64(POINT * tape.outputs[x] + j)
        hot[j, x] = 2.0 * h_u * h_u * registers[at + UU]
        hot[j, 3 + x] = h_u * h_v * registers[at + UV]
        hot[j, 6 + x] = 2.0 * h_v * h_v * registers[at + VV]
        hot[j, 9 + x] = h_u * registers[at + U]
        hot[j, 12 + x] = h_v * registers[at + V]


@loop
def write_thirds(tape, work, cells, j):
    """Write the third derivatives in cell j, from lane j of registers."""
    h_u, h_v = cells.place[j, 2], cells.place[j, 3]
    for k in range(4):
        scale = h_u ** (3 - k) * h_v**k * (6.0 if k == 0 or k == 3 else 2.0)
        for x in range(3):
            at = np.uint64(BALL * tape.outputs[x] + (6 + k) * LANES + j)
            middle = scale * work.middles[at]
            cells.thirds[j, 3 * k + x] = middle
            cells.thirds[j, 12 + 3 * k + x] = scale * work.radii[at] * (
                1.0 + 8.0 * EPS
            ) + 8.0 * EPS * abs(middle)


@loop
def write_noise(tape, errors, reach, cells, j):
    """Write rounding errors of derivatives, scaled to cell j, from lane j of errors."""
    hot, noise = cells.hot, cells.noise
    h_u, h_v = cells.place[j, 2], cells.place[j, 3]
    first_s = first_t = second = 0.0
    t0, t1, t2, t3 = third_sizes(cells.thirds, j)
    for x in range(3):
        at = np.uint64(BALL * tape.outputs[x] + j)
        first_s += h_u * errors[at + U] + 4.0 * EPS * (
            abs(hot[j, 9 + x]) + abs(hot[j, x]) + abs(hot[j, 3 + x])
        )
        first_t += h_v * errors[at + V] + 4.0 * EPS * (
            abs(hot[j, 12 + x]) + abs(hot[j, 3 + x]) + abs(hot[j, 6 + x])
        )
        second += max(
            2.0 * h_u * h_u * errors[at + UU] + 4.0 * EPS * abs(hot[j, x]),
            h_u * h_v * errors[at + UV] + 4.0 * EPS * abs(hot[j, 3 + x]),
            2.0 * h_v * h_v * errors[at + VV] + 4.0 * EPS * abs(hot[j, 6 + x]),
        )
    # Rounding is relative to derivatives, which change over the cell by the third derivatives.
    noise[j, FIRST_S] = first_s + 8.0 * EPS * (t0 + t1 + t2)
    noise[j, FIRST_T] = first_t + 8.0 * EPS * (t1 + t2 + t3)
    noise[j, SECOND] = second + 8.0 * EPS * (t0 + t1 + t2 + t3)
    total = noise[j, FIRST_S] + noise[j, FIRST_T] + noise[j, SECOND] + t0 + t1 + t2 + t3
    for x in range(15):
        total += abs(hot[j, x])
    noise[j, REACH] = reach if math.isfinite(total) else 0.0


@loop
def normal_error(patch, rest_s, rest_t):
    """Return a bound of the remainder of x_s × x_t beyond a patch, from bounds of coordinates.

    Where x_s and x_t are nearly parallel, a bound from lengths alone would be far too large.
    """
    along = sizes_of(patch.d, patch.a, patch.b)
    across = sizes_of(patch.e, patch.b, patch.c)
    error = Vector(
        rest_s.y * (across.z + rest_t.z) + rest_s.z * (across.y + rest_t.y)
        + rest_t.y * along.z + rest_t.z * along.y,
        rest_s.z * (across.x + rest_t.x) + rest_s.x * (across.z + rest_t.z)
        + rest_t.z * along.x + rest_t.x * along.z,
        rest_s.x * (across.y + rest_t.y) + rest_s.y * (across.x + rest_t.x)
        + rest_t.x * along.y + rest_t.y * along.x,
    )  # fmt: skip
    return length(error) * (1.0 + 16.0 * EPS) + 16.0 * EPS * length(along) * length(across)


@inline
def sizes_of(v, w, x):
    """Return the sums of the moduli of the coordinates of three vectors."""
    return Vector(
        abs(v.x) + abs(w.x) + abs(x.x), abs(v.y) + abs(w.y) + abs(x.y),
        abs(v.z) + abs(w.z) + abs(x.z),
    )  # fmt: skip


@inline
def left_of(cells, j, column):
    """Return bounds of the coordinates of the remainder of x_s or x_t in cell j."""
    noise = cells.noise
    return Vector(noise[j, column], noise[j, column + 1], noise[j, column + 2])


@loop
def side_of(patch, rest_s, rest_t, n):
    """Return the common sign of the products of n and all normals of a cell; 0 if it is unknown."""
    ordinates = normal_ordinates(patch)
    error = normal_error(patch, rest_s, rest_t)
    least, most = math.inf, -math.inf
    for k in range(9):
        height = dot(ordinates[k], n)
        least, most = min(least, height), max(most, height)
    return 1 if least > error else -1 if most < -error else 0


@loop
def side_in(cells, j, n):
    """Return the sign of the products of n and the normals of cell j, 0 if unknown."""
    return side_of(patch_of(cells.hot, j), left_of(cells, j, LEFT_S), left_of(cells, j, LEFT_T), n)


@loop
def write_cone(cells, j):
    """Write a cone that contains the normals of cell j.

    It is the cone around the Bernstein ordinates of the normals, each with an error bound.
    """
    hot, cone = cells.hot, cells.cone
    patch = patch_of(hot, j)
    ordinates = normal_ordinates(patch)
    axis = ordinates[4]
    size = length(axis)
    cone[j, 3] = OPEN
    if size == 0.0:
        set_row(cone, j, Vector(0.0, 0.0, 1.0))
        return
    axis = Vector(axis.x / size, axis.y / size, axis.z / size)
    set_row(cone, j, axis)
    error = normal_error(patch, left_of(cells, j, LEFT_S), left_of(cells, j, LEFT_T))
    tangent = 0.0
    for k in range(9):
        height = dot(ordinates[k], axis)
        if not height > error:
            return
        off = Vector(
            ordinates[k].x - height * axis.x,
            ordinates[k].y - height * axis.y,
            ordinates[k].z - height * axis.z,
        )
        tangent = max(tangent, (length(off) + error) / (height - error))
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    # The square of the chord is 2 − 2 cos = 2 tan² cos² / (1 + cos). It is enlarged by the rounding
    # error of the square of a distance between unit vectors.
    square = 2.0 * (tangent * cosine) ** 2 / (1.0 + cosine)
    cone[j, 3] = math.sqrt(square * (1.0 + 16.0 * EPS) + 32.0 * EPS)


@jit
def write_one_cone(cells):
    """Write the cone of the normals of the first cell."""
    write_cone(cells, 0)


@loop
def is_done(cells, j):
    """Return whether a cell counts as regular (see REGULAR), or is flat."""
    if cells.noise[j, REACH] == 0.0 or cells.cone[j, 3] >= WIDE:
        return False
    patch = patch_of(cells.hot, j)
    ordinates = normal_ordinates(patch)
    for k in (4, 0, 2, 6, 8):
        size = length(ordinates[k])
        n = Vector(ordinates[k].x / size, ordinates[k].y / size, ordinates[k].z / size)
        a, b, c, _, _ = linear_forms_of(patch, n)
        if k == 4 and abs(a * c - b * b) <= FLAT * (a * a + b * b + c * c):
            return True
        t0, t1, t2, t3, r0, r1, r2, r3 = thirds_of(cells.thirds, j, n)
        _, _, _, q, noise = inverse_of(
            a, b, c, t0, t1, t2, t3, r0, r1, r2, r3, cells.noise[j, SECOND]
        )
        if not q + noise < REGULAR:
            return False
    return True


@loop
def copy_cell(cells, j, target, k):
    """Copy cell j of `cells` to row k of `target`."""
    for x in range(4):
        target.place[k, x], target.cone[k, x] = cells.place[j, x], cells.cone[j, x]
    for x in range(NOISE):
        target.noise[k, x] = cells.noise[j, x]
    for x in range(HOT):
        target.hot[k, x] = cells.hot[j, x]
    for x in range(24):
        target.thirds[k, x] = cells.thirds[j, x]


@jit
def cut_cells(tape, work, places, state, last, levels, stack, tile, cells):
    """Cut base cells into four parts, again and again until the parts are regular; write these.

    The base cells are rows of places (k, 4), cut at most `levels` times. `state` holds the next
    base cell, the number of cells on the `stack` (…, 5), and the number of cells written. The
    function returns at base cell `last`, or when there is no more room. `tile` are work arrays for
    LANES cells.
    """
    count = 0
    while count + LANES <= cells.place.shape[0] and (state[0] < last or state[1] > 0):
        while state[1] < LANES and state[0] < last:
            base = places[state[0]]
            put_on_stack(stack, state, base[0], base[1], base[2], base[3], 0.0)
            state[0] += 1
        taken = min(state[1], LANES)
        state[1] -= taken
        for j in range(taken):
            for x in range(4):
                tile.place[j, x] = stack[state[1] + j, x]
            work.levels[j] = stack[state[1] + j, 4]
        write_cells(tape, work, INFLATED, tile, taken)
        for j in range(taken):
            if work.levels[j] >= levels or is_done(tile, j):
                copy_cell(tile, j, cells, count)
                count += 1
                continue
            u, v, h_u, h_v = (
                tile.place[j, 0],
                tile.place[j, 1],
                0.5 * tile.place[j, 2],
                0.5 * tile.place[j, 3],
            )
            for part in range(4):
                put_on_stack(
                    stack, state, u + (h_u if part & 1 else -h_u),
                    v + (h_v if part & 2 else -h_v), h_u, h_v, work.levels[j] + 1.0,
                )  # fmt: skip
    state[2] = count


@loop
def put_on_stack(stack, state, u, v, h_u, h_v, level):
    """Add a cell to the stack."""
    top = state[1]
    stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3], stack[top, 4] = (
        u,
        v,
        h_u,
        h_v,
        level,
    )
    state[1] += 1
