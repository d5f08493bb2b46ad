"""Triangulations that are made in strips, and which triangles share an edge."""

from typing import Any

import numpy as np
import pytest
from gaussmap.tools.meshes import triangulation
from gaussmap.tools.meshes.links import neighbours


@pytest.mark.parametrize("kind", ["periodic", "mirrored"])
def test_strips_give_the_triangles_of_the_whole(kind: str, monkeypatch):
    positions = np.random.default_rng(5).random((900, 2))
    boundary: Any = ((kind, kind), ("periodic", "periodic"))
    found = []
    for strip in (1000, 200):
        monkeypatch.setattr(triangulation, "STRIP", strip)
        free = np.ones(len(positions), dtype=bool)
        triangles, sides = next(
            iter(triangulation.triangulations(positions, free, boundary, np.array([2.0, 1.0])))
        )
        first = triangles.argmin(axis=1)[:, None]
        turned = (first + np.arange(3)) % 3
        rows = [np.take_along_axis(x, turned, axis=1) for x in (triangles, sides)]
        found.append(np.unique(np.hstack(rows), axis=0))
        assert neighbours(triangles, ~free)[1]
    np.testing.assert_array_equal(*found)


def test_edges_of_one_two_and_three_triangles():
    triangles = np.array([[0, 1, 2], [2, 1, 3], [3, 1, 4]])
    adjacent, is_closed = neighbours(triangles, np.ones(5, dtype=bool))
    np.testing.assert_array_equal(adjacent, [[1, -1, -1], [2, -1, 0], [-1, -1, 1]])
    assert is_closed
    assert not neighbours(triangles, np.arange(5) > 0)[1]
    third = np.concatenate([triangles, [[1, 2, 5]]])
    adjacent, is_closed = neighbours(third, np.ones(6, dtype=bool))
    assert not is_closed
    np.testing.assert_array_equal(adjacent[:2], [[-1, -1, -1], [2, -1, -1]])


@pytest.mark.parametrize("length", [0.05, 1.0, 12.0])
def test_no_triangle_of_a_long_rectangle_is_turned_over(length: float):
    rng, step = np.random.default_rng(1), np.sqrt(length / 12_000)
    (u, zero_u), (v, zero_v) = (
        (np.arange(n) / n, np.zeros(n)) for n in (int(length / step), int(1.0 / step))
    )
    sides = [(u, zero_u), (zero_v + 1.0, v), (1.0 - u, zero_u + 1.0), (zero_v, 1.0 - v)]
    away = 0.3 * step / np.array([length, 1.0])
    inner = away + (1.0 - 2.0 * away) * rng.random((12_000, 2))
    positions = np.concatenate([inner, *(np.column_stack(x) for x in sides)])
    is_free, lengths = np.arange(len(positions)) < len(inner), np.array([length, 1.0])
    boundary: Any = (("open", "open"), ("open", "open"))
    triangles, _ = next(triangulation.triangulations(positions, is_free, boundary, lengths))
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (areas >= 0.0).all()
    assert areas.sum() == pytest.approx(2.0, rel=1e-12)
