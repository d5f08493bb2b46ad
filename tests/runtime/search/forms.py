"""The formulas of the search, written anew: on floats, or on fractions for exact decisions."""

from fractions import Fraction
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]


def fractions(values: Any) -> Array:
    return np.vectorize(Fraction, otypes=[object])(values)


def power_form(net: Array) -> Array:
    """Return a, b, c, d, e of the patch a u² + 2b uv + c v² + 2d u + 2e v + p."""
    b200, b020, b002, b110, b101, b011 = net
    return np.array([
        b200 - 2 * b101 + b002, b110 - b101 - b011 + b002, b020 - 2 * b011 + b002,
        b101 - b002, b011 - b002,
    ])  # fmt: skip


def by_brute_force(nets: Array, normals: Array) -> list[tuple[int, int, int]]:
    """Return all points: number of the normal, number of the patch, sign of K; ascending.

    Normals are on no boundary of a patch: the signs of U, V, W and of N·n decide alone.
    """
    found = []
    for patch, net in enumerate(nets):
        a, b, c, d, e = power_form(net)
        A, B, C, P, Q = (normals @ x for x in (a, b, c, d, e))
        D, U, V = A * C - B * B, B * Q - C * P, B * P - A * Q
        W = D - U - V
        inside = (np.minimum(np.minimum(U, V), W) > 0) | (np.maximum(np.maximum(U, V), W) < 0)
        for k in np.flatnonzero(inside & (D != 0)).tolist():
            N = np.cross(U[k] * a + V[k] * b + D[k] * d, U[k] * b + V[k] * c + D[k] * e)
            if N @ normals[k] > 0:
                found.append((k, patch, 1 if D[k] > 0 else -1))
    return sorted(found)
