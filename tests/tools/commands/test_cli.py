import errno
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from itertools import cycle
from pathlib import Path
from types import ModuleType
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
import rasterio
from gaussmap.tools.commands import sampled, support
from gaussmap.tools.commands.cli import main
from gaussmap.tools.commands.part_lists import listed

from ...refusals import refused

FEW = ["--count", "60", "--cells", "8", "8"]

posix = pytest.mark.skipif(os.name != "posix", reason="needs POSIX")

GAUSS = ["--density", "gauss"]
EIGHT = ["--cells", "8", "8"]


def python(
    *arguments: str, encoding: str = "utf-8", **how: Any
) -> subprocess.CompletedProcess[str]:
    pipes: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | how
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    return subprocess.run([sys.executable, *arguments], text=True, env=environment, **pipes)


def gaussmap(*arguments: str, **how: Any) -> subprocess.CompletedProcess[str]:
    return python("-m", "gaussmap", *arguments, **how)


def raised(error: BaseException, *_: object, **__: object) -> None:
    raise error


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[BaseException], None]:
    """Let the work of `gaussmap sample` raise an error."""

    return lambda error: monkeypatch.setattr(sampled, "sample_and_normals", partial(raised, error))


@pytest.fixture
def files(parts: ModuleType) -> None:
    """Good and bad input in the current folder."""
    heights = np.add.outer(np.arange(7.0) ** 2, np.arange(9.0) ** 2)
    sheet = np.stack([*np.meshgrid(np.arange(9.0), np.arange(7.0)), heights], axis=2)
    np.save("heights.npy", heights)
    np.save("points.npy", sheet)
    np.savez("one.npz", heights=heights)
    np.savez("two.npz", heights=heights, points=sheet)
    np.savez("none.npz")
    np.save("directions.npy", gm.icosphere(3))
    np.save("volume.npy", np.zeros((3, 4, 5)))
    np.save("complex.npy", heights + 1j)
    np.save("objects.npy", np.array([[{}, {}]]), allow_pickle=True)
    np.save("nan.npy", np.full_like(heights, np.nan))
    np.save("small.npy", heights[:2, :2])
    np.save("zero.npy", np.zeros((4, 3)))
    whole = Path("heights.npy").read_bytes()
    Path("cut.npy").write_bytes(whole[:-40])
    Path("huge.npy").write_bytes(whole.replace(b"(7, 9), }", b"(7777777777777777, 9), }", 1))
    Path("cut.npz").write_bytes(Path("two.npz").read_bytes()[:-40])
    Path("heights.txt").write_text("1 2 3")
    Path("folder.npy").mkdir()
    Path("folder").mkdir()
    Path("part.txt").write_text("1 2 3")
    parts.box().save("box.npz")
    Path("folder/link.ply").symlink_to("../two.npz")
    profile = {"driver": "GTiff", "count": 1, "height": 7, "width": 9, "dtype": "float64"}
    with rasterio.open("dem.tif", "w", transform=rasterio.Affine.scale(30.0), **profile) as file:
        file.write(heights, 1)


# ── What it does ─────────────────────────────────────────────────────────────────────────────────


def test_tolerance_of_data_and_what_the_summary_says_of_them(capsys):
    x, y = np.meshgrid(np.linspace(-1, 1, 50), np.linspace(-1, 1, 40))
    np.save("heights.npy", 100 * np.exp(-3 * (x * x + y * y)))
    arguments = ["--spacing", "30", "30", "--tolerance", "1", "--count", "300", "-o", "a.npz"]
    assert main(["sample", "heights.npy", *arguments]) == 0
    out, samples = capsys.readouterr().out, gm.read_samples("a.npz")
    assert out == f"a.npz: {samples.summary()}\n"
    assert "; they lie on a spline within 0." in out
    assert "of the data (root mean square 0." in out
    report: Any = samples.report
    assert report.surface == "heights.npy"
    assert report.fit_distance <= 1.0
    assert report.patches < 4 * 49 * 39


def test_quiet(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    progress = []
    sample = sampled.sample_and_normals

    def spy(*arguments: object, **options: object) -> object:
        progress.append(options["progress"])
        return sample(*arguments, **options)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(sampled, "sample_and_normals", spy)
    assert main(["sample", "torus", *FEW, "-o", "a.npz", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert main(["sample", "torus", *FEW, "-o", "a.npz"]) == 0
    assert progress == [False, True]


def test_the_default_is_a_count(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = {}

    def spy(_: object, request: object, **options: object) -> gm.Samples:
        asked.update(vars(request) | options)
        raise gm.errors.InputError("enough")

    monkeypatch.setattr(sampled, "sample_and_normals", spy)
    assert main(["sample", "torus", "-o", "a.npz"]) == 2
    assert (asked["count"], asked["normals"]) == (10_000, None)
    assert main(["sample", "torus", "--frequency", "2", "--threads", "3", "-o", "a.npz"]) == 2
    assert (asked["count"], asked["threads"]) == (None, 3)


def test_warnings_are_lines(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["sample", "plane", *GAUSS, "--count", "50", *EIGHT, "-o", "a.npz"]
    for _ in range(2):  # and every time
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert main(arguments) == 0
        out, err = capsys.readouterr()
        assert len(out.splitlines()) == 1
        assert re.fullmatch(r"gaussmap: warning: surface 'plane': .*\n", err)
    assert len(gm.read_samples("a.npz")) == 0


def test_surfaces(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["surfaces"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(gm.surfaces.names())
    assert re.match(r"torus +The torus around", lines[0])
    assert main(["surfaces", "torus"]) == 0
    assert capsys.readouterr().out == gm.surfaces.describe("torus") + "\n"


def test_formulas(capsys: pytest.CaptureFixture[str]) -> None:
    formulas = gm.formulas
    assert main(["formulas"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(formulas)
    name, formula = next(iter(formulas.items()))
    assert formula.sentence in lines[0]
    assert formula.source in lines[0]
    assert main(["formulas", name]) == 0
    out = capsys.readouterr().out
    assert out.startswith(f"{name}: {formula.sentence}")
    assert formula.text() in out
    for arguments in (["--latex", name], [name, "--latex"]):
        assert main(["formulas", *arguments]) == 0
        assert capsys.readouterr().out == formula.latex() + "\n"


@pytest.mark.slow
def test_all_formulas_in_latex(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["formulas", "--latex"]) == 0
    out = capsys.readouterr().out
    assert all(f.latex() in out for f in gm.formulas.values())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--version"], [f"gaussmap {gm.__version__}"]),
        (["mesh", "-h"], ["gaussmap mesh"]),
        (["--help"], ["to try:", "gaussmap sample torus --count 1000 -o torus.csv"]),
        (["sample", "--help"], ["--count N", "default: 10000", "the surface  ", "--spacing"]),
        (["sample", "--help-all"], ["how many samples", "default: 10000", "--spacing DX DY"]),
        (["batch", "--help-all"], ["the data set", "--measure"]),
        (["view", "--help"], ["default: 5000", "gaussmap[view]", ".html or .htm"]),
        (["plot", "--help"], ["default: 2000", "gaussmap[plot]", ".png, .pdf or .svg"]),
        (["surfaces", "--help"], ["NAME"]),
        (["formulas", "--help"], ["LaTeX"]),
    ],
)
def test_help(arguments, words, capsys):
    assert main(arguments) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert all(word in out for word in words)
    assert max(map(len, out.splitlines())) <= 100
    assert out.isascii()


@pytest.mark.parametrize("command", ["sample", "mesh", "plot", "view", "batch"])
def test_help_fits_on_a_screen(command, capsys, monkeypatch):
    """It names all options, and says how they are explained."""
    monkeypatch.setenv("COLUMNS", "100")
    assert main([command, "--help"]) == 0
    brief = capsys.readouterr().out
    assert len(brief.splitlines()) <= 50
    assert main([command, "--help-all"]) == 0
    whole = capsys.readouterr().out
    explained = re.findall(r"^  (?:-\w, )?(--[a-z][a-z-]*)", whole, re.MULTILINE)
    assert {*explained} <= {*re.findall(r"--[a-z][a-z-]*", brief)}
    assert len(explained) > 30
    assert "explained by --help-all" in brief


def test_a_terminal_gets_wrapped_lines(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "70")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert main(["surfaces"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > len(gm.surfaces.names())
    assert max(map(len, lines)) <= 70


@pytest.mark.parametrize("kind", ["csv", "xyz", "ply", "npy"])
def test_samples_go_to_a_pipe(kind: str, capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    """Nothing else goes there; what a file would hold does."""
    assert main(["sample", "torus", *FEW, "-o", "-", "--format", kind]) == 0
    out, err = capfdbinary.readouterr()
    assert err == b""
    assert not [*Path().iterdir()]
    samples = gm.sample("torus", 60, cells=(8, 8))
    if kind == "npy":
        rows = np.concatenate([samples.points, samples.normals], axis=1)
        np.testing.assert_array_equal(np.load(io.BytesIO(out)), rows)
    else:
        samples.write(f"a.{kind}")
        assert out == Path(f"a.{kind}").read_bytes()


# ── What can go wrong ────────────────────────────────────────────────────────────────────────────

# Arguments with values, functions and methods of Python.
PYTHON = r"\w=(\.\.\.|…|True|[\"(])|\b(gm|numpy|np|samples|report)\.[a-z]|\b[a-z]\w*\.[a-z]\w*\("
TO = ["-o", "a.npz"]
HEIGHTS = ["--spacing", "1", "1", *TO]
SADDLE = ["--formula", "u", "v", "u**2-v**2"]
SQUARE = ["--domain", "-1", "1", "-1", "1"]
PLY, SET = ["-o", "a.ply"], ["-o", "set"]
# A byte that is no UTF-8 arrives as a lone surrogate.
LONE = "\udc80"
HOSTILE = [
    [LONE], ["sample", LONE], ["sample", LONE, *TO], ["sample", "torus", "-o", LONE],
    ["sample", "torus", f"--{LONE}"], ["sample", "torus", "--set", f"minor={LONE}"],
    ["sample", "torus", "--count", LONE, *TO], ["surfaces", LONE],
    ["sample", f"{LONE}.npy", *TO], ["formulas", LONE], ["mesh", f"{LONE}.npz"],
    ["sample", "torus", "-o", f"nowhere/{LONE}.ply"],
]  # fmt: skip


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize(
    ("command", "message"),
    [
        # the command itself
        (["sampel"], r"no such command 'sampel'.*'sample'.* \(see `gaussmap --help`\)"),
        (["sample"], r"missing argument 'SURFACE', or --formula X Y Z \(see `gaussmap sample"),
        (["sample", "torus"], r"missing option '-o' / '--output' \(see `gaussmap sample --help`\)"),
        (["sample", "torus", "-o"], "option '-o' requires an argument .*gaussmap sample --help"),
        (["sample", "torus", "--cout", "5", *TO], "no such option '--cout'.*'--count'"),
        (["sample", "torus", "--count", "5", "--frequency", "3", *TO], "--frequency is not allow"),
        (["sample", "torus", "--seed", "5", *TO], "--seed goes with --random COUNT only"),
        (["sample", "torus", "--random", "5", "--seed", "-1", *TO], "--seed: .* from 0 to"),
        (["sample", "torus", "--random", "5", "--seed", *TO], "--seed: it must be .*, not '-o'"),
        (["sample", "torus", "--healpix", "3", *TO], "nside must be a power of 2, not 3"),
        (["torus"], "no such command 'torus'; did you mean `gaussmap sample torus`"),
        (["part.step", *TO], "did you mean `gaussmap sample part.step`"),
        (["--nonsense", "surfaces"], "no such option '--nonsense'"),
        # numbers
        *[
            (["sample", "torus", f"--{option}", number, *TO], f"--{option}: it must be a whole")
            for option, number in zip(
                cycle(("count", "frequency", "healpix", "random", "threads")),
                ("0", "-5", "abc", "1e4", "2.0", "nan", "", "9" * 5000, "0", "abc"), strict=False,
            )
        ],
        (["sample", "torus", "--angle", "91", *TO], "a positive number of at most 90"),
        (["sample", "torus", "--angle", "x", *TO], "--angle: it must be a number, not 'x'"),
        (["sample", "torus", "--coverage", "-1", *TO], "coverage must be a positive number, not"),
        (["sample", "torus", "--density", "flat", *TO], "there is no density"),
        (["sample", "torus", "--density", "-2", *TO], "a positive number of at most 8, not"),
        (["sample", "torus", *GAUSS, "--coverage", "1", *TO], "does not go with coverage; use"),
        (["sample", "torus", "--progressive", "--fields", "uv", *TO], "needs points and normals"),
        (["sample", "torus", "--path", "--progressive", *TO], "excludes --progressive"),
        (["sample", "torus", "--cells", "8", "0", *TO], "--cells: it must be a whole number"),
        (["sample", "torus", "--cells", "2", "8", *TO], "at least 3 x 3 cells"),
        (["sample", "torus", "--fields", "row", "--on", "spline", *TO], "on a grid only"),
        (["sample", "torus", "--reach", *"0019", "--density", "aligned", *TO], "with a reach use"),
        (["mesh", "torus", "--count", "9", "-o", "a.ply"], "take more samples"),
        # surfaces by name
        (["sample", "tours", *TO], "no surface 'tours'; did you mean torus.* `gaussmap surfaces`"),
        (["sample", "", *TO], "there is no surface ''"),
        (["sample", "two\nlines", *TO], "there is no surface"),
        (["sample", "torus", "--set", "mayor=1", *TO], r"did you mean major\?"),
        (["sample", "torus", "--set", "name=1", *TO], "no torus parameter 'name'; .*major, minor"),
        (["sample", "torus", "--set", "minor", *TO], "--set: it must be NAME=VALUE"),
        (["sample", "torus", "--set", "=2", *TO], "--set: it must be NAME=VALUE"),
        (["sample", "torus", "--set", "minor=x", *TO], "--set: it must be a number, not 'x'"),
        (["sample", "torus", "--set", "minor=nan", *TO], "minor of torus must be a positive"),
        (["sample", "torus", "--set", "minor=open('ran', 'w')", *TO], "--set: it must be a number"),
        (["sample", "torus", "--set", "minor=1", "--set", "minor=2", *TO], "same parameter twice"),
        (["sample", "torus", "--spacing", "1", "1", *TO], "--spacing is for elevations"),
        (["sample", "torus", "--periodic", "u", *TO], "--periodic is for grids"),
        # surfaces by formula
        (["sample", "torus", *SADDLE, *TO], "give SURFACE or --formula, not both"),
        (["mesh", *SADDLE, "-o", "a.ply"], "ranges of u and v: add --domain U0 U1 V0 V1"),
        (["plot", "torus", *SQUARE, "-o", "a.png"], "--domain goes with --formula only"),
        (["sample", *SADDLE, *SQUARE, "--set", "a=1", *TO], "--set does not go together"),
        (["sample", *SADDLE, *SQUARE, "--unit", "mm", *TO], "--unit is for CAD files, and 'a for"),
        (["sample", *SADDLE, "--domain", "0", "x", "0", "1", *TO], "domain must be"),
        (["sample", "--formula", "u", "v", "w", *SQUARE, *TO], "neither parameter nor number: w"),
        (["sample", "--formula", "u", "v", "open('a')", *SQUARE, *TO], "not a SymPy expression"),
        # parts
        (["sample", "torus", "--time-limit", "3", *TO], "--time-limit is for CAD files, and 'tor"),
        (["sample", "a.step", "--memory-limit", "0", *TO], "memory_limit must be a positive"),
        (["faces", "a.step", "--unit", "parsec"], "unit must be one of nm"),
        (["faces", "a.step", "--time-limit", "9"], "'a.step' does not exist"),
        (["sample", "box.npz", "--set", "a=1", *TO], "--set is for surfaces"),
        (["sample", "box.npz", "--on", "spline", *TO], "on a spline are of surfaces"),
        (["sample", "box.npz", "-o", "box.npz"], "'box.npz' is read"),
        (["mesh", "box.npz", "--count", "7", *PLY], "needs at least 8 vertices"),
        (["sample", "torus", "--edges", *TO], "edges are sampled of CAD parts"),
        (["faces", "box.npz", "--name", "slot*"], "no face"),
        (["faces", "box.npz", "--kind", "hole"], "'hole'"),
        (["sample", "box.npz", "--faces", "1;2", *TO], "--faces takes indices"),
        (["sample", "torus", "--faces", "1", *TO], "--faces is for CAD parts"),
        (["faces", "lost.npz"], "'lost.npz' cannot be read"),
        (["faces", "part.txt"], "is no STEP, IGES or BREP file"),
        (["sample", "torus", "--tolerance", "1e-30", *TO], "is below the rounding of coordinates"),
        (["sample", "torus", "--tolerance", "1", "--cells", "8", "8", *TO], "do not go together"),
        # surfaces in files
        (["sample", "missing.npy", *HEIGHTS], "'missing.npy' cannot be read: No such file"),
        (["sample", "folder.npy", *HEIGHTS], "'folder.npy' cannot be read: Is a directory"),
        (["sample", "heights.txt", *HEIGHTS], "neither a .npy, .npz, .tif nor .asc file"),
        (["sample", "part.stl", *TO], "'part.stl' is a mesh; meshes are not taken.*CAD file"),
        (["sample", "zero.npy", *HEIGHTS], r"shape \(4, 3\): points \(N, 3\) in no order are not"),
        (["sample", "cut.npy", *HEIGHTS], "'cut.npy' is damaged"),
        (["sample", "huge.npy", *HEIGHTS], "'huge.npy' is damaged|not enough memory"),
        (["sample", "objects.npy", *HEIGHTS], "'objects.npy' is damaged, or holds objects"),
        (["sample", "complex.npy", *HEIGHTS], "real numbers, not of type complex128"),
        (["sample", "cut.npz", *HEIGHTS], "'cut.npz' is damaged or is no .npz"),
        (["sample", "two.npz", *HEIGHTS], "2 arrays: heights, points; name .* two.npz:heights"),
        (["sample", "none.npz", *HEIGHTS], "'none.npz' holds 0 arrays;"),
        (["sample", "points.npy:x", *HEIGHTS], "'points.npy' holds one array, without a name"),
        (["sample", "two.npz:point", *HEIGHTS], r"in 'two.npz' 'point'; did you mean points\?"),
        (["sample", "volume.npy", *TO], r"shape \(m, n, 3\), or .* not \(3, 4, 5\)"),
        (["sample", "small.npy", *HEIGHTS], "small.npy has 2 x 2 points"),
        (["sample", "nan.npy", *HEIGHTS], "all points of nan.npy are missing"),
        (["sample", "heights.npy", *HEIGHTS, "--nodata", "x"], "--nodata: it must be a number"),
        (["sample", "torus", "--nodata", "1", *TO], "--nodata is for grids in a file"),
        (["sample", "torus", "--crs", "EPSG:32617", *TO], "--crs is for elevations"),
        (["sample", "torus", "--origin", "1", "1", *TO], "--origin is for elevations"),
        (["sample", "torus", "--source-crs", "EPSG:4326", *TO], "--source-crs is for elevations"),
        (["sample", "missing.tif", *TO], "cannot be read"),
        (["sample", "dem.tif", "--x", "x", *TO], "--x is for .npz files"),
        (["sample", "dem.tif", "--band", "2", *TO], "has 1 band, and no band 2"),
        (["sample", "dem.tif", "--periodic", "u", *TO], "--periodic is for grids of points"),
        (["sample", "dem.tif", *HEIGHTS], "has its own coordinates"),
        (["sample", "two.npz:heights", "--x", "x", *TO], "--x and --y go together"),
        (["sample", "two.npz:heights", "--x", "points", "--y", "z", *TO],
         "in 'two.npz' 'z'; there is heights, points."),
        (["sample", "two.npz:heights", "--band", "1", *HEIGHTS], "--band is for GeoTIFF"),
        (["sample", "two.npz:heights", *TO], "add --spacing DX DY, or --x and --y"),
        (["sample", "missing.txt", *TO], "does not exist"),
        (["sample", "missing.step", "--cells", "8", "8", *TO], "--cells is for surfaces"),
        (["sample", "torus", "--reach", "0", "0", "0", "25", *TO], "the axis of reach"),
        (["sample", "heights.npy", *TO], "elevations .* add --spacing DX DY"),
        (["sample", "heights.npy", "--spacing", "nan", "1", *TO], "spacing must be finite"),
        (["sample", "heights.npy", "--periodic", "u", *HEIGHTS], "cannot be periodic"),
        (["sample", "heights.npy", "--periodic", "w", *HEIGHTS], "--periodic: 'w' is not one of"),
        (["sample", "heights.npy", "--set", "a=1", *HEIGHTS], "--set is for surfaces by name"),
        (["sample", "points.npy", *HEIGHTS], "--spacing is for elevations, and 'points.npy'"),
        # normals in files
        (["sample", "torus", "--normals", "heights.txt", *TO], "neither a .npy nor a .npz"),
        (["sample", "torus", "--normals", "heights.npy", *TO], r"shape \(S, 3\)"),
        (["sample", "torus", "--normals", "zero.npy", *TO], "zero vector"),
        # the output
        (["sample", "torus", "-o", "a.stl"], "the suffix '.stl' of meshes; use one of .*mesh`"),
        (["sample", "torus", "-o", "a.xlsx"], "'a.xlsx' has the suffix '.xlsx'; use one of .npz,"),
        (["sample", "torus", "-o", "a"], "'a' has no suffix"),
        (["sample", "torus", "-o", ""], "the name of the file is empty"),
        (["sample", "torus", "-o", "-"], "-o - writes to standard output, with --format csv, xyz,"),
        (["sample", "torus", "--format", "csv", *TO], "-o - writes to standard output, with"),
        (["sample", "torus", "--format", "npz", "-o", "-"], "--format: 'npz' is not one of 'csv'"),
        (["sample", "torus", "--fields", "uv", "--format", "npy", "-o", "-"], "needs 'points'"),
        (["sample", "torus", "-o", "missing/a.npz"], "'.*missing' does not exist"),
        (["sample", "torus", "-o", "heights.txt/a.npz"], "not a folder"),
        (["sample", "two.npz:points", "-o", "two.npz"], "'two.npz' is read; write to another"),
        (["sample", "two.npz:points", "-o", "folder/link.ply"], "is read; write to another file"),
        (["sample", "torus", "--normals", "two.npz:points", "-o", "./two.npz"], "is read; write"),
        (["plot", "torus", "-o", "a.npz"], "'a.npz' has the suffix '.npz'; use one of .png"),
        (["view", "torus", "-o", "a.png"], "'a.png' has the suffix '.png'; use one of .html"),
        (["view", "torus", "--count", "50001", "-o", "a.html"], "at most 50,000 samples"),
        # meshes
        (["mesh", "torus", *TO], "use one of .ply, .obj, .stl, .3mf, .vtu, .vtp, .glb"),
        (["mesh", "torus", "-o", "no/a.ply"], "create the folder first"),
        (["mesh", "torus", *FEW, "--deviation", "0", *PLY], "angle must lie between 0 and 180"),
        (["mesh", "torus", "--deviation", "wide", *PLY], "it must be a number, not 'wide'"),
        (["mesh", "torus", "--prefer", "size", *PLY], "'size' is not one of"),
        # data sets
        (["batch", *SET], "there are no parts"),
        (["batch", "torus", *SET, "--fields", "pints"], "points"),
        (["batch", "torus", *SET, "--workers", "0"], "whole number"),
        (["batch", "torus", *SET, "--time-limit", "-1"], "time_limit"),
        (["batch", "torus", "-o", "heights.txt"], "is a file"),
        (["batch", "torus", "-o", "."], "new or empty folder"),
        (["batch", "--list", "missing.txt", *SET], "'missing.txt' cannot be read"),
        (["batch", "*.step", *SET], "matches no files"),
        (["batch", "folder", *SET], "has no files of parts"),
        # lists
        (["surfaces", "tours"], "no surface 'tours'; did you mean torus"),
        (["surfaces", "torus", "sphere"], r"unexpected extra argument \(sphere\)"),
        (["formulas", "support_functoin"], r"no formula 'support_functoin'; did you mean"),
        *((command, "") for command in HOSTILE),
    ],
)  # fmt: skip
def test_an_error_is_one_line(command, message, capsys):
    before = {path: path.is_file() and path.read_bytes() for path in Path().iterdir()}
    assert main(command) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert re.fullmatch(r"gaussmap: error: [^\n]+\n", err)
    assert err.encode()
    assert re.search(message, err)
    assert not re.search(PYTHON, err)
    assert {path: path.is_file() and path.read_bytes() for path in Path().iterdir()} == before


@pytest.mark.parametrize(
    ("command", "suffix"), {**dict.fromkeys(("sample", "mesh", "support"), "ply"), "plot": "png",
                            "view": "html"}.items(),
)  # fmt: skip
def test_bad_output_is_found_before_the_work(command, suffix, failing, monkeypatch, capsys):
    vain = AssertionError("worked in vain")
    failing(vain)
    monkeypatch.setattr(support, "GaussMap", partial(raised, vain))
    asked = (
        ("a.dat", "suffix '.dat'"),
        (f"no/a.{suffix}", "does not exist"),
        (f"a.{suffix}", "denied"),
    )
    for target, said in asked:
        if said == "denied":
            denied = PermissionError(errno.EACCES, "Permission denied")
            monkeypatch.setattr(Path, "touch", partial(raised, denied))
        assert main([command, "torus", "-o", target]) == 2
        assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("command", "extra"),
    [("sample torus --healpix 4 -o a.npz", "spheres"), ("sample torus -o a.parquet", "tables"),
     ("mesh torus -o a.glb", "trimesh"), ("plot torus -o a.png", "plot"),
     ("view torus -o a.html", "view")],
)  # fmt: skip
def test_a_library_that_is_not_installed(command, extra, failing, capsys, monkeypatch):
    """It is named before the work."""
    failing(AssertionError("worked in vain"))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setitem(sys.modules, "astropy_healpix", None)
    assert main(command.split()) == 2
    assert f'run: pip install "gaussmap[{extra}]"' in capsys.readouterr().err
    assert not [*Path().iterdir()]


def test_no_memory_and_a_bug_that_keeps_its_traceback(capsys, failing):
    failing(MemoryError())
    assert main(["sample", "torus", *TO]) == 2
    assert re.fullmatch("gaussmap: error: there is not enough memory.*\n", capsys.readouterr().err)

    failing(ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        main(["sample", "torus", *TO])


def test_interrupted_in_a_callback(capsys, monkeypatch):
    """As by LLVM: the interrupt is lost, and the compiler then fails."""

    class Unraisable:
        exc_type = KeyboardInterrupt

    def sample(*_: object, **__: object) -> None:
        sys.unraisablehook(Unraisable())  # pyright: ignore[reportArgumentType]
        raise RuntimeError("compilation failed")

    monkeypatch.setattr(sampled, "sample_and_normals", sample)
    hook = sys.unraisablehook
    assert main(["sample", "torus", *TO]) == 130
    assert capsys.readouterr() == ("", "gaussmap: interrupted\n")
    assert sys.unraisablehook is hook


@posix
def test_interrupted_by_a_signal(tmp_path: Path) -> None:
    # A test run in the background ignores interrupts, and what it starts would do so too.
    code = (
        "import signal, sys, time; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from pathlib import Path; from gaussmap.tools.commands import sampled; "
        "sampled.sample_and_normals = lambda *_, **__: (Path('begun').touch(), time.sleep(60)); "
        "from gaussmap.__main__ import main; sys.exit(main())"
    )
    command = [sys.executable, "-c", code, "sample", "torus", "-o", "a.ply"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        while not Path("begun").exists():  # past the imports
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert (process.returncode, out, err) == (130, "", "gaussmap: interrupted\n")
    assert [path.name for path in tmp_path.iterdir()] == ["begun"]


@posix
@pytest.mark.parametrize("command", [["surfaces"], ["--help"]])
def test_a_reader_that_goes_away(command: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = gaussmap(*command, stdout=writer)
    os.close(writer)
    assert done.stderr == ""
    assert done.returncode == 141 or command == ["--help"]  # argparse may have swallowed it


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_standard_output_is_full() -> None:
    with open("/dev/full", "w") as full:
        done = gaussmap("surfaces", stdout=full)
    assert done.returncode == 2
    assert re.fullmatch("gaussmap: error: standard output cannot be written: .*\n", done.stderr)


def test_an_old_terminal() -> None:
    """One that knows ASCII only, with Python told to be strict."""
    done = python("-X", "utf8=0", "-m", "gaussmap", "surfaces", encoding="ascii:strict")
    assert (done.returncode, done.stderr) == (0, "")
    assert "x?/a?" in done.stdout


# Lines of Python, and a pattern of modules that they do not load.
LAZY = [
    ("import gaussmap.tools.commands.cli, gaussmap.tools.files.formats",
     "matplotlib|sympy|pyvista|trimesh|vtkmodules|tqdm"),
    ("from gaussmap.tools.pictures.plot import write_figure", "matplotlib"),
    ("from gaussmap.tools.pictures.plot import write_figure; import gaussmap as gm; "
     "write_figure(gm.sample('torus', 50).plot(), 'a.png')", "matplotlib.pyplot"),
    ("import gaussmap as gm; gm.Surface.from_sympy(('u', 'v', 'u*v'), 'uv', ((0, 1), (0, 1)))",
     r"gaussmap\.symbolic\.(?!reading)"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "heavy"), LAZY)
def test_heavy_imports_are_lazy(code: str, heavy: str) -> None:
    loaded = f"import re, sys; print([x for x in sys.modules if re.match({heavy!r}, x)])"
    done = python("-c", f"{code}\n{loaded}")
    assert (done.stdout, done.stderr) == ("[]\n", "")


def test_help_usage_and_completion_need_no_arrays() -> None:
    asked = [[], ["--help"], ["sample", "--help"], ["sample", "torus"], ["--version"]]
    code = (
        "import sys, os; from gaussmap.tools.commands.cli import main\n"
        f"print([main(arguments) for arguments in {asked}])\n"
        "for words in ('sample to', 'formulas s', 'sample torus --set m'):\n"
        "    line = f'gaussmap {words}'\n"
        "    os.environ.update(COMP_WORDS=line, COMP_CWORD=str(line.count(' ')),"
        " _GAUSSMAP_COMPLETE='bash_complete')\n"
        "    assert main([]) == 0\n"
        "print({'numpy', 'numba', 'scipy', 'sympy'} & set(sys.modules))"
    )
    lines = python("-c", code).stdout.splitlines()
    assert lines[-1] == "set()"
    expected = {"[0, 0, 0, 2, 0]", "plain,torus", "plain,support_function", "plain,minor="}
    assert expected <= {*lines}


def test_a_bare_call_shows_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    assert main([]) == 0
    assert capsys.readouterr() == (text, "")
    tried = [line for line in text.splitlines() if line.startswith("    gaussmap")]
    assert len(tried) == 3
    for line in tried[:2]:  # the third one needs Matplotlib
        command = line.split("  ")[2].split()
        assert main(command[1:]) == 0
    assert len(Path("torus.csv").read_text().splitlines()) == 1001


# ── Completion by shells ─────────────────────────────────────────────────────────────────────────


COMMANDS = [
    "sample", "mesh", "plot", "view", "batch", "support", "surfaces", "faces", "formulas",
    "completion",
]  # fmt: skip


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("gaussmap ", COMMANDS),
        ("gaussmap sample --co", ["--count", "--coverage"]),
        ("gaussmap plot tor", ["torus", "file:tor"]),
        ("gaussmap surfaces tor", ["torus"]),
        ("gaussmap sample torus --set mi", ["minor="]),
        ("gaussmap formulas support_f", ["support_function"]),
        ("gaussmap formulas ", [*gm.formulas]),
        ("gaussmap completion z", ["zsh"]),
        ("gaussmap mesh torus --density un", ["uniform"]),
        ("gaussmap mesh torus -o a", ["file:a"]),
    ],
)
def test_completion(words, offered, capsys, monkeypatch):
    monkeypatch.setenv("_GAUSSMAP_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(words.count(" ")))
    assert main([]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    lines = [line.partition(",") for line in out.splitlines()]
    assert [x if kind == "plain" else f"{kind}:{x}" for kind, _, x in lines] == offered


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_is_installed(shell: str) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    install = f"{sys.executable} -m gaussmap completion {shell}"
    evaluate = f"{install} | source" if shell == "fish" else f'eval "$({install})"'
    asked = {"bash": "complete -p gaussmap", "fish": "complete -c gaussmap"}
    before = "autoload -Uz compinit; compinit -u; " if shell == "zsh" else ""
    after = asked.get(shell, "echo ${_comps[gaussmap]}")
    done = subprocess.run(
        [shell, "-c", f"{before}{evaluate}; {after}"], capture_output=True, text=True, check=True
    )
    assert "_gaussmap_completion" in done.stdout


# --- `gaussmap mesh` ------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "vtu", "vtp"])
def test_a_mesh_is_written(suffix: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mesh", "torus", "--count", "100", *EIGHT, "-o", f"torus.{suffix}"]) == 0
    out, err = capsys.readouterr()
    pattern = rf"torus\.{suffix}: (\d+) vertices, (\d+) triangles, closed; 95 % have .*\n"
    found = re.fullmatch(pattern, out)
    assert err == ""
    mesh = pytest.importorskip("pyvista").read(f"torus.{suffix}")
    assert mesh.n_cells == int(found[2]) == 2 * int(found[1])


def test_samples_that_are_left_out_are_counted(capsys: pytest.CaptureFixture[str]) -> None:
    mesh = gm.sample("wavy_graph", 300, cells=(16, 16)).mesh()
    own = mesh.sample_index[mesh.sample_index >= 0]
    assert len(np.unique(own)) + mesh.left_out == 300
    assert mesh.left_out > 0
    few = ["--count", "300", "--cells", "16", "16"]
    assert main(["mesh", "wavy_graph", *few, "-o", "graph.ply"]) == 0
    assert f", {mesh.left_out} of the samples left out, " in capsys.readouterr().out


# --- `gaussmap batch` -----------------------------------------------------------------------------

SMALL = ["--cells", "8", "8", "--count", "50", "--density", "uniform"]


def test_a_run_and_the_same_again(capfd: pytest.CaptureFixture[str]) -> None:
    Path("list.txt").write_text("# two parts\n\nsphere\nmissing.step\n")
    command = ["batch", "torus", "--list", "list.txt", *SMALL, "-o", "set", "--workers", "1"]
    command += ["--float32"]
    assert main(command) == 3
    out, err = capfd.readouterr()
    assert "set: 100 samples of 3 parts" in out
    assert "missing.step' does not exist" in out
    assert "--retry-failed" in out
    assert "error" not in err  # on a slow machine there is a line on progress
    assert main([*command, "--json"]) == 3
    told = json.loads(capfd.readouterr().out)
    assert (told["parts"], told["ok"], told["kept"], told["failed"]) == (3, 0, 2, 1)
    assert told["failures"][0]["name"] == "missing"
    data = gm.open_dataset("set")
    assert data.manifest()["name"].to_pylist() == ["torus", "sphere", "missing"]
    expected = gm.sample("torus", 50, density="uniform", cells=(8, 8), dtype=np.float32)
    np.testing.assert_array_equal(data.samples(0).points, expected.points)
    assert main(["batch", "torus", *SMALL, "-o", "set", "--overwrite", "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")
    assert len(gm.open_dataset("set")) == 1


def same_as_sample(data: gm.Dataset, part: int, *arguments: str) -> bool:
    """Say whether a part has the points that `gaussmap sample` writes."""
    assert main(["sample", *arguments, *SMALL, "-o", "one.npz", "--quiet"]) == 0
    return np.array_equal(data.samples(part).points, gm.read_samples("one.npz").points)


def test_elevations(capfd: pytest.CaptureFixture[str]) -> None:
    heights = 9 * np.sin(np.add.outer(np.arange(12.0), np.arange(15.0) / 3))
    np.save("heights.npy", heights)
    np.savez("two.npz", high=2 * heights, low=heights)
    command = ["batch", "heights.npy", "two.npz:high", "-o", "set", "--workers", "1", "--quiet"]
    command += SMALL
    assert main([*command, "--spacing", "30", "-30"]) == 0
    data = gm.open_dataset("set")
    assert data.settings.asked["spacing"] == [30.0, -30.0]
    assert data.manifest(["name", "source"]).to_pylist() == [
        {"name": "heights", "source": "heights.npy"},
        {"name": "two:high", "source": "two.npz:high"},
    ]
    assert same_as_sample(data, 0, "heights.npy", "--spacing", "30", "-30")
    assert same_as_sample(data, 1, "two.npz:high", "--spacing", "30", "-30")
    assert main([*command, "--spacing", "30", "30"]) == 2
    assert "spacing [30.0, -30.0], not [30.0, 30.0]" in capfd.readouterr().err


@pytest.mark.slow
def test_formulas_are_made_in_batches() -> None:
    formulas = ["u", "v", "u*v"], ["u", "v", "cos(u)*v"]
    domain = ["--domain", "-1", "1", "-1", "pi/3"]
    command = ["batch", "torus", "--formula", *formulas[0], "--formula", *formulas[1]]
    command += [*domain, *SMALL, "-o", "set", "--workers", "1", "--quiet"]
    assert main(command) == 0
    data = gm.open_dataset("set")
    names = ["torus", "(u, v, u*v)", "(u, v, cos(u)*v)"]
    assert data.manifest()["name"].to_pylist() == names
    assert same_as_sample(data, 0, "torus")
    for part, formula in enumerate(formulas, 1):
        assert same_as_sample(data, part, "--formula", *formula, *domain)


def test_lists() -> None:
    names = ("a/2.STEP", "a/b/1.npz", "a/b/c/3.obj", "a/b/dem.TIF", "a/notes.txt", "a/10.iges")
    for name in (*names, "x[1].step"):
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).touch()
    assert listed(["a"], None) == ["a/10.iges", "a/2.STEP", "a/b/1.npz", "a/b/dem.TIF"]
    assert listed(["a/*.*s*"], None) == ["a/10.iges"]
    assert listed(["a/**/*.npz", "x[1].step"], None) == ["a/b/1.npz", "x[1].step"]
    assert listed(["a/**/*.i*", "**/*.obj"], None) == ["a/10.iges", "a/b/c/3.obj"]
    Path("list").write_text("torus\n # no\n../../etc/passwd\n", "utf-8")
    assert listed([], "list") == ["torus", "../../etc/passwd"]
    Path("list").write_bytes(b"\xff\xfe")
    refused("UTF-8", listed, [], "list", error=gm.errors.FileError)
    assert listed([], None) == []


@pytest.mark.slow
def test_a_list_on_standard_input() -> None:
    grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0)), axis=-1)
    points = np.concatenate([grid, np.sin(grid[..., :1])], axis=-1)
    np.save("..grid.npy", points)
    done = subprocess.run(
        [sys.executable, "-m", "gaussmap", "batch", "--list", "-", *SMALL[3:], "-o", "set"],
        input="..grid.npy\ntorus\n../../../../etc/passwd\n", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 3, done.stderr
    rows = gm.open_dataset("set").manifest(("name", "status")).to_pylist()
    assert [(row["name"], row["status"]) for row in rows] == [
        ("..grid", "ok"), ("torus", "ok"), ("passwd", "failed")
    ]  # fmt: skip


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on() -> None:
    command = [sys.executable, "-m", "gaussmap", "batch", *40 * ["torus"], *SMALL, "-o", "set"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while not Path("set/points/000000.parquet").exists():
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "gaussmap: what is done is kept: the same command goes on with the rest\n" in err
    assert 1 <= len(gm.open_dataset("set")) < 40
    assert subprocess.run([*command, "--quiet"]).returncode == 0
    assert len(gm.open_dataset("set")) == 40
