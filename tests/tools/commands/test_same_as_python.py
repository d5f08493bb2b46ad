"""Commands and Python have the same options, defaults and results; texts name the same surfaces."""

import inspect
import math
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.commands.cli import main
from gaussmap.tools.commands.parser import parser

from ...shapes import same

UTM = "EPSG:32617"
ROWS, COLUMNS = np.indices((9, 11))
HEIGHTS = 40.0 * np.sin(ROWS / 3.0) * np.cos(COLUMNS / 4.0)
POINTS = np.stack([np.cos(COLUMNS / 4), np.sin(COLUMNS / 4), ROWS / 3.0], axis=-1)
SADDLE = "-u v u**2-v**2"  # values may begin with a dash
TUBE = "cos(v) sin(v) u"
DEGREES = {"longitude": -83.0 + np.arange(11.0) / 100, "latitude": 36.0 - np.arange(9.0) / 100}
SMALL: dict[str, Any] = {"cells": (8, 8)}

Made = Callable[[], gm.Samples]


def torus(**options: Any) -> Made:
    return lambda: gm.sample("torus", **({} if "tolerance" in options else SMALL) | options)


def elevations(**options: Any) -> Made:
    return lambda: gm.sample(gm.terrain(HEIGHTS, spacing=(30, -30), **options), 60)


def of_degrees(**options: Any) -> Made:
    x, y = DEGREES.values()
    return lambda: gm.sample(gm.terrain(HEIGHTS, x=x, y=y, **options), 60)


def part(**options: Any) -> Made:
    return lambda: gm.sample(gm.read_cad("part.step", **options), 60)


def grid(**options: Any) -> Made:
    return lambda: gm.sample(gm.Surface.from_grid(POINTS, **options), 60)


def formula(texts: str, *how: Any) -> Made:
    return lambda: gm.sample(gm.Surface.from_sympy(texts.split(), "uv", *how), 60)


# What `gaussmap sample` is asked, its options by name, and the same in Python.
ASKED: list[tuple[str, Made]] = [
    ("--count 60", torus(count=60)),
    ("--angle 25", torus(angle=25.0)),
    ("--coverage 0.4", torus(coverage=0.4)),
    ("--frequency 2", torus(normals=gm.icosphere(2))),
    ("--healpix 2", torus(normals=gm.directions.healpix(2))),
    ("--random 20", torus(normals=gm.directions.random(20))),
    ("--seed 3 --random 20", torus(normals=gm.directions.random(20, seed=3))),
    ("--normals one.npy", torus(normals=[[1.0, 2.0, 3.0]])),
    ("--normals all.npz:normals", torus(normals=[[3.0, 2.0, 1.0]])),
    ("--normals one.npy --coverage 0.4", torus(normals=[[1.0, 2.0, 3.0]], coverage=0.4)),
    ("--density uniform --count 60", torus(count=60, density="uniform")),
    ("--density 0.5 --count 60", torus(count=60, density=0.5)),
    ("--density balanced --frequency 2", torus(normals=gm.icosphere(2), density="balanced")),
    ("--reach 1 0 1 40 --count 60", torus(count=60, reach=((1, 0, 1), 40.0))),
    ("--slope 20 60 --aspect 180 45 --count 60",
     torus(count=60, reach=gm.Reach(slope=(20, 60), aspect=(180, 45)))),
    ("--offset -.2 --count 60", lambda: torus(count=60)().offset(-0.2)),
    ("--offset .7 --trimmed --count 60", lambda: torus(count=60)().offset(0.7, trimmed=True)),
    ("--on spline --count 60", torus(count=60, on="spline")),
    ("--threads 1 --count 60", torus(count=60, threads=1)),
    ("--fields points,uv --count 60", torus(count=60, fields=("points", "uv"))),
    ("--float32 --count 60", torus(count=60, dtype=np.float32)),
    ("--progressive --count 60", lambda: torus(count=60)().progressive()),
    ("--path --count 60", lambda: torus(count=60)().in_order("path")),
    ("--set major=2 --set minor=.2 --count 60",
     lambda: gm.sample(gm.surfaces.torus(major=2, minor=0.2), 60, **SMALL)),
]  # fmt: skip
OTHERS: list[tuple[str, str, Made]] = [
    ("torus", "--tolerance 0.01", lambda: gm.sample(
        "torus", 60, cells=gm.fit("torus", tolerance=0.01).cells)),
    ("heights.npy --spacing 30 -30", "--tolerance 5", lambda: gm.sample(
        gm.fit(gm.Surface.from_grid(HEIGHTS, spacing=(30, -30)), tolerance=5.0), 60)),
    ("heights.npy", "--spacing 30 -30", lambda: gm.sample(
        gm.Surface.from_grid(HEIGHTS, spacing=(30, -30)), 60)),
    ("heights.npy --spacing 30 -30", "--nodata 0", elevations(nodata=0.0)),
    ("heights.npy --spacing 30 -30", f"--crs {UTM}", elevations(crs=UTM)),
    ("heights.npy --spacing 30 -30", "--origin 7 8", elevations(origin=(7.0, 8.0))),
    ("all.npz:heights", "--x longitude --y latitude", of_degrees(source_crs="EPSG:4326")),
    ("all.npz:heights --x easting --y northing", "--source-crs EPSG:4258",
     of_degrees(source_crs="EPSG:4258")),
    ("two.tif", "--band 2", lambda: gm.sample(gm.terrain("two.tif", band=2), 60)),
    ("two.tif", "", lambda: gm.sample(gm.terrain("two.tif"), 60)),
    ("points.npy", "--periodic none", grid()),
    ("points.npy", "--periodic u", grid(periodic=(True, False))),
    ("./all.npz:points", "--periodic v", grid(periodic=(False, True))),
    ("points.npy", "--periodic uv", grid(periodic=(True, True))),
    ("--domain -1 1 -2 2", f"--formula {SADDLE}", formula(SADDLE, ((-1, 1), (-2, 2)))),
    (f"--formula {TUBE}", "--domain -1 1 0 2*pi --periodic v",
     formula(TUBE, ((-1, 1), (0, "2*pi")), (False, True))),
    (f"--formula {SADDLE}", "--domain -1 1 -1 1/2", formula(SADDLE, ((-1, 1), (-1, "1/2")))),
    ("box.npz", "--edges", lambda: gm.sample(gm.read_part("box.npz"), 60, edges=True)),
    ("box.npz", "--faces 0 3 --from-edges .2", lambda: gm.sample(
        gm.read_part("box.npz").select(index=[0, 3]), 60, reach=gm.Reach(from_edges=0.2))),
    ("box.npz", "--faces 5 --unobstructed --clearance inf", lambda: gm.sample(
        gm.read_part("box.npz").select(index=[5]), 60,
        reach=gm.Reach(unobstructed=True, clearance=math.inf))),
    ("box.npz --kind plane", "--name s*e",
     lambda: gm.sample(gm.read_part("box.npz").select(kind="plane", name="s*e"), 60)),
    ("part.step", "", part()),
    ("part.step", "--unit cm", part(unit="cm")),
    ("part.step", "--time-limit 7", part(time_limit=7.0)),
    ("part.step", "--memory-limit 2", part(memory_limit=2.0)),
]  # fmt: skip
CASES = [
    *(("torus --cells 8 8", options, made) for options, made in ASKED),
    *((source, f"{options} --count 60", made) for source, options, made in OTHERS),
]
# Options that change nothing of the samples: the file, and what is printed.
OUTSIDE = {"--output", "--format", "--quiet", "--help-all"}


@pytest.fixture(autouse=True)
def _inputs(monkeypatch: pytest.MonkeyPatch, parts: ModuleType) -> None:
    """Write the files of the cases; reading a CAD file gives a box of the size of its arguments."""
    np.save("heights.npy", HEIGHTS)
    np.save("points.npy", POINTS)
    np.save("one.npy", np.array([[1.0, 2.0, 3.0]]))
    easting, northing = DEGREES.values()
    arrays = {"heights": HEIGHTS, "points": POINTS, "normals": np.array([[3.0, 2.0, 1.0]])}
    np.savez("all.npz", easting=easting, northing=northing, **DEGREES, **arrays)
    parts.box().save("box.npz")
    Path("part.step").write_text("ISO-10303-21;")
    signature = inspect.signature(gm.read_cad)

    def read(path: Any, *arguments: Any, **options: Any) -> gm.Part:
        bound = signature.bind(path, *arguments, **options)
        bound.apply_defaults()
        unit, seconds, memory = (bound.arguments[x] for x in ("unit", "time_limit", "memory_limit"))
        return parts.box(len(unit or "") + 1.0, seconds, memory)

    monkeypatch.setattr(sys.modules[gm.read_cad.__module__], "read_cad", read)
    monkeypatch.setattr(gm, "read_cad", read)


def raster() -> None:
    """Write a GeoTIFF of two bands."""
    rasterio = pytest.importorskip("rasterio")
    shift = rasterio.Affine(30.0, 0.0, 500_000.0, 0.0, -30.0, 4_100_000.0)
    size = {"count": 2, "height": 9, "width": 11, "dtype": "float64"}
    with rasterio.open("two.tif", "w", driver="GTiff", transform=shift, crs=UTM, **size) as file:
        file.write(np.stack([HEIGHTS, HEIGHTS.T.reshape(HEIGHTS.shape)]))


@pytest.mark.parametrize(("source", "options", "made"), CASES, ids=[" ".join(x[:2]) for x in CASES])
def test_a_command_and_python_make_the_same_samples(source: str, options: str, made: Made) -> None:
    if "tif" in source or "EPSG" in options or "longitude" in options:
        raster()
    command = ["sample", *source.split(), *options.split(), "--quiet", "-o", "a.npz"]
    assert main(command) == 0
    same(gm.read_samples("a.npz"), made())


def options_of(command: str) -> dict[str, Any]:
    """Return the options of a command by their long names."""
    return {x.opts[-1]: x for x in parser().commands[command].params if x.opts[-1][:2] == "--"}


def test_every_option_has_a_case() -> None:
    asked = {word for x in CASES for word in f"{x[0]} {x[1]}".split() if word.startswith("--")}
    assert {*options_of("sample")} - OUTSIDE == asked


@pytest.mark.parametrize("command", ["mesh", "plot", "view", "batch"])
def test_commands_share_options_and_defaults(command: str) -> None:
    own = options_of(command)
    for name, option in options_of("sample").items():
        if name in own and not own[name].multiple:
            assert own[name].default == option.default


@pytest.mark.parametrize(
    ("source", "options", "normals"),
    [
        ("torus --cells 8 8 --on spline", "--frequency 2", gm.icosphere(2)),
        ("box.npz --faces 0 3", "", [*0.0 - np.eye(3), *np.eye(3)]),
    ],
)
def test_farthest_points(source: str, options: str, normals: Any, capsys: Any) -> None:
    assert main(["support", *source.split(), *options.split(), "-o", "a.npz"]) == 0
    whole, samples = source.startswith("box"), gm.read_samples("a.npz")
    known = gm.GaussMap(
        gm.read_part("box.npz").select(index=[0, 3]) if whole else gm.fit("torus", (8, 8))
    )
    found = known.support(normals)
    assert whole or samples.face_index is None
    np.testing.assert_array_equal(samples.normals, normals)
    np.testing.assert_array_equal(samples.support, found.values)
    for name in ("points", "uv", *(["face_index"] if whole else [])):
        np.testing.assert_array_equal(getattr(samples, name), getattr(found, name))
    error = f"{found.errors.max():.2g} {'mm' if whole else ''}".strip()
    assert f"{len(normals)} farthest points of" in (out := capsys.readouterr().out)
    assert f"to {error} along n\n" in out


@pytest.mark.parametrize("how", [{}, {"angle": 30.0}, {"prefer": "normals"}])
def test_meshes(how: dict[str, Any], capsys: pytest.CaptureFixture[str]) -> None:
    options = {"angle": "--deviation", "prefer": "--prefer"}
    asked = [str(x) for name, value in how.items() for x in (options[name], value)]
    command = ["mesh", "torus", "--cells", "8", "8", "--frequency", "6", "-o", "a.ply"]
    assert main([*command, "--quiet", *asked]) == 0
    assert capsys.readouterr() == ("", "")
    gm.sample("torus", normals=gm.icosphere(6), **SMALL).mesh(**how).write("b.ply")
    assert Path("a.ply").read_bytes() == Path("b.ply").read_bytes()


@pytest.mark.parametrize(
    ("options", "figure"),
    [
        ("box.npz", lambda: gm.plot(gm.read_part("box.npz"))),
        ("ellipsoid_patch --frequency 4", lambda: gm.plot(
            "ellipsoid_patch", normals=gm.icosphere(4))),
    ],
)  # fmt: skip
def test_pictures(options, figure, capsys):
    image = pytest.importorskip("matplotlib.image")
    assert main(["plot", *options.split(), "--quiet", "-o", "a.png"]) == 0
    assert capsys.readouterr() == ("", "")
    figure().savefig("b.png")
    np.testing.assert_array_equal(*(image.imread(x) for x in ("a.png", "b.png")))


@pytest.mark.slow
def test_data_sets() -> None:
    """With the count that is the default, and all that is for data sets only."""
    words = ["batch", "torus", "--fields", "points,normals,normal_index", "--float32", "--measure"]
    words += ["--workers", "1", "--quiet", "-o", "one"]
    assert main(words) == 0
    other = gm.sample_many(
        ["torus"], 2048, fields=["points", "normals", "normal_index"], dtype=np.float32,
        measure=True, out="other", workers=1, progress=False,
    )  # fmt: skip
    one = gm.open_dataset("one")
    assert one.settings == other.settings
    same(one.samples(0), other.samples(0))
    (row,) = one.manifest().to_pylist()
    assert row["angle"] is not None
    assert [row] == other.manifest().to_pylist()


def test_defaults_of_data_sets() -> None:
    """The options of `gaussmap batch` are those of `sample_many`, and have their defaults."""
    known = inspect.signature(gm.sample_many).parameters
    own = {name[2:].replace("-", "_"): x for name, x in options_of("batch").items()}
    names = {*own} & {*known} - {"cells", "time_limit"}
    asked = parser().commands["batch"].make_context("batch", ["torus", "-o", "set"]).params
    for name in names:
        assert (asked[name] or None) == (known[name].default or None), name
    assert {"workers", "scheduler", "measure", "memory_limit", "retry_failed"} <= names
    assert f"(default: {known['time_limit'].default:g})" in own["time_limit"].help
