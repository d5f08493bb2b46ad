"""The bounds of the proof hold, and are not much too wide; wrong ones are noticed."""

import gaussmap as gm
import numpy as np
import pytest
import sympy as sp
from gaussmap.runtime.proof.index import ProvedIndex

from .judge import index_of, jets_at, new_index, normals_at, position_of, surface_of
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
