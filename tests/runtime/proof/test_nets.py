"""Components of NURBS surfaces at special and random normals; `nets.py` judges regular points."""

from collections.abc import Callable
from functools import partial
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.interpolate import BPoly, PPoly

from ...shapes import CIRCLE, MERIDIAN, WEIGHTS, bezier
from .judge import Array, unit
from .nets import Net, revolved, wrong_at

HALF = np.sqrt(0.5)
SHEAR = np.array([[2, 0.3, 0.1], [0, 1.5, 0.4], [0.2, 0, 1]])
PLAIN = np.eye(3)
VASE = [(0, -6), (4, -6), (7, -3), (3.5, 0.5), (5, 4), (3, 7), (0, 7)]
BOTTLE = [(0, -3), (3, -3), (1.2, -1), (2.5, 1.5), (2, 3.5), (0, 3.5)]
CAPSULE = [(0, -1), (1, -1), (1, 0), (1, 0.5), (1, 1), (1, 2), (0, 2)]
CAN = [
    (0, -1), (1.5, -1), (2, -1), (3, -1), (3, 0), (3, 0.4), (3, 1), (3, 2), (2, 2), (1, 2), (0, 2),
]  # fmt: skip
# A square with round corners, and middles of its sides.
ROUNDED = np.array(
    [(1.5, 1), (2, 1), (2, 0.5), (2, 0), (2, -0.5), (2, -1), (1.5, -1), (0.5, -1), (-0.5, -1),
     (-1, -1), (-1, -0.5), (-1, 0), (-1, 0.5), (-1, 1), (-0.5, 1), (0.5, 1), (1.5, 1)]
)  # fmt: skip


def clamped(degree: int, *inner: float) -> Array:
    return np.array([*[0.0] * (degree + 1), *inner, *[1.0] * (degree + 1)])


def conics(profile: Any, weights: Any, matrix: Array = PLAIN, digits: int = 17) -> Net:
    return revolved(profile, weights, bezier(2, len(profile)), matrix, digits)


def graph(degrees: tuple[int, int], knots: tuple[Array, Array], height: float) -> Net:
    """Return a graph of random heights, with random weights unless it is quadratic."""
    rng = np.random.default_rng(7)
    at = [
        np.array([x[k + 1 : k + p + 1].mean() for k in range(len(x) - p - 1)])
        for p, x in zip(degrees, knots, strict=True)
    ]
    x, y = np.meshgrid(*at, indexing="ij")
    points = np.stack([x, y, height * rng.normal(size=x.shape)], axis=2)
    weights = rng.uniform(0.6, 1.6, x.shape) if degrees != (2, 2) else np.ones(x.shape)
    return Net(degrees, knots, points, weights)


RING, FLAT = CIRCLE * 0.7 + np.array([2, 0]), ROUNDED + np.array([3, 0])
# Surfaces, and their Euler characteristics if they are closed.
NETS: dict[str, tuple[Callable[[], Net], int | None]] = {
    "ellipsoid, sheared": (partial(conics, MERIDIAN, WEIGHTS[:5], SHEAR), 2),
    "ellipsoid, 10 digits": (
        partial(conics, MERIDIAN, WEIGHTS[:5], np.diag([15.0, 20, 5]), digits=10), 2
    ),
    "torus, sheared": (partial(conics, RING, WEIGHTS, SHEAR), 0),
    "torus, 10 digits": (partial(conics, RING, WEIGHTS, PLAIN, digits=10), 0),
    "vase": (partial(revolved, VASE, [1] * 7, clamped(3, 0.25, 0.5, 0.75), PLAIN), 2),
    "bottle": (
        partial(revolved, BOTTLE, [1, 0.8, 1.3, 0.7, 1.1, 1], clamped(5), np.diag([1, 0.8, 1])), 2
    ),
    "capsule": (partial(conics, CAPSULE, [1, HALF, 1, 1, 1, HALF, 1]), 2),
    "can": (
        partial(conics, CAN, [1, 1, 1, HALF, 1, 1, 1, HALF, 1, 1, 1], np.diag([1, 1.2, 1])), 2
    ),
    "rounded ring": (partial(conics, FLAT, [1, HALF, 1, 1] * 4 + [1]), 0),
    "quartic": (
        partial(graph, (4, 3), (clamped(4, 0.2, 0.2, 0.55, 0.8), clamped(3, 0.3, 0.3, 0.5)), 0.12),
        None,
    ),
    "quadratic": (
        partial(graph, (2, 2), (clamped(2, 0.2, 0.4, 0.6, 0.8), clamped(2, 0.25, 0.5)), 0.1), None
    ),
}  # fmt: skip


# Two caps of a unit sphere, 1 rad wide; two barrels; a ring with a corner at its seam.
C, LOW = np.cos(0.5), np.cos(1.0)
CAP = np.array([(0, LOW - 1), (np.tan(0.5), LOW - 1), (np.sin(1), 0)])
BARREL = [(0, -2), (1.5, -2), (1.5, -1), (1.5, -0.5), (0.5, 0)]
CORNER = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (0.5, -1), (1, 0)])
CREASED: dict[str, tuple[Callable[[], Net], int]] = {
    "lens": (partial(conics, [*CAP, *(CAP[1::-1] * [1, -1])], [1, C, 1, C, 1]), 2),
    "lens, sheared": (partial(conics, [*CAP, *(CAP[1::-1] * [1, -1])], [1, C, 1, C, 1], SHEAR), 2),
    "hourglass": (
        partial(conics, [*BARREL, *(np.array(BARREL[3::-1]) * [1, -1])],
                [1, HALF, 1, 1, 1, 1, 1, HALF, 1], np.diag([1, 1.2, 1])), 2,
    ),
    "corner at the seam": (
        partial(conics, CORNER * 0.7 + [3, 0], [1, 0.8, 1, 0.9, 1, 0.7, 1, 0.8, 1], SHEAR), 0
    ),
    # The normals of both sides differ by about 1e-8 rad.
    "ellipsoid, 8 digits": (
        partial(conics, MERIDIAN, WEIGHTS[:5], np.diag([15.0, 20, 5]), digits=8), 2
    ),
}  # fmt: skip


def directions(frequency: int, count: int) -> Array:
    """Return axes, an icosphere, tilted equators and random normals."""
    t = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    equator = np.stack([np.cos(t), np.sin(t), 0.0 * t], axis=1)
    tilts = [np.linalg.qr(np.random.default_rng(k).normal(size=(3, 3)))[0] for k in range(3)]
    tilted = [equator @ x for x in (PLAIN, *tilts, np.linalg.inv(SHEAR))]
    axes = [np.eye(3), -np.eye(3)]
    random = gm.directions.random(count, seed=11)
    return unit(np.concatenate([*axes, gm.icosphere(frequency), *tilted, random]))


@pytest.mark.parametrize(
    ("name", "normals"),
    [
        # Segments of cylinders, and discs at poles, which end inside of the surface.
        *((x, directions(1, 1)[:40]) for x in ("capsule", "can")),
        *(pytest.param(x, directions(8, 10_000), marks=pytest.mark.slow) for x in NETS),
    ],
)
def test_components_of_nurbs(name: str, normals: Array) -> None:
    make, euler = NETS[name]
    net = make()
    known = gm.GaussMap(net.surface)
    found = known.points(normals)
    listed = {x.normal for x in found.report.undecided or ()}
    assert len(listed) <= len(normals) / 1000
    assert not listed & set(range(6))
    assert wrong_at(net, normals, found) <= listed
    if euler is not None:
        degree = known.degree(normals)
        assert set(np.flatnonzero(degree != euler // 2).tolist()) <= listed


@pytest.mark.parametrize(
    ("name", "normals"),
    [
        ("lens", directions(1, 1)[:60]),
        *(pytest.param(x, directions(8, 10_000), marks=pytest.mark.slow) for x in CREASED),
    ],
)
def test_creases_have_the_normals_between_those_of_both_sides(name: str, normals: Array) -> None:
    """Judged by the slopes of the height on both sides, and by the sum of indices."""
    make, euler = CREASED[name]
    net = make()
    known = gm.GaussMap(net.surface)
    found = known.points(normals)
    assert found.report.undecided == ()
    np.testing.assert_array_equal(known.degree(normals), euler // 2)
    if name == "lens":
        np.testing.assert_array_equal(known.count(normals), 1)
    assert found.component is not None
    points = found[found.component == gm.Component.CREASE]
    assert len(points) > 0
    n, step = normals[points.normal_index], 1e-6
    low, high = np.ptp(net.spans[0]), net.spans[0][0]
    sides = [
        net.surface.evaluate(high + (points.uv[:, 0] + x - high) % low, points.uv[:, 1])
        for x in (-step, 0.0, step)
    ]
    rise = [((x - sides[1]) * n).sum(axis=1) for x in (sides[0], sides[2])]
    assert (np.sign(rise[0]) == np.sign(rise[1])).all()
    along = net.surface.jets(*points.uv.T)[:, 2]
    assert (np.abs((along * n).sum(axis=1)) < 1e-8 * np.linalg.norm(along, axis=1)).all()
    np.testing.assert_array_equal(points.gaussian_curvature, 0.0)
    if len(net.surface.pieces()) == 1:  # others have no streams
        streamed = gm.Samples.concatenate(gm.sample_stream(net.surface, normals=normals, chunk=100))
        np.testing.assert_array_equal(streamed.component, found.component)
        np.testing.assert_array_equal(streamed.points, found.points)


def test_zeros_along_a_crease() -> None:
    """A ridge along the graph of f; f' has double zeros at 1/4 and 3/4, and a maximum at 1/2."""
    slope = 16.0 * Polynomial([-0.25, 1.0]) ** 2 * Polynomial([-0.75, 1.0]) ** 2
    heights = BPoly.from_power_basis(PPoly(slope.integ().coef[::-1, None], [0.0, 1.0])).c[:, 0]
    ridge = np.stack([np.linspace(0.0, 1.0, 6), heights, np.zeros(6)], axis=1)
    net = ridge[:, None] + np.array([(0, -1, -1), (0, 0, 0), (0, 1, -1)])
    surface = gm.Surface.from_nurbs((5, 1), (clamped(5), [0, 0, 1, 2, 2]), net)
    slopes = np.array([0.0, 1.0 / 16.0, *(1.0 / 16.0 - 10.0 ** -np.arange(1.5, 7.5)), 0.3, -0.01])
    normals = unit(np.stack([-slopes, np.ones_like(slopes), 3.0 + 0.0 * slopes], axis=1))
    known = gm.GaussMap(surface)
    found = known.points(normals)
    np.testing.assert_array_equal(found.component, gm.Component.CREASE)
    assert found.report.undecided == ()
    for k, value in enumerate(slopes):
        zeros = (slope - value).roots()
        zeros = zeros[np.abs(zeros.imag) < 1e-3].real
        zeros = np.unique(zeros[(zeros > 0.0) & (zeros < 1.0)].round(7 if k < 2 else 16))
        at = np.sort(found.uv[found.normal_index == k, 0])
        np.testing.assert_allclose(at, zeros, rtol=0.0, atol=1e-6)
    np.testing.assert_array_equal(known.degree(normals), 0)


def test_normals_of_one_side_of_a_crease() -> None:
    """The crease, or a regular point next to it, or both, or none has a point with the normal.

    Judged by the degree of normals nearby. Normals of the sides of corners are undecided.
    """
    inner = 0.25, 0.5, 0.5, 0.75
    surface = graph((2, 2), (clamped(2, *inner), clamped(2, *inner)), 0.1).surface
    known, rng = gm.GaussMap(surface), np.random.default_rng(8)
    places = np.stack([np.full(40, 0.5), rng.uniform(0.1, 0.9, 40)])
    places = np.concatenate([places, places[::-1], np.full((2, 10), 0.5)], axis=1)
    jets = surface.jets(*(places + 1e-13 * rng.choice([-1.0, 1.0], places.shape)))
    own = unit(np.cross(jets[:, 1], jets[:, 2]))
    nearby = [known.degree(own + 1e-6 * rng.normal(size=own.shape)) for _ in range(3)]
    for size in (0.0, 1e-12, 1e-10, 1e-9, 1e-8):
        normals = own + size * rng.normal(size=own.shape)
        found, single = (known.points(normals, dtype=x) for x in (np.float64, np.float32))
        np.testing.assert_array_equal(single.component, found.component)
        listed = {x.normal for x in found.report.undecided or ()}
        assert listed <= set(range(80, 90))
        wrong = set(np.flatnonzero(known.degree(normals) != np.median(nearby, axis=0)).tolist())
        assert wrong <= listed


def test_corners_where_creases_cross() -> None:
    """Judged by the signs of the height around them, and by the sum of indices."""
    circle = [(1, 0), (1, 0.8), (0, 0.9), (-0.7, 1), (-1, 0), (-1.2, -0.9), (0, -1), (0.8, -0.8),
              (1, 0)]  # fmt: skip
    arcs = [1, 0.8, 1, 0.9, 1, 0.7, 1, 0.8, 1]
    net = revolved(CORNER * 0.7 + [3, 0], arcs, bezier(2, 9), SHEAR, circle=circle)
    angles = np.arange(720.5) * np.pi / 360.0
    around = 1e-4 * np.stack([np.cos(angles), np.sin(angles)])
    sides = 1e-9 * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]).T
    corners, random = np.array([(0.0, 0.0), (0, 1), (0, 2), (0, 3)]), directions(1, 300)
    shares = np.random.default_rng(3).dirichlet(np.ones(4), 40)
    cones = [
        unit(np.cross(*net.surface.jets(*(x[:, None] + sides) % 4.0)[:, 1:3].swapaxes(0, 1)))
        for x in corners
    ]
    normals = np.concatenate([random, *(unit(shares @ x) for x in cones)])
    known = gm.GaussMap(net.surface)
    found = known.points(normals)
    listed = [x.normal for x in found.report.undecided or ()]
    assert len(listed) < 10
    assert not np.delete(known.degree(normals), listed).any()
    assert found.component is not None
    for corner, normal in zip(corners, cones, strict=True):
        point = net.surface.evaluate(*corner)
        ring = net.surface.evaluate(*(corner[:, None] + around) % 4.0) - point
        rises = ring @ normals.T > 0.0
        index = 1.0 - (np.roll(rises, 1, axis=0) != rises).sum(axis=0) / 2.0
        expected = (index != 0.0) & (normals @ normal.sum(axis=0) > 0.0)
        at = np.linalg.norm(found.points - point, axis=1) < 1e-6
        at &= found.component == gm.Component.CREASE
        has = np.bincount(found.normal_index[at], minlength=len(normals))
        assert not np.delete(has != expected, listed).any()
        assert expected.any()


# Where nets are cut: an axis, and how many control points the first part has.
CUTS = {
    "ellipsoid, sheared": (0, 3), "torus, sheared": (1, 5), "capsule": (0, 3),
    "ellipsoid, 10 digits": (1, 5),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", CUTS)
def test_components_of_a_surface_in_two_parts(name: str) -> None:
    net, (axis, count) = NETS[name][0](), CUTS[name]
    parts = net.part(axis, 0, count), net.part(axis, count - 1, net.points.shape[axis])
    normals = directions(8, 2000)
    counts = []
    for surface in (net.surface, gm.Part([x.surface for x in parts], tolerance=1e-6)):
        found = gm.GaussMap(surface).points(normals)
        listed = {x.normal for x in found.report.undecided or ()}
        assert len(listed) <= len(normals) / 1000
        assert found.component is not None
        counts.append(np.zeros((len(normals), len(gm.Component))))
        np.add.at(counts[-1], (found.normal_index, found.component), 1)
        counts[-1][list(listed)] = 0
    np.testing.assert_array_equal(*counts)


def test_poles_of_halves_are_one_point() -> None:
    """Where a surface does not go all the way around a pole, it has the normal there once.

    The normals of the halves point inward, those of the part outward.
    """
    net = NETS["ellipsoid, sheared"][0]()
    halves = [net.part(1, *x).surface for x in ((0, 5), (4, 9))]
    poles = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
    normals = unit(np.concatenate([poles @ np.linalg.inv(SHEAR), np.eye(3), gm.fibonacci(20)]))
    part = gm.Part(halves, tolerance=1e-6)
    for surface, some, side in ((halves[0], normals[:2], -1.0), (part, normals, 1.0)):
        known = gm.GaussMap(surface)
        found = known.points(some)
        assert (found.report.proved, found.report.undecided) == (len(some), ())
        found = found[np.argsort(found.normal_index)]
        np.testing.assert_array_equal(found.normal_index, np.arange(len(some)))
        np.testing.assert_array_equal(found.component, gm.Component.REGULAR)
        np.testing.assert_array_equal(known.degree(some), 1)
        np.testing.assert_allclose(found.points[:2], side * poles @ SHEAR.T, atol=1e-12)
        whole = gm.GaussMap(net.surface).points(some[:2])
        np.testing.assert_allclose(
            found.gaussian_curvature[:2], whole.gaussian_curvature, rtol=1e-3
        )


def rounded_ellipsoid(digits: int) -> tuple[Net, Array]:
    """Return an ellipsoid and the rotation (3, 3) of its axes."""
    turned, _ = np.linalg.qr(np.array([(3.0, 1, 2), (1, 4, 1), (2, -1, 5)]))
    return conics(MERIDIAN, WEIGHTS[:5], turned @ np.diag([3.0, 2, 1]), digits=digits), turned


@pytest.mark.slow
@pytest.mark.parametrize(
    ("digits", "step", "rows"),
    [(8, 4, [(0, 5)]), (7, 2, [(0, 3), (2, 5)]), (10, 2, [(0, 5)])],
)
def test_degrees_of_rounded_parts(digits: int, step: int, rows: list[tuple[int, int]]) -> None:
    """At poles, at corners, and at edges, where the normals of two faces differ slightly."""
    net, turned = rounded_ellipsoid(digits)
    pieces = [net.part(1, i, i + step + 1) for i in range(0, 8, step)]
    faces = [x.part(0, *row).surface for x in pieces for row in rows]
    corners = np.concatenate([turned.T, -turned.T])
    normals = [-corners, *(-x + size * gm.fibonacci(10) for x in corners for size in (1e-8, 3e-8))]
    for face in faces:
        (u0, u1), (v0, _) = face.domain
        jets = face.jets(np.linspace(u0, u1, 17)[1:-1], np.full(15, v0))
        at_edge = -unit(np.cross(jets[:, 1], jets[:, 2]))
        normals += [at_edge + size * gm.fibonacci(15) for size in (0.0, 1e-10, 1e-9)]
    given = unit(np.concatenate(normals))
    known = gm.GaussMap(gm.Part(faces, tolerance=1e-6))
    listed = {x.normal for x in known.points(given).report.undecided or ()}
    assert set(np.flatnonzero(known.degree(given) != 1).tolist()) <= listed
    assert 3 * len(listed) < 2 * len(given)


@pytest.mark.parametrize("digits", [7, 8])
def test_poles_of_rounded_halves_have_no_points_with_the_opposite_normal(digits: int) -> None:
    """Rounding gives the collapsed sides no single normal: they are undecided, and no curves."""
    net, turned = rounded_ellipsoid(digits)
    surface, poles = net.part(1, 0, 5).surface, np.array([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)])
    found = gm.GaussMap(surface).points(poles @ turned.T)
    assert not (found.component == gm.Component.CURVE).any()
    boxes = {x.normal: x.box for x in found.report.undecided or ()}
    middles = np.array([boxes[k] for k in (0, 1)]).reshape(2, 2, 2).mean(axis=2)
    points = np.concatenate([surface.jets(*middles.T.copy())[:, 0], found.points])
    numbers = np.concatenate([[0, 1], found.normal_index])
    assert len(set(np.sign(points @ turned[:, 2] * poles[numbers, 2]).tolist())) == 1
