"""Pieces of a surface, each with a cone of its normals: patches of a spline, or cells of a surface.

The normals of a patch are combinations of its control normals with positive weights, so that a cone
that contains all control normals contains all normals. A cone is given by its axis and its chord:
the largest distance between the unit axis and a unit vector of the cone. In addition, a slab
between two parallel planes bounds long thin Gaussian images.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.patch import control_normals
from ....generated.spline import triangle
from ....generated.vectors import Patch, Vector
from ...base.tolerances import ANGLE_ERROR, FORM_ERROR, SHORT_CONTROL_NORMAL
from ...directions.kernels.vectors import dot, length, row_vector, set_row
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import inline, jit, loop
from ...spline.kernels.patch import patch_vectors, vector_at

# The columns of a cone: its axis and its chord; the normal of its slab, and half the slab's width.
CHORD, SLAB, WIDTH, CONE = 3, 4, 7, 8
# The columns of a patch: the vectors a, b, c, d, e, and bounds of the errors of its forms U, V, W,
# without and with the rounding of coordinates. A cell of a surface has bounds of the remainders of
# x_s and x_t instead of these errors.
BOUND, DATA_BOUND, COLUMNS = 15, 16, 17
REST_S, REST_T = 15, 16
# The chord of a cone, and the width of a slab, that contain all directions.
EVERYTHING = 2.0
# Cones with a larger chord, a half angle above 60°, are not used: a combination of their unit
# vectors with weights of sum 1 may be as short as the cosine of the half angle.
WIDEST = 1.0
# Chords and widths are enlarged, relatively and absolutely, by more than the rounding errors of
# sums of a few numbers of size 1.
RELATIVE, ABSOLUTE = 1.0 + 1e-12, 1e-14


class Pieces(NamedTuple):
    """Cones with slabs (K, 8) and patches (K, 17 or more), with the columns listed above.

    If the slab has the width EVERYTHING, the cone may contain the opposite of a normal of the
    piece.
    """

    cones: NDArray[np.float64]
    patches: NDArray[np.float64]

    @classmethod
    def new(cls, count: int) -> Pieces:
        """Return empty arrays for `count` pieces."""
        return cls(np.empty((count, CONE)), np.empty((count, COLUMNS)))


@jit
def write_pieces(mu, scale, noise, first, start, last, net, pieces):
    """Write the pieces of the patches in the cells [start, last) of a spline.

    `scale` is the power of two that scales the coefficients mu (m, n, 3) to about 1, `noise` the
    error of the scaled coordinates. Row 0 of `pieces` is the first patch of cell `first`. `net` (6,
    4) is a work array.
    """
    columns = mu.shape[1] - 2
    for cell in range(start, last):
        i, j = cell // columns, cell % columns
        c = vector_at(mu, i + 1, j + 1)
        sw, s, se = (
            step_to(mu, i, j, c, scale),
            step_to(mu, i + 1, j, c, scale),
            step_to(mu, i + 2, j, c, scale),
        )
        w, e = step_to(mu, i, j + 1, c, scale), step_to(mu, i + 2, j + 1, c, scale)
        nw, n, ne = (
            step_to(mu, i, j + 2, c, scale),
            step_to(mu, i + 1, j + 2, c, scale),
            step_to(mu, i + 2, j + 2, c, scale),
        )
        spread = Vector(
            max(abs(sw.x), abs(s.x), abs(se.x), abs(w.x), abs(e.x), abs(nw.x), abs(n.x), abs(ne.x)),
            max(abs(sw.y), abs(s.y), abs(se.y), abs(w.y), abs(e.y), abs(nw.y), abs(n.y), abs(ne.y)),
            max(abs(sw.z), abs(s.z), abs(se.z), abs(w.z), abs(e.z), abs(nw.z), abs(n.z), abs(ne.z)),
        )
        at = 4 * (cell - first)
        put_piece(pieces, at, triangle(sw, s, se, w, e, n), spread, noise, net)
        put_piece(pieces, at + 1, triangle(se, e, ne, s, n, w), spread, noise, net)
        put_piece(pieces, at + 2, triangle(ne, n, nw, e, w, s), spread, noise, net)
        put_piece(pieces, at + 3, triangle(nw, w, sw, n, s, e), spread, noise, net)


@loop
def step_to(mu, i, j, centre, scale):
    """Return the coefficient (i, j) minus the coefficient `centre` of the cell, times `scale`."""
    v = vector_at(mu, i, j)
    return Vector(scale * (v.x - centre.x), scale * (v.y - centre.y), scale * (v.z - centre.z))


@loop
def put_piece(pieces, k, patch, spread, noise, net):
    """Write piece k: a patch, the cone of its normals, and bounds of the errors of U, V, W.

    `spread` has the largest differences of the coefficients of the patch in x, y and z, and `noise`
    is the error of their coordinates.
    """
    tangents = tangent_bounds(patch)
    put_cone(pieces, k, patch, tangents, noise, 0.0, net)
    axis, chord = row_vector(pieces.cones, k), pieces.cones[k, CHORD]
    # Bounds of the components of normals, then of the error and of the size of linear forms.
    x, y, z = (
        min(abs(axis.x) + chord, 1.0),
        min(abs(axis.y) + chord, 1.0),
        min(abs(axis.z) + chord, 1.0),
    )
    rounding = FORM_ERROR * (x * spread.x + y * spread.y + z * spread.z)
    error = rounding + noise
    form = chord * (tangents.x + tangents.y + tangents.z) + error
    form += max(abs(dot(axis, patch.a)), abs(dot(axis, patch.b)), abs(dot(axis, patch.c)))
    form += max(abs(dot(axis, patch.d)), abs(dot(axis, patch.e)))
    write_patch(patch, 32.0 * rounding * form, 32.0 * error * form, pieces.patches[k])


@loop
def put_cone(pieces, k, patch, tangents, noise, angle, net):
    """Write the cone of piece k; errors of coordinates are up to `noise`, of normals up to `angle`.

    `tangents` are the results of `tangent_bounds`.
    """
    tangent = max(tangents.x, tangents.y, tangents.z)
    square = tangent * tangent
    control = control_normals(patch)
    for m in range(6):
        n = control[m]
        size = length(n)
        regular = size > SHORT_CONTROL_NORMAL * square
        inverse = 1.0 / size if regular else 0.0
        set_row(net, m, Vector(n.x * inverse, n.y * inverse, n.z * inverse))
        # Where a line has the normal n, |n·p_u| and |n·p_v| may be about 2 `noise`: see `lines_of`.
        error = ANGLE_ERROR + (ANGLE_ERROR * square + 8.0 * noise * tangent) * inverse
        net[m, 3] = angle + error if regular else math.inf
    write_cone(net, pieces.cones[k])


@inline
def write_patch(patch, bound, data_bound, row):
    """Write the vectors a, b, c, d, e of a patch to a row, and bounds of the errors of U, V, W."""
    write_vector(row, 0, patch.a)
    write_vector(row, 3, patch.b)
    write_vector(row, 6, patch.c)
    write_vector(row, 9, patch.d)
    write_vector(row, 12, patch.e)
    row[BOUND], row[DATA_BOUND] = bound, data_bound


@inline
def write_vector(row, at, v):
    """Write a vector to three columns of a row, from `at` on."""
    row[at], row[at + 1], row[at + 2] = v.x, v.y, v.z


@jit
def write_net_pieces(vectors, noise, angles, bounds, net, pieces):
    """Write the pieces of the patches of a spline of nets; `net` (6, 4) is a work array.

    The T patches have the vectors a, …, e (T, 5, 3), whose coordinates have errors up to `noise`,
    errors of normals as angles (T,), and bounds (T,) of the errors of U, V, W.
    """
    for k in range(angles.size):
        v = vectors[k]
        patch = Patch(
            row_vector(v, 0),
            row_vector(v, 1),
            row_vector(v, 2),
            row_vector(v, 3),
            row_vector(v, 4),
            Vector(0.0, 0.0, 0.0),
        )
        put_cone(pieces, k, patch, tangent_bounds(patch), noise, angles[k], net)
        write_patch(patch, bounds[k], bounds[k], pieces.patches[k])


@loop
def write_cone(net, cone):
    """Write the cone and the slab of the unit control normals net[:, :3].

    Their errors net[:, 3] are angles. A control normal with an infinite error is the zero vector,
    and adds no direction to the cone.
    """
    x = y = z = far = worst = 0.0
    regular = True
    for m in range(6):
        regular = regular and net[m, 3] < math.inf
        worst = max(worst, net[m, 3] if net[m, 3] < math.inf else 0.0)
        x, y, z = x + net[m, 0], y + net[m, 1], z + net[m, 2]
    size = length(Vector(x, y, z))
    inverse = 1.0 / size if size > 0.0 else 0.0
    axis = Vector(x * inverse, y * inverse, z * inverse)
    for m in range(6):
        if net[m, 3] < math.inf:
            n = row_vector(net, m)
            far = max(far, (n.x - axis.x) ** 2 + (n.y - axis.y) ** 2 + (n.z - axis.z) ** 2)
    chord = (math.sqrt(far) + 2.0 * worst) * RELATIVE + ABSOLUTE
    cone[SLAB], cone[SLAB + 1], cone[SLAB + 2], cone[WIDTH] = 0.0, 0.0, 0.0, EVERYTHING
    if size == 0.0 or chord > WIDEST:
        cone[0], cone[1], cone[2], cone[CHORD] = 0.0, 0.0, 0.0, EVERYTHING
        return
    write_vector(cone, 0, axis)
    cone[CHORD] = chord
    if regular:
        normal = thinnest(net, axis)
        width = 0.0
        for m in range(6):
            width = max(width, abs(dot(row_vector(net, m), normal)))
        write_vector(cone, SLAB, normal)
        # A combination of unit vectors of the cone, with weights of sum 1, is at least as long as
        # the cosine of the half angle.
        cone[WIDTH] = (width + worst) / (1.0 - 0.5 * chord * chord) * RELATIVE + ABSOLUTE


@loop
def thinnest(net, axis):
    """Return the direction perpendicular to an axis in which the vectors net[:, :3] vary least."""
    x, y, z = abs(axis.x), abs(axis.y), abs(axis.z)
    if x <= y and x <= z:
        p = Vector(0.0, axis.z, -axis.y)
    elif y <= z:
        p = Vector(-axis.z, 0.0, axis.x)
    else:
        p = Vector(axis.y, -axis.x, 0.0)
    size = 1.0 / length(p)
    p = Vector(p.x * size, p.y * size, p.z * size)
    q = Vector(
        axis.y * p.z - axis.z * p.y, axis.z * p.x - axis.x * p.z, axis.x * p.y - axis.y * p.x
    )
    xx = xy = yy = 0.0
    for m in range(6):
        n = row_vector(net, m)
        s, t = dot(n, p), dot(n, q)
        xx, xy, yy = xx + s * s, xy + s * t, yy + t * t
    # The direction of largest variation has half the polar angle of (xx − yy, 2 xy).
    size = math.sqrt((xx - yy) ** 2 + 4.0 * xy * xy)
    share = (xx - yy) / size if size > 0.0 else 1.0
    c, s = math.sqrt(max(0.5 + 0.5 * share, 0.0)), math.sqrt(max(0.5 - 0.5 * share, 0.0))
    s = -s if xy > 0.0 else s
    return Vector(s * p.x + c * q.x, s * p.y + c * q.y, s * p.z + c * q.z)


# --- cones of the normals of patches --------------------------------------------------------------


@loop
def tangent_bounds(patch):
    """Return bounds of |x|, |y| and |z| of the tangent vectors of a patch."""
    a, b, c, d, e, _ = patch
    return Vector(
        max(abs(a.x), abs(b.x), abs(c.x)) + max(abs(d.x), abs(e.x)),
        max(abs(a.y), abs(b.y), abs(c.y)) + max(abs(d.y), abs(e.y)),
        max(abs(a.z), abs(b.z), abs(c.z)) + max(abs(d.z), abs(e.z)),
    )


@jit
def least_cosine(mu, scale, axis):
    """Return the least cosine between a unit vector (3,) and the control normals of the spline.

    If it is not negative, it is a lower bound of the cosines with all normals of the spline. After
    the first patch with a negative cosine, no more patches are examined.
    """
    columns = mu.shape[1] - 2
    towards = Vector(axis[0], axis[1], axis[2])
    least = 1.0
    for number in range(4 * (mu.shape[0] - 2) * columns):
        i, j, turn = place_of(number, columns)
        for normal in control_normals(patch_vectors(mu, i + 1, j + 1, turn, scale)):
            size = length(normal)
            if size > 0.0:
                least = min(least, dot(normal, towards) / size)
        if least < 0.0:
            break
    return least
