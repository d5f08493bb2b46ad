"""Apexes, sides of the domain or lines inside that are one point, and normals absent near them.

On such a line u = u₁, x_v = 0. By the mean value theorem n·x_v(u, v) = (u − u₁) n·x_uv(ξ, v) with ξ
between u₁ and u, on both sides of a line. So a point with the normal n near the line, but not on
it, has n·x_u = 0, and n·x_uv = 0 at some ξ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Flags
from ..domain.domain import Domain
from ..tape.kernels.points import Tape
from ..tape.tapes import bounds_over_boxes, jets_of
from .components import Undecided

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


@dataclass(frozen=True, eq=False)
class Apex:
    """A line that is one point of the surface: there u (axis 0) or v (axis 1) is `end`.

    The line is a side of the domain, or `inside`; `end` may have a rounding `error`. The tape of
    the surface gives bounds over boxes beside the line. The `period` of parameter `axis` is 0 if
    there is none.
    """

    tape: Tape
    axis: int
    end: float
    inside: bool = False
    error: float = 0.0
    period: float = 0.0

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
        keep = (low > last) | (high < first)
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
    found = [Apex(tape, *x) for x in lines[:sides]]
    for axis, x in lines[sides:]:
        error = ROUNDINGS * float(np.spacing(np.abs(domain[axis]).max()))
        found.append(Apex(tape, axis, x, True, error, float(periods[axis])))
    return tuple(x for x, yes in zip(found, is_point.tolist(), strict=True) if yes)


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
