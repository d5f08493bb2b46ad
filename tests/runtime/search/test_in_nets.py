"""The boundary cones that decide for both patches of a joint."""

from __future__ import annotations

from typing import Literal

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search.in_nets import edge_signs
from numpy.typing import NDArray

Array = NDArray[np.float64]


def test_forms_of_edges_are_those_of_the_patch() -> None:
    """Every form has one sign whichever patch of a joint is asked; that of U, V, W at random."""
    nets = np.random.default_rng(5).normal(size=(3, 6, 3))
    spline = gm.Spline.from_nets(nets)
    normals = gm.directions.random(50, seed=6)
    for edge, form in enumerate("UVW"):
        for patch, net in enumerate(nets):
            rows = np.full(len(normals), 3 * patch + edge)
            expected = [_form(net, n, form) for n in normals]
            assert (edge_signs(spline, rows, normals) == np.sign(expected)).all()


def _form(net: Array, n: Array, form: str) -> float:
    """Return U, V or W of Cramer's rule."""
    h = net @ n
    A, C = h[0] - 2 * h[4] + h[2], h[1] - 2 * h[5] + h[2]
    B, P, Q = h[3] - h[4] - h[5] + h[2], h[4] - h[2], h[5] - h[2]
    U, V, D = B * Q - C * P, B * P - A * Q, A * C - B * B
    return {"U": U, "V": V, "W": D - U - V}[form]


@pytest.mark.parametrize("name", ["sphere", "ellipsoid"])
def test_poles_are_one_point_with_their_normal(name: Literal["sphere", "ellipsoid"]) -> None:
    """Around them, at distances from none to that of patches, normals have one point, too."""
    spline = gm.Spline.from_nets(gm.fit(name, (12, 8)).control_nets)
    away = np.random.default_rng(7).normal(size=(200, 2))
    away *= np.logspace(-17, -1, 200)[:, None]
    for pole in (-1.0, 1.0):
        n = np.column_stack([away, np.full(200, pole)])
        n[:2, :2] = [(0.0, 0.0), (1e-16, 0.0)]
        normals = n / np.linalg.norm(n, axis=1)[:, None]
        samples = gm.sample(spline, normals=normals)
        assert samples.normal_index.tolist() == list(range(200))
        assert (samples.gaussian_curvature > 0.0).all()
        assert np.abs(samples.points[:2, :2]).max() < 1e-9
