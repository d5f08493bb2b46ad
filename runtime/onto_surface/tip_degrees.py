"""How often the normals at a tip cover a direction: the degree of a tip.

Near a tip the surface is a cone over a closed curve of rays. The index of the function n·x on a
small ring around the tip is 1 − changes/2 (Banchoff), where changes is the number of changes of
sign of n·ray. The index is the sum of the degrees at n and at −n. Their difference is the winding
number of the normals of the cone around n.

A cone through finitely many rays has wrong signs for normals that nearly touch the surface between
two of them: n·ray has an extreme value near 0 there. The ray next to it is moved to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..base.kept import kept
from ..spline.tips import collapsed_sides
from .on_spline import OnSpline

__all__ = ["Tip", "tip_degrees", "tips_on"]

# The least number of rays of a tip of a surface.
RAYS = 1 << 11
# An extreme value is searched by cutting an interval into PARTS, TIMES times: the last intervals
# are 5e-8 rad long, and the error of the value is of the order of the square of that.
PARTS, TIMES = 32, 4
PRODUCTS_AT_A_TIME = 1 << 20
ROUNDING = 1e-9


class Tip(NamedTuple):
    """A tip of a surface: its point (3,), one of its parameter pairs (2,), and its rays (k, 3).

    The rays are anticlockwise around it; `bends` (k,) are the sizes of their second differences,
    and `ray_at` returns rays at fractional indices (m,). The degree is `outside` at all normals n
    with n·axis < cosine.
    """

    point: Array
    uv: Array
    rays: Array
    bends: Array
    ray_at: Callable[[Array], Array]
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
            given = normals[some]
            heights = self.rays @ given.T
            found[some] = self._degrees(self.rays, heights, given)
            small = np.abs(heights).min(axis=0) <= self.bends.max()
            for k in np.flatnonzero(small):
                rays = self._with_extremes(given[k], heights[:, k])
                found[some[k]] = self._degrees(rays, (rays @ given[k])[:, None], given[[k]])[0]
        return found

    def _degrees(self, rays: Array, heights: Array, normals: Array) -> NDArray[np.int64]:
        """Return the degrees of a cone at normals (S, 3), from the heights (k, S) of its rays."""
        # All normals that have the whole cone below them have the same degree.
        is_below, found = (heights < 0.0).all(axis=0), np.empty(len(normals), np.int64)
        found[~is_below] = _degrees(rays, normals[~is_below])
        if is_below.any():
            is_axis = (rays @ self.axis < 0.0).all()
            found[is_below] = _degrees(rays, self.axis[None] if is_axis else normals[is_below][:1])
        return found

    def _with_extremes(self, normal: Array, heights: Array) -> Array:
        """Return the rays; rays next to an extreme value of n·ray that may be 0 are moved to it.

        The heights (k,) are n·ray.
        """
        rays, signs = self.rays.copy(), np.sign(heights)
        before, here, after = (signs * np.roll(heights, x) for x in (1, 0, -1))
        near = (here < before) & (here <= after) & (here <= self.bends)
        for k in np.flatnonzero(near):
            middle, half = float(k), 1.0
            for _ in range(TIMES):
                places = middle + half * np.linspace(-1.0, 1.0, PARTS + 1)
                beside = self.ray_at(places)
                least = int((signs[k] * (beside @ normal)).argmin())
                middle, half = places[least], 2.0 * half / PARTS
                rays[k] = beside[least]
        return rays


def tip_degrees(geometry: OnSpline, normals: Array) -> NDArray[np.int64]:
    """Return the sums (S,) of the degrees of all tips of a surface at unit normals (S, 3)."""
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
    """Return the tip at one end of the domain along an axis, if there are rays all around it."""
    spline = geometry.spline
    parts = spline.cells[1 - axis]
    if geometry.on == "surface":
        parts *= math.ceil(RAYS / parts)
    (low, high), place = spline.domain[1 - axis], spline.domain[axis][end]

    def uv_at(numbers: Array) -> Array:
        """Return parameters at fractional indices of rays, all anticlockwise or all clockwise."""
        turns = (numbers if axis == end else parts - 1.0 - numbers) / parts
        along = low + (high - low) * (turns % 1.0)
        fixed = np.full_like(along, place)
        return np.stack((fixed, along) if axis == 0 else (along, fixed), axis=1)

    def ray_at(numbers: Array) -> Array:
        jets = geometry.jets(*uv_at(numbers).T.copy())
        return _unit(jets[:, 1 + axis] * (1.0, -1.0)[end])

    rays = ray_at(np.arange(parts, dtype=np.float64))
    if not rays.any(axis=1).all():
        return None
    second = np.roll(rays, 1, axis=0) - 2.0 * rays + np.roll(rays, -1, axis=0)
    bends = np.linalg.norm(second, axis=1)
    normals = _unit(np.cross(rays, np.roll(rays, -1, axis=0)))
    normals = normals[normals.any(axis=1)]
    mean = _unit(normals.sum(axis=0)[None])
    cosine = float((normals @ mean[0]).min(initial=1.0)) - float(bends.max()) - ROUNDING
    # A cap smaller than a half-sphere contains all normals at the tip, and the arcs between them.
    cosine = cosine if cosine > 0.0 else -math.inf
    outside = int(_degrees(rays, -mean)[0]) if mean.any() else 0
    uv = uv_at(np.zeros(1) if axis == end else np.full(1, parts - 1.0))
    point = geometry.jets(*uv.T.copy())[0, 0]
    return Tip(point, uv[0], rays, bends, ray_at, mean[0], cosine, outside)


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
