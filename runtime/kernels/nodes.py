"""The curvature of a surface in the cells of its spline, from its 2-jets at their Gauss points.

In between it is interpolated, as the target density that follows from it, and normals are.
"""

from __future__ import annotations

import math

from ...generated.jet import at_jet
from ...generated.spline import CORNERS
from ...generated.vectors import Vector
from ..base.tolerances import VANISHING
from .jit import inline, jit, loop
from .patch import place_of
from .refine import patch_of_jet
from .sizing import density_of
from .vectors import dot, length, set_row

__all__ = [
    "GAUSS",
    "densities_at_nodes",
    "densities_on_patches",
    "evaluate_nodes",
    "interpolate",
]

# The Gauss points of a cell are at 1/2 ± GAUSS/2 of its sides.
GAUSS = 1.0 / math.sqrt(3.0)
# Extrapolated values stay within this factor of those at the nodes.
FACTOR = 2.0


@inline
def place_in_domain(number, columns, s, t):
    """Return the parameters, in cells, of the place (s, t) in a patch."""
    i, j, turn = place_of(number, columns)
    u = i + 0.5 + s * CORNERS[turn, 0, 0] + t * CORNERS[turn, 1, 0]
    v = j + 0.5 + s * CORNERS[turn, 0, 1] + t * CORNERS[turn, 1, 1]
    return u, v


# --- the nodes of the cells -----------------------------------------------------------------------


@jit
def evaluate_nodes(jets, size, frame, first, nodes):
    """Write the nodes first, first + 1, … of jets: unit normal, K, H and area element (…, 6).

    Lengths are multiplied by `size`; area elements are those of a cell. Where the surface is
    singular, all numbers are 0.
    """
    for k in range(jets.shape[0]):
        patch = patch_of_jet(jets, k, size, frame[2], frame[3])
        area, n, K, H = at_jet(patch)
        scale = math.sqrt(dot(patch.d, patch.d) * dot(patch.e, patch.e))
        regular = area > VANISHING * scale and abs(K) < math.inf
        set_row(nodes, first + k, n if regular else Vector(0.0, 0.0, 0.0))
        nodes[first + k, 3] = K if regular else 0.0
        nodes[first + k, 4] = H if regular else 0.0
        nodes[first + k, 5] = area if regular else 0.0


@jit
def densities_at_nodes(nodes, radii, target, densities):
    """Write the target density (cells, 4) at nodes (4 cells, 6), with patch radii (4 cells,)."""
    for cell in range(densities.shape[0]):
        radius = 0.0
        for k in range(4):
            radius = max(radius, radii[4 * cell + k])
        for k in range(4):
            node = 4 * cell + k
            densities[cell, k] = density_of(nodes[node, 3], nodes[node, 4], radius, target)


@inline
def weight_of(x):
    """Return the weight of the second of two Gauss points at a place x of a cell, 0 ≤ x < 1."""
    return 0.5 + (x - 0.5) / GAUSS


@loop
def density_in(densities, cell, s, t):
    """Return the density at the place (s, t), 0 … 1, of a cell, from those at its nodes."""
    low = densities[cell, 0]
    high = densities[cell, 0]
    for k in range(1, 4):
        low = min(low, densities[cell, k])
        high = max(high, densities[cell, k])
    a, b = weight_of(s), weight_of(t)
    west = (1.0 - b) * densities[cell, 0] + b * densities[cell, 1]
    east = (1.0 - b) * densities[cell, 2] + b * densities[cell, 3]
    return min(max((1.0 - a) * west + a * east, low / FACTOR), high * FACTOR)


@jit
def densities_on_patches(columns, at_nodes, places, densities):
    """Write the density (patches, k) at places (k, 2) of all patches, from that at the nodes."""
    for number in range(densities.shape[0]):
        i, j, _ = place_of(number, columns)
        for k in range(places.shape[0]):
            u, v = place_in_domain(number, columns, places[k, 0], places[k, 1])
            densities[number, k] = density_in(at_nodes, number // 4, u - i, v - j)


@jit
def interpolate(columns, nodes, at_nodes, floor, patches, places, rows):
    """Replace normals and densities of rows (M, 8), at places (M, 2) of patches, by the surface's.

    They are interpolated from the nodes: near to a pole, and where it is folded, the normals and
    the curvature of a spline are far from those of the surface.
    """
    for k in range(rows.shape[0]):
        i, j, _ = place_of(patches[k], columns)
        u, v = place_in_domain(patches[k], columns, places[k, 0], places[k, 1])
        cell = patches[k] // 4
        rows[k, 6] = max(density_in(at_nodes, cell, u - i, v - j), floor)
        a, b = weight_of(u - i), weight_of(v - j)
        normal = Vector(0.0, 0.0, 0.0)
        for node in range(4):
            weight = (a if node > 1 else 1.0 - a) * (b if node % 2 == 1 else 1.0 - b)
            row = 4 * cell + node
            normal = Vector(
                normal.x + weight * nodes[row, 0],
                normal.y + weight * nodes[row, 1],
                normal.z + weight * nodes[row, 2],
            )
        size = length(normal)
        if size > 0.0:
            set_row(rows[:, 3:6], k, Vector(normal.x / size, normal.y / size, normal.z / size))
