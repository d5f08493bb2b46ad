"""Finding the nearest of many points: SciPy's k-d tree, loaded when it is needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import KDTree

__all__ = ["tree_of"]


def tree_of(points: NDArray[np.float64], periods: NDArray[np.float64] | None = None) -> KDTree:
    """Return the k-d tree of points (N, k), whose coordinates have periods (k,) or 0 for none."""
    from scipy.spatial import KDTree  # its import takes as long as many a sampling

    return KDTree(points, boxsize=periods)
