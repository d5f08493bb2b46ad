import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density.path_order import path_order
from gaussmap.tools.density.progressive import progressive_order
from scipy.spatial import KDTree

from ...products import covering
from ...refusals import refused
from ...shapes import same


@pytest.fixture(scope="module")
def waves() -> gm.Spline:
    return gm.fit(gm.surfaces.wavy_graph(), (24, 24))


def spacings(points: np.ndarray) -> np.ndarray:
    return KDTree(points).query(points, k=7)[0][:, 1:].mean(axis=1)


def gaps(points: np.ndarray, beside: np.ndarray, first: np.ndarray) -> np.ndarray:
    """The distances of points to the nearest ones of the first, beside their spacing."""
    return KDTree(first).query(points)[0] / beside


@pytest.mark.parametrize("density", ["gauss", "balanced", "uniform"])
def test_every_beginning_is_spread_as_the_whole(waves: gm.Spline, density: str) -> None:
    # All normals of a graph are on one side, so that only distances count. Those chosen within a
    # radius r are farther apart than r, all others nearer; the next radius is r/√2. (The first
    # few are so far apart that their spacings differ by more than the grids bridge.)
    samples = gm.sample(waves, count=2_000, density=density)
    ordered = samples.progressive()
    points, beside = ordered.points, spacings(ordered.points)
    nearest = [
        np.linalg.norm(points[k] - points[:k], axis=1).min() / beside[k]
        for k in range(1, len(points))
    ]
    for count in (50, 100, 500, 1_000):
        left = gaps(points[count:], beside[count:], points[:count]).max()
        assert left <= min(nearest[: count - 1]) * np.sqrt(2.0) * (1.0 + 1e-12)


def test_the_samples_are_the_same_in_another_order() -> None:
    samples = gm.sample(gm.surfaces.torus(), count=1_000)
    ordered = samples.progressive()
    order = KDTree(samples.points).query(ordered.points)[1]
    assert np.sort(order).tolist() == list(range(1_000))
    same(samples[order], ordered)
    np.testing.assert_array_equal(samples.progressive().points, ordered.points)
    assert ordered.report is samples.report
    assert ordered.spline is samples.spline


@covering(scale=[1e-12, 1.0, 1e12], move=[0.0, 1e6])
def test_size_and_place_do_not_matter(waves: gm.Spline, scale: float, move: float) -> None:
    samples = gm.sample(waves, count=300)
    order = progressive_order(scale * (samples.points + move), samples.normals)
    assert sorted(order) == list(range(300))
    first = samples.points[order[:30]]
    assert gaps(samples.points, np.ones(300), first).max() < 0.6


@pytest.mark.parametrize("count", [0, 1, 2, 7, 8])
def test_few_samples(waves: gm.Spline, count: int) -> None:
    samples = gm.sample(waves, count=50)[:count]
    assert len(samples.progressive()) == count


@pytest.mark.kernels
def test_samples_at_one_place() -> None:
    points = np.repeat(np.arange(30.0).reshape(10, 3), 20, axis=0)
    normals = np.tile([0.0, 0.0, 1.0], (200, 1))
    order = progressive_order(points, normals)
    assert sorted(order) == list(range(200))
    assert len(np.unique(points[order[:10]], axis=0)) == 10
    assert sorted(progressive_order(np.zeros((50, 3)), normals[:50])) == list(range(50))


def test_normals_are_needed(waves: gm.Spline) -> None:
    samples = gm.sample(waves, count=50, fields=("points",))
    refused("'normals'", samples.progressive, error=gm.errors.MissingFieldError)


@pytest.mark.kernels
def test_paths_visit_each_sample_and_are_short() -> None:
    """On a grid, the shortest path has links of length 1."""
    grid = np.indices((12, 20, 1)).reshape(3, -1).T.astype(np.float64)
    grid = np.random.default_rng(0).permutation(grid)
    order = path_order(grid)
    assert sorted(order) == list(range(240))
    assert np.linalg.norm(np.diff(grid[order], axis=0), axis=1).sum() <= 1.25 * 239.0
    for few in (grid[:0], grid[:1], grid[:2], np.zeros((50, 3))):
        assert sorted(path_order(few)) == list(range(len(few)))


@pytest.mark.kernels
def test_samples_in_an_order_that_is_not_known() -> None:
    samples = gm.sample("torus", 20, cells=(8, 8))
    refused("no order of samples", samples.in_order, "tour", error=gm.errors.UnknownNameError)
