"""Solid angles of Gaussian images, as integrals along their boundaries."""

from __future__ import annotations

from ....generated.gaussian_image import boundary_arc, solid_angle
from ....generated.vectors import Vector
from ....runtime.machine_code.jit import jit


@jit
def integrate_arcs(arcs, poles, nodes, weights, integrals):
    """Write the integrals (k,) of the solid-angle form along arcs (k, 3, 3).

    An arc is a quadratic Bézier curve of normals, and `poles` (k, 3) are the poles of the form.
    `nodes` and `weights` are those of a quadrature on [0, 1]. Vanishing normals are skipped.
    """
    for k in range(arcs.shape[0]):
        N0 = Vector(arcs[k, 0, 0], arcs[k, 0, 1], arcs[k, 0, 2])
        N1 = Vector(arcs[k, 1, 0], arcs[k, 1, 1], arcs[k, 1, 2])
        N2 = Vector(arcs[k, 2, 0], arcs[k, 2, 1], arcs[k, 2, 2])
        pole = Vector(poles[k, 0], poles[k, 1], poles[k, 2])
        total = 0.0
        for node in range(nodes.size):
            n, n_t = boundary_arc(N0, N1, N2, nodes[node])
            if n.x * n.x + n.y * n.y + n.z * n.z > 0.0:
                total += weights[node] * solid_angle(pole, n, n_t)
        integrals[k] = total
