"""The degree of the Gauss map on a box that may cross joints: no point with a normal, or one.

A joint is a line u = const or v = const where second derivatives of the surface may jump, and first
ones, too, as long as the tangent plane does not. Joints cut the box into parts. Where the surface
is a graph over a plane perpendicular to n, minus the gradient of the height n·x is

    G = (Y1 F2 − F1 Y2, F1 X2 − X1 F2) / (X1 Y2 − X2 Y1),    F = (n·x_u, n·x_v),

with the coordinates (X1, Y1) of x_u and (X2, Y2) of x_v in the plane. G does not depend on the
parameters, so that it is continuous at joints. If the Hessian of n·x has a determinant of one sign
d in all parts, the index of each zero of G is d. The winding number of G along the border of the
box is the sum of these indices: d if there is one zero, 0 if there is none.
"""

from __future__ import annotations

import math

import numpy as np

from ....generated.proved import model_at, remainders
from ....generated.vectors import Vector
from ...directions.kernels.vectors import dot, length
from ...machine_code.jit import inline, loop
from ...search.kernels.pieces import REST_S, REST_T
from ...tape.kernels.points import LANES, POINT, evaluate_points
from .answers import BORDER
from .cell_bounds import (
    EPS,
    FIRST_S,
    FIRST_T,
    REACH,
    SECOND,
    SMOOTH,
    TOLERANCE_S,
    TOLERANCE_T,
    gap_of,
    inverse_of,
    linear_forms_of,
    patch_of,
    side_in,
    thirds_of,
    write_cells,
)
from .pairs import (
    DETERMINANT,
    HARD,
    HU,
    HV,
    MORE,
    ONE,
    RADIUS,
    STATE,
    U0,
    V0,
    S,
    T,
    bound_pairs,
    distance,
    forms_at,
    improve_pairs,
    is_beyond,
    load_pair,
    most_of,
    newton,
)

# A box is decided if it is known to contain exactly one point with the normal, or none.
UNDECIDED, DECIDED = range(2)
# Boxes grow on each side by the part GROWN of their width, since no point of their border may have
# the normal, and at least by the part LEAST of the domain, since near a joint normals are known
# only up to a tolerance. If a joint is nearer to a side than the part NEAR_SIDE of the width, the
# side moves to the joint.
GROWN, LEAST, NEAR_SIDE = 0.4, 2.0**-23, 0.05
# The largest number of parts of a box along u, and along v.
PARTS = 4
# Half the length of the first segment that is tried on a side of a part, and the least length of a
# segment; a side has the length 2.
LONGEST, SHORTEST = 1.0, 2.0**-14
# The relative error of the computed gradient at ends of segments is at most this, so that two
# errors and the jump at a joint add up to less than half a turn.
ERROR = 0.3
# The given normal differs from the normals on the border of a box by at least this multiple of the
# tolerance of normals.
AWAY = 4.0
STEPS = 8
# The number of entries of a path along a border, see `walk_side`.
PATH = 6
# How a box lies along a parameter: inside of the domain, over a whole period, at the lower or at
# the upper end of the domain.
INSIDE, SEAM, BEFORE, AFTER = range(4)
# A hull counts as small if it is at most LARGEST times the domain. Its index is computed along the
# border of a larger box, since the gradient is too small next to the hull. On each side the box
# exceeds the hull by a fraction of the domain (the fractions in AROUND are tried in turn) or, if
# that is more, by GROWN times the size of the hull. For a large hull only fractions from FAR on are
# tried, and BEYOND replaces GROWN. The border has up to LANES cells, whose half width across the
# border is THIN times the size of the box.
LARGEST, AROUND, THIN = 0.01, (3e-6, 1e-4, 1e-3, 1e-2, 3e-2), 2.0**-7
FAR, BEYOND = 1e-2, 0.1


@loop
def ends_of_parts(lines, period, low, high, ends):
    """Write the ends of the parts into which lines, modulo a period, cut an interval.

    Returns the number of parts, 0 if there are too many.
    """
    slack = NEAR_SIDE * (high - low)
    ends[0], count = low, 1
    first, last = 0, 0
    if period > 0.0:
        first, last = -2, 2
    previous = low
    while True:
        least = math.inf
        for k in range(lines.size):
            for turn in range(first, last + 1):
                x = lines[k] + turn * period
                if x > previous and x < least:
                    least = x
        if least >= high + slack:
            break
        previous = least
        if count == 1 and least < low + slack:
            ends[0] = least
            continue
        if least > high - slack:
            high = least
            break
        if count == PARTS:
            return 0
        ends[count] = least
        count += 1
    ends[count] = high
    return count


@loop
def write_blocks(creases, domain, hull, blocks):
    """Write the ends of the blocks into which creases cut a hull, after growing it.

    Returns the numbers of blocks along u and along v, and whether the grown hull is one block that
    ends at no crease.
    """
    grown_u = max(GROWN * (hull[1] - hull[0]), LEAST * (domain[1] - domain[0]))
    grown_v = max(GROWN * (hull[3] - hull[2]), LEAST * (domain[3] - domain[2]))
    u0, u1, v0, v1 = hull[0] - grown_u, hull[1] + grown_u, hull[2] - grown_v, hull[3] + grown_v
    along = ends_of_parts(creases.u, domain[4], u0, u1, blocks[0])
    across = ends_of_parts(creases.v, domain[5], v0, v1, blocks[1])
    in_u = blocks[0, 0] == u0 and blocks[0, 1] == u1
    return along, across, in_u and blocks[1, 0] == v0 and blocks[1, 1] == v1


@loop
def write_parts(tape, work, tile, joints, domain, blocks, i, j, ends):
    """Write bounds over the parts of block i, j to a tile.

    Returns the numbers of parts along u and along v.
    """
    along = ends_of_parts(joints.u, domain[4], blocks[0, i], blocks[0, i + 1], ends[0])
    across = ends_of_parts(joints.v, domain[5], blocks[1, j], blocks[1, j + 1], ends[1])
    for k in range(along * across):
        place, at_u, at_v = tile.place[k], k // across, k % across
        place[0], place[2] = middle_and_half(ends[0, at_u], ends[0, at_u + 1])
        place[1], place[3] = middle_and_half(ends[1, at_v], ends[1, at_v + 1])
        tile.noise[k, REACH] = 0.0
    if along * across > 0:
        write_cells(tape, work, 1.0, tile, along * across)
    return along, across


@inline
def middle_and_half(low, high):
    """Return the middle of an interval and half its width."""
    return 0.5 * (low + high), 0.5 * (high - low)


@loop
def sign_on(tile, count, n):
    """Return the sign of the determinant of the Hessian of n·x if all parts of a tile share it.

    Return 0 if they do not share it, or if the products of n and the normals have no known common
    sign, and 2 if all these products are negative: then no part has the normal n.
    """
    sign = side = 0
    for k in range(count):
        if tile.noise[k, REACH] == 0.0:
            return 0
        patch = patch_of(tile.hot, k)
        own_side = side_in(tile, k, n)
        if own_side == 0 or (k > 0 and own_side != side):
            return 0
        side = own_side
        if side < 0:
            continue
        a, b, c, _, _ = linear_forms_of(patch, n)
        t0, t1, t2, t3, r0, r1, r2, r3 = thirds_of(tile.thirds, k, n)
        _, _, _, change, noise = inverse_of(
            a, b, c, t0, t1, t2, t3, r0, r1, r2, r3, tile.noise[k, SECOND]
        )
        own_sign = 1 if a * c - b * b > 0.0 else -1
        if not change + noise < 1.0 or (k > 0 and own_sign != sign):
            return 0
        sign = own_sign
    return 2 if side < 0 else sign


@inline
def along_side(side, x):
    """Return s and t on a side of a part, at the distance x from its start (counter-clockwise)."""
    if side == 0:
        return x - 1.0, -1.0
    if side == 1:
        return 1.0, x - 1.0
    if side == 2:
        return 1.0 - x, 1.0
    return -1.0, 1.0 - x


@loop
def gradient_at(tile, k, n, e1, e2, s, t):
    """Return the gradient at s, t in part k, times the area |x_s × x_t|, and terms of its bounds.

    The other results are the forms A, B, C; the derivatives F1, F2; bounds of |x_s| and |x_t|; and
    a bound of the error of the gradient.
    """
    patch = patch_of(tile.hot, k)
    a, b, c, p, q = linear_forms_of(patch, n)
    t0, t1, t2, t3, r0, r1, r2, r3 = thirds_of(tile.thirds, k, n)
    a, b, c, f1, f2 = model_at(a, b, c, p, q, t0, t1, t2, t3, s, t)
    rest_s, rest_t = remainders(r0, r1, r2, r3)
    second = 2.0 * tile.noise[k, SECOND]
    rest_s += tile.noise[k, FIRST_S] + second
    rest_t += tile.noise[k, FIRST_T] + second
    x_s = Vector(
        patch.d.x + patch.a.x * s + patch.b.x * t,
        patch.d.y + patch.a.y * s + patch.b.y * t,
        patch.d.z + patch.a.z * s + patch.b.z * t,
    )
    x_t = Vector(
        patch.e.x + patch.b.x * s + patch.c.x * t,
        patch.e.y + patch.b.y * s + patch.c.y * t,
        patch.e.z + patch.b.z * s + patch.c.z * t,
    )
    g1 = dot(x_s, e2) * f2 - f1 * dot(x_t, e2)
    g2 = f1 * dot(x_t, e1) - dot(x_s, e1) * f2
    size_s = length(x_s) + tile.hot[k, REST_S]
    size_t = length(x_t) + tile.hot[k, REST_T]
    error = rest_s * size_t + rest_t * size_s
    error += abs(f1) * tile.hot[k, REST_T] + abs(f2) * tile.hot[k, REST_S]
    error = error * (1.0 + 64.0 * EPS) + 64.0 * EPS * (abs(f1) * size_t + abs(f2) * size_s)
    return g1, g2, a, b, c, f1, f2, size_s, size_t, error


@loop
def turns_less_than_half(tile, k, n, e1, e2, side, x, step):
    """Return whether the gradient stays in a half plane on a segment [x, x + step] of a side."""
    half = 0.5 * step
    s, t = along_side(side, x + half)
    g1, g2, a, b, c, f1, f2, size_s, size_t, error = gradient_at(tile, k, n, e1, e2, s, t)
    patch = patch_of(tile.hot, k)
    t0, t1, t2, t3, _, _, _, _ = thirds_of(tile.thirds, k, n)
    if side % 2 == 0:
        change1 = half * abs(a) + 0.5 * half * half * abs(t0)
        change2 = half * abs(b) + 0.5 * half * half * abs(t1)
        change_s, change_t = half * length(patch.a), half * length(patch.b)
    else:
        change1 = half * abs(b) + 0.5 * half * half * abs(t2)
        change2 = half * abs(c) + 0.5 * half * half * abs(t3)
        change_s, change_t = half * length(patch.b), half * length(patch.c)
    change = change1 * (size_t + change_t) + change2 * (size_s + change_s)
    change += abs(f1) * change_t + abs(f2) * change_s
    # The errors of x_t and x_s, times the changes of F1 and F2, are added to the error.
    rest = error + change1 * tile.hot[k, REST_T] + change2 * tile.hot[k, REST_S]
    size = math.hypot(g1, g2)
    area = size_s * size_t
    return size > (change + rest) * (1.0 + 64.0 * EPS) and size > AWAY * SMOOTH * area


@loop
def walk_side(tile, k, n, e1, e2, side, path):
    """Follow the gradient along a side of part k; return False if it may have a zero there.

    `path` (6,) has the angle by which the gradient has turned so far, the last gradient, the first
    gradient, and 1 if there was a first gradient, else 0.
    """
    x, step = 0.0, LONGEST
    while True:
        s, t = along_side(side, x)
        g1, g2, _, _, _, _, _, _, _, error = gradient_at(tile, k, n, e1, e2, s, t)
        if not error < ERROR * math.hypot(g1, g2):
            return False
        if path[5] == 0.0:
            path[3], path[4], path[5] = g1, g2, 1.0
        else:
            path[0] += angle_between(path[1], path[2], g1, g2)
        path[1], path[2] = g1, g2
        if x >= 2.0:
            return True
        step = min(2.0 * step, 2.0 - x)
        while not turns_less_than_half(tile, k, n, e1, e2, side, x, step):
            step *= 0.5
            if step < SHORTEST:
                return False
        x += step


@loop
def start_path(path):
    """Begin a path along a border; see `walk_side`."""
    for x in range(path.size):
        path[x] = 0.0


@inline
def turns_of(path):
    """Return the winding number of a path, including the angle that closes the path."""
    total = path[0] + angle_between(path[1], path[2], path[3], path[4])
    return np.rint(total / (2.0 * math.pi))


@loop
def winding(tile, along, across, n, path):
    """Return the winding number of the gradient along the border of a box; NaN if it is unknown."""
    e1, e2 = plane_of(n)
    start_path(path)
    for side in range(4):
        parts = along if side % 2 == 0 else across
        for part in range(parts):
            number = part if side < 2 else parts - 1 - part
            i = number if side % 2 == 0 else (along - 1 if side == 1 else 0)
            j = number if side % 2 == 1 else (0 if side == 0 else across - 1)
            if not walk_side(tile, i * across + j, n, e1, e2, side, path):
                return math.nan
    return turns_of(path)


@loop
def grow(hull, axis, large, factor, domain, points, box):
    """Write both bounds, along an axis, of a box around a hull; return how the box lies.

    The result is SEAM if the hull covers a whole period, BEFORE or AFTER if the box ends at a
    collapsed side of the domain, INSIDE if it reaches no side, and −1 if it leaves the domain.
    """
    low, high = hull[2 * axis], hull[2 * axis + 1]
    start, end = domain[2 * axis], domain[2 * axis + 1]
    if domain[4 + axis] > 0.0 and high - low >= end - start:
        box[2 * axis], box[2 * axis + 1] = start, end
        return SEAM
    more = max(factor * (end - start), (BEYOND if large else GROWN) * (high - low))
    low, high = low - more, high + more
    found = INSIDE
    if domain[4 + axis] == 0.0:
        if low < start:
            found, low = BEFORE if points[2 * axis] > 0.0 else -1, start
        if high > end:
            found, high = AFTER if found == INSIDE and points[2 * axis + 1] > 0.0 else -1, end
    box[2 * axis], box[2 * axis + 1] = low, high
    return found


@loop
def index_around(tape, work, tile, joints, domain, points, hull, n, ends, path, box):
    """Return the winding number of the gradient around a hull; NaN if it is unknown.

    The path is the border of a larger `box` (4,) in the domain, which is written. It consists of
    two closed curves if the hull covers a whole period, and of one closed curve if the box then
    ends at a pole. `points` (4,) are 1 for collapsed sides of the domain.
    """
    e1, e2 = plane_of(n)
    size_u, size_v = domain[1] - domain[0], domain[3] - domain[2]
    large = max((hull[1] - hull[0]) / size_u, (hull[3] - hull[2]) / size_v) > LARGEST
    for factor in AROUND:
        if large and factor < FAR:
            continue
        in_u = grow(hull, 0, large, factor, domain, points, box)
        in_v = grow(hull, 1, large, factor, domain, points, box)
        closed = in_u == SEAM or in_v == SEAM
        if min(in_u, in_v) < 0 or in_u == in_v == SEAM or (max(in_u, in_v) > SEAM and not closed):
            return math.nan
        along = ends_of_parts(joints.u, domain[4], box[0], box[1], ends[0])
        across = ends_of_parts(joints.v, domain[5], box[2], box[3], ends[1])
        if along * across == 0:
            return math.nan
        box[0], box[1], box[2], box[3] = ends[0, 0], ends[0, along], ends[1, 0], ends[1, across]
        count = write_ring(tape, work, tile, ends, along, across, in_u, in_v)
        start_path(path)
        known, turns, last = True, 0.0, -1
        for k in range(count):
            side = int(work.levels[k])
            if closed and side != last:
                turns += turns_of(path) if last >= 0 else 0.0
                start_path(path)
                last = side
            known = (
                known
                and tile.noise[k, REACH] > 0.0
                and side_in(tile, k, n) > 0
                and walk_side(tile, k, n, e1, e2, side, path)
            )
        if known:
            return turns + turns_of(path)
    return math.nan


@inline
def is_free(side, in_u, in_v):
    """Return whether a side of a box belongs to its border: it is neither a seam nor collapsed."""
    kind = in_v if side % 2 == 0 else in_u
    # Side 0 is at the least v, side 3 at the least u.
    return kind != SEAM and kind != (BEFORE if side % 3 == 0 else AFTER)


@loop
def write_ring(tape, work, tile, ends, along, across, in_u, in_v):
    """Write bounds over cells inside a box along its border, in counter-clockwise order.

    Joints cut the box into `along` parts along u and `across` parts along v, whose ends are the
    rows of `ends`. `in_u` and `in_v` are results of `grow`. The index of the side at which each
    cell lies is written to `work.levels`. Return the number of cells.
    """
    count = sides = 0
    for side in range(4):
        sides += 1 if is_free(side, in_u, in_v) else 0
    for side in range(4):
        if not is_free(side, in_u, in_v):
            continue
        axis = side % 2
        other = 1 - axis
        parts, last = (along, across) if axis == 0 else (across, along)
        each = LANES // (sides * parts)
        depth = THIN * (ends[other, last] - ends[other, 0])
        inside = ends[other, 0] + depth if side % 3 == 0 else ends[other, last] - depth
        for step in range(parts * each):
            k = step if side < 2 else parts * each - 1 - step
            low, high = ends[axis, k // each], ends[axis, k // each + 1]
            half = 0.5 * (high - low) / each
            place = tile.place[count]
            place[axis], place[2 + axis] = low + half * (2.0 * (k % each) + 1.0), half
            place[other], place[2 + other] = inside, depth
            tile.noise[count, REACH] = 0.0
            work.levels[count] = float(side)
            count += 1
    write_cells(tape, work, 1.0, tile, count)
    return count


@inline
def angle_between(x1, y1, x2, y2):
    """Return the angle from one vector to another one."""
    return math.atan2(x1 * y2 - y1 * x2, x1 * x2 + y1 * y2)


@loop
def plane_of(n):
    """Return two unit vectors that are perpendicular to n, and to each other."""
    e1 = Vector(0.0, -n.z, n.y) if abs(n.x) < 0.6 else Vector(n.z, 0.0, -n.x)
    size = length(e1)
    e1 = Vector(e1.x / size, e1.y / size, e1.z / size)
    e2 = Vector(n.y * e1.z - n.z * e1.y, n.z * e1.x - n.x * e1.z, n.x * e1.y - n.y * e1.x)
    return e1, e2


@loop
def write_nearest(tape, work, tile, count, n, row):
    """Write the best known solution in the parts of a tile to a row; return False if there is none.

    The error bounds enclose the solutions of all parts. If several parts have a solution, the error
    bounds also enclose all points whose normals are within the tolerance.
    """
    outputs, place = tape.outputs, tile.place
    x, y, z = (
        np.uint64(POINT * outputs[0]), np.uint64(POINT * outputs[1]), np.uint64(POINT * outputs[2])
    )  # fmt: skip
    for k in range(count):
        work.u[k], work.v[k] = place[k, 0], place[k, 1]
    best, least, others = -1, math.inf, 0
    for step in range(STEPS):
        evaluate_points(tape, work.u, work.v, count, work.registers)
        for k in range(count):
            i, h_u, h_v = np.uint64(k), place[k, 2], place[k, 3]
            a, b, c, p, q = forms_at(work.registers, x + i, y + i, z + i, n, h_u, h_v)
            s, t = (work.u[k] - place[k, 0]) / h_u, (work.v[k] - place[k, 1]) / h_v
            if step < STEPS - 1:
                s1, t1, _ = newton(a, b, c, p, q, s, t)
                most = most_of(1.0, gap_of(place[k, 0], place[k, 1], h_u, h_v))
                s1, t1 = min(max(s1, -most), most), min(max(t1, -most), most)
                work.u[k], work.v[k] = place[k, 0] + h_u * s1, place[k, 1] + h_v * t1
                continue
            reach, slack, none = reach_at(tile, k, n, s, t, p, q)
            # The patch of this part is no longer needed: its place holds error bounds instead.
            tile.hot[k, 0], tile.hot[k, 1] = reach * h_u, reach * h_v
            tile.hot[k, 2], tile.hot[k, 3] = slack * h_u, slack * h_v
            tile.hot[k, 4] = 0.0 if none else 1.0
            if none:
                continue
            others += 1
            if reach < least:
                best, least = k, reach
                row[4] = a * c - b * b
    if best < 0:
        return False
    row[0], row[1], row[2], row[3] = work.u[best], work.v[best], 0.0, 0.0
    for k in range(count):
        if tile.hot[k, 4] > 0.0:
            more = 1.0 if others > 1 else 0.0
            row[2] = max(row[2], abs(work.u[k] - row[0]) + tile.hot[k, 0] + more * tile.hot[k, 2])
            row[3] = max(row[3], abs(work.v[k] - row[1]) + tile.hot[k, 1] + more * tile.hot[k, 3])
    row[2] += 4.0 * EPS * abs(row[0])
    row[3] += 4.0 * EPS * abs(row[1])
    return True


@loop
def reach_at(tile, k, n, s, t, p, q):
    """Return a bound of the distance from s, t, where F is (p, q), to a solution in part k.

    The second result is the length that the tolerance of normals at joints adds to this bound. The
    third result is True if there is no solution, even with the tolerance.
    """
    patch = patch_of(tile.hot, k)
    a, b, c, _, _ = linear_forms_of(patch, n)
    t0, t1, t2, t3, r0, r1, r2, r3 = thirds_of(tile.thirds, k, n)
    y11, y12, y22, change, noise = inverse_of(
        a, b, c, t0, t1, t2, t3, r0, r1, r2, r3, tile.noise[k, SECOND]
    )
    whole = change + noise
    i11, i12, i22 = abs(y11), abs(y12), abs(y22)
    first_s, first_t = tile.noise[k, FIRST_S], tile.noise[k, FIRST_T]
    tol_s, tol_t = tile.noise[k, TOLERANCE_S], tile.noise[k, TOLERANCE_T]
    base = max(i11 * first_s + i12 * first_t, i12 * first_s + i22 * first_t) / (1.0 - whole)
    base += gap_of(tile.place[k, 0], tile.place[k, 1], tile.place[k, 2], tile.place[k, 3])
    slack = max(i11 * tol_s + i12 * tol_t, i12 * tol_s + i22 * tol_t) / (1.0 - whole)
    none = is_beyond(s, t, y11 * p + y12 * q, y12 * p + y22 * q, base + slack, whole)
    return distance(p, q, y11, y12, y22, whole, base), slack, none


@loop
def solve_part(tape, work, tile, pairs, n, row):
    """Decide whether the first part of a tile has a solution, and write it to `row`.

    The part ends at a crease, and has no joint: there is no tolerance. It has at most one solution.
    """
    tile.noise[0, TOLERANCE_S] = tile.noise[0, TOLERANCE_T] = 0.0
    load_pair(pairs, 0, tile, 0, n)
    bound_pairs(pairs, 0, 1)
    while pairs[STATE] == MORE:
        work.u[0] = pairs[U0] + pairs[HU] * pairs[S]
        work.v[0] = pairs[V0] + pairs[HV] * pairs[T]
        evaluate_points(tape, work.u, work.v, 1, work.registers)
        improve_pairs(pairs, 1, work.registers, tape.outputs, work.u, work.v)
    if pairs[STATE] == ONE:
        row[0], row[1], row[4] = work.u[0], work.v[0], pairs[DETERMINANT]
        row[2], row[3] = pairs[RADIUS] * pairs[HU], pairs[RADIUS] * pairs[HV]
    return UNDECIDED if pairs[STATE] == HARD else DECIDED


@loop
def degree_on(tape, work, tile, pairs, joints, domain, blocks, i, j, whole, n, ends, path, row):
    """Decide whether block i, j has no point with the normal n or exactly one; write it to `row`.

    The block is `whole` if it does not end at a crease. Returns DECIDED, or UNDECIDED if the block
    may have several such points; row[4] is 0 if it has none.
    """
    along, across = write_parts(tape, work, tile, joints, domain, blocks, i, j, ends)
    if along * across == 0:
        return UNDECIDED
    row[4] = 0.0
    sign = sign_on(tile, along * across, n)
    if sign == 2:
        return DECIDED
    if sign == 0:
        return UNDECIDED
    row[5], row[6], row[7], row[8] = ends[0, 0], ends[0, along], ends[1, 0], ends[1, across]
    row[BORDER] = -1.0
    if along * across == 1 and not whole:
        return solve_part(tape, work, tile, pairs, n, row)
    turns = winding(tile, along, across, n, path)
    if turns == 0.0:
        return DECIDED
    if turns != float(sign):
        return UNDECIDED
    found = write_nearest(tape, work, tile, along * across, n, row)
    return DECIDED if found else UNDECIDED
