"""Distances of points from a polygon."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...runtime.base.checks import real_array
from ...runtime.base.errors import InputError

__all__ = ["polygon_distance"]

PAIRS_AT_A_TIME = 1 << 18


def polygon_distance(points: ArrayLike, polygon: ArrayLike) -> NDArray[np.float64]:
    """Return the distances of points from a polygon.

    The largest distance of many points of a curve approximates the one-sided Hausdorff distance of
    the curve from the polygon.

    Parameters
    ----------
    points : (k, 2) array_like
        The points.
    polygon : (m, 2) array_like
        The vertices in order; a closed polygon repeats its first vertex at its end.

    Returns
    -------
    (k,) float64 array
        The distances.

    Raises
    ------
    InputError
        For other shapes, an empty polygon, NaN or infinity.

    Examples
    --------
    >>> import gaussmap as gm
    >>> gm.curves.polygon_distance([[0, 1], [3, 0]], [[0, 0], [2, 0]]).tolist()
    [1.0, 1.0]

    """
    places, vertices = _plane(points, "points"), _plane(polygon, "polygon")
    if len(vertices) == 0:
        raise InputError("a polygon needs at least one vertex.")
    largest = max(float(np.abs(x).max(initial=0.0)) for x in (places, vertices))
    exponent = math.frexp(largest)[1]  # scaling keeps squares from overflow and underflow
    places, vertices = np.ldexp(places, -exponent), np.ldexp(vertices, -exponent)
    starts = vertices[:-1] if len(vertices) > 1 else vertices
    edges = vertices[1:] - starts if len(vertices) > 1 else np.zeros_like(vertices)
    squares = np.einsum("mx,mx->m", edges, edges)
    squares[squares == 0.0] = 1.0
    parts = max(1, len(places) * len(starts) // PAIRS_AT_A_TIME)
    pieces = np.array_split(places, parts)
    distances = np.concatenate([_nearest(x, starts, edges, squares) for x in pieces])
    return np.ldexp(distances, exponent)


def _nearest(
    places: NDArray[np.float64],
    starts: NDArray[np.float64],
    edges: NDArray[np.float64],
    squares: NDArray[np.float64],
) -> NDArray[np.float64]:
    along = places[:, None] - starts
    share = np.clip(np.einsum("kmx,mx->km", along, edges) / squares, 0.0, 1.0)
    across = along - share[..., None] * edges
    return np.sqrt(np.einsum("kmx,kmx->km", across, across).min(axis=1))


def _plane(values: ArrayLike, name: str) -> NDArray[np.float64]:
    array = real_array(values, name)
    if array.ndim != 2 or array.shape[1] != 2:
        raise InputError(f"{name} must have the shape (k, 2), not {array.shape}.")
    if not np.isfinite(array).all():
        row = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise InputError(f"{name}[{row}] holds NaN or infinity.")
    return array
