"""Sampling of surfaces with a proof: all points at given normals, without a spline."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import isnan
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.kept import kept
from ..base.memory import check_memory
from ..base.scales import check_range, power_of_two, scale_to_one
from ..base.threads import over_ranges
from ..directions.regions import Reach
from ..domain.domain import Domain
from ..domain.trim import samples_inside, with_uv
from ..proof.index import CELLS, ProvedIndex, ProvedPlaces, Undecided
from ..proof.kernels.answers import KINDS
from ..proof.kernels.samples import CURVATURES, SampleFields, fill_places
from ..samples.fields import (
    FLAG_NAMES,
    Component,
    bytes_of,
    count_of,
    dtype_of,
    regular,
    row_shape,
)
from ..samples.report import SamplingReport, UndecidedNormal, count_infinite
from ..samples.samples import Samples
from ..search.search import developable_patches
from ..spline.kernels.jets import evaluate_jets
from ..spline.spline import Spline
from ..surface.sides import closed_points, with_found_sides
from ..surface.surface import Surface
from ..tape.tapes import jets_of
from .cut_components import components_in
from .on_spline import Fields, in_turn
from .on_surface import OnSurface, geometry_of
from .pole_charts import near_poles, pole_charts
from .reach import with_conditions

PLACES_AT_A_TIME = 1 << 14
# Curvatures at a collapsed side are evaluated at this part of the way to the centre of the domain.
BESIDE = 1e-5
# The column of solutions that has the code of their component, if not all are regular points.
CODE = 6
CURVE = KINDS.index("curve")


class Proof(NamedTuple):
    """The number of normals with a proof that all points are known, and the undecided boxes."""

    proved: int
    undecided: tuple[UndecidedNormal, ...]


def index_of(
    surface: Surface, cells: tuple[int, int] = CELLS, domain: Domain | None = None
) -> ProvedIndex | None:
    """Return the index of a surface, or None if its derivatives have no bounds somewhere.

    If a `domain` is given, points are searched in it, and not in the domain of the surface.
    """
    if surface.tape is None:
        return None
    index = ProvedIndex.of(surface.tape, domain or surface.domain, surface.boundary, cells)
    return index if index is not None and len(index.unbounded) == 0 else None


@dataclass(frozen=True, eq=False)
class ProvedSurface:
    """A surface that gives all points with given normals, with a proof and without a spline.

    The boundary conditions of `surface` include the poles that were found at collapsed sides of its
    domain. `scale` is the power of two that scales the distances of neighbouring points of a grid
    to about 1; `largest` is the largest coordinate of these points. Densities need a spline; it is
    fitted with `cells` cells at first access.
    """

    on: ClassVar[str] = "surface"

    surface: Surface
    index: ProvedIndex
    cells: tuple[int, int] | None
    scale: float
    largest: float
    apexes: int
    threads: int | None = None
    reach: Reach | None = None

    @classmethod
    def of(cls, surface: Surface, cells: tuple[int, int] | None) -> ProvedSurface | None:
        """Return a surface with its index; None if its derivatives have no bounds."""
        surface, apexes = with_found_sides(surface)
        index = index_of(surface)
        if index is None:
            return None
        points = closed_points(surface, CELLS)
        step = max(float(np.abs(np.diff(points, axis=axis)).max()) for axis in (0, 1))
        largest = float(np.abs(points).max())
        return cls(surface, index, cells, scale_to_one(step), largest, apexes)

    @property
    def fitted(self) -> OnSurface:
        """The surface with its spline, for densities; fitted once."""

        def fit() -> OnSurface:
            found = geometry_of(self.surface, self.cells, self.on)
            assert isinstance(found, OnSurface)
            return found

        geometry = kept(self.index, "surface with its spline", fit)
        return replace(geometry, threads=self.threads).within(self.reach)

    @property
    def spline(self) -> Spline:
        """The spline of the surface."""
        return self.fitted.spline

    def used(
        self,
        dtype: DTypeLike,
        threads: int | None,
        memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
    ) -> ProvedSurface:
        """Return the geometry for one call; see `OnPatches.used`."""
        del memory  # is for splines
        check_range(self.surface.name, self.largest, dtype)
        return self if threads == self.threads else replace(self, threads=threads)

    def within(self, reach: Reach | None) -> ProvedSurface:
        """Return the part of the surface in a reach, or all of it for None."""
        return self if reach is None else replace(self, reach=reach)

    def samples_at(
        self,
        normals: NDArray[np.float64],
        fields: Sequence[str],
        dtype: DTypeLike,
        progress: bool = False,
        density: float | None = None,
    ) -> Samples:
        """Return all points that have one of the unit normals (S, 3), with the proof in the report.

        Each component has one sample. Samples are sorted by normal, then by u and v.
        """
        del progress, density  # searches take little time; the report has no entries on a fit
        surface, found = self.surface, self.index.query(normals, self.threads)
        trim, georeference = surface.trim, surface.georeference
        if self.reach is not None:
            trim = with_conditions(surface, surface.jets, self.reach).trim
            surface, found = self.fitted.surface, found.only(self.reach._contains(normals))
        left = found.undecided
        if len(left.numbers) > 0:
            components, left = components_in(trim, left, normals, self._jets)
            numbers, places = with_components(found.numbers, found.places, components)
            found = found._replace(numbers=numbers, places=places)
        check_memory("stored", len(found.numbers), bytes_of(fields, dtype))
        arrays = samples_inside(trim, self._arrays(normals, found, with_uv(trim, fields)), fields)
        held = {x: arrays[x].astype(dtype_of(x, dtype), copy=False) for x in fields}
        report = SamplingReport(
            self.surface.name, len(normals), count_of(held), None, None, None,
            infinite_curvatures=count_infinite(held), on=self.on, unrefined=0, apexes=self.apexes,
            **({} if georeference is None else asdict(georeference)),
            **proof_of(normals, left)._asdict(),
        )  # fmt: skip
        return Samples(**held, report=report, spline=None, surface=surface, offset_of=None)

    def samples_in_turn(
        self,
        normals: NDArray[np.float64],
        fields: Sequence[str],
        dtype: DTypeLike,
        size: int,
        progress: bool,
        density: float,
    ) -> Iterator[Samples]:
        """Yield the samples in parts of at most `size`; the report of the first has the proof."""
        found = self.with_fit(self.samples_at(normals, fields, dtype, progress), density)
        return in_turn(found, size)

    def with_fit(self, samples: Samples, density: float | None = None) -> Samples:
        """Return samples with the spline of the surface, and with a report that describes its fit.

        `density` is the number of normals per steradian in the report, by default S / 4π for S
        prescribed normals.
        """
        geometry, known, arrays = self.fitted, samples.report, samples.arrays()
        report = geometry.report(
            known.normals or 0, density, developable_patches(geometry.spline, self.threads), arrays,
            unrefined=0, proved=known.proved, undecided=known.undecided,
        )  # fmt: skip
        return geometry.samples(arrays, report)

    def _arrays(
        self, normals: NDArray[np.float64], found: ProvedPlaces, fields: Sequence[str]
    ) -> Fields:
        """Return the requested fields of the samples at the solutions that were found."""
        numbers, places = found.numbers, found.places
        count = len(numbers)
        rooms = SampleFields(
            *(
                np.empty((count if x in fields else 0, *row_shape(x)), dtype_of(x, np.float64))
                for x in SampleFields._fields
            )
        )
        K, H = rooms.gaussian_curvature, rooms.mean_curvature
        steps = [
            power_of_two((high - low) / count)
            for (low, high), count in zip(self.surface.domain, CELLS, strict=True)
        ]
        scales, charts = np.array([self.scale, *steps]), pole_charts(self.surface, CELLS)

        def work(first: int, last: int) -> None:
            with self.index.room() as memory:
                fill_places(
                    self.index.tape, memory.work, numbers, places, first, last, normals, scales,
                    np.empty(CURVATURES), rooms,
                )  # fmt: skip
            for rows, _, gaussian, mean in near_poles(charts, self.scale, places[first:last, :2]):
                if len(K) > 0:
                    K[first + rows] = np.copysign(gaussian, places[first + rows, 4])
                if len(H) > 0:
                    H[first + rows] = mean

        list(over_ranges(work, count, PLACES_AT_A_TIME, self.threads))
        arrays = {name: x for name, x in rooms._asdict().items() if name in fields}
        arrays |= {name: np.ones(count, dtype=np.bool_) for name in FLAG_NAMES}
        arrays |= {"normal_index": numbers} | regular(count, fields)
        self._beside_poles(places, scales, K, H)
        if places.shape[1] > CODE:
            special = np.flatnonzero(places[:, CODE] != Component.REGULAR)
            if len(K) > 0:
                K[special] = np.copysign(0.0, places[special, 4])
            if "component" in arrays:
                arrays["component"][:] = places[:, CODE]
        return arrays

    def _beside_poles(
        self, places: NDArray[np.float64], scales: NDArray[np.float64], K: NDArray[np.float64],
        H: NDArray[np.float64],
    ) -> None:  # fmt: skip
        """Replace curvatures at collapsed sides, which are 0, by those at nearby points.

        x_u × x_v is 0 on a collapsed side. Points of such a side are recognized by an error bound
        of u or v that is as large as half the domain.
        """
        known = K if len(K) > 0 else H
        wide = places[: len(known), 2:4] >= 0.5 * np.ptp(self.surface.domain, axis=1)
        (lost,) = np.nonzero(wide.any(axis=1) & (known == 0.0))
        if len(lost) > 0:
            uv = places[lost, :2]
            uv += BESIDE * (np.mean(self.surface.domain, axis=1) - uv)
            normals, found = np.empty((len(lost), 3)), np.empty((2, len(lost)))
            evaluate_jets(self._jets(*uv.T.copy()), scales, normals, *found)
            for x, values in zip((K, H), found, strict=True):
                if len(x) > 0:
                    x[lost] = values

    def _jets(self, u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
        return jets_of(self.index.tape, u, v)

    def component_degrees(self, normals: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return, for each normal, the sum of the degrees of its curves and isolated points.

        Only components with a known kind count: neither regular points nor undecided boxes do.
        """
        found = self.index.query(normals, self.threads)
        trim = self.surface.trim
        components, _ = components_in(trim, found.undecided, normals, self._jets)
        degrees = np.nan_to_num(components.degree)
        return np.bincount(components.numbers, degrees, len(normals)).astype(np.int64)


def with_components(
    numbers: NDArray[np.int64], places: NDArray[np.float64], components: Undecided
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return solutions and points of components together, sorted, with a column of component codes.

    `places` (k, 6) are solutions as in `ProvedPlaces`, `numbers` (k,) the indices of their normals.
    """
    sides, uv = components.boxes.reshape(-1, 2, 2), components.uv
    rows = np.zeros((len(uv), CODE + 1))
    rows[:, :2], rows[:, 2:4] = uv, np.abs(sides - uv[:, :, None]).max(axis=2)
    rows[:, 4] = np.where(np.isnan(components.degree), 1.0, components.degree)
    rows[:, 5] = components.border
    rows[:, CODE] = np.where(components.kinds == CURVE, Component.CURVE, Component.ISOLATED)
    places = np.pad(places, ((0, 0), (0, 1)))  # a column of zeros: Component.REGULAR
    if len(rows) == 0:
        return numbers, places
    places = np.concatenate([places, rows])
    numbers = np.concatenate([numbers, components.numbers])
    order = np.lexsort((places[:, 1], places[:, 0], numbers))
    return numbers[order], places[order]


def proof_of(normals: NDArray[np.float64], open_: Undecided, face: int | None = None) -> Proof:
    """Return the proof for unit normals (S, 3) and undecided boxes.

    For a CAD part, `face` is the index of the face on which points were searched.
    """
    if len(open_.numbers) == 0:
        return Proof(len(normals), ())
    undecided = tuple(
        UndecidedNormal(
            number, tuple(box), KINDS[kind], border, face, None if isnan(degree) else int(degree)
        )
        for number, box, kind, border, degree, _ in zip(*(x.tolist() for x in open_), strict=True)
    )
    return Proof(len(normals) - len(np.unique(open_.numbers)), undecided)
