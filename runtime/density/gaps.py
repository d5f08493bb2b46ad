"""How far a surface is from its samples."""

from __future__ import annotations

import math

import numpy as np

from ..threads import thread_count
from ..trees import tree_of
from .cover import Cover
from .pieces import Array, Pieces

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
    tree = tree_of(cover.points[:, :3])

    def look(pieces: Pieces) -> Array:
        points = pieces.middles()[:, :3]
        return tree.query(points, workers=thread_count(cover.wanted.threads))[0]

    pieces = cover.pieces
    bounds = cover.distances + pieces.extents
    loose = float(bounds.max())
    widest = np.argpartition(-bounds, min(FIRST, len(bounds)) - 1)[:FIRST]
    least = float(look(pieces[widest]).max())
    for _ in range(MOST_CUTS):
        far = bounds > TIGHT * least
        if not far.any():
            break
        pieces = pieces[far]
        distances = look(pieces)
        least = max(least, float(distances.max()))
        far = distances + pieces.extents > TIGHT * least
        bounds = np.repeat((distances + pieces.extents)[far], 4)
        pieces = pieces[far].quarters
    tight = max(TIGHT * least, float(bounds.max(initial=0.0)))
    return min(tight, loose) / cover.wanted.unit
