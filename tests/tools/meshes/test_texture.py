"""Texture coordinates: continuous in each triangle, and the parameters of each corner."""

import gaussmap as gm
import numpy as np
import pytest
from scipy.spatial import KDTree

from ...shapes import klein_bottle, square

# The largest extent of the texture coordinates of a triangle, of about 1,500 of them.
WIDEST = 0.35


SURFACES = ["torus", "sphere", "moebius_band", "cylinder", "wavy_graph", "cone", klein_bottle()]


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


@pytest.mark.kernels
def test_without_a_domain_they_are_the_parameters() -> None:
    assert np.array_equal(square().corner_uv, square().uv[square().triangles])


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
