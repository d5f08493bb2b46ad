import re
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures import palette
from gaussmap.tools.pictures.plot import write_figure
from matplotlib import colors, image
from matplotlib.figure import Figure

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
