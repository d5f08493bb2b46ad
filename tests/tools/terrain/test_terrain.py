"""Elevations in GeoTIFF files and arrays: where points are, what is missing, what is refused."""

import json
import warnings
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

rasterio = pytest.importorskip("rasterio")

from affine import Affine  # noqa: E402
from rasterio.crs import CRS  # noqa: E402
from rasterio.warp import transform as warped  # noqa: E402

from ...refusals import refused  # noqa: E402

SHAPE = 14, 17
ROWS, COLUMNS = np.indices(SHAPE)
HEIGHTS = 200.0 + 40.0 * np.sin(ROWS / 3.0) * np.cos(COLUMNS / 4.0)
NORTH_UP = Affine(30.0, 0.0, 500_000.0, 0.0, -30.0, 4_100_000.0)
PLACED: dict[str, Any] = {"transform": NORTH_UP, "crs": "EPSG:32617"}


def write(path: Path, heights: np.ndarray = HEIGHTS, tags: Any = None, **profile: Any) -> Path:
    bands = heights[None] if heights.ndim == 2 else heights
    count, rows, columns = bands.shape
    described = {"driver": "GTiff", "count": count, "height": rows, "width": columns}
    with (
        warnings.catch_warnings(),
        rasterio.open(path, "w", dtype=heights.dtype, **described, **profile) as file,
    ):
        file.write(bands)
        for name, value in (tags or {}).items():
            if name == "AREA_OR_POINT":
                file.update_tags(**{name: value})
            else:
                setattr(file, name, value)
    return path


def world(path: Path) -> np.ndarray:
    """Return the points (m, n, 3) that rasterio says."""
    with rasterio.open(path) as file:
        a, b, c, d, e, f = tuple(file.transform)[:6]
    x, y = a * (COLUMNS + 0.5) + b * (ROWS + 0.5) + c, d * (COLUMNS + 0.5) + e * (ROWS + 0.5) + f
    return np.stack([x, y, HEIGHTS], axis=-1)


def assert_same_points(surface: gm.Surface, expected: np.ndarray, atol: float = 1e-9) -> None:
    found = surface.grid.reshape(-1, 3)
    expected = expected.reshape(-1, 3)
    order = [np.lexsort(x.round(3).T) for x in (found, expected)]
    np.testing.assert_allclose(found[order[0]], expected[order[1]], rtol=0.0, atol=atol)
    u, v = np.array(surface.domain).mean(axis=1)
    assert gm.fit(surface).normals(u, v)[2] > 0.0  # upward


@pytest.mark.parametrize(
    "transform",
    [
        NORTH_UP,
        Affine(30.0, 0.0, 500_000.0, 0.0, 20.0, 4_000_000.0),  # south up
        Affine(-30.0, 0.0, 500_000.0, 0.0, -30.0, 4_000_000.0),
        NORTH_UP @ Affine.rotation(30.0),
        NORTH_UP @ Affine.shear(20.0, 0.0),
        NORTH_UP @ Affine.rotation(140.0) @ Affine.scale(1.0, -1.0),
    ],
)
@pytest.mark.parametrize("kind", ["Area", "Point"])
def test_points_are_where_rasterio_says(tmp_path: Path, transform: Affine, kind: str) -> None:
    tags = {"AREA_OR_POINT": kind}
    path = write(tmp_path / "dem.tif", transform=transform, crs="EPSG:32617", tags=tags)
    surface = gm.terrain(path)
    assert_same_points(surface, world(path))
    assert surface.georeference.crs == "EPSG:32617"
    if transform.is_rectilinear:
        u, v = (np.mean(x) for x in surface.domain)
        np.testing.assert_allclose(surface.evaluate(u, v)[:2], (u, v), rtol=1e-12)


def test_degrees_become_the_zone_of_utm(tmp_path: Path) -> None:
    for longitude, latitude, number in (
        (-84.4, 36.7, 32616), (151.2, -33.9, 32756), (10.0, 85.0, 32661), (10.0, -81.0, 32761)
    ):  # fmt: skip
        place = Affine(1e-3, 0.0, longitude, 0.0, -1e-3, latitude)
        path = write(tmp_path / "dem.tif", transform=place, crs="EPSG:4326")
        surface, expected = gm.terrain(path), world(path)
        x, y = warped(
            CRS.from_epsg(4326), CRS.from_epsg(number), *expected[..., :2].reshape(-1, 2).T
        )[:2]
        expected[..., 0], expected[..., 1] = np.reshape(x, SHAPE), np.reshape(y, SHAPE)
        assert_same_points(surface, expected, 1e-6)
        assert surface.georeference == gm.fit(surface).georeference
        assert surface.georeference.crs == f"EPSG:{number}"


def test_arrays_of_degrees_are_refused_or_projected() -> None:
    x, y = -84.4 + 1e-3 * np.arange(SHAPE[1]), 36.7 - 1e-3 * np.arange(SHAPE[0])
    refused("look like degrees", gm.terrain, HEIGHTS, x=x, y=y)
    surface = gm.terrain(HEIGHTS, x=x, y=y, source_crs=4326)
    same = gm.terrain(HEIGHTS, *(), x=np.broadcast_to(x, SHAPE), y=y, crs="EPSG:4326")
    np.testing.assert_array_equal(surface.grid, same.grid)
    dx, dy = np.ptp(surface.grid[..., 0]), np.ptp(surface.grid[..., 1])
    assert 1420 < dx < 1510  # 16 thousandths of 111.3 km · cos 36.7°, and the turn of the grid
    assert 1440 < dy < 1490


def test_heights_over_degrees_are_steep() -> None:
    """Coordinates below 90 may be lengths, over which heights vary less."""
    x, y = np.arange(SHAPE[1]) / 4.0, np.arange(SHAPE[0]) / 4.0
    heights = x[-1] * (HEIGHTS - HEIGHTS.min()) / np.ptp(HEIGHTS)
    assert gm.terrain(8.0 * heights, x=x, y=y).grid is not None
    refused("look like degrees", gm.terrain, 12.0 * heights, x=x, y=y)


def test_degrees_too_wide_for_a_zone() -> None:
    x, y = np.linspace(0.0, 1.0, SHAPE[1]), 48.0 - np.arange(SHAPE[0]) / 4.0
    assert gm.terrain(HEIGHTS, x=3.0 + 11.5 * x, y=y, source_crs=4326).georeference is not None
    words = "degrees of longitude, too many for UTM"
    refused(words, gm.terrain, HEIGHTS, x=3.0 + 12.5 * x, y=y, source_crs=4326)


@pytest.mark.parametrize(("error", "even"), [(0.8e-3, True), (1.2e-3, False)])
def test_even_coordinates_are_the_parameters(error: float, even: bool) -> None:
    x, y = 30.0 * np.arange(SHAPE[1]), 30.0 * np.arange(SHAPE[0])
    x[8] += 30.0 * error
    (low, high), _ = gm.terrain(HEIGHTS, x=x, y=y).domain
    assert (low, high) == ((0.0, 30.0 * 16) if even else (0.0, 16.0))


def test_uneven_and_curved_coordinates() -> None:
    x = np.cumsum(1.0 + 0.2 * np.sin(np.arange(SHAPE[1])))
    y = 10.0 * np.sqrt(1.0 + np.arange(SHAPE[0]))[::-1]
    uneven = gm.terrain(HEIGHTS, x=x, y=y)
    assert uneven.domain == ((0.0, SHAPE[1] - 1.0), (0.0, SHAPE[0] - 1.0))
    expected = np.stack([*np.broadcast_arrays(x, y[:, None]), HEIGHTS], axis=-1)
    assert_same_points(uneven, expected)
    curved = gm.terrain(
        HEIGHTS, x=x + 0.01 * ROWS * COLUMNS, y=np.broadcast_to(y[:, None], SHAPE) + 0.01 * COLUMNS
    )
    assert curved.grid is not None
    refused("fold", gm.terrain, HEIGHTS, x=x, y=np.abs(np.arange(SHAPE[0]) - 5.0))
    refused("transposed", gm.terrain, HEIGHTS, x=y, y=x)


@pytest.mark.parametrize("kind", ["int16", "uint8", "float32"])
def test_nodata_scale_and_offset(tmp_path: Path, kind: str) -> None:
    stored = HEIGHTS.round().astype(kind)
    missing = np.zeros(SHAPE, dtype=bool)
    missing[6:9, 7:10] = True
    stored[missing] = 7
    tags = {"scales": (0.5,), "offsets": (100.0,)}
    path = write(tmp_path / "dem.tif", stored, nodata=7, tags=tags, **PLACED)
    surface = gm.terrain(path)
    heights = surface.grid[..., 2].T[::-1]
    np.testing.assert_array_equal(np.isnan(heights), missing)
    np.testing.assert_array_equal(heights[~missing], 0.5 * stored[~missing] + 100.0)
    samples = gm.sample(surface, 200)
    columns, rows = (samples.points[:, :2] - (500_000.0, 4_100_000.0)).T / ((30.0,), (-30.0,))
    at = (rows - 0.5).round().astype(int), (columns - 0.5).round().astype(int)
    assert not missing[at].any()
    other = gm.terrain(path, nodata=float(stored[0, 0]))
    assert np.isnan(other.grid[0, -1, 2])
    assert not np.isnan(other.grid[8, 6, 2])


def test_bands_masks_and_units(tmp_path: Path) -> None:
    two = np.stack([HEIGHTS, HEIGHTS + 5.0]).astype("f4")
    path = write(tmp_path / "two.tif", two, tags={"units": ("metre", "foot")}, **PLACED)
    first = gm.terrain(path)
    assert first.grid[0, -1, 2] == two[0, 0, 0]
    refused("heights in foot and x, y in met", gm.terrain, path, band=2)
    refused("has 2 bands, and no band 3", gm.terrain, path, band=3)


def test_units_that_differ_by_more_than_digits_are_two(tmp_path):
    """Clarke's foot, the US survey foot and the German legal metre: 9e-6, 2e-6 and 14e-6 away."""
    paths = [tmp_path / f"{crs}.tif" for crs in (2314, 2229, 29371)]
    for path, unit in zip(paths, ("foot", "foot", "metre"), strict=True):
        write(path, tags={"units": (unit,)}, transform=NORTH_UP, crs=f"EPSG:{path.stem}")
    assert all(gm.terrain(path).grid is not None for path in paths[:2])
    refused("in metre and x, y in German legal metre", gm.terrain, paths[2])


def test_open_datasets_are_taken(tmp_path: Path) -> None:
    path = write(tmp_path / "dem.tif", np.stack([HEIGHTS, HEIGHTS + 1.0]), **PLACED)
    for band in 1, 2:
        expected = gm.terrain(path, band=band)
        with rasterio.open(path) as dataset:
            found = gm.terrain(dataset, band=band)
            refused("has 2 bands, and no band 3", gm.terrain, dataset, band=3)
            refused(r"make one by gm\.terrain", gm.sample, dataset, 10)
        assert expected.grid is not None
        np.testing.assert_array_equal(found.grid, expected.grid)
        assert (found.name, found.georeference) == ("dem.tif", expected.georeference)
    refused(r"dem\.tif' is closed; open it", gm.terrain, dataset)
    with rasterio.MemoryFile(path.read_bytes()) as file, file.open() as dataset:
        np.testing.assert_array_equal(gm.terrain(dataset, band=2).grid, found.grid)


def test_what_has_no_place_is_refused(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = write(tmp_path / "plain.tif")
    refused("not georeferenced", gm.terrain, path)
    surface = gm.terrain(path, spacing=(30.0, -30.0))
    assert surface.domain == ((0.0, 480.0), (-390.0, 0.0))
    grid = gm.Surface.from_grid(HEIGHTS, spacing=(30.0, -30.0)).grid
    np.testing.assert_array_equal(surface.grid, grid)
    placed = write(tmp_path / "dem.tif", **PLACED)
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"x": [1.0], "y": [1.0]}, "x and y are for arrays"),
        ({"spacing": (1, 1)}, "has its own"),
        ({"crs": "EPSG:4326"}, "has degrees"),
        ({"crs": "no system"}, "must be a coordinate reference system"),
        ({"origin": (1.0,)}, "two or three finite numbers"),
        ({"nodata": "x"}, "nodata must be a number"),
    ]
    for unusable, said in wrong:
        refused(said, gm.terrain, placed, **unusable)
    incomplete: list[dict[str, Any]] = [
        {}, {"x": np.arange(17.0)}, {"spacing": (0, 1)}, {"spacing": "a"}
    ]  # fmt: skip
    for arguments in incomplete:
        refused("", gm.terrain, HEIGHTS, **arguments)
    refused("", gm.terrain, HEIGHTS[0], spacing=(1, 1))


def test_an_ascii_grid(tmp_path: Path) -> None:
    """It is the same as a GeoTIFF of single precision, with the reference system given."""
    heights, path = HEIGHTS.astype("f4"), tmp_path / "dem.asc"
    heights[0, 3] = np.nan
    whole = gm.terrain(write(tmp_path / "dem.tif", heights, **PLACED)).grid
    corner = {"xllcorner": 500_000, "yllcorner": 4_100_000 - 30 * SHAPE[0], "cellsize": 30}
    header = {"ncols": SHAPE[1], "nrows": SHAPE[0], **corner, "NODATA_value": -9999}
    lines = "\n".join(f"{name} {x}" for name, x in header.items())
    np.savetxt(path, np.nan_to_num(heights, nan=-9999), "%.9g", header=lines, comments="")
    surface = gm.terrain(path, source_crs="EPSG:32617")
    np.testing.assert_array_equal(surface.grid, whole)
    assert surface.georeference.crs == "EPSG:32617"
    path.write_text("ncols")
    refused("damaged or is no ASCII grid", gm.terrain, path, error=gm.errors.FileError)


def test_damaged_files(tmp_path: Path) -> None:
    whole = write(tmp_path / "dem.tif", HEIGHTS.astype("f4"), **PLACED).read_bytes()
    for k, content in enumerate((b"", b"II*\0junk", whole[:600], b"<VRTDataset/>")):
        path = tmp_path / f"damaged{k}.tif"
        path.write_bytes(content)
        refused("damaged or is no GeoTIFF", gm.terrain, path, error=gm.errors.FileError)
    refused("cannot be read", gm.terrain, tmp_path / "missing.tif", error=gm.errors.FileError)
    path = write(tmp_path / "complex.tif", HEIGHTS.astype("complex64"), **PLACED)
    refused("complex", gm.terrain, path, error=gm.errors.FileError)


def test_too_large_files(tmp_path: Path) -> None:
    path, size = tmp_path / "large.tif", 300_000
    sparse = {"driver": "GTiff", "count": 1, "height": size, "width": size, "dtype": "uint8"}
    with rasterio.open(path, "w", tiled=True, SPARSE_OK=True, BIGTIFF="YES", **sparse, **PLACED):
        pass
    refused(r"90,000,000,000 heights need.*coarsen it", gm.terrain, path, error=gm.errors.FileError)


def test_an_origin_is_subtracted_and_kept(tmp_path: Path) -> None:
    path, origin = write(tmp_path / "dem.tif", **PLACED), (500_000.0, 4_099_000.0, 100.0)
    far, near = gm.terrain(path), gm.terrain(path, origin=origin)
    np.testing.assert_array_equal(near.grid, far.grid - origin)
    samples = gm.sample(near, 100)
    assert samples.report.origin == origin
    assert "coordinates in EPSG:32617 relative to (500000, 4099000, 100)" in samples.summary()
    for suffix in (".npz", ".ply"):
        samples.write(tmp_path / f"x{suffix}")
        assert gm.read_samples(tmp_path / f"x{suffix}").report == samples.report
    with pytest.warns(
        gm.GaussmapWarning, match=r"rounds these coordinates to 0.25.*origin such as 5000"
    ):
        gm.sample(far, 100, dtype=np.float32)
    gm.sample(near, 100, dtype=np.float32)
    with pytest.warns(gm.GaussmapWarning, match="rounds these coordinates"):
        gm.sample(far, 100).mesh().write(tmp_path / "x.stl")


def test_blocks_without_data_are_told_from_water() -> None:
    rng = np.random.default_rng(1)
    i, j = np.indices((60, 70))
    land = 150 + 60 * np.sin(i / 9) * np.cos(j / 11) + 0.2 * i + rng.normal(0, 1, i.shape)
    for value in (0.0, -1.0, 5000.0):
        holed = np.where(i + j < 30, value, land)
        with pytest.warns(
            gm.GaussmapWarning, match=rf"block of 465 heights of {value:.0f}.*as nodata"
        ):
            gm.terrain(holed, spacing=(30, 30))
    gm.terrain(np.where(i + j < 30, 0.0, land), spacing=(30, 30), nodata=0.0)
    gm.terrain(np.maximum(land, 120.0), spacing=(30, 30))  # lakes
    gm.terrain(np.maximum(land - 150.0, 0.0), spacing=(30, 30))  # the sea
    gm.terrain(np.minimum(land, 180.0), spacing=(30, 30))  # tablelands


# --- point clouds ---------------------------------------------------------------------------------

X, Y = 500_000.0 + 30.0 * np.arange(17), 4_100_000.0 - 30.0 * np.arange(14)


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    origin = 500_000.0, 4_099_000.0, 100.0
    return gm.sample(gm.terrain(HEIGHTS, x=X, y=Y, crs=32617, origin=origin), 100)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_point_clouds(samples: gm.Samples, tmp_path: Path, suffix: str) -> None:
    laspy = pytest.importorskip("laspy")
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
    assert CRS.from_wkt(wkt).to_epsg() == 32617
    assert cloud.header.global_encoding.wkt
    (report,) = [x.record_data for x in cloud.header.vlrs if x.user_id == "gaussmap"]
    assert json.loads(report)["crs"] == samples.report.crs == "EPSG:32617"


def test_other_point_clouds(tmp_path: Path) -> None:
    laspy = pytest.importorskip("laspy")
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
