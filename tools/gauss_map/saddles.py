"""Crossings of the curves K = 0: saddles of K at height zero, found by Newton's method."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from .curvature_field import SURE, CurvatureField
from .sign_grid import SignGrid

__all__ = ["SAME", "critical_points", "crossings"]

Array = NDArray[np.float64]
NEWTON_STEPS = 10
# Largest distance, in cells, of a saddle from the cell where the search for it starts.
FARTHEST = 2.0
# Saddles whose distance is less than this, in cells, are the same.
SAME = 1e-2


def crossings(grid: SignGrid, size: Array) -> Array:
    """Return the places (k, 2) of the saddles of K at which curves K = 0 cross.

    Curves whose distance at the saddle is less than `size` (2,) count as crossing.
    """
    field = grid.field
    rectangles = grid.rectangles(_may_hold_saddle(grid))
    cell = rectangles[:, 1] - rectangles[:, 0]
    start = rectangles.mean(axis=1)
    places = critical_points(field, start, cell)
    slope, hessian = field.gradient(places), field.hessian(places)
    found = (np.abs(_newton_step(slope, hessian)) <= SAME * cell).all(axis=1)
    found &= (np.abs(places - start) <= FARTHEST * cell).all(axis=1)
    found &= _is_crossing(
        field.evaluate(places), hessian * (size[:, None] * size), SURE * field.noise_at(places)
    )
    return _different(grid, places[found])


def critical_points(field: CurvatureField, places: Array, longest: Array) -> Array:
    """Move places (k, 2) to where the gradient of K vanishes, by Newton steps of at most `longest`.

    Where the Hessian is singular the steps are the shortest that solve its equations best.
    """
    for _ in range(NEWTON_STEPS):
        step = _newton_step(field.gradient(places), field.hessian(places))
        places = places - np.clip(step, -longest, longest)
    return places


def _newton_step(slope: Array, hessian: Array) -> Array:
    return np.einsum("kxy,ky->kx", np.linalg.pinv(hessian, hermitian=True), slope)


def _may_hold_saddle(grid: SignGrid) -> NDArray[np.bool_]:
    """Return in which cells K may vanish, and both its derivatives, or in the cells around them.

    Corners i − 1 … i + 2 are those of the cell i and of its neighbours.
    """

    def changes(values: Array, shape: tuple[int, int]) -> tuple[Array, Array]:
        return (minimum_filter(values, shape, mode="nearest"),
                maximum_filter(values, shape, mode="nearest"))  # fmt: skip

    low, high = (x[1:, 1:] for x in changes(grid.values, (4, 4)))
    result = grid.mask & (np.maximum(low, -high) <= high - low)
    for axis, shape, inner in ((0, (3, 4), np.s_[:, 1:]), (1, (4, 3), np.s_[1:, :])):
        low, high = (x[inner] for x in changes(np.diff(grid.values, axis=axis), shape))
        result &= (low <= 0.0) & (high >= 0.0)
    return result


def _is_crossing(K: Array, hessian: Array, noise: Array) -> NDArray[np.bool_]:
    """Return at which critical points curves K = 0 are closer than the unit of the Hessian.

    At a saddle they are the branches of the hyperbola 2 K + λ x² + μ y² = 0, λ < 0 < μ.
    """
    low, high = np.linalg.eigvalsh(hessian).T
    towards = np.where(K > 0.0, -low, high)
    return (low < 0.0) & (high > 0.0) & ((2.0 * np.abs(K) <= towards) | (np.abs(K) <= noise))


def _different(grid: SignGrid, places: Array) -> Array:
    """Return the places that lie in the domain, one of each group of those that are the same."""
    same = SAME * np.array([np.diff(line).min() for line in grid.lines])
    low, high = np.array([line[[0, -1]] for line in grid.lines]).T
    wraps = np.array(grid.field.wraps)
    moved = np.where(wraps, low + np.mod(places - low, high - low), np.clip(places, low, high))
    kept = np.empty((0, 2))
    for place in moved[(wraps | (np.abs(moved - places) <= same)).all(axis=1)]:
        if not (np.abs(kept - place) <= same).all(axis=1).any():
            kept = np.concatenate([kept, place[None]])
    return kept
