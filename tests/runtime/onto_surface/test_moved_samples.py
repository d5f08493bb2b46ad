"""Samples of moved surfaces are the moved samples: rotated, shifted, scaled, mirrored."""

import gaussmap as gm
import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]

pytestmark = pytest.mark.compiled

NORMALS = gm.directions.random(400, seed=3)
CELLS = (24, 24)
DEVELOPABLE = ("plane", "cylinder", "cone")  # normals alone sample nothing of these
TURNED = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
MOVES = {
    "rotated": TURNED * np.sign(np.linalg.det(TURNED)),
    "mirrored": np.diag([1.0, -1.0, 1.0]),
    "large": 1e9 * np.eye(3),
    "small": 1e-9 * np.eye(3),
    "far": np.block([[np.eye(3), np.full((3, 1), 1e6)], [np.zeros((1, 3)), np.ones((1, 1))]]),
}
EACH = [x for x in gm.surfaces.names() if x not in DEVELOPABLE]


def compare(name: str, move: str) -> None:
    """Compare the samples of a surface and of the moved one that the surface is sampled on, too.

    Where both are found on the surface, at points that are not nearly parabolic: there points are
    within the rounding of the coordinates and of Newton's method, and there is one for each.
    """
    surface, matrix = gm.surfaces.surface(name), MOVES[move]
    linear, shift = matrix[:3, :3], matrix[:3, 3] if len(matrix) == 4 else np.zeros(3)
    size = float(np.linalg.norm(linear, 2))
    directions = NORMALS @ (linear / size).T
    plain = gm.sample(surface, normals=NORMALS, cells=CELLS)
    moved = gm.sample(surface.transformed(matrix), normals=directions, cells=CELLS)
    expected = plain.points @ linear.T + shift
    rounding = 2.0**-50 * (np.abs(expected).max() + np.abs(moved.points).max())
    missing = np.zeros(2, dtype=int)
    for one, other, a, b in (
        (plain, moved, expected, moved.points),
        (moved, plain, moved.points, expected),
    ):
        assert one.on_surface is not None
        assert other.on_surface is not None
        for k in np.flatnonzero(one.on_surface):
            same = np.flatnonzero((other.normal_index == one.normal_index[k]) & other.on_surface)
            near = np.linalg.norm(b[same] - a[k], axis=1).min(initial=np.inf)
            radius = (
                1.0 / np.abs(one.principal_curvatures[k]).min() * (size if one is plain else 1.0)
            )
            missing[one is moved] += near > 1e-11 * radius + 100.0 * rounding
    # Next to open borders and parabolic curves rounding decides what is found.
    assert missing.max() <= 0.01 * len(plain), (missing, len(plain))
    assert len(plain) > 30


@pytest.mark.parametrize("move", MOVES)
def test_samples_of_a_moved_torus(move):
    compare("torus", move)


@pytest.mark.slow
@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("name", EACH)
def test_samples_of_all_moved_surfaces(name, move):
    compare(name, move)
