"""Candidates for samples along the boundaries of pieces."""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.trees import tree_of
from .cells import Cells
from .kernels.sizing import TargetDensity
from .trims import Trims

# Neighbouring vertices of the polygons are at most this part of the domain apart.
FINE = 1.0 / 48.0
# In the search for the nearest cells, domains are scaled to width 1, and different pieces are
# shifted this far apart.
FAR = 16.0
PLACES_AT_A_TIME = 1 << 17


@dataclass(frozen=True, eq=False)
class BorderLines:
    """L closed polygons along boundaries; polygon l is on the boundary of piece pieces[l].

    The vertices of polygon l are places[starts[l] : starts[l + 1]], the first one repeated at the
    end. `rows` (k, 8) and `limits` (k,) are those of point cells at all k vertices; see `Cells`.
    """

    pieces: Indices
    starts: Indices
    places: Array
    rows: Array
    limits: Array


def polygons_of(trims: Trims, first: Cells) -> tuple[Indices, Indices, Array, Array, Array]:
    """Return the closed polygons of all trimmed pieces, with vertices at most `FINE` apart.

    The polygons are given by the pieces (L,), starts (L + 1,) and places (k, 2) of `BorderLines`.
    Also return the vertices (k, 2) moved into the domains, modulo periods, and for each vertex the
    least radius of curvature (k,): the limit of the nearest cell of `first`.
    """
    used = np.unique(first.pieces)
    numbers, lines = list[int](), [np.empty((0, 2))]
    for k in used[trims.trimmed[used]].tolist():
        lines += trims.pieces[k].border_lines(FINE)
        numbers += [k] * (len(lines) - 1 - len(numbers))
    counts = [len(x) for x in lines[1:]]
    pieces, places = np.repeat(np.array(numbers, np.int64), counts), np.concatenate(lines)
    low, high = trims.domains[pieces, :, 0], trims.domains[pieces, :, 1]
    inside = np.clip(trims.wrapped(pieces, places), low, high)
    near = first[trims.trimmed[first.pieces]]
    limits = np.empty(len(places))
    if len(places):  # a tree takes long to load
        tree = tree_of(_apart(near.pieces, near.places, trims))
        limits[:] = near.limits[tree.query(_apart(pieces, inside, trims))[1]]
    return np.array(numbers, np.int64), np.cumsum([0, *counts]), places, inside, limits


def _apart(pieces: Indices, places: Array, trims: Trims) -> Array:
    """Return points (k, 3) for a search for neighbours among parameters (k, 2) of pieces (k,).

    Parameters are relative to the size of the domain. The third coordinate separates the pieces.
    """
    low, high = trims.domains[pieces, :, 0], trims.domains[pieces, :, 1]
    found = np.empty((len(places), 3))
    found[:, :2], found[:, 2] = places / (high - low), FAR * pieces
    return found


def places_along(
    trims: Trims, lines: BorderLines, target: TargetDensity, step: float, turn: float
) -> tuple[Indices, Array, Array]:
    """Return parameters just inside boundaries, about step/√w apart; w is the target density.

    Normals of neighbours differ by about `turn` radians at most. Return the pieces (k,), the
    parameters (k, 2), and the least radii of curvature (k,), the `limits` of `Cells`. The result is
    sorted by polygon and, for each polygon, by side: left of it, right of it, on it.
    """
    owner, number, share = _spaced(lines, target, step, turn)
    steps = lines.places[number + 1] - lines.places[number]
    on = lines.places[number] + share[:, None] * steps
    pieces, found = lines.pieces[owner], [(np.empty((0, 2)), *np.empty((2, 0), np.int64))]
    for first in range(0, len(owner), PLACES_AT_A_TIME):
        here = slice(first, first + PLACES_AT_A_TIME)
        inside, numbers, sides = trims.beside(pieces[here], on[here], steps[here])
        found.append((inside, first + numbers, sides))
    places, numbers, sides = map(np.concatenate, zip(*found, strict=True))
    order = np.lexsort((numbers, sides, owner[numbers]))
    every = numbers[order]
    return pieces[every], places[order], lines.limits[number[every]]


def _spaced(
    lines: BorderLines, target: TargetDensity, step: float, turn: float
) -> tuple[Indices, Indices, Array]:
    """Return k positions along polygons, at the spacing of `places_along`.

    Return the indices of polygons (k,), the indices of vertices (k,), and fractions (k,): a
    position is at this fraction of the way from the vertex to the next one.
    """
    rates = np.sqrt(np.clip(lines.rows[:, 6], target.floor, target.ceiling))
    lengths = np.linalg.norm(np.diff(lines.rows[:, :3], axis=0), axis=1)
    costs = lengths * np.maximum(rates[1:], rates[:-1]) / step
    normals = lines.rows[:, 3:6]
    chords = np.linalg.norm(np.diff(normals, axis=0), axis=1)
    regular = np.asarray(normals.any(axis=1))
    turns = np.where(regular[1:] & regular[:-1], chords, 0.0) / turn
    costs = np.maximum(costs, turns)
    owners, numbers, shares = [np.empty(0, np.int64)], [np.empty(0, np.int64)], [np.empty(0)]
    for k, (first, last) in enumerate(itertools.pairwise(lines.starts.tolist())):
        total = np.concatenate([[0.0], np.cumsum(costs[first : last - 1])])
        count = math.ceil(total[-1])
        at = np.interp(total[-1] * (np.arange(count) + 0.5) / count, total, np.arange(len(total)))
        before = np.minimum(at.astype(np.int64), len(total) - 2)
        owners.append(np.full(count, k))
        numbers.append(first + before)
        shares.append(at - before)
    return np.concatenate(owners), np.concatenate(numbers), np.concatenate(shares)
