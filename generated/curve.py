"""Planar curves: the formulas of symbolic/curve.py as functions of vectors.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from .vectors import Arc, PlaneVector, inline


@inline
def arc_power_form(b20, b11, b02):
    """The vectors a, b, c of an arc from its control points.

        a = 2*b02 - 4*b11 + 2*b20
        b = 2*(b11 - b20)
        c = b20

    Source: Sect. 4.1; 16 operations as written, 14 here.
    """
    b20_x, b20_y = b20
    b11_x, b11_y = b11
    b02_x, b02_y = b02
    t0 = 2 * b20_x
    a_x = 2 * b02_x - 4 * b11_x + t0
    t1 = 2 * b20_y
    a_y = 2 * b02_y - 4 * b11_y + t1
    b_x = 2 * b11_x - t0
    b_y = 2 * b11_y - t1
    c_x = b20_x
    c_y = b20_y
    return Arc(PlaneVector(a_x, a_y), PlaneVector(b_x, b_y), PlaneVector(c_x, c_y))


@inline
def arc_parameter(arc, n):
    """The parameter at which the tangent of the arc is perpendicular to n.

        A = n·a
        B = n·b
        t = - B/A

    Source: eq. (9), in the plane: Sect. 4.1; 8 operations as written, 8 here.
    """
    a_x, a_y = arc.a
    b_x, b_y = arc.b
    n_x, n_y = n
    A = a_x * n_x + a_y * n_y
    B = b_x * n_x + b_y * n_y
    t = -B / A
    return t


@inline
def arc_support_function(arc, n):
    """The support function of an arc: a quadratic over a linear form in n, homogeneous of
    degree 1 and odd.

        A = n·a
        B = n·b
        h = n·c - B**2/(2*A)

    Source: eqs. (3) and (9), in the plane: Sect. 4.1; 13 operations as written, 13 here.
    """
    a_x, a_y = arc.a
    b_x, b_y = arc.b
    c_x, c_y = arc.c
    n_x, n_y = n
    A = a_x * n_x + a_y * n_y
    B = b_x * n_x + b_y * n_y
    h = c_x * n_x + c_y * n_y - 0.5 * B * B / A
    return h


@inline
def arc_envelope(arc, t):
    """The envelope operator: the gradient of the support function is the point of the arc that
    has the normal n, p(t(n)).

        x = a*t**2/2 + b*t + c

    Source: eqs. (5)-(8), in the plane: Sect. 4.1; 12 operations as written, 10 here.
    """
    a_x, a_y = arc.a
    b_x, b_y = arc.b
    c_x, c_y = arc.c
    t0 = 0.5 * t * t
    x_x = a_x * t0 + b_x * t + c_x
    x_y = a_y * t0 + b_y * t + c_y
    return PlaneVector(x_x, x_y)


@inline
def arc_tangent(arc, t):
    """The tangent vector, and the normal: the tangent after a quarter turn clockwise.

        p_t = a*t + b
        N_x = p_t_y
        N_y = - p_t_x

    Source: eq. (1), in the plane: Sect. 4.1; 5 operations as written, 5 here.
    """
    a_x, a_y = arc.a
    b_x, b_y = arc.b
    p_t_x = a_x * t + b_x
    p_t_y = a_y * t + b_y
    N_x = p_t_y
    N_y = -p_t_x
    return PlaneVector(p_t_x, p_t_y), N_x, N_y


@inline
def arc_curvature(A, p_t):
    """The curvature at the point with the unit normal n: the reciprocal of the radius of
    curvature, which is the trace of the Hessian of the support function (positive on a circle
    with outward normals).

        kappa = - A/|p_t|**2

    Source: beyond the paper: Sect. 4.1; 5 operations as written, 5 here.
    """
    p_t_x, p_t_y = p_t
    kappa = -A / (p_t_x * p_t_x + p_t_y * p_t_y)
    return kappa


@inline
def arc_sample(arc, t, A):
    """Point, tangent and curvature of a sample of a curve.

        x = a*t**2/2 + b*t + c
        p_t = a*t + b
        kappa = - A/|p_t|**2

    Source: eqs. (5)-(8), in the plane: Sect. 4.1; 21 operations as written, 19 here.
    """
    a_x, a_y = arc.a
    b_x, b_y = arc.b
    c_x, c_y = arc.c
    t0 = 0.5 * t * t
    x_x = a_x * t0 + b_x * t + c_x
    x_y = a_y * t0 + b_y * t + c_y
    p_t_x = a_x * t + b_x
    p_t_y = a_y * t + b_y
    kappa = -A / (p_t_x * p_t_x + p_t_y * p_t_y)
    return PlaneVector(x_x, x_y), kappa


@inline
def arc_control_points(mu_l, mu_c, mu_r):
    """The control points of an arc of the quadratic spline from the coefficients of its piece
    and the two next to it.

        b20 = (mu_c + mu_l)/2
        b11 = mu_c
        b02 = (mu_c + mu_r)/2

    Source: Sect. 4.1; 12 operations as written, 10 here.
    """
    mu_l_x, mu_l_y = mu_l
    mu_c_x, mu_c_y = mu_c
    mu_r_x, mu_r_y = mu_r
    t0 = 0.5 * mu_c_x
    b20_x = 0.5 * mu_l_x + t0
    t1 = 0.5 * mu_c_y
    b20_y = 0.5 * mu_l_y + t1
    b11_x = mu_c_x
    b11_y = mu_c_y
    b02_x = 0.5 * mu_r_x + t0
    b02_y = 0.5 * mu_r_y + t1
    return PlaneVector(b20_x, b20_y), PlaneVector(b11_x, b11_y), PlaneVector(b02_x, b02_y)


@inline
def arc(mu_l, mu_r):
    """The vectors of an arc of the spline, c relative to the coefficient of its piece, from the
    differences mu_l, mu_r of the neighbouring coefficients from that one.

        a = mu_l + mu_r
        b = - mu_l
        c = mu_l/2

    Source: Sect. 4.1; 6 operations as written, 6 here.
    """
    mu_l_x, mu_l_y = mu_l
    mu_r_x, mu_r_y = mu_r
    a_x = mu_l_x + mu_r_x
    a_y = mu_l_y + mu_r_y
    b_x = -mu_l_x
    b_y = -mu_l_y
    c_x = 0.5 * mu_l_x
    c_y = 0.5 * mu_l_y
    return Arc(PlaneVector(a_x, a_y), PlaneVector(b_x, b_y), PlaneVector(c_x, c_y))


@inline
def beyond_end(f, mu_c):
    """The coefficient beyond an end of an open curve from that of the last piece and the value
    f at the end, which the spline interpolates.

        mu_l = 2*f - mu_c

    Source: Sect. 4.1; 2 operations as written, 2 here.
    """
    mu_l = 2 * f - mu_c
    return mu_l
