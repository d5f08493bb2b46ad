"""Elevations in world coordinates: GeoTIFF files, and arrays of .npz files with coordinates."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.base.extras import check_extra
from ...runtime.surface.surface import Surface
from ..files.arrays import array_file, read_array
from ..terrain.terrain import terrain

__all__ = ["OF_TERRAIN", "has_place", "is_raster_file", "read_raster_file", "terrain_of_array"]

RASTER_SUFFIXES = (".tif", ".tiff")
# The options that only elevations have.
OF_TERRAIN = ("band", "x", "y", "crs", "source_crs", "origin")
DEGREES = "EPSG:4326"
# Names of arrays that hold degrees.
LONGITUDES, LATITUDES = ("lon", "long", "longitude"), ("lat", "latitude")


def is_raster_file(source: str) -> bool:
    """Say whether a text names a GeoTIFF, by its suffix."""
    return Path(source).suffix.lower() in RASTER_SUFFIXES


def has_place(options: SimpleNamespace) -> bool:
    """Say whether there is an option on coordinates."""
    return any(getattr(options, name) is not None for name in OF_TERRAIN)


def read_raster_file(options: SimpleNamespace) -> Surface:
    """Return the surface of a GeoTIFF."""
    check_extra("rasterio", "gis", "reading GeoTIFF files")
    for name in ("x", "y"):
        if getattr(options, name) is not None:
            raise InputError(f"--{name} is for .npz files; a GeoTIFF has its own coordinates.")
    if options.periodic is not None:
        raise InputError("--periodic is for grids of points, and a GeoTIFF holds elevations.")
    return terrain(options.surface, band=options.band or 1, spacing=options.spacing, **_of(options))


def terrain_of_array(heights: NDArray[Any], options: SimpleNamespace) -> Surface:
    """Return the surface of elevations in a .npy or .npz file, with options on coordinates."""
    if options.band is not None:
        raise InputError("--band is for GeoTIFF files.")
    if heights.ndim != 2 or options.periodic is not None:
        raise InputError(
            "--x, --y, --crs, --source-crs and --origin are for elevations (m, n), and not for "
            f"grids of points {heights.shape}, nor with --periodic."
        )
    named = {x: getattr(options, x) for x in ("x", "y") if getattr(options, x) is not None}
    file = array_file(options.surface)
    if named and (len(named) == 1 or file.suffix.lower() != ".npz"):
        raise InputError(
            "--x and --y go together: the names of two arrays in the .npz file of the elevations."
        )
    arrays = {x: read_array(f"{file}:{y}") for x, y in named.items()}
    place = _of(options)
    if _are_degrees(named) and place["source_crs"] is None:
        place["source_crs"] = DEGREES
    return terrain(heights, **arrays, spacing=options.spacing, name=file.name, **place)


def _are_degrees(named: dict[str, str]) -> bool:
    return named.get("x", "").lower() in LONGITUDES and named.get("y", "").lower() in LATITUDES


def _of(options: SimpleNamespace) -> dict[str, Any]:
    return {x: getattr(options, x) for x in ("nodata", "crs", "source_crs", "origin")}
