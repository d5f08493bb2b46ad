"""What brings the meshes of others to one form."""

import numpy as np
import pytest
from gaussmap.benchmarks.peers.forms import FORMS
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
