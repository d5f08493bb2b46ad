"""The developable share of a surface (K ≈ 0), which no set of normals samples."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.aliases import Array, Flags
from ..domain.domain import widened

__all__ = ["CellMeasure"]

# Regions that 10,000 normals would sample count as curved, even with fewer normals.
LEAST_DENSITY = 10_000 / (4 * math.pi)


@dataclass(frozen=True, eq=False)
class CellMeasure:
    """The cells (m n,): areas, absolute solid angles of their images, and the largest |K| nearby.

    K of a cell is the sum of its signed solid angles divided by its area: the spline of a
    developable surface has elliptic and hyperbolic patches, whose solid angles cancel. This K also
    vanishes where K changes its sign, hence the maximum over the cell and its neighbours.
    """

    areas: Array
    solid_angles: Array
    curvatures: Array

    @classmethod
    def of(cls, measure: tuple[Array, Array], cells: tuple[int, int]) -> CellMeasure:
        """Return the measure of cells from areas and solid angles of the patches (4 m n,)."""
        areas, signed = (x.reshape(*cells, 4).sum(axis=2) for x in measure)
        with np.errstate(divide="ignore", invalid="ignore"):
            curvatures = np.where(areas > 0.0, np.abs(signed) / areas, 0.0)
        curvatures = widened(curvatures, "edge")
        solid_angles = np.abs(measure[1]).reshape(-1, 4).sum(axis=1)
        return cls(measure[0].reshape(-1, 4).sum(axis=1), solid_angles, curvatures.ravel())

    def curved(self, density: float) -> Flags:
        """Return which cells are curved enough to be sampled, as booleans (m n,).

        A cell counts if |K| times the density is at least 1, where the diagonal of the bounding box
        is the unit of length: a surface of that size with this |K| would have a sample.
        """
        return self.curvatures * max(density, LEAST_DENSITY) >= 1.0

    def developable_share(self, density: float) -> float:
        """Return the share of the area that `density` normals per steradian do not sample."""
        return self._share_of_few if density <= LEAST_DENSITY else self._share(density)

    @cached_property
    def _share_of_few(self) -> float:
        return self._share(LEAST_DENSITY)

    def _share(self, density: float) -> float:
        total = float(self.areas.sum())
        return float(self.areas[~self.curved(density)].sum()) / total if total > 0.0 else 1.0

    def curved_solid_angle(self, density: float) -> float:
        """Return the solid angle of the Gaussian image of curved cells, with multiplicity."""
        return float(self.solid_angles[self.curved(density)].sum())
