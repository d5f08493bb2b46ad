"""Two more surfaces: a monkey saddle, and a boss with fillets as in CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass

import gaussmap as gm
import numpy as np

from .forms import Array, ClosedForm, stacked


@dataclass(frozen=True)
class MonkeySaddle(ClosedForm):
    """The graph z = scale Re w³ over w = u + iv: K < 0, except at a flat point in the middle."""

    scale: float = 0.5
    name = "monkey_saddle"
    label = "The monkey saddle z = 0.5 (x³ − 3xy²) over [−1, 1]²"
    aspect = 1.0

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        return gm.surfaces.monkey_saddle(scale=self.scale)

    def slopes(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return z_x and z_y."""
        return 3.0 * self.scale * (u * u - v * v), -6.0 * self.scale * u * v

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        z_x, z_y = self.slopes(u, v)
        r = 1.0 / np.sqrt(1.0 + z_x * z_x + z_y * z_y)
        z = self.scale * (u * u - 3.0 * v * v) * u
        return stacked(u, v, z), stacked(-z_x * r, -z_y * r, r)

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K."""
        z_x, z_y = self.slopes(u, v)
        return -((6.0 * self.scale) ** 2) * (u * u + v * v) / (1.0 + z_x * z_x + z_y * z_y) ** 2

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        z_x, z_y = self.slopes(u, v)
        return np.sqrt(1.0 + z_x * z_x + z_y * z_y)

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        return points[..., 0], points[..., 1]

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v: w² is the conjugate of the gradient, divided by 3 scale."""
        n_x, n_y, n_z = normals[normals[:, 2] > 0.0].T
        w = np.sqrt((-n_x + 1j * n_y) / n_z / (3.0 * self.scale))
        w = np.concatenate([w, -w])
        w = w[np.maximum(np.abs(w.real), np.abs(w.imag)) <= 1.0]
        return np.real(w), np.imag(w)


@dataclass(frozen=True)
class Boss(ClosedForm):
    """A round boss with a hole on a plate, as CAD has them: half of the area has K = 0.

    Its meridian, by arc length from the plate inwards: the plate, a concave fillet, a cylinder, a
    rounded edge and the flat top. Curvature jumps where they meet.
    """

    plate: float = 1.2  # the outer radius
    foot: float = 1.0  # the radius at which the concave fillet begins
    fillet: float = 0.3
    wall: float = 0.35  # how high the cylinder is
    edge: float = 0.2  # the radius of the rounded edge
    hole: float = 0.2
    name = "boss"
    label = "A boss on a plate: planes, a cylinder, a concave and a convex fillet"
    aspect = 3.0

    @property
    def top(self) -> float:
        """The radius at which the flat top begins."""
        return self.foot - self.fillet - self.edge

    @property
    def joints(self) -> tuple[float, ...]:
        """The arc lengths at which the five parts of the meridian end."""
        quarter = math.pi / 2.0
        lengths = (
            self.plate - self.foot, self.fillet * quarter, self.wall,
            self.edge * quarter, self.top - self.hole,
        )  # fmt: skip
        return tuple(np.cumsum(lengths).tolist())

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        domain = ((-math.pi, math.pi), (0.0, self.joints[-1]))
        return gm.Surface.from_callable(
            lambda u, v: self.evaluate(u, v)[0], domain, (True, False), name=self.name
        )

    def meridian(self, v: Array) -> tuple[Array, Array, Array]:
        """Return radius and height, and the angle between normal and axis."""
        a, b, c, d, _ = self.joints
        parts = [v < a, v < b, v < c, v < d]
        angle = np.select(
            parts, [0.0 * v, (v - a) / self.fillet, 0.0 * v + math.pi / 2.0, (d - v) / self.edge]
        )
        s, t = np.sin(angle), np.cos(angle)
        radius = np.select(
            parts,
            [self.plate - v, self.foot - self.fillet * s, 0.0 * v + self.foot - self.fillet,
             self.top + self.edge * s],
            self.top - (v - d),
        )  # fmt: skip
        wall_end = self.fillet + self.wall
        height = np.select(
            parts,
            [0.0 * v, self.fillet * (1.0 - t), self.fillet + (v - b), wall_end + self.edge * t],
            wall_end + self.edge,
        )
        return radius, height, angle

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        radius, height, angle = self.meridian(v)
        cos_u, sin_u, s = np.cos(u), np.sin(u), np.sin(angle)
        points = stacked(radius * cos_u, radius * sin_u, height)
        return points, stacked(s * cos_u, s * sin_u, np.cos(angle))

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K."""
        a, b, c, d, _ = self.joints
        radius, _, angle = self.meridian(v)
        along = np.select(
            [v < a, v < b, v < c, v < d], [0.0, -1.0 / self.fillet, 0.0, 1.0 / self.edge]
        )
        return along * np.sin(angle) / radius + 0.0 * u

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        return self.meridian(v)[0] + 0.0 * u

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        x, y, z = np.moveaxis(points, -1, 0)
        r = np.hypot(x, y)
        a, b, _, d, _ = self.joints
        wall_end = self.fillet + self.wall
        low = z < self.fillet
        v = np.select(
            [low & (r >= self.foot), low, z < wall_end, r > self.top],
            [
                self.plate - r,
                a + self.fillet * np.arctan2(self.foot - r, self.fillet - z),
                b + z - self.fillet,
                d - self.edge * np.arctan2(r - self.top, z - wall_end),
            ],
            d + self.top - r,
        )
        return np.arctan2(y, x), v

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v: one on each fillet."""
        x, y, z = normals[normals[:, 2] > 0.0].T
        u, angle = np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)
        a, _, _, d, _ = self.joints
        return np.tile(u, 2), np.concatenate([a + self.fillet * angle, d - self.edge * angle])


UNTUNED: tuple[ClosedForm, ...] = (MonkeySaddle(), Boss())
