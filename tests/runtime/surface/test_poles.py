"""Poles: the spline has one normal there, and every normal of a closed surface once."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from numpy.typing import ArrayLike

from ...nets import in_fractions
from ...products import covering
from ...shapes import TURN, Array, egg, on_sphere, random_rotation

SPHERE = (0.0, 2 * np.pi), (-np.pi / 2, np.pi / 2)
ROTATION = random_rotation(1)  # no plane of symmetry of a surface is one of the coordinates


def ellipsoid(u: ArrayLike, v: ArrayLike) -> Array:
    return np.stack(on_sphere(u, v), axis=-1) * [1.0, 0.6, 0.3]


def blob(u: ArrayLike, v: ArrayLike) -> Array:
    x, y, z = on_sphere(u, v)
    radius = 1 + 0.12 * x**3 - 0.1 * x * y * z + 0.08 * z * x + 0.05 * y**3
    return radius[..., None] * np.stack([x, y, z], axis=-1)


SHAPES = {"egg": egg, "ellipsoid": ellipsoid, "blob": blob}


def moved(shape: str, rotation: Array, shift: float = 0.0, factor: float = 1.0) -> gm.Surface:
    """Return a shape that is rotated, translated by `shift` along each axis, and then scaled."""

    def evaluate(u: Array, v: Array) -> Array:
        return factor * (SHAPES[shape](u, v) @ rotation.T + shift)

    return gm.Surface.from_callable(evaluate, SPHERE, (True, "pole"), name=shape)


def pole_and_offsets(spline: gm.Spline, end: int) -> tuple[Array, Array]:
    """Return, exactly and times two, poles (m, 3) at an end of v, and offsets from these.

    They are the sums and the differences of the first ring of coefficients and the ghosts.
    """
    ring, ghosts = in_fractions(spline.coefficients[1:-1, (-2, -1) if end else (1, 0)]).swapaxes(
        0, 1
    )
    return ring + ghosts, ring - ghosts


def pole_normal(spline: gm.Spline, end: int) -> Array:
    """Return the normal at a pole, of about unit length; it is exact up to rounding."""
    _, offsets = pole_and_offsets(spline, end)
    normal = np.cross(offsets[0] + offsets[1], offsets[1] + offsets[2])
    return (normal / np.abs(normal).max()).astype(np.float64)


def beside(normal: Array, turns: int) -> Array:
    """Return a normal, its opposite, and normals at distances 1e-14 … 1e-1 from it."""
    a, b = np.linalg.svd(normal[None])[2][1:]
    angles = 0.3 + 2 * np.pi * np.arange(turns) / turns
    ring = np.cos(angles)[:, None] * a + np.sin(angles)[:, None] * b
    parts = [normal / np.linalg.norm(normal) + 10.0**x * ring for x in range(-14, 0)]
    return np.concatenate([[normal, -normal], *parts])


def hard_normals(spline: gm.Spline, generic: int, frequency: int, turns: int) -> Array:
    """Return random normals, symmetric ones, those of the axes, and some at and near the poles."""
    poles = [beside(pole_normal(spline, end), turns) for end in (0, 1)]
    return np.concatenate(
        [gm.fibonacci(generic), gm.icosphere(frequency), np.eye(3), -np.eye(3), *poles]
    )


@covering(shape=SHAPES, shift=[0.0, 1e6, 1e12], cells=[(4, 3), (24, 8), (25, 8)])
def test_the_ring_at_a_pole_is_in_one_plane(shape: str, shift: float, cells: tuple[int, int]):
    spline = gm.fit(moved(shape, ROTATION, shift), cells)
    for end in (0, 1):
        poles, offsets = pole_and_offsets(spline, end)
        assert (poles == poles[0]).all()
        normal = np.cross(offsets[0], offsets[1])
        assert normal.any()
        assert not (offsets @ normal).any()


@pytest.mark.parametrize("shape", SHAPES)
def test_the_ring_at_a_pole_is_moved_by_the_error_of_the_spline_only(shape: str):
    """Position errors keep order 3 and the normal at the pole order 2."""
    errors = []
    for m in (32, 64, 128):
        spline = gm.fit(moved(shape, ROTATION), (m, m // 2))
        u = np.linspace(0.0, 2 * np.pi, 37)
        ends = SPHERE[1]
        places = [np.full_like(u, v + s * 1.5 / m) for v, s in zip(ends, (1, -1), strict=True)]
        truth = [SHAPES[shape](u, v) @ ROTATION.T for v in places]
        gap = max(
            np.abs(spline.evaluate(u, v) - x).max() for v, x in zip(places, truth, strict=True)
        )
        tip = max(
            np.abs(spline.evaluate(0.0, v) - SHAPES[shape](0.0, v) @ ROTATION.T).max() for v in ends
        )
        errors.append((gap, tip))
    gaps, tips = np.array(errors).T
    assert (gaps[:-1] / gaps[1:] > 6.0).all()
    assert (tips[1:] <= np.maximum(tips[:-1] / 6.0, 1e-12)).all()


@covering(
    shape=SHAPES,
    rotation=[np.eye(3), ROTATION],
    cells=[(24, 24), (63, 64)],
    **{"shift, factor": [(0.0, 1.0), (1e6, 1.0), (0.0, 1e9), (1e6, 1e-9), (0.0, 1e-12)]},
)
def test_every_normal_counts_once(
    shape: str, rotation: Array, cells: tuple[int, int], shift: float, factor: float
):
    spline = gm.fit(moved(shape, rotation, shift, factor), cells)
    assert (gm.GaussMap(spline).degree(hard_normals(spline, 200, 3, 8)) == 1).all()


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_every_one_of_many_normals_counts_once(shape: str):
    spline = gm.fit(moved(shape, ROTATION, 1e9), (128, 128))
    assert (gm.GaussMap(spline).degree(hard_normals(spline, 20_000, 12, 36)) == 1).all()


@pytest.mark.parametrize("count", [24, 25])
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("ends", [(True, "pole"), (False, False)])
def test_poles_of_points(count: int, axis: int, ends: Any):
    """Also where a grid repeats its first points, and nobody says that it is closed."""
    repeats = ends == (False, False)
    u, v = np.arange(count + repeats) * (2 * np.pi / count), np.linspace(*SPHERE[1], 14)
    points = egg(u[:, None], v) @ ROTATION.T
    if axis == 0:
        points, ends = -points.swapaxes(0, 1), ends[::-1]
    spline = gm.fit(gm.Surface.from_grid(points, periodic=ends))
    found = (("periodic", "periodic"), ("pole", "pole"))
    assert spline.boundary == (found if axis == 1 else found[::-1])
    assert (gm.GaussMap(spline).degree(gm.fibonacci(500)) == 1).all()


# --- undeclared poles and apexes ------------------------------------------------------------------

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
