"""Classification of normals by the signs of the forms of a patch.

A patch has a normal if U, V, W have one sign there (Sect. 3.2), which is that of D. The code of a
normal is NO, YES, or UNDECIDED if the signs are uncertain because of rounding.
"""

from __future__ import annotations

import math

import numpy as np

from ...generated.patch import forms, parameters
from ...generated.vectors import Vector
from ..base.tolerances import ACCURATE
from ..machine_code.jit import inline, loop
from .patch import normal_of_patch
from .vectors import dot

__all__ = [
    "NO",
    "UNDECIDED",
    "YES",
    "classify",
    "code_again",
    "code_of",
    "count_undecided",
    "look_again",
]

# Typed, since Numba compiles a function anew for each literal number in its arguments.
NO, YES, UNDECIDED = np.int8(0), np.int8(1), np.int8(2)


@inline
def code_of(patch, axis, widest, lowest, bound, least, n):
    """Return the code of a normal: the squared sine and the cosine to the axis, the forms."""
    D, U, V, W = forms(patch, n)
    low = U if U < V else V
    low = low if low < W else W
    high = U if U > V else V
    high = high if high > W else W
    s = n.y * axis.z - n.z * axis.y
    t = n.z * axis.x - n.x * axis.z
    w = n.x * axis.y - n.y * axis.x
    apart = (s * s + t * t + w * w > widest) | (n.x * axis.x + n.y * axis.y + n.z * axis.z < lowest)
    outside = (low < -bound) & (high > bound)
    sure = ((low > bound) | (high < -bound)) & (abs(D) > least)
    return NO if outside | apart else YES if sure else UNDECIDED


@loop
def classify(patch, axis, sine, bound, x, y, z, codes, count):
    """Write the codes of normals with components x, y, z (…).

    `bound` is the error of the forms. The normals of the patch lie in the cone with an axis and a
    sine, which is infinite without a cone. The loop has no branches, so that it is vectorized.
    """
    least = ACCURATE * bound
    lowest = 0.0 if sine < math.inf else -math.inf
    widest = sine * sine
    for k in range(count):
        codes[k] = code_of(patch, axis, widest, lowest, bound, least, Vector(x[k], y[k], z[k]))


@loop
def look_again(patch, x, y, z, codes, count):
    """Compare hits of a patch without a narrow cone with the oriented normal at their parameters.

    The forms are even in n: they do not distinguish a normal from its opposite, as a cone does.
    """
    for k in range(count):
        if codes[k] == YES:
            codes[k] = code_again(patch, Vector(x[k], y[k], z[k]))


@inline
def code_again(patch, n):
    """Return the code of a hit of a patch without a narrow cone; see `look_again`."""
    D, U, V, _ = forms(patch, n)
    u, v = parameters(D, U, V)
    N = normal_of_patch(patch, u, v)
    towards = dot(n, N)
    size = abs(N.x) + abs(N.y) + abs(N.z)
    sure = abs(towards) > 0.25 * size and size > 0.0
    return UNDECIDED if not sure else NO if towards < 0.0 else YES


@inline
def count_undecided(codes, count):
    """Return the number of codes that are UNDECIDED."""
    found = 0
    for k in range(count):
        found += codes[k] == UNDECIDED
    return found
