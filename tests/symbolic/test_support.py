"""Eqs. (4)-(7) for any function on the sphere, exactly, against plain differentiation."""

from typing import Any

import pytest
import sympy as sp
from gaussmap.symbolic import formulas
from gaussmap.symbolic.envelope import ENTRIES
from gaussmap.symbolic.expression import (
    LONGEST_PROOF,
    NORMAL,
    array_function,
    branch,
    is_homogeneous,
)
from gaussmap.symbolic.notation import scalar

from .calls import evaluated

x, y, z = NORMAL
LENGTH = sp.sqrt(x**2 + y**2 + z**2)
UNIT_NORMALS = [(2, 1, 2, 3), (-6, 2, 3, 7), (1, -4, 8, 9), (0, 0, 1, 1), (3, 0, -4, 5)]
FUNCTIONS = {
    "constant": sp.Integer(3),
    "linear": 3 * x - 4 * y + z / 2,
    "ellipsoid": sp.sqrt(4 * x**2 + 2 * x * y + 3 * y**2 + y * z + 2 * z**2),
    "odd": x**3,
    "odd quintic": x**5 - 2 * x * y * z + z**3,
    "even": x * y + z**4,
    "rational": (x**3 + y**3) / (x**2 + 2 * y**2 + 3 * z**2),
    "not homogeneous": sp.sqrt(1 + x**2 + 2 * y * z),
}
EACH_FUNCTION = pytest.mark.parametrize("h", FUNCTIONS.values(), ids=FUNCTIONS)


def places() -> list[dict[sp.Symbol, sp.Expr]]:
    return [
        {s: sp.Rational(k, length) for s, k in zip(NORMAL, normal, strict=True)}
        for *normal, length in UNIT_NORMALS
    ]


def at(place: dict[sp.Symbol, sp.Expr], value: Any) -> Any:
    return sp.radsimp(value.xreplace(place))


@EACH_FUNCTION
@pytest.mark.quick_for("constant", "odd")
def test_branch_is_what_differentiation_of_the_extension_gives(h):
    extension = LENGTH * h.subs({s: s / LENGTH for s in NORMAL}, simultaneous=True)
    derived = branch(h).expanded()
    for place in places():
        for axis, s in zip("xyz", NORMAL, strict=True):
            assert at(place, derived[f"x_{axis}"] - sp.diff(extension, s)) == 0
        for key, (i, j) in ENTRIES.items():
            second = sp.diff(extension, NORMAL[i], NORMAL[j])
            assert at(place, derived[f"H_{key}"] - second) == 0


def test_curvature_from_hessian_against_eigenvalues():
    """A Hessian with the eigenvalues 5 and −3 in the plane orthogonal to n = (2, 1, 2)/3."""
    n, s, t = (sp.Matrix(v) / 3 for v in ((2, 1, 2), (1, 2, -2), (2, -2, -1)))
    hessian = 5 * s * s.T - 3 * t * t.T
    values: dict[Any, Any] = dict(zip(NORMAL, n, strict=True))
    values |= {scalar(f"H_{key}"): hessian[place] for key, place in ENTRIES.items()}
    assert evaluated(formulas["curvature_from_hessian"], values) == {
        "m": 1,
        "q": -15,
        "S": 16,
        "K": sp.Rational(-1, 15),
        "H": sp.Rational(1, 2) * (sp.Rational(1, 5) - sp.Rational(1, 3)),
    }


def test_offset_is_the_sphere_and_adds_to_the_radii():
    R, place = scalar("R"), places()[1] | {scalar("R"): sp.Integer(4)}
    sphere, offset = (evaluated(x, place) for x in (branch(4 * LENGTH), formulas["offset"]))
    assert offset.items() <= sphere.items()
    numbers = {scalar("K"): sp.Rational(1, 6), scalar("H"): sp.Rational(5, 12), R: sp.Integer(4)}
    moved = evaluated(formulas["offset_curvature"], numbers)  # radii 2 and 3 become 6 and 7
    assert moved["K_offset"] == sp.Rational(1, 42)
    assert moved["H_offset"] == (sp.Rational(1, 6) + sp.Rational(1, 7)) / 2
    growth = evaluated(formulas["offset_growth"], numbers)
    assert growth["s"] == sp.Rational(6 * 7, 2 * 3)
    assert growth["m"] == (sp.Rational(6, 2) + sp.Rational(7, 3)) / 2


# --- homogeneity, and the kernels of expressions --------------------------------------------------


@pytest.mark.parametrize(
    ("h", "answer"),
    [
        (3 * x + 4 * z, True), (sp.Integer(0), True), (LENGTH, True),
        (FUNCTIONS["ellipsoid"] + 2 * LENGTH, True), (FUNCTIONS["rational"], True),
        (sp.Abs(x) + sp.Abs(y - z), True), ((x**4 + y**4 + z**4) ** sp.Rational(1, 4), True),
        (sp.Integer(1), False), (x**3, False), (x * y, False),
        (FUNCTIONS["not homogeneous"], False), (LENGTH + sp.Rational(1, 10**9) * x**2, False),
        (LENGTH + sp.Rational(1, 10**25) * x**2, False),
    ],
)  # fmt: skip
def test_homogeneous_of_degree_1(h, answer):
    assert is_homogeneous(h) is answer


@pytest.mark.slow
def test_long_expressions_are_not_expanded():
    h = sum((sp.sqrt(k * x**2 + y**2 + z**2 + k * x * z) for k in range(1, 60)), start=sp.S.Zero)
    assert 3 * h.count_ops() > LONGEST_PROOF  # those of three derivatives
    assert not is_homogeneous(h)


def test_gradient_of_a_homogeneous_function_is_taken_as_it_is():
    assert "dh_S" not in array_function(FUNCTIONS["ellipsoid"])
    assert "dh_S_x" in array_function(x**3)


def test_functions_hold_the_domain_and_no_powers():
    source = array_function(x**3 + y**2, sp.And(z > 0, x < 1))
    condition = source.partition("return numpy.logical_and.reduce(")[2].partition("), x_x")[0]
    assert set(condition.strip("()").split("),")) == {"numpy.less(n_x, 1", "numpy.greater(n_z, 0"}
    assert "**" not in source
