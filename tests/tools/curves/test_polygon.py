"""The distance from a polygon."""

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])


def test_distances_from_a_square():
    points = [[0.5, 0.5], [0.5, -2.0], [4.0, 5.0], [1.0, 0.3], [0.4, 0.9]]
    expected = [0.5, 2.0, 5.0, 0.0, 0.1]
    np.testing.assert_allclose(gm.curves.polygon_distance(points, SQUARE), expected, atol=1e-15)


def test_an_open_polygon_has_ends():
    assert gm.curves.polygon_distance([[-3.0, 4.0]], SQUARE[:4]).tolist() == [np.hypot(3, 3)]
    assert gm.curves.polygon_distance([[-1.0, 0.5]], SQUARE[:4]).tolist() == [np.hypot(1, 0.5)]
    assert gm.curves.polygon_distance([[-1.0, 0.5]], SQUARE).tolist() == [1.0]


def test_one_vertex_and_repeated_vertices():
    assert gm.curves.polygon_distance([[3.0, 4.0]], [[0, 0]]).tolist() == [5.0]
    assert gm.curves.polygon_distance([[3.0, 4.0]], [[0, 0], [0, 0], [0, 0]]).tolist() == [5.0]


def test_many_points_are_cut_into_parts():
    """A regular polygon: the middle of each edge is farthest from the circle, by 1 − cos(π/m)."""
    angle = 2 * np.pi * np.arange(401) / 400
    polygon = np.column_stack([np.cos(angle), np.sin(angle)])
    dense = 2 * np.pi * np.arange(8000) / 8000
    distances = gm.curves.polygon_distance(np.column_stack([np.cos(dense), np.sin(dense)]), polygon)
    assert distances.shape == (8000,)
    assert distances.max() == pytest.approx(1 - np.cos(np.pi / 400), rel=1e-9)


@pytest.mark.parametrize(
    ("points", "polygon", "complaint"),
    [([0, 1], SQUARE, "points must have the shape"), (SQUARE, np.eye(3), "polygon must have"),
     (SQUARE, np.empty((0, 2)), "at least one vertex"), ([[0, np.nan]], SQUARE, r"points\[0\]"),
     (SQUARE, [[0, 0], [np.inf, 1]], r"polygon\[1\]")],
)  # fmt: skip
def test_unusable_arguments(points, polygon, complaint):
    refused(complaint, gm.curves.polygon_distance, points, polygon)


@pytest.mark.parametrize("scale", [1e-300, 1e-200, 1e-150, 1e150, 1e200, 1e300])
def test_any_scale(scale):
    points, polygon = np.array([[1.0, 0.0], [3.0, 3.0]]), np.array([[0.0, 0.0], [1.0, 1.0]])
    expected = np.sqrt([0.5, 8.0]) * scale
    np.testing.assert_allclose(
        gm.curves.polygon_distance(points * scale, polygon * scale), expected, rtol=1e-14
    )
