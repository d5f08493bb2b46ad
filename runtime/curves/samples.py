"""What the sampling of a curve returns: points, normals, parameters, curvatures, how it went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["CurveReport", "CurveSamples"]


@dataclass(frozen=True, slots=True)
class CurveReport:
    """How the sampling of a curve went, as plain numbers.

    - `curve`: label of the curve.
    - `normals`: how many normals were asked.
    - `samples`: how many samples came.
    - `pieces`: how many arcs the spline has.
    - `straight_share`: share of the length that bends so little that normals cannot see it, 0…1.
    - `inflections`: how often the curvature changes its sign.
    - `turning_number`: how often the normal of a closed curve turns round; None for an open one.
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
      tells which way the normal turns, also where rounding leaves nothing of the curvature.
    - `normal_index`: (N,) int64, row of the normals that were asked.
    - `piece_index`: (N,) int64, arc of the spline that holds the point.
    - `ends`: (2, 2) float64, the ends of an open curve; (0, 2) for a closed one.
    - `report`: how the sampling went.
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
        """One line: how many samples, normals and inflections, and how much is straight."""
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
