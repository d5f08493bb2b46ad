"""Formulas as Python source for Numba: functions, blocks inside loops, and filled templates."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping
from pathlib import Path

import sympy as sp

from .formula import Formula
from .printer import source_of
from .simplify import straight_line

__all__ = ["block", "call", "function", "functions", "render"]

TEMPLATES = Path(__file__).parent / "templates"
PLACEHOLDER = re.compile(r"^(?P<indent> *)\{\{(?P<key>\w+)\}\}$", re.MULTILINE)
WIDTH = 92


def assignments(formula: Formula) -> list[str]:
    """Return the straight-line code of a formula, one assignment a line."""
    return [f"{x} = {source_of(value)}" for x, value in straight_line(formula).assignments]


def counts(formula: Formula) -> str:
    """Return the operation counts of a formula in words."""
    code = straight_line(formula)
    return f"{code.operations_before} operations as written, {code.operations_after} here"


def block(formula: Formula) -> str:
    """Return a formula as assignments that read its inputs from local names."""
    comment = f"# {formula.name} ({formula.source}): {counts(formula)}"
    return "\n".join([comment, *assignments(formula)])


def function(formula: Formula) -> str:
    """Return a formula as a jitted function of its inputs that returns its outputs."""
    plain = formula.in_components()
    docstring = [
        *textwrap.wrap(f'"""{formula.sentence}', WIDTH),
        "",
        *(f"    {line}" for line in formula.text().splitlines()),
        "",
        *textwrap.wrap(f"Source: {formula.source}; {counts(formula)}.", WIDTH),
        '"""',
    ]
    body = [*docstring, *assignments(formula), f"return {', '.join(x.name for x in plain.outputs)}"]
    definition = in_brackets(f"def {formula.name}(", plain.inputs, "):")
    return f"@jit\n{definition}\n" + textwrap.indent("\n".join(body), "    ")


def functions(formulas: Iterable[Formula]) -> str:
    """Return several formulas as functions."""
    return "\n\n\n".join(map(function, formulas))


def call(formula: Formula) -> str:
    """Return the call of the function of a formula with local names of its inputs."""
    return in_brackets(f"{formula.name}(", formula.in_components().inputs, ")")


def in_brackets(opening: str, symbols: Iterable[sp.Symbol], closing: str) -> str:
    """Return names in brackets, on one line or in a block that the formatter leaves alone."""
    names = ", ".join(symbol.name for symbol in symbols)
    if len(opening + names + closing) <= 100:
        return f"{opening}{names}{closing}"
    return f"{opening}\n{textwrap.indent(textwrap.fill(names, 90), '    ')}\n{closing}  # fmt: skip"


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
