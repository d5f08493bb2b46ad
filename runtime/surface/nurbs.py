"""A NURBS surface as an object that evaluates points and derivatives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..base.aliases import Array
from ..base.errors import InputError
from ..base.tolerances import SAME_PARAMETER
from ..domain.domain import Domain
from ..tape.kernels import nurbs as kernels
from ..tape.kernels.points import Tape
from .derivatives import Differentiable, Lines
from .nurbs_tape import nurbs_tape


@dataclass(frozen=True, eq=False, repr=False)
class Nurbs(Differentiable):
    """A NURBS surface over a rectangle of its parameters: `nurbs(u, v)` and `nurbs.jets(u, v)`.

    `points` are (m, n, 3), or (m, n, 4) with w x, w y, w z, w. They are relative to `centre` (3,),
    so that a surface far from the origin keeps its digits. On the boundary of the domain the
    surface is evaluated from inside, since it need not be smooth there. `creases` are the values of
    u, and of v, inside the domain across which the surface is not smooth.
    """

    degrees: tuple[int, int]
    knots: tuple[Array, Array]
    points: Array
    centre: Array
    domain: Domain
    periodic: tuple[bool, bool] = (False, False)
    creases: Lines = ((), ())

    def __repr__(self) -> str:
        m, n, _ = self.points.shape
        return f"Nurbs({m} × {n} control points of degrees {self.degrees})"

    def __call__(self, u: Array, v: Array) -> Array:
        """Return points (..., 3); InputError if u or v is outside the domain and not periodic."""
        for name, values, ends, periodic in zip(
            "uv", (u, v), self.domain, self.periodic, strict=True
        ):
            slack = SAME_PARAMETER * (ends[1] - ends[0])
            outside = (values < ends[0] - slack) | (values > ends[1] + slack)
            if not periodic and outside.any():
                raise InputError(f"{name} = {values[outside][0]} lies outside the domain {ends}.")
        points = np.empty((u.size, 3))
        places = np.array(u.ravel()), np.array(v.ravel())
        kernels.positions(self._net, *places, self._scratch(), points)
        return points.reshape(*u.shape, 3)

    def jets(self, u: Array, v: Array) -> Array:
        """Return x, x_u, x_v, x_uu, x_uv, x_vv (k, 6, 3) at u (k,) and v (k,).

        The parameters are not checked. Periodic parameters are reduced to their period; along other
        parameters, the polynomials of the first and the last knot span are continued.
        """
        jets = np.empty((len(u), 6, 3))
        u, v = np.array(u), np.array(v)  # Kernels would be compiled anew for other memory layouts
        kernels.jets(self._net, u, v, self._scratch(), jets)
        return jets

    def tape(self) -> Tape | None:
        """Return the tape of the surface; None for large degrees or nets."""
        return nurbs_tape(self._net)

    def restricted(self, domain: Domain) -> Nurbs:
        """Return the surface over a part of its domain.

        A periodic parameter stays periodic only if the part contains its whole interval.
        """
        whole = zip(self.periodic, domain, self.domain, strict=True)
        u, v = (periodic and part == ends for periodic, part, ends in whole)
        lines_u, lines_v = (
            tuple(x for x in lines if low < x < high)
            for lines, (low, high) in zip(self.creases, domain, strict=True)
        )
        return replace(self, domain=domain, periodic=(u, v), creases=(lines_u, lines_v))

    @property
    def control_points(self) -> Array:
        """The control points (m, n, 3)."""
        points, weights = self.points[:, :, :3], self.points[:, :, 3:]
        return self.centre + (points / weights if weights.size else points)

    @cached_property
    def _net(self) -> kernels.Net:
        spans = [
            # Kernels read the knots around a span without bounds checks.
            np.clip(
                (np.searchsorted(knots, low, "right"), np.searchsorted(knots, high, "left")),
                degree + 1,
                len(knots) - degree - 1,
            )
            - 1
            for knots, degree, (low, high) in zip(
                self.knots, self.degrees, self.domain, strict=True
            )
        ]
        periods = [
            (low, high - low if periodic else 0.0)
            for periodic, (low, high) in zip(self.periodic, self.domain, strict=True)
        ]
        return kernels.Net(
            np.array(self.degrees, dtype=np.int64),
            *self.knots,
            np.array(spans, dtype=np.int64),
            np.array(periods),
            self.points,
            self.centre,
        )

    def _scratch(self) -> kernels.Scratch:
        """Return memory for one call: threads share no memory."""
        p, q = self.degrees
        return kernels.Scratch(np.empty((3, p + 1)), np.empty((3, q + 1)), np.zeros((6, 4)))
