"""The search: the places of cells with normals that two evaluations of the surface prove.

Normals come in the order of bins, so that those of a tile have nearly the same cells.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.proved import excesses
from ...generated.vectors import Vector
from ..machine_code.jit import jit, long_vectors, loop
from .bins import bin_index, cube_face
from .proved_cells import REST_S, REST_T, WIDE, Cells, linear_forms_of, patch_of
from .proved_pairs import (
    DETERMINANT,
    HARD,
    HU,
    HV,
    ONE,
    RADIUS,
    ROWS,
    STATE,
    bound_pairs,
    compact,
    improve_pairs,
    load_pair,
)  # fmt: skip
from .tape import LANES, evaluate_points
from .vectors import dot, row_vector

__all__ = ["PLACE", "Found", "Index", "Tiles", "search_normals"]

# The columns of places: u, v, how far each may be from the exact one, D, and whether the border of
# the domain is so near.
PLACE = 6
# Rows of a tile of normals: x, y, z, and the largest of what excludes a cell.
Y, Z, EXCESS = (np.uint64(k * LANES) for k in range(1, 4))


class Index(NamedTuple):
    """Cells, and those of them that may have the normals of each bin of the sphere.

    `starts` (6 grid² + 1,) are the starts of the bins in `members`, the numbers of cells. From
    number `discs` on, cells are discs around poles.
    """

    cells: Cells
    discs: int
    starts: NDArray[np.int64]
    members: NDArray[np.int32]


class Tiles(NamedTuple):
    """Work arrays: a tile of normals, and one of pairs with their cells and numbers of normals."""

    normals: NDArray[np.float64]
    pairs: NDArray[np.float64]
    cells: NDArray[np.int64]
    numbers: NDArray[np.int64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]

    @classmethod
    def new(cls) -> Tiles:
        """Return new work arrays."""
        cells, numbers = np.zeros((2, LANES), np.int64)
        u, v = np.zeros((2, LANES))
        return cls(np.zeros(4 * LANES), np.zeros(ROWS * LANES), cells, numbers, u, v)


class Found(NamedTuple):
    """What a search finds: places (k, 6) and their normals; hard pairs (k, 2) of normal and cell.

    `counts` are the numbers of both.
    """

    places: NDArray[np.float64]
    numbers: NDArray[np.int64]
    hard: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, places: int, hard: int) -> Found:
        """Return room for some of both."""
        return cls(
            np.empty((places, PLACE)), np.empty(places, np.int64), np.empty((hard, 2), np.int64),
            np.zeros(2, np.int64),
        )  # fmt: skip


@loop
def bin_of(normals, k, grid):
    """Return the bin of the cube of row k of normals."""
    face, s, t = cube_face(row_vector(normals, k))
    return (face * grid + bin_index(t, grid)) * grid + bin_index(s, grid)


@loop
def exclude(tile, count, cells, j):
    """Write a positive number for each normal of a tile that cell j does not have by its bounds."""
    long_vectors()
    patch = patch_of(cells.hot, j)
    rest_s, rest_t = cells.hot[j, REST_S], cells.hot[j, REST_T]
    axis, chord = row_vector(cells.cone, j), cells.cone[j, 3]
    square = chord * chord
    for k in range(count):
        i = np.uint64(k)
        n = Vector(tile[i], tile[i + Y], tile[i + Z])
        a, b, c, p, q = linear_forms_of(patch, n)
        e1, e2, e3, e4 = excesses(a, b, c, p, q, rest_s, rest_t)
        away = 2.0 - 2.0 * dot(axis, n) - square
        tile[i + EXCESS] = max(max(max(e1, e2), max(e3, e4)), away)


@loop
def load_normals(tile, normals, first, last):
    """Write normals first, …, last − 1 to a tile; return their middle and distance from it."""
    x = y = z = 0.0
    for k in range(first, last):
        i = np.uint64(k - first)
        tile[i], tile[i + Y], tile[i + Z] = normals[k, 0], normals[k, 1], normals[k, 2]
        x, y, z = x + normals[k, 0], y + normals[k, 1], z + normals[k, 2]
    size = float(last - first)
    middle = Vector(x / size, y / size, z / size)
    square = 0.0
    for k in range(first, last):
        n = row_vector(normals, k)
        square = max(square, (n.x - middle.x) ** 2 + (n.y - middle.y) ** 2 + (n.z - middle.z) ** 2)
    return middle, math.sqrt(square) * (1.0 + 1e-12)


@loop
def flush(tape, work, cells, tiles, first, count, found):
    """Evaluate the pairs of a tile, those from `first` on for the first time.

    Returns how many stay in the tile, or −1 if there was no room for what was found.
    """
    if (
        found.counts[0] + count > found.numbers.shape[0]
        or found.counts[1] + count > found.hard.shape[0]
    ):
        return -1
    t = tiles.pairs
    bound_pairs(t, first, count)
    store_hard(t, count, tiles, found)
    kept = compact(t, count, tiles.cells, tiles.numbers, tiles.u, tiles.v)
    if kept == 0:
        return 0
    evaluate_points(tape, tiles.u, tiles.v, kept, work.registers)
    improve_pairs(t, kept, work.registers, tape.outputs, tiles.u, tiles.v)
    store_hard(t, kept, tiles, found)
    at = found.counts[0]
    for k in range(kept):
        i = np.uint64(k)
        if t[i + STATE] == ONE:
            found.places[at, 0], found.places[at, 1] = tiles.u[k], tiles.v[k]
            found.places[at, 2], found.places[at, 3] = (
                t[i + RADIUS] * t[i + HU],
                t[i + RADIUS] * t[i + HV],
            )
            found.places[at, 4], found.places[at, 5] = t[i + DETERMINANT], 0.0
            found.numbers[at] = tiles.numbers[k]
            at += 1
    found.counts[0] = at
    return compact(t, kept, tiles.cells, tiles.numbers, tiles.u, tiles.v)


@loop
def store_hard(t, count, tiles, found):
    """Store the pairs of a tile that are not decided here."""
    at = found.counts[1]
    for k in range(count):
        if t[np.uint64(k) + STATE] >= HARD:
            found.hard[at, 0], found.hard[at, 1] = tiles.numbers[k], tiles.cells[k]
            at += 1
    found.counts[1] = at


@jit
def search_normals(index, tape, work, normals, grid, first, last, tiles, found):
    """Find the places with the normals first, …, last − 1; say whether there was room for them.

    A row of normals (S, 4) is a unit normal and its number; `grid` is that of the bins.
    """
    found.counts[0] = found.counts[1] = 0
    cells, tile = index.cells, tiles.normals
    kept = count = 0  # pairs in the tile, those that have been there before in front
    at = first
    while at < last:
        square = bin_of(normals, at, grid)
        end = at + 1
        while end < last and end - at < LANES and bin_of(normals, end, grid) == square:
            end += 1
        middle, radius = load_normals(tile, normals, at, end)
        for member in range(index.starts[square], index.starts[square + 1]):
            j = index.members[member]
            axis = row_vector(cells.cone, j)
            x, y, z = axis.x - middle.x, axis.y - middle.y, axis.z - middle.z
            reach = cells.cone[j, 3] + radius
            if x * x + y * y + z * z > reach * reach:
                continue
            exclude(tile, end - at, cells, j)
            for k in range(end - at):
                if tile[np.uint64(k) + EXCESS] > 0.0:
                    continue
                if cells.cone[j, 3] >= WIDE or j >= index.discs:
                    hard = found.counts[1]
                    if hard >= found.hard.shape[0]:
                        return False
                    found.hard[hard, 0], found.hard[hard, 1] = np.int64(normals[at + k, 3]), j
                    found.counts[1] += 1
                    continue
                load_pair(tiles.pairs, count, cells, j, row_vector(normals, at + k))
                tiles.cells[count], tiles.numbers[count] = j, np.int64(normals[at + k, 3])
                count += 1
                while count == LANES:
                    kept = count = flush(tape, work, cells, tiles, kept, count, found)
                if count < 0:
                    return False
        at = end
    while count > 0:
        kept = count = flush(tape, work, cells, tiles, kept, count, found)
    return count == 0
