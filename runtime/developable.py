"""The developable share of a surface (K ≈ 0), which no set of normals samples."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .geometry.on_spline import OnSpline
    from .splines.spline import Spline

__all__ = ["curved_solid_angle", "developable_share"]


# Regions that 10,000 normals would sample count as curved, even with fewer normals.
LEAST_DENSITY = 10_000 / (4 * math.pi)


def developable_share(sampled: Spline | OnSpline, density: float) -> float:
    """Return the share of the area that `density` normals per steradian do not sample."""
    areas = sampled.measure[0].reshape(-1, 4).sum(axis=1)
    total = float(areas.sum())
    return float(areas[~_curved(sampled, density)].sum()) / total if total > 0.0 else 1.0


def curved_solid_angle(sampled: Spline | OnSpline, density: float) -> float:
    """Return the solid angle of the Gaussian image of curved cells, with multiplicity."""
    solid_angles = np.abs(sampled.measure[1]).reshape(-1, 4).sum(axis=1)
    return float(solid_angles[_curved(sampled, density)].sum())


def _curved(sampled: Spline | OnSpline, density: float) -> NDArray[np.bool_]:
    """Return which cells are curved enough to be sampled, as booleans (cells,).

    A cell counts if |K| times the density is at least 1, in units of the diagonal of the bounding
    box: a surface of that size with this |K| would have a sample. K is the signed solid angle of a
    cell divided by its area: on a developable surface the elliptic and hyperbolic errors of the
    spline cancel in it. It also vanishes where K changes its sign, hence the maximum over the cell
    and its neighbours.
    """
    areas, solid_angles = (x.reshape(*sampled.cells, 4).sum(axis=2) for x in sampled.measure)
    with np.errstate(divide="ignore", invalid="ignore"):
        curvature = np.where(areas > 0.0, np.abs(solid_angles) / areas, 0.0)
    for axis in (0, 1):
        padded = np.pad(curvature, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        shifted = (np.take(padded, np.arange(k, k + curvature.shape[axis]), axis) for k in range(3))
        curvature = np.maximum.reduce(list(shifted))
    return (curvature * max(density, LEAST_DENSITY) >= 1.0).ravel()
