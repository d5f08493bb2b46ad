"""Caps and polygons on the sphere: who is in, who is out, and what is refused."""

from itertools import combinations
from typing import Any

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.directions.regions import angles_between

from ...products import covering
from ...refusals import refused

NORMALS = gm.fibonacci(20_000)
OCTANT = [[1, 0, 0], [0, 2, 0], [0, 0, 3]]


def shares(part: Any) -> float:
    return len(part) / len(NORMALS)


# --- angles ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [0.0, 1e-12, 1e-6, 1.0, 60.0, 90.0, 179.0, 180 - 1e-6])
def test_angles_are_accurate_near_0_and_180(degrees: float) -> None:
    t = np.radians(degrees)
    axis, other = np.array([0, 0, 1.0]), np.array([np.sin(t), 0, np.cos(t)])
    # an angle is known to the rounding of the coordinates, an ε of a radian
    assert abs(float(angles_between(other, axis)) - degrees) <= np.degrees(4 * 2.0**-52)


# --- caps -----------------------------------------------------------------------------------------


@covering(angle=[1.0, 30.0, 90.0, 150.0], axis=[[0, 0, 1], [-3, 0, 0], [1, 2, -3]])
def test_a_cap_has_its_share(angle: float, axis: Any) -> None:
    part = gm.directions.cap(NORMALS, axis, angle)
    cosines = part @ axis / np.linalg.norm(axis)
    assert cosines.min() >= np.cos(np.radians(angle)) - 1e-15
    area = (1 - np.cos(np.radians(angle))) / 2
    assert abs(shares(part) - area) < 3 * len(NORMALS) ** -0.75
    rest = gm.directions.cap(NORMALS, -np.asarray(axis), np.nextafter(180 - angle, 0))
    assert len(part) + len(rest) == len(NORMALS)


def test_a_cap_keeps_order_and_bits() -> None:
    part = gm.directions.cap(NORMALS, [0, 0, 1], 40)
    assert (part == NORMALS[: len(part)]).all()
    scaled = gm.directions.cap(8 * NORMALS, [0, 0, 1e-300], np.float64(40))
    assert (scaled == part).all()


def test_its_border_belongs_to_a_cap() -> None:
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    assert len(gm.directions.cap(axes, [0, 0, 1], 90)) == 5
    assert gm.directions.cap(axes, [0, 0, 1], 0).tolist() == [[0, 0, 1]]
    assert len(gm.directions.cap(axes, [0, 0, 1], 180)) == 6
    assert gm.directions.cap(axes, [1, 1, 1], 54).shape == (0, 3)
    assert len(gm.directions.cap(axes, [1, 1, 1], 55)) == 3


def test_a_small_cap_of_close_normals() -> None:
    t = np.array([0.5e-9, 1.5e-9])
    close = np.stack([np.sin(t), 0 * t, np.cos(t)], axis=1)
    assert len(gm.directions.cap(close, [0, 0, 1], np.degrees(1e-9))) == 1


@pytest.mark.parametrize("angle", [-1, 180.1, np.nan, np.inf, "30", None])
def test_angles_that_are_none(angle: Any) -> None:
    refused(r"^angle must", gm.directions.cap, NORMALS, [0, 0, 1], angle)


@pytest.mark.parametrize("axis", [[0, 0, 0], [0, np.nan, 1], [0, 1], "z"])
def test_axes_that_are_none(axis: Any) -> None:
    refused(r"^axis ", gm.directions.cap, NORMALS, axis, 30)


# --- polygons -------------------------------------------------------------------------------------


def test_an_octant() -> None:
    part = gm.directions.polygon(NORMALS, OCTANT)
    assert (part >= 0).all()
    assert len(part) == (NORMALS >= 0).all(axis=1).sum()


def test_the_faces_of_an_icosahedron_cover_the_sphere() -> None:
    corners = gm.icosphere(1)
    cosines = corners @ corners.T
    edges = np.abs(cosines - np.sort(cosines[0])[-2]) < 1e-12
    faces = [x for x in combinations(range(12), 3) if edges[np.ix_(x, x)].sum() == 6]
    assert len(faces) == 20
    parts = []
    for face in faces:
        triangle = corners[list(face)]
        turned = triangle if np.linalg.det(triangle) > 0 else triangle[::-1]
        parts.append(gm.directions.polygon(NORMALS, turned))
    assert len(np.concatenate(parts)) == len(NORMALS)
    assert len(np.unique(np.concatenate(parts), axis=0)) == len(NORMALS)


def test_corners_on_one_great_circle_bound_a_hemisphere() -> None:
    corners = [[1, 0, 0], [-1, 2, 0], [-1, -2, 0]]
    assert (gm.directions.polygon(NORMALS, corners)[:, 2] >= 0).all()
    assert len(gm.directions.polygon(NORMALS, corners)) == len(NORMALS) // 2


def test_its_corners_belong_to_a_polygon() -> None:
    triangle = gm.fibonacci(50)[[3, 20, 9]]
    turned = triangle if np.linalg.det(triangle) > 0 else triangle[::-1]
    inside = gm.directions.polygon(np.concatenate([turned, -turned]), turned)
    assert (inside == turned).all()
    assert gm.directions.polygon(-turned, turned).shape == (0, 3)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        (OCTANT[:2], "needs at least 3 corners, not 2"),
        (OCTANT[::-1], "anticlockwise"),
        ([[1, 0, 0], [1, 0, 0], [0, 1, 0]], "corners 0 and 1 are equal or opposite"),
        ([[1, 0, 0], [0, 1, 0], [-1, 0, 0]], "corners 2 and 0 are equal or opposite"),
        ([[2, 0, 1], [0.1, 0.1, 1], [0, 2, 1], [-2, -2, 1]], "convex"),  # with a notch
        ([[0, 0, 0], [0, 1, 0], [1, 0, 0]], "zero vector"),
        ([[np.nan, 0, 0], [0, 1, 0], [1, 0, 0]], "NaN"),
    ],
)
def test_corners_that_are_none(corners: Any, message: str) -> None:
    refused(message, gm.directions.polygon, NORMALS, corners)
