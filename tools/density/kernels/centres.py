"""Discrete Voronoi cells of samples: their centres, and the widest gaps.

The cell of a candidate that no boundary intersects is nearly a parallelogram, with a grid of FINER²
points. The list of the candidate has the few samples among which their nearest ones are.
"""

from __future__ import annotations

import math

import numpy as np

from ....generated.vectors import Vector
from ....runtime.directions.kernels.vectors import length, row_vector
from ....runtime.machine_code.jit import inline, jit, loop
from .hash_grids import DENSITY, SQUARE

__all__ = ["FINER", "add_moments", "begin_lists", "find_nearest", "find_widest"]

# The number of fine points along each side of a cell.
FINER = 4
PLACES = FINER * FINER
# The columns of `numbers` of cells, see kernels/cells.py.
AREA, U, V = 6, 8, 11


@inline
def offset(i):
    """Return the coordinate of fine point i along a side, from −1/2 to 1/2."""
    return (i + 0.5) / FINER - 0.5


@inline
def place_in(candidates, lists, k, i, j):
    """Return fine point (i, j) in the cell of candidate k."""
    row, s, t = lists.order[k], offset(i), offset(j)
    sides = lists.numbers
    return Vector(
        candidates[k, 0] + s * sides[row, U] + t * sides[row, V],
        candidates[k, 1] + s * sides[row, U + 1] + t * sides[row, V + 1],
        candidates[k, 2] + s * sides[row, U + 2] + t * sides[row, V + 2],
    )


@inline
def extent(lists, k):
    """Return the radius of the ball around candidate k with all fine points of its cell."""
    sides, row = lists.numbers, lists.order[k]
    u, v = row_vector(sides[:, U:V], row), row_vector(sides[:, V:], row)
    diagonal = max(
        length(Vector(u.x + v.x, u.y + v.y, u.z + v.z)),
        length(Vector(u.x - v.x, u.y - v.y, u.z - v.z)),
    )
    return offset(FINER - 1) * diagonal


@inline
def squared_distance(x, rows, k):
    """Return the squared distance of x from the point of row k."""
    dx, dy, dz = x.x - rows[k, 0], x.y - rows[k, 1], x.z - rows[k, 2]
    return dx * dx + dy * dy + dz * dz


@loop
def find_in_cell(candidates, lists, samples, k, work):
    """Write the fine points of a cell, with their nearest samples, to work (5, FINER²).

    The rows are x, y, z, the squared distance, and the index of the nearest sample in the list.
    """
    row, sides = lists.order[k], lists.numbers
    p, u, v = (
        row_vector(candidates, k),
        row_vector(sides[:, U:V], row),
        row_vector(sides[:, V:], row),
    )
    for i in range(FINER):
        s = offset(i)
        for j in range(FINER):
            t, m = offset(j), np.uint64(FINER * i + j)  # unsigned: no check for negative indices
            work[0, m] = p.x + s * u.x + t * v.x
            work[1, m] = p.y + s * u.y + t * v.y
            work[2, m] = p.z + s * u.z + t * v.z
            work[3, m] = math.inf
    for c in range(lists.counts[k]):
        number = lists.near[k, c]
        y, name = row_vector(samples, number), float(number)
        for at in range(PLACES):
            m = np.uint64(at)
            dx, dy, dz = work[0, m] - y.x, work[1, m] - y.y, work[2, m] - y.z
            square = dx * dx + dy * dy + dz * dz
            nearer = square < work[3, m]
            work[3, m] = square if nearer else work[3, m]
            work[4, m] = name if nearer else work[4, m]


@jit
def begin_lists(grids, lists, margin):
    """Write the radius around each candidate within which samples are listed.

    These samples may be the nearest ones in the cell after moves by up to margin/√w.
    """
    for k in range(lists.within.size):
        away = math.sqrt(max(grids.candidates[k, SQUARE], 0.0))
        reach = extent(lists, k) * math.sqrt(grids.candidates[k, DENSITY])
        lists.within[k] = (away + 2.0 * reach + margin) ** 2


@jit
def add_moments(candidates, lists, samples, work, moments):
    """Add the fine points in the cells of candidates to the moments (N, 4) of the nearest samples.

    Moments are the sums of weights times the points, and of the weights: area times w² times the
    squared distance from the sample. At the mean with these weights, the integral of w² times the
    fourth power of the distance over the Voronoi cell has the gradient 0 by the sample. The mean is
    near the centre of the smallest ball around the cell.
    """
    for k in range(candidates.shape[0]):
        if lists.counts[k] == 0:
            continue
        find_in_cell(candidates, lists, samples, k, work)
        factor = lists.numbers[lists.order[k], AREA] * candidates[k, DENSITY] ** 2
        for m in range(PLACES):
            nearest, weight = int(work[4, m]), factor * work[3, m]
            moments[nearest, 0] += weight * work[0, m]
            moments[nearest, 1] += weight * work[1, m]
            moments[nearest, 2] += weight * work[2, m]
            moments[nearest, 3] += weight


@jit
def find_nearest(candidates, lists, points, found, squares):
    """Find the fine point nearest to each of the points (N, 3), one for each sample.

    found (N, 2) are the row of the candidate and the index of the fine point, −1 for the candidate
    itself; squares (N,) are the squared distances so far, −1 for a sample without a point.
    """
    for k in range(candidates.shape[0]):
        x, reach = Vector(candidates[k, 0], candidates[k, 1], candidates[k, 2]), extent(lists, k)
        for c in range(lists.counts[k]):
            number = lists.near[k, c]
            away = squared_distance(x, points, number)
            if away < squares[number]:
                squares[number] = away
                found[number, 0], found[number, 1] = lists.order[k], -1
            if squares[number] < 0.0 or away >= reach * reach:
                continue
            for m in range(PLACES):
                place = place_in(candidates, lists, k, m // FINER, m % FINER)
                square = squared_distance(place, points, number)
                if square < squares[number]:
                    squares[number] = square
                    found[number, 0], found[number, 1] = lists.order[k], m


@jit
def find_widest(candidates, lists, samples, least, work, found):
    """Find the point of each cell that is farthest from all samples, and at least least/√w away.

    found (M,) are the indices of the points, −1 for the candidate itself, −2 if there is none.
    """
    for k in range(candidates.shape[0]):
        found[k] = -2
        density, away = candidates[k, DENSITY], math.inf
        x = Vector(candidates[k, 0], candidates[k, 1], candidates[k, 2])
        for c in range(lists.counts[k]):
            away = min(away, squared_distance(x, samples, lists.near[k, c]))
        if lists.counts[k] == 0:
            away = candidates[k, SQUARE] / density
        if (math.sqrt(max(away, 0.0)) + extent(lists, k)) * math.sqrt(density) < least:
            continue
        far = least * least
        if away * density >= far:
            far, found[k] = away * density, -1
        if lists.counts[k] > 0:
            find_in_cell(candidates, lists, samples, k, work)
            for m in range(PLACES):
                if work[3, m] * density >= far:
                    far, found[k] = work[3, m] * density, m
