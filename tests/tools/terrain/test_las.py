"""Samples of terrain as point clouds, read again by laspy."""

import json
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest

laspy = pytest.importorskip("laspy")
rasterio = pytest.importorskip("rasterio")


SHAPE = 14, 17
ROWS, COLUMNS = np.indices(SHAPE)
HEIGHTS = 200.0 + 40.0 * np.sin(ROWS / 3.0) * np.cos(COLUMNS / 4.0)
X, Y = 500_000.0 + 30.0 * np.arange(17), 4_100_000.0 - 30.0 * np.arange(14)


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    origin = 500_000.0, 4_099_000.0, 100.0
    return gm.sample(gm.terrain(HEIGHTS, x=X, y=Y, crs=32617, origin=origin), 100)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_point_clouds(samples: gm.Samples, tmp_path: Path, suffix: str) -> None:
    samples.write(tmp_path / f"x{suffix}")
    cloud = laspy.read(tmp_path / f"x{suffix}")
    found, expected = np.asarray(cloud.xyz), samples.points + np.array(samples.report.origin)
    step = cloud.header.scales.max()
    assert step <= 480.0 * 2.0**-27
    # Half a step, and the rounding of float64 at 4.1e6.
    assert np.abs(found - expected).max() <= step / 2 + 2 * np.spacing(4.1e6)
    np.testing.assert_array_equal(np.stack([cloud.nx, cloud.ny, cloud.nz], 1), samples.normals)
    np.testing.assert_array_equal(cloud.gaussian_curvature, samples.gaussian_curvature)
    np.testing.assert_array_equal(cloud.normal_index, samples.normal_index)
    (wkt,) = [x.string for x in cloud.header.vlrs if hasattr(x, "string")]
    assert rasterio.crs.CRS.from_wkt(wkt).to_epsg() == 32617
    assert cloud.header.global_encoding.wkt
    (report,) = [x.record_data for x in cloud.header.vlrs if x.user_id == "gaussmap"]
    assert json.loads(report)["crs"] == samples.report.crs == "EPSG:32617"


def test_other_point_clouds(tmp_path: Path) -> None:
    torus = gm.sample("torus", 60, cells=(8, 8))
    torus.write(tmp_path / "x.las")
    cloud = laspy.read(tmp_path / "x.las")
    assert np.abs(np.asarray(cloud.xyz) - torus.points).max() <= 1e-8
    np.testing.assert_array_equal(cloud.on_surface, torus.on_surface)
    torus[:0].write(tmp_path / "x.las")
    assert len(laspy.read(tmp_path / "x.las").points) == 0
    torus[:1].write(tmp_path / "x.las")
    np.testing.assert_allclose(laspy.read(tmp_path / "x.las").xyz, torus.points[:1], atol=1e-3)
    with pytest.raises(gm.errors.InputError, match=r"a \.las file needs 'points'"):
        gm.sample("torus", 60, cells=(8, 8), fields=("normals",)).write(tmp_path / "y.las")


@pytest.mark.parametrize("suffix", [".gpkg", ".geojson"])
def test_points_for_geographic_information_systems(samples, suffix, tmp_path):
    raw, options = pytest.importorskip("pyogrio.raw"), pytest.importorskip("pyogrio")
    path = tmp_path / f"hills{suffix}"
    samples.write(path)
    about, _, shapes, columns = raw.read(path)
    found = dict(zip(about["fields"].tolist(), columns, strict=True))
    assert options.get_gdal_config_option("OGR_CURRENT_DATE") is None
    assert about["geometry_type"] == "Point Z"
    assert about["crs"] == "EPSG:32617"
    places = np.array([np.frombuffer(x[-24:]) for x in shapes])
    world = samples.points + np.array(samples.report.origin)
    np.testing.assert_allclose(places, world, rtol=1e-12)
    np.testing.assert_allclose(found["slope"], samples.slope, rtol=1e-12)
    np.testing.assert_allclose(found["aspect"], samples.aspect, rtol=1e-12)
    columns = samples.to_dataframe()
    assert np.array_equal(columns["slope"], samples.slope)
    # A slope that rises to the north-east faces south-west.
    x, y = np.meshgrid(np.arange(8.0), np.arange(8.0))
    ramp = gm.sample(gm.terrain(0.1 * (x + y), x=x[0], y=y[:, 0], origin=(0, 0)), coverage=1.0)
    np.testing.assert_allclose(ramp.aspect, 225.0, atol=1e-6)
    np.testing.assert_allclose(ramp.slope, np.degrees(np.arctan(0.1 * 2**0.5)), atol=1e-6)
