"""Weights of samples, and the areas at the corners of triangles."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.meshes.weights import corner_areas

from ...refusals import refused
from ...shapes import TORUS


def area_of(spline: gm.Spline) -> float:
    """The area of a spline, by its own quadrature."""
    inner = spline.coefficients[1:-1, 1:-1].reshape(-1, 3)
    return float(spline.measure[0].sum() * np.sum(np.ptp(inner, axis=0) ** 2))


def errors(surface: gm.Surface, count: int, density: str, volume: float) -> np.ndarray:
    """The errors of area, volume and the integral of K, the first two relative."""
    spline = gm.fit(surface, cells=(96, 96))
    samples = gm.sample(spline, count=count, density=density)
    weights = samples.weights()
    assert (weights >= 0.0).all()
    total = (weights * samples.gaussian_curvature).sum() - spline.measure[1].sum()
    return np.abs(
        [
            weights.sum() / area_of(spline) - 1.0,
            (weights * samples.support).sum() / 3.0 / volume - 1.0,
            total / (4.0 * np.pi),
        ]
    )


@pytest.mark.quick_for("uniform")
@pytest.mark.parametrize("density", ["balanced", "uniform"])
@pytest.mark.parametrize(
    ("surface", "volume"),
    [
        (TORUS, 2.0 * np.pi**2 * 0.35**2),
        (gm.surfaces.ellipsoid(a=1.0, b=0.6, c=0.4), 4.0 / 3.0 * np.pi * 0.24),
    ],
)
def test_integrals_converge(surface: gm.Surface, volume: float, density: str) -> None:
    # Linear interpolation between samples a distance h ~ N^-1/2 apart: h² = 1/N. A triangle that
    # the normals bend has the area to h⁴. Four times the samples: 4 and 16, or half as much.
    coarse, fine = (errors(surface, count, density, volume) for count in (1_000, 16_000))
    area, volume_error, curvature = coarse / fine
    assert area > 16.0**2 / 4.0
    assert volume_error > 16.0 / 2.0
    assert fine[0] < 1e-6
    assert fine[1] < 1e-3
    assert curvature > 4.0 or fine[2] < 2e-3  # next to poles K is that of the spline


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_a_plane_is_exact(scale: float) -> None:
    plane = gm.Surface.from_sympy(
        (f"{scale}*u", f"2*{scale}*v", f"{scale}*(u + 3)"), ("u", "v"), ((0, 1), (0, 1))
    )
    samples = gm.sample(plane, count=200)
    exact = 2.0 * np.sqrt(2.0) * scale**2
    # Sums of some hundred areas, each rounded a few times.
    assert samples.weights().sum() == pytest.approx(exact, rel=1e-12)
    # Barycentric weights: linear functions come out exactly where no border vertices are merged.
    centre = (samples.weights()[:, None] * samples.points).sum(axis=0) / exact
    np.testing.assert_allclose(centre / scale, [0.5, 1.0, 3.5], atol=0.01)


def test_areas_that_numbers_do_not_hold_are_refused() -> None:
    usual = gm.sample(TORUS, 300, cells=(16, 16)).weights()
    for scale, said in ((2.0**540, "too large"), (2.0**-540, "too small"), (2.0**-450, "")):
        samples = gm.sample(gm.surfaces.torus(major=scale, minor=0.35 * scale), 300, cells=(16, 16))
        if said:
            refused(f"are {said} for float64", samples.weights, error=gm.errors.SurfaceError)
        else:
            np.testing.assert_allclose(samples.weights() / scale / scale, usual, rtol=1e-9)


@pytest.mark.parametrize("name", ["moebius_band", "catenoid", "sphere", "cone"])
def test_all_kinds_of_surfaces(name: str) -> None:
    spline = gm.fit(getattr(gm.surfaces, name)())
    samples = gm.sample(spline, count=3_000)
    assert samples.weights().sum() == pytest.approx(area_of(spline), rel=2e-3)


def test_samples_at_one_place_share_a_weight() -> None:
    samples = gm.sample(TORUS, count=500)
    twice = gm.Samples.concatenate([samples, samples])
    weights = twice.weights()
    np.testing.assert_allclose(weights[:500] + weights[500:], samples.weights(), rtol=1e-12)
    assert (np.minimum(weights[:500], weights[500:]) == 0.0).all()


def test_a_part_of_a_surface_needs_an_angle() -> None:
    samples = gm.sample(TORUS, count=2_000)
    half = samples[samples.points[:, 0] > 0.0]
    assert half.weights(angle=30.0).sum() == pytest.approx(samples.weights().sum() / 2.0, rel=0.1)


# --- the areas over single triangles --------------------------------------------------------------

CORNERS = np.array([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.0, 4.0, 0.0)])


def areas_of(points: np.ndarray, normals: np.ndarray, sides: tuple[int, int, int]) -> np.ndarray:
    return corner_areas(points, normals, np.array([[0, 1, 2]]), np.array([sides]))[0]


@pytest.mark.kernels
@pytest.mark.parametrize("sides", [(1, 1, 1), (1, -1, 1), (-1, -1, -1)])
def test_a_flat_triangle_is_shared_evenly(sides: tuple[int, int, int]) -> None:
    normals = np.array(sides)[:, None] * (0.0, 0.0, 1.0)
    assert areas_of(CORNERS, normals, sides) == pytest.approx(np.full(3, 2.0), rel=1e-15)


@pytest.mark.kernels
def test_a_triangle_is_flat_whose_normals_are_more_than_a_right_angle_apart() -> None:
    normals = np.array([(0.6, 0.0, 0.8), (-0.8, 0.0, 0.6), (-1.0, 0.0, 0.0)])
    assert areas_of(CORNERS, normals, (1, 1, 1)) == pytest.approx(np.full(3, 2.0), rel=1e-15)
