from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.pictures.scene import front, height_factor, scene_of, view

pytestmark = pytest.mark.compiled  # every scene evaluates a fine mesh


def test_a_convex_surface_hides_its_back() -> None:
    spline = gm.fit(gm.surfaces.sphere())
    samples = gm.sample(spline, count=2000)
    facing = samples.normals @ view()[2]
    visible = scene_of(spline).visible(samples.points)
    assert visible[facing > 0.05].all()
    assert not visible[facing < -0.15].any()


def test_waves_hide_what_faces_the_viewer() -> None:
    spline = gm.fit(gm.surfaces.wavy_graph(amplitude=0.5, frequency=5.0))
    samples = gm.sample(spline, count=3000)
    # March from each sample to the viewer: where does the way cross the waves?
    steps = np.linspace(0.01, 3.0, 1200)
    x, y, z = np.moveaxis(samples.points[:, None] + steps[:, None] * view()[2], 2, 0)
    above = z > 0.5 * np.sin(5 * x) * np.cos(5 * y)
    over = (np.abs(x) < 1) & (np.abs(y) < 1)
    crossing = (above[:, 1:] != above[:, :-1]) & over[:, 1:] & over[:, :-1]
    visible = scene_of(spline).visible(samples.points)
    hidden = (crossing & (steps[1:] > 0.06)).any(axis=1)
    assert not visible[hidden].any()
    assert visible[~crossing.any(axis=1)].mean() > 0.995  # but for some at an edge
    facing = samples.normals @ view()[2]
    assert np.count_nonzero(hidden & (facing > 0.2)) > 20
    assert np.count_nonzero(visible) > 1000


def test_front_is_the_nearest_triangle() -> None:
    rng = np.random.default_rng(0)
    triangles, places = rng.random((200, 3, 3)), rng.random((300, 2))
    expected = np.full(len(places), -np.inf)
    for a, b, c in triangles:
        matrix = np.stack([b[:2] - a[:2], c[:2] - a[:2]], axis=1)
        s, t = np.linalg.solve(matrix, (places - a[:2]).T)
        inside = (s >= 0) & (t >= 0) & (s + t <= 1)
        depth = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2])
        expected = np.where(inside, np.maximum(expected, depth), expected)
    np.testing.assert_allclose(front(triangles, places), expected, rtol=1e-6)


def test_front_without_area_or_places() -> None:
    flat = np.zeros((2, 3, 3))
    assert front(flat, np.zeros((1, 2)))[0] == -np.inf
    assert front(flat, np.zeros((0, 2))).shape == (0,)


@pytest.mark.parametrize(
    ("extent", "factor"),
    [
        ((2, 2, 2), 1), ((2, 2, 0.2), 1), ((2, 2, 0.1), 5), ((1e4, 1e4, 500), 5),
        ((1e4, 2e4, 1e-3), 5e6), ((2, 2, 0), 1), ((2, 2, 1e-12), 1), ((1, 1, 9), 1),
        ((1, 1, 100), 0.02), ((0, 0, 1), 1), ((0, 0, 0), 1),
    ],
)  # fmt: skip
def test_height_factor(extent: tuple[float, float, float], factor: float) -> None:
    assert height_factor(np.array(extent, dtype=float)) == pytest.approx(factor)
