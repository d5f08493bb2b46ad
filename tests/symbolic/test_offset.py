"""The linear field of normals of a patch and its rational offset (Sect. 3), exactly."""

import random

import pytest
import sympy as sp
from gaussmap.symbolic import BezierTriangle

from ..refusals import refused

s, t = sp.symbols("s t", real=True)
PLACES = [{s: sp.Rational(1, 3), t: sp.Rational(-2, 5)}, {s: sp.Integer(2), t: sp.Rational(7, 4)}]
CYLINDER = [[1, 0, 1], [0, 1, 0], [0, 0, 0], ["1/2", "1/2", 0], ["1/2", 0, 0], [0, "1/2", 0]]


@pytest.fixture(params=[1, pytest.param(2, marks=pytest.mark.slow)], scope="module")
def triangle(request):
    generator = random.Random(request.param)
    return BezierTriangle([[generator.randint(-9, 9) for _ in range(3)] for _ in range(6)])


@pytest.mark.parametrize("field", [None, ((1, 2, 0), (0, 1, -1), ("1/2", 0, 3))])
@pytest.mark.parametrize("place", PLACES)
def test_a_linear_field_is_normal_to_its_points(triangle, field, place):
    x, n = triangle.linear_normals() if field is None else triangle.linear_normals(field)
    assert all(sp.Poly(component, s, t).total_degree() <= 1 for component in n)
    for by in (s, t):
        tangent = x.diff(by).subs(place)
        assert any(tangent)
        assert tangent.dot(n.subs(place)) == 0


def test_the_points_lie_on_the_patch(triangle):
    x, n = triangle.linear_normals()
    place = PLACES[0]
    values = dict(zip(triangle.normal, n.subs(place), strict=True))
    assert [component.subs(values) for component in triangle.gradient] == list(x.subs(place))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(
    "distance", [pytest.param("1/3", marks=pytest.mark.slow), -2, sp.Symbol("R", positive=True)]
)
@pytest.mark.quick_for("place0")
def test_the_offset_is_rational_and_at_the_distance(triangle, distance, place):
    offset, patch = triangle.rational_offset(distance), triangle.rational_offset(0)
    assert all(component.is_rational_function(s, t) for component in offset)
    moved = (offset - patch).subs(place).applyfunc(sp.simplify)
    assert sp.simplify(moved.dot(moved) - sp.sympify(distance) ** 2) == 0
    for by in (s, t):
        assert sp.simplify(offset.diff(by).subs(place).dot(moved)) == 0


def test_a_basis_turns_the_field(triangle):
    swapped = ((0, 0, 1), (1, 0, 0), (0, 1, 0))
    place = {s: sp.S.Zero, t: sp.S.Zero}
    moved = (triangle.rational_offset(1, swapped) - triangle.rational_offset(0, swapped)).subs(
        place
    )
    assert list(moved) == [0, 1, 0]


def test_developable_patches_have_neither():
    developable = BezierTriangle(CYLINDER)
    refused("developable", developable.linear_normals, error=ValueError)
    refused("developable", developable.rational_offset, 1, error=ValueError)
