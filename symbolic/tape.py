"""Tapes: three expressions in u and v as a list of operations, each on results of earlier ones.

A tape is interpreted: with numbers it gives points, with Taylor polynomials derivatives, with
intervals bounds of these. Operations and their codes are those of `taylor.CODES`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, cast

import sympy as sp

from .taylor import CODES, FUNCTIONS

__all__ = ["NoTapeError", "TapeRows", "tape_rows"]

DIGITS = 40  # of constants, before they are rounded
SLACK = sp.Rational(1001, 1000)  # more than the rounding of a radius
# Functions by others; cos and cosh are in the rows after sin and sinh.
REWRITTEN: Mapping[Any, Callable[[Any], sp.Expr]] = {
    sp.cot: lambda x: sp.cos(x) / sp.sin(x),
    sp.sec: lambda x: 1 / sp.cos(x),
    sp.csc: lambda x: 1 / sp.sin(x),
    sp.coth: lambda x: 1 / sp.tanh(x),
    sp.sech: lambda x: 1 / sp.cosh(x),
    sp.csch: lambda x: 1 / sp.sinh(x),
    sp.acos: lambda x: sp.pi / 2 - sp.asin(x),
    sp.acot: lambda x: sp.atan(1 / x),
    sp.asinh: lambda x: sp.log(x + sp.sqrt(x**2 + 1)),
    sp.acosh: lambda x: sp.log(x + sp.sqrt(x**2 - 1)),
    sp.atanh: lambda x: sp.log((1 + x) / (1 - x)) / 2,
}


class NoTapeError(ValueError):
    """An expression holds what no operation of a tape computes; the message says what."""


class TapeRows(NamedTuple):
    """A tape as numbers.

    Operations (k, 4) are a code, two rows or the number of a parameter, and 0. Numbers (k, 2) are
    values of constants, and how far the exact ones may be from them. Outputs are the rows of the
    coordinates.
    """

    operations: list[tuple[int, int, int, int]]
    numbers: list[tuple[float, float]]
    outputs: list[int]


def tape_rows(
    position: Sequence[sp.Expr], u: sp.Symbol, v: sp.Symbol, parameters: Sequence[sp.Symbol] = ()
) -> TapeRows:
    """Return the tape of expressions in u, v and parameters, whose values are filled in later.

    Raises NoTapeError if there is none.
    """
    symbols = sp.numbered_symbols("t", cls=sp.Dummy, real=True)
    shared, outputs = cast(
        tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]],
        sp.cse(list(position), symbols=symbols, order="canonical"),
    )
    writer = _Writer(dict(shared))
    writer.declare(u, "u")
    writer.declare(v, "v")
    for number, parameter in enumerate(parameters):
        writer.declare(parameter, "parameter", number)
    rows = [writer.row_of(x) for x in outputs]
    return TapeRows(writer.operations, writer.numbers, rows)


class _Writer:
    """Writes the operations of expressions; what is there already is not written again."""

    def __init__(self, shared: Mapping[sp.Symbol, sp.Expr]) -> None:
        self.operations: list[tuple[int, int, int, int]] = []
        self.numbers: list[tuple[float, float]] = []
        self._shared = shared
        self._rows: dict[sp.Expr, int] = {}
        self._written: dict[object, int] = {}

    def declare(self, symbol: sp.Symbol, name: str, number: int = 0) -> None:
        """Write the operation that gives the value of a symbol."""
        self._rows[symbol] = self._write(name, number)

    def row_of(self, expression: sp.Expr) -> int:
        """Return the row of an expression, after its operations are written."""
        if expression not in self._rows:
            self._rows[expression] = self._row_of(expression)
        return self._rows[expression]

    def _row_of(self, expression: sp.Expr) -> int:
        if expression in self._shared:
            return self.row_of(self._shared[cast(sp.Symbol, expression)])
        if expression.is_number:
            return self._constant(expression)
        if expression.is_Add:
            return self._folded("sum", expression.args)
        if expression.is_Mul:
            return self._product(cast(sp.Mul, expression))
        if expression.is_Pow:
            return self._power(cast(sp.Pow, expression))
        return self._function(expression)

    def _constant(self, expression: sp.Expr) -> int:
        value = expression if expression.is_Rational else expression.evalf(DIGITS)
        if not (value.is_Float or value.is_Rational) or not value.is_finite:
            raise NoTapeError(f"{expression} is no real number")
        middle = float(value)
        distance = abs(sp.Rational(value) - sp.Rational(middle))
        return self._write("constant", number=(middle, float(distance * SLACK)))

    def _product(self, expression: sp.Mul) -> int:
        number, rest = expression.as_coeff_Mul()
        if number == -1:
            return self._write("negative", self.row_of(rest))
        return self._folded("product", expression.args)

    def _power(self, power: sp.Pow) -> int:
        base, exponent = power.args
        if not (2 * exponent).is_Integer:  # of positive numbers
            return self._write(
                "exp", self._write("product", self.row_of(exponent), self._log(base))
            )
        row = self.row_of(base)
        if exponent.is_negative:
            row = self._write("reciprocal", row)
        size = abs(exponent)
        if not size.is_Integer:
            row, size = self._write("sqrt", row), 2 * size
        return self._whole_power(row, int(size))

    def _log(self, expression: sp.Expr) -> int:
        return self._write("log", self.row_of(expression))

    def _whole_power(self, row: int, exponent: int) -> int:
        if exponent == 1:
            return row
        if exponent % 2 == 0:
            return self._write("square", self._whole_power(row, exponent // 2))
        if exponent % 3 == 0:
            return self._write("cube", self._whole_power(row, exponent // 3))
        return self._write("product", self._whole_power(row, exponent - 1), row)

    def _function(self, expression: sp.Expr) -> int:
        kind = expression.func
        if kind in REWRITTEN:
            return self.row_of(REWRITTEN[kind](*expression.args))
        for name, function in FUNCTIONS.items():
            if function.of.func == kind:
                return self._applied(name, self.row_of(cast(sp.Expr, expression.args[0])))
        raise NoTapeError(f"a tape has no {kind.__name__}")

    def _applied(self, name: str, row: int) -> int:
        """Return the row of a function of a row; sin and cos are neighbours, as sinh and cosh."""
        first = {"cos": "sin", "cosh": "sinh"}.get(name, name)
        found = self._write(first, row)
        if first in ("sin", "sinh"):
            second = self._write({"sin": "cos", "sinh": "cosh"}[first], row)
            return second if name != first else found
        return found

    def _folded(self, name: str, parts: Sequence[sp.Basic]) -> int:
        row, *rest = (self.row_of(cast(sp.Expr, x)) for x in parts)
        for other in rest:
            row = self._write(name, row, other)
        return row

    def _write(
        self, name: str, a: int = 0, b: int = 0, number: tuple[float, float] = (0.0, 0.0)
    ) -> int:
        """Return the row of an operation, which is written unless it is there."""
        operation = CODES[name], a, b, 0
        row = self._written.setdefault((operation, number), len(self.operations))
        if row == len(self.operations):
            self.operations.append(operation)
            self.numbers.append(number)
        return row
