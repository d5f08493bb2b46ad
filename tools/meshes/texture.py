"""Texture coordinates of a mesh: its parameters, without jumps inside triangles."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.domain.domain import Boundary, Domain
from .places import ON_SIDE, wrapped

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Texture(NamedTuple):
    """Texture coordinates (K, 2), and for each corner of the triangles their index (T, 3).

    The first rows of the coordinates belong to the vertices, in order. Further rows are for
    triangles that cross a seam, or have a corner at a pole.
    """

    places: Array
    corners: Indices


def corner_places(
    uv: Array, triangles: Indices, domain: Domain | None, boundary: Boundary | None
) -> Array:
    """Return texture coordinates (T, 3, 2) of corners: parameters, with the domain scaled to 1 × 1.

    Across a seam they continue beyond 1. A corner at a pole gets the mean coordinate of the two
    other corners. Without a domain or boundary conditions they are the parameters.
    """
    if domain is None or boundary is None:
        return uv[triangles]
    found = _scaled(uv, domain)[triangles]
    at_pole = np.zeros((*triangles.shape, 2), dtype=np.bool_)
    for axis, ends in enumerate(boundary):
        for place, end in enumerate(ends):
            if end == "pole":
                at_pole[..., 1 - axis] |= np.abs(found[..., axis] - place) <= ON_SIDE
    anchor = at_pole.any(axis=2).argmin(axis=1)[:, None, None]
    around = np.take_along_axis(found, anchor, axis=1)
    found = wrapped(found, boundary, np.broadcast_to(around, found.shape))
    for axis, (end, _) in enumerate(boundary):
        if end == "periodic":
            low = np.where(at_pole[..., axis], np.inf, found[..., axis]).min(axis=1)
            found[..., axis] += (low < 0.0)[:, None]
    others = np.where(at_pole, 0.0, found).sum(axis=1, keepdims=True)
    number = np.maximum((~at_pole).sum(axis=1, keepdims=True), 1)
    return np.where(at_pole, others / number, found)


def split_at_seams(
    uv: Array, triangles: Indices, domain: Domain | None, boundary: Boundary | None
) -> Texture:
    """Return the texture coordinates of a mesh, several for a vertex at a seam."""
    if domain is None or boundary is None:
        return Texture(uv, triangles)
    places = _scaled(uv, domain)
    found = corner_places(uv, triangles, domain, boundary)
    moved = (found != places[triangles]).any(axis=2)
    rows = np.column_stack([triangles[moved], found[moved]])
    new, number = np.unique(rows, axis=0, return_inverse=True)
    corners = triangles.copy()
    corners[moved] = len(uv) + number.ravel()
    return Texture(np.concatenate([places, new[:, 1:].astype(np.float64)]), corners)


def _scaled(uv: Array, domain: Domain) -> Array:
    low, high = np.array(domain).T
    return (uv - low) / (high - low)
