"""Critical points of K at which K is zero: curves K = 0 cross there, or K touches zero."""

from typing import NamedTuple

import numpy as np

from ...runtime.base.aliases import Array, Flags
from .polylines import different
from .sign_grid import SignGrid

# The number of steps of Newton's method, which converges slowly where K vanishes to the fourth
# order; and the length of a final step, relative to the domain.
NEWTON_STEPS, ARRIVED = 40, 1e-10
# K counts as zero at a critical point if its second derivatives there predict a zero within this
# distance, relative to the domain.
TOUCHING = 1e-7
# The largest distance of a critical point from its nearest node, in cells of the grid: for a point
# found by Newton's method, and for an estimate from differences between nodes.
FARTHEST, FARTHEST_BY_NODES = 2.0, 1.5
# Critical points closer to each other than this, in cells of the grid, count as one point.
SAME = 1e-2
# K counts as constant in one principal direction of its Hessian if its growth in that direction is
# less than this fraction of its growth in the other direction. The second number is for differences
# between nodes, which are not close to the zeros.
CONSTANT, CONSTANT_BY_NODES = 1e-5, 1e-2


class CriticalZeros(NamedTuple):
    """Saddles (k, 2), where curves K = 0 cross, and isolated points (m, 2) at which K touches zero.

    A closed curve K = 0 smaller than a cell also counts as an isolated point; it lies within
    `reach` (m, 2) of the point. `unclear` says whether there are such curves, or curves closer to
    each other than a cell, or curves that cross in the last cells before a boundary.
    """

    saddles: Array
    touched: Array
    reach: Array
    unclear: bool


def critical_zeros(grid: SignGrid, size: float) -> CriticalZeros:
    """Return the critical points of K where it is zero.

    Curves within `size` of a critical point, relative to the domain, count as passing through it.
    """
    curvature = grid.curvature
    (low, high), extent = curvature.ends, curvature.extent
    starts = grid.at(np.argwhere(_may_be_critical(grid)))
    places, cell = starts.copy(), grid.cell / extent
    moving = np.arange(len(places))
    for constant in (CONSTANT_BY_NODES, *[CONSTANT] * NEWTON_STEPS):
        _, gradient, hessian = curvature.derivatives(places[moving])
        # Steps are 0 where K is not known: these places are not found below.
        step = np.nan_to_num(np.clip(_newton_step(gradient, hessian, constant), -cell, cell))
        places[moving] = np.clip(places[moving] - extent * step, low, high)
        far = (np.abs(places[moving] - starts[moving]) > FARTHEST * grid.cell).any(axis=1)
        moving = moving[~far & (np.abs(step) > ARRIVED).any(axis=1)]
    K, gradient, hessian = curvature.derivatives(places)
    found = (np.abs(_newton_step(gradient, hessian)) <= SAME * cell).all(axis=1)
    found &= (np.abs(places - starts) <= FARTHEST * grid.cell).all(axis=1)
    places, K, hessian = places[found], K[found], hessian[found]
    places = np.where(curvature.wraps, _wrapped(grid, places), places)
    cells, error = grid.cells_at(places), curvature.at(places).error
    down, up = _eigenvalues(hessian) * [[-1.0], [1.0]]
    zero = ~(np.abs(K) > np.maximum(error, TOUCHING**2 * np.maximum(np.abs(down), np.abs(up))))
    near = zero | _half_distance_is_less(size, K, hessian)
    # A circle whose radius is half the diagonal of a cell always has a node inside.
    close = _half_distance_is_less(np.sqrt(0.5) * cell, K, hessian) & ~grid.unknown[cells]
    saddle = np.minimum(down, up) > CONSTANT * np.maximum(down, up)
    away = ~grid.near_curves[cells] & ~grid.flat[cells]
    ring = ~zero & (K * grid.values[cells] < 0.0)
    touched = ~saddle & (near | ring) & away
    from_border = np.minimum(places - low, high - places)
    beside_border = ((from_border > size * extent) & (from_border < 3.0 * grid.cell)).any(axis=1)
    curving = np.abs(np.diagonal(hessian, axis1=1, axis2=2)) + 1e-300
    reach = np.clip(np.sqrt(2.0 * (np.abs(K) + error)[:, None] / curving), 0.5 * size, cell)
    return CriticalZeros(
        different(places[saddle & near & ~grid.flat[cells]], SAME * grid.cell),
        places[touched],
        (extent * reach)[touched],
        bool(((close & ~near) | (ring & away) | (saddle & near & beside_border)).any()),
    )


def _may_be_critical(grid: SignGrid) -> Flags:
    """Return a mask of the nodes near which there may be a critical point with K near zero.

    The derivatives of K are estimated by differences between nodes.
    """
    from scipy.ndimage import minimum_filter

    K = np.where(grid.zero, 0.0, grid.values)
    lines = [line / cell for line, cell in zip(grid.lines, grid.cell, strict=True)]
    u, v = np.gradient(K, *lines)
    (uu, uv), (_, vv) = np.gradient(u, *lines), np.gradient(v, *lines)
    gradient = np.stack([u, v], axis=-1).reshape(-1, 2)
    hessian = np.stack([uu, uv, uv, vv], axis=-1).reshape(-1, 2, 2)
    known = np.isfinite(np.column_stack([hessian.reshape(-1, 4), gradient])).all(axis=1)
    hessian[~known], gradient[~known] = 0.0, 0.0
    step = _newton_step(gradient, hessian, CONSTANT_BY_NODES)
    least = K.ravel() - 0.5 * np.einsum("kx,kx->k", gradient, step)
    near = (np.abs(step) <= FARTHEST_BY_NODES).all(axis=1)
    near &= _half_distance_is_less(FARTHEST_BY_NODES, least, hessian)
    return (known & near).reshape(K.shape) & (minimum_filter(grid.zero, 3) == 0)


def _wrapped(grid: SignGrid, places: Array) -> Array:
    """Shift parameter pairs by whole periods, to between the first and the last node."""
    first = np.array([line[0] for line in grid.lines])
    return first + np.mod(places - first, grid.curvature.extent)


def _eigenvalues(hessian: Array) -> Array:
    """Return the lower and the higher eigenvalue (2, k) of symmetric matrices (k, 2, 2)."""
    return np.linalg.eigvalsh(hessian).T.astype(np.float64)


def _half_distance_is_less(size: float | Array, K: Array, hessian: Array) -> Flags:
    """Return a mask of the critical points at which two curves K = 0 are less than 2 `size` apart.

    At a saddle, the curves are the branches of the hyperbola 2 K + λ x² + μ y² = 0, where λ < 0 < μ
    are the eigenvalues of the Hessian.
    """
    low, high = _eigenvalues(hessian * np.multiply.outer(size, size))
    return 2.0 * np.abs(K) <= np.where(K > 0.0, -low, high)


def _newton_step(gradient: Array, hessian: Array, constant: float = CONSTANT) -> Array:
    """Return the shortest least-squares Newton steps to a zero of the gradient of K."""
    inverse = np.linalg.pinv(hessian, rcond=constant, hermitian=True)
    return np.einsum("kxy,ky->kx", inverse, gradient)
