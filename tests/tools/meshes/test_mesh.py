"""The mesh as an object, and its texture coordinates."""

import pickle
from itertools import permutations

import gaussmap as gm
import numpy as np
import pytest
from scipy.spatial import KDTree

from ...refusals import refused
from ...shapes import CORNERS, klein_bottle, square

NAMES = ("vertices", "normals", "uv", "triangles", "sample_index")


class TestMesh:
    def test_edges_and_boundary(self):
        mesh = square()
        assert mesh.edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
        assert mesh.boundary_edges.tolist() == [[0, 1], [0, 3], [1, 2], [2, 3]]
        assert mesh.euler_characteristic == 1

    def test_angles(self):
        np.testing.assert_allclose(square().angles, [45, 60], rtol=1e-12)
        across = square(normals=-square().normals, sides=np.full((2, 3), -1))
        np.testing.assert_allclose(across.angles, [45, 60], rtol=1e-12)

    def test_orders_of_corners(self):
        """All three normals are above the triangle, the farthest 45 degrees from its own."""
        orders = np.array(list(permutations(range(3))))
        upward = np.linalg.det(np.eye(3)[orders]) > 0.0
        for side, from_above in ((1, upward), (-1, ~upward)):
            found = square(triangles=orders, sides=np.full((6, 3), side)).angles
            np.testing.assert_allclose(found, np.where(from_above, 45.0, 180.0), rtol=1e-7)
        assert len(set(square(triangles=orders).smallest_angles)) == 1

    def test_a_triangle_without_area(self):
        flat = square(triangles=np.array([[0, 1, 1]]))
        assert flat.angles.tolist() == [180.0]
        assert flat.smallest_angles.tolist() == [0.0]

    def test_smallest_angles(self):
        """Of 45, 60 and 75 degrees, and of 10, 20 and 150: sides are as the sines of angles."""
        for angles in ([45.0, 60.0, 75.0], [20.0, 10.0, 150.0]):
            a, b, c = np.sin(np.radians(angles))
            x = (b * b + c * c - a * a) / (2.0 * c)
            corners = np.array([[0.0, 0, 0], [c, 0, 0], [x, np.sqrt(b * b - x * x), 0], [9, 9, 9]])
            triangles = np.array([[0, 1, 2], [1, 2, 0], [2, 1, 0]])
            found = square(vertices=corners, triangles=triangles).smallest_angles
            np.testing.assert_allclose(found, min(angles), rtol=1e-12)

    def test_summary(self):
        assert square().summary() == (
            "4 vertices (1 of them added), 2 triangles, 4 edges on the border; 95 % have angles of "
            "at least 45.0°; they deviate from the normals by 52.50° (mean), 60.00° (worst)"
        )
        closed = square(
            triangles=np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]),
            sample_index=np.arange(4),
        )
        assert closed.summary().startswith("4 vertices, 4 triangles, closed; 95 % have")
        assert closed.closed
        assert not square().closed
        assert np.isnan(square().volume)
        some = square(left_out=1200).summary()
        assert some.startswith("4 vertices (1 of them added), 1,200 of the samples left out, 2")
        assert repr(square(name="hill")) == "Mesh(4 vertices, 2 triangles on hill)"

    def test_an_empty_mesh(self):
        none = {name: getattr(square(), name)[:0] for name in NAMES}
        mesh = gm.Mesh(**none)
        assert mesh.summary() == "0 vertices, 0 triangles"
        assert (len(mesh.edges), len(mesh.angles), mesh.euler_characteristic) == (0, 0, 0)

    def test_it_can_be_pickled(self):
        copy = pickle.loads(pickle.dumps(square()))
        np.testing.assert_array_equal(copy.triangles, square().triangles)

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"vertices": CORNERS.tolist()}, "vertices must be a NumPy array, not list"),
            ({"vertices": CORNERS[:, :2]}, r"vertices must be a float64 array of shape \(M, 3\)"),
            ({"normals": CORNERS[:3]}, r"normals must be a float64 array of shape \(4, 3\)"),
            ({"uv": CORNERS}, r"uv must be a float64 array of shape \(4, 2\)"),
            ({"triangles": np.zeros((2, 4), dtype=int)}, r"triangles must be .* shape \(T, 3\)"),
            ({"triangles": np.zeros((2, 3))}, "triangles must be a int64 array"),
            ({"triangles": np.array([[0, 1, 4]])}, "triangles have vertices that are not there"),
            ({"triangles": np.array([[0, 1, -1]])}, "triangles have vertices that are not there"),
            ({"sample_index": np.arange(3)}, r"sample_index must be a int64 array of shape \(4,\)"),
            ({"sides": np.ones((1, 3), dtype=int)}, r"sides must be a int64 array of shape"),
            ({"left_out": -1}, "left_out must be a whole number of at least 0, not -1"),
        ],
    )
    def test_unusable_arrays(self, changes, message):
        refused(message, square, **changes)


# --- texture coordinates --------------------------------------------------------------------------

# The largest extent of the texture coordinates of a triangle, of about 1,500 of them.
WIDEST = 0.35


SURFACES = ["torus", "sphere", "moebius_band", "cylinder", "wavy_graph", "cone", klein_bottle()]


@pytest.mark.compiled
@pytest.mark.parametrize("surface", SURFACES, ids=lambda x: getattr(x, "name", x))
def test_texture_coordinates_do_not_jump(surface: gm.Surface | str) -> None:
    mesh = gm.sample(surface, 1500, cells=(24, 24)).mesh()
    found = mesh.corner_uv
    assert found.shape == (len(mesh.triangles), 3, 2)
    assert np.ptp(found, axis=1).max() < WIDEST
    assert found.min() > -0.5
    assert found.max() < 1.5
    if surface not in ("torus", "sphere", "cylinder"):
        return
    # They are the parameters, less whole periods.
    low, high = np.array(mesh.domain).T
    away = found - ((mesh.uv - low) / (high - low))[mesh.triangles]
    at_pole = (mesh.sample_index < 0)[mesh.triangles] if surface == "sphere" else False
    assert np.abs(away - np.rint(away))[~np.broadcast_to(at_pole, away.shape[:2])].max() < 1e-12
    crossing = (np.rint(away) != 0).any(axis=(1, 2))
    assert 0.0 < crossing.mean() < 0.3


def test_without_a_domain_they_are_the_parameters() -> None:
    assert np.array_equal(square().corner_uv, square().uv[square().triangles])


@pytest.mark.compiled
def test_files_have_them(tmp_path) -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = gm.sample("sphere", 500, cells=(16, 16)).mesh()
    mesh.write(tmp_path / "sphere.obj")
    scene = trimesh.load_scene(tmp_path / "sphere.obj", process=False)
    (again,) = scene.geometry.values()
    found, expected = (
        np.concatenate([uv, points], axis=2).reshape(len(uv), -1)
        for uv, points in (
            (again.visual.uv[again.faces], again.vertices[again.faces]),
            (mesh.corner_uv, mesh.vertices[mesh.triangles]),
        )
    )  # trimesh orders the triangles of .obj files anew
    distances, number = KDTree(found).query(expected)
    assert distances.max() < 1e-6
    assert len(np.unique(number)) == len(expected) == len(found)
