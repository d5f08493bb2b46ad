"""Bins of directions: the six faces of a cube, each cut into grid × grid squares.

The directions may first be mapped by a linear map (3, 3), the frame.
"""

from __future__ import annotations

from ...generated.vectors import Vector
from ..machine_code.jit import inline, jit, loop
from .vectors import row_vector

__all__ = [
    "bin_index",
    "count_bins",
    "cube_face",
    "mapped",
    "place_normals",
    "start_bins",
]


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


@jit
def count_bins(normals, frame, grid, first, last, bins, counts):
    """Write the bins (S,) of the normals first, …, last − 1, and their number in each bin.

    The bins are those of `frame` for the normals (S, 3).
    """
    for b in range(counts.size):
        counts[b] = 0
    for k in range(first, last):
        face, s, t = cube_face(mapped(frame, row_vector(normals, k)))
        bins[k] = (face * grid + bin_index(t, grid)) * grid + bin_index(s, grid)
        counts[bins[k]] += 1


@jit
def start_bins(counts, starts):
    """Write the start of each bin; counts (ranges, bins) become the starts of ranges in bins."""
    start = 0
    for b in range(counts.shape[1]):
        starts[b] = start
        for part in range(counts.shape[0]):
            count = counts[part, b]
            counts[part, b] = start
            start += count
    starts[counts.shape[1]] = start


@jit
def place_normals(normals, bins, first, last, places, ordered):
    """Sort the normals first, …, last − 1 by bins: a counting sort, stable in each bin.

    ordered[starts[b]:starts[b + 1]] become the normals of bin b. `places` (bins,) are the starts of
    this range in the bins. A row of ordered (S, 4) is a normal, unchanged, and its number.
    """
    for k in range(first, last):
        at = places[bins[k]]
        places[bins[k]] += 1
        for axis in range(3):
            ordered[at, axis] = normals[k, axis]
        ordered[at, 3] = k
