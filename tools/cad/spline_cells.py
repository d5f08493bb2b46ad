"""The cells of splines of faces: as few as the turning of tangents and normals needs.

The fit of any surface begins with 64 × 64 cells and is compared with it at thousands of places,
which takes longer than the sampling of a small face. Most faces are planes and cylinders.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...runtime.surface.derivatives import Differentiable
from ...runtime.surface.surface import Surface
from .offset_surface import knots_of

__all__ = ["search_cells", "spline_cells"]

Array = NDArray[np.float64]

# On spheres, cones and tori, a spline with cells of 10° has normals within 0.1° and points within
# 1e-4 of the diameter, as the default of a fit.
ANGLE = math.radians(10.0)
FEWEST, MOST = 3, 256
# Preimages of normals are searched on finer splines. What a spline is off, it loses at the border:
# with fewer cells, one of 2,105 samples of a test part was lost.
FINER, FEWEST_TO_SEARCH = 2, 64
# The lines along u, and along v, on which turning is measured: at least and at most.
LEAST_LINES, LINES_A_SPAN, MOST_LINES = 17, 3, 97
# Tangents and normals that are shorter than this, relative to the longest, have no direction.
SINGULAR = 1e-9


def spline_cells(surface: Surface) -> tuple[int, int]:
    """Return numbers of cells along u and v for the spline of a face or one of its pieces."""
    counts = [_lines(surface, axis) for axis in (0, 1)]
    u, v = (
        low + (high - low) * (np.arange(n) + 0.5) / n
        for n, (low, high) in zip(counts, surface.domain, strict=True)
    )
    places = np.meshgrid(u, v, indexing="ij")
    jets = surface.jets(*(x.ravel() for x in places)).reshape(*counts, 6, 3)
    x_u, x_v = (_directions(jets[:, :, k]) for k in (1, 2))
    normals = _directions(np.cross(jets[:, :, 1], jets[:, :, 2]))
    along_u = _cells(x_u, normals)
    along_v = _cells(np.swapaxes(x_v, 0, 1), np.swapaxes(normals, 0, 1))
    return along_u, along_v


def search_cells(surface: Surface) -> tuple[int, int]:
    """Return numbers of cells of the spline on which the preimages of normals are searched."""
    u, v = (min(max(FINER * x, FEWEST_TO_SEARCH), MOST) for x in spline_cells(surface))
    return u, v


def _lines(surface: Surface, axis: int) -> int:
    if not isinstance(surface.function, Differentiable):
        return LEAST_LINES
    knots, (low, high) = knots_of(surface.function, axis), surface.domain[axis]
    spans = len(np.unique(knots[(knots > low) & (knots < high)])) + 1
    return min(max(LINES_A_SPAN * spans, LEAST_LINES), MOST_LINES)


def _directions(vectors: Array) -> Array:
    """Return unit vectors, NaN where vectors vanish."""
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    real = lengths > SINGULAR * np.max(lengths, where=np.isfinite(lengths), initial=0.0)
    return np.divide(vectors, lengths, out=np.full_like(vectors, np.nan), where=real)


def _cells(*fields: Array) -> int:
    """Return the number of cells for unit vectors (k, l, 3) that turn along the first axis."""
    turning = 0.0
    for field in fields:
        chords = np.linalg.norm(np.diff(field, axis=0), axis=-1)
        angles = 2.0 * np.arcsin(np.minimum(np.nan_to_num(chords) / 2.0, 1.0))
        # The lines begin and end half a step inside the domain.
        turning = max(turning, float(angles.sum(axis=0).max()) * len(field) / len(angles))
    return min(max(math.ceil(turning / ANGLE - 1e-9), FEWEST), MOST)
