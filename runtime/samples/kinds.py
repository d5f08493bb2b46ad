"""Which samples are parabolic points: K is zero up to rounding, whatever its sign bit says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..base.tolerances import DERIVATIVE_ERROR, PATCH_ERROR

if TYPE_CHECKING:
    from .arrays import SampleArrays

__all__ = ["is_parabolic"]


def is_parabolic(samples: SampleArrays) -> NDArray[np.bool_]:
    """Return at which samples (N,) one principal curvature is zero, up to rounding.

    With an error t of both of them, κ₁ κ₂ has the error t (|κ₁| + |κ₂| + t), and |κ₁| + |κ₂| = 2|H|
    where κ₂ is about 0; H = 1/D is assumed if it is unknown, D the diagonal of the bounding box.
    """
    K = samples.gaussian_curvature.astype(np.float64)
    diagonal, error = _size_and_error(samples)
    if not diagonal > 0.0:
        return np.zeros(len(K), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        bend = np.ones_like(K)
        if "mean_curvature" in samples.fields:
            bend = np.abs(samples.mean_curvature.astype(np.float64)) * diagonal
        return np.abs(K) * diagonal * diagonal <= error * (2.0 * bend + error)


def _size_and_error(samples: SampleArrays) -> tuple[float, float]:
    """Return the diagonal of the bounding box, and the error of a curvature relative to 1/D.

    The diagonal is 0 if it is unknown: without points, and without the spline.
    """
    spline = samples.spline
    if spline is not None:
        points, cells = spline.coefficients[1:-1, 1:-1].reshape(-1, 3), max(spline.cells)
    elif "points" in samples.fields and len(samples.points) > 0:
        points, cells = samples.points.astype(np.float64), 0
    else:
        return 0.0, 0.0
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    rounding = float(np.spacing(np.abs(points).max())) / (diagonal or 1.0)
    return diagonal, rounding * max(DERIVATIVE_ERROR, PATCH_ERROR * cells**2)
