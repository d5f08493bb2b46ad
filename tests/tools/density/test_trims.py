"""Trims of many pieces say what each of them says."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density import along_borders, sifting
from gaussmap.tools.density.methods import space_on
from gaussmap.tools.density.trims import Trims

# Across the seams of u and v, with a hole.
LOOPS = [
    np.array([(5.0, 1.0), (8.0, 1.5), (7.0, 7.5), (5.5, 6.0)]),
    np.array([(6.0, 2.0), (6.5, 2.0), (6.2, 3.0)]),
]


@pytest.fixture(scope="module")
def pieces():
    torus = gm.surfaces.torus()
    surfaces = (
        torus.trimmed(LOOPS),
        torus.trimmed(LOOPS).flipped(),
        torus,
        torus.trimmed(within=lambda u, v: u < 2.0),
        torus.trimmed(LOOPS, within=lambda u, v: v < 4.0).flipped(),
    )
    return [space_on(gm.fit(x, (16, 16)), x, None).pieces[0] for x in surfaces]


def test_places_are_inside_as_each_piece_says(pieces):
    """Those of whole periods away, too."""
    rng, every = np.random.default_rng(1), Trims(pieces)
    numbers, places = rng.integers(0, len(pieces), 3000), rng.uniform(-3.0, 9.0, (3000, 2))
    inside = every.contains(numbers, places)
    for k, piece in enumerate(pieces):
        here = numbers == k
        np.testing.assert_array_equal(inside[here], piece.contains(places[here]))
        assert inside[here].all() == (k == 2)


def test_cells_do_not_depend_on_blocks(pieces, monkeypatch):
    def cells():
        space = space_on(gm.fit(gm.surfaces.torus(), (16, 16)), gm.surfaces.torus(), None)
        space = type(space)("several", tuple(pieces[:3]), space.target, None)
        return space.cut(0.1 * np.sqrt(space.area))

    whole = cells()
    monkeypatch.setattr(sifting, "BOXES_AT_A_TIME", 300)
    monkeypatch.setattr(along_borders, "PLACES_AT_A_TIME", 50)
    np.testing.assert_array_equal(cells().rows, whole.rows)
