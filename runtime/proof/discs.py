"""Discs around the poles of a surface: bounds of the surface as a graph over its tangent plane.

Near a pole p the parameters are polar coordinates: u runs around the pole, and r = 0 is the pole.
The coordinates q1 and q2 of the tangent plane are chosen so that the curve x_r (u, 0) is as close
to a circle as possible; h is the height over the plane. The formulas of
`generated.jet.graph_at_pole` contain quotients by r. By Taylor's theorem they are derivatives, at
some ρ between 0 and r, of x and x_u, or of the spline (x − p) / r. Two conditions are checked only
at sampled points: h_r (u, 0) = 0, and that the surface has no creases.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...generated.jet import graph_at_pole, graph_slopes
from ..base.aliases import Array
from ..base.formula_calls import python_function
from ..domain.domain import Domain
from ..search.kernels.pieces import REST_S, REST_T
from ..tape.kernels.balls import BALL
from ..tape.kernels.points import Tape
from ..tape.kernels.rounding import rounding_of_boxes
from ..tape.tapes import bounds_over_boxes, jets_of, moved_tape
from .ball import Ball
from .grid_lines import jumps_of, lines_of
from .kernels.cell_bounds import EPS, LEFT_S, WIDE, CellBounds, write_one_cone
from .kernels.discs import Disc
from .polar_tapes import PolarTapes, polar_tapes
from .spline_quotient import mapped_spline

SECTORS = 512
# If bounds over SECTORS sectors are too wide, NARROW times as many sectors are used; for quotients
# of splines always, since they contain powers of u in each knot span. Bounds are taken over RINGS
# rings of decreasing radii, or over RINGS_OF_QUOTIENTS for quotients, which are exact at the pole.
NARROW, RINGS, RINGS_OF_QUOTIENTS = 4, 8, 2
# Bounds are computed up to this distance from the pole, relative to the radius of the disc.
WHOLE = 2.0
# The radius of a disc is at least this fraction of the height of a row of cells.
SMALLEST = 2.0**-8
# The change of the Hessian in a disc, relative to the Hessian at the pole, is at most this.
CHANGE = 0.4
# Bounds must hold at least up to this multiple of the radius of a disc.
BEYOND = 1.25
# Creases are searched at these fractions of the radius.
PARTS = (0.25, 0.5, 1.0)
# Smaller angles count as 0: angles between tangents and the tangent plane, and between the normals
# on both sides of a line.
SMOOTH = 1e-9
# Taylor coefficients: U1R2 is that of u r², …
ONE, U1, R1, U2, U1R1, R2, _, U2R1, U1R2, _ = range(10)


@dataclass(frozen=True, eq=False)
class PoleDisc:
    """The disc around a pole: its radius, the tape of u and r, its bounds, and its cell."""

    radius: float
    tape: Tape
    disc: Disc
    cell: CellBounds


class Bounds(NamedTuple):
    """Bounds over the sectors of a disc, for r up to some radius; q is (q1, q2).

    hessian: enclosures of the three entries of the Hessian of h(q), each (sectors,).
    q: the smallest and the largest length of q / r.
    slope: the largest length of the gradient of h(q).
    by_q: the largest lengths of r ∇u and ∇r, where ∇ is the gradient with respect to q.
    along: the largest lengths of q_u / r and q_r.
    """

    hessian: list[Ball]
    q: tuple[float, float]
    slope: float
    by_q: tuple[float, float]
    along: tuple[float, float]

    def changes(self, middle: Array) -> Array:
        """Return bounds (3,) of the differences between the entries of the Hessian and `middle`."""
        pairs = zip(self.hessian, middle.tolist(), strict=True)
        return np.array([(np.abs(x.middle - y) + x.radius).max() for x, y in pairs])


@dataclass(frozen=True, eq=False)
class Pole:
    """A pole: tapes of q1, q2 and h as functions of u and r, and the interval `around` of u.

    The columns of `basis` are the derivatives of x by q1, q2 and h. `tilt` is the larger of two
    errors, which are 0 for a smooth surface: the derivative of h at the pole, and the jump of
    derivatives across lines where the surface may have creases.
    """

    tapes: PolarTapes
    around: tuple[float, float]
    basis: Array
    tilt: float

    @classmethod
    def of(
        cls, tapes: PolarTapes, around: tuple[float, float], turned: float, radius: float
    ) -> Pole | None:
        """Return a pole; None if it has no tangent plane, or if creases are closer than `radius`.

        `turned` is the sign of x_u × x_r relative to the oriented normal.
        """
        u = _middles(around)
        jets = jets_of(tapes.tape, u, np.zeros(SECTORS))
        point, rows = (np.zeros(3), jets[:, 0])
        if tapes.slope is not None:
            point, rows = jets[0, 0], jets[:, 2]
        sizes = np.linalg.norm(rows, axis=1)
        if not (sizes.min() > 0.0 and sizes.max() < math.inf):
            return None
        frame = _frame(rows, turned)
        if frame is None:
            return None
        moved = _moved(tapes, frame, -frame @ point)
        if moved is None:
            return None
        basis = np.linalg.inv(frame).astype(np.float64)
        pole = cls(moved, around, basis, 0.0)
        tilt = max(np.abs(rows @ frame[2]).max(), pole._jump(radius))
        is_smooth = tilt <= SMOOTH * np.linalg.norm(pole.basis[:, :2], axis=0).min()
        return replace(pole, tilt=float(tilt)) if is_smooth else None

    def _jump(self, radius: float) -> float:
        """Return the largest jump of the derivatives of h across lines u = const, for r ≤ `radius`.

        The jumps are measured at the radii PARTS · `radius`.
        """
        low, high = self.around
        inner = jumps_of(self.tapes.tape, 0, low, high)
        step = 4.0 * np.spacing(max(abs(low), abs(high)))
        sides = np.append(inner - step, high - step), np.append(inner + step, low + step)
        one, other = (
            np.concatenate([self.slopes(u, np.full_like(u, radius * part)) for part in PARTS])
            for u in sides
        )
        return float(np.abs(one - other).max())

    def slopes(self, u: Array, r: Array) -> Array:
        """Return the derivatives (k, 2) of h with respect to q1 and q2, at u and r > 0 (k,)."""
        jets = jets_of(self.tapes.tape, u, r)
        around, away = jets[:, 1] / r[:, None], jets[:, 2]
        if self.tapes.slope is None:
            around, away = jets[:, 1], jets[:, 0] + r[:, None] * jets[:, 2]
        values = python_function(graph_slopes)(
            around[:, 0], around[:, 1], away[:, 0], away[:, 1], around[:, 2], away[:, 2]
        )
        return np.stack(values[4:], axis=1)

    def bounds(self, reach: float, count: int) -> Bounds:
        """Return bounds over about `count` sectors of the disc r ≤ `reach`."""
        lines = lines_of(self.tapes.tape, 0, np.array(self.around), count)
        middles, half = 0.5 * (lines[1:] + lines[:-1]), 0.5 * np.diff(lines)
        centres = np.column_stack([middles, np.full_like(middles, 0.5 * reach)])
        widths = np.column_stack([half, centres[:, 1]])
        x = _Coefficients.of(self.tapes.tape, centres, widths)
        if self.tapes.slope is None:
            r = Ball(centres[:, 1], widths[:, 1])
            (o1, o2, h1), a = x[U1], [2.0 * y for y in x[U2]]
            e1, e2, _ = (y + r * z for y, z in zip(x[ONE], x[R1], strict=True))
            b = [y + r * z for y, z in zip(x[U1], x[U1R1], strict=True)]
            c = [2.0 * y + 2.0 * (r * z) for y, z in zip(x[R1], x[R2], strict=True)]
            h1, h2, h11, h22 = x[U1R1][2], 2.0 * x[R1][2], 2.0 * x[U2R1][2], c[2]
            q1, q2, _ = x[ONE]
        else:
            slope = _Coefficients.of(self.tapes.slope, centres, widths)
            (o1, o2, _), (e1, e2, _), (q1, q2, _) = x[U1R1], x[R1], x[R1]
            a, b, c = ([f * y for y in x[k]] for f, k in ((2.0, U2R1), (1.0, U1R1), (2.0, R2)))
            h1, h2, h11, h22 = x[U1R2][2], c[2], slope[U1R2][2], c[2]
        *inverse, G1, G2 = python_function(graph_slopes)(o1, o2, e1, e2, h1, h2)
        hessian = python_function(graph_at_pole)(
            *inverse, G1, G2, a[0], a[1], b[0], b[1], c[0], c[1], h11, 2.0 * h1, h22,
            Ball(centres[:, 1], widths[:, 1]),
        )  # fmt: skip
        i11, i12, i21, i22 = inverse
        return Bounds(
            list(hessian),
            (np.hypot(q1.least, q2.least).min(), _length(q1, q2)),
            _length(G1, G2) * reach,
            (_length(i11, i12), _length(i21, i22)),
            (_length(o1, o2), _length(e1, e2)),
        )

    def noise(self, reach: float, bounds: Bounds) -> tuple[float, float]:
        """Return n0 and n1: rounding errors of the derivatives of h are at most n0 + n1 / r."""
        tape = self.tapes.tape
        middles, radii, errors = np.empty((3, BALL * (len(tape.operations) + 1)))
        low, high = self.around
        box = np.array([[0.5 * (low + high), 0.5 * reach]])
        widths, found = np.array([[0.5 * (high - low), 0.5 * reach]]), np.empty((1, 6, 3))
        rounding_of_boxes(
            tape, box, widths * (1.0 + 1e-12), middles, radii, errors, np.empty((2, 4)), found
        )
        by_u, by_r = bounds.by_q
        condition = by_u * bounds.along[0] + by_r * bounds.along[1]
        # Errors of h, of h_u and of h_r. The errors of the vector (q1, q2) and of its derivatives
        # by u and by r, times the slope, are included.
        of_q = np.linalg.norm(found[0, :3, :2], axis=1)
        value, around, away = (found[0, :3, 2] + bounds.slope * of_q).tolist()
        plane = self.basis[:, :2]
        size = np.abs(plane).max() * np.linalg.cond(plane)
        own = 64.0 * EPS * (condition**2 * bounds.slope + size) + 2.0 * self.tilt
        if self.tapes.slope is None:
            return own + by_u * around + by_r * (value + reach * away), 0.0
        return own + by_r * away, by_u * around


class _Coefficients:
    """Bounds of Taylor coefficients over boxes: item k has those of the coordinates x, y and z."""

    def __init__(self, bounds: Array) -> None:
        self._bounds = bounds

    @classmethod
    def of(cls, tape: Tape, centres: Array, widths: Array) -> _Coefficients:
        """Return the bounds of the coefficients of a tape over boxes with given half widths."""
        return cls(bounds_over_boxes(tape, centres, widths, 3))

    def __getitem__(self, k: int) -> list[Ball]:
        return [Ball(self._bounds[:, 0, k, axis], self._bounds[:, 1, k, axis]) for axis in range(3)]


def pole_disc(tape: Tape, domain: Domain, angle: int, end: float, radius: float) -> PoleDisc | None:
    """Return a disc around a pole, of at most the given radius; None if the surface is not smooth.

    `angle` is the index of the parameter that runs around the pole, 0 for u and 1 for v; the other
    parameter is `end` at the pole.
    """
    if not _is_point(tape, domain, angle, end):
        return None
    inward = 1.0 if end == domain[1 - angle][0] else -1.0
    tapes = polar_tapes(tape, angle, end, inward)
    if tapes is None:
        return None
    size = min(radius, tapes.most / WHOLE)
    pole = Pole.of(tapes, domain[angle], inward if angle == 0 else -inward, size)
    if pole is None:
        return None
    widths = (NARROW,) if tapes.slope is None else (1, NARROW)
    while size >= SMALLEST * radius:
        for narrow in widths:
            place = np.array([end, inward, float(angle)])
            disc = _disc(pole, size, SECTORS * narrow, place)
            if disc is not None:
                return disc
        size *= 0.5
    return None


def _disc(pole: Pole, size: float, sectors: int, place: Array) -> PoleDisc | None:
    """Return the disc of radius `size` around a pole; None if its bounds are too wide.

    `place` has three numbers: the value at the pole of the parameter towards it; 1 if this
    parameter increases away from the pole, or −1 if it decreases; and the index `angle`.
    """
    count = RINGS_OF_QUOTIENTS if pole.tapes.slope is None else RINGS
    whole, last = (pole.bounds(WHOLE * size * 0.5**k, sectors) for k in (0, count - 1))
    unit = size * whole.q[1]
    beyond = WHOLE * whole.q[0] / whole.q[1]
    if not beyond >= BEYOND:
        return None
    middle = np.array([0.5 * (x.middle.min() + x.middle.max()) for x in last.hessian])
    if not _is_steady(whole, middle):
        return None
    sizes = [WHOLE * size * 0.5**k for k in range(1, count - 1)]
    rings = [whole, *(pole.bounds(x, sectors) for x in sizes), last]
    changes = [x.changes(middle) for x in rings]
    normal = pole.basis[:, 2]
    hot = np.concatenate(
        [*(unit**2 * middle[:, None] * normal), unit * pole.basis[:, 0], unit * pole.basis[:, 1]]
    )
    change = unit**2 * np.array(changes)[:, :, None] * np.abs(normal) * (1.0 + 1e-9)
    noise = unit * np.array(pole.noise(WHOLE * size, whole))
    cell = _cell(hot, change, noise[0])
    if cell is None:
        return None
    low, high = pole.around
    u = low + (high - low) * np.arange(SECTORS + 1) / SECTORS
    jets = jets_of(pole.tapes.tape, u, np.zeros(SECTORS + 1))
    rows = jets[:, 0 if pole.tapes.slope is None else 2]
    angles = np.unwrap(np.arctan2(rows[:, 1], rows[:, 0]))
    sense = math.copysign(1.0, angles[-1] - angles[0])
    if not (np.diff(sense * angles) > 0.0).all() or abs(np.ptp(angles) - 2.0 * math.pi) > 1e-6:
        return None
    frame = np.array(
        [
            noise[0], noise[1] / size, size, low, high - low, *place, unit, beyond, *whole.by_q,
            float(pole.tapes.slope is None), sense,
        ]
    )  # fmt: skip
    table = np.column_stack([sense * angles, np.hypot(rows[:, 0], rows[:, 1])])
    disc = Disc(hot[None], change, frame, np.ascontiguousarray(pole.basis.T), table)
    return PoleDisc(size, pole.tapes.tape, disc, cell)


def _middles(around: tuple[float, float]) -> Array:
    """Return the values of u in the middles of the sectors."""
    low, high = around
    return low + (high - low) * (np.arange(SECTORS) + 0.5) / SECTORS


def _is_point(tape: Tape, domain: Domain, angle: int, end: float) -> bool:
    """Return whether a side of the domain is collapsed; some of its points are compared."""
    u = _middles(domain[angle])[:: SECTORS // 16]
    places = u, np.full_like(u, end)
    jets = jets_of(tape, *(places if angle == 0 else places[::-1]))
    slack = SMOOTH * np.abs(jets[:, 2 - angle]).max()
    return bool(max(np.ptp(jets[:, 0], axis=0).max(), np.abs(jets[:, 1 + angle]).max()) <= slack)


def _frame(rows: Array, turned: float) -> Array | None:
    """Return the matrix (3, 3) from x to (q1, q2, h), for the directions x_r (k, 3) around a pole.

    Its first two rows take these directions to vectors (q1, q2) that are as close to unit vectors
    as possible. The result is None if the directions do not span a plane.
    """
    normal = turned * np.cross(np.roll(rows, -1, axis=0), rows).sum(axis=0)
    size = np.linalg.norm(normal)
    if not size > 0.0:
        return None
    normal /= size
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    plane = np.stack([first, np.cross(normal, first)])
    flat = rows @ plane.T
    sizes, axes = np.linalg.eigh(flat.T @ flat / len(flat))
    if not sizes[0] > SMOOTH * sizes[1]:
        return None
    rounded = axes @ np.diag(1.0 / np.sqrt(2.0 * sizes)) @ axes.T
    return np.vstack([rounded @ plane, normal])


def _moved(tapes: PolarTapes, frame: Array, shift: Array) -> PolarTapes | None:
    """Return the tapes of the surface after the affine map x → frame x + shift."""
    if tapes.slope is None:
        tape = mapped_spline(tapes.tape, frame)
        return None if tape is None else replace(tapes, tape=tape)
    tape = moved_tape(tapes.tape, frame, shift, None)
    slope = moved_tape(tapes.slope, frame, np.zeros(3), None)
    return None if tape is None or slope is None else replace(tapes, tape=tape, slope=slope)


def _length(x: Ball, y: Ball) -> float:
    """Return an upper bound of the lengths of the vectors (x, y), whose components are balls."""
    return float(np.hypot(x.largest, y.largest).max())


def _is_steady(bounds: Bounds, middle: Array) -> bool:
    """Return whether the Hessian differs little from a regular matrix, given by `middle` (3,)."""
    y11, y12, y22 = middle.tolist()
    hessian = np.array([[y11, y12], [y12, y22]])
    if not np.isfinite(hessian).all() or np.linalg.det(hessian) == 0.0:
        return False
    a, b, c = bounds.changes(middle).tolist()
    return bool((np.abs(np.linalg.inv(hessian)) @ np.array([a + b, b + c])).max() < CHANGE)


def _cell(hot: Array, changes: Array, noise: float) -> CellBounds | None:
    """Return a disc as a cell with a cone of normals; None if the cone is wide."""
    if not noise < math.inf:
        return None
    cell = CellBounds.new(1)
    cell.hot[0, :15] = hot
    a, b, c = changes[1]  # in the disc itself
    left = np.stack([a + b, b + c]) + noise + 2.0**-48 * np.abs(hot).max()
    cell.noise[0, LEFT_S:] = left.ravel()
    cell.hot[0, [REST_S, REST_T]] = np.linalg.norm(left, axis=1)
    write_one_cone(cell)
    return cell if cell.cone[0, 3] < WIDE else None
