"""The coverage: the largest distance of a point of the surface from the nearest sample."""

from __future__ import annotations

import math

import numpy as np

from ..base.trees import tree_of
from .candidates import Candidates
from .sizing import SizingFunction
from .triangles import Array, Triangles, cut_patches

__all__ = ["coverage", "coverage_by"]

# The search ends when the bound is within this factor of the largest distance found.
TIGHT = 1.1
MOST_CUTS = 40


def coverage(sizing: SizingFunction, points: Array, asked: float = math.inf) -> float:
    """Return a bound of the distance of points of the surface from the nearest of points (N, 3).

    Points and the distance are scaled as in `SizingFunction`. This is branch and bound: triangles
    are cut that may hold a point farther away than TIGHT times the farthest centroid, or than
    `asked` if no centroid is. Triangles are those of the spline: twice its distance from the
    surface is added, if that is what is sampled. Infinite if there are no points.
    """
    apart = 2.0 * sizing.geometry.distance * sizing.unit
    return apart + coverage_by(cut_patches(sizing, math.inf), sizing.area, points, asked - apart)


def coverage_by(
    triangles: Triangles, area: float, points: Array, asked: float, tight: float = TIGHT
) -> float:
    """Return the same of triangles that make up a surface, with an area."""
    if len(points) == 0:
        return math.inf
    samples = np.column_stack([points, np.zeros_like(points)])
    radius = math.sqrt(area / len(points)) or 1.0  # within which samples are searched first
    largest = found = 0.0
    for _ in range(MOST_CUTS):
        distances = _distances(triangles, samples, radius)
        bounds, found = distances + triangles.radii, max(found, float(distances.max()))
        far = bounds > (asked if found <= asked < tight * found else tight * found)
        largest = max(largest, float(bounds[~far].max(initial=0.0)))
        if not far.any():
            break
        radius, triangles = float(bounds.max()), triangles[far].halves.halves
    else:
        largest = max(largest, radius)
    return largest


def _distances(triangles: Triangles, samples: Array, radius: float) -> Array:
    """Return the distances (M,) of centroids from the nearest of samples (N, 6) without normals.

    That is fast where there is one within a radius.
    """
    rows = triangles.at_places()
    rows[:, 3:7] = 1.0  # the same density for all; a sample without a normal counts for both sides
    candidates = Candidates(rows, radius)
    candidates.update_distances(samples, radius)
    distances = candidates.distances
    unknown = distances > radius
    if unknown.any():
        distances[unknown] = tree_of(samples[:, :3]).query(rows[unknown, :3])[0]
    return distances
