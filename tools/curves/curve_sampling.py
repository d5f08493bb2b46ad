"""`sample`: every point of a planar curve that has one of the normals, exactly once.

The normals are sorted by angle, and each joint of the spline has one position in this order. The
normals of an arc are those between the positions of its two joints, ascending where κ > 0 and
descending where κ < 0. Neighbouring arcs share a joint and its position, so that no normal is lost
or doubled there, however the position is rounded. On a closed curve the sum of sign κ over the
preimages of a normal is the turning number, for every normal. The exact normal of an inflection has
two preimages there or none, like a normal close to it.

Where the normals of neighbouring joints differ only by the rounding of the coordinates, the curve
is straight, and the joints get one position.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...generated import curve as formulas
from ...runtime.base.checks import checked_count, known_name
from ...runtime.base.errors import GaussmapWarning, InputError, in_memory
from ...runtime.base.formula_calls import plane_vector, python_function
from ...runtime.base.memory import check_memory
from ...runtime.base.repeats import repeated
from ...runtime.base.wording import at_normals
from ...runtime.directions.sets import arc_of_normals, circle
from ...runtime.directions.unit import as_normals
from ...runtime.samples.report import WORTH_A_WARNING
from .curve import Curve
from .curve_arcs import CurveArcs, arcs_of
from .curve_spline import CurveSpline
from .fitting import fit
from .turning import angles_of

Array = NDArray[np.float64]

# The largest number of attempts to meet `count` by changing the number of normals.
TRIES = 6
# Which arcs are straight is decided for at least this number of uniform normals, even if fewer are
# used.
LEAST_NORMALS = 1_000
# The curves on which samples may lie.
PLACES = ("curve", "spline")


@dataclass(frozen=True, slots=True)
class CurveReport:
    """A report on the sampling of a curve.

    Attributes
    ----------
    curve : str
        Label of the curve.
    normals : int
        The number of prescribed normals.
    samples : int
        The number of samples.
    pieces : int
        The number of arcs of the spline, or of arcs into which the curve was divided.
    straight_share : float
        The share (0…1) of the length where κ ≈ 0, which has no samples.
    inflections : int
        The number of changes of the sign of κ.
    turning_number : int or None
        The turning number of a closed curve; None for an open one.
    on : {"curve", "spline"}
        The curve on which the samples lie.
    proved : int or None
        The number of prescribed normals for which all points are proved to be found; None on
        splines.
    undecided : tuple of int
        Rows of the normals that are not proved: normals of inflections and straight parts, up to
        rounding, or all normals if the curve has singular points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(
    ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True, name="circle"
    ... )
    >>> report = gm.curves.sample(circle, 8).report
    >>> report.curve, report.normals, report.samples, report.pieces
    ('circle', 8, 8, 64)
    >>> report.straight_share, report.inflections, report.turning_number
    (0.0, 0, 1)
    >>> report.on, report.proved, report.undecided
    ('curve', 8, ())

    """

    curve: str
    normals: int
    samples: int
    pieces: int
    straight_share: float
    inflections: int
    turning_number: int | None
    on: str = "spline"
    proved: int | None = None
    undecided: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class CurveSamples:
    """N samples of a planar curve in the order of their parameters; lengths in its unit L.

    Attributes
    ----------
    points : (N, 2) float64 array
        Points of the curve, in L.
    normals : (N, 2) float64 array
        Unit normals at the points: the tangent rotated clockwise by 90°.
    parameters : (N,) float64 array
        The parameters of the points.
    support : (N,) float64 array
        Support function h = n·x, in L.
    curvature : (N,) float64 array
        In 1/L, positive on a circle with outward normals. Its sign bit says which way the normal
        turns, even where the curvature is rounded to 0.
    normal_index : (N,) int64 array
        Rows of the prescribed normals.
    piece_index : (N,) int64 array
        Arcs of the spline that contain the points, or arcs of the curve on which the normal turns
        one way.
    ends : (2, 2) float64 array
        The ends of an open curve; (0, 2) for a closed one.
    report : CurveReport
        A report on the sampling.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(
    ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True, name="circle"
    ... )
    >>> samples = gm.curves.sample(circle, 8)
    >>> samples
    CurveSamples(8 points on circle)
    >>> samples.points.shape, samples.normals.shape, samples.parameters.shape
    ((8, 2), (8, 2), (8,))
    >>> samples.support.round(3), samples.curvature.round(2)
    (array([1., 1., 1., 1., 1., 1., 1., 1.]), array([1., 1., 1., 1., 1., 1., 1., 1.]))
    >>> sorted(samples.normal_index.tolist()), samples.piece_index.dtype
    ([0, 1, 2, 3, 4, 5, 6, 7], dtype('int64'))
    >>> samples.polygon.shape, samples.ends.shape, samples.report.inflections
    ((9, 2), (0, 2), 0)

    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    parameters: NDArray[np.float64]
    support: NDArray[np.float64]
    curvature: NDArray[np.float64]
    normal_index: NDArray[np.int64]
    piece_index: NDArray[np.int64]
    ends: NDArray[np.float64]
    report: CurveReport

    @property
    def polygon(self) -> NDArray[np.float64]:
        """(M, 2) float64 array: the vertices of the polygon through all samples, in order.

        The polygon of an open curve begins and ends at the ends of the curve; that of a closed
        curve repeats its first point at its end.
        """
        if len(self.ends):
            return np.concatenate([self.ends[:1], self.points, self.ends[1:]])
        return np.concatenate([self.points, self.points[:1]])

    def summary(self) -> str:
        """Return one line: the numbers of samples, normals and inflections, and the straight share.

        Returns
        -------
        str
            The line, without a line break.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(
        ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True
        ... )
        >>> gm.curves.sample(circle, 8).summary()
        '8 samples at 8 prescribed normals; 0 inflections...'

        """
        report, used = self.report, len(np.unique(self.normal_index))
        line = (
            f"{report.samples:,} samples {at_normals(used, report.normals)}; "
            f"{report.inflections} inflections; {100.0 * report.straight_share:.2f} % of the "
            "curve is straight"
        )
        if report.proved is None:
            return line
        return f"{line}; proved to be complete for {report.proved:,} of {report.normals:,} normals"

    def __len__(self) -> int:
        return len(self.support)

    def __repr__(self) -> str:
        return f"CurveSamples({len(self):,} points on {self.report.curve})"


@dataclass(frozen=True, eq=False)
class Hits:
    """Pairs of an arc and one of its normals, as indices, in order along the curve.

    `signs` are the signs of κ on the arcs.
    """

    piece_index: NDArray[np.int64]
    normal_index: NDArray[np.int64]
    signs: Array

    def __len__(self) -> int:
        return len(self.signs)


@in_memory
def sample(
    curve: Curve | CurveSpline,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    pieces: int | None = None,
    on: str | None = None,
) -> CurveSamples:
    """Return every point of a planar curve that has one of the given normals, each exactly once.

    Uniform normals give samples with the density |κ| (paper, Sect. 4.1). On the curve, all points
    are found with a proof, by bounds of its derivatives, which are available for SymPy expressions
    and for callables made of NumPy functions. The report lists normals that are `undecided`.

    Parameters
    ----------
    curve : Curve or CurveSpline
        The curve; a `Curve` is first approximated by a spline.
    count : int, optional
        The approximate number of samples, at uniform normals. Either this or `normals`.
    normals : (S, 2) array_like, optional
        Directions of any length but 0, such as ``gm.directions.circle(100)``.
    pieces : int, optional
        The number of arcs of the spline, see `fit`; samples then lie on the spline.
    on : {"curve", "spline"}, optional
        The curve on which samples lie. By default the curve itself if its derivatives can be
        bounded and `pieces` is not given; otherwise the spline, as for curves given by points.

    Returns
    -------
    CurveSamples
        The samples in order along the curve.

    Raises
    ------
    InputError
        For invalid arguments, and with ``on="curve"`` if the derivatives cannot be bounded.
    UnknownNameError
        For another value of `on`.
    SurfaceError
        For a curve that cannot be evaluated.

    Warns
    -----
    GaussmapWarning
        If parts of the curve are straight, so that no set of normals can sample them, or if `count`
        cannot be met.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(("cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
    >>> len(gm.curves.sample(circle, normals=gm.directions.circle(10)))
    10

    """
    if (normals is None) == (count is None):
        raise InputError("give either normals=... or count=..., and not both.")
    asked = None if count is None else checked_count(count)
    check_memory("curve", asked or 0)
    directions = None if normals is None else as_normals(normals, 2)
    if isinstance(curve, CurveSpline) and pieces is not None:
        raise InputError("pieces=... is for curves; this spline already has its pieces.")
    spline = _searched(curve, pieces, on)
    if directions is None:
        assert asked is not None
        directions, hits = _by_count(spline, asked)
    else:
        hits = find(spline, directions)
    if isinstance(spline, CurveSpline):
        samples = filled(spline, directions, hits)
    else:
        samples = filled_on_curve(spline, directions, hits)
    _warn(samples.report, asked)
    return samples


def _searched(
    curve: Curve | CurveSpline, pieces: int | None, on: str | None
) -> CurveSpline | CurveArcs:
    """Return the object to search: the arcs of a curve, or a spline."""
    place = None if on is None else known_name(on, PLACES, "place of samples of curves")
    if place == "curve" and pieces is not None:
        raise InputError('pieces=... is for on="spline"; on the curve itself there is no spline.')
    if isinstance(curve, Curve) and place != "spline" and pieces is None:
        arcs = arcs_of(curve)
        if arcs is not None:
            return arcs
    if place == "curve":
        raise InputError(
            f'on="curve" needs bounds of the derivatives of {curve.name!r}, as of SymPy '
            "expressions and of callables made of NumPy functions; leave out on=…."
        )
    return curve if isinstance(curve, CurveSpline) else fit(curve, pieces)


def find(spline: CurveSpline | CurveArcs, normals: Array) -> Hits:
    """Return all pairs of an arc and one of the unit normals (S, 2) that the arc has."""
    angles = angles_of(normals)
    order = np.argsort(angles, kind="stable")
    places = _places(spline, angles[order])
    steps = np.where(spline.reversing, 0, np.diff(places))
    counts, signs = np.abs(steps), np.sign(steps)
    first = np.where(steps > 0, places[:-1], places[:-1] - 1)
    owner, number = repeated(counts)
    ranks = first[owner] + signs[owner] * number
    return Hits(owner, order[np.mod(ranks, len(normals))], signs[owner].astype(np.float64))


def _places(spline: CurveSpline | CurveArcs, angles: Array) -> NDArray[np.int64]:
    """Return for each joint the number of sorted angles below the angle of its normal.

    For each full turn of the normal, the number of all angles is added. Along straight arcs the
    normal is constant. The ends of an open curve belong to the curve: the angles there are moved
    outwards by the rounding error of the normal.
    """
    ends, turns = spline.angles[0].copy(), spline.angles[1].copy()
    curved = np.flatnonzero(~spline.straight)
    with np.errstate(divide="ignore"):
        errors = spline.noise / np.hypot(*spline.joint_normals.T)
    start = int(curved[0]) + 1 if len(curved) else 1
    _merge_joints(ends, turns, errors, start if spline.periodic else 0)
    if not spline.periodic:
        for joint, outwards in ((0, -1.0), (-1, 1.0)):
            if not spline.straight[joint]:
                ends[joint] += outwards * math.copysign(errors[joint], spline.turning_angles[joint])
        beyond = (ends > np.pi).astype(np.int64) - (ends <= -np.pi)
        ends -= 2 * np.pi * beyond
        turns += beyond
    return np.searchsorted(angles, ends).astype(np.int64) + len(angles) * turns


def _merge_joints(angles: Array, turns: NDArray[np.int64], errors: Array, start: int) -> None:
    """Give neighbouring joints the same normal if their normals differ only by rounding.

    angles + 2π turns (P + 1,) are the angles at joints, errors (P + 1,) their rounding errors. On a
    closed curve the joints are visited from the joint `start` > 0 on; on an open curve, `start` is
    0.
    """
    pieces = len(angles) - 1
    whole = turns[pieces] - turns[0]
    bounds = 2.0 * np.minimum(errors[1:], errors[:-1])
    close = np.abs(np.diff(angles) + 2.0 * np.pi * np.diff(turns)) <= 2.0 * bounds
    visited = np.roll(np.arange(pieces), -start)[: pieces - (start > 0)]
    for before in visited[close[visited]].tolist():
        here = before + 1
        step = angles[here] - angles[before] + 2.0 * np.pi * (turns[here] - turns[before])
        if abs(step) <= bounds[before]:
            angles[here], turns[here] = angles[before], turns[before]
            if here == pieces and start > 0:
                angles[0], turns[0] = angles[here], turns[here] - whole


def _by_count(spline: CurveSpline | CurveArcs, count: int) -> tuple[Array, Hits]:
    """Return uniform normals with about `count` samples, and their `Hits`."""
    curved = np.flatnonzero(~spline.straight)
    total = float(np.abs(spline.turning_angles[curved]).sum())
    if total == 0.0:
        normals = circle(count)
        return normals, find(spline, normals)
    angles = spline.angles[0] + 2 * np.pi * spline.angles[1]
    joints = angles[np.concatenate([curved, curved + 1])]
    low, high = float(joints.min()), float(joints.max())
    width, density = min(high - low, 2 * np.pi), count / total
    best: tuple[Array, Hits] | None = None
    for _ in range(TRIES):
        size = max(1, round(density * width))
        normals = arc_of_normals(low, high, size) if high - low < 2 * np.pi else circle(size)
        hits = find(spline, normals)
        if best is None or abs(len(hits) - count) < abs(len(best[1]) - count):
            best = normals, hits
        if len(hits) == count:
            break
        density *= count / max(len(hits), 1)
    assert best is not None
    return best


def filled(spline: CurveSpline, normals: Array, hits: Hits) -> CurveSamples:
    """Return the samples on a spline at the `hits` of unit normals (S, 2)."""
    mine, piece = normals[hits.normal_index], hits.piece_index
    n, arcs = plane_vector(mine), spline._arcs(piece)
    A = mine[:, 0] * arcs.a.x + mine[:, 1] * arcs.a.y
    with np.errstate(all="ignore"):  # where κ ≈ 0
        # On an arc whose turning angle is within rounding, the parameter is arbitrary.
        inside = np.clip(python_function(formulas.arc_parameter)(arcs, n), 0.0, 1.0)
        t: Array = np.where(A != 0.0, inside, 0.5)
        x, curvature = python_function(formulas.arc_sample)(arcs, t, A)
    points = spline.coefficients[piece + 1] + np.stack(x, axis=-1) / spline.scale
    parameters = spline.domain[0] + spline.step * (piece + t)
    return _samples(spline, normals, hits, parameters, points, spline.scale * curvature)


def filled_on_curve(arcs: CurveArcs, normals: Array, hits: Hits) -> CurveSamples:
    """Return the samples at the `hits` of unit normals (S, 2), on the curve itself."""
    mine = normals[hits.normal_index]
    t = arcs.parameters(hits.piece_index, mine)
    samples = _samples(arcs, normals, hits, t, *arcs.at(t, mine))
    undecided = tuple(np.flatnonzero(arcs.undecided(normals)).tolist())
    proved = len(normals) - len(undecided)
    report = replace(samples.report, on="curve", proved=proved, undecided=undecided)
    return replace(samples, report=report)


def _samples(
    spline: CurveSpline | CurveArcs,
    normals: Array,
    hits: Hits,
    parameters: Array,
    points: Array,
    curvature: Array,
) -> CurveSamples:
    """Return samples at the `hits` of unit normals (S, 2), with their report."""
    mine = normals[hits.normal_index]
    report = CurveReport(
        curve=spline.name,
        normals=len(normals),
        samples=len(hits),
        pieces=spline.pieces,
        straight_share=_straight_share(spline, len(normals)),
        inflections=len(spline.inflections),
        turning_number=spline.turning_number,
    )
    ends = np.empty((0, 2)) if spline.periodic else spline.evaluate(np.array(spline.domain))
    return CurveSamples(
        points=points,
        normals=mine,
        parameters=parameters,
        support=np.einsum("kx,kx->k", mine, points),
        curvature=np.copysign(curvature, hits.signs),
        normal_index=hits.normal_index,
        piece_index=hits.piece_index,
        ends=ends,
        report=report,
    )


def _straight_share(spline: CurveSpline | CurveArcs, normals: int) -> float:
    """Return the share of the length where κ ≈ 0, which has no samples.

    An arc counts as straight if a curve of the total length, with the mean curvature of the arc,
    would get less than one sample.
    """
    joints = spline.scale * spline.evaluate(spline.joints)
    lengths = np.hypot(*np.diff(joints, axis=0).T)
    total = float(lengths.sum())
    if total == 0.0:
        return 1.0
    density = max(normals, LEAST_NORMALS) / (2 * np.pi)
    angles = np.where(spline.reversing, 0.0, np.abs(spline.turning_angles))
    straight = angles * total * density < lengths
    return float(lengths[straight].sum()) / total


def _warn(report: CurveReport, count: int | None) -> None:
    """Warn of straight parts, and of a count that is not reached."""
    reasons = []
    if report.straight_share > WORTH_A_WARNING:
        share = 100 * report.straight_share
        reasons.append(f"{share:.0f} % of its length is straight and has no samples")
    elif report.samples == 0:
        reasons.append("it has none of the normals")
    if count is not None and abs(report.samples - count) > 0.05 * count + 1:
        reasons.append(f"there are {report.samples} samples instead of the requested {count}")
    if reasons:
        message = f"curve {report.curve!r}: {'; '.join(reasons)}."
        warnings.warn(message, GaussmapWarning, stacklevel=3)
