"""What support functions make simple (paper, Sect. 2): convolution, offset, motions, scaling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...generated import support as kernels
from ..sphere import as_normals
from .branches import Sheets, curvatures
from .sources import Source

if TYPE_CHECKING:
    import sympy

__all__ = ["Offset", "Reversed", "Rotated", "Scaled", "Sum", "Translated"]

Vector = NDArray[np.float64]


# A radius of curvature is 0 up to rounding if it is this small beside the other and the distance.
RADIUS_ERROR = 2.0**-46


@dataclass(frozen=True, eq=False)
class Sum:
    """h₁ + h₂, the convolution of two surfaces: x₁ + x₂ for any two points with one normal."""

    first: Source
    second: Source

    def sheets(self, normals: Vector) -> Sheets:
        """Return all pairs of branches of each normal; by (7) points and Hessians add."""
        one, two = self.first.sheets(normals), self.second.sheets(normals)
        i, j = _pairs(one.normal_index, two.normal_index, len(normals))
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
class Offset:
    """h + d |n|: the points x + d n."""

    of: Source
    distance: float

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches; both radii grow by d."""
        sheets = self.of.sheets(normals)
        mine = normals[sheets.normal_index]
        kernels.add_offset(
            self.distance, mine, sheets.points, sheets.hessian, sheets.gaussian, sheets.mean
        )
        # Where a radius was 0, the old curvatures say nothing of the new ones; where one becomes 0,
        # they say it with the rounding of 1 + 2 H d + K d².
        radii, gaussian, mean = curvatures(mine, sheets.hessian)
        sizes = np.abs(radii)
        vanishing = sizes.min(axis=1) <= RADIUS_ERROR * (sizes.max(axis=1) + abs(self.distance))
        singular = ~np.isfinite(sheets.gaussian) | vanishing
        sheets.gaussian[singular], sheets.mean[singular] = gaussian[singular], mean[singular]
        return sheets

    def expression(self) -> sympy.Expr | None:
        """Return the expression on the unit sphere."""
        return _changed(self.of.expression(), lambda h, n: h + _exact(self.distance) * _length(n))

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the domain of the surface."""
        return self.of.domain()

    def __str__(self) -> str:
        return f"({self.of}) offset by {self.distance:g}"


@dataclass(frozen=True, eq=False)
class Translated:
    """h + n·t: the points x + t."""

    of: Source
    shift: Vector

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches; only the points change."""
        sheets = self.of.sheets(normals)
        return replace(sheets, points=sheets.points + self.shift)

    def expression(self) -> sympy.Expr | None:
        """Return the expression."""
        shift = [_exact(t) for t in self.shift.tolist()]
        return _changed(
            self.of.expression(),
            lambda h, n: sum((s * t for s, t in zip(n, shift, strict=True)), start=h),
        )

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the domain of the surface."""
        return self.of.domain()

    def __str__(self) -> str:
        return f"({self.of}) translated by {tuple(self.shift.tolist())}"


@dataclass(frozen=True, eq=False)
class Rotated:
    """h(Rᵀn): the points R x."""

    of: Source
    rotation: Vector

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches at Rᵀn, rotated."""
        sheets = self.of.sheets(as_normals(normals @ self.rotation))
        R = self.rotation
        return replace(sheets, points=sheets.points @ R.T, hessian=R @ sheets.hessian @ R.T)

    def expression(self) -> sympy.Expr | None:
        """Return the expression."""
        return _changed(self.of.expression(), lambda h, n: _at(h, n, self._back(n)))

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the domain, rotated."""
        return _changed(self.of.domain(), lambda domain, n: _at(domain, n, self._back(n)))

    def _back(self, n: Sequence[Any]) -> list[Any]:
        columns = self.rotation.T.tolist()
        return [sum(_exact(c) * s for c, s in zip(column, n, strict=True)) for column in columns]

    def __str__(self) -> str:
        return f"({self.of}) rotated"


@dataclass(frozen=True, eq=False)
class Scaled:
    """s h: the points s x, with the same normals also for s < 0."""

    of: Source
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

    def expression(self) -> sympy.Expr | None:
        """Return the expression."""
        return _changed(self.of.expression(), lambda h, n: _exact(self.factor) * h)

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the domain of the surface."""
        return self.of.domain()

    def __str__(self) -> str:
        return f"({self.of}) scaled by {self.factor:g}"


@dataclass(frozen=True, eq=False)
class Reversed:
    """−h(−n): the same points with the opposite normals."""

    of: Source

    def sheets(self, normals: Vector) -> Sheets:
        """Return the branches at −n; radii change their sign."""
        sheets = self.of.sheets(-normals)
        return replace(sheets, hessian=-sheets.hessian, mean=-sheets.mean)

    def expression(self) -> sympy.Expr | None:
        """Return the expression."""
        return _changed(self.of.expression(), lambda h, n: -_at(h, n, [-s for s in n]))

    def domain(self) -> Any:  # noqa: ANN401 - a Boolean of SymPy
        """Return the opposite domain."""
        return _changed(self.of.domain(), lambda domain, n: _at(domain, n, [-s for s in n]))

    def __str__(self) -> str:
        return f"({self.of}) reversed"


def _pairs(
    first: NDArray[np.int64], second: NDArray[np.int64], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the rows i, j of all pairs with first[i] == second[j]; both are ascending."""
    partners = np.bincount(second, minlength=count)
    starts = np.cumsum(partners) - partners
    repeats = partners[first]
    i = np.repeat(np.arange(len(first)), repeats)
    within = np.arange(len(i)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    return i, starts[first[i]] + within


def _changed(given: Any, change: Any) -> Any:  # noqa: ANN401 - SymPy is loaded here only
    """Return change(given, (n_x, n_y, n_z)), or None for None."""
    if given is None:
        return None
    from ...symbolic.patch import n

    return change(given, n.components)


def _at(given: Any, n: Sequence[Any], place: Sequence[Any]) -> Any:  # noqa: ANN401
    return given.subs(dict(zip(n, place, strict=True)), simultaneous=True)


def _exact(value: float) -> Any:  # noqa: ANN401
    """Return a whole number as an integer of SymPy, and another one as a float of it."""
    import sympy as sp

    return sp.Integer(int(value)) if value.is_integer() else sp.Float(value)


def _length(n: Sequence[Any]) -> Any:  # noqa: ANN401
    import sympy as sp

    return sp.sqrt(sum(s**2 for s in n))
