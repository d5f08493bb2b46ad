"""Pairs of a cell and a normal: exclusion by bounds, and the unique solutions of other pairs.

A solution is a point of the cell with this normal. Pairs are processed in tiles of LANES: each step
is a vectorized loop over the lanes. Pairs that need another evaluation of the surface stay in the
tile; new pairs replace those that are decided. Pairs that are not decided after a few evaluations
are left to `places`.
"""

from __future__ import annotations

import numpy as np

from ....generated.patch import eliminated_forms
from ....generated.proved import excesses, model_at, remainders
from ....generated.vectors import Vector
from ...machine_code.jit import inline, long_vectors, loop
from ...tape.kernels.points import LANES, POINT
from .cell_bounds import (
    EPS,
    FIRST_S,
    FIRST_T,
    REACH,
    SECOND,
    TOLERANCE_S,
    TOLERANCE_T,
    gap_of,
    inverse_of,
    linear_forms_of,
    patch_of,
    thirds_of,
)

# The rows of a tile of pairs, of LANES numbers: the normal; the cell; the forms of the pair; bounds
# (see `CellBounds`); the inverse of the Hessian with its bounds (`inverse_of`); bounds of the
# errors of solutions by rounding, and by tolerances at joints; and the solution: s, t, its error
# bound, D, the number of evaluations, a state.
(
    NX, NY, NZ, U0, V0, HU, HV, A, B, C, P, Q, T0, T1, T2, T3, R0, R1, R2, R3,
    ROUND_S, ROUND_T, ROUND_2, REACHED, TOL_S, TOL_T,
    Y11, Y12, Y22, CHANGE, NOISE, BASE, SLACK, S, T, RADIUS, DETERMINANT, ROUND, STATE,
) = (np.uint64(k * LANES) for k in range(39))  # fmt: skip
ROWS = 39
# States of a pair: no solution; one solution; another evaluation is needed; not decided here; one
# solution, near a side of the cell.
NONE, ONE, MORE, HARD, EDGE = 0.0, 1.0, 2.0, 3.0, 4.0
# The largest allowed product of the inverse of the Hessian with the change of the Hessian.
CONTRACTING = 0.95
# A solution is accurate enough if its error bound is below this multiple of the rounding error.
CLOSE = 4.0
# The largest number of evaluations for a pair.
ROUNDS = 6.0
# The solution of the cubic model may be outside the cell, up to this |s| and |t|.
OUTSIDE = 1.5


@loop
def load_pair(t, k, cells, j, n):
    """Write cell j and a normal to lane k of a tile."""
    i = np.uint64(k)
    t[i + NX], t[i + NY], t[i + NZ] = n
    t[i + U0], t[i + V0] = cells.place[j, 0], cells.place[j, 1]
    t[i + HU], t[i + HV] = cells.place[j, 2], cells.place[j, 3]
    t[i + A], t[i + B], t[i + C], t[i + P], t[i + Q] = linear_forms_of(patch_of(cells.hot, j), n)
    (
        t[i + T0], t[i + T1], t[i + T2], t[i + T3], t[i + R0], t[i + R1], t[i + R2], t[i + R3]
    ) = thirds_of(cells.thirds, j, n)  # fmt: skip
    t[i + ROUND_S], t[i + ROUND_T] = cells.noise[j, FIRST_S], cells.noise[j, FIRST_T]
    t[i + ROUND_2], t[i + REACHED] = cells.noise[j, SECOND], cells.noise[j, REACH]
    t[i + TOL_S], t[i + TOL_T] = cells.noise[j, TOLERANCE_S], cells.noise[j, TOLERANCE_T]


@loop
def load_box(t, k, cells, j, n, u, v, size_u, size_v):
    """Write a part of cell j, around (u, v), and a normal to lane k, without the forms."""
    i = np.uint64(k)
    t[i + NX], t[i + NY], t[i + NZ] = n
    t[i + U0], t[i + V0] = u, v
    t[i + HU], t[i + HV] = size_u * cells.place[j, 2], size_v * cells.place[j, 3]
    t0, t1, t2, t3, r0, r1, r2, r3 = thirds_of(cells.thirds, j, n)
    uu, uv, vv = size_u * size_u, size_u * size_v, size_v * size_v
    t[i + T0], t[i + T1], t[i + T2], t[i + T3] = (
        size_u * uu * t0, size_u * uv * t1, size_v * uv * t2, size_v * vv * t3
    )  # fmt: skip
    t[i + R0], t[i + R1], t[i + R2], t[i + R3] = (
        size_u * uu * r0, size_u * uv * r1, size_v * uv * r2, size_v * vv * r3
    )  # fmt: skip
    noise = cells.noise
    t[i + ROUND_S], t[i + ROUND_T] = size_u * noise[j, FIRST_S], size_v * noise[j, FIRST_T]
    t[i + ROUND_2], t[i + REACHED] = max(uu, vv) * noise[j, SECOND], noise[j, REACH]
    t[i + TOL_S], t[i + TOL_T] = size_u * noise[j, TOLERANCE_S], size_v * noise[j, TOLERANCE_T]


@loop
def write_forms(t, count, registers, outputs):
    """Write the forms of parts of cells from 2-jets at their centres."""
    x, y, z = (
        np.uint64(POINT * outputs[0]), np.uint64(POINT * outputs[1]), np.uint64(POINT * outputs[2])
    )  # fmt: skip
    for k in range(count):
        i = np.uint64(k)
        n = Vector(t[i + NX], t[i + NY], t[i + NZ])
        t[i + A], t[i + B], t[i + C], t[i + P], t[i + Q] = forms_at(
            registers, x + i, y + i, z + i, n, t[i + HU], t[i + HV]
        )


@inline
def rests(a, b, c, p, q, t0, t1, t2, t3, r0, r1, r2, r3, round_s, round_t, round_2, gap):
    """Return bounds of the remainders of n·x_s and n·x_t, beyond their linear terms, in a cell."""
    rest_s, rest_t = remainders(abs(t0) + r0, abs(t1) + r1, abs(t2) + r2, abs(t3) + r3)
    rest_s = rest_s * (1.0 + 4.0 * gap) + round_s + 2.0 * round_2 + gap * (abs(a) + abs(b) + abs(p))
    rest_t = rest_t * (1.0 + 4.0 * gap) + round_t + 2.0 * round_2 + gap * (abs(b) + abs(c) + abs(q))
    return rest_s, rest_t


@inline
def is_excluded(a, b, c, p, q, t0, t1, t2, t3, r0, r1, r2, r3, round_s, round_t, round_2, gap):
    """Return whether a cell has no solution for the normal n, and none for −n."""
    rest_s, rest_t = rests(
        a, b, c, p, q, t0, t1, t2, t3, r0, r1, r2, r3, round_s, round_t, round_2, gap
    )
    e1, e2, e3, e4 = excesses(a, b, c, p, q, rest_s, rest_t)
    return max(max(e1, e2), max(e3, e4)) > 0.0


@inline
def most_of(reached, gap):
    """Return the largest |s|, |t| at which derivatives belong to this cell, not to a neighbour."""
    return 1.0 if reached > 1.0 else 1.0 - gap


@inline
def model_start(a, b, c, p, q, t0, t1, t2, t3, y11, y12, y22):
    """Return the solution of the cubic model for a normal, near the cell."""
    s, t = -(y11 * p + y12 * q), -(y12 * p + y22 * q)
    for _ in range(3):
        s, t = min(max(s, -OUTSIDE), OUTSIDE), min(max(t, -OUTSIDE), OUTSIDE)
        a1, b1, c1, p1, q1 = model_at(a, b, c, p, q, t0, t1, t2, t3, s, t)
        d, u, v, _ = eliminated_forms(a1, b1, c1, p1, q1)
        r = 1.0 / d
        s, t = s + u * r, t + v * r
    return s, t


@inline
def is_beyond(s, t, g1, g2, error, change):
    """Return whether a cell has no solution, from the residual at a point (s, t) of it.

    g1, g2 are the residual times the inverse of the Hessian, known up to `error`. If the step of
    Newton's simplified method, cut off at the sides, leads to a point near (s, t), any solution in
    the cell is near (s, t) as well; the cell has none if the residual is too large for that.
    """
    step = max(abs(min(max(s - g1, -1.0), 1.0) - s), abs(min(max(t - g2, -1.0), 1.0) - t))
    away = (step + error) / (1.0 - change)
    return max(abs(g1), abs(g2)) - error > (1.0 + change) * away * (1.0 + 16.0 * EPS)


@loop
def solved(low, high, f, own, rest):
    """Return the part of [low, high] where |f + own x| is at most `rest`; all of it if own = 0."""
    if own != 0.0:
        one, two = (-f - rest) / own, (rest - f) / own
        low, high = max(low, min(one, two)), min(high, max(one, two))
    return low, high


@loop
def contracted(t, k):
    """Return the part of the box in lane k that may have solutions, s₀, s₁, t₀, t₁.

    Both derivatives, and the two combinations with one parameter eliminated, are solved for s and
    for t. The part is empty if s₀ > s₁ or t₀ > t₁.
    """
    i = np.uint64(k)
    a, b, c, p, q = t[i + A], t[i + B], t[i + C], t[i + P], t[i + Q]
    gap = gap_of(t[i + U0], t[i + V0], t[i + HU], t[i + HV])
    rest_s, rest_t = rests(
        a, b, c, p, q, t[i + T0], t[i + T1], t[i + T2], t[i + T3], t[i + R0], t[i + R1],
        t[i + R2], t[i + R3], t[i + ROUND_S] + t[i + TOL_S], t[i + ROUND_T] + t[i + TOL_T],
        t[i + ROUND_2], gap,
    )  # fmt: skip
    d = a * c - b * b
    rounding = 16.0 * EPS * (abs(a * c) + b * b)
    by_s = abs(c) * rest_s + abs(b) * rest_t + rounding + 16.0 * EPS * (abs(c * p) + abs(b * q))
    by_t = abs(a) * rest_t + abs(b) * rest_s + rounding + 16.0 * EPS * (abs(a * q) + abs(b * p))
    low_s, high_s = solved(-1.0, 1.0, c * p - b * q, d, by_s)
    low_t, high_t = solved(-1.0, 1.0, a * q - b * p, d, by_t)
    for _ in range(2):
        most = max(abs(low_t), abs(high_t))
        low_s, high_s = solved(low_s, high_s, p, a, rest_s + abs(b) * most)
        low_s, high_s = solved(low_s, high_s, q, b, rest_t + abs(c) * most)
        most = max(abs(low_s), abs(high_s))
        low_t, high_t = solved(low_t, high_t, p, b, rest_s + abs(a) * most)
        low_t, high_t = solved(low_t, high_t, q, c, rest_t + abs(b) * most)
    return low_s - gap, high_s + gap, low_t - gap, high_t + gap


@loop
def bound_pairs(t, first, count):
    """Write the states of pairs [first, count).

    For pairs that may have a solution, also write the inverse of the Hessian, its bounds, and a
    start for Newton's method.
    """
    long_vectors()
    for k in range(first, count):
        i = np.uint64(k)
        a, b, c, p, q = t[i + A], t[i + B], t[i + C], t[i + P], t[i + Q]
        t0, t1, t2, t3 = t[i + T0], t[i + T1], t[i + T2], t[i + T3]
        r0, r1, r2, r3 = t[i + R0], t[i + R1], t[i + R2], t[i + R3]
        round_s, round_t, round_2 = t[i + ROUND_S], t[i + ROUND_T], t[i + ROUND_2]
        tol_s, tol_t = t[i + TOL_S], t[i + TOL_T]
        gap = gap_of(t[i + U0], t[i + V0], t[i + HU], t[i + HV])
        none = is_excluded(
            a, b, c, p, q, t0, t1, t2, t3, r0, r1, r2, r3, round_s + tol_s, round_t + tol_t,
            round_2, gap,
        )  # fmt: skip
        y11, y12, y22, change, noise = inverse_of(a, b, c, t0, t1, t2, t3, r0, r1, r2, r3, round_2)
        whole = change * t[i + REACHED] + noise
        i11, i12, i22 = abs(y11), abs(y12), abs(y22)
        rounding = max(i11 * round_s + i12 * round_t, i12 * round_s + i22 * round_t)
        tolerance = max(i11 * tol_s + i12 * tol_t, i12 * tol_s + i22 * tol_t)
        s, z = model_start(a, b, c, p, q, t0, t1, t2, t3, y11, y12, y22)
        # The residual of the model, at the point of the cell that is nearest to the solution of the
        # model. If bounds end at a joint, this point is moved from the joint into the cell.
        most = most_of(t[i + REACHED], gap)
        s1, z1 = min(max(s, -most), most), min(max(z, -most), most)
        _, _, _, p1, q1 = model_at(a, b, c, p, q, t0, t1, t2, t3, s1, z1)
        rest_s, rest_t = remainders(r0, r1, r2, r3)
        error = max(i11 * rest_s + i12 * rest_t, i12 * rest_s + i22 * rest_t)
        error += rounding + tolerance + 2.0 * noise
        beyond = is_beyond(s1, z1, y11 * p1 + y12 * q1, y12 * p1 + y22 * q1, error + gap, whole)
        alone = whole < CONTRACTING
        t[i + Y11], t[i + Y12], t[i + Y22] = y11, y12, y22
        t[i + CHANGE], t[i + NOISE] = change, noise
        t[i + BASE] = rounding / (1.0 - whole) + 0.25 * gap
        t[i + SLACK] = tolerance / (1.0 - whole)
        t[i + S], t[i + T], t[i + ROUND] = s1, z1, 0.0
        state = NONE if alone and beyond else MORE if alone else HARD
        t[i + STATE] = NONE if none else state


@loop
def compact(t, count, cells, numbers, u, v):
    """Move the pairs that need an evaluation to the front, with u and v; return their number."""
    kept = 0
    for k in range(count):
        i, to = np.uint64(k), np.uint64(kept)
        if t[i + STATE] != MORE:
            continue
        if kept < k:
            for row in range(ROWS):
                at = np.uint64(row * LANES)
                t[at + to] = t[at + i]
            cells[kept], numbers[kept] = cells[k], numbers[k]
        u[kept] = t[to + U0] + t[to + HU] * t[to + S]
        v[kept] = t[to + V0] + t[to + HV] * t[to + T]
        kept += 1
    return kept


@loop
def improve_pairs(t, count, registers, outputs, u, v):
    """Do a step of Newton's method from the 2-jets at u, v; write states, and bounds of errors."""
    long_vectors()
    x, y, z = (
        np.uint64(POINT * outputs[0]), np.uint64(POINT * outputs[1]), np.uint64(POINT * outputs[2])
    )  # fmt: skip
    for k in range(count):
        i = np.uint64(k)
        n = Vector(t[i + NX], t[i + NY], t[i + NZ])
        h_u, h_v = t[i + HU], t[i + HV]
        a, b, c, p, q = forms_at(registers, x + i, y + i, z + i, n, h_u, h_v)
        s, w, base, slack = t[i + S], t[i + T], t[i + BASE], t[i + SLACK]
        y11, y12, y22 = t[i + Y11], t[i + Y12], t[i + Y22]
        whole = t[i + CHANGE] * t[i + REACHED] + t[i + NOISE]
        gap = gap_of(t[i + U0], t[i + V0], h_u, h_v)
        most = most_of(t[i + REACHED], gap)
        inside = max(abs(s), abs(w)) <= most
        beyond = is_beyond(s, w, y11 * p + y12 * q, y12 * p + y22 * q, base + slack, whole)
        away = distance(p, q, y11, y12, y22, whole, base)
        s1, w1, d = newton(a, b, c, p, q, s, w)
        radius = after_step(away, t[i + CHANGE], t[i + NOISE], whole, base)
        good = max(abs(s), abs(w)) + away <= t[i + REACHED] and d != 0.0
        largest = max(abs(s1), abs(w1))
        at_joint = t[i + REACHED] <= 1.0
        limit = most if at_joint else OUTSIDE
        s1, w1 = min(max(s1, -limit), limit), min(max(w1, -limit), limit)
        u[k] += h_u * (s1 - s)
        v[k] += h_v * (w1 - w)
        t[i + S], t[i + T], t[i + RADIUS], t[i + DETERMINANT] = s1, w1, radius, d
        t[i + ROUND] += 1.0
        # Near a joint the solution may be the neighbour's, whose normal differs slightly.
        near = radius + gap + slack
        edge = HARD if at_joint else EDGE
        known = ONE if largest < 1.0 - near else NONE if largest > 1.0 + near else edge
        again = MORE if t[i + ROUND] < ROUNDS and largest < OUTSIDE else HARD
        state = known if good and radius <= CLOSE * base else again
        t[i + STATE] = NONE if inside and beyond else state


@inline
def forms_at(registers, x, y, z, n, h_u, h_v):
    """Return the linear forms A, B, C, P, Q of n and the surface, whose 2-jets are in `registers`.

    Derivatives are with respect to s and t: u = u₀ + h_u s, v = v₀ + h_v t.
    """
    return (
        2.0 * h_u * h_u * form(registers, x, y, z, n, np.uint64(3 * LANES)),
        h_u * h_v * form(registers, x, y, z, n, np.uint64(4 * LANES)),
        2.0 * h_v * h_v * form(registers, x, y, z, n, np.uint64(5 * LANES)),
        h_u * form(registers, x, y, z, n, np.uint64(LANES)),
        h_v * form(registers, x, y, z, n, np.uint64(2 * LANES)),
    )


@inline
def form(registers, x, y, z, n, at):
    """Return the product of a normal and a derivative."""
    return n.x * registers[x + at] + n.y * registers[y + at] + n.z * registers[z + at]


@inline
def distance(p, q, y11, y12, y22, whole, base):
    """Return a bound of the distance from a point to the solution, if bounds hold that far.

    At the point, the derivatives of n·x by s and t are p and q; at the solution both are 0.
    """
    i11, i12, i22 = abs(y11), abs(y12), abs(y22)
    g1 = abs(y11 * p + y12 * q) + 4.0 * EPS * (i11 * abs(p) + i12 * abs(q))
    g2 = abs(y12 * p + y22 * q) + 4.0 * EPS * (i12 * abs(p) + i22 * abs(q))
    return max(g1, g2) / (1.0 - whole) + base


@inline
def newton(a, b, c, p, q, s, t):
    """Return s, t after a step of Newton's method, and the determinant."""
    d, u, v, _ = eliminated_forms(a, b, c, p, q)
    r = 1.0 / d
    return s + u * r, t + v * r, d


@inline
def after_step(away, change, noise, whole, base):
    """Return a bound of the distance from the solution after a step of Newton's method.

    `away` is a bound of the distance before the step.
    """
    return (0.5 * change * away + noise) * away / (1.0 - whole) + base
