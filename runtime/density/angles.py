"""The angle between the normals of a surface and those of its samples, and how to bound it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from .cover import Cover

# Normals with different signs of K are so far apart: farther than any others.
APART = 2.0

__all__ = ["cover_normals", "largest_angle"]


def cover_normals(cover: Cover, angle: float) -> None:
    """Add samples until the normal in every middle of a triangle is within `angle` degrees of one.

    Where the normals that were asked lie as dense as that, only places at the border of the
    Gaussian image are farther from all of them: their nearest normal may lie outside it.
    """
    rows = cover.middles
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


def widest_angles(cover: Cover, number: int) -> None:
    """Add samples where normals are farthest from those of all samples with the same sign of K."""
    rows = cover.middles
    places = np.column_stack([rows[:, 3:6], APART * np.sign(rows[:, 6])])
    samples = np.column_stack(
        [cover.points[: cover.count, 3:], APART * np.sign(cover.local[: cover.count, 3])]
    )
    distances, tree = KDTree(samples).query(places, workers=-1)[0], KDTree(places)
    chosen = []
    for _ in range(number):
        k = int(distances.argmax())
        near = tree.query_ball_point(places[k], distances[k])
        distances[near] = np.minimum(
            distances[near], np.linalg.norm(places[near] - places[k], axis=1)
        )
        chosen.append(k)
    cover.add(np.array(chosen, dtype=np.int64), rows)


def largest_angle(cover: Cover) -> float:
    """Return the largest angle, in degrees, between a normal of the surface and all samples'."""
    largest = float(_chords(cover, cover.middles).max(initial=0.0))
    return math.degrees(2.0 * math.asin(min(largest / 2.0, 1.0)))


def _chords(cover: Cover, rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the distances of the unit normals in the middles to the nearest ones of samples."""
    return KDTree(cover.points[: cover.count, 3:]).query(rows[:, 3:6], workers=-1)[0]


def _chord(angle: float) -> float:
    return 2.0 * math.sin(math.radians(angle) / 2.0)
