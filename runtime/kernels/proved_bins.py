"""The lists of cells whose cones of normals meet the bins of a cube around the sphere."""

from __future__ import annotations

import math

import numpy as np

from ...generated.vectors import Vector
from ..machine_code.jit import inline, jit, loop
from .vectors import row_vector, set_row

__all__ = ["count_members", "list_members", "write_squares"]


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


@inline
def squares_before(level):
    """Return the number of squares of coarser levels than one."""
    return 2 * ((1 << (2 * level)) - 1)


@jit
def write_squares(levels, squares):
    """Write circles around the squares of all levels up to one: centres, and radii as chords.

    Level k has 6 faces of 4^k squares, by rows, after those of coarser levels.
    """
    at = 0
    for level in range(levels + 1):
        grid = 1 << level
        half = 1.0 / grid
        for face in range(6):
            for row in range(grid):
                for column in range(grid):
                    s, t = (2 * column + 1) * half - 1.0, (2 * row + 1) * half - 1.0
                    middle = on_cube(face, s, t)
                    radius = 0.0
                    for corner in range(4):
                        i = half if corner & 1 else -half
                        k = half if corner & 2 else -half
                        radius = max(radius, apart(middle, on_cube(face, s + i, t + k)))
                    set_row(squares, at, middle)
                    squares[at, 3] = radius * (1.0 + 1e-9) + 1e-12
                    at += 1


@loop
def visit(cone, j, squares, levels, stack, starts, members):
    """Add cell j to its bins: count them in `starts` if there is no room in `members`."""
    grid = 1 << levels
    axis, chord = row_vector(cone, j), cone[j, 3]
    for face in range(6):
        stack[0, 0], stack[0, 1], stack[0, 2] = 0, 0, 0
        top = 1
        while top > 0:
            top -= 1
            level, row, column = stack[top, 0], stack[top, 1], stack[top, 2]
            at = squares_before(level) + (((face << level) + row) << level) + column
            x, y, z = squares[at, 0] - axis.x, squares[at, 1] - axis.y, squares[at, 2] - axis.z
            reach = chord + squares[at, 3]
            if x * x + y * y + z * z > reach * reach:
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
def count_members(cone, squares, levels, stack, starts, members):
    """Write the number of cells of each bin, for a grid of 2^levels; `members` is empty.

    Squares are those of `write_squares`.
    """
    for j in range(cone.shape[0]):
        visit(cone, j, squares, levels, stack, starts, members)


@jit
def list_members(cone, squares, levels, stack, starts, members):
    """Write the cells of the bins; counts in `starts` (bins + 1,) become the starts of bins."""
    total = np.int64(0)
    for square in range(starts.size):
        count = starts[square]
        starts[square] = total
        total += count
    for j in range(cone.shape[0]):
        visit(cone, j, squares, levels, stack, starts, members)
    for square in range(starts.size - 1, 0, -1):
        starts[square] = starts[square - 1]
    starts[0] = 0
