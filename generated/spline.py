"""The C1 quadratic spline: the grid, and the formulas of symbolic/spline.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import numpy as np

from .vectors import Patch, Vector, inline

SCALE = 8.0
NEIGHBOURS = np.array([
    [[-1, -1], [0, -1], [1, -1], [-1, 0], [0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]],
    [[1, -1], [1, 0], [1, 1], [0, -1], [0, 0], [0, 1], [-1, -1], [-1, 0], [-1, 1]],
    [[1, 1], [0, 1], [-1, 1], [1, 0], [0, 0], [-1, 0], [1, -1], [0, -1], [-1, -1]],
    [[-1, 1], [-1, 0], [-1, -1], [0, 1], [0, 0], [0, -1], [1, 1], [1, 0], [1, -1]],
])  # fmt: skip
CORNERS = np.array([
    [[-0.5, -0.5], [0.5, -0.5]],
    [[0.5, -0.5], [0.5, 0.5]],
    [[0.5, 0.5], [-0.5, 0.5]],
    [[-0.5, 0.5], [-0.5, -0.5]],
])  # fmt: skip
TRIANGLE_NEIGHBOURS = np.array([0, 1, 2, 3, 5, 7])
VERTICES = np.array([
    [1, 1], [1, 2], [2, 1], [2, 2], [0, 1], [0, 2], [1, 0], [1, 3], [2, 0], [2, 3], [3, 1], [3, 2],
])  # fmt: skip


@inline
def control_net(mu_sw, mu_s, mu_se, mu_w, mu_c, mu_e, mu_n):
    """The Bézier net of the south triangle of a cell from the coefficients of the cell and its
    eight neighbours; the other three triangles follow by quarter turns.

        b200 = (mu_c + mu_s + mu_sw + mu_w)/4
        b020 = (mu_c + mu_e + mu_s + mu_se)/4
        b002 = mu_c/2 + (mu_e + mu_n + mu_s + mu_w)/8
        b110 = (mu_c + mu_s)/2
        b101 = mu_c/2 + mu_s/4 + mu_w/4
        b011 = mu_c/2 + mu_e/4 + mu_s/4

    Source: Sect. 3.1; 108 operations as written, 75 here.
    """
    mu_sw_x, mu_sw_y, mu_sw_z = mu_sw
    mu_s_x, mu_s_y, mu_s_z = mu_s
    mu_se_x, mu_se_y, mu_se_z = mu_se
    mu_w_x, mu_w_y, mu_w_z = mu_w
    mu_c_x, mu_c_y, mu_c_z = mu_c
    mu_e_x, mu_e_y, mu_e_z = mu_e
    mu_n_x, mu_n_y, mu_n_z = mu_n
    t0 = 0.25 * mu_w_x
    t1 = 0.25 * mu_s_x
    t2 = 0.25 * mu_c_x + t1
    b200_x = 0.25 * mu_sw_x + t0 + t2
    t3 = 0.25 * mu_w_y
    t4 = 0.25 * mu_s_y
    t5 = 0.25 * mu_c_y + t4
    b200_y = 0.25 * mu_sw_y + t3 + t5
    t6 = 0.25 * mu_w_z
    t7 = 0.25 * mu_s_z
    t8 = 0.25 * mu_c_z + t7
    b200_z = 0.25 * mu_sw_z + t6 + t8
    t9 = 0.25 * mu_e_x
    b020_x = 0.25 * mu_se_x + t2 + t9
    t10 = 0.25 * mu_e_y
    b020_y = 0.25 * mu_se_y + t10 + t5
    t11 = 0.25 * mu_e_z
    b020_z = 0.25 * mu_se_z + t11 + t8
    t12 = 0.5 * mu_c_x
    b002_x = 0.125 * mu_e_x + 0.125 * mu_n_x + 0.125 * mu_s_x + 0.125 * mu_w_x + t12
    t13 = 0.5 * mu_c_y
    b002_y = 0.125 * mu_e_y + 0.125 * mu_n_y + 0.125 * mu_s_y + 0.125 * mu_w_y + t13
    t14 = 0.5 * mu_c_z
    b002_z = 0.125 * mu_e_z + 0.125 * mu_n_z + 0.125 * mu_s_z + 0.125 * mu_w_z + t14
    b110_x = 0.5 * mu_s_x + t12
    b110_y = 0.5 * mu_s_y + t13
    b110_z = 0.5 * mu_s_z + t14
    t15 = t1 + t12
    b101_x = t0 + t15
    t16 = t13 + t4
    b101_y = t16 + t3
    t17 = t14 + t7
    b101_z = t17 + t6
    b011_x = t15 + t9
    b011_y = t10 + t16
    b011_z = t11 + t17
    return (
        Vector(b200_x, b200_y, b200_z),
        Vector(b020_x, b020_y, b020_z),
        Vector(b002_x, b002_y, b002_z),
        Vector(b110_x, b110_y, b110_z),
        Vector(b101_x, b101_y, b101_z),
        Vector(b011_x, b011_y, b011_z),
    )


@inline
def triangle(mu_sw, mu_s, mu_se, mu_w, mu_e, mu_n):
    """The vectors of the quadratic patch over the south triangle of a cell, times 8, from the
    differences mu_s, … of the neighbouring coefficients from that of the cell: integer weights,
    so that integers give exact results.

        a = 2*(mu_e + mu_n - mu_s - mu_w) + 4*mu_sw
        b = 2*(mu_n - mu_e + mu_s - mu_w)
        c = 2*(mu_n - mu_e - mu_s + mu_w) + 4*mu_se
        d = 2*(mu_s - mu_e - mu_n + mu_w)
        e = 2*(mu_e - mu_n + mu_s - mu_w)
        p = mu_e + mu_n + mu_s + mu_w

    Source: Sect. 3.1 and eq. (8); 126 operations as written, 69 here.
    """
    mu_sw_x, mu_sw_y, mu_sw_z = mu_sw
    mu_s_x, mu_s_y, mu_s_z = mu_s
    mu_se_x, mu_se_y, mu_se_z = mu_se
    mu_w_x, mu_w_y, mu_w_z = mu_w
    mu_e_x, mu_e_y, mu_e_z = mu_e
    mu_n_x, mu_n_y, mu_n_z = mu_n
    t0 = 2 * mu_w_x
    t1 = 2 * mu_n_x
    t2 = 2 * mu_s_x
    t3 = 2 * mu_e_x
    t4 = t3 - t2
    t5 = t1 - t0 + t4
    a_x = 4 * mu_sw_x + t5
    t6 = 2 * mu_w_y
    t7 = 2 * mu_n_y
    t8 = 2 * mu_s_y
    t9 = 2 * mu_e_y
    t10 = t9 - t8
    t11 = t10 - t6 + t7
    a_y = 4 * mu_sw_y + t11
    t12 = 2 * mu_w_z
    t13 = 2 * mu_n_z
    t14 = 2 * mu_s_z
    t15 = 2 * mu_e_z
    t16 = t15 - t14
    t17 = t13 - t12 + t16
    a_z = 4 * mu_sw_z + t17
    b_x = t1 - t0 - t4
    b_y = t7 - t10 - t6
    b_z = t13 - t12 - t16
    c_x = 4 * mu_se_x + t0 + t1 - t2 - t3
    c_y = 4 * mu_se_y + t6 + t7 - t8 - t9
    c_z = 4 * mu_se_z + t12 + t13 - t14 - t15
    d_x = -t5
    d_y = -t11
    d_z = -t17
    e_x = t2 - t0 - t1 + t3
    e_y = t8 - t6 - t7 + t9
    e_z = t14 - t12 - t13 + t15
    p_x = mu_e_x + mu_n_x + mu_s_x + mu_w_x
    p_y = mu_e_y + mu_n_y + mu_s_y + mu_w_y
    p_z = mu_e_z + mu_n_z + mu_s_z + mu_w_z
    return Patch(
        Vector(a_x, a_y, a_z),
        Vector(b_x, b_y, b_z),
        Vector(c_x, c_y, c_z),
        Vector(d_x, d_y, d_z),
        Vector(e_x, e_y, e_z),
        Vector(p_x, p_y, p_z),
    )


@inline
def coefficient(f, g0, g1, g2, g3):
    """The coefficient of a cell from the values of the surface at its centre (f) and its four
    vertices (g): exact on all quadratics.

        mu = 2*f - (g0 + g1 + g2 + g3)/4

    Source: Sect. 3.1; 9 operations as written, 9 here.
    """
    mu = 2 * f - 0.25 * g0 - 0.25 * g1 - 0.25 * g2 - 0.25 * g3
    return mu


@inline
def coefficient_from_centres(f, g0, g1, g2, g3):
    """The coefficient of a cell from the values at its centre (f) and the centres of its four
    neighbours (g): exact on all quadratics.

        mu = 3*f/2 - (g0 + g1 + g2 + g3)/8

    Source: Sect. 3.1; 9 operations as written, 9 here.
    """
    mu = 1.5 * f - 0.125 * g0 - 0.125 * g1 - 0.125 * g2 - 0.125 * g3
    return mu


@inline
def coefficient_from_vertices(f0, f1, f2, f3, g0, g1, g2, g3, g4, g5, g6, g7):
    """The coefficient of a cell from the values at its four vertices (f) and the eight next
    ones (g): exact on all quadratics.

        mu = 3*(f0 + f1 + f2 + f3)/8 - (g0 + g1 + g2 + g3 + g4 + g5 + g6 + g7)/16

    Source: Sect. 3.1; 23 operations as written, 23 here.
    """
    mu = (
        0.375 * f0
        + 0.375 * f1
        + 0.375 * f2
        + 0.375 * f3
        - 0.0625 * g0
        - 0.0625 * g1
        - 0.0625 * g2
        - 0.0625 * g3
        - 0.0625 * g4
        - 0.0625 * g5
        - 0.0625 * g6
        - 0.0625 * g7
    )
    return mu


@inline
def edge_point(f, g0, g1):
    """The middle Bézier point of an edge on the boundary from the values at its middle (f) and
    its ends (g): exact on all quadratics.

        mu = 2*f - g0/2 - g1/2

    Source: Sect. 3.1; 5 operations as written, 5 here.
    """
    mu = 2 * f - 0.5 * g0 - 0.5 * g1
    return mu


@inline
def edge_point_from_vertices(f0, f1, g0, g1):
    """The middle Bézier point of an edge on the boundary from the values at its ends (f) and at
    the next vertices along the boundary (g): exact on all quadratics.

        mu = 5*f0/8 + 5*f1/8 - g0/8 - g1/8

    Source: Sect. 3.1; 7 operations as written, 7 here.
    """
    mu = 0.625 * f0 + 0.625 * f1 - 0.125 * g0 - 0.125 * g1
    return mu


@inline
def beyond_edge(f, mu_c):
    """The coefficient beyond an edge of the boundary from that of its cell and the middle
    Bézier point f of the edge.

        mu_s = 2*f - mu_c

    Source: Sect. 3.1; 2 operations as written, 2 here.
    """
    mu_s = 2 * f - mu_c
    return mu_s


@inline
def beyond_corner(f, mu_s, mu_w, mu_c):
    """The coefficient beyond a corner of the domain from the other three around it and the
    value f there, which the spline interpolates.

        mu_sw = 4*f - mu_c - mu_s - mu_w

    Source: Sect. 3.1; 4 operations as written, 4 here.
    """
    mu_sw = 4 * f - mu_c - mu_s - mu_w
    return mu_sw


@inline
def extrapolation(f1, f2, f3):
    """A value one step outside the domain from the next three inside: exact on all quadratics.

        f0 = 3*f1 - 3*f2 + f3

    Source: beyond the paper; 4 operations as written, 4 here.
    """
    f0 = 3 * f1 - 3 * f2 + f3
    return f0
