"""K at the corners of equal cells in each panel, and its signs there."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from .curvature_field import ORDER, SURE, CurvatureField
from .sign_changes import with_borders

__all__ = ["SignGrid"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class SignGrid:
    """K at the corners of equal cells in each panel, and where it changes its sign.

    `values` are those of K, with a sign of a neighbour where they are zero up to their error, and
    NaN where there is none, or K is unknown. So a curve through corners is crossed once or not at
    all, whatever the signs of the rounding. In the cells of `mask` K is known at all corners; those
    of them that are `crossed` have corners of both signs. K is zero, up to its error, at the
    corners in `zero` and in the whole of `flat` cells.
    """

    def __init__(self, field: CurvatureField, cells: int) -> None:
        from scipy.ndimage import maximum_filter, minimum_filter

        self.field, self.cells = field, cells
        self.lines = [_refined(line, cells) for line in field.lines]
        in_u, in_v = ("periodic" if wraps else "open" for wraps in field.wraps)
        self.kinds = in_u, in_v
        values, noise = self._corners()
        self.zero = np.abs(values) <= noise
        self.flat = _of_corners(self.zero).all(axis=0) & self._of_panels(field.is_small)
        signs = np.where(self.zero | np.isnan(values), 0.0, np.sign(values))
        around = maximum_filter(signs, 3)
        around = np.where(around > 0.0, around, minimum_filter(signs, 3))
        small = np.where(around == 0.0, np.nan, np.copysign(values, around))
        values = with_borders(np.where(self.zero, small, values), noise, self.kinds)
        for axis, wraps in enumerate(field.wraps):
            if wraps:
                side = np.swapaxes(values, 0, axis)
                side[-1] = side[0]
        self.values = values
        corners = _of_corners(values)
        self.mask = np.logical_and.reduce(np.isfinite(corners))
        self.crossed = self.mask & (corners >= 0.0).any(axis=0) & (corners < 0.0).any(axis=0)

    @cached_property
    def near_curves(self) -> Mask:
        """Which cells are crossed, or next to such a cell."""
        from scipy.ndimage import maximum_filter1d

        near = self.crossed
        for axis, wraps in enumerate(self.field.wraps):
            near = maximum_filter1d(near, 3, axis, mode="wrap" if wraps else "nearest")
        return near.astype(bool)

    def cells_at(self, places: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the cells (i, j) that hold places (k, 2) of the domain."""
        i, j = (
            np.clip(np.searchsorted(line, x, side="right") - 1, 0, len(line) - 2)
            for line, x in zip(self.lines, places.T, strict=True)
        )
        return i, j

    def sizes(self, cells: tuple[NDArray[np.int64], NDArray[np.int64]]) -> Array:
        """Return the sizes (k, 2) of cells."""
        return np.stack(
            [np.diff(line)[x] for line, x in zip(self.lines, cells, strict=True)], axis=1
        )

    def rectangles(self, which: Mask) -> Array:
        """Return the rectangles (k, 2, 2), low and high corner, of the cells that are True."""
        cells = np.argwhere(which)
        return np.stack([self.at(cells), self.at(cells + 1)], axis=1)

    def at(self, corners: NDArray[np.int64]) -> Array:
        """Return the places (..., 2) of corners (..., 2) of cells."""
        return np.stack([line[corners[..., k]] for k, line in enumerate(self.lines)], axis=-1)

    def _of_panels(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return for each cell the value of its panel (m, n)."""
        return np.repeat(np.repeat(values, self.cells, axis=0), self.cells, axis=1)

    def _corners(self) -> tuple[Array, Array]:
        """Return K at the corners and its error; NaN where it is unknown."""
        local = chebyshev.chebvander(np.linspace(-1.0, 1.0, self.cells + 1), ORDER - 1)
        of_panels = local @ self.field.coefficients @ local.T
        values = np.full([len(line) for line in self.lines], np.nan)
        noise = np.zeros_like(values)
        for i, j in np.argwhere(~self.field.unresolved):
            place = tuple(np.s_[k * self.cells : (k + 1) * self.cells + 1] for k in (i, j))
            values[place], noise[place] = of_panels[i, j], SURE * self.field.noise[i, j]
        return values, noise


def _of_corners(x: NDArray[Any]) -> NDArray[Any]:
    """Return the values at the four corners (4, …) of cells, counter-clockwise."""
    return np.stack([x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]])


def _refined(line: Array, cells: int) -> Array:
    steps = np.arange(cells) / cells
    inner = line[:-1, None] + np.diff(line)[:, None] * steps
    return np.append(inner.ravel(), line[-1])
