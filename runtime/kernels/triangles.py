"""Triangles in the parameter domains of patches: their cuts, centroids and bounds.

A triangle is the number of its patch and the parameters (u, v) of its corners, (3, 2).
"""

from __future__ import annotations

import math

from ...generated.patch import part_normals, sides
from ...generated.spline import SCALE
from ..base.tolerances import VANISHING
from .jit import inline, jit, loop
from .patch import patch_of, place_of, point_of_patch
from .sizing import density_and_normal, enclosing_radius
from .vectors import largest_component, length

__all__ = ["bisect", "cut_patches", "evaluate_centroids", "normal_chords", "radii"]

# Squared distances of unit vectors: at 90 degrees, and of opposite ones.
RIGHT_ANGLE, OPPOSITE = 2.0, 4.0


@jit
def cut_patches(parts, ends, first, last, patches, corners):
    """Cut the patches first, …, last − 1 into parts² similar triangles each.

    The parts of a patch end before row ends[patch] of the output `patches` (M,) and `corners`
    (M, 3, 2).
    """
    for patch in range(first, last):
        step = 1.0 / parts[patch]
        k = ends[patch] - parts[patch] * parts[patch]
        for i in range(parts[patch]):
            for j in range(2 * (parts[patch] - i) - 1):
                turned = j % 2
                patches[k] = patch
                for corner in range(3):
                    corners[k, corner, 0] = (i + (turned ^ (corner == 1))) * step
                    corners[k, corner, 1] = (j // 2 + (turned ^ (corner == 2))) * step
                k += 1


@loop
def end_of_patch(patches, first, last):
    """Return the end of the triangles of one patch that begin with number `first`."""
    end = first
    while end < last and patches[end] == patches[first]:
        end += 1
    return end


@jit
def evaluate_centroids(mu, scale, patches, corners, first, last, target, patch_radii, rows):
    """Write point, unit normal, target density and K (M, 8) at the centroids of triangles.

    Those of the triangles first, …, last − 1 are written, for the scaled surface relative to its
    first coefficient; patch_radii (patches,) are those of whole patches. At a singular point the
    normal and K are 0.
    """
    size = SCALE * scale
    columns = mu.shape[1] - 2
    end = first
    while end < last:
        begin, end = end, end_of_patch(patches, end, last)
        number = patches[begin]
        patch = patch_of(mu, scale, number)
        i, j, _ = place_of(number, columns)
        centre_x = (mu[i + 1, j + 1, 0] - mu[0, 0, 0]) * size
        centre_y = (mu[i + 1, j + 1, 1] - mu[0, 0, 1]) * size
        centre_z = (mu[i + 1, j + 1, 2] - mu[0, 0, 2]) * size
        for k in range(begin, end):
            u = (corners[k, 0, 0] + corners[k, 1, 0] + corners[k, 2, 0]) / 3.0
            v = (corners[k, 0, 1] + corners[k, 1, 1] + corners[k, 2, 1]) / 3.0
            x = point_of_patch(patch, u, v)
            rows[k, 0] = x.x + centre_x
            rows[k, 1] = x.y + centre_y
            rows[k, 2] = x.z + centre_z
            _, normal, K, density = density_and_normal(patch, u, v, patch_radii[number], target)
            rows[k, 3], rows[k, 4], rows[k, 5] = normal
            rows[k, 6] = density
            rows[k, 7] = K


@inline
def corner_parameters(corners, k):
    """Return u0, v0, u1, v1, u2, v2 of the corners of triangle k."""
    return (
        corners[k, 0, 0],
        corners[k, 0, 1],
        corners[k, 1, 0],
        corners[k, 1, 1],
        corners[k, 2, 0],
        corners[k, 2, 1],
    )


@jit
def radii(mu, scale, patches, corners, first, last, found):
    """Write the radii (M,) of balls around the centroids that contain the triangles."""
    end = first
    while end < last:
        begin, end = end, end_of_patch(patches, end, last)
        patch = patch_of(mu, scale, patches[begin])
        for k in range(begin, end):
            u0, v0, u1, v1, u2, v2 = corner_parameters(corners, k)
            found[k] = enclosing_radius(patch, u0, v0, u1, v1, u2, v2)


@jit
def bisect(mu, scale, patches, corners, first, last, halves):
    """Cut triangles at the midpoints of their longest sides; write the halves (2 M, 3, 2)."""
    end = first
    while end < last:
        begin, end = end, end_of_patch(patches, end, last)
        patch = patch_of(mu, scale, patches[begin])
        for k in range(begin, end):
            u0, v0, u1, v1, u2, v2 = corner_parameters(corners, k)
            lengths = sides(patch, u0, v0, u1, v1, u2, v2)
            # Bounds of the squared lengths of the sides opposite to the corners 0, 1 and 2.
            side_0 = max(lengths[0], lengths[1])
            side_1 = max(lengths[2], lengths[3])
            side_2 = max(lengths[4], lengths[5])
            apex = 0 if side_0 >= max(side_1, side_2) else 1 if side_1 >= side_2 else 2
            left = (apex + 1) % 3
            right = (apex + 2) % 3
            for x in range(2):
                middle = 0.5 * (corners[k, left, x] + corners[k, right, x])
                for half in range(2):
                    halves[2 * k + half, 0, x] = corners[k, apex, x]
                halves[2 * k, 1, x] = corners[k, left, x]
                halves[2 * k, 2, x] = middle
                halves[2 * k + 1, 1, x] = middle
                halves[2 * k + 1, 2, x] = corners[k, right, x]


@jit
def normal_chords(mu, scale, patches, corners, first, last, rows, chords):
    """Write bounds of the distances of the unit normals of triangles from those at the centroids.

    The normals lie in the cone of the control normals of the triangle. The bound is 2, that is
    unknown, unless the cone is narrower than 90 degrees and the centroid has a normal.
    `rows` (M, 8) are those of `evaluate_centroids`.
    """
    end = first
    while end < last:
        begin, end = end, end_of_patch(patches, end, last)
        patch = patch_of(mu, scale, patches[begin])
        tangent = max(
            largest_component(patch.a), largest_component(patch.b), largest_component(patch.c)
        ) + max(largest_component(patch.d), largest_component(patch.e))
        for k in range(begin, end):
            u0, v0, u1, v1, u2, v2 = corner_parameters(corners, k)
            net = part_normals(patch, u0, v0, u1, v1, u2, v2)
            singular = rows[k, 3] == 0.0 and rows[k, 4] == 0.0 and rows[k, 5] == 0.0
            farthest = 0.0
            for i in range(6):
                N = net[i]
                size = length(N)
                if size > VANISHING * tangent * tangent:
                    x = N.x / size - rows[k, 3]
                    y = N.y / size - rows[k, 4]
                    z = N.z / size - rows[k, 5]
                    square = x * x + y * y + z * z
                    known = square < RIGHT_ANGLE and not singular
                    farthest = max(farthest, square if known else OPPOSITE)
            chords[k] = math.sqrt(farthest)
