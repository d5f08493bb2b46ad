"""Derivatives of surfaces: from formulas, from a user's callable, or by high-order differences.

The differences are of nine points along u, along v and along one diagonal of the parameters. Steps
are between 1/512 and 1/256 of the domain, and smaller where differences of seven points give other
derivatives.
"""

from __future__ import annotations

import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ...generated.differences import FIRST, FIRST_CHANGE, SECOND, SECOND_CHANGE
from ..base.aliases import Array, Flags, Indices
from ..base.errors import SurfaceError
from ..base.evaluation import returned
from ..base.scales import power_of_two, scale_to_one
from ..directions.unit import unit_or_zero
from ..domain.domain import Boundary, BoundaryPair, Domain, Interval, brought_inside, places_in
from ..tape.kernels.points import Tape

Function = Callable[[Array, Array], Array]
Evaluation = Callable[[Array, Array], ArrayLike]
Bounds = tuple[tuple[float, float], tuple[float, float]]
Lines = tuple[tuple[float, ...], tuple[float, ...]]

# The names of the six vectors of a 2-jet, in order.
NAMES = ("x", "x_u", "x_v", "x_uu", "x_uv", "x_vv")
EVERYWHERE: Bounds = ((-math.inf, math.inf), (-math.inf, math.inf))
POINTS = FIRST.shape[1]
HALF = POINTS // 2
# A step is the largest power of two up to this part of the domain. (With powers of two, sums of
# parameters and steps are exact up to the last bit.)
STEP = 1 / 256
CHUNK = 4096  # number of rows in one batch
# If derivatives from seven and from nine points disagree by more than SAME, relative to the
# differences of values, steps are divided by FINER. This is repeated, at most LEVELS times, while
# it reduces the disagreement, or while the disagreement is above LARGE.
SAME, LARGE = 1e-10, 1e-3
FINER, LEVELS = 4.0, 5
ROUNDING = 2.0**-46  # relative to values: smaller differences are rounding errors
# The number of points where given derivatives are compared with numerical ones.
PLACES = 48
# Given and numerical derivatives may differ by TOLERANCE, relative to the largest derivative of the
# same name, plus DOUBT times the change of the numerical derivative when its steps are doubled.
TOLERANCE = 1e-5
DOUBT = 10.0


class Differentiable(ABC):
    """A function x(u,v) with derivatives, which several threads may call."""

    has_gaps: ClassVar[bool] = False  # whether derivatives may be NaN at isolated points
    creases: Lines = ((), ())  # values of u, and of v, inside the domain where it is not smooth

    def restricted(self, domain: Domain) -> Differentiable:
        """Return the function over a part of its domain; at creases it is evaluated from inside."""
        return self

    @property
    def differentiable(self) -> bool:
        """Whether `jets` can be called."""
        return True

    @abstractmethod
    def __call__(self, u: Array, v: Array) -> Array:
        """Return the points (..., 3) for parameters of one shape."""

    @abstractmethod
    def jets(self, u: Array, v: Array) -> Array:
        """Return x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) for u (k,) and v (k,)."""

    def tape(self) -> Tape | None:
        """Return the tape of the function; None if it is unknown."""
        return None

    def differences(self, boundary: Boundary) -> Differences | None:
        """Return the `Differences` that compute `jets`; None if formulas compute them."""
        return None


@dataclass(frozen=True)
class Differences:
    """The derivatives of a function, by differences of its values inside the domain."""

    function: Function
    domain: Domain
    boundary: Boundary
    step: float = STEP  # relative to the domain

    def jets(self, u: Array, v: Array) -> Array:
        """Return x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) for u (k,) and v (k,)."""
        (u0, u1), (v0, v1) = self.domain
        steps = power_of_two(self.step * (u1 - u0)), power_of_two(self.step * (v1 - v0))
        bounds = (
            _bounds(self.domain[0], self.boundary[0]),
            _bounds(self.domain[1], self.boundary[1]),
        )
        jets = np.empty((u.size, len(NAMES), 3))
        for start in range(0, u.size, CHUNK):
            rows = slice(start, start + CHUNK)
            jets[rows] = self._refined(u[rows], v[rows], steps, bounds)
        return jets

    def _refined(self, u: Array, v: Array, steps: tuple[float, float], bounds: Bounds) -> Array:
        """Return 2-jets (k, 6, 3), with smaller steps where these reduce the estimated error."""
        jets, doubts = differences(self._inside, u, v, steps, bounds)
        rows = np.flatnonzero(doubts > SAME)
        for _ in range(LEVELS):
            if not rows.size:
                break
            steps = steps[0] / FINER, steps[1] / FINER
            finer, new = differences(self._inside, u[rows], v[rows], steps, bounds)
            better = new < doubts[rows]
            jets[rows[better]], doubts[rows[better]] = finer[better], new[better]
            rows = rows[(better & (new > SAME)) | (new > LARGE)]
        return jets

    def _inside(self, u: Array, v: Array) -> Array:
        return self.function(*moved_inside(u, v, self.domain, self.boundary))


def _bounds(interval: Interval, ends: BoundaryPair) -> Interval:
    """Return the interval in which u or v may be evaluated.

    It ends at open boundaries; beyond other boundaries the surface continues, and the bound is ±∞.
    """
    (low, high), (at_low, at_high) = interval, ends
    return low if at_low == "open" else -math.inf, high if at_high == "open" else math.inf


def normals_of_jets(jets: Array) -> Array:
    """Return the unit normals (k, 3) of 2-jets (k, 6, 3); 0 at singular points."""
    tangents = scale_to_one(float(np.abs(jets[:, 1:3]).max(initial=0.0))) * jets[:, 1:3]
    with np.errstate(invalid="ignore"):  # jets outside of a trim may be NaN or infinite
        return unit_or_zero(np.cross(tangents[:, 0], tangents[:, 1]))


def moved_inside(u: Array, v: Array, domain: Domain, boundary: Boundary) -> tuple[Array, Array]:
    """Return parameters inside the domain at which the surface has the same points as at u and v.

    They follow from the boundary conditions. Parameters beyond open boundaries are unchanged.
    """
    places = u.copy(), v.copy()
    for axis in (0, 1):
        values, others = places[axis], places[1 - axis]
        low, high = domain[1 - axis]
        for end, kind, sign in zip(domain[axis], boundary[axis], (-1.0, 1.0), strict=True):
            out = sign * (values - end) > 0.0
            if kind == "pole":  # the opposite meridian
                half = np.where(others[out] < (low + high) / 2, 0.5, -0.5)
                others[out] += half * (high - low)
                values[out] = 2.0 * end - values[out]
    return brought_inside(*places, domain, boundary)


def differences(
    function: Function, u: Array, v: Array, steps: tuple[float, float], bounds: Bounds = EVERYWHERE
) -> tuple[Array, Array]:
    """Return x, x_u, x_v, x_uu, x_uv, x_vv of a function by differences of nine points.

    Parameters
    ----------
    function : callable
        ``function(u, v)`` gets arrays (27 k,) and returns points (27 k, 3). It is called once.
    u, v : (k,) float64 array
        The parameters.
    steps : (float, float)
        The distances of the points along u and v, preferably powers of two.
    bounds : pair of (float, float)
        The function is called only between these bounds of u and of v, which are at least 16 steps
        apart; next to a bound, differences are one-sided.

    Returns
    -------
    (k, 6, 3) float64 array
        The 2-jets. With a step h and a rounding error ε of values, the error of a first derivative
        is about h⁸/630 times the ninth derivative plus 2 ε/h, and that of a second derivative
        h⁸/3150 times the tenth derivative plus 8 ε/h². Next to a bound errors are ten to a thousand
        times larger.
    (k,) float64 array
        Estimated errors: the changes of derivatives if only seven points are used, relative to the
        differences of values. They are infinite if a derivative is not finite, but 0 if x itself is
        not finite.

    """
    (shift_u, inward_u), (shift_v, inward_v) = (
        shifts_inside(x, step, *ends) for x, step, ends in zip((u, v), steps, bounds, strict=True)
    )
    # The third line of nodes is the diagonal that leads away from the nearer bounds of u and v. If
    # its nodes are shifted by the larger one of the shifts along u and v, they stay between the
    # bounds.
    shift = np.maximum(np.abs(shift_u), np.abs(shift_v)) * inward_u
    sign = inward_u * inward_v
    central = np.arange(-HALF, HALF + 1)[:, None]
    along_u, along_v, diagonal = (central + x for x in (shift_u, shift_v, shift))
    still = np.zeros_like(diagonal)
    nodes = (
        nodes_between(u, np.concatenate([along_u, still, diagonal]), steps[0], *bounds[0]),
        nodes_between(v, np.concatenate([still, along_v, diagonal * sign]), steps[1], *bounds[1]),
    )
    values = function(nodes[0].ravel(), nodes[1].ravel()).reshape(3, POINTS, u.size, 3)
    points = values[1, HALF - shift_v, np.arange(u.size)]
    values = values - points
    jets = np.empty((u.size, len(NAMES), 3))
    jets[:, 0] = points
    jets[:, 1] = weighted(FIRST, shift_u, values[0]) / steps[0]
    jets[:, 2] = weighted(FIRST, shift_v, values[1]) / steps[1]
    uu, vv = weighted(SECOND, shift_u, values[0]), weighted(SECOND, shift_v, values[1])
    # h² x_uu ± 2 h k x_uv + k² x_vv for the steps h along u and k along v.
    both = weighted(SECOND, shift, values[2])
    jets[:, 3] = uu / steps[0] ** 2
    jets[:, 4] = sign[:, None] * (both - uu - vv) / (2.0 * steps[0] * steps[1])
    jets[:, 5] = vv / steps[1] ** 2
    size = ROUNDING * np.abs(points).max(axis=1)
    doubts = np.maximum(_doubts(values[0], shift_u, size), _doubts(values[1], shift_v, size))
    lost = ~np.isfinite(jets).all(axis=(1, 2))
    doubts[lost] = np.where(np.isfinite(points[lost]).all(axis=1), np.inf, 0.0)
    return jets, doubts


def _doubts(values: Array, shifts: Indices, least: Array) -> Array:
    """Return relative changes (k,) of derivatives if two of the nine points are omitted.

    `values` (9, k, 3) are differences from x itself. Changes are divided by the largest of these
    differences plus the rounding error `least` (k,) of x.
    """
    changes = np.array([weighted(x, shifts, values) for x in (FIRST_CHANGE, SECOND_CHANGE)])
    size, change = (np.abs(x).max(axis=0).max(axis=1) for x in (values, changes))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.nan_to_num(change / (size + least))


def shifts_inside(
    values: Array, step: float | Array, low: float | Array, high: float | Array
) -> tuple[Indices, Indices]:
    """Return the shifts (k,) of nodes around `values` (k,) that keep them between the bounds.

    The nodes are those of differences; a shift is a number of steps. Also return the inward
    directions (k,): 1 or −1, away from the nearer bound. The step and the bounds are numbers, or
    arrays (k,).
    """
    before = np.clip(np.floor((values - low) / step), 0, HALF)
    after = np.clip(np.floor((high - values) / step), 0, HALF)
    inward = np.where(values - low < high - values, 1, -1)
    return (after - before).astype(np.int64), inward


def nodes_between(
    values: Array, offsets: Indices, step: float | Array, low: float | Array, high: float | Array
) -> Array:
    """Return the nodes values + offsets × step of differences.

    They are clipped, since rounding could move them out of the bounds.
    """
    return np.clip(values + offsets * step, np.minimum(low, values), np.maximum(high, values))


def weighted(weights: Array, shifts: Indices, values: Array) -> Array:
    """Return weighted sums (k, 3) of values (9, k, 3) at nine nodes.

    `weights` has a row for each possible shift of the nodes, and `shifts` (k,) select the rows.
    """
    return np.einsum("kj,jkc->kc", weights[shifts + HALF], values)


# --- the source of derivatives --------------------------------------------------------------------


def jet_function(
    function: Evaluation,
    derivatives: Evaluation | None,
    domain: Domain,
    boundary: Boundary,
    name: str,
) -> Function:
    """Return the function of u (k,) and v (k,) that gives the 2-jets (k, 6, 3) of a surface."""
    own = function if isinstance(function, Differentiable) and function.differentiable else None
    if derivatives is None and own is not None and not own.has_gaps:
        return own.jets
    label = f"surface {name!r}"
    numerical = Differences(guarded(function, (3,), f"the callable of {label}"), domain, boundary)
    if derivatives is not None:
        given = guarded(derivatives, (len(NAMES), 3), f"derivatives of {label}")
        compare(given, numerical, label)
        return given
    return numerical.jets if own is None else filled(own, numerical)


def guarded(function: Evaluation, shape: tuple[int, ...], label: str) -> Function:
    """Return a user's callable with checked results, which only one thread calls at a time.

    It raises SurfaceError unless the callable returns an array of `shape` for each parameter pair.
    """
    lock = threading.RLock()

    def call(u: Array, v: Array) -> Array:
        with lock:
            return returned(function, (u, v), shape, label)

    return call


def filled(function: Differentiable, numerical: Differences) -> Function:
    """Return 2-jets from a formula, replaced by numerical ones where they are not finite."""

    def jets(u: Array, v: Array) -> Array:
        found = function.jets(u, v)
        bad = ~np.isfinite(found).all(axis=(1, 2))
        if bad.any():
            found[bad] = numerical.jets(u[bad], v[bad])
        return found

    return jets


def compare(derivatives: Function, numerical: Differences, label: str) -> None:
    """Raise SurfaceError if given derivatives are not finite, or differ from numerical ones.

    They are tested where the numerical ones are finite. The message names the derivative, the
    parameters, and the difference.
    """
    u, v = places_in(numerical.domain, PLACES)
    coarser = replace(numerical, step=2.0 * numerical.step)
    given, found, coarse = derivatives(u, v), numerical.jets(u, v), coarser.jets(u, v)
    known = np.logical_and.reduce(np.isfinite(found) & np.isfinite(coarse), axis=-1)
    sizes = np.abs(np.where(known[..., None], found, 0.0)).max(axis=(0, 2))
    with np.errstate(invalid="ignore"):
        error: Array = np.abs(given - found).max(axis=-1)
        allowed = TOLERANCE * sizes + DOUBT * np.abs(found - coarse).max(axis=-1)
        wrong: Flags = known & ~(error <= allowed)
    if wrong.any():
        order = int(np.argmax(wrong.any(axis=0)))  # the first wrong derivative explains the others
        place = int(np.argmax(np.where(wrong, error, -1.0)[:, order]))
        raise SurfaceError(
            f"derivatives of {label} contradict it: {NAMES[order]} at u = {float(u[place])}, v = "
            f"{float(v[place])} is given as {given[place, order]}, and differences of points give "
            f"{found[place, order]}, {error[place, order]:.2g} away."
        )
