"""Patches with few candidate normals: those of a strip are classified in one vectorized loop.

The candidates are the normals in the box of a patch that lies inside a face: in bins of the cube,
or points of an icosphere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.vectors import Vector
from ..tolerances import ACCURATE
from .classify import NO, UNDECIDED, YES, code_of
from .icosphere import row_start
from .jit import long_vectors, loop
from .runs import ROW, SIZE
from .strips import AXIS, BOUND, BOX, SINE, patch_in
from .tile import STEP, TILE, vector_in
from .vectors import VECTOR

__all__ = ["NO_STARTS", "Few", "classify_few", "copy_few", "store_few_runs"]

# A patch has few candidates if there are not more than this, in not more rows.
MOST, MOST_ROWS = 64, 12
# So many candidates are classified at a time.
LANES = 8
# The number of columns of the table, and the starts of the rows with the vectors and the codes.
ROOM = TILE * MOST + VECTOR
CODE = np.uint64(3 * ROOM)
# The `starts` of bins of an icosphere, which has none.
NO_STARTS = np.empty(0, np.int64)


class Few(NamedTuple):
    """Work arrays: which patches of a strip have `many` candidates, and where the others `start`.

    Each candidate has the row of points or bins on the face, the place in the array of normals, and
    a column of the table: its components and a code.
    """

    many: NDArray[np.bool_]
    starts: NDArray[np.int64]
    lines: NDArray[np.int64]
    places: NDArray[np.int64]
    table: NDArray[np.float64]

    @classmethod
    def new(cls) -> Few:
        """Return new work arrays."""
        return cls(
            np.zeros(TILE, np.bool_),
            np.zeros(TILE + 1, np.int64),
            np.zeros(ROOM, np.int64),
            np.zeros(ROOM, np.int64),
            np.ones(4 * ROOM),
        )


@loop
def classify_few(polyhedron, starts, normals, strip, count, few):
    """Write and classify the candidates of the first patches of a strip.

    `normals` (S, …) are in the order of bins with these `starts`, or those of an icosphere.
    """
    at = 0
    for k in range(count):
        few.starts[k] = at
        end = write_candidates(polyhedron, starts, strip, k, few, at)
        few.many[k] = end < 0
        at = max(at, end)
    few.starts[count] = at
    for c in range(at):
        place = few.places[c]
        for x in range(3):
            few.table[x * ROOM + c] = normals[place, x]
    for k in range(count):
        if few.starts[k] < few.starts[k + 1]:
            write_codes(strip.rows, k, few, few.starts[k], few.starts[k + 1])


@loop
def write_candidates(polyhedron, starts, strip, k, few, at):
    """Write the candidates of patch k from `at` on; return their end, or −1 if they are many."""
    rows, face, grid = strip.rows, strip.faces[k], polyhedron.grid
    if face < 0:
        return -1
    west, east, south = rows[BOX + k], rows[BOX + STEP + k], rows[BOX + 2 * STEP + k]
    north, least = rows[BOX + 3 * STEP + k], rows[BOX + 4 * STEP + k]
    most = rows[BOX + 5 * STEP + k]
    if north - south > MOST_ROWS:
        return -1
    in_bins = starts.size > 0
    end = at
    for line in range(int(south) if in_bins else math.ceil(south), int(north) + 1):
        if in_bins:
            low, high = max(west, least - (line + 1)), min(east, most - line)
            base = (face * grid + line) * grid
            first, last = starts[base + int(low)], starts[base + int(max(low, high)) + 1]
        else:
            low, high = max(west, least - line), min(east, most - line)
            base = row_start(face, line, grid)
            first, last = base + math.ceil(low), base + math.floor(high) + 1
        if low > high:
            continue
        if end - at + last - first > MOST:
            return -1
        for place in range(first, last):
            few.lines[end], few.places[end] = line, place
            end += 1
    return end


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
            places[count] = few.places[c]
            numbers[count] = normals[few.places[c], 3]
            codes[count] = code
            count += 1
    return count


@loop
def store_few_runs(few, k, face, patch, certain, undecided, counts):
    """Write patch and run of the candidates of patch k: those that are hits, and undecided ones."""
    last = np.int64(-1)  # the run that the next candidate may continue
    for c in range(few.starts[k], few.starts[k + 1]):
        code = few.table[CODE + np.uint64(c)]
        run = few.places[c] << 32 | 1 << SIZE | face << ROW | few.lines[c]
        if code == YES:
            if last == few.places[c] - 1 and few.lines[c] == few.lines[c - 1]:
                certain[counts[0] - 1, 1] += 1 << SIZE
            else:
                certain[counts[0], 0] = patch
                certain[counts[0], 1] = run
                counts[0] += 1
            last = few.places[c]
        elif code == UNDECIDED:
            undecided[counts[1], 0] = patch
            undecided[counts[1], 1] = run
            counts[1] += 1
