"""Selection of the cells inside the trims of their pieces, and choice of their places."""

from dataclasses import replace

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from .cells import Cells, runs
from .trims import Trims

# Cells that the boundary intersects are tested at SUB² points, their subplaces.
SUB = 4
BOXES_AT_A_TIME = 1 << 13


def sifted(
    trims: Trims, cells: Cells, pixels: Indices, owner: Indices | None = None
) -> tuple[Cells, Indices]:
    """Return the cells that are not entirely outside their trims, and the owners of these cells.

    `whole` becomes True for cells that no boundary intersects. The owner of a cell is its element
    of `owner` (M,), by default its index in `cells`.
    """
    whole = cells.whole | ~trims.trimmed[cells.pieces]
    open_, clear = np.flatnonzero(~whole), whole.copy()
    for k, rows in runs(cells.pieces[open_]):
        here, border = open_[rows], trims.pieces[k].border(int(pixels[k]))
        assert border is not None
        clear[here] = ~border.passes(cells.boxes[here])
    here, kept = open_[clear[open_]], np.ones(len(cells), dtype=np.bool_)
    whole[here] = kept[here] = trims.contains(cells.pieces[here], cells.places[here])
    found = replace(cells, whole=whole)
    owner = np.arange(len(cells)) if owner is None else owner
    return (found, owner) if kept.all() else (found[kept], owner[kept])


def placed(trims: Trims, cells: Cells) -> tuple[Cells, Cells]:
    """Return the cells that have a place inside the trim, and the other cells.

    Places of cells in the first set that are outside of the trim are replaced by subplaces.
    """
    found, places, here = cells.whole.copy(), cells.places.copy(), np.flatnonzero(~cells.whole)
    found[here] = trims.contains(cells.pieces[here], places[here])
    lost = here[~found[here]]
    for first in range(0, len(lost), BOXES_AT_A_TIME):
        here = lost[first : first + BOXES_AT_A_TIME]
        found[here], places[here] = _subplaces(trims, cells.pieces[here], cells.boxes[here])
    cells = replace(cells, places=places)
    return (cells, cells[np.flatnonzero(~found)]) if found.all() else (cells[found], cells[~found])


def beside(trims: Trims, lost: Cells, pixels: Indices) -> tuple[Indices, Array]:
    """Return points beside boundaries, near cells that have no place.

    Return the indices (k,) of the pieces, and the parameters (k, 2) of the points.
    """
    owners, places = [np.empty(0, dtype=np.int64)], [np.empty((0, 2))]
    for k, rows in runs(lost.pieces):
        n = int(pixels[k])
        border = trims.pieces[k].border(n)
        assert border is not None
        found = trims.beside_border(k, 0.5 / n)
        places.append(found[border.near(lost.boxes[rows], found)])
        owners.append(np.full(len(places[-1]), k))
    return np.concatenate(owners), np.concatenate(places)


def _subplaces(trims: Trims, pieces: Indices, boxes: Array) -> tuple[Flags, Array]:
    """Return whether each box (M, 4) has subplaces inside the trim, and the most central of these.

    The most central subplace (M, 2) of a box is the nearest to the mean of its subplaces inside.
    """
    steps = (np.arange(SUB) + 0.5) / SUB
    grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    sizes = boxes[:, None, 2:] - boxes[:, None, :2]
    every = (boxes[:, None, :2] + grid * sizes).reshape(-1, 2)
    inside = trims.contains(np.repeat(pieces, SUB * SUB), every).reshape(-1, SUB * SUB)
    number = inside.sum(axis=1)
    mean = (inside @ grid) / np.maximum(number, 1)[:, None]
    squares = ((grid - mean[:, None]) ** 2).sum(axis=2)
    best = grid[np.where(inside, squares, np.inf).argmin(axis=1)]
    return number > 0, boxes[:, :2] + best * (boxes[:, 2:] - boxes[:, :2])
