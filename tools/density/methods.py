"""The methods of `Samples` that compare them with their surface, and order them."""

from __future__ import annotations

import math

import numpy as np

from ...runtime.base.checks import finite_array, known_name
from ...runtime.base.progress import busy
from ...runtime.fitting.fit import fit
from ...runtime.onto_surface.on_spline import OnSpline
from ...runtime.onto_surface.on_surface import OnSurface
from ...runtime.samples.samples import Samples, spline_or
from ...runtime.samples.whole import NormalDeviation, Whole
from ...runtime.spline.nets import AnySpline
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from .coverage import coverage as bound
from .deviation import normal_deviation as deviation
from .path_order import path_order
from .progressive import progressive_order
from .space import Space
from .surface_piece import space_of


def progressive(self: Samples, *, progress: bool = False) -> Samples:
    """Return the samples in progressive order: every prefix is well distributed.

    The first ones are far apart relative to the local spacing of the samples; the next ones
    halve the gaps, and so on. The local spacing is at least a thousandth of its median.

    Parameters
    ----------
    progress : bool, default False
        Show progress on a terminal, after the first second.

    Returns
    -------
    Samples
        The samples in that order. Any prefix can be used: ``samples[:1000]``.

    Raises
    ------
    MissingFieldError
        Unless the samples have the fields points and normals.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", 200, cells=(16, 16))
    >>> few = samples.progressive()[:50]
    >>> few.coverage() < 1.2 * samples[:50].coverage()
    True

    """
    points, normals = (x.astype(np.float64) for x in (self.points, self.normals))
    with busy("ordering samples", progress):
        return self[progressive_order(points, normals)]


def in_order(self: Samples, order: str) -> Samples:
    """Return the samples in the order in which a probe may visit them.

    Parameters
    ----------
    order : {"path"}
        "path" is a short path of straight lines from sample to sample: the shortest links between
        samples are joined to one path, which may begin and end anywhere. For 100 to 1,000 samples
        of surfaces and parts it is 4 to 10 % longer than paths that OR-Tools finds in 20 s.
        Obstacles are not considered.

    Returns
    -------
    Samples
        The samples in that order.

    Raises
    ------
    UnknownNameError
        For another order.
    MissingFieldError
        Unless the samples have the field points.

    See Also
    --------
    progressive : every prefix is well distributed.

    Examples
    --------
    >>> import gaussmap as gm
    >>> import numpy as np
    >>> samples = gm.sample("torus", 200)
    >>> def length(x): return np.linalg.norm(np.diff(x.points, axis=0), axis=1).sum()
    >>> bool(length(samples.in_order("path")) < length(samples) / 5)
    True

    """
    known_name(order, ("path",), "order of samples")
    return self[path_order(self.points.astype(np.float64))]


def coverage(
    self: Samples,
    spline: AnySpline | None = None,
    *,
    threads: int | None = None,
    progress: bool = False,
) -> float:
    """Return a bound of the distance from any point of the surface to the nearest sample.

    The distance is in the unit L of the surface. Samples on the other side of a thin wall also
    count; in `SamplingReport.coverage` they do not.

    Parameters
    ----------
    spline : Spline, optional
        The spline of the samples, if `spline` of the samples is None.
    threads : int, optional
        The number of threads; by default all cores.
    progress : bool, default False
        Show progress on a terminal, after the first second.

    Returns
    -------
    float
        The bound, at most 10 % above the largest distance that was found. For samples on a surface
        whose derivatives are finite differences, distances are those from its spline, and twice the
        largest distance of the surface from the spline is added, unless the surface has a pole.
        Infinite if there are no samples.

    Raises
    ------
    MissingFieldError
        Unless the samples have the field points.
    InputError
        If there is no spline.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", coverage=0.3, cells=(16, 16))
    >>> samples.coverage() < 1.1 * 0.3
    True

    """
    with busy("measuring the coverage", progress):
        points, space = self.points, _space_of(self, spline, threads)
        known = self.report.coverage
        asked = math.inf if known is None else known * space.unit
        return bound(space, space.scaled_points(points), asked) / space.unit


def normal_deviation(
    self: Samples,
    spline: AnySpline | None = None,
    *,
    threads: int | None = None,
    progress: bool = False,
) -> NormalDeviation:
    """Return the largest angles between normals of the surface and those of the samples.

    Normals are compared at 16 test points for each sample, at least 20,000, and at further ones
    where larger angles are possible.

    Parameters
    ----------
    spline : Spline, optional
        The spline of the samples, if `spline` of the samples is None.
    threads : int, optional
        The number of threads; by default all cores.
    progress : bool, default False
        Show progress on a terminal, after the first second.

    Returns
    -------
    NormalDeviation
        The largest angle, in degrees, between the normal of a point of the surface and that of
        the sample nearest in normal (`normal_space`), and of the sample nearest in space
        (`space`). Both are 180 without samples.

    Raises
    ------
    MissingFieldError
        Unless the samples have the fields points and normals.
    InputError
        If there is no spline.

    Examples
    --------
    >>> import gaussmap as gm
    >>> samples = gm.sample("torus", angle=20.0, cells=(16, 16))
    >>> samples.normal_deviation().normal_space <= 20.0
    True

    """
    with busy("comparing normals", progress):
        points, normals = self.points, finite_array(self.normals, (len(self), 3), "normals")
        space = _space_of(self, spline, threads)
        return deviation(space, space.scaled_points(points), normals)


def _space_of(samples: Samples, spline: AnySpline | None, threads: int | None) -> Space:
    """Return the sampled `Space`: the pieces of a part, a spline, or the pieces of a surface.

    Without a spline, these are all pieces of the surface that have an area.
    """
    surface = samples.surface
    if isinstance(surface, Whole):
        return surface._space(threads, reach=samples.report._in_reach)
    if spline is None and samples.spline is None and surface is not None:
        return space_of([OnSurface(fit(x), threads, x) for x in surface.pieces()], threads)
    return space_on(spline_or(samples, spline), surface, threads)


def space_on(spline: Spline, surface: Surface | None, threads: int | None) -> Space:
    """Return the `Space` of a surface with its spline or, without a surface, of the spline."""
    on = OnSpline(spline, threads) if surface is None else OnSurface(spline, threads, surface)
    return space_of([on], threads)
