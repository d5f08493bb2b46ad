"""Zeros of K in cells without a change of sign: points and curves where K touches zero.

Rectangles are subdivided while the bounds of K on them include zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from .curvature_field import NODES, ORDER, SURE, CurvatureField
from .rectangles import clusters, merged, quarters, touching
from .sign_grid import SignGrid

__all__ = ["TouchingZeros", "parted", "touching_zeros"]

Array = NDArray[np.float64]
MOST_BOXES = 16384
DEEPEST = 40
# A rectangle on which K is zero up to its error after at most this many subdivisions of a cell is
# a flat region and not a point.
FLAT_LEVELS = 1
# A group of cells in which K is zero up to its error counts as a point up to this side, in cells.
FEW_CELLS = 4


@dataclass(frozen=True, eq=False)
class TouchingZeros:
    """Rectangles (k, 2, 2): `boxes` contain zeros of K; on `zero` K is zero up to its error."""

    boxes: Array
    zero: Array


def touching_zeros(grid: SignGrid, size: Array, finest: bool) -> TouchingZeros | None:
    """Subdivide the cells without a change of sign that may hold a zero of K, down to `size` (2,).

    Returns None if K has another sign inside a cell away from the curves, so that smaller cells are
    needed. If the cells are the `finest`, the rectangles with another sign are returned: they
    contain a closed curve that the cells do not resolve. Where there are more than `MOST_BOXES`
    rectangles, along a curve or where K is zero up to its error, they are not subdivided further.
    """
    open_ = _may_vanish(grid, grid.mask & ~grid.crossed & ~_near_curves(grid))
    rectangles, signs = grid.rectangles(open_), grid.signs[:-1, :-1][open_]
    zero, rings = [np.empty((0, 2, 2))], [np.empty((0, 2, 2))]
    for level in range(DEEPEST):
        large = ((rectangles[:, 1] - rectangles[:, 0]) > size).any(axis=1)
        if not large.any() or len(rectangles) > MOST_BOXES:
            break
        rectangles, signs = quarters(rectangles), np.tile(signs, 4)
        keep, other, flat = _bounded(grid.field, rectangles, signs)
        if other.any() and not finest:
            return None
        rings.append(rectangles[other])
        keep &= ~other
        if level < FLAT_LEVELS:
            zero.append(rectangles[flat])
            keep &= ~flat
        rectangles, signs = rectangles[keep], signs[keep]
    boxes = np.concatenate([merged(rectangles), *rings])
    return TouchingZeros(boxes, np.concatenate(zero))


def parted(grid: SignGrid, zero: Array) -> tuple[Array, Array]:
    """Split rectangles with K = 0 up to its error into small groups in K ≠ 0, and the others."""
    cell = np.array([np.diff(line).max() for line in grid.lines])
    groups = clusters(zero, 1e-6 * cell)
    groups = groups[((groups[:, 1] - groups[:, 0]) <= (FEW_CELLS + 0.1) * cell).all(axis=1)]
    # The border of the unit square, on which K must not vanish.
    share = np.arange(FEW_CELLS * 4) / (FEW_CELLS * 4)
    none, one = 0.0 * share, 0.0 * share + 1.0
    ring = np.stack([np.r_[share, one, 1 - share, none], np.r_[none, share, one, 1 - share]], 1)
    low, high = groups[:, :1] - FEW_CELLS * cell, groups[:, 1:] + FEW_CELLS * cell
    places = (low + ring * (high - low)).reshape(-1, 2)
    least = np.abs(grid.field.evaluate(places)).reshape(-1, len(ring)).min(axis=1)
    groups = groups[least > SURE * grid.field.noise.max(initial=0.0, where=grid.usable)]
    small = np.array([touching(x, groups, 0.0 * cell).any() for x in zero], dtype=bool)
    return zero[small], zero[~small]


def _near_curves(grid: SignGrid) -> NDArray[np.bool_]:
    """Return which cells touch a cell with a sign change, or one in which K is unknown."""
    near = grid.crossed | ~grid.mask
    for (i, j), _ in grid.borders:
        near[min(i, near.shape[0] - 1), min(j, near.shape[1] - 1)] = True
    for axis, periodic in enumerate(grid.field.wraps):
        near = maximum_filter1d(near, 3, axis, mode="wrap" if periodic else "nearest")
    return near.astype(bool)


def _may_vanish(grid: SignGrid, cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the cells in which the bounds of K include zero."""
    field, result = grid.field, np.zeros_like(cells)
    rest = field.largest - 2.0 * np.abs(field.coefficients[..., 0, 0]) + field.noise
    for i, j in np.argwhere(grid.usable & (rest >= 0.0)) * grid.cells:
        k, n = np.nonzero(cells[i : i + grid.cells, j : j + grid.cells])
        k, n = i + k, j + n
        result[k, n] = _bounded(field, grid.rectangles_at(k, n), grid.signs[k, n])[0]
    return result


def _bounded(
    field: CurvatureField, rectangles: Array, signs: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """Return on which rectangles K may vanish, has the other sign too, is zero up to its error."""
    middle = 0.5 * (rectangles[:, 1] + rectangles[:, 0])
    half = 0.5 * (rectangles[:, 1] - rectangles[:, 0])
    index, basis = [], []
    for axis, line in enumerate(field.lines):
        x = middle[:, None, axis] + half[:, None, axis] * NODES[None, ::2]
        k = np.clip(np.searchsorted(line, middle[:, axis], side="right") - 1, 0, len(line) - 2)
        local = 2.0 * (x - line[k][:, None]) / (line[k + 1] - line[k])[:, None] - 1.0
        index.append(k)
        basis.append(chebyshev.chebvander(local, ORDER - 1))
    inner = field.coefficients[index[0], index[1]]
    values = basis[0] @ inner @ np.swapaxes(basis[1], 1, 2)
    noise = field.noise[index[0], index[1]]
    largest, smallest = values.max(axis=(1, 2)), values.min(axis=(1, 2))
    # Between the nodes K exceeds the range of the nodal values by less than that range.
    spread = largest - smallest
    keep = np.where(signs, smallest - spread <= noise, largest + spread >= -noise)
    other = np.where(signs, smallest < -noise, largest > noise)
    return keep, other, np.maximum(largest, -smallest) <= noise
