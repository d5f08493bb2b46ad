"""What `make quality` judges by: surfaces, ways and page, without the peers."""

# pyright: reportAttributeAccessIssue=false, reportArgumentType=false

import re
from itertools import pairwise
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import FORMS, Torus
from gaussmap.benchmarks.peers.mesh_metrics import Quality
from gaussmap.benchmarks.peers.metrics import Errors, Places
from gaussmap.benchmarks.peers.peer import Peer, Turns
from gaussmap.benchmarks.peers.untuned import UNTUNED
from gaussmap.benchmarks.quality import (
    measure,
    meshers,
    page,
    surfaces,
    ways,
)
from gaussmap.benchmarks.quality.measure import Found, OnSurface
from gaussmap.benchmarks.quality.opening import beside_gmsh, opening

ROOT = Path(__file__).parents[2]
FORM = pytest.mark.parametrize("form", [*FORMS, *UNTUNED], ids=lambda x: x.name)


def nearest(samples, places):
    """Compare all with all, where SciPy is not installed."""
    return np.linalg.norm(places[:, None] - samples, axis=2).argmin(axis=1)


# --- ways -----------------------------------------------------------------------------------------


@pytest.mark.compiled
@pytest.mark.parametrize("form", [Torus(), UNTUNED[0]], ids=lambda x: x.name)
def test_the_exact_method_takes_the_normals_of_gauss(form):
    """Samples have exact twins: the spline of 64 × 64 cells turns normals by about 5e-4 at most
    (math.md, Sect. 3), which moves a point by that times its radius of curvature, about 1 here.
    """
    exact, normals = ways.perfect(form, 500)()
    found = gm.sample(form.surface, count=500, density="gauss")
    assert len(exact) == pytest.approx(len(found), rel=0.02)  # at a border some are in or out
    asked = ways.normals_of_gauss(form, 500)
    apart = np.linalg.norm(normals[:, None] - asked, axis=2).min(axis=1)
    assert apart.max() < 1e-14
    twins = nearest(exact, found.points)
    off = np.linalg.norm(exact[twins] - found.points, axis=1)
    assert np.median(off) < 1e-3


@FORM
def test_icosahedral_normals_come_near_to_the_count(form):
    """From one refinement to the next the number grows by (2ν + 1)/ν², here at most a quarter."""
    points, _ = ways.icosahedral(form, 1_500)()
    assert len(points) == pytest.approx(1_500, rel=0.125)


@pytest.mark.compiled
@pytest.mark.parametrize("way", ways.DENSITIES)
def test_ways_of_gaussmap(way):
    points, normals = way.prepare(Torus(), 300)()
    assert points.shape == normals.shape == (len(points), 3)
    assert len(points) == pytest.approx(300, rel=0.05)


def test_every_way_stands_in_the_table_once():
    assert len({x.title for x in ways.WAYS}) == len(ways.WAYS)
    assert len({x.title for x in meshers.MESHERS}) == len(meshers.MESHERS)


# --- surfaces -------------------------------------------------------------------------------------


def test_judged_surfaces_have_names_of_their_own():
    assert len({x.name for x in surfaces.JUDGED}) == len(surfaces.JUDGED) >= 10


def test_sheared_parameters_give_the_same_torus():
    torus, sheared = Torus(), surfaces.ShearedTorus(shear=0.25)
    u, v = np.array([0.3, 2.0]), np.array([-1.0, 3.0])
    for found, expected in zip(
        sheared.evaluate(u - 0.25 * v, v), torus.evaluate(u, v), strict=True
    ):
        assert found == pytest.approx(expected, abs=1e-15)
    assert sheared.surface.boundary[1] == ("open", "open")
    assert surfaces.ShearedTorus(shear=1.0).surface.boundary[1] == ("periodic", "periodic")


def test_the_small_fillets():
    small, boss = surfaces.SmallFillets(), UNTUNED[1]
    assert small.fillet == pytest.approx(0.3 * boss.fillet)
    assert small.edge == pytest.approx(0.3 * boss.edge)
    assert (small.plate, small.foot, small.hole) == (boss.plate, boss.foot, boss.hole)


# --- measuring ------------------------------------------------------------------------------------


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(measure, "nearest_by_tree", nearest)
    monkeypatch.setattr(measure, "COUNTS", (200, 400))
    monkeypatch.setattr(measure, "LAST", 400)
    monkeypatch.setattr(measure.Places, "of", lambda form, of=Places.of: of(form, 300))
    monkeypatch.setattr(measure, "quality", lambda form, places, mesh: mesh)


@pytest.mark.compiled
@pytest.mark.slow
def test_a_surface_is_measured(few):
    gone = Peer("gone", "", "no_such_package_here", ways.perfect, 0)
    mesher = meshers.Mesher("mesh", ways.PERFECT, lambda form, count: count)
    no_mesher = meshers.Mesher("no mesh", gone, mesher.mesh)
    told = []
    on = measure.measured(
        Torus(), (ways.PERFECT, ways.BALANCED, gone), (mesher, no_mesher), told.append
    )
    assert set(on.found) == {(x, n) for x in (ways.PERFECT, ways.BALANCED) for n in (200, 400)}
    assert on.meshes == {mesher: 400}
    assert all("no_such_package_here" in on.missing[x] for x in (gone, no_mesher))
    assert [x.partition(": ")[2] for x in told] == [
        ways.PERFECT.title, ways.BALANCED.title, "gone", "mesh, mesh", "mesh, no mesh",
    ]  # fmt: skip
    assert {key for key, x in on.found.items() if x.times > 0.0} == {(ways.PERFECT, 400)}


@pytest.mark.compiled
def test_without_a_closed_form_a_way_is_missing(few):
    way = Peer("inverse", "", "numpy", lambda form, count: form.preimages(np.zeros((1, 3))), 0)
    on = measure.measured(surfaces.Hills(), (way,), (), str)
    assert on.found == {}
    assert "no closed form" in on.missing[way]


@pytest.mark.parametrize(("random", "E"), [(True, 4), (False, 1)])
def test_random_points_are_judged_by_the_median(monkeypatch, random, E):
    """Three clouds with E = 1, 9, 4 in half a second each; two thirds of the points asked."""
    every = iter([Errors(1, 1, 5, 7, 1), Errors(9, 2, 2, 8, 1), Errors(4, 6, 3, 9, 1)])
    cloud = np.zeros((200, 3))
    way = Peer("random", "", "numpy", lambda form, n: lambda: (cloud, cloud), 0)
    monkeypatch.setattr(measure, "POISSON", (way,) if random else ())
    monkeypatch.setattr(measure, "errors", lambda *_: next(every))
    monkeypatch.setattr(measure, "LAST", 300)

    def turns(work, others, rounds):
        for _ in range(rounds):
            work()
        return Turns(0.5, 200, dict.fromkeys(others, 8.0))

    monkeypatch.setattr(measure, "in_turns", turns)
    found = measure.found(Torus(), Places.of(Torus(), 10), way, 300)
    assert found.errors.E == E
    assert found.errors == (Errors(4, 2, 3, 8, 1) if random else Errors(1, 1, 5, 7, 1))
    assert (found.points, found.rate, found.times) == (200, 400.0, 12.0)


@pytest.mark.compiled
def test_meshes_have_the_vertices_that_were_asked():
    """Points on open borders are among them."""
    vertices, triangles = meshers.through("uniform", "normals")(UNTUNED[0], 1_000)
    assert len(vertices) == pytest.approx(1_000, rel=0.04)
    assert len(np.unique(triangles)) == len(vertices)


# --- the page -------------------------------------------------------------------------------------


def of(E, G, times=1.0, mean=1.0):
    return Found(1_000, Errors(E, mean, G, 0.1 * E, 0.01 * E), 1e5, times)


def mesh(worst):
    return Quality(1_000, 0.01 * worst, 0.02 * worst, worst, 0.5 * worst, 30.0)


def surface(found, meshes=(), missing=(), form=UNTUNED[1]):
    """A surface where each way found the same for both counts."""
    both = {(way, n): x for way, x in found.items() for n in measure.COUNTS}
    return OnSurface(form, both, dict(meshes), dict.fromkeys(missing, "No module 'x'"))


@pytest.fixture
def text():
    found = {way: of(3.0, 2.0, 19.96) for way in ways.WAYS}
    found[ways.GAUSS] = of(3.0, 2.12)
    meshes = {x: mesh(2.0) for x in meshers.MESHERS}
    first = surface(found, meshes)
    del found[ways.GMSH]
    return page.page([first, surface(found, meshes, missing=(ways.GMSH,))], load=0.9)


def test_tables_are_whole(text):
    assert text.count("\n| :--") == 2 + 2 * 2
    width = 0
    for line, after in pairwise(text.splitlines()):
        if after.startswith("| :--"):
            width = line.count("|")
        assert line.count("|") in (0, width)


def test_the_page_opens_with_who_wins_and_ends_with_the_machine(text):
    titles = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert titles[:2] == ["Where gaussmap wins, where it does not", "What is measured"]
    assert titles[-1] == "The machine"


def test_the_opening_counts_who_is_best():
    def table(own: float, other: float, aligned: float) -> str:
        return (
            "| a | E | mean E | G | gap | plane | balanced |\n| :-- | --: |\n"
            f"| **balanced** | {own} | 1 | {own} | 2 | 1 | – |\n"
            f"| **aligned** | {aligned} | 1 | {aligned} | 2 | 1 | 1 × |\n"
            f"| **gauss** | 0 | 0 | 0 | 0 | 0 | – |\n"
            f"| Gmsh, x | {other} | 1 | {other} | 1 | 1 | 1 × |\n"
            "| Open3D, Poisson disk | 9 | 9 | 9 | 9 | 9 | 0.5 × |\n"
        )

    meshes = "| mesh | worst angle | mean angle | Hausdorff distance |\n| :-- | --: |\n"
    meshes += '| **balanced**, prefer="normals" | 1 | 1 | 1 |\n| Gmsh, x | 2 | 2 | 2 |\n'
    meshes += '| **aligned**, prefer="normals" | 3 | 1 | 1 |\n'
    text = f"## a\n\n{table(1, 2, 4)}\n{meshes}\n## b\n\n{table(3, 2, 6)}\n{meshes}"
    found = opening(text.replace("| a |", "|  |"))
    assert "| E | 1 of 2 | 0.50 to 1.50 | 0 of 2 | 2.00 to 3.00 | Gmsh, x (1) |" in found
    assert "| gap | 0 of 2 | 2.00 to 2.00 | 0 of 2 | 2.00 to 2.00 | Gmsh, x (2) |" in found
    assert "| worst angle | 2 of 2 | 0.50 to 0.50 | 0 of 2 | 1.50 to 1.50 | – |" in found
    assert "others in 4 of 6 comparisons, **aligned** in 0 of 6" in found
    assert "**balanced** is 0.5 times as fast" in found
    assert beside_gmsh(text.replace("| a |", "|  |")) == ""  # not by the size of curvature


def test_densities_beside_gmsh():
    def table(gauss: str, balanced: str, aligned: str) -> str:
        return (
            "|  | E | mean E | G |\n| :-- | --: |\n"
            f"| **balanced** | {balanced} |\n| **aligned** | {aligned} |\n"
            f"| **gauss** | {gauss} |\n| Gmsh, curvature size | 2 | 1 | 2 |\n"
        )

    text = f"## a\n\n{table('4 | 1 | 1', '3 | 1 | 2', '1 | 1 | 1.5')}\n"
    text += f"## b\n\n{table('5 | 1 | 4', '2.2 | 1 | 3', '6 | 1 | 3')}\n"
    found = " ".join(beside_gmsh(text).split())
    assert "its E is 0.50 to 0.50 times that of Gmsh on 1 of 2 surfaces" in found
    assert "E of **balanced**, the default, is 10 to 50 % larger" in found
    assert "over all surfaces it is 1.10 to 1.50 times" in found
    assert "**gauss** has the smallest G on 1 of 2 surfaces" in found
    assert "| a | 4.00 / 1.00 | 3.00 / 2.00 | 1.00 / 1.50 | 2.00 / 2.00 |" in found


def test_the_page_in_docs_opens_with_its_own_figures():
    text = (ROOT / "docs" / "quality.md").read_text(encoding="utf-8")
    assert opening(text) in text


def test_every_way_is_shown_and_the_missing_ones_say_why(text):
    for way in (*ways.WAYS, *meshers.MESHERS):
        assert f"\n| {way.title} |" in text
    assert f"| {ways.GMSH.title} | missing: No module 'x' | –" in text


def test_the_page_says_that_others_were_computing(text):
    assert "a load of 0.9" in text
    assert page.busy(0.1) == page.busy(None) == []
