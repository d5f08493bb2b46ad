"""`sample` and `sample_many`: from a surface to its samples, in one call."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .bins import NormalBins
from .choice import choose, normals_asked
from .compiling import compilation_shown
from .errors import GaussmapError, GaussmapWarning, InputError
from .fields import checked_dtype, checked_fields
from .samples import Samples, SamplingReport
from .search import fill, find
from .spline import Spline, spline_of
from .surface import Surface
from .visibility import invisible_share

__all__ = [
    "sample",
    "sample_and_normals",
    "sample_many",
    "sampling_report",
    "warn_of",
]

WORTH_A_WARNING = 0.01


def sample(
    surface: Surface | Spline,
    normals: ArrayLike | None = None,
    *,
    count: int | None = None,
    cells: Sequence[int] | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    progress: bool = False,
) -> Samples:
    """Return every point of a surface that has one of the given normals, each exactly once.

    Uniformly spread normals make the samples dense where the surface bends and sparse where it is
    flat: their density is |K| (paper, Sect. 4.2). The surface is first approximated by a spline of
    `cells` = (m, n) cells (see `fit`); a `Spline` is taken as it is.

    Give either `normals`, an array (S, 3) of directions of any length such as `icosphere(32)` or
    `fibonacci(10_000)`, or `count`, about how many samples shall come: within 5 % (or one sample)
    where the Gaussian image is resolved, from a Fibonacci lattice of normals round the mean normal
    of the surface.

    `fields` are the arrays of `Samples` that are wanted, such as ("points", "normals"); by default
    all. The others are neither computed nor stored, which takes less time and memory. With
    `dtype=numpy.float32` all numbers but the indices, which stay int64, are rounded to float32 when
    they are stored; they are computed in float64.

    With `progress`, work that takes longer than a second shows a bar on standard error.

    Samples are ordered by patch and then by normal, the same for any number of `threads` (by
    default one for each core). A GaussmapWarning says when the surface has flat or developable
    parts, of which normals see nothing, or when `count` cannot be met. Raises InputError for
    unusable arguments and SurfaceError for a surface that cannot be evaluated.
    """
    return sample_and_normals(
        surface,
        normals,
        count=count,
        cells=cells,
        fields=fields,
        dtype=dtype,
        threads=threads,
        progress=progress,
    )[0]


def sample_and_normals(
    surface: Surface | Spline,
    normals: ArrayLike | None,
    *,
    count: int | None,
    cells: Sequence[int] | None,
    threads: int | None,
    progress: bool,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
) -> tuple[Samples, NDArray[np.float64]]:
    """Return what `sample` returns, and the unit normals that were asked."""
    wanted, number = checked_fields(fields), checked_dtype(dtype)
    asked = normals_asked(normals, count, threads)
    with compilation_shown(progress):
        spline = spline_of(surface, cells)
        chosen = choose(spline, asked, threads, progress)
        bins, hits = chosen.found or (
            NormalBins(chosen.part(0, len(chosen), threads), threads),
            None,
        )
        if hits is None:
            hits = find(spline, bins, threads, progress)
        arrays = fill(spline, bins, hits, threads, wanted, number)
    report = sampling_report(spline, len(bins.normals), len(hits), chosen.density, hits.developable)
    warn_of(report, count, stacklevel=4)
    return Samples(**arrays, report=report, spline=spline), bins.normals


def sample_many(
    surfaces: Iterable[Surface | Spline],
    normals: ArrayLike | None = None,
    *,
    progress: bool = True,
    count: int | None = None,
    cells: Sequence[int] | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
) -> Iterator[Samples]:
    """Yield the samples of each surface, in order; the arguments are those of `sample`.

    Progress goes to standard error if that is a terminal. A surface that raises a GaussmapError is
    reported by a GaussmapWarning, with its number and name, and left out; the others go on.
    `samples.report.surface` tells which surface the samples are of. Raises InputError for unusable
    normals, count, fields, dtype or threads.
    """
    from tqdm import tqdm

    asked = normals_asked(normals, count, threads)
    directions = None if isinstance(asked, int) else asked
    wanted, number = checked_fields(fields), checked_dtype(dtype)
    if isinstance(surfaces, str) or not isinstance(surfaces, Iterable):
        raise InputError(f"sample_many takes surfaces to go through, not {surfaces!r}.")
    bar = tqdm(surfaces, desc="sampling", unit="surface", disable=None if progress else True)
    for place, surface in enumerate(bar):
        try:
            samples = sample(
                surface,
                directions,
                count=count,
                cells=cells,
                fields=wanted,
                dtype=number,
                threads=threads,
            )
        except GaussmapError as error:
            name = getattr(surface, "name", type(surface).__name__)
            warnings.warn(
                f"surface {place} ({name}) is left out: {error}", GaussmapWarning, stacklevel=2
            )
        else:
            yield samples


def sampling_report(
    spline: Spline, normals: int, samples: int, density: float, developable: int | None
) -> SamplingReport:
    """Return how a sampling with `density` normals per steradian went."""
    return SamplingReport(
        surface=spline.name,
        normals=normals,
        samples=samples,
        patches=spline.patches,
        invisible_share=invisible_share(spline, density),
        degenerate_patches=developable,
    )


def warn_of(report: SamplingReport, count: int | None, stacklevel: int) -> None:
    """Say when normals see less of the surface than the user may think."""
    share = report.invisible_share or 0.0
    reasons = []
    if share > WORTH_A_WARNING:
        reasons.append(
            f"{100 * share:.0f} % of its area is flat or developable, where normals see nothing "
            "but the error of the spline"
        )
    elif report.samples == 0 and report.degenerate_patches == report.patches:
        reasons.append("it is flat or developable up to the rounding of its coordinates")
    elif report.samples == 0:
        reasons.append("none of the normals lies in its Gaussian image")
    if count is not None and abs(report.samples - count) > 0.05 * count + 1:
        reasons.append(f"{report.samples} samples came where {count} were asked")
    if reasons:
        message = f"surface {report.surface!r}: {'; '.join(reasons)}."
        warnings.warn(message, GaussmapWarning, stacklevel=stacklevel)
