"""Positions: parameter pairs scaled to the unit square, their shifts across seams, their points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...generated.mesh import border_spacing
from ...runtime.base.formula_calls import python_function
from ...runtime.domain.domain import Boundary, BoundaryCondition, closes
from ...runtime.spline.spline import Spline
from ...runtime.spline.tips import collapsed_sides

if TYPE_CHECKING:
    from scipy.spatial import KDTree

Array = NDArray[np.float64]

# A position within this distance of an open side or a pole, relative to the domain, counts as a
# position on the side or at the pole.
ON_SIDE = 1e-9
# The spacing of points on a boundary follows from the distance to the k-th nearest sample, with
# this k.
NEAREST = 4


def wrapped(
    positions: Array, boundary: Boundary, around: Array | None = None, together: bool = False
) -> Array:
    """Return positions (..., 2), shifted across seams into the unit square.

    If `around` is given, they are shifted to be nearest to these positions instead. With
    `together`, all positions are shifted like the first one.
    """
    positions = positions.copy()
    for axis in sorted((0, 1), key=lambda k: boundary[k][0] != "mirrored"):
        if closes(boundary[axis]):
            along, other = positions[:1, axis] if together else positions[..., axis], 1 - axis
            turns = np.floor(along) if around is None else np.rint(along - around[..., axis])
            positions[..., axis] -= turns
            if boundary[axis][0] == "mirrored":
                odd = np.mod(turns, 2.0) == 1.0
                positions[..., other] = np.where(
                    odd, 1.0 - positions[..., other], positions[..., other]
                )
    return positions


def uv_at(spline: Spline, positions: Array) -> Array:
    """Return the parameters (k, 2) at positions."""
    low, high = np.array(spline.domain).T
    return np.where(positions == 1.0, high, low + positions * (high - low))


def points_at(spline: Spline, positions: Array) -> Array:
    """Return the points (k, 3) of a spline at positions, times its scale."""
    return spline.evaluate(*uv_at(spline, positions).T) * spline.scale


def spacings_at(tree: KDTree, points: Array) -> Array:
    """Return spacings (k,) of vertices at points (k, 3), from the distances to nearby samples."""
    nearest = min(NEAREST, tree.n)
    distances = tree.query(points, k=nearest, workers=-1)[0].reshape(len(points), -1)[:, -1]
    return distances * python_function(border_spacing)(1.0, nearest)


def on_side(axis: int, place: float, t: Array) -> Array:
    """Return positions (k, 2) on the line u = `place` (axis 0) or v = `place` (axis 1).

    The other coordinate is t (k,).
    """
    fixed = np.full_like(t, place)
    return np.stack([fixed, t] if axis == 0 else [t, fixed], axis=1)


def boundary_of(spline: Spline, *, every: bool = False) -> Boundary:
    """Return the boundary conditions of a spline, with poles.

    A side collapsed to an apex counts as a pole, too, if the parameter along it is periodic; with
    `every`, also if not.
    """
    ends: list[list[BoundaryCondition]] = [[*kinds] for kinds in spline.boundary]
    for axis, place in collapsed_sides(spline):
        if every or spline.boundary[1 - axis][0] == "periodic":
            ends[axis][place] = "pole"
    return (ends[0][0], ends[0][1]), (ends[1][0], ends[1][1])
