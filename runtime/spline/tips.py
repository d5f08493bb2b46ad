"""Tips of splines: edges of patches that are collapsed to a point, as at the apex of a cone.

A quadratic patch with such an edge is developable: its normals depend only on one parameter, the
distance from the tip. Such a patch has no samples: its Gaussian image is a curve, and rounding
errors decide which other normals it has. Smooth poles, which have one normal, are not tips.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..base.kept import kept
from ..directions.unit import unit_or_zero
from .joints import EDGES, merged_points
from .nets import AnySpline, NetSpline
from .spline import Spline

# Points of a surface within this distance, relative to its size, count as one point.
SAME_POINT = 1e-9


class Tips(NamedTuple):
    """The tips of a spline, at `points` (T, 3), and the patches at tips as flags (patches,).

    A `collapsed` patch has an edge that is collapsed to a tip. A `touching` patch has a corner at a
    tip or, on a grid, is in a cell beside a tip. Points within the distance `same` of a tip count
    as the tip.
    """

    points: Array
    collapsed: Flags
    touching: Flags
    same: float

    def hold(self, points: NDArray[np.floating]) -> Flags:
        """Return whether points (k, 3) are tips, as booleans (k,)."""
        away = points[:, None] - self.points
        return (np.linalg.norm(away, axis=2) <= self.same).any(axis=1)


def is_point(spline: Spline, axis: int, end: int) -> bool:
    """Return whether the lower (end 0) or upper (1) side of u (axis 0) or v (1) is collapsed."""
    return are_one(_side(spline, axis, end), _size(spline))


def are_one(points: Array, size: float) -> bool:
    """Return whether points (k, 3) count as one point, relative to the `size` of their surface."""
    return bool(np.ptp(points, axis=0).max() <= SAME_POINT * size)


def collapsed_sides(spline: Spline) -> list[tuple[int, int]]:
    """Return the axis and the end, 0 or 1, of each open side that is collapsed to a point."""
    return [
        (axis, end)
        for axis, end in np.ndindex(2, 2)
        if spline.boundary[axis][end] == "open" and is_point(spline, axis, end)
    ]


def tips_of(spline: AnySpline) -> Tips | None:
    """Return the tips of a spline, cached with the spline, or None if it has no tips."""

    def make() -> Tips | None:
        return _of_nets(spline) if isinstance(spline, NetSpline) else _of_grid(spline)

    return kept(spline, Tips, make)


def _of_grid(spline: Spline) -> Tips | None:
    """Return the tips of a spline on a grid of cells: its collapsed open sides."""
    sides = collapsed_sides(spline)
    if not sides:
        return None
    flags = np.zeros((2, *spline.cells, 4), np.bool_)
    for axis, end in sides:
        row = np.moveaxis(flags, 1 + axis, 1)[:, -end]
        row[0, :, (3, 1)[end] if axis == 0 else (0, 2)[end]] = True
        row[1] = True
    points = np.array([_side(spline, *x)[0] for x in sides])
    return Tips(points, flags[0].ravel(), flags[1].ravel(), SAME_POINT * _size(spline))


def _of_nets(spline: NetSpline) -> Tips | None:
    """Return the tips of a spline of nets.

    Tips are collapsed edges at which the normals of the patches differ, unlike at smooth poles.
    """
    nets, size = spline.control_nets, float(np.ptp(spline.control_nets, axis=(0, 1)).max())
    rows = [[x.start, x.middle, x.end] for x in EDGES]
    patch, edge = np.nonzero(np.ptp(nets[:, rows], axis=2).max(axis=2) <= SAME_POINT * size)
    if len(patch) == 0:
        return None
    beside = np.array([[x.start, x.start_beside, x.end_beside] for x in EDGES])[edge]
    start, first, second = np.moveaxis(nets[patch[:, None], beside], 1, 0)
    normals = unit_or_zero(np.cross(first - start, second - start))
    points, group = merged_points(start)
    firsts = np.unique(group, return_index=True)[1]
    cosines = np.ones(len(points))
    np.minimum.at(cosines, group, np.einsum("kx,kx->k", normals, normals[firsts][group]))
    sharp = cosines < np.cos(np.radians(spline.smooth))
    if not sharp.any():
        return None
    collapsed = np.zeros(len(nets), np.bool_)
    collapsed[patch[sharp[group]]] = True
    tips = Tips(points[sharp], collapsed, np.zeros(0, np.bool_), SAME_POINT * size)
    corners = nets[:, :3].reshape(-1, 3)
    return tips._replace(touching=tips.hold(corners).reshape(-1, 3).any(axis=1))


def _side(spline: Spline, axis: int, end: int) -> Array:
    """Return points (k, 3) on a side: at the corners of cells, and halfway between these."""
    along = np.linspace(*spline.domain[1 - axis], 2 * spline.cells[1 - axis] + 1)
    place = np.full_like(along, spline.domain[axis][end])
    return spline.evaluate(*((place, along) if axis == 0 else (along, place)))


def _size(spline: Spline) -> float:
    return float(np.ptp(spline.coefficients, axis=(0, 1)).max())
