"""Voronoi cells among finer places of a plane, against all distances."""

import numpy as np
import pytest
from gaussmap.tools.density import candidates as candidates_module
from gaussmap.tools.density.candidates import Candidates
from gaussmap.tools.density.cells import Cells, new_cells
from gaussmap.tools.density.voronoi import Voronoi
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIDE, FINER = 12, 4  # cells along a side of the unit square, and places along a side of a cell


def plane() -> Cells:
    """Return the cells of the unit square of a plane; the density grows along u."""
    low = np.stack(np.meshgrid(*2 * [np.arange(SIDE) / SIDE], indexing="ij"), -1).reshape(-1, 2)
    boxes = np.hstack([low, low + 1.0 / SIDE])
    cells = new_cells(np.zeros(SIDE**2, dtype=np.int64), boxes, True).with_rows()
    cells.rows[:, :2], cells.rows[:, 5] = cells.places, 1.0
    cells.rows[:, 6] = 1.0 + 3.0 * cells.places[:, 0]
    cells.numbers[:, 6] = 1.0 / SIDE**2  # the area, and the sides
    cells.numbers[:, 8] = cells.numbers[:, 12] = 1.0 / SIDE
    return cells


def places_of(cells: Cells) -> tuple[Array, Array, NDArray[np.int64]]:
    """Return the finer places of cells, the densities there, and the numbers of the cells."""
    steps = (np.arange(FINER) + 0.5) / FINER - 0.5
    offsets = np.stack(np.meshgrid(steps, steps, indexing="ij"), -1).reshape(-1, 2) / SIDE
    number = np.repeat(np.arange(len(cells)), FINER**2)
    offsets = np.tile(offsets, (len(cells), 1)) * cells.whole[number, None]
    return cells.places[number] + offsets, cells.rows[number, 6], number


def samples_of(count: int, seed: int) -> Array:
    samples = np.zeros((count, 6))
    samples[:, :2], samples[:, 5] = np.random.default_rng(seed).random((count, 2)), 1.0
    return samples


def voronoi(cells: Cells, samples: Array, margin: float) -> Voronoi:
    candidates = Candidates(cells.rows, 0.1)
    candidates.update_distances(samples, 3.0)
    return Voronoi(candidates, cells, samples, 3.0, margin)


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.compiled
def test_samples_move_to_the_place_nearest_to_the_mean(cut):
    """Weighted by the third derivative of w² d⁴; fixed samples and those on another side stay."""
    cells, samples = plane(), samples_of(14, 1)
    cells.whole[::3] = not cut
    samples[9, 5] = -1.0
    moved, rows, places = voronoi(cells, samples, 0.0).centres(samples, 4)
    finer, density, _ = places_of(cells)
    squares = ((finer[:, None] - samples[:, :2]) ** 2).sum(axis=2)
    squares[:, 9] = np.inf
    owner = squares.argmin(axis=1)
    assert moved.tolist() == [k for k in range(4, 14) if k != 9]
    for k, row, place in zip(moved, rows, places, strict=True):
        weights = np.where(owner == k, density**2 * squares[:, k], 0.0)
        mean = (weights[:, None] * finer).sum(axis=0) / weights.sum()
        least = np.linalg.norm(finer - mean, axis=1).min()
        # Beyond cells that are cut, the nearest place may be in a cell that is not looked at.
        assert np.linalg.norm(place - mean) <= least + (0.5 / SIDE if cut else 1e-12)
        assert (np.abs(place - cells.places[row]) < 0.5 / SIDE).all()


@pytest.mark.compiled
@pytest.mark.parametrize("cut", [False, True])
def test_the_widest_gaps_are_found_after_samples_have_moved(cut):
    cells, samples = plane(), samples_of(30, 2)
    cells.whole[::3] = not cut
    found = voronoi(cells, samples, 0.05)
    turns = np.random.default_rng(3).random(30) * 2.0 * np.pi
    samples[:, :2] += 0.02 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    rows, places = found.widest(samples, 0.2)
    finer, density, number = places_of(cells)
    distances = np.sqrt(((finer[:, None] - samples[:, :2]) ** 2).sum(axis=2).min(axis=1) * density)
    widest = np.zeros(len(cells))
    np.maximum.at(widest, number, distances)
    assert sorted(rows) == np.flatnonzero(widest >= 0.2).tolist()
    assert 5 < len(rows) < len(cells) / 2
    near = np.sqrt(((places[:, None] - samples[:, :2]) ** 2).sum(axis=2).min(axis=1))
    np.testing.assert_allclose(near * np.sqrt(cells.rows[rows, 6]), widest[rows], rtol=1e-12)


def test_places_far_from_all_samples_are_found():
    """Where no sample is within the radius, the place of the candidate counts."""
    cells, samples = plane(), samples_of(1, 4)
    candidates = Candidates(cells.rows, 0.1)
    candidates.update_distances(samples, 9.0)
    rows, places = Voronoi(candidates, cells, samples, 0.1, 0.0).widest(samples, 0.5)
    away = np.linalg.norm(cells.places - samples[0, :2], axis=1) * np.sqrt(cells.rows[:, 6])
    assert set(rows) == set(np.flatnonzero(away >= 0.5))
    # Others share a bucket of a grid with places that are near.
    assert (places == cells.places[rows]).all(axis=1).mean() > 0.9


@pytest.mark.compiled
def test_parts_of_candidates_have_the_centres_and_gaps_of_the_whole(monkeypatch):
    cells, samples = plane(), samples_of(30, 2)

    def found(count: int) -> list[Array]:
        candidates = Candidates(cells.rows, 0.1, split=True)
        assert len(candidates.parts) == count
        candidates.update_distances(samples, 3.0)
        made = Voronoi(candidates, cells, samples, 3.0, 0.05)
        moved, rows, places = made.centres(samples, 4)
        far, gaps = made.widest(samples, 0.2)
        order = np.argsort(far)
        return [moved, rows, places, far[order], gaps[order]]  # pyright: ignore[reportReturnType]

    whole = found(1)
    monkeypatch.setattr(candidates_module, "PART", 20)
    for one, other in zip(whole, found(7), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-12)
