"""Which of two covers of a surface is the better one: on a grid, or with round cells."""

from __future__ import annotations

import math

from .aligned import AlignedGrid
from .cover import Cover
from .errors_of import Errors, places_on
from .on_grid import (
    cover_by_count,
    cover_by_count_and_distance,
    cover_by_errors,
    steps_by_errors,
    usual_distance,
)
from .sizing import SizingFunction

__all__ = ["GREEDY", "better_on_grid", "fewer_on_grid"]

# For n samples with round cells that cover the surface within a radius r, relative to the sizing
# function, the integral of the target density is n r² times this.
GREEDY = 1.85
# A grid is not tried unless the angle that it promises is less than this part of the usual one.
PROMISING = 0.95
# It is taken if the angle to the normal of the nearest sample is at most LEAST times the usual one,
# that in normal space MOST times, and gaps MOST_GAP times.
LEAST, MOST, MOST_GAP = 0.9, 1.03, 1.05
# For an angle or a coverage, it is tried if it needs less than this part of the samples.
FEWER = 0.9
# Samples are searched within this multiple of the usual distances first.
WITHIN = 1.5


def usual_angle(sizing: SizingFunction, count: int) -> float:
    """Return the angle (as a length) between normals of places and of the nearest sample.

    That is if `count` samples follow the larger principal curvature, with round cells.
    """
    return math.sqrt(sizing.integral / (GREEDY * count))


def fewer_on_grid(usual: Cover, angle: float | None, distance: float | None) -> Cover | None:
    """Return a cover on a grid for an angle in degrees, a scaled distance or both.

    None if it needs about as many samples as the usual one.
    """
    aligned = AlignedGrid.of(usual.sizing)
    if steps_by_errors(aligned, angle, distance)[0].count > FEWER * usual.count:
        return None
    return cover_by_errors(aligned, angle, distance, usual.show_count)


def better_on_grid(usual: Cover, count: int, distance: float | None) -> Cover | None:
    """Return a cover with a count that begins with a grid, if it is better than the usual one.

    `distance` is the scaled coverage that is asked for.
    """
    sizing = usual.sizing
    angle = WITHIN * usual_angle(sizing, count)
    apart = angle / math.sqrt(max(sizing.target.floor, float(sizing.largest.min())))
    aligned = AlignedGrid.of(sizing)
    if aligned.steps_for(count, usual_distance(sizing, count)).angle > PROMISING * angle / WITHIN:
        return None
    places, rows = places_on(sizing)
    if len(places) == 0:
        return None
    old = Errors(usual, places, rows, apart, angle)
    if distance is None:
        cover = cover_by_count(aligned, count, old.gap, usual.show_count)
    else:
        cover = cover_by_count_and_distance(aligned, count, distance, usual.show_count)
    new = Errors(cover, places, rows, apart, angle)
    return cover if _is_better(new, old) else None


def _is_better(new: Errors, old: Errors) -> bool:
    """Say whether angles in space are clearly smaller, and no other error is larger."""
    return (
        new.in_space <= LEAST * old.in_space
        and new.tangent <= old.tangent
        and new.gap <= MOST_GAP * old.gap
        and new.in_normal <= MOST * old.in_normal
    )
