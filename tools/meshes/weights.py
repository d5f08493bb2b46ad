"""The area of the surface assigned to each sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...generated.mesh import edge_over_surface
from ...generated.patch import NODE, power_form, tangents
from ...runtime.base.errors import SurfaceError
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.base.scales import scale_to_one
from ...runtime.base.trees import tree_of
from .mesh import Mesh, centred

if TYPE_CHECKING:
    from ...runtime.samples.samples import Samples

Array = NDArray[np.float64]


def area_weights(samples: Samples, angle: float | None) -> Array:
    """Return the weights of `Samples.weights`; areas at added vertices go to the nearest sample."""
    mesh = samples.mesh(angle=angle, prefer="normals")
    parts, triangles = _areas(mesh), mesh.triangles
    owner, added = mesh.sample_index.copy(), np.flatnonzero(mesh.sample_index < 0)
    if len(added):
        scale = scale_to_one(float(np.abs(samples.points).max()))
        regular = np.flatnonzero(samples._regular)
        tree = tree_of(samples.points[regular] * scale)
        owner[added] = regular[tree.query(mesh.vertices[added] * scale)[1]]
    return np.bincount(owner[triangles].ravel(), parts.ravel(), len(samples)).astype(np.float64)


def _areas(mesh: Mesh) -> Array:
    """Return the areas (T, 3) of the surface over triangles, divided among their corners."""
    points, scale = centred(mesh.vertices)
    areas = corner_areas(points * scale, mesh.normals, mesh.triangles, mesh.sides)
    limits = np.finfo(np.float64)
    # Areas smaller than the rounding error of the mean area need not be accurate.
    least = float(limits.eps * areas.sum()) / len(areas)
    with np.errstate(over="ignore", under="ignore"):
        smallest, total = least / scale / scale, float(areas.sum()) / scale / scale
    if (total > limits.max or smallest < limits.tiny) and least > 0.0:
        raise SurfaceError(
            f"the areas of {mesh.name!r} are too {'large' if scale < 1.0 else 'small'} for "
            "float64; choose another unit of length."
        )
    return areas / scale / scale


def corner_areas(
    points: Array, normals: Array, triangles: NDArray[np.int64], sides: NDArray[np.int64]
) -> Array:
    """Return the areas (k, 3) of a surface over triangles (k, 3), divided among their corners.

    The surface is a quadratic Bézier triangle, as perpendicular to the normals at the corners as
    possible; its area is divided by barycentric coordinates. If two normals are more than 90
    degrees apart, the triangle is flat. `sides` (k, 3) are 1 or −1: the side of the surface at a
    corner.
    """
    n = normals[triangles] * sides[..., None]
    n[(np.einsum("kix,kix->ki", n, np.roll(n, 1, axis=1)) < 0.0).any(axis=1)] = 0.0
    corners = [vector(points[triangles[:, k]]) for k in range(3)]
    at_corners = [vector(n[:, k]) for k in range(3)]
    middles = (
        python_function(edge_over_surface)(corners[i], corners[j], at_corners[i], at_corners[j])
        for i, j in ((0, 1), (0, 2), (1, 2))
    )
    patch = python_function(power_form)(*corners, *middles)
    areas = np.zeros(triangles.shape)
    for nodes in np.full((3, 3), NODE) + np.diag(np.full(3, 1.0 - 3.0 * NODE)):
        _, _, N = python_function(tangents)(patch, nodes[0], nodes[1])
        areas += np.linalg.norm(np.stack(N, axis=1), axis=1)[:, None] / 6.0 * nodes
    return areas
