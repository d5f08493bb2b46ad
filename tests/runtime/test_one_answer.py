"""One surface has one answer, however it is written."""

from collections.abc import Callable

import gaussmap as gm
import numpy as np
import pytest

from ..shapes import CIRCLE, MERIDIAN, WEIGHTS, Array, bezier


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


SURFACES: dict[str, Callable[[int], gm.Surface]] = {
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
@pytest.mark.parametrize("name", SURFACES)
def test_components_do_not_depend_on_how_a_surface_is_written(
    name: str, frequency: int, count: int
) -> None:
    n, surface = directions(frequency, count), SURFACES[name](2)
    expected = components(surface, n)
    of_circles = np.abs(n[:, 2]) == 1 if name == "torus" else np.zeros(len(n), bool)
    assert (expected[~of_circles, 0] == (2 if name == "torus" else 1)).all()
    np.testing.assert_array_equal(components(surface.flipped(), -n), expected)
    np.testing.assert_array_equal(components(SURFACES[name](3), n), expected)
