"""Bounds of a cone of normals on a plane grid: a window of rows and columns, a span in each row.

Central projection preserves convex hulls: the hull of the projected control normals of a patch
bounds the projection of all its normals. The planes are the faces of a cube (see `bins`) or, mapped
to its face +z, those of an icosahedron.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.vectors import Vector
from ..machine_code.jit import inline, loop
from .bins import mapped, nearest_bin, on_face
from .strips import AXIS, ERRORS, ONE_VECTOR, SINE, UNIT
from .tile import STEP, vector_in
from .vectors import length, row_vector, set_row, whole_vectors

__all__ = [
    "Cone",
    "bounding_box",
    "face_window",
    "load_cone",
    "map_cone",
    "set_empty",
    "spans_of_hull",
]

# The error of the hull of a clipped cone, relative to the largest error of a control normal.
CUT_ERROR = 1024.0
# The least height of points of a clipped cone above the centre of the sphere.
LEAST_HEIGHT = 0.01


class Cone(NamedTuple):
    """Work arrays for the cone of normals of a patch.

    `unit` (6, 3) are the directions of control normals, `errors` (6,) their errors, which are
    angles, and `axis` (3,) is the axis; `shown` (6, 3) and `angles` (6,) are directions and errors
    mapped by a frame.
    """

    unit: NDArray[np.float64]
    errors: NDArray[np.float64]
    axis: NDArray[np.float64]
    shown: NDArray[np.float64]
    angles: NDArray[np.float64]

    @classmethod
    def new(cls) -> Cone:
        """Return new work arrays."""
        return cls(*map(np.empty, ((6, 3), 6, 3, (6, 3), 6)))


@loop
def load_cone(rows, k, cone):
    """Write the cone of patch k of a strip; return its sine, which is infinite if it is wide."""
    unit, errors, axis, _, _ = cone
    for m in range(6):
        set_row(unit, m, vector_in(rows, UNIT + m * ONE_VECTOR, k))
        errors[m] = rows[ERRORS + m * STEP + k]
    r = vector_in(rows, AXIS, k)
    axis[0], axis[1], axis[2] = r.x, r.y, r.z
    return rows[SINE + k]


@loop
def map_cone(cone, frame, stretch):
    """Write the directions and errors mapped by a frame (3, 3) of norm `stretch`."""
    unit, errors, _, shown, angles = cone
    for k in range(6):
        set_row(shown, k, mapped(frame, row_vector(unit, k)))
        angles[k] = errors[k] * stretch


@inline
def set_empty(window):
    """Make a window empty."""
    window[0], window[1], window[2], window[3] = 0, -1, 0, -1


@loop
def face_window(shown, angles, narrow, face, grid, window, hull):
    """Write first and last column, first and last row of the squares that a cone may meet.

    The hull (12, 2) of the projected control normals is written too, in squares; its error and the
    number of its points are returned. If some control normals do not point to the face, the cone is
    clipped by a plane outside the face. If the cone is not narrow, the window is the whole face and
    the error infinite. The window must be empty on entry, and stays so if the cone lies beyond a
    border of the face.
    """
    half = 0.5 * grid
    error = largest = 0.0
    towards = away = 0
    away_s = away_t = 0.0
    beyond_right = beyond_left = beyond_top = beyond_bottom = True
    for k in range(6):
        if angles[k] == math.inf:
            continue
        s, t, height = on_face(face, shown, k)
        largest = max(largest, angles[k])
        if height <= angles[k]:
            away += 1
            away_s += s
            away_t += t
        else:
            inverse = 1.0 / height
            far = 1.0 + (abs(s) + abs(t)) * inverse
            error = max(error, angles[k] * inverse * far * half)
            hull[towards, 0] = (s * inverse + 1.0) * half
            hull[towards, 1] = (t * inverse + 1.0) * half
            towards += 1
        beyond_right = beyond_right and s - height > 2.0 * angles[k]
        beyond_left = beyond_left and -s - height > 2.0 * angles[k]
        beyond_top = beyond_top and t - height > 2.0 * angles[k]
        beyond_bottom = beyond_bottom and -t - height > 2.0 * angles[k]
    if towards == 0 or beyond_right or beyond_left or beyond_top or beyond_bottom:
        return math.inf, 0
    if away > 0:
        towards = cut_hull(shown, face, grid, away_s, away_t, hull) if narrow else 0
        error = CUT_ERROR * largest * half
        if towards == 0:
            window[1] = window[3] = grid - 1
            return math.inf, 0
    left, right, below, above = bounding_box(hull, towards, error)
    if left <= grid and right >= 0.0 and below <= grid and above >= 0.0:
        window[0], window[1] = nearest_bin(left, grid), nearest_bin(right, grid)
        window[2], window[3] = nearest_bin(below, grid), nearest_bin(above, grid)
    return error, towards


@inline
def bounding_box(points, size, error):
    """Return the least and greatest s, the least and greatest t of points, with their error."""
    left, right, below, above = points[0, 0], points[0, 0], points[0, 1], points[0, 1]
    for k in range(1, size):
        left, right = min(left, points[k, 0]), max(right, points[k, 0])
        below, above = min(below, points[k, 1]), max(above, points[k, 1])
    return left - error, right + error, below - error, above + error


@loop
def cut_hull(shown, face, grid, away_s, away_t, hull):
    """Write the hull of a cone, clipped by a plane between the face and normals that point away.

    The plane is 3 height = (s, t)·d, where d is the unit direction of the normals that point away:
    on the face, where |s|, |t| <= height, the left side is larger. Returns the number of points, at
    most 12; 0 if the cone is too wide for such a plane.
    """
    half = 0.5 * grid
    size = max(length(Vector(away_s, away_t, 0.0)), 0.01)
    count = 0
    for k in range(6):
        s, t, height = on_face(face, shown, k)
        before = 3.0 * height - (s * away_s + t * away_t) / size
        if before >= 0.0:
            if height < LEAST_HEIGHT:
                return 0
            hull[count, 0] = (s / height + 1.0) * half
            hull[count, 1] = (t / height + 1.0) * half
            count += 1
            continue
        for i in range(6):
            s_i, t_i, height_i = on_face(face, shown, i)
            before_i = 3.0 * height_i - (s_i * away_s + t_i * away_t) / size
            if before_i >= 0.0:
                share = before_i / (before_i - before)
                middle = height_i + share * (height - height_i)
                if middle < LEAST_HEIGHT:
                    return 0
                hull[count, 0] = ((s_i + share * (s - s_i)) / middle + 1.0) * half
                hull[count, 1] = ((t_i + share * (t - t_i)) / middle + 1.0) * half
                count += 1
    return count


@loop
def spans_of_hull(hull, size, error, height, first, last, low, high):
    """Write the spans of the hull of points in the rows first, …, last: from low (…) to high (…).

    A row extends from its number by `height`. `error` is that of the points; rows that the hull
    does not meet get an empty span. The arrays need room for VECTOR − 1 more rows.
    """
    for row in range(last - first + 1):
        low[row] = math.inf
        high[row] = -math.inf
    for i in range(size):
        for j in range(max(i, 1)):
            below, above = (i, j) if hull[i, 1] <= hull[j, 1] else (j, i)
            s, t, s_end, t_end = hull[below, 0], hull[below, 1], hull[above, 0], hull[above, 1]
            left, right = min(s, s_end), max(s, s_end)
            slope = (s_end - s) / (t_end - t) if t_end > t else 0.0
            start = max(first, math.ceil(t - error) - height)
            count = min(last, math.floor(t_end + error)) - start + 1
            for k in range(whole_vectors(count)):
                at = np.uint64(start - first + k)  # unsigned: no check for negative indices
                row = float(start + k)
                p = s + (min(max(row - error, t), t_end) - t) * slope
                q = s + (min(max(row + height + error, t), t_end) - t) * slope
                if t_end == t:
                    p, q = left, right
                least = max(left, min(p, q)) if k < count else math.inf
                most = min(right, max(p, q)) if k < count else -math.inf
                low[at] = min(low[at], least)
                high[at] = max(high[at], most)
