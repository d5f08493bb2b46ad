"""Sets of unit normals: the refined icosahedron, the Fibonacci lattice, and what a user brings."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..generated import icosphere as icosahedron
from .checks import real_array, whole_number
from .errors import InputError

__all__ = ["as_normals", "fibonacci", "icosphere", "perpendicular"]

GOLDEN = (1 + math.sqrt(5)) / 2
MOST_FREQUENT = 10_000


def icosphere(frequency: int) -> NDArray[np.float64]:
    """Return the 10 ν² + 2 vertices (…, 3) of the icosahedron whose edges are cut into ν parts.

    Every face carries a planar triangular lattice that is projected from the centre to the unit
    sphere ("uniform refinement", paper, Sect. 4.2). The 12 vertices come first, then the points
    inside the 30 edges, then those inside the 20 faces. Many of them lie in common symmetry planes.

    Raises InputError unless `frequency` is a whole number from 1 to 10,000.
    """
    nu = whole_number(frequency, "frequency")
    if nu > MOST_FREQUENT:
        raise InputError(
            f"frequency must be a whole number of at most {MOST_FREQUENT:,}, not {nu}."
        )
    # Coordinates a + b φ as integers (a, b): what mirrors another point does so bit for bit.
    golden, corners = np.array([1.0, GOLDEN]), icosahedron.CORNERS
    along = np.arange(1, nu)[:, None, None]
    parts = [corners * nu]
    parts += [(nu - along) * corners[i] + along * corners[j] for i, j in icosahedron.EDGES]
    s, t = np.meshgrid(np.arange(1, nu), np.arange(1, nu), indexing="ij")
    s, t = (x[s + t < nu][:, None, None] for x in (s, t))
    parts += [
        (nu - s - t) * corners[i] + s * corners[j] + t * corners[k] for i, j, k in icosahedron.FACES
    ]
    return _unit(np.concatenate(parts) @ golden)


def fibonacci(count: int) -> NDArray[np.float64]:
    """Return `count` unit normals (count, 3) on a Fibonacci lattice, from +z to −z.

    The points are spread evenly (every one stands for the same area of the sphere) and in general
    position: no symmetry aligns them with a surface. Raises InputError unless `count` is a whole
    number of at least 1.
    """
    total = whole_number(count, "count")
    k = np.arange(total)
    z = 1.0 - (2.0 * k + 1.0) / total
    angle = 2.0 * math.pi * np.modf(k / GOLDEN)[0]
    radius = np.sqrt((1.0 - z) * (1.0 + z))
    return _unit(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z]))


def as_normals(normals: ArrayLike, dimension: int = 3) -> NDArray[np.float64]:
    """Return directions (S, dimension), of any non-zero lengths, as unit normals, float64.

    A vector that has unit length already, up to rounding, is kept bit for bit. Raises InputError
    for another shape, an empty array, NaN, infinity, or a vector of length 0, and names its row.
    """
    array = real_array(normals, "normals")
    if array.ndim != 2 or array.shape[1] != dimension or array.shape[0] == 0:
        raise InputError(
            f"normals must have the shape (S, {dimension}) with S >= 1, not {array.shape}."
        )
    bad = ~np.isfinite(array).all(axis=1)
    if bad.any():
        raise InputError(f"normals[{int(bad.argmax())}] holds NaN or infinity.")
    zero = ~array.any(axis=1)
    if zero.any():
        raise InputError(
            f"normals[{int(zero.argmax())}] is the zero vector, which has no direction."
        )
    return _unit(array)


def perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two unit vectors that make a right-handed frame with a unit vector."""
    least = np.eye(3)[np.argmin(np.abs(axis))]
    across = np.cross(least, axis)
    across /= np.linalg.norm(across)
    return across, np.cross(axis, across)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Divide by the length, safely for the smallest and the largest numbers."""
    exponents = np.frexp(np.abs(vectors).max(axis=1, keepdims=True))[1]
    scaled = np.ldexp(vectors, np.where(np.abs(exponents) > 1, -exponents, 0))
    length = np.sqrt(np.einsum("ij,ij->i", scaled, scaled))[:, None]
    return np.where(np.abs(length - 1.0) <= 4.5e-16, scaled, scaled / length)
