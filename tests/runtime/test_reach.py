"""`reach`: samples whose normals are within an angle of an axis, with everything guaranteed."""

import pickle
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from scipy.spatial import KDTree

from ..refusals import refused
from ..shapes import farthest, widest_angle

AXIS, ANGLE = (1.0, 2.0, 0.5), 35.0
ROUNDING = 1e-9
UP, AWAY = ((0, 0, 1), 180.0), gm.Reach(from_edges=0.1)


def angles(normals: np.ndarray, axis: object = AXIS) -> np.ndarray:
    unit = np.asarray(axis) / np.linalg.norm(np.asarray(axis))
    return np.degrees(np.arccos(np.clip(normals @ unit, -1.0, 1.0)))


def places_in_reach(surface: gm.Surface) -> tuple[np.ndarray, np.ndarray]:
    """Return many points in the reach, and their normals."""
    u, v = (low + (high - low) * (np.arange(400) + 0.5) / 400 for low, high in surface.domain)
    u, v = np.meshgrid(u, v)
    points, normals = (f(u, v).reshape(-1, 3) for f in (surface.evaluate, surface.normals))
    inside = angles(normals) <= ANGLE
    return points[inside], normals[inside]


@pytest.mark.parametrize("name", ["torus", "ellipsoid"])
@pytest.mark.quick_for("torus")
def test_every_request_keeps_to_the_reach_and_its_guarantee(name: str) -> None:
    surface = gm.surfaces.torus() if name == "torus" else gm.surfaces.ellipsoid()
    points, normals = places_in_reach(surface)
    requests: list[dict[str, Any]] = [
        {"count": 300},
        {"count": 300, "density": "uniform"},
        {"count": 300, "density": "gauss"},
        {"coverage": 0.06},
        {"angle": 4.0},
        *[{"count": 300, "density": 0.5}, {"angle": 6.0, "coverage": 0.1}] * (name == "ellipsoid"),
    ]
    for how in requests:
        samples = gm.sample(surface, reach=(AXIS, ANGLE), **how)
        assert angles(samples.normals).max() <= ANGLE + ROUNDING
        if "count" in how:
            slack = 6 if how.get("density") == "gauss" else 0
            assert abs(len(samples) - 300) <= slack
        if "coverage" in how:
            assert farthest(samples, points) <= (samples.report.coverage or 0.0) <= how["coverage"]
        if "angle" in how:
            assert widest_angle(samples, normals) <= how["angle"]


def test_prescribed_normals_have_the_same_points_as_without_a_reach() -> None:
    normals = gm.icosphere(12)
    whole = gm.sample("torus", normals=normals)
    some = gm.sample("torus", normals=normals, reach=(AXIS, ANGLE))
    inside = angles(whole.normals) <= ANGLE
    assert np.array_equal(some.points, whole.points[inside])
    assert np.array_equal(some.normal_index, whole.normal_index[inside])


@pytest.mark.parametrize(
    "how",
    [
        {"count": 200},
        {"normals": gm.icosphere(8)},
        {"coverage": 0.1},
        {"count": 50, "on": "spline"},
    ],
)
@pytest.mark.quick_for("how0")
def test_samples_keep_a_distance_from_the_boundary(how: dict[str, Any]) -> None:
    """Of a trim that crosses an open side."""
    waves = gm.surfaces.wavy_graph().trimmed([[(-2, -0.5), (0.9, -0.5), (0.9, 0.7), (-2, 0.7)]])
    t = np.linspace(0.0, 1.0, 50_000)
    (low, _), _ = waves.domain
    corners = np.array([(low, -0.5), (0.9, -0.5), (0.9, 0.7), (low, 0.7), (low, -0.5)])
    line = (corners[:-1, None] + t[:, None] * np.diff(corners, axis=0)[:, None]).reshape(-1, 2)
    samples = gm.sample(waves, **how, reach=AWAY)
    apart = KDTree(waves.evaluate(*line.T)).query(samples.points)[0]
    assert apart.min() >= 0.1 - (1e-3 if "on" in how else ROUNDING)
    assert len(samples) == how.get("count", len(samples)) > 0
    assert (samples.report.coverage or 0.0) <= how.get("coverage", 0.0)


def test_poles_and_small_reaches() -> None:
    for samples in gm.sample_many(["torus", "sphere"], 50, reach=(AXIS, ANGLE)):
        assert len(samples) == 50
        assert angles(samples.normals).max() <= ANGLE + ROUNDING
    assert 4 <= len(gm.sample("sphere", angle=3.0, reach=(AXIS, 6.0))) <= 40
    north = [[0.0, 0.0, 1.0]]
    for on in ("surface", "spline"):
        assert len(gm.sample("sphere", normals=north, reach=((0, 0, 1), 20.0), on=on)) == 1


def test_a_reach_of_everything_leaves_nothing_out() -> None:
    whole, reached, away = (gm.sample("torus", 200, reach=x) for x in (None, UP, AWAY))
    assert len(whole) == len(reached) == 200
    assert reached.coverage() < 1.3 * whole.coverage()
    assert np.array_equal(reached.points, away.points)  # closed surfaces have no edges


@pytest.mark.slow
def test_terrain_meshes_and_pickles() -> None:
    x = np.linspace(0.0, 6.0, 30)
    heights = gm.terrain(2.0 * np.sin(x)[:, None] * np.cos(x), spacing=(0.2, 0.2))
    samples = gm.sample(heights, 150, reach=((0, 0, 1), 25.0))
    assert len(samples) == 150
    assert angles(samples.normals, (0, 0, 1)).max() <= 25.0 + ROUNDING
    assert len(samples.mesh().boundary_edges) > 0
    assert samples.coverage() < gm.sample(heights, 150).coverage()
    assert len(pickle.loads(pickle.dumps(samples))) == 150


ROOF = gm.Surface.from_nurbs(
    (1, 1),
    ([0, 0, 1, 2, 2], [0, 0, 1, 1]),
    [[[x, y, x * (2 - x)] for y in (0, 1)] for x in (0, 1, 2)],
)


def test_pieces_of_a_nurbs_keep_to_the_reach() -> None:
    one_side = gm.sample(ROOF, 50, density="uniform", reach=((-1, 0, 1), 10.0))
    assert (one_side.points[:, 0] <= 1.0).all()
    assert len(one_side) == 50
    assert one_side.coverage() < 0.5


@pytest.mark.parametrize(
    ("reach", "message"),
    [
        ((0, 0, 1), "reach must be an axis and an angle"),
        (5, "reach must be an axis and an angle"),
        (((0, 0, 0), 30), "axis of reach"),
        (((0, 0, 1), 0.0), "angle of reach"),
        (((0, 0, 1), 181.0), "angle of reach"),
        ({"slope": (20, 10)}, "slope must be the least and the largest angle, at most 180"),
        ({"aspect": (180, 120)}, "aspect must be a direction and an angle, at most 90"),
        ({"slope": 20}, "slope"),
        ({"angle": 0}, "the angle of reach"),
        ({"from_edges": 0.0}, "from_edges must be a positive number"),
        ({"clearance": 0.0}, "clearance must be a positive number"),
    ],
)
def test_unusable_reaches(reach: Any, message: str) -> None:
    if isinstance(reach, dict):
        refused(message, gm.Reach, **reach)
    else:
        refused(message, gm.sample, "torus", 100, reach=reach)


@pytest.mark.parametrize("surface", ["wavy_graph", ROOF])
def test_nothing_in_reach(surface: Any) -> None:
    for reach, said in (
        (((0, 0, -1), 10.0), "normals within 10°"),
        (gm.Reach(from_edges=9), "9 from"),
    ):
        message = f"no point in reach.*: .*{said}"
        refused(message, gm.sample, surface, 99, reach=reach, error=gm.errors.SurfaceError)


def test_grids_have_no_reach() -> None:
    refused('use "balanced"', gm.sample, "torus", 100, density="aligned", reach=((0, 0, 1), 30.0))


def test_slopes_and_aspects_are_sectors_of_normals() -> None:
    waves = gm.surfaces.wavy_graph()
    reach = gm.Reach(slope=(5.0, 20.0), aspect=(200.0, 60.0))
    samples = gm.sample(waves, 400, reach=reach, density="uniform")
    turn = (samples.aspect - 200.0 + 180.0) % 360.0 - 180.0
    assert len(samples) == 400
    assert samples.slope.min() >= 5.0 - ROUNDING
    assert samples.slope.max() <= 20.0 + ROUNDING
    assert np.abs(turn).max() <= 60.0 + ROUNDING
    # The samples cover the whole sector: no place of a grid in it is far from all of them.
    side = (np.arange(300) + 0.5) / 150.0 - 1.0
    u, v = (x.ravel() for x in np.meshgrid(side, side))
    x, y, z = waves.normals(u, v).T
    slope, aspect = np.degrees(np.arccos(z)), np.degrees(np.arctan2(x, y))
    inside = (slope > 5.0) & (slope < 20.0) & (abs((aspect + 340.0) % 360.0 - 180.0) < 60.0)
    area = inside.mean() * 4.0
    apart = KDTree(samples.points[:, :2]).query(np.stack([u, v], axis=1)[inside])[0].max()
    assert apart <= 2.0 * np.sqrt(area / 400.0)
