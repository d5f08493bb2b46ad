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


def bezier(net: NDArray, weights: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Return points at barycentric coordinates, and derivatives by the first two of these."""
    b200, b020, b002, b110, b101, b011 = np.moveaxis(net, -2, 0)
    l1, l2, l3 = (weights[..., k, None] for k in range(3))
    by1, by2, by3 = (
        l1 * b200 + l2 * b110 + l3 * b101,
        l1 * b110 + l2 * b020 + l3 * b011,
        l1 * b101 + l2 * b011 + l3 * b002,
    )
    return l1 * by1 + l2 * by2 + l3 * by3, 2.0 * (by1 - by3), 2.0 * (by2 - by3)


def by_brute_force(nets: NDArray, normals: NDArray) -> list[tuple[int, int, int]]:
    """Return all points: number of the normal, number of the patch, sign of K; ascending.

    Normals are on no boundary of a patch: the signs of U, V, W and of N·n decide alone.
    """
    found = []
    for patch, net in enumerate(nets):
        a, b, c, d, e = vectors_of(net)
        A, B, C, P, Q = (normals @ x for x in (a, b, c, d, e))
        D, U, V = A * C - B * B, B * Q - C * P, B * P - A * Q
        W = D - U - V
        inside = (np.minimum(np.minimum(U, V), W) > 0) | (np.maximum(np.maximum(U, V), W) < 0)
        for k in np.flatnonzero(inside & (D != 0)).tolist():
            N = np.cross(U[k] * a + V[k] * b + D[k] * d, U[k] * b + V[k] * c + D[k] * e)
            if N @ normals[k] > 0:
                found.append((k, patch, 1 if D[k] > 0 else -1))
    return sorted(found)
