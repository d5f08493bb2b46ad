"""Spreading the added samples more evenly than by adding one after another."""

from __future__ import annotations

import numpy as np

from .angles import fill_widest_angles
from .cover import Cover

__all__ = ["relax", "spread"]

# This part of the added samples fills the gaps that are widest when the others have moved. With
# half of it, samples in a row leave wider gaps than without moving.
REST = 0.2
# Beside samples at prescribed normals, with a count and more than one step, this part goes where
# normals are farthest from those of all samples.
FOR_NORMALS = 0.1
# Gaps are at most this much wider than the radius while samples are missing.
WIDEST = 2.0


def spread(cover: Cover, count: int, steps: int) -> None:
    """Add samples until there are `count`; most of them are moved, `steps` times and once more.

    A step moves each sample towards the centre of the smallest ball around its Voronoi cell:
    Lloyd's method for a high power of the distance instead of the mean of the squares.
    """
    added = count - cover.count
    for_normals = round(FOR_NORMALS * added) if cover.given and steps > 0 else 0
    cover.to_count(count - round(REST * added) - for_normals)
    if cover.count > cover.fixed:
        widest = WIDEST * cover.radius
        cover.renew_distances(widest)
        voronoi = cover.move_to_centres()
        for _ in range(steps):
            cover.renew_distances(widest)
            voronoi = cover.move_to_centres()
        if for_normals:
            fill_widest_angles(cover, for_normals, widest)
        cover.fill_gaps(voronoi, widest, count)
    cover.count_asked = count


def relax(cover: Cover, steps: int) -> None:
    """Remove the samples that were added last, move the others, and cover the surface again.

    What was asked is kept; if that is a radius, there may be fewer samples than before.
    """
    added, widest = cover.count - cover.fixed, WIDEST * cover.radius
    cover.keep(np.arange(len(cover.added) - round(REST * added)))
    for _ in range(steps):
        cover.renew_distances(widest)
        cover.move_to_centres()
    cover.renew_distances(widest)
    cover.to_what_was_asked(widest)
