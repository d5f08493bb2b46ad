"""Patches by their control points b200, b020, b002, b110, b101, b011, in any exact numbers."""

from collections.abc import Iterable
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray


def net_of(a, b, c, d, e) -> NDArray:
    """Return the control points of ½ a u² + b uv + ½ c v² + d u + e v."""
    a, b, c, d, e = (np.array(x, dtype=float) for x in (a, b, c, d, e))
    return np.array([d + a / 2, e + c / 2, 0 * a, (b + d + e) / 2, d / 2, e / 2])


def vectors_of(net: ArrayLike) -> NDArray:
    """Return a, b, c, d, e (5, 3) of the patch ½ a u² + b uv + ½ c v² + d u + e v + p."""
    b200, b020, b002, b110, b101, b011 = np.asarray(net)
    return np.array([
        2 * (b200 - 2 * b101 + b002), 2 * (b110 - b101 - b011 + b002),
        2 * (b020 - 2 * b011 + b002), 2 * (b101 - b002), 2 * (b011 - b002),
    ])  # fmt: skip


def normals_at(vectors: NDArray, u: ArrayLike, v: ArrayLike) -> NDArray:
    """Return p_u × p_v (k, 3) at places u, v (k,) of one patch, or of the patches (k, 5, 3)."""
    a, b, c, d, e = np.moveaxis(vectors, -2, 0)
    u, v = (np.asarray(x)[..., None] for x in (u, v))
    return np.cross(a * u + b * v + d, b * u + c * v + e)


def quadratic_forms(vectors: NDArray, normal: Iterable) -> list:
    """Return A, B, C, P, Q, the products of a, b, c, d, e with a normal."""
    return [sum(x * y for x, y in zip(normal, z, strict=True)) for z in vectors]


def in_fractions(numbers: ArrayLike) -> NDArray:
    """Return the same numbers as fractions, in an array of objects."""
    return np.vectorize(Fraction, otypes=[object])(numbers)


def exact_sign(net: ArrayLike, normal: ArrayLike) -> int:
    """Return the sign of D = A C − B², which is that of the curvature."""
    A, B, C, *_ = quadratic_forms(vectors_of(in_fractions(net)), in_fractions(normal))
    return (A * C > B * B) - (A * C < B * B)


def exact_place(net: ArrayLike, normal: ArrayLike) -> tuple[Fraction, Fraction] | None:
    """Solve n·p_u = n·p_v = 0 in fractions; None unless the closed patch has this normal."""
    vectors, n = vectors_of(in_fractions(net)), in_fractions(normal)
    A, B, C, P, Q = quadratic_forms(vectors, n)
    D = A * C - B * B
    if D == 0:
        return None
    u, v = (B * Q - C * P) / D, (B * P - A * Q) / D
    outside = min(u, v, 1 - u - v) < 0
    return None if outside or normals_at(vectors, u, v) @ n <= 0 else (u, v)
