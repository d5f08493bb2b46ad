"""The coefficients of a spline from values of a surface: local averages (paper, Sect. 3.1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..base.checks import pair_of_cells
from ..base.errors import InputError, SurfaceError
from ..base.limits import MOST
from ..base.memory import check_memory
from ..base.scales import LARGEST_EXPONENT, not_too_large
from ..domain.domain import Boundary, Domain, cells_between
from .ghosts import Border, Sides, coefficients_with_ring, vertices_with_ring
from .kernels import spline as kernels
from .spline import Spline

__all__ = [
    "Values",
    "checked_cells",
    "completed",
    "continued",
    "fit_grid",
    "fit_values",
    "from_grid",
    "from_values",
    "values_at",
]


# Missing values are extrapolated over this many steps, 2 + 1: a patch depends on values two cells
# away, and the nearest known value may be one cell away from the patch.
FAR = 3


class Values(NamedTuple):
    """Values at the centres (m, n, 3) and vertices (m + 1, n + 1, 3) of cells.

    `middles` are values at the midpoints of the edges on the boundary of the domain.
    """

    centres: Array
    vertices: Array
    middles: Sides

    def filled_by(self, fill: Callable[[Array], Array]) -> Values:
        """Return the values with missing values filled in; `fill` is `continued` or `completed`."""
        g = fill(self.vertices)
        rows = g[:, 0], g[:, -1], g[0], g[-1]
        sides = zip(self.middles, rows, strict=True)
        a, b, c, d = (np.where(np.isfinite(x), x, y[1:]) for x, y in sides)
        return Values(fill(self.centres), g, (a, b, c, d))


def values_at(
    function: Callable[[Array, Array], Array], domain: Domain, cells: tuple[int, int]
) -> Values:
    """Evaluate function(u, v) → (..., 3) on the cells of a domain.

    Raises InputError if the domain is too narrow for the cells in float64.
    """
    lines = []
    for along, (low, high), count in zip("uv", domain, cells, strict=True):
        line = low + (high - low) * (np.arange(2 * count + 1) / (2 * count))
        if not (np.diff(line) > 0.0).all():
            raise InputError(
                f"the domain of {along} is too narrow for {count} cells: ({low}, {high})."
            )
        lines.append(line)
    u, v = lines[0][:, None], lines[1]
    centres, vertices = function(u[1::2], v[1::2]), function(u[::2], v[::2])
    at_v, at_u = function(u[1::2], v[[0, -1]]), function(u[[0, -1]], v[1::2])
    return Values(centres, vertices, (at_v[:, 0], at_v[:, 1], at_u[0], at_u[1]))


def from_values(values: Values) -> tuple[Array, Border]:
    """Return the inner coefficients (m, n, 3) and the border, from values on cells."""
    inner = np.empty_like(values.centres)
    kernels.fit_centres_and_vertices(values.centres, values.vertices, inner)
    return inner, Border.of_values(values.middles, values.vertices)


def from_grid(points: Array, boundary: Boundary) -> tuple[Array, Border]:
    """Return the inner coefficients and the border, from values at vertices only."""
    ringed = vertices_with_ring(points, boundary)
    inner = np.empty((ringed.shape[0] - 3, ringed.shape[1] - 3, 3))
    kernels.fit_vertices(ringed, inner)
    return inner, Border.of_vertices(ringed)


# --- the spline -----------------------------------------------------------------------------------


def fit_values(values: Values, domain: Domain, boundary: Boundary, name: str) -> Spline:
    """Return the spline of values at the centres and vertices of cells."""
    return _spline(*from_values(values), domain, boundary, name)


def fit_grid(points: Array, domain: Domain, boundary: Boundary, name: str) -> Spline:
    """Return the spline with one cell between any four neighbouring points (m, n, 3) of a grid.

    Missing points are replaced by the nearest ones.
    """
    checked_cells(cells_between(points.shape, boundary))
    inner, border = from_grid(not_too_large(filled(points), name), boundary)
    return _spline(inner, border, domain, boundary, name)


def _spline(inner: Array, border: Border, domain: Domain, boundary: Boundary, name: str) -> Spline:
    """Return a spline; SurfaceError if its coefficients are subnormal numbers."""
    coefficients = coefficients_with_ring(inner, border, boundary)
    if 0.0 < float(np.abs(coefficients).max()) < 2.0**-LARGEST_EXPONENT:
        raise SurfaceError(
            f"the coordinates of {name!r} are too small to compute with: choose another unit of "
            "length, in which some are larger than 1e-301."
        )
    return Spline(coefficients, domain, boundary, name)


def filled(points: Array) -> Array:
    """Return points (m, n, 3) with the nearest points in place of missing ones."""
    bad = np.isnan(points)
    if not bad.any():
        return points
    touched: Flags = np.any(bad, axis=2)
    result = points.copy()
    result[touched] = np.where(bad[touched], points[*_nearest(touched)], points[touched])
    return result


def completed(points: Array) -> Array:
    """Return points (m, n, 3), in which a quadratic polynomial replaces missing points.

    The polynomial is fitted to the known points by least squares. If no point is known, all
    become 0.
    """
    bad: Flags = np.any(np.isnan(points), axis=2)
    if not bad.any() or bad.all():
        return np.nan_to_num(points)
    lines = (np.linspace(-1.0, 1.0, count) for count in bad.shape)
    u, v = np.meshgrid(*lines, indexing="ij")
    terms = np.stack([u**0, u, v, u * u, u * v, v * v], axis=2)
    result = points.copy()
    result[bad] = terms[bad] @ np.linalg.lstsq(terms[~bad], points[~bad])[0]
    return result


def continued(points: Array) -> Array:
    """Return points (m, n, 3), in which some missing points, NaN or infinite, are extrapolated.

    A missing point up to FAR steps from the nearest known point gets the value of the quadratic
    through three points on the line through both, from the nearest known point on. Other missing
    points become NaN.
    """
    bad: Flags = np.any(~np.isfinite(points), axis=2)
    places, nearest = np.argwhere(bad), _nearest(bad).T
    last = np.array(bad.shape) - 1
    lines = [nearest + k * (nearest - places) for k in range(3)]
    a, b, c = (points[*np.clip(x, 0, last).T] for x in lines)
    near = (np.abs(nearest - places) <= FAR) & (lines[2] >= 0) & (lines[2] <= last)
    result = points.copy()
    result[bad] = np.where(near.all(axis=1, keepdims=True), 3.0 * a - 3.0 * b + c, np.nan)
    return result


def _nearest(bad: Flags) -> NDArray[np.int32]:
    """Return, for each of k missing values, the indices (2, k) of the nearest known value."""
    from scipy.ndimage import distance_transform_edt

    nearest: NDArray[np.int32] = np.empty((2, *bad.shape), dtype=np.int32)
    distance_transform_edt(bad, return_distances=False, return_indices=True, indices=nearest)
    return nearest[:, bad]


def checked_cells(cells: Sequence[int]) -> tuple[int, int]:
    """Return numbers of cells (m, n); InputError if there are too few or too many."""
    m, n = pair_of_cells(cells)
    if min(m, n) < 3:
        raise InputError(f"at least 3 x 3 cells are needed, not {m} x {n}.")
    if m * n > MOST:
        raise InputError(f"at most {MOST:,} cells are possible, not {m:,} x {n:,}.")
    check_memory("cells", m * n)
    return m, n
