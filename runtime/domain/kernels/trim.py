"""Points inside closed polygons of the parameter plane, by the even-odd rule.

The plane is cut into cells, and each cell lists the segments that may touch it. The parity at the
corner of each cell is known; a point has the same parity, or the opposite one if the path to the
corner crosses an odd number of segments.

Every point is displaced infinitesimally along u, and much less along v (Simulation of Simplicity,
Edelsbrunner and Mücke 1990). So no point is on a segment, or level with a vertex, and exactly one
of two polygons with a common side contains a point of this side. Comparisons with the ends of a
segment are exact. A rounded product decides only for a point inside the bounding box of a segment,
always the same product, so that rounding matters only next to a segment.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.spline import CORNERS
from ...machine_code.jit import inline, jit, loop
from .patch_numbers import place_of


class SegmentGrid(NamedTuple):
    """Segments of polygons, sorted into the rows (along v) and columns (along u) of a grid.

    segments (n, 4): u, v of both ends, the end with the smaller v (then u) first.
    frame (6,): the corner u, v of the grid, its cells per length along u and v, and their sizes.
    starts (rows columns + 1,): segments of cell c are members[starts[c]:starts[c + 1]].
    parity (rows, columns): whether the corner u, v of the cell is inside.
    """

    segments: NDArray[np.float64]
    frame: NDArray[np.float64]
    starts: NDArray[np.int64]
    members: NDArray[np.int32]
    parity: NDArray[np.bool_]


@inline
def is_left(segment, u, v):
    """Return whether a point is left of the line through a segment, as seen from its first end.

    A segment along u runs towards larger u, so that left of it is above it; points on its line
    count as left.
    """
    rise = segment[3] - segment[1]
    product = (segment[2] - segment[0]) * (v - segment[1]) - rise * (u - segment[0])
    return product > 0.0 or (product == 0.0 and rise == 0.0)


@inline
def is_right_of(segment, u, v):
    """Return whether a segment is right of a point, that is, at larger u.

    The v of the point is in the range of v of the segment. The first end of the segment is its
    lower end, so that the point is then left of the segment.
    """
    if segment[0] > u and segment[2] > u:
        return True
    if segment[0] <= u and segment[2] <= u:
        return False
    return is_left(segment, u, v)


@inline
def is_below(segment, u, v):
    """Return whether a segment is below a point whose u is in the segment's range of u."""
    if segment[3] <= v:
        return True
    if segment[1] > v:
        return False
    return is_left(segment, u, v) == (segment[2] > segment[0])


@inline
def crosses(segment, u, v, corner_u, corner_v):
    """Return whether the path from a point to a corner crosses a segment an odd number of times.

    The path goes along u first, then along v.
    """
    odd = False
    if segment[1] <= v < segment[3]:
        odd = is_right_of(segment, u, v) != is_right_of(segment, corner_u, v)
    if (segment[0] <= corner_u) != (segment[2] <= corner_u):
        odd ^= is_below(segment, corner_u, v) != is_below(segment, corner_u, corner_v)
    return odd


@inline
def cell_along(x, low, rate, count):
    """Return the index of the row or column of cells that contains a coordinate."""
    return min(max(int((x - low) * rate), 0), count - 1)


@loop
def is_inside(cells, u, v):
    """Return whether a point is inside the polygons."""
    rows, columns = cells.parity.shape
    frame = cells.frame
    if not (
        frame[0] <= u <= frame[0] + columns * frame[4]
        and frame[1] <= v <= frame[1] + rows * frame[5]
    ):
        return False
    i = cell_along(u, frame[0], frame[2], columns)
    j = cell_along(v, frame[1], frame[3], rows)
    corner_u = frame[0] + i * frame[4]
    corner_v = frame[1] + j * frame[5]
    inside = cells.parity[j, i]
    cell = j * columns + i
    for k in range(cells.starts[cell], cells.starts[cell + 1]):
        inside ^= crosses(cells.segments[cells.members[k]], u, v, corner_u, corner_v)
    return inside


@jit
def find_inside(cells, shifts, places, first, last, inside):
    """Write whether points [first, last) of `places` (k, 2) are inside after one of the shifts.

    shifts (s, 4): rows a, b, c, d map (u, v) to (a u + b, c v + d).
    """
    for k in range(first, last):
        inside[k] = False
        for s in range(shifts.shape[0]):
            if not inside[k]:
                u = shifts[s, 0] * places[k, 0] + shifts[s, 1]
                v = shifts[s, 2] * places[k, 1] + shifts[s, 3]
                inside[k] = is_inside(cells, u, v)


@jit
def find_parities(cells):
    """Write the parities at the corners of the cells.

    A corner is inside if the ray from it towards larger u crosses an odd number of segments.
    """
    rows, columns = cells.parity.shape
    frame = cells.frame
    cells.parity[:] = False
    for k in range(cells.segments.shape[0]):
        segment = cells.segments[k]
        j = max(cell_along(segment[1], frame[1], frame[3], rows) - 1, 0)
        while j < rows and frame[1] + j * frame[5] < segment[3]:
            v = frame[1] + j * frame[5]
            if segment[1] <= v:
                # In row j, find the column i of the last corner that is left of the segment.
                share = (v - segment[1]) / (segment[3] - segment[1])
                near = segment[0] + share * (segment[2] - segment[0])
                i = cell_along(near, frame[0], frame[2], columns)
                while i + 1 < columns and is_right_of(segment, frame[0] + (i + 1) * frame[4], v):
                    i += 1
                while i >= 0 and not is_right_of(segment, frame[0] + i * frame[4], v):
                    i -= 1
                if i >= 0:
                    cells.parity[j, i] ^= True
            j += 1
    for j in range(rows):
        for i in range(columns - 2, -1, -1):
            cells.parity[j, i] ^= cells.parity[j, i + 1]


@jit
def list_segments(cells, margins, stores):
    """Count the segments of each cell in starts[cell + 1], or store them from starts[cell] on.

    Storing advances starts[cell] to the end of the list of the cell. A segment belongs to all cells
    that it may touch: margins (2,) exceed the rounding errors of coordinates.
    """
    rows, columns = cells.parity.shape
    frame = cells.frame
    for k in range(cells.segments.shape[0]):
        segment = cells.segments[k]
        j_first = cell_along(segment[1] - margins[1], frame[1], frame[3], rows)
        j_last = cell_along(segment[3] + margins[1], frame[1], frame[3], rows)
        rise = segment[3] - segment[1]
        for j in range(j_first, j_last + 1):
            begin, end = 0.0, 1.0
            if rise > 0.0:
                low = frame[1] + j * frame[5] - margins[1] - segment[1]
                begin = min(max(low / rise, 0.0), 1.0)
                end = min(max((low + frame[5] + 2.0 * margins[1]) / rise, 0.0), 1.0)
            u = segment[0] + begin * (segment[2] - segment[0])
            w = segment[0] + end * (segment[2] - segment[0])
            i_first = cell_along(min(u, w) - margins[0], frame[0], frame[2], columns)
            i_last = cell_along(max(u, w) + margins[0], frame[0], frame[2], columns)
            for i in range(i_first, i_last + 1):
                cell = j * columns + i
                if stores:
                    cells.members[cells.starts[cell]] = k
                    cells.starts[cell] += 1
                else:
                    cells.starts[cell + 1] += 1


@jit
def to_cells(patches, places, columns, first, last, cells):
    """Convert parameters `places` (k, 2) in `patches` (k,) to parameters in units of cells."""
    for k in range(first, last):
        i, j, turn = place_of(patches[k], columns)
        u = places[k, 0]
        v = places[k, 1]
        for x in range(2):
            corner = i if x == 0 else j
            cells[k, x] = corner + 0.5 + u * CORNERS[turn, 0, x] + v * CORNERS[turn, 1, x]
