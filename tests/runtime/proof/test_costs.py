"""The index of a surface has a bounded number of cells, and is fine where it has to be."""

import gaussmap as gm
import numpy as np
import pytest

from ...shapes import CIRCLE, WEIGHTS, conics
from .judge import new_index, unit


def heavy(weight: float) -> gm.Surface:
    """Return a surface with one large weight: near one point but for strips along its sides."""
    knots, points = [0, 0, 0, 0, 1, 1, 1, 1], np.empty((4, 4, 3))
    points[..., 0], points[..., 1] = np.meshgrid(*[np.linspace(0, 1, 4)] * 2, indexing="ij")
    points[..., 2] = np.random.default_rng(3).uniform(0, 0.4, (4, 4))
    weights = np.ones((4, 4))
    weights[1, 1] = weight
    return gm.Surface.from_nurbs((3, 3), (knots, knots), points, weights)


def test_few_cells_are_cut_where_tangents_are_nearly_parallel() -> None:
    half = "1/2"
    height = f"1/(1/100000 + (u - {half})**2 + (v - {half})**2)"
    index = new_index(gm.Surface.from_sympy(("u", "v", height), ("u", "v"), ((0, 1), (0, 1))))
    assert len(index.index.cells.place) < 4 * 64**2
    slopes = np.array([[-0.1, -0.2], [-0.3, 0.2]])
    found = index.query(unit(np.column_stack([-slopes, np.ones(2)])))
    np.testing.assert_array_equal(found.numbers, [0, 1])
    assert len(found.undecided.numbers) == 0
    # The slope of the height is −2 r / (ε + r²)², nearly −2 r / ε² next to the peak.
    away = -slopes * 1e-10 / 2
    np.testing.assert_allclose(found.uv - 0.5, away, rtol=1e-6, atol=1e-15)


def test_a_heavy_control_point_leaves_nothing_open() -> None:
    surface = heavy(1000.0)
    normal = np.array([[0.1, 0.2, 1.0]]) / np.sqrt(1.05)
    found = new_index(surface).query(normal)
    # Newton's method from 400,000 places, denser along the sides, ends at these two.
    places = [[0.244235, 0.999824], [0.944392, 0.012879]]
    np.testing.assert_allclose(found.uv, places, rtol=0.0, atol=1e-6)
    assert len(found.undecided.numbers) == 0


@pytest.mark.parametrize("weight", [1e5, 1e9])
def test_cells_are_bounded_where_cutting_does_not_help(weight: float) -> None:
    index = new_index(heavy(weight))
    assert len(index.index.cells.place) + len(index.unbounded) <= 24 * 64**2


def test_few_boxes_are_left_where_a_side_is_singular() -> None:
    """Where x_u vanishes along a side, no cut decides the normals of the tangent cone there."""
    r, z = [1.25, 0.75, 1.5, 1.0, 1.25, 1.0, 1.0, 1.0], [0.5, 0.5, 1.0, 1.0, 1.5, 1.5, 2.0, 2.0]
    turn = np.linalg.qr(np.array([(3.0, 1.0, 2.0), (1.0, 4.0, 1.0), (2.0, -1.0, 5.0)]))[0]
    net = np.array([[(a * x, a * y, b) for a, b in zip(r, z, strict=True)] for x, y in CIRCLE])
    weights = np.outer(WEIGHTS, np.ones(len(r)))
    knots = conics(CIRCLE), [*[0.0] * 6, 1.0, 2.0, *[3.0] * 6]
    index = new_index(gm.Surface.from_nurbs((2, 5), knots, net @ turn.T, weights))
    with index.room() as rooms:
        rooms.boxes.following[:] = np.nan
    angles, rise = (x.ravel() for x in np.meshgrid(np.linspace(0.0, 6.0, 25), [0.0, 0.3]))
    around = unit(np.stack([np.cos(angles), np.sin(angles), rise], axis=1))
    assert len(np.unique(index.query(around @ turn.T).undecided.numbers)) == 50
    with index.room() as rooms:
        assert np.isfinite(rooms.boxes.following[:, 0]).sum() < 8192
