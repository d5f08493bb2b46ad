"""The degree of a tip at a normal: the signed number of times that normals at the tip cover it.

Near a tip the surface is approximately a cone of rays. The index of the height n·x at the tip is
1 − changes/2 (Banchoff), where changes is the number of sign changes of n·ray around the tip. This
index is the sum of the degrees at n and at −n; their difference is the winding number of the
normals of the cone around n.

The cone is represented by finitely many rays. If n·ray has an extreme value near 0 between two of
them, sign changes may be missed; therefore the nearest ray is moved to the extreme value.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..base.kept import kept
from ..directions.unit import unit_or_zero
from ..domain.domain import Boundary, Domain
from ..domain.trim import Trim
from ..spline.joints import EDGES
from ..spline.nets import NetSpline
from ..spline.tips import are_one, collapsed_sides, tips_of
from ..tape.tapes import jets_of
from .on_spline import OnPatches, OnSpline
from .proved import ProvedSurface

Jets = Callable[[Array, Array], Array]

# A tip of a surface is represented by at least this number of rays.
RAYS = 1 << 11
# To find an extreme value, an interval is cut into PARTS parts, TIMES times. The last parts have a
# length of 5e-8 rad, and the error of the value is of the order of its square.
PARTS, TIMES = 32, 4
PRODUCTS_AT_A_TIME = 1 << 20
ROUNDING = 1e-9
# Two rays count as one if their distance is at most this.
SAME_RAY = 1e-6
# A side counts as collapsed if this number of its points coincide.
ALONG = 65
# A tip counts as inside a trim if the parameter line at the distance BESIDE (relative to the
# domain) from the collapsed line of the tip is inside.
BESIDE = 1e-6


class Fan(NamedTuple):
    """Rays (k, 3) from a point of one surface or patch, in anticlockwise order.

    `point` is its position, `uv` one of its parameter pairs; on a spline of nets, these are the
    parameters in the patch with the index `patch`. `bends` (k,) are the lengths of the second
    differences of the rays; `ray_at` returns the rays at fractional indices (m,).
    """

    point: Array
    uv: Array
    rays: Array
    bends: Array
    ray_at: Callable[[Array], Array]
    patch: int = -1


class Tip(NamedTuple):
    """A tip of a surface: the fans around it are joined to rays (k, 3) all around.

    `point`, `uv`, `patch`, `bends` and `ray_at` are those of a `Fan`. All normals n with
    n·axis < cosine have the degree `outside`.
    """

    point: Array
    uv: Array
    patch: int
    rays: Array
    bends: Array
    ray_at: Callable[[Array], Array]
    axis: Array
    cosine: float
    outside: int

    @classmethod
    def of(cls, fans: Sequence[Fan]) -> Tip | None:
        """Return the tip of fans in anticlockwise order; None if all rays are in one plane.

        Each fan begins with the ray with which the fan before it ends.
        """
        rays = np.concatenate([x.rays[:-1] for x in fans])
        bends = np.concatenate([x.bends[:-1] for x in fans])
        starts = np.cumsum([0, *(len(x.rays) - 1 for x in fans)])

        def ray_at(numbers: Array) -> Array:
            numbers = numbers % starts[-1]
            which, found = (
                np.searchsorted(starts, numbers, "right") - 1,
                np.empty((len(numbers), 3)),
            )
            for k in np.unique(which).tolist():
                found[which == k] = fans[k].ray_at(numbers[which == k] - starts[k])
            return found

        normals = unit_or_zero(np.cross(rays, np.roll(rays, -1, axis=0)))
        normals = normals[normals.any(axis=1)]
        mean = unit_or_zero(normals.sum(axis=0)[None])
        if not np.abs(rays @ mean[0]).max() > ROUNDING:
            return None  # smooth, but not a pole: the parameters do not follow opposite meridians
        cosine = float((normals @ mean[0]).min(initial=1.0)) - float(bends.max()) - ROUNDING
        # A cap that contains all normals contains the arcs between them only if it is smaller than
        # a half-sphere.
        cosine = cosine if cosine > 0.0 else -math.inf
        outside = int(_degrees(rays, -mean)[0]) if mean.any() else 0
        point, uv, patch = fans[0].point, fans[0].uv, fans[0].patch
        return cls(point, uv, patch, rays, bends, ray_at, mean[0], cosine, outside)

    def degrees(self, normals: Array) -> NDArray[np.int64]:
        """Return the degree of the tip at each of the unit normals (S, 3)."""
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
        """Return the degree of a cone of rays at normals (S, 3); heights (k, S) are n·ray."""
        # All normals for which the whole cone is below the tangent plane have the same degree.
        is_below, found = (heights < 0.0).all(axis=0), np.empty(len(normals), np.int64)
        found[~is_below] = _degrees(rays, normals[~is_below])
        if is_below.any():
            is_axis = (rays @ self.axis < 0.0).all()
            found[is_below] = _degrees(rays, self.axis[None] if is_axis else normals[is_below][:1])
        return found

    def _with_extremes(self, normal: Array, heights: Array) -> Array:
        """Return the rays, after moving some to extreme values of n·ray that are nearly 0.

        The heights (k,) are n·ray; a ray is moved if it is the one next to the extreme value.
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


class Pinch(NamedTuple):
    """A parameter line inside the domain that is collapsed to a point: two tips that are joined.

    One tip is `above` the line in its parameter, one `below`. The surface near the line is an
    annulus, not two disks, and its Euler characteristic is 0 instead of 2. Therefore the degree is
    the sum of the degrees of both tips minus 1.
    """

    above: Tip
    below: Tip

    @property
    def point(self) -> Array:
        """The position (3,) of the point."""
        return self.above.point

    @property
    def uv(self) -> Array:
        """One of its parameter pairs (2,)."""
        return self.above.uv

    def degrees(self, normals: Array) -> NDArray[np.int64]:
        """Return the degree of the point at each of the unit normals (S, 3)."""
        return self.above.degrees(normals) + self.below.degrees(normals) - 1


def tip_degrees(geometry: OnPatches | ProvedSurface, normals: Array) -> NDArray[np.int64]:
    """Return, for each of the unit normals (S, 3), the sum of the degrees of all tips at it."""
    found = np.zeros(len(normals), np.int64)
    for tip in tips_on(geometry):
        found += tip.degrees(normals)
    return found


def tips_on(geometry: OnPatches | ProvedSurface) -> Sequence[Tip | Pinch]:
    """Return the tips of a geometry; they are cached with its spline or index."""
    if isinstance(geometry, ProvedSurface):
        surface, index = geometry.surface, geometry.index
        lines = [(x.axis, x.end) for x in index.apexes if x.inside]

        def jets(u: Array, v: Array) -> Array:
            return jets_of(index.tape, u, v)

        around = Tipped(jets, surface.domain, surface.boundary, surface.trim)
        return kept(index, "tips", lambda: around.tips(around.sides(), lines))
    if not geometry.has_tips:
        return []
    nets = geometry.spline
    if isinstance(nets, NetSpline):
        return kept(nets, "tips", lambda: _tips_of_nets(nets))
    assert isinstance(geometry, OnSpline)
    whole = geometry.whole or geometry
    spline = whole.spline
    least = RAYS if whole.on == "surface" else 1
    parts = [x * math.ceil(least / x) for x in spline.cells]
    around = Tipped(whole.jets, spline.domain, spline.boundary, spline.trim, (parts[0], parts[1]))
    return kept(spline, f"tips, {whole.on}", lambda: around.tips(collapsed_sides(spline)))


class Tipped(NamedTuple):
    """A surface that may have tips: its 2-jets, domain and trim.

    `parts` are the numbers of rays of a tip at a line v = const, along which u varies, and of a tip
    at a line u = const.
    """

    jets: Jets
    domain: Domain
    boundary: Boundary
    trim: Trim | None
    parts: tuple[int, int] = (RAYS, RAYS)

    def sides(self) -> list[tuple[int, int]]:
        """Return the open sides that are collapsed: the axis (0 for u) and the end, 0 or 1."""
        points, steps = list[Array](), np.linspace(0.0, 1.0, ALONG)
        for axis, end in np.ndindex(2, 2):
            low, high = self.domain[1 - axis]
            places = np.full(ALONG, self.domain[axis][end]), low + (high - low) * steps
            points.append(self.jets(*(places if axis == 0 else places[::-1]))[:, 0])
        size = float(np.ptp(points, axis=(0, 1)).max())
        return [
            (axis, end)
            for axis, end in np.ndindex(2, 2)
            if self.boundary[axis][end] == "open" and are_one(points[2 * axis + end], size)
        ]

    def tips(
        self, sides: Sequence[tuple[int, int]], lines: Sequence[tuple[int, float]] = ()
    ) -> list[Tip | Pinch]:
        """Return the tips at collapsed sides (axis, end) and at collapsed lines (axis, value)."""
        found: list[Tip | Pinch] = [x for _, x in tips_of_fans(self.fans(sides), 0.0)]
        for axis, place in lines:
            fans = [x for x in (self._fan(axis, place, end) for end in (0, 1)) if x]
            cones = [x for _, x in tips_of_fans(fans, 0.0)]
            found += [Pinch(*cones)] if len(cones) == 2 else []
        return found

    def fans(self, sides: Sequence[tuple[int, int]]) -> list[Fan]:
        """Return the fans at collapsed sides (axis, end)."""
        found = (self._fan(axis, self.domain[axis][end], end) for axis, end in sides)
        return [x for x in found if x is not None]

    def _fan(self, axis: int, place: float, end: int) -> Fan | None:
        """Return the fan at the line where a parameter is `place`; None if it is not in the trim.

        On the surface this parameter is larger than `place` if `end` is 0, and smaller if it is 1.
        """
        parts, (low, high), way = self.parts[1 - axis], self.domain[1 - axis], (1.0, -1.0)[end]

        def uv_at(numbers: Array, away: float = 0.0) -> Array:
            """Return the parameters at which rays with fractional indices leave the line.

            Their distance from the line is `away`, relative to the domain.
            """
            turns = (numbers if axis == end else parts - numbers) / parts
            along = low + (high - low) * turns
            fixed = np.full_like(along, place + way * away * np.ptp(self.domain[axis]))
            return np.stack((fixed, along) if axis == 0 else (along, fixed), axis=1)

        def ray_at(numbers: Array) -> Array:
            return unit_or_zero(self.jets(*uv_at(numbers).T.copy())[:, 1 + axis] * way)

        numbers = np.arange(parts + 1.0)
        if self.trim is not None and not self.trim.contains(uv_at(numbers[1:-1], BESIDE)).all():
            return None
        rays = ray_at(numbers)
        if not rays.any(axis=1).all():
            return None
        bends = np.linalg.norm(rays[:-2] - 2.0 * rays[1:-1] + rays[2:], axis=1)
        uv = uv_at(np.array([0.0 if axis == end else parts]))
        point = self.jets(*uv.T.copy())[0, 0]
        return Fan(point, uv[0], rays, np.pad(bends, 1, "edge"), ray_at)


def tips_of_fans(fans: Sequence[Fan], same: float) -> Iterator[tuple[list[int], Tip]]:
    """Yield each tip, with the indices of the fans that form the cone around it.

    The points of two fans count as one if their distance is at most `same`.
    """
    if not fans:
        return
    first, last = (np.array([x.rays[k] for x in fans]) for k in (0, -1))
    points = np.array([x.point for x in fans])
    joined = np.linalg.norm(last[:, None] - first, axis=2) <= SAME_RAY
    joined &= np.linalg.norm(points[:, None] - points, axis=2) <= same
    following = np.where(joined.any(axis=1), joined.argmax(axis=1), -1).tolist()
    left = set(range(len(fans)))
    while left:
        around, k = list[int](), min(left)
        while k in left:
            left.remove(k)
            around.append(k)
            k = following[k]
        tip = Tip.of([fans[x] for x in around]) if k == around[0] else None
        if tip is not None:
            yield around, tip


def _tips_of_nets(spline: NetSpline) -> list[Tip]:
    """Return the tips of nets; at a tip, the rays of a patch lie between tangents of two edges."""
    tips, nets, found = tips_of(spline), spline.control_nets, list[Fan]()
    if tips is None:
        return []
    at = tips.hold(nets[:, :3].reshape(-1, 3)).reshape(-1, 3)
    # Edge j runs from corner j + 1 to corner j + 2.
    starts, ends = np.roll(at, -1, axis=1), np.roll(at, -2, axis=1)
    for patch in np.flatnonzero(tips.touching & ~at.all(axis=1)).tolist():
        leaving = EDGES[int((starts & ~ends)[patch].argmax())]
        coming = EDGES[int((ends & ~starts)[patch].argmax())]
        net, corners = nets[patch], [leaving.start, coming.end]
        rays = unit_or_zero(net[[leaving.middle, coming.middle]] - net[corners])
        if np.linalg.norm(rays[1] - rays[0]) > SAME_RAY:
            uv = np.eye(3)[corners[0], :2]
            found.append(
                Fan(net[corners[0]], uv, rays, np.zeros(2), partial(_between, rays), patch)
            )
    return [x for _, x in tips_of_fans(found, tips.same)]


def _between(rays: Array, shares: Array) -> Array:
    """Return the unit rays (m, 3) between two rays, for shares of the way from one to the other."""
    return unit_or_zero(rays[0] + shares[:, None] * (rays[1] - rays[0]))


def _degrees(rays: Array, normals: Array) -> NDArray[np.int64]:
    """Return the degree of a cone of rays (k, 3) at each of the unit normals (S, 3)."""
    positive = rays @ normals.T >= 0.0
    changes = (positive != np.roll(positive, 1, axis=0)).sum(axis=0)
    of_cone = np.cross(rays, np.roll(rays, -1, axis=0))
    across = np.cross(np.eye(3)[np.abs(normals).argmin(axis=1)], normals)
    angles = np.arctan2(of_cone @ np.cross(normals, across).T, of_cone @ across.T)
    steps = np.diff(angles, axis=0, append=angles[:1])
    steps -= 2.0 * math.pi * np.rint(steps / (2.0 * math.pi))
    turns = steps.sum(axis=0) / (2.0 * math.pi)
    return np.rint((1.0 - changes / 2.0 + turns) / 2.0).astype(np.int64)
