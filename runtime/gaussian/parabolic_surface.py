"""The parabolic points of a smooth surface: K = 0 by subdivision (paper, Remark 3.1).

A grid finds the curves across which K changes its sign; each vertex of theirs is then improved to
the accuracy of K. Rectangles in which K keeps its sign are subdivided as long as the bounds of K
leave a zero open: what remains at the tolerance are points or curves where K only touches zero.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from ..surface import Surface
from .chains import Segment, joined
from .curvature_field import NODES, ORDER, SURE, CurvatureField

__all__ = ["Search", "field_of", "search"]

Array = NDArray[np.float64]
PANELS = (8, 8)
MOST_PANELS = 64
# Cells of the grid along a side of a panel; doubled where a curve is too small for them.
CELLS = 16
MOST_LINES = 512
MOST_BOXES = 16384
DEEPEST = 40
# Where K is zero up to its error on a rectangle after so few cuts of a cell, it is no single point.
FLAT_LEVELS = 1
# Cells along a side of a group in which K is zero up to its error that counts as a point.
FEW_CELLS = 4
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
    while cells is None and (best.unresolved | best.rough).any() and max(panels) < MOST_PANELS:
        panels = (2 * panels[0], 2 * panels[1])
        finer = CurvatureField.of_surface(surface, panels)
        if _known(finer) < _known(best):
            best = finer
    return best


def _known(field: CurvatureField) -> tuple[float, float]:
    """Return on how much of the domain K is not known, and not well: less is better."""
    return field.share(field.unresolved), field.share(field.rough)


def search(field: CurvatureField, size: Array) -> Search:
    """Find the zeros of K; `size` (2,) is how small rectangles have to become, in parameters."""
    usable = ~field.flat & ~field.unresolved
    cells = CELLS
    while True:
        grid = _Grid(field, cells, usable)
        finest = 2 * cells * max(field.noise.shape) > MOST_LINES
        found = grid.without_sign_change(size, finest)
        if found is not None:
            break
        cells *= 2
    boxes, zero, dropped = found
    small, large = grid.points_and_areas(np.concatenate([grid.flat_rectangles(), zero]))
    flat = np.concatenate([_panels(field, field.flat), large])
    boxes = np.concatenate([boxes, small])
    groups = _clusters(boxes, size)
    beside = np.array([_touching(group, flat, size).any() for group in groups], dtype=bool)
    rim = [boxes[_touching(group, boxes, 0.0 * size)] for group in groups[beside]]
    return Search(
        joined(grid.segments()),
        groups[~beside],
        np.concatenate([flat, *rim]),
        field.share(field.unresolved) + dropped,
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
        self.values, noise = self._corners()
        self.zero = np.abs(self.values) <= SURE * noise
        self.signs = _signs(self.values, self.zero, field.wraps)
        mask = np.repeat(np.repeat(usable, cells, axis=0), cells, axis=1)
        own = np.repeat(np.repeat(field.noise, cells, axis=0), cells, axis=1)
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

    def flat_rectangles(self) -> Array:
        """Return rectangles (k, 2, 2), one for each run of cells in which K is zero up to error."""
        change = np.diff(np.pad(self.flat, [(0, 0), (1, 1)]).astype(np.int8), axis=1)
        (i, start), (_, end) = np.nonzero(change == 1), np.nonzero(change == -1)
        u, v = self.lines
        low, high = np.stack([u[i], v[start]], axis=1), np.stack([u[i + 1], v[end]], axis=1)
        return np.stack([low, high], axis=1)

    def points_and_areas(self, flat: Array) -> tuple[Array, Array]:
        """Part rectangles in which K is zero up to error: small groups in K ≠ 0, and the others."""
        cell = np.array([np.diff(line).max() for line in self.lines])
        groups = _clusters(flat, 1e-6 * cell)
        groups = groups[((groups[:, 1] - groups[:, 0]) <= (FEW_CELLS + 0.1) * cell).all(axis=1)]
        # The borders of a square, 0 … 1: there K has to be known not to vanish.
        share = np.arange(FEW_CELLS * 4) / (FEW_CELLS * 4)
        zero, one = 0.0 * share, 0.0 * share + 1.0
        ring = np.stack([np.r_[share, one, 1 - share, zero], np.r_[zero, share, one, 1 - share]], 1)
        low, high = groups[:, :1] - FEW_CELLS * cell, groups[:, 1:] + FEW_CELLS * cell
        places = (low + ring * (high - low)).reshape(-1, 2)
        least = np.abs(self.field.evaluate(places)).reshape(-1, len(ring)).min(axis=1)
        groups = groups[least > SURE * self.field.noise.max(initial=0.0, where=self.usable)]
        small = np.array([_touching(x, groups, 0.0 * cell).any() for x in flat], dtype=bool)
        return flat[small], flat[~small]

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
        for border in self._borders():
            for start, end in border:
                ends = np.array([[self.lines[0][i], self.lines[1][j]] for i, j in (start, end)])
                left, right = (self._node(("corner", *place)) for place in (start, end))
                segments.append((left, right, ends))
        return segments

    def _borders(self) -> list[list[tuple[tuple[int, int], tuple[int, int]]]]:
        """Return the sides of cells on the border of the domain along which K vanishes, as corners.

        K has to grow linearly from there: otherwise it only touches zero.
        """
        found = []
        for axis in (0, 1):
            if self.field.wraps[axis]:
                continue
            for end, inner, cell in ((0, 1, 0), (-1, -2, -1)):
                zero, near = (np.swapaxes(x, 0, axis) for x in (self.zero, self.values))
                half = self._between(axis, end, inner)
                linear = np.abs(half) >= 0.375 * np.abs(near[inner])
                good = zero[end] & ~np.swapaxes(self.zero, 0, axis)[inner] & linear
                sides = good[1:] & good[:-1] & np.swapaxes(self.mask, 0, axis)[cell]
                line = (len(self.lines[axis]) - 1) if end else 0
                pairs = [((line, int(k)), (line, int(k) + 1)) for k in np.flatnonzero(sides)]
                found.append([(a[::-1], b[::-1]) if axis else (a, b) for a, b in pairs])
        return found

    def _between(self, axis: int, end: int, inner: int) -> Array:
        """Return K half way between the corners on a border and those next to it."""
        along = self.lines[1 - axis]
        across = np.full(len(along), 0.5 * (self.lines[axis][end] + self.lines[axis][inner]))
        places = (along, across) if axis else (across, along)
        return self.field.evaluate(np.stack(places, axis=1))

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
        sides, low, high, positive = [], [], [], []
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
                positive.append(self.signs[i, j])
        if not sides:
            return {}
        places = _bisected(self.field, np.array(low), np.array(high), np.array(positive))
        return dict(zip(sides, places, strict=True))

    def without_sign_change(self, size: Array, finest: bool) -> tuple[Array, Array, float] | None:
        """Subdivide the cells without sign change that may hold a zero of K.

        Returns the rectangles (k, 2, 2) that are left at the end, large ones in which K is zero up
        to its error, and the share of the domain that was too much to look at. None if K has
        another sign inside a cell away from the curves, so that cells should be smaller. If these
        are the `finest`, the rectangles with another sign are returned as they are: they hold a
        closed curve that is too small for the cells.
        """
        near = self._near_curves()
        open_ = self.mask & ~self.crossed & ~near & self._may_vanish()
        i, j = np.nonzero(open_)
        u, v = self.lines
        low, high = np.stack([u[i], v[j]], axis=1), np.stack([u[i + 1], v[j + 1]], axis=1)
        signs = self.signs[i, j]
        flat, rings = [], []
        for level in range(DEEPEST):
            large = ((high - low) > size).any(axis=1)
            if not large.any() or len(low) > MOST_BOXES:
                break
            low, high, signs = _quartered(low, high, signs)
            keep, other, zero = _bounded(self.field, low, high, signs)
            if other.any() and not finest:
                return None
            rings.append(np.stack([low[other], high[other]], axis=1))
            keep &= ~other
            if level < FLAT_LEVELS:
                flat.append(np.stack([low[zero], high[zero]], axis=1))
                keep &= ~zero
            low, high, signs = low[keep], high[keep], signs[keep]
        left = ((high - low) <= size).all(axis=1)
        dropped = float(np.prod(high[~left] - low[~left], axis=1).sum())
        area = np.prod([line[-1] - line[0] for line in self.lines])
        none = np.empty((0, 2, 2))
        boxes = np.stack([low, high], axis=1)[left]
        boxes = np.concatenate([boxes, *rings])
        return boxes, np.concatenate([none, *flat]), dropped / float(area)

    def _near_curves(self) -> NDArray[np.bool_]:
        """Say which cells touch one with a sign change, or one in which K is not to be had."""
        near = self.crossed | ~self.mask
        for (i, j), _ in (side for border in self._borders() for side in border):
            near[min(i, near.shape[0] - 1), min(j, near.shape[1] - 1)] = True
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


def _of_corners(x: NDArray[Any]) -> NDArray[Any]:
    """Return what is at the four corners (4, …) of cells, in turn."""
    return np.stack([x[:-1, :-1], x[1:, :-1], x[1:, 1:], x[:-1, 1:]])


def _signs(values: Array, zero: NDArray[np.bool_], wraps: tuple[bool, bool]) -> NDArray[np.bool_]:
    """Say where K is positive; where it is `zero` up to its error, as it is beside that place.

    So a curve through corners, or along a border, is crossed once or not at all, whatever the
    signs of the rounding. Two steps reach all corners of a cell from one that has a sign.
    """
    signs = np.where(zero, 0, np.sign(values)).astype(np.int8)
    for _ in range(2):
        padded = np.pad(signs, 1)
        for beside in (padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]):
            signs = np.where(signs == 0, beside, signs)
    for axis in (0, 1):
        if wraps[axis]:
            np.swapaxes(signs, 0, axis)[-1] = np.swapaxes(signs, 0, axis)[0]
    return signs > 0


def _refined(line: Array, cells: int) -> Array:
    steps = np.arange(cells) / cells
    inner = line[:-1, None] + np.diff(line)[:, None] * steps
    return np.append(inner.ravel(), line[-1])


def _bisected(field: CurvatureField, low: Array, high: Array, positive: NDArray[np.bool_]) -> Array:
    """Return the zeros (k, 2) of K between places where it has two signs; the `low` one's is given.

    The sign of a place where K is zero up to its error was taken from its neighbours.
    """
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
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """Say which rectangles may hold a zero of K; have another sign too; are zero up to error."""
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
    return keep, other, np.maximum(largest, -smallest) <= noise


def _clusters(boxes: Array, size: Array) -> Array:
    """Join rectangles that touch; returns those (k, 2, 2) that hold the groups."""
    groups = np.empty((0, 2, 2))
    for box in boxes:
        touching = _touching(box, groups, size)
        corners = np.concatenate([box[None], groups[touching]])
        joint = np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
        groups = np.concatenate([groups[~touching], joint[None]])
    return groups


def _touching(box: Array, others: Array, size: Array) -> NDArray[np.bool_]:
    """Say which rectangles (k, 2, 2) are nearer to one than `size`."""
    low, high = box[0] - size, box[1] + size
    return ((others[:, 0] <= high) & (others[:, 1] >= low)).all(axis=1)
