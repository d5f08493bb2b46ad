"""Patches with few candidate normals: those of a strip are classified in one vectorized loop.

The candidates are the normals in the boxes of a patch on the faces that it meets: in bins of the
cube, or points of an icosphere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.icosahedron import CORNER_PLACES, EDGE_PLACES
from ...generated.vectors import Vector
from ..base.tolerances import ACCURATE
from ..machine_code.jit import long_vectors, loop
from .bins import nearest_bin
from .boxes import box_in, box_on_face, may_reach
from .classify import NO, UNDECIDED, YES, code_of
from .icosphere import row_start
from .runs import NO_FACE, ROW, SIZE
from .sort import insertion_sort
from .strips import AXIS, BOUND, SINE, patch_in
from .tile import TILE, vector_in
from .vectors import VECTOR

__all__ = ["NO_STARTS", "Few", "classify_few", "copy_few", "store_few_runs"]

# A patch has few candidates if there are not more than this, in not more rows.
MOST, MOST_ROWS = 64, 16
# So many candidates are classified at a time.
LANES = 8
# The number of columns of the table, and the starts of the rows with the vectors and the codes.
ROOM = TILE * MOST + VECTOR
CODE = np.uint64(3 * ROOM)
# The `starts` of bins of an icosphere, which has none.
NO_STARTS = np.empty(0, np.int64)
# The corners (0, 0), (ν, 0), (0, ν) and the edges t = 0, s = 0, s + t = ν of the faces of an
# icosahedron: their numbers on the face on which they are looked up, −1 on others.
CORNER_OF, EDGE_OF = np.full((2, 20, 3), -1)
for _number, (_face, _t, _s) in enumerate(CORNER_PLACES):
    CORNER_OF[_face, _s + 2 * _t] = _number
EDGE_OF[tuple(EDGE_PLACES.T)] = np.arange(len(EDGE_PLACES))
# The bits of the face in a packed run.
FACE_BITS = (1 << SIZE - ROW) - 1


class Few(NamedTuple):
    """Work arrays: which patches of a strip have `many` candidates, and where the others `start`.

    Each candidate has a packed run of one point, or a place in the order of bins, and a column of
    the table: its components and a code.
    """

    many: NDArray[np.bool_]
    starts: NDArray[np.int64]
    hits: NDArray[np.int64]
    table: NDArray[np.float64]

    @classmethod
    def new(cls) -> Few:
        """Return new work arrays."""
        return cls(
            np.zeros(TILE, np.bool_),
            np.zeros(TILE + 1, np.int64),
            np.zeros(ROOM, np.int64),
            np.zeros(4 * ROOM),
        )


@loop
def classify_few(polyhedron, starts, normals, strip, count, few):
    """Write and classify the candidates of the first patches of a strip.

    `normals` (S, …) are in the order of bins with these `starts`, or those of an icosphere.
    """
    at = np.int64(0)  # typed: a literal number is compiled for itself
    for k in range(count):
        few.starts[k] = at
        end = write_candidates(polyhedron, starts, strip, k, few, at)
        few.many[k] = end < 0
        at = max(at, end)
    few.starts[count] = at
    for c in range(at):
        place = few.hits[c] >> 32 if starts.size == 0 else few.hits[c]
        for x in range(3):
            few.table[x * ROOM + c] = normals[place, x]
    for k in range(count):
        if few.starts[k] < few.starts[k + 1]:
            write_codes(strip.rows, k, few, few.starts[k], few.starts[k + 1])


@loop
def write_candidates(polyhedron, starts, strip, k, few, at):
    """Write the candidates of patch k from `at` on; return their end, or −1 if they are many."""
    if strip.rows[SINE + k] == math.inf:
        return -1
    if strip.faces[k] >= 0:
        return in_box(polyhedron, starts, strip, k, strip.faces[k], few, at, at + MOST)
    end = at
    for face in range(polyhedron.frames.shape[0]):
        if may_reach(polyhedron, face, strip.rows, k) and box_on_face(
            polyhedron, face, strip.rows, k
        ):
            end = in_box(polyhedron, starts, strip, k, face, few, end, at + MOST)
            if end >= 0 and starts.size == 0:
                end = on_border(polyhedron.grid, strip.rows, k, face, few, end, at + MOST)
            if end < 0:
                return -1
    insertion_sort(few.hits[at:], end - at)
    return end


@loop
def in_box(polyhedron, starts, strip, k, face, few, at, limit):
    """Write the candidates inside a face that are in the box of patch k there; return their end.

    It is −1 if it were above the limit, or if the box is large.
    """
    rows, grid = strip.rows, polyhedron.grid
    west, east, south, north, least, most = box_in(rows, k)
    expected = (north - south) * (east - west) * polyhedron.density
    if north - south > MOST_ROWS or expected > MOST:
        return -1
    in_bins = starts.size > 0
    if in_bins:
        bottom, top = nearest_bin(south, grid), nearest_bin(north, grid)
    else:
        bottom, top = max(math.ceil(south), 1), min(math.floor(north), grid - 2)
    for line in range(bottom, top + 1):
        if in_bins:
            low, high = max(west, least - (line + 1)), min(east, most - line)
            base = (face * grid + line) * grid
            first = starts[base + nearest_bin(low, grid)]
            last = starts[base + nearest_bin(high, grid) + 1]
            step, hit = 1, first
        else:
            low, high = max(west, least - line, 1.0), min(east, most - line, grid - line - 1.0)
            base = row_start(face, line, grid)
            first, last = base + math.ceil(low), base + math.floor(high) + 1
            step, hit = 1 << 32, first << 32 | 1 << SIZE | face << ROW | line
        if low > high:
            continue
        if at + last - first > limit:
            return -1
        for _ in range(first, last):
            few.hits[at] = hit
            at, hit = at + 1, hit + step
    return at


@loop
def on_border(frequency, rows, k, face, few, at, limit):
    """Write the corners and points of edges that belong to a face; see `in_box`."""
    west, east, south, north, least, most = box_in(rows, k)
    for corner in range(3):
        number = CORNER_OF[face, corner]
        s, t = float(frequency * (corner == 1)), float(frequency * (corner == 2))
        if number >= 0 and south <= s <= north and west <= t <= east and least <= s + t <= most:
            if at == limit:
                return -1
            few.hits[at] = number << 32 | 1 << SIZE | NO_FACE << ROW
            at += 1
    for side in range(3):
        if side == 0:
            meets, low, high = west <= 0.0, max(south, least), min(north, most)
        elif side == 1:
            meets, low, high = south <= 0.0, max(west, least), min(east, most)
        else:
            meets = least <= frequency <= most
            low, high = max(west, frequency - north), min(east, frequency - south)
        if meets and EDGE_OF[face, side] >= 0:
            start = 12 + EDGE_OF[face, side] * (frequency - 1) - 1
            first = max(math.ceil(low), 1)
            last = min(math.floor(high), frequency - 1)
            if at + last - first >= limit:
                return -1
            for number in range(start + first, start + last + 1):
                few.hits[at] = number << 32 | 1 << SIZE | NO_FACE << ROW
                at += 1
    return at


@loop
def write_codes(rows, k, few, first, last):
    """Write the codes of candidates of patch k, and some beyond the last; see `classify`."""
    long_vectors()
    table = few.table
    patch, axis = patch_in(rows, k), vector_in(rows, AXIS, k)
    widest, bound = rows[SINE + k] * rows[SINE + k], rows[BOUND + k]
    least = ACCURATE * bound
    for start in range(first, last, LANES):
        for c in range(LANES):
            at = np.uint64(start + c)  # unsigned: no check for negative indices
            n = Vector(table[at], table[at + np.uint64(ROOM)], table[at + np.uint64(2 * ROOM)])
            table[at + CODE] = code_of(patch, axis, widest, 0.0, bound, least, n)


@loop
def copy_few(few, k, normals, places, numbers, codes):
    """Copy the candidates of patch k that may be hits; return their number."""
    count = 0
    for c in range(few.starts[k], few.starts[k + 1]):
        code = few.table[CODE + np.uint64(c)]
        if code != NO:
            places[count] = few.hits[c]
            numbers[count] = normals[few.hits[c], 3]
            codes[count] = code
            count += 1
    return count


@loop
def store_few_runs(few, k, patch, certain, undecided, counts):
    """Write patch and run of the candidates of patch k: those that are hits, and undecided ones."""
    following = np.int64(-1)  # the candidate that continues a run
    for c in range(few.starts[k], few.starts[k + 1]):
        hit, code = few.hits[c], few.table[CODE + np.uint64(c)]
        if code == YES:
            if hit == following:
                certain[counts[0] - 1, 1] += 1 << SIZE
            else:
                certain[counts[0], 0] = patch
                certain[counts[0], 1] = hit
                counts[0] += 1
            following = hit + (1 << 32) if hit >> ROW & FACE_BITS != NO_FACE else np.int64(-1)
        elif code == UNDECIDED:
            undecided[counts[1], 0] = patch
            undecided[counts[1], 1] = hit
            counts[1] += 1
