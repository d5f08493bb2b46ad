"""The support function of one patch: formula, domain decided exactly, boundary included."""

from itertools import product
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.symbolic.expression import NORMAL

from ...nets import exact_place, exact_sign, normals_at, quadratic_forms, vectors_of
from ...refusals import refused
from ...shapes import EPS, Array

# Control points of formula (12) of the paper, and a patch with both kinds of curvature.
OF_12 = [[1.5, 0, 0], [0, 1.5, 0], [0, 0, 1.5], [1, 1, 0.5], [1, 0.5, 1], [0.5, 1, 1]]
MIXED = [[1, 0, 2], [2, 0, 1], [2, 1, 0], [3, 3, -3], [0, 2, -3], [-1, 0, -1]]
ALIGNED = np.array([n for n in product((-2.0, -1.0, 0.0, 1.0, 2.0), repeat=3) if any(n)])
NORMALS = np.concatenate([gm.icosphere(8), gm.fibonacci(400), ALIGNED])


def unit(normals: Array) -> Array:
    return gm.SupportFunction.from_sympy("1").branches(normals).normals


@pytest.mark.compiled
@pytest.mark.parametrize("net", [OF_12, MIXED], ids=["formula 12", "mixed"])
@pytest.mark.parametrize("factor", [pytest.param(1.0, marks=pytest.mark.slow), 0.1])
@pytest.mark.quick_for("mixed")
def test_membership_and_parameters_are_exact(net: list[list[Any]], factor: float) -> None:
    points = factor * np.array(net)
    normals = unit(NORMALS)
    branches = gm.SupportFunction.of_patch(points).branches(normals)
    places = [exact_place(points, n) for n in normals]
    inside = [k for k, place in enumerate(places) if place is not None]
    assert branches.normal_index.tolist() == inside
    assert 30 < len(inside) < len(normals)
    expected = np.array([places[k] for k in inside], dtype=float)
    # u = U/D: forms are exact up to FORM_ERROR, and |D| > 65536 times that or decided exactly.
    assert np.abs(branches.uv - expected).max() < 2.0**-14
    assert np.median(np.abs(branches.uv - expected)) < 64 * EPS
    assert (branches.patch_index == 0).all()


def test_formula_12_of_the_paper() -> None:
    support = gm.SupportFunction.of_patch(OF_12)
    x, y, z = NORMAL
    numerator = 5 * (x**3 + y**3 + z**3) + 13 * x * y * z
    numerator += 4 * (x**2 * y + x**2 * z + x * y**2 + x * z**2 + z * y**2 + z**2 * y)
    denominator = 2 * (x**2 + 3 * x * y + y**2 + 3 * x * z + 3 * y * z + z**2)
    assert sp.cancel(support.expression - numerator / denominator) == 0
    branches = support.branches(unit(NORMALS))
    h = sp.lambdify(NORMAL, numerator / denominator)(*branches.normals.T)
    np.testing.assert_allclose(branches.support, h, rtol=0.0, atol=64 * EPS)
    latex = support._repr_latex_()
    assert latex is not None
    assert r"5 \left(n_{x}^{3} + n_{y}^{3}" in latex


def test_domain_is_a_condition() -> None:
    support = gm.SupportFunction.of_patch(MIXED)
    condition = sp.lambdify(NORMAL, support.domain)
    normals = unit(gm.fibonacci(2000))
    assert (support.contains(normals) == condition(*normals.T)).all()  # in general position


@pytest.mark.compiled
def test_next_to_a_parabolic_line() -> None:
    """All of a parabolic line has one normal: near it, only exact arithmetic knows D, U, V, W."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    b = 0.1 * np.array(MIXED) @ (np.sign(np.linalg.det(turn)) * turn).T
    vectors = vectors_of(b)

    def normal(u: float) -> Array:
        return normals_at(vectors, u, (1 - u) / 2)

    def curvature(u: float) -> float:
        A, B, C, *_ = quadratic_forms(vectors, normal(u))
        return A * C - B * B

    low, high = 0.0, 1.0
    assert curvature(low) * curvature(high) < 0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if curvature(low) * curvature(middle) <= 0 else (middle, high)
    near = normal(low) / np.linalg.norm(normal(low))
    steps = np.random.default_rng(1).uniform(-1.0, 1.0, (500, 3))
    normals = unit(near + steps * np.logspace(-16, -10, 500)[:, None])
    branches = gm.SupportFunction.of_patch(b).branches(normals)
    places = [exact_place(b, n) for n in normals]
    assert branches.normal_index.tolist() == [k for k, x in enumerate(places) if x is not None]
    assert len(branches) > 20
    assert (branches.elliptic == [exact_sign(b, n) > 0 for n in branches.normals]).all()
    assert 0 < np.count_nonzero(branches.elliptic) < len(branches)


@pytest.mark.compiled
def test_patches_of_a_spline_have_its_branches() -> None:
    """Generic normals lie on no boundary: there the spline is the sum of its patches."""
    spline = gm.fit(gm.surfaces.wavy_graph(), (5, 4))
    normals = unit(np.add(gm.fibonacci(3000), [0.01, 0.02, 0.03]))  # the first one had n_y = 0
    of_spline = gm.SupportFunction.of_spline(spline).branches(normals)
    pairs = []
    for index, net in enumerate(spline.control_nets):
        of_patch = gm.SupportFunction.of_patch(net).branches(normals)
        pairs += [(int(k), index) for k in of_patch.normal_index]
        mine = of_spline.patch_index == index
        # Nets carry the rounding of their points, 4 ε, beside cells of size 2/5 and large radii.
        for name in ("points", "hessian", "gaussian_curvature", "mean_curvature"):
            found, expected = getattr(of_patch, name), getattr(of_spline, name)[mine]
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=4 * EPS / 0.4 * 100 * 100)
    found = zip(of_spline.normal_index.tolist(), of_spline.patch_index.tolist(), strict=True)
    assert sorted(pairs) == list(found)
    assert len(pairs) > 500


# --- sizes, and what is no patch ------------------------------------------------------------------


def test_translation_by_whole_numbers_changes_nothing() -> None:
    normals = unit(NORMALS)
    base = gm.SupportFunction.of_patch(MIXED).branches(normals)
    moved = gm.SupportFunction.of_patch(np.add(MIXED, [1e9, -1e6, 1e3])).branches(normals)
    assert (moved.normal_index == base.normal_index).all()
    assert (moved.hessian == base.hessian).all()
    assert np.abs(moved.points - base.points - [1e9, -1e6, 1e3]).max() <= 2 * EPS * 1e9


CYLINDER = [[1, 0, 1], [0, 1, 0], [0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0], [0, 0.5, 0]]
FLAT = [[1, 0, 0], [0, 1, 0], [0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0], [0, 0.5, 0]]


@pytest.mark.parametrize(
    ("net", "message"),
    [
        (FLAT, "flat or developable"),
        (CYLINDER, "flat or developable"),
        (np.ones((6, 3)), "flat or developable"),
        (np.zeros((6, 3)), "flat or developable"),
        (np.ones((5, 3)), r"six points .* not of shape \(5, 3\)"),
        (np.ones(18), r"six points .* not of shape \(18,\)"),
        ([[1, 2, 3], [4, 5]], "equal rows"),
        ("patch", "real numbers"),
        (np.full((6, 3), 1j), "real numbers"),
        (np.where(np.arange(18).reshape(6, 3) == 7, np.nan, 1.0), r"\[\d\] holds NaN or infinity"),
        (np.where(np.arange(18).reshape(6, 3) == 3, np.inf, 1.0), r"\[\d\] holds NaN or infinity"),
        (np.array(MIXED) * 1e305, "too large"),
    ],
)  # fmt: skip
def test_what_is_no_patch(net: Any, message: str) -> None:
    refused(message, gm.SupportFunction.of_patch, net)


def test_a_patch_folded_into_a_plane_has_no_support_function() -> None:
    folded = [[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]
    refused("no regular point", gm.SupportFunction.of_patch, folded)
