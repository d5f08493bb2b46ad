"""Triangles in front of others."""

import numpy as np
from gaussmap.tools.meshes import front
from gaussmap.tools.meshes.front import Front, in_front


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
    np.testing.assert_allclose(Front.of(triangles).at(places), expected, rtol=1e-6)


def test_front_without_area_or_places() -> None:
    flat = np.zeros((2, 3, 3))
    assert Front.of(flat).at(np.zeros((1, 2)))[0] == -np.inf
    assert Front.of(flat).at(np.zeros((0, 2))).shape == (0,)


def test_the_front_triangles_of_pixels_are_found(monkeypatch):
    monkeypatch.setattr(front, "AT_ONCE", 7)  # some of the triangles, in turn
    monkeypatch.setattr(front, "PIXELS", 50)
    triangles = np.random.default_rng(4).random((300, 3, 3))
    small = (triangles - triangles.mean(axis=1, keepdims=True)) * 0.4 + triangles.mean(
        axis=1, keepdims=True
    )
    low, size = small[..., :2].min(axis=(0, 1)), np.ptp(small[..., :2], axis=(0, 1)).max()
    middles = (np.arange(front.PIXELS + 1) + 0.5) * size / front.PIXELS
    pixels = low + np.stack(np.meshgrid(middles, middles), axis=2).reshape(-1, 2)
    depths = Front.of(small).at(pixels)
    a, b, c = np.moveaxis(small, 1, 0)
    seen = np.zeros(300, dtype=bool)
    for k in range(300):
        weights = np.linalg.solve(
            np.stack([(b - a)[k, :2], (c - a)[k, :2]], axis=1), (pixels - a[k, :2]).T
        )
        inside = (weights > 0).all(axis=0) & (weights.sum(axis=0) < 1)
        depth = a[k, 2] + (b - a)[k, 2] * weights[0] + (c - a)[k, 2] * weights[1]
        seen[k] = (inside & (depth >= depths - 1e-9)).any()
    found = in_front(small)
    np.testing.assert_array_equal(found, seen)
    assert 0 < found.sum() < 300


def test_what_holds_a_pixel_of_400_is_seen():
    """A right triangle holds a square with half of its sides, and that the middle of a pixel."""
    corners = np.random.default_rng(5).random((50, 1, 2)) * 0.99
    small = np.pad(
        corners + 2.05 / 400.0 * np.array([(0, 0), (1, 0), (0, 1)]), ((0, 0), (0, 0), (0, 1))
    )
    small[..., 2] = np.arange(1, 51)[:, None]  # those in front hide no other as a whole
    behind = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(1, 0, 0), (1, 1, 0), (0, 1, 0)]])
    assert in_front(np.concatenate([small, behind])).all()
