"""P-curves: the curves of edges in the parameter planes of faces."""

# pyright: reportMissingImports=false

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve2d
from OCP.GeomAbs import GeomAbs_CurveType as Kinds
from OCP.gp import gp_Pnt2d, gp_Vec2d
from OCP.ShapeFix import ShapeFix_Edge
from OCP.TopAbs import TopAbs_Orientation

from .polylines import one_sided

Array = NDArray[np.float64]

# The distance up to which Open CASCADE considers points equal, in mm.
CONFUSION = 1e-7
FIRST_PIECES, PIECES_A_SPAN, MOST_PIECES = 4, 2, 256


@dataclass(frozen=True)
class PCurve:
    """A p-curve: `evaluate` returns points and derivatives (k, 4) at parameters (k,).

    `reversed` says whether the wire runs against the direction of the parameter. `ends` are the
    parameters of both ends, and of possible corners between them. A polyline initially has `pieces`
    pieces between any two successive `ends`; 0 means a straight line. `radius` is the radius of a
    circle, 0 for other curves.
    """

    evaluate: Callable[[Array], Array]
    ends: tuple[float, ...]
    pieces: int
    reversed: bool
    radius: float = 0.0

    @cached_property
    def chord(self) -> Array:
        """The points (2, 2) at both ends."""
        return self.evaluate(np.array([self.ends[0], self.ends[-1]]))[:, :2]

    def polyline(self, tolerance: Array) -> Array:
        """Return points (k, 2) of a polyline in the direction of the wire.

        The polyline deviates from the curve only to the left, where the face lies.
        """
        if self.pieces == 0:
            points = self.chord
        else:
            pieces = self._pieces(tolerance)
            parts = [
                one_sided(self.evaluate, a, b, pieces, tolerance, not self.reversed)
                for a, b in zip(self.ends[:-1], self.ends[1:], strict=True)
            ]
            points = np.concatenate(parts)
        return points[::-1] if self.reversed else points

    def _pieces(self, tolerance: Array) -> int:
        if not self.radius:
            return self.pieces
        # The tangents at the ends of an arc of angle a meet at a distance of about r a² / 4 from
        # its chord.
        angle = 2.0 * math.sqrt(float(tolerance.min()) / self.radius)
        return int(min(max((self.ends[-1] - self.ends[0]) / angle + 1.0, self.pieces), MOST_PIECES))


def curve_of(edge: Any, face: Any) -> PCurve:  # noqa: ANN401
    """Return the p-curve of an oriented edge on a face that is oriented forward."""
    curve = _adaptor(edge, face)
    backwards = edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
    ends = float(curve.FirstParameter()), float(curve.LastParameter())
    kind = curve.GetType()
    if kind == Kinds.GeomAbs_Line:
        return PCurve(_line(curve.Line()), ends, 0, backwards)
    if kind == Kinds.GeomAbs_Circle:
        circle = curve.Circle()
        return PCurve(_circle(circle), ends, FIRST_PIECES, backwards, float(circle.Radius()))
    if kind == Kinds.GeomAbs_BSplineCurve:
        corners, spans = _corners(curve.BSpline(), ends)
        pieces = max(FIRST_PIECES, PIECES_A_SPAN * spans // (len(corners) - 1))
        return PCurve(_any(curve), corners, pieces, backwards)
    return PCurve(_any(curve), ends, FIRST_PIECES, backwards)


def _adaptor(edge: Any, face: Any) -> Any:  # noqa: ANN401
    try:
        return BRepAdaptor_Curve2d(edge, face)
    except Exception:  # the edge has no p-curve on this face
        ShapeFix_Edge().FixAddPCurve(edge, face, BRep_Tool.IsClosed_s(edge, face), CONFUSION)
        return BRepAdaptor_Curve2d(edge, face)


def _corners(spline: Any, ends: tuple[float, float]) -> tuple[tuple[float, ...], int]:  # noqa: ANN401
    """Return the ends and the knots between them where corners may be, and the number of spans."""
    inside = [k for k in range(1, spline.NbKnots() + 1) if ends[0] < spline.Knot(k) < ends[1]]
    multiple = [k for k in inside if spline.Multiplicity(k) >= spline.Degree()]
    return (ends[0], *(spline.Knot(k) for k in multiple), ends[1]), len(inside) + 1


# For a point, a call of Open CASCADE takes a microsecond or more, and most curves are lines and
# circles. Their points are computed here, by the formulas of Open CASCADE.


def _line(line: Any) -> Callable[[Array], Array]:  # noqa: ANN401
    origin, along = np.array(line.Location().Coord()), np.array(line.Direction().Coord())

    def evaluate(t: Array) -> Array:
        rows = np.empty((len(t), 4))
        rows[:, :2] = t[:, None] * along + origin
        rows[:, 2:] = along
        return rows

    return evaluate


def _circle(circle: Any) -> Callable[[Array], Array]:  # noqa: ANN401
    origin, radius = np.array(circle.Location().Coord()), float(circle.Radius())
    axes = circle.XAxis().Direction().Coord(), circle.YAxis().Direction().Coord()
    x, y = map(np.array, axes)

    def evaluate(t: Array) -> Array:
        cosines, sines = _cosines_and_sines(t.tobytes())
        rows = np.empty((len(t), 4))
        across, along = radius * cosines, radius * sines
        rows[:, :2] = across * x + along * y + origin
        rows[:, 2:] = -along * x + across * y
        return rows

    return evaluate


@lru_cache(maxsize=64)
def _cosines_and_sines(angles: bytes) -> tuple[Array, Array]:
    """Return the cosines and sines of angles, (k, 1) each; many circles share the same angles."""
    values = np.frombuffer(angles).tolist()
    cosines, sines = (np.array([*map(f, values)])[:, None] for f in (math.cos, math.sin))
    return cosines, sines


def _any(curve: Any) -> Callable[[Array], Array]:  # noqa: ANN401
    point, tangent = gp_Pnt2d(), gp_Vec2d()

    def evaluate(t: Array) -> Array:
        rows = np.empty((len(t), 4))
        for k, x in enumerate(t.tolist()):
            curve.D1(x, point, tangent)
            rows[k] = *point.Coord(), *tangent.Coord()
        return rows

    return evaluate
