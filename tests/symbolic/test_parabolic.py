"""Boundary cones, arcs and parabolic lines, exactly, on random integer patches of every rank."""

import random
from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic import BezierTriangle, gaussian_image, patch
from gaussmap.symbolic.notation import dot, scalar

from .calls import components, evaluated

u, v, s, t = (scalar(x) for x in "uvst")
NAMES = "abcde"


def random_vector(generator: random.Random) -> Any:
    return sp.Matrix([generator.randint(-9, 9) for _ in range(3)])


def expanded(formula, vectors, **more) -> list[Any]:
    """Return the outputs of a formula for vectors a, b, c, d, e and numbers."""
    values = components(**dict(zip(NAMES, vectors, strict=True)))
    values |= {scalar(name): x for name, x in more.items()}
    return [sp.expand(x) for x in evaluated(formula, values).values()]


def cubic_of(vectors) -> Any:
    """Return L N − M² by its definition, with N = p_u × p_v."""
    a, b, c, d, e = vectors
    normal = (a * u + b * v + d).cross(b * u + c * v + e)
    return sp.expand(dot(normal, a) * dot(normal, c) - dot(normal, b) ** 2)


def binary_cubic(vectors) -> Any:
    k30, k21, k12, k03 = expanded(gaussian_image.PARABOLIC_DIRECTIONS, vectors)
    return k30 * s**3 + k21 * s**2 * t + k12 * s * t**2 + k03 * t**3


@pytest.fixture(params=[0, 1, *(pytest.param(x, marks=pytest.mark.slow) for x in (2, 3))])
def generator(request) -> random.Random:
    return random.Random(request.param)


# --- the binary cubic -----------------------------------------------------------------------------


def test_binary_cubic_is_the_determinant(generator):
    a, b, c, d, e = vectors = [random_vector(generator) for _ in NAMES]
    rows = sp.Matrix.hstack(t * a - s * b, t * b - s * c, t * d - s * e)
    assert sp.expand(rows.det() - binary_cubic(vectors)) == 0


def test_the_line_of_every_root_has_one_normal_and_there_the_cubic_vanishes(generator):
    """For a symbolic direction (s, 1), by each of the three normals that the formula offers.

    What has to vanish on the line is a multiple of the binary cubic.
    """
    a, b, c, d, e = vectors = [random_vector(generator) for _ in NAMES]
    normals = expanded(gaussian_image.PARABOLIC_NORMAL, vectors, s=s, t=1)
    in_s = sp.Poly(binary_cubic(vectors).subs(t, 1), s)
    N = (a * u + b * v + d).cross(b * u + c * v + e)
    for k in range(3):
        normal: Any = sp.Matrix(normals[3 * k : 3 * k + 3])
        more: dict[str, Any] = dict(zip(("n_x", "n_y", "n_z"), normal, strict=True))
        l_u, l_v, l_1 = expanded(gaussian_image.PARABOLIC_LINE, vectors, **more, s=s, t=1)
        assert sp.rem(sp.Poly(l_u - s * l_v, s), in_s).is_zero
        for expression in (cubic_of(vectors), *N.cross(normal)):
            on_line = sp.numer(sp.together(expression.subs(v, -(l_u * u + l_1) / l_v)))
            assert all(
                sp.rem(sp.Poly(x, s), in_s).is_zero for x in sp.Poly(on_line, u).all_coeffs()
            )


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
        points = {f"N{k}": [normals[f"N{x}_{axis}"] for axis in "xyz"] for k, x in enumerate(edge)}
        arc = [*evaluated(gaussian_image.ARC, components(**points)).values()]
        point: Any = sp.Matrix(arc[:3])
        along: Any = sp.Matrix(arc[3:])
        assert sp.expand((point.T * cone * point)[0]) == 0
        assert (point.diff(t) - along).applyfunc(sp.expand) == sp.zeros(3, 1)


@pytest.mark.slow
def test_solid_angle_form_has_the_element_of_area_as_derivative():
    """In any chart n(x, y): ∂ω_y/∂x − ∂ω_x/∂y = det(n, n_x, n_y)/|n|³."""
    x, y = sp.symbols("x y", real=True)
    pole = sp.Matrix([sp.Rational(2, 7), sp.Rational(3, 7), sp.Rational(6, 7)])
    chart: Any = sp.Matrix([1 + x - y * y, 2 - 3 * x * y, 1 + 2 * y + x * x])

    def along(by: Any) -> Any:
        values = components(q=pole, n=chart, n_t=chart.diff(by))
        return evaluated(gaussian_image.SOLID_ANGLE, values)["S_t"]

    density = sp.Matrix.hstack(chart, chart.diff(x), chart.diff(y)).det() / dot(chart, chart) ** (
        sp.Rational(3, 2)
    )
    difference = sp.diff(along(y), x) - sp.diff(along(x), y) - density
    for place in ({x: 0, y: 0}, {x: sp.Rational(1, 3), y: sp.Rational(-1, 5)}):
        assert sp.simplify(difference.subs(place)) == 0


def test_solid_angle_of_an_octant():
    axes = [sp.eye(3).col(k) for k in range(3)]
    total = sp.S.Zero
    for start, end in ((0, 1), (1, 2), (2, 0)):
        point = (1 - t) * axes[start] + t * axes[end]
        values = components(q=(0, 0, 1), n=point, n_t=point.diff(t))
        form = evaluated(gaussian_image.SOLID_ANGLE, values)["S_t"]
        total += sp.integrate(sp.simplify(form), (t, 0, 1))
    assert sp.simplify(total - sp.pi / 2) == 0


def test_curvature_of_derivatives_is_that_of_the_fundamental_forms(generator):
    p_u, p_v, *second = (random_vector(generator) for _ in range(5))
    values = components(p_u=p_u, p_v=p_v, **dict(zip("abc", second, strict=True)))
    K, *normal_parts = evaluated(gaussian_image.CURVATURE_OF_DERIVATIVES, values).values()
    normal = p_u.cross(p_v)
    L, M, N = (dot(normal, x) for x in second)
    area = dot(p_u, p_u) * dot(p_v, p_v) - dot(p_u, p_v) ** 2
    assert [K, *normal_parts] == [(L * N - M**2) / area**2, L, M, N]
