"""Bins of directions: the six faces of a cube, each cut into grid × grid squares.

The directions may first be mapped by a linear map (3, 3), the frame.
"""

from __future__ import annotations

from ....generated.vectors import Vector
from ...machine_code.jit import inline, loop

__all__ = ["bin_index", "cube_face", "mapped"]


@inline
def cube_face(n):
    """Return the face of the cube that a ray n meets, and its coordinates there (in −1 … 1).

    The faces are +x, −x, +y, −y, +z, −z.
    """
    x, y, z = abs(n.x), abs(n.y), abs(n.z)
    axis = 0 if x >= y and x >= z else 1 if y >= z else 2
    height = n[axis]
    size = abs(height)
    face = 2 * axis if height > 0.0 else 2 * axis + 1
    return face, n[(axis + 1) % 3] / size, n[(axis + 2) % 3] / size


@loop
def nearest_bin(position, grid):
    """Return the bin at a position along an edge of the grid, the first or last beyond its ends."""
    return min(max(int(position), 0), grid - 1)


@inline
def bin_index(s, grid):
    """Return the row or column of a face coordinate; monotone, also in rounding."""
    return nearest_bin((s + 1.0) * (0.5 * grid), grid)


@loop
def mapped(frame, n):
    """Return the image of a vector under a linear map (3, 3)."""
    return Vector(
        frame[0, 0] * n.x + frame[0, 1] * n.y + frame[0, 2] * n.z,
        frame[1, 0] * n.x + frame[1, 1] * n.y + frame[1, 2] * n.z,
        frame[2, 0] * n.x + frame[2, 1] * n.y + frame[2, 2] * n.z,
    )
