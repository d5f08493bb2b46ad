"""Covers that begin with a graded grid; what it leaves is filled as usual."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..samples.request import Request
from .aligned import AlignedGrid
from .cover import Cover
from .sizing import SizingFunction, TargetDensity
from .steps import Steps
from .triangles import subdivisions

__all__ = ["cover_on_grid"]

# The largest distance of a point from the nearest sample if round cells follow the curvature: that
# of a sizing function, times this.
WIDEST = 1.0
# Without a coverage, gaps are wider by this factor, where the surface is flat.
WIDER = 2.0
# An angle is asked of the grid that is smaller by this part, and a distance, too.
MARGIN = 0.02
# The parts of a count that a grid is given in turn, until what is left is enough for a coverage.
PARTS = (1.0, 0.95, 0.9, 0.8, 0.65, 0.5, 0.3)


def cover_on_grid(
    sizing: SizingFunction,
    request: Request,
    distance: float | None,
    show_count: Callable[[int], object],
) -> Cover:
    """Return a cover with a count of samples, or for an angle or a coverage.

    `distance` is the scaled coverage that is asked for.
    """
    aligned = AlignedGrid.of(sizing)
    if request.count is None:
        return cover_by_errors(aligned, request.angle, distance, show_count)
    if distance is None:
        return cover_by_count(
            aligned, request.count, usual_distance(sizing, request.count), show_count
        )
    return cover_by_count_and_distance(aligned, request.count, distance, show_count)


def usual_distance(sizing: SizingFunction, count: int) -> float:
    """Return the largest distance of a point from the nearest one of `count` usual samples."""
    density = max(sizing.target.floor, float(sizing.largest.min()))
    return WIDEST * math.sqrt(sizing.integral / count / density)


def cover_by_count(
    aligned: AlignedGrid, count: int, distance: float, show_count: Callable[[int], object]
) -> Cover:
    """Return a cover with a count, whose gaps are about a distance."""
    grid = aligned.grid_for(count, distance)
    # A few samples are too few for all parts of the parameters.
    cover = Cover(aligned.sizing, None, show_count, grid if len(grid) <= count else None)
    if cover.count < count:  # at the border of a trim
        cover.to_count(count)
    return cover


def steps_by_errors(
    aligned: AlignedGrid, angle: float | None, distance: float | None
) -> tuple[Steps, float]:
    """Return the steps for an angle in degrees, or a scaled distance, or both; and the distance.

    Raises InputError if that were too many.
    """
    sizing = aligned.sizing
    rate = math.sqrt(max(sizing.target.floor, float(sizing.largest.min())))
    if angle is None:
        assert distance is not None
        chord = distance * rate
    else:
        chord = (1.0 - MARGIN) * math.radians(angle)
    apart = WIDER * chord / rate if distance is None else distance
    subdivisions(even(sizing), apart)  # or InputError
    return aligned.steps(chord, (1.0 - MARGIN) * apart), apart


def cover_by_errors(
    aligned: AlignedGrid,
    angle: float | None,
    distance: float | None,
    show_count: Callable[[int], object],
) -> Cover:
    """Return a cover for an angle, or a coverage, or both."""
    steps, apart = steps_by_errors(aligned, angle, distance)
    cover = Cover(even(aligned.sizing), None, show_count, aligned.grid(steps, None))
    cover.to_radius(apart)
    return cover


def cover_by_count_and_distance(
    aligned: AlignedGrid, count: int, distance: float, show_count: Callable[[int], object]
) -> Cover:
    """Return a cover with a count; the distance is kept if the count is enough for that."""
    apart = min((1.0 - MARGIN) * distance, usual_distance(aligned.sizing, count))
    for part in PARTS:
        grid = aligned.grid_for(round(part * count), apart)
        if len(grid) > count:
            continue  # a few samples are too few for all parts of the parameters
        cover = Cover(even(aligned.sizing), None, show_count, grid)
        cover.to_radius(distance, count + 1)
        if cover.count <= count:
            cover.fill_up(count)
            return cover
    cover = Cover(even(aligned.sizing), None, show_count)
    cover.to_count(count)
    return cover


def even(sizing: SizingFunction) -> SizingFunction:
    """Return the sizing function 1 on what a sizing function is on."""
    return SizingFunction(sizing.geometry, TargetDensity(floor=1.0))
