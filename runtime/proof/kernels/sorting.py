"""Solutions sorted by normal (a counting sort), and for each normal by u and v."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...machine_code.jit import jit, loop
from .evaluated_pairs import PLACE


class Sorted(NamedTuple):
    """Arrays for sorted solutions (k, 6) of a search, and the indices (k,) of their normals."""

    numbers: NDArray[np.int64]
    places: NDArray[np.float64]

    @classmethod
    def new(cls, count: int) -> Sorted:
        """Return empty arrays for a number of solutions."""
        return cls(np.empty(count, np.int64), np.empty((count, PLACE)))


@jit
def count_places(numbers, starts):
    """Add the number of solutions for each normal n to starts[n + 1]; `starts` is (S + 1,)."""
    for k in range(numbers.size):
        starts[numbers[k] + 1] += 1


@jit
def start_normals(starts):
    """Replace the numbers of solutions by their cumulative sums, the starts."""
    for n in range(starts.size - 1):
        starts[n + 1] += starts[n]


@jit
def put_places(places, numbers, starts, room):
    """Write solutions (k, 6) at the starts of their normals, and advance the starts."""
    for k in range(numbers.size):
        at = starts[numbers[k]]
        starts[numbers[k]] = at + 1
        room.numbers[at] = numbers[k]
        for x in range(PLACE):
            room.places[at, x] = places[k, x]


@jit
def order_places(room):
    """Sort the solutions for each normal by u, then v."""
    for first in range(1, room.numbers.size):
        k = first
        while k > 0 and room.numbers[k - 1] == room.numbers[k] and is_before(room.places, k, k - 1):
            for x in range(PLACE):
                room.places[k, x], room.places[k - 1, x] = room.places[k - 1, x], room.places[k, x]
            k -= 1


@loop
def is_before(places, i, k):
    """Return whether the parameters of solution i precede those of solution k."""
    return places[i, 0] < places[k, 0] or (
        places[i, 0] == places[k, 0] and places[i, 1] < places[k, 1]
    )
