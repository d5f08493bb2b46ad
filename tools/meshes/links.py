"""The triangles of a mesh that share an edge."""

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]


def edge_numbers(triangles: Indices, count: int) -> Indices:
    """Return numbers (k, 3) that identify the edges opposite to the corners of triangles.

    The number of an edge is first · count + second, where first is the smaller and second the
    larger index of its two vertices.
    """
    one, other = triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
    return np.minimum(one, other) * count + np.maximum(one, other)


def edges_of(triangles: Indices, count: int) -> tuple[Indices, Indices]:
    """Return the edges (E, 2) between `count` vertices, and the number of triangles of each."""
    numbers, times = np.unique(edge_numbers(triangles, count), return_counts=True)
    return np.stack(np.divmod(numbers, count), axis=1), times


def is_closed(triangles: Indices, count: int) -> bool:
    """Return whether each edge is in two triangles, which traverse it in opposite directions."""
    one, other = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    ways, back = np.sort(one * count + other), np.sort(other * count + one)
    twice = (ways[1:] == ways[:-1]).any()
    return bool(len(ways) and not twice and (ways == back).all())


def neighbours(triangles: Indices, may_end: NDArray[np.bool_]) -> tuple[Indices, bool]:
    """Return the indices (k, 3) of the triangles across the edges opposite to corners, −1 for none.

    Also return whether the triangles are complete: each edge is in two triangles, or in one
    triangle between two vertices where the surface `may_end`. Triangles at an edge of three or more
    triangles are not neighbours.
    """
    numbers = edge_numbers(triangles, len(may_end)).ravel()
    order = np.argsort(numbers, kind="stable")
    first = np.flatnonzero(np.diff(numbers[order], prepend=-1))
    times = np.diff(first, append=len(order))
    one, other = order[first[times == 2]], order[first[times == 2] + 1]
    adjacent = np.full(triangles.shape, -1)
    adjacent.flat[one], adjacent.flat[other] = other // 3, one // 3
    ends = np.divmod(numbers[order[first[times == 1]]], len(may_end))
    all_there = bool(len(one) and times.max() == 2 and may_end[np.concatenate(ends)].all())
    return adjacent, all_there
