"""The signs of K at the nodes of a grid of the parameters."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array, Flags, Indices
from .curvature import Curvature
from .sign_changes import with_borders

# Nodes are shifted by this share of a cell, so that curves on lines of symmetry do not pass through
# them.
OFFSET = 0.2360679774997897
# K counts as known where its error is below this, relative to |K| or to 1 plus the median of |K|.
RESOLVED = 1e-2
TINY = float(np.finfo(float).tiny)


class SignGrid:
    """K at the nodes of a grid, and the changes of its sign.

    `values` are values of K. Where K is zero up to its error, or unknown, the value has the sign of
    a neighbour, or is NaN if no neighbour has a sign. So the sign changes at most once across a
    curve through nodes, whatever the signs of rounding errors. `flat` are the cells at whose
    corners K is zero up to its error or unknown, and zero at one corner or more. `unknown` are the
    other cells with NaN at a corner, `crossed` the cells with both signs, and `near_curves` the
    neighbours of cells with both signs or with NaN at a corner. `areas` are the areas of cells,
    relative to the domain.
    """

    def __init__(self, curvature: Curvature, cells: tuple[int, int]) -> None:
        from scipy.ndimage import maximum_filter, minimum_filter

        self.curvature = curvature
        self.lines = [
            _line(low, high, count, wraps)
            for low, high, count, wraps in zip(
                curvature.low, curvature.high, cells, curvature.wraps, strict=True
            )
        ]
        shape = cells[0] + 1, cells[1] + 1
        self.cell = curvature.extent / cells
        self.areas = np.outer(*map(np.diff, self.lines)) / np.prod(curvature.extent)
        in_u, in_v = ("periodic" if wraps else "open" for wraps in curvature.wraps)
        self.kinds = in_u, in_v
        K, error, _ = curvature.at(self.at(np.argwhere(np.ones(shape))))
        K, error = K.reshape(shape), error.reshape(shape)
        with np.errstate(invalid="ignore"):
            usual = 1.0 + np.median(np.where(np.abs(K) > error, np.abs(K), 0.0))
            known = np.isfinite(K) & (error <= RESOLVED * np.maximum(np.abs(K), usual))
        self.zero = known & (np.abs(K) <= error)
        signs = np.where(known & ~self.zero, np.sign(K), 0.0)
        modes: Any = ["wrap" if wraps else "nearest" for wraps in curvature.wraps]
        largest, least = (f(signs, 3, mode=modes) for f in (maximum_filter, minimum_filter))
        around = np.where(largest > 0.0, largest, np.where(least < 0.0, least, np.nan))
        size = np.where(known, np.maximum(np.abs(K), TINY), 1.0)
        values = np.where(signs == 0.0, around * size, K)
        self.values = with_borders(values, np.where(known, error, 0.0), self.kinds)
        for axis in np.flatnonzero(curvature.wraps):
            side = np.swapaxes(self.values, 0, axis)
            side[-1] = side[0]
        corners = of_corners(self.values)
        decided = np.isfinite(corners).all(axis=0)
        zero = of_corners(self.zero)
        flat = [(zero | of_corners(~known)).all(axis=0), zero.any(axis=0)]
        self.flat: Flags = np.logical_and.reduce(flat)
        self.unknown: Flags = ~decided & ~self.flat
        crossed = [decided, (corners >= 0.0).any(axis=0), (corners < 0.0).any(axis=0)]
        self.crossed: Flags = np.logical_and.reduce(crossed)
        near = maximum_filter(self.crossed | ~decided, 3, mode=modes)
        self.near_curves: Flags = near.astype(bool)

    def cells_at(self, places: Array) -> tuple[Indices, Indices]:
        """Return the indices i, j (k,) of the cells that contain parameter pairs (k, 2)."""
        i, j = (
            np.clip(np.searchsorted(line, x, side="right") - 1, 0, len(line) - 2)
            for line, x in zip(self.lines, places.T, strict=True)
        )
        return i, j

    def at(self, nodes: Indices) -> Array:
        """Return the parameter pairs (..., 2) of nodes (..., 2)."""
        return np.stack([line[nodes[..., k]] for k, line in enumerate(self.lines)], axis=-1)


def of_corners(x: NDArray[Any]) -> NDArray[Any]:
    """Return the values at the four corners (4, …) of cells, counter-clockwise."""
    return np.stack([x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]])


def _line(low: float, high: float, count: int, wraps: bool) -> Array:
    """Return count + 1 nodes; in a periodic direction, they begin inside the domain."""
    shares = (np.arange(count + 1) + OFFSET) / count
    if not wraps:
        shares[0], shares[-1] = 0.0, 1.0
    return (1.0 - shares) * low + shares * high
