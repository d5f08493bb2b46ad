"""The angle between the normals of a surface and those of its samples, and how to bound it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..threads import thread_count
from ..trees import tree_of
from .cover import Cover, quarters

# Triangles are cut until normals turn by less than this part of an angle within them.
SMALL = 0.02
# Normals with different signs of K are so far apart: farther than any others.
APART = 2.0

__all__ = ["cover_normals", "widest_angles"]


def cover_normals(cover: Cover, angle: float) -> float:
    """Add samples until every normal of the surface is within `angle` degrees of one of theirs.

    Where the normals that were asked lie as dense as that, only places at the border of the
    Gaussian image are farther from all of them: their nearest normal may lie outside it. Returns
    the largest angle of any normal, in degrees. Within a triangle, normals are taken to turn by no
    more than its extent times the curvature in its middle.
    """
    limit = 2.0 * math.sin(math.radians(angle) / 2.0)
    near = (1.0 - SMALL) * limit
    largest, patches, triangles, rows, distances = _far_normals(cover, limit)
    normals = rows[:, 3:6]
    tree, left = tree_of(normals), np.ones(len(normals), dtype=bool)
    chosen = []
    for k in np.argsort(-distances, kind="stable"):
        if left[k]:
            chosen.append(k)
            left[tree.query_ball_point(normals[k], near)] = False
    if chosen:
        cover.add(patches[chosen], triangles[chosen], rows[chosen])
        again = tree_of(normals[chosen]).query(normals)[0]
        largest = max(largest, float(again.max()) + SMALL * limit)
    return math.degrees(2.0 * math.asin(min(largest, limit) / 2.0))


def _far_normals(
    cover: Cover, limit: float
) -> tuple[float, NDArray[np.int64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Find small triangles with normals that are farther than `limit` from those of all samples.

    Returns how far the normals of all other triangles are at most; and patches, triangles, middles
    and the distances of the normals in the middles.
    """
    tree = tree_of(cover.points[: cover.count, 3:])
    patches, triangles, largest = cover.patches, cover.triangles.copy(), 0.0
    weights = np.maximum(triangles[:, 4], cover.wanted.law.floor)
    triangles[:, 4] = weights
    turns = cover.wanted.reaches[patches] * np.abs(triangles[:, 2]) * np.sqrt(weights)
    found = []
    while len(patches):
        rows = cover.middles_of(patches, triangles)
        distances = tree.query(rows[:, 3:6], workers=thread_count(cover.wanted.threads))[0]
        far = (distances + turns > limit) & rows[:, 3:6].any(axis=1)
        largest = max(largest, float((distances + turns)[~far].max(initial=0.0)))
        small = far & (turns <= SMALL * limit)
        found.append((patches[small], triangles[small], rows[small], distances[small]))
        cut = far & ~small
        patches, triangles, turns = quarters(patches[cut], triangles[cut], turns[cut] / 2.0)
    all_patches, all_triangles, all_rows, chords = (
        np.concatenate(x) for x in zip(*found, strict=True)
    )
    return largest, all_patches, all_triangles, all_rows, chords


def widest_angles(cover: Cover, number: int) -> None:
    """Add samples where normals are farthest from those of all samples with the same sign of K."""
    rows = cover.middles
    places = np.column_stack([rows[:, 3:6], APART * np.sign(rows[:, 6])])
    samples = np.column_stack(
        [cover.points[: cover.count, 3:], APART * np.sign(cover.local[: cover.count, 3])]
    )
    distances, tree = (
        tree_of(samples).query(places, workers=thread_count(cover.wanted.threads))[0],
        tree_of(places),
    )
    chosen = []
    for _ in range(number):
        k = int(distances.argmax())
        near = tree.query_ball_point(places[k], distances[k])
        distances[near] = np.minimum(
            distances[near], np.linalg.norm(places[near] - places[k], axis=1)
        )
        chosen.append(k)
    cover.add(cover.patches[chosen], cover.triangles[chosen], rows[chosen])
