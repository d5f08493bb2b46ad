"""Tapes: lists of operations that compute a surface; their evaluation to 2-jets.

Points are evaluated in tiles of LANES: each operation is a loop over the lanes, which shares the
cost of interpretation. The results of operations are Taylor polynomials of degree 2 in u and v.
Each row of the tape has a register for its result: the coefficients of 1, u, v, uu, uv, vv, each
with LANES lanes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated import elementary
from ....generated import taylor as formulas
from ....generated.vectors import Taylor
from ...machine_code.jit import jit, long_vectors, loop
from .functions import LARGEST_ANGLE, coefficients, sine_and_cosine
from .splines import COORDINATES, NO_SPLINE, Polynomials, own_parameter, span_at, spline_at

LANES = 32
# The size of a row of registers, and the offsets of its coefficients.
POINT = np.int64(6 * LANES)
U, V, UU, UV, VV = (np.uint64(k * LANES) for k in range(1, 6))


class Tape(NamedTuple):
    """Three functions x, y, z of u and v, as a list of operations on results of earlier operations.

    A row of `operations` (k, 4) is a code of `generated.elementary`, the rows of the two arguments
    of the operation, and a number that only splines use. A row of `numbers` (k, 2) is the constant
    of the operation and a bound of the error of this constant. `outputs` (3,) are the rows of x, y
    and z. The operation SPLINE evaluates `spline`.
    """

    operations: NDArray[np.int64]
    numbers: NDArray[np.float64]
    outputs: NDArray[np.int64]
    spline: Polynomials = NO_SPLINE


@loop
def taylor_at(registers, at, k):
    """Return the polynomial of lane k of the register that begins at `at`."""
    i = np.uint64(at + k)
    return Taylor(
        registers[i], registers[i + U], registers[i + V],
        registers[i + UU], registers[i + UV], registers[i + VV],
    )  # fmt: skip


@loop
def put(registers, at, k, value, u, v, uu, uv, vv):
    """Write the polynomial of lane k of the register that begins at `at`."""
    i = np.uint64(at + k)
    registers[i] = value
    registers[i + U] = u
    registers[i + V] = v
    registers[i + UU] = uu
    registers[i + UV] = uv
    registers[i + VV] = vv


@loop
def write_variables(code, number, u, v, registers, at, count):
    """Write the polynomials of u, v or a constant to the register that begins at `at`."""
    for k in range(count):
        if code == elementary.U:
            put(registers, at, k, u[k], 1.0, 0.0, 0.0, 0.0, 0.0)
        elif code == elementary.V:
            put(registers, at, k, v[k], 0.0, 1.0, 0.0, 0.0, 0.0)
        else:
            put(registers, at, k, number, 0.0, 0.0, 0.0, 0.0, 0.0)


@loop
def write_spline(spline, turned, total, u, v, registers, at, count):
    """Write x, y, z and the weight of a spline to four registers, of which the first is at `at`."""
    i, j, periods = 0, 0, spline.periods
    for k in range(count):
        x = own_parameter(turned, total, u[k])
        i, s = span_at(spline.breaks_u, spline.frames_u, periods[0, 0], periods[0, 1], i, x)
        j, t = span_at(spline.breaks_v, spline.frames_v, periods[1, 0], periods[1, 1], j, v[k])
        along_u, along_v = spline.frames_u[i, 1], spline.frames_v[j, 1]
        if turned == 1:
            along_u = -along_u
        for c in range(COORDINATES):
            y, ys, yt, yss, yst, ytt = spline_at(spline, i, j, s, t, c)
            put(
                registers, at + c * POINT, k, y, ys * along_u, yt * along_v,
                yss * along_u * along_u, yst * along_u * along_v, ytt * along_v * along_v,
            )  # fmt: skip


@loop
def add(registers, a, b, at, count):
    """Write the sum of two registers."""
    for k in range(count):
        x, y = taylor_at(registers, a, k), taylor_at(registers, b, k)
        put(
            registers, at, k, x.value + y.value, x.u + y.u, x.v + y.v,
            x.uu + y.uu, x.uv + y.uv, x.vv + y.vv,
        )  # fmt: skip


@loop
def scale(registers, a, factor, at, count):
    """Write a multiple of a register."""
    for k in range(count):
        x = taylor_at(registers, a, k)
        put(
            registers, at, k, x.value * factor, x.u * factor, x.v * factor,
            x.uu * factor, x.uv * factor, x.vv * factor,
        )  # fmt: skip


@loop
def shift(registers, a, number, at, count):
    """Write the sum of a register and a number."""
    for k in range(count):
        x = taylor_at(registers, a, k)
        put(registers, at, k, x.value + number, x.u, x.v, x.uu, x.uv, x.vv)


@loop
def multiply(registers, a, b, at, count):
    """Write the product of two registers."""
    for k in range(count):
        x, y = taylor_at(registers, a, k), taylor_at(registers, b, k)
        value, u, v, uu, uv, vv = formulas.product_2(x, y)
        put(registers, at, k, value, u, v, uu, uv, vv)


@loop
def compose(registers, a, at, count):
    """Apply a function to the register at `a`, and write the result to the register at `at`.

    Before the call, the slots of 1, u and v of the register at `at` must hold the value of the
    function and its Taylor coefficients f1 and f2 at the value of the register at `a`.
    """
    for k in range(count):
        x = taylor_at(registers, a, k)
        i = np.uint64(at + k)
        value, f1, f2 = registers[i], registers[i + U], registers[i + V]
        u, v, uu, uv, vv = formulas.composition_2(f1, f2, x)
        put(registers, at, k, value, u, v, uu, uv, vv)


@loop
def write_coefficients(code, registers, a, at, count):
    """Write value and Taylor coefficients f1, f2 of a function to the slots of 1, u and v."""
    for k in range(count):
        value, f1, f2, _ = coefficients(code, registers[np.uint64(a + k)])
        i = np.uint64(at + k)
        registers[i], registers[i + U], registers[i + V] = value, f1, f2


@loop
def write_sines(registers, a, at, count):
    """Write value, f1 and f2 of the sine as `write_coefficients` does, but in vectorized loops."""
    long_vectors()
    for k in range(count):
        i = np.uint64(at + k)
        y, w = sine_and_cosine(registers[np.uint64(a + k)])
        f1, f2, _ = elementary.sin_taylor(y, w)
        registers[i], registers[i + U], registers[i + V] = y, f1, f2
    for k in range(count):
        i, x = np.uint64(at + k), registers[np.uint64(a + k)]
        if not abs(x) < LARGEST_ANGLE:
            y, w = math.sin(x), math.cos(x)
            f1, f2, _ = elementary.sin_taylor(y, w)
            registers[i], registers[i + U], registers[i + V] = y, f1, f2


@loop
def write_cofunction(code, registers, at, count):
    """Write value, f1 and f2 of cos (or cosh) to the register that follows sin (or sinh)."""
    for k in range(count):
        i, j = np.uint64(at + k), np.uint64(at + POINT + k)
        sine, cosine = registers[i], registers[i + U]
        if code == elementary.SIN:
            f1, f2, _ = elementary.cos_taylor(cosine, sine)
        else:
            f1, f2, _ = elementary.cosh_taylor(cosine, sine)
        registers[j], registers[j + U], registers[j + V] = cosine, f1, f2


@loop
def evaluate_points(tape, u, v, count, registers):
    """Write the registers of all rows of a tape for `count` points u, v, at most LANES."""
    for row in range(tape.operations.shape[0]):
        code = tape.operations[row, 0]
        a, b = POINT * tape.operations[row, 1], POINT * tape.operations[row, 2]
        at = POINT * row
        if code == elementary.PRODUCT:
            multiply(registers, a, b, at, count)
        elif code == elementary.SUM:
            add(registers, a, b, at, count)
        elif code == elementary.SCALE:
            scale(registers, a, tape.numbers[row, 0], at, count)
        elif code == elementary.SHIFT:
            shift(registers, a, tape.numbers[row, 0], at, count)
        elif code == elementary.NEGATIVE:
            scale(registers, a, -1.0, at, count)
        elif code <= elementary.CONSTANT:
            write_variables(code, tape.numbers[row, 0], u, v, registers, at, count)
        elif code == elementary.SPLINE:
            write_spline(
                tape.spline,
                tape.operations[row, 3],
                tape.numbers[row, 0],
                u,
                v,
                registers,
                at,
                count,
            )
        elif code > elementary.PRODUCT and code != elementary.COS and code != elementary.COSH:
            if code == elementary.SIN:
                write_sines(registers, a, at, count)
            else:
                write_coefficients(code, registers, a, at, count)
            if code == elementary.SIN or code == elementary.SINH:
                write_cofunction(code, registers, at, count)
                compose(registers, a, at + POINT, count)
            compose(registers, a, at, count)


@jit
def points_jets(tape, u, v, registers, jets):
    """Write x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) at u (k,) and v (k,)."""
    for start in range(0, len(u), LANES):
        count = min(LANES, len(u) - start)
        evaluate_points(tape, u[start:], v[start:], count, registers)
        for axis in range(3):
            at = POINT * tape.outputs[axis]
            for k in range(count):
                x = taylor_at(registers, at, k)
                i = np.uint64(start + k)
                jets[i, 0, axis], jets[i, 1, axis], jets[i, 2, axis] = x.value, x.u, x.v
                jets[i, 3, axis], jets[i, 5, axis] = 2.0 * x.uu, 2.0 * x.vv
                jets[i, 4, axis] = x.uv
