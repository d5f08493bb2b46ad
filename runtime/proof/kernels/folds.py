"""Folds: small boxes with a singular Hessian, in which no point or two have a given normal."""

from __future__ import annotations

import math

import numpy as np

from ....generated.proved import fold_curve, fold_extreme, turned, turned_forms
from ...machine_code.jit import loop
from ...tape.kernels.points import POINT, evaluate_points
from .cell_bounds import (
    EPS,
    FIRST_S,
    FIRST_T,
    REACH,
    SECOND,
    gap_of,
    linear_forms_of,
    patch_of,
    thirds_of,
    write_cells,
)
from .pairs import forms_at

NO_PLACE, DOUBLE, UNKNOWN = range(3)
# Coordinates along the eigenvector of the Hessian with the larger eigenvalue, and across it, are
# between −ALONG and ALONG, and between −ACROSS and ACROSS, so that bounds are needed for |s|, |t| ≤
# √(2² + 2) < WIDER.
ALONG, ACROSS, WIDER = 2.0, 1.4143, 2.5
# The largest number of steps towards the extremum, and the length below which a step is the last.
STEPS, SMALL = 30, 1e-10


@loop
def at_fold(tape, work, tile, n):
    """Classify the first cell of a tile: no point with the normal n, a double point, or unknown.

    For a double point, the cell is replaced by a box that contains all points of the cell with the
    normal n: none, or two that are close to each other.
    """
    write_cells(tape, work, WIDER, tile, 1)
    if tile.noise[0, REACH] < WIDER:
        return UNKNOWN
    a, b, c, p, q = linear_forms_of(patch_of(tile.hot, 0), n)
    angle = 0.5 * math.atan2(2.0 * b, a - c)
    x, y = math.cos(angle), math.sin(angle)
    a1, b1, c1, p1, _ = turned_forms(a, b, c, p, q, x, y)
    if abs(c1) > abs(a1):
        x, y = -y, x
        a1, b1, c1, p1, _ = turned_forms(a, b, c, p, q, x, y)
    t0, t1, t2, t3, r0, r1, r2, r3 = thirds_of(tile.thirds, 0, n)
    m0, m1, m2, m3, s0, s1, s2, s3 = turned(t0, t1, t2, t3, r0, r1, r2, r3, x, y)
    g0, g1, g2 = abs(m0) + s0, abs(m1) + s1, abs(m2) + s2
    first = tile.noise[0, FIRST_S] + tile.noise[0, FIRST_T] + 8.0 * EPS * (abs(p) + abs(q))
    second = 4.0 * tile.noise[0, SECOND] + 16.0 * EPS * (abs(a) + abs(b) + abs(c))
    least, slope, change, excess = fold_curve(a1, p1, g0, g1, g2, ALONG, ACROSS, first, second)
    bend = (abs(m3) - s3 - change) * (1.0 - 64.0 * EPS)
    if not (least > 0.0 and excess < 0.0 and bend > 0.0):
        return UNKNOWN
    u, v, h_u, h_v = tile.place[0, 0], tile.place[0, 1], tile.place[0, 2], tile.place[0, 3]
    along = across = step = q1 = 0.0
    for _ in range(STEPS):
        work.u[0] = u + h_u * (x * along - y * across)
        work.v[0] = v + h_v * (y * along + x * across)
        evaluate_points(tape, work.u, work.v, 1, work.registers)
        a, b, c, p, q = forms_at(
            work.registers, np.uint64(POINT * tape.outputs[0]), np.uint64(POINT * tape.outputs[1]),
            np.uint64(POINT * tape.outputs[2]), n, h_u, h_v,
        )  # fmt: skip
        a1, b1, c1, p1, q1 = turned_forms(a, b, c, p, q, x, y)
        if abs(step) < SMALL and abs(p1) < SMALL * least and step != 0.0:
            break
        step = -(c1 - b1 * b1 / a1) / m3
        along -= (p1 + b1 * step) / a1
        across += step
        if not (abs(along) < ALONG and abs(across) < ACROSS):
            return UNKNOWN
    rest, reach, offset = fold_extreme(
        a1, b1, c1, p1, q1, g0, g1, g2, slope, least, bend, first, second
    )
    value = q1 if m3 > 0.0 else -q1
    if value > rest * (1.0 + 64.0 * EPS):
        return NO_PLACE
    if value < -4.0 * rest:
        return UNKNOWN
    reach_u = h_u * (abs(x) * offset + abs(y) * reach)
    reach_v = h_v * (abs(y) * offset + abs(x) * reach)
    gap = gap_of(u, v, h_u, h_v)
    if (
        abs(work.u[0] - u) > h_u * (1.0 + gap) + reach_u
        or abs(work.v[0] - v) > h_v * (1.0 + gap) + reach_v
    ):
        return NO_PLACE
    tile.place[0, 0], tile.place[0, 1] = work.u[0], work.v[0]
    tile.place[0, 2], tile.place[0, 3] = reach_u, reach_v
    return DOUBLE
