"""How dense samples are wanted at a place of a surface, from its curvature there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...generated.spline import SCALE
from ..kernels.sizing import TargetDensity as Law
from ..kernels.sizing import integrate_density
from ..spline import Spline
from ..threads import over_ranges

__all__ = ["Law", "Wanted"]

Array = NDArray[np.float64]

PATCHES_AT_A_TIME = 1 << 12


@dataclass(frozen=True, eq=False)
class Wanted:
    """A law on a spline: what it asks of each patch.

    Lengths and curvatures are those of the spline times `unit`, which brings them to about 1.
    """

    spline: Spline
    law: Law
    threads: int | None = None

    @property
    def unit(self) -> float:
        """How long one length of the spline is here."""
        return SCALE * self.spline.scale

    def places(self, points: NDArray[np.floating]) -> Array:
        """Return points of the surface (N, 3) relative to the first coefficient, times `unit`."""
        return (points.astype(np.float64) - self.spline.coefficients[0, 0]) * self.unit

    @property
    def size(self) -> float:
        """A length that no two points of the surface are apart."""
        points = self.spline.coefficients.reshape(-1, 3)
        return float(np.linalg.norm(np.ptp(points, axis=0))) * self.unit

    @property
    def noise(self) -> float:
        """The rounding of the coordinates."""
        return SCALE * self.spline.noise

    @property
    def reaches(self) -> Array:
        """How far the points of each patch (patches,) are from its middle, at most."""
        return self._patches[0]

    @cached_property
    def areas(self) -> Array:
        """The areas of the patches (patches,)."""
        return np.add.reduce(list(self._patches[1].T))

    @property
    def area(self) -> float:
        """The area of the surface."""
        return float(self.areas.sum())

    @property
    def total(self) -> float:
        """The integral of what is wanted over the surface."""
        _, areas, weights = self._patches
        return float((areas * np.maximum(weights[:, :3], self.law.floor)).sum())

    @cached_property
    def largest(self) -> Array:
        """What is wanted of each patch (patches,), where that is most."""
        return np.maximum.reduce(list(self._patches[2].T), initial=self.law.floor)

    def with_floor(self, floor: float) -> Wanted:
        """Return the same with another floor."""
        wanted = replace(self, law=self.law._replace(floor=floor))
        wanted.__dict__["_patches"] = self._patches  # which a floor is not in
        return wanted

    @cached_property
    def _patches(self) -> tuple[Array, Array, Array]:
        """Reaches (patches,), areas (patches, 3) and weights (patches, 4); see the kernel."""
        count, law = self.spline.patches, self.law._replace(floor=0.0)
        arrays = np.empty(count), np.empty((count, 3)), np.empty((count, 4))

        def work(first: int, last: int) -> None:
            integrate_density(
                self.spline.coefficients, self.spline.scale, law, first, last, *arrays
            )

        for _ in over_ranges(work, count, PATCHES_AT_A_TIME, self.threads):
            pass
        return arrays
