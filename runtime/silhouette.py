"""`silhouette`: where a surface is seen edge-on, from normals on a great circle."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .bins import NormalBins
from .checks import whole_number
from .choice import NEAR_ENOUGH, NORMALS_PER_SAMPLE
from .directions.circle import circle
from .directions.unit import as_normals, perpendicular, unit_vector
from .fields import checked_dtype, checked_fields
from .fitting import spline_of
from .report import sampling_report, warn_of
from .samples import Samples
from .search import Hits, fill, find
from .spline import Spline
from .surface import Surface
from .threads import thread_count

__all__ = ["great_circle", "silhouette"]

# The largest number of attempts to meet `count` by changing the number of normals.
TRIES = 6


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
) -> Samples:
    """Return points of a surface whose normals are perpendicular to a direction.

    They lie on the contour generator, which a parallel projection along `direction` shows as the
    outline: all of it, also where the surface hides it. Where K < 0 the outline is concave.

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
    Samples
        The points by normal, round the circle (`normal_index`) from the angle 0 to 2π, and then by
        patch, each exactly once. Where K keeps its sign, that is the order along the outline.

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
    circle on top of a torus in the direction of its axis, give isolated points or none.

    Examples
    --------
    >>> import gaussmap as gm
    >>> outline = gm.silhouette("torus", (1, 2, 3), count=200)
    >>> bool((abs(outline.normals @ [1, 2, 3]) < 1e-12).all())
    True

    """
    names, number = checked_fields(fields), checked_dtype(dtype)
    axis, asked = unit_vector(direction, "direction"), whole_number(count, "count")
    thread_count(threads)
    spline = spline_of(surface, cells, number)
    bins, hits = _by_count(spline, axis, asked, threads, progress)
    arrays = fill(spline, bins, hits, threads, names, number)
    order = np.argsort(hits.normal_index, kind="stable")
    asked_normals = len(bins.normals)
    density = asked_normals / (4 * math.pi)
    report = sampling_report(spline, asked_normals, len(hits), density, hits.developable, arrays)
    warn_of(report, asked, stacklevel=3)
    return Samples(**{x: y[order] for x, y in arrays.items()}, report=report, spline=spline)


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
    size, best = count, None
    for _ in range(TRIES):
        bins = NormalBins(great_circle(axis, size), threads)
        hits = find(spline, bins, threads, progress)
        if best is None or abs(len(hits) - count) < abs(len(best[1]) - count):
            best = bins, hits
        if abs(len(hits) - count) <= NEAR_ENOUGH * count or hits.developable == spline.patches:
            break
        next_size = round(size * count / len(hits)) if len(hits) else 2 * size
        size = min(max(next_size, 1), NORMALS_PER_SAMPLE * count)
    assert best is not None
    return best
