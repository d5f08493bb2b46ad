"""Greedy covering of the pieces of a surface or a part with samples, the widest gaps first."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...runtime.base.aliases import Array, Indices
from .at_normals import Given
from .candidates import Candidates
from .cells import CHORD, RADIUS, Cells, joined, merged, points_of
from .grid import Grid
from .space import Space
from .voronoi import Voronoi

# The radii at which samples are chosen fall from WIDEST times the expected radius, by the factor
# STEP.
WIDEST, STEP = 1.25, 0.98
# For a maximal set of n samples with mutual distances of at least r, relative to the sizing
# function, n r² is about this part of the integral of the target density.
PACKED = 0.6
# The radii of the cells of candidates, relative to the covering radius. Cells are cut again when
# the covering radius has fallen by the factor SMALLER.
FINE, SMALLER = 0.4, 1.4
# To cover the whole surface, and not only candidates, cells that may contain an uncovered point are
# bisected down to this radius, relative to the covering radius.
FINEST = 0.07
# Boundaries are covered at points whose spacing is twice this part of the covering radius.
ON_BORDERS = 0.05
# Added samples move to the centres of their Voronoi cells twice. MISSING are the parts of the
# samples to be added that are still missing before the first move, between the moves, and after the
# second. With 0.12 before the first move, samples in a row leave wider gaps than without the moves.
MISSING = (0.2, 0.05, 0.0)
# The search for gaps, where the missing samples are added, begins with gaps of this multiple of the
# covering radius.
WIDEST_GAP = 2.0
# Gaps between candidates are searched down to the covering radius, then to this part of it.
STEP_DOWN = 0.85
# The largest number of cells that are bisected at a time, to bound the memory.
BLOCK = 1 << 18


class Cover:
    """The samples of a `Space`: given samples, and samples that are added until it is covered.

    A point is covered if a sample is within radius/√w, where w is the target density of the space.
    Lengths are scaled as in `Space`. The samples are rows of `points` (N, 6), point and unit
    normal, and `curvatures` (N,), K. The first `given` samples are the samples
    `at_normals`. The added samples lie at the places of the cells `added`, first the samples of the
    `grid`, if it exists.

    Samples are chosen among the places of `cells`. The cells have `numbers` if the samples are
    added for a radius. If they are added for a count, the cells have sides instead, see
    `Space.light`. `show_count` is called with the number of samples whenever it grows.

    The first `fixed` samples, given or on the grid, are never removed.

    `coverage`, in the unit L of the surface, and `angle`, in degrees, are bounds that the cover has
    reached, if known.
    """

    coverage: float | None = None
    angle: float | None = None

    def __init__(
        self,
        space: Space,
        given: Given | None = None,
        show_count: Callable[[int], object] = lambda count: None,
        grid: Grid | None = None,
    ) -> None:
        """Begin with the given samples at normals, and with the samples of a grid."""
        self.space, self.show_count, self.grid = space, show_count, grid
        self.at_normals = Given(space) if given is None else given
        rows = self.at_normals.rows
        self._points, self._curvatures = rows[:, :6], rows[:, 6]
        self._added, self._waiting = space.nothing(), list[Cells]()
        self.given = self.fixed = len(rows)
        if grid is not None:
            self._append(grid.cells)
            self.fixed = self.count

    @property
    def points(self) -> Array:
        """The points and unit normals (N, 6) of the samples."""
        return self._joined()._points

    @property
    def curvatures(self) -> Array:
        """The Gaussian curvatures K (N,) of the samples."""
        return self._joined()._curvatures

    @property
    def added(self) -> Cells:
        """The cells at whose places the added samples lie."""
        return self._joined()._added

    @property
    def count(self) -> int:
        """The number of samples."""
        return len(self._points) + sum(map(len, self._waiting))

    def to_radius(self, radius: float, most: int | None = None) -> None:
        """Add samples until every point is within radius/√w of a sample, or there are `most`."""
        first = radius if most is None else max(radius, self._radius_for(most))
        self.take_candidates(first, WIDEST * first)
        self.narrow(WIDEST * first, radius, most)
        if self.count != most:
            start = self.count
            self._cover_cells(self.cells, self._candidates, radius, most)
            self._cover_small_cells(self._borders(radius), radius, most)
            self._candidates.update_distances(self.points[start:], radius)

    def to_count(self, count: int) -> None:
        """Add samples until there are `count` samples in total."""
        radius = WIDEST * self._radius_for(count)
        # A few samples cover the surface, even a narrow strip, with this radius.
        largest = max(math.sqrt(self.space.integral), 0.5 * self.space.longest)
        self._begin(radius, count)
        while self.count == count > self.fixed + 1 and radius < largest:
            # The first chosen candidates used up the count, perhaps not in the widest gaps.
            self._replace_added(self.added[: self.fixed - self.given])
            radius *= 2.0
            self._begin(radius, count)
        self.fill_up(count)

    def spread(self, count: int) -> None:
        """Add samples until there are `count`: choose most of them, then move them and fill gaps.

        Moving and filling are done twice. A move takes each sample towards the centre of the
        smallest ball around its Voronoi cell: Lloyd's method for a high power of the distance
        instead of its square.
        """
        free = count - self.count
        self.to_count(count - round(MISSING[0] * free))
        if self.count > self.fixed:
            for missing in MISSING[1:]:
                assert self._sides is not None
                # The distance of a fine point from the place of its cell is at most 0.75 times the
                # radius of the cell. The sample nearest to the fine point is therefore within
                # `wide` of the place, except in a gap.
                wide = (1.0 + 1.5 * FINE) * self.radius
                voronoi = Voronoi(self._candidates, self.cells, self._sides, self.points, wide)
                self.move_to_centres(voronoi)
                self.fill_gaps(voronoi, WIDEST_GAP * self.radius, count - round(missing * free))

    def fill_up(self, count: int) -> None:
        """Add samples in the widest gaps until there are `count` samples in total."""
        self.narrow(self.radius, 0.0, count)

    def narrow(self, widest: float, least: float, most: int | None) -> None:
        """Sweep with radii that fall from `widest` to `least`, until there are `most` samples."""
        radius = widest
        while self.count != most and radius > least:
            radius = max(STEP * radius, least)
            self.sweep(radius, most)

    def sweep(self, radius: float, most: int | None = None) -> None:
        """Add candidates until all are within a radius of a sample, or there are `most` samples."""
        if radius < self._candidates.radius / SMALLER:
            self.take_candidates(radius / SMALLER, radius, light=self._sides is not None)
        self.radius = radius
        self._choose(self.cells, self._candidates, radius, most)

    def take_candidates(self, radius: float, widest: float, *, light: bool = False) -> None:
        """Make candidates for `sweep` with radii that fall from `widest` to `radius`.

        The candidates are the places of cells whose radii are FINE times `radius`.
        """
        for name in ("cells", "_candidates"):  # free the old ones, which take as much memory
            vars(self).pop(name, None)
        self.radius, radius_of_cells = widest, FINE * radius
        if light:
            self.cells, self._sides = self.space.candidates(radius_of_cells)
        else:
            self.cells, self._sides = self.space.cut(radius_of_cells), None
        self._candidates = self._with_distances(self.cells.rows, radius, widest)

    def whole(self, turn: float) -> Cells:
        """Return a few cells that partition the surface, and point cells along its boundaries.

        Normals turn by about `turn` radians from one point cell to the next. The `chords` of these
        cells include half of this angle.
        """
        space = self.space
        borders = space.along_borders(math.inf, turn)
        borders.numbers[:, CHORD] += turn / 2.0
        return merged([space.evaluated(space.first), borders])

    def missing(self) -> Cells:
        """Return a cell near the middle of each piece that has cells but no sample."""
        held = np.concatenate([self.at_normals.pieces, self.added.pieces])
        return self.space.middles(np.setdiff1d(self.space.first.pieces, held))

    def remove_last(self, number: int) -> None:
        """Remove the `number` samples added last, but leave an added sample on each piece."""
        numbers = np.bincount(self.added.pieces, minlength=len(self.space.pieces))
        removed: list[int] = []
        for k in range(len(self.added) - 1, self.fixed - self.given - 1, -1):
            if len(removed) == number:
                break
            if numbers[self.added.pieces[k]] > 1:
                numbers[self.added.pieces[k]] -= 1
                removed.append(k)
        self._replace_added(self.added[np.setdiff1d(np.arange(len(self.added)), removed)])
        self.renew_distances(self.radius)

    def add(self, cells: Cells) -> None:
        """Add the places of cells as samples."""
        first = self.count
        self._append(cells)
        self._candidates.update_distances(self.points[first:], self.radius)

    def evaluate_exactly(self) -> None:
        """Replace the added samples by points and normals of the sampled surface itself.

        Samples that are added later are taken from this surface, too.
        """
        space, added = self.space.exact, self.added
        if space is not self.space:
            self.space = space
            self._replace_added(space.light(added, keep=True)[0])

    def renew_distances(self, widest: float) -> None:
        """Recompute all distances of at most `widest` between candidates and samples."""
        self._candidates.reset_distances()
        self._candidates.update_distances(self.points, widest)

    def move_to_centres(self, voronoi: Voronoi) -> None:
        """Move the samples that are not fixed to approximate centres of their Voronoi cells."""
        moved, rows, places = voronoi.centres(self.points, self.fixed)
        cells, order = self._evaluated_at(rows, places)
        regular = np.flatnonzero(cells.rows[:, 3:6].any(axis=1))
        moved, cells = moved[order][regular], cells[regular]
        self.points[moved], self.curvatures[moved] = cells.rows[:, :6], cells.rows[:, 7]
        self.added.write(moved - self.given, cells)

    def fill_gaps(self, voronoi: Voronoi, widest: float, count: int) -> None:
        """Add samples at fine points of cells, the widest gaps first, until there are `count`.

        The search begins with gaps of the radius `widest`.
        """
        least, start = self.radius, self.count
        target = self.space.target
        is_angle = len(self.space.pieces) == 1 and target.curvature_weight * target.exponent == 1.0
        bounds = STEP_DOWN * least, widest if is_angle else 0.0, target.ceiling
        rows, places, gaps = voronoi.widest(self.points, bounds)
        for radius in (least, STEP_DOWN * least):
            if self.count == count:
                return
            far = np.flatnonzero(gaps[:, 1] >= radius * radius)
            cells, order = self._evaluated_at(rows[far], places[far])
            cells.rows[:, 6], squares = gaps[far[order]].T
            candidates = Candidates(cells.rows, radius, self.space.threads, split=True)
            candidates.reset_distances(squares)
            candidates.update_distances(self.points[start:], widest)
            while widest > radius and self.count < count:
                widest = max(STEP * widest, radius)
                self._choose(cells, candidates, widest, count)
        if self.count < count:
            self.renew_distances(widest)
            self.narrow(widest, 0.0, count)

    def _evaluated_at(self, rows: Indices, places: Array) -> tuple[Cells, Indices]:
        """Return evaluated point cells, sorted by piece, and the order (k,) that sorts them.

        The point cells are at parameters `places` (k, 2) in the cells with the indices `rows` (k,).
        """
        order = np.argsort(self.cells.pieces[rows], kind="stable")
        rows = rows[order]
        pieces, limits = self.cells.pieces[rows], self.cells.limits[rows]
        cells = points_of(pieces, places[order], self.space.sizes[pieces], limits)
        return self.space.light(cells, keep=True)[0], order

    def _radius_for(self, count: int) -> float:
        """Return the radius at which about `count` samples cover the surface.

        On a strip narrower than the radius, the samples lie in a row.
        """
        packed = math.sqrt(PACKED * self.space.integral / count)
        return max(packed, 0.5 * self.space.longest / count)

    def _begin(self, radius: float, count: int) -> None:
        self.take_candidates(radius / WIDEST, radius, light=True)
        self.sweep(radius, count)

    def _choose(
        self, cells: Cells, candidates: Candidates, radius: float, most: int | None
    ) -> None:
        """Add the places of cells farther than a radius from all samples, up to `most` samples."""
        room = len(cells) if most is None else most - self.count
        if room > 0:
            self._append(cells[candidates.choose(radius, room)])
            self.show_count(self.count)

    def _append(self, cells: Cells) -> None:
        if len(cells):
            self._waiting.append(cells.without_numbers())

    def _replace_added(self, cells: Cells) -> None:
        self._points, self._curvatures = self._points[: self.given], self._curvatures[: self.given]
        self._added, self._waiting = self.space.nothing(), list[Cells]()
        self._append(cells)

    def _joined(self) -> Cover:
        """Append pending samples to the arrays, and return the cover.

        Added samples are kept in a list first, since it is faster to concatenate many at once.
        """
        if self._waiting:
            added = joined(self._waiting)
            self._waiting = []
            self._points = np.concatenate([self._points, added.rows[:, :6]])
            self._curvatures = np.concatenate([self._curvatures, added.rows[:, 7]])
            self._added = self._added + added
        return self

    def _cover_cells(
        self, cells: Cells, candidates: Candidates, radius: float, most: int | None
    ) -> None:
        """Add samples until each of the cells is covered as a whole, not only its place."""
        shares = cells.radii * np.sqrt(cells.rows[:, 6]) / radius
        far, small = candidates.distances > (1.0 - shares) * radius, shares <= FINEST
        large = np.flatnonzero(far & ~small)
        for first in range(0, len(large), BLOCK):
            if self.count == most:
                return
            halves = self.space.halves(cells[large[first : first + BLOCK]])
            places = self._with_distances(halves.rows, radius, radius)
            self._choose(halves, places, radius, most)
            self._cover_cells(halves, places, radius, most)
        self._cover_small_cells(cells[far & small], radius, most)

    def _borders(self, radius: float) -> Cells:
        """Return point cells along boundaries, with radii that reach halfway to the next cell.

        In tips too narrow for other cells, the balls of these radii cover the surface.
        """
        borders = self.space.along_borders(2.0 * ON_BORDERS * radius)
        borders.numbers[:, RADIUS] += ON_BORDERS * radius / np.sqrt(borders.rows[:, 6])
        return borders

    def _cover_small_cells(self, cells: Cells, radius: float, most: int | None) -> None:
        """Add places of small cells until these cells are covered as a whole."""
        if not len(cells):
            return
        rows = cells.rows.copy()
        # A sample covers a cell if its distance from the place plus the radius of the cell is at
        # most the covering radius.
        rows[:, 6] /= (1.0 - cells.radii * np.sqrt(rows[:, 6]) / radius) ** 2
        self._choose(cells, self._with_distances(rows, radius, radius), radius, most)

    def _with_distances(self, rows: Array, radius: float, widest: float) -> Candidates:
        """Return rows (M, 8) of cells as candidates, with distances from samples up to `widest`."""
        candidates = Candidates(rows, radius, self.space.threads, split=True)
        for samples in (self._points, *(x.rows[:, :6] for x in self._waiting)):
            candidates.update_distances(samples, widest)
        return candidates
