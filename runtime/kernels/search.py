"""The search for normals in bins that are normals of patches.

For each patch: the cone of its normals, the bins that the cone may meet, the normals in these bins,
and the signs of the forms of the patch at these normals.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..machine_code.jit import inline, jit, loop
from .classify import UNDECIDED, YES, classify, count_undecided, look_again
from .few import Few, classify_few, copy_few
from .sort import pack_hits, store_sorted
from .strips import AXIS, BOUND, FLAT, SINE, Polyhedron, Strip, boxes_of, patch_in, strip_of
from .tile import vector_in
from .vectors import VECTOR, whole_vectors
from .windows import Cone, face_window, load_cone, map_cone, set_empty, spans_of_hull

__all__ = ["Bins", "Coefficients", "Found", "search_in"]

# The least height of a unit vector on a face of the cube, 1/√3 rounded down; the height of a vector
# in a cone is at least that of the axis minus SLOPE times the sine.
FACE_HEIGHT, SLOPE = 0.577, 1.1
# Windows with more rows and columns than this are restricted to the hull.
SMALL_WINDOW = 3
# Rows of bins are one square high. Typed: Numba compiles a function anew for a literal number.
ROW_HEIGHT = np.int64(1)
# The initial capacity for candidates.
FEW = 1 << 10


class Coefficients(NamedTuple):
    """The coefficients of a spline and their properties.

    Coefficients mu (m, n, 3) with ghost coefficients, the power of two that scales them to about 1,
    the rounding error of the scaled coordinates, and which sides of the domain are open (4,).
    """

    mu: NDArray[np.float64]
    scale: float
    noise: float
    border: NDArray[np.bool_]


class Bins(NamedTuple):
    """Normals in the order of bins: the `starts` of bins, `normals` (S, 4) with their numbers.

    `frame` (3, 3), of norm `stretch`, maps normals to the cube; an edge has `grid` squares.
    """

    frame: NDArray[np.float64]
    stretch: float
    grid: int
    starts: NDArray[np.int64]
    normals: NDArray[np.float64]


class Found(NamedTuple):
    """The output of a search: rows (…, 2) of patch and packed hit, certain and undecided.

    `bounds` (…) are the errors of the forms of undecided hits, `flat` (…) the patches that may be
    developable. `counts` (3,) are the numbers of certain hits, undecided hits and flat patches.
    """

    certain: NDArray[np.int64]
    undecided: NDArray[np.int64]
    bounds: NDArray[np.float64]
    flat: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, room: int, patches: int) -> Found:
        """Return arrays for `room` hits of each kind, and for a number of patches."""
        return cls(
            np.empty((room, 2), np.int64),
            np.empty((room, 2), np.int64),
            np.empty(room),
            np.empty(patches, np.int64),
            np.zeros(3, np.int64),
        )


class BinMemory(NamedTuple):
    """Work arrays for the bins that a cone may meet: windows of the faces, and rows of bins."""

    windows: NDArray[np.int64]
    hulls: NDArray[np.float64]
    errors: NDArray[np.float64]
    sizes: NDArray[np.int64]
    rows: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def new(cls, grid: int) -> BinMemory:
        """Return work arrays for bins with `grid` squares along an edge."""
        return cls(
            np.empty((6, 4), np.int64),
            np.empty((6, 12, 2)),
            np.empty(6),
            np.empty(6, np.int64),
            np.empty((6 * grid, 2), np.int64),
            np.empty(grid + VECTOR),
            np.empty(grid + VECTOR),
        )


class Candidates(NamedTuple):
    """Work arrays for candidate normals of a patch."""

    places: NDArray[np.int64]
    numbers: NDArray[np.float64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    codes: NDArray[np.int8]
    hits: NDArray[np.int64]
    scratch: NDArray[np.int64]
    digits: NDArray[np.int64]

    @classmethod
    def new(cls, count: int) -> Candidates:
        """Return work arrays for `count` normals."""
        size = count + VECTOR
        return cls(
            np.empty(size, np.int64),
            np.empty(size),
            np.ones(size),
            np.ones(size),
            np.ones(size),
            np.empty(size, np.int8),
            np.empty(size, np.int64),
            np.empty(size, np.int64),
            np.empty(size + 1, np.int64),
        )

    @property
    def room(self) -> int:
        """The capacity in normals."""
        return self.x.size - VECTOR


def search_in(
    spline: Coefficients, cube: Polyhedron, bins: Bins
) -> Callable[[int, int, Found], tuple[int, int]]:
    """Return a function that calls `search_patches` with work arrays of its own."""
    strip, few, cone = Strip.new(), Few.new(), Cone.new()
    memory, candidates = BinMemory.new(bins.grid), Candidates.new(FEW)

    def search(first: int, last: int, found: Found) -> tuple[int, int]:
        nonlocal candidates
        while True:
            first, needed = search_patches(
                spline, cube, bins, first, last, found, strip, few, cone, memory, candidates
            )
            if needed <= candidates.room:
                return first, needed
            candidates = Candidates.new(2 * needed)

    return search


@jit
def search_patches(spline, cube, bins, first, last, found, strip, few, cone, memory, candidates):
    """Find the normals of the patches first, …, last − 1, in ascending order for each patch.

    Returns the patch at which the capacity was exceeded, and the number of normals that this patch
    needs; `last` and 0 at the end.
    """
    certain, undecided, bounds, flat, counts = found
    places, numbers, x, y, z, codes, hits, scratch, digits = candidates
    begin = end = first
    for number in range(first, last):
        if number == end:
            begin, end = strip_of(spline, number, last, strip)
            boxes_of(cube, strip)
            classify_few(cube, bins.starts, bins.normals, strip, end - begin, few)
        place = number - begin
        sine, bound = strip.rows[SINE + place], strip.rows[BOUND + place]
        total = few.starts[place + 1] - few.starts[place]
        if few.many[place]:
            load_cone(strip.rows, place, cone)
            total = count_normals(bins, cone, sine, memory)
        if (
            counts[0] + total > certain.shape[0]
            or counts[1] + total > undecided.shape[0]
            or total + VECTOR > x.size
        ):
            return number, total
        if strip.rows[FLAT + place] > 0.0:
            flat[counts[2]] = number
            counts[2] += 1
        if total == 0:
            continue
        if few.many[place]:
            size = rows_of_bins(bins.grid, bins.starts, memory)
            count = gather(memory.rows, size, bins.normals, places, numbers, x, y, z)
            patch, axis = patch_in(strip.rows, place), vector_in(strip.rows, AXIS, place)
            classify(patch, axis, sine, bound, x, y, z, codes, whole_vectors(count))
            if sine == math.inf:
                look_again(patch, x, y, z, codes, count)
        else:
            count = copy_few(few, place, bins.normals, places, numbers, codes)
        chosen = pack_hits(codes, YES, numbers, places, hits, count)
        counts[0] = store_sorted(hits, chosen, scratch, digits, number, certain, counts[0])
        if count_undecided(codes, count) > 0:
            chosen = pack_hits(codes, UNDECIDED, numbers, places, hits, count)
            for k in range(chosen):
                bounds[counts[1] + k] = bound
            counts[1] = store_sorted(hits, chosen, scratch, digits, number, undecided, counts[1])
    return last, 0


@loop
def count_normals(bins, cone, sine, memory):
    """Write the windows of the faces that a cone may meet; return the number of their normals."""
    frame, stretch, grid, starts, _ = bins
    windows, hulls, errors, sizes, _, _, _ = memory
    axis = cone.axis
    map_cone(cone, frame, stretch)
    total = 0
    for face in range(6):
        window = windows[face]
        set_empty(window)
        if starts[face * grid * grid] == starts[(face + 1) * grid * grid]:
            continue
        height = axis[face >> 1] if face & 1 == 0 else -axis[face >> 1]
        if stretch == 1.0 and height + SLOPE * sine < FACE_HEIGHT:
            continue
        errors[face], sizes[face] = face_window(
            cone.shown, cone.angles, sine < math.inf, face, grid, window, hulls[face]
        )
        total += count_window(window, face, grid, starts)
    return total


@inline
def count_window(window, face, grid, starts):
    """Return the number of normals in a window."""
    total = 0
    if window[1] >= window[0]:
        for row in range(window[2], window[3] + 1):
            base = (face * grid + row) * grid
            total += starts[base + window[1] + 1] - starts[base + window[0]]
    return total


@loop
def rows_of_bins(grid, starts, memory):
    """Write the ranges of normals in rows of bins that a cone may meet; return their number."""
    windows, hulls, errors, sizes, rows, low, high = memory
    count = 0
    for face in range(6):
        window, error = windows[face], errors[face]
        left, right, below, above = window[0], window[1], window[2], window[3]
        cut = right > left + SMALL_WINDOW and above > below + SMALL_WINDOW and error < math.inf
        if cut:
            spans_of_hull(hulls[face], sizes[face], error, ROW_HEIGHT, below, above, low, high)
        for row in range(below, above + 1):
            begin, end = left, right
            if cut:
                least = max(low[row - below] - error, left)
                most = min(high[row - below] + error, right + 1.0)
                if least > most:
                    continue
                begin, end = int(least), min(int(most), right)
            base = (face * grid + row) * grid
            if begin <= end:
                rows[count, 0] = starts[base + begin]
                rows[count, 1] = starts[base + end + 1]
                count += 1
    return count


@loop
def gather(rows, size, normals, places, numbers, x, y, z):
    """Copy the normals in rows of bins, their positions and numbers; return their number."""
    prefetched = 0.0
    for row in range(size):
        # Prefetch all rows at once, in place of one cache miss after the other.
        for k in range(rows[row, 0], rows[row, 1], 2):
            prefetched += normals[np.uint64(k), 0]
    count = 0
    for row in range(size):
        begin = rows[row, 0]
        for k in range(rows[row, 1] - begin):
            at, place = np.uint64(count + k), np.uint64(begin + k)
            places[at] = begin + k
            x[at] = normals[place, 0]
            y[at] = normals[place, 1]
            z[at] = normals[place, 2]
            numbers[at] = normals[place, 3]
        count += rows[row, 1] - begin
    x[count] = prefetched  # keeps the compiler from removing the reads; integer sums are slower
    return count
