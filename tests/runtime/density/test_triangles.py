"""Triangles make up their patches, and lie within their radii."""

from dataclasses import replace

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.density.sizing import SizingFunction, TargetDensity, uniform
from gaussmap.runtime.density.triangles import Triangles, cut_patches

RADII = pytest.mark.parametrize("radius", [0.5, pytest.param(0.06, marks=pytest.mark.compiled)])


def sizing_of(name: str, cells: tuple[int, int]) -> SizingFunction:
    target = TargetDensity(floor=1.0, curvature_weight=1.0)
    return replace(uniform(gm.fit(gm.surfaces.surface(name), cells), None, None), target=target)


def sizes(triangles: Triangles) -> np.ndarray:
    """Return the areas of the triangles (M,) in u, v, twice."""
    return np.abs(np.linalg.det(triangles.corners[:, 1:] - triangles.corners[:, :1]))


@RADII
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid"])
@pytest.mark.quick_for("0.5")
def test_triangles_make_up_the_patches(name, radius):
    triangles = cut_patches(sizing_of(name, (4, 4)), radius)
    odd = np.arange(len(triangles)) % 2 == 1
    for cut in (triangles, triangles.quarters, triangles.halves, triangles[odd] + triangles[~odd]):
        areas = np.bincount(cut.patches, weights=sizes(cut))
        np.testing.assert_allclose(areas, 1.0, rtol=0, atol=1e-12)
        u, v = np.moveaxis(cut.corners, 2, 0)
        assert (np.minimum(u, v) >= -1e-14).all()
        assert (u + v <= 1.0 + 1e-14).all()
        places = np.round(cut.uv * 3e6).astype(int)
        assert len(np.unique(np.column_stack([cut.patches, places]), axis=0)) == len(cut)


@RADII
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid"])
def test_parts_are_their_shares_of_the_whole(name, radius):
    triangles = cut_patches(sizing_of(name, (4, 4)), radius)
    for parts, number in ((triangles.halves, 2), (triangles.quarters, 4)):
        np.testing.assert_array_equal(parts.patches, np.repeat(triangles.patches, number))
        shares = sizes(parts).reshape(-1, number) / sizes(triangles)[:, None]
        np.testing.assert_allclose(shares, 1 / number, rtol=1e-9)


@pytest.mark.compiled
@pytest.mark.parametrize("name", ["torus", "wavy_graph", "ellipsoid", "cone"])
@pytest.mark.quick_for("torus", "wavy_graph", "cone")
def test_no_point_of_a_triangle_is_outside_of_its_radius(name):
    triangles = cut_patches(sizing_of(name, (6, 4)), 0.3)
    for cut in (triangles, triangles.halves.halves):
        centroids = cut.at_places()
        for share in (1.0, 0.5):
            at = points_towards_corners(cut, share)
            lengths = np.linalg.norm(at - centroids[:, None, :3], axis=2)
            assert (lengths <= cut.radii[:, None] * (1 + 1e-9) + 1e-14).all()
    sizing = triangles.sizing
    assert (np.sqrt(sizing.largest[triangles.patches]) * triangles.radii).max() <= 2 * 0.3


def points_towards_corners(triangles: Triangles, share: float) -> np.ndarray:
    """Return points (M, 3, 3) on the way from the centroids to corners."""
    there = triangles.uv[:, None] * (1 - share) + triangles.corners * share
    points = [
        Triangles(triangles.sizing, triangles.patches, np.repeat(there[:, k : k + 1], 3, axis=1))
        for k in range(3)
    ]
    return np.stack([x.at_places()[:, :3] for x in points], axis=1)


@pytest.mark.compiled
@pytest.mark.parametrize("width", [1e-2, 1e-5])
def test_narrow_patches_are_bisected(width):
    """Until they are short enough, or so small that there would be too many of them."""
    plane = gm.Surface.from_callable(
        lambda u, v: np.stack([u, width * v, 0.0 * u], axis=-1), ((0.0, 1.0), (0.0, 1.0))
    )
    sizing = uniform(gm.fit(plane, (4, 4)), None, None)
    for radius in (0.05 * sizing.unit, 0.5 * width * sizing.unit):
        triangles = cut_patches(sizing, radius)
        areas = sizing.areas[triangles.patches] * sizes(triangles)
        short, small = triangles.radii <= radius, areas <= 0.5 * radius**2 * (1 + 1e-9)
        assert (short | small).all()
        assert len(triangles) <= 64 + 4 * max(sizing.area / (0.5 * radius**2), 64 * 2 / radius)


@pytest.mark.parametrize(
    ("name", "cells", "radius"),
    [pytest.param("wavy_graph", (6, 4), 0.3, marks=pytest.mark.compiled), ("torus", (6, 6), 2.0)],
)
def test_angles_of_normals_in_a_triangle(name, cells, radius):
    triangles = cut_patches(sizing_of(name, cells), radius)
    rows = triangles.at_places()
    bounds = triangles.normal_chords(rows)
    assert 0.0 < bounds.max() < 1.0
    for share in (1.0, 0.7, 0.4):
        at = triangles.uv[:, None] * (1 - share) + triangles.corners * share
        for k in range(3):
            there = Triangles(
                triangles.sizing, triangles.patches, np.repeat(at[:, k : k + 1], 3, axis=1)
            )
            chords = np.linalg.norm(there.at_places()[:, 3:6] - rows[:, 3:6], axis=1)
            assert (chords <= bounds * (1 + 1e-9) + 1e-14).all()
            assert share < 1.0 or (chords >= 0.2 * bounds).mean() > 0.5
