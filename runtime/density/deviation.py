"""How far the normals of a surface are from those of its samples: in normal space and in space."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..base.threads import thread_count
from ..base.trees import tree_of
from ..samples.whole import NormalDeviation
from .sizing import SizingFunction
from .triangles import Array, Triangles, cut_patches

__all__ = ["angle_by", "deviation_by", "normal_deviation", "places_for"]

# Places for each sample at which normals are compared at first, and the least number of them.
PLACES, FEWEST = 16, 20_000
# Then triangles that may hold a larger angle than the largest found so far are cut, this often.
CUTS = 6
# Decimal places to which normals have to differ in the search for the nearest one.
DIGITS = 9


def normal_deviation(sizing: SizingFunction, points: Array, normals: Array) -> NormalDeviation:
    """Return the largest angles that are found; `points` (N, 3) are scaled as in `SizingFunction`.

    They are 180 degrees if there are no samples.
    """
    number = places_for(len(points))
    places = cut_patches(sizing, math.sqrt(sizing.area / number))
    return deviation_by(places, points, normals, sizing.threads)


def places_for(samples: int) -> int:
    """Return the number of places at which normals are compared with those of samples at first."""
    return max(PLACES * samples, FEWEST)


def deviation_by(
    places: Triangles, points: Array, normals: Array, threads: int | None
) -> NormalDeviation:
    """Return the same of triangles that make up a surface."""
    if len(points) == 0:
        return NormalDeviation(180.0, 180.0)
    tree, workers = tree_of(points), thread_count(threads)

    def nearest_point(rows: Array) -> Array:
        samples = tree.query(rows[:, :3], workers=workers)[1]
        return np.linalg.norm(rows[:, 3:6] - normals[samples], axis=1)

    return NormalDeviation(angle_by(places, normals, threads), _largest(places, nearest_point))


def angle_by(places: Triangles, normals: Array, threads: int | None) -> float:
    """Return the largest angle in degrees that is found from a normal to the nearest of (N, 3)."""
    # Searches among many nearly equal normals, as on a cone, would be slow.
    tree, workers = tree_of(np.unique(normals.round(DIGITS), axis=0)), thread_count(threads)

    def nearest_normal(rows: Array) -> Array:
        return tree.query(rows[:, 3:6], workers=workers)[0]

    return _largest(places, nearest_normal)


def _largest(triangles: Triangles, chord_of: Callable[[Array], Array]) -> float:
    """Return the largest angle in degrees of chords at places on triangles."""
    found = 0.0
    for _ in range(CUTS):
        rows = triangles.as_samples()
        chords = np.where(rows[:, 3:6].any(axis=1), chord_of(rows), 0.0)
        found = max(found, float(chords.max(initial=0.0)))
        # Within a triangle the normal turns by no more than this.
        turns = triangles.chords(rows)
        triangles = triangles[chords + turns > found].quarters
        if len(triangles) == 0:
            break
    return math.degrees(2.0 * math.asin(min(found, 2.0) / 2.0))
