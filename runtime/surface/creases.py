"""Detection of creases, parameter lines where a NURBS is not smooth, and of smooth seams.

Both are detected from points and derivatives, not from multiplicities: a surface may be smooth at a
multiple knot, as is a circle of four arcs. A surface counts as smooth across a line if its normal
jumps there by at most CREASE_ANGLE, and the length of the tangent across the line by at most a
factor of LARGEST_JUMP: larger jumps would let a spline fold.
"""

import numpy as np

from ..base.aliases import Array
from ..base.scales import SAME_POINT, apart
from ..directions.regions import angles_between
from .nurbs import Nurbs

# The least jump of the normal at a crease, in degrees. Smooth joints of CAD data jump by less.
CREASE_ANGLE = 0.1
# The largest ratio of tangent lengths that counts as smooth. At this ratio, splines of surfaces
# have no folds; from a ratio of 5 on, they have some.
LARGEST_JUMP = 3.0
# x_u or x_v counts as zero at a point of a knot line if |x_u × x_v| is at most SINGULAR times the
# largest |x_u| times the largest |x_v| on the line. The normal of such a point is evaluated at a
# distance of BESIDE times the knot span from the line.
BESIDE, SINGULAR = 1e-4, 1e-9


def creases(nurbs: Nurbs) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the values of u, and the values of v, of the creases inside the domain."""

    def is_crease(axis: int, t: float) -> bool:
        turning, jump = _turning(nurbs, axis, t, t), _jump(nurbs, axis, t, t)
        return turning > CREASE_ANGLE or jump > LARGEST_JUMP

    lines_u, lines_v = (
        tuple(t for t in _candidates(nurbs, axis) if is_crease(axis, t)) for axis in (0, 1)
    )
    return lines_u, lines_v


def smoothly_closed(nurbs: Nurbs, axis: int) -> bool:
    """Return whether the two boundaries of u (axis 0) or v (axis 1) form a smooth seam.

    They do if they are the same curve, and the surface is smooth across it.
    """
    low, high = nurbs.domain[axis]
    first, last = (_jets_along(nurbs, axis, end) for end in (low, high))
    if apart(first[:, 0], last[:, 0], nurbs.control_points):
        return False
    if (np.einsum("ij,ij->i", first[:, 1 + axis], last[:, 1 + axis]) < 0.0).any():
        return False  # the tangent across the seam turns by more than 90°
    turning, jump = _turning(nurbs, axis, high, low), _jump(nurbs, axis, high, low)
    return turning <= CREASE_ANGLE and jump <= LARGEST_JUMP


def _candidates(nurbs: Nurbs, axis: int) -> list[float]:
    """Return the knots inside the domain where derivatives may jump or x_u or x_v may vanish."""
    knots, p, (low, high) = nurbs.knots[axis], nurbs.degrees[axis], nurbs.domain[axis]
    points = np.moveaxis(nurbs.control_points, axis, 0)
    steps = np.abs(np.diff(points, axis=0)).max(axis=2)
    same = steps <= SAME_POINT * float(np.ptp(points, axis=(0, 1)).max())
    found = []
    values, counts = np.unique(knots, return_counts=True)
    for t, count in zip(values.tolist(), counts.tolist(), strict=True):
        # The index of the last basis function that is not 0 at t.
        last = int(np.searchsorted(knots, t, "right")) - 1 - count
        coincide = same[last + count - p : last]
        if low < t < high and (count >= p or coincide.all(axis=0).any()):
            found.append(t)
    return found


def _turning(nurbs: Nurbs, axis: int, below: float, above: float) -> float:
    """Return the largest angle in degrees between the normals below a line and above it.

    `below` and `above` are equal, the value of u or v on the line; at a seam they are the upper and
    the lower bound of the domain. NaN if no point of the line has normals on both sides.
    """
    low, high = nurbs.domain[axis]
    first = _normals_along(nurbs, axis, (low, below), 1)
    second = _normals_along(nurbs, axis, (above, high), 0)
    angles = angles_between(first, second)
    known = angles[np.isfinite(angles)]
    return float(known.max()) if len(known) else np.nan


def _jump(nurbs: Nurbs, axis: int, below: float, above: float) -> float:
    """Return the largest ratio of the lengths of x_u (axis 0) or x_v on both sides of a line.

    The larger length is divided by the smaller one. The ratio counts as 1 where both lengths are
    negligible, compared with the largest length on the line.
    """
    low, high = nurbs.domain[axis]
    first, second = (
        np.linalg.norm(_jets_along(_part(nurbs, axis, part), axis, t)[:, 1 + axis], axis=1)
        for part, t in (((low, below), below), ((above, high), above))
    )
    least = SINGULAR * float(max(first.max(), second.max()))
    first, second = np.maximum(first, least), np.maximum(second, least)
    return float(np.maximum(first / second, second / first).max()) if least > 0.0 else 1.0


def _part(nurbs: Nurbs, axis: int, part: tuple[float, float]) -> Nurbs:
    """Return the surface over a part of the domain of u (axis 0) or v (axis 1)."""
    return nurbs.restricted((part, nurbs.domain[1]) if axis == 0 else (nurbs.domain[0], part))


def _normals_along(nurbs: Nurbs, axis: int, part: tuple[float, float], end: int) -> Array:
    """Return unit normals (k, 3) at one bound of an interval of u (axis 0) or v (axis 1).

    The normals are evaluated from inside the interval `part`, at its lower (end 0) or upper bound.
    """
    inside = _part(nurbs, axis, part)
    jets = _jets_along(inside, axis, part[end])
    normals = np.cross(jets[:, 1], jets[:, 2])
    lengths = np.linalg.norm(normals, axis=1)
    sizes = [float(np.linalg.norm(jets[:, d], axis=1).max()) for d in (1, 2)]
    inner = nurbs.knots[axis][(nurbs.knots[axis] > part[0]) & (nurbs.knots[axis] < part[1])]
    next_knot = [*part, *inner]
    span = min(abs(x - part[end]) for x in next_knot if x != part[end])
    beside = _jets_along(inside, axis, part[end] + (BESIDE * span) * (1 - 2 * end))
    singular = lengths <= SINGULAR * sizes[0] * sizes[1]
    normals[singular] = np.cross(beside[:, 1], beside[:, 2])[singular]
    with np.errstate(invalid="ignore", divide="ignore"):
        return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def _jets_along(nurbs: Nurbs, axis: int, t: float) -> Array:
    """Return jets (k, 6, 3) at points on the line u = t or v = t, several in each knot span."""
    other = 1 - axis
    knots, (low, high) = nurbs.knots[other], nurbs.domain[other]
    ends = np.unique(np.concatenate([[low, high], knots[(knots > low) & (knots < high)]]))
    each = nurbs.degrees[other] + 2
    shares = (np.arange(each) + 0.5) / each
    places = (ends[:-1, None] + np.diff(ends)[:, None] * shares).ravel()
    line = np.full(len(places), t)
    return nurbs.jets(*((line, places) if axis == 0 else (places, line)))
