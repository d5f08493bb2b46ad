"""Lines of a grid of parameters, including those where second derivatives of a spline jump."""

from __future__ import annotations

import numpy as np

from ...generated.elementary import SPLINE
from ..base.aliases import Array
from ..domain.domain import Boundary, Domain
from ..tape.kernels.points import Tape
from ..tape.kernels.spline_bounds import SLACK
from ..tape.tapes import jets_of
from .kernels.cell_bounds import SMOOTH

__all__ = ["joints_of", "jumps_of", "lines_of"]

# Normals on both sides of a line are compared at about this number of points.
PLACES = 64


def jumps_of(tape: Tape, axis: int, low: float, high: float) -> Array:
    """Return the u (axis 0) or v in an interval where second derivatives of a spline jump."""
    x = tape.spline
    breaks, smooth = ((x.breaks_u, x.smooth_u), (x.breaks_v, x.smooth_v))[axis]
    jumps = breaks[smooth < 2]
    (rows,) = np.nonzero(tape.operations[:, 0] == SPLINE)
    if axis == 0 and len(rows) > 0 and tape.operations[rows[0], 3] == 1:
        jumps = tape.numbers[rows[0], 0] - jumps  # u is reversed
    slack = SLACK * np.abs(breaks[[0, -1]]).sum() if len(breaks) > 0 else 0.0
    return jumps[(jumps > low + slack) & (jumps < high - slack)]


def lines_of(tape: Tape, axis: int, ends: Array, count: int) -> Array:
    """Return about `count` lines of a grid between both ends of u or v, and the lines of jumps."""
    low, high = ends.tolist()
    pieces = np.unique([low, high, *jumps_of(tape, axis, low, high)])
    counts = np.maximum(1, np.round(count * np.diff(pieces) / (high - low))).astype(int)
    parts = [
        np.linspace(low, high, k + 1)[:-1]
        for low, high, k in zip(pieces[:-1], pieces[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), high)


def joints_of(tape: Tape, axis: int, domain: Domain, boundary: Boundary) -> Array:
    """Return the u (axis 0) or v where derivatives may jump, but the tangent plane does not.

    The seam of a period is one of them. Normals of both sides are compared at sampled points.
    """
    low, high = domain[axis]
    lines = [(x, x) for x in jumps_of(tape, axis, low, high).tolist()]
    if boundary[axis][0] == "periodic" and len(tape.spline.breaks_u) > 0:
        lines.append((low, high))
    smooth = [
        above for above, below in lines if _turning(tape, axis, domain, below, above) <= SMOOTH
    ]
    return np.array(smooth, dtype=np.float64)


def _turning(tape: Tape, axis: int, domain: Domain, below: float, above: float) -> float:
    """Return the largest angle between the normals on both sides of a line, at sampled points."""
    other = lines_of(tape, 1 - axis, np.array(domain[1 - axis]), PLACES)
    along = (0.5 * (other[1:] + other[:-1])).ravel()
    step = 4.0 * np.spacing(max(map(abs, domain[axis])))
    normals = []
    for end in (below - step, above + step):
        places = [np.full_like(along, end), along]
        jets = jets_of(tape, *(places if axis == 0 else places[::-1]))
        normal = np.cross(jets[:, 1], jets[:, 2])
        with np.errstate(invalid="ignore", divide="ignore"):
            normals.append(normal / np.linalg.norm(normal, axis=1, keepdims=True))
    return float(np.fmax.reduce(np.linalg.norm(normals[1] - normals[0], axis=1), initial=0.0))
