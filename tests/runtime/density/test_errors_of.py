"""The errors that "balanced" chooses by, against SciPy's k-d trees."""

from __future__ import annotations

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.density.cover import Cover
from gaussmap.runtime.density.errors_of import Errors, places_on
from gaussmap.runtime.density.sizing import uniform
from scipy.spatial import KDTree


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["torus", "monkey_saddle", "cylinder"])
def test_errors_are_those_of_the_nearest_samples(name):
    spline = gm.fit(gm.surfaces.surface(name), (16, 16))
    sizing = uniform(spline, None, None)
    cover = Cover(sizing, None)
    cover.to_count(300)
    places, rows = places_on(sizing)
    found = Errors(cover, places, rows, 0.3, 0.2)
    distances, nearest = KDTree(cover.points[:, :3]).query(rows[:, :3])
    samples = cover.points[nearest]
    chords = np.linalg.norm(rows[:, 3:6] - samples[:, 3:], axis=1)
    away = np.abs(((rows[:, :3] - samples[:, :3]) * samples[:, 3:]).sum(axis=1))
    np.testing.assert_allclose(found.in_space, chords.max(), rtol=1e-12)
    np.testing.assert_allclose(found.tangent, away.max(), rtol=1e-9)
    assert distances.max() <= found.gap <= 1.1 * distances.max()
    flat = 1e-9 * np.abs(rows[:, 7]).max()
    negative, of_samples = rows[:, 7] < -flat, cover.curvatures < -flat
    expected = max(
        KDTree(cover.points[of_samples == side, 3:]).query(rows[negative == side, 3:6])[0].max()
        for side in np.unique(negative)
    )
    # Normals closer than 2⁻¹⁷ count as one.
    np.testing.assert_allclose(found.in_normal, expected, atol=4 * 2.0**-17)
