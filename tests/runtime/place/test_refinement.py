"""Newton's method for samples on the surface: normals, marks, borders, poles."""

from __future__ import annotations

from collections.abc import Callable

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.place.newton import CONTRARY, FOUND, Target, evaluate_on_surface, refine
from gaussmap.runtime.place.repeats import kept_once
from numpy.typing import NDArray

Array = NDArray[np.float64]
NORMAL_ERROR = 1e-12  # radians
FULL = (0.0, 2.0 * np.pi)
LATITUDES = (-np.pi / 2, np.pi / 2)
MOTIONS = [(0.0, 1.0), (1e6, 1.0), (0.0, 1e9), (0.0, 1e-9)]


def refined(
    surface: gm.Surface, cells: tuple[int, int], normals: Array
) -> tuple[Target, NDArray[np.int64]]:
    """Return the samples after refinement, and the numbers of their normals."""
    spline = gm.fit(surface, cells)
    samples = gm.sample(spline, normals=normals)
    target = Target(
        samples.normals, np.sign(samples.gaussian_curvature), samples.uv, samples.points,
        samples.gaussian_curvature, samples.mean_curvature, np.empty(len(samples), np.int8),
    )  # fmt: skip
    refine(surface, spline, target, 1)
    return target, samples.normal_index


def normals_of(surface: gm.Surface, uv: Array) -> Array:
    jets = surface.derivatives(*uv.T)
    normals = np.cross(jets[:, 1], jets[:, 2])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def turned(seed: int) -> Array:
    q = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return q * np.linalg.det(q)


def egg(u: Array, v: Array) -> Array:
    """Return points of a smooth convex surface whose parameter lines are no circles."""
    x, y, z = np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)
    return np.stack([x * (1.2 + 0.3 * z), y * (0.8 + 0.1 * z), 1.4 * z + 0.3 * x * x], axis=-1)


def blob(u: Array, v: Array) -> Array:
    """Return points of a smooth surface with dents."""
    n = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    return n * (1.0 + 0.12 * np.sin(2.0 * n @ [1.0, 2.0, 0.5] + 1.0))[..., None]


def moved(f: Callable[[Array, Array], Array], seed: int, shift: float, factor: float) -> gm.Surface:
    rotation = turned(seed)
    return gm.Surface.from_callable(
        lambda u, v: factor * (f(u, v) @ rotation.T) + shift, (FULL, LATITUDES), (True, "pole")
    )


def next_to(normal: Array) -> Array:
    """Return a normal, and others 1e-14 to 0.1 radians beside it."""
    across = np.linalg.svd(normal[None])[2][1:]
    away = [10.0**k * (np.cos(k) * across[0] + np.sin(k) * across[1]) for k in range(-14, 0)]
    return np.concatenate([normal[None], normal + np.array(away)])


# --- regular points -------------------------------------------------------------------------------


@pytest.mark.compiled
@pytest.mark.parametrize(("shift", "factor"), MOTIONS)
def test_normals_become_the_prescribed_ones(shift: float, factor: float) -> None:
    torus = gm.surfaces.torus()
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = factor * turned(1), shift
    surface = torus.transformed(matrix)
    samples, _ = refined(surface, (24, 16), gm.fibonacci(300))
    assert (samples.state == FOUND).all()
    assert np.abs(normals_of(surface, samples.uv) - samples.normals).max() < NORMAL_ERROR
    rounding = 1e-15 * (factor + shift)
    assert np.abs(surface.evaluate(*samples.uv.T) - samples.points).max() < 2.0 * rounding
    v, minor = samples.uv[:, 1], 0.35
    K = np.cos(v) / (minor * (1.0 + minor * np.cos(v))) / factor**2
    H = (1.0 + 2.0 * minor * np.cos(v)) / (2.0 * minor * (1.0 + minor * np.cos(v))) / factor
    np.testing.assert_allclose(samples.gaussian, K, rtol=1e-7, atol=1e-7 / factor**2)
    np.testing.assert_allclose(samples.mean, H, rtol=1e-7)


@pytest.mark.compiled
def test_numerical_derivatives_give_the_same_samples() -> None:
    torus = gm.surfaces.torus()
    numerical = gm.Surface.from_callable(torus.function, torus.domain, (True, True))
    exact, _ = refined(torus, (16, 16), gm.fibonacci(100))
    found, _ = refined(numerical, (16, 16), gm.fibonacci(100))
    assert (found.state == FOUND).all()
    np.testing.assert_allclose(found.uv, exact.uv, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(found.gaussian, exact.gaussian, rtol=0.0, atol=1e-7)


@pytest.mark.compiled
def test_samples_without_a_place_on_the_surface_stay_on_the_spline() -> None:
    """The border of the spline has other normals than that of the surface."""
    helicoid, normals = gm.surfaces.helicoid(), gm.fibonacci(3000)
    spline = gm.fit(helicoid, (6, 6))
    samples = gm.sample(spline, normals=normals)
    found, _ = refined(helicoid, (6, 6), normals)
    outside = found.state != FOUND
    assert 0 < outside.sum() < 0.02 * len(outside)
    np.testing.assert_array_equal(found.uv[outside], samples.uv[outside])
    np.testing.assert_array_equal(found.points[outside], samples.points[outside])
    assert (np.abs(np.abs(found.uv[outside]) - [1.0, np.pi]).min(axis=1) < 0.1).all()


def test_a_place_at_the_very_border_is_inside() -> None:
    surface = gm.surfaces.enneper()
    ends = [-1.0, -0.4, 0.3, 1.0]
    uv = np.array([(u, v) for u in ends for v in (-1.0, 1.0)])
    normals = normals_of(surface, uv)
    state = np.empty(len(uv), np.int8)
    _, _, K, H = evaluate_on_surface(surface, gm.fit(surface, (16, 16)), uv)
    start = np.clip(uv + 0.003, -1.0, 1.0)
    target = Target(normals, np.sign(K), start, np.empty((len(uv), 3)), K.copy(), H, state)
    refine(surface, gm.fit(surface, (16, 16)), target, 1)
    assert (state == FOUND).all()
    np.testing.assert_allclose(start, uv, rtol=0.0, atol=1e-11)


@pytest.mark.compiled
def test_flat_points_are_reached_as_far_as_normals_tell() -> None:
    """Newton's method converges to the flat point slowly; its normal is right long before."""
    surface = gm.surfaces.monkey_saddle()
    samples, _ = refined(surface, (9, 9), np.array([[0.0, 0.0, 1.0]]))
    found = samples.state == FOUND
    assert np.abs(normals_of(surface, samples.uv[found]) - [0.0, 0.0, 1.0]).max() < NORMAL_ERROR
    assert np.abs(samples.uv).max() < 0.2


@pytest.mark.compiled
def test_the_seam_of_a_moebius_band_is_no_way_through() -> None:
    band = gm.surfaces.moebius_band()
    samples, _ = refined(band, (48, 12), gm.fibonacci(2000))
    found = samples.state == FOUND
    assert found.mean() > 0.9
    assert (normals_of(band, samples.uv[found]) * samples.normals[found]).sum(axis=1).min() > 0.5
    assert np.abs(normals_of(band, samples.uv[found]) - samples.normals[found]).max() < NORMAL_ERROR


# --- samples that meet ----------------------------------------------------------------------------


def test_samples_that_meet_are_one() -> None:
    """Normal 0 has a fold, normal 1 two places, normal 2 a pole's fold, normal 3 one contrary."""
    normal_index = np.array([0, 0, 0, 1, 1, 2, 2, 2, 3, 3])
    points = np.zeros((10, 3))
    points[4, 0] = 0.1
    states = np.full(10, FOUND)
    states[[1, 9]] = CONTRARY
    at_pole = normal_index == 2
    kept = kept_once(
        points, np.full(10, -1.0), normal_index, states == FOUND, states == CONTRARY, at_pole, 1.0
    )
    assert np.flatnonzero(~kept).tolist() == [1, 2, 6, 7]


@pytest.mark.compiled
@pytest.mark.filterwarnings("ignore:.*could not be moved")
@pytest.mark.parametrize("cells", [8, 16])
def test_folds_of_a_coarse_spline_are_no_folds_of_the_surface(cells: int) -> None:
    band, normals = gm.surfaces.moebius_band(), gm.fibonacci(3000)
    folded = gm.sample(band, normals=normals, cells=(cells, cells), on="spline")
    samples = gm.sample(band, normals=normals, cells=(cells, cells), on="surface")
    assert samples.on_surface is not None
    assert (samples.gaussian_curvature[samples.on_surface] < 0.0).all()
    assert (folded.gaussian_curvature > 0.0).any()
    there = samples.on_surface
    assert np.bincount(samples.normal_index[there]).max() <= 2
    before, after = (
        np.bincount(x.normal_index, np.sign(x.gaussian_curvature), 3000) for x in (folded, samples)
    )
    np.testing.assert_array_equal(before, after)


# --- poles ----------------------------------------------------------------------------------------


def check_once(surface: gm.Surface, cells: int, normals: Array, euler: int = 1) -> gm.Samples:
    samples = gm.sample(surface, normals=normals, cells=(cells, cells), on="surface")
    assert samples.on_surface is not None
    signs = np.sign(samples.gaussian_curvature)
    totals = np.bincount(samples.normal_index, signs, minlength=len(normals))
    assert (totals == euler).all()
    return samples


@pytest.mark.compiled
@pytest.mark.parametrize(("shift", "factor"), MOTIONS)
def test_every_normal_of_an_egg_once(shift: float, factor: float) -> None:
    surface = moved(egg, 2, shift, factor)
    assert surface.differences is not None
    normals = [gm.fibonacci(400), gm.icosphere(4)]
    for end in LATITUDES:
        normals.append(next_to(evaluate_on_surface(
            surface, gm.fit(surface, (16, 16)), np.array([[0.0, end]])
        )[1][0]))  # fmt: skip
    wanted = np.concatenate(normals)
    samples = check_once(surface, 20, wanted)
    assert len(samples) == len(wanted)
    assert samples.on_surface is not None
    assert samples.on_surface.all()
    assert (samples.gaussian_curvature > 0.0).all()
    # Far from the origin, differences tell normals to ε |x|/step of a surface of size 1.
    error = 1e-11 if shift == 0.0 else 1e-6
    away = np.abs(np.abs(samples.uv[:, 1]) - np.pi / 2) > 1e-2
    found = normals_of(moved(egg, 2, 0.0, 1.0), samples.uv[away])
    assert np.abs(found - samples.normals[away]).max() < error


@pytest.mark.compiled
def test_poles_at_the_ends_of_u() -> None:
    """The same surface with exchanged parameters has opposite normals."""
    along_v = gm.Surface.from_callable(egg, (FULL, LATITUDES), (True, "pole"))
    along_u = gm.Surface.from_callable(lambda v, u: egg(u, v), (LATITUDES, FULL), ("pole", True))
    normals = gm.fibonacci(500)
    first, second = check_once(along_v, 16, normals), check_once(along_u, 16, -normals)
    order = np.argsort(first.normal_index), np.argsort(second.normal_index)
    np.testing.assert_allclose(first.points[order[0]], second.points[order[1]], atol=1e-10)
    np.testing.assert_allclose(
        first.mean_curvature[order[0]], -second.mean_curvature[order[1]], atol=1e-6
    )


def test_curvatures_at_poles() -> None:
    """K and H at the poles of an ellipsoid: c²/(a² b²) and c (a² + b²)/(2 a² b²)."""
    a, b, c = 1.0, 0.6, 0.3
    ellipsoid = gm.surfaces.ellipsoid(a=a, b=b, c=c)
    away = np.array([0.0, 1e-14, 1e-10, 1e-8, 1e-6])
    uv = np.stack([np.full(10, 0.7), np.concatenate([np.pi / 2 - away, away - np.pi / 2])], axis=1)
    spline = gm.fit(ellipsoid, (16, 16))
    _, normals, K, H = evaluate_on_surface(ellipsoid, spline, uv)
    np.testing.assert_allclose(normals[:5, 2], 1.0, atol=1e-10)
    np.testing.assert_allclose(normals[5:, 2], -1.0, atol=1e-10)
    np.testing.assert_allclose(K, c**2 / (a * b) ** 2, rtol=1e-6)
    np.testing.assert_allclose(H, c * (a * a + b * b) / (2.0 * a * a * b * b), rtol=1e-6)


@pytest.mark.slow
@pytest.mark.compiled
@pytest.mark.parametrize(("shift", "factor"), MOTIONS)
@pytest.mark.parametrize("shape", [egg, blob])
def test_every_normal_once(
    shape: Callable[[Array, Array], Array], shift: float, factor: float
) -> None:
    normals = np.concatenate([gm.fibonacci(20_000), gm.icosphere(2)[:72]])
    samples = check_once(moved(shape, 3, shift, factor), 64, normals)
    assert shape is blob or len(samples) == len(normals)
