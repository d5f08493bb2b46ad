"""Functions that use `gaussmap.symbolic`; each of them loads SymPy when it is called.

No other module of the runtime imports `gaussmap.symbolic`, so that sampling never waits for SymPy.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...symbolic import BezierTriangle, Formula


def array_function(expression: Any, condition: Any = True) -> str:  # noqa: ANN401
    """Return the Python source that evaluates a support function; see `symbolic.expression`."""
    from ...symbolic.expression import array_function

    return array_function(expression, condition)


def bezier_triangle(control_points: Sequence[Sequence[Any]]) -> BezierTriangle:
    """Return the quadratic patch of exact control points (6, 3)."""
    from ...symbolic import BezierTriangle

    return BezierTriangle(control_points, normal_components())


def formulas() -> Mapping[str, Formula]:
    """Return all formulas by their names."""
    from ...symbolic import formulas

    return formulas


def latex_of(expression: Any) -> str:  # noqa: ANN401
    """Return an expression as LaTeX."""
    from ...symbolic.display import latex_of

    return latex_of(expression)


def normal_components() -> tuple[Any, ...]:
    """Return the symbols n_x, n_y, n_z."""
    from ...symbolic.envelope import n

    return n.components


def reading() -> ModuleType:
    """Return the module that reads the texts of users, `symbolic.reading`."""
    from ...symbolic import reading

    return reading


def tape_steps(
    position: Sequence[Any], symbols: Sequence[Any]
) -> tuple[list[Any], list[int]] | None:
    """Return the tape of three expressions in two symbols; None if tapes lack an operation.

    See `symbolic.tape`.
    """
    from ...symbolic.tape import NoTapeError, tape_steps

    try:
        return tape_steps(position, *symbols)
    except NoTapeError:
        return None
