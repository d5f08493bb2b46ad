"""Points inserted into the triangles of a lattice, by splits of triangles and of edges.

The lattice has columns along x and rows along y, of width 1: cell (i, j) is the unit square at
(i, j). Triangles stay in the cell in which they begin. In the cells next to a pole, the side there
is one point. `triangles` and `neighbours` (k, 3) are those of `flips`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.kernels.jit import inline, jit, loop
from .flips import corner_of, replace_neighbour, write_row

__all__ = ["LatticeCells", "insert_points"]

# A point is on an edge if the triangle between both is smaller than this part of the whole one.
ON_EDGE = 1e-6


class LatticeCells(NamedTuple):
    """The cells of a lattice and their triangles.

    shape (2,): the numbers of cells along x and y.
    periods (2,): the same along a periodic one, 0 along others.
    poles (2,): whether there is one at the smallest and at the largest y.
    cell (k,): the cell i + j shape[0] of each triangle.
    first (cells,) and following (k,): the triangles of each cell, ended by −1.
    """

    shape: NDArray[np.int64]
    periods: NDArray[np.int64]
    poles: NDArray[np.bool_]
    cell: NDArray[np.int64]
    first: NDArray[np.int64]
    following: NDArray[np.int64]


@inline
def doubled_area(ax, ay, bx, by, cx, cy):
    """Return twice the signed area of a triangle."""
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@loop
def place_in_cell(places, vertex, cell, cells):
    """Return the place of a vertex relative to the middle of the lower side of a cell.

    Next to a pole, lines of constant x meet there.
    """
    j = cell // cells.shape[0]
    x = places[vertex, 0] - (cell - j * cells.shape[0]) - 0.5
    y = places[vertex, 1] - j
    if cells.periods[0] > 0:
        x -= cells.periods[0] * math.floor(x / cells.periods[0] + 0.5)
    if cells.periods[1] > 0:
        y -= cells.periods[1] * math.floor((y - 0.5) / cells.periods[1] + 0.5)
    if j == 0 and cells.poles[0]:
        x *= y
    if j == cells.shape[1] - 1 and cells.poles[1]:
        x *= 1.0 - y
    return x, y


@loop
def shares(places, triangles, t, vertex, cells):
    """Return the barycentric coordinates of a vertex in a triangle of the same cell."""
    cell = cells.cell[t]
    x, y = place_in_cell(places, vertex, cell, cells)
    ax, ay = place_in_cell(places, triangles[t, 0], cell, cells)
    bx, by = place_in_cell(places, triangles[t, 1], cell, cells)
    cx, cy = place_in_cell(places, triangles[t, 2], cell, cells)
    whole = doubled_area(ax, ay, bx, by, cx, cy)
    a = doubled_area(x, y, bx, by, cx, cy) / whole
    b = doubled_area(ax, ay, x, y, cx, cy) / whole
    return a, b, doubled_area(ax, ay, bx, by, x, y) / whole


@loop
def triangle_around(places, triangles, vertex, cells):
    """Return the triangle around a vertex, its corner of the smallest share, and the two smallest.

    Rounding may put a place slightly outside of all triangles of its cell: the nearest one counts.
    """
    i = min(int(places[vertex, 0]), cells.shape[0] - 1)
    j = min(int(places[vertex, 1]), cells.shape[1] - 1)
    t = cells.first[i + j * cells.shape[0]]
    found, corner, smallest, second = t, 0, -math.inf, 0.0
    while t >= 0:
        a, b, c = shares(places, triangles, t, vertex, cells)
        least = min(a, b, c)
        if least > smallest:
            found, smallest = t, least
            corner = 0 if least == a else (1 if least == b else 2)
            second = min(max(a, b), max(b, c), max(a, c))
        t = cells.following[t]
    return found, corner, smallest, second


@loop
def append_triangle(cells, t, beside):
    """Put a new triangle t into the cell of another one."""
    cell = cells.cell[beside]
    cells.cell[t] = cell
    cells.following[t] = cells.first[cell]
    cells.first[cell] = t


@loop
def split(triangles, neighbours, t, k, vertex, new, cells):
    """Cut triangle t = a b c, c its corner k, at a vertex p into p b c and the new one a p c.

    The neighbours of both across a b are for the caller to write.
    """
    a, b, c = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3], triangles[t, k]
    across_bc, across_ca = neighbours[t, (k + 1) % 3], neighbours[t, (k + 2) % 3]
    write_row(triangles, t, vertex, b, c)
    write_row(triangles, new, a, vertex, c)
    write_row(neighbours, t, across_bc, new, -1)
    write_row(neighbours, new, t, across_ca, -1)
    replace_neighbour(neighbours, triangles, across_ca, t, new, c, a)
    append_triangle(cells, new, t)


@loop
def insert_point(triangles, neighbours, t, k, vertex, is_on_edge, count, cells):
    """Insert a vertex into triangle t, on the edge opposite to its corner k or inside.

    `count` is the number of triangles before; returns that after.
    """
    a, b = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
    other = neighbours[t, k]
    split(triangles, neighbours, t, k, vertex, count, cells)
    third = count + 1
    if not is_on_edge:
        write_row(triangles, third, a, b, vertex)
        write_row(neighbours, third, t, count, other)
        replace_neighbour(neighbours, triangles, other, t, third, a, b)
        append_triangle(cells, third, t)
        neighbours[t, 2], neighbours[count, 2] = third, third
        return third + 1
    if other < 0:
        return third
    corner = 3 - corner_of(triangles, other, a) - corner_of(triangles, other, b)
    split(triangles, neighbours, other, corner, vertex, third, cells)
    neighbours[t, 2], neighbours[third, 2] = third, t
    neighbours[count, 2], neighbours[other, 2] = other, count
    return third + 1


@jit
def insert_points(places, triangles, neighbours, count, vertices, cells):
    """Insert vertices (n,) of a lattice at their places (x, y), and return the number of triangles.

    The first `count` rows of `triangles` and `neighbours` are those before; 2 n more are needed. A
    vertex that coincides with another one is left out.
    """
    for n in range(vertices.shape[0]):
        t, k, smallest, second = triangle_around(places, triangles, vertices[n], cells)
        if second > ON_EDGE:
            is_on_edge = smallest <= ON_EDGE
            count = insert_point(triangles, neighbours, t, k, vertices[n], is_on_edge, count, cells)
    return count
