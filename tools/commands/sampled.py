"""Inputs of the commands that sample: surfaces and normals, by name or from files."""

import os
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime import directions
from ...runtime.base.compiling import NOTICE
from ...runtime.base.errors import InputError
from ...runtime.base.progress import busy
from ...runtime.directions.regions import Reach
from ...runtime.samples.samples import Samples
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ..cad.part import Part
from ..density.request import Request, checked_request
from ..files.numpy_files import array_file, is_array_file, read_array
from ..sampling.sample import sample_and_normals
from ..sources.elevations import is_raster_file
from ..sources.named import Named
from ..sources.surface_of import surface_of, with_tolerance


def sampled(
    options: SimpleNamespace,
    default_count: int,
    **how: Any,  # noqa: ANN401
) -> tuple[Samples, NDArray[np.float64]]:
    """Return the samples that a command requests, and the requested unit normals."""
    progress = not options.quiet
    spare_inputs(options)
    if options.trimmed and options.offset is None:
        raise InputError("--trimmed goes with --offset DISTANCE only.")
    request = request_of(options, default_count)
    surface_, cells = named_surface(options)
    how |= {"cells": cells, "on": options.on, "threads": options.threads, "progress": progress}
    with busy("sampling", progress):
        samples, normals = sample_and_normals(surface_, request, **how)
        if options.offset is not None:
            samples = samples.offset(options.offset, trimmed=options.trimmed)
    return samples, normals


def named_surface(
    options: SimpleNamespace,
) -> tuple[Surface | Spline | Part, tuple[int, int] | None]:
    """Return the surface that a command names, and the cells of its spline, None by default."""
    NOTICE.quiet = options.quiet
    named = Named.of(options)
    surface_ = surface_of(named)
    return (surface_, None) if isinstance(surface_, Part) else with_tolerance(surface_, named)


def request_of(options: SimpleNamespace, default_count: int) -> Request:
    """Return the request that the options describe, by default for `default_count` samples."""
    normals = named_normals(options)
    asked = normals, options.count, options.angle, options.coverage
    count = default_count if all(x is None for x in asked) else options.count
    given = vars(options)
    reach, how = (
        options.reach,
        {x: given[x] for x in ("slope", "aspect", "from_edges", "clearance")},
    )
    if reach is not None or options.unobstructed or any(x is not None for x in how.values()):
        cap = () if reach is None else (reach[:3], reach[3])
        reach = Reach(*cap, **how, unobstructed=options.unobstructed)
    amounts = normals, count, options.angle, options.coverage
    return checked_request(*amounts, options.density, given.get("threads"), reach)


def named_normals(options: SimpleNamespace) -> NDArray[np.float64] | None:
    """Return the normals that the options describe, or those of a file; None if there are none."""
    if options.seed is not None and options.random is None:
        raise InputError("--seed goes with --random COUNT only.")
    if options.frequency is not None:
        return directions.icosphere(options.frequency)
    if options.healpix is not None:
        return directions.healpix(options.healpix)
    if options.random is not None:
        return directions.random(options.random, seed=options.seed or 0)
    return None if options.normals is None else read_array(options.normals)


def spare_inputs(options: SimpleNamespace) -> None:
    """Raise InputError if the output file is one of the input files."""
    for source in (options.surface, options.normals):
        if source is not None and (is_array_file(source) or is_raster_file(source)):
            # A missing file is reported where it is opened.
            with suppress(OSError):
                if os.path.samefile(array_file(source), options.output):
                    raise InputError(f"'{options.output}' is read; write to another file.")
