"""Surfaces moved by affine maps, or with reversed normals: points, derivatives, grids."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..base.aliases import Array
from ..base.checks import finite_array
from ..base.errors import InputError
from ..base.evaluation import returned
from ..domain.domain import Boundary, Interval
from ..tape.kernels.points import Tape
from ..tape.tapes import moved_tape
from .derivatives import Differences, Differentiable
from .surface_values import SurfaceValues


@dataclass(frozen=True, eq=False)
class AffineMap:
    """The map x → matrix x + shift."""

    matrix: Array
    shift: Array

    def after(self, first: AffineMap) -> AffineMap:
        """Return the composition: `first`, then this map."""
        return AffineMap(self.matrix @ first.matrix, self.directions(first.shift) + self.shift)

    @property
    def reflects(self) -> bool:
        """Whether the determinant is negative."""
        return bool(np.linalg.slogdet(self.matrix)[0] < 0.0)

    def points(self, points: Array) -> Array:
        """Return the images of points (..., 3)."""
        return self.directions(points) + self.shift

    def directions(self, vectors: Array) -> Array:
        """Return the images of vectors (..., 3), such as derivatives."""
        # One product of long matrices: NumPy is ten times slower with stacks of short ones.
        product = vectors.reshape(-1, 3) @ np.ascontiguousarray(self.matrix.T)
        return product.reshape(vectors.shape)


IDENTITY = AffineMap(np.eye(3), np.zeros(3))


def affine_map(matrix: ArrayLike) -> AffineMap:
    """Return the map of a matrix (3, 3) or (4, 4); InputError if it is not affine, or singular."""
    array = finite_array(matrix, None, "matrix")
    if array.shape not in ((3, 3), (4, 4)):
        raise InputError(f"matrix must have the shape (3, 3) or (4, 4), not {array.shape}.")
    if array.shape == (4, 4) and (array[3] != (0.0, 0.0, 0.0, 1.0)).any():
        raise InputError(
            f"the last row of matrix must be (0, 0, 0, 1), not {array[3]}: "
            "projective maps are not affine."
        )
    linear = array[:3, :3]
    largest = np.abs(linear).max()
    if largest == 0.0 or np.linalg.matrix_rank(linear / largest) < 3:
        raise InputError("matrix is singular: it maps space onto a plane, a line or a point.")
    return AffineMap(linear.copy(), array[:3, 3].copy() if len(array) == 4 else np.zeros(3))


@dataclass(frozen=True, eq=False)
class Moved(Differentiable):
    """The function of a surface moved by an affine map.

    If `turned`, u is also reversed: u → u0 + u1 − u, where `ends` are u0 and u1.
    """

    surface: SurfaceValues
    map: AffineMap
    turned: bool
    ends: Interval

    @classmethod
    def of(cls, surface: SurfaceValues) -> Moved:
        """Return the function of a surface as a `Moved`, unchanged if it already is one."""
        if isinstance(surface.function, Moved):
            return surface.function
        return cls(surface, IDENTITY, False, surface.domain[0])

    def then(self, map_: AffineMap, turned: bool) -> Moved:
        """Return the function with a further map applied, and u reversed again if `turned`."""
        return replace(self, map=map_.after(self.map), turned=self.turned != turned)

    def __call__(self, u: Array, v: Array) -> Array:
        """Return the points (..., 3)."""
        label = f"the callable of surface {self.surface.name!r}"
        points = returned(self.surface.function, (self._own(u), v), (3,), label)
        return self.map.points(points)

    def jets(self, u: Array, v: Array) -> Array:
        """Return positions and derivatives (k, 6, 3)."""
        jets = self.map.directions(self.surface.unchecked_jets(self._own(u), v))
        jets[:, 0] += self.map.shift
        if self.turned:
            jets[:, 1::3] *= -1.0  # x_u and x_uv
        return jets

    def tape(self) -> Tape | None:
        """Return the tape of the surface, extended by the map; None if the surface has none."""
        own = self.surface.tape
        if own is None:
            return None
        ends = self.ends if self.turned else None
        return moved_tape(own, self.map.matrix, self.map.shift, ends)

    def differences(self, boundary: Boundary) -> Differences | None:
        """Return the differences of the moved function, if the surface has differences."""
        own = self.surface.differences
        if own is None:
            return None

        def evaluate(u: Array, v: Array) -> Array:
            return self.map.points(own.function(self._own(u), v))

        return replace(own, function=evaluate, boundary=boundary)

    def _own(self, u: Array) -> Array:
        """Return the parameters u of the surface before the reversal of u."""
        low, high = self.ends
        if not self.turned:
            return u
        return np.where(u == low, high, np.where(u == high, low, low + high - u))  # ends are exact


def moved_grid(grid: Array, boundary: Boundary, map_: AffineMap, turned: bool) -> Array:
    """Return the images of the points of a grid (m, n, 3), with u reversed if `turned`."""
    points = map_.points(grid)
    (along_u, _), (along_v, _) = boundary
    if not turned:
        return points
    if along_u in ("open", "pole"):
        return points[::-1].copy()
    points = np.roll(points[::-1], 1, axis=0)
    if along_u == "mirrored":  # u = 0 is now the other end of u, where rows are mirrored
        points[0] = points[0, ::-1] if along_v != "periodic" else np.roll(points[0, ::-1], 1, 0)
    return points
