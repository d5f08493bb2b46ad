"""`silhouette`: where a surface is seen edge-on, from normals on a great circle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ...runtime.base.checks import whole_number
from ...runtime.base.threads import thread_count
from ...runtime.density.chosen_normals import NEAR_ENOUGH, NORMALS_PER_SAMPLE
from ...runtime.directions.circle import circle
from ...runtime.directions.unit import as_normals, perpendicular, unit_vector
from ...runtime.fitting.fit import check_range, spline_of
from ...runtime.samples.fields import ARRAY_NAMES, checked_dtype, checked_fields
from ...runtime.samples.report import sampling_report, warn_of
from ...runtime.samples.samples import Samples
from ...runtime.search.bins import NormalBins
from ...runtime.search.search import Hits, fill, find
from ...runtime.spline.inside import count_of, samples_inside
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from .contours import polylines_of

__all__ = ["Silhouette", "great_circle", "silhouette"]

# The largest number of attempts to meet `count` by changing the number of normals.
TRIES = 6


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Silhouette(Samples):
    """Samples of a contour generator, and their order along its curves; made by `silhouette`.

    Rows that are picked, parts joined by ``Samples.concatenate`` and offsets are `Samples`, without
    polylines.

    Attributes
    ----------
    polylines : tuple of (k,) int64 arrays
        The rows along each curve; a closed one ends with the row with which it begins.

    """

    polylines: tuple[NDArray[np.int64], ...] = field(default=(), kw_only=True)

    def __getitem__(self, key: ArrayLike | slice) -> Samples:
        return self._plain()[key]

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (self._plain(), self.polylines)

    def _plain(self) -> Samples:
        arrays: dict[str, Any] = self.arrays()
        return Samples(
            **arrays, report=self.report,
            spline=self.spline, surface=self.surface, offset_of=self.offset_of,
        )  # fmt: skip


def _rebuilt(samples: Samples, polylines: tuple[NDArray[np.int64], ...]) -> Silhouette:
    """Return a silhouette that was copied or pickled."""
    arrays: dict[str, Any] = samples.arrays()
    return Silhouette(
        **arrays, report=samples.report,
        spline=samples.spline, surface=samples.surface, polylines=polylines,
    )  # fmt: skip


def silhouette(
    surface: Surface | Spline | str,
    direction: ArrayLike,
    *,
    count: int = 1000,
    cells: Sequence[int] | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
) -> Silhouette:
    """Return points of a surface whose normals are perpendicular to a direction.

    They lie on the contour generator, which a parallel projection along `direction` shows as the
    outline: all of it, also where the surface hides it. Where K < 0 the outline is concave. Unlike
    samples, they stay on the spline that approximates the surface: ``gm.fit(surface).misfit`` is
    how far away it is, and more `cells` bring it nearer.

    Parameters
    ----------
    surface : Surface, Spline or str
        The surface, or its name in the catalogue.
    direction : (3,) array_like
        The direction of the projection, of any length but 0.
    count : int, default 1000
        The approximate number of points. Their normals are uniform on a great circle, so that
        points are dense where the outline is curved.
    cells, fields, dtype, threads, progress : optional
        As in `sample`.

    Returns
    -------
    Silhouette
        `Samples`: the points by normal, round the circle (`normal_index`) from the angle 0 to 2π,
        and then by patch, each exactly once. Their `polylines`, a tuple of (k,) int64 arrays, are
        the rows in the order of each curve of the contour generator, across patches and parabolic
        points. A closed curve ends with the row with which it begins; others end at open borders,
        or at a trim.

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
    circle on top of a torus in the direction of its axis, give isolated points or none. A polyline
    crosses them in one step.

    Examples
    --------
    >>> import gaussmap as gm
    >>> outline = gm.silhouette("torus", (1, 2, 3), count=200)
    >>> bool((abs(outline.normals @ [1, 2, 3]) < 1e-12).all())
    True
    >>> [(len(line), bool(line[0] == line[-1])) for line in outline.polylines]
    [(101, True), (101, True)]
    >>> outline.points[outline.polylines[0]].shape  # a closed curve
    (101, 3)

    """
    names, number = checked_fields(fields), checked_dtype(dtype)
    axis, asked = unit_vector(direction, "direction"), whole_number(count, "count")
    thread_count(threads)
    spline = spline_of(surface, cells)
    check_range(spline, number)
    bins, hits = _by_count(spline, axis, asked, threads, progress)
    needed = {*names, "uv", "normal_index"}
    arrays = fill(spline, bins, hits, threads, [x for x in ARRAY_NAMES if x in needed], number)
    arrays = samples_inside(spline.trim, arrays, list(arrays))
    order = np.argsort(arrays["normal_index"], kind="stable")
    arrays = {name: x[order] for name, x in arrays.items()}
    lines = polylines_of(spline, axis, arrays["uv"].astype(np.float64))
    chosen: dict[str, Any] = {name: arrays[name] for name in names}
    asked_normals = len(bins.normals)
    density = asked_normals / (4 * math.pi)
    report = sampling_report(spline, asked_normals, len(order), density, hits.developable, chosen)
    warn_of(report, asked, stacklevel=3)
    return Silhouette(**chosen, report=report, spline=spline, polylines=lines)


def great_circle(axis: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return unit normals (count, 3) perpendicular to a unit vector, anticlockwise round it."""
    return as_normals(circle(count) @ np.stack(perpendicular(axis)))


def _by_count(
    spline: Spline,
    axis: NDArray[np.float64],
    count: int,
    threads: int | None,
    progress: bool,
) -> tuple[NormalBins, Hits]:
    """Return normals with about `count` samples, and these."""
    size, best, nearest = count, None, math.inf
    for _ in range(TRIES):
        bins = NormalBins(great_circle(axis, size), threads)
        hits = find(spline, bins, threads, progress)
        number = len(hits)
        if spline.trim is not None and number:
            uv = fill(spline, bins, hits, threads, ("uv",))
            number = count_of(samples_inside(spline.trim, uv, ("uv",)))
        if best is None or abs(number - count) < nearest:
            best, nearest = (bins, hits), abs(number - count)
        if nearest <= NEAR_ENOUGH * count or hits.developable == spline.patches:
            break
        next_size = round(size * count / number) if number else 2 * size
        size = min(max(next_size, 1), NORMALS_PER_SAMPLE * count)
    assert best is not None
    return best
