"""Triangles in front of others."""

import numpy as np
from gaussmap.tools.meshes import front
from gaussmap.tools.meshes.front import Front, in_front


def depths_at(triangles: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the depth (T, k) of each triangle at places (k, 2), −∞ beside it."""
    found = np.full((len(triangles), len(places)), -np.inf)
    for row, (a, b, c) in zip(found, triangles, strict=True):
        sides = np.stack([b - a, c - a], axis=1)
        s, t = np.linalg.solve(sides[:2], (places - a[:2]).T)
        inside = (s >= 0) & (t >= 0) & (s + t <= 1)
        row[inside] = (a[2] + s * sides[2, 0] + t * sides[2, 1])[inside]
    return found


def test_front_is_the_nearest_triangle() -> None:
    rng = np.random.default_rng(0)
    triangles, places = rng.random((200, 3, 3)), rng.random((300, 2))
    expected = depths_at(triangles, places).max(axis=0)
    np.testing.assert_allclose(Front.of(triangles).at(places), expected, rtol=1e-6)


def test_front_without_area_or_places() -> None:
    flat = np.zeros((2, 3, 3))
    assert Front.of(flat).at(np.zeros((1, 2)))[0] == -np.inf
    assert Front.of(flat).at(np.zeros((0, 2))).shape == (0,)


def test_the_front_triangles_of_pixels_are_found(monkeypatch):
    monkeypatch.setattr(front, "AT_ONCE", 7)  # some of the triangles, in turn
    monkeypatch.setattr(front, "PIXELS", 50)
    triangles = np.random.default_rng(4).random((300, 3, 3))
    centres = triangles.mean(axis=1, keepdims=True)
    small = (triangles - centres) * 0.4 + centres
    low, size = small[..., :2].min(axis=(0, 1)), np.ptp(small[..., :2], axis=(0, 1)).max()
    middles = (np.arange(front.PIXELS + 1) + 0.5) * size / front.PIXELS
    pixels = low + np.stack(np.meshgrid(middles, middles), axis=2).reshape(-1, 2)
    depths = depths_at(small, pixels)
    seen = (np.isfinite(depths) & (depths >= depths.max(axis=0) - 1e-9)).any(axis=1)
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
