"""The vectors that formulas take and return, and the decorator that inlines formulas.

Written by `make generate`, SymPy 1.14.0, float64, no fast-math: do not edit, change symbolic/.
"""

from typing import NamedTuple

import numba

# A formula is put into its callers before types are known, and not compiled by itself.
inline = numba.njit(inline="always", nogil=True, error_model="numpy", fastmath=False)


class Vector(NamedTuple):
    """A vector of R³."""

    x: float
    y: float
    z: float


class PlaneVector(NamedTuple):
    """A vector of R²."""

    x: float
    y: float


class Taylor(NamedTuple):
    """The Taylor coefficients of a function of u and v up to order 2."""

    value: float
    u: float
    v: float
    uu: float
    uv: float
    vv: float


class CubicTaylor(NamedTuple):
    """The Taylor coefficients of a function up to order 3."""

    value: float
    u: float
    v: float
    uu: float
    uv: float
    vv: float
    uuu: float
    uuv: float
    uvv: float
    vvv: float


class Patch(NamedTuple):
    """The vectors of a quadratic patch, eq. (8)."""

    a: Vector
    b: Vector
    c: Vector
    d: Vector
    e: Vector
    p: Vector


class Arc(NamedTuple):
    """The vectors of a quadratic arc, as those of a patch."""

    a: PlaneVector
    b: PlaneVector
    c: PlaneVector


class Hessian(NamedTuple):
    """The entries of a Hessian, a symmetric matrix."""

    H_xx: float
    H_yy: float
    H_zz: float
    H_xy: float
    H_xz: float
    H_yz: float
