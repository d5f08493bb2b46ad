"""One law for several pieces: the same target density on all, and a count divided among them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.errors import SurfaceError
from ..base.tolerances import FLAT_SURFACE
from ..place.on_spline import OnSpline
from ..samples.request import BY_CURVATURE, Request
from ..spline.developable import curved_solid_angle
from .filling import FLAT_SHARE, GREEDY, SAVED, WIDER, WIDEST_GAP, spacing
from .sizing import SizingFunction, TargetDensity

__all__ = ["Law", "allotted"]

Array = NDArray[np.float64]

# A piece with a smaller part of the area of all is no surface, and gets no samples.
NO_AREA = 1e-12
BISECTIONS = 60


@dataclass(frozen=True, eq=False)
class Law:
    """The target density of all pieces, and how many samples each of them is to have.

    Numbers are in the unit L of the surface, in which the pieces are.
    """

    parts: Sequence[OnSpline]
    request: Request

    @cached_property
    def areas(self) -> Array:
        """The areas of the pieces, inside their trims; 0 for those that have none.

        Raises SurfaceError if all have none.
        """
        areas = np.array([area_of(x) for x in self._sizings])
        areas[areas <= NO_AREA * areas.sum()] = 0.0
        if not areas.any():
            raise SurfaceError(
                f"surface {self.parts[0].name!r} and the other pieces have no area beyond "
                "rounding, or their trim leaves nothing of them."
            )
        return areas

    @cached_property
    def floor(self) -> float:
        """The floor of the target density: that of a surface made of all pieces."""
        total, area = float(self._integrals(0.0).sum()), float(self.areas.sum())
        if self.request.density in BY_CURVATURE:
            absolute = self.request.normals is not None or self.request.angle is not None
            return FLAT_SHARE * max(total, 4 * math.pi if absolute else FLAT_SURFACE) / area
        return total / area / WIDEST_GAP**2

    def counts(self, count: int, least: NDArray[np.int64] | None = None) -> NDArray[np.int64]:
        """Divide a count among the pieces, by what they need.

        Each gets at least `least`, by default 1 if it has an area, where the count is large enough.
        """
        if least is None:
            least = (self.areas > 0.0).astype(np.int64) * (self.request.density != "gauss")
        needs = self._needs(count)
        return allotted(count, needs if needs.any() else self.areas, least)

    def _needs(self, count: int) -> Array:
        """Return numbers that are proportional to the samples of the pieces."""
        if self.request.density not in ("gauss", *BY_CURVATURE):
            return self._integrals(self.floor)
        seen = np.zeros(len(self.parts))
        for k in np.flatnonzero(self.areas).tolist():
            seen[k] = self._seen(self.parts[k], count)
        if self.request.density == "gauss":
            return seen
        filling = self._integrals(self.floor) / (GREEDY * (WIDER * spacing(1.0)) ** 2)
        return seen + np.maximum(filling - SAVED * seen, 0.0)

    def _integrals(self, floor: float) -> Array:
        """Return the integrals of the target density over the pieces, with a floor."""
        order, values = self._order, floor * self.areas
        for k in np.flatnonzero(self.areas).tolist():
            sizing = self._sizings[k]
            if self._by_power and self._seen(sizing.geometry, 0) == 0.0:
                continue  # its curvature is rounding
            with_floor = sizing.with_floor(max(floor / sizing.unit**order, sizing.target.floor))
            values[k] = with_floor.integral * sizing.unit ** (order - 2.0)
        return values

    @staticmethod
    def _seen(part: OnSpline, count: int) -> float:
        return curved_solid_angle(part, count / (4 * math.pi))

    @property
    def _by_power(self) -> bool:
        return not isinstance(self.request.density, str)

    @property
    def _order(self) -> float:
        """The dimension of the target density, as a power of 1/L."""
        if self._by_power:
            return 2.0 * float(self.request.density)
        return 2.0 if self.request.density in BY_CURVATURE else 0.0

    @cached_property
    def _sizings(self) -> tuple[SizingFunction, ...]:
        """The sizing functions of the pieces, without the floor of the law."""
        target = TargetDensity(floor=1.0)
        if self._by_power:
            target = TargetDensity(gauss_weight=1.0, exponent=float(self.request.density))
        elif self.request.density in BY_CURVATURE:
            target = TargetDensity(curvature_weight=1.0)
        return tuple(SizingFunction(x, target) for x in self.parts)


def area_of(sizing: SizingFunction) -> float:
    """Return the area of a piece; 0 if it is rounding, or if the trim leaves nothing."""
    try:
        area = sizing.area
    except SurfaceError:
        return 0.0
    return area / sizing.unit**2 if area > sizing.size * sizing.noise else 0.0


def allotted(count: int, needs: Array, least: NDArray[np.int64]) -> NDArray[np.int64]:
    """Divide a count in proportion to needs (k,), but so that each part is at least `least`.

    If the count is too small for that, it is divided in proportion to `least`, or to the needs if
    that is one for each. Of the fractions of parts, the largest are rounded up.
    """
    if least.sum() > count:
        weights = needs * (least > 0) if least.max() == 1 else least.astype(np.float64)
        shares = weights * (count / weights.sum())
    else:
        low, high = 0.0, count / float(needs.sum())
        for _ in range(BISECTIONS):
            factor = (low + high) / 2
            enough = np.maximum(least, factor * needs).sum() > count
            low, high = (low, factor) if enough else (factor, high)
        shares = np.maximum(least, low * needs)
    parts = np.floor(shares).astype(np.int64)
    largest = np.argsort(parts - shares, kind="stable")
    parts[largest[: count - int(parts.sum())]] += 1
    return parts
