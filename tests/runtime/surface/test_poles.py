"""Poles: the spline has one normal there, and every normal of a closed surface once."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from numpy.typing import ArrayLike

from ...nets import in_fractions
from ...products import covering
from ...shapes import Array, egg, on_sphere, random_rotation

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
