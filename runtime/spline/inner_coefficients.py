"""The coefficients inside the domain, and the boundary, from values of a surface or a grid."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..base.aliases import Array
from ..base.errors import InputError
from ..domain.domain import Boundary, Domain
from .ghosts import Border, Sides, vertices_with_ring
from .kernels import spline as kernels

__all__ = ["Values", "from_grid", "from_values", "values_at"]


class Values(NamedTuple):
    """Values at the centres (m, n, 3) and vertices (m + 1, n + 1, 3) of cells.

    `middles` are those at the midpoints of the edges on the boundary of the domain.
    """

    centres: Array
    vertices: Array
    middles: Sides


def values_at(
    function: Callable[[Array, Array], Array], domain: Domain, cells: tuple[int, int]
) -> Values:
    """Return the values of function(u, v) → (..., 3); InputError if the domain is too narrow."""
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
    """Return the coefficients (m, n, 3) and the boundary from values at centres and vertices."""
    inner = np.empty_like(values.centres)
    kernels.fit_centres_and_vertices(values.centres, values.vertices, inner)
    return inner, Border.of_values(values.middles, values.vertices)


def from_grid(points: Array, boundary: Boundary) -> tuple[Array, Border]:
    """Return the coefficients and the boundary from values at the vertices only."""
    ringed = vertices_with_ring(points, boundary)
    inner = np.empty((ringed.shape[0] - 3, ringed.shape[1] - 3, 3))
    kernels.fit_vertices(ringed, inner)
    return inner, Border.of_vertices(ringed)
