"""NURBS surfaces: their values and derivatives, what defines them, and where their normals turn."""

import math
from itertools import pairwise
from typing import Any

import gaussmap as gm
import geomdl.BSpline
import geomdl.NURBS
import numpy as np
import pytest
from scipy.interpolate import NdBSpline
from splipy import surface_factory
from splipy.basis import BSplineBasis
from splipy.surface import Surface
from splipy.volume import Volume

from ...refusals import refused
from ...shapes import CIRCLE, HALF, MERIDIAN, WEIGHTS, quotients, revolved

RNG = np.random.default_rng(8)


def torus(major=2.0, minor=0.5, **named):
    return revolved(minor * CIRCLE + [major, 0.0], WEIGHTS, **named)


def sphere():
    return revolved(MERIDIAN, HALF)


def random_parameters(surface, count):
    low, high = np.transpose(surface.domain)
    return np.ascontiguousarray(RNG.uniform(low, high, (count, 2)).T)


# --- values and derivatives -----------------------------------------------------------------------


def random_knots(degree, clamped):
    inner = np.sort(RNG.random(RNG.integers(0, 6)))
    inner = np.repeat(inner, RNG.integers(1, degree + 1, len(inner)))
    if clamped:
        return np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    ends = RNG.random(degree) * (1, -1)[degree % 2]
    return np.sort(np.concatenate([-np.abs(ends), [0.0], inner, [1.0], 1.0 + np.abs(ends)]))


def jets_of_scipy(degrees, knots, points, weights, uv):
    """Return 2-jets from SciPy's derivatives of x w and w."""
    spline = NdBSpline(knots, np.concatenate([points * weights, weights], axis=2), degrees)
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    return quotients([spline(uv, nu=nu) for nu in orders]).swapaxes(0, 1)


@pytest.mark.parametrize("p", range(1, 6))
@pytest.mark.parametrize("q", range(1, 6))
@pytest.mark.quick_for("1", "5")
def test_random_surfaces_agree_with_scipy(p, q):
    clamped, rational = bool((p + q) % 2), bool(p % 2 or q % 3)
    knots = random_knots(p, clamped), random_knots(q, clamped)
    shape = len(knots[0]) - p - 1, len(knots[1]) - q - 1
    points, weights = RNG.normal(size=(*shape, 3)), RNG.uniform(0.3, 3.0, shape)
    surface = gm.Surface.from_nurbs((p, q), knots, points, weights if rational else None)
    u, v = random_parameters(surface, 50)
    factors = weights[:, :, None] if rational else np.ones((*shape, 1))
    expected = jets_of_scipy((p, q), knots, points, factors, np.stack([u, v], axis=1))
    found = surface.jets(u, v)
    for rows, tolerance in ((slice(0, 1), 1e-13), (slice(1, 3), 1e-11), (slice(3, 6), 1e-10)):
        error = np.abs(found - expected)[:, rows].max()
        assert error <= tolerance * max(1.0, np.abs(expected[:, rows]).max())
    assert np.array_equal(surface.evaluate(u, v), found[:, 0])


def test_the_largest_degree():
    """x = u³, y = v, in the Bernstein basis of degree 25."""
    k = np.arange(26)
    cubes = k * (k - 1) * (k - 2) / (25 * 24 * 23)
    x, y = np.meshgrid(cubes, [0.0, 1.0], indexing="ij")
    points = np.stack([x, y, 0 * x], axis=-1)
    surface = gm.Surface.from_nurbs((25, 1), ([0] * 26 + [1] * 26, [0, 0, 1, 1]), points)
    u = np.linspace(0.0, 1.0, 11)
    jets = surface.jets(u, 0 * u)
    assert np.allclose(jets[:, [0, 1, 3], 0], np.stack([u**3, 3 * u**2, 6 * u], axis=1), atol=1e-12)


def test_far_from_the_origin_derivatives_keep_their_digits():
    surface = torus()
    moved = revolved(0.5 * CIRCLE + [2.0, 0.0], WEIGHTS, shift=[1e6, -1e7, 3e6])
    u, v = random_parameters(surface, 100)
    difference = np.abs(surface.jets(u, v) - moved.jets(u, v))[:, 1:]
    assert difference.max() < 1e3 * np.spacing(1e7)  # the rounding of the moved control points
    assert moved.boundary == surface.boundary


@pytest.mark.parametrize("factor", [1e-290, 1e290])
def test_only_the_ratios_of_weights_count(factor):
    surface = torus()
    other = revolved(0.5 * CIRCLE + [2.0, 0.0], WEIGHTS * factor)
    u, v = random_parameters(surface, 20)
    assert np.allclose(surface.jets(u, v), other.jets(u, v), rtol=1e-12, atol=1e-12)


def test_ends_are_those_of_the_domain_and_period():
    surface = torus()
    (low, high), _ = surface.domain
    assert (low, high) == (0.0, 4.0)
    corner = surface.evaluate(low, 0.0)
    assert np.allclose(surface.evaluate([high, high + 4.0, low - 8.0], 0.0), corner, atol=1e-15)
    refused(r"v = 2.5 lies outside the domain \(0.0, 2.0\)", sphere().evaluate, 0.0, 2.5)
    assert np.isnan(surface.jets(np.array([np.nan]), np.zeros(1))).any()


# --- closing --------------------------------------------------------------------------------------


def extruded(profile, degree=1, knots=None):
    """Return a profile (x, y) of uniform knots, extruded along z."""
    profile = np.asarray(profile, dtype=float)
    points = np.empty((len(profile), 2, 3))
    points[:, :, :2], points[:, :, 2] = profile[:, None], [0.0, 3.0]
    inner = np.arange(len(profile) - degree + 1)
    ends = [0] * degree, [len(profile) - degree] * degree
    knots = np.concatenate([ends[0], inner, ends[1]]) if knots is None else knots
    return gm.Surface.from_nurbs((degree, 1), (knots, [0, 0, 1, 1]), points, name="sweep")


CORNERS = [(1, 1), (-1, 1), (-1, -1), (1, -1)]


CUBIC = [0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]
OPEN, PERIODIC = ("open", "open"), ("periodic", "periodic")


def slope(degrees):
    return math.tan(math.radians(degrees))


def cubic(*middle):
    """Return a corner, if three control points on a simple knot coincide, and knots."""
    return extruded([(0, 0), (1, 0), (2, 0), *middle], 3, CUBIC)


def with_speed(speed):
    return extruded([(0, 0), (speed, 0), (speed, 1), (-1, 1), (-1, 0), (0, 0)])


# Surfaces, the conditions at the ends of u, and the lines along which the normal turns.
LINES = {
    "torus": (torus(), PERIODIC, ()),
    "torus, half said to be open": (torus(periodic=(True, False)), PERIODIC, ()),
    "sphere": (sphere(), PERIODIC, ()),
    "open square": (extruded(CORNERS), OPEN, (1, 2)),
    "seam on an edge": (extruded([*CORNERS, CORNERS[0]]), OPEN, (1, 2, 3)),
    "seam on a face": (extruded([(1, 0), *CORNERS, (1, 0)]), PERIODIC, (1, 2, 3, 4)),
    # Multiple knots on a smooth surface.
    "plane": (extruded([(0, 0), (1, 0), (3, 0), (4, 0)]), OPEN, ()),
    "small angle": (extruded([(0, 0), (1, 0), (2, slope(0.09))]), OPEN, ()),
    "larger angle": (extruded([(0, 0), (1, 0), (2, slope(0.11))]), OPEN, (1,)),
    # A spline of a plane would fold where a tangent becomes five times longer.
    "tangent, longer": (extruded([(0, 0), (1, 0), (3.9, 0)]), OPEN, ()),
    "tangent, much longer": (extruded([(0, 0), (1, 0), (4.1, 0)]), OPEN, (1,)),
    "tangent at a seam, longer": (with_speed(2.9), PERIODIC, (1, 2, 3, 4)),
    "tangent at a seam, much longer": (with_speed(3.1), OPEN, (1, 2, 3, 4)),
    "edge on a simple knot": (cubic((2, 0), (2, 0), (2, 1), (2, 2)), OPEN, (2,)),
    "nearly": (cubic((math.nextafter(2.0, 3.0), 0), (2, 0), (2, 1), (2, 2)), OPEN, (2,)),
    "rounded": (cubic((2, 0), (2.01, 0), (2, 1), (2, 2)), OPEN, ()),
    "straight": (cubic((2, 0), (2, 0), (3, 0), (4, 0)), OPEN, ()),
}


@pytest.mark.parametrize("name", LINES)
def test_ends_and_lines_where_the_normal_turns(name):
    surface, ends, lines = LINES[name]
    assert surface.boundary == (ends, PERIODIC if name == "torus" else OPEN)
    assert surface.function.creases == (lines, ())
    pieces = surface.pieces()
    if not lines:
        assert pieces == (surface,)
        return
    (low, high), _ = surface.domain
    assert [x.domain[0] for x in pieces] == list(pairwise([low, *lines, high]))
    assert all(x.boundary == (OPEN, OPEN) for x in pieces)
    assert [x.name for x in pieces][:2] == ["sweep (piece 1)", "sweep (piece 2)"]
    u = np.array([float(lines[0])])
    before, after = (x.jets(u, 0.5 * u)[0] for x in pieces[:2])
    assert np.array_equal(before[0], after[0])
    if name == "seam on a face":
        assert np.allclose([before[1], after[1]], [[0, 1, 0], [-2, 0, 0]])


def test_a_crease_on_a_part_of_a_line_is_found():
    """A bilinear net, flat but for one corner."""
    x, y = np.meshgrid([0.0, 1.0, 2.0], np.arange(5.0), indexing="ij")
    points = np.stack([x, y, 0 * x], axis=-1)
    points[2, 4, 2] = 0.5
    knots = [0, 0, 1, 2, 2], [0, 0, 1, 2, 3, 4, 4]
    surface: Any = gm.Surface.from_nurbs((1, 1), knots, points)
    assert surface.function.creases == ((1.0,), (3.0,))
    assert len(surface.pieces()) == 4


# --- objects --------------------------------------------------------------------------------------


def net(rows, columns):
    x, y = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    return np.stack([x, y, RNG.random((rows, columns))], axis=-1)


def of_geomdl():
    surface = geomdl.NURBS.Surface()
    surface.degree_u, surface.degree_v = 2, 3
    points, weights = net(4, 5), RNG.uniform(0.5, 2.0, (4, 5))
    surface.set_ctrlpts(
        np.concatenate([points * weights[..., None], weights[..., None]], axis=2)
        .reshape(-1, 4).tolist(),
        4, 5,
    )  # fmt: skip
    surface.knotvector_u, surface.knotvector_v = [0, 0, 0, 0.3, 1, 1, 1], [0] * 4 + [0.6] + [1] * 4
    return surface


def smooth_of_splipy():
    """Cubics with two continuous derivatives at the seam: three control points are repeated."""
    basis = BSplineBasis(4, np.arange(-3.0, 12.0), periodic=2)
    angles = 2 * np.pi * np.arange(basis.num_functions()) / basis.num_functions()
    around = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1)
    return Surface(basis, BSplineBasis(2), np.concatenate([around, around + np.array([0, 0, 1])]))


# Those of Splipy are rational, and periodic ones do not repeat control points.
MAKERS = [of_geomdl, surface_factory.torus, surface_factory.sphere, smooth_of_splipy]


@pytest.mark.parametrize("make", MAKERS)
def test_surfaces_of_other_libraries(make):
    theirs = make()
    ours = gm.Surface.from_nurbs(theirs, name="theirs")
    u, v = (np.linspace(*ends, 9) for ends in ours.domain)
    if make is of_geomdl:
        expected = [[theirs.evaluate_single((a, b)) for b in v.tolist()] for a in u.tolist()]
        periodic = [False, False]
    else:
        expected, periodic = theirs(u, v), [theirs.periodic(k) for k in (0, 1)]
    assert np.allclose(ours.evaluate(u[:, None], v), expected, atol=1e-14)
    assert [x[0] == "periodic" for x in ours.boundary] == periodic
    assert ours.name == "theirs"


# --- errors ---------------------------------------------------------------------------------------

LINE = [0, 0, 1, 1]
SQUARE = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((1, 1), (LINE, [0, 0, 1]), SQUARE), "along v need 4 knots, not 3"),
        (((1, 1), (LINE, [0, 1, 0.5, 1]), SQUARE), "knots of v decrease: 1.0 is followed by 0.5"),
        (((1, 1), (LINE, [0, 0, 0, 1]), SQUARE), "leave no domain: it is from 0.0 to 0.0"),
        (((1, 1), (LINE, [0, 0, np.nan, 1]), SQUARE), r"knots of v holds .*: nan at index \[2\]"),
        (((1, 1), (LINE, LINE), SQUARE, [[1, 0], [1, 1]]), "a NURBS with a zero weight"),
        (((1, 1), (LINE, LINE), SQUARE, [[1, 1], [-2, 1]]), r"weights\[1, 0\] is -2.0"),
        (((1, 1), (LINE, LINE), SQUARE, [[1, np.nan], [1, 1]]), r"weights .*nan at index \[0, 1"),
        (((1, 1), (LINE, LINE), SQUARE, [1, 1]), r"weights must have the shape \(2, 2\)"),
        (((0, 1), (LINE, LINE), SQUARE), "the degree of u must be a whole number of at least 1"),
        (((26, 1), (LINE, LINE), SQUARE), "the degree of u must be a whole number of at most 25"),
        (((2, 1), ([0] * 3 + [1] * 2, LINE), SQUARE), "needs at least 3 control points along u"),
        (((1, 1), ([0, 0, 0.5, 0.5, 1, 1], LINE), net(4, 2)),
         r"the knot 0.5 of u occurs 2 times.*would be torn"),
        (((1, 1), ([0, 0, 0, 0.5, 1, 1], LINE), net(4, 2)),
         "the knot 0.0 of u occurs 3 times.*would do nothing"),
        ((1, (LINE, LINE), SQUARE), "degrees must be a pair"),
        (((1, 1), LINE, SQUARE), "knots must be a pair"),
        (((1, 1), (LINE, LINE), [[0, 0, 0], [1, 0, 0]]), r"must have the shape \(m, n, 3\)"),
        (((1, 1), (LINE, LINE), [[[0, 0, np.inf]] * 2] * 2), r"holds .*: inf at index \[0, 0, 2\]"),
        (((1, 1), (LINE, LINE), None), "control_points must be an array of real numbers"),
        (("torus",), "one surface of geomdl or Splipy, not 'torus'"),
        ((Volume(),), "this object of Splipy has 3 parameters"),
        ((Surface(),), r"must have the shape \(m, n, 3\), not \(2, 2, 2\)"),
        ((geomdl.NURBS.Surface(),), "does not have 0 × 0 control points yet"),
    ],
)  # fmt: skip
def test_errors(arguments, message):
    refused(message, gm.Surface.from_nurbs, *arguments)


def test_trimmed_surfaces_of_geomdl_are_refused():
    surface = geomdl.BSpline.Surface()
    surface.degree_u = surface.degree_v = 1
    surface.set_ctrlpts([[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0]], 2, 2)
    surface.knotvector_u = surface.knotvector_v = LINE
    trim = geomdl.BSpline.Curve()
    trim.degree, trim.ctrlpts, trim.knotvector = 1, [[0.1, 0.1], [0.9, 0.9]], LINE
    surface.trims = [trim]
    refused("has trim curves", gm.Surface.from_nurbs, surface)
