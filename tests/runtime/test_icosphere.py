"""Row by row among the points of an icosahedron: the same samples as by bins, in the same order."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.bins import NormalBins
from gaussmap.runtime.search import Hits, fill, find
from hypothesis import given, settings
from hypothesis import strategies as st

SURFACES = [x for x in gm.surfaces.names() if x not in ("plane", "cylinder", "cone")]


def by_bins(spline: gm.Spline, normals: np.ndarray) -> Hits:
    bins = NormalBins(normals)
    bins.__dict__["frequency"] = 0  # instead of the points of an icosahedron: any normals
    return find(spline, bins)


def assert_same(spline: gm.Spline, frequency: int) -> None:
    normals = gm.icosphere(frequency)
    bins = NormalBins(normals)
    assert bins.frequency == frequency
    scanned, expected = find(spline, bins), by_bins(spline, normals)
    np.testing.assert_array_equal(scanned.patch_index, expected.patch_index)
    np.testing.assert_array_equal(scanned.normal_index, expected.normal_index)
    np.testing.assert_array_equal(scanned.exact, expected.exact)
    np.testing.assert_array_equal(scanned.local, expected.local)
    assert scanned.developable == expected.developable


@pytest.mark.compiled
@pytest.mark.parametrize("frequency", [1, 2, 3, 7, 40])
@pytest.mark.parametrize("cells", [(4, 3), (24, 20)])
@pytest.mark.parametrize("name", SURFACES)
def test_scan_finds_what_bins_find(name: str, cells: tuple[int, int], frequency: int) -> None:
    assert_same(gm.fit(gm.surfaces.surface(name), cells), frequency)


@pytest.mark.compiled
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), roughness=st.floats(-6, 1), frequency=st.integers(1, 30))
def test_rough_splines(seed: int, roughness: float, frequency: int) -> None:
    """From gentle waves to patches with normals all round: cones of every width."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 6), indexing="ij")
    heights = 10.0**roughness * rng.standard_normal(u.shape)
    points = np.stack([u, v, heights], axis=-1) @ np.linalg.qr(rng.standard_normal((3, 3)))[0]
    ends = ("none", "none")
    assert_same(gm.Spline(points, ((0, 5), (0, 4)), (ends, ends), "rough"), frequency)


@pytest.mark.compiled
def test_poles_and_singular_points() -> None:
    assert_same(gm.fit(gm.surfaces.sphere(), (32, 16)), 25)
    assert_same(gm.fit(gm.surfaces.ellipsoid(), (6, 3)), 25)


def test_points_are_told_by_their_directions() -> None:
    for frequency in (1, 2, 5, 12):
        assert NormalBins(gm.icosphere(frequency)).frequency == frequency
    normals = gm.icosphere(6)
    moved, swapped, turned = normals.copy(), normals.copy(), normals.copy()
    moved[200] += [0.0, 1e-13, 0.0]
    swapped[[40, 41]] = swapped[[41, 40]]
    turned[5] *= -1
    for others in (moved, swapped, turned, normals[:-1], normals[::-1], gm.fibonacci(362)):
        assert NormalBins(np.ascontiguousarray(others)).frequency == 0


@pytest.mark.compiled
def test_samples_are_those_of_the_bins() -> None:
    spline, normals = gm.fit(gm.surfaces.torus(), (20, 12)), gm.icosphere(30)
    bins, others = NormalBins(normals), NormalBins(normals)
    others.__dict__["frequency"] = 0
    scanned = fill(spline, bins, find(spline, bins))
    expected = fill(spline, others, find(spline, others))
    for name, values in expected.items():
        np.testing.assert_array_equal(scanned[name], values, err_msg=name)
