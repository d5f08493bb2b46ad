"""The surfaces of docs/quality.md beyond those of `bench-peers`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import gaussmap as gm
import numpy as np

from ..peers.forms import FORMS, Array, ClosedForm, Torus, stacked
from ..peers.untuned import UNTUNED, Boss


@dataclass(frozen=True)
class SmallFillets(Boss):
    """The boss with fillets of 0.3 times their radius, and a higher wall."""

    fillet: float = 0.09
    wall: float = 0.56
    edge: float = 0.06
    name = "boss0.3"
    label = "The same boss with small fillets, of 0.09 and 0.06"


@dataclass(frozen=True)
class ShearedTorus(Torus):
    """The torus over sheared parameters, x(u + shear v, v): v-lines are not lines of curvature.

    If the shear is not an integer, v-lines do not close, and the torus is cut open at v = ±π.
    """

    shear: float = 1.0

    @property
    def name(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The name with the shear."""
        return f"sheared{self.shear:g}"

    @property
    def label(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The title of its section."""
        return f"The torus over parameters sheared by {self.shear:g}: x(u + {self.shear:g} v, v)"

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        closed = float(self.shear).is_integer()
        domain = ((-math.pi, math.pi), (-math.pi, math.pi))
        return gm.Surface.from_callable(
            lambda u, v: self.evaluate(u, v)[0], domain, (True, closed), name=self.name
        )

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        return super().evaluate(u + self.shear * v, v)

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        u, v = super().parameters(points)
        return u - self.shear * v, v

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v."""
        u, v = super().preimages(normals)
        return u - self.shear * v, v


@dataclass(frozen=True)
class BentPipe(ClosedForm):
    """A pipe round the planar curve y = swing sin(turns x): u goes round it, v along."""

    radius: float = 0.2
    swing: float = 0.35
    turns: float = 2.0
    end: float = 1.2
    name = "bent_pipe"
    label = "A pipe of radius 0.2 round the curve y = 0.35 sin 2x, −1.2 ≤ x ≤ 1.2"
    aspect = 0.6

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        domain = ((-math.pi, math.pi), (-self.end, self.end))
        return gm.Surface.from_callable(
            lambda u, v: self.evaluate(u, v)[0], domain, (True, False), name=self.name
        )

    def spine(self, v: Array) -> tuple[Array, Array, Array]:
        """Return y, y' and y'' of the curve."""
        a, w = self.swing, self.turns
        return a * np.sin(w * v), a * w * np.cos(w * v), -a * w * w * np.sin(w * v)

    def bent(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return |c'| and 1 − radius κ cos u, for the curve c and its curvature κ.

        Their product with the radius is the area element.
        """
        _, slope, second = self.spine(v)
        speed = np.sqrt(1.0 + slope * slope)
        return speed, 1.0 - self.radius * second / speed**3 * np.cos(u)

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        y, slope, _ = self.spine(v)
        speed = np.sqrt(1.0 + slope * slope)
        c, s = np.cos(u), np.sin(u)
        n_x, n_y, n_z = -slope / speed * c, c / speed, s + 0.0 * v
        points = stacked(v + self.radius * n_x, y + self.radius * n_y, self.radius * n_z)
        return points, stacked(n_x, n_y, n_z)

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K: the curvature 1/radius round the pipe, times the curvature along it."""
        _, near = self.bent(u, v)
        return (near - 1.0) / (self.radius**2 * near)

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        speed, near = self.bent(u, v)
        return self.radius * speed * near

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v: the nearest of some places on the curve, then Newton's method."""
        x, y, z = np.moveaxis(points, -1, 0)
        v, best = np.zeros_like(x), np.full_like(x, np.inf)
        for place in np.linspace(-self.end, self.end, 49):
            away = (x - place) ** 2 + (y - self.spine(place)[0]) ** 2
            v, best = np.where(away < best, place, v), np.minimum(away, best)
        for _ in range(8):
            height, slope, second = self.spine(v)
            off = height - y
            v = v - (v - x + off * slope) / (1.0 + slope * slope + off * second)
        height, slope, _ = self.spine(v)
        across = ((y - height) - slope * (x - v)) / np.sqrt(1.0 + slope * slope)
        return np.arctan2(z, across), v

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Return u and v: the slope of the curve is −n_x/n_y where it is perpendicular to n."""
        x, y, _ = normals.T
        reached = (np.abs(x) <= self.swing * self.turns * np.abs(y)) & (y != 0.0)
        n_x, n_y, n_z = normals[reached].T
        angle, u_v = np.arccos(-n_x / n_y / (self.swing * self.turns)), []
        for sign in (1.0, -1.0):
            for turn in range(-2, 3):
                v = (sign * angle + 2.0 * math.pi * turn) / self.turns
                slope = self.spine(v)[1]
                across = (n_y - slope * n_x) / np.sqrt(1.0 + slope * slope)
                inside = np.abs(v) <= self.end
                u_v.append(np.stack([np.arctan2(n_z, across), v])[:, inside])
        u, v = np.concatenate(u_v, axis=1)
        return u, v


@dataclass(frozen=True)
class Hills(ClosedForm):
    """A graph of three Gaussian ridges in three directions: no parameter line follows a ridge."""

    # height, x and y of the top, direction in radians, widths along and across
    ridges: tuple[tuple[float, ...], ...] = (
        (0.35, -0.35, 0.3, 0.6, 0.6, 0.16),
        (0.25, 0.4, -0.35, -0.9, 0.5, 0.2),
        (-0.2, 0.45, 0.5, 0.3, 0.3, 0.22),
    )
    name = "hills"
    label = "A graph of three Gaussian ridges in three directions over [−1, 1]²"
    aspect = 1.0

    @property
    def surface(self) -> gm.Surface:
        """The same surface for gaussmap."""
        return gm.Surface.from_callable(
            lambda u, v: stacked(u, v, sum((x[0] for x in self.parts(u, v)), 0.0 * u)),
            ((-1.0, 1.0), (-1.0, 1.0)),
            name=self.name,
        )

    def parts(
        self, u: Array, v: Array
    ) -> Iterator[tuple[Array, Array, Array, float, float, float]]:
        """Yield z of each ridge, the gradient g of its exponent, and the derivatives of g."""
        for height, x, y, direction, along, across in self.ridges:
            c, s = math.cos(direction), math.sin(direction)
            p, q = 1.0 / along**2, 1.0 / across**2
            a, b, d = p * c * c + q * s * s, (p - q) * c * s, p * s * s + q * c * c
            dx, dy = u - x, v - y
            g_x, g_y = a * dx + b * dy, b * dx + d * dy
            yield height * np.exp(-0.5 * (g_x * dx + g_y * dy)), g_x, g_y, a, b, d

    def jets(self, u: Array, v: Array) -> Array:
        """Return z, z_x, z_y, z_xx, z_xy and z_yy."""
        total = np.zeros((6, *np.broadcast_shapes(u.shape, v.shape)))
        for z, g_x, g_y, a, b, d in self.parts(*np.broadcast_arrays(u, v)):
            second = g_x * g_x - a, g_x * g_y - b, g_y * g_y - d
            total += z * np.stack([np.ones_like(z), -g_x, -g_y, *second])
        return total

    def evaluate(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return points and unit normals."""
        z, z_x, z_y, *_ = self.jets(u, v)
        r = 1.0 / np.sqrt(1.0 + z_x * z_x + z_y * z_y)
        return stacked(u, v, z), stacked(-z_x * r, -z_y * r, r)

    def curvature(self, u: Array, v: Array) -> Array:
        """Return K."""
        _, z_x, z_y, z_xx, z_xy, z_yy = self.jets(u, v)
        return (z_xx * z_yy - z_xy * z_xy) / (1.0 + z_x * z_x + z_y * z_y) ** 2

    def area(self, u: Array, v: Array) -> Array:
        """Return the area element."""
        _, z_x, z_y, *_ = self.jets(u, v)
        return np.sqrt(1.0 + z_x * z_x + z_y * z_y)

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Return u and v."""
        return points[..., 0], points[..., 1]

    def preimages(self, normals: Array) -> tuple[Array, Array]:
        """Raise NotImplementedError."""
        raise NotImplementedError("its inverse Gauss map has no closed form")


JUDGED: tuple[ClosedForm, ...] = (
    *FORMS, *UNTUNED, SmallFillets(), ShearedTorus(shear=0.25), ShearedTorus(), BentPipe(), Hills(),
)  # fmt: skip
