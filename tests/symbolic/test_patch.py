"""One patch, exactly: the support function and what follows from it, against plain definitions."""

import random
from fractions import Fraction
from itertools import product
from typing import Any, cast

import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic import BezierTriangle, patch
from gaussmap.symbolic.gaussian_image import EDGE_VECTORS, TANGENTIAL
from gaussmap.symbolic.notation import Dot, dot, scalar, substitute, vectors
from gaussmap.symbolic.patch import FORMS, TANGENTS

from ..refusals import refused
from .calls import components, evaluated

u, v, t = sp.symbols("u v t", real=True)
n: Any = sp.Matrix(sp.symbols("n_x n_y n_z", real=True))
# The control points that give (12) of the paper.
POINTS_12 = [
    ["3/2", 0, 0], [0, "3/2", 0], [0, 0, "3/2"], [1, 1, "1/2"], [1, "1/2", 1], ["1/2", 1, 1]
]  # fmt: skip

CYLINDER = [[1, 0, 1], [0, 1, 0], [0, 0, 0], ["1/2", "1/2", 0], ["1/2", 0, 0], [0, "1/2", 0]]
FOLDED_PLANE = [[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]


def triangle_of(points) -> Any:
    """Return the triangle with results in the symbols of the formulas."""
    return BezierTriangle(points, patch.n.components)


def bezier_point(points) -> Any:
    """Return p(u,v) by the definition (10)."""
    w = 1 - u - v
    basis = (u**2, v**2, w**2, 2 * u * v, 2 * u * w, 2 * v * w)
    return sum(
        (b * sp.Matrix(point) for b, point in zip(basis, points, strict=True)), sp.zeros(3, 1)
    )


class Case:
    """A random patch, its point and tangents by definition, and rational parameter points."""

    def __init__(self, seed: int) -> None:
        generator = random.Random(seed)
        points = [[generator.randint(-9, 9) for _ in range(3)] for _ in range(6)]
        self.triangle: Any = triangle_of(points)
        self.p: Any = bezier_point(points).applyfunc(sp.expand)
        self.p_u, self.p_v = self.p.diff(u), self.p.diff(v)
        self.normal: Any = self.p_u.cross(self.p_v).applyfunc(sp.expand)
        self.places = [
            {
                u: sp.Rational(generator.randint(-5, 9), 7),
                v: sp.Rational(generator.randint(-5, 9), 8),
            }
            for _ in range(3)
        ]

    def at_normal(self, expression, place):
        """Return the value of an expression in n for n = N(u,v)."""
        return expression.xreplace(dict(zip(n, self.normal.xreplace(place), strict=True)))

    def fundamental_forms(self, place):
        """Return E, F, G and L, M, N, the latter with the unnormalized N(u,v)."""
        first = [
            dot(a, b) for a, b in ((self.p_u, self.p_u), (self.p_u, self.p_v), (self.p_v, self.p_v))
        ]
        second = [dot(self.normal, self.p.diff(*by)) for by in ((u, u), (u, v), (v, v))]
        return [form.subs(place) for form in (*first, *second)]

    def curvatures(self, place):
        """Return K and the mean curvature, positive on a sphere with outward normals."""
        E, F, G, L, M, N = self.fundamental_forms(place)
        area = E * G - F**2
        return (L * N - M**2) / area**2, -(E * N - 2 * F * M + G * L) / (2 * area * sp.sqrt(area))


@pytest.fixture(scope="module", params=[1, pytest.param(2, marks=pytest.mark.slow)])
def case(request) -> Case:
    return Case(request.param)


# --- the support function -------------------------------------------------------------------------


def test_power_form_is_the_bezier_form(case):
    point = list(case.triangle.evaluate(patch.ENVELOPE).values())
    assert [sp.expand(a - b) for a, b in zip(point, case.p, strict=True)] == [0, 0, 0]
    tangents = list(case.triangle.evaluate(patch.TANGENTS).values())
    expected = [*case.p_u, *case.p_v, *case.normal]
    assert [sp.expand(a - b) for a, b in zip(tangents, expected, strict=True)] == [0] * 9


def test_gradient_is_the_point_with_that_normal(case):
    for place in case.places:
        gradient = [case.at_normal(derivative, place) for derivative in case.triangle.gradient]
        assert gradient == list(case.p.xreplace(place))


def test_formula_12_comes_out_as_the_paper_prints_it():
    triangle = BezierTriangle(POINTS_12)
    assert str(triangle.support_function) == (
        "(13*n_1*n_2*n_3 + 5*(n_1**3 + n_2**3 + n_3**3)"
        " + 4*(n_1**2*n_2 + n_1**2*n_3 + n_1*n_2**2 + n_1*n_3**2 + n_2**2*n_3 + n_2*n_3**2))"
        "/(2*(n_1**2 + 3*n_1*n_2 + 3*n_1*n_3 + n_2**2 + 3*n_2*n_3 + n_3**2))"
    )
    cubes = r"5 \left(n_{1}^{3} + n_{2}^{3} + n_{3}^{3}\right) + 4 \left("
    assert triangle.latex().startswith(rf"h(n_{{1}}, n_{{2}}, n_{{3}}) = \frac{{{cubes}")
    assert r"+ 13 n_{1} n_{2} n_{3}}{2 \left(" in triangle.latex()
    assert cast(str, triangle._repr_latex_()).strip("$").endswith(triangle.latex())
    assert repr(triangle).startswith("BezierTriangle([(3/2, 0, 0), (0, 3/2, 0)")
    plane = [[2, 0, 0], [0, 2, 0], [0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]
    assert BezierTriangle(plane)._repr_latex_() is None


@pytest.mark.slow
def test_hessian_annihilates_the_normal_and_is_that_of_the_formula(case):
    hessian = case.triangle.hessian
    assert (hessian * n).applyfunc(sp.cancel) == sp.zeros(3, 1)
    values = case.triangle.evaluate(patch.FORMS) | linear_forms(case.triangle)
    for place in case.places[:2]:
        numbers = dict(zip(n, case.normal.subs(place), strict=True))
        rows = {scalar(name): form.subs(numbers) for name, form in values.items()}
        rows |= components(p_u=case.p_u.subs(place), p_v=case.p_v.subs(place))
        for name, entry in evaluated(patch.HESSIAN, rows).items():
            i, j = ("xyz".index(axis) for axis in name[2:])
            assert entry == hessian[i, j].subs(numbers)


def linear_forms(triangle) -> dict[str, sp.Expr]:
    """Return A, B, C in n."""
    names = [x.name for x in patch.NET]
    values = evaluated(
        patch.POWER_FORM, components(**dict(zip(names, triangle.control_points, strict=True)))
    )
    return {
        form: dot(n, sp.Matrix([values[f"{name}_{axis}"] for axis in "xyz"]))
        for form, name in zip("ABC", "abc", strict=True)
    }


# --- orientation and curvature --------------------------------------------------------------------


def test_oriented_normal_is_n_c3_over_d_squared(case):
    at_n = dict(zip((u, v), case.triangle.parameters, strict=True))
    normal = case.normal.xreplace(at_n)
    expected = n * case.triangle.orientation / case.triangle.forms["D"] ** 2
    assert (normal - expected).applyfunc(sp.cancel) == sp.zeros(3, 1)


def test_orientation_is_positive_at_oriented_normals(case):
    for place in case.places:
        c3 = case.at_normal(case.triangle.orientation, place)
        assert c3 > 0
        assert case.triangle.orientation.xreplace({a: -a for a in n}) == sp.expand(
            -case.triangle.orientation
        )


def test_gaussian_curvature_is_that_of_the_fundamental_forms(case):
    for place in case.places:
        K, _ = case.curvatures(place)
        assert case.at_normal(case.triangle.gaussian_curvature, place) == K


@pytest.mark.slow
def test_mean_curvature_is_that_of_the_fundamental_forms_and_of_the_radii(case):
    for place in case.places:
        K, H = case.curvatures(place)
        assert same_root(case.at_normal(case.triangle.mean_curvature, place), H)
        larger, smaller = (case.at_normal(r, place) for r in case.triangle.principal_radii)
        assert sp.expand(larger * smaller) == 1 / K
        assert same_root((larger + smaller) * K / 2, H)
        assert larger >= smaller


def same_root(left: sp.Expr, right: sp.Expr) -> bool:
    """Compare two signed square roots of rational numbers, exactly."""
    return sp.expand(left**2) == sp.expand(right**2) and bool(left * right > 0)


def test_formulas_of_curvature_agree(case):
    for place in case.places[:2]:
        K, H = case.curvatures(place)
        normal = case.normal.subs(place)
        unit = normal / sp.sqrt(dot(normal, normal))
        numbers = components(n=unit) | place
        sample = case.triangle.evaluate(patch.SAMPLE)
        at = case.triangle.evaluate(patch.CURVATURE_AT)
        for values in (sample, at):
            assert sp.simplify(values["K"].subs(numbers)) == K
            assert sp.simplify(values["H"].subs(numbers) - H) == 0
        assert [sp.simplify(sample[name].subs(numbers)) for name in "uv"] == [place[u], place[v]]
        measure = {k: e.subs(place) for k, e in case.triangle.evaluate(patch.MEASURE).items()}
        assert measure["dA"] ** 2 == dot(normal, normal)
        assert sp.simplify(measure["dS"] / measure["dA"]) == K


def test_radii_formula_is_the_reciprocal_of_curvature():
    radii, curvature = patch.RADII.expanded(), patch.CURVATURE.expanded()
    assert sp.cancel(radii["R_product"] * curvature["K"]) == 1
    assert sp.cancel(radii["R_sum"] * curvature["K"] / 2 - curvature["H"]) == 0


# --- the Gaussian image ---------------------------------------------------------------------------


def test_control_normals_reproduce_the_normal_field(case):
    values = case.triangle.evaluate(patch.CONTROL_NORMALS)
    points = [
        [values[f"N{index}_{axis}"] for axis in "xyz"]
        for index in ("200", "020", "002", "110", "101", "011")
    ]
    assert (bezier_point(points) - case.normal).applyfunc(sp.expand) == sp.zeros(3, 1)


def test_parabolic_cubic_is_d_of_the_normal_field(case):
    D = case.triangle.forms["D"].xreplace(dict(zip(n, case.normal, strict=True)))
    net = case.triangle.evaluate(patch.PARABOLIC_CUBIC)
    cubic = sum(
        patch.multinomial(i, j, 3 - i - j) * u**i * v**j * (1 - u - v) ** (3 - i - j)
        * net[f"D{i}{j}{3 - i - j}"]
        for i, j in product(range(4), repeat=2)
        if i + j <= 3
    )  # fmt: skip
    assert sp.expand(cubic - D) == 0
    assert sp.Poly(sp.expand(D), u, v).total_degree() == 3


def test_quadrature_is_exact_on_quadratics():
    node = patch.quadrature_node()
    nodes = [(1 - 2 * node, node), (node, 1 - 2 * node), (node, node)]
    for i, j in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        integral = sp.integrate(u**i * v**j, (u, 0, 1 - v), (v, 0, 1))
        assert sum(r**i * s**j for r, s in nodes) / 6 == integral


def test_a_writing_that_is_not_what_was_derived_is_refused():
    refused("is not", patch._written, scalar("u") ** 2, patch.GRADIENT[0], error=ArithmeticError)


# --- what a triangle may be made of ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("row", "exact"),
    [(["0.1", 0.1, np.float32(0.1)], ["1/10", Fraction(0.1), Fraction(float(np.float32(0.1)))]),
     ([sp.Rational(1, 3), Fraction(1, 3), "1/3"], ["1/3"] * 3),
     ([np.int64(7), 7, "7"], [7] * 3)],
    ids=["decimals", "thirds", "integers"],
)  # fmt: skip
def test_numbers_are_exact(row, exact):
    """Floats are taken at their binary value, and texts at their decimal one."""
    values: Any = triangle_of([row] * 6).control_points[0]
    assert list(values) == [sp.Rational(str(x)) for x in exact]


def test_symbols():
    s = sp.Symbol("s", positive=True)
    scaled = triangle_of([[s * sp.Rational(a) for a in point] for point in POINTS_12])
    plain = triangle_of(POINTS_12)
    assert sp.cancel(scaled.support_function - s * plain.support_function) == 0
    mixed = triangle_of([[0.5 * s, 0, 0], *POINTS_12[1:]])
    assert mixed.control_points[0][0] == s / 2


def test_symbols_that_the_formulas_use_themselves_do_not_get_mixed_up():
    """A control point may be called a_x, or even D: substitution happens all at once."""
    named = triangle_of([[scalar("a_x"), scalar("D"), scalar("d_y")], *POINTS_12[1:]])
    other = triangle_of([[scalar("q1"), scalar("q2"), scalar("q3")], *POINTS_12[1:]])
    renaming = {scalar("q1"): scalar("a_x"), scalar("q2"): scalar("D"), scalar("q3"): scalar("d_y")}
    assert sp.expand(named.forms["U"] - other.forms["U"].xreplace(renaming)) == 0


@pytest.mark.parametrize(
    "points",
    [5, [], POINTS_12[:5], [*POINTS_12, [0, 0, 0]], [[0, 0]] * 6, [[0, 0, 0, 0]] * 6, ["abc"] * 6,
     [0, 1, 2, 3, 4, 5], [[0, 0, float("nan")], *POINTS_12[1:]],
     [[0, 0, float("inf")], *POINTS_12[1:]], [[0, 0, 1j], *POINTS_12[1:]],
     [[0, 0, sp.I], *POINTS_12[1:]], [[0, 0, "1/0"], *POINTS_12[1:]],
     [[0, 0, "2 +"], *POINTS_12[1:]], [[0, 0, None], *POINTS_12[1:]],
     [[0, 0, True], *POINTS_12[1:]], [[0, 0, [1]], *POINTS_12[1:]],
     [[0, 0, sp.Matrix([1])], *POINTS_12[1:]], [[0, 0, scalar("n_x")], *POINTS_12[1:]],
     [[0, 0, scalar("u")], *POINTS_12[1:]]],
)  # fmt: skip
def test_bad_input_is_refused(points):
    refused(r"control_points|coordinate|[Ss]ympify", triangle_of, points, error=ValueError)


def test_a_developable_patch_has_no_support_function():
    cylinder = triangle_of(CYLINDER)
    assert cylinder.forms["D"] == 0
    assert set(cylinder.evaluate(patch.PARABOLIC_CUBIC).values()) == {0}
    for name in ("parameters", "support_function", "gradient", "hessian", "gaussian_curvature"):
        refused("developable", getattr, cylinder, name, error=ValueError)


def test_a_folded_plane_has_no_curvature():
    folded = triangle_of(FOLDED_PLANE)
    assert folded.forms["D"] != 0
    assert folded.orientation == 0
    with pytest.raises(ValueError, match="no regular point"):
        _ = folded.gaussian_curvature


@pytest.mark.parametrize(
    "normal", [5, None, "xyz", (1, 2, 3), sp.symbols("x x y"), sp.symbols("x y"), [[1], [2], [3]]]
)
def test_a_normal_that_is_not_three_symbols_is_refused(normal: Any) -> None:
    with pytest.raises(ValueError, match="normal must be three different SymPy symbols"):
        BezierTriangle(POINTS_12, normal)


@pytest.mark.parametrize(
    ("value", "words"),
    [("q+", r"^'q\+' is not a coordinate$"), ("x" * 15_000 + "+", "coordinate"),
     (sp.Symbol("x" * 900) * sp.I * sp.oo, "coordinate")],
)  # fmt: skip
def test_what_is_said_of_a_coordinate_is_one_short_sentence(value: Any, words: str) -> None:
    assert len(refused(words, BezierTriangle, [[value] * 3] * 6, error=ValueError)) <= 100


# --- boundary cones of edges ----------------------------------------------------------------------


def test_the_form_of_an_edge_is_that_of_its_patch() -> None:
    ends = {}
    for at in (0, 1):
        tangents = evaluated(TANGENTS, {scalar("u"): sp.S(at), scalar("v"): sp.S.Zero})
        for name, field in (("T", "p_u"), ("X", "p_v")):
            ends |= components(**{f"{name}{at}": [tangents[f"{field}_{axis}"] for axis in "xyz"]})
    found = evaluated(EDGE_VECTORS, ends)
    for vector in vectors("abde"):
        assert all(sp.expand(found[x.name] - x) == 0 for x in vector.components)
    assert not {*vectors("c")[0].components} & FORMS.expanded()["V"].free_symbols


def test_the_tangential_part_is_perpendicular() -> None:
    x, n, y = vectors("xny")
    found = TANGENTIAL.expanded()
    values = {symbol: found[symbol.name] for symbol in y.components}
    assert sp.expand(substitute(Dot(y, n).in_components(), values)) == 0
    square = Dot(n, n).in_components()
    for k, axis in enumerate("xyz"):
        rest = found[f"y_{axis}"] - square * x.components[k]
        assert sp.expand(rest / n.components[k] + Dot(x, n).in_components()) == 0
