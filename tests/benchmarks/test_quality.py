"""What `make quality` judges by: ways, criteria and page, without the packages of the peers."""

import dataclasses
from itertools import pairwise

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import FORMS, Torus
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.benchmarks.peers.peer import Peer, Turns
from gaussmap.benchmarks.peers.untuned import UNTUNED
from gaussmap.benchmarks.quality import criteria, measure, page, ways
from gaussmap.benchmarks.quality.measure import Found, OnSurface

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
@pytest.mark.parametrize("way", [ways.GAUSS, ways.BALANCED, ways.RELAXED[0], ways.UNIFORM])
def test_ways_of_gaussmap(way):
    points, normals = way.prepare(Torus(), 300)()
    assert points.shape == normals.shape == (len(points), 3)
    assert len(points) == pytest.approx(300, rel=0.05)


def test_every_way_stands_in_the_table_once():
    assert len({x.title for x in ways.WAYS}) == len(ways.WAYS)
    judged = {x for c in criteria.CRITERIA for x in (c.own, c.other)}
    assert judged <= set(ways.WAYS)


# --- measuring ------------------------------------------------------------------------------------


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(measure, "nearest_by_tree", nearest)
    monkeypatch.setattr(measure, "COUNTS", (200, 400))
    monkeypatch.setattr(measure, "LARGE", 800)
    monkeypatch.setattr(measure, "FEASIBLE", np.inf)  # however slow the machine is
    monkeypatch.setattr(measure.Places, "of", lambda form, of=Places.of: of(form, 300))


@pytest.mark.compiled
def test_a_surface_is_measured(few):
    gone = Peer("gone", "", "no_such_package_here", ways.perfect, 0)
    told = []
    on = measure.measured(Torus(), (ways.PERFECT, ways.BALANCED, gone), told.append)
    assert set(on.found) == {(x, n) for x in (ways.PERFECT, ways.BALANCED) for n in (200, 400)}
    assert set(on.large) == {ways.PERFECT, ways.BALANCED}
    assert "no_such_package_here" in on.missing[gone]
    assert [x.partition(": ")[2] for x in told] == [ways.PERFECT.title, ways.BALANCED.title, "gone"]
    assert {x.times for (way, _), x in on.found.items() if way is ways.BALANCED} == {1.0}


@pytest.mark.compiled
def test_what_takes_too_long_is_not_asked_for_many(few, monkeypatch):
    monkeypatch.setattr(measure, "FEASIBLE", 0.0)
    assert measure.measured(Torus(), (ways.PERFECT,), str).large == {}


def test_random_points_are_judged_by_the_median(monkeypatch):
    """Three clouds with E = 1, 9, 4 and G = 5, 2, 3; two thirds of the points that were asked."""
    errors = iter([(1.0, 5.0), (9.0, 2.0), (4.0, 3.0)])
    cloud = np.zeros((200, 3))
    way = dataclasses.replace(ways.POISSON[0], prepare=lambda form, n: lambda: (cloud, cloud))
    monkeypatch.setattr(measure, "POISSON", (way,))
    monkeypatch.setattr(measure, "both", lambda *_: next(errors))
    monkeypatch.setattr(
        measure,
        "in_turns",
        lambda work, others, rounds: Turns(0.5, 200, dict.fromkeys(others, 8.0)),
    )
    found = measure.found(Torus(), Places.of(Torus(), 10), way, 300)
    assert found == Found(200, 4.0, 3.0, 400.0, 12.0)


# --- criteria -------------------------------------------------------------------------------------


def of(E, G, times=1.0):
    return Found(1_000, E, G, 1e5, times)


def surface(found, missing=()):
    """A surface where each way found the same for both counts."""
    both = {(way, n): x for way, x in found.items() for n in measure.COUNTS}
    return OnSurface(Torus(), both, {}, dict.fromkeys(missing, "No module named 'x'"))


@pytest.mark.parametrize(
    ("limit", "strict", "at_least", "good", "bad", "target"),
    [
        (1.05, False, False, 1.05, 1.0501, "≤ 1.05"),
        (1.0, True, False, 0.999, 1.0, "< 1"),
        (20.0, False, True, 20.0, 19.9, "≥ 20"),
    ],
)
def test_limits(limit, strict, at_least, good, bad, target):
    criterion = criteria.Criterion(
        "x", ways.GAUSS, ways.PERFECT, criteria.of_E, limit, strict, at_least
    )
    assert criterion.met(good)
    assert not criterion.met(bad)
    assert criterion.target == target


def test_each_criterion_compares_what_its_title_says():
    """Values that are all different: E = 2, 3, 5 … and G = 20, 30, 50 …"""
    relaxed = ways.RELAXED[criteria.JUDGED_STEPS - 1]
    numbers = {
        ways.GAUSS: of(2, 20), ways.PERFECT: of(3, 30), relaxed: of(5, 50), ways.GMSH: of(7, 70),
        ways.BALANCED: of(11, 110),
        ways.POISSON[0]: of(13, 130, 17), ways.POISSON[1]: of(19, 190, 23),
    }  # fmt: skip
    on = surface(numbers)
    found = {x.title: criteria.verdicts(x, on, measure.COUNTS)[1].value for x in criteria.CRITERIA}
    assert found == {
        "gauss : exact, G": 20 / 30,
        "relaxed : Gmsh, G": 50 / 70,
        "relaxed : Gmsh, E": 5 / 7,
        "goal: relaxed : Gmsh, E": 5 / 7,
        "balanced : Open3D, E": 11 / 13,
        "balanced : Open3D, G": 110 / 130,
        "balanced : Open3D, speed": 17,
        "balanced : PyMeshLab, E": 11 / 19,
        "balanced : PyMeshLab, G": 110 / 190,
        "balanced : PyMeshLab, speed": 23,
    }


def test_what_is_missing_is_neither_met_nor_not():
    on = surface({ways.RELAXED[criteria.JUDGED_STEPS - 1]: of(1, 1)}, missing=(ways.GMSH,))
    found = criteria.verdicts(criteria.CRITERIA[1], on, measure.COUNTS)
    assert [x.met for x in found] == [None, None]
    assert criteria.share(found) == "0 of 0"


def test_the_worst_is_farthest_from_the_target():
    """Speeds shall be large, errors small; what is missing is never the worst."""
    found = [
        criteria.verdicts(x, on, measure.COUNTS)[0]
        for x in criteria.CRITERIA
        if x.title in ("balanced : Open3D, E", "balanced : Open3D, speed")
        for on in (
            surface({ways.BALANCED: of(2, 1), ways.POISSON[0]: of(4, 1, 30)}),
            surface({ways.BALANCED: of(3, 1), ways.POISSON[0]: of(4, 1, 40)}),
            surface({ways.BALANCED: of(3, 1)}),
        )
    ]
    assert criteria.worst(found[:3]) is found[1]
    assert criteria.worst(found[3:]) is found[3]
    assert criteria.worst(found[2:3]).value is None


# --- the page -------------------------------------------------------------------------------------


@pytest.fixture
def text():
    found = {way: of(3.0, 2.0, 19.96) for way in ways.WAYS}
    found[ways.GAUSS] = of(3.0, 2.12)
    first = surface(found)
    first.large[ways.BALANCED] = (1.23e6, 1.0)
    del found[ways.GMSH]
    return page.page([first, surface(found, missing=(ways.GMSH,))], ways.WAYS)


def test_tables_are_whole(text):
    assert text.count("\n| :--") == 1 + 2
    width = 0
    for line, after in pairwise(text.splitlines()):
        if after.startswith("| :--"):
            width = line.count("|")
        assert line.count("|") in (0, width)


def test_the_page_says_what_is_met(text):
    rows = {x.partition(" |")[0][2:]: x for x in text.splitlines() if x.startswith("| ")}
    failed = "1.060 **not met**, 1.060 **not met**"
    assert rows["gauss : exact, G"].endswith(f"| ≤ 1.05 | {failed} | {failed} | 1.060 | 0 of 4 |")
    assert rows["relaxed : Gmsh, E"].endswith(
        "| 1.000 met, 1.000 met | missing, missing | 1.000 | 2 of 2 |"
    )
    assert "| 20 × **not met**" in rows["balanced : Open3D, speed"]  # 19.96


def test_every_way_is_shown_and_the_missing_ones_say_why(text):
    for way in ways.WAYS:
        assert text.count(f"\n| {way.title} |") == 2
    assert f"| {ways.GMSH.title} | missing: No module named 'x' | –" in text
    assert "| 1.2e6 | 1 × |" in text
