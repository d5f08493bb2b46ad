"""Tips of splines: a patch with a collapsed edge has no samples, and no row lies at a tip."""

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.spline.nets import AnySpline
from gaussmap.runtime.spline.poles import ring_around
from gaussmap.runtime.spline.tips import tips_of
from numpy.typing import NDArray

from ...products import covering
from ...shapes import Array, random_rotation, unit

HALF = np.pi / 3
TURN = random_rotation(5)
SHAPES = ("lemon", "ogive")
MOTIONS = {"identity": np.eye(3), "turned": TURN, "small": 1e-6 * TURN}


def grid(shape: str) -> Array:
    """Points of a lemon, with two tips, or of z = 1 − r − 0.3 r², with one."""
    columns, rows = (80, 61) if shape == "lemon" else (60, 50)
    u = (np.arange(columns) * 2 * np.pi / columns)[:, None]
    v = np.linspace(-HALF, HALF, rows) if shape == "lemon" else np.linspace(1.0, 0.0, rows)
    r, z = (2 * np.cos(v) - 1, 2 * np.sin(v)) if shape == "lemon" else (v, 1 - v - 0.3 * v * v)
    return np.stack([r * np.cos(u), r * np.sin(u), z + 0 * u], -1)


def counts(shape: str, n: Array) -> Array:
    """Return how many regular points have the unit normals, exactly."""
    if shape == "lemon":
        return (np.abs(n[:, 2]) < np.sin(HALF)).astype(int)
    with np.errstate(divide="ignore"):
        r = (np.hypot(n[:, 0], n[:, 1]) / n[:, 2] - 1) / 0.6
    return ((n[:, 2] > 0) & (r > 0) & (r < 1)).astype(int)


def tips(shape: str, matrix: Array) -> Array:
    points = grid(shape)
    ends = points[0, [0, -1]] if shape == "lemon" else points[0, -1:]
    return ends @ matrix.T


def made(shape: str, matrix: Array) -> gm.Surface:
    return gm.Surface.from_grid(grid(shape) @ matrix.T, periodic=(True, False))


def at_tips(points: Array, shape: str, matrix: Array) -> int:
    far = np.linalg.norm(points[:, None] - tips(shape, matrix), axis=2).min(axis=1, initial=np.inf)
    return int(np.count_nonzero(far <= 1e-9 * np.ptp(grid(shape) @ matrix.T, axis=(0, 1)).max()))


def regular(samples: gm.Samples) -> gm.Samples:
    """Return the samples without the tips."""
    return samples[samples.component == gm.Component.REGULAR]


def collapsed(spline: AnySpline) -> NDArray[np.bool_]:
    """Return the patches without samples."""
    found = tips_of(spline)
    return found.collapsed


def directions() -> Array:
    rng = np.random.default_rng(7)
    parts = [np.eye(3), -np.eye(3), gm.icosphere(8), [[1.3, 0, 1]], rng.normal(size=(500, 3))]
    return unit(np.concatenate(parts))


@covering(shape=SHAPES, motion=MOTIONS, nets=[False, True])
def test_points_are_those_of_the_surface(shape: str, motion: str, nets: bool) -> None:
    n, matrix = directions(), MOTIONS[motion]
    spline = gm.fit(made(shape, matrix))
    if nets:
        spline = gm.Spline.from_nets(spline.control_nets)
    turned = n @ (matrix / np.cbrt(np.linalg.det(matrix))).T
    samples = regular(gm.sample(spline, normals=turned))
    found = np.bincount(samples.normal_index, minlength=len(n))
    np.testing.assert_array_equal(found, counts(shape, n))
    assert not collapsed(spline)[samples.patch_index].any()


def normals_at_tips(spline: gm.Spline) -> Array:
    """Return normals, and nearly normals, of patches with an edge at a tip, and their opposites."""
    nets = spline.control_nets[collapsed(spline)]
    corner, left, right = (nets[:, k] for k in (0, 4, 5))  # the edge from b200 to b020 is a point
    n = unit(np.cross(left - corner, right - corner))
    near = n + 1e-12 * np.random.default_rng(3).normal(size=n.shape)
    return np.concatenate([n, -n, near, -near])


@covering(shape=SHAPES, nets=[False, True])
def test_normals_of_collapsed_patches_find_nothing_at_the_tip(shape: str, nets: bool) -> None:
    spline = gm.fit(made(shape, np.eye(3)))
    n = normals_at_tips(spline)
    if nets:
        spline = gm.Spline.from_nets(spline.control_nets)
    samples = regular(gm.GaussMap(spline).points(n))
    assert not collapsed(spline)[samples.patch_index].any()
    assert at_tips(samples.points, shape, np.eye(3)) == 0


@pytest.mark.parametrize("shape", SHAPES)
def test_everything_that_searches_leaves_tips_out(shape: str) -> None:
    surface = made(shape, np.eye(3))
    spline = gm.fit(surface)
    n = np.concatenate([normals_at_tips(spline), directions()])
    outline = gm.silhouette(spline, (1, 0, 0.9), count=200)
    streamed = regular(gm.Samples.concatenate(list(gm.sample_stream(spline, normals=n))))
    dense = gm.sample(spline, 500, density="gauss")
    sum_ = gm.convolve(spline, gm.SupportFunction.from_sympy("1/10"), n)
    for found in (outline, streamed, dense):
        assert len(found) > 0
        assert not collapsed(spline)[found.patch_index].any()
        assert at_tips(found.points, shape, np.eye(3)) == 0
    numbers = np.bincount(streamed.normal_index, minlength=len(n))
    np.testing.assert_array_equal(np.bincount(sum_.normal_index, minlength=len(n)), numbers)
    classes = gm.gauss_map.classify_patches(spline)[collapsed(spline)]
    assert set(classes.tolist()) <= {gm.gauss_map.PatchClass.DEVELOPABLE}


def test_smooth_poles_are_no_tips() -> None:
    spline = gm.fit("sphere", (16, 12))
    nets = gm.Spline.from_nets(spline.control_nets)
    assert tips_of(spline) is None
    assert tips_of(nets) is None
    poles = np.array([[0.0, 0, 1], [0, 0, -1]])
    np.testing.assert_array_equal(gm.GaussMap(spline).degree(poles), 1)


def test_a_spline_without_collapsed_sides_has_no_tips() -> None:
    assert tips_of(gm.fit("torus", (8, 8))) is None
    assert tips_of(gm.Spline.from_nets(gm.fit("plane", (4, 4)).control_nets)) is None


@pytest.mark.parametrize(("count", "error"), [(8, 1.6e-9), (64, 1.6e-9), (512, 4e-9)])
def test_a_ring_hardly_moves(count: int, error: float):
    """Its radius is 0.1: the mean of the largest errors of twenty planes."""
    rng, angles = np.random.default_rng(0), 2.0 * np.pi * np.arange(count) / count
    errors = []
    for _ in range(20):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]
        ring = 0.1 * np.stack([np.cos(angles), np.sin(angles)], axis=1) @ axes + (1.0, 0.3, 0.2)
        errors.append(np.abs(ring_around(ring)[0] - ring).max())
    assert np.mean(errors) < error
