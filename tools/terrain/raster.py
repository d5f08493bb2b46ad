"""Elevations in GeoTIFF files and ASCII grids, read by rasterio."""

import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.base.extras import from_extra
from ...runtime.base.memory import check_memory
from ...runtime.base.wording import plural
from ..files.reading import UnusableError, opened, readable

Array = NDArray[np.float64]


class Raster(NamedTuple):
    """Heights (m, n), NaN where they are missing, and their position as given in the file.

    `transform` (a, b, c, d, e, f) maps a column and a row, counted from the corner of the first
    pixel, to x = a column + b row + c and y = d column + e row + f; None if the file has none.
    `unit` is the unit of the heights, or empty.
    """

    heights: Array
    transform: tuple[float, ...] | None
    crs: Any
    unit: str


def read_raster(path: Path, band: int, nodata: float | None) -> Raster:
    """Return a band of a raster, with scale and offset applied.

    Heights equal to `nodata`, by default the file's own value, are missing; they are compared
    before scale and offset are applied. Raises FileError, InputError for a missing band, and
    MissingExtraError.
    """
    rasterio = from_extra("rasterio", "gis", "reading GeoTIFF files")
    ascii_grid = path.suffix.lower() == ".asc"
    kind, driver = ("ASCII grid", "AAIGrid") if ascii_grid else ("GeoTIFF", "GTiff")
    quiet = warnings.catch_warnings()
    with opened(path, kind, "elevations"), quiet:
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        with rasterio.open(path, driver=driver) as dataset:
            bands = dataset.count
            if band <= bands:
                return _raster(dataset, band, nodata)
    raise _no_band(path, bands, band)


def raster_of(dataset: Any, band: int, nodata: float | None) -> Raster:  # noqa: ANN401
    """Return a band of an open dataset of rasterio; raises the errors of `read_raster`."""
    if dataset.closed:
        raise InputError(f"the dataset '{dataset.name}' is closed; open it, or name its file.")
    if band > dataset.count:
        raise _no_band(dataset.name, dataset.count, band)
    with readable(dataset.name, "raster", "elevations"):
        return _raster(dataset, band, nodata)


def _no_band(name: Path | str, bands: int, band: int) -> InputError:
    return InputError(f"'{name}' has {plural(bands, 'band')}, and no band {band}.")


def _raster(dataset: Any, band: int, nodata: float | None) -> Raster:  # noqa: ANN401
    check_memory("heights", dataset.height * dataset.width)
    heights = _heights(dataset, band, nodata)
    return Raster(heights, _transform(dataset), dataset.crs, dataset.units[band - 1] or "")


def _heights(dataset: Any, band: int, nodata: float | None) -> Array:  # noqa: ANN401
    if np.issubdtype(np.dtype(dataset.dtypes[band - 1]), np.complexfloating):
        raise UnusableError("holds complex numbers, and no elevations.")
    if nodata is None:
        found = dataset.read(band, masked=True)
        values, missing = found.data, np.ma.getmaskarray(found)
    else:
        values = dataset.read(band)
        with np.errstate(over="ignore"):
            missing = (values == nodata) | (values == np.float64(np.float32(nodata)))
    heights = values.astype(np.float64)
    heights *= dataset.scales[band - 1]
    heights += dataset.offsets[band - 1]
    heights[missing] = np.nan
    return heights


def _transform(dataset: Any) -> tuple[float, ...] | None:  # noqa: ANN401
    if not dataset.transform.is_identity:
        return tuple(dataset.transform)[:6]
    if dataset.gcps[0] or dataset.rpcs is not None:
        raise UnusableError(
            "is placed by ground control points or a camera model; rectify it first, with gdalwarp."
        )
    return None
