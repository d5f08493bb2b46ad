"""How dense samples are wanted at a place of a surface, from its curvature there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels
from ..spline import Spline
from ..threads import over_ranges

__all__ = ["Law", "Wanted"]

PATCHES_AT_A_TIME = 1 << 12


@dataclass(frozen=True)
class Law:
    """Samples per area, up to a factor: bend κ² + power |K|^α, but no less than a floor.

    κ is the larger principal curvature, in modulus. Curvatures are those of the surface times its
    `unit` (see `Wanted`).
    """

    floor: float = 0.0
    bend: float = 0.0
    power: float = 0.0
    alpha: float = 1.0

    @property
    def numbers(self) -> NDArray[np.float64]:
        """The law as kernels take it."""
        return np.array([self.floor, self.bend, self.power, self.alpha])


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
        return kernels.SCALE * self.spline.scale

    @cached_property
    def reaches(self) -> NDArray[np.float64]:
        """How far the points of each patch (patches,) are from its middle, at most."""
        reaches = np.empty(self.spline.patches)

        def work(first: int, last: int) -> None:
            spline = self.spline
            kernels.reach_of_patches(spline.coefficients, spline.scale, first, last, reaches)

        return self._filled(work, reaches)

    @cached_property
    def totals(self) -> tuple[float, float]:
        """The area of the surface, and the integral of what is wanted over it."""
        both = np.empty((2, self.spline.patches))

        def work(first: int, last: int) -> None:
            kernels.wanted_of_patches(
                self.spline.coefficients, self.spline.scale, self.reaches, self.law.numbers,
                first, last, *both,
            )  # fmt: skip

        area, total = self._filled(work, both).sum(axis=1).tolist()
        return area, total

    def triangles(self) -> NDArray[np.float64]:
        """Return the patches as triangles (patches, 5) that nothing covers; see the kernel."""
        triangles = np.empty((self.spline.patches, 5))

        def work(first: int, last: int) -> None:
            kernels.start_triangles(
                self.spline.coefficients, self.spline.scale, self.reaches, self.law.numbers,
                first, last, triangles,
            )  # fmt: skip

        return self._filled(work, triangles)

    def with_floor(self, floor: float) -> Wanted:
        """Return the same with another floor."""
        return self.with_law(replace(self.law, floor=floor))

    def with_law(self, law: Law) -> Wanted:
        """Return another law on the same spline."""
        wanted = replace(self, law=law)
        wanted.__dict__["reaches"] = self.reaches  # which no law changes
        return wanted

    def _filled(
        self, work: Callable[[int, int], None], array: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        for _ in over_ranges(work, self.spline.patches, PATCHES_AT_A_TIME, self.threads):
            pass
        return array
