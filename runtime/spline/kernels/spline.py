"""The C¹ quadratic spline: its coefficients, control nets, evaluation, areas and solid angles."""

from __future__ import annotations

import math

from ....generated.patch import NODE, measure
from ....generated.spline import (
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

__all__ = [
    "control_nets",
    "evaluate",
    "fit_centres_and_vertices",
    "fit_vertices",
    "mark_left",
    "measure_patches",
]


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
    """Return neighbour k of a coefficient."""
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
    """Return the triangle of a cell and u, v in it; s, t are relative to its centre, in cells."""
    turn = 0
    if abs(s) > abs(t):
        turn = 1 if s > 0.0 else 3
    elif t > 0.0:
        turn = 2
    u, v = in_triangle(s, t, turn)
    return turn, u, v


@inline
def patch_at(x, y, rows, columns):
    """Return row, column and triangle of the cell of a parameter pair in cells, and u, v there."""
    i = min(max(int(math.floor(x)), 0), rows - 1)
    j = min(max(int(math.floor(y)), 0), columns - 1)
    turn, u, v = locate(x - i - 0.5, y - j - 0.5)
    return i, j, turn, u, v


@inline
def in_triangle(s, t, turn):
    """Return u, v in a triangle of a cell; s, t are relative to its centre, in cells."""
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


@jit
def mark_left(uv, patches, frame, columns, near, left):
    """Mark parameters (k, 2) outside their patches (k,), or within `near` of the sides, in cells.

    A step of one cell along both axes changes u and v in a triangle by two.
    """
    u0, v0, du, dv = frame
    for k in range(patches.size):
        i, j, turn = place_of(patches[k], columns)
        u, v = in_triangle((uv[k, 0] - u0) / du - i - 0.5, (uv[k, 1] - v0) / dv - j - 0.5, turn)
        left[k] = min(u, v, 1.0 - u - v) < 2.0 * near


@jit
def measure_patches(mu, scale, first, last, areas, solid_angles):
    """Write area (scaled) and signed solid angle of the patches [first, last)."""
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
