"""The page on rows along lines of curvature: its constants on surfaces, and the page itself."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import FORMS
from gaussmap.docs import alignment, alignment_cells
from gaussmap.docs.alignment_cells import CELLS, SPOTS, Spot

PAGE = Path(alignment.__file__).with_suffix(".md").read_text(encoding="utf-8")


def rows(title):
    """Return the cells of the rows of a section."""
    section = PAGE.split(f"## {title}")[1].split("\n## ")[0]
    lines = re.findall(r"^\| (.*) \|$", section.replace("\\|", "/"), re.MULTILINE)
    return [line.split(" | ") for line in lines if not line.startswith(":--")]


@pytest.mark.parametrize(("title", "constant", "found", "developable"), CELLS)
def test_cells_of_surfaces_tend_to_those_of_quadratic_patches(title, constant, found, developable):
    """Terms of third order change angles by a part of the size h; here h = 1e-3 and 1e-4."""
    for _, true, at in SPOTS:
        if developable or not true.developable:
            for size in (1e-3, 1e-4):
                value = found(Spot(true, np.array(at)), size)
                assert value == pytest.approx(constant, rel=10 * size)


def test_principal_curvatures_of_the_torus():
    """On the outer equator 1/r and 1/(R + r), with r = 0.35 and R = 1."""
    curvatures, directions = Spot(SPOTS[0][1], np.array([0.2, 0.0])).principal
    assert np.abs(curvatures) == pytest.approx([1 / 0.35, 1 / 1.35])
    across, along = directions.T * 2 * math.pi * np.array([1.35, 0.35])
    assert np.abs(across) == pytest.approx([0, 1], abs=1e-12)
    assert np.abs(along) == pytest.approx([1, 0], abs=1e-12)


@pytest.mark.parametrize("rings", [10, 640])
def test_the_lantern_leans_as_schwarz_says(rings):
    """The tangent of the lean is the sagitta 1 − cos(π/n) over the height of a ring.

    Normals at corners turn by π/n to the middle of the side, whose plane leans: the spherical law
    of cosines joins both.
    """
    n = alignment_cells.SIDES
    between, lean = alignment_cells.lantern(rings)
    assert between == pytest.approx(360 / n)
    down = math.atan((1 - math.cos(math.pi / n)) * rings)
    expected = math.acos(math.cos(down) * math.cos(math.pi / n))
    assert math.radians(lean) == pytest.approx(max(expected, down), rel=1e-9)


def test_stretched_triangles_lean_as_their_formula_says():
    """At θ = 0 the corner on the axis has the gradient R, and the plane −(κ₁/κ₂ − 1) R/4."""
    for stretch in (2.0, 30.0):
        found = alignment_cells.leanings(safe=False)(stretch)
        assert found.max() == pytest.approx(1.0 + (stretch - 1.0) / 4.0)
        assert alignment_cells.leanings(safe=True)(stretch).max() == pytest.approx(1.0)


def test_promises_for_the_torus():
    """∫ κ₁² = 4π² R/r and ∫ |K| = 8π; normals turn by 2π along both parameters."""
    found = alignment.Promise.of(FORMS[0])
    scale = math.degrees(1.0) / math.sqrt(alignment.COUNT)
    round_cells = math.sqrt(2 / (3 * math.sqrt(3)))
    expected = (
        round_cells * 2 * math.pi / math.sqrt(0.35), math.sqrt(4 * math.pi),
        math.sqrt(0.5) * 2 * math.pi, round_cells * math.sqrt(8 * math.pi),
    )  # fmt: skip
    promised = found.balanced, found.aligned, found.graded, found.bound
    assert np.array(promised) / scale == pytest.approx(expected, rel=1e-4)


def test_the_committed_constants_are_those_of_a_fresh_run():
    for table in (alignment_cells.cells_table, alignment_cells.lantern_table):
        assert table() in PAGE
    assert alignment_cells.stretched_table() in PAGE


def test_fewer_aligned_samples_give_the_same_worst_angle():
    """On the torus theory promises a share of (√½ 2π)² / (0.62² 4π² / 0.35) = 46 % at least."""
    found = {x[0]: x for x in rows("The same accuracy")[1:]}
    assert set(found) == {"torus", "ellipsoid_patch", "boss", "boss0.3"}
    for name, cells in found.items():
        vertices, fewer = (int(cells[k].replace(",", "")) for k in (2, 5))
        assert fewer < 0.7 * vertices, name
        assert float(cells[4]) <= float(cells[1]) * 1.1, name


@pytest.mark.slow
@pytest.mark.compiled
def test_the_committed_errors_are_those_of_a_fresh_run():
    pytest.importorskip("scipy")
    fresh = alignment.promises([alignment.Measurement.of(FORMS[0])]).splitlines()[-1]
    (committed,) = (x for x in rows("Whole surfaces") if x[0] == "torus")
    for found, expected in zip(fresh.strip("| ").split(" | ")[1:], committed[1:], strict=True):
        assert float(found) == pytest.approx(float(expected), rel=0.02)
