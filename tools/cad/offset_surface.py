"""Offset surfaces: points at a distance from another surface, the basis, along its normals.

Points and first derivatives follow from the 2-jet of the basis. Second derivatives also need its
third derivatives: finite differences of its second derivatives at nine points in one knot span.
The error of the second derivatives, relative to the largest one, is about 1e-12, or 1e-10 where the
reader has interpolated a circle or another curve that is not a NURBS.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ...generated.differences import FIRST
from ...runtime.domain.domain import Domain
from ...runtime.surface.derivatives import Differentiable, nodes_between, shifts_inside, weighted
from ...runtime.surface.moved import Moved
from ...runtime.surface.nurbs import Nurbs
from ...runtime.tape.kernels.points import Tape
from .kernels import faces as kernels
from .turned_tape import turned_tape

Array = NDArray[np.float64]

# A step of the finite differences is the largest power of two up to this fraction of a knot span.
STEP = 1 / 128
NODES = np.arange(9)[:, None] - 4
# Where the basis has no normal, at a pole or an apex, the normal is taken at this distance,
# relative to the domain.
BESIDE = 1e-7


@dataclass(frozen=True, eq=False)
class Turned(Differentiable):
    """The surface x(u,v) of a curve rotated about the z axis by the angle u.

    The curve is the line v = 0 of a NURBS; u of the NURBS is v of the surface.
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

    def tape(self) -> Tape | None:
        """Return the tape: the operations of the curve, then those of the rotation."""
        return turned_tape(self.curve)

    def restricted(self, domain: Domain) -> Turned:
        """Return the surface over a subdomain; derivatives at its sides are those from inside."""
        return Turned(self.curve.restricted((domain[1], self.curve.domain[1])))


@dataclass(frozen=True, eq=False)
class OffsetSurface(Differentiable):
    """The points x + distance n of a surface x(u,v) with unit normals n along x_u × x_v."""

    basis: Differentiable
    distance: float
    domain: Domain

    def __post_init__(self) -> None:
        object.__setattr__(self, "creases", self.basis.creases)

    def __call__(self, u: Array, v: Array) -> Array:
        """Return the points (..., 3)."""
        places = u.ravel(), v.ravel()
        points = self._points(*places)
        lost = ~np.isfinite(points).all(axis=1)
        if lost.any():
            points[lost] = self._beside(*(x[lost] for x in places))
        return points.reshape(*u.shape, 3)

    def jets(self, u: Array, v: Array) -> Array:
        """Return positions and derivatives (k, 6, 3); NaN where the basis is singular."""
        jets = self.basis.jets(u, v)
        along_u, along_v = self._differences(0, u, v), self._differences(1, u, v)
        thirds = np.concatenate([along_u, along_v[:, 2:]], axis=1)
        return self._at_distance(jets, thirds)

    def restricted(self, domain: Domain) -> OffsetSurface:
        """Return the surface over a subdomain; derivatives at its sides are those from inside."""
        return replace(self, basis=self.basis.restricted(domain), domain=domain)

    def _at_distance(self, jets: Array, thirds: Array) -> Array:
        """Return 2-jets (k, 6, 3) of the offset, from those of the basis and its third derivatives.

        `thirds` (k, 4, 3) are x_uuu, x_uuv, x_uvv, x_vvv of the basis.
        """
        out = np.empty_like(jets)
        kernels.offset(self.distance, jets, thirds, out)
        return out

    def _points(self, u: Array, v: Array) -> Array:
        """Return points (k, 3) of the offset; NaN where the basis is singular."""
        return self._at_distance(self.basis.jets(u, v), np.zeros((len(u), 4, 3)))[:, 0]

    def _differences(self, axis: int, u: Array, v: Array) -> Array:
        """Return the derivatives (k, 3, 3) of x_uu, x_uv, x_vv by u (axis 0) or v (axis 1)."""
        values = (u, v)[axis]
        low, high = self._span(axis, values)
        step = np.exp2(np.floor(np.log2((high - low) * STEP)))
        shifts, _ = shifts_inside(values, step, low, high)
        nodes = nodes_between(values, NODES + shifts, step, low, high)
        others = np.broadcast_to((v, u)[axis], nodes.shape)
        places = (nodes, others) if axis == 0 else (others, nodes)
        seconds = self.basis.jets(*(x.ravel() for x in places)).reshape(9, -1, 6, 3)[:, :, 3:]
        seconds = seconds - seconds[4]
        by = [weighted(FIRST, shifts, seconds[:, :, k]) for k in range(3)]
        return np.stack(by, axis=1) / step[:, None, None]

    def _span(self, axis: int, values: Array) -> tuple[Array, Array]:
        """Return the lower and the upper end (k,) of the knot span that contains each parameter.

        Spans are cut at the ends of the domain.
        """
        (first, last), knots = self.domain[axis], _knots_of(self.basis, axis)
        inner = np.unique(knots[(knots > first) & (knots < last)])
        lines = np.concatenate([[first], inner, [last]])
        place = np.clip(np.searchsorted(lines, values, "right") - 1, 0, len(lines) - 2)
        return lines[place], lines[place + 1]

    def _beside(self, u: Array, v: Array) -> Array:
        """Return points (k, 3) of the offset where the basis has no normal, by a normal nearby."""
        (u0, u1), (v0, v1) = self.domain
        u_in, v_in = u + BESIDE * ((u0 + u1) / 2 - u), v + BESIDE * ((v0 + v1) / 2 - v)
        moved = self._points(u_in, v_in) - self.basis.jets(u_in, v_in)[:, 0]
        return self.basis.jets(u, v)[:, 0] + moved


def _knots_of(function: Differentiable, axis: int) -> Array:
    """Return the knots of a function in u (axis 0) or v (axis 1), before a face reverses u."""
    if isinstance(function, Moved):
        function = cast(Differentiable, function.surface.function)
    if isinstance(function, Nurbs):
        return function.knots[axis]
    if isinstance(function, Turned) and axis == 1:
        return function.curve.knots[0]
    return _knots_of(function.basis, axis) if isinstance(function, OffsetSurface) else np.empty(0)
