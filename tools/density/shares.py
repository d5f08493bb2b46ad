"""Apportionment: division of a count in proportion to weights."""

import numpy as np
from numpy.typing import NDArray


def apportioned(count: int, weights: NDArray[np.float64]) -> NDArray[np.int64]:
    """Divide a count into integers in proportion to weights (k,), which are not all 0.

    The shares with the largest fractional parts are rounded up.
    """
    shares = weights * (count / weights.sum())
    parts = np.floor(shares).astype(np.int64)
    parts[np.argsort(parts - shares, kind="stable")[: count - int(parts.sum())]] += 1
    return parts
