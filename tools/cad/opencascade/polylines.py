"""Curves in the parameter plane as polylines that deviate to one side only."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Points and first derivatives (k, 4) of a curve at parameters (k,).
Evaluator = Callable[[Array], Array]

MOST_ROUNDS, MOST_PARTS = 14, 32
# A piece counts as straight if it deviates from its chord by less than this fraction of the
# tolerance.
STRAIGHT = 1e-3
# Tangents at the ends are taken this far inside, relative to the length: an end may be a corner.
INSIDE = 1e-9
# The tangents at both ends of a piece must form angles of less than 60° with its chord.
LEAST_COSINE = 0.5


def one_sided(
    evaluate: Evaluator, first: float, last: float, pieces: int, tolerance: Array, keep_left: bool
) -> Array:
    """Return points (k, 2) of a polyline from one end of a smooth curve to the other.

    On the kept side, left or right in the direction of the parameter, the polyline deviates from
    the curve by at most `tolerance` (2,) in u and v; on the other side by at most 1e-3 of that. It
    follows tangents where the curve is convex towards the kept side, and chords elsewhere. So a
    point inside a polygon of such polylines is inside the curves.
    """
    side = 1.0 if keep_left else -1.0
    scale = np.tile(tolerance, 2)
    margin = INSIDE * (last - first)
    t = np.linspace(first, last, pieces + 1)
    rows = evaluate(t) / scale
    rows[[0, -1], 2:] = evaluate(np.array([first + margin, last - margin]))[:, 2:] / tolerance
    where, found = [t], [rows[:, :2]]
    ends = np.stack([t[:-1], t[1:]])
    left, right = rows[:-1], rows[1:]
    for number in range(MOST_ROUNDS + 1):
        parts, corner, tips = _judged(left, right, side)
        where.append(ends.mean(axis=0)[corner])
        found.append(tips[corner])
        again = parts > 1
        if number == MOST_ROUNDS or not again.any():
            break
        t, inner, first_ones = _divided(ends[:, again], parts[again])
        rows = np.empty((len(t), 4))
        rows[first_ones], rows[first_ones + parts[again]] = left[again], right[again]
        rows[inner] = evaluate(t[inner]) / scale
        where.append(t[inner])
        found.append(rows[inner, :2])
        pairs = np.ones(len(t) - 1, dtype=np.bool_)
        pairs[first_ones[1:] - 1] = False
        ends = np.stack([t[:-1], t[1:]])[:, pairs]
        left, right = rows[:-1][pairs], rows[1:][pairs]
    order = np.argsort(np.concatenate(where), kind="stable")
    return np.concatenate(found)[order] * tolerance


def _divided(
    ends: Array, parts: NDArray[np.int64]
) -> tuple[Array, NDArray[np.bool_], NDArray[np.int64]]:
    """Divide intervals into equal parts.

    Return the ends of all parts in order, a mask of the new ends, and the index of the first end in
    each interval.
    """
    counts = parts + 1
    first_ones = np.cumsum(counts) - counts
    owner = np.repeat(np.arange(len(parts)), counts)
    number = np.arange(len(owner)) - first_ones[owner]
    t = ends[0, owner] + (ends[1] - ends[0])[owner] * (number / parts[owner])
    return t, (number > 0) & (number < parts[owner]), first_ones


def _judged(
    left: Array, right: Array, side: float
) -> tuple[NDArray[np.int64], NDArray[np.bool_], Array]:
    """Return the number of parts for each piece, a mask of the pieces with a corner, and the tips.

    A piece with a corner is replaced by the tangents at its ends, which meet at its tip.
    """
    along, start, end = right[:, :2] - left[:, :2], left[:, 2:], right[:, 2:]
    chord = np.hypot(along[:, 0], along[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        start = start / np.hypot(start[:, 0], start[:, 1])[:, None]
        end = end / np.hypot(end[:, 0], end[:, 1])[:, None]
        # Cross products: the chord length times the sines of its angles to the tangents at its
        # ends.
        rise, fall = _cross(along, start), _cross(along, end)
        ahead = np.minimum((along * start).sum(axis=1), (along * end).sum(axis=1))
        forward = ahead > LEAST_COSINE * chord
        straight = (forward & (np.maximum(np.abs(rise), np.abs(fall)) <= STRAIGHT)) | (chord == 0)
        reach = fall / _cross(start, end)
        convex = forward & ~straight & (rise * fall < 0.0)
        height = np.where(convex, np.abs(reach * rise) / chord, 4.0)
    parts = np.clip(np.ceil(np.sqrt(height)), 1, MOST_PARTS).astype(np.int64)
    parts[straight] = 1
    corner = convex & (parts == 1) & (rise * side > 0.0)
    tips = left[:, :2] + np.where(corner, reach, 0.0)[:, None] * start
    return parts, corner, tips


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
