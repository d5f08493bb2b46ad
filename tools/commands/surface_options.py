"""The options that select a surface, and how it is read and approximated."""

import click

from ...runtime.base.limits import MOST
from .completion import settings, surfaces_and_files
from .options import Option, number, setting, whole

GROUP, FILES, FACES = "the surface", "reading CAD files", "faces of CAD parts"


def surface_argument() -> click.Argument:
    """Return the argument SURFACE, which --formula may replace."""
    return click.Argument(
        ["surface"], required=False, callback=_checked_source, shell_complete=surfaces_and_files
    )


def _checked_source(ctx: click.Context, _: click.Parameter, surface: str | None) -> str | None:
    """Return SURFACE; UsageError unless exactly one of SURFACE and --formula is given."""
    formula = ctx.params.get("formula")  # options are processed before arguments
    if surface is None and formula is None:
        raise click.UsageError("missing argument 'SURFACE', or --formula X Y Z", ctx)
    if surface is not None and formula is not None:
        raise click.UsageError("give SURFACE or --formula, not both", ctx)
    return surface


def surface_options() -> list[Option]:
    """Return the options of all commands that take a surface."""
    return [*made_options(), *_limits(), *_of_faces()]


def made_options(several: bool = False) -> list[Option]:
    """Return the options that define a surface, or several surfaces."""
    place = "A further surface; may be repeated" if several else "In place of SURFACE"
    formula = (
        f'{place}: its coordinates, three texts such as "cos(u)" in u and v. They are read as '
        "mathematics, and never run."
    )
    domain = 'The ranges of u and v for --formula; numbers, or texts such as "2*pi".'
    periodic = (
        "In which directions a grid of points or a formula is periodic: none (default), u, v or "
        "uv. Do not repeat the first row of a grid at the end."
    )
    nodata = "The number that stands for missing data in a grid, such as -9999; NaN always does."
    spacing = "The grid spacing of elevations; DY < 0 if rows run from north to south."
    cells = "The cells of the spline along u and v (default: 64 64 or more, or those of the grid)."
    on = (
        "Where samples lie: on the surface itself (default) or on the spline that approximates it. "
        "A grid in a file has only the spline."
    )
    tolerance = "Instead of --cells: the largest distance of the spline from the surface or data."
    parameter = "A parameter of a surface of the catalogue; may be repeated."
    named = {"multiple": True, "shell_complete": settings}
    return [
        Option("--set NAME=VALUE", parameter, setting, group=GROUP, **named),
        Option("--formula X Y Z", formula, group=GROUP, multiple=several),
        Option("--domain U0 U1 V0 V1", domain, group=GROUP),
        Option("--spacing DX DY", spacing, number, group=GROUP),
        Option("--periodic AXES", periodic, click.Choice(("none", "u", "v", "uv")), group=GROUP),
        Option("--nodata NUMBER", nodata, number, group=GROUP),
        Option("--cells M N", cells, whole(MOST), group=GROUP),
        Option("--on WHERE", on, click.Choice(("surface", "spline")), group=GROUP),
        Option("--tolerance LENGTH", tolerance, number, group=GROUP),
        *_terrain_options(),
        _unit(),
    ]


def _terrain_options() -> list[Option]:
    band = "The band of a GeoTIFF (default: 1)."
    coordinates = (
        "The array of the same .npz file with the {} of elevations: one for each {}, or for each "
        "elevation. Those named longitude and latitude are projected."
    )
    crs = (
        "The coordinate reference system of the points, in lengths, such as EPSG:32617 (default: "
        "that of the file or, if it has degrees, the zone of UTM)."
    )
    source_crs = "The reference system of a file that states none, such as EPSG:4326 for degrees."
    origin = "The coordinates subtracted from x and y; the output file records them."
    group = "coordinates of elevations"
    return [
        Option("--band N", band, whole(MOST), group=group),
        Option("--x NAME", coordinates.format("x", "column"), group=group),
        Option("--y NAME", coordinates.format("y", "row"), group=group),
        Option("--crs CRS", crs, group=group),
        Option("--source-crs CRS", source_crs, group=group),
        Option("--origin X Y", origin, number, group=group),
    ]


def cad_options() -> list[Option]:
    """Return the options of commands that read STEP, IGES and BREP files."""
    return [_unit(), *_limits(), *_of_faces()]


def _of_faces() -> list[Option]:
    name = 'Only faces of a name, or of a pattern such as "slot*".'
    indices = "Only faces with these indices, which `gaussmap faces` lists."
    return [
        Option("--kind KIND", "Only faces of a kind; may be repeated.", group=FACES, multiple=True),
        Option("--name NAME", name, group=FACES),
        Option("--faces INDEX ...", indices, group=FACES),
    ]


def _unit() -> Option:
    text = "The unit of lengths: mm, cm, m, in, ft ... (default: that of the file)."
    return Option("--unit UNIT", text, group=FILES)


def _limits() -> list[Option]:
    seconds = "The time limit for reading, in seconds (default: 120)."
    memory = "The memory limit for reading, in GiB (default: 4)."
    return [
        Option("--time-limit SECONDS", seconds, number, group=FILES),
        Option("--memory-limit GIB", memory, number, group=FILES),
    ]
