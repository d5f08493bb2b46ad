"""Point clouds for surveying: .las files and compressed .laz files, by laspy."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.base.extras import from_extra
from ...runtime.samples.fields import columns_of
from ...runtime.samples.samples import Samples
from .content import report_to_json
from .of_terrain import in_world
from .reference_systems import wkt_of

# Coordinates are stored as 32-bit multiples of a step. The step is this fraction of the extent,
# rounded down to a power of ten: far below the distances of samples, and without overflow.
STEP = 2.0**-27
LARGEST = 2**31 - 1
# A point format of LAS 1.4 without times and colours.
FORMAT, VERSION = 6, "1.4"
# The byte offset of the date that laspy writes to a file; 0 means an unknown date.
DATE = 90
# The user ID and the record ID of the variable-length record that holds the report.
USER, RECORD = "gaussmap", 1


def write_las(samples: Samples, path: Path) -> None:
    """Write points, the CRS, the report as a record, and all other fields as extra dimensions.

    The origin of the samples is added again: the points are in world coordinates.
    """
    laspy = from_extra("laspy", "gis", f"a {path.suffix} file")
    report = samples.report
    points = in_world(samples)
    header = laspy.LasHeader(point_format=FORMAT, version=VERSION)
    header.scales, header.offsets = _steps(points)
    header.generating_software = "gaussmap"
    arrays = columns_of({x: y for x, y in samples.arrays().items() if x != "points"})
    header.add_extra_dims(
        [laspy.ExtraBytesParams(name=x, type=_kept(y)) for x, y in arrays.items()]
    )
    if report.crs is not None:
        header.vlrs.append(laspy.vlrs.known.WktCoordinateSystemVlr(wkt_of(report.crs)))
        header.global_encoding.wkt = True
    text = report_to_json(report).encode("ascii")
    header.vlrs.append(laspy.VLR(USER, RECORD, "report", text))
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = points.T
    for name, column in arrays.items():
        cloud[name] = column.astype(_kept(column), copy=False)
    cloud.write(str(path))
    with open(path, "r+b") as file:  # without the date, equal samples make equal files
        file.seek(DATE)
        file.write(bytes(4))


def _steps(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the steps and the offsets of the three coordinates."""
    if not len(points):
        return np.full(3, 1e-3), np.zeros(3)
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float((high - low).max())
    step = 10.0 ** math.floor(math.log10(extent * STEP)) if extent > 0.0 else 1e-3
    with np.errstate(over="ignore", invalid="ignore"):
        offsets = np.floor((low + high) / 2.0)
        if not (np.isfinite(offsets).all() and extent / 2.0 / step + 1.0 / step < LARGEST):
            offsets = (low + high) / 2.0
    if not (np.isfinite(offsets).all() and 1e-300 < step < 1e300):
        raise InputError("a .las file cannot hold these coordinates; write a .ply file instead.")
    return np.full(3, step), offsets


def _kept(column: NDArray[np.generic]) -> np.dtype[np.generic]:
    """Return the type of the extra dimension for a column; LAS has no booleans."""
    return np.dtype(np.uint8) if column.dtype == np.bool_ else column.dtype
