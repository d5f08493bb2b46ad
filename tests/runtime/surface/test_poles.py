"""Poles: the spline has one normal there, and every normal of a closed surface once."""

from fractions import Fraction

import gaussmap as gm
import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from ...products import covering
from ...shapes import egg, on_sphere

Array = NDArray[np.float64]
SPHERE = (0.0, 2 * np.pi), (-np.pi / 2, np.pi / 2)
# A rotation without zeros: no plane of symmetry of a surface is one of the coordinates.
ROTATION = np.linalg.qr(np.array([[0.7, 0.3, -0.5], [0.2, 0.8, 0.6], [-0.4, 0.5, 0.9]]))[0]
ROTATION *= np.linalg.det(ROTATION)


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


def pole_offsets(spline: gm.Spline, end: int) -> list[list[Fraction]]:
    """Return, exactly, how the first ring of coefficients differs from the ghosts at an end of v.

    They are twice the differences from the pole.
    """
    inner, outer = ((1, 0), (-2, -1))[end]
    pairs = zip(
        spline.coefficients[1:-1, inner].tolist(), spline.coefficients[1:-1, outer].tolist(),
        strict=True,
    )  # fmt: skip
    return [[Fraction(x) - Fraction(y) for x, y in zip(*pair, strict=True)] for pair in pairs]


def cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def pole_normal(spline: gm.Spline, end: int) -> Array:
    """Return the normal at a pole, of about unit length; it is exact up to rounding."""
    offsets = pole_offsets(spline, end)
    a, b = ([x + y for x, y in zip(offsets[k], offsets[k + 1], strict=True)] for k in (0, 1))
    normal = cross(a, b)
    largest = max(map(abs, normal))
    return np.array([float(x / largest) for x in normal])


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
        offsets = pole_offsets(spline, end)
        normal = cross(offsets[0], offsets[1])
        assert any(normal)
        assert not any(
            sum(x * y for x, y in zip(normal, offset, strict=True)) for offset in offsets
        )


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
def test_poles_of_points(count: int, axis: int):
    u, v = np.arange(count) * (2 * np.pi / count), np.linspace(*SPHERE[1], 14)
    points = egg(u[:, None], v) @ ROTATION.T
    ends = (True, "pole")
    if axis == 0:
        points, ends = -points.swapaxes(0, 1), ends[::-1]
    spline = gm.fit(gm.Surface.from_grid(points, periodic=ends))
    assert (gm.GaussMap(spline).degree(gm.fibonacci(500)) == 1).all()
