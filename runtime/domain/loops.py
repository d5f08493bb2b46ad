"""Loops: closed polygons in the parameter plane, with tests of whether points are inside."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..base.checks import finite_array, listed
from ..base.errors import InputError, shown
from ..base.repeats import repeated
from ..base.scales import scale_to_one
from ..base.threads import over_ranges
from .domain import Boundary, Domain, brought_inside, closes
from .kernels import trim as kernels

# Segments are sorted into a square grid of cells. It has about this many cells for each segment,
# and at most this many rows.
CELLS_A_SEGMENT, MOST_ROWS = 8, 2048
# The lists of segments of all cells have at most about this many entries together.
MOST_ENTRIES = 1 << 24
# A segment belongs to all cells within a margin around it, the sum of two numbers: the first one in
# units of a cell, the second one in units in the last place of the largest coordinate.
MARGIN, MARGIN_IN_ROUNDINGS = 1e-9, 16.0
POINTS_AT_A_TIME = 1 << 14
# The largest distance of a point of a loop from the bounds of a periodic parameter, in periods.
MOST_PERIODS = 100
# The number of pairs of a box and a segment in one batch.
PAIRS_AT_A_TIME = 1 << 20
# Loops overlap their copies if some point is inside twice. Points at the distance BESIDE from the
# loops, relative to the domain, are tested; they are spaced by at most 1/SIDES of the domain.
BESIDE, SIDES = 1e-6, 64
# The signs of the coordinates of the corners of a square around 0.
CORNERS = np.array([(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)])
# Points on an open side of the domain are moved inwards by this part of the domain.
INSIDE = 1e-13


@dataclass(frozen=True, eq=False)
class Loops:
    """Closed polygons (k, 2) in the parameter plane; a point is inside by the even-odd rule.

    The first point of a polygon is not repeated. Loops may cross the seam of a periodic direction:
    a point belongs to the inside if the polygons contain the point, or a copy of the point that is
    shifted by whole periods.
    """

    polygons: tuple[Array, ...]
    domain: Domain
    boundary: Boundary

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether points (k, 2) of the domain are inside, as booleans (k,)."""
        cells, shifts = self._cells
        places, inside = np.ascontiguousarray(self._inwards(uv)), np.empty(len(uv), dtype=np.bool_)

        def work(first: int, last: int) -> None:
            kernels.find_inside(cells, shifts, places, first, last, inside)

        list(over_ranges(work, len(uv), POINTS_AT_A_TIME, threads))
        return inside

    def overlap(self) -> bool:
        """Return whether loops and their copies, shifted by whole periods, have common points."""
        low, high = np.array(self.domain).T
        around = [closes(ends) for ends in self.boundary]
        if not ((self.box[1] - self.box[0] > high - low) & around).any():
            return False
        border = np.concatenate([_steps(x, (high - low) / SIDES) for x in self.polygons])
        near = border + BESIDE * (high - low) * CORNERS[:, None]
        u, v = near.reshape(-1, 2).T.copy()
        near = np.stack(brought_inside(u, v, self.domain, self.boundary), axis=1)
        (cells, shifts), places = self._cells, np.ascontiguousarray(self._inwards(near))
        inside = np.empty((len(shifts), len(near)), dtype=np.bool_)
        for k in range(len(shifts)):
            kernels.find_inside(cells, shifts[k : k + 1], places, 0, len(places), inside[k])
        return bool((inside.sum(axis=0) > 1).any())

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags:
        """Return a mask (m, n) of the cells of a grid that sides of the polygons may intersect."""
        low, high = np.array(domain).T
        steps = (high - low) / cells
        points = np.concatenate([_steps(x, steps / 2.0) for x in self.polygons])
        passed = np.zeros(cells, dtype=np.bool_)
        for a, b, c, d in self.shifts:
            # The inverse of u → a u + b is u → a (u − b), since a is 1 or −1.
            places = np.stack([a * (points[:, 0] - b), c * (points[:, 1] - d)], axis=1)
            i, j = np.floor((places - low) / steps).astype(np.int64).T
            here = (i >= -1) & (i <= cells[0]) & (j >= -1) & (j <= cells[1])
            marks = np.zeros((cells[0] + 2, cells[1] + 2), dtype=np.bool_)
            marks[i[here] + 1, j[here] + 1] = True
            # Mark the cells that contain one of the points, and the neighbours of these cells.
            rows = marks[:-2] | marks[1:-1] | marks[2:]
            passed |= rows[:, :-2] | rows[:, 1:-1] | rows[:, 2:]
        return passed

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Classify boxes (k, 4): 1 if inside, −1 if outside, 0 if a segment may meet the box.

        Boxes have a margin for rounding errors. The normals (k, 3) are not used.
        """
        low, high = boxes[:, ::2], boxes[:, 1::2]
        middles, halves = (low + high) / 2.0, (high - low) / 2.0
        sides = np.where(self.contains(middles), 1, -1).astype(np.int8)
        segments = np.concatenate([np.hstack([x, np.roll(x, -1, axis=0)]) for x in self.polygons])
        step = max(PAIRS_AT_A_TIME // len(segments), 1)
        for a, b, c, d in self.shifts:
            moved = middles * (a, c) + (b, d)
            for first in range(0, len(boxes), step):
                some = slice(first, first + step)
                sides[some][_may_meet(segments, moved[some], halves[some]).any(axis=1)] = 0
        return sides

    def _inwards(self, uv: Array) -> Array:
        """Return the points (k, 2); points on open sides are moved inwards, see INSIDE."""
        return uv.clip(*self._limits)

    @cached_property
    def _limits(self) -> tuple[Array, Array]:
        """The bounds (2,) to which u and v are clipped: just inside open sides, otherwise ±∞."""
        low, high = np.array(self.domain).T
        nudge = INSIDE * (high - low)
        is_open = np.array([not closes(ends) for ends in self.boundary])
        return np.where(is_open, low + nudge, -np.inf), np.where(is_open, high - nudge, np.inf)

    @cached_property
    def box(self) -> Array:
        """(2, 2) float64: the smallest and the largest u and v."""
        points = np.concatenate(self.polygons)
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @cached_property
    def shifts(self) -> Array:
        """The maps (s, 4) of a point u, v to its copies a u + b, c v + d that may be inside.

        A row is a, b, c, d. Copies differ from the point by whole periods.
        """
        (u0, u1), (v0, v1) = self.domain
        along_u, along_v = (self._periods(axis) for axis in (0, 1))
        rows = []
        for k in along_u:
            for m in along_v:
                turned_v = self.boundary[0][0] == "mirrored" and k % 2
                turned_u = self.boundary[1][0] == "mirrored" and m % 2
                a, b = (-1.0, u0 + u1) if turned_u else (1.0, 0.0)
                c, d = (-1.0, v0 + v1) if turned_v else (1.0, 0.0)
                rows.append((a, b + k * (u1 - u0), c, d + m * (v1 - v0)))
        return np.array(rows)

    def _periods(self, axis: int) -> list[int]:
        """Return the numbers of periods by which points may be shifted along an axis, 0 first."""
        low, high = self.domain[axis]
        if not closes(self.boundary[axis]):
            return [0]
        period = high - low
        first = math.floor((float(self.box[0, axis]) - high) / period)
        last = math.ceil((float(self.box[1, axis]) - low) / period)
        return sorted({0, *range(first, last + 1)}, key=abs)

    @cached_property
    def _cells(self) -> tuple[kernels.SegmentGrid, Array]:
        """The segments, sorted into cells, and `shifts`, both scaled by powers of two."""
        sizes = self.box[1] - self.box[0]
        scales = np.array([scale_to_one(float(x)) for x in sizes])
        ends = [np.stack([x, np.roll(x, -1, axis=0)], axis=1) for x in self.polygons]
        segments = np.concatenate(ends) * scales
        # Each segment starts at its lower end: a segment that two polygons share is then equal in
        # both.
        (u, v), (w, z) = segments[:, 0].T, segments[:, 1].T
        turned = (v > z) | ((v == z) & (u > w))
        segments[turned] = segments[turned][:, ::-1]
        segments = np.ascontiguousarray(segments.reshape(-1, 4))
        sizes = np.where(sizes > 0.0, sizes * scales, 1.0)
        reach = (np.abs(segments[:, 2:] - segments[:, :2]) / sizes).sum()
        count = min(math.ceil(math.sqrt(CELLS_A_SEGMENT * len(segments))), MOST_ROWS)
        count = max(min(count, int(MOST_ENTRIES / reach)), 1) if reach > 0.0 else count
        steps = sizes / count
        frame = np.concatenate([self.box[0] * scales, 1.0 / steps, steps])
        cells = kernels.SegmentGrid(
            segments, frame, np.zeros(count * count + 1, dtype=np.int64),
            np.empty(0, dtype=np.int32), np.empty((count, count), dtype=np.bool_),
        )  # fmt: skip
        rounding = np.spacing(np.abs(self.box * scales).max(axis=0))
        margins = MARGIN * steps + MARGIN_IN_ROUNDINGS * rounding
        kernels.find_parities(cells)
        kernels.list_segments(cells, margins, False)
        starts = np.cumsum(cells.starts)
        cells = cells._replace(starts=starts.copy(), members=np.empty(starts[-1], dtype=np.int32))
        kernels.list_segments(cells, margins, True)
        return cells._replace(starts=starts), self.shifts * np.repeat(scales, 2)


def _may_meet(segments: Array, middles: Array, halves: Array) -> Flags:
    """Return whether n segments (n, 4) may meet k boxes, as flags (k, n).

    Boxes are given by their centres `middles` (k, 2) and half sizes `halves` (k, 2). A segment does
    not meet a box if a line parallel to u, to v or to the segment separates them.
    """
    start, way = segments[:, :2], (segments[:, 2:] - segments[:, :2]) / 2.0
    largest = np.maximum(np.abs(segments).max(), np.abs(middles).max(initial=0.0))
    halves = halves + MARGIN_IN_ROUNDINGS * np.spacing(largest)
    off = start + way - middles[:, None]
    beside = (np.abs(off) > np.abs(way) + halves[:, None]).any(axis=2)
    across = np.abs(off[:, :, 0] * way[:, 1] - off[:, :, 1] * way[:, 0])
    reach = halves @ np.abs(way[:, ::-1]).T
    rounding = MARGIN_IN_ROUNDINGS * 2.0**-52 * (np.abs(off) * np.abs(way[:, ::-1])).sum(axis=2)
    return ~beside & (across <= reach + rounding)


def _steps(polygon: Array, steps: Array) -> Array:
    """Return points on a polygon (k, 2), spaced by at most `steps` (2,) along u and v."""
    along = np.roll(polygon, -1, axis=0) - polygon
    parts = np.ceil(np.abs(along / steps).max(axis=1)).astype(np.int64) + 1
    owner, number = repeated(parts)
    return polygon[owner] + (number / parts[owner])[:, None] * along[owner]


# --- reading loops --------------------------------------------------------------------------------


def checked_loops(loops: object, domain: Domain, boundary: Boundary) -> Loops:
    """Return the `Loops` that a user gives; InputError if they are not closed polygons."""
    polygons = [_polygon(x, k) for k, x in enumerate(_rings(loops))]
    if not polygons:
        raise InputError("loops is empty; give at least one closed polygon of points u, v.")
    for k, polygon in enumerate(polygons):
        for axis, (low, high) in enumerate(domain):
            size = max(np.abs(polygon[:, axis] - low).max(), np.abs(polygon[:, axis] - high).max())
            if closes(boundary[axis]) and size > MOST_PERIODS * (high - low):
                raise InputError(
                    f"loop {k} is more than {MOST_PERIODS} periods of {'uv'[axis]} away from the "
                    f"domain ({low}, {high})."
                )
    return Loops(tuple(polygons), domain, boundary)


def _rings(loops: Any) -> list[Any]:  # noqa: ANN401
    """Return the closed polygons that a user gives.

    They are given as a geometry, as one array (k, 2), or as a sequence of geometries and arrays.
    """
    if hasattr(loops, "__geo_interface__"):
        return _rings_of_geometry(loops.__geo_interface__)
    items = listed(loops)
    if items is None:
        raise InputError(
            "loops must be a sequence of closed polygons, arrays (k, 2) of points u, v, or a "
            f"Polygon of Shapely, not {shown(loops)}."
        )
    if isinstance(loops, np.ndarray) and loops.ndim == 2:
        return [loops]
    rings: list[Any] = []
    for item in items:
        geometry = hasattr(item, "__geo_interface__")
        rings.extend(_rings_of_geometry(item.__geo_interface__) if geometry else [item])
    return rings


def _rings_of_geometry(geometry: Any) -> list[Any]:  # noqa: ANN401
    """Return the outer boundaries and the holes of a (Multi)Polygon, each as a list of points."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind not in ("Polygon", "MultiPolygon"):
        raise InputError(f"loops must be a Polygon or a MultiPolygon, not a {shown(kind)}.")
    coordinates = geometry["coordinates"]
    polygons = [coordinates] if kind == "Polygon" else coordinates
    return [[point[:2] for point in ring] for polygon in polygons for ring in polygon]


def _polygon(points: Any, number: int) -> Array:  # noqa: ANN401
    """Return the points (k, 2) of loop `number`; the first point is not repeated at the end."""
    array = finite_array(points, ("k", 2), f"loop {number}")
    if len(array) > 1 and (array[0] == array[-1]).all():
        array = array[:-1]
    if len(array) < 3:
        raise InputError(f"loop {number} has {len(array)} points; a polygon needs at least 3.")
    return array
