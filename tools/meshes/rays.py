"""Unobstructed samples: rays along normals, tested against a closed mesh."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.errors import InputError
from ...runtime.base.extras import check_extra, from_extra
from ...runtime.base.scales import scale_to_one
from .mesh import Mesh

__all__ = ["check_rays", "unobstructed"]

PURPOSE = "a test with rays"
# Rays begin this far below the surface, relative to the obstacle's size, to hit an obstacle in
# contact.
BELOW = 1e-9
RAYS = 4096  # traced at once


def check_rays() -> None:
    """Raise MissingExtraError if a library for rays is missing."""
    check_extra("trimesh", "rays", PURPOSE)
    check_extra("rtree", "rays", PURPOSE)


def unobstructed(points: Array, normals: Array, distance: float, obstacle: object) -> Flags:
    """Return a mask (N,) of rays of this length that do not enter the obstacle, a closed mesh.

    A ray may leave the obstacle: through the surface on which it begins, whose mesh has chords on
    either side of the surface.
    """
    solid = _solid(obstacle)
    # trimesh rounds coordinates to some decimals, and merges equal points: sizes are scaled to
    # about 1.
    middle, size = solid.bounds.mean(axis=0), float(solid.extents.max())
    scale = scale_to_one(size)
    solid.vertices = (solid.vertices - middle) * scale
    points, distance = (points - middle) * scale, distance * scale
    step = BELOW * scale * size
    free = np.ones(len(points), dtype=np.bool_)
    for first in range(0, len(points), RAYS):
        along = normals[first : first + RAYS]
        begins = points[first : first + RAYS] - step * along
        triangles, rays, places = solid.ray.intersects_id(
            begins, along, multiple_hits=True, return_locations=True
        )
        along = along[rays]
        far = np.einsum("kx,kx->k", np.reshape(places, (-1, 3)) - begins[rays], along)
        enters = np.einsum("kx,kx->k", solid.face_normals[triangles], along) < 0.0
        free[first + rays[enters & (far <= distance + step)]] = False
    return free


def _solid(obstacle: object) -> Any:  # noqa: ANN401
    """Return a mesh of trimesh that traces rays in double precision; InputError if it is open."""
    trimesh = from_extra("trimesh", "rays", PURPOSE)
    corners: Any = obstacle
    if not isinstance(obstacle, Mesh | trimesh.Trimesh):
        kind = type(obstacle).__name__
        raise InputError(f"by must be a part, a Mesh or a trimesh.Trimesh, not {kind}.")
    triangles = corners.triangles if isinstance(obstacle, Mesh) else corners.faces
    solid = trimesh.Trimesh(corners.vertices, triangles, process=False, use_embree=False)
    if not (solid.is_watertight and solid.is_winding_consistent):
        raise InputError(
            "rays need a closed obstacle, whose triangles say which side is outside, and this one "
            "is open; give the whole part, or a closed mesh, as in unobstructed(5.0, by=part)."
        )
    return solid
