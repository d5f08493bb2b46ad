"""What any samples have reached: their coverage, and how far normals are from theirs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..fitting.fit import fit
from ..samples.whole import NormalDeviation
from ..spline.spline import Spline
from ..surface.surface import Surface
from .coverage import coverage
from .deviation import normal_deviation
from .law import area_of
from .sizing import SizingFunction, uniform

__all__ = ["coverage_of", "deviation_of"]


def coverage_of(
    points: NDArray[np.floating],
    spline: Spline | None,
    surface: Surface | None,
    threads: int | None,
) -> float:
    """Return what `Samples.coverage` returns: of all pieces of the surface without a spline."""
    sizings = _sizings(spline, surface, threads)
    return max(coverage(x, x.scaled_points(points)) / x.unit for x in sizings)


def deviation_of(
    points: NDArray[np.floating],
    normals: NDArray[np.floating],
    spline: Spline | None,
    surface: Surface | None,
    threads: int | None,
) -> NormalDeviation:
    """Return what `Samples.normal_deviation` returns: of all pieces without a spline."""
    directions = normals.astype(np.float64)
    found = [
        normal_deviation(x, x.scaled_points(points), directions)
        for x in _sizings(spline, surface, threads)
    ]
    return NormalDeviation(max(x.normal_space for x in found), max(x.space for x in found))


def _sizings(
    spline: Spline | None, surface: Surface | None, threads: int | None
) -> list[SizingFunction]:
    """Return the sizing function 1 on what is sampled, or on each piece that has an area."""
    if spline is not None:
        return [uniform(spline, surface, threads)]
    assert surface is not None
    pieces = [uniform(fit(x), x, threads) for x in surface.pieces()]
    return [x for x in pieces if area_of(x) > 0.0] if pieces[1:] else pieces
