"""What the commands that sample share: surfaces and normals that are named or in files."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...runtime import directions
from ...runtime.base.advice import NO_CLOUDS, NO_MESHES, is_mesh_file
from ...runtime.base.checks import known_name
from ...runtime.base.compiling import NOTICE
from ...runtime.base.errors import FileError, InputError
from ...runtime.fitting.fit import fit
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import CATALOGUE, names, surface
from ..cad.part import Part
from ..cad.part_files import is_part_file
from ..files.arrays import array_file, is_array_file, read_array
from .parts import LIMITS, read_part_file, refuse
from .terrains import OF_TERRAIN, has_place, is_raster_file, read_raster_file, terrain_of_array

__all__ = ["arguments", "named_normals"]

NOT_OF_FORMULAS = ("set", "spacing", "nodata")
NOT_OF_PARTS = ("set", "domain", "spacing", "periodic", "nodata", "cells", "tolerance", *OF_TERRAIN)
PERIODIC = {"none": (False, False), "u": (True, False), "v": (False, True), "uv": (True, True)}


def arguments(options: SimpleNamespace, default_count: int) -> dict[str, Any]:
    """Return the arguments of `sampling.sample` that were given."""
    NOTICE.quiet = options.quiet
    _spare_inputs(options)
    normals = named_normals(options)
    surface_, cells = _part(options), None
    if surface_ is None:
        surface_, cells = _with_tolerance(_surface(options), options)
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


def _part(options: SimpleNamespace) -> Part | None:
    """Return the part in a file; InputError for options that it does not have."""
    if not is_part_file(options.surface):
        return None
    for name in NOT_OF_PARTS:
        if getattr(options, name) not in (None, ()):
            option = name.replace("_", "-")
            raise InputError(f"--{option} is for surfaces, and '{options.surface}' is a CAD part.")
    return read_part_file(options.surface, options)


def _surface(options: SimpleNamespace) -> Surface:
    source = options.surface or "a formula"
    refuse([x for x in LIMITS if getattr(options, x) is not None], "is for CAD files", source)
    if options.formula is not None:
        refuse(
            [x for x in OF_TERRAIN if getattr(options, x) is not None], "is for elevations", source
        )
        return _of_formula(options)
    if options.domain is not None:
        raise InputError("--domain is for --formula, which is not there.")
    if is_array_file(options.surface) or is_raster_file(options.surface):
        return _grid(options)
    _refuse_file(options.surface)
    refuse([x for x in OF_TERRAIN if getattr(options, x) is not None], "is for elevations", source)
    name = known_name(options.surface, names(), "surface", "gaussmap surfaces")
    if options.spacing is not None:
        raise InputError(f"--spacing is for elevations in a file, and {name} is a surface by name.")
    if options.periodic is not None:
        raise InputError(f"--periodic is for grids in a file; {name} knows where it closes.")
    if options.nodata is not None:
        raise InputError(f"--nodata is for grids in a file; {name} has no missing points.")
    parameters = dict(options.set)
    if len(parameters) < len(options.set):
        raise InputError("--set gives the same parameter twice; give each once.")
    for parameter in parameters:
        known_name(parameter, tuple(CATALOGUE[name]["parameters"]), f"{name} parameter")
    return surface(name, **parameters)


def _refuse_file(source: str) -> None:
    """Raise an error if SURFACE is a file of another kind, or the name of one that is missing."""
    if is_mesh_file(source):
        raise InputError(f"'{source}' is a mesh; {NO_MESHES}.")
    if Path(source).is_file():
        raise InputError(
            f"'{source}' is neither a .npy, .npz nor .tif file, nor a CAD part; write points (m, "
            "n, 3) or elevations (m, n) by numpy.save."
        )
    if Path(source).suffix:
        raise FileError(f"'{source}' does not exist; look at its name and folder.")


def _of_formula(options: SimpleNamespace) -> Surface:
    for name in NOT_OF_FORMULAS:
        if getattr(options, name) not in (None, ()):
            raise InputError(f"--{name} does not go together with --formula; leave it out.")
    if options.domain is None:
        raise InputError("--formula needs the ranges of u and v: add --domain U0 U1 V0 V1.")
    u0, u1, v0, v1 = options.domain
    return Surface.from_sympy(
        options.formula,
        ("u", "v"),
        ((u0, u1), (v0, v1)),
        PERIODIC[options.periodic or "none"],
        name=f"({', '.join(options.formula)})",
    )


def _grid(options: SimpleNamespace) -> Surface:
    if options.set:
        raise InputError("--set is for surfaces by name; a grid in a file has no parameters.")
    if is_raster_file(options.surface):
        return read_raster_file(options)
    points = read_array(options.surface)
    if points.ndim == 2 and points.shape[1] == 3 and options.x is None:
        raise InputError(f"'{options.surface}' has the shape {points.shape}: {NO_CLOUDS}.")
    if points.ndim == 2 and options.spacing is None and options.x is None:
        raise InputError(
            f"'{options.surface}' holds elevations {points.shape}, which need their distances: "
            "add --spacing DX DY, or --x and --y, the names of arrays of coordinates."
        )
    if has_place(options):
        return terrain_of_array(points, options)
    if points.ndim == 3 and options.spacing is not None:
        raise InputError(
            f"--spacing is for elevations, and '{options.surface}' has the shape {points.shape}."
        )
    return Surface.from_grid(
        points,
        spacing=options.spacing,
        periodic=PERIODIC[options.periodic or "none"],
        nodata=options.nodata,
        name=array_file(options.surface).name,
    )


def _with_tolerance(
    surface_: Surface, options: SimpleNamespace
) -> tuple[Surface | Spline, tuple[int, int] | None]:
    """Return the surface, and the cells that --cells or --tolerance choose; of data the spline."""
    if options.tolerance is None:
        return surface_, options.cells
    if options.cells is not None:
        raise InputError("--tolerance and --cells do not go together; give one of them.")
    spline = fit(surface_, tolerance=options.tolerance, progress=not options.quiet)
    return (spline, None) if surface_.grid is not None else (surface_, spline.cells)


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
