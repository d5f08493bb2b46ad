"""`convolve`: all sums of two points with the same normal, with the branches of both surfaces."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import checked_rows
from ...runtime.base.errors import GaussmapWarning, InputError
from ...runtime.base.later import Later
from ...runtime.base.threads import over_ranges
from ...runtime.directions.unit import as_normals
from ...runtime.fitting.fit import patches_of
from ...runtime.map import GaussMap
from ...runtime.samples.fields import new_field
from ...runtime.samples.report import (
    SamplingReport,
    count_infinite,
    joined_proof,
    sampling_report,
    warn_of,
)
from ...runtime.samples.samples import Samples
from ...runtime.spline.nets import AnySpline
from ...runtime.spline.spline import short_label
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from .branches import Branches, curvatures
from .function import SupportFunction
from .operations import pairs
from .sources import Source, SplineSource, SurfaceSource

# The number of sums computed at a time; there may be many more sums than branches.
PIECE = 1 << 14


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Convolution(Samples):
    """The k sums of two points with the same normal, sorted by normal, then by branch of the first.

    They are `Samples` of the convolution surface, without `uv` and `patch_index`: each sum has two
    of each. Selected rows are a `Convolution`; offsets, and parts joined by
    ``Samples.concatenate``, are `Samples`.

    Attributes
    ----------
    first, second : Branches
        The branches of both surfaces at the prescribed normals.
    rows : (k, 2) int64 array
        Rows of `first` and of `second`, whose points add to the sample.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import numpy as np
    >>> ball = gm.surfaces.ellipsoid(a=0.2, b=0.1, c=0.1)
    >>> sums = gm.convolve("torus", ball, [[1, 0, 0], [0, 1, 1]], cells=(16, 16))
    >>> sums[sums.elliptic]
    Convolution(2 points on torus + ellipsoid: 2 with K > 0)
    >>> i, j = sums.rows.T
    >>> np.allclose(sums.points, sums.first.points[i] + sums.second.points[j])
    True
    >>> sums.first_uv.shape, sums.second_uv.shape
    ((4, 2), (4, 2))

    """

    first: Branches = field(kw_only=True)
    second: Branches = field(kw_only=True)
    rows: NDArray[np.int64] = field(kw_only=True)

    mesh = Later("gaussmap.tools.meshes.of_sums")

    @property
    def first_uv(self) -> NDArray[np.float64]:
        """(k, 2) float64 array: parameters of the point of the first surface, or NaN."""
        return self.first.uv[self.rows[:, 0]]

    @property
    def second_uv(self) -> NDArray[np.float64]:
        """(k, 2) float64 array: parameters of the point of the second surface, or NaN."""
        return self.second.uv[self.rows[:, 1]]

    def __getitem__(self, key: ArrayLike | slice) -> Convolution:
        rows = key if isinstance(key, slice) else checked_rows(key, len(self))
        arrays: dict[str, Any] = {name: array[rows] for name, array in self.arrays().items()}
        summands: dict[str, Any] = self._summands | {"rows": self.rows[rows]}
        return Convolution(**arrays, report=self.report, **summands)

    def __reduce__(self) -> tuple[Any, ...]:
        make, nothing = Samples.__reduce__(self)
        return partial(make, **self._summands), nothing

    @property
    def _summands(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("first", "second", "rows")}


def convolve(
    first: Surface | AnySpline | SupportFunction | str,
    second: Surface | AnySpline | SupportFunction | str,
    normals: ArrayLike,
    *,
    cells: Sequence[int] | None = None,
) -> Convolution:
    """Return every sum of two points of two surfaces that have the same normal.

    Support functions add, h = h₁ + h₂ (7), and so do points and Hessians. A normal with i points on
    the first surface and j on the second has i j sums, which are very many on folded surfaces.

    Points of a `Surface` are those of `GaussMap.points`, exact up to rounding; the report says for
    how many normals they are proved to be all points. Points of splines, of grids, and of surfaces
    with creases lie on the spline; the report has the sum of the distances of both splines from
    their surfaces.

    Parameters
    ----------
    first, second : Surface, Spline, SupportFunction or str
        The two surfaces, or their names in the catalogue.
    normals : (S, 3) array_like
        Directions of any length but 0, such as ``icosphere(32)``.
    cells : (int, int), optional
        Take splines with these numbers of cells in place of each `Surface`, see `fit`.

    Returns
    -------
    Convolution
        `Samples`: the sums, with the points of both surfaces. If `on` in the report is "surface",
        the report has `proved`, `undecided` (entries of the first surface, then of the second) and
        `unrefined`. If it is "spline", the report has `fit_distance`, `fit_rms` and `fit_angle`:
        the sums of the distances of both surfaces, and the larger one of their angles.

    Raises
    ------
    InputError
        For invalid normals, for `cells` without a `Surface`, and for objects that are not surfaces.
    UnknownNameError
        If the catalogue has no surface of that name.
    SurfaceError
        As `fit`.

    Warns
    -----
    GaussmapWarning
        If developable regions are left out, or if there are no sums.

    Notes
    -----
    For two convex bodies whose normals point outwards the result lies on the boundary of their
    Minkowski sum. For others it lies on the convolution surface; the boundary of the sum is a part
    of it, and other sheets lie inside the sum. A body B, moved by t, meets a body A if t lies in
    the sum of A and −B, B reflected in the origin. The outward normals of −B are −n, so it is
    ``SupportFunction.of_spline(B).scaled(-1).reversed()``.

    On splines a point differs from that of the surface with the same normal by up to about
    `fit_distance`, plus `fit_angle` in radians times the largest radius of curvature.

    K and H come from the sum of the Hessians. They are NaN where a radius is infinite (at a
    parabolic point), and infinite or NaN where a sum of radii is 0.

    Examples
    --------
    >>> import gaussmap as gm
    >>> ball = gm.SupportFunction.from_sympy("1/10")
    >>> sums = gm.convolve("torus", ball, gm.icosphere(2))
    >>> bool((abs(sums.support - sums.first.support[sums.rows[:, 0]] - 0.1) < 1e-15).all())
    True

    """
    directions = as_normals(normals)
    first, second = named(first), named(second)
    if cells is not None and not any(isinstance(x, Surface) for x in (first, second)):
        raise InputError("cells=... is for surfaces, and neither of these is a Surface.")
    sources = [_source(x, cells) for x in (first, second)]
    one = _branches(sources[0], directions)  # one by one: warnings name the caller's line
    two = _branches(sources[1], directions)
    i, j = pairs(one.normal_index, two.normal_index, len(directions))
    name = " + ".join(short_label(_name(x)) for x in sources)
    if len(one) and len(two) and not len(i):
        message = f"surface {name!r}: no normal has points on both of the two."
        warnings.warn(message, GaussmapWarning, stacklevel=2)
    arrays = _sums(one, two, i, j) | _flags(sources, i, j)
    report = SamplingReport(
        name, len(directions), len(i), None, None, None,
        infinite_curvatures=count_infinite(arrays), **_accuracy(sources, len(directions), arrays),
    )  # fmt: skip
    rows = np.stack([i, j], axis=1)
    return Convolution(**arrays, report=report, first=one, second=two, rows=rows)


def _sums(
    one: Branches, two: Branches, i: NDArray[np.int64], j: NDArray[np.int64]
) -> dict[str, Any]:
    """Return the fields of the sums: branch i[k] of one surface plus branch j[k] of the other."""
    names = ("points", "normals", "support", "gaussian_curvature", "mean_curvature")
    arrays: dict[str, NDArray[Any]] = {x: new_field(x, len(i), np.float64) for x in names}

    def work(begin: int, end: int) -> None:
        here, first, second = slice(begin, end), i[begin:end], j[begin:end]
        normals = one.normals[first]
        with np.errstate(all="ignore"):  # infinite radii are valid
            hessian = one.hessian[first] + two.hessian[second]
            _, K, H = curvatures(normals, hessian)
        arrays["points"][here] = one.points[first] + two.points[second]
        arrays["normals"][here] = normals
        arrays["support"][here] = one.support[first] + two.support[second]
        arrays["gaussian_curvature"][here], arrays["mean_curvature"][here] = K, H

    list(over_ranges(work, len(i), PIECE, None))
    return arrays | {"normal_index": one.normal_index[i]}


def _source(surface: Surface | AnySpline | SupportFunction, cells: Sequence[int] | None) -> Source:
    """Return the source of branches: a smooth surface itself, a spline, or a support function."""
    if isinstance(surface, SupportFunction):
        return surface._source
    if not isinstance(surface, Surface | AnySpline):
        raise InputError(
            "convolve takes two of Surface, Spline and SupportFunction, not "
            f"{type(surface).__name__}."
        )
    if cells is None and isinstance(surface, Surface) and surface.grid is None:
        known = GaussMap(surface)
        if known.spline is not None:
            return SurfaceSource(known, surface)
    return SplineSource(patches_of(surface, cells if isinstance(surface, Surface) else None))


def _name(source: Source) -> str:
    if isinstance(source, SplineSource):
        return source.spline.name
    return str(source) if isinstance(source, SurfaceSource) else f"SupportFunction({source})"


def _branches(source: Source, normals: NDArray[np.float64]) -> Branches:
    """Return the branches of a surface at normals; warn of developable regions."""
    branches = source.sheets(normals).branches(normals)
    if isinstance(source, SurfaceSource):
        warn_of(source.report, None, stacklevel=4)
    elif isinstance(source, SplineSource):
        density = len(normals) / (4 * math.pi)
        report = sampling_report(source.spline, len(normals), len(branches), density, None)
        warn_of(report, None, stacklevel=4)
    return branches


def _flags(sources: Sequence[Source], i: NDArray[np.int64], j: NDArray[np.int64]) -> dict[str, Any]:
    """Return the field `on_surface`: whether both points are on their surfaces; {} for splines."""
    if any(x.splines() for x in sources):
        return {}
    found = np.ones(len(i), dtype=np.bool_)
    for source, rows in zip(sources, (i, j), strict=True):
        if isinstance(source, SurfaceSource):
            found &= source.on_surface[rows]
    return {"on_surface": found}


def _accuracy(
    sources: Sequence[Source], count: int, arrays: dict[str, NDArray[Any]]
) -> dict[str, Any]:
    """Return the entries of the report that say how exact the sums are."""
    splines = [x for source in sources for x in source.splines()]
    if splines:
        misfits = [(factor, x.misfit) for factor, x in splines]
        known = [(factor, x) for factor, x in misfits if x is not None]
        if len(known) < len(misfits):
            return {"on": "spline"}
        angles = [x.angle for _, x in known if x.angle is not None]
        return {
            "on": "spline",
            "fit_distance": sum(factor * x.distance for factor, x in known),
            "fit_rms": sum(factor * x.rms for factor, x in known),
            "fit_angle": max(angles) if len(angles) == len(known) else None,
        }
    entries: dict[str, Any] = {"on": "surface"}
    entries["unrefined"] = int(np.count_nonzero(~arrays["on_surface"]))
    reports = [x.report for x in sources if isinstance(x, SurfaceSource)]
    if all(x.proved is not None for x in reports):
        entries |= joined_proof(count, reports)
    return entries
