"""Sampling of splines: the points of a spline at given normals, and at given parameters.

`OnSurface`, which inherits from `OnSpline`, moves these samples to the surface that the spline
approximates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...generated.spline import SCALE
from ..base.aliases import Array, Indices
from ..base.memory import check_memory
from ..base.scales import check_range
from ..base.threads import over_ranges
from ..directions.regions import Reach
from ..domain.trim import samples_inside, with_uv
from ..samples.fields import FLOAT_NAMES, bytes_of, count_of, new_field
from ..samples.report import SamplingReport, UndecidedNormal, sampling_report
from ..samples.samples import Samples
from ..search.hits import SIGN, fill, kinds_of
from ..search.kernels.hits import fill_known
from ..search.search import Hits, find, find_in_turn
from ..spline.developable import CellMeasure
from ..spline.kernels.jets import forms_of_jets
from ..spline.kernels.spline import jets_on_spline, patches_at
from ..spline.nets import AnySpline, on_grid
from ..spline.spline import Spline
from ..spline.tips import tips_of
from ..surface.surface import Surface
from .reach import reached

Fields = dict[str, NDArray[Any]]

AT_A_TIME = 1 << 12
# At a pole, normals of a spline are evaluated at this distance from it, relative to the domain.
BESIDE_POLE = 1e-6


class FieldsOfSamples(NamedTuple):
    """Fields of samples, and what is known of points that could not be moved to the surface.

    `unrefined` is the number of samples that are points of the spline, not of its surface.
    `undecided` has a box for each normal with points of the spline that could not be moved to the
    surface. Both are None if the spline itself is sampled.
    """

    fields: Fields
    unrefined: int | None = None
    undecided: tuple[UndecidedNormal, ...] | None = None

    @property
    def number(self) -> int:
        """The number of samples."""
        return count_of(self.fields)


@dataclass(frozen=True, eq=False)
class OnPatches:
    """A spline of patches, on a grid or of nets, whose own points are the samples.

    Fields of samples at normals are written to the arrays in `memory` if these are large enough.
    """

    on: ClassVar[str] = "spline"

    spline: AnySpline
    threads: int | None = None
    surface: Surface | None = None
    memory: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    reach: Reach | None = None

    @property
    def fitted(self) -> OnPatches:
        """The geometry that densities use; see `ProvedSurface`."""
        return self

    def with_fit(self, samples: Samples, density: float | None = None) -> Samples:
        """Return `samples`, which have their spline already; see `ProvedSurface.with_fit`."""
        del density
        return samples

    @property
    def has_tips(self) -> bool:
        """Whether the spline has patches with a tip."""
        return tips_of(self.spline) is not None

    def within(self, reach: Reach | None) -> Self:
        """Return self; InputError for a `reach` of a spline of nets, which has no trim."""
        if reach is not None:
            on_grid(self.spline)
        return self

    def used(
        self,
        dtype: DTypeLike,
        threads: int | None,
        memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
    ) -> Self:
        """Return the geometry for one call, with a number of threads and memory for the samples.

        Raises SurfaceError if points are beyond the range of `dtype`.
        """
        check_range(self.spline.name, self.spline._largest, dtype)
        if threads == self.threads and not memory and not self.memory:
            return self
        return replace(self, threads=threads, memory=memory)

    @property
    def measure(self) -> tuple[Array, Array]:
        """Areas and signed solid angles of the patches, as `Spline.measure`."""
        return self.spline.measure

    @property
    def cell_measure(self) -> CellMeasure:
        """Areas and signed solid angles of the cells."""
        return self.spline._cell_measure

    @property
    def distance(self) -> float:
        """The largest distance between the sampled surface and its spline."""
        return 0.0

    # --- samples at normals -----------------------------------------------------------------------

    def samples_at(
        self,
        normals: Array,
        fields: Sequence[str],
        dtype: DTypeLike,
        progress: bool = False,
        density: float | None = None,
    ) -> Samples:
        """Return all points that have one of the unit normals (S, 3).

        `density` is the number of normals per steradian in the report, by default S / 4π.
        """
        hits = find(self.spline, normals, self.threads, progress, components=True)
        return self.samples_at_hits(normals, hits, fields, dtype, density)

    def samples_at_hits(
        self,
        normals: Array,
        hits: Hits,
        fields: Sequence[str],
        dtype: DTypeLike,
        density: float | None = None,
    ) -> Samples:
        """Return the samples at hits, with their report; see `samples_at`."""
        found = self.at_hits(normals, hits, fields, dtype)
        report = self.report(
            len(normals), density, hits.developable, found.fields,
            unrefined=found.unrefined, undecided=found.undecided,
        )  # fmt: skip
        return self.samples(found.fields, report)

    def samples_in_turn(
        self,
        normals: Array,
        fields: Sequence[str],
        dtype: DTypeLike,
        size: int,
        progress: bool,
        density: float,
    ) -> Iterator[Samples]:
        """Yield the samples of `samples_at` in parts of at most `size` samples."""
        report = self.report(len(normals), density, None, {})
        parts = find_in_turn(self.spline, normals, self.threads, progress, components=True)
        for found in self.at_hits_in_turn(normals, parts, fields, dtype, size):
            known = replace(
                report, samples=found.number, unrefined=found.unrefined, undecided=found.undecided
            )
            yield self.samples(found.fields, known)

    def number_inside(self, normals: Array, hits: Hits) -> int:
        """Return the number of hits inside the trim of the spline."""
        if self.spline.trim is None:
            return len(hits)
        uv = fill(self.spline, normals, hits, self.threads, ("uv",))
        return count_of(samples_inside(self.spline.trim, uv, ("uv",)))

    def near_hits(
        self, normals: Array, hits: Hits, fields: Sequence[str], dtype: DTypeLike
    ) -> FieldsOfSamples:
        """Return the samples at hits; in `OnSurface`, some are points of the spline only."""
        return self.at_hits(normals, hits, fields, dtype)

    def share_at(self, normals: Array, hits: Hits) -> float:
        """Return an estimate of the share of hits that become samples."""
        return 1.0

    def at_hits(
        self, normals: Array, hits: Hits, fields: Sequence[str], dtype: DTypeLike
    ) -> FieldsOfSamples:
        """Return the requested fields of the samples at hits."""
        wanted = with_uv(self.spline.trim, fields)
        check_memory("stored", len(hits), bytes_of(set(wanted) - set(self.memory), dtype))
        arrays = fill(self.spline, normals, hits, self.threads, wanted, dtype, self.memory)
        arrays |= kinds_of(hits, fields, self.memory)
        return FieldsOfSamples(samples_inside(self.spline.trim, arrays, fields))

    def component_degrees(self, normals: Array) -> Indices:
        """Return, for each normal, the sum of the indices of its curves and isolated points."""
        hits = find(self.spline, normals, self.threads, components=True)
        some = hits.rows(hits.special)
        degrees, trim = some.local[:, SIGN], self.spline.trim
        if trim is not None:
            uv = fill(self.spline, normals, some, self.threads, ("uv",))["uv"]
            degrees = np.where(trim.contains(uv), degrees, 0.0)
        return np.bincount(some.normal_index, degrees, len(normals)).astype(np.int64)

    def at_hits_in_turn(
        self,
        normals: Array,
        parts: Iterator[Hits],
        fields: Sequence[str],
        dtype: DTypeLike,
        size: int,
    ) -> Iterator[FieldsOfSamples]:
        """Yield the samples at the hits of all `parts`, at most `size` at a time."""
        for hits in grouped(parts, size):
            yield self.at_hits(normals, hits, fields, dtype)

    def report(
        self,
        normals: int,
        density: float | None,
        developable: int | None,
        arrays: Fields,
        **known: Any,  # noqa: ANN401
    ) -> SamplingReport:
        """Return the report of samples with the fields `arrays`; see `sampling_report`."""
        count, cells = count_of(arrays) if arrays else 0, self.cell_measure
        density = normals / (4 * math.pi) if density is None else density
        return sampling_report(
            self.spline, normals, count, density, developable, arrays, cells, on=self.on, **known
        )

    def samples(self, fields: Fields, report: SamplingReport) -> Samples:
        """Return the samples with the given fields and report."""
        return Samples(
            **fields, report=report, spline=self.spline, surface=self.surface, offset_of=None
        )


@dataclass(frozen=True, eq=False)
class OnSpline(OnPatches):
    """A spline on a grid of cells that is sampled; `OnSurface` samples its `surface` instead.

    With a `reach`, the trim of the spline excludes the points outside it, and `whole` is the same
    geometry without the reach.
    """

    spline: Spline
    whole: OnSpline | None = None

    def within(self, reach: Reach | None) -> Self:
        """Return the part of the geometry in a reach, or all of it for None."""
        if reach is None:
            return self
        spline = reached(self.spline, self.normals, self.jets, reach)
        surface = self.surface and replace(self.surface, trim=spline.trim)
        return replace(self, spline=spline, surface=surface, reach=reach, whole=self)

    def normals(self, places: Array) -> Array:
        """Return unit normals (k, 3) at parameters (k, 2); 0 or NaN at singular points."""
        places = places.copy()
        for axis, ends in enumerate(self.spline.boundary):
            low, high = self.spline.domain[axis]
            off = BESIDE_POLE * (high - low)
            low, high = low + off * (ends[0] == "pole"), high - off * (ends[1] == "pole")
            places[:, axis] = np.clip(places[:, axis], low, high)
        return self.spline.normals(*places.T)

    @cached_property
    def size(self) -> float:
        """The square root of the area inside the trim; 0 if the area is rounding error."""
        spline = self.spline
        extents = np.ptp(spline.coefficients[1:-1, 1:-1].reshape(-1, 3) * spline.scale, axis=0)
        diagonal, area = float(np.linalg.norm(extents)), float(spline.measure[0].sum())
        return diagonal * math.sqrt(area) / spline.scale if area * diagonal > spline.noise else 0.0

    # --- samples that fill gaps -------------------------------------------------------------------

    @property
    def knows_jets(self) -> bool:
        """Whether derivatives come from formulas, not from a user's callable or differences."""
        return True

    def jets(self, u: Array, v: Array) -> Array:
        """Return the 2-jets (k, 6, 3) of the sampled surface or spline; see `Surface.jets`."""
        return self.jets_of_spline(u, v)

    def jets_of_spline(self, u: Array, v: Array) -> Array:
        """Return the 2-jets (k, 6, 3) of the spline."""
        spline, jets = self.spline, np.empty((len(u), 6, 3))
        jets_on_spline(spline.coefficients, spline.scale, spline.frame, self._in_cells(u, v), jets)
        return jets

    def at_parameters(
        self, uv: Array, normals: Array, K: Array, fields: Sequence[str], dtype: DTypeLike
    ) -> Fields:
        """Return fields of samples at parameters (k, 2).

        At a singular point, normal and curvatures do not follow from the parameters: there the
        normal is the row of `normals` (k, 3), and the sign of K is that of `K` (k,).
        """
        count, spline = len(uv), self.spline
        patches, places = np.empty(count, dtype=np.int64), np.empty((count, 2))
        patches_at(*spline.cells, self._in_cells(*uv.T), patches, places)
        filled = {x: new_field(x, count, dtype) for x in FLOAT_NAMES if x in fields}
        here = np.arange(count)
        fill_known(
            spline.coefficients, spline.scale, normals, spline.frame,
            here, here << 32 | patches, np.column_stack([places, K, places]),
            *(filled[x] if x in filled else new_field(x, 0, dtype) for x in FLOAT_NAMES),
        )  # fmt: skip
        indices = {"normal_index": np.full(count, -1), "patch_index": patches}
        return filled | {x: y for x, y in indices.items() if x in fields}

    def forms(self, cells: Array) -> Array:
        """Return the fundamental forms (k, 7) at positions (k, 2) in cells; see `forms_of_jets`."""
        found, frame = np.empty((len(cells), 7)), self.spline.frame
        scales = np.array([self._size, *frame[2:]])
        u, v = (frame[:2] + frame[2:] * cells).T.copy()

        def work(first: int, last: int) -> None:
            forms_of_jets(self.jets(u[first:last], v[first:last]), scales, found[first:last])

        self._in_parts(work, len(cells))
        return found

    @property
    def _size(self) -> float:
        """The factor by which lengths are multiplied in `forms` and solid angles."""
        return SCALE * self.spline.scale

    def _in_parts(self, work: Callable[[int, int], None], count: int) -> None:
        for _ in over_ranges(work, count, AT_A_TIME, self.threads):
            pass

    def _in_cells(self, u: Array, v: Array) -> Array:
        """Return the positions (k, 2) of parameters, in cells from the corner of the domain."""
        frame = self.spline.frame
        return (np.stack([u, v], axis=1) - frame[:2]) / frame[2:]


def on_grids(geometries: Sequence[OnPatches]) -> list[OnSpline]:
    """Return the geometries, all with splines on grids; InputError if one has a spline of nets."""
    for geometry in geometries:
        on_grid(geometry.spline)
    return [x for x in geometries if isinstance(x, OnSpline)]


def in_turn(found: Samples, size: int) -> Iterator[Samples]:
    """Yield the samples in parts of at most `size`; only the first part reports undecided boxes."""
    yield found[:size]
    report = found.report
    proved, undecided = report.proved and 0, report.undecided and ()
    report = replace(report, proved=proved, undecided=undecided)
    for first in range(size, len(found), size):
        some = found[first : first + size]
        yield Samples(
            **some.arrays(), report=report, spline=some.spline, surface=some.surface, offset_of=None
        )


def grouped(parts: Iterator[Hits], size: int) -> Iterator[Hits]:
    """Yield the hits of all parts, in their order, in groups of `size`; the last may be smaller."""
    group: list[Hits] = []
    room = size
    for hits in parts:
        start = 0
        while len(hits) - start >= room:
            yield Hits.joined([*group, hits[start : start + room]])
            start += room
            group, room = [], size
        group.append(hits[start:])
        room -= len(group[-1])
    yield Hits.joined(group)
