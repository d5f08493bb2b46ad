"""The sizing function: how far apart samples of a spline are to be, from its curvature."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...generated.spline import SCALE
from ..base.threads import over_ranges
from ..kernels.sizing import TargetDensity, integrate_density
from ..place.on_spline import OnSpline
from ..place.on_surface import OnSurface
from ..spline.spline import Spline
from ..surface.surface import Surface

__all__ = ["SizingFunction", "TargetDensity", "uniform"]

Array = NDArray[np.float64]

PATCHES_AT_A_TIME = 1 << 12


@dataclass(frozen=True, eq=False)
class SizingFunction:
    """A target density w on what is sampled, and its integrals over the patches.

    The sizing function is 1/√w: every point is to have a sample within r/√w, for a radius r that is
    the same everywhere. Lengths and curvatures are scaled: those of the spline times `unit`, which
    brings them to about 1.
    """

    geometry: OnSpline
    target: TargetDensity

    @property
    def spline(self) -> Spline:
        """The spline."""
        return self.geometry.spline

    @property
    def threads(self) -> int | None:
        """The number of threads."""
        return self.geometry.threads

    @property
    def unit(self) -> float:
        """The scaled length of a length 1 of the spline."""
        return SCALE * self.spline.scale

    def scaled_points(self, points: NDArray[np.floating]) -> Array:
        """Return scaled points (N, 3), relative to the first coefficient of the spline."""
        return (points.astype(np.float64) - self.spline.coefficients[0, 0]) * self.unit

    @property
    def size(self) -> float:
        """The diagonal of a box that holds the surface."""
        points = self.spline.coefficients.reshape(-1, 3)
        return float(np.linalg.norm(np.ptp(points, axis=0) * self.unit))

    @property
    def noise(self) -> float:
        """The rounding error of the coordinates."""
        return SCALE * self.spline.noise

    @property
    def radii(self) -> Array:
        """Radii (patches,) of balls around the images of the centroids that hold the patches."""
        return self._patches[0]

    @cached_property
    def areas(self) -> Array:
        """The areas of the patches (patches,)."""
        return np.add.reduce(list(self._patches[1].T))

    @property
    def area(self) -> float:
        """The area of the surface, of its part inside the trim if there is one."""
        inside = self.spline.inside
        return float((self.areas if inside is None else self.areas * inside.shares).sum())

    @property
    def integral(self) -> float:
        """The integral of the target density over the surface, or its part inside the trim."""
        _, areas, densities = self._patches
        if self.spline.inside is not None:
            areas = areas * self.spline.inside.shares[:, None]
        return float((areas * np.maximum(densities[:, :3], self.target.floor)).sum())

    @property
    def patch_integrals(self) -> Array:
        """The integrals (patches,) of the target density, without the floor, over the patches."""
        _, areas, densities = self._patches
        return np.add.reduce(list((areas * densities[:, :3]).T))

    @cached_property
    def largest(self) -> Array:
        """The largest target density found on each patch (patches,)."""
        return np.maximum.reduce(list(self._patches[2].T), initial=self.target.floor)

    def with_floor(self, floor: float) -> SizingFunction:
        """Return the sizing function of the same target density with another floor."""
        sizing = replace(self, target=self.target._replace(floor=floor))
        sizing.__dict__["_patches"] = self._patches  # the floor is not in them
        return sizing

    @cached_property
    def _patches(self) -> tuple[Array, Array, Array]:
        """The arrays of `integrate_density`, without the floor."""
        count, target = self.spline.patches, self.target._replace(floor=0.0)
        arrays = np.empty(count), np.empty((count, 3)), np.empty((count, 4))

        def work(first: int, last: int) -> None:
            integrate_density(
                self.spline.coefficients, self.spline.scale, target, first, last, *arrays
            )

        for _ in over_ranges(work, count, PATCHES_AT_A_TIME, self.threads):
            pass
        radii, areas, densities = arrays
        return radii, areas, self.geometry.densities(target, radii, densities)


def uniform(spline: Spline, surface: Surface | None, threads: int | None) -> SizingFunction:
    """Return the sizing function 1 of samples on a surface, or on a spline."""
    geometry = OnSpline(spline, threads)
    if surface is not None:
        geometry = OnSurface(spline, threads, surface)
    return SizingFunction(geometry, TargetDensity(floor=1.0))
