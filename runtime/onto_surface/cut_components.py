"""Components of the set of points with a given normal, cut by the boundary of a trim.

A component that is a curve or a region is sampled: Gauss–Newton steps lead from the points of a
grid on its box to points with the normal. Each piece consists of points with the normal inside the
trim that are linked by chains of neighbours.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..base.trees import tree_of
from ..domain.domain import brought_inside
from ..domain.trim import Trim
from ..proof.index import Undecided
from ..proof.kernels.answers import KINDS
from ..spline.joints import linked

Jets = Callable[[Array, Array], Array]

OPEN_BOX, ISOLATED = KINDS.index("open"), KINDS.index("isolated")
# A box counts as thin if its width is at most THIN times its length, both relative to the domain.
# Its grid is one row of PLACES points; that of other boxes has SIDE points along each side.
PLACES, SIDE, THIN = 257, 65, 1e-3
# Points count as neighbours if their distance is at most NEIGHBOURS steps of the grid. Points are
# rounded to multiples of 1/HALVES steps, and of points that become equal only one is kept.
NEIGHBOURS, HALVES = 1.5, 2.0
# From each grid point there are at most STEPS Gauss–Newton steps. They end when the angles between
# the normal and the tangents differ from 90° by at most SETTLED; points at which these angles still
# differ by more than NEAR are left out. An eigenvalue of the Hessian counts as 0 if it is less than
# SINGULAR times the other one.
STEPS, SETTLED, NEAR, SINGULAR = 16, 1e-14, 1e-9, 1e-4


def components_in(
    trim: Trim | None, open_: Undecided, normals: Array, jets: Jets
) -> tuple[Undecided, Undecided]:
    """Return the known components inside a trim, and the boxes that remain undecided.

    A component counts as known if its kind is known. A component that the boundary of the trim cuts
    gets a row for each of its pieces inside the trim, or an undecided box if no piece is found.
    `jets` returns the 2-jets of the surface at u and v (k,). The normals (S, 3) are unit vectors.
    """
    known = open_.kinds != OPEN_BOX
    if trim is None or len(known) == 0:
        return _rows(open_, known), _rows(open_, ~known)
    sides = trim.sides(open_.boxes, normals[open_.numbers])
    open_ = open_._replace(border=open_.border | (sides == 0))
    found, left = [_rows(open_, known & (sides > 0))], ~known & (sides >= 0)
    cut = dict[bytes, Undecided]()  # the pieces of a box and a normal, which queries may repeat
    for k in np.flatnonzero(known & (sides == 0)).tolist():
        one, normal = _rows(open_, [k]), normals[open_.numbers[k]]
        if one.kinds[0] == ISOLATED:
            pieces = _rows(one, trim.contains(one.uv))
        else:
            key = one.boxes.tobytes() + normal.tobytes()
            if key not in cut:
                cut[key] = _pieces(trim, one, normal, jets)
            pieces = cut[key]._replace(numbers=np.repeat(one.numbers, len(cut[key].numbers)))
        found.append(pieces)
        left[k] = len(pieces.numbers) == 0
    whole = Undecided._make(np.concatenate(x) for x in zip(*found, strict=True))
    return _rows(whole, np.argsort(whole.numbers, kind="stable")), _rows(open_, left)


def _rows(open_: Undecided, rows: Indices | Flags | list[int]) -> Undecided:
    return Undecided._make(x[rows] for x in open_)


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
    uv = _with_normal(grid, one.boxes[0].reshape(2, 2).T, normal, jets)
    uv = uv[trim.contains(uv)]
    places = np.divide(uv - grid.low, grid.step, out=np.zeros_like(uv), where=grid.step > 0.0)
    firsts = np.unique(np.round(HALVES * places), axis=0, return_index=True)[1]
    uv, places = uv[firsts], places[firsts]
    links = tree_of(places, grid.periods).query_pairs(NEIGHBOURS, output_type="ndarray")
    count, piece = linked(len(uv), *links.T)
    members = [uv[piece == k] for k in range(count)]
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
    shares = (high - low) / np.ptp(trim.domain, axis=1)
    is_thin = shares <= THIN * shares.max()
    around = (shares >= 1.0) & [x[0] == "periodic" for x in trim.boundary]
    counts = np.where(is_thin, 1, PLACES if is_thin.any() else SIDE)
    step = np.where(is_thin, 0.0, (high - low) / np.maximum(counts - ~around, 1))
    places = np.indices(counts.tolist()).reshape(2, -1).T.astype(np.float64)
    return Grid(places, np.where(is_thin, (low + high) / 2.0, low), step, around * counts * 1.0)


def _with_normal(grid: Grid, ends: Array, normal: Array, jets: Jets) -> Array:
    """Return the parameters (k, 2) of points in a box that have `normal`.

    Gauss–Newton steps lead to them from the points of a grid. `ends` (2, 2) are the lowest u and v
    of the box, and the highest ones.
    """
    uv, scale = grid.low + grid.step * grid.places, np.ptp(ends, axis=0)
    for _ in range(STEPS):
        jet = jets(*uv.T.copy())
        slopes, lengths = jet[:, 1:3] @ normal, np.linalg.norm(jet[:, 1:3], axis=2)
        away = (np.abs(slopes) > SETTLED * lengths).any(axis=1)
        if not away.any():
            break
        second = (jet[away, 3:] @ normal)[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
        inverse = np.linalg.pinv(second * np.outer(scale, scale), rcond=SINGULAR, hermitian=True)
        step = scale * np.einsum("kij,kj->ki", inverse, slopes[away] * scale)
        uv[away] = np.clip(uv[away] - step, *ends)
    jet = jets(*uv.T.copy())
    slopes, lengths = jet[:, 1:3] @ normal, np.linalg.norm(jet[:, 1:3], axis=2)
    settled = (np.abs(slopes) <= NEAR * lengths).all(axis=1)
    return uv[settled & (np.cross(jet[:, 1], jet[:, 2]) @ normal > 0.0)]
