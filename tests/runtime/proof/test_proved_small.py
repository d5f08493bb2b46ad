"""The proved search on few cells, also without compilation: every way to an answer once."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.proof.index import ProvedPlaces
from numpy.typing import NDArray

from .judge import index_of, kinds, unit

# Without compilation, NumPy warns where kernels divide by zero.
pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")


def query(name: str, normals: Any, cells: tuple[int, int]) -> ProvedPlaces:
    vectors = np.array(normals, dtype=np.float64)
    return index_of(name, cells=cells, threads=1).query(unit(vectors), threads=1)


def normal_of(slope_u: float, slope_v: float) -> list[float]:
    return [-slope_u, -slope_v, 1.0]


def check_graph(found: ProvedPlaces, number: int, places: list[tuple[float, float]]) -> None:
    mine = found.numbers == number
    assert mine.sum() == len(places)
    away = np.abs(found.uv[mine] - np.reshape(places, (-1, 2)))
    assert (away <= found.radius[mine] + 1e-15).all()
    signs: NDArray[Any] = np.sign([u for u, _ in places])
    np.testing.assert_array_equal(found.sign[mine], signs)


def test_a_graph_with_a_fold() -> None:
    slopes = [(-0.75, 0.3), (-1.0 + 1e-8, 0.2), (-1.0 - 1e-8, 0.2), (0.1, 0.0), (-0.4375, 0.5)]
    found = query("folded", [normal_of(*x) for x in slopes], (4, 4))
    assert kinds(found) == set()
    check_graph(found, 0, [(-0.5, 0.3), (0.5, 0.3)])
    check_graph(found, 1, [(-np.sqrt(1e-8), 0.2), (np.sqrt(1e-8), 0.2)])
    check_graph(found, 2, [])
    check_graph(found, 3, [])
    check_graph(found, 4, [(-0.75, 0.5), (0.75, 0.5)])  # v = 1/2 is the side of cells


def test_a_double_point() -> None:
    found = query("folded", [normal_of(-1.0, 0.2)], (4, 4))
    assert kinds(found) == {"open"}
    assert len(found.undecided.kinds) == 1
    u_low, u_high, v_low, v_high = found.undecided.boxes[0]
    assert u_low <= 0.0 <= u_high
    assert v_low <= 0.2 <= v_high
    assert max(u_high - u_low, v_high - v_low) < 1e-6


@pytest.mark.compiled
def test_points_at_poles() -> None:
    normals = [(0, 0, 1), (0, 0, -1), (0.02, 0.01, 1), (1e-9, 1e-9, 1), (1, 1, 0.1)]
    found = query("sphere", normals, (8, 8))
    assert kinds(found) == set()
    np.testing.assert_array_equal(found.numbers, range(5))
    points = gm.surfaces.sphere().evaluate(*found.uv.T)
    exact = np.array(normals) / np.linalg.norm(normals, axis=1, keepdims=True)
    np.testing.assert_allclose(points, exact, rtol=0.0, atol=1e-12)


def test_a_flat_region() -> None:
    found = query("plane", [(0, 0, 1), (0, 0.6, 0.8)], (4, 4))
    assert kinds(found) == {"curve"}
    assert len(found.undecided.kinds) == 1


def test_a_singular_point() -> None:
    slope = 1.25  # of the meridian at v = 1/2, where it has the angle 1
    found = query("horn", [(slope * np.cos(1.0), slope * np.sin(1.0), -1.0)], (8, 4))
    assert kinds(found) == set()
    np.testing.assert_allclose(found.uv, [[1.0, 0.5]], rtol=0.0, atol=1e-12)
