"""Surfaces of points and elevations: they are what their points came from, end to end."""

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused
from ...shapes import klein_bottle, unit

POINTS = np.random.default_rng(7).random((5, 6, 3))
HEIGHTS = np.random.default_rng(8).random((5, 6))


@pytest.fixture
def rng():
    return np.random.default_rng(9)


def order(errors):
    """Return the mean order of convergence over grids that are refined by 2."""
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))


# --- closed surfaces: f on [0,1]², what is periodic, the cells of a coarse grid -------------------


def over_square(surface):
    """Return a surface as a function of parameters from 0 to 1."""
    low, size = np.array(surface.domain)[:, 0], np.ptp(surface.domain, axis=1)
    return lambda u, v: surface.evaluate(low[0] + size[0] * u, low[1] + size[1] * v)


torus, tube, moebius, klein, ball = map(over_square, (
    gm.surfaces.torus(), gm.surfaces.hyperboloid(), gm.surfaces.moebius_band(), klein_bottle(),
    gm.surfaces.ellipsoid(b=0.8, c=1.0),
))  # fmt: skip


def cap(u, v):
    return ball(u, 0.4 + 0.6 * v)


def swapped(f):
    return lambda u, v: f(v, u)


CLOSED = {
    "torus": (torus, (True, True), (12, 8)),
    "tube": (tube, (True, False), (12, 5)),
    "tube_swapped": (swapped(tube), (False, True), (5, 12)),
    "moebius": (moebius, ("mirrored", False), (12, 5)),
    "moebius_swapped": (swapped(moebius), (False, "mirrored"), (5, 12)),
    "klein": (klein, ("mirrored", True), (14, 11)),
    "klein_swapped": (swapped(klein), (True, "mirrored"), (11, 14)),
    "ball": (ball, (True, "pole"), (12, 7)),
    "cap": (cap, (True, ("open", "pole")), (12, 7)),
}


def grid_of(f, periodic, cells):
    """Return the points of a grid with so many cells: a periodic direction has no last row."""
    u, v = (
        np.arange(count + (kind not in (True, "mirrored"))) / count
        for count, kind in zip(cells, periodic, strict=True)
    )
    return f(u[:, None], v)


@pytest.mark.parametrize("name", CLOSED)
def test_points_and_normals_converge(name, rng):
    f, periodic, coarsest = CLOSED[name]
    u, v = rng.random((2, 400))
    if name in ("ball", "cap"):
        v = 0.1 + 0.8 * v  # at the poles there is no normal
    step = 1e-6
    across = unit(np.cross(f(u + step, v) - f(u - step, v), f(u, v + step) - f(u, v - step)))
    position_errors, normal_errors = [], []
    for factor in (2, 4, 8):
        cells = coarsest[0] * factor, coarsest[1] * factor
        surface = gm.Surface.from_grid(grid_of(f, periodic, cells), periodic=periodic)
        assert surface.domain == ((0.0, cells[0]), (0.0, cells[1]))
        spline = gm.fit(surface)
        assert spline.cells == cells
        places = u * cells[0], v * cells[1]
        assert (spline.evaluate(*places) == surface.evaluate(*places)).all()
        position_errors.append(np.abs(spline.evaluate(*places) - f(u, v)).max())
        normal_errors.append(np.abs(spline.normals(*places) - across).max())
    assert 2.6 < order(position_errors) < 4.2
    assert 1.8 < order(normal_errors) < 3.2
    assert position_errors[-1] < 2e-4
    assert normal_errors[-1] < 1e-2


@pytest.mark.parametrize("name", CLOSED)
def test_grid_and_callable_agree(name):
    """Two functionals that are exact on quadratics, on every patch, at all seams and poles too."""
    f, periodic, coarsest = CLOSED[name]
    cells = coarsest[0] * 4, coarsest[1] * 4
    of_grid = gm.fit(gm.Surface.from_grid(grid_of(f, periodic, cells), periodic=periodic))
    of_callable = gm.fit(gm.Surface.from_callable(f, ((0, 1), (0, 1)), periodic), cells)
    difference = np.abs(of_grid.control_nets - of_callable.control_nets).max()
    assert difference < 2e-2 * np.abs(np.diff(of_callable.coefficients, axis=0)).max()


def test_smallest_grids(rng):
    for periodic, shape in [
        ((False, False), (4, 4)),
        ((True, False), (3, 4)),
        ((False, True), (4, 3)),
        ((True, True), (3, 3)),
        (("mirrored", False), (3, 4)),
    ]:
        surface = gm.Surface.from_grid(rng.random((*shape, 3)), periodic=periodic)
        assert gm.fit(surface).cells == (3, 3)
    pole = np.concatenate([np.zeros((4, 1, 3)), rng.random((4, 3, 3))], axis=1)
    surface = gm.Surface.from_grid(pole, periodic=(True, ("pole", "open")))
    assert gm.fit(surface).cells == (4, 3)


# --- elevations -----------------------------------------------------------------------------------


def hills(x, y):
    """Return elevations that tell x from y."""
    return 0.3 * np.sin(2.0 * x) * np.cos(y) + 0.1 * x * x - 0.2 * y


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_elevations_are_a_map(sign, rng):
    """Rows along y, columns along x, different counts and spacings."""
    at_x, at_y = 3.0 * rng.random(3000), sign * 2.0 * rng.random(3000)
    errors, slopes = [], []
    for refinement in (1, 2, 4):
        rows, columns = 24 * refinement + 1, 40 * refinement + 1
        dx, dy = 3.0 / (columns - 1), sign * 2.0 / (rows - 1)
        x, y = dx * np.arange(columns), dy * np.arange(rows)
        surface = gm.Surface.from_grid(hills(x, y[:, None]), spacing=(dx, dy))
        np.testing.assert_allclose(surface.domain, [[0, 3], [min(0, 2 * sign), max(0, 2 * sign)]])
        spline = gm.fit(surface)
        assert spline.cells == (columns - 1, rows - 1)
        points, normals = spline.evaluate(at_x, at_y), spline.normals(at_x, at_y)
        np.testing.assert_allclose(points[:, 0], at_x, rtol=0, atol=1e-14)
        np.testing.assert_allclose(points[:, 1], at_y, rtol=0, atol=1e-14)
        errors.append(np.abs(points[:, 2] - hills(at_x, at_y)).max())
        step = 1e-6
        slope_x = (hills(at_x + step, at_y) - hills(at_x - step, at_y)) / (2 * step)
        slope_y = (hills(at_x, at_y + step) - hills(at_x, at_y - step)) / (2 * step)
        assert (normals[:, 2] > 0.0).all()
        found = normals[:, :2] / normals[:, 2:]
        slopes.append(np.abs(found + np.stack([slope_x, slope_y], axis=1)).max())
    assert 2.6 < order(errors) < 4.0
    assert 1.7 < order(slopes) < 2.5
    assert errors[-1] < 5e-6


# --- what may be brought --------------------------------------------------------------------------


def test_the_surface_keeps_its_points():
    points = POINTS.copy()
    surface = gm.Surface.from_grid(points)
    before = gm.fit(surface).coefficients.copy()
    points[...] = 0.0
    np.testing.assert_array_equal(gm.fit(surface).coefficients, before)


# --- what is refused ------------------------------------------------------------------------------


def with_values(points, value, *places):
    points = points.copy()
    for place in places:
        points[place] = value
    return points


MAP = {"spacing": (1.0, 1.0)}
NOTHING = np.full((9, 9), np.nan)
BALL = grid_of(ball, (True, "pole"), (12, 7))
OTHER_SHAPE = r"must have the shape \(m, n, 3\), or \(m, n\) for elevations, not \("
REFUSED = [
    *((np.zeros((*shape, 3)), {"periodic": periodic}, f"grid has {complaint}")
      for shape, periodic, complaint in (
        ((3, 6), (False, False), "3 x 6 points; it needs at least 4 along axis 0"),
        ((6, 3), (False, False), "6 x 3 points; it needs at least 4 along axis 1"),
        ((2, 6), (True, False), "2 x 6 points; it needs at least 3 along axis 0"),
        ((6, 2), (False, "mirrored"), "6 x 2 points; it needs at least 3 along axis 1"),
        ((0, 0), (False, False), "0 x 0 points"),
        ((1, 1), (True, True), "1 x 1 points"),
    )),
    *((np.zeros(x), {}, OTHER_SHAPE) for x in ((), (5,), (5, 6, 2), (5, 6, 4), (5, 5, 5, 3))),
    *((points, named, "a grid must be an array of real numbers")
      for points in (POINTS + 0j, None, "terrain") for named in ({}, MAP)),
    *((with_values(POINTS, x, (3, 4, 1), (4, 0, 2)), {},
       r"grid holds 2 points with infinity, the first at \[3, 4\]") for x in (np.inf, -np.inf)),
    *((with_values(HEIGHTS, x, (1, 4)), {"spacing": (1.0, y)},
       r"holds 1 points with infinity, the first at \[1, 4\]")
      for x in (np.inf, -np.inf) for y in (2.0, -2.0)),
    (NOTHING, MAP, "all points of grid are missing"),
    (np.full((9, 9, 3), -1.0), {"nodata": -1}, "all points of grid are missing"),
    (with_values(NOTHING, 1.0, (4, 4)), MAP, "80 of the 81 points of grid are missing"),
    (POINTS, {"nodata": "none"}, "nodata must be a number, not 'none'"),
    *((HEIGHTS, {"spacing": x}, r"elevations \(m, n\) need a spacing of two numbers")
      for x in (None, (1, 2, 3), ("a", 1), (10**400, 1))),
    *((HEIGHTS, {"spacing": x}, "spacing must be finite and the map too, dx > 0 and dy not 0")
      for x in ((0, 1), (1, 0), (-1, 1), (np.nan, 1), (1, np.nan), (np.inf, 1), (1e308, 1))),
    (POINTS, MAP, "spacing is for elevations"),
    *((HEIGHTS, MAP | {"periodic": x}, "cannot be periodic")
      for x in ((True, False), (False, "mirrored"), (True, "pole"))),
    *((points, {"periodic": ends}, rf"has no pole at points\[{side}\]")
      for points, ends, side in (
        (BALL[:, 1:], (True, "pole"), ":, 0"), (BALL[:, :-1], (True, "pole"), ":, -1"),
        (BALL.swapaxes(0, 1)[1:], ("pole", True), "0"),
    )),
    # The corner (0, n) of such a surface is a point of its own, and not in the grid.
    (POINTS, {"periodic": ("mirrored", "mirrored")}, "cannot be mirrored along both axes"),
]  # fmt: skip


@pytest.mark.parametrize(("points", "named", "complaint"), REFUSED)
def test_what_is_no_grid_is_refused(points, named, complaint):
    refused(complaint, gm.Surface.from_grid, points, **named)


@pytest.mark.parametrize(
    "periodic", [(False, False), (True, True), ("mirrored", False), (True, "pole")]
)
def test_points_too_large_to_compute_with(periodic):
    with pytest.raises(gm.errors.SurfaceError, match="coordinates of 'grid' are too large"):
        gm.Surface.from_grid(1.7e308 * (2 * POINTS[:4] - 1), periodic=periodic)


@pytest.mark.parametrize(("part", "repeats"), [(0.5e-3, True), (2e-3, False)])
def test_first_points_nearly_repeated_at_the_end(part, repeats):
    """They are one if their distance is a thousandth of that of two rows."""
    angles = np.linspace(0.0, 2.0 * np.pi, 13)
    angles[-1] -= part * angles[1]
    rings = np.stack([np.cos(angles), np.sin(angles)], axis=-1)[:, None]
    points = np.concatenate([rings + np.zeros((1, 5, 1)), np.ones((13, 1, 1)) * np.c_[:5][None]], 2)
    if repeats:
        message = "repeats its first points at the end of axis 0"
        refused(message, gm.Surface.from_grid, points, periodic=(True, False))
    else:
        assert gm.Surface.from_grid(points, periodic=(True, False)).grid is not None


@pytest.mark.parametrize("name", ["torus", "tube", "tube_swapped", "moebius", "moebius_swapped"])
def test_first_points_repeated_at_the_end(name):
    f, periodic, cells = CLOSED[name]
    repeated = f(np.linspace(0, 1, cells[0] + 1)[:, None], np.linspace(0, 1, cells[1] + 1))
    message = "repeats its first points at the end of axis [01], .*leave them out"
    refused(message, gm.Surface.from_grid, repeated, periodic=periodic)
