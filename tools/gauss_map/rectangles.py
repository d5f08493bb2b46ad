"""Rectangles (k, 2, 2) of the parameter plane: the lower and the upper corner of each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["clusters", "merged", "quarters", "touching"]

Array = NDArray[np.float64]
QUARTERS = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], dtype=bool)


def quarters(rectangles: Array) -> Array:
    """Return the quarters (4 k, 2, 2): the first of all, then the second of all, and so on."""
    low, high = rectangles[:, 0], rectangles[:, 1]
    middle = 0.5 * (low + high)
    parts = [
        np.stack([np.where(upper, middle, low), np.where(upper, high, middle)], axis=1)
        for upper in QUARTERS
    ]
    return np.concatenate(parts)


def touching(rectangle: Array, others: Array, size: Array) -> NDArray[np.bool_]:
    """Return which of the others are within a distance `size` (2,) of a rectangle (2, 2)."""
    low, high = rectangle[0] - size, rectangle[1] + size
    return ((others[:, 0] <= high) & (others[:, 1] >= low)).all(axis=1)


def clusters(rectangles: Array, size: Array) -> Array:
    """Group rectangles within a distance `size` of each other; return the hull of each group."""
    groups = np.empty((0, 2, 2))
    for rectangle in rectangles:
        near = touching(rectangle, groups, size)
        corners = np.concatenate([rectangle[None], groups[near]])
        joint = np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
        groups = np.concatenate([groups[~near], joint[None]])
    return groups


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
