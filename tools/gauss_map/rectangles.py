"""Rectangles (k, 2, 2) of the parameter plane: the lower and the upper corner of each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["merged"]

Array = NDArray[np.float64]


def merged(rectangles: Array) -> Array:
    """Merge rectangles that share a whole side, first along v and then along u."""
    for axis in (1, 0):
        rectangles = _merged_along(rectangles, axis)
    return rectangles


def _merged_along(rectangles: Array, axis: int) -> Array:
    if len(rectangles) == 0:
        return rectangles
    other = 1 - axis
    keys = rectangles[:, 0, axis], rectangles[:, 1, other], rectangles[:, 0, other]
    sorted_ = rectangles[np.lexsort(keys)]
    follows = (
        (sorted_[1:, 0, axis] == sorted_[:-1, 1, axis])
        & (sorted_[1:, 0, other] == sorted_[:-1, 0, other])
        & (sorted_[1:, 1, other] == sorted_[:-1, 1, other])
    )
    first, last = np.append(True, ~follows), np.append(~follows, True)
    return np.stack([sorted_[first, 0], sorted_[last, 1]], axis=1)
