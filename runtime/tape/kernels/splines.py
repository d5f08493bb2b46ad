"""The polynomials of a spline, an operation of tapes that writes four rows: x, y, z and a weight.

On each pair of knot spans, coordinates are polynomials in s and t, the differences of u and v from
the middles of the spans, times powers of two so that they are between −1 and 1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...machine_code.jit import loop
from .nurbs import in_period, span_of

COORDINATES = 4  # rows of a tape: x, y, z and a weight
MOST_COEFFICIENTS = 160  # of one polynomial, which fit into registers


class Polynomials(NamedTuple):
    """The polynomials of a spline.

    For u and for v, `breaks` (k + 1,) are the ends of the k spans, `smooth` (k + 1,) the numbers of
    continuous derivatives at these ends, and `frames` (k, 2) the middle m and the factor f of each
    span: s = (u − m) f, t likewise. `periods` (2, 2) has a row for u and a row for v: the lower end
    and the length of the period; the length is 0 if there is no period. `coefficients`
    (k, l, p + 1, q + 1, 4) belong to powers of s and t; `errors` are bounds of their errors.
    """

    breaks_u: NDArray[np.float64]
    breaks_v: NDArray[np.float64]
    smooth_u: NDArray[np.int64]
    smooth_v: NDArray[np.int64]
    frames_u: NDArray[np.float64]
    frames_v: NDArray[np.float64]
    periods: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    errors: NDArray[np.float64]


NO_SPLINE = Polynomials(
    np.empty(0),
    np.empty(0),
    np.empty(0, dtype=np.int64),
    np.empty(0, dtype=np.int64),
    np.empty((0, 2)),
    np.empty((0, 2)),
    np.zeros((2, 2)),
    np.empty((0, 0, 0, 0, 0)),
    np.empty((0, 0, 0, 0, 0)),
)


@loop
def own_parameter(turned, total, u):
    """Return the parameter of the spline: u, or total − u where u is reversed."""
    return total - u if turned == 1 else u


@loop
def span_at(breaks, frames, low, period, near, x):
    """Return the span that contains a parameter, or the nearest one, and the parameter s in it."""
    x = in_period(x, low, period)
    i = span_of(breaks, 0, len(breaks) - 2, near, x)
    return i, (x - frames[i, 0]) * frames[i, 1]


@loop
def spline_at(spline, i, j, s, t, c):
    """Return the Taylor coefficients 1, s, t, ss, st, tt of a coordinate by Horner's scheme."""
    f, fs, ft, fss, fst, ftt = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    table = spline.coefficients
    for a in range(table.shape[2] - 1, -1, -1):
        y, y1, y2 = 0.0, 0.0, 0.0
        for b in range(table.shape[3] - 1, -1, -1):
            y2 = y2 * t + y1
            y1 = y1 * t + y
            y = y * t + table[i, j, a, b, c]
        fss = fss * s + fs
        fs = fs * s + f
        f = f * s + y
        fst = fst * s + ft
        ft = ft * s + y1
        ftt = ftt * s + y2
    return f, fs, ft, fss, fst, ftt
