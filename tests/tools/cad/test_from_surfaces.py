"""Parts made of surfaces: shared edges, orientation, gaps, and all that takes a part."""

import itertools
import pickle
import re
from pathlib import Path
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.cad.part_mesh import PartMesh
from gaussmap.tools.cad.surface_geometry import geometry_of_surface

from ...products import covering
from ...refusals import refused
from .made import BEZIER, TURN, UNIT, bezier, circle, has_its_dimensions, moved, rectangle

SURFACES, SURFACE_ERROR = gm.surfaces, gm.errors.SurfaceError


def bilinear(a, b, c, d, **more) -> gm.Surface:
    """Return the surface with corners a at (0, 0), b at (1, 0), c at (1, 1) and d at (0, 1)."""
    return bezier([[a, d], [b, c]], **more)


def cube(size: float = 1.0) -> list[gm.Surface]:
    """Return six squares; those of even places have normals that point inward."""
    found, axes = [], size * np.eye(3)
    for k in range(3):
        across, along = axes[k - 2], axes[k - 1]
        for far in (0.0, 1.0):
            low = far * axes[k]
            found.append(bilinear(low, low + across, low + across + along, low + along))
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
    band = SURFACES.moebius_band()
    return gm.Surface.from_callable(band.function, (u, v), name=name)


def is_outward(part, centre) -> bool:
    samples = gm.sample(part, 100, density="uniform")
    return bool((np.einsum("ij,ij->i", samples.points - centre, samples.normals) > 0.0).all())


SAID = {
    "vertices": lambda x: len(x.arrays["vertices"]),
    "edges": lambda x: len(x.arrays["edge_vertices"]),
    "points": lambda x: int(x.arrays["edge_degenerate"].sum()),
    "solids": lambda x: len(x.solids),
    "reversed": lambda x: [face.reversed for face in x.faces],
    "in_solids": lambda x: [face.solid_index for face in x.faces],
}


def says(part, **wanted: Any) -> None:
    """Check what a part says of itself."""
    found = {x: SAID[x](part) if x in SAID else getattr(part, x) for x in wanted}
    assert found == wanted


def mesh_of(samples: gm.Samples, euler: int, *, closed: bool) -> PartMesh:
    """Return a mesh with as many vertices as there are samples."""
    mesh = samples.mesh()
    assert isinstance(mesh, PartMesh)
    made = len(mesh.vertices), mesh.closed, mesh.euler_characteristic
    assert made == (len(samples), closed, euler)
    return mesh


# --- edges ----------------------------------------------------------------------------------------

NONE, THREE_FLIPPED = pytest.approx(0.0, abs=1e-14), ("3 surfaces are flipped: 0, 2, 4.",)
POLAR = (("u", "v"), ((0, "2*pi"), (0, 1)), (True, False))


SHEET = gm.Surface.from_sympy(("u", "v", "u*v/4"), ("u", "v"), ((0, 2), (0, 2)))


def trimmed_sheet() -> list[gm.Surface]:
    """Return a sheet with a hole, and the disk in it from the other side."""
    hole = 1.0 + circle(0.5, 100)
    plate = SHEET.trimmed([hole, rectangle((0, 2), (0, 2))[[0, 3, 2, 1]]])
    return [plate, SHEET.flipped().trimmed([(2.0, 0.0) - hole * (1, -1)])]


def half_torus(low: float, high: float) -> gm.Surface:
    return SURFACES.torus().trimmed([rectangle((low, high), (0, TURN))])


def polygon(corners: int) -> list[gm.Surface]:
    square = bilinear((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    return [square.trimmed([0.5 + circle(0.4, corners)])]


def case(surfaces, euler: int, **wanted: Any):
    """Return surfaces, the Euler characteristic of their mesh, and what their part says."""
    return surfaces, euler, wanted


UNIT_CUBE = {"volume": pytest.approx(1.0, rel=1e-14), "area": pytest.approx(6.0, rel=1e-14)}
PARTS = {
    "a cube": case(
        cube(), 2, closed=True, open_edges=0, gap=0.0, oriented=True, vertices=8, edges=12,
        warnings=THREE_FLIPPED, reversed=[True, False] * 3, **UNIT_CUBE,
    ),
    # A side that is a point is no border; the seam of the disk is elsewhere.
    "a cone and a disk": case(
        [
            gm.Surface.from_sympy(("v*cos(u)", "v*sin(u)", "1 - v"), *POLAR),
            gm.Surface.from_sympy(("v*cos(u + 1)", "v*sin(u + 1)", "0*u"), *POLAR),
        ],
        2, closed=True, points=2, volume=pytest.approx(np.pi / 3.0, rel=1e-12),
    ),
    # Of an octagon the border turns by 45° at its corners; of 16 points, by 22.5°, it is smooth.
    "an octagon": case(polygon(8), 1, vertices=8),
    "a polygon of 16 corners": case(polygon(16), 1, vertices=1),
    "a trimmed sheet": case(
        trimmed_sheet(), 1, open_edges=4, edges=5, gap=NONE, reversed=[False, True], closed=False,
        area=pytest.approx(gm.Part([SHEET]).area, rel=1e-9),
    ),
    "trimmed halves": case([half_torus(0, 3).flipped(), half_torus(3, TURN)], 0, closed=True),
    "a trimmed half": case([half_torus(0, 3)], 0, closed=False, open_edges=2),
} | {
    name: case(
        [moved(x, shift, scale) for x in cube()], 2, closed=True, warnings=THREE_FLIPPED,
        volume=pytest.approx(scale**3, rel=1e-9),
    )
    for name, scale, shift in (("small", 1e-12, 0.0), ("large", 1e12, 0.0), ("far", 1.0, 1e6))
}  # fmt: skip


@pytest.mark.parametrize("name", PARTS)
def test_edges_are_found(name):
    surfaces, euler, wanted = PARTS[name]
    part = gm.Part(surfaces)
    says(part, **wanted)
    mesh_of(gm.sample(part, 200), euler, closed=part.closed)


def test_six_squares_are_a_cube():
    part = gm.Part(cube(), name="cube")
    assert repr(part) == "Part(cube: 6 faces, 1 solid)"
    assert is_outward(part, (0.5, 0.5, 0.5))
    assert (gm.sample(part, 60, edges=True).report.edge_samples or 0) > 0


def test_an_edge_of_three_faces():
    a, b = (0, 0, 0), (1, 0, 0)
    sheets = [bilinear(a, b, (1, *x), (0, *x)) for x in ((1, 0), (-1, 1), (-1, -1))]
    warnings = ("there is 1 edge of more than two faces.",)
    says(gm.Part(sheets), warnings=warnings, open_edges=9, closed=False, solids=0)


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
    volume = pytest.approx(2.0 * np.pi**2 * 0.4**2, rel=1e-6)
    says(part, closed=True, solids=1, gap=NONE, volume=volume)
    whole = gm.sample(ring((0, TURN), (0, TURN)), 1000)
    samples = gm.sample(part, 1000)
    assert samples.coverage() < 1.15 * whole.coverage()
    assert samples.normal_deviation().space < 1.2 * whole.normal_deviation().space
    mesh = mesh_of(samples, 0, closed=True)
    assert mesh.volume == pytest.approx(part.volume, rel=0.02)
    # The outer half of a torus turns by 4π, the inner half by as much to the other side.
    curvature = samples.gaussian_curvature * samples.weights()
    for side in (1.0, -1.0):
        half = np.maximum(side * curvature, 0.0).sum()
        assert half == pytest.approx(4.0 * np.pi, rel=0.02)


@pytest.mark.parametrize("weight", [3.0, 100.0])
def test_a_common_border_may_have_two_parametrizations(weight):
    # The same parabola with weights 1, w, w² is passed backwards, and at another speed.
    curve = np.array([(0, 0, 0), (1, 0, 1), (2, 0, 0)], dtype=np.float64)
    left = np.stack([np.add(curve, x) for x in ((0, 0, 0), (0, 1, 0.3), (0, 2, 0))], axis=1)
    right = np.stack([curve[::-1] - [0, k, 0] for k in range(3)])
    weights = np.tile([1.0, weight, weight**2], (3, 1))
    knots = BEZIER, 7.0 * np.array(BEZIER) - 2.0
    part = gm.Part([bezier(left), gm.Surface.from_nurbs((2, 2), knots, right, weights)])
    says(part, open_edges=6, closed=False, gap=pytest.approx(0.0, abs=1e-13))
    mesh = mesh_of(gm.sample(part, 200), 1, closed=False)
    (shared,) = [k for k, x in enumerate(np.diff(part.arrays["edge_side_starts"])) if x == 2]
    x, y, z = mesh.vertices[mesh.lines[shared]].T
    np.testing.assert_allclose([y, z], [0.0 * x, x - x * x / 2.0], atol=1e-14)
    rows = mesh.face_index == 1
    x = mesh.vertices[mesh.triangles[rows], 0]
    normals = np.stack([x - 1.0, 0.0 * x, np.ones_like(x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    cosines = np.abs(np.einsum("tkx,tkx->tk", normals, mesh.corner_normals[rows]))
    np.testing.assert_allclose(cosines, 1.0, atol=1e-11)


# --- gaps -----------------------------------------------------------------------------------------


def opened(gap: float) -> list[gm.Surface]:
    """Return a cube whose last side is apart from the others."""
    return [*cube()[:5], moved(cube()[5], (0.0, 0.0, gap))]


def test_gaps_are_measured():
    with pytest.warns(gm.GaussmapWarning, match="nearly coincide, up to 0.001, and stay apart"):
        part = gm.Part(opened(1e-3))
    says(part, closed=False, oriented=False, open_edges=8, gap=0.0)
    refused("enclose no solids", lambda: part.volume, error=SURFACE_ERROR)
    part = gm.Part(opened(1e-3), tolerance=2e-3)
    says(part, closed=True, gap=pytest.approx(1e-3, rel=1e-9))
    mesh_of(gm.sample(part, 200), 2, closed=True)


@pytest.mark.parametrize(("gap", "is_near"), [(0.007, True), (0.014, False)])
def test_edges_nearly_coincide_up_to_a_hundredth_of_their_length(gap, is_near, recwarn):
    says(gm.Part(opened(gap)), open_edges=8)
    assert any("nearly coincide" in str(x.message) for x in recwarn) == is_near


# --- orientation ----------------------------------------------------------------------------------


def test_an_open_set_is_as_its_first_surface():
    pair = [ring((0, 2), (0, 3)), ring((2, 4), (0, 3), flipped=True)]
    says(gm.Part(pair), reversed=[False, True], warnings=("surface 1 ('ring') is flipped.",))
    says(gm.Part(pair[::-1]), reversed=[False, True])


def test_one_surface():
    part = gm.Part([SURFACES.sphere().flipped(), "plane"])  # two sets
    kinds = [(x.kind, x.name) for x in part.faces]
    assert kinds == [("sphere", "sphere"), ("plane", "plane")]
    says(part, reversed=[True, False], in_solids=[0, -1], solids=1, oriented=False, closed=False)
    alone = part.select(index=[0])
    says(alone, closed=True, area=pytest.approx(4.0 * np.pi, rel=1e-9))
    assert is_outward(alone, 0.0)


def test_a_set_with_one_side_is_refused():
    (low, high), v = SURFACES.moebius_band().domain
    ends = np.linspace(low, high, 4)
    strips = [strip((a, b), v, "band") for a, b in itertools.pairwise(ends)]
    says(gm.Part(strips[:2]), open_edges=6)
    for surfaces in (strips, [SURFACES.moebius_band()]):
        refused("band'\\) closes a band that has one side", gm.Part, surfaces)


def ball(radius, centre=(0.0, 0.0, 0.0), *, flipped=False):
    surface = moved(SURFACES.sphere(), centre, radius)
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
    # A ball in a hollow of the block, and two bodies beside it.
    in_solids = [0] * 6 + [2, 1] + [2] * 6 + [3]
    volume = pytest.approx(125.125 + 4.0 / 3.0 * np.pi * (1.0 + 0.6**3 - 1.5**3), rel=1e-9)
    says(part, closed=True, oriented=True, solids=4, in_solids=in_solids, volume=volume)
    hollow = gm.sample(part.select(index=[6]), 50)
    assert (np.einsum("kx,kx->k", hollow.points, hollow.normals) < 0.0).all()
    assert part.faces[6].dimensions["hollow"]


@pytest.mark.parametrize(
    ("radius", "centre", "sign", "solids"),
    [
        pytest.param(1.0 - 1e-3, (0.0, 0.0, 0.0), -1.0, 1, id="thin wall"),
        pytest.param(0.8, (0.2 - 1e-6, 0.0, 0.0), -1.0, 1, id="wall that is thin at one place"),
        pytest.param(0.5, (0.7, 0.0, 0.0), 1.0, 2, id="crossing"),
        pytest.param(0.5, (1.6, 0.0, 0.0), 1.0, 2, id="outside"),
        pytest.param(0.05, (0.9, 0.9, 0.9), 1.0, 2, id="in a corner of the box around it"),
    ],
)
def test_only_a_ball_inside_another_is_a_hollow(radius, centre, sign, solids):
    volume = pytest.approx(4.0 / 3.0 * np.pi * (1.0 + sign * radius**3), rel=1e-9)
    says(gm.Part([ball(1.0), ball(radius, centre)]), volume=volume, solids=solids)


# --- kinds and units ------------------------------------------------------------------------------

TILTED = 2.0 * np.linalg.qr(np.array([(3.0, 1, 2), (1, 4, 1), (2, -1, 5)]))[0]
MIRROR = np.diag([1.0, -1.0, 1.0])
SHEAR = np.array([(1.0, 0.5, 0.0), (0.0, 2.0, 0.3), (0.2, 0.0, 1.0)])


@covering(
    is_flipped=[False, True],
    matrix=[np.eye(3), TILTED, MIRROR],
    **{
        "surface, kind": [
            (SURFACES.plane(0.5, -2.0), "plane"),
            (SURFACES.cylinder(0.5, 3.0), "cylinder"),
            (SURFACES.cone(1.0, 0.25, 1.0), "cone"),
            (SURFACES.cone(0.25, 0.25, 3.0), "cylinder"),
            (SURFACES.sphere(1.5), "sphere"),
            (SURFACES.torus(2.0, 0.5), "torus"),
        ]
    },
)
def test_kinds_and_dimensions(surface, kind, matrix, is_flipped):
    shift = np.array([3.0, -2.0, 5.0])
    placed = np.block([[matrix, shift[:, None]], [np.zeros(3), 1.0]])
    given = surface.transformed(placed)
    given = given.flipped() if is_flipped else given
    (low, high), (first, last) = given.domain
    middle = (low + high) / 2.0
    given = given.trimmed([[(low, first), (middle, first), (middle, last), (low, last)]])
    part = gm.Part([given])
    (face,) = part.faces
    assert face.kind == kind
    has_its_dimensions(part)
    assert face.dimensions.get("hollow", is_flipped) == is_flipped
    u, v = (np.linspace(a, b, 7)[1:-1] for a, b in ((low, middle), (first, last)))
    jets = given.jets(u, v)
    _, own = geometry_of_surface(given)
    again = face.surface.jets(*(own @ [u, v]))
    tangents = np.einsum("ij,kix->kjx", own, again[:, 1:3])
    np.testing.assert_allclose(again[:, 0], jets[:, 0], atol=1e-13)
    np.testing.assert_allclose(tangents, jets[:, 1:3], atol=1e-13)
    trim = face.surface.trim
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
    (face,) = gm.Part([SURFACES.surface(surface).transformed(matrix)]).faces
    assert face.kind == kind


def test_units():
    part = gm.Part([SURFACES.cylinder(0.5)], unit="inch", name="tube")
    assert repr(part) == "Part(tube: 1 face, 0 solids, in)"
    says(part, unit="in", metres=0.0254)
    samples = gm.sample(part.select(kind="cylinder"), 20, coverage=0.5)
    assert re.search(r"within 0\.\d+ in of a sample; 1 face$", samples.summary())
    assert gm.GaussMap(part).points([[1, 0, 0]]).report.unit == "in"
    assert gm.Part(["torus"]).unit == ""
    refused("unit must be one of nm, um, mm", gm.Part, ["torus"], unit="furlong")


# --- what takes parts -----------------------------------------------------------------------------


def test_nurbs_are_saved_moved_and_flipped(tmp_path):
    sides = [moved(x, (1.0, 2.0, 3.0), 2.0) for x in cube()]
    sides[2] = sides[2].flipped()
    points = [[(x, y, z) for y in (0, 1)] for x, z in ((0, 0), (1, 1), (2, 0))]
    arch = bezier(points, [[1, 1], [2, 2], [1, 1]])
    for surface in (arch, arch.flipped(), moved(arch, (1, 2, 3), -2.0)):
        face = gm.Part([surface]).faces[0]
        u, v = np.random.default_rng(0).random((2, 10))
        np.testing.assert_allclose(face.surface.jets(u, v), surface.jets(u, v), atol=1e-13)
    part = gm.Part(sides)
    part.save(tmp_path / "part.npz")
    again = gm.read_part(tmp_path / "part.npz")
    assert [x.kind for x in again.faces] == ["nurbs"] * 6
    says(again, closed=True, warnings=("2 surfaces are flipped: 0, 4.",))
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
    says(part, open_edges=6, gap=NONE)
    samples = gm.sample(part, 50)
    rows = samples.face_index == 1
    on_spline = gm.fit(surfaces[1]).evaluate(*samples.uv[rows].T)
    np.testing.assert_allclose(samples.points[rows], on_spline, atol=1e-12)


# --- refusals -------------------------------------------------------------------------------------


LINE = bilinear((0, 0, 0), (1, 0, 0), (1, 0, 0), (0, 0, 0), name="line")
TORN = gm.Surface.from_callable(
    lambda u, v: np.stack([np.where(v > 0.9, np.nan, u), v, u], axis=-1), (UNIT, UNIT)
)


INPUT_ERROR, NO_LIST = gm.errors.InputError, "must be a list of surfaces"
PREDICATE = SURFACES.torus().trimmed(within=lambda u, v: u < 3)
BEYOND = SURFACES.torus().trimmed([[(-1, 0), (1, 0), (1, 1)]])


@pytest.mark.parametrize(
    ("surfaces", "tolerance", "error", "message"),
    [
        ([], None, INPUT_ERROR, NO_LIST),
        ("torus", None, INPUT_ERROR, NO_LIST),
        (SURFACES.torus(), None, INPUT_ERROR, NO_LIST),
        (["torus", 1], None, INPUT_ERROR, "surface 1 must be a Surface, or the name of one, not 1"),
        ([PREDICATE], None, INPUT_ERROR, "'torus' is trimmed by a pred"),
        ([BEYOND], None, INPUT_ERROR, "runs beyond its domain"),
        (["torus"], 0.0, INPUT_ERROR, "tolerance must be a positive number"),
        (["torus"], 100.0, SURFACE_ERROR, r"face 0 \('torus'\).* no larger than the"),
        ([LINE], None, SURFACE_ERROR, "'line' has no area"),
        ([TORN], None, SURFACE_ERROR, "not finite along its border"),
    ],
)
def test_what_is_no_part(surfaces, tolerance, error, message):
    refused(message, gm.Part, surfaces, tolerance=tolerance, error=error)


def test_a_list_in_place_of_a_surface_is_told_of_parts():
    for function in (lambda x: gm.sample(x, 10), gm.GaussMap, gm.fit, gm.plot):
        refused(r"gm\.Part\(", function, ["torus", "sphere"])


# --- Newell's teapot: 32 patches that are sewn, with the borders that it really has ---------------

QUARTER = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])


def patches() -> list[gm.Surface]:
    text = (Path(__file__).parent / "teapot.txt").read_text(encoding="utf-8")
    lines = [x for x in text.splitlines() if not x.startswith("#")]
    found = []
    for k in range(0, len(lines), 5):
        points = np.array([x.split() for x in lines[k + 1 : k + 5]], dtype=np.float64)
        points = points.reshape(4, 4, 3).swapaxes(0, 1)  # so that normals of the body point outward
        copies = 2 if lines[k] in ("handle", "spout") else 4
        for turn in range(copies):
            matrix = np.linalg.matrix_power(MIRROR if copies == 2 else QUARTER, turn)
            found.append(bezier(points @ matrix.T, name=lines[k]))
    return found


def open_edges(part) -> dict[str, int]:
    """Return how many edges of faces with each name have no other face."""
    starts, found = part.arrays["edge_side_starts"], dict[str, int]()
    single = (np.diff(starts) == 1) & ~part.arrays["edge_degenerate"]
    for face in part.arrays["side_faces"][starts[:-1][single]].tolist():
        name = part.faces[face].name
        found[name] = found.get(name, 0) + 1
    return found


@pytest.fixture(scope="module")
def teapot():
    return gm.Part(patches(), tolerance=3e-3, name="teapot")


def test_body_and_bottom_lid_handle_and_spout_are_sewn(teapot):
    """The lid lies inside of the rim; handle and spout begin inside of the body."""
    assert (len(teapot), teapot.closed, teapot.oriented) == (32, False, False)
    assert teapot.gap < 1e-14
    assert open_edges(teapot) == {"rim": 4, "lid": 4, "handle": 4, "spout": 4}
    assert teapot.warnings == ("4 surfaces are flipped: 25, 27, 29, 31.",)
    np.testing.assert_allclose(teapot.bounds[1], [3.434075, 2.0, 3.15], atol=1e-6)


def test_the_tip_of_the_lid_is_no_point(teapot):
    """Its four patches end in loops of 0.002, which a small tolerance does not take for points."""
    part = gm.Part([x for x in patches() if x.name == "lid"])
    assert open_edges(part) == {"lid": 8}
    assert int(part.arrays["edge_degenerate"].sum()) == 0
    assert int(teapot.arrays["edge_degenerate"].sum()) == 8  # those of the bottom, too


@pytest.mark.slow
def test_it_is_sampled_and_meshed(teapot):
    samples = gm.sample(teapot, 3000)
    faces = np.asarray(samples.face_index).tolist()
    assert set(faces) == set(range(32))
    rows = [teapot.faces[k].name == "body" for k in faces]
    away = np.einsum("kx,kx->k", samples.normals[rows, :2], samples.points[rows, :2])
    assert (away > 0.0).all()
    mesh: Any = samples.mesh()
    assert (len(mesh.vertices), mesh.failed, mesh.closed) == (3000, {}, False)
    # A body, a lid, and two tubes, one of which touches a corner of the body.
    assert mesh.euler_characteristic == 1
