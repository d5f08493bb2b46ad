"""All points with a given normal in cells that `pairs` left undecided: bisection, folds, degrees.

Such points are called solutions. The cells are bisected level by level. Small boxes that remain
undecided are listed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...directions.kernels.vectors import row_vector
from ...machine_code.jit import inline, jit, loop
from ...tape.kernels.points import LANES, POINT, evaluate_points
from .answers import (
    BORDER,
    COLUMNS,
    CURVE,
    OPEN_BOX,
    WHERE,
    add_open,
    add_place,
)
from .cell_bounds import (
    EPS,
    FIRST_S,
    FIRST_T,
    TOLERANCE_S,
    TOLERANCE_T,
    WIDE,
    CellBounds,
    patch_of,
    rests_in,
    side_of,
    write_patch,
)
from .clusters import cluster
from .degree import DECIDED, PARTS, PATH, degree_on, write_blocks
from .folds import DOUBLE, NO_PLACE, at_fold
from .pairs import (
    DETERMINANT,
    EDGE,
    HARD,
    HU,
    HV,
    MORE,
    NONE,
    ONE,
    RADIUS,
    REACHED,
    ROWS,
    STATE,
    U0,
    V0,
    S,
    T,
    bound_pairs,
    compact,
    contracted,
    forms_at,
    improve_pairs,
    load_box,
    newton,
    write_forms,
)

# The number of levels of bisection, and the levels after which clusters are tested.
DEEPEST, FOLDS = 24, (1, 4, 8, 14, 19, 24)
# Boxes on curves of solutions are set aside in two cases: more than MOST cells are undecided at
# first; or there are more than MANY boxes, and between GROWTH and AREA times as many as on the
# level before (along a curve, their number doubles). Bisection ends in three cases: there are more
# than BOXES other boxes; from the level FINE on, there are more than AREA times as many boxes as on
# the level before, since rounding leaves them undecided; boxes are set aside again, but fewer than
# FEW times the others.
MANY, GROWTH, AREA, MOST, BOXES, FINE, FEW = 256, 1.6, 3.0, 1024, 12288, 10, 2.0**-6
# The columns of boxes: u, v, the index of a cell, half the widths relative to those of the cell.
BOX_COLUMNS = 5
# A box is cut into two if one side is more than SLENDER times as long as the other, relative to the
# sides of its cell. Contraction leaves at least the part SHRUNK of a side, so that clusters have a
# width.
SLENDER, SHRUNK = 4.0, 2.0**-5
# A box is on a curve of solutions if at most SETTLING steps lead from its centre to a solution
# within BESIDE half widths. A Hessian counts as one of rank 1 if its determinant is less than RANK
# times the square of its larger eigenvalue. If it is not of rank 1, and the error of the solution
# is less than SURE times the size of the box, the solution is regular: it is on no curve.
SETTLING, BESIDE, RANK, SURE = 32, 4.0, 1e-4, 2.0**-12
# Boxes that are at most NEAR times the domain wide, and touch boxes on a curve, belong to it.
NEAR = 3e-6


class Boxes(NamedTuple):
    """Work arrays: boxes of a level and of the next level, clusters of boxes, and decisions."""

    now: NDArray[np.float64]
    following: NDArray[np.float64]
    on_curve: NDArray[np.float64]
    hulls: NDArray[np.float64]
    owner: NDArray[np.int64]
    fates: NDArray[np.int64]
    pairs: NDArray[np.float64]
    numbers: NDArray[np.int64]
    ends: NDArray[np.float64]
    blocks: NDArray[np.float64]
    path: NDArray[np.float64]
    tile: CellBounds

    @classmethod
    def new(cls, cells: int) -> Boxes:
        """Return work arrays for an index with this number of cells."""
        most = 4 * BOXES + cells
        return cls(
            np.empty((most, BOX_COLUMNS)), np.empty((most, BOX_COLUMNS)),
            np.empty((most, BOX_COLUMNS)), np.empty((most, 4)),
            np.empty(most, np.int64), np.empty(most, np.int64), np.zeros(ROWS * LANES),
            np.zeros(LANES, np.int64), np.empty((2, PARTS + 1)), np.empty((2, PARTS + 1)),
            np.empty(PATH), CellBounds.new(LANES),
        )  # fmt: skip


@loop
def side_at(tape, work, tile, cells, j, u, v, r_u, r_v, n):
    """Return the sign of the products of n and the normals in a part of cell j, 0 if unknown."""
    work.u[0], work.v[0] = u, v
    evaluate_points(tape, work.u, work.v, 1, work.registers)
    tile.place[0, 0], tile.place[0, 1], tile.place[0, 2], tile.place[0, 3] = u, v, r_u, r_v
    write_patch(tape, work.registers, tile, 0)
    size_u, size_v = r_u / cells.place[j, 2], r_v / cells.place[j, 3]
    rest_s, rest_t = rests_in(cells, j, size_u, size_v)
    return side_of(patch_of(tile.hot, 0), rest_s, rest_t, n)


@loop
def cut_boxes(tape, work, index, boxes, count, number, n, answers):
    """Decide the boxes of a level, and write the boxes of the next level.

    Returns the number of boxes on the next level, −1 if there was no room for answers.
    """
    cells, t = index.cells, boxes.pairs
    following = 0
    for first in range(0, count, LANES):
        lanes = min(LANES, count - first)
        for k in range(lanes):
            box = boxes.now[first + k]
            u, v, j = box[0], box[1], int(box[2])
            load_box(t, k, cells, j, n, u, v, box[3], box[4])
            boxes.numbers[k] = j
            work.u[k], work.v[k] = u, v
        evaluate_points(tape, work.u, work.v, lanes, work.registers)
        write_forms(t, lanes, work.registers, tape.outputs)
        bound_pairs(t, 0, lanes)
        for k in range(lanes):
            j = boxes.numbers[k]
            if cells.cone[j, 3] < WIDE or t[np.uint64(k) + STATE] == NONE:
                continue
            place, box = boxes.tile.place, boxes.now[first + k]
            place[k, 2], place[k, 3] = box[3] * cells.place[j, 2], box[4] * cells.place[j, 3]
            write_patch(tape, work.registers, boxes.tile, k)
            rest_s, rest_t = rests_in(cells, j, box[3], box[4])
            if side_of(patch_of(boxes.tile.hot, k), rest_s, rest_t, n) < 0:
                t[np.uint64(k) + STATE] = NONE
        following = keep_boxes(t, lanes, boxes, cells, following)
        kept = compact(t, lanes, boxes.numbers, boxes.numbers, work.u, work.v)
        while kept > 0:
            evaluate_points(tape, work.u, work.v, kept, work.registers)
            improve_pairs(t, kept, work.registers, tape.outputs, work.u, work.v)
            if not store_places(t, kept, work, boxes, number, answers):
                return -1
            following = keep_boxes(t, kept, boxes, cells, following)
            kept = compact(t, kept, boxes.numbers, boxes.numbers, work.u, work.v)
    return following


@inline
def inside(middle, half):
    """Return the middle of an interval after the least move that brings it into −1 … 1."""
    return min(max(middle, half - 1.0), 1.0 - half)


@loop
def keep_boxes(t, lanes, boxes, cells, following):
    """Contract and cut the boxes of a tile that are undecided; add the parts to the next level.

    A box is cut into four parts, or into two if one side is much longer. `following` is the number
    of boxes on the next level so far; the new number is returned.
    """
    for k in range(lanes):
        i = np.uint64(k)
        if t[i + STATE] != HARD:
            continue
        low_s, high_s, low_t, high_t = contracted(t, k)
        if low_s > high_s or low_t > high_t:
            continue
        j = boxes.numbers[k]
        half_s, half_t = (
            min(max(0.5 * (high_s - low_s), SHRUNK), 1.0),
            min(max(0.5 * (high_t - low_t), SHRUNK), 1.0),
        )
        # The box stays inside the cell: derivatives may jump at the boundary of the cell.
        u = t[i + U0] + inside(0.5 * (low_s + high_s), half_s) * t[i + HU]
        v = t[i + V0] + inside(0.5 * (low_t + high_t), half_t) * t[i + HV]
        size_u = half_s * t[i + HU] / cells.place[j, 2]
        size_v = half_t * t[i + HV] / cells.place[j, 3]
        along, across = size_v <= SLENDER * size_u, size_u <= SLENDER * size_v
        size_u, size_v = 0.5 * size_u if along else size_u, 0.5 * size_v if across else size_v
        for part in range(4):
            if (part & 1 and not along) or (part & 2 and not across):
                continue
            row = boxes.following[following]
            row[0], row[1], row[2], row[3], row[4] = u, v, float(j), size_u, size_v
            if along:
                row[0] += (size_u if part & 1 else -size_u) * cells.place[j, 2]
            if across:
                row[1] += (size_v if part & 2 else -size_v) * cells.place[j, 3]
            following += 1
    return following


@loop
def store_places(t, lanes, work, boxes, number, answers):
    """Store the proved solutions of a tile of boxes; return whether there was room."""
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
        row[BORDER] = float(boxes.numbers[k])  # the cell, until `is_inside` writes this column
        answers.numbers[at] = number
        answers.counts[0] = at + 1
    return True


@loop
def decide_hull(tape, work, index, boxes, hull, domain, number, n, answers):
    """Return whether the points with the normal n in a hull are known; add them to the answers."""
    start, blocks = answers.counts[0], boxes.blocks
    along, across, whole = write_blocks(index.creases, domain, hull, blocks)
    for k in range(along * across):
        at = answers.counts[0]
        row = answers.places[at]
        found = degree_on(
            tape, work, boxes.tile, boxes.pairs, index.joints, domain, blocks, k // across,
            k % across, whole, n, boxes.ends, boxes.path, row,
        )  # fmt: skip
        if found != DECIDED:
            answers.counts[0] = start
            return False
        if row[4] != 0.0:
            answers.numbers[at] = number
            answers.counts[0] = at + 1
    return along * across > 0


@loop
def decide_clusters(tape, work, index, boxes, count, domain, number, n, answers):
    """Drop clusters of boxes of the next level that a degree or a fold decides.

    Returns the number of boxes that remain, −1 if there was no room.
    """
    cells, tile = index.cells, boxes.tile
    hulls = cluster(boxes.following, count, cells, domain[4:], boxes.hulls, boxes.owner)
    for i in range(hulls):
        if answers.counts[0] + PARTS * PARTS > answers.numbers.shape[0]:
            return -1
        if decide_hull(tape, work, index, boxes, boxes.hulls[i], domain, number, n, answers):
            boxes.fates[i] = NO_PLACE
            continue
        u0, u1, v0, v1 = boxes.hulls[i, 0], boxes.hulls[i, 1], boxes.hulls[i, 2], boxes.hulls[i, 3]
        tile.place[0, 0], tile.place[0, 1] = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
        tile.place[0, 2], tile.place[0, 3] = 0.5 * (u1 - u0), 0.5 * (v1 - v0)
        boxes.fates[i] = at_fold(tape, work, tile, n)
        if boxes.fates[i] == DOUBLE:
            u, v, r_u, r_v = tile.place[0, 0], tile.place[0, 1], tile.place[0, 2], tile.place[0, 3]
            if not add_open(answers, number, u - r_u, u + r_u, v - r_v, v + r_v, OPEN_BOX, domain):
                return -1
    left = 0
    for k in range(count):
        if boxes.fates[boxes.owner[k]] != NO_PLACE and boxes.fates[boxes.owner[k]] != DOUBLE:
            for x in range(BOX_COLUMNS):
                boxes.following[left, x] = boxes.following[k, x]
            left += 1
    return left


@loop
def set_aside(tape, work, boxes, cells, count, on_curve, n):
    """Move the boxes of a level that are on curves of solutions to `boxes.on_curve`.

    `on_curve` is the number of boxes there. Returns the new number, and that of the other boxes.
    """
    left = 0
    for first in range(0, count, LANES):
        lanes = min(LANES, count - first)
        settle(tape, work, boxes, cells, boxes.now[first:], lanes, n)
        for k in range(lanes):
            on = boxes.pairs[np.uint64(k) + STATE] == ONE
            to = boxes.on_curve[on_curve] if on else boxes.now[left]
            for x in range(BOX_COLUMNS):
                to[x] = boxes.now[first + k, x]
            on_curve, left = (on_curve + 1, left) if on else (on_curve, left + 1)
    return on_curve, left


@loop
def list_rest(tape, work, index, boxes, count, on_curve, domain, number, n, answers):
    """List the undecided boxes of the last level, and those on curves, as clusters.

    A cluster counts as a curve if all of its boxes are on curves, except for boxes that are at most
    NEAR times the domain wide. Return whether there was room.
    """
    cells, rows = index.cells, boxes.on_curve
    on_curve, left = set_aside(tape, work, boxes, cells, count, on_curve, n)
    for k in range(left):
        for x in range(BOX_COLUMNS):
            rows[on_curve + k, x] = boxes.now[k, x]
    hulls = cluster(rows, on_curve + left, cells, domain[4:], boxes.hulls, boxes.owner)
    for i in range(hulls):
        hull, first = boxes.hulls[i], answers.counts[1]
        middle = middle_of(boxes, on_curve, left, i, cells, domain)
        kind = CURVE if middle >= 0 else OPEN_BOX
        if not add_open(answers, number, hull[0], hull[1], hull[2], hull[3], kind, domain):
            return False
        if answers.counts[1] > first and kind == CURVE:
            settle(tape, work, boxes, cells, rows[middle:], 1, n)
            row = answers.open_boxes[first]
            row[WHERE], row[WHERE + 1] = work.u[0], work.v[0]
    return True


@inline
def middle_of(boxes, on_curve, left, owner, cells, domain):
    """Return the index of the middle box of a cluster; −1 if it does not count as a curve."""
    own, rows = 0, boxes.on_curve
    most_u, most_v = 0.5 * NEAR * (domain[1] - domain[0]), 0.5 * NEAR * (domain[3] - domain[2])
    for k in range(on_curve + left):
        if boxes.owner[k] == owner:
            j = int(rows[k, 2])
            if k < on_curve:
                own += 1
            elif rows[k, 3] * cells.place[j, 2] > most_u or rows[k, 4] * cells.place[j, 3] > most_v:
                return -1
    middle = own // 2
    for k in range(on_curve):
        if boxes.owner[k] == owner:
            if middle == 0:
                return k
            middle -= 1
    return -1


@loop
def settle(tape, work, boxes, cells, rows, lanes, n):
    """Move from the centres of boxes towards solutions by Gauss–Newton steps; write u, v to `work`.

    The boxes are the first rows, as many as there are lanes. The state of a lane becomes ONE if the
    steps reach a point near the box whose residual is explained by rounding, unless it is a regular
    solution with a small error (see SURE). Otherwise the state becomes NONE.
    """
    t, outputs = boxes.pairs, tape.outputs
    x, y, z = (
        np.uint64(POINT * outputs[0]), np.uint64(POINT * outputs[1]), np.uint64(POINT * outputs[2])
    )  # fmt: skip
    for k in range(lanes):
        i = np.uint64(k)
        t[i + S] = t[i + T] = 0.0
        t[i + STATE] = MORE
    moving, step = True, 0
    while moving:
        for k in range(lanes):
            i, j = np.uint64(k), int(rows[k, 2])
            work.u[k] = rows[k, 0] + cells.place[j, 2] * t[i + S]
            work.v[k] = rows[k, 1] + cells.place[j, 3] * t[i + T]
        evaluate_points(tape, work.u, work.v, lanes, work.registers)
        moving, step = False, step + 1
        for k in range(lanes):
            i, j = np.uint64(k), int(rows[k, 2])
            if t[i + STATE] != MORE:
                continue
            forms = forms_at(
                work.registers, x + i, y + i, z + i, n, cells.place[j, 2], cells.place[j, 3]
            )
            t[i + S], t[i + T], t[i + STATE] = settled(
                forms, cells.noise[j], rows[k, 3], rows[k, 4], t[i + S], t[i + T]
            )
            if t[i + STATE] == MORE:
                t[i + STATE] = MORE if step < SETTLING else NONE
                moving = moving or step < SETTLING


@loop
def settled(forms, noise, size_s, size_t, s, t):
    """Return s, t after a Gauss–Newton step, and a state: MORE, or NONE if they are far away.

    If rounding explains the residual at s, t, they are returned unchanged, with the state of
    `settle`. `forms` are those at s, t in a box with the half widths size_s, size_t.
    """
    a, b, c, p, q = forms
    rest_s, rest_t = noise[FIRST_S] + noise[TOLERANCE_S], noise[FIRST_T] + noise[TOLERANCE_T]
    large = 0.5 * (a + c) + math.copysign(math.hypot(0.5 * (a - c), b), a + c)
    d = abs(a * c - b * b)
    regular = d > RANK * large * large
    if abs(p) <= rest_s and abs(q) <= rest_t:
        # A regular solution whose error is small relative to the box is on no curve.
        alone = (
            regular
            and abs(c) * rest_s + abs(b) * rest_t < SURE * d * size_s
            and abs(b) * rest_s + abs(a) * rest_t < SURE * d * size_t
        )
        return s, t, NONE if alone else ONE
    if not abs(large) > 0.0:
        return s, t, NONE
    if regular:
        s, t, _ = newton(a, b, c, p, q, s, t)
    else:
        e_s, e_t = (b, large - a) if abs(a) < abs(c) else (large - c, b)
        step = (e_s * p + e_t * q) / (large * (e_s * e_s + e_t * e_t))
        s, t = s - step * e_s, t - step * e_t
    # At joints, the tolerance of normals lets solutions be this much farther from a box.
    most = BESIDE * (max(size_s, size_t) + (rest_s + rest_t) / abs(large))
    return s, t, MORE if max(abs(s), abs(t)) <= most else NONE


@loop
def bisect(tape, work, index, boxes, count, domain, number, n, answers):
    """Find the solutions for a normal in whole cells; return whether there was room."""
    on_curve, growing = 0, count > MOST
    for level in range(DEEPEST + 1):
        if count > MANY and growing:
            before = on_curve
            on_curve, count = set_aside(tape, work, boxes, index.cells, count, on_curve, n)
            if before > 0 and on_curve - before < FEW * count:
                break
        if count > BOXES or on_curve + 4 * count > boxes.owner.size:
            break
        following = cut_boxes(tape, work, index, boxes, count, number, n, answers)
        if following < 0:
            return False
        rounding = level >= FINE and following > AREA * count
        if following > 0 and (rounding or level in FOLDS):
            following = decide_clusters(
                tape, work, index, boxes, following, domain, number, n, answers
            )
            if following < 0:
                return False
        growing, count = GROWTH * count < following < AREA * count, following
        for k in range(count):
            for x in range(BOX_COLUMNS):
                boxes.now[k, x] = boxes.following[k, x]
        if count == 0 or rounding:
            break
    return list_rest(tape, work, index, boxes, count, on_curve, domain, number, n, answers)


@loop
def orient(tape, work, index, boxes, first, domain, number, n, answers):
    """Remove solutions whose normal is −n; list solutions of unknown sign as boxes.

    Return whether there was room.
    """
    cells = index.cells
    kept = first
    for at in range(first, answers.counts[0]):
        row = answers.places[at]
        j = int(row[BORDER])  # negative if the side is known
        side = 1
        if j >= 0 and cells.cone[j, 3] >= WIDE:
            r_u, r_v = row[2] + 4.0 * EPS * abs(row[0]), row[3] + 4.0 * EPS * abs(row[1])
            side = side_at(tape, work, boxes.tile, cells, j, row[0], row[1], r_u, r_v, n)
        if side == 0 and not add_place(answers, number, row, domain):
            return False
        if side > 0:
            for x in range(COLUMNS):
                answers.places[kept, x] = row[x]
            kept += 1
    answers.counts[0] = kept
    return True


@jit
def decide_normals(tape, work, index, normals, hard, groups, first, last, domain, boxes, answers):
    """Decide the hard pairs of the groups [first, last), each of one normal.

    hard (…, 2) are indices of normals (S, 3) and of cells; groups[g] is the start of a group.
    `domain` (6) is u₀, u₁, v₀, v₁, and the periods of u and v or 0. Returns the next group, `last`
    unless there was no more room for answers.
    """
    answers.counts[0] = answers.counts[1] = 0
    for g in range(first, last):
        start, open_start = answers.counts[0], answers.counts[1]
        number = hard[groups[g], 0]
        n = row_vector(normals, number)
        count = groups[g + 1] - groups[g]
        for k in range(count):
            j = hard[groups[g] + k, 1]
            place = index.cells.place
            box = boxes.now[k]
            box[0], box[1], box[2], box[3], box[4] = place[j, 0], place[j, 1], float(j), 1.0, 1.0
        room = bisect(tape, work, index, boxes, count, domain, number, n, answers)
        room = room and orient(tape, work, index, boxes, start, domain, number, n, answers)
        if not room:
            answers.counts[0], answers.counts[1] = start, open_start
            return np.int64(g)
    return np.int64(last)
