"""Samples of parts: one count, coverage and angle for all faces, and what samples know."""

# pyright: reportOptionalMemberAccess=false, reportOptionalOperand=false, reportOperatorIssue=false
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false

import math
import pickle
import pkgutil
import re

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.records import FaceRecord, Geometry, Net
from gaussmap.tools.cad.results import PartSpace, space_of
from scipy.spatial import ConvexHull, cKDTree

from ...refusals import refused


@pytest.fixture(scope="module")
def cylinder(made) -> Part:
    return made.part(made.cylinder_faces(), "cylinder")


@pytest.fixture(scope="module")
def plates(made) -> Part:
    """Return a part with a hole, a sphere whose normals are reversed, a torus, and a tiny face."""
    turn, circle = made.TURN, np.linspace(0.0, made.TURN, 720, endpoint=False)
    hole = 0.5 + 0.3 * np.stack([np.cos(circle), np.sin(circle)], axis=1)
    plate = made.face(
        "plane",
        made.placement(),
        (0.0, 1.0),
        (0.0, 1.0),
        1.0 - np.pi * 0.09,
        loops=[made.rectangle(0, 1, 0, 1), hole],
    )
    ball = made.face(
        "sphere",
        [*made.placement((0.5, 0.5, 1.0)), 0.25],
        (0.0, turn),
        (-np.pi / 2, np.pi / 2),
        np.pi / 4,
        (turn, 0.0),
        reversed=True,
        solid_index=0,
    )
    ring = made.face(
        "torus",
        [*made.placement((0.5, 0.5, 2.0)), 0.4, 0.1],
        (0.0, turn),
        (0.0, turn),
        4 * np.pi**2 * 0.04,
        (turn, turn),
        solid_index=1,
    )
    tiny = made.face("plane", made.placement((3.0, 0.0, 0.0)), (0.0, 1e-4), (0.0, 2e-4), 2e-8)
    return made.part([plate, ball, ring, tiny], "plates", False)


def points_on_cylinder(count: int = 40_000) -> np.ndarray:
    """Return points of the cylinder of radius 1 and height 2, from no evaluation of ours."""
    rng = np.random.default_rng(0)
    phi, z = rng.uniform(0, 2 * np.pi, count), rng.uniform(0, 2, count)
    r = np.sqrt(rng.uniform(0, 1, count))
    side = np.stack([np.cos(phi), np.sin(phi), z], axis=1)
    ends = np.stack([r * np.cos(phi), r * np.sin(phi), 2.0 * (z > 1)], axis=1)
    return np.concatenate([side, ends])


def gap(samples: gm.Samples, points: np.ndarray) -> float:
    return float(cKDTree(samples.points).query(points)[0].max())


@pytest.mark.parametrize("count", [1, 2, 5, 6, 7, 60, 500])
def test_count_is_exact(cylinder, count):
    samples = gm.sample(cylinder, count)
    assert len(samples) == count == samples.report.samples
    if count >= 6:  # twice the faces
        assert set(samples.face_index.tolist()) == {0, 1, 2}
        assert samples.report.empty_faces == 0


@pytest.mark.parametrize("density", ["balanced", "uniform", 0.5])
def test_samples_are_on_their_faces(plates, density):
    samples = gm.sample(plates, 400, density=density)
    points, normals, faces = samples.points, samples.normals, samples.face_index
    assert len(samples) == 400
    on_plate, on_ball, on_ring, on_tiny = (faces == k for k in range(4))
    assert np.abs(points[on_plate, 2]).max() == 0.0
    assert np.hypot(*(points[on_plate, :2] - 0.5).T).min() > 0.3 * np.cos(np.pi / 720) - 1e-6
    from_centre = points[on_ball] - [0.5, 0.5, 1.0]
    np.testing.assert_allclose(np.linalg.norm(from_centre, axis=1), 0.25, atol=1e-14)
    np.testing.assert_allclose(normals[on_ball], -from_centre / 0.25, atol=1e-13)  # reversed
    np.testing.assert_allclose(samples.mean_curvature[on_ball], -4.0, rtol=1e-12)
    np.testing.assert_allclose(samples.gaussian_curvature[on_ball], 16.0, rtol=1e-12)
    x, y, z = (points[on_ring] - [0.5, 0.5, 2.0]).T
    np.testing.assert_allclose(np.hypot(np.hypot(x, y) - 0.4, z), 0.1, atol=1e-14)
    assert on_tiny.sum() >= 1
    assert samples.solid_index.tolist() == np.array([-1, 0, 1, -1])[faces].tolist()
    assert samples.report.oriented is False
    for k, face in enumerate(plates.faces):
        here = faces == k
        evaluated = face.surface.evaluate(*samples.uv[here].T)
        np.testing.assert_allclose(evaluated, points[here], atol=1e-15)


@pytest.mark.parametrize("coverage", [0.5, 0.2])
@pytest.mark.parametrize("density", ["balanced", "uniform"])
def test_coverage_holds_for_the_part(cylinder, coverage, density):
    samples = gm.sample(cylinder, coverage=coverage, density=density)
    assert gap(samples, points_on_cylinder()) <= samples.report.coverage <= coverage
    assert samples.coverage() <= 1.1 * samples.report.coverage
    # Squares of half the diagonal cover as much by twice as many samples; edges cost some, and so
    # does the curvature of the side.
    most = 1.6 if density == "uniform" else 2.2
    assert len(samples) < most * cylinder.area / (2 * coverage**2) + 30


def test_count_and_coverage(cylinder):
    samples = gm.sample(cylinder, 200, coverage=0.42)
    assert len(samples) == 200
    assert gap(samples, points_on_cylinder()) <= samples.report.coverage <= 0.42


def test_coverage_that_a_count_cannot_reach(cylinder):
    with pytest.warns(gm.GaussmapWarning, match="the coverage is"):
        samples = gm.sample(cylinder, 20, coverage=0.05)
    assert len(samples) == 20


def test_angle_holds_for_the_part(plates):
    samples = gm.sample(plates, angle=15.0)
    assert samples.report.angle <= 15.0
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(20_000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)  # those of the sphere are all
    chords = cKDTree(samples.normals).query(normals)[0]
    assert np.degrees(2 * np.arcsin(chords.max() / 2)) <= 15.0
    assert samples.normal_deviation().normal_space <= 15.0


def tips(made, width: float, power: int, lean: float, count: int) -> Part:
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
    plane = made.face("plane", made.placement((0, 0, -1.0)), (0.0, 1.0), (0.0, 1.0), 1.0)
    return made.part([plane, strip])


def test_angle_holds_in_narrow_tips(made):
    samples = gm.sample(tips(made, 0.03, 3, 0.0, 40), angle=8.0)
    assert samples.normal_deviation().normal_space <= samples.report.angle <= 8.0


@pytest.mark.parametrize("angle", [1.0, 3.0])
def test_an_angle_holds_in_narrow_tips(made, angle):
    """Their borders are sampled as finely as normals turn along them."""
    samples = gm.sample(tips(made, 0.01, 2, 0.3, 10), angle=angle)
    assert samples.normal_deviation().normal_space <= samples.report.angle <= angle


@pytest.mark.parametrize("radius", [1e-3, 1e-4])
def test_an_angle_takes_few_samples_of_tiny_fillets(made, radius):
    """They took 66,000 samples of the larger one, most of them on the plane."""
    plane = made.face("plane", made.placement(), (0.0, 1.0), (0.0, 1.0), 1.0)
    axis = made.placement((0.0, 0.0, -radius), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    quarter = (-np.pi / 2, 0.0)
    fillet = made.face("cylinder", [*axis, radius], quarter, (0.0, 1.0), np.pi / 2 * radius)
    samples = gm.sample(made.part([plane, fillet]), angle=5.0)
    turn = np.linspace(*quarter, 2000)
    normals = np.stack([0.0 * turn, -np.sin(turn), np.cos(turn)], axis=1)
    chords = cKDTree(samples.normals).query(normals)[0]
    assert np.degrees(2 * np.arcsin(chords.max() / 2)) <= samples.report.angle <= 5.0
    assert len(samples) < 1000


def test_an_angle_holds_on_tiny_faces(made):
    """A rounded corner of 1e-4 of the part: its cells are small for the part, not for the face."""
    plane = made.face("plane", made.placement(), (0.0, 1.0), (0.0, 1.0), 1.0)
    quarter, radius = (0.0, np.pi / 2), 1e-4
    area = np.pi / 2 * radius**2
    corner = made.face("sphere", [*made.placement(), radius], quarter, quarter, area)
    samples = gm.sample(made.part([plane, corner]), angle=5.0)
    normals = np.abs(gm.fibonacci(5000))
    chords = cKDTree(samples.normals).query(normals)[0]
    assert np.degrees(2 * np.arcsin(chords.max() / 2)) <= samples.report.angle <= 5.0


def needle(made, radius):
    """Return a cylinder of length 1: κ² integrates to 1/(2 radius) spheres."""
    ends = (0.0, made.TURN), (0.0, 1.0), made.TURN * radius, (made.TURN, 0.0)
    return made.part([made.face("cylinder", [*made.placement(), radius], *ends)], "needle")


def test_an_angle_that_takes_millions_of_samples_is_refused(made):
    part = needle(made, 1e-4)
    said = r"about (\S+) million samples .* on face 0 .* ask for angle=(\S+) or more, or"
    found = re.search(said, refused(said, gm.sample, part, angle=3.5))
    assert found is not None
    millions, enough = map(float, found.groups())  # of two digits and more
    assert enough == pytest.approx(3.5 * math.sqrt(millions / 2.0), rel=0.06)
    assert len(gm.sample(part, 50)) == 50


@pytest.mark.parametrize(
    ("spheres", "said"), [(150, r"more than 2e\+09 places"), (600, "narrow and sharply curved")]
)
def test_narrow_faces_are_blamed_where_they_are(made, spheres, said):
    """An angle of 0.02° takes too many samples of every part."""
    refused(said, gm.sample, needle(made, 0.5 / spheres), angle=0.02)


def test_prescribed_normals(plates):
    normals = np.array([[1.0, 2, 2], [-2, 1, 2], [2, -2, 1]]) / 3
    with pytest.warns(gm.GaussmapWarning, match="33 % of its area is flat"):
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
    assert found.points.tobytes() == known.points(normals, threads=3).points.tobytes()
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
    one, other = (gm.sample(plates, 250, threads=x) for x in (1, 3))
    again = gm.sample(pickle.loads(pickle.dumps(plates)), 250)
    for name, array in one.arrays().items():
        assert np.array_equal(array, getattr(other, name))
        assert np.array_equal(array, getattr(again, name))


@pytest.mark.parametrize(("is_alone", "is_reversed"), [(False, False), (True, False), (True, True)])
def test_a_narrow_face_keeps_its_coverage(made, is_alone, is_reversed):
    """A sliver across the domain, thinner than cells: places next to its border cover it.

    Its first cell has one place only.
    """
    sliver = np.array([(0.0, 0.0), (1.0, 0.9999), (1.0, 1.0), (0.0, 0.0001)])
    ends, more = ((0.0, 1.0), (0.0, 1.0)), {} if is_alone else {"solid_index": 0}
    more |= {"loops": [sliver], "reversed": is_reversed}
    faces = [made.face("plane", made.placement(), *ends, 1e-4, **more)]
    faces += [] if is_alone else made.box_faces(2.0, 2.0, 2.0)
    samples = gm.sample(made.part(faces), coverage=0.1)
    along = np.linspace(0, 1, 2000)
    points = np.stack([along, 0.9999 * along + 5e-5, 0 * along], axis=1)
    assert gap(samples, points) <= 0.1
    assert samples.report.coverage <= 0.1
    assert not is_alone or gap(samples, points) <= samples.report.coverage
    assert (samples.face_index == 0).sum() >= 1


@pytest.mark.parametrize("inner", [0.499, 0.4999])
def test_coverage_holds_where_a_hole_touches_the_border(made, inner):
    """A face between two circles that touch is too narrow there for places beside its borders."""
    turns = np.linspace(0.0, made.TURN, 720, endpoint=False) - np.pi / 2
    circle, ends = np.stack([np.cos(turns), np.sin(turns)], axis=1), (-0.5, 0.5)
    loops = [0.5 * circle, inner * circle[::-1] + [0.0, inner - 0.5]]
    area = np.pi * (0.25 - inner**2)
    face = made.face("plane", made.placement(), ends, ends, area, loops=loops)
    samples = gm.sample(made.part([face]), coverage=0.02, density="uniform")
    borders = np.concatenate([x + t * (np.roll(x, -1, 0) - x) for x in loops for t in (0, 0.5)])
    points = np.column_stack([borders, np.zeros(len(borders))])
    assert gap(samples, points) <= 1.001 * samples.report.coverage <= 1.001 * 0.02


def test_failed_faces_are_left_out(made):
    faces = made.box_faces()
    faces[2] = FaceRecord(Geometry("unknown"), reason="it has no surface")
    flat = made.face("plane", made.placement(), (0.0, 1.0), (0.0, 1.0), 0.0)
    part = made.part([*faces, flat])
    with pytest.warns(gm.GaussmapWarning, match="2 of 7 faces cannot be sampled"):
        samples = gm.sample(part, 50)
    assert set(samples.face_index.tolist()) == {0, 1, 3, 4, 5}
    assert (samples.report.faces, samples.report.empty_faces) == (7, 2)
    assert "7 faces, 2 of them without samples" in samples.summary()


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"count": 10, "cells": (8, 8)}, "cells=... are for splines"),
        ({"count": 10, "on": "spline"}, "is for surfaces"),
        ({"count": 10, "density": "gauss"}, "goes with normals"),
        ({"count": 10, "density": "aligned"}, "is for surfaces"),
        ({"count": 10, "fields": ("row",)}, "on a grid only"),
        ({"coverage": 1e-9}, "more than"),
    ],
)
def test_unusable_arguments(cylinder, arguments, match):
    refused(match, gm.sample, cylinder, **arguments)


def test_samples_that_lack_what_is_needed(cylinder):
    few = gm.sample(cylinder, 20, fields=("points", "normals"))
    refused("weights of a part need", few.weights, error=gm.errors.MissingFieldError)
    arrays = {"points": few.points, "normals": few.normals}
    for name in arrays:
        unknown = {**arrays, name: np.where(np.arange(20)[:, None] == 7, np.nan, arrays[name])}
        bad = gm.Samples(**unknown, report=few.report, surface=cylinder)
        refused(f"{name} holds NaN", bad.normal_deviation)
        if name == "points":
            refused("points holds NaN", bad.coverage)


def test_parts_without_faces(made):
    with pytest.raises(gm.errors.SurfaceError, match="has no face that can be sampled"):
        gm.sample(made.part([]), 10)


def test_samples_in_files_and_other_methods(cylinder, tmp_path):
    samples = gm.sample(cylinder, 40)
    for name in ("a.npz", "a.ply"):
        samples.write(tmp_path / name)
        again = gm.read_samples(tmp_path / name)
        assert again.fields == samples.fields
        assert np.array_equal(again.face_index, samples.face_index)
        assert again.report == samples.report
    few = samples[:5]
    assert few.surface is cylinder
    assert len(gm.Samples.concatenate([few, few]).solid_index) == 10
    assert pickle.loads(pickle.dumps(samples)).surface.name == "cylinder"
    refused("does not say how its edges go around", samples.mesh)
    refused("of CAD parts only", gm.sample, "torus", 10, cells=(8, 8), fields=("face_index",))
    assert gm.sample("torus", 10, cells=(8, 8)).face_index is None
    chosen = gm.sample(cylinder, 10, fields=("points", "solid_index"))
    assert chosen.fields == ("points", "solid_index")
    assert gm.sample(cylinder, 10, dtype=np.float32).points.dtype == np.float32


def test_candidates_for_normals_are_no_more_than_asked(plates):
    space = space_of(plates, 1)
    for most in (0, 500):
        cells = space.cut_by_normals(1e-3, most)
        assert sum(map(len, cells)) <= most + len(space.first)
    (whole,) = space.cut_by_normals(0.2, np.inf)  # few are enough: the chord is the one asked for
    assert whole.numbers[:, 4].max() <= 0.5


def test_places_along_borders_are_inside_with_limits_of_their_face(parts):
    space = space_of(parts.all_kinds(), 1)
    lines = space.borders
    assert len(lines.pieces) > 1
    limits = np.split(lines.limits, lines.starts[1:-1])
    for number, part in zip(lines.pieces, limits, strict=True):
        own = space.first.limits[space.first.pieces == number]
        assert len(part) > 4
        assert np.isin(part, own).all()
    found = space.along_borders(0.1 * math.sqrt(space.area))
    assert set(found.pieces) == set(lines.pieces)
    assert space.trims.contains(found.pieces, found.places).all()


def test_five_percent_of_a_count_go_where_normals_are_missing(parts, monkeypatch):
    name = "gaussmap.runtime.density.filling.choose_apart"
    numbers, choose = [], pkgutil.resolve_name(name)

    def recorded(normals, near, threads, widest, number, known):
        numbers.append(number)
        return choose(normals, near, threads, widest, number, known)

    monkeypatch.setattr(name, recorded)
    samples = gm.sample(parts.all_kinds(), 300)
    assert numbers == [15]
    assert samples.normal_deviation().normal_space < 6.5


def test_every_face_has_a_sample_if_there_are_twice_as_many(made):
    """Nine faces of one square, between lines of which two are close together."""
    ends = (0.0, 1.0), (1.0, 1.001), (1.001, 2.0)
    faces = [
        made.face("plane", made.placement(), u, v, (u[1] - u[0]) * (v[1] - v[0]))
        for u in ends
        for v in ends
    ]
    part = made.part(faces, "nine")
    assert gm.sample(part, 17).report.empty_faces > 0
    assert gm.sample(part, 18).report.empty_faces == 0


def test_candidates_for_missing_normals_are_dense_and_few(parts, monkeypatch):
    """With normals twice as far apart, 2.6° are left; twice as near, there are 7 a sample."""
    part, numbers, cut = parts.all_kinds(), [], PartSpace.cut_by_normals

    def recorded(*arguments):
        cells = list(cut(*arguments))
        numbers.append(sum(map(len, cells)))
        return cells

    monkeypatch.setattr(PartSpace, "cut_by_normals", recorded)
    gm.sample(part, 300)
    assert numbers.pop() < 4 * 300
    assert gm.sample(part, 3000).normal_deviation().normal_space < 2.3


def test_a_part_has_some_candidates_for_each_sample(cylinder, monkeypatch):
    """Squares of circumradius 0.4 r have an area of 0.32 r², a sample has r²/0.6: five, or more.

    With a quarter of them gaps are wider; four times as many take as much more time and memory.
    """
    numbers, cut = [], PartSpace.cut

    def recorded(*arguments):
        cells = cut(*arguments)
        numbers.append(len(cells))
        return cells

    monkeypatch.setattr(PartSpace, "cut", recorded)
    gm.sample(cylinder, 1000, density="uniform")
    assert 4.0 < max(numbers) / 1000 < 10.0


@pytest.mark.parametrize("count", [300, 1000])
def test_the_widest_angle_on_a_sphere_is_found(made, count):
    """It is that of the largest empty circle: around a face of the convex hull of the samples."""
    ends = (0.0, made.TURN), (-np.pi / 2, np.pi / 2)
    ball = made.face("sphere", [*made.placement(), 1.0], *ends, 4 * np.pi, (made.TURN, 0.0))
    samples = gm.sample(made.part([ball]), count, density="uniform")
    expected = np.degrees(np.arccos(-ConvexHull(samples.points).equations[:, 3].max()))
    for found in samples.normal_deviation():
        assert 0.99 * expected < found < 1.0001 * expected


def test_flat_faces_get_their_share(parts):
    """The target density is 0.8 of the mean of κ² at least: a torus has more, a plane not."""
    part = parts.all_kinds()
    counts = np.bincount(gm.sample(part, 1000).face_index, minlength=len(part.faces))
    kinds = [face.kind for face in part.faces]
    ratio = counts[kinds.index("torus")] / counts[kinds.index("plane")]
    assert ratio == pytest.approx(7.4, rel=0.1)


def test_a_coverage_that_no_number_of_samples_has(parts) -> None:
    """Its inverse overflows."""
    refused("would have to be searched in more than", gm.sample, parts.box(), coverage=1e-320)


def test_samples_beside_borders_are_inside(plates):
    samples = gm.sample(plates, 2000, density="uniform")
    hole = np.linalg.norm(samples.uv[samples.face_index == 0] - 0.5, axis=1)
    assert 0.2999 < hole.min() < 0.3001  # a circle of 720 chords


@pytest.mark.parametrize(("points", "parts"), [(10, 2), (35, 2), (36, 1)])
def test_dense_nets_have_one_first_cell_for_each_span(made, points, parts):
    """Two for each span along a parameter, as long as there are no more than 64."""
    spans = points - 3
    knots = np.concatenate([[0.0] * 3, np.arange(spans + 1.0), [float(spans)] * 3])
    grid = np.stack(np.meshgrid(*2 * [np.arange(float(points))], indexing="ij"), axis=-1)
    net = Net((3, 3), (knots, knots), np.dstack([grid, np.sin(grid[:, :, 0])]))
    ends = 0.0, float(spans)
    loops = [made.rectangle(*ends, *ends)]
    face = FaceRecord(Geometry("nurbs", net=net), (ends, ends), loops=loops, area=1.0)
    assert len(space_of(made.part([face]), 1).pieces[0].boxes) == (parts * spans) ** 2


def test_borders_are_measured_in_groups(made, monkeypatch):
    """What is found does not depend on the size of the groups."""
    whole = space_of(made.cylinder(), 1).borders
    monkeypatch.setattr("gaussmap.runtime.density.space.PLACES_AT_A_TIME", 1000)
    some = space_of(made.cylinder(), 1).borders
    assert len(whole.rows) > 2000
    for name in ("pieces", "starts", "places", "rows", "limits"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(some, name))
