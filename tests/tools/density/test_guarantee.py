"""No point of a surface is too far from a sample, whatever density, surface, size or place."""

import math
from collections.abc import Callable

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density import cover, deviation, filling
from gaussmap.tools.density.cells import Cells
from gaussmap.tools.density.space import Space
from scipy.spatial import KDTree

from ...products import covering
from ...refusals import refused
from ...shapes import Array, farthest, moved, widest_angle

pytestmark = pytest.mark.compiled


def places(spline: gm.Spline, number: int = 200) -> tuple[Array, Array]:
    """Return points and normals of number² places of a spline, its border included."""
    u, v = (np.linspace(low, high, number) for low, high in spline.domain)
    points, normals = spline.evaluate(u[:, None], v), spline.normals(u[:, None], v)
    regular = np.isfinite(normals).all(axis=2)
    return points[regular], normals[regular]


def even(name: str, cells: tuple[int, int]) -> tuple[int, int]:
    """Return cells that suit a surface with poles, too."""
    poles = "pole" in gm.surfaces.surface(name).boundary[1]
    return (cells[0] + cells[0] % 2, cells[1]) if poles else cells


# --- coverage -------------------------------------------------------------------------------------


@covering(cells=[(3, 3), (24, 20)], name=gm.surfaces.names())
def test_coverage_is_kept_and_reported(name, cells):
    spline = gm.fit(gm.surfaces.surface(name), even(name, cells))
    points, _ = places(spline)
    size = float(np.ptp(points, axis=0).max())
    for density in ("balanced", "uniform"):
        asked = 0.08 * size
        samples = gm.sample(spline, coverage=asked, density=density)
        found = farthest(samples, points)
        assert found <= (samples.report.coverage or 0.0) * (1 + 1e-12) <= asked * (1 + 1e-12)
        assert found > 0.4 * asked  # and not by far too many samples


@pytest.mark.parametrize("density", ["balanced", "uniform", 0.5, 2.0])
@pytest.mark.parametrize("name", gm.surfaces.names())
@pytest.mark.quick_for("torus")
def test_the_coverage_of_samples_is_10_percent_off_at_most(name, density):
    """The places are a grid: a point may be half its diagonal farther than they are."""
    spline = gm.fit(gm.surfaces.surface(name), even(name, (12, 10)))
    points, _ = places(spline, 500)
    lines = (np.linspace(low, high, 500) for low, high in spline.domain)
    grid = spline.evaluate(*np.meshgrid(*lines, indexing="ij"))
    steps = (np.linalg.norm(np.diff(grid, axis=axis), axis=2).max() for axis in (0, 1))
    samples = gm.sample(spline, count=400, density=density)
    found, reported = farthest(samples, points), samples.coverage()
    assert found <= reported <= 1.1 * (found + math.hypot(*steps) / 2)


@pytest.mark.parametrize(
    ("factor", "shift"),
    [(1e-12, 0.0), (1e12, 0.0), (2.0**-300, 0.0), (2.0**300, 0.0), (1.0, 1e6)],
)
@pytest.mark.parametrize("name", ["torus", "cone", "wavy_graph", "cylinder", "plane"])
@pytest.mark.quick_for("torus", "1000000.0")
def test_any_unit_of_length_and_place(name, factor, shift):
    """A million times its size away, coordinates are rounded to 1e-10: no more is lost."""
    spline = gm.fit(moved(gm.surfaces.surface(name), factor, shift), (12, 12))
    points, normals = places(spline)
    by_coverage = gm.sample(spline, coverage=0.3 * factor)
    assert farthest(by_coverage, points) <= 0.3 * factor + 1e-15 * shift
    assert widest_angle(gm.sample(spline, angle=10.0), normals) <= 10.0
    assert len(gm.sample(spline, count=300)) == 300
    if math.frexp(factor)[0] == 0.5 and not shift:  # a power of two changes no bit
        plain = gm.sample(name, coverage=0.3, cells=(12, 12), on="spline")
        assert (plain.points * factor == by_coverage.points).all()
        assert plain.report.coverage == (by_coverage.report.coverage or 0.0) / factor


def test_both_sides_of_a_thin_plate_are_covered():
    """A sheet folded back at a distance of 1e-3: samples of one side do not cover the other."""
    gap = 1e-3

    def folded(u, v):
        turn = math.pi * gap / 2
        s = np.clip(np.abs(u), 0.0, turn) / turn  # along half of the fold
        angle = np.sign(u) * s * math.pi / 2
        straight = np.maximum(np.abs(u) - turn, 0.0)
        return np.stack(
            [gap / 2 * np.cos(angle) - straight, v + 0.0 * u, gap / 2 * np.sin(angle)], axis=-1
        )

    plate = gm.Surface.from_callable(folded, ((-1.0, 1.0), (0.0, 1.0)))
    spline = gm.fit(plate, (400, 10))
    points, normals = places(spline, 300)
    samples = gm.sample(spline, coverage=0.1)
    for side in (-1.0, 1.0):
        flat = np.abs(normals[:, 2] - side) < 1e-3
        mine = samples[samples.normals[:, 2] * side > 0]
        assert flat.sum() > 10_000
        assert farthest(mine, points[flat]) <= 0.1


# --- bending --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["sphere", pytest.param("torus", marks=pytest.mark.slow), "cylinder", "plane"]
)
@pytest.mark.parametrize("angle", [3.0, 12.0])
@pytest.mark.quick_for("12.0")
def test_no_point_is_farther_than_bending_allows(name, angle):
    """|x − s| κ <= r, which is twice the angle, where κ is the same everywhere."""
    radii = {"sphere": 1.0, "torus": 0.35, "cylinder": 1.0, "plane": math.inf}
    spline = gm.fit(gm.surfaces.surface(name))
    points, _ = places(spline, 400)
    if name == "sphere":  # beside a pole, curvatures of the spline are accidents
        points = points[np.abs(points[:, 2]) < 0.9]
    samples = gm.sample(spline, angle=angle)
    radius, least = 2.0 * math.radians(angle), 4 * math.pi
    inner = spline.coefficients[1:-1, 1:-1].reshape(-1, 3)
    area = float(spline.measure[0].sum() * np.square(np.ptp(inner, axis=0)).sum())
    # κ of the spline is off by its cells (order 1): 64 of them in 2π allow 2 % and some
    allowed = 1.1 * radii[name] * radius if name != "plane" else math.inf
    bending = area / radii[name] ** 2
    floor = max(bending, least) / area / 4
    assert farthest(samples, points) <= min(allowed, 1.01 * radius / math.sqrt(floor))


def with_angle(spline: gm.Spline, angle: float, number: int = 700) -> gm.Samples:
    """Return samples for an angle, which is kept everywhere."""
    samples = gm.sample(spline, angle=angle)
    kept = widest_angle(samples, places(spline, number)[1])
    assert kept <= (samples.report.angle or 0.0) <= angle
    return samples


@pytest.mark.parametrize("angle", [2.5, 10.0])
@pytest.mark.parametrize("name", gm.surfaces.names())
@pytest.mark.quick_for("torus", "monkey_saddle")
def test_angle_is_kept_everywhere(name, angle):
    """Border and poles included: there, no normals of the sphere need to lie inside the image."""
    spline = gm.fit(gm.surfaces.surface(name), (32, 32))
    samples = with_angle(spline, angle, 300)
    assert samples.coverage() >= farthest(samples, places(spline)[0])


def test_what_was_not_asked_is_not_reported():
    torus = gm.surfaces.torus()
    for samples in (gm.sample(torus, count=50), gm.sample(torus, normals=gm.icosphere(4))):
        assert (samples.report.angle, samples.report.coverage) == (None, None)


# --- what goes together ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "cylinder", "moebius_band"])
def test_coverage_beside_normals_and_angle(name):
    spline = gm.fit(gm.surfaces.surface(name), (24, 24))
    points, normals = places(spline)
    by_normals = gm.sample(spline, normals=gm.icosphere(6), coverage=0.2, density="balanced")
    assert farthest(by_normals, points) <= 0.2
    by_angle = gm.sample(spline, angle=25.0, coverage=0.1)
    assert farthest(by_angle, points) <= 0.1
    assert widest_angle(by_angle, normals) <= 25.0
    assert len(by_angle) > len(gm.sample(spline, angle=25.0))


@pytest.mark.parametrize("name", ["torus", "cylinder", "helicoid", "wavy_graph"])
@pytest.mark.quick_for("torus", "cylinder")
def test_coverage_beside_a_count(name):
    spline = gm.fit(gm.surfaces.surface(name), (24, 24))
    points, _ = places(spline)
    alone = gm.sample(spline, count=1500)
    reached = alone.coverage()
    easy = gm.sample(spline, count=1500, coverage=2.0 * reached)
    assert (easy.points == alone.points).all()  # what was there anyway
    least = gm.sample(spline, coverage=0.95 * reached, density="uniform")
    if len(least) < 1200:
        tight = gm.sample(spline, count=1500, coverage=0.95 * reached)
        assert len(tight) == 1500
        assert farthest(tight, points) <= 0.95 * reached
    with pytest.warns(gm.GaussmapWarning, match="the coverage is .* instead of the requested"):
        hopeless = gm.sample(spline, count=100, coverage=0.01 * reached)
    assert len(hopeless) == 100
    assert farthest(hopeless, points) <= (hopeless.report.coverage or 0.0)


# --- too much and too little ----------------------------------------------------------------------


@pytest.mark.parametrize("coverage", [1e-9, 1e-100, 5e-324])
def test_what_would_need_too_many_samples_is_refused(coverage):
    spline = gm.fit(gm.surfaces.torus(), (8, 8))
    for density in ("balanced", "uniform"):
        how = {"coverage": coverage, "density": density}
        refused("in more than 2e\\+09 places; ask for a larger", gm.sample, spline, **how)
    refused("in more than 2e\\+09 places", gm.sample, spline, angle=30.0, coverage=coverage)
    with pytest.warns(gm.GaussmapWarning, match="the coverage is .* instead of the requested"):
        assert len(gm.sample(spline, count=50, coverage=coverage)) == 50
    refused(r"angle must be at least 0\.0044 degrees, not ", gm.sample, spline, angle=coverage)


@pytest.mark.parametrize("coverage", [10.0, 1e300])
def test_more_than_the_size_of_a_surface_asks_for_a_few_samples(coverage):
    spline = gm.fit(gm.surfaces.torus(), (8, 8))
    for density in ("balanced", "uniform"):
        samples = gm.sample(spline, coverage=coverage, density=density)
        assert 1 <= len(samples) < 10
        assert (samples.report.coverage or math.inf) < 3.0
    assert len(gm.sample(spline, count=50, coverage=coverage)) == 50


@pytest.mark.parametrize(("name", "area"), [("sphere", 4.0 * math.pi), ("torus", 1.4 * math.pi**2)])
def test_a_coverage_takes_few_samples(name, area):
    """1.9 times as many as a hexagonal lattice with this covering radius has.

    It is 2.2 times if the smallest cells around uncovered points are twice as large.
    """
    samples = gm.sample(gm.fit(name, (16, 16)), coverage=0.05, density="uniform")
    lattice = 2.0 * area / (3.0 * math.sqrt(3.0) * 0.05**2)
    assert len(samples) < 2.05 * lattice


# --- memory ---------------------------------------------------------------------------------------


@pytest.fixture
def cut(monkeypatch) -> list[int]:
    """Return how many cells at a time are cut from now on."""
    numbers: list[int] = []

    def counted(cut: Callable[[Space, Cells], Cells]) -> Callable[[Space, Cells], Cells]:
        def counting(space: Space, cells: Cells) -> Cells:
            numbers.append(len(cells))
            return cut(space, cells)

        return counting

    for name in ("halves", "quarters"):
        monkeypatch.setattr(Space, name, counted(getattr(Space, name)))
    return numbers


def test_few_cells_are_bisected_at_a_time(cut, monkeypatch):
    """All at once took three times the memory; in blocks the surface is covered as well."""
    monkeypatch.setattr(filling, "coverage", lambda *_: 0.0)
    monkeypatch.setattr(cover, "BLOCK", 500)
    spline = gm.fit("torus", (16, 16))
    samples = gm.sample(spline, density="uniform", coverage=0.1)
    assert 100 < max(cut) <= 500 < sum(cut)
    assert farthest(samples, places(spline)[0]) <= 0.1
    assert len(samples) < 1000  # 958 with all at once


def test_few_cells_are_searched_for_wide_angles_at_a_time(cut, monkeypatch):
    samples = gm.sample(gm.fit("wavy_graph", (16, 16)), 300)
    whole = samples.normal_deviation()
    most = max(cut)
    monkeypatch.setattr(deviation, "BLOCK", most // 4)
    cut.clear()
    assert samples.normal_deviation() == whole
    assert max(cut) == most // 4


def test_an_angle_that_is_just_reached_is_reported_as_it_was_asked():
    """Next to a singular point that is the bound of angles; its rounding was warned of."""
    assert gm.sample(singular("umbrella", (20, 20)), angle=24.0).report.angle == 24.0


# --- the coverage of any samples ------------------------------------------------------------------


def test_the_coverage_of_samples_from_normals():
    """The poles of a sphere that is seen from two sides: a quarter of a great circle away."""
    sphere = gm.fit(gm.surfaces.sphere())
    samples = gm.sample(sphere, normals=[[1, 0, 0], [-1, 0, 0]])
    assert math.sqrt(2) - 1e-3 <= samples.coverage() <= 1.1 * math.sqrt(2) + 1e-3
    assert samples.coverage(threads=1) == samples.coverage(threads=3)
    assert samples[:0].coverage() == math.inf


# The normal field vanishes on a line, in a point; the spline is folded along curves.
SINGULAR = {
    "cuspidal edge": lambda u, v: (u, v**2, v**3),
    "tilted edge": lambda u, v: (u + 0.3 * v, (v - 0.2 * u) ** 2, (v - 0.2 * u) ** 3 + 0.1 * u * u),
    "swallowtail": lambda u, v: (u, u * v**2 + 3 * v**4, 2 * u * v + 4 * v**3),
    "umbrella": lambda u, v: (u, v**2, u * v),
    # There is no normal, and none is looked for again and again.
    "half a line": lambda u, v: (u, np.maximum(v, 0.0), 0.1 * np.maximum(v, 0.0) ** 2),
}


def singular(name: str, cells: tuple[int, int]) -> gm.Spline:
    def position(u, v):
        return np.stack(np.broadcast_arrays(*SINGULAR[name](u, v)), axis=-1)

    return gm.fit(gm.Surface.from_callable(position, ((-1.0, 1.0), (-1.0, 1.0))), cells)


@pytest.mark.parametrize("cells", [(20, 20), (20, 21)])
@pytest.mark.parametrize("name", SINGULAR)
@pytest.mark.slow
def test_angles_are_kept_at_singular_points(name, cells):
    """Places nearer to a singular point than cells are cut would need another bound."""
    with_angle(singular(name, cells), 10.0)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.quick_for("0")
def test_angles_are_kept_on_crumpled_splines(seed):
    heights = 0.35 * np.random.default_rng(seed).normal(size=(9, 9, 3))
    grid = np.moveaxis(np.stack([*np.mgrid[:9, :9], np.zeros((9, 9))]), 0, -1)
    with_angle(gm.fit(gm.Surface.from_grid(grid + heights)), 10.0)


def test_angles_where_half_a_surface_is_a_line():
    assert len(with_angle(singular("half a line", (8, 8)), 3.0)) < 1000


CURVES = {
    "line": lambda u, v: (u, 2.0 * u, -u),
    "tilted line": lambda u, v: (0.1 * u + 0.7 * v, 0.3 * u + 2.1 * v, -0.2 * u - 1.4 * v),
    "cubic": lambda u, v: (u, u**2, u**3),
    "point": lambda u, v: (0.0, 0.0, 0.0),
}


@covering(
    shift=[0.0, 1e6],
    name=CURVES,
    asked=[{"angle": 10.0}, {"coverage": 0.1}, {"count": 100}, {"normals": [[0, 0, 1]]}],
)
def test_surfaces_whose_area_is_rounding(name, shift, asked):
    def f(u, v):
        return np.stack(np.broadcast_arrays(*CURVES[name](u, v), u, v)[:3], axis=-1) + shift

    surface = gm.Surface.from_callable(f, ((-1.0, 1.0), (-1.0, 1.0)))
    how = asked | {"density": "balanced", "cells": (6, 6), "error": gm.errors.SurfaceError}
    refused("has no area beyond rounding: all its points lie on", gm.sample, surface, **how)


@pytest.mark.parametrize("width", [1e-6, pytest.param(1e-9, marks=pytest.mark.slow)])
def test_long_and_narrow(width: float):
    hair = gm.Surface.from_callable(
        lambda u, v: np.stack([u, width * v, 0.0 * u], axis=-1), ((0.0, 1.0), (0.0, 1.0))
    )
    assert len(gm.sample(hair, coverage=0.02, cells=(6, 6))) <= 60


# --- angles between normals of a surface and of its samples ---------------------------------------

CELLS = (24, 24)


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "moebius_band"])
@pytest.mark.quick_for("wavy_graph")
def test_no_place_of_a_grid_has_a_larger_angle(name):
    spline = gm.fit(name, CELLS)
    samples, (points, normals) = gm.sample(spline, 150), places(spline)
    found, least = samples.normal_deviation(), widest_angle(samples, normals)
    # The places of both are finite: normals turn by less than half a degree between them.
    assert least - 0.5 <= found.normal_space <= 1.1 * least + 0.5
    nearest = samples.normals[KDTree(samples.points).query(points)[1]]
    least = np.degrees(np.arccos((nearest * normals).sum(axis=1).min()))
    assert least - 0.5 <= found.space <= 1.1 * least + 1.0


def test_what_was_asked_is_kept():
    samples = gm.sample(gm.fit("torus", CELLS), angle=12.0)
    assert 6.0 < samples.normal_deviation().normal_space <= 12.0


def test_no_samples_are_far_from_everything():
    samples = gm.sample(gm.fit("torus", CELLS), 100)[:0]
    assert samples.normal_deviation() == (180.0, 180.0)


def test_many_places_are_searched_block_by_block(monkeypatch):
    """Fewer places at first, whose cells are cut once more, find about the same angles."""
    samples = gm.sample(gm.fit("torus", (12, 12)), 60, density="gauss")
    expected = samples.normal_deviation()
    for name, value in (("MOST", 5000), ("BLOCK", 1000)):
        monkeypatch.setattr(f"gaussmap.tools.density.deviation.{name}", value)
    np.testing.assert_allclose(samples.normal_deviation(), expected, rtol=0.01)
