"""NURBS of faces over the domain of the face: cut, or continued periodically."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from ...runtime.base.scales import apart
from ...runtime.domain.domain import Interval
from ...runtime.surface.creases import creases, smoothly_closed
from ...runtime.surface.nurbs import Nurbs
from ...runtime.surface.nurbs_input import nurbs_of
from .records import Net

Array = NDArray[np.float64]

# Ends of domains count as equal if their distance, relative to the period or the length, is below
# this. It is more than the 1e-9 to which CAD systems compare parameters, since faces may leave
# wider gaps along their seams.
SAME_END = 1e-7


def nurbs_of_net(net: Net) -> Nurbs:
    """Return the NURBS surface of a net over all of its knots; InputError if the net is invalid."""
    return nurbs_of(net.degrees, net.knots, net.points, net.weights)


def nurbs_of_curve(net: Net, along: Array, length: Interval) -> Nurbs:
    """Return the surface of a NURBS curve, with parameter u, translated along a vector (3,) by v.

    v runs over `length`. Raises InputError if the net is not a curve.
    """
    (degree,), (knots,) = net.degrees, net.knots
    points = net.points[:, None] + along * np.array(length)[:, None]
    weights = None if net.weights is None else np.repeat(net.weights[:, None], 2, axis=1)
    return nurbs_of((degree, 1), (knots, np.repeat(length, 2)), points, weights)


def curve_of_net(net: Net) -> Nurbs:
    """Return a NURBS curve as the line v = 0 of a surface.

    The curve is translated along the direction in which it extends least, so that the normals of
    the surface jump at kinks of the curve.
    """
    points = net.points - net.points.mean(axis=0)
    direction = np.linalg.svd(points, full_matrices=True)[2][-1]
    return nurbs_of_curve(net, direction * np.abs(points).max(), (0.0, 1.0))


def line_of(start: Array, way: Array, ends: Interval) -> Nurbs:
    """Return the line start + t way in the plane y = 0, for t in the interval `ends`.

    The surface that is returned consists of this line, at v = 0 with u = t, and its translates
    along y.
    """
    middle, half = start + sum(ends) / 2.0 * way, (ends[1] - ends[0]) / 2.0 * way
    across = np.array([(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
    points = np.stack([-half, half])[:, None] + across
    knots = np.repeat(ends, 2), np.repeat((0.0, 1.0), 2)
    return Nurbs((1, 1), knots, points, middle, (ends, (0.0, 1.0)))


def nurbs_over(nurbs: Nurbs, domain: tuple[Interval, Interval]) -> Nurbs:
    """Return a NURBS over a domain, with its creases, and periodic where it closes smoothly.

    A domain that exceeds the NURBS is covered periodically if the ends of the NURBS meet; otherwise
    the NURBS is cut.
    """
    for axis in (0, 1):
        nurbs = _over(nurbs, axis, domain[axis])
    return replace(nurbs, creases=creases(nurbs))


def _over(nurbs: Nurbs, axis: int, interval: Interval) -> Nurbs:
    """Return a NURBS over an interval of u (axis 0) or v (axis 1)."""
    (first, last), (low, high) = nurbs.domain[axis], interval
    period, slack = last - first, SAME_END * (last - first)
    if low < first - slack or high > last + slack:
        nurbs = _continued(nurbs, axis, interval)
        first, last = nurbs.domain[axis]
    low, high = (_at_knot(nurbs.knots[axis], x, slack) for x in interval)
    low, high = max(low, first), min(high, last)
    if not low < high:
        raise InputError(
            f"the face is at {'uv'[axis]} from {interval[0]} to {interval[1]}, outside its surface."
        )
    whole = abs(high - low - period) <= slack
    parts = list(nurbs.domain)
    parts[axis] = (low, min(low + period, last) if whole else high)
    nurbs = nurbs.restricted((parts[0], parts[1]))
    periodic = list(nurbs.periodic)
    periodic[axis] = whole and smoothly_closed(nurbs, axis)
    return replace(nurbs, periodic=(periodic[0], periodic[1]))


def _at_knot(knots: Array, end: float, slack: float) -> float:
    """Return the knot within `slack` of the end of an interval, or else the end itself.

    Faces often end at a kink of their surface: beyond the knot there would be a piece without area.
    """
    nearest = float(knots[np.abs(knots - end).argmin()])
    return nearest if abs(nearest - end) <= slack else end


def _continued(nurbs: Nurbs, axis: int, interval: Interval) -> Nurbs:
    """Return one NURBS over an interval, joined from copies of a NURBS shifted by its period.

    A NURBS that is not clamped, or whose ends along the axis do not meet, is returned unchanged.
    """
    (first, last), degree = nurbs.domain[axis], nurbs.degrees[axis]
    points, knots = np.moveaxis(nurbs.points, axis, 0), nurbs.knots[axis]
    clamped = (knots[: degree + 1] == first).all() and (knots[-degree - 1 :] == last).all()
    if not clamped or apart(points[:1], points[-1:], nurbs.points):
        return nurbs
    period = last - first
    before = max(int(np.ceil((first - interval[0]) / period - SAME_END)), 0)
    after = max(int(np.ceil((interval[1] - last) / period - SAME_END)), 0)
    turns = np.arange(-before, after + 1)
    inner = knots[degree + 1 : -degree - 1]
    parts = [np.full(degree + 1, first - before * period)]
    for turn in turns:
        end = last + turn * period
        parts += [inner + turn * period, np.full(degree + (turn == after), end)]
    joined = np.concatenate([points, *[points[1:]] * (len(turns) - 1)])
    all_knots, domain = list(nurbs.knots), list(nurbs.domain)
    all_knots[axis] = np.concatenate(parts)
    domain[axis] = (first - before * period, last + after * period)
    return replace(
        nurbs,
        knots=(all_knots[0], all_knots[1]),
        points=np.ascontiguousarray(np.moveaxis(joined, 0, axis)),
        domain=(domain[0], domain[1]),
    )
