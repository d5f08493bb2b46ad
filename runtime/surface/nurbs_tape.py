"""The tape of a NURBS surface: its polynomials on each pair of knot spans, and their quotients.

The basis functions of a span are polynomials with rational coefficients, which are computed exactly
from the knots and then rounded. Sums of their products with control points are computed in float64,
with bounds of the rounding errors.
"""

from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..tape.kernels.nurbs import Net
from ..tape.kernels.points import Tape
from ..tape.kernels.splines import COORDINATES, MOST_COEFFICIENTS, Polynomials
from ..tape.tapes import TapeWriter

UNIT = 2.0**-53
KEPT = 256  # the number of cached bases of spans, which faces of a part often share
MOST_NUMBERS = 4_000_000  # of the coefficients of all polynomials: 64 MB with their errors


class Axis(NamedTuple):
    """The k knot spans of one parameter, and the basis functions on them.

    Attributes
    ----------
    breaks : (k + 1,) float64 array
        The bounds of the spans.
    smooth : (k + 1,) int64 array
        The order of continuity at each bound: degree minus multiplicity.
    frames : (k, 2) float64 array
        The midpoint and the scale of the local parameter of each span.
    first : (k,) int64 array
        The index of the first control point of each span.
    basis : (k, p + 1, p + 1) float64 array
        The coefficients of the basis functions on each span.

    """

    breaks: Array
    smooth: NDArray[np.int64]
    frames: Array
    first: NDArray[np.int64]
    basis: Array


def nurbs_tape(net: Net) -> Tape | None:
    """Return the tape of a NURBS surface; None if its degrees or its net are large."""
    p, q = (int(x) for x in net.degrees)
    if (p + 1) * (q + 1) > MOST_COEFFICIENTS:
        return None
    along_u, along_v = _axis(net, 0), _axis(net, 1)
    patches = len(along_u.first) * len(along_v.first)
    if patches * (p + 1) * (q + 1) * COORDINATES > MOST_NUMBERS:
        return None
    writer = TapeWriter()
    row = writer.spline(_polynomials(net, along_u, along_v))
    rows = [row + k for k in range(3)]
    if net.points.shape[2] == 4:
        factor = writer.write("reciprocal", row + 3)
        rows = [writer.write("product", x, factor) for x in rows]
    centre = [writer.constant(x) for x in net.centre.tolist()]
    return writer.tape([writer.write("sum", x, y) for x, y in zip(rows, centre, strict=True)])


def _axis(net: Net, axis: int) -> Axis:
    """Return the knot spans of positive length, for u (axis 0) or v (axis 1)."""
    knots, degree = (net.knots_u, net.knots_v)[axis], int(net.degrees[axis])
    first, last = net.spans[axis].tolist()
    spans = np.array([k for k in range(first, last + 1) if knots[k] < knots[k + 1]])
    breaks = np.append(knots[spans], knots[spans[-1] + 1])
    smooth = degree - np.count_nonzero(knots[:, None] == breaks, axis=0)
    if net.periods[axis, 1] > 0.0:  # both ends are the same knot, with unknown smoothness
        smooth[0] = smooth[-1] = 0
    middles = breaks[:-1] / 2 + breaks[1:] / 2
    scales = np.ldexp(1.0, -np.frexp(np.diff(breaks) / 2)[1])
    frames = np.stack([middles, scales], axis=1)
    basis = np.array(
        [
            _basis(tuple(knots[k - degree : k + degree + 2].tolist()), degree, *frame)
            for k, frame in zip(spans.tolist(), frames.tolist(), strict=True)
        ]
    )
    return Axis(breaks, smooth.astype(np.int64), frames, spans - degree, basis)


@lru_cache(KEPT)
def _basis(knots: tuple[float, ...], degree: int, middle: float, scale: float) -> Array:
    """Return the coefficients of the basis functions on a span, one row for each function.

    The functions are polynomials in s = (u − middle) scale. `knots` are the 2 degree + 2 knots
    around the span.
    """
    exact = [Fraction(scale) * (Fraction(x) - Fraction(middle)) for x in knots]
    rows = [[Fraction(1)]]
    for j in range(1, degree + 1):
        found = [[Fraction(0)] * (j + 1) for _ in range(j + 1)]
        for r, row in enumerate(rows):
            low, high = exact[degree + 1 - j + r], exact[degree + 1 + r]
            for k, x in enumerate(row):
                share = x / (high - low)
                found[r][k] += high * share
                found[r][k + 1] -= share
                found[r + 1][k] -= low * share
                found[r + 1][k + 1] += share
        rows = found
    return np.array([[float(x) for x in row] for row in rows])


def _polynomials(net: Net, along_u: Axis, along_v: Axis) -> Polynomials:
    """Return the polynomials on all pairs of spans, with bounds of their rounding errors.

    The bounds include the errors of the coordinates of control points, which are rounded numbers.
    """
    p, q = (int(x) for x in net.degrees)
    rows = along_u.first[:, None] + np.arange(p + 1)
    columns = along_v.first[:, None] + np.arange(q + 1)
    points = net.points[rows[:, None, :, None], columns[None, :, None, :]]
    weights = points[..., 3:] if points.shape[-1] == COORDINATES else 1.0
    errors = (p + q + 8) * UNIT * np.abs(points)
    errors[..., :3] += UNIT * np.abs(weights * net.centre)
    values, errors = (
        np.einsum("ira,ijrsc,jsb->ijabc", *x, optimize=True)
        for x in (
            (along_u.basis, points, along_v.basis),
            (np.abs(along_u.basis), errors, np.abs(along_v.basis)),
        )
    )
    if points.shape[-1] < COORDINATES:
        more = [(0, 0)] * 4 + [(0, 1)]
        values, errors = np.pad(values, more), np.pad(errors, more)
    return Polynomials(
        along_u.breaks, along_v.breaks, along_u.smooth, along_v.smooth,
        along_u.frames, along_v.frames, net.periods.copy(),
        np.ascontiguousarray(values), np.ascontiguousarray(errors),
    )  # fmt: skip
