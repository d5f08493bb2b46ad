"""The triangles of a grid; a cell with samples between its lines is triangulated on its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.spline.spline import Spline
from .graded_grid import GradedGrid
from .links import neighbours
from .places import on_side
from .triangulation import delaunay
from .vertices import Vertices

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples

__all__ = ["grid_triangles"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# At most this number of vertices lie between lines.
MOST_BETWEEN = 20_000
# Points that are added on an open side below samples are apart by this part of a cell.
APART = 1.0 / 64.0
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def grid_triangles(samples: Samples, spline: Spline) -> tuple[Vertices, Indices, Indices] | None:
    """Return vertices, triangles (k, 3) and their neighbours.

    None if the samples are on no `GradedGrid`, or too many of them between its lines.
    """
    grid = GradedGrid.of(samples, spline)
    if grid is None or len(grid.between) > MOST_BETWEEN:
        return None
    grid = _with_samples_at_poles(grid)
    for axis in (0, 1):
        for place, end in enumerate(grid.along(axis).ends):
            grid = _with_feet(grid, axis, place) if end == "open" else grid
    triangles, cell = grid.triangles()
    filled = dict(_filled(grid))
    triangles = np.concatenate([triangles[~np.isin(cell, list(filled))], *filled.values()])
    if grid.is_swapped:
        triangles = triangles[:, [0, 2, 1]]
    adjacent, is_whole = neighbours(triangles, ~grid.vertices.is_free)
    vertices = replace(grid.vertices, positions=grid.uv(grid.vertices.positions))
    return (vertices, triangles, adjacent) if is_whole else None


def _with_samples_at_poles(grid: GradedGrid) -> GradedGrid:
    """Let samples at poles be the vertices there."""
    nodes, between = grid.nodes.copy(), grid.between
    for row, place, end in zip((0, -1), (0, grid.y.cells), grid.y.ends, strict=True):
        is_there = grid.places[between, 1] == place
        if end == "pole" and is_there.any():
            nodes[row] = between[is_there][0]
            between = between[~is_there]
    return replace(grid, nodes=nodes, between=between)


def _with_feet(grid: GradedGrid, axis: int, place: int) -> GradedGrid:
    """Add points on an open side, an end of x (axis 0) or y (axis 1), opposite to samples near it.

    Near are those that are closer to it than to the next node, in cells. Otherwise a triangle of
    such a sample and two points of the side might be flat, or folded.
    """
    near, side = grid.places[grid.between], float(place * grid.along(axis).cells)
    depth, along = np.abs(near[:, axis] - side), near[:, 1 - axis]
    along = along[(depth > 0.0) & (depth < np.abs(along - np.rint(along)))]
    along = along[np.unique(np.rint(along / APART), return_index=True)[1]]
    places = on_side(axis, side, along)
    added = Vertices.fixed(grid.on_side(axis, place, along), np.full(len(along), -1))
    numbers = len(grid.places) + np.arange(len(along))
    return replace(
        grid,
        vertices=Vertices.joined([grid.vertices, added]),
        places=np.concatenate([grid.places, places]),
        between=np.concatenate([grid.between, numbers]),
    )


def _filled(grid: GradedGrid) -> Iterator[tuple[int, Indices]]:
    """Yield the cells with vertices between their corners, and the triangles (k, 3) there.

    A vertex on a line is in the cells on both sides. Of several at one place the first counts.
    """
    shape = np.array([grid.x.cells, grid.y.cells])
    closes = np.array([grid.x.closes, grid.y.closes])
    places = grid.places[grid.between]
    places = np.where(closes, places % shape, places)
    first = np.unique(places, axis=0, return_index=True)[1]
    first = first[(places[first] % 1.0 > 0.0).any(axis=1)]
    numbers, places = grid.between[first], places[first]
    members: dict[int, list[int]] = {}
    for back in np.ndindex(2, 2):
        cells = np.floor(places).astype(np.int64) - back
        touches = (places - cells <= 1.0).all(axis=1)
        cells = np.where(closes, cells % shape, cells)
        touches &= ((cells >= 0) & (cells < shape)).all(axis=1)
        for k in np.flatnonzero(touches).tolist():
            members.setdefault(int(cells[k] @ (1, shape[0])), []).append(k)
    for cell, inside in members.items():
        row, column = divmod(cell, int(shape[0]))
        # One that lies on the last line of a periodic direction is beyond the first cell.
        within = places[inside] - (column, row)
        within = np.where(within < 0.0, within + shape, within)
        yield cell, _in_cell(grid, row, column, numbers[inside], within)


def _in_cell(grid: GradedGrid, row: int, column: int, inner: Indices, within: Array) -> Indices:
    """Triangulate a cell with inner vertices; next to a pole, lines of constant x meet there."""
    rows, columns = np.array([[row, column]] * 4).T + CORNERS.T[::-1].astype(np.int64)
    corners = grid.nodes[rows % grid.nodes.shape[0], columns % grid.nodes.shape[1]]
    x, y = np.concatenate([CORNERS, within]).T
    for is_there, height in (
        (row == 0 and grid.y.ends[0] == "pole", y),
        (row == grid.y.cells - 1 and grid.y.ends[1] == "pole", 1.0 - y),
    ):
        x = 0.5 + (x - 0.5) * height if is_there else x
    return np.concatenate([corners, inner])[delaunay(np.stack([x, y], axis=1))]
