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

__all__ = ["normal_deviation"]

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
    if len(points) == 0:
        return NormalDeviation(180.0, 180.0)
    number = max(PLACES * len(points), FEWEST)
    places = cut_patches(sizing, math.sqrt(sizing.area / number))
    threads = thread_count(sizing.threads)
    # Searches among many nearly equal normals, as on a cone, would be slow.
    distinct = np.unique(normals.round(DIGITS), axis=0)
    of_normals, of_points = tree_of(distinct), tree_of(points)

    def nearest_normal(rows: Array) -> Array:
        return of_normals.query(rows[:, 3:6], workers=threads)[0]

    def nearest_point(rows: Array) -> Array:
        samples = of_points.query(rows[:, :3], workers=threads)[1]
        return np.linalg.norm(rows[:, 3:6] - normals[samples], axis=1)

    return NormalDeviation(_largest(places, nearest_normal), _largest(places, nearest_point))


def _largest(triangles: Triangles, chord_of: Callable[[Array], Array]) -> float:
    """Return the largest angle in degrees of chords at places on triangles."""
    found = 0.0
    for _ in range(CUTS):
        rows = triangles.as_samples()
        chords = np.where(rows[:, 3:6].any(axis=1), chord_of(rows), 0.0)
        found = max(found, float(chords.max(initial=0.0)))
        # Within a triangle the normal turns by no more than this.
        turns = triangles.sizing.geometry.normal_chords(triangles, rows)
        triangles = triangles[chords + turns > found].quarters
        if len(triangles) == 0:
            break
    return math.degrees(2.0 * math.asin(min(found, 2.0) / 2.0))
