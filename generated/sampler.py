"""Sampling by normals: which patch has which normal, and where.

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


# fill_samples loads a patch with its first sample, which a type checker cannot see.
# pyright: reportPossiblyUnboundVariable=false

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
TRIANGLE_NEIGHBOURS = np.array([0, 1, 2, 3, 5, 7])

# Rounding, in units of the largest coefficient difference of a patch. The integer weights of a vector
# sum to at most 12 in modulus, and a scalar product with a unit normal adds three roundings, so that
# 2⁻⁴³ bounds the error of A, B, C, P, Q with a factor of 6 to spare.
FORM_ERROR = math.ldexp(1.0, -43)
# U, V, W are compared with the bound of their error; D has to exceed it by this factor for u = U/D.
ACCURATE = 65536.0
# The coordinates themselves carry a few roundings of the largest coordinate.
DATA_ERROR = math.ldexp(64.0, -52)
# Control normals shorter than this (relative to the square of the tangents) are a singular point.
SINGULAR = math.ldexp(1.0, -30)
# The error of a control normal, as an angle, is at most this times one plus the square of the tangents,
# relative to its length.
ANGLE_ERROR = math.ldexp(1.0, -40)

# Samples are computed so many at a time, then stored. The rows of a tile have room for some more.
TILE = 64
TILE_STEP = 80
# The normals of so many samples are asked for before they are needed.
AHEAD = 512
TILE_ROWS = 38


def inner(function):
    """Compile a function for kernels that makes no arrays, without counting references to those it gets."""
    return numba.njit(_nrt=False, **OPTIONS)(function)  # pyright: ignore[reportCallIssue]


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
def forms(a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z):
    """Eliminating u, v from eq. (9) leaves three quadratic forms in n, with u = U/D, v = V/D
    and w = W/D. The patch has the normal n where U, V, W have one sign, which is then that of D
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


@jit
def orientation(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
):  # fmt: skip
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


@jit
def control_normals(a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z):
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
def parabolic_cubic(a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z):
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


# --- bins of normals: the six faces of a cube, each cut into grid x grid squares ---------------------


@inner
def cube_face(x, y, z):
    """Return the face of the cube that the vector meets, and its coordinates there (in -1 … 1)."""
    if abs(x) >= abs(y) and abs(x) >= abs(z):
        return (0, y / x, z / x) if x > 0.0 else (1, y / -x, z / -x)
    if abs(y) >= abs(z):
        return (2, z / y, x / y) if y > 0.0 else (3, z / -y, x / -y)
    return (4, x / z, y / z) if z > 0.0 else (5, x / -z, y / -z)


@inner
def on_face(face, x, y, z):
    """Return the vector in the axes of a face: two coordinates along it, the third towards it."""
    if face == 0:
        return y, z, x
    if face == 1:
        return y, z, -x
    if face == 2:
        return z, x, y
    if face == 3:
        return z, x, -y
    if face == 4:
        return x, y, z
    return x, y, -z


@inner
def within(place, grid):
    """Return the bin of a place along an edge of the grid, the first or last if it is outside."""
    return min(max(int(place), 0), grid - 1)


@inner
def bin_index(s, grid):
    """Return the row or column of a face coordinate; monotone, also in rounding."""
    return within((s + 1.0) * (0.5 * grid), grid)


@inner
def mapped(frame, x, y, z):
    """Return a vector as a linear map (3, 3) maps it."""
    return (
        frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z,
        frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z,
        frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z,
    )


@jit
def count_bins(normals, frame, grid, first, last, bins, counts):
    """Write the bins of the normals first, …, last − 1, and how many of them each bin has.

    The bins are on a cube round the normals (k, 3) as `frame`, a linear map, maps them.
    """
    counts[:] = 0
    for k in range(first, last):
        x, y, z = mapped(frame, normals[k, 0], normals[k, 1], normals[k, 2])
        face, s, t = cube_face(x, y, z)
        bins[k] = (face * grid + bin_index(t, grid)) * grid + bin_index(s, grid)
        counts[bins[k]] += 1


@jit
def start_bins(counts, starts):
    """Write where each bin starts; counts (ranges, bins) become the places of the ranges in it."""
    start = 0
    for b in range(counts.shape[1]):
        starts[b] = start
        for part in range(counts.shape[0]):
            count = counts[part, b]
            counts[part, b] = start
            start += count
    starts[counts.shape[1]] = start


@jit
def place_normals(normals, bins, first, last, places, ordered):
    """Sort the normals first, …, last − 1: ordered[starts[b]:starts[b + 1]] are those of bin b, ascending.

    `places` are those of this range in each bin. The rows of ordered (S, 4) are a normal (as it is) and
    its number.
    """
    for k in range(first, last):
        at = places[bins[k]]
        places[bins[k]] += 1
        for axis in range(3):
            ordered[at, axis] = normals[k, axis]
        ordered[at, 3] = k


# --- which normals a patch may have ---------------------------------------------------------------


@inner
def whole_vectors(count):
    """Return the next multiple of 16: loops of so many leave nothing to do one by one."""
    return (count + 15) & -16


@inner
def length_of(x, y, z):
    """Return the length of a vector."""
    return math.sqrt(x * x + y * y + z * z)


@inner
def largest_tangent(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
):  # fmt: skip
    """Return a bound of the components of the tangents of a patch."""
    return max(
        max(abs(a_x), abs(b_x), abs(c_x)) + max(abs(d_x), abs(e_x)),
        max(abs(a_y), abs(b_y), abs(c_y)) + max(abs(d_y), abs(e_y)),
        max(abs(a_z), abs(b_z), abs(c_z)) + max(abs(d_z), abs(e_z)),
    )


@inner
def cone_of_normals(net, tangents, unit, errors, axis):
    """Write the directions of the control normals, their errors as angles, and the axis of a cone.

    Returns the sine of the cone round the axis that holds them; it is infinite if the cone is not
    narrower than 37 degrees, or has a singular point, which has no direction and an infinite error.
    """
    square = tangents * tangents
    worst = 0.0
    axis[:] = 0.0
    for k in range(6):
        length = length_of(net[k, 0], net[k, 1], net[k, 2])
        inverse = 1.0 / length
        regular = length > SINGULAR * square
        errors[k] = ANGLE_ERROR * (1.0 + square * inverse) if regular else math.inf
        worst = max(worst, errors[k])
        for x in range(3):
            unit[k, x] = net[k, x] * inverse if regular else 0.0
            axis[x] += unit[k, x]
    inverse = 1.0 / length_of(axis[0], axis[1], axis[2])
    for x in range(3):
        axis[x] *= inverse
    widest = 0.0
    towards = 1.0
    for k in range(6):
        towards = min(towards, unit[k, 0] * axis[0] + unit[k, 1] * axis[1] + unit[k, 2] * axis[2])
        s = unit[k, 1] * axis[2] - unit[k, 2] * axis[1]
        t = unit[k, 2] * axis[0] - unit[k, 0] * axis[2]
        w = unit[k, 0] * axis[1] - unit[k, 1] * axis[0]
        widest = max(widest, s * s + t * t + w * w)
    if not (worst < math.inf and towards >= 0.8):
        return math.inf
    return math.sqrt(widest) + 2.0 * worst


@inner
def empty(window):
    """Make a window that holds no bin."""
    window[0], window[1], window[2], window[3] = 0, -1, 0, -1


@inner
def map_net(unit, errors, frame, shown, angles, stretch):
    """Write the control normals as the frame maps them, and their errors; the frame has this norm."""
    for k in range(6):
        shown[k, 0], shown[k, 1], shown[k, 2] = mapped(frame, unit[k, 0], unit[k, 1], unit[k, 2])
        angles[k] = errors[k] * stretch


@inner
def face_window(shown, angles, narrow, face, grid, window, hull):
    """Write first and last column, first and last row of the bins of a face that the cone may meet.

    Central projection keeps convex hulls: the hull of the projected control normals bounds the cone.
    It is written too, in bins; its error and the number of its points are returned. Where some control
    normals do not point to the face, the cone is cut off before them, but outside the face; if it is
    not narrow, the window is the whole face and the error infinite. The window is empty if the cone
    lies beyond one of the borders of the face, as it has to be before.
    """
    half = 0.5 * grid
    error = largest = 0.0
    towards = away = 0
    away_s = away_t = 0.0
    beyond_right = beyond_left = beyond_top = beyond_bottom = True
    for k in range(6):
        if angles[k] == math.inf:
            continue
        s, t, height = on_face(face, shown[k, 0], shown[k, 1], shown[k, 2])
        largest = max(largest, angles[k])
        if height <= angles[k]:
            away += 1
            away_s += s
            away_t += t
        else:
            inverse = 1.0 / height
            far = 1.0 + (abs(s) + abs(t)) * inverse
            error = max(error, angles[k] * inverse * far * half)
            hull[towards, 0] = (s * inverse + 1.0) * half
            hull[towards, 1] = (t * inverse + 1.0) * half
            towards += 1
        beyond_right = beyond_right and s - height > 2.0 * angles[k]
        beyond_left = beyond_left and -s - height > 2.0 * angles[k]
        beyond_top = beyond_top and t - height > 2.0 * angles[k]
        beyond_bottom = beyond_bottom and -t - height > 2.0 * angles[k]
    if towards == 0 or beyond_right or beyond_left or beyond_top or beyond_bottom:
        return math.inf, 0
    if away > 0:
        towards = cut_hull(shown, face, grid, away_s, away_t, hull) if narrow else 0
        error = 1024.0 * largest * half
        if towards == 0:
            window[1] = window[3] = grid - 1
            return math.inf, 0
    left, right, below, above = box_of(hull, towards, error)
    if left <= grid and right >= 0.0 and below <= grid and above >= 0.0:
        window[0], window[1] = within(left, grid), within(right, grid)
        window[2], window[3] = within(below, grid), within(above, grid)
    return error, towards


@inner
def box_of(hull, size, error):
    """Return the least and the greatest s, the least and the greatest t of points, with their error."""
    left, right, below, above = hull[0, 0], hull[0, 0], hull[0, 1], hull[0, 1]
    for k in range(1, size):
        left, right = min(left, hull[k, 0]), max(right, hull[k, 0])
        below, above = min(below, hull[k, 1]), max(above, hull[k, 1])
    return left - error, right + error, below - error, above + error


@inner
def cut_hull(shown, face, grid, away_s, away_t, hull):
    """Write the hull of a cone cut by a plane between the face and what points away from it.

    The plane is 3 height = (s, t)·d with d the unit direction of what points away: on the face, where
    |s|, |t| <= height, the left side is larger. Returns the number of points, 12 at most; 0 if the cone
    is so wide that there is no such plane.
    """
    half = 0.5 * grid
    length = max(length_of(away_s, away_t, 0.0), 0.01)
    size = 0
    for k in range(6):
        s, t, height = on_face(face, shown[k, 0], shown[k, 1], shown[k, 2])
        before = 3.0 * height - (s * away_s + t * away_t) / length
        if before >= 0.0:
            if height < 0.01:
                return 0
            hull[size, 0] = (s / height + 1.0) * half
            hull[size, 1] = (t / height + 1.0) * half
            size += 1
            continue
        for i in range(6):
            s_i, t_i, height_i = on_face(face, shown[i, 0], shown[i, 1], shown[i, 2])
            before_i = 3.0 * height_i - (s_i * away_s + t_i * away_t) / length
            if before_i >= 0.0:
                share = before_i / (before_i - before)
                middle = height_i + share * (height - height_i)
                if middle < 0.01:
                    return 0
                hull[size, 0] = ((s_i + share * (s - s_i)) / middle + 1.0) * half
                hull[size, 1] = ((t_i + share * (t - t_i)) / middle + 1.0) * half
                size += 1
    return size


@inner
def spans_of_hull(hull, size, error, height, first, last, low, high):
    """Write where the hull of points is in the rows first, …, last: from low (…) to high (…).

    A row reaches over `height` from its number on. `error` is that of the points; rows that the hull
    does not meet get an empty span. There has to be room for 15 more rows.
    """
    for row in range(last - first + 1):
        low[row] = math.inf
        high[row] = -math.inf
    for i in range(size):
        for j in range(max(i, 1)):
            below, above = (i, j) if hull[i, 1] <= hull[j, 1] else (j, i)
            s, t = hull[below]
            s_end, t_end = hull[above]
            left, right = min(s, s_end), max(s, s_end)
            slope = (s_end - s) / (t_end - t) if t_end > t else 0.0
            start = max(first, math.ceil(t - error) - height)
            count = min(last, math.floor(t_end + error)) - start + 1
            for k in range(whole_vectors(count)):
                at = np.uint64(start - first + k)
                row = float(start + k)
                p = s + (min(max(row - error, t), t_end) - t) * slope
                q = s + (min(max(row + height + error, t), t_end) - t) * slope
                if t_end == t:
                    p, q = left, right
                least = max(left, min(p, q)) if k < count else math.inf
                most = min(right, max(p, q)) if k < count else -math.inf
                low[at] = min(low[at], least)
                high[at] = max(high[at], most)


@inner
def count_window(window, face, grid, starts):
    """Return the number of normals in a window."""
    total = 0
    if window[1] >= window[0]:
        for row in range(window[2], window[3] + 1):
            base = (face * grid + row) * grid
            total += starts[base + window[1] + 1] - starts[base + window[0]]
    return total


# --- which normals a patch has --------------------------------------------------------------------


@jit
def search_patches(
    mu, scale, noise, border, frame, stretch, grid, starts, normals, first, last,
    found, doubtful, bounds, counts,
):  # fmt: skip
    """Find the normals of the patches first, …, last − 1, in ascending order for each patch.

    normals (S, 4) are in the order of the bins, which are those of `frame`, of norm `stretch`.
    found (…, 2) holds the patch and a note, normal << 32 | its place in that order; doubtful (…, 2) those
    that rounding leaves open, to be decided exactly, and bounds (…) the errors of their forms. Adds the
    numbers of both, and that of the developable patches, to counts (3). `noise` is the rounding of the
    scaled coordinates, `border` the open sides of the domain. Returns the patch before which it
    stopped for lack of room, and the room that it needs.
    """
    columns = mu.shape[1] - 2
    net, unit, shown = np.empty((6, 3)), np.empty((6, 3)), np.empty((6, 3))
    errors, angles = np.empty(6), np.empty(6)
    windows, hulls = np.empty((6, 4), np.int64), np.empty((6, 12, 2))
    slacks, sizes, rows = np.empty(6), np.empty(6, np.int64), np.empty((6 * grid, 2), np.int64)
    axis, low, high = np.empty(3), np.empty(grid + 16), np.empty(grid + 16)
    places, numbers, x, y, z, codes, notes, scratch, buckets = buffers(256)
    for patch in range(first, last):
        cell = patch // 4
        turn = patch % 4
        i = cell // columns
        j = cell % columns
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(mu, i + 1, j + 1, turn, scale)  # fmt: skip
        (
            net[0, 0],
            net[0, 1],
            net[0, 2],
            net[1, 0],
            net[1, 1],
            net[1, 2],
            net[2, 0],
            net[2, 1],
            net[2, 2],
            net[3, 0],
            net[3, 1],
            net[3, 2],
            net[4, 0],
            net[4, 1],
            net[4, 2],
            net[5, 0],
            net[5, 1],
            net[5, 2],
        ) = control_normals(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
        )
        counts[2] += is_developable(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, net, noise
        )

        # Which normals may the patch have?
        tangents = largest_tangent(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
        )
        sine = cone_of_normals(net, tangents, unit, errors, axis)
        map_net(unit, errors, frame, shown, angles, stretch)
        total = 0
        for face in range(6):
            empty(windows[face])
            if starts[face * grid * grid] == starts[(face + 1) * grid * grid]:
                continue
            # A unit vector in the cone is this near to the axis, and one on the face is 1/√3 high.
            if stretch == 1.0 and on_face(face, axis[0], axis[1], axis[2])[2] + 1.1 * sine < 0.577:
                continue
            slacks[face], sizes[face] = face_window(
                shown, angles, sine < math.inf, face, grid, windows[face], hulls[face]
            )
            total += count_window(windows[face], face, grid, starts)
        if counts[0] + total > found.shape[0] or counts[1] + total > doubtful.shape[0]:
            return patch, total
        if total == 0:
            continue
        if total + 16 > x.size:
            places, numbers, x, y, z, codes, notes, scratch, buckets = buffers(total + 16)
        size = note_rows(windows, hulls, sizes, slacks, grid, starts, low, high, rows)
        count = gather(rows, size, normals, places, numbers, x, y, z)

        bound = bound_of_forms(
            mu, i, j, turn, scale, noise, border, axis, sine,
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
        )  # fmt: skip
        full = whole_vectors(count)  # a few more
        classify(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
            axis, sine, bound, x[:full], y[:full], z[:full], codes,
        )  # fmt: skip
        if sine == math.inf:
            look_again(
                a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
                x, y, z, codes[:count],
            )  # fmt: skip
        hits = note(codes, 1, numbers, places, notes, count)
        counts[0] = store(notes, hits, scratch, buckets, patch, found, counts[0])
        if count_open(codes, count) > 0:
            doubts = note(codes, 2, numbers, places, notes, count)
            bounds[counts[1] : counts[1] + doubts] = bound
            counts[1] = store(notes, doubts, scratch, buckets, patch, doubtful, counts[1])
    return last, 0


@jit
def all_developable(mu, scale, noise):
    """Say whether no patch is bent in two directions by more than the rounding of its coordinates."""
    columns = mu.shape[1] - 2
    net = np.empty((6, 3))
    for patch in range(4 * (mu.shape[0] - 2) * columns):
        cell = patch // 4
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(
            mu, cell // columns + 1, cell % columns + 1, patch % 4, scale
        )  # fmt: skip
        (
            net[0, 0],
            net[0, 1],
            net[0, 2],
            net[1, 0],
            net[1, 1],
            net[1, 2],
            net[2, 0],
            net[2, 1],
            net[2, 2],
            net[3, 0],
            net[3, 1],
            net[3, 2],
            net[4, 0],
            net[4, 1],
            net[4, 2],
            net[5, 0],
            net[5, 1],
            net[5, 2],
        ) = control_normals(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
        )
        if not is_developable(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, net, noise
        ):
            return False
    return True


@inner
def is_developable(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, net, noise
):  # fmt: skip
    """Say whether the Gaussian curvature of a patch is nothing but rounding of its coordinates."""
    second = max(
        abs(a_x), abs(a_y), abs(a_z), abs(b_x), abs(b_y), abs(b_z), abs(c_x), abs(c_y), abs(c_z)
    )
    tangent = second + max(abs(d_x), abs(d_y), abs(d_z), abs(e_x), abs(e_y), abs(e_z))
    longest = 0.0
    for k in range(6):
        longest = max(longest, length_of(net[k, 0], net[k, 1], net[k, 2]))
    flat = 4.0 * noise * second * longest * (longest + tangent * second)
    u = 1.0 / 3.0
    v = 1.0 / 3.0
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
    n_x = N_x
    n_y = N_y
    n_z = N_z
    D, U, V, W = forms(
        a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
    )
    if abs(D) > flat:  # already at the centre
        return False
    cubic = parabolic_cubic(
        a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
    )
    curvature = 0.0
    for value in cubic:
        curvature = max(curvature, abs(value))
    return curvature <= flat


@inner
def bound_of_forms(
    mu, i, j, turn, scale, noise, border, axis, sine,
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
):  # fmt: skip
    """Return the error of the forms of a patch; the components of its normals bound it too.

    On an open border of the domain it holds the rounding of the coordinates, `noise`.
    """
    x = y = z = 1.0  # a little more does no harm
    if sine < math.inf:
        x, y, z = abs(axis[0]) + sine, abs(axis[1]) + sine, abs(axis[2]) + sine
    form = (
        x * (max(abs(a_x), abs(b_x), abs(c_x)) + max(abs(d_x), abs(e_x)))
        + y * (max(abs(a_y), abs(b_y), abs(c_y)) + max(abs(d_y), abs(e_y)))
        + z * (max(abs(a_z), abs(b_z), abs(c_z)) + max(abs(d_z), abs(e_z)))
    )
    s, t, w = spread_of(mu, i + 1, j + 1, turn)
    error = FORM_ERROR * scale * (x * s + y * t + z * w)
    if (
        (turn == 0 and j == 0 and border[0])
        or (turn == 1 and i == mu.shape[0] - 3 and border[1])
        or (turn == 2 and j == mu.shape[1] - 3 and border[2])
        or (turn == 3 and i == 0 and border[3])
    ):
        error += noise
    return 32.0 * error * (form + error)


@inner
def spread_of(mu, i, j, turn):
    """Return the largest differences, by component, of the coefficients of a cell and around it."""
    s, t, w = 0.0, 0.0, 0.0
    for k in range(9):
        p = i + NEIGHBOURS[turn, k, 0]
        q = j + NEIGHBOURS[turn, k, 1]
        s = max(s, abs(mu[p, q, 0] - mu[i, j, 0]))
        t = max(t, abs(mu[p, q, 1] - mu[i, j, 1]))
        w = max(w, abs(mu[p, q, 2] - mu[i, j, 2]))
    return s, t, w


@jit
def buffers(size):
    """Return arrays for the candidates of a patch: places, numbers, x, y, z, codes, notes, two to sort."""
    x, y, z = np.ones(size), np.ones(size), np.ones(size)
    notes, scratch = np.empty(size, np.int64), np.empty(size, np.int64)
    places, buckets = np.empty(size, np.int64), np.empty(size + 1, np.int64)
    numbers, codes = np.empty(size), np.empty(size, np.int8)
    return places, numbers, x, y, z, codes, notes, scratch, buckets


@inner
def note_rows(windows, hulls, sizes, slacks, grid, starts, low, high, rows):
    """Write where the rows of bins that a patch may have begin and end; return how many there are."""
    count = 0
    for face in range(6):
        window = windows[face]
        cut = window[1] > window[0] + 3 and window[3] > window[2] + 3 and slacks[face] < math.inf
        if cut:
            spans_of_hull(
                hulls[face], sizes[face], slacks[face], 1, window[2], window[3], low, high
            )
        for row in range(window[2], window[3] + 1):
            left, right = window[0], window[1]
            if cut:
                start = max(low[row - window[2]] - slacks[face], window[0])
                end = min(high[row - window[2]] + slacks[face], window[1] + 1.0)
                if start > end:
                    continue
                left, right = int(start), min(int(end), right)
            base = (face * grid + row) * grid
            if left <= right:
                rows[count, 0] = starts[base + left]
                rows[count, 1] = starts[base + right + 1]
                count += 1
    return count


@inner
def gather(rows, size, normals, places, numbers, x, y, z):
    """Copy the normals of rows of bins, their places and numbers; return how many there are."""
    asked = 0.0
    for row in range(size):
        # The memory is asked for all rows at once, so that they are not waited for one by one.
        for k in range(rows[row, 0], rows[row, 1], 2):
            asked += normals[np.uint64(k), 0]
    count = 0
    for row in range(size):
        begin = rows[row, 0]
        for k in range(rows[row, 1] - begin):
            at, place = np.uint64(count + k), np.uint64(begin + k)
            places[at] = begin + k
            x[at] = normals[place, 0]
            y[at] = normals[place, 1]
            z[at] = normals[place, 2]
            numbers[at] = normals[place, 3]
        count += rows[row, 1] - begin
    x[count] = asked  # else the compiler drops it; sums of integers it makes slower
    return count


@inner
def classify(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
    axis, sine, bound, x, y, z, codes,
):  # fmt: skip
    """Write for each normal whether the patch has it: 0 no, 1 yes, 2 if rounding leaves it open.

    The normals of the patch lie in the cone with the sine round the axis, if that is not infinite. The
    loop has no branches, so that it runs on vectors.
    """
    least = ACCURATE * bound
    lowest = 0.0 if sine < math.inf else -math.inf
    widest = sine * sine
    r_x, r_y, r_z = axis
    for k in range(x.size):
        n_x = x[k]
        n_y = y[k]
        n_z = z[k]
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
        low = U if U < V else V
        low = low if low < W else W
        high = U if U > V else V
        high = high if high > W else W
        s = n_y * r_z - n_z * r_y
        t = n_z * r_x - n_x * r_z
        w = n_x * r_y - n_y * r_x
        beside = (s * s + t * t + w * w > widest) | (n_x * r_x + n_y * r_y + n_z * r_z < lowest)
        outside = (low < -bound) & (high > bound)
        sure = ((low > bound) | (high < -bound)) & (abs(D) > least)
        codes[k] = np.int8(0) if outside | beside else np.int8(1) if sure else np.int8(2)


@inner
def look_again(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z,
    x, y, z, codes,
):  # fmt: skip
    """Compare the sure normals of a patch that bends far with the normal at their own parameters."""
    for k in range(codes.size):
        if codes[k] != 1:
            continue
        n_x = x[k]
        n_y = y[k]
        n_z = z[k]
        D, U, V, W = forms(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
        )
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
        length = abs(N_x) + abs(N_y) + abs(N_z)
        if not (abs(towards) > 0.25 * length and length > 0.0):
            codes[k] = 2
        elif towards < 0.0:
            codes[k] = 0


@inner
def count_open(codes, count):
    """Return how many codes are 2."""
    found = 0
    for k in range(count):
        found += codes[k] == 2
    return found


@inner
def note(codes, code, numbers, places, notes, count):
    """Write a note, normal << 32 | place, of each candidate that has the code; return how many have."""
    chosen = 0
    for k in range(count):
        notes[chosen] = int(numbers[k]) << 32 | places[k]
        chosen += codes[k] == code
    return chosen


@jit
def store(notes, count, scratch, starts, patch, pairs, at):
    """Sort notes and write patch and note of each to pairs (…, 2) from `at` on; return the end."""
    if count <= 32:
        insertion_sort(notes, count)
    else:
        notes = radix_sort(notes, count, scratch, starts)
    for k in range(count):
        pairs[at + k, 0] = patch
        pairs[at + k, 1] = notes[k]
    return at + count


@inner
def insertion_sort(notes, count):
    """Sort a few notes."""
    for k in range(1, count):
        note = notes[k]
        at = k
        while at > 0 and notes[at - 1] > note:
            notes[at] = notes[at - 1]
            at -= 1
        notes[at] = note


@jit
def radix_sort(notes, count, scratch, starts):
    """Sort notes by the numbers of the normals, in digits of as many values as there are notes."""
    low = high = notes[0] >> 32
    for k in range(count):
        low = min(low, notes[k] >> 32)
        high = max(high, notes[k] >> 32)
    width = 1
    while 2 << width <= count:
        width += 1
    mask = (1 << width) - 1
    shift = 0
    while (high - low) >> shift > 0:
        starts[: mask + 2] = 0
        for k in range(count):
            starts[((((notes[k] >> 32) - low) >> shift) & mask) + 1] += 1
        for k in range(mask + 1):
            starts[k + 1] += starts[k]
        for k in range(count):
            digit = (((notes[k] >> 32) - low) >> shift) & mask
            scratch[starts[digit]] = notes[k]
            starts[digit] += 1
        notes, scratch = scratch, notes
        shift += width
    return notes


@jit
def merge_pairs(sure, decided, merged, places):
    """Merge pairs (…, 2) of patch and note with decided ones; write where these are to places (…)."""
    at = 0
    end = sure.shape[0]
    count = decided.shape[0]
    for k in range(count + 1):
        while at < end and (
            k == count
            or sure[at, 0] < decided[k, 0]
            or (sure[at, 0] == decided[k, 0] and sure[at, 1] < decided[k, 1])
        ):
            merged[at + k, 0] = sure[at, 0]
            merged[at + k, 1] = sure[at, 1]
            at += 1
        if k < count:
            places[k] = at + k
            merged[at + k, 0] = decided[k, 0]
            merged[at + k, 1] = decided[k, 1]


# --- what a sample holds --------------------------------------------------------------------------


@jit
def fill_samples(
    mu, scale, normals, frame, pairs, start,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Fill the samples from number `start` on from pairs (k, 2) of patch and note.

    frame = (u0, v0, du, dv): the corner of the domain and the size of a cell in the parameters. What
    is not wanted of points (k, 3), directions (k, 3), uv (k, 2), support, gaussian, mean and the
    two indices (k) is None: Numba compiles without it, and the compiler drops what only that needs.
    """
    tile, indices = new_tile(), np.zeros(2 * TILE_STEP, np.int64)
    loaded = -1
    for begin in range(0, pairs.shape[0], TILE):
        count = min(TILE, pairs.shape[0] - begin)
        if pairs[begin, 0] != loaded or pairs[begin + count - 1, 0] != loaded:
            loaded = load_patches(mu, scale, pairs, begin, count, tile)
        if begin % AHEAD == 0:
            tile[TILE_STEP - 1] = ask_for(normals, pairs, begin + AHEAD)
        for k in range(count):
            indices[k] = pairs[begin + k, 1] >> 32
            indices[TILE_STEP + k] = pairs[begin + k, 0]
            at = np.uint64(pairs[begin + k, 1] & 0xFFFFFFFF)
            n_x = normals[at, 0]
            n_y = normals[at, 1]
            n_z = normals[at, 2]
            tile[0 * TILE_STEP + k] = n_x
            tile[1 * TILE_STEP + k] = n_y
            tile[2 * TILE_STEP + k] = n_z
        fill_tile(
            tile, indices, count, start + begin, scale, frame,
            points, directions, uv, support, gaussian, mean, normal_index, patch_index,
        )  # fmt: skip


@inner
def ask_for(normals, pairs, first):
    """Read a number of AHEAD normals, so that they are on their way: they lie far from each other."""
    asked = 0.0
    for k in range(first, min(first + AHEAD, pairs.shape[0])):
        asked += normals[np.uint64(pairs[np.uint64(k), 1] & 0xFFFFFFFF), 0]
    return asked


@jit
def new_tile():
    """Return a tile: a row for each of what a sample needs and has, TILE_STEP numbers long."""
    return np.zeros(TILE_ROWS * TILE_STEP)


@inner
def fill_tile(
    tile, indices, count, start, scale, frame,
    points, directions, uv, support, gaussian, mean, normal_index, patch_index,
):  # fmt: skip
    """Fill `count` samples from number `start` on from a tile, and rows of their indices."""
    # A few more than wanted, so that vectors are full: what they give is not stored.
    full = whole_vectors(count)
    evaluate_tile(tile, full, frame, SCALE * scale, points, uv, support, gaussian, mean)
    for row in range(count):
        k = np.uint64(start + row)  # so that nobody asks whether it is negative
        n_x = tile[0 * TILE_STEP + row]
        n_y = tile[1 * TILE_STEP + row]
        n_z = tile[2 * TILE_STEP + row]
        point_x = tile[30 * TILE_STEP + row]
        point_y = tile[31 * TILE_STEP + row]
        point_z = tile[32 * TILE_STEP + row]
        s = tile[33 * TILE_STEP + row]
        t = tile[34 * TILE_STEP + row]
        h = tile[35 * TILE_STEP + row]
        K = tile[36 * TILE_STEP + row]
        H = tile[37 * TILE_STEP + row]
        if points is not None:
            points[k, 0] = point_x
            points[k, 1] = point_y
            points[k, 2] = point_z
        if directions is not None:
            directions[k, 0] = n_x
            directions[k, 1] = n_y
            directions[k, 2] = n_z
        if uv is not None:
            uv[k, 0] = s
            uv[k, 1] = t
        if support is not None:
            support[k] = h
        if gaussian is not None:
            gaussian[k] = K
        if mean is not None:
            mean[k] = H
        if normal_index is not None:
            normal_index[k] = indices[row]
        if patch_index is not None:
            patch_index[k] = indices[TILE_STEP + row]


@inner
def load_patches(mu, scale, pairs, begin, count, tile):
    """Write what belongs to the patches of the samples of a tile; return the patch if there is one."""
    columns = mu.shape[1] - 2
    patch = pairs[begin, 0]
    if pairs[begin + count - 1, 0] == patch:
        load_patch(mu, patch // 4 // columns, patch // 4 % columns, patch % 4, scale, tile, 0, TILE)
        return patch
    end = 0
    while end < count:
        start = end
        patch = pairs[begin + start, 0]
        while end < count and pairs[begin + end, 0] == patch:
            end += 1
        load_patch(
            mu, patch // 4 // columns, patch // 4 % columns, patch % 4, scale, tile, start, end
        )
    return -1


@inner
def load_patch(mu, i, j, turn, scale, tile, start, end):
    """Write what belongs to a patch for the samples start, …, end − 1 of a tile, and up to 15 more."""
    (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
     d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(mu, i + 1, j + 1, turn, scale)  # fmt: skip
    centre_x = mu[i + 1, j + 1, 0]
    centre_y = mu[i + 1, j + 1, 1]
    centre_z = mu[i + 1, j + 1, 2]
    cell_u = i + 0.5
    cell_v = j + 0.5
    u_s = CORNERS[turn, 0, 0]
    u_t = CORNERS[turn, 0, 1]
    v_s = CORNERS[turn, 1, 0]
    v_t = CORNERS[turn, 1, 1]
    tile = tile[start:]
    for k in range(whole_vectors(end - start)):
        tile[3 * TILE_STEP + k] = a_x
        tile[4 * TILE_STEP + k] = a_y
        tile[5 * TILE_STEP + k] = a_z
        tile[6 * TILE_STEP + k] = b_x
        tile[7 * TILE_STEP + k] = b_y
        tile[8 * TILE_STEP + k] = b_z
        tile[9 * TILE_STEP + k] = c_x
        tile[10 * TILE_STEP + k] = c_y
        tile[11 * TILE_STEP + k] = c_z
        tile[12 * TILE_STEP + k] = d_x
        tile[13 * TILE_STEP + k] = d_y
        tile[14 * TILE_STEP + k] = d_z
        tile[15 * TILE_STEP + k] = e_x
        tile[16 * TILE_STEP + k] = e_y
        tile[17 * TILE_STEP + k] = e_z
        tile[18 * TILE_STEP + k] = p_x
        tile[19 * TILE_STEP + k] = p_y
        tile[20 * TILE_STEP + k] = p_z
        tile[21 * TILE_STEP + k] = centre_x
        tile[22 * TILE_STEP + k] = centre_y
        tile[23 * TILE_STEP + k] = centre_z
        tile[24 * TILE_STEP + k] = cell_u
        tile[25 * TILE_STEP + k] = cell_v
        tile[26 * TILE_STEP + k] = u_s
        tile[27 * TILE_STEP + k] = u_t
        tile[28 * TILE_STEP + k] = v_s
        tile[29 * TILE_STEP + k] = v_t


@inner
def evaluate_tile(tile, count, frame, size, points, uv, support, gaussian, mean):
    """Evaluate `count` samples of a tile; the loop has no branches, so that it runs on vectors.

    Of the last five is asked only whether they are None, and so not wanted: no branch is left of it.
    """
    unit = 1.0 / size
    u_0, v_0, du, dv = frame[0], frame[1], frame[2], frame[3]
    for k in range(count):
        n_x = tile[0 * TILE_STEP + k]
        n_y = tile[1 * TILE_STEP + k]
        n_z = tile[2 * TILE_STEP + k]
        a_x = tile[3 * TILE_STEP + k]
        a_y = tile[4 * TILE_STEP + k]
        a_z = tile[5 * TILE_STEP + k]
        b_x = tile[6 * TILE_STEP + k]
        b_y = tile[7 * TILE_STEP + k]
        b_z = tile[8 * TILE_STEP + k]
        c_x = tile[9 * TILE_STEP + k]
        c_y = tile[10 * TILE_STEP + k]
        c_z = tile[11 * TILE_STEP + k]
        d_x = tile[12 * TILE_STEP + k]
        d_y = tile[13 * TILE_STEP + k]
        d_z = tile[14 * TILE_STEP + k]
        e_x = tile[15 * TILE_STEP + k]
        e_y = tile[16 * TILE_STEP + k]
        e_z = tile[17 * TILE_STEP + k]
        p_x = tile[18 * TILE_STEP + k]
        p_y = tile[19 * TILE_STEP + k]
        p_z = tile[20 * TILE_STEP + k]
        centre_x = tile[21 * TILE_STEP + k]
        centre_y = tile[22 * TILE_STEP + k]
        centre_z = tile[23 * TILE_STEP + k]
        cell_u = tile[24 * TILE_STEP + k]
        cell_v = tile[25 * TILE_STEP + k]
        u_s = tile[26 * TILE_STEP + k]
        u_t = tile[27 * TILE_STEP + k]
        v_s = tile[28 * TILE_STEP + k]
        v_t = tile[29 * TILE_STEP + k]
        # sample (eqs. (1), (5)-(9); curvatures beyond the paper): 145 operations as written, 134 here
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
        point_x = centre_x + x_x * unit
        point_y = centre_y + x_y * unit
        point_z = centre_z + x_z * unit
        s = u_0 + du * (cell_u + u * u_s + v * v_s)
        t = v_0 + dv * (cell_v + u * u_t + v * v_t)
        h = n_x * point_x + n_y * point_y + n_z * point_z
        K = K * size * size
        H = H * size
        if points is not None:
            tile[30 * TILE_STEP + k] = point_x
            tile[31 * TILE_STEP + k] = point_y
            tile[32 * TILE_STEP + k] = point_z
        if uv is not None:
            tile[33 * TILE_STEP + k] = s
            tile[34 * TILE_STEP + k] = t
        if support is not None:
            tile[35 * TILE_STEP + k] = h
        if gaussian is not None:
            tile[36 * TILE_STEP + k] = K
        if mean is not None:
            tile[37 * TILE_STEP + k] = H


@jit
def fill_known(
    mu, scale, normals, frame, which, pairs, local,
    points, directions, uv, support, gaussian, mean,
):  # fmt: skip
    """Fill the samples which[0], which[1], … at known parameters; see `fill_samples`.

    pairs (k, 2) are their patches and the numbers of their normals.

    local (k, 5) holds u, v, the sign of K, and the parameters at which the curvatures are taken: u, v
    themselves but at a singular point.
    """
    columns = mu.shape[1] - 2
    size = SCALE * scale
    unit = 1.0 / size
    u_0, v_0, du, dv = frame[0], frame[1], frame[2], frame[3]
    for row in range(which.size):
        k = which[row]
        cell = pairs[row, 0] // 4
        turn = pairs[row, 0] % 4
        i = cell // columns
        j = cell % columns
        centre_x = mu[i + 1, j + 1, 0]
        centre_y = mu[i + 1, j + 1, 1]
        centre_z = mu[i + 1, j + 1, 2]
        cell_u = i + 0.5
        cell_v = j + 0.5
        u_s = CORNERS[turn, 0, 0]
        u_t = CORNERS[turn, 0, 1]
        v_s = CORNERS[turn, 1, 0]
        v_t = CORNERS[turn, 1, 1]
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(mu, i + 1, j + 1, turn, scale)  # fmt: skip
        u = local[row, 3]
        v = local[row, 4]
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
        length = length_of(N_x, N_y, N_z)
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
        K = math.copysign(K, local[row, 2])
        u = local[row, 0]
        v = local[row, 1]
        # envelope (eqs. (5)-(8)): 45 operations as written, 35 here
        t0 = u * v
        t1 = 0.5 * u * u
        t2 = 0.5 * v * v
        x_x = a_x * t1 + b_x * t0 + c_x * t2 + d_x * u + e_x * v + p_x
        x_y = a_y * t1 + b_y * t0 + c_y * t2 + d_y * u + e_y * v + p_y
        x_z = a_z * t1 + b_z * t0 + c_z * t2 + d_z * u + e_z * v + p_z
        n_x = normals[pairs[row, 1], 0]
        n_y = normals[pairs[row, 1], 1]
        n_z = normals[pairs[row, 1], 2]
        point_x = centre_x + x_x * unit
        point_y = centre_y + x_y * unit
        point_z = centre_z + x_z * unit
        s = u_0 + du * (cell_u + u * u_s + v * v_s)
        t = v_0 + dv * (cell_v + u * u_t + v * v_t)
        h = n_x * point_x + n_y * point_y + n_z * point_z
        K = K * size * size
        H = H * size
        if points is not None:
            points[k, 0] = point_x
            points[k, 1] = point_y
            points[k, 2] = point_z
        if directions is not None:
            directions[k, 0] = n_x
            directions[k, 1] = n_y
            directions[k, 2] = n_z
        if uv is not None:
            uv[k, 0] = s
            uv[k, 1] = t
        if support is not None:
            support[k] = h
        if gaussian is not None:
            gaussian[k] = K
        if mean is not None:
            mean[k] = H


@jit
def normals_at(mu, scale, patches, local, normals):
    """Write the unnormalized oriented normals (k, 3) of patches at their parameters local (k, 2)."""
    columns = mu.shape[1] - 2
    for k in range(patches.size):
        cell = patches[k] // 4
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(
            mu, cell // columns + 1, cell % columns + 1, patches[k] % 4, scale
        )  # fmt: skip
        u = local[k, 0]
        v = local[k, 1]
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
        normals[k, 0] = N_x
        normals[k, 1] = N_y
        normals[k, 2] = N_z


@jit
def least_cosine(mu, scale, axis):
    """Return the least cosine between a unit vector and any oriented normal of the spline.

    If that is negative, it is one that is.
    """
    rows = mu.shape[0] - 2
    columns = mu.shape[1] - 2
    net = np.empty((6, 3))
    least = 1.0
    for patch in range(4 * rows * columns):
        cell = patch // 4
        (a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z,
         d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z) = patch_vectors(
            mu, cell // columns + 1, cell % columns + 1, patch % 4, scale
        )  # fmt: skip
        (
            net[0, 0],
            net[0, 1],
            net[0, 2],
            net[1, 0],
            net[1, 1],
            net[1, 2],
            net[2, 0],
            net[2, 1],
            net[2, 2],
            net[3, 0],
            net[3, 1],
            net[3, 2],
            net[4, 0],
            net[4, 1],
            net[4, 2],
            net[5, 0],
            net[5, 1],
            net[5, 2],
        ) = control_normals(
            a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z
        )
        for k in range(6):
            towards = net[k, 0] * axis[0] + net[k, 1] * axis[1] + net[k, 2] * axis[2]
            length = length_of(net[k, 0], net[k, 1], net[k, 2])
            if length > 0.0:
                least = min(least, towards / length)
        if least < 0.0:
            break
    return least
