"""Polylines that leave a curve to one side: no Open CASCADE is needed."""

import numpy as np
import pytest
from gaussmap.tools.cad.opencascade.polylines import one_sided

TOLERANCE = np.array([1e-3, 1e-3])


def wave(t):
    return np.stack([t, np.sin(t), np.ones_like(t), np.cos(t)], axis=1)


def filled(polyline, count=50):
    steps = np.linspace(0.0, 1.0, count)[:, None, None]
    return (polyline[:-1] + steps * np.diff(polyline, axis=0)).reshape(-1, 2)


@pytest.mark.parametrize("keep_left", [True, False])
def test_a_wave_stays_on_one_side(keep_left):
    polyline = one_sided(wave, 0.0, 6.0, 4, TOLERANCE, keep_left)
    np.testing.assert_allclose(polyline[[0, -1]], wave(np.array([0.0, 6.0]))[:, :2], atol=1e-15)
    x, y = filled(polyline).T
    above = (y - np.sin(x)) * (1.0 if keep_left else -1.0)
    assert above.min() > -1e-3 * TOLERANCE[0]
    assert above.max() < 1.5 * TOLERANCE[0]
    assert len(polyline) < 400


def test_a_straight_line_needs_no_more_points():
    def line(t):
        return np.stack([t, 2.0 * t, np.ones_like(t), 2.0 * np.ones_like(t)], axis=1)

    assert len(one_sided(line, 0.0, 1.0, 4, TOLERANCE, True)) == 5


def test_a_curve_that_stands_still_ends():
    def cusp(t):
        return np.stack([t**2, t**3, 2.0 * t, 3.0 * t**2], axis=1)

    polyline = one_sided(cusp, -1.0, 1.0, 4, TOLERANCE, True)
    x, y = filled(polyline).T
    assert np.abs(np.abs(y) - np.maximum(x, 0.0) ** 1.5).max() < 4e-3


def test_numbers_that_are_not_finite_end():
    def nowhere(t):
        return np.full((len(t), 4), np.nan)

    assert len(one_sided(nowhere, 0.0, 1.0, 4, TOLERANCE, True)) < 1 << 20
