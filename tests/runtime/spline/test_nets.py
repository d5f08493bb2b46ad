"""Splines of users' own nets: joints, and every point with a normal exactly once."""

import pickle

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.spline.joints import EDGES
from gaussmap.runtime.spline.nets import NetSpline
from gaussmap.tools.meshes.creased import CreasedMesh
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from ...nets import bezier, by_brute_force, in_fractions
from ...refusals import refused
from ...shapes import Array, unit

SYMMETRIC = np.array([x for x in np.ndindex(5, 5, 5) if x != (2, 2, 2)]) - 2.0


def octants() -> tuple[Array, NDArray[np.int64]]:
    """Return points and triangles of a closed spline of 8 patches, with continuous normals."""
    points, triangles = list[tuple[int, ...]](), list[list[int]]()

    def number(point: Array) -> int:
        key = tuple(int(x) for x in point)
        if key not in points:
            points.append(key)
        return points.index(key)

    net = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)])
    for signs in np.ndindex(2, 2, 2):
        flip = 1 - 2 * np.array(signs)
        rows = [0, 1, 2, 3, 4, 5] if flip.prod() > 0 else [1, 0, 2, 3, 5, 4]
        triangles.append([number(p) for p in (net * flip)[rows]])
    return np.array(points, dtype=np.float64), np.array(triangles)


def powell_sabin(count: int, seed: int, bumps: float) -> Array:
    """Return the nets (6 T, 6, 3) of a Powell-Sabin spline over random points of a square."""
    random = np.random.default_rng(seed)
    square = np.array([(x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    places = np.concatenate([square, random.uniform(-0.9, 0.9, (count, 2))])

    def value(x: float, y: float) -> tuple[Array, Array]:
        f = np.array([x + 0.1 * x * y, y - 0.1 * x * x, x * x + y * y + bumps * np.sin(3 * x * y)])
        c = 3 * bumps * np.cos(3 * x * y)
        return f, np.array([[1 + 0.1 * y, 0.1 * x], [-0.2 * x, 1], [2 * x + c * y, 2 * y + c * x]])

    mesh = Delaunay(places)
    centres = []
    for corners in places[mesh.simplices]:
        sides = [np.linalg.norm(corners[(k + 1) % 3] - corners[(k + 2) % 3]) for k in range(3)]
        centres.append(np.average(corners, axis=0, weights=sides))
    nets = []
    for t, (corners, others) in enumerate(zip(mesh.simplices, mesh.neighbors, strict=True)):
        Z, bars = centres[t], np.linalg.inv(np.c_[places[corners], np.ones(3)].T)
        towards = {i: _towards(value, places[i], Z) for i in corners}
        middle = sum(b * towards[i] for b, i in zip(bars @ [*Z, 1.0], corners, strict=True))
        for k in range(3):
            i, j = corners[(k + 1) % 3], corners[(k + 2) % 3]
            share = 0.5 if others[k] < 0 else _crossing(places[i], places[j], Z, centres[others[k]])
            R = (1 - share) * places[i] + share * places[j]
            at_i, at_j = _towards(value, places[i], R), _towards(value, places[j], R)
            on_edge = (1 - share) * at_i + share * at_j
            inner = (1 - share) * towards[i] + share * towards[j]
            f_i, f_j = value(*places[i])[0], value(*places[j])[0]
            nets.append([f_i, on_edge, middle, at_i, towards[i], inner])
            nets.append([on_edge, f_j, middle, at_j, inner, towards[j]])
    return np.array(nets)


def _towards(value, place: Array, other: Array) -> Array:
    f, gradient = value(*place)
    return f + 0.5 * gradient @ (other - place)


def _crossing(p: Array, q: Array, a: Array, b: Array) -> float:
    return float(np.linalg.solve(np.column_stack([q - p, a - b]), a - p)[0])


def check_brute_force(spline: NetSpline, normals: Array) -> None:
    """Compare patches and signs of all points with those of fractions; no normal is on a joint."""
    found = gm.sample(spline, normals=normals)
    rows = [found.normal_index, found.patch_index, np.sign(found.gaussian_curvature)]
    points = np.stack(rows, axis=1).astype(int)
    assert sorted(map(tuple, points.tolist())) == by_brute_force(
        in_fractions(spline.control_nets), in_fractions(normals)
    )


def normals_on_joints(spline: NetSpline) -> Array:
    """Return unit normals at places of all joints and at their ends, as rounded."""
    found = []
    for patch, edge in zip(spline.joints.patches[:, 0], spline.joints.edges[:, 0], strict=True):
        start, middle, end, beside, end_beside = spline.control_nets[patch][list(EDGES[edge])]
        for t in (0.0, 0.25, 0.5, 0.7, 1.0):
            along = (1 - t) * (middle - start) + t * (end - middle)
            across = (1 - t) * (beside - start) + t * (end_beside - middle)
            found.append(np.cross(along, across))
    lengths = np.linalg.norm(found, axis=1, keepdims=True)
    return np.array(found)[lengths[:, 0] > 1e-12] / lengths[lengths[:, 0] > 1e-12]


def test_closed_spline_of_8_patches() -> None:
    """Eight octants of a closed surface; its joints are creases, whose angle is known."""
    points, triangles = octants()
    spline = gm.Spline.from_nets(points, triangles, name="octants")
    joints = spline.joints
    assert joints.patches.shape == (12, 2)
    assert np.bincount(joints.patches.ravel()).tolist() == [3] * 8
    assert not joints.smooth.any()
    # Half-way along an edge the normal is (1, 1, 1) x's largest tilt out of the plane of symmetry.
    assert np.allclose(joints.angles, 2.0 * np.degrees(np.arctan(np.sqrt(0.125))), atol=1e-9)
    normals = gm.directions.random(200, seed=1)
    check_brute_force(spline, normals)


@pytest.mark.parametrize("bumps", [0.0, 0.15, 0.6])
@pytest.mark.quick_for("0.15")
def test_powell_sabin_spline(bumps: float) -> None:
    nets = powell_sabin(12, 3, bumps)
    spline = gm.Spline.from_nets(nets, name="Powell-Sabin")
    assert spline.joints.smooth.all()
    assert spline.joints.angles.max() < 1e-9
    normals = gm.directions.random(30, seed=2) * [0.6, 0.6, 1.0]
    normals[:, 2] = np.abs(normals[:, 2]) + 0.2
    check_brute_force(spline, normals)


@pytest.mark.parametrize("bumps", [0.0, 0.15, 0.6])
@pytest.mark.quick_for("0.15")
def test_normals_on_joints_and_at_corners(bumps: float) -> None:
    """They have what normals next to them have: Σ sign K does not change at folds either."""
    nets = powell_sabin(30, 3, bumps)
    spline = gm.Spline.from_nets(nets)
    normals = normals_on_joints(spline)
    known = gm.GaussMap(spline)
    degree = known.degree(normals)
    around = np.array([
        known.degree(normals + 1e-6 * np.array(step))
        for step in ((1.0, 0.1, 0.2), (-0.6, 0.8, 0.1), (-0.4, -0.9, 0.1), (0.3, -0.8, -0.4))
    ])  # fmt: skip
    away = (around == around[0]).all(axis=0)  # from the border of the square
    assert away.mean() > 0.8
    assert (degree[away] == around[0, away]).all()


@pytest.mark.parametrize(("name", "degree"), [("sphere", 1), ("torus", 0), ("ellipsoid", 1)])
@pytest.mark.quick_for("torus")
def test_normals_of_a_closed_spline(name: str, degree: int) -> None:
    spline = gm.Spline.from_nets(gm.fit(name, (8, 6)).control_nets, name=name)
    normals = unit(np.concatenate([normals_on_joints(spline), gm.icosphere(12), SYMMETRIC]))
    assert (gm.GaussMap(spline).degree(normals) == degree).all()


@pytest.mark.parametrize("cells", [(8, 6), (24, 17), (32, 32)])
@pytest.mark.parametrize("away", [0.0, 1e6])
def test_normals_of_a_circle(cells: tuple[int, int], away: float) -> None:
    """The circles at the top and the bottom of a torus have one normal each."""
    c, s = np.cos(0.7), np.sin(0.7)
    nets, axis = gm.fit("torus", cells).control_nets, np.array([0.0, 0.0, 1.0])
    for turn in (np.eye(3), np.array([[1.0, 0, 0], [0, c, s], [0, -s, c]])):
        spline = gm.Spline.from_nets(nets @ turn.T + [away, 0.0, 0.0])
        known, normals = gm.GaussMap(spline), np.array([turn @ axis, -turn @ axis])
        samples = known.points(normals)
        assert samples.normal_index.tolist() == [0, 1]
        assert samples.component is not None
        assert samples.patch_index is not None
        assert samples.component.tolist() == [gm.Component.CURVE] * 2
        assert known.degree(normals).tolist() == [0, 0]
        own = unit(spline._cross_products(samples.patch_index, samples.uv))
        assert np.abs(own - samples.normals).max() <= spline.noise


@pytest.mark.parametrize("name", ["sphere", "ellipsoid"])
def test_poles_are_one_point_with_their_normal(name: str) -> None:
    """Around them, at distances from none to that of patches, normals have one point, too."""
    spline = gm.Spline.from_nets(gm.fit(name, (12, 8)).control_nets)
    away = np.random.default_rng(7).normal(size=(60, 2))
    away *= np.logspace(-17, -1, 60)[:, None]
    for pole in (-1.0, 1.0):
        n = np.column_stack([away, np.full(60, pole)])
        n[:2, :2] = [(0.0, 0.0), (1e-16, 0.0)]
        samples = gm.sample(spline, normals=n)
        assert samples.normal_index.tolist() == list(range(60))
        assert (samples.gaussian_curvature > 0.0).all()
        assert np.abs(samples.points[:2, :2]).max() < 1e-9


def test_the_same_samples_as_the_library_s_own_spline() -> None:
    own = gm.fit("torus", (16, 12))
    nets = gm.Spline.from_nets(own.control_nets, name="torus")
    normals = gm.directions.random(2000, seed=3)
    one, other = (gm.sample(x, normals=normals) for x in (own, nets))
    for name in ("patch_index", "normal_index"):
        assert (getattr(one, name) == getattr(other, name)).all()
    for name in ("points", "normals", "support", "gaussian_curvature", "mean_curvature"):
        assert np.allclose(getattr(one, name), getattr(other, name), rtol=1e-11, atol=1e-11)
    count = gm.sample(nets, 1500)
    assert abs(len(count) - 1500) <= 0.02 * 1500 + 5


def test_what_does_not_fit_together_is_refused() -> None:
    square = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 1), (0, 2, 0), (1, 0, 0)], dtype=np.float64)

    def net(i: int, j: int, k: int) -> Array:
        a, b, c = square[[i, j, k]]
        return np.array([a, b, c, (a + b) / 2, (a + c) / 2, (b + c) / 2])

    assert len(gm.Spline.from_nets([net(0, 1, 2), net(0, 2, 3)]).joints.patches) == 1
    mirrored = (net(0, 1, 2) * [1, -1, 1])[[1, 0, 2, 3, 5, 4]]
    corner = r"a corner of another patch, at \[1.0, 0.0, 0.0\]"
    refused(corner, gm.Spline.from_nets, [net(0, 4, 2), net(4, 1, 2), mirrored])
    refused("opposite orientations", gm.Spline.from_nets, [net(0, 1, 2), net(3, 2, 0)])
    with pytest.raises(gm.errors.InputError, match="3 patches share one edge"):
        gm.Spline.from_nets([net(0, 1, 2), net(0, 2, 3), net(0, 2, 4)])
    refused("nets must", gm.Spline.from_nets, np.zeros((2, 5, 3)))
    refused("points that are not there", gm.Spline.from_nets, square, [[0, 1, 2, 3, 4, 5]])
    refused("the same", gm.Spline.from_nets, np.ones((1, 6, 3)), error=gm.errors.SurfaceError)


def test_what_takes_a_spline_takes_it() -> None:
    own = gm.fit("torus", (8, 8))
    nets = gm.Spline.from_nets(own.control_nets, name="torus")
    normals = gm.directions.random(200, seed=7)
    images = gm.gauss_map.GaussianImages(nets)
    assert (gm.GaussMap(nets).count(normals) == 2).all()
    assert abs(images.solid_angles.sum()) < 1e-11
    one, other = (gm.SupportFunction.of_spline(x).branches(normals) for x in (own, nets))
    assert np.allclose(one.hessian, other.hessian, atol=1e-11)
    assert np.allclose(one.support, other.support, atol=1e-12)
    again = pickle.loads(pickle.dumps(nets))
    assert len(gm.sample(again, normals=normals)) == 400
    for density in ("balanced", "uniform", "aligned", 0.5):
        refused(r'spline of nets.*use density="gauss"', gm.sample, nets, 10, density=density)
    assert not isinstance(nets, gm.Spline)
    samples, known = gm.sample(nets, normals=normals), gm.GaussMap(nets)
    for call in (samples.mesh, samples.weights, samples.coverage, known.folds, known.border_image):
        refused("no grid of cells", call)
    refused("no grid of cells", gm.silhouette, nets, (1, 2, 3))
    refused("no grid of cells", gm.gauss_map.parabolic_points, nets)
    refused("no grid of cells", gm.sample, nets, normals=normals, reach=((0, 0, 1), 30))


# --- meshes of splines of nets --------------------------------------------------------------------

PARTS = [1, 3]


def of_fit(name: str) -> NetSpline:
    return gm.Spline.from_nets(gm.fit(name, (8, 6)).control_nets, name=name)


def from_patches(spline: NetSpline, mesh: CreasedMesh, parts: int) -> Array:
    """Return how far the corners of each triangle are from points of the patch that it is of."""
    n = parts + 1
    places = np.array([(i, j, parts - i - j) for i in range(n) for j in range(n - i)]) / parts
    points = bezier(spline.control_nets[mesh.face_index][:, None], places)[0]
    corners = mesh.vertices[mesh.triangles]
    return np.linalg.norm(corners[:, :, None] - points[:, None], axis=3).min(axis=2)


@pytest.mark.parametrize("parts", PARTS)
@pytest.mark.parametrize(("name", "characteristic"), [("torus", 0), ("sphere", 2)])
def test_closed_nets_have_closed_meshes(name: str, characteristic: int, parts: int) -> None:
    spline = of_fit(name)
    mesh = spline.mesh(parts)
    assert mesh.closed  # and so all triangles have one orientation
    assert mesh.euler_characteristic == characteristic
    assert len(mesh.triangles) == spline.patches * parts**2 - (16 * parts if characteristic else 0)
    assert len(mesh.split.vertices) == len(mesh.vertices)  # no creases, nor at poles
    assert np.abs(mesh.corner_normals - mesh.normals[mesh.triangles]).max() < 1e-14
    assert from_patches(spline, mesh, parts).max() < 1e-14
    assert mesh.summary().startswith(f"{len(mesh.vertices):,} vertices, {len(mesh.triangles):,} tr")


@pytest.mark.parametrize("parts", PARTS)
def test_normals_are_those_of_the_surface(parts: int) -> None:
    """Those of a fitted torus are off by its misfit."""
    spline = gm.fit("torus", (24, 24))
    mesh = gm.Spline.from_nets(spline.control_nets).mesh(parts)
    x, y, z = mesh.vertices.T
    outwards = unit(np.stack([x - x / np.hypot(x, y), y - y / np.hypot(x, y), z], axis=1))
    angles = np.degrees(np.arccos(np.clip((outwards * mesh.normals).sum(axis=1), -1.0, 1.0)))
    assert angles.max() < 1.5 * spline.misfit.angle
    assert np.abs(np.linalg.norm(mesh.normals, axis=1) - 1.0).max() < 1e-14


@pytest.mark.parametrize("parts", PARTS)
def test_powell_sabin_splines_are_open(parts: int) -> None:
    nets = powell_sabin(30, 3, 0.15)
    spline = gm.Spline.from_nets(nets)
    mesh = spline.mesh(parts)
    assert mesh.euler_characteristic == 1
    border = 3 * len(nets) - 2 * len(spline.joints.patches)
    assert len(mesh.boundary_edges) == border * parts
    assert not mesh.closed
    assert np.isnan(mesh.volume)
    assert len(mesh.split.vertices) == len(mesh.vertices)
    ways = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    assert len(np.unique(ways, axis=0)) == len(ways)  # neighbours pass an edge in opposite ways
    assert (mesh.normals[:, 2] > 0.0).all()
    assert from_patches(spline, mesh, parts).max() < 1e-14


@pytest.mark.parametrize("parts", PARTS)
def test_creases_share_points_and_not_normals(parts: int) -> None:
    spline = gm.Spline.from_nets(*octants())
    mesh = spline.mesh(parts)
    assert mesh.closed
    assert (mesh.euler_characteristic, len(mesh.triangles)) == (2, 8 * parts**2)
    inside = (parts + 1) * (parts + 2) // 2
    # Normals agree at the six corners, and nowhere else on the twelve joints.
    assert len(mesh.split.vertices) == 8 * inside - 6 * 3
    assert (np.einsum("kx,kx->k", mesh.normals, mesh.vertices) > 0.0).all()


@pytest.mark.parametrize("parts", PARTS)
def test_patches_at_the_tip_of_a_cone_have_their_own_normals(parts: int) -> None:
    """All are singular there. They are perpendicular to the cone, whose generators fall by 45°."""
    position, domain = ("v*cos(u)", "-v*sin(u)", "1 - v"), ((0, "2*pi"), (0, 1))
    cone = gm.Surface.from_sympy(position, ("u", "v"), domain, periodic=(True, False))
    spline = gm.Spline.from_nets(gm.fit(cone, (16, 4)).control_nets)
    mesh = spline.mesh(parts)
    assert (mesh.euler_characteristic, len(mesh.boundary_edges)) == (1, 16 * parts)
    at_tip = np.linalg.norm(mesh.vertices[mesh.triangles] - [0, 0, 1], axis=2) < 1e-9
    patches = np.nonzero(at_tip)[0]
    tip = mesh.corner_normals[at_tip]
    assert np.abs(tip[:, 2] - np.sqrt(0.5)).max() < 0.02
    for patch in np.unique(mesh.face_index[patches]):
        own = tip[mesh.face_index[patches] == patch]
        assert np.abs(own - own[0]).max() < 1e-6
        assert own[0, :2] @ spline.control_nets[patch, :, :2].mean(axis=0) > 0.0
    assert len(np.unique(tip.round(3), axis=0)) == (32 if parts == 1 else 48)


@pytest.mark.parametrize("parts", [0, -1, 1.5, "2"])
def test_parts_that_are_none(parts: int) -> None:
    refused("parts must be a whole number", gm.Spline.from_nets(*octants()).mesh, parts)


def test_more_parts_than_memory_holds() -> None:
    refused(r"vertices of a mesh need about .* parts", gm.Spline.from_nets(*octants()).mesh, 10**6)
