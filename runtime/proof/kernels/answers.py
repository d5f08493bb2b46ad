"""Answers of a search: solutions, each once and sorted by normal, and undecided boxes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...machine_code.jit import jit, loop
from .cell_bounds import EPS
from .clusters import shift_to
from .evaluated_pairs import PLACE

# The kinds of boxes that are listed besides regular solutions: a box that may contain solutions or
# none, a box around a small component of solutions, and one around a curve or a region of them.
KINDS = ("open", "isolated", "curve")
OPEN_BOX, ISOLATED, CURVE = range(3)
# The columns of solutions: u, v, their error bounds, D; then the box without other solutions, u₀,
# u₁, v₀, v₁; and whether the error bounds reach the boundary of the domain.
BOX, BORDER, COLUMNS = 5, 9, 10
# The last two columns of boxes are u and v of a point in the box, a solution if the kind is CURVE.
WHERE, OPEN_COLUMNS = 5, 7


class Answers(NamedTuple):
    """Arrays for solutions (k, 10), other boxes (k, 7) with their kinds, and indices of normals.

    The columns of boxes are u₀, u₁, v₀, v₁, whether the box reaches the boundary, and u and v of a
    point of it. `counts` are the numbers of solutions and boxes.
    """

    places: NDArray[np.float64]
    numbers: NDArray[np.int64]
    open_boxes: NDArray[np.float64]
    kinds: NDArray[np.int64]
    open_numbers: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, room: int) -> Answers:
        """Return empty arrays."""
        return cls(
            np.empty((room, COLUMNS)), np.empty(room, np.int64), np.empty((room, OPEN_COLUMNS)),
            np.empty(room, np.int64), np.empty(room, np.int64), np.zeros(2, np.int64),
        )  # fmt: skip


@loop
def add_open(answers, number, u0, u1, v0, v1, kind, domain):
    """List the part of an undecided box inside the domain; return whether there was room.

    A box outside the domain is not listed.
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
    row[WHERE], row[WHERE + 1] = 0.5 * (u0 + u1), 0.5 * (v0 + v1)
    answers.kinds[at], answers.open_numbers[at] = kind, number
    answers.counts[1] = at + 1
    return True


@loop
def add_place(answers, number, row, domain):
    """List the box of a possible solution as undecided; return whether there was room."""
    u, v, r_u, r_v = row[0], row[1], row[2], row[3]
    return add_open(answers, number, u - r_u, u + r_u, v - r_v, v + r_v, OPEN_BOX, domain)


@jit
def merge_places(places, numbers, groups, first, last, fast, fast_starts, domain, keep, answers):
    """Write to `keep` whether to keep each solution: solutions in the domain, each once.

    A solution is listed as a box if it is unknown whether it is the same as another one.
    Solutions (k, 10) of a group share one normal, whose index is in numbers (k,). The groups are
    [first, last); further solutions of group g, fast[fast_starts[g]:fast_starts[g + 1]], are always
    kept. Return the next group, `last` unless there was no more room for boxes.
    """
    answers.counts[0] = answers.counts[1] = 0
    for g in range(first, last):
        start = answers.counts[1]
        for at in range(groups[g], groups[g + 1]):
            keep[at] = is_inside(places[at], domain)
        for at in range(groups[g], groups[g + 1]):
            if not keep[at]:
                continue
            same = 0
            for k in range(fast_starts[g], fast_starts[g + 1]):
                same = worse(same, relation(places[at], fast[k], domain[4:]))
            for k in range(groups[g], at):
                if keep[k]:
                    same = worse(same, either(places[at], places[k], domain[4:]))
            keep[at] = same == 0
            if same == -1 and not add_place(answers, numbers[at], places[at], domain):
                answers.counts[1] = start
                return np.int64(g)
    return np.int64(last)


@loop
def either(row, other, period):
    """Return the relation of two solutions, tested in the box of each."""
    one, two = relation(row, other, period), relation(other, row, period)
    return 1 if one == 1 or two == 1 else one


@loop
def relation(row, other, period):
    """Return 1 if two solutions are the same, 0 if they are distinct, −1 if unknown."""
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
    # The slack exceeds the rounding errors of the shifts by periods.
    slack_u, slack_v = 4.0 * EPS * (abs(du) + abs(row[0])), 4.0 * EPS * (abs(dv) + abs(row[1]))
    apart_u = abs(other[0] + du - row[0]) > other[2] + row[2] + slack_u
    apart_v = abs(other[1] + dv - row[1]) > other[3] + row[3] + slack_v
    return 0 if apart_u or apart_v else -1


@loop
def worse(one, other):
    """Combine two relations: return 1 if either is 1, otherwise −1 if either is −1, otherwise 0."""
    return 1 if one == 1 or other == 1 else -1 if one == -1 or other == -1 else 0


@loop
def is_inside(row, domain):
    """Return whether a solution may be in the domain; write whether it may be on the boundary.

    Solutions are shifted into the domain.
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


# --- sorted by normal -----------------------------------------------------------------------------


class Sorted(NamedTuple):
    """Arrays for sorted solutions (k, 6) of a search, and the indices (k,) of their normals."""

    numbers: NDArray[np.int64]
    places: NDArray[np.float64]

    @classmethod
    def new(cls, count: int) -> Sorted:
        """Return empty arrays for a number of solutions."""
        return cls(np.empty(count, np.int64), np.empty((count, PLACE)))


@jit
def count_places(numbers, starts):
    """Add the number of solutions for each normal n to starts[n + 1]; `starts` is (S + 1,)."""
    for k in range(numbers.size):
        starts[numbers[k] + 1] += 1


@jit
def start_normals(starts):
    """Replace the numbers of solutions by their cumulative sums, the starts."""
    for n in range(starts.size - 1):
        starts[n + 1] += starts[n]


@jit
def put_places(places, numbers, starts, room):
    """Write solutions (k, 6) at the starts of their normals, and advance the starts."""
    for k in range(numbers.size):
        at = starts[numbers[k]]
        starts[numbers[k]] = at + 1
        room.numbers[at] = numbers[k]
        for x in range(PLACE):
            room.places[at, x] = places[k, x]


@jit
def order_places(room):
    """Sort the solutions for each normal by u, then v."""
    for first in range(1, room.numbers.size):
        k = first
        while k > 0 and room.numbers[k - 1] == room.numbers[k] and is_before(room.places, k, k - 1):
            for x in range(PLACE):
                room.places[k, x], room.places[k - 1, x] = room.places[k - 1, x], room.places[k, x]
            k -= 1


@loop
def is_before(places, i, k):
    """Return whether the parameters of solution i precede those of solution k."""
    return places[i, 0] < places[k, 0] or (
        places[i, 0] == places[k, 0] and places[i, 1] < places[k, 1]
    )
