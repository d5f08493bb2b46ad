"""Places in the order of their normals, those of a normal by u and v: a counting sort."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..machine_code.jit import jit, loop

__all__ = ["Sorted", "count_places", "order_places", "put_places", "start_normals"]


class Sorted(NamedTuple):
    """Room for sorted places: numbers of normals (k,), parameters, radii (k, 2), signs, borders."""

    numbers: NDArray[np.int64]
    uv: NDArray[np.float64]
    radius: NDArray[np.float64]
    sign: NDArray[np.int8]
    border: NDArray[np.bool_]

    @classmethod
    def new(cls, count: int) -> Sorted:
        """Return room for some places."""
        return cls(
            np.empty(count, np.int64), np.empty((count, 2)), np.empty((count, 2)),
            np.empty(count, np.int8), np.empty(count, np.bool_),
        )  # fmt: skip


@jit
def count_places(numbers, starts):
    """Add the numbers of places with each normal to `starts` (S + 1,), shifted by one."""
    for k in range(numbers.size):
        starts[numbers[k] + 1] += 1


@jit
def start_normals(starts):
    """Change the numbers of places into their starts."""
    for n in range(starts.size - 1):
        starts[n + 1] += starts[n]


@jit
def put_places(places, numbers, starts, room):
    """Write places (k, 6) where those with their normals start, and move the starts on."""
    for k in range(numbers.size):
        at = starts[numbers[k]]
        starts[numbers[k]] = at + 1
        room.numbers[at] = numbers[k]
        room.uv[at, 0], room.uv[at, 1] = places[k, 0], places[k, 1]
        room.radius[at, 0], room.radius[at, 1] = places[k, 2], places[k, 3]
        room.sign[at] = 1 if places[k, 4] > 0.0 else -1
        room.border[at] = places[k, 5] > 0.0


@jit
def order_places(room):
    """Sort the places with each normal by u, then v."""
    for first in range(1, room.numbers.size):
        k = first
        while k > 0 and room.numbers[k - 1] == room.numbers[k] and is_before(room.uv, k, k - 1):
            swap(room, k, k - 1)
            k -= 1


@loop
def is_before(uv, i, k):
    """Say whether parameters i are before parameters k."""
    return uv[i, 0] < uv[k, 0] or (uv[i, 0] == uv[k, 0] and uv[i, 1] < uv[k, 1])


@loop
def swap(room, i, k):
    """Exchange two places."""
    for x in range(2):
        room.uv[i, x], room.uv[k, x] = room.uv[k, x], room.uv[i, x]
        room.radius[i, x], room.radius[k, x] = room.radius[k, x], room.radius[i, x]
    room.sign[i], room.sign[k] = room.sign[k], room.sign[i]
    room.border[i], room.border[k] = room.border[k], room.border[i]
