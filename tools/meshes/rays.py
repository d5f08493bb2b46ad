"""Unobstructed and visible points: rays tested against a mesh."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.errors import InputError
from ...runtime.base.scales import scale_to_one
from .kernels.rays import Tree, find_first_hits
from .links import is_closed
from .mesh import Mesh

# Rays begin this far below the surface, relative to the obstacle's size, to hit an obstacle in
# contact. Because of rounding, the cosine between a ray and the normal may be as low as −BELOW.
BELOW = 1e-9
# Rays to an eye begin at this multiple of the largest distance between points of the surface and
# its mesh.
TIMES_AWAY = 2.0
# A leaf of the tree has from LEAF to 2 · LEAF triangles, or fewer if there are fewer in all.
LEAF = 4


@dataclass(frozen=True, eq=False)
class Obstacle:
    """Triangles against which rays are tested, moved to the origin and scaled to about 1.

    They are `closed` if each edge is in two triangles, which traverse it in opposite directions.
    """

    tree: Tree
    middle: Array
    scale: float
    size: float
    closed: bool

    @classmethod
    def of(cls, vertices: Array, triangles: Indices) -> Obstacle:
        """Return the triangles (T, 3) between vertices (M, 3) as an obstacle."""
        corners, closed = vertices[triangles], is_closed(triangles, len(vertices))
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        middle, scale = (low + high) / 2.0, scale_to_one(float((high - low).max()))
        size = scale * float((high - low).max())
        tree = _tree_of((corners - middle) * scale, BELOW * size)
        return cls(tree, middle, scale, size, closed)

    def scaled(self, points: Array) -> Array:
        """Return points (N, 3) moved and scaled as the triangles."""
        return (points - self.middle) * self.scale

    def are_free(self, points: Array, along: Array, distance: float) -> Flags:
        """Return a mask (N,) of the points whose rays do not enter the obstacle, which is closed.

        The rays run along unit vectors (N, 3) for the given distance. A ray may leave the obstacle
        through the surface on which it begins, since chords of the mesh lie on either side of the
        surface.
        """
        below = BELOW * self.size
        most = np.full(len(points), distance * self.scale + below)
        return np.isinf(self.hits(self.scaled(points) - below * along, along, most))

    def hits(self, begins: Array, along: Array, most: Array, both_sides: bool = False) -> Array:
        """Return how far rays (N, 3) run, at most (N,), until they meet a triangle from outside.

        Without such a triangle it is infinite. With `both_sides` triangles count that are met from
        inside, too. All lengths are scaled.
        """
        found = np.empty(len(begins))
        find_first_hits(self.tree, begins, along, most, both_sides, found)
        return found


@dataclass(frozen=True, eq=False)
class Free:
    """The condition that rays from points do not enter an obstacle within a distance.

    The rays run along an axis or, if it is None, along the normals.
    """

    obstacle: Obstacle
    axis: Array | None
    distance: float
    error = 0.0

    def holds(self, points: Array, normals: Array) -> Flags:
        """Return whether the rays from points (k, 3) with normals (k, 3) are free.

        Rays that begin towards the inner side of the surface are not.
        """
        along = normals if self.axis is None else np.broadcast_to(self.axis, normals.shape)
        found = np.einsum("kx,kx->k", normals, along) >= -BELOW
        found[found] = self.obstacle.are_free(points[found], along[found], self.distance)
        return found

    def may_change(self, points: Array, radii: Array) -> None:
        """Return None: where shadows end is not known."""


def obstacle_from(given: Any) -> Obstacle:  # noqa: ANN401
    """Return a mesh of this package or of trimesh as an obstacle; InputError for other objects."""
    trimesh = sys.modules.get("trimesh")
    if isinstance(given, Mesh):
        return Obstacle.of(given.vertices, given.triangles)
    if trimesh is not None and isinstance(given, trimesh.Trimesh):
        return Obstacle.of(np.asarray(given.vertices), np.asarray(given.faces))
    kind = type(given).__name__
    raise InputError(f"by must be a part, a Mesh or a trimesh.Trimesh, not {kind}.")


def visible(points: Array, normals: Array, to_eye: Array, bends: Array, surface: Mesh) -> Flags:
    """Return a mask (N,) of the points of a silhouette that a mesh of the surface does not hide.

    `to_eye` (N, 3) are vectors to the eye, at least long enough to leave the mesh. They are tangent
    to the surface, and rays along them begin farther from the surface than the mesh is, on the side
    from which the surface bends away. It bends towards the normal where `bends` (N,) are positive,
    and away from the normal where they are negative. At flat points (0 or NaN) rays begin on both
    sides. A point is seen if one of its rays is free.
    """
    solid = Obstacle.of(surface.vertices, surface.triangles)
    points, to_eye = solid.scaled(points), to_eye * solid.scale
    distance = np.linalg.norm(to_eye, axis=1)
    along = to_eye / distance[:, None]
    first, last = np.moveaxis(surface.vertices[surface.edges], 1, 0)
    longest = np.linalg.norm(last - first, axis=1).max() * solid.scale + 0.0 * distance
    both = [solid.hits(points, side * normals, longest, both_sides=True) for side in (1.0, -1.0)]
    nearest = np.min(both, axis=0)
    away = TIMES_AWAY * nearest[np.isfinite(nearest)].max(initial=0.0)
    seen = np.zeros(len(points), np.bool_)
    for side in (1.0, -1.0):
        rows = ~(side * bends > 0.0)
        begins = points[rows] + side * away * normals[rows]
        seen[rows] |= np.isinf(solid.hits(begins, along[rows], distance[rows], both_sides=True))
    return seen


def _tree_of(triangles: Array, margin: float) -> Tree:
    """Sort triangles (T, 3, 3) into a tree whose boxes are larger by a margin, for rounding.

    Each node is halved along the longest side of the box around the centres of its triangles. The
    last triangle is repeated, so that all leaves have the same number of triangles.
    """
    leaves = 1
    while len(triangles) >= 2 * LEAF * leaves:
        leaves *= 2
    size = -(-len(triangles) // leaves)
    order = np.minimum(np.arange(leaves * size), len(triangles) - 1)[None]
    centres = triangles.mean(axis=1)
    while len(order) < leaves:
        inside = centres[order]
        axis = np.ptp(inside, axis=1).argmax(axis=1)
        places = np.take_along_axis(inside, axis[:, None, None], axis=2)[:, :, 0]
        halved = np.argpartition(places, order.shape[1] // 2, axis=1)
        order = np.take_along_axis(order, halved, axis=1).reshape(2 * len(order), -1)
    corners = triangles[order.ravel()]
    boxes, ends = np.empty((2 * leaves, 2, 3)), corners.reshape(leaves, -1, 3)
    low, high = ends.min(axis=1) - margin, ends.max(axis=1) + margin
    for first in (leaves >> k for k in range(leaves.bit_length())):
        boxes[first : 2 * first] = np.stack([low, high], axis=1)
        if first > 1:
            low, high = low.reshape(-1, 2, 3).min(axis=1), high.reshape(-1, 2, 3).max(axis=1)
    return Tree(corners, boxes)
