"""Every preimage of every normal once: Σ sign κ is the turning number, and more."""

import warnings
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

import gaussmap as gm
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from ...products import covering
from ...refusals import refused
from ...shapes import EPS, TURN, Array

AXES = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])


def polar(radius: Callable[[Array], Array]) -> Callable[[Array], Array]:
    return lambda t: radius(t)[..., None] * np.stack([np.cos(t), np.sin(t)], axis=-1)


# name: the curve, its turning number, its inflections; without them all normals have as many points
CLOSED: dict[str, tuple[Callable[[Array], Array], int, int]] = {
    "circle": (polar(np.ones_like), 1, 0),
    "clockwise": (lambda t: np.stack([np.cos(t), -np.sin(t)], -1), -1, 0),
    "ellipse": (lambda t: np.stack([20 * np.cos(t), np.sin(t)], -1), 1, 0),
    "eight": (lambda t: np.stack([np.sin(t), np.sin(2 * t)], -1), 0, 2),
    "limacon": (polar(lambda t: 1 + 2 * np.cos(t)), 2, 0),
    "star": (polar(lambda t: 1 + np.cos(5 * t) / 5), 1, 10),
}


def closed(name: str, turn: Array | None = None, factor: float = 1.0, shift: float = 0.0):
    """Return a closed curve, turned, moved and scaled."""
    matrix = np.eye(2) if turn is None else turn
    f = CLOSED[name][0]
    return gm.curves.Curve.from_callable(
        lambda t: factor * (f(t) @ matrix.T + shift), TURN, True, name=name
    )


def rotation(angle: float) -> Array:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def sampled(
    curve: gm.curves.Curve | gm.curves.CurveSpline, normals: Array, pieces: int | None = None
):
    """Sample without the warnings, which have their own tests."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        return gm.curves.sample(curve, normals=normals, pieces=pieces)


def sums(samples: gm.curves.CurveSamples, count: int) -> NDArray[np.int64]:
    """Return Σ sign κ over the preimages of each normal."""
    signs = np.where(np.signbit(samples.curvature), -1, 1)
    return np.bincount(samples.normal_index, signs, minlength=count).astype(np.int64)


def is_sane(samples: gm.curves.CurveSamples) -> None:
    fields = (samples.points, samples.normals, samples.parameters, samples.support)
    assert all(np.isfinite(x).all() for x in (*fields, samples.curvature))
    # two normals that differ by rounding may share a place
    rounding = 8 * EPS * np.abs(samples.parameters).max(initial=0.0)
    assert (np.diff(samples.parameters) >= -rounding).all()
    assert (np.diff(samples.piece_index) >= 0).all()
    assert len(samples) == samples.report.samples == len(samples.points)


# --- exactly once ---------------------------------------------------------------------------------

SETS = {
    "axes": AXES,
    "one": np.array([[1.0, 0.0]]),
    "few": gm.directions.circle(3),
    "off the axes": gm.directions.circle(1000),
    "on the axes": np.column_stack([f(2 * np.pi * np.arange(720) / 720) for f in (np.cos, np.sin)]),
    "twice": np.repeat(gm.directions.circle(64), 2, axis=0),
}


@covering(name=CLOSED, normals=SETS.values(), pieces=[16, 63, 64, 720])
def test_sum_of_signs_is_the_turning_number(name: str, normals: Array, pieces: int) -> None:
    _, turning, inflections = CLOSED[name]
    spline = gm.curves.fit(closed(name), pieces)
    samples = sampled(spline, normals)
    is_sane(samples)
    assert (sums(samples, len(normals)) == turning).all()
    assert samples.report.turning_number == turning
    assert spline.turning_angles.sum() == pytest.approx(2 * np.pi * turning, abs=1e-12)
    if pieces > 16:
        assert samples.report.inflections == len(spline.inflections) == inflections
    if not inflections:
        counts = np.bincount(samples.normal_index, minlength=len(normals))
        assert (counts == abs(turning)).all()


@pytest.mark.compiled
@covering(
    name=["ellipse", "eight", "star"], factor=[1.0, 1e12, 1e-12, 1e150, 1e-150], shift=[0.0, 1e6]
)
def test_moved_and_scaled(name: str, factor: float, shift: float) -> None:
    for angle in (0.0, 0.7):
        turn = rotation(angle)
        normals = np.concatenate([gm.directions.circle(500), AXES]) @ turn.T
        for pieces in (64, 99):
            samples = sampled(closed(name, turn, factor, shift), normals, pieces)
            is_sane(samples)
            assert (sums(samples, len(normals)) == CLOSED[name][1]).all()


@pytest.mark.compiled
def test_more_pieces_than_the_coordinates_can_tell_apart() -> None:
    """Beside a shift of 10⁶ the turn of an arc is rounding; still no normal is lost or doubled."""
    normals = gm.directions.circle(360)
    near, far = (sampled(closed("star", shift=x), normals, 200_000) for x in (0.0, 1e6))
    for samples in (near, far):
        assert (sums(samples, 360) == 1).all()
    assert len(near) == len(far)
    # spacing(1e6) = 1e-10, an arc is 3e-5 long: angles to within about 8e-10/3e-5 or so
    assert np.abs(near.parameters - far.parameters).max() < 1e-2


# --- against exact arithmetic ---------------------------------------------------------------------


def exact_hits(spline: gm.curves.CurveSpline, normals: Array) -> set[tuple[int, int]]:
    """Return (piece, normal) by exact signs of n·p' at the ends of arcs, for generic normals."""
    mu = [[Fraction(x) for x in row] for row in spline.coefficients.tolist()]
    tangents = [(q[0] - p[0], q[1] - p[1]) for p, q in pairwise(mu)]
    hits = set()
    for number, (x, y) in enumerate(normals.tolist()):
        n = Fraction(x), Fraction(y)
        sides = [n[0] * d[0] + n[1] * d[1] for d in tangents]
        for piece in range(spline.pieces):
            (s, t), (p, q) = tangents[piece : piece + 2]
            area = s * q - t * p
            # n·p' falls where the normal turns towards n's left, as on a circle
            if area * sides[piece] > 0 > area * sides[piece + 1]:
                hits.add((piece, number))
    return hits


@pytest.mark.parametrize("name", CLOSED)
def test_hits_are_those_of_exact_arithmetic(name: str) -> None:
    spline = gm.curves.fit(closed(name), 40)
    normals = unit(gm.directions.circle(97) @ rotation(0.123).T)
    samples = sampled(spline, normals)
    assert (samples.normals == normals[samples.normal_index]).all()
    pairs = list(zip(samples.piece_index.tolist(), samples.normal_index.tolist(), strict=True))
    assert set(pairs) == exact_hits(spline, normals)
    assert len(set(pairs)) == len(pairs) > 0


def unit(vectors: Array) -> Array:
    return vectors / np.hypot(*vectors.T)[:, None]


points = st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=3, max_size=12)


@given(polygon=points, is_closed=st.booleans())
def test_any_small_integers(polygon: list[tuple[int, int]], is_closed: bool) -> None:
    """Straight arcs, cusps, stops and returns are all among these."""
    mu = np.array(polygon, dtype=np.float64)
    if is_closed:
        mu = np.concatenate([mu[-1:], mu, mu[:1]])
    spline = gm.curves.CurveSpline(mu, (0.0, float(len(mu) - 2)), is_closed, "integers")
    aligned = np.unique(spline.joint_normals, axis=0)
    aligned = aligned[aligned.any(axis=1)]
    generic = gm.directions.circle(13) @ rotation(0.1).T
    normals = unit(np.concatenate([aligned, -aligned, generic]))
    samples = sampled(spline, normals)
    is_sane(samples)
    pairs = zip(samples.piece_index.tolist(), samples.normal_index.tolist(), strict=True)
    chosen = [(k, j) for k, j in pairs if j >= 2 * len(aligned)]
    exact = {(k, j) for k, j in exact_hits(spline, normals) if j >= 2 * len(aligned)}
    assert set(chosen) == exact
    assert len(chosen) == len(exact)
    if is_closed and not spline.reversing.any():
        assert (sums(samples, len(normals)) == spline.turning_number).all()


# --- what a sample holds --------------------------------------------------------------------------


def test_samples_of_an_ellipse() -> None:
    """Convex curves at the distance d have support functions at most d apart."""
    curve = gm.curves.Curve.from_callable(
        lambda t: np.stack([3 * np.cos(t), 2 * np.sin(t)], -1), TURN, True
    )
    spline = gm.curves.fit(curve, 100)
    dense = np.linspace(*TURN, 10_001)
    apart = np.linalg.norm(spline.evaluate(dense) - curve.evaluate(dense), axis=1).max()
    normals = gm.directions.circle(333)
    samples = gm.curves.sample(spline, normals=normals)
    assert (samples.normals == normals[samples.normal_index]).all()
    exact = np.hypot(3 * samples.normals[:, 0], 2 * samples.normals[:, 1])
    assert np.abs(samples.support - exact).max() < 1.01 * apart
    assert (samples.support == np.einsum("kx,kx->k", samples.normals, samples.points)).mean() > 0.5
    places = samples.parameters
    # t = −B/A: both lose a few roundings of |p'|; the step and the number of pieces cancel
    np.testing.assert_allclose(spline.normals(places), samples.normals, rtol=0, atol=200 * EPS)
    np.testing.assert_allclose(spline.evaluate(places), samples.points, rtol=0, atol=200 * EPS)
    np.testing.assert_allclose(spline.curvature(places), samples.curvature, rtol=1e-10)


@pytest.mark.compiled
def test_normals_of_any_length() -> None:
    curve = closed("eight")
    lengths = np.geomspace(1e-300, 1e300, 100)[:, None]
    long, unit = (
        gm.curves.sample(curve, normals=x)
        for x in (gm.directions.circle(100) * lengths, gm.directions.circle(100))
    )
    np.testing.assert_allclose(long.normals, unit.normals, rtol=0, atol=4 * EPS)
    assert (long.normal_index == unit.normal_index).all()


# --- ends -----------------------------------------------------------------------------------------


@covering(angle=[0.0, 0.3, 2.0, 3.1], pieces=[1, 2, 3, 7, 50], sign=[1.0, -1.0])
def test_ends_belong_to_an_open_curve(angle: float, pieces: int, sign: float) -> None:
    """The normals of both ends of a parabola; those against them and beyond them are not there."""
    turn = rotation(angle)
    parabola = gm.curves.Curve.from_callable(
        lambda t: np.stack([t, sign * t * t], axis=-1) @ turn.T, (0.0, 1.0)
    )
    ends = np.array([[0.0, -1.0], [2.0 * sign, -1.0]])
    beyond = np.array([[-1e-6 * sign, -1.0], [(2.0 + 1e-5) * sign, -1.0]])
    samples = gm.curves.sample(
        parabola, normals=np.concatenate([ends, -ends, beyond]) @ turn.T, pieces=pieces
    )
    assert samples.normal_index.tolist() == [0, 1]
    assert (np.signbit(samples.curvature) == (sign < 0)).all()
    np.testing.assert_allclose(samples.parameters, [0.0, 1.0], rtol=0, atol=1e-12)


def test_polygon() -> None:
    open_ = gm.curves.Curve.from_callable(CLOSED["ellipse"][0], (0.0, 3.0))
    samples = gm.curves.sample(open_, count=20)
    assert len(samples.polygon) == len(samples) + 2
    np.testing.assert_allclose(samples.polygon[[0, -1]], open_.evaluate([0.0, 3.0]), atol=1e-14)
    samples = gm.curves.sample(closed("ellipse"), count=20)
    assert len(samples.polygon) == 21
    assert (samples.polygon[0] == samples.polygon[-1]).all()


# --- straight pieces ------------------------------------------------------------------------------


def stadium(
    turn: Array, shift: float = 0.0, start: float = 0.0, side: float = 2.0
) -> gm.curves.Curve:
    """Two straight sides and two half circles of radius 1, each a quarter of the parameters."""

    def f(t: Array) -> Array:
        quarter, s = np.divmod(np.mod(t, 4.0), 1.0)
        angle = np.pi * s
        straight = np.stack([side * (s - 0.5), -np.ones_like(s)], axis=-1)
        bend = np.stack([side / 2 + np.sin(angle), -np.cos(angle)], axis=-1)
        half = np.where((quarter % 2 == 0)[..., None], straight, bend)
        return np.where((quarter < 2)[..., None], half, -half) @ turn.T + shift

    return gm.curves.Curve.from_callable(f, (start, start + 4.0), True, name="stadium")


@covering(
    angle=[0.0, 0.3, 1.234],
    shift=[0.0, 1e6],
    start=[0.0, 0.5, 1.5],
    normals=[AXES, gm.directions.circle(100)],
)
def test_stadium(angle: float, shift: float, start: float, normals: Array) -> None:
    """Every normal once, also the one that a whole side has; the warning says how much is straight.

    The spline bends the last piece of each side towards the half circle.
    """
    turn = rotation(angle)
    with pytest.warns(gm.GaussmapWarning, match=r"3\d % of its length is straight"):
        samples = gm.curves.sample(stadium(turn, shift, start), normals=normals @ turn.T, pieces=64)
    is_sane(samples)
    assert (np.bincount(samples.normal_index, minlength=len(normals)) == 1).all()
    length = 4 + 2 * np.pi
    share = samples.report.straight_share
    assert (4 - 4 * 2 / 16) / length - 1e-3 < share < 4 / length + 1e-3
    assert samples.report.turning_number == 1


@pytest.mark.parametrize(("share", "is_said"), [(0.007, False), (0.015, True)])
def test_a_straight_part_is_said_if_it_is_more_than_a_hundredth(share: float, is_said: bool):
    """The spline bends the last piece of each of the sides, which have 16."""
    side = 16.0 / 14.0 * share / (1.0 - share) * np.pi
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        samples = gm.curves.sample(stadium(np.eye(2), side=side), normals=AXES, pieces=64)
    assert samples.report.straight_share == pytest.approx(share, rel=0.1)
    assert len(caught) == is_said


@covering(angle=[0.0, 0.7, 2.0], shift=[0.0, 0.1, 1e6])
def test_a_straight_line_has_no_samples(angle: float, shift: float) -> None:
    turn = rotation(angle)
    line = gm.curves.Curve.from_callable(
        lambda t: np.stack([t, 0 * t], axis=-1) @ turn.T + shift, (0.0, 1.0), name="line"
    )
    with pytest.warns(gm.GaussmapWarning, match="'line': 100 % of its length is straight"):
        samples = gm.curves.sample(line, normals=AXES @ turn.T)
    assert len(samples) == 0
    assert samples.report.straight_share == 1.0
    assert len(samples.polygon) == 2
    with pytest.warns(gm.GaussmapWarning, match="0 samples instead of the requested 50"):
        assert len(gm.curves.sample(line, count=50)) == 0


def test_points_of_a_square() -> None:
    """A C¹ spline through the corners and middles of a square rounds the corners."""
    corners = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]]
    square = gm.curves.Curve.from_points(corners, closed=True)
    for normals in (AXES, gm.directions.circle(4), gm.directions.circle(100)):
        samples = gm.curves.sample(square, normals=normals)
        assert (np.bincount(samples.normal_index, minlength=len(normals)) == 1).all()


# --- count ----------------------------------------------------------------------------------------


@pytest.mark.compiled
@pytest.mark.parametrize("count", [1, 2, 7, 100, 1000])
def test_count_is_exact_without_inflections(count: int) -> None:
    assert len(gm.curves.sample(closed("ellipse"), count=count)) == count
    assert len(gm.curves.sample(closed("limacon"), count=2 * count)) == 2 * count
    arc = gm.curves.Curve.from_callable(CLOSED["circle"][0], (3.0, 3.5))  # across the angle π
    samples = gm.curves.sample(arc, count=count)
    assert len(samples) == samples.report.normals == count


@pytest.mark.compiled
@covering(name=["eight", "star"], count=[20, 100, 1000])
def test_count_is_nearly_met_with_inflections(name: str, count: int) -> None:
    assert abs(len(gm.curves.sample(closed(name), count=count)) - count) <= 0.05 * count + 1


def test_what_cannot_be_met_is_said() -> None:
    with pytest.warns(gm.GaussmapWarning, match="samples instead of the requested 1"):
        assert len(gm.curves.sample(closed("star"), count=1)) > 2
    arc = gm.curves.Curve.from_callable(CLOSED["circle"][0], (0.0, 1.0), name="arc")
    with pytest.warns(gm.GaussmapWarning, match="'arc': it has none of the normals"):
        assert len(gm.curves.sample(arc, normals=[[-1.0, 0.0]])) == 0


# --- arguments, words -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [({}, "either normals"), ({"normals": AXES, "count": 3}, "not both"),
     ({"count": 0}, "at least 1"), ({"count": -4}, "at least 1"), ({"count": 2.5}, "whole number"),
     ({"normals": np.empty((0, 2))}, r"\(S, 2\)"), ({"normals": np.eye(3)}, r"\(S, 2\)"),
     ({"normals": [[1, 0], [0, 0]]}, r"normals\[1\] is the zero vector"),
     ({"normals": [[1, np.nan]]}, r"normals\[0\] holds NaN"), ({"normals": "xy"}, "real numbers"),
     ({"count": 9, "pieces": 2}, "at least 3 pieces"), ({"count": 9, "pieces": 0}, "pieces must")],
)  # fmt: skip
def test_unusable_arguments(arguments: dict, complaint: str) -> None:
    refused(complaint, gm.curves.sample, closed("circle"), **arguments)


def test_a_spline_has_its_pieces() -> None:
    spline = gm.curves.fit(closed("circle"), 10)
    refused("already has its pieces", gm.curves.sample, spline, normals=AXES, pieces=10)
    assert len(gm.curves.sample(spline, normals=AXES)) == 4
    refused("takes a Curve, not Surface", gm.curves.sample, gm.surfaces.torus(), normals=AXES)


def test_words() -> None:
    samples = gm.curves.sample(closed("eight"), normals=gm.directions.circle(10))
    assert repr(samples) == f"CurveSamples({len(samples)} points on eight)"
    found = len(set(samples.normal_index.tolist()))
    assert samples.summary() == (
        f"{len(samples)} samples at {found} of 10 prescribed normals; 2 inflections; "
        "0.15 % of the curve is straight; proved to be complete for 10 of 10 normals"
    )


# --- samples on the curve itself ------------------------------------------------------------------

Curve = gm.curves.Curve


def star(lobes: int = 5, depth: float = 0.3) -> Curve:
    r = f"(1 + {depth}*cos({lobes}*t))"
    return Curve.from_sympy((f"{r}*cos(t)", f"{r}*sin(t)"), "t", (0, "2*pi"), True, name="star")


def tangents_of_star(t: Array, lobes: int = 5, depth: float = 0.3) -> Array:
    """Return x′, by the product rule."""
    r, d = 1 + depth * np.cos(lobes * t), -depth * lobes * np.sin(lobes * t)
    return np.stack([d * np.cos(t) - r * np.sin(t), d * np.sin(t) + r * np.cos(t)], axis=-1)


def counted(tangents: Callable[[Array], Array], normals: Array, turn: float) -> list[int]:
    """Return how many points have each normal: the changes of sign at 200,000 parameters."""
    t = np.linspace(0.0, turn, 200_001)
    x = tangents(t)
    outward = np.stack([x[:, 1], -x[:, 0]], axis=-1)
    found = []
    for n in normals:
        below = x @ n < 0.0
        places = np.flatnonzero(below[:-1] != below[1:])
        found.append(int(np.count_nonzero(outward[places] @ n > 0.0)))
    return found


@pytest.mark.compiled
@pytest.mark.parametrize(("lobes", "depth"), [(5, 0.3), (7, 0.1), (3, 0.9)])
def test_every_point_of_a_star(lobes: int, depth: float) -> None:
    curve, normals = star(lobes, depth), gm.directions.circle(500)
    samples = gm.curves.sample(curve, normals=normals)
    expected = counted(lambda t: tangents_of_star(t, lobes, depth), normals, 2 * np.pi)
    assert np.bincount(samples.normal_index, minlength=500).tolist() == expected
    x = tangents_of_star(samples.parameters, lobes, depth)
    found = np.stack([x[:, 1], -x[:, 0]], axis=1) / np.linalg.norm(x, axis=1, keepdims=True)
    assert np.abs(found - normals[samples.normal_index]).max() < 1e-12
    assert np.allclose(samples.points, curve.evaluate(samples.parameters), atol=1e-14)
    signs = np.bincount(samples.normal_index, np.sign(samples.curvature))
    assert (signs == samples.report.turning_number).all()
    assert samples.report.proved == 500
    assert samples.report.on == "curve"
    assert samples.report.inflections == 2 * lobes


def test_where_they_lie() -> None:
    spline = gm.curves.fit(star(), 64)
    normals = gm.directions.circle(16)
    assert gm.curves.sample(spline, normals=normals).report.on == "spline"
    assert gm.curves.sample(star(), normals=normals, pieces=64).report.on == "spline"
    assert gm.curves.sample(star(), normals=normals, on="spline").report.proved is None
    points = Curve.from_points(star().evaluate(np.linspace(0, 6, 40)), closed=True)
    assert gm.curves.sample(points, normals=normals).report.on == "spline"
    untraced = Curve.from_callable(
        lambda t: np.stack([np.where(t > 1.0, t, t), t**2], axis=-1), (-1.0, 2.0)
    )
    assert gm.curves.sample(untraced, normals=[[0.5, -1.0]]).report.on == "spline"
    with pytest.raises(gm.errors.InputError, match="needs bounds of the derivatives"):
        gm.curves.sample(untraced, normals=normals, on="curve")
    with pytest.raises(gm.errors.InputError, match=r'pieces=\.\.\. is for on="spline"'):
        gm.curves.sample(star(), 10, pieces=64, on="curve")
    with pytest.raises(gm.errors.UnknownNameError):
        gm.curves.sample(star(), 10, on="surface")


def test_normals_of_inflections_and_cusps_are_undecided() -> None:
    cubic = Curve.from_sympy(("t", "t**3 + t/2"), "t", (-1, 1), name="cubic")
    normals = [[0.5, -1.0], [1.0, -1.0], [0.2, -1.0]]
    report = gm.curves.sample(cubic, normals=normals).report
    assert report.undecided == (0,)
    assert (report.proved, report.samples >= 2) == (2, True)
    cusp = Curve.from_sympy(("t**2", "t**3"), "t", (-1, 1), name="cusp")
    samples = gm.curves.sample(cusp, normals=[[0.3, -1.0], [1.0, 0.0]])
    assert samples.report.proved == 0
    assert samples.report.undecided == (0, 1)
