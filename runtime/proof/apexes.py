"""Apexes: sides of the domain, and parameter lines inside it, that are collapsed to a point.

On a line u = u₁ that is collapsed to a point, x_v = 0. For u on either side of the line, the mean
value theorem says that n·x_v(u, v) = (u − u₁) n·x_uv(ξ, v) with some ξ between u₁ and u. Therefore
n·x_u(u, v) = 0 and n·x_uv(ξ, v) = 0 at a point (u, v) near the line that has the normal n. If
bounds over a box that touches the line exclude one of these zeros, or show that all normals are
more than 90° from n, the box has no point with this normal.
"""

from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..domain.domain import Domain
from ..spline.tips import SAME_POINT
from ..tape.kernels.points import Tape
from ..tape.tapes import bounds_over_boxes, jets_of
from .ball import Ball, cross
from .components import Undecided
from .kernels.answers import OPEN_BOX
from .kernels.cell_bounds import SMOOTH

# A line counts as collapsed if PLACES points along it agree up to ROUNDINGS units in the last place
# of the largest coordinate, plus SAME_POINT times the extent, of all sides and lines. The
# coordinates of the collapsed side alone give no scale: near the origin they are small, but their
# rounding errors are not.
PLACES, ROUNDINGS = 17, 64.0
MIXED = 4  # the index of the Taylor coefficient of u v; those of u and v are 1 and 2
BOXES_AT_A_TIME = 1 << 12  # 2 MB of bounds, or 64 MB if all boxes are cut
# A box beside a line is cut into ALONG parts if it is longer than 1/ALONG of the line, since the
# derivatives may turn by 360° along the line.
ALONG = 32
# Collapsed lines inside the domain are searched between LINES equidistant lines. The first of these
# lines is SHIFT steps from the side, so that it is unlikely that one of them is itself collapsed.
LINES, SHIFT = 32, 0.381966
# A box counts as beside a line if its distance is at most this, relative to the domain.
BESIDE = 1e-6
# Let a collapsed side have one normal. A box that touches the side has no point with this normal
# outside of the side if two conditions hold: the width of the box is at most SMALL, relative to the
# domain; the normals at the far side of the box (or at the distance LEAST, if that is farther)
# differ from the normal of the collapsed side, but by at most WIDE. The normal of the collapsed
# side has errors up to ONE.
SMALL, LEAST, WIDE, ONE = 1e-2, 1e-5, 0.5, 4.0 * SMOOTH


@dataclass(frozen=True, eq=False)
class Apex:
    """A line u = `end` (axis 0) or v = `end` (axis 1) that is collapsed to a point of the surface.

    The line is a side of the domain, or `inside` the domain; `end` may have a rounding `error`.
    `tape` is that of the surface; `period` is the period of the parameter that is constant on the
    line, or 0. `normal` is the limit of the normals at a side, or None if the limit is not the same
    all along the side.
    """

    tape: Tape
    domain: Domain
    axis: int
    end: float
    inside: bool = False
    error: float = 0.0
    period: float = 0.0
    normal: Array | None = None

    def at_pole(self, open_: Undecided, normals: Array) -> tuple[Undecided, Array, Indices]:
        """Return the remaining undecided boxes, and solutions at a collapsed side with one normal.

        Such a side occurs where a surface goes only part of the way around a smooth pole. The
        results are the remaining boxes, rows (k, 6) as in `ProvedPlaces.places`, and the indices
        (k,) of their normals. A box beside the side can be decided if the normals at its far side
        are different from the normal of the side, and K has one sign there. The box then contains
        the point of the side if the prescribed normal is that of the side. It contains no point if
        the prescribed normal differs from that of the side more than twice as much as the normals
        at the far side do. Otherwise the box remains undecided.
        """
        sides = open_.boxes.reshape(-1, 2, 2)
        away = np.abs(sides[:, self.axis] - self.end)
        size = np.ptp(self.domain[self.axis])
        near = (away.min(axis=1) <= BESIDE * size) & (away.max(axis=1) <= SMALL * size)
        kinds = open_.kinds.copy()
        if self.normal is None:
            kinds[near] = OPEN_BOX  # gradients are small everywhere here, not only on curves
            return open_._replace(kinds=kinds), np.empty((0, 6)), np.empty(0, np.int64)
        apart = np.linalg.norm(normals[open_.numbers] - self.normal, axis=1)
        rows, found, keep = list[Array](), dict[int, float](), np.ones(len(near), np.bool_)
        for k in np.flatnonzero(near).tolist():
            reach = max(away[k].max(), LEAST * size)
            beside, signs = self._beside(reach)
            turned = np.linalg.norm(beside - self.normal, axis=1)
            if turned.max() > WIDE or turned.min() <= 4.0 * ONE or (signs != signs[0]).any():
                continue
            kinds[k] = OPEN_BOX
            keep[k], number = ONE < apart[k] <= 2.0 * turned.max(), int(open_.numbers[k])
            if apart[k] <= ONE:
                found[number] = max(reach, abs(found.get(number, 0.0))) * signs[0]
        low, high = self.domain[1 - self.axis]
        for reach in found.values():
            row = np.array([[self.end, (low + high) / 2.0], [abs(reach), (high - low) / 2.0]])
            row = row if self.axis == 0 else row[:, ::-1]
            rows.append(np.array([*row.ravel(), np.sign(reach), 1.0]))
        left = Undecided._make(x[keep] for x in open_._replace(kinds=kinds))
        return left, np.array(rows).reshape(-1, 6), np.array(list(found), np.int64)

    def _beside(self, reach: float) -> tuple[Array, Array]:
        """Return unit normals (k, 3) and the signs (k,) of K at k points beside the line.

        The points are inside the domain, at the distance `reach` from the line.
        """
        inward = 1.0 if self.end == self.domain[self.axis][0] else -1.0
        at = np.array([self.end + inward * reach])
        jets = _jets_on(self.tape, self.domain, self.axis, at)[0]
        normals = np.cross(jets[:, 1], jets[:, 2])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        a, b, c = np.einsum("kjx,kx->jk", jets[:, 3:], normals)
        return normals, np.sign(a * c - b * b)

    def decided(self, open_: Undecided, normals: Array) -> Undecided:
        """Return the undecided boxes, without those beside the line that are proved to be empty.

        `open_.numbers` are indices of the normals (S, 3) of the query.
        """
        sides = open_.boxes.copy()
        low, high = sides.reshape(-1, 2, 2)[:, self.axis].T
        if self.period > 0.0:
            turns = self.period * np.rint((self.end - (low + high) / 2.0) / self.period)
            low, high = low + turns, high + turns
        first, last = self.end - self.error, self.end + self.error
        reach = BESIDE * np.ptp(self.domain[self.axis])
        keep = (low > last + reach) | (high < first - reach)
        sides[:, 2 * self.axis], sides[:, 2 * self.axis + 1] = (
            np.minimum(low, first), np.maximum(high, last),
        )  # fmt: skip
        along = 1 - self.axis
        lengths = sides[:, 2 * along + 1] - sides[:, 2 * along]
        (beside,) = np.nonzero(~keep)
        for first in range(0, len(beside), BOXES_AT_A_TIME):
            rows = beside[first : first + BOXES_AT_A_TIME]
            given = normals[open_.numbers[rows]]
            keep[rows] = self._may_have_points(sides[rows], given)
            wide = keep[rows] & (lengths[rows] > np.ptp(self.domain[along]) / ALONG)
            parts = _cut(sides[rows[wide]], along)
            given = np.repeat(given[wide], ALONG, axis=0)
            may = self._may_have_points(parts, given, sharply=not self.inside)
            keep[rows[wide]] = may.reshape(-1, ALONG).any(axis=1)
        return Undecided._make(x[keep] for x in open_)

    def _may_have_points(self, boxes: Array, normals: Array, sharply: bool = False) -> Flags:
        """Return whether boxes (k, 4) that touch the line may have points with normals (k, 3).

        With `sharply`, boxes at a side are also excluded if all their normals are more than 90°
        from the given one.
        """
        sides = boxes.reshape(-1, 2, 2)
        half = (sides[:, :, 1] - sides[:, :, 0]) / 2.0
        bounds = bounds_over_boxes(self.tape, sides.mean(axis=2), half)
        none = np.zeros(len(boxes), np.bool_)
        for order in (1 + self.axis, MIXED):
            value = np.einsum("kx,kx->k", bounds[:, 0, order], normals)
            reach = np.einsum("kx,kx->k", bounds[:, 1, order], np.abs(normals))
            size = np.einsum("kx,kx->k", np.abs(bounds[:, 0, order]), np.abs(normals))
            none |= np.abs(value) > reach * (1.0 + 1e-12) + 1e-15 * size
        return ~(none | self._is_opposite(bounds, normals)) if sharply else ~none

    def _is_opposite(self, bounds: Array, normals: Array) -> Flags:
        """Return whether all normals over boxes at a side are more than 90° from normals (k, 3).

        By the mean value theorem, x_u × x_v beside a side u = u₁ is (u − u₁) times a vector within
        the bounds of x_u × x_uv. Beside a side v = v₁ it is (v − v₁) times a vector within the
        bounds of x_uv × x_v.
        """
        first, second = (1, MIXED) if self.axis == 0 else (MIXED, 2)
        a, b = ([Ball(*bounds[:, :, k, x].T) for x in range(3)] for k in (first, second))
        x, y, z = (along * n for along, n in zip(cross(a, b), normals.T, strict=True))
        volume = x + y + z
        inward = 1.0 if self.end == self.domain[self.axis][0] else -1.0
        return np.asarray(inward * volume.middle < -volume.radius)


def _cut(boxes: Array, axis: int) -> Array:
    """Return the boxes (ALONG k, 4) into which boxes (k, 4) are cut along u (axis 0) or v."""
    low, high = boxes[:, 2 * axis, None], boxes[:, 2 * axis + 1, None]
    ends, parts = low + (high - low) * np.linspace(0.0, 1.0, ALONG + 1), boxes.repeat(ALONG, axis=0)
    ends[:, -1:] = high
    parts[:, 2 * axis], parts[:, 2 * axis + 1] = ends[:, :-1].ravel(), ends[:, 1:].ravel()
    return parts


def apexes_of(tape: Tape, domain: Domain, periods: Array) -> tuple[Apex, ...]:
    """Return the collapsed sides of a domain, and the collapsed lines inside the domain.

    They are collapsed up to rounding. `periods` (2,) are the periods of u and v, or 0.
    """
    lines = [(axis, end) for axis in (0, 1) for end in domain[axis]]
    sides = len(lines)
    lines += [(axis, x) for axis in (0, 1) for x in _reversals(tape, domain, axis, periods[axis])]
    points = np.stack([_jets_on(tape, domain, axis, np.array([x]))[0, :, 0] for axis, x in lines])
    slack = ROUNDINGS * np.spacing(np.fmax.reduce(np.abs(points), axis=None))
    with np.errstate(invalid="ignore"):  # infinity minus infinity
        size = np.fmax.reduce(points, axis=(0, 1)) - np.fmin.reduce(points, axis=(0, 1))
        slack += SAME_POINT * size.max()
        is_point = np.ptp(points, axis=1).max(axis=1) <= slack
    errors = [ROUNDINGS * float(np.spacing(np.abs(x).max())) for x in domain]
    found = [
        Apex(tape, domain, *x, error=errors[x[0]], normal=_normal(tape, domain, *x))
        for x in lines[:sides]
    ]
    for axis, x in lines[sides:]:
        found.append(Apex(tape, domain, axis, x, True, errors[axis], float(periods[axis])))
    return tuple(x for x, yes in zip(found, is_point.tolist(), strict=True) if yes)


def _normal(tape: Tape, domain: Domain, axis: int, end: float) -> Array | None:
    """Return the limit of the normals at a collapsed side; None if it varies along the side."""
    jets = _jets_on(tape, domain, axis, np.array([end]))[0]
    with np.errstate(all="ignore"):
        normals = np.cross(jets[:, 1 + axis], jets[:, MIXED]) * (1.0 if axis == 0 else -1.0)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    is_one = np.linalg.norm(normals - normals[0], axis=1).max() <= SMOOTH
    return normals[0] * (1.0 if end == domain[axis][0] else -1.0) if is_one else None


def _reversals(tape: Tape, domain: Domain, axis: int, period: float) -> list[float]:
    """Return the values of u (axis 0) or v of inner lines that may be collapsed.

    On both sides of a collapsed line, the tangents along parallel lines have opposite directions.
    Such reversals are searched.
    """
    low, high = domain[axis]
    places = low + (high - low) * (np.arange(LINES + (period > 0.0)) + SHIFT) / LINES

    def tangents(places: Array) -> Array:
        return _jets_on(tape, domain, axis, places)[:, :, 2 - axis]

    found, along = list[float](), tangents(places)
    with np.errstate(invalid="ignore"):
        turned = (np.einsum("kjx,kjx->kj", along[1:], along[:-1]) < 0.0).all(axis=1)
    for k in np.flatnonzero(turned).tolist():
        first, last = places[k : k + 2].tolist()
        while first < (middle := (first + last) / 2.0) < last:
            is_before = float((tangents(np.array([middle]))[0] * along[k]).sum()) > 0.0
            first, last = (middle, last) if is_before else (first, middle)
        found.append(first - (period if first > high else 0.0))
    return found


def _jets_on(tape: Tape, domain: Domain, axis: int, ends: Array) -> Array:
    """Return 2-jets (k, PLACES, 6, 3) on the lines where u (axis 0) or v is one of `ends` (k,)."""
    across, along = np.meshgrid(ends, np.linspace(*domain[1 - axis], PLACES), indexing="ij")
    u, v = (across, along) if axis == 0 else (along, across)
    return jets_of(tape, u.ravel(), v.ravel()).reshape(len(ends), PLACES, 6, 3)
