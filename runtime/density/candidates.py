"""Choosing samples among many places: those that are far from all samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels
from ..threads import over_ranges

__all__ = ["Candidates"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Numbers = NDArray[np.int32]

# So many places or samples are worked on before Ctrl-C is listened to.
AT_A_TIME = 1 << 14
# Places that are nearer to a sample than so many times a radius are left out of the next searches.
LEFT_OUT = 0.7
CENTRES_AT_A_TIME = 1 << 9


class Candidates:
    """Places that may become samples, each of which knows how near a sample is.

    Rows (M, 8) of point, unit normal, weight, and one more number; places without a normal are
    never chosen. Near enough is within radius / √weight, by the weight of the place, and on the
    same side of the surface: the angle between the normals is 90 degrees at most.

    Samples tell the places around them how near they are, instead of being asked again and again:
    a place is told by a few dozens of samples, all in all.
    """

    def __init__(self, rows: Array, radius: float) -> None:
        """Sort places into grids, which suit radii that are not very much larger than this one."""
        count = len(rows)
        self.radius = radius
        finest, self._widest = kernels.gaps_of(rows)
        self._starts = np.zeros((1 << max(count - 1, 1).bit_length()) + 1, dtype=np.int32)
        self._order, self._places = np.empty(count, dtype=np.int32), np.empty((count, 8))
        self._nearest = np.full(count, -1, dtype=np.int32)
        kernels.sort_places(
            rows, radius, finest, self._widest, self._starts, np.empty(count, dtype=np.int32),
            self._order, self._places,
        )  # fmt: skip
        self._asked, self._least = np.empty(0, dtype=np.int32), np.inf

    @property
    def _grids(self) -> tuple[Array, Numbers, Numbers, Array, float]:
        return self._places, self._nearest, self._starts, self._widest, self.radius

    @property
    def distances(self) -> Array:
        """How far each place (M,) is from a sample, times √weight: the nearest, if it told.

        That is infinite where there is no normal.
        """
        known, squares = np.empty(len(self._order)), self._places[:, 7]
        known[self._order] = np.sqrt(np.where(squares < 0.0, np.inf, squares))
        return known

    @property
    def weights(self) -> Array:
        """The weights of the places (M,)."""
        weights = np.empty(len(self._order))
        weights[self._order] = self._places[:, 6]
        return weights

    def tell(self, samples: Array, radius: float, number: int = 0) -> None:
        """Tell places within a radius of samples (N, 6), point and unit normal, numbered from …."""
        for first, last in _ranges(len(samples)):
            kernels.tell_of_samples(*self._grids, radius, number, samples, first, last)

    def forget(self) -> None:
        """Forget what samples have told."""
        regular = self._places[:, 7] >= 0.0
        self._places[regular, 7], self._nearest[:], self._least = np.inf, -1, np.inf

    def choose(
        self,
        radius: float,
        most: int,
        number: int = 0,
        told: Callable[[int], object] = lambda count: None,
    ) -> Indices:
        """Choose places until all of them are near enough to a sample, or `most` are chosen.

        Returns their rows; as samples, they are numbered from `number` on. `told` is told how many
        samples there are, from time to time.
        """
        if radius <= self._least:
            self._least = LEFT_OUT * radius
            self._asked = np.arange(len(self._order), dtype=np.int32)
        chosen = np.empty(min(most, len(self._asked)), dtype=np.int32)
        counts = np.zeros(2, dtype=np.int64)
        for first, last in _ranges(len(self._asked)):
            kernels.choose_far(
                *self._grids, radius, number, self._least, self._asked, first, last, len(chosen),
                chosen, counts,
            )  # fmt: skip
            told(number + int(counts[1]))
        self._asked = self._asked[: counts[0]]
        return self._order[chosen[: counts[1]]].astype(np.int64)

    def centres(self, count: int, threads: int | None) -> Indices:
        """Return for each of `count` samples the place in the middle of those it is nearest to.

        That is the row of the place next to the centre of the smallest ball around them, distances
        times √weight; −1 if there are none.
        """
        heads, links = (np.full(x, -1, dtype=np.int32) for x in (count, len(self._order)))
        kernels.list_places(self._nearest, heads, links)
        found = np.empty(count, dtype=np.int64)

        def work(first: int, last: int) -> None:
            kernels.centres(self._places, heads, links, first, last, found)

        for _ in over_ranges(work, count, CENTRES_AT_A_TIME, threads):
            pass
        return np.where(found < 0, -1, self._order[found])


def _ranges(count: int) -> Iterator[tuple[int, int]]:
    return ((first, min(first + AT_A_TIME, count)) for first in range(0, count, AT_A_TIME))
