"""The angle between the normals of a surface and those of its samples, and how to bound it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..threads import thread_count
from ..trees import tree_of
from .candidates import Candidates
from .cover import STEP, Cover
from .pieces import Array, Pieces

# Triangles are cut until normals turn by less than this part of an angle within them.
SMALL = 0.02
# The gaps between normals are searched from the widest ones to this part of them.
LEAST = 0.1
# Of so many pieces one is looked at.
EACH = 3

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
    largest, pieces, rows, distances = _far_normals(cover, limit)
    normals = rows[:, 3:6]
    tree, left = tree_of(normals), np.ones(len(normals), dtype=bool)
    chosen = []
    for k in np.argsort(-distances, kind="stable"):
        if left[k]:
            chosen.append(k)
            left[tree.query_ball_point(normals[k], near)] = False
    if chosen:
        cover.add(pieces[np.array(chosen)])
        again = tree_of(normals[chosen]).query(normals)[0]
        largest = max(largest, float(again.max()) + SMALL * limit)
    return math.degrees(2.0 * math.asin(min(largest, limit) / 2.0))


def _far_normals(cover: Cover, limit: float) -> tuple[float, Pieces, Array, Array]:
    """Find small triangles with normals that are farther than `limit` from those of all samples.

    Returns how far the normals of all other triangles are at most; and the small ones, their
    middles and the distances of the normals there.
    """
    # Without a floor, what is wanted is the square of the larger principal curvature.
    bending = cover.wanted.with_floor(0.0)
    tree, pieces, largest = tree_of(cover.points[:, 3:]), replace(cover.pieces, wanted=bending), 0.0
    small, middles, chords = [], [], []
    while len(pieces):
        rows = pieces.middles()
        turns = pieces.extents * np.sqrt(rows[:, 6])
        distances = tree.query(rows[:, 3:6], workers=thread_count(cover.wanted.threads))[0]
        regular = rows[:, 3:6].any(axis=1)
        far = regular & (distances + turns > limit)
        largest = max(largest, float((distances + turns)[regular & ~far].max(initial=0.0)))
        uncut = far & (turns <= SMALL * limit)
        small.append(pieces[uncut])
        middles.append(rows[uncut])
        chords.append(distances[uncut])
        pieces = pieces[far & ~uncut].quarters
    return largest, sum(small[1:], small[0]), np.concatenate(middles), np.concatenate(chords)


def widest_angles(cover: Cover, number: int, widest: float) -> None:
    """Add samples where normals are farthest from those of all samples with the same sign of K.

    Distances are searched from `widest` on. If there is no such place any more, fewer are added.
    """
    pieces = cover.pieces[np.arange(0, len(cover.pieces), EACH)]
    rows = pieces.middles()
    candidates = Candidates(_in_normal_space(rows[:, 3:6], rows[:, 7]), widest)
    candidates.tell(_in_normal_space(cover.points[:, 3:], cover.curvatures)[:, :6], widest)
    chosen, radius = np.empty(0, dtype=np.int64), widest
    while len(chosen) < number and radius > LEAST * widest:
        radius *= STEP
        chosen = np.append(chosen, candidates.choose(radius, number - len(chosen)))
    cover.add(pieces[chosen])


def _in_normal_space(normals: Array, K: Array) -> Array:
    """Return normals as places (M, 8), with the sign of K for a normal: a side of its own."""
    rows = np.zeros((len(normals), 8))
    rows[:, :3], rows[:, 3], rows[:, 6] = normals, np.where(np.signbit(K), -1.0, 1.0), 1.0
    return rows
