"""Straight-line code of a formula, made by a short list of passes."""

from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cache
from typing import cast

import sympy as sp

from .formula import Formula
from .notation import Definition, substitute
from .printer import operations


@dataclass(frozen=True)
class StraightLine:
    """Assignments in order, and the numbers of operations before and after simplification."""

    assignments: tuple[Definition, ...]
    operations_before: int
    operations_after: int


@cache
def straight_line(formula: Formula) -> StraightLine:
    """Share subexpressions between the definitions of a formula, then drop needless names."""
    definitions = formula.in_components().definitions
    assignments = share_subexpressions(definitions)
    assignments = write_back(assignments, other_names(assignments))
    assignments = write_back(assignments, used_once(assignments))
    assignments = name_temporaries(assignments)
    return StraightLine(
        tuple(assignments),
        operations(value for _, value in definitions),
        operations(value for _, value in assignments),
    )


def share_subexpressions(definitions: Collection[Definition]) -> list[Definition]:
    """Eliminate common subexpressions jointly, with each temporary just before its first use."""
    names, values = zip(*definitions, strict=True)
    temporaries = sp.numbered_symbols("t", cls=sp.Dummy, real=True)
    shared, reduced = cast(
        tuple[list[Definition], list[sp.Expr]],
        sp.cse(values, symbols=temporaries, order="canonical"),
    )
    pending = dict(shared)
    result: list[Definition] = []

    def append(symbol: sp.Symbol, value: sp.Expr) -> None:
        for needed in [x for x in pending if x in value.free_symbols]:
            if needed in pending:
                append(needed, pending.pop(needed))
        result.append((symbol, value))

    for name, value in zip(names, reduced, strict=True):
        append(name, value)
    return result


def other_names(assignments: Iterable[Definition]) -> set[sp.Symbol]:
    """Return the temporaries whose value is only another symbol, possibly with a minus sign."""

    def is_name(value: sp.Basic) -> bool:  # a condition has no sign
        return value.is_Symbol or (isinstance(value, sp.Mul) and (-value).is_Symbol)

    return {x for x, value in assignments if x.is_Dummy and is_name(value)}


def used_once(assignments: Iterable[Definition]) -> Collection[sp.Symbol]:
    """Return the temporaries that are used once."""
    nodes = (node for _, value in assignments for node in sp.preorder_traversal(value))
    uses = Counter(node for node in nodes if isinstance(node, sp.Dummy))
    return {symbol for symbol, count in uses.items() if count == 1}


def write_back(
    assignments: Iterable[Definition], needless: Collection[sp.Symbol]
) -> list[Definition]:
    """Substitute the values of `needless` symbols where they are used; drop their assignments."""
    values: dict[sp.Symbol, sp.Expr] = {}
    kept: list[Definition] = []
    for symbol, value in assignments:
        written = substitute(value, values)
        if symbol in needless:
            values[symbol] = written
        else:
            kept.append((symbol, written))
    return kept


def name_temporaries(assignments: Collection[Definition]) -> list[Definition]:
    """Rename the temporaries to t0, t1, … in order, skipping names that the formula uses."""
    symbols = {y for x, value in assignments for y in (x, *value.atoms(sp.Symbol))}
    taken = {x.name for x in symbols if not x.is_Dummy}
    free = (x for x in sp.numbered_symbols("t", real=True) if x.name not in taken)
    names = dict(zip((x for x, _ in assignments if x.is_Dummy), free, strict=False))
    return [(names.get(symbol, symbol), substitute(value, names)) for symbol, value in assignments]
