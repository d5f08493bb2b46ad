"""`silhouette`: the contour generator of a surface, from normals on a great circle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ...generated.jet import contour
from ...runtime.base.checks import whole_number
from ...runtime.base.formula_calls import patch, python_function, vector
from ...runtime.base.threads import thread_count
from ...runtime.base.tolerances import NORMAL_ERROR
from ...runtime.directions.circle import circle
from ...runtime.directions.unit import as_normals, perpendicular, unit_vector
from ...runtime.onto_surface.on_spline import OnSpline, on_grids
from ...runtime.onto_surface.on_surface import geometry_of, place_of_samples
from ...runtime.samples.fields import FLAG_NAMES, checked_dtype, checked_fields
from ...runtime.samples.report import warn_of
from ...runtime.samples.samples import Samples
from ...runtime.search.fill import fill
from ...runtime.search.search import Hits, find
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from ..density.chosen_normals import NEAR_ENOUGH, NORMALS_PER_SAMPLE
from .contours import polylines_of

__all__ = ["Silhouette", "great_circle", "silhouette"]

# Fields for the normal of a sample, and the patch where it was found.
KEYS = ("normal_index", "patch_index")
# The indices of x_uu, x_uv, x_vv, x_u, x_v in jets: the vectors of the osculating patch.
SECOND_JET = (3, 4, 5, 1, 2)
# The largest number of steps of Newton's method, and their total reach, in cells.
MOST_STEPS, FARTHEST = 12, 2.0
# The largest number of attempts to reach `count` by changing the number of normals.
TRIES = 6


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Silhouette(Samples):
    """Samples of a contour generator, and their order along its curves; made by `silhouette`.

    Selected rows, parts joined by ``Samples.concatenate`` and offsets are `Samples`, without
    polylines.

    Attributes
    ----------
    polylines : tuple of (k,) int64 arrays
        The rows along each curve; a closed one repeats its first row at its end.

    """

    polylines: tuple[NDArray[np.int64], ...] = field(default=(), kw_only=True)

    def __getitem__(self, key: ArrayLike | slice) -> Samples:
        arrays: dict[str, Any] = self.arrays()
        return Samples(
            **arrays, report=self.report,
            spline=self.spline, surface=self.surface, offset_of=self.offset_of,
        )[key]  # fmt: skip

    def __reduce__(self) -> tuple[Any, ...]:
        make, nothing = Samples.__reduce__(self)
        return partial(make, polylines=self.polylines), nothing


def silhouette(
    surface: Surface | Spline | str,
    direction: ArrayLike,
    *,
    count: int = 1000,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
) -> Silhouette:
    """Return points of a surface whose normals are perpendicular to a direction.

    They lie on the contour generator, whose parallel projection along `direction` is the outline,
    hidden parts included. Where K < 0 the outline is concave. The points are found on the spline
    that approximates the surface, and moved to the surface as samples are. Next to parabolic
    points, where the surface may have no nearby point with the same normal, they are moved to the
    contour generator of the surface, and their normal differs from that of their `normal_index`.

    Parameters
    ----------
    surface : Surface, Spline or str
        The surface, or its name in the catalogue.
    direction : (3,) array_like
        The direction of the projection, of any length but 0.
    count : int, default 1000
        The approximate number of points. Their normals are uniform on a great circle, so that
        points are dense where the outline is curved.
    cells, on, fields, dtype, threads, progress : optional
        As in `sample`.

    Returns
    -------
    Silhouette
        `Samples`: the points by normal, round the circle (`normal_index`) from the angle 0 to 2π,
        and then by patch, each exactly once. Their `polylines`, a tuple of (k,) int64 arrays, are
        the rows in order along each curve of the contour generator, across patches and parabolic
        points. A closed curve repeats its first row at its end; others end at open boundaries, or
        at a trim.

    Raises
    ------
    GaussmapError
        As `sample`; InputError also for a direction that is zero, NaN or infinite.

    Warns
    -----
    GaussmapWarning
        As `sample`.

    Notes
    -----
    Parts of the contour generator along which the normal is constant, such as straight ones and the
    circle on top of a torus seen along its axis, give isolated points or none. A polyline crosses
    them in one step. The visibility of the outline, its cusps and its T-junctions are not computed.

    Examples
    --------
    >>> import gaussmap as gm
    >>> outline = gm.silhouette("torus", (1, 2, 3), count=200)
    >>> bool((abs(outline.normals @ [1, 2, 3]) < 1e-12).all()), bool(outline.on_surface.all())
    (True, True)
    >>> [(len(line), bool(line[0] == line[-1])) for line in outline.polylines]
    [(101, True), (101, True)]
    >>> outline.points[outline.polylines[0]].shape  # a closed curve
    (101, 3)

    """
    surface, number = named(surface), checked_dtype(dtype)
    on_surface = place_of_samples(surface, on) == "surface"
    names, flags = checked_fields(fields, surface=on_surface), FLAG_NAMES if on_surface else ()
    axis, asked = unit_vector(direction, "direction"), whole_number(count, "count")
    thread_count(threads)
    (geometry,) = on_grids([geometry_of(surface, cells, on).used(number, threads)])
    spline = geometry.spline
    normals, hits = _by_count(geometry, axis, asked, progress)
    found = geometry.near_hits(normals, hits, list(dict.fromkeys([*names, *KEYS, *flags])), number)
    arrays = found.fields
    places = _places_on_spline(spline, normals, hits, arrays)
    unrefined = _move_others(geometry, axis, places, arrays)
    lines = polylines_of(spline, axis, places)
    chosen: dict[str, Any] = {name: arrays[name] for name in names}
    asked_normals = len(normals)
    density = asked_normals / (4 * math.pi)
    report = geometry.report(asked_normals, density, hits.developable, chosen)
    report = replace(report, on=geometry.on, unrefined=unrefined)
    warn_of(report, asked, stacklevel=3)
    return Silhouette(
        **chosen, report=report, spline=spline, surface=geometry.surface, polylines=lines
    )


def _places_on_spline(
    spline: Spline, normals: NDArray[np.float64], hits: Hits, arrays: dict[str, NDArray[Any]]
) -> NDArray[np.float64]:
    """Return the parameters (N, 2) at which samples were found on the spline."""
    uv = fill(spline, normals, hits, fields=("uv",))["uv"]
    return uv[np.searchsorted(hits.keys, arrays["normal_index"] << 32 | arrays["patch_index"])]


def _move_others(
    geometry: OnSpline,
    axis: NDArray[np.float64],
    places: NDArray[np.float64],
    arrays: dict[str, NDArray[Any]],
) -> int | None:
    """Move samples that are not on the surface to its contour generator; return the number left.

    Newton's method for N·axis = 0, along the gradient from the parameters (N, 2) on the spline,
    also converges at parabolic points. The samples are overwritten.
    """
    if FLAG_NAMES[0] not in arrays:
        return None
    on_surface = arrays[FLAG_NAMES[0]]
    rows = np.flatnonzero(~on_surface)
    surface = geometry.surface
    if len(rows) == 0 or surface is None:
        return len(rows)
    steps, start = geometry.spline.frame[2:], places[rows]
    uv, near = start.copy(), np.zeros(len(rows), dtype=bool)
    for _ in range(MOST_STEPS):
        jets = surface.jets(*uv.T.copy())[:, SECOND_JET]
        N, value, *slopes = python_function(contour)(patch(jets), vector(axis))
        gradient = steps * np.stack(slopes, axis=1)
        near = np.abs(value) <= NORMAL_ERROR * np.linalg.norm(N, axis=0)
        squares = np.square(gradient).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            move = -steps * gradient * (value / squares)[:, None]
        uv = np.where(near[:, None] | ~np.isfinite(move), uv, uv + move)
        uv = np.clip(uv, start - FARTHEST * steps, start + FARTHEST * steps)
        uv = _inside(uv, geometry.spline)
    done = rows[near]
    fields = [x for x in arrays if x not in KEYS]
    K = np.ones(len(done))
    dtype = arrays["points"].dtype if "points" in arrays else np.float64
    moved = geometry.at_parameters(uv[near], np.tile(axis, (len(done), 1)), K, fields, dtype)
    for name in fields:
        arrays[name][done] = moved[name]
    return int(np.count_nonzero(~arrays[FLAG_NAMES[0]]))


def _inside(uv: NDArray[np.float64], spline: Spline) -> NDArray[np.float64]:
    """Return parameters (k, 2) clipped to the domain in directions that are not periodic."""
    free = [ends[0] == "periodic" for ends in spline.boundary]
    low, high = np.array(spline.domain).T
    return np.where(free, uv, np.clip(uv, low, high))


def great_circle(axis: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return unit normals (count, 3) perpendicular to a unit vector, anticlockwise around it."""
    return as_normals(circle(count) @ np.stack(perpendicular(axis)))


def _by_count(
    geometry: OnSpline, axis: NDArray[np.float64], count: int, progress: bool
) -> tuple[NDArray[np.float64], Hits]:
    """Return normals with about `count` samples, and their hits."""
    size, best, nearest = count, None, math.inf
    for _ in range(TRIES):
        normals = great_circle(axis, size)
        hits = find(geometry.spline, normals, geometry.threads, progress)
        number = geometry.number_inside(normals, hits)
        if best is None or abs(number - count) < nearest:
            best, nearest = (normals, hits), abs(number - count)
        if nearest <= NEAR_ENOUGH * count or hits.developable == geometry.spline.patches:
            break
        next_size = round(size * count / number) if number else 2 * size
        size = min(max(next_size, 1), NORMALS_PER_SAMPLE * count)
    assert best is not None
    return best
