"""The parabolic points of a smooth surface: K = 0 by subdivision (paper, Remark 3.1).

A grid finds the curves across which K changes its sign; each vertex of theirs is then improved to
the accuracy of K. Rectangles in which K keeps its sign are subdivided as long as the bounds of K
leave a zero open: what remains at the tolerance are points or curves where K only touches zero.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from ..surface import Surface
from .chains import Segment, joined
from .curvature_field import NODES, ORDER, CurvatureField

__all__ = ["Search", "field_of", "search"]

Array = NDArray[np.float64]
PANELS = (8, 8)
MOST_PANELS = 64
# Cells of the grid along a side of a panel; doubled where a curve is too small for them.
CELLS = 16
MOST_LINES = 512
MOST_BOXES = 4096
DEEPEST = 40
BISECTIONS = 36


@dataclass(frozen=True, eq=False)
class Search:
    """What a search found, all in parameters.

    `polylines` are (k, 2) with whether they are closed; `boxes` (k, 2, 2) are rectangles (low and
    high corner) that hold zeros of K without a change of sign, and `flat` (k, 2, 2) those where K
    is zero up to its error. `unresolved` is the share of the domain where K is not known.
    """

    polylines: list[tuple[Array, bool]]
    boxes: Array
    flat: Array
    unresolved: float


def field_of(surface: Surface, cells: tuple[int, int] | None) -> CurvatureField:
    """Return K on panels: as many as asked, or as many as resolve the most of the domain."""
    panels = PANELS if cells is None else cells
    best = CurvatureField.of_surface(surface, panels)
    while cells is None and best.unresolved.any() and max(panels) < MOST_PANELS:
        panels = (2 * panels[0], 2 * panels[1])
        finer = CurvatureField.of_surface(surface, panels)
        if finer.share(finer.unresolved) < best.share(best.unresolved):
            best = finer
    return best


def search(field: CurvatureField, size: Array) -> Search:
    """Find the zeros of K; `size` (2,) is how small rectangles have to become, in parameters."""
    usable = ~field.flat & ~field.unresolved
    cells = CELLS
    while True:
        grid = _Grid(field, cells, usable)
        finest = 2 * cells * max(field.noise.shape) > MOST_LINES
        boxes = grid.without_sign_change(size, finest)
        if boxes is not None:
            break
        cells *= 2
    return Search(
        joined(grid.segments()),
        _clusters(boxes, size),
        _panels(field, field.flat),
        field.share(field.unresolved),
    )


def _panels(field: CurvatureField, which: NDArray[np.bool_]) -> Array:
    """Return the rectangles (k, 2, 2) of panels."""
    i, j = np.nonzero(which)
    u, v = field.lines
    return np.stack([np.stack([u[i], v[j]], axis=1), np.stack([u[i + 1], v[j + 1]], axis=1)], 1)


class _Grid:
    """K at the corners of equal cells in each panel, and what its signs say."""

    def __init__(self, field: CurvatureField, cells: int, usable: NDArray[np.bool_]) -> None:
        self.field, self.cells, self.usable = field, cells, usable
        self.lines = [_refined(line, cells) for line in field.lines]
        self.signs = self._corner_signs()
        self.mask = np.repeat(np.repeat(usable, cells, axis=0), cells, axis=1)
        signs = self.signs
        corners = np.stack([signs[:-1, :-1], signs[1:, :-1], signs[1:, 1:], signs[:-1, 1:]])
        self.crossed = (corners != corners[0]).any(axis=0) & self.mask

    def _corner_signs(self) -> NDArray[np.bool_]:
        """Say at the corners (m cells + 1, n cells + 1) whether K is positive."""
        local = chebyshev.chebvander(np.linspace(-1.0, 1.0, self.cells + 1), ORDER - 1)
        values = local @ self.field.coefficients @ local.T
        m, n = values.shape[:2]
        result = np.empty((m * self.cells + 1, n * self.cells + 1))
        for i in range(m):
            for j in range(n):
                u, v = i * self.cells, j * self.cells
                result[u : u + self.cells + 1, v : v + self.cells + 1] = values[i, j]
        for axis in (0, 1):
            if self.field.wraps[axis]:
                np.swapaxes(result, 0, axis)[-1] = np.swapaxes(result, 0, axis)[0]
        return result > 0.0

    def segments(self) -> list[Segment]:
        """Return the segments of the curves K = 0 in the cells."""
        places = self._crossings()
        segments: list[Segment] = []
        for i, j in zip(*np.nonzero(self.crossed), strict=True):
            sides = [("u", i, j), ("v", i + 1, j), ("u", i, j + 1), ("v", i, j)]
            met = [(side, places[side]) for side in sides if side in places]
            if len(met) == 4 and self._joins_other_corners(i, j):
                met = met[1:] + met[:1]
            for (left, start), (right, end) in zip(met[::2], met[1::2], strict=True):
                ends = np.array([start, end])
                segments.append((self._node(left), self._node(right), ends))
        return segments

    def _joins_other_corners(self, i: int, j: int) -> bool:
        """Say which way two curves pass through a cell whose four sides are all crossed."""
        middle = [0.5 * (line[k] + line[k + 1]) for line, k in zip(self.lines, (i, j), strict=True)]
        centre = bool(self.field.evaluate(np.array([middle]))[0] > 0.0)
        return centre == bool(self.signs[i, j])

    def _node(self, side: tuple[str, int, int]) -> Hashable:
        """Return the name of a side, the same for both places of it in a periodic direction."""
        along, i, j = side
        m, n = (len(line) - 1 for line in self.lines)
        return (
            along,
            int(i % m if self.field.wraps[0] else i),
            int(j % n if self.field.wraps[1] else j),
        )

    def _crossings(self) -> dict[tuple[str, int, int], Array]:
        """Return the zero of K on each side of a cell at whose ends it has two signs."""
        sides, low, high = [], [], []
        for along, axis in (("u", 0), ("v", 1)):
            width = [(0, 0) if k == axis else (1, 1) for k in (0, 1)]
            beside = np.pad(self.crossed, width)
            beside = beside[:, 1:] | beside[:, :-1] if along == "u" else beside[1:] | beside[:-1]
            change = np.diff(self.signs, axis=axis) & beside
            for i, j in zip(*np.nonzero(change), strict=True):
                sides.append((along, int(i), int(j)))
                low.append((self.lines[0][i], self.lines[1][j]))
                step = (1, 0) if along == "u" else (0, 1)
                high.append((self.lines[0][i + step[0]], self.lines[1][j + step[1]]))
        if not sides:
            return {}
        places = _bisected(self.field, np.array(low), np.array(high))
        return dict(zip(sides, places, strict=True))

    def without_sign_change(self, size: Array, finest: bool) -> Array | None:
        """Subdivide the cells without sign change that may hold a zero of K.

        Returns the rectangles (k, 2, 2) that are left at the end; None if K has another sign inside
        a cell away from the curves, so that cells should be smaller. If these are the `finest`,
        such small curves are left out.
        """
        near = self._near_curves()
        open_ = self.mask & ~self.crossed & ~near & self._may_vanish()
        i, j = np.nonzero(open_)
        u, v = self.lines
        low, high = np.stack([u[i], v[j]], axis=1), np.stack([u[i + 1], v[j + 1]], axis=1)
        signs = self.signs[i, j]
        for _ in range(DEEPEST):
            large = ((high - low) > size).any(axis=1)
            if not large.any() or len(low) > MOST_BOXES:
                break
            low, high, signs = _quartered(low, high, signs)
            keep, other = _bounded(self.field, low, high, signs)
            if other.any() and not finest:
                return None
            keep &= ~other
            low, high, signs = low[keep], high[keep], signs[keep]
        return np.stack([low, high], axis=1)

    def _near_curves(self) -> NDArray[np.bool_]:
        """Say which cells touch one with a sign change."""
        near = self.crossed
        for axis in (0, 1):
            ends = "wrap" if self.field.wraps[axis] else "constant"
            width = [(1, 1) if k == axis else (0, 0) for k in (0, 1)]
            padded = np.pad(near, width, mode=ends)
            stretch = [np.take(padded, np.arange(k, k + near.shape[axis]), axis) for k in range(3)]
            near = np.logical_or.reduce(stretch)
        return near

    def _may_vanish(self) -> NDArray[np.bool_]:
        """Say in which cells the bounds of K leave a zero open."""
        result = np.zeros(self.crossed.shape, dtype=bool)
        c = self.field.coefficients
        rest = self.field.largest - 2.0 * np.abs(c[..., 0, 0]) + self.field.noise
        for i, j in zip(*np.nonzero(self.usable & (rest >= 0.0)), strict=True):
            cells = np.arange(self.cells)
            u, v = i * self.cells + cells, j * self.cells + cells
            a, b = (x.ravel() for x in np.meshgrid(u, v, indexing="ij"))
            low = np.stack([self.lines[0][a], self.lines[1][b]], axis=1)
            high = np.stack([self.lines[0][a + 1], self.lines[1][b + 1]], axis=1)
            result[a, b] = _bounded(self.field, low, high, self.signs[a, b])[0]
        return result


def _refined(line: Array, cells: int) -> Array:
    steps = np.arange(cells) / cells
    inner = line[:-1, None] + np.diff(line)[:, None] * steps
    return np.append(inner.ravel(), line[-1])


def _bisected(field: CurvatureField, low: Array, high: Array) -> Array:
    """Return the zeros (k, 2) of K between places where it has two signs."""
    positive = field.evaluate(low) > 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        same = (field.evaluate(middle) > 0.0) == positive
        low, high = np.where(same[:, None], middle, low), np.where(same[:, None], high, middle)
    return 0.5 * (low + high)


def _quartered(
    low: Array, high: Array, signs: NDArray[np.bool_]
) -> tuple[Array, Array, NDArray[np.bool_]]:
    middle = 0.5 * (low + high)
    parts = [
        (np.where(take, middle, low), np.where(take, high, middle))
        for take in np.array([[0, 0], [1, 0], [0, 1], [1, 1]], dtype=bool)
    ]
    return (
        np.concatenate([x for x, _ in parts]),
        np.concatenate([y for _, y in parts]),
        np.tile(signs, 4),
    )


def _bounded(
    field: CurvatureField, low: Array, high: Array, signs: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Say which rectangles may hold a zero of K, and in which K has another sign too."""
    places = [
        0.5 * (low + high)[:, None, axis] + 0.5 * (high - low)[:, None, axis] * NODES[None, ::2]
        for axis in (0, 1)
    ]
    index = [
        np.clip(np.searchsorted(line, x[:, 4], side="right") - 1, 0, len(line) - 2)
        for line, x in zip(field.lines, places, strict=True)
    ]
    basis = []
    for line, k, x in zip(field.lines, index, places, strict=True):
        local = 2.0 * (x - line[k][:, None]) / (line[k + 1] - line[k])[:, None] - 1.0
        basis.append(chebyshev.chebvander(local, ORDER - 1))
    inner = field.coefficients[index[0], index[1]]
    values = basis[0] @ inner @ np.swapaxes(basis[1], 1, 2)
    noise = field.noise[index[0], index[1]]
    largest, smallest = values.max(axis=(1, 2)), values.min(axis=(1, 2))
    # Between the nodes K departs from their values by less than they differ among themselves.
    spread = largest - smallest
    keep = np.where(signs, smallest - spread <= noise, largest + spread >= -noise)
    other = np.where(signs, smallest < -noise, largest > noise)
    return keep, other


def _clusters(boxes: Array, size: Array) -> Array:
    """Join rectangles that touch; returns those (k, 2, 2) that hold the groups."""
    groups = np.empty((0, 2, 2))
    for box in boxes:
        low, high = box[0] - size, box[1] + size
        touching = ((groups[:, 0] <= high) & (groups[:, 1] >= low)).all(axis=1)
        corners = np.concatenate([box[None], groups[touching]])
        joint = np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
        groups = np.concatenate([groups[~touching], joint[None]])
    return groups
