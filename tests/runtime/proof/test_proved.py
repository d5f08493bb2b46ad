"""The answers of the proof: surfaces, normals, and what is right, in tables; see `judge`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.proof import index as proved
from gaussmap.runtime.proof.index import ProvedIndex

from ...shapes import CIRCLE, HALF, MERIDIAN, WEIGHTS, conics, random_rotation
from .judge import (
    Array,
    check,
    counts,
    curvature_at,
    index_of,
    jets_at,
    kinds,
    near,
    new_index,
    normals_at,
    nurbs,
    position_of,
    random_normals,
    surface_of,
    unit,
)

TAU = 2.0 * np.pi

# --- all points, by another search ----------------------------------------------------------------

JUDGED = (
    "torus", "knobby", "waves", "monkey_saddle", "enneper", "catenoid", "bump", "asphere",
    "bohemian", "dupin_cyclide", "moebius_band", "egg",
)  # fmt: skip
MANY = [pytest.param(seed, 1000, marks=pytest.mark.slow) for seed in range(2, 12)]


@pytest.mark.parametrize(("seed", "count"), [(1, 60), *MANY])
@pytest.mark.parametrize("name", JUDGED)
def test_another_search_finds_the_same_points(name: str, seed: int, count: int) -> None:
    check(name, random_normals(count, seed))


EULER = {"sheared": 2, "torus": 0, "knobby": 0, "dupin_cyclide": 0, "sphere": 2, "ellipsoid": 2}


@pytest.mark.parametrize("count", [5000, pytest.param(100_000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", EULER)
def test_sum_of_signs_is_half_the_euler_characteristic(name: str, count: int) -> None:
    """Also for normals of circles."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    normals = np.concatenate([axes, gm.icosphere(3), random_normals(count, seed=3)])
    known = gm.GaussMap(surface_of(name))
    assert known.points(normals).report.undecided == ()
    np.testing.assert_array_equal(known.degree(normals), EULER[name] // 2)


# --- places that are known ------------------------------------------------------------------------


class Places(NamedTuple):
    """Parameters whose normals are asked: each is found so many times.

    At most a share of the normals is `open`, of these kinds; places are compared where they are
    decided, and everywhere if all may have open boxes beside their points.
    """

    surface: gm.Surface
    known: ProvedIndex
    u: Array
    v: Array
    times: int = 1
    open: float = 0.0
    kinds: frozenset[str] = frozenset()

    @classmethod
    def on(cls, name: str, u: Any, v: Any, *more: Any, **options: Any) -> Places:
        return cls(surface_of(name), index_of(name, **options), np.array(u), np.array(v), *more)


def corners(name: str) -> Places:
    """Corners of cells, and seams; at some of them K = 0."""
    surface = surface_of(name)
    lines = (np.linspace(low, high, 33) for low, high in surface.domain)
    u, v = (x.ravel() for x in np.meshgrid(*lines))
    return Places.on(name, u, v, 1, 0.1, frozenset({"open", "isolated", "curve"}))


def beside_borders(name: str, distance: float, inside: bool) -> Places:
    surface = surface_of(name)
    rng = np.random.default_rng(4)
    axis = 0 if surface.boundary[1][0] == "periodic" else 1
    places = np.array([rng.uniform(low, high, 200) for low, high in surface.domain])
    low, high = surface.domain[axis]
    step = distance if inside else -distance
    places[axis] = np.repeat([low + step, high - step], 100)
    return Places.on(name, *places, int(inside))


def beside_a_mirrored_seam() -> Places:
    surface = surface_of("moebius_band")
    (u0, u1), (v0, v1) = surface.domain
    v = np.tile(np.linspace(0.9 * v0, 0.9 * v1, 40), 2)
    return Places.on("moebius_band", np.repeat([u0 + 1e-6, u1 - 1e-6], 40), v)


def in_spline(degree: int, repeated: int) -> Places:
    rng = np.random.default_rng(14)
    u, v = rng.uniform(0.01, 0.99, (2, 300))
    u[100:] = rng.choice([0.25, 0.5, 0.75], 200) + np.tile([1e-4, -1e-4], 100)
    return Places(*nurbs(degree, repeated), u, v)


def on_knots(degree: int, repeated: int) -> Places:
    rng = np.random.default_rng(15)
    u, v = rng.choice([0.25, 0.5, 0.75], 100), rng.uniform(0.01, 0.99, 100)
    return Places(*nurbs(degree, repeated), u, v)


def cap(bump: float, tip: float) -> gm.Surface:
    """Return a polynomial cap over rings that are no ellipses, with a row of points at the tip."""
    angle = TAU * np.arange(15) / 12
    ring = np.stack(
        [1.3 * np.cos(angle) + bump * np.cos(3 * angle), 0.8 * np.sin(angle) + 0 * angle], axis=1
    )
    profile = [(0.0, tip), (0.5, 1.0), (0.9, 0.6), (1.0, 0.1), (1.0, -0.5)]
    points = np.array([[[r * x, r * y, z] for r, z in profile] for x, y in ring])
    knots = np.arange(-3, 16) / 12, np.array([0.0, 0.0, 0.0, 0.0, 0.6, 1.0, 1.0, 1.0, 1.0])
    return gm.Surface.from_nurbs((3, 3), knots, points)


def beside_a_tip(bump: float, tip: float) -> Places:
    """Tips of cones, and poles where curvatures depend on the direction too much."""
    u, v = np.array([0.3, 0.7, 0.01]), np.array([0.5, 0.1, 0.9])
    surface = cap(bump, tip)
    return Places(surface, new_index(surface, cells=(16, 16)), u, v, 1, 1.0, OPEN)


def in_a_valley() -> Places:
    """A point of a ruled NURBS with a very small K: solutions for nearby normals are a long way."""
    along = np.concatenate([np.zeros(4), [1, 2, 2], np.full(4, 3.0)])
    means = [along[k + 1 : k + 4].mean() for k in range(7)]
    x, y = np.meshgrid([0.0, 1.0], means, indexing="ij")
    off = np.random.default_rng(30).normal(size=(2, 7, 3)) * [0.15, 0.15, 0.5]
    net = np.stack([x, y, 0.0 * x], axis=-1) + off
    surface = gm.Surface.from_nurbs((1, 3), ([0, 0, 1, 1], along), net)
    u, v = np.array([0.9635228978, 0.2, 0.7]), np.array([0.4934060946, 1.3, 2.6])
    return Places(surface, new_index(surface), u, v)


OPEN = frozenset({"open"})
PLACES: dict[str, Callable[[], Places]] = {
    **{f"corners of {x}": partial(corners, x) for x in ("torus", "knobby", "waves")},
    **{
        f"{'inside' if inside else 'outside'} of {name} by {distance}": partial(
            beside_borders, name, distance, inside
        )
        for name in ("waves", "enneper", "catenoid", "rim")
        for distance in (1e-2, 1e-5, 1e-8, 1e-11)
        for inside in (True, False)
    },
    "mirrored seam": beside_a_mirrored_seam,
    # The second derivatives of the last two jump at knots.
    **{f"spline {x}": partial(in_spline, *x) for x in ((3, 1), (2, 1), (3, 2))},
    "knots of a smooth spline": partial(on_knots, 3, 1),
    "valley": in_a_valley,
    "root": lambda: Places.on("root", [0.5, 0.02], [0.3, 0.7], cells=(8, 8)),
    "horn": lambda: Places.on("horn", [0.3, 2.0, 4.0], [0.5, 0.1, 0.9], cells=(16, 8)),
    **{
        f"tip {x}": partial(beside_a_tip, *x) for x in ((0.02, 1.5), (0.02, 1.0 + 1e-6), (0.5, 1.0))
    },
}  # fmt: skip


@pytest.mark.parametrize("name", PLACES)
def test_known_places_are_found_once(name: str) -> None:
    asked = PLACES[name]()
    found = asked.known.query(normals_at(asked.surface, asked.u, asked.v))
    is_open = np.isin(np.arange(len(asked.u)), found.undecided.numbers)
    assert is_open.mean() <= asked.open
    assert kinds(found) <= asked.kinds
    compared = slice(None) if asked.open == 1.0 else ~is_open
    within = 1e-6 if name.startswith("corners") else 1e-9
    hits = near(asked.surface, found, asked.u, asked.v, within)
    np.testing.assert_array_equal(hits[compared], asked.times)
    if name.startswith("tip"):
        assert asked.known.discs == ()
    if asked.open == 1.0:
        assert (found.undecided.boxes[:, 2] == 0.0).all()
    if name.startswith("spline"):
        assert len(asked.known.unbounded) == 0


def test_points_on_open_borders_are_marked() -> None:
    surface = surface_of("waves")
    u = np.linspace(-0.9, 0.9, 50)
    v = np.full_like(u, surface.domain[1][1])
    found = index_of("waves").query(normals_at(surface, u, v))
    np.testing.assert_array_equal(near(surface, found, u, v, 1e-9), 1)
    # Points with the same normals elsewhere are on the border, too, or not near it.
    np.testing.assert_array_equal(found.border, np.abs(found.uv).max(axis=1) > 1.0 - 1e-9)
    assert np.abs(found.uv).max() <= 1.0


@pytest.mark.parametrize("name", ["knobby", "waves"])
@pytest.mark.quick_for("waves")
def test_radii_hold_the_exact_parameters(name: str) -> None:
    surface, (u, v) = surface_of(name), sp.symbols("u v", real=True)
    rng = np.random.default_rng(5)
    normals = normals_at(surface, *(rng.uniform(low, high, 4) for low, high in surface.domain))
    found = index_of(name).query(normals)
    assert len(found.numbers) >= 4
    for number, place, radius in zip(found.numbers, found.uv, found.radius, strict=True):
        n = sp.Matrix([sp.Rational(float(x)) for x in normals[number]])
        equations = [n.dot(position_of(name).diff(x)) for x in (u, v)]
        start = [sp.Float(x, 40) for x in place.tolist()]
        root = sp.nsolve(equations, [u, v], start, prec=40)
        away = [abs(float(x)) for x in root - sp.Matrix(start)]
        for axis, (low, high) in enumerate(surface.domain):
            if surface.boundary[axis][0] == "periodic":
                away[axis] = min(away[axis], abs(high - low - away[axis]))
            assert away[axis] <= radius[axis]
        assert (radius < 1e-10).all()


# --- poles ----------------------------------------------------------------------------------------


@cache
def ball(scales: tuple[float, ...], shift: float) -> tuple[gm.Surface, Array]:
    """Return a NURBS that is the image of the unit sphere under a matrix, and the matrix.

    Its parameters are those of circles, rational, and its angles and arcs are not linear in them.
    """
    matrix = random_rotation(17) @ np.diag(scales)
    points = np.array([[(r * x, r * y, z) for r, z in MERIDIAN] for x, y in CIRCLE])
    knots = conics(CIRCLE) / 4, conics(MERIDIAN) / 2
    net, weights = points @ matrix.T + shift, np.outer(WEIGHTS, HALF)
    surface = gm.Surface.from_nurbs((2, 2), knots, net, weights)
    return replace(surface, boundary=(("periodic", "periodic"), ("pole", "pole"))), matrix


BALLS: dict[str, tuple[Callable[[], tuple[gm.Surface, Array]], float]] = {
    "sphere": (lambda: (surface_of("sphere"), np.eye(3)), 0.0),
    "ellipsoid": (lambda: (surface_of("ellipsoid"), np.diag([1.0, 0.6, 0.3])), 0.0),
    **{
        str(scales): (partial(ball, scales, shift), shift)
        for scales, shift in (
            ((1.0, 0.7, 1.3), 0.3), ((1e-3, 1e-3, 1e-3), 1.0), ((2.0, 1.0, 9.0), 0.0),
            ((1e-12, 2e-12, 1e-12), 0.0), ((1e12, 2e12, 1e12), 1e12),
        )
    },
}  # fmt: skip


@pytest.mark.parametrize("name", BALLS)
def test_points_near_poles(name: str) -> None:
    """Of images of the unit sphere, whose points are known."""
    made, shift = BALLS[name]
    (surface, matrix), rng = made(), np.random.default_rng(18)
    index, inverse = new_index(surface), np.linalg.inv(matrix)
    size = np.linalg.norm(matrix, 2) + shift
    assert (len(index.discs), len(index.unbounded)) == (2, 0)
    for distance in (0.2, 0.06, 0.05, 1e-2, 1e-3, 1e-4, 1e-8, 1e-12, 1e-15, 0.0):
        angle, off = rng.uniform(0.1, 0.9, 60), distance * rng.uniform(0.5, 1.0, 60)
        angle = 0.5 * np.pi * (angle + np.arange(60))
        up = np.where(np.arange(60) % 8 < 4, 1.0, -1.0)
        own = [np.sin(off) * np.cos(angle), np.sin(off) * np.sin(angle), up * np.cos(off)]
        normals = unit(np.stack(own, axis=1) @ inverse)
        found = index.query(normals)
        assert len(found.undecided.numbers) == 0
        np.testing.assert_array_equal(counts(found, normals), 1)
        assert (found.sign == 1).all()
        exact = unit(normals @ matrix) @ matrix.T + shift
        points = surface.evaluate(*found.uv.T)
        assert (np.linalg.norm(points - exact, axis=1) < 1e-11 * size).all()
        # The exact parameters are within the radii, which are small next to the pole, too.
        ends = (np.clip(found.uv[:, 1] + s * found.radius[:, 1], *surface.domain[1])
                for s in (-1.0, 1.0))  # fmt: skip
        heights = [
            np.abs(unit((surface.evaluate(found.uv[:, 0], v) - shift) @ inverse.T)[:, 2])
            for v in ends
        ]
        assert (np.minimum(*heights) <= np.cos(off) + 1e-12).all()
        assert (np.maximum(*heights) >= np.cos(off) - 1e-12).all()
        assert (found.radius[:, 1] < 1e-6).all()
        around = np.linalg.norm((points - shift) @ inverse.T * [1.0, 1.0, 0.0], axis=1)
        (u0, u1), (v0, v1) = surface.domain
        along, across = found.radius[:, 1] / (v1 - v0), found.radius[:, 0] / (u1 - u0)
        reach = TAU * (along + around * np.minimum(across, 1.0))
        assert (np.linalg.norm(points - exact, axis=1) <= 2.0 * size * reach + 1e-15 * size).all()


def test_poles_of_lofted_caps() -> None:
    """Second derivatives at the pole depend on the direction, a little."""
    surface = cap(bump=0.02, tip=1.0)
    index = new_index(surface)
    assert len(index.discs) == 1
    rng = np.random.default_rng(19)
    u, v = rng.uniform(0.0, 1.0, 300), 10.0 ** rng.uniform(-12.0, -0.2, 300)
    _, x_u, x_v, *_ = jets_at(surface, u, v)
    normals = unit(np.cross(x_u / v[:, None], x_v))
    normals[:50] *= -1.0
    found = index.query(normals)
    assert len(found.undecided.numbers) == 0
    np.testing.assert_array_equal(counts(found, normals), np.repeat([0, 1], [50, 250]))
    # x_u has a rounding, which is large relative to it near the pole.
    within = np.stack([1e-13 / v**2, 1e-12 / v], axis=1)[found.numbers]
    away = np.abs(found.uv - np.stack([u, v], axis=1)[found.numbers])
    away[:, 0] = np.minimum(away[:, 0], 1.0 - away[:, 0])
    far = v[found.numbers] > 1e-4
    assert (away < within)[far].all()


def test_poles_without_a_disc_are_open_for_their_own_normals() -> None:
    """Where K is 0 at a pole, normals near that of the pole may have further points in a strip."""
    surface, index = surface_of("bowl"), index_of("bowl")
    (cap,) = index.caps
    rng = np.random.default_rng(21)
    u, v = rng.uniform(0.0, TAU, 400), rng.uniform(0.0, 1.0, 400) ** 2
    normals = normals_at(surface, u, v)
    found = index.query(np.concatenate([normals, -normals, [[0.0, 0.0, -1.0]]]))
    is_open = np.isin(np.arange(801), found.undecided.numbers)
    np.testing.assert_array_equal(kinds(found), {"open"})
    assert (is_open[:400] | (near(surface, found, u, v, 1e-9)[:400] == 1)).all()
    assert is_open[:400][v < cap.size].all()
    assert not is_open[400:800].any()
    assert is_open[800]
    assert is_open[:400].mean() < 0.35
    assert (found.undecided.boxes[:, 3] <= cap.size).all()


# --- folds ----------------------------------------------------------------------------------------


def fold_points(surface: gm.Surface, count: int) -> tuple[Array, Array]:
    """Return parameters at which K changes its sign, up to rounding."""
    curvature = partial(curvature_at, surface)
    (u0, u1), (v0, v1) = surface.domain
    rng = np.random.default_rng(7)
    v = rng.uniform(v0, v1, 200 * count)
    low = rng.uniform(u0, u1, 200 * count)
    high = low + (u1 - u0) / 200
    at_low = curvature(low, v)
    changes = np.flatnonzero((at_low * curvature(high, v) < 0.0) & (high < u1))[:count]
    low, high, v, at_low = low[changes], high[changes], v[changes], at_low[changes]
    for _ in range(60):
        middle = 0.5 * (low + high)
        same = curvature(middle, v) * at_low > 0.0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return low, v


def beside_folds(surface: gm.Surface, count: int, distance: float) -> tuple[Array, Array]:
    """Return normals on both sides of the image of a fold, at this distance from its points."""
    u, v = fold_points(surface, count)
    n, h = normals_at(surface, u, v), 1e-5
    changes = [
        normals_at(surface, u + h * i, v + h * j) - normals_at(surface, u - h * i, v - h * j)
        for i, j in ((1.0, 0.0), (0.0, 1.0), (0.7, 0.7))
    ]
    sizes = np.linalg.norm(changes, axis=2)
    across = unit(np.cross(n, np.choose(sizes.argmax(axis=0)[:, None], changes)))
    return unit(n + distance * across), unit(n - distance * across)


# The graph of waves has the same normals in four places.
@pytest.mark.parametrize(("name", "jump"), [("knobby", 2), ("waves", 8), ("menn", 2)])
def test_two_points_appear_at_folds(name: str, jump: int) -> None:
    for distance in (1e-4, 1e-6, 1e-8):
        one, other = beside_folds(surface_of(name), 60, distance)
        assert len(one) > 30
        found = [index_of(name).query(x) for x in (one, other)]
        assert all(len(x.undecided.numbers) == 0 for x in found)
        numbers = [counts(x, one) for x in found]
        # Other folds are farther away, but for a few normals.
        assert (np.abs(numbers[0] - numbers[1]) == jump).mean() > 0.9
        sums = [np.bincount(x.numbers, x.sign, minlength=len(one)) for x in found]
        np.testing.assert_array_equal(sums[0], sums[1])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["knobby", "waves", "menn", "torus"])
def test_few_normals_near_folds_are_undecided(name: str) -> None:
    for distance in (1e-4, 1e-6, 1e-8, 1e-9):
        normals = np.concatenate(beside_folds(surface_of(name), 1000, distance))
        found = index_of(name).query(normals)
        assert len(np.unique(found.undecided.numbers)) <= 0.01 * len(normals)


# --- what is not decided --------------------------------------------------------------------------

UNDECIDED: dict[str, tuple[Callable[[], Places], float]] = {
    "open": (
        lambda: Places.on("waves", *fold_points(surface_of("waves"), 20)), 1e-5
    ),
    "isolated": (lambda: Places.on("monkey_saddle", [0.0], [0.0]), 1e-6),
}  # fmt: skip


@pytest.mark.parametrize("name", UNDECIDED)
def test_small_boxes_hold_what_is_not_decided(name: str) -> None:
    made, size = UNDECIDED[name]
    surface, index, u, v, *_ = made()
    found = index.query(normals_at(surface, u, v))
    assert kinds(found) == {name}
    u_low, u_high, v_low, v_high = found.undecided.boxes.T
    assert (np.maximum(u_high - u_low, v_high - v_low) < size).all()
    here = found.undecided.numbers
    holds = (u_low <= u[here]) & (u[here] <= u_high) & (v_low <= v[here]) & (v[here] <= v_high)
    assert set(here[holds]) == set(range(len(u)))
    assert len(found.numbers) == 0 or name != "isolated"
    assert len(here) == len(u) or name != "isolated"


FLAT: dict[str, tuple[str, list[int], list[list[float]]]] = {
    "fold": ("u**3 + v**2", [0], []),
    "cusp and a point": (
        "u**4/4 + u**2*v/2 + v**2/3 + u**3*v/10",
        [1],
        [[0.620468872115, -0.324566582797]],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FLAT)
def test_flat_points_have_an_index(name: str) -> None:
    """The index is that of the gradient of the height: the judge turns along a circle."""
    height, expected, others = FLAT[name]
    surface = gm.Surface.from_sympy(("u", "v", height), ("u", "v"), ((-0.9, 1.1), (-1.1, 0.9)))
    found = new_index(surface).query(np.array([[0.0, 0.0, 1.0]]))
    np.testing.assert_allclose(found.uv, np.reshape(others, (-1, 2)), rtol=0.0, atol=1e-9)
    (box,), (kind,) = found.undecided.boxes, kinds(found)
    assert np.abs(box).max() < 1e-2
    assert kind == ("isolated" if expected[0] else "open")
    np.testing.assert_array_equal(found.undecided.degree, expected)
    angle = np.linspace(0.0, TAU, 2000)
    jets = surface.jets(0.02 * np.cos(angle), 0.02 * np.sin(angle))
    turns = np.unwrap(np.arctan2(jets[:, 2, 2], jets[:, 1, 2]))
    assert round((turns[-1] - turns[0]) / TAU) == expected[0]
    total = expected[0] + int(found.sign.sum())
    np.testing.assert_array_equal(gm.GaussMap(surface).degree([[0.0, 0.0, 1.0]]), total)


def test_other_normals_of_developables_have_no_points() -> None:
    for name in ("plane", "cylinder", "cone"):
        found = index_of(name).query(random_normals(500))
        assert len(found.numbers) == len(found.undecided.numbers) == 0


def test_an_apex_is_open_for_normals_of_its_own_only() -> None:
    """x_v is perpendicular to any normal of a point on two of the lines that end in the apex."""
    horn, u = new_index(surface_of("horn"), cells=(16, 8)), np.linspace(0.0, 6.0, 40)
    own = np.stack([np.cos(u), np.sin(u), np.full(40, -1.0)], axis=1)
    normals = np.concatenate([own, own + np.array([0.0, 0.0, 1e-6])])
    found = horn.query(normals / np.linalg.norm(normals, axis=1)[:, None])
    np.testing.assert_array_equal(found.undecided.numbers, np.arange(40))
    assert kinds(found) == {"open"}
    low, high, v_low, v_high = found.undecided.boxes.T
    assert ((low <= u) & (u <= high) & (v_low < 1e-8) & (v_high < 1e-8)).all()
    np.testing.assert_array_equal(found.numbers, np.arange(40, 80))


def test_where_derivatives_have_no_bounds_is_said() -> None:
    u_low, u_high, v_low, v_high = new_index(surface_of("root"), cells=(8, 8)).unbounded.T
    assert (u_low == 0.0).all()
    assert (u_high < 0.01).all()
    assert np.sum(v_high - v_low) == pytest.approx(1.0)


# --- independence ---------------------------------------------------------------------------------


def test_answers_do_not_depend_on_threads_and_other_normals() -> None:
    folds, _ = beside_folds(surface_of("knobby"), 40, 1e-7)
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    normals = np.concatenate([random_normals(30_000, seed=10), folds, axes])
    whole = index_of("knobby").query(normals, threads=1)
    for other in (
        index_of("knobby").query(normals, threads=3),
        new_index(surface_of("knobby"), threads=2).query(normals, threads=2),
    ):
        for one, two in zip((*whole[:2], *whole[2]), (*other[:2], *other[2]), strict=True):
            np.testing.assert_array_equal(one, two)
    some = np.random.default_rng(11).permutation(len(normals))[:700]
    part = index_of("knobby").query(normals[some])
    starts = np.searchsorted(whole.numbers, np.arange(len(normals) + 1))
    rows = np.concatenate([np.arange(int(starts[k]), int(starts[k + 1])) for k in some])
    np.testing.assert_array_equal(part.places, whole.places[rows])


def test_small_rooms_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    waves = surface_of("waves")
    folds, on_folds = beside_folds(waves, 40, 1e-7)[0], normals_at(waves, *fold_points(waves, 40))
    normals = np.concatenate([random_normals(3000, seed=12), folds, on_folds])
    expected = index_of("waves").query(normals)
    monkeypatch.setattr(proved, "ROOM", 64)
    monkeypatch.setattr(proved, "CELL_ROOM", 64)
    found = new_index(waves).query(normals)
    for one, two in zip((*expected[:2], *expected[2]), (*found[:2], *found[2]), strict=True):
        np.testing.assert_array_equal(one, two)


def test_a_line_has_no_index() -> None:
    line = surface_of("line")
    assert line.tape is not None
    assert ProvedIndex.of(line.tape, line.domain, line.boundary, cells=(4, 4)) is None


def test_no_normals() -> None:
    found = index_of("waves").query(np.empty((0, 3)))
    assert len(found.numbers) == len(found.uv) == len(found.undecided.numbers) == 0
