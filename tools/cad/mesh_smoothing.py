"""Vertices of thin triangles move inside of their faces, so that the smallest angles grow."""

from __future__ import annotations

import math

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ..meshes.mesh import cosines_of, tangents_of
from ..meshes.triangulated import LARGEST_DEVIATION
from .edges import Places, at_places
from .results import PartSpace

__all__ = ["smoothed"]

# Vertices move if a triangle around them has a smaller angle than this, in degrees; so many times.
SMALL, ROUNDS = 30.0, 6


def smoothed(
    space: PartSpace, pieces: Indices, known: Places, triangles: Indices, points: Array, free: Flags
) -> tuple[Places, Array]:
    """Return places on pieces (C,) whose `free` ones have moved, and their points (C, 3).

    Of the triangles around one that moves the smallest angle grows, and none turns away from the
    normals by more than `LARGEST_DEVIATION` degrees, unless it did before.
    """
    known, points = Places(*(x.copy() for x in known)), points.copy()
    sides = np.ones_like(triangles)
    for _ in range(ROUNDS):
        tangents = tangents_of(points, triangles)
        thin = np.zeros(len(points), dtype=np.bool_)
        thin[triangles[tangents < math.tan(math.radians(SMALL))]] = True
        chosen = np.flatnonzero(thin & free)
        if not len(chosen):
            break
        place = np.full(len(points), -1)
        place[chosen] = np.arange(len(chosen))
        rows, corner = np.nonzero(place[triangles] >= 0)
        around = triangles[rows[:, None], (corner[:, None] + np.arange(3)) % 3]
        owner = place[around[:, 0]]
        moved = _moved(space, pieces, known, points, chosen, around, owner, tangents[rows])
        new_points, new_normals = points[around], known.normals[around]
        new_points[:, 0], new_normals[:, 0] = moved.vectors[owner, 0], moved.normals[owner]
        own = np.arange(3 * len(rows)).reshape(-1, 3)
        after = tangents_of(new_points.reshape(-1, 3), own)
        turned = cosines_of(new_points.reshape(-1, 3), new_normals.reshape(-1, 3), own, sides[rows])
        before = cosines_of(points, known.normals, triangles[rows], sides[rows])
        least = np.minimum(before, math.cos(math.radians(LARGEST_DEVIATION)))
        after[turned < least] = -1.0
        now, then = (_least(x, owner, len(chosen)) for x in (tangents[rows], after))
        better = then > now
        # Of neighbours, that with the smallest angle moves.
        for k in (1, 2):
            other = place[around[:, k]]
            both = (other >= 0) & better[owner] & better[other]
            one, other = owner[both], other[both]
            later = (now[other] < now[one]) | ((now[other] == now[one]) & (other < one))
            better[one[later]] = False
        if not better.any():
            break
        at = chosen[better]
        for mine, new in zip(known, moved, strict=True):
            mine[at] = new[better]
        points[at] = moved.vectors[better, 0]
    return known, points


def _least(values: Array, owner: Indices, count: int) -> Array:
    found = np.full(count, np.inf)
    np.minimum.at(found, owner, values)
    return found


def _moved(
    space: PartSpace, pieces: Indices, known: Places, points: Array, chosen: Indices,
    around: Indices, owner: Indices, tangents: Array,
) -> Places:  # fmt: skip
    """Return where chosen vertices are to go: to the mean of the tips of even triangles.

    These stand on the sides opposite to them; thin triangles count more.
    """
    x, a, b = points[around].transpose(1, 0, 2)
    middle, side = (a + b) / 2.0, b - a
    lengths = np.linalg.norm(side, axis=1, keepdims=True)
    along = side / np.where(lengths > 0.0, lengths, 1.0)
    up = x - middle
    up -= (up * along).sum(axis=1, keepdims=True) * along
    heights = np.linalg.norm(up, axis=1, keepdims=True)
    tips = middle + math.sqrt(0.75) * lengths * up / np.where(heights > 0.0, heights, 1.0)
    weights = 1.0 / np.maximum(tangents, 1e-3) ** 2
    sums = [np.bincount(owner, weights * y, len(chosen)) for y in (tips - x).T]
    step = np.stack(sums, axis=1) / np.bincount(owner, weights, len(chosen))[:, None]
    tangent = known.vectors[chosen, 1:]
    metric = np.einsum("kix,kjx->kij", tangent, tangent)
    product = np.einsum("kix,kx->ki", tangent, step)
    det = metric[:, 0, 0] * metric[:, 1, 1] - metric[:, 0, 1] ** 2
    inverse = np.stack(
        [
            metric[:, 1, 1] * product[:, 0] - metric[:, 0, 1] * product[:, 1],
            metric[:, 0, 0] * product[:, 1] - metric[:, 0, 1] * product[:, 0],
        ],
        axis=1,
    )
    uv = known.uv[chosen] + inverse / np.where(det > 0.0, det, np.inf)[:, None]
    low, high = np.array([p.domain for p in space.pieces])[pieces[chosen]].transpose(2, 0, 1)
    return at_places(space, pieces[chosen], np.clip(uv, low, high))
