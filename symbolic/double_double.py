"""Formulas of +, − and × as code on double-doubles: pairs (high, low) that carry 106 bits."""

from __future__ import annotations

import textwrap

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
    if value.is_Symbol:
        return value.name
    if value.is_Add:
        return _sum(value)
    if value.is_Mul:
        return _product(value)
    if value.is_Pow and value.exp == 2:
        return f"times({_written(value.base)}, {_written(value.base)})"
    raise NotImplementedError(f"{value} cannot be written in double-doubles")


def _sum(value: sp.Expr) -> str:
    terms = sorted(value.as_ordered_terms(), key=lambda x: x.as_coeff_Mul()[0].is_negative)
    result = _written(terms[0])
    for term in terms[1:]:
        negative = term.as_coeff_Mul()[0].is_negative
        result = (
            f"{'minus' if negative else 'plus'}({result}, {_written(-term if negative else term)})"
        )
    return result


def _product(value: sp.Expr) -> str:
    number, rest = value.as_coeff_Mul()
    first, *others = rest.as_ordered_factors()
    result = _written(first)
    for factor in others:
        result = f"times({result}, {_written(factor)})"
    if abs(number) != 1:
        size = abs(number)
        if not (size.is_Integer and int(size) & (int(size) - 1) == 0):
            raise NotImplementedError(f"{value} has a factor that is no power of two")
        result = f"multiple({result}, {int(size)}.0)"
    return f"negative({result})" if number.is_negative else result
