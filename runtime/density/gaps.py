"""How far a surface is from its samples."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..spline import Spline
from ..trees import tree_of
from .candidates import Candidates
from .law import Law, Wanted
from .pieces import Array, Pieces, cut_patches

__all__ = ["coverage", "coverage_of"]

# The coverage is known when no place can be farther than this times what was found.
TIGHT = 1.1
# Samples are looked for within so many times their spacing first.
SPACINGS = 2.0
MOST_CUTS = 40


def coverage_of(points: NDArray[np.floating], spline: Spline, threads: int | None) -> float:
    """Return what `Samples.coverage` returns."""
    wanted = Wanted(spline, Law(floor=1.0), threads)
    return coverage(wanted, wanted.places(points)) / wanted.unit


def coverage(wanted: Wanted, points: Array, asked: float = math.inf) -> float:
    """Return how far a place of the surface can be from the nearest of points (N, 3), at most.

    Points and the distance are as in a `Cover`. Triangles that may hold a place that is farther
    than the middles of others are cut, until none does, nor one that is farther than asked, if no
    middle is. Infinite if there is no point.
    """
    if len(points) == 0:
        return math.inf
    samples = np.column_stack([points, np.zeros_like(points)])
    pieces = cut_patches(wanted, math.inf)
    reach = SPACINGS * math.sqrt(wanted.area / len(points)) or 1.0
    largest = found = 0.0
    for _ in range(MOST_CUTS):
        distances = _distances(pieces, samples, reach)
        bounds, found = distances + pieces.extents, max(found, float(distances.max()))
        far = bounds > (asked if found <= asked < TIGHT * found else TIGHT * found)
        largest = max(largest, float(bounds[~far].max(initial=0.0)))
        if not far.any():
            break
        reach, pieces = float(bounds.max()), pieces[far].halves.halves
    else:
        largest = max(largest, reach)
    return largest


def _distances(pieces: Pieces, samples: Array, reach: float) -> Array:
    """Return how far the middles of pieces (M,) are from the nearest of samples without normals.

    That is fast where one is within reach.
    """
    rows = pieces.middles()
    rows[:, 3:7] = 1.0  # all of one weight; a sample without a normal is on every side
    candidates = Candidates(rows, reach)
    candidates.tell(samples, reach)
    distances = candidates.distances
    unknown = distances > reach
    if unknown.any():
        distances[unknown] = tree_of(samples[:, :3]).query(rows[unknown, :3])[0]
    return distances
