"""The functions of one variable in tapes: Taylor coefficients at a number, and their ranges."""

from __future__ import annotations

import math

from ....generated import elementary
from ...machine_code.jit import inline, loop

UNIT = 2.0**-53  # unit roundoff
QUARTER = 0.5 * math.pi
FAR = 1e8  # beyond this, reduction modulo π/2 is inaccurate
# Adding and subtracting this rounds numbers to integers.
SHIFT = 1.5 * 2.0**52
LARGEST_ANGLE = 2.0**18  # largest argument of `reduced_angle`


@inline
def sine_and_cosine(x):
    """Return the sine and the cosine of an angle, as accurate as those of the C library.

    Angles are below LARGEST_ANGLE. The code has no branches, so that loops over lanes are
    vectorized.
    """
    k = (x * (1.0 / QUARTER) + SHIFT) - SHIFT
    y, w = elementary.sine_and_cosine(elementary.reduced_angle(x, k))
    half = ((0.5 * k - 0.25) + SHIFT) - SHIFT  # half of an integer, rounded down
    whole = ((0.5 * half - 0.25) + SHIFT) - SHIFT
    sign = 1.0 - 2.0 * (half - 2.0 * whole)
    swapped = k != 2.0 * half
    return sign * (w if swapped else y), sign * (-y if swapped else w)


@loop
def coefficients(code, x):
    """Return the value at x of the function with this code, and its Taylor coefficients there.

    They are NaN or infinite where they do not exist.
    """
    if code == elementary.RECIPROCAL:
        y = 1.0 / x
        f1, f2, f3 = elementary.reciprocal_taylor(y)
        return y, f1, f2, f3
    if code == elementary.SQUARE:
        f1, f2, f3 = elementary.square_taylor(x)
        return x * x, f1, 1.0, 0.0
    if code == elementary.CUBE:
        f1, f2, f3 = elementary.cube_taylor(x)
        return x * x * x, f1, f2, 1.0
    if code == elementary.SQRT:
        y = math.sqrt(x)
        f1, f2, f3 = elementary.sqrt_taylor(y)
        return y, f1, f2, f3
    if code == elementary.EXP:
        y = math.exp(x)
        f1, f2, f3 = elementary.exp_taylor(y)
        return y, f1, f2, f3
    if code == elementary.LOG:
        f1, f2, f3 = elementary.log_taylor(x)
        return math.log(x), f1, f2, f3
    if code == elementary.SIN or code == elementary.COS:
        y, w = math.sin(x), math.cos(x)
        if code == elementary.SIN:
            f1, f2, f3 = elementary.sin_taylor(y, w)
            return y, f1, f2, f3
        f1, f2, f3 = elementary.cos_taylor(w, y)
        return w, f1, f2, f3
    if code == elementary.SINH or code == elementary.COSH:
        y, w = math.sinh(x), math.cosh(x)
        if code == elementary.SINH:
            f1, f2, f3 = elementary.sinh_taylor(y, w)
            return y, f1, f2, f3
        f1, f2, f3 = elementary.cosh_taylor(w, y)
        return w, f1, f2, f3
    if code == elementary.TANH:
        y = math.tanh(x)
        f1, f2, f3 = elementary.tanh_taylor(y)
        return y, f1, f2, f3
    if code == elementary.ASIN:
        f1, f2, f3 = elementary.asin_taylor(x)
        return math.asin(x), f1, f2, f3
    if code == elementary.ERF:
        f1, f2, f3 = elementary.erf_taylor(x, math.exp(-x * x))
        return math.erf(x), f1, f2, f3
    if code == elementary.SIGN:  # 0 where it jumps
        return math.copysign(1.0, x) if x != 0.0 else 0.0, 0.0, 0.0, 0.0
    if code == elementary.SINC:
        if abs(x) < 1.0:
            return elementary.sinc_series(x)
        y = math.sin(x) / x
        f1, f2, f3 = elementary.sinc_taylor(x, y, math.cos(x))
        return y, f1, f2, f3
    f1, f2, f3 = elementary.atan_taylor(x)
    return math.atan(x), f1, f2, f3


@loop
def error_of_rounding(code, order, size):
    """Return a bound of the error of a coefficient of this order whose absolute value is `size`."""
    function = code - elementary.RECIPROCAL
    roundings = elementary.ROUNDINGS[function, order] * UNIT
    return roundings * (size + elementary.CANCELLING[function])


@loop
def include(code, x, f):
    """Extend the ranges f (2, 4) of Taylor coefficients, [least, largest], by values at x."""
    found = coefficients(code, x)
    jumps = code == elementary.SIGN and x == 0.0
    if jumps or not abs(found[0]) + abs(found[1]) + abs(found[2]) + abs(found[3]) < math.inf:
        for k in range(4):
            f[0, k], f[1, k] = -math.inf, math.inf
    for k, y in enumerate(found):
        f[0, k] = min(f[0, k], y)
        f[1, k] = max(f[1, k], y)


@loop
def ranges(code, low, high, f):
    """Write midpoints and radii (2, 4) of the Taylor coefficients on an interval.

    Coefficients are monotone between their extrema, so that their values at extrema and at the ends
    of the interval bound them. Those of sinc are bounded by their values in the middle, and by
    bounds of their slopes. Radii are infinite if the function has a singularity in the interval, or
    if no bound is known.
    """
    function = code - elementary.RECIPROCAL
    for k in range(4):
        f[0, k], f[1, k] = math.inf, -math.inf
    if code == elementary.SINC:
        middle = 0.5 * low + 0.5 * high
        half = (0.5 * (high - low) + UNIT * (abs(low) + abs(high))) * (1.0 + 8.0 * UNIT)
        include(code, middle, f)
        for k in range(4):
            f[0, k] -= half * elementary.SINC_SLOPES[k]
            f[1, k] += half * elementary.SINC_SLOPES[k]
    else:
        include(code, low, f)
        include(code, high, f)
    for k in range(elementary.EXTREMES.shape[1]):
        x = elementary.EXTREMES[function, k]
        if low < x < high:
            include(code, x, f)
    if elementary.SPACING[function] > 0.0:
        if not max(abs(low), abs(high)) < FAR:
            for k in range(4):
                f[0, k], f[1, k] = -1.0, 1.0
        else:
            slack = 8.0 * UNIT * (abs(low) + abs(high))
            first = math.ceil((low - slack) / QUARTER)
            for k in range(4):
                if (first + k) * QUARTER <= high + slack:
                    include(code, (first + k) * QUARTER, f)
    for k in range(4):
        y, z = f[0, k], f[1, k]
        if math.isfinite(y) and math.isfinite(z):
            f[0, k] = 0.5 * y + 0.5 * z
            size = max(abs(y), abs(z))
            f[1, k] = (0.5 * (z - y) + 2.0 * UNIT * size) + error_of_rounding(code, k, size)
        else:
            f[0, k], f[1, k] = 0.0, math.inf
