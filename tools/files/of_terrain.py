"""Samples of terrain: columns of slope and aspect, and files for geographic information systems."""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import columns_of
from ...runtime.samples.samples import Samples
from .reference_systems import wkt_of

# A point with three coordinates in the format WKB.
POINT = np.dtype([("order", "u1"), ("type", "<u4"), ("place", "<f8", 3)])
POINT_Z = 1001
# The option of GDAL for the date in a file. It is fixed, so that equal samples make equal files.
DATE = "OGR_CURRENT_DATE"


def columns_of_terrain(samples: Samples) -> dict[str, NDArray[np.floating]]:
    """Return the columns slope and aspect, in degrees, for samples of terrain with normals."""
    report = samples.report
    if (report.crs is None and report.origin is None) or "normals" not in samples.fields:
        return {}
    return {"slope": samples.slope, "aspect": samples.aspect}


def in_world(samples: Samples) -> NDArray[np.float64]:
    """Return the points (N, 3) in world coordinates: with the origin of the samples added."""
    return samples.points.astype(np.float64) + np.array(samples.report.origin or (0.0, 0.0, 0.0))


def write_points(samples: Samples, path: Path) -> None:
    """Write a .gpkg or .geojson file of points with all other columns and the reference system.

    The origin of the samples is added again: the points are in world coordinates.
    """
    library = from_extra("pyogrio", "gis", f"a {path.suffix} file")
    report = samples.report
    points = np.empty(len(samples), POINT)
    points["order"], points["type"] = 1, POINT_Z
    points["place"] = in_world(samples)
    columns = columns_of({x: y for x, y in samples.arrays().items() if x != "points"})
    columns |= columns_of_terrain(samples)
    file, date = BytesIO(), library.get_gdal_config_option(DATE)
    library.set_gdal_config_options({DATE: "1970-01-01T00:00:00.000Z"})
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="'crs' was not provided")
            library.raw.write(
                file,
                geometry=np.array([x.tobytes() for x in points], dtype=object),
                field_data=[np.ascontiguousarray(x) for x in columns.values()],
                field_mask=[~np.isfinite(x) for x in columns.values()],
                fields=list(columns),
                driver={".gpkg": "GPKG", ".geojson": "GeoJSON"}[path.suffix.lower()],
                geometry_type="Point Z",
                crs=None if report.crs is None else wkt_of(report.crs),
                layer="samples",
            )
    finally:  # other files that this process writes keep their dates
        library.set_gdal_config_options({DATE: date})
    path.write_bytes(file.getbuffer())
