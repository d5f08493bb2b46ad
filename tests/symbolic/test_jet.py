"""The formulas of 2-jets, exactly: of a sphere, and of polar coordinates."""

from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic.jet import AT_JET, AT_POLE, BEND, CONTOUR, NEWTON, POLAR_CHART
from gaussmap.symbolic.notation import Cross, Det, Dot, derivative, scalar, vectors

from ..refusals import refused
from .calls import components, evaluated

diff: Any = sp.diff
s, t, phi, r = sp.symbols("s t phi r", real=True)
GRAPH: Any = sp.Matrix([s + t**2, t - s * t, 1 + 2 * s**2 + 3 * s * t - t**2 + s**3])


def jet(x: Any, u: sp.Symbol, v: sp.Symbol) -> dict[sp.Expr, sp.Expr]:
    derivatives = {"a": (u, u), "b": (u, v), "c": (v, v), "d": (u,), "e": (v,)}
    return components(**{name: diff(x, *by) for name, by in derivatives.items()})


def test_a_sphere_with_outward_normals():
    radius = sp.Rational(3, 2)
    x = radius * sp.Matrix([sp.cos(s) * sp.cos(t), sp.sin(s) * sp.cos(t), sp.sin(t)])
    place = {s: sp.Rational(1, 3), t: sp.Rational(1, 5)}
    found = evaluated(AT_JET, jet(x, s, t))
    for name, expected in {"K": 1 / radius**2, "H": 1 / radius}.items():
        assert abs((found[name] - expected).subs(place).evalf(30)) < 1e-25
    for name, value in zip("xyz", x, strict=True):
        assert abs((found[f"n_{name}"] - value / radius).subs(place).evalf(30)) < 1e-25


def test_newtons_step_is_exact_on_a_quadratic_patch():
    """From (0, 0) it leads to the point with the normal at once; s and m are those of the angle."""
    x = GRAPH - sp.Matrix([0, 0, s**3])
    at = {s: sp.Rational(1, 7), t: sp.Rational(-2, 9)}
    normal = diff(x, s).cross(diff(x, t)).subs(at)
    origin = {s: 0, t: 0}
    values = {key: value.subs(origin) for key, value in jet(x, s, t).items()}
    found = evaluated(NEWTON, values | components(n=normal))
    assert (found["u"], found["v"]) == (at[s], at[t])
    here = diff(x, s).cross(diff(x, t)).subs(origin)
    assert found["s"] == normal.cross(here).dot(normal.cross(here)) / here.dot(here)
    assert found["m"] == normal.dot(here)


def test_the_contour_is_where_the_normal_is_perpendicular():
    """f is N·w, and its derivatives are those of that function."""
    along = sp.Matrix([2, -1, 3])
    N = diff(GRAPH, s).cross(diff(GRAPH, t))
    found = evaluated(CONTOUR, jet(GRAPH, s, t) | components(w=along))
    f = N.dot(along)
    for name, wanted in {"f": f, "f_u": diff(f, s), "f_v": diff(f, t)}.items():
        assert sp.expand(found[name] - wanted) == 0
    for name, wanted in zip("xyz", N, strict=True):
        assert sp.expand(found[f"N_{name}"] - wanted) == 0


def test_the_second_form_of_a_tangent_vector():
    """N·x'' on the line through (s, t) along (3, −2) in the parameters."""
    line = {s: s + 3 * r, t: t - 2 * r}
    at = {s: sp.Rational(1, 7), t: sp.Rational(-2, 9), r: 0}
    x = GRAPH.subs(line, simultaneous=True)
    N = diff(GRAPH, s).cross(diff(GRAPH, t))
    values = jet(GRAPH, s, t) | components(w=diff(x, r).subs(r, 0))
    found = evaluated(BEND, {key: value.subs(at) for key, value in values.items()})
    assert found["k"] == N.dot(diff(x, r, r)).subs(at)


def test_the_product_rule():
    a, b, c, d = vectors("abcd")
    by = {a: c, b: d}
    assert derivative(Dot(a, b), by) == Dot(c, b) + Dot(a, d)
    assert derivative(Dot(a, a), {a: a}) == 2 * Dot(a, a)
    assert derivative(3 * Cross(a, d) - Cross(a, c), by) == 3 * Cross(c, d)  # c × c = 0
    assert derivative(Det(a, b, c), {a: b, b: d}) == Det(a, d, c)  # the same vector twice
    assert derivative(Cross(c, d), by) == 0
    refused("no sum of multiples", derivative, Dot(a, b) * Dot(a, c), by, error=TypeError)


def assert_derivatives(found: dict[str, Any], place: dict[sp.Symbol, Any]) -> None:
    """Compare derivatives of the graph by s and t at a place."""
    for name, by in {"ss": (s, s), "st": (s, t), "tt": (t, t), "s": (s,), "t": (t,)}.items():
        expected = diff(GRAPH, *by).subs(place)
        assert [sp.nsimplify(found[f"X_{name}_{axis}"]) for axis in "xyz"] == list(expected)


@pytest.mark.parametrize("direction", [(1, 0), (sp.Rational(3, 5), sp.Rational(-4, 5))])
def test_polar_chart(direction):
    cosine, sine = direction
    distance = sp.Rational(2, 3)
    polar = jet(GRAPH.subs({s: r * sp.cos(phi), t: r * sp.sin(phi)}, simultaneous=True), phi, r)
    here = {sp.cos(phi): cosine, sp.sin(phi): sine, r: distance}
    place = {scalar("x"): cosine, scalar("y"): sine, scalar("r"): distance}
    found = evaluated(POLAR_CHART, {key: x.subs(here) for key, x in polar.items()} | place)
    assert_derivatives(found, {s: distance * cosine, t: distance * sine})


def test_at_pole():
    along = {
        k: GRAPH.subs({s: r * sp.cos(k * sp.pi / 4), t: r * sp.sin(k * sp.pi / 4)})
        for k in (0, 1, 2)
    }
    first = {f"e{k}": diff(along[k], r).subs(r, 0) for k in (0, 2)}
    second = {f"c{k}": diff(along[k], r, 2).subs(r, 0) for k in (0, 1, 2)}
    assert_derivatives(evaluated(AT_POLE, components(**first, **second)), {s: 0, t: 0})
