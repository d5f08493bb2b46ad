"""The developable share of a surface (K ≈ 0), which no set of normals samples."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.aliases import Array, Flags
from ..domain.domain import widened

# A region counts as curved if 10,000 normals would sample it, even if fewer normals are requested.
LEAST_DENSITY = 10_000 / (4 * math.pi)


@dataclass(frozen=True, eq=False)
class CellMeasure:
    """The areas of cells (m n,), the solid angles of their Gaussian images, and their |K|.

    K of a cell is the sum of the signed solid angles of its patches divided by its area: the spline
    of a developable surface has elliptic and hyperbolic patches, whose solid angles cancel. This
    quotient also vanishes where K changes its sign; therefore `curvatures` are maxima over each
    cell and its neighbours. The `solid_angles` of cells are sums of absolute values. In a spline of
    nets each patch counts as a cell, without neighbours.
    """

    areas: Array
    solid_angles: Array
    curvatures: Array

    @classmethod
    def of(cls, measure: tuple[Array, Array], cells: tuple[int, int]) -> CellMeasure:
        """Return the measure of cells from areas and signed solid angles of patches (4 m n,)."""
        areas, signed = (x.reshape(*cells, 4).sum(axis=2) for x in measure)
        with np.errstate(divide="ignore", invalid="ignore"):
            curvatures = np.where(areas > 0.0, np.abs(signed) / areas, 0.0)
        curvatures = widened(curvatures, "edge")
        solid_angles = np.abs(measure[1]).reshape(-1, 4).sum(axis=1)
        return cls(measure[0].reshape(-1, 4).sum(axis=1), solid_angles, curvatures.ravel())

    def curved(self, density: float) -> Flags:
        """Return a mask (m n,) of the cells that are curved enough to be sampled.

        `density` is the number of normals per steradian; the unit of length is the diagonal of the
        bounding box. A cell is curved enough if |K| times the density is at least 1: a surface of
        area 1 with this |K| would have a sample.
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
        """Return the sum of the solid angles of the Gaussian images of curved cells."""
        return float(self.solid_angles[self.curved(density)].sum())
