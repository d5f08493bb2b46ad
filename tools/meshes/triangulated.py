"""Triangles through samples and added vertices, with what they are improved by."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError
from .links import neighbours
from .mesh import Mesh, cosines_of, scaled, tangents_of

__all__ = ["Triangulated", "too_few"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Triangulated:
    """Samples and added vertices in a triangulation of the parameter domain.

    `sample` and `is_free` are those of `Vertices`; `triangles`, `sides` and `neighbours` (k, 3)
    those of `kernels.flips`, which changes them in place; `is_node` says which vertices are samples
    on a graded grid.
    """

    name: str
    uv: Array
    sample: Indices
    is_free: NDArray[np.bool_]
    points: Array
    normals: Array
    triangles: Indices
    sides: Indices
    neighbours: Indices
    is_node: NDArray[np.bool_]

    def cosines(self) -> Array:
        """Return the smallest cosine of each triangle and the normals at its corners."""
        return cosines_of(self.points, self.normals, self.triangles, self.sides)

    def tangents(self) -> Array:
        """Return the tangent of the smallest angle of each triangle."""
        return tangents_of(self.points, self.triangles)

    def arrays(self) -> tuple[Array, Array, Indices, Indices, Indices]:
        """Return what kernels take: points, normals, triangles, sides, and neighbours."""
        return scaled(self.points), self.normals, self.triangles, self.sides, self.neighbours

    def within(self, angle: float) -> Triangulated:
        """Leave out the triangles that deviate by more than `angle` degrees from normals.

        Raises InputError if an edge is then in more than two triangles.
        """
        chosen = self.cosines() >= math.cos(math.radians(angle))
        if not chosen.any():
            raise InputError(
                f"every triangle deviates by more than {angle:g} degrees from a normal at a "
                "corner; allow a larger angle, or take more samples."
            )
        triangles = self.triangles[chosen]
        adjacent, is_surface = neighbours(triangles, np.ones(len(self.points), dtype=bool))
        if not is_surface:
            raise too_few(len(self.points), self.name)
        return replace(self, triangles=triangles, sides=self.sides[chosen], neighbours=adjacent)

    def chosen(self, which: NDArray[np.bool_]) -> Triangulated:
        """Choose triangles; the others are neighbours of none of them."""
        number = np.cumsum(which) - 1
        adjacent = self.neighbours[which]
        adjacent = np.where(adjacent >= 0, number[adjacent], -1)
        return replace(
            self, triangles=self.triangles[which], sides=self.sides[which], neighbours=adjacent
        )

    def mesh(self, samples: int) -> Mesh:
        """Return the mesh of a number of samples."""
        triangles, sides = self.triangles, self.sides
        reverse = sides[:, :1] < 0
        triangles, sides = (
            np.where(reverse, x[:, [0, 2, 1]], x) for x in (triangles, sides * sides[:, :1])
        )
        is_used = np.zeros(len(self.points), dtype=bool)
        is_used[triangles] = True
        used, corners = np.flatnonzero(is_used), (np.cumsum(is_used) - 1)[triangles]
        return Mesh(
            self.points[used],
            self.normals[used],
            self.uv[used],
            corners,
            self.sample[used],
            name=self.name,
            sides=sides,
            left_out=samples - int(np.count_nonzero(self.sample[used] >= 0)),
        )


def too_few(count: int, name: str) -> InputError:
    """Return the error of a mesh of the whole that cannot be made."""
    return InputError(
        f"the vertices on {name!r}, {count:,} in all, are too few, or leave too large gaps, for "
        "a mesh of the whole; take more samples or normals in all directions, or leave out the "
        "triangles across gaps, by angle=... of mesh() or --deviation of the command."
    )
