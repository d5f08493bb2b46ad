"""`sample_stream`: the samples of a surface in chunks, in bounded memory."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .base.checks import whole_number, yes_or_no
from .base.errors import InputError
from .base.threads import over_ranges, shown
from .density.at_normals import samples_at
from .density.chosen_normals import choose
from .density.on_pieces import geometries_of, kept_geometries, pieces_to_sample
from .place.on_spline import FieldsOfSamples, OnSpline
from .place.on_surface import place_of_samples
from .samples.fields import checked_dtype, checked_fields
from .samples.report import SamplingReport, count_infinite, warn_of
from .samples.request import Request, checked_request
from .samples.samples import Samples
from .search.bins import NormalBins
from .search.search import Hits, Search, find, merged
from .spline.spline import Spline
from .surface.surface import Surface
from .surface.surfaces import named

__all__ = ["sample_stream"]

# The number of normals of a block; with their samples they take about 150 MB.
NORMALS_AT_A_TIME = 1 << 20


def sample_stream(
    surface: Surface | Spline | str,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    chunk: int = 1_000_000,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
) -> Generator[Samples, None, None]:
    """Return the samples of a surface in chunks, in bounded memory.

    They are those of `sample` with ``density="gauss"``. 10⁹ samples that are reduced on the fly
    take less than 1 GiB; with `count`, not even the normals are ever in memory all at once.

    Parameters
    ----------
    surface : Surface, Spline or str
        The surface, or its name in the catalogue.
    count, normals, cells, on, fields, dtype, threads, progress : optional
        As in `sample`: either `count` or `normals`.
    chunk : int, default 1,000,000
        The largest number of samples in a chunk.

    Returns
    -------
    generator of Samples
        The chunks; there is at least one, and all but the last of each block are full, unless the
        surface is trimmed, or several samples of the spline are one of the surface. The report of a
        chunk counts its samples, and no degenerate patches.

    Raises
    ------
    GaussmapError
        As `sample`; all arguments are checked, and the surface is evaluated, before the generator
        is returned.

    Warns
    -----
    GaussmapWarning
        As `sample`, after the last chunk.

    Notes
    -----
    ``Samples.concatenate(sample_stream(…))`` is ``sample(…, density="gauss")``, bit for bit and in
    the same order, for up to 1,048,576 normals. More of them are searched in blocks of this size:
    the samples are the same, but ordered by block, then by patch, then by normal. Closing the
    generator ends the work.

    Examples
    --------
    >>> import gaussmap as gm
    >>> chunks = gm.sample_stream("torus", normals=gm.icosphere(4), chunk=100)
    >>> sum(len(chunk) for chunk in chunks) == len(gm.sample("torus", normals=gm.icosphere(4)))
    True

    """
    size = whole_number(chunk, "chunk")
    surface, number = named(surface), checked_dtype(dtype)
    is_on_surface = place_of_samples(surface, on) == "surface"
    wanted = checked_fields(fields, is_on_surface, proved=is_on_surface)
    request = checked_request(normals, count, None, None, "gauss", threads)
    if pieces := pieces_to_sample(surface):
        raise InputError(
            f"surface {surface.name!r} has {len(pieces)} smooth pieces between creases; "
            "stream each of surface.pieces(), or gm.fit(surface), which rounds the creases."
        )
    if request.normals is not None:  # the caller may change them before the last chunk
        request = replace(request, normals=request.normals.copy())
    make = geometries_of if request.normals is None else kept_geometries
    geometry = make(surface, cells, on)[0].used(number, threads)
    if geometry.index is None:
        wanted = checked_fields(fields, is_on_surface)
    shows = yes_or_no(progress, "progress")
    return _Stream(geometry, request, size, wanted, number, shows).chunks()


@dataclass(frozen=True, eq=False)
class _Stream:
    geometry: OnSpline
    request: Request
    size: int
    fields: tuple[str, ...]
    dtype: np.dtype[np.floating]
    progress: bool

    def chunks(self) -> Generator[Samples, None, None]:
        """Yield the chunks of all blocks of normals, at least one, and warn at the end."""
        if self.geometry.index is not None:
            yield from self._proved_chunks()
            return
        geometry, threads = self.geometry, self.geometry.threads
        chosen = choose(geometry, self.request.normals_or_count, self.progress)
        chosen, total = replace(chosen, found=None), len(chosen)  # frees the hits
        report = geometry.report(total, chosen.density, None, {})
        starts = range(0, total, NORMALS_AT_A_TIME)
        alone = len(starts) == 1
        came, unrefined, flat, nothing = 0, 0, Flat(), None
        for first in shown(iter(starts), len(starts), self.progress and not alone):
            last = min(first + NORMALS_AT_A_TIME, total)
            bins = NormalBins(chosen.part(first, last, threads), threads)
            found = find_in_turn(geometry.spline, bins, threads, self.progress and alone)
            flat.patches = 0  # the same in every block
            parts = flat.counted(found)
            for part in geometry.at_hits_in_turn(bins, parts, self.fields, self.dtype, self.size):
                samples = self._samples(part, first, report)
                came, unrefined = came + part.number, unrefined + (part.unrefined or 0)
                if part.number:
                    yield samples
                else:
                    nothing = samples
            del bins, found, parts  # before the next ones are made
        if came == 0 and nothing is not None:
            yield nothing
        report = replace(report, samples=came, developable_patches=flat.patches)
        warn_of(replace(report, unrefined=unrefined), self.request.count, stacklevel=3)

    def _proved_chunks(self) -> Generator[Samples, None, None]:
        """Yield the same of a proved search, whose samples are sorted by normal."""
        chosen = choose(self.geometry, self.request.normals_or_count, self.progress)
        total, came, report = len(chosen), 0, None
        starts = range(0, total, NORMALS_AT_A_TIME)
        for first in shown(iter(starts), len(starts), self.progress and len(starts) > 1):
            normals = chosen.part(first, first + NORMALS_AT_A_TIME, self.geometry.threads)
            block = replace(chosen, source=normals)
            found = samples_at(self.geometry, block, self.fields, self.dtype, self.progress)[0]
            for start in range(0, max(len(found), 1), self.size):
                if start or len(found) or (first == starts[-1] and not came):
                    part = found[start : start + self.size]
                    yield _chunk(part, first, total, is_first=start == 0)
            came, report = came + len(found), found.report
        assert report is not None
        warn_of(replace(report, samples=came), self.request.count, stacklevel=4)

    def _samples(self, found: FieldsOfSamples, start: int, report: SamplingReport) -> Samples:
        """Return a chunk; its normals are numbered from `start` on."""
        arrays = found.fields
        if start and "normal_index" in arrays:
            arrays["normal_index"] = arrays["normal_index"] + start
        report = replace(report, samples=found.number, infinite_curvatures=count_infinite(arrays))
        return self.geometry.samples(arrays, report, found.unrefined)


def _chunk(found: Samples, start: int, total: int, is_first: bool) -> Samples:
    """Return a chunk of a block of normals from `start` on; the proof is in the first one."""
    arrays: dict[str, Any] = found.arrays()
    report = found.report
    if start and "normal_index" in arrays:
        arrays["normal_index"] = arrays["normal_index"] + start
    undecided = [x._replace(normal=x.normal + start) for x in report.undecided or ()]
    report = replace(
        report,
        normals=total,
        samples=len(found),
        infinite_curvatures=count_infinite(arrays),
        proved=report.proved if is_first else 0,
        undecided=tuple(undecided) if is_first else (),
    )
    return Samples(**arrays, report=report, spline=found.spline, surface=found.surface)


@dataclass
class Flat:
    """Counts developable patches."""

    patches: int = 0

    def counted(self, parts: Iterator[Hits]) -> Iterator[Hits]:
        """Yield the same hits, and count the developable patches of each."""
        for hits in parts:
            self.patches += hits.developable
            yield hits


def find_in_turn(
    spline: Spline, bins: NormalBins, threads: int | None, progress: bool
) -> Iterator[Hits]:
    """Yield the hits of `find` for consecutive ranges of patches."""
    search = Search(spline, bins)
    if search.all_developable:
        yield Hits.none(spline.patches)
        return
    if search.in_tree:
        yield find(spline, bins, threads, progress)
        return
    border = _Border.of(search, threads)
    size = search.range_size(threads)
    yield from over_ranges(border.hits, spline.patches, size, threads, progress)


@dataclass(frozen=True, eq=False)
class _Border:
    """The cells (m n,) at the open border of the domain, and the hits in them decided exactly.

    At the border two patches may both have a hit at one position, of which one is dropped. So the
    undecided hits of these cells are decided together, before all ranges are searched. `decided`
    (k, 2) are rows as in `PackedHits`, `local` (k, 5) is that of `Decision`.
    """

    search: Search
    cells: NDArray[np.bool_]
    decided: NDArray[np.int64]
    local: NDArray[np.float64]

    @classmethod
    def of(cls, search: Search, threads: int | None) -> _Border:
        """Search the cells at the border."""
        south, east, north, west = search.border
        cells = np.zeros(search.spline.cells, dtype=bool)
        cells[:, 0], cells[:, -1] = south, north
        cells[0] |= west
        cells[-1] |= east
        undecided, bounds = [np.empty((0, 2), dtype=np.int64)], [np.empty(0)]
        ends = np.flatnonzero(np.diff(cells.ravel(), prepend=False, append=False))
        for first, last in ends.reshape(-1, 2).tolist():
            for found in search.results(4 * first, 4 * last):
                undecided.append(found.undecided)
                bounds.append(found.bounds)
        decided = search.decided(np.concatenate(undecided), np.concatenate(bounds), threads)
        return cls(search, cells.ravel(), *decided)

    def hits(self, first: int, last: int) -> Hits:
        """Return the hits of the patches first, …, last − 1."""
        found = self.search.results(first, last)
        undecided = np.concatenate([x.undecided for x in found])
        bounds = np.concatenate([x.bounds for x in found])
        inside = ~self.cells[undecided[:, 0] // 4]
        decided, local = self.search.decided(undecided[inside], bounds[inside], 1)
        low, high = np.searchsorted(self.decided[:, 0], (first, last))
        decided = np.concatenate([decided, self.decided[low:high]])
        order = np.lexsort((decided[:, 1], decided[:, 0]))
        local = np.concatenate([local, self.local[low:high]])
        return merged(found, decided[order], local[order], self.search.order)
