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

        r_0 = b_0*d_0 + e_0*(a_0 + d_0) + u*(a_0 + d_0)*(b_0 + e_0)
        r_u = b_0*d_u + b_u*d_0 + e_0*(a_u + d_u) + e_u*(a_0 + d_0)
            + 2*u*((a_0 + d_0)*(b_u + e_u) + (a_u + d_u)*(b_0 + e_0))
        r_v = b_0*d_v + b_v*d_0 + e_0*(a_v + d_v) + e_v*(a_0 + d_0)
            + 2*u*((a_0 + d_0)*(b_v + e_v) + (a_v + d_v)*(b_0 + e_0))
        r_uu = b_0*d_uu + b_u*d_u + b_uu*d_0 + e_0*(a_uu + d_uu) + e_u*(a_u + d_u)
             + e_uu*(a_0 + d_0)
             + 3*u*((a_0 + d_0)*(b_uu + e_uu) + (a_u + d_u)*(b_u + e_u) + (a_uu + d_uu)*(b_0 + e_0))
        r_uv = b_0*d_uv + b_u*d_v + b_uv*d_0 + b_v*d_u + e_0*(a_uv + d_uv) + e_u*(a_v + d_v)
             + e_uv*(a_0 + d_0) + e_v*(a_u + d_u)
             + 4*u*((a_0 + d_0)*(b_uv + e_uv) + (a_u + d_u)*(b_v + e_v) + (a_uv + d_uv)*(b_0 + e_0) + (a_v + d_v)*(b_u + e_u))
        r_vv = b_0*d_vv + b_v*d_v + b_vv*d_0 + e_0*(a_vv + d_vv) + e_v*(a_v + d_v)
             + e_vv*(a_0 + d_0)
             + 3*u*((a_0 + d_0)*(b_vv + e_vv) + (a_v + d_v)*(b_v + e_v) + (a_vv + d_vv)*(b_0 + e_0))

    Source: beyond the paper; 140 operations as written, 105 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv = d
    b_0, b_u, b_v, b_uu, b_uv, b_vv = b
    e_0, e_u, e_v, e_uu, e_uv, e_vv = e
    t0 = a_0 + d_0
    t1 = b_0 + e_0
    r_0 = b_0 * d_0 + e_0 * t0 + t0 * t1 * u
    t2 = a_u + d_u
    t3 = b_u + e_u
    t4 = 2 * u
    r_u = b_0 * d_u + b_u * d_0 + e_0 * t2 + e_u * t0 + t4 * (t0 * t3 + t1 * t2)
    t5 = a_v + d_v
    t6 = b_v + e_v
    r_v = b_0 * d_v + b_v * d_0 + e_0 * t5 + e_v * t0 + t4 * (t0 * t6 + t1 * t5)
    t7 = a_uu + d_uu
    t8 = 3 * u
    r_uu = (
        b_0 * d_uu
        + b_u * d_u
        + b_uu * d_0
        + e_0 * t7
        + e_u * t2
        + e_uu * t0
        + t8 * (t0 * (b_uu + e_uu) + t1 * t7 + t2 * t3)
    )
    t9 = a_uv + d_uv
    r_uv = (
        b_0 * d_uv
        + b_u * d_v
        + b_uv * d_0
        + b_v * d_u
        + e_0 * t9
        + e_u * t5
        + e_uv * t0
        + e_v * t2
        + 4 * u * (t0 * (b_uv + e_uv) + t1 * t9 + t2 * t6 + t3 * t5)
    )
    t10 = a_vv + d_vv
    r_vv = (
        b_0 * d_vv
        + b_v * d_v
        + b_vv * d_0
        + e_0 * t10
        + e_v * t5
        + e_vv * t0
        + t8 * (t0 * (b_vv + e_vv) + t1 * t10 + t5 * t6)
    )
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

        r_u = d_u*f1 + g1*(a_u + d_u) + u*(a_u + d_u)*(f1 + g1)
        r_v = d_v*f1 + g1*(a_v + d_v) + u*(a_v + d_v)*(f1 + g1)
        r_uu = a_u**2*g2 + a_u*d_u*(f2 + g2) + d_u*(a_u + d_u)*(f2 + g2) + d_uu*f1
             + g1*(a_uu + d_uu) + 3*u*((a_u + d_u)**2*(f2 + g2) + (a_uu + d_uu)*(f1 + g1))
        r_uv = 2*(a_v*d_u*f2 + d_v*f2*(a_u + d_u) + g2*(a_u + d_u)*(a_v + d_v)) + d_uv*f1
             + g1*(a_uv + d_uv)
             + 4*u*(2*(a_u + d_u)*(a_v + d_v)*(f2 + g2) + (a_uv + d_uv)*(f1 + g1))
        r_vv = a_v**2*g2 + a_v*d_v*(f2 + g2) + d_v*(a_v + d_v)*(f2 + g2) + d_vv*f1
             + g1*(a_vv + d_vv) + 3*u*((a_v + d_v)**2*(f2 + g2) + (a_vv + d_vv)*(f1 + g1))

    Source: beyond the paper; 106 operations as written, 73 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv = d
    t0 = a_u + d_u
    t1 = f1 + g1
    t2 = t1 * u
    r_u = d_u * f1 + g1 * t0 + t0 * t2
    t3 = a_v + d_v
    r_v = d_v * f1 + g1 * t3 + t2 * t3
    t4 = a_uu + d_uu
    t5 = f2 + g2
    t6 = d_u * t5
    t7 = 3 * u
    r_uu = a_u * a_u * g2 + a_u * t6 + d_uu * f1 + g1 * t4 + t0 * t6 + t7 * (t0 * t0 * t5 + t1 * t4)
    t8 = a_uv + d_uv
    t9 = 2 * t0
    t10 = t3 * t9
    r_uv = (
        2 * a_v * d_u * f2
        + d_uv * f1
        + d_v * f2 * t9
        + g1 * t8
        + g2 * t10
        + 4 * u * (t1 * t8 + t10 * t5)
    )
    t11 = a_vv + d_vv
    t12 = d_v * t5
    r_vv = (
        a_v * a_v * g2
        + a_v * t12
        + d_vv * f1
        + g1 * t11
        + t12 * t3
        + t7 * (t1 * t11 + t3 * t3 * t5)
    )
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

        r_0 = b_0*d_0 + e_0*(a_0 + d_0) + u*(a_0 + d_0)*(b_0 + e_0)
        r_u = b_0*d_u + b_u*d_0 + e_0*(a_u + d_u) + e_u*(a_0 + d_0)
            + 2*u*((a_0 + d_0)*(b_u + e_u) + (a_u + d_u)*(b_0 + e_0))
        r_v = b_0*d_v + b_v*d_0 + e_0*(a_v + d_v) + e_v*(a_0 + d_0)
            + 2*u*((a_0 + d_0)*(b_v + e_v) + (a_v + d_v)*(b_0 + e_0))
        r_uu = b_0*d_uu + b_u*d_u + b_uu*d_0 + e_0*(a_uu + d_uu) + e_u*(a_u + d_u)
             + e_uu*(a_0 + d_0)
             + 3*u*((a_0 + d_0)*(b_uu + e_uu) + (a_u + d_u)*(b_u + e_u) + (a_uu + d_uu)*(b_0 + e_0))
        r_uv = b_0*d_uv + b_u*d_v + b_uv*d_0 + b_v*d_u + e_0*(a_uv + d_uv) + e_u*(a_v + d_v)
             + e_uv*(a_0 + d_0) + e_v*(a_u + d_u)
             + 4*u*((a_0 + d_0)*(b_uv + e_uv) + (a_u + d_u)*(b_v + e_v) + (a_uv + d_uv)*(b_0 + e_0) + (a_v + d_v)*(b_u + e_u))
        r_vv = b_0*d_vv + b_v*d_v + b_vv*d_0 + e_0*(a_vv + d_vv) + e_v*(a_v + d_v)
             + e_vv*(a_0 + d_0)
             + 3*u*((a_0 + d_0)*(b_vv + e_vv) + (a_v + d_v)*(b_v + e_v) + (a_vv + d_vv)*(b_0 + e_0))
        r_uuu = b_0*d_uuu + b_u*d_uu + b_uu*d_u + b_uuu*d_0 + e_0*(a_uuu + d_uuu)
              + e_u*(a_uu + d_uu) + e_uu*(a_u + d_u) + e_uuu*(a_0 + d_0)
              + 4*u*((a_0 + d_0)*(b_uuu + e_uuu) + (a_u + d_u)*(b_uu + e_uu) + (a_uu + d_uu)*(b_u + e_u) + (a_uuu + d_uuu)*(b_0 + e_0))
        r_uuv = b_0*d_uuv + b_u*d_uv + b_uu*d_v + b_uuv*d_0 + b_uv*d_u + b_v*d_uu
              + e_0*(a_uuv + d_uuv) + e_u*(a_uv + d_uv) + e_uu*(a_v + d_v) + e_uuv*(a_0 + d_0)
              + e_uv*(a_u + d_u) + e_v*(a_uu + d_uu)
              + 6*u*((a_0 + d_0)*(b_uuv + e_uuv) + (a_u + d_u)*(b_uv + e_uv) + (a_uu + d_uu)*(b_v + e_v) + (a_uuv + d_uuv)*(b_0 + e_0) + (a_uv + d_uv)*(b_u + e_u) + (a_v + d_v)*(b_uu + e_uu))
        r_uvv = b_0*d_uvv + b_u*d_vv + b_uv*d_v + b_uvv*d_0 + b_v*d_uv + b_vv*d_u
              + e_0*(a_uvv + d_uvv) + e_u*(a_vv + d_vv) + e_uv*(a_v + d_v) + e_uvv*(a_0 + d_0)
              + e_v*(a_uv + d_uv) + e_vv*(a_u + d_u)
              + 6*u*((a_0 + d_0)*(b_uvv + e_uvv) + (a_u + d_u)*(b_vv + e_vv) + (a_uv + d_uv)*(b_v + e_v) + (a_uvv + d_uvv)*(b_0 + e_0) + (a_v + d_v)*(b_uv + e_uv) + (a_vv + d_vv)*(b_u + e_u))
        r_vvv = b_0*d_vvv + b_v*d_vv + b_vv*d_v + b_vvv*d_0 + e_0*(a_vvv + d_vvv)
              + e_v*(a_vv + d_vv) + e_vv*(a_v + d_v) + e_vvv*(a_0 + d_0)
              + 4*u*((a_0 + d_0)*(b_vvv + e_vvv) + (a_v + d_v)*(b_vv + e_vv) + (a_vv + d_vv)*(b_v + e_v) + (a_vvv + d_vvv)*(b_0 + e_0))

    Source: beyond the paper; 324 operations as written, 234 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv, a_uuu, a_uuv, a_uvv, a_vvv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv, d_uuu, d_uuv, d_uvv, d_vvv = d
    b_0, b_u, b_v, b_uu, b_uv, b_vv, b_uuu, b_uuv, b_uvv, b_vvv = b
    e_0, e_u, e_v, e_uu, e_uv, e_vv, e_uuu, e_uuv, e_uvv, e_vvv = e
    t0 = a_0 + d_0
    t1 = b_0 + e_0
    r_0 = b_0 * d_0 + e_0 * t0 + t0 * t1 * u
    t2 = a_u + d_u
    t3 = b_u + e_u
    t4 = 2 * u
    r_u = b_0 * d_u + b_u * d_0 + e_0 * t2 + e_u * t0 + t4 * (t0 * t3 + t1 * t2)
    t5 = a_v + d_v
    t6 = b_v + e_v
    r_v = b_0 * d_v + b_v * d_0 + e_0 * t5 + e_v * t0 + t4 * (t0 * t6 + t1 * t5)
    t7 = a_uu + d_uu
    t8 = b_uu + e_uu
    t9 = 3 * u
    r_uu = (
        b_0 * d_uu
        + b_u * d_u
        + b_uu * d_0
        + e_0 * t7
        + e_u * t2
        + e_uu * t0
        + t9 * (t0 * t8 + t1 * t7 + t2 * t3)
    )
    t10 = a_uv + d_uv
    t11 = b_uv + e_uv
    t12 = 4 * u
    r_uv = (
        b_0 * d_uv
        + b_u * d_v
        + b_uv * d_0
        + b_v * d_u
        + e_0 * t10
        + e_u * t5
        + e_uv * t0
        + e_v * t2
        + t12 * (t0 * t11 + t1 * t10 + t2 * t6 + t3 * t5)
    )
    t13 = a_vv + d_vv
    t14 = b_vv + e_vv
    r_vv = (
        b_0 * d_vv
        + b_v * d_v
        + b_vv * d_0
        + e_0 * t13
        + e_v * t5
        + e_vv * t0
        + t9 * (t0 * t14 + t1 * t13 + t5 * t6)
    )
    t15 = a_uuu + d_uuu
    r_uuu = (
        b_0 * d_uuu
        + b_u * d_uu
        + b_uu * d_u
        + b_uuu * d_0
        + e_0 * t15
        + e_u * t7
        + e_uu * t2
        + e_uuu * t0
        + t12 * (t0 * (b_uuu + e_uuu) + t1 * t15 + t2 * t8 + t3 * t7)
    )
    t16 = a_uuv + d_uuv
    t17 = 6 * u
    r_uuv = (
        b_0 * d_uuv
        + b_u * d_uv
        + b_uu * d_v
        + b_uuv * d_0
        + b_uv * d_u
        + b_v * d_uu
        + e_0 * t16
        + e_u * t10
        + e_uu * t5
        + e_uuv * t0
        + e_uv * t2
        + e_v * t7
        + t17 * (t0 * (b_uuv + e_uuv) + t1 * t16 + t10 * t3 + t11 * t2 + t5 * t8 + t6 * t7)
    )
    t18 = a_uvv + d_uvv
    r_uvv = (
        b_0 * d_uvv
        + b_u * d_vv
        + b_uv * d_v
        + b_uvv * d_0
        + b_v * d_uv
        + b_vv * d_u
        + e_0 * t18
        + e_u * t13
        + e_uv * t5
        + e_uvv * t0
        + e_v * t10
        + e_vv * t2
        + t17 * (t0 * (b_uvv + e_uvv) + t1 * t18 + t10 * t6 + t11 * t5 + t13 * t3 + t14 * t2)
    )
    t19 = a_vvv + d_vvv
    r_vvv = (
        b_0 * d_vvv
        + b_v * d_vv
        + b_vv * d_v
        + b_vvv * d_0
        + e_0 * t19
        + e_v * t13
        + e_vv * t5
        + e_vvv * t0
        + t12 * (t0 * (b_vvv + e_vvv) + t1 * t19 + t13 * t6 + t14 * t5)
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

        r_u = d_u*f1 + g1*(a_u + d_u) + u*(a_u + d_u)*(f1 + g1)
        r_v = d_v*f1 + g1*(a_v + d_v) + u*(a_v + d_v)*(f1 + g1)
        r_uu = a_u**2*g2 + a_u*d_u*(f2 + g2) + d_u*(a_u + d_u)*(f2 + g2) + d_uu*f1
             + g1*(a_uu + d_uu) + 3*u*((a_u + d_u)**2*(f2 + g2) + (a_uu + d_uu)*(f1 + g1))
        r_uv = 2*(a_v*d_u*f2 + d_v*f2*(a_u + d_u) + g2*(a_u + d_u)*(a_v + d_v)) + d_uv*f1
             + g1*(a_uv + d_uv)
             + 4*u*(2*(a_u + d_u)*(a_v + d_v)*(f2 + g2) + (a_uv + d_uv)*(f1 + g1))
        r_vv = a_v**2*g2 + a_v*d_v*(f2 + g2) + d_v*(a_v + d_v)*(f2 + g2) + d_vv*f1
             + g1*(a_vv + d_vv) + 3*u*((a_v + d_v)**2*(f2 + g2) + (a_vv + d_vv)*(f1 + g1))
        r_uuu = a_u**3*g3 + a_u**2*d_u*(f3 + g3) + a_u*d_u*(a_u + d_u)*(f3 + g3)
              + 2*(a_uu*d_u*f2 + d_uu*f2*(a_u + d_u) + g2*(a_u + d_u)*(a_uu + d_uu))
              + d_u*(a_u + d_u)**2*(f3 + g3) + d_uuu*f1 + g1*(a_uuu + d_uuu)
              + 5*u*((a_u + d_u)**3*(f3 + g3) + 2*(a_u + d_u)*(a_uu + d_uu)*(f2 + g2) + (a_uuu + d_uuu)*(f1 + g1))
        r_uuv = 3*(a_u**2*d_v*f3 + a_u**2*g3*(a_v + d_v) + a_u*d_u*(a_v + d_v)*(f3 + g3)
              + d_u*(a_u + d_u)*(a_v + d_v)*(f3 + g3)) + 2*(a_uv*d_u*f2 + a_v*d_uu*f2
              + d_uv*f2*(a_u + d_u) + d_v*f2*(a_uu + d_uu) + g2*(a_u + d_u)*(a_uv + d_uv)
              + g2*(a_uu + d_uu)*(a_v + d_v)) + d_uuv*f1 + g1*(a_uuv + d_uuv)
              + 7*u*(3*(a_u + d_u)**2*(a_v + d_v)*(f3 + g3) + 2*(a_u + d_u)*(a_uv + d_uv)*(f2 + g2) + 2*(a_uu + d_uu)*(a_v + d_v)*(f2 + g2) + (a_uuv + d_uuv)*(f1 + g1))
        r_uvv = 3*(a_v**2*d_u*f3 + a_v**2*g3*(a_u + d_u) + a_v*d_v*(a_u + d_u)*(f3 + g3)
              + d_v*(a_u + d_u)*(a_v + d_v)*(f3 + g3)) + 2*(a_v*d_uv*f2 + a_vv*d_u*f2
              + d_v*f2*(a_uv + d_uv) + d_vv*f2*(a_u + d_u) + g2*(a_u + d_u)*(a_vv + d_vv)
              + g2*(a_uv + d_uv)*(a_v + d_v)) + d_uvv*f1 + g1*(a_uvv + d_uvv)
              + 7*u*(3*(a_u + d_u)*(a_v + d_v)**2*(f3 + g3) + 2*(a_u + d_u)*(a_vv + d_vv)*(f2 + g2) + 2*(a_uv + d_uv)*(a_v + d_v)*(f2 + g2) + (a_uvv + d_uvv)*(f1 + g1))
        r_vvv = a_v**3*g3 + a_v**2*d_v*(f3 + g3) + a_v*d_v*(a_v + d_v)*(f3 + g3)
              + 2*(a_vv*d_v*f2 + d_vv*f2*(a_v + d_v) + g2*(a_v + d_v)*(a_vv + d_vv))
              + d_v*(a_v + d_v)**2*(f3 + g3) + d_vvv*f1 + g1*(a_vvv + d_vvv)
              + 5*u*((a_v + d_v)**3*(f3 + g3) + 2*(a_v + d_v)*(a_vv + d_vv)*(f2 + g2) + (a_vvv + d_vvv)*(f1 + g1))

    Source: beyond the paper; 408 operations as written, 224 here.
    """
    a_0, a_u, a_v, a_uu, a_uv, a_vv, a_uuu, a_uuv, a_uvv, a_vvv = a
    d_0, d_u, d_v, d_uu, d_uv, d_vv, d_uuu, d_uuv, d_uvv, d_vvv = d
    t0 = a_u + d_u
    t1 = f1 + g1
    t2 = t1 * u
    r_u = d_u * f1 + g1 * t0 + t0 * t2
    t3 = a_v + d_v
    r_v = d_v * f1 + g1 * t3 + t2 * t3
    t4 = a_u * a_u
    t5 = a_uu + d_uu
    t6 = f2 + g2
    t7 = d_u * t6
    t8 = t0 * t0
    t9 = 3 * u
    r_uu = a_u * t7 + d_uu * f1 + g1 * t5 + g2 * t4 + t0 * t7 + t9 * (t1 * t5 + t6 * t8)
    t10 = a_uv + d_uv
    t11 = 2 * f2
    t12 = d_u * t11
    t13 = 2 * t0
    t14 = f2 * t13
    t15 = t13 * t3
    r_uv = a_v * t12 + d_uv * f1 + d_v * t14 + g1 * t10 + g2 * t15 + 4 * u * (t1 * t10 + t15 * t6)
    t16 = a_v * a_v
    t17 = a_vv + d_vv
    t18 = d_v * t6
    t19 = t3 * t3
    r_vv = a_v * t18 + d_vv * f1 + g1 * t17 + g2 * t16 + t18 * t3 + t9 * (t1 * t17 + t19 * t6)
    t20 = a_uuu + d_uuu
    t21 = f3 + g3
    t22 = d_u * t21
    t23 = t13 * t5
    t24 = a_u * t22
    t25 = 5 * u
    r_uuu = (
        a_u * a_u * a_u * g3
        + a_uu * t12
        + d_uu * t14
        + d_uuu * f1
        + g1 * t20
        + g2 * t23
        + t0 * t24
        + t22 * t4
        + t22 * t8
        + t25 * (t0 * t0 * t0 * t21 + t1 * t20 + t23 * t6)
    )
    t26 = a_uuv + d_uuv
    t27 = a_v * t11
    t28 = 3 * f3
    t29 = d_v * t11
    t30 = 3 * t3
    t31 = t10 * t13
    t32 = 2 * t3
    t33 = t32 * t5
    t34 = t0 * t30
    t35 = 7 * u
    r_uuv = (
        a_uv * t12
        + d_uu * t27
        + d_uuv * f1
        + d_uv * t14
        + d_v * t28 * t4
        + g1 * t26
        + g2 * t31
        + g2 * t33
        + g3 * t30 * t4
        + t22 * t34
        + t24 * t30
        + t29 * t5
        + t35 * (t1 * t26 + t21 * t30 * t8 + t31 * t6 + t33 * t6)
    )
    t36 = a_uvv + d_uvv
    t37 = 3 * t0
    t38 = t13 * t17
    t39 = t10 * t32
    t40 = d_v * t21
    t41 = a_v * t40
    r_uvv = (
        a_vv * t12
        + d_u * t16 * t28
        + d_uv * t27
        + d_uvv * f1
        + d_vv * t14
        + g1 * t36
        + g2 * t38
        + g2 * t39
        + g3 * t16 * t37
        + t10 * t29
        + t34 * t40
        + t35 * (t1 * t36 + t19 * t21 * t37 + t38 * t6 + t39 * t6)
        + t37 * t41
    )
    t42 = a_vvv + d_vvv
    t43 = t17 * t32
    r_vvv = (
        a_v * a_v * a_v * g3
        + a_vv * t29
        + d_vv * t11 * t3
        + d_vvv * f1
        + g1 * t42
        + g2 * t43
        + t16 * t40
        + t19 * t40
        + t25 * (t1 * t42 + t21 * t3 * t3 * t3 + t43 * t6)
        + t3 * t41
    )
    return r_u, r_v, r_uu, r_uv, r_vv, r_uuu, r_uuv, r_uvv, r_vvv
