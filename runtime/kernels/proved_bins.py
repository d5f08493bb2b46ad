"""The lists of cells whose cones of normals meet the bins of a cube around the sphere."""

from __future__ import annotations

import math

import numpy as np

from ...generated.vectors import Vector
from ..machine_code.jit import inline, jit, loop
from .vectors import row_vector

__all__ = ["count_members", "list_members"]


@inline
def on_cube(face, s, t):
    """Return the unit vector of the place (s, t) of a face, as in `bins.cube_face`."""
    axis, sign = face >> 1, 1.0 if face & 1 == 0 else -1.0
    size = 1.0 / math.sqrt(1.0 + s * s + t * t)
    high, along, across = sign * size, s * size, t * size
    if axis == 0:
        return Vector(high, along, across)
    if axis == 1:
        return Vector(across, high, along)
    return Vector(along, across, high)


@inline
def apart(v, w):
    """Return the distance of two places."""
    return math.sqrt((v.x - w.x) ** 2 + (v.y - w.y) ** 2 + (v.z - w.z) ** 2)


@loop
def may_meet(cone, j, face, s, t, half):
    """Say whether the cone of cell j may meet the square around (s, t) of a face."""
    middle = on_cube(face, s, t)
    radius = 0.0
    for corner in range(4):
        i = half if corner & 1 else -half
        k = half if corner & 2 else -half
        radius = max(radius, apart(middle, on_cube(face, s + i, t + k)))
    return apart(row_vector(cone, j), middle) <= cone[j, 3] + radius * (1.0 + 1e-9) + 1e-12


@loop
def visit(cone, j, levels, stack, starts, members):
    """Add cell j to its bins: count them in `starts` if there is no room in `members`."""
    grid = 1 << levels
    for face in range(6):
        stack[0, 0], stack[0, 1], stack[0, 2] = 0, 0, 0
        top = 1
        while top > 0:
            top -= 1
            level, row, column = stack[top, 0], stack[top, 1], stack[top, 2]
            half = 1.0 / (1 << level)
            if not may_meet(
                cone, j, face, (2 * column + 1) * half - 1.0, (2 * row + 1) * half - 1.0, half
            ):
                continue
            if level == levels:
                square = (face * grid + row) * grid + column
                if members.size > 0:
                    members[starts[square]] = j
                starts[square] += 1
                continue
            for part in range(4):
                stack[top, 0] = level + 1
                stack[top, 1], stack[top, 2] = 2 * row + (part >> 1), 2 * column + (part & 1)
                top += 1


@jit
def count_members(cone, levels, stack, starts, members):
    """Write the number of cells of each bin, for a grid of 2^levels; `members` is empty."""
    for j in range(cone.shape[0]):
        visit(cone, j, levels, stack, starts, members)


@jit
def list_members(cone, levels, stack, starts, members):
    """Write the cells of the bins; counts in `starts` (bins + 1,) become the starts of bins."""
    total = np.int64(0)
    for square in range(starts.size):
        count = starts[square]
        starts[square] = total
        total += count
    for j in range(cone.shape[0]):
        visit(cone, j, levels, stack, starts, members)
    for square in range(starts.size - 1, 0, -1):
        starts[square] = starts[square - 1]
    starts[0] = 0
