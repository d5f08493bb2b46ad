"""Parts made of surfaces: shared edges, orientation, gaps, and all that takes a part."""

import itertools
import pickle
import re

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.part_mesh import PartMesh
from gaussmap.tools.cad.surface_geometry import geometry_of_surface

from ...products import covering
from ...refusals import refused

TURN = 2.0 * np.pi
BEZIER = [0, 0, 0, 1, 1, 1]


def bilinear(a, b, c, d, **more) -> gm.Surface:
    """Return the surface with corners a at (0, 0), b at (1, 0), c at (1, 1) and d at (0, 1)."""
    return gm.Surface.from_nurbs((1, 1), ([0, 0, 1, 1],) * 2, [[a, d], [b, c]], **more)


def cube(size: float = 1.0) -> list[gm.Surface]:
    """Return six squares; those of even places have normals that point inward."""
    found, axes = [], size * np.eye(3)
    for k in range(3):
        across, along = axes[k - 2], axes[k - 1]
        for far in (0.0, 1.0):
            low = far * axes[k]
            found.append(bilinear(low, low + across, low + across + along, low + along))
    return found


def globe() -> list[gm.Surface]:
    """Return the six faces of a cube as wavy patches of a star-shaped body; some are flipped."""
    found = []
    for axis in range(3):
        for sign in (1.0, -1.0):

            def position(u, v, axis=axis, sign=sign):
                others = np.tan(u * np.pi / 4.0), np.tan(v * np.pi / 4.0)
                x, y, z = np.roll([np.full_like(u, sign), *others], axis, axis=0)
                size = np.sqrt(x * x + y * y + z * z)
                x, y, z = x / size, y / size, z / size
                radius = 1.0 + 0.1 * np.sin(3.0 * x) * np.sin(3.0 * y) * np.cos(2.0 * z)
                return np.stack([radius * x, radius * y, radius * z], axis=-1)

            found.append(gm.Surface.from_callable(position, ((-1, 1), (-1, 1))))
    return found


def ring(u, v, *, flipped=False) -> gm.Surface:
    """Return a part of a torus."""

    def position(u, v):
        radius = 1.0 + 0.4 * np.cos(v)
        return np.stack([radius * np.cos(u), radius * np.sin(u), 0.4 * np.sin(v)], axis=-1)

    surface = gm.Surface.from_callable(position, (u, v), name="ring")
    return surface.flipped() if flipped else surface


def strip(u, v, name: str = "strip") -> gm.Surface:
    """Return a part of a Möbius band."""
    band = gm.surfaces.moebius_band()
    return gm.Surface.from_callable(band.function, (u, v), name=name)


def moved(surface: gm.Surface, shift, scale: float = 1.0) -> gm.Surface:
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = shift
    return surface.transformed(matrix)


def is_outward(part, centre) -> bool:
    samples = gm.sample(part, 100, density="uniform")
    return bool((np.einsum("ij,ij->i", samples.points - centre, samples.normals) > 0.0).all())


def mesh_of(samples: gm.Samples) -> PartMesh:
    mesh = samples.mesh()
    assert isinstance(mesh, PartMesh)
    return mesh


# --- edges ----------------------------------------------------------------------------------------


def test_six_squares_are_a_cube():
    part = gm.Part(cube(), name="cube")
    assert repr(part) == "Part(cube: 6 faces, 1 solid)"
    assert (part.closed, part.open_edges, part.gap, part.oriented) == (True, 0, 0.0, True)
    assert (len(part.arrays["vertices"]), len(part.arrays["edge_vertices"])) == (8, 12)
    assert part.warnings == ("3 surfaces are flipped: 0, 2, 4.",)
    assert [x.reversed for x in part.faces] == [True, False] * 3
    np.testing.assert_allclose([part.area, part.volume], [6.0, 1.0], rtol=1e-14)
    assert is_outward(part, (0.5, 0.5, 0.5))
    with_edges = gm.sample(part, 60, edges=True)
    assert (with_edges.report.edge_samples or 0) > 0


@pytest.mark.compiled
def test_wavy_patches_are_a_closed_body():
    part = gm.Part(globe())
    assert (part.closed, len(part.solids), part.gap < 1e-14) == (True, 1, True)
    assert is_outward(part, 0.0)
    samples = gm.sample(part, 600)
    mesh = mesh_of(samples)
    assert (len(samples), mesh.closed, mesh.euler_characteristic) == (600, True, 2)
    assert mesh.volume == pytest.approx(part.volume, rel=0.02)
    curvature = (samples.gaussian_curvature * samples.weights()).sum()
    assert curvature == pytest.approx(4.0 * np.pi, rel=0.02)


@pytest.mark.compiled
@pytest.mark.parametrize(
    "pieces",
    [
        [((0, 2), (0, 3), False), ((2, TURN), (0, 3), True), ((0, 2), (3, TURN), True),
         ((2, TURN), (3, TURN), False)],
        [((0, TURN), (0, 3), False), ((1, 4), (3, TURN), True), ((4, 1 + TURN), (3, TURN), True)],
    ],
    ids=["crossing", "meeting in T"],
)  # fmt: skip
@pytest.mark.quick_for("meeting in T")
def test_a_torus_in_pieces_is_sampled_as_in_one(pieces):
    part = gm.Part([ring(u, v, flipped=flipped) for u, v, flipped in pieces])
    assert (part.closed, part.gap < 1e-14) == (True, True)
    whole = gm.sample(ring((0, TURN), (0, TURN)), 1000)
    samples = gm.sample(part, 1000)
    assert samples.coverage() < 1.15 * whole.coverage()
    assert samples.normal_deviation().space < 1.2 * whole.normal_deviation().space
    mesh = mesh_of(samples)
    assert (mesh.closed, mesh.euler_characteristic, len(mesh.vertices)) == (True, 0, 1000)


@pytest.mark.parametrize("weight", [3.0, 100.0])
def test_a_common_border_may_have_two_parametrizations(weight):
    # The same parabola with weights 1, w, w² is passed backwards, and at another speed.
    curve = np.array([(0, 0, 0), (1, 0, 1), (2, 0, 0)], dtype=np.float64)
    left = np.stack([np.add(curve, x) for x in ((0, 0, 0), (0, 1, 0.3), (0, 2, 0))], axis=1)
    right = np.stack([curve[::-1] - [0, k, 0] for k in range(3)])
    weights = np.tile([1.0, weight, weight**2], (3, 1))
    knots = BEZIER, 7.0 * np.array(BEZIER) - 2.0
    part = gm.Part([
        gm.Surface.from_nurbs((2, 2), (BEZIER, BEZIER), left),
        gm.Surface.from_nurbs((2, 2), knots, right, weights),
    ])  # fmt: skip
    assert (part.open_edges, part.closed, part.gap < 1e-13) == (6, False, True)
    mesh = mesh_of(gm.sample(part, 200))
    assert (mesh.euler_characteristic, len(mesh.vertices)) == (1, 200)
    (shared,) = [k for k, x in enumerate(np.diff(part.arrays["edge_side_starts"])) if x == 2]
    x, y, z = mesh.vertices[mesh.lines[shared]].T
    np.testing.assert_allclose([y, z], [0.0 * x, x - x * x / 2.0], atol=1e-14)
    rows = mesh.face_index == 1
    x = mesh.vertices[mesh.triangles[rows], 0]
    normals = np.stack([x - 1.0, 0.0 * x, np.ones_like(x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    cosines = np.abs(np.einsum("tkx,tkx->tk", normals, mesh.corner_normals[rows]))
    np.testing.assert_allclose(cosines, 1.0, atol=1e-11)


def test_a_side_that_is_a_point_is_no_border():
    cone = gm.Surface.from_sympy(
        ("v*cos(u)", "v*sin(u)", "1 - v"), ("u", "v"), ((0, "2*pi"), (0, 1)), (True, False)
    )
    disk = gm.Surface.from_sympy(  # the seam is elsewhere
        ("v*cos(u + 1)", "v*sin(u + 1)", "0*u"), ("u", "v"), ((0, "2*pi"), (0, 1)), (True, False)
    )
    part = gm.Part([cone, disk])
    assert (part.closed, int(part.arrays["edge_degenerate"].sum())) == (True, 2)
    assert part.volume == pytest.approx(np.pi / 3.0, rel=1e-12)
    mesh = mesh_of(gm.sample(part, 200))
    assert (mesh.closed, mesh.euler_characteristic) == (True, 2)


def test_trims_have_borders():
    angles = np.linspace(0.0, TURN, 100, endpoint=False)
    circle = 1.0 + 0.5 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    sheet = gm.Surface.from_sympy(("u", "v", "u*v/4"), ("u", "v"), ((0, 2), (0, 2)))
    square = [(0, 0), (0, 2), (2, 2), (2, 0)]
    plate, disk = (
        sheet.trimmed([circle, square]),
        sheet.flipped().trimmed([(2.0, 0.0) - circle * (1, -1)]),
    )
    part = gm.Part([plate, disk])
    assert (part.open_edges, len(part.arrays["edge_vertices"]), part.gap < 1e-14) == (4, 5, True)
    assert [x.reversed for x in part.faces] == [False, True]
    assert part.area == pytest.approx(gm.Part([sheet]).area, rel=1e-9)
    mesh = mesh_of(gm.sample(part, 200))
    assert (mesh.euler_characteristic, len(mesh.vertices)) == (1, 200)
    halves = [gm.surfaces.torus().trimmed([[(a, 0), (b, 0), (b, TURN), (a, TURN)]])
              for a, b in ((0, 3), (3, TURN))]  # fmt: skip
    assert gm.Part([halves[0].flipped(), halves[1]]).closed
    assert (gm.Part([halves[0]]).open_edges, gm.Part([halves[0]]).closed) == (2, False)


@pytest.mark.parametrize(("points", "corners"), [(8, 8), (16, 0)])
def test_borders_have_corners_where_they_turn_by_30_degrees(points, corners):
    """An octagon turns by 45° at its corners; of 16 points, by 22.5°, a border is smooth."""
    angles = np.linspace(0.0, TURN, points, endpoint=False)
    polygon = 0.5 + 0.4 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    part = gm.Part([bilinear((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)).trimmed([polygon])])
    assert len(part.arrays["edge_vertices"]) == max(corners, 1)


def test_an_edge_of_three_faces():
    a, b = (0, 0, 0), (1, 0, 0)
    sheets = [bilinear(a, b, (1, *x), (0, *x)) for x in ((1, 0), (-1, 1), (-1, -1))]
    part = gm.Part(sheets)
    assert part.warnings == ("there is 1 edge of more than two faces.",)
    assert (part.open_edges, part.closed, len(part.solids)) == (9, False, 0)


# --- gaps -----------------------------------------------------------------------------------------


def test_gaps_are_measured():
    sides = cube()
    sides[5] = moved(sides[5], (0.0, 0.0, 1e-3))
    with pytest.warns(gm.GaussmapWarning, match="nearly coincide, up to 0.001, and stay apart"):
        part = gm.Part(sides)
    assert (part.closed, part.oriented, part.open_edges, part.gap) == (False, False, 8, 0.0)
    with pytest.raises(gm.errors.SurfaceError, match="enclose no solids"):
        _ = part.volume
    part = gm.Part(sides, tolerance=2e-3)
    assert (part.closed, part.gap) == (True, pytest.approx(1e-3, rel=1e-9))
    mesh = mesh_of(gm.sample(part, 200))
    assert (mesh.closed, mesh.euler_characteristic) == (True, 2)


@pytest.mark.parametrize(("gap", "is_near"), [(0.007, True), (0.014, False)])
def test_edges_nearly_coincide_up_to_a_hundredth_of_their_length(gap, is_near, recwarn):
    sides = cube()
    sides[5] = moved(sides[5], (0.0, 0.0, gap))
    assert gm.Part(sides).open_edges == 8
    assert any("nearly coincide" in str(x.message) for x in recwarn) == is_near


@pytest.mark.parametrize(
    ("scale", "shift"), [(1e-12, 0.0), (1e12, 0.0), (1.0, 1e6)], ids=["small", "large", "far"]
)
def test_units_and_origins_do_not_matter(scale, shift):
    part = gm.Part([moved(x, shift, scale) for x in cube()])
    assert (part.closed, part.warnings) == (True, ("3 surfaces are flipped: 0, 2, 4.",))
    assert part.volume == pytest.approx(scale**3, rel=1e-9)
    mesh = mesh_of(gm.sample(part, 100))
    assert (mesh.closed, mesh.euler_characteristic) == (True, 2)


# --- orientation ----------------------------------------------------------------------------------


def test_an_open_set_is_as_its_first_surface():
    pair = [ring((0, 2), (0, 3)), ring((2, 4), (0, 3), flipped=True)]
    assert [x.reversed for x in gm.Part(pair).faces] == [False, True]
    assert [x.reversed for x in gm.Part(pair[::-1]).faces] == [False, True]
    assert gm.Part(pair).warnings == ("surface 1 ('ring') is flipped.",)


def test_one_surface():
    part = gm.Part([gm.surfaces.sphere().flipped(), "plane"])  # two sets
    assert [x.reversed for x in part.faces] == [True, False]
    assert [(x.kind, x.name, x.solid_index) for x in part.faces] == [
        ("sphere", "sphere", 0), ("plane", "plane", -1),
    ]  # fmt: skip
    assert (len(part.solids), part.oriented, part.closed) == (1, False, False)
    alone = part.select(index=[0])
    assert (alone.closed, alone.area) == (True, pytest.approx(4.0 * np.pi, rel=1e-9))
    assert is_outward(alone, 0.0)


def test_a_set_with_one_side_is_refused():
    (low, high), v = gm.surfaces.moebius_band().domain
    ends = np.linspace(low, high, 4)
    strips = [strip((a, b), v, "band") for a, b in itertools.pairwise(ends)]
    assert gm.Part(strips[:2]).open_edges == 6
    for surfaces in (strips, [gm.surfaces.moebius_band()]):
        refused("band'\\) closes a band that has one side", gm.Part, surfaces)


def volume_of_ball(radius):
    return 4.0 / 3.0 * np.pi * radius**3


def ball(radius, centre=(0.0, 0.0, 0.0), *, flipped=False):
    surface = moved(gm.surfaces.sphere(), centre, radius)
    return surface.flipped() if flipped else surface


@pytest.mark.parametrize("flipped", [False, True])
def test_a_closed_set_inside_another_is_a_hollow(flipped):
    small = [moved(x, (3.0, 0.0, 0.0)) for x in cube(0.5)]
    block = [moved(x, (-2.5, -2.5, -2.5)) for x in cube(5.0)]
    surfaces = [
        *small, ball(1.5, flipped=flipped), ball(1.0, flipped=not flipped), *block,
        ball(0.6, (5.0, 0.0, 0.0)),
    ]  # fmt: skip
    part = gm.Part(surfaces)
    assert (part.closed, part.oriented, len(part.solids)) == (True, True, 4)
    # A ball in a hollow of the block, and two bodies beside it.
    assert [x.solid_index for x in part.faces] == [0] * 6 + [2, 1] + [2] * 6 + [3]
    volume = 125.125 - volume_of_ball(1.5) + volume_of_ball(1.0) + volume_of_ball(0.6)
    assert part.volume == pytest.approx(volume, rel=1e-9)
    hollow = gm.sample(part.select(index=[6]), 50)
    assert (np.einsum("kx,kx->k", hollow.points, hollow.normals) < 0.0).all()
    assert part.faces[6].dimensions["hollow"]


@pytest.mark.parametrize(("wall", "shift"), [(1e-3, 0.0), (0.2, 0.2 - 1e-6)])
def test_walls_may_be_thin(wall, shift):
    part = gm.Part([ball(1.0), ball(1.0 - wall, (shift, 0.0, 0.0))])
    assert part.volume == pytest.approx(volume_of_ball(1.0) - volume_of_ball(1.0 - wall), rel=1e-9)
    assert len(part.solids) == 1


@pytest.mark.parametrize(
    ("other", "centre"),
    [(0.5, (0.7, 0.0, 0.0)), (0.5, (1.6, 0.0, 0.0)), (0.05, (0.9, 0.9, 0.9))],
    ids=["crossing", "outside", "in a corner of the box around it"],
)
def test_what_crosses_or_is_outside_is_no_hollow(other, centre):
    part = gm.Part([ball(1.0), ball(other, centre)])
    assert part.volume == pytest.approx(volume_of_ball(1.0) + volume_of_ball(other), rel=1e-9)


# --- kinds and units ------------------------------------------------------------------------------

TILTED = 2.0 * np.linalg.qr(np.array([(3.0, 1, 2), (1, 4, 1), (2, -1, 5)]))[0]
MIRROR = np.diag([1.0, -1.0, 1.0])
SHEAR = np.array([(1.0, 0.5, 0.0), (0.0, 2.0, 0.3), (0.2, 0.0, 1.0)])
SURFACES = gm.surfaces


@covering(
    is_flipped=[False, True],
    matrix=[np.eye(3), TILTED, MIRROR],
    **{
        "surface, kind, sizes": [
            (SURFACES.plane(0.5, -2.0), "plane", {}),
            (SURFACES.cylinder(0.5, 3.0), "cylinder", {"radius": 0.5}),
            (SURFACES.cone(1.0, 0.25, 1.0), "cone", {"half_angle": np.degrees(np.arctan(0.75))}),
            (SURFACES.cone(0.25, 0.25, 3.0), "cylinder", {"radius": 0.25}),
            (SURFACES.sphere(1.5), "sphere", {"radius": 1.5}),
            (SURFACES.torus(2.0, 0.5), "torus", {"major_radius": 2.0, "minor_radius": 0.5}),
        ]
    },
)
def test_kinds_and_dimensions(surface, kind, sizes, matrix, is_flipped):
    factor = np.linalg.norm(matrix[0])
    shift = np.array([3.0, -2.0, 5.0])
    placed = np.block([[matrix, shift[:, None]], [np.zeros(3), 1.0]])
    given = surface.transformed(placed)
    given = given.flipped() if is_flipped else given
    (low, high), (first, last) = given.domain
    middle = (low + high) / 2.0
    given = given.trimmed([[(low, first), (middle, first), (middle, last), (low, last)]])
    face = gm.Part([given]).faces[0]
    assert face.kind == kind
    for name, size in sizes.items():
        wanted = size if name == "half_angle" else factor * size
        assert face.dimensions[name] == pytest.approx(wanted, rel=1e-14)
    if kind != "plane":
        assert face.dimensions["hollow"] == is_flipped
        axis = face.dimensions.get("axis", [0.0, 0.0, 1.0])
        wanted = [0.0, 0.0, 1.0] if kind == "sphere" else matrix[:, 2] / factor
        np.testing.assert_allclose(np.abs(np.dot(axis, wanted)), 1.0, rtol=1e-14)
    u, v = (np.linspace(a, b, 7)[1:-1] for a, b in ((low, middle), (first, last)))
    jets = given.jets(u, v)
    _, own = geometry_of_surface(given)
    again = face.surface.jets(*(own @ [u, v]))
    tangents = np.einsum("ij,kix->kjx", own, again[:, 1:3])
    np.testing.assert_allclose(again[:, 0], jets[:, 0], atol=1e-13)
    np.testing.assert_allclose(tangents, jets[:, 1:3], atol=1e-13)
    trim = face.surface.trim
    assert trim is not None
    assert trim.contains((own @ [u, v]).T).all()


@pytest.mark.parametrize(
    ("surface", "matrix", "kind"),
    [
        ("torus", SHEAR, "surface"),
        ("sphere", np.diag([1.0, 1.0, 2.0]), "surface"),
        ("cone", np.diag([1.0, 1.0, 2.0]), "cone"),
        ("cylinder", np.diag([1.0, 2.0, 1.0]), "surface"),
        ("plane", SHEAR, "plane"),
        ("torus", np.eye(3) + 1e-8 * SHEAR, "surface"),
        ("torus", np.eye(3) + 1e-10 * SHEAR, "torus"),
        ("ellipsoid", np.eye(3), "surface"),
    ],
)
def test_kinds_after_affine_maps(surface, matrix, kind):
    (face,) = gm.Part([gm.surfaces.surface(surface).transformed(matrix)]).faces
    assert face.kind == kind


@pytest.mark.parametrize("is_reversed", [False, True])
def test_faces_of_parts_keep_their_kinds(parts, is_reversed):
    faces = [x for x in parts.all_kinds().faces if x.kind in ("plane", "cylinder", "cone", "sphere",
                                                              "torus")]  # fmt: skip
    surfaces = [x.surface.flipped() if is_reversed else x.surface for x in faces]
    for given, old in zip(surfaces, faces, strict=True):
        (face,) = gm.Part([given]).faces
        assert face.kind == old.kind
        for name, value in old.dimensions.items():
            if isinstance(value, float):
                assert face.dimensions[name] == pytest.approx(value, rel=1e-12)


def test_units(tmp_path):
    part = gm.Part([gm.surfaces.cylinder(0.5)], unit="inch", name="tube")
    assert (part.unit, part.metres, repr(part)) == (
        "in",
        0.0254,
        "Part(tube: 1 face, 0 solids, in)",
    )
    samples = gm.sample(part.select(kind="cylinder"), 20, coverage=0.5)
    assert re.search(r"within 0\.\d+ in of a sample; 1 face$", samples.summary())
    assert gm.GaussMap(part).points([[1, 0, 0]]).report.unit == "in"
    samples.write(tmp_path / "tube.npz")
    gm.read_samples(tmp_path / "tube.npz").write(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text().startswith("x [in],y [in],z [in]")
    samples.write(tmp_path / "tube.csv")
    head = (tmp_path / "tube.csv").read_text().splitlines()[0]
    assert head.startswith("x [in],y [in],z [in]")
    assert "face_radius [in]" in head
    assert gm.Part(["torus"]).unit == ""
    refused("unit must be one of nm, um, mm", gm.Part, ["torus"], unit="furlong")


# --- what takes parts -----------------------------------------------------------------------------


def test_nurbs_are_saved_moved_and_flipped(tmp_path):
    sides = [moved(x, (1.0, 2.0, 3.0), 2.0) for x in cube()]
    sides[2] = sides[2].flipped()
    curve = np.array([(0, 0, 0), (1, 0, 1), (2, 0, 0)], dtype=np.float64)
    points = np.stack([curve, np.add(curve, (0, 1, 0))], axis=1)
    arch = gm.Surface.from_nurbs((2, 1), (BEZIER, [0, 0, 1, 1]), points, [[1, 1], [2, 2], [1, 1]])
    for surface in (arch, arch.flipped(), moved(arch, (1, 2, 3), -2.0)):
        face = gm.Part([surface]).faces[0]
        u, v = np.random.default_rng(0).random((2, 10))
        np.testing.assert_allclose(face.surface.jets(u, v), surface.jets(u, v), atol=1e-13)
    part = gm.Part(sides)
    part.save(tmp_path / "part.npz")
    again = gm.read_part(tmp_path / "part.npz")
    assert [x.kind for x in again.faces] == ["nurbs"] * 6
    assert (again.closed, again.warnings) == (True, ("2 surfaces are flipped: 0, 4.",))
    np.testing.assert_array_equal(gm.sample(again, 50).points, gm.sample(part, 50).points)


def test_functions_are_pickled_and_not_saved(tmp_path):
    part = gm.Part(["enneper"]).select(kind="surface")
    again = pickle.loads(pickle.dumps(part))
    np.testing.assert_array_equal(gm.sample(again, 50).points, gm.sample(part, 50).points)
    refused(r"face 0 \('enneper'\) .* function in memory", part.save, tmp_path / "part.npz")


def test_a_file_cannot_hold_a_function(tmp_path):
    part = gm.Part(cube())
    arrays = dict(part.arrays, kind=np.full(6, 10, dtype=np.int8))
    np.savez(tmp_path / "part.npz", **arrays)  # pyright: ignore[reportArgumentType]
    refused("'kind'", gm.read_part, tmp_path / "part.npz", error=gm.errors.FileError)


def test_prescribed_normals_and_reach():
    part = gm.Part([gm.surfaces.sphere(), moved(gm.surfaces.torus(), (5.0, 0.0, 0.0))])
    normal = np.array([[0.36, 0.48, 0.8]])
    found = gm.GaussMap(part).points(normal)
    np.testing.assert_array_equal(np.array(found.face_index), [0, 1, 1])
    assert found.report.proved == 1
    np.testing.assert_allclose(found.points[0], normal[0], atol=1e-12)
    tilted = gm.sample(part, 100, reach=((0, 0, 1), 30.0))
    assert tilted.normals[:, 2].min() >= np.cos(np.radians(30.0)) - 1e-12


@pytest.mark.parametrize("shift", [0.0, 1.0])
def test_a_side_that_is_a_point_is_one_at_the_origin_too(shift):
    """It is one up to rounding, sin(π) ≠ 0, which is not less where coordinates are small."""
    z = f"sin(v)*(u - 1)**2 + sin(v)**2 + {shift}"
    tip = gm.Surface.from_sympy(
        ("sin(v)*cos(u)", "sin(v)*sin(u)", z), ("u", "v"), ((0, 2), (1.7, "pi"))
    )
    report = gm.GaussMap(gm.Part([tip])).points(gm.icosphere(3)).report
    assert report.proved == report.normals == 92


def test_a_grid_is_its_spline():
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 6), np.linspace(0.0, 1.0, 5), indexing="ij")
    heights = [np.stack([u + k, v, 0.2 * np.sin(3.0 * (u + k))], axis=-1) for k in (0, 1)]
    surfaces = [gm.Surface.from_grid(x) for x in heights]
    part = gm.Part(surfaces)
    assert (part.open_edges, part.gap < 1e-14) == (6, True)
    samples = gm.sample(part, 50)
    rows = samples.face_index == 1
    on_spline = gm.fit(surfaces[1]).evaluate(*samples.uv[rows].T)
    np.testing.assert_allclose(samples.points[rows], on_spline, atol=1e-12)


# --- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("surfaces", "message"),
    [
        ([], "must be a list of surfaces"),
        ("torus", "must be a list of surfaces"),
        (gm.surfaces.torus(), "must be a list of surfaces"),
        (["torus", 1], "surface 1 must be a Surface, or the name of one, not 1"),
        ([gm.surfaces.torus().trimmed(within=lambda u, v: u < 3)], "'torus' is trimmed by a pred"),
        ([gm.surfaces.torus().trimmed([[(-1, 0), (1, 0), (1, 1)]])], "runs beyond its domain"),
    ],
)
def test_what_is_no_list_of_surfaces(surfaces, message):
    refused(message, gm.Part, surfaces)


def test_surfaces_that_cannot_be_used():
    refused("tolerance must be a positive number", gm.Part, ["torus"], tolerance=0.0)
    with pytest.raises(gm.errors.SurfaceError, match=r"face 0 \('torus'\).* no larger than the"):
        gm.Part(["torus"], tolerance=100.0)
    line = bilinear((0, 0, 0), (1, 0, 0), (1, 0, 0), (0, 0, 0), name="line")
    refused("'line' has no area", gm.Part, [line], error=gm.errors.SurfaceError)
    torn = gm.Surface.from_callable(
        lambda u, v: np.stack([np.where(v > 0.9, np.nan, u), v, u], axis=-1), ((0, 1), (0, 1))
    )
    refused("not finite along its border", gm.Part, [torn], error=gm.errors.SurfaceError)


def test_a_list_in_place_of_a_surface_is_told_of_parts():
    for function in (lambda x: gm.sample(x, 10), gm.GaussMap, gm.fit, gm.plot):
        refused(r"gm\.Part\(", function, ["torus", "sphere"])
