"""The constants of docs/alignment.md on surfaces, and the lantern of Schwarz."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from gaussmap.benchmarks.peers.forms import Array
from gaussmap.benchmarks.peers.metrics import angles
from gaussmap.docs.orders import TrueSurface, markdown
from gaussmap.symbolic import cells

__all__ = [
    "ALIGNED", "CHORD", "HEXAGON", "SIDES", "cells_table", "lantern_table", "stretched_table",
]  # fmt: skip

SIZES = (0.1, 0.01, 0.001)  # of cells, relative to the smaller radius of curvature
STRETCHES = (1, 2, 5, 10, 30)
TURNS = 720  # directions of a triangle
RINGS = (10, 40, 160, 640, 2560)  # of the lantern
SIDES = 40

ALIGNED, HEXAGON, CHORD = (float(x) for x in (cells.ALIGNED, cells.HEXAGON, cells.CHORD))


# --- cells on surfaces ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Spot:
    """A point of a surface with its principal curvatures and directions (over the parameters)."""

    true: TrueSurface
    at: Array  # (2,), in the unit square

    @cached_property
    def jet(self) -> Array:
        """The position and its derivatives there."""
        return self.true.derivatives(self.at[0], self.at[1], 2)

    @cached_property
    def principal(self) -> tuple[Array, Array]:
        """The principal curvatures, the larger one first, and parameters of unit directions."""
        _, x_s, x_t, *second = self.jet
        normal = np.cross(x_s, x_t)
        normal /= np.linalg.norm(normal)
        first = np.array([[x_s @ x_s, x_s @ x_t], [x_s @ x_t, x_t @ x_t]])
        L, M, N = (x @ normal for x in second)
        to_frame = np.linalg.inv(np.linalg.cholesky(first)).T
        curvatures, turned = np.linalg.eigh(to_frame.T @ np.array([[L, M], [M, N]]) @ to_frame)
        order = np.argsort(-np.abs(curvatures))
        return curvatures[order], (to_frame @ turned)[:, order]

    def points(self, offsets: Array) -> tuple[Array, Array]:
        """Return points and unit normals at offsets (k, 2) along the principal directions."""
        _, directions = self.principal
        places = self.at + offsets @ directions.T
        x, x_s, x_t = np.moveaxis(self.true.derivatives(places[:, 0], places[:, 1], 1), -2, 0)
        normals = np.cross(x_s, x_t)
        return x, normals / np.linalg.norm(normals, axis=1)[:, None]


def rectangle(spot: Spot, size: float) -> float:
    """Return the angle between the middle and the corners of the best rectangle, scaled."""
    (first, second), _ = spot.principal
    p, q = size / abs(first), size / abs(second)
    corners = np.array([[0, 0], [p, q], [-p, q], [p, -q], [-p, -q]]) / 2
    normals = spot.points(corners)[1]
    return radians(normals[1:], normals[0]).max() / math.sqrt(abs(first * second) * p * q)


def diagonal(spot: Spot, size: float) -> float:
    """Return the angle between a triangle of this rectangle and its corners, scaled."""
    (first, second), _ = spot.principal
    p, q = size / abs(first), size / abs(second)
    x, normals = spot.points(np.array([[-p, -q], [p, -q], [p, q]]) / 2)
    return leaning(x, normals) / math.sqrt(abs(first * second) * p * q)


def hexagon(spot: Spot, size: float) -> float:
    """Return the angle between the middle and the corners of a hexagon, scaled."""
    (first, _), _ = spot.principal
    turns = np.arange(6) * math.pi / 3
    corners = size / abs(first) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    normals = spot.points(np.concatenate([np.zeros((1, 2)), corners]))[1]
    area = 1.5 * math.sqrt(3.0) * (size / first) ** 2
    return radians(normals[1:], normals[0]).max() / (abs(first) * math.sqrt(area))


def chord(spot: Spot, size: float) -> float:
    """Return how far the middle of a triangle, equilateral in |II|, is from the surface, scaled."""
    curvatures, _ = spot.principal
    turns = np.arange(3) * 2 * math.pi / 3 + 0.3
    scale = np.sqrt(np.abs(curvatures[0] / curvatures)) * size / abs(curvatures[0])
    corners = np.stack([np.cos(turns), np.sin(turns)], axis=1) * scale
    x, normals = spot.points(np.concatenate([np.zeros((1, 2)), corners]))
    area = 2 * 0.75 * math.sqrt(3.0) * scale.prod()
    away = abs((x[1:].mean(axis=0) - x[0]) @ normals[0])
    return away / (math.sqrt(abs(curvatures.prod())) * area)


def radians(left: Array, right: Array) -> Array:
    """Return angles between unit vectors."""
    return np.radians(angles(left, right))


def leaning(corners: Array, normals: Array) -> float:
    """Return the largest angle between a triangle and the normals at its corners."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal /= np.linalg.norm(normal)
    return float(radians(normals, normal * np.sign(normal @ normals[0])).max())


CELLS: tuple[tuple[str, float, Callable[[Spot, float], float], bool], ...] = (
    ("hexagon", HEXAGON, hexagon, True),
    ("rectangle", ALIGNED, rectangle, False),
    ("its triangles", ALIGNED, diagonal, False),
    (r"distance, in \|II\|", CHORD, chord, False),
)
SPOTS = (
    ("torus", TrueSurface("torus"), (0.1, 0.07)),
    ("ellipsoid_patch", TrueSurface("ellipsoid_patch"), (0.13, 0.7)),
    ("cylinder", TrueSurface("cylinder"), (0.3, 0.4)),
)


def cells_table() -> str:
    """Return the constants as they are found on surfaces."""
    header = ["cell", "constant", "surface", *(f"h = {x:g}" for x in SIZES)]
    rows = []
    for title, constant, found, developable in CELLS:
        for name, true, at in SPOTS:
            if developable or not true.developable:
                values = [found(Spot(true, np.array(at)), size) for size in SIZES]
                rows.append([title, f"{constant:.4f}", name, *(f"{x:.4f}" for x in values)])
    return markdown(
        [x.replace("|", r"\|") for x in header],
        ([x.replace("|", r"\|") for x in row] for row in rows),
    )


# --- the lantern ----------------------------------------------------------------------------------


def lantern(rings: int) -> tuple[float, float]:
    """Return the angles between normals at corners and between triangle and surface, in degrees."""
    turns = np.array([0.0, 2.0, 1.0]) * math.pi / SIDES
    normals = np.stack([np.cos(turns), np.sin(turns), np.zeros(3)], axis=1)
    corners = normals + np.array([0.0, 0.0, 1.0]) * (np.arange(3) == 2)[:, None] / rings
    between = angles(normals, normals[0]).max()
    return float(between), math.degrees(leaning(corners, normals))


def lantern_table() -> str:
    """Return the table of the lantern."""
    found = [lantern(x) for x in RINGS]
    rows = [
        ["between normals of corners", *(f"{x:.1f}°" for x, _ in found)],
        ["between triangle and surface", *(f"{x:.1f}°" for _, x in found)],
    ]
    return markdown(["rings", *(f"{x:,}" for x in RINGS)], rows)


def leanings(safe: bool) -> Callable[[float], Array]:
    """Return f(κ₁/κ₂) → the largest angle over R for each turn of a triangle of a metric."""
    along = sp.sqrt(cells.kappa1 * cells.kappa2) if safe else cells.kappa2
    corners = cells.turned_triangle(cells.kappa1, along)
    lean = cells.gradient(corners)
    off = [
        sp.sqrt((lean[0] - cells.kappa1 * x) ** 2 + (lean[1] - cells.kappa2 * y) ** 2)
        for x, y in corners
    ]
    evaluate = sp.lambdify((cells.kappa1, cells.kappa2, cells.radius, cells.theta), off, "numpy")
    turns = np.arange(TURNS) / TURNS * 2 * math.pi  # cos 3θ is 0 and 1 at some of them
    return lambda stretch: np.max(evaluate(1.0, 1.0 / stretch, 1.0, turns), axis=0)


def stretched_table() -> str:
    """Return how triangles of both metrics lean."""
    alone, safe = leanings(safe=False), leanings(safe=True)
    rows = [
        ["III, best θ", *(f"{alone(x).min():.2f}" for x in STRETCHES)],
        ["III, worst θ", *(f"{alone(x).max():.2f}" for x in STRETCHES)],
        [r"κ₁ \|II\|, worst θ", *(f"{safe(x).max():.2f}" for x in STRETCHES)],
    ]
    return markdown(["κ₁/κ₂", *map(str, STRETCHES)], rows)
