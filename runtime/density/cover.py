"""Covering a spline with samples, greedily: the widest gaps first."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..samples import Samples
from .candidates import Candidates
from .law import Wanted
from .pieces import Array, Pieces, cut_patches, refuse_more

__all__ = ["STEP", "Cover"]

# The first samples come where none is within so many times the radius that is expected, the next
# ones within STEP of that, and so on.
WIDEST, STEP = 1.25, 0.98
# n samples that are no nearer to one another than a radius r, where there is no room for another,
# have about n r² times this as what is wanted of them.
PACKED = 0.6
# Candidates are the middles of triangles that reach so far, beside the radius. Others are taken if
# it is so many times smaller than that of the last.
FINE, SMALLER = 0.7, 1.3
# If all of the surface has to be near enough, and not only candidates, triangles that may hold a
# place which is not are cut until they reach so far.
FINEST = 0.1
# No more than so many at a time, or so many times as many as there were.
MANY, TIMES = 2e7, 8


class Cover:
    """Samples that are given, and others that are added until every place is near enough to one.

    Near enough is within radius / √weight, by a `Law` of weights. Lengths are those of the spline
    times `wanted.unit`. Rows of `points` (…, 6) (and normals) and `curvatures` (K) are the samples;
    the first `given` are those that were given, all others lie in the middles of `added`.

    Samples are chosen among the middles of `pieces`. `tell` is told how many there are.

    What was asked for is kept: `least`, the radius, if it is not 0, and `most`, the count, if there
    is one.
    """

    least: float
    most: int | None

    def __init__(
        self,
        wanted: Wanted,
        given: Samples | None,
        tell: Callable[[int], object] = lambda count: None,
    ) -> None:
        """Begin with what is given, samples of the same spline."""
        self.wanted, self.tell = wanted, tell
        self.points, self.curvatures = np.empty((0, 6)), np.empty(0)
        if given is not None:
            self.points = np.column_stack([wanted.places(given.points), given.normals])
            self.curvatures = given.gaussian_curvature / wanted.unit**2
        self.given, self.fine = len(self.points), FINE
        self.least, self.most = 0.0, None
        self.forget()

    @property
    def count(self) -> int:
        """How many samples there are."""
        return len(self.points)

    def to_radius(self, radius: float, most: int | None = None) -> None:
        """Add samples until every place is within radius / √weight of one, or there are `most`."""
        self.least = radius
        first = radius if most is None else max(radius, self._radius_of(most))
        self.take_candidates(first, WIDEST * first)
        self._to_radius(WIDEST * first, most)

    def to_count(self, count: int) -> None:
        """Add samples until there are so many."""
        radius = WIDEST * self._radius_of(count)
        self._begin(radius, count)
        while self.count == count > self.given + 1 and radius * radius < self.wanted.total:
            # That is not where the widest gaps are, but those that came first.
            self.forget()
            radius *= 2.0
            self._begin(radius, count)
        self.fill_up(count)

    def fill_up(self, count: int) -> None:
        """Add samples where gaps are widest until there are so many: that is asked from now on."""
        self.most = count
        self.narrow(self.radius, 0.0, count)

    def to_what_was_asked(self, widest: float) -> None:
        """Sweep within radii from `widest` on, until there is what was asked for."""
        if self.least > 0.0:
            self._to_radius(widest, self.most)
            widest = self.least
        if self.most is not None:
            self.narrow(widest, 0.0, self.most)

    def narrow(self, widest: float, least: float, most: int | None) -> None:
        """Sweep within ever smaller radii, until `least` or until there are `most` samples."""
        radius = widest
        while self.count != most and radius > least:
            radius = max(STEP * radius, least)
            self.sweep(radius, most)

    def sweep(self, radius: float, most: int | None = None) -> None:
        """Add candidates until all are near enough within this radius, or there are `most`."""
        if radius < self._candidates.radius / SMALLER:
            self.take_candidates(radius / SMALLER, radius)
        self.radius = radius
        self._choose(self.pieces, self._candidates, radius, most)

    def take_candidates(self, radius: float, widest: float) -> None:
        """Take candidates for sweeps until this radius; the first one may be as wide as `widest`.

        They are the middles of triangles that reach `fine` times the radius.
        """
        self.radius, self.pieces = widest, cut_patches(self.wanted, self.fine * radius)
        self._candidates = self._told(self.pieces.middles(), radius, widest)

    def add(self, pieces: Pieces) -> None:
        """Add the middles of some pieces as samples."""
        first = self.count
        self._append(pieces)
        self._candidates.tell(self.points[first:], self.radius)

    def tell_again(self, widest: float) -> None:
        """Tell all candidates of the samples within the radius `widest`, and of no others."""
        self._candidates.forget()
        self._candidates.tell(self.points, widest)

    def centre(self, first: int) -> None:
        """Move samples from number `first` on to the middle of the places that they are nearest to.

        Candidates have to be told again before and after that.
        """
        chosen = self._candidates.centres(self.count)
        moved = first + np.flatnonzero(chosen[first:] >= 0)
        pieces = self.pieces[chosen[moved]]
        rows = pieces.middles()
        self.points[moved], self.curvatures[moved] = rows[:, :6], rows[:, 7]
        self.added.patches[moved - self.given] = pieces.patches
        self.added.corners[moved - self.given] = pieces.corners

    def forget(self) -> None:
        """Take out all samples that were added."""
        self.points, self.curvatures = self.points[: self.given], self.curvatures[: self.given]
        self.added = Pieces(self.wanted, np.empty(0, dtype=np.int64), np.empty((0, 3, 2)))

    def _radius_of(self, count: int) -> float:
        """Return which radius brings about so many samples."""
        return math.sqrt(PACKED * self.wanted.total / count)

    def _begin(self, radius: float, count: int) -> None:
        self.take_candidates(radius / WIDEST, radius)
        self.sweep(radius, count)

    def _choose(
        self, pieces: Pieces, candidates: Candidates, radius: float, most: int | None
    ) -> None:
        """Add those of the middles of some pieces that are far from all samples."""
        room = len(pieces) if most is None else most - self.count
        if room > 0:
            self._append(pieces[candidates.choose(radius, room)])
            self.tell(self.count)

    def _append(self, pieces: Pieces) -> None:
        rows = pieces.middles()
        self.added += pieces
        self.points = np.concatenate([self.points, rows[:, :6]])
        self.curvatures = np.concatenate([self.curvatures, rows[:, 7]])

    def _to_radius(self, widest: float, most: int | None) -> None:
        self.narrow(widest, self.least, most)
        if self.count != most:
            self._close(self.least, most)

    def _close(self, radius: float, most: int | None) -> None:
        """Add samples until not only candidates are within radius / √weight of one."""
        pieces, candidates, small, first = self.pieces, self._candidates, [], self.count
        while len(pieces):
            shares = pieces.extents * np.sqrt(candidates.weights) / radius
            far = candidates.distances > (1.0 - shares) * radius
            uncut = far & (shares <= FINEST)
            small.append(pieces[uncut])
            far &= ~uncut
            refuse_more(self.wanted, 4 * far.sum(), max(MANY, TIMES * len(self.pieces)))
            pieces = pieces[far].halves.halves
            candidates = self._told(pieces.middles(), radius, radius)
            self._choose(pieces, candidates, radius, most)
        self._choose_strictly(sum(small[1:], start=small[0]), radius, most)
        self._candidates.tell(self.points[first:], radius)

    def _choose_strictly(self, pieces: Pieces, radius: float, most: int | None) -> None:
        """Add middles of small pieces until all of each is within radius / √weight of a sample."""
        rows = pieces.middles()
        # A sample that is nearer to the middle by the extent is near enough to the whole piece.
        rows[:, 6] /= (1.0 - pieces.extents * np.sqrt(rows[:, 6]) / radius) ** 2
        self._choose(pieces, self._told(rows, radius, radius), radius, most)

    def _told(self, rows: Array, radius: float, widest: float) -> Candidates:
        """Return middles of pieces as candidates that know of all samples."""
        candidates = Candidates(rows, radius, self.wanted.threads, split=True)
        candidates.tell(self.points, widest)
        return candidates
