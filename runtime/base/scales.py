"""Powers of two that bring numbers to about 1."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["LARGEST_EXPONENT", "scale_to_one", "scales_to_one"]

# Above this binary exponent, products with a few small integers may overflow.
LARGEST_EXPONENT = 1000


def scale_to_one(largest: float) -> float:
    """Return a power of two that brings a number to about 1."""
    return math.ldexp(1.0, min(-math.frexp(largest)[1], LARGEST_EXPONENT)) if largest else 1.0


def scales_to_one(largest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return powers of two that bring numbers to about 1; 1 for zero, infinity and NaN."""
    return np.ldexp(1.0, np.minimum(-np.frexp(largest)[1], LARGEST_EXPONENT))
