"""Clusters of boxes that touch, modulo periods, with the bounding box of each."""

from __future__ import annotations

import numpy as np

from ...machine_code.jit import inline, loop

# Boxes count as touching if their distance is at most this multiple of their size.
TOUCHING = 1e-6


@inline
def shift_to(x, y, period):
    """Return the multiple of the period that brings x nearest to y."""
    return period * np.rint((y - x) / period) if period > 0.0 else 0.0


@loop
def join(hull, u0, u1, v0, v1, period):
    """Extend a hull by a box if they touch; return whether they do."""
    du = shift_to(0.5 * (u0 + u1), 0.5 * (hull[0] + hull[1]), period[0])
    dv = shift_to(0.5 * (v0 + v1), 0.5 * (hull[2] + hull[3]), period[1])
    u0, u1, v0, v1 = u0 + du, u1 + du, v0 + dv, v1 + dv
    slack_u, slack_v = TOUCHING * (u1 - u0), TOUCHING * (v1 - v0)
    if (
        u0 > hull[1] + slack_u
        or u1 < hull[0] - slack_u
        or v0 > hull[3] + slack_v
        or v1 < hull[2] - slack_v
    ):
        return False
    hull[0], hull[1] = min(hull[0], u0), max(hull[1], u1)
    hull[2], hull[3] = min(hull[2], v0), max(hull[3], v1)
    return True


@loop
def cluster(boxes, count, cells, period, hulls, owner):
    """Write the hulls (…, 4) of clusters, u₀, u₁, v₀, v₁, and the cluster of each box.

    Boxes (count, 5) are parts of cells: u, v, the index of the cell, and half the widths of the box
    along u and v, relative to those of the cell. Returns the number of hulls.
    """
    hull_count = 0
    for k in range(count):
        j = int(boxes[k, 2])
        h_u, h_v = boxes[k, 3] * cells.place[j, 2], boxes[k, 4] * cells.place[j, 3]
        u0, u1, v0, v1 = boxes[k, 0] - h_u, boxes[k, 0] + h_u, boxes[k, 1] - h_v, boxes[k, 1] + h_v
        owner[k] = -1
        for i in range(hull_count):
            if join(hulls[i], u0, u1, v0, v1, period):
                owner[k] = i
                break
        if owner[k] < 0:
            (
                hulls[hull_count, 0],
                hulls[hull_count, 1],
                hulls[hull_count, 2],
                hulls[hull_count, 3],
            ) = u0, u1, v0, v1
            owner[k] = hull_count
            hull_count += 1
    joined = True
    while joined:
        joined = False
        for i in range(hull_count):
            for k in range(hull_count - 1, i, -1):
                h = hulls[k]
                if not join(hulls[i], h[0], h[1], h[2], h[3], period):
                    continue
                hull_count -= 1
                for x in range(4):
                    h[x] = hulls[hull_count, x]
                for box in range(count):
                    if owner[box] == k:
                        owner[box] = i
                    elif owner[box] == hull_count:
                        owner[box] = k
                joined = True
    return hull_count
