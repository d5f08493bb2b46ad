"""Samples of a curve: points, normals, parameters, curvatures, and a report."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["CurveReport", "CurveSamples"]


@dataclass(frozen=True, slots=True)
class CurveReport:
    """A report on the sampling of a curve.

    - `curve`: label of the curve.
    - `normals`: the number of prescribed normals.
    - `samples`: the number of samples.
    - `pieces`: the number of arcs of the spline.
    - `straight_share`: the share (0…1) of the length where κ ≈ 0, so that it has no samples.
    - `inflections`: the number of changes of the sign of κ.
    - `turning_number`: the turning number of a closed curve; None for an open one.
    """

    curve: str
    normals: int
    samples: int
    pieces: int
    straight_share: float
    inflections: int
    turning_number: int | None


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class CurveSamples:
    """N samples of a planar curve in the order of their parameters; lengths in its unit L.

    - `points`: (N, 2) float64, points of the curve, in L.
    - `normals`: (N, 2) float64, unit normals at the points: the tangent turned clockwise.
    - `parameters`: (N,) float64, the curve's own parameters of the points.
    - `support`: (N,) float64, support function n·x, in L.
    - `curvature`: (N,) float64, in 1/L, positive on a circle with outward normals. Its sign bit
      is the sense in which the normal turns, also where the curvature is rounded to 0.
    - `normal_index`: (N,) int64, row of the prescribed normals.
    - `piece_index`: (N,) int64, arc of the spline that contains the point.
    - `ends`: (2, 2) float64, the ends of an open curve; (0, 2) for a closed one.
    - `report`: a report on the sampling.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    parameters: NDArray[np.float64]
    support: NDArray[np.float64]
    curvature: NDArray[np.float64]
    normal_index: NDArray[np.int64]
    piece_index: NDArray[np.int64]
    ends: NDArray[np.float64]
    report: CurveReport

    @property
    def polygon(self) -> NDArray[np.float64]:
        """The vertices (M, 2) of the polygon through all samples in turn.

        That of an open curve begins and ends with the ends of the curve; that of a closed curve
        repeats its first point at its end.
        """
        if len(self.ends):
            return np.concatenate([self.ends[:1], self.points, self.ends[1:]])
        return np.concatenate([self.points, self.points[:1]])

    def summary(self) -> str:
        """One line: the numbers of samples, normals and inflections, and the straight share."""
        report = self.report
        return (
            f"{report.samples:,} samples at {report.normals:,} prescribed normals; "
            f"{report.inflections} inflections; {100.0 * report.straight_share:.2f} % of the "
            "curve is straight"
        )

    def __len__(self) -> int:
        return len(self.support)

    def __repr__(self) -> str:
        return f"CurveSamples({len(self):,} points on {self.report.curve})"
