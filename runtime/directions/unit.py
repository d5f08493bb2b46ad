"""Directions as unit vectors: checks of users' directions, and frames perpendicular to them."""

from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.checks import finite_array, real_values
from ..base.errors import InputError
from ..base.memory import check_memory
from ..base.threads import over_ranges
from .kernels.unit import are_unit

# The number of normals in one batch, such that their arrays fit into the cache.
PIECE = 1 << 15
# The number of vectors in one batch of checks.
PART = 1 << 18


def as_normals(
    normals: ArrayLike, dimension: int = 3, threads: int | None = None
) -> NDArray[np.float64]:
    """Return directions (S, dimension), of any non-zero lengths, as unit normals, float64.

    A vector that already has unit length, up to rounding, is kept bit for bit. An array (S, 3) of
    such vectors is returned itself, not a copy, if it is float64, C-contiguous and writeable.
    Raises InputError for another shape, an empty array, NaN, infinity, or a vector of length 0,
    with the index of its row.
    """
    if hasattr(normals, "normals"):  # samples: as an array they are points
        raise InputError(
            f"normals are directions, not {type(normals).__name__}; give its .normals."
        )
    array = real_values(normals, "normals")
    if array.ndim != 2 or array.shape[1] != dimension or array.shape[0] == 0:
        raise InputError(
            f"normals must have the shape (S, {dimension}) with S >= 1, not {array.shape}"
            f"{'; write [normal] for one' if array.shape == (dimension,) else ''}."
        )
    if dimension == 3 and _are_unit(array, threads):
        return array

    def rows(begin: int, end: int) -> NDArray[np.float64]:
        return _normalized(*_checked_directions(array[begin:end], begin))

    return in_pieces(rows, 0, len(array), threads, dimension)


def unit_vector(direction: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return a direction (3,), of any length but 0, as a unit vector.

    Raises InputError, with the `name` of the direction, if it is unusable.
    """
    vector = finite_array(direction, (3,), name)
    if not vector.any():
        raise InputError(f"{name} is the zero vector, which has no direction.")
    return normalized(vector[None])[0]


def perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two unit vectors that make a right-handed frame with a unit vector."""
    least = np.eye(3)[np.argmin(np.abs(axis))]
    across = np.cross(least, axis)
    across /= np.linalg.norm(across)
    return across, np.cross(axis, across)


def in_pieces(
    rows: Callable[[int, int], NDArray[np.float64]],
    first: int,
    last: int,
    threads: int | None = None,
    width: int = 3,
) -> NDArray[np.float64]:
    """Return the rows [first, last) of a long array with `width` columns.

    The function `rows` computes a range of these rows; threads call it for PIECE rows at a time.
    """
    check_memory("normals", last - first)
    result = np.empty((last - first, width))

    def work(begin: int, end: int) -> None:
        result[begin:end] = rows(first + begin, first + end)

    list(over_ranges(work, last - first, PIECE, threads))
    return result


def normalized(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Divide vectors by their lengths, without overflow or underflow."""
    return _normalized(vectors, _largest(vectors))


def unit_or_zero(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors (…, 3) divided by their lengths; zero vectors stay 0."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)


def _normalized(vectors: NDArray[np.float64], largest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors divided by their lengths; `largest` are their largest |components|."""
    exponents = np.frexp(largest)[1]
    far = np.abs(exponents) > 1
    if far.any():
        vectors = np.ldexp(vectors, np.where(far, -exponents, 0)[:, None])
    length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None]
    near = np.abs(length - 1.0) <= 4.5e-16
    return vectors if near.all() else np.where(near, vectors, vectors / length)


def _are_unit(array: NDArray[Any], threads: int | None) -> bool:
    """Return whether an array holds unit vectors in the dtype and layout of the kernels."""
    if array.dtype != np.float64 or not array.flags.carray:
        return False

    def work(first: int, last: int) -> bool:
        return are_unit(array, first, last)

    return all(over_ranges(work, len(array), PART, threads))


def _checked_directions(
    values: NDArray[Any], start: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return directions as float64, and the largest component of each, in modulus.

    The InputError gives the index of the first unusable row; row 0 of `values` has index `start`.
    """
    with np.errstate(over="ignore"):
        array = values.astype(np.float64, copy=False)
    largest = _largest(array)
    finite = np.isfinite(largest)
    if not finite.all():
        raise InputError(f"normals[{start + int(finite.argmin())}] holds NaN or infinity.")
    if not largest.all():
        raise InputError(
            f"normals[{start + int(largest.argmin())}] is the zero vector, which has no direction."
        )
    return array, largest


def _largest(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest component of each vector, in modulus."""
    return reduce(np.maximum, np.abs(vectors).T)
