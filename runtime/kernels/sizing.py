"""The target density of samples, which follows from the curvature, on the patches of a spline.

With the density w, the sizing function is 1/√w: samples are to lie within r/√w of every point, for
a radius r that is the same everywhere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ...generated.patch import NODE, largest_curvature, reach
from ...generated.vectors import Vector
from .jit import inline, jit, loop
from .patch import curvatures_of_patch, normal_of_patch, patch_of
from .vectors import length

__all__ = ["TargetDensity", "density_and_normal", "enclosing_radius", "integrate_density"]

THIRD = 1.0 / 3.0


class TargetDensity(NamedTuple):
    """Samples per area, up to a factor: a κ² + b |K|^exponent, at least the floor.

    κ is the larger principal curvature in modulus, a the curvature weight and b the Gauss weight.
    Curvatures are those of the scaled surface.
    """

    floor: float = 0.0
    curvature_weight: float = 0.0
    gauss_weight: float = 0.0
    exponent: float = 1.0


@inline
def at_most(value, limit):
    """Return the smaller number, the limit for NaN."""
    return value if value < limit else limit


@inline
def density_of(K, H, radius, target):
    """Return the target density for the Gaussian and mean curvature.

    Radii of curvature smaller than the radius of the patch are artefacts of the spline, and are
    replaced by it.
    """
    density = 0.0
    limit = 1.0 / (radius * radius)
    if target.curvature_weight > 0.0:
        k = largest_curvature(K, H)
        density += target.curvature_weight * at_most(k * k, limit)
    if target.gauss_weight > 0.0:
        density += target.gauss_weight * math.pow(at_most(abs(K), limit), target.exponent)
    return max(density, target.floor)


@loop
def density_and_normal(patch, u, v, radius, target):
    """Return the length |p_u × p_v|, the unit normal, K and the target density at (u, v).

    `radius` is that of the whole patch. At a singular point the normal and K are 0 and the density
    is its floor.
    """
    N = normal_of_patch(patch, u, v)
    size = length(N)
    if size > 0.0:
        normal, K, H = curvatures_of_patch(patch, N, u, v)
        return size, normal, K, density_of(K, H, radius, target)
    return size, Vector(0.0, 0.0, 0.0), 0.0, target.floor


@loop
def enclosing_radius(patch, u0, v0, u1, v1, u2, v2):
    """Return a radius around the image of the centroid that covers the image of a triangle."""
    return math.sqrt(max(reach(patch, u0, v0, u1, v1, u2, v2)))


@jit
def integrate_density(mu, scale, target, first, last, radii, areas, densities):
    """Write weights and values of the target density for the patches first, …, last − 1.

    radii (patches,): of balls around the centroids that contain the patches.
    areas (patches, 3): the weights of the nodes of a quadrature.
    densities (patches, 4): the target density at these nodes and at the centroid.
    """
    for number in range(first, last):
        patch = patch_of(mu, scale, number)
        radius = enclosing_radius(patch, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
        radii[number] = radius
        for node in range(4):
            u = THIRD if node == 3 else 1.0 - 2.0 * NODE if node == 0 else NODE
            v = THIRD if node == 3 else 1.0 - 2.0 * NODE if node == 1 else NODE
            size, _, _, density = density_and_normal(patch, u, v, radius, target)
            densities[number, node] = density
            if node < 3:
                areas[number, node] = size / 6.0
