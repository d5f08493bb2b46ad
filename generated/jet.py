"""Surfaces at a point: the formulas of symbolic/jet.py as functions of vectors.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math

from .vectors import Vector, inline


@inline
def at_jet(patch):
    """The length L of the normal N of a surface, the unit normal, the Gaussian and the mean
    curvature, from its 2-jet: a = x_uu, b = x_uv, c = x_vv, d = x_u, e = x_v. The mean
    curvature is half the sum of the principal curvatures −II/I, positive on a sphere with
    outward normals.

        N = d × e
        A = N·a
        B = N·b
        C = N·c
        E = |d|**2
        F = d·e
        G = |e|**2
        L = |N|
        n = N/L
        K = (A*C - B**2)/L**4
        H = (2*B*F - A*G - C*E)/(2*L**3)

    Source: beyond the paper; 65 operations as written, 66 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    N_x = d_y * e_z - d_z * e_y
    N_y = d_z * e_x - d_x * e_z
    N_z = d_x * e_y - d_y * e_x
    A = N_x * a_x + N_y * a_y + N_z * a_z
    B = N_x * b_x + N_y * b_y + N_z * b_z
    C = N_x * c_x + N_y * c_y + N_z * c_z
    E = d_x * d_x + d_y * d_y + d_z * d_z
    F = d_x * e_x + d_y * e_y + d_z * e_z
    G = e_x * e_x + e_y * e_y + e_z * e_z
    L = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z)
    t0 = 1.0 / L
    n_x = N_x * t0
    n_y = N_y * t0
    n_z = N_z * t0
    K = (A * C - B * B) / (L * L * L * L)
    H = 0.5 * (2 * B * F - A * G - C * E) / (L * L * L)
    return L, Vector(n_x, n_y, n_z), K, H


@inline
def forms_at_jet(patch):
    """The first fundamental form E, F, G of a surface, its third fundamental form e_1, f_1, g_1
    (of the derivatives of the unit normal), and D, which has the sign of the Gaussian
    curvature, from its 2-jet.

        N = d × e
        A = N·a
        B = N·b
        C = N·c
        r = 1/|N|**4
        E = |d|**2
        F = d·e
        G = |e|**2
        e1 = r*(A**2*G - 2*A*B*F + B**2*E)
        f1 = r*(A*B*G + B*C*E - F*(A*C + B**2))
        g1 = r*(B**2*G - 2*B*C*F + C**2*E)
        D = A*C - B**2

    Source: beyond the paper; 85 operations as written, 78 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    N_x = d_y * e_z - d_z * e_y
    N_y = d_z * e_x - d_x * e_z
    N_z = d_x * e_y - d_y * e_x
    A = N_x * a_x + N_y * a_y + N_z * a_z
    B = N_x * b_x + N_y * b_y + N_z * b_z
    C = N_x * c_x + N_y * c_y + N_z * c_z
    r = 1.0 / ((N_x * N_x + N_y * N_y + N_z * N_z) * (N_x * N_x + N_y * N_y + N_z * N_z))
    E = d_x * d_x + d_y * d_y + d_z * d_z
    F = d_x * e_x + d_y * e_y + d_z * e_z
    G = e_x * e_x + e_y * e_y + e_z * e_z
    t0 = B * B
    t1 = A * B
    t2 = 2 * F
    e1 = r * (A * A * G + E * t0 - t1 * t2)
    t3 = B * C
    t4 = A * C
    f1 = r * (E * t3 - F * (t0 + t4) + G * t1)
    g1 = r * (C * C * E + G * t0 - t2 * t3)
    D = t4 - t0
    return E, F, G, e1, f1, g1, D


@inline
def newton(patch, n):
    """The step u, v of Newton's method for P = Q = 0: the preimage of the unit normal n on the
    patch that osculates the surface. s is the squared sine of the angle between n and the
    normal N of the surface, q = n × N, and m has the sign of the cosine.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e
        D = A*C - B**2
        r = 1/D
        q = Q*d - P*e
        N = d × e
        u = r*(B*Q - C*P)
        v = r*(B*P - A*Q)
        s = |q|**2/|N|**2
        m = n·N

    Source: beyond the paper; 71 operations as written, 71 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    n_x, n_y, n_z = n
    A = a_x * n_x + a_y * n_y + a_z * n_z
    B = b_x * n_x + b_y * n_y + b_z * n_z
    C = c_x * n_x + c_y * n_y + c_z * n_z
    P = d_x * n_x + d_y * n_y + d_z * n_z
    Q = e_x * n_x + e_y * n_y + e_z * n_z
    D = A * C - B * B
    r = 1.0 / D
    q_x = Q * d_x - P * e_x
    q_y = Q * d_y - P * e_y
    q_z = Q * d_z - P * e_z
    N_x = d_y * e_z - d_z * e_y
    N_y = d_z * e_x - d_x * e_z
    N_z = d_x * e_y - d_y * e_x
    u = r * (B * Q - C * P)
    v = r * (B * P - A * Q)
    s = (q_x * q_x + q_y * q_y + q_z * q_z) / (N_x * N_x + N_y * N_y + N_z * N_z)
    m = N_x * n_x + N_y * n_y + N_z * n_z
    return u, v, s, m


@inline
def contour(patch, w):
    """The normal N of a surface, its product f with w, and the derivatives of f by u and v,
    from its 2-jet. The zeros of f are the contour generator of the projection along w.

        N_u = a × e + d × b
        N_v = b × e + d × c
        N = d × e
        f = N·w
        f_u = N_u·w
        f_v = N_v·w

    Source: beyond the paper; 66 operations as written, 66 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    w_x, w_y, w_z = w
    N_u_x = a_y * e_z - a_z * e_y - b_y * d_z + b_z * d_y
    N_u_y = a_z * e_x - a_x * e_z + b_x * d_z - b_z * d_x
    N_u_z = a_x * e_y - a_y * e_x - b_x * d_y + b_y * d_x
    N_v_x = b_y * e_z - b_z * e_y - c_y * d_z + c_z * d_y
    N_v_y = b_z * e_x - b_x * e_z + c_x * d_z - c_z * d_x
    N_v_z = b_x * e_y - b_y * e_x - c_x * d_y + c_y * d_x
    N_x = d_y * e_z - d_z * e_y
    N_y = d_z * e_x - d_x * e_z
    N_z = d_x * e_y - d_y * e_x
    f = N_x * w_x + N_y * w_y + N_z * w_z
    f_u = N_u_x * w_x + N_u_y * w_y + N_u_z * w_z
    f_v = N_v_x * w_x + N_v_y * w_y + N_v_z * w_z
    return Vector(N_x, N_y, N_z), f, f_u, f_v


@inline
def bend(patch, w):
    """The second fundamental form k of a tangent vector w = U x_u + V x_v of a surface, times
    the length of the normal N, from its 2-jet. Positive where the surface bends along w towards
    N.

        N = d × e
        A = N·a
        B = N·b
        C = N·c
        r = 1/|N|**2
        o = e × N
        m = N × d
        U = r*(o·w)
        V = r*(m·w)
        k = A*U**2 + 2*B*U*V + C*V**2

    Source: beyond the paper; 69 operations as written, 69 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    w_x, w_y, w_z = w
    N_x = d_y * e_z - d_z * e_y
    N_y = d_z * e_x - d_x * e_z
    N_z = d_x * e_y - d_y * e_x
    A = N_x * a_x + N_y * a_y + N_z * a_z
    B = N_x * b_x + N_y * b_y + N_z * b_z
    C = N_x * c_x + N_y * c_y + N_z * c_z
    r = 1.0 / (N_x * N_x + N_y * N_y + N_z * N_z)
    o_x = N_z * e_y - N_y * e_z
    o_y = N_x * e_z - N_z * e_x
    o_z = N_y * e_x - N_x * e_y
    m_x = N_y * d_z - N_z * d_y
    m_y = N_z * d_x - N_x * d_z
    m_z = N_x * d_y - N_y * d_x
    U = r * (o_x * w_x + o_y * w_y + o_z * w_z)
    V = r * (m_x * w_x + m_y * w_y + m_z * w_z)
    k = A * U * U + 2 * B * U * V + C * V * V
    return k


@inline
def polar_chart(patch, r, x, y):
    """The 2-jet in the regular chart s = r x, t = r y at a pole, from derivatives by the polar
    angle (first d, second a), by angle and distance (b) and by the distance r > 0; x and y are
    the cosine and the sine of the angle.

        o = d/r
        m = b/r - o/r
        h = a/r**2 + e/r
        X_ss = c*x**2 + h*y**2 - 2*m*x*y
        X_st = c*x*y - h*x*y + m*(x**2 - y**2)
        X_tt = c*y**2 + h*x**2 + 2*m*x*y
        X_s = e*x - o*y
        X_t = e*y + o*x

    Source: beyond the paper; 126 operations as written, 89 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    t0 = 1.0 / r
    o_x = d_x * t0
    o_y = d_y * t0
    o_z = d_z * t0
    m_x = b_x * t0 - o_x * t0
    m_y = b_y * t0 - o_y * t0
    m_z = b_z * t0 - o_z * t0
    t1 = 1.0 / (r * r)
    h_x = a_x * t1 + e_x * t0
    h_y = a_y * t1 + e_y * t0
    h_z = a_z * t1 + e_z * t0
    t2 = x * x
    t3 = y * y
    t4 = x * y
    t5 = 2 * t4
    t6 = m_x * t5
    X_ss_x = c_x * t2 + h_x * t3 - t6
    t7 = m_y * t5
    X_ss_y = c_y * t2 + h_y * t3 - t7
    t8 = m_z * t5
    X_ss_z = c_z * t2 + h_z * t3 - t8
    t9 = t2 - t3
    X_st_x = c_x * t4 - h_x * t4 + m_x * t9
    X_st_y = c_y * t4 - h_y * t4 + m_y * t9
    X_st_z = c_z * t4 - h_z * t4 + m_z * t9
    X_tt_x = c_x * t3 + h_x * t2 + t6
    X_tt_y = c_y * t3 + h_y * t2 + t7
    X_tt_z = c_z * t3 + h_z * t2 + t8
    X_s_x = e_x * x - o_x * y
    X_s_y = e_y * x - o_y * y
    X_s_z = e_z * x - o_z * y
    X_t_x = e_x * y + o_x * x
    X_t_y = e_y * y + o_y * x
    X_t_z = e_z * y + o_z * x
    return (
        Vector(X_ss_x, X_ss_y, X_ss_z),
        Vector(X_st_x, X_st_y, X_st_z),
        Vector(X_tt_x, X_tt_y, X_tt_z),
        Vector(X_s_x, X_s_y, X_s_z),
        Vector(X_t_x, X_t_y, X_t_z),
    )


@inline
def at_pole(e0, c0, c1, e2, c2):
    """The 2-jet at a pole, in its chart, from the first and second derivatives e and c by the
    distance from it, along the directions of 0, 45 and 90 degrees.

        X_ss = c0
        X_st = c1 - c0/2 - c2/2
        X_tt = c2
        X_s = e0
        X_t = e2

    Source: beyond the paper; 12 operations as written, 12 here.
    """
    e0_x, e0_y, e0_z = e0
    c0_x, c0_y, c0_z = c0
    c1_x, c1_y, c1_z = c1
    e2_x, e2_y, e2_z = e2
    c2_x, c2_y, c2_z = c2
    X_ss_x = c0_x
    X_ss_y = c0_y
    X_ss_z = c0_z
    X_st_x = c1_x - 0.5 * c0_x - 0.5 * c2_x
    X_st_y = c1_y - 0.5 * c0_y - 0.5 * c2_y
    X_st_z = c1_z - 0.5 * c0_z - 0.5 * c2_z
    X_tt_x = c2_x
    X_tt_y = c2_y
    X_tt_z = c2_z
    X_s_x = e0_x
    X_s_y = e0_y
    X_s_z = e0_z
    X_t_x = e2_x
    X_t_y = e2_y
    X_t_z = e2_z
    return (
        Vector(X_ss_x, X_ss_y, X_ss_z),
        Vector(X_st_x, X_st_y, X_st_z),
        Vector(X_tt_x, X_tt_y, X_tt_z),
        Vector(X_s_x, X_s_y, X_s_z),
        Vector(X_t_x, X_t_y, X_t_z),
    )


@inline
def graph_slopes(o1, o2, e1, e2, h1, h2):
    """The inverse i11, … of the matrix of o and e: the derivatives of coordinates q1, q2 of a
    plane by u, divided by r, and by r. Also the first derivatives G1, G2 of a graph h by q1,
    q2, from h1 by u, divided by r, and h2 by r.

        d = 1/(e2*o1 - e1*o2)
        i11 = d*e2
        i12 = - d*e1
        i21 = - d*o2
        i22 = d*o1
        G1 = h1*i11 + h2*i21
        G2 = h1*i12 + h2*i22

    Source: beyond the paper; 16 operations as written, 16 here.
    """
    d = 1.0 / (e2 * o1 - e1 * o2)
    i11 = d * e2
    i12 = -d * e1
    i21 = -d * o2
    i22 = d * o1
    G1 = h1 * i11 + h2 * i21
    G2 = h1 * i12 + h2 * i22
    return i11, i12, i21, i22, G1, G2


@inline
def graph_at_pole(i11, i12, i21, i22, G1, G2, a1, a2, b1, b2, c1, c2, h11, h12, h22, r):
    """The second derivatives H11, H12, H22 of a graph h by the coordinates q1, q2 of its
    tangent plane, near a pole with the parameters u around it and r = 0 at it. Inputs are i11,
    … and G1, G2 of `graph_slopes`, the latter divided by r; the second derivatives of q1, q2: a
    by u, divided by r, b by both, c by r; and those of h: h11 by u, divided by r^2, h12 by
    both, divided by r, h22 by r.

        A = h11 - G1*a1 - G2*a2
        B = h12 - G1*b1 - G2*b2
        C = h22 - r*(G1*c1 + G2*c2)
        H11 = A*i11**2 + 2*B*i11*i21 + C*i21**2
        H12 = A*i11*i12 + B*(i11*i22 + i12*i21) + C*i21*i22
        H22 = A*i12**2 + 2*B*i12*i22 + C*i22**2

    Source: beyond the paper; 41 operations as written, 40 here.
    """
    A = h11 - G1 * a1 - G2 * a2
    B = h12 - G1 * b1 - G2 * b2
    C = h22 - r * (G1 * c1 + G2 * c2)
    t0 = 2 * B
    H11 = A * i11 * i11 + C * i21 * i21 + i11 * i21 * t0
    H12 = A * i11 * i12 + B * (i11 * i22 + i12 * i21) + C * i21 * i22
    H22 = A * i12 * i12 + C * i22 * i22 + i12 * i22 * t0
    return H11, H12, H22
