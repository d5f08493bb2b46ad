"""`GaussMap`: the samples of `sample`, whatever was asked before, by whichever thread."""

import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import gaussmap as gm
import numpy as np
import pytest

from ..refusals import refused
from ..shapes import AXES, CIRCLE, MERIDIAN, WEIGHTS, Array, bezier

NORMALS = np.concatenate([AXES, gm.fibonacci(300)])


def bits(samples: gm.Samples) -> dict[str, bytes]:
    return {name: getattr(samples, name).tobytes() for name in samples.fields}


def surfaces() -> dict[str, gm.Surface | gm.Spline | str]:
    v = np.linspace(0.0, 1.0, 9)
    grid = np.stack(np.meshgrid(v, v, v[:1], indexing="ij"), axis=-1)[:, :, 0]
    grid[..., 2] = np.sin(5 * grid[..., 0]) * np.cos(4 * grid[..., 1])
    knots = [0, 0, 0, 0.5, 0.5, 1, 1, 1]  # double inside: a crease
    u, v = np.meshgrid(range(5), range(5), indexing="ij")
    net = np.stack([u, v, 0.3 * (u - 2.0) ** 2 + 0.2 * (v - 2.0) ** 2], axis=-1)
    net[2:, :, 2] += u[2:]
    return {
        "name": "torus",
        "sphere": gm.surfaces.sphere(),
        "callable": gm.Surface.from_callable(
            lambda u, v: np.stack([u, v, 0.1 * np.sin(7 * u) * np.cos(6 * v)], axis=-1),
            ((-1, 1), (-1, 1)),
        ),
        "grid": gm.Surface.from_grid(grid),
        "spline": gm.fit("moebius_band", (20, 9)),
        "two pieces": gm.Surface.from_nurbs((2, 2), (knots, knots), net),
    }


SURFACES = surfaces()


@pytest.mark.parametrize("name", SURFACES)
def test_points_are_those_of_sample_whatever_was_asked_before(name):
    known = gm.GaussMap(SURFACES[name])
    assert known.spline is None or name != "two pieces"
    expected = gm.sample(SURFACES[name], normals=NORMALS)
    for normals in (AXES[:1], NORMALS, gm.icosphere(8), AXES):
        known.points(normals)
    for threads in (None, 3):
        assert bits(known.points(NORMALS, threads=threads)) == bits(expected)
    for k in range(0, len(NORMALS), 23):
        one, same = known.points(NORMALS[k : k + 1]), expected[expected.normal_index == k]
        assert (one.uv == same.uv).all()
        assert (one.points == same.points).all()


def test_threads_may_share_a_map():
    known = gm.GaussMap("torus")
    expected = [bits(known.points(NORMALS[k::4])) for k in range(4)]
    shared = gm.GaussMap("torus")
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda k: bits(shared.points(NORMALS[k % 4 :: 4])), range(16)))
    assert found == expected * 4


def test_a_map_is_pickled():
    known = gm.GaussMap("torus", cells=(20, 30), on="spline")
    known.points(NORMALS)
    again = pickle.loads(pickle.dumps(known))
    assert bits(again.points(NORMALS)) == bits(known.points(NORMALS))
    assert again.points(AXES).spline.cells == again.spline.cells == (20, 30)


def test_numbers_of_points_and_their_sum_of_signs():
    known = gm.GaussMap("torus")
    counts, degrees = known.count(NORMALS), known.degree(NORMALS)
    assert counts.dtype == degrees.dtype == np.int64
    generic = np.abs(NORMALS[:, 2]) < 0.999
    assert (counts[generic] == 2).all()
    assert (degrees == 0).all()
    assert (gm.GaussMap("sphere").degree(NORMALS) == 1).all()


def test_normals_without_a_point_have_none_without_a_warning(recwarn):
    known = gm.GaussMap(SURFACES["callable"])
    assert known.count(-AXES[2:3]).tolist() == [0]
    assert known.degree(-AXES[2:3]).tolist() == [0]
    assert not recwarn


def test_a_surface_is_fitted_once_and_a_map_when_it_is_made():
    calls = []

    def f(u: Array, v: Array) -> Array:
        calls.append(u.size)
        return np.stack([u, v, u * u - v * v], axis=-1)

    surface, other = (gm.Surface.from_callable(f, ((-1, 1), (-1, 1))) for _ in range(2))
    first = gm.sample(surface, normals=NORMALS, on="spline")
    fitted = len(calls)
    second = gm.sample(surface, normals=NORMALS, on="spline")
    assert len(calls) == fitted
    assert bits(first) == bits(second)
    gm.sample(surface, normals=NORMALS, on="spline", cells=(9, 9))
    assert len(calls) > fitted
    known = gm.GaussMap(other, on="spline")
    fitted = len(calls)
    assert len(known.points(NORMALS)) > 0
    assert len(calls) == fitted


def test_a_name_is_the_same_surface_each_time():
    """So that its map is cached, too."""
    assert gm.GaussMap("torus").surface is gm.sample("torus", normals=AXES).surface


@pytest.mark.parametrize(
    "arguments",
    [{"surface": "toru"}, {"surface": 3}, {"surface": "torus", "on": "moon"}, {"surface": [1, 2]}],
)
def test_unusable_arguments_are_refused_at_once(arguments):
    refused("", gm.GaussMap, **arguments, error=gm.GaussmapError)
    refused("", gm.sample, **arguments, normals=AXES, error=gm.GaussmapError)


# --- one answer, however a surface is written -----------------------------------------------------


def elevated(curves: Array) -> Array:
    """Return the control points of joined quadratic curves (2 k + 1, …) as cubic ones."""
    starts, middles, ends = curves[:-2:2], curves[1::2], curves[2::2]
    inner = np.stack([starts, (starts + 2 * middles) / 3, (2 * middles + ends) / 3], axis=1)
    return np.concatenate([inner.reshape(-1, *curves.shape[1:]), curves[-1:]])


def revolved(profile: Array, scale: Array, degree: int) -> gm.Surface:
    """Return a profile (k, 2) of conics, turned about z, as a NURBS of some degree."""
    weights = np.outer(WEIGHTS[: len(profile)], WEIGHTS)
    points = np.array([[(r * x, r * y, z) for x, y in CIRCLE] for r, z in profile]) * scale
    for _ in range(degree - 2):
        both = np.dstack([points * weights[..., None], weights])
        both = elevated(elevated(both).swapaxes(0, 1)).swapaxes(0, 1)
        weights = both[..., 3]
        points = both[..., :3] / weights[..., None]
    knots = [bezier(degree, x) for x in weights.shape]
    return gm.Surface.from_nurbs((degree, degree), knots, points, weights)


REVOLVED: dict[str, Callable[[int], gm.Surface]] = {
    "ellipsoid": lambda degree: revolved(MERIDIAN, np.array([3.0, 2.0, 1.0]), degree),
    "torus": lambda degree: revolved(0.7 * CIRCLE + (2, 0), np.ones(3), degree),
}


def directions(frequency: int, count: int) -> Array:
    parts = [np.eye(3), -np.eye(3), gm.icosphere(frequency), gm.directions.random(count, seed=4)]
    return np.concatenate(parts)


def components(surface: gm.Surface, normals: Array) -> Array:
    """Return how many components of each kind the normals have (S, 5), 0 where boxes are open."""
    points = gm.GaussMap(surface).points(normals)
    assert points.component is not None
    found = np.zeros((len(normals), len(gm.Component)))
    np.add.at(found, (points.normal_index, points.component), 1)
    found[[x.normal for x in points.report.undecided or ()]] = 0
    return found


@pytest.mark.parametrize(
    ("frequency", "count"), [(2, 20), pytest.param(8, 2000, marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("name", REVOLVED)
def test_components_do_not_depend_on_how_a_surface_is_written(
    name: str, frequency: int, count: int
) -> None:
    n, surface = directions(frequency, count), REVOLVED[name](2)
    expected = components(surface, n)
    of_circles = np.abs(n[:, 2]) == 1 if name == "torus" else np.zeros(len(n), bool)
    assert (expected[~of_circles, 0] == (2 if name == "torus" else 1)).all()
    np.testing.assert_array_equal(components(surface.flipped(), -n), expected)
    np.testing.assert_array_equal(components(REVOLVED[name](3), n), expected)
