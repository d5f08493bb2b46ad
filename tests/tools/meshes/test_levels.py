"""Nested levels of detail."""

from __future__ import annotations

import itertools

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["torus", "wavy_graph"])
def test_levels_are_nested_and_good_meshes(name: str) -> None:
    samples = gm.sample(name, 2000, cells=(24, 24))
    ordered, meshes = samples.progressive(), samples.levels([200, 600, 2000])
    for coarse, fine in itertools.pairwise(meshes):
        inner = coarse.sample_index[coarse.sample_index >= 0]
        assert inner.max() < len(fine.vertices)
        shared = np.isin(inner, fine.sample_index)
        assert shared.mean() > 0.95  # the others are too close to borders
    for mesh, count in zip(meshes, (200, 600, 2000), strict=True):
        inner = mesh.sample_index >= 0
        assert inner.sum() + mesh.left_out == count
        assert np.array_equal(mesh.vertices[inner], ordered.points[mesh.sample_index[inner]])
        assert mesh.euler_characteristic == (0 if name == "torus" else 1)
    worst = [mesh.angles.mean() for mesh in meshes]
    assert worst[0] > 1.5 * worst[1] > 2.25 * worst[2]


@pytest.mark.compiled
@pytest.mark.parametrize("counts", [[0], [201], [1.5], ["many"]])
def test_unusable_counts(counts: list) -> None:
    refused("level", gm.sample("torus", 200, cells=(16, 16)).levels, counts)
