"""NURBS: points and 2-jets per second of a bicubic surface, compared with SciPy."""

from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest
from scipy.interpolate import NdBSpline

COUNT, SIZE = 20_000, 20
ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
RNG = np.random.default_rng(0)
KNOTS = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, SIZE - 2), np.ones(3)])
POINTS, WEIGHTS = RNG.random((SIZE, SIZE, 3)), RNG.uniform(0.5, 2.0, (SIZE, SIZE))


@pytest.mark.parametrize("orders", [1, 6], ids=["points", "jets"])
@pytest.mark.parametrize("rational", [False, True], ids=["polynomial", "rational"])
def test_bicubic(compare, orders, rational):
    weights = WEIGHTS if rational else None
    surface = gm.Surface.from_nurbs((3, 3), (KNOTS, KNOTS), POINTS, weights)
    factors = WEIGHTS[:, :, None] if rational else np.ones((SIZE, SIZE, 1))
    homogeneous = np.concatenate([POINTS * factors, factors], axis=2)[:, :, : 4 if rational else 3]
    spline = NdBSpline((KNOTS, KNOTS), homogeneous, 3)
    u, v = RNG.random((2, COUNT))
    uv = np.stack([u, v], axis=1)
    compare(
        lambda: surface.jets(u, v) if orders == 6 else surface.evaluate(u, v),
        baselines={"scipy": lambda: [spline(uv, nu=nu) for nu in ORDERS[:orders]]},
        units={"points": COUNT},
        rounds=3,
    )
