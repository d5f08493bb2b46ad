"""A support function that a user writes as h(n): compiled like gaussmap's own formulas."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .branches import Sheets, curvatures
from .errors import InputError
from .expressions import _expression

if TYPE_CHECKING:
    import sympy

__all__ = ["ExpressionSource"]


@dataclass(frozen=True, eq=False)
class ExpressionSource:
    """A support function h in the real symbols n_x, n_y, n_z, where `condition` holds.

    `source` is the Python source of its kernel.
    """

    h: sympy.Expr
    condition: Any
    source: str

    @classmethod
    def checked(cls, h: object, normal: Sequence[Any], domain: object) -> ExpressionSource:
        """Make one from what a user gives; InputError if it cannot be used."""
        from ..symbolic.expression import kernel_source

        symbols = _normal_symbols(normal)
        expression = _in_normal(_expression(h, symbols), symbols, "h")
        condition = _condition(domain, symbols)
        try:
            source = kernel_source(expression, condition)
        except (NotImplementedError, ValueError, TypeError, AttributeError) as error:
            reason = str(error).partition("\n")[0]
            raise InputError(f"h = {expression} cannot be compiled: {reason}") from error
        return cls(expression, condition, source)

    def sheets(self, normals: NDArray[np.float64]) -> Sheets:
        """Return the branch of each normal in the domain where h and its gradient are finite."""
        count = len(normals)
        inside = np.empty(count, dtype=np.bool_)
        points, hessian = np.empty((count, 3)), np.empty((count, 3, 3))
        self._evaluate(normals, inside, points, hessian)
        rows = np.flatnonzero(inside & np.isfinite(points).all(axis=1))
        points, hessian = points[rows], hessian[rows]
        _, gaussian, mean = curvatures(normals[rows], hessian)
        nowhere = np.full(len(rows), -1, dtype=np.int64)
        return Sheets(
            rows, points, hessian, gaussian, mean, nowhere, np.full((len(rows), 2), np.nan)
        )

    def expression(self) -> sympy.Expr:
        """Return h as it was given."""
        return self.h

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the condition that was given."""
        return self.condition

    def __str__(self) -> str:
        return f"h = {self.h}"

    @cached_property
    def _evaluate(self) -> Callable[..., None]:
        return _kernel(self.source)


@lru_cache(maxsize=128)
def _kernel(source: str) -> Callable[..., None]:
    """Compile a module that defines `evaluate`, once in a process."""
    namespace: dict[str, Any] = {}
    exec(compile(source, "<support function>", "exec"), namespace)
    return namespace["evaluate"]


def _normal_symbols(normal: Sequence[Any]) -> dict[str, Any]:
    """Return the symbols n_x, n_y, n_z by the names that the user has for them."""
    from ..symbolic.patch import n

    try:
        names = [x if isinstance(x, str) else x.name for x in normal]
    except (TypeError, AttributeError):
        names = []
    usable = all(isinstance(x, str) and x.isidentifier() for x in names)
    if len(names) != 3 or len(set(names)) != 3 or not usable:
        raise InputError(f"normal must be three symbols, or their names, not {normal!r}.")
    return dict(zip(names, n.components, strict=True))


def _in_normal(expression: Any, symbols: dict[str, Any], name: str) -> Any:  # noqa: ANN401
    """Write an expression in the real symbols n_x, n_y, n_z; InputError if there are others."""
    import sympy as sp

    if unknown := sorted({x.name for x in expression.free_symbols} - symbols.keys()):
        raise InputError(
            f"{name} holds symbols that are no component of the normal: {', '.join(unknown)}."
        )
    if expression.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise InputError(f"{name} is not finite: {expression}.")
    if expression.has(sp.I):
        raise InputError(f"{name} is not real: {expression}.")
    return expression.xreplace({x: symbols[x.name] for x in expression.free_symbols})


def _condition(domain: object, symbols: dict[str, Any]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a Boolean of SymPy from one, a text or None; InputError if it is none."""
    import sympy as sp
    from sympy.logic.boolalg import Boolean

    sympify: Any = sp.sympify
    try:
        condition = sympify(True if domain is None else domain, locals=symbols)
    except Exception:  # SymPy runs the text as Python, which may raise anything
        condition = None
    if not isinstance(condition, Boolean) or condition.is_Symbol:
        raise InputError(
            f"domain must be a condition such as 'n_z > 0' or '(n_x > 0) & (n_y > 0)', "
            f"not {domain!r}."
        )
    return _in_normal(condition, symbols, "domain")
