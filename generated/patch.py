"""One quadratic patch: the formulas of symbolic/patch.py as functions of vectors.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math

from .vectors import Hessian, Patch, Vector, inline

NODE = 1.0 / 6.0


@inline
def power_form(b200, b020, b002, b110, b101, b011):
    """The vectors of eq. (8), a = a_20, b = a_11, c = a_02, d = a_10, e = a_01 and p = a_00 in
    the paper, from the control points of a quadratic Bézier triangle.

        a = 2*b002 - 4*b101 + 2*b200
        b = 2*(b002 - b011 - b101 + b110)
        c = 2*b002 - 4*b011 + 2*b020
        d = 2*(b101 - b002)
        e = 2*(b011 - b002)
        p = b002

    Source: eqs. (8) and (10); 69 operations as written, 54 here.
    """
    b200_x, b200_y, b200_z = b200
    b020_x, b020_y, b020_z = b020
    b002_x, b002_y, b002_z = b002
    b110_x, b110_y, b110_z = b110
    b101_x, b101_y, b101_z = b101
    b011_x, b011_y, b011_z = b011
    t0 = 2 * b002_x
    a_x = 2 * b200_x - 4 * b101_x + t0
    t1 = 2 * b002_y
    a_y = 2 * b200_y - 4 * b101_y + t1
    t2 = 2 * b002_z
    a_z = 2 * b200_z - 4 * b101_z + t2
    t3 = -2 * b011_x
    t4 = t0 - 2 * b101_x
    b_x = 2 * b110_x + t3 + t4
    t5 = -2 * b011_y
    t6 = t1 - 2 * b101_y
    b_y = 2 * b110_y + t5 + t6
    t7 = -2 * b011_z
    t8 = t2 - 2 * b101_z
    b_z = 2 * b110_z + t7 + t8
    c_x = 2 * b020_x - 4 * b011_x + t0
    c_y = 2 * b020_y - 4 * b011_y + t1
    c_z = 2 * b020_z - 4 * b011_z + t2
    d_x = -t4
    d_y = -t6
    d_z = -t8
    e_x = -t0 - t3
    e_y = -t1 - t5
    e_z = -t2 - t7
    p_x = b002_x
    p_y = b002_y
    p_z = b002_z
    return Patch(
        Vector(a_x, a_y, a_z),
        Vector(b_x, b_y, b_z),
        Vector(c_x, c_y, c_z),
        Vector(d_x, d_y, d_z),
        Vector(e_x, e_y, e_z),
        Vector(p_x, p_y, p_z),
    )


@inline
def forms(patch, n):
    """Eliminating u, v from eq. (9) leaves three quadratic forms in n, with u = U/D, v = V/D
    and w = W/D. The patch has the normal n where U, V, W have the same sign, which is that of D
    = U + V + W; U = 0, V = 0, W = 0 are the three boundary cones of its Gaussian image.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e
        D = A*C - B**2
        U = B*Q - C*P
        V = B*P - A*Q
        W = D - U - V

    Source: eq. (9) and Sect. 3.2; 36 operations as written, 36 here.
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
    U = B * Q - C * P
    V = B * P - A * Q
    W = D - U - V
    return D, U, V, W


@inline
def linear_forms(patch, n):
    """The linear forms in n of eq. (9), from which u, v are eliminated.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e

    Source: eq. (9); 25 operations as written, 25 here.
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
    return A, B, C, P, Q


@inline
def eliminated_forms(A, B, C, P, Q):
    """The quadratic forms of a patch from the linear ones, by elimination of u and v.

        D = A*C - B**2
        U = B*Q - C*P
        V = B*P - A*Q
        W = D - U - V

    Source: eq. (9) and Sect. 3.2; 11 operations as written, 11 here.
    """
    D = A * C - B * B
    U = B * Q - C * P
    V = B * P - A * Q
    W = D - U - V
    return D, U, V, W


@inline
def polar_forms(A, B, C, P, Q, A_m, B_m, C_m, P_m, Q_m):
    """Coefficients of s t in the quadratic forms at s n + t m, from the linear forms of the
    normals n and m; for m = n, twice the quadratic forms.

        D = A*C_m + A_m*C - 2*B*B_m
        U = B*Q_m + B_m*Q - C*P_m - C_m*P
        V = B*P_m - A*Q_m - A_m*Q + B_m*P
        W = D - U - V

    Source: eq. (9); 22 operations as written, 22 here.
    """
    D = A * C_m + A_m * C - 2 * B * B_m
    U = B * Q_m + B_m * Q - C * P_m - C_m * P
    V = B * P_m - A * Q_m - A_m * Q + B_m * P
    W = D - U - V
    return D, U, V, W


@inline
def parameters(D, U, V):
    """The parameters at which the patch has the normal n.

        r = 1/D
        u = U*r
        v = V*r

    Source: eq. (9); 3 operations as written, 3 here.
    """
    r = 1.0 / D
    u = U * r
    v = V * r
    return u, v


@inline
def support_function(patch, n):
    """The support function of a quadratic patch: a cubic over a quadratic form in n,
    homogeneous of degree 1 and odd.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e
        D = A*C - B**2
        U = B*Q - C*P
        V = B*P - A*Q
        h = n·p + (P*U + Q*V)/(2*D)

    Source: eqs. (3) and (9); 45 operations as written, 45 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    n_x, n_y, n_z = n
    A = a_x * n_x + a_y * n_y + a_z * n_z
    B = b_x * n_x + b_y * n_y + b_z * n_z
    C = c_x * n_x + c_y * n_y + c_z * n_z
    P = d_x * n_x + d_y * n_y + d_z * n_z
    Q = e_x * n_x + e_y * n_y + e_z * n_z
    D = A * C - B * B
    U = B * Q - C * P
    V = B * P - A * Q
    h = n_x * p_x + n_y * p_y + n_z * p_z + 0.5 * (P * U + Q * V) / D
    return h


@inline
def envelope(patch, u, v):
    """The envelope operator: the gradient of the support function is the point of the patch
    that has the normal n, p(u(n), v(n)).

        x = a*u**2/2 + b*u*v + c*v**2/2 + d*u + e*v + p

    Source: eqs. (5)-(8); 45 operations as written, 35 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    t0 = u * v
    t1 = 0.5 * u * u
    t2 = 0.5 * v * v
    x_x = a_x * t1 + b_x * t0 + c_x * t2 + d_x * u + e_x * v + p_x
    x_y = a_y * t1 + b_y * t0 + c_y * t2 + d_y * u + e_y * v + p_y
    x_z = a_z * t1 + b_z * t0 + c_z * t2 + d_z * u + e_z * v + p_z
    return Vector(x_x, x_y, x_z)


@inline
def tangents(patch, u, v):
    """The tangent vectors and their cross product, the oriented normal of the patch at (u, v).

        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        N = p_u × p_v

    Source: eqs. (1) and (14); 33 operations as written, 33 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_u_x = a_x * u + b_x * v + d_x
    p_u_y = a_y * u + b_y * v + d_y
    p_u_z = a_z * u + b_z * v + d_z
    p_v_x = b_x * u + c_x * v + e_x
    p_v_y = b_y * u + c_y * v + e_y
    p_v_z = b_z * u + c_z * v + e_z
    N_x = p_u_y * p_v_z - p_u_z * p_v_y
    N_y = p_u_z * p_v_x - p_u_x * p_v_z
    N_z = p_u_x * p_v_y - p_u_y * p_v_x
    return Vector(p_u_x, p_u_y, p_u_z), Vector(p_v_x, p_v_y, p_v_z), Vector(N_x, N_y, N_z)


@inline
def hessian(A, B, C, D, p_u, p_v):
    """The Hessian of the support function; for a unit normal its eigenvalues on the tangent
    plane are the signed principal radii, positive on a sphere with outward normals.

        s = (B*p_v - C*p_u)/D
        t = (B*p_u - A*p_v)/D
        H_xx = p_u_x*s_x + p_v_x*t_x
        H_yy = p_u_y*s_y + p_v_y*t_y
        H_zz = p_u_z*s_z + p_v_z*t_z
        H_xy = p_u_x*s_y + p_v_x*t_y
        H_xz = p_u_x*s_z + p_v_x*t_z
        H_yz = p_u_y*s_z + p_v_y*t_z

    Source: beyond the paper; 42 operations as written, 43 here.
    """
    p_u_x, p_u_y, p_u_z = p_u
    p_v_x, p_v_y, p_v_z = p_v
    t0 = 1.0 / D
    s_x = t0 * (B * p_v_x - C * p_u_x)
    s_y = t0 * (B * p_v_y - C * p_u_y)
    s_z = t0 * (B * p_v_z - C * p_u_z)
    t_x = t0 * (B * p_u_x - A * p_v_x)
    t_y = t0 * (B * p_u_y - A * p_v_y)
    t_z = t0 * (B * p_u_z - A * p_v_z)
    H_xx = p_u_x * s_x + p_v_x * t_x
    H_yy = p_u_y * s_y + p_v_y * t_y
    H_zz = p_u_z * s_z + p_v_z * t_z
    H_xy = p_u_x * s_y + p_v_x * t_y
    H_xz = p_u_x * s_z + p_v_x * t_z
    H_yz = p_u_y * s_z + p_v_y * t_z
    return Hessian(H_xx, H_yy, H_zz, H_xy, H_xz, H_yz)


@inline
def principal_radii(A, B, C, D, p_u, p_v, N):
    """Sum and product of the signed principal radii of curvature for a unit normal n: trace and
    determinant of the Hessian of the support function on the tangent plane.

        E = |p_u|**2
        F = p_u·p_v
        G = |p_v|**2
        R_1 + R_2 = (2*B*F - A*G - C*E)/D
        R_1*R_2 = |N|**2/D

    Source: beyond the paper; 28 operations as written, 29 here.
    """
    p_u_x, p_u_y, p_u_z = p_u
    p_v_x, p_v_y, p_v_z = p_v
    N_x, N_y, N_z = N
    E = p_u_x * p_u_x + p_u_y * p_u_y + p_u_z * p_u_z
    F = p_u_x * p_v_x + p_u_y * p_v_y + p_u_z * p_v_z
    G = p_v_x * p_v_x + p_v_y * p_v_y + p_v_z * p_v_z
    t0 = 1.0 / D
    R_sum = t0 * (2 * B * F - A * G - C * E)
    R_product = t0 * (N_x * N_x + N_y * N_y + N_z * N_z)
    return R_sum, R_product


@inline
def curvature(A, B, C, D, p_u, p_v, N):
    """Gaussian and mean curvature for a unit normal n: the reciprocal of the product of the
    principal radii, and half the sum of their reciprocals (positive on a sphere with outward
    normals).

        E = |p_u|**2
        F = p_u·p_v
        G = |p_v|**2
        g = 1/|N|**2
        K = D*g
        H = g*(2*B*F - A*G - C*E)/2

    Source: beyond the paper; 30 operations as written, 30 here.
    """
    p_u_x, p_u_y, p_u_z = p_u
    p_v_x, p_v_y, p_v_z = p_v
    N_x, N_y, N_z = N
    E = p_u_x * p_u_x + p_u_y * p_u_y + p_u_z * p_u_z
    F = p_u_x * p_v_x + p_u_y * p_v_y + p_u_z * p_v_z
    G = p_v_x * p_v_x + p_v_y * p_v_y + p_v_z * p_v_z
    g = 1.0 / (N_x * N_x + N_y * N_y + N_z * N_z)
    K = D * g
    H = 0.5 * g * (2 * B * F - A * G - C * E)
    return K, H


@inline
def orientation(patch, n):
    """Twice the cubic form c_3, with p_u × p_v = n c_3/D^2: n is the oriented normal of the
    patch where c_3 > 0, and -n where c_3 < 0.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e
        dU = B*e - C*d - P*c + Q*b
        dV = B*d - A*e + P*b - Q*a
        dD = A*c - 2*B*b + C*a
        2*c_3 = det(dU, dV, dD)

    Source: beyond the paper; 99 operations as written, 97 here.
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
    dU_x = B * e_x - C * d_x - P * c_x + Q * b_x
    dU_y = B * e_y - C * d_y - P * c_y + Q * b_y
    dU_z = B * e_z - C * d_z - P * c_z + Q * b_z
    dV_x = B * d_x - A * e_x + P * b_x - Q * a_x
    dV_y = B * d_y - A * e_y + P * b_y - Q * a_y
    dV_z = B * d_z - A * e_z + P * b_z - Q * a_z
    t0 = 2 * B
    dD_x = A * c_x + C * a_x - b_x * t0
    dD_y = A * c_y + C * a_y - b_y * t0
    dD_z = A * c_z + C * a_z - b_z * t0
    c3_twice = (
        dU_x * (dD_z * dV_y - dD_y * dV_z)
        + dU_y * (dD_x * dV_z - dD_z * dV_x)
        + dU_z * (dD_y * dV_x - dD_x * dV_y)
    )
    return c3_twice


@inline
def gaussian_curvature_closed_form(D, c3_twice, n):
    """The Gaussian curvature as a rational function of the normal (of any length) alone;
    kernels use the equal formula `curvature`, which does not overflow.

        K = D**5/(c_3**2*|n|**4)

    Source: beyond the paper; 14 operations as written, 14 here.
    """
    n_x, n_y, n_z = n
    n_n = n_x * n_x + n_y * n_y + n_z * n_z
    K = 4 * D * D * D * D * D / (c3_twice * c3_twice * n_n * n_n)
    return K


@inline
def control_normals(patch):
    """The Bézier net of the normal field N(u,v) = p_u × p_v: every oriented normal of the patch
    is a non-negative combination of these six vectors.

        s100 = a + d
        t100 = b + e
        s010 = b + d
        t010 = c + e
        s001 = d
        t001 = e
        N200 = s100 × t100
        N110 = (s010 × t100 + s100 × t010)/2
        N101 = (s001 × t100 + s100 × t001)/2
        N020 = s010 × t010
        N011 = (s001 × t010 + s010 × t001)/2
        N002 = s001 × t001

    Source: Sect. 3.2, eq. (14); 138 operations as written, 122 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    s100_x = a_x + d_x
    s100_y = a_y + d_y
    s100_z = a_z + d_z
    t100_x = b_x + e_x
    t100_y = b_y + e_y
    t100_z = b_z + e_z
    s010_x = b_x + d_x
    s010_y = b_y + d_y
    s010_z = b_z + d_z
    t010_x = c_x + e_x
    t010_y = c_y + e_y
    t010_z = c_z + e_z
    s001_x = d_x
    s001_y = d_y
    s001_z = d_z
    t001_x = e_x
    t001_y = e_y
    t001_z = e_z
    N200_x = s100_y * t100_z - s100_z * t100_y
    N200_y = s100_z * t100_x - s100_x * t100_z
    N200_z = s100_x * t100_y - s100_y * t100_x
    t0 = 0.5 * t100_z
    t1 = 0.5 * s010_z
    t2 = 0.5 * t010_z
    t3 = 0.5 * s100_z
    N110_x = s010_y * t0 + s100_y * t2 - t010_y * t3 - t1 * t100_y
    N110_y = 0.5 * s010_z * t100_x - s010_x * t0 - s100_x * t2 + 0.5 * s100_z * t010_x
    t4 = 0.5 * t100_y
    t5 = 0.5 * t100_x
    t6 = 0.5 * s100_x
    t7 = 0.5 * s100_y
    N110_z = s010_x * t4 - s010_y * t5 - t010_x * t7 + t010_y * t6
    N101_x = s001_y * t0 - s001_z * t4 - t001_y * t3 + t001_z * t7
    N101_y = 0.5 * s001_z * t100_x - s001_x * t0 + 0.5 * s100_z * t001_x - t001_z * t6
    N101_z = s001_x * t4 - s001_y * t5 - t001_x * t7 + t001_y * t6
    N020_x = s010_y * t010_z - s010_z * t010_y
    N020_y = s010_z * t010_x - s010_x * t010_z
    N020_z = s010_x * t010_y - s010_y * t010_x
    t8 = 0.5 * t001_z
    N011_x = s001_y * t2 - 0.5 * s001_z * t010_y + s010_y * t8 - t001_y * t1
    N011_y = 0.5 * s001_z * t010_x - s001_x * t2 - s010_x * t8 + 0.5 * s010_z * t001_x
    N011_z = (
        0.5 * s001_x * t010_y
        - 0.5 * s001_y * t010_x
        + 0.5 * s010_x * t001_y
        - 0.5 * s010_y * t001_x
    )
    N002_x = s001_y * t001_z - s001_z * t001_y
    N002_y = s001_z * t001_x - s001_x * t001_z
    N002_z = s001_x * t001_y - s001_y * t001_x
    return (
        Vector(N200_x, N200_y, N200_z),
        Vector(N110_x, N110_y, N110_z),
        Vector(N101_x, N101_y, N101_z),
        Vector(N020_x, N020_y, N020_z),
        Vector(N011_x, N011_y, N011_z),
        Vector(N002_x, N002_y, N002_z),
    )


@inline
def parabolic_cubic(patch):
    """The Bézier net of D(N(u,v)), a cubic whose zeros are the parabolic points of the patch
    and whose sign is that of the Gaussian curvature; it vanishes when the patch is developable.
    abc is the determinant of a, b, c, and so on.

        abc = det(a, b, c)
        abd = det(a, b, d)
        abe = det(a, b, e)
        acd = det(a, c, d)
        ace = det(a, c, e)
        ade = det(a, d, e)
        bcd = det(b, c, d)
        bce = det(b, c, e)
        bde = det(b, d, e)
        cde = det(c, d, e)
        D300 = abc*ade - abc*abd + abd*ace - abd*bcd - abd*cde - abe**2 + 2*abe*bde - ace*ade
             + ade*bcd + ade*cde - bde**2
        D210 = (abc*ade - abc*abe - abc*acd + abd*ace - abd*bcd + abd*bce - abe**2 - abe*ace
             - abe*bcd + abe*cde + acd*ace - acd*bcd - acd*cde - ade*bce)/3 + 2*(abc*bde
             - abd*cde - ace*ade + ade*bcd + bcd*bde)/3 + 4*abe*bde/3 + ade*cde - bde**2
        D201 = (abc*ade + abd*ace - abd*bcd - abe**2)/3 - 2*(abd*cde + ace*ade - ade*bcd)/3
             + 4*abe*bde/3 + ade*cde - bde**2
        D120 = 2*(abc*bde + abe*bde + abe*cde - acd*cde - ade*bce)/3 - (abc*ace + abc*bcd
             - abc*cde - abd*bce + abd*cde + abe*ace + abe*bcd + abe*bce - acd*ace + acd*bcd
             - acd*bce + ace*ade - ade*bcd + bcd**2)/3 + ade*cde + 4*bcd*bde/3 - bde**2
        D111 = (abc*bde - abd*cde + abe*cde - acd*cde - ace*ade + ade*bcd - ade*bce)/3
             + (abd*bce - abe*ace - abe*bcd + acd*ace - acd*bcd)/6 + 2*abe*bde/3 + ade*cde
             + 2*bcd*bde/3 - bde**2
        D102 = 2*abe*bde/3 - (abd*cde + ace*ade - ade*bcd)/3 + ade*cde - bde**2
        D030 = abc*cde - abc*bce - abe*bce + abe*cde + acd*bce - acd*cde - ade*bce + ade*cde
             - bcd**2 + 2*bcd*bde - bde**2
        D021 = (abc*cde - abe*bce + acd*bce - bcd**2)/3 + 2*(abe*cde - acd*cde - ade*bce)/3
             + ade*cde + 4*bcd*bde/3 - bde**2
        D012 = (abe*cde - acd*cde - ade*bce)/3 + ade*cde + 2*bcd*bde/3 - bde**2
        D003 = ade*cde - bde**2

    Source: Sect. 3.2 and Remark 3.1; 442 operations as written, 295 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    abc = (
        a_x * (b_y * c_z - b_z * c_y)
        + a_y * (b_z * c_x - b_x * c_z)
        + a_z * (b_x * c_y - b_y * c_x)
    )
    abd = (
        a_x * (b_y * d_z - b_z * d_y)
        + a_y * (b_z * d_x - b_x * d_z)
        + a_z * (b_x * d_y - b_y * d_x)
    )
    abe = (
        a_x * (b_y * e_z - b_z * e_y)
        + a_y * (b_z * e_x - b_x * e_z)
        + a_z * (b_x * e_y - b_y * e_x)
    )
    t0 = c_y * d_z - c_z * d_y
    t1 = c_z * d_x - c_x * d_z
    t2 = c_x * d_y - c_y * d_x
    acd = a_x * t0 + a_y * t1 + a_z * t2
    t3 = c_y * e_z - c_z * e_y
    t4 = c_z * e_x - c_x * e_z
    t5 = c_x * e_y - c_y * e_x
    ace = a_x * t3 + a_y * t4 + a_z * t5
    t6 = d_y * e_z - d_z * e_y
    t7 = d_z * e_x - d_x * e_z
    t8 = d_x * e_y - d_y * e_x
    ade = a_x * t6 + a_y * t7 + a_z * t8
    bcd = b_x * t0 + b_y * t1 + b_z * t2
    bce = b_x * t3 + b_y * t4 + b_z * t5
    bde = b_x * t6 + b_y * t7 + b_z * t8
    cde = c_x * t6 + c_y * t7 + c_z * t8
    t9 = abe * abe
    t10 = abd * bcd
    t11 = abd * cde
    t12 = ace * ade
    t13 = bde * bde
    t14 = t13 - ade * cde
    D300 = (
        abc * ade - abc * abd + abd * ace + 2 * abe * bde + ade * bcd - t10 - t11 - t12 - t14 - t9
    )
    t15 = (1.0 / 3.0) * t9
    t16 = (1.0 / 3.0) * abc
    t17 = (1.0 / 3.0) * t10
    t18 = acd * cde
    t19 = (1.0 / 3.0) * t18
    t20 = ade * bce
    t21 = (1.0 / 3.0) * t20
    t22 = (2.0 / 3.0) * t11
    t23 = (2.0 / 3.0) * t12
    t24 = (1.0 / 3.0) * abe
    t25 = (
        (1.0 / 3.0) * acd * bcd
        - (2.0 / 3.0) * abc * bde
        - (1.0 / 3.0) * abd * bce
        - (1.0 / 3.0) * acd * ace
        + ace * t24
        + bcd * t24
    )
    D210 = (
        (1.0 / 3.0) * abc * ade
        + (1.0 / 3.0) * abd * ace
        + (4.0 / 3.0) * abe * bde
        + (1.0 / 3.0) * abe * cde
        - abe * t16
        - acd * t16
        + (2.0 / 3.0) * ade * bcd
        + (2.0 / 3.0) * bcd * bde
        - t14
        - t15
        - t17
        - t19
        - t21
        - t22
        - t23
        - t25
    )
    t26 = ade * bcd
    t27 = abe * bde
    t28 = ade * cde - t13
    D201 = (
        (1.0 / 3.0) * abc * ade
        + (1.0 / 3.0) * abd * ace
        - t15
        - t17
        - t22
        - t23
        + (2.0 / 3.0) * t26
        + (4.0 / 3.0) * t27
        + t28
    )
    t29 = bcd * bcd
    t30 = (1.0 / 3.0) * t29
    t31 = abe * bce
    t32 = (1.0 / 3.0) * t31
    t33 = (2.0 / 3.0) * t18
    t34 = (2.0 / 3.0) * t20
    t35 = (1.0 / 3.0) * t11
    t36 = (1.0 / 3.0) * t12
    t37 = t14 - (2.0 / 3.0) * abe * bde - (1.0 / 3.0) * ade * bcd + t35 + t36
    D120 = (
        (1.0 / 3.0) * abc * cde
        + (2.0 / 3.0) * abe * cde
        + (1.0 / 3.0) * acd * bce
        - ace * t16
        + (4.0 / 3.0) * bcd * bde
        - bcd * t16
        - t25
        - t30
        - t32
        - t33
        - t34
        - t37
    )
    t38 = (1.0 / 6.0) * abe
    t39 = (1.0 / 6.0) * acd
    t40 = abe * cde
    t41 = (2.0 / 3.0) * bcd * bde - t19 - t21 + t28 + (1.0 / 3.0) * t40
    D111 = (
        (1.0 / 6.0) * abd * bce
        - ace * t38
        + ace * t39
        - bcd * t38
        - bcd * t39
        + bde * t16
        + (1.0 / 3.0) * t26
        + (2.0 / 3.0) * t27
        - t35
        - t36
        + t41
    )
    D102 = -t37
    D030 = (
        abc * cde - abc * bce + abe * cde + acd * bce + 2 * bcd * bde - t14 - t18 - t20 - t29 - t31
    )
    D021 = (
        (1.0 / 3.0) * abc * cde
        + (1.0 / 3.0) * acd * bce
        + (4.0 / 3.0) * bcd * bde
        + t28
        - t30
        - t32
        - t33
        - t34
        + (2.0 / 3.0) * t40
    )
    D012 = t41
    D003 = t28
    return D300, D210, D201, D120, D111, D102, D030, D021, D012, D003


@inline
def measure(patch, u, v):
    """Area of the patch and signed area of its Gaussian image (negative where the patch is
    hyperbolic), both per area of the parameter plane.

        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        N = p_u × p_v
        A = N·a
        B = N·b
        C = N·c
        dA = |N|
        dS = (A*C - B**2)/(dA*|N|**2)

    Source: beyond the paper; 64 operations as written, 59 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_u_x = a_x * u + b_x * v + d_x
    p_u_y = a_y * u + b_y * v + d_y
    p_u_z = a_z * u + b_z * v + d_z
    p_v_x = b_x * u + c_x * v + e_x
    p_v_y = b_y * u + c_y * v + e_y
    p_v_z = b_z * u + c_z * v + e_z
    N_x = p_u_y * p_v_z - p_u_z * p_v_y
    N_y = p_u_z * p_v_x - p_u_x * p_v_z
    N_z = p_u_x * p_v_y - p_u_y * p_v_x
    A = N_x * a_x + N_y * a_y + N_z * a_z
    B = N_x * b_x + N_y * b_y + N_z * b_z
    C = N_x * c_x + N_y * c_y + N_z * c_z
    t0 = N_x * N_x + N_y * N_y + N_z * N_z
    dA = math.sqrt(t0)
    dS = (A * C - B * B) / (dA * t0)
    return dA, dS


@inline
def sample(patch, n):
    """The fields of a sample: parameters, point, oriented normal, curvatures.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e
        D = A*C - B**2
        U = B*Q - C*P
        V = B*P - A*Q
        r = 1/D
        u = U*r
        v = V*r
        x = a*u**2/2 + b*u*v + c*v**2/2 + d*u + e*v + p
        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        N = p_u × p_v
        E = |p_u|**2
        F = p_u·p_v
        G = |p_v|**2
        g = 1/|N|**2
        K = D*g
        H = g*(2*B*F - A*G - C*E)/2

    Source: eqs. (1), (5)-(9); curvatures beyond the paper; 145 operations as written, 134 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    n_x, n_y, n_z = n
    A = a_x * n_x + a_y * n_y + a_z * n_z
    B = b_x * n_x + b_y * n_y + b_z * n_z
    C = c_x * n_x + c_y * n_y + c_z * n_z
    P = d_x * n_x + d_y * n_y + d_z * n_z
    Q = e_x * n_x + e_y * n_y + e_z * n_z
    D = A * C - B * B
    U = B * Q - C * P
    V = B * P - A * Q
    r = 1.0 / D
    u = U * r
    v = V * r
    t0 = b_x * v
    t1 = 0.5 * u * u
    t2 = 0.5 * v * v
    x_x = a_x * t1 + c_x * t2 + d_x * u + e_x * v + p_x + t0 * u
    t3 = b_y * v
    x_y = a_y * t1 + c_y * t2 + d_y * u + e_y * v + p_y + t3 * u
    t4 = b_z * v
    x_z = a_z * t1 + c_z * t2 + d_z * u + e_z * v + p_z + t4 * u
    p_u_x = a_x * u + d_x + t0
    p_u_y = a_y * u + d_y + t3
    p_u_z = a_z * u + d_z + t4
    p_v_x = b_x * u + c_x * v + e_x
    p_v_y = b_y * u + c_y * v + e_y
    p_v_z = b_z * u + c_z * v + e_z
    N_x = p_u_y * p_v_z - p_u_z * p_v_y
    N_y = p_u_z * p_v_x - p_u_x * p_v_z
    N_z = p_u_x * p_v_y - p_u_y * p_v_x
    E = p_u_x * p_u_x + p_u_y * p_u_y + p_u_z * p_u_z
    F = p_u_x * p_v_x + p_u_y * p_v_y + p_u_z * p_v_z
    G = p_v_x * p_v_x + p_v_y * p_v_y + p_v_z * p_v_z
    g = 1.0 / (N_x * N_x + N_y * N_y + N_z * N_z)
    K = D * g
    H = 0.5 * g * (2 * B * F - A * G - C * E)
    return u, v, Vector(x_x, x_y, x_z), Vector(N_x, N_y, N_z), K, H


@inline
def curvature_at(patch, n, u, v):
    """Gaussian and mean curvature at given parameters u, v, where n is the unit normal.

        A = n·a
        B = n·b
        C = n·c
        D = A*C - B**2
        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        N = p_u × p_v
        E = |p_u|**2
        F = p_u·p_v
        G = |p_v|**2
        g = 1/|N|**2
        K = D*g
        H = g*(2*B*F - A*G - C*E)/2

    Source: eqs. (1), (9); curvatures beyond the paper; 81 operations as written, 81 here.
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
    D = A * C - B * B
    p_u_x = a_x * u + b_x * v + d_x
    p_u_y = a_y * u + b_y * v + d_y
    p_u_z = a_z * u + b_z * v + d_z
    p_v_x = b_x * u + c_x * v + e_x
    p_v_y = b_y * u + c_y * v + e_y
    p_v_z = b_z * u + c_z * v + e_z
    N_x = p_u_y * p_v_z - p_u_z * p_v_y
    N_y = p_u_z * p_v_x - p_u_x * p_v_z
    N_z = p_u_x * p_v_y - p_u_y * p_v_x
    E = p_u_x * p_u_x + p_u_y * p_u_y + p_u_z * p_u_z
    F = p_u_x * p_v_x + p_u_y * p_v_y + p_u_z * p_v_z
    G = p_v_x * p_v_x + p_v_y * p_v_y + p_v_z * p_v_z
    g = 1.0 / (N_x * N_x + N_y * N_y + N_z * N_z)
    K = D * g
    H = 0.5 * g * (2 * B * F - A * G - C * E)
    return K, H


@inline
def largest_curvature(K, H):
    """The larger absolute value of the two principal curvatures.

        k = Abs(H) + sqrt(Abs(H**2 - K))

    Source: beyond the paper; 6 operations as written, 6 here.
    """
    k = abs(H) + math.sqrt(abs(H * H - K))
    return k
