"""Places along the borders of pieces, as candidates for samples: cells without an extent."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..base.trees import tree_of
from ..domain.domain import brought_inside
from ..kernels.sizing import TargetDensity
from .cells import LIMIT, Array, Cells, Evaluator, Indices, by_piece, points_of
from .piece import Piece

__all__ = ["BorderLine", "along_borders", "beside_border", "border_lines"]

# Borders are measured at places that are this part of the domain apart, or less.
FINE = 1.0 / 48.0
# The distance from the border of places beside it, relative to the domain.
BESIDE = 1e-6


@dataclass(frozen=True, eq=False)
class BorderLine:
    """A closed polygon of the border of a piece: places (k, 2), the first one repeated.

    rows (k, 8) and limits (k,) are those of cells there.
    """

    piece: int
    places: Array
    rows: Array
    limits: Array


class Bordered(Evaluator, Protocol):
    """What has borders."""

    @property
    def first(self) -> Cells:
        """Cells that it is made of."""
        ...

    @property
    def borders(self) -> list[BorderLine]:
        """The borders of all pieces."""
        ...

    @property
    def target(self) -> TargetDensity:
        """The target density."""
        ...


def border_lines(space: Bordered) -> list[BorderLine]:
    """Return the borders of all pieces that have a trim of polygons."""
    found = []
    for k, rows in by_piece(space.first):
        piece, cells = space.pieces[k], space.first[rows]
        if piece.trim is None:
            continue
        tree = tree_of(cells.places / piece.sizes)
        for polygon in piece.polygons:
            places = _divided(polygon, piece.sizes, FINE)
            inside = np.clip(_wrapped(piece, places), *np.array(piece.domain).T)
            made = points_of(space, np.full(len(places), k), inside)
            made.numbers[:, LIMIT] = cells.numbers[tree.query(inside / piece.sizes)[1], LIMIT]
            known = space.known(made, keep=True)
            found.append(BorderLine(k, places, known.rows, known.numbers[:, LIMIT]))
    return found


def along_borders(space: Bordered, step: float, turn: float = math.inf) -> Cells:
    """Return places inside, beside borders, that are about step/√w apart, w the target density.

    And normals turn by about `turn` between them at most, in radians.
    """
    pieces, places, limits = [], [np.empty((0, 2))], [np.empty(0)]
    for line in space.borders:
        piece, at = space.pieces[line.piece], _spaced(line, space.target, step, turn)
        number = np.minimum(at.astype(np.int64), len(line.places) - 2)
        steps = np.diff(line.places, axis=0)
        on = line.places[number] + (at - number)[:, None] * steps[number]
        inside, owner = _beside(piece, on, steps[number])
        pieces.append(np.full(len(inside), line.piece))
        places.append(inside)
        limits.append(line.limits[number[owner]])
    made = points_of(
        space, np.concatenate([np.empty(0, np.int64), *pieces]), np.concatenate(places)
    )
    made.numbers[:, LIMIT] = np.concatenate(limits)
    return space.known(made)


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


def beside_border(piece: Piece, step: float) -> Array:
    """Return places (k, 2) inside, close to the border, at distances `step` along it."""
    found = [np.empty((0, 2))]
    for polygon in piece.polygons:
        line = _divided(polygon, piece.sizes, step)
        steps = np.diff(line, axis=0)
        found.append(_beside(piece, line[:-1] + steps / 2.0, steps)[0])
    return np.concatenate(found)


def _divided(polygon: Array, sizes: Array, step: float) -> Array:
    """Return a polygon (k, 2), closed, with further places: steps are `step` of sizes at most."""
    polygon = np.concatenate([polygon, polygon[:1]])
    steps = np.diff(polygon, axis=0)
    parts = np.maximum(np.ceil(np.abs(steps / sizes).max(axis=1) / step), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(steps)), parts)
    number = np.arange(len(owner)) - (np.cumsum(parts) - parts)[owner]
    inner = polygon[owner] + (number / parts[owner])[:, None] * steps[owner]
    return np.concatenate([inner, polygon[-1:]])


def _beside(piece: Piece, places: Array, steps: Array) -> tuple[Array, Indices]:
    """Return which places are inside, of those to the left and right of places (k, 2) on a border.

    And the numbers of these; the border runs along steps (k, 2).
    """
    along = steps / piece.sizes
    lengths = np.hypot(*along.T)
    unit = along / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    across = BESIDE * piece.sizes * np.stack([-unit[:, 1], unit[:, 0]], axis=1)
    both = _wrapped(piece, np.concatenate([places + across, places - across]))
    low, high = np.array(piece.domain).T
    inside = ((both > low) & (both < high)).all(axis=1)
    inside[inside] = piece.contains(both[inside])
    return both[inside], np.tile(np.arange(len(places)), 2)[inside]


def _wrapped(piece: Piece, places: Array) -> Array:
    """Return places less whole periods."""
    if piece.trim is None:
        return places
    u, v = places.T
    return np.stack(brought_inside(u, v, piece.domain, piece.trim.boundary), axis=1)
