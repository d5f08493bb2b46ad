"""The command line: commands and their options; shared options are declared once.

Nothing here needs NumPy or Numba, so that help and completion are quick. Each command calls the
function `run` of the module that has the command's name, see `options.Command`.
"""

import re
from typing import Any

import click

from ... import __version__
from ...runtime.base.limits import MOST, MOST_FREQUENCY
from ...runtime.samples.fields import ARRAY_NAMES_ON_SURFACE, EDGE_NAMES, PART_NAMES
from .completion import PROGRAM, SHELLS, densities, formula_names, surface_names, surfaces_and_files
from .options import Command, Option, Program, density, number, whole
from .surface_options import cad_options, made_options, surface_argument, surface_options

SETTINGS = {"help_option_names": ["-h", "--help"]}

EXAMPLES = """\
\b
three commands to try:
  gaussmap surfaces                                 the surfaces that have names
  gaussmap sample torus --count 1000 -o torus.csv   1,000 points with normals and curvatures
  gaussmap plot torus -o torus.png                  a picture; pip install 'gaussmap[plot]' first

`gaussmap COMMAND --help` explains a command, with examples.
"""

SAMPLE_EXAMPLES = """\
SURFACE is the name of a surface of the catalogue (see `gaussmap surfaces`), a .npy file, or an
.npz file, as FILE.npz:NAME if it holds several arrays. The array is a grid of points (m, n, 3), or
of elevations (m, n) with rows along y and columns along x, which need --spacing.

A GeoTIFF, .tif or .tiff, or an ASCII grid, .asc, holds elevations with their coordinates, read
with pip install 'gaussmap[gis]'. Points are in world coordinates.

In place of SURFACE, --formula gives x, y and z in terms of u and v.

A STEP, IGES or BREP file is a CAD part, of which all faces are sampled, read with pip install
'gaussmap[cad]'; or an .npz file of a part that gaussmap saved.

\b
examples:
  gaussmap sample torus --count 10000 -o torus.ply
  gaussmap sample torus --set minor=0.2 --frequency 32 -o torus.npz
  gaussmap sample torus --coverage 0.05 --density uniform -o torus.ply
  gaussmap sample torus --fields points,normals --float32 -o torus.ply
  gaussmap sample heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap sample dem.tif --count 20000 -o terrain.laz
  gaussmap sample dem.npz:heights --x longitude --y latitude -o terrain.ply
  gaussmap sample scan.npz:points --periodic u --normals directions.npy -o scan.csv
  gaussmap sample part.step --count 50000 --edges -o part.ply
  gaussmap sample --formula "u" "v" "u**2-v**2" --domain -1 1 -1 1 -o saddle.ply
"""

SURFACE = """\
SURFACE is a name (see `gaussmap surfaces`), a grid of points or elevations in a .npy or .npz file,
a GeoTIFF, a STEP, IGES or BREP file, or a part that gaussmap saved.
"""

SAMPLE_BRIEF = f"""\
{SURFACE}
\b
examples:
  gaussmap sample torus --count 10000 -o torus.ply
  gaussmap sample heights.npy --spacing 30 30 -o terrain.ply
  gaussmap sample part.step --count 50000 --edges -o part.ply
  gaussmap sample --formula "u" "v" "u**2-v**2" --domain -1 1 -1 1 -o saddle.ply
  gaussmap sample torus --quiet -o - --format csv | head
"""

MESH_EXAMPLES = """\
`gaussmap sample --help-all` explains SURFACE.

\b
examples:
  gaussmap mesh torus --count 5000 -o torus.obj
  gaussmap mesh torus --offset 0.1 -o shell.stl
  gaussmap mesh heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap mesh torus --normals cap.npy --deviation 20 -o cap.stl
  gaussmap mesh part.step --count 8000 -o part.stl
"""

PLOT_EXAMPLES = """\
`gaussmap sample --help-all` explains SURFACE.

\b
examples:
  gaussmap plot torus -o torus.png
  gaussmap plot wavy_graph --set frequency=4 --count 4000 -o waves.pdf
  gaussmap plot heights.npy --spacing 30 30 --cells 80 80 -o terrain.png
"""

SUPPORT_EXAMPLES = """\
`gaussmap sample --help-all` explains SURFACE.

\b
examples:
  gaussmap support torus --frequency 16 -o farthest.csv
  gaussmap support part.step -o extremes.csv
  gaussmap support part.step --normals directions.npy -o farthest.npz
"""

COMPLETION_EXAMPLES = """\
\b
to have it in every shell:
  echo 'eval "$(gaussmap completion bash)"' >> ~/.bashrc
  echo 'eval "$(gaussmap completion zsh)"' >> ~/.zshrc
  gaussmap completion fish > ~/.config/fish/completions/gaussmap.fish
"""

VIEW_EXAMPLES = """\
`gaussmap sample --help-all` explains SURFACE.

\b
examples:
  gaussmap view torus -o torus.html
  gaussmap view torus --frequency 16 -o torus.html
  gaussmap view heights.npy --spacing 30 30 -o terrain.html
"""

BATCH_EXAMPLES = """\
\b
examples:
  gaussmap batch parts/ -o dataset
  gaussmap batch parts/*.step torus --count 2048 --float32 -o dataset
  gaussmap batch tiles/*.tif --crs EPSG:32617 --count 2048 -o dataset
  gaussmap batch 'heights/*.npy' --spacing 30 30 --count 2048 -o dataset
  gaussmap batch --formula u v u*v --formula u v u**2-v**2 --domain -1 1 -1 1 -o dataset
  gaussmap batch --list parts.txt --workers 8 --time-limit 60 -o dataset
  gaussmap batch parts/ --scheduler tcp://10.0.0.1:8786 -o /shared/dataset
"""

SUFFIXES = ".npz, .ply, .csv, .vtp, .xyz, .parquet, .gpkg, .geojson, .las or .laz"
FOLDER = click.Path(file_okay=False, readable=False)
FILE = click.Path(readable=False)  # for completion; files are checked where they are used


def parser() -> click.Group:
    """Return the program with all of its commands."""
    text = "Sample surfaces by the normals of their points, so that density follows curvature."
    program = Program(PROGRAM, help=text, epilog=EXAMPLES, context_settings=SETTINGS)
    click.version_option(__version__, message=f"{PROGRAM} %(version)s")(program)
    sampling = _sample, _mesh, _plot, _view, _batch
    for make in (*sampling, _support, _surfaces, _faces, _formulas, _completion):
        program.add_command(make())
    return program


def _command(
    name: str, text: str, *parameters: click.Parameter, epilog: str = "", brief: str = ""
) -> Command:
    """Return a command; the list of commands shows its text up to the first colon or full stop."""
    short = f"{re.split('[.:]', text)[0]}."
    return Command(
        name, params=[*parameters], short_help=short, help=text, epilog=epilog, brief=brief,
        context_settings=SETTINGS,
    )  # fmt: skip


def _sample() -> Command:
    group = "contents of the file"
    default = f"all, with --edges {', '.join(EDGE_NAMES)}, too"
    prefixes = "Order the samples such that every prefix of them is well distributed."
    format_ = "The format with -o -; npy is an array (N, 6) of points and normals."
    edges = "Add samples on the sharp edges of a CAD part, with the normals of both faces."
    return _command(
        "sample",
        "Sample a surface and write the samples to a file: points with normals, parameters and "
        "curvatures. The samples are all points with prescribed normals, and others that fill the "
        "gaps between these, as where the surface is flat or developable.",
        *_sampling(default_count=10_000),
        _output(f"{SUFFIXES}; with --format -, which is standard output"),
        Option("--format FORMAT", format_, click.Choice(("csv", "xyz", "ply", "npy")), main=True),
        Option("--edges", edges, group="the surface"),
        *_contents(group, default),
        Option("--progressive", prefixes, group=group),
        Option("--path", "Write the samples in the order of a short path of a probe.", group=group),
        epilog=SAMPLE_EXAMPLES,
        brief=SAMPLE_BRIEF,
    )


def _mesh() -> Command:
    deviation = (
        "Leave out triangles whose normal is farther from those at their corners, as across gaps "
        "between samples."
    )
    prefer = (
        "shape (default): triangles with large angles; samples very close to others are left out. "
        "normals: triangles as close to the normals as the samples allow, thin where the surface "
        "is curved in one direction only."
    )
    return _command(
        "mesh",
        "Sample a surface and write a triangle mesh of it. The vertices are the samples, and "
        "points on open boundaries and at poles; the mesh of a CAD part has as many new vertices.",
        *_sampling(default_count=10_000),
        _output(".ply, .obj, .stl, .3mf, .vtu, .vtp or .glb"),
        Option("--deviation DEGREES", deviation, number, main=True),
        Option(
            "--prefer KIND", prefer, click.Choice(("shape", "normals")), default="shape", main=True
        ),
        epilog=MESH_EXAMPLES,
        brief=SURFACE + MESH_EXAMPLES.partition("\n")[2],
    )


def _plot() -> Command:
    return _command(
        "plot",
        "Draw a surface, its samples and their normals: samples coloured by Gaussian curvature, "
        "normals on the unit sphere. Needs Matplotlib: pip install 'gaussmap[plot]'.",
        *_sampling(default_count=2_000),
        _output(".png, .pdf or .svg"),
        Option("--face-numbers", "Write the number in the file on each face of a CAD part."),
        epilog=PLOT_EXAMPLES,
        brief=SURFACE + PLOT_EXAMPLES.partition("\n")[2],
    )


def _view() -> Command:
    return _command(
        "view",
        "Write a page with a surface and its normals, linked: for browsers, with the samples, and "
        "the unit sphere of their normals. Click a normal, and its preimages light up; click a "
        "point, and the Gaussian image of the region around it lights up. Needs Plotly: pip "
        "install 'gaussmap[view]'. A page shows at most 50000 samples, and works without a "
        "network.",
        *_sampling(default_count=5_000),
        _output(".html or .htm"),
        epilog=VIEW_EXAMPLES,
        brief=SURFACE + VIEW_EXAMPLES.partition("\n")[2],
    )


def _batch() -> Command:
    data, run = "the data set", "the run"
    workers = "How many processes sample (default: one for each core)."
    scheduler = (
        "The address of a scheduler of Dask, such as tcp://host:8786; its workers sample, and must "
        "see the folder by the same path. Needs pip install 'gaussmap[cluster]'."
    )
    parts = "A file with a part in each line, a name or a path; - for standard input."
    measure = "Measure coverage and normal deviation of each part, which may take ten times longer."
    again = "Sample again the parts that failed in an earlier run."
    seconds = "The time limit of a part, in seconds (default: 600)."
    memory = "The memory limit of a process, in GiB (default: its share of 0.9 of all memory)."
    return _command(
        "batch",
        "Sample many parts into a data set: by several processes, into a folder of Parquet files, "
        "points with normals and curvatures, and a manifest with the outcome for each part. A "
        "part that fails does not end the run. If the run is stopped, the same command resumes it. "
        "PARTS are surfaces and files as `gaussmap sample` takes them, "
        "patterns and folders; the options hold for all of them. The exit code is 3 if parts "
        "failed. Needs pip install 'gaussmap[batch]'.",
        click.Argument(["parts"], nargs=-1, required=False, shell_complete=surfaces_and_files),
        *_amount(2048),
        *_distribution(),
        *made_options(several=True),
        Option(
            "-o --output FOLDER", "The folder of the data set.", FOLDER, required=True, main=True
        ),
        Option("--list FILE", parts, FILE, main=True),
        *_contents(data, "those of real numbers"),
        Option("--measure", measure, group=data),
        Option("--overwrite", "First remove the data set in the folder, if any.", group=data),
        Option("--workers N", workers, whole(MOST), group=run, exclusive=False),
        Option("--scheduler ADDRESS", scheduler, group=run),
        Option("--time-limit SECONDS", seconds, number, group=run),
        Option("--memory-limit GIB", memory, number, group=run),
        Option("--retry-failed", again, group=run),
        Option("--json", "Print the summary as a JSON object.", group=run),
        _quiet(),
        epilog=BATCH_EXAMPLES,
        brief=BATCH_EXAMPLES,
    )


def _support() -> Command:
    return _command(
        "support",
        "Find the farthest points of a surface in given directions: also on edges and borders, at "
        "corners and tips. Without directions, they are those of the axes: the extremes of x, y "
        "and z. A line of the file has the point, the direction, and the support value n.x.",
        surface_argument(),
        *_normals("directions (one of these)", "Directions"),
        *surface_options(),
        _output(SUFFIXES),
        _quiet(),
        epilog=SUPPORT_EXAMPLES,
        brief=SURFACE + SUPPORT_EXAMPLES.partition("\n")[2],
    )


def _surfaces() -> Command:
    return _command(
        "surfaces",
        "List the surfaces of the catalogue, or describe one: with NAME, its parameters.",
        click.Argument(["name"], required=False, shell_complete=surface_names),
    )


def _faces() -> Command:
    return _command(
        "faces",
        "List the faces of a CAD part: a line for each, with its index, kind, area, number of "
        "loops, name, and why it failed if it cannot be used. PART is a STEP, IGES or BREP file, "
        "or an .npz file of a part that gaussmap saved.",
        click.Argument(["part"], type=FILE),
        Option("--json", "Print a JSON object, with axes and radii, instead of lines."),
        *cad_options(),
    )


def _formulas() -> Command:
    return _command(
        "formulas",
        "List the formulas that the program computes with, or show the formula NAME.",
        click.Argument(["name"], required=False, shell_complete=formula_names),
        Option("--latex", "Show LaTeX (of all without a NAME)."),
    )


def _completion() -> Command:
    return _command(
        "completion",
        "Let a shell complete commands, surfaces and files: print the script by which bash, zsh or "
        "fish completes these, options and formulas.",
        click.Argument(["shell"], type=click.Choice(SHELLS)),
        epilog=COMPLETION_EXAMPLES,
    )


def _output(suffixes: str) -> Option:
    return Option(
        "-o --output OUT", f"The file to write: {suffixes}.", FILE, required=True, main=True
    )


def _contents(group: str, default: str) -> list[Option]:
    """Return the options that select the contents of the output."""
    names = (
        f"Write these arrays only. They are {', '.join(ARRAY_NAMES_ON_SURFACE)}; of CAD parts "
        f"{' and '.join(PART_NAMES)}, too (default: {default})."
    )
    single = "Write single precision: 7 digits instead of 16."
    return [
        Option("--fields NAME,NAME", names, group=group),
        Option("--float32", single, group=group),
    ]


def _quiet() -> Option:
    text = "Print nothing but warnings and errors: no summary, no progress."
    return Option("--quiet", text, group="the run")


def _sampling(default_count: int) -> list[click.Parameter]:
    """Return the arguments that `sample`, `mesh`, `plot` and `view` share."""
    threads = "How many threads to use (default: one for each core)."
    distance = "Move the samples by DISTANCE along their normals; inwards, if it is negative."
    trimmed = "With --offset: without samples that become nearer to the surface than DISTANCE."
    moved = [
        Option("--offset DISTANCE", distance, number, group="an offset"),
        Option("--trimmed", trimmed, group="an offset"),
    ]
    run = [Option("--threads T", threads, whole(MOST), group="the run"), _quiet()]
    how = *_amount(default_count), *_distribution(), *surface_options()
    return [surface_argument(), *how, *moved, *run]


def _amount(default_count: int) -> list[Option]:
    angle = (
        "As many samples as it takes for the normal of every point to lie within this angle of the "
        "normal of a sample."
    )
    coverage = (
        "As many samples as it takes for every point to lie within this distance of a sample."
    )
    group = "how many samples (one of these; --coverage alone or with another one)"
    kinds: list[tuple[str, str, Any]] = [
        ("--count N", f"N samples (default: {default_count}).", whole(MOST)),
        ("--angle DEGREES", angle, number),
        ("--coverage LENGTH", coverage, number),
    ]
    beside, main = "--coverage LENGTH", "--count N"
    amounts = [Option(*x, group=group, exclusive=x[0] != beside, main=x[0] == main) for x in kinds]
    return amounts + _normals(group, "Normals")


def _normals(group: str, what: str) -> list[Option]:
    """Return the options for a set of normals or directions."""
    frequency = (
        f"{what}: the 10 NU^2 + 2 vertices of an icosphere, an icosahedron whose edges are divided "
        "into NU."
    )
    healpix = (
        f"{what}: the 12 NSIDE^2 centres of the HEALPix pixels, NSIDE a power of 2. Needs pip "
        "install 'gaussmap[spheres]'."
    )
    kinds: list[tuple[str, str, Any]] = [
        ("--frequency NU", frequency, whole(MOST_FREQUENCY)),
        ("--healpix NSIDE", healpix, whole(MOST_FREQUENCY)),
        ("--random COUNT", f"{what}: COUNT random ones, uniform.", whole(MOST)),
        ("--seed N", "The seed of --random (default: 0).", whole(MOST, least=0)),
        ("--normals FILE.npy", f"{what}: an array (S, 3), of any lengths.", FILE),
    ]
    beside, main = "--seed N", "--normals FILE.npy"
    return [Option(*x, group=group, exclusive=x[0] != beside, main=x[0] == main) for x in kinds]


def _distribution() -> list[Option]:
    group = "how dense"
    how = (
        "balanced (default): higher where a principal curvature is larger, by prescribed normals "
        "and samples that fill the gaps. gauss (default where normals alone are given): "
        "proportional to |K|, prescribed normals only. aligned: on a grid of lines u = const and v "
        "= const, spaced by how fast the normal turns. uniform: the same everywhere. A number A: "
        "proportional to |K|^A."
    )
    reach = (
        "Only where the normal is within ANGLE degrees of the direction X Y Z, from which a probe, "
        "a camera or a printer comes."
    )
    away = "Only points at least LENGTH away from edges and boundaries of faces."
    first = (
        "Only points of a CAD part or a closed surface that a ray against the direction of --reach "
        "(default: +z) meets first."
    )
    free = (
        "Only points of a CAD part or a closed surface from which the LENGTH along the normal is "
        "free: inf for the whole ray."
    )
    slope = "Only where the normal is between LEAST and MOST degrees from +z."
    aspect = (
        "Only slopes that face within ANGLE degrees (90 at most) of a DIRECTION, in degrees "
        "clockwise from north."
    )
    density_ = Option(
        "--density HOW", how, density, group=group, main=True, shell_complete=densities
    )
    return [
        density_,
        Option("--reach X Y Z ANGLE", reach, number, group=group),
        Option("--from-edges LENGTH", away, number, group=group),
        Option("--unobstructed", first, group=group),
        Option("--clearance LENGTH", free, number, group=group),
        Option("--slope LEAST MOST", slope, number, group=group),
        Option("--aspect DIRECTION ANGLE", aspect, number, group=group),
    ]
