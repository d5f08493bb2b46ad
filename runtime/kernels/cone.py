"""The cone of normals of a patch: the convex hull of its control normals contains all normals."""

from __future__ import annotations

import math

from ...generated.patch import control_normals
from ...generated.vectors import Vector
from ..tolerances import ANGLE_ERROR, SHORT_CONTROL_NORMAL
from .jit import jit, loop
from .patch import patch_vectors, place_of
from .vectors import dot, length, row_vector, set_row

__all__ = ["cone_of_normals", "least_cosine", "tangent_bounds", "write_control_normals"]

# The cosine of 37 degrees: control normals within this angle of the axis form a narrow cone.
NARROW = 0.8


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


@loop
def cone_of_normals(net, tangents, unit, errors, axis):
    """Write the directions (6, 3) of control normals, their errors (6) and the axis (3) of a cone.

    The errors are angles. `tangents` bounds the components of the tangents. Returns the sine of the
    angle between the axis and any normal; it is infinite if the cone is not narrow, or if the patch
    has a singular point, whose direction is undefined and whose error is infinite.
    """
    square = tangents * tangents
    worst = 0.0
    for x in range(3):
        axis[x] = 0.0
    for k in range(6):
        size = length(row_vector(net, k))
        inverse = 1.0 / size
        regular = size > SHORT_CONTROL_NORMAL * square
        errors[k] = ANGLE_ERROR * (1.0 + square * inverse) if regular else math.inf
        worst = max(worst, errors[k])
        for x in range(3):
            unit[k, x] = net[k, x] * inverse if regular else 0.0
            axis[x] += unit[k, x]
    inverse = 1.0 / length(Vector(axis[0], axis[1], axis[2]))
    for x in range(3):
        axis[x] *= inverse
    widest = 0.0
    cosine = 1.0
    for k in range(6):
        cosine = min(cosine, unit[k, 0] * axis[0] + unit[k, 1] * axis[1] + unit[k, 2] * axis[2])
        s = unit[k, 1] * axis[2] - unit[k, 2] * axis[1]
        t = unit[k, 2] * axis[0] - unit[k, 0] * axis[2]
        w = unit[k, 0] * axis[1] - unit[k, 1] * axis[0]
        widest = max(widest, s * s + t * t + w * w)
    if not (worst < math.inf and cosine >= NARROW):
        return math.inf
    return math.sqrt(widest) + 2.0 * worst


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
