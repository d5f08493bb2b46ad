"""Voronoi cells among finer places of a plane, against all distances."""

import numpy as np
import pytest
from gaussmap.tools.density import candidates as candidates_module
from gaussmap.tools.density.candidates import Candidates
from gaussmap.tools.density.cells import Cells, Sides, joined, new_cells
from gaussmap.tools.density.voronoi import Voronoi
from numpy.typing import NDArray

from ...shapes import Array

SIDE, FINER = 12, 4  # cells along a side of the unit square, and places along a side of a cell


def plane(*, cut: bool = False) -> tuple[Cells, Sides]:
    """Return cells of the unit square of a plane, and their sides; the density grows along u.

    If they are cut, a boundary intersects each third one.
    """
    low = np.stack(np.meshgrid(*2 * [np.arange(SIDE) / SIDE], indexing="ij"), -1).reshape(-1, 2)
    boxes = np.hstack([low, low + 1.0 / SIDE])
    cells = new_cells(np.zeros(SIDE**2, dtype=np.int64), boxes, True).with_rows()
    cells.rows[:, :2], cells.rows[:, 5] = cells.places, 1.0
    cells.rows[:, 6] = 1.0 + 3.0 * cells.places[:, 0]
    cells.whole[::3] = not cut
    sides = np.zeros((SIDE**2, 8), dtype=np.float32)
    sides[cells.whole, 0] = sides[cells.whole, 4] = 1.0 / SIDE
    sides[:, 6] = 1.0 / SIDE**2  # the area
    sides[cells.whole, 7] = np.sqrt(2.0) * (0.5 - 0.5 / FINER) / SIDE
    return cells, sides


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


def voronoi(found: tuple[Cells, Sides], samples: Array) -> Voronoi:
    cells, sides = found
    return Voronoi(Candidates(cells.rows, 0.1, split=True), cells, sides, samples, 3.0)


@pytest.mark.parametrize("cut", [False, True])
def test_samples_move_to_the_mean(cut):
    """Weighted by the third derivative of w² d⁴; fixed samples and those on another side stay.

    The mean is computed in single precision, from coordinates relative to its neighbours. Samples
    keep away from the edges of cells, where the surface may be singular.
    """
    (cells, sides), samples = plane(cut=cut), samples_of(14, 1)
    samples[9, 5] = -1.0
    moved, rows, places = voronoi((cells, sides), samples).centres(samples, 4)
    finer, density, _ = places_of(cells)
    squares = ((finer[:, None] - samples[:, :2]) ** 2).sum(axis=2)
    squares[:, 9] = np.inf
    owner = squares.argmin(axis=1)
    assert moved.tolist() == [k for k in range(4, 14) if k != 9]
    for k, row, place in zip(moved, rows, places, strict=True):
        weights = np.where(owner == k, density**2 * squares[:, k], 0.0)
        mean = (weights[:, None] * finer).sum(axis=0) / weights.sum()
        nearest = np.linalg.norm(cells.places - mean, axis=1).argmin()
        assert row == nearest
        most = 0.45 / SIDE if cells.whole[row] else 0.0
        expected = np.clip(mean, cells.places[row] - most, cells.places[row] + most)
        np.testing.assert_allclose(place, expected, atol=1e-5)


@pytest.mark.parametrize("cut", [False, True])
def test_the_widest_gaps_are_found_after_samples_have_moved(cut):
    (cells, sides), samples = plane(cut=cut), samples_of(30, 2)
    found = voronoi((cells, sides), samples)
    turns = np.random.default_rng(3).random(30) * 2.0 * np.pi
    samples[:, :2] += 0.02 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    rows, places, gaps = found.widest(samples, (0.2, 0.0, 1.0))
    finer, density, number = places_of(cells)
    distances = np.sqrt(((finer[:, None] - samples[:, :2]) ** 2).sum(axis=2).min(axis=1) * density)
    widest = np.zeros(len(cells))
    np.maximum.at(widest, number, distances)
    assert sorted(rows) == np.flatnonzero(widest >= 0.2).tolist()
    assert 5 < len(rows) < len(cells) / 2
    near = np.sqrt(((places[:, None] - samples[:, :2]) ** 2).sum(axis=2).min(axis=1))
    np.testing.assert_allclose(near * np.sqrt(cells.rows[rows, 6]), widest[rows], rtol=1e-6)
    np.testing.assert_allclose(np.sqrt(gaps[:, 1]), widest[rows], rtol=1e-6)
    np.testing.assert_allclose(gaps[:, 0], cells.rows[rows, 6])


@pytest.mark.kernels
def test_places_far_from_all_samples_are_found():
    """Where no sample is near the bucket of a candidate, its place counts."""
    (cells, sides), samples = plane(cut=True), samples_of(1, 4)
    made = Voronoi(Candidates(cells.rows, 0.1), cells, sides, samples, 0.5)
    rows, places, gaps = made.widest(samples, (0.5, 0.0, 1.0))
    finer, density, number = places_of(cells)
    away = np.linalg.norm(finer - samples[0, :2], axis=1) * np.sqrt(density)
    assert set(rows) == set(number[away >= 0.5])
    # Others share a bucket of a grid with places that are near.
    far = gaps[:, 1] > 1e6
    assert far.mean() > 0.4
    assert (places == cells.places[rows])[far].all()


def test_angles_to_nearest_samples_are_gaps_up_to_a_bound():
    """Samples with another normal make gaps around them, as wide as the chord between normals.

    The density of such a gap has a ceiling.
    """
    (cells, sides), samples = plane(), samples_of(30, 2)
    samples[:15, 3:] = 0.6, 0.0, 0.8
    squares = ((cells.places[:, None] - samples[:, :2]) ** 2).sum(axis=2)
    turned, chord = squares.argmin(axis=1) < 15, np.sqrt(0.4)
    least = squares.min(axis=1)
    for most, ceiling in ((1.01, 1e9), (0.99, 1e9), (1.01, 20.0)):
        made = voronoi((cells, sides), samples)
        rows, places, gaps = made.widest(samples, (0.99 * chord, most * chord, ceiling))
        found = turned & (most > 1.0) & (ceiling * least >= (0.99 * chord) ** 2)
        assert sorted(rows) == np.flatnonzero(found).tolist()
        np.testing.assert_allclose(places, cells.places[rows])
        np.testing.assert_allclose(gaps[:, 1], np.minimum(0.4, ceiling * least[rows]), rtol=1e-5)
        np.testing.assert_allclose(gaps[:, 0] * least[rows], gaps[:, 1], rtol=1e-5)
    assert len(rows) > 1


def test_samples_on_the_other_side_of_a_thin_wall_stay_there():
    """The centre of a sample may be nearer to the places of the other side."""
    cells, sides = plane()
    below = cells[np.arange(len(cells))]
    below.rows[:, 2], below.rows[:, 5] = -1e-3 / SIDE, -1.0
    samples = np.concatenate([samples_of(9, 1), samples_of(9, 2)])
    samples[9:, 2], samples[9:, 5] = -1e-3 / SIDE, -1.0
    both = joined([cells, below])
    found = voronoi((both, np.concatenate([sides, sides])), samples)
    moved, rows, _ = found.centres(samples, 0)
    assert moved.tolist() == list(range(18))
    assert ((rows < len(cells)) == (moved < 9)).all()


@pytest.mark.parametrize("threads", [1, 2])
def test_parts_of_candidates_have_the_centres_and_gaps_of_the_whole(threads, monkeypatch):
    (cells, sides), samples = plane(), samples_of(30, 2)

    def found(count: int) -> list[Array]:
        candidates = Candidates(cells.rows, 0.1, threads, split=True)
        assert len(candidates.parts) == count
        made = Voronoi(candidates, cells, sides, samples, 3.0)
        moved, rows, places = made.centres(samples, 4)
        far, widest, gaps = made.widest(samples, (0.2, 0.0, 1.0))
        order = np.argsort(far)
        return [moved, rows, places, far[order], widest[order], gaps[order]]  # pyright: ignore[reportReturnType]

    whole = found(1)
    monkeypatch.setattr(candidates_module, "SMALL", 20)
    for one, other in zip(whole, found(7), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-6)
