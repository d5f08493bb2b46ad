"""SymPy expressions of a user as a fast callable; SymPy is imported only here, on first use."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

if TYPE_CHECKING:
    import sympy

__all__ = ["as_expression", "compiled", "interval", "numbers", "one_symbol", "two_symbols"]


def compiled(
    position: Sequence[Any], symbols: Sequence[sympy.Symbol]
) -> Callable[..., NDArray[np.float64]]:
    """Return f(u, v) → (..., 3) for three expressions in two symbols, or f(t) → (..., 2).

    Raises InputError if they are unusable.
    """
    import sympy as sp

    by_name = {symbol.name: symbol for symbol in symbols}
    expressions = [as_expression(entry, by_name) for entry in _coordinates(position, len(symbols))]
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

    def evaluate(*values: NDArray[np.float64]) -> NDArray[np.float64]:
        shape = values[0].shape
        return np.stack([np.broadcast_to(x, shape) for x in function(*values)], axis=-1)

    return evaluate


def numbers(domain: Sequence[Sequence[Any]]) -> list[list[float]]:
    """Return a domain whose ends may be expressions as floats; raise InputError if it is none."""
    try:
        return [[float(as_expression(end, {})) for end in ends] for ends in domain]
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"domain must be ((u0, u1), (v0, v1)) in numbers, not {domain!r}."
        ) from None


def interval(domain: Sequence[Any]) -> list[float]:
    """Return the ends of an interval, which may be expressions, as floats; InputError if not."""
    try:
        return [float(as_expression(end, {})) for end in domain]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"domain must be (t0, t1) in numbers, not {domain!r}.") from None


def _coordinates(position: Sequence[Any], parameters: int) -> tuple[Any, ...]:
    """Return the coordinates, one more than there are parameters."""
    names = "(x, y, z)" if parameters == 2 else "(x, y)"
    try:
        coordinates = () if isinstance(position, str) else tuple(position)
    except TypeError:
        coordinates = ()
    if len(coordinates) != parameters + 1:
        number = "three" if parameters == 2 else "two"
        raise InputError(f"position must be {number} SymPy expressions {names}, not {position!r}.")
    return coordinates


def two_symbols(parameters: Sequence[Any]) -> list[sympy.Symbol]:
    """Return the parameters of a surface, symbols or their names; InputError if they are not."""
    try:
        u, v = (_symbol(x) for x in parameters)
    except (TypeError, ValueError):
        u = v = None
    if u is None or v is None or u.name == v.name:
        raise InputError(f"parameters must be two SymPy symbols (u, v), not {parameters!r}.")
    return [u, v]


def one_symbol(parameter: sympy.Symbol | str) -> list[sympy.Symbol]:
    """Return the parameter of a curve, a symbol or its name; InputError if it is not."""
    symbol = _symbol(parameter)
    if symbol is None:
        raise InputError(f"the parameter must be a SymPy symbol such as t, not {parameter!r}.")
    return [symbol]


def _symbol(entry: object) -> sympy.Symbol | None:
    import sympy as sp

    if isinstance(entry, str) and entry.isidentifier():
        return sp.Symbol(entry)
    return entry if isinstance(entry, sp.Symbol) else None


def as_expression(entry: Any, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return an expression or the one that a text stands for, in which `symbols` come first."""
    import sympy as sp

    sympify: Any = sp.sympify  # its type hints forget `locals`
    expression = None
    if not isinstance(entry, str) or _is_mathematics(entry):
        with suppress(Exception):  # SymPy runs the text as Python, which may raise anything
            expression = sympify(entry, locals=symbols)
    if not isinstance(expression, sp.Expr):
        raise InputError(f"{entry!r} is not a SymPy expression.")
    return expression


# What a text may hold besides names, numbers and calls of functions by their names.
_SYNTAX = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.Tuple, ast.Load,
    ast.operator, ast.unaryop, ast.boolop, ast.cmpop,
)  # fmt: skip


def _is_mathematics(text: str) -> bool:
    """Say whether a text is arithmetic with SymPy's functions: SymPy would run any Python."""
    import sympy as sp

    def is_harmless(node: ast.AST) -> bool:
        if isinstance(node, ast.Call):
            name = node.func.id if isinstance(node.func, ast.Name) else ""
            function = getattr(sp, name, None)
            known = isinstance(function, type) and issubclass(function, sp.Basic)
            unknown = name != "" and not hasattr(sp, name) and not hasattr(builtins, name)
            known = known or hasattr(sp.functions, name) or name == "abs"
            return (known or unknown) and not node.keywords
        if isinstance(node, ast.Constant):
            return isinstance(node.value, int | float | complex)
        return isinstance(node, (ast.Name, *_SYNTAX))

    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError):
        return False
    return all(map(is_harmless, ast.walk(tree)))
