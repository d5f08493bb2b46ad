"""The three surfaces in NumPy, as users who know their formulas would write them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import gaussmap as gm
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]


class ClosedForm(ABC):
    """A surface of the catalogue, with closed forms of all quantities that samplers use.

    Parameters broadcast together, so that a grid costs its trigonometry only along its sides.
    """

    name: str
    label: str
    aspect: float  # the ratio of the numbers of values of u and of v for cells of good shape

    @property
    @abstractmethod
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""

    @abstractmethod
    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals, each (..., 3)."""

    @abstractmethod
    def curvature(self, u: Array, v: Array) -> Array:
        """Return the Gaussian curvature K."""

    @abstractmethod
    def area(self, u: Array, v: Array) -> Array:
        """Return the area element |x_u × x_v|."""

    @abstractmethod
    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v of points (..., 3) on, or near, the surface."""

    @abstractmethod
    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v (...,) of all points that have one of the unit normals (N, 3)."""

    def bending(self, u: Array, v: Array) -> Array:
        """Return |K| |x_u × x_v|, the density of the paper's samples over the parameters."""
        return np.abs(self.curvature(u, v)) * self.area(u, v)

    def lattice(self, count: int) -> tuple[Array, Array]:
        """Return u (m, 1) and v (1, n) of a lattice of about `count` different points."""
        m, n = (max(2, round(math.sqrt(count * x))) for x in (self.aspect, 1.0 / self.aspect))
        lines = [
            np.linspace(low, high, count, endpoint=ends[0] == "open")
            for (low, high), ends, count in zip(
                self.surface.domain, self.surface.boundary, (m, n), strict=True
            )
        ]
        return lines[0][:, None], lines[1][None, :]


@dataclass(frozen=True)
class Torus(ClosedForm):
    """The torus."""

    major: float = 1.0
    minor: float = 0.35
    name = "torus"
    label = "The torus (1, 0.35)"
    aspect = 1.0

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        return gm.surfaces.torus(major=self.major, minor=self.minor)

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        cos_u, sin_u, cos_v, sin_v = np.cos(u), np.sin(u), np.cos(v), np.sin(v)
        ring = self.major + self.minor * cos_v
        points = stacked(ring * cos_u, ring * sin_u, self.minor * sin_v)
        return points, stacked(cos_u * cos_v, sin_u * cos_v, sin_v)

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K."""
        cos_v = np.cos(v)
        return cos_v / (self.minor * (self.major + self.minor * cos_v))

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        return self.minor * (self.major + self.minor * np.cos(v))

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        x, y, z = np.moveaxis(points, -1, 0)
        return np.arctan2(y, x), np.arctan2(z, np.hypot(x, y) - self.major)

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v: one on the outer half, one across the hole on the inner half."""
        x, y, z = normals.T
        u, v = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))
        return np.concatenate([u, u + math.pi]), np.concatenate([v, math.pi - v])


@dataclass(frozen=True)
class Ellipsoid(ClosedForm):
    """The belt of an ellipsoid between the latitudes ±π/3, round its longest axis."""

    a: float = 0.6
    b: float = 0.3
    c: float = 1.0
    name = "ellipsoid_patch"
    label = "The ellipsoid x²/0.36 + y²/0.09 + z² = 1 between the latitudes ±60°"
    aspect = 2.0

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        return gm.surfaces.ellipsoid_patch(a=self.a, b=self.b, c=self.c)

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        cos_v = np.cos(v)
        x, y, z = np.cos(u) * cos_v, np.sin(u) * cos_v, np.sin(v)
        g_x, g_y, g_z = x / self.a, y / self.b, z / self.c
        r = 1.0 / np.sqrt(g_x * g_x + g_y * g_y + g_z * g_z)
        return stacked(self.a * x, self.b * y, self.c * z), stacked(g_x * r, g_y * r, g_z * r)

    def gradient(self, u: Array, v: Array) -> Array:
        """Return the length of (x/a², y/b², z/c²)."""
        along = (np.cos(u) / self.a) ** 2 + (np.sin(u) / self.b) ** 2
        return np.sqrt(along * np.cos(v) ** 2 + (np.sin(v) / self.c) ** 2)

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K."""
        return 1.0 / (self.a * self.b * self.c * self.gradient(u, v) ** 2) ** 2

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        return self.a * self.b * self.c * np.cos(v) * self.gradient(u, v)

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        x, y, z = np.moveaxis(points / [self.a, self.b, self.c], -1, 0)
        return np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v of the normals that belong to the belt, one for each."""
        x, y, z = (normals * [self.a, self.b, self.c]).T
        u, v = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))
        inside = np.abs(v) <= self.surface.domain[1][1]
        return u[inside], v[inside]


@dataclass(frozen=True)
class Waves(ClosedForm):
    """The graph z = amplitude sin(frequency x) cos(frequency y)."""

    amplitude: float = 0.2
    frequency: float = 3.0
    name = "wavy_graph"
    label = "The graph z = 0.2 sin 3x cos 3y over [−1, 1]²"
    aspect = 1.0

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        return gm.surfaces.wavy_graph(amplitude=self.amplitude, frequency=self.frequency)

    def slopes(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return z, z_x and z_y."""
        a, f = self.amplitude, self.frequency
        sin_u, cos_v = np.sin(f * u), np.cos(f * v)
        return a * sin_u * cos_v, a * f * np.cos(f * u) * cos_v, -a * f * sin_u * np.sin(f * v)

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        z, z_x, z_y = self.slopes(u, v)
        r = 1.0 / np.sqrt(1.0 + z_x * z_x + z_y * z_y)
        return stacked(u, v, z), stacked(-z_x * r, -z_y * r, r)

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K."""
        z, z_x, z_y = self.slopes(u, v)
        a, f = self.amplitude, self.frequency
        z_xy = -a * f**2 * np.cos(f * u) * np.sin(f * v)
        return ((f**2 * z) ** 2 - z_xy**2) / (1.0 + z_x * z_x + z_y * z_y) ** 2

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        _, z_x, z_y = self.slopes(u, v)
        return np.sqrt(1.0 + z_x * z_x + z_y * z_y)

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        return points[..., 0], points[..., 1]

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v of all points with one of the unit normals.

        With α = frequency u and β = frequency v, a normal gives the products cos α cos β and
        sin α sin β, whose sum and difference are cos(α − β) and cos(α + β).
        """
        n_x, n_y, n_z = normals[normals[:, 2] > 0.0].T
        steepest = self.amplitude * self.frequency
        cosines, sines = -n_x / n_z / steepest, n_y / n_z / steepest
        exists = np.maximum(np.abs(cosines + sines), np.abs(cosines - sines)) <= 1.0
        cosines, sines = cosines[exists], sines[exists]
        turns = 2.0 * math.pi * np.arange(-2, 3)  # |α ± β| <= 2 frequency
        assert 2.0 * self.frequency < 5.0 * math.pi
        differences, sums = (
            np.concatenate([x + turns[:, None], turns[:, None] - x])
            for x in (np.arccos(cosines + sines), np.arccos(cosines - sines))
        )
        u = (differences[:, None] + sums).ravel() / (2.0 * self.frequency)
        v = (sums - differences[:, None]).ravel() / (2.0 * self.frequency)
        inside = np.maximum(np.abs(u), np.abs(v)) <= 1.0
        return u[inside], v[inside]


FORMS: tuple[ClosedForm, ...] = (Torus(), Ellipsoid(), Waves())


def stacked(x: Array, y: Array, z: Array) -> Array:
    """Return vectors (..., 3) of components that broadcast together."""
    vectors = np.empty((*np.broadcast_shapes(x.shape, y.shape, z.shape), 3))
    vectors[..., 0], vectors[..., 1], vectors[..., 2] = x, y, z
    return vectors
