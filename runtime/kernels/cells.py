"""Rectangles of the parameters of a surface: what they hold, and how far it reaches.

A cell is a rectangle u, v with a place in it. The quadratic patch that osculates the surface at the
place stands for the surface in the cell, which has to be small enough for that.
"""

from __future__ import annotations

import math

from ...generated.jet import at_jet
from ...generated.patch import envelope, tangents
from ...generated.vectors import Vector
from ..base.tolerances import VANISHING
from ..machine_code.jit import inline, jit
from .refine import patch_of_jet
from .sizing import density_of
from .vectors import dot, length, set_row

__all__ = ["evaluate_cells"]

# What the surface may be farther away than its osculating patch, as parts of the distance.
BEYOND = 1.03


@inline
def distance_of(v, w):
    """Return the distance between the ends of two vectors."""
    return length(Vector(v.x - w.x, v.y - w.y, v.z - w.z))


@jit
def evaluate_cells(jets, boxes, places, size, centre, finest, target, rows, numbers):
    """Write what is known of cells with boxes (M, 4), from 2-jets (M, 6, 3) at places (M, 2).

    Boxes are u0, v0, u1, v1. Lengths are multiplied by `size`, and points are relative to a centre.

    rows (M, 8): point, unit normal, target density and K; normal and K are 0 at singular points.
    numbers (M, 8): a radius around the point that holds the cell; the chord between the normal and
    others of the cell, 2 where there is none; the lengths of the cell along u and v; its bends
    along u and v, relative to these; its area; the radius of curvature below which curvature does
    not count: the width of the cell, if it is 0 on entry, or of one whose sides are `finest` (2,).
    """
    for k in range(jets.shape[0]):
        du = boxes[k, 2] - boxes[k, 0]
        dv = boxes[k, 3] - boxes[k, 1]
        patch = patch_of_jet(jets, k, size, du, dv)
        area, n, K, H = at_jet(patch)
        scale = math.sqrt(dot(patch.d, patch.d) * dot(patch.e, patch.e))
        regular = area > VANISHING * scale and abs(K) < math.inf
        radius = 0.0
        chord = 0.0
        along_u = 0.0
        along_v = 0.0
        for corner in range(4):
            s = (boxes[k, 2 * (corner % 2)] - places[k, 0]) / du
            t = (boxes[k, 1 + 2 * (corner // 2)] - places[k, 1]) / dv
            radius = max(radius, distance_of(envelope(patch, s, t), patch.p))
            p_u, p_v, N = tangents(patch, s, t)
            along_u = max(along_u, length(p_u))
            along_v = max(along_v, length(p_v))
            size_of_N = length(N)
            if regular and size_of_N > VANISHING * length(p_u) * length(p_v):
                m = Vector(N.x / size_of_N, N.y / size_of_N, N.z / size_of_N)
                chord = max(chord, distance_of(m, n))
            else:
                chord = 2.0
        radius *= BEYOND
        limit = numbers[k, 7]
        if limit == 0.0:
            wide = max(finest[0] / du, 1.0)
            high = max(finest[1] / dv, 1.0)
            across_u = (along_u + length(patch.a) * (wide - 1.0)) * wide
            across_v = (along_v + length(patch.c) * (high - 1.0)) * high
            limit = min(across_u, across_v)
        for x in range(3):
            rows[k, x] = (jets[k, 0, x] - centre[x]) * size
        set_row(rows[:, 3:6], k, n if regular else Vector(0.0, 0.0, 0.0))
        rows[k, 6] = density_of(K, H, limit, target) if regular else target.floor
        rows[k, 7] = K if regular else 0.0
        numbers[k, 0] = radius
        numbers[k, 1] = min(BEYOND * chord, 2.0)
        numbers[k, 2] = along_u
        numbers[k, 3] = along_v
        numbers[k, 4] = length(patch.a) / along_u if along_u > 0.0 else 0.0
        numbers[k, 5] = length(patch.c) / along_v if along_v > 0.0 else 0.0
        numbers[k, 6] = area
        numbers[k, 7] = limit
