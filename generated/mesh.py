"""Triangles through samples: the formulas of symbolic/mesh.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math

from .vectors import Vector, inline


@inline
def corner_products(p0, p1, p2, n0, n1, n2):
    """Cosines s0/L, s1/L, s2/L of the angles between the normal of a triangle with the corners
    p0, p1, p2 and the unit normals n0, n1, n2 of the surface there. L is twice its area.

        e = p1 - p0
        f = p2 - p0
        N = e × f
        s0 = N·n0
        s1 = N·n1
        s2 = N·n2
        L = |N|

    Source: beyond the paper; 36 operations as written, 36 here.
    """
    p0_x, p0_y, p0_z = p0
    p1_x, p1_y, p1_z = p1
    p2_x, p2_y, p2_z = p2
    n0_x, n0_y, n0_z = n0
    n1_x, n1_y, n1_z = n1
    n2_x, n2_y, n2_z = n2
    e_x = p1_x - p0_x
    e_y = p1_y - p0_y
    e_z = p1_z - p0_z
    f_x = p2_x - p0_x
    f_y = p2_y - p0_y
    f_z = p2_z - p0_z
    N_x = e_y * f_z - e_z * f_y
    N_y = e_z * f_x - e_x * f_z
    N_z = e_x * f_y - e_y * f_x
    s0 = N_x * n0_x + N_y * n0_y + N_z * n0_z
    s1 = N_x * n1_x + N_y * n1_y + N_z * n1_z
    s2 = N_x * n2_x + N_y * n2_y + N_z * n2_z
    L = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z)
    return s0, s1, s2, L


@inline
def corner_cotangents(p0, p1, p2):
    """Cotangents c0/L, c1/L, c2/L of the angles of a triangle with the corners p0, p1, p2. L is
    twice its area.

        e = p1 - p0
        f = p2 - p0
        g = p2 - p1
        N = e × f
        c0 = e·f
        c1 = - e·g
        c2 = f·g
        L = |N|

    Source: beyond the paper; 40 operations as written, 40 here.
    """
    p0_x, p0_y, p0_z = p0
    p1_x, p1_y, p1_z = p1
    p2_x, p2_y, p2_z = p2
    e_x = p1_x - p0_x
    e_y = p1_y - p0_y
    e_z = p1_z - p0_z
    f_x = p2_x - p0_x
    f_y = p2_y - p0_y
    f_z = p2_z - p0_z
    g_x = p2_x - p1_x
    g_y = p2_y - p1_y
    g_z = p2_z - p1_z
    N_x = e_y * f_z - e_z * f_y
    N_y = e_z * f_x - e_x * f_z
    N_z = e_x * f_y - e_y * f_x
    c0 = e_x * f_x + e_y * f_y + e_z * f_z
    c1 = -e_x * g_x - e_y * g_y - e_z * g_z
    c2 = f_x * g_x + f_y * g_y + f_z * g_z
    L = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z)
    return c0, c1, c2, L


@inline
def border_spacing(r, k):
    """The spacing of boundary points where the distance to the k-th nearest sample is r: the
    spacing of samples of which k fill half a disk of radius r.

        rho = 2*k/(pi*r**2)
        d = 1/sqrt(rho)

    Source: beyond the paper; 6 operations as written, 6 here.
    """
    rho = 2 * k / (math.pi * r * r)
    d = 1.0 / math.sqrt(rho)
    return d


@inline
def edge_over_surface(p0, p1, n0, n1):
    """The middle Bézier point of a quadratic curve from p0 to p1 whose end tangents are
    perpendicular to the unit normals n0 and n1, in the sense of least squares.

        e = p1 - p0
        beta = - (e·n0 - e·n1)/(4*(n0·n1 + 1))
        b = beta*(n0 + n1) + p0/2 + p1/2

    Source: beyond the paper; 40 operations as written, 40 here.
    """
    p0_x, p0_y, p0_z = p0
    p1_x, p1_y, p1_z = p1
    n0_x, n0_y, n0_z = n0
    n1_x, n1_y, n1_z = n1
    e_x = p1_x - p0_x
    e_y = p1_y - p0_y
    e_z = p1_z - p0_z
    beta = (
        -0.25
        * (e_x * n0_x - e_x * n1_x + e_y * n0_y - e_y * n1_y + e_z * n0_z - e_z * n1_z)
        / (n0_x * n1_x + n0_y * n1_y + n0_z * n1_z + 1)
    )
    b_x = beta * (n0_x + n1_x) + 0.5 * p0_x + 0.5 * p1_x
    b_y = beta * (n0_y + n1_y) + 0.5 * p0_y + 0.5 * p1_y
    b_z = beta * (n0_z + n1_z) + 0.5 * p0_z + 0.5 * p1_z
    return Vector(b_x, b_y, b_z)


@inline
def ray_in_triangle(p, d, p0, p1, p2):
    """Where a ray, p + T/D d, meets the plane of a triangle, p0 + U/D (p1 - p0) + V/D (p2 -
    p0). D is positive if the ray comes from the side from which p0, p1, p2 are anticlockwise.

        e = p1 - p0
        f = p2 - p0
        s = p - p0
        h = d × f
        q = s × e
        D = e·h
        U = s·h
        V = d·q
        T = f·q

    Source: beyond the paper; 47 operations as written, 47 here.
    """
    p_x, p_y, p_z = p
    d_x, d_y, d_z = d
    p0_x, p0_y, p0_z = p0
    p1_x, p1_y, p1_z = p1
    p2_x, p2_y, p2_z = p2
    e_x = p1_x - p0_x
    e_y = p1_y - p0_y
    e_z = p1_z - p0_z
    f_x = p2_x - p0_x
    f_y = p2_y - p0_y
    f_z = p2_z - p0_z
    s_x = p_x - p0_x
    s_y = p_y - p0_y
    s_z = p_z - p0_z
    h_x = d_y * f_z - d_z * f_y
    h_y = d_z * f_x - d_x * f_z
    h_z = d_x * f_y - d_y * f_x
    q_x = e_z * s_y - e_y * s_z
    q_y = e_x * s_z - e_z * s_x
    q_z = e_y * s_x - e_x * s_y
    D = e_x * h_x + e_y * h_y + e_z * h_z
    U = h_x * s_x + h_y * s_y + h_z * s_z
    V = d_x * q_x + d_y * q_y + d_z * q_z
    T = f_x * q_x + f_y * q_y + f_z * q_z
    return D, U, V, T
