"""Singular points inside an edge: the boundary of the Gaussian image is cut there."""

import gaussmap as gm
import numpy as np
import pytest

from ...nets import normals_at, vectors_of
from ...products import covering
from ...shapes import Array

# Control points, the edge (u, v or w = 0), the zeros along it, the kind of the image, its sides.
CASES = {
    # All normals of the edge are parallel, and jump once: the other edges and half a circle.
    "umbrella": (
        [[10, 0, 0], [0, 10, -3], [0, 0, 0], [5, 0, 3.5], [5, 0, 0], [0, 0, -1.5]],
        1, [0.3], "triangle", 3,
    ),
    "generic": (
        [[-2, 0, 1], [0, 0, -1], [-2, 0, 1], [0, 1, 2], [-1, -2, -1], [-1, 1, -2]],
        1, [1 / 2], "polygon", 5,
    ),
    "line inside": (
        [[-1, 1, 0], [-1, -2, 0], [0, 0, -2], [-1, -2, 0], [-2, 2, 2], [0, 2, 2]],
        1, [2 / 3], "bow tie", 6,
    ),
    # Two zeros: the normals are n, -n and n again.
    "two": (
        [[2, 0, -2], [2, 0, -2], [0, 0, -2], [0, 1, 1], [-1, 2, 2], [0, 0, 2]],
        2, [1 / 3, 1 / 2], "bow tie", 4,
    ),
    # The derivative of N has the rank 1: the second order decides through where the normals turn.
    "second order": (
        [[-1, -2, 1], [-2, -1, 1], [-2, -1, 1], [0, -2, -1], [-1, -2, -1], [2, -2, -1]],
        0, [1 / 2], "bow tie", 3,
    ),
    # In that direction the second order is parallel, too.
    "third order": (
        [[2, -1, 1], [-2, 1, -2], [2, 2, 0], [-2, -1, -2], [2, 2, -1], [2, 1, -1]],
        0, [2 / 3], "bow tie", 5,
    ),
}  # fmt: skip


# Places (u, v) along the edges u = 0, v = 0 and w = 0.
ON_EDGES = (lambda t: (0 * t, 1 - t), lambda t: (t, 0 * t), lambda t: (1 - t, t))


def field(net: Array, u: Array, v: Array) -> Array:
    """Return the unit normals (k, 3) at places u, v (k,)."""
    N = normals_at(vectors_of(net), u, v)
    return N / np.linalg.norm(N, axis=1, keepdims=True)


def of_polygon(points: Array, pole: Array) -> float:
    """Return the sum of the signed areas of the triangles of a pole and each side of a polygon."""
    after = np.roll(points, -1, axis=0)
    volume = np.cross(points, after) @ pole
    below = 1.0 + points @ pole + after @ pole + np.einsum("kx,kx->k", points, after)
    return float(2.0 * np.arctan2(volume, below).sum())


@pytest.mark.parametrize("name", CASES)
def test_an_edge_is_cut_at_its_singular_points(name: str) -> None:
    """Parts are sampled along the edge, between these; rounding is divided by |N| > 1e-3."""
    points, edge, zeros, kind, sides = CASES[name]
    net = np.array(points, dtype=float)
    image = gm.gauss_map.GaussianImage.of_patch(points)
    assert image.kind == kind
    assert len(image.boundary) == sides
    assert [len(x.singular_points) for x in image.arcs] == [
        len(zeros) if k == edge else 0 for k in range(3)
    ]
    np.testing.assert_allclose(image.arcs[edge].singular_points, zeros, rtol=0, atol=1e-13)
    parts = image.arcs[edge].parts
    for part, start, end in zip(parts, [0.0, *zeros], [*zeros, 1.0], strict=True):
        along = part.points(11)
        inner = np.linspace(start, end, 11)[1:-1]
        expected = field(net, *ON_EDGES[edge](inner))
        np.testing.assert_allclose(along[1:-1], expected, rtol=0, atol=1e-11)
        near_ends = np.array([start + 1e-9, end - 1e-9])
        expected = field(net, *ON_EDGES[edge](near_ends))
        np.testing.assert_allclose(along[[0, -1]], expected, rtol=0, atol=1e-6)


@pytest.mark.compiled
@pytest.mark.parametrize("name", CASES)
@pytest.mark.quick_for("two", "third order", "line inside", "umbrella", "generic")
def test_the_boundary_is_closed_and_has_the_solid_angle_and_area(name: str) -> None:
    """A polygon of chords of length 1/n misses areas of order 1/n².

    In the third order a triple parabolic line ends in the singular point: a triple root, which is
    known to the cube root of 2⁻⁵² only, 6e-6.
    """
    image = gm.gauss_map.GaussianImage.of_patch(CASES[name][0])
    curves = [arc.points(4001) for arc in image.boundary]
    for before, after in zip(curves, curves[1:] + curves[:1], strict=True):
        np.testing.assert_allclose(before[-1], after[0], rtol=0, atol=1e-12)
    pole = np.array([0.36, 0.48, 0.8])
    error = of_polygon(np.concatenate(curves), pole) - image.solid_angle
    assert np.remainder(error + 1.0, 4 * np.pi) - 1.0 == pytest.approx(
        0.0, abs=2e-5 if name == "third order" else 1e-5
    )
    share = image.contains(gm.fibonacci(100_000)).mean()
    assert image.area == pytest.approx(4 * np.pi * share, abs=0.01)


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["umbrella", "generic", "line inside"])
def test_normals_round_a_singular_point_turn_through_half_a_great_circle(name: str) -> None:
    """Sampled on a half circle round it, of radius 1e-7; one side of the arc is in the image."""
    points, _, zeros, _, _ = CASES[name]
    net = np.array(points, dtype=float)
    image = gm.gauss_map.GaussianImage.of_patch(net)
    halves = [x for x in image.boundary if np.linalg.norm(x.points(2).sum(axis=0)) < 1e-12]
    assert len(halves) == 1
    assert halves[0].is_great_circle
    along = halves[0].points(20_001)
    angle = np.linspace(0.0, np.pi, 41)[1:-1]
    round_it = field(net, zeros[0] - 1e-7 * np.cos(angle), 1e-7 * np.sin(angle))
    distance = np.linalg.norm(round_it[:, None] - along, axis=2)
    assert distance.min(axis=1).max() < 1e-3  # half the distance of points, and of order 1e-7
    assert (np.diff(distance.argmin(axis=1)) > 0).all()
    middle = along[2000:-2000:500]
    across = 1e-5 * np.cross(along[0], along[10_000])
    sides = [image.contains(middle + sign * across) for sign in (1, -1)]
    assert (sides[0] != sides[1]).all()


def test_integer_normals_of_a_cut_edge_are_members() -> None:
    """Exact normals of the edge v = 0 at u = 1/8, …, 7/8; at 1/2 it has none."""
    net = np.array(CASES["generic"][0], dtype=float)
    image = gm.gauss_map.GaussianImage.of_patch(net)
    normals = normals_at(vectors_of(net), np.array([1, 2, 3, 5, 6, 7]) / 8, 0.0)
    assert image.contains(normals).all()
    assert not image.contains(-normals).any()


@covering(factor=[1e-12, 1e12], name=CASES)
def test_scale_and_rotation_do_not_matter_for_the_cuts(name: str, factor: float) -> None:
    """Rotated, the zeros hold up to rounding only, and so does what decides the second order."""
    points, edge, zeros, kind, sides = CASES[name]
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    image = gm.gauss_map.GaussianImage.of_patch(factor * np.array(points) @ turn.T)
    assert (image.kind, len(image.boundary)) == (kind, sides)
    np.testing.assert_allclose(image.arcs[edge].singular_points, zeros, rtol=0, atol=1e-7)
    original = gm.gauss_map.GaussianImage.of_patch(points).boundary
    for mine, other in zip(image.boundary, original, strict=True):
        np.testing.assert_allclose(mine.points(9), other.points(9) @ turn.T, rtol=0, atol=1e-6)


def test_arcs_without_a_singular_point_inside() -> None:
    octant = [[2, 0, 0], [0, 2, 0], [0, 0, 2], [2, 2, 1], [2, 1, 2], [1, 2, 2]]
    image = gm.gauss_map.GaussianImage.of_patch(octant)
    assert len(image.boundary) == 3
    for arc, side in zip(image.arcs, image.boundary, strict=True):
        assert arc.singular_points == ()
        assert arc.parts == (arc,)
        np.testing.assert_array_equal(side.control_normals, arc.control_normals)


def test_a_double_zero_is_one_singular_point_without_a_jump() -> None:
    """(t − 0.3)² n: rounding may leave a negative discriminant."""
    normal = np.array([1.0, 2.0, 3.0])
    arc = gm.gauss_map.BoundaryArc(np.outer([0.09, -0.21, 0.49], normal), 1e-15)
    assert arc.singular_points == pytest.approx((0.3,), abs=1e-7)
    for part in arc.parts:
        np.testing.assert_allclose(part.points(3), np.tile(normal, (3, 1)) / np.sqrt(14), atol=1e-7)
