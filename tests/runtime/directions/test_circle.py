"""Unit normals in the plane."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.directions.unit import as_normals

COUNTS = [1, 2, 3, 4, 5, 6, 8, 12, 20, 100, 1001, 4096]


@pytest.mark.parametrize("count", COUNTS)
def test_angles(count):
    normals = gm.directions.circle(count)
    assert normals.shape == (count, 2)
    assert normals.flags.c_contiguous
    angle = 2 * np.pi * (np.arange(count) + 0.5) / count
    exact = np.column_stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(normals, exact, rtol=0, atol=2e-15)  # ulps of 2π
    assert (as_normals(normals, 2) == normals).all()


@pytest.mark.parametrize("count", [x for x in COUNTS if x % 2 == 0])
def test_mirrored_bit_for_bit(count):
    normals = gm.directions.circle(count)
    points = set(map(tuple, normals.tolist()))
    assert len(points) == count
    mirrors = [normals * [1, -1], normals * [-1, 1]] + [normals[:, ::-1]] * (count % 4 == 0)
    for mirrored in mirrors:
        assert set(map(tuple, mirrored.tolist())) == points
