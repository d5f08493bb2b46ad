"""Points with given normals where faces meet smoothly: each of them is there once."""

import itertools

import gaussmap as gm
import numpy as np
import pytest

from .made import HALF, TURN, moved, rectangle

QUARTER = np.pi / 2.0
ANGLES = np.linspace(0.1, 6.2, 50)
TILT = np.linalg.qr(np.array([(3.0, 1, 2), (1, 4, 1), (2, -1, 5)]))[0]


def cut(surface: gm.Surface, u, v, matrix=None) -> gm.Surface:
    """Return the part of a surface over a rectangle, moved."""
    found = gm.Surface.from_callable(surface.function, (u, v))
    return found if matrix is None else found.transformed(matrix)


def halves(matrix=None, shift: float = 0.0, *, trimmed: bool = False) -> list[gm.Surface]:
    """Return two halves of a unit sphere, the second one moved; they meet in the plane y = 0."""
    sphere, turns = gm.surfaces.sphere(), ((0.0, np.pi), (np.pi, TURN))
    found = [
        sphere.trimmed([rectangle(x, HALF)]) if trimmed else cut(sphere, x, HALF) for x in turns
    ]
    found[1] = moved(found[1], (shift, 0.0, 0.0))
    return found if matrix is None else [x.transformed(matrix) for x in found]


def meridian(angles=ANGLES) -> np.ndarray:
    return np.stack([np.cos(angles), 0.0 * angles, np.sin(angles)], axis=1)


def latitude(v: float) -> np.ndarray:
    around = np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)
    return np.column_stack([np.cos(v) * around, np.full(len(ANGLES), np.sin(v))])


@pytest.mark.parametrize("trimmed", [False, True])
@pytest.mark.parametrize("matrix", [np.eye(3), TILT], ids=["", "tilted"])
def test_each_point_of_a_sphere_is_there_once(matrix, trimmed):
    """At poles four borders end; the even-odd rule of trims gives a point to one side itself."""
    gauss_map = gm.GaussMap(gm.Part(halves(matrix, trimmed=trimmed)))
    normals = np.concatenate([meridian(), np.eye(3), -np.eye(3)]) @ matrix.T
    assert (gauss_map.count(normals) == 1).all()
    assert (gauss_map.degree(normals) == 1).all()
    samples = gauss_map.points(normals)
    np.testing.assert_allclose(samples.points, normals[samples.normal_index], atol=1e-14)
    assert trimmed or (np.asarray(samples.face_index)[samples.normal_index < 50] == 0).all()


@pytest.mark.parametrize("v", [1.0, 2.0], ids=["elliptic", "hyperbolic"])
def test_each_point_of_a_torus_is_there_once(v):
    torus = gm.surfaces.torus()
    part = gm.Part([cut(torus, (0, TURN), (0, v), TILT), cut(torus, (0, TURN), (v, TURN), TILT)])
    gauss_map = gm.GaussMap(part)
    assert (gauss_map.count(latitude(v) @ TILT.T) == 2).all()
    assert (gauss_map.degree(latitude(v) @ TILT.T) == 0).all()


def test_each_point_of_a_seam_is_there_once():
    zone = cut(gm.surfaces.sphere(), (0, TURN), (-1.0, 1.0), np.diag([1.0, 2.0, 1.0]))
    angles = np.linspace(-0.9, 0.9, 20)
    samples = gm.GaussMap(gm.Part([zone])).points(meridian(angles))
    assert samples.normal_index.tolist() == list(range(20))
    np.testing.assert_allclose(samples.uv, np.stack([0.0 * angles, angles], axis=1), atol=1e-9)


def test_where_curvature_changes_its_sign_both_faces_have_the_point():
    """A ball with a neck: the Gauss map has a fold at the edge, with two points or none beside."""
    v, radius = 0.5, 0.5
    ball = cut(gm.surfaces.sphere(), (0, TURN), (-QUARTER, v))
    neck = gm.surfaces.torus((1.0 + radius) * np.cos(v), radius)
    neck = moved(cut(neck, (0, TURN), (np.pi, np.pi + v)), (0.0, 0.0, (1.0 + radius) * np.sin(v)))
    gauss_map = gm.GaussMap(gm.Part([ball, neck]))
    for angle, count in ((v - 1e-4, 2), (v, 2), (v + 1e-4, 0)):
        assert (gauss_map.count(latitude(angle)) == count).all()
        assert (gauss_map.degree(latitude(angle)) == 0).all()


@pytest.mark.parametrize(("gap", "count"), [(1e-8, 1), (1e-6, 2)])
def test_faces_may_be_apart_by_rounding(gap, count):
    part = gm.Part(halves(shift=gap), tolerance=1e-4)
    assert (gm.GaussMap(part).count(meridian(np.array([2.0, 4.0]))) == count).all()


def test_faces_that_only_touch_have_points_of_their_own():
    # Inside of the sphere, in contact with it at its edge.
    cap = moved(cut(gm.surfaces.sphere(), (2.0, 4.0), (-1.0, 1.0)), (-0.5, 0.0, 0.0), 0.5)
    samples = gm.GaussMap(gm.Part([*halves(), cap])).points([[-1.0, 0.0, 0.0]])
    assert np.asarray(samples.face_index).tolist() == [0, 2]
    np.testing.assert_allclose(samples.points, [[-1.0, 0.0, 0.0]] * 2, atol=1e-14)


def test_gaps_are_filled_beside_what_is_left():
    samples = gm.sample(gm.Part(halves()), normals=meridian(), coverage=0.3)
    assert (np.bincount(samples.normal_index[samples.normal_index >= 0]) == 1).all()
    assert (samples.report.coverage or np.inf) <= 0.3
    assert len(samples) == samples.report.samples > 50


def circle() -> np.ndarray:
    """Return x, y and weights (3, 7) of a circle of three rational spans."""
    angles, radii = np.arange(7) * np.pi / 3.0, 1.0 + np.arange(7) % 2
    return np.stack([radii * np.cos(angles), radii * np.sin(angles), 1.0 / radii])


def torus_net(digits: int, *, flat: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return points and weights of a tilted torus of 3 × 3 rational spans, with some digits.

    A flat one has its circles around the axis along v; the normals of each are close together.
    """
    x, y, weights = circle()
    reach, height = 1.0 + 0.4 * x, np.broadcast_to(0.4 * y, (7, 7))
    points = np.dstack([np.outer(x, reach), np.outer(y, reach), height])
    if flat:
        points = points.swapaxes(0, 1)[::-1] * [1.0, 1.0, 0.05]
    return (points @ TILT.T).round(digits), np.outer(weights, weights)


def nurbs_torus(first: int, last: int, digits: int = 17, *, flat: bool = False) -> gm.Surface:
    """Return some thirds of the torus of `torus_net`."""
    knots, some = np.repeat(np.arange(4), [3, 2, 2, 3]), slice(2 * first, 2 * last + 1)
    ends = np.repeat(np.arange(first, last + 1), [3, *[2] * (last - first - 1), 3])
    points, weights = (x[some] for x in torus_net(digits, flat=flat))
    return gm.Surface.from_nurbs((2, 2), (ends, knots), points, weights)


@pytest.mark.parametrize("cuts", [[0, 3], [0, 1, 3], [0, 1, 2, 3]])
def test_circles_over_edges_are_one_component(cuts):
    faces = [nurbs_torus(*x) for x in itertools.pairwise(cuts)]
    gauss_map = gm.GaussMap(gm.Part(list(reversed(faces))))
    normals = np.concatenate([np.eye(3), -np.eye(3), gm.fibonacci(50)]) @ TILT.T
    samples = gauss_map.points(normals)
    assert (samples.report.proved, samples.report.estimated_faces) == (len(normals), 0)
    curves = np.isin(np.arange(len(normals)), [2, 5])
    assert gauss_map.count(normals).tolist() == np.where(curves, 1, 2).tolist()
    assert (gauss_map.degree(normals) == 0).all()
    on_curve = samples[samples.component == gm.Component.CURVE]
    assert on_curve.normal_index.tolist() == [2, 5]
    assert (np.asarray(on_curve.face_index) == 0).all()


@pytest.mark.parametrize("matrix", [np.eye(3), TILT], ids=["", "tilted"])
def test_planes_with_what_meets_them_smoothly_are_one_component(matrix):
    """The top of a box in two rectangles, with a fillet that ends in a rounded corner."""
    to_y = np.array([(0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)])  # the z axis
    faces = [
        cut(gm.surfaces.plane(), (0.0, 1.0), (0.0, 1.0)),
        cut(gm.surfaces.plane(), (1.0, 2.0), (0.0, 1.0)),
        moved(cut(gm.surfaces.sphere(), (0.0, QUARTER), (0.0, QUARTER)), (2.0, 1.0, -1.0)),
        moved(cut(gm.surfaces.cylinder(), (0.0, QUARTER), (0.0, 0.5), to_y), (2.0, 0.0, -1.0)),
    ]
    gauss_map = gm.GaussMap(gm.Part([x.transformed(matrix) for x in faces]))
    normals = np.array([(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (1.0, 0.0, 0.0)]) @ matrix.T
    samples = gauss_map.points(normals)
    assert (samples.normal_index.tolist(), samples.report.proved) == ([0, 1, 2], 3)
    assert np.asarray(samples.component).tolist() == [gm.Component.CURVE] * 3
    assert np.asarray(samples.face_index).tolist() == [0, 3, 3]


@pytest.mark.parametrize("trimmed", [False, True])
def test_normals_in_the_gap_of_digits_have_each_point_once(trimmed):
    """Normals of an edge are between those of both faces, or both have the point.

    Next to the circles with one normal K is small: both points are far apart, or listed.
    """
    faces = [nurbs_torus(0, 1, 10), nurbs_torus(1, 3, 10)]
    if trimmed:
        faces = [
            nurbs_torus(0, 3, digits).trimmed([rectangle(u, (0.0, 3.0))])
            for digits, u in ((10, (0.0, 1.0)), (17, (1.0, 3.0)))
        ]
    part = gm.Part(faces, tolerance=1e-6)
    assert part.faces[0].kind == "nurbs"
    angles = np.concatenate([ANGLES[::5], np.pi / 2 + np.linspace(-4e-3, 4e-3, 4)])
    turn, reach, height = 2.0 * np.pi / 3.0, np.cos(angles), np.sin(angles)
    at_edge = np.stack([reach * np.cos(turn), reach * np.sin(turn), height], axis=1)
    across = np.array([-np.sin(turn), np.cos(turn), 0.0])
    steps = (-1e-9, -3e-10, -2e-11, -5e-12, 0.0, 5e-12, 2e-11, 3e-10, 1e-9)
    samples = gm.GaussMap(part).points(np.vstack([at_edge + x * across for x in steps]) @ TILT.T)
    listed = {x.normal for x in samples.report.undecided or ()}
    assert np.abs(np.tile(reach, len(steps))[list(listed)]).max(initial=0.0) < 0.01
    wrong = np.bincount(samples.normal_index) != 2
    assert set(np.flatnonzero(wrong).tolist()) <= listed


def sides_of(points, weights, row: int) -> np.ndarray:
    """Return points, and normals of both sides, (3, k, 3), on a row of a net of conics.

    Tangent planes are those of the curves of the row and of the rows beside it.
    """
    net, t = np.dstack([points * weights[..., None], weights]), np.linspace(0.1, 0.9, 9)
    value = np.stack([(1 - t) ** 2, 2 * t * (1 - t), t**2], axis=1)
    slope = np.stack([2 * t - 2, 2 - 4 * t, 2 * t], axis=1)
    found = []
    for first in range(0, net.shape[1] - 1, 2):
        before, on, after = net[row - 1 : row + 2, first : first + 3]
        x = (value @ on)[:, :3] / (value @ on)[:, 3:]
        vectors = slope @ on, value @ before, value @ after
        along, left, right = (y[:, :3] - y[:, 3:] * x for y in vectors)
        normals = np.stack([-np.cross(left, along), np.cross(right, along)])
        found.append([x, *(normals / np.linalg.norm(normals, axis=2, keepdims=True))])
    return np.concatenate(found, axis=1)


@pytest.mark.parametrize(
    ("row", "flat", "least"), [(2, False, 0.9), (4, False, 0.5), (2, True, 0.9)],
    ids=["edge", "knot of a face", "narrow circle"],
)  # fmt: skip
def test_normals_between_those_of_both_sides_have_a_point_there(row, flat, least):
    """Gaps of 7 digits are creases."""
    net = torus_net(7, flat=flat)
    faces = [nurbs_torus(*x, 7, flat=flat) for x in ((0, 1), (1, 3))]
    gauss_map = gm.GaussMap(gm.Part(faces, tolerance=1e-5))
    x, one, other = sides_of(*net, row)
    shares = np.array([-0.6, -0.3, 0.3, 0.5, 0.7, 1.3, 1.6])[:, None, None]
    normals = ((1.0 - shares) * one + shares * other).reshape(-1, 3)
    samples = gauss_map.points(normals)
    known = ~np.isin(np.arange(len(normals)), [y.normal for y in samples.report.undecided or ()])
    assert known.mean() > least
    at = np.tile(x, (len(shares), 1))[samples.normal_index]
    near = np.linalg.norm(samples.points - at, axis=1) < 0.05
    regular, creases = (
        np.bincount(samples.normal_index[near & (samples.component == y)], minlength=len(normals))
        for y in (gm.Component.REGULAR, gm.Component.CREASE)
    )
    between = np.repeat((shares.ravel() > 0.0) & (shares.ravel() < 1.0), len(x))
    wide = np.tile(np.linalg.norm(other - one, axis=1) > 1e-9, len(shares))
    assert (known & between & wide).sum() > 20
    np.testing.assert_array_equal(creases[known], (between & wide)[known])
    np.testing.assert_array_equal(regular[known & ~(between & wide)], 1)
    assert np.isin(regular[known], [0, 1, 2]).all()
    np.testing.assert_array_equal(gauss_map.degree(normals)[known], 0)


def test_faces_are_developable_up_to_their_digits():
    """The Gaussian curvature of a cone of 7 digits is rounding, that of a bowl of 8 is not."""
    x, y, weights = circle()
    points = np.stack([np.outer(x, [1, 2]), np.outer(y, [1, 2]), np.tile([0, 1], (7, 1))], 2)
    points, along = (points @ TILT.T).round(7), ([0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 2, 2, 2])
    cone = [
        gm.Surface.from_nurbs(
            (2, 1), (k, [0, 0, 1, 1]), points[some], np.outer(weights, [1, 1])[some]
        )
        for k, some in zip(along, (slice(0, 3), slice(2, 7)), strict=True)
    ]
    angles = 2.0 * np.pi / 3.0 + np.linspace(-3e-7, 3e-7, 61)
    normals = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles - 1.0], axis=1) @ TILT.T
    samples = gm.GaussMap(gm.Part(cone, tolerance=1e-5)).points([*normals, *-normals])
    assert (len(samples), samples.report.undecided) == (0, ())
    row, squares = np.array([-1, -0.5, 0, 0.5, 1]), np.array([1, 0, 0, 0, 1])
    shape = np.broadcast_arrays(row[:, None], [-1, 0, 1], (squares[:, None] + [1, -1, 1]) / 200.0)
    points, clamped = (np.stack(shape, axis=2) @ TILT.T).round(8), [0, 0, 0, 1, 1, 1]
    bowl = [gm.Surface.from_nurbs((2, 2), (clamped,) * 2, points[k : k + 3]) for k in (0, 2)]
    y, across = (x.ravel() for x in np.meshgrid(np.linspace(-0.9, 0.9, 41), [-1e-8, 0.0, 3e-9]))
    normals = np.stack([across, -y / 100.0, 1.0 + 0.0 * y], axis=1) @ TILT.T
    assert (gm.GaussMap(gm.Part(bowl, tolerance=1e-5)).degree(normals) == 1).all()
