"""Grids in space in which samples are found: one for each size of their cells."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels

__all__ = ["grids_of"]


def grids_of(
    points: NDArray[np.float64],
    weights: NDArray[np.float64],
    numbers: NDArray[np.int64],
    radius: float,
    least: float,
) -> tuple[NDArray[np.int32], NDArray[np.int32], float]:
    """Return heads, links and the finest cell of grids that hold some of the samples, by number.

    They are for a radius that is not much smaller than this one, and for weights from `least` on;
    there is room for all rows of points (…, 6).
    """
    room = len(weights)
    finest = math.ldexp(2.0 * (radius / math.sqrt(least)), 1 - kernels.LEVELS)
    heads = np.full(1 << (2 * kernels.SIZES * room).bit_length(), -1, dtype=np.int32)
    links = np.empty(kernels.SIZES * room, dtype=np.int32)
    kernels.enter_samples(heads, links, points, weights, radius, finest, numbers)
    return heads, links, finest
