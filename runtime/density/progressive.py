"""An order of samples in which the first ones, however many, are a good sampling themselves."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels
from ..trees import tree_of
from .grids import grids_of

__all__ = ["progressive_order"]

# Radii within which no two samples are chosen, one after the other, in spacings of the samples.
STEP, FINEST = 2.0**-0.5, 0.25
# The spacing at a sample is the mean distance to so many others.
NEIGHBOURS = 6
SAMPLES_AT_A_TIME = 1 << 15


def progressive_order(
    points: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return the numbers (N,) of points (N, 3) with normals (N, 3): coarse ones first.

    Distances are taken beside the spacing of the samples there, so that as many come early where
    the samples are dense as where they are sparse, in proportion.
    """
    count = len(points)
    asked = np.random.default_rng(0).permutation(count)  # no direction goes first
    if count <= NEIGHBOURS:
        return asked
    places = np.column_stack([points - points.min(axis=0), normals])
    weights = 1.0 / _spacings(points) ** 2
    least = float(weights.min())
    order, counts = np.empty(count, dtype=np.int64), np.zeros(2, dtype=np.int64)
    radius = 2.0 * math.sqrt(count)
    while len(asked) and radius > FINEST:
        grids = grids_of(places, weights, order[: counts[0]], radius, least)
        for first in range(0, len(asked), SAMPLES_AT_A_TIME):
            last = min(first + SAMPLES_AT_A_TIME, len(asked))
            kernels.choose_apart(
                *grids[:2], places, weights, radius, grids[2], asked, first, last, order, counts
            )
        asked, counts[1] = asked[: counts[1]], 0
        radius *= STEP
    order[counts[0] :] = asked  # those that are almost at one place with others
    return order


def _spacings(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean distance (N,) of each point to the next ones, nowhere zero."""
    distances = tree_of(points).query(points, k=NEIGHBOURS + 1, workers=-1)[0][:, 1:].mean(axis=1)
    least = float(np.median(distances)) * 1e-3
    return np.maximum(distances, least if least > 0.0 else 1.0)
