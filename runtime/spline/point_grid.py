"""Points on a grid as a surface: scans, elevation models, images."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..base.advice import NO_CLOUDS
from ..base.checks import as_float
from ..base.errors import InputError, shown
from ..domain.domain import Boundary, Domain, broken_poles, cells_between, closes
from .quasi_interpolant import fit_grid
from .spline import Spline

# If the last row is this close to the first row, relative to the distance between the first two
# rows, it repeats the first row.
REPEATED = 1e-3


def spline_of_points(
    points: NDArray[np.float64], boundary: Boundary, name: str, domain: Domain | None = None
) -> Spline:
    """Return the spline that approximates points (m, n, 3), given at the vertices of its cells."""
    _check(points, boundary, name)
    if domain is None:
        m, n = cells_between(points.shape, boundary)
        domain = (0.0, float(m)), (0.0, float(n))
    spline = fit_grid(points, domain, boundary, name)
    _check_closed(points, boundary, name)
    return spline


def points_of_elevations(
    elevations: NDArray[np.float64], spacing: Sequence[float] | None, boundary: Boundary, name: str
) -> tuple[NDArray[np.float64], Domain]:
    """Return the points (m, n, 3) of elevations (rows along y, columns along x), and their domain.

    The order of the points makes normals point upward.
    """
    if boundary != (("open", "open"), ("open", "open")):
        raise InputError("elevations are a graph and cannot be periodic.")
    rows, columns = elevations.shape
    if columns == 3:
        raise InputError(f"{name} has the shape {elevations.shape}: {NO_CLOUDS}.")
    dx, dy = checked_spacing(spacing, max(rows, columns))
    _check(elevations[..., None], boundary, name)
    x, y = dx * np.arange(columns), dy * np.arange(rows) + 0.0
    if dy < 0.0:
        elevations, y = elevations[::-1], y[::-1]
    points = np.empty((columns, rows, 3))
    points[..., 0] = x[:, None]
    points[..., 1] = y
    points[..., 2] = elevations.T
    return points, ((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])))


def checked_spacing(spacing: Sequence[float] | None, count: int) -> tuple[float, float]:
    """Return the spacing dx, dy of at most `count` elevations along x and along y.

    Raises InputError if it is invalid.
    """
    try:
        dx, dy = (as_float(x) for x in (() if spacing is None else spacing))
    except Exception:  # `float` may raise anything
        raise InputError(
            f"elevations (m, n) need a spacing of two numbers, dx and dy, not {shown(spacing)}."
        ) from None
    if not np.isfinite([dx * count, dy * count]).all() or dx <= 0.0 or dy == 0.0:
        raise InputError(
            f"spacing must be finite and the map too, dx > 0 and dy not 0, not ({dx}, {dy})."
        )
    return dx, dy


def _check(points: NDArray[np.float64], boundary: Boundary, name: str) -> None:
    for axis, end in enumerate(boundary):
        least = 3 if closes(end) else 4
        if points.shape[axis] < least:
            raise InputError(
                f"{name} has {points.shape[0]} x {points.shape[1]} points; it needs at least "
                f"{least} along axis {axis}, for 3 x 3 cells."
            )
    bad = np.isinf(points).any(axis=2)
    if bad.any():
        i, j = np.unravel_index(int(np.argmax(bad)), bad.shape)
        raise InputError(
            f"{name} holds {int(bad.sum())} points with infinity, the first at [{i}, {j}]; make "
            "them NaN if they are missing."
        )
    if np.isnan(points).any(axis=2).all():
        raise InputError(f"all points of {name} are missing: each holds NaN, or nodata.")


def _farthest(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Return the largest difference of coordinates between two rows of points.

    The result is NaN if all differences are NaN.
    """
    return float(np.fmax.reduce(np.abs(first - second), axis=None))


def _check_closed(points: NDArray[np.float64], boundary: Boundary, name: str) -> None:
    if "mirrored" in boundary[0] and "mirrored" in boundary[1]:
        raise InputError(
            f"{name} cannot be mirrored along both axes: one of its corners would be missing; use "
            "a callable."
        )
    for axis, ends in enumerate(boundary):
        rows = np.swapaxes(points, 0, axis)
        if closes(ends):
            first = rows[0] if ends[0] == "periodic" else rows[0, ::-1]
            if _farthest(rows[-1], first) < REPEATED * _farthest(rows[1], rows[0]):
                raise InputError(
                    f"{name} repeats its first points at the end of axis {axis}, which is "
                    "periodic; leave them out."
                )
        for end in broken_poles(points, boundary, axis):
            place = f"points[{-end}]" if axis == 0 else f"points[:, {-end}]"
            raise InputError(f"{name} has no pole at {place}: they are not one point.")
