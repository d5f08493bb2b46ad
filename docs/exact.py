"""The exact derivatives of surfaces of the catalogue, with which splines are compared."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import sympy as sp
from gaussmap.symbolic.surfaces import ParametricSurface
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def derivatives_of(entry: ParametricSurface) -> Callable[[ArrayLike, ArrayLike, int], Array]:
    """Return f(s, t, order) → (..., 3, 3) or (..., 6, 3): x, x_s, x_t; also x_ss, x_st, x_tt.

    The parameters s, t are those of the unit square.
    """
    u, v = entry.u, entry.v
    unit = {x: low + (high - low) * x for x, (low, high) in zip((u, v), entry.domain, strict=True)}
    position = sp.Matrix(entry.position).xreplace({**entry.defaults, **unit})
    orders = [(), (u,), (v,), (u, u), (u, v), (v, v)]
    rows = [sp.diff(x, *by) if by else x for by in orders for x in position.flat()]
    functions = {
        order: sp.lambdify((u, v), rows[:count], modules="numpy", cse=True)
        for order, count in ((1, 9), (2, 18))
    }

    def derivatives(s: ArrayLike, t: ArrayLike, order: int) -> Array:
        shape = np.broadcast_shapes(np.shape(s), np.shape(t))
        values = [np.broadcast_to(x, shape) for x in functions[order](s, t)]
        return np.stack(values, axis=-1).reshape(*shape, len(values) // 3, 3)

    return derivatives


def lengths(vectors: Array) -> Array:
    """Return the lengths of vectors (..., 3)."""
    return np.sqrt(np.einsum("...x,...x->...", vectors, vectors))


def angles(left: Array, right: Array) -> Array:
    """Return the angles between vectors in degrees, accurate when they are small."""
    chord = left / lengths(left)[..., None] - right / lengths(right)[..., None]
    return np.degrees(2 * np.arcsin(np.minimum(lengths(chord) / 2, 1.0)))
