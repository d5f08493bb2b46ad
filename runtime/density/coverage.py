"""The coverage: the largest distance of a point of the surface from the nearest sample."""

from __future__ import annotations

import math

from ..base.aliases import Array
from ..base.threads import thread_count
from ..base.trees import tree_of
from .space import Space

__all__ = ["coverage"]

# The search ends when the bound is within this factor of the largest distance found.
TIGHT = 1.1
MOST_CUTS = 40


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
    tree, workers = tree_of(points), thread_count(space.threads)
    cells = space.cut(math.sqrt(space.area / len(points)) or 1.0)
    largest = found = widest = 0.0
    for _ in range(MOST_CUTS):
        distances = tree.query(cells.rows[:, :3], workers=workers)[0]
        bounds, found = distances + cells.radii, max(found, float(distances.max(initial=0.0)))
        far = bounds > (asked if found <= asked < TIGHT * found else TIGHT * found)
        largest = max(largest, float(bounds[~far].max(initial=0.0)))
        if not far.any():
            break
        widest, cells = float(bounds.max()), space.halves(space.halves(cells[far]))
    else:
        largest = max(largest, widest)
    return apart + largest
