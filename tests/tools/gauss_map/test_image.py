"""Gaussian images: against definitions in exact arithmetic, quadrature, and topology."""

import gaussmap as gm
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ...nets import exact_place, exact_sign, net_of, normals_at, vectors_of
from ...products import covering
from ...refusals import refused
from ...shapes import Array

# Its normals fill an octant: e_x, e_y, e_z at the corners, and coordinate planes along the edges.
OCTANT = np.array([[2, 0, 0], [0, 2, 0], [0, 0, 2], [2, 2, 1], [2, 1, 2], [1, 2, 2]], dtype=float)
CYLINDER = np.array(
    [[1, 0, 1], [0, 1, 0], [0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0], [0, 0.5, 0]], dtype=float
)
PLANE = np.array([[4, 0, 8], [0, 4, 12], [0, 0, 0], [2, 2, 10], [2, 0, 4], [0, 2, 6]], dtype=float)
FOLDED_PLANE = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]], dtype=float
)
LINE = np.outer([2.0, 4.0, 0.0, 3.0, 1.0, 2.0], [1.0, 2.0, 3.0])


# D(N(u,v)) = (v + 2)² u: the edge u = 0 is a parabolic line.
BIANGLE = net_of([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 2, 0], [0, 1, 2])


def random_patch(seed: int, bend: float = 9.0) -> Array:
    """Return integer control points near the plane z = 0, farther from it for a larger bend."""
    flat = np.array([[8, 0, 0], [0, 8, 0], [0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 4, 0]], dtype=float)
    noise = np.random.default_rng(seed).integers(-9, 10, (6, 3))
    return np.round(8.0 * flat + bend * noise).astype(np.float64)


def measured(net: Array, corners: Array, order: int = 60) -> float:
    """Return the integral of dS over a triangle by Gauss-Legendre quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    x, y = (g.ravel() for g in np.meshgrid(0.5 + 0.5 * nodes, 0.5 + 0.5 * nodes))
    weight = np.outer(weights, weights).ravel() / 4.0 * (1.0 - y)
    barycentric = np.stack([x * (1.0 - y), y, (1.0 - x) * (1.0 - y)])
    u, v = (corners.T @ barycentric)[:2]
    area = abs(np.linalg.det(np.column_stack([corners, np.ones(3)])))
    vectors = vectors_of(net)
    N = normals_at(vectors, u, v).T
    A, B, C = (vectors[k] @ N for k in range(3))
    return float((weight * (A * C - B * B) / np.linalg.norm(N, axis=0) ** 3).sum() * area)


TRIANGLE = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])


# --- one patch ------------------------------------------------------------------------------------


def test_octant() -> None:
    image = gm.gauss_map.GaussianImage.of_patch(OCTANT)
    assert image.kind == "triangle"
    assert image.patch_class == gm.gauss_map.PatchClass.ELLIPTIC
    assert all(arc.is_great_circle and not arc.is_point for arc in image.arcs)
    assert image.solid_angle == pytest.approx(np.pi / 2, rel=1e-14)
    assert image.area == image.solid_angle
    inside = [[1, 1, 1], [1, 2, 3], [1e-12, 1, 1]]
    border = [[0, 1, 1], [1, 0, 3], [0, 0, 1], [1e-300, 1, 1]]
    outside = [[-1, -1, -1], [-1e-300, 1, 1], [1, 1, -1e-12], [0, 0, -1]]
    assert image.contains(inside + border).all()
    assert not image.contains(outside).any()
    forms = np.einsum("x,kxy,y->k", [1.0, 2.0, 3.0], image.cones, [1.0, 2.0, 3.0])
    assert (forms > 0).all() or (forms < 0).all()  # the normal is inside all cones


def test_arcs_are_the_normals_of_the_edges_and_lie_on_the_cones() -> None:
    for seed in range(20):
        net = random_patch(seed, 3.0)
        image = gm.gauss_map.GaussianImage.of_patch(net)
        vectors = vectors_of(net)
        share = np.linspace(0.0, 1.0, 9)
        edges = [(0 * share, 1 - share), (share, 0 * share), (1 - share, share)]
        for arc, cone, (u, v) in zip(image.arcs, image.cones, edges, strict=True):
            normals = normals_at(vectors, u, v)
            normals /= np.linalg.norm(normals, axis=1)[:, None]
            points = arc.points(9)
            np.testing.assert_allclose(points, normals, rtol=0, atol=1e-13)
            on_cone = np.einsum("kx,xy,ky->k", points, cone, points)
            assert np.abs(on_cone).max() <= 1e-13 * np.linalg.norm(cone)
            np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-15)


@pytest.mark.parametrize("seed", range(6))
def test_solid_angle_and_area_are_integrals_of_the_curvature(seed: int) -> None:
    """Nearly flat patches: there 60 × 60 nodes are exact up to rounding."""
    net = random_patch(seed, 1.5)
    image = gm.gauss_map.GaussianImage.of_patch(net)
    assert image.solid_angle == pytest.approx(measured(net, TRIANGLE), abs=1e-13)
    total = 0.0
    for piece in image.pieces:
        fan = [piece.corners[[0, k, k + 1]] for k in range(1, len(piece.corners) - 1)]
        value = sum(measured(net, triangle) for triangle in fan)
        assert np.sign(value) == piece.sign
        total += abs(value)
    assert image.area == pytest.approx(total, abs=1e-13)


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(4))
def test_area_is_the_share_of_the_sphere_that_it_contains(seed: int) -> None:
    """Wild patches, with singular points inside: 100 000 normals count the area to 1 %."""
    net = np.random.default_rng(seed).integers(-9, 10, (6, 3)).astype(float)
    image = gm.gauss_map.GaussianImage.of_patch(net)
    share = image.contains(gm.fibonacci(100_000)).mean()
    assert image.area == pytest.approx(4 * np.pi * share, abs=0.01)


# --- membership, exactly --------------------------------------------------------------------------


@given(
    seed=st.integers(0, 10**6),
    normals=st.lists(st.tuples(*[st.integers(-4, 4)] * 3), min_size=5, max_size=20),
)
def test_membership_is_that_of_the_definition(seed: int, normals: list) -> None:
    net = np.random.default_rng(seed).integers(-3, 4, (6, 3)).astype(float)
    asked = [n for n in normals if exact_sign(net, n)]
    if asked:
        found = gm.gauss_map.GaussianImage.of_patch(net).contains(asked)
        assert found.tolist() == [exact_place(net, n) is not None for n in asked]


def test_border_belongs_to_the_image_and_what_lies_beyond_does_not() -> None:
    """Normals on an edge of an integer patch, moved by one part in 2⁵⁰ along the gradient of V."""
    image = gm.gauss_map.GaussianImage.of_patch(2 * BIANGLE)
    normals = normals_at(vectors_of(2 * BIANGLE), np.array([0.25, 0.5, 0.75]), 0.0)
    assert image.contains(normals).all()
    away = normals @ image.cones[1]
    away /= np.abs(away).max(axis=1, keepdims=True)
    sides = [image.contains(normals + sign * 2.0**-50 * away) for sign in (1, -1)]
    assert (sides[0] != sides[1]).all()


def test_parabolic_line_inside_has_its_normal() -> None:
    """Moved to u = −½ … ½ the patch has the line u = 0 inside: all of it has the normal e_x."""
    a, b, c, d, e = np.eye(3)[0], np.eye(3)[1], np.eye(3)[2], [0, 2, 0], [0, 1, 2]
    moved = net_of(4 * a, 4 * b, 4 * c, 2 * (np.array(d) - a), 2 * (np.array(e) - b))
    image = gm.gauss_map.GaussianImage.of_patch(moved)
    assert image.kind == "bow tie"
    assert image.contains([[1, 0, 0]]).all()
    assert not image.contains([[-1, 0, 0], [0, 1, 0]]).any()


# --- degenerate images ----------------------------------------------------------------------------


def test_biangle() -> None:
    image = gm.gauss_map.GaussianImage.of_patch(BIANGLE)
    assert image.kind == "biangle"
    assert [arc.is_point for arc in image.arcs] == [True, False, False]
    np.testing.assert_allclose(image.arcs[0].points(5), np.tile([1.0, 0.0, 0.0], (5, 1)))
    assert image.area == pytest.approx(measured(BIANGLE, TRIANGLE), abs=1e-12)
    assert image.contains([[1, 0, 0]]).all()


def test_developable_patch_is_an_arc() -> None:
    image = gm.gauss_map.GaussianImage.of_patch(CYLINDER)
    assert (image.kind, image.patch_class) == ("arc", gm.gauss_map.PatchClass.DEVELOPABLE)
    assert image.solid_angle == image.area == 0.0
    assert all(arc.is_great_circle for arc in image.arcs)
    np.testing.assert_array_equal(
        image.contains([[0, 0, 1], [-1, 0, 1], [-2, 0, 1], [-3, 0, 1], [1, 0, 1], [-1, 1e-9, 1]]),
        [True, True, True, False, False, False],
    )


def test_plane_is_a_point() -> None:
    image = gm.gauss_map.GaussianImage.of_patch(PLANE)
    assert (image.kind, image.patch_class, image.area) == (
        "point",
        gm.gauss_map.PatchClass.PLANAR,
        0.0,
    )
    assert all(arc.is_point and arc.is_great_circle for arc in image.arcs)
    asked = [[-2, -3, 1], [-4, -6, 2], [2, 3, -1], [-2, -3, 1 + 1e-15]]
    assert image.contains(asked).tolist() == [True, True, False, False]
    folded = gm.gauss_map.GaussianImage.of_patch(FOLDED_PLANE)
    assert folded.kind == "point"
    assert folded.boundary == ()  # its normals jump, but through no others
    assert folded.contains([[0, 0, 1], [0, 0, -1], [0, 1, 1]]).tolist() == [True, True, False]


@pytest.mark.parametrize("net", [LINE, np.zeros((6, 3)), np.ones((6, 3))])
def test_what_has_no_normals_is_empty(net: Array) -> None:
    image = gm.gauss_map.GaussianImage.of_patch(net)
    assert (image.kind, image.patch_class) == ("empty", gm.gauss_map.PatchClass.SINGULAR)
    assert image.solid_angle == image.area == 0.0
    assert not image.contains([[1, 0, 0], [3, -2, 1]]).any()
    assert np.isnan(image.arcs[0].points(3)).all()


@pytest.mark.compiled
def test_singular_corner_adds_a_side() -> None:
    """With p_u and p_v parallel at a corner, the normals near it fill part of a great circle."""
    net = net_of([2, 3, -1], [1, 3, 1], [2, 1, 1], [1, 0, 0], [2, 0, 0])
    image = gm.gauss_map.GaussianImage.of_patch(net)
    assert image.kind == "polygon"
    share = image.contains(gm.fibonacci(200_000)).mean()
    assert image.area == pytest.approx(4 * np.pi * share, abs=0.005)
    ends = image.arcs[0].points(5)[-1], image.arcs[1].points(5)[0]
    assert np.isfinite(ends).all()
    assert np.abs(np.array(ends)[:, 0]).max() == 0.0  # perpendicular to both tangents
    assert np.linalg.norm(ends[0] - ends[1]) > 0.1


@pytest.mark.compiled
def test_images_at_a_pole() -> None:
    """One triangle of a cell has a whole edge in the pole, two have one corner there."""
    images = gm.gauss_map.GaussianImages.of_spline(gm.surfaces.sphere(), (8, 6))
    cell = 5  # the northernmost one for the first step of u
    kinds = [images[4 * cell + turn].kind for turn in range(4)]
    assert kinds == ["triangle", "triangle", "arc", "triangle"]
    for turn in range(1, 4):
        points = np.concatenate([arc.points(5) for arc in images[4 * cell + turn].arcs])
        assert np.abs(points - [0, 0, 1]).max(axis=1).min() < 1e-15


def test_developable_patch_with_a_curve_of_singular_points_is_an_arc() -> None:
    image = gm.gauss_map.GaussianImage.of_patch(
        net_of([-1, 0, -1], [0, -2, 2], [-3, -1, -2], [1, 0, 0], [2, 0, 0])
    )
    assert (image.kind, image.area) == ("arc", 0.0)
    assert not image.contains(gm.fibonacci(5000)).any()


@pytest.mark.compiled
@pytest.mark.parametrize("factor", [1e-150, 1e100])
def test_scale_does_not_matter(factor: float) -> None:
    for seed in range(5):
        net = random_patch(seed)
        image, other = (gm.gauss_map.GaussianImage.of_patch(x) for x in (net, net * factor))
        assert image.kind == other.kind
        assert other.area == pytest.approx(image.area, rel=1e-11)
        normals = gm.fibonacci(500)
        assert (image.contains(normals) == other.contains(normals)).all()


def test_translation_costs_only_its_rounding() -> None:
    for net, kind in ((OCTANT, "triangle"), (CYLINDER, "arc"), (PLANE, "point")):
        moved = net / 3.0 + 1e6
        image = gm.gauss_map.GaussianImage.of_patch(moved)
        assert image.kind == kind
        assert image.area == pytest.approx(gm.gauss_map.GaussianImage.of_patch(net).area, abs=1e-8)
    assert all(
        arc.is_great_circle for arc in gm.gauss_map.GaussianImage.of_patch(OCTANT / 3 + 1e6).arcs
    )


# --- all patches of a spline ----------------------------------------------------------------------


@pytest.mark.compiled
def test_torus_covers_the_sphere_twice() -> None:
    """Where cells end at the parabolic circles no patch is mixed, and each half covers 4π."""
    images = gm.gauss_map.GaussianImages.of_spline(gm.surfaces.torus(), (32, 32))
    elliptic = images.patch_classes == gm.gauss_map.PatchClass.ELLIPTIC
    assert images.solid_angles[elliptic].sum() == pytest.approx(4 * np.pi, abs=1e-11)
    assert images.solid_angles[~elliptic].sum() == pytest.approx(-4 * np.pi, abs=1e-11)
    assert images.areas.sum() == pytest.approx(8 * np.pi, abs=1e-11)
    assert len(images) == len(images.areas) == images.spline.patches


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["wavy_graph", "moebius_band"])
def test_points_are_in_the_images_that_contain_their_normal(name: str) -> None:
    images = gm.gauss_map.GaussianImages.of_spline(gm.surfaces.surface(name), (4, 3))
    normals = gm.fibonacci(1500) + np.array([0.01, 0.02, 0.03])  # no tie with a symmetry
    count = np.sum([image.contains(normals) for image in images], axis=0)
    np.testing.assert_array_equal(gm.GaussMap(images.spline).count(normals), count)
    assert count.max() > 1


@pytest.mark.slow
def test_solid_angles_of_a_spline_are_those_of_its_patches() -> None:
    images = gm.gauss_map.GaussianImages.of_spline(gm.surfaces.dupin_cyclide(), (8, 6))
    single = np.array([(x.solid_angle, x.area) for x in images])
    np.testing.assert_allclose(images.solid_angles, single[:, 0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(images.areas, single[:, 1], rtol=0, atol=1e-12)


@pytest.mark.compiled
def test_quadrature_of_the_sampler_agrees() -> None:
    """`Spline.measure` uses three nodes a patch: its error falls with the size of the cells."""
    errors = []
    for cells in (16, 32):
        spline = gm.fit(gm.surfaces.ellipsoid_patch(), (cells, cells))
        exact = gm.gauss_map.GaussianImages.of_spline(spline).solid_angles
        errors.append(np.abs(spline.measure[1] - exact).max() / exact.max())
    assert errors[1] < 0.35 * errors[0] < 0.01


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "points",
    [
        [], OCTANT[:5], np.zeros((6, 2)), np.zeros((2, 6, 3)), "abc", None, 5,
        np.where(np.eye(6, 3) > 0, np.nan, OCTANT), np.full((6, 3), np.inf), OCTANT * 1j,
        OCTANT * 1e305,
    ],
)  # fmt: skip
def test_bad_control_points(points) -> None:
    for call in (
        gm.gauss_map.GaussianImage.of_patch,
        gm.gauss_map.parabolic_lines,
        gm.gauss_map.split_patch,
    ):
        refused("control_points", call, points)


def test_other_bad_input() -> None:
    spline = gm.fit(gm.surfaces.torus(), (4, 4))
    images = gm.gauss_map.GaussianImages.of_spline(spline)
    refused("cells", gm.gauss_map.GaussianImages.of_spline, spline, (4, 4))
    refused("Surface", gm.gauss_map.GaussianImages.of_spline, 5)
    square = gm.surfaces.torus().trimmed([[(1, 1), (2, 1), (2, 2), (1, 2)]])
    refused("of whole patches", gm.gauss_map.GaussianImages.of_spline, square)
    with pytest.raises(IndexError):
        images[len(images)]
    for count in (1, 0, 2.5, None):
        arc = gm.gauss_map.GaussianImage.of_patch(OCTANT).arcs[0]
        refused("count must be a whole number of at least 2", arc.points, count)


def test_a_double_parabolic_line_inside_pinches_the_image() -> None:
    points = [
        [1, 0, 0.2], [-0.3, 1, 0], [0, 0, 0], [0.85, 0.5, -0.15], [0.5, 0, -0.15], [-0.15, 0.5, 0]
    ]  # fmt: skip
    image = gm.gauss_map.GaussianImage.of_patch(points)
    assert [piece.sign for piece in image.pieces] == [-1, -1]
    assert image.kind == "bow tie"


# --- singular points inside an edge ---------------------------------------------------------------

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
