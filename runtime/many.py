"""`sample_many`: the samples of several surfaces, in the order of these."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from .checks import known_name, yes_or_no
from .density.request import checked_request
from .errors import GaussmapError, GaussmapWarning, InputError, shown
from .fields import checked_dtype, checked_fields
from .geometry.on_surface import checked_place
from .samples import Samples
from .sampling import sample_and_normals
from .splines.spline import Spline
from .surface.surface import Surface

__all__ = ["sample_many"]

Surfaces = Iterable[Surface | Spline | str]
ON_ERROR = ("raise", "skip", "none", "return")


@overload
def sample_many(
    surfaces: Surfaces,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    progress: bool = True,
    on_error: Literal["none"],
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
) -> Iterator[Samples | None]: ...


@overload
def sample_many(
    surfaces: Surfaces,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    progress: bool = True,
    on_error: Literal["return"],
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
) -> Iterator[Samples | GaussmapError]: ...


@overload
def sample_many(
    surfaces: Surfaces,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    progress: bool = True,
    on_error: Literal["raise", "skip"] = "raise",
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
) -> Iterator[Samples]: ...


def sample_many(
    surfaces: Surfaces,
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    progress: bool = True,
    on_error: str = "raise",
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    relax: int = 0,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
) -> Iterator[Samples | GaussmapError | None]:
    """Yield the samples of each of several surfaces, in order.

    Parameters
    ----------
    surfaces : iterable of Surface, Spline or str
        The surfaces; they may be made one by one.
    count, normals, angle, coverage, density, relax, cells, on, fields, dtype, threads : optional
        As in `sample`.
    progress : bool, default True
        Show a bar on standard error, if that is a terminal.
    on_error : {"raise", "skip", "none", "return"}, default "raise"
        What happens if a surface cannot be sampled: its error is raised; or it is left out with a
        warning; or None is yielded in its place, with a warning; or its error is yielded there.

    Yields
    ------
    Samples, GaussmapError or None
        The samples of the next surface: ``samples.report.index`` is its number among `surfaces`,
        from 0 on, and ``samples.report.surface`` its name.

    Raises
    ------
    InputError
        For arguments with which no surface can be sampled.
    GaussmapError
        If a surface cannot be sampled, unless `on_error` says otherwise; a note says which one.

    Warns
    -----
    GaussmapWarning
        If a surface is left out, or None stands for it.

    Notes
    -----
    Surfaces are sampled one after the other, each on all cores. Python functions run on one core:
    for many surfaces of these, sample each of them in one of several processes, with ``threads=1``;
    examples/data_set.py shows how.

    Examples
    --------
    >>> import gaussmap as gm
    >>> for samples in gm.sample_many(["torus", "sphere"], 500):
    ...     print(samples.report.surface, len(samples))
    torus 500
    sphere 500
    >>> broken = gm.Surface.from_callable(lambda u, v: u, ((0, 1), (0, 1)))
    >>> list(gm.sample_many(["torus", broken], 500, on_error="return"))
    [Samples(500 points on torus: ...), SurfaceError(...)]

    """
    from tqdm import tqdm

    request = checked_request(normals, count, angle, coverage, density, relax, threads)
    checked_fields(fields, checked_place(on) != "spline")
    number = checked_dtype(dtype)
    shows = yes_or_no(progress, "progress")
    known_name(on_error, ON_ERROR, "value of on_error")
    flat = isinstance(surfaces, np.ndarray) and surfaces.ndim == 0
    if isinstance(surfaces, str) or flat or not isinstance(surfaces, Iterable):
        raise InputError(f"sample_many takes surfaces to go through, not {shown(surfaces)}.")
    bar = tqdm(surfaces, desc="sampling", unit="surface", disable=None if shows else True)
    for place, surface in enumerate(bar):
        try:
            samples, _ = sample_and_normals(
                surface,
                request,
                cells=cells,
                on=on,
                fields=fields,
                dtype=number,
                threads=threads,
                progress=False,
            )
        except GaussmapError as error:
            where = f"surface {place} ({_name(surface)})"
            if on_error in ("raise", "return"):
                error.add_note(f"This is {where} of sample_many.")
            if on_error == "raise":
                raise
            if on_error == "return":
                yield error
                continue
            left = "left out" if on_error == "skip" else "None"
            warnings.warn(f"{where} is {left}: {error}", GaussmapWarning, stacklevel=2)
            if on_error == "none":
                yield None
        else:
            yield _numbered(samples, place)


def _numbered(samples: Samples, index: int) -> Samples:
    """Return samples whose report has the number of the surface."""
    report = replace(samples.report, index=index)
    known = {"spline": samples.spline, "surface": samples.surface}
    return Samples(**samples.arrays(), report=report, **known)


def _name(surface: object) -> str:
    """Return the name of a surface, or the type of what is none."""
    name = getattr(surface, "name", surface if isinstance(surface, str) else None)
    return name or type(surface).__name__
