"""Unobstructed and visible samples: rays tested against a mesh."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.errors import InputError
from ...runtime.base.extras import check_extra, from_extra
from ...runtime.base.scales import scale_to_one
from .mesh import Mesh

PURPOSE = "a test with rays"
# Rays begin this far below the surface, relative to the obstacle's size, to hit an obstacle in
# contact.
BELOW = 1e-9
RAYS = 4096  # rays that are traced at once
# Rays to an eye begin at this multiple of the largest distance between points of the surface and
# its mesh.
TIMES_AWAY = 2.0


def check_rays() -> None:
    """Raise MissingExtraError if a library for rays is missing."""
    check_extra("trimesh", "rays", PURPOSE)
    check_extra("rtree", "rays", PURPOSE)


def unobstructed(points: Array, normals: Array, distance: float, obstacle: object) -> Flags:
    """Return a mask (N,) of the points whose rays do not enter the obstacle, a closed mesh.

    The rays run along the normals (N, 3) for the given distance. A ray may leave the obstacle
    through the surface on which it begins, since chords of the mesh lie on either side of the
    surface.
    """
    solid, middle, scale = _solid(obstacle, closed=True)
    points, distance = (points - middle) * scale, distance * scale
    step = BELOW * float(solid.extents.max())
    free = np.ones(len(points), dtype=np.bool_)
    begins = points - step * normals
    for rays, triangles, far in _hits(solid, begins, normals):
        enters = np.einsum("kx,kx->k", solid.face_normals[triangles], normals[rays]) < 0.0
        free[rays[enters & (far <= distance + step)]] = False
    return free


def visible(points: Array, normals: Array, to_eye: Array, surface: Mesh) -> Flags:
    """Return a mask (N,) of the points of a silhouette that a mesh of the surface does not hide.

    `to_eye` (N, 3) are vectors to the eye, at least long enough to leave the mesh. Rays begin on
    both sides of the surface, farther from it than the mesh is. A point is seen if one of its rays
    is free: the surface around a point does not hide the point.
    """
    trimesh = from_extra("trimesh", "rays", PURPOSE)
    solid, middle, scale = _solid(surface, closed=False)
    points, to_eye = (points - middle) * scale, to_eye * scale
    distance = np.linalg.norm(to_eye, axis=1)
    along = to_eye / distance[:, None]
    away = TIMES_AWAY * trimesh.proximity.closest_point(solid, points)[1].max()
    free = np.zeros(len(points), np.bool_)
    for side in (1.0, -1.0):
        seen = np.ones(len(points), np.bool_)
        for rays, _, far in _hits(solid, points + side * away * normals, along):
            seen[rays[far <= distance[rays]]] = False
        free |= seen
    return free


def _hits(solid: Any, begins: Array, along: Array) -> Iterator[tuple[Indices, Indices, Array]]:  # noqa: ANN401
    """Yield intersections of rays and a mesh: rays (k,), triangles (k,), and distances (k,).

    Rays and triangles are given by their indices, distances are measured along the rays.
    """
    for first in range(0, len(begins), RAYS):
        part = slice(first, first + RAYS)
        triangles, rays, places = solid.ray.intersects_id(
            begins[part], along[part], multiple_hits=True, return_locations=True
        )
        rays = first + rays
        ways = np.reshape(places, (-1, 3)) - begins[rays]
        yield rays, triangles, np.einsum("kx,kx->k", ways, along[rays])


def _solid(obstacle: object, closed: bool) -> tuple[Any, Array, float]:
    """Return a mesh of trimesh that traces rays in double precision, its centre and its scale.

    Raises InputError if the obstacle is open and should be closed. trimesh rounds coordinates to
    some decimals and merges equal points: so the mesh is moved to the origin and scaled to a size
    of about 1.
    """
    trimesh = from_extra("trimesh", "rays", PURPOSE)
    corners: Any = obstacle
    if not isinstance(obstacle, Mesh | trimesh.Trimesh):
        kind = type(obstacle).__name__
        raise InputError(f"by must be a part, a Mesh or a trimesh.Trimesh, not {kind}.")
    triangles = corners.triangles if isinstance(obstacle, Mesh) else corners.faces
    solid = trimesh.Trimesh(corners.vertices, triangles, process=False, use_embree=False)
    if closed and not (solid.is_watertight and solid.is_winding_consistent):
        raise InputError(
            "rays need a closed obstacle, whose triangles say which side is outside, and this one "
            "is open; give the whole part, or a closed mesh, as in unobstructed(5.0, by=part)."
        )
    middle, scale = solid.bounds.mean(axis=0), scale_to_one(float(solid.extents.max()))
    solid.vertices = (solid.vertices - middle) * scale
    return solid, middle, scale
