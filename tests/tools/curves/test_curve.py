"""Planar curves: making, evaluating and fitting them, and what their splines say."""

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp

from ...refusals import refused
from ...shapes import EPS, TURN


def ellipse(t):
    return np.stack([2 * np.cos(t), np.sin(t)], axis=-1)


def eight(t):
    return np.stack([np.sin(t), np.sin(2 * t)], axis=-1)


def parabola(t):
    return np.stack([t, 1 - 2 * t + 3 * t * t], axis=-1)


ELLIPSE = gm.curves.Curve.from_callable(ellipse, TURN, periodic=True, name="ellipse")
EIGHT = gm.curves.Curve.from_callable(eight, TURN, periodic=True, name="eight")
PARABOLA = gm.curves.Curve.from_callable(parabola, (-1.0, 2.0), name="parabola")


# --- making and evaluating ------------------------------------------------------------------------


def test_sympy_and_callable_are_the_same_curve():
    t = sp.Symbol("t")
    by_text = gm.curves.Curve.from_sympy(("2*cos(t)", "sin(t)"), "t", (0, "2*pi"), True)
    by_symbol = gm.curves.Curve.from_sympy((2 * sp.cos(t), sp.sin(t)), t, (0, 2 * sp.pi), True)
    places = np.linspace(0, 6, 17).reshape(1, 17)
    for curve in (by_text, by_symbol):
        assert (curve.domain, curve.periodic) == (TURN, True)
        assert gm.curves.fit(curve).pieces == 64
        np.testing.assert_allclose(curve.evaluate(places), ellipse(places), rtol=0, atol=4 * EPS)


def test_constant_expressions_and_scalars():
    curve = gm.curves.Curve.from_sympy((1, "s**2"), "s", (0, 1))
    assert curve.evaluate(0.5).tolist() == [1.0, 0.25]
    assert curve.evaluate([[0.0], [1.0]]).shape == (2, 1, 2)
    assert gm.curves.fit(curve).evaluate(0.5).shape == (2,)


POINTS, CALLABLE, SYMPY = (
    getattr(gm.curves.Curve, f"from_{x}") for x in ("points", "callable", "sympy")
)
NO_DOMAIN = [(0,), (0, 1, 2), (1, 0), (0, 0), (0, np.inf), (np.nan, 1), None, "ab", (0, 1 + 1j)]


@pytest.mark.parametrize(
    ("call", "arguments", "complaint"),
    [
        *((SYMPY, (x, "t", (0, 1)), "two SymPy expressions")
          for x in (("t",), ("t", "t", "t"), "tt", None)),
        (SYMPY, (("t", "s"), "t", (0, 1)), "symbols .*s"),
        (SYMPY, (("t", "("), "t", (0, 1)), "not a SymPy expression"),
        (SYMPY, (("t", "zoo"), "t", (0, 1)), "not a real number"),
        *((SYMPY, (("t", "t"), x, (0, 1)), "symbol such as t")
          for x in ("", "2t", 3, None, ("t",))),
        *((SYMPY, (("t", "t"), "t", x), "domain") for x in NO_DOMAIN),
        *((CALLABLE, (ellipse, x), "domain") for x in NO_DOMAIN),
        (CALLABLE, (3, (0, 1)), "callable as f"),
        *((CALLABLE, (ellipse, (0, 1), x), "True or False") for x in ("periodic", None, 1)),
        *((POINTS, (np.eye(4, 2), x), "True or False") for x in ("periodic", None, (True, True))),
        (POINTS, (np.zeros((5, 3)),), r"\(m, 2\), not \(5, 3\)"),
        *((POINTS, (x,), "shape") for x in (np.zeros(4), [])),
        (POINTS, (np.eye(2),), "at least 3 points"),
        (POINTS, ([["a", "b"]] * 4,), "real numbers"),
        (POINTS, ([[0, 0], [1, np.nan], [2, 0], [3, np.inf]],), r"2 points with NaN .*, .* \[1\]"),
        (POINTS, (np.ma.masked_equal(np.eye(4, 2), 1),), "masked"),
        *((gm.curves.fit, (ELLIPSE, x), "pieces must be") for x in (0, -3, 2.0, True)),
        (gm.curves.fit, (ELLIPSE, 2), "at least 3 pieces"),
        (gm.curves.fit, (gm.surfaces.torus(),), "takes a Curve, not"),
        (gm.curves.fit, (CALLABLE(ellipse, (1.0, 1.0 + 8 * EPS)),), "too narrow"),
    ],
)  # fmt: skip
def test_unusable_arguments(call, arguments, complaint):
    refused(complaint, call, *arguments)


@pytest.mark.parametrize(
    ("how", "complaint"),
    [((lambda t: 1 / 0, (0, 1)), "raised ZeroDivisionError"),
     ((np.cos, (0, 1)), "returned the shape"),
     ((lambda t: np.stack([t, t, t], -1), (0, 1)), "returned the shape"),
     ((lambda t: np.stack([t, 1j * t], -1), (0, 1)), "real numbers"),
     ((lambda t: np.stack([t, 1 / (t - 0.5)], -1), (0, 1)), r"'curve' is not finite at t = 0\.5"),
     ((lambda t: 1e305 * ellipse(t), (0.0, 1.0)), "too large"),
     ((ellipse, (0.0, 3.0), True), "does not close")],
)  # fmt: skip
def test_unusable_callables(how, complaint):
    refused(complaint, gm.curves.fit, CALLABLE(*how), 4, error=gm.errors.SurfaceError)


# --- points ---------------------------------------------------------------------------------------


def test_points_lie_near_the_curve_through_them():
    """On a quadratic they lie on it; else the spline is off by its error of order 3."""
    points = parabola(np.linspace(-1, 2, 7))
    curve = gm.curves.Curve.from_points(points)
    assert (curve.domain, curve.periodic) == ((0.0, 6.0), False)
    assert gm.curves.fit(curve).pieces == 6
    np.testing.assert_allclose(curve.evaluate(np.arange(7)), points, rtol=0, atol=100 * EPS)
    errors = []
    for count in (32, 64):
        points = ellipse(2 * np.pi * np.arange(count) / count)
        closed = gm.curves.Curve.from_points(points, closed=True)
        assert closed.domain == (0.0, float(count))
        errors.append(np.abs(closed.evaluate(np.arange(count)) - points).max())
    assert errors[0] / errors[1] > 7.5


def test_points_can_be_fitted_with_other_pieces():
    curve = gm.curves.Curve.from_points(ellipse(2 * np.pi * np.arange(50) / 50), closed=True)
    assert gm.curves.fit(curve).pieces == 50
    spline = gm.curves.fit(curve, pieces=200)
    assert spline.turning_number == 1
    places = np.linspace(0, 50, 77)
    assert np.abs(spline.evaluate(places) - curve.evaluate(places)).max() < 1e-4


@pytest.mark.parametrize(("part", "repeats"), [(0.5e-3, True), (2e-3, False)])
def test_closed_points_that_nearly_repeat_the_first(part, repeats):
    """They do if their distance is a thousandth of that of two points."""
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, part]])
    if repeats:
        refused("repeats its first point", gm.curves.Curve.from_points, points, closed=True)
    else:
        assert gm.curves.fit(gm.curves.Curve.from_points(points, closed=True)).pieces == 5


# --- fitting --------------------------------------------------------------------------------------


@pytest.mark.parametrize("pieces", [1, 2, 3, 64])
def test_quadratics_are_reproduced(pieces):
    """Up to rounding: a few roundings of each of a few terms."""
    spline = gm.curves.fit(PARABOLA, pieces)
    places = np.linspace(-1, 2, 101)
    np.testing.assert_allclose(spline.evaluate(places), parabola(places), rtol=0, atol=200 * EPS)
    kappa = 6 / np.hypot(1, 6 * places - 2) ** 3
    np.testing.assert_allclose(spline.curvature(places), kappa, rtol=1e-12 * pieces)
    normal = np.stack([6 * places - 2, -np.ones_like(places)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    np.testing.assert_allclose(spline.normals(places), normal, rtol=0, atol=1e-12 * pieces)


def test_ends_of_an_open_curve_are_met():
    spline = gm.curves.fit(gm.curves.Curve.from_callable(ellipse, (0.0, 2.0)), 10)
    ends = spline.evaluate(spline.domain)
    np.testing.assert_allclose(ends, ellipse(np.array([0.0, 2.0])), rtol=0, atol=8 * EPS)


@pytest.mark.parametrize("domain", [(0.3, 2.0), TURN], ids=["open", "closed"])
def test_orders(domain):
    curve = gm.curves.Curve.from_callable(eight, domain, periodic=domain is TURN)
    t = np.linspace(domain[0], domain[1], 4001)
    tangent = np.stack([np.cos(t), 2 * np.cos(2 * t)], axis=-1)
    exact = np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)
    exact /= np.linalg.norm(exact, axis=-1, keepdims=True)
    errors = []
    for pieces in (64, 128):
        spline = gm.curves.fit(curve, pieces)
        errors.append(
            (np.abs(spline.evaluate(t) - eight(t)).max(), np.abs(spline.normals(t) - exact).max())
        )
    position, normal = np.log2(np.divide(*errors))
    assert 2.9 < position < 3.2
    assert 1.9 < normal < 2.2


def test_control_points_give_the_spline():
    spline = gm.curves.fit(EIGHT, 24)
    assert spline.control_points.shape == (24, 3, 2)
    ends = spline.evaluate(spline.joints)
    np.testing.assert_allclose(spline.control_points[:, 0], ends[:-1], rtol=0, atol=8 * EPS)
    np.testing.assert_allclose(spline.control_points[:, 2], ends[1:], rtol=0, atol=8 * EPS)
    middles = spline.evaluate((spline.joints[:-1] + spline.joints[1:]) / 2)
    weights = np.array([0.25, 0.5, 0.25])
    by_points = np.einsum("j,kjx->kx", weights, spline.control_points)
    np.testing.assert_allclose(middles, by_points, rtol=0, atol=16 * EPS)


def test_closed_splines_wrap():
    spline = gm.curves.fit(ELLIPSE, 16)
    t = np.array([0.5, 3.0])
    for turns in (-2, 1):
        moved = spline.evaluate(t + 2 * np.pi * turns)
        np.testing.assert_allclose(moved, spline.evaluate(t), rtol=0, atol=64 * EPS)
    assert (spline.joint_normals[0] == spline.joint_normals[-1]).all()
    assert (spline.coefficients[:2] == spline.coefficients[-2:]).all()


def test_parameters_outside():
    spline = gm.curves.fit(PARABOLA)
    refused(r"t = 2\.1 lies outside", spline.evaluate, [0.0, 2.1])
    for place in (np.nan, np.inf):
        refused("lies outside", spline.normals, place)
        refused("lies outside", gm.curves.fit(ELLIPSE).curvature, place)
    refused("real numbers", spline.evaluate, "x")


# --- how the normal turns -------------------------------------------------------------------------


def test_inflections_are_where_the_curvature_changes_its_sign():
    """sin t has them at multiples of π; the spline finds them to within a piece."""
    sine = gm.curves.Curve.from_callable(lambda t: np.stack([t, np.sin(t)], -1), (-1.0, 9.0))
    spline = gm.curves.fit(sine, 100)
    np.testing.assert_allclose(spline.inflections, np.pi * np.arange(3), atol=spline.step)
    assert spline.turning_number is None
    for place in spline.inflections:
        before, after = spline.curvature(place + np.array([-0.5, 0.5]) * spline.step)
        assert before * after < 0.0


def test_a_straight_stretch_between_bends_is_one_inflection():
    def f(t):
        return np.stack([t, np.sign(t) * np.maximum(np.abs(t) - 1.0, 0.0) ** 2], axis=-1)

    spline = gm.curves.fit(gm.curves.Curve.from_callable(f, (-2.0, 2.0)), 40)
    assert spline.straight[11:29].all()
    assert spline.inflections == pytest.approx([0.0], abs=1e-12)
