"""Sampling of surfaces without a proof: points are found on a spline, and moved to the surface."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.checks import known_name
from ..base.errors import InputError
from ..base.kept import kept
from ..domain.trim import samples_inside
from ..fitting.fit import patches_of
from ..samples.fields import FLAG_NAMES, count_of
from ..samples.report import PLACES, UndecidedNormal
from ..search.search import Hits
from ..spline.developable import CellMeasure
from ..spline.nets import AnySpline
from ..spline.spline import Spline
from ..surface.derivatives import Differentiable
from ..surface.surface import Surface
from .kernels import nodes as kernels
from .moved_samples import as_fields, moved_samples, part_of, unmoved
from .newton import evaluate_on_surface
from .on_spline import Array, Fields, FieldsOfSamples, OnPatches, OnSpline
from .pole_charts import PoleChart, pole_charts
from .repeats import kept_once

# In streams, samples are moved, and tested for repeats, in groups of about this number.
TOGETHER = 1 << 17
# The share of hits that become samples is estimated from about this number of hits.
TRIED = 1 << 12


def place_of_samples(surface: object, on: str | None) -> str:
    """Return where the samples of a surface lie: "surface" or "spline".

    Raises UnknownNameError for another word, InputError if samples cannot lie on the surface.
    """
    known = isinstance(surface, Surface) and surface.grid is None
    if checked_place(on) is None:
        return "surface" if known else "spline"
    if on == "surface" and not known:
        if isinstance(surface, Surface):
            raise InputError(
                "samples on the surface need one that can be evaluated everywhere, and "
                f"{surface.name!r} was given by points; its spline is all there is."
            )
        if isinstance(surface, AnySpline):
            raise InputError(
                f'on="surface" needs the surface, not its spline: sample the Surface of which '
                f"{surface.name!r} is a spline."
            )
    return str(on)


def checked_place(on: str | None) -> str | None:
    """Return `on` if it is "surface", "spline" or None; UnknownNameError otherwise."""
    return None if on is None else known_name(on, PLACES, "place of samples")


def geometry_of(
    surface: Surface | AnySpline, cells: Sequence[int] | None, on: str | None
) -> OnPatches:
    """Return the geometry that is sampled without a proof: a spline, or a surface with its spline.

    Raises the errors of `place_of_samples` and `patches_of`.
    """
    place = place_of_samples(surface, on)
    spline = patches_of(surface, cells)
    if not isinstance(spline, Spline):
        return OnPatches(spline)
    if place == "surface" and isinstance(surface, Surface):
        if surface.boundary != spline.boundary:  # poles that the fit has found
            surface = replace(surface, boundary=spline.boundary)
        return OnSurface(spline, surface=surface)
    return OnSpline(spline)


@dataclass(frozen=True, eq=False)
class OnSurface(OnSpline):
    """A surface that is sampled without a proof, and the spline on which points are searched."""

    on: ClassVar[str] = "surface"

    @property
    def distance(self) -> float:
        """The largest measured distance between the surface and its spline."""
        misfit = self.spline.misfit
        return 0.0 if misfit is None else misfit.distance

    def normals(self, places: Array) -> Array:
        """Return unit normals (k, 3) of the surface at parameters (k, 2); 0 at singular points."""
        assert self.surface is not None
        return evaluate_on_surface(self.surface, self.spline, places.copy(), threads=1)[1]

    @property
    def measure(self) -> tuple[Array, Array]:
        """Areas and signed solid angles of the patches, as `Spline.measure`.

        The solid angle of a cell is the integral of K of the surface, computed at the Gauss points
        of the cell; each patch gets a fourth of it. For surfaces whose derivatives do not come from
        formulas, which take many evaluations, the solid angles are those of the spline. Both arrays
        are cached with the spline.
        """
        return kept(self.spline, "measure of the surface", self._measured)

    def _measured(self) -> tuple[Array, Array]:
        if not self.knows_jets:
            return self.spline.measure
        areas, inside = self.spline.measure[0], self.spline.inside
        solid_angles = np.repeat(self._at_gauss_points.reshape(-1, 4).sum(axis=1) / 16.0, 4)
        return areas, solid_angles if inside is None else solid_angles * inside.shares

    @property
    def cell_measure(self) -> CellMeasure:
        """Areas and signed solid angles of the cells."""

        def of_cells() -> CellMeasure:
            return CellMeasure.of(self.measure, self.spline.cells)

        return kept(self.spline, "measure of cells of the surface", of_cells)

    @property
    def _at_gauss_points(self) -> Array:
        """K times the area element of a cell at its four Gauss points, (4 · cells,).

        It is 0 at singular points.
        """
        found, columns = np.empty(self.spline.patches), self.spline.cells[1]
        ends = 0.5 + kernels.GAUSS * np.array([-0.5, 0.5])
        u0, v0, du, dv = self.spline.frame

        def work(first: int, last: int) -> None:
            cell, node = np.divmod(np.arange(first, last), 4)
            u = u0 + du * (cell // columns + ends[node // 2])
            v = v0 + dv * (cell % columns + ends[node % 2])
            kernels.signed_solid_angles(
                self.jets(u, v), self._size, self.spline.frame, found[first:last]
            )

        self._in_parts(work, len(found))
        return found

    # --- samples at normals -----------------------------------------------------------------------

    def at_hits(
        self, normals: Array, hits: Hits, fields: Sequence[str], dtype: DTypeLike
    ) -> FieldsOfSamples:
        """Return the requested fields of the samples at hits.

        Of samples that coincide on the surface, only one is returned. A hit for which no point of
        the surface is found has no sample, and its normal has an undecided box.
        """
        arrays, left = self._found(normals, hits)
        return as_fields(arrays, fields, dtype)._replace(undecided=left)

    def near_hits(
        self, normals: Array, hits: Hits, fields: Sequence[str], dtype: DTypeLike
    ) -> FieldsOfSamples:
        """Return the samples at hits, including hits for which no point of the surface is found.

        The samples at such hits are points of the spline. Of samples that coincide on the surface,
        only one is returned.
        """
        return as_fields(self._moved_once(normals, hits), fields, dtype)

    def share_at(self, normals: Array, hits: Hits) -> float:
        """Return the share of hits that become samples, estimated from about TRIED hits."""
        some = hits.normal_index % max(len(hits) // TRIED, 1) == 0
        moved = self._moved(normals, hits.rows(np.flatnonzero(some)))
        found = moved[FLAG_NAMES[0]] & self._kept_once(moved)
        return float(found.mean()) if len(found) else 1.0

    def at_hits_in_turn(
        self,
        normals: Array,
        parts: Iterator[Hits],
        fields: Sequence[str],
        dtype: DTypeLike,
        size: int,
    ) -> Iterator[FieldsOfSamples]:
        """Yield the samples at the hits of all `parts`, at most `size` at a time.

        All hits of a normal are moved together, since only samples of one normal can coincide.
        """
        came, rest, left = False, list[Fields](), tuple[UndecidedNormal, ...]()
        for hits in (x for part in parts for x in part.whole_normals(TOGETHER)):
            arrays, more = self._found(normals, hits)
            rest.append(arrays)
            left += more
            if sum(map(count_of, rest)) < size:
                continue
            arrays = _joined(rest)
            end = count_of(arrays) // size * size
            for first in range(0, end, size):
                part = as_fields(_rows(arrays, first, first + size), fields, dtype)
                yield part._replace(undecided=left)
                left = ()
            came, rest = True, [_rows(arrays, end, None)]
        arrays = _joined(rest)
        if count_of(arrays) or left or not came:
            yield as_fields(arrays, fields, dtype)._replace(undecided=left)

    def _found(self, normals: Array, hits: Hits) -> tuple[Fields, tuple[UndecidedNormal, ...]]:
        """Return the samples on the surface, and the undecided boxes of hits without a sample."""
        arrays = self._moved_once(normals, hits)
        left = np.flatnonzero(~arrays[FLAG_NAMES[0]])
        numbers, uv = arrays["normal_index"][left], arrays["uv"][left]
        return part_of(arrays, arrays[FLAG_NAMES[0]]), unmoved(self.spline, numbers, uv)

    def _moved_once(self, normals: Array, hits: Hits) -> Fields:
        """Return the samples of `_moved`; of samples that coincide on the surface, only one."""
        arrays = self._moved(normals, hits)
        return part_of(arrays, self._kept_once(arrays))

    def _moved(self, normals: Array, hits: Hits) -> Fields:
        """Return the samples at hits inside the trim, with all fields but the support."""
        assert self.surface is not None
        arrays = moved_samples(self.surface, self.spline, normals, hits, self.threads)
        return samples_inside(self.spline.trim, arrays, tuple(arrays))

    def _at_poles(self, arrays: Fields) -> NDArray[np.bool_]:
        """Return a mask of the samples that are next to a pole."""
        at_poles = [chart.near(arrays["uv"]) for chart in self._charts]
        return np.logical_or.reduce([np.zeros(len(arrays["uv"]), dtype=bool), *at_poles])

    def _kept_once(self, arrays: Fields) -> NDArray[np.bool_]:
        """Return a mask of the samples to keep, so that none is repeated; see `kept_once`."""
        return kept_once(self.spline, arrays, self._at_poles(arrays))

    @property
    def _charts(self) -> list[PoleChart]:
        assert self.surface is not None
        return pole_charts(self.surface, self.spline.cells)

    # --- samples that fill gaps -------------------------------------------------------------------

    @property
    def knows_jets(self) -> bool:
        """Whether derivatives come from formulas, not from a user's callable or differences."""
        function = None if self.surface is None else self.surface.function
        return isinstance(function, Differentiable) and function.differentiable

    def jets(self, u: Array, v: Array) -> Array:
        """Return the 2-jets (k, 6, 3) of the surface."""
        assert self.surface is not None
        return self.surface.jets(u, v)

    def at_parameters(
        self, uv: Array, normals: Array, K: Array, fields: Sequence[str], dtype: DTypeLike
    ) -> Fields:
        """Return fields of samples on the surface at parameters (k, 2).

        At singular points of the surface, the fields are those of the spline, with the given
        `normals` and the signs of `K`; see `OnSpline.at_parameters`.
        """
        assert self.surface is not None
        points, directions, gaussian, mean = evaluate_on_surface(
            self.surface, self.spline, uv, self.threads
        )
        there: NDArray[np.bool_] = np.any(directions, axis=1)
        arrays = super().at_parameters(uv, normals, K, fields, dtype)
        found = {
            "uv": uv,
            "points": points,
            "normals": directions,
            "support": np.einsum("ij,ij->i", points, directions),
            "gaussian_curvature": gaussian,
            "mean_curvature": mean,
        }
        for name in set(arrays) & set(found):
            arrays[name][there] = found[name][there]
        return arrays | {name: there for name in FLAG_NAMES if name in fields}


def _joined(parts: Sequence[Fields]) -> Fields:
    """Return the fields of the samples of all parts, one after the other."""
    if len(parts) == 1:
        return parts[0]
    return {name: np.concatenate([x[name] for x in parts]) for name in parts[0]}


def _rows(arrays: Fields, first: int, last: int | None) -> Fields:
    """Return the samples [first, last)."""
    return {name: x[first:last] for name, x in arrays.items()}
