"""All faces of a part as one surface: what its cells hold, and the target density on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.checks import finite_array
from ...runtime.base.errors import InputError
from ...runtime.base.scales import scale_to_one
from ...runtime.base.threads import over_ranges
from ...runtime.kernels.sizing import TargetDensity
from ..kernels.cells import evaluate_cells
from .cells import (
    ALONG_U,
    ALONG_V,
    AREA,
    BEND_U,
    BEND_V,
    CHORD,
    LIMIT,
    RADIUS,
    Array,
    Cells,
    Indices,
    by_piece,
    halved,
    into_parts,
    new_cells,
)
from .face_pieces import FacePiece
from .sifting import beside, placed, sifted

__all__ = ["Space"]

# The first cells bend by at most this along u and along v, in radians.
FLAT = 0.3
MOST_BENDS = 24
# Cells of the first ones that have no place inside are cut into four so many times.
MOST_LOST = 4
# The pixels along u and v of the rasters of borders.
FEWEST_PIXELS, MOST_PIXELS = 64, 512
# Cells with more parts than this, which the border passes, are cut in two steps.
AT_ONCE = 64
MOST_CELLS = 4e7
# The factor by which cells are made coarser if there were too many.
COARSER = 1.2
# Cells of small faces are evaluated together by one thread.
CELLS_AT_A_TIME = 1 << 12
# Where |K| is below this part of 1/area, a part counts as developable.
FLAT_CURVATURE = 1e-6


@dataclass(frozen=True, eq=False)
class Space:
    """The pieces of a part, with a target density, at least the floor.

    Lengths are multiplied by `unit`, and points are relative to `centre`, in L.
    """

    name: str
    pieces: tuple[FacePiece, ...]
    target: TargetDensity
    threads: int | None
    floor: float = 0.0
    failed: Mapping[int, str] = field(default_factory=dict)
    _held: dict[str, Cells] = field(default_factory=dict, repr=False)

    # --- the part as a whole ----------------------------------------------------------------------

    @cached_property
    def areas(self) -> Array:
        """The areas (P,) of the pieces, in L²."""
        return np.array([x.face.area for x in self.pieces])

    @cached_property
    def unit(self) -> float:
        """The scaled length of a length 1 of the part: a power of two."""
        return scale_to_one(math.sqrt(float(self.areas.sum())))

    @cached_property
    def centre(self) -> Array:
        """What scaled points are relative to, in L."""
        return self.pieces[0].surface.jets(*self.pieces[0].middle)[0, 0]

    @cached_property
    def sizes(self) -> Array:
        """The lengths (P, 2) of the domains of the pieces."""
        return np.array([x.sizes for x in self.pieces])

    @property
    def size(self) -> float:
        """The diagonal of a box around the first cells."""
        points, radii = self.first.rows[:, :3], self.first.numbers[:, [RADIUS]]
        low, high = (points - radii).min(axis=0), (points + radii).max(axis=0)
        return float(np.linalg.norm(high - low))

    @property
    def area(self) -> float:
        """The area of the part, scaled."""
        return float(self.areas.sum()) * self.unit**2

    @property
    def integral(self) -> float:
        """The integral of the target density over the part."""
        return float(self.integrals.sum())

    @property
    def integrals(self) -> Array:
        """The integrals (P,) of the target density over the pieces."""
        cells = self.first
        weights, count = cells.numbers[:, AREA], len(self.pieces)
        values = np.maximum(cells.rows[:, 6], self.floor)
        sums = np.bincount(cells.pieces, weights, count)
        with np.errstate(divide="ignore", invalid="ignore"):
            means = np.bincount(cells.pieces, weights * values, count) / sums
        means = np.where(np.isfinite(means), means, self.floor)
        return means * self.areas * self.unit**2

    @property
    def smallest(self) -> float:
        """The smallest target density of a cell."""
        return float(np.maximum(self.first.rows[:, 6], self.floor).min())

    @property
    def images(self) -> Array:
        """The solid angles (P,) of the Gaussian images of the pieces, with multiplicity."""
        weights = np.abs(self.first.rows[:, 7]) * self.first.numbers[:, AREA]
        return np.bincount(self.first.pieces, weights, len(self.pieces)).astype(np.float64)

    @property
    def developable_share(self) -> float:
        """The part of the area that is flat, or curved in one direction only."""
        flat = np.abs(self.first.rows[:, 7]) * self.area < FLAT_CURVATURE
        areas = self.first.numbers[:, AREA]
        return float(areas[flat].sum() / areas.sum()) if areas.any() else 1.0

    @property
    def uniform(self) -> Space:
        """The same pieces with the target density 1."""
        space = Space(self.name, self.pieces, TargetDensity(), self.threads, 1.0, self.failed)
        first = replace(self.first, rows=self.first.rows.copy())
        first.rows[:, 6] = 0.0
        space._held["first"] = first
        space.__dict__.update(self._shared)
        return space

    def with_floor(self, floor: float) -> Space:
        """Return the same space with another floor of the target density."""
        made = replace(self, floor=floor)
        made.__dict__.update(self._shared)
        return made

    @property
    def _shared(self) -> dict[str, object]:
        """What spaces of the same pieces share."""
        return {x: getattr(self, x) for x in ("areas", "unit", "centre", "sizes")}

    def scaled_points(self, points: NDArray[np.floating]) -> Array:
        """Return scaled points (N, 3); InputError unless they are finite."""
        return (finite_array(points, (len(points), 3), "points") - self.centre) * self.unit

    # --- cells ------------------------------------------------------------------------------------

    def nothing(self) -> Cells:
        """Return no cells."""
        return new_cells(self, np.empty(0, dtype=np.int64), np.empty((0, 4)))

    @property
    def first(self) -> Cells:
        """Cells of all pieces, as large as the surface is flat in each; without the floor."""
        if "first" not in self._held:
            self._held["first"] = self._first()
        return self._held["first"]

    def middles(self, pieces: Indices) -> Cells:
        """Return the cell nearest to the middle of each of some pieces."""
        first, rows = self.first, []
        for k, found in by_piece(first):
            if k in pieces:
                points, areas = first.rows[found, :3], first.numbers[found, AREA]
                regular = first.rows[found, 3:6].any(axis=1)
                weights = areas if areas.any() else np.ones(len(areas))
                middle = (points * weights[:, None]).sum(axis=0) / weights.sum()
                distances = np.where(regular, ((points - middle) ** 2).sum(axis=1), np.inf)
                if regular.any():
                    rows.append(found.start + int(distances.argmin()))
        return replace(first, space=self)[np.array(rows, dtype=np.int64)]

    def cut(self, radius: float) -> Cells:
        """Return cells that lie within radius/√w of their places, w the target density there."""
        first = self.first
        lengths = first.numbers[:, [ALONG_U, ALONG_V]]
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            rates = np.sqrt(np.maximum(first.rows[:, 6], self.floor)) / (math.sqrt(2.0) * radius)
            parts = np.fmax(np.ceil(np.fmin(lengths * rates[:, None], MOST_CELLS)), 1.0)
        if parts.prod(axis=1).sum() > MOST_CELLS:
            raise InputError(
                f"part {self.name!r} would have to be searched in more than {MOST_CELLS:.0e} "
                "places; ask for a larger coverage or angle, or for fewer samples or normals."
            )
        cells, parts = replace(first, space=self), parts.astype(np.int64)
        pixels = self._pixels(radius)
        many = (parts.prod(axis=1) > AT_ONCE) & ~cells.whole
        steps = np.where(many[:, None], np.ceil(np.sqrt(parts)).astype(np.int64), 1)
        cells, owner = sifted(
            into_parts(cells, steps), pixels, np.repeat(np.arange(len(steps)), steps.prod(axis=1))
        )
        cells = into_parts(cells, -(-parts[owner] // steps[owner]))
        return self.evaluated(cells, pixels, with_border=True)

    def cut_by_normals(self, chord: float, most: float) -> Cells:
        """Return cells whose normals are about within a chord from that at their places.

        The chord is made larger until there are about `most` cells at most.
        """
        first = self.first
        bends = np.where(first.numbers[:, [CHORD]] > chord, first.numbers[:, [BEND_U, BEND_V]], 0.0)
        parts = np.maximum(np.ceil(bends / (2.0 * chord)), 1.0)
        while parts.prod(axis=1).sum() > most + len(first):
            chord *= COARSER
            parts = np.maximum(np.ceil(bends / (2.0 * chord)), 1.0)
        return self.evaluated(into_parts(replace(first, space=self), parts.astype(np.int64)))

    def evaluated(
        self, cells: Cells, pixels: Indices | None = None, with_border: bool = False
    ) -> Cells:
        """Return those of cells that have a place inside the trim, with their rows and numbers.

        With `with_border`, places next to the border are added where the inside is too narrow.
        """
        if len(cells) and (np.diff(cells.pieces) < 0).any():
            cells = cells[np.argsort(cells.pieces, kind="stable")]
        pixels = self._fewest if pixels is None else pixels
        cells, _ = sifted(cells, pixels)
        cells, lost = placed(cells)
        if with_border and len(lost):
            cells += beside(lost, pixels)
            cells = cells[np.argsort(cells.pieces, kind="stable")]
        return self._known(cells)

    # --- steps ------------------------------------------------------------------------------------

    def _first(self) -> Cells:
        boxes = [x.boxes for x in self.pieces]
        pieces = np.repeat(np.arange(len(boxes)), [len(x) for x in boxes])
        space = self.with_floor(0.0)
        cells = new_cells(space, pieces, np.concatenate(boxes))
        done = [space.nothing()]
        for step in range(MOST_BENDS):
            cells.numbers[:, LIMIT] = 0.0
            cells, _ = sifted(cells, self._fewest)
            cells, lost = placed(cells)
            cells = space._known(cells)
            bends = cells.numbers[:, [BEND_U, BEND_V]]
            bent = (bends > FLAT).any(axis=1) & ~cells.deepest
            done.append(cells[~bent])
            cells = halved(cells[bent], bends[bent, 0] >= bends[bent, 1])
            if len(lost) and step < MOST_LOST:
                cells += into_parts(lost, np.full((len(lost), 2), 2))
                cells = cells[np.argsort(cells.pieces, kind="stable")]
            elif len(lost):
                done.append(space._known(beside(lost, self._fewest)))
            if not len(cells):
                break
        found = sum(done[1:], start=done[0])
        found = found[np.argsort(found.pieces, kind="stable")]
        return found

    @cached_property
    def _fewest(self) -> Indices:
        return np.full(len(self.pieces), FEWEST_PIXELS)

    def _pixels(self, radius: float) -> Indices:
        """Return for each piece the pixels of its raster: half a radius wide, if that is enough."""
        cells, count = self.first, len(self.pieces)
        rates = np.sqrt(np.maximum(cells.rows[:, 6], self.floor))
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

    def _known(self, cells: Cells) -> Cells:
        """Return cells, sorted by their pieces, with rows and numbers: those that are finite."""
        target = self.target._replace(floor=self.floor)
        ranges = list(by_piece(cells))
        starts = [0]
        for _, rows in ranges:
            if rows.stop - starts[-1] >= CELLS_AT_A_TIME or rows.stop == len(cells):
                starts.append(rows.stop)
        ends = {rows.stop: number + 1 for number, (_, rows) in enumerate(ranges)}
        groups = [0, *(ends[x] for x in starts[1:])]

        def work(first: int, last: int) -> None:
            for group in range(first, last):
                for k, rows in ranges[groups[group] : groups[group + 1]]:
                    piece = self.pieces[k]
                    jets = piece.surface.jets(*cells.places[rows].T.copy())
                    evaluate_cells(
                        jets, cells.boxes[rows], cells.places[rows], self.unit, self.centre,
                        target, cells.rows[rows], cells.numbers[rows],
                    )  # fmt: skip

        for _ in over_ranges(work, len(groups) - 1, 1, self.threads):
            pass
        known = np.concatenate([cells.rows, cells.numbers], axis=1)
        lost = np.flatnonzero(~np.isfinite(known).all(axis=1))
        return cells[np.setdiff1d(np.arange(len(cells)), lost)] if len(lost) else cells
