"""Discs around poles: the points with given normals there, in coordinates of the tangent plane.

At a pole, u is the parameter around it, and r = 0. The surface is a graph over its tangent plane,
whose coordinates s and t are scaled so that the disc is within s² + t² ≤ 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.jet import graph_slopes
from ....generated.patch import eliminated_forms
from ...directions.kernels.vectors import dot, row_vector
from ...machine_code.jit import inline, jit, loop
from ...tape.kernels.points import POINT, U, V, evaluate_points
from .answers import BORDER, OPEN_BOX, add_open
from .cell_bounds import EPS, linear_forms_of, patch_of
from .pairs import CLOSE, CONTRACTING

# The largest number of steps towards a solution.
STEPS = 60
# After a step that is longer than this part of the distance from the pole, u and r are computed
# from the tangents at the pole, not from the derivatives at the last point.
LONG = 0.25
# Indices into the frame of a disc.
(
    FAR_NOISE, NEAR_NOISE, SIZE, START, TURN, END, INWARD, ANGLE, UNIT, WHOLE, BY_U, BY_R, QUOTIENT,
    SENSE,
) = range(14)  # fmt: skip


class Disc(NamedTuple):
    """The disc around a pole. (q1, q2) = UNIT · (s, t) are coordinates of the tangent plane.

    hot (1, 15): the vectors a, b, c, d, e, with respect to s and t, of the patch that osculates
    the surface at the pole.
    changes (m, 3, 3): item k has bounds of the coordinates of x_ss − a, x_st − b and x_tt − c for
    r ≤ ρ/2ᵏ, where ρ is the largest r at which bounds hold.
    frame (14,), by index:
        FAR_NOISE, NEAR_NOISE: derivatives of h with respect to s and t have errors of at
            most FAR_NOISE + NEAR_NOISE · SIZE / r.
        SIZE: the radius of the disc, in r.
        START, TURN: the lower end and the length of the interval of u.
        END, INWARD: the other parameter is END + INWARD · r, where INWARD is 1 or −1.
        ANGLE: the index of u among the parameters of the surface, 0 or 1.
        UNIT: the length of the unit of s and t in the plane.
        WHOLE: bounds hold for s² + t² ≤ WHOLE².
        BY_U, BY_R: the largest lengths of r ∇u and ∇r; ∇ is the gradient with respect to q1, q2.
        QUOTIENT: 1 if the tape computes (x − p) / r, 0 if it computes x.
        SENSE: 1 if the angle in the plane increases with u, −1 if it decreases.
    basis (3, 3): the rows are the derivatives of x with respect to q1, q2 and h.
    directions (k, 2): SENSE times the angle of x_r (u, 0) in the plane, and the length of
    x_r (u, 0), for k equally spaced u from START to START + TURN.
    """

    hot: NDArray[np.float64]
    changes: NDArray[np.float64]
    frame: NDArray[np.float64]
    basis: NDArray[np.float64]
    directions: NDArray[np.float64]


@inline
def bound_of(changes, ring, k, n):
    """Return the largest change in a ring of n·x_ss (k = 0), n·x_st (k = 1) or n·x_tt (k = 2)."""
    return (
        changes[ring, k, 0] * abs(n.x)
        + changes[ring, k, 1] * abs(n.y)
        + changes[ring, k, 2] * abs(n.z)
    )


@inline
def rows_of(y11, y12, y22, p, q):
    """Return the larger component of |Y| (p, q); |Y| has the moduli of a symmetric matrix Y."""
    return max(abs(y11) * p + abs(y12) * q, abs(y12) * p + abs(y22) * q)


@loop
def change_in(disc, ring, n, y11, y12, y22):
    """Return a bound of the change of the Hessian in a ring, times the inverse Hessian at the pole.

    y11, y12, y22 are the entries of the inverse.
    """
    a, b, c = (
        bound_of(disc.changes, ring, 0, n),
        bound_of(disc.changes, ring, 1, n),
        bound_of(disc.changes, ring, 2, n),
    )
    i11, i12, i22 = abs(y11), abs(y12), abs(y22)
    return max(i11 * (a + b) + i12 * (b + c), i12 * (a + b) + i22 * (b + c)) * (1.0 + 16.0 * EPS)


@loop
def place_towards(disc, s, t):
    """Return u and r of a point near s, t, from the tangents at the pole."""
    table = disc.directions
    count = table.shape[0] - 1
    angle = disc.frame[SENSE] * math.atan2(t, s)
    turn = table[count, 0] - table[0, 0]
    angle -= turn * math.floor((angle - table[0, 0]) / turn)
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) // 2
        if table[middle, 0] <= angle:
            low = middle
        else:
            high = middle
    part = (angle - table[low, 0]) / (table[low + 1, 0] - table[low, 0])
    length = table[low, 1] + part * (table[low + 1, 1] - table[low, 1])
    u = disc.frame[START] + disc.frame[TURN] * (low + part) / count
    return u, disc.frame[UNIT] * math.hypot(s, t) / length


@loop
def graph_at(tape, work, disc, u, r):
    """Return s, t at u, r, the derivatives of u, r with respect to s, t, and the slopes of h.

    The slopes of h are with respect to the unscaled coordinates of the plane.
    """
    work.u[0], work.v[0] = u, r
    evaluate_points(tape, work.u, work.v, 1, work.registers)
    x, y, z = (
        np.uint64(POINT * tape.outputs[0]),
        np.uint64(POINT * tape.outputs[1]),
        np.uint64(POINT * tape.outputs[2]),
    )
    registers, unit = work.registers, disc.frame[UNIT]
    q1, q2 = registers[x], registers[y]
    o1, o2, h1 = registers[x + U], registers[y + U], registers[z + U]
    e1, e2, h2 = registers[x + V], registers[y + V], registers[z + V]
    if disc.frame[QUOTIENT] > 0.0:
        e1, e2, h2 = q1 + r * e1, q2 + r * e2, registers[z] + r * h2
        q1, q2 = r * q1, r * q2
    else:
        o1, o2, h1 = o1 / r, o2 / r, h1 / r
    i11, i12, i21, i22, g1, g2 = graph_slopes(o1, o2, e1, e2, h1, h2)
    return (
        q1 / unit, q2 / unit, i11 * unit / r, i12 * unit / r, i21 * unit, i22 * unit, g1, g2
    )  # fmt: skip


@loop
def place_in(tape, work, disc, n):
    """Return u, r of the only solution for n, a bound of its error in s, t, and the determinant.

    The bound is infinite if nothing is proved, and negative if no solution is in the disc.
    """
    frame = disc.frame
    a, b, c, p, q = linear_forms_of(patch_of(disc.hot, 0), n)
    d, u, v, _ = eliminated_forms(a, b, c, p, q)
    y11, y12, y22 = c / d, -b / d, a / d
    rounding = 16.0 * EPS * rows_of(y11, y12, y22, abs(a) + abs(b), abs(b) + abs(c))
    change = change_in(disc, 0, n, y11, y12, y22) + rounding
    if not (change < CONTRACTING and frame[FAR_NOISE] < math.inf):
        return 0.0, 0.0, math.inf, d
    n1, n2, n3 = (
        dot(row_vector(disc.basis, 0), n),
        dot(row_vector(disc.basis, 1), n),
        dot(row_vector(disc.basis, 2), n),
    )
    unit, whole = frame[UNIT], frame[WHOLE]
    s, t = u / d, v / d
    base = rows_of(y11, y12, y22, frame[FAR_NOISE], frame[FAR_NOISE]) / (1.0 - change)
    if max(abs(s), abs(t)) > 1.0 + change + base:
        return 0.0, 0.0, -1.0, d  # the solution is too far from the pole
    # The 2-jet at the pole may be more accurate than 2-jets on a small circle around the pole.
    length, ring = math.hypot(s, t), 0
    while ring + 1 < disc.changes.shape[0] and 2.0 * length <= whole * 0.5 ** (ring + 1):
        ring += 1
    near = change_in(disc, ring, n, y11, y12, y22) + rounding
    first = (near * length + base) / (1.0 - change) + 4.0 * EPS * length
    u, r = place_towards(disc, s, t)
    if length == 0.0:
        return u, 0.0, first, d
    least, best_u, best_r, best_length = math.inf, 0.0, 0.0, math.inf
    for step in range(STEPS):
        if math.hypot(s, t) > 0.98 * whole:
            factor = 0.98 * whole / math.hypot(s, t)
            s, t = s * factor, t * factor
            u, r = place_towards(disc, s, t)
        if not r > 0.0:
            break
        here_s, here_t, u_s, u_t, r_s, r_t, g1, g2 = graph_at(tape, work, disc, u, r)
        if step == 0:
            least = first + max(abs(here_s - s), abs(here_t - t))
            best_u, best_r, best_length = u, r, math.hypot(here_s, here_t)
        f, g = unit * (n1 + g1 * n3), unit * (n2 + g2 * n3)
        noise = frame[FAR_NOISE] + frame[NEAR_NOISE] * frame[SIZE] / r
        noise = rows_of(y11, y12, y22, noise, noise) / (1.0 - change)
        s1, t1 = -(y11 * f + y12 * g), -(y12 * f + y22 * g)
        move = max(abs(s1), abs(t1))
        distance = move / (1.0 - change) + noise + 4.0 * EPS * length
        length = math.hypot(here_s, here_t)
        if not length <= whole:
            break
        if distance < least:
            least, best_u, best_r, best_length = distance, u, r, length
        s, t = here_s + s1, here_t + t1
        if max(abs(s), abs(t)) > 1.0 + change * move / (1.0 - change) + noise + 1e-12:
            return 0.0, 0.0, -1.0, d
        if distance <= CLOSE * noise:
            break
        if move > LONG * length:
            u, r = place_towards(disc, s, t)
        else:
            u, r = u + u_s * s1 + u_t * t1, r + r_s * s1 + r_t * t1
            u -= frame[TURN] * math.floor((u - frame[START]) / frame[TURN])
    # The solution lies in a square around the point; bounds have to hold in all of this square.
    if not best_length + 1.5 * least <= whole:
        least = math.inf
    return best_u, best_r, least, d


@jit
def decide_discs(tape, work, disc, normals, numbers, first, last, domain, answers):
    """Find the solutions in a disc for the normals (S, 3) with the indices `numbers`.

    The tape computes the coordinates of the plane and h from u and r, or their quotients by r.
    Returns the next position in `numbers`; see `decide_normals`.
    """
    answers.counts[0] = answers.counts[1] = 0
    frame = disc.frame
    size, start, turn, end, inward, angle = (
        frame[SIZE], frame[START], frame[TURN], frame[END], frame[INWARD], int(frame[ANGLE])
    )  # fmt: skip
    for k in range(first, last):
        number, at = numbers[k], answers.counts[0]
        if at == answers.numbers.shape[0] or answers.counts[1] == answers.kinds.shape[0]:
            return np.int64(k)
        u, r, radius, d = place_in(tape, work, disc, row_vector(normals, number))
        if radius < 0.0:
            continue
        if radius == math.inf:
            low, high = min(end, end + inward * size), max(end, end + inward * size)
            if angle == 0:
                add_open(answers, number, start, start + turn, low, high, OPEN_BOX, domain)
            else:
                add_open(answers, number, low, high, start, start + turn, OPEN_BOX, domain)
            continue
        error = 1.4143 * radius * frame[UNIT]
        of_r, rest = frame[BY_R] * error, 4.0 * EPS * (abs(end) + r)
        if r > size + of_r + rest:
            continue
        row = answers.places[at]
        row[angle], row[1 - angle] = u, end + inward * r
        row[2 + angle], row[3 - angle] = 0.5 * turn, of_r + rest
        if 2.0 * of_r < r:
            row[2 + angle] = min(frame[BY_U] * error / (r - of_r), 0.5 * turn)
        row[2 + angle] += 4.0 * EPS * (abs(start) + turn)
        row[4] = d
        # The box without other solutions is the whole disc: all angles, and r < 0 beyond the pole.
        row[5 + 2 * angle], row[6 + 2 * angle] = start - 2.0 * turn, start + 3.0 * turn
        edge, beyond = end + inward * frame[WHOLE] * size, end - inward * size
        row[7 - 2 * angle], row[8 - 2 * angle] = min(edge, beyond), max(edge, beyond)
        row[BORDER] = 0.0
        answers.numbers[at] = number
        answers.counts[0] = at + 1
    return np.int64(last)
