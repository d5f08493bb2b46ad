"""A curve without a spline, divided into arcs on which its normal provably turns one way.

Bounds of x′ and x″ over intervals of the parameter come from the tape of the curve. An arc is
certain if x′ stays within 90° of one direction and x′ × x″ has one sign: the angle of the normal is
monotone, and the arc has each normal between those at its ends exactly once. Other intervals are
halved until the normal turns by less than `SMALLEST_TURN` there: around inflections, and where the
curve is straight. Intervals where x′ may vanish, as at cusps, are halved until they are shorter
than `SHORTEST`; they are singular.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...generated import curve as formulas
from ...runtime.base.formula_calls import plane_vector, python_function
from ...runtime.base.kept import kept
from ...runtime.base.scales import scale_to_one
from ...runtime.surface.traced import traced_tape
from ...runtime.tape.kernels.points import Tape
from ...runtime.tape.tapes import bounds_over_boxes, jets_of
from .curve import Curve
from .turning import Turning

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

FIRST_ARCS, MOST_ARCS = 64, 1 << 14
# An interval is not halved if the normal turns by less than SMALLEST_TURN in it (radians), or if
# the interval is shorter than SHORTEST, relative to the domain.
SMALLEST_TURN, SHORTEST = 1e-12, 2.0**-36
# The largest number of steps of Newton's method and of bisection: more than a float has digits.
STEPS = 80
CERTAIN, UNCERTAIN, SINGULAR = range(3)


@dataclass(frozen=True, eq=False)
class CurveArcs(Turning):
    """A curve in P arcs: the parameters `joints` (P + 1,), and the `kinds` (P,) of the arcs.

    A kind is CERTAIN, UNCERTAIN or SINGULAR. The attributes that the search needs are named as in
    `CurveSpline`.
    """

    curve: Curve
    tape: Tape
    joints: Array
    kinds: NDArray[np.int8]
    periodic: bool

    @property
    def name(self) -> str:
        """Label of the curve."""
        return self.curve.name

    @property
    def domain(self) -> tuple[float, float]:
        """The interval of the parameter."""
        return self.curve.domain

    @property
    def pieces(self) -> int:
        """The number of arcs."""
        return len(self.kinds)

    @property
    def straight(self) -> Flags:
        """A mask (P,) of arcs that may be straight or singular: the sense of turning is unknown."""
        return self.kinds != CERTAIN

    @property
    def reversing(self) -> Flags:
        """A mask (P,) of the arcs with a cusp, where the curve reverses its direction."""
        before, after = self.joint_normals[:-1], self.joint_normals[1:]
        return (self.kinds == SINGULAR) & (np.einsum("kx,kx->k", before, after) <= 0.0)

    @cached_property
    def joint_normals(self) -> Array:
        """Unit normals (P + 1, 2) at the joints: the tangent rotated clockwise by 90°."""
        tangents = self.jets(self.joints)[1]
        normals = np.stack([tangents[:, 1], -tangents[:, 0]], axis=1)
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return normals / np.where(lengths > 0.0, lengths, 1.0)

    @property
    def noise(self) -> float:
        """A bound of the rounding errors of `joint_normals`."""
        return 4.0 * float(np.finfo(np.float64).eps)

    @cached_property
    def inflections(self) -> Array:
        """The parameters (k,) of inflections.

        An inflection is between two certain arcs on which the normal turns in opposite senses.
        """
        certain = np.flatnonzero(self.kinds == CERTAIN)
        following = np.roll(certain, -1)
        if not self.periodic:
            certain, following = certain[:-1], following[:-1]
        positive = self.turning_angles > 0.0
        changes = positive[certain] != positive[following]
        low, high = self.joints[certain[changes] + 1], self.joints[following[changes]]
        return np.sort(np.where(high >= low, 0.5 * (low + high), low))

    @property
    def scale(self) -> float:
        """A power of two that scales distances of neighbouring joints to about 1."""
        return scale_to_one(float(np.abs(np.diff(self.jets(self.joints)[0], axis=0)).max()))

    def evaluate(self, t: Array) -> Array:
        """Return the points at parameters."""
        return self.jets(np.asarray(t, dtype=np.float64))[0]

    def jets(self, t: Array) -> tuple[Array, Array, Array]:
        """Return x, x′, x″, each (k, 2), at parameters (k,)."""
        jets = jets_of(self.tape, t, np.zeros_like(t))[..., :2]
        return jets[:, 0], jets[:, 1], jets[:, 3]

    def undecided(self, normals: Array) -> Flags:
        """Return a mask of the unit normals (S, 2) that may have points which were not found.

        These are the normals of uncertain arcs, or all if the curve is singular somewhere.
        """
        if (self.kinds == SINGULAR).any():
            return np.ones(len(normals), dtype=bool)
        found = np.zeros(len(normals), dtype=bool)
        starts = self.joint_normals[:-1][self.kinds == UNCERTAIN]
        for start in np.unique(starts.round(14), axis=0):
            found |= np.linalg.norm(normals - start, axis=1) <= 4.0 * SMALLEST_TURN
        return found

    def parameters(self, arcs: NDArray[np.int64], normals: Array) -> Array:
        """Return the parameters (k,) at which arcs, given by indices, have unit normals (k, 2).

        Newton's method is safeguarded by bisection.
        """
        low, high = self.joints[arcs].copy(), self.joints[arcs + 1].copy()
        at_low = np.einsum("kx,kx->k", normals, self.jets(low)[1])
        t = 0.5 * (low + high)
        for _ in range(STEPS):
            _, first, second = self.jets(t)
            value = np.einsum("kx,kx->k", normals, first)
            slope = np.einsum("kx,kx->k", normals, second)
            same = np.sign(value) == np.sign(at_low)
            low, high = np.where(same, t, low), np.where(same, high, t)
            with np.errstate(divide="ignore", invalid="ignore"):
                after = t - value / slope
            after = np.where((after > low) & (after < high), after, 0.5 * (low + high))
            after = np.where(value == 0.0, t, after)
            if (np.abs(after - t) <= 2.0 * np.spacing(np.abs(t))).all():
                return after
            t = after
        return t

    def at(self, t: Array, normals: Array) -> tuple[Array, Array]:
        """Return points (k, 2) and curvatures (k,) at parameters (k,) with unit normals (k, 2)."""
        x, first, second = self.jets(t)
        A = np.einsum("kx,kx->k", normals, second)
        with np.errstate(all="ignore"):  # at cusps
            return x, python_function(formulas.arc_curvature)(A, plane_vector(first))


def arcs_of(curve: Curve) -> CurveArcs | None:
    """Return the arcs of a curve; None if its derivatives cannot be bounded.

    The arcs are cached with the curve.
    """
    return kept(curve, CurveArcs, lambda: _arcs_of(curve))


def _arcs_of(curve: Curve) -> CurveArcs | None:
    if curve.points is not None:
        return None

    def lifted(u: Array, v: Array) -> Array:
        plane = np.asarray(curve.function(u))
        return np.stack([plane[..., 0], plane[..., 1], 0.0 * v], axis=-1)

    tape = traced_tape(lifted, (curve.domain, (0.0, 1.0)))
    if tape is None:
        return None
    low, high = curve.domain
    joints = np.linspace(low, high, FIRST_ARCS + 1)
    open_, done = np.stack([joints[:-1], joints[1:]], axis=1), list[tuple[float, int]]()
    while len(open_):
        kinds = _kinds(tape, open_)
        kinds[np.diff(open_, axis=1)[:, 0] <= SHORTEST * (high - low)] %= 4
        final = kinds < 4
        done += zip(open_[final, 0].tolist(), kinds[final].tolist(), strict=True)
        rest = open_[~final]
        if len(done) + 2 * len(rest) > MOST_ARCS:
            return None
        middle = rest.mean(axis=1)
        open_ = np.concatenate([np.column_stack([rest[:, 0], middle]),
                                np.column_stack([middle, rest[:, 1]])])  # fmt: skip
    done.sort()
    starts, kinds = zip(*done, strict=True)
    return CurveArcs(
        curve, tape, np.array([*starts, high]), np.array(kinds, dtype=np.int8), curve.periodic
    )


def _kinds(tape: Tape, intervals: Array) -> NDArray[np.int8]:
    """Return the kinds (k,) of intervals (k, 2), plus 4 for intervals that should be halved."""
    centres = intervals.mean(axis=1)
    half = np.maximum(intervals[:, 1] - centres, centres - intervals[:, 0])
    zero = np.zeros_like(half)
    bounds = bounds_over_boxes(
        tape, np.column_stack([centres, zero]), np.column_stack([half, zero])
    )
    # Taylor coefficients: x″ is twice the coefficient of u².
    first, second = bounds[:, :, 1, :2], 2.0 * bounds[:, :, 3, :2]
    low, high = first[:, 0] - first[:, 1], first[:, 0] + first[:, 1]
    towards = first[:, 0]
    length = np.linalg.norm(towards, axis=1)
    along = np.minimum(low * towards, high * towards).sum(axis=1)
    regular = np.isfinite(first).all(axis=(1, 2)) & (along > 1e-12 * length**2) & (length > 0.0)
    middle = first[:, 0, 0] * second[:, 0, 1] - first[:, 0, 1] * second[:, 0, 0]
    size_1, size_2 = np.abs(first[:, 0]), np.abs(second[:, 0])
    radius = sum(
        size_1[:, i] * second[:, 1, j] + first[:, 1, i] * (size_2[:, j] + second[:, 1, j])
        for i, j in ((0, 1), (1, 0))
    )
    radius *= 1.0 + 1e-12
    kinds = np.full(len(intervals), SINGULAR + 4, dtype=np.int8)
    with np.errstate(divide="ignore", invalid="ignore"):
        least = along / length  # a lower bound of the length of x′
        turn = 2.0 * half * (np.abs(middle) + radius) / least**2
    kinds[regular] = UNCERTAIN + 4
    kinds[regular & (turn < SMALLEST_TURN)] = UNCERTAIN
    kinds[regular & (np.abs(middle) > radius)] = CERTAIN
    return kinds
