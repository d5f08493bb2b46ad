"""The mesh of a part that rays are tested against."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad import obstacle
from gaussmap.tools.cad.examples import box

from ...refusals import refused
from .made import noted

pytest.importorskip("pythoncdt")
ALONG = gm.Reach((1, 0, 0.2), 70, unobstructed=True)
AXIS = np.array([1, 0, 0.2]) / np.hypot(1, 0.2)


def test_the_mesh_of_a_part_is_made_once_with_vertices_enough(monkeypatch):
    monkeypatch.setattr(obstacle, "VERTICES", 10)  # and 8 corners
    part, made = box(), noted(monkeypatch, obstacle, "mesh_of_part", lambda _, mesh: mesh)
    samples = gm.sample(part, 60)
    assert samples.unobstructed(1.0).all()
    assert samples[:5].unobstructed(2.0, by=part).all()
    assert [len(x.vertices) for x in made] == [16]
    some = gm.sample(part.select(index=[0]), 20)
    assert some.unobstructed(1.0).all()  # by the whole part
    assert len(made) == 1


def test_of_saved_faces_the_whole_part_is_not_known(tmp_path):
    box().select(index=[0]).save(tmp_path / "some.npz")
    some = gm.read_part(tmp_path / "some.npz")
    refused(r"give the whole part, .* by=part\)", gm.sample(some, 20).unobstructed, 1.0)
    refused("needs a closed part", gm.sample, some, 20, reach=ALONG)
    refused("needs a closed part or surface", gm.sample, "wavy_graph", 20, reach=ALONG)
    for reach in (ALONG, gm.Reach(clearance=1.0)):
        refused("not known of splines", gm.sample, gm.fit("torus", (8, 8)), 20, reach=reach)


def test_faces_that_rays_from_above_meet_are_those_of_the_whole_part():
    above, error = gm.Reach(unobstructed=True), gm.errors.SurfaceError
    samples = gm.sample(box(), 60, reach=above)
    assert set(np.asarray(samples.face_index).tolist()) == {0, 1, 2, 3, 5}
    assert gm.Reach._of(above._numbers)._numbers == above._numbers == samples.report.reach
    bottom = box().select(index=[4])
    refused("no point in reach: unobstructed", gm.sample, bottom, 20, reach=above, error=error)


def least_distance(points, normals):
    """The least distance from the central circle of a torus, on segments of length 1.4."""
    steps = np.linspace(0.05, 1.4, 100)[:, None]
    x, y, z = np.moveaxis(points[:, None] + steps * normals[:, None], 2, 0)
    return np.hypot(np.hypot(x, y) - 1.0, z).min(axis=1)


@pytest.mark.parametrize("whole", [gm.Part(["torus"]), gm.surfaces.torus()])
def test_points_with_clearance(monkeypatch, whole):
    """In the hole of a torus, of radius 0.65, normals meet the other side."""
    monkeypatch.setattr(obstacle, "VERTICES", 3_000)
    reach = gm.Reach((1, 0, 0), 30.0, clearance=1.4)
    assert gm.Reach._of(reach._numbers)._numbers == reach._numbers
    samples = gm.sample(whole, 60, reach=reach)
    assert len(samples) == 60
    assert samples.report.reach == reach._numbers
    assert "normals within 30° of (1, 0, 0), free along the normal for 1.4" in samples.summary()
    assert least_distance(samples.points, samples.normals).min() > 0.34
    assert samples.unobstructed(1.4).all()
    u, v = np.random.default_rng(0).random((2, 100_000)) * 2.0 * np.pi
    normals = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=1)
    share, area = normals[:, 0] > np.cos(np.radians(30.0)), 1.0 + 0.35 * np.cos(v)
    points = np.stack([area * np.cos(u), area * np.sin(u), 0.35 * np.sin(v)], axis=1)
    share[share] = least_distance(points[share], normals[share]) > 0.35
    expected = 0.35 * (2.0 * np.pi) ** 2 * (area * share).mean()
    np.testing.assert_allclose(samples.weights().sum(), expected, rtol=0.05)
    numbers = gm.Reach(clearance=np.inf)._numbers
    assert np.isfinite(numbers).all()
    assert gm.Reach._of(numbers)._clearance == np.inf


@pytest.mark.slow
def test_normals_that_point_into_a_closed_surface(monkeypatch):
    """The tube of a torus, from its inner side, is 0.7 wide."""
    monkeypatch.setattr(obstacle, "VERTICES", 3_000)
    torus = gm.surfaces.torus()
    inside = gm.Surface.from_callable(
        lambda v, u: torus.function(u, v), torus.domain, periodic=(True, True)
    )
    assert gm.sample(inside, 30, reach=gm.Reach(clearance=0.6)).unobstructed(0.6).all()
    wide, error = gm.Reach(clearance=0.71), gm.errors.SurfaceError
    refused("no point in reach.*: free along", gm.sample, inside, 30, reach=wide, error=error)


@pytest.mark.slow
@pytest.mark.parametrize("whole", [gm.Part(["torus"]), gm.surfaces.torus()])
def test_points_that_a_ray_reaches(monkeypatch, whole):
    """Through the hole of a torus, rays meet the near side before the far one."""
    monkeypatch.setattr(obstacle, "VERTICES", 3_000)
    steps = np.linspace(0.05, 3.0, 300)[:, None]

    def deepest(samples):
        x, y, z = np.moveaxis(samples.points[:, None] + steps * AXIS, 2, 0)
        return 0.35 - np.hypot(np.hypot(x, y) - 1.0, z).min(axis=1)

    samples = gm.sample(whole, 150, reach=ALONG)
    cap = gm.sample(whole, 150, reach=((1, 0, 0.2), 70))
    assert len(samples) == 150
    assert (samples.normals @ AXIS).min() >= np.cos(np.radians(70.0)) - 1e-9
    assert deepest(samples).max() < 0.02 < 0.2 < deepest(cap).max()
    assert samples.weights().sum() < 0.95 * cap.weights().sum()
