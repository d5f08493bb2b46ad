"""Samples of surfaces with lines where the normal turns: of all smooth pieces, as one."""

import math
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...refusals import refused
from ...shapes import revolved

CELLS = (24, 24)
ROOT = math.sqrt(0.5)
# From 15° to 60° above the equator of a unit sphere, the upper part of the barrel.
LOW, HIGH = math.radians(15.0), math.radians(60.0)


def barrel():
    """Two zones of unit spheres with the edge z = 0 in common; u goes round the z axis.

    The centre of the upper one is sin LOW below the edge. Both are exact NURBS.
    """
    middle, half = (LOW + HIGH) / 2, (HIGH - LOW) / 2
    arc = np.array([
        (math.cos(HIGH), math.sin(HIGH)),
        (math.cos(middle) / math.cos(half), math.sin(middle) / math.cos(half)),
        (math.cos(LOW), math.sin(LOW)),
    ]) - [0.0, math.sin(LOW)]  # fmt: skip
    profile = np.concatenate([arc * [1, -1], arc[-2::-1]])
    weights = [1, math.cos(half), 1, math.cos(half), 1]
    return revolved(profile, weights, name="barrel")


def roof():
    """Two rectangles of 5 × 2 and 5 × 4 with a right angle between them."""
    points = np.array([[[0.0, y, 2], [0, y, 0], [4, y, 0]] for y in (0, 5)])
    return gm.Surface.from_nurbs((1, 1), ([0, 0, 1, 1], [0, 0, 1, 3, 3]), points, name="roof")


def arcs(small, large, height):
    """Two quarters of cylinders, parallel to z, that meet at a right angle."""
    quarter = np.array([(0.0, 1.0), (1.0, 1.0), (1.0, 0.0)])
    profile = np.concatenate([small * quarter, [small, 0.0] + large * quarter[1:] - [0.0, large]])
    points = np.array([[(*x, z) for x in profile] for z in (0.0, height)])
    weights = [[1.0, ROOT, 1.0, ROOT, 1.0]] * 2
    knots = [0, 0, 1, 1], [0, 0, 0, 1, 1, 2, 2, 2]
    return gm.Surface.from_nurbs((1, 2), knots, points, weights, name="arcs")


def piece_of(samples, line):
    return (samples.uv[:, 1] > line).astype(int)


def share(surface, count, density):
    """Return the mean share of the second piece in five counts of samples around `count`.

    That of one count is off by 2 % as often as not, by what fits between borders.
    """
    counts = np.linspace(2 / 3, 4 / 3, 5) * count
    found = [gm.sample(surface, int(x), density=density, cells=CELLS) for x in counts]
    return np.mean([piece_of(x, 1.0).mean() for x in found])


@pytest.mark.parametrize(("on", "tolerance"), [("spline", 2e-2), ("surface", 1e-11)])
def test_every_point_with_a_normal_once(on, tolerance):
    """The normals of the edge belong to no piece: they are those of its points."""
    normals = np.concatenate([gm.fibonacci(300), gm.icosphere(8), np.eye(3), -np.eye(3)])
    latitude = np.abs(np.arcsin(normals[:, 2] / np.linalg.norm(normals, axis=1)))
    if on == "spline":
        clear = (np.abs(latitude - LOW) > 0.01) & (np.abs(latitude - HIGH) > 0.01)
        normals, latitude = normals[clear], latitude[clear]
    samples = gm.sample(barrel(), normals=normals, cells=CELLS, on=on)
    if on == "surface":
        counts = np.bincount(samples.normal_index, minlength=len(normals))
        assert np.array_equal(counts, latitude < HIGH)
        on_edge = samples.normal_index[samples.component == gm.Component.CREASE]
        assert np.array_equal(on_edge, np.flatnonzero(latitude <= LOW))
        assert (samples.report.proved, samples.report.undecided) == (len(normals), ())
        assert (samples.uv_radius < 1e-8).all()
        assert np.array_equal(gm.GaussMap(barrel()).count(normals), counts)
    samples = samples[samples.component == gm.Component.REGULAR]
    inside = np.flatnonzero((latitude > LOW) & (latitude < HIGH))
    assert np.array_equal(np.sort(samples.normal_index), inside)
    assert np.array_equal(piece_of(samples, 1.0) == 1, samples.normals[:, 2] > 0)
    centres = np.array([0, 0, -math.sin(LOW)]) * np.sign(samples.normals[:, 2:])
    assert np.allclose(samples.points - centres, samples.normals, atol=tolerance)


def test_patches_are_numbered_through_all_pieces():
    samples = gm.sample(barrel(), 200, cells=CELLS)
    assert samples.report.patches == 2 * 4 * 24 * 12
    assert np.array_equal(
        samples.arrays()["patch_index"] >= 4 * 24 * 12, piece_of(samples, 1.0) == 1
    )
    assert samples.spline is None
    assert samples.report.surface == "barrel"


@covering(count=[1, 2, 3, 100, 257], density=["balanced", "uniform", 0.5])
def test_the_count_is_exact(count, density):
    samples = gm.sample(barrel(), count, density=density, cells=CELLS)
    assert len(samples) == samples.report.samples == count
    counts = np.bincount(piece_of(samples, 1.0), minlength=2)
    assert abs(counts[1] - counts[0]) <= 1 + 0.06 * count  # both pieces are alike
    assert samples.normal_index.max() < max(samples.report.normals or 0, 1)


@covering(factor=[1e-3, 1.0, 1e3], density=["uniform", "balanced", 1.5])
def test_pieces_of_other_sizes_share_a_count_by_the_target_density(density, factor):
    """Cylinders of radius r: the areas go as r, and the integrals of κ² as 1/r.

    λ is 0.8 of the mean of κ², and more than 1/r² on the large one. Samples at borders count half.
    """
    small, large = 0.1, 4.0
    surface = arcs(factor * small, factor * large, factor * 0.2)
    assert len(surface.pieces()) == 2
    scales = [gm.fit(x, (4, 12)).scale for x in surface.pieces()]
    assert scales[0] > 4.0 * scales[1]
    needs = np.array([small, large])
    if density == "balanced":
        floor = 0.8 * (1.0 / small + 1.0 / large) / (small + large)
        needs = np.array([1.0 / small, floor * large])
    assert abs(share(surface, 600, density) - needs[1] / needs.sum()) <= 0.05


def test_curvature_counts_up_to_20_times_the_root_of_the_floor():
    """Of cylinders with the radii 0.02 and 100, κ² of the small one is 6,300 λ, and counts 400."""
    small, large, count = 0.02, 100.0, 3000
    samples = gm.sample(arcs(small, large, 1.0), count, cells=(8, 8))
    expected = count * 400.0 * small / (400.0 * small + large)
    assert (piece_of(samples, 1.0) == 0).sum() == pytest.approx(expected, rel=0.25)


def test_an_angle_holds_on_all_pieces():
    samples = gm.sample(barrel(), angle=6.0, cells=CELLS)
    lower, upper = np.bincount(piece_of(samples, 1.0))
    assert lower == pytest.approx(upper, rel=0.05)
    assert samples.report.angle <= 6.0
    assert samples.normal_index.max() < samples.report.normals  # of one icosphere


def test_coverage_holds_on_all_pieces():
    samples = gm.sample(roof(), coverage=0.5, cells=CELLS)
    x = np.stack(np.meshgrid(np.linspace(0, 4, 60), np.linspace(0, 5, 60)), axis=-1).reshape(-1, 2)
    for points in (
        np.insert(x, 2, 0.0, axis=1),
        np.insert(x * [0.5, 1], 0, 0.0, axis=1)[:, [0, 2, 1]],
    ):
        distances = np.linalg.norm(points[:, None] - samples.points, axis=2).min(axis=1)
        assert distances.max() <= samples.report.coverage <= 0.5


def test_samples_of_pieces_have_no_mesh():
    samples = gm.sample(barrel(), 50, cells=CELLS)
    refused(r"of several pieces .* each of surface.pieces\(\)", samples.mesh)
    meshes = [gm.sample(x, 50, cells=CELLS).mesh() for x in barrel().pieces()]
    assert all(len(x.triangles) > 50 for x in meshes)


def test_a_count_that_covers_all_pieces():
    least = len(gm.sample(roof(), coverage=0.5, density="uniform", cells=CELLS))
    samples = gm.sample(roof(), least + 40, coverage=0.5, cells=CELLS)
    assert len(samples) == least + 40
    assert samples.report.coverage <= 0.5
    with pytest.warns(gm.GaussmapWarning, match="the coverage is"):
        few = gm.sample(roof(), least // 2, coverage=0.5, cells=CELLS)
    assert len(few) == least // 2


def test_the_report_sums_up():
    samples = gm.sample(
        barrel(), coverage=0.2, cells=CELLS, fields=("points", "gaussian_curvature")
    )
    report = samples.report
    alone: list[Any] = [
        gm.sample(x, coverage=0.2, cells=(24, 12)).report for x in barrel().pieces()
    ]
    assert report.patches == sum(x.patches for x in alone)
    assert report.fit_distance == max(x.fit_distance for x in alone)
    assert report.fit_rms == pytest.approx(math.sqrt(sum(x.fit_rms**2 for x in alone) / 2))
    assert report.coverage <= 0.2
    assert report.developable_share == 0.0
    assert samples.fields == ("points", "gaussian_curvature")


def test_trimmed_pieces():
    """Of the narrow piece nothing is left, of the wide one a half."""
    half = roof().trimmed([[(0, 2), (1, 2), (1, 3), (0, 3)]])
    samples = gm.sample(half, 100, cells=CELLS)
    assert len(samples) == 100
    assert samples.points[:, 0].min() >= 2.0
    with pytest.raises(gm.errors.SurfaceError, match="their trim leaves nothing"):
        gm.sample(roof().trimmed(within=lambda u, v: u > 2.0), 100, cells=CELLS)


def test_many_pieces_are_refused():
    count = 60
    points = np.random.default_rng(0).random((count, count, 3))
    knots = [0, *range(count), count - 1]
    surface = gm.Surface.from_nurbs((1, 1), (knots, knots), points)
    refused(r"3,481 smooth pieces between creases", gm.sample, surface, 100)


def test_streams_are_of_one_piece():
    refused(r"2 smooth pieces .*surface.pieces\(\)", gm.sample_stream, barrel(), 100)


def test_poles_and_apexes_of_pieces():
    """A cone on a hemisphere: the pole is found, and the apex told."""
    half = math.radians(45.0)
    arc = [(0, -1), (math.tan(half), -1), (1, 0)]
    profile = np.array([*arc, (0.5, 0.5), (0, 1)])
    buoy = revolved(profile, [1, math.cos(half), 1, 1, 1])
    samples = gm.sample(buoy, 200, cells=CELLS)
    assert len(samples) == 200
    assert samples.report.apexes == 1
    areas = 2 * math.pi, math.pi * math.sqrt(2.0)
    assert share(buoy, 400, "uniform") == pytest.approx(areas[1] / sum(areas), rel=0.02)
