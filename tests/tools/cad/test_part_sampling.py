"""Samples of parts: one count, coverage and angle for all faces, and what samples know."""

# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

import math
import pickle
import pkgutil
import re
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import box, box_faces
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import FaceRecord, Geometry, Net
from gaussmap.tools.cad.results import PartSpace, space_of
from scipy.spatial import ConvexHull, KDTree

from ...products import covering
from ...refusals import refused
from ...shapes import farthest, same, widest_angle
from . import made
from .made import CYLINDER, HALF, KINDS, UNIT, circle, cylinder, face, noted, part


@pytest.fixture(scope="module")
def plates() -> Part:
    """Return a part with a hole, a sphere whose normals are reversed, a torus, and a tiny face."""
    loops = [made.rectangle(UNIT, UNIT), 0.5 + circle(0.3, 720)]
    plate = face("plane", loops=loops, area=1.0 - np.pi * 0.09)
    at = [made.placement((0.5, 0.5, z)) for z in (1.0, 2.0)]
    ball = face("sphere", 0.25, place=at[0], reversed=True, solid_index=0)
    ring = face("torus", 0.4, 0.1, place=at[1], solid_index=1)
    tiny = face("plane", u=(0.0, 1e-4), v=(0.0, 2e-4), place=made.placement((3.0, 0.0, 0.0)))
    return part([plate, ball, ring, tiny], "plates", False)


def points_on_cylinder(count: int = 40_000) -> np.ndarray:
    """Return points of the cylinder of radius 1 and height 2, from no evaluation of ours."""
    rng = np.random.default_rng(0)
    phi, z = rng.uniform(0, 2 * np.pi, count), rng.uniform(0, 2, count)
    r = np.sqrt(rng.uniform(0, 1, count))
    side = np.stack([np.cos(phi), np.sin(phi), z], axis=1)
    ends = np.stack([r * np.cos(phi), r * np.sin(phi), 2.0 * (z > 1)], axis=1)
    return np.concatenate([side, ends])


@pytest.mark.parametrize("count", [1, 2, 5, 6, 7, 60, 500])
def test_count_is_exact(count):
    samples = gm.sample(CYLINDER, count)
    assert len(samples) == count == samples.report.samples
    if count >= 6:  # twice the faces
        assert set(samples.face_index.tolist()) == {0, 1, 2}
        assert samples.report.empty_faces == 0


@pytest.mark.parametrize("density", ["balanced", "uniform", 0.5])
def test_samples_are_on_their_faces(plates, density):
    samples = gm.sample(plates, 400, density=density)
    points, normals, faces = samples.points, samples.normals, samples.face_index
    assert len(samples) == 400
    on_plate, on_ball = faces == 0, faces == 1
    assert np.hypot(*(points[on_plate, :2] - 0.5).T).min() > 0.3 * np.cos(np.pi / 720) - 1e-6
    from_centre = points[on_ball] - [0.5, 0.5, 1.0]
    np.testing.assert_allclose(normals[on_ball], -from_centre / 0.25, atol=1e-13)  # reversed
    np.testing.assert_allclose(samples.mean_curvature[on_ball], -4.0, rtol=1e-12)
    np.testing.assert_allclose(samples.gaussian_curvature[on_ball], 16.0, rtol=1e-12)
    assert samples.solid_index.tolist() == np.array([-1, 0, 1, -1])[faces].tolist()
    assert samples.report.oriented is False
    for k, known in enumerate(plates.faces):
        here = faces == k
        assert here.any()
        made.is_on(known.surface, samples.uv[here], points[here], normals[here])


@pytest.mark.parametrize(
    ("asked", "most"),
    [({"coverage": x}, 2.2) for x in (0.5, 0.2)]
    + [({"coverage": x, "density": "uniform"}, 1.6) for x in (0.5, 0.2)]
    + [({"coverage": 0.42, "count": 200}, np.inf)],
)
def test_coverage_holds_for_the_part(asked, most):
    samples, coverage = gm.sample(CYLINDER, **asked), asked["coverage"]
    assert len(samples) == asked.get("count", len(samples))
    assert farthest(samples, points_on_cylinder()) <= samples.report.coverage <= coverage
    assert samples.coverage() <= samples.report.coverage
    # Squares of half the diagonal cover as much by twice as many samples; edges cost some, and so
    # does the curvature of the side.
    assert len(samples) < most * CYLINDER.area / (2 * coverage**2) + 30


def test_coverage_that_a_count_cannot_reach():
    with pytest.warns(gm.GaussmapWarning, match="the coverage is"):
        samples = gm.sample(CYLINDER, 20, coverage=0.05)
    assert len(samples) == 20


def tips(width: float, power: int, lean: float, count: int) -> Part:
    """Return half a cone of NURBS that is trimmed to a strip with two thin tips, and a plane."""
    half, knots = np.sqrt(0.5), (np.array([0, 0, 0, 0.5, 0.5, 1, 1, 1.0]), np.array([0, 0, 1, 1.0]))
    arc = 0.1 * np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)])
    rings = [np.column_stack([r * arc, np.full(5, z)]) for r, z in ((1.0, 0.0), (0.8, 0.03))]
    weights = np.repeat([[1.0], [half], [1.0], [half], [1.0]], 2, axis=1)
    net = Net((2, 1), knots, np.stack(rings, axis=1), weights)
    u = np.linspace(0.0, 1.0, count)
    middle, wide = 0.5 + lean * (u - 0.5), width * (4.0 * u * (1.0 - u)) ** power
    sides = np.stack([u, middle - wide], axis=1), np.stack([u, middle + wide], axis=1)[::-1]
    loop = np.concatenate([sides[0], sides[1][1:-1]])
    ends = tuple(zip(loop.min(axis=0).tolist(), loop.max(axis=0).tolist(), strict=True))
    strip = FaceRecord(Geometry("nurbs", net=net), ends, loops=[loop], area=0.003)
    return part([face("plane", place=made.placement((0, 0, -1.0))), strip])


@pytest.mark.parametrize(
    ("tip", "angle"),
    [((0.03, 3, 0.0, 40), 8.0), ((0.01, 2, 0.3, 10), 1.0), ((0.01, 2, 0.3, 10), 3.0)],
)
def test_an_angle_holds_in_narrow_tips(tip, angle):
    """Their borders are sampled as finely as normals turn along them."""
    samples = gm.sample(tips(*tip), angle=angle)
    assert samples.normal_deviation().normal_space <= samples.report.angle <= angle


@pytest.mark.parametrize(
    ("kind", "radius"),
    [("cylinder", 3e-3), ("cylinder", 1e-3), ("cylinder", 1e-4), ("sphere", 1e-4)],
)
def test_an_angle_takes_few_samples_of_tiny_faces(kind, radius):
    """They took 66,000 samples of the larger fillet, most of them on the plane.

    The cells of a rounded corner are small for the part, and not for the face.
    """
    quarter = (0.0, np.pi / 2)
    tiny, normals = face("sphere", radius, u=quarter, v=quarter), np.abs(gm.fibonacci(5000))
    if kind == "cylinder":
        place, turn = (
            made.placement((0.0, 0.0, -radius), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
            (HALF[0], 0),
        )
        angles = np.linspace(*turn, 2000)
        tiny = face(kind, radius, u=turn, place=place)
        normals = np.stack([0.0 * angles, -np.sin(angles), np.cos(angles)], axis=1)
    samples = gm.sample(part([face("plane"), tiny]), angle=5.0)
    assert widest_angle(samples, normals) <= samples.report.angle <= 5.0
    assert len(samples) < 1000


def needle(radius) -> Part:
    """Return a cylinder of length 1: κ² integrates to 1/(2 radius) spheres."""
    return part([face("cylinder", radius)], "needle")


def test_an_angle_that_takes_millions_of_samples_is_refused():
    tube = needle(1e-4)
    said = r"about (\S+) million samples .* on face 0 .* ask for (\S+) degrees or more, or"
    found = re.search(said, refused(said, gm.sample, tube, angle=3.5))
    millions, enough = map(float, found.groups())  # of two digits and more
    assert enough == pytest.approx(3.5 * math.sqrt(millions / 2.0), rel=0.06)
    assert len(gm.sample(tube, 50)) == 50


@pytest.mark.parametrize(
    ("spheres", "said"), [(150, r"more than 2e\+09 places"), (600, "narrow and sharply curved")]
)
def test_narrow_faces_are_blamed_where_they_are(spheres, said):
    """An angle of 0.02° takes too many samples of every part."""
    refused(said, gm.sample, needle(0.5 / spheres), angle=0.02)


def test_angles_hold_in_tips_of_sharp_bends():
    """Two flanks meet in a round of 1e-6 that is 2e-5 wide in u, and the trim ends on it."""
    x = [(1.0, -0.12), (0.2, -0.05), (1e-6, -1e-6), (0.0, -1e-6)]
    x += [(a, -b) for a, b in x[::-1]]
    knots = np.array([0, 0, 0, 0.3, 0.5 - 1e-5, 0.5, 0.5 + 1e-5, 0.7, 1, 1, 1])
    points = np.array([[(a, y, b) for y in (0.0, 2.0)] for a, b in x])
    wing = Geometry("nurbs", net=Net((2, 1), (knots, np.array([0.0, 0, 1, 1])), points))
    tip = np.array([(0, 0), (1, 0), (1, 0.9), (0.5, 1), (0, 0.9)])
    whole = part([FaceRecord(wing, (UNIT, UNIT), loops=[tip], area=3.8)], "wing", False)
    samples = gm.sample(whole, angle=10.0)
    assert samples.report.angle <= 10.0
    u = np.concatenate([np.linspace(0, 1, 101), 0.5 + np.linspace(-1e-5, 1e-5, 101)])
    v = np.concatenate([np.linspace(0.0, 0.89, 5), 0.999 + 0.0 * u[:1]])
    jets = whole.faces[0].surface.jets(np.repeat(u, len(v)), np.tile(v, len(u)))
    assert widest_angle(samples, made.normals_of(jets)) <= 10.0


def test_prescribed_normals(plates):
    normals = np.array([[1.0, 2, 2], [-2, 1, 2], [2, -2, 1]]) / 3
    with pytest.warns(gm.GaussmapWarning, match="23 % of its area is flat"):
        samples = gm.sample(plates, normals=normals)
    assert samples.report.normals == 3
    # Once on the sphere, and twice on the torus; planes have one normal only.
    assert np.bincount(samples.face_index, minlength=4).tolist() == [0, 3, 6, 0]
    np.testing.assert_allclose(samples.normals, normals[samples.normal_index], atol=1e-12)
    ball = samples[samples.face_index == 1]
    np.testing.assert_allclose(ball.points, [0.5, 0.5, 1.0] - 0.25 * ball.normals, atol=1e-12)
    filled = gm.sample(plates, normals=normals, density="balanced")
    assert (filled.normal_index >= 0).sum() == 9
    assert (filled.normal_index < 0).sum() > 20


def test_a_part_has_a_map(plates):
    normals, known = gm.fibonacci(40), gm.GaussMap(plates)
    found = known.points(normals)
    assert known.surface is plates
    assert (known.count(normals) == np.bincount(found.normal_index, minlength=40)).all()
    assert (known.count(normals) == 3).all()
    assert (known.degree(normals) == 1).all()  # of the sphere; the torus has 0
    refused(r"face\.surface", known.folds, error=gm.GaussmapError)


def test_weights_add_up_to_the_areas(plates):
    samples = gm.sample(plates, 300)
    weights = samples.weights()
    areas = np.bincount(samples.face_index, weights, 4)
    np.testing.assert_allclose(areas, [x.area for x in plates.faces], rtol=1e-12)
    # Twice the integral of z² over the sphere is that over a shell: its moment.
    ball = samples.face_index == 1
    moment = (weights * (samples.points[:, 2] - 1.0) ** 2)[ball].sum()
    assert moment == pytest.approx(4 * np.pi / 3 * 0.25**4, rel=0.05)


def test_threads_and_repeats_give_the_same(plates):
    one = gm.sample(plates, 250, threads=1)
    same(one, gm.sample(plates, 250, threads=3))
    same(one, gm.sample(pickle.loads(pickle.dumps(plates)), 250))


@pytest.mark.parametrize(
    ("others", "is_reversed"), [(box_faces(2.0, 2.0, 2.0), False), ([], False), ([], True)]
)
def test_a_narrow_face_keeps_its_coverage(others, is_reversed):
    """A sliver across the domain, thinner than cells: places next to its border cover it.

    Its first cell has one place only; the places next to its border are many.
    """
    sliver = np.array([(0.0, 0.0), (1.0, 0.9999), (1.0, 1.0), (0.0, 0.0001)])
    narrow = face("plane", area=1e-4, loops=[sliver], reversed=is_reversed, solid_index=0)
    samples = gm.sample(part([narrow, *others]), coverage=0.1)
    along = np.linspace(0, 1, 2000)
    points = np.stack([along, 0.9999 * along + 5e-5, 0 * along], axis=1)
    assert farthest(samples, points) <= samples.report.coverage <= 0.1
    assert (samples.face_index == 0).sum() >= 1


@pytest.mark.parametrize("inner", [0.499, 0.4999])
def test_coverage_holds_where_a_hole_touches_the_border(inner):
    """A face between two circles that touch is too narrow there for places beside its borders."""
    round_, ends = circle(1.0, 720, -np.pi / 2), (-0.5, 0.5)
    loops = [0.5 * round_, inner * round_[::-1] + [0.0, inner - 0.5]]
    narrow = face("plane", u=ends, v=ends, area=np.pi * (0.25 - inner**2), loops=loops)
    samples = gm.sample(part([narrow]), coverage=0.02, density="uniform")
    borders = np.concatenate([x + t * (np.roll(x, -1, 0) - x) for x in loops for t in (0, 0.5)])
    points = np.column_stack([borders, np.zeros(len(borders))])
    assert farthest(samples, points) <= 1.001 * samples.report.coverage <= 1.001 * 0.02


def test_failed_faces_are_left_out():
    faces = box_faces()
    faces[2] = made.FAILED
    failing = part([*faces, face("plane", area=0.0)])
    with pytest.warns(gm.GaussmapWarning, match="2 of 7 faces cannot be sampled"):
        samples = gm.sample(failing, 50)
    assert set(samples.face_index.tolist()) == {0, 1, 3, 4, 5}
    assert (samples.report.faces, samples.report.empty_faces) == (7, 2)
    assert "7 faces, 2 of them without samples" in samples.summary()


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"count": 10, "cells": (8, 8)}, "cells are for splines"),
        ({"count": 10, "on": "spline"}, "are of surfaces"),
        ({"count": 10, "density": "gauss"}, "goes with normals"),
        ({"count": 10, "density": "aligned"}, "is for surfaces"),
        ({"count": 10, "fields": ("row",)}, "on a grid only"),
        ({"coverage": 1e-9}, "more than"),
        ({"coverage": 1e-320}, "would have to be searched in more than"),  # its inverse overflows
    ],
)
def test_unusable_arguments(arguments, match):
    refused(match, gm.sample, CYLINDER, **arguments)


def test_samples_that_lack_what_is_needed():
    few = gm.sample(CYLINDER, 20, fields=("points", "normals"))
    refused("weights of a part need", few.weights, error=gm.errors.MissingFieldError)
    arrays = {"points": few.points, "normals": few.normals}
    for name in arrays:
        unknown = {**arrays, name: np.where(np.arange(20)[:, None] == 7, np.nan, arrays[name])}
        bad = gm.Samples(**unknown, report=few.report, surface=CYLINDER)
        refused(f"{name} holds NaN", bad.normal_deviation)
        if name == "points":
            refused("points holds NaN", bad.coverage)


def test_parts_without_faces():
    no_face, error = "has no face that can be sampled", gm.errors.SurfaceError
    refused(no_face, gm.sample, part([]), 10, error=error)


@covering(kind=["faces", "edges", "curves"], name=["a.npz", "a.ply"], dtype=["f8", "f4"])
def test_samples_are_in_files(kind, name, dtype, tmp_path):
    if kind == "curves":
        with pytest.warns(gm.GaussmapWarning, match="is flat"):
            samples = gm.sample(box(), normals=np.eye(3), dtype=dtype)
        assert sorted(samples.face_index) == [1, 3, 5]
    else:
        samples = gm.sample(box(), 30, edges=kind == "edges", dtype=dtype)
    samples.write(tmp_path / name)
    again = gm.read_samples(tmp_path / name)
    assert (again.report, again.dtype) == (samples.report, dtype)
    same(samples, again)


def test_other_methods():
    samples = gm.sample(CYLINDER, 40)
    few = samples[:5]
    assert few.surface is CYLINDER
    assert len(gm.Samples.concatenate([few, few]).solid_index) == 10
    assert pickle.loads(pickle.dumps(samples)).surface.name == "cylinder"
    refused("of CAD parts only", gm.sample, "torus", 10, cells=(8, 8), fields=("face_index",))
    assert gm.sample("torus", 10, cells=(8, 8)).face_index is None
    chosen = gm.sample(CYLINDER, 10, fields=("points", "solid_index"))
    assert chosen.fields == ("points", "solid_index")
    assert gm.sample(CYLINDER, 10, dtype=np.float32).points.dtype == np.float32


def test_candidates_for_normals_are_no_more_than_asked(plates):
    space = space_of(plates, 1)
    for most in (0, 500):
        cells = space.cut_by_normals(1e-3, most)
        assert sum(map(len, cells)) <= most + len(space.first)
    (whole,) = space.cut_by_normals(0.2, np.inf)  # few are enough: the chord is the one asked for
    assert whole.numbers[:, 4].max() <= 0.5


def test_places_along_borders_are_inside_with_limits_of_their_face():
    space = space_of(KINDS, 1)
    lines = space.borders
    assert len(lines.pieces) > 1
    limits = np.split(lines.limits, lines.starts[1:-1])
    for number, along in zip(lines.pieces, limits, strict=True):
        own = space.first.limits[space.first.pieces == number]
        assert len(along) > 4
        assert np.isin(along, own).all()
    found = space.along_borders(0.1 * math.sqrt(space.area))
    assert set(found.pieces) == set(lines.pieces)
    assert space.trims.contains(found.pieces, found.places).all()


def test_five_percent_of_a_count_go_where_normals_are_missing(monkeypatch):
    filling = pkgutil.resolve_name("gaussmap.tools.density.filling")
    numbers = noted(monkeypatch, filling, "choose_apart", lambda given, _: given[4])
    samples = gm.sample(KINDS, 300)
    assert numbers == [15]
    assert samples.normal_deviation().normal_space < 6.5


def test_every_face_has_a_sample_if_there_are_twice_as_many():
    """Nine faces of one square, between lines of which two are close together."""
    ends = (0.0, 1.0), (1.0, 1.001), (1.001, 2.0)
    nine = part([face("plane", u=u, v=v) for u in ends for v in ends], "nine")
    assert gm.sample(nine, 17).report.empty_faces > 0
    assert gm.sample(nine, 18).report.empty_faces == 0


def test_candidates_for_missing_normals_are_dense_and_few(monkeypatch):
    """With normals twice as far apart, 2.6° are left; twice as near, there are 7 a sample."""
    by_normals = "cut_by_normals"
    numbers = noted(monkeypatch, PartSpace, by_normals, lambda _, cells: sum(map(len, cells)))
    gm.sample(KINDS, 300)
    assert numbers.pop() < 4 * 300
    assert gm.sample(KINDS, 3000).normal_deviation().normal_space < 2.3


def test_a_part_has_some_candidates_for_each_sample(monkeypatch):
    """Squares of circumradius 0.4 r have an area of 0.32 r², a sample has r²/0.6: five, or more.

    With a quarter of them gaps are wider; four times as many take as much more time and memory.
    """
    numbers = noted(monkeypatch, PartSpace, "candidates", lambda _, found: len(found[0]))
    gm.sample(CYLINDER, 1000, density="uniform")
    assert 4.0 < max(numbers) / 1000 < 10.0


@pytest.mark.parametrize("count", [300, 1000])
def test_the_widest_angle_on_a_sphere_is_found(count):
    """It is that of the largest empty circle: around a face of the convex hull of the samples."""
    samples = gm.sample(part([face("sphere", 1.0)]), count, density="uniform")
    expected = np.degrees(np.arccos(-ConvexHull(samples.points).equations[:, 3].max()))
    for found in samples.normal_deviation():
        assert 0.99 * expected < found < 1.0001 * expected


def test_flat_faces_get_their_share():
    """The target density is 0.8 of the mean of κ² at least: a torus has more, a plane not."""
    kinds = [x.kind for x in KINDS.faces]
    counts = np.bincount(gm.sample(KINDS, 1000).face_index, minlength=len(kinds))
    ratio = counts[kinds.index("torus")] / counts[kinds.index("plane")]
    assert ratio == pytest.approx(7.4, rel=0.1)


def test_samples_beside_borders_are_inside(plates):
    samples = gm.sample(plates, 2000, density="uniform")
    hole = np.linalg.norm(samples.uv[samples.face_index == 0] - 0.5, axis=1)
    assert 0.2999 < hole.min() < 0.3001  # a circle of 720 chords


@pytest.mark.parametrize(("points", "cells"), [(10, 2), (35, 2), (36, 1)])
def test_dense_nets_have_one_first_cell_for_each_span(points, cells):
    """Two for each span along a parameter, as long as there are no more than 64."""
    spans = points - 3
    knots = np.concatenate([[0.0] * 3, np.arange(spans + 1.0), [float(spans)] * 3])
    grid = np.stack(np.meshgrid(*2 * [np.arange(float(points))], indexing="ij"), axis=-1)
    waves = made.nurbs(np.dstack([grid, np.sin(grid[:, :, 0])]), knots=knots)
    ends = 0.0, float(spans)
    dense = FaceRecord(waves, (ends, ends), loops=[made.rectangle(ends, ends)], area=1.0)
    assert len(space_of(part([dense]), 1).pieces[0].boxes) == (cells * spans) ** 2


def test_borders_are_measured_in_groups(monkeypatch):
    """What is found does not depend on the size of the groups."""
    whole = space_of(CYLINDER, 1).borders
    monkeypatch.setattr("gaussmap.tools.density.space.PLACES_AT_A_TIME", 1000)
    some = space_of(CYLINDER, 1).borders
    assert len(whole.rows) > 2000
    for name in ("pieces", "starts", "places", "rows", "limits"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(some, name))


# --- normals within an angle of an axis -----------------------------------------------------------

ROUNDING = 1e-9


def angles(normals: np.ndarray, axis: tuple[float, float, float]) -> np.ndarray:
    return np.degrees(
        np.arccos(np.clip(normals @ (np.array(axis) / np.linalg.norm(axis)), -1.0, 1.0))
    )


@pytest.mark.parametrize(
    "how", [{"count": 200}, {"coverage": 0.3}, {"count": 60, "density": "uniform"}]
)
@pytest.mark.quick_for("how2")
def test_parts_have_samples_on_faces_that_can_be_reached(how: dict[str, Any]) -> None:
    samples = gm.sample(KINDS, reach=((0, 0, 1), 60.0), **how)
    assert angles(samples.normals, (0, 0, 1)).max() <= 60.0 + ROUNDING
    if "count" in how:
        assert len(samples) == how["count"]
    else:
        assert (samples.report.coverage or np.inf) <= how["coverage"]


@pytest.mark.slow
def test_weights_and_deviation_are_those_of_what_is_in_reach() -> None:
    """Of a surface of revolution, of which a sixth is in reach."""
    part, reach = KINDS.select(kind="revolution"), ((1, 1, 1), 60.0)
    whole, some = gm.sample(part, 4000), gm.sample(part, 200, reach=reach)
    within = angles(whole.normals, (1, 1, 1)) <= 60.0
    assert some.weights().sum() == pytest.approx(whole.weights()[within].sum(), rel=0.02)
    assert some.report.reach == pytest.approx((3**-0.5, 3**-0.5, 3**-0.5, 60.0))
    assert whole.report.reach is None
    # What is outside of the reach is farther away, in space and in normal.
    left_out = whole.points[~within]
    farthest = np.linalg.norm(left_out[:, None] - some.points, axis=2).min(axis=1).max()
    assert some.coverage() < farthest / 2
    assert some.normal_deviation().normal_space < 10.0


def test_edges_are_reached_if_both_faces_are() -> None:
    whole = gm.sample(box(), 100, edges=True)
    sides = gm.sample(box(), 100, edges=True, reach=((1, 1, 0), 50.0))
    assert (whole.report.edge_samples or 0) > (sides.report.edge_samples or 0) > 0
    on_edge = sides.kind == "edge"
    assert angles(sides.other_normals[on_edge], (1, 1, 0)).max() <= 50.0 + ROUNDING


@pytest.mark.parametrize("reach", [((1, 1, 1), 10.0), gm.Reach(from_edges=1.0)])
def test_a_part_without_points_in_reach_is_refused(reach: Any) -> None:
    error = gm.errors.SurfaceError
    refused("no point in reach", gm.sample, box(), 100, reach=reach, error=error)


def test_samples_of_a_box_keep_a_distance_from_its_edges() -> None:
    size, distance = np.array([3.0, 2.0, 1.0]), 0.3
    samples = gm.sample(box(*size), 200, reach=gm.Reach(from_edges=distance))
    from_sides = np.sort(np.minimum(samples.points, size - samples.points), axis=1)
    assert len(samples) == 200
    assert from_sides[:, 1].min() >= distance - ROUNDING
    left = size - 2.0 * distance
    area = 2.0 * (left[0] * left[1] + left[1] * left[2] + left[2] * left[0])
    assert samples.weights().sum() == pytest.approx(area, rel=0.1)
    near = gm.sample(box(*size), coverage=0.2, reach=gm.Reach((0, 0, 1), 1.0, from_edges=distance))
    x, y = (
        a.ravel() for a in np.meshgrid(*(distance + np.linspace(0, 1, 50)[:, None] * left[:2]).T)
    )
    top = np.stack([x, y, np.ones_like(x)], axis=1)
    assert farthest(near, top) <= (near.report.coverage or 0.0) <= 0.2


def test_seams_are_no_edges_and_circles_are_exact() -> None:
    """On the plane at their ends, the circles are known by cubics only."""
    samples = gm.sample(cylinder(), 500, reach=gm.Reach(from_edges=0.05))
    x, y, z = samples.points.T
    apart = np.hypot(np.hypot(x, y) - 1.0, np.minimum(np.abs(z), np.abs(z - 2.0)))
    wall = samples.points[samples.face_index == 0]
    assert len(samples) == 500
    assert 0.05 - ROUNDING <= apart.min() < 0.1
    assert KDTree(wall).query([1.0, 0.0, 1.0])[0] < samples.coverage()


@pytest.mark.parametrize(
    ("whole", "unit", "least"), [(KINDS, " mm", 1e-6), (box(), " mm", 0.0), ("wavy_graph", "", 0.0)]
)
def test_summaries_name_the_reach_and_the_error_of_edges(
    whole: Any, unit: str, least: float
) -> None:
    reach = gm.Reach((0, 0, 2), 170, from_edges=0.05)
    samples = gm.sample(whole, 60, density="uniform", reach=reach)
    assert samples.report.reach == (0.0, 0.0, 1.0, 170.0, 0.0, 0.0, 0.0, 0.05)
    error = samples.report.edge_error
    assert least <= error < least + 1e-4
    more = f" + {error:.2g}{unit} (their error)" if least else ""
    said = f"; in reach: normals within 170° of (0, 0, 1), at least 0.05{unit}{more} from edges"
    assert said in samples.summary()


def test_samples_on_edges_are_not_away_from_them() -> None:
    reach = gm.Reach(from_edges=0.1)
    refused("leave out edges", gm.sample, box(), 100, edges=True, reach=reach)
