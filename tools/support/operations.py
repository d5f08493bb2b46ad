"""Operations on support functions (paper, Sect. 2): convolution, offset, motions, scaling."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...generated import support as formulas
from ...runtime.base.bridge import normal_components
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.repeats import repeated
from ...runtime.base.tolerances import RADIUS_ERROR
from ...runtime.directions.unit import as_normals
from ...runtime.spline.nets import AnySpline
from .branches import Sheets, curvatures
from .offset import size_of_terms
from .sources import Source

if TYPE_CHECKING:
    import sympy

Vector = NDArray[np.float64]

# A sum counts as affected by cancellation if it is smaller than its terms by this factor.
CANCELLED = math.ldexp(1.0, -20)


@dataclass(frozen=True, eq=False)
class Sum:
    """h₁ + h₂, the convolution of two surfaces: x₁ + x₂ for any two points with the same normal."""

    first: Source
    second: Source

    def sheets(self, normals: Vector) -> Sheets:
        """Return a branch for each pair of branches of a normal; by (7) points and Hessians add."""
        one, two = self.first.sheets(normals), self.second.sheets(normals)
        i, j = pairs(one.normal_index, two.normal_index, len(normals))
        rows, hessian = one.normal_index[i], one.hessian[i] + two.hessian[j]
        _, gaussian, mean = curvatures(normals[rows], hessian)
        patches, others = one.patch_index[i], two.patch_index[j]
        of_first, of_second = others < 0, patches < 0
        uv = np.where(of_second[:, None], two.uv[j], one.uv[i])
        uv[~(of_first | of_second)] = np.nan
        patch_index = np.where(of_second, others, np.where(of_first, patches, -1))
        return Sheets(rows, one.points[i] + two.points[j], hessian, gaussian, mean, patch_index, uv)

    def expression(self) -> sympy.Expr | None:
        """Return the sum of the expressions."""
        first, second = self.first.expression(), self.second.expression()
        return None if first is None or second is None else first + second  # pyright: ignore

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the condition under which both support functions are defined."""
        import sympy as sp

        first, second = self.first.domain(), self.second.domain()
        return None if first is None or second is None else sp.And(first, second)

    def splines(self) -> list[tuple[float, AnySpline]]:
        """Return the splines of both summands."""
        return self.first.splines() + self.second.splines()

    def __str__(self) -> str:
        return f"({self.first}) + ({self.second})"


@dataclass(frozen=True, eq=False)
class Moved:
    """The support function of the points s R x + t + d n: h becomes s h(Rᵀn) + n·t + d |n|.

    If `side` is −1, normals are reversed first: h(n) is then replaced by −h(−n). `text` describes
    the operation.
    """

    of: Source
    text: str
    rotation: Vector | None = None
    side: float = 1.0
    factor: float = 1.0
    shift: Vector = field(default_factory=partial(np.zeros, 3))
    distance: float = 0.0

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches of the moved surface.

        Radii are multiplied by `factor` and `side`, then increased by `distance`.
        """
        R, growth = self.rotation, self.side * self.factor
        turned = normals if R is None else as_normals(normals @ R)
        sheets = self.of.sheets(self.side * turned)
        points, hessian = sheets.points, growth * sheets.hessian
        if R is not None:
            points, hessian = points @ R.T, R @ hessian @ R.T
        gaussian, mean = sheets.gaussian / growth / growth, sheets.mean / growth
        points = self.factor * points + self.shift
        moved = replace(sheets, points=points, hessian=hessian, gaussian=gaussian, mean=mean)
        return _grown(moved, normals, self.distance) if self.distance else moved

    def expression(self) -> sympy.Expr | None:
        """Return the expression; None if the surface has none."""
        given = self.of.expression()
        if given is None:
            return None
        n = normal_components()
        h = _exact(self.side * self.factor) * self._at(given)
        h = sum((s * _exact(t) for s, t in zip(n, self.shift.tolist(), strict=True)), start=h)
        return h + _exact(self.distance) * _length(n)

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the domain; None if the surface has none."""
        given = self.of.domain()
        return None if given is None else self._at(given)

    def _at(self, given: Any) -> Any:  # noqa: ANN401
        """Return an expression of the surface in terms of the normal of the moved surface."""
        n, rows = normal_components(), self.side * np.eye(3)
        if self.rotation is not None:
            rows = rows @ self.rotation.T
        back = [sum(_exact(c) * s for c, s in zip(row, n, strict=True)) for row in rows.tolist()]
        return given.subs(dict(zip(n, back, strict=True)), simultaneous=True)

    def splines(self) -> list[tuple[float, AnySpline]]:
        """Return the splines with their factors."""
        return [(abs(self.factor) * factor, spline) for factor, spline in self.of.splines()]

    def __str__(self) -> str:
        return f"({self.of}) {self.text}"


def _grown(sheets: Sheets, normals: Vector, d: float) -> Sheets:
    """Return the branches of the points x + d n: both radii grow by d."""
    mine, (K, H) = normals[sheets.normal_index], (sheets.gaussian, sheets.mean)
    x, of_sphere = python_function(formulas.offset)(d, vector(mine))
    matrices = np.stack([of_sphere[k] for k in (0, 3, 4, 3, 1, 5, 4, 5, 2)], axis=1)
    hessian = sheets.hessian + matrices.reshape(-1, 3, 3)
    s, gaussian, mean = python_function(formulas.offset_curvature)(K, H, d)
    # Where a radius was 0, the old curvatures do not determine the new ones; where a radius becomes
    # 0, they do so only up to the rounding of 1 + 2 H d + K d². On large surfaces K, about the
    # square of H, underflows.
    lost = (np.maximum(np.abs(K), H * H) < np.finfo(np.float64).tiny) & (H != 0.0)
    rows = np.flatnonzero(lost | ~(np.abs(s) > CANCELLED * size_of_terms(K, H, d)))
    radii, *own = curvatures(mine[rows], hessian[rows])
    sizes = np.abs(radii)
    vanishing = sizes.min(axis=1) <= RADIUS_ERROR * (sizes.max(axis=1) + abs(d))
    singular = ~np.isfinite(gaussian[rows]) | vanishing | lost[rows]
    gaussian[rows[singular]], mean[rows[singular]] = (x[singular] for x in own)
    points = sheets.points + np.stack(x, axis=1)
    return replace(sheets, points=points, hessian=hessian, gaussian=gaussian, mean=mean)


def pairs(
    first: NDArray[np.int64], second: NDArray[np.int64], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows i, j of all pairs with first[i] == second[j]; both arrays are ascending."""
    partners = np.bincount(second, minlength=count)
    starts = np.cumsum(partners) - partners
    i, number = repeated(partners[first])
    return i, starts[first[i]] + number


def _exact(value: float) -> Any:  # noqa: ANN401
    """Return a whole number as an Integer of SymPy, and any other number as a Float."""
    import sympy as sp

    return sp.Integer(int(value)) if value.is_integer() else sp.Float(value)


def _length(n: Sequence[Any]) -> Any:  # noqa: ANN401
    import sympy as sp

    return sp.sqrt(sum(s**2 for s in n))
