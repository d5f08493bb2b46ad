"""Reads and checks a user's expressions and conditions, given as texts or SymPy objects.

`symbolic.reading` defines the language of texts. SymPy is imported at first use.
"""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Number
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base import bridge
from ..base.checks import listed
from ..base.errors import InputError, clipped, shown

if TYPE_CHECKING:
    import sympy

__all__ = [
    "as_condition",
    "as_expression",
    "as_position",
    "numbers",
    "one_symbol",
    "two_symbols",
]


def as_position(position: Sequence[Any], symbols: Sequence[sympy.Symbol]) -> tuple[Any, ...]:
    """Return the coordinates: three expressions in two symbols, or two expressions in one symbol.

    Raises InputError if they are unusable.
    Symbols in the expressions that have the names of `symbols` are replaced by these, whatever
    their assumptions are.
    """
    by_name = {symbol.name: symbol for symbol in symbols}
    expressions = [as_expression(entry, by_name) for entry in _coordinates(position, len(symbols))]
    reading, found = bridge.reading(), []
    unknown: set[Any] = set()
    for e in expressions:
        free: set[Any] = reading.free_symbols(e)
        own = {s: by_name[s.name] for s in free if s.name in by_name}
        found.append(reading.replaced(e, {s: x for s, x in own.items() if s != x}))
        unknown |= free - set(own)
    if unknown:
        names = clipped(", ".join(sorted(map(str, unknown))))
        raise InputError(f"position holds symbols that are neither parameter nor number: {names}.")
    return tuple(found)


def numbers(domain: Sequence[Any], form: str) -> Any:  # noqa: ANN401
    """Return a domain or an interval with bounds as floats; the given bounds may be expressions.

    Raises InputError, which states the required form, if the domain is invalid.
    """

    def number(end: object) -> Any:  # noqa: ANN401
        ends = listed(end)
        return float(as_expression(end, {})) if ends is None else [number(x) for x in ends]

    try:
        return number(domain)
    except (TypeError, ValueError, OverflowError, RecursionError):  # lists that contain themselves
        raise InputError(f"domain must be {form} in numbers, not {shown(domain)}.") from None


def _coordinates(position: Sequence[Any], parameters: int) -> tuple[Any, ...]:
    """Return the entries of a position; InputError unless there is one more than parameters."""
    names = "(x, y, z)" if parameters == 2 else "(x, y)"
    coordinates = tuple(listed(position) or ())
    if len(coordinates) != parameters + 1:
        number = "three" if parameters == 2 else "two"
        raise InputError(
            f"position must be {number} SymPy expressions {names}, not {shown(position)}."
        )
    return coordinates


def two_symbols(parameters: Sequence[Any]) -> list[sympy.Symbol]:
    """Return real symbols for two parameters, given as symbols or names; otherwise InputError."""
    try:
        u, v = (_symbol(x) for x in parameters)
    except Exception:  # iteration may raise anything
        u = v = None
    if u is None or v is None or u.name == v.name:
        raise InputError(f"parameters must be two SymPy symbols (u, v), not {shown(parameters)}.")
    return [u, v]


def one_symbol(parameter: sympy.Symbol | str) -> list[sympy.Symbol]:
    """Return a real symbol for a parameter, given as symbol or name; otherwise InputError."""
    symbol = _symbol(parameter)
    if symbol is None:
        raise InputError(f"the parameter must be a SymPy symbol such as t, not {shown(parameter)}.")
    return [symbol]


def _symbol(entry: object) -> sympy.Symbol | None:
    import sympy as sp

    if isinstance(entry, sp.Symbol):
        entry = entry.name
    elif not isinstance(entry, str) or not entry.isidentifier():
        return None
    return sp.Symbol(entry, real=True)


def as_expression(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a SymPy expression, or read one from a text, in which `symbols` are known by name.

    Raises InputError, which states the reason, if the expression is invalid or cannot be compiled.
    """
    import sympy as sp

    expression = _read(entry, symbols)
    if not isinstance(expression, sp.Expr) or expression.is_Matrix:
        raise InputError(f"{shown(entry)} is not a SymPy expression.")
    return expression


def as_condition(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a Boolean of SymPy, or read one from a text; InputError if it is invalid."""
    from sympy.logic.boolalg import Boolean

    condition = _read(entry, symbols)
    if not isinstance(condition, Boolean) or condition.is_Symbol:
        raise InputError(f"{shown(entry)} is not a condition.")
    return condition


def _read(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401
    """Return the SymPy object for a text, a number or an expression; None for anything else.

    SymPy would run texts as Python, even those in lists, so texts are never passed to it.
    """
    import sympy as sp

    reading = bridge.reading()
    try:
        if isinstance(entry, str):
            return reading.read(entry, symbols)
        if not isinstance(entry, sp.Basic | sp.MatrixBase | Number | np.bool_):
            return None
        expression = sp.sympify(entry, strict=True)
        reading.refuse_unusable(expression)
    except reading.ReadingError as error:
        raise InputError(
            f"{shown(entry)} is not a SymPy expression that can be compiled: {error}."
        ) from None
    except (sp.SympifyError, ValueError, TypeError, RecursionError):
        return None
    return expression
