"""Spreading samples that were added further, at more cost."""

from __future__ import annotations

from .angles import widest_angles
from .cover import FINE, STEP, Cover

__all__ = ["relax"]

# So many of the samples that are added go where normals are farthest from those of all samples.
FOR_NORMALS = 0.1


def relax(cover: Cover, steps: int) -> None:
    """Add the samples again as farthest points, more and more exactly: by 1, 2, 3 … steps.

    A few go to the widest gaps in normal space, all others to those in space. Each step halves the
    distance between the radii of the sweeps, and the size of the triangles in whose middles samples
    are put; without end, every sample came where the widest gap is.
    """
    if steps == 0 or cover.count == cover.given:
        return
    count = cover.count
    cover.forget()
    if cover.given:
        widest_angles(cover, round(FOR_NORMALS * (count - cover.given)))
    cover.narrow(2.0 * cover.radius, count, STEP**0.5**steps, FINE * 0.5**steps)
