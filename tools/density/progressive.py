"""A progressive order of samples: every prefix is well distributed."""

import math

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.scales import scale_to_one
from ...runtime.base.trees import tree_of
from .candidates import Candidates

# In each round, samples are chosen with mutual distances of at least a radius, relative to the
# local spacing. The radius falls from one that contains all samples to FINEST, by the factor STEP.
STEP, FINEST = 2.0**-0.5, 0.25
# The local spacing is the mean distance to this number of nearest neighbours.
NEIGHBOURS = 6


def progressive_order(
    points: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return the indices (N,) of points (N, 3) with normals (N, 3) in progressive order.

    Distances are relative to the local spacing of the samples, so that the density of a prefix is
    that of all samples, up to a constant factor.
    """
    count = len(points)
    left = np.random.default_rng(0).permutation(count)  # no preferred direction
    if count <= NEIGHBOURS:
        return left
    order, radius = left[:0], 2.0 * math.sqrt(count)
    points = points * scale_to_one(float(np.ptp(points, axis=0).max()))
    densities = 1.0 / _spacings(points) ** 2
    rows = np.column_stack([points - points.min(axis=0), normals, densities, densities])
    while len(left) and radius > FINEST:
        candidates = Candidates(rows[left], radius)
        candidates.update_distances(rows[order, :6], radius)
        chosen = candidates.choose(radius, len(left))
        order, left = np.append(order, left[chosen]), np.delete(left, chosen)
        radius *= STEP
    return np.append(order, left)  # samples that nearly coincide with others


def _spacings(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the local spacing (N,) at each point, which is positive.

    If most points coincide, it is at least the spacing of the same number of points spread evenly
    over a square, whose side is the extent of all points.
    """
    distances = tree_of(points).query(points, k=NEIGHBOURS + 1, workers=-1)[0][:, 1:].mean(axis=1)
    least = float(np.median(distances)) * 1e-3
    if least == 0.0:
        least = float(np.ptp(points, axis=0).max()) / math.sqrt(len(points))
    return np.maximum(distances, least or 1.0)
