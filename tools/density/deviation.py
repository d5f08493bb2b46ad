"""Normal deviation: angles between the normals of a surface and those of its samples."""

import math
from collections.abc import Callable

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.base.threads import thread_count
from ...runtime.base.trees import tree_of, tree_of_directions
from ...runtime.samples.whole import NormalDeviation
from .angles import chord_of
from .cells import Cells
from .space import Space

# The initial number of test points per sample, and the least number of test points.
PLACES, FEWEST = 16, 20_000
# After the first test points, cells that may contain a larger angle than any found so far are cut,
# at most this often.
CUTS = 6
# At first there are at most MOST test points. If more are needed, the cells of the first ones are
# cut, at most BLOCK cells at a time, to bound the memory.
MOST, BLOCK = 1 << 21, 1 << 16


def normal_deviation(space: Space, points: Array, normals: Array) -> NormalDeviation:
    """Return the largest angles found between normals of the surface and of samples.

    The samples have points (N, 3), scaled as in `Space`, and unit normals (N, 3). Without samples,
    the angles are 180 degrees.
    """
    if len(points) == 0:
        return NormalDeviation(180.0, 180.0)
    tree, workers = tree_of(points), thread_count(space.threads)

    def nearest_point(cells: Cells) -> Array:
        samples = tree.query(cells.rows[:, :3], workers=workers)[1]
        return np.linalg.norm(cells.rows[:, 3:6] - normals[samples], axis=1)

    return NormalDeviation(
        widest_angle(space, normals), _largest(space, len(points), nearest_point)
    )


def widest_angle(
    space: Space, normals: Array, least: float = 0.0, wider: list[Cells] | None = None
) -> float:
    """Return the largest angle found from a normal of the surface to the nearest one of `normals`.

    The angle is in degrees; `normals` (N, 3) are the normals of samples. Angles below `least` are
    not searched: if no angle is larger, return `least`. Cells whose places have larger angles than
    `least` are appended to `wider`.
    """
    if len(normals) == 0:
        return 180.0
    tree, workers = tree_of_directions(normals), thread_count(space.threads)
    limit = chord_of(least)

    def nearest_normal(cells: Cells) -> Array:
        chords = tree.query(cells.rows[:, 3:6], workers=workers)[0]
        if wider is not None:
            wider.append(cells[cells.rows[:, 3:6].any(axis=1) & (chords > limit)])
        return chords

    return _largest(space, len(normals), nearest_normal, least)


def _largest(
    space: Space, samples: int, chords_of: Callable[[Cells], Array], least: float = 0.0
) -> float:
    """Return the largest angle found, in degrees, but at least `least`.

    `chords_of` returns the chord of the angle at the place of each cell.
    """
    even = space.uniform.exact
    begin = found = chord_of(least)
    wanted = max(PLACES * samples, FEWEST)
    first = min(wanted, MOST)
    cells, cuts = even.cut(math.sqrt(even.area / first)), CUTS
    while first < wanted:
        first, cuts = 4 * first, cuts + 1

    def search(cells: Cells, cuts: int) -> None:
        nonlocal found
        chords = np.where(cells.rows[:, 3:6].any(axis=1), chords_of(cells), 0.0)
        found = max(found, float(chords.max(initial=0.0)))
        # For each cell, a bound of the chord from any of its normals to the normal of the sample.
        bounds = chords + cells.chords
        far = np.flatnonzero(bounds > found)
        for start in range(0, len(far) if cuts else 0, BLOCK):
            some = far[start : start + BLOCK]
            search(even.quarters(cells[some[bounds[some] > found]]), cuts - 1)

    search(cells, cuts - 1)
    return least if found == begin else math.degrees(2.0 * math.asin(min(found, 2.0) / 2.0))
