"""Taylor polynomials in two variables: the formulas of symbolic/taylor.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from .vectors import inline


@inline
def product_2(a, b):
    """The Taylor coefficients c of the product of two functions, up to order 2.

        c_0 = a_0*b_0
        c_u = a_0*b_u + a_u*b_0
        c_v = a_0*b_v + a_v*b_0
        c_uu = a_0*b_uu + a_u*b_u + a_uu*b_0
        c_uv = a_0*b_uv + a_u*b_v + a_uv*b_0 + a_v*b_u
        c_vv = a_0*b_vv + a_v*b_v + a_vv*b_0

    Source: beyond the paper; 24 operations as written, 24 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv = a
    b_0, b_u, b_v, b_uu, b_uv, b_vv = b
    c_0 = a_0 * b_0
    c_u = a_0 * b_u + a_u * b_0
    c_v = a_0 * b_v + a_v * b_0
    c_uu = a_0 * b_uu + a_u * b_u + a_uu * b_0
    c_uv = a_0 * b_uv + a_u * b_v + a_uv * b_0 + a_v * b_u
    c_vv = a_0 * b_vv + a_v * b_v + a_vv * b_0
    return c_0, c_u, c_v, c_uu, c_uv, c_vv


@inline
def product_radius_2(a, d, b, e, u):
    """Bounds r of the errors of `product_2` if coefficients of absolute values up to a and b
    have errors up to d and e; u is the unit of rounding.

        s_0 = a_0 + d_0
        s_u = a_u + d_u
        s_v = a_v + d_v
        s_uu = a_uu + d_uu
        s_uv = a_uv + d_uv
        s_vv = a_vv + d_vv
        t_0 = b_0 + e_0
        t_u = b_u + e_u
        t_v = b_v + e_v
        t_uu = b_uu + e_uu
        t_uv = b_uv + e_uv
        t_vv = b_vv + e_vv
        L_0 = s_0*t_0
        L_u = s_0*t_u + s_u*t_0
        L_v = s_0*t_v + s_v*t_0
        L_uu = s_0*t_uu + s_u*t_u + s_uu*t_0
        L_uv = s_0*t_uv + s_u*t_v + s_uv*t_0 + s_v*t_u
        L_vv = s_0*t_vv + s_v*t_v + s_vv*t_0
        r_0 = L_0*u + b_0*d_0 + e_0*s_0
        r_u = 2*L_u*u + b_0*d_u + b_u*d_0 + e_0*s_u + e_u*s_0
        r_v = 2*L_v*u + b_0*d_v + b_v*d_0 + e_0*s_v + e_v*s_0
        r_uu = 3*L_uu*u + b_0*d_uu + b_u*d_u + b_uu*d_0 + e_0*s_uu + e_u*s_u + e_uu*s_0
        r_uv = 4*L_uv*u + b_0*d_uv + b_u*d_v + b_uv*d_0 + b_v*d_u + e_0*s_uv + e_u*s_v
             + e_uv*s_0 + e_v*s_u
        r_vv = 3*L_vv*u + b_0*d_vv + b_v*d_v + b_vv*d_0 + e_0*s_vv + e_v*s_v + e_vv*s_0

    Source: beyond the paper; 107 operations as written, 105 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv = d
    b_0, b_u, b_v, b_uu, b_uv, b_vv = b
    e_0, e_u, e_v, e_uu, e_uv, e_vv = e
    s_0 = a_0 + d_0
    s_u = a_u + d_u
    s_v = a_v + d_v
    s_uu = a_uu + d_uu
    s_uv = a_uv + d_uv
    s_vv = a_vv + d_vv
    t_0 = b_0 + e_0
    t_u = b_u + e_u
    t_v = b_v + e_v
    t_uu = b_uu + e_uu
    t_uv = b_uv + e_uv
    t_vv = b_vv + e_vv
    L_0 = s_0 * t_0
    L_u = s_0 * t_u + s_u * t_0
    L_v = s_0 * t_v + s_v * t_0
    L_uu = s_0 * t_uu + s_u * t_u + s_uu * t_0
    L_uv = s_0 * t_uv + s_u * t_v + s_uv * t_0 + s_v * t_u
    L_vv = s_0 * t_vv + s_v * t_v + s_vv * t_0
    r_0 = L_0 * u + b_0 * d_0 + e_0 * s_0
    t0 = 2 * u
    r_u = L_u * t0 + b_0 * d_u + b_u * d_0 + e_0 * s_u + e_u * s_0
    r_v = L_v * t0 + b_0 * d_v + b_v * d_0 + e_0 * s_v + e_v * s_0
    t1 = 3 * u
    r_uu = L_uu * t1 + b_0 * d_uu + b_u * d_u + b_uu * d_0 + e_0 * s_uu + e_u * s_u + e_uu * s_0
    r_uv = (
        4 * L_uv * u
        + b_0 * d_uv
        + b_u * d_v
        + b_uv * d_0
        + b_v * d_u
        + e_0 * s_uv
        + e_u * s_v
        + e_uv * s_0
        + e_v * s_u
    )
    r_vv = L_vv * t1 + b_0 * d_vv + b_v * d_v + b_vv * d_0 + e_0 * s_vv + e_v * s_v + e_vv * s_0
    return r_0, r_u, r_v, r_uu, r_uv, r_vv


@inline
def composition_2(f1, f2, a):
    """The Taylor coefficients c, from order 1 to 2, of a function of the function with the
    coefficients a; f1, f2, … are those of the outer function at the value of the inner one.

        c_u = a_u*f1
        c_v = a_v*f1
        c_uu = a_u**2*f2 + a_uu*f1
        c_uv = 2*a_u*a_v*f2 + a_uv*f1
        c_vv = a_v**2*f2 + a_vv*f1

    Source: beyond the paper; 15 operations as written, 15 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv = a
    c_u = a_u * f1
    c_v = a_v * f1
    c_uu = a_u * a_u * f2 + a_uu * f1
    c_uv = 2 * a_u * a_v * f2 + a_uv * f1
    c_vv = a_v * a_v * f2 + a_vv * f1
    return c_u, c_v, c_uu, c_uv, c_vv


@inline
def composition_radius_2(f1, f2, g1, g2, a, d, u):
    """Bounds r of the errors of `composition_2` if coefficients of absolute values up to f and
    a have errors up to g and d; u is the unit of rounding.

        s_u = a_u + d_u
        s_v = a_v + d_v
        s_uu = a_uu + d_uu
        s_uv = a_uv + d_uv
        s_vv = a_vv + d_vv
        F1 = f1 + g1
        F2 = f2 + g2
        L_u = F1*s_u
        L_v = F1*s_v
        L_uu = F1*s_uu + F2*s_u**2
        L_uv = F1*s_uv + 2*F2*s_u*s_v
        L_vv = F1*s_vv + F2*s_v**2
        r_u = L_u*u + d_u*f1 + g1*s_u
        r_v = L_v*u + d_v*f1 + g1*s_v
        r_uu = F2*a_u*d_u + F2*d_u*s_u + 3*L_uu*u + a_u**2*g2 + d_uu*f1 + g1*s_uu
        r_uv = 4*L_uv*u + 2*(a_v*d_u*f2 + d_v*f2*s_u + g2*s_u*s_v) + d_uv*f1 + g1*s_uv
        r_vv = F2*a_v*d_v + F2*d_v*s_v + 3*L_vv*u + a_v**2*g2 + d_vv*f1 + g1*s_vv

    Source: beyond the paper; 80 operations as written, 74 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv = d
    s_u = a_u + d_u
    s_v = a_v + d_v
    s_uu = a_uu + d_uu
    s_uv = a_uv + d_uv
    s_vv = a_vv + d_vv
    F1 = f1 + g1
    F2 = f2 + g2
    L_u = F1 * s_u
    L_v = F1 * s_v
    L_uu = F1 * s_uu + F2 * s_u * s_u
    t0 = 2 * s_u
    t1 = s_v * t0
    L_uv = F1 * s_uv + F2 * t1
    L_vv = F1 * s_vv + F2 * s_v * s_v
    r_u = L_u * u + d_u * f1 + g1 * s_u
    r_v = L_v * u + d_v * f1 + g1 * s_v
    t2 = 3 * u
    t3 = F2 * d_u
    r_uu = L_uu * t2 + a_u * a_u * g2 + a_u * t3 + d_uu * f1 + g1 * s_uu + s_u * t3
    r_uv = 4 * L_uv * u + 2 * a_v * d_u * f2 + d_uv * f1 + d_v * f2 * t0 + g1 * s_uv + g2 * t1
    t4 = F2 * d_v
    r_vv = L_vv * t2 + a_v * a_v * g2 + a_v * t4 + d_vv * f1 + g1 * s_vv + s_v * t4
    return r_u, r_v, r_uu, r_uv, r_vv


@inline
def product_3(a, b):
    """The Taylor coefficients c of the product of two functions, up to order 3.

        c_0 = a_0*b_0
        c_u = a_0*b_u + a_u*b_0
        c_v = a_0*b_v + a_v*b_0
        c_uu = a_0*b_uu + a_u*b_u + a_uu*b_0
        c_uv = a_0*b_uv + a_u*b_v + a_uv*b_0 + a_v*b_u
        c_vv = a_0*b_vv + a_v*b_v + a_vv*b_0
        c_uuu = a_0*b_uuu + a_u*b_uu + a_uu*b_u + a_uuu*b_0
        c_uuv = a_0*b_uuv + a_u*b_uv + a_uu*b_v + a_uuv*b_0 + a_uv*b_u + a_v*b_uu
        c_uvv = a_0*b_uvv + a_u*b_vv + a_uv*b_v + a_uvv*b_0 + a_v*b_uv + a_vv*b_u
        c_vvv = a_0*b_vvv + a_v*b_vv + a_vv*b_v + a_vvv*b_0

    Source: beyond the paper; 60 operations as written, 60 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv, a_uuu, a_uuv, a_uvv, a_vvv = a
    b_0, b_u, b_v, b_uu, b_uv, b_vv, b_uuu, b_uuv, b_uvv, b_vvv = b
    c_0 = a_0 * b_0
    c_u = a_0 * b_u + a_u * b_0
    c_v = a_0 * b_v + a_v * b_0
    c_uu = a_0 * b_uu + a_u * b_u + a_uu * b_0
    c_uv = a_0 * b_uv + a_u * b_v + a_uv * b_0 + a_v * b_u
    c_vv = a_0 * b_vv + a_v * b_v + a_vv * b_0
    c_uuu = a_0 * b_uuu + a_u * b_uu + a_uu * b_u + a_uuu * b_0
    c_uuv = a_0 * b_uuv + a_u * b_uv + a_uu * b_v + a_uuv * b_0 + a_uv * b_u + a_v * b_uu
    c_uvv = a_0 * b_uvv + a_u * b_vv + a_uv * b_v + a_uvv * b_0 + a_v * b_uv + a_vv * b_u
    c_vvv = a_0 * b_vvv + a_v * b_vv + a_vv * b_v + a_vvv * b_0
    return c_0, c_u, c_v, c_uu, c_uv, c_vv, c_uuu, c_uuv, c_uvv, c_vvv


@inline
def product_radius_3(a, d, b, e, u):
    """Bounds r of the errors of `product_3` if coefficients of absolute values up to a and b
    have errors up to d and e; u is the unit of rounding.

        s_0 = a_0 + d_0
        s_u = a_u + d_u
        s_v = a_v + d_v
        s_uu = a_uu + d_uu
        s_uv = a_uv + d_uv
        s_vv = a_vv + d_vv
        s_uuu = a_uuu + d_uuu
        s_uuv = a_uuv + d_uuv
        s_uvv = a_uvv + d_uvv
        s_vvv = a_vvv + d_vvv
        t_0 = b_0 + e_0
        t_u = b_u + e_u
        t_v = b_v + e_v
        t_uu = b_uu + e_uu
        t_uv = b_uv + e_uv
        t_vv = b_vv + e_vv
        t_uuu = b_uuu + e_uuu
        t_uuv = b_uuv + e_uuv
        t_uvv = b_uvv + e_uvv
        t_vvv = b_vvv + e_vvv
        L_0 = s_0*t_0
        L_u = s_0*t_u + s_u*t_0
        L_v = s_0*t_v + s_v*t_0
        L_uu = s_0*t_uu + s_u*t_u + s_uu*t_0
        L_uv = s_0*t_uv + s_u*t_v + s_uv*t_0 + s_v*t_u
        L_vv = s_0*t_vv + s_v*t_v + s_vv*t_0
        L_uuu = s_0*t_uuu + s_u*t_uu + s_uu*t_u + s_uuu*t_0
        L_uuv = s_0*t_uuv + s_u*t_uv + s_uu*t_v + s_uuv*t_0 + s_uv*t_u + s_v*t_uu
        L_uvv = s_0*t_uvv + s_u*t_vv + s_uv*t_v + s_uvv*t_0 + s_v*t_uv + s_vv*t_u
        L_vvv = s_0*t_vvv + s_v*t_vv + s_vv*t_v + s_vvv*t_0
        r_0 = L_0*u + b_0*d_0 + e_0*s_0
        r_u = 2*L_u*u + b_0*d_u + b_u*d_0 + e_0*s_u + e_u*s_0
        r_v = 2*L_v*u + b_0*d_v + b_v*d_0 + e_0*s_v + e_v*s_0
        r_uu = 3*L_uu*u + b_0*d_uu + b_u*d_u + b_uu*d_0 + e_0*s_uu + e_u*s_u + e_uu*s_0
        r_uv = 4*L_uv*u + b_0*d_uv + b_u*d_v + b_uv*d_0 + b_v*d_u + e_0*s_uv + e_u*s_v
             + e_uv*s_0 + e_v*s_u
        r_vv = 3*L_vv*u + b_0*d_vv + b_v*d_v + b_vv*d_0 + e_0*s_vv + e_v*s_v + e_vv*s_0
        r_uuu = 4*L_uuu*u + b_0*d_uuu + b_u*d_uu + b_uu*d_u + b_uuu*d_0 + e_0*s_uuu + e_u*s_uu
              + e_uu*s_u + e_uuu*s_0
        r_uuv = 6*L_uuv*u + b_0*d_uuv + b_u*d_uv + b_uu*d_v + b_uuv*d_0 + b_uv*d_u + b_v*d_uu
              + e_0*s_uuv + e_u*s_uv + e_uu*s_v + e_uuv*s_0 + e_uv*s_u + e_v*s_uu
        r_uvv = 6*L_uvv*u + b_0*d_uvv + b_u*d_vv + b_uv*d_v + b_uvv*d_0 + b_v*d_uv + b_vv*d_u
              + e_0*s_uvv + e_u*s_vv + e_uv*s_v + e_uvv*s_0 + e_v*s_uv + e_vv*s_u
        r_vvv = 4*L_vvv*u + b_0*d_vvv + b_v*d_vv + b_vv*d_v + b_vvv*d_0 + e_0*s_vvv + e_v*s_vv
              + e_vv*s_v + e_vvv*s_0

    Source: beyond the paper; 239 operations as written, 234 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv, a_uuu, a_uuv, a_uvv, a_vvv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv, d_uuu, d_uuv, d_uvv, d_vvv = d
    b_0, b_u, b_v, b_uu, b_uv, b_vv, b_uuu, b_uuv, b_uvv, b_vvv = b
    e_0, e_u, e_v, e_uu, e_uv, e_vv, e_uuu, e_uuv, e_uvv, e_vvv = e
    s_0 = a_0 + d_0
    s_u = a_u + d_u
    s_v = a_v + d_v
    s_uu = a_uu + d_uu
    s_uv = a_uv + d_uv
    s_vv = a_vv + d_vv
    s_uuu = a_uuu + d_uuu
    s_uuv = a_uuv + d_uuv
    s_uvv = a_uvv + d_uvv
    s_vvv = a_vvv + d_vvv
    t_0 = b_0 + e_0
    t_u = b_u + e_u
    t_v = b_v + e_v
    t_uu = b_uu + e_uu
    t_uv = b_uv + e_uv
    t_vv = b_vv + e_vv
    t_uuu = b_uuu + e_uuu
    t_uuv = b_uuv + e_uuv
    t_uvv = b_uvv + e_uvv
    t_vvv = b_vvv + e_vvv
    L_0 = s_0 * t_0
    L_u = s_0 * t_u + s_u * t_0
    L_v = s_0 * t_v + s_v * t_0
    L_uu = s_0 * t_uu + s_u * t_u + s_uu * t_0
    L_uv = s_0 * t_uv + s_u * t_v + s_uv * t_0 + s_v * t_u
    L_vv = s_0 * t_vv + s_v * t_v + s_vv * t_0
    L_uuu = s_0 * t_uuu + s_u * t_uu + s_uu * t_u + s_uuu * t_0
    L_uuv = s_0 * t_uuv + s_u * t_uv + s_uu * t_v + s_uuv * t_0 + s_uv * t_u + s_v * t_uu
    L_uvv = s_0 * t_uvv + s_u * t_vv + s_uv * t_v + s_uvv * t_0 + s_v * t_uv + s_vv * t_u
    L_vvv = s_0 * t_vvv + s_v * t_vv + s_vv * t_v + s_vvv * t_0
    r_0 = L_0 * u + b_0 * d_0 + e_0 * s_0
    t0 = 2 * u
    r_u = L_u * t0 + b_0 * d_u + b_u * d_0 + e_0 * s_u + e_u * s_0
    r_v = L_v * t0 + b_0 * d_v + b_v * d_0 + e_0 * s_v + e_v * s_0
    t1 = 3 * u
    r_uu = L_uu * t1 + b_0 * d_uu + b_u * d_u + b_uu * d_0 + e_0 * s_uu + e_u * s_u + e_uu * s_0
    t2 = 4 * u
    r_uv = (
        L_uv * t2
        + b_0 * d_uv
        + b_u * d_v
        + b_uv * d_0
        + b_v * d_u
        + e_0 * s_uv
        + e_u * s_v
        + e_uv * s_0
        + e_v * s_u
    )
    r_vv = L_vv * t1 + b_0 * d_vv + b_v * d_v + b_vv * d_0 + e_0 * s_vv + e_v * s_v + e_vv * s_0
    r_uuu = (
        L_uuu * t2
        + b_0 * d_uuu
        + b_u * d_uu
        + b_uu * d_u
        + b_uuu * d_0
        + e_0 * s_uuu
        + e_u * s_uu
        + e_uu * s_u
        + e_uuu * s_0
    )
    t3 = 6 * u
    r_uuv = (
        L_uuv * t3
        + b_0 * d_uuv
        + b_u * d_uv
        + b_uu * d_v
        + b_uuv * d_0
        + b_uv * d_u
        + b_v * d_uu
        + e_0 * s_uuv
        + e_u * s_uv
        + e_uu * s_v
        + e_uuv * s_0
        + e_uv * s_u
        + e_v * s_uu
    )
    r_uvv = (
        L_uvv * t3
        + b_0 * d_uvv
        + b_u * d_vv
        + b_uv * d_v
        + b_uvv * d_0
        + b_v * d_uv
        + b_vv * d_u
        + e_0 * s_uvv
        + e_u * s_vv
        + e_uv * s_v
        + e_uvv * s_0
        + e_v * s_uv
        + e_vv * s_u
    )
    r_vvv = (
        L_vvv * t2
        + b_0 * d_vvv
        + b_v * d_vv
        + b_vv * d_v
        + b_vvv * d_0
        + e_0 * s_vvv
        + e_v * s_vv
        + e_vv * s_v
        + e_vvv * s_0
    )
    return r_0, r_u, r_v, r_uu, r_uv, r_vv, r_uuu, r_uuv, r_uvv, r_vvv


@inline
def composition_3(f1, f2, f3, a):
    """The Taylor coefficients c, from order 1 to 3, of a function of the function with the
    coefficients a; f1, f2, … are those of the outer function at the value of the inner one.

        c_u = a_u*f1
        c_v = a_v*f1
        c_uu = a_u**2*f2 + a_uu*f1
        c_uv = 2*a_u*a_v*f2 + a_uv*f1
        c_vv = a_v**2*f2 + a_vv*f1
        c_uuu = a_u**3*f3 + 2*a_u*a_uu*f2 + a_uuu*f1
        c_uuv = 3*a_u**2*a_v*f3 + 2*a_u*a_uv*f2 + 2*a_uu*a_v*f2 + a_uuv*f1
        c_uvv = 3*a_u*a_v**2*f3 + 2*a_u*a_vv*f2 + 2*a_uv*a_v*f2 + a_uvv*f1
        c_vvv = a_v**3*f3 + 2*a_v*a_vv*f2 + a_vvv*f1

    Source: beyond the paper; 61 operations as written, 48 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv, a_uuu, a_uuv, a_uvv, a_vvv = a
    c_u = a_u * f1
    c_v = a_v * f1
    t0 = a_u * a_u
    c_uu = a_uu * f1 + f2 * t0
    t1 = 2 * a_u * f2
    c_uv = a_uv * f1 + a_v * t1
    t2 = a_v * a_v
    c_vv = a_vv * f1 + f2 * t2
    c_uuu = a_u * a_u * a_u * f3 + a_uu * t1 + a_uuu * f1
    t3 = 2 * a_v * f2
    t4 = 3 * f3
    c_uuv = a_uu * t3 + a_uuv * f1 + a_uv * t1 + a_v * t0 * t4
    c_uvv = a_u * t2 * t4 + a_uv * t3 + a_uvv * f1 + a_vv * t1
    c_vvv = a_v * a_v * a_v * f3 + a_vv * t3 + a_vvv * f1
    return c_u, c_v, c_uu, c_uv, c_vv, c_uuu, c_uuv, c_uvv, c_vvv


@inline
def composition_radius_3(f1, f2, f3, g1, g2, g3, a, d, u):
    """Bounds r of the errors of `composition_3` if coefficients of absolute values up to f and
    a have errors up to g and d; u is the unit of rounding.

        s_u = a_u + d_u
        s_v = a_v + d_v
        s_uu = a_uu + d_uu
        s_uv = a_uv + d_uv
        s_vv = a_vv + d_vv
        s_uuu = a_uuu + d_uuu
        s_uuv = a_uuv + d_uuv
        s_uvv = a_uvv + d_uvv
        s_vvv = a_vvv + d_vvv
        F1 = f1 + g1
        F2 = f2 + g2
        F3 = f3 + g3
        L_u = F1*s_u
        L_v = F1*s_v
        L_uu = F1*s_uu + F2*s_u**2
        L_uv = F1*s_uv + 2*F2*s_u*s_v
        L_vv = F1*s_vv + F2*s_v**2
        L_uuu = F1*s_uuu + 2*F2*s_u*s_uu + F3*s_u**3
        L_uuv = F1*s_uuv + 2*F2*s_u*s_uv + 2*F2*s_uu*s_v + 3*F3*s_u**2*s_v
        L_uvv = F1*s_uvv + 2*F2*s_u*s_vv + 2*F2*s_uv*s_v + 3*F3*s_u*s_v**2
        L_vvv = F1*s_vvv + 2*F2*s_v*s_vv + F3*s_v**3
        r_u = L_u*u + d_u*f1 + g1*s_u
        r_v = L_v*u + d_v*f1 + g1*s_v
        r_uu = F2*a_u*d_u + F2*d_u*s_u + 3*L_uu*u + a_u**2*g2 + d_uu*f1 + g1*s_uu
        r_uv = 4*L_uv*u + 2*(a_v*d_u*f2 + d_v*f2*s_u + g2*s_u*s_v) + d_uv*f1 + g1*s_uv
        r_vv = F2*a_v*d_v + F2*d_v*s_v + 3*L_vv*u + a_v**2*g2 + d_vv*f1 + g1*s_vv
        r_uuu = F3*a_u**2*d_u + F3*a_u*d_u*s_u + F3*d_u*s_u**2 + 5*L_uuu*u + a_u**3*g3
              + 2*(a_uu*d_u*f2 + d_uu*f2*s_u + g2*s_u*s_uu) + d_uuu*f1 + g1*s_uuu
        r_uuv = 3*(F3*a_u*d_u*s_v + F3*d_u*s_u*s_v + a_u**2*d_v*f3 + a_u**2*g3*s_v) + 7*L_uuv*u
              + 2*(a_uv*d_u*f2 + a_v*d_uu*f2 + d_uv*f2*s_u + d_v*f2*s_uu + g2*s_u*s_uv
              + g2*s_uu*s_v) + d_uuv*f1 + g1*s_uuv
        r_uvv = 3*(F3*a_v*d_v*s_u + F3*d_v*s_u*s_v + a_v**2*d_u*f3 + a_v**2*g3*s_u) + 7*L_uvv*u
              + 2*(a_v*d_uv*f2 + a_vv*d_u*f2 + d_v*f2*s_uv + d_vv*f2*s_u + g2*s_u*s_vv
              + g2*s_uv*s_v) + d_uvv*f1 + g1*s_uvv
        r_vvv = F3*a_v**2*d_v + F3*a_v*d_v*s_v + F3*d_v*s_v**2 + 5*L_vvv*u + a_v**3*g3
              + 2*(a_vv*d_v*f2 + d_vv*f2*s_v + g2*s_v*s_vv) + d_vvv*f1 + g1*s_vvv

    Source: beyond the paper; 299 operations as written, 227 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv, a_uuu, a_uuv, a_uvv, a_vvv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv, d_uuu, d_uuv, d_uvv, d_vvv = d
    s_u = a_u + d_u
    s_v = a_v + d_v
    s_uu = a_uu + d_uu
    s_uv = a_uv + d_uv
    s_vv = a_vv + d_vv
    s_uuu = a_uuu + d_uuu
    s_uuv = a_uuv + d_uuv
    s_uvv = a_uvv + d_uvv
    s_vvv = a_vvv + d_vvv
    F1 = f1 + g1
    F2 = f2 + g2
    F3 = f3 + g3
    L_u = F1 * s_u
    L_v = F1 * s_v
    t0 = s_u * s_u
    L_uu = F1 * s_uu + F2 * t0
    t1 = 2 * s_u
    t2 = F2 * t1
    L_uv = F1 * s_uv + s_v * t2
    t3 = s_v * s_v
    L_vv = F1 * s_vv + F2 * t3
    L_uuu = F1 * s_uuu + F3 * s_u * s_u * s_u + s_uu * t2
    t4 = 2 * s_uu
    t5 = F2 * s_v
    t6 = 3 * F3
    L_uuv = F1 * s_uuv + s_uv * t2 + s_v * t0 * t6 + t4 * t5
    t7 = 2 * t5
    L_uvv = F1 * s_uvv + s_u * t3 * t6 + s_uv * t7 + s_vv * t2
    L_vvv = F1 * s_vvv + F3 * s_v * s_v * s_v + s_vv * t7
    r_u = L_u * u + d_u * f1 + g1 * s_u
    r_v = L_v * u + d_v * f1 + g1 * s_v
    t8 = 3 * u
    t9 = F2 * d_u
    t10 = a_u * a_u
    r_uu = L_uu * t8 + a_u * t9 + d_uu * f1 + g1 * s_uu + g2 * t10 + s_u * t9
    t11 = 2 * f2
    t12 = d_u * t11
    t13 = f2 * t1
    t14 = g2 * t1
    r_uv = 4 * L_uv * u + a_v * t12 + d_uv * f1 + d_v * t13 + g1 * s_uv + s_v * t14
    t15 = F2 * d_v
    t16 = a_v * a_v
    r_vv = L_vv * t8 + a_v * t15 + d_vv * f1 + g1 * s_vv + g2 * t16 + s_v * t15
    t17 = 5 * u
    t18 = F3 * d_u
    t19 = a_u * t18
    r_uuu = (
        L_uuu * t17
        + a_u * a_u * a_u * g3
        + a_uu * t12
        + d_uu * t13
        + d_uuu * f1
        + g1 * s_uuu
        + s_u * t19
        + s_uu * t14
        + t0 * t18
        + t10 * t18
    )
    t20 = 7 * u
    t21 = a_v * t11
    t22 = g2 * s_v
    t23 = 3 * s_v
    t24 = s_u * t23
    t25 = 3 * t10
    r_uuv = (
        L_uuv * t20
        + a_uv * t12
        + d_uu * t21
        + d_uuv * f1
        + d_uv * t13
        + d_v * f2 * t4
        + d_v * f3 * t25
        + g1 * s_uuv
        + g3 * s_v * t25
        + s_uv * t14
        + t18 * t24
        + t19 * t23
        + t22 * t4
    )
    t26 = d_v * t11
    t27 = 2 * t22
    t28 = F3 * d_v
    t29 = a_v * t28
    t30 = 3 * t16
    r_uvv = (
        L_uvv * t20
        + a_vv * t12
        + d_u * f3 * t30
        + d_uv * t21
        + d_uvv * f1
        + d_vv * t13
        + g1 * s_uvv
        + g3 * s_u * t30
        + 3 * s_u * t29
        + s_uv * t26
        + s_uv * t27
        + s_vv * t14
        + t24 * t28
    )
    r_vvv = (
        L_vvv * t17
        + a_v * a_v * a_v * g3
        + a_vv * t26
        + d_vv * s_v * t11
        + d_vvv * f1
        + g1 * s_vvv
        + s_v * t29
        + s_vv * t27
        + t16 * t28
        + t28 * t3
    )
    return r_u, r_v, r_uu, r_uv, r_vv, r_uuu, r_uuv, r_uvv, r_vvv
