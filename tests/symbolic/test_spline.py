"""The spline, exactly: what makes it C¹, and that it reproduces quadratics."""

import random
from fractions import Fraction
from itertools import pairwise, product
from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic import curve, patch, spline
from gaussmap.symbolic.notation import scalar, substitute

from ..refusals import refused
from .calls import components, evaluated

HALF = Fraction(1, 2)
NET: Any = spline.control_points()
CELLS = [(i, j) for i in range(-2, 3) for j in range(-2, 3)]  # the support and one ring more
MONOMIALS = [(r, s) for r, s in product(range(3), repeat=2) if r + s <= 2]


class Piece:
    """A quadratic over a triangle, by its Bézier ordinates at the places of the net."""

    def __init__(self, triangle, net) -> None:
        self.triangle = triangle
        self.ordinates = [
            [net.get(spline.middle(p, q), Fraction(0)) for q in triangle] for p in triangle
        ]
        (px, py), (qx, qy), (rx, ry) = triangle
        area = (qx - px) * (ry - py) - (qy - py) * (rx - px)
        self.slopes = [
            ((qy - ry) / area, (rx - qx) / area),
            ((ry - py) / area, (px - rx) / area),
            ((py - qy) / area, (qx - px) / area),
        ]  # the gradients of the barycentric coordinates

    def barycentric(self, point):
        """Return the barycentric coordinates: each is 0 at the two other corners, and linear."""
        corners = [self.triangle[k - 2] for k in range(3)]
        return [
            sum(s * (x - c) for s, x, c in zip(slope, point, corner, strict=True))
            for slope, corner in zip(self.slopes, corners, strict=True)
        ]

    def value(self, point):
        w = self.barycentric(point)
        return sum(w[i] * w[j] * self.ordinates[i][j] for i, j in product(range(3), repeat=2))

    def gradient(self, point):
        w = self.barycentric(point)
        by_weight = [2 * sum(w[j] * self.ordinates[i][j] for j in range(3)) for i in range(3)]
        return [sum(by_weight[i] * self.slopes[i][x] for i in range(3)) for x in range(2)]


def pieces(net) -> list[Piece]:
    return [Piece(triangle, net) for triangle in spline.triangles(CELLS)]


@pytest.fixture(scope="module")
def net():
    return spline.box_spline_net()


@pytest.fixture
def numbers():
    generator = random.Random(7)
    return lambda: Fraction(generator.randint(-20, 20), generator.randint(1, 9))


# --- the box spline -------------------------------------------------------------------------------


def test_c1_across_every_edge(net):
    neighbours = {}
    for piece in pieces(net):
        for k in range(3):
            edge = frozenset((piece.triangle[k], piece.triangle[k - 1]))
            neighbours.setdefault(edge, []).append(piece)
    inner = {edge: two for edge, two in neighbours.items() if len(two) == 2}
    assert len(inner) == 4 * 25 + 2 * 4 * 5  # half diagonals, and edges between cells
    for edge, (left, right) in inner.items():
        for end in edge:
            assert left.value(end) == right.value(end)
            assert left.gradient(end) == right.gradient(end)


def test_conditions_of_nets_that_leave_a_choice_are_refused(monkeypatch):
    """The C¹ quadratics on one cell alone, with no border to vanish on, have dimension 8."""
    monkeypatch.setattr(spline, "NEIGHBOURS", {"c": (0, 0)})
    refused("8 functions", spline.box_spline_net.__wrapped__, error=ArithmeticError)


# --- nets -----------------------------------------------------------------------------------------


def net_of_cell(mu, turn: int) -> dict[str, Fraction]:
    """Return the net of a triangle of the central cell from its 3 × 3 coefficients, by NET."""
    turned = {
        name: mu[spline.quarter_turns(place, turn)] for name, place in spline.NEIGHBOURS.items()
    }
    values = {
        spline.MU[name]: sp.Rational(x.numerator, x.denominator) for name, x in turned.items()
    }
    return {x.name[1:]: spline.fraction(y.xreplace(values)) for x, y in NET.items()}


def test_triangle_is_the_power_form_of_the_net():
    """Its vectors are those of POWER_FORM times SCALE, the point p relative to the coefficient."""
    values: dict[Any, Any] = dict(spline.TRIANGLE.definitions)
    differences = {x: x - spline.MU["c"] for x in spline.MU.values() if x != spline.MU["c"]}
    for symbol, vector in patch.POWER_FORM.definitions:
        expected = substitute(vector, NET) - (spline.MU["c"] if symbol.name == "p" else 0)
        assert sp.expand(values[symbol].xreplace(differences) - spline.SCALE * expected) == 0
    weights = [
        weight for value in values.values() for weight in value.as_coefficients_dict().values()
    ]
    assert all(weight.is_Integer for weight in weights)
    assert sp.igcd(*weights) == 1


# --- functionals ----------------------------------------------------------------------------------


def monomial(powers, point) -> Fraction:
    return Fraction(point[0]) ** powers[0] * Fraction(point[1]) ** powers[1]


def applied(formula, *values: Fraction) -> Fraction:
    """Return the only output of a formula for these inputs."""
    numbers = [sp.Rational(x.numerator, x.denominator) for x in values]
    (output,) = formula.expanded().values()
    return spline.fraction(output.xreplace(dict(zip(formula.inputs, numbers, strict=True))))


FUNCTIONALS = {
    "coefficient": [(0, 0), *spline.orbit(HALF, HALF)],
    "coefficient_from_centres": [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)],
    "coefficient_from_vertices": [*spline.orbit(HALF, HALF), *spline.orbit(HALF, 3 * HALF)],
}


@pytest.mark.parametrize("name", FUNCTIONALS)
def test_the_spline_surface_of_a_quadratic_is_that_quadratic(name, numbers):
    """Fit all six monomials with a functional and read the spline at random places of a cell."""
    (formula,) = [x for x in spline.FORMULAS if x.name == name]
    for powers in MONOMIALS:
        mu = {
            (i, j): applied(
                formula, *(monomial(powers, (i + x, j + y)) for x, y in FUNCTIONALS[name])
            )
            for i, j in product((-1, 0, 1), repeat=2)
        }
        for turn, triangle in enumerate(spline.triangles([(0, 0)])):
            places = {spline.quarter_turns(place, turn): key for key, place in spline.SOUTH.items()}
            ordinates = net_of_cell(mu, turn)
            piece = Piece(triangle, {place: ordinates[key] for place, key in places.items()})
            for point in [(numbers(), numbers()) for _ in range(6)]:
                assert piece.value(point) == monomial(powers, point)


@pytest.mark.parametrize(
    "orbits",
    [
        [[(Fraction(0), Fraction(0))]],
        [[(Fraction(0), Fraction(0))], spline.orbit(HALF, HALF), spline.orbit(HALF, 3 * HALF)],
    ],
    ids=["too few", "too many"],
)
def test_points_that_do_not_determine_a_functional_are_refused(orbits):
    refused("do not determine", spline.coefficient_weights, *orbits, error=ArithmeticError)


def test_extrapolation_is_3_minus_3_1():
    assert spline.extrapolation_weights() == [3, -3, 1]
    for power in range(3):
        values = [Fraction(k) ** power for k in range(4)]
        assert applied(spline.EXTRAPOLATION, *values[1:]) == values[0]


# --- the border -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("formula", "point"), [(spline.BEYOND_EDGE, "b110"), (spline.BEYOND_CORNER, "b200")]
)
def test_coefficients_beyond_the_border_give_the_point_on_it(formula, point):
    """In the net of the cell the coefficient gives back the Bézier point that it was made from."""
    ((unknown, value),) = formula.definitions
    (weights,) = [y.as_coefficients_dict() for x, y in NET.items() if x.name == point]
    around = {symbol.name: weight for symbol, weight in weights.items()}
    others = sum(
        weight * sp.Symbol(name, real=True)
        for name, weight in around.items()
        if name != unknown.name
    )
    assert sp.expand(around[unknown.name] * value + others) == sp.Symbol("f", real=True)


# --- planar curves --------------------------------------------------------------------------------

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
