"""The formulas of 2-jets: of a sphere, polar coordinates, surfaces of revolution, offsets."""

from typing import Any

import mpmath
import pytest
import sympy as sp
from gaussmap.symbolic.faces import OFFSET_JET, REVOLUTION_JET, TORUS_NORMAL
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


# --- derivatives of surfaces of revolution and offsets --------------------------------------------

u, v = sp.symbols("u v", real=True)
PLACE = (mpmath.mpf(2) / 7, mpmath.mpf(-3) / 5)
# The orders of the derivatives of a 2-jet, by u and by v, and of third derivatives.
ORDERS = {"": (0, 0), "_u": (1, 0), "_v": (0, 1), "_uu": (2, 0), "_uv": (1, 1), "_vv": (0, 2)}
LETTERS = {"p": (0, 0), "d": (1, 0), "e": (0, 1), "a": (2, 0), "b": (1, 1), "c": (0, 2)}
THIRDS = {"x_uuu": (3, 0), "x_uuv": (2, 1), "x_uvv": (1, 2), "x_vvv": (0, 3)}


def derivatives(functions, orders):
    """Return the derivatives of three functions of u and v, by the names of their components."""
    return {
        f"{name}_{axis}": mpmath.diff(function, PLACE, order) if any(order) else function(*PLACE)
        for name, order in orders.items()
        for axis, function in zip("xyz", functions, strict=True)
    }


def compare(formula, inputs, wanted):
    plain = formula.in_components()
    found = {symbol: sp.Float(inputs[symbol.name]) for symbol in plain.inputs}
    for symbol, value in plain.definitions:
        found[symbol] = value.xreplace(found)
    assert {x.name for x in plain.outputs} == set(wanted)
    for symbol in plain.outputs:
        assert abs(found[symbol] - wanted[symbol.name]) < 1e-13 * max(1, abs(found[symbol]))


def functions_of(position):
    return [sp.lambdify((u, v), x, "mpmath") for x in position]


def test_the_revolution_of_a_twisted_curve():
    curve = sp.Matrix([2 + v**2, v - v**3, sp.exp(v)])
    inputs = derivatives(functions_of(curve), {"c": (0, 0), "c_v": (0, 1), "c_vv": (0, 2)})
    inputs |= {"x": mpmath.cos(PLACE[0]), "y": mpmath.sin(PLACE[0])}
    turned = functions_of(sp.rot_axis3(-u) * curve)
    orders = {f"x{name}" if name else "p": order for name, order in ORDERS.items()}
    compare(REVOLUTION_JET, inputs, derivatives(turned, orders))


def test_the_offset_of_a_surface_without_symmetries():
    position = sp.Matrix([u + v**2 / 3, v - u * v / 2, u**3 / 4 + u**2 * v - v**3 / 5 + u * v])
    field = sp.Matrix(position.diff(u)).cross(sp.Matrix(position.diff(v)))
    length, distance = sp.sqrt(field.dot(field)), sp.Rational(3, 10)
    inputs = derivatives(functions_of(position), LETTERS | THIRDS)
    inputs |= derivatives(functions_of(field / length), {"n": (0, 0)})
    inputs |= {"L": functions_of([length])[0](*PLACE), "R": distance}
    offset = functions_of(position + distance * field / length)
    compare(OFFSET_JET, inputs, derivatives(offset, {f"y{x}": y for x, y in ORDERS.items()}))


def test_the_normal_of_a_torus_that_meets_itself():
    """At the side of the tube that is across the axis, and at the other one."""
    for major in (mpmath.mpf(1) / 4, mpmath.mpf(-1) / 4, mpmath.mpf(0)):
        minor = mpmath.mpf(2) / 3
        distance = major + minor * sp.cos(v)
        position = [distance * sp.cos(u), distance * sp.sin(u), minor * sp.sin(v)]
        known = derivatives(functions_of(position), {"d": (1, 0), "e": (0, 1)})
        d, e = (sp.Matrix([known[f"{name}_{axis}"] for axis in "xyz"]) for name in "de")
        longitude, latitude = PLACE
        direction = sp.Matrix([
            mpmath.cos(longitude) * mpmath.cos(latitude),
            mpmath.sin(longitude) * mpmath.cos(latitude),
            mpmath.sin(latitude),
        ])  # fmt: skip
        inputs = {"R": major, "r": minor, "x": mpmath.cos(latitude)}
        compare(TORUS_NORMAL, inputs, {"q": d.cross(e).dot(direction)})
