"""Places in the order of their normals, those of a normal by u and v: a counting sort."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..machine_code.jit import jit, loop
from .proved_search import PLACE

__all__ = ["Sorted", "count_places", "order_places", "put_places", "start_normals"]


class Sorted(NamedTuple):
    """Room for sorted places (k, 6) of a search, and the numbers (k,) of their normals."""

    numbers: NDArray[np.int64]
    places: NDArray[np.float64]

    @classmethod
    def new(cls, count: int) -> Sorted:
        """Return room for some places."""
        return cls(np.empty(count, np.int64), np.empty((count, PLACE)))


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
        for x in range(PLACE):
            room.places[at, x] = places[k, x]


@jit
def order_places(room):
    """Sort the places with each normal by u, then v."""
    for first in range(1, room.numbers.size):
        k = first
        while k > 0 and room.numbers[k - 1] == room.numbers[k] and is_before(room.places, k, k - 1):
            for x in range(PLACE):
                room.places[k, x], room.places[k - 1, x] = room.places[k - 1, x], room.places[k, x]
            k -= 1


@loop
def is_before(places, i, k):
    """Say whether the parameters of place i are before those of place k."""
    return places[i, 0] < places[k, 0] or (
        places[i, 0] == places[k, 0] and places[i, 1] < places[k, 1]
    )
