"""Samples of a CAD part: one target density, one greedy cover and one count for all faces."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.errors import GaussmapWarning, InputError
from ...runtime.base.memory import check_memory
from ...runtime.base.threads import counted
from ...runtime.base.tolerances import FLAT_SURFACE, LENGTH_ERROR
from ...runtime.density.angles import choose_apart, cover_normals
from ...runtime.density.filling import WIDER, WIDEST_GAP, spacing
from ...runtime.density.relaxation import relax
from ...runtime.kernels.sizing import TargetDensity
from ...runtime.samples.fields import EDGE_NAMES
from ...runtime.samples.report import SamplingReport
from ...runtime.samples.request import Request
from ...runtime.samples.samples import Samples
from .at_normals import Given, given_at_normals
from .cover import PartCover
from .edge_sampling import with_edges
from .part import Part
from .results import arrays_of, reached_angle, reached_coverage, space_of
from .space import Space

__all__ = ["sample_part"]

Array = NDArray[np.float64]

# Balanced: the floor of the target density, relative to the mean of κ² on the part. Small fillets
# have most of the curvature of a part.
FLOOR = 3.0
# The part of a count that goes where normals are farthest from those of all samples.
FOR_NORMALS = 0.05
# The chord between the normals of candidates for these samples, relative to that which their number
# leaves on a sphere.
NORMALS_APART = 0.2
# About the number of candidates for them, at most, beside as many as there are samples.
CANDIDATES = 200_000
# Decimal places to which normals of samples differ.
DIGITS = 6
# Each face gets a sample if there are at least this many samples for each face.
SAMPLES_A_FACE = 2
DENSITIES = ("gauss", "balanced", "uniform")
BISECTIONS, NEAR_ENOUGH, WIDEST_RADIUS = 8, 0.97, 10.0


def sample_part(
    part: Part,
    request: Request,
    fields: Sequence[str],
    dtype: DTypeLike,
    threads: int | None,
    progress: bool,
    edges: bool = False,
) -> tuple[Samples, Array]:
    """Return samples of a part, and the normals that were asked. Raises what `sample` raises."""
    _check(request)
    if request.count is not None:
        check_memory("relaxed part" if request.relax else "part", request.count)
    space = space_of(part, threads, _target(request))
    given = given_at_normals(space, request.normals, progress)
    angle = None
    with counted(request.count, progress) as show_count:
        filling = PartFilling(space, request, given, show_count)
        cover = filling.cover()
        if request.angle is not None:
            angle = cover_normals(cover, request.angle)
            # Tips of faces may be too narrow for its cells.
            angle = max(angle, reached_angle(space, cover.points[:, 3:6]))
    on_faces = [x for x in fields if x not in EDGE_NAMES]
    arrays: dict[str, Any] = arrays_of(space, cover.added, given, on_faces, dtype)
    if edges:
        arrays = with_edges(cover.sizing, cover.count, arrays, fields, dtype)
    reached = None
    if request.coverage is not None:
        points, asked = cover.points[:, :3], request.coverage * space.unit
        reached = reached_coverage(space, points, asked) / space.unit
    report = _report(part, space, cover, given, reached, angle)
    if edges:
        total = len(next(iter(arrays.values())))
        report = replace(report, samples=total, edge_samples=total - cover.count)
    normals = np.empty((0, 3)) if request.normals is None else request.normals
    _warn(part, report, len(space.failed), request.angle)
    return Samples(**arrays, report=report, surface=part), normals


def _check(request: Request) -> None:
    """Raise InputError for densities that parts do not have."""
    if isinstance(request.density, str) and request.density not in DENSITIES:
        raise InputError(
            f'density="{request.density}" is for surfaces; of a part use "balanced" or "uniform".'
        )
    if request.density == "gauss" and request.normals is None:
        raise InputError(
            'density="gauss" of a part goes with normals=...; with count=... use "balanced", or a '
            "power of |K|, such as density=1.0."
        )


def _target(request: Request) -> TargetDensity:
    if isinstance(request.density, str):
        return TargetDensity(curvature_weight=0.0 if request.density == "uniform" else 1.0)
    return TargetDensity(gauss_weight=1.0, exponent=float(request.density))


@dataclass(frozen=True, eq=False)
class PartFilling:
    """The cover of a part that is asked for, with the samples that are given."""

    space: Space
    request: Request
    given: Given
    show_count: Callable[[int], object]

    def cover(self) -> PartCover:
        """Return the cover."""
        request, space = self.request, self.space
        if request.density == "gauss":
            return self._new(space)
        if isinstance(request.density, str) and request.density != "uniform":
            return self._balanced()
        integral = space.integral
        floor = integral / space.area / WIDEST_GAP**2 if integral > 0.0 else 1.0
        space = space.with_floor(1.0 if request.density == "uniform" else floor)
        if request.count is not None:
            return self._by_count(space, request.count)
        assert request.coverage is not None
        return self._by_radius(space, self._distance(request.coverage))

    def _balanced(self) -> PartCover:
        request, space = self.request, self.space
        # Normals and angles are absolute: flat parts then count as parts of a sphere.
        absolute = request.normals is not None or request.angle is not None
        least = 4 * math.pi if absolute else FLAT_SURFACE
        floor = FLOOR * max(space.integral, least) / space.area
        if request.count is not None:
            cover = self._by_count(space.with_floor(floor), request.count)
            asked = request.coverage
            if asked is None or self._reached(cover, asked) <= asked * space.unit:
                return cover
            return self._by_count_and_coverage(request.count, asked)
        if request.angle is not None:
            radius = WIDER * math.radians(request.angle)
        elif request.normals is not None:
            radius = WIDER * spacing(len(request.normals) / (4 * math.pi))
        else:
            assert request.coverage is not None
            radius = self._distance(request.coverage) * math.sqrt(max(floor, space.smallest))
        if request.coverage is not None:
            floor = (radius / self._distance(request.coverage)) ** 2
        return self._by_radius(space.with_floor(floor), radius)

    def _by_radius(self, space: Space, radius: float) -> PartCover:
        cover = self._new(space)
        cover.to_radius(radius)
        cover = self._relaxed(cover)
        missing = cover.missing()
        if SAMPLES_A_FACE * len(space.pieces) <= cover.count + len(missing):
            cover.put(missing)
        return cover

    def _by_count(self, space: Space, count: int) -> PartCover:
        """Fill gaps with most of a count, and use the rest for empty faces and for normals."""
        cover = self._new(space)
        rest = math.floor(FOR_NORMALS * count) if self.request.density != "uniform" else 0
        cover.to_count(count - rest)
        cover = self._relaxed(cover)
        missing = cover.missing()
        if SAMPLES_A_FACE * len(space.pieces) <= count and len(missing):
            if len(missing) > rest:
                cover.remove_last(len(missing) - rest)
            cover.put(missing)
        if cover.count < count and rest:
            _fill_normals(cover, count - cover.count)
        cover.fill_up(count)
        return cover

    def _by_count_and_coverage(self, count: int, coverage: float) -> PartCover:
        """Find the smallest radius of a balanced cover that leaves enough for a coverage."""
        distance, best = self._distance(coverage), None
        high = math.log(count)
        low = high - WIDEST_RADIUS
        for _ in range(BISECTIONS):
            radius = WIDER * spacing(math.exp((low + high) / 2))
            cover = self._new(self.space.with_floor((radius / distance) ** 2))
            cover.to_radius(radius, count + 1)
            if cover.count > count:
                high = (low + high) / 2
                continue
            low, best = (low + high) / 2, cover
            if cover.count > NEAR_ENOUGH * count:
                break
        if best is None:
            best = self._new(self.space.uniform)
            best.to_count(count)
        best.fill_up(count)
        return best

    def _relaxed(self, cover: PartCover) -> PartCover:
        """Return the relaxed cover, or the given one if relaxing would exceed the coverage."""
        if self.request.relax == 0 or cover.count == cover.given:
            return cover
        relaxed, asked = copy(cover), self.request.coverage
        relax(relaxed, self.request.relax)
        if self.request.count is None or asked is None:
            return relaxed
        within = self._reached(relaxed, asked) <= asked * self.space.unit
        return relaxed if within else cover

    def _new(self, space: Space) -> PartCover:
        return PartCover(space, self.given.rows(space), self.show_count)

    def _reached(self, cover: PartCover, asked: float) -> float:
        return reached_coverage(self.space, cover.points[:, :3], asked * self.space.unit)

    def _distance(self, coverage: float) -> float:
        """Return a coverage as a scaled length, between rounding and the size of the part."""
        size = self.space.size
        return min(max(coverage * self.space.unit, LENGTH_ERROR * size), size)


def _fill_normals(cover: PartCover, number: int) -> None:
    """Add samples where normals are farthest from those of all samples."""
    chord = NORMALS_APART * spacing(max(cover.count + number, 1) / (4 * math.pi))
    most = CANDIDATES + cover.count
    cells = cover.sizing.cut_by_normals(max(chord, math.radians(0.5)), most)
    known = np.unique(cover.points[:, 3:].round(DIGITS), axis=0)
    opposite = 2.0  # the largest chord between normals
    chosen = choose_apart(cells.rows[:, 3:6], chord, cover.sizing.threads, opposite, number, known)
    cover.put(cells[chosen])


def _report(
    part: Part,
    space: Space,
    cover: PartCover,
    given: Given,
    coverage: float | None,
    angle: float | None,
) -> SamplingReport:
    held = np.union1d(cover.added.pieces, given.pieces)
    return SamplingReport(
        surface=part.name,
        normals=given.normals,
        samples=cover.count,
        patches=None,
        developable_share=space.developable_share,
        developable_patches=None,
        coverage=coverage,
        angle=angle,
        on="surface",
        unrefined=int(np.count_nonzero(~given.arrays["on_surface"])),
        faces=len(part),
        empty_faces=len(part) - len(held),
        oriented=part.oriented,
    )


def _warn(part: Part, report: SamplingReport, failed: int, angle: float | None) -> None:
    """Warn of faces that failed, and of an angle that was not reached."""
    reasons = []
    if failed:
        reasons.append(
            f"{failed} of {len(part):,} faces cannot be sampled, and got no samples (see "
            "part.failed)"
        )
    if angle is not None and report.angle is not None and report.angle > angle:
        reasons.append(
            f"some normals in narrow tips of faces are {report.angle:.3g}° from those of all "
            f"samples instead of the requested {angle:g}°; ask for a smaller angle"
        )
    for reason in reasons:
        warnings.warn(f"part {part.name!r}: {reason}.", GaussmapWarning, stacklevel=6)
