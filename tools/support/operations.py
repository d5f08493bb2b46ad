"""What support functions make simple (paper, Sect. 2): convolution, offset, motions, scaling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.bridge import normal_components
from ...runtime.base.tolerances import RADIUS_ERROR
from ...runtime.directions.unit import as_normals
from ..kernels import support as kernels
from .branches import Sheets, curvatures
from .sources import Source

if TYPE_CHECKING:
    import sympy

__all__ = ["Offset", "Reversed", "Rotated", "Scaled", "Sum", "Translated", "pairs"]

Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sum:
    """h₁ + h₂, the convolution of two surfaces: x₁ + x₂ for any two points with one normal."""

    first: Source
    second: Source

    def sheets(self, normals: Vector) -> Sheets:
        """Return all pairs of branches of each normal; by (7) points and Hessians add."""
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
        """Return where both are defined."""
        import sympy as sp

        first, second = self.first.domain(), self.second.domain()
        return None if first is None or second is None else sp.And(first, second)

    def __str__(self) -> str:
        return f"({self.first}) + ({self.second})"


@dataclass(frozen=True, eq=False)
class Changed:
    """What operations on one support function have in common: how they are written."""

    of: Source

    def expression(self) -> sympy.Expr | None:
        """Return the expression; None if that of the surface is none."""
        given = self.of.expression()
        return None if given is None else self._written(self._moved(given), normal_components())

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the domain; None if that of the surface is none."""
        given = self.of.domain()
        return None if given is None else self._moved(given)

    def _moved(self, given: Any) -> Any:  # noqa: ANN401
        """Return what is said of the normals of the surface, for those that they become."""
        return given

    def _written(self, h: Any, n: Sequence[Any]) -> Any:  # noqa: ANN401
        """Return the new expression, once the normal has moved."""
        return h


@dataclass(frozen=True, eq=False)
class Offset(Changed):
    """h + d |n|: the points x + d n."""

    distance: float

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches; both radii grow by d."""
        sheets = self.of.sheets(normals)
        mine = normals[sheets.normal_index]
        doubtful = np.empty(len(mine), dtype=np.bool_)
        # Of large surfaces float64 does not hold K, about the square of H.
        squares = np.maximum(np.abs(sheets.gaussian), sheets.mean * sheets.mean)
        lost = (squares < np.finfo(np.float64).tiny) & (sheets.mean != 0.0)
        kernels.add_offset(
            self.distance, mine, sheets.points, sheets.hessian, sheets.gaussian, sheets.mean,
            doubtful,
        )  # fmt: skip
        # Where a radius was 0, the old curvatures say nothing of the new ones; where one becomes 0,
        # they say it with the rounding of 1 + 2 H d + K d².
        rows = np.flatnonzero(doubtful | lost)
        radii, gaussian, mean = curvatures(mine[rows], sheets.hessian[rows])
        sizes = np.abs(radii)
        vanishing = sizes.min(axis=1) <= RADIUS_ERROR * (sizes.max(axis=1) + abs(self.distance))
        singular = ~np.isfinite(sheets.gaussian[rows]) | vanishing | lost[rows]
        sheets.gaussian[rows[singular]] = gaussian[singular]
        sheets.mean[rows[singular]] = mean[singular]
        return sheets

    def __str__(self) -> str:
        return f"({self.of}) offset by {self.distance:g}"

    def _written(self, h: Any, n: Sequence[Any]) -> Any:  # noqa: ANN401
        return h + _exact(self.distance) * _length(n)


@dataclass(frozen=True, eq=False)
class Translated(Changed):
    """h + n·t: the points x + t."""

    shift: Vector

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches; only the points change."""
        sheets = self.of.sheets(normals)
        return replace(sheets, points=sheets.points + self.shift)

    def __str__(self) -> str:
        return f"({self.of}) translated by {tuple(self.shift.tolist())}"

    def _written(self, h: Any, n: Sequence[Any]) -> Any:  # noqa: ANN401
        return sum((s * _exact(t) for s, t in zip(n, self.shift.tolist(), strict=True)), start=h)


@dataclass(frozen=True, eq=False)
class Rotated(Changed):
    """h(Rᵀn): the points R x."""

    rotation: Vector

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches at Rᵀn, rotated."""
        sheets = self.of.sheets(as_normals(normals @ self.rotation))
        R = self.rotation
        return replace(sheets, points=sheets.points @ R.T, hessian=R @ sheets.hessian @ R.T)

    def __str__(self) -> str:
        return f"({self.of}) rotated"

    def _moved(self, given: Any) -> Any:  # noqa: ANN401
        n, columns = normal_components(), self.rotation.T.tolist()
        back = [sum(_exact(c) * s for c, s in zip(column, n, strict=True)) for column in columns]
        return _at(given, n, back)


@dataclass(frozen=True, eq=False)
class Scaled(Changed):
    """s h: the points s x, with the same normals also for s < 0."""

    factor: float

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches; radii are multiplied by s."""
        sheets, s = self.of.sheets(normals), self.factor
        return replace(
            sheets,
            points=s * sheets.points,
            hessian=s * sheets.hessian,
            gaussian=sheets.gaussian / s / s,
            mean=sheets.mean / s,
        )

    def __str__(self) -> str:
        return f"({self.of}) scaled by {self.factor:g}"

    def _written(self, h: Any, n: Sequence[Any]) -> Any:  # noqa: ANN401
        return _exact(self.factor) * h


@dataclass(frozen=True, eq=False)
class Reversed(Changed):
    """−h(−n): the same points with the opposite normals."""

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches at −n; radii change their sign."""
        sheets = self.of.sheets(-normals)
        return replace(sheets, hessian=-sheets.hessian, mean=-sheets.mean)

    def __str__(self) -> str:
        return f"({self.of}) reversed"

    def _moved(self, given: Any) -> Any:  # noqa: ANN401
        n = normal_components()
        return _at(given, n, [-s for s in n])

    def _written(self, h: Any, n: Sequence[Any]) -> Any:  # noqa: ANN401
        return -h


def pairs(
    first: NDArray[np.int64], second: NDArray[np.int64], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows i, j of all pairs with first[i] == second[j]; both are ascending."""
    partners = np.bincount(second, minlength=count)
    starts = np.cumsum(partners) - partners
    repeats = partners[first]
    i = np.repeat(np.arange(len(first)), repeats)
    within = np.arange(len(i)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    return i, starts[first[i]] + within


def _at(given: Any, n: Sequence[Any], place: Sequence[Any]) -> Any:  # noqa: ANN401
    return given.subs(dict(zip(n, place, strict=True)), simultaneous=True)


def _exact(value: float) -> Any:  # noqa: ANN401
    """Return a whole number as an integer of SymPy, and another one as a float of it."""
    import sympy as sp

    return sp.Integer(int(value)) if value.is_integer() else sp.Float(value)


def _length(n: Sequence[Any]) -> Any:  # noqa: ANN401
    import sympy as sp

    return sp.sqrt(sum(s**2 for s in n))
