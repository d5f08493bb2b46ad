"""Apexes, sides of the domain or lines inside that are one point, and normals absent near them.

On such a line u = u₁, x_v = 0. By the mean value theorem n·x_v(u, v) = (u − u₁) n·x_uv(ξ, v) with ξ
between u₁ and u, on both sides of a line. So a point with the normal n near the line, but not on
it, has n·x_u = 0, and n·x_uv = 0 at some ξ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..domain.domain import Domain
from ..tape.kernels.points import Tape
from ..tape.tapes import bounds_over_boxes, jets_of
from .components import Undecided
from .kernels.answers import OPEN_BOX
from .kernels.cell_bounds import SMOOTH

__all__ = ["Apex", "apexes_of"]

# A side of the domain is mapped to one point if PLACES points along it agree up to ROUNDINGS units
# in the last place of the largest coordinate of all sides. The coordinates of the point itself do
# not serve as a scale: near the origin they are small, but their rounding errors are not.
PLACES, ROUNDINGS = 17, 64.0
MIXED = 4  # the index of the coefficient of u v in Taylor polynomials; those of u and v are 1 and 2
BOXES_AT_A_TIME = 1 << 14  # 8 MB of bounds
# Lines inside of the domain that are one point are searched between LINES equidistant lines. Their
# distance from the side is this part of a step, so that none of them is likely to be one point.
LINES, SHIFT = 32, 0.381966
# Boxes are beside a line up to this distance, relative to the domain.
BESIDE = 1e-6
# A box beside a side with one normal holds that point only if it is SMALL, relative to the domain,
# and the normals at its other side, or at the distance LEAST, differ from it by up to WIDE. The
# normal at the side is known up to ONE.
SMALL, LEAST, WIDE, ONE = 1e-2, 1e-5, 0.5, 4.0 * SMOOTH


@dataclass(frozen=True, eq=False)
class Apex:
    """A line that is one point of the surface: there u (axis 0) or v (axis 1) is `end`.

    The line is a side of the domain, or `inside`; `end` may have a rounding `error`. The tape of
    the surface gives bounds over boxes beside the line. `period` is that of the parameter, or
    0. The `normal` of a side is None if several places of it have different ones.
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
        """Return undecided boxes without those whose only point is a side with one normal.

        These sides have rows (k, 6) of places, see `ProvedPlaces`, and numbers (k,) of normals. So
        it is where a surface does not go all the way around a pole. Boxes with other normals are
        left out. At the far ends of the boxes normals are different, and K has one sign.
        """
        sides = open_.boxes.reshape(-1, 2, 2)
        away = np.abs(sides[:, self.axis] - self.end)
        if self.normal is None:
            return open_, np.empty((0, 6)), np.empty(0, np.int64)
        size = np.ptp(self.domain[self.axis])
        near = (away.min(axis=1) <= BESIDE * size) & (away.max(axis=1) <= SMALL * size)
        apart = np.linalg.norm(normals[open_.numbers] - self.normal, axis=1)
        rows, found, keep = list[Array](), dict[int, float](), np.ones(len(near), np.bool_)
        kinds = open_.kinds.copy()
        for k in np.flatnonzero(near).tolist():
            reach = max(away[k].max(), LEAST * size)
            beside, signs = self._beside(reach)
            turned = np.linalg.norm(beside - self.normal, axis=1)
            if turned.max() > WIDE or turned.min() <= 4.0 * ONE or (signs != signs[0]).any():
                continue
            kinds[k] = OPEN_BOX  # gradients are small everywhere: they are no sign of a curve
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
        """Return normals (k, 3), and the signs (k,) of K, at a distance from the side."""
        inward = 1.0 if self.end == self.domain[self.axis][0] else -1.0
        at = np.array([self.end + inward * reach])
        jets = _jets_on(self.tape, self.domain, self.axis, at)[0]
        normals = np.cross(jets[:, 1], jets[:, 2])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        a, b, c = np.einsum("kjx,kx->jk", jets[:, 3:], normals)
        return normals, np.sign(a * c - b * b)

    def decided(self, open_: Undecided, normals: Array) -> Undecided:
        """Return undecided boxes without those at the line that have no point with their normal.

        The normals (S, 3) are those to which `open_.numbers` refer.
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
        (beside,) = np.nonzero(~keep)
        for first in range(0, len(beside), BOXES_AT_A_TIME):
            rows = beside[first : first + BOXES_AT_A_TIME]
            keep[rows] = self._may_have_points(sides[rows], normals[open_.numbers[rows]])
        return Undecided._make(x[keep] for x in open_)

    def _may_have_points(self, boxes: Array, normals: Array) -> Flags:
        """Return whether boxes (k, 4) that touch the line may have points with normals (k, 3)."""
        sides = boxes.reshape(-1, 2, 2)
        half = (sides[:, :, 1] - sides[:, :, 0]) / 2.0
        bounds = bounds_over_boxes(self.tape, sides.mean(axis=2), half)
        none = np.zeros(len(boxes), np.bool_)
        for order in (1 + self.axis, MIXED):
            value = np.einsum("kx,kx->k", bounds[:, 0, order], normals)
            reach = np.einsum("kx,kx->k", bounds[:, 1, order], np.abs(normals))
            size = np.einsum("kx,kx->k", np.abs(bounds[:, 0, order]), np.abs(normals))
            none |= np.abs(value) > reach * (1.0 + 1e-12) + 1e-15 * size
        return ~none


def apexes_of(tape: Tape, domain: Domain, periods: Array) -> tuple[Apex, ...]:
    """Return the sides of a domain, and lines inside, that are one point up to rounding.

    The periods (2,) of u and v are 0 if there are none.
    """
    lines = [(axis, end) for axis in (0, 1) for end in domain[axis]]
    sides = len(lines)
    lines += [(axis, x) for axis in (0, 1) for x in _reversals(tape, domain, axis, periods[axis])]
    points = np.stack([_jets_on(tape, domain, axis, np.array([x]))[0, :, 0] for axis, x in lines])
    slack = ROUNDINGS * np.spacing(np.fmax.reduce(np.abs(points), axis=None))
    with np.errstate(invalid="ignore"):  # infinity minus infinity
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
    """Return the normal at a side that is one point; None if its places have different ones."""
    jets = _jets_on(tape, domain, axis, np.array([end]))[0]
    with np.errstate(all="ignore"):
        normals = np.cross(jets[:, 1 + axis], jets[:, MIXED]) * (1.0 if axis == 0 else -1.0)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    is_one = np.linalg.norm(normals - normals[0], axis=1).max() <= SMOOTH
    return normals[0] * (1.0 if end == domain[axis][0] else -1.0) if is_one else None


def _reversals(tape: Tape, domain: Domain, axis: int, period: float) -> list[float]:
    """Return the u (axis 0) or v of inner lines across which tangents along lines are reversed.

    If a line is one point, and the lines beside it are not, the tangents along lines on one side of
    it are opposite to those on the other side.
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
    """Return jets (k, PLACES, 6, 3) on lines where u (axis 0) or v (axis 1) is one of `ends`."""
    across, along = np.meshgrid(ends, np.linspace(*domain[1 - axis], PLACES), indexing="ij")
    u, v = (across, along) if axis == 0 else (along, across)
    return jets_of(tape, u.ravel(), v.ravel()).reshape(len(ends), PLACES, 6, 3)
