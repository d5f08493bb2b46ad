"""The normals for a wanted count: a cap that holds the Gaussian image, evenly filled."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density import chosen_normals
from gaussmap.tools.density.fibonacci_lattice import Lattice
from gaussmap.tools.density.shares import apportioned
from scipy.spatial.transform import Rotation

from ...products import covering
from ...shapes import EPS, moved, same

OPEN_NAMES = ["elliptic_paraboloid", "wavy_graph", "monkey_saddle", "hyperbolic_paraboloid"]
FULL_NAMES = ["torus", "sphere", "moebius_band", "catenoid", "ellipsoid_patch"]


def spline_of(name, turned):
    return gm.fit(moved(gm.surfaces.surface(name), rotation=turned), (16, 16))


def all_normals(spline, count=60):
    """Return normals over the domain, its border included."""
    u, v = (np.linspace(low, high, count) for low, high in spline.domain)
    normals = spline.normals(u[:, None], v).reshape(-1, 3)
    return normals[np.isfinite(normals).all(axis=1)]


@pytest.mark.parametrize("name", OPEN_NAMES)
@pytest.mark.parametrize(
    "seed", [None, *(pytest.param(seed, marks=pytest.mark.compiled) for seed in (0, 1, 2))]
)
def test_cap_holds_all_normals_and_little_more(name, seed):
    turned = np.eye(3) if seed is None else Rotation.random(None, seed).as_matrix()
    spline = spline_of(name, turned)
    lattice = Lattice.around(spline)
    assert np.linalg.norm(lattice.axis) == pytest.approx(1.0, abs=2 * EPS)
    least = float((all_normals(spline) @ lattice.axis).min())
    assert 0.0 < lattice.cosine <= least
    assert np.arccos(lattice.cosine) < 1.6 * np.arccos(least)


@pytest.mark.parametrize("name", FULL_NAMES)
def test_closed_surfaces_need_the_whole_sphere(name):
    lattice = Lattice.around(spline_of(name, np.eye(3)))
    assert lattice.cosine == -1.0
    assert lattice.solid_angle == pytest.approx(4 * np.pi)
    np.testing.assert_array_equal(lattice.normals(100 / (4 * np.pi)), gm.fibonacci(100))


def test_a_surface_without_normals_gets_the_whole_sphere():
    point = gm.Surface.from_callable(lambda u, v: np.zeros((*u.shape, 3)), ((0, 1), (0, 1)))
    assert Lattice.around(gm.fit(point, (4, 4))).cosine == -1.0


@covering(
    cosine=[0.999999, 0.99, 0.7, 0.3, -1.0],
    count=[1, 2, 10, 1000],
    axis=[np.array([2.0, -3.0, 6.0]) / 7.0, *np.eye(3), *-np.eye(3)],
)
def test_normals_fill_the_cap_evenly(cosine, count, axis):
    axis = axis if cosine > 0 else np.array([0.0, 0.0, 1.0])
    lattice = Lattice(axis, cosine)
    density = lattice.density_of(count)
    normals = lattice.normals(density * (1 + 1e-12))
    assert normals.shape == (count, 3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=0, atol=2 * EPS)
    cosines = normals @ axis
    assert (cosines >= cosine - 2 * EPS).all()
    # every ring of the same solid angle holds the same number
    depth = (1.0 - cosines) / (1.0 - cosine)
    np.testing.assert_allclose(np.sort(depth), (np.arange(count) + 0.5) / count, rtol=0, atol=1e-6)
    if count == 1000:
        across = normals - cosines[:, None] * axis
        assert np.linalg.norm(across.mean(axis=0)) < 3e-3 * np.linalg.norm(across, axis=1).max()
        products = normals @ normals.T
        np.fill_diagonal(products, -1.0)
        gaps = np.linalg.norm(normals - normals[products.argmax(axis=1)], axis=1)
        ideal = np.sqrt(2 / (np.sqrt(3) * density))
        assert gaps.min() > 0.65 * ideal
        assert gaps.max() < 1.3 * ideal


def test_there_is_always_one_normal():
    for lattice in (Lattice.everywhere(), Lattice(np.array([0.0, 0.0, 1.0]), 0.9)):
        assert len(lattice.normals(1e-9)) == 1
        assert lattice.normals(1e-9)[0] @ lattice.axis >= lattice.cosine


def test_density_does_not_depend_on_the_cap():
    """A smaller cap round the same axis holds the same normals: it only ends earlier."""
    axis = np.array([0.6, 0.0, 0.8])
    wide, narrow = Lattice(axis, 0.5).normals(1000.0), Lattice(axis, 0.95).normals(1000.0)
    np.testing.assert_array_equal(wide[: len(narrow)], narrow)


# --- the normals for a count of samples -----------------------------------------------------------


@pytest.mark.compiled
@covering(
    name=["torus", "wavy_graph", "moebius_band", "enneper", "helicoid"], count=[1000, 1700, 3000]
)
def test_a_count_is_met_within_a_hundredth(name, count):
    samples = gm.sample(name, count, density="gauss", cells=(24, 24), on="spline")
    assert abs(len(samples) - count) <= count / 100


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band"])
def test_a_count_is_concluded_from_a_smaller_one(name, monkeypatch):
    spline = gm.fit(gm.surfaces.surface(name))
    monkeypatch.setattr(chosen_normals, "PILOT", 2000)
    tried, find = [], chosen_normals.find

    def recorded(spline, normals, *rest):
        tried.append(len(normals))
        return find(spline, normals, *rest)

    monkeypatch.setattr(chosen_normals, "find", recorded)
    samples = gm.sample(spline, count=50_000, density="gauss")
    assert abs(len(samples) - 50_000) <= 2500
    assert 10 * max(tried) < (samples.report.normals or 0)
    chunks = gm.sample_stream(spline, count=50_000, chunk=9999)
    same(gm.Samples.concatenate(chunks), samples)


# --- dividing a count -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("count", "weights", "parts"),
    [(10, [1.0, 1.0], [5, 5]), (11, [2.0, 1.0, 1.0], [5, 3, 3]), (10, [1e9, 1.0, 0.0], [10, 0, 0]),
     (0, [1.0, 2.0], [0, 0]), (2, [1.0, 5.0, 3.0], [0, 1, 1])],
)  # fmt: skip
def test_parts_of_a_count(count, weights, parts):
    found = apportioned(count, np.array(weights))
    assert found.sum() == count
    assert np.abs(found - parts).max() <= 1
