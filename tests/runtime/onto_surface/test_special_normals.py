"""Normals of flat points, circles and rulings: one sample for each component, with its index."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp

from ...products import covering
from ...shapes import CIRCLE, WEIGHTS, circle, conics, revolved, unit

REGULAR, ISOLATED, CURVE = gm.Component.REGULAR, gm.Component.ISOLATED, gm.Component.CURVE
Z, X = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)


class Case(NamedTuple):
    """A surface, a normal, its components in any order, its degree, and what is 0 on them.

    The functions are those of coordinates of samples on curves. Isolated points are at the origin.
    """

    surface: Callable[[], gm.Surface]
    normal: tuple[float, float, float]
    components: list[int]
    degree: int
    zero: Callable[[Any, Any, Any], Any] = lambda x, y, z: 0.0 * z
    within: float = 0.0


def graph(height: str) -> gm.Surface:
    return gm.Surface.from_sympy(("u", "v", height), ("u", "v"), ((-0.9, 1.1), (-1.1, 0.9)))


def enneper(order: int) -> gm.Surface:
    """Return the minimal surface whose Gauss map is the power z**order."""
    u, v = sp.symbols("u v", real=True)
    z = u + sp.I * v
    power = z ** (2 * order + 1) / (2 * order + 1)
    parts = z - power, sp.I * (z + power), 2 * z ** (order + 1) / (order + 1)
    position = [str(sp.expand(sp.re(sp.expand(x)))) for x in parts]
    return gm.Surface.from_sympy(position, ("u", "v"), ((-1.03, 1.0), (-1.0, 1.07)))


def nurbs_torus() -> gm.Surface:
    """Return a torus whose circles of z = ±0.4 are knot lines."""
    return revolved(0.4 * CIRCLE + [1.0, 0.0], WEIGHTS)


def vase() -> gm.Surface:
    """Return a surface of revolution of degree 4 with a part of a cylinder and one of a plane."""
    r = [0.5, 0.8, *[1.0] * 5, 1.1, 1.3, 1.5, 1.7, 1.9, 2.1, 2.3, 2.5, 2.6]
    z = [0.0, 0.1, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.5, *[1.8] * 5, 2.0, 2.5]
    points = np.array([[(a * x, a * y, b) for a, b in zip(r, z, strict=True)] for x, y in CIRCLE])
    knots = np.concatenate([np.zeros(4), np.linspace(0.0, 1.0, len(r) - 3), np.ones(4)])
    weights = np.outer(WEIGHTS, np.ones(len(r)))
    return gm.Surface.from_nurbs((2, 4), (conics(CIRCLE), knots), points, weights)


def cubic(r: Sequence[float], z: Sequence[float]) -> gm.Surface:
    """Return a surface of revolution of degree 3, with straight parts at rows of points."""
    points = np.array([[(a * x, a * y, b) for a, b in zip(r, z, strict=True)] for x, y in CIRCLE])
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, len(r) - 2), np.ones(3)])
    weights = np.outer(WEIGHTS, np.ones(len(r)))
    return gm.Surface.from_nurbs((2, 3), (conics(CIRCLE), knots), points, weights)


# Two cylinders close together, of the radii 1 and 1.5.
shaft = partial(cubic, [*[1.0] * 9, 1.25, *[1.5] * 9], range(19))
# A flat ring below a steep one, and two more rings.
LID = (
    [6.0, 5.5, 5.0, 4.5, 4.0, 3.5, *np.arange(4.0, 6.75, 0.5), *np.arange(6.25, 9.5, 0.5), 9.25],
    [*[0.0] * 6, *[0.25] * 6, *[1.0] * 7, 1.25],
)


def on_top(x: Any, y: Any, z: Any) -> Any:
    return np.hypot(np.hypot(x, y) - 1.0, z - 0.4)


CASES = {
    "torus": Case(partial(gm.surfaces.torus, 1.0, 0.4), Z, [CURVE], 0, on_top, 1e-12),
    "NURBS torus": Case(nurbs_torus, Z, [CURVE], 0, on_top, 1e-12),
    "torus, sides": Case(partial(gm.surfaces.torus, 1.0, 0.4), X, [REGULAR, REGULAR], 0),
    "monkey saddle": Case(gm.surfaces.monkey_saddle, Z, [ISOLATED], -2),
    "Enneper 2": Case(partial(enneper, 2), (0.0, 0.0, -1.0), [ISOLATED], -2),
    "Enneper 3": Case(partial(enneper, 3), (0.0, 0.0, -1.0), [ISOLATED], -3),
    "Enneper, none": Case(partial(enneper, 2), Z, [], 0),
    "cusp": Case(partial(graph, "u**4/4 + u**2*v/2 + v**2/3"), Z, [ISOLATED], 1),
    "minimum": Case(partial(graph, "u**4 + v**4"), Z, [ISOLATED], 1),
    "flat minimum": Case(partial(graph, "u**8 + v**8"), Z, [ISOLATED], 1),
    # A circle around the point at which the height has a maximum.
    "crater": Case(
        partial(graph, "(u**2 + v**2 - 1/4)**2"), Z, [CURVE, REGULAR], 1,
        lambda x, y, z: np.hypot(np.hypot(x, y) - 0.5, z), 1e-9,
    ),
    # On the circle, K vanishes of higher order.
    "flat crater": Case(
        partial(graph, "(u**2 + v**2 - 1/4)**3"), Z, [CURVE, REGULAR], 1,
        lambda x, y, z: np.hypot(np.hypot(x, y) - 0.5, z), 1e-5,
    ),
    "crossing": Case(partial(graph, "u**2*v**2"), Z, [CURVE], 0, lambda x, y, z: x * y, 1e-9),
    "flat crossing": Case(partial(graph, "u**4*v**2"), Z, [CURVE], 0, lambda x, y, z: x * y, 1e-3),
    "cylinder in a vase": Case(vase, X, [CURVE], 0, lambda x, y, z: np.hypot(x - 1.0, y), 1e-9),
    "plane in a vase": Case(vase, (0.0, 0.0, -1.0), [CURVE], 0, lambda x, y, z: z - 1.8, 1e-9),
    "cylinders of a shaft": Case(
        shaft, X, [CURVE, CURVE], 0, lambda x, y, z: np.hypot((x - 1.0) * (x - 1.5), y), 1e-9
    ),
    "cylinders off a knot": Case(
        shaft, (0.6, 0.8, 0.0), [CURVE, CURVE], 0,
        lambda x, y, z: np.hypot((x - 0.6) * (x - 0.9), (y - 0.8) * (y - 1.2)), 1e-9,
    ),
    "lid": Case(partial(cubic, *LID), Z, [CURVE], 0, lambda x, y, z: z, 1e-9),
    "concentric circles": Case(
        partial(graph, "((u**2 + v**2 - 1/8) * (u**2 + v**2 - 1/2))**2"), Z,
        [REGULAR, CURVE, CURVE, CURVE], 1,
        lambda x, y, z: np.prod([x * x + y * y - a for a in (0.125, 0.3125, 0.5)], axis=0), 1e-7,
    ),
    "parallel lines": Case(
        partial(graph, "((u - v)**2 - 1/4)**2"), Z, [CURVE, CURVE, CURVE], 0,
        lambda x, y, z: (x - y - 0.5) * (x - y) * (x - y + 0.5), 1e-7,
    ),
    "cylinder": Case(
        gm.surfaces.cylinder, (0.6, 0.8, 0.0), [CURVE], 0,
        lambda x, y, z: np.hypot(x - 0.6, y - 0.8), 1e-12,
    ),
    "ruled": Case(
        partial(graph, "u**2*(2 + v)"), Z, [CURVE], 0, lambda x, y, z: np.hypot(x, z), 1e-9
    ),
    "inflections": Case(
        partial(graph, "u**3*(2 + v)"), Z, [CURVE], 0, lambda x, y, z: np.hypot(x, z), 1e-7
    ),
    "plane": Case(gm.surfaces.plane, Z, [CURVE], 0, lambda x, y, z: z, 1e-15),
}  # fmt: skip
COSINE, SINE = math.cos(0.7), math.sin(0.7)
TURN = np.array([[COSINE, -SINE, 0], [SINE, COSINE, 0], [0, 0, 1]]) @ np.array(
    [[1, 0, 0], [0, COSINE, -SINE], [0, SINE, COSINE]]
)
# Matrices of motions, translations, and how much larger rounding errors are.
MOVES: dict[str, tuple[Any, float, float]] = {
    "as it is": (np.eye(3), 0.0, 1.0),
    "turned": (TURN, 0.0, 1.0),
    "large": (1e9 * np.eye(3), 0.0, 1.0),
    "small": (1e-9 * np.eye(3), 0.0, 1.0),
    "mirrored": (np.diag([1.0, -1.0, 1.0]), 0.0, 1.0),
    "far away": (np.eye(3), 1e6, 1e6),
    "turned, far away": (TURN, 1e6, 1e6),
}


@covering(name=CASES, move=MOVES)
def test_each_component_has_one_sample(name: str, move: str) -> None:
    case, (matrix, away, rougher) = CASES[name], MOVES[move]
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = matrix, away
    surface = case.surface().transformed(whole)
    normal = np.linalg.inv(matrix).T @ case.normal
    known = gm.GaussMap(surface)
    samples = known.points([normal])
    assert samples.component is not None
    assert samples.uv_radius is not None
    assert sorted(samples.component) == sorted(case.components)
    assert (samples.report.proved, samples.report.undecided) == (1, ())
    np.testing.assert_array_equal(known.count([normal]), len(case.components))
    np.testing.assert_array_equal(known.degree([normal]), case.degree)
    special = samples[samples.component != REGULAR]
    np.testing.assert_array_equal(special.gaussian_curvature, 0.0)
    isolated = special[special.component == ISOLATED]
    assert (isolated.uv_radius <= 0.02).all()  # 1 % of the domain
    # x_u and x_v are unit vectors there, and change by at most a tenth within the radius.
    at = np.linalg.norm(np.linalg.solve(matrix, (isolated.points - away).T), axis=0)
    assert (at <= 1.1 * isolated.uv_radius.sum(axis=1) + rougher * 1e-15).all()
    on_curve = special[special.component == CURVE]
    points = np.linalg.solve(matrix, (on_curve.points - away).T)
    assert (np.abs(case.zero(*points)) <= rougher * case.within).all()
    _, x_u, x_v, *_ = np.moveaxis(surface.jets(*on_curve.uv.T.copy()), 1, 0)
    own = unit(np.cross(x_u, x_v))
    # Translations leave derivatives as they are, but for what the search takes for rounding. At
    # joints, normals are those of both sides, up to 1e-9.
    tolerance = 1e-9 if name == "NURBS torus" else rougher * 1e-14
    np.testing.assert_allclose(own - unit(normal), 0.0, atol=tolerance)
    for spline in splines(surface) if name in ON_SPLINES else ():
        check(spline, normal, case.components, case.degree)


# Cases in which the spline has the components of its surface.
ON_SPLINES = ("torus", "NURBS torus", "torus, sides", "cylinder", "plane")


def splines(surface: gm.Surface, cells: tuple[int, int] = (16, 12)) -> list[Any]:
    """Return the spline of a surface on a grid, and the same patches as nets."""
    spline = gm.fit(surface, cells)
    return [spline, gm.Spline.from_nets(spline.control_nets)]


def check(spline: Any, normal: Any, components: Sequence[int], degree: int) -> None:
    known = gm.GaussMap(spline)
    found = known.points([normal])
    assert found.component is not None
    assert sorted(found.component) == sorted(components)
    assert ((found.gaussian_curvature == 0.0) == (found.component != REGULAR)).all()
    np.testing.assert_array_equal(known.degree([normal]), degree)


def dyadic(height: str, cells: tuple[int, int]) -> gm.Surface:
    """Return a graph whose cells have width 1/4, so that control points have no rounding errors."""
    m, n = cells
    domain = ((-m / 8, m / 8), (-n / 8, n / 8))
    return gm.Surface.from_sympy(("u", "v", height), ("u", "v"), domain)


# Of splines, the components at (0, 0, 1) and the degree: exact arithmetic on the heights of their
# nets has these, too. What is a flat point of a surface is one vertex (of cells 6 × 6), or edges.
OF_SPLINES: list[tuple[str, tuple[int, int], list[int], int]] = [
    ("torus", (15, 17), [CURVE], 0),
    ("torus", (6, 8), [CURVE], 0),
    ("u**2", (7, 6), [CURVE], 0),
    ("u**2*v**2", (6, 6), [CURVE], 1),
    ("u**3*v - u*v**3", (6, 6), [ISOLATED], -3),
    ("u**3*v - u*v**3", (7, 7), [CURVE], -3),
    ("u**3 - 3*u*v**2", (6, 6), [REGULAR, REGULAR], -2),
    ("u**3 - 3*u*v**2", (6, 7), [CURVE, CURVE], -2),
]


@pytest.mark.parametrize(("name", "cells", "components", "degree"), OF_SPLINES)
def test_components_of_splines(
    name: str, cells: tuple[int, int], components: list[int], degree: int
) -> None:
    """Also of those that are turned, where rounding bends circles; far away it splits the rest."""
    surface = CASES[name].surface() if name in CASES else dyadic(name, cells)
    for spline in splines(surface, cells):
        check(spline, Z, components, degree)
    turned = np.eye(4)
    turned[:3, :3] = TURN
    for turned[0, 3] in (0.0,) if degree else (0.0, 1e6):
        for spline in splines(surface.transformed(turned), cells):
            check(spline, TURN @ Z, components, degree)


disc = partial(circle, 99)
# Surfaces with a trim, and the number of pieces that it leaves of a circle, a line or a plane.
CUT: dict[str, tuple[Callable[[], gm.Surface], Any, int]] = {
    "inside": (gm.surfaces.torus, {"within": lambda u, v: v < 3.0}, 1),
    "outside": (gm.surfaces.torus, {"within": lambda u, v: v > 3.0}, 0),
    "half": (gm.surfaces.torus, {"within": lambda u, v: u < 3.0}, 1),
    "at the seam": (gm.surfaces.torus, {"within": lambda u, v: u % 2.0 < 1.0}, 3),
    "loops": (
        gm.surfaces.torus,
        {"loops": [disc((1.0, 1.5), 0.4), disc((3.0, 1.8), 0.4)]},
        2,
    ),
    "discs": (
        gm.surfaces.plane,
        {"loops": [disc((-0.5, 0.0), 0.4), disc((0.5, 0.2), 0.4)]},
        2,
    ),
    "ring": (
        gm.surfaces.plane,
        {"loops": [disc((0.0, 0.0), 0.8), disc((0.0, 0.0), 0.3)]},
        1,
    ),
    "circles": (
        CASES["concentric circles"].surface,
        {"within": lambda u, v: abs(u - 0.45) > 0.02},
        5,
    ),
    "arcs": (CASES["crater"].surface, {"within": lambda u, v: abs(u + v) > 0.2}, 2),
}


@pytest.mark.parametrize("name", CUT)
def test_pieces_inside_of_a_trim_have_one_sample_each(name: str) -> None:
    make, trim, pieces = CUT[name]
    surface = make().trimmed(**trim)
    for side, sign in ((surface, 1.0), (surface.flipped(), -1.0)):
        known = gm.GaussMap(side)
        samples = known.points([(0.0, 0.0, sign)])
        assert (samples.report.proved, samples.report.undecided) == (1, ())
        curves = samples[samples.component == CURVE]
        assert len(curves) == pieces
        assert side.trim.contains(curves.uv).all()
        own = side.normals(*curves.uv.T)
        np.testing.assert_allclose(own - [0.0, 0.0, sign], 0.0, atol=1e-12)
        np.testing.assert_array_equal(known.count([(0.0, 0.0, sign)] * 2), len(samples))


def test_summaries_name_what_samples_stand_for() -> None:
    known = gm.GaussMap(gm.surfaces.torus())
    assert "2 on curves with one normal" in known.points([Z, (0.0, 0.0, -1.0), X]).summary()
    assert "curve" not in known.points([X]).summary()
    saddle = gm.GaussMap(gm.surfaces.monkey_saddle()).points([Z])
    assert "1 isolated with K = 0" in saddle.summary()
