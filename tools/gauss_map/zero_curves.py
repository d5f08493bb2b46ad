"""The curves K = 0: contour lines of the signs of K, with exact vertices, cut where they cross.

Signs at the corners of cells do not show which branches belong together at a crossing, which is a
saddle of K. A block of cells around each saddle is cut out, and the curves that enter the block
are led straight to the saddle.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .chains import continued
from .sign_changes import sign_changes
from .sign_grid import SignGrid

__all__ = ["zero_curves"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
# A polyline (k, 2), and whether it is closed: it then ends where it begins, or a period away.
Curve = tuple[Array, bool]
# Accuracy of a vertex relative to the side of a cell on which it lies.
ACCURACY = 1e-11
# What is closer to a corner, relative to the side, is there.
AT_CORNER = 1e-6
# Largest distance, in cells, from a saddle to the border of its block. Curves that cross at a small
# angle need a large block.
LARGEST_BLOCK = 16


def zero_curves(grid: SignGrid, saddles: Array, touched: Array) -> tuple[list[Curve], Array]:
    """Return the curves K = 0, cut at saddles. They may run beyond the ends of a period.

    Also returns the places that K touches without those near saddles, which are on such curves.
    """
    lines = sign_changes(_decided(grid), grid.kinds, lambda *ends: _zeros_between(grid, *ends))
    curves = [(continued(parts), closed) for parts, closed in lines]
    for number, saddle in enumerate(saddles):
        others = np.delete(saddles, number, axis=0)
        curves, touched = _cut(grid, curves, touched, saddle, others)
    return curves, touched


def _cut(
    grid: SignGrid, curves: list[Curve], touched: Array, saddle: Array, others: Array
) -> tuple[list[Curve], Array]:
    """Cut curves at the smallest block around a saddle that at least four curves enter, if any.

    A block that is clipped by the border of the domain needs two only: the ends of the others may
    be shorter than a cell, or outside.
    """
    low, high = np.array([line[[0, -1]] for line in grid.lines]).T
    wraps, cell = np.array(grid.field.wraps), grid.sizes(grid.cells_at(saddle[None]))

    def away(places: Array) -> Array:
        offset = places - saddle
        return offset - np.where(wraps, (high - low) * np.round(offset / (high - low)), 0.0)

    for reach in cell * (np.arange(LARGEST_BLOCK)[:, None] + 1.5):
        if (np.abs(away(others)) <= reach).all(axis=1).any():
            break
        whole = (wraps | ((saddle - reach >= low) & (saddle + reach <= high))).all()
        result, entries = [], 0
        for line, closed in curves:
            from_saddle = away(line)
            near: Mask = (np.abs(from_saddle) <= reach).all(axis=1)
            if not near.any():
                result.append((line, closed))
                continue
            if closed:  # begin inside
                first = int(near.argmax())
                line = np.concatenate([line[first:], line[1 : first + 1] + line[-1] - line[0]])
                from_saddle = np.concatenate([from_saddle[first:], from_saddle[1 : first + 1]])
                near = np.concatenate([near[first:], near[1 : first + 1]])
            line[near] -= from_saddle[near]
            for run in np.split(np.arange(len(line)), np.flatnonzero(np.diff(near)) + 1):
                if not near[run[0]]:
                    before, after = int(run[0] > 0), int(run[-1] < len(line) - 1)
                    entries += before + after
                    result.append((line[run[0] - before : run[-1] + 1 + after], False))
        if entries >= (4 if whole else 2):
            return result, touched[(np.abs(away(touched)) > reach).any(axis=1)]
    return curves, touched


def _decided(grid: SignGrid) -> Array:
    """Return values with the signs of K whose mean has the sign of K at the centre of a cell.

    That decides how two curves are joined that pass through one cell; values are made larger there.
    """
    values, largest = grid.values.copy(), np.nanmax(np.abs(grid.values), initial=0.0)
    positive = values >= 0.0
    opposite = (positive[:-1, :-1] == positive[1:, 1:]) & (positive[1:, :-1] == positive[:-1, 1:])
    cells = np.argwhere(grid.crossed & opposite)
    at_centre = grid.field.evaluate(0.5 * (grid.at(cells) + grid.at(cells + 1))) > 0.0
    for step in np.argwhere(np.ones((2, 2))):
        corner = cells + step
        larger = tuple(corner[positive[tuple(corner.T)] == at_centre].T)
        values[larger] = np.copysign(largest, values[larger])
    return values


def _zeros_between(grid: SignGrid, low: Integers, high: Integers) -> Array:
    """Return the zeros (k, 2) of K between corners (k, 2) of different sign.

    The sign of a corner where K is zero up to its error was taken from its neighbours; K has that
    sign here, too.
    """
    from scipy.optimize.elementwise import find_root

    start, end = grid.at(low), grid.at(high)
    sign = np.where(grid.values[tuple(low.T)] >= 0.0, 1.0, -1.0)

    def K(share: Array, which: Integers) -> Array:
        value = grid.field.evaluate(start[which] + share[:, None] * (end - start)[which])
        at_end = np.where(share == 0.0, sign[which], -sign[which]) * np.abs(value)
        return np.where((share == 0.0) | (share == 1.0), at_end, value)

    none, one = np.zeros(len(low)), np.ones(len(low))
    tolerances = {"xatol": ACCURACY, "xrtol": 0.0, "fatol": 0.0, "frtol": 0.0}
    share = find_root(K, (none, one), args=(np.arange(len(low)),), tolerances=tolerances).x[:, None]
    inner = np.where(share < AT_CORNER, start, start + share * (end - start))
    return np.where(share > 1.0 - AT_CORNER, end, inner)
