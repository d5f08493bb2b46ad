import importlib.util
import re
from io import BytesIO
from itertools import combinations
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures import palette
from gaussmap.tools.pictures.plot import write_figure
from gaussmap.tools.pictures.scene import scene_of, view
from matplotlib import colors, image
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Path3DCollection

from ...refusals import refused
from .made import texts

SIZE = (920, 1800, 4)


@pytest.fixture(scope="module")
def torus() -> gm.Spline:
    return gm.fit(gm.surfaces.torus(), cells=(24, 24))


def plotted(
    surface: gm.Surface | gm.Spline, path: Path, normals: np.ndarray | None = None, **asked: Any
) -> gm.Samples:
    """Draw samples of a surface into a file."""
    samples = gm.sample(surface, normals=normals, **asked)
    write_figure(samples.plot(normals=normals), path)
    return samples


def picture(path: Path) -> np.ndarray:
    return image.imread(path)


def share(pixels: np.ndarray, colour: str) -> float:
    """The share of the pixels that have about a colour."""
    return float(np.mean(np.abs(pixels[..., :3] - colors.to_rgb(colour)).max(axis=2) < 0.08))


# ── Pictures ─────────────────────────────────────────────────────────────────────────────────────


def test_png(torus: gm.Spline, tmp_path: Path) -> None:
    path = tmp_path / "torus.png"
    samples = plotted(torus, path, count=600)
    assert abs(len(samples) - 600) < 30
    pixels = picture(path)
    assert pixels.shape == SIZE
    sphere, support, surface = np.split(pixels, [560, 920], axis=1)
    for panel in (sphere, support, surface):
        assert 0.3 < np.mean(panel[..., :3].min(axis=2) > 0.99) < 0.9  # neither blank nor full
    assert share(sphere, palette.FILLING) > 0.002
    assert share(sphere, palette.INK) > 0.002
    assert share(sphere, palette.HYPERBOLIC) < 0.0001
    assert share(surface, palette.HYPERBOLIC) > 0.001
    for panel in (sphere, support, surface):
        assert share(panel, palette.MARK) > 0.0003
    for h in ("#440154", "#fde725"):  # the ends of viridis
        assert share(support, h) > 0.005
    assert not np.all(surface[..., 0] == surface[..., 2])


def test_normals_without_samples_are_grey(tmp_path: Path) -> None:
    surface = gm.surfaces.elliptic_paraboloid()
    samples = plotted(surface, tmp_path / "a.png", gm.fibonacci(300), cells=(16, 16))
    assert 0 < len(samples) < 150
    left = picture(tmp_path / "a.png")[:, :560]
    assert share(left, palette.NO_SAMPLE) > 0.005
    assert share(left, palette.HYPERBOLIC) < 0.0001


@pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")
def test_terrain() -> None:
    x, y = np.meshgrid(np.linspace(-2, 2, 30), np.linspace(-2, 2, 20))
    hill = gm.Surface.from_grid(np.exp(-x * x - y * y), spacing=(100.0, 100.0))
    labels = texts(gm.sample(hill, 100).plot())
    assert "z (exaggerated 500×)" in labels
    assert any("10^{-" in label and "length²" in label for label in labels)


def test_what_is_written(tmp_path: Path) -> None:
    waves = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, 0.3 * np.sin(3 * u) * v], axis=-1),
        ((-1, 1), (-1, 1)),
        name="$x$ and\nsome 中文\udc80\x1b" + 100 * "x",
    )
    figure = gm.sample(waves, 100).plot()
    write_figure(figure, tmp_path / "a.png")  # without a warning of letters that a font lacks
    labels = texts(figure)
    assert {"x", "y", "z"} <= labels
    (name,) = (label for label in labels if label.startswith("$x$ and some 中文"))
    assert name.startswith(r"$x$ and some 中文\udc80\x1bxxx")
    assert 80 <= len(name) <= 90
    assert any("on the unit sphere" in label for label in labels)
    assert any("samples visible" in label for label in labels)
    assert any(label.startswith("filling gaps (") for label in labels)
    assert any(label.startswith("prescribed (") for label in labels)
    assert "Gaussian curvature $K$ (1/length²)" in labels


@pytest.mark.parametrize("suffix", [".pdf", ".svg", ".PNG"])
@pytest.mark.quick_for(".svg")
def test_other_suffixes_and_equal_bytes(suffix: str, tmp_path: Path) -> None:
    for name in ("a", "b"):
        plotted(gm.surfaces.plane(), tmp_path / f"{name}{suffix}", count=100)
    content = (tmp_path / f"a{suffix}").read_bytes()
    assert content == (tmp_path / f"b{suffix}").read_bytes()
    assert content.startswith({".pdf": b"%PDF", ".svg": b"<?xml", ".PNG": b"\x89PNG"}[suffix])
    if suffix == ".svg":
        assert ElementTree.fromstring(content).tag.endswith("svg")


# ── Errors ───────────────────────────────────────────────────────────────────────────────────────


def test_nothing_half_written(torus, tmp_path, monkeypatch):
    path = tmp_path / "a.png"
    path.write_text("old")

    def half(figure: Figure, path: Path, **_: object) -> None:
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr(Figure, "savefig", half)
    with pytest.raises(KeyboardInterrupt):
        plotted(torus, path, count=50)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("a.png", "old")]


def test_samples_that_no_normal_gave(tmp_path: Path) -> None:
    drawn = plotted(gm.surfaces.plane(), tmp_path / "a.png", count=50, cells=(8, 8))
    assert set(drawn.kind) <= {"filling", "grid"}
    assert picture(tmp_path / "a.png").shape == SIZE


def test_fields_that_pictures_need() -> None:
    spline, normals = gm.fit(gm.surfaces.torus(), (12, 8)), gm.icosphere(6)
    samples = gm.sample(spline, normals=normals, fields=("points",))
    with pytest.raises(gm.errors.MissingFieldError, match="add 'normal_index' to the fields"):
        samples.plot(normals=normals)


def test_surfaces_of_several_pieces(tmp_path: Path) -> None:
    x, y = np.meshgrid(np.arange(3.0), np.arange(5.0), indexing="ij")
    points = np.stack([x, y, (x == 1.0) + 1.0 * (y % 2.0)], axis=2)
    knots = [0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 2, 2, 2]
    surface = gm.Surface.from_nurbs((2, 2), knots, points)
    assert len(surface.pieces()) == 2
    path = tmp_path / "a.png"
    samples = plotted(surface, path, count=100, cells=(24, 24))
    assert len(samples) == 100
    assert path.stat().st_size > 10_000


def test_no_samples(torus: gm.Spline) -> None:
    refused("no samples to draw", gm.sample(torus, normals=[[0, 0, 1]])[:0].plot)


def test_command_line(tmp_path, capsys, main):
    path = tmp_path / "a.png"
    assert main(["plot", "plane", "--count", "50", "--cells", "8", "8", "-o", str(path)]) == 0
    out, err = capsys.readouterr()
    assert re.match(rf"{path}: 50 samples ", out)
    assert err == ""


def test_the_picture_of_a_gauss_map_has_its_folds_and_cusps(parts: ModuleType) -> None:
    texts = ("u", "v", "u**4/2 + u**2*v - v**2")  # a fold with a cusp at (0, 0)
    bay = gm.GaussMap(gm.Surface.from_sympy(texts, ("u", "v"), ((-1, 1), (-1, 1))))
    (fold,) = bay.folds()
    surface, sphere = bay.plot(view=(45, -60)).axes
    surface.figure.canvas.draw()
    assert surface.xaxis.label.get_window_extent().y0 > 0.0  # inside of the figure
    of_surface: Any = surface.lines
    drawn = [np.stack(x.get_data_3d()[:2], axis=1) for x in of_surface]
    assert sum(len(x) == len(fold.points) for x in drawn) == 1
    (cusp,) = (x for x in drawn if len(x) == 1)
    np.testing.assert_allclose(cusp, [[0.0, 0.0]], atol=1e-8)
    cusps = [x for x in sphere.lines if x.get_marker() == "o"]
    assert sum(np.size(x.get_xdata()) for x in cusps) == 1
    assert surface.figure.texts[0].get_text() == "1 fold with 1 cusp"
    refused("are for surfaces, not for parts", gm.GaussMap(parts.box()).plot)


# --- texts in pictures ----------------------------------------------------------------------------


def test_units_are_those_of_the_part(parts: ModuleType) -> None:
    part = parts.all_kinds()
    found = texts(gm.plot(part, gm.sample(part, 200)))
    assert {f"{x} (mm)" for x in "xyz"} <= found
    assert any(x.endswith("/mm²)") for x in found)
    assert any(x.startswith("support (") and x.endswith("mm)") for x in found)
    assert not any("length" in x for x in found)


def test_faces_have_colours_and_the_numbers_of_the_file(parts: ModuleType) -> None:
    part = parts.all_kinds().select(index=[1, 4, 8])
    figure = gm.plot(part, gm.sample(part, 200), color="face_index")
    bars = [x for x in figure.axes if x.get_xlabel() == "face in the file"]
    assert [[t.get_text() for t in x.get_xticklabels()] for x in bars] == [["1", "4", "8"]]
    (drawn,) = [x for x in figure.axes[0].collections if x.get_array() is not None]
    assert len({*map(tuple, drawn.to_rgba(np.asarray(drawn.get_array())))}) == 3


def test_numbers_of_the_file_are_written_on_visible_faces(parts: ModuleType) -> None:
    part = parts.box().select(index=[1, 3, 5])
    figure = gm.plot(part, gm.sample(part, 60), view=(30, 30), face_numbers=True)
    assert {t.get_text() for t in figure.axes[0].texts} == {"1", "3", "5"}
    below = gm.plot(parts.box(), gm.sample(parts.box(), 60), view=(-30, 210), face_numbers=True)
    assert {t.get_text() for t in below.axes[0].texts} == {"0", "2", "4"}
    refused("only the faces of a CAD part", gm.sample("torus", 20).plot, face_numbers=True)


def test_of_many_faces_some_have_their_number() -> None:
    shift = np.zeros((4, 4))
    shift[0, 3] = 3.0
    part = gm.Part([gm.surfaces.plane().transformed(np.eye(4) + k * shift) for k in range(13)])
    figure = gm.plot(part, gm.sample(part, 300), color="face_index")
    (bar,) = [x for x in figure.axes if x.get_xlabel() == "face in the file"]
    labels = [int(t.get_text()) for t in bar.get_xticklabels()]
    assert labels == [*range(0, 13, 2)]


def drawn_boxes(items: list[Any]) -> list[Any]:
    return [x.get_window_extent() for x in items if x.get_text() and x.get_visible()]


@pytest.mark.parametrize(
    "surface",
    [
        gm.surfaces.torus().transformed(np.diag([1.0, 1.0, 30.0])),
        gm.surfaces.torus().transformed(np.diag([25.0, 1.0, 1.0])),
        gm.surfaces.wavy_graph().transformed(
            np.array([[9e3, 0, 0, 5e5], [0, 9e3, 0, 4.1e6], [0, 0, 300, 912.3456], [0, 0, 0, 1.0]])
        ),
    ],
    ids=["high", "long", "far"],
)
def test_labels_of_ticks_do_not_overlap(surface: gm.Surface) -> None:
    figure = gm.plot(surface, gm.sample(surface, 200, cells=(16, 16)))
    figure.canvas.draw()
    axes: Any = figure.axes[0]
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        labels = [x.label1 for x in axis.majorTicks]  # as drawn
        assert 0 < max(len(x.get_text()) for x in labels) <= 7
        assert axis.get_offset_text().get_text() == ""
        for one, other in combinations(drawn_boxes(labels), 2):
            assert not one.overlaps(other)


@pytest.mark.parametrize("normals", [gm.icosphere(4), gm.icosphere(12)])
def test_the_legend_is_inside_of_the_figure(normals: np.ndarray) -> None:
    """It has up to four lines: with prescribed normals that have no sample."""
    samples = gm.sample("monkey_saddle", normals=normals, density="balanced")
    figure = gm.plot("monkey_saddle", samples, normals=normals)
    figure.canvas.draw()
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 4
    box, whole = legend.get_window_extent(), figure.bbox
    assert box.x0 >= whole.x0
    assert box.y0 >= whole.y0
    assert box.x1 <= whole.x1


# --- `gm.plot` and `samples.plot`: figures from Python --------------------------------------------


@pytest.fixture(scope="module")
def samples() -> gm.Samples:
    return gm.sample(gm.fit(gm.surfaces.torus(), cells=(16, 16)), 300)


def drawn(figure: Figure) -> np.ndarray:
    """Return the values of the visible samples, that the colours show."""
    (dots,) = figure.findobj(Path3DCollection)
    return np.asarray(dots.get_array())  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.slow
def test_notebooks_show_it(samples: gm.Samples) -> None:
    content = samples.plot()._repr_png_()  # pyright: ignore[reportAttributeAccessIssue]
    assert image.imread(BytesIO(content)).shape == (920, 1800, 4)


@pytest.mark.parametrize(
    ("color", "label"),
    [("support", "support (length)"), ("mean_curvature", "mean curvature (1/length²)"),
     ("nz", "nz")],
)  # fmt: skip
@pytest.mark.quick_for("nz")
def test_colours_by_a_column(color: str, label: str, samples: gm.Samples) -> None:
    figure = samples.plot(color=color)
    assert label.replace("1/length²", "1/length") in texts(figure)
    arrays = {"nz": samples.normals[:, 2]}
    values = arrays[color] if color in arrays else getattr(samples, color)
    assert np.isin(drawn(figure), values).all()


def test_colours_by_an_array(samples: gm.Samples) -> None:
    values = np.arange(len(samples))
    assert np.isin(drawn(samples.plot(color=values)), values).all()
    refused("a number for each of the 300 samples", samples.plot, color=values[:5])


def test_the_view_decides_what_is_visible(samples: gm.Samples) -> None:
    above = drawn(samples.plot(color="nz", view=(90, 0)))
    below = drawn(samples.plot(color="nz", view=(-90, 0)))
    assert above.min() > -0.2
    assert below.max() < 0.2
    np.testing.assert_allclose(view(90, 0)[2], [0, 0, 1], atol=1e-12)


def test_axes_of_ones_own(samples: gm.Samples) -> None:
    figure = Figure()
    solid, flat = figure.add_subplot(1, 2, 1, projection="3d"), figure.add_subplot(1, 2, 2)
    assert samples.plot(axes=solid) is figure
    assert len(flat.collections) == 0
    assert samples.plot(axes=(solid, flat)) is figure
    assert len(flat.collections) > 2
    assert len(figure.axes) == 2
    for bad in (flat, (solid, solid), (), (solid, flat, flat), (1,)):
        refused("axes must be three-dimensional", samples.plot, axes=bad)


@pytest.mark.slow
def test_normals_without_samples(samples: gm.Samples) -> None:
    found = gm.sample("elliptic_paraboloid", normals=gm.icosphere(4), cells=(16, 16))
    assert not any("no sample" in x for x in texts(found.plot()))
    assert any("no sample" in x for x in texts(found.plot(normals=gm.icosphere(4))))
    refused("too few normals", samples.plot, normals=[[0, 0, 1]])


def test_an_offset_is_drawn_where_it_is(samples: gm.Samples) -> None:
    figure = samples.offset(0.2).plot(color="nz", view=(90, 0))
    assert len(drawn(figure)) > 100
    low, high = figure.axes[0].get_xlim()
    assert high - low == pytest.approx(2 * 1.55, rel=0.02)


@pytest.mark.parametrize(("radius", "folds"), [(0.5, False), (-2.0, True)])
def test_sums_are_drawn_on_their_mesh(radius: float, folds: bool) -> None:
    given = gm.SupportFunction.from_sympy
    body = given("sqrt(n_x**2 + 4*n_y**2 + 9*n_z**2)")
    sums = gm.convolve(body, given("1").offset(radius - 1), gm.icosphere(4))
    seen = drawn(sums.plot(color="nz", view=(90, 0)))
    assert len(seen) == len(sums) if folds else 60 < len(seen) < 120
    assert folds or seen.min() > -0.5


def test_by_default_samples_are_made() -> None:
    figure = gm.plot("sphere")
    assert any(x.startswith("2,000 samples") for x in texts(figure))


def test_samples_of_parts(parts: ModuleType) -> None:
    part = parts.box()
    found = gm.sample(part, 200, edges=True)
    away = np.sort(np.abs(found.points[:, None] - part.bounds).reshape(-1, 6))[:, 1] > 0.1
    figure = found[away].plot(color="face_index")
    assert len(np.unique(drawn(figure))) == 3  # of six sides
    assert any("samples visible" in x for x in texts(figure))
    assert len(drawn(gm.plot(part, found[away]))) == len(drawn(figure))


def test_borders_of_faces_are_as_fine_as_their_meshes(parts: ModuleType) -> None:
    """The second face is a cylinder of radius 1, on which parameters are lengths."""
    scene = scene_of(parts.all_kinds())
    steps = np.linalg.norm(np.diff(scene.lines[1], axis=0), axis=1)
    mesh = 0.8 / 40  # of the parameters
    assert 0.5 * mesh < steps.max() < mesh


@pytest.mark.parametrize("is_reversed", [False, True])
@pytest.mark.parametrize("beyond", [6e-5, 1e-2])
def test_loops_that_leave_the_surface(beyond: float, is_reversed: bool, parts: ModuleType) -> None:
    """Open CASCADE's trims leave the domains of their NURBS by its tolerance."""
    knots, ends = np.array([0.0, 0.0, 1.0, 1.0]), (-beyond, 1.0 + beyond)
    points = np.array([[(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)], [(1.0, 0.0, 0.0), (1.0, 1.0, 1.0)]])
    angles = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    circle = 0.5 + (0.5 + beyond) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    saddle = parts.Geometry("nurbs", net=parts.Net((1, 1), (knots, knots), points))
    face = parts.FaceRecord(saddle, (ends, ends), loops=[circle], reversed=is_reversed, area=0.8)
    scene = scene_of(parts.part_of(parts.PartRecord("saddle", "mm", 1e-3, False, [face])))
    corners = scene.quadrangles.reshape(-1, 3)
    assert len(scene.lines) == 1
    for found in (corners, *scene.lines):
        np.testing.assert_allclose(found[:, 2], found[:, 0] * found[:, 1], atol=1e-12)
        np.testing.assert_allclose(found.min(axis=0)[:2], 0.0, atol=1e-12)
        np.testing.assert_allclose(found.max(axis=0)[:2], 1.0, atol=1e-12)


def test_errors(samples: gm.Samples, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        gm.errors.UnknownNameError, match="no column 'suport'; did you mean support"
    ):
        samples.plot(color="suport")
    refused("view", samples.plot, view=(1, 2, 3))
    refused("samples must be Samples", gm.plot, "sphere", 5)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    refused(r'pip install "gaussmap\[plot\]"', samples.plot, error=gm.errors.MissingExtraError)
