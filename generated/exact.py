"""Exact decisions: the signs of the forms of a patch and a normal.

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


# First with 106 bits; where that leaves a sign open, exactly. Coefficients and normals are binary
# fractions, so that the forms are integers, up to a power of two. They are computed modulo several
# primes, which is as exact as integers of any size if the product of the primes is large enough.

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
PRIMES = np.array(
    [
        536870909,
        536870879,
        536870869,
        536870849,
        536870839,
        536870837,
        536870819,
        536870813,
        536870791,
        536870779,
        536870767,
        536870743,
        536870729,
        536870723,
        536870717,
        536870701,
        536870683,
        536870657,
        536870641,
        536870627,
        536870611,
        536870603,
        536870599,
        536870573,
    ]
)

# So much less than the error of the forms as floating-point numbers is that of double-doubles: 2⁻⁵¹,
# with a factor of 64 to spare.
PRECISE = math.ldexp(1.0, -45)
SPLITTER = 134217729.0
MANTISSA = 53
HIGHEST = 1 << 30
# Every prime adds so many bits.
BITS = 28.99
# Bits that the formulas add: those of the weights, of the sums of products, and of a second normal.
WEIGHT_BITS, SUM_BITS, FORM_BITS = 6, 2, 6


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
def linear_forms(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
):  # fmt: skip
    """The linear forms in n of eq. (9), from which u, v are eliminated.

        A = n·a
        B = n·b
        C = n·c
        P = n·d
        Q = n·e

    Source: eq. (9); 25 operations as written, 25 here.
    """
    A = a_x * n_x + a_y * n_y + a_z * n_z
    B = b_x * n_x + b_y * n_y + b_z * n_z
    C = c_x * n_x + c_y * n_y + c_z * n_z
    P = d_x * n_x + d_y * n_y + d_z * n_z
    Q = e_x * n_x + e_y * n_y + e_z * n_z
    return A, B, C, P, Q


@jit
def eliminated_forms(A, B, C, P, Q):
    """The quadratic forms of a patch from the linear ones: what eliminating u, v leaves.

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


# --- double-doubles -------------------------------------------------------------------------------


@jit
def sum_of(x, y):
    """Return the sum of two numbers and its error, exactly."""
    s = x + y
    part = s - x
    return s, (x - (s - part)) + (y - part)


@jit
def plus(x, y):
    """Return x + y."""
    high, low = sum_of(x[0], y[0])
    middle, rest = sum_of(x[1], y[1])
    high, low = sum_of(high, low + middle)
    return sum_of(high, low + rest)


@jit
def negative(x):
    """Return −x."""
    return -x[0], -x[1]


@jit
def minus(x, y):
    """Return x − y."""
    return plus(x, negative(y))


@jit
def halves(x):
    """Return two parts of 26 bits each of a number."""
    c = SPLITTER * x
    high = c - (c - x)
    return high, x - high


@jit
def times(x, y):
    """Return x y."""
    product = x[0] * y[0]
    a, b = halves(x[0])
    c, d = halves(y[0])
    error = ((a * c - product) + a * d + b * c) + b * d
    return sum_of(product, error + (x[0] * y[1] + x[1] * y[0]))


@jit
def multiple(x, factor):
    """Return x times a power of two."""
    return x[0] * factor, x[1] * factor


@jit
def double_double_triangle(
    mu_sw_x, mu_sw_y, mu_sw_z, mu_s_x, mu_s_y, mu_s_z, mu_se_x, mu_se_y, mu_se_z, mu_w_x,
    mu_w_y, mu_w_z, mu_e_x, mu_e_y, mu_e_z, mu_n_x, mu_n_y, mu_n_z
):  # fmt: skip
    """As `triangle`, of double-doubles."""
    t0 = multiple(mu_w_x, 2.0)
    t1 = multiple(mu_n_x, 2.0)
    t2 = multiple(mu_s_x, 2.0)
    t3 = multiple(mu_e_x, 2.0)
    t4 = minus(t3, t2)
    t5 = minus(plus(t1, t4), t0)
    a_x = plus(multiple(mu_sw_x, 4.0), t5)
    t6 = multiple(mu_w_y, 2.0)
    t7 = multiple(mu_n_y, 2.0)
    t8 = multiple(mu_s_y, 2.0)
    t9 = multiple(mu_e_y, 2.0)
    t10 = minus(t9, t8)
    t11 = minus(plus(t10, t7), t6)
    a_y = plus(multiple(mu_sw_y, 4.0), t11)
    t12 = multiple(mu_w_z, 2.0)
    t13 = multiple(mu_n_z, 2.0)
    t14 = multiple(mu_s_z, 2.0)
    t15 = multiple(mu_e_z, 2.0)
    t16 = minus(t15, t14)
    t17 = minus(plus(t13, t16), t12)
    a_z = plus(multiple(mu_sw_z, 4.0), t17)
    b_x = minus(minus(t1, t0), t4)
    b_y = minus(minus(t7, t10), t6)
    b_z = minus(minus(t13, t12), t16)
    c_x = minus(minus(plus(plus(multiple(mu_se_x, 4.0), t0), t1), t2), t3)
    c_y = minus(minus(plus(plus(multiple(mu_se_y, 4.0), t6), t7), t8), t9)
    c_z = minus(minus(plus(plus(multiple(mu_se_z, 4.0), t12), t13), t14), t15)
    d_x = negative(t5)
    d_y = negative(t11)
    d_z = negative(t17)
    e_x = minus(minus(plus(t2, t3), t0), t1)
    e_y = minus(minus(plus(t8, t9), t6), t7)
    e_z = minus(minus(plus(t14, t15), t12), t13)
    p_x = plus(plus(plus(mu_e_x, mu_n_x), mu_s_x), mu_w_x)
    p_y = plus(plus(plus(mu_e_y, mu_n_y), mu_s_y), mu_w_y)
    p_z = plus(plus(plus(mu_e_z, mu_n_z), mu_s_z), mu_w_z)
    return a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z


@jit
def double_double_forms(
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
):  # fmt: skip
    """As `forms`, of double-doubles."""
    A = plus(plus(times(a_x, n_x), times(a_y, n_y)), times(a_z, n_z))
    B = plus(plus(times(b_x, n_x), times(b_y, n_y)), times(b_z, n_z))
    C = plus(plus(times(c_x, n_x), times(c_y, n_y)), times(c_z, n_z))
    P = plus(plus(times(d_x, n_x), times(d_y, n_y)), times(d_z, n_z))
    Q = plus(plus(times(e_x, n_x), times(e_y, n_y)), times(e_z, n_z))
    D = minus(times(A, C), times(B, B))
    U = minus(times(B, Q), times(C, P))
    V = minus(times(B, P), times(A, Q))
    W = minus(minus(D, U), V)
    return D, U, V, W


@jit
def precise_forms(mu, i, j, turn, scale, n_x, n_y, n_z):
    """Return D, U, V, W of a patch and a normal as double-doubles, for the scaled spline."""
    mu_sw_x = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 0], 0.0),
            (-mu[i, j, 0], 0.0),
        ),
        scale,
    )
    mu_sw_y = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 1], 0.0),
            (-mu[i, j, 1], 0.0),
        ),
        scale,
    )
    mu_sw_z = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 0, 0], j + NEIGHBOURS[turn, 0, 1], 2], 0.0),
            (-mu[i, j, 2], 0.0),
        ),
        scale,
    )
    mu_s_x = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 0], 0.0),
            (-mu[i, j, 0], 0.0),
        ),
        scale,
    )
    mu_s_y = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 1], 0.0),
            (-mu[i, j, 1], 0.0),
        ),
        scale,
    )
    mu_s_z = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 1, 0], j + NEIGHBOURS[turn, 1, 1], 2], 0.0),
            (-mu[i, j, 2], 0.0),
        ),
        scale,
    )
    mu_se_x = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 0], 0.0),
            (-mu[i, j, 0], 0.0),
        ),
        scale,
    )
    mu_se_y = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 1], 0.0),
            (-mu[i, j, 1], 0.0),
        ),
        scale,
    )
    mu_se_z = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 2, 0], j + NEIGHBOURS[turn, 2, 1], 2], 0.0),
            (-mu[i, j, 2], 0.0),
        ),
        scale,
    )
    mu_w_x = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 0], 0.0),
            (-mu[i, j, 0], 0.0),
        ),
        scale,
    )
    mu_w_y = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 1], 0.0),
            (-mu[i, j, 1], 0.0),
        ),
        scale,
    )
    mu_w_z = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 3, 0], j + NEIGHBOURS[turn, 3, 1], 2], 0.0),
            (-mu[i, j, 2], 0.0),
        ),
        scale,
    )
    mu_e_x = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 0], 0.0),
            (-mu[i, j, 0], 0.0),
        ),
        scale,
    )
    mu_e_y = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 1], 0.0),
            (-mu[i, j, 1], 0.0),
        ),
        scale,
    )
    mu_e_z = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 5, 0], j + NEIGHBOURS[turn, 5, 1], 2], 0.0),
            (-mu[i, j, 2], 0.0),
        ),
        scale,
    )
    mu_n_x = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 0], 0.0),
            (-mu[i, j, 0], 0.0),
        ),
        scale,
    )
    mu_n_y = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 1], 0.0),
            (-mu[i, j, 1], 0.0),
        ),
        scale,
    )
    mu_n_z = multiple(
        plus(
            (mu[i + NEIGHBOURS[turn, 7, 0], j + NEIGHBOURS[turn, 7, 1], 2], 0.0),
            (-mu[i, j, 2], 0.0),
        ),
        scale,
    )
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z = double_double_triangle(
        mu_sw_x, mu_sw_y, mu_sw_z, mu_s_x, mu_s_y, mu_s_z, mu_se_x, mu_se_y, mu_se_z, mu_w_x,
        mu_w_y, mu_w_z, mu_e_x, mu_e_y, mu_e_z, mu_n_x, mu_n_y, mu_n_z
    )  # fmt: skip
    n_x, n_y, n_z = (n_x, 0.0), (n_y, 0.0), (n_z, 0.0)
    return double_double_forms(
        a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
    )


# --- integers modulo primes -----------------------------------------------------------------------


@jit
def exponents_of(values):
    """Return the lowest and the highest exponent of the numbers that are not zero."""
    lowest, highest = HIGHEST, -HIGHEST
    for value in values:
        if value != 0.0:
            exponent = math.frexp(value)[1]
            lowest, highest = min(lowest, exponent), max(highest, exponent)
    return lowest, highest


@jit
def residue(value, lowest, prime, powers):
    """Return value / 2^(lowest − MANTISSA), an integer, modulo a prime."""
    mantissa, exponent = math.frexp(value)
    if mantissa == 0.0:
        return 0
    return int(math.ldexp(mantissa, MANTISSA)) % prime * powers[exponent - lowest] % prime


@jit
def residues_of_vectors(around, lowest, prime, powers):
    """Return a, b, c, d, e (15) of a patch modulo a prime, from the coefficients around (9, 3)."""
    centre_0 = residue(around[4, 0], lowest, prime, powers)
    centre_1 = residue(around[4, 1], lowest, prime, powers)
    centre_2 = residue(around[4, 2], lowest, prime, powers)
    mu_sw_x = residue(around[0, 0], lowest, prime, powers) - centre_0
    mu_sw_y = residue(around[0, 1], lowest, prime, powers) - centre_1
    mu_sw_z = residue(around[0, 2], lowest, prime, powers) - centre_2
    mu_s_x = residue(around[1, 0], lowest, prime, powers) - centre_0
    mu_s_y = residue(around[1, 1], lowest, prime, powers) - centre_1
    mu_s_z = residue(around[1, 2], lowest, prime, powers) - centre_2
    mu_se_x = residue(around[2, 0], lowest, prime, powers) - centre_0
    mu_se_y = residue(around[2, 1], lowest, prime, powers) - centre_1
    mu_se_z = residue(around[2, 2], lowest, prime, powers) - centre_2
    mu_w_x = residue(around[3, 0], lowest, prime, powers) - centre_0
    mu_w_y = residue(around[3, 1], lowest, prime, powers) - centre_1
    mu_w_z = residue(around[3, 2], lowest, prime, powers) - centre_2
    mu_e_x = residue(around[5, 0], lowest, prime, powers) - centre_0
    mu_e_y = residue(around[5, 1], lowest, prime, powers) - centre_1
    mu_e_z = residue(around[5, 2], lowest, prime, powers) - centre_2
    mu_n_x = residue(around[7, 0], lowest, prime, powers) - centre_0
    mu_n_y = residue(around[7, 1], lowest, prime, powers) - centre_1
    mu_n_z = residue(around[7, 2], lowest, prime, powers) - centre_2
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, p_x, p_y, p_z = triangle(
        mu_sw_x, mu_sw_y, mu_sw_z, mu_s_x, mu_s_y, mu_s_z, mu_se_x, mu_se_y, mu_se_z, mu_w_x,
        mu_w_y, mu_w_z, mu_e_x, mu_e_y, mu_e_z, mu_n_x, mu_n_y, mu_n_z
    )  # fmt: skip
    return (
        a_x % prime,
        a_y % prime,
        a_z % prime,
        b_x % prime,
        b_y % prime,
        b_z % prime,
        c_x % prime,
        c_y % prime,
        c_z % prime,
        d_x % prime,
        d_y % prime,
        d_z % prime,
        e_x % prime,
        e_y % prime,
        e_z % prime,
    )


@jit
def residues_of_forms(vectors, n_x, n_y, n_z, prime):
    """Return D, U, V, W modulo a prime, from vectors (15) and a normal modulo it."""
    a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z = vectors
    A, B, C, P, Q = linear_forms(
        a_x, a_y, a_z, b_x, b_y, b_z, c_x, c_y, c_z, d_x, d_y, d_z, e_x, e_y, e_z, n_x, n_y, n_z
    )  # fmt: skip
    A, B, C, P, Q = A % prime, B % prime, C % prime, P % prime, Q % prime
    D, U, V, W = eliminated_forms(A, B, C, P, Q)
    return D % prime, U % prime, V % prime, W % prime


@jit
def residues_of_monomial(vectors, normal, s, t, primes, residues):
    """Write the residues (4, k) of the coefficients of a monomial in D, U, V, W.

    Each form is a sum of the ten monomials of n, ε₁, ε₂, ε₃ (0, 1, 2, 3); this one is that of s and t.
    """
    for k in range(residues.shape[1]):
        prime = primes[k]
        parts = ((1, 1), (1, 0), (0, 1)) if s != t else ((1, 0), (0, 0), (0, 0))
        for which, (with_s, with_t) in enumerate(parts):
            if with_s + with_t == 0:
                continue
            x, y, z = 0, 0, 0
            for axis, taken in ((s, with_s), (t, with_t)):
                if taken:
                    x += normal[k, 0] if axis == 0 else int(axis == 1)
                    y += normal[k, 1] if axis == 0 else int(axis == 2)
                    z += normal[k, 2] if axis == 0 else int(axis == 3)
            values = residues_of_forms(vectors[k], x % prime, y % prime, z % prime, prime)
            for form in range(4):
                value = values[form] if which == 0 else prime - values[form]
                residues[form, k] = (value + (residues[form, k] if which else 0)) % prime


@jit
def value_of(residues, primes, inverses, digits):
    """Return the number (sign included) that has these residues modulo the first of the primes.

    It has to be smaller than the product of all of them but the last. The digits are those in mixed
    radix of the number, or of its opposite: the last is zero for the one that is positive.
    """
    count = residues.size
    negative = False
    for _ in range(2):
        for k in range(count):
            prime = primes[k]
            digit = (prime - residues[k]) % prime if negative else residues[k]
            for i in range(k):
                digit = (digit - digits[i]) % prime * inverses[i, k] % prime
            digits[k] = digit
        if digits[count - 1] == 0:
            break
        negative = True
    value = 0.0
    for k in range(count - 1, -1, -1):
        value = value * primes[k] + digits[k]
    return -value if negative else value


@jit
def exact_forms(around, normal, primes, powers, inverses, forms, signs):
    """Write D, U, V, W to forms (4), in a unit of their own, and the signs of U, V, W to signs (3).

    Returns the exponent of the unit, or HIGHEST if the numbers are too long for the primes.

    Where one of U, V, W is zero and the others leave open whether the patch has the normal, this is
    moved to n + (ε₁, ε₂, ε₃), with n ≫ ε₁ ≫ ε₂ ≫ ε₃ ≫ ε₁². A form is then a sum of ten monomials in
    n, ε₁, ε₂, ε₃, each infinitesimal beside the one before; its coefficients follow from
    F(x + y) − F(x) − F(y). The first that is not zero gives the sign. Quotients by D need the monomial
    that leads in D alone: that one is written. The forms are even in n, but a normal and its opposite
    must be moved to opposite normals: where a surface is joined to its own mirror image, one patch
    has the one and its neighbour the other. So n is taken with its first component positive.
    """
    lowest, highest = exponents_of(around.ravel())
    lowest_n, highest_n = exponents_of(normal)
    bits = highest - lowest + highest_n - lowest_n + 2 * MANTISSA
    count = int((2 * (bits + WEIGHT_BITS + SUM_BITS) + FORM_BITS) / BITS) + 2
    if count > primes.size or max(highest - lowest, highest_n - lowest_n) >= powers.shape[1]:
        return HIGHEST
    first = normal[0] if normal[0] != 0.0 else normal[1] if normal[1] != 0.0 else normal[2]
    vectors, n = np.empty((count, 15), np.int64), np.empty((count, 3), np.int64)
    for k in range(count):
        vectors[k] = np.array(residues_of_vectors(around, lowest, primes[k], powers[k]))
        for x in range(3):
            n[k, x] = residue(math.copysign(1.0, first) * normal[x], lowest_n, primes[k], powers[k])
    residues, digits = np.empty((4, count), np.int64), np.empty(count, np.int64)
    forms[:] = 0.0
    signs[:] = 0
    for s in range(4):
        for t in range(s, 4):
            residues_of_monomial(vectors, n, s, t, primes, residues)
            leads_in_d = forms[0] == 0.0
            for form in range(4):
                known = not leads_in_d and (form == 0 or signs[form - 1] != 0)
                if known or not residues[form].any():
                    continue
                value = value_of(residues[form], primes, inverses, digits)
                if leads_in_d:
                    forms[form] = value
                if form > 0 and signs[form - 1] == 0:
                    signs[form - 1] = int(value > 0.0) - int(value < 0.0)
            if (signs.min() < 0 and signs.max() > 0 and s + t == 0) or signs.all():
                return 2 * (lowest + lowest_n - 2 * MANTISSA)
    return 2 * (lowest + lowest_n - 2 * MANTISSA)


# --- pairs of patches and normals -----------------------------------------------------------------


@jit
def decide_pairs(
    mu, scale, patches, normals, bounds, forgiven, primes, powers, inverses, first, last,
    local, size, signs, known,
):  # fmt: skip
    """Decide the pairs first, …, last − 1 of patches and normals that rounding leaves open.

    `bounds` are the errors of their forms as floating-point numbers; what is `forgiven` at the open
    border of the domain needs the parameters even outside. Writes U/D and V/D to local (k, 2), the
    modulus of D to size (k), the signs of U, V, W to signs (k, 3), and whether these are known: they
    are not if the numbers are too long.
    """
    columns = mu.shape[1] - 2
    around, forms = np.empty((9, 3)), np.empty(4)
    exponent = math.frexp(scale)[1] - 1
    for k in range(first, last):
        cell = patches[k] // 4
        turn = patches[k] % 4
        i = cell // columns + 1
        j = cell % columns + 1
        n = normals[k]
        D, U, V, W = precise_forms(mu, i, j, turn, scale, n[0], n[1], n[2])
        least = PRECISE * bounds[k]
        low, high = min(U[0], V[0], W[0]), max(U[0], V[0], W[0])
        nearest = min(abs(U[0]), abs(V[0]), abs(W[0]))
        if (nearest > least and abs(D[0]) > bounds[k]) or (
            low < -least and high > least and forgiven[k] == 0.0
        ):
            for form, value in enumerate((U[0], V[0], W[0])):
                signs[k, form] = int(value > least) - int(value < -least)
            local[k, 0], local[k, 1], size[k] = U[0] / D[0], V[0] / D[0], abs(D[0])
            known[k] = True
            continue
        for place in range(9):
            around[place] = mu[i + NEIGHBOURS[turn, place, 0], j + NEIGHBOURS[turn, place, 1]]
        unit = exact_forms(around, n, primes, powers, inverses, forms, signs[k])
        known[k] = unit < HIGHEST
        local[k, 0], local[k, 1] = forms[1] / forms[0], forms[2] / forms[0]
        size[k] = math.ldexp(abs(forms[0]), unit + 2 * exponent)
