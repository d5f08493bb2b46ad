"""The C1 quadratic spline: fitting, control nets, evaluation, measure.

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


# The nine coefficients round a cell, in reading order from the south-west, after 0 to 3 quarter
# turns; and the corners u = 1, v = 1 of the triangle (w = 1 is the centre of the cell).
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


# --- formulas -------------------------------------------------------------------------------------


@jit
def extrapolation(f1, f2, f3):
    """A value one step outside the domain from the three next inside: exact on all quadratics.

        f0 = 3*f1 - 3*f2 + f3

    Source: beyond the paper; 4 operations as written, 4 here.
    """
    f0 = 3 * f1 - 3 * f2 + f3
    return f0


@jit
def edge_point(f, g0, g1):
    """The middle Bézier point of an edge on the border from the values at its middle (f) and
    its ends (g): exact on all quadratics.

        mu = 2*f - g0/2 - g1/2

    Source: Sect. 3.1; 5 operations as written, 5 here.
    """
    mu = 2 * f - 0.5 * g0 - 0.5 * g1
    return mu


@jit
def edge_point_from_vertices(f0, f1, g0, g1):
    """The middle Bézier point of an edge on the border from the values at its ends (f) and at
    the next vertices along the border (g): exact on all quadratics.

        mu = 5*f0/8 + 5*f1/8 - g0/8 - g1/8

    Source: Sect. 3.1; 7 operations as written, 7 here.
    """
    mu = 0.625 * f0 + 0.625 * f1 - 0.125 * g0 - 0.125 * g1
    return mu


@jit
def beyond_edge(f, mu_c):
    """The coefficient beyond an edge of the border from that of its cell and the middle Bézier
    point f of the edge.

        mu_s = 2*f - mu_c

    Source: Sect. 3.1; 2 operations as written, 2 here.
    """
    mu_s = 2 * f - mu_c
    return mu_s


@jit
def beyond_corner(f, mu_s, mu_w, mu_c):
    """The coefficient beyond a corner of the domain from the three others round it and the
    value f there, which the spline interpolates.

        mu_sw = 4*f - mu_c - mu_s - mu_w

    Source: Sect. 3.1; 4 operations as written, 4 here.
    """
    mu_sw = 4 * f - mu_c - mu_s - mu_w
    return mu_sw


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
def measure(a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, u, v):
    """Area of the patch and of its Gaussian image (signed: negative where the patch is
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


# --- fitting --------------------------------------------------------------------------------------


@jit
def fit_centres_and_vertices(centres, vertices, coefficients):
    """Write coefficients (m, n, 3) from values at centres (m, n, 3) and vertices (m+1, n+1, 3)."""
    for i in range(coefficients.shape[0]):
        for j in range(coefficients.shape[1]):
            for x in range(3):
                f = centres[i, j, x]
                g0 = vertices[i, j, x]
                g1 = vertices[i, j + 1, x]
                g2 = vertices[i + 1, j, x]
                g3 = vertices[i + 1, j + 1, x]
                # coefficient (Sect. 3.1): 9 operations as written, 9 here
                mu = 2 * f - 0.25 * g0 - 0.25 * g1 - 0.25 * g2 - 0.25 * g3
                coefficients[i, j, x] = mu


@jit
def fit_vertices(values, coefficients):
    """Write coefficients (m, n, 3) from values (m+3, n+3, 3) at the vertices and one ring more."""
    for i in range(coefficients.shape[0]):
        for j in range(coefficients.shape[1]):
            for x in range(3):
                f0 = values[i + 1, j + 1, x]
                f1 = values[i + 1, j + 2, x]
                f2 = values[i + 2, j + 1, x]
                f3 = values[i + 2, j + 2, x]
                g0 = values[i + 0, j + 1, x]
                g1 = values[i + 0, j + 2, x]
                g2 = values[i + 1, j + 0, x]
                g3 = values[i + 1, j + 3, x]
                g4 = values[i + 2, j + 0, x]
                g5 = values[i + 2, j + 3, x]
                g6 = values[i + 3, j + 1, x]
                g7 = values[i + 3, j + 2, x]
                # coefficient_from_vertices (Sect. 3.1): 23 operations as written, 23 here
                mu = (
                    0.375 * f0
                    + 0.375 * f1
                    + 0.375 * f2
                    + 0.375 * f3
                    - 0.0625 * g0
                    - 0.0625 * g1
                    - 0.0625 * g2
                    - 0.0625 * g3
                    - 0.0625 * g4
                    - 0.0625 * g5
                    - 0.0625 * g6
                    - 0.0625 * g7
                )
                coefficients[i, j, x] = mu


# --- reading the spline ---------------------------------------------------------------------------


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
def control_nets(mu, nets):
    """Write the Bezier nets (4 m n, 6, 3) of all patches: cell by cell, south, east, north, west."""
    for i in range(1, mu.shape[0] - 1):
        for j in range(1, mu.shape[1] - 1):
            for turn in range(4):
                patch = 4 * ((i - 1) * (mu.shape[1] - 2) + j - 1) + turn
                mu_sw_x = mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 0]
                mu_sw_y = mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 1]
                mu_sw_z = mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 2]
                mu_s_x = mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 0]
                mu_s_y = mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 1]
                mu_s_z = mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 2]
                mu_se_x = mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 0]
                mu_se_y = mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 1]
                mu_se_z = mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 2]
                mu_w_x = mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 0]
                mu_w_y = mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 1]
                mu_w_z = mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 2]
                mu_c_x = mu[i + NEIGHBOURS[turn, 4, 0], j + NEIGHBOURS[turn, 4, 1], 0]
                mu_c_y = mu[i + NEIGHBOURS[turn, 4, 0], j + NEIGHBOURS[turn, 4, 1], 1]
                mu_c_z = mu[i + NEIGHBOURS[turn, 4, 0], j + NEIGHBOURS[turn, 4, 1], 2]
                mu_e_x = mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 0]
                mu_e_y = mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 1]
                mu_e_z = mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 2]
                mu_n_x = mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 0]
                mu_n_y = mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 1]
                mu_n_z = mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 2]
                # control_net (Sect. 3.1): 108 operations as written, 75 here
                t0 = 0.25 * mu_w_x
                t1 = 0.25 * mu_s_x
                t2 = 0.25 * mu_c_x + t1
                b200_x = 0.25 * mu_sw_x + t0 + t2
                t3 = 0.25 * mu_w_y
                t4 = 0.25 * mu_s_y
                t5 = 0.25 * mu_c_y + t4
                b200_y = 0.25 * mu_sw_y + t3 + t5
                t6 = 0.25 * mu_w_z
                t7 = 0.25 * mu_s_z
                t8 = 0.25 * mu_c_z + t7
                b200_z = 0.25 * mu_sw_z + t6 + t8
                t9 = 0.25 * mu_e_x
                b020_x = 0.25 * mu_se_x + t2 + t9
                t10 = 0.25 * mu_e_y
                b020_y = 0.25 * mu_se_y + t10 + t5
                t11 = 0.25 * mu_e_z
                b020_z = 0.25 * mu_se_z + t11 + t8
                t12 = 0.5 * mu_c_x
                b002_x = 0.125 * mu_e_x + 0.125 * mu_n_x + 0.125 * mu_s_x + 0.125 * mu_w_x + t12
                t13 = 0.5 * mu_c_y
                b002_y = 0.125 * mu_e_y + 0.125 * mu_n_y + 0.125 * mu_s_y + 0.125 * mu_w_y + t13
                t14 = 0.5 * mu_c_z
                b002_z = 0.125 * mu_e_z + 0.125 * mu_n_z + 0.125 * mu_s_z + 0.125 * mu_w_z + t14
                b110_x = 0.5 * mu_s_x + t12
                b110_y = 0.5 * mu_s_y + t13
                b110_z = 0.5 * mu_s_z + t14
                t15 = t1 + t12
                b101_x = t0 + t15
                t16 = t13 + t4
                b101_y = t16 + t3
                t17 = t14 + t7
                b101_z = t17 + t6
                b011_x = t15 + t9
                b011_y = t10 + t16
                b011_z = t11 + t17
                nets[patch, 0, 0] = b200_x
                nets[patch, 0, 1] = b200_y
                nets[patch, 0, 2] = b200_z
                nets[patch, 1, 0] = b020_x
                nets[patch, 1, 1] = b020_y
                nets[patch, 1, 2] = b020_z
                nets[patch, 2, 0] = b002_x
                nets[patch, 2, 1] = b002_y
                nets[patch, 2, 2] = b002_z
                nets[patch, 3, 0] = b110_x
                nets[patch, 3, 1] = b110_y
                nets[patch, 3, 2] = b110_z
                nets[patch, 4, 0] = b101_x
                nets[patch, 4, 1] = b101_y
                nets[patch, 4, 2] = b101_z
                nets[patch, 5, 0] = b011_x
                nets[patch, 5, 1] = b011_y
                nets[patch, 5, 2] = b011_z


@jit
def locate(s, t):
    """Return the triangle of a cell and the parameters u, v in it; s, t in cells from the centre."""
    turn = 0
    if abs(s) > abs(t):
        turn = 1 if s > 0.0 else 3
    elif t > 0.0:
        turn = 2
    for _ in range(turn):
        s, t = t, -s
    return turn, -t - s, -t + s


@jit
def evaluate(mu, scale, cells, points, normals):
    """Write points (k, 3) and unnormalized normals (k, 3) at cells (k, 2), in cells from the corner."""
    for k in range(cells.shape[0]):
        i = min(max(int(math.floor(cells[k, 0])), 0), mu.shape[0] - 3)
        j = min(max(int(math.floor(cells[k, 1])), 0), mu.shape[1] - 3)
        turn, u, v = locate(cells[k, 0] - i - 0.5, cells[k, 1] - j - 0.5)
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(mu, i + 1, j + 1, turn, scale)  # fmt: skip
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
        points[k, 0] = mu[i + 1, j + 1, 0] + x_x / (SCALE * scale)
        points[k, 1] = mu[i + 1, j + 1, 1] + x_y / (SCALE * scale)
        points[k, 2] = mu[i + 1, j + 1, 2] + x_z / (SCALE * scale)
        normals[k, 0] = N_x
        normals[k, 1] = N_y
        normals[k, 2] = N_z


@jit
def measure_patches(mu, scale, first, last, areas, solid_angles):
    """Write area (scaled) and signed solid angle of the patches first, …, last − 1."""
    columns = mu.shape[1] - 2
    for patch in range(first, last):
        cell = patch // 4
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(
            mu, cell // columns + 1, cell % columns + 1, patch % 4, scale
        )  # fmt: skip
        area = 0.0
        solid_angle = 0.0
        for node in range(3):
            u = 1.0 - 2.0 * NODE if node == 0 else NODE
            v = 1.0 - 2.0 * NODE if node == 1 else NODE
            dA, dS = measure(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, u, v
            )
            if dA > 0.0:
                area += dA / 6.0
                solid_angle += dS / 6.0
        areas[patch - first] = area / (SCALE * SCALE)
        solid_angles[patch - first] = solid_angle
