"""`sample_stream`: the samples of a surface in chunks, in bounded memory."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ...runtime.base.aliases import Array
from ...runtime.base.checks import whole_number, yes_or_no
from ...runtime.base.errors import InputError
from ...runtime.base.threads import shown
from ...runtime.map import GaussMap, kept_map
from ...runtime.onto_surface.at_tips import samples_in_turn
from ...runtime.onto_surface.on_spline import OnPatches, in_turn
from ...runtime.onto_surface.on_surface import place_of_samples
from ...runtime.onto_surface.proved import ProvedSurface
from ...runtime.onto_surface.smooth_pieces import geometries_of, pieces_to_sample
from ...runtime.samples.fields import checked_dtype, checked_fields
from ...runtime.samples.report import UndecidedNormal, count_infinite, warn_of
from ...runtime.samples.samples import Samples
from ...runtime.search.search import developable_patches
from ...runtime.spline.nets import AnySpline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import named
from ..density.chosen_normals import Chosen, choose
from ..density.request import Request, checked_request

# The number of normals in a block; with their samples they take about 150 MB.
NORMALS_AT_A_TIME = 1 << 20


def sample_stream(
    surface: Surface | AnySpline | str,
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

    The samples are those of `sample` with ``density="gauss"``. 10⁹ samples that are reduced on the
    fly take less than 1 GiB of memory; with `count`, even the normals are made in blocks.

    Parameters
    ----------
    surface : Surface, Spline or str
        The surface, or its name in the catalogue.
    count, normals, cells, on, fields, dtype, threads, progress : optional
        As in `sample`; either `count` or `normals` is given.
    chunk : int, default 1,000,000
        The largest number of samples in a chunk.

    Returns
    -------
    generator of Samples
        The chunks, at least one. In each block of 1,048,576 normals, all chunks but the last are
        full, unless a spline is trimmed. The report of a chunk has the number of its samples, and
        does not count developable patches.

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
    the same order. Normals are searched in blocks of 1,048,576. Closing the generator ends the
    work.

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
    given = normals is not None
    checked_fields(fields, is_on_surface, proved=None, given=given)
    request = checked_request(normals, count, None, None, "gauss", threads)
    if pieces := pieces_to_sample(surface):
        raise InputError(
            f"surface {surface.name!r} has {len(pieces)} smooth pieces between creases; "
            "stream each of surface.pieces(), or gm.fit(surface), which rounds the creases."
        )
    if request.normals is not None:  # the caller may change them before the last chunk
        request = replace(request, normals=request.normals.copy())
    known = None if request.normals is None else kept_map(surface, cells, on)
    pieces = known._pieces if known else geometries_of(surface, cells, on)
    geometry = pieces[0].used(number, threads)
    proved = isinstance(geometry, ProvedSurface)
    wanted = checked_fields(fields, is_on_surface, proved, given=given)
    shows = yes_or_no(progress, "progress")
    return _Stream(geometry, known, request, size, wanted, number, shows).chunks()


@dataclass(frozen=True, eq=False)
class _Stream:
    geometry: OnPatches | ProvedSurface
    known: GaussMap | None
    request: Request
    size: int
    fields: tuple[str, ...]
    dtype: np.dtype[np.floating]
    progress: bool

    @property
    def _chosen(self) -> Chosen:
        """The prescribed normals, or the normals of a lattice for the count."""
        if self.request.count is not None:
            return choose(self.geometry.fitted, self.request.count, self.progress)
        normals = self.request.directions
        return Chosen(normals, len(normals) / (4 * math.pi))

    def chunks(self) -> Generator[Samples, None, None]:
        """Yield the chunks of all blocks of normals, at least one, and warn at the end."""
        geometry, chosen = self.geometry, self._chosen
        chosen, total = replace(chosen, found=None), len(chosen)  # frees the hits
        starts = range(0, total, NORMALS_AT_A_TIME)
        alone = len(starts) == 1
        came, unrefined, last, chunk = 0, 0, None, None
        left, listed = list[UndecidedNormal](), self.request.count is None
        search = partial(samples_in_turn, geometry) if listed else geometry.samples_in_turn
        if self.known is not None and self.known._creases is not None:
            search = self._with_creases
        for first in shown(iter(starts), len(starts), self.progress and not alone):
            end = min(first + NORMALS_AT_A_TIME, total)
            normals = chosen.part(first, end, geometry.threads)
            shows = self.progress and alone
            for part in search(normals, self.fields, self.dtype, self.size, shows, chosen.density):
                last, chunk = part.report, _chunk(part, first, total, listed)
                came, unrefined = came + len(part), unrefined + (last.unrefined or 0)
                more = chunk.report.undecided or ()
                left += more
                if len(part) or more:
                    yield chunk
            del normals  # before the next block is made
        assert last is not None
        assert chunk is not None
        if came == 0 and not left:
            yield chunk
        developable = developable_patches(geometry.spline, geometry.threads)
        report = replace(last, samples=came, developable_patches=developable, unrefined=unrefined)
        report = replace(report, undecided=tuple(left) if listed else None)
        warn_of(report, self.request.count, stacklevel=3)

    def _with_creases(
        self, normals: Array, fields: Sequence[str], dtype: DTypeLike, size: int, progress: bool,
        density: float,
    ) -> Iterator[Samples]:  # fmt: skip
        """Yield at most `size` of the samples at normals at a time, including those on creases."""
        assert self.known is not None
        found = self.known._points(normals, fields, dtype, self.geometry.threads, progress)
        return in_turn(self.geometry.with_fit(found, density), size)


def _chunk(found: Samples, start: int, total: int, listed: bool) -> Samples:
    """Return samples at a block of normals, whose `normal_index` refers to all normals.

    The block begins at the normal with the index `start`; there are `total` normals. The report has
    the undecided normals if `listed`, which means that the normals were prescribed.
    """
    arrays: dict[str, Any] = found.arrays()
    if start and "normal_index" in arrays:
        arrays["normal_index"] = arrays["normal_index"] + start
    report, undecided = found.report, found.report.undecided if listed else None
    if undecided is not None:
        undecided = tuple(x._replace(normal=x.normal + start) for x in undecided)
    report = replace(
        report, normals=total, samples=len(found),
        infinite_curvatures=count_infinite(arrays), undecided=undecided,
    )  # fmt: skip
    return Samples(**arrays, report=report, spline=found.spline, surface=found.surface)
