"""The boxes of cones of normals on those faces of a polyhedron that they may reach."""

from __future__ import annotations

import math

from ..machine_code.jit import inline, loop
from .strips import AXIS, BOX, ERRORS, ONE_VECTOR, SINE, UNIT, put_box
from .tile import STEP, vector_in

__all__ = ["box_in", "box_on_face", "may_reach"]


@inline
def box_in(rows, k):
    """Return the sides of the box of patch k: west, east, south, north, least and largest sum."""
    return (
        rows[BOX + k],
        rows[BOX + STEP + k],
        rows[BOX + 2 * STEP + k],
        rows[BOX + 3 * STEP + k],
        rows[BOX + 4 * STEP + k],
        rows[BOX + 5 * STEP + k],
    )


@loop
def may_reach(polyhedron, face, rows, k):
    """Return whether a cone may reach a face, by its axis and sine."""
    h, r = polyhedron.frames[face, 2], vector_in(rows, AXIS, k)
    height = h[0] * r.x + h[1] * r.y + h[2] * r.z
    sine = rows[SINE + k]
    return sine == math.inf or height + polyhedron.slope * sine >= polyhedron.least


@loop
def box_on_face(polyhedron, face, rows, k):
    """Write the box of patch k on a face; return whether it meets the face.

    It is the whole face if some control normals do not point to the face.
    """
    frames, stretch, grid, limit, _, _, _ = polyhedron
    half = 0.5 * grid
    frame = frames[face]
    west = south = least = math.inf
    east = north = most = -math.inf
    error = 0.0
    clipped = False
    right = left = top = bottom = True  # beyond these sides
    for m in range(6):
        angle = rows[ERRORS + m * STEP + k] * stretch
        if angle == math.inf:
            continue
        n = vector_in(rows, UNIT + m * ONE_VECTOR, k)
        s = frame[0, 0] * n.x + frame[0, 1] * n.y + frame[0, 2] * n.z
        t = frame[1, 0] * n.x + frame[1, 1] * n.y + frame[1, 2] * n.z
        height = frame[2, 0] * n.x + frame[2, 1] * n.y + frame[2, 2] * n.z
        right = right and s - height > 2.0 * angle
        left = left and -s - height > 2.0 * angle
        top = top and t - height > 2.0 * angle
        bottom = bottom and -t - height > 2.0 * angle
        if height <= angle:
            clipped = True
            continue
        inverse = 1.0 / height
        error = max(error, angle * inverse * (1.0 + (abs(s) + abs(t)) * inverse) * half)
        s = (s * inverse + 1.0) * half
        t = (t * inverse + 1.0) * half
        west, east = min(west, s), max(east, s)
        south, north = min(south, t), max(north, t)
        least, most = min(least, s + t), max(most, s + t)
    if west == math.inf or right or left or top or bottom:
        return False
    west, east, south, north = west - error, east + error, south - error, north + error
    least, most = least - 2.0 * error, most + 2.0 * error
    if clipped:
        west = south = least = 0.0
        east = north = float(grid)
        most = limit
    put_box(rows, k, west, east, south, north, least, most)
    return east >= 0.0 and west <= grid and north >= 0.0 and south <= grid and least <= limit
