"""How fast the spline and its samples approach the surface: orders measured, against theory.

References are the exact formulas of symbolic/surfaces.py. An order is the least-squares slope of
log(largest error) against log(cell size) over four grids.
"""

import gaussmap as gm
import numpy as np
import pytest

from ..exact import Exact
from ..shapes import Array

THREE = ["torus", "ellipsoid_patch", "wavy_graph"]
OTHERS = ["hyperboloid", "monkey_saddle", "enneper", "catenoid", "moebius_band", "dupin_cyclide"]
FAR_FROM_THE_POLES = 0.5  # radians of latitude


def random_places(name: str, count: int = 20_000, margin: float = 0.0) -> Array:
    """Return parameters, at open ends no nearer to them than `margin` of the domain."""
    surface = gm.surfaces.surface(name)
    places = np.random.default_rng(1).random((count, 2))
    for axis, ends in enumerate(surface.boundary):
        low, high = surface.domain[axis]
        inside = margin if "open" in ends else 0.0
        if "pole" in ends:
            inside = FAR_FROM_THE_POLES / (high - low)
        places[:, axis] = low + (high - low) * (inside + (1 - 2 * inside) * places[:, axis])
    return places


def order(cells: list[int], errors: list[float]) -> float:
    """Return the least-squares slope."""
    return -float(np.polyfit(np.log(cells), np.log(errors), 1)[0])


# --- the spline -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*THREE, *OTHERS, "ellipsoid", "sphere"])
@pytest.mark.quick_for("torus", "wavy_graph", "moebius_band", "sphere")
def test_positions_have_order_three_and_normals_two(name: str) -> None:
    exact, uv = Exact(name), random_places(name)
    points, normals = exact.points(uv), exact.normals(uv)
    cells, position_errors, normal_errors = [32, 64, 128, 256], [], []
    for m in cells:
        spline = gm.fit(gm.surfaces.surface(name), (m, m))
        distances = np.linalg.norm(spline.evaluate(*uv.T) - points, axis=1)
        angles = np.linalg.norm(spline.normals(*uv.T) - normals, axis=1)
        position_errors.append(float(distances.max()))
        normal_errors.append(float(angles.max()))
    assert order(cells, position_errors) == pytest.approx(3.0, abs=0.3)
    assert order(cells, normal_errors) == pytest.approx(2.0, abs=0.1)
    assert position_errors[-1] < 1e-6
    assert normal_errors[-1] < 5e-4


def test_samples_of_quadratic_graphs_are_exact() -> None:
    """Each at the point that has its normal, with its curvatures."""
    for name in ("elliptic_paraboloid", "hyperbolic_paraboloid"):
        samples = gm.sample(gm.surfaces.surface(name), count=1000, cells=(7, 9), on="spline")
        exact = Exact(name)
        np.testing.assert_allclose(samples.points, exact.points(samples.uv), rtol=0, atol=1e-14)
        np.testing.assert_allclose(samples.normals, exact.normals(samples.uv), rtol=0, atol=1e-13)
        K, H = exact.curvatures(samples.uv).T
        np.testing.assert_allclose(samples.gaussian_curvature, K, rtol=1e-11)
        np.testing.assert_allclose(samples.mean_curvature, H, rtol=0, atol=1e-11)


# --- the support function -------------------------------------------------------------------------


def support_of_samples(name: str, uv: Array, m: int) -> tuple[Array, Array]:
    """Return h at the exact normals of uv, on the sheet of uv, and how far the parameters moved."""
    surface = gm.surfaces.surface(name)
    samples = gm.sample(surface, normals=Exact(name).normals(uv), cells=(m, m), on="spline")
    low, high = np.array(surface.domain).T
    gaps = np.abs(samples.uv - uv[samples.normal_index]) / (high - low)
    closed = np.array(["open" not in ends for ends in surface.boundary])
    gaps = np.where(closed, np.minimum(gaps, 1.0 - gaps), gaps).max(axis=1)
    nearest = np.full(len(uv), np.inf)
    np.minimum.at(nearest, samples.normal_index, gaps)
    chosen = gaps == nearest[samples.normal_index]
    support = np.full(len(uv), np.nan)
    support[samples.normal_index[chosen]] = samples.support[chosen]
    return support, nearest


@pytest.mark.parametrize("name", THREE)
@pytest.mark.quick_for("torus")
def test_support_function_has_order_three(name: str) -> None:
    """At normals of points that are neither at the edge of the Gaussian image nor at a fold."""
    exact, uv = Exact(name), random_places(name, 5000, margin=0.03)
    bending = np.abs(exact.curvatures(uv)[:, 0])
    uv = uv[bending > 0.1 * bending.max()]
    h = (exact.normals(uv) * exact.points(uv)).sum(axis=1)
    cells, errors = [64, 112, 192, 320], []
    for m in cells:
        support, moved = support_of_samples(name, uv, m)
        assert moved.max() < 2.0 / m
        errors.append(float(np.abs(support - h).max()))
    assert order(cells, errors) == pytest.approx(3.0, abs=0.3)
    assert errors[0] < 5e-6


# --- the samples ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*THREE, *OTHERS, "ellipsoid", "sphere"])
@pytest.mark.quick_for("torus", "wavy_graph")
def test_samples_have_the_orders_of_the_spline_and_curvatures_order_one(name: str) -> None:
    """The surface's own normal is order two off; curvatures jump from patch to patch."""
    exact, normals, errors = Exact(name), gm.fibonacci(20_000), []
    cells = [32, 64, 128, 256]
    for m in cells:
        samples = gm.sample(gm.surfaces.surface(name), normals=normals, cells=(m, m), on="spline")
        if "pole" in gm.surfaces.surface(name).boundary[1]:
            samples = samples[np.abs(samples.uv[:, 1]) < np.pi / 2 - FAR_FROM_THE_POLES]
        K, H = exact.curvatures(samples.uv).T
        size = np.sqrt(np.abs(K).max())
        errors.append([
            np.linalg.norm(samples.points - exact.points(samples.uv), axis=1).max(),
            np.linalg.norm(samples.normals - exact.normals(samples.uv), axis=1).max(),
            np.abs(samples.gaussian_curvature - K).max() / size**2,
            np.abs(samples.mean_curvature - H).max() / size,
        ])  # fmt: skip
    distances, angles, gaussian, mean = np.transpose(errors).tolist()
    assert order(cells, distances) == pytest.approx(3.0, abs=0.3)
    assert order(cells, angles) == pytest.approx(2.0, abs=0.2)
    assert order(cells, gaussian) == pytest.approx(1.0, abs=0.35)
    assert order(cells, mean) == pytest.approx(1.0, abs=0.35)
    assert max(gaussian[-1], mean[-1]) < 0.1
