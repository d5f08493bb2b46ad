"""Spreading samples that were added further, at more cost."""

from __future__ import annotations

import math

from .angles import widest_angles
from .cover import FINE, STEP, Cover

__all__ = ["relax"]

# So many of the samples that are added go where normals are farthest from those of all samples.
FOR_NORMALS = 0.1
# The first ones are so many times farther from others than the last ones were.
FARTHEST = 2.0
# With each step, triangles reach so many times less far.
FINER = math.sqrt(0.5)


def relax(cover: Cover, steps: int) -> None:
    """Add the samples again as farthest points, more and more exactly: by 1, 2, 3 … steps.

    A few go to the widest gaps in normal space, all others to those in space. Each step halves the
    distance between the radii of the sweeps, and the size of the triangles in whose middles samples
    are put; without end, every sample came where the widest gap is.
    """
    if steps == 0 or cover.count == cover.given:
        return
    count = cover.count
    widest = FARTHEST * cover.radius
    cover.forget()
    cover.take_candidates(cover.radius, widest, FINE * FINER**steps)
    if cover.given:
        widest_angles(cover, round(FOR_NORMALS * (count - cover.given)))
    cover.narrow(widest, count, STEP**0.5**steps)
