"""The cone of normals of a patch: the convex hull of its control normals contains all normals."""

from __future__ import annotations

from ....generated.patch import control_normals
from ....generated.vectors import Vector
from ...directions.kernels.vectors import dot, length, row_vector, set_row
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import jit, loop
from ...spline.kernels.patch import patch_vectors

__all__ = ["least_cosine", "tangent_bounds", "write_control_normals"]


@loop
def write_control_normals(patch, net):
    """Write the control normals (6, 3) of a patch."""
    normals = control_normals(patch)
    for k in range(6):
        set_row(net, k, normals[k])


@loop
def tangent_bounds(patch):
    """Return bounds of the moduli of the components of the tangent vectors of a patch."""
    a, b, c, d, e, _ = patch
    return Vector(
        max(abs(a.x), abs(b.x), abs(c.x)) + max(abs(d.x), abs(e.x)),
        max(abs(a.y), abs(b.y), abs(c.y)) + max(abs(d.y), abs(e.y)),
        max(abs(a.z), abs(b.z), abs(c.z)) + max(abs(d.z), abs(e.z)),
    )


@jit
def least_cosine(mu, scale, axis, net):
    """Return the least cosine between a unit vector (3) and an oriented normal of the spline.

    It is a lower bound, from the control normals. The search ends at the first negative cosine.
    `net` (6, 3) is a work array.
    """
    columns = mu.shape[1] - 2
    towards = Vector(axis[0], axis[1], axis[2])
    least = 1.0
    for number in range(4 * (mu.shape[0] - 2) * columns):
        i, j, turn = place_of(number, columns)
        write_control_normals(patch_vectors(mu, i + 1, j + 1, turn, scale), net)
        for k in range(6):
            normal = row_vector(net, k)
            size = length(normal)
            if size > 0.0:
                least = min(least, dot(normal, towards) / size)
        if least < 0.0:
            break
    return least
