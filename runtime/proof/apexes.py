"""Apexes: sides of the domain that are one point, and normals that no point near them has.

On such a side u = u₁, x_v = 0. By the mean value theorem n·x_v(u, v) = (u − u₁) n·x_uv(ξ, v) with ξ
between u₁ and u. So a point with the normal n near the side, but not on it, has n·x_u = 0, and
n·x_uv = 0 at some ξ.
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


@dataclass(frozen=True, eq=False)
class Apex:
    """A side of a domain that is one point of the surface: there u (axis 0) or v (axis 1) is `end`.

    `tape` is the tape of the surface, from which bounds over boxes near the side come.
    """

    tape: Tape
    axis: int
    end: float

    def decided(self, open_: Undecided, normals: Array) -> Undecided:
        """Return undecided boxes, except those at the side without a point with their normal.

        `numbers` of boxes are rows of `normals` (S, 3).
        """
        low, high = 2 * self.axis, 2 * self.axis + 1
        keep = (open_.boxes[:, low] > self.end) | (open_.boxes[:, high] < self.end)
        (beside,) = np.nonzero(~keep)
        for first in range(0, len(beside), BOXES_AT_A_TIME):
            rows = beside[first : first + BOXES_AT_A_TIME]
            keep[rows] = self._may_have_points(open_.boxes[rows], normals[open_.numbers[rows]])
        return Undecided._make(x[keep] for x in open_)

    def _may_have_points(self, boxes: Array, normals: Array) -> Flags:
        """Return whether boxes (k, 4) that touch the side may have points with normals (k, 3)."""
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


def apexes_of(tape: Tape, domain: Domain) -> tuple[Apex, ...]:
    """Return the sides of a domain that are one point up to rounding."""
    sides = [(axis, end) for axis in (0, 1) for end in domain[axis]]
    points = np.stack([_points_of_side(tape, domain, *x) for x in sides])
    slack = ROUNDINGS * np.spacing(np.fmax.reduce(np.abs(points), axis=None))
    with np.errstate(invalid="ignore"):  # no differences of infinite coordinates
        is_point = np.ptp(points, axis=1).max(axis=1) <= slack
    return tuple(Apex(tape, *x) for x, yes in zip(sides, is_point.tolist(), strict=True) if yes)


def _points_of_side(tape: Tape, domain: Domain, axis: int, end: float) -> Array:
    """Return points (PLACES, 3) on the side where u (axis 0) or v (axis 1) is `end`."""
    places = [np.full(PLACES, end), np.linspace(*domain[1 - axis], PLACES)]
    return jets_of(tape, *(places if axis == 0 else places[::-1]))[:, 0]
