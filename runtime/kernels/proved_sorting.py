"""Places in the order of their normals, those of a normal by u and v."""

from __future__ import annotations

from ..machine_code.jit import jit, loop

__all__ = ["sort_places"]


@loop
def is_before(rows, a, b):
    """Say whether place a is before place b."""
    return rows[a, 0] < rows[b, 0] or (rows[a, 0] == rows[b, 0] and rows[a, 1] < rows[b, 1])


@jit
def sort_places(rows, numbers, starts, order, uv, radius, sign, border):
    """Write the fields of places, rows (k, 6) of u, v, two radii, D, and whether on the border.

    `numbers` (k,) are those of normals; `starts` (S + 1,), zeros, become the starts of normals in
    the result, and order (k,) their numbers.
    """
    count = numbers.size
    for k in range(count):
        starts[numbers[k] + 1] += 1
    for n in range(starts.size - 1):
        starts[n + 1] += starts[n]
    for k in range(count):
        order[starts[numbers[k]]] = k
        starts[numbers[k]] += 1
    for n in range(starts.size - 1, 0, -1):
        starts[n] = starts[n - 1]
    starts[0] = 0
    for n in range(starts.size - 1):
        for at in range(starts[n], starts[n + 1]):
            place, to = order[at], at
            while to > starts[n] and is_before(rows, place, order[to - 1]):
                order[to] = order[to - 1]
                to -= 1
            order[to] = place
        for at in range(starts[n], starts[n + 1]):
            k = order[at]
            uv[at, 0], uv[at, 1], radius[at, 0], radius[at, 1] = (
                rows[k, 0],
                rows[k, 1],
                rows[k, 2],
                rows[k, 3],
            )
            sign[at] = 1 if rows[k, 4] > 0.0 else -1
            border[at] = rows[k, 5] > 0.0
            order[at] = n
