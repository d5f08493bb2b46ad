"""Repeated samples: samples at a fold of the spline that become the same point of the surface.

At a fold of its Gaussian image, the spline has several points with the same normal where the
surface may have only one. The signs of K of these points cancel in pairs, except for one point.

A patch has at most one point with a given normal. If two samples with the same normal coincide
after they were moved, at least one of them has therefore left its patch. Only normals with such
samples are examined.
"""

import numpy as np

from ..base.aliases import Flags, Indices
from ..base.tolerances import MEETING
from ..samples.fields import FLAG_NAMES
from ..spline.kernels.spline import mark_left
from ..spline.spline import Spline
from .on_spline import Fields


def kept_once(spline: Spline, arrays: Fields, at_pole: Flags) -> Flags:
    """Return a mask (k,) of the samples to keep, so that none on the surface is repeated.

    Samples are repeated if they have the same normal, sign of K and point, and the same parameters
    modulo periods; next to a pole, parameters are ignored. Of repeated samples one is kept, if
    possible one that is in its patch. Each time that a sample away from poles is removed, a second
    sample is removed: one that was not moved, with the same normal and the other sign of K. It is
    on the other side of a fold that the surface does not have. So the sum of the signs of K at the
    samples of a normal does not change.
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
    repeats, firsts = _repeats(spline, arrays, at_pole, rows[found[rows]])
    kept[repeats] = False
    folded = repeats[~(at_pole[repeats] | at_pole[firsts])]
    other_side = rows[~found[rows]]
    kept[_paired(other_side, _keys(arrays, other_side) ^ 1, _keys(arrays, folded))] = False
    return kept


def _keys(arrays: Fields, rows: Indices) -> Indices:
    """Return a key for each row: equal if and only if normal and sign of K are the same."""
    return 2 * arrays["normal_index"][rows] + np.signbit(arrays["gaussian_curvature"][rows])


def left_patch(spline: Spline, arrays: Fields) -> Flags:
    """Return a mask of the samples outside their patch, or within MEETING of one of its sides."""
    left = np.empty(len(arrays["uv"]), dtype=np.bool_)
    mark_left(arrays["uv"], arrays["patch_index"], spline.frame, spline.cells[1], MEETING, left)
    return left


def _repeats(
    spline: Spline, arrays: Fields, at_pole: Flags, rows: Indices
) -> tuple[Indices, Indices]:
    """Return the rows that repeat an earlier row with the same normal, and these earlier rows.

    The rows are sorted by normal. A row is repeated if its point, its parameters (in cells) and its
    sign of K agree with those of the other row; next to poles, parameters are ignored.
    """
    points, uv = arrays["points"][rows] * spline.scale, arrays["uv"][rows] / spline.frame[2:]
    places, normals = np.hstack([points, uv]), arrays["normal_index"][rows]
    is_hyperbolic, poles = np.signbit(arrays["gaussian_curvature"][rows]), at_pole[rows]
    periods = np.where([ends[0] == "periodic" for ends in spline.boundary], spline.cells, np.inf)
    left = np.arange(len(rows))
    found: list[tuple[Indices, Indices]] = [(rows[:0], rows[:0])]
    while len(left):
        first = left[_starts(normals[left])]
        away = np.abs(places[left] - places[first])
        away[:, 3:] = np.minimum(away[:, 3:], np.abs(periods - away[:, 3:]))
        away[poles[left] | poles[first], 3:] = 0.0
        same = (is_hyperbolic[left] == is_hyperbolic[first]) & (away.max(axis=1) <= MEETING)
        again = same & (left != first)
        found.append((rows[left[again]], rows[first[again]]))
        left = left[~same]
    return np.concatenate([x for x, _ in found]), np.concatenate([x for _, x in found])


def _starts(values: Indices) -> Indices:
    """Return, for each of the sorted values, the index of the first value equal to it."""
    new = np.r_[True, values[1:] != values[:-1]]
    return np.maximum.accumulate(np.where(new, np.arange(len(values)), 0))


def _paired(rows: Indices, keys: Indices, others: Indices) -> Indices:
    """Return, for each key, as many rows with this key as there are entries of the key in `others`.

    `keys` are those of `rows`. If fewer rows have the key, all of these rows are returned.
    """
    if len(rows) == 0 or len(others) == 0:
        return rows[:0]
    order = np.argsort(keys, kind="stable")
    rows, keys = rows[order], keys[order]
    counts = np.bincount(others, minlength=int(keys[-1]) + 1)
    rank = np.arange(len(rows)) - _starts(keys)
    return rows[rank < counts[keys]]
