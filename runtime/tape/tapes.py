"""Tapes of surfaces: the operations that compute x(u,v), for bounds of its derivatives."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...generated import elementary as codes
from ..base.aliases import Array
from ..domain.domain import Interval
from .kernels.balls import BALL, bounds_of_boxes
from .kernels.points import POINT, Tape, points_jets
from .kernels.rounding import rounding_of_boxes
from .kernels.splines import COORDINATES, NO_SPLINE, Polynomials

Number = tuple[float, float]  # a value, and a bound of its error
LEAVES = (codes.U, codes.V, codes.CONSTANT, codes.SPLINE, codes.COORDINATE)
BINARY = (codes.SUM, codes.PRODUCT)
NEUTRAL = {codes.SHIFT: (0.0, 0.0), codes.SCALE: (1.0, 0.0)}  # exact numbers that change nothing
# Pairs of functions that are computed together, in consecutive rows.
PAIRS = {codes.COS: codes.SIN, codes.COSH: codes.SINH}


class TapeWriter:
    """A builder of tapes that writes each operation once."""

    def __init__(self) -> None:
        self._operations: list[tuple[int, int, int, int]] = []
        self._numbers: list[tuple[float, float]] = []
        self._rows: dict[object, int] = {}
        self._spline = NO_SPLINE

    def write(self, name: str, *arguments: int) -> int:
        """Return the index of the row of an operation, appending the row if it is new.

        `name` is the name of the operation in `generated.elementary`; `arguments` are the rows of
        its arguments.
        """
        code: int = getattr(codes, name.upper())
        first = PAIRS.get(code, code)
        a, b = (*arguments, 0, 0)[:2]
        row = self.row(first, a, b)
        for second in (x for x, y in PAIRS.items() if y == first):
            other = self.row(second, a, b)
            row = row if code == first else other
        return row

    def constant(self, value: float, distance: float = 0.0) -> int:
        """Return the row of a constant `value` with an error of at most `distance`."""
        return self.row(codes.CONSTANT, number=(value, distance))

    def spline(self, polynomials: Polynomials, turned: int = 0, number: Number = (0.0, 0.0)) -> int:
        """Write a spline as four rows, its x, y, z and weight, and return the first row.

        If `turned`, the spline is evaluated at total − u in place of u; `number` is the total and
        a bound of its error.
        """
        self._spline = polynomials
        row = self.row(codes.SPLINE, last=turned, number=number)
        for coordinate in range(1, COORDINATES):
            self.row(codes.COORDINATE, last=coordinate)
        return row

    def power(self, row: int, halves: int) -> int:
        """Return the row of a power of `row`; its exponent `halves` / 2 is not 0."""
        if halves < 0:
            return self.power(self.write("reciprocal", row), -halves)
        if halves % 2:
            return self._whole_power(self.write("sqrt", row), halves)
        return self._whole_power(row, halves // 2)

    def _whole_power(self, row: int, exponent: int) -> int:
        if exponent == 1:
            return row
        if exponent % 2 == 0:
            return self.write("square", self._whole_power(row, exponent // 2))
        if exponent % 3 == 0:
            return self.write("cube", self._whole_power(row, exponent // 3))
        return self.write("product", self._whole_power(row, exponent - 1), row)

    def replay(self, tape: Tape, total: Number | None = None) -> list[int]:
        """Write the operations of another tape, and return the rows of its outputs.

        If `total` is given, total − u takes the place of u.
        """
        rows: list[int] = []
        self._spline = tape.spline
        for (code, a, b, last), number in zip(
            tape.operations.tolist(), map(tuple, tape.numbers.tolist()), strict=True
        ):
            if code == codes.U and total is not None:
                rows.append(
                    self.write(
                        "sum", self.write("negative", self.write("u")), self.constant(*total)
                    )
                )
            elif code == codes.SPLINE and total is not None:
                rows.append(self.row(code, last=1, number=total))
            elif code in LEAVES:
                rows.append(self.row(code, last=last, number=number))
            else:
                other = rows[b] if code in BINARY else 0
                rows.append(self.row(code, rows[a], other, number=number))
        return [rows[x] for x in tape.outputs]

    def tape(self, outputs: Sequence[int]) -> Tape | None:
        """Return the tape with three rows as outputs; None if a constant in it is not finite."""
        tape = Tape(
            np.array(self._operations, dtype=np.int64),
            np.array(self._numbers),
            np.array(outputs, dtype=np.int64),
            self._spline,
        )
        return _folded(tape)

    def row(
        self, code: int, a: int = 0, b: int = 0, last: int = 0, number: Number = (0.0, 0.0)
    ) -> int:
        """Return the index of the row with the given entries, appending the row if it is new.

        The entries are those of `Tape.operations` and `Tape.numbers`.
        """
        operation = code, a, b, last
        row = self._rows.setdefault((operation, number), len(self._operations))
        if row == len(self._operations):
            self._operations.append(operation)
            self._numbers.append(number)
        return row


def tape_of_steps(
    steps: Sequence[tuple[Any, ...]], outputs: Sequence[int], values: Mapping[str, float]
) -> Tape | None:
    """Return the tape of steps that `symbolic.tape` has made; `values` are its parameters."""
    writer, rows = TapeWriter(), []
    for name, *arguments in steps:
        if name == "constant":
            row = writer.constant(*arguments)
        elif name == "parameter":
            row = writer.constant(values[arguments[0]])
        elif name == "power":
            row = writer.power(rows[arguments[0]], arguments[1])
        else:
            row = writer.write(name, *(rows[x] for x in arguments))
        rows.append(row)
    return writer.tape([rows[x] for x in outputs])


def moved_tape(tape: Tape, matrix: Array, shift: Array, ends: Interval | None) -> Tape | None:
    """Return the tape of matrix x + shift, where `tape` computes x.

    If `ends` is given, an interval of u, u is also reversed in this interval.
    """
    writer, total = TapeWriter(), None
    if ends is not None:
        total = sum(ends), float(abs(sum(map(Fraction, ends)) - Fraction(sum(ends))))
    position = writer.replay(tape, total)
    outputs = []
    for factors, number in zip(matrix.tolist(), shift.tolist(), strict=True):
        row = writer.constant(number)
        for factor, x in zip(factors, position, strict=True):
            if factor != 0.0:
                row = writer.write("sum", row, writer.write("product", writer.constant(factor), x))
        outputs.append(row)
    return writer.tape(outputs)


def _folded(tape: Tape) -> Tape | None:
    """Return a tape with constant operations evaluated, and without unused rows.

    Returns None if one of its numbers is not finite.
    """
    constant = _constant_rows(tape)
    numbers = np.where(constant[:, None], _values(tape), tape.numbers)
    if not np.isfinite(numbers).all():
        return None
    operations = tape.operations.copy()
    same = np.arange(len(operations))  # for each row, the row with the same values
    for row in range(len(operations)):
        operations[row, 1:3] = same[operations[row, 1:3]]
        code, a, b, _ = operations[row]
        if constant[row]:
            operations[row] = codes.CONSTANT, 0, 0, 0
        elif code in BINARY and (constant[a] or constant[b]):
            variable, number = (b, a) if constant[a] else (a, b)
            kind = codes.SHIFT if code == codes.SUM else codes.SCALE
            operations[row], numbers[row] = (kind, variable, 0, 0), numbers[number]
            if tuple(numbers[number]) == NEUTRAL[kind]:
                same[row] = variable
    return _needed(
        tape._replace(operations=operations, numbers=numbers, outputs=same[tape.outputs])
    )


def _constant_rows(tape: Tape) -> NDArray[np.bool_]:
    """Return a mask (k,) of the rows that depend on neither u nor v."""
    constant = np.zeros(len(tape.operations), dtype=np.bool_)
    for row, (code, a, b, _) in enumerate(tape.operations):
        constant[row] = code == codes.CONSTANT or (
            code not in LEAVES and constant[a] and (code not in BINARY or constant[b])
        )
    return constant


def bounds_over_boxes(tape: Tape, centres: Array, half_widths: Array, order: int = 2) -> Array:
    """Return bounds of the Taylor coefficients of x(u,v), up to an order, over boxes.

    Boxes are given by `centres` (k, 2) and `half_widths` (k, 2). The result (k, 2, 10, 3) has the
    midpoint and the radius of each of 10 coefficients of x, y, z. With order 2, only the first six
    are defined.
    """
    middles, radii = np.empty((2, BALL * (len(tape.operations) + 1)))
    bounds = np.empty((len(centres), 2, 10, 3))
    centres, half_widths = np.array(centres, order="C"), np.array(half_widths, order="C")
    ends = np.empty((2, 4))
    bounds_of_boxes(tape, order, centres, half_widths, middles, radii, ends, bounds)
    return bounds


def _values(tape: Tape) -> Array:
    """Return midpoints and radii (k, 2) of the values of all rows at u = v = 0."""
    middles, radii = np.empty((2, BALL * (len(tape.operations) + 1)))
    place = np.zeros((1, 2))
    bounds = np.empty((1, 2, 10, 3))
    bounds_of_boxes(tape, 2, place, place, middles, radii, np.empty((2, 4)), bounds)
    first = slice(0, -int(BALL), int(BALL))  # the first lane of each row
    return np.stack([middles[first], radii[first]], axis=1)


def _needed(tape: Tape) -> Tape:
    """Return a tape without the rows that its outputs do not need."""
    operations = tape.operations.copy()
    needed = np.zeros(len(operations), dtype=np.bool_)
    needed[tape.outputs] = True
    for row in range(len(operations) - 1, -1, -1):
        code, a, b, _ = operations[row]
        if code in PAIRS and needed[row]:
            needed[row - 1] = True
        if code in PAIRS.values():
            needed[row + 1] = needed[row] = needed[row] or needed[row + 1]
        if code == codes.COORDINATE and needed[row]:
            needed[row - 1] = True
        if code == codes.SPLINE:
            needed[row : row + COORDINATES] = needed[row]
        if needed[row] and code not in LEAVES:
            needed[a] = True
            needed[b] |= code in BINARY
    new = np.maximum(np.cumsum(needed) - 1, 0)
    operations[:, 1:3] = new[operations[:, 1:3]]
    operations[np.isin(operations[:, 0], LEAVES), 1:3] = 0
    return tape._replace(
        operations=operations[needed].copy(),
        numbers=tape.numbers[needed].copy(),
        outputs=new[tape.outputs],
    )


def jets_of(tape: Tape, u: Array, v: Array) -> Array:
    """Return x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) at u (k,) and v (k,)."""
    jets = np.empty((len(u), 6, 3))
    u, v = np.array(u), np.array(v)  # Kernels would be compiled anew for other memory layouts
    points_jets(tape, u, v, np.empty(POINT * len(tape.operations)), jets)
    return jets


def values_of(tape: Tape, u: Array, v: Array) -> tuple[Array, Array]:
    """Return the points (k, 3) of a tape, and bounds (k, 3) of their rounding errors."""
    places, errors = np.stack([u, v], axis=1), np.empty((len(u), 6, 3))
    middles, radii, changes = np.empty((3, BALL * (len(tape.operations) + 1)))
    points = np.zeros_like(places)
    rounding_of_boxes(tape, places, points, middles, radii, changes, np.empty((2, 4)), errors)
    return jets_of(tape, u, v)[:, 0], errors[:, 0]
