"""Lines u = const or v = const at which the curvature of a surface jumps, or K changes its sign.

Examples are joints of a plane and a fillet, knot lines, and parabolic curves that are parameter
lines. The lines of a grid stay half a step away from them.
"""

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.onto_surface.on_spline import OnSpline
from .lines import Axis

# Forms are compared along this number of lines.
ACROSS = 8
# A value may jump if it changes by more than JUMP between neighbouring points, relative to the
# largest value. It jumps if, in each of BISECTIONS bisections, one half of the interval still has
# more than the part REMAINS of this change.
JUMP, REMAINS, BISECTIONS = 0.1, 0.4, 8
# Intervals are divided at this part, and not at 1/2, which by symmetry may be exactly where K = 0.
HALF = 0.47
# K counts as changing its sign on a line if it does so along at least this part of the line.
ALONG = 0.75
# |K| below this part of its maximum counts as 0.
FLAT = 1e-6
# If there are more breaks than this, they are not joints, and are ignored.
MOST = 64


def breaks_along(geometry: OnSpline, axes: tuple[Axis, Axis], forms: Array, along: int) -> Array:
    """Return the positions of breaks along u (`along` is 0) or along v (`along` is 1).

    The unit is a cell of the spline. `forms` (7, k, l) are the fundamental forms at the midpoints
    of axes.
    """
    scales = np.array([forms[3].max(), forms[5].max(), np.abs(forms[6]).max()])
    if not scales.all():
        scales[scales == 0.0] = 1.0
    middles, others = axes[along].middles, axes[1 - along].middles
    chosen = np.arange(ACROSS) * len(others) // ACROSS
    values = _values(np.take(np.swapaxes(forms, 1, 2) if along == 0 else forms, chosen, 1), scales)
    changes = _changes(values[:, :, :-1], values[:, :, 1:])
    places = np.flatnonzero(changes > JUMP)
    low, high, change = middles[places], middles[places + 1], changes[places]
    ends = values[:, :, places], values[:, :, places + 1]
    for _ in range(BISECTIONS):
        if len(low) == 0:
            return low
        half = low + HALF * (high - low)
        found = _values(_forms_at(geometry, half, others[chosen], along), scales)
        first, second = _changes(ends[0], found), _changes(found, ends[1])
        later = second > first
        low, high = np.where(later, half, low), np.where(later, high, half)
        ends = np.where(later, found, ends[0]), np.where(later, ends[1], found)
        real = np.maximum(first, second) > REMAINS * change
        low, high, change = low[real], high[real], change[real]
        ends = ends[0][:, :, real], ends[1][:, :, real]
    return (low + high) / 2.0 if len(low) <= MOST else low[:0]


def _forms_at(geometry: OnSpline, places: Array, others: Array, along: int) -> Array:
    """Return the fundamental forms (7, l, k) where k lines cross l lines of the other parameter.

    The lines are at the values `places` (k,) of the parameter of index `along`, and at the values
    `others` (l,) of the other parameter.
    """
    lines = np.meshgrid(others, places, indexing="ij")
    cells = np.stack(lines[::-1] if along == 0 else lines, axis=-1).reshape(-1, 2)
    return geometry.forms(cells).T.reshape(7, len(others), len(places))


def _values(forms: Array, scales: Array) -> Array:
    """Return values (3, l, k) that may jump: the turning of the normal along u and v, and K.

    The rates of turning are divided by `scales`; K is replaced by its sign, or by a number near 0
    if |K| is tiny.
    """
    signs = forms[6] / (np.abs(forms[6]) + FLAT * scales[2])
    return np.stack([np.sqrt(forms[3] / scales[0]), np.sqrt(forms[5] / scales[1]), signs])


def _changes(low: Array, high: Array) -> Array:
    """Return the changes (k,) from `low` to `high`, both (3, l, k).

    The changes of each of the three values are averaged over l; the largest of the three means
    counts. K counts as changing its sign only if it does so along most of a line; see `ALONG`.
    """
    along_u, along_v, signs = np.abs(high - low).mean(axis=1)
    return np.maximum(np.maximum(along_u, along_v), np.where(signs < 2.0 * ALONG, 0.0, signs))
