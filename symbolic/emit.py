"""Formulas as Python source for Numba: functions of vectors, and filled templates."""

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import sympy as sp

from .formula import Formula
from .notation import (
    CubicTaylorSymbol,
    PlaneVector,
    TaylorSymbol,
    VectorSymbol,
    plane_vectors,
    scalar,
    vectors,
)
from .printer import source_of
from .simplify import straight_line

TEMPLATES = Path(__file__).parent / "templates"
PLACEHOLDER = re.compile(r"^(?P<indent> *)\{\{(?P<key>\w+)\}\}$", re.MULTILINE)
WIDTH = 92
# The named tuples of several vectors or numbers: name of the argument, name of the type, sentence,
# and fields.
Group = tuple[str, str, str, tuple[sp.Symbol, ...]]
HESSIAN = tuple(scalar(f"H_{x}") for x in ("xx", "yy", "zz", "xy", "xz", "yz"))
GROUPS: tuple[Group, ...] = (
    ("patch", "Patch", "The vectors of a quadratic patch, eq. (8).", vectors("abcdep")),
    ("arc", "Arc", "The vectors of a quadratic arc, as those of a patch.", plane_vectors("abc")),
    ("hessian", "Hessian", "The entries of a Hessian, a symmetric matrix.", HESSIAN),
)
# A formula takes the whole tuple as one argument if its inputs contain these fields.
NEEDED = {"patch": set(vectors("abcde")), "arc": set(plane_vectors("ab")), "hessian": set(HESSIAN)}


# The type of the tuple of numbers for each kind of vector symbol, with the sentence of its
# docstring.
KINDS = {
    VectorSymbol: ("Vector", "A vector of R³."),
    PlaneVector: ("PlaneVector", "A vector of R²."),
    TaylorSymbol: ("Taylor", "The Taylor coefficients of a function of u and v up to order 2."),
    CubicTaylorSymbol: ("CubicTaylor", "The Taylor coefficients of a function up to order 3."),
}


def assignments(formula: Formula) -> list[str]:
    """Return the straight-line code of a formula, one assignment per line."""
    return [f"{x} = {source_of(value)}" for x, value in straight_line(formula).assignments]


def counts(formula: Formula) -> str:
    """Return the operation counts of a formula in words."""
    code = straight_line(formula)
    return f"{code.operations_before} operations as written, {code.operations_after} here"


def arguments(formula: Formula) -> dict[str, tuple[sp.Symbol, ...]]:
    """Return the arguments of the function of a formula, each with the inputs that it contains.

    An argument is a scalar, a vector, or a `Patch`, `Arc` or `Hessian` that contains several
    inputs.
    """
    result: dict[str, tuple[sp.Symbol, ...]] = {}
    for symbol in formula.inputs:
        name = next((g[0] for g in GROUPS if symbol in g[3] and _takes(formula, g)), symbol.name)
        result[name] = (*result.get(name, ()), symbol)
    return result


def _takes(formula: Formula, group: Group) -> bool:
    return NEEDED[group[0]] <= {*formula.inputs}


def described(formula: Formula) -> list[str]:
    """Return the lines of a docstring, without its end: sentence, definitions, source, counts."""
    return [
        *textwrap.wrap(f'"""{formula.sentence}', WIDTH),
        "",
        *(f"    {line}" for line in formula.text().splitlines()),
        "",
        *textwrap.wrap(f"Source: {formula.source}; {counts(formula)}.", WIDTH),
    ]


def function(formula: Formula) -> str:
    """Return a formula as an inlined function of vectors and scalars that returns its outputs."""
    taken = arguments(formula)
    docstring = [*described(formula), '"""']
    loads = [x for name, symbols in taken.items() for x in unpacked(name, symbols)]
    body = [*docstring, *loads, *assignments(formula), f"return {_returned(formula)}"]
    definition = f"@inline\ndef {formula.name}({', '.join(taken)}):\n"
    return definition + textwrap.indent("\n".join(body), "    ")


def unpacked(argument: str, symbols: Sequence[sp.Symbol]) -> list[str]:
    """Return assignments that read the numbers in an argument, a vector or a tuple of vectors."""
    if symbols == HESSIAN:
        return [f"{', '.join(x.name for x in symbols)} = {argument}"]
    return [
        f"{', '.join(x.name for x in symbol.components)} = "
        + (argument if argument == symbol.name else f"{argument}.{symbol.name}")
        for symbol in symbols
        if isinstance(symbol, VectorSymbol)
    ]


def grouped(symbols: Sequence[sp.Symbol]) -> list[tuple[Group | None, tuple[sp.Symbol, ...]]]:
    """Return pairs of a group and its symbols, in the order of `symbols`.

    Consecutive symbols that are all the fields of a named tuple, in order, form a group. Any other
    symbol is alone, with None in place of the group.
    """
    result: list[tuple[Group | None, tuple[sp.Symbol, ...]]] = []
    place = 0
    while place < len(symbols):
        rest = tuple(symbols[place:])
        group = next((g for g in GROUPS if rest[: len(g[3])] == g[3]), None)
        result.append((group, group[3] if group else rest[:1]))
        place += len(result[-1][1])
    return result


def _returned(formula: Formula) -> str:
    """Return the outputs of a formula as an expression: one value or several."""
    parts = []
    for group, symbols in grouped(formula.outputs):
        values = ", ".join(map(_constructed, symbols))
        parts.append(f"{group[1]}({values})" if group else values)
    return ", ".join(parts)


def _constructed(symbol: sp.Symbol) -> str:
    if not isinstance(symbol, VectorSymbol):
        return symbol.name
    return f"{_kind(symbol)}({', '.join(x.name for x in symbol.components)})"


def _kind(symbol: sp.Symbol) -> str:
    if not isinstance(symbol, VectorSymbol):
        return "float"
    return KINDS[type(symbol)][0]


def field(axis: str) -> str:
    """Return the name of a component, which does not begin with a digit."""
    return "value" if axis == "0" else axis


def functions(formulas: Iterable[Formula]) -> str:
    """Return several formulas as inlined functions of vectors."""
    return "\n\n\n".join(map(function, formulas))


def named_tuples() -> str:
    """Return the types of vectors, and of the tuples of vectors that formulas take."""
    types = [
        (name, sentence, [(field(x), "float") for x in kind.AXES])
        for kind, (name, sentence) in KINDS.items()
    ]
    for _, name, sentence, fields in GROUPS:
        types.append((name, sentence, [(x.name, _kind(x)) for x in fields]))
    return "\n\n\n".join(
        "\n".join(
            [f"class {name}(NamedTuple):", f'    """{sentence}"""', ""]
            + [f"    {field}: {kind}" for field, kind in fields]
        )
        for name, sentence, fields in types
    )


def render(template: str, values: Mapping[str, str]) -> str:
    """Fill the lines `{{key}}` of templates/<template>.in, keeping their indentation.

    Raises ValueError unless the keys of the template are exactly those of `values`.
    """
    source = (TEMPLATES / f"{template}.in").read_text(encoding="utf-8")
    asked = {match["key"] for match in PLACEHOLDER.finditer(source)}
    if asked != values.keys():
        raise ValueError(f"{template} and its values differ in {sorted(asked ^ values.keys())}")
    return PLACEHOLDER.sub(
        lambda match: textwrap.indent(values[match["key"]], match["indent"]), source
    )
