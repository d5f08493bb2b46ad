"""Meshes of samples on a graded grid: topology, samples between its lines, and other samples."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.tools.meshes.meshing import triangulated

from ...products import covering
from ...refusals import refused
from .test_meshing import NO_AREA, PREFER, TURN, check_topology, latitude, on_spline
from .test_meshing import surfaces as all_surfaces

pytestmark = pytest.mark.filterwarnings("ignore::gaussmap.GaussmapWarning")
compiled = pytest.mark.compiled


QUARTER = (0.0, np.pi / 2)
surfaces = {x: all_surfaces[x] for x in ("torus", "ellipsoid", "graph", "belt, v closes")} | {
    # surface, Euler characteristic, number of borders
    "ellipsoid, v closes": (
        lambda: gm.Surface.from_callable(
            lambda u, v: latitude(v, u) * [2.0, 1.0, 1.0],
            ((-np.pi / 2, np.pi / 2), TURN), ("pole", True),
        ), 2, 0,
    ),
    "cylinder": (gm.surfaces.cylinder, 0, 2),
    "cone": (
        lambda: gm.Surface.from_callable(
            lambda u, v: np.stack([v * np.cos(u), v * np.sin(u), 0.7 * v], axis=-1),
            (TURN, (0.0, 1.0)), (True, False),
        ), 1, 1,
    ),
    # An eighth of the unit sphere: the side v = π/2 is one point, an apex.
    "octant": (lambda: gm.Surface.from_callable(latitude, (QUARTER, QUARTER)), 1, 1),
}  # fmt: skip
# Without compilation a few are enough.
UNCOMPILED = ("torus", "octant")
FEW_UNCOMPILED = pytest.mark.parametrize(
    "name", [x if x in UNCOMPILED else pytest.param(x, marks=compiled) for x in surfaces]
)


def on_grid(surface: str | gm.Surface, lines: tuple[int, int], between: Any = None) -> Any:
    """Return samples on a grid of lines of u and v, and at places in the unit square `between`."""
    surface = surfaces[surface][0]() if isinstance(surface, str) else surface
    spline = gm.fit(surface, cells=(16, 16))
    places = [(np.arange(n) + 0.5) / n for n in lines]
    places = [x + 0.08 * np.sin(2 * np.pi * x) for x in places]
    column, row = (x.ravel() for x in np.indices(lines))
    unit = np.stack([places[0][column], places[1][row]], axis=1)
    if between is not None:
        unit = np.concatenate([unit, between])
        row, column = (np.append(x, np.full(len(between), -1)) for x in (row, column))
    low, high = np.array(spline.domain).T
    return on_spline(spline, low + unit * (high - low), row=row, column=column, surface=surface)


def check(mesh: gm.Mesh, characteristic: int, borders: int) -> None:
    """Check that a mesh is the whole surface, without folds and flat triangles."""
    check_topology(mesh, characteristic, borders)
    assert mesh.smallest_angles.min() > NO_AREA
    assert mesh.angles.max() < 90.0
    directed = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert len(np.unique(directed, axis=0)) == len(directed)


class TestTopology:
    @FEW_UNCOMPILED
    @pytest.mark.parametrize("prefer", PREFER)
    def test_a_grid_makes_the_whole_surface(self, name, prefer):
        """Alone, and with samples between its lines.

        These are at random, on lines and sides, next to sides, at corners, poles and other samples.
        """
        alone = on_grid(name, (14, 11))
        low, high = np.array(surfaces[name][0]().domain).T
        unit = (alone.uv - low) / (high - low)
        special = [
            [0.0, 0.3], [1.0, 0.62], [0.41, 0.0], [0.77, 1.0], [1e-4, 0.5], [0.21, 1.0 - 1e-4],
            [0.0, 0.0], [unit[5, 0], 0.37], [0.13, unit[5, 1]], unit[40], unit[41],
        ]  # fmt: skip
        between = np.random.default_rng(3).uniform(0.0, 1.0, (20, 2))
        both = on_grid(name, (14, 11), np.concatenate([between, special]))
        for samples, twice in ((alone, set()), (both, {40, 41})):
            mesh = samples.mesh(prefer=prefer)
            check(mesh, *surfaces[name][1:])
            own = mesh.sample_index >= 0
            used = mesh.sample_index[own]
            assert len(np.unique(used)) == len(used)
            np.testing.assert_array_equal(mesh.vertices[own], samples.points[used])
            # Of three in a line, as on a cone, one may be left out.
            left_out = set(range(len(alone))) - {*used.tolist()} - twice
            assert len(left_out) <= (name == "cone")
            assert prefer == "shape" or len(used) >= len(samples) - 6

    def test_it_covers_the_parameters_once(self):
        rng = np.random.default_rng(5)
        samples = on_grid("graph", (12, 15), rng.uniform(0.0, 1.0, (40, 2)))
        start = triangulated(samples, samples.spline)
        a, b, c = np.moveaxis(start.uv[start.triangles], 1, 0)
        areas = np.linalg.det(np.stack([b - a, c - a], axis=1)) / 2
        assert areas.min() > 0.0
        assert areas.sum() == pytest.approx(4.0, rel=1e-12)

    def test_a_border_close_to_samples_gets_points_opposite_to_them(self):
        """On the disk of a flat belt the chords of the outer circle are inside of these samples."""
        disk = gm.Surface.from_callable(
            lambda u, v: np.stack([v * np.cos(u), v * np.sin(u), 0.0 * u], axis=-1),
            (TURN, (0.5, 1.0)), (True, False),
        )  # fmt: skip
        between = np.stack([np.linspace(0.03, 0.9, 9), np.full(9, 0.999)], axis=1)
        for prefer in PREFER:
            check(on_grid(disk, (12, 6), between).mesh(prefer=prefer), 0, 2)

    def test_grids_of_one_line(self):
        for name, lines in (("ellipsoid", (5, 1)), ("graph", (1, 1)), ("graph", (1, 6))):
            check_topology(on_grid(name, lines).mesh(), *surfaces[name][1:])


class TestOtherSamples:
    def test_the_order_does_not_matter(self):
        samples = on_grid("graph", (12, 9))
        order = np.random.default_rng(1).permutation(len(samples))
        first, second = samples.mesh(), samples[order].mesh()
        at = [
            {tuple(sorted(map(tuple, x))) for x in mesh.vertices[mesh.triangles].tolist()}
            for mesh in (first, second)
        ]
        assert at[0] == at[1]

    @compiled
    @pytest.mark.parametrize("name", ["torus", "graph"])
    def test_parts_of_grids(self, name):
        samples = on_grid(name, (12, 9))
        rowless = on_spline(samples.spline, samples.uv, column=samples.column)
        for other in (samples[samples.column != 4], samples[::2], rowless):
            check_topology(other.mesh(), *surfaces[name][1:])

    @compiled
    def test_too_many_between_the_lines(self):
        rng = np.random.default_rng(2)
        samples = on_grid("graph", (6, 6), rng.uniform(0.0, 1.0, (40, 2)))
        check_topology(samples.mesh(), 1, 1)


def check_nodes(samples):
    """Each sample on a line of a grid is a vertex, and those that are none are counted."""
    mesh = samples.mesh()
    own = mesh.sample_index[mesh.sample_index >= 0]
    assert np.isin(np.flatnonzero(samples.row >= 0), own).all()
    assert len(own) + mesh.left_out == len(samples)


@compiled
class TestAligned:
    @covering(prefer=PREFER, name=["torus", "ellipsoid", "graph"])
    def test_samples_of_that_density(self, name, prefer):
        samples = gm.sample(surfaces[name][0](), count=700, density="aligned", cells=(16, 16))
        check(samples.mesh(prefer=prefer), *surfaces[name][1:])

    @pytest.mark.parametrize(
        ("name", "fields"),
        [
            ("torus", ("points", "normals", "uv")),
            ("ellipsoid_patch", ("points", "normals", "uv", "row")),
            ("moebius_band", ("points", "uv", "column")),
        ],
    )
    def test_the_lines_of_a_grid_are_needed(self, name, fields):
        samples = gm.sample(name, 300, density="aligned", cells=(16, 16), fields=fields)
        lacking = [x for x in ("points", "normals", "uv", "row", "column") if x not in fields]
        for made in (samples.mesh, samples.weights):
            said = refused("", made, error=gm.errors.MissingFieldError)
            assert f"a mesh needs {' and '.join(lacking)}, but" in said

    @pytest.mark.parametrize(
        "surface",
        [
            "ellipsoid_patch", "sphere", "wavy_graph", "moebius_band",
            gm.surfaces.ellipsoid_patch().trimmed(within=lambda u, v: u + v < 5.0),
        ],
    )  # fmt: skip
    def test_no_other_field_matters(self, surface):
        """Each sample of a grid is a vertex, whether it knows more than a mesh needs or not."""
        fields = ("points", "normals", "uv", "row", "column")
        whole, few = (
            gm.sample(surface, 400, density="aligned", cells=(16, 16), fields=x)
            for x in (None, fields)
        )
        np.testing.assert_array_equal(whole.mesh().triangles, few.mesh().triangles)
        check_nodes(whole)
        check_nodes(whole[whole.column % 5 != 3])

    def test_too_small_for_a_grid(self):
        """No line meets the part that is left: then the samples are on no grid, and say so."""
        plane = gm.Surface.from_callable(
            lambda u, v: np.stack([u, v, 0.0 * u], axis=-1), ((0.0, 1.0), (0.0, 1.0))
        )
        spot = plane.trimmed(
            within=lambda u, v: np.maximum(abs(u - 0.4137), abs(v - 0.4137)) < 0.013
        )
        samples = gm.sample(spot, 2, density="aligned")
        assert samples.row is None
        assert samples.report.density is None
        assert samples.mesh().euler_characteristic == 1

    def test_weights_offsets_and_parts_by_angle(self):
        samples = gm.sample("torus", 700, density="aligned", cells=(16, 16))
        area = 4 * np.pi**2 * 0.35  # the torus (1, 0.35)
        assert samples.weights().sum() == pytest.approx(area, rel=1e-3)
        check(samples.offset(0.05).mesh(), 0, 0)
        whole, part = samples.mesh(angle=90.0), samples[samples.row > 3].mesh(angle=30.0)
        check(whole, 0, 0)
        assert len(part.boundary_edges) > 0
