"""Surfaces that are moved, mirrored and flipped: points, derivatives, normals, ends."""

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...refusals import refused
from ...shapes import saddle

SQUARE = ((0.0, 1.0), (0.0, 1.0))


ROTATION = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
ROTATION *= np.sign(np.linalg.det(ROTATION))
MAPS = {
    "rotated": ROTATION,
    "mirrored": np.diag([1.0, -1.0, 1.0]),
    "turned and mirrored": -ROTATION,
    "scaled": 1e-9 * ROTATION,
    "sheared": np.array([[1.0, 0.5, 0.0], [0.0, 2.0, 0.25], [0.0, 0.0, 3.0]]),
    "translated": np.array([[1, 0, 0, 1e6], [0, 1, 0, -2e6], [0, 0, 1, 5.0], [0, 0, 0, 1]]),
}


def inside(surface):
    """Return places in the domain, among them the corners."""
    (u0, u1), (v0, v1) = surface.domain
    s, t = np.random.default_rng(2).random((2, 30))
    s[:4], t[:4] = (0, 0, 1, 1), (0, 1, 0, 1)
    return u0 + (u1 - u0) * s, v0 + (v1 - v0) * t


def moved_jets(jets, matrix, shift):
    return jets @ matrix.T + np.eye(6)[:, :1] * shift


TURNED = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])[:, None]  # signs of derivatives


@covering(
    matrix=MAPS.values(),
    surface=[
        gm.surfaces.torus(),
        gm.Surface.from_sympy(("u*cos(v)", "u*sin(v)", "v**2"), "uv", SQUARE),
        gm.Surface.from_callable(saddle, SQUARE),
    ],
)
def test_transformed(surface, matrix):
    linear, shift = matrix[:3, :3], matrix[:3, 3] if len(matrix) == 4 else np.zeros(3)
    moved = surface.transformed(matrix)
    turned = np.linalg.det(linear) < 0.0
    u, v = inside(surface)
    own = surface.domain[0][0] + surface.domain[0][1] - u if turned else u
    expected = moved_jets(surface.derivatives(own, v), linear, shift)
    expected *= TURNED if turned else 1.0
    size = np.abs(expected).max()
    rounding = 1e-8 if surface.function is saddle else 1e-15  # own is u after rounding
    np.testing.assert_allclose(moved.derivatives(u, v), expected, rtol=0, atol=4 * rounding * size)
    np.testing.assert_allclose(moved.evaluate(u, v), expected[:, 0], rtol=0, atol=4e-15 * size)
    assert (moved.name, moved.domain, moved.boundary) == (
        surface.name,
        surface.domain,
        surface.boundary,
    )


@pytest.mark.parametrize("name", gm.surfaces.names())
def test_mirrored_surfaces_of_the_catalogue(name):
    """The ends, mirrored ones and poles too, are as before; normals are on the same side."""
    surface = gm.surfaces.surface(name)
    mirrored = surface.transformed(np.diag([-1.0, 1.0, 1.0]))
    u, v = inside(surface)
    own = sum(surface.domain[0]) - u
    assert np.allclose(mirrored.evaluate(u, v), surface.evaluate(own, v) * (-1, 1, 1), atol=1e-14)
    assert gm.fit(mirrored, (8, 8)).boundary == surface.boundary  # which checks the ends
    again = mirrored.transformed(np.diag([-1.0, 1.0, 1.0]))
    assert (again.evaluate(u, v) == surface.evaluate(u, v)).all()


def normals(surface, u, v):
    normal = np.cross(*np.moveaxis(surface.derivatives(u, v)[..., 1:3, :], -2, 0))
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def test_normals_stay_on_the_same_side():
    sphere = gm.surfaces.sphere()
    u, v = np.random.default_rng(0).uniform(-1, 1, (2, 20))
    for matrix in MAPS.values():
        moved = sphere.transformed(matrix)
        centre = matrix[:3, 3] if len(matrix) == 4 else 0.0
        spokes = moved.evaluate(u, v) - centre
        assert (np.sum(spokes * normals(moved, u, v), axis=-1) > 0.0).all()
        assert (np.sum(spokes * normals(moved.flipped(), -u, v), axis=-1) < 0.0).all()


@pytest.mark.parametrize(
    "periodic", [(False, False), (True, True), ("mirrored", False), (True, "mirrored")]
)
def test_points_are_transformed(periodic):
    points = np.random.default_rng(3).normal(size=(5, 6, 3)) + 3.0 * np.indices((5, 6, 1))[0]
    surface = gm.Surface.from_grid(points, periodic=periodic)
    u, v = inside(surface)
    for name, matrix in MAPS.items():
        if name == "translated":
            continue
        moved = surface.transformed(matrix)
        turned = np.linalg.det(matrix) < 0.0
        own = sum(surface.domain[0]) - u if turned else u
        expected = surface.evaluate(own, v) @ matrix.T
        np.testing.assert_allclose(
            moved.evaluate(u, v), expected, rtol=0, atol=1e-14 * np.abs(expected).max()
        )
        assert np.array_equal(gm.fit(moved).evaluate(u, v), moved.evaluate(u, v))
    again, first = surface.flipped().flipped().grid, surface.grid
    assert again is not None
    assert first is not None
    assert np.array_equal(again, first)


def polar(r, phi):
    return np.stack([r * np.cos(phi), r * np.sin(phi), r**2 / 4 + 0 * phi], axis=-1)


def test_poles_at_an_end_of_u():
    domain = ((0.0, 1.0), (0.0, 2 * np.pi))
    exact = gm.Surface.from_sympy(("u*cos(v)", "u*sin(v)", "u**2 / 4"), "uv", domain)
    bowl = gm.Surface.from_callable(polar, domain, (("pole", "open"), True))
    u, v = inside(bowl)
    u[5:9] = 0.0, 1e-3, 0.01, 0.99  # differences go through the pole
    np.testing.assert_allclose(bowl.jets(u, v), exact.jets(u, v), rtol=0, atol=1e-9)
    flipped = bowl.flipped()
    assert flipped.boundary == (("open", "pole"), ("periodic", "periodic"))
    expected = bowl.jets(1.0 - u, v) * TURNED
    np.testing.assert_allclose(flipped.jets(u, v), expected, rtol=0, atol=1e-9)
    assert gm.fit(flipped, (8, 8)).boundary == flipped.boundary


def test_trims_are_reversed():
    loop = np.array([(1.0, 1.0), (2.0, 1.0), (1.0, 3.0)])
    window = gm.surfaces.torus().trimmed([loop], within=lambda u, v: u > 1.25)
    uv = np.random.default_rng(0).uniform(0.0, 4.0, (200, 2))
    turned = (2 * np.pi - uv[:, 0])[:, None] * (1, 0) + uv * (0, 1)
    mirrored = window.transformed(np.diag([1.0, 1.0, -1.0]))
    trims = [x.trim for x in (window, mirrored, mirrored.flipped())]
    before, after, again = (x for x in trims if x is not None)
    assert 0 < before.contains(uv).sum() < 200
    assert np.array_equal(after.contains(turned), before.contains(uv))
    assert again.parts == before.parts
    assert window.transformed(ROTATION).trim is before
    loops = gm.surfaces.torus().trimmed([loop])
    mine, its = (
        x.trim.cells_of_border(loops.domain, (16, 8))[0]
        for x in (loops, loops.flipped())
        if x.trim is not None
    )
    assert np.array_equal(mine, its[::-1])


def test_pieces_of_a_moved_surface():
    roof = [[[0, 0, 0], [0, 5, 0]], [[2, 0, 1], [2, 5, 1]], [[5, 0, 0], [5, 5, 0]]]
    whole = gm.Surface.from_nurbs((1, 1), ([0, 0, 1, 3, 3], [0, 0, 1, 1]), roof)
    flipped = whole.flipped()
    assert [x.domain[0] for x in whole.pieces()] == [(0.0, 1.0), (1.0, 3.0)]
    assert [x.domain[0] for x in flipped.pieces()] == [(0.0, 2.0), (2.0, 3.0)]
    for surface in (flipped, whole.transformed(MAPS["sheared"])):
        for piece in surface.pieces():
            u, v = inside(piece)
            np.testing.assert_allclose(
                piece.evaluate(u, v), surface.evaluate(u, v), rtol=0, atol=1e-14
            )
    names = [x.name for x in flipped.flipped().transformed(ROTATION).pieces()]
    assert names == [x.name for x in whole.pieces()]
    smooth = gm.surfaces.torus().flipped()
    assert smooth.pieces() == (smooth,)


def test_missing_points_are_missing_after_a_map():
    heights = np.random.default_rng(5).random((9, 10))
    heights[2, 3] = np.nan
    hill = gm.Surface.from_grid(heights, spacing=(1.0, 1.0))
    uv = np.random.default_rng(0).uniform(0.0, 8.0, (100, 2))
    for matrix in (ROTATION, -ROTATION):
        moved = hill.transformed(matrix)
        own = np.where([matrix is ROTATION, True], uv, 9.0 - uv)
        there = hill.trim.contains(own)
        assert 0 < there.sum() < 100
        assert np.array_equal(moved.trim.contains(uv), there)
        np.testing.assert_allclose(
            moved.evaluate(*uv[there].T),
            hill.evaluate(*own[there].T) @ matrix.T,
            rtol=0,
            atol=1e-13,
        )


@pytest.mark.parametrize(
    ("matrix", "complaint"),
    [
        (np.eye(2), r"matrix must have the shape \(3, 3\) or \(4, 4\), not \(2, 2\)"),
        (np.eye(4)[:3], r"not \(3, 4\)"),
        (3.0, r"not \(\)"),
        ("abc", "matrix must be an array of real numbers"),
        (np.diag([1.0, np.nan, 1.0]), "matrix holds NaN or infinity"),
        (np.diag([1.0, 1.0, 0.0]), "matrix is singular"),
        (np.zeros((3, 3)), "matrix is singular"),
        (np.arange(9.0).reshape(3, 3), "matrix is singular"),
        (np.diag([1.0, 1.0, 1.0, 2.0]), "last row of matrix"),
    ],
)
def test_matrices_that_are_no_affine_maps(matrix, complaint):
    refused(complaint, gm.surfaces.torus().transformed, matrix)


def test_errors_of_a_moved_callable():
    half = gm.Surface.from_callable(
        lambda u, v: saddle(np.where(u < 0.5, u, np.nan), v), SQUARE, name="half"
    )
    with pytest.raises(gm.errors.SurfaceError, match=r"'half' is not finite at u = 0[.]25"):
        half.flipped().evaluate(0.25, 0.0)
