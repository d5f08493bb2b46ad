"""What brings the meshes of others to one form, and how meshes are compared with a surface."""

import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import FORMS, Torus
from gaussmap.benchmarks.peers.mesh_metrics import to_surface
from gaussmap.benchmarks.peers.triangles import by_grid, joined


def test_vertices_at_one_place_are_joined():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1e-12, 0], [0, 1, 0], [1, 1, 0]])
    faces = np.array([[0, 1, 2], [3, 5, 4], [1, 3, 5]])
    vertices, triangles = joined(points.astype(float), faces)
    assert len(vertices) == 4
    # the third one had two corners at one place
    assert len(triangles) == 2
    np.testing.assert_allclose(vertices[triangles], points[faces[:2]], atol=1e-11)


@pytest.mark.parametrize("form", FORMS, ids=lambda x: x.name)
def test_a_grid_has_the_topology_of_its_surface(form):
    vertices, triangles = by_grid(form, 400)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    characteristic = len(vertices) - len(np.unique(edges, axis=0)) + len(triangles)
    assert characteristic == (form.name == "wavy_graph")
    assert len(vertices) == pytest.approx(400, rel=0.05)


def test_distances_from_the_torus_are_exact():
    form = Torus()
    rng = np.random.default_rng(1)
    u, v = rng.uniform(-np.pi, np.pi, (2, 500))
    points, normals = form.evaluate(u, v)
    away = rng.uniform(-0.1, 0.1, 500)
    found = to_surface(form, points + away[:, None] * normals)
    np.testing.assert_allclose(found, np.abs(away), rtol=0, atol=1e-14)


def test_beyond_a_border_the_border_is_nearest():
    form = FORMS[2]
    points = np.array([[1.1, 0.2, 0.2 * np.sin(3) * np.cos(0.6)]])
    ends = form.evaluate(np.array([1.0]), np.linspace(-1, 1, 200_001))[0]
    nearest = np.linalg.norm(ends - points, axis=1).min()
    assert to_surface(form, points)[0] == pytest.approx(nearest, rel=1e-9)
