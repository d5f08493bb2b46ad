"""Meshes and weights of trimmed surfaces end at the border."""

from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
import shapely
from gaussmap.tools.meshes.border import border_lines
from gaussmap.tools.meshes.places import wrapped

from ...shapes import TORUS, area_of, circle

pytestmark = pytest.mark.compiled

TURN = 2.0 * np.pi


def plane(u, v):
    return np.stack([u, v, 0.0 * u], axis=-1)


PLANE = gm.Surface.from_callable(plane, ((0.0, 1.0), (0.0, 1.0)), name="plane")
X = np.linspace(0.0, 1.0, 21)
HEIGHTS = np.where(
    (np.abs(X[:, None] - 0.5) < 0.11) & (np.abs(X - 0.6) < 0.11), np.nan, 0.1 * np.sin(5 * X)
)
LEFT = np.array([(0.1, 0.1), (0.5, 0.1), (0.5, 0.9), (0.1, 0.9)])
RIGHT = LEFT + np.array([0.4, 0.0])
# Surfaces with the Euler characteristics of their parts.
PARTS = {
    "hole": (PLANE.trimmed(shapely.box(0, 0, 1, 1).difference(shapely.box(0.3, 0.3, 0.7, 0.6))), 0),
    "disc": (PLANE.trimmed([circle(200, 0.5, 0.4)]), 1),
    "half": (PLANE.trimmed(within=lambda u, v: u + v < 1.0), 1),
    "annulus": (TORUS.trimmed([circle(100, 3.0, 1.5), circle(100, 3.0, 0.7)]), 0),
    "seam": (TORUS.trimmed([circle(100, TURN, 1.2)]), 1),
    "torus with a hole": (TORUS.trimmed(within=lambda u, v: np.hypot(u - 3, v - 2) > 0.7), -1),
    "cap": (gm.surfaces.sphere().trimmed(within=lambda u, v: v > 0.5), 1),
    "band": (gm.surfaces.cylinder().trimmed(within=lambda u, v: np.abs(v) < 0.3), 0),
    "moebius": (gm.surfaces.moebius_band().trimmed(within=lambda u, v: np.abs(u - 3) > 0.4), 1),
    "across a mirrored seam": (
        gm.surfaces.moebius_band().trimmed(within=lambda u, v: v * np.cos(u / 2) > -0.3),
        0,
    ),
    # In one loop each: no border between them. And a predicate.
    "rectangles that touch": (
        PLANE.trimmed([LEFT, RIGHT]).trimmed(within=lambda u, v: v < 0.5),
        1,
    ),
    "grid": (gm.Surface.from_grid(HEIGHTS, spacing=(0.05, 0.05)), 0),
}


@pytest.mark.parametrize("name", PARTS)
@pytest.mark.quick_for("rectangles that touch", "grid", "cap", "band", "across a mirrored seam")
def test_a_mesh_ends_at_the_border(name):
    surface, characteristic = PARTS[name]
    spline = gm.fit(surface, None if name == "grid" else (16, 16))
    samples = gm.sample(spline, 300)
    mesh = samples.mesh()
    assert mesh.euler_characteristic == characteristic
    a, b, c = np.swapaxes(mesh.vertices[mesh.triangles], 0, 1)
    heights = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    assert (
        heights > 1e-6 * np.square(np.stack([a - b, b - c, c - a])).sum(axis=2).max(axis=0)
    ).all()
    ends = np.unique(mesh.boundary_edges)
    assert np.count_nonzero(mesh.sample_index[ends] >= 0) <= 6  # that are so close to the border
    ends = ends[mesh.sample_index[ends] < 0]
    # Each of its ends is on the border: points on both sides, or only inside the domain.
    low, high = np.array(spline.domain).T
    around = 2e-6 * circle(16, 0.0, 1.0) * (high - low)
    places = (mesh.uv[ends][:, None] + around).reshape(-1, 2)
    is_open = np.array([kinds[0] not in ("periodic", "mirrored") for kinds in spline.boundary])
    beyond = (is_open & ((places < low) | (places > high))).any(axis=1)
    places = np.where(is_open, np.clip(places, low, high), places)
    inside = (spline.trim.contains(places) & ~beyond).reshape(len(ends), -1)
    known = name == "grid"  # whose own evaluation of places on edges is not exact
    assert np.mean(inside.any(axis=1) & ~inside.all(axis=1)) >= (0.9 if known else 1.0)
    assert samples.weights().sum() == pytest.approx(area_of(surface), rel=6e-3)


def test_weights_of_a_disc():
    samples = gm.sample(gm.fit(PARTS["disc"][0], (16, 16)), 1000, density="uniform")
    weights = samples.weights()
    assert (weights > 0.0).all()
    assert weights.sum() == pytest.approx(np.pi * 0.16, rel=1e-3)
    assert weights @ samples.points[:, 0] == pytest.approx(np.pi * 0.16 * 0.5, rel=2e-3)
    square = ((samples.points[:, :2] - 0.5) ** 2).sum(axis=1)
    assert weights @ square == pytest.approx(np.pi * 0.4**4 / 2.0, rel=1e-2)


def test_a_border_through_nodes_of_the_grid_is_whole():
    surface = TORUS.trimmed(within=lambda u, v: np.cos(u) + np.cos(v) > 0.0)
    assert len(border_lines(gm.fit(surface, (128, 128)))) == 1


def test_positions_around_another_one():
    """A shift along v, which is mirrored, comes before one along u."""
    bottle = gm.Surface.from_callable(plane, PLANE.domain, (True, "mirrored"))
    found = wrapped(np.array([[0.9, 0.95]]), bottle.boundary, np.array([[0.1, 0.05]]))
    np.testing.assert_allclose(found, [[0.1, -0.05]], atol=1e-15)


def test_a_loop_around_the_whole_torus_has_no_border():
    whole = [(0.0, 0.0), (TURN, 0.0), (TURN, TURN), (0.0, TURN)]
    spline = gm.fit(TORUS.trimmed([whole]), (16, 16))
    assert border_lines(spline) == []
    mesh = gm.sample(spline, 200).mesh()
    assert mesh.euler_characteristic == 0
    assert not len(mesh.boundary_edges)


def test_samples_on_the_border_are_its_vertices():
    strip = TORUS.trimmed(within=lambda u, v: u < 1).flipped()
    spline = gm.fit(strip, (16, 16))
    samples = gm.sample(spline, 150)
    on_border = samples.uv[3::40].copy()
    on_border[:, 0] = spline.domain[0][1]
    u, v = on_border.T
    added = replace(
        samples[: len(u)], uv=on_border, points=spline.evaluate(u, v), normals=spline.normals(u, v)
    )
    joined = gm.Samples.concatenate([samples, added])
    mesh = joined.mesh()
    assert mesh.euler_characteristic == 0
    ends = mesh.sample_index[np.unique(mesh.boundary_edges)]
    assert set(range(150, 150 + len(u))) <= set(ends.tolist())
    assert (joined.weights() > 0.0).all()
