"""Nets: joints at poles, where many patches meet."""

from typing import Literal

import gaussmap as gm
import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]


@pytest.mark.parametrize("name", ["sphere", "ellipsoid"])
def test_poles_are_one_point_with_their_normal(name: Literal["sphere", "ellipsoid"]) -> None:
    """Around them, at distances from none to that of patches, normals have one point, too."""
    spline = gm.Spline.from_nets(gm.fit(name, (12, 8)).control_nets)
    away = np.random.default_rng(7).normal(size=(60, 2))
    away *= np.logspace(-17, -1, 60)[:, None]
    for pole in (-1.0, 1.0):
        n = np.column_stack([away, np.full(60, pole)])
        n[:2, :2] = [(0.0, 0.0), (1e-16, 0.0)]
        normals = n / np.linalg.norm(n, axis=1)[:, None]
        samples = gm.sample(spline, normals=normals)
        assert samples.normal_index.tolist() == list(range(60))
        assert (samples.gaussian_curvature > 0.0).all()
        assert np.abs(samples.points[:2, :2]).max() < 1e-9
