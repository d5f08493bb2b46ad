"""Pieces make up their patches, and none reaches farther than it says."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.density.law import Law, Wanted
from gaussmap.runtime.density.pieces import Pieces, cut_patches


def wanted_of(name: str, cells: tuple[int, int]) -> Wanted:
    return Wanted(gm.fit(gm.surfaces.surface(name), cells), Law(floor=1.0, curvature_weight=1.0))


def sizes(pieces: Pieces) -> np.ndarray:
    """Return the areas of the triangles (M,) in u, v, twice."""
    return np.abs(np.linalg.det(pieces.corners[:, 1:] - pieces.corners[:, :1]))


@pytest.mark.parametrize("radius", [0.5, 0.06])
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid"])
def test_pieces_make_up_the_patches(name, radius):
    pieces = cut_patches(wanted_of(name, (4, 4)), radius)
    odd = np.arange(len(pieces)) % 2 == 1
    for cut in (pieces, pieces.quarters, pieces.halves, pieces[odd] + pieces[~odd]):
        areas = np.bincount(cut.patches, weights=sizes(cut))
        np.testing.assert_allclose(areas, 1.0, rtol=0, atol=1e-12)
        u, v = np.moveaxis(cut.corners, 2, 0)
        assert (np.minimum(u, v) >= -1e-14).all()
        assert (u + v <= 1.0 + 1e-14).all()
        places = np.round(cut.uv * 3e6).astype(int)
        assert len(np.unique(np.column_stack([cut.patches, places]), axis=0)) == len(cut)


@pytest.mark.parametrize("radius", [0.5, 0.06])
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid"])
def test_parts_are_their_shares_of_the_whole(name, radius):
    pieces = cut_patches(wanted_of(name, (4, 4)), radius)
    for parts, number in ((pieces.halves, 2), (pieces.quarters, 4)):
        np.testing.assert_array_equal(parts.patches, np.repeat(pieces.patches, number))
        shares = sizes(parts).reshape(-1, number) / sizes(pieces)[:, None]
        np.testing.assert_allclose(shares, 1 / number, rtol=1e-9)


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid", "cone"])
def test_no_point_of_a_piece_is_farther_than_its_extent(name):
    pieces = cut_patches(wanted_of(name, (6, 4)), 0.3)
    for cut in (pieces, pieces.halves.halves):
        middles = cut.middles()
        for share in (1.0, 0.5):
            at = points_towards_corners(cut, share)
            lengths = np.linalg.norm(at - middles[:, None, :3], axis=2)
            assert (lengths <= cut.extents[:, None] * (1 + 1e-9) + 1e-14).all()
    wanted = pieces.wanted
    assert (np.sqrt(wanted.largest[pieces.patches]) * pieces.extents).max() <= 2 * 0.3


def points_towards_corners(pieces: Pieces, share: float) -> np.ndarray:
    """Return points (M, 3, 3) on the way from the middles to corners."""
    there = pieces.uv[:, None] * (1 - share) + pieces.corners * share
    points = [
        Pieces(pieces.wanted, pieces.patches, np.repeat(there[:, k : k + 1], 3, axis=1))
        for k in range(3)
    ]
    return np.stack([x.middles()[:, :3] for x in points], axis=1)


@pytest.mark.parametrize("width", [1e-2, 1e-5])
def test_narrow_patches_are_cut_across(width):
    """Until they are short enough, or so small that there would be too many of them."""
    plane = gm.Surface.from_callable(
        lambda u, v: np.stack([u, width * v, 0.0 * u], axis=-1), ((0.0, 1.0), (0.0, 1.0))
    )
    wanted = Wanted(gm.fit(plane, (4, 4)), Law(floor=1.0))
    for radius in (0.05 * wanted.unit, 0.5 * width * wanted.unit):
        pieces = cut_patches(wanted, radius)
        areas = wanted.areas[pieces.patches] * sizes(pieces)
        short, small = pieces.extents <= radius, areas <= 0.5 * radius**2 * (1 + 1e-9)
        assert (short | small).all()
        assert len(pieces) <= 64 + 4 * max(wanted.area / (0.5 * radius**2), 64 * 2 / radius)


def test_angles_of_normals_in_a_piece():
    pieces = cut_patches(wanted_of("wavy_graph", (6, 4)), 0.3)
    rows = pieces.middles()
    turns = pieces.turns(rows)
    assert 0.0 < turns.max() < 1.0
    for share in (1.0, 0.7, 0.4):
        at = pieces.uv[:, None] * (1 - share) + pieces.corners * share
        for k in range(3):
            there = Pieces(pieces.wanted, pieces.patches, np.repeat(at[:, k : k + 1], 3, axis=1))
            chords = np.linalg.norm(there.middles()[:, 3:6] - rows[:, 3:6], axis=1)
            assert (chords <= turns * (1 + 1e-9) + 1e-14).all()
            assert share < 1.0 or (chords >= 0.2 * turns).mean() > 0.5
