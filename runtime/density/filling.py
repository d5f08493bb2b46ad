"""Sampling by normals and filling what they leave, as dense as a density asks."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...generated import sampler as kernels
from ..errors import SurfaceError
from ..fields import FLOAT_NAMES, new_field
from ..report import sampling_report
from ..samples import Samples
from ..spline import Spline
from ..threads import counted
from ..visibility import visible_solid_angle
from .angles import cover_normals
from .answers import Answers, answers_of, answers_of_lattice, no_answers
from .cover import Cover
from .gaps import coverage
from .law import Law, Wanted
from .pieces import parts_of_patches
from .relaxation import relax
from .request import Request

__all__ = ["filled_samples"]

# Twice the area of a hexagon whose corners are 1 from its centre.
HEXAGON = 3.0 * math.sqrt(3.0)
# Balanced: what is filled are gaps that are wider than those between the normals by this factor.
WIDER = 2.0
# n samples that bring every place within a radius r have n r² times this as what is wanted of them.
GREEDY = 1.85
# Balanced: the floor of the density, beside the mean of what bending asks.
FLAT_SHARE = 0.25
# Less bending than this, as the integral of κ² over the surface, is rounding.
UNBENT = 1e-9
# Distances less than this part of the size of a surface are rounding.
ROUNDING = 1e-15
# |K|^α vanishes where K does; there no gap is wider than this many others.
WIDEST_GAP = 1000.0
# So many samples of a cover each sample of the normals is taken to save. They save up to 0.7; with
# less, more is left for the gaps, where |K| alone leaves wide ones.
SAVED = 0.25
# Steps of the bisection for how many normals leave room for a coverage, and when it ends; it begins
# with exp(−FEWEST_NORMALS) of them.
BISECTIONS, NEAR_ENOUGH, FEWEST_NORMALS = 10, 0.97, 10.0


def filled_samples(
    spline: Spline,
    request: Request,
    fields: Sequence[str],
    dtype: DTypeLike,
    threads: int | None,
    progress: bool,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples of any density but "gauss", and the normals that were asked."""
    angle = None
    with counted(request.count, progress) as tell:
        filling = Filling(spline, request, threads, progress, tell)
        cover, answers = filling.cover()
        cover = filling.relaxed(cover)
        if request.angle is not None:
            angle = cover_normals(cover, request.angle)
        return filling.samples(cover, answers, fields, dtype, angle), answers.normals


@dataclass(frozen=True, eq=False)
class Filling:
    """Samples of any density but "gauss", in two parts: what normals give, and a cover of the rest.

    `tell` is told how many samples there are.
    """

    spline: Spline
    request: Request
    threads: int | None
    progress: bool
    tell: Callable[[int], object]

    def cover(self) -> tuple[Cover, Answers]:
        """Return the cover that is asked, and what normals gave of it.

        Raises SurfaceError if there is nothing to cover.
        """
        if self.request.density == "balanced":
            return self._balanced()
        cover = Cover(self._law(), None, self.tell)
        if self.request.count is not None:
            cover.to_count(self.request.count)
        elif self.request.coverage is not None:
            cover.to_radius(self._distance(cover.wanted, self.request.coverage))
        return cover, no_answers()

    def relaxed(self, cover: Cover) -> Cover:
        """Return the cover after the steps that are asked; as it is, if they miss what it kept."""
        if self.request.relax == 0 or cover.count == cover.given:
            return cover
        relaxed, asked = copy(cover), self.request.coverage
        relax(relaxed, self.request.relax)
        if self.request.count is None or asked is None:
            return relaxed
        return relaxed if self._coverage(relaxed, asked) <= asked else cover

    def _law(self) -> Wanted:
        """Return what "uniform" or a power of |K| wants.

        That power is the same everywhere if what bends is the error of the spline alone.
        """
        power, count = self.request.density, self.request.count or 0
        if isinstance(power, str) or visible_solid_angle(self.spline, count / (4 * math.pi)) == 0.0:
            return self._wanted(Law(floor=1.0))
        wanted = self._wanted(Law(gauss_weight=1.0, exponent=power))
        return wanted.with_floor(wanted.total / wanted.area / WIDEST_GAP**2)

    def _wanted(self, law: Law) -> Wanted:
        """Return a law on the spline; SurfaceError if that has no area but that of rounding."""
        wanted = Wanted(self.spline, law, self.threads)
        if not wanted.area > wanted.size * wanted.noise:
            raise SurfaceError(
                f"surface {self.spline.name!r} has no area beyond rounding: all its points lie on "
                'one curve or are one point; only density="gauss" takes it.'
            )
        return wanted

    def samples(
        self,
        cover: Cover,
        answers: Answers,
        fields: Sequence[str],
        dtype: DTypeLike,
        angle: float | None,
    ) -> Samples:
        """Return what normals gave, and after it the samples that were added."""
        arrays, given = added_fields(cover, fields, dtype), answers.samples
        if given is not None:
            arrays = {
                name: np.concatenate([getattr(given, name).astype(x.dtype, copy=False), x])
                for name, x in arrays.items()
            }
        developable = None if given is None else given.report.degenerate_patches
        report = sampling_report(
            self.spline, len(answers.normals), cover.count, answers.density, developable
        )
        asked = self.request.coverage
        reached = None if asked is None else self._coverage(cover, asked)
        report = replace(report, coverage=reached, angle=angle)
        return Samples(**arrays, report=report, spline=self.spline)

    def _coverage(self, cover: Cover, asked: float) -> float:
        """Return how far a point of the surface can be from the nearest sample."""
        unit = cover.wanted.unit
        return coverage(cover.wanted, cover.points[:, :3], asked * unit) / unit

    def _distance(self, wanted: Wanted, coverage: float) -> float:
        """Return a coverage that is asked as a length of covers, between rounding and the size."""
        return min(max(coverage * wanted.unit, ROUNDING * wanted.size), wanted.size)

    # --- balanced ---------------------------------------------------------------------------------

    def _balanced(self) -> tuple[Cover, Answers]:
        request, wanted = self.request, self._wanted(Law(curvature_weight=1.0))
        # Normals and angles are absolute: then flat parts are bent as a sphere of this area.
        least = 4 * math.pi if request.normals is not None or request.angle else UNBENT
        floor = FLAT_SHARE * max(wanted.total, least) / wanted.area
        if request.count is None:
            return self._by_radius(wanted, floor)
        cover, answers = self._by_count(wanted.with_floor(floor), request.count)
        if request.coverage is None or self._coverage(cover, request.coverage) <= request.coverage:
            return cover, answers
        return self._by_count_and_coverage(wanted, request.count, request.coverage)

    def _by_radius(self, wanted: Wanted, floor: float) -> tuple[Cover, Answers]:
        """Search the normals that are asked, or fit a coverage, and cover the rest as they do."""
        request = self.request
        if request.angle is not None:
            answers = self._answers(request.directions)
            radius = WIDER * math.radians(request.angle)
        elif request.normals is not None:
            answers = self._answers(request.directions)
            radius = WIDER * spacing(answers.density_met)
        else:
            assert request.coverage is not None
            least = float(wanted.largest.min())
            radius = self._distance(wanted, request.coverage) * math.sqrt(max(floor, least))
            parts_of_patches(wanted.with_floor(floor), radius)  # or InputError, before the search
            answers = self._answers(density_of(radius / WIDER))
        if request.coverage is not None:
            floor = (radius / self._distance(wanted, request.coverage)) ** 2
        cover = Cover(wanted.with_floor(floor), answers.samples, self.tell)
        cover.to_radius(radius)
        return cover, answers

    def _by_count(self, wanted: Wanted, count: int) -> tuple[Cover, Answers]:
        """Search as many normals as fit the gaps that are left for the others, and fill these."""
        seen = visible_solid_angle(self.spline, count / (4 * math.pi))
        density = 1.0
        # How many samples there are at one normal per steradian; all of them grow in proportion.
        filling = wanted.total / (GREEDY * (WIDER * spacing(density)) ** 2)
        each = seen + max(0.0, filling - SAVED * seen)
        answers = self._answers(count / each, count)
        cover = Cover(wanted, answers.samples, self.tell)
        cover.to_count(count)
        return cover, answers

    def _by_count_and_coverage(
        self, wanted: Wanted, count: int, coverage: float
    ) -> tuple[Cover, Answers]:
        """Find the most normals that leave room for a coverage, by bisection, and then fill up."""
        seen = visible_solid_angle(self.spline, count / (4 * math.pi))
        distance = self._distance(wanted, coverage)
        high = math.log(count / seen) if seen > 0.0 else 0.0
        low, best = high - FEWEST_NORMALS, None
        for _ in range(BISECTIONS):
            radius = WIDER * spacing(math.exp((low + high) / 2))
            answers = self._answers(math.exp((low + high) / 2))
            floor = (radius / distance) ** 2
            cover = Cover(wanted.with_floor(floor), answers.samples, self.tell)
            cover.to_radius(radius, count + 1)
            if cover.count > count:
                high = (low + high) / 2
                continue
            low, best = (low + high) / 2, (cover, answers)
            if cover.count > NEAR_ENOUGH * count:
                break
        if best is None:  # not even a cover alone is so small
            cover = Cover(replace(wanted, law=Law(floor=1.0)), None, self.tell)
            cover.to_count(count)
            return cover, no_answers()
        best[0].fill_up(count)
        return best

    def _answers(self, asked: NDArray[np.float64] | float, most: int | None = None) -> Answers:
        """Return what normals give, or a lattice of so many per steradian."""
        if isinstance(asked, np.ndarray):
            return answers_of(self.spline, asked, self.threads, self.progress)
        return answers_of_lattice(self.spline, asked, self.threads, self.progress, most)


def added_fields(cover: Cover, fields: Sequence[str], dtype: DTypeLike) -> dict[str, NDArray[Any]]:
    """Return fields of the samples that a cover has added; see `Samples`."""
    patch_index, uv = cover.added.patches, cover.added.uv
    count, spline, K = len(patch_index), cover.wanted.spline, cover.curvatures[cover.given :]
    filled = {x: new_field(x, count, dtype) for x in FLOAT_NAMES if x in fields}
    here = np.arange(count)
    kernels.fill_known(
        spline.coefficients, spline.scale, cover.points[cover.given :, 3:].copy(), spline.frame,
        here, np.column_stack([patch_index, here]), np.column_stack([uv, K, uv]),
        *(filled.get(x) for x in FLOAT_NAMES),
    )  # fmt: skip
    indices = {"normal_index": np.full(count, -1), "patch_index": patch_index}
    return filled | {name: x for name, x in indices.items() if name in fields}


def spacing(density: float) -> float:
    """Return the covering radius of so many points per area, laid out as hexagons."""
    return math.sqrt(2.0 / (HEXAGON * density))


def density_of(radius: float) -> float:
    """Return how many points per area have this covering radius, laid out as hexagons."""
    return 2.0 / (HEXAGON * radius * radius)
