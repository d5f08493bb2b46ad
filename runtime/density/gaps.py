"""How far a surface is from its samples."""

from __future__ import annotations

import math

import numpy as np

from ..threads import thread_count
from ..trees import tree_of
from .cover import Array, Cover, Indices, quarters

__all__ = ["coverage"]

# The coverage is known when no place can be farther than this times what was found.
TIGHT = 1.1
# So many triangles are looked at first, and so often a triangle is cut.
FIRST, MOST_CUTS = 1024, 40


def coverage(cover: Cover) -> float:
    """Return how far a place of the surface can be from the nearest sample, at most.

    Triangles that may hold a place that is farther than the middles of others are cut, until none
    does. It is a length of the surface; infinite if there is no sample.
    """
    if cover.count == 0:
        return math.inf
    tree = tree_of(cover.points[: cover.count, :3])

    def look(patches: Indices, triangles: Array) -> Array:
        return tree.query(
            cover.middles_of(patches, triangles)[:, :3], workers=thread_count(cover.wanted.threads)
        )[0]

    patches, triangles = cover.patches, cover.triangles
    extents = cover.wanted.reaches[patches] * np.abs(triangles[:, 2])
    bounds = triangles[:, 3] + extents
    loose = float(bounds.max())
    first = np.argpartition(-bounds, min(FIRST, len(bounds)) - 1)[:FIRST]
    least = float(look(patches[first], triangles[first]).max())
    for _ in range(MOST_CUTS):
        far = bounds > TIGHT * least
        if not far.any():
            break
        patches, triangles, extents = patches[far], triangles[far], extents[far]
        distances = look(patches, triangles)
        least = max(least, float(distances.max()))
        far = distances + extents > TIGHT * least
        patches, triangles, extents, distances = quarters(
            patches[far], triangles[far], extents[far] / 2.0, distances[far]
        )
        bounds = distances + 2.0 * extents
    tight = max(TIGHT * least, float(bounds.max(initial=0.0)))
    return min(tight, loose) / cover.wanted.unit
