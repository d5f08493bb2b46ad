"""Meshes of parts made of numbers: closed, oriented, with exact normals and counts."""

# pyright: reportAttributeAccessIssue=false

import zipfile
from dataclasses import replace
from typing import Literal
from xml.etree import ElementTree

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad import part_meshing as meshing
from gaussmap.tools.cad.examples import box, box_faces
from gaussmap.tools.cad.face_pieces import FacePiece
from gaussmap.tools.cad.mesh_spacing import TurnedPiece
from gaussmap.tools.cad.part import Part
from gaussmap.tools.cad.part_mesh import PartMesh

from ...refusals import refused
from . import made
from .made import CYLINDER, KINDS, TURN, ball, bezier, cylinder, face_normals, moved, noted

SIZES = np.array([1.0, 2.0, 3.0])


Way = Literal["shape", "normals"]


def meshed(part: Part, count: int, prefer: Way = "shape", **how) -> PartMesh:
    mesh = gm.sample(part, count, **how).mesh(prefer=prefer)
    assert isinstance(mesh, PartMesh)
    assert len(mesh.vertices) == count
    return mesh


def sound(
    part: Part, count: int, prefer: Way = "shape", *, euler: int, closed: bool = False, **how
) -> PartMesh:
    """Return a mesh, and check what holds of each, of smooth faces and enough vertices."""
    mesh = meshed(part, count, prefer, **how)
    assert (mesh.closed, mesh.euler_characteristic) == (closed, euler)
    assert (np.bincount(mesh.triangles.ravel(), minlength=count) > 0).all()
    assert (mesh.sample_index == -1).all()
    assert mesh.angles.max() < 60.0  # and so none is inverted
    np.testing.assert_allclose(np.linalg.norm(mesh.corner_normals, axis=2), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-12)
    ways = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    assert len(np.unique(ways, axis=0)) == len(ways)  # each edge is passed once in each direction
    assert mesh.failed == {}
    return mesh


@pytest.mark.parametrize("count", [8, 9, 20, 21, 100, 1000, 1001])
def test_a_box(count):
    mesh = sound(box(*SIZES), count, euler=2, closed=True)
    assert len(mesh.boundary_edges) == 0
    assert mesh.volume == pytest.approx(6.0, rel=1e-12)
    assert (mesh.angles < 1e-6).all()
    corners = ((mesh.vertices == 0.0) | (mesh.vertices == SIZES)).all(axis=1)
    assert corners.sum() == 8
    for k in range(6):
        here = mesh.face_index == k
        outward = np.eye(3)[k // 2] * (2 * (k % 2) - 1)
        assert np.array_equal(
            mesh.corner_normals[here], np.broadcast_to(outward, (here.sum(), 3, 3))
        )
        on_face = mesh.vertices[mesh.triangles[here]][..., k // 2]
        assert np.abs(on_face - SIZES[k // 2] * (k % 2)).max() <= 1e-15
    for line in mesh.lines:
        along = np.diff(mesh.vertices[line], axis=0)
        assert ((along > 0.0).sum(axis=1) == 1).all()
        assert ((along == 0.0).sum(axis=1) == 2).all()
    assert mesh.summary().startswith(f"{count:,} vertices, {2 * count - 4:,} triangles, closed; ")
    assert repr(mesh) == f"PartMesh({count:,} vertices, {2 * count - 4:,} triangles on box)"


@pytest.mark.parametrize("count", [200, 2000])
def test_a_cylinder_is_exact_though_its_circles_have_few_points(count):
    """A circle of a plane is a cubic of nine points; the seam and both circles are shared."""
    mesh, whole = sound(CYLINDER, count, euler=2, closed=True), CYLINDER.volume
    assert whole > mesh.volume == pytest.approx(whole, rel=20.0 / count)
    side = mesh.face_index == 0
    points = mesh.vertices[mesh.triangles]
    radii = np.hypot(points[..., 0], points[..., 1])
    np.testing.assert_allclose(radii[side], 1.0, atol=1e-14)
    normals = points[side] * [1.0, 1.0, 0.0]
    np.testing.assert_allclose(mesh.corner_normals[side], normals, atol=1e-13)
    assert (np.abs(mesh.corner_normals[~side][..., 2]) == 1.0).all()
    assert (points[mesh.face_index == 1][..., 2] == 0.0).all()
    assert (points[mesh.face_index == 2][..., 2] == 2.0).all()
    assert [len(x) > 1 for x in mesh.lines] == [True, True, True]
    assert mesh.lines[0][0] == mesh.lines[0][-1] == mesh.lines[2][0]


@pytest.mark.parametrize("count", [60, 150, 1500])
def test_a_ball_has_one_vertex_at_each_pole(count):
    mesh = sound(ball(2.0), count, euler=2, closed=True)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 2.0, atol=1e-14)
    at_pole = np.abs(mesh.vertices[mesh.triangles][..., 2]) == 2.0
    away = np.abs(mesh.corner_normals - mesh.vertices[mesh.triangles] / 2.0).max(axis=2)
    assert away[~at_pole].max() <= 1e-13
    assert away[at_pole].max() <= 1e-6
    assert (np.abs(mesh.vertices[:, 2]) == 2.0).sum() == 2
    assert mesh.volume == pytest.approx(32.0 / 3.0 * np.pi, rel=20.0 / count)
    assert [len(x) > 0 for x in mesh.lines] == [False, False, True]


def test_faces_of_all_kinds_are_open():
    faces = KINDS.faces
    mesh = sound(KINDS, 2000, euler=len(faces))  # disks
    assert mesh.smallest_angles.min() > 16.0  # 11.5 if vertices of thin triangles do not move
    assert np.quantile(mesh.smallest_angles, 0.01) > 25.0  # 21.8
    assert np.isnan(mesh.volume)
    assert set(mesh.face_index.tolist()) == set(range(len(faces)))
    border = {tuple(x) for x in mesh.boundary_edges.tolist()}
    lines = {tuple(sorted(x)) for y in mesh.lines for x in np.stack([y[:-1], y[1:]], 1).tolist()}
    assert border == lines
    assert "edges on borders" in mesh.summary()
    for known in faces:
        here = mesh.face_index == known.index
        corners = mesh.triangles[here]
        points, normals = mesh.vertices[corners], mesh.corner_normals[here]
        made.is_on(known.surface, mesh.uv[corners], points, normals, of_normals=1e-12)


def test_open_shells():
    mesh = sound(box(*SIZES).select(index=[0, 1, 2, 4, 5]), 300, euler=1)
    on_border = mesh.vertices[mesh.boundary_edges]
    assert (on_border[..., 1] == SIZES[1]).all()  # of the face that is missing


def ring(inner: float) -> Part:
    """Return a flat ring of radii 1 and `inner`, whose circles begin at opposite sides."""
    radii, ends = (1.0, inner), (-1.0, 1.0)
    edges = [
        made.edge((0,), [made.round_side(radius, 33, start)], (k, k))
        for k, (radius, start) in enumerate(zip(radii, (0.0, np.pi), strict=True))
    ]
    loops, wires = [made.circle(x) for x in radii], [[(0, 0, False)], [(1, 0, True)]]
    area = np.pi * (1.0 - inner**2)
    flat = made.face("plane", u=ends, v=ends, area=area, loops=loops, wires=wires)
    vertices = np.array([(1.0, 0.0, 0.0), (-inner, 0.0, 0.0)])
    return made.part([flat], "ring", False, edges=edges, vertices=vertices)


@pytest.mark.parametrize("inner", [0.9, 0.995, 0.999])
def test_edges_are_divided_until_they_do_not_cross(inner):
    """The polygons of two circles that are close cross each other unless they are fine."""
    mesh = meshed(ring(inner), 600)
    assert (mesh.failed, mesh.euler_characteristic) == ({}, 0)
    areas = face_normals(mesh)[:, 2]
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(ring(inner).area, rel=0.02)


@pytest.mark.parametrize("whole", [box(*SIZES), CYLINDER, KINDS], ids=lambda x: x.name)
def test_counts_below_what_edges_need_are_refused(whole):
    said = refused("vertices for its edges", gm.sample(whole, 4).mesh)
    least = int(said.split(" needs at least ")[1].split()[0].replace(",", ""))
    meshed(whole, least)
    refused(f"needs at least {least:,} vertices", gm.sample(whole, least - 1).mesh)


def test_counts_with_faults_are_refused_with_one_that_has_none():
    refused(r"30 vertices would lack .* 36 are enough", gm.sample(ring(0.99), 30).mesh)
    assert meshed(ring(0.99), 36).failed == {}


# --- what fails -----------------------------------------------------------------------------------


def crossed_box() -> Part:
    """Return a box whose face 5 has a border that crosses itself."""
    whole = box(*SIZES)
    starts = whole.arrays["side_point_starts"]
    side, _ = whole.faces[5].wires[0][0]
    points = whole.arrays["side_points"][starts[side] : starts[side + 1]]
    points[:, :2] = [(0.9, 1.9), (0.1, 1.9)]
    points[:, 2:] = points[1, :2] - points[0, :2]
    return whole


def unplaced_box() -> Part:
    """Return a box of which an edge of face 2 has no places."""
    whole = box(*SIZES)
    side, _ = whole.faces[2].wires[0][1]
    whole.arrays["side_points"][whole.arrays["side_point_starts"][side]] = np.nan
    return whole


@pytest.mark.parametrize(
    ("whole", "missing", "why"),
    [(crossed_box, 5, "of face 5 .* crosses itself"), (unplaced_box, 2, "face 2 .* are not known")],
)
def test_a_face_whose_border_is_bad_is_missing(whole, missing, why):
    """The other faces are there, and the mesh never says that it is closed."""
    with pytest.warns(gm.GaussmapWarning, match=f"lacks 1 face of 6: {why}"):
        mesh = meshed(whole(), 400)
    assert list(mesh.failed) == [missing]
    assert set(mesh.face_index.tolist()) == set(range(6)) - {missing}
    assert (mesh.closed, mesh.euler_characteristic) == (False, 1)
    assert "1 face missing" in mesh.summary()


def test_larger_counts_are_tried_up_to_a_bound(monkeypatch):
    """The edges of a box need 8 vertices: counts below 16 times that are tried."""
    tried = noted(monkeypatch, meshing, "mesh_and_soundness", lambda given, _: given[1])
    with pytest.warns(gm.GaussmapWarning, match="crosses itself"):
        gm.sample(crossed_box(), 60).mesh()
    assert tried == [60, 72, 87, 105, 126]


def test_edges_are_divided_again_as_long_as_triangles_point_inward(monkeypatch):
    """But not more often than that: here, an edge never gets better."""
    rounds = noted(monkeypatch, meshing, "wrong_edges", lambda given, _: len(given[1].lines[0]))
    monkeypatch.setattr(
        meshing, "inverted_triangles",
        lambda mesh: np.isin(mesh.triangles, mesh.lines[0][:2]).sum(axis=1).argmax()[None],
    )  # fmt: skip
    monkeypatch.setattr(meshing, "REFILLS", 1)
    with pytest.warns(gm.GaussmapWarning, match="has 1 triangle pointing inward, .* on face 0 "):
        meshed(box(*SIZES), 150)
    assert len(rounds) == 15
    assert rounds[-1] > rounds[0]


def test_vertices_of_triangles_that_point_inward_are_replaced(monkeypatch):
    """Seven times, and not more: here, each mesh has one such triangle inside of a face."""
    meshes, bad = [], []

    def one_inside(mesh):
        row = np.flatnonzero(~np.isin(mesh.triangles, np.concatenate(mesh.lines)).any(axis=1))[:1]
        meshes.append(mesh)
        bad.append(mesh.vertices[mesh.triangles[row[0]]])
        return row

    monkeypatch.setattr(meshing, "inverted_triangles", one_inside)
    with pytest.warns(gm.GaussmapWarning, match="pointing inward"):
        meshed(box(*SIZES), 300)
    tried = list({id(x): x for x in meshes}.values())[:-1]  # the last one is what is returned
    assert len(tried) == 8
    for old, mesh in zip(bad, tried[1:], strict=False):
        used = mesh.vertices[np.unique(mesh.triangles)]
        assert np.linalg.norm(used[:, None] - old, axis=2).min(axis=0).max() > 0.01


@pytest.mark.parametrize(
    ("samples", "arguments", "match"),
    [
        (lambda: gm.sample(made.part(box_faces()), 100), {}, "read the CAD file again"),
        (lambda: gm.sample(box(), 60)[:0], {}, "there are no samples"),
        (lambda: gm.sample(box(), 100), {"angle": 10.0}, "an angle"),
        (lambda: gm.sample(box(), 30, density=1.0), {}, '"balanced" or "uniform", .* have "power"'),
        (lambda: gm.sample(box(), 30, density=0.5), {}, '"balanced" or "uniform", .* have "power"'),
    ],
)
def test_what_has_no_mesh(samples, arguments, match):
    refused(match, samples().mesh, **arguments)


# --- triangles close to the normals ---------------------------------------------------------------


def inner(mesh: PartMesh) -> np.ndarray:
    """Return the vertices that are on no edge of the part."""
    return np.setdiff1d(np.arange(len(mesh.vertices)), np.concatenate(mesh.lines))


@pytest.mark.parametrize("count", [8, 9, 100, 1001])
def test_planes_have_no_vertices_inside(count):
    mesh = sound(box(*SIZES), count, "normals", euler=2, closed=True)
    assert mesh.volume == pytest.approx(6.0, rel=1e-12)
    assert len(inner(mesh)) == 0
    steps = [np.linalg.norm(np.diff(mesh.vertices[x], axis=0), axis=1) for x in mesh.lines]
    longest = [x.max() for x in steps]
    assert max(longest) <= 1.5 * min(longest) or count < 100


@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_meshes_by_normals_do_not_depend_on_the_unit(size):
    """Straight edges count by their share of the size: they leave vertices for what turns."""

    sheets = (
        np.array([[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0.3]]]),
        np.array([[[0, 0, -1.0], [0, 0, 0]], [[1, 0, -1], [1, 0, 0]]]),
    )
    one, other = (
        meshed(gm.Part([bezier(factor * x) for x in sheets]), 200, "normals")
        for factor in (1.0, size)
    )
    assert [len(x) for x in other.lines] == [len(x) for x in one.lines]


@pytest.mark.parametrize("count", [50, 2000])
def test_cylinders_have_vertices_on_their_circles_only(count):
    """Their rows are rulings: a regular polygon of as many corners as vertices allow."""
    mesh = sound(CYLINDER, count, "normals", euler=2, closed=True)
    assert len(inner(mesh)) == 0
    heights = mesh.vertices[:, 2]
    assert (np.isin(heights, [0.0, 2.0])).all()
    corners = (heights == 0.0).sum()
    assert abs(2 * corners - count) <= 1
    side = mesh.face_index == 0
    assert mesh.angles[side].max() == pytest.approx(180.0 / corners, rel=0.05)
    assert mesh.angles[side].max() < 0.6 * meshed(CYLINDER, count).angles.max()
    polygon = corners * np.sin(TURN / corners)
    assert mesh.volume == pytest.approx(polygon, rel=1e-2 if count < 100 else 1e-5)


def test_balls_by_normals():
    mesh = sound(ball(2.0), 1000, "normals", euler=2, closed=True)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 2.0, atol=1e-14)
    assert np.median(mesh.angles) < 4.5  # √(4π / 1000) · .58 rad are 3.7°


def mean_angle(mesh: PartMesh) -> float:
    """Return the mean angle by area."""
    return float(np.average(mesh.angles, weights=np.linalg.norm(face_normals(mesh), axis=1)))


def test_faces_of_all_kinds_by_normals():
    kinds = np.array([x.kind for x in KINDS.faces])
    mesh = sound(KINDS, 1000, "normals", euler=len(kinds))  # disks
    ruled = np.isin(kinds, ["plane", "cylinder", "cone"])
    owners = mesh.face_index[np.isin(mesh.triangles, inner(mesh)).any(axis=1)]
    assert not ruled[owners].any()
    assert set(kinds[owners]) >= {"sphere", "torus"}
    assert mean_angle(mesh) < 1.95
    assert mean_angle(meshed(KINDS, 1000)) < 2.3
    for kind in ("cylinder", "cone", "torus", "sphere"):
        here = np.isin(mesh.face_index, np.flatnonzero(kinds == kind))
        assert mesh.angles[here].mean() < 3.0 * mean_angle(mesh)


def arcs(radius: float, others: float, shift: float) -> gm.Surface:
    """Return what lies between a quarter of a circle and others: `others` and `shift` (x, y, z)."""
    root = np.sqrt(0.5)
    circle = radius * np.array([(1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
    points = np.stack([circle, others * circle + [0.0, 0.0, shift]], axis=1)
    return bezier(points, [[1.0, 1.0], [root, root], [1.0, 1.0]])


@pytest.mark.parametrize(
    ("other", "prefer", "count", "ratio"),
    [
        # The least mean angle has 29 times as large angles where the area is 850 times as small.
        pytest.param(arcs(1e-3, 1.0, 1.0), "normals", 200, 3.0, id="small cylinders",
                     marks=pytest.mark.filterwarnings("ignore:.*nearly coincide")),
        # Of radii r, steps h have the distance h²/8r; if that is even, arcs have steps as √r.
        pytest.param(arcs(0.5, 1.0, 1.0), "shape", 2000, np.sqrt(2.0), id="even distances"),
        pytest.param(arcs(1.0, 0.5, 0.0), "normals", 200, 2.0, id="borders of planes"),
    ],
)  # fmt: skip
def test_steps_of_arcs(other, prefer, count, ratio):
    """The arcs of a cylinder, and above it others that are smaller, or the borders of a plane."""
    both = gm.Part([arcs(1.0, 1.0, 1.0), moved(other, (0.0, 0.0, 3.0))])
    mesh = meshed(both, count, prefer)
    level = [x for x in mesh.lines if np.ptp(mesh.vertices[x][:, 2]) < 1e-9]
    numbers = [len(x) - 1 for x in level if len(x) > 2]  # the others are straight
    assert len(numbers) == 4
    rel = 0.06 if prefer == "shape" else 0.1
    assert max(numbers) == pytest.approx(ratio * min(numbers), rel=rel)


def test_even_meshes_are_flipped_to_the_normals_where_no_angle_becomes_small(monkeypatch):
    mesh = sound(CYLINDER, 1000, euler=2, closed=True)
    assert np.quantile(mesh.smallest_angles, 0.01) > 24.0
    monkeypatch.setattr("gaussmap.tools.cad.part_meshing.ENOUGH", 89.0)  # which no triangle has
    by_shape = meshed(CYLINDER, 1000)
    assert by_shape.smallest_angles.mean() > mesh.smallest_angles.mean() + 1.0
    assert mesh.angles.mean() < 0.95 * by_shape.angles.mean()


def arch(height: float) -> gm.Surface:
    """Return a surface that is arched along both parameters."""
    curve = [(0.0, 0.0), (0.5, height), (1.0, 0.0)]
    return bezier([[(x, y, z + w) for y, w in curve] for x, z in curve])


@pytest.mark.parametrize(("height", "is_ruled"), [(1e-4, False), (1e-9, True)])
def test_faces_that_turn_by_little_are_not_ruled(height, is_ruled):
    """An arch of 1e-4 rad has vertices inside, and one of 1e-9 rad has none."""
    assert (len(inner(meshed(gm.Part([arch(height)]), 40, "normals"))) == 0) == is_ruled


def test_normals_of_waves_are_seen():
    """Five waves, of which a straight line sees nothing, turn by 4 arctan(slope) each."""
    slope = 0.3

    def waves(u, v):
        return np.stack([u, v, slope / (10.0 * np.pi) * np.sin(10.0 * np.pi * u + 0.7)], axis=-1)

    wavy = gm.Part([gm.Surface.from_callable(waves, ((0.0, 1.0), (0.0, 1.0)))])
    turned = TurnedPiece.of_piece(FacePiece.of(wavy.faces[0]), 0)
    assert turned.lengths[0][-1] == pytest.approx(20.0 * np.arctan(slope), rel=0.05)


def test_faces_whose_normals_are_the_same_do_not_share_vertices():
    """Planes of two faces are apart: each of both has vertices as if it were alone."""
    mesh = meshed(gm.Part([arch(0.8), moved(arch(0.8), (5.0, 0.0, 0.0))]), 400, "normals")
    inside = mesh.vertices[inner(mesh)][:, 0]
    assert len(inside) > 100
    assert (inside > 2.0).mean() == pytest.approx(0.5, abs=0.05)


def test_sizes_grow_slowly_from_edges():
    """The edges of disks of a low cylinder are several times as fine as the inside needs."""
    mesh = sound(cylinder(height=0.02), 1500, euler=2, closed=True)
    flat = mesh.face_index > 0
    assert 24.0 < np.quantile(mesh.smallest_angles[flat], 0.05) < 28.0  # 4 without growth
    corners = mesh.vertices[mesh.triangles[flat]]
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    inside = np.linalg.norm(corners.mean(axis=1)[:, :2], axis=1) < 0.6
    assert lengths[inside].mean() > 6.0 * TURN / (len(mesh.lines[0]) - 1)


def test_steps_along_edges_are_even_whatever_their_parameters():
    """Along u, the point moves with the speed 3 u²."""
    points = [[(x, y, 0.0) for y in (0.0, 1.0)] for x in (0.0, 0.0, 0.0, 1.0)]
    mesh = meshed(gm.Part([bezier(points)]), 1500, density="uniform")
    for line in mesh.lines:
        lengths = np.linalg.norm(np.diff(mesh.vertices[line], axis=0), axis=1)
        assert lengths.max() < 1.03 * lengths.min()


# --- density --------------------------------------------------------------------------------------


def test_meshes_follow_the_density_of_samples():
    """Of a cylinder, disks have more vertices if the density is uniform."""
    flat = []
    for density in ("balanced", "uniform"):
        mesh = sound(cylinder(height=0.2), 1500, euler=2, closed=True, density=density)
        flat.append((np.hypot(*mesh.vertices[:, :2].T) < 0.9).sum())
    assert flat[1] > 1.2 * flat[0]
    assert flat[1] / 1500 == pytest.approx(2.0 * 0.81 / (2.0 + 2.0 * 0.2), rel=0.15)


@pytest.mark.parametrize("density", [1.0, 0.5])
def test_meshes_by_normals_are_made_of_other_densities(density):
    meshed(KINDS, 300, "normals", density=density)


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", ["stl", "ply", "glb"])
def test_trimesh_reads_a_closed_mesh(tmp_path, suffix):
    trimesh = pytest.importorskip("trimesh")
    mesh, path = meshed(CYLINDER, 300), tmp_path / f"part.{suffix}"
    mesh.write(path)
    if suffix == "glb":
        (again,) = trimesh.load_scene(path, process=False).geometry.values()
        assert len(again.vertices) == len(mesh.split.vertices) == 300 + 2 * (len(mesh.lines[0]) - 1)
        np.testing.assert_allclose(again.vertex_normals, mesh.split.normals, atol=1e-6)
        again.merge_vertices(merge_norm=True)
    else:
        again = trimesh.load_mesh(path)
    assert (again.is_watertight, len(again.vertices)) == (True, 300)
    assert again.volume == pytest.approx(mesh.volume, rel=1e-5)


def test_obj_files_have_a_normal_at_each_corner(tmp_path):
    mesh = meshed(CYLINDER, 300)
    mesh.write(tmp_path / "part.obj")
    rows = [x.split() for x in (tmp_path / "part.obj").read_text().splitlines()]
    vertices, normals = (np.array([x[1:] for x in rows if x[0] == y], float) for y in ("v", "vn"))
    corners = np.array([[y.split("/")[::2] for y in x[1:]] for x in rows if x[0] == "f"], int) - 1
    assert np.array_equal(vertices, mesh.vertices)
    assert np.array_equal(corners[..., 0], mesh.triangles)
    np.testing.assert_allclose(normals[corners[..., 1]], mesh.corner_normals, atol=1e-9)


@pytest.fixture(scope="module")
def mesh_of_box() -> PartMesh:
    return meshed(box(*SIZES), 100)


@pytest.mark.parametrize(
    ("unit", "written", "factor"),
    [("um", "micron", 1.0), ("mm", "millimeter", 1.0), ("cm", "centimeter", 1.0),
     ("m", "meter", 1.0), ("in", "inch", 1.0), ("ft", "foot", 1.0), ("", "millimeter", 1.0),
     ("km", "millimeter", 1e6), ("yd", "millimeter", 914.4)],
)  # fmt: skip
def test_3mf_files_have_a_unit(mesh_of_box, tmp_path, unit, written, factor):
    mesh = mesh_of_box
    assert mesh.unit == "mm"
    replace(mesh, unit=unit).write(tmp_path / "part.3mf")
    with zipfile.ZipFile(tmp_path / "part.3mf") as file:
        assert file.testzip() is None
        assert file.namelist()[:2] == ["[Content_Types].xml", "_rels/.rels"]
        target = ElementTree.fromstring(file.read("_rels/.rels"))[0].get("Target")
        model = ElementTree.fromstring(file.read(str(target).lstrip("/")))
    assert model.get("unit") == written
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    rows = [[float(x.attrib[y]) for y in "xyz"] for x in model.iter(f"{core}vertex")]
    corners = [[int(x.attrib[f"v{k}"]) for k in (1, 2, 3)] for x in model.iter(f"{core}triangle")]
    rtol = 0.0 if factor == 1.0 else 1e-15
    np.testing.assert_allclose(rows, mesh.vertices * factor, rtol=rtol)
    assert np.array_equal(corners, mesh.triangles)
    (item,) = model.iter(f"{core}item")
    assert item.get("objectid") == next(model.iter(f"{core}object")).get("id")
