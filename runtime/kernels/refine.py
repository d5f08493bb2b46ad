"""Newton's method for the points of a surface that have given normals, many at once.

A row is a sample. The surface is known by 2-jets (k, 6, 3), x, x_u, x_v, x_uu, x_uv and x_vv, which
the caller computes at `Rows.place` before each step.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.jet import at_jet, at_pole, polar_chart
from ...generated.jet import newton as newton_of_jet
from ...generated.patch import tangents
from ...generated.vectors import Patch, Vector
from ..tolerances import VANISHING
from .jit import inline, jit, loop
from .vectors import dot, row_vector, set_row

__all__ = [
    "CLAMPED",
    "FREE",
    "PERIODIC",
    "Rows",
    "Target",
    "chart_jets",
    "evaluate_jets",
    "jet_of_pole",
    "newton",
]

# What a parameter does at the ends of its interval: there are none, it stops there, or it goes on
# at the other end.
FREE, CLAMPED, PERIODIC = 0, 1, 2
# In cells of the spline: the length of a step, and of all steps together. What is farther away
# belongs to another sample.
LONGEST_STEP, FARTHEST = 1.0, 3.0
# The part of a step that is taken back if the angle does not get smaller by it.
TAKEN_BACK = 0.5
# A squared sine that does not get smaller than this part of the last one does not converge.
SLOW = 0.25
OPPOSITE = 4.0  # in place of the squared sine of angles above 90 degrees


class Rows(NamedTuple):
    """The rows that are not finished: their `numbers` (n,), and the parameters (2, n) of each.

    By the numbers of rows, in cells of the spline: the last `step` (n, 2), and all steps `gone`
    (n, 2) together; and the squared sine (n,) of the smallest angle so far.
    """

    numbers: NDArray[np.int64]
    place: NDArray[np.float64]
    step: NDArray[np.float64]
    gone: NDArray[np.float64]
    least: NDArray[np.float64]


class Target(NamedTuple):
    """By the numbers of rows: the normals, signs that K must not contradict, and what is found."""

    normals: NDArray[np.float64]
    signs: NDArray[np.float64]
    uv: NDArray[np.float64]
    points: NDArray[np.float64]
    gaussian: NDArray[np.float64]
    mean: NDArray[np.float64]
    found: NDArray[np.bool_]


@inline
def jet_vector(jets, k, i, factor):
    """Return a vector of a 2-jet, times a factor."""
    return Vector(factor * jets[k, i, 0], factor * jets[k, i, 1], factor * jets[k, i, 2])


@inline
def patch_of_jet(jets, k, size, du, dv):
    """Return the patch that osculates `size` times the surface, in cells of the parameters."""
    along_u = size * du
    along_v = size * dv
    return Patch(
        jet_vector(jets, k, 3, along_u * du),
        jet_vector(jets, k, 4, along_u * dv),
        jet_vector(jets, k, 5, along_v * dv),
        jet_vector(jets, k, 1, along_u),
        jet_vector(jets, k, 2, along_v),
        jet_vector(jets, k, 0, 1.0),
    )


@inline
def after_step(value, step, low, high, kind):
    """Return a parameter after a step, inside its interval."""
    value += step
    if kind == PERIODIC:
        if value < low:
            value += high - low
        elif value > high:
            value -= high - low
    return value if kind == FREE else min(max(value, low), high)


@loop
def store(target, row, patch, u, v, size):
    """Write the sample at (u, v), unless it has no curvature, or one of the wrong sign."""
    _, _, K, H = at_jet(patch)
    if not target.signs[row] * K >= 0.0 or not abs(K) < math.inf:
        return
    target.uv[row, 0] = u
    target.uv[row, 1] = v
    set_row(target.points, row, patch.p)
    target.gaussian[row] = K * size * size
    target.mean[row] = H * size
    target.found[row] = True


@jit
def newton(jets, count, rows, target, frame, box, kinds, size, tolerance, noise):
    """Finish the first `count` rows or move them by a step; return how many are left.

    A row is finished where the squared sine of the angle between its normal and that of the surface
    is at most `tolerance`, or where it is below `noise` and does not get smaller. `frame` = (du,
    dv) is the size of a cell, `box` = (u0, u1, v0, v1) the domain. `size` times the surface has
    cells of about the size 1.
    """
    du, dv = frame
    # Of the parameters, in cells: shorter steps change nothing.
    rounding_u = 2.0**-51 * max(abs(box[0]), abs(box[1])) / du
    rounding_v = 2.0**-51 * max(abs(box[2]), abs(box[3])) / dv
    left = 0
    for k in range(count):
        row = rows.numbers[k]
        u, v = rows.place[0, k], rows.place[1, k]
        patch = patch_of_jet(jets, k, size, du, dv)
        D, U, V, sine, cosine = newton_of_jet(patch, row_vector(target.normals, row))
        least = rows.least[row]
        if not cosine > 0.0:
            sine = OPPOSITE
        if sine <= tolerance or (sine <= noise and sine > SLOW * least):
            store(target, row, patch, u, v, size)
            continue
        if sine < least:
            rows.least[row] = sine
            s, t = U / D, V / D
            if abs(s) <= rounding_u and abs(t) <= rounding_v and cosine > 0.0:
                store(target, row, patch, u, v, size)
                continue
            length = math.sqrt(s * s + t * t)
            if length > LONGEST_STEP:
                s *= LONGEST_STEP / length
                t *= LONGEST_STEP / length
        else:
            s, t = -TAKEN_BACK * rows.step[row, 0], -TAKEN_BACK * rows.step[row, 1]
        new_u = after_step(u, s * du, box[0], box[1], kinds[0])
        new_v = after_step(v, t * dv, box[2], box[3], kinds[1])
        rows.step[row, 0] = s
        rows.step[row, 1] = t
        rows.gone[row, 0] += s
        rows.gone[row, 1] += t
        far = rows.gone[row, 0] ** 2 + rows.gone[row, 1] ** 2
        # Where there is no number, as U/D for D = 0, no comparison is true.
        if far <= FARTHEST * FARTHEST and (new_u != u or new_v != v):
            rows.numbers[left] = row
            rows.place[0, left] = new_u
            rows.place[1, left] = new_v
            left += 1
    return left


@jit
def evaluate_jets(jets, scales, normals, gaussian, mean):
    """Write unit normals (k, 3), K (k,) and H (k,) from 2-jets (k, 6, 3); 0 at singular points.

    `scales` = (size, du, dv): `size` times the surface has cells du × dv of about the size 1.
    """
    size, du, dv = scales
    for k in range(jets.shape[0]):
        patch = patch_of_jet(jets, k, size, du, dv)
        L, n, K, H = at_jet(patch)
        scale = math.sqrt(dot(patch.d, patch.d) * dot(patch.e, patch.e))
        regular = VANISHING * scale < L and abs(K) < math.inf
        set_row(normals, k, n if regular else Vector(0.0, 0.0, 0.0))
        gaussian[k] = K * size * size if regular else 0.0
        mean[k] = H * size if regular else 0.0


# --- the chart at a pole --------------------------------------------------------------------------


@inline
def polar_jet(jets, k, angle, turn, sign):
    """Return a 2-jet by φ and r: the parameter `angle` is φ/turn, and the other grows as sign r."""
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


@inline
def set_jet(chart, k, x, X_s, X_t, X_ss, X_st, X_tt):
    """Write a 2-jet."""
    set_row(chart[k], 0, x)
    set_row(chart[k], 1, X_s)
    set_row(chart[k], 2, X_t)
    set_row(chart[k], 3, X_ss)
    set_row(chart[k], 4, X_st)
    set_row(chart[k], 5, X_tt)


@jit
def jet_of_pole(jets, angle, sign, chart):
    """Write the 2-jet (1, 6, 3) of a pole, from those (3, 6, 3) at 0, 45 and 90 degrees."""
    first = polar_jet(jets, 0, angle, 1.0, sign)
    middle = polar_jet(jets, 1, angle, 1.0, sign)
    last = polar_jet(jets, 2, angle, 1.0, sign)
    X_ss, X_st, X_tt, X_s, X_t = at_pole(first.e, first.c, middle.c, last.e, last.c)
    set_jet(chart, 0, first.p, X_s, X_t, X_ss, X_st, X_tt)


@jit
def chart_jets(jets, phi, r, angle, turn, sign, near, pole, chart):
    """Write 2-jets (k, 6, 3) by s = r cos φ and t = r sin φ, from those by the parameters.

    Where r (k,) is at most `near`, that of the `pole` itself (1, 6, 3) is continued.
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
        set_jet(chart, k, jet_vector(jets, k, 0, 1.0), X_s, X_t, X_ss, X_st, X_tt)
