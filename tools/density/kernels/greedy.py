"""Greedy covering: candidates far from all samples become samples.

Each new sample updates the distances of the candidates around it, which is cheaper than repeated
searches for the nearest sample of each candidate. A sample counts for candidates on its own side of
the surface: the angle between their normals is at most 60 degrees.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ....generated.vectors import Vector
from ....runtime.directions.kernels.vectors import dot, row_vector
from ....runtime.machine_code.jit import inline, jit, loop
from .hash_grids import CELL, DENSITY, NORMAL, SQUARE, bucket_of

__all__ = ["Lists", "choose_far", "note_samples", "update_distances"]

# The index of no sample; typed, so that Numba compiles one function for all indices.
NO_NUMBER = np.int64(-1)
# The cosine of the largest angle between normals on the same side of a surface.
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
    """Return whether a candidate is on the side of the surface with the normal n."""
    return dot(normal_of(candidates, at), n) >= SAME_SIDE


class Lists(NamedTuple):
    """For each candidate, the samples that may be the nearest ones in its cell.

    near: (M, …) int32, their indices; if they are too many, the rest is left out.
    counts: (M,) int32, their numbers.
    within: (M,) w times the square of the largest distance for the list.
    order: (M,) int32, the rows of the candidates in `numbers`.
    numbers: (M, 14), see kernels/cells.py.
    """

    near: np.ndarray
    counts: np.ndarray
    within: np.ndarray
    order: np.ndarray
    numbers: np.ndarray


def around(meet):
    """Return a loop that calls meet(grids, kept, at, number, square, n) near a sample.

    It is called for all candidates within radius/√w of the sample x with the normal n, and for some
    others. `square` is w times the squared distance, `kept` the output of `meet`.
    """
    meets = inline(meet)

    @loop
    def visit(grids, radius, kept, number, x, n):
        candidates = grids.candidates
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
                        if x_gap * x_gap + y_gap * y_gap + z_gap * z_gap > reach * reach:
                            continue
                        bucket = bucket_of(level, i, j, k, buckets)
                        for at in range(grids.starts[bucket], grids.starts[bucket + 1]):
                            dx = candidates[at, 0] - x.x
                            dy = candidates[at, 1] - x.y
                            dz = candidates[at, 2] - x.z
                            square = (dx * dx + dy * dy + dz * dz) * candidates[at, DENSITY]
                            meets(grids, kept, at, number, square, n)

    return visit


def update(grids, nearest, at, number, square, n):
    """Update the distance of a candidate."""
    if square < grids.candidates[at, SQUARE] and on_side(grids.candidates, at, n):
        grids.candidates[at, SQUARE] = square
        nearest[at] = number


def note(grids, lists, at, number, square, n):
    """List a sample that may be the nearest one somewhere in the cell of a candidate."""
    near, count = lists.near, lists.counts[at]
    # Cells of a grid may share a bucket, which is then visited several times.
    has_room = count < near.shape[1] and (count == 0 or near[at, count - 1] != number)
    if has_room and square <= lists.within[at] and on_side(grids.candidates, at, n):
        near[at, count] = number
        lists.counts[at] = count + 1


update_around, note_around = around(update), around(note)


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
    """Update the distances of candidates within radius/√w of samples (N, 6), point and normal.

    The number of a sample is its row.
    """
    for k in range(samples.shape[0]):
        if is_near(grids, radius, samples, k):
            x, n = row_vector(samples, k), normal_of(samples, k)
            update_around(grids, radius, grids.nearest, k, x, n)


@jit
def note_samples(grids, radius, lists, samples):
    """Write samples (N, 6) to the lists of the candidates within radius/√w of them."""
    for k in range(samples.shape[0]):
        if is_near(grids, radius, samples, k):
            note_around(grids, radius, lists, k, row_vector(samples, k), normal_of(samples, k))


@jit
def choose_far(grids, radius, least, searched, chosen):
    """Choose candidates that are farther than radius/√w from all samples, chosen ones included.

    Only candidates in `searched` are considered, in this order. Those still farther than least/√w
    are moved to its front. Return their number, and the number of chosen candidates.
    """
    candidates = grids.candidates
    kept = 0
    count = 0
    for k in range(searched.size):
        at = searched[k]
        square = candidates[at, SQUARE]
        if square > radius * radius:
            update_around(
                grids,
                radius,
                grids.nearest,
                NO_NUMBER,
                row_vector(candidates, at),
                normal_of(candidates, at),
            )
            chosen[count] = at
            count += 1
        elif square > least * least:
            searched[kept] = at
            kept += 1
    return kept, count
