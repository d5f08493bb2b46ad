"""Pairs of a normal and a cell that a few evaluations of the surface decide."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...directions.kernels.vectors import row_vector
from ...machine_code.jit import jit, loop
from ...search.kernels.lists import NUMBER
from ...tape.kernels.points import LANES, evaluate_points
from .cell_bounds import CellBounds
from .pairs import (
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
)

# The columns of places: u, v, the error bound of each, D, and whether the error bounds reach the
# boundary of the domain.
PLACE = 6


class Lines(NamedTuple):
    """Lines u = const (k,) and v = const (l,)."""

    u: NDArray[np.float64]
    v: NDArray[np.float64]


class Index(NamedTuple):
    """The cells of a surface; from index `discs` on, cells are discs at poles.

    Cells end at joints, where derivatives may jump, but the normal does not, and at creases, where
    the normal jumps.
    """

    cells: CellBounds
    discs: int
    joints: Lines
    creases: Lines


class Tiles(NamedTuple):
    """Work arrays: a tile of pairs with the indices of their cells and normals."""

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
        return cls(np.zeros(ROWS * LANES), cells, numbers, u, v)


class Outcome(NamedTuple):
    """The outcome: proved places (k, 6) and their normals; hard pairs (k, 2) of normal and cell.

    `counts` are the numbers of both.
    """

    places: NDArray[np.float64]
    numbers: NDArray[np.int64]
    hard: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, places: int, hard: int) -> Outcome:
        """Return arrays with room for these numbers of places and of hard pairs."""
        return cls(
            np.empty((places, PLACE)), np.empty(places, np.int64), np.empty((hard, 2), np.int64),
            np.zeros(2, np.int64),
        )  # fmt: skip


@loop
def flush(tape, work, cells, tiles, first, count, found):
    """Evaluate the pairs of a tile; those from position `first` on are new.

    Returns how many pairs stay in the tile, or −1 if there was no room for the results.
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
    """Store pairs of a tile that are undecided, or have a solution near a side, as hard pairs."""
    at = found.counts[1]
    for k in range(count):
        if t[np.uint64(k) + STATE] >= HARD:
            found.hard[at, 0], found.hard[at, 1] = tiles.numbers[k], tiles.cells[k]
            at += 1
    found.counts[1] = at


@jit
def evaluate_pairs(cells, tape, work, normals, keys, tiles, found):
    """Find the solutions of pairs; return whether there was room for them.

    A key is (index of a normal in (S, 3)) << 32 | index of a cell.
    """
    found.counts[0] = found.counts[1] = 0
    kept = count = 0  # pairs in the tile; those with an earlier evaluation come first
    for key in keys:
        number, j = key >> 32, key & NUMBER
        load_pair(tiles.pairs, count, cells, j, row_vector(normals, number))
        tiles.cells[count], tiles.numbers[count] = j, number
        count += 1
        while count == LANES:
            kept = count = flush(tape, work, cells, tiles, kept, count, found)
        if count < 0:
            return False
    while count > 0:
        kept = count = flush(tape, work, cells, tiles, kept, count, found)
    return count == 0
