"""Boundary cones, arcs and parabolic lines, exactly, on random integer patches of every rank."""

import random
from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic import BezierTriangle, gaussian_image, patch
from gaussmap.symbolic.notation import dot, scalar

u, v, s, t = (scalar(x) for x in "uvst")
n: Any = sp.Matrix(patch.n.components)
NAMES = "abcde"


def random_vector(generator: random.Random) -> Any:
    return sp.Matrix([generator.randint(-9, 9) for _ in range(3)])


def values_of(vectors) -> dict[Any, Any]:
    """Return the components of a, b, c, d, e as substitutions."""
    return {
        component: value
        for symbol, vector in zip(patch.VECTORS, vectors, strict=True)
        for component, value in zip(symbol.components, vector, strict=True)
    }


def evaluated(formula, vectors, **more) -> list[Any]:
    values = values_of(vectors) | {scalar(name): x for name, x in more.items()}
    return [sp.expand(x.xreplace(values)) for x in formula.expanded().values()]


def cubic_of(vectors) -> Any:
    """Return L N − M² by its definition, with N = p_u × p_v."""
    a, b, c, d, e = vectors
    normal = (a * u + b * v + d).cross(b * u + c * v + e)
    return sp.expand(dot(normal, a) * dot(normal, c) - dot(normal, b) ** 2)


def binary_cubic(vectors) -> Any:
    k30, k21, k12, k03 = evaluated(gaussian_image.PARABOLIC_DIRECTIONS, vectors)
    return k30 * s**3 + k21 * s**2 * t + k12 * s * t**2 + k03 * t**3


def lines_at(vectors, direction) -> list[tuple[Any, Any, Any]]:
    """Return the lines of a direction by each of the three normals that do not vanish."""
    ends: dict[str, Any] = dict(zip("st", direction, strict=True))
    normals = evaluated(gaussian_image.PARABOLIC_NORMAL, vectors, **ends)
    names = ("n_x", "n_y", "n_z")
    triples = [normals[3 * k : 3 * k + 3] for k in range(3)]
    rows = [dict(zip(names, x, strict=True)) for x in triples if any(x)]
    found = [evaluated(gaussian_image.PARABOLIC_LINE, vectors, **row, **ends) for row in rows]
    return [(x[0], x[1], x[2]) for x in found]


@pytest.fixture(params=[0, 1, *(pytest.param(x, marks=pytest.mark.slow) for x in (2, 3))])
def generator(request) -> random.Random:
    return random.Random(request.param)


# --- the binary cubic -----------------------------------------------------------------------------


def test_binary_cubic_is_the_determinant(generator):
    a, b, c, d, e = vectors = [random_vector(generator) for _ in NAMES]
    rows = sp.Matrix.hstack(t * a - s * b, t * b - s * c, t * d - s * e)
    assert sp.expand(rows.det() - binary_cubic(vectors)) == 0


def test_the_cubic_vanishes_on_the_line_of_every_root(generator):
    """For a symbolic direction (s, 1): what is left on the line is a multiple of the cubic in s."""
    vectors = [random_vector(generator) for _ in NAMES]
    normal = evaluated(gaussian_image.PARABOLIC_NORMAL, vectors, s=s, t=1)[:3]
    more = dict(zip(("n_x", "n_y", "n_z"), normal, strict=True))
    l_u, l_v, l_1 = evaluated(gaussian_image.PARABOLIC_LINE, vectors, **more, s=s, t=1)
    on_line = sp.numer(sp.together(cubic_of(vectors).subs(v, -(l_u * u + l_1) / l_v)))
    in_s = binary_cubic(vectors).subs(t, 1)
    for coefficient in sp.Poly(on_line, u).all_coeffs():
        assert sp.rem(sp.Poly(coefficient, s), sp.Poly(in_s, s)).is_zero


def test_the_line_has_one_normal(generator):
    """N(u,v) is parallel to n on the line, modulo the binary cubic."""
    a, b, c, d, e = vectors = [random_vector(generator) for _ in NAMES]
    normal: Any = sp.Matrix(evaluated(gaussian_image.PARABOLIC_NORMAL, vectors, s=s, t=1)[:3])
    more: dict[str, Any] = dict(zip(("n_x", "n_y", "n_z"), normal, strict=True))
    l_u, l_v, l_1 = evaluated(gaussian_image.PARABOLIC_LINE, vectors, **more, s=s, t=1)
    in_s = sp.Poly(binary_cubic(vectors).subs(t, 1), s)
    place = {v: -(l_u * u + l_1) / l_v}
    N = (a * u + b * v + d).cross(b * u + c * v + e).subs(place)
    for component in N.cross(normal):
        numerator = sp.Poly(sp.numer(sp.together(component)), u)
        assert all(sp.rem(sp.Poly(x, s), in_s).is_zero for x in numerator.all_coeffs())


def rational_patch(generator: random.Random, lines: list[Any]) -> list[Any]:
    """Return vectors whose binary cubic has the given rational directions.

    With a, b, c the unit vectors, n = (s², st, t²): t n·d − s n·e is any cubic by choice of d, e.
    """
    wanted = sp.Poly(sp.prod(q * s - p * t for p, q in lines), s, t)
    k30, k21, k12, k03 = (wanted.coeff_monomial(s**k * t ** (3 - k)) for k in (3, 2, 1, 0))
    x, y = generator.randint(-5, 5), generator.randint(-5, 5)
    d = sp.Matrix([x, y, k03])
    e = sp.Matrix([-k30, x - k21, y - k12])
    shear = sp.Matrix(3, 3, lambda i, j: generator.randint(-4, 4))
    while shear.det() == 0:
        shear = sp.Matrix(3, 3, lambda i, j: generator.randint(-4, 4))
    return [shear * vector for vector in (*(sp.eye(3).col(k) for k in range(3)), d, e)]


def test_three_rational_lines_are_the_factors_of_the_cubic(generator):
    directions = [(1, 2), (-3, 1), (1, 0)]
    vectors = rational_patch(generator, directions)
    product = sp.S.One
    for direction in directions:
        assert binary_cubic(vectors).subs(dict(zip((s, t), direction, strict=True))) == 0
        lines = lines_at(vectors, direction)
        assert lines
        for line in lines:  # every normal that does not vanish gives the same line
            assert sp.Matrix(line).cross(sp.Matrix(lines[0])) == sp.zeros(3, 1)
        l_u, l_v, l_1 = lines[0]
        assert l_u * direction[1] == l_v * direction[0]
        product *= l_u * u + l_v * v + l_1
    quotient: Any
    quotient, rest = sp.div(sp.Poly(cubic_of(vectors), u, v), sp.Poly(product, u, v))
    assert rest.is_zero
    assert quotient.total_degree() == 0


# --- the boundary ---------------------------------------------------------------------------------


def test_boundary_cones_are_those_of_the_forms(generator):
    points = [[generator.randint(-9, 9) for _ in range(3)] for _ in range(6)]
    triangle: Any = BezierTriangle(points)
    entries = list(triangle.evaluate(gaussian_image.BOUNDARY_CONES).values())
    for k, cone in enumerate(triangle.boundary_cones):
        assert list(cone.flat()) == entries[9 * k : 9 * k + 9]


def test_arcs_lie_on_the_cones(generator):
    points = [[generator.randint(-9, 9) for _ in range(3)] for _ in range(6)]
    triangle: Any = BezierTriangle(points)
    normals = triangle.evaluate(patch.CONTROL_NORMALS)
    edges = (("020", "011", "002"), ("002", "101", "200"), ("200", "110", "020"))
    for cone, edge in zip(triangle.boundary_cones, edges, strict=True):
        values = {
            scalar(f"N{k}_{axis}"): normals[f"N{index}_{axis}"]
            for k, index in enumerate(edge)
            for axis in "xyz"
        }
        arc = [x.xreplace(values) for x in gaussian_image.ARC.expanded().values()]
        point: Any = sp.Matrix(arc[:3])
        along: Any = sp.Matrix(arc[3:])
        assert sp.expand((point.T * cone * point)[0]) == 0
        assert (point.diff(t) - along).applyfunc(sp.expand) == sp.zeros(3, 1)


@pytest.mark.slow
def test_solid_angle_form_has_the_element_of_area_as_derivative():
    """In any chart n(x, y): ∂ω_y/∂x − ∂ω_x/∂y = det(n, n_x, n_y)/|n|³."""
    x, y = sp.symbols("x y", real=True)
    names = [f"{vector}_{axis}" for vector in ("q", "n", "n_t") for axis in "xyz"]
    (form,) = gaussian_image.SOLID_ANGLE.expanded().values()
    pole = sp.Matrix([sp.Rational(2, 7), sp.Rational(3, 7), sp.Rational(6, 7)])
    chart: Any = sp.Matrix([1 + x - y * y, 2 - 3 * x * y, 1 + 2 * y + x * x])

    def along(by: Any) -> Any:
        values = [*pole, *chart, *chart.diff(by)]
        return form.xreplace(dict(zip(map(scalar, names), values, strict=True)))

    density = sp.Matrix.hstack(chart, chart.diff(x), chart.diff(y)).det() / dot(chart, chart) ** (
        sp.Rational(3, 2)
    )
    difference = sp.diff(along(y), x) - sp.diff(along(x), y) - density
    for place in ({x: 0, y: 0}, {x: sp.Rational(1, 3), y: sp.Rational(-1, 5)}):
        assert sp.simplify(difference.subs(place)) == 0


def test_solid_angle_of_an_octant():
    names = [f"{vector}_{axis}" for vector in ("q", "n", "n_t") for axis in "xyz"]
    (form,) = gaussian_image.SOLID_ANGLE.expanded().values()
    axes = [sp.eye(3).col(k) for k in range(3)]
    total = sp.S.Zero
    for start, end in ((0, 1), (1, 2), (2, 0)):
        point = (1 - t) * axes[start] + t * axes[end]
        values = dict(zip(map(scalar, names), [0, 0, 1, *point, *point.diff(t)], strict=True))
        total += sp.integrate(sp.simplify(form.xreplace(values)), (t, 0, 1))
    assert sp.simplify(total - sp.pi / 2) == 0


def test_curvature_of_derivatives_is_that_of_the_fundamental_forms(generator):
    p_u, p_v, *second = (random_vector(generator) for _ in range(5))
    values = dict(
        zip(
            (x for v in ("p_u", "p_v", *"abc") for x in (scalar(f"{v}_{k}") for k in "xyz")),
            (x for vector in (p_u, p_v, *second) for x in vector),
            strict=True,
        )
    )
    found = gaussian_image.CURVATURE_OF_DERIVATIVES.expanded().values()
    K, *normal_parts = (x.xreplace(values) for x in found)
    normal = p_u.cross(p_v)
    L, M, N = (dot(normal, x) for x in second)
    area = dot(p_u, p_u) * dot(p_v, p_v) - dot(p_u, p_v) ** 2
    assert [K, *normal_parts] == [(L * N - M**2) / area**2, L, M, N]
