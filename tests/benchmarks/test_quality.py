"""What `make quality` judges by: surfaces, ways and page, without the peers."""

# pyright: reportAttributeAccessIssue=false, reportArgumentType=false

from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import Torus
from gaussmap.benchmarks.peers.metrics import Errors, Places, nearest_by_tree
from gaussmap.benchmarks.peers.peer import Peer, Turns
from gaussmap.benchmarks.peers.untuned import UNTUNED
from gaussmap.benchmarks.quality import measure, meshers, surfaces, ways
from gaussmap.benchmarks.quality.opening import opening

ROOT = Path(__file__).parents[2]


# --- ways -----------------------------------------------------------------------------------------


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
    twins = nearest_by_tree(exact, found.points)
    off = np.linalg.norm(exact[twins] - found.points, axis=1)
    assert np.median(off) < 1e-3


# --- surfaces -------------------------------------------------------------------------------------


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
    monkeypatch.setattr(measure, "COUNTS", (200, 400))
    monkeypatch.setattr(measure, "LAST", 400)
    monkeypatch.setattr(measure.Places, "of", lambda form, of=Places.of: of(form, 300))
    monkeypatch.setattr(measure, "quality", lambda form, places, mesh: mesh)


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


# --- the page -------------------------------------------------------------------------------------


def test_the_page_in_docs_opens_with_its_own_figures():
    text = (ROOT / "docs" / "quality.md").read_text(encoding="utf-8")
    assert opening(text) in text
