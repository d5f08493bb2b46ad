"""Bounds of the rounding errors of 2-jets that a tape computes, over boxes of parameters.

For each operation, balls enclose the exact Taylor coefficients on the box. From these follow bounds
of the errors of the coefficients that `points` computes anywhere in the box: errors of the
arguments, and rounding errors of the operation. The assumptions are those of `balls`.
"""

from __future__ import annotations

import numpy as np

from ....generated import elementary
from ....generated import taylor as formulas
from ....generated.vectors import Taylor
from ...machine_code.jit import jit, loop
from .balls import (
    BALL,
    INFLATION,
    TINY,
    UU,
    UV,
    VV,
    U,
    V,
    evaluate_boxes,
    inflate,
    put_quadratic,
    quadratic_at,
)
from .functions import UNIT, error_of_rounding, ranges
from .points import LANES
from .spline_bounds import write_spline_errors

TERMS = 6


@loop
def size_at(middles, radii, i):
    """Return the largest absolute value in a ball."""
    return abs(middles[i]) + radii[i]


@loop
def largest_at(middles, radii, at, k):
    """Return the largest absolute values of the coefficients of lane k."""
    i = np.uint64(at + k)
    return Taylor(
        size_at(middles, radii, i), size_at(middles, radii, i + U), size_at(middles, radii, i + V),
        size_at(middles, radii, i + UU), size_at(middles, radii, i + UV),
        size_at(middles, radii, i + VV),
    )  # fmt: skip


@loop
def of_sum(code, factor, distance, middles, radii, errors, a, b, at, count):
    """Write the errors of sums of two registers, and of sums and products with a constant."""
    for j in range(TERMS):
        for k in range(count):
            lane = j * LANES + k
            x, y, z = np.uint64(a + lane), np.uint64(b + lane), np.uint64(at + lane)
            size = size_at(middles, radii, z)
            if code == elementary.SUM:
                error = errors[x] + errors[y] + UNIT * size
            elif code == elementary.SHIFT:
                error = errors[x] + (distance + UNIT * size if j == 0 else 0.0)
            else:
                largest = size_at(middles, radii, x) + errors[x]
                error = abs(factor) * errors[x] + distance * largest + UNIT * size
            # UNIT * size bounds the rounding error of a result of the absolute value `size`. The
            # computed result is hardly larger than `size`.
            errors[z] = error * INFLATION + TINY


@loop
def of_product(middles, radii, errors, a, b, at, count):
    """Write the errors of products."""
    for k in range(count):
        x, y = largest_at(middles, radii, a, k), largest_at(middles, radii, b, k)
        d, e = quadratic_at(errors, a, k), quadratic_at(errors, b, k)
        put_quadratic(errors, at, k, formulas.product_radius_2(x, d, y, e, UNIT))
    inflate(TERMS, errors, at, count)


@loop
def of_coefficients(code, middles, radii, errors, a, f, ends, count):
    """Write bounds of the Taylor coefficients of a function, and of their errors, from row f on.

    Between the exact and the computed argument a coefficient changes by at most its slope, the next
    coefficient, times their difference.
    """
    for k in range(count):
        i = np.uint64(a + k)
        error = errors[i]
        reach = (radii[i] + error) * INFLATION + 2.0 * UNIT * abs(middles[i])
        ranges(code, middles[i] - reach, middles[i] + reach, ends)
        for j in range(3):
            z = np.uint64(f + j * LANES + k)
            size = abs(ends[0, j]) + ends[1, j]
            slope = (j + 1.0) * (abs(ends[0, j + 1]) + ends[1, j + 1])
            middles[z], radii[z] = size, 0.0
            errors[z] = slope * error + error_of_rounding(code, j, size)


@loop
def compose_errors(middles, radii, errors, a, f, at, count):
    """Write the errors of the value of a function whose argument is the register at `a`."""
    for k in range(count):
        i = np.uint64(f + k)
        c = formulas.composition_radius_2(
            middles[i + U], middles[i + V], errors[i + U], errors[i + V],
            largest_at(middles, radii, a, k), quadratic_at(errors, a, k), UNIT,
        )  # fmt: skip
        put_quadratic(errors, at, k, (errors[i], *c))
    inflate(TERMS, errors, at, count)


@loop
def rounding_of_points(tape, centres, half_widths, count, middles, radii, errors, ends):
    """Write bounds of the errors of all rows at points in `count` boxes, at most LANES.

    Registers of midpoints and radii are filled to order 2 as well.
    """
    evaluate_boxes(tape, 2, centres, half_widths, count, middles, radii, ends)
    rows = tape.operations.shape[0]
    f = BALL * rows
    for row in range(rows):
        code = tape.operations[row, 0]
        a, b = BALL * tape.operations[row, 1], BALL * tape.operations[row, 2]
        factor, distance = tape.numbers[row, 0], tape.numbers[row, 1]
        at = BALL * row
        if code <= elementary.CONSTANT:
            for j in range(TERMS):
                for k in range(count):
                    value = distance if code == elementary.CONSTANT and j == 0 else 0.0
                    errors[np.uint64(at + j * LANES + k)] = value
        elif code == elementary.SPLINE:
            for k in range(count):
                write_spline_errors(
                    tape.spline, tape.operations[row, 3], factor, distance,
                    centres[k, 0], centres[k, 1], half_widths[k, 0], half_widths[k, 1],
                    middles, radii, errors, at + k, f,
                )  # fmt: skip
        elif code == elementary.PRODUCT:
            of_product(middles, radii, errors, a, b, at, count)
        elif code < elementary.SPLINE:
            if code == elementary.NEGATIVE:
                factor, distance = -1.0, 0.0
            of_sum(code, factor, distance, middles, radii, errors, a, b, at, count)
        elif code > elementary.PRODUCT:
            of_coefficients(code, middles, radii, errors, a, f, ends, count)
            compose_errors(middles, radii, errors, a, f, at, count)


@jit
def rounding_of_boxes(tape, centres, half_widths, middles, radii, errors, ends, bounds):
    """Write the bounds (k, 6, 3) of the errors of 1, u, v, uu, uv, vv at points in boxes (k, 2)."""
    for start in range(0, len(centres), LANES):
        count = min(LANES, len(centres) - start)
        rounding_of_points(
            tape, centres[start:], half_widths[start:], count, middles, radii, errors, ends
        )
        for axis in range(3):
            for j in range(TERMS):
                for k in range(count):
                    i = np.uint64(BALL * tape.outputs[axis] + j * LANES + k)
                    bounds[start + k, j, axis] = errors[i] if errors[i] < np.inf else np.inf
