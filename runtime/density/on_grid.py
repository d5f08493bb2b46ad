"""Covers that begin with a graded grid; what it leaves is filled as usual."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from .aligned import AlignedGrid
from .cover import Cover
from .request import Request
from .sizing import SizingFunction, TargetDensity
from .triangles import subdivisions

__all__ = ["cover_on_grid"]

# The largest distance of a point from the nearest sample if round cells follow the curvature: that
# of a sizing function, times this.
WIDEST = 1.0
# An angle is asked of the grid that is smaller by this part, and a distance, too.
MARGIN = 0.02
# The parts of a count that a grid is given in turn, until what is left is enough for a coverage.
PARTS = (1.0, 0.95, 0.9, 0.8, 0.65, 0.5, 0.3)
# What a grid leaves of a count is filled among few candidates.
COARSE = 1.5


def cover_on_grid(
    sizing: SizingFunction,
    request: Request,
    distance: float | None,
    show_count: Callable[[int], object],
) -> Cover:
    """Return a cover with a count of samples, or for an angle or a coverage.

    `distance` is the scaled coverage that is asked for.
    """
    if request.count is None:
        return _by_errors(sizing, request, distance, show_count)
    if distance is None:
        return _by_count(sizing, request.count, show_count)
    return _by_count_and_distance(sizing, request.count, distance, show_count)


def usual_distance(sizing: SizingFunction, count: int) -> float:
    """Return the largest distance of a point from the nearest one of `count` usual samples."""
    density = max(sizing.target.floor, float(sizing.largest.min()))
    return WIDEST * math.sqrt(sizing.integral / count / density)


def _by_count(sizing: SizingFunction, count: int, show_count: Callable[[int], object]) -> Cover:
    aligned = AlignedGrid.of(sizing)
    grid = aligned.grid_for(count, usual_distance(sizing, count))
    cover = Cover(sizing, None, show_count, grid)
    cover.fine = COARSE
    cover.to_count(count)
    return cover


def _by_errors(
    sizing: SizingFunction,
    request: Request,
    distance: float | None,
    show_count: Callable[[int], object],
) -> Cover:
    """Return a cover for an angle, or a coverage, or both."""
    floor = max(sizing.target.floor, float(sizing.largest.min()))
    if request.angle is None:
        assert distance is not None
        angle = distance * math.sqrt(floor)
    else:
        angle = (1.0 - MARGIN) * math.radians(request.angle)
    apart = distance if distance is not None else angle / math.sqrt(floor)
    subdivisions(sizing.with_floor(floor), apart * math.sqrt(floor))  # or InputError
    aligned = AlignedGrid.of(sizing)
    grid = aligned.grid(aligned.steps(angle, (1.0 - MARGIN) * apart), None)
    cover = Cover(_even(sizing), None, show_count, grid)
    cover.to_radius(apart)
    return cover


def _by_count_and_distance(
    sizing: SizingFunction, count: int, distance: float, show_count: Callable[[int], object]
) -> Cover:
    """Return a cover with a count; the distance is kept if the count is enough for that."""
    aligned, even = AlignedGrid.of(sizing), _even(sizing)
    apart = min((1.0 - MARGIN) * distance, usual_distance(sizing, count))
    for part in PARTS:
        grid = aligned.grid_for(round(part * count), apart)
        cover = Cover(even, None, show_count, grid)
        cover.to_radius(distance, count + 1)
        if cover.count <= count:
            cover.fill_up(count)
            return cover
    cover = Cover(even, None, show_count)
    cover.to_count(count)
    return cover


def _even(sizing: SizingFunction) -> SizingFunction:
    """Return the sizing function 1."""
    return replace(sizing, target=TargetDensity(floor=1.0))
