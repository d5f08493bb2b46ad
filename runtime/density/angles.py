"""The angle between the normals of a surface and those of its samples, and how to bound it."""

from __future__ import annotations

import math

import numpy as np

from ..threads import thread_count
from ..trees import tree_of
from .candidates import Candidates
from .cover import STEP, Cover
from .pieces import Array, Indices, cut_patches

# A normal is near enough if it is nearer by this part of an angle. Triangles are not cut to sides
# that are shorter than DEEPEST of those of a patch: next to singular points normals turn at once.
SMALL, DEEPEST = 0.02, 2.0**-10
# Where normals are far from all others, first come those that are so many times as far as allowed.
FIRST = 2.0
# The gaps between normals are searched from the widest ones to this part of them.
LEAST = 0.1
# Of so many pieces one is looked at.
EACH = 3

__all__ = ["cover_normals", "widest_angles"]


def cover_normals(cover: Cover, angle: float) -> float:
    """Add samples until every normal of the surface is within `angle` degrees of one of theirs.

    Where the normals that were asked lie as dense as that, only places at the border of the
    Gaussian image are farther from all of them: their nearest normal may lie outside it. Returns
    the largest angle of any normal, in degrees: `angle` if there are singular points, next to which
    only normals in the middles of triangles are known.
    """
    limit = 2.0 * math.sin(math.radians(angle) / 2.0)
    near, largest, pieces = (1.0 - SMALL) * limit, 0.0, cut_patches(cover.wanted, math.inf)
    while len(pieces):
        rows = pieces.middles()
        turns = pieces.turns(rows)
        distances = _distances(cover, 0, rows)
        far = distances > near
        if far.any():
            first = cover.count
            cover.add(pieces[far][_spread(rows[far, 3:6], near, cover.wanted.threads)])
            distances[far] = _distances(cover, first, rows[far])
        deepest = np.ptp(pieces.corners[:, :, 0], axis=1) <= DEEPEST
        chords = distances + turns
        far = (chords > limit) & ~deepest
        largest = max(largest, float(chords[~far].max(initial=0.0)))
        pieces = pieces[far].quarters
    return math.degrees(2.0 * math.asin(min(largest, limit) / 2.0))


def _distances(cover: Cover, first: int, rows: Array) -> Array:
    """Return how far normals of rows are from those of the samples from number `first` on.

    That is 0 where there is no normal.
    """
    tree, threads = tree_of(cover.points[first:, 3:]), thread_count(cover.wanted.threads)
    return np.where(rows[:, 3:6].any(axis=1), tree.query(rows[:, 3:6], workers=threads)[0], 0.0)


def _spread(normals: Array, near: float, threads: int | None) -> Indices:
    """Choose some of normals (M, 3), so that all others are as near to one."""
    candidates = Candidates(_in_normal_space(normals, np.zeros(len(normals))), near, threads)
    chosen, radius = np.empty(0, dtype=np.int64), FIRST * near
    while radius > near:
        radius = max(STEP * radius, near)
        chosen = np.append(chosen, candidates.choose(radius, len(normals)))
    return chosen


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
