"""What the command line understands: commands and their options, shared ones declared once.

Nothing here needs NumPy or Numba, so that help and completion are quick. The work of a command is
done by `run` in the module of its name, see `options.Command`.
"""

from __future__ import annotations

from typing import Any

import click

from ... import __version__
from ..fields import ARRAY_NAMES
from ..limits import MOST, MOST_FREQUENCY, MOST_STEPS
from .options import Command, Density, Number, Option, Program, Setting, SurfaceName, Whole

__all__ = ["PROGRAM", "parser"]

PROGRAM = "gaussmap"
SETTINGS = {"help_option_names": ["-h", "--help"]}

EXAMPLES = """\
\b
examples:
  gaussmap sample torus --count 10000 -o torus.ply
  gaussmap sample torus --set major=1.0 --set minor=0.2 --frequency 32 -o torus.npz
  gaussmap sample heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap mesh torus --count 5000 -o torus.obj
  gaussmap plot torus -o torus.png
  gaussmap surfaces torus
  gaussmap formulas --latex
  gaussmap formulas --html formulas.html

`gaussmap COMMAND --help` explains a command.
"""

SAMPLE_EXAMPLES = """\
SURFACE is the name of a surface of the catalogue (see `gaussmap surfaces`), a .npy file, or an
.npz file, as FILE.npz:NAME if it holds several arrays. The array is a grid of points (m, n, 3), or
of elevations (m, n) with rows along y and columns along x, which need --spacing.

\b
examples:
  gaussmap sample torus --count 10000 -o torus.ply
  gaussmap sample torus --set minor=0.2 --frequency 32 -o torus.npz
  gaussmap sample torus --coverage 0.05 --density uniform -o torus.ply
  gaussmap sample torus --fields points,normals --float32 -o torus.ply
  gaussmap sample heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap sample scan.npz:points --periodic u --normals directions.npy -o scan.csv
"""

MESH_EXAMPLES = """\
`gaussmap sample --help` explains SURFACE.

\b
examples:
  gaussmap mesh torus --count 5000 -o torus.obj
  gaussmap mesh heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap mesh torus --normals cap.npy --deviation 20 -o part.stl
"""

PLOT_EXAMPLES = """\
`gaussmap sample --help` explains SURFACE.

\b
examples:
  gaussmap plot torus -o torus.png
  gaussmap plot wavy_graph --set frequency=4 --count 4000 -o waves.pdf
  gaussmap plot heights.npy --spacing 30 30 --cells 80 80 -o terrain.png
"""

FILE = click.Path(readable=False)  # for completion; files are checked where they are used


def parser() -> click.Group:
    """Return the program with all of its commands."""
    program = Program(
        PROGRAM,
        help="Sample surfaces by the normals of their points, so that the density of the samples "
        "follows the curvature.",
        epilog=EXAMPLES,
        context_settings=SETTINGS,
    )
    click.version_option(__version__, message=f"{PROGRAM} %(version)s")(program)
    for command in (_sample(), _mesh(), _plot(), _surfaces(), _formulas()):
        program.add_command(command)
    return program


def _command(name: str, parameters: list[click.Parameter], **texts: Any) -> Command:  # noqa: ANN401
    return Command(name, params=parameters, context_settings=SETTINGS, **texts)


def _sample() -> Command:
    group = "contents of the file"
    contents: list[click.Parameter] = [
        Option(
            ["--fields"],
            group=group,
            metavar="NAME,NAME",
            help=f"Write these arrays only (default: all). They are {', '.join(ARRAY_NAMES)}.",
        ),
        Option(
            ["--progressive"],
            group=group,
            is_flag=True,
            help="Order the samples such that every prefix of them is well distributed.",
        ),
        Option(
            ["--float32"],
            group=group,
            is_flag=True,
            help="Write single precision: 7 digits instead of 16.",
        ),
    ]
    return _command(
        "sample",
        [*_sampling(default_count=10_000), _output(".npz, .ply, .csv, .vtp or .xyz"), *contents],
        short_help="Sample a surface and write the samples to a file.",
        help="Sample a surface and write the samples to a file: points with normals, parameters "
        "and curvatures. Samples are the points that have prescribed normals, and samples that "
        "fill the gaps between these, where the surface is flat or developable.",
        epilog=SAMPLE_EXAMPLES,
    )


def _mesh() -> Command:
    deviation = Option(
        ["--deviation"],
        type=Number(),
        metavar="DEGREES",
        help="Leave out triangles whose normal deviates by more from a normal at their corners; "
        "for samples of a part of the surface.",
    )
    return _command(
        "mesh",
        [
            *_sampling(default_count=10_000),
            _output(".ply, .obj, .stl, .vtk, .vtu or .vtp"),
            deviation,
        ],
        short_help="Sample a surface and write a triangle mesh of it.",
        help="Sample a surface and write a triangle mesh of it. The vertices are the samples, and "
        "points on open borders and at poles.",
        epilog=MESH_EXAMPLES,
    )


def _plot() -> Command:
    return _command(
        "plot",
        [*_sampling(default_count=2_000), _output(".png, .pdf or .svg")],
        short_help="Draw a surface, its samples and their normals.",
        help="Draw a surface with its samples, coloured by Gaussian curvature, and the unit sphere "
        "with their normals. Needs Matplotlib: pip install 'gaussmap[plot]'.",
        epilog=PLOT_EXAMPLES,
    )


def _surfaces() -> Command:
    name = click.Argument(["name"], required=False, type=SurfaceName(files=False))
    return _command(
        "surfaces",
        [name],
        short_help="List the surfaces of the catalogue, or explain one.",
        help="List the surfaces of the catalogue; with NAME, its parameters.",
    )


def _formulas() -> Command:
    options = [
        click.Argument(["name"], required=False),
        Option(
            ["--latex"], exclusive=True, is_flag=True, help="Show LaTeX (of all without a NAME)."
        ),
        Option(
            ["--html"],
            exclusive=True,
            type=FILE,
            metavar="FILE.html",
            help="Write all formulas, and the surfaces, to one page for browsers. Needs "
            "pip install 'gaussmap[html]'.",
        ),
    ]
    return _command(
        "formulas",
        options,
        short_help="List the formulas that the program computes with, or show one.",
        help="List the formulas that the program computes with; with NAME, show it.",
    )


def _output(suffixes: str) -> Option:
    return Option(
        ["-o", "--output"],
        required=True,
        type=FILE,
        metavar="OUT",
        help=f"The file to write: {suffixes}",
    )


def _quiet() -> Option:
    return Option(
        ["--quiet"],
        group="the run",
        is_flag=True,
        help="Print nothing but warnings and errors: no summary, no progress.",
    )


def _sampling(default_count: int) -> list[click.Parameter]:
    """Return the arguments that `sample`, `mesh` and `plot` share."""
    options = [*_amount(default_count), *_distribution(), *_surface_options(), *_run()]
    return [click.Argument(["surface"], type=SurfaceName(files=True)), *options]


def _amount(default_count: int) -> list[Option]:
    group = "how many samples (one of these; --coverage alone or with another one)"

    def one_of(declaration: str, kind: click.ParamType, metavar: str, text: str) -> Option:
        return Option(
            [declaration], group=group, exclusive=True, type=kind, metavar=metavar, help=text
        )

    return [
        one_of("--count", Whole(MOST), "N", f"N samples (default: {default_count})."),
        one_of(
            "--angle",
            Number(),
            "DEGREES",
            "As many samples as it takes for the normal of every point to lie within this angle of "
            "the normal of a sample.",
        ),
        Option(
            ["--coverage"],
            group=group,
            type=Number(),
            metavar="LENGTH",
            help="As many samples as it takes for every point to lie within this distance of a "
            "sample.",
        ),
        one_of(
            "--frequency",
            Whole(MOST_FREQUENCY),
            "NU",
            "Normals: the 10 NU^2 + 2 vertices of an icosphere, an icosahedron whose edges are "
            "divided into NU.",
        ),
        one_of(
            "--healpix",
            Whole(MOST_FREQUENCY),
            "NSIDE",
            "Normals: the 12 NSIDE^2 centres of the HEALPix pixels, NSIDE a power of 2. Needs pip "
            "install 'gaussmap[spheres]'.",
        ),
        one_of("--random", Whole(MOST), "COUNT", "Normals: COUNT random ones, uniform."),
        Option(
            ["--seed"],
            group=group,
            type=Whole(MOST, least=0),
            metavar="N",
            help="The seed of --random (default: 0).",
        ),
        one_of("--normals", FILE, "FILE.npy", "Normals: an array (S, 3), of any lengths."),
    ]


def _distribution() -> list[Option]:
    group = "how dense"
    return [
        Option(
            ["--density"],
            group=group,
            type=Density(),
            default="balanced",
            metavar="HOW",
            help="gauss: proportional to |K|, prescribed normals only. balanced (default): that, "
            "with samples that fill the gaps. uniform: the same everywhere. A number A: "
            "proportional to |K|^A.",
        ),
        Option(
            ["--relax"],
            group=group,
            type=Whole(MOST_STEPS, least=0),
            default=0,
            metavar="STEPS",
            help="Distribute the samples that fill gaps more evenly, in 2 or 3 steps, at more cost "
            "(default: 0).",
        ),
    ]


def _surface_options() -> list[Option]:
    group = "the surface"
    return [
        Option(
            ["--set"],
            group=group,
            multiple=True,
            type=Setting(),
            metavar="NAME=VALUE",
            help="A parameter of a surface of the catalogue; may be repeated.",
        ),
        Option(
            ["--spacing"],
            group=group,
            nargs=2,
            type=Number(),
            metavar="DX DY",
            help="The grid spacing of elevations; DY < 0 if rows run from north to south.",
        ),
        Option(
            ["--periodic"],
            group=group,
            type=click.Choice(("none", "u", "v", "uv")),
            metavar="AXES",
            help="In which directions a grid of points is periodic: none (default), u, v or uv. "
            "Do not repeat the first row at the end.",
        ),
        Option(
            ["--cells"],
            group=group,
            nargs=2,
            type=Whole(MOST),
            metavar="M N",
            help="The cells of the spline along u and v (default: 64 64, or those of the grid).",
        ),
    ]


def _run() -> list[Option]:
    threads = Option(
        ["--threads"],
        group="the run",
        type=Whole(MOST),
        metavar="T",
        help="How many threads to use (default: one for each core).",
    )
    return [threads, _quiet()]
