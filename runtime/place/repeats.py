"""Samples that meet: those of a fold of the spline are one on the surface, which has no fold there.

Of the preimages of one normal on a fold, one is counted with the sign of K and the others cancel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..base.tolerances import MEETING

__all__ = ["kept_once"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def kept_once(
    points: Array,
    gaussian: Array,
    normal_index: Numbers,
    found: Mask,
    contrary: Mask,
    at_pole: Mask,
    cell: float,
) -> Mask:
    """Return which samples (k,) to keep, such that none is repeated.

    Those that were `found` on the surface are repeated where one with the same normal and the same
    sign of K is at the same place. Next to a pole all but the first are left out; elsewhere, only
    together with as many samples of the normal that were led to a place with the `contrary` sign of
    K, so that the sum of the signs does not change.
    """
    kept = np.ones(len(points), dtype=np.bool_)
    suspects = np.flatnonzero(contrary | (at_pole & found))
    if len(suspects) == 0:
        return kept
    flagged = np.zeros(int(normal_index.max()) + 1, dtype=np.bool_)
    flagged[normal_index[suspects]] = True
    rows = np.flatnonzero(flagged[normal_index] & found)
    repeats, firsts = _repeats(rows, points, gaussian > 0.0, normal_index, MEETING * cell)
    next_to_pole = at_pole[repeats] | at_pole[firsts]
    kept[repeats[next_to_pole]] = False
    elsewhere, others = repeats[~next_to_pole], np.flatnonzero(contrary)
    kept[_paired(elsewhere, others, normal_index)] = False
    kept[_paired(others, elsewhere, normal_index)] = False
    return kept


def _repeats(
    rows: Numbers, points: Array, elliptic: Mask, normal_index: Numbers, distance: float
) -> tuple[Numbers, Numbers]:
    """Return the rows that repeat another one, and these."""
    left = rows[np.argsort(normal_index[rows], kind="stable")]
    found: list[tuple[Numbers, Numbers]] = [(left[:0], left[:0])]
    while len(left):
        starts = _starts(normal_index[left])
        first = left[starts]
        away = np.abs(points[left] - points[first]).max(axis=1)
        same = (away <= distance) & (elliptic[left] == elliptic[first])
        again = same & (left != first)
        found.append((left[again], first[again]))
        left = left[~same]
    return np.concatenate([x for x, _ in found]), np.concatenate([x for _, x in found])


def _starts(values: Numbers) -> Numbers:
    """Return for each of the sorted values the place of the first one that is equal."""
    new = np.r_[True, values[1:] != values[:-1]]
    return np.maximum.accumulate(np.where(new, np.arange(len(values)), 0))


def _paired(rows: Numbers, others: Numbers, normal_index: Numbers) -> Numbers:
    """Return rows of each normal: as many as it has among `others`, or all if it has fewer."""
    rows = rows[np.argsort(normal_index[rows], kind="stable")]
    normals = normal_index[rows]
    counts = np.bincount(normal_index[others], minlength=int(normals.max(initial=0)) + 1)
    rank = np.arange(len(rows)) - _starts(normals)
    return rows[rank < counts[normals]]
