"""Covering a spline with samples, greedily: the widest gaps first."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels
from ..samples import Samples
from ..threads import over_ranges
from .law import Wanted

__all__ = ["APPROACH", "GREEDY", "Cover"]

Array = NDArray[np.float64]

# The arrays that hold a row for each sample.
SAMPLES = ("points", "weights", "local")
TRIANGLES_AT_A_TIME = 1 << 15
# The first samples come where none is within so many times the radius that is expected, the next
# ones within STEP of that, and so on.
WIDEST, STEP = 2.0, 2.0**-0.25
# n samples of a greedy cover within a radius r have n r² times this as what is wanted of them.
GREEDY = 1.85
# The grids are made again when the radius is so many times smaller or larger than it was.
FINER = 1.5
# Triangles this small beside the radius are not cut any more. If `strict`, they get a sample if
# need be, so that all of the surface is near enough; otherwise the middles of all triangles are.
FINE, FINEST = 0.3, 0.1
# A count is approached from below: the last but one radius shall bring so much of it.
APPROACH = 0.98


class Cover:
    """Samples that are given, and others that are added until every place is near enough to one.

    Near enough is within radius / √weight, by a `Law` of weights. Lengths are those of the spline
    times `wanted.unit`. Rows of `points` (…, 6) (and normals), `weights` and `local` (…, 4) (patch,
    u, v, K) up to `count` are the samples; the first `given` are those that were given.
    """

    def __init__(self, wanted: Wanted, given: Samples | None) -> None:
        """Begin with what is given, samples of the same spline."""
        self.wanted = wanted
        self.given = self.count = 0 if given is None else len(given)
        room = max(self.given, 1024)
        self.points, self.weights = np.empty((room, 6)), np.empty(room)
        self.local, self.links = np.empty((room, 4)), np.empty(0, dtype=np.int32)
        self.heads = np.empty(0, dtype=np.int32)
        self.finest = self.grid_radius = math.inf
        self.patches = np.arange(wanted.spline.patches)
        self.triangles = wanted.triangles()
        if given is not None:
            self._take(given)

    @property
    def coverage(self) -> float:
        """How far a place of the surface can be from the nearest sample, at most."""
        extents = self.wanted.reaches[self.patches] * np.abs(self.triangles[:, 2])
        farthest = self.triangles[:, 3] + extents
        return float(farthest.max(initial=0.0)) / self.wanted.unit

    @property
    def widest_gap(self) -> float:
        """The radius that the middles of all triangles are near enough within."""
        return float((np.sqrt(self.triangles[:, 4]) * self.triangles[:, 3]).max(initial=0.0))

    def state(self) -> dict[str, NDArray[Any]]:
        """Return what `restore` brings back: copies of the samples and the triangles."""
        rows = {name: getattr(self, name)[: self.count].copy() for name in SAMPLES}
        return rows | {"patches": self.patches, "triangles": self.triangles.copy()}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go back to a state with no more samples than there is room for now."""
        self.count = len(state["weights"])
        for name in SAMPLES:
            getattr(self, name)[: self.count] = state[name]
        self.patches, self.triangles = state["patches"], state["triangles"]
        self.grid_radius = math.inf

    def middles(self) -> Array:
        """Return point, unit normal and K (…, 7) in the middle of the triangles."""
        rows = np.empty((len(self.patches), 7))
        spline = self.wanted.spline

        def work(first: int, last: int) -> None:
            kernels.middles(
                spline.coefficients, spline.scale, self.patches, self.triangles, first, last, rows
            )

        for _ in over_ranges(work, len(rows), TRIANGLES_AT_A_TIME, self.wanted.threads):
            pass
        return rows

    def to_radius(self, radius: float, most: int | None = None) -> None:
        """Add samples until every place is within radius / √weight of one, or there are `most`."""
        now = WIDEST * radius
        while now > radius:
            self.sweep(now, most, strict=False)
            now *= STEP
        self.sweep(radius, most, FINEST)

    def to_count(self, count: int) -> None:
        """Add samples until there are so many."""
        weight = self.wanted.totals[1]
        radius = WIDEST * math.sqrt(weight / (GREEDY * count))
        start = self.patches, self.triangles, self.count
        self.sweep(radius, count)
        while self.count == count > start[2] + 1 and radius * radius < weight:
            # That is not where the widest gaps are, but those that came first.
            self.patches, self.triangles, self.count = start
            self.grid_radius = math.inf
            radius *= 2.0
            self.sweep(radius, count)
        self.narrow(radius, count, STEP)

    def narrow(
        self, radius: float, count: int, step: float, fine: float = FINE, strict: bool = True
    ) -> None:
        """Sweep within ever smaller radii, from the given one on, until there are so many samples.

        How many a radius brings is concluded from the two before, so that the last sweeps are
        whole ones, but for the very last.
        """
        before = (math.inf, max(self.count, 1))
        while self.count < count and radius > 0.0:
            self.sweep(radius, count, fine, strict)
            factor = step
            if before[1] < self.count < count:
                power = math.log(self.count / before[1]) / math.log(before[0] / radius)
                factor = (self.count / (APPROACH * count)) ** (1.0 / power) if power > 0.0 else step
            before = (radius, max(self.count, 1))
            radius *= min(max(factor, step), APPROACH)
        self._measure_gaps()

    def _measure_gaps(self) -> None:
        """Find the nearest samples where none is near, or none on the same side."""
        from scipy.spatial import KDTree

        (unknown,) = np.nonzero(np.isinf(self.triangles[:, 3]))
        if len(unknown):
            tree = KDTree(self.points[: self.count, :3])
            self.triangles[unknown, 3] = tree.query(self.middles()[unknown, :3], workers=-1)[0]

    def sweep(
        self, radius: float, most: int | None = None, fine: float = FINE, strict: bool = True
    ) -> None:
        """Add samples within this radius until every place is near enough, or there are `most`."""
        if not self.grid_radius / FINER <= radius <= self.grid_radius * FINER:
            self._make_grids(radius)
        kept: list[tuple[NDArray[np.int64], Array]] = []
        todo = [(self.patches, self.triangles)]
        while todo:
            cut = []
            for patches, triangles in todo:
                for first in range(0, len(patches), TRIANGLES_AT_A_TIME):
                    last = min(first + TRIANGLES_AT_A_TIME, len(patches))
                    part = patches[first:last], triangles[first:last]
                    near, far = self._look_at(radius, most, fine, strict, *part)
                    kept.append(near)
                    cut.append(far)
            todo = [x for x in cut if len(x[0])]
        self.patches, self.triangles = (np.concatenate(x) for x in zip(*kept, strict=True))

    def add(self, which: NDArray[np.int64], middles: Array) -> None:
        """Add the middles of some triangles as samples; `middles` are those of all."""
        self._make_room(len(which))
        rows = slice(self.count, self.count + len(which))
        self.points[rows] = middles[which, :6]
        self.weights[rows] = self.triangles[which, 4]
        self.local[rows] = np.column_stack(
            [self.patches[which], self.triangles[which, :2], middles[which, 6]]
        )
        self.count += len(which)
        self.grid_radius = math.inf  # they are not in the grids

    def remove(self, rows: NDArray[np.int64]) -> None:
        """Take samples out again; nothing is known then of how near the others are."""
        left = np.ones(self.count, dtype=bool)
        left[rows] = False
        self.given -= int(np.count_nonzero(rows < self.given))
        for name in SAMPLES:
            array = getattr(self, name)
            array[: np.count_nonzero(left)] = array[: self.count][left]
        self.count = int(np.count_nonzero(left))
        self.triangles[:, 3] = math.inf
        self.grid_radius = math.inf

    def _look_at(
        self,
        radius: float,
        most: int | None,
        fine: float,
        strict: bool,
        patches: NDArray[np.int64],
        triangles: Array,
    ) -> tuple[tuple[NDArray[np.int64], Array], tuple[NDArray[np.int64], Array]]:
        """Return the triangles that are near enough to a sample, and the quarters of the others."""
        size, wanted = len(patches), self.wanted
        self._make_room(size)
        kept, cut = (
            (np.empty(x, dtype=np.int64), np.empty((x, triangles.shape[1])))
            for x in (size, 4 * size)
        )
        counts = np.array([0, 0, self.count])
        kernels.cover_triangles(
            wanted.spline.coefficients, wanted.spline.scale, wanted.reaches, wanted.law.numbers,
            radius, fine, strict, self.count + size if most is None else most,
            patches, triangles, 0, size,
            *kept, *cut, self.heads, self.links, self.points, self.weights, self.finest, counts,
            self.local,
        )  # fmt: skip
        near, far, self.count = counts.tolist()
        return (
            (kept[0][:near].copy(), kept[1][:near].copy()),
            (cut[0][:far].copy(), cut[1][:far].copy()),
        )

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
        weights = self.triangles[:, 4]
        least = max(float(weights[weights >= 0.0].min(initial=math.inf)), self.wanted.law.floor)
        self.finest = 2.0 * radius / math.sqrt(least) / 2.0 ** (kernels.LEVELS - 1)
        room = len(self.weights)
        self.heads = np.full(1 << (2 * kernels.SIZES * room).bit_length(), -1, dtype=np.int32)
        self.links = np.empty(kernels.SIZES * room, dtype=np.int32)
        kernels.enter_samples(
            self.heads,
            self.links,
            self.points,
            self.weights,
            radius,
            self.finest,
            np.arange(self.count),
        )
        self.grid_radius = radius

    def _make_room(self, more: int) -> None:
        """Make room for so many more samples."""
        old = len(self.weights)
        if self.count + more <= old:
            return
        room = max(self.count + more, 2 * old)
        for name in (*SAMPLES, "links"):
            rows = getattr(self, name)
            new = np.empty((len(rows) // old * room, *rows.shape[1:]), rows.dtype)
            new[: len(rows)] = rows
            setattr(self, name, new)
