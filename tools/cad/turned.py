"""Surfaces of revolution: a NURBS curve that is turned about the z axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.base import compiling  # noqa: F401 - announces compilation on terminals
from ...runtime.domain.domain import Domain
from ...runtime.surface.derivatives import Differentiable
from ...runtime.surface.nurbs import Nurbs
from ..kernels import faces as kernels

__all__ = ["Turned"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Turned(Differentiable):
    """The surface x(u,v) of a curve that is turned about the z axis by the angle u.

    The curve is the line v = 0 of a NURBS, whose u is v here.
    """

    curve: Nurbs

    def __post_init__(self) -> None:
        object.__setattr__(self, "creases", ((), self.curve.creases[0]))

    def __call__(self, u: Array, v: Array) -> Array:
        """Return the points (..., 3)."""
        return self.jets(u.ravel(), v.ravel())[:, 0].reshape(*u.shape, 3)

    def jets(self, u: Array, v: Array) -> Array:
        """Return positions and derivatives (k, 6, 3)."""
        jets, along = np.empty((len(u), 6, 3)), self.curve.jets(v, np.zeros(len(v)))[:, [0, 1, 3]]
        kernels.revolve(np.ascontiguousarray(u), along, jets)
        return jets

    def restricted(self, domain: Domain) -> Turned:
        """Return a part of the surface, evaluated from inside where the curve is not smooth."""
        return Turned(self.curve.restricted((domain[1], self.curve.domain[1])))
