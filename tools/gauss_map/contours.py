"""The contour generator of a spline, the curve with N·d = 0, and polylines through its samples.

d is a direction, or the ray x − p from a viewpoint p. The signs of N·d on a grid locate the curves,
which are closed or end at open sides. Zero counts as positive, so that a curve may follow sides of
the grid, and cross a pole; along an open side, a zero gets the sign opposite to the inside. Samples
are sorted along these curves by their feet, the nearest points of the curves in the parameter
plane. A curve is cut where it leaves the trim of the spline.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.trees import tree_of
from ...runtime.domain.domain import brought_inside, closes
from ...runtime.spline.spline import Spline
from .sign_changes import sign_changes, with_borders

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

# A cell of the spline is divided, along u and along v, into the largest of these numbers of parts
# with which there are at most MOST_CELLS cells.
PARTS, MOST_CELLS = (8, 4, 2), 1 << 16
# The error of N·d relative to the length of N.
ROUNDING = 1e-14
# The foot of a sample is searched on this number of segments, which have the nearest midpoints.
CANDIDATES = 8


class View(NamedTuple):
    """An eye: `at` is its position or, for an eye that is `far`, the direction of its view."""

    at: Array
    far: bool

    def rays(self, points: Array) -> Array:
        """Return the directions (k, 3), of any length, in which the eye sees points (k, 3)."""
        return np.broadcast_to(self.at, points.shape) if self.far else points - self.at


def places_along(spline: Spline, view: View, count: int) -> tuple[Array, tuple[Indices, ...]]:
    """Return the parameters (k, 2) of about `count` points along the contour generator.

    The points are equally spaced in space. Also return polylines, as `polylines_of` does.
    """
    ends, section, closed, outside = _segments(spline, view)
    ends, section = ends[~outside], section[~outside]
    uv = [_wrapped(spline, ends[:, k]) for k in (0, 1)]
    steps = np.linalg.norm(spline.evaluate(*uv[1].T) - spline.evaluate(*uv[0].T), axis=1)
    places, lines, first = [np.empty((0, 2))], list[Indices](), 0
    for k in np.unique(section):
        own = np.flatnonzero(section == k)
        along = np.concatenate([[0.0], np.cumsum(steps[own])])
        number = max(round(count * along[-1] / steps.sum()), 1) if along[-1] > 0.0 else 0
        at = np.linspace(0.0, along[-1], number, endpoint=not closed[k])
        before = np.clip(np.searchsorted(along, at, side="right") - 1, 0, len(own) - 1)
        share = ((at - along[before]) / np.maximum(steps[own[before]], 1e-300))[:, None]
        start, end = ends[own[before], 0], ends[own[before], 1]
        places.append(_wrapped(spline, start + share * (end - start)))
        rows = first + np.arange(number)
        lines.append(np.append(rows, rows[:1]) if closed[k] else rows)
        first += number
    return np.concatenate(places), tuple(x for x in lines if len(x))


def _wrapped(spline: Spline, cells: Array) -> Array:
    """Convert positions (k, 2), in cells of the spline, to parameters, wrapped across seams."""
    u, v = (spline.frame[:2] + cells * spline.frame[2:]).T
    return np.stack(brought_inside(u, v, spline.domain, spline.boundary), axis=1)


def polylines_of(spline: Spline, view: View, uv: Array) -> tuple[Indices, ...]:
    """Return the indices of samples in their order along each curve of the contour generator.

    `uv` are the parameters of the samples. A closed curve repeats its first sample at its end. Each
    sample is in one polyline.
    """
    if not len(uv):
        return ()
    ends, section, closed, _ = _segments(spline, view)
    if not len(ends):  # a curve in the corner of a cell, too small to be found
        return (np.arange(len(uv)),)
    copies, original = _with_copies(spline, ends)
    segment, share = _feet(copies, spline.in_cells(uv.copy()))
    segment = original[segment]
    order = np.lexsort((share, segment))
    at = section[segment[order]]
    found = np.split(order, np.flatnonzero(np.diff(at)) + 1)
    return tuple(
        np.append(x, x[0]) if len(x) > 1 and closed[section[segment[x[0]]]] else x for x in found
    )


def _segments(spline: Spline, view: View) -> tuple[Array, Indices, list[bool], Flags]:
    """Return the segments (k, 2, 2) of all curves, in cells and in order, and their sections (k,).

    A curve inside the trim is one section; each segment outside of the trim begins another section.
    Also return, for each section, whether it is closed, and a mask (k,) of the segments outside of
    the trim.
    """
    ends, sections, closed = [np.empty((0, 2, 2))], [np.empty(0, dtype=np.int64)], list[bool]()
    left = [np.empty(0, dtype=np.bool_)]
    for parts, is_closed in _lines(spline, view):
        own = np.concatenate([np.stack([x[:-1], x[1:]], axis=1) for x in parts])
        outside = np.zeros(len(own), dtype=bool)
        if spline.trim is not None:
            middle = spline.frame[:2] + own.mean(axis=1) * spline.frame[2:]
            outside = ~spline.trim.contains(middle)
        first = int(outside.argmax()) if is_closed else 0
        ends.append(np.roll(own, -first, axis=0))
        left.append(np.roll(outside, -first))
        sections.append(len(closed) + np.cumsum(np.roll(outside, -first)))
        closed += [is_closed and not outside.any()] * (1 + np.count_nonzero(outside))
    return np.concatenate(ends), np.concatenate(sections), closed, np.concatenate(left)


def _feet(ends: Array, places: Array) -> tuple[Indices, Array]:
    """Return the segments nearest to positions (k, 2), and the positions of the feet on them.

    The segments are given by their indices (k,), the feet (k,) by numbers from 0 at the start of
    the segment to 1 at its end.
    """
    number = min(CANDIDATES, len(ends))
    near = tree_of(ends.mean(axis=1)).query(places, k=number)[1].reshape(len(places), number)
    start, step = ends[near, 0], ends[near, 1] - ends[near, 0]
    from_start, squares = places[:, None] - start, (step * step).sum(axis=2)
    t = np.divide(
        (from_start * step).sum(axis=2), squares, out=np.zeros_like(squares), where=squares > 0.0
    ).clip(0.0, 1.0)
    best = ((from_start - t[..., None] * step) ** 2).sum(axis=2).argmin(axis=1)
    rows = np.arange(len(places))
    return near[rows, best], t[rows, best]


def _lines(spline: Spline, view: View) -> list[tuple[list[Array], bool]]:
    """Return the curves of the contour generator.

    For each curve, return its parts (k, 2), in cells of the spline, and whether it is closed.
    """
    parts = next((x for x in PARTS if x * x * np.prod(spline.cells) <= MOST_CELLS), PARTS[-1])
    counts = np.array(spline.cells) * parts
    nodes = np.stack(np.meshgrid(*map(np.arange, counts + 1), indexing="ij"), axis=-1)
    normals = spline.normals_in_cells(nodes.reshape(-1, 2) / parts).reshape(*nodes.shape[:2], 3)
    values, noise = normals @ view.at, ROUNDING * np.linalg.norm(normals, axis=2)
    if not view.far:
        u, v = np.moveaxis(spline.frame[:2] + nodes / parts * spline.frame[2:], -1, 0)
        rays = view.rays(spline.evaluate(u, v))
        values, noise = (normals * rays).sum(axis=2), noise * np.linalg.norm(rays, axis=2)
    values[np.abs(values) <= noise] = 0.0
    kinds = spline.boundary[0][0], spline.boundary[1][0]
    for by, pair in enumerate(spline.boundary):  # on both sides of a seam, equal up to rounding
        side = np.swapaxes(values, 0, by)
        if closes(pair):
            side[-1] = side[0] if pair[0] == "periodic" else -side[0, ::-1]
    values = with_borders(values, noise, kinds)

    def places(low: Indices, high: Indices) -> Array:
        at_low, at_high = (np.abs(values[tuple(x.T)]) for x in (low, high))
        return (low + (at_low / (at_low + at_high))[:, None] * (high - low)) / parts

    return sign_changes(values, kinds, places)


def _with_copies(spline: Spline, ends: Array) -> tuple[Array, Indices]:
    """Add copies of the segments next to seams, shifted beyond the seams.

    Also return the index of the original of each segment.
    """
    which = np.arange(len(ends))
    for axis, pair in enumerate(spline.boundary):
        if not closes(pair):
            continue
        size, middle = spline.cells[axis], ends.mean(axis=1)[:, axis]
        for shift, near in ((size, middle < 1.0), (-size, middle > size - 1.0)):
            copy = ends[: len(near)][near]
            copy[..., axis] += shift
            if pair[0] == "mirrored":
                copy[..., 1 - axis] = spline.cells[1 - axis] - copy[..., 1 - axis]
            ends = np.concatenate([ends, copy])
            which = np.concatenate([which, which[: len(near)][near]])
    return ends, which
