"""The support function of a patch, its gradient, its Hessian and the curvatures, at many normals.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""


def support_function(patch, normals, h_values):
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
    Arrays: normals (k, 3), h_values (k,).
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        A = a_x * n_x + a_y * n_y + a_z * n_z
        B = b_x * n_x + b_y * n_y + b_z * n_z
        C = c_x * n_x + c_y * n_y + c_z * n_z
        P = d_x * n_x + d_y * n_y + d_z * n_z
        Q = e_x * n_x + e_y * n_y + e_z * n_z
        D = A * C - B * B
        U = B * Q - C * P
        V = B * P - A * Q
        h = n_x * p_x + n_y * p_y + n_z * p_z + 0.5 * (P * U + Q * V) / D
        h_values[row] = h


def gradient_at_normal(patch, normals, points):
    """The gradient of the support function of a patch at the normal n: the point of the patch
    that has this normal.

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

    Source: eqs. (5)-(9); 82 operations as written, 72 here.
    Arrays: normals (k, 3), points (k, 3).
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
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
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z


def hessian_at_normal(patch, normals, hessians):
    """The Hessian of the support function of a patch at the normal n.

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

    Source: eqs. (1), (9); Hessian beyond the paper; 103 operations as written, 103 here.
    Arrays: normals (k, 3), hessians (k, 3, 3).
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        A = a_x * n_x + a_y * n_y + a_z * n_z
        B = b_x * n_x + b_y * n_y + b_z * n_z
        C = c_x * n_x + c_y * n_y + c_z * n_z
        P = d_x * n_x + d_y * n_y + d_z * n_z
        Q = e_x * n_x + e_y * n_y + e_z * n_z
        D = A * C - B * B
        U = B * Q - C * P
        V = B * P - A * Q
        t0 = 1.0 / D
        r = t0
        u = U * r
        v = V * r
        p_u_x = a_x * u + b_x * v + d_x
        p_u_y = a_y * u + b_y * v + d_y
        p_u_z = a_z * u + b_z * v + d_z
        p_v_x = b_x * u + c_x * v + e_x
        p_v_y = b_y * u + c_y * v + e_y
        p_v_z = b_z * u + c_z * v + e_z
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
        hessians[row, 0, 0] = H_xx
        hessians[row, 0, 1] = H_xy
        hessians[row, 0, 2] = H_xz
        hessians[row, 1, 0] = H_xy
        hessians[row, 1, 1] = H_yy
        hessians[row, 1, 2] = H_yz
        hessians[row, 2, 0] = H_xz
        hessians[row, 2, 1] = H_yz
        hessians[row, 2, 2] = H_zz


def curvature_at_normal(patch, normals, K_values, H_values):
    """Gaussian and mean curvature of a patch at the point that has the unit normal n.

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
        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        N = p_u × p_v
        E = |p_u|**2
        F = p_u·p_v
        G = |p_v|**2
        g = 1/|N|**2
        K = D*g
        H = g*(2*B*F - A*G - C*E)/2

    Source: eqs. (1), (9); curvatures beyond the paper; 100 operations as written, 100 here.
    Arrays: normals (k, 3), K_values (k,), H_values (k,).
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
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
        K_values[row] = K
        H_values[row] = H


def branch(patch, normals, u_values, v_values, points, hessians, K_values, H_values):
    """Point, Hessian of the support function and curvatures of a patch at the normal n, given
    its parameters.

        A = n·a
        B = n·b
        C = n·c
        D = A*C - B**2
        p_u = a*u + b*v + d
        p_v = b*u + c*v + e
        N = p_u × p_v
        x = a*u**2/2 + b*u*v + c*v**2/2 + d*u + e*v + p
        s = (B*p_v - C*p_u)/D
        t = (B*p_u - A*p_v)/D
        H_xx = p_u_x*s_x + p_v_x*t_x
        H_yy = p_u_y*s_y + p_v_y*t_y
        H_zz = p_u_z*s_z + p_v_z*t_z
        H_xy = p_u_x*s_y + p_v_x*t_y
        H_xz = p_u_x*s_z + p_v_x*t_z
        H_yz = p_u_y*s_z + p_v_y*t_z
        E = |p_u|**2
        F = p_u·p_v
        G = |p_v|**2
        g = 1/|N|**2
        K = D*g
        H = g*(2*B*F - A*G - C*E)/2

    Source: eqs. (1), (5)-(9); curvatures beyond the paper; 168 operations as written, 158 here.
    Arrays: normals (k, 3), u_values (k,), v_values (k,), points (k, 3), hessians (k, 3, 3),
    K_values (k,), H_values (k,).
    """
    a_x, a_y, a_z = patch.a
    b_x, b_y, b_z = patch.b
    c_x, c_y, c_z = patch.c
    d_x, d_y, d_z = patch.d
    e_x, e_y, e_z = patch.e
    p_x, p_y, p_z = patch.p
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        u = u_values[row]
        v = v_values[row]
        A = a_x * n_x + a_y * n_y + a_z * n_z
        B = b_x * n_x + b_y * n_y + b_z * n_z
        C = c_x * n_x + c_y * n_y + c_z * n_z
        D = A * C - B * B
        t0 = b_x * v
        p_u_x = a_x * u + d_x + t0
        t1 = b_y * v
        p_u_y = a_y * u + d_y + t1
        t2 = b_z * v
        p_u_z = a_z * u + d_z + t2
        p_v_x = b_x * u + c_x * v + e_x
        p_v_y = b_y * u + c_y * v + e_y
        p_v_z = b_z * u + c_z * v + e_z
        N_x = p_u_y * p_v_z - p_u_z * p_v_y
        N_y = p_u_z * p_v_x - p_u_x * p_v_z
        N_z = p_u_x * p_v_y - p_u_y * p_v_x
        t3 = 0.5 * u * u
        t4 = 0.5 * v * v
        x_x = a_x * t3 + c_x * t4 + d_x * u + e_x * v + p_x + t0 * u
        x_y = a_y * t3 + c_y * t4 + d_y * u + e_y * v + p_y + t1 * u
        x_z = a_z * t3 + c_z * t4 + d_z * u + e_z * v + p_z + t2 * u
        t5 = 1.0 / D
        s_x = t5 * (B * p_v_x - C * p_u_x)
        s_y = t5 * (B * p_v_y - C * p_u_y)
        s_z = t5 * (B * p_v_z - C * p_u_z)
        t_x = t5 * (B * p_u_x - A * p_v_x)
        t_y = t5 * (B * p_u_y - A * p_v_y)
        t_z = t5 * (B * p_u_z - A * p_v_z)
        H_xx = p_u_x * s_x + p_v_x * t_x
        H_yy = p_u_y * s_y + p_v_y * t_y
        H_zz = p_u_z * s_z + p_v_z * t_z
        H_xy = p_u_x * s_y + p_v_x * t_y
        H_xz = p_u_x * s_z + p_v_x * t_z
        H_yz = p_u_y * s_z + p_v_y * t_z
        E = p_u_x * p_u_x + p_u_y * p_u_y + p_u_z * p_u_z
        F = p_u_x * p_v_x + p_u_y * p_v_y + p_u_z * p_v_z
        G = p_v_x * p_v_x + p_v_y * p_v_y + p_v_z * p_v_z
        g = 1.0 / (N_x * N_x + N_y * N_y + N_z * N_z)
        K = D * g
        H = 0.5 * g * (2 * B * F - A * G - C * E)
        points[row, 0] = x_x
        points[row, 1] = x_y
        points[row, 2] = x_z
        hessians[row, 0, 0] = H_xx
        hessians[row, 0, 1] = H_xy
        hessians[row, 0, 2] = H_xz
        hessians[row, 1, 0] = H_xy
        hessians[row, 1, 1] = H_yy
        hessians[row, 1, 2] = H_yz
        hessians[row, 2, 0] = H_xz
        hessians[row, 2, 1] = H_yz
        hessians[row, 2, 2] = H_zz
        K_values[row] = K
        H_values[row] = H
