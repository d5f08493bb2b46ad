"""Parameter lines of a grid, and lines where derivatives of a spline jump: joints and creases."""

from collections.abc import Sequence

import numpy as np

from ...generated.elementary import SPLINE
from ..base.aliases import Array
from ..base.scales import SAME_POINT
from ..domain.domain import Boundary, Domain
from ..tape.kernels.points import Tape
from ..tape.kernels.spline_bounds import SLACK
from ..tape.tapes import jets_of
from .kernels.cell_bounds import SMOOTH

# The normals on both sides of a line are compared at about this number of points.
PLACES = 64


def jumps_of(tape: Tape, axis: int, low: float, high: float) -> Array:
    """Return the values of u (axis 0) or v at which second derivatives of a spline may jump.

    Only values inside the interval [low, high] are returned.
    """
    x = tape.spline
    breaks, smooth = ((x.breaks_u, x.smooth_u), (x.breaks_v, x.smooth_v))[axis]
    rough = smooth < 2
    if not x.periods[axis, 1] > 0.0:  # beyond both ends, the spline continues as polynomials
        rough[:1] = rough[-1:] = False
    jumps = breaks[rough]
    (rows,) = np.nonzero(tape.operations[:, 0] == SPLINE)
    if axis == 0 and len(rows) > 0 and tape.operations[rows[0], 3] == 1:
        jumps = tape.numbers[rows[0], 0] - jumps  # u is reversed
    slack = SLACK * np.abs(breaks[[0, -1]]).sum() if len(breaks) > 0 else 0.0
    return jumps[(jumps > low + slack) & (jumps < high - slack)]


def lines_of(tape: Tape, axis: int, ends: Array, count: int) -> Array:
    """Return about `count` + 1 values of u (axis 0) or v for grid lines, with nearly equal spacing.

    The first and the last value are the `ends`; all values of `jumps_of` are included.
    """
    low, high = ends.tolist()
    pieces = np.unique([low, high, *jumps_of(tape, axis, low, high)])
    counts = np.maximum(1, np.round(count * np.diff(pieces) / (high - low))).astype(int)
    parts = [
        np.linspace(low, high, k + 1)[:-1]
        for low, high, k in zip(pieces[:-1], pieces[1:], counts, strict=True)
    ]
    return np.append(np.concatenate(parts), high)


def joints_and_creases(
    tape: Tape, axis: int, domain: Domain, boundary: Boundary
) -> tuple[Array, Array]:
    """Return the values of u (axis 0) or v of joints, and those of creases.

    Derivatives may jump at both, the normal only at creases. The seam of a periodic spline may be
    such a line. The normals on both sides of a line are compared at sampled points.
    """
    jumps = jumps_of(tape, axis, *domain[axis]).tolist()
    lines = _with_seam(tape, axis, domain, boundary, jumps)
    smooth = [_turning(tape, axis, domain, *x) <= SMOOTH for x in lines]
    above, is_joint = np.array([x for _, x in lines]), np.array(smooth, np.bool_)
    return above[is_joint], above[~is_joint]


def creases_of(
    tape: Tape, axis: int, domain: Domain, boundary: Boundary
) -> list[tuple[float, float]]:
    """Return the values of u (axis 0) or v just before and just after each crease.

    Both bounds of the parameter count as one line if the surface has the same points on them.
    """
    x = tape.spline
    smooth = (x.smooth_u, x.smooth_v)[axis]
    jumps = jumps_of(tape, axis, *domain[axis]).tolist() if (smooth == 0).any() else []
    # In bounds over boxes, a parameter closer to a knot than SLACK is on both sides of the knot.
    step = 4.0 * SLACK * sum(map(abs, domain[axis]))
    lines = _with_seam(tape, axis, domain, boundary, jumps)
    if boundary[axis] == ("open", "open") and _is_closed(tape, axis, domain):
        lines.append((domain[axis][1], domain[axis][0]))
    return [
        (below - step, above + step)
        for below, above in lines
        if _turning(tape, axis, domain, below, above) > SMOOTH
    ]


def _with_seam(
    tape: Tape, axis: int, domain: Domain, boundary: Boundary, jumps: Sequence[float]
) -> list[tuple[float, float]]:
    """For each line, return the parameter at its lower side and the parameter at its upper side.

    They are equal for the lines at `jumps`. At the seam of a periodic spline they are the upper and
    the lower bound of the domain.
    """
    lines = [(x, x) for x in jumps]
    if boundary[axis][0] == "periodic" and len(tape.spline.breaks_u) > 0:
        lines.append((domain[axis][1], domain[axis][0]))
    return lines


def _is_closed(tape: Tape, axis: int, domain: Domain) -> bool:
    """Return whether the surface has the same points at both ends of u (axis 0) or v."""
    along = lines_of(tape, 1 - axis, np.array(domain[1 - axis]), PLACES)
    ends = []
    for end in domain[axis]:
        places = [np.full_like(along, end), along]
        ends.append(jets_of(tape, *(places if axis == 0 else places[::-1]))[:, 0])
    size = np.ptp(np.concatenate(ends), axis=0).max()
    return bool(np.abs(ends[1] - ends[0]).max() <= SAME_POINT * size)


def _turning(tape: Tape, axis: int, domain: Domain, below: float, above: float) -> float:
    """Return the largest distance between the unit normals below and above a line.

    The normals are compared at sampled points of the line.
    """
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
