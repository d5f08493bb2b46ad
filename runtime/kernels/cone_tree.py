"""A tree of cones of normals over the patches of a spline, and the search in it for few normals.

A cone holds all normals of a patch, of a cell, or of a block of 2^k × 2^k cells. A block has as
children the four blocks of half its size. A search for one normal sees the blocks whose cones hold
it: about log₂ of the number of cells.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...generated.vectors import Vector
from ..base.tolerances import ACCURATE
from ..machine_code.jit import inline, jit, loop
from .classify import UNDECIDED, YES, code_again, code_of
from .patch import patch_of
from .strips import AXIS, BOUND, FLAT, SINE, strip_of
from .tile import vector_in
from .vectors import length, row_vector, set_row

__all__ = ["EVERYTHING", "Keys", "Tree", "cones_of_blocks", "cones_of_cells", "search_tree"]

# The half-angle of a cone is computed with an error below this.
ANGLE_ERROR = 1e-12
# Children without a common direction have a sum of axes shorter than this.
SHORTEST = 1e-9
# The least cosine of a cone that holds all directions.
EVERYTHING = -2.0


class Tree(NamedTuple):
    """Cones of patches, then of cells, then of blocks of 2 × 2 cells, up to one block.

    `nodes` (K, 4) are axes and least cosines, `levels` (L, 3) the first node, the rows and the
    columns of each level from the cells on, `bounds` (P,) the errors of the forms of the patches.
    """

    nodes: NDArray[np.float32]
    levels: NDArray[np.int64]
    bounds: NDArray[np.float64]


class Keys(NamedTuple):
    """The output of a search: keys patch << 32 | number of the normal, certain and undecided.

    `counts` (2,) are their numbers.
    """

    certain: NDArray[np.int64]
    undecided: NDArray[np.int64]
    counts: NDArray[np.int64]

    @classmethod
    def new(cls, room: int) -> Keys:
        """Return arrays for `room` keys of each kind."""
        return cls(np.empty(room, np.int64), np.empty(room, np.int64), np.zeros(2, np.int64))


@jit
def cones_of_cells(spline, first, last, strip, cones, bounds, flat):
    """Write axes and half-angles (…, 4) of the cells first, …, last − 1, and of their patches.

    Also written are the errors (P,) of the forms of patches, and whether (P,) these may be
    developable.
    """
    begin = end = 4 * first
    for cell in range(first, last):
        if 4 * cell == end:
            begin, end = strip_of(spline, end, 4 * last, strip)
        for patch in range(4 * cell, 4 * cell + 4):
            k = patch - begin
            sine = strip.rows[SINE + k]
            half = math.asin(sine) if sine < 1.0 else math.pi
            put_cone(cones, patch, vector_in(strip.rows, AXIS, k), half)
            bounds[patch] = strip.rows[BOUND + k]
            flat[patch] = strip.rows[FLAT + k] > 0.0
        join(cones, 4 * cell, 4, 1, 4, bounds.size + cell)


@jit
def cones_of_blocks(cones, below, rows, columns, at):
    """Write the cones of blocks from `at` on, those of their children being from `below` on.

    The children are `rows` × `columns`; blocks at the last row and column may have fewer than four.
    """
    for i in range(0, rows, 2):
        for j in range(0, columns, 2):
            high, wide = min(2, rows - i), min(2, columns - j)
            join(cones, below + i * columns + j, wide, high, columns, at)
            at += 1


@loop
def join(cones, first, wide, high, columns, at):
    """Write a cone that holds `high` rows of `wide` cones; rows begin `columns` cones apart."""
    x = y = z = 0.0
    for p in range(high):
        for q in range(wide):
            r = row_vector(cones, first + p * columns + q)
            x, y, z = x + r.x, y + r.y, z + r.z
    size = length(Vector(x, y, z))
    inverse = 1.0 / size if size > SHORTEST else 0.0
    axis = Vector(x * inverse, y * inverse, z * inverse)
    widest = 0.0 if size > SHORTEST else math.pi
    for p in range(high):
        for q in range(wide):
            child = first + p * columns + q
            widest = max(widest, angle_between(axis, row_vector(cones, child)) + cones[child, 3])
    put_cone(cones, at, axis, widest)


@inline
def angle_between(n, r):
    """Return the angle between unit vectors, also a small one without cancellation."""
    chord = length(Vector(n.x - r.x, n.y - r.y, n.z - r.z))
    return 2.0 * math.asin(min(0.5 * chord, 1.0))


@inline
def put_cone(cones, at, axis, half):
    """Write a cone with a half-angle of at most π."""
    set_row(cones, at, axis)
    cones[at, 3] = min(half + ANGLE_ERROR, math.pi)


@jit
def search_tree(spline, tree, normals, first, last, stack, found):
    """Write the keys of the normals first, …, last − 1; return the normal that has no room."""
    nodes, levels, bounds = tree
    for number in range(first, last):
        n = row_vector(normals, number)
        certain, undecided = found.counts[0], found.counts[1]
        stack[0, 0], stack[0, 1], stack[0, 2] = levels.shape[0] - 1, 0, 0
        size = 1
        while size > 0:
            size -= 1
            level, i, j = stack[size, 0], stack[size, 1], stack[size, 2]
            if level > 0:
                start, rows, columns = levels[level - 1]
                for p in range(2 * i, min(2 * i + 2, rows)):
                    for q in range(2 * j, min(2 * j + 2, columns)):
                        if may_have(nodes, start + p * columns + q, n):
                            stack[size, 0], stack[size, 1], stack[size, 2] = level - 1, p, q
                            size += 1
                continue
            if max(found.counts[0], found.counts[1]) + 4 > found.certain.size:
                found.counts[0], found.counts[1] = certain, undecided
                return number
            cell = i * levels[0, 2] + j
            for patch in range(4 * cell, 4 * cell + 4):
                if may_have(nodes, patch, n):
                    code = code_in(spline, nodes, bounds, patch, n)
                    if code == YES:
                        found.certain[found.counts[0]] = patch << 32 | number
                        found.counts[0] += 1
                    elif code == UNDECIDED:
                        found.undecided[found.counts[1]] = patch << 32 | number
                        found.counts[1] += 1
    return last


@inline
def may_have(nodes, at, n):
    """Return whether a cone holds a normal."""
    return n.x * nodes[at, 0] + n.y * nodes[at, 1] + n.z * nodes[at, 2] >= nodes[at, 3]


@loop
def code_in(spline, nodes, bounds, number, n):
    """Return the code of a normal in the cone of a patch; see `classify`."""
    patch = patch_of(spline.mu, spline.scale, number)
    bound = bounds[number]
    code = code_of(patch, n, math.inf, -math.inf, bound, ACCURATE * bound, n)
    if code == YES and nodes[number, 3] == EVERYTHING:
        code = code_again(patch, n)
    return code
