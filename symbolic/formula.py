"""The named formula: one object, from which the kernels are emitted and the LaTeX is printed.

Formulas are written in the notation of vectors, so that they can be shown as people write them;
what is computed are their components.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy as sp

from .display import latex, text
from .notation import Definition, components, flat, named, substitute

__all__ = ["BEYOND_THE_PAPER", "Formula", "compose"]

BEYOND_THE_PAPER = "beyond the paper"


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
        return text(self.definitions)

    def latex(self) -> str:
        """Return the definitions as an `aligned` block of LaTeX."""
        return latex(self.definitions)

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
