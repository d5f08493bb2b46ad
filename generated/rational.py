"""Rational surfaces: the formulas of symbolic/rational.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from .vectors import Vector, inline


@inline
def rational_jet(A, A_u, A_v, A_uu, A_uv, A_vv, w, w_u, w_v, w_uu, w_uv, w_vv):
    """The point x = A/w of a rational surface and its first and second derivatives, from those
    of the numerator A and the denominator w.

        r = 1/w
        x = A*r
        x_u = r*(A_u - w_u*x)
        x_v = r*(A_v - w_v*x)
        x_uu = r*(A_uu - 2*w_u*x_u - w_uu*x)
        x_uv = r*(A_uv - w_u*x_v - w_uv*x - w_v*x_u)
        x_vv = r*(A_vv - 2*w_v*x_v - w_vv*x)

    Source: beyond the paper; Piegl & Tiller, The NURBS Book, eqs. (4.19) and (4.20); 79
    operations as written, 75 here.
    """
    A_x, A_y, A_z = A
    A_u_x, A_u_y, A_u_z = A_u
    A_v_x, A_v_y, A_v_z = A_v
    A_uu_x, A_uu_y, A_uu_z = A_uu
    A_uv_x, A_uv_y, A_uv_z = A_uv
    A_vv_x, A_vv_y, A_vv_z = A_vv
    r = 1.0 / w
    x_x = A_x * r
    x_y = A_y * r
    x_z = A_z * r
    x_u_x = r * (A_u_x - w_u * x_x)
    x_u_y = r * (A_u_y - w_u * x_y)
    x_u_z = r * (A_u_z - w_u * x_z)
    x_v_x = r * (A_v_x - w_v * x_x)
    x_v_y = r * (A_v_y - w_v * x_y)
    x_v_z = r * (A_v_z - w_v * x_z)
    t0 = 2 * w_u
    x_uu_x = r * (A_uu_x - t0 * x_u_x - w_uu * x_x)
    x_uu_y = r * (A_uu_y - t0 * x_u_y - w_uu * x_y)
    x_uu_z = r * (A_uu_z - t0 * x_u_z - w_uu * x_z)
    x_uv_x = r * (A_uv_x - w_u * x_v_x - w_uv * x_x - w_v * x_u_x)
    x_uv_y = r * (A_uv_y - w_u * x_v_y - w_uv * x_y - w_v * x_u_y)
    x_uv_z = r * (A_uv_z - w_u * x_v_z - w_uv * x_z - w_v * x_u_z)
    t1 = 2 * w_v
    x_vv_x = r * (A_vv_x - t1 * x_v_x - w_vv * x_x)
    x_vv_y = r * (A_vv_y - t1 * x_v_y - w_vv * x_y)
    x_vv_z = r * (A_vv_z - t1 * x_v_z - w_vv * x_z)
    return (
        Vector(x_x, x_y, x_z),
        Vector(x_u_x, x_u_y, x_u_z),
        Vector(x_v_x, x_v_y, x_v_z),
        Vector(x_uu_x, x_uu_y, x_uu_z),
        Vector(x_uv_x, x_uv_y, x_uv_z),
        Vector(x_vv_x, x_vv_y, x_vv_z),
    )
