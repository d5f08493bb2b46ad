"""The named formula: one object, from which the kernels are emitted and the LaTeX is printed.

Formulas are written in the notation of vectors, so that they can be shown as people write them;
what is computed are their components.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, cast

import sympy as sp
from sympy.printing.precedence import PRECEDENCE

__all__ = [
    "BEYOND_THE_PAPER",
    "Cross",
    "Definition",
    "Det",
    "Dot",
    "Formula",
    "PlaneVector",
    "VectorSymbol",
    "compose",
    "dot",
    "plane_vectors",
    "scalar",
    "substitute",
    "vectors",
]

BEYOND_THE_PAPER = "beyond the paper"

Definition = tuple[sp.Symbol, sp.Expr]


# --- the notation of vectors ----------------------------------------------------------------------


class VectorSymbol(sp.Symbol):
    """The name of a vector of R³."""

    AXES: tuple[str, ...] = ("x", "y", "z")

    @property
    def components(self) -> tuple[sp.Symbol, ...]:
        """The symbols name_x, name_y, name_z."""
        return tuple(scalar(f"{self.name}_{axis}") for axis in self.AXES)

    @classmethod
    def class_key(cls) -> tuple[Literal[2], Literal[0], str]:
        """Sort vectors among the other symbols, by their names."""
        return sp.Symbol.class_key()

    @property
    def column(self) -> sp.Matrix:
        """The components as a matrix."""
        return sp.Matrix(self.components)


class PlaneVector(VectorSymbol):
    """The name of a vector of R²."""

    AXES = ("x", "y")


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
        """Return s · t."""
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
    """Replace symbols (or other parts) by expressions, all at once."""
    return cast(sp.Expr, expression.xreplace(values))


def is_vector(expression: sp.Basic) -> bool:
    """Say whether an expression is a vector; ValueError if it makes no sense, such as a + |a|."""
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

    Raises ValueError if the expression makes no sense, see `is_vector`, or mixes R² and R³.
    """
    plain = substitute(expression, {x: x.in_components() for x in expression.atoms(Dot, Det)})
    if not is_vector(expression):
        return (plain,)
    columns = {x: x.column.flat() for x in plain.atoms(VectorSymbol, Cross)}
    rows = zip(*columns.values(), strict=True)
    return tuple(substitute(plain, dict(zip(columns, row, strict=True))) for row in rows)


def named(name: str, expression: sp.Expr) -> sp.Symbol:
    """Return a symbol of the kind that the expression is: a scalar or a vector of R² or R³."""
    if not is_vector(expression):
        return scalar(name)
    return (PlaneVector if len(components(expression)) == 2 else VectorSymbol)(name)


def flat(symbols: Iterable[sp.Symbol]) -> tuple[sp.Symbol, ...]:
    """Put components in the place of vector symbols."""
    return tuple(
        x for s in symbols for x in (s.components if isinstance(s, VectorSymbol) else (s,))
    )


# --- the formula ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Formula:
    """A straight-line computation with a name, a description and its place in the paper.

    `description` is a sentence or two, with mathematics between dollar signs. `definitions` are in
    the order in which they are computed: each may use the inputs and what stands before it.
    `outputs` are those of them that the formula is for; the others are named terms.
    """

    name: str
    description: str
    source: str
    inputs: tuple[sp.Symbol, ...]
    definitions: tuple[Definition, ...]
    outputs: tuple[sp.Symbol, ...]

    def __post_init__(self) -> None:
        """Raise ValueError if a symbol is used before it is defined, or is defined twice."""
        known = {*self.inputs, *flat(self.inputs)}
        for symbol, value in self.definitions:
            if unknown := value.free_symbols - known:
                raise ValueError(
                    f"{self.name}: {symbol} uses undefined {sorted(map(str, unknown))}"
                )
            if symbol in known:
                raise ValueError(f"{self.name}: {symbol} is defined twice")
            known |= {symbol, *flat([symbol])}

    @classmethod
    def build(
        cls,
        name: str,
        description: str,
        *,
        source: str = BEYOND_THE_PAPER,
        inputs: Iterable[sp.Symbol],
        terms: Sequence[tuple[str, sp.Expr]] = (),
        outputs: Sequence[tuple[str, sp.Expr]],
    ) -> Formula:
        """Make a formula of names and expressions; what is a vector follows from the expression.

        Raises ValueError if an expression is neither a scalar nor a vector.
        """
        pairs = tuple((named(x, y), y) for x, y in (*terms, *outputs))
        symbols = tuple(symbol for symbol, _ in pairs[len(terms) :])
        return cls(name, description, source, tuple(inputs), pairs, symbols)

    @property
    def sentence(self) -> str:
        """The description as plain text."""
        return self.description.replace("$", "")

    def in_components(self) -> Formula:
        """Return the same computation without vectors."""
        pairs = [
            pair
            for symbol, value in self.definitions
            for pair in zip(flat([symbol]), components(value), strict=True)
        ]
        return Formula(
            self.name,
            self.description,
            self.source,
            flat(self.inputs),
            tuple(pairs),
            flat(self.outputs),
        )

    def expanded(self) -> dict[str, sp.Expr]:
        """Return each component of the outputs as one expression in those of the inputs."""
        values: dict[sp.Symbol, sp.Expr] = {}
        plain = self.in_components()
        for symbol, value in plain.definitions:
            values[symbol] = substitute(value, values)
        return {symbol.name: values[symbol] for symbol in plain.outputs}

    def text(self) -> str:
        """Return the definitions as plain text, one a line."""
        from .display import text

        return text(self)

    def latex(self) -> str:
        """Return the definitions as an `aligned` block of LaTeX."""
        from .display import latex

        return latex(self)

    def _repr_latex_(self) -> str:
        """Show the formula in a notebook."""
        return f"$\\displaystyle {self.latex()}$"


def compose(
    name: str,
    description: str,
    parts: Sequence[Formula],
    *,
    source: str,
    outputs: Iterable[sp.Symbol],
) -> Formula:
    """Chain formulas into one: what an earlier part computes feeds the later ones.

    Only the definitions that `outputs` need are kept. Raises ValueError if two parts define a term
    differently, or none defines an output.
    """
    defined: dict[sp.Symbol, sp.Expr] = {}
    inputs: dict[sp.Symbol, None] = {}
    for part in parts:
        inputs.update(dict.fromkeys(s for s in part.inputs if s not in defined))
        for symbol, value in part.definitions:
            if defined.setdefault(symbol, value) != value:
                raise ValueError(f"{name}: two parts define {symbol} differently")
    ends = tuple(outputs)
    if missing := set(ends) - defined.keys():
        raise ValueError(f"{name}: no part defines {sorted(map(str, missing))}")
    needed = set(ends)

    def is_needed(symbol: sp.Symbol) -> bool:
        return not needed.isdisjoint({symbol, *flat([symbol])})

    for symbol in filter(is_needed, reversed(defined)):
        needed |= defined[symbol].free_symbols
    return Formula(
        name,
        description,
        source,
        tuple(filter(is_needed, inputs)),
        tuple(pair for pair in defined.items() if is_needed(pair[0])),
        ends,
    )
