"""What samples lie on: a spline, or the surface that it approximates.

Samples are searched on the spline. Those of the surface are then moved to it: at a prescribed
normal to the point that has this normal, elsewhere to the point with the same parameters. Sizing
functions and solid angles take the curvature of the surface from the Gauss points of the cells.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.georeference import Georeference
from ..base.memory import check_memory
from ..kernels.forms import forms_on_spline
from ..kernels.sizing import TargetDensity
from ..kernels.tile import fill_known
from ..samples.fields import FLOAT_NAMES, bytes_of, new_field
from ..samples.report import SamplingReport
from ..samples.samples import Samples
from ..search.bins import NormalBins
from ..search.search import Hits, fill
from ..spline.developable import CellMeasure
from ..spline.inside import count_of, samples_inside, with_uv
from ..spline.spline import Spline
from ..surface.surface import Surface

if TYPE_CHECKING:
    from ..spline.misfit import Misfit
    from .triangles import Triangles

__all__ = ["Fields", "FieldsOfSamples", "OnSpline", "grouped"]

Array = NDArray[np.float64]
Fields = dict[str, NDArray[Any]]


class FieldsOfSamples(NamedTuple):
    """Fields of samples, and how many of these are not on the surface."""

    fields: Fields
    unrefined: int | None = None

    @property
    def number(self) -> int:
        """The number of samples."""
        return count_of(self.fields)


@dataclass(frozen=True, eq=False)
class OnSpline:
    """A spline as what is sampled; `surface` is for `OnSurface`.

    Samples at normals are written to the fields in `memory` that are large enough.
    """

    on: ClassVar[str] = "spline"

    spline: Spline
    threads: int | None = None
    surface: Surface | None = None
    memory: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Label of the surface."""
        return self.spline.name

    @property
    def cells(self) -> tuple[int, int]:
        """The numbers of cells of the spline."""
        return self.spline.cells

    @property
    def patches(self) -> int:
        """The number of patches of the spline."""
        return self.spline.patches

    @property
    def apexes(self) -> int:
        """The number of apexes of the spline."""
        return self.spline.apexes

    @property
    def georeference(self) -> Georeference | None:
        """Where the coordinates are on the Earth."""
        return self.spline.georeference

    @property
    def misfit(self) -> Misfit | None:
        """The misfit of the spline."""
        return self.spline.misfit

    @cached_property
    def measure(self) -> tuple[Array, Array]:
        """Areas and signed solid angles of the patches, as `Spline.measure`."""
        return self.spline.measure

    @cached_property
    def _cell_measure(self) -> CellMeasure:
        """The same of the cells."""
        return self.spline._cell_measure

    @property
    def distance(self) -> float:
        """How far the points of what is sampled are from those of the spline, at most."""
        return 0.0

    # --- samples at normals -----------------------------------------------------------------------

    def at_hits(
        self, bins: NormalBins, hits: Hits, fields: Sequence[str], dtype: DTypeLike
    ) -> FieldsOfSamples:
        """Return the samples at hits, with the fields that are requested."""
        wanted = with_uv(self.spline, fields)
        check_memory("stored", len(hits), bytes_of(set(wanted) - set(self.memory), dtype))
        arrays = fill(self.spline, bins, hits, self.threads, wanted, dtype, self.memory)
        return FieldsOfSamples(samples_inside(self.spline, arrays, fields))

    def at_hits_in_turn(
        self,
        bins: NormalBins,
        parts: Iterator[Hits],
        fields: Sequence[str],
        dtype: DTypeLike,
        size: int,
    ) -> Iterator[FieldsOfSamples]:
        """Yield at most `size` samples at a time, those at `parts` of all hits of these normals."""
        for hits in grouped(parts, size):
            yield self.at_hits(bins, hits, fields, dtype)

    def samples(self, fields: Fields, report: SamplingReport, unrefined: int | None) -> Samples:
        """Return samples of fields, with what is known of all of them."""
        report = replace(report, on=self.on, unrefined=unrefined)
        return Samples(
            **fields, report=report, spline=self.spline, surface=self.surface, offset_of=None
        )

    def forms(self, cells: Array) -> Array:
        """Return the fundamental forms (k, 7) at places (k, 2) in cells; see `forms_of_jets`."""
        found = np.empty((len(cells), 7))
        forms_on_spline(self.spline.coefficients, self.spline.scale, cells, found)
        return found

    # --- samples that fill gaps -------------------------------------------------------------------

    def densities(self, target: TargetDensity, radii: Array, densities: Array) -> Array:
        """Return the target densities (patches, 4), without the floor, at the nodes of patches.

        `densities` are those of the spline, radii (patches,) those of the patches.
        """
        return densities

    def as_candidates(self, triangles: Triangles, rows: Array) -> Array:
        """Return the rows (M, 8) of `Triangles.at_places`, from those of the spline."""
        return rows

    def as_samples(self, triangles: Triangles) -> Array:
        """Return the rows (M, 8 + k) of candidates that have become samples.

        The columns after those of candidates are for `at_places`.
        """
        return triangles.at_places()

    def normal_chords(self, triangles: Triangles, rows: Array) -> Array:
        """Return how far normals of triangles (M,) are from those of their rows, at most.

        That is the length of the chord between the unit vectors, or 2 if no bound below √2 is
        known. `rows` are those of `as_samples`.
        """
        return triangles.normal_chords(rows)

    def at_places(
        self,
        triangles: Triangles,
        normals: Array,
        K: Array,
        exact: Array | None,
        fields: Sequence[str],
        dtype: DTypeLike,
    ) -> FieldsOfSamples:
        """Return the samples at the places of triangles; see `as_samples`.

        normals (M, 3), the signs of K (M,) and the columns `exact` are those of their rows.
        """
        patch_index, uv = triangles.patches, triangles.uv
        count, spline = len(triangles), self.spline
        filled = {x: new_field(x, count, dtype) for x in FLOAT_NAMES if x in fields}
        here = np.arange(count)
        fill_known(
            spline.coefficients, spline.scale, normals, spline.frame,
            here, np.column_stack([patch_index, here]), np.column_stack([uv, K, uv]),
            *(filled[x] if x in filled else new_field(x, 0, dtype) for x in FLOAT_NAMES),
        )  # fmt: skip
        indices = {"normal_index": np.full(count, -1), "patch_index": patch_index}
        return FieldsOfSamples(filled | {x: y for x, y in indices.items() if x in fields})


def grouped(parts: Iterator[Hits], size: int) -> Iterator[Hits]:
    """Yield consecutive hits in groups of `size`, and a last group with the remaining ones."""
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
