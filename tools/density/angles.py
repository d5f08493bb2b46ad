"""Covering in normal space: every normal is within an angle of the normal of a sample."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.threads import thread_count
from ...runtime.base.trees import tree_of, tree_of_directions
from .candidates import Candidates
from .cover import STEP, Cover

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# Each candidate has a normal within 1 − MARGIN times the requested angle of the normal of a sample.
# The rest of the angle is left for points between candidates: along boundaries, the normal turns by
# MARGIN times the angle from a candidate to the point halfway to the next one.
MARGIN = 0.02
# The greedy choice of normals begins with gaps whose radius is this multiple of the requested one.
FIRST = 2.0


def chord_of(angle: float) -> float:
    """Return the chord of an angle in degrees: the distance of unit vectors at this angle."""
    return 2.0 * math.sin(math.radians(angle) / 2.0)


def cover_normals(cover: Cover, angle: float) -> float:
    """Add samples until all normals of the surface are near normals of samples.

    At the end, each normal of the surface is within `angle` degrees of the normal of a sample.

    If the prescribed normals are dense enough for the angle, normals are uncovered only at the
    boundary of the Gaussian image, where the nearest prescribed normal may lie outside of the
    image.

    Return a bound, in degrees, of the angle from any normal of the surface to the nearest normal of
    a sample. The bound is `angle` if there are singular points: next to these, normals are known
    only at the places of cells.
    """
    limit = chord_of(angle)
    cover.evaluate_exactly()
    near, largest, cells = (1.0 - MARGIN) * limit, 0.0, cover.whole(2.0 * MARGIN * limit)
    first, threads = cover.count, cover.space.threads
    trees = [tree_of_directions(cover.points[:, 3:])]
    while len(cells):
        distances = _distances(trees, cells.rows, threads)
        far = distances > near
        if far.any():
            chosen = choose_apart(cells.rows[far, 3:6], near, threads)
            cover.add(cells[np.flatnonzero(far)[chosen]])
            trees[1:] = [tree_of_directions(cover.points[first:, 3:])]
            distances[far] = _distances(trees[1:], cells.rows[far], threads)
        chords = distances + cells.chords
        far = (chords > limit) & ~cover.space.deepest(cells)
        largest = max(largest, float(chords[~far].max(initial=0.0)))
        cells = cover.space.quarters(cells[far])
    return angle if largest >= limit else math.degrees(2.0 * math.asin(largest / 2.0))


def _distances(trees: Sequence[KDTree], rows: Array, threads: int | None) -> Array:
    """Return the chord (M,) from the normal of each row to the nearest normal in the trees.

    The chord is 0 for a row without a normal.
    """
    workers = thread_count(threads)
    chords = [x.query(rows[:, 3:6], workers=workers)[0] for x in trees]
    return np.where(rows[:, 3:6].any(axis=1), np.min(chords, axis=0), 0.0)


def choose_apart(
    normals: Array,
    near: float,
    threads: int | None,
    widest: float | None = None,
    most: int | None = None,
    known: Array | None = None,
) -> Indices:
    """Choose some of the normals (M, 3): all are within the chord `near` of a chosen normal.

    Return the indices of at most `most` chosen normals. The widest gaps are filled first: the
    radius of the choice falls from `widest` to `near`. The normals `known` (N, 3) count as chosen;
    no two of them may be nearly equal.
    """
    rows, radius = np.arange(len(normals)), widest or FIRST * near
    if known is not None:
        rows, radius = _apart(normals, known, near, radius, threads)
    room = len(rows) if most is None else most
    candidates = Candidates(_in_normal_space(normals[rows]), radius, threads)
    if known is not None:
        candidates.update_distances(_in_normal_space(known)[:, :6], radius)
    chosen = np.empty(0, dtype=np.int64)
    while radius > near and len(chosen) < room:
        radius = max(STEP * radius, near)
        chosen = np.append(chosen, candidates.choose(radius, room - len(chosen)))
    return rows[chosen]


def _apart(
    normals: Array, known: Array, near: float, widest: float, threads: int | None
) -> tuple[Indices, float]:
    """Return the indices of normals farther than `near` from known normals, and the first radius.

    The first radius of the choice is at most `widest`. If possible, it is only slightly larger than
    the distance of any normal from the nearest known normal: the smaller this radius, the fewer
    distances are updated.
    """
    distances = tree_of(known).query(normals, workers=thread_count(threads))[0]
    far = (distances > near) & normals.any(axis=1)
    return np.flatnonzero(far), min(widest, float(distances[far].max(initial=near)) / STEP)


def _in_normal_space(normals: Array) -> Array:
    """Return candidates (M, 8) in normal space: their points are the unit vectors `normals`.

    All candidates have the same normal, so that they are on the same side, and the same density.
    """
    rows = np.zeros((len(normals), 8))
    rows[:, :3], rows[:, 3], rows[:, 6] = normals, 1.0, 1.0
    return rows
