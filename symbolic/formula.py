"""`Formula`: a named formula, an object from which kernels and LaTeX are printed.

Formulas are written and shown in the notation of vectors; kernels compute with components.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import sympy as sp

from .display import latex, text
from .notation import Definition, components, flat, named, substitute

BEYOND_THE_PAPER = "beyond the paper"
Named = Iterable[tuple[str, sp.Expr]]


class Content(NamedTuple):
    """The content of a formula: its inputs, all its definitions, and which symbols are outputs."""

    inputs: tuple[sp.Symbol, ...]
    definitions: tuple[Definition, ...]
    outputs: tuple[sp.Symbol, ...]


class Parts(NamedTuple):
    """The parts of a formula: inputs, intermediate terms and outputs, by name."""

    inputs: Iterable[sp.Symbol]
    outputs: Named
    terms: Named = ()

    def named(self) -> Content:
        """Return the content; the symbol of a name is a scalar or a vector, as its expression."""
        terms, outputs = (
            tuple((named(x, y), y) for x, y in row) for row in (self.terms, self.outputs)
        )
        return Content(tuple(self.inputs), terms + outputs, tuple(x for x, _ in outputs))


@dataclass(frozen=True, eq=False)
class Formula:
    """A straight-line computation with a name, a description and its place in the paper.

    `description` is a sentence or two, with mathematics between dollar signs. `definitions` are in
    the order of computation: each may use the inputs and earlier definitions. `outputs` are the
    symbols of results; all other definitions are named terms. `inputs`, `definitions` and `outputs`
    are derived when one of them is first read.
    """

    name: str
    description: str
    source: str
    derive: Callable[[], Content] = field(repr=False)

    @classmethod
    def build(
        cls,
        name: str,
        description: str,
        *,
        source: str = BEYOND_THE_PAPER,
        inputs: Iterable[sp.Symbol],
        terms: Named = (),
        outputs: Named,
    ) -> Formula:
        """Make a formula of names and expressions; the symbol of a vector expression is a vector.

        Raises ValueError if an expression is neither a scalar nor a vector, if a symbol is used
        before it is defined, or is defined twice.
        """
        content = Parts(inputs, outputs, terms).named()
        made = cls(name, description, source, lambda: content)
        made._content  # noqa: B018 - raises
        return made

    @cached_property
    def _content(self) -> Content:
        content = self.derive()
        known = {*content.inputs, *flat(content.inputs)}
        for symbol, value in content.definitions:
            if unknown := value.free_symbols - known:
                raise ValueError(
                    f"{self.name}: {symbol} uses undefined {sorted(map(str, unknown))}"
                )
            if symbol in known:
                raise ValueError(f"{self.name}: {symbol} is defined twice")
            known |= {symbol, *flat([symbol])}
        return content

    @property
    def inputs(self) -> tuple[sp.Symbol, ...]:
        """The symbols of the inputs."""
        return self._content.inputs

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """The named terms and the outputs, in the order in which they are computed."""
        return self._content.definitions

    @property
    def outputs(self) -> tuple[sp.Symbol, ...]:
        """The symbols of the results."""
        return self._content.outputs

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Formula) and self._identity == other._identity

    def __hash__(self) -> int:
        return hash(self.name)

    @property
    def _identity(self) -> tuple[object, ...]:
        return self.name, self.description, self.source, self._content

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
        content = Content(flat(self.inputs), tuple(pairs), flat(self.outputs))
        return replace(self, derive=lambda: content)

    def expanded(self) -> dict[str, sp.Expr]:
        """Return each component of the outputs as an expression in components of the inputs."""
        values: dict[sp.Symbol, sp.Expr] = {}
        plain = self.in_components()
        for symbol, value in plain.definitions:
            values[symbol] = substitute(value, values)
        return {symbol.name: values[symbol] for symbol in plain.outputs}

    def text(self) -> str:
        """Return the definitions as plain text, one per line."""
        return text(self.definitions)

    def latex(self) -> str:
        """Return the definitions as an `aligned` block of LaTeX."""
        return latex(self.definitions)

    def _repr_latex_(self) -> str:
        """Show the formula in a notebook."""
        return f"$\\displaystyle {self.latex()}$"


def formula(
    name: str, description: str, *, source: str = BEYOND_THE_PAPER
) -> Callable[[Callable[[], Parts]], Formula]:
    """Make a formula of the parts that a function derives when the formula is first read.

    This is a decorator: the formula replaces the function.
    """

    def decorate(parts: Callable[[], Parts]) -> Formula:
        return Formula(name, description, source, lambda: parts().named())

    return decorate


def compose(
    name: str,
    description: str,
    parts: Sequence[Formula],
    *,
    source: str,
    outputs: Iterable[sp.Symbol],
) -> Formula:
    """Chain formulas into one formula: results of earlier parts are inputs of later parts.

    Only the definitions that `outputs` need are kept. When the formula is first read, ValueError is
    raised if two parts define a term differently, or if no part defines an output.
    """
    ends = tuple(outputs)
    return Formula(name, description, source, lambda: _chained(name, parts, ends))


def _chained(name: str, parts: Sequence[Formula], outputs: tuple[sp.Symbol, ...]) -> Content:
    defined: dict[sp.Symbol, sp.Expr] = {}
    inputs: dict[sp.Symbol, None] = {}
    for part in parts:
        inputs.update(dict.fromkeys(s for s in part.inputs if s not in defined))
        for symbol, value in part.definitions:
            if defined.setdefault(symbol, value) != value:
                raise ValueError(f"{name}: two parts define {symbol} differently")
    if missing := set(outputs) - defined.keys():
        raise ValueError(f"{name}: no part defines {sorted(map(str, missing))}")
    needed = set(outputs)

    def is_needed(symbol: sp.Symbol) -> bool:
        return not needed.isdisjoint({symbol, *flat([symbol])})

    for symbol in filter(is_needed, reversed(defined)):
        needed |= defined[symbol].free_symbols
    pairs = tuple(pair for pair in defined.items() if is_needed(pair[0]))
    return Content(tuple(filter(is_needed, inputs)), pairs, outputs)
