"""The curves K = 0: contour lines of the signs of K with exact vertices, joined at crossings.

The signs at the nodes of a grid do not show which branches belong together at a crossing, which is
a saddle of K. A block of cells around each saddle is left out, and the curves that end at the block
are continued straight to the saddle.
"""

import numpy as np

from ...runtime.base.aliases import Array, Indices
from .chains import continued
from .sign_changes import sign_changes
from .sign_grid import SignGrid

# Accuracy of a vertex, relative to the side of a cell on which it lies.
ACCURACY = 1e-14
# A vertex within this distance of a node, relative to the side, counts as the node.
AT_NODE = 1e-9
# Largest distance, in cells of the grid, from a saddle to the boundary of its block. Curves that
# cross at a small angle need a large block.
LARGEST_BLOCK = 16


def zero_curves(grid: SignGrid, saddles: Array) -> list[Array]:
    """Return the curves K = 0 as polylines (k, 2), cut at saddles.

    A closed curve ends where it begins, or a period away.
    """
    values = grid.values.copy()
    blocks = [(x, half) for x in saddles if (half := _hide_block(grid, values, x))]
    lines = sign_changes(values, grid.kinds, lambda *ends: _zeros_between(grid, *ends))
    whole = [(continued(parts), closed) for parts, closed in lines]
    return [line if closed else _to_saddles(grid, line, blocks) for line, closed in whole]


def _hide_block(grid: SignGrid, values: Array, saddle: Array) -> int:
    """Set values to NaN inside the smallest block around a saddle that at least four curves enter.

    Return half of the size of the block in cells, 0 if there is no such block. Two curves suffice
    for a block that the boundary of the domain clips: other curves may enter it outside the domain.
    """
    cell = np.ravel(grid.cells_at(saddle[None]))
    shape, wraps = np.array(values.shape), grid.curvature.wraps
    for half in range(1, LARGEST_BLOCK + 1):
        rows = [np.arange(x - half, x + half + 2) for x in cell]
        whole = (wraps | [x[0] >= 0 and x[-1] < n for x, n in zip(rows, shape, strict=True)]).all()
        i, j = (
            np.where(periodic, x % (n - 1), np.clip(x, 0, n - 1))
            for x, n, periodic in zip(rows, shape, wraps, strict=True)
        )
        block = values[np.ix_(i, j)]
        ring = np.concatenate([block[:-1, 0], block[-1, :-1], block[:0:-1, -1], block[0, :0:-1]])
        if not np.isfinite(ring).all():
            return 0
        if np.count_nonzero(np.diff(ring >= 0.0, append=ring[0] >= 0.0)) >= (4 if whole else 2):
            values[np.ix_(i[1:-1], j[1:-1])] = np.nan
            for axis in np.flatnonzero(wraps):
                side = np.swapaxes(values, 0, axis)
                side[-1] = side[0]
            return half
    return 0


def _to_saddles(grid: SignGrid, line: Array, blocks: list[tuple[Array, int]]) -> Array:
    """Continue a line to the saddles of the blocks at whose boundaries it ends."""
    (low, high), period = grid.curvature.ends, grid.curvature.extent
    start, end = (np.empty((0, 2)) for _ in range(2))
    for saddle, half in blocks:
        to_saddle = saddle - line[[0, -1]]
        to_saddle -= np.where(grid.curvature.wraps, period * np.round(to_saddle / period), 0.0)
        near = (np.abs(to_saddle) <= (half + 1.0) * grid.cell).all(axis=1)
        near &= ((low < line[[0, -1]]) & (line[[0, -1]] < high)).all(axis=1)
        start = line[:1] + to_saddle[:1] if near[0] else start
        end = line[-1:] + to_saddle[1:] if near[1] else end
    return np.concatenate([start, line, end])


def _zeros_between(grid: SignGrid, low: Indices, high: Indices) -> Array:
    """Return the zeros (k, 2) of K between nodes (k, 2) of different sign.

    At a node where K is zero up to its error, the sign is that of a neighbour, as in `SignGrid`.
    """
    from scipy.optimize.elementwise import find_root

    start, end = grid.at(low), grid.at(high)
    sign = np.where(grid.values[tuple(low.T)] >= 0.0, 1.0, -1.0)

    def K(share: Array, which: Indices) -> Array:
        value = grid.curvature.at(start[which] + share[:, None] * (end - start)[which]).K
        at_end = np.where(share == 0.0, sign[which], -sign[which])
        at_end = at_end * np.nan_to_num(np.abs(value), nan=1.0, posinf=1.0)
        return np.where((share == 0.0) | (share == 1.0), at_end, value)

    none, one = np.zeros(len(low)), np.ones(len(low))
    tolerances = {"xatol": ACCURACY, "xrtol": 0.0, "fatol": 0.0, "frtol": 0.0}
    share = find_root(K, (none, one), args=(np.arange(len(low)),), tolerances=tolerances).x[:, None]
    share = np.nan_to_num(share, nan=0.5)  # K is not known all along the side of the cell
    inner = np.where(share < AT_NODE, start, start + share * (end - start))
    return np.where(share > 1.0 - AT_NODE, end, inner)
