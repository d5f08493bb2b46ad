"""How much of a surface normals can see: flat and developable parts have no support function."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .spline import Spline

__all__ = ["invisible_share", "visible_solid_angle"]


# What 10,000 normals would see counts as visible, even if fewer were asked.
LEAST_DENSITY = 10_000 / (4 * math.pi)


def invisible_share(spline: Spline, density: float) -> float:
    """Return the share of the area where `density` normals per steradian leave no trace."""
    areas = spline.measure[0].reshape(-1, 4).sum(axis=1)
    total = float(areas.sum())
    return float(areas[~_visible(spline, density)].sum()) / total if total > 0.0 else 1.0


def visible_solid_angle(spline: Spline, density: float) -> float:
    """Return the solid angle of the Gaussian image, every sheet counted, of the visible cells."""
    solid_angles = np.abs(spline.measure[1]).reshape(-1, 4).sum(axis=1)
    return float(solid_angles[_visible(spline, density)].sum())


def _visible(spline: Spline, density: float) -> NDArray[np.bool_]:
    """Say for each cell whether a surface as large as this one and bent like it gets one sample.

    What counts is the signed solid angle of a whole cell: on a developable surface the spline's
    small elliptic and hyperbolic errors cancel in it. Where the curvature changes sign it is zero
    as well, hence the largest of the cell and its neighbours.
    """
    areas, solid_angles = (x.reshape(*spline.cells, 4).sum(axis=2) for x in spline.measure)
    with np.errstate(divide="ignore", invalid="ignore"):
        bending = np.where(areas > 0.0, np.abs(solid_angles) / areas, 0.0)
    for axis in (0, 1):
        padded = np.pad(bending, [(1, 1) if k == axis else (0, 0) for k in (0, 1)], mode="edge")
        stretches = (np.take(padded, np.arange(k, k + bending.shape[axis]), axis) for k in range(3))
        bending = np.maximum.reduce(list(stretches))
    return (bending * max(density, LEAST_DENSITY) >= 1.0).ravel()
