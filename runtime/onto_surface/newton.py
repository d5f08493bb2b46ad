"""Newton's method: from samples of a spline to the points of its surface with the same normals.

A point of the spline with the normal n is close to one of the surface. Starting from its
parameters, Newton's method solves n·x_u = n·x_v = 0 on the surface, except at parabolic and
singular points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Indices
from ..base.threads import over_ranges
from ..base.tolerances import NORMAL_ERROR, NORMAL_NOISE
from ..spline.kernels.jets import evaluate_jets
from ..spline.spline import Spline
from ..surface.surface import Surface
from .kernels.refine import (
    CLAMPED,
    FOUND,
    FREE,
    NOT_FOUND,
    PERIODIC,
    Box,
    Rows,
    Target,
    begin,
    newton,
)
from .pole_charts import PoleChart, near_poles, pole_charts

Jets = Callable[[Array, Array], Array]

ROWS_AT_A_TIME = 4096
# If at most this share of the rows of a batch is unsolved, these rows are left for a last batch,
# which has the unsolved rows of all batches.
FEW = 1 / 32
MOST_STEPS = 32


@dataclass(frozen=True, eq=False)
class Parameters:
    """A parametrization of a surface, by u and v or by the coordinates of a chart at a pole.

    `jets` returns the 2-jets of the surface by these parameters. `box` has the bounds of both
    parameters, and says whether a parameter is periodic, clamped to its bounds, or unbounded. The
    factor `size` scales the surface so that its cells have sides of about 1. Rounding errors of
    normals are up to `noise`.
    """

    jets: Jets
    box: Box
    size: float
    noise: float

    @classmethod
    def of_domain(cls, surface: Surface, spline: Spline) -> Parameters:
        """Return the parametrization by u and v."""
        (u0, u1), (v0, v1) = surface.domain
        along_u, along_v = (
            PERIODIC if ends[0] == "periodic" else CLAMPED for ends in spline.boundary
        )
        _, _, du, dv = spline.frame.tolist()
        box = Box((u0, u1, v0, v1), (along_u, along_v), (du, dv))
        return cls(surface.jets, box, spline.scale, max(NORMAL_NOISE, spline.noise))

    @classmethod
    def of_chart(cls, chart: PoleChart, spline: Spline) -> Parameters:
        """Return the parametrization by s and t, the unbounded coordinates of a chart at a pole."""
        largest = max(abs(chart.end), abs(chart.other))
        ends = (-largest, largest, -largest, largest)
        box = Box(ends, (FREE, FREE), (chart.cell, chart.cell))
        return cls(chart.jets, box, spline.scale, max(NORMAL_NOISE, spline.noise))

    def solve(self, target: Target, numbers: Indices, few: int) -> Indices:
        """Do Newton steps until at most `few` rows are unsolved; return the indices of these rows.

        `numbers` are the indices of the rows to solve; the steps start from target.uv. Rows that
        are unsolved after MOST_STEPS steps are given up, and not returned.
        """
        count, rows = len(numbers), Rows.new(numbers)
        begin(target.uv, count, rows, self.box)
        for _ in range(MOST_STEPS):
            if count <= few:
                return numbers[:count]
            jets = self.jets(rows.place[0, :count], rows.place[1, :count])
            count = newton(
                jets, count, rows, target, self.box, self.size, NORMAL_ERROR**2, self.noise**2
            )
        return numbers[:0]


def refine(surface: Surface, spline: Spline, target: Target, threads: int | None = None) -> None:
    """Replace samples of a spline by the points of the surface with the same unit normals.

    A sample is found if Newton's method leads to a point of the surface whose normal is the
    prescribed one, up to NORMAL_ERROR or up to the noise of the surface where the method stagnates,
    and where K has the sign of target.signs; next to a pole the sign does not matter, since the
    spline has folds there. The parameters, point and curvatures of such a sample are overwritten.
    All other samples stay those of the spline: samples at parabolic and singular points, and
    samples whose solution is outside the domain or more than three cells away. `target.state` says
    of each sample whether it was found.
    """
    target.state[:] = NOT_FOUND
    charts = pole_charts(surface, spline.cells)
    next_to_poles = _refine_away(surface, spline, charts, target, threads)
    for chart, rows in zip(charts, next_to_poles, strict=True):
        _refine_at_pole(chart, spline, target, rows, threads)


def _refine_away(
    surface: Surface, spline: Spline, charts: list[PoleChart], target: Target, threads: int | None
) -> list[Indices]:
    """Do `refine` for samples away from poles; return for each chart the samples near its pole.

    The samples near a pole are given by an array of their indices.
    """
    domain = Parameters.of_domain(surface, spline)

    def work(first: int, last: int) -> tuple[Indices, list[Indices]]:
        part = Target._make(x[first:last] for x in target)
        at_poles = [np.flatnonzero(x.near(part.uv)) for x in charts]
        numbers = np.arange(last - first)
        if charts:
            numbers = np.delete(numbers, np.concatenate(at_poles))
        left = domain.solve(part, numbers, int(len(numbers) * FEW))
        return first + left, [first + x for x in at_poles]

    none = np.empty(0, np.int64)
    results = [(none, [none for _ in charts])]
    results += over_ranges(work, len(target.uv), ROWS_AT_A_TIME, threads)
    left = np.concatenate([x for x, _ in results])
    _on_rows(target, left, lambda x: domain.solve(x, np.arange(len(x.uv)), 0), threads)
    return [np.concatenate([x[k] for _, x in results]) for k in range(len(charts))]


def _on_rows(
    target: Target, numbers: Indices, solve: Callable[[Target], object], threads: int | None
) -> None:
    """Call `solve` with copies of the rows `numbers` of `target`; write found rows back to it."""

    def work(first: int, last: int) -> None:
        rows = numbers[first:last]
        part = Target._make(x[rows] for x in target)
        solve(part)
        target.state[rows] = part.state
        found = part.state == FOUND
        for array, values in zip(target[2:-1], part[2:-1], strict=True):
            array[rows[found]] = values[found]

    list(over_ranges(work, len(numbers), ROWS_AT_A_TIME, threads))


def _refine_at_pole(
    chart: PoleChart, spline: Spline, target: Target, numbers: Indices, threads: int | None
) -> None:
    """Do `refine` for the samples next to a pole, with the parameters s and t of its chart."""
    parameters = Parameters.of_chart(chart, spline)

    def solve(part: Target) -> None:
        part.normals[:] *= chart.orientation
        part.signs[:] = 0.0
        part.uv[:] = chart.places(part.uv)
        parameters.solve(part, np.arange(len(part.uv)), 0)
        part.uv[:] = chart.parameters(part.uv)
        # Evaluate the fields as for all other samples: finite differences are by s and t near the
        # pole (`PoleChart.next_to`), and by u and v elsewhere, where their errors are smaller.
        found = part.state == FOUND
        points, _, gaussian, mean = evaluate_on_surface(
            chart.surface, spline, part.uv[found], threads=1
        )
        part.points[found], part.gaussian[found], part.mean[found] = points, gaussian, mean

    _on_rows(target, numbers, solve, threads)


def evaluate_on_surface(
    surface: Surface, spline: Spline, uv: Array, threads: int | None = None
) -> tuple[Array, Array, Array, Array]:
    """Return points (k, 3), unit normals (k, 3), K (k,) and H (k,) at parameters (k, 2).

    Normals and curvatures are 0 at singular points, except at poles.
    """
    count = len(uv)
    points, normals = np.empty((count, 3)), np.empty((count, 3))
    gaussian, mean = np.empty(count), np.empty(count)
    charts = pole_charts(surface, spline.cells)

    def work(first: int, last: int) -> None:
        part = slice(first, last)
        jets = surface.jets(uv[part, 0].copy(), uv[part, 1].copy())
        points[part] = jets[:, 0]
        scales = np.array([spline.scale, *spline.frame[2:]])
        evaluate_jets(jets, scales, normals[part], gaussian[part], mean[part])
        for rows, n, K, H in near_poles(charts, spline.scale, uv[part]):
            normals[first + rows], gaussian[first + rows], mean[first + rows] = n, K, H

    list(over_ranges(work, count, ROWS_AT_A_TIME, threads))
    return points, normals, gaussian, mean
