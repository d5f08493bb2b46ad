"""Points of faces with given normals, against oracles that share no code with the project."""

# pyright: reportArgumentType=false, reportAttributeAccessIssue=false
# pyright: reportCallIssue=false

import itertools
import math
import pickle

import gaussmap as gm
import mpmath
import numpy as np
import pytest
from gaussmap.tools.cad.examples import all_kinds
from gaussmap.tools.cad.records import FaceRecord, Geometry
from scipy.spatial.transform import Rotation

from ...products import covering
from ...shapes import same
from .made import KINDS, TURN, UNIT, circle, face, net, nurbs, part, placement

# Frames (origin, columns x, y, z): turned, mirrored, far away, and neither orthogonal nor unit.
SKEW = np.array([[1.0, 0.2, 0.0], [0.0, 0.8, 0.1], [0.0, 0.0, 1.3]])
FRAMES = {
    "turned": ((1.0, -2.0, 3.0), Rotation.random(None, 1).as_matrix()),
    "mirrored": ((0.5, 0.0, 0.0), Rotation.random(None, 2).as_matrix() * [1.0, 1.0, -1.0]),
    "far": ((1e6, -1e6, 1e6), Rotation.random(None, 3).as_matrix()),
    "skew": ((0.0, 0.0, 1.0), Rotation.random(None, 4).as_matrix() @ SKEW),
}


def place_of(frame: str) -> np.ndarray:
    origin, columns = FRAMES[frame]
    return np.concatenate([origin, columns.T.ravel()])


# Radii, and windows of u and v; of the spindle the tube meets the axis.
ROUND = {
    "sphere": (0.0, 2.0, (0.4, 5.9), (-1.1, 1.4)),
    "torus": (3.0, 1.0, (0.4, 5.9), (2.0, 7.0)),
    "inner torus": (3.0, -1.0, (0.4, 5.9), (2.0, 7.0)),
    "spindle torus": (1.0, 2.0, (0.0, TURN), (0.0, TURN)),
}


@covering(scale=[1e-6, 1.0, 1e6], is_reversed=[False, True], frame=FRAMES, kind=ROUND)
def test_points_of_spheres_and_tori(kind, frame, is_reversed, scale):
    """Places are found once, by normals that are those of the tube; and no others are found.

    Where the distance ρ from the axis is negative, x_u × x_v points to the other side.
    """
    major, minor, *window = ROUND[kind]
    low, high = np.transpose(window)
    u, v = np.random.default_rng(0).uniform(low, high, (400, 2)).T
    circle, zero = np.stack([np.cos(u), np.sin(u)], axis=1), np.zeros((400, 1))
    outward = np.hstack([circle * np.cos(v)[:, None], np.sin(v)[:, None]])
    origin, columns = FRAMES[frame]
    points = scale * (major * np.hstack([circle, zero]) + minor * outward) @ columns.T + origin
    side = np.sign(minor * (major + minor * np.cos(v))) * np.sign(np.linalg.det(columns))
    normals = (-1.0 if is_reversed else 1.0) * side[:, None] * outward @ np.linalg.inv(columns)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lengths = scale * (np.array([major, minor]) if major else np.array([minor]))
    more = {"place": place_of(frame), "reversed": is_reversed}
    known = part([face(kind.split()[-1], *lengths, u=window[0], v=window[1], **more)])
    samples = gm.sample(known, normals=normals)
    assert (samples.report.proved, samples.report.undecided) == (400, ())
    away = np.linalg.norm(samples.points - points[samples.normal_index], axis=1)
    near = away <= 1e-13 * scale + 1e-15 * np.abs(origin).max()
    assert (np.bincount(samples.normal_index[near], minlength=400) == 1).all()
    there = known.faces[0].surface.normals(*samples.uv.T)
    np.testing.assert_allclose(there, normals[samples.normal_index], atol=1e-13)
    if is_reversed:
        samples.uv[:, 0] = low[0] + high[0] - samples.uv[:, 0]
    assert ((samples.uv >= low) & (samples.uv <= high)).all()
    each = np.column_stack([samples.normal_index, samples.uv.round(9)])
    assert len(np.unique(each, axis=0)) == len(samples)
    rates = np.cos(samples.uv[:, 1])
    assert (samples.gaussian_curvature * rates * minor * (major + minor * rates) > 0.0).all()


@pytest.mark.parametrize("frame", FRAMES)
def test_radii_contain_the_exact_parameters(frame):
    """50 digits, next to poles, too."""
    near = np.array([1.0, 0.3, 1e3]) * 10.0 ** -np.arange(0, 9)[:, None]
    near[:, 2] = 1.0
    columns = FRAMES[frame][1]
    normals = np.concatenate(
        [gm.directions.random(300, seed=0), near @ np.linalg.inv(columns) * [1, 1, 1]]
    )
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    ball = part([face("sphere", 1.0, place=place_of(frame))])
    samples = gm.sample(ball, normals=normals)
    assert len(samples) == len(normals)
    side, ratios = np.sign(np.linalg.det(columns)), []
    with mpmath.workdps(50):
        for n, uv, radius in zip(normals, samples.uv, samples.uv_radius, strict=True):
            x, y, z = (
                side * sum(mpmath.mpf(columns[i, k]) * mpmath.mpf(n[i]) for i in range(3))
                for k in range(3)
            )
            exact = mpmath.atan2(y, x) % (2 * mpmath.pi), mpmath.atan2(z, mpmath.hypot(x, y))
            off = [abs(mpmath.mpf(a) - b) for a, b in zip(uv, exact, strict=True)]
            off[0] = min(off[0], 2 * mpmath.pi - off[0])
            ratios.append([float(a / mpmath.mpf(r)) for a, r in zip(off, radius, strict=True)])
    largest = np.max(ratios, axis=0)
    assert (largest <= 1.0).all()
    assert (largest > 0.005).all()  # and are not far too wide


def test_the_pole_of_a_sphere():
    ball, poles = part([face("sphere", 2.0)]), [[0, 0, 1], [0, 0, -1], [1e-12, 0, 1]]
    samples = gm.sample(ball, normals=poles)
    assert samples.normal_index.tolist() == [0, 1, 2]
    np.testing.assert_allclose(samples.points, 2.0 * samples.normals, atol=1e-15)
    np.testing.assert_allclose(samples.gaussian_curvature, 0.25, rtol=1e-6)
    np.testing.assert_allclose(samples.mean_curvature, 0.5, rtol=1e-6)
    assert samples.report.proved == 3


@pytest.mark.parametrize("is_reversed", [False, True])
def test_planes_cylinders_and_cones_have_lines_of_points(is_reversed):
    """Their normals are known to be those of curves; all others have no point."""
    sign, angle = -1.0 if is_reversed else 1.0, 0.3
    more = {"reversed": is_reversed}
    lines = part([
        face("plane", v=(0.0, 2.0), **more),
        face("cylinder", 1.5, u=(0.5, 2.5), v=(-1.0, 1.0), **more),
        face("cone", 1.0, angle, u=(0.5, 2.5), v=(0.0, 2.0), **more),
    ])  # fmt: skip
    phi = 1.25
    across = np.array([math.cos(phi), math.sin(phi), 0.0])
    normals = sign * np.array([
        [0.0, 0.0, 1.0],
        across,
        math.cos(angle) * across - [0.0, 0.0, math.sin(angle)],
        [math.cos(4.0), math.sin(4.0), 0.0],  # beyond the end
        [1e-9, 0.0, 1.0],
        math.cos(angle) * across + [0.0, 0.0, math.sin(angle)],
    ])  # fmt: skip
    with pytest.warns(gm.GaussmapWarning, match="is flat"):
        samples = gm.sample(lines, normals=normals)
    assert (samples.component == gm.Component.CURVE).all()
    assert (samples.report.proved, samples.report.undecided) == (6, ())
    assert "3 on curves with one normal" in samples.summary()
    assert samples.normal_index.tolist() == samples.face_index.tolist() == [0, 1, 2]
    u = 3.0 - phi if is_reversed else phi
    expected = [(0.5, 1.0), (u, 0.0), (u, 1.0)]
    np.testing.assert_allclose(samples.uv, expected, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(samples.uv_radius[:, 1], 1.0, rtol=1e-15)
    assert (samples.uv_radius[1:, 0] < 1e-13).all()
    known = lines.faces[2].surface.normals(u, 1.0)
    np.testing.assert_allclose(known, normals[2], atol=1e-14)


def test_rulings_are_cut_by_trims():
    """The face is a letter M, with u from 0.5 to 2.5; rulings run through the domain."""
    loop = np.array([(0.5, 0.0), (2.5, 0.0), (1.5, 1.0)])
    loop = np.concatenate([loop, [(2.5, 2.0), (0.5, 2.0)]])
    band = face("cylinder", 1.5, u=(0.0, 3.0), v=(0.0, 2.0), area=3.0, loops=[loop])
    angles = np.array([0.3, 0.499, 0.501, 1.4, 1.6, 2.4, 2.7])
    normals = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
    known = gm.GaussMap(part([band]))
    samples = known.points(normals)
    assert (samples.report.proved, samples.report.undecided) == (7, ())
    assert samples.normal_index.tolist() == [2, 3, 4, 4, 5, 5]
    assert known.count(normals).tolist() == [0, 0, 1, 1, 2, 2, 0]
    np.testing.assert_allclose(samples.uv[:, 0], angles[samples.normal_index], atol=1e-14)
    for place, (u, v) in zip(samples.uv_radius, samples.uv, strict=True):
        length = 2.0 if u < 1.5 else 2.5 - u  # of the piece
        assert length / 2.0 <= place[1] <= length + 0.02
        assert u < 1.5 or abs(v - 1.0) > u - 1.5


def test_both_sides_of_an_apex():
    """Below it ρ < 0, and x_u × x_v points to the axis: at the angle π from n."""
    cone = part([face("cone", 0.0, 0.5, v=(-1.0, 1.0), area=3.0)])
    normals = np.array([[math.cos(0.5), 0.0, s * math.sin(0.5)] for s in (-1.0, 1.0)])
    found = gm.GaussMap(cone).points(normals)
    assert found.component.tolist() == [gm.Component.CURVE] * 2
    np.testing.assert_allclose(found.uv, [(0.0, 0.5), (math.pi, -0.5)], atol=1e-14)
    np.testing.assert_allclose(
        cone.faces[0].surface.normals(*found.uv.T), normals, rtol=0.0, atol=1e-14
    )


# --- faces of splines: places whose normals are known by differences ------------------------------

NODES = np.arange(3) / 2
GRID = np.stack(np.meshgrid(NODES, NODES, indexing="ij"), axis=-1)
HEIGHTS = GRID[..., 0] ** 2 + GRID[..., 0] * GRID[..., 1]
POINTS, WEIGHTS = np.dstack([GRID, HEIGHTS]), 1.0 + GRID.prod(axis=2)
DIFFERENCE = [(-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12)]


def bernstein(t: np.ndarray) -> np.ndarray:
    return np.stack([(1 - t) ** 2, 2 * t * (1 - t), t**2], axis=-1)


def on_net(u: np.ndarray, v: np.ndarray, weights: np.ndarray = WEIGHTS) -> np.ndarray:
    b = np.einsum("ki,kj,ij->kij", bernstein(u), bernstein(v), weights)
    return np.einsum("kij,ijx->kx", b, POINTS) / b.sum(axis=(1, 2))[:, None]


def on_curve(t: np.ndarray) -> np.ndarray:
    b = bernstein(t) * WEIGHTS[1]
    return (b @ (POINTS[1] + [1.0, 0.0, 0.0])) / b.sum(axis=1)[:, None]


def turned(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    (x, y, z), c, s = on_curve(v).T, np.cos(u), np.sin(u)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=1)


def tangents(f, u: np.ndarray, v: np.ndarray, h: float) -> np.ndarray:
    """Return x_u and x_v (2, k, 3), by differences of fourth order."""
    return np.stack([
        sum(c * f(u + k * h * du, v + k * h * dv) for k, c in DIFFERENCE) / h
        for du, dv in ((1.0, 0.0), (0.0, 1.0))
    ])  # fmt: skip


def offset_by(distance: float):
    def position(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        normal = np.cross(*tangents(on_net, u, v, 2.0**-10))
        return on_net(u, v) + distance * normal / np.linalg.norm(normal, axis=1)[:, None]

    return position


def in_polygon(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return what is inside of 24 corners at the distance 0.4 from the middle, one of them at 0."""
    r, angle, part = np.hypot(u - 0.5, v - 0.5), np.arctan2(v - 0.5, u - 0.5), TURN / 24
    return r * np.cos(angle % part - part / 2) < 0.4 * math.cos(part / 2)


def normals_by_differences(f, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    found = np.cross(*tangents(f, u, v, 2.0**-8))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def times_found(samples: gm.Samples, own: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return how many points of each normal are at its place; `own` are their parameters."""
    away = np.abs(own - places[samples.normal_index]) - samples.uv_radius
    return np.bincount(samples.normal_index[away.max(axis=1) < 1e-5], minlength=len(places))


def faces_of_splines() -> dict:
    """Return geometries of faces, and their positions."""
    curve, axis = net(POINTS[1] + [1.0, 0.0, 0.0], WEIGHTS[1]), np.eye(6)[5]
    rational = nurbs(POINTS, WEIGHTS)
    return {
        "nurbs": (nurbs(POINTS), lambda u, v: on_net(u, v, np.ones((3, 3)))),
        "rational": (rational, on_net),
        "revolution": (Geometry("revolution", axis, curve), turned),
    } | {
        f"offset {x}": (Geometry("offset", np.array([x]), basis=rational), offset_by(x))
        for x in (0.1, -1.5, 3.0)
    }


@pytest.mark.parametrize("is_reversed", [False, True])
@pytest.mark.parametrize("name", faces_of_splines())
@pytest.mark.quick_for("nurbs", "revolution")
def test_points_of_faces_of_splines(name, is_reversed):
    """Random places are found once, and all that is found is inside and has the normal."""
    geometry, f = faces_of_splines()[name]
    ends, loops = (0.1, 0.9), [0.5 + circle(0.4, 24)]
    trimmed = FaceRecord(geometry, (ends, ends), loops=loops, area=0.5, reversed=is_reversed)
    places = np.random.default_rng(7).uniform(0.1, 0.9, (100, 2))
    regular = np.linalg.norm(np.cross(*tangents(f, *places.T, 2.0**-8)), axis=1) > 0.02
    places = places[regular & in_polygon(*places.T)]
    sign = -1.0 if is_reversed else 1.0
    normals = sign * normals_by_differences(f, *places.T)
    samples = gm.sample(part([trimmed]), normals=normals)
    assert (samples.report.estimated_faces, samples.report.proved) == (0, len(places))
    own = samples.uv * [sign, 1.0] + [float(is_reversed), 0.0]
    assert (times_found(samples, own, places) == 1).all()
    assert in_polygon(*own.T).all()
    there = sign * normals_by_differences(f, *own.T)
    np.testing.assert_allclose(there, normals[samples.normal_index], atol=1e-6)
    each = np.column_stack([samples.normal_index, own.round(4)])
    assert len(np.unique(each, axis=0)) == len(own)


def untrimmed(geometry: Geometry) -> gm.Part:
    return part([FaceRecord(geometry, (UNIT, UNIT), area=0.5)])


def test_where_the_side_of_an_offset_is_open_is_said():
    """An offset to the centre of curvature has no normal there, and opposite ones around it."""
    basis = untrimmed(nurbs(POINTS)).faces[0].surface
    x_u, x_v, x_uu, x_uv, x_vv = basis.derivatives(0.4, 0.6)[1:]
    normal = np.cross(x_u, x_v) / np.linalg.norm(np.cross(x_u, x_v))
    first = np.array([[x_u @ x_u, x_u @ x_v], [x_u @ x_v, x_v @ x_v]])
    second = np.array([[x_uu @ normal, x_uv @ normal], [x_uv @ normal, x_vv @ normal]])
    for curvature in np.linalg.eigvals(np.linalg.solve(first, second)).tolist():
        for factor, count in ((1.0 - 1e-6, 1), (1.0, 0), (1.0 + 1e-6, 1)):
            offset = Geometry("offset", np.array([factor / curvature]), basis=nurbs(POINTS))
            samples = gm.GaussMap(untrimmed(offset)).points(np.array([normal, -normal]))
            near = np.abs(samples.uv - [0.4, 0.6]).max(axis=1) < 1e-9
            assert near.sum() == count
            places = [x.box for x in samples.report.undecided if x.kind == "open"]
            holds = [u0 <= 0.4 <= u1 and v0 <= 0.6 <= v1 for u0, u1, v0, v1 in places]
            assert any(holds) == (count == 0)


@pytest.mark.slow
def test_a_triangular_face():
    """Its side u = 1 is a point, where x_u × x_v vanishes: only normals beside it are undecided."""
    points = POINTS.copy()
    points[2] = [1.0, 0.4, 0.7]

    def f(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.einsum("ki,kj,ijx->kx", bernstein(u), bernstein(v), points)

    random = np.random.default_rng(3)
    u = np.concatenate([np.linspace(0.1, 0.9, 20), 1.0 - np.logspace(-1, -6, 20)])
    places = np.stack([u, random.uniform(0.1, 0.9, 40)], axis=1)
    places = np.concatenate([places, random.uniform(0.02, 0.97, (200, 2))])
    normals = normals_by_differences(f, *places.T)
    samples = gm.GaussMap(untrimmed(nurbs(points))).points(normals)
    boxes: dict[int, list[tuple[float, ...]]] = {}
    for x in samples.report.undecided:
        boxes.setdefault(x.normal, []).append(x.box)
    assert set(boxes) <= set(range(23, 40))
    for k, (u, v) in enumerate(places):
        assert k not in boxes or any(x[0] <= u <= x[1] and x[2] <= v <= x[3] for x in boxes[k])
    known = ~np.isin(np.arange(240), [*boxes])
    assert (times_found(samples, samples.uv, places)[known] == 1).all()
    away = samples.uv[:, 0] < 0.97
    there = normals_by_differences(f, *samples.uv[away].T)
    np.testing.assert_allclose(there, normals[samples.normal_index[away]], atol=1e-6)


def test_the_kinds_that_are_proved():
    samples = gm.GaussMap(KINDS).points(gm.fibonacci(500))
    assert (samples.report.estimated_faces, samples.report.proved) == (0, 500)
    assert set(samples.face_index.tolist()) == {2, 4, 5, 6, 7, 9}
    assert np.isfinite(samples.uv_radius).all()


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_the_parts_of_a_closed_surface_have_its_degree(scale):
    """A torus in six faces, cut by slanted lines: Σ sign K is 0, and there are two points."""
    lines = np.linspace(0.0, TURN, 7)
    sizes, place, faces = (3.0 * scale, scale), placement((1e6, 0.0, 0.0)), []
    for low, high in itertools.pairwise(lines):
        loop = np.array([(low, 0.0), (high, 0.0), (high + 0.5, TURN), (low + 0.5, TURN)])
        faces.append(face("torus", *sizes, u=(low, high + 0.5), place=place, loops=[loop]))
    known, normals = gm.GaussMap(part(faces)), gm.directions.random(2000, seed=9)
    assert (known.count(normals) == 2).all()
    assert (known.degree(normals) == 0).all()


def test_what_has_no_bounds_is_estimated():
    """Degrees 13 × 13 have too many coefficients."""
    nodes = np.linspace(0.0, 1.0, 14)
    x, y = np.meshgrid(nodes, nodes, indexing="ij")
    sheet = nurbs(np.stack([x, y, x * x - y * y], axis=2), knots=np.repeat([0.0, 1.0], 14))
    faces = [FaceRecord(sheet, (UNIT, UNIT), area=2.0), face("sphere", 1.0, v=(-0.5, 0.5))]
    samples = gm.sample(part(faces), normals=gm.directions.random(300, seed=0))
    of_ball = samples.face_index == 1
    assert 0 < of_ball.sum() < len(samples)
    assert np.isfinite(samples.uv_radius[of_ball]).all()
    assert np.isnan(samples.uv_radius[~of_ball]).all()
    assert (samples.report.proved, samples.report.estimated_faces) == (None, 1)
    assert "2 faces, 1 of them estimated" in samples.summary()
    assert "proved" not in samples.summary()


def test_answers_do_not_depend_on_earlier_calls():
    kinds, normals = all_kinds(), gm.directions.random(80, seed=0)
    known = gm.GaussMap(kinds)
    first = known.points(normals)
    gm.sample(kinds, 100)
    with pytest.warns(gm.GaussmapWarning, match="is flat"):
        same(first, gm.sample(kinds, normals=normals))
    same(first, known.points(normals, threads=3))
    same(first, gm.GaussMap(pickle.loads(pickle.dumps(kinds))).points(normals))
    single = np.concatenate([known.points(n[None]).uv for n in normals])
    order = np.lexsort((first.face_index, first.normal_index))
    assert single.tobytes() == first.uv[order].tobytes()
