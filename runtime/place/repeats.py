"""Samples that meet: those of a fold of the spline are one on the surface, which has no fold there.

Of the preimages of one normal on a fold, one is counted with the sign of K and the others cancel.

A patch has a normal once at most. So of two samples of one normal at one place at least one has
left its patch, and only normals of such samples are looked at.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ..base.tolerances import MEETING
from ..kernels.spline import mark_left
from ..samples.fields import FLAG_NAMES
from ..spline.spline import Spline
from .on_spline import Fields

__all__ = ["kept_once", "left_patch"]

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def kept_once(spline: Spline, arrays: Fields, at_pole: Mask) -> Mask:
    """Return which samples (k,) to keep, such that none on the surface is repeated.

    It is repeated where one with the same normal and the same sign of K is at the same point and
    has the same parameters, modulo periods; next to a pole these do not matter. All but one are
    left out, first those that have left their patch. Elsewhere than next to a pole as many samples
    of the normal that are not on the surface, with the other sign of K, are left out with them: the
    other side of a fold that the surface does not have. So the sum of the signs does not change.
    """
    kept, found, normal_index = np.ones_like(at_pole), arrays[FLAG_NAMES[0]], arrays["normal_index"]
    left = left_patch(spline, arrays)
    suspects = np.flatnonzero(found & (left | at_pole))
    if len(suspects) == 0:
        return kept
    flagged = np.zeros(int(normal_index.max()) + 1, dtype=np.bool_)
    flagged[normal_index[suspects]] = True
    rows = np.flatnonzero(flagged[normal_index])
    rows = rows[np.lexsort((left[rows], normal_index[rows]))]
    meeting = Meeting.of(spline, arrays, at_pole, rows[found[rows]])
    repeats, firsts = meeting.repeats()
    kept[meeting.rows[repeats]] = False
    folded = meeting.rows[repeats[~(meeting.at_pole[repeats] | meeting.at_pole[firsts])]]
    other_side = rows[~found[rows]]
    kept[_paired(other_side, _keys(arrays, other_side) ^ 1, _keys(arrays, folded))] = False
    return kept


def _keys(arrays: Fields, rows: Numbers) -> Numbers:
    """Return numbers that rows share if they have the same normal and the same sign of K."""
    return 2 * arrays["normal_index"][rows] + np.signbit(arrays["gaussian_curvature"][rows])


def left_patch(spline: Spline, arrays: Fields) -> Mask:
    """Return which samples are not in their patches, or so close to the sides that they meet."""
    left = np.empty(len(arrays["uv"]), dtype=np.bool_)
    mark_left(arrays["uv"], arrays["patch_index"], spline.frame, spline.cells[1], MEETING, left)
    return left


@dataclass(frozen=True, eq=False)
class Meeting:
    """Samples that may meet, sorted by normal: their `rows`, and `places` (k, 5) in cells.

    These are points and parameters; `periods` (2,) are those of the parameters.
    """

    rows: Numbers
    normal_index: Numbers
    places: Array
    is_hyperbolic: Mask
    at_pole: Mask
    periods: Array

    @classmethod
    def of(cls, spline: Spline, arrays: Fields, at_pole: Mask, rows: Numbers) -> Self:
        """Choose rows of the arrays of samples."""
        places = arrays["points"][rows] * spline.scale, arrays["uv"][rows] / spline.frame[2:]
        closes = [ends[0] == "periodic" for ends in spline.boundary]
        return cls(
            rows,
            arrays["normal_index"][rows],
            np.hstack(places),
            np.signbit(arrays["gaussian_curvature"][rows]),
            at_pole[rows],
            np.where(closes, spline.cells, np.inf),
        )

    def repeats(self) -> tuple[Numbers, Numbers]:
        """Return which ones repeat another one, and these."""
        left = np.arange(len(self.rows))
        found: list[tuple[Numbers, Numbers]] = [(left[:0], left[:0])]
        while len(left):
            first = left[_starts(self.normal_index[left])]
            same = self._is_same(left, first)
            again = same & (left != first)
            found.append((left[again], first[again]))
            left = left[~same]
        return np.concatenate([x for x, _ in found]), np.concatenate([x for _, x in found])

    def _is_same(self, some: Numbers, others: Numbers) -> Mask:
        away = np.abs(self.places[some] - self.places[others])
        away[:, 3:] = np.minimum(away[:, 3:], np.abs(self.periods - away[:, 3:]))
        away[self.at_pole[some] | self.at_pole[others], 3:] = 0.0
        same_sign = self.is_hyperbolic[some] == self.is_hyperbolic[others]
        return same_sign & (away.max(axis=1) <= MEETING)


def _starts(values: Numbers) -> Numbers:
    """Return for each of the sorted values the place of the first one that is equal."""
    new = np.r_[True, values[1:] != values[:-1]]
    return np.maximum.accumulate(np.where(new, np.arange(len(values)), 0))


def _paired(rows: Numbers, keys: Numbers, others: Numbers) -> Numbers:
    """Return rows with `keys` (k,): of each key as many as it has among others, or all of fewer."""
    if len(rows) == 0 or len(others) == 0:
        return rows[:0]
    order = np.argsort(keys, kind="stable")
    rows, keys = rows[order], keys[order]
    counts = np.bincount(others, minlength=int(keys[-1]) + 1)
    rank = np.arange(len(rows)) - _starts(keys)
    return rows[rank < counts[keys]]
