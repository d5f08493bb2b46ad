"""Triangles through samples and added vertices, with the arrays for their improvement."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.errors import InputError, shown
from ...runtime.base.progress import tell
from ...runtime.base.threads import interruptible
from ...runtime.base.tolerances import NO_AREA
from ...runtime.domain.domain import Boundary, Domain
from .kernels import collapses
from .kernels import flips as kernels
from .links import neighbours
from .mesh import Mesh, cosines_of, scaled, tangents_of

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Prefer = Literal["normals", "shape"]
KINDS = ("shape", "normals")

# For better shapes a triangle may deviate by at most this angle (degrees) from a normal at a
# corner, unless it already deviates more.
LARGEST_DEVIATION = 30.0
# Triangles with smaller angles (degrees) than these are removed, one bound after the other, until
# at most the share PART of the triangles away from boundaries has an angle below ENOUGH.
SMALLEST = (5.0, 10.0, 15.0, 20.0, 25.0)
PART, ENOUGH = 0.05, 25.0
# A bound of SMALLEST is given up if the mesh would have lost more than this share of its samples
# since the first bound. Where the spacing doubles from one sample to the next, no better
# triangles exist, and more and more edges would be collapsed.
MOST_LOST = 0.1
# The arrays that flips and collapses change.
CHANGED = ("triangles", "sides", "neighbours")
# The largest number of rounds for each bound: a collapse may make another one possible.
ROUNDS = 4
# A vertex in more triangles than this is not moved.
MOST_AROUND = 256


@dataclass(frozen=True, eq=False)
class Triangulated:
    """Samples and added vertices in a triangulation of the parameter domain.

    `sample` and `is_free` are explained in `Vertices`; `triangles`, `sides` and `neighbours` (k, 3)
    are explained in `kernels.flips`, which changes them in place. `is_node` marks vertices that are
    samples on a graded grid.
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
    domain: Domain
    boundary: Boundary

    def cosines(self) -> Array:
        """Return the smallest cosine (T,) between a triangle's normal and its corners' normals."""
        return cosines_of(self.points, self.normals, self.triangles, self.sides)

    def tangents(self) -> Array:
        """Return the tangent of the smallest angle of each triangle."""
        return tangents_of(self.points, self.triangles)

    def arrays(self) -> tuple[Array, Array, Indices, Indices, Indices]:
        """Return the arguments of kernels: points, normals, triangles, sides, and neighbours."""
        return scaled(self.points), self.normals, self.triangles, self.sides, self.neighbours

    def within(self, angle: float) -> Triangulated:
        """Remove the triangles that deviate by more than `angle` degrees from normals.

        Raises InputError if no triangle remains, no two of the remaining triangles share an edge,
        or an edge is in more than two of them.
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
        """Return the mesh of the chosen triangles; the removed ones are no longer neighbours."""
        number = np.cumsum(which) - 1
        adjacent = self.neighbours[which]
        adjacent = np.where(adjacent >= 0, number[adjacent], -1)
        return replace(
            self, triangles=self.triangles[which], sides=self.sides[which], neighbours=adjacent
        )

    def mesh(self, samples: int) -> Mesh:
        """Return the mesh, made from `samples` samples."""
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
            domain=self.domain,
            boundary=self.boundary,
        )


def too_few(count: int, name: str) -> InputError:
    """Return the error for a mesh that cannot cover the whole surface."""
    return InputError(
        f"the vertices on {name!r}, {count:,} in all, are too few, or leave too large gaps, as at "
        "borders of shadows, for a mesh of the whole; take more samples or normals in all "
        "directions, or leave out triangles that deviate from normals by more than an angle, as "
        "with angle=60."
    )


def checked_prefer(prefer: object) -> Prefer:
    """Return the checked argument `prefer`; InputError if it is unknown."""
    if not isinstance(prefer, str) or prefer not in KINDS:
        raise InputError(f"prefer must be 'shape' or 'normals', not {shown(prefer)}.")
    return prefer  # pyright: ignore[reportReturnType]


def improved(mesh: Triangulated, prefer: Prefer, angle: float) -> Triangulated:
    """Return a mesh with better triangles, by flips and, where these do not suffice, collapses.

    For "normals", vertices are removed only with triangles without area. The same holds for samples
    on a graded grid, whose cells may be long; other vertices on such a grid are removed only for
    angles below the smallest bound. No flip makes a triangle deviate from normals by more than
    `angle` degrees.
    """
    least = math.cos(math.radians(min(angle, LARGEST_DEVIATION)))
    flip_edges(mesh, prefer, least)
    has_grid = bool(mesh.is_node.any())
    if prefer == "normals" or has_grid:
        mesh = _without_small_angles(mesh, prefer, NO_AREA, least)
    if prefer == "normals":
        return mesh
    if has_grid:
        mesh = replace(mesh, is_free=mesh.is_free & ~mesh.is_node)
        return _without_small_angles(mesh, prefer, math.tan(math.radians(SMALLEST[0])), least)
    mesh = _without_small_angles(mesh, prefer, math.tan(math.radians(SMALLEST[0])), least)
    fewest = (1.0 - MOST_LOST) * _samples_in(mesh)
    for smallest in SMALLEST[1:]:
        if _has_good_shape(mesh):
            break
        before = replace(mesh, **{x: getattr(mesh, x).copy() for x in CHANGED})
        mesh = _without_small_angles(mesh, prefer, math.tan(math.radians(smallest)), least)
        if _samples_in(mesh) < fewest:
            return before
    return mesh


def flip_edges(mesh: Triangulated, prefer: Prefer, least: float = 1.0) -> int:
    """Flip edges until no flip improves triangles; return the number of flips.

    For "shape", cosines between triangles and normals may fall, but not below `least`.
    """
    by_shape = prefer == "shape"
    waiting = np.ones(len(mesh.triangles), dtype=np.bool_)
    given = (
        *mesh.arrays(), by_shape, least if by_shape else 0.0,
        np.arange(len(mesh.triangles)), waiting,
    )  # fmt: skip
    tell("flipping edges", lambda: 1.0 - waiting.mean())
    return interruptible(partial(kernels.flip_edges, *given))


def _samples_in(mesh: Triangulated) -> int:
    """Return the number of samples that are vertices of triangles."""
    used = np.zeros(len(mesh.sample), dtype=np.bool_)
    used[mesh.triangles] = True
    return int(np.count_nonzero(used & (mesh.sample >= 0)))


def _has_good_shape(mesh: Triangulated) -> bool:
    """Return whether few enough triangles away from boundaries have small angles."""
    inner = mesh.tangents()[(mesh.neighbours >= 0).all(axis=1)]
    few = math.tan(math.radians(ENOUGH))
    return bool(np.count_nonzero(inner < few) <= PART * len(inner))


def _without_small_angles(
    mesh: Triangulated, prefer: Prefer, smallest: float, least: float
) -> Triangulated:
    """Collapse edges at angles whose tangent is below `smallest`, and flip edges, if that helps."""
    for _ in range(ROUNDS):
        if mesh.tangents().min(initial=np.inf) >= smallest:
            break
        given = (*mesh.arrays(), mesh.is_free, smallest, least)
        around = np.empty(MOST_AROUND, dtype=np.int64)
        if not interruptible(partial(collapses.collapse_edges, *given, around)):
            break
        mesh = mesh.chosen(mesh.triangles[:, 0] >= 0)
        flip_edges(mesh, prefer, least)
    return mesh
