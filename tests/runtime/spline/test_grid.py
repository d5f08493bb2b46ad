"""Surfaces of points and elevations: they are what their points came from, end to end."""

import gaussmap as gm
import numpy as np
import pytest

from ...refusals import refused as is_refused

POINTS = np.random.default_rng(7).random((5, 6, 3))
HEIGHTS = np.random.default_rng(8).random((5, 6))


@pytest.fixture
def rng():
    return np.random.default_rng(9)


def refused(complaint, *arguments, **named):
    """Check that from_grid raises InputError with one line that matches `complaint`."""
    is_refused(complaint, gm.Surface.from_grid, *arguments, **named)


def order(errors):
    """Return the mean order of convergence over grids that are refined by 2."""
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))


# --- closed surfaces: f on [0,1]², what is periodic, the cells of a coarse grid -------------------


def torus(u, v):
    u, v = 2 * np.pi * u, 2 * np.pi * v
    r = 1.0 + 0.35 * np.cos(v)
    return np.stack([r * np.cos(u), r * np.sin(u), 0.35 * np.sin(v) + 0 * u], axis=-1)


def tube(u, v):
    u = 2 * np.pi * u
    return np.stack([np.cos(u) * (2 + v * v), np.sin(u) * (2 - v), 3 * v + 0 * u], axis=-1)


def moebius(u, v):
    u, v = 2 * np.pi * u, 0.8 * v - 0.4
    r = 1.0 + v * np.sin(u / 2)
    return np.stack([r * np.cos(u), r * np.sin(u), v * np.cos(u / 2)], axis=-1)


def klein(u, v):
    u, v = 2 * np.pi * u, 2 * np.pi * v
    r = 2.0 + np.cos(v)
    return np.stack([r * np.cos(u), r * np.sin(u), np.sin(v) * np.cos(u / 2)], axis=-1)


def ball(u, v):
    u, v = 2 * np.pi * u, np.pi * (v - 0.5)
    return np.stack(
        [np.cos(u) * np.cos(v), 0.8 * np.sin(u) * np.cos(v), np.sin(v) + 0 * u], axis=-1
    )


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
    across = np.cross(f(u + step, v) - f(u - step, v), f(u, v + step) - f(u, v - step))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
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


@pytest.mark.parametrize("value", [np.inf, -np.inf])
def test_infinity_and_where(value):
    points = POINTS.copy()
    points[3, 4, 1] = points[4, 0, 2] = value
    refused(r"grid holds 2 points with infinity, the first at \[3, 4\]", points)
    heights = HEIGHTS.copy()
    heights[1, 4] = value
    for spacing in ((1.0, 2.0), (1.0, -2.0)):
        refused(r"holds 1 points with infinity, the first at \[1, 4\]", heights, spacing)


@pytest.mark.parametrize(
    ("shape", "periodic", "complaint"),
    [
        ((3, 6), (False, False), "grid has 3 x 6 points; it needs at least 4 along axis 0"),
        ((6, 3), (False, False), "grid has 6 x 3 points; it needs at least 4 along axis 1"),
        ((2, 6), (True, False), "grid has 2 x 6 points; it needs at least 3 along axis 0"),
        ((6, 2), (False, "mirrored"), "grid has 6 x 2 points; it needs at least 3 along axis 1"),
        ((0, 0), (False, False), "grid has 0 x 0 points"),
        ((1, 1), (True, True), "grid has 1 x 1 points"),
    ],
)
def test_too_few_points(shape, periodic, complaint):
    refused(complaint, np.zeros((*shape, 3)), periodic=periodic)


@pytest.mark.parametrize("shape", [(), (5,), (5, 6, 2), (5, 6, 4), (5, 5, 5, 3)])
def test_other_shapes(shape):
    complaint = r"must have the shape \(m, n, 3\), or \(m, n\) for elevations, not \("
    refused(complaint, np.zeros(shape))


@pytest.mark.parametrize("points", [POINTS + 0j, None, "terrain"], ids=lambda x: type(x).__name__)
def test_other_things_than_numbers(points):
    refused("a grid must be an array of real numbers", points)
    refused("a grid must be an array of real numbers", points, spacing=(1.0, 1.0))


def test_nothing_but_missing_points():
    nothing = np.full((9, 9), np.nan)
    refused("all points of grid are missing", nothing, spacing=(1.0, 1.0))
    refused("all points of grid are missing", np.full((9, 9, 3), -1.0), nodata=-1)
    nothing[4, 4] = 1.0
    refused("80 of the 81 points of grid are missing", nothing, spacing=(1.0, 1.0))
    refused("nodata must be a number, not 'none'", POINTS, nodata="none")


@pytest.mark.parametrize("spacing", [None, (1, 2, 3), ("a", 1), (10**400, 1)])
def test_spacing_that_is_none(spacing):
    refused(r"elevations \(m, n\) need a spacing of two numbers", HEIGHTS, spacing=spacing)


@pytest.mark.parametrize(
    "spacing", [(0, 1), (1, 0), (-1, 1), (np.nan, 1), (1, np.nan), (np.inf, 1), (1e308, 1)]
)
def test_spacing_out_of_range(spacing):
    refused("spacing must be finite and the map too, dx > 0 and dy not 0", HEIGHTS, spacing=spacing)


def test_spacing_is_for_elevations_and_ends_are_for_points():
    refused("spacing is for elevations", POINTS, spacing=(1.0, 1.0))
    for periodic in ((True, False), (False, "mirrored"), (True, "pole")):
        refused("cannot be periodic", HEIGHTS, spacing=(1.0, 1.0), periodic=periodic)


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
        refused("repeats its first points at the end of axis 0", points, periodic=(True, False))
    else:
        assert gm.Surface.from_grid(points, periodic=(True, False)).grid is not None


@pytest.mark.parametrize("name", ["torus", "tube", "tube_swapped", "moebius", "moebius_swapped"])
def test_first_points_repeated_at_the_end(name):
    f, periodic, cells = CLOSED[name]
    repeated = f(np.linspace(0, 1, cells[0] + 1)[:, None], np.linspace(0, 1, cells[1] + 1))
    refused("repeats its first points at the end of axis [01], .*leave them out", repeated,
            periodic=periodic)  # fmt: skip


def test_poles_that_are_none():
    points = grid_of(ball, (True, "pole"), (12, 7))
    refused(r"has no pole at points\[:, 0\]", points[:, 1:], periodic=(True, "pole"))
    refused(r"has no pole at points\[:, -1\]", points[:, :-1], periodic=(True, "pole"))
    refused(r"has no pole at points\[0\]", points.swapaxes(0, 1)[1:], periodic=("pole", True))


def test_mirrored_both_ways():
    """The corner (0, n) of such a surface is a point of its own, and not in the grid."""
    refused("cannot be mirrored along both axes", POINTS, periodic=("mirrored", "mirrored"))
