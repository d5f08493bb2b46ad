"""Triangles of a trimmed surface: what lies outside the trim is dropped.

A triangle is represented by its place, at which a sample may be put: its centroid, or if that is
outside, another point of it that is inside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..spline.inside import FINEST, Inside, parameters_of, subcentroids

if TYPE_CHECKING:
    from .triangles import Triangles

__all__ = ["inside_trim"]

Array = NDArray[np.float64]

# A triangle with its centroid outside is tested at the centroids of its parts, PARTS² of them. If
# all of these are outside, it is cut, until it is so large relative to the patch, and then dropped.
PARTS = 4
SMALLEST = PARTS / FINEST


def inside_trim(triangles: Triangles) -> Triangles:
    """Return the triangles that have a part inside the trim of their spline."""
    inside = triangles.sizing.spline.inside
    if inside is None:
        return triangles
    triangles = triangles[inside.reached[triangles.patches]]
    at_centroid = _contains(triangles, triangles.centroids)
    found = triangles[at_centroid]
    left = triangles[~at_centroid]
    left = left[_may_reach(left, inside)]
    while len(left):
        left, some = _with_places(left)
        found += left[some]
        left = left[~some]
        large = np.ptp(left.corners[:, :, 0], axis=1) > SMALLEST
        left = left[large].uncut_quarters
        at_centroid = _contains(left, left.centroids)
        found += left[at_centroid]
        left = left[~at_centroid]
    found = found[np.argsort(found.patches, kind="stable")]
    return found.at(found.uv)


def _may_reach(triangles: Triangles, inside: Inside) -> NDArray[np.bool_]:
    """Say which triangles with centroids outside may have a part inside."""
    spline, width = triangles.sizing.spline, len(inside.near) // triangles.sizing.spline.cells[0]
    small = np.abs(np.diff(triangles.corners, axis=1)).max(axis=(1, 2)) <= 1.0 / width
    return ~small | inside.is_near(spline, triangles.patches, triangles.centroids)


def _with_places(triangles: Triangles) -> tuple[Triangles, NDArray[np.bool_]]:
    """Give triangles places inside, in the middle of those known; say which ones have one."""
    places = subcentroids(PARTS)
    first, along, across = np.moveaxis(triangles.corners, 1, 0)[..., None, :]
    points = first + places[:, :1] * (along - first) + places[:, 1:] * (across - first)
    is_inside = _contains(triangles, points)
    number = is_inside.sum(axis=1)
    mean = np.where(is_inside[..., None], points, 0.0).sum(axis=1) / np.maximum(number, 1)[:, None]
    squares = ((points - mean[:, None]) ** 2).sum(axis=2)
    best = np.where(is_inside, squares, np.inf).argmin(axis=1)
    return triangles.at(points[np.arange(len(points)), best]), number > 0


def _contains(triangles: Triangles, places: Array) -> NDArray[np.bool_]:
    """Say which places (M, …, 2) of triangles are inside the trim."""
    spline = triangles.sizing.spline
    assert spline.trim is not None
    each = places[0, ..., 0].size if len(places) else 1
    uv = parameters_of(spline, np.repeat(triangles.patches, each), places.reshape(-1, 2))
    return spline.trim.contains(uv, triangles.sizing.threads).reshape(places.shape[:-1])
