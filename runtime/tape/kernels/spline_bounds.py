"""Bounds of the polynomials of a spline over boxes, for `balls` and `rounding`.

A polynomial is expanded at the centre s, t of a box. Over the box, a coefficient of the expansion
changes by at most its terms of higher order, with the absolute values of their coefficients, and
half the widths of the box as variables. Expansions with absolute values also bound rounding errors.

A box may contain knots. A derivative that is unbounded there has an infinite radius.
"""

from __future__ import annotations

import math

import numpy as np

from ...machine_code.jit import loop
from .functions import UNIT
from .nurbs import in_period, span_of
from .points import LANES
from .splines import COORDINATES, MOST_COEFFICIENTS, own_parameter

# The orders in u, and in v, of the ten Taylor coefficients.
IN_U = np.array([0, 1, 0, 2, 1, 0, 3, 2, 1, 0])
IN_V = np.array([0, 0, 1, 0, 1, 2, 0, 1, 2, 3])
SECOND = np.int64(MOST_COEFFICIENTS)  # the offset of the second polynomial of an array
# A bound of a box counts as a knot if it is within this distance of the knot, relative to the
# largest knots.
SLACK = 8.0 * UNIT


@loop
def shift_polynomial(d, at, p, q, s, t):
    """Expand a polynomial at s, t, in place: its coefficients are `d`, from the index `at` on."""
    for a in range(p + 1):
        row = at + a * (q + 1)
        for k in range(q):
            for b in range(q - 1, k - 1, -1):
                d[row + b] += d[row + b + 1] * t
    for b in range(q + 1):
        for k in range(p):
            for a in range(p - 1, k - 1, -1):
                d[at + a * (q + 1) + b] += d[at + (a + 1) * (q + 1) + b] * s


@loop
def spans_of(breaks, low_end, period, low, high):
    """Return the first and the last span that an interval intersects, and a number of periods.

    The lower end of the interval is outside the first period by this number of whole periods.
    Indices of spans continue into the next period.
    """
    slack = SLACK * (abs(breaks[0]) + abs(breaks[-1]))
    last = len(breaks) - 2
    if not period > 0.0:
        first = span_of(breaks, 0, last, 0, low + slack)
        return first, max(first, span_of(breaks, 0, last, 0, high - slack)), 0.0
    x = in_period(low + slack, low_end, period)
    turns = np.rint((low + slack - x) / period)
    first = span_of(breaks, 0, last, 0, x)
    end = first
    while end_of(breaks, period, end) + turns * period < high - slack and end < first + last + 1:
        end += 1
    return first, end, turns


@loop
def end_of(breaks, period, i):
    """Return the upper end of span i, which may be in a later period."""
    spans = len(breaks) - 1
    return breaks[i % spans + 1] + (i // spans) * period


@loop
def part_in(breaks, frames, period, turns, first, last, i, u, half_width):
    """Return centre and half width of the part of an interval in span i, and their error.

    All three are in the unit of the span.
    """
    spans = len(breaks) - 1
    offset = (turns + i // spans) * period
    centre, half = u, half_width
    if first != last:
        low, high = u - half_width, u + half_width
        if i > first:
            low = max(low, breaks[i % spans] + offset)
        if i < last:
            high = min(high, breaks[i % spans + 1] + offset)
        centre, half = 0.5 * (low + high), max(0.5 * (high - low), 0.0)
    s = (centre - offset) - frames[i % spans, 0]
    error = UNIT * (abs(s) + half)
    if offset != 0.0 or first != last:
        error += 4.0 * UNIT * (abs(u) + half_width + abs(offset))
    scale = frames[i % spans, 1]
    return s * scale, half * scale, error * scale


@loop
def least_smooth(smooth, first, last):
    """Return the number of derivatives that are continuous at all knots between two spans."""
    spans, least = len(smooth) - 1, 1000
    for i in range(first, last):
        least = min(least, smooth[(i + 1) % spans])
    return least


@loop
def expand(spline, i, j, c, s, t, middles, radii, at):
    """Expand a polynomial at s, t.

    From `at` on, `middles` receives the coefficients of the expansion; from `at` + SECOND on, those
    of the expansion at |s|, |t| of the polynomial with the absolute values of the coefficients.
    `radii` receives bounds of the errors of the expansion that result from the errors of the
    coefficients.
    """
    table, errors = spline.coefficients, spline.errors
    p, q = table.shape[2] - 1, table.shape[3] - 1
    for a in range(p + 1):
        for b in range(q + 1):
            k = at + a * (q + 1) + b
            middles[k] = table[i, j, a, b, c]
            middles[k + SECOND] = abs(table[i, j, a, b, c])
            radii[k] = errors[i, j, a, b, c]
    shift_polynomial(middles, at, p, q, s, t)
    shift_polynomial(middles, at + SECOND, p, q, abs(s), abs(t))
    shift_polynomial(radii, at, p, q, abs(s), abs(t))


@loop
def include_balls(spline, i, j, c, s, t, half_s, half_t, terms, middles, radii, at, scratch):
    """Extend the ranges of Taylor coefficients so that they hold the coefficients on spans i, j.

    The ranges are those of coefficients with respect to u and v: their lower ends are in `middles`,
    their upper ends in `radii`, in the lane at `at`.
    """
    p, q = spline.coefficients.shape[2] - 1, spline.coefficients.shape[3] - 1
    along_u, along_v = spline.frames_u[i, 1], spline.frames_v[j, 1]
    rounding = (2.0 * (p + q) + 2.0) * UNIT
    expand(spline, i, j, c, s, t, middles, radii, scratch)
    sizes = scratch + SECOND
    for k in range((p + 1) * (q + 1)):
        own = rounding * middles[sizes + k] + radii[scratch + k]
        radii[sizes + k] = abs(middles[scratch + k]) + own
    shift_polynomial(radii, sizes, p, q, half_s, half_t)
    for k in range(terms):
        a, b = IN_U[k], IN_V[k]
        middle, radius = 0.0, 0.0
        if a <= p and b <= q:
            entry = a * (q + 1) + b
            middle = middles[scratch + entry]
            largest = radii[sizes + entry]
            radius = (largest - abs(middle)) + 2.0 * rounding * largest
        factor = along_u**a * along_v**b
        z = np.uint64(at + k * LANES)
        middles[z] = min(middles[z], (middle - radius) * factor)
        radii[z] = max(radii[z], (middle + radius) * factor)


@loop
def write_spline_balls(
    spline, turned, number, distance, terms, u, v, half_u, half_v, middles, radii, at, scratch
):
    """Write midpoints and radii of the coordinates of a spline on a box to the lane at `at`.

    The registers have room for polynomials from `scratch` on.
    """
    x = own_parameter(turned, number, u)
    if turned == 1:
        half_u += distance + 2.0 * UNIT * (abs(u) + abs(number))
    periods, breaks_u, breaks_v = spline.periods, spline.breaks_u, spline.breaks_v
    i0, i1, turns_u = spans_of(breaks_u, periods[0, 0], periods[0, 1], x - half_u, x + half_u)
    j0, j1, turns_v = spans_of(breaks_v, periods[1, 0], periods[1, 1], v - half_v, v + half_v)
    smooth_u, smooth_v = (
        least_smooth(spline.smooth_u, i0, i1),
        least_smooth(spline.smooth_v, j0, j1),
    )
    for c in range(COORDINATES):
        row = at + c * 10 * LANES
        for k in range(terms):
            z = np.uint64(row + k * LANES)
            middles[z], radii[z] = math.inf, -math.inf
        for i in range(i0, i1 + 1):
            s, half_s, error_s = part_in(
                breaks_u, spline.frames_u, periods[0, 1], turns_u, i0, i1, i, x, half_u
            )
            for j in range(j0, j1 + 1):
                t, half_t, error_t = part_in(
                    breaks_v, spline.frames_v, periods[1, 1], turns_v, j0, j1, j, v, half_v
                )
                include_balls(
                    spline, i % (len(breaks_u) - 1), j % (len(breaks_v) - 1), c, s, t,
                    half_s + error_s, half_t + error_t, terms, middles, radii, row, scratch,
                )  # fmt: skip
        for k in range(terms):
            z = np.uint64(row + k * LANES)
            low, high = middles[z], radii[z]
            middles[z] = 0.5 * (low + high)
            radii[z] = 0.5 * (high - low) + 2.0 * UNIT * (abs(low) + abs(high))
            if IN_U[k] >= smooth_u + 2 or IN_V[k] >= smooth_v + 2:
                middles[z], radii[z] = 0.0, math.inf
            if turned == 1 and IN_U[k] % 2 == 1:
                middles[z] = -middles[z]


@loop
def write_spline_errors(
    spline, turned, number, distance, u, v, half_u, half_v, middles, radii, errors, at, scratch
):
    """Write bounds of the errors of the coordinates of a spline at points of a box.

    The error of the parameters s, t in a span is included: it is multiplied by the slopes of the
    coefficients.
    """
    x = own_parameter(turned, number, u)
    if turned == 1:
        half_u += distance + 2.0 * UNIT * (abs(u) + abs(number))
    periods, breaks_u, breaks_v = spline.periods, spline.breaks_u, spline.breaks_v
    p, q = spline.coefficients.shape[2] - 1, spline.coefficients.shape[3] - 1
    rounding = (2.0 * (p + q) + 8.0) * UNIT
    i0, i1, turns_u = spans_of(breaks_u, periods[0, 0], periods[0, 1], x - half_u, x + half_u)
    j0, j1, turns_v = spans_of(breaks_v, periods[1, 0], periods[1, 1], v - half_v, v + half_v)
    for c in range(COORDINATES):
        for k in range(6):
            errors[np.uint64(at + (c * 10 + k) * LANES)] = 0.0
    moved_u = 4.0 * UNIT * (abs(x) + half_u) if turned == 1 or periods[0, 1] > 0.0 else 0.0
    moved_v = 4.0 * UNIT * (abs(v) + half_v) if periods[1, 1] > 0.0 else 0.0
    if turned == 1:
        moved_u += distance + 2.0 * UNIT * (abs(u) + abs(number))
    for i in range(i0, i1 + 1):
        s, half_s, error_s = part_in(
            breaks_u, spline.frames_u, periods[0, 1], turns_u, i0, i1, i, x, half_u
        )
        own_i = i % (len(breaks_u) - 1)
        for j in range(j0, j1 + 1):
            t, half_t, error_t = part_in(
                breaks_v, spline.frames_v, periods[1, 1], turns_v, j0, j1, j, v, half_v
            )
            own_j = j % (len(breaks_v) - 1)
            along_u, along_v = spline.frames_u[own_i, 1], spline.frames_v[own_j, 1]
            s_error = error_s + moved_u * along_u
            t_error = error_t + moved_v * along_v
            for c in range(COORDINATES):
                expand(
                    spline, own_i, own_j, c, abs(s) + half_s + error_s, abs(t) + half_t + error_t,
                    middles, radii, scratch,
                )  # fmt: skip
                for k in range(6):
                    a, b = IN_U[k], IN_V[k]
                    if a > p or b > q:
                        continue
                    entry = scratch + a * (q + 1) + b
                    error = rounding * middles[entry + SECOND] + radii[entry]
                    if a < p:
                        error += (a + 1) * s_error * middles[entry + SECOND + q + 1]
                    if b < q:
                        error += (b + 1) * t_error * middles[entry + SECOND + 1]
                    z = np.uint64(at + (c * 10 + k) * LANES)
                    errors[z] = max(errors[z], error * along_u**a * along_v**b)
