"""Elementary functions: the formulas and tables of symbolic/elementary.py.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

import math

import numpy as np

from .vectors import inline

# The operations of tapes; from RECIPROCAL on, they are functions.
U = 0
V = 1
CONSTANT = 2
SUM = 3
NEGATIVE = 4
SHIFT = 5
SCALE = 6
SPLINE = 7
COORDINATE = 8
PRODUCT = 9
RECIPROCAL = 10
SQUARE = 11
CUBE = 12
SQRT = 13
EXP = 14
LOG = 15
SIN = 16
COS = 17
SINH = 18
COSH = 19
TANH = 20
ASIN = 21
ATAN = 22
ERF = 23
SINC = 24
SIGN = 25
# For each function: how often value, f1, f2 and f3 are rounded,
ROUNDINGS = np.array(
    [
        [1, 4, 5, 8],
        [1, 1, 0, 0],
        [2, 2, 1, 0],
        [1, 4, 10, 16],
        [4, 4, 6, 6],
        [4, 1, 5, 7],
        [4, 4, 6, 6],
        [4, 5, 6, 6],
        [4, 4, 6, 6],
        [4, 4, 6, 6],
        [4, 12, 16, 25],
        [4, 6, 23, 40],
        [4, 3, 9, 17],
        [4, 7, 8, 12],
        [5, 10, 14, 17],
        [0, 0, 0, 0],
    ]
)
# bounds of the sums of absolute values where terms cancel,
CANCELLING = np.array(
    [
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        5.333333333333333,
        0.0,
        1.6666666666666667,
        1.1428571428571428,
        3.0,
        0.0,
    ]
)
# and where there are extremes: at multiples of this distance, and at these places.
SPACING = np.array(
    [
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        1.5707963267948966,
        1.5707963267948966,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    ]
)
EXTREMES = np.array(
    [
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [np.nan, np.nan, np.nan, np.nan, np.nan],
        [np.nan, np.nan, np.nan, np.nan, np.nan],
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [np.nan, np.nan, np.nan, np.nan, np.nan],
        [np.nan, np.nan, np.nan, np.nan, np.nan],
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [-1.1462158347805889, -0.6584789484624084, 0.0, 0.6584789484624084, 1.1462158347805889],
        [0.0, np.nan, np.nan, np.nan, np.nan],
        [-1.0, -0.5773502691896257, 0.0, 0.5773502691896257, 1.0],
        [-1.224744871391589, -0.7071067811865476, 0.0, 0.7071067811865476, 1.224744871391589],
        [np.nan, np.nan, np.nan, np.nan, np.nan],
        [0.0, np.nan, np.nan, np.nan, np.nan],
    ]
)
# Bounds of the slopes of a function and of f1, f2, f3 where they have others.
SINC_SLOPES = np.array([0.5, 0.3333333333333333, 0.125, 0.03333333333333333])


@inline
def reciprocal_taylor(y):
    """The Taylor coefficients f1, f2, f3 of reciprocal at x, from x or values there.

        f1 = - y**2
        f2 = y**3
        f3 = - y**4

    Source: beyond the paper; 8 operations as written, 8 here.
    """
    f1 = -y * y
    f2 = y * y * y
    f3 = -y * y * y * y
    return f1, f2, f3


@inline
def square_taylor(x):
    """The Taylor coefficients f1, f2, f3 of square at x, from x or values there.

        f1 = 2*x
        f2 = 1
        f3 = 0

    Source: beyond the paper; 1 operations as written, 1 here.
    """
    f1 = 2 * x
    f2 = 1
    f3 = 0
    return f1, f2, f3


@inline
def cube_taylor(x):
    """The Taylor coefficients f1, f2, f3 of cube at x, from x or values there.

        f1 = 3*x**2
        f2 = 3*x
        f3 = 1

    Source: beyond the paper; 3 operations as written, 3 here.
    """
    f1 = 3 * x * x
    f2 = 3 * x
    f3 = 1
    return f1, f2, f3


@inline
def sqrt_taylor(y):
    """The Taylor coefficients f1, f2, f3 of sqrt at x, from x or values there.

        w = 1/y
        f1 = w/2
        f2 = - w**3/8
        f3 = w**5/16

    Source: beyond the paper; 10 operations as written, 10 here.
    """
    w = 1.0 / y
    f1 = 0.5 * w
    f2 = -0.125 * w * w * w
    f3 = 0.0625 * w * w * w * w * w
    return f1, f2, f3


@inline
def exp_taylor(y):
    """The Taylor coefficients f1, f2, f3 of exp at x, from x or values there.

        f1 = y
        f2 = y/2
        f3 = y/6

    Source: beyond the paper; 2 operations as written, 2 here.
    """
    f1 = y
    f2 = 0.5 * y
    f3 = (1.0 / 6.0) * y
    return f1, f2, f3


@inline
def log_taylor(x):
    """The Taylor coefficients f1, f2, f3 of log at x, from x or values there.

        w = 1/x
        f1 = w
        f2 = - w**2/2
        f3 = w**3/3

    Source: beyond the paper; 6 operations as written, 6 here.
    """
    w = 1.0 / x
    f1 = w
    f2 = -0.5 * w * w
    f3 = (1.0 / 3.0) * w * w * w
    return f1, f2, f3


@inline
def sin_taylor(y, w):
    """The Taylor coefficients f1, f2, f3 of sin at x, from x or values there.

        f1 = w
        f2 = - y/2
        f3 = - w/6

    Source: beyond the paper; 2 operations as written, 2 here.
    """
    f1 = w
    f2 = -0.5 * y
    f3 = -(1.0 / 6.0) * w
    return f1, f2, f3


@inline
def cos_taylor(y, w):
    """The Taylor coefficients f1, f2, f3 of cos at x, from x or values there.

        f1 = - w
        f2 = - y/2
        f3 = w/6

    Source: beyond the paper; 3 operations as written, 3 here.
    """
    f1 = -w
    f2 = -0.5 * y
    f3 = (1.0 / 6.0) * w
    return f1, f2, f3


@inline
def sinh_taylor(y, w):
    """The Taylor coefficients f1, f2, f3 of sinh at x, from x or values there.

        f1 = w
        f2 = y/2
        f3 = w/6

    Source: beyond the paper; 2 operations as written, 2 here.
    """
    f1 = w
    f2 = 0.5 * y
    f3 = (1.0 / 6.0) * w
    return f1, f2, f3


@inline
def cosh_taylor(y, w):
    """The Taylor coefficients f1, f2, f3 of cosh at x, from x or values there.

        f1 = w
        f2 = y/2
        f3 = w/6

    Source: beyond the paper; 2 operations as written, 2 here.
    """
    f1 = w
    f2 = 0.5 * y
    f3 = (1.0 / 6.0) * w
    return f1, f2, f3


@inline
def tanh_taylor(y):
    """The Taylor coefficients f1, f2, f3 of tanh at x, from x or values there.

        f1 = - (y - 1)*(y + 1)
        f2 = y*(y - 1)*(y + 1)
        f3 = - (y - 1)*(y + 1)*(3*y**2 - 1)/3

    Source: beyond the paper; 16 operations as written, 10 here.
    """
    t0 = (y - 1) * (y + 1)
    f1 = -t0
    f2 = t0 * y
    f3 = -(1.0 / 3.0) * t0 * (3 * y * y - 1)
    return f1, f2, f3


@inline
def asin_taylor(x):
    """The Taylor coefficients f1, f2, f3 of asin at x, from x or values there.

        w = 1/sqrt((1 - x)*(x + 1))
        f1 = w
        f2 = w**3*x/2
        f3 = w**3*(3*w**2*x**2 + 1)/6

    Source: beyond the paper; 18 operations as written, 16 here.
    """
    w = 1.0 / math.sqrt((1 - x) * (x + 1))
    f1 = w
    t0 = w * w * w
    f2 = 0.5 * t0 * x
    f3 = (1.0 / 6.0) * t0 * (3 * w * w * x * x + 1)
    return f1, f2, f3


@inline
def atan_taylor(x):
    """The Taylor coefficients f1, f2, f3 of atan at x, from x or values there.

        w = 1/(x**2 + 1)
        f1 = w
        f2 = - w**2*x
        f3 = w**2*(4*w*x**2 - 1)/3

    Source: beyond the paper; 13 operations as written, 11 here.
    """
    t0 = x * x
    w = 1.0 / (t0 + 1)
    f1 = w
    t1 = w * w
    f2 = -t1 * x
    f3 = (1.0 / 3.0) * t1 * (4 * t0 * w - 1)
    return f1, f2, f3


@inline
def erf_taylor(x, w):
    """The Taylor coefficients f1, f2, f3 of erf at x, from x or values there.

        f1 = 2*w/sqrt(pi)
        f2 = - 2*w*x/sqrt(pi)
        f3 = 2*w*(2*x**2 - 1)/(3*sqrt(pi))

    Source: beyond the paper; 11 operations as written, 9 here.
    """
    t0 = w / math.sqrt(math.pi)
    t1 = 2 * t0
    f1 = t1
    f2 = -t1 * x
    f3 = (2.0 / 3.0) * t0 * (2 * x * x - 1)
    return f1, f2, f3


@inline
def sinc_taylor(x, y, w):
    """The Taylor coefficients f1, f2, f3 of sinc at x, from x or values there.

        f1 = - (y - w)/x
        f2 = - (2*w + x**2*y - 2*y)/(2*x**2)
        f3 = (6*w - w*x**2 + 3*x**2*y - 6*y)/(6*x**3)

    Source: beyond the paper; 26 operations as written, 23 here.
    """
    f1 = -(y - w) / x
    t0 = x * x
    f2 = -0.5 * (t0 * y + 2 * w - 2 * y) / t0
    f3 = (1.0 / 6.0) * (3 * t0 * y - t0 * w + 6 * w - 6 * y) / (x * x * x)
    return f1, f2, f3


@inline
def reduced_angle(x, k):
    """The difference r of an angle x and the nearest number k of quarters of a turn. Products
    with the first two numbers, and the first difference, are exact for |x| below 2**18, so that
    r has two roundings; where most digits cancel, the second difference is exact, too.

        s = x - 1686629713*k/1073741824
        t = s - 2242054355*k/36893488147419103232
        r = t - 5376105825661043*k/2658455991569831745807614120560689152

    Source: beyond the paper; 6 operations as written, 6 here.
    """
    s = x - 1.5707963267341256 * k
    t = s - 6.077100506303966e-11 * k
    r = t - 2.0222662487959506e-21 * k
    return r


@inline
def sine_and_cosine(x):
    """The sine y and the cosine w of an angle x of at most an eighth of a turn, to two units of
    the last place, also if x has two roundings: Taylor polynomials.

        z = x**2
        y_1 = z*(z*(z/355687428096000 - 1/1307674368000) + 1/6227020800) - 1/39916800
        y_2 = z*(z*(z*(y_1*z + 1/362880) - 1/5040) + 1/120) - 1/6
        w_1 = z*(z*(1/20922789888000 - z/6402373705728000) - 1/87178291200) + 1/479001600
        w_2 = z*(z*(z*(w_1*z - 1/3628800) + 1/40320) - 1/720) + 1/24
        a = x*z
        b = w_2*z - 1/2
        y = a*y_2 + x
        w = b*z + 1

    Source: beyond the paper; 36 operations as written, 36 here.
    """
    z = x * x
    y_1 = z * (
        z * ((1.0 / 355687428096000.0) * z + (-1.0 / 1307674368000.0)) + (1.0 / 6227020800.0)
    ) + (-1.0 / 39916800.0)
    y_2 = z * (z * (z * (y_1 * z + (1.0 / 362880.0)) + (-1.0 / 5040.0)) + (1.0 / 120.0)) + (
        -1.0 / 6.0
    )
    w_1 = z * (
        z * ((1.0 / 20922789888000.0) - (1.0 / 6402373705728000.0) * z) + (-1.0 / 87178291200.0)
    ) + (1.0 / 479001600.0)
    w_2 = z * (z * (z * (w_1 * z + (-1.0 / 3628800.0)) + (1.0 / 40320.0)) + (-1.0 / 720.0)) + (
        1.0 / 24.0
    )
    a = x * z
    b = w_2 * z - 0.5
    y = a * y_2 + x
    w = b * z + 1
    return y, w


@inline
def sinc_series(x):
    """The function y = sin(x)/x and its Taylor coefficients for |x| up to 1: their series.

        z = x**2
        y = z*(z*(z*(z*(z*(z*(z*(z*(z*(z/51090942171709440000 - 1/121645100408832000) + 1/355687428096000) - 1/1307674368000) + 1/6227020800) - 1/39916800) + 1/362880) - 1/5040) + 1/120) - 1/6)
          + 1
        f1 = x*(z*(z*(z*(z*(z*(z*(z*(z*(z/2554547108585472000 - 1/6758061133824000) + 1/22230464256000) - 1/93405312000) + 1/518918400) - 1/3991680) + 1/45360) - 1/840) + 1/30) - 1/3)
        f2 = z*(z*(z*(z*(z*(z*(z*(z*(z/268899695640576000 - 1/795066015744000) + 1/2964061900800) - 1/14370048000) + 1/94348800) - 1/887040) + 1/12960) - 1/336) + 1/20)
           - 1/6
        f3 = x*(z*(z*(z*(z*(z*(z*(z*(z/44816615940096000 - 1/149074877952000) + 1/635156121600) - 1/3592512000) + 1/28304640) - 1/332640) + 1/6480) - 1/252) + 1/30)

    Source: beyond the paper; 75 operations as written, 75 here.
    """
    z = x * x
    y = (
        z
        * (
            z
            * (
                z
                * (
                    z
                    * (
                        z
                        * (
                            z
                            * (
                                z
                                * (
                                    z
                                    * (
                                        z
                                        * (
                                            (1.0 / 51090942171709440000.0) * z
                                            + (-1.0 / 121645100408832000.0)
                                        )
                                        + (1.0 / 355687428096000.0)
                                    )
                                    + (-1.0 / 1307674368000.0)
                                )
                                + (1.0 / 6227020800.0)
                            )
                            + (-1.0 / 39916800.0)
                        )
                        + (1.0 / 362880.0)
                    )
                    + (-1.0 / 5040.0)
                )
                + (1.0 / 120.0)
            )
            + (-1.0 / 6.0)
        )
        + 1
    )
    f1 = x * (
        z
        * (
            z
            * (
                z
                * (
                    z
                    * (
                        z
                        * (
                            z
                            * (
                                z
                                * (
                                    z
                                    * (
                                        (1.0 / 2554547108585472000.0) * z
                                        + (-1.0 / 6758061133824000.0)
                                    )
                                    + (1.0 / 22230464256000.0)
                                )
                                + (-1.0 / 93405312000.0)
                            )
                            + (1.0 / 518918400.0)
                        )
                        + (-1.0 / 3991680.0)
                    )
                    + (1.0 / 45360.0)
                )
                + (-1.0 / 840.0)
            )
            + (1.0 / 30.0)
        )
        + (-1.0 / 3.0)
    )
    f2 = z * (
        z
        * (
            z
            * (
                z
                * (
                    z
                    * (
                        z
                        * (
                            z
                            * (
                                z * ((1.0 / 268899695640576000.0) * z + (-1.0 / 795066015744000.0))
                                + (1.0 / 2964061900800.0)
                            )
                            + (-1.0 / 14370048000.0)
                        )
                        + (1.0 / 94348800.0)
                    )
                    + (-1.0 / 887040.0)
                )
                + (1.0 / 12960.0)
            )
            + (-1.0 / 336.0)
        )
        + (1.0 / 20.0)
    ) + (-1.0 / 6.0)
    f3 = x * (
        z
        * (
            z
            * (
                z
                * (
                    z
                    * (
                        z
                        * (
                            z
                            * (
                                z * ((1.0 / 44816615940096000.0) * z + (-1.0 / 149074877952000.0))
                                + (1.0 / 635156121600.0)
                            )
                            + (-1.0 / 3592512000.0)
                        )
                        + (1.0 / 28304640.0)
                    )
                    + (-1.0 / 332640.0)
                )
                + (1.0 / 6480.0)
            )
            + (-1.0 / 252.0)
        )
        + (1.0 / 30.0)
    )
    return y, f1, f2, f3
