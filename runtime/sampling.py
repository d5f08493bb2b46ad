"""`sample` and `sample_many`: from a surface to its samples, in one call."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .bins import NormalBins
from .choice import choose
from .density.filling import filled_samples
from .density.request import Request, checked_request
from .errors import GaussmapError, GaussmapWarning, InputError, in_memory, shown
from .fields import checked_dtype, checked_fields
from .report import sampling_report, warn_of
from .samples import Samples
from .search import fill, find
from .spline import Spline, spline_of
from .surface import Surface

__all__ = [
    "sample",
    "sample_and_normals",
    "sample_many",
]


def sample(
    surface: Surface | Spline | str,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
) -> Samples:
    """Return points of a surface with their normals, dense where it bends.

    The surface is first approximated by a spline of `cells` = (m, n) cells (see `fit`); a `Spline`
    is taken as it is. Say how many samples there shall be by one of

    - `normals`, an array (S, 3) of directions of any length such as `icosphere(32)` or
      `fibonacci(10_000)`: every point that has one of them comes, each exactly once;
    - `count`, how many samples;
    - `angle`, in degrees, at most 90: how far the normal of any point may be from that of the
      sample nearest in normal (next to singular points of the spline, such as cusps, only as far as
      triangles of a thousandth of a patch resolve it);
    - `coverage`, a length of the surface: how far any point may be from the nearest sample.

    `density` says where they are:

    - "gauss", the default of `normals`: as many as |K|, from normals alone (paper, Sect. 4.2).
      Unbeaten in normal space, but parts that bend in one direction only, or not at all, get none.
      A count is met within 2 % (or 5 samples) where the Gaussian image is resolved.
    - "balanced", the default otherwise: the same from fewer normals, and samples that fill what
      these leave. Their `kind` is "coverage", their `normal_index` −1. No point is farther from a
      sample than r / κ, nor than r / √λ: κ is the larger principal curvature, so that normals turn
      by about r, which is twice the angle between the normals. λ is a quarter of the mean of
      κ², or follows from `coverage`, which may be given beside normals, an angle or a count.
    - "uniform": the same everywhere; for `count` or `coverage`.
    - a number α > 0, at most 8: as |K|^α; for `count`. Uniform where the surface has no curvature
      but the error of the spline.

    But for "gauss", a count is met exactly. The report tells the angle and the coverage that were
    reached, if they were asked; `Samples.coverage` tells that of any samples. `relax` steps, 10 at
    most, place what is added better: two or three are enough. They take 20 to 40 times as long as
    the sampling, and 30 kB of memory for each sample, which takes 2 kB else.

    `fields` are the arrays of `Samples` that are wanted, such as ("points", "normals"); by default
    all. The others are neither computed nor stored, which takes less time and memory. With
    `dtype=numpy.float32` all numbers but the indices, which stay int64, are rounded to float32 when
    they are stored; they are computed in float64.

    With `progress`, work that takes longer than a second shows a bar on standard error.

    Samples of normals are ordered by patch and then by normal; those that were added come after
    them. They are the same for any number of `threads` (by default one for each core).

    A GaussmapWarning says when the surface has flat or developable parts, of which normals see
    nothing, and nothing else was asked to cover them; or when a `count` or a `coverage` cannot be
    met. Raises InputError for unusable arguments and too little memory, UnknownNameError for
    unknown fields; SurfaceError for a surface that cannot be evaluated, or that has no area to be
    covered.
    """
    return sample_and_normals(
        surface,
        checked_request(normals, count, angle, coverage, density, relax, threads),
        cells=cells,
        fields=fields,
        dtype=dtype,
        threads=threads,
        progress=progress,
    )[0]


@in_memory
def sample_and_normals(
    surface: Surface | Spline | str,
    request: Request,
    *,
    cells: Sequence[int] | None,
    threads: int | None,
    progress: bool,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return what `sample` returns, and the unit normals that were asked."""
    wanted, number = checked_fields(fields), checked_dtype(dtype)
    filled = request.density != "gauss"
    spline = spline_of(surface, cells)
    sampled = filled_samples if filled else _by_normals
    samples, normals = sampled(spline, request, wanted, number, threads, progress)
    warn_of(samples.report, request.count, 5, coverage=request.coverage, filled=filled)
    return samples, normals


def _by_normals(
    spline: Spline,
    request: Request,
    fields: tuple[str, ...],
    dtype: np.dtype[np.floating],
    threads: int | None,
    progress: bool,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return the points that have the normals that are asked, and these."""
    chosen = choose(spline, request.asked, threads, progress)
    bins, hits = chosen.found or (NormalBins(chosen.part(0, len(chosen), threads), threads), None)
    if hits is None:
        hits = find(spline, bins, threads, progress)
    arrays = fill(spline, bins, hits, threads, fields, dtype)
    report = sampling_report(spline, len(bins.normals), len(hits), chosen.density, hits.developable)
    return Samples(**arrays, report=report, spline=spline), bins.normals


def sample_many(
    surfaces: Iterable[Surface | Spline | str],
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    progress: bool = True,
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
) -> Iterator[Samples]:
    """Yield the samples of each surface, in order; the arguments are those of `sample`.

    Progress goes to standard error if that is a terminal. A surface that raises a GaussmapError is
    reported by a GaussmapWarning, with its number and name, and left out; the others go on.
    `samples.report.surface` tells which surface the samples are of. Raises InputError for
    arguments that no surface can be sampled with.
    """
    from tqdm import tqdm

    request = checked_request(normals, count, angle, coverage, density, relax, threads)
    wanted, number = checked_fields(fields), checked_dtype(dtype)
    if isinstance(surfaces, str) or not isinstance(surfaces, Iterable):
        raise InputError(f"sample_many takes surfaces to go through, not {shown(surfaces)}.")
    bar = tqdm(surfaces, desc="sampling", unit="surface", disable=None if progress else True)
    for place, surface in enumerate(bar):
        try:
            samples, _ = sample_and_normals(
                surface,
                request,
                cells=cells,
                fields=wanted,
                dtype=number,
                threads=threads,
                progress=False,
            )
        except GaussmapError as error:
            name = getattr(surface, "name", surface if isinstance(surface, str) else None)
            name = name or type(surface).__name__
            warnings.warn(
                f"surface {place} ({name}) is left out: {error}", GaussmapWarning, stacklevel=2
            )
        else:
            yield samples
