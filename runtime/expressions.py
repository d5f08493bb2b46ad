"""SymPy expressions of a user as a fast callable; SymPy is imported only here, on first use."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

if TYPE_CHECKING:
    import sympy

__all__ = ["compiled", "numbers"]


def compiled(
    position: Sequence[Any], parameters: Sequence[Any]
) -> Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    """Return f(u, v) → (..., 3) for three expressions in two parameters; InputError if unusable."""
    import sympy as sp

    symbols = _symbols(parameters)
    by_name = {symbol.name: symbol for symbol in symbols}
    try:
        x, y, z = position
    except (TypeError, ValueError):
        raise InputError(
            f"position must be three SymPy expressions (x, y, z), not {position!r}."
        ) from None
    expressions = [_expression(entry, by_name) for entry in (x, y, z)]
    if any(e.has(sp.nan, sp.zoo) for e in expressions):
        raise InputError(f"position is not finite: {position!r}.")
    expressions = [
        e.subs({s: by_name[s.name] for s in e.free_symbols if s.name in by_name})
        for e in expressions
    ]
    unknown = set().union(*(e.free_symbols for e in expressions)) - set(symbols)
    if unknown:
        names = ", ".join(sorted(map(str, unknown)))
        raise InputError(f"position holds symbols that are neither parameter nor number: {names}.")
    function = sp.lambdify(symbols, expressions, modules="numpy", cse=True)

    def evaluate(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([np.broadcast_to(x, u.shape) for x in function(u, v)], axis=-1)

    return evaluate


def numbers(domain: Sequence[Sequence[Any]]) -> list[list[float]]:
    """Return a domain whose ends may be expressions as floats; raise InputError if it is none."""
    try:
        return [[float(_expression(end, {})) for end in ends] for ends in domain]
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"domain must be ((u0, u1), (v0, v1)) in numbers, not {domain!r}."
        ) from None


def _symbols(parameters: Sequence[Any]) -> list[sympy.Symbol]:
    import sympy as sp

    try:
        u, v = (sp.Symbol(x) if isinstance(x, str) and x.isidentifier() else x for x in parameters)
    except (TypeError, ValueError):
        u = v = None
    if not (isinstance(u, sp.Symbol) and isinstance(v, sp.Symbol)) or u.name == v.name:
        raise InputError(f"parameters must be two SymPy symbols (u, v), not {parameters!r}.")
    return [u, v]


def _expression(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return an expression or the one that a text stands for, in which `symbols` come first."""
    import sympy as sp

    sympify: Any = sp.sympify  # its type hints forget `locals`
    try:
        expression = sympify(entry, locals=symbols)
    except Exception:  # SymPy runs the text as Python, which may raise anything
        expression = None
    if not isinstance(expression, sp.Expr):
        raise InputError(f"{entry!r} is not a SymPy expression.")
    return expression
