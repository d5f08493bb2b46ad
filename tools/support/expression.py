"""A support function given as an expression h(n): parsing, derivatives and evaluation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base import bridge
from ...runtime.base.errors import InputError, clipped, shown
from ...runtime.surface.expressions import as_condition, as_expression
from .branches import Sheets, curvatures

if TYPE_CHECKING:
    import sympy

# The number of normals evaluated at a time, so that intermediate results stay in the cache.
AT_A_TIME = 1 << 13
# The order in which a compiled function returns the entries of a Hessian.
ENTRIES = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)


@dataclass(frozen=True, eq=False)
class ExpressionSource:
    """A support function h in the real symbols n_x, n_y, n_z, where `condition` holds.

    `source` is the Python source of a function of NumPy, as `symbolic.expression` writes it.
    """

    h: sympy.Expr
    condition: Any
    source: str

    @classmethod
    def checked(cls, h: object, normal: Sequence[Any], domain: object) -> ExpressionSource:
        """Return a source made from a user's arguments; InputError if they are invalid."""
        names = _names(normal)
        expression = _in_normal(as_expression(h, _symbols(names)), names, "h")
        condition = _condition(domain, names)
        if not bridge.reading().is_differentiable([expression]):
            raise InputError(
                f"h = {_short(expression)} is too long, or nested too deeply, to be differentiated."
            )
        try:
            source = bridge.array_function(expression, condition)
            compile(source, "<support function>", "exec")
        except (RecursionError, MemoryError, SyntaxError):  # SyntaxError: too many brackets
            raise InputError(
                f"h = {_short(expression)} is nested too deeply to be compiled."
            ) from None
        except (NotImplementedError, ValueError, TypeError, AttributeError) as error:
            raise InputError(
                f"h = {_short(expression)} cannot be compiled: {_culprits(expression, condition)}, "
                "which kernels cannot compute."
            ) from error
        return cls(expression, condition, source)

    def sheets(self, normals: NDArray[np.float64]) -> Sheets:
        """Return one branch for each normal in the domain where h and its gradient are finite."""
        count = len(normals)
        inside = np.empty(count, dtype=np.bool_)
        points, hessian = np.empty((count, 3)), np.empty((count, 3, 3))
        for first in range(0, count, AT_A_TIME):
            rows = slice(first, first + AT_A_TIME)
            with np.errstate(all="ignore"):
                inside[rows], *found = _function(self.source)(*normals[rows].T)
            for k, values in enumerate(found[:3]):
                points[rows, k] = values
            for (i, j), values in zip(ENTRIES, found[3:], strict=True):
                hessian[rows, i, j] = hessian[rows, j, i] = values
        rows = np.flatnonzero(inside & np.isfinite(points).all(axis=1))
        points, hessian = points[rows], hessian[rows]
        _, gaussian, mean = curvatures(normals[rows], hessian)
        nowhere = np.full(len(rows), -1, dtype=np.int64)
        return Sheets(
            rows, points, hessian, gaussian, mean, nowhere, np.full((len(rows), 2), np.nan)
        )

    def expression(self) -> sympy.Expr:
        """Return h as given."""
        return self.h

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the condition as given."""
        return self.condition

    def splines(self) -> list[Any]:
        """Return an empty list: the expression is exact."""
        return []

    def __str__(self) -> str:
        return f"h = {_short(self.h)}"


@lru_cache(maxsize=128)
def _function(source: str) -> Callable[..., Any]:
    namespace: dict[str, Any] = {}
    exec(compile(source, "<support function>", "exec"), namespace)
    return namespace["evaluate"]


def _names(normal: Sequence[Any]) -> list[str]:
    """Return the names of the components of the normal; InputError unless they are three."""
    try:
        names = [x if isinstance(x, str) else x.name for x in islice(normal, 4)]
    except Exception:  # iteration may raise anything
        names = []
    usable = all(isinstance(x, str) and x.isidentifier() and not iskeyword(x) for x in names)
    if len(names) != 3 or len(set(names)) != 3 or not usable:
        raise InputError(f"normal must be three symbols, or their names, not {shown(normal)}.")
    return names


def _symbols(names: Sequence[str]) -> dict[str, Any]:
    """Return real symbols, by their names."""
    import sympy as sp

    return {name: sp.Symbol(name, real=True) for name in names}


def _in_normal(expression: Any, names: Sequence[str], what: str) -> Any:  # noqa: ANN401
    """Write an expression in the real symbols n_x, n_y, n_z; InputError for other symbols."""
    import sympy as sp

    if unknown := sorted({x.name for x in expression.free_symbols} - set(names)):
        raise InputError(
            f"{what} holds symbols that are no component of the normal: "
            f"{clipped(', '.join(unknown))}."
        )
    if expression.has(sp.I):
        raise InputError(f"{what} is not real: {_short(expression)}.")
    components = dict(zip(names, bridge.normal_components(), strict=True))
    return expression.xreplace({x: components[x.name] for x in expression.free_symbols})


def _condition(domain: object, names: Sequence[str]) -> Any:  # noqa: ANN401 - SymPy has no types
    """Return a Boolean of SymPy from a Boolean, a text or None; InputError for anything else."""
    if domain is None:
        domain = True
    try:
        condition = as_condition(domain, _symbols(names))
    except InputError as error:
        raise InputError(
            f"domain must be a condition such as 'n_z > 0' or '(n_x > 0) & (n_y > 0)': {error}"
        ) from None
    return _in_normal(condition, names, "domain")


def _culprits(*expressions: Any) -> str:  # noqa: ANN401 - SymPy has no types
    """Return a text: the user's functions that cannot be compiled or differentiated."""
    import sympy as sp

    def is_unusable(part: Any) -> bool:  # noqa: ANN401
        try:
            bridge.array_function(part)
        except (NotImplementedError, ValueError, TypeError, AttributeError):
            return True
        return False

    kinds = (sp.Function, sp.Integral, sp.Derivative, sp.Sum, sp.Product, sp.Limit)
    parts = {x for e in expressions for x in e.atoms(*kinds) if is_unusable(x)}
    inner = {x for x in parts if not any(y != x and x.has(y) for y in parts)}
    names = sorted({x.func.__name__ for x in inner})
    return f"it uses {', '.join(names)}" if names else "it or a derivative uses a function"


def _short(expression: object) -> str:
    try:
        return clipped(str(expression))
    except RecursionError:
        return "…"
