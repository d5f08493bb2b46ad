"""The angle between the normals of a surface and those of its samples, and how to bound it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .cover import Cover

__all__ = ["cover_normals", "largest_angle"]


def cover_normals(cover: Cover, angle: float) -> None:
    """Add samples until the normal in every middle of a triangle is within `angle` degrees of one.

    Where the normals that were asked lie as dense as that, only places at the border of the
    Gaussian image are farther from all of them: their nearest normal may lie outside it.
    """
    from scipy.spatial import KDTree

    rows = cover.middles()
    chords = _chords(cover, rows)
    limit = _chord(angle)
    (far,) = np.nonzero(chords > limit)
    normals = rows[far, 3:6]
    tree, left = KDTree(normals), np.ones(len(far), dtype=bool)
    chosen = []
    for k in np.argsort(-chords[far], kind="stable"):
        if left[k]:
            chosen.append(far[k])
            left[tree.query_ball_point(normals[k], limit)] = False
    cover.add(np.array(chosen, dtype=np.int64), rows)


def largest_angle(cover: Cover) -> float:
    """Return the largest angle, in degrees, that any middle of a triangle makes with all samples."""
    largest = float(_chords(cover, cover.middles()).max(initial=0.0))
    return math.degrees(2.0 * math.asin(min(largest / 2.0, 1.0)))


def _chords(cover: Cover, rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distances of the unit normals in the middles to the nearest ones of samples."""
    from scipy.spatial import KDTree

    return KDTree(cover.points[: cover.count, 3:]).query(rows[:, 3:6], workers=-1)[0]


def _chord(angle: float) -> float:
    return 2.0 * math.sin(math.radians(angle) / 2.0)
