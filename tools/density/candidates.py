"""Choosing samples among candidates: a candidate far from all samples becomes a sample."""

from collections.abc import Callable, Mapping
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.threads import over_ranges
from .kernels.greedy import choose_far, update_distances
from .kernels.hash_grids import LEVELS, SQUARE, HashGrids, measure, sort_candidates

Numbers = NDArray[np.int32]
Result = TypeVar("Result")

# Candidates are split into parts for threads: into at most FEW parts of at least SMALL candidates,
# or, if they are many, into at most MOST parts of at least PART candidates.
SMALL, FEW, PART, MOST = 1 << 13, 8, 1 << 16, 64
# After a search with a radius, candidates nearer to a sample than this part of the radius are left
# out of the next searches.
LEFT_OUT = 0.7


class Candidates:
    """Candidates for samples, each with its distance from the nearest sample.

    Candidates are rows (M, 8): point, unit normal, density w, and a column that is ignored. A
    candidate without a normal is never chosen. All distances are multiplied by √w of the candidate.
    A sample counts only for candidates on its side of the surface: the angle between their normals
    is at most 60 degrees.

    A new sample updates the distances of the candidates around it: a few dozen updates of each
    candidate in total.
    """

    def __init__(
        self, rows: Array, radius: float, threads: int | None = None, split: bool = False
    ) -> None:
        """Sort candidates into grids for searches with radii of about `radius` or less.

        With `split`, many candidates are split into parts for the threads; then consecutive rows
        should be neighbours in space.
        """
        count, self.radius, self.threads = len(rows), radius, threads
        parts = max(min(count // SMALL, FEW), min(count // PART, MOST), 1) if split else 1
        self._order, self._sorted = np.empty(count, dtype=np.int32), np.empty((count, 8))
        edges = np.linspace(0, count, parts + 1).astype(np.int64)

        def part(k: int) -> Block:
            here = slice(int(edges[k]), int(edges[k + 1]))
            order = self._order[here]
            made = Block(rows[here], radius, order, self._sorted[here])
            order += np.int32(here.start)
            return made

        self.parts = self.each(part, parts)

    @property
    def distances(self) -> Array:
        """The distances (M,) from the nearest samples, as of the last updates.

        They are infinite for candidates without a normal.
        """
        known, squares = np.empty(len(self._order)), self._sorted[:, SQUARE]
        known[self._order] = np.sqrt(np.where(squares < 0.0, np.inf, squares))
        return known

    def update_distances(self, samples: Array, radius: float) -> None:
        """Update the distances of candidates within a radius of samples (N, 6).

        A row of a sample is its point and unit normal.
        """
        samples = np.ascontiguousarray(samples)
        self.each(lambda k: self.parts[k].update_distances(samples, radius), len(self.parts))

    def reset_distances(self, squares: Array | None = None) -> None:
        """Set all distances to infinity, or their squares to `squares` (M,)."""
        for part in self.parts:
            part.reset_distances(np.inf if squares is None else squares[part.order])

    def choose(self, radius: float, most: int) -> Indices:
        """Choose candidates until each of the others is near a sample or a chosen candidate.

        Near means within `radius`. Return the row indices of the chosen candidates. If they are
        more than `most`, return only `most` of them, from all over the surface; then distances are
        too small, since the chosen candidates that are not returned count as samples.
        """
        found = dict[int, Numbers]()
        # First the even parts, then the odd ones: neighbouring parts that choose at the same time
        # would choose candidates close to one another.
        for turn in (0, 1):
            now = range(turn, len(self.parts), 2)
            rows = self.each(lambda i, now=now: self.parts[now[i]].choose(radius), len(now))
            found |= zip(now, rows, strict=True)
            self._update_other_parts(dict(zip(now, rows, strict=True)), radius)
        rows = [part.order[found[k]] for k, part in enumerate(self.parts)]
        chosen = np.concatenate(rows).astype(np.int64)
        return chosen if len(chosen) <= most else chosen[np.arange(most) * len(chosen) // most]

    def _update_other_parts(self, chosen: Mapping[int, Numbers], radius: float) -> None:
        """Update the distances in each part for the candidates chosen in all other parts."""
        numbers = np.zeros(len(self.parts) + 1, dtype=np.int64)
        for k, rows in chosen.items():
            numbers[k + 1] = len(rows)
        ends = np.cumsum(numbers)
        if ends[-1] == 0 or len(self.parts) == 1:
            return
        samples = np.concatenate(
            [self.parts[k].grids.candidates[rows, :6] for k, rows in chosen.items()]
        )

        def update(k: int) -> None:
            for others in (samples[: ends[k]], samples[ends[k + 1] :]):
                if len(others):
                    self.parts[k].update_distances(others, radius)

        self.each(update, len(self.parts))

    def each(self, work: Callable[[int], Result], count: int) -> list[Result]:
        """Return the list of work(k) for all k < count; the calls run on the threads."""
        return list(over_ranges(lambda first, last: work(first), count, 1, self.threads))


class Block:
    """A part of the candidates, with its own hash grids."""

    def __init__(self, rows: Array, radius: float, order: Numbers, candidates: Array) -> None:
        """Sort rows into grids: write them to `candidates`, and their indices to `order`."""
        count = len(rows)
        box, sizes = np.empty((2, 3)), np.zeros(LEVELS)
        finest, coarsest = measure(rows, box, sizes)
        starts = np.zeros((1 << max(count - 1, 1).bit_length()) + 1, dtype=np.int32)
        sizes = sizes[finest : coarsest + 1].copy()
        self.grids = HashGrids(candidates, starts, sizes, box, radius)
        sort_candidates(rows, finest, self.grids, np.empty(count, dtype=np.int32), order)
        self.order = order
        # `searched` are the candidates that were farther than `least` from all samples.
        self.searched, self.least = np.empty(0, dtype=np.int32), np.inf

    def update_distances(self, samples: Array, radius: float) -> None:
        """See `Candidates.update_distances`."""
        update_distances(self.grids, radius, samples)

    def reset_distances(self, values: Array | float) -> None:
        """See `Candidates.reset_distances`."""
        squares = self.grids.candidates[:, SQUARE]
        squares[:] = np.where(squares < 0.0, squares, values)
        self.least = np.inf

    def choose(self, radius: float) -> Numbers:
        """Return the rows, in the grids, of chosen candidates; see `Candidates.choose`."""
        if radius <= self.least:
            self.least = LEFT_OUT * radius
            self.searched = np.arange(len(self.order), dtype=np.int32)
        chosen = np.empty(len(self.searched), dtype=np.int32)
        kept, count = choose_far(self.grids, radius, self.least, self.searched, chosen)
        self.searched = self.searched[:kept]
        return chosen[:count]
