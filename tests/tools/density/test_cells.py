"""Cells make up their pieces, lie within their radii, and bound the normals in them."""

from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.density import along_borders, sifting
from gaussmap.tools.density.cells import Cells
from gaussmap.tools.density.methods import space_on
from gaussmap.tools.density.trims import Trims

from ...shapes import central_differences

NAMES = ("torus", "wavy_graph", "ellipsoid", "cone")


def space_of(surface, on: str = "surface"):
    return space_on(gm.fit(surface, (24, 24)), surface if on == "surface" else None, None)


def places_in(cells: Cells, share: float) -> np.ndarray:
    """Return parameters (4, M, 2) on the way from the places to corners."""
    u0, v0, u1, v1 = cells.boxes.T
    corners = np.array([(u0, v0), (u1, v0), (u0, v1), (u1, v1)]).transpose(0, 2, 1)
    return cells.places + share * (corners - cells.places)


@pytest.mark.parametrize("name", NAMES)
def test_cells_make_up_the_surface(name):
    """By the rule of midpoints, whose error is a part h²/24 of fourth derivatives."""
    space = space_of(gm.surfaces.surface(name))
    for cells in (space.first, space.cut(0.1 * np.sqrt(space.area))):
        assert cells.numbers[:, 6].sum() == pytest.approx(space.area, rel=4e-3)
        boxes = cells.boxes[:, 2:] - cells.boxes[:, :2]
        assert boxes.prod(axis=1).sum() == pytest.approx(space.sizes.prod(), rel=1e-12)
    halves = space.halves(space.first)
    np.testing.assert_array_equal(halves.pieces, np.repeat(space.first.pieces, 2))


@pytest.mark.parametrize("on", ["surface", "spline"])
@pytest.mark.parametrize(
    "name", ["torus", *(pytest.param(name, marks=pytest.mark.compiled) for name in NAMES[1:])]
)
def test_no_point_of_a_cell_is_outside_of_its_radius(name, on):
    surface = gm.surfaces.surface(name)
    space = space_of(surface, on)
    (piece,) = space.pieces
    cells = space.cut(0.2 * np.sqrt(space.area))
    for share in (1.0, 0.5):
        for places in places_in(cells, share):
            points = space.scaled_points(piece.jets(*places.T.copy())[:, 0])
            lengths = np.linalg.norm(points - cells.rows[:, :3], axis=1)
            assert (lengths <= cells.radii * (1 + 1e-9) + 1e-12).all()


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid"])
def test_normals_of_a_cell_are_within_its_chord(name):
    surface = gm.surfaces.surface(name)
    space = space_of(surface)
    (piece,) = space.pieces
    cells = space.cut(0.05 * np.sqrt(space.area))
    for places in places_in(cells, 0.99):
        jets = piece.jets(*places.T.copy())
        normals = np.cross(jets[:, 1], jets[:, 2])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        chords = np.linalg.norm(normals - cells.rows[:, 3:6], axis=1)
        known = cells.chords < 2.0
        assert known.mean() > 0.9
        # Third derivatives are left out: of cells of width h, a part of h².
        size = cells.radii[known] / np.sqrt(space.area)
        assert (chords[known] <= cells.chords[known] + 10.0 * size**2).all()


@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid", "enneper"])
def test_derivatives_of_a_spline(name):
    """They are those of the points, up to differences, where one patch is."""
    spline = gm.fit(name, (7, 5))
    (piece,), frame = space_on(spline, None, None).pieces, spline.frame
    # In the southern patches, a quarter of a cell from all others.
    cells = np.random.default_rng(1).integers(0, [7, 5], (50, 2)) + np.array([0.5, 0.2])
    jets = piece.jets(*(frame[:2] + frame[2:] * cells).T.copy())

    def position(s: np.ndarray, t: np.ndarray) -> np.ndarray:
        return spline.evaluate(frame[0] + frame[2] * s, frame[1] + frame[3] * t)

    du, dv = frame[2:]
    sizes = np.array([1.0, du, dv, du * du, du * dv, dv * dv])[:, None]
    expected = central_differences(position, cells[:, 0], cells[:, 1], 0.01) / sizes
    scales = np.abs(expected).max(axis=(0, 2)) + np.abs(expected[:, 0]).max()
    assert (np.abs(jets - expected).max(axis=(0, 2)) <= 1e-9 * scales).all()


def test_cells_bound_what_the_curvature_of_a_ridge_counts():
    """Its radius of curvature, 1e-6, is far smaller than a cell: it counts as the width of that."""
    ridge = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, np.sqrt(u * u + 1e-12)], axis=-1), ((-1, 1), (0, 1))
    )
    space = space_on(gm.fit(ridge, (31, 7)), ridge, None)
    target = space.target._replace(floor=0.0, curvature_weight=1.0)
    cells = replace(space, target=target).first
    largest, bound = cells.rows[:, 6].max(), 1.0 / cells.limits**2
    assert (cells.rows[:, 6] <= bound * (1 + 1e-12)).all()
    assert largest == pytest.approx(bound[cells.rows[:, 6].argmax()])


@pytest.mark.compiled
def test_a_surface_within_a_predicate():
    torus = gm.surfaces.torus().trimmed(within=lambda u, v: u < 3)
    assert len(gm.sample(torus, 100, cells=(12, 8))) == 100


# --- trims of many pieces -------------------------------------------------------------------------

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


@pytest.mark.compiled
def test_places_are_inside_as_each_piece_says(pieces):
    """Those of whole periods away, too."""
    rng, every = np.random.default_rng(1), Trims(pieces)
    numbers, places = rng.integers(0, len(pieces), 3000), rng.uniform(-3.0, 9.0, (3000, 2))
    inside = every.contains(numbers, places)
    for k, piece in enumerate(pieces):
        here = numbers == k
        np.testing.assert_array_equal(inside[here], piece.contains(places[here]))
        assert inside[here].all() == (k == 2)


@pytest.mark.compiled
def test_cells_do_not_depend_on_blocks(pieces, monkeypatch):
    def cells():
        space = space_on(gm.fit(gm.surfaces.torus(), (16, 16)), gm.surfaces.torus(), None)
        space = type(space)("several", tuple(pieces[:3]), space.target, None)
        return space.cut(0.1 * np.sqrt(space.area))

    whole = cells()
    monkeypatch.setattr(sifting, "BOXES_AT_A_TIME", 300)
    monkeypatch.setattr(along_borders, "PLACES_AT_A_TIME", 50)
    np.testing.assert_array_equal(cells().rows, whole.rows)
