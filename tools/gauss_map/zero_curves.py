"""The curves K = 0: contour lines of the signs of K, with exact vertices, cut where they cross.

Signs at the corners of cells do not show which branches belong together at a crossing, which is a
saddle of K. A block of cells around each saddle is cut out, and the curves that enter the block
are led straight to the saddle.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from numpy.typing import NDArray

from .chains import Segment, joined
from .saddles import SAME, crossings
from .sign_grid import SignGrid

__all__ = ["zero_curves"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
# Accuracy of a vertex relative to the side of a cell on which it lies.
ACCURACY = 1e-11
# Largest distance, in cells, from a saddle to the border of its block. Curves that cross at a small
# angle need a large block.
LARGEST_BLOCK = 16
# Size of the values handed to the contouring where a cell has to be decided by its centre.
DECISIVE = 3.0


def zero_curves(grid: SignGrid, size: Array) -> tuple[list[tuple[Array, bool]], Mask]:
    """Return the curves K = 0 as polylines (k, 2), whether each is closed, and the cells cut out.

    Curves whose distance at a saddle of K is less than `size` (2,) cross there, and end.
    """
    contours = _Contours(grid)
    for saddle in crossings(grid, size):
        contours.cut(saddle)
    pieces = contours.pieces() + contours.spokes + _along_borders(contours)
    return joined(pieces), contours.taken


class _Contours:
    """The contour lines of the signs of K on a grid, as segments that pass through one cell each.

    A vertex lies on a side of a cell; its `codes` are the coordinates of the middle of that side in
    half cells, modulo the periods: a name of the vertex.
    """

    def __init__(self, grid: SignGrid) -> None:
        self.grid = grid
        self.taken = np.zeros_like(grid.mask)
        self.spokes: list[Segment] = []
        lines = _contour_lines(grid)
        x = np.concatenate([np.empty((0, 2)), *lines])
        owner = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
        ends = np.stack([np.floor(x), np.ceil(x)]).astype(np.int64)
        self.codes = self.modulo(ends.sum(axis=0))
        middle = np.floor(0.5 * (x[1:] + x[:-1])).astype(np.int64)
        # The step from one line to the next is no segment, and may lie beyond the last cell.
        self.cells = np.minimum(middle, np.array(grid.mask.shape) - 1)
        self.kept = (owner[1:] == owner[:-1]) & grid.mask[tuple(self.cells.T)]
        used = np.zeros(len(x), dtype=bool)
        used[:-1] |= self.kept
        used[1:] |= self.kept
        self.places = np.full(x.shape, np.nan)
        self.places[used] = _zeros_between(grid, *ends[:, used])

    def cut(self, saddle: Array) -> None:
        """Cut out the smallest block around a saddle that at least four curves enter, if any.

        A block that is clipped by the border of the domain needs two only: the ends of the others
        may be shorter than a cell, or outside.
        """
        count, wraps = np.array(self.taken.shape), self.grid.field.wraps
        centre = np.array([int(k[0]) for k in self.grid.cells_at(saddle[None])])
        apart = np.abs(self.cells - centre)
        apart = np.where(wraps, np.minimum(apart, count - apart), apart).max(axis=1)
        for reach in range(1, LARGEST_BLOCK + 1):
            block, whole = self._block(centre, reach)
            if not self.grid.mask[block].all() or self.taken[block].any():
                return
            inside = self.kept & (apart <= reach)
            entries, places = self._entries(inside, saddle)
            if len(entries) >= (4 if whole else 2):
                self.taken[block] = True
                self.kept &= ~inside
                node = ("crossing", *saddle.tolist())
                self.spokes += [
                    (_name(code), node, np.stack([place, saddle]))
                    for code, place in zip(entries, places, strict=True)
                ]
                return

    def pieces(self) -> list[Segment]:
        """Return the runs of segments that were kept."""
        kept = np.flatnonzero(self.kept)
        runs = np.split(kept, np.flatnonzero(np.diff(kept) > 1) + 1) if len(kept) else []
        return [
            (_name(self.codes[a]), _name(self.codes[b]), self.places[a : b + 1])
            for a, b in ((run[0], run[-1] + 1) for run in runs)
        ]

    def modulo(self, codes: Integers) -> Integers:
        """Return coordinates (…, 2) in half cells, modulo the period in periodic directions."""
        period = 2 * np.array(self.taken.shape)
        return np.where(self.grid.field.wraps, np.mod(codes, period), codes)

    def _block(self, centre: Integers, reach: int) -> tuple[tuple[Integers, ...], bool]:
        """Return the cells of a block as an index, and whether it lies inside the domain."""
        axes, whole = [], True
        for k, count, wraps in zip(centre, self.taken.shape, self.grid.field.wraps, strict=True):
            cells = np.arange(k - reach, k + reach + 1)
            inside = (cells >= 0) & (cells < count)
            axes.append(np.mod(cells, count) if wraps else cells[inside])
            whole = whole and (wraps or bool(inside.all()))
        return np.ix_(*axes), whole

    def _entries(self, inside: Mask, saddle: Array) -> tuple[Integers, Array]:
        """Return codes and places of vertices where curves enter the block of these segments.

        These are the ends of one segment only. They are moved by periods to be next to the saddle.
        """
        numbers = np.flatnonzero(inside)
        numbers = np.concatenate([numbers, numbers + 1])
        codes, first, counts = np.unique(
            self.codes[numbers], axis=0, return_index=True, return_counts=True
        )
        places = self.places[numbers[first]]
        period = np.array([line[-1] - line[0] for line in self.grid.lines])
        away = places - saddle
        away -= np.where(self.grid.field.wraps, period * np.round(away / period), 0.0)
        cell = np.array([np.diff(line).min() for line in self.grid.lines])
        entry = (counts == 1) & (np.abs(away) > SAME * cell).any(axis=1)
        return codes[entry], (saddle + away)[entry]


def _name(code: Integers) -> Hashable:
    return tuple(code.tolist())


def _contour_lines(grid: SignGrid) -> list[Array]:
    """Return the lines (k, 2) between corners of different sign, in cells.

    Two curves pass through a cell whose four sides are crossed. The sign of K at its centre decides
    how they are joined; contourpy takes the mean of the corners instead, so that two of these are
    made larger.
    """
    from contourpy import LineType, contour_generator  # not needed for splines

    values = np.where(grid.signs, 1.0, -1.0)
    i, j = np.nonzero(grid.crossed & (grid.signs[:-1, :-1] == grid.signs[1:, 1:])
                      & (grid.signs[1:, :-1] == grid.signs[:-1, 1:]))  # fmt: skip
    if len(i):
        centres = grid.rectangles_at(i, j).mean(axis=1)
        positive = grid.field.evaluate(centres) > 0.0
        for di, dj in ((0, 0), (1, 0), (0, 1), (1, 1)):
            larger = grid.signs[i + di, j + dj] == positive
            corner = i[larger] + di, j[larger] + dj
            values[corner] = DECISIVE * np.sign(values[corner])
    # contourpy counts the second axis first.
    lines = contour_generator(z=values.T, line_type=LineType.Separate).lines(0.0)
    return [np.asarray(line) for line in lines]


def _zeros_between(grid: SignGrid, low: Integers, high: Integers) -> Array:
    """Return the zeros (k, 2) of K between corners (k, 2) of different sign.

    The sign of a corner where K is zero up to its error was taken from its neighbours; K has that
    sign here, too.
    """
    from scipy.optimize.elementwise import find_root

    start, end = (
        np.stack([line[k] for line, k in zip(grid.lines, x.T, strict=True)], axis=1)
        for x in (low, high)
    )
    sign = np.where(grid.signs[tuple(low.T)], 1.0, -1.0)

    def K(share: Array, which: Integers) -> Array:
        value = grid.field.evaluate(start[which] + share[:, None] * (end - start)[which])
        at_end = np.where(share == 0.0, sign[which], -sign[which]) * np.abs(value)
        return np.where((share == 0.0) | (share == 1.0), at_end, value)

    none, one = np.zeros(len(low)), np.ones(len(low))
    tolerances = {"xatol": ACCURACY, "xrtol": 0.0, "fatol": 0.0, "frtol": 0.0}
    found = find_root(K, (none, one), args=(np.arange(len(low)),), tolerances=tolerances)
    return start + found.x[:, None] * (end - start)


def _along_borders(contours: _Contours) -> list[Segment]:
    """Return the sides of cells on the border of the domain along which K vanishes."""
    (u, v), borders = contours.grid.lines, contours.grid.borders
    corners = np.array(borders, dtype=np.int64).reshape(-1, 2, 2)
    codes = contours.modulo(2 * corners)
    places = np.stack([u[corners[..., 0]], v[corners[..., 1]]], axis=-1)
    return [
        (("border", _name(start)), ("border", _name(end)), ends)
        for (start, end), ends in zip(codes, places, strict=True)
    ]
