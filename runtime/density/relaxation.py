"""Spreading samples that were added further, at more cost."""

from __future__ import annotations

import numpy as np

from .cover import FINE, STEP, Cover

__all__ = ["relax"]


def relax(cover: Cover, steps: int) -> None:
    """Add the samples again as farthest points, more and more exactly: by 1, 2, 3 … steps.

    Each step halves the distance between the radii of the sweeps and the size of the triangles in
    whose middles samples are put; without end, every sample came where the widest gap is.
    """
    if steps and cover.count > cover.given:
        count, widest = cover.count, cover.widest_gap
        cover.remove(np.arange(cover.given, count))
        cover.narrow(2.0 * widest, count, STEP**0.5**steps, FINE * 0.5**steps, strict=False)
