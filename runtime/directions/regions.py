"""Parts of a set of normals: those in a cap, those in a polygon on the sphere."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.checks import finite_number, positive_number
from ..base.errors import InputError, shown
from ..base.memory import check_memory
from ..base.tolerances import TRIPLE_PRODUCT_ERROR
from .unit import as_normals, unit_vector

__all__ = ["Cap", "angles_between", "cap", "checked_reach", "polygon"]


class Cap(NamedTuple):
    """The directions within an angle, in degrees, of a unit vector."""

    axis: NDArray[np.float64]
    angle: float

    @property
    def solid_angle(self) -> float:
        """The solid angle of the cap."""
        return 4.0 * math.pi * math.sin(math.radians(self.angle) / 2.0) ** 2

    def contains(self, normals: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which unit normals (N, 3) are in the cap; rows of NaN or 0 are not."""
        return normals.any(axis=1) & (angles_between(normals, self.axis) <= self.angle)


def checked_reach(reach: Any) -> Cap | None:  # noqa: ANN401
    """Return a pair of an axis and an angle as a cap; InputError if it is none."""
    if reach is None:
        return None
    try:
        axis, angle = reach
    except Exception:  # iteration may raise anything
        raise InputError(
            f"reach must be an axis and an angle in degrees, such as ((0, 0, 1), 60.0), not "
            f"{shown(reach)}."
        ) from None
    degrees = positive_number(angle, "the angle of reach", " degrees", most=180.0)
    return Cap(unit_vector(axis, "the axis of reach"), degrees)


def cap(normals: ArrayLike, axis: ArrayLike, angle: float) -> NDArray[np.float64]:
    """Return those of some normals that are within an angle of an axis.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.
    axis : (3,) array_like
        The direction of the middle of the cap.
    angle : float
        The radius of the cap in degrees, from 0 to 180: 90 gives the closed hemisphere, 180 all
        normals.

    Returns
    -------
    (k, 3) float64 array
        Unit normals in the order of `normals`; there may be none.

    Raises
    ------
    InputError
        For unusable normals (see `sample`), an axis that is zero or not three finite numbers, or an
        angle out of range.

    See Also
    --------
    polygon : the normals in a convex polygon on the sphere.

    Notes
    -----
    Any other region is a mask on the array, such as ``normals[normals[:, 2] > 0.5]``.

    Examples
    --------
    >>> import gaussmap as gm
    >>> upper = gm.directions.cap(gm.icosphere(8), axis=(0, 0, 1), angle=60)
    >>> bool((upper[:, 2] >= 0.5 - 1e-15).all())
    True

    """
    directions, middle = as_normals(normals), unit_vector(axis, "axis")
    degrees = finite_number(angle, "angle")
    if not 0.0 <= degrees <= 180.0:
        raise InputError(f"angle must lie between 0 and 180 degrees, and is {degrees:g}.")
    check_memory("cap", len(directions))
    return directions[Cap(middle, degrees).contains(directions)]


def polygon(normals: ArrayLike, corners: ArrayLike) -> NDArray[np.float64]:
    """Return those of some normals that lie in a convex polygon on the sphere.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.
    corners : (c, 3) array_like
        At least three directions of any length, anticlockwise as seen from outside. The edges are
        arcs of great circles, each shorter than half of one; the boundary belongs to the polygon.

    Returns
    -------
    (k, 3) float64 array
        Unit normals in the order of `normals`; there may be none.

    Raises
    ------
    InputError
        For unusable normals or corners, neighbouring corners that are equal or opposite, or corners
        that are not in anticlockwise order round a convex polygon.

    See Also
    --------
    cap : the normals within an angle of an axis.

    Examples
    --------
    >>> import gaussmap as gm
    >>> octant = gm.directions.polygon(gm.icosphere(8), [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> bool((octant >= -1e-15).all())
    True

    """
    directions, around = as_normals(normals), as_normals(corners)
    if len(around) < 3:
        raise InputError(f"a polygon needs at least 3 corners, not {len(around)}.")
    following = np.roll(around, -1, axis=0)
    inwards = np.cross(around, following)
    lengths = np.linalg.norm(inwards, axis=1)
    if (lengths <= TRIPLE_PRODUCT_ERROR).any():
        k = int(np.argmax(lengths <= TRIPLE_PRODUCT_ERROR))
        raise InputError(
            f"corners {k} and {(k + 1) % len(around)} are equal or opposite: no arc joins them."
        )
    if (around @ inwards.T < -TRIPLE_PRODUCT_ERROR).any():
        raise InputError(
            "the corners must go round a convex polygon anticlockwise, as seen from outside."
        )
    check_memory("polygon", len(directions), 9.0 * len(around))  # a number and a boolean each
    return directions[(directions @ inwards.T >= -TRIPLE_PRODUCT_ERROR).all(axis=1)]


def angles_between(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles in degrees between unit vectors (…, 3), accurate also near 0 and 180."""
    apart = np.linalg.norm(first - second, axis=-1)
    together = np.linalg.norm(first + second, axis=-1)
    return np.degrees(2.0 * np.arctan2(apart, together))
