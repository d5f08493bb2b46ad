"""Covers, step by step."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.density.cover import Cover
from gaussmap.runtime.density.methods import space_on
from gaussmap.runtime.density.space import Space


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "plane"])
def test_what_is_filled_up_is_far_from_all_samples(name):
    """Also from those that came for places between the candidates."""
    space = space_on(gm.fit(gm.surfaces.surface(name), (16, 16)), None, None)
    cover = Cover(space)
    cover.to_radius(0.1 * np.sqrt(space.area))
    before = cover.count
    cover.fill_up(before + 100)
    assert cover.count == before + 100
    points, normals = cover.points[:, :3], cover.points[:, 3:]
    for k in range(before, cover.count):
        same = normals[:k] @ normals[k] >= 0.5
        assert np.linalg.norm(points[:k][same] - points[k], axis=1).min() > cover.radius


@pytest.mark.compiled
@pytest.mark.parametrize("density", ["uniform", "balanced"])
@pytest.mark.parametrize("name", ["torus", "catenoid", "wavy_graph"])
def test_candidates_for_a_count_are_evaluated_once(name, density, monkeypatch):
    """The radius that a count leaves is known well enough before."""
    taken, cut = [], Space.cut

    def recorded(*arguments):
        taken.append(cut(*arguments))
        return taken[-1]

    monkeypatch.setattr(Space, "cut", recorded)
    gm.sample(gm.fit(name, (32, 32)), 600, density=density)
    assert len(taken) == 1
