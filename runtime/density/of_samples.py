"""What any samples have reached: their coverage, and how far normals are from theirs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..fitting.fit import fit
from ..place.on_spline import OnSpline
from ..place.on_surface import OnSurface
from ..samples.whole import NormalDeviation
from ..spline.spline import Spline
from ..surface.surface import Surface
from .coverage import coverage
from .deviation import normal_deviation
from .space import Space
from .surface_piece import space_of

__all__ = ["coverage_of", "deviation_of", "space_on"]


def coverage_of(
    points: NDArray[np.floating],
    spline: Spline | None,
    surface: Surface | None,
    threads: int | None,
) -> float:
    """Return what `Samples.coverage` returns: of all pieces of the surface without a spline."""
    space = space_on(spline, surface, threads)
    return coverage(space, space.scaled_points(points)) / space.unit


def deviation_of(
    points: NDArray[np.floating],
    normals: NDArray[np.floating],
    spline: Spline | None,
    surface: Surface | None,
    threads: int | None,
) -> NormalDeviation:
    """Return what `Samples.normal_deviation` returns: of all pieces without a spline."""
    space = space_on(spline, surface, threads)
    return normal_deviation(space, space.scaled_points(points), normals.astype(np.float64))


def space_on(spline: Spline | None, surface: Surface | None, threads: int | None) -> Space:
    """Return what is sampled, or all of its pieces that have an area."""
    if spline is not None:
        on = OnSpline(spline, threads)
        return space_of([on if surface is None else OnSurface(spline, threads, surface)], threads)
    assert surface is not None
    return space_of([OnSurface(fit(x), threads, x) for x in surface.pieces()], threads)
