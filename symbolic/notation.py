"""The notation of vectors in formulas: symbols, their products, and their components."""

from collections.abc import Iterable, Mapping
from typing import Any, Literal, cast

import sympy as sp
from sympy.printing.precedence import PRECEDENCE

Definition = tuple[sp.Symbol, sp.Expr]


class VectorSymbol(sp.Symbol):
    """The name of a vector of R³."""

    AXES: tuple[str, ...] = ("x", "y", "z")

    @property
    def components(self) -> tuple[sp.Symbol, ...]:
        """The symbols name_x, name_y, name_z."""
        return tuple(scalar(f"{self.name}_{axis}") for axis in self.AXES)

    @classmethod
    def class_key(cls) -> tuple[Literal[2], Literal[0], str]:
        """Return the key of scalar symbols, so that SymPy sorts vectors among them, by name."""
        return sp.Symbol.class_key()

    @property
    def column(self) -> sp.Matrix:
        """The components as a matrix."""
        return sp.Matrix(self.components)


class PlaneVector(VectorSymbol):
    """The name of a vector of R²."""

    AXES = ("x", "y")


class TaylorSymbol(VectorSymbol):
    """The name of a polynomial in two variables of degree 2, whose components are coefficients."""

    AXES = ("0", "u", "v", "uu", "uv", "vv")


class CubicTaylorSymbol(TaylorSymbol):
    """The name of a polynomial in two variables of degree 3."""

    AXES = (*TaylorSymbol.AXES, "uuu", "uuv", "uvv", "vvv")


class VectorProduct(sp.Expr):
    """A product of vector symbols."""

    is_commutative = True
    precedence = PRECEDENCE["Mul"]

    @property
    def factors(self) -> list[sp.Matrix]:
        """The components of the factors."""
        return [cast(VectorSymbol, x).column for x in self.args]


class Dot(VectorProduct):
    """The scalar product of two vector symbols."""

    def in_components(self) -> sp.Expr:
        """Return the scalar product of the components of both vectors."""
        s, t = self.factors
        return dot(s, t)


class Det(VectorProduct):
    """The determinant of three vector symbols, or of two in the plane."""

    def in_components(self) -> sp.Expr:
        """Return r · (s × t), or s_x t_y − s_y t_x."""
        if len(self.args) == 2:
            return cast(sp.Expr, sp.Matrix.hstack(*self.factors).det())
        r, s, t = self.factors
        return dot(r, s.cross(t))


class Cross(VectorProduct):
    """The cross product of two vector symbols."""

    @property
    def column(self) -> sp.Matrix:
        """The components as a matrix."""
        s, t = self.factors
        return s.cross(t)


def scalar(name: str) -> sp.Symbol:
    """Return a real symbol."""
    return sp.Symbol(name, real=True)


def vectors(names: Iterable[str]) -> tuple[VectorSymbol, ...]:
    """Return one vector symbol for each name."""
    return tuple(VectorSymbol(name) for name in names)


def plane_vectors(names: Iterable[str]) -> tuple[PlaneVector, ...]:
    """Return one vector symbol of the plane for each name."""
    return tuple(PlaneVector(name) for name in names)


def dot(left: sp.Matrix, right: sp.Matrix) -> sp.Expr:
    """Return the scalar product of two columns."""
    pairs = zip(left.flat(), right.flat(), strict=True)
    return sum((x * y for x, y in pairs), start=sp.S.Zero)


def substitute(expression: sp.Expr, values: Mapping[Any, sp.Expr]) -> sp.Expr:
    """Replace symbols (or other subexpressions) by expressions, simultaneously."""
    return cast(sp.Expr, expression.xreplace(values))


def derivative(expression: sp.Expr, by: Mapping[VectorSymbol, VectorSymbol]) -> sp.Expr:
    """Return the derivative of a sum of products of vectors.

    `by` has the derivatives of the vectors.
    """
    zero: sp.Expr = sp.S.Zero
    if isinstance(expression, VectorProduct):
        factors = [cast(VectorSymbol, x) for x in expression.args]
        changed = (
            [*factors[:k], by[x], *factors[k + 1 :]] for k, x in enumerate(factors) if x in by
        )
        # A cross product or determinant with the same vector twice vanishes.
        some = (x for x in changed if isinstance(expression, Dot) or len({*x}) == len(x))
        return sum((expression.func(*x) for x in some), start=zero)
    if isinstance(expression, sp.Add):
        return sum((derivative(cast(sp.Expr, x), by) for x in expression.args), start=zero)
    factor, rest = expression.as_coeff_Mul()
    if factor == 1:
        raise TypeError(f"{expression} is no sum of multiples of products of vectors")
    return factor * derivative(rest, by)


def is_vector(expression: sp.Basic) -> bool:
    """Return whether an expression is a vector; ValueError if it is ill-formed, such as a + |a|."""
    if isinstance(expression, VectorProduct):
        return isinstance(expression, Cross)
    parts = [is_vector(x) for x in expression.args]
    if not any(parts):
        return isinstance(expression, VectorSymbol)
    if (expression.is_Add and all(parts)) or (expression.is_Mul and sum(parts) == 1):
        return True
    raise ValueError(f"{expression} mixes scalars and vectors")


def components(expression: sp.Expr) -> tuple[sp.Expr, ...]:
    """Return the components of a vector, or a scalar in the components of its vectors.

    Raises ValueError if the expression is ill-formed, see `is_vector`, or mixes R² and R³.
    """
    plain = substitute(expression, {x: x.in_components() for x in expression.atoms(Dot, Det)})
    if not is_vector(expression):
        return (plain,)
    columns = {x: x.column.flat() for x in plain.atoms(VectorSymbol, Cross)}
    rows = zip(*columns.values(), strict=True)
    return tuple(substitute(plain, dict(zip(columns, row, strict=True))) for row in rows)


def named(name: str, expression: sp.Expr) -> sp.Symbol:
    """Return a symbol of the same kind as the expression: a scalar or a vector of R² or R³."""
    if not is_vector(expression):
        return scalar(name)
    return (PlaneVector if len(components(expression)) == 2 else VectorSymbol)(name)


def flat(symbols: Iterable[sp.Symbol]) -> tuple[sp.Symbol, ...]:
    """Return the symbols, with each vector symbol replaced by its components."""
    return tuple(
        x for s in symbols for x in (s.components if isinstance(s, VectorSymbol) else (s,))
    )
