"""`sample_many`: samples of many surfaces, in the order given, or as a data set."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ...runtime.base.checks import known_name, yes_or_no
from ...runtime.base.errors import GaussmapError, GaussmapWarning, InputError, shown
from ...runtime.base.threads import seen
from ...runtime.directions.regions import Reach
from ...runtime.onto_surface.on_surface import checked_place
from ...runtime.samples.fields import checked_dtype, checked_fields
from ...runtime.samples.samples import Samples
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ..density.request import Request, checked_request
from ..files.paths import PathLike
from ..sampling.sample import sample_and_normals
from .dataset import Dataset, open_dataset
from .inputs import Source
from .making import make
from .plan import SECONDS, plan_of

Surfaces = Iterable[Surface | Spline | str]
ON_ERROR = ("raise", "skip", "return")


class _How(TypedDict, total=False):
    """The sampling options of each surface."""

    normals: ArrayLike | None
    progress: bool
    angle: float | None
    coverage: float | None
    density: str | float | None
    reach: tuple[ArrayLike, float] | Reach | None
    cells: Sequence[int] | None
    on: str | None
    fields: Sequence[str] | None
    dtype: DTypeLike


class _Stored(_How, total=False):
    """The options for making a data set, in addition to the sampling options."""

    workers: int | None
    scheduler: object
    time_limit: float
    memory_limit: float | None
    measure: bool
    overwrite: bool
    retry_failed: bool


@overload
def sample_many(
    surfaces: Surfaces,
    count: int | None = None,
    *,
    on_error: Literal["return"],
    threads: int | None = None,
    **how: Unpack[_How],
) -> Iterator[Samples | GaussmapError]: ...


@overload
def sample_many(
    surfaces: Surfaces,
    count: int | None = None,
    *,
    on_error: Literal["raise", "skip"] = "raise",
    threads: int | None = None,
    **how: Unpack[_How],
) -> Iterator[Samples]: ...


@overload
def sample_many(
    surfaces: Iterable[Source], count: int | None = None, *, out: PathLike, **how: Unpack[_Stored]
) -> Dataset: ...


def sample_many(
    surfaces: Iterable[Source],
    count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    progress: bool = True,
    on_error: str | None = None,
    angle: float | None = None,
    coverage: float | None = None,
    density: str | float | None = None,
    reach: tuple[ArrayLike, float] | Reach | None = None,
    cells: Sequence[int] | None = None,
    on: str | None = None,
    fields: Sequence[str] | None = None,
    dtype: DTypeLike = np.float64,
    threads: int | None = None,
    out: PathLike | None = None,
    workers: int | None = None,
    scheduler: object = None,
    time_limit: float = SECONDS,
    memory_limit: float | None = None,
    measure: bool = False,
    overwrite: bool = False,
    retry_failed: bool = False,
) -> Iterator[Samples | GaussmapError] | Dataset:
    """Yield the samples of each of several surfaces, in order; or make a data set of them.

    With `out` the parts are sampled by several processes, on this machine or on a cluster, into a
    folder of Parquet files (docs/datasets.md). A part that fails has a row in the manifest, too. If
    the run is stopped or killed, the same call resumes it.

    Parameters
    ----------
    surfaces : iterable of Surface, Spline or str
        The surfaces; an iterator may make them one by one. With `out` also CAD parts and paths: CAD
        files, saved parts, GeoTIFFs, and points (m, n, 3) in .npy and .npz files (FILE.npz:NAME if
        the file holds several arrays).
    count, normals, angle, coverage, density, cells, on, fields, dtype, threads : optional
        As in `sample`. With `out`, the default fields are points, normals, uv, support and both
        curvatures, each process has one thread, and `threads` cannot be given.
    reach : (axis, angle), optional
        As in `sample`.
    progress : bool, default True
        Show a bar on standard error, if that is a terminal.
    on_error : {"raise", "skip", "return"}, default "raise"
        What to do without `out` if a surface cannot be sampled: raise its error, leave the surface
        out with a warning, or yield the error in its place.
    out : path, optional
        The folder of the data set. All following arguments are for data sets only.
    workers : int, optional
        The number of processes; by default one for each core.
    scheduler : str or distributed.Client, optional
        The address of a Dask scheduler, or a client: its workers sample the parts, and must see the
        folder by the same path. The extra `cluster` installs Dask.
    time_limit : float, default 600.0
        The time limit of a part, in seconds. A part that fails is tried twice.
    memory_limit : float, optional
        The memory limit of a process, in GiB (not on macOS and Windows); by default the workers
        share nine tenths of this machine's memory.
    measure : bool, default False
        Measure coverage and normal deviation of each part for the manifest, even where they were
        not requested; that may take ten times as long as sampling.
    overwrite : bool, default False
        Remove the data set that is in the folder, if any, first.
    retry_failed : bool, default False
        Sample again the parts that failed in an earlier run.

    Yields
    ------
    Samples or GaussmapError
        The samples of the next surface: ``samples.report.index`` is its index in `surfaces`, and
        ``samples.report.surface`` its name.

    Returns
    -------
    Dataset
        With `out`, the data set.

    Raises
    ------
    InputError
        For arguments with which no surface can be sampled; if `threads` or `on_error` is given with
        `out`, or `workers`, `scheduler` or `memory_limit` without it; and if the folder holds a
        data set with other settings.
    FileError
        If the folder holds other files or cannot be written to, if another run writes to it, or if
        Dask's scheduler or its workers cannot be used.
    MissingExtraError
        If an extra is missing: `batch` for data sets, `cluster` for schedulers.
    GaussmapError
        If a surface cannot be sampled, unless `on_error` says otherwise; a note names the surface.

    Warns
    -----
    GaussmapWarning
        If a surface is left out.

    Notes
    -----
    Without `out`, surfaces are sampled one after the other, each on all cores; Python functions run
    on one core. With `out`, each process samples one surface on one core, which is faster for many
    surfaces.

    A resumed run samples a part again if its content has changed: the bytes of its file, or points
    of its surface.

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
    >>> parts = gm.sample_many(["torus", "missing.step"], 500, cells=(16, 16), out="parts")
    >>> parts.manifest()["status"].to_pylist()
    ['ok', 'failed']

    """
    request = checked_request(normals, count, angle, coverage, density, threads, reach)
    shows = yes_or_no(progress, "progress")
    if isinstance(surfaces, str | bytes) or not _iterates(surfaces):
        raise InputError(f"sample_many takes an iterable of surfaces, not {shown(surfaces)}.")
    of_data_sets = {"workers": workers, "scheduler": scheduler, "memory_limit": memory_limit}
    if out is None:
        for name, value in of_data_sets.items():
            if value is not None:
                raise InputError(f"{name}=… is for data sets; name the folder of one by out=….")
        checked_fields(fields, checked_place(on) != "spline")
        action = known_name(
            "raise" if on_error is None else on_error, ON_ERROR, "value of on_error"
        )
        how = {"cells": cells, "on": on, "fields": fields, "threads": threads}
        return _each(surfaces, request, how | {"dtype": checked_dtype(dtype)}, action, shows)
    if on_error is not None or threads is not None:
        name = "threads" if on_error is None else "on_error"
        raise InputError(f"{name}=… does not go together with out=…; leave it out.")
    plan = plan_of(
        request, cells=cells, on=on, measured=yes_or_no(measure, "measure"), fields=fields,
        dtype=dtype,
    )  # fmt: skip
    make(
        surfaces,
        out,
        plan,
        request.normals,
        workers=workers,
        scheduler=scheduler,
        time_limit=time_limit,
        memory_limit=memory_limit,
        how={"disable": not seen(shows)},
        overwrite=yes_or_no(overwrite, "overwrite"),
        again=yes_or_no(retry_failed, "retry_failed"),
    )
    return open_dataset(out)


def _iterates(surfaces: Iterable[Source]) -> bool:
    """Return whether `surfaces` can be iterated over; arrays of zero dimensions cannot."""
    try:
        iter(surfaces)
    except Exception:  # objects raise anything
        return False
    return True


def _each(
    surfaces: Iterable[Any], request: Request, how: dict[str, Any], on_error: str, shows: bool
) -> Iterator[Samples | GaussmapError]:
    """Yield the samples of each surface; for a surface that fails, do what `on_error` says."""
    from tqdm import tqdm

    bar = tqdm(surfaces, desc="sampling", unit="surface", disable=None if shows else True)
    for place, surface in enumerate(bar):
        try:
            samples, _ = sample_and_normals(surface, request, progress=False, **how)
        except GaussmapError as error:
            where = f"surface {place} ({_name(surface)})"
            if on_error == "skip":
                warnings.warn(f"{where} is left out: {error}", GaussmapWarning, stacklevel=2)
                continue
            error.add_note(f"This is {where} of sample_many.")
            if on_error == "raise":
                raise
            yield error
        else:
            report = replace(samples.report, index=place)
            known = {"spline": samples.spline, "surface": samples.surface}
            yield Samples(**samples.arrays(), report=report, **known)


def _name(surface: object) -> str:
    """Return the name of a surface, or the type of any other object."""
    name = getattr(surface, "name", surface if isinstance(surface, str) else None)
    return name or type(surface).__name__
