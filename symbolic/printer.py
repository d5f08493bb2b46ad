"""SymPy expressions as Python source for Numba: products instead of powers, exact numbers.

Powers other than short products and square roots are calls of `math.pow`; they occur only in users'
expressions.
"""

import ast
from collections.abc import Iterable
from typing import Any, cast

import sympy as sp
from sympy.printing.numpy import SciPyPrinter
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

LONGEST_PRODUCT = 64  # higher powers are calls of `math.pow`


class PositiveFirst:
    """A mixin for printers: terms of sums are in SymPy's order, but a positive term comes first."""

    def _as_ordered_terms(self, expr: sp.Expr, order: str | None = None) -> list[sp.Expr]:
        terms = cast(Any, super())._as_ordered_terms(expr, order)
        positive = (x for x in terms if not x.as_coeff_Mul()[0].is_negative)
        first = next(positive, terms[0])
        return [first, *(x for x in terms if x is not first)]


class KernelPrinter(PositiveFirst, PythonCodePrinter):
    """Print powers without `**`, and integers as integers, so that integer arguments stay exact."""

    power, root = "math.pow", "math.sqrt"

    def _print_Mul(self, expr: sp.Mul) -> str:
        coefficient, rest = expr.as_coeff_Mul()
        size = abs(coefficient)
        above, below = [] if size == 1 else [self._print(size)], []
        for factor in rest.as_ordered_factors():
            base, exponent = factor.as_base_exp() if factor.is_Pow else (factor, sp.S.One)
            side = below if exponent.is_negative else above
            side.extend(self._factors(base, _without_sign(exponent)))
        return ("-" if coefficient.is_negative else "") + _quotient(above, below)

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        base, exponent = expr.as_base_exp()
        factors = self._factors(base, _without_sign(exponent))
        return _quotient([], factors) if exponent.is_negative else _quotient(factors, [])

    def _print_Integer(self, expr: sp.Integer) -> str:
        fits = -(2**63) <= int(expr.p) < 2**63
        return str(int(expr.p)) if fits else f"{int(expr.p)}.0"

    def _print_Rational(self, expr: sp.Rational) -> str:
        numerator, denominator = int(expr.p), int(expr.q)
        if denominator & (denominator - 1) == 0:
            return repr(numerator / denominator)
        return f"({numerator}.0 / {denominator}.0)"

    def _factors(self, base: sp.Expr, exponent: sp.Expr) -> list[str]:
        """Return the factors whose product is a power; its exponent is not known to be negative."""
        whole, half = divmod(exponent, 1)
        if not whole.is_Integer or half not in (0, sp.S.Half) or whole > LONGEST_PRODUCT:
            return [f"{self.power}({self._print(base)}, {self._print(exponent)})"]
        roots = [f"{self.root}({self._print(base)})"] if half else []
        return [self.parenthesize(base, PRECEDENCE["Mul"])] * int(whole) + roots


class ArrayPrinter(KernelPrinter, SciPyPrinter):
    """Print source for arrays, with the functions of NumPy and of `scipy.special`."""

    power, root = "numpy.power", "numpy.sqrt"


SETTINGS = {"fully_qualified_modules": True, "allow_unknown_functions": False}


def _without_sign(exponent: sp.Expr) -> sp.Expr:
    return -exponent if exponent.is_negative else exponent


def _quotient(above: list[str], below: list[str]) -> str:
    numerator = " * ".join(above or ["1.0"])
    if not below:
        return numerator
    denominator = below[0] if len(below) == 1 else f"({' * '.join(below)})"
    return f"{numerator} / {denominator}"


def source_of(expression: sp.Expr) -> str:
    """Return the expression as Python source.

    Raises NotImplementedError for functions that `math` does not have.
    """
    return cast(str, KernelPrinter(SETTINGS).doprint(expression))


def array_source_of(expression: sp.Expr) -> str:
    """Return the expression as Python source for arrays of NumPy.

    Raises NotImplementedError for functions that neither NumPy nor `scipy.special` has.
    """
    return cast(str, ArrayPrinter(SETTINGS).doprint(expression))


def operations(expressions: Iterable[sp.Expr]) -> int:
    """Return the number of operations and calls in the source, except in constants."""
    nodes = (node for x in expressions for node in ast.walk(ast.parse(source_of(x))))
    return sum(
        isinstance(node, ast.BinOp | ast.UnaryOp | ast.Call) and _has_variable(node)
        for node in nodes
    )


def _has_variable(tree: ast.AST) -> bool:
    return any(isinstance(node, ast.Name) and node.id != "math" for node in ast.walk(tree))
