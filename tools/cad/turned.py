"""Surfaces of revolution: a straight line or a NURBS curve that is turned about the z axis."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...runtime.base import compiling  # noqa: F401 - announces compilation on terminals
from ...runtime.domain.domain import Domain, Interval
from ...runtime.surface.derivatives import Differentiable
from ...runtime.surface.nurbs import Nurbs
from ..kernels import faces as kernels

__all__ = ["Line", "Profile", "ProfileCurve", "Turned"]

Array = NDArray[np.float64]


class Profile(Protocol):
    """A curve c(v)."""

    @property
    def kinks(self) -> tuple[float, ...]:
        """The values of v where it is not smooth."""
        ...

    def jets(self, v: Array) -> Array:
        """Return its points and its first and second derivatives (k, 3, 3)."""
        ...

    def restricted(self, interval: Interval) -> Profile:
        """Return a part of it."""
        ...


@dataclass(frozen=True)
class Line:
    """The straight line start + v along."""

    start: tuple[float, float, float]
    along: tuple[float, float, float]
    kinks: tuple[float, ...] = ()

    def jets(self, v: Array) -> Array:
        """Return its points and its first and second derivatives (k, 3, 3)."""
        jets = np.zeros((len(v), 3, 3))
        for axis in range(3):
            jets[:, 0, axis] = self.start[axis] + self.along[axis] * v
            jets[:, 1, axis] = self.along[axis]
        return jets

    def restricted(self, interval: Interval) -> Line:
        """Return the line itself."""
        return self


@dataclass(frozen=True, eq=False)
class ProfileCurve:
    """A NURBS curve: the line v = 0 of a surface whose u is the parameter of the curve."""

    surface: Nurbs

    @property
    def kinks(self) -> tuple[float, ...]:
        """The parameters where it is not smooth."""
        return self.surface.creases[0]

    def jets(self, v: Array) -> Array:
        """Return its points and its first and second derivatives (k, 3, 3)."""
        return self.surface.jets(v, np.zeros(len(v)))[:, [0, 1, 3]]

    def restricted(self, interval: Interval) -> ProfileCurve:
        """Return a part of it."""
        return ProfileCurve(self.surface.restricted((interval, self.surface.domain[1])))


@dataclass(frozen=True, eq=False)
class Turned(Differentiable):
    """The surface x(u,v) of a curve c(v) that is turned about the z axis by the angle u."""

    profile: Profile

    def __call__(self, u: Array, v: Array) -> Array:
        """Return the points (..., 3)."""
        return self.jets(u.ravel(), v.ravel())[:, 0].reshape(*u.shape, 3)

    def jets(self, u: Array, v: Array) -> Array:
        """Return positions and derivatives (k, 6, 3)."""
        jets = np.empty((len(u), 6, 3))
        kernels.revolve(np.ascontiguousarray(u), self.profile.jets(v), jets)
        return jets

    @property
    def creases(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """No values of u, and the values of v where the curve is not smooth."""
        return (), self.profile.kinks

    def restricted(self, domain: Domain) -> Turned:
        """Return a part of the surface, evaluated from inside where the curve is not smooth."""
        return replace(self, profile=self.profile.restricted(domain[1]))
