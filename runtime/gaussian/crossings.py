"""The curves K = 0 in the cells of a grid, cut where they cross.

Signs at the corners of cells cannot show which way two curves go on where they cross. There K has
a saddle at zero: it is found by Newton steps, and the curves round it are led into it.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from .chains import Segment
from .curvature_field import SURE, CurvatureField
from .sign_grid import Side, SignGrid

__all__ = ["segments"]

Array = NDArray[np.float64]
NEWTON_STEPS = 10
# A saddle is looked for this many cells away at most, and the block of cells that is cut out round
# it reaches so far at most. Curves that cross at a small angle need a large one.
FARTHEST = 2.0
LARGEST_BLOCK = 16
# Saddles nearer than this share of a cell are the same.
SAME = 1e-2


def segments(grid: SignGrid, size: Array) -> tuple[list[Segment], NDArray[np.bool_]]:
    """Return the segments of the curves K = 0, and which cells are near a crossing.

    Curves that are nearer to each other than `size` (2,) at a saddle of K cross there.
    """
    blocks = _Blocks(grid)
    for saddle in _saddles(grid, size):
        blocks.cut(saddle)
    found = _in_cells(grid, grid.crossed & ~blocks.taken) + _on_borders(grid) + blocks.segments
    return found, blocks.taken


def _in_cells(grid: SignGrid, cells: NDArray[np.bool_]) -> list[Segment]:
    found: list[Segment] = []
    for i, j in zip(*(x.tolist() for x in np.nonzero(cells)), strict=True):
        sides: list[Side] = [("u", i, j), ("v", i + 1, j), ("u", i, j + 1), ("v", i, j)]
        met = [side for side in sides if side in grid.places]
        if len(met) == 4 and _joins_other_corners(grid, i, j):
            met = met[1:] + met[:1]
        for start, end in zip(met[::2], met[1::2], strict=True):
            ends = np.array([grid.places[start], grid.places[end]])
            found.append((grid.node(start), grid.node(end), ends))
    return found


def _joins_other_corners(grid: SignGrid, i: int, j: int) -> bool:
    """Say which way two curves pass through a cell whose four sides are all crossed."""
    middle = [0.5 * (line[k] + line[k + 1]) for line, k in zip(grid.lines, (i, j), strict=True)]
    centre = bool(grid.field.evaluate(np.array([middle]))[0] > 0.0)
    return centre == bool(grid.signs[i, j])


def _on_borders(grid: SignGrid) -> list[Segment]:
    u, v = grid.lines
    return [
        (
            grid.node(("corner", *start)),
            grid.node(("corner", *end)),
            np.array([[u[i], v[j]] for i, j in (start, end)]),
        )
        for start, end in grid.borders
    ]


# --- saddles --------------------------------------------------------------------------------------


def _saddles(grid: SignGrid, size: Array) -> Array:
    """Return the places (k, 2) of the saddles of K at which curves cross."""
    field = grid.field
    rectangles = grid.rectangles(_may_hold_saddle(grid))
    cell = rectangles[:, 1] - rectangles[:, 0]
    places = start = rectangles.mean(axis=1)
    for _ in range(NEWTON_STEPS):
        places = places - np.clip(_newton_step(*_derivatives(field, places)), -cell, cell)
    slope, hessian = _derivatives(field, places)
    found = (np.abs(_newton_step(slope, hessian)) <= SAME * cell).all(axis=1)
    found &= (np.abs(places - start) <= FARTHEST * cell).all(axis=1)
    found &= _is_crossing(
        field.evaluate(places), hessian * (size[:, None] * size), SURE * field.noise_at(places)
    )
    return _different(grid, places[found])


def _may_hold_saddle(grid: SignGrid) -> NDArray[np.bool_]:
    """Say in which cells, or next to them, K may vanish and both its derivatives change signs."""
    K = _windows(grid.values, (4, 4))
    low, high = K.min(axis=(2, 3)), K.max(axis=(2, 3))
    result = grid.mask & (np.maximum(low, -high) <= high - low)
    for axis, shape in ((0, (3, 4)), (1, (4, 3))):
        slope = _windows(np.diff(grid.values, axis=axis), shape)
        result &= (slope.min(axis=(2, 3)) <= 0.0) & (slope.max(axis=(2, 3)) >= 0.0)
    return result


def _windows(values: Array, shape: tuple[int, int]) -> Array:
    """Return what is at each cell and at those round it, as a view (m, n, …)."""
    return sliding_window_view(np.pad(values, 1, mode="edge"), shape)


def _derivatives(field: CurvatureField, places: Array) -> tuple[Array, Array]:
    """Return the first (k, 2) and the second (k, 2, 2) derivatives of K."""
    uu, uv, vv = (field.evaluate(places, *by) for by in ((2, 0), (1, 1), (0, 2)))
    hessian = np.stack([np.stack([uu, uv], axis=1), np.stack([uv, vv], axis=1)], axis=1)
    return field.gradient(places), hessian


def _newton_step(slope: Array, hessian: Array) -> Array:
    """Return the step (k, 2) to a critical point, infinite where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        (uu, uv), (_, vv) = hessian.transpose(1, 2, 0)
        u, v = slope.T
        step = np.stack([vv * u - uv * v, uu * v - uv * u]) / (uu * vv - uv * uv)
    return np.where(np.isfinite(step), step, np.inf).T


def _is_crossing(K: Array, hessian: Array, noise: Array) -> NDArray[np.bool_]:
    """Say at which critical points of K curves are nearer than the unit of its second derivatives.

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


# --- blocks of cells round saddles ----------------------------------------------------------------


class _Blocks:
    """Blocks of cells that were cut out: the curves in them go straight into a saddle of K."""

    def __init__(self, grid: SignGrid) -> None:
        self.grid = grid
        self.taken = np.zeros_like(grid.crossed)
        self.segments: list[Segment] = []
        self.count = 0

    def cut(self, saddle: Array) -> None:
        """Cut the smallest block out that four curves or more enter, if there is one.

        At the border of the domain two are enough: the others would come from outside.
        """
        centre = [int(k[0]) for k in self.grid.cells_at(saddle[None])]
        for reach in range(1, LARGEST_BLOCK + 1):
            cells = [self._cells(axis, k, reach) for axis, k in enumerate(centre)]
            inner = self._wrapped(cells)
            if not self.grid.mask[inner].all() or self.taken[inner].any():
                return
            met = [entry for side in self._border(cells) for entry in self._place(side)]
            whole = all(len(x) == 2 * reach + 1 for x in cells)
            if len(met) >= (4 if whole else 2):
                self.taken[inner] = True
                node = ("crossing", self.count)
                self.count += 1
                self.segments += [(name, node, np.array([x, saddle])) for name, x in met]
                return

    def _cells(self, axis: int, centre: int, reach: int) -> list[int]:
        """Return the numbers of cells along an axis, beyond the ends in a periodic direction."""
        cells = range(centre - reach, centre + reach + 1)
        if self.grid.field.wraps[axis]:
            return list(cells)
        return [k for k in cells if 0 <= k < self.taken.shape[axis]]

    def _wrapped(self, cells: list[list[int]]) -> tuple[NDArray[np.int64], ...]:
        m, n = self.taken.shape
        return np.ix_(np.mod(cells[0], m), np.mod(cells[1], n))

    def _border(self, cells: list[list[int]]) -> list[Side]:
        """Return the sides of cells round a block, but not those on the border of the domain."""
        (west, *_, east), (south, *_, north) = cells
        u = [("u", i, j) for j in (south, north + 1) if self._within(1, j) for i in cells[0]]
        v = [("v", i, j) for i in (west, east + 1) if self._within(0, i) for j in cells[1]]
        return [*u, *v]

    def _within(self, axis: int, line: int) -> bool:
        return self.grid.field.wraps[axis] or 0 < line < self.taken.shape[axis]

    def _place(self, side: Side) -> list[tuple[object, Array]]:
        """Return the node of a side and the zero of K on it, if there is one."""
        along, i, j = side
        (p, i), (q, j) = (
            divmod(k, n) if wraps else (0, k)
            for k, n, wraps in zip((i, j), self.taken.shape, self.grid.field.wraps, strict=True)
        )
        place = self.grid.places.get((along, i, j))
        if place is None:
            return []
        period = [line[-1] - line[0] for line in self.grid.lines]
        return [(self.grid.node((along, i, j)), place + np.multiply((p, q), period))]
