"""How many samples come, which ones, in which order, and how dense they are where."""

import math
from dataclasses import replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density import candidates, space
from gaussmap.tools.density.methods import space_on
from gaussmap.tools.density.path_order import path_order
from gaussmap.tools.density.progressive import progressive_order
from scipy.spatial import KDTree

from ...products import covering
from ...refusals import refused
from ...shapes import TORUS, klein_bottle, same

DENSITIES = ["balanced", "uniform", 0.5, 1.0, 3.0]
# Dents of a plane, so that all kinds of points are there, and flat parts between them.
DENTS = gm.Surface.from_callable(
    lambda u, v: np.stack([u, v, 0.2 * np.exp(-8 * ((u + 0.5) ** 2 + v * v))], axis=-1),
    ((-1.0, 1.0), (-1.0, 1.0)),
)


# --- how many -------------------------------------------------------------------------------------


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("name", [*gm.surfaces.names(), "klein bottle"])
@pytest.mark.quick_for("torus", "plane", "monkey_saddle")
def test_counts_are_exact(name, density):
    surface = klein_bottle() if name == "klein bottle" else gm.surfaces.surface(name)
    for cells in ((4, 3), (16, 16)):
        spline = gm.fit(surface, cells)
        for count in (1, 2, 3, 10, 300):
            samples = gm.sample(spline, count=count, density=density)
            assert len(samples) == samples.report.samples == count
            for field in samples.fields:
                assert np.isfinite(getattr(samples, field)).all()


@pytest.mark.parametrize("density", DENSITIES)
def test_samples_lie_on_the_spline(density):
    spline = gm.fit(DENTS, (9, 8))
    samples = gm.sample(spline, count=200, density=density)
    at_uv = spline.evaluate(*samples.uv.T)
    np.testing.assert_allclose(samples.points, at_uv, rtol=0, atol=1e-14)
    normals = spline.normals(*samples.uv.T)
    np.testing.assert_allclose(samples.normals, normals, rtol=0, atol=1e-9)
    lengths = np.linalg.norm(samples.normals, axis=1)
    np.testing.assert_allclose(lengths, 1.0, rtol=0, atol=4 * np.finfo(float).eps)
    support = (samples.points * samples.normals).sum(axis=1)
    np.testing.assert_allclose(samples.support, support, rtol=0, atol=1e-14)


@pytest.mark.parametrize("density", ["gauss", "uniform"])
def test_samples_on_a_spline_have_its_curvatures(density):
    """By its 2-jets, where K has one sign and the other; H is positive where it is convex."""
    spline = gm.fit(gm.surfaces.torus(major=70.0, minor=20.0), (9, 8))
    samples = gm.sample(spline, count=300, density=density)
    s, t = np.modf((samples.uv - spline.frame[:2]) / spline.frame[2:])[0].T
    inside = np.min([s, t, 1.0 - s, 1.0 - t, abs(s - t), abs(s + t - 1.0)], axis=0) > 1e-6
    assert inside.sum() > 100  # of a patch: there are two curvatures at an edge
    samples = samples[inside]
    (piece,) = space_on(spline, None, None).pieces
    (_, x_u, x_v, *seconds) = np.moveaxis(piece.jets(*samples.uv.T.copy()), 1, 0)
    e, f, g = (-np.einsum("kx,kx->k", x, samples.normals) for x in seconds)
    E, F, G = (np.einsum("kx,kx->k", x, y) for x, y in ((x_u, x_u), (x_u, x_v), (x_v, x_v)))
    K = (e * g - f * f) / (E * G - F * F)
    H = (e * G - 2.0 * f * F + g * E) / (2.0 * (E * G - F * F))
    assert (K > 0.0).any()
    assert (K < 0.0).any()
    largest = (H**2 - K).max() + (H**2).max()
    np.testing.assert_allclose(samples.gaussian_curvature, K, rtol=0, atol=1e-9 * largest)
    np.testing.assert_allclose(samples.mean_curvature, H, rtol=0, atol=1e-9 * largest**0.5)


# --- which ones -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band", "ellipsoid"])
@pytest.mark.quick_for("torus", "moebius_band")
def test_all_samples_of_the_normals_are_kept(name):
    spline = gm.fit(gm.surfaces.surface(name), (16, 16))
    for normals in (gm.icosphere(8), gm.fibonacci(500)):
        samples = gm.sample(spline, normals=normals, density="balanced")
        plain = gm.sample(spline, normals=normals, fields=samples.fields)
        same(samples[: len(plain)], plain)
        assert len(samples) > len(plain)
        assert (samples.kind[: len(plain)] == "normal").all()
        assert (samples.kind[len(plain) :] == "filling").all()
        assert (samples.normal_index[len(plain) :] == -1).all()
        assert samples.report.normals == len(normals)
        assert (plain.kind == "normal").all()


@pytest.mark.parametrize("asked", [{"count": 300}, {"angle": 15.0}, {"coverage": 0.3}])
def test_samples_of_normals_come_first(asked):
    samples = gm.sample(gm.fit(TORUS, (12, 12)), **asked)
    given = int((samples.kind == "normal").sum())
    assert 0 < given < len(samples)
    assert (samples.kind[:given] == "normal").all()
    pairs = samples.normal_index[:given] * 10**9 + samples.arrays()["patch_index"][:given]
    assert (np.diff(pairs) > 0).all()


@pytest.mark.parametrize("density", ["uniform", 1.0])
def test_covers_alone_answer_no_normals(density):
    samples = gm.sample(gm.fit(TORUS, (8, 8)), count=100, density=density)
    assert (samples.kind == "filling").all()
    assert samples.report.normals == 0


@pytest.mark.parametrize(
    "asked",
    [
        {"count": 700}, {"angle": 9.0}, {"count": 900, "coverage": 0.12},
        {"count": 700, "density": "uniform"}, {"count": 700, "density": "aligned"},
        {"count": 500, "density": 0.7}, {"coverage": 0.1},
        {"normals": gm.icosphere(5), "density": "balanced"},
    ],
)  # fmt: skip
@pytest.mark.quick_for("asked0")
def test_the_same_for_any_number_of_threads(asked: dict[str, Any], monkeypatch):
    monkeypatch.setattr(space, "CELLS_AT_A_TIME", 100)
    monkeypatch.setattr(candidates, "PART", 1 << 9)
    for surface in (TORUS, DENTS):
        expected = gm.sample(surface, threads=1, **asked)
        for threads in (2, 3):
            found = gm.sample(surface, threads=threads, **asked)
            same(found, expected)
            assert found.report == expected.report


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "plane"])
@pytest.mark.quick_for("torus")
def test_parts_make_covers_hardly_worse(name, monkeypatch):
    """Parts of 1,000 places meet in borders, where they do not always know of one another."""
    spline = gm.fit(gm.surfaces.surface(name), (32, 32))
    whole = gm.sample(spline, coverage=0.05, density="uniform")
    monkeypatch.setattr(candidates, "PART", 1000)
    parts = gm.sample(spline, coverage=0.05, density="uniform")
    assert (parts.report.coverage or 1.0) <= 0.05
    assert abs(len(parts) - len(whole)) <= 0.08 * len(whole)


# --- what they hold -------------------------------------------------------------------------------


@covering(
    fields=[("points",), ("normal_index", "uv"), ("normals", "support")],
    dtype=[np.float32, np.float64],
)
def test_fields_and_types(fields, dtype):
    spline = gm.fit(TORUS, (8, 8))
    whole = gm.sample(spline, count=200)
    part = gm.sample(spline, count=200, fields=fields, dtype=dtype)
    assert set(part.fields) == set(fields)
    for name in fields:
        expected = getattr(whole, name)
        expected = expected if name == "normal_index" else expected.astype(dtype)
        assert getattr(part, name).tobytes() == expected.tobytes()
    # Without the curvatures nobody knows which of them are infinite.
    assert part.report == replace(whole.report, infinite_curvatures=None)


# --- how dense ------------------------------------------------------------------------------------


@pytest.mark.parametrize("alpha", [0.25, 0.5, 1.0, 1.5])
@pytest.mark.quick_for("0.25", "1.5")
def test_density_is_a_power_of_the_curvature(alpha):
    """On a torus, K dA = cos v du dv and dA = r (R + r cos v) du dv: counts of two bands of v.

    N samples of a cover, none of them nearer than its radius, differ from the integral by what the
    borders of a band hold: a row of them at each of four borders, of one sample per radius each.
    """
    R, r, count = 1.0, 0.35, 20_000
    samples = gm.sample(gm.fit(TORUS, (128, 128)), count=count, density=alpha)
    v = np.angle(np.exp(1j * samples.uv[:, 1]))

    def wanted(low: float, high: float) -> float:
        x = np.linspace(low, high, 2001)
        K = np.cos(x) / (r * (R + r * np.cos(x)))
        return float(np.trapezoid(np.abs(K) ** alpha * (R + r * np.cos(x)), x))

    bands = [(0.0, 0.4), (0.8, 1.2), (2.6, 3.0)]
    counts = [int(((np.abs(v) > low) & (np.abs(v) < high)).sum()) for low, high in bands]
    shares = [wanted(low, high) for low, high in bands]
    whole = wanted(0.0, math.pi)
    for found, share in zip(counts, shares, strict=True):
        expected = count * share / whole
        width = 0.4 * r  # of a band; a row is a spacing wide
        spacing = math.sqrt(2 * math.pi * R * width * 2 / expected)
        assert abs(found - expected) <= expected * 2 * spacing / width


@pytest.mark.parametrize("count", [500, 5000])
def test_uniform_goes_by_area(count):
    """Not by parameters: with x = u³, half of the cells have an eighth of the area.

    Where no sample is nearer to another than r, and there is no room for one more, there are
    between 0.385 (hexagons as wide as can be) and 1.155 (as dense as can be) of them for an r².
    """
    surface = gm.Surface.from_callable(
        lambda u, v: np.stack([u**3, v, 0 * u], axis=-1), ((-1.0, 1.0), (0.0, 1.0))
    )
    samples = gm.sample(surface, count=count, density="uniform", cells=(40, 20))
    inner = int((np.abs(samples.uv[:, 0]) < 0.5).sum())
    assert 1 / 3 < 7 * inner / (count - inner) < 3


def test_balanced_is_dense_where_it_bends_and_not_blind_where_it_is_flat():
    """A cylinder beside a plane: κ² against λ, which is 0.8 of the mean of κ²."""
    radius, flat = 0.5, 4.0

    def profile(u, v):
        s = np.clip(u, 0.0, math.pi * radius)
        x = radius * np.sin(s / radius) + np.minimum(u, 0.0)
        z = radius * (1.0 - np.cos(s / radius))
        return np.stack([x, v, z], axis=-1)

    surface = gm.Surface.from_callable(profile, ((-flat, math.pi * radius), (0.0, 3.0)))
    samples = gm.sample(surface, count=4000, cells=(256, 16))
    length, k = math.pi * radius, 1.0 / radius**2
    floor = 0.8 * k * length / (length + flat)
    bent = samples.uv[:, 0] > 0.0
    expected = k * length / (k * length + floor * flat)
    rows = 2 * 3.0 * math.sqrt(4000 * k / (3.0 * (k * length + floor * flat)))
    assert abs(bent.sum() - 4000 * expected) <= 2 * rows  # one between them, and the outer ones
    assert (~bent).sum() > 300


def test_a_surface_without_curvature_is_covered_evenly_by_any_power():
    spline = gm.fit(gm.surfaces.cylinder(), (8, 6))
    uniform = gm.sample(spline, count=100, density="uniform")
    same(gm.sample(spline, count=100, density=2.0), uniform)


@pytest.mark.parametrize("alpha", [0.5, 1.0, 4.0])
def test_gaps_of_a_power_are_bounded_where_the_surface_is_flat(alpha):
    """A dent in a strip that is 120,000 times as long as it is wide.

    On average, n samples in an area A cover it within r = √(0.6 A/n). In the strip neighbours are
    between 1 and 2 times 1,000 r apart: 7 to 14 samples.
    """
    length, count = 0.2 * math.sinh(14.0), 1000

    def dented(u, v):
        x = 0.1 * np.sinh(14.0 * u)
        return np.stack([x, v + 0.0 * x, 0.3 * np.exp(-4.0 * (x * x + v * v))], axis=-1)

    surface = gm.Surface.from_callable(dented, ((-1.0, 1.0), (-0.5, 0.5)))
    samples = gm.sample(surface, count, density=alpha, cells=(160, 16))
    most = length / (1000.0 * math.sqrt(0.6 * length / count))
    assert most / 2.0 < (np.abs(samples.points[:, 0]) > 5.0).sum() < most


def test_nothing_warns_of_what_is_covered():
    for name in ("plane", "cylinder", "cone"):
        samples = gm.sample(gm.surfaces.surface(name), count=60, cells=(12, 12))
        assert samples.report.developable_share == pytest.approx(1.0)


def test_a_count_is_divided_well():
    """With fewer samples at normals, angles are wider; with more, gaps are."""
    samples = gm.sample("catenoid", 1000, cells=(32, 32))
    deviation = samples.normal_deviation()
    assert deviation.space < 4.53
    assert deviation.normal_space < 4.4


# --- requests, and those that are refused ---------------------------------------------------------

PLANE = gm.fit(gm.surfaces.plane(), (3, 3))
BAD_NUMBERS = [0, 0.0, -1.0, np.nan, np.inf, "3", True, [1.0]]


def is_refused(match: str, error: type[Exception] = gm.errors.InputError, **asked: Any) -> None:
    def many() -> object:
        return next(gm.sample_many([PLANE], progress=False, **asked))

    refused(match, gm.sample, PLANE, **asked, error=error)
    refused(match, many, error=error)


def use(what: str) -> str:
    return rf"does not go with .*; use {what}\."


COVERAGE, COUNT = use("count or coverage"), use("count")
ANGLE = "angle must be a positive number of at most 90 degrees, not"
POWER = "density, as the power of .K., must be a positive number"
NO_POWERS = [0, -0.5, np.nan, np.inf, True, [1.0], 9.0]


@pytest.mark.kernels
@pytest.mark.parametrize(
    ("asked", "said"),
    [
        *(({"coverage": x}, "coverage must be a positive number, not") for x in BAD_NUMBERS),
        *(({"count": 5, "coverage": x}, "coverage must be a positive") for x in BAD_NUMBERS),
        *(({"angle": x}, ANGLE) for x in BAD_NUMBERS),
        ({"angle": 90.1}, f"{ANGLE} 90.1"),
        *(({"count": 5, "density": x}, POWER) for x in NO_POWERS),
        ({"density": "gauss", "coverage": 0.1}, use("normals or count")),
        ({"density": "gauss", "angle": 4.0}, use("normals or count")),
        ({"density": "gauss", "count": 9, "coverage": 0.1}, use("normals or count")),
        ({"density": "uniform", "angle": 5.0}, COVERAGE),
        ({"density": "uniform", "count": 5, "coverage": 1.0}, COVERAGE),
        ({"density": "uniform", "normals": [[0, 0, 1]]}, COVERAGE),
        ({"density": "aligned", "normals": [[0, 0, 1]]}, use("count or angle or coverage")),
        ({"density": 0.5, "coverage": 0.1}, COUNT),
        ({"density": 0.5, "normals": [[0, 0, 1]]}, COUNT),
    ],
)
def test_what_cannot_be_asked_for(asked: dict[str, Any], said: str):
    is_refused(said, **asked)


@pytest.mark.kernels
def test_densities_that_are_unknown():
    unknown = "no density 'gaus'.* did you mean gauss"
    is_refused(unknown, gm.errors.UnknownNameError, count=5, density="gaus")


def test_defaults():
    """Normals alone give the paper's density, all else is balanced."""
    torus = gm.fit(gm.surfaces.torus(), (8, 8))
    assert set(gm.sample(torus, normals=gm.icosphere(4)).kind) == {"normal"}
    amounts: list[dict[str, Any]] = [{"count": 100}, {"angle": 20.0}, {"coverage": 0.4}]
    for asked in amounts:
        assert set(gm.sample(torus, **asked).kind) == {"normal", "filling"}


# --- progressive order ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def waves() -> gm.Spline:
    return gm.fit(gm.surfaces.wavy_graph(), (24, 24))


def spacings(points: np.ndarray) -> np.ndarray:
    return KDTree(points).query(points, k=7)[0][:, 1:].mean(axis=1)


def gaps(points: np.ndarray, beside: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Return distances of points from the nearest of the first points, relative to a spacing."""
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
