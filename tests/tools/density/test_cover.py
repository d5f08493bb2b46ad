"""Covers, step by step."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density.cover import Cover
from gaussmap.tools.density.methods import space_on
from gaussmap.tools.density.space import Space
from scipy.spatial import KDTree

from ...products import covering


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


@covering(density=["uniform", "balanced"], name=["torus", "catenoid", "wavy_graph"])
def test_candidates_for_a_count_are_evaluated_once(name, density, monkeypatch):
    """The radius that a count leaves is known well enough before."""
    taken, cut = [], Space.candidates

    def recorded(*arguments):
        taken.append(cut(*arguments))
        return taken[-1]

    monkeypatch.setattr(Space, "candidates", recorded)
    gm.sample(gm.fit(name, (32, 32)), 600, density=density)
    assert len(taken) == 1


@covering(width=[1e-9, 1e-4], count=[10, 50, 200])
def test_samples_of_a_narrow_strip_stand_in_a_row(width, count, monkeypatch):
    """As many places as for other surfaces are looked at: the area says nothing of the gaps."""
    looked_at = []
    evaluated = Space.evaluated

    def counted(space, cells, *others):
        looked_at.append(len(cells))
        return evaluated(space, cells, *others)

    monkeypatch.setattr(Space, "evaluated", counted)
    strip = gm.Surface.from_callable(
        lambda u, v: np.stack([u, width * v, width * np.sin(3 * u) * np.cos(2 * v)], axis=-1),
        domain=((0, 1), (0, 1)),
    )
    places = np.sort(gm.sample(strip, count, density="uniform").points[:, 0])
    assert len(places) == count
    assert np.diff([-places[0], *places, 2.0 - places[-1]]).max() <= 1.6 / count
    assert sum(looked_at) < 100_000


# --- gaps between samples -------------------------------------------------------------------------


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
