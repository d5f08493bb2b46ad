"""Spreading samples: how wide the gaps are that are left."""

import gaussmap as gm
import numpy as np
import pytest
from scipy.spatial import KDTree


@pytest.mark.compiled
def test_gaps_between_candidates_are_filled():
    """The widest gap on a square of a plane: 1.34 times that of a hexagonal lattice.

    It is 1.46 times that if samples are not moved, and 1.47 if gaps are those at candidates.
    """
    samples = gm.sample("plane", 2000, density="uniform", cells=(8, 8))
    (u0, u1), (v0, v1) = gm.surfaces.surface("plane").domain
    u, v = np.meshgrid(np.linspace(u0, u1, 700)[35:-35], np.linspace(v0, v1, 700)[35:-35])
    places = np.stack([u.ravel(), v.ravel()], axis=1)
    widest = KDTree(samples.uv).query(places)[0].max()
    lattice = np.sqrt((u1 - u0) * (v1 - v0) / 2000 * 2.0 / (3.0 * np.sqrt(3.0)))
    assert widest < 1.4 * lattice
