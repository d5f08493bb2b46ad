"""Splines of users' own nets: joints, and every point with a normal exactly once."""

from __future__ import annotations

import pickle
from fractions import Fraction
from itertools import pairwise

import gaussmap as gm
import numpy as np
import pytest
from gaussmap.runtime.search.in_nets import edge_signs
from gaussmap.runtime.spline.joints import EDGES
from numpy.typing import NDArray
from scipy.spatial import Delaunay

Array = NDArray[np.float64]
SYMMETRIC = np.array([x for x in np.ndindex(5, 5, 5) if x != (2, 2, 2)]) - 2.0


def octants() -> tuple[Array, NDArray[np.int64]]:
    """Return points and triangles of a closed spline of 8 patches, with continuous normals."""
    points, triangles = list[tuple[int, ...]](), list[list[int]]()

    def number(point: Array) -> int:
        key = tuple(int(x) for x in point)
        if key not in points:
            points.append(key)
        return points.index(key)

    net = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1)])
    for signs in np.ndindex(2, 2, 2):
        flip = 1 - 2 * np.array(signs)
        rows = [0, 1, 2, 3, 4, 5] if flip.prod() > 0 else [1, 0, 2, 3, 5, 4]
        triangles.append([number(p) for p in (net * flip)[rows]])
    return np.array(points, dtype=np.float64), np.array(triangles)


def powell_sabin(count: int, seed: int, bumps: float) -> Array:
    """Return the nets (6 T, 6, 3) of a Powell-Sabin spline over random points of a square."""
    random = np.random.default_rng(seed)
    square = np.array([(x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    places = np.concatenate([square, random.uniform(-0.9, 0.9, (count, 2))])

    def value(x: float, y: float) -> tuple[Array, Array]:
        f = np.array([x + 0.1 * x * y, y - 0.1 * x * x, x * x + y * y + bumps * np.sin(3 * x * y)])
        c = 3 * bumps * np.cos(3 * x * y)
        return f, np.array([[1 + 0.1 * y, 0.1 * x], [-0.2 * x, 1], [2 * x + c * y, 2 * y + c * x]])

    mesh = Delaunay(places)
    centres = []
    for corners in places[mesh.simplices]:
        sides = [np.linalg.norm(corners[(k + 1) % 3] - corners[(k + 2) % 3]) for k in range(3)]
        centres.append(np.average(corners, axis=0, weights=sides))
    nets = []
    for t, (corners, others) in enumerate(zip(mesh.simplices, mesh.neighbors, strict=True)):
        Z, bars = centres[t], np.linalg.inv(np.c_[places[corners], np.ones(3)].T)
        towards = {i: _towards(value, places[i], Z) for i in corners}
        middle = sum(b * towards[i] for b, i in zip(bars @ [*Z, 1.0], corners, strict=True))
        for k in range(3):
            i, j = corners[(k + 1) % 3], corners[(k + 2) % 3]
            share = 0.5 if others[k] < 0 else _crossing(places[i], places[j], Z, centres[others[k]])
            R = (1 - share) * places[i] + share * places[j]
            at_i, at_j = _towards(value, places[i], R), _towards(value, places[j], R)
            on_edge = (1 - share) * at_i + share * at_j
            inner = (1 - share) * towards[i] + share * towards[j]
            f_i, f_j = value(*places[i])[0], value(*places[j])[0]
            nets.append([f_i, on_edge, middle, at_i, towards[i], inner])
            nets.append([on_edge, f_j, middle, at_j, inner, towards[j]])
    return np.array(nets)


def _towards(value, place: Array, other: Array) -> Array:  # noqa: ANN001
    f, gradient = value(*place)
    return f + 0.5 * gradient @ (other - place)


def _crossing(p: Array, q: Array, a: Array, b: Array) -> float:
    return float(np.linalg.solve(np.column_stack([q - p, a - b]), a - p)[0])


def brute_force(nets: Array, normal: Array) -> list[int]:
    """Return the signs of K of all points with a normal that is on no joint, on fractions."""
    n = [Fraction(float(x)) for x in normal]

    def dot(p: Array) -> Fraction:
        return sum((x * Fraction(float(y)) for x, y in zip(n, p, strict=True)), Fraction(0))

    found = []
    for net in nets:
        h = [dot(p) for p in net]
        # n·p as a quadratic polynomial; its critical point by Cramer's rule.
        a, c = 2 * (h[0] - 2 * h[4] + h[2]), 2 * (h[1] - 2 * h[5] + h[2])
        b, d, e = 2 * (h[3] - h[4] - h[5] + h[2]), 2 * (h[4] - h[2]), 2 * (h[5] - h[2])
        if (D := a * c - b * b) == 0:
            continue
        u, v = (b * e - c * d) / D, (b * d - a * e) / D
        if u <= 0 or v <= 0 or u + v >= 1:
            continue
        rows = [[Fraction(float(x)) for x in p] for p in net]
        w = 1 - u - v
        x_u = [2 * ((p - t) * u + (q - s) * v + (t - r) * w) for p, q, r, s, t in _parts(rows, 0)]
        x_v = [2 * ((p - t) * v + (q - s) * u + (t - r) * w) for p, q, r, s, t in _parts(rows, 1)]
        cross = [x_u[i - 2] * x_v[i - 1] - x_u[i - 1] * x_v[i - 2] for i in range(3)]
        if sum(x * y for x, y in zip(cross, n, strict=True)) > 0:
            found.append(1 if D > 0 else -1)
    return found


def _parts(rows, which: int):  # noqa: ANN001, ANN202
    b200, b020, b002, b110, b101, b011 = rows
    one = (b200, b110, b002, b011, b101) if which == 0 else (b020, b110, b002, b101, b011)
    return zip(*one, strict=True)


def degrees(samples: gm.Samples, count: int) -> Array:
    signs = np.copysign(1.0, samples.gaussian_curvature)
    return np.bincount(samples.normal_index, signs, minlength=count)


def normals_on_joints(spline) -> tuple[Array, Array]:  # noqa: ANN001
    """Return normals at places of all joints, and at all corners of joints."""
    joints = spline.joints
    inside, corners = [], []
    for patch, edge in zip(joints.patches[:, 0], joints.edges[:, 0], strict=True):
        start, middle, end, beside, end_beside = spline.control_nets[patch][list(EDGES[edge])]
        for t in (0.0, 0.25, 0.5, 0.7, 1.0):
            along = (1 - t) * (middle - start) + t * (end - middle)
            across = (1 - t) * (beside - start) + t * (end_beside - middle)
            (corners if t in (0.0, 1.0) else inside).append(-np.cross(along, across) * -1)
    return np.array(inside), np.array(corners)


def test_closed_spline_of_8_patches() -> None:
    """Eight octants of a closed surface; its joints are creases, whose angle is known."""
    points, triangles = octants()
    spline = gm.Spline.from_nets(points, triangles, name="octants")
    joints = spline.joints
    assert joints.patches.shape == (12, 2)
    assert np.bincount(joints.patches.ravel()).tolist() == [3] * 8
    assert not joints.smooth.any()
    # Half-way along an edge the normal is (1, 1, 1) x's largest tilt out of the plane of symmetry.
    assert np.allclose(joints.angles, 2.0 * np.degrees(np.arctan(np.sqrt(0.125))), atol=1e-9)
    normals = gm.directions.random(500, seed=1)
    samples = gm.sample(spline, normals=normals)
    for k, n in enumerate(normals):
        mine = samples.gaussian_curvature[samples.normal_index == k]
        assert sorted(np.sign(mine)) == brute_force(spline.control_nets, n)


@pytest.mark.parametrize("bumps", [0.0, 0.15, 0.6])
def test_powell_sabin_spline(bumps: float) -> None:
    nets = powell_sabin(30, 3, bumps)
    spline = gm.Spline.from_nets(nets, name="Powell-Sabin")
    assert spline.joints.smooth.all()
    assert spline.joints.angles.max() < 1e-9
    normals = gm.directions.random(400, seed=2) * [0.6, 0.6, 1.0]
    normals[:, 2] = np.abs(normals[:, 2]) + 0.2
    samples = gm.sample(spline, normals=normals)
    for k, n in enumerate(normals / np.linalg.norm(normals, axis=1, keepdims=True)):
        mine = samples[samples.normal_index == k]
        assert sorted(np.sign(mine.gaussian_curvature)) == sorted(brute_force(nets, n))


@pytest.mark.parametrize("bumps", [0.0, 0.15, 0.6])
def test_normals_on_joints_and_at_corners(bumps: float) -> None:
    """They have what normals next to them have: Σ sign K does not change at folds either."""
    nets = powell_sabin(30, 3, bumps)
    spline = gm.Spline.from_nets(nets)
    inside, corners = normals_on_joints(spline)
    normals = np.concatenate([inside, corners])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    border = gm.sample(spline, normals=normals + [1e-6, 1.7e-6, 0.3e-6])
    counts = degrees(gm.sample(spline, normals=normals), len(normals))
    others = degrees(border, len(normals))
    assert (counts == others).mean() > 0.95  # those at the border of the square differ
    away = np.array([_is_inside(nets, n) for n in normals])
    assert (counts[away] == others[away]).all()


def _is_inside(nets: Array, normal: Array) -> bool:
    """Return whether Σ sign K is the same all around a normal, by brute force."""
    turns = np.linspace(0.0, 2.0 * np.pi, 6)[:-1] + 0.1
    found = {sum(brute_force(nets, normal + 1e-7 * np.array([np.cos(t), np.sin(t), 0.1 * np.sin(2 * t)]))) for t in turns}
    return len(found) == 1
