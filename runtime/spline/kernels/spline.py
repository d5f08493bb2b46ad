"""The C¹ quadratic spline: its coefficients, control nets, points, 2-jets, areas, solid angles."""

from __future__ import annotations

import math

import numpy as np

from ....generated.patch import NODE, envelope, measure, tangents
from ....generated.spline import (
    CORNERS,
    NEIGHBOURS,
    SCALE,
    VERTICES,
    coefficient,
    coefficient_from_vertices,
    control_net,
)
from ...directions.kernels.vectors import set_row
from ...domain.kernels.patch_numbers import place_of
from ...machine_code.jit import inline, jit
from .patch import normal_of_patch, patch_vectors, point_of_patch, vector_at

# For each number of quarter turns of a patch, the matrix that maps steps in units of cells to steps
# of the parameters u, v of the patch.
TO_PATCH = np.linalg.inv(CORNERS)


# --- fitting --------------------------------------------------------------------------------------


@jit
def fit_centres_and_vertices(centres, vertices, coefficients):
    """Write coefficients (m, n, 3) from values at centres (m, n, 3) and vertices (m+1, n+1, 3)."""
    for i in range(coefficients.shape[0]):
        for j in range(coefficients.shape[1]):
            for x in range(3):
                coefficients[i, j, x] = coefficient(
                    centres[i, j, x],
                    vertices[i, j, x],
                    vertices[i, j + 1, x],
                    vertices[i + 1, j, x],
                    vertices[i + 1, j + 1, x],
                )


@inline
def value_round_cell(values, i, j, k, x):
    """Return component x of the value at vertex k of a cell."""
    return values[i + VERTICES[k, 0], j + VERTICES[k, 1], x]


@jit
def fit_vertices(values, coefficients):
    """Write coefficients (m, n, 3) from values (m+3, n+3, 3) at the vertices and ghosts."""
    for i in range(coefficients.shape[0]):
        for j in range(coefficients.shape[1]):
            for x in range(3):
                coefficients[i, j, x] = coefficient_from_vertices(
                    value_round_cell(values, i, j, 0, x),
                    value_round_cell(values, i, j, 1, x),
                    value_round_cell(values, i, j, 2, x),
                    value_round_cell(values, i, j, 3, x),
                    value_round_cell(values, i, j, 4, x),
                    value_round_cell(values, i, j, 5, x),
                    value_round_cell(values, i, j, 6, x),
                    value_round_cell(values, i, j, 7, x),
                    value_round_cell(values, i, j, 8, x),
                    value_round_cell(values, i, j, 9, x),
                    value_round_cell(values, i, j, 10, x),
                    value_round_cell(values, i, j, 11, x),
                )


# --- reading the spline ---------------------------------------------------------------------------


@inline
def coefficient_near(mu, i, j, turn, k):
    """Return the coefficient at the position NEIGHBOURS[turn, k] relative to (i, j)."""
    return vector_at(mu, i + NEIGHBOURS[turn, k, 0], j + NEIGHBOURS[turn, k, 1])


@jit
def control_nets(mu, nets):
    """Write the Bézier nets (4 m n, 6, 3) of all patches."""
    columns = mu.shape[1] - 2
    for patch in range(nets.shape[0]):
        i, j, turn = place_of(patch, columns)
        net = control_net(
            coefficient_near(mu, i + 1, j + 1, turn, 0),
            coefficient_near(mu, i + 1, j + 1, turn, 1),
            coefficient_near(mu, i + 1, j + 1, turn, 2),
            coefficient_near(mu, i + 1, j + 1, turn, 3),
            coefficient_near(mu, i + 1, j + 1, turn, 4),
            coefficient_near(mu, i + 1, j + 1, turn, 5),
            coefficient_near(mu, i + 1, j + 1, turn, 7),
        )
        for k in range(6):
            nets[patch, k, 0], nets[patch, k, 1], nets[patch, k, 2] = net[k]


@inline
def locate(s, t):
    """Return the triangle of a cell that contains a point, and u, v of the point in this triangle.

    s, t are the parameters of the point relative to the centre of the cell, in units of cells.
    """
    turn = 0
    if abs(s) > abs(t):
        turn = 1 if s > 0.0 else 3
    elif t > 0.0:
        turn = 2
    u, v = in_triangle(s, t, turn)
    return turn, u, v


@inline
def patch_at(x, y, rows, columns):
    """Return row and column of the cell that contains a point, its triangle, and u, v in this.

    x, y are the parameters of the point in units of cells.
    """
    i = min(max(int(math.floor(x)), 0), rows - 1)
    j = min(max(int(math.floor(y)), 0), columns - 1)
    turn, u, v = locate(x - i - 0.5, y - j - 0.5)
    return i, j, turn, u, v


@inline
def in_triangle(s, t, turn):
    """Return u, v in a triangle of a cell, for s, t relative to the cell's centre, in cells."""
    for _ in range(turn):
        s, t = t, -s
    return -t - s, -t + s


@jit
def evaluate(mu, scale, cells, points, normals):
    """Write points (k, 3) and unnormalized normals (k, 3) at parameters (k, 2) in cells."""
    size = SCALE * scale
    for k in range(cells.shape[0]):
        i, j, turn, u, v = patch_at(cells[k, 0], cells[k, 1], mu.shape[0] - 2, mu.shape[1] - 2)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        x = point_of_patch(patch, u, v)
        points[k, 0] = mu[i + 1, j + 1, 0] + x.x / size
        points[k, 1] = mu[i + 1, j + 1, 1] + x.y / size
        points[k, 2] = mu[i + 1, j + 1, 2] + x.z / size
        set_row(normals, k, normal_of_patch(patch, u, v))


@inline
def set_combination(jets, k, row, v, w, a, b):
    """Write the vector a v + b w into a 2-jet."""
    jets[k, row, 0] = a * v.x + b * w.x
    jets[k, row, 1] = a * v.y + b * w.y
    jets[k, row, 2] = a * v.z + b * w.z


@inline
def set_second(jets, k, row, patch, uu, uv, vv, size):
    """Write (uu a + uv b + vv c) / `size` into a 2-jet; a, b, c are vectors of a patch."""
    set_combination(jets, k, row, patch.a, patch.c, uu / size, vv / size)
    jets[k, row, 0] += uv / size * patch.b.x
    jets[k, row, 1] += uv / size * patch.b.y
    jets[k, row, 2] += uv / size * patch.b.z


@jit
def jets_on_spline(mu, scale, frame, cells, jets):
    """Write the 2-jets (k, 6, 3) of a spline at parameters (k, 2) in cells.

    Second derivatives at joints are those of one of the patches.
    """
    size = SCALE * scale
    du = frame[2]
    dv = frame[3]
    for k in range(cells.shape[0]):
        i, j, turn, u, v = patch_at(cells[k, 0], cells[k, 1], mu.shape[0] - 2, mu.shape[1] - 2)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        x = envelope(patch, u, v)
        p_u, p_v, _ = tangents(patch, u, v)
        # From derivatives along the sides of the patch to derivatives along the parameter lines.
        a = TO_PATCH[turn, 0, 0] / du
        b = TO_PATCH[turn, 0, 1] / du
        c = TO_PATCH[turn, 1, 0] / dv
        d = TO_PATCH[turn, 1, 1] / dv
        set_combination(jets, k, 0, x, vector_at(mu, i + 1, j + 1), 1.0 / size, 1.0)
        set_combination(jets, k, 1, p_u, p_v, a / size, b / size)
        set_combination(jets, k, 2, p_u, p_v, c / size, d / size)
        set_second(jets, k, 3, patch, a * a, 2.0 * a * b, b * b, size)
        set_second(jets, k, 4, patch, a * c, a * d + b * c, b * d, size)
        set_second(jets, k, 5, patch, c * c, 2.0 * c * d, d * d, size)


@jit
def patches_at(rows, columns, cells, patches, places):
    """Write the patches (k,) that contain points, and the parameters (k, 2) in these patches.

    The points have the parameters `cells` (k, 2), in units of cells. `rows` and `columns` are the
    numbers of cells along u and v.
    """
    for k in range(cells.shape[0]):
        i, j, turn, u, v = patch_at(cells[k, 0], cells[k, 1], rows, columns)
        patches[k] = 4 * (i * columns + j) + turn
        places[k, 0] = u
        places[k, 1] = v


@jit
def mark_left(uv, patches, frame, columns, near, left):
    """Write to `left` whether parameters `uv` (k, 2) are outside their patches (k,) or near a side.

    Parameters count as near a side if a step of at most `near` cells along each axis may lead out
    of the patch: such a step changes u and v of a triangle by at most 2 `near`.
    """
    u0, v0, du, dv = frame
    for k in range(patches.size):
        i, j, turn = place_of(patches[k], columns)
        u, v = in_triangle((uv[k, 0] - u0) / du - i - 0.5, (uv[k, 1] - v0) / dv - j - 0.5, turn)
        left[k] = min(u, v, 1.0 - u - v) < 2.0 * near


@jit
def measure_patches(mu, scale, first, last, areas, solid_angles):
    """Write areas, times scale², and signed solid angles of the patches [first, last)."""
    columns = mu.shape[1] - 2
    for number in range(first, last):
        i, j, turn = place_of(number, columns)
        patch = patch_vectors(mu, i + 1, j + 1, turn, scale)
        area = 0.0
        solid_angle = 0.0
        for node in range(3):
            u = 1.0 - 2.0 * NODE if node == 0 else NODE
            v = 1.0 - 2.0 * NODE if node == 1 else NODE
            dA, dS = measure(patch, u, v)
            if dA > 0.0:
                area += dA / 6.0
                solid_angle += dS / 6.0
        areas[number - first] = area / (SCALE * SCALE)
        solid_angles[number - first] = solid_angle
