"""Support points: the farthest points of surfaces, compared with formulas and with many places."""

import pickle
from dataclasses import replace
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from ..products import covering
from ..refusals import refused
from ..shapes import TORUS
from .cad import made

TURN = (0.0, "2*pi")
DIRECTIONS = np.concatenate([gm.directions.random(40, seed=1), np.eye(3), -np.eye(3)])
HOLE = [[(1, 1), (4, 1), (4, 4), (1, 4)], [(2, 2), (3, 2), (3, 3)]]


def in_two(*position: Any, domain: Any, periodic: Any = False) -> gm.Surface:
    return gm.Surface.from_sympy(position, ("u", "v"), domain, periodic)


def lemon() -> gm.Surface:
    """A spindle with two tips, which are farthest in a cone of directions."""
    ring = "cos(u) - 1/2"
    position = f"({ring})*cos(v)", f"({ring})*sin(v)", "sin(u)"
    return in_two(*position, domain=(("-pi/3", "pi/3"), TURN), periodic=(False, True))


def plateau(u: Any, v: Any) -> Any:
    """Return points of a graph that is flat in a disc, without a tape."""
    return np.stack([u, v, -(np.maximum(np.hypot(u, v) - 0.5, 0.0) ** 3)], axis=-1)


SURFACES = {
    "closed": TORUS,
    "open": gm.surfaces.wavy_graph(),
    "hole": TORUS.trimmed(HOLE),
    "across a seam": TORUS.trimmed([[(5, 1), (8, 1), (8, 4), (5, 4)]]),
    "predicate": TORUS.trimmed(within=lambda u, v: (u - 3) ** 2 + (v - 1) ** 2 < 1),
    "side cut": gm.surfaces.wavy_graph().trimmed(within=lambda u, v: u + v > 0.1),
    "tips": lemon(),
    "developable": in_two("cos(u)", "sin(u)", "v", domain=(TURN, (0, 2)), periodic=(True, False)),
    "flat top": in_two("u", "v", "-u**4 - v**4", domain=((-1, 1), (-1, 1))),
    "function": gm.Surface.from_callable(plateau, ((-1, 1), (-1, 1))),
    "crease": gm.Surface.from_callable(
        lambda u, v: np.stack([u, v, -abs(u - 0.013) - v * v], -1), ((-1, 1), (-1, 1))
    ),
}


# Where a farthest point may be at a corner or a crease inside of the domain.
SHARP = {"hole", "across a seam", "predicate", "side cut", "crease"}


def most(surface: Any, count: int) -> tuple[Any, Any]:
    """Return the largest n·x of places on a grid, and by how much others may exceed it.

    n·x falls from a farthest point inside the domain, or along a side, as its second derivatives;
    from a corner as its first ones.
    """
    u, v = (np.linspace(low, high, count) for low, high in surface.domain)
    uv = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    uv = uv if surface.trim is None else uv[surface.trim.contains(uv)]
    parts = np.array_split(surface.evaluate(*uv.T), -(-len(uv) // 10_000))
    found = np.max([(x @ DIRECTIONS.T).max(axis=0) for x in parts], axis=0)
    some = uv[:: max(len(uv) // 100, 1)]
    size = np.abs(surface.jets(*some.T) if isinstance(surface, gm.Surface) else 0.0).max(initial=12)
    step = u[1] - u[0] + v[1] - v[0]
    return found, (4.0 * size * step, size * step**2)


def assert_farthest(surface: Any, count: int, sharp: bool) -> None:
    found = gm.GaussMap(surface).support(DIRECTIONS)
    known, slack = most(surface, count)
    assert (found.values + found.errors >= known).all()
    assert (found.values <= known + slack[0 if sharp else 1]).all()
    assert_allclose(np.einsum("kx,kx->k", found.points, DIRECTIONS), found.values, atol=1e-14)
    assert_allclose(surface.evaluate(*found.uv.T), found.points, atol=1e-13)


def assert_exact(found: Any, values: Any, most: float) -> None:
    """Check that values are known up to their errors, and that these are small."""
    assert (np.abs(found.values - values) <= found.errors).all()
    assert found.errors.max() < most


@covering(name=SURFACES, on_spline=[False, True])
def test_no_place_on_a_grid_is_farther(name: str, on_spline: bool) -> None:
    surface = SURFACES[name]
    assert_farthest(gm.fit(surface) if on_spline else surface, 120, name in SHARP)


@pytest.mark.parametrize("reverse", [False, True])
def test_errors_count_where_a_predicate_changes(reverse: bool) -> None:
    circle = np.array([3.0, 1.0]) + gm.directions.circle(20_000)
    surface = SURFACES["predicate"]
    found = gm.GaussMap(surface.flipped() if reverse else surface).support(DIRECTIONS)
    values = (TORUS.evaluate(*circle.T.copy()) @ DIRECTIONS.T).max(axis=0)
    assert (found.values + found.errors >= values).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", SURFACES)
def test_none_of_a_million_places_is_farther(name: str) -> None:
    assert_farthest(SURFACES[name], 1_000, name in SHARP)


def test_values_of_a_torus_and_an_ellipsoid() -> None:
    radii = np.array([3.0, 2.0, 1.0])
    ellipsoid = gm.GaussMap(gm.surfaces.ellipsoid(*radii)).support(DIRECTIONS)
    torus = gm.GaussMap(TORUS).support(DIRECTIONS)
    exact = np.linalg.norm(radii * DIRECTIONS, axis=1), np.hypot(*DIRECTIONS.T[:2]) + 0.35
    for found, values in zip((ellipsoid, torus), exact, strict=True):
        assert_exact(found, values, 1e-13)
        assert not found.on_border.any()


def test_tips_corners_and_whole_circles() -> None:
    tip = gm.GaussMap(lemon()).support([[0.1, 0, 1], [-0.2, 0.1, 1], [0, 0, 1]])
    assert_allclose(tip.points, np.tile([0.0, 0.0, np.sin(np.pi / 3)], (3, 1)), atol=1e-15)
    found = gm.GaussMap(SURFACES["hole"]).support([[-1, -1, -5]])
    assert found.on_border.all()
    top = gm.GaussMap(TORUS).support([[0, 0, 1]])
    again = gm.GaussMap(TORUS).support([[1, 0, 0], [0, 0, 1], [0, 0, 1]])
    assert_allclose(top.values, 0.35, atol=1e-15)
    assert (again.points[1:] == top.points).all()


def test_flat_regions_of_splines_have_farthest_points() -> None:
    """No patch there has samples, and no border is near."""
    spline = gm.fit(SURFACES["function"], (32, 32))
    coefficients = spline.coefficients.copy()
    coefficients[..., 2] = np.minimum(coefficients[..., 2], 0.0)
    spline = replace(spline, coefficients=coefficients)
    found = gm.GaussMap(spline).support([[0, 0, 1]])
    assert_allclose(found.values, 0.0, atol=1e-15)
    assert np.hypot(*found.points[0, :2]) <= 0.5 + 2 / 32


def test_points_of_nets() -> None:
    spline = gm.fit(lemon(), (16, 16))
    nets = gm.Spline.from_nets(spline.control_nets, name="nets")
    found, same = (gm.GaussMap(x).support(DIRECTIONS) for x in (nets, spline))
    assert_allclose(found.values, same.values, atol=1e-14)
    assert np.isnan(found.uv).all()


@pytest.mark.parametrize("name", ["box", "all_kinds"])
def test_points_of_parts(parts: Any, name: str) -> None:
    part = getattr(parts, name)()
    known = gm.GaussMap(part)
    found = known.support(DIRECTIONS)
    alone = [known.support([n]).points[0] for n in DIRECTIONS[::6]]
    assert_array_equal(alone, found.points[::6])
    many = known.support(np.concatenate([DIRECTIONS, gm.icosphere(12)]))
    assert_array_equal(many.points[: len(DIRECTIONS)], found.points)
    samples = gm.sample(part, 3_000)
    assert (found.values >= (samples.points @ DIRECTIONS.T).max(axis=0)).all()
    faces = [part.faces[k].surface for k in found.face_index]
    points = [x.evaluate(*uv) for x, uv in zip(faces, found.uv, strict=True)]
    assert_allclose(points, found.points, atol=1e-13)
    low, high = part.bounds
    assert (
        found.values <= np.maximum(low * DIRECTIONS, high * DIRECTIONS).sum(axis=1) + 1e-12
    ).all()


def test_values_of_a_box(parts: Any) -> None:
    found = gm.GaussMap(parts.box(1.0, 2.0, 3.0)).support(DIRECTIONS)
    assert_allclose(found.values, np.maximum(DIRECTIONS * [1, 2, 3], 0.0).sum(axis=1), atol=1e-14)
    assert found.on_border[:40].all()
    assert found.errors.min() > 3.0 * np.finfo(float).eps  # also for the corner at 0


@pytest.mark.parametrize("inside", [False, True])
def test_errors_on_edges_are_those_of_the_curves_not_of_the_polygons(inside: bool) -> None:
    """Of a disk with a polygon of 40 sides, in a domain that may end at its vertices."""
    turn, count = 0.5 * np.pi / 20.0, 40
    end = np.cos(turn) if inside else 1.0
    disk = made.face(
        "plane", u=(-end, end), v=(-end, end), loops=[made.circle(1.0, count, turn)],
        area=np.pi, wires=[[(0, 0, False)]],
    )  # fmt: skip
    rim = made.edge((0,), [made.round_side(1.0, 65, turn)], (0, 0))
    vertex = np.array([(np.cos(turn), np.sin(turn), 0.0)])
    part = made.part([disk], edges=[rim], vertices=vertex)
    found = gm.GaussMap(part).support(DIRECTIONS)
    assert_exact(found, np.hypot(*DIRECTIONS.T[:2]), 2.0 * (1.0 - np.cos(turn)))
    assert (np.abs(found.uv) <= end).all()
    # A cubic that replaces an arc of angle a deviates by about a⁴ / 384 at most.
    assert (found.errors.max() < (2.0 * np.pi / 64.0) ** 4 / 100.0) == (not inside)
    # Some points of the curve are known.
    known = np.pad(made.round_side(1.0, 65, turn)[0], ((0, 0), (0, 1)))
    assert inside or gm.GaussMap(part).support(known).errors.max() < 1e-12


def test_an_edge_is_as_exact_as_its_better_side() -> None:
    """The rims of a cylinder are straight on its side, and cubics on its disks."""
    found = gm.GaussMap(made.CYLINDER).support(DIRECTIONS)
    exact = np.hypot(*DIRECTIONS.T[:2]) + 2.0 * np.maximum(DIRECTIONS[:, 2], 0.0)
    assert_exact(found, exact, 1e-13)


def test_functions_without_a_proof_have_larger_errors() -> None:
    torus = gm.Surface.from_callable(
        lambda u, v: np.vectorize(TORUS.function, signature="(),()->(3)")(u, v),
        TORUS.domain, periodic=True,
    )  # fmt: skip
    found = gm.GaussMap(torus, cells=(16, 16)).support(DIRECTIONS)
    misfit = gm.fit(torus, (16, 16)).misfit
    assert_exact(found, np.hypot(*DIRECTIONS.T[:2]) + 0.35, 2.0 * misfit.distance)
    assert found.errors.max() > 1e-12


def test_a_map_pickles_after_a_query() -> None:
    known = gm.GaussMap(gm.surfaces.wavy_graph())
    values = known.support(DIRECTIONS).values
    assert (pickle.loads(pickle.dumps(known)).support(DIRECTIONS).values == values).all()


def test_bounds() -> None:
    assert_allclose(TORUS.bounds, [[-1.35, -1.35, -0.35], [1.35, 1.35, 0.35]], atol=1e-14)
    half = TORUS.trimmed([[(0, -1), (np.pi, -1), (np.pi, 5), (0, 5)]])
    assert_allclose(half.bounds, [[-1.35, 0, -0.35], [1.35, 1.35, 0.35]], atol=1e-14)


def test_refusals() -> None:
    known = gm.GaussMap(TORUS)
    refused("", known.support, [[0, 0, 0]])
    nothing = TORUS.trimmed(within=lambda u, v: u > 7)
    error = gm.errors.SurfaceError
    refused("", gm.GaussMap(nothing).support, DIRECTIONS, error=error)
