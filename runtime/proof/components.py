"""Components, other than regular points, of the set of points with a given normal: a box for each.

Boxes that bisection leaves undecided are joined where they touch. If the index of a box is not 0,
the box contains a point. The index is the winding number of the gradient of the height n·x along a
path around the box, minus the indices of the regular points inside the path. Boxes along curves
are marked by the search itself.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Indices
from .kernels.answers import CURVE, ISOLATED, OPEN_BOX, WHERE, Answers, Sorted
from .kernels.degree import LARGEST
from .kernels.places import NEAR


class Undecided(NamedTuple):
    """Boxes of parameters that contain points other than regular ones, or may contain points.

    Each of the k boxes has the index of its normal in `numbers`; u₀, u₁, v₀, v₁ in `boxes`; a
    position in `KINDS` in `kinds`; whether it touches an open side of the domain in `border`; and
    the parameters of a point in `uv` (k, 2). `degree` is the degree of the Gauss map on the box:
    the sum of sign K over the points with a nearby generic normal, or NaN if unknown.
    """

    numbers: Indices
    boxes: Array
    kinds: Indices
    border: NDArray[np.bool_]
    degree: Array
    uv: Array


NO_NUMBERS, NO_FLAGS = np.empty(0, np.int64), np.empty(0, np.bool_)
NOTHING = Undecided(
    NO_NUMBERS, np.empty((0, 4)), NO_NUMBERS, NO_FLAGS, np.empty(0), np.empty((0, 2))
)


def boxes_of(answers: Sequence[Answers]) -> Undecided:
    """Return the undecided boxes of answers, sorted by normal; their degrees are NaN."""
    answers = [x for x in answers if len(x.open_numbers) > 0]
    if not answers:
        return NOTHING
    numbers, rows, kinds = (
        np.concatenate(x)
        for x in zip(*((y.open_numbers, y.open_boxes, y.kinds) for y in answers), strict=True)
    )
    order = np.lexsort((rows[:, 2], rows[:, 0], numbers))
    rows, degree = rows[order], np.full(len(order), np.nan)
    boxes, uv = rows[:, :4].copy(), rows[:, WHERE:].copy()
    return Undecided(numbers[order], boxes, kinds[order], rows[:, 4] > 0.0, degree, uv)


def components_of(open_: Undecided, domain: Array) -> Undecided:
    """Return the boxes, after joining touching boxes of the same normal.

    Two boxes count as touching if their distance is at most NEAR times the domain, or at most the
    width of one of them; widths of large curves do not count. `domain` (6,) is u₀, u₁, v₀, v₁, and
    the periods of u and v or 0.
    """
    keep = np.ones(len(open_.numbers), np.bool_)
    _, starts, counts = np.unique(open_.numbers, return_index=True, return_counts=True)
    for first, count in zip(starts[counts > 1].tolist(), counts[counts > 1].tolist(), strict=True):
        some = slice(first, first + count)
        _join(Undecided._make(x[some] for x in open_), keep[some], domain)
    open_, low, high = Undecided._make(x[keep] for x in open_), domain[0:4:2], domain[1:4:2]
    boxes = open_.boxes
    around = boxes[:, 1::2] - boxes[:, 0::2] >= (1.0 - NEAR) * (high - low)
    around &= domain[4:] > 0.0
    boxes[:, 0::2] = np.where(around, low, boxes[:, 0::2])
    boxes[:, 1::2] = np.where(around, high, boxes[:, 1::2])
    return open_


def _join(open_: Undecided, keep: NDArray[np.bool_], domain: Array) -> None:
    """Join touching boxes of one normal, in place: each component becomes its first box.

    It is a curve if all boxes are, except for boxes that are at most NEAR times the domain wide.
    `keep` is set to False for the other boxes.
    """
    k, size, periods = 0, domain[1:4:2] - domain[0:4:2], domain[4:]
    rows, kinds, border = open_.boxes, open_.kinds, open_.border
    while k < len(rows):
        low, high = rows[:, 0::2], rows[:, 1::2]
        shift = shift_to(0.5 * (low + high), 0.5 * (low[k] + high[k]), periods)
        low, high, width = low + shift, high + shift, high - low
        on_curve, is_open = kinds == CURVE, (kinds != CURVE) & (width > NEAR * size).any(axis=1)
        width[on_curve & (width > LARGEST * size).any(axis=1)] = 0.0
        near = np.maximum(np.maximum(width, width[k]), NEAR * size)
        touch = np.all((low <= high[k] + near) & (high >= low[k] - near), axis=1)
        # Boxes beside a curve may count as boxes on it: then Gauss–Newton steps lead to its box.
        at = np.all((low <= open_.uv[k]) & (high >= open_.uv[k]), axis=1)
        touch = keep & (touch | (on_curve & on_curve[k] & at))
        touch[k] = False
        if not keep[k] or not touch.any():
            k += 1
            continue
        touch[k] = True
        rows[k, 0::2], rows[k, 1::2] = low[touch].min(axis=0), high[touch].max(axis=0)
        border[k] = border[touch].any()
        kinds[k] = OPEN_BOX
        if on_curve[touch].any() and not is_open[touch].any():
            kinds[k], open_.uv[k] = CURVE, open_.uv[touch & on_curve][0]
        touch[k] = False
        keep[touch] = False
        k = 0


def shift_to(x: Array, towards: Array, periods: Array) -> Array:
    """Return the multiples of the periods by which points x (k, 2) come nearest to `towards`."""
    return periods * np.rint((towards - x) / np.where(periods > 0.0, periods, 1.0))


def with_kinds(open_: Undecided, around: Array, places: Sorted, domain: Array) -> Undecided:
    """Return the components with their degrees and kinds, and with a point of each in the domain.

    `around` (k, 5) has the winding number around each component, and the box of the path;
    `places` are the regular points.
    """
    degree = around[:, 0].copy()
    for k in np.flatnonzero(np.isfinite(degree)).tolist():
        some = slice(*np.searchsorted(open_.numbers, [open_.numbers[k], open_.numbers[k] + 1]))
        degree[k] -= _others(open_.numbers[k], around[k, 1:], open_.boxes[some], places, domain[4:])
    sizes = (open_.boxes[:, 1::2] - open_.boxes[:, 0::2]) / (domain[1:4:2] - domain[0:4:2])
    small = np.where(np.nan_to_num(degree) != 0.0, ISOLATED, OPEN_BOX)
    kinds = np.where(sizes.max(axis=1, initial=0.0) <= LARGEST, small, open_.kinds)
    low, high = domain[0:4:2], domain[1:4:2]
    middles = 0.5 * (open_.boxes[:, 0::2] + open_.boxes[:, 1::2])
    uv = np.where(kinds[:, None] == CURVE, open_.uv, middles)
    turned = uv - domain[4:] * np.floor((uv - low) / (high - low))
    uv = np.where(domain[4:] > 0.0, turned, np.clip(uv, low, high))
    return open_._replace(degree=degree, kinds=kinds, uv=uv)


def _others(number: int, path: Array, boxes: Array, places: Sorted, periods: Array) -> float:
    """Return the sum of the indices of the regular points inside a path around a component.

    These points have the normal with the index `number`, and lie in the box `path` (4,). The sum is
    NaN if this box meets more than one of the boxes (k, 4) of components.
    """
    low, high = path[0::2], path[1::2]

    def meet(first: Array, last: Array) -> NDArray[np.bool_]:
        shift = shift_to(0.5 * (first + last), 0.5 * (low + high), periods)
        return np.all((first + shift <= high) & (last + shift >= low), axis=1)

    if meet(boxes[:, 0::2], boxes[:, 1::2]).sum() > 1:
        return np.nan
    start, end = np.searchsorted(places.numbers, [number, number + 1]).tolist()
    found = places.places[start:end]
    mine = meet(found[:, :2] - found[:, 2:4], found[:, :2] + found[:, 2:4])
    return float(np.sign(found[mine][:, 4]).sum())
