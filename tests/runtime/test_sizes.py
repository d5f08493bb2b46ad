"""Surfaces of any size that float64 holds: all is that of the surface of size 1, scaled."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ..refusals import refused

# Sizes of 1e-300, 1e-160, 1e-100, 1e100, 1e160 and 1e300, as powers of two.
EXPONENTS = [-997, -532, -332, 332, 532, 997]
# Those whose squares float64 holds, and the others.
MODERATE, EXTREME = [-332, 332], [-997, -532, 532, 997]
NORMALS = gm.icosphere(3)

Case = Callable[[int], list[Any]]


def sized(surface: gm.Surface, exponent: int) -> gm.Surface:
    """Return a surface times a power of two, moved so that no coordinate is next to zero."""

    def f(u: Any, v: Any) -> Any:
        return np.ldexp(surface.evaluate(u, v) + 2.0, exponent)

    return gm.Surface.from_callable(f, surface.domain, surface.boundary, name=surface.name)


def torus(exponent: int) -> gm.Surface:
    return sized(gm.surfaces.torus(), exponent)


def spline(exponent: int) -> gm.Spline:
    return gm.fit(torus(exponent), (12, 12))


def rows(samples: gm.Samples, exponent: int) -> list[Any]:
    """Return samples scaled back; of K only the sign, which is there however small K is."""
    return [
        np.ldexp(samples.points, -exponent), samples.normals, samples.uv,
        np.ldexp(samples.support, -exponent), np.signbit(samples.gaussian_curvature),
        np.ldexp(samples.mean_curvature, exponent), samples.normal_index, samples.patch_index,
    ]  # fmt: skip


def of_sampling(**named: Any) -> Case:
    """Return a sampling of the torus; a coverage is in units of its size."""

    def case(exponent: int) -> list[Any]:
        asked = dict(named)
        if "coverage" in asked:
            asked["coverage"] = np.ldexp(asked["coverage"], exponent)
        samples = gm.sample(spline(exponent), **asked)
        reached = samples.report.coverage or 0.0
        return [*rows(samples, exponent), np.ldexp(reached, -exponent), samples.report.angle]

    return case


def stream(exponent: int) -> list[Any]:
    parts = gm.sample_stream(spline(exponent), normals=NORMALS, chunk=50)
    return [x for part in parts for x in rows(part, exponent)]


def silhouettes(exponent: int) -> list[Any]:
    return rows(gm.silhouette(spline(exponent), (1.0, 0.3, 0.2), count=50), exponent)


def grids(exponent: int) -> list[Any]:
    u, v = np.mgrid[:6.0:12j, :6.0:12j]
    grid = gm.Surface.from_grid(np.ldexp(gm.surfaces.torus().evaluate(u, v), exponent))
    return rows(gm.sample(grid, 100), exponent)


def meshes(exponent: int) -> list[Any]:
    """Meshes of a closed surface, and of an open one, to whose border points are added."""
    open_one = sized(gm.surfaces.monkey_saddle(), exponent)
    samples = [gm.sample(spline(exponent), 200), gm.sample(open_one, 200, cells=(8, 8))]
    found = [x.mesh() for x in samples]
    coverages = [np.ldexp(x.coverage(), -exponent) for x in samples]
    return [[np.ldexp(x.vertices, -exponent), x.triangles, x.angles] for x in found] + coverages


def support_functions(exponent: int) -> list[Any]:
    length = float(np.ldexp(1.0, exponent))
    surface = gm.SupportFunction.of_spline(spline(exponent))
    found = []
    for function in (
        surface.offset(0.125 * length).translated([length] * 3),
        gm.SupportFunction.of_patch(spline(exponent).control_nets[7]),
        gm.SupportFunction.from_sympy("1 + n_x**2/4").scaled(length),
    ):
        x = function.branches(NORMALS)
        # Where float64 does not hold K, the curvatures of an offset come from the Hessian.
        mean = np.round(np.ldexp(x.mean_curvature, exponent), 12)
        found.append([
            np.ldexp(x.points, -exponent), np.ldexp(x.support, -exponent), x.normal_index,
            np.ldexp(x.hessian, -exponent), np.ldexp(x.principal_radii, -exponent),
            mean, np.signbit(x.gaussian_curvature),
        ])  # fmt: skip
    sums = gm.convolve(spline(exponent), surface, normals=gm.icosphere(1))
    return [
        *found, np.ldexp(sums.points, -exponent), np.ldexp(sums.mean_curvature, exponent),
        np.signbit(sums.gaussian_curvature),
    ]  # fmt: skip


CASES: dict[str, Case] = {
    "normals": of_sampling(normals=NORMALS),
    "count": of_sampling(count=300),
    "uniform": of_sampling(count=300, density="uniform"),
    "power of K": of_sampling(count=300, density=0.5),
    "angle": of_sampling(angle=20.0),
    "coverage": of_sampling(coverage=0.25),
    "coverage beside a count": of_sampling(count=300, coverage=0.5),
    **{x.__name__: x for x in (stream, silhouettes, grids, meshes, support_functions)},
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.quick_for("normals", "count", "uniform", "angle", "coverage", "grids")
def test_results_are_those_of_size_one_scaled(name: str) -> None:
    expected = CASES[name](0)
    for exponent in EXPONENTS:
        np.testing.assert_equal(CASES[name](exponent), expected)


@pytest.mark.parametrize("exponent", MODERATE)
def test_what_needs_squares_of_moderate_sizes(exponent: int) -> None:
    one, other = gm.sample(spline(0), 200), gm.sample(spline(exponent), 200)
    np.testing.assert_array_equal(np.ldexp(other.weights(), -2 * exponent), one.weights())
    np.testing.assert_array_equal(
        np.ldexp(other.gaussian_curvature, 2 * exponent), one.gaussian_curvature
    )
    np.testing.assert_array_equal(
        np.ldexp(other.principal_curvatures, exponent), one.principal_curvatures
    )
    moved = other.offset(np.ldexp(0.125, exponent))
    np.testing.assert_equal(rows(moved, exponent), rows(one.offset(0.125), 0))


@pytest.mark.parametrize("exponent", EXTREME)
def test_squares_that_float64_does_not_hold(exponent: int) -> None:
    """Areas and K are beyond float64 then: what needs them says so."""
    samples = gm.sample(spline(exponent), 200)
    size = "large" if exponent > 0 else "small"
    refused(f"areas of 'torus' are too {size}", samples.weights, error=gm.errors.SurfaceError)
    size = "small" if exponent > 0 else "large"
    refused(f"squares .* are too {size} for float64", samples.offset, np.ldexp(0.125, exponent))
    assert np.isnan(samples.principal_curvatures).any()
    moved = gm.sample(spline(exponent), 200, fields=("points", "normals"))
    moved = moved.offset(np.ldexp(0.125, exponent))
    expected = gm.sample(spline(0), 200).offset(0.125).points
    np.testing.assert_array_equal(np.ldexp(moved.points, -exponent), expected)


@pytest.mark.parametrize("exponent", [-997, -532])
def test_infinite_curvatures_are_reported(exponent: int) -> None:
    samples = gm.sample(spline(exponent), normals=NORMALS)
    assert samples.report.infinite_curvatures == len(samples) > 0
    assert samples.summary().endswith(
        f"K is infinite at {len(samples)} samples, where it is too large for float64"
    )
    both = gm.Samples.concatenate([samples, samples])
    assert both.report.infinite_curvatures == 2 * len(samples)
    chunk = next(gm.sample_stream(spline(exponent), normals=NORMALS, chunk=7))
    assert chunk.report.infinite_curvatures == 7
    assert gm.sample(spline(0), 200).report.infinite_curvatures == 0
    points = gm.sample(spline(exponent), 200, fields=("points",))
    assert points.report.infinite_curvatures is None


def test_singular_points_are_reported() -> None:
    samples = gm.sample(spline(0), normals=NORMALS)
    K, H = samples.gaussian_curvature.copy(), samples.mean_curvature.copy()
    K[:2], H[:2] = np.inf, np.inf
    singular = gm.Samples(gaussian_curvature=K, mean_curvature=H, report=samples.report)
    assert "K is infinite at 2 samples, where the spline is singular" in singular.summary()
    assert "infinite" not in samples.summary()


@pytest.mark.parametrize("exponent", [-997, 997])
def test_files(exponent: int, tmp_path: Path) -> None:
    samples = gm.sample(spline(exponent), 200)
    for suffix in ("npz", "ply"):
        samples.write(tmp_path / f"samples.{suffix}")
        other = gm.read_samples(tmp_path / f"samples.{suffix}")
        np.testing.assert_array_equal(other.points, samples.points)
        assert other.report == samples.report
    gm.sample(spline(exponent), 200).mesh().write(tmp_path / "mesh.stl")
    triangles = np.fromfile(tmp_path / "mesh.stl", np.uint8)[84:].reshape(-1, 50)
    normals = np.ascontiguousarray(triangles[:, :12]).view("<f4")
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)


def test_coordinates_that_cannot_be_computed_with() -> None:
    for exponent in (-1060, -1010):
        refused("too small to compute with", gm.fit, torus(exponent), error=gm.errors.SurfaceError)
    for exponent in (1005, 1020):
        refused("too large to compute with", gm.fit, torus(exponent), error=gm.errors.SurfaceError)
    with pytest.raises(gm.errors.SurfaceError, match="too large to compute with"):
        gm.gauss_map.parabolic_points(torus(1020))


@pytest.mark.parametrize(("exponent", "size"), [(332, "large"), (-332, "small")])
def test_coordinates_that_float32_does_not_hold(exponent: int, size: str) -> None:
    with pytest.raises(gm.errors.SurfaceError, match=f"too {size} for float32"):
        gm.sample(torus(exponent), 100, dtype=np.float32)
    with pytest.raises(gm.errors.SurfaceError, match=f"too {size} for float32"):
        gm.silhouette(torus(exponent), (0, 0, 1), dtype=np.float32)
    with pytest.raises(gm.errors.SurfaceError, match=f"too {size} for float32"):
        gm.sample_stream(torus(exponent), 100, dtype=np.float32)
