"""How often the normals at a tip cover a direction: its part in the degree of the Gauss map.

Near a tip the surface is a cone over a closed curve of rays. On a small ring round the tip the
function n·x has 1 − changes/2 as its index (Banchoff), where changes counts changes of the sign
of n·ray; this is the sum of the degrees at n and at −n. Their difference is the winding number of
the normals of the cone round n.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..base.kept import kept
from ..spline.tips import collapsed_sides
from .on_spline import OnSpline

__all__ = ["tip_degrees"]

# On a surface, the rays of a tip are at least as many: normals are 1e-6 off between them.
RAYS = 1 << 11
PRODUCTS_AT_A_TIME = 1 << 20


def tip_degrees(geometry: OnSpline, normals: Array) -> NDArray[np.int64]:
    """Return the sum (S,) over the tips of a surface of their degrees at unit normals (S, 3)."""
    found = np.zeros(len(normals), np.int64)
    for rays in kept(geometry.spline, f"rays of tips, {geometry.on}", lambda: _tips(geometry)):
        size = max(PRODUCTS_AT_A_TIME // len(rays), 1)
        for first in range(0, len(normals), size):
            found[first : first + size] += _degrees(rays, normals[first : first + size])
    return found


def _tips(geometry: OnSpline) -> list[Array]:
    """Return the rays (k, 3) of each tip, anticlockwise around it; none on a trimmed surface."""
    found, spline = list[Array](), geometry.spline
    for axis, end in [] if spline.trim is not None else collapsed_sides(spline):
        if spline.boundary[1 - axis][0] != "periodic":
            continue
        rays = _rays(geometry, axis, end)
        if rays.any(axis=1).all():
            # The other parameter runs anticlockwise round the tip, or clockwise.
            found.append(rays if axis == end else rays[::-1])
    return found


def _rays(geometry: OnSpline, axis: int, end: int) -> Array:
    """Return the directions (k, 3) in which the surface leaves a tip, along the other parameter."""
    spline = geometry.spline
    parts = spline.cells[1 - axis]
    if geometry.on == "surface":
        parts *= math.ceil(RAYS / parts)
    along = np.linspace(*spline.domain[1 - axis], parts, endpoint=False)
    place = np.full(parts, spline.domain[axis][end])
    jets = geometry.jets(*((place, along) if axis == 0 else (along, place)))
    rays = jets[:, 1 + axis] * (1.0, -1.0)[end]
    lengths = np.linalg.norm(rays, axis=1, keepdims=True)
    return np.divide(rays, lengths, out=np.zeros_like(rays), where=lengths > 0.0)


def _degrees(rays: Array, normals: Array) -> NDArray[np.int64]:
    """Return the degrees (S,) of a cone at unit normals (S, 3)."""
    positive = rays @ normals.T >= 0.0
    changes = (positive != np.roll(positive, 1, axis=0)).sum(axis=0)
    of_cone = np.cross(rays, np.roll(rays, -1, axis=0))
    across = np.cross(np.eye(3)[np.abs(normals).argmin(axis=1)], normals)
    angles = np.arctan2(of_cone @ np.cross(normals, across).T, of_cone @ across.T)
    steps = np.diff(angles, axis=0, append=angles[:1])
    steps -= 2.0 * math.pi * np.rint(steps / (2.0 * math.pi))
    turns = steps.sum(axis=0) / (2.0 * math.pi)
    return np.rint((1.0 - changes / 2.0 + turns) / 2.0).astype(np.int64)
