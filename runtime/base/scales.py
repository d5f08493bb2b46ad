"""Scales of coordinates: powers of two that bring them to about 1, and limits of coordinates."""

import math

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .errors import SurfaceError

# Above this binary exponent, products with a few small integers may overflow.
LARGEST_EXPONENT = 1000
# Points count as the same if their distance, relative to the size of the surface, is at most this.
SAME_POINT = 1e-6
# Rounding of coordinates, in units of the last place: coordinates result from several operations.
ROUNDING = 64.0


def power_of_two(value: float) -> float:
    """Return the largest power of two that is not above a positive number."""
    return math.ldexp(1.0, math.frexp(value)[1] - 1)


def scale_to_one(largest: float) -> float:
    """Return the power of two by which a number has to be multiplied to be about 1."""
    return math.ldexp(1.0, min(-math.frexp(largest)[1], LARGEST_EXPONENT)) if largest else 1.0


def scales_to_one(largest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the powers of two that scale numbers to about 1; 1 for zero, infinity and NaN."""
    return np.ldexp(1.0, np.minimum(-np.frexp(largest)[1], LARGEST_EXPONENT))


def apart(
    first: NDArray[np.float64], second: NDArray[np.float64], points: NDArray[np.float64]
) -> bool:
    """Return whether `first` and `second`, which should be equal, differ by more than rounding.

    `points` are all points of the surface, which determine the tolerance.
    """
    size, last_place = extent_of(points)
    return float(np.abs(first - second).max()) > SAME_POINT * size + ROUNDING * last_place


def extent_of(points: NDArray[np.float64]) -> tuple[float, float]:
    """Return the longest side of the bounding box of points (m, n, 3), and a unit of rounding.

    The unit is the distance from the largest coordinate to the next float64. Missing points (NaN)
    are ignored.
    """
    high, low = (f.reduce(f.reduce(points)) for f in (np.fmax, np.fmin))  # the fastest way
    largest = np.maximum(np.abs(low), np.abs(high)).max()
    return float((high - low).max()), float(np.spacing(largest))


def not_too_large(points: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Return points; SurfaceError if they are so large that formulas would overflow."""
    if np.abs(points).max() > 2.0**LARGEST_EXPONENT:
        raise SurfaceError(
            f"the coordinates of {name!r} are too large to compute with: choose another unit of "
            "length, in which they are smaller than 1e301."
        )
    return points


def check_range(name: str, largest: float, dtype: DTypeLike) -> None:
    """Raise SurfaceError if the largest coordinate of a surface is beyond the range of `dtype`."""
    limits = np.finfo(np.zeros(0, dtype).dtype)
    if not float(limits.tiny) <= largest <= float(limits.max) and largest > 0.0:
        raise SurfaceError(
            f"the coordinates of {name!r} are too {'large' if largest > 1.0 else 'small'} "
            f"for {limits.dtype}; choose another unit of length or double precision."
        )
