"""An order of samples in which the first ones, however many, are a good sampling themselves."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..trees import tree_of
from .candidates import Candidates

__all__ = ["progressive_order"]

# Radii within which no two samples are chosen, one after the other, in spacings of the samples.
STEP, FINEST = 2.0**-0.5, 0.25
# The spacing at a sample is the mean distance to so many others.
NEIGHBOURS = 6


def progressive_order(
    points: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return the numbers (N,) of points (N, 3) with normals (N, 3): coarse ones first.

    Distances are taken beside the spacing of the samples there, so that as many come early where
    the samples are dense as where they are sparse, in proportion.
    """
    count = len(points)
    left = np.random.default_rng(0).permutation(count)  # no direction goes first
    if count <= NEIGHBOURS:
        return left
    order, radius = left[:0], 2.0 * math.sqrt(count)
    weights = 1.0 / _spacings(points) ** 2
    rows = np.column_stack([points - points.min(axis=0), normals, weights, weights])
    while len(left) and radius > FINEST:
        candidates = Candidates(rows[left], radius)
        candidates.tell(rows[order, :6], radius)
        chosen = candidates.choose(radius, len(left))
        order, left = np.append(order, left[chosen]), np.delete(left, chosen)
        radius *= STEP
    return np.append(order, left)  # those that are almost at one place with others


def _spacings(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean distance (N,) of each point to the next ones, nowhere zero."""
    distances = tree_of(points).query(points, k=NEIGHBOURS + 1, workers=-1)[0][:, 1:].mean(axis=1)
    least = float(np.median(distances)) * 1e-3
    return np.maximum(distances, least if least > 0.0 else 1.0)
