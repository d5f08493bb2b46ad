"""The covering radius: exact cases, brute force, sets that lie in a plane or a hemisphere."""

from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.directions.regions import angles_between
from hypothesis import given
from hypothesis import strategies as st

from ...shapes import AXES, Array

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
TETRAHEDRON = CUBE[[0, 3, 5, 6]]
ACCURACY = 1e-12  # degrees: some ε of a radian, and coordinates that are rounded


def ring(colatitude: float, angles: Any) -> Array:
    t, c = np.radians(np.asarray(angles, float)), np.radians(colatitude)
    return np.stack([np.sin(c) * np.cos(t), np.sin(c) * np.sin(t), np.cos(c) + 0 * t], axis=1)


def nearest(places: Array, normals: Array) -> Array:
    return angles_between(places[:, None], normals).min(axis=1)


def by_search(normals: Array) -> tuple[float, float]:
    """Return bounds of the radius in degrees, by branch and bound over the faces of a cube.

    Central projection of a face brings points no farther apart, and the distance to the nearest
    normal changes no faster than the place: so a square of the half-width w can only matter if the
    distance at its middle plus w√2 exceeds the best that was found.
    """
    face, s, t = (x.ravel() for x in np.meshgrid(np.arange(6), 0.0, 0.0, indexing="ij"))
    width, best, reach = 1.0, 0.0, 180.0
    while reach > 1e-3:
        flat = np.stack([s, t, np.ones_like(s)], axis=1)
        places = np.where(face % 2, 1.0, -1.0)[:, None] * flat
        places = np.take_along_axis(places, (np.arange(3) + face[:, None] // 2) % 3, axis=1)
        distances = nearest(places / np.linalg.norm(places, axis=1, keepdims=True), normals)
        best, reach = max(best, float(distances.max())), float(np.degrees(width * np.sqrt(2)))
        kept = distances + reach > best
        width /= 2
        corners = [(i, j) for i in (-width, width) for j in (-width, width)]
        face = np.repeat(face[kept], 4)
        s, t = (
            (np.repeat(x[kept], 4).reshape(-1, 4) + [c[k] for c in corners]).ravel()
            for k, x in enumerate((s, t))
        )
    return best, best + reach


# --- exact cases ----------------------------------------------------------------------------------


def degrees(cosine: float) -> float:
    return float(np.degrees(np.arccos(cosine)))


EXACT: dict[str, tuple[Any, float]] = {
    "octahedron": (AXES, degrees(3**-0.5)),
    "cube": (CUBE, degrees(3**-0.5)),
    "tetrahedron": (TETRAHEDRON, degrees(1 / 3)),
    "icosahedron": (gm.icosphere(1), degrees(np.sqrt((5 + 2 * np.sqrt(5)) / 15))),
    "healpix": (gm.directions.healpix(1), degrees(2 / 3)),
    "one normal": ([[0, 3, 4]], 180.0),
    **{f"{x} degrees": (ring(90, [0, x]), 180 - x / 2) for x in (1e-6, 1.0, 90.0, 179.0, 180.0)},
}


@pytest.mark.parametrize("name", EXACT)
def test_exact_cases(name: str) -> None:
    normals, radius = EXACT[name]
    for repeated in (normals, np.concatenate([normals, 3 * np.asarray(normals)])):
        assert abs(gm.directions.covering_radius(repeated) - radius) < ACCURACY


# --- brute force ----------------------------------------------------------------------------------


def check(normals: Array) -> None:
    low, high = by_search(normals)
    assert low - 1e-9 <= gm.directions.covering_radius(normals) <= high + 1e-9


@given(
    count=st.integers(1, 30),
    seed=st.integers(0, 10**6),
    squeezed=st.sampled_from([1.0, 0.3, 0.01, 0.0]),
    shift=st.sampled_from([0.0, 0.5, 1.0, 3.0]),
)
def test_against_a_search(count: int, seed: int, squeezed: float, shift: float) -> None:
    """Random sets: all round, flat, on one side."""
    vectors = np.random.default_rng(seed).standard_normal((count, 3))
    vectors = vectors * [1, 1, squeezed] + [0, 0, shift]
    check(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


@pytest.mark.parametrize(
    "normals",
    [
        pytest.param(gm.fibonacci(500), marks=pytest.mark.slow),
        gm.directions.random(300),
        gm.directions.healpix(4),
    ],
)
def test_sets_against_a_search(normals: Array) -> None:
    check(normals)
