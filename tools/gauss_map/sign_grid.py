"""K at the corners of equal cells in each panel, and its signs there."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from .curvature_field import ORDER, SURE, CurvatureField

__all__ = ["SignGrid"]

Array = NDArray[np.float64]


class SignGrid:
    """K at the corners of equal cells in each panel, and where it changes its sign.

    `values` are those of K, `signs` say where it is positive, `zero` where it is zero up to its
    error. In the cells of `mask` K is known and not zero up to its error; those of them that are
    `crossed` have corners of both signs, and on `flat` ones K is zero up to its error.
    """

    def __init__(self, field: CurvatureField, cells: int) -> None:
        self.field, self.cells = field, cells
        self.usable = ~field.flat & ~field.unresolved
        self.lines = [_refined(line, cells) for line in field.lines]
        self.values, noise = self._corners()
        self.zero = np.abs(self.values) <= SURE * noise
        self.signs = _signs(self.values, self.zero, field.wraps)
        mask = self.panels(self.usable)
        own = self.panels(field.noise)
        self.flat = (np.abs(_of_corners(self.values)) <= SURE * own).all(axis=0) & mask
        self.mask = mask & ~self.flat
        corners = _of_corners(self.signs)
        self.crossed = (corners != corners[0]).any(axis=0) & self.mask

    def _corners(self) -> tuple[Array, Array]:
        """Return K at the corners (m cells + 1, n cells + 1) and its error, the lesser of panels.

        The error is infinite where there is no usable panel.
        """
        local = chebyshev.chebvander(np.linspace(-1.0, 1.0, self.cells + 1), ORDER - 1)
        values = local @ self.field.coefficients @ local.T
        m, n = values.shape[:2]
        result = np.zeros((m * self.cells + 1, n * self.cells + 1))
        noise = np.full(result.shape, np.inf)
        order = np.argsort(-self.field.noise, axis=None, kind="stable")
        for i, j in zip(*np.unravel_index(order, (m, n)), strict=True):
            if self.usable[i, j]:
                u, v = i * self.cells, j * self.cells
                place = np.s_[u : u + self.cells + 1, v : v + self.cells + 1]
                result[place], noise[place] = values[i, j], self.field.noise[i, j]
        for axis in (0, 1):
            if self.field.wraps[axis]:
                x, error = np.swapaxes(result, 0, axis), np.swapaxes(noise, 0, axis)
                x[0] = x[-1] = np.where(error[0] <= error[-1], x[0], x[-1])
                error[0] = error[-1] = np.minimum(error[0], error[-1])
        return result, noise

    def panels(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return for each cell the value of its panel (m, n)."""
        return np.repeat(np.repeat(values, self.cells, axis=0), self.cells, axis=1)

    def rectangles(self, which: NDArray[np.bool_]) -> Array:
        """Return the rectangles (k, 2, 2) of the cells that are True."""
        return self.rectangles_at(*np.nonzero(which))

    def rectangles_at(self, i: NDArray[np.int64], j: NDArray[np.int64]) -> Array:
        """Return the rectangles (k, 2, 2) of cells."""
        u, v = self.lines
        corners = np.stack([u[i], v[j]], axis=1), np.stack([u[i + 1], v[j + 1]], axis=1)
        return np.stack(corners, axis=1)

    def cells_at(self, places: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the cells (i, j) that hold places (k, 2) of the domain."""
        i, j = (
            np.clip(np.searchsorted(line, x, side="right") - 1, 0, len(line) - 2)
            for line, x in zip(self.lines, places.T, strict=True)
        )
        return i, j

    @cached_property
    def borders(self) -> list[tuple[tuple[int, int], tuple[int, int]]]:
        """The sides of cells on the border of the domain along which K vanishes, as corners.

        K has to grow linearly from there: otherwise it only touches zero.
        """
        found = []
        for axis in (0, 1):
            if self.field.wraps[axis]:
                continue
            zero, mask = np.swapaxes(self.zero, 0, axis), np.swapaxes(self.mask, 0, axis)
            for end, inner, line in ((0, 1, 0), (-1, -2, len(self.lines[axis]) - 1)):
                half, whole = (self._inside(axis, end, inner, share) for share in (0.5, 1.0))
                good = zero[end] & ~zero[inner] & (np.abs(half) >= 0.375 * np.abs(whole))
                sides = np.flatnonzero(good[1:] & good[:-1] & mask[end]).tolist()
                pairs = [((line, k), (line, k + 1)) for k in sides]
                found += [(a[::-1], b[::-1]) if axis else (a, b) for a, b in pairs]
        return found

    def _inside(self, axis: int, end: int, inner: int, share: float) -> Array:
        """Return K at a share of the way from the corners on a border to those next to it."""
        along, line = self.lines[1 - axis], self.lines[axis]
        across = np.full(len(along), line[end] + share * (line[inner] - line[end]))
        places = (along, across) if axis else (across, along)
        return self.field.evaluate(np.stack(places, axis=1))


def _of_corners(x: NDArray[Any]) -> NDArray[Any]:
    """Return the values at the four corners (4, …) of cells, counter-clockwise."""
    return np.stack([x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]])


def _signs(values: Array, zero: NDArray[np.bool_], wraps: tuple[bool, bool]) -> NDArray[np.bool_]:
    """Return where K is positive; where it is `zero` up to its error, it has a neighbour's sign.

    So a curve through corners, or along a border, is crossed once or not at all, whatever the
    signs of the rounding. Two steps reach all corners of a cell from one that has a sign.
    """
    signs = np.where(zero, 0, np.sign(values)).astype(np.int8)
    for _ in range(2):
        padded = np.pad(signs, 1)
        for neighbour in (padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]):
            signs = np.where(signs == 0, neighbour, signs)
    for axis in (0, 1):
        if wraps[axis]:
            np.swapaxes(signs, 0, axis)[-1] = np.swapaxes(signs, 0, axis)[0]
    return signs > 0


def _refined(line: Array, cells: int) -> Array:
    steps = np.arange(cells) / cells
    inner = line[:-1, None] + np.diff(line)[:, None] * steps
    return np.append(inner.ravel(), line[-1])
