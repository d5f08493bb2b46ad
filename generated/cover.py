"""Covering: samples near every point, as near as a density asks.

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
NODE = 1.0 / 6.0

# Cells of the grids are so many times as wide as the widest gap that is looked for in them.
CELL = 2.0
# As many powers of two as a gap can be wide.
LEVELS = 1100
# Steps towards the centre of a ball.
STEPS = 12
# Control normals shorter than this, relative to the square of the tangents, are rounding.
SINGULAR = math.ldexp(1.0, -40)


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
def part_normals(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, u0, v0, u1, v1,
    u2, v2
):  # fmt: skip
    """The Bézier net of the normal field over a part of the domain, a triangle with three
    corners.

        s001 = a*u0 + b*v0 + d
        t001 = b*u0 + c*v0 + e
        s100 = a*u1 + b*v1 + d
        t100 = b*u1 + c*v1 + e
        s010 = a*u2 + b*v2 + d
        t010 = b*u2 + c*v2 + e
        N200 = s100 × t100
        N110 = (s010 × t100 + s100 × t010)/2
        N101 = (s001 × t100 + s100 × t001)/2
        N020 = s010 × t010
        N011 = (s001 × t010 + s010 × t001)/2
        N002 = s001 × t001

    Source: Sect. 3.2, eq. (14); 198 operations as written, 182 here.
    """
    s001_x = a_x * u0 + b_x * v0 + d_x
    s001_y = a_y * u0 + b_y * v0 + d_y
    s001_z = a_z * u0 + b_z * v0 + d_z
    t001_x = b_x * u0 + c_x * v0 + e_x
    t001_y = b_y * u0 + c_y * v0 + e_y
    t001_z = b_z * u0 + c_z * v0 + e_z
    s100_x = a_x * u1 + b_x * v1 + d_x
    s100_y = a_y * u1 + b_y * v1 + d_y
    s100_z = a_z * u1 + b_z * v1 + d_z
    t100_x = b_x * u1 + c_x * v1 + e_x
    t100_y = b_y * u1 + c_y * v1 + e_y
    t100_z = b_z * u1 + c_z * v1 + e_z
    s010_x = a_x * u2 + b_x * v2 + d_x
    s010_y = a_y * u2 + b_y * v2 + d_y
    s010_z = a_z * u2 + b_z * v2 + d_z
    t010_x = b_x * u2 + c_x * v2 + e_x
    t010_y = b_y * u2 + c_y * v2 + e_y
    t010_z = b_z * u2 + c_z * v2 + e_z
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
        N200_x,
        N200_y,
        N200_z,
        N110_x,
        N110_y,
        N110_z,
        N101_x,
        N101_y,
        N101_z,
        N020_x,
        N020_y,
        N020_z,
        N011_x,
        N011_y,
        N011_z,
        N002_x,
        N002_y,
        N002_z,
    )


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


@jit
def cell_of(mu, patch):
    """Return the row and the column of the coefficient of the cell of a patch."""
    columns = mu.shape[1] - 2
    return patch // 4 // columns + 1, patch // 4 % columns + 1


@jit
def vectors_of(mu, scale, patch):
    """Return the vectors of a patch, of the surface times its scale."""
    i, j = cell_of(mu, patch)
    return patch_vectors(mu, i, j, patch % 4, scale)


# --- places of a patch ----------------------------------------------------------------------------


@jit
def weight_of(K, H, reach, law):
    """Return how many samples are wanted per area, up to a factor: law = (floor, bend, power, alpha).

    That is bend k^2 + power |K|^alpha for the larger principal curvature k, but at least the floor. A
    radius of curvature that is smaller than a patch is taken as large as the patch: it is an accident.
    """
    weight = 0.0
    limit = 1.0 / (reach * reach)
    if law[1] > 0.0:
        # largest_curvature (beyond the paper): 6 operations as written, 6 here
        k = abs(H) + math.sqrt(abs(H * H - K))
        weight += law[1] * at_most(k * k, limit)
    if law[2] > 0.0:
        weight += law[2] * math.pow(at_most(abs(K), limit), law[3])
    return max(weight, law[0])


@jit
def at_most(value, limit):
    """Return the smaller number, the limit for NaN."""
    return value if value < limit else limit


@jit
def weigh_patches(mu, scale, law, first, last, reaches, areas, weights):
    """Write what is wanted of the patches first, …, last − 1.

    That is how far a point can be from the middle, at most; the area that each node of a quadrature
    stands for (…, 3); and the weights at the nodes and in the middle (…, 4).
    """
    for patch in range(first, last):
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = vectors_of(mu, scale, patch)  # fmt: skip
        u0, v0, u1, v1, u2, v2 = 0.0, 0.0, 1.0, 0.0, 0.0, 1.0
        # reach (beyond the paper): 228 operations as written, 222 here
        s0_x = a_x * u0 + b_x * v0 + d_x
        s0_y = a_y * u0 + b_y * v0 + d_y
        s0_z = a_z * u0 + b_z * v0 + d_z
        t0_x = b_x * u0 + c_x * v0 + e_x
        t0_y = b_y * u0 + c_y * v0 + e_y
        t0_z = b_z * u0 + c_z * v0 + e_z
        s1_x = a_x * u1 + b_x * v1 + d_x
        s1_y = a_y * u1 + b_y * v1 + d_y
        s1_z = a_z * u1 + b_z * v1 + d_z
        t1_x = b_x * u1 + c_x * v1 + e_x
        t1_y = b_y * u1 + c_y * v1 + e_y
        t1_z = b_z * u1 + c_z * v1 + e_z
        s2_x = a_x * u2 + b_x * v2 + d_x
        s2_y = a_y * u2 + b_y * v2 + d_y
        s2_z = a_z * u2 + b_z * v2 + d_z
        t2_x = b_x * u2 + c_x * v2 + e_x
        t2_y = b_y * u2 + c_y * v2 + e_y
        t2_z = b_z * u2 + c_z * v2 + e_z
        t0 = (1.0 / 3.0) * u1
        t1 = (1.0 / 3.0) * u2
        du0 = (2.0 / 3.0) * u0 - t0 - t1
        t2 = (1.0 / 3.0) * v1
        t3 = (1.0 / 3.0) * v2
        dv0 = (2.0 / 3.0) * v0 - t2 - t3
        t4 = (1.0 / 3.0) * u0
        du1 = (2.0 / 3.0) * u1 - t1 - t4
        t5 = (1.0 / 3.0) * v0
        dv1 = (2.0 / 3.0) * v1 - t3 - t5
        du2 = (2.0 / 3.0) * u2 - t0 - t4
        dv2 = (2.0 / 3.0) * v2 - t2 - t5
        q00_x = du0 * s0_x + dv0 * t0_x
        q00_y = du0 * s0_y + dv0 * t0_y
        q00_z = du0 * s0_z + dv0 * t0_z
        q01_x = du1 * s0_x + dv1 * t0_x
        q01_y = du1 * s0_y + dv1 * t0_y
        q01_z = du1 * s0_z + dv1 * t0_z
        q02_x = du2 * s0_x + dv2 * t0_x
        q02_y = du2 * s0_y + dv2 * t0_y
        q02_z = du2 * s0_z + dv2 * t0_z
        q10_x = du0 * s1_x + dv0 * t1_x
        q10_y = du0 * s1_y + dv0 * t1_y
        q10_z = du0 * s1_z + dv0 * t1_z
        q11_x = du1 * s1_x + dv1 * t1_x
        q11_y = du1 * s1_y + dv1 * t1_y
        q11_z = du1 * s1_z + dv1 * t1_z
        q12_x = du2 * s1_x + dv2 * t1_x
        q12_y = du2 * s1_y + dv2 * t1_y
        q12_z = du2 * s1_z + dv2 * t1_z
        q20_x = du0 * s2_x + dv0 * t2_x
        q20_y = du0 * s2_y + dv0 * t2_y
        q20_z = du0 * s2_z + dv0 * t2_z
        q21_x = du1 * s2_x + dv1 * t2_x
        q21_y = du1 * s2_y + dv1 * t2_y
        q21_z = du1 * s2_z + dv1 * t2_z
        q22_x = du2 * s2_x + dv2 * t2_x
        q22_y = du2 * s2_y + dv2 * t2_y
        q22_z = du2 * s2_z + dv2 * t2_z
        r00 = q00_x * q00_x + q00_y * q00_y + q00_z * q00_z
        r01 = q01_x * q01_x + q01_y * q01_y + q01_z * q01_z
        r02 = q02_x * q02_x + q02_y * q02_y + q02_z * q02_z
        r10 = q10_x * q10_x + q10_y * q10_y + q10_z * q10_z
        r11 = q11_x * q11_x + q11_y * q11_y + q11_z * q11_z
        r12 = q12_x * q12_x + q12_y * q12_y + q12_z * q12_z
        r20 = q20_x * q20_x + q20_y * q20_y + q20_z * q20_z
        r21 = q21_x * q21_x + q21_y * q21_y + q21_z * q21_z
        r22 = q22_x * q22_x + q22_y * q22_y + q22_z * q22_z
        extent = math.sqrt(max(r00, r01, r02, r10, r11, r12, r20, r21, r22))
        reaches[patch] = extent
        for node in range(4):
            u = 1.0 / 3.0 if node == 3 else 1.0 - 2.0 * NODE if node == 0 else NODE
            v = 1.0 / 3.0 if node == 3 else 1.0 - 2.0 * NODE if node == 1 else NODE
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
            weights[patch, node] = law[0]
            if node < 3:
                areas[patch, node] = length / 6.0
            if length > 0.0:
                n_x = N_x / length
                n_y = N_y / length
                n_z = N_z / length
                # curvature_at (eqs. (1), (9); curvatures beyond the paper): 81 operations as written, 81 here
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
                weights[patch, node] = weight_of(K, H, reaches[patch], law)


@jit
def cut_patches(parts, ends, first, last, patches, corners):
    """Cut the patches first, …, last − 1 into parts² equal triangles each, up to number `ends`.

    Writes the patch of each, and (u, v) of its corners (…, 3, 2).
    """
    for patch in range(first, last):
        step = 1.0 / parts[patch]
        k = ends[patch] - parts[patch] * parts[patch]
        for i in range(parts[patch]):
            for j in range(2 * (parts[patch] - i) - 1):
                turned = j % 2
                patches[k] = patch
                for corner in range(3):
                    corners[k, corner, 0] = (i + (turned ^ (corner == 1))) * step
                    corners[k, corner, 1] = (j // 2 + (turned ^ (corner == 2))) * step
                k += 1


@jit
def next_patch(patches, first, last):
    """Return the first of the numbers first, …, last whose patch is another than that of `first`."""
    end = first
    while end < last and patches[end] == patches[first]:
        end += 1
    return end


@jit
def middles(mu, scale, patches, corners, first, last, law, reaches, rows):
    """Write point, normal, weight and K (…, 8) in the middle of the triangles first, …, last − 1.

    All is that of the surface times its scale. The point is relative to the first coefficient. The
    normal is zero where there is none.
    """
    size = SCALE * scale
    end = first
    while end < last:
        begin, end = end, next_patch(patches, end, last)
        patch = patches[begin]
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = vectors_of(mu, scale, patch)  # fmt: skip
        i, j = cell_of(mu, patch)
        centre_x = (mu[i, j, 0] - mu[0, 0, 0]) * size
        centre_y = (mu[i, j, 1] - mu[0, 0, 1]) * size
        centre_z = (mu[i, j, 2] - mu[0, 0, 2]) * size
        for k in range(begin, end):
            u = (corners[k, 0, 0] + corners[k, 1, 0] + corners[k, 2, 0]) / 3.0
            v = (corners[k, 0, 1] + corners[k, 1, 1] + corners[k, 2, 1]) / 3.0
            # envelope (eqs. (5)-(8)): 45 operations as written, 35 here
            t0 = u * v
            t1 = 0.5 * u * u
            t2 = 0.5 * v * v
            x_x = a_x * t1 + b_x * t0 + c_x * t2 + d_x * u + e_x * v + p_x
            x_y = a_y * t1 + b_y * t0 + c_y * t2 + d_y * u + e_y * v + p_y
            x_z = a_z * t1 + b_z * t0 + c_z * t2 + d_z * u + e_z * v + p_z
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
            rows[k, 0] = x_x + centre_x
            rows[k, 1] = x_y + centre_y
            rows[k, 2] = x_z + centre_z
            length = math.sqrt(N_x * N_x + N_y * N_y + N_z * N_z)
            if length == 0.0:
                rows[k, 3:8] = 0.0
                rows[k, 6] = law[0]
                continue
            n_x = N_x / length
            n_y = N_y / length
            n_z = N_z / length
            # curvature_at (eqs. (1), (9); curvatures beyond the paper): 81 operations as written, 81 here
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
            rows[k, 3] = n_x
            rows[k, 4] = n_y
            rows[k, 5] = n_z
            rows[k, 6] = weight_of(K, H, reaches[patch], law)
            rows[k, 7] = K


@jit
def extents(mu, scale, patches, corners, first, last, farthest):
    """Write how far the points of triangles are from those in their middles, at most."""
    end = first
    while end < last:
        begin, end = end, next_patch(patches, end, last)
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = vectors_of(mu, scale, patches[begin])  # fmt: skip
        for k in range(begin, end):
            u0 = corners[k, 0, 0]
            v0 = corners[k, 0, 1]
            u1 = corners[k, 1, 0]
            v1 = corners[k, 1, 1]
            u2 = corners[k, 2, 0]
            v2 = corners[k, 2, 1]
            # reach (beyond the paper): 228 operations as written, 222 here
            s0_x = a_x * u0 + b_x * v0 + d_x
            s0_y = a_y * u0 + b_y * v0 + d_y
            s0_z = a_z * u0 + b_z * v0 + d_z
            t0_x = b_x * u0 + c_x * v0 + e_x
            t0_y = b_y * u0 + c_y * v0 + e_y
            t0_z = b_z * u0 + c_z * v0 + e_z
            s1_x = a_x * u1 + b_x * v1 + d_x
            s1_y = a_y * u1 + b_y * v1 + d_y
            s1_z = a_z * u1 + b_z * v1 + d_z
            t1_x = b_x * u1 + c_x * v1 + e_x
            t1_y = b_y * u1 + c_y * v1 + e_y
            t1_z = b_z * u1 + c_z * v1 + e_z
            s2_x = a_x * u2 + b_x * v2 + d_x
            s2_y = a_y * u2 + b_y * v2 + d_y
            s2_z = a_z * u2 + b_z * v2 + d_z
            t2_x = b_x * u2 + c_x * v2 + e_x
            t2_y = b_y * u2 + c_y * v2 + e_y
            t2_z = b_z * u2 + c_z * v2 + e_z
            t0 = (1.0 / 3.0) * u1
            t1 = (1.0 / 3.0) * u2
            du0 = (2.0 / 3.0) * u0 - t0 - t1
            t2 = (1.0 / 3.0) * v1
            t3 = (1.0 / 3.0) * v2
            dv0 = (2.0 / 3.0) * v0 - t2 - t3
            t4 = (1.0 / 3.0) * u0
            du1 = (2.0 / 3.0) * u1 - t1 - t4
            t5 = (1.0 / 3.0) * v0
            dv1 = (2.0 / 3.0) * v1 - t3 - t5
            du2 = (2.0 / 3.0) * u2 - t0 - t4
            dv2 = (2.0 / 3.0) * v2 - t2 - t5
            q00_x = du0 * s0_x + dv0 * t0_x
            q00_y = du0 * s0_y + dv0 * t0_y
            q00_z = du0 * s0_z + dv0 * t0_z
            q01_x = du1 * s0_x + dv1 * t0_x
            q01_y = du1 * s0_y + dv1 * t0_y
            q01_z = du1 * s0_z + dv1 * t0_z
            q02_x = du2 * s0_x + dv2 * t0_x
            q02_y = du2 * s0_y + dv2 * t0_y
            q02_z = du2 * s0_z + dv2 * t0_z
            q10_x = du0 * s1_x + dv0 * t1_x
            q10_y = du0 * s1_y + dv0 * t1_y
            q10_z = du0 * s1_z + dv0 * t1_z
            q11_x = du1 * s1_x + dv1 * t1_x
            q11_y = du1 * s1_y + dv1 * t1_y
            q11_z = du1 * s1_z + dv1 * t1_z
            q12_x = du2 * s1_x + dv2 * t1_x
            q12_y = du2 * s1_y + dv2 * t1_y
            q12_z = du2 * s1_z + dv2 * t1_z
            q20_x = du0 * s2_x + dv0 * t2_x
            q20_y = du0 * s2_y + dv0 * t2_y
            q20_z = du0 * s2_z + dv0 * t2_z
            q21_x = du1 * s2_x + dv1 * t2_x
            q21_y = du1 * s2_y + dv1 * t2_y
            q21_z = du1 * s2_z + dv1 * t2_z
            q22_x = du2 * s2_x + dv2 * t2_x
            q22_y = du2 * s2_y + dv2 * t2_y
            q22_z = du2 * s2_z + dv2 * t2_z
            r00 = q00_x * q00_x + q00_y * q00_y + q00_z * q00_z
            r01 = q01_x * q01_x + q01_y * q01_y + q01_z * q01_z
            r02 = q02_x * q02_x + q02_y * q02_y + q02_z * q02_z
            r10 = q10_x * q10_x + q10_y * q10_y + q10_z * q10_z
            r11 = q11_x * q11_x + q11_y * q11_y + q11_z * q11_z
            r12 = q12_x * q12_x + q12_y * q12_y + q12_z * q12_z
            r20 = q20_x * q20_x + q20_y * q20_y + q20_z * q20_z
            r21 = q21_x * q21_x + q21_y * q21_y + q21_z * q21_z
            r22 = q22_x * q22_x + q22_y * q22_y + q22_z * q22_z
            extent = math.sqrt(max(r00, r01, r02, r10, r11, r12, r20, r21, r22))
            farthest[k] = extent


@jit
def halve(mu, scale, patches, corners, first, last, halves):
    """Cut triangles in the middle of their longest sides; the halves (2 …, 3, 2) follow one another."""
    end = first
    while end < last:
        begin, end = end, next_patch(patches, end, last)
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = vectors_of(mu, scale, patches[begin])  # fmt: skip
        for k in range(begin, end):
            u0 = corners[k, 0, 0]
            v0 = corners[k, 0, 1]
            u1 = corners[k, 1, 0]
            v1 = corners[k, 1, 1]
            u2 = corners[k, 2, 0]
            v2 = corners[k, 2, 1]
            # sides (beyond the paper): 162 operations as written, 162 here
            s0_x = a_x * u0 + b_x * v0 + d_x
            s0_y = a_y * u0 + b_y * v0 + d_y
            s0_z = a_z * u0 + b_z * v0 + d_z
            t0_x = b_x * u0 + c_x * v0 + e_x
            t0_y = b_y * u0 + c_y * v0 + e_y
            t0_z = b_z * u0 + c_z * v0 + e_z
            s1_x = a_x * u1 + b_x * v1 + d_x
            s1_y = a_y * u1 + b_y * v1 + d_y
            s1_z = a_z * u1 + b_z * v1 + d_z
            t1_x = b_x * u1 + c_x * v1 + e_x
            t1_y = b_y * u1 + c_y * v1 + e_y
            t1_z = b_z * u1 + c_z * v1 + e_z
            s2_x = a_x * u2 + b_x * v2 + d_x
            s2_y = a_y * u2 + b_y * v2 + d_y
            s2_z = a_z * u2 + b_z * v2 + d_z
            t2_x = b_x * u2 + c_x * v2 + e_x
            t2_y = b_y * u2 + c_y * v2 + e_y
            t2_z = b_z * u2 + c_z * v2 + e_z
            du0 = u2 - u1
            dv0 = v2 - v1
            du1 = u0 - u2
            dv1 = v0 - v2
            du2 = u1 - u0
            dv2 = v1 - v0
            q10_x = du0 * s1_x + dv0 * t1_x
            q10_y = du0 * s1_y + dv0 * t1_y
            q10_z = du0 * s1_z + dv0 * t1_z
            q20_x = du0 * s2_x + dv0 * t2_x
            q20_y = du0 * s2_y + dv0 * t2_y
            q20_z = du0 * s2_z + dv0 * t2_z
            q21_x = du1 * s2_x + dv1 * t2_x
            q21_y = du1 * s2_y + dv1 * t2_y
            q21_z = du1 * s2_z + dv1 * t2_z
            q01_x = du1 * s0_x + dv1 * t0_x
            q01_y = du1 * s0_y + dv1 * t0_y
            q01_z = du1 * s0_z + dv1 * t0_z
            q02_x = du2 * s0_x + dv2 * t0_x
            q02_y = du2 * s0_y + dv2 * t0_y
            q02_z = du2 * s0_z + dv2 * t0_z
            q12_x = du2 * s1_x + dv2 * t1_x
            q12_y = du2 * s1_y + dv2 * t1_y
            q12_z = du2 * s1_z + dv2 * t1_z
            r10 = q10_x * q10_x + q10_y * q10_y + q10_z * q10_z
            r20 = q20_x * q20_x + q20_y * q20_y + q20_z * q20_z
            r21 = q21_x * q21_x + q21_y * q21_y + q21_z * q21_z
            r01 = q01_x * q01_x + q01_y * q01_y + q01_z * q01_z
            r02 = q02_x * q02_x + q02_y * q02_y + q02_z * q02_z
            r12 = q12_x * q12_x + q12_y * q12_y + q12_z * q12_z
            side_0 = max(r10, r20)
            side_1 = max(r21, r01)
            side_2 = max(r02, r12)
            apart = 0 if side_0 >= max(side_1, side_2) else 1 if side_1 >= side_2 else 2
            left = (apart + 1) % 3
            right = (apart + 2) % 3
            for x in range(2):
                middle = 0.5 * (corners[k, left, x] + corners[k, right, x])
                for half in range(2):
                    halves[2 * k + half, 0, x] = corners[k, apart, x]
                halves[2 * k, 1, x] = corners[k, left, x]
                halves[2 * k, 2, x] = middle
                halves[2 * k + 1, 1, x] = middle
                halves[2 * k + 1, 2, x] = corners[k, right, x]


@jit
def turns(mu, scale, patches, corners, first, last, rows, widest):
    """Write how far the normals of triangles are from those in their middles, as chords, at most.

    That is 2, which says nothing, where there is none in the middle but elsewhere, or they turn by 90
    degrees: else they lie in the cone of their control normals. Those of a singular point have no
    direction.
    """
    net = np.empty((6, 3))
    end = first
    while end < last:
        begin, end = end, next_patch(patches, end, last)
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = vectors_of(mu, scale, patches[begin])  # fmt: skip
        longest = max(
            abs(a_x), abs(a_y), abs(a_z), abs(b_x), abs(b_y), abs(b_z), abs(c_x), abs(c_y), abs(c_z)
        ) + max(abs(d_x), abs(d_y), abs(d_z), abs(e_x), abs(e_y), abs(e_z))
        for k in range(begin, end):
            u0 = corners[k, 0, 0]
            v0 = corners[k, 0, 1]
            u1 = corners[k, 1, 0]
            v1 = corners[k, 1, 1]
            u2 = corners[k, 2, 0]
            v2 = corners[k, 2, 1]
            net[0, 0], net[0, 1], net[0, 2], net[1, 0], net[1, 1], net[1, 2], net[2, 0], net[2, 1], net[2, 2], net[3, 0], net[3, 1], net[3, 2], net[4, 0], net[4, 1], net[4, 2], net[5, 0], net[5, 1], net[5, 2] = part_normals(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, u0, v0, u1, v1,
                u2, v2
            )  # fmt: skip
            n_x = rows[k, 3]
            n_y = rows[k, 4]
            n_z = rows[k, 5]
            singular = n_x == 0.0 and n_y == 0.0 and n_z == 0.0
            farthest = 0.0
            for i in range(6):
                length = math.sqrt(
                    net[i, 0] * net[i, 0] + net[i, 1] * net[i, 1] + net[i, 2] * net[i, 2]
                )
                if length > SINGULAR * longest * longest:
                    x = net[i, 0] / length - n_x
                    y = net[i, 1] / length - n_y
                    z = net[i, 2] / length - n_z
                    square = x * x + y * y + z * z
                    farthest = max(farthest, square if square < 2.0 and not singular else 4.0)
            widest[k] = math.sqrt(farthest)


# --- places in grids, one grid for each size of gaps ------------------------------------------------


@jit
def level_of(weight):
    """Return the number of the grid of places with this weight; the next has cells twice as wide."""
    return LEVELS // 2 - (math.frexp(weight)[1] >> 1)


@jit
def bucket_of(level, i, j, k, buckets):
    """Return where the places of a cell of a grid are, maybe with others.

    The buckets of 4 x 4 x 4 cells are neighbours: what is near in space mostly is near in memory.
    """
    block = (i >> 2) * 73856093 ^ (j >> 2) * 19349663 ^ (k >> 2) * 83492791 ^ level * 49979687
    return ((block << 6) + ((i & 3) << 4) + ((j & 3) << 2) + (k & 3)) & (buckets - 1)


@jit
def survey(rows, box):
    """Write the box (2, 3) of places; return the number of the finest grid, and from it on the widest
    1 / sqrt(weight) of each.
    """
    widest = np.zeros(LEVELS)
    finest = LEVELS
    coarsest = 0
    for x in range(3):
        box[0, x] = box[1, x] = rows[0, x] if rows.shape[0] > 0 else 0.0
    for k in range(rows.shape[0]):
        level = level_of(rows[k, 6])
        finest = min(finest, level)
        coarsest = max(coarsest, level)
        widest[level] = max(widest[level], 1.0 / math.sqrt(rows[k, 6]))
        for x in range(3):
            box[0, x] = min(box[0, x], rows[k, x])
            box[1, x] = max(box[1, x], rows[k, x])
    return finest, widest[finest : coarsest + 1]


@jit
def sort_places(rows, radius, finest, widest, starts, buckets, order, places):
    """Sort rows into grids for a radius: `places` holds rows order[k], bucket b those from starts[b] on.

    Their last number becomes the square of the distance to the nearest sample times the weight, which
    is not known yet; where there is no normal it is -1, so that such a place never is far.
    """
    for k in range(rows.shape[0]):
        level = level_of(rows[k, 6]) - finest
        cell = CELL * radius * widest[level]
        buckets[k] = bucket_of(
            level,
            int(math.floor(rows[k, 0] / cell)),
            int(math.floor(rows[k, 1] / cell)),
            int(math.floor(rows[k, 2] / cell)),
            starts.size - 1,
        )
        starts[buckets[k]] += 1
    total = 0
    for bucket in range(starts.size):
        total += starts[bucket]
        starts[bucket] = total
    for k in range(rows.shape[0] - 1, -1, -1):
        starts[buckets[k]] -= 1
        at = starts[buckets[k]]
        order[at] = k
        for x in range(7):
            places[at, x] = rows[k, x]
        regular = rows[k, 3] != 0.0 or rows[k, 4] != 0.0 or rows[k, 5] != 0.0
        places[at, 7] = np.inf if regular else -1.0


@jit
def gap_of(i, cell, x):
    """Return how far x is from the cells with number i along its axis."""
    return max(i * cell - x, x - (i + 1) * cell, 0.0)


@jit
def tell_of_sample(
    places, nearest, starts, widest, cell_radius, radius, number, x, y, z, n_x, n_y, n_z
):
    """Tell all places within radius / sqrt(weight), on the same side of the surface, of a sample.

    On the same side are places whose normal makes an angle of at most 90 degrees with its own.
    `nearest` has the number of the sample that is nearest to each place.
    """
    for level in range(widest.size):
        reach = radius * widest[level]
        cell = CELL * cell_radius * widest[level]
        if cell == 0.0:
            continue
        i_last = int(math.floor((x + reach) / cell))
        j_first = int(math.floor((y - reach) / cell))
        j_last = int(math.floor((y + reach) / cell))
        k_first = int(math.floor((z - reach) / cell))
        k_last = int(math.floor((z + reach) / cell))
        for i in range(int(math.floor((x - reach) / cell)), i_last + 1):
            x_gap = gap_of(i, cell, x)
            for j in range(j_first, j_last + 1):
                y_gap = gap_of(j, cell, y)
                for k in range(k_first, k_last + 1):
                    z_gap = gap_of(k, cell, z)
                    if x_gap * x_gap + y_gap * y_gap + z_gap * z_gap > reach * reach:
                        continue
                    bucket = bucket_of(level, i, j, k, starts.size - 1)
                    for at in range(starts[bucket], starts[bucket + 1]):
                        dx = places[at, 0] - x
                        dy = places[at, 1] - y
                        dz = places[at, 2] - z
                        square = (dx * dx + dy * dy + dz * dz) * places[at, 6]
                        if square < places[at, 7] and (
                            places[at, 3] * n_x + places[at, 4] * n_y + places[at, 5] * n_z >= 0.0
                        ):
                            places[at, 7] = square
                            nearest[at] = number


@jit
def tell_of_samples(places, nearest, starts, widest, cell_radius, box, radius, samples):
    """Tell places of samples (…, 6), by their rows.

    All places lie in the box (2, 3); samples that are far from it are left out.
    """
    reach = 0.0
    for level in range(widest.size):
        reach = max(reach, radius * widest[level])
    for k in range(samples.shape[0]):
        outside = False
        for x in range(3):
            outside |= samples[k, x] < box[0, x] - reach or samples[k, x] > box[1, x] + reach
        if outside:
            continue
        tell_of_sample(
            places, nearest, starts, widest, cell_radius, radius, k, samples[k, 0],
            samples[k, 1], samples[k, 2], samples[k, 3], samples[k, 4], samples[k, 5],
        )  # fmt: skip


@jit
def choose_far(places, nearest, starts, widest, cell_radius, radius, least, asked, chosen):
    """Choose those of the asked places that are farther from all samples than radius / sqrt(weight).

    They become samples, without a number. Places that are farther than least / sqrt(weight) are kept
    in the beginning of `asked`. Returns how many are kept, and how many chosen.
    """
    kept = 0
    count = 0
    for k in range(asked.size):
        at = asked[k]
        known = places[at, 7]
        if known > radius * radius:
            tell_of_sample(
                places, nearest, starts, widest, cell_radius, radius, -1, places[at, 0],
                places[at, 1], places[at, 2], places[at, 3], places[at, 4], places[at, 5],
            )  # fmt: skip
            chosen[count] = at
            count += 1
        elif known > least * least:
            asked[kept] = at
            kept += 1
    return kept, count


@jit
def list_places(nearest, heads, links):
    """List the places of each sample: heads[number] is the first, links[·] the next, -1 the end."""
    for at in range(nearest.size):
        if nearest[at] >= 0:
            links[at] = heads[nearest[at]]
            heads[nearest[at]] = at


@jit
def centres(places, heads, links, first, last, found):
    """Write which place is nearest to the centre of all places of a sample, for first, …, last − 1.

    The centre is that of the smallest ball, distances times sqrt(weight): time and again, it takes a
    step towards the farthest place, of 1/2, 1/3, … of the way. -1 for samples without a place.
    """
    for number in range(first, last):
        at = heads[number]
        found[number] = at
        if at < 0:
            continue
        x = places[at, 0]
        y = places[at, 1]
        z = places[at, 2]
        for step in range(STEPS):
            farthest = extreme_place(places, links, heads[number], x, y, z, 1.0)
            x += (places[farthest, 0] - x) / (step + 2.0)
            y += (places[farthest, 1] - y) / (step + 2.0)
            z += (places[farthest, 2] - z) / (step + 2.0)
        found[number] = extreme_place(places, links, heads[number], x, y, z, -1.0)


@jit
def extreme_place(places, links, at, x, y, z, sign):
    """Return which place of a list is farthest from a point, distances times sqrt(weight).

    With sign = -1, which is the nearest one.
    """
    best = -np.inf
    found = at
    while at >= 0:
        dx = places[at, 0] - x
        dy = places[at, 1] - y
        dz = places[at, 2] - z
        square = sign * (dx * dx + dy * dy + dz * dz) * places[at, 6]
        if square > best:
            best = square
            found = at
        at = links[at]
    return found
