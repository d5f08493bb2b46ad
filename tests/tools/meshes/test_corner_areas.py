"""The areas over single triangles."""

import numpy as np
import pytest
from gaussmap.tools.meshes.weights import corner_areas

CORNERS = np.array([(0.0, 0.0, 0.0), (3.0, 0.0, 0.0), (0.0, 4.0, 0.0)])


def areas_of(points: np.ndarray, normals: np.ndarray, sides: tuple[int, int, int]) -> np.ndarray:
    return corner_areas(points, normals, np.array([[0, 1, 2]]), np.array([sides]))[0]


@pytest.mark.parametrize("sides", [(1, 1, 1), (1, -1, 1), (-1, -1, -1)])
def test_a_flat_triangle_is_shared_evenly(sides: tuple[int, int, int]) -> None:
    normals = np.array(sides)[:, None] * (0.0, 0.0, 1.0)
    assert areas_of(CORNERS, normals, sides) == pytest.approx(np.full(3, 2.0), rel=1e-15)


def test_a_triangle_is_flat_whose_normals_are_more_than_a_right_angle_apart() -> None:
    normals = np.array([(0.6, 0.0, 0.8), (-0.8, 0.0, 0.6), (-1.0, 0.0, 0.0)])
    assert areas_of(CORNERS, normals, (1, 1, 1)) == pytest.approx(np.full(3, 2.0), rel=1e-15)
