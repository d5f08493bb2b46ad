"""Every preimage of every normal once: Σ sign K = χ/2 (math.md, Sect. 4) needs no reference."""

import math
from collections.abc import Callable
from functools import partial

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search.search import find
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from ...nets import by_brute_force
from ...products import covering
from ...shapes import TORUS, Array, klein_bottle, moved


def count_preimages(
    samples: gm.Samples, normals: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return, for each normal, how many elliptic and how many hyperbolic preimages came back."""
    regular = samples.component == gm.Component.REGULAR
    elliptic, hyperbolic = (
        np.bincount(samples.normal_index[kind & regular], minlength=normals)
        for kind in (samples.elliptic, samples.hyperbolic)
    )
    return elliptic, hyperbolic


def check_torus(surface: gm.Surface, cells: tuple[int, int], normals: Array, axis: Array) -> None:
    known = gm.GaussMap(surface, cells=cells, on="spline")
    samples = known.points(normals)
    assert (known.degree(normals) == 0).all()
    away = np.abs(normals @ axis) < np.cos(np.radians(2.0))
    for found in count_preimages(samples, len(normals)):
        assert (found[away] == 1).all()
    assert samples.report.developable_patches == 0
    assert np.isfinite(samples.points).all()
    assert np.isfinite(samples.gaussian_curvature).all()


Quaternion = tuple[float, float, float, float]


def rotation_of(quaternion: Quaternion) -> Array:
    w, x, y, z = np.array(quaternion) / np.linalg.norm(quaternion)
    turn = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    return np.eye(3) + 2.0 * w * np.array(turn) + 2.0 * np.linalg.matrix_power(turn, 2)


quaternions = st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)


@given(
    of_surface=quaternions,
    of_normals=quaternions,
    factor=st.sampled_from([1.0, 1e9, 1e-9, 1e12, 1e-12, 1e150, 1e-150]),
    shift=st.sampled_from([0.0, 1e6, 1e9]),
    cells=st.sampled_from([(16, 16), (32, 20), (96, 96)]),
)
def test_torus_turned_moved_and_scaled(
    of_surface: Quaternion,
    of_normals: Quaternion,
    factor: float,
    shift: float,
    cells: tuple[int, int],
) -> None:
    turn = rotation_of(of_surface)
    normals = gm.icosphere(8) @ rotation_of(of_normals).T
    surface = moved(TORUS, factor, shift * factor, turn)
    check_torus(surface, cells, normals, turn[:, 2])


DEGREES = {"torus": 0, "sphere": 1, "ellipsoid": 1, "dupin_cyclide": 0}
SETS: dict[str, Callable[[], Array]] = {
    **{f"icosphere {k}": partial(gm.icosphere, k) for k in (10, 32, 100)},
    **{f"healpix {k}": partial(gm.directions.healpix, k) for k in (8, 64)},
    "random": lambda: gm.directions.random(50_000),
}


@covering(
    surface=DEGREES,
    cells=[(4, 7), (9, 9), (16, 16), (32, 20), (96, 96)],
    normals=SETS,
)
def test_sum_of_signs_is_that_of_the_surface(
    surface: str, cells: tuple[int, int], normals: str
) -> None:
    """Also where patches bend far."""
    n = SETS[normals]()
    samples = gm.sample(surface, normals=n, cells=cells, on="spline")
    elliptic, hyperbolic = count_preimages(samples, len(n))
    assert (elliptic - hyperbolic == DEGREES[surface]).all()
    assert surface != "torus" or samples.report.developable_patches == 0
    if surface == "torus" and min(cells) >= 16:  # without the circles along the axis
        assert (elliptic[np.abs(n[:, 2]) < np.cos(np.radians(2.0))] == 1).all()


@pytest.mark.parametrize(
    ("surface", "shift", "cells"),
    [
        pytest.param(gm.surfaces.sphere(), 1e6, 512, marks=pytest.mark.slow),
        *((gm.surfaces.sphere(), *x) for x in ((1e8, 128), (1e9, 128), (1e10, 32), (1e12, 32))),
        (gm.surfaces.torus(minor=1e-6), 0.0, 128),
        *((gm.surfaces.torus(minor=0.35), *x) for x in ((1e9, 256), (1e12, 32))),
    ],
)
def test_surfaces_that_are_mostly_rounding(surface: gm.Surface, shift: float, cells: int) -> None:
    normals = gm.fibonacci(20_000)
    known = gm.GaussMap(gm.fit(moved(surface, 1.0, shift), (cells,) * 2))
    samples = known.points(normals)
    assert samples.report.developable_patches
    assert (known.degree(normals) == (surface.name == "sphere")).all()
    if surface.name == "torus" and shift < 1e12:
        elliptic, _ = count_preimages(samples, len(normals))
        assert (elliptic == 1).all()


@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-6, 1e-8])
def test_gentle_waves_are_decided_in_floating_point(height: float) -> None:
    """Their normals crowd in a small cap, and yet each patch is compared with a few only."""
    surface = gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, height * np.sin(u) * np.cos(v)], axis=-1),
        domain=((0.0, 2 * np.pi), (0.0, 2 * np.pi)),
    )
    spline = gm.fit(surface, (32, 32))
    normals = spline.normals(*np.random.default_rng(0).uniform(1.0, 5.0, (2, 5000)))
    hits = find(spline, normals)
    assert len(hits.exact) < 0.05 * len(hits)  # at the border, where rounding is forgiven
    assert np.bincount(hits.normal_index, minlength=len(normals)).min() >= 1


@covering(cells=[(16, 16), (40, 24)], frequency=[4, 10, 32])
def test_klein_bottle(cells: tuple[int, int], frequency: int) -> None:
    """It has no oriented normals, but for every line the signs of K sum to χ = 0."""

    normals = gm.icosphere(frequency)
    elliptic, hyperbolic = count_preimages(
        gm.sample(klein_bottle(), normals=normals, cells=cells, on="spline"), len(normals)
    )
    order = np.lexsort(normals.T)
    signed = elliptic - hyperbolic
    assert (normals[order] == -normals[order[::-1]]).all()  # the set is symmetric, bit for bit
    assert (signed[order] + signed[order[::-1]] == 0).all()


def spiral(axis: Array, angle: float, count: int) -> Array:
    """Return normals at the golden angle from each other, up to an angle in degrees to the axis."""
    height = 1.0 - (1.0 - math.cos(math.radians(angle))) * (np.arange(count) + 0.5) / count
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)
    across = np.linalg.svd(axis[None])[2][1:]
    ring = np.outer(np.cos(turn), across[0]) + np.outer(np.sin(turn), across[1])
    return np.outer(height, axis) + np.sqrt(1.0 - height**2)[:, None] * ring


@covering(
    name=["torus", "wavy_graph", "moebius_band", "enneper", "helicoid"],
    cells=[(3, 3), (6, 5)],
    cap=[180.0, 40.0, 3.0],
)
def test_the_search_finds_what_brute_force_finds(
    name: str, cells: tuple[int, int], cap: float
) -> None:
    spline = gm.fit(gm.surfaces.surface(name), cells)
    axis = spline.normals(*np.mean(spline.domain, axis=1) + 0.1)
    normals = spiral(axis, cap - 1e-3, 4000)
    samples = gm.sample(spline, normals=normals)
    expected = np.array(by_brute_force(spline.control_nets, normals))
    np.testing.assert_array_equal(samples.normal_index, expected[:, 0])
    np.testing.assert_array_equal(samples.patch_index, expected[:, 1])
    assert len(samples) > 500


@covering(shift=[0.0, 1.0, 10.0], axis=[0, 1], domain=[(0.0, 1.0), (-1.0, 0.0)])
def test_open_border_belongs_to_the_surface(
    shift: float, axis: int, domain: tuple[float, float]
) -> None:
    """Half of a symmetric surface: normals in the plane of symmetry lie on its border.

    Away from the origin they lie there up to the rounding of points.
    """
    a, b = (1.0, 0.75) if axis == 0 else (0.75, 1.0)
    half = gm.Surface.from_callable(
        lambda u, v: shift + np.stack([u, v, a * u * u + b * v * v], axis=-1),
        (domain, (-1.0, 1.0)) if axis == 0 else ((-1.0, 1.0), domain),
    )
    along = np.linspace(-0.99, 0.99, 777)
    normals = np.column_stack([0.0 * along, -1.5 * along, np.ones_like(along)])
    tolerance = 1e-12 + 1e-14 * shift
    normals = normals if axis == 0 else normals[:, [1, 0, 2]]
    for cells in ((3, 3), (7, 5), (16, 16), (37, 41)):
        samples = gm.sample(half, normals=normals, cells=cells, on="spline")
        assert (np.bincount(samples.normal_index, minlength=len(along)) == 1).all()
        assert np.abs(samples.uv[:, axis]).max() < tolerance
        np.testing.assert_allclose(np.sort(samples.uv[:, 1 - axis]), along, rtol=0, atol=tolerance)


RINGS = [("catenoid", (12, 8)), ("hyperboloid", (12, 8))]
SQUARES = [("elliptic_paraboloid", x) for x in ((3, 3), (8, 8), (5, 9), (12, 8))]


@pytest.mark.parametrize("kind", ["grid", "nets"])
@pytest.mark.parametrize(("name", "cells"), [*RINGS, *SQUARES])
def test_vertices_of_the_border_come_once(name: str, cells: tuple[int, int], kind: str) -> None:
    """Rounding lets several patches answer: the same each time, at ends of closed rings too."""
    spline = gm.fit(name, cells)
    u, v = (np.linspace(*x, k + 1) for x, k in zip(spline.domain, cells, strict=True))
    sides = [spline.normals(u, end) for end in spline.domain[1]]
    if spline.boundary[0][0] == "open":
        sides += [spline.normals(end, v) for end in spline.domain[0]]
    vertices = np.concatenate([*sides, *sides])
    spline = spline if kind == "grid" else gm.Spline.from_nets(spline.control_nets)
    samples = gm.sample(spline, normals=vertices)
    assert samples.normal_index.tolist() == list(range(len(vertices)))


@pytest.mark.parametrize("name", ["klein", "moebius"])
def test_points_of_a_mirrored_seam(name: str) -> None:
    """A point there has the normals n and −n, of which one counts."""
    surface = klein_bottle() if name == "klein" else gm.surfaces.moebius_band()
    v = np.linspace(*surface.domain[1], 23)[1:-1] + 0.01
    for on in ("spline", "surface"):
        known = gm.GaussMap(surface, on=on)
        own = known.spline if on == "spline" else surface
        assert isinstance(own, gm.Spline | gm.Surface)
        N = own.normals(0.0 * v, v)
        points, found = own.evaluate(0.0 * v, v), np.zeros(len(v), np.int64)
        for sign in (1.0, -1.0):
            samples = known.points(sign * N)
            here = np.linalg.norm(samples.points - points[samples.normal_index], axis=1) < 1e-9
            found += np.bincount(samples.normal_index[here], minlength=len(v))
        assert {*found.tolist()} == {1}


@pytest.mark.parametrize("sign", [1, -1])
def test_a_pole_is_one_point_with_its_normal(sign: int) -> None:
    """Curvatures differ around it, so that Gaussian images of patches overlap there."""

    def bowl(u: Array, v: Array) -> Array:
        height = np.cos(2.0 * u) + (2.0 if sign > 0 else 0.0)
        return np.stack([v * np.cos(u), v * np.sin(u), height * v * v], -1)

    surface = gm.Surface.from_callable(bowl, ((0.0, 2.0 * np.pi), (0.0, 1.0)), (True, False))
    samples = gm.sample(gm.fit(surface, (12, 8)), normals=[[0, 0, -1], [0, 0, 1]])
    assert samples.normal_index.tolist() == [0]
    assert np.abs(samples.points[0, :2]).max() < 1e-12
    assert np.sign(samples.gaussian_curvature[0]) == sign
