"""Curves of Open CASCADE as NURBS of the same parameter."""

# pyright: reportMissingImports=false

from collections.abc import Callable, Sequence
from math import comb
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.GeomConvert import GeomConvert

from ..records import Net
from .shapes import direct_class

Array = NDArray[np.float64]

# Curves other than NURBS, such as circles, are interpolated by splines of this degree. The number
# of spans is doubled until the error, relative to the size of the curve, is that of rounding.
# Offsets need third derivatives, whose errors grow with shorter spans: a circle has four spans.
DEGREE, MOST_SPANS = 13, 1024
ROUNDING = 4e-15
# The length of the extension of a line beyond its domain, relative to the domain.
BEYOND = 0.1
# Parameters count as equal up to this distance, relative to the period.
SAME = 1e-9


class UnusableError(Exception):
    """A face cannot be converted to arrays; the text is the reason, without a full stop."""


def curve_net(curve: Any, domain: Sequence[float]) -> Net:  # noqa: ANN401
    """Return a curve as NURBS.

    A periodic curve is returned as a whole, any other curve at least over a domain.
    """
    period = float(curve.Period()) if curve.IsPeriodic() else 0.0
    trimmed = curve
    while direct_class(curve) == "Geom_TrimmedCurve":
        curve = curve.BasisCurve()
    kind = direct_class(curve)
    if kind == "Geom_BSplineCurve":
        crosses_seam = curve.IsPeriodic() and not period
        if crosses_seam:
            return _of_spline(GeomConvert.CurveToBSplineCurve_s(trimmed), domain)
        return _of_spline(curve, domain)
    if kind == "Geom_BezierCurve":
        degree = curve.Degree()
        knots = np.repeat([0.0, 1.0], degree + 1)
        return Net((degree,), (knots,), *_poles(curve))
    first, last = float(domain[0]), float(domain[1])
    if period:
        shift = start_of_period(domain, 0.0, period)
        first, last = shift, shift + period
    if kind == "Geom_Line":
        margin = BEYOND * (last - first)
        ends = np.array([first - margin, last + margin])
        return Net((1,), (np.repeat(ends, 2),), _values(curve, ends))
    return _interpolated(curve, first, last)


def start_of_period(domain: Sequence[float], first: float, period: float) -> float:
    """Return the start of a period that contains a domain.

    It is `first` if possible, otherwise the start of the domain.
    """
    slack = SAME * period
    inside = first - slack <= domain[0] and domain[1] <= first + period + slack
    return first if inside else float(domain[0])


def knots_of(knots: Sequence[float], multiplicities: Sequence[int]) -> Array:
    """Return knots, repeated by their multiplicities."""
    return np.repeat(np.array(knots, dtype=np.float64), np.array(multiplicities, dtype=np.int64))


def _of_spline(curve: Any, domain: Sequence[float]) -> Net:  # noqa: ANN401
    shift = 0.0
    if curve.IsPeriodic():
        curve = curve.Copy()
        names = ("Knot", "NbKnots", "InsertKnot", "SetOrigin", "SetNotPeriodic")
        shift = opened([getattr(curve, x) for x in names], domain, float(curve.Period()))
    places = range(1, curve.NbKnots() + 1)
    knots = knots_of([curve.Knot(k) for k in places], [curve.Multiplicity(k) for k in places])
    return Net((curve.Degree(),), (knots + shift,), *_poles(curve))


def opened(calls: Sequence[Callable[..., Any]], domain: Sequence[float], period: float) -> float:
    """Cut a periodic spline open such that a domain is in one period; return the shift of knots.

    A face may start anywhere in the period. `calls` are methods of the spline: they return knot k,
    return the number of knots, insert a knot, choose the first knot, and make it non-periodic.
    """
    knot, count, insert, begin, end = calls
    first = float(knot(1))
    start = start_of_period(domain, first, period)
    inside = first + (start - first) % period
    if inside != first:
        insert(inside, 1, SAME * period)
        begin(min(range(1, count()), key=lambda k: abs(knot(k) - inside)))
    end()
    return start - inside


def _poles(curve: Any) -> tuple[Array, Array | None]:  # noqa: ANN401
    """Return the control points (m, 3) and the weights (m,), or None for weights of 1."""
    places = range(1, curve.NbPoles() + 1)
    poles = (curve.Pole(k) for k in places)
    points = np.array([(p.X(), p.Y(), p.Z()) for p in poles], dtype=np.float64)
    if not curve.IsRational():
        return points, None
    return points, np.array([curve.Weight(k) for k in places], dtype=np.float64)


def _values(curve: Any, parameters: Array) -> Array:  # noqa: ANN401
    points = (curve.Value(t) for t in parameters.tolist())
    return np.array([(p.X(), p.Y(), p.Z()) for p in points], dtype=np.float64)


def _interpolated(curve: Any, first: float, last: float) -> Net:  # noqa: ANN401
    """Return a curve as polynomials between knots, continuous at the knots."""
    spans = 1
    while spans <= MOST_SPANS:
        ends = np.linspace(first, last, spans + 1)
        points = _control_points(curve, ends)
        if _misfit(curve, ends, points) <= ROUNDING:
            knots = np.repeat(ends, [DEGREE + 1, *([DEGREE] * (spans - 1)), DEGREE + 1])
            joined = np.concatenate([points[0, :1], points[:, 1:].reshape(-1, 3)])
            return Net((DEGREE,), (knots,), joined)
        spans *= 2
    kind = direct_class(curve).removeprefix("Geom_")
    raise UnusableError(f"its curve of type {kind} cannot be written as NURBS")


def _control_points(curve: Any, ends: Array) -> Array:  # noqa: ANN401
    """Return the Bézier points (spans, degree + 1, 3) of the interpolating polynomials."""
    places = (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, DEGREE + 1))) / 2.0
    parameters = ends[:-1, None] + np.diff(ends)[:, None] * places
    values = _values(curve, parameters.ravel()).reshape(-1, DEGREE + 1, 3)
    return np.asarray(np.linalg.solve(_bernstein(places)[None], values), dtype=np.float64)


def _misfit(curve: Any, ends: Array, points: Array) -> float:  # noqa: ANN401
    """Return the largest error at three points of each span, relative to the size of the curve."""
    places = np.linspace(0.1, 0.7, 3)
    parameters = ends[:-1, None] + np.diff(ends)[:, None] * places
    values = _values(curve, parameters.ravel()).reshape(-1, len(places), 3)
    error = np.abs(_bernstein(places) @ points - values).max()
    return float(error / max(np.abs(values).max(), np.finfo(np.float64).tiny))


def _bernstein(places: Array) -> Array:
    """Return the values of the Bernstein polynomials of `DEGREE`, a row for each parameter."""
    k = np.arange(DEGREE + 1)
    binomials = np.array([comb(DEGREE, int(x)) for x in k], dtype=np.float64)
    return binomials * places[:, None] ** k * (1.0 - places[:, None]) ** (DEGREE - k)
