"""Ghost coefficients: one ring outside the domain, computed from the boundary conditions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...generated import spline as formulas
from ..base.aliases import Array
from ..base.formula_calls import python_function
from ..domain.domain import Boundary, BoundaryPair, closes
from .poles import close_pole

__all__ = ["Border", "Sides", "coefficients_with_ring", "vertices_with_ring"]

Sides = tuple[Array, Array, Array, Array]


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

    Whole rows are copied, first beyond the boundaries of v, then of u. So the copies include the
    ghosts along the other parameter.
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


# --- vertices -------------------------------------------------------------------------------------


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
