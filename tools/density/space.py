"""The space that is sampled: all pieces as one surface, with cells and a target density."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.checks import finite_array
from ...runtime.base.errors import InputError
from ...runtime.base.scales import scale_to_one
from ...runtime.base.threads import over_ranges
from .along_borders import BorderLines, places_along, polygons_of
from .cells import (
    ALONG_U,
    ALONG_V,
    AREA,
    BEND_U,
    BEND_V,
    CHORD,
    RADIUS,
    Cells,
    Sides,
    grouped,
    halved,
    into_parts,
    merged,
    new_cells,
    points_of,
    runs,
)
from .grading import Sources, bounds_of, growth_for
from .kernels.cells import evaluate_cells, evaluate_places
from .kernels.sizing import TargetDensity
from .piece import Piece
from .sifting import beside, placed, sifted
from .trims import Trims

# The cells `Space.first` bend by at most this along u and along v, in radians, unless they would
# have to be bisected more often than MOST_BENDS.
FLAT = 0.3
MOST_BENDS = 24
# Cells of `Space.first` without a place inside the trim are quartered at most this many times.
MOST_LOST = 4
# The least and the largest number of pixels along u and v of the rasters of boundaries.
FEWEST_PIXELS, MOST_PIXELS = 64, 512
# Cells that the boundary intersects are cut in two steps if they are cut into more parts than this.
AT_ONCE = 64
# A cell is not cut further if its sides are at most this part of the sides of the domain of its
# piece, or if its radius is at most this part of the square root of the area of the piece.
DEEPEST = 2.0**-14
MOST_CELLS = 2e9
# The factor by which the chord of `cut_by_normals` is increased while cells are too many.
COARSER = 1.2
# The number of points on boundaries that are evaluated at a time.
PLACES_AT_A_TIME = 1 << 17
# The largest number of cells that are evaluated at a time, and the largest number of ranges of them
# for the threads.
CELLS_AT_A_TIME, RANGES = 1 << 12, 32
# `cut_by_normals` evaluates cells in blocks of about this number.
BLOCK = 1 << 16
# A cell counts as developable if |K| is below this part of 1/area.
FLAT_CURVATURE = 1e-6
# K is also evaluated at this part of the way from the place of a cell to its corner.
BESIDE = 0.3
# The cached attributes that `Space._with` copies.
SHARED = ("areas", "unit", "centre", "sizes", "trims")


@dataclass(frozen=True, eq=False)
class Space:
    """The pieces of a surface or a part, with a target density.

    Lengths are multiplied by `unit`, and points are relative to `centre`, a point in the unit L of
    the surface. The target density of the cells `first` has no floor and no ceiling, so that spaces
    that differ only in floor and ceiling share these cells. On the `developable` pieces, K is
    rounding error, and its powers count as 0. Sizes, 1/√w for the target density w, are bounded by
    the `sources` of each piece that has some.
    """

    label: str
    pieces: tuple[Piece, ...]
    target: TargetDensity
    threads: int | None
    developable: frozenset[int] = frozenset()
    sources: Mapping[int, Sources] = field(default_factory=dict)
    _held: dict[str, Any] = field(default_factory=dict, repr=False)

    # --- the surface as a whole -------------------------------------------------------------------

    @cached_property
    def unit(self) -> float:
        """The factor that scales lengths: a power of two."""
        return scale_to_one(max(x.size for x in self.pieces))

    @cached_property
    def areas(self) -> Array:
        """The areas (P,) of the pieces, scaled."""
        return (np.array([x.size for x in self.pieces]) * self.unit) ** 2

    @cached_property
    def centre(self) -> Array:
        """The origin of scaled points, in the unit L of the surface."""
        return self.pieces[0].jets(*self.pieces[0].middle)[0, 0]

    @cached_property
    def sizes(self) -> Array:
        """The lengths (P, 2) of the domains of the pieces."""
        return np.array([x.sizes for x in self.pieces])

    @cached_property
    def trims(self) -> Trims:
        """The trims of the pieces."""
        return Trims(self.pieces)

    @property
    def size(self) -> float:
        """The diagonal of a box around the initial cells, `first`, scaled."""
        points, radii = self.first.rows[:, :3], self.first.numbers[:, [RADIUS]]
        low, high = (points - radii).min(axis=0), (points + radii).max(axis=0)
        return float(np.linalg.norm(high - low))

    @property
    def area(self) -> float:
        """The area of all pieces, scaled."""
        return float(self.areas.sum())

    @property
    def integral(self) -> float:
        """The integral of the target density over all pieces."""
        return float(self.integrals.sum())

    @property
    def integrals(self) -> Array:
        """The integrals (P,) of the target density over the pieces."""
        cells = self.first
        weights, count = cells.numbers[:, AREA], len(self.pieces)
        values = self.densities
        sums = np.bincount(cells.pieces, weights, count)
        with np.errstate(divide="ignore", invalid="ignore"):
            means = np.bincount(cells.pieces, weights * values, count) / sums
        means = np.where(np.isfinite(means), means, self.target.floor)
        return means * self.areas

    @property
    def longest(self) -> float:
        """The largest extent of a piece along x, y or z, times √w for the least density w."""
        points = (self.first.rows[found, :3] for _, found in runs(self.first.pieces))
        return math.sqrt(self.smallest) * max(float(np.ptp(x, axis=0).max()) for x in points)

    @property
    def smallest(self) -> float:
        """The smallest target density of a cell."""
        return float(self.densities.min())

    @property
    def images(self) -> Array:
        """The solid angles (P,) of the Gaussian images of the pieces, with multiplicity."""
        weights = np.abs(self.first.rows[:, 7]) * self.first.numbers[:, AREA]
        return np.bincount(self.first.pieces, weights, len(self.pieces)).astype(np.float64)

    def solid_angles(self, density: float) -> Array:
        """Return the solid angles (P,) of the Gaussian images, as far as a lattice can sample them.

        `density` is the number of normals of the lattice per steradian.
        """
        known = (x.solid_angle(density) for x in self.pieces)
        return np.array([y if x is None else x for x, y in zip(known, self.images, strict=True)])

    @property
    def distance(self) -> float:
        """The largest measured distance between the sampled surface and the surface of the cells.

        It is in the unit L of the surface. Cells may be evaluated on a spline.
        """
        return max(x.distance for x in self.pieces)

    @property
    def developable_share(self) -> float:
        """The part of the area that is developable; 0 without cells."""
        cells, count = self.first, len(self.pieces)
        chosen = np.flatnonzero(self._is_flat(cells))
        # K may vanish at the place of a curved cell, as on two circles of a torus.
        corners, places = cells.boxes[chosen, :2], cells.places[chosen]
        others = places + BESIDE * (corners - places)
        chosen = chosen[self._is_flat(self.at(cells.pieces[chosen], others, keep=True))]
        # A cell whose place is an apex has the area 0. If all cells of a piece have the area 0,
        # they get equal weights.
        tiny = np.finfo(np.float64).tiny
        weights = np.maximum(cells.numbers[:, AREA], tiny)
        flat = np.bincount(cells.pieces[chosen], weights[chosen], count)
        # Areas of cells at boundaries are approximate; areas of pieces are exact.
        known = np.maximum(np.bincount(cells.pieces, weights, count), tiny)
        return float(np.sum(flat / known * self.areas) / self.area)

    def _is_flat(self, cells: Cells) -> Flags:
        return np.asarray(np.abs(cells.rows[:, 7]) * self.area < FLAT_CURVATURE)

    @property
    def uniform(self) -> Space:
        """The same pieces with the target density 1."""
        first = replace(self.first, rows=self.first.rows.copy())
        first.rows[:, 6] = 0.0
        target, held = TargetDensity(floor=1.0), {"first": first}
        return self._with(target=target, developable=frozenset(), sources={}, _held=held)

    @property
    def exact(self) -> Space:
        """The same space with derivatives of the sampled surface, which may take longer."""
        pieces = tuple(x.exact for x in self.pieces)
        if all(x is y for x, y in zip(pieces, self.pieces, strict=True)):
            return self
        return self._with(pieces=pieces)

    def to_power(self, exponent: float) -> Self:
        """Return the space with another exponent of its target density; its cells are kept.

        The target density must be a power of κ alone: `target.gauss_weight` is 0.
        """
        made = self._with(target=self.target._replace(exponent=exponent), _held=self._copies())
        for found in (made.first, made.borders):
            found.rows[:, 6] **= exponent / self.target.exponent
        return made

    def between(self, floor: float, ceiling: float = math.inf) -> Space:
        """Return the same space with another floor and ceiling of the target density."""
        return self._with(target=self.target._replace(floor=floor, ceiling=ceiling))

    def graded(self, count: int) -> Self:
        """Return the same space with slowly growing sizes, for a cover with `count` samples.

        Without the slow growth, the spacing of few samples may halve from one sample to the next
        near a narrow bend.
        """
        growth, sizes = growth_for(count, self.integral), self.densities**-0.5
        found = {
            k: bounds_of(self.first.rows[cells, :3], sizes[cells], growth)
            for k, cells in runs(self.first.pieces)
        }
        sources = {k: x for k, x in found.items() if x is not None}
        return self.with_sources(sources) if sources else self

    def with_sources(self, sources: Mapping[int, Sources]) -> Self:
        """Return the same space with other bounds of sizes; its cells and boundaries are kept."""
        made = self._with(sources=sources, _held=self._copies())
        made.grade(made.first.pieces, made.first.rows)
        lines = made.borders
        made.grade(np.repeat(lines.pieces, np.diff(lines.starts)), lines.rows)
        return made

    @property
    def densities(self) -> Array:
        """The target densities (M,) of the initial cells, `first`."""
        return np.clip(self.first.rows[:, 6], self.target.floor, self.target.ceiling)

    def _with(self, **changes: object) -> Self:
        """Return a space with other fields, for pieces with the same areas, domains and trims."""
        made = replace(self, **changes)
        vars(made).update({x: getattr(self, x) for x in SHARED})
        return made

    def _copies(self) -> dict[str, Any]:
        """Return `first` and `borders` with copies of their rows, to be changed."""
        both = {"first": self.first, "borders": self.borders}
        return {x: replace(y, rows=y.rows.copy()) for x, y in both.items()}

    def scaled_points(self, points: NDArray[np.floating]) -> Array:
        """Return scaled points (N, 3); InputError unless they are finite."""
        return (finite_array(points, (len(points), 3), "points") - self.centre) * self.unit

    # --- cells ------------------------------------------------------------------------------------

    def nothing(self) -> Cells:
        """Return an empty set of cells."""
        return new_cells(np.empty(0, dtype=np.int64), np.empty((0, 4))).with_rows()

    @property
    def first(self) -> Cells:
        """Cells of all pieces, as large as flatness allows; their density has no floor."""
        if "first" not in self._held:
            self._held["first"] = self._first()
        return self._held["first"]

    @property
    def borders(self) -> BorderLines:
        """The boundaries of all pieces; the density there has no floor."""
        if "borders" not in self._held:
            self._held["borders"] = self._borders()
        return self._held["borders"]

    def along_borders(self, step: float, turn: float = math.inf) -> Cells:
        """Return evaluated point cells along boundaries; see `places_along`."""
        return self.known(self._beside_borders(step, turn))

    def at(
        self, pieces: Indices, places: Array, limits: Array | float = 0.0, *, keep: bool = False
    ) -> Cells:
        """Return evaluated point cells at parameters (k, 2) of pieces (k,); see `known`."""
        return self.known(points_of(pieces, places, self.sizes[pieces], limits), keep=keep)

    def middles(self, pieces: Indices) -> Cells:
        """Return, for each of the given pieces, the cell of `first` nearest to its middle.

        A piece whose cells in `first` are all singular is left out.
        """
        first, rows, wanted = self.first, [], set(pieces.tolist())
        for k, found in runs(first.pieces):
            if k in wanted:
                points, areas = first.rows[found, :3], first.numbers[found, AREA]
                regular = first.rows[found, 3:6].any(axis=1)
                weights = areas if areas.any() else np.ones(len(areas))
                middle = (points * weights[:, None]).sum(axis=0) / weights.sum()
                distances = np.where(regular, ((points - middle) ** 2).sum(axis=1), np.inf)
                if regular.any():
                    rows.append(found.start + int(distances.argmin()))
        return first[np.array(rows, dtype=np.int64)]

    def cut(self, radius: float) -> Cells:
        """Return cells within radius/√w of their places, where w is the target density there.

        Point cells along boundaries, about radius/√w apart, are included.
        """
        return self.known(self._cut(radius))

    def candidates(self, radius: float) -> tuple[Cells, Sides]:
        """Return the cells of `cut` without numbers, and their sides; see `light`."""
        return self.light(self._cut(radius))

    def _cut(self, radius: float) -> Cells:
        """Return the cells of `cut`, not evaluated."""
        cells, parts, pixels = self.first, self.parts(radius), self._pixels(radius)
        many = (parts.prod(axis=1) > AT_ONCE) & ~cells.whole
        steps = np.where(many[:, None], np.ceil(np.sqrt(parts)).astype(np.int64), 1)
        owner = np.repeat(np.arange(len(steps)), steps.prod(axis=1))
        cells, owner = sifted(self.trims, into_parts(cells, steps), pixels, owner)
        cells = self._inside(into_parts(cells, -(-parts[owner] // steps[owner])), pixels)
        return merged([cells, self._beside_borders(radius)])

    def parts(self, radius: float) -> Indices:
        """Return the numbers of parts (M, 2), along u and v, of the cells `first` in `cut`.

        Raises InputError if the parts are too many.
        """
        lengths = self.first.numbers[:, [ALONG_U, ALONG_V]]
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            rates = np.sqrt(self.densities) / (math.sqrt(2.0) * radius)
            parts = np.fmax(np.ceil(np.fmin(lengths * rates[:, None], MOST_CELLS)), 1.0)
        if parts.prod(axis=1).sum() > MOST_CELLS:
            raise self._too_many()
        return parts.astype(np.int64)

    def _too_many(self) -> InputError:
        """Return the error for a surface that would be cut into more cells than allowed."""
        return InputError(
            f"{self.label} would have to be searched in more than {MOST_CELLS:.0e} places; ask for "
            "a larger coverage or angle, or for fewer samples or normals."
        )

    def cut_by_normals(self, chord: float, most: float) -> Iterator[Cells]:
        """Yield blocks of cells whose normals differ little from the normal at their place.

        The chord between these normals is at most about `chord`, which is increased until there are
        at most about `most` cells.
        """
        first = self.first
        bends = np.where(first.numbers[:, [CHORD]] > chord, first.numbers[:, [BEND_U, BEND_V]], 0.0)
        parts = np.maximum(np.ceil(bends / (2.0 * chord)), 1.0)
        while parts.prod(axis=1).sum() > most + len(first):
            chord *= COARSER
            parts = np.maximum(np.ceil(bends / (2.0 * chord)), 1.0)
        blocks = np.cumsum(parts.prod(axis=1)) // BLOCK
        for _, rows in runs(blocks):
            yield self.evaluated(into_parts(first[rows], parts[rows].astype(np.int64)))

    def evaluated(self, cells: Cells, pixels: Indices | None = None) -> Cells:
        """Return the cells that have a place inside the trim, evaluated."""
        return self.known(self._inside(cells, self._fewest if pixels is None else pixels))

    def halves(self, cells: Cells) -> Cells:
        """Return cells bisected across their longer sides, without halves outside the trim."""
        along_u = cells.numbers[:, ALONG_U] >= cells.numbers[:, ALONG_V]
        return self.evaluated(halved(cells, along_u))

    def quarters(self, cells: Cells) -> Cells:
        """Return cells bisected along u and along v.

        Cutting the longer side is not enough: near singular points, normals may turn most along the
        shorter one.
        """
        return self.evaluated(into_parts(cells, np.full((len(cells), 2), 2)))

    def deepest(self, cells: Cells) -> NDArray[np.bool_]:
        """Return which cells are too small to be cut further."""
        sizes = cells.boxes[:, 2:] - cells.boxes[:, :2]
        small = np.all(sizes <= DEEPEST * self.sizes[cells.pieces], axis=1)
        return small | (cells.radii <= DEEPEST * np.sqrt(self.areas[cells.pieces]))

    # --- steps ------------------------------------------------------------------------------------

    def _inside(self, cells: Cells, pixels: Indices) -> Cells:
        """Return the cells that have a place inside the trim, with this place."""
        return placed(self.trims, sifted(self.trims, cells.sorted(), pixels)[0])[0]

    def _beside_borders(self, step: float, turn: float = math.inf) -> Cells:
        """Return the cells of `along_borders`, not evaluated."""
        pieces, *found = places_along(self.trims, self.borders, self.target, step, turn)
        return points_of(pieces, found[0], self.sizes[pieces], found[1])

    def _first(self) -> Cells:
        boxes = [x.boxes for x in self.pieces]
        pieces = np.repeat(np.arange(len(boxes)), [len(x) for x in boxes])
        space = self.between(0.0)
        cells = new_cells(pieces, np.concatenate(boxes))
        done = [space.nothing()]
        for step in range(MOST_BENDS):
            cells = replace(cells, limits=np.zeros(len(cells)))
            cells, _ = sifted(self.trims, cells, self._fewest)
            cells, lost = placed(self.trims, cells)
            cells = space.known(cells)
            bends = cells.numbers[:, [BEND_U, BEND_V]]
            bent = (bends > FLAT).any(axis=1) & ~self.deepest(cells)
            done.append(cells[~bent] if bent.any() else cells)
            cells = halved(cells[bent], bends[bent, 0] >= bends[bent, 1])
            if len(lost) and step < MOST_LOST:
                cells += into_parts(lost, np.full((len(lost), 2), 2))
                cells = cells.sorted()
            elif len(lost):
                done.append(space.at(*beside(self.trims, lost, self._fewest)))
            if not len(cells):
                break
        return merged(done)

    def _borders(self) -> BorderLines:
        numbers, starts, places, inside, near = polygons_of(self.trims, self.first)
        owners, space = np.repeat(numbers, np.diff(starts)), self.between(0.0)
        rows, limits = np.empty((len(owners), 8)), np.empty(len(owners))
        for first in range(0, len(owners), PLACES_AT_A_TIME):
            some = slice(first, first + PLACES_AT_A_TIME)
            cells = space.at(owners[some], inside[some], near[some], keep=True)
            rows[some], limits[some] = cells.rows, cells.limits
        return BorderLines(numbers, starts, places, rows, limits)

    @cached_property
    def _fewest(self) -> Indices:
        return np.full(len(self.pieces), FEWEST_PIXELS)

    def _pixels(self, radius: float) -> Indices:
        """Return the numbers (P,) of pixels of the rasters of pieces, along u and along v.

        They are powers of two from FEWEST_PIXELS to MOST_PIXELS; within these limits, a pixel is at
        most about half of radius/√w wide.
        """
        cells, count = self.first, len(self.pieces)
        rates = np.sqrt(self.densities)
        low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
        np.minimum.at(low, cells.pieces, cells.rows[:, :3])
        np.maximum.at(high, cells.pieces, cells.rows[:, :3])
        mean = np.bincount(cells.pieces, rates, count) / np.maximum(
            np.bincount(cells.pieces, minlength=count), 1
        )
        extent = np.where(np.isfinite(high - low), high - low, 0.0)
        wanted = np.linalg.norm(extent, axis=1) * mean * 2.0 / radius
        power = np.ceil(np.log2(np.clip(wanted, FEWEST_PIXELS, MOST_PIXELS)))
        return (2**power).astype(np.int64)

    def known(self, cells: Cells, *, keep: bool = False) -> Cells:
        """Return the cells with rows and numbers; the cells have to be sorted by their pieces.

        Cells with values that are not finite are left out. With `keep`, they remain, and are marked
        as singular: their rows are 0.
        """
        cells = cells.with_rows()
        return self._evaluated(cells, cells.numbers, evaluate_cells, keep)[0]

    def light(self, cells: Cells, *, keep: bool = False) -> tuple[Cells, Sides]:
        """Return the same cells with rows, but without numbers; see `known`.

        The limits of the cells have to be known. Also return their sides (M, 8), see
        kernels/cells.py. Cells that a boundary intersects have an area, but no sides.
        """
        rows, sides = np.empty((len(cells), 8)), np.empty((len(cells), 8), dtype=np.float32)
        cells, sides = self._evaluated(replace(cells, rows=rows), sides, evaluate_places, keep)
        sides[~cells.whole, :AREA] = sides[~cells.whole, AREA + 1 :] = 0.0
        return cells, sides

    def _evaluated(
        self, cells: Cells, others: NDArray[Any], kernel: Callable[..., object], keep: bool
    ) -> tuple[Cells, NDArray[Any]]:
        """Let a kernel write the rows of cells, and `others` (M, …): their numbers or sides.

        `known` explains `keep`.
        """

        def work(first: int, last: int) -> None:
            for parts in groups[first:last]:
                jets = [self.pieces[k].jets(*cells.places[rows].T.copy()) for k, rows in parts]
                (k, begin), (_, end) = parts[0], parts[-1]
                rows = slice(begin.start, end.stop)
                kernel(
                    jets[0] if len(jets) == 1 else np.concatenate(jets),
                    cells.boxes[rows], cells.places[rows], cells.limits[rows], self.unit,
                    self.centre, self.pieces[k].finest, self._target_of(k),
                    cells.rows[rows], others[rows],
                )  # fmt: skip

        groups = self._groups(cells)
        list(over_ranges(work, len(groups), len(groups) // RANGES + 1, self.threads))
        self.grade(cells.pieces, cells.rows)
        with np.errstate(over="ignore", invalid="ignore"):
            if math.isfinite(cells.rows.sum() + others.sum(dtype=np.float64)):
                return cells, others
        finite = np.asarray(np.isfinite(cells.rows).all(axis=1) & np.isfinite(others).all(axis=1))
        if keep:
            cells.rows[~finite] = 0.0
            return cells, others
        return cells[finite], others[finite]

    def grade(self, pieces: Indices, rows: Array, *, far: bool = False) -> Array:
        """Raise densities w in rows (M, 8) of cells so that the sizes 1/√w obey the sources.

        `pieces` (M,) are the pieces of the cells. Return the bounds (M,) of the sizes; unless
        `far`, bounds that are too large to matter are inf.
        """
        sizes = np.full(len(rows), np.inf)
        if self.sources:
            for k, here in grouped(pieces):
                if sources := self.sources.get(k):
                    reach = math.inf if far else sources.reach
                    sizes[here] = sources.sizes_at(rows[here, :3], reach)
            rows[:, 6] = np.maximum(rows[:, 6], np.minimum(sizes**-2.0, self.target.ceiling))
        return sizes

    def _groups(self, cells: Cells) -> list[list[tuple[int, slice]]]:
        """Return groups of cells that are evaluated together.

        A group is a list of pairs: the index of a piece, and a slice of its cells.

        Since pieces may have few cells each, a group has cells of several pieces if `finest` and
        the target density of these pieces are equal.
        """
        groups, last, room = list[list[tuple[int, slice]]](), None, 0
        for k, rows in runs(cells.pieces):
            kind = k in self.developable, *self.pieces[k].finest.tolist()
            for first in range(rows.start, rows.stop, CELLS_AT_A_TIME):
                part = slice(first, min(first + CELLS_AT_A_TIME, rows.stop))
                room -= part.stop - part.start
                if kind != last or room < 0:
                    groups.append([])
                    last, room = kind, CELLS_AT_A_TIME - (part.stop - part.start)
                groups[-1].append((k, part))
        return groups

    def _target_of(self, piece: int) -> TargetDensity:
        flat = piece in self.developable
        return self.target._replace(gauss_weight=0.0) if flat else self.target
