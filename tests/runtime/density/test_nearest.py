"""The samples nearest to places, against all distances."""

from __future__ import annotations

import numpy as np
import pytest
from gaussmap.runtime.density.nearest import NearestSamples


def rows_of(count: int, seed: int) -> np.ndarray:
    """Return random places (count, 8) in a box, most of them at one corner, with normals."""
    random = np.random.default_rng(seed)
    rows = random.standard_normal((count, 8))
    rows[:, :3] = random.random((count, 3)) ** 3 - [0.3, 0.5, 2.0]
    rows[:, 3:6] /= np.linalg.norm(rows[:, 3:6], axis=1)[:, None]
    return rows


@pytest.mark.parametrize("count", [1, 2, 60])
def test_nearest_are_those_on_the_same_side(count):
    rows, samples = rows_of(80, 1), rows_of(count, 2)[:, :6]
    # Two samples at one place: the first one is taken.
    samples = np.concatenate([samples, samples])
    distances, numbers = NearestSamples(samples, 1).nearest(rows, 0.4)
    apart = np.linalg.norm(rows[:, None, :3] - samples[:, :3], axis=2)
    same = np.where(rows[:, 3:6] @ samples[:, 3:].T >= 0.0, apart, np.inf)
    near = same.min(axis=1) <= 0.4
    np.testing.assert_array_equal(numbers[near], same.argmin(axis=1)[near])
    np.testing.assert_allclose(distances[near], same.min(axis=1)[near], rtol=1e-14)
    np.testing.assert_allclose(distances[~near], apart.min(axis=1)[~near], rtol=1e-14)


def test_samples_at_one_place_and_on_a_line():
    rows = rows_of(20, 3)
    rows[:, 3:6] = [1.0, 0.0, 0.0]
    samples = np.zeros((30, 6))
    samples[:, 3] = 1.0
    for x in (0.0, np.linspace(-1.0, 1.0, 30)):
        samples[:, 0] = x
        distances, _ = NearestSamples(samples, 1).nearest(rows, 10.0)
        apart = np.linalg.norm(rows[:, None, :3] - samples[:, :3], axis=2)
        np.testing.assert_allclose(distances, apart.min(axis=1), rtol=1e-14)
