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


def test_a_triangle_of_the_sphere() -> None:
    """Bézier triangles that have the normals of a sphere have its area up to h⁴: 16 times better.

    The area of the triangle between great circles is known from its sides (L'Huilier).
    """
    errors = []
    for h in (0.4, 0.2):
        points = np.array([(h, 0.0, 1.0), (-h / 2, h, 1.0), (-h / 3, -h, 1.0)])
        points /= np.linalg.norm(points, axis=1)[:, None]
        a, b, c = (np.arccos(points[i] @ points[i - 1]) for i in range(3))
        s = (a + b + c) / 2
        tangents = np.tan(np.array([s, s - a, s - b, s - c]) / 2)
        exact = 4 * np.arctan(np.sqrt(tangents.prod()))
        errors.append(abs(areas_of(points, points, (1, 1, 1)).sum() / exact - 1))
    assert errors[0] < 0.4**4
    assert errors[0] / errors[1] > 16 / 1.5
