"""The bounds of the proof hold, and are not much too wide; wrong ones are noticed."""

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.proof.index import ProvedIndex

from ...shapes import CIRCLE, WEIGHTS, conics
from .judge import index_of, jets_at, new_index, normals_at, position_of, surface_of, unit
from .test_proved import ball, cap


@pytest.mark.parametrize("name", ["ball", "cap", "ellipsoid"])
def test_bounds_of_discs_hold(name: str) -> None:
    """Gradients over the tangent plane, from points of the surface, have slopes within bounds."""
    surface: gm.Surface = {
        "ball": lambda: ball((1.0, 0.7, 1.3), 0.3)[0],
        "cap": lambda: cap(bump=0.02, tip=1.0),
        "ellipsoid": lambda: surface_of("ellipsoid"),
    }[name]()
    for pole in new_index(surface).discs:
        disc, rng = pole.disc, np.random.default_rng(20)
        _, _, size, low, turn, end, inward, _, unit_of, whole, *_ = disc.frame
        normal = disc.basis[2] / np.linalg.norm(disc.basis[2])
        frame = np.linalg.inv(disc.basis.T)
        u, r = low + turn * rng.uniform(size=4000), 2.0 * size * rng.uniform(0.2, 1.0, 4000)
        x, x_u, x_v, *_ = jets_at(surface, u, end + inward * r)
        middle = jets_at(surface, np.array([low]), np.array([end]))[0]
        q = (x - middle) @ frame.T / unit_of
        n = np.cross(x_u, x_v) @ np.linalg.inv(frame)
        slopes = -unit_of * n[:, :2] / n[:, 2:]
        a, b, c = disc.hot[0, :9].reshape(3, 3) @ normal
        rest = slopes - np.stack([a * q[:, 0] + b * q[:, 1], b * q[:, 0] + c * q[:, 1]], axis=1)
        d_a, d_b, d_c = disc.changes[0] @ np.abs(normal) / (np.abs(normal) ** 2).sum()
        # Of the origin, and of one another.
        for step in (0, 1):
            by = np.abs(q - step * np.roll(q, 1, axis=0))
            off = np.abs(rest - step * np.roll(rest, 1, axis=0))
            bound = np.stack([d_a * by[:, 0] + d_b * by[:, 1], d_b * by[:, 0] + d_c * by[:, 1]], 1)
            inside = np.linalg.norm(q, axis=1) <= whole
            inside &= np.roll(inside, 1)
            assert (off <= bound + 1e-12 * np.abs(slopes).max())[inside].all()
            assert inside.mean() > 0.5


def excess_of_thirds(name: str, index: ProvedIndex) -> float:
    """Return how much third derivatives exceed their bounds, relative to these, at most."""
    u, v = sp.symbols("u v", real=True)
    orders = ((3, 0), (2, 1), (1, 2), (0, 3))
    exact = [sp.diff(x, u, i, v, j) for i, j in orders for x in position_of(name)]
    evaluate = sp.lambdify((u, v), exact)
    cells, rng, most = index.index.cells, np.random.default_rng(8), -1.0
    for j in rng.integers(len(cells.place), size=300):
        u0, v0, h_u, h_v = cells.place[j]
        reach = cells.noise[j, 3]
        steps = np.concatenate(
            [rng.uniform(-reach, reach, (4, 2)), reach * rng.choice([-1, 1], (4, 2))]
        )
        scale = np.repeat([h_u ** (3 - k) * h_v**k for k in range(4)], 3)
        for s, t in steps:
            values = np.array(evaluate(u0 + h_u * s, v0 + h_v * t), dtype=np.float64) * scale
            off = np.abs(values - cells.thirds[j, :12]) - cells.thirds[j, 12:]
            most = max(most, float((off / np.abs(values).max()).max()))
    return most


@pytest.mark.parametrize("name", ["sum", "knobby"])
def test_bounds_hold_third_derivatives(name: str) -> None:
    assert excess_of_thirds(name, index_of(name)) <= 1e-12


def test_cones_hold_the_normals_of_cells() -> None:
    surface, index = surface_of("knobby"), index_of("knobby")
    cells, rng = index.index.cells, np.random.default_rng(9)
    ratios = []
    for j in rng.integers(len(cells.place), size=200):
        u0, v0, h_u, h_v = cells.place[j]
        s, t = rng.uniform(-1.0, 1.0, (2, 40)).round(rng.integers(0, 2))
        away = normals_at(surface, u0 + h_u * s, v0 + h_v * t) - cells.cone[j, :3]
        ratios.append(np.linalg.norm(away, axis=1).max() / cells.cone[j, 3])
    assert max(ratios) <= 1.0
    assert np.median(ratios) > 0.5  # the cones are not much too wide


# --- numbers of cells of an index -----------------------------------------------------------------


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
