"""Covering a spline with samples, greedily: the widest gaps first."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels
from ..samples import Samples
from ..threads import over_ranges
from .grids import grids_of
from .law import Wanted

__all__ = ["APPROACH", "FINE", "STEP", "Array", "Cover", "Indices", "quarters"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# The arrays that hold a row for each sample.
SAMPLES = ("points", "weights", "local")
TRIANGLES_AT_A_TIME = 1 << 15
# The first samples come where none is within so many times the radius that is expected, the next
# ones within STEP of that, and so on.
WIDEST, STEP = 1.3, 0.8
# n samples that are no nearer to one another than a radius r, where there is no room for another,
# have about n r² times this as what is wanted of them.
PACKED = 0.6
# The grids are made again when the radius is so many times smaller or larger than it was.
FINER = 1.5
# Triangles this small beside the radius are not cut any more. If all of the surface has to be near
# enough, and not only their middles, they are cut finer, and get a sample if need be.
FINE, FINEST = 0.7, 0.1
# The part of all patches by which one goes on from one to the next.
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
# A count is approached from below: the last but one radius shall bring so much of it.
APPROACH = 0.95


class Cover:
    """Samples that are given, and others that are added until every place is near enough to one.

    Near enough is within radius / √weight, by a `Law` of weights. Lengths are those of the spline
    times `wanted.unit`. Rows of `points` (…, 6) (and normals), `weights` and `local` (…, 4) (patch,
    u, v, K) up to `count` are the samples; the first `given` are those that were given.

    The surface is cut into triangles, smaller and smaller ones. `tell` is told how many samples
    there are, from time to time.
    """

    def __init__(
        self,
        wanted: Wanted,
        given: Samples | None,
        tell: Callable[[int], object] = lambda count: None,
    ) -> None:
        """Begin with what is given, samples of the same spline."""
        self.wanted, self.tell = wanted, tell
        self.given = self.count = 0 if given is None else len(given)
        room = max(self.given, 1024)
        self.points, self.weights = np.empty((room, 6)), np.empty(room)
        self.local, self.links = np.empty((room, 4)), np.empty(0, dtype=np.int32)
        self.heads = np.empty(0, dtype=np.int32)
        self.finest = self.grid_radius = self.radius = math.inf
        self.room, self.cut = self._whole_patches(), wanted.spline.patches
        if given is not None:
            self._take(given)

    @property
    def patches(self) -> Indices:
        """The patches that the triangles are of."""
        return self.room[0][: self.cut]

    @property
    def triangles(self) -> Array:
        """Triangles (…, 5) that make up the surface; see `cover_triangles`."""
        return self.room[1][: self.cut]

    @property
    def middles(self) -> Array:
        """Point, unit normal and K (…, 7) in the middle of the triangles."""
        return self.middles_of(self.patches, self.triangles)

    def middles_of(self, patches: Indices, triangles: Array) -> Array:
        """Return point, unit normal and K (…, 7) in the middle of triangles."""
        rows, spline = np.empty((len(patches), 7)), self.wanted.spline

        def work(first: int, last: int) -> None:
            kernels.middles(
                spline.coefficients, spline.scale, patches, triangles, first, last, rows
            )

        for _ in over_ranges(work, len(rows), TRIANGLES_AT_A_TIME, self.wanted.threads):
            pass
        return rows

    def to_radius(self, radius: float, most: int | None = None) -> None:
        """Add samples until every place is within radius / √weight of one, or there are `most`."""
        now = WIDEST * radius
        while now > radius:
            self.sweep(now, most)
            now *= STEP
        self.sweep(radius, most, FINEST, strict=True)

    def to_count(self, count: int) -> None:
        """Add samples until there are so many."""
        weight = self.wanted.total
        radius = WIDEST * math.sqrt(PACKED * weight / count)
        self.sweep(radius, count)
        while self.count == count > self.given + 1 and radius * radius < weight:
            # That is not where the widest gaps are, but those that came first.
            self.forget()
            self.room, self.cut = self._whole_patches(), self.wanted.spline.patches
            radius *= 2.0
            self.sweep(radius, count)
        self.narrow(radius, count, STEP)

    def narrow(self, radius: float, count: int, step: float, fine: float = FINE) -> None:
        """Sweep within ever smaller radii than the given one, until there are so many samples.

        How many a radius brings is concluded from the two before, so that the last sweeps are
        whole ones, but for the very last.
        """
        factor = step
        while self.count < count and radius > 0.0:
            before, shrunk = self.count, factor
            radius *= factor
            self.sweep(radius, count, fine)
            factor = step
            if 0 < before < self.count < count:
                power = math.log(self.count / before) / -math.log(shrunk)
                factor = (self.count / (APPROACH * count)) ** (1.0 / power)
            factor = min(max(factor, step), APPROACH)

    def sweep(
        self, radius: float, most: int | None = None, fine: float = FINE, strict: bool = False
    ) -> None:
        """Add samples within this radius until every middle is near enough, or there are `most`.

        If `strict`, every place is near enough then. Once there are `most`, the rest is left alone.
        """
        self.radius = radius
        if not self.grid_radius / FINER <= radius <= self.grid_radius * FINER:
            self._make_grids(radius)
        wanted, spline, done = self.wanted, self.wanted.spline, 0
        while done < self.cut and self.count != most:
            self._make_room(TRIANGLES_AT_A_TIME)
            counts = np.array([self.cut, self.count])
            done = kernels.cover_triangles(
                spline.coefficients, spline.scale, wanted.reaches, wanted.law.numbers,
                radius, fine, strict, len(self.weights) if most is None else most,
                *self.room, done, min(done + TRIANGLES_AT_A_TIME, self.cut),
                self.heads, self.links, self.points, self.weights, self.finest, counts, self.local,
            )  # fmt: skip
            self.cut, self.count = counts.tolist()
            self.tell(self.count)

    def add(self, patches: Indices, triangles: Array, middles: Array) -> None:
        """Add the middles of some triangles as samples; see `middles_of`."""
        self._make_room(len(patches))
        rows = slice(self.count, self.count + len(patches))
        self.points[rows], self.weights[rows] = middles[:, :6], triangles[:, 4]
        self.local[rows] = np.column_stack([patches, triangles[:, :2], middles[:, 6]])
        self.count += len(patches)
        self.grid_radius = math.inf  # they are not in the grids

    def forget(self) -> None:
        """Take out all samples that were added, and what is known of how near samples are."""
        self.count = self.given
        self.triangles[:, 3] = math.inf
        self.grid_radius = math.inf

    def _whole_patches(self) -> tuple[Indices, Array]:
        """Return all patches, as triangles that no sample is known to be near to.

        Their order is mixed: row by row, samples would snap to the pattern of the cells.
        """
        count = self.wanted.spline.patches
        step = round(count * GOLDEN)
        while math.gcd(step, count) > 1:
            step += 1
        order = step * np.arange(count) % count
        third, one, far = np.full((3, count), [[1 / 3], [1.0], [math.inf]])
        return order, np.column_stack([third, third, one, far, self.wanted.largest[order]])

    def _take(self, given: Samples) -> None:
        """Enter the samples that are given."""
        wanted, spline = self.wanted, self.wanted.spline
        self.points[: self.given, :3] = (given.points - spline.coefficients[0, 0]) * wanted.unit
        self.points[: self.given, 3:] = given.normals
        self.local[: self.given, 3] = given.gaussian_curvature
        kernels.weigh_samples(
            given.gaussian_curvature, given.mean_curvature, given.patch_index, 1.0 / wanted.unit,
            wanted.reaches, wanted.law.numbers, self.weights,
        )  # fmt: skip

    def _make_grids(self, radius: float) -> None:
        """Make the grids again, for a radius that is not much smaller than this one."""
        self.heads, self.links, self.finest = grids_of(
            self.points, self.weights, np.arange(self.count), radius, self.wanted.law.floor
        )
        self.grid_radius = radius

    def _make_room(self, more: int) -> None:
        """Make room for so many more samples, and for the quarters of so many triangles."""
        room = _room(len(self.weights), self.count + more)
        for name in SAMPLES:
            setattr(self, name, _enlarged(getattr(self, name), room))
        self.links = _enlarged(self.links, kernels.SIZES * room)
        patches, triangles = self.room
        room = _room(len(patches), self.cut + 3 * more)
        self.room = _enlarged(patches, room), _enlarged(triangles, room)


def quarters(
    patches: Indices, triangles: Array, *columns: Array
) -> tuple[Indices, Array, *tuple[Array, ...]]:
    """Return the quarters of triangles, those in the middles first, then three of each.

    What else is known of the triangles, and holds for their quarters, comes with them.
    """
    room = np.tile(patches, 4), np.tile(triangles, (4, 1))
    kernels.quarter_triangles(*room, len(patches))
    return *room, *(np.concatenate([x, np.repeat(x, 3)]) for x in columns)


def _room(old: int, needed: int) -> int:
    return old if needed <= old else max(needed, 2 * old)


def _enlarged(rows: NDArray[Any], room: int) -> NDArray[Any]:
    """Return an array of so many rows that begins with these."""
    if len(rows) >= room:
        return rows
    new = np.empty((room, *rows.shape[1:]), rows.dtype)
    new[: len(rows)] = rows
    return new
