"""Row by row among the points of an icosahedron: the same samples as by bins, in the same order."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search.bins import NormalBins
from gaussmap.runtime.search.search import fill, find
from hypothesis import given
from hypothesis import strategies as st

INDEX_NAMES = "normal_index", "patch_index"
SURFACES = [x for x in gm.surfaces.names() if x not in ("plane", "cylinder", "cone")]


def without_rows(normals: np.ndarray) -> NormalBins:
    """Return bins that take the points of an icosahedron for any normals."""
    bins = NormalBins(normals)
    bins.__dict__["frequency"] = 0
    return bins


def assert_same(spline: gm.Spline, frequency: int) -> None:
    normals = gm.icosphere(frequency)
    bins, others = NormalBins(normals), without_rows(normals)
    assert bins.frequency == frequency
    scanned, expected = find(spline, bins), find(spline, others)
    for name in INDEX_NAMES:
        np.testing.assert_array_equal(getattr(scanned, name), getattr(expected, name))
    np.testing.assert_array_equal(scanned.exact, expected.exact)
    np.testing.assert_array_equal(scanned.exact_indices, expected.exact_indices)
    np.testing.assert_array_equal(scanned.local, expected.local)
    assert scanned.developable == expected.developable


@pytest.mark.compiled
@pytest.mark.parametrize("frequency", [1, 2, 3, 7, 40])
@pytest.mark.parametrize("cells", [(4, 3), (24, 20)])
@pytest.mark.parametrize("name", SURFACES)
def test_scan_finds_what_bins_find(name: str, cells: tuple[int, int], frequency: int) -> None:
    assert_same(gm.fit(gm.surfaces.surface(name), cells), frequency)


@pytest.mark.compiled
@given(seed=st.integers(0, 2**32 - 1), roughness=st.floats(-6, 1), frequency=st.integers(1, 30))
def test_rough_splines(seed: int, roughness: float, frequency: int) -> None:
    """From gentle waves to patches with normals all round: cones of every width."""
    rng = np.random.default_rng(seed)
    u, v = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(-1, 1, 6), indexing="ij")
    heights = 10.0**roughness * rng.standard_normal(u.shape)
    points = np.stack([u, v, heights], axis=-1) @ np.linalg.qr(rng.standard_normal((3, 3)))[0]
    ends = ("open", "open")
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
    bins, others = NormalBins(normals), without_rows(normals)
    scanned = fill(spline, bins, find(spline, bins))
    expected = fill(spline, others, find(spline, others))
    for name, values in expected.items():
        np.testing.assert_array_equal(scanned[name], values, err_msg=name)
    assert (scanned["normals"] == normals[scanned["normal_index"]]).all()
    for name in INDEX_NAMES:  # two ways to know them
        np.testing.assert_array_equal(getattr(find(spline, bins), name), scanned[name])


@pytest.mark.compiled
@pytest.mark.parametrize("size", [1, 3, 50, 10**9])
def test_hits_can_be_cut_anywhere(size: int) -> None:
    spline, normals = gm.fit(gm.surfaces.torus(), (6, 4)), gm.icosphere(12)
    bins = NormalBins(normals)
    hits = find(spline, bins)
    whole = fill(spline, bins, hits)
    starts = range(0, len(hits), size)
    parts = [fill(spline, bins, hits[start : start + size]) for start in starts]
    for name, values in whole.items():
        np.testing.assert_array_equal(np.concatenate([x[name] for x in parts]), values)
