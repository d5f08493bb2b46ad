"""The spline: exact on quadratics, C¹ over every edge and seam, closed at poles."""

import math
from fractions import Fraction

import gaussmap as gm
import numpy as np
import pytest

from ...nets import bezier
from ...products import covering
from ...refusals import refused
from ...shapes import SQUARE, TORUS, klein_bottle

# The corners u = 1 and v = 1 of the triangles south, east, north, west of a cell, from its centre.
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) / 2


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def cube(u, v):
    """Return a surface that is neither quadratic nor symmetric."""
    return np.stack([u + 0.2 * v**3, v - 0.3 * u * u * v, u**3 - u * v * v + 0.1 * v], axis=-1)


CUBE = gm.Surface.from_callable(cube, SQUARE, name="cube")
NAMES = ["torus", "sphere", "moebius_band", "catenoid", "wavy_graph", "cube", "klein", "grid"]


def made(name):
    if name == "cube":
        return CUBE
    if name == "klein":
        return klein_bottle()
    if name == "grid":
        points = np.random.default_rng(0).random((7, 6, 3))
        return gm.Surface.from_grid(points, periodic=(False, True))
    return gm.surfaces.surface(name)


# --- exactness ------------------------------------------------------------------------------------


@covering(
    cells=[(3, 3), (3, 8), (8, 3), (5, 7), (16, 16)], domain=[SQUARE, ((-2.0, 5.0), (10.0, 10.5))]
)
def test_quadratics_are_reproduced_up_to_the_border(cells, domain, rng):
    weights = rng.standard_normal((6, 3))

    def quadratic(u, v):
        return np.stack([u * u, u * v, v * v, u, v, np.ones_like(u)], axis=-1) @ weights

    spline = gm.fit(gm.Surface.from_callable(quadratic, domain), cells)
    (u0, u1), (v0, v1) = domain
    u = u0 + (u1 - u0) * np.append(rng.random(500), [0, 0, 1, 1, 0.3, 0, 1])
    v = v0 + (v1 - v0) * np.append(rng.random(500), [0, 1, 0, 1, 0, 0.3, 1])
    expected = quadratic(u, v)
    size = np.abs(spline.coefficients).max()
    np.testing.assert_allclose(spline.evaluate(u, v), expected, rtol=0, atol=4e-15 * size)


def rough(u, v):
    """Return whole numbers without any pattern: the formulas below are exact on them."""
    angles = np.stack([37 * u + 91 * v, 55 * u - 23 * v, 71 * u * v + 13 * u + 7 * v], axis=-1)
    return np.round(99 * np.sin(10 * angles + 1))


def exactly(points):
    return [[Fraction(x) for x in point] for point in points.reshape(-1, 3)]


@pytest.mark.parametrize("cells", [(4, 8), (8, 4)])
def test_coefficients_in_rational_numbers(cells):
    """Inside, μ = 2 f(centre) − ¼ Σ f(vertices), without any rounding."""
    m, n = cells
    spline = gm.fit(gm.Surface.from_callable(rough, SQUARE), cells)
    i, j = (x.ravel() for x in np.indices((m, n)))
    centres = exactly(rough((i + 0.5) / m, (j + 0.5) / n))
    vertices = [exactly(rough((i + a) / m, (j + b) / n)) for a in (0, 1) for b in (0, 1)]
    for k, mu in enumerate(exactly(spline.coefficients[1:-1, 1:-1])):
        around = [corner[k] for corner in vertices]
        for x in range(3):
            assert mu[x] == 2 * centres[k][x] - sum(point[x] for point in around) / 4


@pytest.mark.parametrize("cells", [(4, 8), (8, 4)])
def test_open_borders_in_rational_numbers(cells):
    """The border is the univariate quasi-interpolant of the border, and the corners are met."""
    m, n = cells
    spline = gm.fit(gm.Surface.from_callable(rough, SQUARE), cells)
    nets = spline.control_nets.reshape(m, n, 4, 6, 3)
    for turn, edge in enumerate(
        ([(k / m, 0) for k in range(2 * m)], [(1, k / n) for k in range(2 * n)],
         [(k / m, 1) for k in range(2 * m)], [(0, k / n) for k in range(2 * n)])
    ):  # fmt: skip
        row = [nets[:, 0, 0], nets[-1, :, 1], nets[:, -1, 2], nets[0, :, 3]][turn]
        middles = exactly(row[:, 3])
        for k, middle in enumerate(middles):
            step_ = np.array(edge[1]) - np.array(edge[0])
            start = np.array(edge[0]) + k * step_
            ends = exactly(np.stack([rough(*start), rough(*(start + step_))]))
            (centre,) = exactly(rough(*(start + step_ / 2)))
            for x in range(3):
                assert middle[x] == 2 * centre[x] - (ends[0][x] + ends[1][x]) / 2
    for u in (0, 1):
        for v in (0, 1):
            assert (spline.evaluate(u, v) == rough(np.float64(u), np.float64(v))).all()


# --- smoothness -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["torus", "moebius_band", "klein", "swapped"])
def test_seams_of_coefficients_are_bitwise_equal(name):
    """Equal coefficients make the spline C¹ across a seam."""
    band = gm.surfaces.moebius_band()
    surface = made(name) if name != "swapped" else gm.Surface.from_callable(
        lambda u, v: band.evaluate(v, u), band.domain[::-1], (False, "mirrored")
    )  # fmt: skip
    spline = gm.fit(surface, (6, 5))
    for axis, (kind, _) in enumerate(surface.boundary):
        rows, turn = np.swapaxes(spline.coefficients, 0, axis), -1 if kind == "mirrored" else 1
        assert kind == "open" or (rows[0] == rows[-2, ::turn]).all()
        assert kind == "open" or (rows[-1] == rows[1, ::turn]).all()


# --- reading --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_control_nets_and_evaluate_agree(name, rng):
    spline = gm.fit(made(name), None if name == "grid" else (6, 5))
    m, n = spline.cells
    assert spline.patches == 4 * m * n == len(spline.control_nets)
    patch = rng.integers(0, spline.patches, 400)
    weights = rng.dirichlet([1.0, 1.0, 1.0], 400)
    cell, turn = np.divmod(patch, 4)
    place = np.stack(np.divmod(cell, n), axis=-1) + 0.5
    place += weights[:, :1] * CORNERS[turn] + weights[:, 1:2] * CORNERS[turn + 1]
    u0, v0, du, dv = spline.frame
    u, v = u0 + du * place[:, 0], v0 + dv * place[:, 1]
    points, x_u, x_v = bezier(spline.control_nets[patch], weights)
    size = np.abs(spline.coefficients).max()
    np.testing.assert_allclose(spline.evaluate(u, v), points, rtol=0, atol=8e-15 * size)
    normals = np.cross(x_u, x_v)
    lengths = np.linalg.norm(normals, axis=1)
    regular = lengths > 0.01 * np.median(lengths)
    assert regular.sum() > 350
    expected = normals[regular] / lengths[regular, None]
    found = spline.normals(u, v)[regular]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, rtol=0, atol=3e-16)


def test_frame_and_cells():
    spline = gm.fit(gm.Surface.from_callable(cube, ((-1, 5), (10, 12))), (3, 8))
    assert spline.cells == (3, 8)
    assert spline.patches == 96
    assert spline.frame.tolist() == [-1.0, 10.0, 2.0, 0.25]
    assert gm.fit(CUBE).cells == (64, 64)


@pytest.mark.parametrize("turns", [-3, -1, 1, 2, 1000])
@pytest.mark.parametrize("name", ["torus", "moebius_band"])
def test_parameters_wrap(name, turns, rng):
    spline = gm.fit(name, (8, 7))
    (u0, u1), (v0, v1) = spline.domain
    u, v = rng.uniform(u0, u1, 100), rng.uniform(v0, v1, 100)
    beyond, near = u + (u1 - u0) * turns, {"rtol": 0, "atol": 1e-13 * abs(turns)}
    if name == "torus":
        expected, period = spline.evaluate(u, v), 2 * np.pi * turns
        for places in ((beyond, v), (u, v + period), (2 * u - beyond, v + period)):
            np.testing.assert_allclose(spline.evaluate(*places), expected, **near)
    else:
        own = (-1) ** turns * v
        np.testing.assert_allclose(spline.evaluate(beyond, v), spline.evaluate(u, own), **near)
        cosines = (spline.normals(beyond, v) * spline.normals(u, own)).sum(axis=1)
        np.testing.assert_allclose(np.abs(cosines), 1.0)


def test_outside_an_open_domain():
    spline = gm.fit(CUBE, (5, 5))
    for u, v, name in (
        (1.001, 0.5, "u"),
        (0.5, -0.001, "v"),
        (np.nan, 0.5, "u"),
        (0.5, np.inf, "v"),
    ):
        complaint = rf"^{name} = .* lies outside the domain \(0.0, 1.0\) of 'cube'\.$"
        for read_ in (spline.evaluate, spline.normals):
            refused(complaint, read_, [0.5, u], [0.5, v])
    spline.evaluate([0.0, 1.0], [1.0, 0.0])
    refused("u = inf lies outside", gm.fit(TORUS, (5, 5)).evaluate, np.inf, 0.0)


# --- size and place -------------------------------------------------------------------------------


def test_normals_of_a_surface_that_is_nearly_a_curve():
    thin = gm.Surface(
        "thin", lambda u, v: TORUS.evaluate(u, v) * [1.0, 1.0, 1e-200], TORUS.domain, TORUS.boundary
    )
    normals = gm.fit(thin, (8, 7)).normals(0.3, np.linspace(0, 6, 20))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-15)


# --- area ---------------------------------------------------------------------------------------


@pytest.mark.compiled
@pytest.mark.parametrize(
    ("name", "area"),
    [("torus", 4 * math.pi**2 * 0.35), ("sphere", 4 * math.pi), ("cylinder", 4 * math.pi),
     ("cone", math.pi * 1.5 * math.hypot(0.5, 1.0)), ("plane", 4.0),
     ("catenoid", math.pi * (2 + math.sinh(2)))],
)  # fmt: skip
def test_areas(name, area):
    spline = gm.fit(gm.surfaces.surface(name), (48, 48))
    inner = spline.coefficients[1:-1, 1:-1].reshape(-1, 3)
    diagonal = np.linalg.norm(np.ptp(inner, axis=0))
    assert spline.measure[0].sum() * diagonal**2 == pytest.approx(area, rel=1e-3)
    assert (spline.measure[0] >= 0).all()


# --- arguments of fit -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "cells", [(4, 5), [4, 5], np.array([4, 5]), (np.int8(4), np.uint64(5)), iter((4, 5))]
)
def test_cells(cells):
    assert gm.fit(CUBE, cells).cells == (4, 5)


@pytest.mark.parametrize(
    ("cells", "complaint"),
    [
        ((2, 3), "at least 3 x 3 cells are needed, not 2 x 3"),
        ((3, 2), "at least 3 x 3 cells are needed, not 3 x 2"),
        ((10**5, 10**5), "at most 1,000,000,000 cells are possible, not 100,000 x 100,000"),
        ((5, -5), r"cells\[1\] must be a whole number"),
        ({"u": 5, "v": 5}, r"cells\[0\] must be a whole number"),
        (5, "cells must be a pair of whole numbers"),
        ((5, 5, 5), "cells must be a pair of whole numbers"),
    ],
)
def test_cells_that_are_none(cells, complaint):
    for call in (gm.fit, lambda surface, cells: gm.sample(surface, count=5, cells=cells)):
        refused(complaint, call, CUBE, cells)


@pytest.mark.parametrize("domain", [((0, 5e-324), (0, 1)), ((1, 1 + 2**-50), (0, 1))])
def test_domains_too_narrow_for_the_cells(domain):
    with pytest.raises(gm.errors.InputError, match="domain of u is too narrow for 8 cells"):
        gm.fit(gm.Surface.from_callable(cube, domain), (8, 8))


@pytest.mark.parametrize("domain", [((0, 1e-300), (0, 1)), ((1, 1 + 2**-40), (-1e300, 1e300))])
def test_domains_of_odd_sizes(domain):
    (u0, u1), (v0, v1) = domain
    surface = gm.Surface.from_callable(
        lambda u, v: cube((u - u0) / (u1 - u0), (v - v0) / (v1 - v0)), domain
    )
    plain, odd = gm.fit(CUBE, (8, 8)), gm.fit(surface, (8, 8))
    np.testing.assert_allclose(odd.coefficients, plain.coefficients, rtol=0, atol=1e-10)
    at_u, at_v = u0 + 0.3125 * (u1 - u0), v0 + 0.4375 * (v1 - v0)
    np.testing.assert_allclose(
        odd.evaluate(at_u, at_v), plain.evaluate(0.3125, 0.4375), rtol=0, atol=1e-10
    )
