"""Greedy covering: candidates far from all samples become samples.

Each new sample updates the distances of the candidates around it, which is cheaper than repeated
searches for the nearest sample of each candidate. A sample counts for candidates on its own side of
the surface: the angle between their normals is at most 60 degrees.
"""

from __future__ import annotations

import math

from ....generated.vectors import Vector
from ....runtime.directions.kernels.vectors import dot, row_vector
from ....runtime.machine_code.jit import inline, jit, loop
from .hash_grids import CELL, DENSITY, NORMAL, SQUARE, bucket_of

# Two points are on the same side of the surface if the cosine of the angle between their normals is
# at least this: 60 degrees.
SAME_SIDE = 0.5


@inline
def distance_to_cells(i, cell, x):
    """Return the distance of x from interval i of an axis cut into intervals of width `cell`."""
    return max(i * cell - x, x - (i + 1) * cell, 0.0)


@inline
def normal_of(rows, k):
    """Return the normal of row k, which follows its point."""
    return Vector(rows[k, NORMAL], rows[k, NORMAL + 1], rows[k, NORMAL + 2])


@inline
def on_side(candidates, at, n):
    """Return whether a candidate is on the same side of the surface as a point with normal n."""
    return dot(normal_of(candidates, at), n) >= SAME_SIDE


def around(meet):
    """Return a loop that calls meet(grids, kept, number, bucket, x, n) for buckets near a sample.

    The sample has the point x and the normal n. The buckets are all those with candidates within
    radius/√w of x, and some others, perhaps more than once. `number` and `kept` are passed to
    `meet`.
    """
    meets = inline(meet)

    @loop
    def visit(grids, radius, kept, number, x, n):
        buckets = grids.starts.size - 1
        for level in range(grids.sizes.size):
            reach = radius * grids.sizes[level]
            cell = CELL * grids.radius * grids.sizes[level]
            if cell == 0.0:
                continue
            i_last = int(math.floor((x.x + reach) / cell))
            j_first = int(math.floor((x.y - reach) / cell))
            j_last = int(math.floor((x.y + reach) / cell))
            k_first = int(math.floor((x.z - reach) / cell))
            k_last = int(math.floor((x.z + reach) / cell))
            for i in range(int(math.floor((x.x - reach) / cell)), i_last + 1):
                x_gap = distance_to_cells(i, cell, x.x)
                for j in range(j_first, j_last + 1):
                    y_gap = distance_to_cells(j, cell, x.y)
                    for k in range(k_first, k_last + 1):
                        z_gap = distance_to_cells(k, cell, x.z)
                        if x_gap * x_gap + y_gap * y_gap + z_gap * z_gap <= reach * reach:
                            meets(grids, kept, number, bucket_of(level, i, j, k, buckets), x, n)

    return visit


@inline
def squared_distance(rows, k, x):
    """Return the squared distance of x from the point of row k."""
    dx, dy, dz = rows[k, 0] - x.x, rows[k, 1] - x.y, rows[k, 2] - x.z
    return dx * dx + dy * dy + dz * dz


def update(grids, kept, number, bucket, x, n):
    """Update the distances of the candidates of a bucket for a sample at x with normal n."""
    candidates = grids.candidates
    for at in range(grids.starts[bucket], grids.starts[bucket + 1]):
        square = squared_distance(candidates, at, x) * candidates[at, DENSITY]
        if square < candidates[at, SQUARE] and on_side(candidates, at, n):
            candidates[at, SQUARE] = square


update_around = around(update)


@loop
def is_near(grids, radius, samples, k):
    """Return whether a sample is within radius/√w of the box around all candidates."""
    reach = 0.0
    for level in range(grids.sizes.size):
        reach = max(reach, radius * grids.sizes[level])
    outside = False
    for x in range(3):
        outside |= samples[k, x] < grids.box[0, x] - reach
        outside |= samples[k, x] > grids.box[1, x] + reach
    return not outside


@jit
def update_distances(grids, radius, samples):
    """Update the distances of candidates within radius/√w of samples (N, 6).

    A row of a sample is its point and its unit normal.
    """
    for k in range(samples.shape[0]):
        if is_near(grids, radius, samples, k):
            update_around(grids, radius, 0, k, row_vector(samples, k), normal_of(samples, k))


@jit
def choose_far(grids, radius, least, searched, chosen):
    """Choose candidates that are farther than radius/√w from all samples and chosen candidates.

    Only the candidates in `searched` are considered, in this order. Candidates still farther than
    least/√w are moved to the front of `searched`. Return their number, and the number of chosen
    candidates.
    """
    candidates = grids.candidates
    kept = 0
    count = 0
    for k in range(searched.size):
        at = searched[k]
        square = candidates[at, SQUARE]
        if square > radius * radius:
            x, n = row_vector(candidates, at), normal_of(candidates, at)
            update_around(grids, radius, 0, 0, x, n)
            chosen[count] = at
            count += 1
        elif square > least * least:
            searched[kept] = at
            kept += 1
    return kept, count
