"""Covering a spline with samples, greedily: the widest gaps first."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..samples.samples import Samples
from .candidates import Candidates
from .grid import Grid
from .sizing import SizingFunction
from .triangles import Array, Indices, Triangles, cut_patches, refuse_more

__all__ = ["STEP", "Cover"]

# Samples are chosen within radii that fall from WIDEST times the expected radius on, each STEP
# times the one before.
WIDEST, STEP = 1.25, 0.98
# For a maximal set of n samples that are no closer to one another than r, relative to the sizing
# function, n r² is about this part of the integral of the target density.
PACKED = 0.6
# The radii of the triangles of candidates, relative to the covering radius. Smaller triangles are
# taken when the covering radius has fallen by the factor SMALLER.
FINE, SMALLER = 0.7, 1.3
# Where all of the surface is to be covered, and not candidates only, triangles that may hold an
# uncovered point are bisected until they have this radius, relative to the covering radius.
FINEST = 0.1
# Distances are renewed within this multiple of the radius first.
NEAR = 1.25
# The most triangles at a time: this number, or this multiple of the candidates.
MANY, TIMES = 2e7, 8


class _Known(NamedTuple):
    """What is known of samples, see `Cover`."""

    points: Array
    curvatures: Array
    exact: Array | None
    added: Triangles


class Cover:
    """Samples of a spline: some that are given, and others that are added until it is covered.

    A point is covered if a sample is within radius/√w, with the target density w of a sizing
    function. All lengths are scaled as in `SizingFunction`. Rows of `points` (N, 6), point and unit
    normal, and `curvatures` (N,), K, are the samples; the first `given` ones are those that were
    given (only the sign of their K counts, which is not scaled), the others lie at the places of
    the triangles `added`, of which the first ones are those of the `grid`, if there is one. Samples
    are evaluated together, when somebody asks for them; `exact` (added, k) are the other columns of
    their rows, see `OnSpline.as_samples`.

    Samples are chosen among the places of `triangles`. `show_count` is called with the number of
    samples when it has grown.

    The first `fixed` samples, those given and those of the grid, are never removed.

    `radius_asked`, if it is not 0, and `count_asked`, if it is not None, are what the cover was
    last asked for.
    """

    radius_asked: float
    count_asked: int | None

    def __init__(
        self,
        sizing: SizingFunction,
        given: Samples | None,
        show_count: Callable[[int], object] = lambda count: None,
        grid: Grid | None = None,
    ) -> None:
        """Begin with given samples of the same spline, and those of a grid."""
        self.sizing, self.show_count, self.grid = sizing, show_count, grid
        points, curvatures = np.empty((0, 6)), np.empty(0)
        if given is not None:
            points = np.column_stack([sizing.scaled_points(given.points), given.normals])
            curvatures = given.gaussian_curvature
        self._begin_with(
            points, curvatures, Triangles(sizing, np.empty(0, dtype=np.int64), np.empty((0, 3, 2)))
        )
        if grid is not None:
            self._append(grid.triangles)
        self.fixed = self.count

    def _begin_with(self, points: Array, curvatures: Array, added: Triangles) -> None:
        """Begin with given samples; `added` has no triangles."""
        self._known = _Known(points, curvatures, None, added)
        self._waiting: tuple[Triangles, ...] = ()
        self.given = self.fixed = len(points)
        self.fine, self.radius_asked, self.count_asked = FINE, 0.0, None

    @property
    def points(self) -> Array:
        """The points and unit normals (N, 6) of the samples."""
        return self._evaluated.points

    @property
    def curvatures(self) -> Array:
        """K (N,) of the samples."""
        return self._evaluated.curvatures

    @property
    def exact(self) -> Array | None:
        """The other columns (added, k) of the added samples; None without any sample."""
        return self._evaluated.exact

    @property
    def added(self) -> Triangles:
        """The triangles at whose places the added samples lie."""
        return self._evaluated.added

    @property
    def count(self) -> int:
        """The number of samples."""
        return len(self._known.points) + sum(map(len, self._waiting))

    def to_radius(self, radius: float, most: int | None = None) -> None:
        """Add samples until every point is within radius/√w of one, or there are `most`."""
        self.radius_asked = radius
        first = radius if most is None else max(radius, self._radius_for(most))
        self.take_candidates(first, WIDEST * first)
        self._to_radius_asked(WIDEST * first, most)

    def to_count(self, count: int) -> None:
        """Add samples until there are `count`."""
        radius = WIDEST * self._radius_for(count)
        self._begin(radius, count)
        while self.count == count > self.fixed + 1 and radius * radius < self.sizing.integral:
            # The first candidates have used up the count, wherever the widest gaps are.
            self.remove_added()
            radius *= 2.0
            self._begin(radius, count)
        self.fill_up(count)

    def fill_up(self, count: int) -> None:
        """Add samples in the widest gaps until there are `count`, which is asked from now on."""
        self.count_asked = count
        self.narrow(self.radius, 0.0, count)

    def to_what_was_asked(self, widest: float) -> None:
        """Add samples, with radii that fall from `widest` on, until there is what was asked."""
        if self.radius_asked > 0.0:
            self._to_radius_asked(widest, self.count_asked)
            widest = self.radius_asked
        if self.count_asked is not None:
            self.narrow(widest, 0.0, self.count_asked)

    def narrow(self, widest: float, least: float, most: int | None) -> None:
        """Add samples, with radii that fall from `widest` to `least`, until there are `most`."""
        radius = widest
        while self.count != most and radius > least:
            radius = max(STEP * radius, least)
            self.sweep(radius, most)

    def sweep(self, radius: float, most: int | None = None) -> None:
        """Add candidates until all of them are covered within a radius, or there are `most`."""
        if radius < self._candidates.radius / SMALLER:
            self.take_candidates(radius / SMALLER, radius)
        self.radius = radius
        self._choose(self.triangles, self._candidates, radius, most)

    def take_candidates(self, radius: float, widest: float) -> None:
        """Take candidates for sweeps with radii that fall from `widest` to this radius.

        They are the places of triangles whose radii are `fine` times the radius.
        """
        self.radius, self.triangles = widest, cut_patches(self.sizing, self.fine * radius)
        self._candidates = self._with_distances(self.triangles.at_places(), radius, widest)

    def whole(self) -> Triangles:
        """Return few triangles, which make up the surface."""
        return cut_patches(self.sizing, math.inf)

    def add(self, triangles: Triangles) -> None:
        """Add the places of some triangles as samples."""
        first = self.count
        self._append(triangles)
        self._candidates.update_distances(self.points[first:], self.radius)

    def renew_distances(self, widest: float) -> None:
        """Compute the distances of all candidates from the samples again, within `widest`."""
        self._candidates.reset_distances()
        # Nearly all candidates are that near to a sample. The others need the wide search.
        self._candidates.update_distances(self.points, min(NEAR * self.radius, widest))
        self._candidates.update_far(self.points, widest)

    def move_to_centres(self, first: int) -> None:
        """Move the samples from number `first` on to the centres of their Voronoi cells.

        The distances of the candidates have to be renewed before and after that.
        """
        chosen = self._candidates.centres(self.count)
        moved = first + np.flatnonzero(chosen[first:] >= 0)
        triangles = self.triangles[chosen[moved]]
        rows = triangles.as_samples()
        points, curvatures, exact, added = self._evaluated
        points[moved], curvatures[moved] = rows[:, :6], rows[:, 7]
        if exact is not None:
            exact[moved - self.given] = rows[:, 8:]
        added.write(moved - self.given, triangles)

    def remove_added(self) -> None:
        """Remove all samples that were added, except those of the grid."""
        self.keep(np.arange(self.fixed - self.given))

    def keep(self, numbers: Indices) -> None:
        """Keep some of the added samples, and remove the others."""
        rows = np.concatenate([np.arange(self.given), self.given + numbers])
        points, curvatures, exact, added = self._evaluated
        exact = None if exact is None else exact[numbers]
        self._known = _Known(points[rows], curvatures[rows], exact, added[numbers])

    def _radius_for(self, count: int) -> float:
        """Return the radius at which about `count` samples cover the surface."""
        return math.sqrt(PACKED * self.sizing.integral / count)

    def _begin(self, radius: float, count: int) -> None:
        self.take_candidates(radius / WIDEST, radius)
        self.sweep(radius, count)

    def _choose(
        self, triangles: Triangles, candidates: Candidates, radius: float, most: int | None
    ) -> None:
        """Add those places of some triangles that are far from all samples."""
        room = len(triangles) if most is None else most - self.count
        if room > 0:
            self._append(triangles[candidates.choose(radius, room)])
            self.show_count(self.count)

    def _append(self, triangles: Triangles) -> None:
        self._waiting += (triangles,)

    @property
    def _evaluated(self) -> _Known:
        """What is known of all samples, those that wait as well."""
        if not self._waiting:
            return self._known
        points, curvatures, exact, added = self._known
        triangles = sum(self._waiting[1:], start=self._waiting[0])
        rows = triangles.as_samples()
        self._waiting, self._known = (), _Known(
            np.concatenate([points, rows[:, :6]]),
            np.concatenate([curvatures, rows[:, 7]]),
            rows[:, 8:].copy() if exact is None else np.concatenate([exact, rows[:, 8:]]),
            added + triangles,
        )  # fmt: skip
        return self._known

    def _to_radius_asked(self, widest: float, most: int | None) -> None:
        self.narrow(widest, self.radius_asked, most)
        if self.count != most:
            self._cover_whole_surface(self.radius_asked, most)

    def _cover_whole_surface(self, radius: float, most: int | None) -> None:
        """Add samples until not only candidates are covered, but all points."""
        triangles, candidates, small, first = self.triangles, self._candidates, [], self.count
        while len(triangles):
            shares = triangles.radii * np.sqrt(candidates.densities) / radius
            far = candidates.distances > (1.0 - shares) * radius
            smallest = far & (shares <= FINEST)
            small.append(triangles[smallest])
            far &= ~smallest
            refuse_more(self.sizing, 4 * far.sum(), max(MANY, TIMES * len(self.triangles)))
            triangles = triangles[far].halves.halves
            candidates = self._with_distances(triangles.at_places(), radius, radius)
            self._choose(triangles, candidates, radius, most)
        self._cover_small_triangles(sum(small[1:], start=small[0]), radius, most)
        self._candidates.update_distances(self.points[first:], radius)

    def _cover_small_triangles(self, triangles: Triangles, radius: float, most: int | None) -> None:
        """Add places of small triangles until these are covered as a whole."""
        rows = triangles.at_places()
        # A triangle is covered by a sample that is closer to its place by its radius.
        rows[:, 6] /= (1.0 - triangles.radii * np.sqrt(rows[:, 6]) / radius) ** 2
        self._choose(triangles, self._with_distances(rows, radius, radius), radius, most)

    def _with_distances(self, rows: Array, radius: float, widest: float) -> Candidates:
        """Return rows as candidates with their distances from all samples, within `widest`."""
        candidates = Candidates(rows, radius, self.sizing.threads, split=True)
        candidates.update_distances(self.points, widest)
        return candidates
