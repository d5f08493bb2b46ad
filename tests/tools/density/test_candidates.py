"""Candidates against all distances, computed one by one."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density.angles import choose_apart
from gaussmap.tools.density.candidates import Candidates
from scipy.spatial import KDTree

from ...products import covering
from ...shapes import Array


def rows_of(count: int, seed: int, spread: float) -> Array:
    """Return random places (count, 8) in a box, with normals all round and uneven weights."""
    random = np.random.default_rng(seed)
    rows = random.standard_normal((count, 8))
    rows[:, :3] = random.random((count, 3)) - [0.3, 0.5, 2.0]
    rows[:, 3:6] /= np.linalg.norm(rows[:, 3:6], axis=1)[:, None]
    rows[:, 6] = np.exp(spread * random.random(count))
    return rows


def squares(rows: Array, samples: Array) -> Array:
    """Return all squared distances (places, samples) times weights, infinite on another side."""
    difference = rows[:, None, :3] - samples[None, :, :3]
    same = rows[:, 3:6] @ samples[:, 3:6].T >= 0.5
    return np.where(same, (difference**2).sum(axis=2) * rows[:, 6:7], np.inf)


@covering(spread=[0.0, 3.0, 12.0], radius=[0.05, 0.3], made=[0.5, 1.0, 2.0])
def test_places_know_the_nearest_sample_within_a_radius(spread, radius, made):
    rows, samples = rows_of(600, 1, spread), rows_of(80, 2, 0.0)[:, :6]
    samples[::2, :3] += 0.3 * (samples[::2, :3] - rows[:, :3].mean(axis=0))  # some outside the box
    candidates = Candidates(rows, made * radius)
    candidates.update_distances(samples[:30], radius)
    candidates.update_distances(samples[30:], radius)
    exact = np.sqrt(squares(rows, samples).min(axis=1))
    found = candidates.distances
    near = exact <= radius
    np.testing.assert_allclose(found[near], exact[near], rtol=1e-14)
    assert (found[~near] >= exact[~near] * (1 - 1e-14)).all()
    candidates.reset_distances()
    assert np.isinf(candidates.distances).all()


@pytest.mark.compiled
@pytest.mark.parametrize("spread", [0.0, 6.0])
def test_chosen_are_far_from_all_others_and_near_to_what_is_left(spread):
    rows, samples = rows_of(2000, 3, spread), rows_of(20, 4, 0.0)[:, :6]
    candidates, radius = Candidates(rows, 0.2), 0.2
    candidates.update_distances(samples, 0.4)
    chosen = np.empty(0, dtype=np.int64)
    for step in (0.4, 0.3, 0.2):
        chosen = np.append(chosen, candidates.choose(step, len(rows)))
        everything = np.concatenate([samples, rows[chosen, :6]])
        left = np.setdiff1d(np.arange(len(rows)), chosen)
        assert (squares(rows[left], everything).min(axis=1) <= step**2 * (1 + 1e-14)).all()
    assert len(set(chosen)) == len(chosen) > 20
    for k, place in enumerate(chosen):  # where it was chosen, no sample was near
        before = squares(rows[place : place + 1], everything[: 20 + k])
        assert before.min() > radius**2
    assert (candidates.distances <= radius).all()


def test_no_more_than_asked_are_chosen_from_all_over():
    rows = rows_of(500, 5, 0.0)
    whole = Candidates(rows, 0.1).choose(0.1, 500)
    part = Candidates(rows, 0.1).choose(0.1, 7)
    assert len(part) == 7
    at = np.flatnonzero(np.isin(whole, part))
    assert (np.diff(at) > len(whole) / 7 - 2).all()
    assert len(Candidates(rows, 0.1).choose(0.1, 0)) == 0


@pytest.mark.compiled
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_parts_know_of_one_another(threads, monkeypatch):
    """Rows that follow one another are neighbours; parts are shells of 100 of them."""
    rows = rows_of(2000, 8, 2.0)
    rows = rows[np.argsort(rows[:, 0])]
    whole = Candidates(rows, 0.15)
    monkeypatch.setattr("gaussmap.tools.density.candidates.SMALL", 100)
    candidates, radius = Candidates(rows, 0.15, threads, split=True), 0.15
    chosen = candidates.choose(2 * radius, 2000)
    chosen = np.append(chosen, candidates.choose(radius, 2000))
    assert len(set(chosen)) == len(chosen)
    near = squares(np.delete(rows, chosen, axis=0), rows[chosen, :6]).min(axis=1)
    assert (near <= radius**2 * (1 + 1e-14)).all()
    fewest = np.append(whole.choose(2 * radius, 2000), whole.choose(radius, 2000))
    assert len(chosen) < 1.05 * len(fewest)
    samples = rows[chosen, :6]
    for each in (candidates, whole):
        each.reset_distances()
        each.update_distances(samples, 0.3)
    np.testing.assert_array_equal(candidates.distances, whole.distances)


def test_places_without_a_normal_are_never_chosen():
    rows = rows_of(50, 6, 0.0)
    rows[::2, 3:6] = 0.0
    candidates = Candidates(rows, 0.1)
    chosen = candidates.choose(1e-3, 50)
    assert sorted(chosen) == list(range(1, 50, 2))
    assert np.isinf(candidates.distances[::2]).all()


# --- normals far from each other ------------------------------------------------------------------


def test_normals_are_chosen_far_from_known_ones():
    known, normals = gm.icosphere(3), gm.fibonacci(2000)
    near, widest = 0.1, 1.0
    chosen = choose_apart(np.concatenate([normals, np.zeros((1, 3))]), near, 1, widest, None, known)
    every = np.concatenate([known, normals[chosen]])
    distances, _ = KDTree(every).query(normals, k=2)
    assert distances[:, 0].max() <= near
    assert distances[chosen, 1].min() > near * 0.98
