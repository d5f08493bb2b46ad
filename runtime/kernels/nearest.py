"""The samples nearest to places, searched in the cells of a grid around each place."""

from __future__ import annotations

import math

from .greedy import NO_NUMBER, distance_to_cells, normal_of
from .hash_grids import CELL, bucket_of
from .jit import jit, loop
from .vectors import dot, row_vector

__all__ = ["compare_with_nearest", "nearest_samples"]


@loop
def nearest_in_cell(grids, order, i, j, k, x, n, square, number):
    """Return the square of the distance and the number of the sample nearest to a place x.

    That is one in the cell (i, j, k) on the side of n, or the one that was found so far. The first
    of several equally near ones is returned.
    """
    samples = grids.candidates
    bucket = bucket_of(0, i, j, k, grids.starts.size - 1)
    for at in range(grids.starts[bucket], grids.starts[bucket + 1]):
        dx = samples[at, 0] - x.x
        dy = samples[at, 1] - x.y
        dz = samples[at, 2] - x.z
        found = dx * dx + dy * dy + dz * dz
        if found < square or (found == square and order[at] < number):
            m = normal_of(samples, at)
            if dot(m, n) >= 0.0:
                square = found
                number = order[at]
    return square, number


@jit
def nearest_samples(grids, order, rings, rows, first, last, squares, numbers):
    """Write the squared distances and the numbers of the samples nearest to rows (M, 8).

    Those of the rows first, …, last − 1 are written: of samples on the same side, by their normals.
    The samples are the candidates of grids with one level; sample k is number order[k]. Cells
    around that of a place are searched in `rings`; the number is −1 where that is not enough.
    """
    cell = CELL * grids.radius * grids.sizes[0]
    for row in range(first, last):
        x = row_vector(rows, row)
        n = normal_of(rows, row)
        i_x = int(math.floor(x.x / cell))
        j_x = int(math.floor(x.y / cell))
        k_x = int(math.floor(x.z / cell))
        # The distance from the faces of its own cell.
        inside = min(
            min(x.x - i_x * cell, (i_x + 1) * cell - x.x),
            min(x.y - j_x * cell, (j_x + 1) * cell - x.y),
            min(x.z - k_x * cell, (k_x + 1) * cell - x.z),
        )
        square = math.inf
        number = NO_NUMBER
        for ring in range(rings + 1):
            for i in range(i_x - ring, i_x + ring + 1):
                x_gap = distance_to_cells(i, cell, x.x)
                for j in range(j_x - ring, j_x + ring + 1):
                    y_gap = distance_to_cells(j, cell, x.y)
                    # All cells of the faces of the ring, and the two ends of other columns.
                    at_face = abs(i - i_x) == ring or abs(j - j_x) == ring
                    step = 1 if at_face else 2 * ring
                    for k in range(k_x - ring, k_x + ring + 1, step):
                        z_gap = distance_to_cells(k, cell, x.z)
                        if x_gap * x_gap + y_gap * y_gap + z_gap * z_gap <= square:
                            square, number = nearest_in_cell(
                                grids, order, i, j, k, x, n, square, number
                            )
            reach = max(inside + ring * cell, 0.0)
            if square < reach * reach:
                break
        else:
            number = NO_NUMBER
        squares[row] = square
        numbers[row] = number


@jit
def compare_with_nearest(rows, points, nearest, chords):
    """Write the chords (M,) between normals of rows and those of the samples nearest to them.

    Returns the largest one, and the largest distance of a row from the tangent plane at its
    nearest sample. `points` (N, 6) are the samples, point and normal.
    """
    longest = 0.0
    farthest = 0.0
    for k in range(rows.shape[0]):
        x = row_vector(rows, k)
        y = row_vector(points, nearest[k])
        m = normal_of(rows, k)
        n = normal_of(points, nearest[k])
        dx = m.x - n.x
        dy = m.y - n.y
        dz = m.z - n.z
        chords[k] = math.sqrt(dx * dx + dy * dy + dz * dz)
        away = (x.x - y.x) * n.x + (x.y - y.y) * n.y + (x.z - y.z) * n.z
        longest = max(longest, chords[k])
        farthest = max(farthest, abs(away))
    return longest, farthest
