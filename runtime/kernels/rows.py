"""The points of an icosphere that a cone of normals may contain: spans in the rows of faces."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.icosahedron import (
    BARYCENTRIC,
    CORNER_PLACES,
    EDGE_PLACES,
    FRAMES,
    LENGTHS,
    STRETCHES,
)
from ..machine_code.jit import inline, loop
from .vectors import VECTOR
from .windows import bounding_box, face_window, map_cone, set_empty, spans_of_hull

__all__ = ["FaceMemory", "border_points", "count_points", "points_inside"]

# Bounding boxes of at most this many points are not restricted to the hull.
SMALL_BOX = 192
# The faces of an icosahedron, and the face of a cube to which they are mapped.
FACES, CUBE_FACE = 20, np.int64(4)
# Rows of points have no height, in contrast to rows of bins.
ROW_HEIGHT = np.int64(0)


class FaceMemory(NamedTuple):
    """Work arrays: the faces `met` (20) by a cone, and the first and last row on each.

    spans (20, 2, ν + 1) are the first and the last column of each row; the others are for one face.
    """

    met: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    spans: NDArray[np.int64]
    window: NDArray[np.int64]
    hull: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def new(cls, frequency: int) -> FaceMemory:
        """Return new work arrays."""
        return cls(
            np.empty(FACES + 1, np.int64),
            np.empty(FACES, np.int64),
            np.empty(FACES, np.int64),
            np.empty((FACES, 2, frequency + 1), np.int64),
            np.empty(4, np.int64),
            np.empty((12, 2)),
            np.empty(frequency + 1 + VECTOR),
            np.empty(frequency + 1 + VECTOR),
        )


@loop
def count_points(cone, sine, frequency, memory):
    """Write the rows of all faces that a cone may meet.

    Returns the numbers of faces and of points, and whether some are on the border of a face.
    """
    met, first, last, spans, _, _, _, _ = memory
    for face in range(FACES):
        first[face], last[face] = 0, -1
    count = faces_met(cone.axis, sine, met)
    total = 0
    at_border = False
    for k in range(count):
        face = met[k]
        total += write_spans(face, cone, sine, frequency, memory)
        at_border = at_border or on_border(spans[face], first[face], last[face], frequency)
    return count, total, at_border


@loop
def faces_met(axis, sine, met):
    """Write the faces that a cone of normals may meet, in ascending order; return their number.

    Most cones are narrow and lie within the face that is nearest to their axis.
    """
    slack = 1.01 * sine + 1e-9
    if sine < math.inf:
        nearest = 0
        highest = -math.inf
        for face in range(FACES):
            height = (
                FRAMES[face, 2, 0] * axis[0]
                + FRAMES[face, 2, 1] * axis[1]
                + FRAMES[face, 2, 2] * axis[2]
            )
            if height > highest:
                nearest, highest = face, height
        if reaches(nearest, axis, -slack):
            met[0] = nearest
            return 1
    count = 0
    for face in range(FACES):
        met[count] = face
        count += sine == math.inf or reaches(face, axis, slack)
    return count


@inline
def reaches(face, axis, slack):
    """Return whether a unit vector lies in a face, or outside by less than the slack (a sine)."""
    for k in range(3):
        towards = (
            BARYCENTRIC[face, k, 0] * axis[0]
            + BARYCENTRIC[face, k, 1] * axis[1]
            + BARYCENTRIC[face, k, 2] * axis[2]
        )
        if towards < -LENGTHS[face, k] * slack:
            return False
    return True


@loop
def write_spans(face, cone, sine, frequency, memory):
    """Write the rows of a face that a cone may meet, and spans; return the number of points."""
    _, first, last, spans, window, hull, low, high = memory
    map_cone(cone, FRAMES[face], STRETCHES[face])
    set_empty(window)
    error, size = face_window(
        cone.shown, cone.angles, sine < math.inf, CUBE_FACE, frequency, window, hull
    )
    if window[1] < window[0]:
        return 0
    here = spans[face]
    bottom, top, left, right = 0, frequency, 0, frequency
    if error < math.inf:
        west, east, south, north = bounding_box(hull, size, error)
        bottom, top = math.ceil(max(south, 0.0)), math.floor(min(north, frequency))
        left, right = math.ceil(max(west, 0.0)), math.floor(min(east, frequency))
    first[face], last[face] = bottom, top
    total = 0
    if error == math.inf or (top - bottom + 1) * (right - left + 1) <= SMALL_BOX:
        for row in range(bottom, top + 1):
            here[0, row] = left
            here[1, row] = min(right, frequency - row)
            total += max(0, here[1, row] - left + 1)
        return total
    spans_of_hull(hull, size, error, ROW_HEIGHT, bottom, top, low, high)
    for row in range(bottom, top + 1):
        least = max(low[row - bottom] - error, 0.0)
        most = min(high[row - bottom] + error, frequency - row)
        here[0, row], here[1, row] = 0, -1
        if least <= most:
            here[0, row], here[1, row] = math.ceil(least), math.floor(most)
        total += max(0, here[1, row] - here[0, row] + 1)
    return total


@inline
def on_border(spans, first, last, frequency):
    """Return whether rows of a face reach its border."""
    if first <= 0:
        return True
    for row in range(first, last + 1):
        if spans[0, row] <= 0 or spans[1, row] >= frequency - row:
            return True
    return False


@loop
def border_points(memory, frequency, numbers):
    """Write the numbers of corners, then of the points inside edges, that a cone may meet.

    Each is looked up on one of its faces; faces not met have no rows. Returns the number of points.
    """
    _, first, last, spans, _, _, _, _ = memory
    count = 0
    for k in range(12):
        face, t, s = CORNER_PLACES[k, 0], CORNER_PLACES[k, 1], CORNER_PLACES[k, 2]
        row = s * frequency
        if first[face] <= row <= last[face]:
            numbers[count] = k
            count += spans[face, 0, row] <= t * frequency <= spans[face, 1, row]
    for edge in range(30):
        face, side = EDGE_PLACES[edge, 0], EDGE_PLACES[edge, 1]
        if first[face] <= last[face]:
            start = 12 + edge * (frequency - 1) - 1
            low, high = first[face], last[face]
            if side == 1:
                low, high = (spans[face, 0, 0], spans[face, 1, 0]) if low <= 0 else (0, -1)
            elif side == 2:
                low, high = frequency - high, frequency - low
            for k in range(max(low, 1), min(high, frequency - 1) + 1):
                row = k if side == 0 else 0 if side == 1 else frequency - k
                column = 0 if side == 0 else k
                numbers[count] = start + k
                count += spans[face, 0, row] <= column <= spans[face, 1, row]
    return count


@loop
def points_inside(face, memory, frequency, s, t):
    """Write the rows and columns (s, t) of the points inside a face that a cone may meet.

    Rows are separated by NaN, with one before the first and after the last. Returns the length.
    """
    _, first, last, spans, _, _, _, _ = memory
    t[0] = math.nan
    count = 1
    for row in range(max(first[face], 1), min(last[face], frequency - 2) + 1):
        left = max(spans[face, 0, row], 1)
        size = min(spans[face, 1, row], frequency - row - 1) - left + 1
        for k in range(size):
            at = np.uint64(count + k)  # unsigned: no check for negative indices
            s[at] = row
            t[at] = left + k
        if size > 0:
            count += size + 1
            t[count - 1] = math.nan
    for k in range(VECTOR):
        t[count + k] = math.nan
    return count
