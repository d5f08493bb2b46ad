"""Sets of normals: how many, how long, how even; and what a user brings."""

import sys
from itertools import combinations
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.directions.kernels.unit import are_unit
from gaussmap.runtime.directions.regions import angles_between
from gaussmap.runtime.directions.unit import as_normals, normalized
from hypothesis import given
from hypothesis import strategies as st

from ...products import covering
from ...refusals import refused
from ...shapes import AXES, EPS, Array

FREQUENCIES = [1, 2, 3, 5, 8, 16, 33]


def lengths(vectors):
    """Return lengths to more than double precision."""
    return np.sqrt((vectors.astype(np.longdouble) ** 2).sum(axis=1)).astype(float)


def nearest(normals):
    """Return, for each normal, the distance to the nearest other one."""
    cosines = normals @ normals.T
    np.fill_diagonal(cosines, -1.0)
    other = normals[cosines.argmax(axis=1)]
    return np.linalg.norm(normals - other, axis=1)


# --- icosphere ------------------------------------------------------------------------------------


@pytest.mark.parametrize("frequency", FREQUENCIES)
def test_icosphere_is_symmetric(frequency):
    """Under n → −n bitwise, and under the symmetries that exchange or mirror the axes."""
    normals = gm.icosphere(frequency) + 0.0  # no −0
    points = set(map(tuple, normals.tolist()))
    assert points == set(map(tuple, (0.0 - normals).tolist()))
    for axis in range(3):
        mirrored = normals.copy()
        mirrored[:, axis] = 0.0 - mirrored[:, axis]
        assert points == set(map(tuple, mirrored.tolist()))
    rounded = set(map(tuple, (normals.round(9) + 0.0).tolist()))
    turned = set(map(tuple, (np.roll(normals, 1, axis=1).round(9) + 0.0).tolist()))
    assert rounded == turned


def test_icosphere_begins_with_vertices_then_edges():
    normals = gm.icosphere(4)
    np.testing.assert_allclose(normals[:12], gm.icosphere(1), rtol=0, atol=2 * EPS)
    # on an edge, the planes of symmetry of the icosahedron: the mean of the ends, twice refined
    edge = gm.icosphere(2)[12:]
    assert len(edge) == 30
    corners = gm.icosphere(1)
    sums = corners[:, None] + corners
    middles = sums[np.abs(np.linalg.norm(sums, axis=-1) - 1.7013016167) < 1e-6]
    middles /= np.linalg.norm(middles, axis=1, keepdims=True)
    expected = {tuple(x) for x in (middles.round(9) + 0.0).tolist()}
    assert {tuple(x) for x in (edge.round(9) + 0.0).tolist()} == expected


MAKERS = [gm.icosphere, gm.fibonacci, gm.directions.healpix, gm.directions.random,
          gm.directions.circle]  # fmt: skip


@covering(make=MAKERS, number=[0, -1, 2.5, None, True])
def test_numbers_that_are_none(make, number):
    refused(r"must be a whole number of at least 1, not ", make, number)


@pytest.mark.parametrize("make", [gm.icosphere, gm.directions.healpix])
def test_refinements_that_no_memory_holds(make):
    refused(r"must be a whole number of at most 10,000, not 10001", make, 10_001)


# --- fibonacci ------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 10, 1000, 3000])
def test_fibonacci_counts_and_lengths(count):
    normals = gm.fibonacci(count)
    assert normals.shape == (count, 3)
    np.testing.assert_allclose(lengths(normals), 1.0, rtol=0, atol=2 * EPS)
    assert (np.diff(normals[:, 2]) < 0).all()
    assert len(np.unique(normals, axis=0)) == count


def test_fibonacci_gives_every_cap_its_share():
    count = 20_000
    normals, centres = gm.fibonacci(count), gm.icosphere(3)
    for cosine in (0.99, 0.9, 0.5, 0.0):
        share = (normals @ centres.T > cosine).mean(axis=0)
        np.testing.assert_allclose(share, (1 - cosine) / 2, rtol=0, atol=3 * count**-0.75)


def test_fibonacci_is_in_general_position():
    normals = gm.fibonacci(10_001)
    assert (normals == 0.0).any(axis=1).sum() <= 2  # k = 0 lies in the plane y = 0
    assert np.abs(np.diff(np.sort(np.abs(normals[1:, 1])))).min() > 0.0


# --- HEALPix --------------------------------------------------------------------------------------


@pytest.mark.parametrize("nside", [1, 2, 8, 32])
def test_healpix_lies_on_rings(nside):
    """z = 1 − i²/3N² in the caps, 4/3 − 2i/3N between them (Gorski et al. 2005, eqs. 4 and 8)."""
    normals = gm.directions.healpix(nside)
    assert normals.shape == (12 * nside**2, 3)
    assert normals.flags.c_contiguous
    np.testing.assert_allclose(lengths(normals), 1.0, rtol=0, atol=2 * EPS)
    ring = np.arange(1, 4 * nside)
    north = np.where(ring < nside, 1 - ring**2 / (3 * nside**2), 4 / 3 - 2 * ring / (3 * nside))[
        : 2 * nside
    ]
    heights = np.concatenate([north, -north[-2::-1]])
    counts = 4 * np.minimum(np.minimum(ring, 4 * nside - ring), nside)
    # where z is near 1 its rounding is that of the angle
    np.testing.assert_allclose(normals[:, 2], np.repeat(heights, counts), rtol=0, atol=8 * EPS)
    first = np.arctan2(*normals[:4, 1::-1].T)
    np.testing.assert_allclose(np.mod(first, 2 * np.pi), np.pi / 4 * np.array([1, 3, 5, 7]))


@pytest.mark.parametrize("nside", [3, 6, 100, 9999])
def test_healpix_is_refined_by_halving(nside):
    refused(f"nside must be a power of 2, not {nside}", gm.directions.healpix, nside)


def test_healpix_names_what_it_needs(monkeypatch):
    monkeypatch.setitem(sys.modules, "astropy_healpix", None)
    with pytest.raises(
        gm.errors.MissingExtraError, match=r'needs astropy-healpix.*"gaussmap\[spheres\]"'
    ):
        gm.directions.healpix(2)


# --- random ---------------------------------------------------------------------------------------


def test_random_normals_are_those_of_their_seed():
    normals = gm.directions.random(1000, seed=3)
    np.testing.assert_allclose(lengths(normals), 1.0, rtol=0, atol=2 * EPS)
    assert (gm.directions.random(1000, seed=3) == normals).all()
    assert (gm.directions.random(10, seed=3) == normals[:10]).all()
    assert (gm.directions.random(1000, seed=4) != normals).all()
    assert (gm.directions.random(5) == gm.directions.random(5, seed=0)).all()


def test_random_normals_are_uniform():
    """Archimedes: each coordinate is uniform in [−1, 1]; 5 σ of the mean and of the shares."""
    count = 100_000
    normals = gm.directions.random(count, seed=1)
    assert np.abs(normals.mean(axis=0)).max() < 5 / np.sqrt(3 * count)
    for axis in range(3):
        share = np.histogram(normals[:, axis], bins=10, range=(-1, 1))[0] / count
        assert np.abs(share - 0.1).max() < 5 * np.sqrt(0.09 / count)
    assert np.abs(normals.T @ normals / count - np.eye(3) / 3).max() < 5 / np.sqrt(5 * count)


@pytest.mark.parametrize("seed", [-1, 1.0, None, "3", True])
def test_seeds_that_are_none(seed):
    refused(r"seed must be a whole number of at least 0, not ", gm.directions.random, 5, seed=seed)


# --- as_normals -----------------------------------------------------------------------------------


@pytest.mark.parametrize("frequency", [1, 2, 3, 7, 64, pytest.param(200, marks=pytest.mark.slow)])
def test_points_stay_as_they_are(frequency: int) -> None:
    """`sample` takes them for unit vectors, and so sees that they are those of an icosahedron."""
    normals = gm.icosphere(frequency)
    assert as_normals(normals).tobytes() == normals.tobytes()
    assert len(np.unique(normals, axis=0)) == 10 * frequency**2 + 2


def test_extreme_directions():
    tiny, huge = 5e-324, np.finfo(float).max
    given_ = [[tiny, 0, 0], [0, -huge, 0], [huge, huge, huge], [tiny, tiny, 0], [huge, tiny, -huge]]
    third, half = 3**-0.5, 2**-0.5
    expected = [[1, 0, 0], [0, -1, 0], [third, third, third], [half, half, 0], [half, 0, -half]]
    np.testing.assert_allclose(as_normals(given_), expected, rtol=0, atol=2 * EPS)


def test_unit_normals_are_not_copied():
    normals = gm.fibonacci(5000)
    assert as_normals(normals) is normals
    for changed in (np.asfortranarray(normals), normals.astype(np.float32), normals[:, ::-1]):
        assert as_normals(changed) is not changed
    longer = normals.copy()
    longer[4321] *= 1 + 4 * EPS
    assert as_normals(longer) is not longer


def test_what_is_taken_for_unit_is_kept_when_it_is_normalized():
    rng = np.random.default_rng(2)
    near = gm.directions.random(20_000, seed=3)
    near = np.nextafter(near, near + rng.integers(-1, 2, near.shape))
    rows = np.split(near, len(near))
    taken = near[[as_normals(row) is row for row in rows]]
    assert 0 < len(taken) < len(near)
    assert normalized(taken) is taken


@given(st.lists(st.tuples(*[st.floats(-1e300, 1e300)] * 3).filter(any), min_size=1, max_size=20))
def test_any_direction(vectors):
    normals = as_normals(vectors)
    np.testing.assert_allclose(lengths(normals), 1.0, rtol=0, atol=2 * EPS)
    np.testing.assert_array_equal(as_normals(normals), normals)
    assert (np.sign(normals) * np.sign(vectors) >= 0).all()
    largest = np.abs(vectors).argmax(axis=1)
    assert (np.abs(normals)[np.arange(len(normals)), largest] >= 0.57).all()


def test_the_array_of_the_user_is_left_alone():
    directions = np.array([[3.0, 4.0, 0.0]])
    normals = as_normals(directions)
    normals[:] = 0.0
    assert directions.tolist() == [[3.0, 4.0, 0.0]]


@pytest.mark.parametrize(
    ("directions", "complaint"),
    [
        ([], r"must have the shape \(S, 3\) with S >= 1, not \(0,\)\.$"),
        (np.zeros((0, 3)), r"must have the shape \(S, 3\) with S >= 1, not \(0, 3\)\.$"),
        ([0, 0, 1], r"shape \(S, 3\) with S >= 1, not \(3,\); write \[normal\] for one\.$"),
        (np.ones((5, 4)), r"not \(5, 4\)\.$"),
        (np.ones((2, 3, 1)), r"not \(2, 3, 1\)\.$"),
        (5.0, r"not \(\)\.$"),
        ([[0, 0, 1], [0, 0, 0]], r"^normals\[1\] is the zero vector, which has no direction\.$"),
        ([[0.0, -0.0, 0.0]], r"^normals\[0\] is the zero vector"),
        ([[0, 0, 1], [0, 1, 0], [0, np.nan, 1]], r"^normals\[2\] holds NaN or infinity\.$"),
        ([[0, 0, np.inf]], r"^normals\[0\] holds NaN or infinity\.$"),
        ("up", "must be an array of real numbers"),
    ],
)
def test_directions_that_are_none(directions, complaint):
    sphere = gm.SupportFunction.from_sympy(1)
    image = gm.gauss_map.GaussianImage.of_patch(np.ones((6, 3)))
    for call in (
        *(as_normals, gm.directions.covering_radius, lambda n: gm.convolve(sphere, sphere, n)),
        lambda n: gm.sample(gm.surfaces.torus(), normals=n, cells=(4, 4)),
        *(sphere, sphere.branches, sphere.envelope, sphere.sheets, sphere.contains, image.contains),
    ):
        refused(complaint, call, directions)


# --- unit normals in the plane --------------------------------------------------------------------

COUNTS = [1, 2, 3, 4, 5, 6, 8, 12, 20, 100, 1001, 4096]


@pytest.mark.parametrize("count", COUNTS)
def test_angles(count):
    normals = gm.directions.circle(count)
    assert normals.shape == (count, 2)
    assert normals.flags.c_contiguous
    angle = 2 * np.pi * (np.arange(count) + 0.5) / count
    exact = np.column_stack([np.cos(angle), np.sin(angle)])
    np.testing.assert_allclose(normals, exact, rtol=0, atol=2e-15)  # ulps of 2π
    assert (as_normals(normals, 2) == normals).all()


@pytest.mark.parametrize("count", [x for x in COUNTS if x % 2 == 0])
def test_mirrored_bit_for_bit(count):
    normals = gm.directions.circle(count)
    points = set(map(tuple, normals.tolist()))
    assert len(points) == count
    mirrors = [normals * [1, -1], normals * [-1, 1]] + [normals[:, ::-1]] * (count % 4 == 0)
    for mirrored in mirrors:
        assert set(map(tuple, mirrored.tolist())) == points


# --- whether vectors have unit length -------------------------------------------------------------


@pytest.mark.kernels
def test_no_unit_vector():
    normals = gm.icosphere(2)
    for bad in (np.nan, np.inf, -2.0):
        spoilt = normals.copy()
        spoilt[7, 1] = bad
        assert not are_unit(spoilt, 0, len(spoilt))
        assert are_unit(spoilt, 0, 7)


# --- regions of the sphere ------------------------------------------------------------------------

NORMALS = gm.fibonacci(20_000)
OCTANT = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]


def shares(part: Any) -> float:
    return len(part) / len(NORMALS)


# --- angles ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [0.0, 1e-12, 1e-6, 1.0, 60.0, 90.0, 179.0, 180 - 1e-6])
def test_angles_are_accurate_near_0_and_180(degrees: float) -> None:
    t = np.radians(degrees)
    axis, other = np.array([0, 0, 1.0]), np.array([np.sin(t), 0, np.cos(t)])
    # an angle is known to the rounding of the coordinates, an ε of a radian
    assert abs(float(angles_between(other, axis)) - degrees) <= np.degrees(4 * 2.0**-52)


# --- caps -----------------------------------------------------------------------------------------


@covering(angle=[1.0, 30.0, 90.0, 150.0], axis=[[0, 0, 1], [-3, 0, 0], [1, 2, -3]])
def test_a_cap_has_its_share(angle: float, axis: Any) -> None:
    part = gm.directions.cap(NORMALS, axis, angle)
    cosines = part @ axis / np.linalg.norm(axis)
    assert cosines.min() >= np.cos(np.radians(angle)) - 1e-15
    area = (1 - np.cos(np.radians(angle))) / 2
    assert abs(shares(part) - area) < 3 * len(NORMALS) ** -0.75
    rest = gm.directions.cap(NORMALS, -np.asarray(axis), np.nextafter(180 - angle, 0))
    assert len(part) + len(rest) == len(NORMALS)


def test_a_cap_keeps_order_and_bits() -> None:
    part = gm.directions.cap(NORMALS, [0, 0, 1], 40)
    assert (part == NORMALS[: len(part)]).all()
    scaled = gm.directions.cap(8 * NORMALS, [0, 0, 1e-300], np.float64(40))
    assert (scaled == part).all()


def test_its_border_belongs_to_a_cap() -> None:
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    assert len(gm.directions.cap(axes, [0, 0, 1], 90)) == 5
    assert gm.directions.cap(axes, [0, 0, 1], 0).tolist() == [[0, 0, 1]]
    assert len(gm.directions.cap(axes, [0, 0, 1], 180)) == 6
    assert gm.directions.cap(axes, [1, 1, 1], 54).shape == (0, 3)
    assert len(gm.directions.cap(axes, [1, 1, 1], 55)) == 3


def test_a_small_cap_of_close_normals() -> None:
    t = np.array([0.5e-9, 1.5e-9])
    close = np.stack([np.sin(t), 0 * t, np.cos(t)], axis=1)
    assert len(gm.directions.cap(close, [0, 0, 1], np.degrees(1e-9))) == 1


@pytest.mark.parametrize("angle", [-1, 180.1, np.nan, np.inf, "30", None])
def test_angles_that_are_none(angle: Any) -> None:
    refused(r"^angle must", gm.directions.cap, NORMALS, [0, 0, 1], angle)


@pytest.mark.parametrize("axis", [[0, 0, 0], [0, np.nan, 1], [0, 1], "z"])
def test_axes_that_are_none(axis: Any) -> None:
    refused(r"^axis ", gm.directions.cap, NORMALS, axis, 30)


# --- polygons -------------------------------------------------------------------------------------


def test_an_octant() -> None:
    part = gm.directions.polygon(NORMALS, OCTANT)
    assert (part >= 0).all()
    assert len(part) == (NORMALS >= 0).all(axis=1).sum()


def test_the_faces_of_an_icosahedron_cover_the_sphere() -> None:
    corners = gm.icosphere(1)
    cosines = corners @ corners.T
    edges = np.abs(cosines - np.sort(cosines[0])[-2]) < 1e-12
    faces = [x for x in combinations(range(12), 3) if edges[np.ix_(x, x)].sum() == 6]
    assert len(faces) == 20
    parts = []
    for face in faces:
        triangle = corners[list(face)]
        turned = triangle if np.linalg.det(triangle) > 0 else triangle[::-1]
        parts.append(gm.directions.polygon(NORMALS, turned))
    assert len(np.concatenate(parts)) == len(NORMALS)
    assert len(np.unique(np.concatenate(parts), axis=0)) == len(NORMALS)


def test_corners_on_one_great_circle_bound_a_hemisphere() -> None:
    corners = [[1, 0, 0], [-1, 2, 0], [-1, -2, 0]]
    assert (gm.directions.polygon(NORMALS, corners)[:, 2] >= 0).all()
    assert len(gm.directions.polygon(NORMALS, corners)) == len(NORMALS) // 2


def test_its_corners_belong_to_a_polygon() -> None:
    triangle = gm.fibonacci(50)[[3, 20, 9]]
    turned = triangle if np.linalg.det(triangle) > 0 else triangle[::-1]
    inside = gm.directions.polygon(np.concatenate([turned, -turned]), turned)
    assert (inside == turned).all()
    assert gm.directions.polygon(-turned, turned).shape == (0, 3)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        (OCTANT[:2], "needs at least 3 corners, not 2"),
        (OCTANT[::-1], "anticlockwise"),
        ([[1, 0, 0], [1, 0, 0], [0, 1, 0]], "corners 0 and 1 are equal or opposite"),
        ([[1, 0, 0], [0, 1, 0], [-1, 0, 0]], "corners 2 and 0 are equal or opposite"),
        ([[2, 0, 1], [0.1, 0.1, 1], [0, 2, 1], [-2, -2, 1]], "convex"),  # with a notch
        ([[0, 0, 0], [0, 1, 0], [1, 0, 0]], "zero vector"),
        ([[np.nan, 0, 0], [0, 1, 0], [1, 0, 0]], "NaN"),
    ],
)
def test_corners_that_are_none(corners: Any, message: str) -> None:
    refused(message, gm.directions.polygon, NORMALS, corners)


# --- covering radius ------------------------------------------------------------------------------

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
TETRAHEDRON = CUBE[[0, 3, 5, 6]]
ACCURACY = 1e-12  # degrees: some ε of a radian, and coordinates that are rounded


def ring(colatitude: float, angles: Any) -> Array:
    t, c = np.radians(np.asarray(angles, float)), np.radians(colatitude)
    return np.stack([np.sin(c) * np.cos(t), np.sin(c) * np.sin(t), np.cos(c) + 0 * t], axis=1)


def nearest_angle(places: Array, normals: Array) -> Array:
    return angles_between(places[:, None], normals).min(axis=1)


def by_search(normals: Array) -> tuple[float, float]:
    """Return bounds of the radius in degrees, by branch and bound over the faces of a cube.

    Central projection of a face brings points no farther apart, and the distance to the nearest
    normal changes no faster than the place: so a square of the half-width w can only matter if the
    distance at its middle plus w√2 exceeds the best that was found.
    """
    face, s, t = (x.ravel() for x in np.meshgrid(np.arange(6), 0.0, 0.0, indexing="ij"))
    width, best, reach = 1.0, 0.0, 180.0
    while reach > 1e-3:
        flat = np.stack([s, t, np.ones_like(s)], axis=1)
        places = np.where(face % 2, 1.0, -1.0)[:, None] * flat
        places = np.take_along_axis(places, (np.arange(3) + face[:, None] // 2) % 3, axis=1)
        distances = nearest_angle(places / np.linalg.norm(places, axis=1, keepdims=True), normals)
        best, reach = max(best, float(distances.max())), float(np.degrees(width * np.sqrt(2)))
        kept = distances + reach > best
        width /= 2
        corners = [(i, j) for i in (-width, width) for j in (-width, width)]
        face = np.repeat(face[kept], 4)
        s, t = (
            (np.repeat(x[kept], 4).reshape(-1, 4) + [c[k] for c in corners]).ravel()
            for k, x in enumerate((s, t))
        )
    return best, best + reach


# --- exact cases ----------------------------------------------------------------------------------


def degrees(cosine: float) -> float:
    return float(np.degrees(np.arccos(cosine)))


EXACT: dict[str, tuple[Any, float]] = {
    "octahedron": (AXES, degrees(3**-0.5)),
    "cube": (CUBE, degrees(3**-0.5)),
    "tetrahedron": (TETRAHEDRON, degrees(1 / 3)),
    "icosahedron": (gm.icosphere(1), degrees(np.sqrt((5 + 2 * np.sqrt(5)) / 15))),
    "healpix": (gm.directions.healpix(1), degrees(2 / 3)),
    "one normal": ([[0, 3, 4]], 180.0),
    **{f"{x} degrees": (ring(90, [0, x]), 180 - x / 2) for x in (1e-6, 1.0, 90.0, 179.0, 180.0)},
}


@pytest.mark.parametrize("name", EXACT)
def test_exact_cases(name: str) -> None:
    normals, radius = EXACT[name]
    for repeated in (normals, np.concatenate([normals, 3 * np.asarray(normals)])):
        assert abs(gm.directions.covering_radius(repeated) - radius) < ACCURACY


# --- brute force ----------------------------------------------------------------------------------


def check(normals: Array) -> None:
    low, high = by_search(normals)
    assert low - 1e-9 <= gm.directions.covering_radius(normals) <= high + 1e-9


@given(
    count=st.integers(1, 30),
    seed=st.integers(0, 10**6),
    squeezed=st.sampled_from([1.0, 0.3, 0.01, 0.0]),
    shift=st.sampled_from([0.0, 0.5, 1.0, 3.0]),
)
def test_against_a_search(count: int, seed: int, squeezed: float, shift: float) -> None:
    """Random sets: all round, flat, on one side."""
    vectors = np.random.default_rng(seed).standard_normal((count, 3))
    vectors = vectors * [1, 1, squeezed] + [0, 0, shift]
    check(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


@pytest.mark.parametrize(
    "normals",
    [
        pytest.param(gm.fibonacci(500), marks=pytest.mark.slow),
        gm.directions.random(300),
        gm.directions.healpix(4),
    ],
)
def test_sets_against_a_search(normals: Array) -> None:
    check(normals)
