"""Support functions given as expressions and by splines: envelope, curvatures, branches."""

from dataclasses import replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from numpy.typing import NDArray

from ...refusals import refused
from ...shapes import EPS, Array

NORMALS = np.concatenate([gm.icosphere(6), gm.fibonacci(200)])
A = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]])
ELLIPSOID = "sqrt(4*n_x**2 + 2*n_x*n_y + 3*n_y**2 + n_y*n_z + 2*n_z**2)"


def given(h: object, **options) -> gm.SupportFunction:
    return gm.SupportFunction.from_sympy(h, **options)  # pyright: ignore


def close(actual: NDArray[Any], expected: NDArray[Any], size: float, ulps: int = 64) -> None:
    """Compare up to the rounding of some dozens of operations on numbers of a size."""
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=ulps * EPS * size)


# --- expressions ----------------------------------------------------------------------------------


@pytest.mark.kernels
def test_ellipsoid() -> None:
    """The envelope of √(nᵀAn) is A n/h, on xᵀA⁻¹x = 1, with K = h⁴/det A."""
    branches = given(ELLIPSOID).branches(NORMALS)
    h = np.sqrt(np.einsum("ki,ij,kj->k", NORMALS, A, NORMALS))
    points = NORMALS @ A / h[:, None]
    assert (branches.normal_index == np.arange(len(NORMALS))).all()
    close(branches.support, h, 3.0)
    close(branches.points, points, 3.0)
    level = np.einsum("ki,ij,kj->k", branches.points, np.linalg.inv(A), branches.points)
    close(level, np.ones(len(NORMALS)), 4.0)
    hessian = A / h[:, None, None] - points[:, :, None] * points[:, None, :] / h[:, None, None]
    close(branches.hessian, hessian, 4.0)
    gaussian = h**4 / np.linalg.det(A)
    close(branches.gaussian_curvature / gaussian, np.ones_like(h), 8.0)  # radii differ by < 8
    half_sum = np.trace(hessian, axis1=1, axis2=2) / 2
    close(branches.mean_curvature / (half_sum * gaussian), np.ones_like(h), 8.0)
    radii = np.linalg.eigvalsh(hessian)  # 0 and the two radii, all others being positive
    close(branches.principal_radii, radii[:, :0:-1], 4.0)
    assert branches.elliptic.all()


@pytest.mark.kernels
@pytest.mark.parametrize("h", [2, 2.0, "2", "2*sqrt(n_x**2 + n_y**2 + n_z**2)", sp.Integer(2)])
def test_constant_is_a_sphere(h: object) -> None:
    branches = given(h).branches(NORMALS)
    close(branches.points, 2 * NORMALS, 2.0)
    close(branches.support, np.full(len(NORMALS), 2.0), 2.0)
    close(branches.principal_radii, np.full((len(NORMALS), 2), 2.0), 2.0)
    close(branches.gaussian_curvature, np.full(len(NORMALS), 0.25), 1.0)
    close(branches.mean_curvature, np.full(len(NORMALS), 0.5), 1.0)


def test_linear_is_a_point() -> None:
    """Both radii are 0, exactly, and the curvature is infinite; functions return no arrays."""
    branches = given("3*n_x - n_y/4 + 1e6*n_z").branches(NORMALS)
    assert (branches.points == [3.0, -0.25, 1e6]).all()
    assert not branches.hessian.any()
    assert not branches.principal_radii.any()
    assert np.isposinf(branches.gaussian_curvature).all()
    assert np.isnan(branches.mean_curvature).all()


@pytest.mark.kernels
def test_an_extension_off_the_sphere_changes_nothing() -> None:
    """n_x² + n_y² is 1 − n_z² on the sphere; |n| may be put anywhere."""
    first, second = (given(h) for h in ("n_x**2 + n_y**2", "1 - n_z**2"))
    third = given("(n_x**2 + n_y**2)/sqrt(n_x**2 + n_y**2 + n_z**2)")  # homogeneous of degree 1
    expected = first.branches(NORMALS)
    for other in (second.branches(NORMALS), third.branches(NORMALS)):
        close(other.points, expected.points, 4.0)
        close(other.hessian, expected.hessian, 8.0)


@pytest.mark.kernels
def test_length_of_normals_does_not_matter() -> None:
    support = given("n_x**3 + n_y")
    long = NORMALS * np.exp(np.linspace(-300.0, 300.0, len(NORMALS)))[:, None]
    close(support.envelope(long), support.envelope(NORMALS), 16.0)


@pytest.mark.parametrize("exponent", [-150, 150])
def test_scales(exponent: int) -> None:
    s = 10.0**exponent
    branches = given(f"1e{exponent}*({ELLIPSOID})").branches(NORMALS)
    expected = given(ELLIPSOID).branches(NORMALS)
    close(branches.points / s, expected.points, 3.0)
    close(branches.gaussian_curvature * s * s, expected.gaussian_curvature, 64.0)


def test_domain() -> None:
    """Where h is not real there is no branch; nor where the condition does not hold."""
    half = given("sqrt(n_z)")
    assert (half.contains(NORMALS) == (NORMALS[:, 2] > 0.0)).all()  # no gradient at n_z = 0
    assert np.isnan(half.envelope(NORMALS)[NORMALS[:, 2] <= 0.0]).all()
    quarter = given("1 + n_x*n_y", domain="(n_z > 0) & (n_x > 0)")
    inside = (NORMALS[:, 2] > 0.0) & (NORMALS[:, 0] > 0.0)
    assert (quarter.sheets(NORMALS) == inside).all()
    assert (quarter.branches(NORMALS).normal_index == np.flatnonzero(inside)).all()
    assert (np.isfinite(quarter(NORMALS)) == inside).all()
    nothing = given(1, domain=False).branches(NORMALS)
    assert len(nothing) == 0
    assert nothing.points.shape == (0, 3)
    assert nothing.hessian.shape == (0, 3, 3)


def test_other_powers_and_functions() -> None:
    """|n|₄ at (1, 1, 1)/√3 has the point 3^(−3/4) (1, 1, 1): compare with central differences."""
    support = given("(n_x**4 + n_y**4 + n_z**4)**(1/4)")
    diagonal = support.envelope([[1.0, 1.0, 1.0]])
    close(diagonal, np.full((1, 3), 3.0**-0.75), 1.0)
    bumpy = given("1 + exp(n_x)*sin(3*n_y)/10 + abs(n_z)**(5/2)/20")
    n = np.array([[0.48, 0.6, 0.64]])
    t, step = np.array([[0.6, -0.8, 0.0]]) @ np.diag([0.8, 0.6, 1.0]), 1e-5
    t -= (t @ n.T) * n
    t /= np.linalg.norm(t)
    ahead, behind = (bumpy.branches(n * np.cos(a) + t * np.sin(a)) for a in (step, -step))
    here = bumpy.branches(n)
    slope = (ahead.support - behind.support) / (2 * step)
    assert slope == pytest.approx(float((here.points @ t.T)[0, 0]), abs=1e-8)
    moved = (ahead.points - behind.points) / (2 * step)  # dx = Hess h dn
    np.testing.assert_allclose(moved[0], here.hessian[0] @ t[0], atol=1e-7)


@pytest.mark.kernels
def test_cube() -> None:
    """|n_x| + |n_y| + |n_z|: every generic normal sees a vertex of the cube, a point."""
    normals = gm.fibonacci(50)
    branches = given("abs(n_x) + Abs(n_y) + Abs(n_z)").branches(normals)
    assert (branches.points == np.sign(normals)).all()
    assert not branches.principal_radii.any()


@pytest.mark.kernels
def test_names_of_the_normal() -> None:
    x, y, z = sp.symbols("x y z")
    expected = given("n_x**2 + 2*n_y*n_z").envelope(NORMALS)
    for h, normal in (("x**2 + 2*y*z", "xyz"), (x**2 + 2 * y * z, (x, y, z))):
        assert (given(h, normal=normal).envelope(NORMALS) == expected).all()
    swapped = given("n_y**2 + 2*n_x*n_z", normal=("n_y", "n_x", "n_z"))
    assert (swapped.envelope(NORMALS) == expected).all()
    assert str(swapped.expression) == "n_x**2 + 2*n_y*n_z"


# --- splines --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def torus() -> gm.Spline:
    return gm.fit(gm.surfaces.torus(major=1.0, minor=0.35), (48, 48))


@pytest.mark.parametrize(
    ("normals", "is_trimmed"),
    [(gm.icosphere(12), False), (gm.fibonacci(5000), True)],
    ids=["ico", "trimmed"],
)
def test_spline_has_the_branches_that_sampling_finds(
    torus: gm.Spline, normals: Array, is_trimmed: bool
) -> None:
    if is_trimmed:
        triangle = gm.surfaces.torus().trimmed([[(1, 1), (5, 1), (3, 6)]])
        torus = replace(torus, trim=triangle.trim)
    branches = gm.SupportFunction.of_spline(torus).branches(normals)
    samples = gm.sample(torus, normals=normals)
    same = np.abs(branches.normals[:, 2]) < 1.0  # others are on two circles, with one sample each
    samples = samples[np.abs(samples.normals[:, 2]) < 1.0]
    for name in ("normal_index", "patch_index", "points", "uv", "normals", "gaussian_curvature"):
        assert (getattr(branches, name)[same] == getattr(samples, name)).all()
    assert (np.diff(branches.normal_index) >= 0).all()
    assert (branches.normals == normals[branches.normal_index]).all()


def test_hessian_of_a_spline_is_that_of_its_curvatures(torus: gm.Spline) -> None:
    """Hess n = 0; trace and determinant on the tangent plane are those of K and H."""
    branches = gm.SupportFunction.of_spline(torus).branches(gm.fibonacci(5000))
    away = np.abs(branches.normals[:, 2]) < 0.99
    radii = branches.principal_radii[away]
    large = np.abs(radii).max(axis=1)
    # The forms of a patch are known up to FORM_ERROR = 2⁻⁴³; beside that, cells of size 1/48.
    error = 2.0**-43 * 48 * large
    kernel = np.einsum("kij,kj->ki", branches.hessian, branches.normals)[away]
    assert (np.abs(kernel) <= error[:, None]).all()
    K, H = branches.gaussian_curvature[away], branches.mean_curvature[away]
    assert (np.abs(radii.prod(axis=1) * K - 1) <= error * large * np.abs(K) * large).all()
    assert (np.abs(radii.sum(axis=1) * K / 2 - H) <= error * np.abs(K) * large).all()
    eigenvalues = np.sort(np.linalg.eigvalsh(branches.hessian[away]), axis=1)
    expected = np.sort(np.column_stack([radii, np.zeros(len(radii))]), axis=1)
    assert (np.abs(eigenvalues - expected) <= error[:, None]).all()


@pytest.mark.parametrize("name", ["plane", "cylinder"])
def test_developable_surfaces_have_no_branch(name: str) -> None:
    support = gm.SupportFunction.of_spline(gm.surfaces.surface(name), (8, 8))
    assert not support.contains(gm.icosphere(4)).any()
    assert len(support.branches([[0.0, 0.0, 1.0]])) == 0


def test_parabolic_normals_keep_the_sign(torus: gm.Spline) -> None:
    """At ±z the plane touches the torus along circles: curvature ±0, and an infinite radius."""
    branches = gm.SupportFunction.of_spline(torus).branches([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    assert (np.bincount(branches.normal_index) == 2).all()
    assert np.count_nonzero(branches.elliptic) == 2
    assert np.isfinite(branches.points).all()
    assert not np.isfinite(branches.principal_radii).all()


def test_hessian_at_poles_is_taken_where_the_curvatures_are() -> None:
    """Next to the singular point, at 2⁻²⁰: a radius that small has lost 20 of the 43 bits."""
    poles = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 1e-9, 1.0]]
    branches = gm.SupportFunction.of_spline(gm.surfaces.sphere(), (16, 16)).branches(poles)
    assert branches.normal_index.tolist() == [0, 1, 2]
    product = branches.principal_radii.prod(axis=1) * branches.gaussian_curvature
    assert np.abs(product - 1).max() < 2.0**-20


@pytest.mark.kernels
def test_small_spline_without_compilation() -> None:
    """A bowl z = u² + v²: the spline is exact, x = (−n_x, −n_y, ·)/(2 n_z)."""
    bowl = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, u * u + v * v], axis=-1), ((-1.0, 1.0), (-1.0, 1.0))
    )
    normals = np.array([[0.3, -0.2, 1.0], [0.0, 0.0, 1.0], [0.5, 0.5, 1.0], [0.0, 0.0, -1.0]])
    support = gm.SupportFunction.of_spline(bowl, (3, 3))
    branches = support.branches(normals)
    assert branches.normal_index.tolist() == [0, 1, 2]
    u, v = (-normals[:3, :2] / (2 * normals[:3, 2:])).T
    close(branches.points, np.column_stack([u, v, u * u + v * v]), 1.0, 2**12)
    close(branches.uv, np.column_stack([u, v]), 1.0, 2**12)
    g = 1 + 4 * u * u + 4 * v * v  # K = 4/g², and the normal points inwards: H < 0
    close(branches.gaussian_curvature, 4 / g**2, 4.0, 2**12)
    close(branches.mean_curvature, -(2 + 4 * u * u + 4 * v * v) / g**1.5, 4.0, 2**12)
    close(1 / branches.principal_radii.prod(axis=1), 4 / g**2, 4.0, 2**14)


def test_several_branches_are_no_single_value(torus: gm.Spline) -> None:
    support = gm.SupportFunction.of_spline(torus)
    for call in (support, support.envelope):
        refused(r"normals\[0\] has 2 branches", call, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


# --- what is shown --------------------------------------------------------------------------------


@pytest.mark.kernels
def test_text_and_latex() -> None:
    support = given("n_x**3 + 2*n_y")
    assert repr(support) == "SupportFunction(h = n_x**3 + 2*n_y)"
    assert support._repr_latex_() == r"$\displaystyle h(\mathbf{n}) = n_{x}^{3} + 2 n_{y}$"
    assert support.domain == sp.true
    assert repr(support.branches(NORMALS)).startswith("Branches(")
    spline = gm.Spline(np.zeros((5, 5, 3)), ((0, 1), (0, 1)), (("open",) * 2,) * 2, "flat")  # pyright: ignore
    flat = gm.SupportFunction.of_spline(spline)
    assert repr(flat) == "SupportFunction(flat, 36 patches)"
    assert flat.expression is flat.domain is flat._repr_latex_() is None
