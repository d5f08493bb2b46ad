"""Elevations in world coordinates: GeoTIFF files, and arrays of .npz files with coordinates."""

from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ...runtime.base.advice import RASTER_SUFFIXES
from ...runtime.base.errors import InputError
from ...runtime.surface.surface import Surface
from ..files.numpy_files import array_file, read_array
from ..terrain.terrain import terrain
from .named import Named

# The options that only elevations have.
OF_TERRAIN = ("band", "x", "y", "crs", "source_crs", "origin")
DEGREES = "EPSG:4326"
# Names of arrays that hold degrees.
LONGITUDES, LATITUDES = ("lon", "long", "longitude"), ("lat", "latitude")


def is_raster_file(source: str) -> bool:
    """Return whether a text names a raster file, a GeoTIFF or an ASCII grid, by its suffix."""
    return Path(source).suffix.lower() in RASTER_SUFFIXES


def has_place(named: Named) -> bool:
    """Return whether one of the options for coordinates of elevations is given."""
    return not named.given().keys().isdisjoint(OF_TERRAIN)


def read_raster_file(named: Named, source: str) -> Surface:
    """Return the surface of a raster file."""
    named.refuse(("x", "y"), "is for .npz files; a GeoTIFF has its own coordinates.")
    named.refuse(("periodic",), "is for grids of points, and a GeoTIFF holds elevations.")
    return terrain(source, band=named.band or 1, spacing=named.spacing, **_place(named))


def terrain_of_array(heights: NDArray[Any], named: Named, source: str) -> Surface:
    """Return the surface of elevations from a .npy or .npz file, with coordinates from options."""
    named.refuse(("band",), "is for GeoTIFF files.")
    if heights.ndim != 2 or named.periodic is not None:
        raise InputError(
            "--x, --y, --crs, --source-crs and --origin are for elevations (m, n), and not for "
            f"grids of points {heights.shape}, nor with --periodic."
        )
    axes = {name: text for name, text in (("x", named.x), ("y", named.y)) if text is not None}
    file = array_file(source)
    if axes and (len(axes) == 1 or file.suffix.lower() != ".npz"):
        raise InputError(
            "--x and --y go together: the names of two arrays in the .npz file of the elevations."
        )
    arrays = {axis: read_array(f"{file}:{name}") for axis, name in axes.items()}
    place = _place(named)
    degrees = axes.get("x", "").lower() in LONGITUDES and axes.get("y", "").lower() in LATITUDES
    if degrees and place["source_crs"] is None:
        place["source_crs"] = DEGREES
    return terrain(heights, **arrays, spacing=named.spacing, name=file.name, **place)


def _place(named: Named) -> dict[str, Any]:
    return {x: getattr(named, x) for x in ("nodata", "crs", "source_crs", "origin")}
