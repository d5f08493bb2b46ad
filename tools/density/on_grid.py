"""Covers that begin with graded grids; the remaining gaps are filled by added samples."""

import math
from collections.abc import Callable
from functools import reduce
from operator import add

from .aligned import AlignedGrid
from .cover import Cover
from .grid import Grid
from .request import Request
from .shares import apportioned
from .space import Space

# The covering radius of n samples without a grid, relative to the sizing function, is estimated as
# WIDEST √(I/n), where I is the integral of the target density.
WIDEST = 1.0
# If no coverage is requested, gaps in flat regions may be wider by this factor than the target
# density prescribes.
WIDER = 2.0
# The angle and distance for the grid are smaller than the requested ones by this part.
MARGIN = 0.02
# The parts of a count that are tried for the grid, until the remaining samples suffice for a
# coverage.
PARTS = (1.0, 0.95, 0.9, 0.8, 0.65, 0.5, 0.3)


def cover_on_grid(
    space: Space, request: Request, distance: float | None, show_count: Callable[[int], object]
) -> Cover:
    """Return a cover that begins with graded grids, for the requested count, angle or coverage.

    `distance` is the requested coverage, scaled as in `Space`.
    """
    if request.count is None:
        return _by_errors(space, request.angle, distance, show_count)
    if distance is None:
        return _by_count(space, request.count, show_count)
    return _by_count_and_distance(space, request.count, distance, show_count)


def _by_count(space: Space, count: int, show_count: Callable[[int], object]) -> Cover:
    """Return a cover with `count` samples."""
    grid = _grid_of(space, count, _usual_distance(space, count))
    # A grid has at least one line in each part of both axes: a small count may not suffice for it.
    cover = Cover(space, None, show_count, grid if len(grid) <= count else None)
    if cover.count < count:  # at the boundary of a trim
        cover.to_count(count)
    return cover


def _by_errors(
    space: Space, angle: float | None, distance: float | None, show_count: Callable[[int], object]
) -> Cover:
    """Return a cover that meets an angle in degrees, or a scaled coverage, or both."""
    rate = math.sqrt(space.smallest)
    if angle is None:
        assert distance is not None
        chord = distance * rate
    else:
        chord = (1.0 - MARGIN) * math.radians(angle)
    apart = WIDER * chord / rate if distance is None else distance
    even = space.uniform
    even.parts(apart)  # or InputError
    grids = (AlignedGrid.of(space, k) for k in range(len(space.pieces)))
    grid = reduce(add, (x.grid(x.steps(chord, (1.0 - MARGIN) * apart), None) for x in grids))
    cover = Cover(even, None, show_count, grid)
    cover.to_radius(apart)
    return cover


def _by_count_and_distance(
    space: Space, count: int, distance: float, show_count: Callable[[int], object]
) -> Cover:
    """Return a cover with `count` samples and a scaled coverage, if `count` samples suffice."""
    apart = min((1.0 - MARGIN) * distance, _usual_distance(space, count))
    even = space.uniform
    for part in PARTS:
        grid = _grid_of(space, round(part * count), apart)
        if len(grid) > count:
            continue  # the count does not suffice for all parts of the axes
        cover = Cover(even, None, show_count, grid)
        cover.to_radius(distance, count + 1)
        if cover.count <= count:
            cover.fill_up(count)
            return cover
    cover = Cover(even, None, show_count)
    cover.to_count(count)
    return cover


def _grid_of(space: Space, count: int, distance: float) -> Grid:
    """Return about the finest grids with at most `count` samples in total, joined to one grid.

    The count is divided among the pieces. There are more samples if one line in each part of both
    axes of a piece already gives more.
    """
    counts = apportioned(count, space.integrals).tolist()
    grids = (AlignedGrid.of(space, k).grid_for(n, distance) for k, n in enumerate(counts) if n)
    return reduce(add, grids)


def _usual_distance(space: Space, count: int) -> float:
    """Return an estimate of the coverage, scaled, of `count` samples without a grid."""
    return WIDEST * math.sqrt(space.integral / count / space.smallest)
