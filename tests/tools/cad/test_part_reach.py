"""Samples of parts whose normals are within an angle of an axis."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.examples import box
from scipy.spatial import KDTree

from ...refusals import refused
from ...shapes import farthest
from .made import KINDS, cylinder

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
