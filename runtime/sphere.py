"""Sets of unit normals: icosahedron, Fibonacci lattice, HEALPix, random, what a user brings."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..generated import icosphere as icosahedron
from . import compiling  # noqa: F401 - it tells that kernels are compiled
from .checks import finite_array, real_values, whole_number
from .errors import InputError
from .extras import from_extra
from .threads import over_ranges

__all__ = [
    "as_normals",
    "fibonacci",
    "frequency_within",
    "healpix",
    "icosphere",
    "in_pieces",
    "part_of_fibonacci",
    "perpendicular",
    "random_normals",
    "spiral_angle",
    "unit_vector",
]

GOLDEN = (1 + math.sqrt(5)) / 2
# So many normals are made at a time: their arrays fit into the cache.
PIECE = 1 << 15
MOST_FREQUENT = 10_000
# The corners, the edges and the faces of an icosahedron.
PARTS = 1 + 30 + 20
PARTS_AT_A_TIME = 5


def icosphere(frequency: int) -> NDArray[np.float64]:
    """Return the 10 ν² + 2 vertices (…, 3) of the icosahedron whose edges are cut into ν parts.

    Every face carries a planar triangular lattice that is projected from the centre to the unit
    sphere ("uniform refinement", paper, Sect. 4.2). The 12 vertices come first, then the points
    inside the 30 edges, then those inside the 20 faces. Many of them lie in common symmetry planes.

    Raises InputError unless `frequency` is a whole number from 1 to 10,000.
    """
    nu = _refinement(frequency, "frequency")
    normals = np.empty((10 * nu**2 + 2, 3))

    def work(first: int, last: int) -> None:
        icosahedron.write_points(nu, first, last, normals)

    list(over_ranges(work, PARTS, PARTS_AT_A_TIME, 1 if len(normals) < PIECE else None))
    return normals


def frequency_within(angle: float) -> int:
    """Return the least ν for which every direction is within `angle` degrees of `icosphere(ν)`.

    Raises InputError if there is none.
    """
    tangent = math.tan(math.radians(angle))
    if tangent * MOST_FREQUENT < icosahedron.FACE_RADIUS:
        least = math.degrees(math.atan(icosahedron.FACE_RADIUS / MOST_FREQUENT))
        raise InputError(f"angle must be at least {least:.4f} degrees, not {angle:g}.")
    return max(1, math.ceil(icosahedron.FACE_RADIUS / tangent))


def fibonacci(count: int) -> NDArray[np.float64]:
    """Return `count` unit normals (count, 3) on a Fibonacci lattice, from +z to −z.

    The points are spread evenly (every one stands for the same area of the sphere) and in general
    position: no symmetry aligns them with a surface. Raises InputError unless `count` is a whole
    number of at least 1.
    """
    total = whole_number(count, "count")
    return part_of_fibonacci(total, 0, total)


def healpix(nside: int) -> NDArray[np.float64]:
    """Return the 12 nside² centres (…, 3) of the pixels of HEALPix, ring by ring from +z to −z.

    Pixels have equal areas, and their centres lie on rings of equal latitude; those on the equator
    and on some meridians lie in planes of symmetry. `nside` is a power of 2 up to 8,192.

    Needs astropy-healpix, which the extra "spheres" brings: MissingExtraError if it is not
    installed. Raises InputError unless `nside` is such a number.
    """
    size = _refinement(nside, "nside")
    if size & (size - 1):
        raise InputError(f"nside must be a power of 2, not {size}.")
    library = from_extra("astropy_healpix", "spheres", "HEALPix")
    xyz = library.healpix_to_xyz(np.arange(12 * size**2), size, order="ring")
    return as_normals(np.stack(xyz, axis=1))


def random_normals(count: int, *, seed: int = 0) -> NDArray[np.float64]:
    """Return `count` unit normals (count, 3), independent and uniform on the sphere.

    The same seed gives the same normals (with the same version of NumPy), and fewer of them are the
    first of more. They are less even than those of a lattice: about 1/e of the pieces of 4π/count
    stay empty. Raises InputError unless `count` and `seed` are whole numbers, of at least 1 and 0.
    """
    total, start = whole_number(count, "count"), whole_number(seed, "seed", least=0)
    return as_normals(np.random.default_rng(start).standard_normal((total, 3)))


def part_of_fibonacci(
    count: int, first: int, last: int, threads: int | None = None
) -> NDArray[np.float64]:
    """Return the rows first, …, last − 1 of `fibonacci(count)`."""

    def rows(begin: int, end: int) -> NDArray[np.float64]:
        k = np.arange(begin, end)
        z = 1.0 - (2.0 * k + 1.0) / count
        angle = spiral_angle(k)
        radius = np.sqrt((1.0 - z) * (1.0 + z))
        return _unit(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z]))

    return in_pieces(rows, first, last, threads)


def spiral_angle(k: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the azimuth of the points of a Fibonacci lattice."""
    return 2.0 * math.pi * np.modf(k / GOLDEN)[0]


def in_pieces(
    rows: Callable[[int, int], NDArray[np.float64]],
    first: int,
    last: int,
    threads: int | None = None,
    width: int = 3,
) -> NDArray[np.float64]:
    """Return rows(first, last) (…, width), made in pieces that stay in the cache, on threads."""
    result = np.empty((last - first, width))

    def work(begin: int, end: int) -> None:
        result[begin:end] = rows(first + begin, first + end)

    for _ in over_ranges(work, last - first, PIECE, threads):
        pass
    return result


def as_normals(
    normals: ArrayLike, dimension: int = 3, threads: int | None = None
) -> NDArray[np.float64]:
    """Return directions (S, dimension), of any non-zero lengths, as unit normals, float64.

    A vector that has unit length already, up to rounding, is kept bit for bit. Raises InputError
    for another shape, an empty array, NaN, infinity, or a vector of length 0, and names its row.
    """
    array = real_values(normals, "normals")
    if array.ndim != 2 or array.shape[1] != dimension or array.shape[0] == 0:
        raise InputError(
            f"normals must have the shape (S, {dimension}) with S >= 1, not {array.shape}."
        )

    def rows(begin: int, end: int) -> NDArray[np.float64]:
        return _unit(_checked_directions(array[begin:end], begin))

    return in_pieces(rows, 0, len(array), threads, dimension)


def unit_vector(direction: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return three numbers, of any length but 0, as a unit vector; InputError with their name."""
    vector = finite_array(direction, (3,), name)
    if not vector.any():
        raise InputError(f"{name} is the zero vector, which has no direction.")
    return _unit(vector[None])[0]


def perpendicular(axis: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two unit vectors that make a right-handed frame with a unit vector."""
    least = np.eye(3)[np.argmin(np.abs(axis))]
    across = np.cross(least, axis)
    across /= np.linalg.norm(across)
    return across, np.cross(axis, across)


def _refinement(value: int, name: str) -> int:
    """Return how fine a set shall be; InputError if it is no number, or larger than any memory."""
    number = whole_number(value, name)
    if number > MOST_FREQUENT:
        raise InputError(
            f"{name} must be a whole number of at most {MOST_FREQUENT:,}, not {number}."
        )
    return number


def _checked_directions(values: NDArray[Any], start: int) -> NDArray[np.float64]:
    """Return directions as float64; InputError names the first unusable row, from `start` on."""
    with np.errstate(over="ignore"):
        array = values.astype(np.float64)
    if not np.isfinite(array).all():
        bad = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise InputError(f"normals[{start + bad}] holds NaN or infinity.")
    zero = _largest(array) == 0.0
    if zero.any():
        raise InputError(
            f"normals[{start + int(zero.argmax())}] is the zero vector, which has no direction."
        )
    return array


def _largest(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest component of each vector, in modulus."""
    return reduce(np.maximum, np.abs(vectors).T)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Divide by the length, safely for the smallest and the largest numbers."""
    exponents = np.frexp(_largest(vectors))[1]
    far = np.abs(exponents) > 1
    if far.any():
        vectors = np.ldexp(vectors, np.where(far, -exponents, 0)[:, None])
    length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None]
    near = np.abs(length - 1.0) <= 4.5e-16
    return vectors if near.all() else np.where(near, vectors, vectors / length)
