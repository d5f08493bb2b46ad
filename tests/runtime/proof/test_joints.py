"""The proof at joints: lines where smooth parts of a surface meet, with points in closed form."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import gaussmap as gm
import numpy as np
import pytest

from ...shapes import AXES, CIRCLE, MERIDIAN, WEIGHTS, conics
from .judge import Array, counts, curvature_at, near, new_index, normals_at, nurbs, unit
from .nets import bernstein

AROUND = unit(np.concatenate([gm.icosphere(8), AXES]))


class Asked(NamedTuple):
    """A surface, normals, and all points that have them: arrays (S, 3) of points with one K."""

    surface: gm.Surface
    normals: Array
    points: list[Array]
    signs: list[int]


def turned(profile: Array, scales: Array, digits: int) -> gm.Surface:
    """Return arcs that are turned about z and scaled, a NURBS with double knots.

    Weights have some digits. Since products of weights are rounded, arcs meet in creases.
    """
    points = np.array([[(r * x, r * y, z) for r, z in profile] for x, y in CIRCLE]) * scales
    net = np.round(np.outer(WEIGHTS, WEIGHTS[: len(profile)]), digits)
    return gm.Surface.from_nurbs((2, 2), (conics(CIRCLE), conics(profile)), points, net)


def ellipsoid(digits: int) -> Asked:
    scales = np.array([3.0, 2.0, 1.0])
    surface = turned(MERIDIAN, scales, digits)
    return Asked(surface, AROUND, [unit(AROUND * scales) * scales], [1])


def torus(digits: int) -> Asked:
    normals = AROUND[np.abs(AROUND[:, 2]) < 0.999]
    surface = turned(0.7 * CIRCLE + [2.0, 0.0], np.ones(3), digits)
    ring = 2.0 * unit(normals * [1.0, 1.0, 0.0])
    return Asked(surface, normals, [0.7 * normals + ring, 0.7 * normals - ring], [1, -1])


def interpolated(values: Array, degrees: tuple[int, int]) -> Array:
    """Return control points of the polynomial that has values (p + 1, q + 1, 3) at equal steps."""
    for axis, p in enumerate(degrees):
        inverse = np.linalg.inv(bernstein(p, np.linspace(0.0, 1.0, p + 1), 0))
        values = np.moveaxis(np.tensordot(inverse, values, (1, axis)), 0, axis)
    return values


def graph(sign: int, ratio: float, slope: float, skew: float) -> Asked:
    """Return a graph of two parts whose parameters do not fit, and points of their joint.

    On the line x = 1 tangent planes are those of both parts, but x_u is ratio + slope v times as
    long on one side, and in another direction; second derivatives jump. K has a sign.
    """

    def height(x: Array, y: Array) -> Array:
        more = np.where(x > 1.0, 0.5 * sign * (x - 1.0) ** 2, 0.0)
        return 0.3 * sign * x * x + 0.4 * y * y + 0.1 * x * y + 0.03 * y**3 + more

    s, t = np.meshgrid(np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 4), indexing="ij")
    parts = [(s, t), (1.0 + 0.3 * s * (ratio + slope * t), t + 0.06 * skew * s)]
    nets = [interpolated(np.stack([x, y, height(x, y)], axis=-1), (4, 3)) for x, y in parts]
    knots = np.repeat([0.0, 1.0, 2.0], [5, 4, 5]), np.repeat([0.0, 1.0], 4)
    surface = gm.Surface.from_nurbs((4, 3), knots, np.concatenate([nets[0], nets[1][1:]]))
    y = np.linspace(0.1, 0.9, 20)
    slopes = 0.6 * sign + 0.1 * y, 0.8 * y + 0.1 + 0.09 * y**2
    normals = unit(np.stack([-slopes[0], -slopes[1], np.ones_like(y)], axis=1))
    points = np.stack([np.ones_like(y), y, height(np.ones_like(y), y)], axis=1)
    return Asked(surface, normals, [points], [sign])


# The normals of both sides of joints differ by up to 1e-9 in the first ones.
ASKED: dict[str, Callable[[], Asked]] = {
    **{
        f"{make.__name__}, {digits} digits": partial(make, digits)
        for make in (ellipsoid, torus)
        for digits in (16, 12, 11, 10, 9)
    },
    **{
        f"graph {x}": partial(graph, *x)
        for sign in (1, -1)
        for x in (
            (sign, 3.3, 0.0, 0.0), (sign, 10.0, 0.0, 0.0), (sign, 0.9, 1.0, 0.5),
            (sign, 0.8, 0.9, -1.0), (sign, 0.3, 0.4, 0.0), (sign, 2.0, 3.0, 1.0),
        )
    },
}  # fmt: skip


@pytest.mark.parametrize("name", ASKED)
def test_points_on_joints_are_found_once(name: str) -> None:
    asked = ASKED[name]()
    digits = int(name.split()[1]) if "digits" in name else 16
    found = new_index(asked.surface).query(asked.normals)
    assert len(found.undecided.numbers) == 0
    np.testing.assert_array_equal(counts(found, asked.normals), len(asked.points))
    points = asked.surface.evaluate(*found.uv.T)
    away = [np.linalg.norm(points - x[found.numbers], axis=1) for x in asked.points]
    np.testing.assert_array_equal(found.sign, np.take(asked.signs, np.argmin(away, axis=0)))
    # A surface with rounded weights differs from the exact one by about the last digit.
    assert (np.min(away, axis=0) < 1e-7 + 10.0 ** (1 - digits)).all()
    assert (np.sort(found.radius[:, 0])[:-4] < 1e-6).all()  # those of poles are any angle


@pytest.mark.parametrize(("degree", "repeated"), [(2, 1), (3, 2)])
def test_points_on_knots(degree: int, repeated: int) -> None:
    """Where K keeps its sign across a knot, points on it are found; else they are in small boxes.

    There the surface has a fold along the knot: none, one or two points have the normal, all near.
    """
    surface, known = nurbs(degree, repeated)
    rng = np.random.default_rng(15)
    u, v = rng.choice([0.25, 0.5, 0.75], 100), rng.uniform(0.01, 0.99, 100)
    u[70:90], v[70:90] = v[70:90].copy(), u[70:90].copy()
    u[90:], v[90:] = np.divmod(np.arange(9.0).repeat(2)[:10], 3)
    u[90:], v[90:] = 0.25 + 0.25 * u[90:], 0.25 + 0.25 * v[90:]
    found = known.query(normals_at(surface, u, v))
    nearby = [curvature_at(surface, u + 1e-9 * i, v + 1e-9 * j) for i in (-1, 1) for j in (-1, 1)]
    is_kept = np.abs(np.sign(nearby).sum(axis=0)) == 4.0
    assert 30 < is_kept.sum() < 80
    hits = near(surface, found, u, v, 1e-9)
    u_low, u_high, v_low, v_high = found.undecided.boxes.T
    here = found.undecided.numbers
    holds = (u_low <= u[here]) & (u[here] <= u_high) & (v_low <= v[here]) & (v[here] <= v_high)
    is_open = np.isin(np.arange(len(u)), here[holds])
    np.testing.assert_array_equal(hits, is_kept)
    np.testing.assert_array_equal(is_open, ~is_kept)
    assert np.maximum(u_high - u_low, v_high - v_low)[holds].max() < 1e-6
    away = np.abs(found.uv - np.stack([u, v], axis=1)[found.numbers])
    mine = (away < 1e-6).all(axis=1)
    assert (away <= found.radius)[mine].all()
    assert (found.radius < 1e-6).all()


def test_a_crease_is_no_joint() -> None:
    """A crease of 1.2e-8 rad is an edge, and ends what is smooth; one of 1e-9 rad is none."""
    rough, smooth = (new_index(turned(MERIDIAN, np.array([15.0, 20.0, 5.0]), k)) for k in (8, 9))
    assert len(rough.index.joints.u) + len(rough.index.joints.v) < 5
    assert len(smooth.index.joints.u) + len(smooth.index.joints.v) == 5


@pytest.mark.parametrize(("digits", "axis", "line"), [(7, 0, 2.0), (8, 1, 1.0)])
def test_normals_beside_a_crease(digits: int, axis: int, line: float) -> None:
    """Between the normals of both sides, each side or none has a point; beyond them, one side."""
    surface = turned(MERIDIAN, np.array([15.0, 20.0, 5.0]), digits)
    along = np.linspace(0.3, 0.7, 40) + np.arange(40) % 2
    sides = [(np.full(40, line + step), along)[:: 1 - 2 * axis] for step in (-1e-15, 1e-15)]
    jets = [surface.jets(*x) for x in sides]
    below, above = (unit(np.cross(x[:, 1], x[:, 2])) for x in jets)
    assert (np.abs(above - below).max(axis=1) > 1e-9).all()
    shares = np.array([-2.0, -0.1, 0.2, 0.7, 1.1, 2.0])[:, None, None]
    normals = unit((below + shares * (above - below)).reshape(-1, 3))
    known = gm.GaussMap(surface)
    samples = known.points(normals)
    assert not samples.report.undecided
    np.testing.assert_array_equal(known.degree(normals), 1)
    is_between = np.repeat((shares > 0.0) & (shares < 1.0), len(along))
    kinds, numbers = samples.component, samples.normal_index
    creases, regular = (
        np.bincount(numbers[kinds == x], minlength=len(normals))
        for x in (gm.Component.CREASE, gm.Component.REGULAR)
    )
    np.testing.assert_array_equal(creases, is_between)
    np.testing.assert_array_equal(regular[~is_between], 1)
    assert np.isin(regular[is_between], (0, 2)).all()


def test_points_of_creases_on_both_sides_of_a_corner_at_the_seam() -> None:
    """They are close to each other, but on different creases."""
    turn = np.linalg.qr(np.array([(3.0, 1.0, 2.0), (1.0, 4.0, 1.0), (2.0, -1.0, 5.0)]))[0]
    net = np.array([[(r * x, r * y, z) for r, z in 0.7 * CIRCLE + [2.0, 0.0]] for x, y in CIRCLE])
    knots, weights = conics(CIRCLE), np.outer(WEIGHTS, WEIGHTS)
    surface = gm.Surface.from_nurbs((2, 2), (knots, knots), (net @ turn.T).round(7), weights)
    shifts = 3e-8 * np.random.default_rng(8).normal(size=(50, 3))
    known, normals = gm.GaussMap(surface), unit(shifts - turn[:, 0])
    listed = [x.normal for x in known.points(normals).report.undecided or ()]
    assert len(listed) < 5
    assert (np.delete(known.degree(normals), listed) == 0).all()


def test_creases_that_meet_at_a_pole_have_no_point_there() -> None:
    """At a pole x_u is 0, and a normal that is perpendicular to x_v is not that of the surface."""
    surface = turned(MERIDIAN, np.array([3.0, 2.0, 1.0]), 6)
    samples = gm.GaussMap(surface).points(AROUND)
    at = samples.points[samples.component == gm.Component.CREASE]
    assert len(at) > 20
    assert (np.abs(at[:, 2]) < 1.0 - 1e-9).all()
