"""Components of the set of points with a given normal, cut by the boundary of a trim.

A component that is a curve or a region is sampled: Gauss–Newton steps lead from the points of a
grid on its box to points with the normal. Each piece consists of points with the normal inside the
trim that are linked by chains of neighbours.
"""

from typing import NamedTuple

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..base.trees import tree_of
from ..domain.domain import brought_inside
from ..domain.trim import Trim
from ..proof.components import Undecided
from ..proof.curves import Jets, are_thin, with_normal
from ..proof.kernels.answers import KINDS
from ..spline.joints import linked

OPEN_BOX, ISOLATED = KINDS.index("open"), KINDS.index("isolated")
# The grid of a thin box is one row of PLACES points; that of other boxes has SIDE points along each
# side.
PLACES, SIDE = 257, 65
# Points count as neighbours if their distance is at most NEIGHBOURS steps of the grid. Points are
# rounded to multiples of 1/HALVES steps, and of points that become equal only one is kept. A piece
# that is shorter than SHORTEST steps is a regular point in the box.
NEIGHBOURS, HALVES, SHORTEST = 1.5, 2.0, 0.25


def components_in(
    trim: Trim | None, open_: Undecided, normals: Array, jets: Jets
) -> tuple[Undecided, Undecided]:
    """Return the known components inside a trim, and the boxes that remain undecided.

    A component counts as known if its kind is known. A component that the boundary of the trim cuts
    gets a row for each of its pieces inside the trim, or an undecided box if no piece is found. The
    pieces of curves with overlapping boxes are found together. `jets` returns the 2-jets of the
    surface at u and v (k,). The normals (S, 3) are unit vectors.
    """
    known = open_.kinds != OPEN_BOX
    if trim is None or len(known) == 0:
        return _rows(open_, known), _rows(open_, ~known)
    sides = trim.sides(open_.boxes, normals[open_.numbers])
    open_ = open_._replace(border=open_.border | (sides == 0))
    found, left, done = list[Undecided](), ~known & (sides >= 0), np.zeros_like(known)
    cut = dict[bytes, Undecided]()  # the pieces of a box and a normal, which queries may repeat
    for k in np.flatnonzero(known & (sides == 0)).tolist():
        if done[k]:
            continue
        one, normal = _rows(open_, [k]), normals[open_.numbers[k]]
        group = np.arange(len(known)) == k
        if one.kinds[0] == ISOLATED:
            pieces = _rows(one, trim.contains(one.uv))
        else:
            group, hull = _overlapping(open_, k)
            one = one._replace(boxes=hull[None])
            key = one.boxes.tobytes() + normal.tobytes()
            if key not in cut:
                cut[key] = _pieces(trim, one, normal, jets)
            pieces = cut[key]._replace(numbers=np.repeat(one.numbers, len(cut[key].numbers)))
        found.append(pieces)
        done |= group
        left |= group & (len(pieces.numbers) == 0)
    found.append(_rows(open_, known & (sides > 0) & ~done))
    whole = Undecided._make(np.concatenate(x) for x in zip(*found, strict=True))
    return _rows(whole, np.argsort(whole.numbers, kind="stable")), _rows(open_, left)


def _rows(open_: Undecided, rows: Indices | Flags | list[int]) -> Undecided:
    return Undecided._make(x[rows] for x in open_)


def _overlapping(open_: Undecided, k: int) -> tuple[Flags, Array]:
    """Return the rows of curves whose boxes overlap that of row k, and the hull (4,) of all.

    They have the same normal. Boxes that overlap the hull count, too.
    """
    low, high = open_.boxes[:, 0::2], open_.boxes[:, 1::2]
    same, chosen = open_.numbers == open_.numbers[k], np.arange(len(low)) == k
    same &= open_.kinds == open_.kinds[k]
    while True:
        first, last = low[chosen].min(axis=0), high[chosen].max(axis=0)
        more = same & ((low <= last) & (high >= first)).all(axis=1)
        if (more == chosen).all():
            return chosen, np.stack([first, last], axis=1).ravel()
        chosen = more


class Grid(NamedTuple):
    """A grid on a box: the parameters `low` + `step` · place, with integer `places` (k, 2).

    The step across a thin box is 0. `periods` (2,) are the periods of places, 0 for none.
    """

    places: Array
    low: Array
    step: Array
    periods: Array


def _pieces(trim: Trim, one: Undecided, normal: Array, jets: Jets) -> Undecided:
    """Return the pieces of a curve or a region that are inside a trim."""
    grid = _grid(trim, one.boxes[0])
    places = grid.low + grid.step * grid.places
    uv = with_normal(places, one.boxes[0].reshape(2, 2).T, normal, jets)
    uv = uv[trim.contains(uv)]
    places = np.divide(uv - grid.low, grid.step, out=np.zeros_like(uv), where=grid.step > 0.0)
    firsts = np.unique(np.round(HALVES * places), axis=0, return_index=True)[1]
    uv, places = uv[firsts], places[firsts]
    links = tree_of(places, grid.periods).query_pairs(NEIGHBOURS, output_type="ndarray")
    count, piece = linked(len(uv), *links.T)
    long = [np.ptp(places[piece == k], axis=0).max() >= SHORTEST for k in range(count)]
    members = [uv[piece == k] for k in np.flatnonzero(long)]
    count = len(members)
    middles = np.array([x[len(x) // 2] for x in members]).reshape(count, 2)
    sides = [(x.min(axis=0) - grid.step, x.max(axis=0) + grid.step) for x in members]
    boxes = np.array(sides).reshape(count, 2, 2).transpose(0, 2, 1).reshape(count, 4)
    inside = brought_inside(middles[:, 0], middles[:, 1], trim.domain, trim.boundary)
    kinds, border = np.repeat(one.kinds, count), np.ones(count, np.bool_)
    numbers, degree = np.repeat(one.numbers, count), np.full(count, np.nan)
    return Undecided(numbers, boxes, kinds, border, degree, np.stack(inside, axis=1))


def _grid(trim: Trim, box: Array) -> Grid:
    """Return the grid of a box; that of a thin box is one row on its middle line."""
    low, high = box.reshape(2, 2).T
    sizes = np.ptp(trim.domain, axis=1)
    (is_thin,) = are_thin(box, sizes)
    around = (high - low >= sizes) & [x[0] == "periodic" for x in trim.boundary]
    counts = np.where(is_thin, 1, PLACES if is_thin.any() else SIDE)
    step = np.where(is_thin, 0.0, (high - low) / np.maximum(counts - ~around, 1))
    places = np.indices(counts.tolist()).reshape(2, -1).T.astype(np.float64)
    return Grid(places, np.where(is_thin, (low + high) / 2.0, low), step, around * counts * 1.0)
