"""Convolution: against exact sums, and against the convex hull of all sums of two points."""

import pickle
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from ...refusals import refused
from ...shapes import AXES, EPS, Array

NORMALS = gm.fibonacci(400)
given = gm.SupportFunction.from_sympy
of_spline = gm.SupportFunction.of_spline
ELLIPSOID = given("sqrt(n_x**2 + 4*n_y**2 + 9*n_z**2)")
TURNED = given("sqrt(2*n_x**2 + n_y**2 + n_x*n_z + n_z**2)")
# Sums of flat ellipsoids: boxes with round edges.
BOX = given("2*sqrt(n_x**2 + 1/16) + sqrt(n_y**2 + 1/16) + sqrt(n_z**2 + 1/16)")
BEAM = given("sqrt((n_x + n_y)**2 + 1/9) + sqrt((n_x - n_y)**2 + 1/9) + 3*sqrt(n_z**2 + 1/9)")


# --- exact sums -----------------------------------------------------------------------------------


@pytest.mark.kernels
def test_spheres() -> None:
    sums = gm.convolve(given("2 + n_x"), given("1 - 3*n_y"), NORMALS)
    assert np.abs(sums.points - [1, -3, 0] - 3 * NORMALS).max() <= 16 * EPS * 4
    np.testing.assert_allclose(sums.gaussian_curvature, 1 / 9, rtol=64 * EPS)
    np.testing.assert_allclose(sums.mean_curvature, 1 / 3, rtol=64 * EPS)
    assert np.isnan(sums.first_uv).all()
    assert repr(sums).startswith("Convolution(400 points on SupportFunction(h = ")


BODY = gm.surfaces.ellipsoid(a=1.0, b=0.75, c=0.5)
PLACE = np.eye(4)[[1, 2, 0, 3]]
PLACE[:3, 3] = 1.0, 2.0, 3.0
SMALL = gm.surfaces.ellipsoid(a=0.2, b=0.3, c=0.4).transformed(PLACE)
EXACT = given("sqrt(n_x**2 + 9*n_y**2/16 + n_z**2/4)")
EXACT_SMALL = given("sqrt(9*n_x**2 + 16*n_y**2 + 4*n_z**2)/10 + n_x + 2*n_y + 3*n_z")


def test_points_of_surfaces_are_exact() -> None:
    """At poles, too, where a side of the domain collapses."""
    normals = np.concatenate([gm.icosphere(6), AXES])
    sums = gm.convolve(BODY, SMALL, normals)
    exact = (EXACT + EXACT_SMALL).branches(normals)
    assert (sums.normal_index == np.arange(len(normals))).all()
    np.testing.assert_allclose(sums.points, exact.points, rtol=0, atol=64 * EPS * 4)
    np.testing.assert_allclose(sums.first.hessian, EXACT.branches(normals).hessian, atol=1e-12)
    np.testing.assert_allclose(sums.gaussian_curvature, exact.gaussian_curvature, rtol=1e-11)
    np.testing.assert_allclose(sums.mean_curvature, exact.mean_curvature, rtol=1e-11)
    report = sums.report
    assert (report.on, report.unrefined, report.fit_distance) == ("surface", 0, None)
    assert (report.proved, report.undecided) == (len(normals), ())
    assert sums.on_surface.all()


def test_what_is_not_proved_is_listed() -> None:
    """The normals ±z of a torus are those of circles, of which a trim leaves hardly anything."""
    normals = np.concatenate([NORMALS, AXES])
    part = gm.surfaces.torus().trimmed(within=lambda u, v: (v < 1.0) | (abs(u - 0.01) < 1e-3))
    report = gm.convolve(part, BODY, normals).report
    assert report.undecided is not None
    assert {x.normal for x in report.undecided} == {402, 405}
    assert report.proved == 404
    whole = gm.convolve("torus", BODY, normals)
    assert whole.report.proved == 406
    np.testing.assert_array_equal(np.bincount(whole.normal_index)[[402, 405]], 1)
    np.testing.assert_allclose(
        whole.support, (whole.points * whole.normals).sum(axis=1), rtol=0.0, atol=1e-12
    )


def test_how_far_sums_of_splines_are_off_is_said() -> None:
    """Also for a spline in an operation, and a sum of a spline and a surface."""
    one, two = gm.fit(BODY, (32, 32)), gm.fit(SMALL, (24, 24))
    twice = of_spline(two).scaled(-2).reversed()
    exact = EXACT.branches(NORMALS).points
    small = EXACT_SMALL.branches(NORMALS).points
    reflected = EXACT_SMALL.scaled(-2).reversed().branches(NORMALS).points
    asked: list[tuple[tuple[Any, Any], Array, list[tuple[int, Any]]]] = [
        ((one, two), exact + small, [(1, one.misfit), (1, two.misfit)]),
        ((BODY, two), exact + small, [(1, two.misfit)]),
        ((one, twice), exact + reflected, [(1, one.misfit), (2, two.misfit)]),
    ]
    for pair, points, misfits in asked:
        samples = gm.convolve(*pair, NORMALS)
        report: Any = samples.report
        assert report.on == "spline"
        assert report.proved is None
        assert report.fit_distance == pytest.approx(sum(k * x.distance for k, x in misfits))
        assert report.fit_angle == max(x.angle for _, x in misfits)
        assert "they lie on a spline within" in samples.summary()
        normal = np.abs(np.einsum("ij,ij->i", samples.points - points, NORMALS)).max()
        off = np.linalg.norm(samples.points - points, axis=1).max()
        # the largest radii are 2 and 0.8 (twice that of the last)
        assert normal <= 1.01 * report.fit_distance
        assert off <= report.fit_distance + np.radians(report.fit_angle) * (2 + 2 * 0.8)
        assert off > 1e-6


# --- the boundary of the Minkowski sum of convex bodies -------------------------------------------


def pairwise(first: Array, second: Array) -> Array:
    return (first[:, None] + second).reshape(-1, 3)


@pytest.mark.quick_for("boxes", "box and ellipsoid")
@pytest.mark.parametrize(
    "pair",
    [(ELLIPSOID, TURNED), (BOX, BEAM), (BOX, ELLIPSOID)],
    ids=["ellipsoids", "boxes", "box and ellipsoid"],
)
def test_against_the_hull_of_all_sums(pair: tuple[Any, Any]) -> None:
    """Its points are the vertices i + i of the hull, whose facets lie nearly as far out as h says.

    A facet with normal e is nearer than h(e) by at most R (1 − cos θ), R being the largest radius
    of the sum and θ < 8.5° the angle from e to the next of 400 normals.
    """
    sums = gm.convolve(*pair, NORMALS)
    everything = pairwise(sums.first.points, sums.second.points)
    hull = ConvexHull(everything)
    size = np.abs(everything).max()
    diagonal = np.arange(len(NORMALS)) * (len(NORMALS) + 1)
    assert (everything[diagonal] == sums.points).all()
    assert np.isin(diagonal, hull.vertices).all()
    farthest = (NORMALS @ everything.T).max(axis=1)
    assert np.abs(farthest - sums.support).max() <= 32 * EPS * size
    directions, distances = hull.equations[:, :3], -hull.equations[:, 3]
    angle = np.arccos((directions @ NORMALS.T).max(axis=1).min())
    assert np.degrees(angle) < 8.5
    h = (pair[0] + pair[1])(directions)
    largest = sum(x.branches(gm.fibonacci(20_000)).principal_radii.max() for x in pair)
    assert (distances <= h + 32 * EPS * size).all()
    assert (h - distances <= 1.01 * largest * (1 - np.cos(angle))).all()


@pytest.mark.kernels
def test_a_sum_with_the_reflected_body() -> None:
    """For bodies A, B: x ∈ A ⊕ (−B) where A and x + B meet; h is h_A(n) + h_B(−n)."""
    away = given("sqrt(n_x**2 + n_y**2 + 4*n_z**2) + 5*n_x + n_y*n_z*n_x/9")
    samples = gm.convolve(BOX, away.scaled(-1).reversed(), NORMALS)
    assert np.abs(samples.support - BOX(NORMALS) - away(-NORMALS)).max() <= 64 * EPS * 8
    assert np.abs(np.einsum("ij,ij->i", samples.points, NORMALS) - samples.support).max() < 1e-13
    assert samples.elliptic.all()


# --- all pairs, and what is told of them ----------------------------------------------------------


def test_all_pairs_of_branches() -> None:
    torus = gm.fit(gm.surfaces.torus(), (32, 24))
    turned = of_spline(torus).rotated(np.eye(3)[[1, 2, 0]])
    normals = gm.icosphere(6)
    sums = gm.convolve(torus, turned, normals)
    i, j = sums.rows.T
    assert len(sums) == len(i)
    assert (sums.points == sums.first.points[i] + sums.second.points[j]).all()
    for rows, branches in ((i, sums.first), (j, sums.second)):
        assert (sums.normal_index == branches.normal_index[rows]).all()
    counts = [
        np.bincount(x.normal_index, minlength=len(normals)) for x in (sums.first, sums.second)
    ]
    assert (np.bincount(sums.normal_index, minlength=len(normals)) == counts[0] * counts[1]).all()
    assert len(set(zip(i.tolist(), j.tolist(), strict=True))) == len(sums)
    assert (np.diff(sums.normal_index) >= 0).all()
    assert (sums.normals == normals[sums.normal_index]).all()
    assert np.abs(torus.evaluate(*sums.first_uv.T) - sums.first.points[i]).max() < 1e-12
    assert sums.second_uv.shape == (len(sums), 2)
    together = (of_spline(torus) + turned).branches(normals)
    assert (together.points == sums.points).all()
    assert np.array_equal(together.gaussian_curvature, sums.gaussian_curvature, equal_nan=True)
    assert sums.report.surface.startswith("torus + SupportFunction((torus, ")
    assert (sums.report.normals, sums.report.samples) == (362, len(sums))


def test_a_convolution_is_samples(tmp_path: Any) -> None:
    sums = gm.convolve(gm.fit(gm.surfaces.torus(), (16, 16)), ELLIPSOID, gm.icosphere(4))
    outer = sums[sums.elliptic]
    i, j = outer.rows.T
    assert (outer.points == outer.first.points[i] + outer.second.points[j]).all()
    assert [len(sums[x]) for x in ([], [3], slice(2, 7), [True] * len(sums))] == [
        0,
        1,
        5,
        len(sums),
    ]
    with pytest.raises(gm.errors.InputError, match="index is out of range"):
        sums[[len(sums)]]
    outer.write(tmp_path / "sum.ply", fields=("points", "normals"))
    assert len(gm.read_samples(tmp_path / "sum.ply")) == len(outer) > 100
    again = pickle.loads(pickle.dumps(outer))
    assert (again.rows == outer.rows).all()
    assert again.summary() == outer.summary()
    assert outer.summary().startswith(f"{len(outer)} of {len(sums)} samples at ")
    both = gm.Samples.concatenate([outer, sums])
    assert (type(both), len(both)) == (gm.Samples, len(outer) + len(sums))


@pytest.mark.parametrize("cells", [None, (8, 8)])
def test_what_normals_cannot_see_is_said(cells: Any) -> None:
    for name in ("plane", "cylinder"):
        with pytest.warns(gm.GaussmapWarning, match=f"'{name}': 100 % of its area is flat") as said:
            sums = gm.convolve(ELLIPSOID, gm.surfaces.surface(name), gm.fibonacci(100), cells=cells)
        assert said[0].filename == __file__
        assert len(sums) == 0
        assert sums.first_uv.shape == (0, 2)


@pytest.mark.parametrize("prefer", ["shape", "normals"])
@pytest.mark.parametrize("scale", [1.0, 1e-9, -1e9])
def test_the_mesh_of_a_minkowski_sum(scale: float, prefer: Any) -> None:
    """Closed, outwards; its support function is h₁ + h₂ at the normals, and not far off between.

    Normals on the side of a negative scale point inwards.
    """
    sums = gm.convolve(ELLIPSOID.scaled(scale), TURNED.scaled(scale), NORMALS)
    mesh = sums.mesh(prefer=prefer)
    assert (len(mesh.boundary_edges), mesh.euler_characteristic) == (0, 2)
    assert len(mesh.vertices) + mesh.left_out == len(sums) == 400
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    across = np.cross(b - a, c - a)
    assert (np.einsum("kx,kx->k", across, mesh.normals[mesh.triangles[:, 0]]) > 0).all()
    assert (np.einsum("kx,kx->k", across, a) * scale > 0).all()  # the origin is inside
    farthest = (NORMALS @ mesh.vertices.T * np.sign(scale)).max(axis=1)
    off = np.sign(scale) * sums.support - farthest
    assert off.min() >= -32 * EPS * 5 * abs(scale)
    rows = mesh.sample_index
    assert np.abs(off[rows]).max() <= 32 * EPS * 5 * abs(scale)
    if prefer == "normals":
        np.testing.assert_array_equal(np.sort(rows), np.arange(400))
        hull, volume = ConvexHull(mesh.vertices), np.einsum("kx,kx", across, a) / 6
        assert volume == pytest.approx(np.sign(scale) * hull.volume, rel=1e-12)


def test_sums_without_a_mesh() -> None:
    """Those that fold, of which there are few, and with gaps, unless these are to stay."""
    folded = given("sqrt(n_x**2 + 4*n_y**2 + 9*n_z**2) - 1")  # the least radius is 1/3
    torus = gm.fit("torus", (16, 16))
    for first, second, message in [
        (torus, ELLIPSOID, "sums on both sides of the tangent planes of [1-9]"),
        (folded, given("0*n_x"), "are not on a convex body"),
        (given("n_x"), given("n_y"), "400 in all, do not bound a body"),
    ]:
        refused(message, gm.convolve(first, second, NORMALS).mesh)
    sums = gm.convolve(ELLIPSOID, TURNED, NORMALS)
    refused("do not bound a body", sums[:0].mesh)
    upper = sums[sums.normals[:, 2] > 0]
    refused("200 in all, are too few, or leave too large ga", upper.mesh)
    assert upper.mesh(angle=45).euler_characteristic == 1


@pytest.mark.kernels
def test_surfaces_without_a_common_normal() -> None:
    upper, lower = given("1", domain="n_z > 0"), given("1", domain="n_z < 0")
    with pytest.warns(gm.GaussmapWarning, match="no normal has points on both") as said:
        assert len(gm.convolve(upper, lower, NORMALS)) == 0
    assert said[0].filename == __file__


def test_one_normal() -> None:
    sums = gm.convolve(gm.surfaces.torus(), ELLIPSOID, [[0, 3, 4]], cells=(16, 16))
    assert sums.normals.tolist() == [[0, 0.6, 0.8]] * 2
    assert sums.rows.tolist() == [[0, 0], [1, 0]]


@pytest.mark.kernels
def test_what_is_refused() -> None:
    for arguments, message in (
        ((ELLIPSOID, 3, NORMALS), "two of Surface, Spline and SupportFunction, not int"),
        ((NORMALS, ELLIPSOID, NORMALS), "SupportFunction, not ndarray"),
    ):
        refused(message, gm.convolve, *arguments)
    words = "neither of these is a Surface"
    refused(words, gm.convolve, ELLIPSOID, TURNED, NORMALS, cells=(8, 8))
