"""Newton's method for the points of a surface that have given normals, many at once.

A row is a sample. The surface is given by 2-jets (k, 6, 3), x, x_u, x_v, x_uu, x_uv and x_vv, which
the caller computes at `Rows.place` before each step.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.jet import at_jet, at_pole, polar_chart
from ....generated.jet import newton as newton_of_jet
from ....generated.patch import tangents
from ....generated.vectors import Patch, Vector
from ...base.tolerances import NORMAL_ERROR
from ...directions.kernels.vectors import row_vector, set_jet, set_row
from ...machine_code.jit import inline, jit
from ...spline.kernels.jets import is_regular, jet_vector, patch_of_jet

# The kinds of parameters: unbounded, clamped to an interval, or periodic.
FREE, CLAMPED, PERIODIC = 0, 1, 2
NOT_FOUND, FOUND = 0, 1
# In cells of the spline: the largest length of a step, and of all steps together. A point farther
# away belongs to another sample.
LONGEST_STEP, FARTHEST = 1.0, 3.0
# The part of a step that is undone if the step does not reduce the angle.
TAKEN_BACK = 0.5
# The iteration stagnates if the squared sine of the angle is above this part of the least one so
# far; an angle up to the noise is then accepted.
SLOW = 0.25
OPPOSITE = 4.0  # in place of the squared sine of angles above 90 degrees


class Rows(NamedTuple):
    """The unfinished rows: their indices `numbers` (n,), and their parameters (2, n).

    `steps` (4, n) are the last step and the sum of all steps, in units of cells of the spline.
    `least` (n,) is the squared sine of the smallest angle so far.
    """

    numbers: NDArray[np.int64]
    place: NDArray[np.float64]
    steps: NDArray[np.float64]
    least: NDArray[np.float64]

    @classmethod
    def new(cls, numbers: NDArray[np.int64]) -> Rows:
        """Return arrays for the state of rows with these indices."""
        count = len(numbers)
        return cls(numbers, np.empty((2, count)), np.empty((4, count)), np.empty(count))


class Target(NamedTuple):
    """For each row: the normal, the required sign of K (0 for any sign), and the resulting sample.

    `state` (n,) is NOT_FOUND or FOUND. A row is written only when its point is found; all other
    rows keep their values.
    """

    normals: NDArray[np.float64]
    signs: NDArray[np.float64]
    uv: NDArray[np.float64]
    points: NDArray[np.float64]
    gaussian: NDArray[np.float64]
    mean: NDArray[np.float64]
    state: NDArray[np.int8]


class Box(NamedTuple):
    """The bounds of u and v, their kinds (FREE, …), and the size of a cell of the spline."""

    ends: tuple[float, float, float, float]
    kinds: tuple[int, int]
    cell: tuple[float, float]


@inline
def inside(value, low, high, kind):
    """Return a parameter moved into its interval, by a period or to the nearest end, if needed."""
    if kind == PERIODIC:
        if value < low:
            value += high - low
        elif value > high:
            value -= high - low
    return value if kind == FREE else min(max(value, low), high)


@jit
def begin(uv, count, rows, box):
    """Write the parameters and the state of the first `count` rows before their first step."""
    u0, u1, v0, v1 = box.ends
    for at in range(count):
        k = np.uint64(at)
        row = np.uint64(rows.numbers[k])
        rows.place[0, k] = inside(uv[row, 0], u0, u1, box.kinds[0])
        rows.place[1, k] = inside(uv[row, 1], v0, v1, box.kinds[1])
        for i in range(4):
            rows.steps[np.uint64(i), k] = 0.0
        rows.least[k] = math.inf


@inline
def store(target, row, patch, u, v, size):
    """Store the sample at (u, v), unless it is singular or K has the wrong sign.

    K may have the wrong sign if it is 0 up to the error of the normal, as at parabolic points.
    """
    L, _, K, H = at_jet(patch)
    if target.signs[row] * K >= -NORMAL_ERROR * 4.0 * H * H and is_regular(patch, L, K):
        unit = 1.0 / size
        target.uv[row, 0] = u
        target.uv[row, 1] = v
        set_row(target.points, row, Vector(patch.p.x * unit, patch.p.y * unit, patch.p.z * unit))
        # The stored K has the required sign, also if K is 0.
        sign = target.signs[row] if target.signs[row] != 0.0 else K
        target.gaussian[row] = math.copysign(K * size * size, sign)
        target.mean[row] = H * size
        target.state[row] = FOUND


@inline
def keep(rows, left, row, u, v, s, t, gone_u, gone_v, least):
    """Write the state of an unfinished row, which becomes row `left`."""
    at = np.uint64(left)
    rows.numbers[at] = row
    rows.place[0, at] = u
    rows.place[1, at] = v
    rows.steps[0, at] = s
    rows.steps[1, at] = t
    rows.steps[2, at] = gone_u
    rows.steps[3, at] = gone_v
    rows.least[at] = least


@jit
def newton(jets, count, rows, target, box, size, tolerance, noise):
    """Finish the first `count` rows or move them by a step; return the number of unfinished rows.

    A row is finished if the squared sine of the angle between its normal and that of the surface is
    at most `tolerance`, or if it is at most `noise` and the iteration stagnates (see SLOW) or stays
    at the same parameters. The point and the curvatures of a finished row are written. A row is
    given up if it stays at the same parameters with a larger angle, or goes farther than FARTHEST.
    `size`, a power of two, scales the surface to cells of about the size 1.
    """
    u0, u1, v0, v1 = box.ends
    du, dv = box.cell
    left = 0
    for at in range(count):
        k = np.uint64(at)
        row = np.uint64(rows.numbers[k])
        u, v, least = rows.place[0, k], rows.place[1, k], rows.least[k]
        patch = patch_of_jet(jets, k, size, du, dv)
        s, t, sine, cosine = newton_of_jet(patch, row_vector(target.normals, row))
        if not cosine > 0.0:
            sine = OPPOSITE
        if sine <= tolerance or (sine <= noise and sine > SLOW * least):
            store(target, row, patch, u, v, size)
            continue
        if sine < least:
            least = sine
            length = math.sqrt(s * s + t * t)
            if length > LONGEST_STEP:
                s *= LONGEST_STEP / length
                t *= LONGEST_STEP / length
        else:
            s, t = -TAKEN_BACK * rows.steps[0, k], -TAKEN_BACK * rows.steps[1, k]
        new_u = inside(u + s * du, u0, u1, box.kinds[0])
        new_v = inside(v + t * dv, v0, v1, box.kinds[1])
        gone_u, gone_v = rows.steps[2, k] + s, rows.steps[3, k] + t
        # Comparisons with NaN, as from 1/D for D = 0, are false.
        near = gone_u * gone_u + gone_v * gone_v <= FARTHEST * FARTHEST
        if near and (new_u != u or new_v != v):
            keep(rows, left, row, new_u, new_v, s, t, gone_u, gone_v, least)
            left += 1
        elif near and sine <= noise:
            store(target, row, patch, u, v, size)
    return left


# --- the chart at a pole --------------------------------------------------------------------------


@inline
def polar_jet(jets, k, angle, turn, sign):
    """Return the 2-jet with respect to φ and r, from the 2-jet with respect to u and v.

    The parameter with the index `angle` (0 or 1) is φ/turn; the other one is `sign` r + const.
    """
    radius = 1 - angle
    by_angle = 1.0 / turn
    return Patch(
        jet_vector(jets, k, 3 + 2 * angle, by_angle * by_angle),
        jet_vector(jets, k, 4, by_angle * sign),
        jet_vector(jets, k, 3 + 2 * radius, 1.0),
        jet_vector(jets, k, 1 + angle, by_angle),
        jet_vector(jets, k, 1 + radius, sign),
        jet_vector(jets, k, 0, 1.0),
    )


@jit
def jet_of_pole(jets, angle, sign, chart):
    """Write the 2-jet (1, 6, 3) of a pole, from 2-jets (3, 6, 3) at 0, 45 and 90 degrees."""
    first = polar_jet(jets, 0, angle, 1.0, sign)
    middle = polar_jet(jets, 1, angle, 1.0, sign)
    last = polar_jet(jets, 2, angle, 1.0, sign)
    X_ss, X_st, X_tt, X_s, X_t = at_pole(first.e, first.c, middle.c, last.e, last.c)
    set_jet(chart[0], first.p, X_s, X_t, X_ss, X_st, X_tt)


@jit
def chart_jets(jets, phi, r, angle, turn, sign, near, pole, chart):
    """Write 2-jets (k, 6, 3) with respect to s = r cos φ and t = r sin φ, from 2-jets in u and v.

    Where r (k,) is at most `near`, the 2-jet (1, 6, 3) of the `pole` is continued.
    """
    for k in range(phi.size):
        x, y = math.cos(phi[k]), math.sin(phi[k])
        if r[k] > near:
            polar = polar_jet(jets, k, angle, turn, sign)
            X_ss, X_st, X_tt, X_s, X_t = polar_chart(polar, r[k], x, y)
        else:
            there = patch_of_jet(pole, 0, 1.0, 1.0, 1.0)
            X_ss, X_st, X_tt = there.a, there.b, there.c
            X_s, X_t, _ = tangents(there, r[k] * x, r[k] * y)
        set_jet(chart[k], jet_vector(jets, k, 0, 1.0), X_s, X_t, X_ss, X_st, X_tt)
