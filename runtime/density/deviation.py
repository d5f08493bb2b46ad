"""How far the normals of a surface are from those of its samples: in normal space and in space."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..base.aliases import Array
from ..base.threads import thread_count
from ..base.trees import tree_of
from ..samples.whole import NormalDeviation
from .space import Space

__all__ = ["normal_deviation", "widest_angle"]

# Places for each sample at which normals are compared at first, and the least number of them.
PLACES, FEWEST = 16, 20_000
# Then cells that may hold a larger angle than the largest found so far are cut, this often.
CUTS = 6
# There are no more of these places than MOST; their cells are cut as much more often, BLOCK of them
# at a time, for the memory.
MOST, BLOCK = 1 << 21, 1 << 18
# Decimal places to which normals have to differ in the search for the nearest one.
DIGITS = 9


def normal_deviation(space: Space, points: Array, normals: Array) -> NormalDeviation:
    """Return the largest angles that are found; `points` (N, 3) are scaled as in `Space`.

    They are 180 degrees if there are no samples.
    """
    if len(points) == 0:
        return NormalDeviation(180.0, 180.0)
    tree, workers = tree_of(points), thread_count(space.threads)

    def nearest_point(rows: Array) -> Array:
        samples = tree.query(rows[:, :3], workers=workers)[1]
        return np.linalg.norm(rows[:, 3:6] - normals[samples], axis=1)

    return NormalDeviation(
        widest_angle(space, normals), _largest(space, len(points), nearest_point)
    )


def widest_angle(space: Space, normals: Array) -> float:
    """Return the largest angle in degrees that is found from a normal to the nearest of (N, 3)."""
    if len(normals) == 0:
        return 180.0
    # Searches among many nearly equal normals, as on a cone, would be slow.
    distinct = np.unique(normals.round(DIGITS), axis=0)
    tree, workers = tree_of(distinct), thread_count(space.threads)

    def nearest_normal(rows: Array) -> Array:
        return tree.query(rows[:, 3:6], workers=workers)[0]

    return _largest(space, len(normals), nearest_normal)


def _largest(space: Space, samples: int, chord_of: Callable[[Array], Array]) -> float:
    """Return the largest angle in degrees that is found of chords at places."""
    even, found = space.uniform.exact, 0.0
    wanted = max(PLACES * samples, FEWEST)
    first = min(wanted, MOST)
    all_cells, cuts = even.cut(math.sqrt(even.area / first)), CUTS
    while first < wanted:
        first, cuts = 4 * first, cuts + 1
    for start in range(0, len(all_cells), BLOCK):
        cells = all_cells[start : start + BLOCK]
        for _ in range(cuts):
            chords = np.where(cells.rows[:, 3:6].any(axis=1), chord_of(cells.rows), 0.0)
            found = max(found, float(chords.max(initial=0.0)))
            # Within a cell the normal turns by no more than this.
            cells = even.quarters(cells[chords + cells.chords > found])
            if len(cells) == 0:
                break
    return math.degrees(2.0 * math.asin(min(found, 2.0) / 2.0))
