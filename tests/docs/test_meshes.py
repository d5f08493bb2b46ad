"""The measurements of docs/meshes.py against theory, and its page against a fresh run."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import FORMS, Torus
from gaussmap.benchmarks.peers.mesh_metrics import quality, to_surface
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.docs import meshes

pytestmark = [pytest.mark.compiled, pytest.mark.slow]

PAGE = (Path(meshes.__file__).parent / "meshes.md").read_text(encoding="utf-8")
EACH = pytest.mark.parametrize("form", FORMS, ids=lambda x: x.name)
DIGITS = 0.006  # relative: a number with three digits is off by half of the last one


def rows(form, title):
    """Return the numbers of the rows of a title in the committed table of a form."""
    section = PAGE.split(f"## {form.label}\n")[1].split("\n## ")[0]
    lines = [x.split(" | ") for x in section.splitlines() if x.startswith(f"| {title} |")]
    return [[float(cell.strip(" |").replace(",", "")) for cell in line[1:]] for line in lines]


@EACH
@pytest.mark.parametrize(
    "title", [meshes.OWN, meshes.NORMALS, meshes.DELAUNAY, "grid of parameters"]
)
def test_committed_numbers_are_those_of_a_fresh_run(form, title):
    pytest.importorskip("pyvista")
    places = Places.of(form, meshes.PLACES)
    mesh = meshes.MESHERS[title](form, meshes.COUNTS[0])
    found = meshes.row(title, quality(form, places, mesh))
    fresh = [float(cell.replace(",", "")) for cell in found[1:]]
    np.testing.assert_allclose(fresh, rows(form, title)[0], rtol=2 * DIGITS, atol=0.051)
    assert fresh[1:3] == pytest.approx(rows(form, title)[0][1:3], rel=2 * DIGITS)


@EACH
def test_every_mesh_is_there_with_about_as_many_vertices(form):
    for title in meshes.MESHERS:
        counts = [row[0] for row in rows(form, title)]
        np.testing.assert_allclose(counts, meshes.COUNTS, rtol=0.04)


def test_a_grid_on_the_torus_is_off_by_what_theory_says():
    """Chords of the tube, of m sides, and of the outer circle, of n: R (1 − cos π/n) and so on."""
    pytest.importorskip("pyvista")
    form = Torus()
    found = quality(form, Places.of(form, 20_000), meshes.by_grid(form, 2_000))
    n = math.isqrt(found.vertices)
    tube = form.minor * (1 - math.cos(math.pi / n))
    ring = (form.major + form.minor) * (1 - math.cos(math.pi / n))
    # in the middle of a diagonal both add up, to the order of the next power of 1/n
    for distance in (found.to_mesh, found.to_surface):
        assert distance == pytest.approx(tube + ring, rel=0.03)


def test_distances_from_the_torus_are_exact():
    form = Torus()
    rng = np.random.default_rng(1)
    u, v = rng.uniform(-np.pi, np.pi, (2, 500))
    points, normals = form.evaluate(u, v)
    away = rng.uniform(-0.1, 0.1, 500)
    found = to_surface(form, points + away[:, None] * normals)
    np.testing.assert_allclose(found, np.abs(away), rtol=0, atol=1e-14)


def test_beyond_a_border_the_border_is_nearest():
    form = FORMS[2]
    points = np.array([[1.1, 0.2, 0.2 * np.sin(3) * np.cos(0.6)]])
    ends = form.evaluate(np.array([1.0]), np.linspace(-1, 1, 200_001))[0]
    nearest = np.linalg.norm(ends - points, axis=1).min()
    assert to_surface(form, points)[0] == pytest.approx(nearest, rel=1e-9)


def test_flips_never_make_the_worst_angle_larger():
    for form in FORMS:
        for own, before in zip(
            rows(form, meshes.NORMALS), rows(form, meshes.DELAUNAY), strict=True
        ):
            assert own[3] <= before[3]


def test_shapes_are_as_promised():
    """95 % of the smallest angles are 25° at least, one in a thousand is below 5° at most."""
    section = PAGE.split("## Shapes of triangles\n")[1].split("\n## ")[0]
    found = [x.strip("| ").split(" | ") for x in section.splitlines() if " | shape | " in x]
    assert [x[0] for x in found] == ["torus", "cylinder", "sphere", "boss", "terrain"]
    for line in found:
        assert float(line[6]) >= 25.0
        assert max(float(line[5]), float(line[7])) <= 1.0


def test_times_are_there():
    section = PAGE.split("## Time\n")[1]
    for form in FORMS:
        assert re.search(rf"^\| {form.name} \|( [\d.e-]+ \|){{3}}$", section, re.MULTILINE)
