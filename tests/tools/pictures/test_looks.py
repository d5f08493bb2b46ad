"""What can be read in a picture: units, numbers of faces, labels that do not overlap or are cut."""

from itertools import combinations
from types import ModuleType
from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from .made import texts


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
