"""From samples to a mesh: vertices, triangles between them, and flips that follow the normals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...generated import mesh as kernels
from ..errors import InputError
from ..spline import Spline, scale_to_one
from .mesh import Mesh
from .triangulation import neighbours, triangulations
from .vertices import Vertices

if TYPE_CHECKING:
    from ..samples import Samples

__all__ = ["mesh_of"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def mesh_of(samples: Samples, spline: Spline | None, angle: float | None) -> Mesh:
    """Return what `Samples.mesh` returns."""
    spline = samples.spline if spline is None else spline
    if spline is None:
        raise InputError(
            "these samples do not know the spline that was sampled (those from a file do not); "
            "give it, as in samples.mesh(gm.fit(surface))."
        )
    if not isinstance(spline, Spline):
        raise InputError(f"spline must be a Spline, not {type(spline).__name__}.")
    smallest = _smallest_cosine(angle)
    if not len(samples):
        raise InputError("there are no samples, and so there is nothing to make a mesh of.")
    vertices = Vertices.of(samples, spline)
    points, normals = _on_surface(vertices, samples, spline)
    triangles, sides, beyond = _triangulated(vertices, spline, angle is None)
    _complete(normals, triangles, sides)
    centred = points - points.mean(axis=0)
    centred *= scale_to_one(float(np.abs(centred).max()))
    kernels.flip_edges(centred, normals, triangles, sides, beyond)
    if angle is not None:
        cosines = np.empty(len(triangles))
        kernels.smallest_cosines(centred, normals, triangles, sides, cosines)
        triangles, sides = triangles[cosines >= smallest], sides[cosines >= smallest]
    elsewhere = sides[:, 0] < 0
    triangles[elsewhere] = triangles[elsewhere][:, [0, 2, 1]]
    used, corners = np.unique(triangles, return_inverse=True)
    uv = vertices.uv(spline)
    is_sample = vertices.sample >= 0
    uv[is_sample] = samples.uv[vertices.sample[is_sample]]
    return Mesh(
        points[used],
        normals[used],
        uv[used],
        corners.reshape(-1, 3).astype(np.int64),
        vertices.sample[used],
        name=spline.name,
    )


def _smallest_cosine(angle: float | None) -> float:
    if angle is None:
        return -1.0
    if isinstance(angle, bool) or not isinstance(angle, int | float | np.number):
        raise InputError(f"angle must be a number of degrees, not {angle!r}.")
    if not 0.0 < angle <= 180.0:
        raise InputError(f"angle must lie between 0 and 180 degrees, and is {angle}.")
    return math.cos(math.radians(float(angle)))


def _on_surface(vertices: Vertices, samples: Samples, spline: Spline) -> tuple[Array, Array]:
    """Return the points and unit normals of vertices; normals are NaN where there are none."""
    is_sample = vertices.sample >= 0
    own = vertices.sample[is_sample]
    u, v = vertices.uv(spline)[~is_sample].T
    points, normals = np.empty((2, len(vertices.sample), 3))
    points[is_sample], normals[is_sample] = samples.points[own], samples.normals[own]
    points[~is_sample], normals[~is_sample] = spline.evaluate(u, v), spline.normals(u, v)
    return points, normals


def _lengths(spline: Spline) -> Array:
    """Return the mean lengths of a spline along u and along v, 1 where they vanish."""
    inner = spline.coefficients[1:-1, 1:-1] * spline.scale
    found = [np.linalg.norm(np.diff(inner, axis=k), axis=2).mean() for k in (0, 1)]
    lengths = np.array(found) * spline.cells
    return np.where(lengths > 0.0, lengths, 1.0)


def _triangulated(
    vertices: Vertices, spline: Spline, to_be_closed: bool
) -> tuple[Indices, Indices, Indices]:
    """Return triangles, the sides on which they lie, and their neighbours.

    Raises InputError if they are to be closed and cannot: each edge in two triangles, or on an open
    side of the domain.
    """
    found = triangulations(vertices.places, vertices.is_free, spline.ends, _lengths(spline))
    for triangles, sides in found:
        beyond, is_complete = neighbours(triangles, ~vertices.is_free)
        if is_complete:
            return triangles, sides, beyond
    if not to_be_closed:
        return triangles, sides, beyond
    raise InputError(
        f"{len(vertices.sample):,} vertices are too few, or lie too far apart, for a whole mesh of "
        f"{spline.name!r}; take more samples or normals in all directions, or give angle=... to "
        "leave out triangles that span gaps."
    )


def _complete(normals: Array, triangles: Indices, sides: Indices) -> None:
    """Give vertices that have no normal, such as poles, the mean of those round them.

    A normal is 0 where that does not help.
    """
    lacking = ~np.isfinite(normals).all(axis=1)
    normals[lacking] = 0.0
    if not lacking.any():
        return
    round_it = lacking[triangles].any(axis=1)
    corners, side = triangles[round_it], sides[round_it, :, None]
    sums = np.zeros_like(normals)
    np.add.at(sums, corners, side * (side * normals[corners]).sum(axis=1, keepdims=True))
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    sums /= np.where(lengths > 0.0, lengths, 1.0)
    normals[lacking] = sums[lacking]
