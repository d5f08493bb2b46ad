"""What `make bench-peers` measures with: the closed forms, the two metrics, the turns, the page."""

import dataclasses
import math
import re
from pathlib import Path

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.benchmarks.peers import cad, machine, measure, metrics, peer, recipe
from gaussmap.benchmarks.peers.catalogue import RECIPE
from gaussmap.benchmarks.peers.forms import FORMS, Torus, Waves
from gaussmap.benchmarks.peers.mesh_metrics import to_surface
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.benchmarks.peers.metrics import nearest_by_tree as nearest
from gaussmap.benchmarks.peers.opening import opening
from gaussmap.benchmarks.peers.peer import Peer, Turns
from gaussmap.benchmarks.peers.triangles import by_grid, joined
from gaussmap.benchmarks.peers.untuned import Boss
from gaussmap.benchmarks.quality.surfaces import JUDGED

ROOT = Path(__file__).parents[2]
FORM = pytest.mark.parametrize("form", JUDGED, ids=lambda x: x.name)
INVERTED = pytest.mark.parametrize(
    "form", [x for x in JUDGED if x.name != "hills"], ids=lambda x: x.name
)


def places_inside(form, count, margin=1e-3):
    rng = np.random.default_rng(3)
    ends = np.array(form.surface.domain)
    inside = rng.uniform(margin, 1.0 - margin, (2, count))
    return ends[:, :1] + np.diff(ends) * inside


# --- closed forms ---------------------------------------------------------------------------------


@FORM
def test_positions_are_those_of_gaussmap(form):
    u, v = places_inside(form, 100)
    assert form.evaluate(u, v)[0] == pytest.approx(form.surface.evaluate(u, v), abs=1e-15)


@FORM
def test_normals_area_and_curvature(form):
    """Central differences with h = 1e-5 are off by h² and by ε/h times a few derivatives."""
    u, v = places_inside(form, 100)
    h = 1e-5
    (x_u, n_u), (x_v, n_v) = (
        tuple((b - a) / (2 * h) for a, b in zip(low, high, strict=True))
        for low, high in (
            (form.evaluate(u - h, v), form.evaluate(u + h, v)),
            (form.evaluate(u, v - h), form.evaluate(u, v + h)),
        )
    )
    normals = form.evaluate(u, v)[1]
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-15)
    cross = np.cross(x_u, x_v)
    assert cross == pytest.approx(normals * form.area(u, v)[:, None], abs=1e-8)
    image = np.einsum("nx,nx->n", normals, np.cross(n_u, n_v))  # of the Gauss map: K |x_u × x_v|
    assert image == pytest.approx(form.curvature(u, v) * form.area(u, v), abs=1e-7, rel=1e-7)
    assert form.bending(u, v) == pytest.approx(np.abs(image), abs=1e-7, rel=1e-7)


@FORM
def test_parameters_of_points(form):
    u, v = places_inside(form, 100)
    found = np.stack(form.parameters(form.evaluate(u, v)[0]))
    turns = (found - [u, v]) / (2 * math.pi)
    assert turns == pytest.approx(np.round(turns), abs=1e-14)


@INVERTED
def test_points_of_normals(form):
    """Every place comes back from its normal, and nothing comes that has another one.

    Near a parabolic point parameters follow from normals as a root does: there errors of some ε
    become such of √ε, which is 1.5e-8.
    """
    u, v = places_inside(form, 100)
    places = form.parameters(form.evaluate(u, v)[0])  # angles as preimages have them
    bent = np.abs(form.curvature(*places)) > 0.0
    normals = form.evaluate(*places)[1]
    for normal, place in zip(normals[bent], np.stack(places, axis=1)[bent], strict=True):
        found = np.stack(form.preimages(normal[None]), axis=1)
        assert form.evaluate(*found.T)[1] == pytest.approx(
            np.tile(normal, (len(found), 1)), abs=1e-12
        )
        points = form.evaluate(*found.T)[0]
        apart = np.linalg.norm(points - form.evaluate(*place)[0], axis=1)
        assert apart.min() < 1e-7
        assert len(found) == 1 or np.partition(apart, 1)[1] > 1e-4


@INVERTED
def test_the_density_of_preimages(form):
    """As many normals per steradian have points as the integral of |K| says.

    Cells where K jumps are off by 1/400 at most; at a border some √count of the normals are.
    """
    (u0, u1), (v0, v1) = form.surface.domain
    k = (np.arange(400) + 0.5) / 400
    u, v = (u0 + (u1 - u0) * k)[:, None], (v0 + (v1 - v0) * k)[None, :]
    solid_angle = np.mean(form.bending(u, v)) * (u1 - u0) * (v1 - v0)
    found = len(form.preimages(gm.fibonacci(100_000))[0])
    assert found == pytest.approx(100_000 * solid_angle / (4 * math.pi), rel=5e-3)


def test_the_outline_of_the_boss():
    """Its arcs are quarters of circles round their centres, and its lines upright or level."""
    boss = Boss()
    ends, centres = (np.array(x) for x in cad.boss_outline(boss))
    steps = np.diff(ends, axis=0)
    assert np.count_nonzero(np.abs(steps[[0, 2, 4]]) > 1e-15, axis=1) == pytest.approx(1)
    for k, radius in ((0, boss.fillet), (1, boss.edge)):
        spokes = ends[2 * k + 1 : 2 * k + 3] - centres[k]
        assert np.linalg.norm(spokes, axis=1) == pytest.approx(radius, rel=1e-14)
        assert spokes[0] @ spokes[1] == pytest.approx(0.0, abs=1e-15)


def test_random_places_have_their_density():
    """The torus has (1 + 2r/πR)/2 of its area, and half of its |K|, where K > 0; five sigma."""
    torus, count = Torus(), 40_000
    sigma = 0.5 / math.sqrt(count)
    v = recipe.draw(torus, count, torus.area)[1]
    expected = 0.5 + torus.minor / (math.pi * torus.major)
    assert np.mean(np.cos(v) > 0.0) == pytest.approx(expected, abs=5 * sigma)
    points, normals, uv, K = recipe.by_curvature(torus, count)
    assert np.mean(K > 0.0) == pytest.approx(0.5, abs=5 * sigma)
    for found, again in zip((points, normals), torus.evaluate(*uv.T), strict=True):
        assert (found == again).all()


# --- metrics --------------------------------------------------------------------------------------


def turned(normals, degrees):
    """Turn vectors round the z axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return normals @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("degrees", [1e-9, 3.0, 90.0, 180.0])
def test_angles(degrees):
    axis = np.array([[1.0, 0.0, 0.0]])
    assert metrics.angles(axis, turned(axis, degrees)) == pytest.approx(degrees, rel=1e-7)


def test_errors_in_space_are_of_the_nearest_point():
    """Samples on the graph z = 0 at (±1/2, 0), places 0.1 aside and 0.2 above, normals turned."""
    form = Waves(amplitude=0.0)
    points = np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]])
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    tilted = np.array([[math.sin(x), 0.0, math.cos(x)] for x in (0.1, 0.3)])
    places = metrics.Places(points + np.array([0.1, 0.0, 0.2]), tilted, np.zeros(2, dtype=bool))
    found = metrics.errors(form, places, points, normals, nearest)
    assert pytest.approx(math.degrees(0.3)) == found.E
    assert found.mean == pytest.approx(math.degrees(0.2))
    assert pytest.approx(math.degrees(0.3)) == found.G
    assert found.gap == pytest.approx(math.hypot(0.1, 0.2))
    assert found.plane == pytest.approx(0.2)


def test_worst_in_normal_keeps_the_sign_of_the_curvature():
    x = np.array([[1.0, 0.0, 0.0]])
    places = metrics.Places(x, x, np.array([False]))
    normals = np.concatenate([turned(x, 1.0), turned(x, 5.0)])
    found = [
        metrics.worst_in_normal(places, normals, np.array(hyperbolic), nearest)
        for hyperbolic in ([False, False], [True, False], [True, True])
    ]
    assert found == pytest.approx([1.0, 5.0, 180.0])


@FORM
def test_both_metrics_of_a_grid_and_of_its_other_side(form):
    places = metrics.Places.of(form, 500)
    points, normals = recipe.by_grid(form, 400)
    found = metrics.both(form, places, points, normals, nearest)
    assert metrics.both(form, places, points, -normals, nearest) == found
    u, v = form.parameters(points)
    hyperbolic = form.curvature(u, v) < 0.0
    assert found[1] == metrics.worst_in_normal(places, normals, hyperbolic, nearest)


# --- time -----------------------------------------------------------------------------------------


def points_of(count):
    return np.zeros((count, 3)), np.zeros((count, 3))


def test_times_are_taken_in_turns(monkeypatch):
    """A clock that goes with what is done: the ratio is the median of 2/1, 6/1 and 4/1."""
    now, done = [0.0], []

    def step(name, seconds):
        done.append(name)
        now[0] += seconds
        return points_of(5)

    monkeypatch.setattr(peer, "perf_counter", lambda: now[0])
    seconds = iter([2.0, 6.0, 4.0])
    others = {"other": lambda: step("other", 1.0)}
    turns = peer.in_turns(lambda: step("own", next(seconds)), others, 3)
    assert done == ["other", "own"] * 3
    assert turns == peer.Turns(4.0, 5, {"other": 4.0})


@pytest.mark.parametrize("count", [300, 10_000, 100_000])
@pytest.mark.parametrize("power", [1.0, 2.0, -2.0])
def test_tuning_finds_the_setting(count, power):
    sizes = []

    def made(knob):
        sizes.append(round(37.0 * knob**power))
        return points_of(sizes[-1])

    knob = peer.tuned(made, 1.0, count, power)
    assert 37.0 * knob**power == pytest.approx(count, rel=2 * peer.NEAR_ENOUGH)
    assert max(sizes) <= 1.1 * peer.TUNED_AT


def test_a_package_that_is_missing_is_named():
    gone = Peer("gone", "no", "no_such_package_here", lambda form, count: lambda: points_of(1), 1)
    assert "no_such_package_here" in gone.missing
    assert RECIPE.missing == ""


# --- the page -------------------------------------------------------------------------------------


def test_the_page_in_docs_opens_with_its_own_figures():
    text = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
    assert opening(text) in text


def test_a_page_says_of_which_commit():
    assert re.fullmatch(r"[0-9a-f]{7,}(-dirty)?|unknown", machine.commit())


# --- meshes of others, and distances from a surface -----------------------------------------------


def test_vertices_at_one_place_are_joined():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1e-12, 0], [0, 1, 0], [1, 1, 0]])
    faces = np.array([[0, 1, 2], [3, 5, 4], [1, 3, 5]])
    vertices, triangles = joined(points.astype(float), faces)
    assert len(vertices) == 4
    # the third one had two corners at one place
    assert len(triangles) == 2
    np.testing.assert_allclose(vertices[triangles], points[faces[:2]], atol=1e-11)


@pytest.mark.parametrize("form", FORMS, ids=lambda x: x.name)
def test_a_grid_has_the_topology_of_its_surface(form):
    vertices, triangles = by_grid(form, 400)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    characteristic = len(vertices) - len(np.unique(edges, axis=0)) + len(triangles)
    assert characteristic == (form.name == "wavy_graph")
    assert len(vertices) == pytest.approx(400, rel=0.05)


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


# --- measuring a peer and gaussmap itself, on few points ------------------------------------------


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(measure, "MILLION", 2_000)
    monkeypatch.setattr(measure, "JUDGED", 500)
    measure.normals_for.cache_clear()


@pytest.mark.parametrize("form", FORMS, ids=lambda x: x.name)
def test_a_peer_is_timed_and_judged(form):
    peer = dataclasses.replace(RECIPE, count=1_000, rounds=1)
    found = measure.measure(form, Places.of(form, 300), peer)
    assert (found.points, found.missing) == (1_000, "")
    assert min(found.rate, found.times_same, found.times_million) > 0.0
    assert 0.0 < found.errors[1] <= 180.0


def test_ratios_are_of_rates(monkeypatch):
    """The other tool takes 3 times as long as gaussmap, and returns half the requested points."""
    monkeypatch.setattr(
        measure, "in_turns", lambda work, others, rounds: Turns(0.1, 50, dict.fromkeys(others, 3.0))
    )
    peer = dataclasses.replace(RECIPE, count=100)
    found = measure.measure(FORMS[0], Places.of(FORMS[0], 10), peer)
    assert (found.rate, found.times_same, found.times_million) == (500.0, 6.0, 120.0)


def test_a_missing_peer_is_not_prepared():
    peer = dataclasses.replace(RECIPE, module="no_such_package_here")
    found = measure.measure(FORMS[0], Places.of(FORMS[0], 10), peer)
    assert found == measure.Measured(peer, peer.missing)
    assert found.missing
