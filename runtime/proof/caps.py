"""Caps: strips of parameters around poles without a disc, where nothing but normals is known.

At a pole r = 0 the derivative around it vanishes: x_u (u, r) = r x_ur (u, ρ) with some ρ between 0
and r for each coordinate. So the normals lie in the cone of the vectors x_ur × x_r over the strip.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.aliases import Array, Indices
from ..domain.domain import Domain
from ..tape.kernels.points import Tape
from ..tape.tapes import bounds_over_boxes
from .ball import Ball
from .discs import NARROW, SECTORS

__all__ = ["Cap", "cap_of"]

# A cap has at most this half angle, in radians, and at least this part of a given size.
WIDEST, SMALLEST = 0.05, 2.0**-8
# The positions of Taylor coefficients.
U1, V1, U1V1 = 1, 2, 4
ROUNDING = 2.0**-40


class Cap(NamedTuple):
    """A box of parameters u₀, u₁, v₀, v₁ around a pole; its size; and a cone of its normals."""

    box: Array
    size: float
    axis: Array
    angle: float

    def holds(self, normals: Array) -> Indices:
        """Return the indices of those unit normals (S, 3) that points of the cap may have."""
        away = np.linalg.norm(normals - self.axis, axis=1)
        return np.flatnonzero(away <= 2.0 * np.sin(0.5 * self.angle) + ROUNDING)


def cap_of(tape: Tape, domain: Domain, angle: int, end: float, size: float) -> Cap | None:
    """Return the cap around a pole of at most some size; None if its normals are not bounded.

    Parameter `angle` (0 or 1) runs around the pole, the other one is `end` there.
    """
    inward = 1.0 if end == domain[1 - angle][0] else -1.0
    smallest = SMALLEST * size
    while size >= smallest:
        cone = _cone(tape, domain, angle, (end, inward), size)
        if cone is not None and cone[1] <= WIDEST:
            sides = [list(x) for x in domain]
            sides[1 - angle] = sorted((end, end + inward * size))
            return Cap(np.array([*sides[0], *sides[1]]), size, *cone)
        size *= 0.5
    return None


def _cone(
    tape: Tape, domain: Domain, angle: int, side: tuple[float, float], size: float
) -> tuple[Array, float] | None:
    """Return axis and half angle of a cone of the normals of a strip; None if there is none."""
    (low, high), (end, inward), count = domain[angle], side, NARROW * SECTORS
    half = np.array([0.5 * (high - low) / count, 0.5 * size])
    around = low + half[0] * (2.0 * np.arange(count) + 1.0)
    centres = np.column_stack([around, np.full(count, end + inward * half[1])])
    widths = np.broadcast_to(half * (1.0 + ROUNDING), centres.shape)
    if angle == 1:
        centres, widths = centres[:, ::-1], widths[:, ::-1]
    bounds = bounds_over_boxes(tape, np.ascontiguousarray(centres), np.array(widths), 3)
    across, mixed = (
        [Ball(bounds[:, 0, k, x], bounds[:, 1, k, x]) for x in range(3)]
        for k in (V1 if angle == 0 else U1, U1V1)
    )
    first, second = (mixed, across) if angle == 0 else (across, mixed)
    normal = [
        first[(k + 1) % 3] * second[(k + 2) % 3] - first[(k + 2) % 3] * second[(k + 1) % 3]
        for k in range(3)
    ]
    middle = inward * np.stack([x.middle for x in normal], axis=1)
    radius = np.linalg.norm([x.radius for x in normal], axis=0)
    lengths = np.linalg.norm(middle, axis=1)
    if not (radius < lengths).all():
        return None
    directions = middle / lengths[:, None]
    axis = directions.sum(axis=0)
    axis /= np.linalg.norm(axis)
    chords = np.minimum(np.linalg.norm(directions - axis, axis=1), 2.0)
    angles = 2.0 * np.arcsin(0.5 * chords) + np.arcsin(radius / lengths)
    return axis, float(angles.max()) + ROUNDING
