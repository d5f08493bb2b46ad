"""Winding numbers around the boxes that hold components of solutions."""

from __future__ import annotations

from ...directions.kernels.vectors import row_vector
from ...machine_code.jit import jit
from .degree import index_around


@jit
def indices_around(
    tape, work, tile, joints, domain, points, boxes, numbers, normals, ends, path, around
):
    """Write the winding number around each box (k, 4), and the box of its path, to `around` (k, 5).

    `numbers` (k,) are indices of normals (S, 3); `points` (4,) are 1 for collapsed sides of the
    domain, else 0. The winding number is NaN if it is unknown.
    """
    for k in range(numbers.size):
        n, row = row_vector(normals, numbers[k]), around[k]
        row[0] = index_around(
            tape, work, tile, joints, domain, points, boxes[k], n, ends, path, row[1:]
        )  # fmt: skip
