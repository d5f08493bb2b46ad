"""Sides that are one point, and that nobody declared: poles and apexes are found."""

import gaussmap as gm
import numpy as np
import pytest

from ...products import covering
from ...shapes import TURN, Array
from .test_poles import ROTATION, SHAPES, SPHERE

DISK = (0.0, 1.0), TURN
PERIODIC, OPEN = ("periodic", "periodic"), ("open", "open")


def polar(r: Array, phi: Array, z: Array) -> Array:
    r, phi, z = np.broadcast_arrays(r, phi, z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1) @ ROTATION.T


def lens(r: Array, phi: Array) -> Array:
    """Return a surface that is smooth at r = 0, where its normal is not the axis."""
    return polar(r, phi, 0.5 * r**2 + 0.1 * r**3 * np.cos(3 * phi) + 0.2 * r * np.cos(phi))


def cone(r: Array, phi: Array) -> Array:
    return polar(r, phi, 0.3 * r)


def cusp(r: Array, phi: Array) -> Array:
    return polar(r**3, phi, r**2)


def creased(r: Array, phi: Array) -> Array:
    """Return a surface with a crease along phi = 0, down to r = 0, where it is smooth."""
    return polar(r, phi, r**3 * np.sin(phi / 2))


def spiral(r: Array, phi: Array) -> Array:
    """Return a surface that does not close after one turn."""
    return polar(r, phi, 0.1 * phi * r**2)


def swapped(f):
    return lambda u, v: f(v, u)


@covering(
    shift=[0.0, 1e6, 1e9],
    factor=[1.0, 1e-9, 1e9],
    **{
        "f, domain, radial, around, apexes": [
            (lens, DISK, ("pole", "open"), PERIODIC, 0),
            (lambda r, phi: lens(1.0 - r, phi), DISK, ("open", "pole"), PERIODIC, 0),
            (lambda v, u: SHAPES["egg"](u, v), SPHERE[::-1], ("pole", "pole"), PERIODIC, 0),
            (lens, ((0.05, 1.0), TURN), OPEN, OPEN, 0),
            (lens, ((0.0, 1.0), (0.0, np.pi)), OPEN, OPEN, 1),
            (cone, DISK, OPEN, OPEN, 1),
            (cusp, DISK, OPEN, OPEN, 1),
            (creased, DISK, OPEN, OPEN, 1),
            (spiral, DISK, OPEN, OPEN, 1),
        ]
    },
)
def test_sides_that_are_found(f, domain, radial, around, apexes, shift, factor):
    def evaluate(u, v):
        return factor * (f(u, v) + shift)

    for g, sides, expected in (
        (evaluate, domain, (radial, around)),
        (swapped(evaluate), domain[::-1], (around, radial)),
    ):
        surface = gm.Surface.from_callable(g, sides)
        spline = gm.fit(surface, (8, 9))
        assert (spline.boundary, spline.apexes) == (expected, apexes)
        assert surface.boundary == (OPEN, OPEN)


@pytest.mark.parametrize(
    ("periodic", "expected"),
    [
        ((False, False), (("pole", "open"), PERIODIC)),
        ((False, True), (("pole", "open"), PERIODIC)),
        ((("pole", "open"), True), (("pole", "open"), PERIODIC)),
        (("open", False), (OPEN, OPEN)),
        (("open", True), (OPEN, PERIODIC)),
        ((False, "open"), (OPEN, OPEN)),
    ],
)
def test_what_is_said_is_respected(periodic, expected):
    assert gm.fit(gm.Surface.from_callable(lens, DISK, periodic), (8, 8)).boundary == expected


@covering(
    turned=[False, True],
    count=[24, 25],
    **{
        "points, periodic, radial, around, apexes": [
            (lens, False, ("pole", "open"), PERIODIC, 0),
            (lens, True, ("pole", "open"), PERIODIC, 0),
            (lens, "open", OPEN, OPEN, 1),
            (cone, False, OPEN, OPEN, 1),
            (cone, True, OPEN, PERIODIC, 1),
        ]
    },
)
def test_grids_of_points(points, periodic, radial, around, apexes, turned, count):
    r = np.linspace(0.0, 1.0, 9)[:, None]
    phi = np.arange(count + (periodic is not True)) * (2 * np.pi / count)  # repeats its first point
    array = points(r, phi)
    ends, expected, shape = (False, periodic), (radial, around), (9, count)
    if turned:
        array, ends, expected = array.swapaxes(0, 1), ends[::-1], expected[::-1]
    surface = gm.Surface.from_grid(array, periodic=ends)
    spline = gm.fit(surface)
    assert (spline.boundary, spline.apexes) == (expected, apexes)
    assert surface.boundary == expected
    if around == PERIODIC:
        assert surface.grid.shape[:2] == (shape[::-1] if turned else shape)


@pytest.mark.parametrize(("f", "apexes"), [(lens, 0), (cone, 1)])
def test_samples_of_a_disk(f, apexes):
    """They do not crowd at its middle, and an apex is told."""
    samples = gm.sample(gm.fit(gm.Surface.from_callable(f, DISK), (24, 24)), 300)
    assert abs(len(samples) - 300) <= 5
    assert np.isfinite(samples.points).all()
    assert len(np.unique(samples.points.round(6), axis=0)) == len(samples)
    assert samples.report.apexes == apexes
    assert ("; the surface ends in a sharp tip" in samples.summary()) == apexes
    assert ("tip" in samples.summary()) == apexes
    assert samples.mesh().euler_characteristic == 1
