"""Critical points of K where it is zero: curves K = 0 cross there, or K touches zero."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .curvature_field import SURE, CurvatureField
from .sign_grid import SignGrid

__all__ = ["critical_zeros"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
NEWTON_STEPS = 20
# Largest distance, in cells, of a critical point from the corners of the cell that may hold it.
FARTHEST = 2.0
# Saddles whose distance is less than this, in cells, are the same.
SAME = 1e-2
# Where K grows slower in one direction by this factor, it is constant there.
CONSTANT = 1e-5
# Places along a side of a cell at which a sign is sought that its corners do not have.
SAMPLES = 8


def critical_zeros(grid: SignGrid, size: Array) -> tuple[Array, Array, bool]:
    """Return the places (k, 2) where curves K = 0 cross, and those away from curves that K touches.

    Curves whose distance from a critical point is less than `size` (2,) pass through it. A closed
    curve K = 0 that is smaller than a cell is a point that K touches, too. The last value says
    whether there are such curves, or others that are closer to each other than a cell.
    """
    field = grid.field
    may_vanish, may_be_critical = field.bounded(grid.cells)
    away_from_curves = grid.mask & ~grid.near_curves
    i, j = np.nonzero(may_be_critical & grid.mask)
    corners = np.stack([i, j], axis=1) + np.argwhere(np.ones((2, 2)))[:, None]
    starts = grid.at(np.unique(corners.reshape(-1, 2), axis=0))
    cell = grid.sizes(grid.cells_at(starts))
    low, high = np.array([line[[0, -1]] for line in grid.lines]).T
    ends = np.where(field.wraps, -np.inf, low), np.where(field.wraps, np.inf, high)
    places = starts
    for _ in range(NEWTON_STEPS):
        step = np.clip(_newton_step(field, places), -cell, cell)
        places = np.clip(places - step, *ends)
    found = (np.abs(_newton_step(field, places)) <= SAME * cell).all(axis=1)
    found &= (np.abs(places - starts) <= FARTHEST * cell).all(axis=1)
    places = np.where(field.wraps, low + np.mod(places - low, high - low), places)[found]
    cell = cell[found]
    cells = grid.cells_at(places)
    K, noise = field.evaluate(places), SURE * field.noise_at(places)
    hessian = field.hessian(places)
    near = _half_distance_is_less(size[None], K, hessian) | (np.abs(K) <= noise)
    # A circle whose radius is half the diagonal of a cell always has a corner inside.
    close = _half_distance_is_less(math.sqrt(0.5) * cell, K, hessian) & grid.mask[cells]
    down, up = np.linalg.eigvalsh(hessian * (size[:, None] * size)).T * [[-1], [1]]
    saddle = np.minimum(down, up) > CONSTANT * np.maximum(down, up)
    ring = (np.abs(K) > noise) & (K * grid.values[cells] < 0.0)
    touched = ~saddle & (near | ring) & away_from_curves[cells]
    unclear = (close | (ring & away_from_curves[cells])) & ~near
    from scipy.ndimage import maximum_filter

    explained = np.zeros_like(grid.mask)
    explained[grid.cells_at(places[touched])] = True
    hidden = may_vanish & away_from_curves & ~maximum_filter(explained, 3).astype(bool)
    others = _of_other_sign(grid, hidden)
    same = SAME * cell.min(axis=0, initial=np.inf)
    return (
        _different(places[saddle & near], same),
        np.concatenate([places[touched], others]),
        bool(unclear.any() or len(others)),
    )


def _half_distance_is_less(size: Array, K: Array, hessian: Array) -> Mask:
    """Return around which critical points half the distance of curves K = 0 is less than `size`.

    At a saddle they are the branches of the hyperbola 2 K − λ x² + μ y² = 0.
    """
    low, high = np.linalg.eigvalsh(hessian * (size[:, :, None] * size[:, None])).T
    return 2.0 * np.abs(K) <= np.where(K > 0.0, -low, high)


def _newton_step(field: CurvatureField, places: Array) -> Array:
    """Return the shortest steps that best solve Newton's equations for the gradient of K."""
    inverse = np.linalg.pinv(field.hessian(places), rcond=CONSTANT, hermitian=True)
    return np.einsum("kxy,ky->kx", inverse, field.gradient(places))


def _of_other_sign(grid: SignGrid, cells: Mask) -> Array:
    """Return a place (k, 2) in each cell that has another sign than its corners somewhere."""
    low, high = np.moveaxis(grid.rectangles(cells), 1, 0)
    share = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, SAMPLES)] * 2), axis=-1).reshape(-1, 2)
    places = low[:, None] + share * (high - low)[:, None]
    flat = places.reshape(-1, 2)
    sign = np.sign(grid.values[:-1, :-1][cells])
    excess = grid.field.evaluate(flat).reshape(places.shape[:2]) * sign[:, None]
    excess += SURE * grid.field.noise_at(flat).reshape(places.shape[:2])
    lowest = excess.argmin(axis=1)
    rows = np.arange(len(places))
    return places[rows, lowest][excess[rows, lowest] < 0.0]


def _different(places: Array, same: Array) -> Array:
    """Return places without those that are the same as one before them."""
    kept = np.empty((0, 2))
    for place in places:
        if not (np.abs(kept - place) <= same).all(axis=1).any():
            kept = np.concatenate([kept, place[None]])
    return kept
