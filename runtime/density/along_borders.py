"""Places along the borders of pieces, as candidates for samples."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Indices
from ..base.trees import tree_of
from ..kernels.sizing import TargetDensity
from .cells import LIMIT, Cells, by_piece
from .piece import Piece

__all__ = ["BorderLine", "places_along", "polygons_of"]

# Borders are measured at places that are this part of the domain apart, or less.
FINE = 1.0 / 48.0


@dataclass(frozen=True, eq=False)
class BorderLine:
    """A closed polygon of the border of a piece: places (k, 2), the first one repeated.

    rows (k, 8) and limits (k,) are those of cells there.
    """

    piece: int
    places: Array
    rows: Array
    limits: Array


def polygons_of(pieces: Sequence[Piece], first: Cells) -> Iterator[tuple[int, Array, Array, Array]]:
    """Yield the closed polygons (k, 2) of all pieces that have a trim, with the numbers of these.

    Places are `FINE` apart at most. With them come the same places less whole periods, and the
    limits (k,) of the first cells near them.
    """
    for k, rows in by_piece(first):
        piece, cells = pieces[k], first[rows]
        if piece.trim is None:
            continue
        tree = tree_of(cells.places / piece.sizes)
        for places in piece.border_lines(FINE):
            inside = np.clip(piece.wrapped(places), *np.array(piece.domain).T)
            yield k, places, inside, cells.numbers[tree.query(inside / piece.sizes)[1], LIMIT]


def places_along(
    pieces: Sequence[Piece],
    lines: Sequence[BorderLine],
    target: TargetDensity,
    step: float,
    turn: float,
) -> tuple[Indices, Array, Array]:
    """Return places inside, beside borders, that are about step/√w apart, w the target density.

    And normals turn by about `turn` between them at most, in radians. The places (k, 2) come with
    the numbers of their pieces (k,) and with their limits (k,).
    """
    owners, places, limits = [np.empty(0, np.int64)], [np.empty((0, 2))], [np.empty(0)]
    for line in lines:
        piece, at = pieces[line.piece], _spaced(line, target, step, turn)
        number = np.minimum(at.astype(np.int64), len(line.places) - 2)
        steps = np.diff(line.places, axis=0)
        on = line.places[number] + (at - number)[:, None] * steps[number]
        inside, owner = piece.beside(on, steps[number])
        owners.append(np.full(len(inside), line.piece))
        places.append(inside)
        limits.append(line.limits[number[owner]])
    return np.concatenate(owners), np.concatenate(places), np.concatenate(limits)


def _spaced(line: BorderLine, target: TargetDensity, step: float, turn: float) -> Array:
    """Return where places are: 1.5 is between the second and the third place of the line."""
    rates = np.sqrt(np.clip(line.rows[:, 6], target.floor, target.ceiling))
    lengths = np.linalg.norm(np.diff(line.rows[:, :3], axis=0), axis=1)
    costs = lengths * np.maximum(rates[1:], rates[:-1]) / step
    normals = line.rows[:, 3:6]
    chords = np.linalg.norm(np.diff(normals, axis=0), axis=1)
    regular = np.asarray(normals.any(axis=1))
    turns = np.where(regular[1:] & regular[:-1], chords, 0.0) / turn
    total = np.concatenate([[0.0], np.cumsum(np.maximum(costs, turns))])
    number = math.ceil(total[-1])
    return np.interp(total[-1] * (np.arange(number) + 0.5) / number, total, np.arange(len(total)))
