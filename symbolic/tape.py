"""Tapes: three expressions in u and v as a list of steps, each with results of earlier steps.

Evaluated with numbers, a tape gives points; with Taylor polynomials, derivatives; with intervals,
bounds. The interpreters are in `runtime/tape/kernels/`, such as `points.py`.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

import sympy as sp

from .elementary import FUNCTIONS
from .reading import is_long, parts, replaced, with_shared_parts

# The name of an operation and its arguments: in general indices of steps; for "constant" a value
# and a bound of its error; for "parameter" a name; for "power" the index of a step and twice the
# exponent.
Step = tuple[Any, ...]

DIGITS = 40  # of constants, before they are rounded
SLACK = sp.Rational(1001, 1000)  # exceeds the rounding of a radius
KNOWN = {function.of.func: name for name, function in FUNCTIONS.items() if function.of.is_Function}
REWRITTEN: Mapping[Any, Callable[[Any], sp.Expr]] = {
    sp.tan: lambda x: sp.sin(x) / sp.cos(x),
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
    sp.erfc: lambda x: 1 - sp.erf(x),
    sp.Abs: lambda x: sp.sign(x) * x,
}


class NoTapeError(ValueError):
    """An expression has an operation that tapes lack; the message names it."""


def tape_steps(
    position: Sequence[sp.Expr], u: sp.Symbol, v: sp.Symbol, parameters: Sequence[sp.Symbol] = ()
) -> tuple[list[Step], list[int]]:
    """Return the steps that compute expressions in u, v and parameters, and the results' indices.

    Raises NoTapeError if an expression has no tape.
    """
    if is_long(position):
        definitions, values = with_shared_parts(position)
        shared, outputs = [(x, _exact(y)) for x, y in definitions], [_exact(x) for x in values]
    else:
        shared, outputs = _common([_exact(x) for x in position])
    steps = _Steps({u: ("u",), v: ("v",)} | {x: ("parameter", x.name) for x in parameters})
    for symbol, value in shared:
        steps.define(symbol, value)
    found = [steps.step_of(x) for x in outputs]
    return steps.steps, found


def _exact(expression: Any) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return an expression with floats replaced by the fractions that they are exactly."""
    floats = {x: sp.Rational(x) for x in parts(expression) if isinstance(x, sp.Float)}
    return replaced(expression, floats)


def _common(expressions: list[Any]) -> tuple[list[tuple[sp.Symbol, Any]], list[Any]]:
    symbols = sp.numbered_symbols("t", cls=sp.Dummy, real=True)
    shared, outputs = sp.cse(expressions, symbols=symbols, order="canonical")
    return shared, cast(list[Any], outputs)


class _Steps:
    """The steps that compute expressions; equal steps are written once."""

    def __init__(self, symbols: Mapping[sp.Symbol, Step]) -> None:
        self.steps: list[Step] = []
        self._numbers: dict[Step, int] = {}
        self._found: dict[sp.Expr, int] = {x: self._write(*y) for x, y in symbols.items()}

    def define(self, symbol: sp.Symbol, expression: sp.Expr) -> None:
        """Write the steps of the expression that defines a symbol."""
        self._found[symbol] = self.step_of(expression)

    def step_of(self, expression: sp.Expr) -> int:
        """Return the index of the step that computes an expression, appending missing steps."""
        if expression not in self._found:
            self._found[expression] = self._written(expression)
        return self._found[expression]

    def _written(self, expression: sp.Expr) -> int:
        if expression.is_number:
            return self._constant(expression)
        if expression.is_Add:
            return self._folded("sum", expression.args)
        if expression.is_Mul:
            number, rest = expression.as_coeff_Mul()
            if number == -1:
                return self._write("negative", self.step_of(rest))
            return self._folded("product", expression.args)
        if expression.is_Pow:
            return self._power(*cast(tuple[sp.Expr, sp.Expr], expression.args))
        kind = expression.func
        if kind in KNOWN or kind is sp.sinc:
            (argument,) = cast(tuple[sp.Expr], expression.args)
            return self._write(KNOWN.get(kind, "sinc"), self.step_of(argument))
        if kind in REWRITTEN:
            return self.step_of(REWRITTEN[kind](*expression.args))
        raise NoTapeError(f"a tape has no {kind.__name__}")

    def _constant(self, expression: sp.Expr) -> int:
        value = expression if expression.is_Rational else expression.evalf(DIGITS)
        if not (value.is_Float or value.is_Rational):
            raise NoTapeError(f"{expression} is no real number")
        middle = float(value)
        distance = abs(sp.Rational(value) - sp.Rational(middle))
        return self._write("constant", middle, float(distance * SLACK))

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> int:
        if not (2 * exponent).is_Integer:  # defined for positive numbers
            logarithm = self._write("log", self.step_of(base))
            return self._write("exp", self._write("product", self.step_of(exponent), logarithm))
        return self._write("power", self.step_of(base), int(2 * exponent))

    def _folded(self, name: str, parts: Sequence[sp.Basic]) -> int:
        step, *rest = (self.step_of(cast(sp.Expr, x)) for x in parts)
        for other in rest:
            step = self._write(name, step, other)
        return step

    def _write(self, *step: str | float) -> int:
        """Return the index of a step, appending it if it is new."""
        number = self._numbers.setdefault(step, len(self.steps))
        if number == len(self.steps):
            self.steps.append(step)
        return number
