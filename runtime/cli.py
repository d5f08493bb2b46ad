"""The command line: `gaussmap sample`, `mesh`, `plot`, `surfaces` and `formulas`.

Results go to standard output; the progress bar, warnings and errors go to standard error. Every
error is one line and the exit code 2; Ctrl-C gives 130, and a reader that went away 141.
"""

from __future__ import annotations

import _thread
import argparse
import os
import re
import shutil
import sys
import textwrap
import threading
import warnings
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, NoReturn, TextIO

import numpy as np
from numpy.typing import NDArray

from .checks import known_name
from .density.request import MOST_STEPS
from .errors import FileError, GaussmapError, GaussmapWarning, InputError
from .extras import check_extra
from .fields import ARRAY_NAMES, checked_fields
from .formulas import formulas
from .io import atomic_path, check_fields, check_target
from .samples import Samples
from .sampling import sample
from .sphere import healpix, icosphere, random_normals
from .surface import Surface
from .surfaces import CATALOGUE, describe, names, surface

if TYPE_CHECKING:
    from .meshes.mesh import Mesh

__all__ = ["main"]

PROGRAM = "gaussmap"
FAILED, INTERRUPTED, READER_GONE = 2, 130, 141

# A number of normals or samples beyond these fits into no computer that people sit at.
MOST_SAMPLES = 10**9
MOST_FREQUENCY = 10**4
LARGEST_SEED = 10**9

PERIODIC = {"none": (False, False), "u": (True, False), "v": (False, True), "uv": (True, True)}

EXAMPLES = """\
examples:
  gaussmap sample torus --count 10000 -o torus.ply
  gaussmap sample torus --set major=1.0 --set minor=0.2 --frequency 32 -o torus.npz
  gaussmap sample heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap mesh torus --count 5000 -o torus.obj
  gaussmap plot torus -o torus.png
  gaussmap surfaces torus
  gaussmap formulas --latex
  gaussmap formulas --html formulas.html
"""

SAMPLE_EXAMPLES = """\
SURFACE is a name of the catalogue (see `gaussmap surfaces`), a .npy file, or an .npz file, as
FILE.npz:NAME if it holds several arrays. The array is a grid of points (m, n, 3), or of elevations
(m, n) with rows along y, columns along x and --spacing.

examples:
  gaussmap sample torus --count 10000 -o torus.ply
  gaussmap sample torus --set minor=0.2 --frequency 32 -o torus.npz
  gaussmap sample torus --coverage 0.05 --density uniform -o torus.ply
  gaussmap sample torus --fields points,normals --float32 -o torus.ply
  gaussmap sample heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap sample scan.npz:points --periodic u --normals directions.npy -o scan.csv
"""

MESH_EXAMPLES = """\
SURFACE and the options that choose normals and cells are those of `gaussmap sample`.

examples:
  gaussmap mesh torus --count 5000 -o torus.obj
  gaussmap mesh heights.npy --spacing 30 30 --count 50000 -o terrain.ply
  gaussmap mesh torus --normals cap.npy --deviation 20 -o part.stl
"""

PLOT_EXAMPLES = """\
SURFACE and the options that choose samples and cells are those of `gaussmap sample`.

examples:
  gaussmap plot torus -o torus.png
  gaussmap plot wavy_graph --set frequency=4 --count 4000 -o waves.pdf
  gaussmap plot heights.npy --spacing 30 30 --cells 80 80 -o terrain.png
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line with `arguments`, by default those of the process; return the exit code.

    No exception of gaussmap leaves this function, and no SystemExit.
    """
    try:
        with warnings.catch_warnings(), _interruptible():
            warnings.simplefilter("always", GaussmapWarning)
            warnings.showwarning = _show_warning
            try:
                options = _parser().parse_args(arguments)
                options.run(options)
            finally:
                _flush()
    except _UsageError as error:
        return _fail(str(error))
    except BrokenPipeError:
        _give_up_output()
        return READER_GONE
    except GaussmapError as error:
        return _fail(str(error))
    except MemoryError:
        return _fail("there is not enough memory for this; ask for fewer samples or cells.")
    except OSError as error:  # all other files are handled where they are read or written
        _give_up_output()
        return _fail(f"standard output cannot be written: {error.strerror or error}.")
    except KeyboardInterrupt:
        _complain("interrupted")
        return INTERRUPTED
    except SystemExit as done:  # of --help and --version
        return int(done.code or 0)
    return 0


# ── The commands ─────────────────────────────────────────────────────────────────────────────────


def _run_sample(options: argparse.Namespace) -> None:
    check_target(options.output)
    fields = checked_fields(options.fields)
    check_fields(options.output, fields)
    if options.progressive and not {"points", "normals"} <= {*fields}:
        raise InputError("--progressive needs points and normals among the --fields.")
    dtype = np.float32 if options.float32 else np.float64
    samples = sample(**_arguments(options), fields=fields, dtype=dtype)
    if options.progressive:
        samples = samples.progressive()
    samples.write(options.output)
    _summarize(samples, options)


def _run_mesh(options: argparse.Namespace) -> None:
    from .meshes.files import MESH_SUFFIXES

    check_target(options.output, MESH_SUFFIXES)
    fields = ("points", "normals", "uv")
    mesh = sample(**_arguments(options), fields=fields).mesh(angle=options.deviation)
    mesh.write(options.output)
    _summarize(mesh, options)


def _run_plot(options: argparse.Namespace) -> None:
    from .pictures import plot

    plot.check_target(options.output)
    _summarize(plot.plot(path=options.output, **_arguments(options)), options)


def _arguments(options: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments of `sampling.sample` that were given."""
    _spare_inputs(options)
    surface_, normals = _surface(options), _normals(options)
    amounts = [x for x in (options.count, options.angle, options.coverage) if x is not None]
    return {
        "surface": surface_,
        "normals": normals,
        "count": options.default_count if normals is None and not amounts else options.count,
        "angle": options.angle,
        "coverage": options.coverage,
        "density": options.density,
        "relax": options.relax,
        "cells": options.cells,
        "threads": options.threads,
        "progress": not options.quiet,
    }


def _run_surfaces(options: argparse.Namespace) -> None:
    if options.name is not None:
        _say(describe(known_name(options.name, names(), "surface", "gaussmap surfaces")))
        return
    _table((name, CATALOGUE[name]["sentence"]) for name in names())


def _run_formulas(options: argparse.Namespace) -> None:
    if options.html is not None:
        _write_formulas(options)
        return
    if options.name is not None:
        formula = formulas[options.name]
        if options.latex:
            _say(formula.latex())
        else:
            _say(
                f"{formula.name}: {formula.sentence}\nSource: {formula.source}.\n\n{formula.text()}"
            )
    elif options.latex:
        _say("\n\n".join(f"% {name}\n{formula.latex()}" for name, formula in formulas.items()))
    else:
        _table((name, f"{f.sentence} [{f.source}]") for name, f in formulas.items())


def _write_formulas(options: argparse.Namespace) -> None:
    if options.name is not None:
        raise InputError("--html writes all formulas to one page; leave out the name.")
    check_target(options.html, (".html",))
    check_extra("math_core", "html", "the page")
    from ..symbolic import formulas, html

    page = html.page()
    with atomic_path(options.html) as temporary:
        temporary.write_text(page, encoding="utf-8", newline="\n")
    _say(f"{options.html}: {len(formulas)} formulas and {len(names())} surfaces")


def _summarize(result: Samples | Mesh, options: argparse.Namespace) -> None:
    if not options.quiet:
        _say(f"{options.output}: {result.summary()}")


def _table(rows: Iterable[tuple[str, str]]) -> None:
    """Print one line a row, for people wrapped under its own column."""
    pairs = list(rows)
    width = max(len(name) for name, _ in pairs) + 2
    for name, sentence in pairs:
        line = f"{name:{width}}{sentence}"
        if sys.stdout is not None and sys.stdout.isatty():
            columns = max(shutil.get_terminal_size().columns, width + 20)
            line = textwrap.fill(line, columns, subsequent_indent=" " * width)
        _say(line)


# ── What a user names: surfaces, normals, files ──────────────────────────────────────────────────


def _surface(options: argparse.Namespace) -> Surface:
    if _is_array_file(options.surface):
        return _grid(options)
    if Path(options.surface).is_file():
        raise InputError(f"'{options.surface}' is neither a .npy nor a .npz file; save it as one.")
    name = known_name(options.surface, names(), "surface", "gaussmap surfaces")
    if options.spacing is not None:
        raise InputError(f"--spacing is for elevations in a file, and {name} is a surface by name.")
    if options.periodic is not None:
        raise InputError(f"--periodic is for grids in a file; {name} knows where it closes.")
    parameters = dict(options.set)
    if len(parameters) < len(options.set):
        raise InputError("--set gives the same parameter twice; give each once.")
    for parameter in parameters:
        known_name(parameter, tuple(CATALOGUE[name]["parameters"]), f"{name} parameter")
    return surface(name, **parameters)


def _grid(options: argparse.Namespace) -> Surface:
    if options.set:
        raise InputError("--set is for surfaces by name; a grid in a file has no parameters.")
    points = _read_array(options.surface)
    if points.ndim == 2 and options.spacing is None:
        raise InputError(
            f"'{options.surface}' holds elevations {points.shape}, which need their distances: "
            "add --spacing DX DY."
        )
    if points.ndim == 3 and options.spacing is not None:
        raise InputError(
            f"--spacing is for elevations, and '{options.surface}' has the shape {points.shape}."
        )
    return Surface.from_grid(
        points,
        spacing=options.spacing,
        periodic=PERIODIC[options.periodic or "none"],
        name=_array_file(options.surface).name,
    )


def _normals(options: argparse.Namespace) -> NDArray[np.float64] | None:
    if options.seed is not None and options.random is None:
        raise InputError("--seed is for --random COUNT, which is not there.")
    if options.frequency is not None:
        return icosphere(options.frequency)
    if options.healpix is not None:
        return healpix(options.healpix)
    if options.random is not None:
        return random_normals(options.random, seed=options.seed or 0)
    return None if options.normals is None else _read_array(options.normals)


def _spare_inputs(options: argparse.Namespace) -> None:
    """Refuse to write over a file that is read."""
    for source in (options.surface, options.normals):
        if source is not None and _is_array_file(source):
            # If one of the two is not there, that is said where it is opened.
            with suppress(OSError):
                if os.path.samefile(_array_file(source), options.output):
                    raise InputError(f"'{options.output}' is read; write to another file.")


def _is_array_file(source: str) -> bool:
    return _array_file(source).suffix.lower() in (".npy", ".npz")


def _array_file(source: str) -> Path:
    """Return the file in FILE.npy, FILE.npz or FILE.npz:NAME."""
    return Path(_parts(source)[0])


def _parts(source: str) -> tuple[str, str | None]:
    match = re.fullmatch(r"(.+\.npz):([^/\\]+)", source, re.IGNORECASE | re.DOTALL)
    return (match[1], match[2]) if match else (source, None)


def _read_array(source: str) -> NDArray[Any]:
    """Return the array in FILE.npy, FILE.npz or FILE.npz:NAME; never unpickle."""
    file_name, key = _parts(source)
    try:
        if not _is_array_file(file_name):
            raise InputError(f"'{file_name}' is neither a .npy nor a .npz file; save it as one.")
        with open(file_name, "rb") as file:
            return _unpacked(file, source, key)
    except (GaussmapError, MemoryError):
        raise
    except OSError as error:
        raise FileError(f"'{file_name}' cannot be read: {error.strerror or error}.") from error
    except Exception as error:  # NumPy and zipfile raise a dozen kinds on bad bytes
        raise FileError(
            f"'{file_name}' is damaged, or holds objects instead of numbers "
            f"({type(error).__name__}: {error}); write it again with numpy.save or numpy.savez."
        ) from error


def _unpacked(file: IO[bytes], source: str, key: str | None) -> NDArray[Any]:
    if Path(file.name).suffix.lower() == ".npy":
        return np.lib.format.read_array(file, allow_pickle=False)
    if not zipfile.is_zipfile(file):  # np.load would take it for a pickle
        raise FileError(f"'{file.name}' is damaged or no .npz file; write it again.")
    file.seek(0)
    with np.load(file, allow_pickle=False) as archive:
        keys = tuple(archive.files)
        if key is None and len(keys) != 1:
            raise InputError(
                f"'{source}' holds {len(keys)} arrays{': ' if keys else ''}{', '.join(keys)}; "
                f"name the one to read, as in {source}:{keys[0] if keys else 'NAME'}."
            )
        return archive[keys[0] if key is None else known_name(key, keys, f"array in '{file.name}'")]


# ── The parser ───────────────────────────────────────────────────────────────────────────────────


class _UsageError(Exception):
    """The arguments cannot be understood."""


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, and which does not guess at shortened options."""

    def _print_message(self, message: str, file: Any = None) -> None:  # noqa: ANN401
        """Print help; unlike argparse, let errors of standard output be known."""
        _print(message.rstrip("\n"), file or sys.stdout)

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401
        super().__init__(
            formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False, **settings
        )

    def error(self, message: str) -> NoReturn:
        raise _UsageError(f"{message} (see `{self.prog} --help`)")


def _parser() -> argparse.ArgumentParser:
    from .. import __version__

    parser = _Parser(
        prog=PROGRAM,
        description="Sample surfaces densely where they bend, by the normals of their points.",
        epilog=EXAMPLES + "\n`gaussmap COMMAND --help` explains a command.",
    )
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, title="commands")

    command = commands.add_parser(
        "sample",
        help="sample a surface and write the samples to a file",
        description="Write points of a surface, with their normals, to a file: those that have\n"
        "one of many normals, and others that leave no gaps where it hardly bends.",
        epilog=SAMPLE_EXAMPLES,
    )
    _add_sampling(command, default_count=10_000)
    _add_output(command, ".npz, .ply, .csv, .vtp or .xyz")
    _add_contents(command)
    command.set_defaults(run=_run_sample)

    command = commands.add_parser(
        "mesh",
        help="sample a surface and write a triangle mesh through the samples",
        description="Write a triangle mesh of a surface, whose vertices are samples, and points\n"
        "on open borders.",
        epilog=MESH_EXAMPLES,
    )
    _add_sampling(command, default_count=10_000)
    _add_output(command, ".ply, .obj, .stl, .vtk, .vtu or .vtp")
    command.add_argument(
        "--deviation",
        type=_number,
        metavar="DEGREES",
        help="leave out triangles that deviate by more from the normals at their corners, for "
        "normals of a part of the surface",
    )
    command.set_defaults(run=_run_mesh)

    command = commands.add_parser(
        "plot",
        help="draw a surface, its samples and their normals",
        description="Draw a surface with its samples, coloured by Gaussian curvature, and the\n"
        "unit sphere with their normals. Needs matplotlib: pip install 'gaussmap[plot]'.",
        epilog=PLOT_EXAMPLES,
    )
    _add_sampling(command, default_count=2_000)
    _add_output(command, ".png, .pdf or .svg")
    command.set_defaults(run=_run_plot)

    command = commands.add_parser(
        "surfaces",
        help="list the surfaces of the catalogue, or explain one",
        description="List the surfaces of the catalogue; with a NAME, its parameters.",
    )
    command.add_argument("name", nargs="?", metavar="NAME", help="a surface, such as torus")
    command.set_defaults(run=_run_surfaces)

    command = commands.add_parser(
        "formulas",
        help="list the formulas that the program computes with, or show one",
        description="List the formulas that the program computes with; with a NAME, show it.",
    )
    command.add_argument("name", nargs="?", metavar="NAME", help="the name of a formula")
    group = command.add_mutually_exclusive_group()
    group.add_argument("--latex", action="store_true", help="show LaTeX (of all without a NAME)")
    group.add_argument(
        "--html",
        metavar="FILE.html",
        help="write all, and the surfaces, to one page for browsers; needs pip install "
        "'gaussmap[html]'",
    )
    command.set_defaults(run=_run_formulas)
    return parser


def _add_sampling(parser: argparse.ArgumentParser, default_count: int) -> None:
    """Add the arguments that `sample`, `mesh` and `plot` share."""
    parser.set_defaults(default_count=default_count)
    parser.add_argument("surface", metavar="SURFACE", help="a name, or a .npy or .npz file")

    amount = parser.add_argument_group("how many samples (one of, and --coverage, --seed)")
    group = amount.add_mutually_exclusive_group()
    group.add_argument(
        "--count",
        type=_whole(MOST_SAMPLES),
        metavar="N",
        help=f"N samples (default: {default_count})",
    )
    group.add_argument(
        "--angle",
        type=_number,
        metavar="DEGREES",
        help="so many that the normal of any point is so near to that of a sample",
    )
    amount.add_argument(
        "--coverage",
        type=_number,
        metavar="LENGTH",
        help="so many that any point is so near to a sample; alone, or beside one of the others",
    )
    group.add_argument(
        "--frequency",
        type=_whole(MOST_FREQUENCY),
        metavar="NU",
        help="the 10 NU^2 + 2 vertices of an icosahedron refined NU times",
    )
    group.add_argument(
        "--healpix",
        type=_whole(MOST_FREQUENCY),
        metavar="NSIDE",
        help="the 12 NSIDE^2 centres of the pixels of HEALPix, NSIDE a power of 2; needs pip "
        "install 'gaussmap[spheres]'",
    )
    group.add_argument(
        "--random",
        type=_whole(MOST_SAMPLES),
        metavar="COUNT",
        help="COUNT random normals, uniform on the sphere",
    )
    amount.add_argument(
        "--seed",
        type=_whole(LARGEST_SEED, least=0),
        metavar="N",
        help="another choice of --random (default: 0)",
    )
    group.add_argument(
        "--normals", metavar="FILE.npy", help="an array (S, 3) of directions of any length"
    )

    group = parser.add_argument_group("where they are")
    group.add_argument(
        "--density",
        type=_density,
        default="balanced",
        metavar="HOW",
        help="gauss: as dense as |K|, from normals alone; balanced (default): that, and what "
        "leaves no gaps; uniform; or a number A for |K|^A",
    )
    group.add_argument(
        "--relax",
        type=_whole(MOST_STEPS, least=0),
        default=0,
        metavar="STEPS",
        help="place them better at more cost, in 2 or 3 steps (default: 0)",
    )

    group = parser.add_argument_group("the surface")
    group.add_argument(
        "--set",
        action="append",
        default=[],
        type=_setting,
        metavar="NAME=VALUE",
        help="a parameter of a surface by name; may be repeated",
    )
    group.add_argument(
        "--spacing",
        nargs=2,
        type=_number,
        metavar=("DX", "DY"),
        help="distances of elevations; DY < 0 if rows run from north to south",
    )
    group.add_argument(
        "--periodic",
        choices=tuple(PERIODIC),
        help="along which axes a grid of points closes (default: none); do not repeat the first "
        "row at its end",
    )
    group.add_argument(
        "--cells",
        nargs=2,
        type=_whole(MOST_SAMPLES),
        metavar=("M", "N"),
        help="cells of the spline along u and v (default: 64 64, or those of the grid)",
    )

    group = parser.add_argument_group("the run")
    group.add_argument(
        "--threads", type=_whole(MOST_SAMPLES), metavar="T", help="threads (default: all cores)"
    )
    group.add_argument("--quiet", action="store_true", help="no progress bar and no summary")


def _add_output(parser: argparse.ArgumentParser, suffixes: str) -> None:
    parser.add_argument(
        "-o", "--output", required=True, metavar="OUT", help=f"the file to write: {suffixes}"
    )


def _add_contents(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("what the file holds")
    group.add_argument(
        "--fields",
        type=lambda text: tuple(text.split(",")),
        metavar="NAME,NAME",
        help=f"only these (default: all), of {', '.join(ARRAY_NAMES)}",
    )
    group.add_argument(
        "--progressive",
        action="store_true",
        help="an order in which the first samples, however many, are a good sampling themselves",
    )
    group.add_argument(
        "--float32", action="store_true", help="numbers of half the size: 7 digits, not 16"
    )


def _whole(most: int, least: int = 1) -> Callable[[str], int]:
    def whole(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if not least <= number <= most:
            raise argparse.ArgumentTypeError(
                f"it must be a whole number from {least} to {most:,}, not {text!r}"
            )
        return number

    return whole


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"it must be a number, not {text!r}") from None


def _density(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text


def _setting(text: str) -> tuple[str, float]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"it must be NAME=VALUE, such as minor=0.2, not {text!r}")
    return name, _number(value)


# ── Standard output and standard error ───────────────────────────────────────────────────────────


def _say(text: str) -> None:
    """Print to standard output."""
    _print(text, sys.stdout)


def _complain(text: str) -> None:
    """Print one line to standard error; if nobody hears it, go on."""
    with suppress(OSError, ValueError):
        _print(f"{PROGRAM}: {' '.join(text.split())}", sys.stderr)


def _fail(message: str) -> int:
    _complain(f"error: {message}")
    return FAILED


def _show_warning(message: Warning | str, *_: object, **__: object) -> None:
    _complain(f"warning: {message}")


def _print(text: str, stream: TextIO | None) -> None:
    """Print a text, with `?` for what the stream's encoding lacks; Python has no closed streams."""
    if stream is not None:
        encoding = stream.encoding or "utf-8"
        print(text.encode(encoding, "replace").decode(encoding), file=stream)


def _flush() -> None:
    if sys.stdout is not None:
        sys.stdout.flush()


@contextmanager
def _interruptible() -> Iterator[None]:
    """Let Ctrl-C work during compilation too: a callback from LLVM would swallow it."""
    previous = sys.unraisablehook
    again: list[threading.Timer] = []

    def interrupt_again(unraisable: Any) -> None:  # noqa: ANN401
        if unraisable.exc_type is KeyboardInterrupt:
            again.append(threading.Timer(0.1, _thread.interrupt_main))
            again[-1].start()
        else:
            previous(unraisable)

    sys.unraisablehook = interrupt_again
    try:
        yield
    except Exception as error:
        if again:  # the compiler may have stumbled over it
            raise KeyboardInterrupt from error
        raise
    finally:
        sys.unraisablehook = previous
        for timer in again:
            timer.cancel()


def _give_up_output() -> None:
    """Let what is left in standard output go nowhere, or Python complains at its end."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
