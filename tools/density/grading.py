"""Sizes of triangles that grow slowly: no sample has neighbours at very different distances."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.base.trees import tree_of

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# The spacing grows by at most GROWTH/s² for each unit of distance, where s is the angle in radians
# that normals turn by from one sample to the next. GROWTH was measured on meshes of 500 to 2,000
# samples. With 0.3, up to a twentieth of the samples on steep bends are superfluous if the sampling
# is coarse; with 0.1, these bends get more samples than they need, at the expense of other places.
GROWTH = 0.15
# The size of a cell is bounded by the sizes of this number of nearest cells.
NEAREST = 8
# Twice the area of a triangle of edges 1.
TWO_TRIANGLES = math.sqrt(3.0) / 2.0


@dataclass(frozen=True, eq=False)
class Sources:
    """Prescribed sizes at tree nodes; the last size, inf, is for points far from all nodes.

    At other points the size is that of the nearest node plus `growth` times its distance. If no
    node is within `reach`, the size is too large to matter.
    """

    tree: KDTree
    sizes: Array
    growth: float
    reach: float

    def sizes_at(self, points: Array, reach: float) -> Array:
        """Return bounds (M,) of the size at points (M, 3); inf if no node is within `reach`."""
        distances, rows = self.tree.query(points, distance_upper_bound=reach)
        return self.sizes[rows] + self.growth * distances


def growth_for(count: int, integral: float) -> float:
    """Return the growth of sizes for a number of samples and the integral of the target density."""
    return GROWTH / math.sqrt(integral / (TWO_TRIANGLES * count)) ** 3


def bounds_of(points: Array, sizes: Array, growth: float) -> Sources | None:
    """Return the largest slowly growing sizes that are at most `sizes` (M,) at points (M, 3).

    Return None if `sizes` themselves grow slowly.
    """
    tree = tree_of(points)
    distances, near = (
        x.reshape(len(points), -1) for x in tree.query(points, k=min(NEAREST, len(points)))
    )
    found, before = sizes, np.full(len(sizes), np.inf)
    while (found < before).any():
        before, found = found, (found[near] + growth * distances).min(axis=1)
    if (found == sizes).all():
        return None
    return Sources(tree, np.append(found, np.inf), growth, math.inf)
