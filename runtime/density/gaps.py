"""How far a surface is from its samples."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial import KDTree

from ...generated import cover as kernels
from .cover import Array, Cover, Indices

__all__ = ["coverage"]

# The coverage is known when no place can be farther than this times what was found.
TIGHT = 1.05
# So many triangles are looked at first, and so often a triangle is cut.
FIRST, MOST_CUTS = 1024, 40


def coverage(cover: Cover) -> float:
    """Return how far a place of the surface can be from the nearest sample, at most.

    Triangles that may hold a place that is farther than the middles of others are cut, until none
    does. It is a length of the surface; infinite if there is no sample.
    """
    if cover.count == 0:
        return math.inf
    tree = KDTree(cover.points[: cover.count, :3])

    def look(patches: Indices, triangles: Array) -> Array:
        return tree.query(cover.middles_of(patches, triangles)[:, :3], workers=-1)[0]

    patches, triangles = cover.patches, cover.triangles
    extents = cover.wanted.reaches[patches] * np.abs(triangles[:, 2])
    bounds = triangles[:, 3] + extents
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
        patches, triangles = _quarters(patches[far], triangles[far])
        extents, distances = (_of_quarters(x[far]) for x in (extents / 2.0, distances))
        bounds = distances + 2.0 * extents
    return max(TIGHT * least, float(bounds.max(initial=0.0))) / cover.wanted.unit


def _quarters(patches: Indices, triangles: Array) -> tuple[Indices, Array]:
    """Return the quarters of triangles: those in their middles, then three of each."""
    room = np.tile(patches, 4), np.tile(triangles, (4, 1))
    kernels.quarter_triangles(*room, len(patches))
    return room


def _of_quarters(values: Array) -> Array:
    """Return for all quarters what is known of whole triangles."""
    return np.concatenate([values, np.repeat(values, 3)])
