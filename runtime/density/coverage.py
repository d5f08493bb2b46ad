"""The coverage: the largest distance of a point of the surface from the nearest sample."""

from __future__ import annotations

import math

import numpy as np

from ..base.trees import tree_of
from .candidates import Candidates
from .cells import Array, Cells
from .space import Space

__all__ = ["coverage"]

# The search ends when the bound is within this factor of the largest distance found.
TIGHT = 1.1
MOST_CUTS = 40
# The normal of all, so that samples count for both sides.
UPWARD = np.array([0.0, 0.0, 1.0])


def coverage(space: Space, points: Array, asked: float = math.inf) -> float:
    """Return a bound of the distance of points of the surface from the nearest of points (N, 3).

    Points and the distance are scaled as in `Space`. This is branch and bound: cells are cut that
    may hold a point farther away than TIGHT times the farthest place, or than `asked` if no place
    is. Where cells are those of a spline, and samples on the surface, twice the distance between
    spline and surface is added.
    Infinite if there are no points.
    """
    if len(points) == 0:
        return math.inf
    apart, space = 2.0 * space.distance * space.unit, space.uniform
    asked -= apart
    samples = np.column_stack([points, np.broadcast_to(UPWARD, points.shape)])
    radius = math.sqrt(space.area / len(points)) or 1.0  # within which samples are searched first
    cells, largest, found = space.cut(radius), 0.0, 0.0
    for _ in range(MOST_CUTS):
        distances = _distances(cells, samples, radius)
        bounds, found = distances + cells.radii, max(found, float(distances.max(initial=0.0)))
        far = bounds > (asked if found <= asked < TIGHT * found else TIGHT * found)
        largest = max(largest, float(bounds[~far].max(initial=0.0)))
        if not far.any():
            break
        radius, cells = float(bounds.max()), space.halves(space.halves(cells[far]))
    else:
        largest = max(largest, radius)
    return apart + largest


def _distances(cells: Cells, samples: Array, radius: float) -> Array:
    """Return the distances (M,) of places from the nearest of samples (N, 6), on any side.

    That is fast where there is one within a radius.
    """
    rows = cells.rows.copy()
    rows[:, 3:6], rows[:, 6] = UPWARD, 1.0  # for all, as the samples
    candidates = Candidates(rows, radius)
    candidates.update_distances(samples, radius)
    distances = candidates.distances
    unknown = distances > radius
    if unknown.any():
        distances[unknown] = tree_of(samples[:, :3]).query(rows[unknown, :3])[0]
    return distances
