"""Which cells are inside the trims of their pieces, and where in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..base.aliases import Array, Flags, Indices
from .cells import Cells, by_piece
from .piece import Piece

__all__ = ["beside", "placed", "sifted"]

# Cells that the border passes are tested at SUB² places.
SUB = 4


def sifted(
    pieces: Sequence[Piece], cells: Cells, pixels: Indices, owner: Indices | None = None
) -> tuple[Cells, Indices]:
    """Return cells without those outside, and which are whole; and the owners of these."""
    kept, whole = np.ones(len(cells), dtype=np.bool_), cells.whole.copy()
    for k, rows in by_piece(cells):
        piece, open_ = pieces[k], ~cells.whole[rows]
        border = piece.border(int(pixels[k]))
        if border is None or not open_.any():
            whole[rows] = True
            continue
        here = np.arange(rows.start, rows.stop)[open_]
        clear = here[~border.passes(cells.boxes[here])]
        inside = piece.contains(cells.places[clear])
        whole[clear], kept[clear] = inside, inside
    found = replace(cells, whole=whole)
    owner = np.arange(len(cells)) if owner is None else owner
    return (found, owner) if kept.all() else (found[kept], owner[kept])


def placed(pieces: Sequence[Piece], cells: Cells) -> tuple[Cells, Cells]:
    """Return the cells that have a place inside, with it, and those without."""
    found, places = cells.whole.copy(), cells.places.copy()
    for k, rows in by_piece(cells):
        if cells.whole[rows].all():
            continue
        piece, here = pieces[k], np.arange(rows.start, rows.stop)[~cells.whole[rows]]
        inside = piece.contains(places[here])
        found[here] = inside
        here = here[~inside]
        if len(here):
            found[here], places[here] = _subplaces(piece, cells.boxes[here])
    cells = replace(cells, places=places)
    return (cells, cells[np.flatnonzero(~found)]) if found.all() else (cells[found], cells[~found])


def beside(pieces: Sequence[Piece], lost: Cells, pixels: Indices) -> tuple[Indices, Array]:
    """Return places (k, 2) next to the border where cells have none inside, and their pieces."""
    owners, places = [np.empty(0, dtype=np.int64)], [np.empty((0, 2))]
    for k, rows in by_piece(lost):
        n, piece = int(pixels[k]), pieces[k]
        border = piece.border(n)
        assert border is not None
        found = piece.beside_border(0.5 / n)
        places.append(found[border.near(lost.boxes[rows], found)])
        owners.append(np.full(len(places[-1]), k))
    return np.concatenate(owners), np.concatenate(places)


def _subplaces(piece: Piece, boxes: Array) -> tuple[Flags, Array]:
    """Return which boxes (M, 4) have a subplace inside, and the one in the middle of these."""
    steps = (np.arange(SUB) + 0.5) / SUB
    grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    sizes = boxes[:, None, 2:] - boxes[:, None, :2]
    inside = piece.contains((boxes[:, None, :2] + grid * sizes).reshape(-1, 2)).reshape(
        -1, SUB * SUB
    )
    number = inside.sum(axis=1)
    mean = (inside @ grid) / np.maximum(number, 1)[:, None]
    squares = ((grid - mean[:, None]) ** 2).sum(axis=2)
    best = grid[np.where(inside, squares, np.inf).argmin(axis=1)]
    return number > 0, boxes[:, :2] + best * (boxes[:, 2:] - boxes[:, :2])
