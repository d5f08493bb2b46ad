"""Choosing samples among many places: those that are far from all samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..kernels.centres import link_cells, move_to_centres
from ..kernels.greedy import choose_far, update_distances
from ..kernels.hash_grids import LEVELS, SQUARE, HashGrids, measure, sort_candidates
from ..threads import over_ranges

__all__ = ["Candidates"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Numbers = NDArray[np.int32]
Result = TypeVar("Result")

# Threads work on parts of the places: of about so many, but no more than MOST parts.
PART, MOST = 1 << 16, 64
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

    def __init__(
        self, rows: Array, radius: float, threads: int | None = None, split: bool = False
    ) -> None:
        """Sort places into grids, which suit radii that are not very much larger than this one.

        If there are many, they are `split` into parts for the threads: rows that follow one another
        should be neighbours then.
        """
        count, self.radius, self._threads = len(rows), radius, threads
        parts = min(max(count // PART, 1), MOST) if split else 1
        self._order, self._places = np.empty(count, dtype=np.int32), np.empty((count, 8))
        self._nearest = np.full(count, -1, dtype=np.int32)
        edges = np.linspace(0, count, parts + 1).astype(np.int64)

        def part(k: int) -> _Part:
            here = slice(int(edges[k]), int(edges[k + 1]))
            order = self._order[here]
            made = _Part(rows[here], radius, order, self._places[here], self._nearest[here])
            order += np.int32(here.start)
            return made

        self._parts = self._each(part, parts)

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

    def tell(self, samples: Array, radius: float) -> None:
        """Tell places within a radius of samples (N, 6), point and unit normal."""
        self._each(lambda k: self._parts[k].tell(samples, radius), len(self._parts))

    def forget(self) -> None:
        """Forget what samples have told."""
        self._each(lambda k: self._parts[k].forget(), len(self._parts))

    def choose(self, radius: float, most: int) -> Indices:
        """Choose places until all of them are near enough to a sample.

        Returns their rows; `most` of them, all over the surface, if there are more. Then what other
        places know is no longer true.
        """
        found = dict[int, Numbers]()
        # Every other part at a time: neighbours would choose places that are near to one another.
        for turn in (0, 1):
            now = range(turn, len(self._parts), 2)
            rows = self._each(lambda i, now=now: self._parts[now[i]].choose(radius), len(now))
            found |= zip(now, rows, strict=True)
            self._exchange({k: self._parts[k].places[found[k], :6] for k in now}, radius)
        rows = [part.order[found[k]] for k, part in enumerate(self._parts)]
        chosen = np.concatenate(rows).astype(np.int64)
        return chosen if len(chosen) <= most else chosen[np.arange(most) * len(chosen) // most]

    def centres(self, count: int) -> Indices:
        """Return for each of `count` samples the place in the middle of those it is nearest to.

        That is the row of the place next to the centre of the smallest ball around them, distances
        times √weight; −1 if there are none. All samples were told at once, and none chosen since.
        """
        heads, links = (np.full(x, -1, dtype=np.int32) for x in (count, len(self._order)))
        link_cells(self._nearest, heads, links)
        found = np.empty(count, dtype=np.int64)

        def work(first: int, last: int) -> None:
            move_to_centres(self._places, heads, links, first, last, found)

        for _ in over_ranges(work, count, CENTRES_AT_A_TIME, self._threads):
            pass
        return np.where(found < 0, -1, self._order[found])

    def _exchange(self, samples: Mapping[int, Array], radius: float) -> None:
        """Tell every part of the samples of other parts."""

        def learn(k: int) -> None:
            for other, points in samples.items():
                if other != k:
                    self._parts[k].tell(points, radius)

        self._each(learn, len(self._parts))

    def _each(self, work: Callable[[int], Result], count: int) -> list[Result]:
        return list(over_ranges(lambda first, last: work(first), count, 1, self._threads))


class _Part:
    """Some of the places in grids of their own."""

    def __init__(
        self, rows: Array, radius: float, order: Numbers, places: Array, nearest: Numbers
    ) -> None:
        """Sort rows into arrays of the same length."""
        count = len(rows)
        box, sizes = np.empty((2, 3)), np.zeros(LEVELS)
        finest, coarsest = measure(rows, box, sizes)
        starts = np.zeros((1 << max(count - 1, 1).bit_length()) + 1, dtype=np.int32)
        sizes = sizes[finest : coarsest + 1].copy()
        self.grids = HashGrids(places, nearest, starts, sizes, box, radius)
        sort_candidates(rows, finest, self.grids, np.empty(count, dtype=np.int32), order)
        self.order, self.asked, self.least = order, np.empty(0, dtype=np.int32), np.inf

    @property
    def places(self) -> Array:
        return self.grids.candidates

    def tell(self, samples: Array, radius: float) -> None:
        update_distances(self.grids, radius, samples)

    def forget(self) -> None:
        squares = self.grids.candidates[:, SQUARE]
        squares[squares >= 0.0] = np.inf
        self.grids.nearest[:], self.least = -1, np.inf

    def choose(self, radius: float) -> Numbers:
        if radius <= self.least:
            self.least = LEFT_OUT * radius
            self.asked = np.arange(len(self.places), dtype=np.int32)
        chosen = np.empty(len(self.asked), dtype=np.int32)
        kept, count = choose_far(self.grids, radius, self.least, self.asked, chosen)
        self.asked = self.asked[:kept]
        return chosen[:count]
