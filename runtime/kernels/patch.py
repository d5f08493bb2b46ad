"""The patches of a spline: where they are on the grid, and their vectors.

The patches are numbered cell by cell: cell = i n + j, and in each cell south, east, north, west,
which are 0 to 3 quarter turns of the southern one.
"""

from __future__ import annotations

from ...generated.patch import tangents
from ...generated.spline import NEIGHBOURS, triangle
from ...generated.vectors import Patch, Vector
from .jit import inline, jit, loop
from .vectors import set_row

__all__ = ["normals_at", "patch_of", "patch_vectors", "place_of", "vector_at"]


@inline
def place_of(patch, columns):
    """Return row and column of the cell of a patch, and its quarter turns."""
    cell = patch // 4
    return cell // columns, cell % columns, patch % 4


@inline
def vector_at(mu, i, j):
    """Return an entry of an array (m, n, 3) of vectors."""
    return Vector(mu[i, j, 0], mu[i, j, 1], mu[i, j, 2])


@inline
def neighbour(mu, i, j, turn, k, centre, scale):
    """Return the difference of neighbour k of a coefficient from it, times `scale`."""
    p = i + NEIGHBOURS[turn, k, 0]
    q = j + NEIGHBOURS[turn, k, 1]
    return Vector(
        scale * (mu[p, q, 0] - centre.x),
        scale * (mu[p, q, 1] - centre.y),
        scale * (mu[p, q, 2] - centre.z),
    )


@loop
def patch_vectors(mu, i, j, turn, scale) -> Patch:
    """Return the vectors of the patch of the coefficient (i, j), times SCALE * scale.

    p is relative to the coefficient.
    """
    centre = vector_at(mu, i, j)
    return triangle(
        neighbour(mu, i, j, turn, 0, centre, scale),
        neighbour(mu, i, j, turn, 1, centre, scale),
        neighbour(mu, i, j, turn, 2, centre, scale),
        neighbour(mu, i, j, turn, 3, centre, scale),
        neighbour(mu, i, j, turn, 5, centre, scale),
        neighbour(mu, i, j, turn, 7, centre, scale),
    )


@inline
def patch_of(mu, scale, number) -> Patch:
    """Return the vectors of a patch by its number; see `patch_vectors`."""
    i, j, turn = place_of(number, mu.shape[1] - 2)
    return patch_vectors(mu, i + 1, j + 1, turn, scale)


@jit
def normals_at(mu, scale, patches, places, normals):
    """Write the unnormalized oriented normals (k, 3) of patches (k) at places u, v (k, 2)."""
    for k in range(patches.size):
        _, _, N = tangents(patch_of(mu, scale, patches[k]), places[k, 0], places[k, 1])
        set_row(normals, k, N)
