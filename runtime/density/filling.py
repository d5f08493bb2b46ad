"""Samples at normals, and samples that fill the gaps between them, for a target density."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.errors import SurfaceError
from ..base.threads import counted
from ..base.tolerances import FLAT_SURFACE, LENGTH_ERROR
from ..place.on_spline import OnSpline
from ..samples.report import sampling_report
from ..samples.request import BY_CURVATURE, Request
from ..samples.samples import Samples
from ..spline.developable import curved_solid_angle
from .angles import cover_normals
from .at_normals import SamplesAtNormals, no_samples, sample_at_lattice, sample_at_normals
from .cover import Cover
from .coverage import coverage
from .grid import lines_of
from .on_grid import cover_on_grid
from .relaxation import relax
from .sizing import SizingFunction, TargetDensity
from .triangles import subdivisions

__all__ = ["filled_samples"]

# Twice the area of a hexagon of circumradius 1.
HEXAGON = 3.0 * math.sqrt(3.0)
# For n samples with round cells that cover the surface within a radius r, relative to the sizing
# function, the integral of the target density is n r² times this.
GREEDY = 1.85
# Balanced: the covering radius of the added samples, relative to that of the normals.
WIDER = 2.0
# Balanced: the floor of the target density, relative to the mean of κ².
FLAT_SHARE = 0.5
# |K|^α vanishes where K does; gaps there are wider than the mean by at most this factor.
WIDEST_GAP = 1000.0
# The number of added samples that a sample at a normal is taken to save. It saves up to 0.7; with
# less, more samples are left for gaps, of which |K| alone leaves wide ones.
SAVED = 0.25
# The bisection for the number of normals that leaves enough samples for a coverage: its steps, the
# part of the count at which it ends, and the logarithm of the ratio of its bounds.
BISECTIONS, NEAR_ENOUGH, FEWEST_NORMALS = 10, 0.97, 10.0


def filled_samples(
    geometry: OnSpline,
    request: Request,
    fields: Sequence[str],
    dtype: DTypeLike,
    progress: bool,
    floor: float | None = None,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples for any density but "gauss", and the normals that were searched.

    `floor` is that of the target density, in L, if a whole determines it of which this is a part.
    """
    angle = None
    with counted(request.count, progress) as show_count:
        filling = Filling(geometry, request, progress, show_count, floor)
        cover, at_normals = filling.cover()
        cover = filling.relaxed(cover)
        if request.angle is not None:
            angle = cover_normals(cover, request.angle)
        return filling.samples(cover, at_normals, fields, dtype, angle), at_normals.normals


@dataclass(frozen=True, eq=False)
class Filling:
    """Samples for any density but "gauss": those at normals, and those that fill gaps between them.

    `show_count` is called with the number of samples when it has grown.
    """

    geometry: OnSpline
    request: Request
    progress: bool
    show_count: Callable[[int], object]
    floor: float | None = None

    def cover(self) -> tuple[Cover, SamplesAtNormals]:
        """Return the cover that is asked for, and the samples at normals in it.

        Raises SurfaceError if the surface has no area.
        """
        if self.request.density in BY_CURVATURE:
            return self._balanced()
        cover = Cover(self._sizing_of_power(), None, self.show_count)
        if self.request.count is not None:
            cover.to_count(self.request.count)
        elif self.request.coverage is not None:
            cover.to_radius(self._distance(cover.sizing, self.request.coverage))
        return cover, no_samples()

    def relaxed(self, cover: Cover) -> Cover:
        """Return the relaxed cover, or the given one if relaxing would exceed the coverage."""
        if self.request.relax == 0 or cover.count == cover.fixed:
            return cover
        relaxed, asked = copy(cover), self.request.coverage
        relax(relaxed, self.request.relax)
        if self.request.count is None or asked is None:
            return relaxed
        return relaxed if self._coverage(relaxed, asked) <= asked else cover

    def _sizing_of_power(self) -> SizingFunction:
        """Return the sizing function of "uniform" or a power of |K|.

        A power is uniform, too, if all curvature is an error of the spline.
        """
        power, count = self.request.density, self.request.count or 0
        density = count / (4 * math.pi)
        if isinstance(power, str) or curved_solid_angle(self.geometry, density) == 0.0:
            return self._sizing(TargetDensity(floor=1.0))
        sizing = self._sizing(TargetDensity(gauss_weight=1.0, exponent=float(power)))
        floor = sizing.integral / sizing.area / WIDEST_GAP**2
        return sizing.with_floor(self._floor_or(floor, sizing, 2.0 * float(power)))

    def _floor_or(self, own: float, sizing: SizingFunction, order: float) -> float:
        """Return the given floor, for a target density in 1/L^order, or that of this surface."""
        return own if self.floor is None else self.floor / sizing.unit**order

    def _sizing(self, target: TargetDensity) -> SizingFunction:
        """Return a sizing function; SurfaceError if the area of the spline is rounding."""
        sizing = SizingFunction(self.geometry, target)
        if not sizing.area > sizing.size * sizing.noise:
            raise SurfaceError(
                f"surface {sizing.spline.name!r} has no area beyond rounding: all its points lie "
                'on one curve or are one point; only density="gauss" takes it.'
            )
        return sizing

    def samples(
        self,
        cover: Cover,
        at_normals: SamplesAtNormals,
        fields: Sequence[str],
        dtype: DTypeLike,
        angle: float | None,
    ) -> Samples:
        """Return the samples at normals, followed by the added ones."""
        added, given = cover.points[cover.given :, 3:].copy(), at_normals.samples
        arrays, unrefined = self.geometry.at_places(
            cover.added, added, cover.curvatures[cover.given :], cover.exact, fields, dtype
        )
        if given is not None:
            arrays = {
                name: np.concatenate([getattr(given, name).astype(x.dtype, copy=False), x])
                for name, x in arrays.items()
            }
            unrefined = None if unrefined is None else unrefined + (given.report.unrefined or 0)
        arrays |= lines_of(cover.grid, cover.count, fields)
        developable = None if given is None else given.report.developable_patches
        report = sampling_report(
            self.geometry, len(at_normals.normals), cover.count, at_normals.density, developable,
            arrays,
        )  # fmt: skip
        asked = self.request.coverage
        reached = None if asked is None else self._coverage(cover, asked)
        is_on_grid = cover.grid is not None and (cover.grid.rows >= 0).any()
        density = "aligned" if is_on_grid else None
        report = replace(report, coverage=reached, angle=angle, density=density)
        return self.geometry.samples(arrays, report, unrefined)

    def _coverage(self, cover: Cover, asked: float) -> float:
        """Return a bound of the distance of a point of the surface from the nearest sample."""
        unit = cover.sizing.unit
        return coverage(cover.sizing, cover.points[:, :3], asked * unit) / unit

    def _distance(self, sizing: SizingFunction, coverage: float) -> float:
        """Return a coverage as a scaled length, between rounding and the size of the surface.

        Triangles are those of the spline: from places on the surface, its points are farther away
        by twice its distance from the spline, at most. That is subtracted, and half of the coverage
        is left at least.
        """
        coverage = max(coverage - 2.0 * self.geometry.distance, coverage / 2.0)
        return min(max(coverage * sizing.unit, LENGTH_ERROR * sizing.size), sizing.size)

    # --- balanced ---------------------------------------------------------------------------------

    def _balanced(self) -> tuple[Cover, SamplesAtNormals]:
        request, sizing = self.request, self._sizing(TargetDensity(curvature_weight=1.0))
        # Normals and angles are absolute: flat parts then count as parts of a sphere.
        least = 4 * math.pi if request.normals is not None or request.angle else FLAT_SURFACE
        floor = FLAT_SHARE * max(sizing.integral, least) / sizing.area
        floor = self._floor_or(floor, sizing, 2.0)
        if request.density == "aligned":
            return self._aligned(sizing.with_floor(floor)), no_samples()
        if request.count is None:
            return self._by_radius(sizing, floor)
        cover, at_normals = self._by_count(sizing.with_floor(floor), request.count)
        if request.coverage is None or self._coverage(cover, request.coverage) <= request.coverage:
            return cover, at_normals
        return self._by_count_and_coverage(sizing, request.count, request.coverage)

    def _aligned(self, sizing: SizingFunction) -> Cover:
        """Sample on a graded grid, and fill the gaps that it leaves."""
        asked = self.request.coverage
        distance = None if asked is None else self._distance(sizing, asked)
        return cover_on_grid(sizing, self.request, distance, self.show_count)

    def _by_radius(self, sizing: SizingFunction, floor: float) -> tuple[Cover, SamplesAtNormals]:
        """Sample at the normals asked for, or at as many as fit a coverage, and fill the gaps."""
        request = self.request
        if request.angle is not None:
            at_normals = self._at_normals(request.directions)
            radius = WIDER * math.radians(request.angle)
        elif request.normals is not None:
            at_normals = self._at_normals(request.directions)
            radius = WIDER * spacing(at_normals.samples_per_steradian)
        else:
            assert request.coverage is not None
            least = float(sizing.largest.min())
            radius = self._distance(sizing, request.coverage) * math.sqrt(max(floor, least))
            subdivisions(sizing.with_floor(floor), radius)  # or InputError, before the search
            at_normals = self._at_normals(density_of(radius / WIDER))
        if request.coverage is not None:
            floor = (radius / self._distance(sizing, request.coverage)) ** 2
        cover = Cover(sizing.with_floor(floor), at_normals.samples, self.show_count)
        cover.to_radius(radius)
        return cover, at_normals

    def _by_count(self, sizing: SizingFunction, count: int) -> tuple[Cover, SamplesAtNormals]:
        """Divide a count between samples at normals and samples that fill the gaps."""
        seen = curved_solid_angle(self.geometry, count / (4 * math.pi))
        density = 1.0
        # The number of samples at one normal per steradian; it is proportional to their density.
        filling = sizing.integral / (GREEDY * (WIDER * spacing(density)) ** 2)
        each = seen + max(0.0, filling - SAVED * seen)
        at_normals = self._at_normals(count / each, count)
        cover = Cover(sizing, at_normals.samples, self.show_count)
        cover.to_count(count)
        return cover, at_normals

    def _by_count_and_coverage(
        self, sizing: SizingFunction, count: int, coverage: float
    ) -> tuple[Cover, SamplesAtNormals]:
        """Find the most normals that leave enough samples for a coverage, by bisection."""
        seen = curved_solid_angle(self.geometry, count / (4 * math.pi))
        distance = self._distance(sizing, coverage)
        high = math.log(count / seen) if seen > 0.0 else 0.0
        low, best = high - FEWEST_NORMALS, None
        for _ in range(BISECTIONS):
            radius = WIDER * spacing(math.exp((low + high) / 2))
            at_normals = self._at_normals(math.exp((low + high) / 2))
            floor = (radius / distance) ** 2
            cover = Cover(sizing.with_floor(floor), at_normals.samples, self.show_count)
            cover.to_radius(radius, count + 1)
            if cover.count > count:
                high = (low + high) / 2
                continue
            low, best = (low + high) / 2, (cover, at_normals)
            if cover.count > NEAR_ENOUGH * count:
                break
        if best is None:  # not even without normals
            cover = Cover(replace(sizing, target=TargetDensity(floor=1.0)), None, self.show_count)
            cover.to_count(count)
            return cover, no_samples()
        best[0].fill_up(count)
        return best

    def _at_normals(
        self, asked: NDArray[np.float64] | float, most: int | None = None
    ) -> SamplesAtNormals:
        """Return the samples at normals, or at a lattice with a density per steradian."""
        if isinstance(asked, np.ndarray):
            return sample_at_normals(self.geometry, asked, self.progress)
        return sample_at_lattice(self.geometry, asked, self.progress, most)


def spacing(density: float) -> float:
    """Return the covering radius of a hexagonal lattice of `density` points per area."""
    return math.sqrt(2.0 / (HEXAGON * density))


def density_of(radius: float) -> float:
    """Return the points per area of a hexagonal lattice with a covering radius."""
    return 2.0 / (HEXAGON * radius * radius)
