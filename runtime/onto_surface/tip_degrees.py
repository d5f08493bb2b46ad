"""How often the normals at a tip cover a direction: its part in the degree of the Gauss map.

Near a tip the surface is a cone over a closed curve of rays. On a small ring round the tip the
function n·x has 1 − changes/2 as its index (Banchoff), where changes counts changes of the sign
of n·ray; this is the sum of the degrees at n and at −n. Their difference is the winding number of
the normals of the cone round n.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..base.kept import kept
from ..spline.tips import collapsed_sides
from .on_spline import OnSpline

__all__ = ["Tip", "tip_degrees", "tips_on"]

# On a surface, the rays of a tip are at least as many: normals are 1e-6 off between them.
RAYS = 1 << 11
PRODUCTS_AT_A_TIME = 1 << 20
ROUNDING = 1e-9


class Tip(NamedTuple):
    """A tip of a surface: its point (3,), one of its parameter pairs (2,), and its rays (k, 3).

    The rays are anticlockwise around it. The degree is `outside` at all normals n with n·axis <
    cosine.
    """

    point: Array
    uv: Array
    rays: Array
    axis: Array
    cosine: float
    outside: int

    def degrees(self, normals: Array) -> NDArray[np.int64]:
        """Return the degrees (S,) at unit normals (S, 3)."""
        found = np.full(len(normals), self.outside, np.int64)
        near = np.flatnonzero(normals @ self.axis >= self.cosine)
        size = max(PRODUCTS_AT_A_TIME // len(self.rays), 1)
        for first in range(0, len(near), size):
            some = near[first : first + size]
            # Normals below which the whole cone lies have one degree.
            is_below = (self.rays @ normals[some].T < 0.0).all(axis=0)
            below, rest = some[is_below], some[~is_below]
            found[rest] = _degrees(self.rays, normals[rest])
            found[below] = _degrees(self.rays, normals[below[:1]])
        return found


def tip_degrees(geometry: OnSpline, normals: Array) -> NDArray[np.int64]:
    """Return the sum (S,) over the tips of a surface of their degrees at unit normals (S, 3)."""
    found = np.zeros(len(normals), np.int64)
    for tip in tips_on(geometry):
        found += tip.degrees(normals)
    return found


def tips_on(geometry: OnSpline) -> list[Tip]:
    """Return the tips with a degree, which are kept with the spline; none if it is trimmed."""
    return kept(geometry.spline, f"tips, {geometry.on}", lambda: _tips(geometry))


def _tips(geometry: OnSpline) -> list[Tip]:
    found, spline = list[Tip](), geometry.spline
    for axis, end in [] if spline.trim is not None else collapsed_sides(spline):
        if spline.boundary[1 - axis][0] != "periodic":
            continue
        if (tip := _tip(geometry, axis, end)) is not None:
            found.append(tip)
    return found


def _tip(geometry: OnSpline, axis: int, end: int) -> Tip | None:
    """Return the tip that is one end of the domain along an axis, if it has rays all round."""
    spline = geometry.spline
    parts = spline.cells[1 - axis]
    if geometry.on == "surface":
        parts *= math.ceil(RAYS / parts)
    along = np.linspace(*spline.domain[1 - axis], parts, endpoint=False)
    place = np.full(parts, spline.domain[axis][end])
    uv = np.stack((place, along) if axis == 0 else (along, place), axis=1)
    jets = geometry.jets(*uv.T.copy())
    rays = _unit(jets[:, 1 + axis] * (1.0, -1.0)[end])
    if not rays.any(axis=1).all():
        return None
    # The other parameter runs anticlockwise round the tip, or clockwise.
    rays = rays if axis == end else rays[::-1]
    normals = _unit(np.cross(rays, np.roll(rays, -1, axis=0)))
    normals = normals[normals.any(axis=1)]
    mean = _unit(normals.sum(axis=0)[None])
    cosine = float((normals @ mean[0]).min(initial=1.0)) - ROUNDING
    # A cap below a half-sphere holds all normals at the tip, and the arcs between them.
    cosine = cosine if cosine > 0.0 else -math.inf
    outside = int(_degrees(rays, -mean)[0]) if mean.any() else 0
    return Tip(jets[0, 0], uv[0], rays, mean[0], cosine, outside)


def _unit(vectors: Array) -> Array:
    """Return vectors (k, 3) with length 1, or 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)


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
