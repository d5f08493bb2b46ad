"""Samples of a curve: points, normals, parameters, curvatures, and a report."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["CurveReport", "CurveSamples"]


@dataclass(frozen=True, slots=True)
class CurveReport:
    """A report on the sampling of a curve.

    Attributes
    ----------
    curve : str
        Label of the curve.
    normals : int
        The number of prescribed normals.
    samples : int
        The number of samples.
    pieces : int
        The number of arcs of the spline.
    straight_share : float
        The share (0…1) of the length where κ ≈ 0, so that it has no samples.
    inflections : int
        The number of changes of the sign of κ.
    turning_number : int or None
        The turning number of a closed curve; None for an open one.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(
    ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True, name="circle"
    ... )
    >>> report = gm.curves.sample(circle, 8).report
    >>> report.curve, report.normals, report.samples, report.pieces
    ('circle', 8, 8, 64)
    >>> report.straight_share, report.inflections, report.turning_number
    (0.0, 0, 1)

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

    Attributes
    ----------
    points : (N, 2) float64 array
        Points of the curve, in L.
    normals : (N, 2) float64 array
        Unit normals at the points: the tangent turned clockwise.
    parameters : (N,) float64 array
        The parameters of the points.
    support : (N,) float64 array
        Support function h = n·x, in L.
    curvature : (N,) float64 array
        In 1/L, positive on a circle with outward normals. Its sign bit is the sense in which the
        normal turns, also where the curvature is rounded to 0.
    normal_index : (N,) int64 array
        Rows of the prescribed normals.
    piece_index : (N,) int64 array
        Arcs of the spline that contain the points.
    ends : (2, 2) float64 array
        The ends of an open curve; (0, 2) for a closed one.
    report : CurveReport
        A report on the sampling.

    Examples
    --------
    >>> import gaussmap as gm
    >>> circle = gm.curves.Curve.from_sympy(
    ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True, name="circle"
    ... )
    >>> samples = gm.curves.sample(circle, 8)
    >>> samples
    CurveSamples(8 points on circle)
    >>> samples.points.shape, samples.normals.shape, samples.parameters.shape
    ((8, 2), (8, 2), (8,))
    >>> samples.support.round(3), samples.curvature.round(2)
    (array([1., 1., 1., 1., 1., 1., 1., 1.]), array([1., 1., 1., 1., 1., 1., 1., 1.]))
    >>> sorted(samples.normal_index.tolist()), samples.piece_index.dtype
    ([0, 1, 2, 3, 4, 5, 6, 7], dtype('int64'))
    >>> samples.polygon.shape, samples.ends.shape, samples.report.inflections
    ((9, 2), (0, 2), 0)

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
        """(M, 2) float64 array: the vertices of the polygon through all samples in turn.

        That of an open curve begins and ends with the ends of the curve; that of a closed curve
        repeats its first point at its end.
        """
        if len(self.ends):
            return np.concatenate([self.ends[:1], self.points, self.ends[1:]])
        return np.concatenate([self.points, self.points[:1]])

    def summary(self) -> str:
        """Return one line: the numbers of samples, normals and inflections, and the straight share.

        Returns
        -------
        str
            The line, without a line break.

        Examples
        --------
        >>> import gaussmap as gm
        >>> circle = gm.curves.Curve.from_sympy(
        ...     ("cos(t)", "sin(t)"), "t", (0, "2*pi"), periodic=True
        ... )
        >>> gm.curves.sample(circle, 8).summary()
        '8 samples at 8 prescribed normals; 0 inflections...'

        """
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
