"""Rays through triangles that are sorted into a tree of boxes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....generated.mesh import ray_in_triangle
from ....generated.vectors import Vector
from ....runtime.directions.kernels.vectors import row_vector
from ....runtime.machine_code.jit import inline, jit, loop

# A ray may pass a triangle at this distance from it, relative to its sides: neighbours overlap.
OVERLAP = 1e-9


class Tree(NamedTuple):
    """Triangles in a complete binary tree.

    corners (leaves · size, 3, 3): the triangles; leaf k begins with triangle k · size.
    boxes (2 · leaves, 2, 3): smallest and largest coordinates of nodes. Node 1 is the root, the
    children of node k are 2 k and 2 k + 1, and leaf k is node leaves + k; row 0 is not used.
    """

    corners: NDArray[np.float64]
    boxes: NDArray[np.float64]


@inline
def inverse(x):
    """Return 1/x, or a number that is large but finite for 0."""
    return 1.0 / x if abs(x) > 1e-300 else 1e300


@loop
def is_met(box, p, rates, most):
    """Return whether a box meets the points p + t d, 0 ≤ t ≤ most, where `rates` are 1/d."""
    first, last = 0.0, most
    for axis in range(3):
        one, other = (box[0, axis] - p[axis]) * rates[axis], (box[1, axis] - p[axis]) * rates[axis]
        first, last = max(first, min(one, other)), min(last, max(one, other))
    return first <= last


@loop
def first_hit(tree, p, d, most, both_sides):
    """Return the smallest t ≤ `most` at which p + t d, t ≥ 0, meets a triangle; infinity if none.

    Only triangles that are anticlockwise as seen from p count, unless `both_sides` is true.
    """
    leaves, found = tree.boxes.shape[0] // 2, np.inf
    size, rates = tree.corners.shape[0] // leaves, Vector(inverse(d.x), inverse(d.y), inverse(d.z))
    node = 1
    while True:
        if is_met(tree.boxes[node], p, rates, most):
            if node < leaves:
                node *= 2
                continue
            for j in range((node - leaves) * size, (node - leaves + 1) * size):
                a = row_vector(tree.corners[j], 0)
                b = row_vector(tree.corners[j], 1)
                c = row_vector(tree.corners[j], 2)
                D, U, V, T = ray_in_triangle(p, d, a, b, c)
                if D > 0.0 or (both_sides and D < 0.0):
                    u, v, t = U / D, V / D, T / D
                    inside = min(u, v) >= -OVERLAP and u + v <= 1.0 + OVERLAP
                    if inside and 0.0 <= t <= most:
                        found = most = t
        node += 1  # the next node that is not below this one
        while node % 2 == 0:
            node //= 2
        if node == 1:
            return found


@jit
def find_first_hits(tree, begins, along, most, both_sides, found):
    """Write how far rays (N, 3) run until they meet a triangle; see `first_hit`."""
    for k in range(found.shape[0]):
        p, d = row_vector(begins, k), row_vector(along, k)
        found[k] = first_hit(tree, p, d, most[k], both_sides)
