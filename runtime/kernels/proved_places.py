"""All places with a normal in the cells that a simple search left open: bisection, folds, doubles.

The cells of a normal are cut level by level. What stays open in the end lies in a few small boxes,
and is listed with them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..machine_code.jit import jit, loop
from .proved_cells import (
    EPS,
    FIRST_S,
    FIRST_T,
    SECOND,
    WIDE,
    Cells,
    patch_of,
    side_of,
    third_sizes,
    write_patch,
)  # fmt: skip
from .proved_clusters import cluster, shift_to
from .proved_folds import DOUBLE, NO_PLACE, at_fold
from .proved_pairs import (
    DETERMINANT,
    EDGE,
    HARD,
    HU,
    HV,
    NONE,
    ONE,
    RADIUS,
    REACHED,
    ROWS,
    STATE,
    U0,
    V0,
    bound_pairs,
    compact,
    improve_pairs,
    load_box,
    write_forms,
)  # fmt: skip
from .tape import LANES, evaluate_points
from .vectors import row_vector

__all__ = ["BORDER", "BOX", "KINDS", "Answers", "Boxes", "decide_normals"]

# What is not decided: none or two places in a box, several or none, a curve or more of them, or
# places where the surface may have no normal.
KINDS = ("double", "multiple", "continuum", "singular")
DOUBLE_KIND, MULTIPLE, CONTINUUM, SINGULAR = range(4)
# The columns of places: u, v, how far they may be off, D; then the box in which there is no other
# place, u₀, u₁, v₀, v₁; and whether the border of the domain is so near.
BOX, BORDER, COLUMNS = 5, 9, 10
# Boxes are cut so often; after each of some levels folds are looked for.
DEEPEST, FOLDS = 24, (4, 8, 14, 19)
# More open boxes than these, or than these and twice the cells of a normal, are a continuum.
MOST, FEW = 1024, 64


class Boxes(NamedTuple):
    """Work arrays: boxes of a level and of the next one, clusters of them, and what becomes of these."""

    now: NDArray[np.float64]
    following: NDArray[np.float64]
    hulls: NDArray[np.float64]
    owner: NDArray[np.int64]
    fates: NDArray[np.int64]
    pairs: NDArray[np.float64]
    numbers: NDArray[np.int64]
    levels: NDArray[np.int64]
    tile: Cells

    @classmethod
    def new(cls, cells: int) -> Boxes:
        """Return work arrays for an index with so many cells."""
        most = 4 * MOST + cells
        return cls(
            np.empty((most, 3)), np.empty((most, 3)), np.empty((most, 4)), np.empty(most, np.int64),
            np.empty(most, np.int64), np.zeros(ROWS * LANES), np.zeros(LANES, np.int64),
            np.array(FOLDS), Cells.new(LANES),
        )  # fmt: skip


class Answers(NamedTuple):
    """Room for places (k, 10), undecided boxes (k, 5) with their kinds, and the normals of both.

    `counts` are the numbers of both.
    """

    places: NDArray[np.float64]
    numbers: NDArray[np.int64]
    open_boxes: NDArray[np.float64]
    kinds: NDArray[np.int64]
    open_numbers: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, room: int) -> Answers:
        """Return some room."""
        return cls(
            np.empty((room, COLUMNS)), np.empty(room, np.int64), np.empty((room, 5)),
            np.empty(room, np.int64), np.empty(room, np.int64), np.zeros(2, np.int64),
        )  # fmt: skip


@loop
def add_open(answers, number, u0, u1, v0, v1, kind, domain):
    """List a box that is not decided, less what is outside of the domain; say if there was room.

    A box outside is not listed.
    """
    at = answers.counts[1]
    if at == answers.kinds.shape[0]:
        return False
    border = 0.0
    if domain[4] == 0.0:  # no period
        if u1 < domain[0] or u0 > domain[1]:
            return True
        border = 1.0 if u0 <= domain[0] or u1 >= domain[1] else border
        u0, u1 = max(u0, domain[0]), min(u1, domain[1])
    if domain[5] == 0.0:
        if v1 < domain[2] or v0 > domain[3]:
            return True
        border = 1.0 if v0 <= domain[2] or v1 >= domain[3] else border
        v0, v1 = max(v0, domain[2]), min(v1, domain[3])
    row = answers.open_boxes[at]
    row[0], row[1], row[2], row[3], row[4] = u0, u1, v0, v1, border
    answers.kinds[at], answers.open_numbers[at] = kind, number
    answers.counts[1] = at + 1
    return True


@loop
def side_at(tape, work, tile, cells, j, u, v, r_u, r_v, n):
    """Return the sign of the product of n and the normals in a small box of cell j, 0 if unknown."""
    work.u[0], work.v[0] = u, v
    evaluate_points(tape, work.u, work.v, 1, work.registers)
    tile.place[0, 0], tile.place[0, 1], tile.place[0, 2], tile.place[0, 3] = u, v, r_u, r_v
    write_patch(tape, work.registers, tile, 0)
    size_u, size_v = r_u / cells.place[j, 2], r_v / cells.place[j, 3]
    rest_s, rest_t = rest_in(cells, j, size_u, size_v)
    return side_of(patch_of(tile.hot, 0), rest_s, rest_t, n)


@loop
def rest_in(cells, j, size_u, size_v):
    """Return what a patch leaves out of x_s, x_t in a part of cell j, relative to it so large."""
    t0, t1, t2, t3 = third_sizes(cells.thirds, j)
    square = max(size_u, size_v) ** 2
    second = 2.0 * square * cells.noise[j, SECOND]
    rest_s = size_u * (0.5 * square * (t0 + 2.0 * t1 + t2) + cells.noise[j, FIRST_S]) + second
    rest_t = size_v * (0.5 * square * (t1 + 2.0 * t2 + t3) + cells.noise[j, FIRST_T]) + second
    return rest_s, rest_t


@loop
def cut_boxes(tape, work, index, boxes, count, size, number, n, answers):
    """Decide boxes of a level; write those of the next one. Returns their number, −1 without room."""
    cells, t = index.cells, boxes.pairs
    following = 0
    for first in range(0, count, LANES):
        lanes = min(LANES, count - first)
        for k in range(lanes):
            u, v, j = boxes.now[first + k, 0], boxes.now[first + k, 1], int(boxes.now[first + k, 2])
            load_box(t, k, cells, j, n, u, v, size)
            boxes.numbers[k] = j
            work.u[k], work.v[k] = u, v
        evaluate_points(tape, work.u, work.v, lanes, work.registers)
        write_forms(t, lanes, work.registers, tape.outputs)
        bound_pairs(t, 0, lanes)
        for k in range(lanes):
            j = boxes.numbers[k]
            if cells.cone[j, 3] < WIDE or t[np.uint64(k) + STATE] == NONE:
                continue
            place = boxes.tile.place
            place[k, 2], place[k, 3] = size * cells.place[j, 2], size * cells.place[j, 3]
            write_patch(tape, work.registers, boxes.tile, k)
            rest_s, rest_t = rest_in(cells, j, size, size)
            if side_of(patch_of(boxes.tile.hot, k), rest_s, rest_t, n) < 0:
                t[np.uint64(k) + STATE] = NONE
        following = keep_boxes(t, lanes, boxes, size, following)
        kept = compact(t, lanes, boxes.numbers, boxes.numbers, work.u, work.v)
        while kept > 0:
            evaluate_points(tape, work.u, work.v, kept, work.registers)
            improve_pairs(t, kept, work.registers, tape.outputs, work.u, work.v)
            if not store_places(t, kept, work, boxes, number, answers):
                return -1
            following = keep_boxes(t, kept, boxes, size, following)
            kept = compact(t, kept, boxes.numbers, boxes.numbers, work.u, work.v)
    return following


@loop
def keep_boxes(t, lanes, boxes, size, following):
    """Write the four parts of boxes that are not decided; return the number of all parts."""
    for k in range(lanes):
        i = np.uint64(k)
        if t[i + STATE] != HARD:
            continue
        for part in range(4):
            row = boxes.following[following]
            row[0] = t[i + U0] + (0.5 if part & 1 else -0.5) * t[i + HU]
            row[1] = t[i + V0] + (0.5 if part & 2 else -0.5) * t[i + HV]
            row[2] = boxes.numbers[k]
            following += 1
    return following


@loop
def store_places(t, lanes, work, boxes, number, answers):
    """Store the places that are proved in a tile of boxes; say whether there was room."""
    if answers.counts[0] + lanes > answers.numbers.shape[0]:
        return False
    for k in range(lanes):
        i = np.uint64(k)
        if t[i + STATE] != ONE and t[i + STATE] != EDGE:
            continue
        at = answers.counts[0]
        row = answers.places[at]
        row[0], row[1], row[4] = work.u[k], work.v[k], t[i + DETERMINANT]
        row[2], row[3] = t[i + RADIUS] * t[i + HU], t[i + RADIUS] * t[i + HV]
        reach_u, reach_v = t[i + REACHED] * t[i + HU], t[i + REACHED] * t[i + HV]
        row[5], row[6] = t[i + U0] - reach_u, t[i + U0] + reach_u
        row[7], row[8] = t[i + V0] - reach_v, t[i + V0] + reach_v
        row[BORDER] = float(boxes.numbers[k])  # until it is decided
        answers.numbers[at] = number
        answers.counts[0] = at + 1
    return True


@loop
def use_folds(tape, work, index, boxes, count, size, domain, number, n, last, answers):
    """Drop the clusters of boxes that are decided by folds; the others, too, after the `last` level.

    Returns the number of boxes that are left, −1 if there was no room.
    """
    cells, tile = index.cells, boxes.tile
    hulls = cluster(boxes.following, count, cells, size, domain[4:], boxes.hulls, boxes.owner)
    for i in range(hulls):
        u0, u1, v0, v1 = boxes.hulls[i, 0], boxes.hulls[i, 1], boxes.hulls[i, 2], boxes.hulls[i, 3]
        tile.place[0, 0], tile.place[0, 1] = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
        tile.place[0, 2], tile.place[0, 3] = 0.5 * (u1 - u0), 0.5 * (v1 - v0)
        boxes.fates[i] = at_fold(tape, work, tile, n)
        if boxes.fates[i] == DOUBLE:
            u, v, r_u, r_v = tile.place[0, 0], tile.place[0, 1], tile.place[0, 2], tile.place[0, 3]
            if not add_open(
                answers, number, u - r_u, u + r_u, v - r_v, v + r_v, DOUBLE_KIND, domain
            ):
                return -1
        elif boxes.fates[i] != NO_PLACE and last:
            kind = MULTIPLE
            for k in range(count):
                if boxes.owner[k] == i and cells.cone[int(boxes.following[k, 2]), 3] >= WIDE:
                    kind = SINGULAR
            if not add_open(answers, number, u0, u1, v0, v1, kind, domain):
                return -1
            boxes.fates[i] = NO_PLACE
    left = 0
    for k in range(count):
        if boxes.fates[boxes.owner[k]] != NO_PLACE and boxes.fates[boxes.owner[k]] != DOUBLE:
            for x in range(3):
                boxes.following[left, x] = boxes.following[k, x]
            left += 1
    return left


@loop
def give_up(index, boxes, rows, count, size, domain, number, answers):
    """List all boxes of rows as a continuum, or as singular; say whether there was room."""
    cells = index.cells
    hulls = cluster(rows, count, cells, size, domain[4:], boxes.hulls, boxes.owner)
    for i in range(hulls):
        kind = CONTINUUM
        for k in range(count):
            if boxes.owner[k] == i and cells.cone[int(rows[k, 2]), 3] >= WIDE:
                kind = SINGULAR
        hull = boxes.hulls[i]
        if not add_open(answers, number, hull[0], hull[1], hull[2], hull[3], kind, domain):
            return False
    return True


@loop
def bisect(tape, work, index, boxes, count, domain, number, n, answers):
    """Find the places of a normal in the first boxes, which are whole cells; say if there was room."""
    size = 1.0
    fold = 0
    limit = min(MOST, FEW + 2 * count)
    for level in range(DEEPEST + 1):
        if count > 4 * limit or (level == 0 and count > MOST):
            return give_up(index, boxes, boxes.now, count, size, domain, number, answers)
        following = cut_boxes(tape, work, index, boxes, count, size, number, n, answers)
        size *= 0.5
        if following < 0:
            return False
        last = level == DEEPEST
        if following > 0 and (last or (fold < boxes.levels.size and level == boxes.levels[fold])):
            fold += 1
            following = use_folds(
                tape, work, index, boxes, following, size, domain, number, n, last, answers
            )
            if following < 0:
                return False
        if following == 0:
            return True
        count = following
        for k in range(count):
            for x in range(3):
                boxes.now[k, x] = boxes.following[k, x]
    return True


@loop
def orient(tape, work, index, boxes, first, domain, number, n, answers):
    """Leave places out that have the normal −n; list those that may have none as singular.

    Says whether there was room.
    """
    cells = index.cells
    kept = first
    for at in range(first, answers.counts[0]):
        row = answers.places[at]
        j = int(row[BORDER])
        side = 1
        if cells.cone[j, 3] >= WIDE:
            r_u, r_v = row[2] + 4.0 * EPS * abs(row[0]), row[3] + 4.0 * EPS * abs(row[1])
            side = side_at(tape, work, boxes.tile, cells, j, row[0], row[1], r_u, r_v, n)
        if side == 0 and not add_open(
            answers,
            number,
            row[0] - row[2],
            row[0] + row[2],
            row[1] - row[3],
            row[1] + row[3],
            SINGULAR,
            domain,
        ):
            return False
        if side > 0:
            for x in range(COLUMNS):
                answers.places[kept, x] = row[x]
            kept += 1
    answers.counts[0] = kept
    return True


@loop
def relation(row, other, period):
    """Return 1 if another place is that of a row, 0 if it is another one, −1 if this is not known."""
    du = shift_to(other[0], 0.5 * (row[5] + row[6]), period[0])
    dv = shift_to(other[1], 0.5 * (row[7] + row[8]), period[1])
    u, v = other[0] + du, other[1] + dv
    if (
        u - other[2] >= row[5]
        and u + other[2] <= row[6]
        and v - other[3] >= row[7]
        and v + other[3] <= row[8]
    ):
        return 1
    du = shift_to(other[0], row[0], period[0])
    dv = shift_to(other[1], row[1], period[1])
    # More than the rounding of shifts.
    slack_u, slack_v = 4.0 * EPS * (abs(du) + abs(row[0])), 4.0 * EPS * (abs(dv) + abs(row[1]))
    apart_u = abs(other[0] + du - row[0]) > other[2] + row[2] + slack_u
    apart_v = abs(other[1] + dv - row[1]) > other[3] + row[3] + slack_v
    return 0 if apart_u or apart_v else -1


@loop
def merge(answers, first, fast, fast_first, fast_last, number, domain):
    """Keep each place once, and those in the domain; say whether there was room."""
    period = domain[4:]
    kept = first
    for at in range(first, answers.counts[0]):
        row = answers.places[at]
        if not is_inside(row, domain):
            continue
        same = 0
        for k in range(fast_first, fast_last):
            same = worse(same, relation(row, fast[k], period))
        for k in range(first, kept):
            same = worse(
                same,
                max(
                    relation(row, answers.places[k], period),
                    relation(answers.places[k], row, period),
                ),
            )
        if same == -1:
            if not add_open(
                answers,
                number,
                row[0] - row[2],
                row[0] + row[2],
                row[1] - row[3],
                row[1] + row[3],
                MULTIPLE,
                domain,
            ):
                return False
        elif same == 0:
            for x in range(COLUMNS):
                answers.places[kept, x] = row[x]
            answers.numbers[kept] = number
            kept += 1
    answers.counts[0] = kept
    return True


@loop
def worse(one, other):
    """Return the relation to two places from those to each: the same as one, or not known."""
    return 1 if one == 1 or other == 1 else -1 if one == -1 or other == -1 else 0


@loop
def is_inside(row, domain):
    """Say whether a place may be in the domain, and write whether its border is as near as that.

    Places are brought into the domain.
    """
    border = 0.0
    for axis in range(2):
        low, high, period = domain[2 * axis], domain[2 * axis + 1], domain[4 + axis]
        x, radius = row[axis], row[2 + axis]
        if period > 0.0:
            row[axis] = x + period if x < low else x - period if x > high else x
            continue
        if x + radius < low or x - radius > high:
            return False
        if x - radius < low or x + radius > high:
            border = 1.0
            row[axis] = min(max(x, low), high)
    row[BORDER] = border
    return True


@jit
def decide_normals(
    index, tape, work, normals, hard, groups, first, last, fast, fast_starts, domain, boxes, answers
):
    """Decide the hard pairs of the groups first, …, last − 1, each of one normal.

    hard (…, 2) are numbers of normals (S, 3) and of cells; groups[g] is the start of a group. Its
    places that are known already are fast[fast_starts[g]:fast_starts[g + 1]], (…, 5). `domain` (6)
    is u₀, u₁, v₀, v₁, and the periods of u and v or 0. Returns the next group,
    `last` unless there was no more room for answers.
    """
    answers.counts[0] = answers.counts[1] = 0
    for g in range(first, last):
        start, open_start = answers.counts[0], answers.counts[1]
        number = hard[groups[g], 0]
        n = row_vector(normals, number)
        count = groups[g + 1] - groups[g]
        for k in range(count):
            j = hard[groups[g] + k, 1]
            boxes.now[k, 0], boxes.now[k, 1], boxes.now[k, 2] = (
                index.cells.place[j, 0],
                index.cells.place[j, 1],
                j,
            )
        room = bisect(tape, work, index, boxes, count, domain, number, n, answers)
        room = room and orient(tape, work, index, boxes, start, domain, number, n, answers)
        room = room and merge(
            answers, start, fast, fast_starts[g], fast_starts[g + 1], number, domain
        )
        if not room:
            answers.counts[0], answers.counts[1] = start, open_start
            return np.int64(g)
    return np.int64(last)
