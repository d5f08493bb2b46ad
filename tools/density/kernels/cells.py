"""Cells, rectangles of the parameters of a surface: radii, spreads of normals, areas.

A cell is a rectangle in u, v with a parameter pair in it, its place. In the cell, the surface is
approximated by the quadratic patch that osculates it at the place; the cell has to be small enough.
"""

from __future__ import annotations

import math

from ....generated.jet import at_jet
from ....generated.patch import control_normals, envelope, tangents
from ....generated.vectors import Patch, Vector
from ....runtime.base.tolerances import VANISHING
from ....runtime.directions.kernels.vectors import dot, length, set_row
from ....runtime.machine_code.jit import inline, jit, loop
from ....runtime.spline.kernels.jets import patch_of_jet
from .sizing import density_of

# The number of fine points along each side of a cell, and the coordinate of the last one.
FINER = 4
OUTERMOST = (FINER - 0.5) / FINER - 0.5
# The surface may be farther from the place than its osculating patch by this factor.
BEYOND = 1.03


@inline
def distance_of(v, w):
    """Return the distance between the end points of two position vectors."""
    return length(Vector(v.x - w.x, v.y - w.y, v.z - w.z))


@loop
def squared_sine(patch, s, t, sign, n, least):
    """Return sin² of the largest angle from n to normals of half a cell; 2 if it is not acute.

    The normals are combinations of control normals; control normals shorter than `least` are
    ignored. The half is the triangle of the corner s, t and the two corners a step of `sign` away
    from it.
    """
    p_u, p_v, _ = tangents(patch, s, t)
    d = Vector(sign * p_u.x, sign * p_u.y, sign * p_u.z)
    e = Vector(sign * p_v.x, sign * p_v.y, sign * p_v.z)
    largest = 0.0
    for m in control_normals(Patch(patch.a, patch.b, patch.c, d, e, patch.p)):
        size = dot(m, m)
        if size > least * least:
            x = m.y * n.z - m.z * n.y
            y = m.z * n.x - m.x * n.z
            z = m.x * n.y - m.y * n.x
            sine = (x * x + y * y + z * z) / size
            largest = max(largest, sine if dot(m, n) > 0.0 else 2.0)
    return largest


@inline
def chord_of_cell(patch, low_s, low_t, n, least):
    """Return the largest chord between n and normals of a cell; 2 if an angle is not acute."""
    square = max(
        squared_sine(patch, low_s, low_t, 1.0, n, least),
        squared_sine(patch, low_s + 1.0, low_t + 1.0, -1.0, n, least),
    )
    return math.sqrt(2.0 * square / (1.0 + math.sqrt(1.0 - square))) if square < 1.0 else 2.0


@inline
def write_row(rows, k, jets, size, centre, normal, density, K):
    """Write the scaled point, the normal, the target density and K of a place."""
    for x in range(3):
        rows[k, x] = (jets[k, 0, x] - centre[x]) * size
    set_row(rows[:, 3:6], k, normal)
    rows[k, 6] = density
    rows[k, 7] = K


@jit
def evaluate_cells(jets, boxes, places, limits, size, centre, finest, target, rows, numbers):
    """Write measures of cells with boxes (M, 4), from 2-jets (M, 6, 3) at their places (M, 2).

    Boxes are u0, v0, u1, v1. Lengths are multiplied by `size`, and points are relative to a centre.

    rows (M, 8): point, unit normal, target density and K; normal and K are 0 at singular points.
    numbers (M, 7): the radius of a ball around the point that contains the cell; the largest chord
    between the normal at the place and a normal of the cell, 0 if it is rounding error, 2 if an
    angle is not acute or there is no normal; the lengths of the cell along u and v; its bends along
    u and v, relative to the lengths, 0 if they are rounding error; its area.
    limits (M,): least radii of curvature, which replace smaller radii. A limit that is 0 on entry
    becomes the width of the cell in space, along u or v, whichever is smaller; sides shorter than
    `finest` (2,), in parameters, count as `finest`.
    """
    for k in range(jets.shape[0]):
        du = boxes[k, 2] - boxes[k, 0]
        dv = boxes[k, 3] - boxes[k, 1]
        patch = patch_of_jet(jets, k, size, du, dv)
        area, n, K, H = at_jet(patch)
        scale = math.sqrt(dot(patch.d, patch.d) * dot(patch.e, patch.e))
        regular = area > VANISHING * scale and abs(K) < math.inf
        radius = 0.0
        along_u = 0.0
        along_v = 0.0
        for corner in range(4):
            s = (boxes[k, 2 * (corner % 2)] - places[k, 0]) / du
            t = (boxes[k, 1 + 2 * (corner // 2)] - places[k, 1]) / dv
            radius = max(radius, distance_of(envelope(patch, s, t), patch.p))
            p_u, p_v, _ = tangents(patch, s, t)
            along_u = max(along_u, length(p_u))
            along_v = max(along_v, length(p_v))
        radius *= BEYOND
        low_s = (boxes[k, 0] - places[k, 0]) / du
        low_t = (boxes[k, 1] - places[k, 1]) / dv
        normal = n if regular else Vector(0.0, 0.0, 0.0)
        longest = max(along_u, along_v)
        least = VANISHING * longest
        chord = chord_of_cell(patch, low_s, low_t, normal, least * longest)
        limit = limits[k]
        if limit == 0.0:
            wide = max(finest[0] / du, 1.0)
            high = max(finest[1] / dv, 1.0)
            across_u = (along_u + length(patch.a) * (wide - 1.0)) * wide
            across_v = (along_v + length(patch.c) * (high - 1.0)) * high
            limit = min(across_u, across_v)
        density = density_of(K, H, limit, target) if regular else target.floor
        write_row(rows, k, jets, size, centre, normal, density, K if regular else 0.0)
        numbers[k, 0] = radius
        numbers[k, 1] = min(BEYOND * chord, 2.0)
        numbers[k, 2] = along_u
        numbers[k, 3] = along_v
        numbers[k, 4] = length(patch.a) / along_u if along_u > least else 0.0
        numbers[k, 5] = length(patch.c) / along_v if along_v > least else 0.0
        numbers[k, 6] = area
        limits[k] = limit


@jit
def evaluate_places(jets, boxes, places, limits, size, centre, finest, target, rows, sides):
    """Write the rows of `evaluate_cells`, and the sides of cells instead of their numbers.

    sides (M, 8) float32: two vectors, the sides of the cell along u and v at its place; its area;
    and the largest distance of a fine point from the place, see kernels/voronoi.py. The limits are
    known.
    """
    for k in range(jets.shape[0]):
        patch = patch_of_jet(jets, k, size, boxes[k, 2] - boxes[k, 0], boxes[k, 3] - boxes[k, 1])
        area, n, K, H = at_jet(patch)
        d, e = patch.d, patch.e
        scale = math.sqrt(dot(d, d) * dot(e, e))
        regular = area > VANISHING * scale and abs(K) < math.inf
        normal = n if regular else Vector(0.0, 0.0, 0.0)
        density = density_of(K, H, limits[k], target) if regular else target.floor
        write_row(rows, k, jets, size, centre, normal, density, K if regular else 0.0)
        set_row(sides[:, :3], k, d)
        set_row(sides[:, 3:6], k, e)
        sides[k, 6] = area
        diagonal = math.sqrt(dot(d, d) + dot(e, e) + 2.0 * abs(dot(d, e)))
        sides[k, 7] = OUTERMOST * diagonal


@jit
def cut_into_parts(cells, parts, boxes):
    """Write the boxes of the parts of cells (M, 4).

    `parts` (M, 2) are the numbers of parts of each cell along u and v.
    """
    at = 0
    for k in range(cells.shape[0]):
        du = (cells[k, 2] - cells[k, 0]) / parts[k, 0]
        dv = (cells[k, 3] - cells[k, 1]) / parts[k, 1]
        for i in range(parts[k, 0]):
            end = cells[k, 0] + (i + 1) * du if i + 1 < parts[k, 0] else cells[k, 2]
            for j in range(parts[k, 1]):
                boxes[at, 0], boxes[at, 2] = cells[k, 0] + i * du, end
                boxes[at, 1], boxes[at, 3] = cells[k, 1] + j * dv, cells[k, 1] + (j + 1) * dv
                at += 1
            boxes[at - 1, 3] = cells[k, 3]
