"""Gaussian images of patches: boundaries, solid angles, parabolic lines.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math

from .vectors import Vector, inline


@inline
def boundary_cones(patch):
    """The rows of the symmetric matrices of the three quadratic cones U = 0, V = 0, W = 0 that
    bound the Gaussian image of a patch.

        U_x = (b*e_x + b_x*e - c*d_x - c_x*d)/2
        U_y = (b*e_y + b_y*e - c*d_y - c_y*d)/2
        U_z = (b*e_z + b_z*e - c*d_z - c_z*d)/2
        V_x = (b*d_x - a*e_x - a_x*e + b_x*d)/2
        V_y = (b*d_y - a*e_y - a_y*e + b_y*d)/2
        V_z = (b*d_z - a*e_z - a_z*e + b_z*d)/2
        W_x = (a*c_x + a*e_x + a_x*c + a_x*e - b*d_x - b*e_x - b_x*d - b_x*e + c*d_x + c_x*d)/2
            - b*b_x
        W_y = (a*c_y + a*e_y + a_y*c + a_y*e - b*d_y - b*e_y - b_y*d - b_y*e + c*d_y + c_y*d)/2
            - b*b_y
        W_z = (a*c_z + a*e_z + a_z*c + a_z*e - b*d_z - b*e_z - b_z*d - b_z*e + c*d_z + c_z*d)/2
            - b*b_z

    Source: Sect. 3.2; 369 operations as written, 128 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    t0 = b_x * e_x
    t1 = c_x * d_x
    U_x_x = t0 - t1
    t2 = 0.5 * b_x
    t3 = e_y * t2
    t4 = 0.5 * e_x
    t5 = b_y * t4
    t6 = 0.5 * c_x
    t7 = d_y * t6
    t8 = 0.5 * d_x
    t9 = c_y * t8
    t10 = t3 + t5 - t7 - t9
    U_x_y = t10
    t11 = e_z * t2
    t12 = b_z * t4
    t13 = d_z * t6
    t14 = c_z * t8
    t15 = t11 + t12 - t13 - t14
    U_x_z = t15
    U_y_x = t10
    t16 = b_y * e_y
    t17 = c_y * d_y
    U_y_y = t16 - t17
    t18 = 0.5 * e_z
    t19 = b_y * t18
    t20 = 0.5 * e_y
    t21 = b_z * t20
    t22 = 0.5 * d_z
    t23 = c_y * t22
    t24 = 0.5 * d_y
    t25 = c_z * t24
    t26 = t19 + t21 - t23 - t25
    U_y_z = t26
    U_z_x = t15
    U_z_y = t26
    t27 = b_z * e_z
    t28 = c_z * d_z
    U_z_z = t27 - t28
    t29 = a_x * e_x - b_x * d_x
    V_x_x = -t29
    t30 = a_x * t20 + a_y * t4 - b_y * t8 - d_y * t2
    V_x_y = -t30
    t31 = a_x * t18 + a_z * t4 - b_z * t8 - d_z * t2
    V_x_z = -t31
    V_y_x = -t30
    t32 = a_y * e_y - b_y * d_y
    V_y_y = -t32
    t33 = a_y * t18 + a_z * t20 - b_y * t22 - b_z * t24
    V_y_z = -t33
    V_z_x = -t31
    V_z_y = -t33
    t34 = a_z * e_z - b_z * d_z
    V_z_z = -t34
    W_x_x = a_x * c_x - b_x * b_x - t0 + t1 + t29
    t35 = 0.5 * a_x
    t36 = a_y * t6 - b_x * b_y + c_y * t35 - t3 + t30 - t5 + t7 + t9
    W_x_y = t36
    t37 = a_z * t6 - b_x * b_z + c_z * t35 - t11 - t12 + t13 + t14 + t31
    W_x_z = t37
    W_y_x = t36
    W_y_y = a_y * c_y - b_y * b_y - t16 + t17 + t32
    t38 = 0.5 * a_y * c_z + 0.5 * a_z * c_y - b_y * b_z - t19 - t21 + t23 + t25 + t33
    W_y_z = t38
    W_z_x = t37
    W_z_y = t38
    W_z_z = a_z * c_z - b_z * b_z - t27 + t28 + t34
    return (
        Vector(U_x_x, U_x_y, U_x_z),
        Vector(U_y_x, U_y_y, U_y_z),
        Vector(U_z_x, U_z_y, U_z_z),
        Vector(V_x_x, V_x_y, V_x_z),
        Vector(V_y_x, V_y_y, V_y_z),
        Vector(V_z_x, V_z_y, V_z_z),
        Vector(W_x_x, W_x_y, W_x_z),
        Vector(W_y_x, W_y_y, W_y_z),
        Vector(W_z_x, W_z_y, W_z_z),
    )


@inline
def edge_vectors(T0, X0, T1, X1):
    """The vectors of a patch on which its form V depends, from the tangents T = p_u and X = p_v
    at the ends (0, 0) and (1, 0) of the edge v = 0: V = 0 is the boundary cone of this edge.

        a = T1 - T0
        b = X1 - X0
        d = T0
        e = X0

    Source: Sect. 3.2; 6 operations as written, 6 here.
    """
    T0_x, T0_y, T0_z = T0
    X0_x, X0_y, X0_z = X0
    T1_x, T1_y, T1_z = T1
    X1_x, X1_y, X1_z = X1
    a_x = T1_x - T0_x
    a_y = T1_y - T0_y
    a_z = T1_z - T0_z
    b_x = X1_x - X0_x
    b_y = X1_y - X0_y
    b_z = X1_z - X0_z
    d_x = T0_x
    d_y = T0_y
    d_z = T0_z
    e_x = X0_x
    e_y = X0_y
    e_z = X0_z
    return (
        Vector(a_x, a_y, a_z),
        Vector(b_x, b_y, b_z),
        Vector(d_x, d_y, d_z),
        Vector(e_x, e_y, e_z),
    )


@inline
def tangential(x, n):
    """The component of x perpendicular to n, times |n|^2.

        y = x*|n|**2 - n*x·n

    Source: beyond the paper; 39 operations as written, 19 here.
    """
    x_x, x_y, x_z = x
    n_x, n_y, n_z = n
    t0 = n_x * x_x + n_y * x_y + n_z * x_z
    t1 = n_x * n_x + n_y * n_y + n_z * n_z
    y_x = t1 * x_x - n_x * t0
    y_y = t1 * x_y - n_y * t0
    y_z = t1 * x_z - n_z * t0
    return Vector(y_x, y_y, y_z)


@inline
def boundary_arc(N0, N1, N2, t):
    """The normals along an edge of a patch, and their derivative: a quadratic Bézier curve with
    three of the six control normals. Its projection to the sphere is an arc of the boundary of
    the Gaussian image; it lies on one of the cones U = 0, V = 0, W = 0.

        n = N0*(1 - t)**2 + 2*N1*t*(1 - t) + N2*t**2
        n_t = 2*(N0*t - N0 + N1 + N2*t) - 4*N1*t

    Source: Sect. 3.2; 72 operations as written, 48 here.
    """
    N0_x, N0_y, N0_z = N0
    N1_x, N1_y, N1_z = N1
    N2_x, N2_y, N2_z = N2
    t0 = t * t
    t1 = 1 - t
    t2 = t1 * t1
    t3 = 2 * N1_x
    t4 = t * t1
    n_x = N0_x * t2 + N2_x * t0 + t3 * t4
    t5 = 2 * N1_y
    n_y = N0_y * t2 + N2_y * t0 + t4 * t5
    t6 = 2 * N1_z
    n_z = N0_z * t2 + N2_z * t0 + t4 * t6
    t7 = 2 * N0_x
    t8 = 4 * t
    t9 = 2 * t
    n_t_x = N2_x * t9 - N1_x * t8 + t * t7 + t3 - t7
    t10 = 2 * N0_y
    n_t_y = N2_y * t9 - N1_y * t8 + t * t10 - t10 + t5
    t11 = 2 * N0_z
    n_t_z = N2_z * t9 - N1_z * t8 + t * t11 - t11 + t6
    return Vector(n_x, n_y, n_z), Vector(n_t_x, n_t_y, n_t_z)


@inline
def boundary_arc_zeros(N0, N1, N2, q, s):
    """The two zeros of the component along q of the normals of a boundary arc. At a singular
    point the normal vanishes, and so does the component along every q. s is the sign of z1,
    which avoids cancellation. A negative discriminant, the rounded value of a double zero,
    counts as zero.

        z0 = q·N0
        z1 = q·N1
        z2 = q·N2
        r = s*sqrt(max(0, z1**2 - z0*z2)) + z1
        t1 = r/(r - z2)
        t2 = z0/(z0 - r)

    Source: beyond the paper; 26 operations as written, 26 here.
    """
    N0_x, N0_y, N0_z = N0
    N1_x, N1_y, N1_z = N1
    N2_x, N2_y, N2_z = N2
    q_x, q_y, q_z = q
    z0 = N0_x * q_x + N0_y * q_y + N0_z * q_z
    z1 = N1_x * q_x + N1_y * q_y + N1_z * q_z
    z2 = N2_x * q_x + N2_y * q_y + N2_z * q_z
    r = s * math.sqrt(max(0, z1 * z1 - z0 * z2)) + z1
    t1 = r / (r - z2)
    t2 = z0 / (z0 - r)
    return t1, t2


@inline
def solid_angle(q, n, n_t):
    """Integrand of a solid angle along a curve n of normals of any length, with the derivative
    n_t: its integral along the boundary of a region of the sphere is the region's solid angle,
    unless the region contains -q. q is a unit vector.

        S_t = (det(q, n, n_t))/((q·n + |n|)*|n|)

    Source: beyond the paper; 34 operations as written, 28 here.
    """
    q_x, q_y, q_z = q
    n_x, n_y, n_z = n
    n_t_x, n_t_y, n_t_z = n_t
    t0 = math.sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
    S_t = (
        q_x * (n_t_z * n_y - n_t_y * n_z)
        + q_y * (n_t_x * n_z - n_t_z * n_x)
        + q_z * (n_t_y * n_x - n_t_x * n_y)
    ) / (t0 * (n_x * q_x + n_y * q_y + n_z * q_z + t0))
    return S_t


@inline
def parabolic_directions(patch):
    """The coefficients of the binary cubic det[t a − s b, t b − s c, t d − s e] in (s, t): its
    real roots are the directions of the parabolic lines s u + t v = const. It vanishes where
    the patch is developable, and where a, b, c are multiples of one vector, so that the
    curvature has one sign.

        k30 = - det(b, c, e)
        k21 = det(a, c, e) + det(b, c, d)
        k12 = - det(a, b, e) - det(a, c, d)
        k03 = det(a, b, d)

    Source: Sect. 3.2; 88 operations as written, 70 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    t0 = c_y * e_z - c_z * e_y
    t1 = c_z * e_x - c_x * e_z
    t2 = c_x * e_y - c_y * e_x
    k30 = -b_x * t0 - b_y * t1 - b_z * t2
    t3 = c_y * d_z - c_z * d_y
    t4 = c_z * d_x - c_x * d_z
    t5 = c_x * d_y - c_y * d_x
    k21 = a_x * t0 + a_y * t1 + a_z * t2 + b_x * t3 + b_y * t4 + b_z * t5
    k12 = (
        -a_x * t3
        - a_x * (b_y * e_z - b_z * e_y)
        - a_y * t4
        - a_y * (b_z * e_x - b_x * e_z)
        - a_z * t5
        - a_z * (b_x * e_y - b_y * e_x)
    )
    k03 = (
        a_x * (b_y * d_z - b_z * d_y)
        + a_y * (b_z * d_x - b_x * d_z)
        + a_z * (b_x * d_y - b_y * d_x)
    )
    return k30, k21, k12, k03


@inline
def parabolic_normal(patch, s, t):
    """Three multiples of the normal along a parabolic line of direction (s, t), which is
    constant there up to length and sign. At least one is non-zero, unless the patch is
    developable or has no normal on the line.

        f1 = a*t - b*s
        f2 = b*t - c*s
        f3 = d*t - e*s
        n12 = f1 × f2
        n13 = f1 × f3
        n23 = f2 × f3

    Source: Sect. 3.2; 54 operations as written, 54 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    f1_x = a_x * t - b_x * s
    f1_y = a_y * t - b_y * s
    f1_z = a_z * t - b_z * s
    f2_x = b_x * t - c_x * s
    f2_y = b_y * t - c_y * s
    f2_z = b_z * t - c_z * s
    f3_x = d_x * t - e_x * s
    f3_y = d_y * t - e_y * s
    f3_z = d_z * t - e_z * s
    n12_x = f1_y * f2_z - f1_z * f2_y
    n12_y = f1_z * f2_x - f1_x * f2_z
    n12_z = f1_x * f2_y - f1_y * f2_x
    n13_x = f1_y * f3_z - f1_z * f3_y
    n13_y = f1_z * f3_x - f1_x * f3_z
    n13_z = f1_x * f3_y - f1_y * f3_x
    n23_x = f2_y * f3_z - f2_z * f3_y
    n23_y = f2_z * f3_x - f2_x * f3_z
    n23_z = f2_x * f3_y - f2_y * f3_x
    return Vector(n12_x, n12_y, n12_z), Vector(n13_x, n13_y, n13_z), Vector(n23_x, n23_y, n23_z)


@inline
def parabolic_line(patch, n, s, t):
    """The parabolic line l_u u + l_v v + l_1 = 0 of direction (s, t) with the normal n; it is
    the line at infinity if l_u = l_v = 0.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e
        l_u = A*s + B*t
        l_v = B*s + C*t
        l_1 = P*s + Q*t

    Source: Sect. 3.2; 34 operations as written, 34 here.
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
    l_u = A * s + B * t
    l_v = B * s + C * t
    l_1 = P * s + Q * t
    return l_u, l_v, l_1


@inline
def gaussian_curvature_of_derivatives(p_u, p_v, a, b, c):
    """The Gaussian curvature of any surface from its first derivatives p_u, p_v and its second
    derivatives a, b, c (by uu, uv, vv), and the components l_uu, l_uv, l_vv of these along the
    normal p_u × p_v.

        N = p_u × p_v
        A = N·a
        B = N·b
        C = N·c
        K = (A*C - B**2)/|N|**4
        l_uu = A
        l_uv = B
        l_vv = C

    Source: Sect. 3.2, Remark 3.1; 39 operations as written, 39 here.
    """
    p_u_x, p_u_y, p_u_z = p_u
    p_v_x, p_v_y, p_v_z = p_v
    a_x, a_y, a_z = a
    b_x, b_y, b_z = b
    c_x, c_y, c_z = c
    N_x = p_u_y * p_v_z - p_u_z * p_v_y
    N_y = p_u_z * p_v_x - p_u_x * p_v_z
    N_z = p_u_x * p_v_y - p_u_y * p_v_x
    A = N_x * a_x + N_y * a_y + N_z * a_z
    B = N_x * b_x + N_y * b_y + N_z * b_z
    C = N_x * c_x + N_y * c_y + N_z * c_z
    K = (A * C - B * B) / (
        (N_x * N_x + N_y * N_y + N_z * N_z) * (N_x * N_x + N_y * N_y + N_z * N_z)
    )
    l_uu = A
    l_uv = B
    l_vv = C
    return K, l_uu, l_uv, l_vv
