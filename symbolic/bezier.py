"""One quadratic Bézier triangle, given by numbers or symbols, and everything derived from it."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from itertools import combinations_with_replacement
from typing import Any, cast

import sympy as sp

from .formula import Formula, dot, flat, scalar, substitute
from .patch import (
    CLOSED_CURVATURE,
    FORMS,
    NET,
    ORIENTATION,
    POWER_FORM,
    SUPPORT_FUNCTION,
    n,
    u,
    v,
)

__all__ = ["BezierTriangle"]


class BezierTriangle:
    """A quadratic Bézier triangle (10) with exact control points.

    `control_points` are six points of three coordinates in the order b200, b020, b002, b110, b101,
    b011; u belongs to b200, v to b020. Coordinates are numbers, SymPy expressions, or strings of
    these. A float is taken at its exact binary value, a string such as "0.1" at its decimal one.

    Results are expressions in the components of `normal`, which need not have length 1. Those that
    need the support function raise ValueError if the patch has none, because it is developable.
    """

    def __init__(self, control_points: Iterable[Iterable[object]]) -> None:
        """Raise ValueError unless there are six points of three real coordinates."""
        rows = [[_exact(x) for x in point] for point in _six_points(control_points)]
        self.control_points = tuple(sp.ImmutableMatrix(row) for row in rows)
        net = dict(zip(flat(NET), (x for row in rows for x in row), strict=True))
        self._values = {
            scalar(name): substitute(x, net) for name, x in POWER_FORM.expanded().items()
        }

    @property
    def normal(self) -> tuple[sp.Symbol, sp.Symbol, sp.Symbol]:
        """The symbols n_x, n_y, n_z."""
        x, y, z = n.components
        return x, y, z

    def evaluate(self, formula: Formula) -> dict[str, sp.Expr]:
        """Return the outputs of a formula for this patch; inputs but a … e, p stay symbols."""
        return {name: substitute(x, self._values) for name, x in formula.expanded().items()}

    @cached_property
    def forms(self) -> dict[str, sp.Expr]:
        """The quadratic forms D, U, V, W."""
        return {name: sp.expand(form) for name, form in self.evaluate(FORMS).items()}

    @cached_property
    def parameters(self) -> tuple[sp.Expr, sp.Expr]:
        """The parameters u(n), v(n)."""
        self._require_support_function()
        u_of_n, v_of_n = (sp.cancel(self.forms[x] / self.forms["D"]) for x in "UV")
        return u_of_n, v_of_n

    @cached_property
    def support_function(self) -> sp.Expr:
        """The support function h(n): cubic over quadratic, as in formula (12)."""
        self._require_support_function()
        return sp.cancel(self.evaluate(SUPPORT_FUNCTION)["h"])

    @cached_property
    def gradient(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The gradient of the support function: the envelope point."""
        x, y, z = (sp.cancel(sp.diff(self.support_function, by)) for by in self.normal)
        return x, y, z

    @cached_property
    def hessian(self) -> sp.ImmutableMatrix:
        """The Hessian of the support function."""
        entries = {
            (i, j): sp.cancel(sp.diff(self.gradient[i], self.normal[j]))
            for i, j in combinations_with_replacement(range(3), 2)
        }
        return sp.ImmutableMatrix(3, 3, lambda i, j: entries[min(i, j), max(i, j)])

    @cached_property
    def orientation(self) -> sp.Expr:
        """The cubic form c3(n): n is the oriented normal where it is positive."""
        return sp.expand(self.evaluate(ORIENTATION)["c3_twice"] / 2)

    @cached_property
    def gaussian_curvature(self) -> sp.Expr:
        """The Gaussian curvature K(n); ValueError if no point of the patch is regular."""
        self._require_support_function()
        if self.orientation == 0:
            raise ValueError("the patch has no regular point (c3 = 0)")
        values = {scalar("D"): self.forms["D"], scalar("c3_twice"): 2 * self.orientation}
        return sp.cancel(substitute(CLOSED_CURVATURE.expanded()["K"], values))

    @cached_property
    def mean_curvature(self) -> sp.Expr:
        """The mean curvature at the point with the oriented normal n."""
        return sp.cancel(self._trace * self.gaussian_curvature) * self._length / 2

    @cached_property
    def principal_radii(self) -> tuple[sp.Expr, sp.Expr]:
        """The signed principal radii of curvature, the larger one first."""
        half_sum = self._trace * self._length / 2
        root = sp.sqrt(half_sum**2 - 1 / self.gaussian_curvature)
        return half_sum + root, half_sum - root

    @cached_property
    def boundary_cones(self) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
        """The symmetric matrices M of the cones nᵀMn = 0 that bound the Gaussian image: U, V, W."""
        u_cone, v_cone, w_cone = (sp.hessian(self.forms[name], self.normal) / 2 for name in "UVW")
        return u_cone, v_cone, w_cone

    def _require_support_function(self) -> None:
        if self.forms["D"] == 0:
            raise ValueError("the patch is developable (D = 0): it has no support function")

    @cached_property
    def _trace(self) -> sp.Expr:
        return cast(sp.Expr, sp.cancel(self.hessian.trace()))

    @property
    def _length(self) -> sp.Expr:
        return sp.sqrt(dot(n.column, n.column))


def _six_points(control_points: Iterable[Iterable[object]]) -> list[list[object]]:
    """Return the coordinates of six points; ValueError unless they are six times three."""
    try:
        points = [[] if isinstance(point, str) else list(point) for point in control_points]
    except TypeError:
        points = []
    if [len(point) for point in points] != [3] * 6:
        raise ValueError("control_points must be six points of three coordinates each")
    return points


def _exact(value: object) -> sp.Expr:
    """Return a coordinate as SymPy sees it, without floating-point numbers.

    Raises ValueError unless it is real and finite (or a symbol) and leaves n, u, v alone.
    """
    expression = cast(Any, sp.sympify)(value, rational=isinstance(value, str))
    if not isinstance(expression, sp.Expr) or expression.is_Matrix:
        raise ValueError(f"{value!r} is not a coordinate")
    expression = substitute(expression, {x: sp.Rational(x) for x in expression.atoms(sp.Float)})
    if expression.is_real is False or expression.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        raise ValueError(f"the coordinate {value!r} is not a real number")
    if reserved := expression.free_symbols & {*n.components, u, v}:
        raise ValueError(f"the coordinate {value!r} uses {sorted(map(str, reserved))}")
    return expression
