"""Pieces make up their patches, and none reaches farther than it says."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.density.law import Law, Wanted
from gaussmap.runtime.density.pieces import Pieces, cut_patches


def wanted_of(name: str, cells: tuple[int, int]) -> Wanted:
    return Wanted(gm.fit(gm.surfaces.surface(name), cells), Law(floor=1.0, bend=1.0))


def corners(pieces: Pieces) -> np.ndarray:
    """Return u, v of the corners (M, 3, 2)."""
    third = np.array([[2.0, -1.0], [-1.0, 2.0], [-1.0, -1.0]]) / 3.0
    return pieces.triangles[:, None, :2] + pieces.triangles[:, 2, None, None] * third


@pytest.mark.parametrize("radius", [0.5, 0.06])
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid"])
def test_pieces_make_up_the_patches(name, radius):
    pieces = cut_patches(wanted_of(name, (4, 4)), radius)
    odd = np.arange(len(pieces)) % 2 == 1
    for cut in (pieces, pieces.quarters, pieces[odd] + pieces[~odd]):
        areas = np.bincount(cut.patches, weights=cut.triangles[:, 2] ** 2)
        np.testing.assert_allclose(areas, 1.0, rtol=0, atol=1e-12)  # of each patch, twice
        u, v = np.moveaxis(corners(cut), 2, 0)
        assert (np.minimum(u, v) >= -1e-14).all()
        assert (u + v <= 1.0 + 1e-14).all()
        places = np.round(cut.triangles[:, :2] * 3e6).astype(int)
        assert len(np.unique(np.column_stack([cut.patches, places]), axis=0)) == len(cut)


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid", "cone"])
def test_no_point_of_a_piece_is_farther_than_its_extent(name):
    pieces = cut_patches(wanted_of(name, (6, 4)), 0.3)
    wanted, middles = pieces.wanted, pieces.middles()
    for share in (1.0, 0.5):
        at = middles_at(pieces, middles, corners(pieces), share)
        lengths = np.linalg.norm(at - middles[:, None, :3], axis=2)
        assert (lengths <= pieces.extents[:, None] * (1 + 1e-9) + 1e-14).all()
    assert (np.sqrt(wanted.largest[pieces.patches]) * pieces.extents).max() <= 2 * 0.3


def middles_at(pieces: Pieces, middles: np.ndarray, uv: np.ndarray, share: float) -> np.ndarray:
    """Return points (M, 3, 3) on the way from the middles to corners."""
    there = pieces.triangles[:, None, :2] * (1 - share) + uv * share
    points = [
        Pieces(pieces.wanted, pieces.patches, np.column_stack([there[:, k], np.ones(len(pieces))]))
        for k in range(3)
    ]
    return np.stack([x.middles()[:, :3] for x in points], axis=1)
