"""Patches by their control points b200, b020, b002, b110, b101, b011, in any exact numbers."""

from collections.abc import Iterable

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
