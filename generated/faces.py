"""Faces of CAD parts: the formulas of symbolic/faces.py as functions of vectors.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from .vectors import Vector, inline


@inline
def revolution_jet(c, c_v, c_vv, x, y):
    """The point p and the derivatives of a surface of revolution around the z axis, from those
    of the curve c(v) that is turned; x and y are the cosine and the sine of the angle u.

        p_x = c_x*x - c_y*y
        p_y = c_x*y + c_y*x
        p_z = c_z
        x_u_x = - c_x*y - c_y*x
        x_u_y = c_x*x - c_y*y
        x_u_z = 0
        x_v_x = c_v_x*x - c_v_y*y
        x_v_y = c_v_x*y + c_v_y*x
        x_v_z = c_v_z
        x_uu_x = c_y*y - c_x*x
        x_uu_y = - c_x*y - c_y*x
        x_uu_z = 0
        x_uv_x = - c_v_x*y - c_v_y*x
        x_uv_y = c_v_x*x - c_v_y*y
        x_uv_z = 0
        x_vv_x = c_vv_x*x - c_vv_y*y
        x_vv_y = c_vv_x*y + c_vv_y*x
        x_vv_z = c_vv_z

    Source: beyond the paper; 39 operations as written, 22 here.
    """
    c_x, c_y, c_z = c
    c_v_x, c_v_y, c_v_z = c_v
    c_vv_x, c_vv_y, c_vv_z = c_vv
    t0 = c_x * x - c_y * y
    p_x = t0
    t1 = c_x * y + c_y * x
    p_y = t1
    p_z = c_z
    x_u_x = -t1
    x_u_y = t0
    x_u_z = 0
    t2 = c_v_x * x - c_v_y * y
    x_v_x = t2
    t3 = c_v_x * y + c_v_y * x
    x_v_y = t3
    x_v_z = c_v_z
    x_uu_x = -t0
    x_uu_y = -t1
    x_uu_z = 0
    x_uv_x = -t3
    x_uv_y = t2
    x_uv_z = 0
    x_vv_x = c_vv_x * x - c_vv_y * y
    x_vv_y = c_vv_x * y + c_vv_y * x
    x_vv_z = c_vv_z
    return (
        Vector(p_x, p_y, p_z),
        Vector(x_u_x, x_u_y, x_u_z),
        Vector(x_v_x, x_v_y, x_v_z),
        Vector(x_uu_x, x_uu_y, x_uu_z),
        Vector(x_uv_x, x_uv_y, x_uv_z),
        Vector(x_vv_x, x_vv_y, x_vv_z),
    )


@inline
def offset_jet(patch, x_uuu, x_uuv, x_uvv, x_vvv, n, L, R):
    """The point y = p + R n and the derivatives of the offset of a surface, from the point p,
    the 2-jet and the third derivatives of the surface, its unit normal n, and the length L of N
    = d × e.

        g = 1/L
        N_u = a × e + d × b
        N_v = b × e + d × c
        N_uu = 2*(a × b) + d × x_uuv + x_uuu × e
        N_uv = a × c + d × x_uvv + x_uuv × e
        N_vv = 2*(b × c) + d × x_vvv + x_uvv × e
        L_u = N_u·n
        L_v = N_v·n
        n_u = g*(N_u - L_u*n)
        n_v = g*(N_v - L_v*n)
        L_uu = L*|n_u|**2 + N_uu·n
        L_uv = L*(n_u·n_v) + N_uv·n
        L_vv = L*|n_v|**2 + N_vv·n
        y = R*n + p
        y_u = R*n_u + d
        y_v = R*n_v + e
        y_uu = R*g*(N_uu - 2*L_u*n_u - L_uu*n) + a
        y_uv = R*g*(N_uv - L_u*n_v - L_uv*n - L_v*n_u) + b
        y_vv = R*g*(N_vv - 2*L_v*n_v - L_vv*n) + c

    Source: beyond the paper; 311 operations as written, 293 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    x_uuu_x, x_uuu_y, x_uuu_z = x_uuu
    x_uuv_x, x_uuv_y, x_uuv_z = x_uuv
    x_uvv_x, x_uvv_y, x_uvv_z = x_uvv
    x_vvv_x, x_vvv_y, x_vvv_z = x_vvv
    n_x, n_y, n_z = n
    g = 1.0 / L
    N_u_x = a_y * e_z - a_z * e_y - b_y * d_z + b_z * d_y
    N_u_y = a_z * e_x - a_x * e_z + b_x * d_z - b_z * d_x
    N_u_z = a_x * e_y - a_y * e_x - b_x * d_y + b_y * d_x
    N_v_x = b_y * e_z - b_z * e_y - c_y * d_z + c_z * d_y
    N_v_y = b_z * e_x - b_x * e_z + c_x * d_z - c_z * d_x
    N_v_z = b_x * e_y - b_y * e_x - c_x * d_y + c_y * d_x
    t0 = 2 * b_z
    N_uu_x = (
        a_y * t0 - 2 * a_z * b_y + d_y * x_uuv_z - d_z * x_uuv_y - e_y * x_uuu_z + e_z * x_uuu_y
    )
    N_uu_y = (
        2 * a_z * b_x - a_x * t0 - d_x * x_uuv_z + d_z * x_uuv_x + e_x * x_uuu_z - e_z * x_uuu_x
    )
    t1 = 2 * b_y
    t2 = 2 * b_x
    N_uu_z = a_x * t1 - a_y * t2 + d_x * x_uuv_y - d_y * x_uuv_x - e_x * x_uuu_y + e_y * x_uuu_x
    N_uv_x = a_y * c_z - a_z * c_y + d_y * x_uvv_z - d_z * x_uvv_y - e_y * x_uuv_z + e_z * x_uuv_y
    N_uv_y = a_z * c_x - a_x * c_z - d_x * x_uvv_z + d_z * x_uvv_x + e_x * x_uuv_z - e_z * x_uuv_x
    N_uv_z = a_x * c_y - a_y * c_x + d_x * x_uvv_y - d_y * x_uvv_x - e_x * x_uuv_y + e_y * x_uuv_x
    N_vv_x = c_z * t1 - c_y * t0 + d_y * x_vvv_z - d_z * x_vvv_y - e_y * x_uvv_z + e_z * x_uvv_y
    N_vv_y = (
        2 * b_z * c_x - c_z * t2 - d_x * x_vvv_z + d_z * x_vvv_x + e_x * x_uvv_z - e_z * x_uvv_x
    )
    N_vv_z = c_y * t2 - c_x * t1 + d_x * x_vvv_y - d_y * x_vvv_x - e_x * x_uvv_y + e_y * x_uvv_x
    L_u = N_u_x * n_x + N_u_y * n_y + N_u_z * n_z
    L_v = N_v_x * n_x + N_v_y * n_y + N_v_z * n_z
    n_u_x = g * (N_u_x - L_u * n_x)
    n_u_y = g * (N_u_y - L_u * n_y)
    n_u_z = g * (N_u_z - L_u * n_z)
    n_v_x = g * (N_v_x - L_v * n_x)
    n_v_y = g * (N_v_y - L_v * n_y)
    n_v_z = g * (N_v_z - L_v * n_z)
    L_uu = (
        L * (n_u_x * n_u_x + n_u_y * n_u_y + n_u_z * n_u_z)
        + N_uu_x * n_x
        + N_uu_y * n_y
        + N_uu_z * n_z
    )
    L_uv = (
        L * (n_u_x * n_v_x + n_u_y * n_v_y + n_u_z * n_v_z)
        + N_uv_x * n_x
        + N_uv_y * n_y
        + N_uv_z * n_z
    )
    L_vv = (
        L * (n_v_x * n_v_x + n_v_y * n_v_y + n_v_z * n_v_z)
        + N_vv_x * n_x
        + N_vv_y * n_y
        + N_vv_z * n_z
    )
    y_x = R * n_x + p_x
    y_y = R * n_y + p_y
    y_z = R * n_z + p_z
    y_u_x = R * n_u_x + d_x
    y_u_y = R * n_u_y + d_y
    y_u_z = R * n_u_z + d_z
    y_v_x = R * n_v_x + e_x
    y_v_y = R * n_v_y + e_y
    y_v_z = R * n_v_z + e_z
    t3 = 2 * L_u
    t4 = R * g
    y_uu_x = a_x + t4 * (N_uu_x - L_uu * n_x - n_u_x * t3)
    y_uu_y = a_y + t4 * (N_uu_y - L_uu * n_y - n_u_y * t3)
    y_uu_z = a_z + t4 * (N_uu_z - L_uu * n_z - n_u_z * t3)
    y_uv_x = b_x + t4 * (N_uv_x - L_u * n_v_x - L_uv * n_x - L_v * n_u_x)
    y_uv_y = b_y + t4 * (N_uv_y - L_u * n_v_y - L_uv * n_y - L_v * n_u_y)
    y_uv_z = b_z + t4 * (N_uv_z - L_u * n_v_z - L_uv * n_z - L_v * n_u_z)
    t5 = 2 * L_v
    y_vv_x = c_x + t4 * (N_vv_x - L_vv * n_x - n_v_x * t5)
    y_vv_y = c_y + t4 * (N_vv_y - L_vv * n_y - n_v_y * t5)
    y_vv_z = c_z + t4 * (N_vv_z - L_vv * n_z - n_v_z * t5)
    return (
        Vector(y_x, y_y, y_z),
        Vector(y_u_x, y_u_y, y_u_z),
        Vector(y_v_x, y_v_y, y_v_z),
        Vector(y_uu_x, y_uu_y, y_uu_z),
        Vector(y_uv_x, y_uv_y, y_uv_z),
        Vector(y_vv_x, y_vv_y, y_vv_z),
    )


@inline
def offset_side(patch, n, R):
    """A number D with the sign of the product of the normals of a surface and of its offset by
    R: the determinant of the first fundamental form minus R times the second one, from first
    and second derivatives of the surface and its unit normal n.

        D = (|d|**2 - R*a·n)*(|e|**2 - R*c·n) - (d·e - R*b·n)**2

    Source: beyond the paper; 51 operations as written, 51 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    n_x, n_y, n_z = n
    D = (d_x * d_x - R * (a_x * n_x + a_y * n_y + a_z * n_z) + d_y * d_y + d_z * d_z) * (
        e_x * e_x - R * (c_x * n_x + c_y * n_y + c_z * n_z) + e_y * e_y + e_z * e_z
    ) - (d_x * e_x - R * (b_x * n_x + b_y * n_y + b_z * n_z) + d_y * e_y + d_z * e_z) * (
        d_x * e_x - R * (b_x * n_x + b_y * n_y + b_z * n_z) + d_y * e_y + d_z * e_z
    )
    return D


@inline
def torus_normal(R, r, x):
    """The quotient q of x_u × x_v and the unit vector with the longitude u and the latitude v,
    on a torus with the radii R and r, a sphere if R = 0; x is the cosine of v.

        q = r*(R + r*x)

    Source: beyond the paper; 3 operations as written, 3 here.
    """
    q = r * (R + r * x)
    return q


@inline
def cone_normal(R, x, y):
    """The quotient q of x_u × x_v and the unit vector with the longitude u and the latitude
    that is minus the half angle, on a cone whose radius is R where v = 0, or a cylinder; x is
    the sine of the half angle, y is v.

        q = R + x*y

    Source: beyond the paper; 2 operations as written, 2 here.
    """
    q = R + x * y
    return q
