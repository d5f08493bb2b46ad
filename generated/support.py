"""Support functions: envelope, Hessian, curvatures.

Written by `make generate` (python -m gaussmap.symbolic): do not edit, change symbolic/ instead.
SymPy 1.14.0. Passes: common subexpressions of all outputs together, in canonical order;
temporaries that are used once or are another name with a sign written back. float64, no
fast-math.
"""

import math

import numba
import numpy as np

OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False}


def jit(function):
    """Compile on the first call; keep the machine code on disk where a folder can be written."""
    try:
        return numba.njit(cache=True, **OPTIONS)(function)
    except RuntimeError:  # no writable cache folder
        return numba.njit(**OPTIONS)(function)


SCALE = 8.0
NEIGHBOURS = np.array(
    [
        [[-1, -1], [0, -1], [1, -1], [-1, 0], [0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]],
        [[1, -1], [1, 0], [1, 1], [0, -1], [0, 0], [0, 1], [-1, -1], [-1, 0], [-1, 1]],
        [[1, 1], [0, 1], [-1, 1], [1, 0], [0, 0], [-1, 0], [1, -1], [0, -1], [-1, -1]],
        [[-1, 1], [-1, 0], [-1, -1], [0, 1], [0, 0], [0, -1], [1, 1], [1, 0], [1, -1]],
    ]
)
CORNERS = np.array(
    [
        [[-0.5, -0.5], [0.5, -0.5]],
        [[0.5, -0.5], [0.5, 0.5]],
        [[0.5, 0.5], [-0.5, 0.5]],
        [[-0.5, 0.5], [-0.5, -0.5]],
    ]
)


# --- formulas -------------------------------------------------------------------------------------


@jit
def triangle(
    mu_sw_x, mu_sw_y, mu_sw_z, mu_s_x, mu_s_y, mu_s_z, mu_se_x, mu_se_y, mu_se_z, mu_w_x,
    mu_w_y, mu_w_z, mu_e_x, mu_e_y, mu_e_z, mu_n_x, mu_n_y, mu_n_z
):  # fmt: skip
    """The vectors of the quadratic patch over the south triangle of a cell, times 8, from the
    differences mu_s, … of the neighbouring coefficients from that of the cell: integer weights,
    so that integers give exact results.

        a = 2*(mu_e + mu_n - mu_s - mu_w) + 4*mu_sw
        b = 2*(mu_n - mu_e + mu_s - mu_w)
        c = 2*(mu_n - mu_e - mu_s + mu_w) + 4*mu_se
        d = 2*(mu_s - mu_e - mu_n + mu_w)
        e = 2*(mu_e - mu_n + mu_s - mu_w)
        p = mu_e + mu_n + mu_s + mu_w

    Source: Sect. 3.1 and eq. (8); 126 operations as written, 69 here.
    """
    t0 = 2 * mu_w_x
    t1 = 2 * mu_n_x
    t2 = 2 * mu_s_x
    t3 = 2 * mu_e_x
    t4 = t3 - t2
    t5 = t1 - t0 + t4
    a_x = 4 * mu_sw_x + t5
    t6 = 2 * mu_w_y
    t7 = 2 * mu_n_y
    t8 = 2 * mu_s_y
    t9 = 2 * mu_e_y
    t10 = t9 - t8
    t11 = t10 - t6 + t7
    a_y = 4 * mu_sw_y + t11
    t12 = 2 * mu_w_z
    t13 = 2 * mu_n_z
    t14 = 2 * mu_s_z
    t15 = 2 * mu_e_z
    t16 = t15 - t14
    t17 = t13 - t12 + t16
    a_z = 4 * mu_sw_z + t17
    b_x = t1 - t0 - t4
    b_y = t7 - t10 - t6
    b_z = t13 - t12 - t16
    c_x = 4 * mu_se_x + t0 + t1 - t2 - t3
    c_y = 4 * mu_se_y + t6 + t7 - t8 - t9
    c_z = 4 * mu_se_z + t12 + t13 - t14 - t15
    d_x = -t5
    d_y = -t11
    d_z = -t17
    e_x = t2 - t0 - t1 + t3
    e_y = t8 - t6 - t7 + t9
    e_z = t14 - t12 - t13 + t15
    p_x = mu_e_x + mu_n_x + mu_s_x + mu_w_x
    p_y = mu_e_y + mu_n_y + mu_s_y + mu_w_y
    p_z = mu_e_z + mu_n_z + mu_s_z + mu_w_z
    return a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z


@jit
def patch_vectors(mu, i, j, turn, scale):
    """Return a, b, c, d, e, p of one patch, times SCALE * scale, p relative to its coefficient."""
    mu_sw_x = scale * (mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 0] - mu[i, j, 0])
    mu_sw_y = scale * (mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 1] - mu[i, j, 1])
    mu_sw_z = scale * (mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 2] - mu[i, j, 2])
    mu_s_x = scale * (mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 0] - mu[i, j, 0])
    mu_s_y = scale * (mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 1] - mu[i, j, 1])
    mu_s_z = scale * (mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 2] - mu[i, j, 2])
    mu_se_x = scale * (mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 0] - mu[i, j, 0])
    mu_se_y = scale * (mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 1] - mu[i, j, 1])
    mu_se_z = scale * (mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 2] - mu[i, j, 2])
    mu_w_x = scale * (mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 0] - mu[i, j, 0])
    mu_w_y = scale * (mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 1] - mu[i, j, 1])
    mu_w_z = scale * (mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 2] - mu[i, j, 2])
    mu_e_x = scale * (mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 0] - mu[i, j, 0])
    mu_e_y = scale * (mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 1] - mu[i, j, 1])
    mu_e_z = scale * (mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 2] - mu[i, j, 2])
    mu_n_x = scale * (mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 0] - mu[i, j, 0])
    mu_n_y = scale * (mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 1] - mu[i, j, 1])
    mu_n_z = scale * (mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 2] - mu[i, j, 2])
    return triangle(
        mu_sw_x, mu_sw_y, mu_sw_z, mu_s_x, mu_s_y, mu_s_z, mu_se_x, mu_se_y, mu_se_z, mu_w_x,
        mu_w_y, mu_w_z, mu_e_x, mu_e_y, mu_e_z, mu_n_x, mu_n_y, mu_n_z
    )  # fmt: skip


# --- one patch ------------------------------------------------------------------------------------

OUTSIDE = 0
INSIDE = 1
DOUBTFUL = 2


@jit
def classify(vectors, bound, accurate, shortest, normals, kinds, parameters):
    """Say of each normal whether it is one of a patch, and write u, v (k, 2) of those INSIDE.

    `vectors` are a, b, c, d, e; `bound` is the rounding error of U, V, W. D has to exceed `accurate`,
    and N `shortest`. Normals have a length of about 1. Whatever rounding may have changed is
    DOUBTFUL.
    """
    (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z) = vectors
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        # forms (eq. (9) and Sect. 3.2): 36 operations as written, 36 here
        A = a_x * n_x + a_y * n_y + a_z * n_z
        B = b_x * n_x + b_y * n_y + b_z * n_z
        C = c_x * n_x + c_y * n_y + c_z * n_z
        P = d_x * n_x + d_y * n_y + d_z * n_z
        Q = e_x * n_x + e_y * n_y + e_z * n_z
        D = A * C - B * B
        U = B * Q - C * P
        V = B * P - A * Q
        W = D - U - V
        low = min(U, V, W)
        high = max(U, V, W)
        kinds[row] = OUTSIDE
        if low < -bound and high > bound:
            continue
        kinds[row] = DOUBTFUL
        if (low > bound or high < -bound) and abs(D) > accurate:
            # parameters (eq. (9)): 3 operations as written, 3 here
            r = 1.0 / D
            u = U * r
            v = V * r
            # tangents (eqs. (1) and (14)): 33 operations as written, 33 here
            p_u_x = a_x * u + b_x * v + d_x
            p_u_y = a_y * u + b_y * v + d_y
            p_u_z = a_z * u + b_z * v + d_z
            p_v_x = b_x * u + c_x * v + e_x
            p_v_y = b_y * u + c_y * v + e_y
            p_v_z = b_z * u + c_z * v + e_z
            N_x = p_u_y * p_v_z - p_u_z * p_v_y
            N_y = p_u_z * p_v_x - p_u_x * p_v_z
            N_z = p_u_x * p_v_y - p_u_y * p_v_x
            towards = n_x * N_x + n_y * N_y + n_z * N_z
            size = abs(N_x) + abs(N_y) + abs(N_z)
            if abs(towards) > 0.25 * size and size > shortest:
                kinds[row] = INSIDE if towards > 0.0 else OUTSIDE
                parameters[row, 0] = u
                parameters[row, 1] = v


@jit
def fill_branches(vectors, origin, size, normals, parameters, points, hessians, gaussian, mean):
    """Write what a patch has at unit normals (k, 3) with the parameters (k, 2).

    `vectors` are a, b, c, d, e, times `size`; the point u = v = 0 is at `origin`.
    """
    (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z) = vectors
    p_x = 0.0
    p_y = 0.0
    p_z = 0.0
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        u = parameters[row, 0]
        v = parameters[row, 1]
        # branch (eqs. (1), (5)-(9); curvatures beyond the paper): 168 operations as written, 158 here
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
        points[row, 0] = origin[0] + x_x / size
        points[row, 1] = origin[1] + x_y / size
        points[row, 2] = origin[2] + x_z / size
        hessians[row, 0, 0] = H_xx / size
        hessians[row, 1, 1] = H_yy / size
        hessians[row, 2, 2] = H_zz / size
        hessians[row, 0, 1] = H_xy / size
        hessians[row, 1, 0] = H_xy / size
        hessians[row, 0, 2] = H_xz / size
        hessians[row, 2, 0] = H_xz / size
        hessians[row, 1, 2] = H_yz / size
        hessians[row, 2, 1] = H_yz / size
        gaussian[row] = K * size * size
        mean[row] = H * size


# --- a spline -------------------------------------------------------------------------------------


@jit
def fill_hessians(mu, scale, patches, normals, known, hessians):
    """Write the Hessians (k, 3, 3) of the support function at unit normals (k, 3) of patches (k,).

    known (k, 2) holds u, v where they are known better than from the normal, which is then that of the
    patch there; else NaN.
    """
    columns = mu.shape[1] - 2
    size = SCALE * scale
    for row in range(patches.size):
        cell = patches[row] // 4
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(
            mu, cell // columns + 1, cell % columns + 1, patches[row] % 4, scale
        )  # fmt: skip
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        u = known[row, 0]
        v = known[row, 1]
        if math.isnan(u):
            # parameters_at (eq. (9)): 37 operations as written, 37 here
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
        else:
            # tangents (eqs. (1) and (14)): 33 operations as written, 33 here
            p_u_x = a_x * u + b_x * v + d_x
            p_u_y = a_y * u + b_y * v + d_y
            p_u_z = a_z * u + b_z * v + d_z
            p_v_x = b_x * u + c_x * v + e_x
            p_v_y = b_y * u + c_y * v + e_y
            p_v_z = b_z * u + c_z * v + e_z
            N_x = p_u_y * p_v_z - p_u_z * p_v_y
            N_y = p_u_z * p_v_x - p_u_x * p_v_z
            N_z = p_u_x * p_v_y - p_u_y * p_v_x
            length = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z)
            n_x = N_x / length
            n_y = N_y / length
            n_z = N_z / length
        # hessian_at (eqs. (1), (9); Hessian beyond the paper): 84 operations as written, 85 here
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
        hessians[row, 0, 0] = H_xx / size
        hessians[row, 1, 1] = H_yy / size
        hessians[row, 2, 2] = H_zz / size
        hessians[row, 0, 1] = H_xy / size
        hessians[row, 1, 0] = H_xy / size
        hessians[row, 0, 2] = H_xz / size
        hessians[row, 2, 0] = H_xz / size
        hessians[row, 1, 2] = H_yz / size
        hessians[row, 2, 1] = H_yz / size


# --- any support function -------------------------------------------------------------------------


# A sum that is smaller than its terms by this factor has lost digits.
CANCELLED = math.ldexp(1.0, -20)


@jit
def add_offset(R, normals, points, hessians, gaussian, mean, doubtful):
    """Add a sphere of radius R to points and Hessians at unit normals (k, 3), change curvatures.

    Where a radius was 0 or becomes 0, nearly, these are `doubtful` (k,).
    """
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        # offset (eqs. (5)-(7)): 21 operations as written, 18 here
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
        points[row, 0] += x_x
        points[row, 1] += x_y
        points[row, 2] += x_z
        hessians[row, 0, 0] += H_xx
        hessians[row, 1, 1] += H_yy
        hessians[row, 2, 2] += H_zz
        hessians[row, 0, 1] += H_xy
        hessians[row, 1, 0] += H_xy
        hessians[row, 0, 2] += H_xz
        hessians[row, 2, 0] += H_xz
        hessians[row, 1, 2] += H_yz
        hessians[row, 2, 1] += H_yz
        K = gaussian[row]
        H = mean[row]
        # offset_curvature (beyond the paper): 10 operations as written, 11 here
        s = 2 * H * R + K * R * R + 1
        t0 = 1.0 / s
        K_offset = K * t0
        H_offset = t0 * (H + K * R)
        gaussian[row] = K_offset
        mean[row] = H_offset
        terms = 1.0 + 2.0 * abs(R * H) + abs(R * R * K)
        doubtful[row] = not abs(s) > CANCELLED * terms


@jit
def offset_curvatures(R, rounding, gaussian, mean, folded):
    """Change the curvatures (k,) to those of the offset, and say where R has passed a radius.

    Where a radius becomes 0, up to the `rounding` of the sum that says so, Gaussian curvature is
    infinite with its old sign (NaN if it was 0) and mean curvature NaN.
    """
    for row in range(gaussian.size):
        K = gaussian[row]
        H = mean[row]
        # offset_curvature (beyond the paper): 10 operations as written, 11 here
        s = 2 * H * R + K * R * R + 1
        t0 = 1.0 / s
        K_offset = K * t0
        H_offset = t0 * (H + K * R)
        # offset_growth (beyond the paper): 8 operations as written, 7 here
        t0 = H * R
        s = K * R * R + 2 * t0 + 1
        m = t0 + 1
        terms = 1.0 + 2.0 * abs(R * H) + abs(R * R * K)
        vanishing = terms < math.inf and abs(s) <= rounding * terms
        gaussian[row] = K * math.inf if vanishing else K_offset
        mean[row] = math.nan if vanishing else H_offset
        folded[row] = vanishing or s < 0.0 or m < 0.0


@jit
def fill_support(normals, points, support):
    """Write the distances of the tangent planes from the origin."""
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        x_x = points[row, 0]
        x_y = points[row, 1]
        x_z = points[row, 2]
        # tangent_plane (eqs. (2) and (4)): 5 operations as written, 5 here
        h = n_x * x_x + n_y * x_y + n_z * x_z
        support[row] = h


@jit
def fill_curvatures(normals, hessians, radii, gaussian, mean):
    """Write principal radii (k, 2), the larger one first, and curvatures from Hessians (k, 3, 3)."""
    for row in range(normals.shape[0]):
        n_x = normals[row, 0]
        n_y = normals[row, 1]
        n_z = normals[row, 2]
        H_xx = hessians[row, 0, 0]
        H_yy = hessians[row, 1, 1]
        H_zz = hessians[row, 2, 2]
        H_xy = hessians[row, 0, 1]
        H_xz = hessians[row, 0, 2]
        H_yz = hessians[row, 1, 2]
        # curvature_from_hessian (beyond the paper): 53 operations as written, 52 here
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
        radii[row, 0] = m + math.sqrt(S)
        radii[row, 1] = m - math.sqrt(S)
        gaussian[row] = K
        mean[row] = H
