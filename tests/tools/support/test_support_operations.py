"""Each operation on support functions against the same operation done on the surface."""

import dataclasses
from collections.abc import Callable
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic.expression import NORMAL
from gaussmap.tools.support import operations
from gaussmap.tools.support.branches import Branches

from ...shapes import EPS, Array

NORMALS = gm.fibonacci(1500)
of_spline = gm.SupportFunction.of_spline
given = gm.SupportFunction.from_sympy
MIXED = [[1, 0, 2], [2, 0, 1], [2, 1, 0], [3, 3, -3], [0, 2, -3], [-1, 0, -1]]
ELLIPSOIDS = "sqrt(n_x**2 + 4*n_y**2 + 9*n_z**2)", "sqrt(2*n_x**2 + n_y**2 + n_x*n_z + n_z**2)"


@pytest.fixture(scope="module")
def torus() -> gm.Spline:
    """A torus whose coefficients are multiples of 2⁻³⁰, so that such sums are exact."""
    spline = gm.fit(gm.surfaces.torus(major=1.0, minor=0.35), (32, 24))
    rounded = np.ldexp(np.rint(np.ldexp(spline.coefficients, 30)), -30)
    return dataclasses.replace(spline, coefficients=rounded)


def changed(spline: gm.Spline, f: Callable[[Array], Array]) -> gm.Spline:
    return dataclasses.replace(spline, coefficients=f(spline.coefficients))


def rotation(axis: list[float], angle: float) -> Array:
    """Return a rotation matrix, by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def by_kind(branches: Branches) -> Branches:
    """Sort by normal and sign of curvature: on a torus that is one branch each."""
    order = np.lexsort([branches.hyperbolic, branches.normal_index])
    return Branches(*(getattr(branches, x.name)[order] for x in dataclasses.fields(branches)))


def check_same(actual: Branches, expected: Branches, size: float) -> None:
    """Compare branches of two splines that differ by the rounding of their coefficients.

    A coefficient that is off by ε·size turns a normal by a few ε·size beside a cell of 2π·0.35/24,
    and a turned normal moves the point by the Hessian; hence 64 ε (1 + |Hess|/cell)² for all.
    """
    actual, expected = by_kind(actual), by_kind(expected)
    assert (actual.normal_index == expected.normal_index).all()
    assert (actual.elliptic == expected.elliptic).all()
    cell = 2 * np.pi * 0.35 / 24
    error = 64 * EPS * size * (1 + np.abs(expected.hessian).max(axis=(1, 2)) / cell) ** 2
    assert np.median(error) < 1e-10
    assert (np.abs(actual.points - expected.points).max(axis=1) <= error).all()
    assert (np.abs(actual.support - expected.support) <= error).all()
    relative = error * np.abs(expected.principal_radii).max(axis=1) / cell
    assert (np.abs(actual.principal_radii - expected.principal_radii).max(axis=1) <= relative).all()
    assert (np.abs(actual.hessian - expected.hessian).max(axis=(1, 2)) <= relative).all()


# --- translation, scaling, rotation, reversal of a spline -----------------------------------------


@pytest.mark.parametrize("shift", [[2.0, -3.0, 0.5], [0.0, 0.0, 4096.0]])
def test_translation(torus: gm.Spline, shift: list[float]) -> None:
    """Differences of coefficients stay the same, exactly: so does all but the points."""
    moved = of_spline(changed(torus, lambda mu: mu + shift)).branches(NORMALS)
    translated = of_spline(torus).translated(shift).branches(NORMALS)
    for name in ("normal_index", "patch_index", "uv", "hessian", "gaussian_curvature"):
        assert (getattr(moved, name) == getattr(translated, name)).all()
    largest = np.abs(shift).max() + 2.0
    assert np.abs(moved.points - translated.points).max() <= 2 * EPS * largest
    assert np.abs(moved.support - translated.support).max() <= 8 * EPS * largest
    base = of_spline(torus).branches(NORMALS)
    assert (
        np.abs(translated.support - base.support - base.normals @ shift).max() <= 8 * EPS * largest
    )


@pytest.mark.parametrize("factor", [4.0, -0.5, 2.0**-40, -(2.0**60)])
def test_scaling_by_powers_of_two(torus: gm.Spline, factor: float) -> None:
    """Also for s < 0: p_u × p_v keeps its direction, and radii change their sign."""
    moved = of_spline(changed(torus, lambda mu: factor * mu)).branches(NORMALS)
    scaled = of_spline(torus).scaled(factor).branches(NORMALS)
    names = ("normal_index", "patch_index", "uv", "points", "hessian", "support")
    for name in (*names, "principal_radii", "gaussian_curvature", "mean_curvature"):
        assert (getattr(moved, name) == getattr(scaled, name)).all(), name
    base = of_spline(torus).branches(NORMALS)
    assert (scaled.points == factor * base.points).all()
    assert (scaled.mean_curvature == base.mean_curvature / factor).all()


@pytest.mark.parametrize(
    ("axis", "angle"), [([0, 0, 1], np.pi / 2), ([1, 2, 3], 1.0), ([-1, 0.2, 0], 3.0)]
)
def test_rotation(torus: gm.Spline, axis: list[float], angle: float) -> None:
    R = rotation(axis, angle)
    moved = of_spline(changed(torus, lambda mu: mu @ R.T)).branches(NORMALS)
    check_same(moved, of_spline(torus).rotated(R).branches(NORMALS), 1.35)


def test_reversal(torus: gm.Spline) -> None:
    """Exchanging u and v turns every normal round."""
    swapped = gm.Spline(
        np.ascontiguousarray(torus.coefficients.transpose(1, 0, 2)),
        (torus.domain[1], torus.domain[0]),
        (torus.boundary[1], torus.boundary[0]),
        "swapped",
    )
    reversed_ = of_spline(torus).reversed().branches(NORMALS)
    check_same(of_spline(swapped).branches(NORMALS), reversed_, 1.35)
    opposite = of_spline(torus).branches(-NORMALS)
    assert (reversed_.points == opposite.points).all()
    assert (reversed_.support == -opposite.support).all()
    assert (reversed_.normals == -opposite.normals).all()
    assert (reversed_.mean_curvature == -opposite.mean_curvature).all()
    assert (reversed_.gaussian_curvature == opposite.gaussian_curvature).all()
    twice = of_spline(torus).reversed().reversed().branches(NORMALS)
    assert (twice.hessian == of_spline(torus).branches(NORMALS).hessian).all()


# --- offset ---------------------------------------------------------------------------------------


def test_offset_of_a_point_is_a_sphere() -> None:
    branches = given("n_x - 2*n_y").offset(-3.0).branches(NORMALS)
    assert np.abs(branches.points - [1.0, -2.0, 0.0] + 3 * NORMALS).max() <= 8 * EPS
    np.testing.assert_allclose(branches.gaussian_curvature, 1 / 9, rtol=32 * EPS)
    np.testing.assert_allclose(branches.mean_curvature, -1 / 3, rtol=32 * EPS)
    np.testing.assert_allclose(branches.principal_radii, -3.0, rtol=32 * EPS)


# --- sums -----------------------------------------------------------------------------------------


@pytest.mark.kernels
def test_convolution_of_ellipsoids() -> None:
    """The sum of objects, one expression for the sum, and the sum of points agree: eq. (7)."""
    first, second = map(given, ELLIPSOIDS)
    convolution = (first + second).branches(NORMALS)
    at_once = given(" + ".join(ELLIPSOIDS)).branches(NORMALS)
    assert (convolution.points == first.envelope(NORMALS) + second.envelope(NORMALS)).all()
    for name, size in (("points", 5.0), ("hessian", 20.0), ("support", 5.0)):
        difference = getattr(convolution, name) - getattr(at_once, name)
        assert np.abs(difference).max() <= 64 * EPS * size
    np.testing.assert_allclose(
        convolution.gaussian_curvature, at_once.gaussian_curvature, rtol=1024 * EPS
    )
    assert (convolution.patch_index == -1).all()
    assert np.isnan(convolution.uv).all()


@pytest.mark.parametrize(
    ("other", "changed", "rounding"),
    [("1/4", lambda h: h.offset(0.25), 64 * EPS),
     ("2*n_x - n_z", lambda h: h.translated([2.0, 0.0, -1.0]), 0.0)],
    ids=["sphere", "point"],
)  # fmt: skip
def test_convolution_with_a_sphere_is_the_offset_and_with_a_point_the_translation(
    other: str, changed: Any, rounding: float, torus: gm.Spline
) -> None:
    for support in (of_spline(torus), given(ELLIPSOIDS[0]), gm.SupportFunction.of_patch(MIXED)):
        expected = changed(support).branches(NORMALS)
        for convolution in (support + given(other), given(other) + support):
            branches = convolution.branches(NORMALS)
            assert (branches.normal_index == expected.normal_index).all()
            assert (branches.patch_index == expected.patch_index).all()
            assert np.array_equal(branches.uv, expected.uv, equal_nan=True)
            assert np.abs(branches.points - expected.points).max() <= rounding
            assert np.abs(branches.hessian - expected.hessian).max() <= rounding


@pytest.mark.kernels
def test_sums_have_the_common_domain() -> None:
    patch = gm.SupportFunction.of_patch(MIXED)
    upper = given("1 + n_x", domain="n_z > 0")
    both = (patch + upper).contains(NORMALS)
    assert (both == patch.contains(NORMALS) & (NORMALS[:, 2] > 0)).all()
    assert both.any()
    nothing = upper + given("1", domain="n_z < 0")
    assert len(nothing.branches(NORMALS)) == 0


# --- composition, and the expressions of it -------------------------------------------------------

R = rotation([1.0, -2.0, 0.5], 0.8)
COMPOSITIONS: dict[str, Callable[[gm.SupportFunction], gm.SupportFunction]] = {
    "offset": lambda h: h.offset(0.5),
    "translated": lambda h: h.translated([1.0, 2.0, -0.1]),
    "rotated": lambda h: h.rotated(R),
    "scaled": lambda h: h.scaled(-1.5),
    "reversed": lambda h: h.reversed(),
    "sum": lambda h: h + given("n_x*n_y"),
    "all": lambda h: (h.rotated(R).offset(0.5) + h.reversed()).scaled(2).translated([1, 0, 0]),
}


@pytest.mark.parametrize("operation", COMPOSITIONS.values(), ids=COMPOSITIONS)
@pytest.mark.parametrize("h", [ELLIPSOIDS[1], "n_x**3 + n_y*n_z + 2"])
@pytest.mark.quick_for("all")
def test_expression_of_a_composition(operation: Any, h: str) -> None:
    """What an operation says it is, given as one expression, is what it does."""
    composed = operation(given(h))
    branches = composed.branches(NORMALS)
    again = given(composed.expression).branches(NORMALS)
    assert np.abs(branches.support - again.support).max() <= 256 * EPS * 10
    assert np.abs(branches.points - again.points).max() <= 256 * EPS * 10
    assert np.abs(branches.hessian - again.hessian).max() <= 256 * EPS * 50
    assert composed.domain == sp.true


@pytest.mark.kernels
@pytest.mark.parametrize("operation", COMPOSITIONS.values(), ids=COMPOSITIONS)
def test_domain_of_a_composition(operation: Any) -> None:
    x, y, z = NORMAL
    composed = operation(given("2 + n_x", domain=sp.And(x > y / 2, z > -x)))
    condition = sp.lambdify(NORMAL, composed.domain)
    assert (composed.contains(NORMALS) == condition(*NORMALS.T)).all()


@pytest.mark.kernels
def test_operations_change_nothing_before() -> None:
    ellipsoid = given(ELLIPSOIDS[0])
    before = ellipsoid.branches(NORMALS)
    for operation in COMPOSITIONS.values():
        operation(ellipsoid).branches(NORMALS)
    after = ellipsoid.branches(NORMALS)
    assert (before.points == after.points).all()
    assert (before.hessian == after.hessian).all()
    assert "translated by (1.0, 0.0, 0.0)" in repr(COMPOSITIONS["all"](ellipsoid))


@pytest.mark.kernels
def test_an_offset_to_a_point_is_one() -> None:
    branches = given("1").offset(-1).branches(NORMALS)
    assert (branches.principal_radii == 0.0).all()
    assert np.isposinf(branches.gaussian_curvature).all()
    assert branches.elliptic.all()


@pytest.mark.kernels
@pytest.mark.parametrize(("distance", "share"), [(0.25, 0.0), (-1.0, 1.0)])
def test_an_offset_looks_at_radii_only_where_they_may_vanish(monkeypatch, distance, share) -> None:
    """Of a unit sphere: at the distance −1 all radii are 0, elsewhere none."""
    asked: list[int] = []
    computed = operations.curvatures

    def counted(normals: Array, hessian: Array) -> tuple[Array, Array, Array]:
        asked.append(len(normals))
        return computed(normals, hessian)

    monkeypatch.setattr(operations, "curvatures", counted)
    assert len(given("1").offset(distance).branches(NORMALS)) == len(NORMALS)
    assert sum(asked) == share * len(NORMALS)


@pytest.mark.kernels
def test_operations_say_their_names_and_domains() -> None:
    half = given("2", domain="n_z > 0")
    moved = half.offset(1).scaled(2).translated([1, 0, 0])
    assert repr(moved) == (
        "SupportFunction((((h = 2) offset by 1) scaled by 2) translated by (1.0, 0.0, 0.0))"
    )
    assert moved.domain == half.domain
    assert str(half.reversed().domain) in ("n_z < 0", "-n_z > 0")
    turned = half.rotated([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    assert repr(turned) == "SupportFunction((h = 2) rotated)"
    assert turned.contains([[0, -1, 0], [0, 1, 0]]).tolist() == [True, False]
    assert of_spline(gm.surfaces.torus()).offset(1).domain is None
