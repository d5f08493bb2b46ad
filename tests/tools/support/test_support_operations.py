"""Each operation on support functions against the same operation done on the surface."""

import dataclasses
import pickle
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.symbolic.expression import NORMAL
from gaussmap.tools.support import operations
from gaussmap.tools.support.branches import Branches

from ...refusals import refused
from ...shapes import EPS, Array, torus_samples

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


# --- offsets of samples ---------------------------------------------------------------------------

MAJOR, MINOR, REPORT = 2.0, 0.5, SamplingReport("torus", 500, 500, 125, 0.0, 0)
FIELDS = ("points", "support", "gaussian_curvature", "mean_curvature")


def exact_torus(minor: float = MINOR, scale: float = 1.0) -> gm.Samples:
    return torus_samples(500, minor, scale, report=REPORT)


def curved(K: object, H: object, **changes: Any) -> gm.Samples:
    K = np.array(K, dtype=float, ndmin=1)
    H = np.array(H, dtype=float, ndmin=1)
    report = SamplingReport("s", None, len(K), None, None, None)
    return gm.Samples(
        **({"gaussian_curvature": K, "mean_curvature": H, "report": report} | changes)
    )


# --- exact cases ----------------------------------------------------------------------------------


@pytest.mark.kernels
@pytest.mark.parametrize("scale", [1.0, 1e-12, 1e12])
@pytest.mark.parametrize("ratio", [0.25, -0.125, -0.4375, 1.0, 0.0])
def test_the_offset_of_a_torus_is_a_torus(scale: float, ratio: float) -> None:
    """K and H carry the rounding of K, H and of the sum s, which may be small beside its terms."""
    before, after = exact_torus(scale=scale), exact_torus(MINOR + ratio, scale)
    d = ratio * scale
    moved = before.offset(d)
    K, H = before.gaussian_curvature, before.mean_curvature
    terms = 1 + 2 * np.abs(H * d) + np.abs(K) * d * d
    loss = 8 * EPS * terms / np.abs(1 + 2 * H * d + K * d * d)
    assert np.abs(moved.points - after.points).max() <= 8 * EPS * 4 * scale
    assert np.abs(moved.support - after.support).max() <= 16 * EPS * 4 * scale
    largest = np.abs(after.principal_curvatures).max(axis=1)
    H_error = np.abs(moved.mean_curvature - after.mean_curvature)
    K_error = np.abs(moved.gaussian_curvature - after.gaussian_curvature)
    assert (H_error <= loss * largest).all()
    assert (K_error <= 8 * EPS * largest**2 + loss * np.abs(after.gaussian_curvature)).all()


def test_what_an_offset_keeps() -> None:
    before = exact_torus()
    moved = before.offset(-0.25)
    for name in ("normals", "uv", "normal_index", "patch_index"):
        assert (getattr(moved, name) == getattr(before, name)).all()
    assert moved.report == replace(
        before.report,
        surface="torus offset by -0.25",
        developable_share=None,
        infinite_curvatures=0,
    )
    assert (before.points == exact_torus().points).all()  # and of the old ones nothing is changed
    assert (before.gaussian_curvature == exact_torus().gaussian_curvature).all()
    for name in FIELDS:
        assert (getattr(before.offset(0.0), name) == getattr(before, name)).all()


@pytest.mark.parametrize("d", [0.1, -0.2])
def test_it_is_the_offset_of_the_support_function(d: float) -> None:
    """The same kernel for K and H; its points are moved as here."""
    spline, normals = gm.fit(gm.surfaces.torus(), (32, 24)), gm.fibonacci(1500)
    moved = gm.sample(spline, normals=normals).offset(d)
    assert moved.spline is None
    order = np.lexsort((moved.arrays()["patch_index"], moved.normal_index))
    branches = gm.SupportFunction.of_spline(spline).offset(d).branches(normals)
    assert (moved.normal_index[order] == branches.normal_index).all()
    assert (moved.gaussian_curvature[order] == branches.gaussian_curvature).all()
    assert (moved.mean_curvature[order] == branches.mean_curvature).all()
    assert np.abs(moved.points[order] - branches.points).max() <= 4 * EPS
    assert np.abs(moved.support[order] - branches.support).max() <= 8 * EPS


def test_float32_is_rounded_once() -> None:
    spline, normals = gm.fit(gm.surfaces.torus(), (32, 24)), gm.fibonacci(500)
    narrow = gm.sample(spline, normals=normals, dtype=np.float32).offset(0.1)
    wide = gm.sample(spline, normals=normals).offset(0.1)
    assert narrow.dtype == np.float32
    for name in FIELDS:
        a, b = getattr(narrow, name), getattr(wide, name)
        np.testing.assert_allclose(a, b, rtol=0, atol=8 * 2.0**-23 * np.abs(b).max())


# --- folds ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("K", "H", "d", "folds"),
    [
        (1.0, 1.0, -0.5, False),
        (1.0, 1.0, -2.0, True),  # both radii are passed: s > 0, m < 0
        (1.0, 1.0, 2.0, False),
        (1.0, -1.0, 2.0, True),  # normals that point inwards
        (1.0, -1.0, -2.0, False),
        (-1.0, 0.0, 2.0, True),
        (-1.0, 0.0, -2.0, True),
        (-1.0, 0.0, 0.5, False),
        (0.0, 0.5, -2.0, True),  # a cylinder
        (0.0, 0.5, 2.0, False),
        (0.0, 0.0, 1e9, False),  # a plane
    ],
)
def test_where_it_folds(K: float, H: float, d: float, folds: bool) -> None:
    samples = curved(K, H)
    if folds:
        with pytest.warns(gm.GaussmapWarning, match=r"at 1 of 1 samples.*smallest radius.* 1\.$"):
            samples.offset(d)
    else:
        samples.offset(d)


def test_the_warning_counts_and_names_the_smallest_radius() -> None:
    """Radii 2, 4 and 8, and a saddle with 1 and −3."""
    R_1, R_2 = np.array([2.0, 4.0, 8.0, 1.0]), np.array([2.0, 4.0, 8.0, -3.0])
    samples = curved(1 / (R_1 * R_2), (R_1 + R_2) / (2 * R_1 * R_2))
    for d, count, smallest in ((-5.0, 3, "1"), (3.5, 1, "3"), (-1.5, 1, "1")):
        expected = rf"distance {d:g} reaches .* at {count} of 4 .* that side is {smallest}\.$"
        with pytest.warns(gm.GaussmapWarning, match=expected) as caught:
            samples.offset(d)
        assert caught[0].filename == __file__


@pytest.mark.parametrize(
    ("radius", "dtype"), [*((x, "f8") for x in (1.0, 0.1, 3.0, 1e-9, 1e9, 0.7)), (0.3, "f4")]
)
def test_an_offset_to_a_point(radius: float, dtype: str) -> None:
    """Single precision vanishes within its own rounding."""
    K, H = (np.array([x], dtype) for x in (1 / radius**2, 1 / radius))
    with pytest.warns(gm.GaussmapWarning, match="folds"):
        moved = curved(0, 0, gaussian_curvature=K, mean_curvature=H).offset(-radius)
    assert moved.gaussian_curvature.tolist() == [np.inf]
    assert np.isnan(moved.mean_curvature).all()
    assert np.isnan(moved.principal_curvatures).all()


def test_an_offset_by_one_radius() -> None:
    """To the circle in the middle of the tube, and to the line in the middle of a cylinder."""
    with pytest.warns(gm.GaussmapWarning, match="at 500 of 500"):
        moved = exact_torus().offset(-MINOR)
    assert np.isinf(moved.gaussian_curvature).all()
    assert (moved.elliptic == exact_torus().elliptic).all()
    assert np.abs(np.linalg.norm(moved.points, axis=1) - MAJOR).max() <= 8 * EPS * MAJOR
    with pytest.warns(gm.GaussmapWarning, match="at 1 of 1"):
        assert np.isnan(curved(0.0, 0.5).offset(-1.0).gaussian_curvature).all()


def test_singular_samples_stay_so() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", gm.GaussmapWarning)
        moved = curved([np.nan, np.inf, -np.inf], [np.nan, np.inf, 1.0]).offset(-1.0)
    assert np.isnan(moved.gaussian_curvature).all()
    with pytest.warns(gm.GaussmapWarning, match=r"that side is 0\.$"):
        curved(-np.inf, 1.0).offset(-1.0)


def test_a_far_offset_is_nearly_a_sphere() -> None:
    samples = exact_torus()
    with pytest.warns(gm.GaussmapWarning, match="folds"):
        moved = samples.offset(1e30)
    np.testing.assert_allclose(moved.mean_curvature, 1e-30, rtol=1e-12)
    np.testing.assert_allclose(moved.gaussian_curvature, 1e-60, rtol=1e-12)
    with pytest.warns(gm.GaussmapWarning, match="folds"):
        assert np.isfinite(samples.offset(1e300).gaussian_curvature).all()


# --- trimmed offsets ------------------------------------------------------------------------------


def from_torus(points: np.ndarray) -> np.ndarray:
    x, y, z = points.T
    return np.abs(np.hypot(np.hypot(x, y) - 1.0, z) - 0.35)


@pytest.mark.parametrize(("d", "scale"), [(0.7, 1e-9), (-0.36, 1e9), (0.5, 1.0)])
@pytest.mark.quick_for("0.7")
def test_a_trimmed_offset_is_as_far_as_its_distance(d: float, scale: float) -> None:
    """The hole of a torus has the radius 0.65, the tube 0.35, and curvatures are not needed."""
    torus = gm.surfaces.torus(major=scale, minor=0.35 * scale)
    samples = gm.sample(torus, 500, fields=("points", "normals"))
    moved = samples.offset(d * scale / 2).offset(d * scale / 2, trimmed=True)
    distances = from_torus((samples.points + d * scale * samples.normals) / scale)
    assert len(moved) == np.count_nonzero(distances >= abs(d) - 1e-4)
    assert (len(moved) < 500) == (d != 0.5)
    assert from_torus(moved.points / scale).min(initial=1.0) >= abs(d) - 1e-4
    assert moved.offset_of.trimmed == (d != 0.5)


@pytest.mark.slow
def test_trimmed_by_brute_force() -> None:
    """By the distances of 10⁵ points; no warning, as all that folds is left out."""
    graph = gm.surfaces.wavy_graph()
    ends = [np.linspace(*side, 320) for side in graph.domain]
    fine = graph.evaluate(*(x.ravel() for x in np.meshgrid(*ends)))
    samples = gm.sample(graph, 300)
    places = samples.points + samples.normals
    distances = np.array([np.linalg.norm(fine - x, axis=1).min() for x in places])
    moved = samples.offset(1.0, trimmed=True)
    kept = np.isin(samples.uv[:, 0], moved.uv[:, 0])
    assert 50 < len(moved) == np.count_nonzero(kept) < 150
    assert (distances[kept] >= 1.0 - 1e-3).all()
    assert (distances[~kept] < 1.0 + 1e-4).all()  # fine points are up to 3e-3 apart
    refused("by 1, trimmed' has no mesh", moved.mesh)
    band = gm.sample("moebius_band", 300).offset(0.05)
    refused("has no mesh: the surface has one side", band.mesh)


@pytest.mark.slow
def test_a_thin_body_is_trimmed_away() -> None:
    """It is .0496 thick; 20,000 samples are too far apart to find that everywhere."""
    samples = gm.sample(gm.surfaces.ellipsoid(1, 1, 0.0248), 400, density="uniform")
    assert len(samples.offset(-0.025, trimmed=True)) == 0


@pytest.mark.slow
def test_a_trimmed_offset_of_a_part(parts: Any) -> None:
    """Into a box: what stays is as far from all walls as from its own."""
    part = parts.box()
    samples = gm.sample(part, 200)
    inside = samples.points - 0.3 * samples.normals
    walls = np.abs(inside[:, None] - part.bounds).min(axis=(1, 2))
    moved = samples.offset(-0.3, trimmed=True)
    assert 50 < len(moved) < 150
    assert np.isin(moved.points[:, 0], inside[walls >= 0.3 * 0.99, 0]).all()
    assert len(moved) >= np.count_nonzero(walls >= 0.3 - 1e-9)
    refused("an offset of a CAD part has no mesh", samples.offset(0.1).mesh)


def test_what_cannot_be_trimmed() -> None:
    refused("do not hold their surface", exact_torus().offset, 0.1, trimmed=True)
    samples = gm.sample("torus", 100, cells=(16, 16))
    refused("0.01, is less than 1/180 of", samples.offset, 0.01, trimmed=True)
    assert len(samples.offset(0.0, trimmed=True)) == 100


# --- fields, and what is refused ------------------------------------------------------------------


def only(*names: str) -> gm.Samples:
    samples = exact_torus()
    return gm.Samples(**{x: getattr(samples, x) for x in names}, report=samples.report)


@pytest.mark.parametrize(
    "names",
    [("points", "normals"), ("normals",), ("support",), ("gaussian_curvature", "mean_curvature"),
     ("uv", "normal_index")],
)  # fmt: skip
def test_fields_that_are_there_are_moved(names: tuple[str, ...]) -> None:
    moved, everything = only(*names).offset(-0.25), exact_torus().offset(-0.25)
    assert set(moved.fields) == set(names)
    for name in names:
        assert (getattr(moved, name) == getattr(everything, name)).all()


@pytest.mark.parametrize(
    ("names", "missing"),
    [
        (("points",), "offset of points needs normals, but these samples hold points only"),
        (("normals", "gaussian_curvature"), "needs mean_curvature, .* add 'mean_curvature' to"),
        (("mean_curvature",), "needs gaussian_curvature"),
    ],
)
def test_fields_that_are_needed(names: tuple[str, ...], missing: str) -> None:
    refused(missing, only(*names).offset, 0.1, error=gm.errors.MissingFieldError)


@pytest.mark.parametrize("distance", [np.nan, np.inf, "1", None, [1.0, 2.0], 1j])
def test_distances_that_are_none(distance: Any) -> None:
    refused(r"^distance must be a finite number, not ", exact_torus().offset, distance)


def test_no_samples_and_other_ways_to_get_them() -> None:
    assert len(exact_torus()[:0].offset(-9.0)) == 0
    moved = pickle.loads(pickle.dumps(exact_torus().offset(0.5)))[[1, 2]]
    assert moved.report.surface == "torus offset by 0.5"
