"""Areas over the triangles of a mesh, with the surface as quadratic Bézier triangles."""

from __future__ import annotations

from ...generated.mesh import edge_over_surface
from ...generated.patch import NODE, power_form, tangents
from ...generated.vectors import Vector
from ...runtime.kernels.vectors import dot, length, row_vector
from ...runtime.machine_code.jit import inline, jit

__all__ = ["corner_areas"]


@inline
def turned_row(array, k, side):
    """Return row k of an array (n, 3), times a side that is 1 or −1."""
    return Vector(array[k, 0] * side, array[k, 1] * side, array[k, 2] * side)


@jit
def corner_areas(points, normals, triangles, sides, areas):
    """Write the parts (k, 3) of the areas over triangles (k, 3) that belong to their corners.

    The Bézier triangles are as perpendicular to the normals at their corners as possible; their
    area belongs to the corners by barycentric coordinates. If two normals are more than 90 degrees
    apart, the triangle is flat. `sides` (k, 3) are 1 or −1: the side of the surface at a corner.
    """
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        p0 = row_vector(points, a)
        p1 = row_vector(points, b)
        p2 = row_vector(points, c)
        n0 = turned_row(normals, a, sides[t, 0])
        n1 = turned_row(normals, b, sides[t, 1])
        n2 = turned_row(normals, c, sides[t, 2])
        if min(dot(n0, n1), dot(n0, n2), dot(n1, n2)) < 0.0:
            n0 = n1 = n2 = Vector(0.0, 0.0, 0.0)
        patch = power_form(
            p0,
            p1,
            p2,
            edge_over_surface(p0, p1, n0, n1),
            edge_over_surface(p0, p2, n0, n2),
            edge_over_surface(p1, p2, n1, n2),
        )
        areas[t, 0] = areas[t, 1] = areas[t, 2] = 0.0
        for node in range(3):
            u = 1.0 - 2.0 * NODE if node == 0 else NODE
            v = 1.0 - 2.0 * NODE if node == 1 else NODE
            _, _, N = tangents(patch, u, v)
            area = length(N) / 6.0
            areas[t, 0] += u * area
            areas[t, 1] += v * area
            areas[t, 2] += (1.0 - u - v) * area
