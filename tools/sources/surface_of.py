"""`surface_of`: the surface or the CAD part that a text names."""

from pathlib import Path

from ...runtime.base.advice import NO_CLOUDS, NO_MESHES, is_mesh_file
from ...runtime.base.checks import known_name
from ...runtime.base.errors import FileError, InputError
from ...runtime.fitting.fit import fit
from ...runtime.spline.spline import Spline
from ...runtime.surface.surface import Surface
from ...runtime.surface.surfaces import CATALOGUE, names, surface
from ..cad.inspection import is_part_file
from ..cad.part import Part
from ..files.numpy_files import array_file, is_array_file, read_array
from .elevations import OF_TERRAIN, has_place, is_raster_file, read_raster_file, terrain_of_array
from .named import Named
from .parts import LIMITS, OF_FACES, read_part_file

NOT_OF_FORMULAS = ("set", "spacing", "nodata")
NOT_OF_PARTS = ("set", "domain", "spacing", "periodic", "nodata", "cells", "tolerance", *OF_TERRAIN)
PERIODIC = {"none": (False, False), "u": (True, False), "v": (False, True), "uv": (True, True)}


def surface_of(named: Named) -> Surface | Part:
    """Return the surface or the CAD part that `named` describes.

    Raises InputError for options that do not apply, and the errors of the functions for each kind.
    """
    if is_part_file(named.surface):
        named.refuse(NOT_OF_PARTS, "is for surfaces, and {} is a CAD part.")
        return read_part_file(named)
    named.refuse(OF_FACES, "is for CAD parts, and {} is none.")
    named.refuse(LIMITS, "is for CAD files, and {} is none.")
    source = named.surface
    if source is not None and (is_array_file(source) or is_raster_file(source)):
        return _grid(named, source)
    if source is not None:
        _refuse_file(source)
    named.refuse(OF_TERRAIN, "is for elevations, and {} is none.")
    return _of_formula(named) if source is None else _of_catalogue(named, source)


def _of_catalogue(named: Named, source: str) -> Surface:
    name = known_name(source, names(), "surface", "gaussmap surfaces")
    named.refuse(("spacing",), "is for elevations in a file, and {} is a surface by name.")
    named.refuse(("periodic",), "is for grids in a file; {} knows where it closes.")
    named.refuse(("nodata",), "is for grids in a file; {} has no missing points.")
    parameters = dict(named.set)
    if len(parameters) < len(named.set):
        raise InputError("--set gives the same parameter twice; give each once.")
    for parameter in parameters:
        known_name(parameter, tuple(CATALOGUE[name]["parameters"]), f"{name} parameter")
    return surface(name, **parameters)


def _refuse_file(source: str) -> None:
    """Raise an error if SURFACE names a file of another kind, or a missing file."""
    if is_mesh_file(source):
        raise InputError(f"'{source}' is a mesh; {NO_MESHES}.")
    if Path(source).is_file():
        raise InputError(
            f"'{source}' is neither a .npy, .npz, .tif nor .asc file, nor a CAD part; write points "
            "(m, n, 3) or elevations (m, n) to a .npy file."
        )
    if Path(source).suffix:
        raise FileError(f"'{source}' does not exist; look at its name and folder.")


def _of_formula(named: Named) -> Surface:
    named.refuse(NOT_OF_FORMULAS, "does not go together with --formula; leave it out.")
    if named.formula is None or named.domain is None:
        raise InputError("--formula needs the ranges of u and v: add --domain U0 U1 V0 V1.")
    u0, u1, v0, v1 = named.domain
    return Surface.from_sympy(
        named.formula,
        ("u", "v"),
        ((u0, u1), (v0, v1)),
        PERIODIC[named.periodic or "none"],
        name=f"({', '.join(named.formula)})",
    )


def _grid(named: Named, source: str) -> Surface:
    named.refuse(("set",), "is for surfaces by name; a grid in a file has no parameters.")
    if is_raster_file(source):
        return read_raster_file(named, source)
    points = read_array(source)
    if points.ndim == 2 and points.shape[1] == 3 and named.x is None:
        raise InputError(f"'{source}' has the shape {points.shape}: {NO_CLOUDS}.")
    if points.ndim == 2 and named.spacing is None and named.x is None:
        raise InputError(
            f"'{source}' holds elevations {points.shape}, which need their distances: "
            "add --spacing DX DY, or --x and --y, the names of arrays of coordinates."
        )
    if has_place(named):
        return terrain_of_array(points, named, source)
    if points.ndim == 3:
        named.refuse(("spacing",), f"is for elevations, and {{}} has the shape {points.shape}.")
    return Surface.from_grid(
        points,
        spacing=named.spacing,
        periodic=PERIODIC[named.periodic or "none"],
        nodata=named.nodata,
        name=array_file(source).name,
    )


def with_tolerance(
    surface_: Surface | Spline, named: Named
) -> tuple[Surface | Spline, tuple[int, int] | None]:
    """Return the surface, and the cells from --cells or --tolerance.

    With --tolerance, a grid of points is replaced by its spline, and the cells are None.
    """
    if named.tolerance is None or isinstance(surface_, Spline):
        return surface_, named.cells
    spline = fit(surface_, tolerance=named.tolerance, progress=not named.quiet)
    return (spline, None) if surface_.grid is not None else (surface_, spline.cells)
