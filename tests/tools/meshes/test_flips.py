"""The smallest angle of a triangle, and how far its normal is from those at its corners."""

import itertools

import numpy as np
import pytest
from gaussmap.tools.meshes.kernels.flips import smallest_cosines, smallest_tangents

CORNERS = np.array([(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 3.0, 0.0)])
ORDERS = np.array(list(itertools.permutations(range(3))))


def test_the_smallest_angle_does_not_depend_on_the_order_of_the_corners() -> None:
    tangents = np.empty(len(ORDERS))
    smallest_tangents(CORNERS, ORDERS, tangents)
    assert tangents == pytest.approx(np.full(len(ORDERS), 0.75), rel=1e-15)
    assert len(set(tangents)) == 1


def test_a_triangle_without_area() -> None:
    points, tangents, cosines = CORNERS * [1.0, 0.0, 1.0], np.empty(1), np.empty(1)
    smallest_tangents(points, ORDERS[:1], tangents)
    sides = np.ones((1, 3), dtype=np.int64)
    smallest_cosines(points, np.ones((3, 3)), ORDERS[:1], sides, cosines)
    assert (tangents[0], cosines[0]) == (0.0, -2.0)


def test_cosines_follow_the_orientation_and_the_sides() -> None:
    """The normals are (0, 0, 1), (0.6, 0, 0.8) and (0, 0, 1)."""
    normals = np.array([(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.0, 0.0, 1.0)])
    even = [np.linalg.det(np.eye(3)[x]) > 0.0 for x in ORDERS]
    for side in (1, -1):
        cosines, sides = np.empty(len(ORDERS)), np.full(ORDERS.shape, side)
        smallest_cosines(CORNERS, normals, ORDERS, sides, cosines)
        expected = np.where(np.array(even) == (side == 1), 0.8, -1.0)
        assert cosines == pytest.approx(expected, rel=1e-15)
