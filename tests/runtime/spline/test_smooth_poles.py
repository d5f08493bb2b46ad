"""The ring of coefficients around a pole, moved into one plane."""

from fractions import Fraction

import numpy as np
import pytest
from gaussmap.runtime.spline.poles import ring_around


@pytest.mark.parametrize(("count", "error"), [(8, 1.6e-9), (64, 1.6e-9), (512, 4e-9)])
def test_a_ring_hardly_moves(count, error):
    """Its radius is 0.1: the mean of the largest errors of twenty planes."""
    rng, angles = np.random.default_rng(0), 2.0 * np.pi * np.arange(count) / count
    errors = []
    for _ in range(20):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        ring = 0.1 * np.stack([np.cos(angles), np.sin(angles)], axis=1) @ axes + (1.0, 0.3, 0.2)
        found, pole = ring_around(ring)
        a, b, c = ([Fraction(float(x)) for x in row] for row in (found - pole)[[0, 1, count // 3]])
        assert (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        ) == 0
        errors.append(np.abs(found - ring).max())
    assert np.mean(errors) < error
