"""The poles of a surface: each has a disc or a cap, or nothing is known of it.

In a disc the surface is a graph over its tangent plane (`discs.py`). A cap is a strip of parameters
around a pole without a disc; only its normals have bounds. At a pole r = 0 the derivative x_u
around it vanishes, so that each coordinate of x_u (u, r) is r x_ur (u, ρ) with some ρ between 0 and
r. Therefore the normals in the strip lie in a cone that contains all vectors x_ur × x_r.
"""

from typing import NamedTuple

import numpy as np

from ..base.aliases import Array
from ..domain.domain import Boundary, Domain
from ..tape.kernels.points import Tape
from ..tape.tapes import bounds_over_boxes, jets_of
from .ball import Ball, cross
from .discs import NARROW, SECTORS, PoleDisc, pole_disc
from .kernels.answers import CURVE, OPEN_BOX, Answers

# The largest half angle of the cone of a cap, in radians; and the smallest size of a cap, relative
# to a row of cells.
WIDEST, SMALLEST = 0.05, 2.0**-8
# The positions of Taylor coefficients.
U1, V1, U1V1 = 1, 2, 4
ROUNDING = 2.0**-40
# A cap counts as lying in a plane if its normals at PLACES² points differ by at most SMOOTH.
PLACES, SMOOTH = 16, 1e-9


class Cap(NamedTuple):
    """A box u₀, u₁, v₀, v₁ of parameters around a pole, its size, and a cone with all its normals.

    A cap in a plane is a region with a constant normal: its `kind` is CURVE. Other caps are
    undecided boxes for the normals in their cone.
    """

    box: Array
    size: float
    axis: Array
    angle: float
    kind: int = OPEN_BOX

    def answers(self, normals: Array) -> Answers:
        """Return the box of the cap as the answer for each unit normal of (S, 3) in the cone."""
        away = np.linalg.norm(normals - self.axis, axis=1)
        numbers = np.flatnonzero(away <= 2.0 * np.sin(0.5 * self.angle) + ROUNDING)
        row = np.array([*self.box, 0.0, *self.box.reshape(2, 2).mean(axis=1)])
        boxes, kinds = np.tile(row, (len(numbers), 1)), np.full(len(numbers), self.kind)
        return Answers.new(0)._replace(open_boxes=boxes, kinds=kinds, open_numbers=numbers)


class Poles(NamedTuple):
    """The discs and caps around poles, and the domain `inside` (2, 2) without these.

    A pole with neither disc nor cap is a box in `unknown` (k, 4), of which nothing is known.
    """

    discs: tuple[PoleDisc, ...]
    caps: tuple[Cap, ...]
    inside: Array
    unknown: Array


def poles_of(tape: Tape, domain: Domain, boundary: Boundary, cells: tuple[int, int]) -> Poles:
    """Return the discs and caps around the poles of a surface.

    Their sizes are at most those of the m × n `cells` of the domain. Open sides that are collapsed
    to a smooth pole have discs, too.
    """
    discs, caps, unknown = list[PoleDisc](), list[Cap](), list[list[float]]()
    inside = np.array(domain, dtype=np.float64)
    for axis, ends in enumerate(boundary):
        low, high = domain[axis]
        row = (high - low) / cells[axis]
        for k, end in enumerate(ends):
            if end not in ("pole", "open") or boundary[1 - axis][0] != "periodic":
                continue
            at, size = domain[axis][k], 0.0
            disc = pole_disc(tape, domain, 1 - axis, at, row)
            cap = (
                _cap_of(tape, domain, 1 - axis, at, row) if disc is None and end == "pole" else None
            )
            if disc is not None:
                discs.append(disc)
                size = disc.radius
            elif cap is not None:
                caps.append(cap)
                size = cap.size
            elif end == "pole":
                sides = [list(x) for x in domain]
                sides[axis] = [at] * 2
                unknown.append([*sides[0], *sides[1]])
            inside[axis, k] += size if k == 0 else -size
    return Poles(tuple(discs), tuple(caps), inside, np.array(unknown).reshape(-1, 4))


def _cap_of(tape: Tape, domain: Domain, angle: int, end: float, size: float) -> Cap | None:
    """Return the cap around a pole, of at most `size`; None if its normals have no bounds.

    `angle` is the index of the parameter that runs around the pole; the other parameter has the
    value `end` at the pole.
    """
    inward = 1.0 if end == domain[1 - angle][0] else -1.0
    smallest = SMALLEST * size
    while size >= smallest:
        cone = _cone(tape, domain, angle, (end, inward), size)
        if cone is not None and cone[1] <= WIDEST:
            sides = [list(x) for x in domain]
            sides[1 - angle] = sorted((end, end + inward * size))
            box = np.array([*sides[0], *sides[1]])
            normals = _normals_in(tape, box)
            if np.linalg.norm(normals - normals[0], axis=1).max() <= SMOOTH:
                return Cap(box, size, normals[0], SMOOTH, CURVE)
            return Cap(box, size, *cone)
        size *= 0.5
    return None


def _normals_in(tape: Tape, box: Array) -> Array:
    """Return the unit normals (PLACES², 3) at a grid of points in a box."""
    parts = (np.arange(PLACES) + 0.5) / PLACES
    u, v = (low + (high - low) * parts for low, high in box.reshape(2, 2))
    jets = jets_of(tape, np.repeat(u, PLACES), np.tile(v, PLACES))
    normals = np.cross(jets[:, 1], jets[:, 2])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _cone(
    tape: Tape, domain: Domain, angle: int, side: tuple[float, float], size: float
) -> tuple[Array, float] | None:
    """Return axis and half angle of a cone with all normals of a strip; None if there is none.

    `side` has the value at the pole of the parameter towards it, and 1 if this parameter increases
    away from the pole, or −1 if it decreases; `size` is the width of the strip.
    """
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
    normal = cross(first, second)
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
