"""`gm.plot` and `samples.plot`: figures from Python."""

import importlib.util
from io import BytesIO
from types import ModuleType

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.scene import scene_of, view
from matplotlib import image
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Path3DCollection

from ...refusals import refused
from .made import texts


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
