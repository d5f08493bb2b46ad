"""`silhouette`: the contour generator of a surface, seen along a direction or from a point.

Along a direction, its points have normals on a great circle; from a viewpoint p they are points of
the curve N·(x − p) = 0 on the spline, moved to the surface.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ...generated.jet import bend, contour
from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.checks import finite_array, whole_number
from ...runtime.base.errors import InputError
from ...runtime.base.formula_calls import patch, python_function, vector
from ...runtime.base.later import Later
from ...runtime.base.threads import thread_count
from ...runtime.base.tolerances import NORMAL_ERROR
from ...runtime.directions.sets import circle
from ...runtime.directions.unit import as_normals, perpendicular, unit_vector
from ...runtime.domain.domain import brought_inside
from ...runtime.onto_surface.on_spline import OnSpline, on_grids
from ...runtime.onto_surface.on_surface import geometry_of, place_of_samples
from ...runtime.samples.fields import FLAG_NAMES, checked_dtype, checked_fields
from ...runtime.samples.report import warn_of
from ...runtime.samples.samples import Samples
from ...runtime.search.hits import fill
from ...runtime.search.search import Hits, find
from ...runtime.spline.kernels.jets import evaluate_jets
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from ..density.chosen_normals import NEAR_ENOUGH, NORMALS_PER_SAMPLE
from .contours import View, places_along, polylines_of

# The fields for the index of the normal of a sample, and for the index of the patch where it was
# found.
KEYS = ("normal_index", "patch_index")
# The indices of x_uu, x_uv, x_vv, x_u, x_v in jets: the vectors of the osculating patch.
SECOND_JET = (3, 4, 5, 1, 2)
# The largest number of steps of Newton's method, and their largest total length, in cells of the
# spline.
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
        The indices of the rows along each curve; a closed curve repeats its first row at its end.
    eye : View or None
        The direction or the viewpoint.

    """

    polylines: tuple[NDArray[np.int64], ...] = field(default=(), kw_only=True)
    eye: View | None = field(default=None, kw_only=True)

    visible = Later("gaussmap.tools.derived")

    def __getitem__(self, key: ArrayLike | slice) -> Samples:
        arrays: dict[str, Any] = self.arrays()
        return Samples(
            **arrays, report=self.report,
            spline=self.spline, surface=self.surface, offset_of=self.offset_of,
        )[key]  # fmt: skip

    def __reduce__(self) -> tuple[Any, ...]:
        make, nothing = Samples.__reduce__(self)
        return partial(make, polylines=self.polylines, eye=self.eye), nothing


def silhouette(
    surface: Surface | Spline | str,
    direction: ArrayLike | None = None,
    *,
    viewpoint: ArrayLike | None = None,
    count: int = 1000,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
) -> Silhouette:
    """Return points of a surface whose normals are perpendicular to the lines of sight.

    They lie on the contour generator, whose projection along `direction`, or from `viewpoint`, is
    the outline, hidden parts included. Along a direction, the outline is concave where K < 0. The
    points are found on the spline that approximates the surface, and moved to the surface like
    samples. Next to parabolic points, the surface may have no nearby point with the same normal;
    along a direction, the point is then moved to the contour generator of the surface, and its
    normal differs from the normal with its `normal_index`.

    Parameters
    ----------
    surface : Surface, Spline or str
        The surface, or its name in the catalogue.
    direction : (3,) array_like, optional
        The direction of a parallel projection, of any length but 0.
    viewpoint : (3,) array_like, optional
        In place of a direction, the point from which the surface is seen.
    count : int, default 1000
        The approximate number of points. Along a direction, their normals are uniform on a great
        circle, so that points are dense where the outline is curved. From a viewpoint, they are
        about equally far apart, and `normal_index` is −1.
    cells, on, fields, dtype, threads, progress : optional
        As in `sample`.

    Returns
    -------
    Silhouette
        `Samples`: each point once. Along a direction, points are sorted by normal, around the
        circle (`normal_index`) from the angle 0 to 2π, then by patch; from a viewpoint, along the
        curves. Their `polylines`, a tuple of (k,) int64 arrays, are the rows in order along each
        curve of the contour generator, across patches and parabolic points. A closed curve repeats
        its first row at its end; others end at open boundaries, or at a trim.

    Raises
    ------
    GaussmapError
        As `sample`; InputError also for a direction that is zero, NaN or infinite, and unless
        either a direction or a viewpoint is given.

    Warns
    -----
    GaussmapWarning
        As `sample`.

    Notes
    -----
    Parts of the contour generator along which the normal is constant, such as straight ones and the
    circle on top of a torus seen along its axis, give isolated points or none. A polyline crosses
    them in one step. From a viewpoint, curves smaller than half a cell of the spline may be missed
    (an eighth of a cell, if the spline has at most 1,024 cells). `Silhouette.visible` says which
    points are seen; cusps and T-junctions of the outline are not computed.

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
    >>> near = gm.silhouette("sphere", viewpoint=(2, 0, 0), count=200)
    >>> abs(near.points[:, 0] - 0.5).max() < 1e-12
    np.True_

    """
    surface, number = named(surface), checked_dtype(dtype)
    on_surface = place_of_samples(surface, on) == "surface"
    names, flags = checked_fields(fields, surface=on_surface), FLAG_NAMES if on_surface else ()
    asked, view = whole_number(count, "count"), _view(direction, viewpoint)
    thread_count(threads)
    (geometry,) = on_grids([geometry_of(surface, cells, on).used(number, threads)])
    spline, wanted = geometry.spline, list(dict.fromkeys([*names, *KEYS, *flags]))
    if view.far:
        normals, hits = _by_count(geometry, view.at, asked, progress)
        asked_normals, developable = len(normals), hits.developable
        arrays = geometry.near_hits(normals, hits, wanted, number).fields
        places = _places_on_spline(spline, normals, hits, arrays)
        unrefined = _move_others(geometry, view, places, arrays)
        lines = polylines_of(spline, view, places)
    else:
        places, lines = places_along(spline, view, asked)
        asked_normals, developable = 0, None
        arrays = _fields_at(geometry, places, wanted, number)
        found = _move_to_contour(geometry, view, places, arrays, np.arange(len(places)))
        arrays, lines = {x: y[found] for x, y in arrays.items()}, _of_rows(lines, found)
        unrefined = 0 if flags else None
    chosen: dict[str, Any] = {name: arrays[name] for name in names}
    density = asked_normals / (4 * math.pi)
    report = geometry.report(asked_normals, density, developable, chosen)
    report = replace(report, on=geometry.on, unrefined=unrefined)
    warn_of(report, asked, stacklevel=3)
    return Silhouette(
        **chosen, report=report, spline=spline, surface=geometry.surface, polylines=lines, eye=view
    )


def bends(outline: Silhouette) -> Array:
    """Return the second fundamental forms (N,) of the lines of sight, each times a positive factor.

    They are positive where the surface bends towards its normals, and NaN at singular points.
    """
    assert outline.eye is not None
    u, v = outline.uv.astype(np.float64).T.copy()
    if outline.report.on == "surface":
        jets = cast("Surface", outline.surface).jets(u, v)
    else:
        jets = OnSpline(cast("Spline", outline.spline)).jets(u, v)
    rays = vector(outline.eye.rays(jets[:, 0]))
    with np.errstate(divide="ignore", invalid="ignore"):
        return python_function(bend)(patch(jets[:, SECOND_JET]), rays)


def _places_on_spline(
    spline: Spline, normals: NDArray[np.float64], hits: Hits, arrays: dict[str, NDArray[Any]]
) -> NDArray[np.float64]:
    """Return the parameters (N, 2) at which samples were found on the spline."""
    uv = fill(spline, normals, hits, fields=("uv",))["uv"]
    return uv[np.searchsorted(hits.keys, arrays["normal_index"] << 32 | arrays["patch_index"])]


def _view(direction: ArrayLike | None, viewpoint: ArrayLike | None) -> View:
    if (direction is None) == (viewpoint is None):
        raise InputError("a silhouette needs either a direction or a viewpoint=(x, y, z).")
    if viewpoint is not None:
        return View(finite_array(viewpoint, (3,), "viewpoint"), far=False)
    assert direction is not None
    return View(unit_vector(direction, "direction"), far=True)


def _move_others(
    geometry: OnSpline, view: View, places: Array, arrays: dict[str, NDArray[Any]]
) -> int | None:
    """Move samples that are not on the surface to its contour generator.

    The samples, which were found at parameters (N, 2) of the spline, are overwritten. Return how
    many are still not on the surface; None if `arrays` does not say which samples are on it.
    """
    if FLAG_NAMES[0] not in arrays:
        return None
    rows = np.flatnonzero(~arrays[FLAG_NAMES[0]])
    if len(rows) == 0 or geometry.surface is None:
        return len(rows)
    _move_to_contour(geometry, view, places, arrays, rows)
    return int(np.count_nonzero(~arrays[FLAG_NAMES[0]]))


def _move_to_contour(
    geometry: OnSpline, view: View, places: Array, arrays: dict[str, NDArray[Any]], rows: Indices
) -> Flags:
    """Move the samples in `rows` (k,) to the contour generator; return a mask (k,) of successes.

    The moved samples are overwritten. Newton's method for N·d = 0, along the gradient from the
    parameters (N, 2), also converges at parabolic points.
    """
    steps, start = geometry.spline.frame[2:], places[rows]
    uv, near = start.copy(), np.zeros(len(rows), dtype=bool)
    for _ in range(MOST_STEPS):
        jets = geometry.jets(*uv.T.copy())
        rays = view.rays(jets[:, 0])
        N, value, *slopes = python_function(contour)(patch(jets[:, SECOND_JET]), vector(rays))
        gradient = steps * np.stack(slopes, axis=1)
        sizes = np.linalg.norm(N, axis=0) * np.linalg.norm(rays, axis=1)
        near = (np.abs(value) <= NORMAL_ERROR * sizes) & (view.far | (sizes > 0.0))
        squares = np.square(gradient).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            move = -steps * gradient * (value / squares)[:, None]
        uv = np.where(near[:, None] | ~np.isfinite(move), uv, uv + move)
        uv = np.clip(uv, start - FARTHEST * steps, start + FARTHEST * steps)
        uv = _inside(uv, geometry.spline)
    done, (u, v) = rows[near], uv[near].T
    uv = np.stack(brought_inside(u, v, geometry.spline.domain, geometry.spline.boundary), axis=1)
    fields = [x for x in arrays if x not in KEYS]
    dtype = arrays["points"].dtype if "points" in arrays else np.float64
    moved = _fields_at(geometry, uv, fields, dtype)
    for name in fields:
        arrays[name][done] = moved[name]
    return near


def _of_rows(lines: Sequence[Indices], rows: Flags) -> tuple[Indices, ...]:
    """Return polylines without the rows that a mask drops, renumbered for the remaining rows."""
    number, found = np.cumsum(rows) - 1, list[Indices]()
    for line in lines:
        is_closed = len(line) > 1 and line[0] == line[-1]
        kept = line[: -1 if is_closed else None]
        kept = number[kept[rows[kept]]]
        if len(kept):
            found.append(np.append(kept, kept[:1]) if is_closed else kept)
    return tuple(found)


def _fields_at(
    geometry: OnSpline, uv: Array, fields: Sequence[str], dtype: DTypeLike
) -> dict[str, NDArray[Any]]:
    """Return fields of samples at parameters (k, 2)."""
    normals, K, H = np.empty((len(uv), 3)), np.empty(len(uv)), np.empty(len(uv))
    scales = np.array([geometry.spline.scale, *geometry.spline.frame[2:]])
    evaluate_jets(geometry.jets(*uv.T.copy()), scales, normals, K, H)
    return geometry.at_parameters(uv, normals, K, fields, dtype)


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
    """Return normals on a great circle that have about `count` samples, and their `Hits`."""
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
