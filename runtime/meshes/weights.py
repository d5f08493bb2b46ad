"""The area of the surface that belongs to each sample."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..kernels.areas import corner_areas
from ..trees import tree_of
from .mesh import Mesh, centred

if TYPE_CHECKING:
    from ..samples import Samples

__all__ = ["area_weights"]

Array = NDArray[np.float64]


def area_weights(samples: Samples, angle: float | None) -> Array:
    """Return what `Samples.weights` returns."""
    mesh = samples.mesh(angle=angle)
    parts, triangles = _areas(mesh), mesh.triangles
    is_sample = mesh.sample[triangles] >= 0
    number = is_sample.sum(axis=1)
    # The parts of added vertices go to the samples at the other corners.
    added = np.where(is_sample, 0.0, parts).sum(axis=1) / np.maximum(number, 1)
    shares = np.where(is_sample, parts + added[:, None], 0.0)
    samples_of, parts_of = mesh.sample[triangles[is_sample]], shares[is_sample]
    weights = np.zeros(len(samples))
    np.add.at(weights, samples_of, parts_of)
    lost = number == 0
    if lost.any():
        centroids = mesh.vertices[triangles[lost]].mean(axis=1)
        weights += _nearest(samples.points, centroids, parts[lost].sum(axis=1))
    return weights


def _areas(mesh: Mesh) -> Array:
    """Return the parts (T, 3) of the areas over triangles that belong to their corners."""
    points, scale = centred(mesh.vertices)
    areas = np.empty(mesh.triangles.shape)
    corner_areas(points * scale, mesh.normals, mesh.triangles, mesh.sides, areas)
    return areas / scale / scale


def _nearest(points: Array, centroids: Array, areas: Array) -> Array:
    """Return areas (N,): those at `centroids`, each added to the nearest of points (N, 3)."""
    nearest = tree_of(points).query(centroids)[1]
    return np.bincount(nearest, areas, minlength=len(points)).astype(np.float64)
