"""Charts at the poles of a surface, where its own parameters are singular.

At a pole the parameters are polar coordinates, an angle φ and a distance r. The surface is smooth
in s = r cos φ, t = r sin φ.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..base.scales import power_of_two
from ..spline.kernels.jets import evaluate_jets
from ..surface.derivatives import differences
from ..surface.surface import Surface
from .kernels.refine import chart_jets, jet_of_pole

# Samples of the spline are moved in the chart if they are within this number of cells of the pole.
# Within four cells the spline is inaccurate and may have folds; its samples are up to a cell away
# from those of the surface. With one cell, samples are lost; from three cells on, more cells change
# samples by rounding errors only.
POLE_CELLS = 6
# Closer to a pole than this share r of the domain, the 2-jet at the pole is used, with an error of
# order r. Derivatives by the angle would have cancellation errors of up to ε/r².
NEAR = 2.0**-20


@dataclass(frozen=True, eq=False)
class PoleChart:
    """The chart at one pole.

    `angle` is the index of the parameter (0 for u, 1 for v) that runs around the pole. The other
    parameter has the value `end` at the pole, and `other` at the opposite side of the domain.
    """

    surface: Surface
    angle: int
    end: float
    other: float
    cells: int  # along the other parameter

    @property
    def inward(self) -> float:
        """1 if the parameter that is constant at the pole increases away from the pole, else −1."""
        return math.copysign(1.0, self.other - self.end)

    @property
    def orientation(self) -> float:
        """The sign of x_u × x_v relative to x_s × x_t."""
        return -self.inward if self.angle == 0 else self.inward

    @property
    def cell(self) -> float:
        """The length of a cell in the parameter towards the pole."""
        return abs(self.other - self.end) / self.cells

    @property
    def turn(self) -> float:
        """The derivative of the angle φ by the parameter that runs around the pole."""
        low, high = self.surface.domain[self.angle]
        return 2.0 * math.pi / (high - low)

    def near(self, uv: Array) -> Flags:
        """Return a mask (k,) of the parameters (k, 2) within POLE_CELLS cells of the pole.

        At most half of the cells towards the opposite side belong to the pole.
        """
        cells = min(POLE_CELLS, self.cells // 2)
        return self._distances(uv) < cells * self.cell

    def next_to(self, uv: Array) -> Flags:
        """Return a mask (k,) of the parameters (k, 2) at which fields are evaluated by the chart.

        If derivatives are finite differences, which have large relative errors on small circles
        around the pole, these are the parameters selected by `near`; otherwise they are those
        closer to the pole than NEAR, relative to the domain.
        """
        if self.surface.differences is not None:
            return self.near(uv)
        return self._distances(uv) <= NEAR * abs(self.other - self.end)

    def places(self, uv: Array) -> Array:
        """Return the coordinates s and t (k, 2) of parameters (k, 2)."""
        phi = (uv[:, self.angle] - self.surface.domain[self.angle][0]) * self.turn
        r = self._distances(uv)
        return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)

    def parameters(self, places: Array) -> Array:
        """Return the parameters (k, 2) of coordinates s and t (k, 2), clipped to the domain."""
        low, high = self.surface.domain[self.angle]
        phi = np.arctan2(places[:, 1], places[:, 0])
        phi[phi < 0.0] += 2.0 * math.pi
        r = np.minimum(np.hypot(places[:, 0], places[:, 1]), abs(self.other - self.end))
        uv = np.empty((len(places), 2))
        uv[:, self.angle] = np.clip(low + phi / self.turn, low, high)
        uv[:, 1 - self.angle] = self.end + self.inward * r
        return uv

    def jets(self, s: Array, t: Array) -> Array:
        """Return the 2-jets (k, 6, 3) with respect to s and t."""
        if self.surface.differences is not None:
            step = power_of_two(self.surface.differences.step * abs(self.other - self.end))
            return differences(self._evaluate, s, t, (step, step))[0]
        uv = self.parameters(np.stack([s, t], axis=1))
        chart = np.empty((len(uv), 6, 3))
        phi = (uv[:, self.angle] - self.surface.domain[self.angle][0]) * self.turn
        chart_jets(
            self.surface.jets(uv[:, 0].copy(), uv[:, 1].copy()), phi, self._distances(uv),
            self.angle, self.turn, self.inward, NEAR * abs(self.other - self.end), self._at_pole,
            chart,
        )  # fmt: skip
        return chart

    def _evaluate(self, s: Array, t: Array) -> Array:
        """Return points (k, 3) at s and t."""
        assert self.surface.differences is not None
        u, v = self.parameters(np.stack([s, t], axis=1)).T.copy()
        return self.surface.differences.function(u, v)

    @cached_property
    def _at_pole(self) -> Array:
        """The 2-jet (1, 6, 3) at the pole, with respect to s and t."""
        low, high = self.surface.domain[self.angle]
        uv = np.full((2, 3), self.end)
        uv[self.angle] = low + (high - low) * np.array([0.0, 0.125, 0.25])
        pole = np.empty((1, 6, 3))
        jet_of_pole(self.surface.jets(uv[0], uv[1]), self.angle, self.inward, pole)
        return pole

    def _distances(self, uv: Array) -> Array:
        return np.abs(uv[:, 1 - self.angle] - self.end)


def pole_charts(surface: Surface, cells: tuple[int, int]) -> list[PoleChart]:
    """Return a chart for each pole of a surface; `cells` are those of its spline."""
    charts = []
    for axis in (0, 1):
        ends = surface.domain[axis]
        for k in (0, 1):
            if surface.boundary[axis][k] == "pole":
                charts.append(PoleChart(surface, 1 - axis, ends[k], ends[1 - k], cells[axis]))
    return charts


def near_poles(
    charts: list[PoleChart], scale: float, uv: Array
) -> Iterator[tuple[Indices, Array, Array, Array]]:
    """Yield the rows of `uv` at which each chart evaluates fields; charts without rows are omitted.

    A result has the indices (k,) of the rows, and unit normals (k, 3), K (k,) and H (k,) there.
    """
    for chart in charts:
        rows = np.flatnonzero(chart.next_to(uv))
        if len(rows):
            s, t = chart.places(uv[rows]).T.copy()
            n, K, H = np.empty((len(rows), 3)), np.empty(len(rows)), np.empty(len(rows))
            scales = np.array([scale, *[power_of_two(chart.cell)] * 2])
            evaluate_jets(chart.jets(s, t), scales, n, K, H)
            yield rows, n * chart.orientation, K, H * chart.orientation
