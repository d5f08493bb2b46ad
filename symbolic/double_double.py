"""Formulas of +, − and × as code on double-doubles: pairs (high, low) that carry 106 bits."""

from __future__ import annotations

import textwrap
from typing import cast

import sympy as sp

from .emit import in_brackets
from .formula import Formula
from .simplify import straight_line

__all__ = ["double_double_function"]


def double_double_function(formula: Formula) -> str:
    """Return a formula as a jitted function of pairs that returns pairs: `double_double_<name>`.

    Raises NotImplementedError if it has other operations than +, − and ×.
    """
    plain = formula.in_components()
    body = [
        f'"""As `{formula.name}`, of double-doubles."""',
        *(f"{x} = {_written(value)}" for x, value in straight_line(formula).assignments),
        f"return {', '.join(x.name for x in plain.outputs)}",
    ]
    definition = in_brackets(f"def double_double_{formula.name}(", plain.inputs, "):")
    return f"@jit\n{definition}\n" + textwrap.indent("\n".join(body), "    ")


def _written(value: sp.Expr) -> str:
    """Return an expression as calls of `plus`, `minus`, `times`, `multiple` and `negative`."""
    if isinstance(value, sp.Symbol):
        return value.name
    if isinstance(value, sp.Add):
        return _sum(value)
    if isinstance(value, sp.Mul):
        return _product(value)
    if isinstance(value, sp.Pow) and value.exp == 2:
        base = _written(value.base)
        return f"times({base}, {base})"
    raise NotImplementedError(f"{value} cannot be written in double-doubles")


def _sum(value: sp.Add) -> str:
    signed = [(_is_negative(x), x) for x in cast(list[sp.Expr], value.as_ordered_terms())]
    (_, first), *others = sorted(signed, key=lambda pair: pair[0])
    result = _written(first)
    for negative, term in others:
        name, size = ("minus", -term) if negative else ("plus", term)
        result = f"{name}({result}, {_written(size)})"
    return result


def _product(value: sp.Mul) -> str:
    number, rest = value.as_coeff_Mul()
    size = abs(number)
    result, *factors = map(_written, rest.as_ordered_factors())
    for factor in factors:
        result = f"times({result}, {factor})"
    if size != 1:
        if not (size.is_Integer and int(size) & (int(size) - 1) == 0):
            raise NotImplementedError(f"{value} has a factor that is no power of two")
        result = f"multiple({result}, {int(size)}.0)"
    return f"negative({result})" if number.is_negative else result


def _is_negative(term: sp.Expr) -> bool:
    return bool(term.as_coeff_Mul()[0].is_negative)
