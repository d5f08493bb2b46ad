"""Points with a given normal, proved: the formulas of symbolic/proved.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math

from .vectors import Vector, inline


@inline
def model_at(A, B, C, P, Q, T0, T1, T2, T3, s, t):
    """The linear forms at s, t of a cubic polynomial with the given linear forms at the origin
    and the third derivatives T0, …, T3.

        A_m = A + T0*s + T1*t
        B_m = B + T1*s + T2*t
        C_m = C + T2*s + T3*t
        P_m = A*s + B*t + P + T0*s**2/2 + T1*s*t + T2*t**2/2
        Q_m = B*s + C*t + Q + T1*s**2/2 + T2*s*t + T3*t**2/2

    Source: beyond the paper; 42 operations as written, 36 here.
    """
    t0 = T1 * t
    A_m = A + T0 * s + t0
    t1 = T2 * t
    B_m = B + T1 * s + t1
    C_m = C + T2 * s + T3 * t
    t2 = 0.5 * s * s
    t3 = 0.5 * t * t
    P_m = A * s + B * t + P + T0 * t2 + T2 * t3 + s * t0
    Q_m = B * s + C * t + Q + T1 * t2 + T3 * t3 + s * t1
    return A_m, B_m, C_m, P_m, Q_m


@inline
def remainders(T0, T1, T2, T3):
    """Bounds R and S, over a cell, of the remainders of the derivatives of heights by s and t
    beyond a quadratic patch, from bounds T0, …, T3 of the third derivatives.

        R = T0/2 + T1 + T2/2
        S = T1/2 + T2 + T3/2

    Source: beyond the paper; 8 operations as written, 8 here.
    """
    R = 0.5 * T0 + T1 + 0.5 * T2
    S = 0.5 * T1 + T2 + 0.5 * T3
    return R, S


@inline
def excesses(A, B, C, P, Q, R, S):
    """Four numbers; if one is positive, no point of the cell has the normal n. Each compares a
    derivative of the height along n at the centre, or a combination of both with one parameter
    eliminated, with its change over the cell. R and S bound the remainders beyond a quadratic
    patch.

        D = A*C - B**2
        e1 = Abs(P) - R - Abs(A) - Abs(B)
        e2 = Abs(Q) - S - Abs(B) - Abs(C)
        e3 = Abs(B*Q - C*P) - R*Abs(C) - S*Abs(B) - Abs(D)
        e4 = Abs(A*Q - B*P) - R*Abs(B) - S*Abs(A) - Abs(D)

    Source: beyond the paper; 39 operations as written, 33 here.
    """
    D = A * C - B * B
    t0 = abs(A)
    t1 = abs(B)
    e1 = abs(P) - R - t0 - t1
    t2 = abs(C)
    e2 = abs(Q) - S - t1 - t2
    t3 = abs(D)
    e3 = abs(B * Q - C * P) - R * t2 - S * t1 - t3
    e4 = abs(A * Q - B * P) - R * t1 - S * t0 - t3
    return e1, e2, e3, e4


@inline
def contraction(A, B, C, T0, T1, T2, T3, R0, R1, R2, R3):
    """The inverse y11, y12, y22 of the Hessian A, B, C at the centre, and bounds q1 and q2 of
    the rows of its product with the change of the Hessian over the cell, whose third
    derivatives are T0, …, T3 up to R0, …, R3. If both bounds are below 1, at most one point of
    the cell has the normal n or -n.

        D = A*C - B**2
        y11 = C/D
        y12 = - B/D
        y22 = A/D
        q1 = R0*Abs(y11) + 2*(R1*Abs(y11) + R2*Abs(y12) + Abs(T1*y11 + T2*y12)) + R1*Abs(y12)
           + R2*Abs(y11) + R3*Abs(y12) + Abs(T0*y11 + T1*y12) + Abs(T2*y11 + T3*y12)
        q2 = R0*Abs(y12) + 2*(R1*Abs(y12) + R2*Abs(y22) + Abs(T1*y12 + T2*y22)) + R1*Abs(y22)
           + R2*Abs(y12) + R3*Abs(y22) + Abs(T0*y12 + T1*y22) + Abs(T2*y12 + T3*y22)

    Source: beyond the paper; 77 operations as written, 65 here.
    """
    D = A * C - B * B
    t0 = 1.0 / D
    y11 = C * t0
    y12 = -B * t0
    y22 = A * t0
    t1 = abs(y11)
    t2 = abs(y12)
    t3 = R1 * t2
    t4 = R2 * t2
    t5 = T1 * y12
    t6 = T2 * y12
    q1 = (
        R0 * t1
        + 2 * R1 * t1
        + R2 * t1
        + R3 * t2
        + t3
        + 2 * t4
        + abs(T0 * y11 + t5)
        + 2 * abs(T1 * y11 + t6)
        + abs(T2 * y11 + T3 * y12)
    )
    t7 = abs(y22)
    q2 = (
        R0 * t2
        + R1 * t7
        + 2 * R2 * t7
        + R3 * t7
        + 2 * t3
        + t4
        + abs(T0 * y12 + T1 * y22)
        + 2 * abs(T2 * y22 + t5)
        + abs(T3 * y22 + t6)
    )
    return y11, y12, y22, q1, q2


@inline
def normal_ordinates(patch):
    """The Bernstein ordinates of x_s × x_t of a patch over the cell: its normals lie in the
    cone that they span.

        N0 = a × b + a × c - a × e + b × c - b × e - d × b - d × c + d × e
        N1 = a × b - a × e - b × c - d × b + d × e
        N2 = a × b - a × c - a × e + b × c + b × e - d × b + d × c + d × e
        N3 = b × c - a × b - b × e - d × c + d × e
        N4 = d × e - a × b - b × c
        N5 = b × c - a × b + b × e + d × c + d × e
        N6 = a × b - a × c + a × e + b × c - b × e + d × b - d × c + d × e
        N7 = a × b + a × e - b × c + d × b + d × e
        N8 = a × b + a × c + a × e + b × c + b × e + d × b + d × c + d × e

    Source: beyond the paper; 633 operations as written, 183 here.
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    t0 = b_z * e_y
    t1 = c_y * d_z
    t2 = b_y * e_z
    t3 = c_z * d_y
    t4 = t0 + t1 - t2 - t3
    t5 = b_y * c_z
    t6 = b_z * c_y
    t7 = t5 - t6
    t8 = d_z * e_y
    t9 = a_y * b_z - a_z * b_y
    t10 = d_y * e_z - t8 + t9
    t11 = a_z * e_y
    t12 = b_y * d_z
    t13 = a_y * e_z
    t14 = b_z * d_y
    t15 = t11 + t12 - t13 - t14
    t16 = t10 + t15 + t7
    t17 = a_y * c_z
    t18 = a_z * c_y
    t19 = t17 - t18
    N0_x = t16 + t19 + t4
    t20 = b_z * e_x
    t21 = c_x * d_z
    t22 = b_x * e_z
    t23 = c_z * d_x
    t24 = t20 + t21 - t22 - t23
    t25 = b_x * c_z
    t26 = b_z * c_x
    t27 = t25 - t26
    t28 = d_x * e_z
    t29 = a_x * b_z - a_z * b_x
    t30 = t28 - d_z * e_x + t29
    t31 = a_z * e_x
    t32 = b_x * d_z
    t33 = a_x * e_z
    t34 = b_z * d_x
    t35 = t31 + t32 - t33 - t34
    t36 = t27 + t30 + t35
    t37 = a_x * c_z
    t38 = a_z * c_x
    t39 = t37 - t38
    N0_y = -t24 - t36 - t39
    t40 = b_y * e_x
    t41 = c_x * d_y
    t42 = b_x * e_y
    t43 = c_y * d_x
    t44 = t40 + t41 - t42 - t43
    t45 = b_x * c_y
    t46 = b_y * c_x
    t47 = t45 - t46
    t48 = d_y * e_x
    t49 = a_x * b_y - a_y * b_x
    t50 = d_x * e_y - t48 + t49
    t51 = a_y * e_x
    t52 = b_x * d_y
    t53 = a_x * e_y
    t54 = b_y * d_x
    t55 = t51 + t52 - t53 - t54
    t56 = t47 + t50 + t55
    t57 = a_x * c_y
    t58 = a_y * c_x
    t59 = t57 - t58
    N0_z = t44 + t56 + t59
    t60 = t6 - t5
    t61 = t10 + t60
    N1_x = t15 + t61
    t62 = t26 - t25
    t63 = t30 + t62
    N1_y = -t35 - t63
    t64 = t46 - t45
    t65 = t50 + t64
    N1_z = t55 + t65
    t66 = t2 - t0 - t1 + t3
    t67 = t18 - t17
    N2_x = t16 + t66 + t67
    t68 = t22 - t20 - t21 + t23
    t69 = t38 - t37
    N2_y = -t36 - t68 - t69
    t70 = t42 - t40 - t41 + t43
    t71 = t58 - t57
    N2_z = t56 + t70 + t71
    t72 = t8 - d_y * e_z + t9
    t73 = t60 + t72
    N3_x = -t66 - t73
    t74 = d_z * e_x - t28 + t29
    t75 = t62 + t74
    N3_y = t68 + t75
    t76 = t48 - d_x * e_y + t49
    t77 = t64 + t76
    N3_z = -t70 - t77
    N4_x = -t7 - t72
    N4_y = t27 + t74
    N4_z = -t47 - t76
    N5_x = -t4 - t73
    N5_y = t24 + t75
    N5_z = -t44 - t77
    t78 = t13 - t11 - t12 + t14
    t79 = t10 + t7 + t78
    N6_x = t4 + t67 + t79
    t80 = t33 - t31 - t32 + t34
    t81 = t27 + t30 + t80
    N6_y = -t24 - t69 - t81
    t82 = t53 - t51 - t52 + t54
    t83 = t47 + t50 + t82
    N6_z = t44 + t71 + t83
    N7_x = t61 + t78
    N7_y = -t63 - t80
    N7_z = t65 + t82
    N8_x = t19 + t66 + t79
    N8_y = -t39 - t68 - t81
    N8_z = t59 + t70 + t83
    return (
        Vector(N0_x, N0_y, N0_z),
        Vector(N1_x, N1_y, N1_z),
        Vector(N2_x, N2_y, N2_z),
        Vector(N3_x, N3_y, N3_z),
        Vector(N4_x, N4_y, N4_z),
        Vector(N5_x, N5_y, N5_z),
        Vector(N6_x, N6_y, N6_z),
        Vector(N7_x, N7_y, N7_z),
        Vector(N8_x, N8_y, N8_z),
    )


@inline
def turned(T0, T1, T2, T3, R0, R1, R2, R3, x, y):
    """The third derivatives by i and j in turned coordinates, s = x i - y j, t = y i + x j,
    from those by s and t: T0, …, T3 up to R0, …, R3.

        M0 = T0*x**3 + 3*T1*x**2*y + 3*T2*x*y**2 + T3*y**3
        M1 = T1*x**3 - T0*x**2*y - 2*T1*x*y**2 + 2*T2*x**2*y - T2*y**3 + T3*x*y**2
        M2 = T0*x*y**2 - 2*T1*x**2*y + T1*y**3 + T2*x**3 - 2*T2*x*y**2 + T3*x**2*y
        M3 = 3*T1*x*y**2 - T0*y**3 - 3*T2*x**2*y + T3*x**3
        S0 = R0*x**2*Abs(x) + 3*R1*x**2*Abs(y) + 3*R2*y**2*Abs(x) + R3*y**2*Abs(y)
        S1 = R0*x**2*Abs(y) + R1*x**2*Abs(x) + 2*R1*y**2*Abs(x) + 2*R2*x**2*Abs(y)
           + R2*y**2*Abs(y) + R3*y**2*Abs(x)
        S2 = R0*y**2*Abs(x) + 2*R1*x**2*Abs(y) + R1*y**2*Abs(y) + R2*x**2*Abs(x)
           + 2*R2*y**2*Abs(x) + R3*x**2*Abs(y)
        S3 = R0*y**2*Abs(y) + 3*R1*y**2*Abs(x) + 3*R2*x**2*Abs(y) + R3*x**2*Abs(x)

    Source: beyond the paper; 188 operations as written, 100 here.
    """
    t0 = x * x * x
    t1 = y * y * y
    t2 = x * x
    t3 = t2 * y
    t4 = T1 * t3
    t5 = y * y
    t6 = t5 * x
    t7 = T2 * t6
    M0 = T0 * t0 + T3 * t1 + 3 * t4 + 3 * t7
    M1 = T1 * t0 - T0 * t3 - 2 * T1 * t6 - T2 * t1 + 2 * T2 * t2 * y + T3 * t5 * x
    M2 = T0 * t6 + T1 * t1 + T2 * t0 + T3 * t3 - 2 * t4 - 2 * t7
    M3 = 3 * T1 * t5 * x - T0 * t1 - 3 * T2 * t3 + T3 * t0
    t8 = abs(x)
    t9 = R0 * t2
    t10 = abs(y)
    t11 = t10 * t5
    t12 = t10 * t2
    t13 = R1 * t12
    t14 = t5 * t8
    t15 = R2 * t14
    S0 = R3 * t11 + 3 * t13 + 3 * t15 + t8 * t9
    t16 = t2 * t8
    t17 = R1 * t14
    t18 = R2 * t12
    S1 = R1 * t16 + R2 * t11 + R3 * t14 + t10 * t9 + 2 * t17 + 2 * t18
    S2 = R0 * t14 + R1 * t11 + R2 * t16 + R3 * t12 + 2 * t13 + 2 * t15
    S3 = R0 * t11 + R3 * t16 + 3 * t17 + 3 * t18
    return M0, M1, M2, M3, S0, S1, S2, S3


@inline
def turned_forms(A, B, C, P, Q, x, y):
    """The linear forms by i and j in turned coordinates, s = x i - y j, t = y i + x j.

        A_m = A*x**2 + 2*B*x*y + C*y**2
        B_m = B*x**2 - A*x*y - B*y**2 + C*x*y
        C_m = A*y**2 - 2*B*x*y + C*x**2
        P_m = P*x + Q*y
        Q_m = Q*x - P*y

    Source: beyond the paper; 35 operations as written, 27 here.
    """
    t0 = x * x
    t1 = y * y
    t2 = x * y
    t3 = 2 * B * t2
    A_m = A * t0 + C * t1 + t3
    B_m = B * t0 - A * t2 - B * t1 + C * x * y
    C_m = A * t1 + C * t0 - t3
    P_m = P * x + Q * y
    Q_m = Q * x - P * y
    return A_m, B_m, C_m, P_m, Q_m


@inline
def fold_curve(A, P, G0, G1, G2, h, W, o1, o2):
    """The curve i(j) on which the derivative by i of the height along n vanishes, in a
    rectangle with the half widths h and W. m > 0 bounds the second derivative by i from below,
    and k the slope of the curve. g bounds the difference between the second derivative of the
    other equation along the curve and the third derivative by j. The curve reaches from -W to W
    if z < 0. A and P are derivatives by i at the centre, where that by i and j vanishes; G0,
    G1, G2 bound third derivatives, and o1, o2 the rounding of first and second ones.

        m = Abs(A) - G0*h - G1*W - o2
        k = (G1*h + G2*W + o2)/m
        g = G0*k**3 + 3*G1*k**2 + 3*G2*k
        z = G2*W**2/2 + W*o2 - h*m + o1 + Abs(P)

    Source: beyond the paper; 31 operations as written, 31 here.
    """
    m = abs(A) - G0 * h - G1 * W - o2
    k = (G1 * h + G2 * W + o2) / m
    g = G0 * k * k * k + 3 * G1 * k * k + 3 * G2 * k
    z = 0.5 * G2 * W * W + W * o2 - h * m + o1 + abs(P)
    return m, k, g, z


@inline
def fold_extreme(A, B, C, P, Q, G0, G1, G2, k, m, c2, o1, o2):
    """A test of the other equation near its extreme value along the curve of `fold_curve`,
    where its second derivative is at least c2 in absolute value: it has no zero if |Q| > r and
    Q has the sign of this derivative. Otherwise zeros are at most y away by j, and z by i.

        o3 = (o1 + Abs(P))/m
        g = o2*(k + 1)**2 + o3*(G0*k**2 + 2*G1*k + G2) + Abs(C - B**2/A)
        h = k*(o1 + Abs(P)) + o1
        r = h + g**2/(2*c2)
        y = (g + sqrt(2*c2*(h + Abs(Q)) + g**2))/c2
        z = k*y + o3

    Source: beyond the paper; 39 operations as written, 37 here.
    """
    t0 = o1 + abs(P)
    o3 = t0 / m
    g = o2 * (k + 1) * (k + 1) + o3 * (G0 * k * k + 2 * G1 * k + G2) + abs(C - B * B / A)
    h = k * t0 + o1
    t1 = 1.0 / c2
    t2 = g * g
    r = h + 0.5 * t1 * t2
    y = t1 * (g + math.sqrt(2 * c2 * (h + abs(Q)) + t2))
    z = k * y + o3
    return r, y, z
