"""Bounds of the Taylor coefficients of a tape over boxes |u − u0| <= ru, |v − v0| <= rv.

A coefficient is enclosed in a ball: a midpoint and a radius. Registers are as in `points`, with the
ten coefficients 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv; midpoints and radii have registers of
their own. Boxes are evaluated in tiles of LANES boxes, the lanes of a register.

Radii include the rounding errors of all operations; their bounds are derived with the formulas
(`symbolic/taylor.py`). The functions of the C library are assumed to be accurate to two units in
the last place.
"""

from __future__ import annotations

import numpy as np

from ....generated import elementary
from ....generated import taylor as formulas
from ....generated.vectors import CubicTaylor, Taylor
from ...machine_code.jit import jit, loop
from .functions import UNIT, ranges
from .points import LANES
from .spline_bounds import write_spline_balls

# The size of a row of registers, and the offsets of its coefficients.
BALL = np.int64(10 * LANES)
U, V, UU, UV, VV, UUU, UUV, UVV, VVV = (np.uint64(k * LANES) for k in range(1, 10))
# Radii are multiplied by INFLATION and increased by TINY: bounds of the relative rounding errors of
# radii, which are sums of fewer than 64 terms, and of underflow.
INFLATION = 1.0 + 2.0**-46
TINY = 1e-290


@loop
def cubic_at(registers, at, k):
    """Return the polynomial of lane k of the register that begins at `at`."""
    i = np.uint64(at + k)
    return CubicTaylor(
        registers[i], registers[i + U], registers[i + V],
        registers[i + UU], registers[i + UV], registers[i + VV],
        registers[i + UUU], registers[i + UUV], registers[i + UVV], registers[i + VVV],
    )  # fmt: skip


@loop
def sizes_at(registers, at, k):
    """Return the absolute values of the coefficients of lane k."""
    i = np.uint64(at + k)
    return CubicTaylor(
        abs(registers[i]), abs(registers[i + U]), abs(registers[i + V]),
        abs(registers[i + UU]), abs(registers[i + UV]), abs(registers[i + VV]),
        abs(registers[i + UUU]), abs(registers[i + UUV]),
        abs(registers[i + UVV]), abs(registers[i + VVV]),
    )  # fmt: skip


@loop
def quadratic_at(registers, at, k):
    """Return the polynomial of lane k up to degree 2."""
    i = np.uint64(at + k)
    return Taylor(
        registers[i], registers[i + U], registers[i + V],
        registers[i + UU], registers[i + UV], registers[i + VV],
    )  # fmt: skip


@loop
def quadratic_sizes_at(registers, at, k):
    """Return the absolute values of the coefficients of lane k up to degree 2."""
    i = np.uint64(at + k)
    return Taylor(
        abs(registers[i]), abs(registers[i + U]), abs(registers[i + V]),
        abs(registers[i + UU]), abs(registers[i + UV]), abs(registers[i + VV]),
    )  # fmt: skip


@loop
def put_cubic(registers, at, k, c):
    """Write the coefficients of lane k."""
    i = np.uint64(at + k)
    registers[i], registers[i + U], registers[i + V] = c[0], c[1], c[2]
    registers[i + UU], registers[i + UV], registers[i + VV] = c[3], c[4], c[5]
    registers[i + UUU], registers[i + UUV] = c[6], c[7]
    registers[i + UVV], registers[i + VVV] = c[8], c[9]


@loop
def put_quadratic(registers, at, k, c):
    """Write the coefficients of lane k up to degree 2."""
    i = np.uint64(at + k)
    registers[i], registers[i + U], registers[i + V] = c[0], c[1], c[2]
    registers[i + UU], registers[i + UV], registers[i + VV] = c[3], c[4], c[5]


@loop
def write_variables(code, numbers, centres, half_widths, terms, middles, radii, at, count):
    """Write the balls of u, v or a constant to the register that begins at `at`."""
    for j in range(terms):
        for k in range(count):
            i = np.uint64(at + j * LANES + k)
            middles[i], radii[i] = 0.0, 0.0
    for k in range(count):
        i = np.uint64(at + k)
        if code == elementary.CONSTANT:
            middles[i], radii[i] = numbers[0], numbers[1]
        else:
            middles[i], radii[i] = centres[k, code], half_widths[k, code]
            middles[i + (U if code == elementary.U else V)] = 1.0


@loop
def add(terms, middles, radii, a, b, at, count):
    """Write the sum of two registers."""
    for j in range(terms):
        for k in range(count):
            lane = j * LANES + k
            x, y, z = np.uint64(a + lane), np.uint64(b + lane), np.uint64(at + lane)
            middles[z] = middles[x] + middles[y]
            radii[z] = (radii[x] + radii[y] + UNIT * abs(middles[z])) * INFLATION


@loop
def shift(number, distance, terms, middles, radii, a, at, count):
    """Write the sum of a register and a constant."""
    for j in range(terms):
        for k in range(count):
            lane = j * LANES + k
            x, z = np.uint64(a + lane), np.uint64(at + lane)
            middles[z], radii[z] = middles[x], radii[x]
    for k in range(count):
        z = np.uint64(at + k)
        middles[z] += number
        radii[z] = (radii[z] + distance + UNIT * abs(middles[z])) * INFLATION


@loop
def scale(number, distance, terms, middles, radii, a, at, count):
    """Write the product of a register and a constant."""
    for j in range(terms):
        for k in range(count):
            lane = j * LANES + k
            x, z = np.uint64(a + lane), np.uint64(at + lane)
            size = abs(middles[x]) + radii[x]
            middles[z] = middles[x] * number
            radius = radii[x] * abs(number) + size * distance + UNIT * abs(middles[z])
            radii[z] = radius * INFLATION + TINY


@loop
def multiply(terms, middles, radii, a, b, at, count):
    """Write the product of two registers."""
    if terms == 10:
        for k in range(count):
            x, y = cubic_at(middles, a, k), cubic_at(middles, b, k)
            put_cubic(middles, at, k, formulas.product_3(x, y))
        for k in range(count):
            x, y = sizes_at(middles, a, k), sizes_at(middles, b, k)
            d, e = cubic_at(radii, a, k), cubic_at(radii, b, k)
            put_cubic(radii, at, k, formulas.product_radius_3(x, d, y, e, UNIT))
    else:
        for k in range(count):
            x, y = quadratic_at(middles, a, k), quadratic_at(middles, b, k)
            put_quadratic(middles, at, k, formulas.product_2(x, y))
        for k in range(count):
            x, y = quadratic_sizes_at(middles, a, k), quadratic_sizes_at(middles, b, k)
            d, e = quadratic_at(radii, a, k), quadratic_at(radii, b, k)
            put_quadratic(radii, at, k, formulas.product_radius_2(x, d, y, e, UNIT))
    inflate(terms, radii, at, count)


@loop
def inflate(terms, radii, at, count):
    """Increase radii by a bound of their own rounding errors."""
    for j in range(terms):
        for k in range(count):
            i = np.uint64(at + j * LANES + k)
            radii[i] = radii[i] * INFLATION + TINY


@loop
def write_ranges(code, middles, radii, a, f, ends, count):
    """Write balls of the Taylor coefficients of a function to rows of registers, from f on.

    The argument of the function is the register that begins at `a`.
    """
    for k in range(count):
        i = np.uint64(a + k)
        middle, radius = middles[i], radii[i]
        pad = 2.0 * UNIT * (abs(middle) + radius) if radius > 0.0 else 0.0
        ranges(code, middle - radius - pad, middle + radius + pad, ends)
        for j in range(4):
            z = np.uint64(f + j * LANES + k)
            middles[z], radii[z] = ends[0, j], ends[1, j]


@loop
def write_coranges(code, middles, radii, f, count):
    """Replace the Taylor coefficients of sin (or sinh) by the coefficients of cos (or cosh)."""
    for k in range(count):
        i = np.uint64(f + k)
        y, w = middles[i], middles[i + U]
        if code == elementary.SIN:
            f1, f2, f3 = elementary.cos_taylor(w, y)
        else:
            f1, f2, f3 = elementary.cosh_taylor(w, y)
        d, e = radii[i], radii[i + U]
        _, g2, g3 = elementary.cosh_taylor(e, d)
        middles[i], middles[i + U], middles[i + V], middles[i + UU] = w, f1, f2, f3
        radii[i], radii[i + U] = e, d
        radii[i + V], radii[i + UU] = g2 + 3.0 * UNIT * abs(f2), g3 + 3.0 * UNIT * abs(f3)


@loop
def compose(terms, middles, radii, a, f, at, count):
    """Apply a function to the register at `a`, and write the result to the register at `at`.

    The rows from f on have the Taylor coefficients of the function.
    """
    if terms == 10:
        for k in range(count):
            i = np.uint64(f + k)
            x = cubic_at(middles, a, k)
            c = formulas.composition_3(middles[i + U], middles[i + V], middles[i + UU], x)
            put_cubic(middles, at, k, (middles[i], *c))
        for k in range(count):
            i = np.uint64(f + k)
            x, d = sizes_at(middles, a, k), cubic_at(radii, a, k)
            c = formulas.composition_radius_3(
                abs(middles[i + U]), abs(middles[i + V]), abs(middles[i + UU]),
                radii[i + U], radii[i + V], radii[i + UU], x, d, UNIT,
            )  # fmt: skip
            put_cubic(radii, at, k, (radii[i], *c))
    else:
        for k in range(count):
            i = np.uint64(f + k)
            x = quadratic_at(middles, a, k)
            c = formulas.composition_2(middles[i + U], middles[i + V], x)
            put_quadratic(middles, at, k, (middles[i], *c))
        for k in range(count):
            i = np.uint64(f + k)
            x, d = quadratic_sizes_at(middles, a, k), quadratic_at(radii, a, k)
            c = formulas.composition_radius_2(
                abs(middles[i + U]), abs(middles[i + V]), radii[i + U], radii[i + V], x, d, UNIT
            )
            put_quadratic(radii, at, k, (radii[i], *c))
    inflate(terms, radii, at, count)


@loop
def evaluate_boxes(tape, order, centres, half_widths, count, middles, radii, ends):
    """Write the balls of all rows of a tape on `count` boxes, at most LANES.

    Centres and half widths of boxes are (k, 2). The order is 2 or 3. The arrays of registers have
    room for one row more than the tape; `ends` (2, 4) is scratch memory.
    """
    terms = 10 if order == 3 else 6
    rows = tape.operations.shape[0]
    f = BALL * rows
    for row in range(rows):
        code = tape.operations[row, 0]
        a, b = BALL * tape.operations[row, 1], BALL * tape.operations[row, 2]
        number, distance = tape.numbers[row, 0], tape.numbers[row, 1]
        at = BALL * row
        if code == elementary.PRODUCT:
            multiply(terms, middles, radii, a, b, at, count)
        elif code == elementary.SUM:
            add(terms, middles, radii, a, b, at, count)
        elif code == elementary.SCALE:
            scale(number, distance, terms, middles, radii, a, at, count)
        elif code == elementary.NEGATIVE:
            scale(-1.0, 0.0, terms, middles, radii, a, at, count)
        elif code == elementary.SHIFT:
            shift(number, distance, terms, middles, radii, a, at, count)
        elif code <= elementary.CONSTANT:
            write_variables(
                code, tape.numbers[row], centres, half_widths, terms, middles, radii, at, count
            )
        elif code == elementary.SPLINE:
            for k in range(count):
                write_spline_balls(
                    tape.spline, tape.operations[row, 3], number, distance, terms,
                    centres[k, 0], centres[k, 1], half_widths[k, 0], half_widths[k, 1],
                    middles, radii, at + k, f,
                )  # fmt: skip
        elif code > elementary.PRODUCT and code != elementary.COS and code != elementary.COSH:
            write_ranges(code, middles, radii, a, f, ends, count)
            compose(terms, middles, radii, a, f, at, count)
            if code == elementary.SIN or code == elementary.SINH:
                write_coranges(code, middles, radii, f, count)
                compose(terms, middles, radii, a, f, at + BALL, count)
    hide_unknown(tape, terms, middles, radii, count)


@loop
def hide_unknown(tape, terms, middles, radii, count):
    """Make radii of outputs infinite if they are NaN, or if their midpoints are infinite."""
    for axis in range(3):
        for j in range(terms):
            for k in range(count):
                i = np.uint64(BALL * tape.outputs[axis] + j * LANES + k)
                if not abs(middles[i]) + radii[i] < np.inf:
                    middles[i], radii[i] = 0.0, np.inf


@jit
def bounds_of_boxes(tape, order, centres, half_widths, middles, radii, ends, bounds):
    """Write midpoints and radii (k, 2, 10, 3) of the Taylor coefficients of x, y, z on boxes.

    `centres` and `half_widths` of the boxes are (k, 2).
    """
    for start in range(0, len(centres), LANES):
        count = min(LANES, len(centres) - start)
        evaluate_boxes(
            tape, order, centres[start:], half_widths[start:], count, middles, radii, ends
        )
        for axis in range(3):
            for j in range(10 if order == 3 else 6):
                for k in range(count):
                    i = np.uint64(BALL * tape.outputs[axis] + j * LANES + k)
                    bounds[start + k, 0, j, axis] = middles[i]
                    bounds[start + k, 1, j, axis] = radii[i]
