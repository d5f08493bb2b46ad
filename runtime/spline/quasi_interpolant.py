"""The coefficients of a spline from values of a surface: local averages (paper, Sect. 3.1)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated import spline as formulas
from ..base.aliases import Array, Flags
from ..base.checks import pair_of_cells
from ..base.errors import InputError, SurfaceError
from ..base.formula_calls import python_function
from ..base.limits import MOST
from ..base.memory import check_memory
from ..base.scales import LARGEST_EXPONENT, not_too_large
from ..domain.domain import Boundary, BoundaryPair, Domain, cells_between, closes
from .kernels import spline as kernels
from .poles import close_pole
from .spline import Spline

# Missing values are extrapolated over this many steps, 2 + 1: a patch depends on values two cells
# away, and the nearest known value may be one cell away from the patch.
FAR = 3

Sides = tuple[Array, Array, Array, Array]


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
    """Evaluate function(u, v) → (..., 3) at the centres and vertices of the cells of a domain.

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
    """Return the inner coefficients (m, n, 3) and the border, from `values`."""
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

    Take the line from a missing point to the nearest known point. The missing point gets the value
    of the quadratic through the nearest known point and the two points that follow on this line, in
    steps of the same length. It becomes NaN if these are not in the grid, or if it is more than FAR
    rows or columns from the nearest known point.
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


# --- ghosts, one ring outside the domain, which follow from the boundary conditions ---------------


@dataclass(frozen=True, eq=False)
class Border:
    """The spline on the boundary of the domain: the univariate quasi-interpolant of the boundary.

    `sides` are the middle Bézier points of the edges along u at the lower and the upper bound of v,
    then along v at the lower and the upper bound of u; `corners` (2, 2, 3) the values at the
    corners.
    """

    sides: Sides
    corners: Array

    @classmethod
    def of_values(cls, middles: Sides, g: Array) -> Border:
        """Return the border from values at midpoints of boundary edges, and at all vertices."""
        rows = g[:, 0], g[:, -1], g[0], g[-1]
        south, north, west, east = (
            python_function(formulas.edge_point)(f, row[:-1], row[1:])
            for f, row in zip(middles, rows, strict=True)
        )
        return cls((south, north, west, east), g[:: len(g) - 1, :: g.shape[1] - 1])

    @classmethod
    def of_vertices(cls, ringed: Array) -> Border:
        """Return the border from values at vertices, with a ring of vertices outside the domain."""
        south, north, west, east = (
            python_function(formulas.edge_point_from_vertices)(
                row[1:-2], row[2:-1], row[:-3], row[3:]
            )
            for row in (ringed[:, 1], ringed[:, -2], ringed[1], ringed[-2])
        )
        corners = ringed[1 :: len(ringed) - 3, 1 :: ringed.shape[1] - 3][:2, :2]
        return cls((south, north, west, east), corners)


def coefficients_with_ring(inner: Array, border: Border, boundary: Boundary) -> Array:
    """Return the coefficients (m + 2, n + 2, 3): `inner` (m, n, 3) and a ring of ghosts.

    At open sides the ghosts follow from `border`, the boundary of the spline. At periodic and
    mirrored sides they are copies of inner coefficients. At a pole they are the first inner
    coefficients reflected in their mean, so that this side of the spline is exactly a point. Before
    that, these inner coefficients are moved into one plane, so that the pole has one normal
    (poles.py).
    """
    result = np.pad(inner, [(1, 1), (1, 1), (0, 0)])
    turned = np.swapaxes(result, 0, 1)
    _open_rows(result, boundary[0], border.sides[2:])
    _open_rows(turned, boundary[1], border.sides[:2])
    _close(result, turned, boundary)
    for i, j in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
        if boundary[0][i] == boundary[1][j] == "open":
            a, b = (1, -2)[i], (1, -2)[j]
            result[i, j] = python_function(formulas.beyond_corner)(
                border.corners[i, j], result[a, j], result[i, b], result[a, b]
            )
    return result


def _open_rows(rows: Array, boundary: BoundaryPair, sides: tuple[Array, Array]) -> None:
    """Write the rows of ghosts, without corners, beyond the open boundaries of the first axis."""
    for end, side, outside, first in zip(boundary, sides, (0, -1), (1, -2), strict=True):
        if end == "open":
            rows[outside, 1:-1] = python_function(formulas.beyond_edge)(side, rows[first, 1:-1])


def _close(result: Array, turned: Array, boundary: Boundary) -> None:
    """Write the rows of ghosts beyond poles, then beyond periodic or mirrored boundaries.

    Whole rows are copied, first beyond the boundaries of v, then of u, so that the copies include
    the ghosts along the other parameter.
    """
    directions = ((turned, boundary[1]), (result, boundary[0]))
    for rows, end in directions:
        for kind, outside, first in zip(end, (0, -1), (1, -2), strict=True):
            if kind == "pole":
                close_pole(rows, outside, first)
    for rows, end in directions:
        if closes(end):
            step = 1 if end[0] == "periodic" else -1
            rows[0], rows[-1] = rows[-2, ::step].copy(), rows[1, ::step].copy()


def vertices_with_ring(values: Array, boundary: Boundary) -> Array:
    """Return values (m, n, 3) at vertices, extended by the vertices one step outside the domain.

    A periodic direction, in which the first row is not repeated at the end, gets one row before the
    first row and two rows after the last one; other directions get one row at each end. The row
    beyond a pole is the row before the pole, shifted by half a period; it is extrapolated if half a
    period is not an integer number of points.
    """
    if "pole" in boundary[0]:
        swapped = vertices_with_ring(np.swapaxes(values, 0, 1), (boundary[1], boundary[0]))
        return np.ascontiguousarray(np.swapaxes(swapped, 0, 1))
    turned = np.swapaxes(values, 0, 1)
    reverse = values[::-1]  # in a closed row of vertices, the first vertex stays the first
    reverse = np.roll(reverse, 1, axis=0) if closes(boundary[0]) else reverse
    opposite = np.roll(turned, len(values) // 2, axis=1)
    low, high = _beyond(turned, np.swapaxes(reverse, 0, 1), opposite, boundary[1])
    ringed = np.swapaxes(np.concatenate([low, turned, high]), 0, 1)
    low, high = _beyond(ringed, ringed[:, ::-1], ringed, boundary[0])
    return np.ascontiguousarray(np.concatenate([low, ringed, high]))


def _beyond(
    rows: Array, mirrored: Array, opposite: Array, boundary: BoundaryPair
) -> tuple[Array, Array]:
    """Return the rows of values to add before the first row, and after the last row.

    `mirrored` are all rows with the other parameter reversed, `opposite` all rows shifted by half a
    period of the other parameter.
    """
    if closes(boundary):
        source = rows if boundary[0] == "periodic" else mirrored
        return source[-1:], source[:2]
    parts = []
    for end, step, first in zip(boundary, (1, -1), (0, -1), strict=True):
        if end == "pole" and rows.shape[1] % 2 == 0:
            parts.append(opposite[first + step][None])
        else:
            inside = (rows[first + k * step] for k in range(3))
            parts.append(python_function(formulas.extrapolation)(*inside)[None])
    return parts[0], parts[1]
