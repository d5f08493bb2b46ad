"""Fields of normals and rational offsets: the formulas of symbolic/offset.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from .vectors import Vector, inline


@inline
def linear_field(n_0, n_1, n_2, s, t):
    """A linear field of normals: all directions are those of n(s, t), if n_0, n_1, n_2 are
    linearly independent.

        n = n_0 + n_1*s + n_2*t

    Source: Sect. 3; 12 operations as written, 12 here.
    """
    n_0_x, n_0_y, n_0_z = n_0
    n_1_x, n_1_y, n_1_z = n_1
    n_2_x, n_2_y, n_2_z = n_2
    n_x = n_0_x + n_1_x * s + n_2_x * t
    n_y = n_0_y + n_1_y * s + n_2_y * t
    n_z = n_0_z + n_1_z * s + n_2_z * t
    return Vector(n_x, n_y, n_z)


@inline
def linear_normals(n_0, n_1, n_2, s, t, patch):
    """The patch with a linear field of normals: a rational parametrization x(s, t) whose normal
    has the direction of n(s, t).

        n = n_0 + n_1*s + n_2*t
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

    Source: Sect. 3; 94 operations as written, 84 here.
    """
    n_0_x, n_0_y, n_0_z = n_0
    n_1_x, n_1_y, n_1_z = n_1
    n_2_x, n_2_y, n_2_z = n_2
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    n_x = n_0_x + n_1_x * s + n_2_x * t
    n_y = n_0_y + n_1_y * s + n_2_y * t
    n_z = n_0_z + n_1_z * s + n_2_z * t
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
    t0 = u * v
    t1 = 0.5 * u * u
    t2 = 0.5 * v * v
    x_x = a_x * t1 + b_x * t0 + c_x * t2 + d_x * u + e_x * v + p_x
    x_y = a_y * t1 + b_y * t0 + c_y * t2 + d_y * u + e_y * v + p_y
    x_z = a_z * t1 + b_z * t0 + c_z * t2 + d_z * u + e_z * v + p_z
    return Vector(n_x, n_y, n_z), Vector(x_x, x_y, x_z)


@inline
def spherical_field(e_1, e_2, e_3, s, t):
    """A field of normals whose length q is a polynomial: the stereographic projection, with
    respect to an orthonormal basis. It gives every direction except -e_3.

        n = 2*e_1*s + 2*e_2*t + e_3*(1 - s**2 - t**2)
        q = s**2 + t**2 + 1

    Source: Sect. 3; 37 operations as written, 22 here.
    """
    e_1_x, e_1_y, e_1_z = e_1
    e_2_x, e_2_y, e_2_z = e_2
    e_3_x, e_3_y, e_3_z = e_3
    t0 = 2 * s
    t1 = 2 * t
    t2 = s * s + t * t
    t3 = 1 - t2
    n_x = e_1_x * t0 + e_2_x * t1 + e_3_x * t3
    n_y = e_1_y * t0 + e_2_y * t1 + e_3_y * t3
    n_z = e_1_z * t0 + e_2_z * t1 + e_3_z * t3
    q = t2 + 1
    return Vector(n_x, n_y, n_z), q


@inline
def rational_offset(e_1, e_2, e_3, s, t, patch, R):
    """The offset of a patch at the distance R, in a rational parametrization y(s, t) without
    square roots; its normal has the direction of n(s, t).

        n = 2*e_1*s + 2*e_2*t + e_3*(1 - s**2 - t**2)
        q = s**2 + t**2 + 1
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
        y = R*n/q + x

    Source: Sect. 3; 128 operations as written, 101 here.
    """
    e_1_x, e_1_y, e_1_z = e_1
    e_2_x, e_2_y, e_2_z = e_2
    e_3_x, e_3_y, e_3_z = e_3
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    t0 = 2 * s
    t1 = 2 * t
    t2 = s * s + t * t
    t3 = 1 - t2
    n_x = e_1_x * t0 + e_2_x * t1 + e_3_x * t3
    n_y = e_1_y * t0 + e_2_y * t1 + e_3_y * t3
    n_z = e_1_z * t0 + e_2_z * t1 + e_3_z * t3
    q = t2 + 1
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
    t4 = u * v
    t5 = 0.5 * u * u
    t6 = 0.5 * v * v
    x_x = a_x * t5 + b_x * t4 + c_x * t6 + d_x * u + e_x * v + p_x
    x_y = a_y * t5 + b_y * t4 + c_y * t6 + d_y * u + e_y * v + p_y
    x_z = a_z * t5 + b_z * t4 + c_z * t6 + d_z * u + e_z * v + p_z
    t7 = R / q
    y_x = n_x * t7 + x_x
    y_y = n_y * t7 + x_y
    y_z = n_z * t7 + x_z
    return Vector(y_x, y_y, y_z)
