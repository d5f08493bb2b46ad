"""Grids with missing points: what depends on these is left out, and the rest is as it was."""

import re
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.spline.missing import Known

STEP = 1.0 / 12.0
X = np.linspace(-1.0, 1.0, 25)
HEIGHTS = 0.3 * np.sin(3 * X)[:, None] * np.cos(3 * X)


def island() -> np.ndarray:
    heights = HEIGHTS.copy()
    heights[10:13, 14:16] = np.nan
    heights[0, 0] = np.nan
    return heights


def terrain(heights: Any, **named: Any) -> gm.Surface:
    return gm.Surface.from_grid(heights, spacing=(STEP, STEP), **named)


def sphere() -> np.ndarray:
    u, v = np.arange(24)[:, None] * np.pi / 12, np.linspace(-np.pi / 2, np.pi / 2, 13)
    return np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v) + 0 * u], axis=-1)


def known(surface: gm.Surface) -> Known:
    (part,) = surface.trim.parts
    assert isinstance(part, Known)
    return part


def check_against(surface: gm.Surface, whole: gm.Surface) -> None:
    """Check that the spline of what is left is that of the whole, and no more than needed goes."""
    left, spline, other = known(surface).patches, gm.fit(surface), gm.fit(whole)
    assert np.isfinite(spline.coefficients).all()
    np.testing.assert_array_equal(spline.control_nets[left], other.control_nets[left])
    assert np.count_nonzero(~left) > 0
    samples = gm.sample(surface, 200)
    assert len(samples) == 200
    assert left[samples.patch_index].all()
    assert np.abs(samples.points - other.evaluate(*samples.uv.T)).max() < 1e-14
    for cells in None, (12, 12):  # what is left out does not count
        off, of_whole = gm.fit(surface, cells).misfit, gm.fit(whole, cells).misfit
        assert off.distance <= of_whole.distance


def test_the_rest_is_that_of_whole_data():
    check_against(terrain(island()), terrain(HEIGHTS))
    grid = terrain(island()).grid
    assert grid is not None
    assert np.isnan(grid).any()
    # A point alone: what is left out is what another value would change.
    alone, other = HEIGHTS.copy(), HEIGHTS.copy()
    alone[12, 12], other[12, 12] = np.nan, 1.0
    changed = gm.fit(terrain(other)).control_nets != gm.fit(terrain(HEIGHTS)).control_nets
    left = known(terrain(alone)).patches
    np.testing.assert_array_equal(left, ~changed.any(axis=(1, 2)))


@pytest.mark.parametrize("place", [(5, 6), (5, 1), (0, 0), (0, 6), (23, 12)])
def test_next_to_seams_and_poles(place):
    points = sphere()
    points[place] = np.nan
    ends = True, "pole"
    check_against(
        gm.Surface.from_grid(points, periodic=ends), gm.Surface.from_grid(sphere(), periodic=ends)
    )


def test_three_ways_to_say_it():
    expected = known(terrain(island())).patches
    numbers = np.where(np.isnan(island()), -9999, island())
    for surface in (
        terrain(numbers, nodata=-9999),
        terrain(numbers.astype(np.float32), nodata=-9999),
        terrain(np.ma.masked_equal(numbers, -9999)),
    ):
        np.testing.assert_array_equal(known(surface).patches, expected)
    large = np.where(np.isnan(island()), 3.4028235e38, island()).astype(np.float32)
    np.testing.assert_array_equal(known(terrain(large, nodata=3.4028235e38)).patches, expected)
    grid = terrain(HEIGHTS).grid
    points = grid.copy()
    points[3, 4, 1] = -1234.0
    assert not known(gm.Surface.from_grid(points, nodata=-1234)).patches.all()


@pytest.mark.parametrize("value", [-9999.0, -32768.0, 3.4028234663852886e38])
def test_numbers_that_look_like_missing_data(value):
    with pytest.warns(gm.GaussmapWarning, match=r"grid.* holds .* 7 times, .* as nodata"):
        terrain(np.where(np.isnan(island()), value, island()))


@pytest.mark.parametrize(
    ("value", "given"),
    [(-3.4028234663852886e38, -3.40282e38), (-9999.0, -32768), (-777.03125, -777.031)],
)
def test_a_rounded_or_a_wrong_number_for_missing_data_is_said(value, given):
    heights = np.where(np.isnan(island()), value, island())
    message = rf"say {value:.9g} as nodata instead of {given:.9g}, which is none of its values"
    with pytest.warns(gm.GaussmapWarning, match=re.escape(message)):
        terrain(heights, nodata=given)
    # what is said works
    (said,) = re.findall(r"say (\S+) as nodata instead", message)
    np.testing.assert_array_equal(
        known(terrain(heights, nodata=float(said))).patches, known(terrain(island())).patches
    )


def test_other_cells_depend_on_more():
    samples = gm.sample(terrain(island()), 200, cells=(8, 8))
    spline = samples.spline
    assert spline.trim is not None
    other = gm.fit(terrain(HEIGHTS), (8, 8))
    np.testing.assert_allclose(samples.points, other.evaluate(*samples.uv.T), atol=1e-14)
    assert len(samples) == 200


def test_a_part_of_what_is_left():
    surface = terrain(island()).trimmed(within=lambda u, v: u > 1.0)
    samples = gm.sample(surface, 100)
    assert (samples.uv[:, 0] > 1.0).all()
    trim = terrain(island()).trim
    assert trim.contains(samples.uv).all()


def test_whole_grids_have_no_trim():
    assert terrain(HEIGHTS).trim is None
    assert terrain(HEIGHTS, nodata=-9999).trim is None
    assert gm.fit(terrain(HEIGHTS)).trim is None
