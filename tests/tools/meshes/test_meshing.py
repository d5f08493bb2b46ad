"""Meshes through samples: topology, seams, poles, borders, flips, and samples that are too few."""

import pickle
from collections.abc import Callable
from typing import Any, Literal

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.samples.report import SamplingReport
from gaussmap.tools.meshes import triangulation
from gaussmap.tools.meshes.links import neighbours
from gaussmap.tools.meshes.meshing import triangulated
from gaussmap.tools.meshes.triangulated import Triangulated, flip_edges
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ...products import covering
from ...refusals import refused
from ...shapes import TURN, klein, klein_bottle, moved

pytestmark = pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")
compiled = pytest.mark.compiled

NO_AREA = np.degrees(1e-6)  # of the smallest angle
CAP = gm.icosphere(24)[gm.icosphere(24)[:, 2] > 0.9]


def latitude(u: Any, v: Any) -> Any:
    return np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)


surfaces: dict[str, tuple[Callable[[], gm.Surface], int, int]] = {
    # surface, Euler characteristic, number of borders
    "torus": (gm.surfaces.torus, 0, 0),
    "cyclide": (gm.surfaces.dupin_cyclide, 0, 0),
    "sphere": (gm.surfaces.sphere, 2, 0),
    "ellipsoid": (gm.surfaces.ellipsoid, 2, 0),
    "graph": (gm.surfaces.wavy_graph, 1, 1),
    "helicoid": (gm.surfaces.helicoid, 1, 1),
    "belt": (gm.surfaces.ellipsoid_patch, 0, 2),
    "catenoid": (gm.surfaces.catenoid, 0, 2),
    "moebius": (gm.surfaces.moebius_band, 0, 1),
    "klein": (klein_bottle, 0, 0),
    "klein, v flips": (
        lambda: gm.Surface.from_callable(
            lambda u, v: klein(v, u), ((-np.pi, np.pi), TURN), (True, "mirrored")
        ), 0, 0,
    ),
    "dome": (
        lambda: gm.Surface.from_callable(
            latitude, (TURN, (0.0, np.pi / 2)), (True, ("open", "pole"))
        ), 1, 1,
    ),
    "dome, pole first": (
        lambda: gm.Surface.from_callable(
            latitude, (TURN, (-np.pi / 2, 0.0)), (True, ("pole", "open"))
        ), 1, 1,
    ),
    "belt, v closes": (
        lambda: gm.Surface.from_callable(
            lambda u, v: latitude(v, u), ((-1.0, 1.0), TURN), (False, True)
        ), 0, 2,
    ),
}  # fmt: skip
# Without compilation a few kinds are enough.
UNCOMPILED = ("sphere", "helicoid", "catenoid", "klein")
FEW_UNCOMPILED = pytest.mark.parametrize(
    "name", [x if x in UNCOMPILED else pytest.param(x, marks=compiled) for x in surfaces]
)
PREFER: tuple[Literal["shape", "normals"], ...] = ("shape", "normals")


def mesh_of(name: str, prefer: Literal["shape", "normals"] = "shape", **options: Any) -> gm.Mesh:
    return gm.sample(surfaces[name][0](), **(options or {"count": 600})).mesh(prefer=prefer)


def components(edges: np.ndarray) -> int:
    """Return how many closed lines edges make: each vertex is in two of them."""
    assert (np.unique(edges, return_counts=True)[1] == 2).all()
    return connected(*edges.T)


def connected(one: np.ndarray, other: np.ndarray) -> int:
    """Return the number of components of a graph with edges between the nodes of two arrays."""
    names, nodes = np.unique([one, other], return_inverse=True)
    graph = coo_array((np.ones(len(one)), tuple(nodes.reshape(2, -1))), (len(names), len(names)))
    return connected_components(graph, directed=False)[0]


def check_topology(mesh: gm.Mesh, characteristic: int, borders: int) -> None:
    """Check that a mesh is a surface with a given Euler characteristic and number of borders.

    The edges opposite to each vertex make one line, open or closed.
    """
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    times = np.unique(edges, axis=0, return_counts=True)[1]
    assert set(times.tolist()) == ({1, 2} if borders else {2})
    assert mesh.euler_characteristic == characteristic
    assert (components(mesh.boundary_edges) if borders else 0) == borders
    vertex, *opposite = mesh.triangles[:, [[0, 1, 2], [1, 2, 0], [2, 0, 1]]].reshape(-1, 3).T
    count = len(mesh.vertices)
    assert connected(*(count * vertex + x for x in opposite)) == count


def on_spline(spline: gm.Spline, uv: np.ndarray, **more: Any) -> gm.Samples:
    """Return samples at parameters: a mesh needs no more of them than points and normals."""
    report = SamplingReport("", None, len(uv), None, None, None)
    points, normals = spline.evaluate(*uv.T), spline.normals(*uv.T)
    return gm.Samples(points=points, normals=normals, uv=uv, report=report, spline=spline, **more)


def samples_at(name: str, count: int) -> gm.Samples:
    """Return samples at random parameters."""
    spline = gm.fit(surfaces[name][0](), cells=(8, 8))
    low, high = np.array(spline.domain).T
    return on_spline(spline, np.random.default_rng(1).uniform(low, high, (count, 2)))


@pytest.mark.parametrize("prefer", PREFER)
@FEW_UNCOMPILED
def test_samples_anywhere(name, prefer):
    mesh = samples_at(name, 100).mesh(prefer=prefer)
    check_topology(mesh, *surfaces[name][1:])
    assert mesh.smallest_angles.min() > NO_AREA
    assert prefer == "shape" or (mesh.sample_index >= 0).sum() == 100


def figure_eight(width=1):
    """Return a figure eight that is turned: it has four narrow bends."""
    around = f"(2 + sin(v)/{width})"
    return gm.Surface.from_sympy(
        (f"{around}*cos(u)", f"{around}*sin(u)", "sin(2*v)/2"), ("u", "v"),
        ((0, "2*pi"), (0, "2*pi")), (True, True),
    )  # fmt: skip


@compiled
class TestTopology:
    @covering(
        name=surfaces,
        prefer=PREFER,
        asked=[{"count": 60}, {"count": 600}, {"normals": gm.icosphere(12)}],
    )
    def test_it_is_that_of_the_surface(self, name, prefer, asked):
        """Triangles are seen counterclockwise from where normals point.

        Of normals in symmetry planes, four samples and more are on one circle, and samples are on
        seams, at poles and at corners.
        """
        mesh = mesh_of(name, prefer, **asked)
        check_topology(mesh, *surfaces[name][1:])
        # no two vertices at one place, but for those that immersions bring together
        rounded = np.round(mesh.vertices / np.ptp(mesh.vertices, axis=0).max(), 9)
        assert len(np.unique(rounded, axis=0)) == len(rounded) or name.startswith("klein")
        if name.startswith(("klein", "moebius")):
            assert (mesh.sides[:, 0] == 1).all()
            assert 0 < (mesh.sides == -1).any(axis=1).mean() < 0.25 or asked == {"count": 60}
        else:
            directed = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
            assert len(np.unique(directed, axis=0)) == len(directed)
            assert (mesh.sides == 1).all()
        assert mesh.angles.max() < 90.0 or asked != {"count": 600}

    def test_a_pole_is_one_vertex_with_the_normal_of_those_round_it(self):
        samples = gm.sample(gm.surfaces.ellipsoid(a=2, b=1, c=1), count=600, density="gauss")
        mesh = samples.mesh()
        poles = mesh.sample_index == -1
        assert poles.sum() == 2
        assert isinstance(samples.surface, gm.Surface)
        ends = samples.surface.evaluate(0.0, [-np.pi / 2, np.pi / 2])
        order = np.argsort(mesh.vertices[poles, 2])
        np.testing.assert_array_equal(mesh.vertices[poles][order], ends)
        # the mean normal of vertices that are up to 20 degrees away
        assert (mesh.normals[poles, 2][order] * [-1, 1] > np.cos(np.radians(20))).all()

    def test_a_sample_at_a_pole_is_the_pole(self):
        mesh = mesh_of("sphere", normals=np.concatenate([gm.fibonacci(100), [[0, 0, 1]]]))
        assert (mesh.vertices[:, 2] > 1 - 1e-6).sum() == 1
        assert mesh.euler_characteristic == 2


@compiled
class TestBorders:
    def test_a_graph_is_meshed_up_to_its_corners(self):
        mesh = mesh_of("graph", count=1000)
        border = np.unique(mesh.boundary_edges)
        u, v = mesh.uv[border].T
        assert ((np.abs(u) == 1.0) | (np.abs(v) == 1.0)).all()
        corners = mesh.uv[(np.abs(mesh.uv) == 1.0).all(axis=1)]
        assert sorted(map(tuple, corners)) == [(-1, -1), (-1, 1), (1, -1), (1, 1)]
        # what the triangles cover in (u, v) is the whole square
        a, b, c = np.moveaxis(mesh.uv[mesh.triangles], 1, 0)
        areas = np.linalg.det(np.stack([b - a, c - a], axis=1)) / 2
        assert areas.sum() == pytest.approx(4.0, rel=1e-12)

    def test_added_points_are_about_as_far_apart_as_samples_near_them(self):
        """On a belt of the unit sphere S samples have the distance √(4π/S); see border_spacing.

        The fourth nearest of random points is √(4/(ρ π/2)) away to within its scatter 1/√4.
        """
        mesh = mesh_of("belt, v closes", "normals", normals=gm.fibonacci(4000))
        for low in (True, False):
            added = (mesh.sample_index < 0) & ((mesh.uv[:, 0] < 0) == low)
            spacing = 2 * np.pi * np.cos(1.0) / added.sum()
            assert spacing == pytest.approx(np.sqrt(4 * np.pi / 4000), rel=0.5)

    def test_samples_on_the_border_are_its_vertices(self):
        """The saddle z = u v over [−1, 1]² has the normals (−v, −u, 1)."""
        saddle = gm.Surface.from_callable(
            lambda u, v: np.stack([u, v, u * v], axis=-1), ((-1, 1), (-1, 1))
        )
        u, v = (x.ravel() for x in np.meshgrid(*[np.linspace(-1, 1, 9)] * 2, indexing="ij"))
        samples = gm.sample(
            saddle, normals=np.stack([-v, -u, np.ones_like(u)], axis=1), cells=(4, 4)
        )
        on_border = (np.abs(samples.uv) > 1 - 1e-9).any(axis=1).sum()
        assert on_border > 8
        mesh = samples.mesh()
        border = np.unique(mesh.boundary_edges)
        assert (mesh.sample_index[border] >= 0).sum() == on_border
        assert mesh.euler_characteristic == 1
        a, b, c = np.moveaxis(mesh.uv[mesh.triangles], 1, 0)
        assert (np.linalg.det(np.stack([b - a, c - a], axis=1)) > 1e-6).all()

    def test_a_side_that_is_one_point(self):
        """The pole of a paraboloid that nobody called one: an open end of length 0."""
        bowl = gm.Surface.from_callable(
            lambda u, v: np.stack([v * np.cos(u), v * np.sin(u), v**2], axis=-1),
            (TURN, (0.0, 1.0)), (True, False),
        )  # fmt: skip
        mesh = gm.sample(bowl, count=300).mesh()
        check_topology(mesh, 1, 1)
        assert (np.linalg.norm(mesh.vertices, axis=1) < 1e-9).sum() <= 1
        assert np.isfinite(mesh.normals).all()


@compiled
class TestFlips:
    @pytest.mark.parametrize("name", ["torus", "graph", "moebius", "klein"])
    @pytest.mark.quick_for("torus", "graph", "moebius")
    def test_no_flip_is_left_that_helps(self, name):
        """Each pair of triangles is compared with the other one, in NumPy."""
        samples = gm.sample(surfaces[name][0](), count=150)
        assert isinstance(samples.spline, gm.Spline)
        state = triangulated(samples, samples.spline)
        assert flip_edges(state, "normals") > 0
        assert flip_edges(state, "normals") == 0
        fresh, is_whole = neighbours(state.triangles, np.ones(len(state.points), dtype=bool))
        assert is_whole
        np.testing.assert_array_equal(state.neighbours, fresh)
        joined = {tuple(x) for x in np.sort(state.mesh(len(samples)).edges, axis=1).tolist()}
        for t, k in np.ndindex(len(state.triangles), 3):
            if state.neighbours[t, k] >= 0:
                before, after, edge = flipped(state, t, k, int(state.neighbours[t, k]))
                assert tuple(sorted(edge)) in joined or after <= before + 1e-12


@compiled
class TestShape:
    """Small angles: 5 % below 25° and one in a thousand below 5° at most; and no folds."""

    @pytest.mark.parametrize("name", ["torus", "cylinder", "sphere"])
    def test_angles_of_triangles(self, name):
        samples = gm.sample(name, count=3000)
        shape, normals = (samples.mesh(prefer=x) for x in PREFER)
        angles = shape.smallest_angles
        border = np.isin(shape.triangles, np.unique(shape.boundary_edges)).any(axis=1)
        assert np.quantile(angles[~border], 0.05) >= 25.0
        assert (angles < 5.0).mean() <= 1e-3
        # Of a cylinder, three samples on one ruling can be left as a triangle without area.
        assert (normals.smallest_angles < NO_AREA).sum() <= (name == "cylinder")
        # Flips leave triangles that are farther than 30 degrees from normals, and turn none as far;
        # the cosine falls by 0.1 more where an edge is collapsed.
        assert isinstance(samples.spline, gm.Spline)
        state, least = triangulated(samples, samples.spline), np.cos(np.radians(30.0))
        flip_edges(state, "shape", least)
        assert np.cos(np.radians(shape.angles.max())) > min(state.cosines().min(), least) - 0.1
        assert normals.angles.mean() < shape.angles.mean() or name == "sphere"
        assert shape.euler_characteristic == normals.euler_characteristic

    @pytest.mark.parametrize(
        ("surface", "count", "density", "left_out", "share", "turned"),
        [
            # Triangles turn by 30 degrees for better angles, and not more.
            ("dupin_cyclide", 600, "balanced", (0, 0), 0.0, 30.0),
            # Samples of density |K| are uneven.
            ("dupin_cyclide", 600, "gauss", (1, 39), 0.05, 90.0),
            ("helicoid", 200, "balanced", (1, 14), 0.05, 90.0),
            # Beside narrow bends, samples without graded sizes are twice as dense from one row to
            # the next.
            *((figure_eight(1), x, "balanced", (0, 0), 0.05, 90.0) for x in (500, 1000, 2000)),
            (figure_eight(2), 1000, "balanced", (0, 0), 0.05, 90.0),
            # Triangles of a one-sided surface keep their sides.
            (surfaces["klein"][0](), 1200, "gauss", (61, 120), 0.5, 120.0),
        ],
    )
    def test_samples_are_left_out_until_few_angles_are_small(
        self, surface, count, density, left_out, share, turned
    ):
        mesh = gm.sample(surface, count, density=density, cells=(32, 32)).mesh()
        border = np.isin(mesh.triangles, np.unique(mesh.boundary_edges)).any(axis=1)
        assert np.quantile(mesh.smallest_angles[~border], share) >= 25.0
        assert left_out[0] <= mesh.left_out <= left_out[1]
        assert mesh.angles.max() < turned
        assert mesh.euler_characteristic == int(surface == "helicoid")

    def test_flips_make_triangles_delaunay(self):
        """No point of a pair of triangles lies in the circle of the other: angles sum up to π."""
        mesh = gm.sample(gm.surfaces.torus(), count=500).mesh()
        corners = mesh.vertices[mesh.triangles]
        sums: dict[tuple[int, int], float] = {}
        for k in range(3):
            e, f = (corners[:, (k + x) % 3] - corners[:, k] for x in (1, 2))
            angles = np.arccos((e * f).sum(axis=1) / lengths(e) / lengths(f))
            for edge, angle in zip(np.roll(mesh.triangles, -k - 1, axis=1), angles, strict=True):
                key = tuple(sorted(edge[:2].tolist()))
                sums[key] = sums.get(key, 0.0) + float(angle)
        # The triangles of a pair are in two planes: the sum is that of the plane up to the angle
        # between them, squared.
        assert max(sums.values()) < np.pi + 0.1

    @covering(prefer=PREFER, gap=[1e-3, 1e-6, 1e-9, 1e-12])
    def test_samples_that_nearly_coincide(self, prefer, gap):
        first = samples_at("torus", 200)
        spline = first.spline
        assert isinstance(spline, gm.Spline)
        uv = np.concatenate([first.uv, first.uv[:50] + gap * np.array([0.6, 0.8])])
        mesh = on_spline(spline, uv).mesh(prefer=prefer)
        assert mesh.euler_characteristic == 0
        assert mesh.smallest_angles.min() > (5.0 if prefer == "shape" else NO_AREA)
        assert mesh.angles.max() < 1.1 * first.mesh(prefer=prefer).angles.max()
        assert prefer == "shape" or len(mesh.vertices) == (250 if gap >= 1e-3 else 200)

    @pytest.mark.parametrize("prefer", PREFER)
    def test_samples_in_line(self, prefer):
        """On the rulings of a cylinder; on its borders and close to them, too."""
        spline = gm.fit(gm.surfaces.cylinder(), cells=(8, 8))
        (u0, u1), (v0, v1) = spline.domain
        u, v = np.meshgrid(np.linspace(u0, u1, 9)[:-1], [0.0, 1e-9, 1e-5, 0.3, 0.5, 0.7, 1.0])
        uv = np.column_stack([u.ravel(), v0 + (v1 - v0) * v.ravel()])
        mesh = on_spline(spline, uv).mesh(prefer=prefer)
        check_topology(mesh, 0, 2)
        assert mesh.smallest_angles.min() > NO_AREA

    def test_triangles_across_gaps_cost_no_samples(self):
        samples = gm.sample(gm.surfaces.torus(), count=2000)
        part = samples[samples.points[:, 0] > 0.3]
        mesh = part.mesh(angle=25.0)
        assert len(mesh.vertices) > 0.98 * len(part)
        assert mesh.angles.max() <= 25.0
        assert np.quantile(mesh.smallest_angles, 0.05) > 25.0


def lengths(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=-1)


def flipped(state: Triangulated, t: int, k: int, other: int) -> tuple[float, float, set[int]]:
    """Return the smallest cosine of two triangles, that of the two others, and their edge."""
    c, a, b = np.roll(state.triangles[t], -k)
    side = dict(zip((c, a, b), np.roll(state.sides[t], -k), strict=True))
    (at,) = set(range(3)) - {list(state.triangles[other]).index(x) for x in (a, b)}
    d = state.triangles[other, at]
    there = dict(zip(state.triangles[other], state.sides[other], strict=True))
    side[d] = there[d] * there[a] * side[a]

    def cosine(*corners: int) -> float:
        p, q, r = state.points[list(corners)]
        normal = np.cross(q - p, r - p)
        normal /= np.linalg.norm(normal)
        return min(float(side[x] * (normal @ state.normals[x])) for x in corners)

    before = min(cosine(c, a, b), cosine(d, b, a))
    return before, min(cosine(c, a, d), cosine(d, b, c)), {int(c), int(d)}


@compiled
class TestInput:
    def test_samples_at_one_place_are_one_vertex(self):
        samples = gm.sample(gm.surfaces.torus(), count=300)
        twice = samples[np.concatenate([np.arange(len(samples))] * 2)]
        mesh = twice.mesh()
        assert len(mesh.vertices) == len(samples)
        assert sorted(mesh.sample_index.tolist()) == list(range(len(samples)))

    def test_a_point_on_the_seam_given_on_both_sides_is_one_vertex(self):
        samples = gm.sample(gm.surfaces.torus(), normals=gm.icosphere(8))
        samples = samples[samples.component == gm.Component.REGULAR]
        uv = samples.uv.copy()
        on_seam = np.abs(np.remainder(uv[:, 0] + 1.0, 2 * np.pi) - 1.0) < 1e-12
        assert on_seam.any()
        uv[on_seam, 0] = 0.0
        other = uv.copy()
        other[on_seam, 0] = 2 * np.pi
        arrays: dict[str, Any] = {name: getattr(samples, name) for name in samples.fields}
        parts = [
            gm.Samples(**{**arrays, "uv": x}, report=samples.report, spline=samples.spline)
            for x in (uv, other)
        ]
        mesh = gm.Samples.concatenate(parts).mesh(prefer="normals")
        assert len(mesh.vertices) == len(samples)
        assert mesh.euler_characteristic == 0

    @pytest.mark.parametrize("scale", [1e-12, 1e12, 1e-100, 1e100])
    def test_scale_changes_nothing(self, scale):
        """But rounding: a power of two next to the scale changes nothing at all."""
        small = gm.surfaces.torus()
        large = moved(small, 2.0 ** round(np.log2(scale)))
        ours, theirs = (
            gm.sample(x, normals=gm.fibonacci(300), cells=(32, 32), on="spline").mesh()
            for x in (large, small)
        )
        np.testing.assert_array_equal(ours.triangles, theirs.triangles)

    def test_far_from_the_origin(self):
        near = gm.surfaces.torus()
        far = moved(near, shift=1e6)
        ours, theirs = (gm.sample(x, normals=gm.fibonacci(300)).mesh() for x in (far, near))
        assert ours.euler_characteristic == 0
        # points are rounded to 1e-10, which turns triangles of the size 0.1 by 1e-9
        assert ours.angles.max() == pytest.approx(theirs.angles.max(), abs=1e-4)

    def test_float32_samples_give_a_mesh_in_float64(self):
        mesh = gm.sample(gm.surfaces.torus(), count=1000, dtype=np.float32).mesh()
        assert mesh.euler_characteristic == 0
        assert mesh.vertices.dtype == np.float64

    def test_the_normals_asked_do_not_matter(self):
        samples = gm.sample(gm.surfaces.torus(), count=300)
        lean = gm.sample(gm.surfaces.torus(), count=300, fields=("points", "normals", "uv"))
        np.testing.assert_array_equal(lean.mesh().triangles, samples.mesh().triangles)

    def test_part_of_the_surface(self):
        """Normals in a cap give an upper ring of the torus; triangles across the rest go."""
        samples = gm.sample(gm.surfaces.torus(), normals=CAP)
        whole, part = samples.mesh(prefer="normals"), samples.mesh(angle=20)
        assert (len(whole.boundary_edges), whole.euler_characteristic) == (0, 0)
        assert part.angles.max() <= 20.0
        assert len(part.triangles) < len(whole.triangles)
        assert len(part.boundary_edges) > 0
        assert whole.angles.max() > 90.0
        # The normals of the cap are up to 25.8° from the axis: they reach r (1 − cos) down.
        assert part.vertices[:, 2].min() > 0.35 * 0.9 - 1e-3

    def test_an_angle_of_180_degrees_leaves_out_nothing(self):
        samples = gm.sample(gm.surfaces.torus(), count=200)
        assert len(samples.mesh(angle=180).triangles) == 400

    @pytest.mark.parametrize("name", ["torus", "sphere", "klein"])
    @pytest.mark.parametrize("count", [1, 2, 3, 5])
    @pytest.mark.quick_for("torus", "sphere")
    def test_too_few_samples_for_a_closed_surface(self, name, count):
        samples = gm.sample(surfaces[name][0](), count=100, density="gauss")[:count]
        if name == "sphere" and count > 1:
            mesh = samples.mesh()  # and two poles
            assert mesh.euler_characteristic == 2
        else:
            refused("too few, or leave too large gaps", samples.mesh)

    @covering(name=["graph", "belt", "moebius"], count=[1, 2, 3])
    def test_a_border_needs_few_samples(self, name, count):
        mesh = gm.sample(surfaces[name][0](), count=100)[:count].mesh(prefer="normals")
        assert mesh.euler_characteristic == surfaces[name][1]
        assert (mesh.sample_index >= 0).sum() == count

    @pytest.mark.parametrize("name", ["torus", "sphere", "graph", "belt"])
    def test_samples_in_line(self, name):
        """On a line of the parameters: whole, or an error that says why not."""
        surface = surfaces[name][0]()
        spline = gm.fit(surface)
        (u0, u1), (v0, v1) = surface.domain
        u, v = np.linspace(u0, u1, 20)[1:-1], np.full(18, (0.7 * v0 + 0.3 * v1))
        samples = on_spline(spline, np.column_stack([u, v]))
        if name == "torus":  # on one circle: triangles would have a corner twice
            refused("leave too large gaps", samples.mesh)
        else:
            assert samples.mesh().euler_characteristic == surfaces[name][1]

    def test_ruled_samples(self):
        """Normals of a cone come in lines that rounding bends: flips have to end."""
        mesh = gm.sample(gm.surfaces.cone(), count=3000).mesh()
        assert mesh.euler_characteristic == 0

    def test_what_is_refused(self):
        """The domain of the cylinder ends at v = 1/2, that of the graph at 1."""
        samples, other = gm.sample(gm.surfaces.wavy_graph(), count=100), gm.surfaces.cylinder()
        refused("there are no samples", samples[:0].mesh)
        refused("lies outside the domain", samples.mesh, gm.fit(other))
        refused("spline must be a Spline, not Surface", samples.mesh, other)
        for angle in (0, -1, 181, np.nan, np.inf, "20", True):
            refused("^angle must ", samples.mesh, angle=angle)
        for prefer in ("angles", None, 1, ["shape"]):
            refused("prefer must be 'shape' or 'normals', not", samples.mesh, prefer=prefer)


@compiled
class TestOffsets:
    @covering(prefer=PREFER, name=["torus", "sphere", "graph", "dome"])
    def test_an_offset_has_the_topology_of_the_surface(self, name, prefer):
        surface, *topology = surfaces[name]
        samples = gm.sample(surface(), count=400, fields=("points", "normals", "uv"))
        mesh = samples.offset(0.05).offset(0.05).mesh(prefer=prefer)
        check_topology(mesh, *topology)
        # Every vertex is 0.1 away from the surface, those on borders and at poles, too.
        own = mesh.sample_index >= 0
        np.testing.assert_allclose(
            mesh.vertices[own], (samples.points + 0.1 * samples.normals)[mesh.sample_index[own]]
        )
        if not own.all():
            exact = surface().evaluate(*mesh.uv[~own].T)
            np.testing.assert_allclose(lengths(mesh.vertices[~own] - exact), 0.1, rtol=1e-12)

    def test_the_offset_of_a_sphere_is_a_sphere(self):
        """Of the area 4π 1.5², to the rounding of triangles that normals bend: h⁴."""
        samples = gm.sample(gm.surfaces.sphere(), count=2000).offset(0.5)
        np.testing.assert_allclose(lengths(samples.mesh().vertices), 1.5, rtol=1e-4)
        assert samples.weights().sum() == pytest.approx(4 * np.pi * 2.25, rel=1e-4)

    @pytest.mark.parametrize(
        ("distance", "fields", "count"),
        [
            (-0.35, None, "300"),
            (-0.36, None, "300"),
            (0.7, None, r"\d+"),
            (-0.4, ("points", "normals", "uv"), r"\d+"),
        ],
    )
    def test_a_folded_offset_has_no_mesh(self, distance, fields, count):
        """Beyond the radius of the tube, .35, or of the hole, .65; by curvatures, or by edges."""
        samples = gm.sample("torus", 300, fields=fields)
        refused(f"offset by .* folds at {count} of 300 vertices", samples.offset(distance).mesh)
        assert len(samples.offset(0.8 * distance).mesh().boundary_edges) == 0

    def test_an_offset_of_proved_samples(self):
        """They hold no spline, and are those of a surface."""
        samples = gm.sample("sphere", normals=gm.icosphere(4)).offset(-0.5)
        np.testing.assert_allclose(lengths(samples.mesh().vertices), 0.5, rtol=1e-12)

    def test_rows_copies_and_parts(self):
        samples = gm.sample(gm.surfaces.torus(), count=300).offset(0.1)
        triangles = samples.mesh().triangles
        halves = gm.Samples.concatenate([samples[:100], samples[100:]])
        for again in (samples[:], pickle.loads(pickle.dumps(samples)), halves):
            np.testing.assert_array_equal(again.mesh().triangles, triangles)

    def test_an_unknown_offset_has_no_mesh(self, tmp_path):
        gm.sample(gm.surfaces.torus(), count=100).offset(0.1).write(tmp_path / "a.npz")
        refused("do not hold the spline", gm.read_samples(tmp_path / "a.npz").mesh)
        samples = samples_at("torus", 1)
        known: Any = {"points": samples.points, "report": samples.report}
        refused("offset_of must be an OffsetOf or None", gm.Samples, **known, offset_of=0.1)

    def test_vertices_on_borders_are_on_the_surface(self):
        """And not on the spline, if that is where samples are."""
        belt = gm.surfaces.ellipsoid_patch()
        mesh = gm.sample(belt, count=300, cells=(12, 12)).mesh()
        added = mesh.sample_index < 0
        assert added.sum() > 10
        exact = belt.evaluate(*mesh.uv[added].T)
        np.testing.assert_allclose(mesh.vertices[added], exact, atol=1e-14)


# --- strips of triangulations, and triangles that share an edge -----------------------------------


@pytest.mark.parametrize("kind", ["periodic", "mirrored"])
def test_strips_give_the_triangles_of_the_whole(kind: str, monkeypatch):
    positions = np.random.default_rng(5).random((900, 2))
    boundary: Any = ((kind, kind), ("periodic", "periodic"))
    found = []
    for strip in (1000, 200):
        monkeypatch.setattr(triangulation, "STRIP", strip)
        free = np.ones(len(positions), dtype=bool)
        triangles, sides = next(
            iter(triangulation.triangulations(positions, free, boundary, np.array([2.0, 1.0])))
        )
        first = triangles.argmin(axis=1)[:, None]
        turned = (first + np.arange(3)) % 3
        rows = [np.take_along_axis(x, turned, axis=1) for x in (triangles, sides)]
        found.append(np.unique(np.hstack(rows), axis=0))
        assert neighbours(triangles, ~free)[1]
    np.testing.assert_array_equal(*found)


def test_edges_of_one_two_and_three_triangles():
    triangles = np.array([[0, 1, 2], [2, 1, 3], [3, 1, 4]])
    adjacent, is_closed = neighbours(triangles, np.ones(5, dtype=bool))
    np.testing.assert_array_equal(adjacent, [[1, -1, -1], [2, -1, 0], [-1, -1, 1]])
    assert is_closed
    assert not neighbours(triangles, np.arange(5) > 0)[1]
    third = np.concatenate([triangles, [[1, 2, 5]]])
    adjacent, is_closed = neighbours(third, np.ones(6, dtype=bool))
    assert not is_closed
    np.testing.assert_array_equal(adjacent[:2], [[-1, -1, -1], [2, -1, -1]])


@pytest.mark.parametrize("length", [0.05, 1.0, 12.0])
def test_no_triangle_of_a_long_rectangle_is_turned_over(length: float):
    rng, step = np.random.default_rng(1), np.sqrt(length / 12_000)
    (u, zero_u), (v, zero_v) = (
        (np.arange(n) / n, np.zeros(n)) for n in (int(length / step), int(1.0 / step))
    )
    sides = [(u, zero_u), (zero_v + 1.0, v), (1.0 - u, zero_u + 1.0), (zero_v, 1.0 - v)]
    away = 0.3 * step / np.array([length, 1.0])
    inner = away + (1.0 - 2.0 * away) * rng.random((12_000, 2))
    positions = np.concatenate([inner, *(np.column_stack(x) for x in sides)])
    is_free, lengths = np.arange(len(positions)) < len(inner), np.array([length, 1.0])
    boundary: Any = (("open", "open"), ("open", "open"))
    triangles, _ = next(triangulation.triangulations(positions, is_free, boundary, lengths))
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (areas >= 0.0).all()
    assert areas.sum() == pytest.approx(2.0, rel=1e-12)
