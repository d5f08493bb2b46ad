"""Sides of the domain of a face that are one point: no point beside them has a certain normal.

If u = u₁ is such a side, x_v is 0 on it. So, for each n, n·x_v = (u − u₁) n·x_uv with x_uv at some
position between, and a point beside the side with normal n has n·x_u = 0, and n·x_uv = 0 somewhere
between it and the side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.proof.index import Undecided
from ...runtime.surface.surface import Surface
from ...runtime.tape.kernels.points import Tape
from ...runtime.tape.tapes import bounds_over_boxes

__all__ = ["Apex", "apexes_of"]

Array = NDArray[np.float64]

# A side of the domain is mapped to one point if the points at PLACES parameters along it differ
# by at most ROUNDINGS units in the last place of the largest coordinate of all sides. The
# coordinates of the point itself are no measure: near the origin they are small, but their rounding
# errors are not.
PLACES, ROUNDINGS = 17, 64.0
MIXED = 4  # the index of the coefficient of u v in Taylor polynomials; those of u and v are 1 and 2


@dataclass(frozen=True, eq=False)
class Apex:
    """A side of a domain that is one point of the surface: there u (axis 0) or v (axis 1) is `end`.

    The tape of the surface gives bounds over boxes beside it.
    """

    tape: Tape
    axis: int
    end: float

    def decided(self, open_: Undecided, normals: Array) -> Undecided:
        """Return undecided boxes without those at the side that have no point with their normal.

        The normals (S, 3) are those of the search, to which the numbers of boxes belong.
        """
        low, high = 2 * self.axis, 2 * self.axis + 1
        # The boxes that touch the side.
        (rows,) = np.nonzero((open_.boxes[:, low] <= self.end) & (open_.boxes[:, high] >= self.end))
        if not len(rows):
            return open_
        boxes = open_.boxes[rows].reshape(-1, 2, 2)
        half = (boxes[:, :, 1] - boxes[:, :, 0]) / 2.0
        bounds = bounds_over_boxes(self.tape, boxes.mean(axis=2), half)
        given = normals[open_.numbers[rows]]
        none = np.zeros(len(rows), np.bool_)
        for order in (1 + self.axis, MIXED):
            value = np.einsum("kx,kx->k", bounds[:, 0, order], given)
            reach = np.einsum("kx,kx->k", bounds[:, 1, order], np.abs(given))
            size = np.einsum("kx,kx->k", np.abs(bounds[:, 0, order]), np.abs(given))
            none |= np.abs(value) > reach * (1.0 + 1e-12) + 1e-15 * size
        keep = np.ones(len(open_.numbers), np.bool_)
        keep[rows[none]] = False
        return Undecided._make(x[keep] for x in open_)


def apexes_of(surface: Surface, tape: Tape) -> list[Apex]:
    """Return the sides of a surface that are one point up to rounding."""
    sides = [(axis, end) for axis in (0, 1) for end in surface.domain[axis]]
    points = np.stack([_points_of_side(surface, *x) for x in sides])
    slack = ROUNDINGS * np.spacing(np.fmax.reduce(np.abs(points), axis=None))
    is_point = np.ptp(points, axis=1).max(axis=1) <= slack
    return [Apex(tape, *x) for x, yes in zip(sides, is_point.tolist(), strict=True) if yes]


def _points_of_side(surface: Surface, axis: int, end: float) -> Array:
    """Return points (PLACES, 3) on the side where u (axis 0) or v (axis 1) is `end`."""
    places = [np.full(PLACES, end), np.linspace(*surface.domain[1 - axis], PLACES)]
    return surface.jets(*(places if axis == 0 else places[::-1]))[:, 0]
