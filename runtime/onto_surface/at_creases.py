"""Points of creases at given normals n: n is between the normals of both sides of the crease.

At such a point of a crease u = c, n is perpendicular to x_v, and n·x_u has different signs on both
sides. So across the crease the height n·x has a maximum or a minimum. Along the crease it has a
maximum or a minimum, too, or neither. The index of the point is 1 for two maxima or two minima, −1
for a maximum and a minimum, and else 0. If the crease is rounded off, the point is replaced by
points with this normal whose indices have the same sum. For creases u = c and v = c alike, w is the
parameter along the crease, and s the parameter across it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..directions.unit import unit_or_zero
from ..domain.trim import Trim
from ..proof.grid_lines import PLACES, creases_of, lines_of
from ..samples.fields import Component
from ..samples.samples import Samples
from ..surface.surface import Surface
from ..tape.kernels.points import Tape
from ..tape.tapes import bounds_over_boxes, jets_of

# Along creases, n·x_w counts as 0 up to SMOOTH |x_w|. Where n·x_ww is 0, too, zeros of n·x_w are
# known up to APART, the square root of SMOOTH. Therefore points of one crease with the same normal
# that are closer than APART, relative to the length of the crease in w, are one component.
# The signs of n·x_w before and after a component are taken at the distance APART from it.
SMOOTH = 1e-9
APART = math.sqrt(SMOOTH)
# The normals of both sides are known up to the angle ROUNDING. If the normal of a point of a crease
# is that of one side up to the angle NEARLY, the point cannot be told apart from a regular point
# beside it. Two points are beside each other if they are nearer than four times the error bound of
# the regular point plus BESIDE times the size of the creases.
ROUNDING, NEARLY, BESIDE = 2.0**-43, 2.0**-40, 2.0**-40
# In intervals where n·x_w has at most one zero, there are STEPS steps of Newton's method. Other
# intervals, and those where these steps do not settle, are halved. If a normal has more than MANY
# intervals to halve, as on a straight crease, only those with a zero in the middle are kept.
STEPS, MANY = 5, 4096
# All combinations of whether the height increases along each of the four creases at a corner, and
# the index of the corner for each combination.
RISES = np.indices((2, 2, 2, 2)).reshape(4, -1).T == 1
DEGREES = 1.0 - (np.roll(RISES, 1, axis=1) != RISES).sum(axis=1) / 2.0
PRODUCTS_AT_A_TIME = 1 << 21
# The positions of the second derivatives by uu and vv in jets and Taylor polynomials.
SECOND = (3, 5)


class OnCreases(NamedTuple):
    """Points of creases at given normals, one for each component, sorted by normal.

    `numbers` (k,) are the indices of the normals. `degrees` (k,) are the indices −1, 0 or 1 that
    the docstring of the module defines, or NaN where the index is unknown. The parameters of all
    points of a component differ by at most `radius` (k, 2) from `uv` (k, 2). A point is `unsure` if
    its normal is nearly that of one side, or if its index is unknown. In the first case that side
    may have a regular point with this normal near the crease. If there is one, the point of the
    crease exists only if it is `paired`: both then have opposite indices. If there is none, the
    point of the crease exists only if it is `alone`.
    """

    numbers: Indices
    uv: Array
    points: Array
    degrees: Array
    radius: Array
    unsure: Flags
    paired: Flags
    alone: Flags


class Corner(NamedTuple):
    """A point where a crease u = const and a crease v = const cross.

    `lines` (2,) are the indices of both creases. `uv` (2,) are its parameters, `point` (3,) is its
    position. Points of creases within `radius` (2,) of `uv`, the rounding error, belong to the
    corner. `tangents` (4, 3) are unit tangents of the four creases that leave the corner,
    counter-clockwise.
    """

    lines: Indices
    uv: Array
    radius: Array
    point: Array
    tangents: Array

    @classmethod
    def of(cls, tape: Tape, numbers: Sequence[int], lines: Array, spans: Array) -> Corner:
        """Return the corner of two creases with the given rows of `Creases.lines` and `.spans`."""
        (_, left, right, _), (_, below, above, _) = lines
        radius, size = lines[:, 2] - lines[:, 1], np.ptp(spans[::-1], axis=1)
        radius -= size * np.rint(radius / size)  # the bounds at a seam differ by a period
        u, v = np.array([right, right, left, right]), np.array([above, above, above, below])
        jets = jets_of(tape, u, v)
        tangents = jets[np.arange(4), [1, 2, 1, 2]] * [[1.0], [1.0], [-1.0], [-1.0]]
        at = np.array([right, above])
        return cls(np.array(numbers), at, radius, jets[0, 0], unit_or_zero(tangents))

    def is_near(self, rows: Indices, along: Array, periods: Array) -> Flags:
        """Return a mask (k,) of the points of creases that belong to the corner.

        `rows` (k,) are the indices of their creases, `along` (k,) their parameters along these.
        """
        near = np.zeros(len(rows), np.bool_)
        for axis, line in enumerate(self.lines.tolist()):
            away = along - self.uv[1 - axis]
            if periods[line] > 0.0:
                away -= periods[line] * np.rint(away / periods[line])
            near |= (rows == line) & (np.abs(away) <= self.radius[1 - axis])
        return near

    def at(self, normals: Array) -> OnCreases:
        """Return the corner once for each of the unit normals (S, 3) that is in its normal cone.

        The index follows from the signs of the slopes of n·x along the four creases; corners with
        the index 0 are left out. Where the index depends on a slope that is 0 up to rounding, or
        where the normal is that of one of the four sides, the degree is NaN and the point `unsure`.
        """
        following = np.roll(self.tangents, -1, axis=0)
        facing = normals @ unit_or_zero(np.cross(self.tangents, following)).sum(axis=0)
        slopes = normals @ self.tangents.T
        zero, flat = np.abs(slopes) <= SMOOTH, np.abs(slopes) <= 2.0 * SMOOTH
        degrees = np.full((len(normals), len(RISES)), np.nan)
        for k, (rises, degree) in enumerate(zip(RISES, DEGREES, strict=True)):
            degrees[(zero | (rises == (slopes > 0.0))).all(axis=1), k] = degree
        low, high = np.fmin.reduce(degrees, axis=1), np.fmax.reduce(degrees, axis=1)
        unsure = (low != high) | (flat & np.roll(flat, -1, axis=1)).any(axis=1)
        (numbers,) = np.nonzero((facing > 0.0) & (unsure | (low != 0.0)))
        low, unsure = low[numbers], unsure[numbers]
        uv, points, radius = (
            np.tile(x, (len(numbers), 1)) for x in (self.uv, self.point, self.radius)
        )
        degrees, none = np.where(unsure, np.nan, low), np.zeros(len(numbers), np.bool_)
        return OnCreases(numbers, uv, points, degrees, radius, unsure, none, none)


class _Sides(NamedTuple):
    """Bounds of derivatives over k intervals of creases.

    `first` and `second` are x_w and x_ww / 2 along the crease, `before` and `after` are x_s on both
    sides. Each is a pair of vectors (k, 3): the value in the middle of the interval, and bounds of
    the differences from it.
    """

    first: tuple[Array, Array]
    second: tuple[Array, Array]
    before: tuple[Array, Array]
    after: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Creases:
    """Creases of a surface, cut into intervals.

    Each of the m creases has a row of `lines` (m, 4): the axis of the parameter that is constant on
    it (0 for u), the values of this parameter just before and after the crease, and the period of
    the parameter w along it, or 0. `spans` (m, 2) are the bounds of w. Each of the k intervals has
    the index of its crease in `rows` (k,), bounds of w in `ends` (k, 2), and bounds of derivatives
    in `sides`.
    """

    tape: Tape
    trim: Trim | None
    lines: Array
    spans: Array
    rows: Indices
    ends: Array
    sides: _Sides
    corners: Sequence[Corner]

    @classmethod
    def of(cls, surface: Surface) -> Creases | None:
        """Return the creases of a surface with a tape; None if there are none."""
        tape, lines, rows, ends = surface.tape, list[Array](), list[Indices](), list[Array]()
        spans = []
        for axis in (0, 1) if tape is not None else ():
            assert tape is not None
            other = np.array(surface.domain[1 - axis])
            closed = surface.boundary[1 - axis][0] == "periodic"
            for line in creases_of(tape, axis, surface.domain, surface.boundary):
                cuts = lines_of(tape, 1 - axis, other, PLACES)
                rows.append(np.full(len(cuts) - 1, len(lines)))
                ends.append(np.column_stack([cuts[:-1], cuts[1:]]))
                lines.append(np.array([axis, *line, np.ptp(other) if closed else 0.0]))
                spans.append(other)
        if tape is None or not lines:
            return None
        table, row, end = np.array(lines), np.concatenate(rows), np.concatenate(ends)
        bounds, trim = np.array(spans), surface.trim
        crossing = product(*(np.flatnonzero(table[:, 0] == axis).tolist() for axis in (0, 1)))
        corners = [Corner.of(tape, x, table[list(x)], bounds[list(x)]) for x in crossing]
        if trim is not None:
            corners = [x for x in corners if trim.contains(x.uv[None])[0]]
        return cls(tape, trim, table, bounds, row, end, _sides(tape, table[row], end), corners)

    def at(self, normals: Array) -> OnCreases:
        """Return the points of creases that have one of the unit normals (S, 3)."""
        numbers, rows, ends = self._intervals(normals)
        numbers, rows, ends = self._merged(numbers, rows, ends)
        given, middle = normals[numbers], ends.mean(axis=1)
        jets = [self._jets(rows, middle, side) for side in (1, 2)]
        axis = self.lines[rows, 0].astype(int)
        index = np.arange(len(rows))
        across = [x[index, 1 + axis] for x in jets]
        lengths = np.linalg.norm(across, axis=2)
        heights = [np.einsum("kjx,kx->jk", x, given) for x in jets]
        slopes = np.array([x[1 + axis, index] for x in heights])
        nearly, equal = (np.abs(slopes) <= x * lengths for x in (NEARLY, ROUNDING))
        facing = sum(
            np.einsum("kx,kx->k", unit_or_zero(np.cross(x[:, 1], x[:, 2])), given) for x in jets
        )
        unsure, between = nearly.any(axis=0), slopes[0] * slopes[1] < 0.0
        keep = (facing > 0.0) & (unsure | between)
        # At a pole x_s is 0: creases that end there have no direction across.
        largest = np.linalg.norm(self.sides.after[0], axis=1).max()
        keep &= np.minimum(*lengths) > SMOOTH * largest
        uv = self._uv(rows, middle, 2)
        if self.trim is not None:
            keep &= self.trim.contains(uv)
        convex = np.sign(slopes[0] - slopes[1])
        degrees = convex * self._turning(rows, ends, given)
        radius = np.outer(np.ptp(ends, axis=1) / 2.0, [1.0, 1.0])
        radius[index, axis] = 0.0
        for corner in self.corners:
            keep &= ~corner.is_near(rows, middle, self.lines[:, 3])
        of_sides = np.where(nearly[0], *(np.sign(x[3] * x[5] - x[4] ** 2) for x in heights))
        paired = of_sides == -degrees
        alone = np.where(equal.any(axis=0), ~paired, between)
        found = OnCreases(numbers, uv, jets[1][:, 0], degrees, radius, unsure, paired, alone)
        found = OnCreases._make(x[keep] for x in found)
        if not self.corners:
            return found
        parts = [found, *(x.at(normals) for x in self.corners)]
        found = OnCreases._make(np.concatenate(x) for x in zip(*parts, strict=True))
        return OnCreases._make(x[np.argsort(found.numbers, kind="stable")] for x in found)

    def besides(self, found: Samples, normals: Array) -> OnCreases:
        """Return the points of creases at unit normals that are not among the samples `found`.

        A point of a crease may be among the samples if its normal is that of one side, or if it is
        in the box of an isolated point. The samples have the fields `component`, `points` and
        `uv_radius`.
        """
        at, kinds, errors = self.at(normals), found.component, found.uv_radius
        assert kinds is not None
        assert errors is not None
        tangents = np.concatenate([self.sides.first[0], self.sides.after[0]])
        errors = 4.0 * np.linalg.norm(tangents, axis=1).max() * np.nan_to_num(errors.max(axis=1))
        keep = np.ones(len(at.numbers), np.bool_)
        size = np.ptp(self._jets(self.rows, self.ends[:, 0], 2)[:, 0], axis=0).max()
        special = found.normal_index[(kinds != Component.REGULAR) & (kinds != Component.CREASE)]
        for k in np.flatnonzero(at.unsure | np.isin(at.numbers, special)).tolist():
            own = (found.normal_index == at.numbers[k]) & (kinds != Component.CREASE)
            regular = kinds[own] == Component.REGULAR
            reach = np.where(regular, BESIDE * size + errors[own], APART * size)
            near = np.abs(found.points[own] - at.points[k]).max(axis=1) <= reach
            if (near & ~regular).any() or (at.unsure[k] & (kinds[own] == Component.CURVE)).any():
                keep[k] = np.isnan(at.degrees[k])
            elif at.unsure[k]:
                keep[k] = np.isnan(at.degrees[k]) or (
                    at.paired[k] if (near & regular).any() else at.alone[k]
                )
        return OnCreases._make(x[keep] for x in at)

    def _intervals(self, normals: Array) -> tuple[Indices, Indices, Array]:
        """Return intervals (k, 2) of w with a zero of n·x_w, for the normals (S, 3).

        The first two results (k,) are the index of the normal and that of the crease.
        """
        found: list[tuple[Indices, Indices, Array]] = []
        size = max(PRODUCTS_AT_A_TIME // len(self.rows), 1)
        for first in range(0, len(normals), size):
            some = normals[first : first + size]
            middle, error = self.sides.first
            error = error + SMOOTH * np.linalg.norm(middle, axis=1, keepdims=True)
            number, interval = np.nonzero(np.abs(some @ middle.T) <= np.abs(some) @ error.T)
            sides = _Sides._make((x[0][interval], x[1][interval]) for x in self.sides)
            rows, ends = self.rows[interval], self.ends[interval]
            while True:
                given, width = some[number], np.ptp(ends, axis=1)
                value, change, slack = _product(given, sides.first)
                bend, more, rounding = _product(given, sides.second)
                change = np.minimum(change, width * (np.abs(bend) + more))
                keep = (np.abs(value) <= change + slack) & _may_be_between(given, sides)
                one = np.abs(bend) > more + rounding
                small = (change <= slack) | (width <= SMOOTH * np.ptp(self.spans[rows], axis=1))
                several, small = keep & ~one & ~small, keep & ~one & small
                at = np.flatnonzero(keep & one)
                zeros, known, settled = self._zeros(rows[at], ends[at], given[at])
                found.append((first + number[at[known]], rows[at[known]], zeros[known]))
                several[at[~settled]] = True
                of_normal = np.bincount(number[several], minlength=len(some))
                straight = several & (of_normal[number] > MANY)
                small |= straight & (np.abs(value) <= slack)
                found.append((first + number[small], rows[small], ends[small]))
                several &= ~straight
                number, rows, ends = number[several], rows[several], ends[several]
                if len(number) == 0:
                    break
                middle = ends.mean(axis=1)
                ends = np.stack([ends[:, 0], middle, middle, ends[:, 1]], axis=1).reshape(-1, 2)
                number, rows = np.repeat(number, 2), np.repeat(rows, 2)
                sides = _sides(self.tape, self.lines[rows], ends)
        numbers, rows, ends = (np.concatenate(x) for x in zip(*found, strict=True))
        return numbers, rows, ends

    def _zeros(self, rows: Indices, ends: Array, normals: Array) -> tuple[Array, Flags, Flags]:
        """Return the zeros of n·x_w in intervals (k, 2) where it is monotonic, and two masks (k,).

        A zero is returned as an interval of length 0. The first mask is False where there is none
        or where it was not reached, the second one only where it was not reached.
        """
        low, high = ends.T
        following = at = 0.5 * (low + high)
        along = 2 - self.lines[rows, 0].astype(int)
        index = np.arange(len(rows))
        known = np.ones(len(rows), np.bool_)
        for _ in range(STEPS):
            at = following
            jets = self._jets(rows, at, 2)
            tangents, bends = jets[index, along], jets[index, np.array(SECOND)[along - 1]]
            value, slope = (np.einsum("kx,kx->k", x, normals) for x in (tangents, bends))
            known = np.abs(value) <= SMOOTH * np.linalg.norm(tangents, axis=1)
            following = np.clip(at - value / slope, low, high)
        return np.stack([following, following], axis=1), known, known | (following == at)

    def _merged(
        self, numbers: Indices, rows: Indices, ends: Array
    ) -> tuple[Indices, Indices, Array]:
        """Return the intervals, after joining close ones of the same normal and crease.

        Close means a gap of at most APART; intervals on different sides of a corner stay apart.
        """
        order = np.lexsort((ends[:, 0], rows, numbers))
        numbers, rows, ends = numbers[order], rows[order], ends[order]
        slack = APART * np.ptp(self.spans[rows], axis=1)
        arcs = self._arcs(rows, ends.mean(axis=1))[0]
        same = (numbers[1:] == numbers[:-1]) & (rows[1:] == rows[:-1]) & (arcs[1:] == arcs[:-1])
        starts = np.append(True, ~(same & (ends[1:, 0] <= ends[:-1, 1] + slack[1:])))[: len(rows)]
        firsts = np.flatnonzero(starts)
        lasts = np.append(firsts, len(rows))[1:] - 1
        numbers, rows, arcs = numbers[firsts], rows[firsts], arcs[firsts]
        ends = np.stack([ends[firsts, 0], ends[lasts, 1]], axis=1)
        # On a closed crease without a corner at its ends, the last interval may be close to the
        # first one.
        period, slack = self.lines[rows, 3], slack[firsts]
        keep = np.ones(len(rows), np.bool_)
        near = (ends[:, 0] <= self.spans[rows, 0] + slack) & (arcs == 0)
        begins = np.flatnonzero((period > 0.0) & near)
        for k in begins.tolist():
            group = np.flatnonzero((numbers == numbers[k]) & (rows == rows[k]))
            last, corners = group[-1], sum(int(rows[k] in x.lines) for x in self.corners)
            at_end = arcs[last] == corners and ends[last, 1] >= self.spans[rows[k], 1] - slack[k]
            if last != k and at_end:
                ends[last, 1] = ends[k, 1] + period[k]
                keep[k] = False
        return numbers[keep], rows[keep], ends[keep]

    def _turning(self, rows: Indices, ends: Array, normals: Array) -> Array:
        """For each interval, return whether the height n·x has an extremum along the crease there.

        The result is 1 for a maximum, −1 for a minimum, and 0 for neither.
        """
        step = APART * np.ptp(self.spans[rows], axis=1)
        signs, between = [], self._arcs(rows, ends.mean(axis=1))[1].T
        for at in (ends[:, 0] - step, ends[:, 1] + step):
            at, (low, high) = np.clip(at, *between), self.spans[rows].T
            turns = np.floor((at - low) / (high - low)) * self.lines[rows, 3]
            at = np.clip(at - turns, low, high)
            jets = self._jets(rows, at, 2)
            along = jets[np.arange(len(rows)), 2 - self.lines[rows, 0].astype(int)]
            signs.append(np.sign(np.einsum("kx,kx->k", along, normals)))
        return 0.5 * (signs[0] - signs[1])

    def _arcs(self, rows: Indices, along: Array) -> tuple[Indices, Array]:
        """Return which arc of a crease, between corners, contains each of the parameters w (k,).

        The first result (k,) is the index of the arc, counted along the crease; the second one
        (k, 2) has the bounds of the arc.
        """
        arcs, ends = np.zeros(len(rows), np.int64), np.tile([-np.inf, np.inf], (len(rows), 1))
        for line in np.unique(np.array([x.lines for x in self.corners], np.int64)).tolist():
            axis, own = int(self.lines[line, 0]), rows == line
            of_line = self.lines[[x.lines[1 - axis] for x in self.corners if line in x.lines]]
            low, high = np.sort(of_line[:, 1]), np.sort(of_line[:, 2])
            arcs[own] = np.searchsorted(high, along[own])
            ends[own, 0] = np.append(-np.inf, high)[arcs[own]]
            ends[own, 1] = np.append(low, np.inf)[np.searchsorted(low, along[own])]
        return arcs, ends

    def _uv(self, rows: Indices, along: Array, side: int) -> Array:
        """Return u and v (k, 2) just before creases (`side` is 1) or just after them (`side` is 2).

        `rows` (k,) are the indices of the creases, `along` (k,) the parameters w.
        """
        is_u, fixed = self.lines[rows, 0] == 0.0, self.lines[rows, side]
        low, high = self.spans[rows].T
        along = along - np.floor((along - low) / (high - low)) * self.lines[rows, 3]
        return np.where(is_u[:, None], np.stack([fixed, along], 1), np.stack([along, fixed], 1))

    def _jets(self, rows: Indices, along: Array, side: int) -> Array:
        """Return the 2-jets (k, 6, 3) just before or after creases, see `_uv`."""
        return jets_of(self.tape, *self._uv(rows, along, side).T.copy())


def _sides(tape: Tape, lines: Array, ends: Array) -> _Sides:
    """Return bounds of derivatives over intervals (k, 2) of creases with rows `lines` (k, 4)."""
    axis, index = lines[:, 0].astype(int), np.arange(len(lines))
    middle, half = ends.mean(axis=1), np.ptp(ends, axis=1) / 2.0
    of_sides = []
    for k in (1, 2):
        centres, widths = np.zeros((2, len(lines), 2))
        centres[index, axis], centres[index, 1 - axis], widths[index, 1 - axis] = (
            lines[:, k], middle, half
        )  # fmt: skip
        of_sides.append(bounds_over_boxes(tape, centres, widths))
    below, above = of_sides

    def of(bounds: Array, order: Indices) -> tuple[Array, Array]:
        found = np.moveaxis(bounds, 1, 0)[:, index, order]
        return found[0], found[1] * (1.0 + 1e-12)

    second = np.array(SECOND)[1 - axis]
    return _Sides(of(above, 2 - axis), of(above, second), of(below, 1 + axis), of(above, 1 + axis))


def _may_be_between(normals: Array, sides: _Sides) -> Flags:
    """Return a mask (k,): whether n·x_s may be 0 on a side, or have different signs on both."""
    before, after = (_product(normals, x) for x in (sides.before, sides.after))
    zero = [np.abs(value) <= error + slack for value, error, slack in (before, after)]
    return zero[0] | zero[1] | (before[0] * after[0] < 0.0)


def _product(normals: Array, bounds: tuple[Array, Array]) -> tuple[Array, Array, Array]:
    """Return products n·x for the middle values of k vectors x, and bounds of two kinds of errors.

    The first bounds (k,) are for all values of x, the others for n, which is known up to `SMOOTH`.
    """
    middle, error = bounds
    return (
        np.einsum("kx,kx->k", normals, middle), np.einsum("kx,kx->k", np.abs(normals), error),
        SMOOTH * np.linalg.norm(middle, axis=1),
    )  # fmt: skip
