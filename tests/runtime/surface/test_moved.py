"""Surfaces that are moved, mirrored and flipped: points, derivatives, normals, ends."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...refusals import refused
from ...shapes import SQUARE, random_rotation, saddle

ROTATION = random_rotation(1)
MAPS = {
    "rotated": ROTATION,
    "mirrored": np.diag([1.0, -1.0, 1.0]),
    "mirrored along x": np.diag([-1.0, 1.0, 1.0]),
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


TURNED = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])[:, None]  # signs of derivatives
ENDS: list[Any] = [(False, False), (True, True), ("mirrored", False), (True, "mirrored")]
POINTS = np.random.default_rng(3).normal(size=(5, 6, 3)) + 3.0 * np.indices((5, 6, 1))[0]
HEIGHTS = np.random.default_rng(5).random((9, 10))
HEIGHTS[2, 3] = np.nan
MOVED = {
    **{name: gm.surfaces.surface(name) for name in gm.surfaces.names()},
    "sympy": gm.Surface.from_sympy(("u*cos(v)", "u*sin(v)", "v**2"), "uv", SQUARE),
    "callable": gm.Surface.from_callable(saddle, SQUARE),
    **{f"grid, {ends}": gm.Surface.from_grid(POINTS, periodic=ends) for ends in ENDS},
    "hill": gm.Surface.from_grid(HEIGHTS, spacing=(1.0, 1.0)),
}


@covering(name=MOVED, matrix=MAPS.values())
def test_transformed(name, matrix):
    """Points, derivatives, ends, and what is missing: all is as before the map."""
    surface, moved = MOVED[name], MOVED[name].transformed(matrix)
    linear, shift = matrix[:3, :3], matrix[:3, 3] if len(matrix) == 4 else np.zeros(3)
    turned = np.linalg.det(linear) < 0.0
    u, v = inside(surface)
    own = sum(surface.domain[0]) - u if turned else u
    if surface.trim is not None:
        there = surface.trim.contains(np.stack([own, v], axis=1))
        assert 0 < there.sum() < len(there)
        assert np.array_equal(moved.trim.contains(np.stack([u, v], axis=1)), there)
        u, v, own = u[there], v[there], own[there]
    expected = surface.evaluate(own, v) @ linear.T + shift
    size = np.abs(expected).max()
    np.testing.assert_allclose(moved.evaluate(u, v), expected, rtol=0, atol=1e-14 * size)
    assert (moved.name, moved.domain) == (surface.name, surface.domain)
    assert moved.boundary == surface.boundary
    assert gm.fit(moved, (8, 8)).boundary == gm.fit(surface, (8, 8)).boundary  # checks the ends
    again = surface.flipped().flipped()
    if surface.grid is not None:
        assert np.array_equal(gm.fit(moved).evaluate(u, v), moved.evaluate(u, v))
        before, after = surface.grid, again.grid
        assert name == "hill" or (after == before).all()  # its gaps are filled
        return
    assert (again.evaluate(u, v) == surface.evaluate(u, v)).all()
    jets = surface.derivatives(own, v) @ linear.T + np.eye(6)[:, :1] * shift
    jets *= TURNED if turned else 1.0
    size = np.abs(jets).max()
    rounding = 1e-8 if name == "callable" else 1e-15  # own is u after rounding
    np.testing.assert_allclose(moved.derivatives(u, v), jets, rtol=0, atol=4 * rounding * size)


def test_normals_stay_on_the_same_side():
    sphere = gm.surfaces.sphere()
    u, v = np.random.default_rng(0).uniform(-1, 1, (2, 20))
    for matrix in MAPS.values():
        moved = sphere.transformed(matrix)
        centre = matrix[:3, 3] if len(matrix) == 4 else 0.0
        spokes = moved.evaluate(u, v) - centre
        assert (np.sum(spokes * moved.normals(u, v), axis=-1) > 0.0).all()
        assert (np.sum(spokes * moved.flipped().normals(-u, v), axis=-1) < 0.0).all()


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
