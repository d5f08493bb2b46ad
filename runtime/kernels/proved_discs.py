"""Discs around poles: the places with given normals there, in a chart without a singularity.

At a pole the parameters are an angle φ and a distance r. The surface is smooth in s = r cos φ and
t = r sin φ, which are scaled so that the disc is r ≤ 1. Bounds hold up to r = 2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.patch import eliminated_forms
from ..machine_code.jit import inline, jit, loop
from .proved_answers import BORDER, MULTIPLE, add_open
from .proved_cells import EPS, linear_forms_of, patch_of
from .proved_pairs import CLOSE, CONTRACTING
from .tape import POINT, U, V, evaluate_points
from .vectors import row_vector

__all__ = ["RINGS", "WHOLE", "Disc", "decide_discs"]

# Bounds hold up to this distance, and smaller ones up to halves of it, quarters, …
WHOLE, RINGS = 2.0, 8
# Steps towards a place.
STEPS = 60


class Disc(NamedTuple):
    """The disc around a pole.

    hot (1, 15): the vectors a, b, c, d, e of the patch that osculates at the pole, by s and t.
    changes (RINGS, 3, 3): how far x_ss, x_st, x_tt may be from a, b, c up to r = 2, 1, ½, …
    frame (8): rounding of x_r and of x_φ; radius of the disc; u or v at φ = 0, and for a full turn;
    the other one at the pole, whether it grows with r (1 or −1), and the number of the first, 0 or
    1. With a rounding of inf there are no bounds.
    """

    hot: NDArray[np.float64]
    changes: NDArray[np.float64]
    frame: NDArray[np.float64]


@inline
def bound_of(changes, ring, k, n):
    """Return the largest change of the product of n with a second derivative."""
    return (
        changes[ring, k, 0] * abs(n.x)
        + changes[ring, k, 1] * abs(n.y)
        + changes[ring, k, 2] * abs(n.z)
    )


@inline
def rows_of(y11, y12, y22, p, q):
    """Return the larger row of a matrix, without signs, times a vector."""
    return max(abs(y11) * p + abs(y12) * q, abs(y12) * p + abs(y22) * q)


@loop
def change_in(disc, ring, n, y11, y12, y22):
    """Return a bound of the change of the Hessian in a ring, times the inverse at the pole."""
    a, b, c = (
        bound_of(disc.changes, ring, 0, n),
        bound_of(disc.changes, ring, 1, n),
        bound_of(disc.changes, ring, 2, n),
    )
    i11, i12, i22 = abs(y11), abs(y12), abs(y22)
    return max(i11 * (a + b) + i12 * (b + c), i12 * (a + b) + i22 * (b + c)) * (1.0 + 16.0 * EPS)


@loop
def gradient_at(tape, work, phi, r, n):
    """Return the products of n with x_s and x_t at φ and r, of a tape in polar coordinates."""
    work.u[0], work.v[0] = phi, r
    evaluate_points(tape, work.u, work.v, 1, work.registers)
    around = away = 0.0
    for x in range(3):
        at = np.uint64(POINT * tape.outputs[x])
        around += n[x] * work.registers[at + U]
        away += n[x] * work.registers[at + V]
    around /= r
    x, y = math.cos(phi), math.sin(phi)
    return x * away - y * around, y * away + x * around


@loop
def place_in(tape, work, disc, n):
    """Return s, t, how far the only place with the normal n may be, and the determinant.

    The distance is infinite if this is not proved.
    """
    size = disc.frame[2]
    a, b, c, p, q = linear_forms_of(patch_of(disc.hot, 0), n)
    d, u, v, _ = eliminated_forms(a, b, c, p, q)
    y11, y12, y22 = c / d, -b / d, a / d
    rounding = 16.0 * EPS * rows_of(y11, y12, y22, abs(a) + abs(b), abs(b) + abs(c))
    change = change_in(disc, 0, n, y11, y12, y22) + rounding
    away_noise, around_noise = disc.frame[0] * size, disc.frame[1]
    if not (change < CONTRACTING and away_noise < math.inf):
        return 0.0, 0.0, math.inf, d
    s, t = u / d, v / d
    least = math.inf
    best_s = best_t = 0.0
    for step in range(STEPS):
        r = math.hypot(s, t)
        base = rows_of(y11, y12, y22, away_noise, away_noise) / (1.0 - change) + 4.0 * EPS * r
        if step == 0:
            if max(abs(s), abs(t)) > 1.0 + change + base:
                return s, t, 0.0, d  # the step to it from the pole is too long
            # From the 2-jet at the pole, which is better than a small circle around it.
            ring = 0
            while ring + 1 < RINGS and r <= WHOLE * 0.5 ** (ring + 1):
                ring += 1
            near = change_in(disc, ring, n, y11, y12, y22) + rounding
            least, best_s, best_t = near * r / (1.0 - change) + base, s, t
        if r == 0.0 or r >= WHOLE:
            break
        f, g = gradient_at(tape, work, math.atan2(t, s), r * size, n)
        f, g = size * f, size * g
        noise = away_noise + around_noise / r + 8.0 * EPS * (abs(f) + abs(g))
        here = rows_of(y11, y12, y22, noise, noise) / (1.0 - change) + 4.0 * EPS * r
        s1, t1 = y11 * f + y12 * g, y12 * f + y22 * g
        distance = max(abs(s1), abs(t1)) / (1.0 - change) + here
        if distance < least:
            least, best_s, best_t = distance, s, t
        if distance <= CLOSE * here:
            break
        s, t = s - s1, t - t1
    # The square around the place has to be where bounds hold.
    if not math.hypot(best_s, best_t) + 1.5 * least <= WHOLE:
        least = math.inf
    return best_s, best_t, least, d


@jit
def decide_discs(tape, work, disc, normals, numbers, first, last, domain, answers):
    """Find the places in a disc with normals (S, 3) of some numbers; see `decide_normals`.

    The tape is that of the surface in polar coordinates. Returns the next position in `numbers`.
    """
    answers.counts[0] = answers.counts[1] = 0
    frame = disc.frame
    size, start, turn, end, inward, angle = (
        frame[2], frame[3], frame[4], frame[5], frame[6], int(frame[7])
    )  # fmt: skip
    for k in range(first, last):
        number, at = numbers[k], answers.counts[0]
        if at == answers.numbers.shape[0] or answers.counts[1] == answers.kinds.shape[0]:
            return np.int64(k)
        s, t, radius, d = place_in(tape, work, disc, row_vector(normals, number))
        r, error = math.hypot(s, t), 1.4143 * radius
        other = end + inward * r * size
        rest = 4.0 * EPS * abs(end)
        if radius == math.inf:
            low, high = min(end, end + inward * size), max(end, end + inward * size)
            if angle == 0:
                add_open(answers, number, start, start + turn, low, high, MULTIPLE, domain)
            else:
                add_open(answers, number, low, high, start, start + turn, MULTIPLE, domain)
            continue
        if r > 1.0 + error + rest / size:
            continue
        phi = math.atan2(t, s)
        if phi < 0.0:
            phi += 2.0 * math.pi
        half = math.pi if error >= r else 1.58 * error / r + 4.0 * EPS * phi
        row = answers.places[at]
        row[angle], row[1 - angle] = start + turn * (phi / (2.0 * math.pi)), other
        row[2 + angle] = min(turn * half / (2.0 * math.pi), 0.5 * turn) + 4.0 * EPS * (
            abs(start) + turn
        )
        row[3 - angle] = error * size + rest
        row[4] = d
        # The disc, with all angles.
        row[5 + 2 * angle], row[6 + 2 * angle] = start - 2.0 * turn, start + 3.0 * turn
        edge = end + inward * WHOLE * size
        row[7 - 2 * angle], row[8 - 2 * angle] = min(end, edge), max(end, edge)
        row[7 - 2 * angle] -= size
        row[8 - 2 * angle] += size
        row[BORDER] = 0.0
        answers.numbers[at] = number
        answers.counts[0] = at + 1
    return np.int64(last)
