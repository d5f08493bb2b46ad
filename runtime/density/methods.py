"""The methods of `Samples` that compare them with their surface, and order them."""

from __future__ import annotations

import numpy as np

from ..base.progress import busy
from ..samples.samples import Samples, spline_if_one
from ..samples.whole import NormalDeviation, Whole
from ..spline.spline import Spline
from .of_samples import coverage_of, deviation_of
from .progressive import progressive_order

__all__ = ["coverage", "normal_deviation", "progressive"]


def progressive(self: Samples, *, progress: bool = False) -> Samples:
    """Return the same samples in an order in which every prefix is well distributed.

    The first ones are far apart relative to the local spacing of the samples; the next ones
    halve the gaps, and so on. Spacings below a thousandth of the median count as that.

    Parameters
    ----------
    progress : bool, default False
        Show on a terminal what is done, from a second on.

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


def coverage(
    self: Samples,
    spline: Spline | None = None,
    *,
    threads: int | None = None,
    progress: bool = False,
) -> float:
    """Return a bound of the distance from any point of the surface to the nearest sample, in L.

    Parameters
    ----------
    spline : Spline, optional
        The spline of the samples, if `spline` of the samples is None.
    threads : int, optional
        The number of threads; by default all cores.
    progress : bool, default False
        Show on a terminal what is done, from a second on.

    Returns
    -------
    float
        The bound, at most 10 % above the distance of a point that was found. For samples on the
        surface, twice the largest distance of the surface from its spline is added. Infinite if
        there are no samples.

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
        if isinstance(self.surface, Whole):
            return self.surface._coverage_of(self.points, threads)
        return coverage_of(self.points, spline_if_one(self, spline), self.surface, threads)


def normal_deviation(
    self: Samples,
    spline: Spline | None = None,
    *,
    threads: int | None = None,
    progress: bool = False,
) -> NormalDeviation:
    """Return the largest angles between normals of the surface and those of the samples.

    Normals are compared at 16 places for each sample and at least 20,000, and at more of them
    where larger angles may be.

    Parameters
    ----------
    spline : Spline, optional
        The spline of the samples, if `spline` of the samples is None.
    threads : int, optional
        The number of threads; by default all cores.
    progress : bool, default False
        Show on a terminal what is done, from a second on.

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
        if isinstance(self.surface, Whole):
            return self.surface._deviation_of(self.points, self.normals, threads)
        one = spline_if_one(self, spline)
        return deviation_of(self.points, self.normals, one, self.surface, threads)
