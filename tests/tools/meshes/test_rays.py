"""Which samples a probe reaches along their normals, without running into obstacles."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.meshes.rays import Obstacle

from ...refusals import refused

trimesh = pytest.importorskip("trimesh")
pytestmark = pytest.mark.compiled


@pytest.mark.slow
def test_walls_of_holes_block_beyond_their_diameter():
    bracket: Any = gm.sample(gm.read_part(f"{gm.__path__[0]}/docs/gallery/bracket.npz"), 300)
    faces = [bracket.surface.faces[k] for k in bracket.face_index]
    holes = np.array([x.kind == "cylinder" and x.dimensions["radius"] == 3.5 for x in faces])
    assert holes.sum() >= 8
    holes, mesh = bracket[holes], gm.sample(bracket.surface, 6000).mesh()
    assert holes.unobstructed(6.9, by=mesh).all()
    assert not holes.unobstructed(7.1, by=mesh).any()
    centres = holes.offset(1.0)
    assert centres.unobstructed(5.9, by=mesh).all()
    assert not centres.unobstructed(6.1).any()  # by the mesh of the part


def test_a_clamp(parts):
    """A box of 1 × 2 × 3, and a clamp 0.5 above a part of its top, in contact with one side."""
    samples = gm.sample(parts.box(1.0, 2.0, 3.0), 400)
    clamp = trimesh.creation.box(bounds=[[0.2345, -1.0, 3.5], [0.7654, 1.0123, 4.0]])
    wall = trimesh.creation.box(bounds=[[1.0, -1.0, -1.0], [2.0, 3.0, 5.0]])
    x, y, z = samples.points.T
    under = (z == 3.0) & (x > 0.2345) & (x < 0.7654) & (y < 1.0123) & (samples.normals[:, 2] > 0.5)
    assert 0 < under.sum() < (z == 3.0).sum()
    np.testing.assert_array_equal(samples.unobstructed(0.6, by=clamp), ~under)
    assert samples.unobstructed(0.4, by=clamp).all()
    np.testing.assert_array_equal(samples.unobstructed(0.4, by=wall), samples.normals[:, 0] < 0.5)


@pytest.mark.parametrize("count", [1, 8, 300])
def test_the_first_triangle_on_a_ray(count):
    """As all triangles say, one by one."""
    rng = np.random.default_rng(count)
    corners = rng.random((count, 3, 3)) * 0.4 + rng.random((count, 1, 3))
    solid = Obstacle.of(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    begins = rng.random((400, 3)) * 2.0 - 0.3
    along = corners[rng.integers(count, size=400)].mean(axis=1) + rng.normal(size=(400, 3)) / 9
    along -= begins
    along[::7, 1] = 0.0  # parallel to sides of boxes
    sides = np.broadcast_to(np.diff(corners, axis=1)[:, [0, 1]], (400, count, 2, 3))
    matrix = np.concatenate([sides, -along[:, None, None].repeat(count, 1)], axis=2)
    offsets = begins[:, None] - corners[:, 0]
    u, v, t = np.moveaxis(np.linalg.solve(np.swapaxes(matrix, 2, 3), offsets[..., None]), 2, 0)
    meets = ((v >= 0) & (v <= u) & (u <= 1) & (t >= 0) & (t <= 2))[..., 0]
    inward = np.cross(sides[:, :, 0], sides[:, :, 1]) @ along[:, :, None] < 0
    most = np.full(400, 2.0 * solid.scale)
    for both_sides, counted in ((True, meets), (False, meets & inward[..., 0])):
        expected = np.where(counted, t[..., 0], np.inf).min(axis=1) * solid.scale
        found = solid.hits(solid.scaled(begins), along, most, both_sides)
        np.testing.assert_allclose(found, expected, rtol=1e-9)
    assert np.isfinite(expected).any()


@pytest.mark.parametrize(("scale", "shift"), [(1e-12, 0.0), (1e-9, 1e-3), (1e12, 1e18)])
def test_rays_do_not_depend_on_the_unit(scale, shift):
    """A box 1.5 above three points, of which one is above it, and one looks away."""
    clamp = trimesh.creation.box(bounds=[[-3.0, -3.0, 1.5], [3.0, 3.0, 2.0]])
    moved = trimesh.Trimesh(scale * clamp.vertices + shift, clamp.faces, process=False)
    points = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 3.0], [0.2, 0.1, -1.0]])
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, -1.0]])
    for distance, free in ((1.4, [True, False, True]), (1.6, [False, False, True])):
        solid = Obstacle.of(np.asarray(moved.vertices), np.asarray(moved.faces))
        found = solid.are_free(scale * points + shift, normals, scale * distance)
        assert found.tolist() == free


def test_what_is_refused(parts):
    samples = gm.sample(parts.box(), 60)
    open_box = trimesh.creation.box()
    open_box.update_faces(np.arange(12) > 0)
    refused("this one is open", samples.unobstructed, 1.0, by=open_box)
    refused("distance must be", samples.unobstructed, -1.0)
    refused(r"trimesh\.Trimesh, not str", samples.unobstructed, 1.0, by="table")
