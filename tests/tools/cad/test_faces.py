"""Surfaces of faces: exact derivatives, domains and their ends, trims, normals."""

import math

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.faces import face_surface, own_parameters
from gaussmap.tools.cad.records import FaceRecord, Geometry, Net
from gaussmap.tools.cad.units import with_unit

from ...refusals import refused
from ...shapes import area_of, central_differences
from .made import TURN, net, normals_of, nurbs, rectangle

OPEN, PERIODIC = ("open", "open"), ("periodic", "periodic")
Z = np.array([0.36, 0.48, 0.8])
X = np.array([0.8, -0.6, 0.0])
FRAME = np.array([X, np.cross(Z, X), Z])  # the rows x, y and z
ORIGIN = np.array([1.0, -2.0, 0.5])
KNOTS = np.array([0.0, 0, 0, 0, 1, 2, 2, 2, 2])
ROUND = math.sqrt(0.5)
CIRCLE = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)])


def placed(*more, left_handed=False):
    signs = np.array([[1.0], [-1.0 if left_handed else 1.0], [1.0]])
    return np.concatenate([ORIGIN, *(signs * FRAME), more])


def curve(weights=None):
    t = np.linspace(0.0, 2.0, 5)
    return net(np.stack([2.0 + np.sin(2 * t), 0.3 * t**2, 2.0 * t], axis=1), weights, KNOTS)


def circle():
    """Return a circle of radius 1 as NURBS over [0, 4], with double knots, around x = 3."""
    points = np.array([3.0, 0.0, 0.0]) + CIRCLE @ np.eye(3)[[0, 2]]
    knots = [0.0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
    return net(points, np.array([1, ROUND] * 4 + [1]), knots)


def waves():
    x, y = np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij")
    return nurbs(np.stack([x, y, np.sin(x + 0.5 * y)], axis=2), 1.0 + 0.1 * x * y, KNOTS)


def offset(distance: float, basis: Geometry) -> Geometry:
    return Geometry("offset", np.array([distance]), basis=basis)


WEIGHTS = np.array([1.0, 2.0, 1.0, 0.5, 1.0])
AXIS = np.concatenate([ORIGIN, Z])
GEOMETRIES = {
    "plane": (Geometry("plane", placed()), ((-1, 2), (0, 3))),
    "cylinder": (Geometry("cylinder", placed(1.5)), ((0.5, 4), (-1, 2))),
    "cone": (Geometry("cone", placed(1.5, -0.4)), ((0.5, 4), (-1, 2))),
    "sphere": (Geometry("sphere", placed(1.5)), ((0.5, 4), (-1.2, 1))),
    "torus": (Geometry("torus", placed(1.5, 0.4)), ((0.5, 4), (2, 6))),
    "left-handed": (Geometry("torus", placed(1.5, 0.4, left_handed=True)), ((0.5, 4), (2, 6))),
    "nurbs": (waves(), ((0.1, 1.9), (0.2, 2.0))),
    "revolution": (Geometry("revolution", AXIS, curve(WEIGHTS)), ((0.5, 4), (0.2, 2.0))),
    "extrusion": (Geometry("extrusion", Z, curve(WEIGHTS)), ((0.2, 2.0), (-1, 2))),
}
DISTANCE = 0.02
SPINDLE = Geometry("torus", placed(0.4, 1.5, left_handed=True))
OFFSETS = {
    name: (offset(DISTANCE, basis), domain) for name, (basis, domain) in GEOMETRIES.items()
} | {
    "twice": (offset(0.03, offset(-0.1, waves())), ((0.1, 1.9), (0.2, 2.0))),
    "spindle, left-handed": (offset(0.2, SPINDLE), ((0.5, 4), (-1, 1))),
}


def places(domain, count=60):
    low, high = np.array(domain, dtype=float).T
    return low + (high - low) * (0.02 + 0.96 * np.random.default_rng(2).random((count, 2)))


@pytest.mark.parametrize("case", [*GEOMETRIES.values(), *OFFSETS.values()])
def test_derivatives_are_those_of_the_points(case):
    surface = face_surface(*case)
    uv = places(case[1], 12)
    u, v = uv[(np.abs(uv - KNOTS[4]) > 0.02).all(axis=1)].T  # second derivatives may jump there
    jets = surface.jets(u, v)
    assert np.array_equal(surface.evaluate(u, v), jets[:, 0])
    numerical = central_differences(surface.evaluate, u, v, 2.0**-9)
    # Rounding 8 ε/h² = 5e-10.
    assert np.abs(jets - numerical).max() < 2e-8 * max(np.abs(jets).max(), 1.0)


# The factors of u and v if lengths are doubled.
DOUBLED = {"plane": (2, 2), "cylinder": (1, 2), "cone": (1, 2), "extrusion": (1, 2)}


@pytest.mark.parametrize(
    ("name", "case"), [*GEOMETRIES.items(), *((f"offset, {x}", y) for x, y in OFFSETS.items())]
)
def test_faces_in_another_unit(name, case):
    """Lengths are multiplied, and angles are not; offsets have the parameters of their bases."""
    geometry, domain = case
    one = FaceRecord(geometry, domain, (6.0, 3.0), [rectangle(*domain)], area=5.0)
    other, factors = with_unit(one, 2.0), np.array(DOUBLED.get(name.split(", ")[-1], (1, 1)))
    np.testing.assert_array_equal(other.loops[0], one.loops[0] * factors)
    np.testing.assert_array_equal(other.domain, domain * factors[:, None])
    assert (tuple(other.periods), other.area) == (tuple(factors * (6.0, 3.0)), 20.0)
    uv = places(domain)
    found = face_surface(other.geometry, other.domain).evaluate(*(uv * factors).T)
    expected = 2.0 * face_surface(geometry, domain).evaluate(*uv.T)
    np.testing.assert_allclose(found, expected, atol=1e-13)


@pytest.mark.parametrize("name", [*GEOMETRIES])
def test_offsets_are_at_their_distance_along_the_normals(name):
    geometry, domain = GEOMETRIES[name]
    u, v = places(domain).T
    jets, moved = (face_surface(x, domain).jets(u, v) for x in (geometry, OFFSETS[name][0]))
    assert np.allclose(moved[:, 0], jets[:, 0] + DISTANCE * normals_of(jets), atol=1e-13)
    assert np.allclose(normals_of(moved), normals_of(jets), atol=1e-13)


@pytest.mark.parametrize(
    ("name", "radius", "height"),
    [
        ("cylinder", lambda v: 1.5 + 0 * v, lambda v: v),
        ("cone", lambda v: 1.5 - v * math.sin(0.4), lambda v: v * math.cos(0.4)),
        ("torus", lambda v: 1.5 + 0.4 * np.cos(v), lambda v: 0.4 * np.sin(v)),
    ],
)
def test_elementary_surfaces_are_where_their_numbers_say(name, radius, height):
    surface = face_surface(*GEOMETRIES[name])
    u, v = places(surface.domain).T
    x, y, z = FRAME @ (surface.evaluate(u, v) - ORIGIN).T
    assert np.allclose(np.cos(np.arctan2(y, x) - u), 1.0)
    assert np.allclose((np.hypot(x, y), z), (radius(v), height(v)), atol=1e-14)


# --- ends -----------------------------------------------------------------------------------------

ROUNDED, SOUTH = (0.3, 0.3 + TURN - 1e-9), (-math.pi / 2, 1.0)


@pytest.mark.parametrize(
    ("kind", "sizes", "u", "v", "boundary", "cells", "apexes"),
    [
        ("sphere", [1.0], ROUNDED, SOUTH, (PERIODIC, ("pole", "open")), (12, 6), 0),
        ("sphere", [1.0], (0, 2), SOUTH, (OPEN, OPEN), (12, 6), 1),
        ("torus", [1.0, 0.3], ROUNDED, (1.0, 1.0 + TURN), (PERIODIC, PERIODIC), (12, 6), 0),
        ("cone", [0.0, 0.5], ROUNDED, (0.0, 1.0), (PERIODIC, OPEN), (24, 4), 1),
    ],
)
def test_whole_turns_close_and_poles_are_poles(kind, sizes, u, v, boundary, cells, apexes):
    surface = face_surface(Geometry(kind, placed(*sizes)), (u, v))
    assert surface.boundary == boundary
    fitted = gm.fit(surface, cells)
    assert fitted.apexes == apexes
    if u == ROUNDED:
        assert surface.domain[0] == (0.3, 0.3 + TURN)
    if kind == "sphere" and u == ROUNDED:
        assert surface.domain[1] == SOUTH
        assert fitted.misfit.distance < 0.02


def test_a_band_that_turns_twice_is_open_and_has_its_area():
    width, steps = 0.3, np.linspace(0.0, 12.0, 200)
    low, high = (np.stack([steps, 0.2 * steps + x], axis=1) for x in (0.0, width))
    domain = (0.0, 12.0), (0.0, 2.4 + width)
    band = face_surface(
        Geometry("cylinder", placed(2.0)), domain, [np.concatenate([low, high[::-1]])]
    )
    assert band.boundary == (OPEN, OPEN)
    assert area_of(band) == pytest.approx(2.0 * 12.0 * width, rel=2e-3)
    # One turn on is the same point of the cylinder, but in another place of the band.
    inside = band.trim.contains(np.array([(1.0, 0.35), (1.0 + TURN, 0.35), (1.0 + TURN, 1.6)]))
    assert inside.tolist() == [True, False, True]


def test_revolutions_close_both_ways():
    geometry = Geometry("revolution", np.concatenate([np.zeros(3), [0, 0, 1]]), circle())
    torus = face_surface(geometry, ((0.0, TURN), (0.0, 4.0)))
    assert torus.boundary == (PERIODIC, PERIODIC)
    assert torus.pieces() == (torus,)
    assert area_of(torus, 60) == pytest.approx(TURN**2 * 3.0, rel=1e-3)
    # A domain that begins within the period goes on around it.
    later = face_surface(geometry, ((0.0, TURN), (1.5, 5.5)))
    assert later.boundary == (PERIODIC, PERIODIC)
    u, v = places(((0.0, TURN), (1.5, 5.5))).T
    assert np.allclose(later.jets(u, v), torus.jets(u, v % 4.0), atol=1e-12)
    part = face_surface(geometry, ((0.0, 1.0), (3.5, 4.5)))
    assert part.boundary == (OPEN, OPEN)
    assert np.allclose(part.jets(u, v * 0 + 4.25), torus.jets(u, v * 0 + 0.25), atol=1e-12)


def test_extrusions_of_closed_curves_close():
    tube = face_surface(Geometry("extrusion", np.array([0, 1, 0]), circle()), ((0, 4), (-1, 2)))
    assert tube.boundary == (PERIODIC, OPEN)
    assert area_of(tube, 60) == pytest.approx(TURN * 3.0, rel=1e-3)


def test_the_profile_of_a_vase_has_a_pole_on_the_axis():
    points = np.array([(0.0, 0, 0), (1, 0, 0), (2, 0, 1), (1, 0, 2), (1.5, 0, 3)])
    geometry = Geometry("revolution", AXIS, net(ORIGIN + points @ FRAME, knots=KNOTS))
    vase = face_surface(geometry, ((0.0, TURN), (0.0, 2.0)))
    assert gm.fit(vase, (24, 24)).boundary == (PERIODIC, ("pole", "open"))


# --- kinks, trims, normals ------------------------------------------------------------------------


def kinked():
    """Return a polygon of three sides as a NURBS curve, with kinks at 1 and 2."""
    points = [(1.0, 0, 0), (2, 0, 0), (2, 0, 1), (1, 0, 2)]
    return net(points, knots=[0.0, 0, 1, 2, 3, 3])


@pytest.mark.parametrize("kind", ["revolution", "extrusion", "offset"])
def test_kinks_cut_surfaces_into_pieces(kind):
    geometry, axis = Geometry("revolution", np.eye(6)[5], kinked()), int(kind != "extrusion")
    if kind == "extrusion":
        geometry = Geometry("extrusion", np.array([0.0, 1, 0]), kinked())
    if kind == "offset":
        geometry = offset(0.1, geometry)

    def domain(low):
        return ((0.0, TURN), (low, 3.0)) if axis else ((low, 3.0), (0.0, TURN))

    pieces = face_surface(geometry, domain(0.0)).pieces()
    assert [x.domain[axis] for x in pieces] == [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]
    at_kink = [1.0, 1.0]
    sides = [x.derivatives(*((0.5, at_kink) if axis else (at_kink, 0.5))) for x in pieces[:2]]
    turned = (normals_of(sides[0]) * normals_of(sides[1])).sum(axis=1)
    assert np.allclose(turned, 0.0, atol=1e-14)
    # Faces end at kinks, up to the rounding of a file; what is beyond is no piece.
    ended = face_surface(geometry, domain(1.0 - 1e-9)).pieces()
    assert [x.domain[axis] for x in ended] == [(1.0, 2.0), (2.0, 3.0)]


def test_only_loops_that_cut_something_off_are_a_trim():
    geometry, domain = GEOMETRIES["plane"]
    border = np.array([(-1, 0), (0, 0), (2, 0), (2, 3), (-1, 3)])
    hole = np.array([(0, 1), (1, 1), (1, 2)])
    assert face_surface(geometry, domain, [border]).trim is None
    assert face_surface(geometry, domain, [border[::-1] + 1e-12]).trim is None
    assert face_surface(geometry, domain, [border[:4]]).trim is not None
    holed = face_surface(geometry, domain, [border, hole])
    assert area_of(holed) == pytest.approx(8.5, rel=2e-3)


@pytest.mark.parametrize("name", ["plane", "torus", "left-handed", "nurbs", "revolution"])
def test_reversed_faces_have_opposite_normals(name):
    geometry, domain = GEOMETRIES[name]
    corner = rectangle(*domain)[:3]
    forward, back = (face_surface(geometry, domain, [corner], is_reversed=x) for x in (False, True))
    uv = places(domain)
    other = own_parameters(back, uv, is_reversed=True)
    jets, turned = forward.jets(*uv.T), back.jets(*other.T)
    assert np.allclose(jets[:, 0], turned[:, 0], atol=1e-13)
    assert np.allclose(normals_of(jets), -normals_of(turned), atol=1e-12)
    assert np.array_equal(forward.trim.contains(uv), back.trim.contains(other))
    assert np.allclose(own_parameters(back, other, is_reversed=True), uv, atol=1e-14)
    assert own_parameters(forward, uv, is_reversed=False) is uv


@pytest.mark.parametrize(
    ("geometry", "domain", "said"),
    [
        (Geometry("unknown"), ((0, 1), (0, 1)), "'unknown' has no surface"),
        (waves(), ((0, 1), (7, 8)), "outside its surface"),
        (GEOMETRIES["plane"][0], ((0, 0), (0, 1)), "empty or infinite"),
    ],
)
def test_what_is_no_surface_is_refused(geometry, domain, said):
    refused(said, face_surface, geometry, domain)


def test_a_whole_domain_ends_at_the_last_knot():
    # low + (high - low) is beyond it, in the last digits of low
    ends = (-6.589091811, 1.421085e-14)
    knots = np.repeat(ends, 2), np.repeat([0.0, 1], 3)
    sheet = Geometry("nurbs", net=Net((1, 2), knots, np.eye(3)[np.mgrid[:2, :3][1]]))
    surface = face_surface(sheet, (ends, (0, 1)))
    assert surface.domain == (ends, (0.0, 1.0))
