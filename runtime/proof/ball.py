"""Arrays of balls: enclosures given by midpoints and radii, including rounding errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array

# UNIT bounds the relative rounding error of a midpoint; WIDER is a factor for radii that covers the
# rounding errors of the few operations by which they are computed.
UNIT, WIDER = 2.0**-53, 1.0 + 2.0**-48
TINY = 1e-290  # above the error of an underflow


@dataclass(frozen=True, eq=False)
class Ball:
    """Enclosures [middle − radius, middle + radius]; operations return enclosures as well."""

    middle: Array
    radius: Array
    __array_ufunc__ = None  # arrays leave operations to balls

    @classmethod
    def of(cls, value: Ball | Array | float) -> Ball:
        """Return numbers as balls of radius 0, and balls unchanged."""
        if isinstance(value, Ball):
            return value
        return cls(np.asarray(value, np.float64), np.zeros_like(value, np.float64))

    @property
    def largest(self) -> Array:
        """The largest absolute value in each ball."""
        return np.abs(self.middle) + self.radius

    @property
    def least(self) -> Array:
        """The smallest absolute value in each ball."""
        return np.maximum(np.abs(self.middle) - self.radius, 0.0)

    def __neg__(self) -> Ball:
        return Ball(-self.middle, self.radius)

    def __add__(self, other: Ball | Array | float) -> Ball:
        y = Ball.of(other)
        middle = self.middle + y.middle
        return Ball(middle, (self.radius + y.radius + UNIT * np.abs(middle)) * WIDER)

    __radd__ = __add__

    def __sub__(self, other: Ball | Array | float) -> Ball:
        return self + -Ball.of(other)

    def __rsub__(self, other: Ball | Array | float) -> Ball:
        return -self + other

    def __mul__(self, other: Ball | Array | float) -> Ball:
        y = Ball.of(other)
        middle = self.middle * y.middle
        with np.errstate(invalid="ignore"):  # 0 times infinity: the radius becomes infinite
            radius = np.abs(self.middle) * y.radius + self.radius * y.largest
        radius = np.where(np.isnan(radius), np.inf, radius)
        return Ball(middle, (radius + UNIT * np.abs(middle)) * WIDER + TINY)

    __rmul__ = __mul__

    def __rtruediv__(self, other: Ball | Array | float) -> Ball:
        with np.errstate(divide="ignore", invalid="ignore"):
            middle = 1.0 / self.middle
            radius = self.radius / (np.abs(self.middle) * self.least)
            radius = (radius + UNIT * np.abs(middle)) * WIDER + TINY
        unknown = ~np.isfinite(radius)
        inverse = Ball(np.where(unknown, 0.0, middle), np.where(unknown, np.inf, radius))
        return inverse * other


def cross(a: Sequence[Ball], b: Sequence[Ball]) -> list[Ball]:
    """Return the components of the cross product of two vectors of balls."""
    return [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]
