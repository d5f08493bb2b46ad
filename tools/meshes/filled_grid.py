"""The triangles of a grid, and the samples between its lines inserted into them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.spline.spline import Spline
from ..kernels.insertion import LatticeCells, insert_points
from .graded_grid import GradedGrid
from .links import neighbours
from .vertices import CLOSE, Vertices, before_offset, points_at

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples

__all__ = ["grid_triangles"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# A cell may have at most this number of vertices between lines.
MOST_IN_CELL = 64
# Points that are added on an open side below samples are apart by this part of a cell.
APART = 1.0 / 64.0


def grid_triangles(samples: Samples, spline: Spline) -> tuple[Vertices, Indices, Indices] | None:
    """Return vertices, triangles (k, 3) and their neighbours.

    None if the samples are on no `GradedGrid`, or too many of them between its lines.
    """
    grid = GradedGrid.of(samples, spline)
    if grid is None:
        return None
    if len(grid.between):
        grid = _with_feet(_with_samples_at_poles(grid), samples, spline)
        if np.bincount(grid.cells_of(grid.between)).max(initial=0) > MOST_IN_CELL:
            return None
    triangles, adjacent = _filled(grid)
    if grid.is_swapped:
        triangles, adjacent = (np.ascontiguousarray(x[:, [0, 2, 1]]) for x in (triangles, adjacent))
    vertices = replace(grid.vertices, positions=grid.uv(grid.vertices.positions))
    return vertices, triangles, adjacent


def _with_samples_at_poles(grid: GradedGrid) -> GradedGrid:
    """Let samples at poles be the vertices there."""
    nodes, between = grid.nodes.copy(), grid.between
    for row, place, end in zip((0, -1), (0, grid.y.cells), grid.y.ends, strict=True):
        is_there = grid.places[between, 1] == place
        if end == "pole" and is_there.any():
            nodes[row] = between[is_there][0]
            between = between[~is_there]
    return replace(grid, nodes=nodes, between=between)


def _with_feet(grid: GradedGrid, samples: Samples, spline: Spline) -> GradedGrid:
    """Add points on open sides opposite to samples close to them.

    Otherwise a triangle of such a sample and two points of the side might be flat, or folded.
    """
    points, numbers = before_offset(samples) * spline.scale, grid.between
    for axis in (0, 1):
        depth = grid.places[numbers, axis]
        for place, end in enumerate(grid.along(axis).ends):
            last = grid.along(axis).cells
            near = (
                (depth > 0.0) & (depth < 1.0) if place == 0 else (last - 1 < depth) & (depth < last)
            )
            if end == "open" and near.any():
                grid = _with_feet_on(grid, axis, place, numbers[near], points, spline)
    return grid


def _with_feet_on(
    grid: GradedGrid, axis: int, place: int, near: Indices, points: Array, spline: Spline
) -> GradedGrid:
    """Add points on one side, an end of x (axis 0) or y (axis 1), opposite to samples `near` it."""

    def side(along: Array) -> Array:
        return points_at(spline, grid.uv(grid.on_side(axis, place, along)))

    along, lines = grid.places[near, 1 - axis], grid.along(axis)
    left = np.minimum(np.floor(along), grid.along(1 - axis).cells - 1)
    foot, start, end = side(along), side(left), side(left + 1.0)
    depth, length, before, after = (
        np.linalg.norm(x, axis=1)
        for x in (points[near] - foot, end - start, foot - start, end - foot)
    )
    is_close = (depth < CLOSE * length) & (depth < np.minimum(before, after))
    along = along[is_close]
    along = along[np.unique(np.rint(along / APART), return_index=True)[1]]
    if not len(along):
        return grid
    places = np.full((len(along), 2), float(place * lines.cells))
    places[:, 1 - axis] = along
    added = Vertices.fixed(grid.on_side(axis, place, along), np.full(len(along), -1))
    numbers = len(grid.places) + np.arange(len(along))
    return replace(
        grid,
        vertices=Vertices.joined([grid.vertices, added]),
        places=np.concatenate([grid.places, places]),
        between=np.concatenate([grid.between, numbers]),
    )


def _filled(grid: GradedGrid) -> tuple[Indices, Indices]:
    """Return the triangles of a grid, counterclockwise in x and y, and their neighbours."""
    triangles, cell = grid.triangles()
    adjacent = neighbours(triangles, ~grid.vertices.is_free)[0]
    if not len(grid.between):
        return triangles, adjacent
    count, more = len(triangles), 2 * len(grid.between)
    following = np.where(np.diff(cell, append=-1) == 0, np.arange(1, count + 1), -1)
    cells = LatticeCells(
        shape=np.array([grid.x.cells, grid.y.cells]),
        periods=np.array([z.cells if z.closes else 0 for z in (grid.x, grid.y)]),
        poles=np.array([end == "pole" for end in grid.y.ends]),
        cell=_longer(cell, more),
        first=np.searchsorted(cell, np.arange(grid.x.cells * grid.y.cells)),
        following=_longer(following, more),
    )
    triangles, adjacent = _longer(triangles, more), _longer(adjacent, more)
    count = insert_points(grid.places, triangles, adjacent, count, grid.between, cells)
    return triangles[:count], adjacent[:count]


def _longer(array: Indices, more: int) -> Indices:
    """Return an array with more rows, of −1."""
    return np.concatenate([array, np.full((more, *array.shape[1:]), -1)])
