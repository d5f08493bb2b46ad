"""Nearest-neighbour searches: SciPy's k-d tree, imported on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# Directions in a tree are distinct when rounded to this number of decimals.
DIGITS = 9


def tree_of(points: NDArray[np.float64], periods: NDArray[np.float64] | None = None) -> KDTree:
    """Return the k-d tree of points (N, k); `periods` (k,) are those of the coordinates, or 0."""
    from scipy.spatial import KDTree  # its import takes as long as a small sampling

    return KDTree(points, boxsize=periods)


def tree_of_directions(directions: NDArray[np.float64]) -> KDTree:
    """Return the k-d tree of unit vectors (N, 3) without near duplicates.

    Duplicates, such as the normals of planes and cones, would slow searches down.
    """
    rows = np.unique(directions.round(DIGITS), axis=0, return_index=True)[1]
    return tree_of(directions[rows])
