"""The coefficients of a planar spline from values or points: local averages (Sect. 4.1)."""

import numpy as np
from numpy.typing import NDArray

from ...generated import curve as formulas
from ...generated import spline as edge_formulas
from ...runtime.base.errors import InputError
from ...runtime.base.formula_calls import python_function
from ...runtime.base.scales import not_too_large
from ...runtime.domain.domain import Interval
from .curve_spline import CurveSpline

Array = NDArray[np.float64]
# A last point closer to the first point than this, relative to the first step, counts as a
# repetition of the first point.
REPEATED = 1e-3


def spline_of_values(values: Array, domain: Interval, closed: bool, name: str) -> CurveSpline:
    """Return the spline of values (2 P + 1, 2), alternately at joints and midpoints of P pieces."""
    inner = python_function(edge_formulas.edge_point)(values[1::2], values[:-1:2], values[2::2])
    return CurveSpline(_with_ends(inner, values[[0, -1]], closed), domain, closed, name)


def spline_of_points(points: Array, domain: Interval, closed: bool, name: str) -> CurveSpline:
    """Return the spline with one piece between neighbouring points."""
    not_too_large(points, name)
    if closed:
        values = np.concatenate([points[-1:], points, points[:2]])
    else:
        before = python_function(edge_formulas.extrapolation)(*points[:3])
        after = python_function(edge_formulas.extrapolation)(*points[:-4:-1])
        values = np.concatenate([before[None], points, after[None]])
    inner = python_function(edge_formulas.edge_point_from_vertices)(
        values[1:-2], values[2:-1], values[:-3], values[3:]
    )
    return CurveSpline(_with_ends(inner, points[[0, -1]], closed), domain, closed, name)


def _is_repeated(points: Array) -> bool:
    step = float(np.hypot(*(points[1] - points[0])))
    return bool(np.ptp(points[[0, -1]], axis=0).max() < REPEATED * step)


def _with_ends(inner: Array, ends: Array, closed: bool) -> Array:
    """Return the coefficients (P + 2, 2), with a ghost coefficient at each end.

    The ghosts of a closed curve are copies; the ghosts of an open curve follow from its end points.
    """
    if closed:
        return np.concatenate([inner[-1:], inner, inner[:1]])
    before, after = python_function(formulas.beyond_end)(ends, inner[[0, -1]])
    return np.concatenate([before[None], inner, after[None]])


def checked_points(points: Array, closed: bool, name: str) -> Array:
    """Return points (m, 2) of a curve; InputError if they are unusable."""
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(f"points of a curve must have the shape (m, 2), not {points.shape}.")
    if len(points) < 3:
        raise InputError(f"a curve needs at least 3 points, not {len(points)}.")
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise InputError(
            f"{name} holds {int(bad.sum())} points with NaN or infinity, the first at "
            f"[{int(bad.argmax())}]; leave them out."
        )
    if closed and _is_repeated(points):
        raise InputError(f"{name} repeats its first point at its end; leave it out.")
    return points
