"""The proved search: borders, seams, poles, folds, what is undecided; and wrong bounds are seen."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.search import proved
from gaussmap.runtime.search.proved import KINDS, ProvedIndex, ProvedPlaces
from numpy.typing import NDArray

pytestmark = pytest.mark.compiled

Array = NDArray[Any]
TAU = 2.0 * np.pi
KNOBBY = "(0.35 + 0.06*sin(4*u + 3*v))"
FORMULAS: dict[str, Any] = {
    "knobby": (
        (f"(1 + {KNOBBY}*cos(v))*cos(u)", f"(1 + {KNOBBY}*cos(v))*sin(u)", f"{KNOBBY}*sin(v)"),
        ((0, "2*pi"), (0, "2*pi")), ("periodic", "periodic"),
    ),
    "waves": (("u", "v", "sin(3*u)*cos(3*v)/5"), ((-1, 1), (-1, 1)), ("open", "open")),
    # The third derivatives of its height are those of functions of one parameter.
    "sum": (("u", "v", "exp(u) + cos(2*v)/2"), ((-1, 1), (-1, 1)), ("open", "open")),
    "menn": (("u", "v", "u**4 + u**2*v - v**2"), ((-0.8, 0.8), (-0.8, 0.8)), ("open", "open")),
    "rim": (("u*cos(v)", "u*sin(v)", "sqrt(u)"), ((0.5, 1), (0, "2*pi")), ("open", "periodic")),
}  # fmt: skip


@cache
def surface_of(name: str) -> gm.Surface:
    if name not in FORMULAS:
        return getattr(gm.surfaces, name)()
    position, domain, boundary = FORMULAS[name]
    return gm.Surface.from_sympy(position, ("u", "v"), domain, periodic=boundary)


@cache
def index_of(name: str) -> ProvedIndex:
    return new_index(surface_of(name))


def new_index(surface: gm.Surface, **options: Any) -> ProvedIndex:
    assert surface.tape is not None
    index = ProvedIndex.of(surface.tape, surface.domain, surface.boundary, **options)
    assert index is not None
    return index


def unit(vectors: Any) -> Array:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_normals(count: int, seed: int = 0) -> Array:
    return unit(np.random.default_rng(seed).normal(size=(count, 3)))


def jets_at(surface: gm.Surface, u: Array, v: Array) -> list[Array]:
    return list(np.moveaxis(surface.jets(u, v), 1, 0))


def normals_at(surface: gm.Surface, u: Array, v: Array) -> Array:
    _, x_u, x_v, *_ = jets_at(surface, u, v)
    return unit(np.cross(x_u, x_v))


def counts(found: ProvedPlaces, normals: Array) -> Array:
    return np.bincount(found.numbers, minlength=len(normals))


def near(surface: gm.Surface, found: ProvedPlaces, u: Array, v: Array, within: float) -> Array:
    """Return how many of the points that are found for normal k are near (u[k], v[k])."""
    apart = np.abs(found.uv - np.stack([u, v], axis=1)[found.numbers])
    for axis, ends in enumerate(surface.boundary):
        if ends[0] == "periodic":
            low, high = surface.domain[axis]
            apart[:, axis] = np.minimum(apart[:, axis], high - low - apart[:, axis])
    close = (apart <= within).all(axis=1)
    return np.bincount(found.numbers[close], minlength=len(u))


# --- exactly once ---------------------------------------------------------------------------------

EULER = {"torus": 0, "knobby": 0, "dupin_cyclide": 0, "sphere": 2, "ellipsoid": 2}


def check_sums(name: str, count: int) -> None:
    normals = random_normals(count, seed=3)
    found = index_of(name).query(normals)
    assert len(found.undecided.numbers) == 0
    sums = np.bincount(found.numbers, found.sign, minlength=count)
    assert (sums == EULER[name] // 2).all()


@pytest.mark.parametrize("name", EULER)
def test_sum_of_signs_is_half_the_euler_characteristic(name: str) -> None:
    check_sums(name, 5000)


@pytest.mark.slow
@pytest.mark.parametrize("name", EULER)
def test_sum_of_signs_for_many_normals(name: str) -> None:
    check_sums(name, 100_000)


@pytest.mark.parametrize("name", ["torus", "knobby", "waves"])
def test_corners_of_cells_and_seams_once(name: str) -> None:
    surface = surface_of(name)
    (u0, u1), (v0, v1) = surface.domain
    u, v = (x.ravel() for x in np.meshgrid(np.linspace(u0, u1, 33), np.linspace(v0, v1, 33)))
    normals = normals_at(surface, u, v)
    found = index_of(name).query(normals)
    open_at = np.isin(np.arange(len(u)), found.undecided.numbers)
    np.testing.assert_array_equal(near(surface, found, u, v, 1e-6)[~open_at], 1)
    assert open_at.mean() < 0.1  # of them, those with K = 0


@pytest.mark.parametrize("name", ["waves", "enneper", "catenoid", "rim"])
@pytest.mark.parametrize("distance", [1e-2, 1e-5, 1e-8, 1e-11])
def test_points_near_open_borders_once(name: str, distance: float) -> None:
    surface = surface_of(name)
    rng = np.random.default_rng(4)
    axis = 0 if surface.boundary[1][0] == "periodic" else 1
    places = [rng.uniform(low, high, 100) for low, high in surface.domain]
    for side, inwards in ((0, 1.0), (1, -1.0)):
        for inside in (True, False):
            step = inwards * distance if inside else -inwards * distance
            places[axis] = np.full(100, surface.domain[axis][side] + step)
            normals = normals_at(surface, *places)
            found = index_of(name).query(normals)
            assert len(found.undecided.numbers) == 0
            hits = near(surface, found, places[0], places[1], 1e-9)
            np.testing.assert_array_equal(hits, 1 if inside else 0)


def test_points_on_open_borders_are_marked() -> None:
    surface = surface_of("waves")
    u = np.linspace(-0.9, 0.9, 50)
    v = np.full_like(u, surface.domain[1][1])
    found = index_of("waves").query(normals_at(surface, u, v))
    np.testing.assert_array_equal(near(surface, found, u, v, 1e-9), 1)
    # Points with the same normals elsewhere are on the border, too, or not near it.
    np.testing.assert_array_equal(found.border, np.abs(found.uv).max(axis=1) > 1.0 - 1e-9)
    assert np.abs(found.uv).max() <= 1.0


def test_seams_of_mirrored_surfaces_once() -> None:
    surface = surface_of("moebius_band")
    (u0, u1), (v0, v1) = surface.domain
    for u, step in ((u0, 1e-6), (u1, -1e-6)):
        v = np.linspace(0.9 * v0, 0.9 * v1, 40)
        places = np.full_like(v, u + step), v
        found = index_of("moebius_band").query(normals_at(surface, *places))
        np.testing.assert_array_equal(near(surface, found, *places, 1e-9), 1)


# --- splines --------------------------------------------------------------------------------------


@cache
def nurbs(degree: int, repeated: int) -> gm.Surface:
    """Return a graph over the unit square, whose inner knots 1/4, 1/2, 3/4 are repeated."""
    inner = np.repeat([0.25, 0.5, 0.75], repeated)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    count = len(knots) - degree - 1
    places = np.array([knots[k + 1 : k + degree + 1].mean() for k in range(count)])
    x, y = np.meshgrid(places, places, indexing="ij")
    z = 0.15 * np.random.default_rng(13).normal(size=x.shape)
    return gm.Surface.from_nurbs((degree, degree), (knots, knots), np.stack([x, y, z], axis=-1))


# The second derivatives of the last two jump at knots.
@pytest.mark.parametrize(("degree", "repeated"), [(3, 1), (2, 1), (3, 2)])
def test_points_of_splines_once(degree: int, repeated: int) -> None:
    surface = nurbs(degree, repeated)
    index, rng = new_index(surface, cells=(32, 32)), np.random.default_rng(14)
    u, v = rng.uniform(0.01, 0.99, (2, 300))
    u[100:] = rng.choice([0.25, 0.5, 0.75], 200) + np.tile([1e-4, -1e-4], 100)
    found = index.query(normals_at(surface, u, v))
    assert len(index.unbounded) == len(found.undecided.numbers) == 0
    np.testing.assert_array_equal(near(surface, found, u, v, 1e-9), 1)


@pytest.mark.parametrize(("degree", "repeated"), [(3, 1), (2, 1), (3, 2)])
def test_points_on_knots_of_splines(degree: int, repeated: int) -> None:
    surface = nurbs(degree, repeated)
    index, rng = new_index(surface, cells=(32, 32)), np.random.default_rng(15)
    u, v = rng.choice([0.25, 0.5, 0.75], 100), rng.uniform(0.01, 0.99, 100)
    found = index.query(normals_at(surface, u, v))
    if degree - repeated >= 2:
        np.testing.assert_array_equal(near(surface, found, u, v, 1e-9), 1)
        return
    assert kinds(found) == {"multiple"}
    u_low, u_high, v_low, v_high = found.undecided.boxes.T
    here = found.undecided.numbers
    holds = (u_low <= u[here]) & (u[here] <= u_high) & (v_low <= v[here]) & (v[here] <= v_high)
    assert set(here[holds]) == set(range(100))
    assert (np.maximum(u_high - u_low, v_high - v_low) < 1e-6).all()


def test_where_derivatives_have_no_bounds_is_said() -> None:
    root = gm.Surface.from_sympy(("u", "v", "sqrt(u)/3 + v**2"), ("u", "v"), ((0, 1), (0, 1)))
    index = new_index(root, cells=(8, 8))
    u_low, u_high, v_low, v_high = index.unbounded.T
    assert (u_low == 0.0).all()
    assert (u_high < 0.01).all()
    assert np.sum(v_high - v_low) == pytest.approx(1.0)
    u, v = np.array([0.5, 0.02]), np.array([0.3, 0.7])
    found = index.query(normals_at(root, u, v))
    np.testing.assert_array_equal(near(root, found, u, v, 1e-9), 1)


# --- accuracy -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["knobby", "waves"])
@pytest.mark.quick_for("waves")
def test_radii_hold_the_exact_parameters(name: str) -> None:
    position, _, _ = FORMULAS[name]
    u, v = sp.symbols("u v", real=True)
    exact = sp.Matrix([sp.nsimplify(x) for x in position]).subs({"u": u, "v": v})
    rng = np.random.default_rng(5)
    places = (rng.uniform(low, high, 4) for low, high in surface_of(name).domain)
    normals = normals_at(surface_of(name), *places)
    found = index_of(name).query(normals)
    assert len(found.numbers) >= 4
    for number, place, radius in zip(found.numbers, found.uv, found.radius, strict=True):
        n = sp.Matrix([sp.Rational(float(x)) for x in normals[number]])
        equations = [n.dot(exact.diff(x)) for x in (u, v)]
        root = sp.nsolve(equations, [u, v], [sp.Float(x, 40) for x in place.tolist()], prec=40)
        apart = np.abs(np.array(root - sp.Matrix([sp.Float(x, 40) for x in place.tolist()])))
        for axis, (low, high) in enumerate(surface_of(name).domain):
            away = float(apart[axis, 0])
            if surface_of(name).boundary[axis][0] == "periodic":
                away = min(away, abs(high - low - away))
            assert away <= radius[axis]
        assert (radius < 1e-10).all()


# --- poles ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["sphere", "ellipsoid"])
def test_points_near_poles(name: str) -> None:
    surface, rng = surface_of(name), np.random.default_rng(6)
    axes = np.linalg.norm(
        surface.evaluate(np.array([0.0, np.pi / 2, 0.0]), np.array([0.0, 0.0, np.pi / 2])), axis=1
    )
    for distance in (0.2, 0.06, 0.05, 1e-2, 1e-4, 1e-8, 1e-12, 1e-15, 0.0):
        angle, off = rng.uniform(0.0, TAU, 60), distance * rng.uniform(0.5, 1.0, 60)
        up = np.where(np.arange(60) % 2 == 0, 1.0, -1.0)
        normals = unit(
            np.stack(
                [np.sin(off) * np.cos(angle), np.sin(off) * np.sin(angle), up * np.cos(off)], axis=1
            )
        )
        found = index_of(name).query(normals)
        assert len(found.undecided.numbers) == 0
        np.testing.assert_array_equal(counts(found, normals), 1)
        assert (found.sign == 1).all()
        exact = axes**2 * normals / np.linalg.norm(axes * normals, axis=1, keepdims=True)
        points = surface.evaluate(*found.uv.T)
        around = np.hypot(*points[:, :2].T) / axes[:2].min()
        reach = axes.max() * (found.radius[:, 1] + around * np.minimum(found.radius[:, 0], TAU))
        assert (np.linalg.norm(points - exact, axis=1) <= 2.0 * reach + 1e-15).all()
        assert (np.linalg.norm(points - exact, axis=1) < 1e-9).all()


HALF = np.sqrt(0.5)
SQUARE = np.array(
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], float
)
CIRCLE_KNOTS = np.repeat([0.0, 0.25, 0.5, 0.75, 1.0], [3, 2, 2, 2, 3])
ARC_KNOTS = np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])


@cache
def spline_ball(scales: tuple[float, ...], shift: float) -> tuple[gm.Surface, Array]:
    """Return a NURBS that is the image of the unit sphere under a matrix, and the matrix.

    Its parameters are those of circles, rational, and its angles and arcs are not linear in them.
    """
    meridian = np.array([(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)], float)
    points = np.array([[[r * x, r * y, z] for r, z in meridian] for x, y in SQUARE])
    weights = np.outer([1, HALF] * 4 + [1], [1, HALF, 1, HALF, 1])
    matrix = rotation() @ np.diag(scales)
    knots = CIRCLE_KNOTS, np.repeat([0.0, 0.5, 1.0], [3, 2, 3])
    surface = gm.Surface.from_nurbs((2, 2), knots, points @ matrix.T + shift, weights)
    return replace(surface, boundary=(("periodic", "periodic"), ("pole", "pole"))), matrix


def rotation() -> Array:
    q, _ = np.linalg.qr(np.random.default_rng(17).normal(size=(3, 3)))
    return q * np.linalg.det(q)


@pytest.mark.parametrize(
    ("scales", "shift"),
    [
        ((1.0, 0.7, 1.3), 0.3),
        ((1e-3, 1e-3, 1e-3), 1.0),
        ((2.0, 1.0, 9.0), 0.0),
        ((1e-12, 2e-12, 1e-12), 0.0),
        ((1e12, 2e12, 1e12), 1e12),
    ],
)
def test_points_near_poles_of_splines(scales: tuple[float, ...], shift: float) -> None:
    surface, matrix = spline_ball(scales, shift)
    index, rng = new_index(surface), np.random.default_rng(18)
    assert (len(index.discs), len(index.unbounded)) == (2, 0)
    for distance in (0.2, 0.06, 1e-2, 1e-3, 1e-4, 1e-8, 1e-12, 1e-15, 0.0):
        angle, off = rng.uniform(0.1, 0.9, 60), distance * rng.uniform(0.5, 1.0, 60)
        angle = 0.5 * np.pi * (angle + np.arange(60))
        up = np.where(np.arange(60) % 8 < 4, 1.0, -1.0)
        own = np.stack(
            [np.sin(off) * np.cos(angle), np.sin(off) * np.sin(angle), up * np.cos(off)], axis=1
        )
        normals = unit(own @ np.linalg.inv(matrix))
        found = index.query(normals)
        assert len(found.undecided.numbers) == 0
        np.testing.assert_array_equal(counts(found, normals), 1)
        assert (found.sign == 1).all()
        exact = unit(normals @ matrix) @ matrix.T + shift
        points = surface.evaluate(*found.uv.T)
        assert (np.linalg.norm(points - exact, axis=1) < 1e-11 * (max(scales) + shift)).all()
        # The exact parameters are within the radii, which are small next to the pole, too.
        low, high = (found.uv[:, 1] + sign * found.radius[:, 1] for sign in (-1.0, 1.0))
        heights = [
            np.abs(unit((surface.evaluate(found.uv[:, 0], np.clip(v, 0.0, 1.0)) - shift)
            @ np.linalg.inv(matrix).T)[:, 2]) for v in (low, high)
        ]  # fmt: skip
        assert (np.minimum(*heights) <= np.cos(off) + 1e-12).all()
        assert (np.maximum(*heights) >= np.cos(off) - 1e-12).all()
        assert (found.radius[:, 1] < 1e-6).all()


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
    apart = np.abs(found.uv - np.stack([u, v], axis=1)[found.numbers])
    apart[:, 0] = np.minimum(apart[:, 0], 1.0 - apart[:, 0])
    # x_u has a rounding, which is large relative to it near the pole.
    far = v[found.numbers] > 1e-4
    assert (apart[far] < np.stack([1e-13 / v**2, 1e-12 / v], axis=1)[found.numbers][far]).all()


@pytest.mark.parametrize(("bump", "tip"), [(0.02, 1.5), (0.02, 1.0 + 1e-6), (0.5, 1.0)])
def test_sides_that_are_no_smooth_pole_have_no_disc(bump: float, tip: float) -> None:
    """Tips of cones, and poles where curvatures depend on the direction too much."""
    surface = cap(bump, tip)
    index = new_index(surface, cells=(16, 16))
    assert index.discs == ()
    u, v = np.array([0.3, 0.7, 0.01]), np.array([0.5, 0.1, 0.9])
    found = index.query(normals_at(surface, u, v))
    np.testing.assert_array_equal(near(surface, found, u, v, 1e-9), 1)
    assert kinds(found) <= {"singular"}
    assert (found.undecided.boxes[:, 2] == 0.0).all()


@pytest.mark.parametrize("name", ["ball", "cap", "ellipsoid"])
def test_bounds_of_discs_hold(name: str) -> None:
    """Gradients over the tangent plane, from points of the surface, have slopes within bounds."""
    surface = {
        "ball": lambda: spline_ball((1.0, 0.7, 1.3), 0.3)[0],
        "cap": lambda: cap(bump=0.02, tip=1.0),
        "ellipsoid": lambda: surface_of("ellipsoid"),
    }[name]()
    for pole in new_index(surface).discs:
        disc, rng = pole.disc, np.random.default_rng(20)
        _, _, size, low, turn, end, inward, _, unit_of, whole, *_ = disc.frame
        normal = disc.basis[2] / np.linalg.norm(disc.basis[2])
        frame = np.linalg.inv(disc.basis.T)
        u, r = low + turn * rng.uniform(size=4000), 2.0 * size * rng.uniform(0.2, 1.0, 4000)
        x, x_u, x_v, *_ = jets_at(surface, u, end + inward * r)
        middle = jets_at(surface, np.array([low]), np.array([end]))[0]
        q = (x - middle) @ frame.T / unit_of
        n = np.cross(x_u, x_v) @ np.linalg.inv(frame)
        slopes = -unit_of * n[:, :2] / n[:, 2:]
        a, b, c = disc.hot[0, :9].reshape(3, 3) @ normal
        rest = slopes - np.stack([a * q[:, 0] + b * q[:, 1], b * q[:, 0] + c * q[:, 1]], axis=1)
        d_a, d_b, d_c = disc.changes[0] @ np.abs(normal) / (np.abs(normal) ** 2).sum()
        # Of the origin, and of one another.
        for step in (0, 1):
            by = np.abs(q - step * np.roll(q, 1, axis=0))
            off = np.abs(rest - step * np.roll(rest, 1, axis=0))
            bound = np.stack([d_a * by[:, 0] + d_b * by[:, 1], d_b * by[:, 0] + d_c * by[:, 1]], 1)
            inside = np.linalg.norm(q, axis=1) <= whole
            inside &= np.roll(inside, 1)
            assert (off <= bound + 1e-12 * np.abs(slopes).max())[inside].all()
            assert inside.mean() > 0.5


# --- folds ----------------------------------------------------------------------------------------


def fold_points(surface: gm.Surface, count: int) -> tuple[Array, Array]:
    """Return parameters at which K changes its sign, up to rounding."""

    def curvature(u: Array, v: Array) -> Array:
        _, x_u, x_v, a, b, c = jets_at(surface, u, v)
        n = np.cross(x_u, x_v)
        a, b, c = ((n * x).sum(axis=1) for x in (a, b, c))
        return a * c - b * b

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
    along = np.choose(sizes.argmax(axis=0)[:, None], changes)
    across = unit(np.cross(n, along))
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
        one, other = beside_folds(surface_of(name), 1000, distance)
        normals = np.concatenate([one, other])
        found = index_of(name).query(normals)
        assert len(np.unique(found.undecided.numbers)) <= 0.01 * len(normals)


# --- what is not decided --------------------------------------------------------------------------


def kinds(found: ProvedPlaces) -> set[str]:
    return {KINDS[k] for k in found.undecided.kinds}


def test_double_points() -> None:
    u, v = fold_points(surface_of("waves"), 20)
    normals = normals_at(surface_of("waves"), u, v)
    found = index_of("waves").query(normals)
    assert set(found.undecided.numbers) == set(range(len(normals)))
    assert kinds(found) == {"double"}
    u_low, u_high, v_low, v_high = found.undecided.boxes.T
    assert (np.maximum(u_high - u_low, v_high - v_low) < 1e-5).all()
    here = found.undecided.numbers
    holds = (u_low <= u[here]) & (u[here] <= u_high) & (v_low <= v[here]) & (v[here] <= v_high)
    assert set(here[holds]) == set(range(len(normals)))


def test_a_flat_point_is_multiple() -> None:
    found = index_of("monkey_saddle").query(np.array([[0.0, 0.0, 1.0]]))
    assert kinds(found) == {"multiple"}
    assert len(found.numbers) == 0
    u_low, u_high, v_low, v_high = found.undecided.boxes[0]
    assert u_low <= 0.0 <= u_high
    assert v_low <= 0.0 <= v_high
    assert max(u_high - u_low, v_high - v_low) < 1e-6


@pytest.mark.parametrize(
    ("name", "normal"),
    [("plane", (0, 0, 1)), ("cylinder", (1, 0, 0)), ("torus", (0, 0, 1)), ("torus", (0, 0, -1))],
)
def test_curves_of_points_are_a_continuum(name: str, normal: tuple[float, float, float]) -> None:
    found = index_of(name).query(np.array([normal], dtype=np.float64))
    assert kinds(found) == {"continuum"}
    assert len(found.numbers) == 0
    u_low, u_high, v_low, v_high = found.undecided.boxes.T
    (u0, u1), (v0, v1) = surface_of(name).domain
    whole = (u_high - u_low >= 0.99 * (u1 - u0)) | (v_high - v_low >= 0.99 * (v1 - v0))
    assert whole.any()
    assert found.undecided.border.all() == (name != "torus")


def test_other_normals_of_developables_have_no_points() -> None:
    for name in ("plane", "cylinder", "cone"):
        found = index_of(name).query(random_normals(500))
        assert len(found.numbers) == len(found.undecided.numbers) == 0


def test_places_without_a_normal_are_singular() -> None:
    # The apex of a horn: a side of the domain that is one point, and not smooth.
    horn = gm.Surface.from_sympy(
        ("v*cos(u)", "v*sin(u)", "v + v**2/4"), ("u", "v"), ((0, "2*pi"), (0, 1)),
        periodic=("periodic", "open"),
    )  # fmt: skip
    u, v = np.array([0.3, 2.0, 4.0]), np.array([0.5, 0.1, 0.9])
    normals = normals_at(horn, u, v)
    found = new_index(horn, cells=(16, 8)).query(normals)
    np.testing.assert_array_equal(near(horn, found, u, v, 1e-9), 1)
    np.testing.assert_array_equal(counts(found, normals), 1)
    # x_v is perpendicular to the normal there on two of the lines that end in the apex.
    assert kinds(found) == {"singular"}
    np.testing.assert_array_equal(np.bincount(found.undecided.numbers), 2)
    assert (found.undecided.boxes[:, 2] == 0.0).all()
    assert (found.undecided.boxes[:, 3] < 1e-9).all()
    assert found.undecided.border.all()


# --- bounds ---------------------------------------------------------------------------------------


def excess_of_thirds(name: str, index: ProvedIndex) -> float:
    """Return how much third derivatives exceed their bounds, relative to these, at most."""
    position, _, _ = FORMULAS[name]
    u, v = sp.symbols("u v")
    orders = ((3, 0), (2, 1), (1, 2), (0, 3))
    exact = [sp.diff(sp.sympify(x), u, i, v, j) for i, j in orders for x in position]
    evaluate = sp.lambdify((u, v), exact)
    cells, rng, most = index.index.cells, np.random.default_rng(8), -1.0
    for j in rng.integers(len(cells.place), size=300):
        u0, v0, h_u, h_v = cells.place[j]
        reach = cells.noise[j, 3]
        steps = np.concatenate(
            [rng.uniform(-reach, reach, (4, 2)), reach * rng.choice([-1, 1], (4, 2))]
        )
        scale = np.repeat([h_u ** (3 - k) * h_v**k for k in range(4)], 3)
        for s, t in steps:
            values = np.array(evaluate(u0 + h_u * s, v0 + h_v * t), dtype=np.float64) * scale
            off = np.abs(values - cells.thirds[j, :12]) - cells.thirds[j, 12:]
            most = max(most, float((off / np.abs(values).max()).max()))
    return most


@pytest.mark.parametrize("name", ["sum", "knobby"])
def test_bounds_hold_third_derivatives(name: str) -> None:
    assert excess_of_thirds(name, index_of(name)) <= 1e-12


@pytest.mark.parametrize("factor", [0.8, 0.9, 0.99])
def test_smaller_bounds_of_third_derivatives_are_noticed(factor: float) -> None:
    index = new_index(surface_of("sum"))
    index.index.cells.thirds[:] *= factor
    assert excess_of_thirds("sum", index) > 1e-4


def test_cones_hold_the_normals_of_cells() -> None:
    surface, index = surface_of("knobby"), index_of("knobby")
    cells, rng = index.index.cells, np.random.default_rng(9)
    ratios = []
    for j in rng.integers(len(cells.place), size=200):
        u0, v0, h_u, h_v = cells.place[j]
        s, t = rng.uniform(-1.0, 1.0, (2, 40)).round(rng.integers(0, 2))
        away = normals_at(surface, u0 + h_u * s, v0 + h_v * t) - cells.cone[j, :3]
        ratios.append(np.linalg.norm(away, axis=1).max() / cells.cone[j, 3])
    assert max(ratios) <= 1.0
    assert np.median(ratios) > 0.5  # the cones are not much too wide


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
    folds, _ = beside_folds(surface_of("waves"), 40, 1e-7)
    on_folds = normals_at(surface_of("waves"), *fold_points(surface_of("waves"), 40))
    normals = np.concatenate([random_normals(3000, seed=12), folds, on_folds])
    expected = index_of("waves").query(normals)
    monkeypatch.setattr(proved, "ROOM", 64)
    monkeypatch.setattr(proved, "CELL_ROOM", 64)
    found = new_index(surface_of("waves")).query(normals)
    for one, two in zip((*expected[:2], *expected[2]), (*found[:2], *found[2]), strict=True):
        np.testing.assert_array_equal(one, two)


def test_a_line_has_no_index() -> None:
    line = gm.Surface.from_sympy(("u + v", "u + v", "0"), ("u", "v"), ((0, 1), (0, 1)))
    assert line.tape is not None
    assert ProvedIndex.of(line.tape, line.domain, line.boundary, cells=(4, 4)) is None


def test_no_normals() -> None:
    found = index_of("waves").query(np.empty((0, 3)))
    assert len(found.numbers) == len(found.uv) == len(found.undecided.numbers) == 0
