"""Several curves or regions of solutions for one normal, whose bounding boxes overlap.

Bisection encloses the solutions for a normal in small boxes. The bounding boxes of different curves
may overlap, as those of concentric circles do, but small boxes that touch contain the same curve.
"""

from collections.abc import Callable

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..spline.joints import linked
from .components import Undecided, shift_to

Jets = Callable[[Array, Array], Array]

# A box counts as thin if its width is at most THIN times its length, both relative to the domain.
THIN = 1e-3
# The small boxes are drawn on a raster of SIDE × SIDE cells. Curves and regions closer than two
# cells count as one.
SIDE = 256
# The point of a curve is reached from at most STARTS of its boxes.
STARTS = 65
# There are at most STEPS Gauss–Newton steps to a point with a given normal. They end when the
# angles between the normal and the tangents differ from 90° by at most SETTLED; points at which
# these angles still differ by more than NEAR are left out. An eigenvalue of the Hessian counts as 0
# if it is less than SINGULAR times the other one.
STEPS, SETTLED, NEAR, SINGULAR = 16, 1e-14, 1e-9, 1e-4


def are_thin(boxes: Array, sizes: Array) -> Flags:
    """Return whether boxes (k, 4) are thin along u, and along v (k, 2), in a domain of `sizes`."""
    shares = np.ptp(boxes.reshape(-1, 2, 2), axis=2) / sizes
    return shares <= THIN * shares.max(axis=1, keepdims=True)


def separated(one: Undecided, boxes: Array, periods: Array, normal: Array, jets: Jets) -> Undecided:
    """Return a row for each curve or region in the bounding box of `one`, which has one row.

    `boxes` (k, 2, 2) are the middles and half the widths of the small boxes for `normal`. `jets`
    returns the 2-jets of the surface at u and v.
    """
    low, high = one.boxes.reshape(2, 2).T
    middles, halves = boxes[:, 0], boxes[:, 1]
    middles = middles + shift_to(middles, 0.5 * (low + high), periods)
    own = ((middles >= low) & (middles <= high)).all(axis=1)
    if not own.any():
        return one
    middles, halves = middles[own], halves[own]
    around = (periods > 0.0) & (high - low >= periods)
    owner = _connected(middles - halves - low, middles + halves - low, high - low, around)
    rows = [owner == k for k in range(owner.max() + 1)]
    if len(rows) < 2:
        return one
    hulls = np.array([_hull(middles[x], halves[x]) for x in rows])
    points = np.array(
        [
            _point(middles[x], hull, one.boxes[0], normal, jets)
            for x, hull in zip(rows, hulls, strict=True)
        ]
    )
    # Boxes beside a curve may count as boxes on it: then the steps lead to boxes of another set.
    there = [owner[(np.abs(middles - x) <= halves).all(axis=1)] for x in points]
    keep = [k for k, x in enumerate(there) if len(x) == 0 or k in x]
    more = Undecided._make(np.repeat(x, len(keep), axis=0) for x in one)
    return more._replace(boxes=hulls[keep].reshape(-1, 4), uv=points[keep])


def _connected(low: Array, high: Array, size: Array, around: Flags) -> Indices:
    """Return the connected set of each box with the bounds `low`, `high` (k, 2), from 0 to `size`.

    `around` (2,) is True along an axis whose ends are joined.
    """
    from scipy.ndimage import label  # imported late: most normals have no such box

    first, last = (np.clip(SIDE * x / size, 0, SIDE - 1).astype(np.int64) for x in (low, high))
    cells = np.zeros((SIDE, SIDE), np.bool_)
    for (i, j), (m, n) in zip(first.tolist(), last.tolist(), strict=True):
        cells[i : m + 1, j : n + 1] = True
    found: tuple[Indices, int] = label(cells, np.ones((3, 3)))  # pyright: ignore
    sets, count = found
    links = [np.empty((2, 0), np.int64)]
    for axis in np.flatnonzero(around).tolist():
        start, end = np.take(sets, 0, axis), np.take(sets, -1, axis)
        links += [np.stack([start, np.roll(end, x)]) for x in (-1, 0, 1)]
    one, other = np.concatenate(links, axis=1)
    both = (one > 0) & (other > 0)
    owner = linked(count, one[both] - 1, other[both] - 1)[1]
    return owner[sets[tuple(first.T)] - 1]


def _hull(middles: Array, halves: Array) -> Array:
    """Return the bounding box (2, 2) of boxes: bounds of u, and of v."""
    return np.stack([(middles - halves).min(axis=0), (middles + halves).max(axis=0)], axis=1)


def _point(middles: Array, hull: Array, box: Array, normal: Array, jets: Jets) -> Array:
    """Return a point (2,) with the normal in a box (4,), in the `hull` of small boxes if possible.

    Gauss–Newton steps lead to it from the `middles` (k, 2) of the small boxes.
    """
    starts = middles[:: len(middles) // STARTS + 1]
    found = with_normal(starts, box.reshape(2, 2).T, normal, jets)
    low, high = hull.T
    own = found[((found >= low) & (found <= high)).all(axis=1)]
    best = own if len(own) else found if len(found) else starts
    return best[len(best) // 2]


def with_normal(uv: Array, ends: Array, normal: Array, jets: Jets) -> Array:
    """Return the parameters (k, 2) of points in a box that have `normal`.

    Gauss–Newton steps lead to them from the parameters `uv`. `ends` (2, 2) are the lowest u and v
    of the box, and the highest ones.
    """
    uv, scale = uv.copy(), np.ptp(ends, axis=0)
    for _ in range(STEPS):
        jet = jets(*uv.T.copy())
        slopes, lengths = jet[:, 1:3] @ normal, np.linalg.norm(jet[:, 1:3], axis=2)
        away = (np.abs(slopes) > SETTLED * lengths).any(axis=1)
        if not away.any():
            break
        second = (jet[away, 3:] @ normal)[:, [0, 1, 1, 2]].reshape(-1, 2, 2)
        inverse = np.linalg.pinv(second * np.outer(scale, scale), rcond=SINGULAR, hermitian=True)
        step = scale * np.einsum("kij,kj->ki", inverse, slopes[away] * scale)
        uv[away] = np.clip(uv[away] - step, *ends)
    jet = jets(*uv.T.copy())
    slopes, lengths = jet[:, 1:3] @ normal, np.linalg.norm(jet[:, 1:3], axis=2)
    settled = (np.abs(slopes) <= NEAR * lengths).all(axis=1)
    return uv[settled & (np.cross(jet[:, 1], jet[:, 2]) @ normal > 0.0)]
