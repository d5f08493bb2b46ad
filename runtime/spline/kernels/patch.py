"""The patches of a spline: their positions on the grid, and their vectors.

The patches are numbered cell by cell: cell = i n + j, and in each cell south, east, north, west,
which are 0 to 3 quarter turns of the southern one.
"""

from __future__ import annotations

import math

import numpy as np

from ....generated.patch import (
    control_normals,
    curvature_at,
    envelope,
    forms,
    parabolic_cubic,
    tangents,
)
from ....generated.spline import NEIGHBOURS, triangle
from ....generated.vectors import Patch, Vector
from ...directions.kernels.vectors import dot, largest_component, length, set_row
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import inline, jit, loop

THIRD = 1.0 / 3.0
# The indices of neighbours in NEIGHBOURS. They are typed, since Numba would compile functions for
# each literal separately.
SOUTHWEST, SOUTH, SOUTHEAST, WEST, EAST, NORTH = (np.int64(k) for k in (0, 1, 2, 3, 5, 7))


@inline
def vector_at(mu, i, j):
    """Return an entry of an array (m, n, 3) of vectors."""
    return Vector(mu[i, j, 0], mu[i, j, 1], mu[i, j, 2])


@loop
def neighbour(mu, i, j, turn, k, centre, scale):
    """Return neighbour k of the coefficient (i, j), minus this coefficient, times `scale`."""
    p = i + NEIGHBOURS[turn, k, 0]
    q = j + NEIGHBOURS[turn, k, 1]
    return Vector(
        scale * (mu[p, q, 0] - centre.x),
        scale * (mu[p, q, 1] - centre.y),
        scale * (mu[p, q, 2] - centre.z),
    )


@loop
def patch_vectors(mu, i, j, turn, scale) -> Patch:
    """Return the vectors of a patch, times SCALE * scale; p₀ is relative to its coefficient.

    The coefficient (i, j) is that of the cell of the patch; `turn` is the number of quarter turns.
    """
    centre = vector_at(mu, i, j)
    return triangle(
        neighbour(mu, i, j, turn, SOUTHWEST, centre, scale),
        neighbour(mu, i, j, turn, SOUTH, centre, scale),
        neighbour(mu, i, j, turn, SOUTHEAST, centre, scale),
        neighbour(mu, i, j, turn, WEST, centre, scale),
        neighbour(mu, i, j, turn, EAST, centre, scale),
        neighbour(mu, i, j, turn, NORTH, centre, scale),
    )


@inline
def patch_of(mu, scale, number) -> Patch:
    """Return the vectors of a patch by its number; see `patch_vectors`."""
    i, j, turn = place_of(number, mu.shape[1] - 2)
    return patch_vectors(mu, i + 1, j + 1, turn, scale)


@loop
def point_of_patch(patch, u, v):
    """Return the point of a patch at (u, v)."""
    return envelope(patch, u, v)


@loop
def normal_of_patch(patch, u, v):
    """Return the unnormalized oriented normal of a patch at (u, v)."""
    _, _, N = tangents(patch, u, v)
    return N


@loop
def curvatures_of_patch(patch, N, u, v):
    """Return the unit normal, K and H of a patch at (u, v), where its unnormalized normal is N."""
    size = length(N)
    n = Vector(N.x / size, N.y / size, N.z / size)
    K, H = curvature_at(patch, n, u, v)
    return n, K, H


@jit
def normals_at(mu, scale, patches, places, normals):
    """Write the unnormalized oriented normals (k, 3) of patches (k,) at parameters (k, 2)."""
    for k in range(patches.size):
        patch = patch_of(mu, scale, patches[k])
        set_row(normals, k, normal_of_patch(patch, places[k, 0], places[k, 1]))


# --- developable patches, up to rounding ----------------------------------------------------------


@loop
def curvature_error(patch, longest, noise):
    """Return a bound of the error of the form D(N) that results from the rounding of coordinates.

    D(N) has the sign of K. `longest` is the length of the longest control normal, `noise` the
    rounding error of coordinates in the unit of the patch.
    """
    second = max(largest_component(patch.a), largest_component(patch.b), largest_component(patch.c))
    tangent = second + max(largest_component(patch.d), largest_component(patch.e))
    return 4.0 * noise * second * longest * (longest + tangent * second)


@loop
def may_be_developable(patch, longest, noise):
    """Return whether the Gaussian curvature at the centre of a patch is zero up to rounding."""
    D, _, _, _ = forms(patch, normal_of_patch(patch, THIRD, THIRD))
    return not abs(D) > curvature_error(patch, longest, noise)


@loop
def longest_control_normal(patch):
    """Return the length of the longest control normal of a patch."""
    longest = 0.0
    for normal in control_normals(patch):
        longest = max(longest, dot(normal, normal))
    return math.sqrt(longest)


@jit
def count_developable(mu, scale, noise, first, last):
    """Return the number of developable patches among [first, last)."""
    columns = mu.shape[1] - 2
    found = 0
    for number in range(first, last):
        i, j, turn = place_of(number, columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        longest = longest_control_normal(patch)
        if may_be_developable(patch, longest, noise):
            found += is_developable(patch, curvature_error(patch, longest, noise))
    return found


@loop
def is_developable(patch, error):
    """Return whether the parabolic cubic of a patch is zero up to an error."""
    largest = 0.0
    for value in parabolic_cubic(patch):
        largest = max(largest, abs(value))
    return largest <= error
