"""Classification of normals by the signs of the forms of a patch.

A patch has a normal if U, V, W have one sign there (Sect. 3.2), which is that of D. The code of a
normal is NO, YES, or UNDECIDED if the signs are uncertain because of rounding.
"""

from __future__ import annotations

import math

import numpy as np

from ...generated.patch import forms, parameters
from ...generated.spline import NEIGHBOURS
from ...generated.vectors import Vector
from ..tolerances import ACCURATE, FORM_ERROR
from .cone import tangent_bounds
from .jit import inline, loop
from .patch import normal_of_patch
from .vectors import dot

__all__ = ["NO", "UNDECIDED", "YES", "bound_of_forms", "classify", "count_undecided", "look_again"]

# Typed, since Numba compiles a function anew for each literal number in its arguments.
NO, YES, UNDECIDED = np.int8(0), np.int8(1), np.int8(2)


@loop
def bound_of_forms(mu, i, j, turn, scale, noise, border, axis, sine, patch):
    """Return a bound of the rounding error of U, V, W of a patch.

    The normals lie in the cone with an axis (3,) and a sine, which is infinite without a cone. On
    an open side of the domain, as `border` (4,) says, the error includes the rounding of
    coordinates, `noise`.
    """
    form = error = 0.0
    largest = tangent_bounds(patch)
    for x in range(3):
        n = abs(axis[x]) + sine if sine < math.inf else 1.0  # an upper bound
        difference = 0.0
        for k in range(9):
            p = i + 1 + NEIGHBOURS[turn, k, 0]
            q = j + 1 + NEIGHBOURS[turn, k, 1]
            difference = max(difference, abs(mu[p, q, x] - mu[i + 1, j + 1, x]))
        form += n * largest[x]
        error += n * difference
    error *= FORM_ERROR * scale
    if (
        (turn == 0 and j == 0 and border[0])
        or (turn == 1 and i == mu.shape[0] - 3 and border[1])
        or (turn == 2 and j == mu.shape[1] - 3 and border[2])
        or (turn == 3 and i == 0 and border[3])
    ):
        error += noise
    return 32.0 * error * (form + error)


@loop
def classify(patch, axis, sine, bound, x, y, z, codes, count):
    """Write the codes of normals with components x, y, z (…).

    `bound` is the error of the forms. The normals of the patch lie in the cone with an axis and a
    sine, which is infinite without a cone. The loop has no branches, so that it is vectorized.
    """
    least = ACCURATE * bound
    lowest = 0.0 if sine < math.inf else -math.inf
    widest = sine * sine
    r = Vector(axis[0], axis[1], axis[2])
    for k in range(count):
        n = Vector(x[k], y[k], z[k])
        D, U, V, W = forms(patch, n)
        low = U if U < V else V
        low = low if low < W else W
        high = U if U > V else V
        high = high if high > W else W
        s = n.y * r.z - n.z * r.y
        t = n.z * r.x - n.x * r.z
        w = n.x * r.y - n.y * r.x
        apart = (s * s + t * t + w * w > widest) | (n.x * r.x + n.y * r.y + n.z * r.z < lowest)
        outside = (low < -bound) & (high > bound)
        sure = ((low > bound) | (high < -bound)) & (abs(D) > least)
        codes[k] = NO if outside | apart else YES if sure else UNDECIDED


@loop
def look_again(patch, x, y, z, codes, count):
    """Compare hits of a patch without a narrow cone with the oriented normal at their parameters.

    The forms are even in n: they do not distinguish a normal from its opposite, as a cone does.
    """
    for k in range(count):
        if codes[k] != YES:
            continue
        n = Vector(x[k], y[k], z[k])
        D, U, V, _ = forms(patch, n)
        u, v = parameters(D, U, V)
        N = normal_of_patch(patch, u, v)
        towards = dot(n, N)
        size = abs(N.x) + abs(N.y) + abs(N.z)
        if not (abs(towards) > 0.25 * size and size > 0.0):
            codes[k] = UNDECIDED
        elif towards < 0.0:
            codes[k] = NO


@inline
def count_undecided(codes, count):
    """Return the number of codes that are UNDECIDED."""
    found = 0
    for k in range(count):
        found += codes[k] == UNDECIDED
    return found
