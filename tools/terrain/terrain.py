"""`terrain`: a surface in world coordinates from the elevations in a file or an array."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.advice import is_raster
from ...runtime.base.checks import text, whole_number, with_gaps
from ...runtime.base.errors import InputError, in_memory
from ...runtime.base.georeference import Georeference, Origin, checked_origin
from ...runtime.domain.domain import Boundary, Domain
from ...runtime.spline.missing import checked_nodata, without_nodata
from ...runtime.surface.surface import Surface, label
from ..files.lengths import METRES, unit_named
from ..files.paths import checked_path
from ..files.reference_systems import checked_crs, crs_text, projected, target_crs
from .coordinates import check_degrees, grid_of, is_even, of_arrays, of_spacing, of_transform
from .raster import Raster, raster_of, read_raster

if TYPE_CHECKING:
    import rasterio

Array = NDArray[np.float64]

OPEN: Boundary = ("open", "open"), ("open", "open")
SAME_UNIT = 1e-5


@in_memory
def terrain(
    source: str | os.PathLike[str] | ArrayLike | rasterio.DatasetReader,
    *,
    x: ArrayLike | None = None,
    y: ArrayLike | None = None,
    spacing: Sequence[float] | None = None,
    band: int = 1,
    nodata: float | None = None,
    crs: str | int | None = None,
    source_crs: str | int | None = None,
    origin: Sequence[float] | None = None,
    name: str | None = None,
) -> Surface:
    """Make a surface of elevations, from a raster or an array, in world coordinates.

    Heights are at the centres of pixels. Coordinates in degrees are projected; heights are not
    resampled, so that every point of the grid is kept. Samples and their files record the reference
    system (`SamplingReport.crs`).

    Parameters
    ----------
    source : str, os.PathLike, rasterio.DatasetReader or (m, n) array_like
        Name of a GeoTIFF or an ASCII grid (.asc), or an open dataset of rasterio in any format,
        whose transform, CRS, nodata, mask, scale and offset are respected; or elevations, with rows
        along y and columns along x. Heights are in the unit of x and y.
    x, y : (n,) and (m,), or (m, n) array_like, optional
        The coordinates of an array: one for each column and one for each row, or for each height.
        They need not be equally spaced.
    spacing : (float, float), optional
        In place of x and y: the distances dx between columns and dy between rows of an array, or of
        a raster that states none; the first height is at (0, 0). A negative dy means that rows run
        from north to south.
    band : int, default 1
        The band of a raster.
    nodata : float, optional
        The number that marks missing heights, in place of the number in the file; it is compared
        before scale and offset are applied. NaN and masked entries are always missing. Parts of the
        surface that depend on missing heights are left out, see `Surface.from_grid`.
    crs : str or int, optional
        The coordinate reference system of the points, such as "EPSG:32617" or its number; its
        coordinates must be lengths, not degrees. By default that of the source or, if the source
        is in degrees, the zone of UTM that contains the middle of the source (UPS beyond 84° of
        latitude).
    source_crs : str or int, optional
        The CRS of the source if it states none, or a wrong one; ``"EPSG:4326"`` for longitudes x
        and latitudes y. If neither is known, `crs` is the CRS of the source, too.
    origin : (float, float) or (float, float, float), optional
        The origin subtracted from x, y and z, so that numbers are small: single precision (float32,
        .stl, .glb) rounds world coordinates to decimetres.
    name : str, optional
        Label of the surface. By default the name of the file, or "terrain".

    Returns
    -------
    Surface
        The surface, with normals upward, and its `georeference`. If rows and columns run along x
        and y at equal distances, u and v are x and y; else the fractional column and row.

    Raises
    ------
    FileError
        If the file cannot be read, is damaged, of another format, or too large for the memory.
    InputError
        For invalid arguments; for a file or an array without coordinates, coordinates that fold,
        degrees not declared as such, heights in another unit than x and y, and as
        `Surface.from_grid`.
    MissingExtraError
        Without Rasterio, if it is needed: for files, and for `crs`; the extra is "gis".

    Warns
    -----
    GaussmapWarning
        If heights look like missing data: usual numbers such as −9999, or blocks of constant height
        with abrupt steps at their borders.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import numpy as np
    >>> x, y = 500_000.0 + 30.0 * np.arange(12), 4_100_000.0 - 30.0 * np.arange(10)
    >>> heights = 200.0 + 40.0 * np.sin(x / 90.0) * np.cos(y[:, None] / 120.0)
    >>> hills = gm.terrain(heights, x=x, y=y, origin=(500_000, 4_100_000))
    >>> hills.domain, hills.georeference.origin
    (((0.0, 330.0), (-270.0, 0.0)), (500000.0, 4100000.0, 0.0))
    >>> samples = gm.sample(hills, 100)
    >>> samples.report.origin, samples.report.crs
    ((500000.0, 4100000.0, 0.0), None)

    """
    start, asked, given = checked_origin(origin), checked_crs(crs, "crs"), None
    if source_crs is not None:
        given = checked_crs(source_crs, "source_crs")
    said = "terrain" if name is None else text(name, "name")
    if isinstance(source, str | os.PathLike) or is_raster(source):
        if x is not None or y is not None:
            raise InputError("x and y are for arrays; a raster has its own coordinates.")
        wanted = whole_number(band, "band"), None if nodata is None else checked_nodata(nodata)
        if isinstance(source, str | os.PathLike):
            path = checked_path(source)
            raster = read_raster(path, *wanted)
        else:
            raster, path = raster_of(source, *wanted), Path(source.name)  # pyright: ignore
        said = path.name if name is None else said
        raster = raster._replace(heights=without_nodata(raster.heights, None, repr(said)))
        at_x, at_y = _of_raster(raster, spacing, path)
    else:
        raster = Raster(_elevations(source, nodata, said), None, None, "")
        at_x, at_y = _of_array(raster.heights, x, y, spacing)
    system = given if given is not None else raster.crs if raster.crs is not None else asked
    return _surface(raster, (at_x, at_y), (system, asked), start, said)


def _elevations(source: ArrayLike, nodata: float | None, name: str) -> Array:
    heights = with_gaps(source, "elevations")
    if heights.ndim != 2:
        raise InputError(f"elevations must have the shape (m, n), not {heights.shape}.")
    return without_nodata(heights, nodata, name)


def _of_raster(raster: Raster, spacing: Sequence[float] | None, path: Path) -> tuple[Array, Array]:
    if raster.transform is not None and spacing is not None:
        raise InputError(f"'{path}' has its own coordinates; leave out spacing.")
    if raster.transform is not None:
        return of_transform(raster.transform, _shape(raster.heights))
    if spacing is None:
        raise InputError(
            f"'{path}' is not georeferenced; give the size of its pixels, dx and dy, as "
            "spacing, dy < 0 if rows run from north to south."
        )
    return of_spacing(spacing, _shape(raster.heights))


def _of_array(
    heights: Array, x: ArrayLike | None, y: ArrayLike | None, spacing: Sequence[float] | None
) -> tuple[Array, Array]:
    if (x is None) != (y is None) or (x is None) == (spacing is None):
        raise InputError(
            "an array of elevations needs x and y, its coordinates, or a spacing, dx and dy."
        )
    if spacing is not None:
        return of_spacing(spacing, _shape(heights))
    assert x is not None
    assert y is not None
    return of_arrays(x, y, _shape(heights))


def _shape(heights: Array) -> tuple[int, int]:
    return heights.shape[0], heights.shape[1]


def _surface(
    raster: Raster,
    coordinates: tuple[Array, Array],
    systems: tuple[Any, Any],
    origin: Origin,
    name: str,
) -> Surface:
    """Return the surface; `systems` are the CRS of the coordinates and the requested CRS."""
    (x, y), heights, (source, asked) = coordinates, raster.heights, systems
    if min(heights.shape) < 2:
        raise InputError(f"{name} has {heights.shape[0]} x {heights.shape[1]} heights; too few.")
    if source is None:
        check_degrees(x, y, heights, name)
    if source is not None and asked is not None and source == asked and source.is_geographic:
        asked = None  # the CRS of x and y
    system = target_crs(source, asked, x, y, name)
    if system is not None and source != system:
        x, y = projected(source, system, *grid_of(x, y), name)
    _check_unit(raster.unit, system, name)
    points, domain = _points(x, y, heights, name)
    points -= origin
    if domain is not None:
        (x0, x1), (y0, y1) = domain
        domain = (x0 - origin[0], x1 - origin[0]), (y0 - origin[1], y1 - origin[1])
    place = Georeference(None, origin)
    if system is not None:
        place = Georeference(crs_text(system), origin, unit_named(system.linear_units))
    return Surface._of_grid(points, OPEN, (False, False), domain, name, label(name, name), place)


def _points(x: Array, y: Array, heights: Array, name: str) -> tuple[Array, Domain | None]:
    """Return points (n, m, 3) with normals upward, and their domain, None unless evenly spaced.

    The first index of a point is its column in `heights`, the second its row.
    """
    even = x.ndim == 1 and is_even(x) and is_even(y)
    if even:
        if x[0] > x[-1]:
            x, heights = x[::-1], heights[:, ::-1]
        if y[0] > y[-1]:
            y, heights = y[::-1], heights[::-1]
        x, y = (np.linspace(q[0], q[-1], len(q)) for q in (x, y))
    points = np.stack([*grid_of(x, y), heights], axis=-1).swapaxes(0, 1)
    if even:
        return points, ((float(x[0]), float(x[-1])), (float(y[0]), float(y[-1])))
    a, b = np.diff(points[..., :2], axis=0)[:, :-1], np.diff(points[..., :2], axis=1)[:-1]
    areas = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    if not ((areas > 0.0).all() or (areas < 0.0).all()):
        raise InputError(
            f"the coordinates x, y of {name} fold, or some repeat: along rows and columns they "
            "must go one way."
        )
    return (points if areas.flat[0] > 0.0 else points[:, ::-1].copy()), None


def _check_unit(unit: str, system: Any, name: str) -> None:  # noqa: ANN401
    """Raise InputError if heights are known to have another unit than x and y."""
    known = unit_named(unit)
    if known is None or system is None:
        return
    along, factor = system.linear_units_factor
    if abs(factor / METRES[known] - 1.0) > SAME_UNIT:
        raise InputError(
            f"{name} has heights in {unit} and x, y in {along}: normals need one unit; give a CRS "
            f"in {unit}, to which x and y are projected."
        )
