"""Support functions: the formulas of symbolic/support.py as functions of vectors.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from .vectors import Hessian, Vector, inline


@inline
def tangent_plane(n, x):
    """The support function at the normal n of the point x: the distance of the tangent plane
    from the origin.

        h = n·x

    Source: eqs. (2) and (4); 5 operations as written, 5 here.
    """
    n_x, n_y, n_z = n
    x_x, x_y, x_z = x
    h = n_x * x_x + n_y * x_y + n_z * x_z
    return h


@inline
def intrinsic_gradient(dh, n):
    """The intrinsic gradient dh_S of a function on the unit sphere: the gradient dh of any
    extension of it, projected into the tangent plane of the sphere.

        g = dh·n
        dh_S = dh - g*n

    Source: eq. (6); 11 operations as written, 11 here.
    """
    dh_x, dh_y, dh_z = dh
    n_x, n_y, n_z = n
    g = dh_x * n_x + dh_y * n_y + dh_z * n_z
    dh_S_x = dh_x - g * n_x
    dh_S_y = dh_y - g * n_y
    dh_S_z = dh_z - g * n_z
    return Vector(dh_S_x, dh_S_y, dh_S_z)


@inline
def envelope_operator(h, dh_S, n):
    """The point of the envelope of the tangent planes, for any function h on the unit sphere;
    linear in h, so that the sum of functions gives the convolution of surfaces.

        x = dh_S + h*n

    Source: eqs. (5) and (7); 6 operations as written, 6 here.
    """
    dh_S_x, dh_S_y, dh_S_z = dh_S
    n_x, n_y, n_z = n
    x_x = dh_S_x + h * n_x
    x_y = dh_S_y + h * n_y
    x_z = dh_S_z + h * n_z
    return Vector(x_x, x_y, x_z)


@inline
def hessian_of_extension(h, n, dh, h_xx, h_yy, h_zz, h_xy, h_xz, h_yz):
    """The Hessian, at a unit normal n, of |n| h(n/|n|): it follows from value, gradient and
    second derivatives of any function h that has the same values on the sphere.

        q_x = h_xx*n_x + h_xy*n_y + h_xz*n_z
        q_y = h_xy*n_x + h_yy*n_y + h_yz*n_z
        q_z = h_xz*n_x + h_yz*n_y + h_zz*n_z
        r = n_x*q_x + n_y*q_y + n_z*q_z
        g = dh·n
        k = h - g
        H_xx = h_xx + k + n_x**2*(r - k) - 2*n_x*q_x
        H_yy = h_yy + k + n_y**2*(r - k) - 2*n_y*q_y
        H_zz = h_zz + k + n_z**2*(r - k) - 2*n_z*q_z
        H_xy = h_xy + n_x*n_y*(r - k) - n_x*q_y - n_y*q_x
        H_xz = h_xz + n_x*n_z*(r - k) - n_x*q_z - n_z*q_x
        H_yz = h_yz + n_y*n_z*(r - k) - n_y*q_z - n_z*q_y

    Source: beyond the paper; 74 operations as written, 65 here.
    """
    n_x, n_y, n_z = n
    dh_x, dh_y, dh_z = dh
    q_x = h_xx * n_x + h_xy * n_y + h_xz * n_z
    q_y = h_xy * n_x + h_yy * n_y + h_yz * n_z
    q_z = h_xz * n_x + h_yz * n_y + h_zz * n_z
    t0 = n_x * q_x
    t1 = n_y * q_y
    t2 = n_z * q_z
    r = t0 + t1 + t2
    g = dh_x * n_x + dh_y * n_y + dh_z * n_z
    k = h - g
    t3 = r - k
    H_xx = h_xx + k + n_x * n_x * t3 - 2 * t0
    H_yy = h_yy + k + n_y * n_y * t3 - 2 * t1
    H_zz = h_zz + k + n_z * n_z * t3 - 2 * t2
    t4 = n_x * t3
    H_xy = h_xy - n_x * q_y - n_y * q_x + n_y * t4
    H_xz = h_xz - n_x * q_z - n_z * q_x + n_z * t4
    H_yz = h_yz + n_y * n_z * t3 - n_y * q_z - n_z * q_y
    return Hessian(H_xx, H_yy, H_zz, H_xy, H_xz, H_yz)


@inline
def offset(R, n):
    """The sphere of radius R, h = R|n|, at a unit normal n: envelope and Hessian. Its
    convolution with a surface is the offset at the distance R.

        x = R*n
        H_xx = R*(1 - n_x**2)
        H_yy = R*(1 - n_y**2)
        H_zz = R*(1 - n_z**2)
        H_xy = - R*n_x*n_y
        H_xz = - R*n_x*n_z
        H_yz = - R*n_y*n_z

    Source: eqs. (5)-(7); 21 operations as written, 18 here.
    """
    n_x, n_y, n_z = n
    t0 = R * n_x
    x_x = t0
    t1 = R * n_y
    x_y = t1
    x_z = R * n_z
    H_xx = R * (1 - n_x * n_x)
    H_yy = R * (1 - n_y * n_y)
    H_zz = R * (1 - n_z * n_z)
    H_xy = -n_y * t0
    H_xz = -n_z * t0
    H_yz = -n_z * t1
    return Vector(x_x, x_y, x_z), Hessian(H_xx, H_yy, H_zz, H_xy, H_xz, H_yz)


@inline
def offset_curvature(K, H, R):
    """Gaussian and mean curvature of the offset at the distance R; principal radii may be
    infinite. s is the factor by which the product of the radii grows, 0 where one of them
    becomes 0.

        s = 2*H*R + K*R**2 + 1
        K_offset = K/s
        H_offset = (H + K*R)/s

    Source: beyond the paper; 10 operations as written, 11 here.
    """
    s = 2 * H * R + K * R * R + 1
    t0 = 1.0 / s
    K_offset = K * t0
    H_offset = t0 * (H + K * R)
    return s, K_offset, H_offset


@inline
def offset_growth(K, H, R):
    """The factors by which an offset at the distance R stretches the surface along its two
    principal directions: their product s and their mean m. Both are positive where R has passed
    no radius of curvature; elsewhere the offset is folded.

        s = 2*H*R + K*R**2 + 1
        m = H*R + 1

    Source: beyond the paper; 8 operations as written, 7 here.
    """
    t0 = H * R
    s = K * R * R + 2 * t0 + 1
    m = t0 + 1
    return s, m


@inline
def curvature_from_hessian(n, hessian):
    """Gaussian and mean curvature from the Hessian of a support function at a unit normal n. m
    is the mean of the principal radii, q their product and S the square of half their
    difference.

        m = (H_xx + H_yy + H_zz)/2
        T_xx = H_xx - m*(1 - n_x**2)
        T_yy = H_yy - m*(1 - n_y**2)
        T_zz = H_zz - m*(1 - n_z**2)
        T_xy = H_xy + m*n_x*n_y
        T_xz = H_xz + m*n_x*n_z
        T_yz = H_yz + m*n_y*n_z
        q = H_xx*H_yy + H_xx*H_zz - H_xy**2 - H_xz**2 + H_yy*H_zz - H_yz**2
        S = (T_xx**2 + T_yy**2 + T_zz**2)/2 + T_xy**2 + T_xz**2 + T_yz**2
        K = 1/q
        H = m/q

    Source: beyond the paper; 53 operations as written, 52 here.
    """
    n_x, n_y, n_z = n
    H_xx, H_yy, H_zz, H_xy, H_xz, H_yz = hessian
    m = 0.5 * H_xx + 0.5 * H_yy + 0.5 * H_zz
    T_xx = H_xx - m * (1 - n_x * n_x)
    T_yy = H_yy - m * (1 - n_y * n_y)
    T_zz = H_zz - m * (1 - n_z * n_z)
    t0 = m * n_x
    T_xy = H_xy + n_y * t0
    T_xz = H_xz + n_z * t0
    T_yz = H_yz + m * n_y * n_z
    q = H_xx * H_yy + H_xx * H_zz - H_xy * H_xy - H_xz * H_xz + H_yy * H_zz - H_yz * H_yz
    S = (
        0.5 * T_xx * T_xx
        + T_xy * T_xy
        + T_xz * T_xz
        + 0.5 * T_yy * T_yy
        + T_yz * T_yz
        + 0.5 * T_zz * T_zz
    )
    t1 = 1.0 / q
    K = t1
    H = m * t1
    return m, q, S, K, H


@inline
def parameters_at(patch, n):
    """The parameters at which a patch has the normal n, from its vectors.

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

    Source: eq. (9); 37 operations as written, 37 here.
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
    r = 1.0 / D
    u = U * r
    v = V * r
    return u, v


@inline
def hessian_at(patch, n, u, v):
    """The Hessian of the support function of a patch at given parameters.

        A = n·a
        B = n·b
        C = n·c
        D = A*C - B**2
        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        s = (B*p_v - C*p_u)/D
        t = (B*p_u - A*p_v)/D
        H_xx = p_u_x*s_x + p_v_x*t_x
        H_yy = p_u_y*s_y + p_v_y*t_y
        H_zz = p_u_z*s_z + p_v_z*t_z
        H_xy = p_u_x*s_y + p_v_x*t_y
        H_xz = p_u_x*s_z + p_v_x*t_z
        H_yz = p_u_y*s_z + p_v_y*t_z

    Source: eqs. (1), (9); Hessian beyond the paper; 84 operations as written, 85 here.
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
