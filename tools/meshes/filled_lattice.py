"""The triangles of a lattice, and the samples between its lines inserted into them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...runtime.spline.spline import Spline
from ..kernels.insertion import LatticeCells, insert_points
from .lattice import Lattice
from .triangulation import neighbours
from .vertices import CLOSE, Vertices, before_offset, points_at

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples

__all__ = ["lattice_triangles"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# A cell may have at most this number of vertices between lines.
MOST_IN_CELL = 64
# Points that are added on an open side below samples are apart by this part of a cell.
APART = 1.0 / 64.0


def lattice_triangles(samples: Samples, spline: Spline) -> tuple[Vertices, Indices, Indices] | None:
    """Return vertices, triangles (k, 3) and their neighbours.

    None if the samples are on no `Lattice`, or too many of them between its lines.
    """
    lattice = Lattice.of(samples, spline)
    if lattice is None:
        return None
    if len(lattice.between):
        lattice = _with_feet(_with_samples_at_poles(lattice), samples, spline)
        if np.bincount(lattice.cells_of(lattice.between)).max(initial=0) > MOST_IN_CELL:
            return None
    triangles, adjacent = _filled(lattice)
    if lattice.is_swapped:
        triangles, adjacent = (np.ascontiguousarray(x[:, [0, 2, 1]]) for x in (triangles, adjacent))
    vertices = replace(lattice.vertices, positions=lattice.uv(lattice.vertices.positions))
    return vertices, triangles, adjacent


def _with_samples_at_poles(lattice: Lattice) -> Lattice:
    """Let samples at poles be the vertices there."""
    nodes, between = lattice.nodes.copy(), lattice.between
    for row, place, end in zip((0, -1), (0, lattice.y.cells), lattice.y.ends, strict=True):
        is_there = lattice.places[between, 1] == place
        if end == "pole" and is_there.any():
            nodes[row] = between[is_there][0]
            between = between[~is_there]
    return replace(lattice, nodes=nodes, between=between)


def _with_feet(lattice: Lattice, samples: Samples, spline: Spline) -> Lattice:
    """Add points on open sides opposite to samples close to them.

    Otherwise a triangle of such a sample and two points of the side might be flat, or folded.
    """
    points, numbers = before_offset(samples) * spline.scale, lattice.between
    for axis in (0, 1):
        depth = lattice.places[numbers, axis]
        for place, end in enumerate(lattice.along(axis).ends):
            last = lattice.along(axis).cells
            near = (
                (depth > 0.0) & (depth < 1.0) if place == 0 else (last - 1 < depth) & (depth < last)
            )
            if end == "open" and near.any():
                lattice = _with_feet_on(lattice, axis, place, numbers[near], points, spline)
    return lattice


def _with_feet_on(
    lattice: Lattice, axis: int, place: int, near: Indices, points: Array, spline: Spline
) -> Lattice:
    """Add points on one side, an end of x (axis 0) or y (axis 1), opposite to samples `near` it."""

    def side(along: Array) -> Array:
        return points_at(spline, lattice.uv(lattice.on_side(axis, place, along)))

    along, lines = lattice.places[near, 1 - axis], lattice.along(axis)
    left = np.minimum(np.floor(along), lattice.along(1 - axis).cells - 1)
    foot, start, end = side(along), side(left), side(left + 1.0)
    depth, length, before, after = (
        np.linalg.norm(x, axis=1)
        for x in (points[near] - foot, end - start, foot - start, end - foot)
    )
    is_close = (depth < CLOSE * length) & (depth < np.minimum(before, after))
    along = along[is_close]
    along = along[np.unique(np.rint(along / APART), return_index=True)[1]]
    if not len(along):
        return lattice
    places = np.full((len(along), 2), float(place * lines.cells))
    places[:, 1 - axis] = along
    added = Vertices.fixed(lattice.on_side(axis, place, along), np.full(len(along), -1))
    numbers = len(lattice.places) + np.arange(len(along))
    return replace(
        lattice,
        vertices=Vertices.joined([lattice.vertices, added]),
        places=np.concatenate([lattice.places, places]),
        between=np.concatenate([lattice.between, numbers]),
    )


def _filled(lattice: Lattice) -> tuple[Indices, Indices]:
    """Return the triangles of a lattice, counterclockwise in x and y, and their neighbours."""
    triangles, cell = lattice.triangles()
    adjacent = neighbours(triangles, ~lattice.vertices.is_free)[0]
    if not len(lattice.between):
        return triangles, adjacent
    count, more = len(triangles), 2 * len(lattice.between)
    following = np.where(np.diff(cell, append=-1) == 0, np.arange(1, count + 1), -1)
    cells = LatticeCells(
        shape=np.array([lattice.x.cells, lattice.y.cells]),
        periods=np.array([z.cells if z.closes else 0 for z in (lattice.x, lattice.y)]),
        poles=np.array([end == "pole" for end in lattice.y.ends]),
        cell=_longer(cell, more),
        first=np.searchsorted(cell, np.arange(lattice.x.cells * lattice.y.cells)),
        following=_longer(following, more),
    )
    triangles, adjacent = _longer(triangles, more), _longer(adjacent, more)
    count = insert_points(lattice.places, triangles, adjacent, count, lattice.between, cells)
    return triangles[:count], adjacent[:count]


def _longer(array: Indices, more: int) -> Indices:
    """Return an array with more rows, of −1."""
    return np.concatenate([array, np.full((more, *array.shape[1:]), -1)])
