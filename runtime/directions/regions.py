"""Parts of a set of normals: those in a cap, those in a polygon on the sphere."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import finite_number
from ..errors import InputError
from .unit import as_normals, unit_vector

__all__ = ["angles_between", "cap", "polygon"]

# Of triple products of unit vectors: what is on a border up to rounding belongs to the region.
ROUNDING = 2.0**-50


def cap(normals: ArrayLike, axis: ArrayLike, angle: float) -> NDArray[np.float64]:
    """Return those of the normals (S, 3) that are within `angle` degrees of an axis, (k, 3).

    They come as unit normals in the same order; 90 gives the closed hemisphere, 180 all of them.
    The result may be empty. Any other region is a mask on the array, such as
    `normals[normals[:, 2] > 0.5]`, or a `polygon`.

    Raises InputError for normals as `sample` does, an axis that is not three finite numbers or
    zero, and an angle that is not between 0 and 180.
    """
    directions, middle = as_normals(normals), unit_vector(axis, "axis")
    degrees = finite_number(angle, "angle")
    if not 0.0 <= degrees <= 180.0:
        raise InputError(f"angle must lie between 0 and 180 degrees, and is {degrees:g}.")
    return directions[angles_between(directions, middle) <= degrees]


def polygon(normals: ArrayLike, corners: ArrayLike) -> NDArray[np.float64]:
    """Return those of the normals (S, 3) that lie in a convex polygon on the sphere, (k, 3).

    Its edges are arcs of great circles, each shorter than half of one, between the `corners`
    (c, 3), c >= 3, directions of any length, which go round anticlockwise as seen from outside. The
    border belongs to it. The result, in the same order, may be empty.

    Raises InputError for normals and corners that are unusable, neighbouring corners that are equal
    or opposite, and corners that do not go round a convex polygon anticlockwise.
    """
    directions, around = as_normals(normals), as_normals(corners)
    if len(around) < 3:
        raise InputError(f"a polygon needs at least 3 corners, not {len(around)}.")
    following = np.roll(around, -1, axis=0)
    inwards = np.cross(around, following)
    lengths = np.linalg.norm(inwards, axis=1)
    if (lengths <= ROUNDING).any():
        k = int(np.argmax(lengths <= ROUNDING))
        raise InputError(
            f"corners {k} and {(k + 1) % len(around)} are equal or opposite: no arc joins them."
        )
    if (around @ inwards.T < -ROUNDING).any():
        raise InputError(
            "the corners must go round a convex polygon anticlockwise, as seen from outside."
        )
    return directions[(directions @ inwards.T >= -ROUNDING).all(axis=1)]


def angles_between(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles in degrees between unit vectors (…, 3), accurate also near 0 and 180."""
    apart = np.linalg.norm(first - second, axis=-1)
    together = np.linalg.norm(first + second, axis=-1)
    return np.degrees(2.0 * np.arctan2(apart, together))
