"""Planar curves, exactly: the support function of an arc, and the spline, against definitions."""

import random
from itertools import pairwise
from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic import curve, spline
from gaussmap.symbolic.notation import scalar

from ..refusals import refused
from .calls import components, evaluated

t = sp.Symbol("t", real=True)
n: Any = sp.Matrix(sp.symbols("n_x n_y", real=True))
PLACES = [sp.Rational(-2, 3), sp.Integer(0), sp.Rational(2, 5), sp.Integer(1)]


class Case:
    """A random arc, its point and derivatives by the definition with Bernstein polynomials."""

    def __init__(self, seed: int) -> None:
        generator = random.Random(seed)
        points = [[generator.randint(-9, 9) for _ in range(2)] for _ in range(3)]
        basis = ((1 - t) ** 2, 2 * t * (1 - t), t**2)
        self.p: Any = sum(
            (b * sp.Matrix(x) for b, x in zip(basis, points, strict=True)), sp.zeros(2, 1)
        )
        self.tangent: Any = self.p.diff(t).applyfunc(sp.expand)
        self.normal: Any = sp.Matrix([self.tangent[1], -self.tangent[0]])
        names = [x.name for x in curve.CONTROL_POINTS]
        control = components(**dict(zip(names, map(sp.Matrix, points), strict=True)))
        form = evaluated(curve.POWER_FORM, control)
        self.values = {scalar(name): x for name, x in form.items()}

    def expression(self, formula, name: str) -> Any:
        """Return an output of a formula for this arc; n, t stay symbols."""
        return formula.expanded()[name].xreplace(self.values)

    def vector(self, formula, name: str) -> Any:
        return sp.Matrix([self.expression(formula, f"{name}_{axis}") for axis in "xy"])

    def at_normal(self, expression, place, factor=1) -> Any:
        """Return the value of an expression in n for n = N(t), times a factor."""
        normal = factor * self.normal.subs(t, place)
        return expression.xreplace(dict(zip(n, normal, strict=True)))

    def curvature(self, place) -> Any:
        """Return κ by its definition x' y'' − y' x'' over |p'|³."""
        first, second = (self.p.diff(t, k).subs(t, place) for k in (1, 2))
        return (first[0] * second[1] - first[1] * second[0]) / sp.sqrt(first.dot(first)) ** 3


@pytest.fixture(scope="module")
def case() -> Case:
    return Case(1)


# --- one arc --------------------------------------------------------------------------------------


def test_power_form_is_the_bezier_form(case):
    point = case.vector(curve.ENVELOPE, "x")
    assert (point - case.p).applyfunc(sp.expand) == sp.zeros(2, 1)
    tangent = case.vector(curve.TANGENT, "p_t")
    assert (tangent - case.tangent).applyfunc(sp.expand) == sp.zeros(2, 1)
    normal = case.vector(curve.TANGENT, "N")
    assert (normal - case.normal).applyfunc(sp.expand) == sp.zeros(2, 1)


def test_gradient_is_the_point_with_that_normal(case):
    h = case.expression(curve.SUPPORT_FUNCTION, "h")
    gradient = sp.Matrix([sp.diff(h, x) for x in n])
    at_n = {t: case.expression(curve.PARAMETER, "t")}
    assert (case.p.xreplace(at_n) - gradient).applyfunc(sp.cancel) == sp.zeros(2, 1)
    assert sp.cancel(n.dot(gradient) - h) == 0  # Euler


def test_curvature_is_that_of_the_definition(case):
    for place in PLACES:
        length = sp.sqrt(case.tangent.subs(t, place).dot(case.tangent.subs(t, place)))
        tangent = dict(zip(curve.p_t.components, case.tangent.subs(t, place), strict=True))
        form = case.at_normal(curve.PARAMETER.in_components().definitions[0][1], place, 1 / length)
        by_normal = curve.CURVATURE.expanded()["kappa"].xreplace(
            {curve.A: form.xreplace(case.values), **tangent}
        )
        assert sp.simplify(by_normal - case.curvature(place)) == 0


def test_a_wrong_writing_is_refused():
    refused("is not", curve._written, t, sp.diff(curve.SUPPORT, curve.A), error=ArithmeticError)


# --- the spline -----------------------------------------------------------------------------------


def control_points(mu) -> list[Any]:
    """Return the three control ordinates over a piece from three coefficients."""
    values = dict(zip((x.components[0] for x in curve.COEFFICIENTS), mu, strict=True))
    return [
        curve.CONTROL_NET.expanded()[f"{x.name}_x"].xreplace(values) for x in curve.CONTROL_POINTS
    ]


def test_spline_is_c1():
    mu = [sp.Rational(x) for x in ("3", "-7/2", "5", "1/3", "9")]
    for left, right in pairwise(control_points(mu[k : k + 3]) for k in range(3)):
        assert left[2] == right[0]
        assert left[2] - left[1] == right[1] - right[0]


def test_arc_is_the_power_form_of_the_control_points():
    left, centre, right = (sp.Integer(x) for x in (4, -3, 11))
    b20, b11, b02 = control_points((left, centre, right))
    differences = {scalar("mu_l_x"): left - centre, scalar("mu_r_x"): right - centre}
    a, b, c = (curve.ARC.expanded()[f"{x}_x"].xreplace(differences) for x in "abc")
    for place in PLACES:
        by_points = (1 - place) ** 2 * b20 + 2 * place * (1 - place) * b11 + place**2 * b02
        assert a * place**2 / 2 + b * place + c + centre == by_points


@pytest.mark.parametrize(
    ("formula", "places"),
    [(spline.EDGE_POINT, ("0", "-1/2", "1/2")),
     (spline.EDGE_POINT_FROM_VERTICES, ("-1/2", "1/2", "-3/2", "3/2"))],
    ids=["values", "points"],
)  # fmt: skip
@pytest.mark.parametrize("power", range(3))
def test_the_spline_of_a_quadratic_is_that_quadratic(formula, places, power):
    """The functionals of an edge on the border of a surface, pieces centred at −1, 0, 1."""
    ((_, functional),) = formula.definitions
    mu = []
    for piece in (-1, 0, 1):
        values = ((sp.Rational(x) + piece) ** power for x in places)
        mu.append(functional.xreplace(dict(zip(formula.inputs, values, strict=True))))
    b20, b11, b02 = control_points(mu)
    for place in PLACES:
        point = (1 - place) ** 2 * b20 + 2 * place * (1 - place) * b11 + place**2 * b02
        assert point == (place - sp.Rational(1, 2)) ** power


def test_the_coefficient_beyond_an_end_interpolates_it():
    ((_, value),) = curve.BEYOND_END.definitions
    mu_l = value.xreplace({scalar("f"): sp.Integer(5), scalar("mu_c"): sp.Integer(2)})
    assert control_points((mu_l, sp.Integer(2), sp.Integer(40)))[0] == 5
    assert control_points((sp.Integer(40), sp.Integer(2), mu_l))[2] == 5  # at the other end too


def test_conditions_that_leave_a_choice_are_refused(monkeypatch):
    monkeypatch.setattr(curve, "pairwise", lambda pieces: [])
    refused("do not determine", curve.b_spline_net, error=ArithmeticError)
