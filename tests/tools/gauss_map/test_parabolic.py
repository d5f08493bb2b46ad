"""Parabolic points: lines of patches, and curves and points of splines and surfaces."""

import warnings
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.tools.gauss_map.chains import joined
from gaussmap.tools.gauss_map.curvature import Curvature
from gaussmap.tools.gauss_map.patches import Patches
from numpy.typing import NDArray

from ...nets import net_of, normals_at, vectors_of
from ...refusals import refused
from ...shapes import Array

PatchClass = gm.gauss_map.PatchClass


def graph(f, domain=((-1.0, 1.0), (-1.0, 1.0))) -> gm.Surface:
    return gm.Surface.from_callable(lambda u, v: np.stack([u, v, f(u, v)], axis=-1), domain)


def curves_of(of: gm.Surface | gm.Spline, **asked: Any) -> tuple[gm.gauss_map.ImageCurve, ...]:
    """Return the curves of something that has no other parabolic points, known or unknown."""
    found = gm.gauss_map.parabolic_points(of, **asked)
    assert found.isolated == ()
    assert len(found.flat) == 0
    assert not found.developable
    return found.curves


def distances(points: Array, polylines: list[Array]) -> Array:
    """Return the distances (k,) of points from the nearest segment of polylines."""
    start = np.concatenate([x[:-1] for x in polylines])
    along = np.concatenate([np.diff(x, axis=0) for x in polylines])
    square = np.maximum(np.einsum("sx,sx->s", along, along), 1e-300)
    share = np.clip(np.einsum("ksx,sx->ks", points[:, None] - start, along) / square, 0.0, 1.0)
    apart = points[:, None] - start - share[..., None] * along
    return np.linalg.norm(apart, axis=2).min(axis=1)


# --- one patch ------------------------------------------------------------------------------------


@pytest.mark.kernels
def test_lines_hold_parabolic_points_with_one_normal() -> None:
    for seed in range(40):
        net = np.random.default_rng(seed).integers(-9, 10, (6, 3)).astype(float)
        vectors = vectors_of(net / 16.0)  # of about the size 1
        lines = gm.gauss_map.parabolic_lines(net)
        assert len(lines) in (1, 3)
        for line in lines:
            assert np.hypot(line.s, line.t) == pytest.approx(1.0, abs=1e-15)
            along = np.linspace(-2.0, 2.0, 7)
            u = -line.rho * line.s - along * line.t
            v = -line.rho * line.t + along * line.s
            N = normals_at(vectors, u, v)
            size = 1.0 + np.abs(N).max()
            assert np.abs(np.cross(N, line.normal)).max() <= 1e-11 * size
            if line.segment is not None:
                weights = np.column_stack([line.segment, 1.0 - line.segment.sum(axis=1)])
                assert weights.min() >= -1e-12
                np.testing.assert_allclose(weights.min(axis=1), 0.0, atol=1e-12)
                height = line.segment @ [line.s, line.t] + line.rho
                np.testing.assert_allclose(height, 0.0, atol=1e-12)


@pytest.mark.kernels
def test_lines_given_in_advance() -> None:
    """p = (½u², uv, ½v²) + d u + e v with D(N) = (v + 2)² u, see `test_image`."""
    lines = gm.gauss_map.parabolic_lines(
        net_of([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 2, 0], [0, 1, 2])
    )
    by_place = {round(line.rho * (line.s + line.t)): line for line in lines}
    assert sorted(by_place) == [0, 2]
    single, double = by_place[0], by_place[2]
    assert (single.multiplicity, double.multiplicity) == (1, 2)
    assert abs(single.s) == pytest.approx(1.0, abs=1e-12)
    assert abs(double.t) == pytest.approx(1.0, abs=1e-7)  # a double root has half the digits
    np.testing.assert_allclose(single.normal, [1.0, 0.0, 0.0], atol=1e-12)
    assert single.segment is not None
    np.testing.assert_allclose(np.sort(single.segment, axis=0), [[0, 0], [0, 1]], atol=1e-12)
    assert double.segment is None


@pytest.mark.kernels
def test_pieces_make_up_the_triangle_and_have_one_sign() -> None:
    generator = np.random.default_rng(3)
    numbers = []
    for _ in range(60):
        net = generator.integers(-9, 10, (6, 3)).astype(float)
        pieces = gm.gauss_map.split_patch(net)
        numbers.append(len(pieces))
        vectors = vectors_of(net)
        total = 0.0
        for piece in pieces:
            x, y = piece.corners.T
            area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
            assert area > 0.0  # counter-clockwise
            total += area
            weights = generator.dirichlet(np.ones(len(x)), 20)
            u, v = (weights @ piece.corners).T
            N = normals_at(vectors, u, v).T
            A, B, C = (vectors[k] @ N for k in range(3))
            assert (np.sign(A * C - B * B) == piece.sign).all()
        assert total == pytest.approx(0.5, abs=1e-13)
    assert set(numbers) >= {1, 2, 3}


@pytest.mark.kernels
@pytest.mark.parametrize(
    ("factor", "shift", "seeds", "error"),
    [(1e-150, 0.0, range(10), 1e-9), (1e100, 0.0, range(10), 1e-9), (1 / 3, 1e6, [1], 1e-7)],
)
def test_scale_does_not_matter_and_translation_costs_its_rounding(factor, shift, seeds, error):
    for seed in seeds:
        net = np.random.default_rng(seed).integers(-9, 10, (6, 3)).astype(float)
        moved = gm.gauss_map.parabolic_lines(net * factor + shift)
        for line, other in zip(gm.gauss_map.parabolic_lines(net), moved, strict=True):
            here, there = (line.s, line.t, line.rho), (other.s, other.t, other.rho)
            assert here == pytest.approx(there, rel=1e-9, abs=error)


# --- classes --------------------------------------------------------------------------------------

X, Y, Z, O = (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)  # noqa: E741


@pytest.mark.kernels
@pytest.mark.parametrize(
    ("vectors", "expected"),
    [
        ((Z, O, Z, X, Y), PatchClass.ELLIPTIC),
        ((Z, O, (0, 0, -1), X, Y), PatchClass.HYPERBOLIC),
        ((O, Z, O, X, Y), PatchClass.HYPERBOLIC),
        ((Z, O, O, X, Y), PatchClass.DEVELOPABLE),
        ((X, Y, Z, O, O), PatchClass.DEVELOPABLE),  # a cone: homogeneous
        ((O, O, O, X, Y), PatchClass.PLANAR),
        ((X, Y, X, X, Y), PatchClass.PLANAR),
        ((X, O, O, X, X), PatchClass.SINGULAR),
        ((O, O, O, O, O), PatchClass.SINGULAR),
        ((X, Y, Z, (0, 2, 0), (0, 1, 2)), PatchClass.ELLIPTIC),  # K = 0 on an edge
        (((4, 0, 0), (0, 4, 0), (0, 0, 4), (-2, 4, 0), (0, 0, 4)), PatchClass.MIXED),
    ],
)
def test_classes(vectors, expected) -> None:
    net = net_of(*vectors)
    nets = [net, net * 1e-12, net * 1e12, net[[1, 2, 0, 5, 3, 4]], net[[1, 0, 2, 3, 5, 4]]]
    assert gm.gauss_map.classify_patches(np.array(nets)).tolist() == [expected] * 5
    assert gm.gauss_map.classify_patches([net / 3 + 1e5]).tolist() == [expected]
    if expected in (PatchClass.PLANAR, PatchClass.DEVELOPABLE, PatchClass.SINGULAR):
        assert gm.gauss_map.parabolic_lines(net) == ()
        assert [piece.sign for piece in gm.gauss_map.split_patch(net)] == [0]


@pytest.mark.kernels
def test_an_isolated_parabolic_point_has_no_say() -> None:
    """In the middle of the piece v < 2/3, at u = v = 1/3, the curvature vanishes."""
    net = [[1, -1, 0], [1, 0, -1], [-1, 1, 1], [-1, 1, 0], [1, 1, -1], [1, -1, -1]]
    assert [line.multiplicity for line in gm.gauss_map.parabolic_lines(net)] == [1]
    pieces = gm.gauss_map.split_patch(net)
    assert [np.sign(piece.corners[:, 1].mean() - 0.6) for piece in pieces] == [-1, 1]
    assert [piece.sign for piece in pieces] == [-1, 1]
    assert gm.gauss_map.classify_patches([net]).tolist() == [PatchClass.MIXED]


@pytest.mark.parametrize("part", [8, pytest.param(1, marks=pytest.mark.slow)])
def test_classes_of_many_patches_are_those_of_each(part: int) -> None:
    """Random and degenerate nets of all sizes; K of both signs inside, counted without lines."""
    rng = np.random.default_rng(0)
    kinds = [rng.integers(-k, k + 1, (400, 6, 3)).astype(float) for k in (1, 2, 9)]
    flat = np.array([[2, 0, 0], [0, 2, 0], [0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]])
    bent = flat + 0.1 * rng.normal(size=(400, 6, 3))
    planes = np.einsum("kij,jx->kix", rng.integers(-2, 3, (50, 6, 2)), [[1.0, 2, 3], [2, -1, 1]])
    lines = np.einsum("ki,x->kix", rng.integers(-2, 3, (20, 6)), [1.0, 2, 3])
    cones = [net_of(x, y, z, 0 * x, 0 * x) for x, y, z in rng.integers(-3, 4, (50, 3, 3))]
    nets = np.concatenate([*kinds, bent, planes, lines, cones, np.ones((1, 6, 3))])
    nets = nets * 10.0 ** rng.integers(-12, 13, (len(nets), 1, 1)) + 0.0
    nets[::7] += np.abs(nets[::7]).max(axis=(1, 2), keepdims=True) * 100.0
    nets = nets[::part]
    classes = gm.gauss_map.classify_patches(nets)
    assert set(classes.tolist()) == set(PatchClass)
    assert classes.tolist() == [gm.gauss_map.classify_patches(net[None])[0] for net in nets]
    for net, found in zip(nets, classes.tolist(), strict=True):
        signs = {piece.sign for piece in gm.gauss_map.split_patch(net)}
        assert (found == PatchClass.MIXED) == (signs == {1, -1})


@pytest.mark.parametrize(
    ("name", "allowed"),
    [
        ("torus", {PatchClass.ELLIPTIC, PatchClass.HYPERBOLIC}),
        ("ellipsoid_patch", {PatchClass.ELLIPTIC}),
        ("catenoid", {PatchClass.HYPERBOLIC}),
        ("monkey_saddle", {PatchClass.HYPERBOLIC}),
        ("cylinder", {PatchClass.DEVELOPABLE}),
        ("plane", {PatchClass.PLANAR}),
    ],
)
def test_classes_of_splines(name: str, allowed: set) -> None:
    spline = gm.fit(gm.surfaces.surface(name), (32, 32))
    classes = gm.gauss_map.classify_patches(spline)
    assert classes.shape == (spline.patches,)
    assert set(classes.tolist()) == allowed


# --- splines --------------------------------------------------------------------------------------


@pytest.mark.parametrize("cells", [(16, 16), (24, 17), (64, 48)])
@pytest.mark.quick_for("cells0", "cells2")
def test_parabolic_circles_of_a_torus_spline(cells: tuple[int, int]) -> None:
    """Two closed polylines, each within one cell of the exact circle, going round once."""
    curves = curves_of(gm.fit(gm.surfaces.torus(), cells))
    assert [curve.closed for curve in curves] == [True, True]
    for curve, place in zip(
        sorted(curves, key=lambda x: x.uv[0, 1]), (np.pi / 2, 3 * np.pi / 2), strict=True
    ):
        assert np.abs(curve.uv[:, 1] - place).max() <= 2 * np.pi / cells[1]
        assert abs(curve.uv[-1, 0] - curve.uv[0, 0]) == pytest.approx(2 * np.pi, abs=1e-12)
        np.testing.assert_allclose(curve.points[0], curve.points[-1], atol=1e-12)


@pytest.mark.parametrize("name", ["cone", "dupin_cyclide", "moebius_band", "wavy_graph"])
@pytest.mark.quick_for("wavy_graph")
def test_curvature_changes_sign_across_the_polylines_of_a_spline(name: str) -> None:
    """On both sides of the middle of every segment K has two signs, by the spline's own samples."""
    spline = gm.fit(gm.surfaces.surface(name), (12, 10))
    patches, steps = Patches.of_spline(spline), []
    found = gm.gauss_map.parabolic_points(spline, tolerance=0.1)
    for curve in found.curves:
        along = np.diff(curve.uv, axis=0)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        across /= np.linalg.norm(across / spline.frame[2:], axis=1, keepdims=True)
        middle = 0.5 * (curve.uv[1:] + curve.uv[:-1])
        steps.append([signs_at(spline, patches, middle + x * across) for x in (1e-7, -1e-7)])
    left, right = (np.concatenate([x[k] for x in steps]) for k in (0, 1))
    assert len(left) > 20
    assert (left * right == -1).all()


def signs_at(spline: gm.Spline, patches: Patches, places: Array) -> Array:
    """Return the sign of D(N) of the patch at each place, by its definition."""
    x = (places - spline.frame[:2]) / spline.frame[2:]
    x = np.where([e[0] == "periodic" for e in spline.boundary], np.mod(x, spline.cells), x)
    cell = np.clip(np.floor(x).astype(int), 0, np.array(spline.cells) - 1)
    s, t = (x - cell - 0.5).T
    turn = np.where(np.abs(s) > np.abs(t), np.where(s > 0, 1, 3), np.where(t > 0, 2, 0))
    for k in range(1, 4):
        s, t = np.where(turn >= k, t, s), np.where(turn >= k, -s, t)
    vectors = patches.vectors[4 * (cell[:, 0] * spline.cells[1] + cell[:, 1]) + turn]
    u, v = -t - s, -t + s
    N = normals_at(vectors, u, v)
    A, B, C = (np.einsum("kx,kx->k", N, vectors[:, k]) for k in range(3))
    return np.sign(A * C - B * B)


def length(polylines: Sequence[Array]) -> float:
    return sum(float(np.linalg.norm(np.diff(x, axis=0), axis=1).sum()) for x in polylines)


def along(polyline: Array, parts: int) -> Array:
    """Return points that cut each segment into equal parts."""
    share = np.arange(parts)[:, None, None] / parts
    return ((1.0 - share) * polyline[:-1] + share * polyline[1:]).reshape(-1, polyline.shape[1])


@pytest.mark.slow
def test_grids_are_splines() -> None:
    u, v = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 40), indexing="ij")
    points = np.stack([u, v, 0.2 * np.sin(3 * u) * np.cos(3 * v)], axis=-1)
    surface = gm.Surface.from_grid(points)
    found, expected = (gm.gauss_map.parabolic_points(x).curves for x in (surface, gm.fit(surface)))
    assert len(found) == len(expected) > 5
    for left, right in zip(found, expected, strict=True):
        np.testing.assert_array_equal(left.uv, right.uv)


# --- surfaces -------------------------------------------------------------------------------------


@pytest.mark.parametrize("by", ["formulas", "operations", "differences"])
def test_curvature_of_the_torus_is_exact_up_to_its_error(by: str) -> None:
    torus = gm.surfaces.torus(major=1.0, minor=0.35)

    def f(u: Array, v: Array) -> Array:
        r = 1.0 + 0.35 * np.cos(v)
        return np.stack([r * np.cos(u), r * np.sin(u), 0.35 * np.sin(v)], axis=-1)

    functions = {"operations": f, "differences": lambda u, v: f(np.array(u), np.array(v, float))}
    if by != "formulas":
        torus = gm.Surface.from_callable(functions[by], torus.domain, periodic=True)
        assert (torus.tape is None) == (by == "differences")
    places = np.random.default_rng(0).uniform(-1.0, 8.0, (2000, 2))
    curvature = Curvature(torus)
    cosine = np.cos(places[:, 1])
    exact = cosine / (0.35 * (1.0 + 0.35 * cosine)) / curvature.scale**2
    found = curvature.at(places)
    assert (np.abs(found.K - exact) <= found.error + 1e-14 * np.abs(exact)).all()
    assert found.error.max() < (1e-5 if by == "differences" else 1e-10)
    K, gradient, hessian = curvature.derivatives(places)
    slope = -np.sin(places[:, 1]) / (0.35 * (1.0 + 0.35 * cosine) ** 2) / curvature.scale**2
    rounding = 1e-3 if by == "differences" else 1e-9
    np.testing.assert_allclose(K, exact, atol=1e-6)
    np.testing.assert_allclose(gradient, slope[:, None] * [0.0, 2 * np.pi], atol=rounding)
    np.testing.assert_allclose(hessian[:, 0], 0.0, atol=1e4 * rounding)


@pytest.mark.parametrize("factor", [1e-12, 1.0, 1e12])
def test_torus(factor: float) -> None:
    curves = curves_of(gm.surfaces.torus(major=factor, minor=0.35 * factor))
    assert [curve.closed for curve in curves] == [True, True]
    for curve in curves:
        place = np.mod(curve.uv[:, 1], 2 * np.pi)
        assert np.abs(np.abs(place - np.pi) - np.pi / 2).max() < 1e-8
        assert abs(curve.uv[-1, 0] - curve.uv[0, 0]) == pytest.approx(2 * np.pi, abs=1e-9)
        radius = np.hypot(*curve.points[:, :2].T)
        np.testing.assert_allclose(radius, factor, rtol=1e-8)
        np.testing.assert_allclose(np.abs(curve.points[:, 2]), 0.35 * factor, rtol=1e-12)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-5])
def test_polylines_are_within_the_tolerance_of_the_curve(tolerance: float) -> None:
    """The circle of the torus, in space: the polyline departs from it by no more than asked."""
    size = np.linalg.norm([2.7, 2.7, 0.7])
    for curve in curves_of(gm.surfaces.torus(), tolerance=tolerance):
        angle = np.linspace(0.0, 2 * np.pi, 1000)
        height = np.full(1000, np.sign(curve.points[0, 2]) * 0.35)
        circle = np.column_stack([np.cos(angle), np.sin(angle), height])
        assert distances(circle, [curve.points]).max() <= tolerance * size


@pytest.mark.parametrize("scale", [0.5, 1e-6, 10.0])
@pytest.mark.quick_for("0.5")
def test_monkey_saddle_has_one_point(scale: float) -> None:
    found = gm.gauss_map.parabolic_points(gm.surfaces.monkey_saddle(scale=scale))
    assert found.curves == ()
    (point,) = found.isolated
    assert np.abs(point.uv).max() < 2e-4  # the tolerance, of a domain of size 2
    assert (point.box[0] <= 0.0).all()
    assert (point.box[1] >= 0.0).all()
    assert np.ptp(point.box, axis=0).max() <= 2e-4
    assert np.linalg.norm(point.point[:2] - point.uv) < 1e-12


def off_the_net(places: Array) -> Array:
    """Return the distances of places from the lines 3x ± 3y = kπ."""
    sums, differences = (3 * (places @ [1, sign]) / np.pi for sign in (1, -1))
    off = [np.abs(x - np.round(x)) * np.pi / np.sqrt(18) for x in (sums, differences)]
    return np.minimum(*off)


def test_wavy_graph_has_a_net_of_curves() -> None:
    """K of z = 0.2 sin 3x cos 3y vanishes on the lines 3x ± 3y = kπ: all of them in [−1, 1]²."""
    curves = [curve.uv for curve in curves_of(gm.surfaces.wavy_graph(), tolerance=1e-4)]
    assert off_the_net(np.concatenate(curves)).max() < 1e-8
    between = np.concatenate([along(x, 5) for x in curves])
    assert off_the_net(between).max() <= 1e-4 * np.linalg.norm([2.0, 2.0, 0.4])
    exact = 2.0 * np.sqrt(2.0) * (2.0 + 2.0 * (2.0 - np.pi / 3.0))
    assert length(curves) == pytest.approx(exact, abs=1e-6)


def crossings(curves: Sequence[gm.gauss_map.ImageCurve]) -> Array:
    """Return the places (k, 2) at which four polylines end."""
    ends = np.concatenate([curve.uv[[0, -1]] for curve in curves])
    places, counts = np.unique(np.round(ends, 9), axis=0, return_counts=True)
    return places[counts == 4]


def test_curves_end_where_they_cross() -> None:
    """The 6 lines of the wavy graph cross at 5 places inside: 6 + 2·5 arcs."""
    curves = curves_of(gm.surfaces.wavy_graph())
    assert len(curves) == 16
    step = np.pi / 6
    expected = [[-step, -step], [-step, step], [0.0, 0.0], [step, -step], [step, step]]
    np.testing.assert_allclose(crossings(curves), expected, atol=1e-8)


@pytest.mark.parametrize("slope", [1.0, 0.3, 0.05])
@pytest.mark.slow
def test_curves_cross_at_any_angle(slope: float) -> None:
    """z = u⁴/12 − s² u² v²/2 + 5 v²: K ∝ u² − s² v² up to terms of the order four in u, v."""
    u, v = sp.symbols("u v")
    z = u**4 / 12 - (slope * u * v) ** 2 / 2 + 5 * v * v
    K = sp.diff(z, u, 2) * sp.diff(z, v, 2) - sp.diff(z, u, v) ** 2
    curves = curves_of(graph(sp.lambdify((u, v), z)), tolerance=1e-4)
    assert len(curves) == 4
    np.testing.assert_allclose(crossings(curves), [[0.0, 0.0]], atol=1e-6)
    K, K_u, K_v = (sp.lambdify((u, v), x) for x in (K, sp.diff(K, u), sp.diff(K, v)))
    for curve in curves:
        u, v = curve.uv[(curve.uv != 0.0).any(axis=1)].T
        assert (np.abs(K(u, v)) <= 1e-4 * np.hypot(K_u(u, v), K_v(u, v)) + 1e-9).all()


@pytest.mark.slow
def test_curves_behind_a_crossing_near_the_border_are_whole() -> None:
    """K of z = sin u sin v vanishes where u ± v is an odd multiple of π/2: at a crossing that is
    1.2 cells from a border four arcs end, and two of them are that short.
    """
    low, high = np.array([-3.0, -3.0]), np.array([3.1, 3.2])
    curves = curves_of(
        graph(lambda u, v: np.sin(u) * np.sin(v), tuple(zip(low, high, strict=True)))
    )
    exact = 0.0
    for sign in (1.0, -1.0):
        for constant in np.pi / 2 * np.arange(-5, 6, 2):
            ends = sorted(sign * (constant - np.array([low[1], high[1]])))
            exact += np.sqrt(2.0) * max(0.0, min(high[0], ends[1]) - max(low[0], ends[0]))
    assert length([x.uv for x in curves]) == pytest.approx(exact, abs=1e-6)
    places = np.array([(-1, 0), (0, -1), (0, 1), (1, 0), (-1, 2), (1, 2)]) * np.pi / 2
    ends = np.concatenate([curve.uv[[0, -1]] for curve in curves])
    for place in places:
        assert (np.abs(ends - place).max(axis=1) < 1e-8).sum() == 4


@pytest.mark.parametrize("ratio", [2, 3, 4])
def test_two_curves_in_one_cell_are_joined_the_right_way(ratio: int) -> None:
    """z = 20u² + h with h_vv = p² − r q² + 0.002: branches of a hyperbola less than a cell apart.

    K = 40 h_vv − h_uv² is positive on the line q = 0: there is a curve on each side of it.
    """
    u, v = sp.symbols("u v")
    s, t = u - sp.Rational(1, 10), v + sp.Rational(13, 100)
    p, q = s + t / 2, t - s / 2
    target = p**2 - ratio * q**2 + sp.Rational(1, 500)
    z = 20 * u * u + sp.integrate(sp.integrate(sp.expand(target), v), v)
    curves = curves_of(graph(sp.lambdify((u, v), z)), cells=(2, 2))
    assert len(curves) == 2
    sides = [sp.lambdify((u, v), q)(*curve.uv.T) > 0.0 for curve in curves]
    assert sorted(bool(side.all()) for side in sides) == [False, True]
    assert sorted(bool(side.any()) for side in sides) == [False, True]


@pytest.mark.slow
def test_steep_waves_are_resolved() -> None:
    """z = sin 50u sin 40v: K vanishes where cos(50u + 40v) cos(50u − 40v) = 0, however steep."""
    waves = graph(lambda u, v: np.sin(50 * u) * np.sin(40 * v), ((0.0, 0.25),) * 2)
    for curve in curves_of(waves, tolerance=1e-3):
        phases = curve.uv @ [[50, 50], [40, -40]] / np.pi - 0.5
        assert np.abs(phases - np.round(phases)).min(axis=1).max() < 1e-8


@pytest.mark.parametrize(
    ("size", "factor", "sharp"),
    [(5.0, 1.0, 1.0), (3.0, 1.0, 2.0), (2.0, 1.0, 10.0), (1.0, 0.1, 50.0)],
)  # fmt: skip
@pytest.mark.slow
def test_bump_has_one_circle(size: float, factor: float, sharp: float) -> None:
    """z = f exp(−a r²): K changes its sign at r = 1/√(2a) alone, and is known however far out."""
    bump = graph(lambda u, v: factor * np.exp(-sharp * (u * u + v * v)), ((-size, size),) * 2)
    (circle,) = curves_of(bump)
    assert circle.closed
    np.testing.assert_allclose(np.linalg.norm(circle.uv, axis=1), np.sqrt(0.5 / sharp), rtol=1e-12)


@pytest.mark.parametrize(
    ("domain", "ends"),
    [(((0.0, 2 * np.pi), (-np.pi / 2, np.pi / 2)), True),
     (((0.0, 2 * np.pi), (np.pi / 2, 3 * np.pi / 2)), True),
     (((0.0, np.pi / 2), (-np.pi / 2, np.pi / 2)), False)],
)  # fmt: skip
def test_curves_on_the_border_are_curves(domain, ends: bool) -> None:
    """Half a torus ends at its two parabolic circles: they are there, each once."""
    torus = gm.surfaces.torus(major=1.0, minor=0.35)

    def f(u: Array, v: Array) -> Array:
        return torus.evaluate(np.mod(u, 2 * np.pi), np.mod(v, 2 * np.pi))

    curves = curves_of(gm.Surface.from_callable(f, domain, periodic=(ends, False)))
    assert [curve.closed for curve in curves] == [ends, ends]
    assert sorted(curve.uv[0, 1] for curve in curves) == list(domain[1])
    for curve in curves:
        assert np.ptp(curve.uv[:, 1]) < 1e-8
        assert np.ptp(curve.uv[:, 0]) == pytest.approx(domain[0][1] - domain[0][0])
        np.testing.assert_allclose(np.abs(curve.points[:, 2]), 0.35, rtol=1e-12)


@pytest.mark.slow
def test_closed_curve_smaller_than_all_cells_is_isolated() -> None:
    """z = x³ − 3 x y² + e r²: K vanishes on the circle r = e/3, which one rectangle has to meet."""
    e = 1e-3
    found = gm.gauss_map.parabolic_points(
        graph(lambda x, y: x**3 - 3 * x * y * y + e * (x * x + y * y))
    )
    assert found.curves == ()
    (ring,) = found.isolated
    assert (ring.box[0] <= e / 3).all()
    assert (ring.box[1] >= -e / 3).all()
    assert np.abs(ring.box).max() < 1 / 64


def strip(width: float) -> gm.Surface:
    """Return z = u² + h, K ∝ 2 h_vv − h_uv², h_vv = t² − w²(1 + u/2)/4 with t = v − 0.1003."""

    def f(u: Array, v: Array) -> Array:
        t = v - 0.1003
        return u * u + t**4 / 12 - width**2 / 4 * (1 + u / 2) * t**2 / 2

    return graph(f)


@pytest.mark.slow
@pytest.mark.parametrize("width", [0.02, 0.006])
def test_curves_close_to_each_other_are_two(width: float) -> None:
    """K is negative in a strip from border to border, narrower than cells; its slope is not 0."""
    curves = curves_of(strip(width))
    assert [curve.closed for curve in curves] == [False, False]
    for curve in curves:
        u, v = curve.uv.T
        assert sorted(np.round(u[[0, -1]], 9)) == [-1.0, 1.0]
        exact = 0.5 * width * np.sqrt(1.0 + 0.5 * u)
        np.testing.assert_allclose(np.abs(v - 0.1003), exact, atol=2e-6)


@pytest.mark.parametrize(
    ("f", "box"),
    [
        (lambda u, v: u**4 + v * v, [[-0.005, -1.0], [0.005, 1.0]]),
        (lambda u, v: (u * u + v * v) ** 2, [[-0.02, -0.02], [0.02, 0.02]]),
    ],
)
def test_zeros_in_too_many_rectangles_are_not_lost(f, box) -> None:
    """K > 0 but on a line, or at a point where it is of order 4: K ≈ 48 r⁴ is lost in rounding."""
    found = gm.gauss_map.parabolic_points(graph(f))
    assert found.curves == ()
    (zero,) = found.isolated
    low, high = np.array(box)
    assert (low <= zero.box[0]).all()
    assert (zero.box[1] <= high).all()
    assert (zero.box[0] <= [0.0, min(0.0, low[1] + 0.02)]).all()
    assert (zero.box[1] >= [0.0, max(0.0, high[1] - 0.02)]).all()


@pytest.mark.slow
def test_panels_with_a_large_error_are_not_flat() -> None:
    """Half twisted and bent, steep at the lower border: K, which has both signs there, is known."""
    band = gm.Surface.from_sympy(
        ("(1 + (v/2 + v**2/5)*cos(u/2))*cos(u)", "(1 + (v/2 + v**2/5)*cos(u/2))*sin(u)",
         "v/2*sin(u/2) + v**2/3"),
        ("u", "v"), domain=((0, "2*pi"), (-1, 1)),
    )  # fmt: skip
    found = gm.gauss_map.parabolic_points(band)
    assert len(found.flat) == 0
    ends = np.concatenate([curve.uv[[0, -1]] for curve in found.curves])
    assert ends[:, 1].min() == -1.0  # one of them reaches the lower border


@pytest.mark.parametrize(
    "name", ["ellipsoid", "ellipsoid_patch", "sphere", "catenoid", "helicoid", "moebius_band",
             "enneper", "hyperboloid", "elliptic_paraboloid", "hyperbolic_paraboloid"]
)  # fmt: skip
@pytest.mark.quick_for("ellipsoid_patch", "hyperboloid")
def test_surfaces_of_one_sign_have_none(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert curves_of(gm.surfaces.surface(name)) == ()


@pytest.mark.parametrize(
    "of",
    [gm.surfaces.cylinder(), gm.surfaces.cone(), gm.surfaces.plane(),
     gm.fit("cylinder", (16, 12)), gm.fit("plane", (16, 12))],
    ids=str,
)  # fmt: skip
def test_developable_surfaces_and_splines_say_so(of: gm.Surface | gm.Spline) -> None:
    found = gm.gauss_map.parabolic_points(of)
    assert found.developable
    assert found.curves == found.isolated == ()
    assert len(found.flat) == 1


def test_planes_touch_a_dupin_cyclide_along_its_parabolic_curves() -> None:
    """A parabolic curve of a ring cyclide is a circle, in which one plane touches it."""
    curves = curves_of(gm.surfaces.dupin_cyclide())
    assert [curve.closed for curve in curves] == [True, True]
    for curve in curves:
        centred = curve.points - curve.points[:-1].mean(axis=0)
        normal = np.linalg.svd(centred)[2][2]
        assert np.abs(centred @ normal).max() < 1e-8
        for step in np.array([[1e-4, 0.0], [0.0, -1e-4]]):
            points = gm.surfaces.dupin_cyclide().evaluate(*(curve.uv + step).T)
            height = (points - curve.points) @ normal
            assert np.abs(height).max() < 1e-6  # of second order in the step


@pytest.mark.slow
@pytest.mark.parametrize("size", [np.abs, np.fabs])
def test_a_crease_between_panels_gives_nothing_false(
    size: Callable[..., NDArray[np.float64]],
) -> None:
    """z = |x − 0.1| + r² has K = 4 / (1 + z_x² + z_y²)² > 0 on both sides of the crease.

    np.abs is traced, so that its derivatives are exact; those of np.fabs are differences.
    """
    surface = graph(lambda u, v: size(u - 0.1) + u * u + v * v)
    for found in (curves_of, lambda x: gm.GaussMap(x).folds()):
        with (
            pytest.warns(gm.GaussmapWarning, match="cannot be computed")
            if surface.tape is None
            else nullcontext()
        ):
            assert found(surface) == ()


@pytest.mark.kernels
def test_cells_are_panels() -> None:
    curves = curves_of(gm.surfaces.torus(), cells=(3, 5))
    assert [curve.closed for curve in curves] == [True, True]


@pytest.mark.kernels
def test_results_print_in_one_line() -> None:
    torus = gm.surfaces.torus()
    found = gm.gauss_map.parabolic_points(torus, cells=(8, 8))
    assert repr(found) == "ParabolicPoints(2 curves, 0 isolated, 0 flat rectangles)"
    number = f"{len(found.curves[0].uv):,} vertices"
    assert repr(found.curves[0]) == f"ImageCurve(closed, {number}, 0 cusps)"
    flat = gm.gauss_map.parabolic_points(gm.surfaces.plane(), cells=(2, 3))
    assert repr(flat) == "ParabolicPoints(0 curves, 0 isolated, 1 flat rectangle, developable)"
    images = gm.gauss_map.GaussianImages.of_spline(gm.fit(gm.surfaces.plane(), (8, 8)))
    assert repr(images) == "GaussianImages(256 patches)"
    assert repr(images[0]) == "GaussianImage(point)"


# --- chains ---------------------------------------------------------------------------------------


@pytest.mark.kernels
def test_chains() -> None:
    def segment(a: int, b: int) -> tuple:
        return a, b, np.array([[a, 0.0], [b, 0.0]])

    open_ = joined([segment(2, 1), segment(2, 3), segment(4, 3)])
    assert [closed for _, closed in open_] == [False]
    assert sorted(open_[0][0][:, 0].tolist()) in ([1, 2, 3, 4],)
    (ring,) = joined([segment(1, 2), segment(3, 2), segment(3, 1)])
    assert ring[1]
    assert ring[0][0].tolist() == ring[0][-1].tolist()
    star = joined([segment(0, k) for k in range(1, 5)])
    assert len(star) == 4
    assert joined([]) == []


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.kernels
def test_bad_input() -> None:
    for tolerance in (0.0, -1.0, 1.0, np.nan, "small", None, 1e-9):
        refused("tolerance", gm.gauss_map.parabolic_points, "torus", tolerance=tolerance)
    for cells in (3, (0, 4), (4,), (2.5, 3), "ab", (1000, 4)):
        refused("cells", gm.gauss_map.parabolic_points, "torus", cells=cells)
    refused("Surface", gm.gauss_map.parabolic_points, 3.0)
    refused("cells", gm.gauss_map.parabolic_points, gm.fit("torus", (8, 8)), cells=(8, 8))
    logarithm = graph(lambda u, v: np.log(u))
    error = gm.errors.SurfaceError
    refused("not finite", gm.gauss_map.parabolic_points, logarithm, error=error)
    for nets in ([], np.zeros((6, 3)), np.zeros((2, 5, 3)), "abc", None):
        refused("nets", gm.gauss_map.classify_patches, nets)
    nan = np.where(np.arange(4 * 6 * 3).reshape(4, 6, 3) == 46, np.nan, 1.0)
    refused(r"nets\[2\] holds NaN or infinity", gm.gauss_map.classify_patches, nan)
    refused("nets are too large", gm.gauss_map.classify_patches, np.full((2, 6, 3), 1e305))


@pytest.mark.kernels
@pytest.mark.parametrize("shift", [0.0, 1e9])
def test_what_cannot_be_known_is_said(shift: float) -> None:
    """A surface that is one point, and one whose coordinates have no digits for its curvature."""

    def f(u: Array, v: Array) -> Array:
        return np.stack([u, v, u**3 + v**3], axis=-1) * bool(shift) + shift

    surface = gm.Surface.from_callable(lambda u, v: f(np.array(u, float), v), ((-1, 1), (-1, 1)))
    with pytest.warns(gm.GaussmapWarning, match="cannot be computed on 100 %"):
        found = gm.gauss_map.parabolic_points(surface, cells=(8, 8))
    assert found.curves == found.isolated == ()
    assert not found.developable


def test_curvature_is_known_where_points_have_no_digits() -> None:
    """The operations of z = u³ + v³ + 10⁹ have exact derivatives: K ∝ u v."""
    curves = curves_of(graph(lambda u, v: u**3 + v**3 + 1e9))
    assert len(curves) == 4
    assert max(np.abs(curve.uv).min(axis=1).max() for curve in curves) < 1e-9
