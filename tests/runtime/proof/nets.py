"""The judge of points of NURBS surfaces: Bézier patches, cones of normals, Newton's method.

It shares no code with the library: patches come from values that SciPy computes, and points are
searched from the cells of a grid whose normals are near. It may miss points that the library has;
these are tested one by one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import comb
from typing import Any

import gaussmap as gm
import numpy as np
from scipy.interpolate import BSpline
from scipy.spatial import KDTree

from ...shapes import CIRCLE, WEIGHTS, conics, quotients
from .judge import Array, unit

# The cells of a patch along each parameter; points of two patches this near, relative to the size
# of the surface, are one; so are two within SAME; normals are within TURNED of the requested ones.
CELLS, NEAR, SAME, TURNED = 24, 1e-6, 1e-9, 3e-9
STEPS, OUTSIDE = 30, 1e-7


def bernstein(degree: int, t: Array, order: int) -> Array:
    """Return derivatives (k, degree + 1) of an order of all Bernstein polynomials."""
    if order > degree:
        return np.zeros((len(t), degree + 1))
    p = degree - order
    rows = np.array([comb(p, i) * t**i * (1.0 - t) ** (p - i) for i in range(p + 1)]).T
    for q in range(p + 1, degree + 1):
        rows = q * (np.pad(rows, ((0, 0), (1, 0))) - np.pad(rows, ((0, 0), (0, 1))))
    return rows


@dataclass(frozen=True)
class Net:
    """A NURBS surface."""

    degrees: tuple[int, int]
    knots: tuple[Array, Array]
    points: Array
    weights: Array

    @property
    def surface(self) -> gm.Surface:
        return gm.Surface.from_nurbs(self.degrees, self.knots, self.points, self.weights)

    @property
    def size(self) -> float:
        return float(np.ptp(self.points, axis=(0, 1)).max())

    def part(self, axis: int, start: int, end: int) -> Net:
        """Return the part between two full knots, with these numbers of control points."""
        p, knots = self.degrees[axis], list(self.knots)
        inner = knots[axis][start + 1 : end + p]
        knots[axis] = np.concatenate([inner[:1], inner, inner[-1:]])
        points, weights = (x.take(range(start, end), axis) for x in (self.points, self.weights))
        return Net(self.degrees, (knots[0], knots[1]), points, weights)

    @cached_property
    def spans(self) -> list[Array]:
        return [np.unique(x) for x in self.knots]

    @cached_property
    def patches(self) -> Array:
        """The homogeneous control points (m, n, p + 1, q + 1, 4) of Bézier patches."""
        sides = []
        for p, knots, ends in zip(self.degrees, self.knots, self.spans, strict=True):
            t = 0.5 - 0.5 * np.cos(np.pi * (np.arange(p + 1) + 0.5) / (p + 1))
            basis = BSpline(knots, np.eye(len(knots) - p - 1), p)
            values = basis(ends[:-1, None] + np.diff(ends)[:, None] * t)
            sides.append(np.linalg.inv(bernstein(p, t, 0)) @ values)
        weights = self.weights[..., None]
        whole = np.concatenate([self.points * weights, weights], axis=2)
        return np.einsum("mai,nbj,ijx->mnabx", *sides, whole)

    def jets(self, i: int, j: int, s: Array, t: Array) -> Array:
        """Return x, x_s, x_t, x_ss, x_st, x_tt (6, k, 3) of a patch at parameters from 0 to 1."""
        along, across = (
            [bernstein(p, x, k) for k in range(3)]
            for p, x in zip(self.degrees, (s, t), strict=True)
        )
        orders = (0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)
        found = [
            np.einsum("ka,kb,abx->kx", along[a], across[b], self.patches[i, j], optimize=True)
            for a, b in orders
        ]
        return quotients(found)

    def turned(self, uv: Array, normals: Array) -> Array:
        """Return the least angle (k,) of unit normals with those of the patches at parameters."""
        angles = np.full(len(uv), np.inf)
        for shift in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            cells = [
                np.clip(np.searchsorted(x, y + 1e-9 * z, "right") - 1, 0, len(x) - 2)
                for x, y, z in zip(self.spans, uv.T, shift, strict=True)
            ]
            for i, j in np.unique(np.transpose(cells), axis=0).tolist():
                rows = np.flatnonzero((cells[0] == i) & (cells[1] == j))
                st = [
                    (uv[rows, k] - x[c]) / (x[c + 1] - x[c])
                    for k, (x, c) in enumerate(zip(self.spans, (i, j), strict=True))
                ]
                _, x_s, x_t, *_ = self.jets(i, j, *st)
                normal = np.cross(x_s, x_t)
                angle = np.linalg.norm(unit(normal) - normals[rows], axis=1)
                # Poles have one normal, which the points around them are asked for.
                angle[np.linalg.norm(normal, axis=1) < 1e-9 * self.size**2] = 0.0
                angles[rows] = np.fmin(angles[rows], angle)
        return angles

    @np.errstate(all="ignore")
    def points_at(self, normals: Array) -> tuple[Array, Array]:
        """Return points (k, 3) with unit normals and the numbers (k,) of these, some repeated."""
        tree, found = KDTree(normals), []
        corners = np.clip(np.linspace(0.0, 1.0, CELLS + 1), NEAR, 1.0 - NEAR)
        middles = (np.arange(CELLS) + 0.5) / CELLS
        for i, j in np.ndindex(self.patches.shape[:2]):
            places = [
                [x.ravel() for x in np.meshgrid(y, y, indexing="ij")] for y in (corners, middles)
            ]
            own = [unit(np.cross(*self.jets(i, j, *x)[1:3])) for x in places]
            around = own[0].reshape(CELLS + 1, CELLS + 1, 3)
            around = [around[a : a + CELLS, b : b + CELLS] for a in (0, 1) for b in (0, 1)]
            reach = [np.linalg.norm(x.reshape(-1, 3) - own[1], axis=1) for x in around]
            radius = np.nan_to_num(1.6 * np.max(reach, axis=0) + NEAR, nan=3.0)
            near = tree.query_ball_point(np.nan_to_num(own[1]), radius)
            cell = np.repeat(np.arange(CELLS**2), [len(x) for x in near])
            number = np.concatenate(near).astype(np.int64)
            (s, t), n = (x[cell] for x in places[1]), normals[number]
            step = np.full(len(s), np.inf)
            for _ in range(STEPS if len(number) > 0 else 0):
                p, q, a, b, c = np.einsum("dkx,kx->dk", self.jets(i, j, s, t)[1:], n)
                step = np.stack([b * q - c * p, b * p - a * q]) / (a * c - b * b)
                size = np.hypot(*step)
                step *= np.where(np.isfinite(size), np.minimum(1.0, 0.2 / size), np.nan)
                s, t = np.clip(np.nan_to_num(np.stack([s, t]) + step, nan=0.5), -0.1, 1.1)
                step = size
            jets = self.jets(i, j, s, t)
            normal = np.cross(jets[1], jets[2])
            inside = (np.abs(np.stack([s, t]) - 0.5) <= 0.5 + OUTSIDE).all(axis=0)
            is_point = (np.linalg.norm(unit(normal) - n, axis=1) < TURNED) & (step < SAME) & inside
            is_point &= np.linalg.norm(normal, axis=1) > 1e-9 * self.size**2
            found.append((jets[0][is_point], number[is_point]))
        points, numbers = (np.concatenate(x) for x in zip(*found, strict=True))
        return points, numbers


def wrong_at(net: Net, normals: Array, found: gm.Samples) -> set[int]:
    """Return normals at which points are missing, twice there, or have another normal.

    Normals with other components than regular points may lack some of these.
    """
    assert found.component is not None
    regular = found.component == gm.Component.REGULAR
    points, numbers, uv = found.points[regular], found.normal_index[regular], found.uv[regular]
    special = set(found.normal_index[~regular].tolist())
    wrong = set(numbers[net.turned(uv, normals[numbers]) > TURNED].tolist())
    starts = np.searchsorted(numbers, np.arange(len(normals) + 1))
    for point, number in zip(*net.points_at(normals), strict=True):
        own = points[starts[number] : starts[number + 1]]
        away = np.linalg.norm(own - point, axis=1).min(initial=np.inf)
        if away > NEAR * net.size and number not in special:
            wrong.add(int(number))
    for step in range(1, 12):
        same = numbers[step:] == numbers[:-step]
        near = np.linalg.norm(points[step:] - points[:-step], axis=1) < SAME * net.size
        wrong |= set(numbers[step:][same & near].tolist())
    return wrong


def revolved(
    profile: Any, weights: Any, knots: Array, matrix: Array, digits: int = 17, circle: Any = CIRCLE
) -> Net:  # fmt: skip
    """Return a profile (k, 2) of radii and heights, turned about z, and mapped by a matrix.

    Control points and weights are rounded to some digits. Another `circle` (9, 2) has corners.
    """
    points = np.array([[(r * x, r * y, z) for x, y in circle] for r, z in profile]) @ matrix.T
    rounded = np.vectorize(lambda x: float(f"%.{digits - 1}e" % x))
    degree = len(knots) - len(profile) - 1
    all_weights = rounded(np.outer(weights, WEIGHTS))
    return Net((degree, 2), (knots, conics(CIRCLE)), rounded(points), all_weights)
