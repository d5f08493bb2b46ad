"""Coordinate reference systems: identification and projection, by rasterio."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError, shown
from ...runtime.base.extras import from_extra

Array = NDArray[np.float64]

# UTM is for latitudes from SOUTH to NORTH, UPS for those beyond. POLAR are the EPSG codes of both
# zones of UPS: north, south.
SOUTH, NORTH, POLAR = -80.0, 84.0, (32661, 32761)
# The largest range of longitude, in degrees, for one zone of UTM: in a wider range, the scale is
# wrong by a percent.
WIDEST_ZONE = 12.0
# The number of points that are projected at a time.
AT_A_TIME = 1 << 17


def checked_crs(crs: str | int | None, name: str) -> Any:  # noqa: ANN401
    """Return a CRS of rasterio for "EPSG:number", a number or WKT; InputError for anything else."""
    if crs is None:
        return None
    rasterio = from_extra("rasterio.crs", "gis", f"{name}=...")
    try:
        with from_extra("rasterio", "gis", f"{name}=...").Env():
            found = rasterio.CRS.from_user_input(crs)
            found.to_wkt()
            return found
    except Exception:  # the object's methods may raise anything
        raise InputError(
            f"{name} must be a coordinate reference system, such as EPSG:32617, not {shown(crs)}."
        ) from None


def target_crs(source: Any, target: Any, x: Array, y: Array, name: str) -> Any:  # noqa: ANN401
    """Return the CRS of points, whose coordinates are lengths, not degrees.

    It is `target` if given; else `source` or, if `source` has degrees, UTM (near the poles, UPS).
    x and y are coordinates in `source`. The result is None if neither is given. Raises InputError
    if `target` has degrees, a latitude exceeds 90°, or no zone of UTM fits.
    """
    if target is not None and target.is_geographic:
        raise InputError(
            f"the CRS {crs_text(target)} has degrees, and normals need lengths; use one in metres, "
            "such as that of UTM, EPSG:326NN north and 327NN south of the equator for zone NN."
        )
    if target is not None or source is None or not source.is_geographic:
        return target if target is not None else source
    middle, latitude = float(x.min() + x.max()) / 2.0, float(y.min() + y.max()) / 2.0
    if np.abs(y).max() > 90.0:
        raise InputError(f"{name} has latitudes beyond 90 degrees; are x and y exchanged?")
    south = latitude < 0.0
    if not SOUTH <= latitude <= NORTH:
        number = POLAR[south]
    elif float(np.ptp(x)) > WIDEST_ZONE:
        raise InputError(
            f"{name} spans {float(np.ptp(x)):.0f} degrees of longitude, too many for UTM; give "
            "a projection, such as EPSG:3035, or crop it."
        )
    else:
        number = (32701 if south else 32601) + int((middle + 180.0) % 360.0 // 6.0)
    return checked_crs(number, "crs")


def projected(source: Any, target: Any, x: Array, y: Array, name: str) -> tuple[Array, Array]:  # noqa: ANN401
    """Return x and y in the CRS `target`; InputError for points outside of its range."""
    warp = from_extra("rasterio.warp", "gis", "a projection")
    flat_x, flat_y = x.ravel(), y.ravel()
    found = np.empty((2, x.size))
    for first in range(0, x.size, AT_A_TIME):
        part = slice(first, first + AT_A_TIME)
        found[:, part] = warp.transform(source, target, flat_x[part], flat_y[part])[:2]
    if not np.isfinite(found).all():
        raise InputError(
            f"{name} has places outside the range of {crs_text(target)}; use another crs."
        )
    return found[0].reshape(x.shape), found[1].reshape(x.shape)


def crs_text(crs: Any) -> str:  # noqa: ANN401
    """Return "EPSG:number" if this code is exactly the given CRS, else the WKT of the CRS."""
    number = crs.to_epsg(confidence_threshold=100)
    if number is not None and checked_crs(number, "crs") == crs:
        return f"EPSG:{number}"
    return crs.to_wkt()


def wkt_of(crs: str) -> str:
    """Return the WKT (version 1, as in LAS) of a CRS that is given as by `crs_text`."""
    return checked_crs(crs, "crs").to_wkt()
