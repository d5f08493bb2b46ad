"""What the commands that sample share: surfaces and normals that are named or in files."""

from __future__ import annotations

import os
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime import directions
from ...runtime.base.compiling import NOTICE
from ...runtime.base.errors import InputError
from ..cad.part import Part
from ..files.numpy_files import array_file, is_array_file, read_array
from ..sources.elevations import is_raster_file
from ..sources.named import Named
from ..sources.surface_of import surface_of, with_tolerance

__all__ = ["arguments", "named_normals"]


def arguments(options: SimpleNamespace, default_count: int) -> dict[str, Any]:
    """Return the arguments of `sampling.sample` that were given."""
    NOTICE.quiet = options.quiet
    _spare_inputs(options)
    normals = named_normals(options)
    named = Named.of(options)
    surface_, cells = surface_of(named), None
    if not isinstance(surface_, Part):
        surface_, cells = with_tolerance(surface_, named)
    asked = normals, options.count, options.angle, options.coverage
    return {
        "surface": surface_,
        "normals": normals,
        "count": default_count if all(x is None for x in asked) else options.count,
        "angle": options.angle,
        "coverage": options.coverage,
        "density": options.density,
        "relax": options.relax,
        "cells": cells,
        "on": options.on,
        "threads": options.threads,
        "progress": not options.quiet,
    }


def named_normals(options: SimpleNamespace) -> NDArray[np.float64] | None:
    """Return the normals that are named or in a file; None if a number says how many samples."""
    if options.seed is not None and options.random is None:
        raise InputError("--seed is for --random COUNT, which is not there.")
    if options.frequency is not None:
        return directions.icosphere(options.frequency)
    if options.healpix is not None:
        return directions.healpix(options.healpix)
    if options.random is not None:
        return directions.random(options.random, seed=options.seed or 0)
    return None if options.normals is None else read_array(options.normals)


def _spare_inputs(options: SimpleNamespace) -> None:
    """Refuse to write over a file that is read."""
    for source in (options.surface, options.normals):
        if source is not None and (is_array_file(source) or is_raster_file(source)):
            # If one of the two is not there, that is said where it is opened.
            with suppress(OSError):
                if os.path.samefile(array_file(source), options.output):
                    raise InputError(f"'{options.output}' is read; write to another file.")
