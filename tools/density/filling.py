"""Samples of pieces: at prescribed normals, and in the gaps between these."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.aliases import Array
from ...runtime.base.errors import InputError
from ...runtime.base.threads import counted
from ...runtime.base.tolerances import FLAT_SURFACE, LENGTH_ERROR
from ...runtime.directions.sets import frequency_within
from ...runtime.onto_surface.smooth_pieces import LEAST_IMAGE
from ...runtime.samples.fields import dtype_of
from .angles import MARGIN, choose_apart, chord_of, cover_normals
from .at_normals import Given, at_count, at_lattices, at_normals
from .cells import Cells, joined, runs
from .cover import Cover
from .coverage import coverage
from .deviation import widest_angle
from .kernels.sizing import TargetDensity
from .on_grid import cover_on_grid
from .piece import Piece
from .request import BY_CURVATURE, Request
from .shares import apportioned
from .space import Space

# Twice the area of a hexagon of circumradius 1.
HEXAGON = 3.0 * math.sqrt(3.0)
# If a greedy cover of n samples has the covering radius r, relative to the sizing function, the
# integral of the target density is about n r² times this.
GREEDY = 1.85
# Density "balanced": the covering radius of the added samples, relative to the sizing function,
# divided by the covering radius of the lattice of normals, in radians.
WIDER = 2.0
# Density "balanced": FLOOR is the floor of the target density, relative to the mean of κ².
# MOST_CURVED is the ceiling of κ, relative to the root of the floor, for a count or a coverage;
# MOST_FOR_NORMALS is the same for an angle. With 20 for an angle, too, samples on narrow faces
# would be as close as the radius of these faces, and a wing with a round trailing edge would have 6
# times as many samples.
FLOOR, MOST_CURVED, MOST_FOR_NORMALS = 0.8, 20.0, 10.0
# For an angle, the ceiling also applies to κ in the mean of κ². Since the ceiling depends on this
# mean, both are iterated until the ratio of consecutive means exceeds SETTLED.
SETTLED = 0.9
# An angle is refused if it takes more than MOST_FOR_ANGLE samples, which are minutes of work, and
# more samples than SPHERES spheres take for the same angle: then the reason is narrow faces, and
# not that the angle is small.
MOST_FOR_ANGLE, SPHERES = 2e6, 300.0
# The largest number of searches for points at which the angle is too large, on parts with narrow
# tips.
MOST_SEARCHES = 8
# |K|^α vanishes where K = 0. Gaps where it is small are wider than the mean gap by at most this
# factor.
WIDEST_GAP = 1000.0
# The number of added samples that a sample at a normal is assumed to save: up to 0.7 are saved. A
# smaller number leaves more samples for the wide gaps of the density |K|.
SAVED = 0.25
# A piece has samples at the normals of a lattice only if these samples are at least this part of
# all samples: fitting its spline takes as long as computing many samples.
LATTICE = 0.1
# If some of several pieces have no lattice, this part of a count is placed where normals are
# farthest from those of all samples.
FOR_NORMALS = 0.05
# Some samples are placed where normals are farthest from those of all samples. NORMALS_APART is the
# chord between the normals of candidates for these samples, relative to the covering radius of as
# many normals, evenly spaced on the sphere, as the cover will have samples. CANDIDATES is about the
# number of candidates minus the number of samples.
NORMALS_APART, CANDIDATES = 0.2, 200_000
# The smallest chord between the normals of candidates for these samples.
LEAST_CHORD = math.radians(0.5)
# Normals of samples count as distinct if they differ when rounded to this number of decimals.
DIGITS = 6
# Each piece gets a sample if there are at least this many samples per piece.
SAMPLES_A_PIECE = 2
# Bisection for the radius of a cover with density "balanced", a count and a coverage: the largest
# number of steps; the part of the count at which the bisection ends; and the logarithm of the ratio
# of the first bounds.
BISECTIONS, NEAR_ENOUGH, WIDEST_RADIUS = 10, 0.97, 10.0


def target_of(request: Request) -> TargetDensity:
    """Return the target density of a request, without its floor."""
    if isinstance(request.density, str):
        return TargetDensity(curvature_weight=float(request.density in BY_CURVATURE))
    return TargetDensity(gauss_weight=1.0, exponent=float(request.density))


def fill(
    space: Space,
    request: Request,
    progress: bool,
    each_once: Callable[[Given], Given] | None = None,
) -> Cover:
    """Sample a `Space` whose target density has no floor; raises the errors of `sample`.

    With `each_once`, a point that several pieces share at a prescribed normal is returned once.
    """
    with counted(request.count, progress) as show_count:
        filling = Filling(space, request, progress, show_count, each_once)
        cover = filling.cover()
        if request.angle is not None:
            trimmed = any(x.trim is not None for x in space.pieces)
            cover.angle = (_covered_tips if trimmed else cover_normals)(cover, request.angle)
        if request.coverage is not None:
            cover.coverage = filling.reached(cover) / space.unit
    return cover


def _covered_tips(cover: Cover, angle: float) -> float:
    """Add samples as `cover_normals` does, and more in tips too narrow for its cells.

    `widest_angle` finds places in these tips. Return the largest remaining angle.
    """
    reached, near = cover_normals(cover, angle), (1.0 - MARGIN) * chord_of(angle)
    for _ in range(MOST_SEARCHES):
        found = [cover.space.nothing()]
        widest = widest_angle(cover.space, cover.points[:, 3:], reached, found)
        wider = joined(found)
        if not len(wider):
            return widest
        cover.add(wider[choose_apart(wider.rows[:, 3:6], near, cover.space.threads)])
    return widest_angle(cover.space, cover.points[:, 3:], reached)


def fields_of(cover: Cover, fields: Sequence[str], dtype: DTypeLike) -> dict[str, NDArray[Any]]:
    """Return fields of all samples of a `Cover`: the samples at normals, then the added samples."""
    added = cover.added
    order = np.argsort(added.pieces, kind="stable")
    added = added[order]
    pieces = cover.space.pieces
    parts = [_of_piece(pieces[k], added[rows], fields, dtype) for k, rows in runs(added.pieces)]
    found = {}
    for name in fields:
        given = cover.at_normals.array(name, dtype)
        new = np.empty((len(order), *given.shape[1:]), dtype=dtype_of(name, dtype))
        if parts:
            new[order] = np.concatenate([x[name] for x in parts])
        found[name] = np.concatenate([given, new])
    return found


def _of_piece(
    piece: Piece, cells: Cells, fields: Sequence[str], dtype: DTypeLike
) -> dict[str, NDArray[Any]]:
    """Return fields of samples at the places of cells of one piece."""
    found = piece.fields_at(cells.places, cells.rows, fields, dtype)
    for name, number in piece.indices.items():
        if name in fields:
            found[name] = found.get(name, np.zeros(len(cells), dtype=np.int64)) + number
    return found


@dataclass(frozen=True, eq=False)
class Filling:
    """The sampling of a `Space` for a request.

    `show_count` is called with the number of samples whenever it grows; `each_once` is as in
    `fill`.
    """

    space: Space
    request: Request
    progress: bool
    show_count: Callable[[int], object]
    each_once: Callable[[Given], Given] | None = None

    def cover(self) -> Cover:
        """Return the requested cover."""
        request = self.request
        if request.density == "gauss":
            return self._new(self.space, self._at_normals())
        if request.density == "aligned":
            return cover_on_grid(self.balanced(), request, self._asked, self.show_count)
        if request.density in BY_CURVATURE:
            if request.count is None:
                return self._by_radius()
            space = self.balanced(capped=True).graded(request.count)
            cover = self._by_count(space, request.count)
            asked = request.coverage
            if asked is None or self.reached(cover) <= asked * self.space.unit:
                return cover
            return self._by_count_and_coverage(request.count)
        space = self._by_power
        if request.count is not None:
            return self._by_count(space, request.count)
        assert self._asked is not None
        return self._to_radius(space, Given(space), self._asked)

    def reached(self, cover: Cover) -> float:
        """Return a bound of scaled distances from points to the nearest sample on their side."""
        asked = math.inf if self.request.coverage is None else self.request.coverage
        return coverage(self.space, cover.points, asked * self.space.unit)

    # --- the target density -----------------------------------------------------------------------

    def balanced(self, *, capped: bool = False) -> Space:
        """Return the `Space` with the floor of "balanced", and with a ceiling if `capped`.

        For an angle, the floor is computed from the density with this ceiling: without the ceiling,
        tiny fillets would make all flat parts dense.
        """
        floor = self._floor(math.inf)
        if not capped:
            return self.space.between(floor)
        if self.request.angle is None:
            return self.space.between(floor, MOST_CURVED**2 * floor)
        lower = self._floor(MOST_FOR_NORMALS**2 * floor)
        while lower < SETTLED * floor:
            floor, lower = lower, self._floor(MOST_FOR_NORMALS**2 * lower)
        return self.space.between(floor, MOST_FOR_NORMALS**2 * floor)

    def _floor(self, ceiling: float) -> float:
        """Return the floor of "balanced" for a target density with a ceiling."""
        request, space = self.request, self.space.between(self.space.target.floor, ceiling)
        # Requested normals or a requested angle determine the radius. The integral of κ² is then
        # replaced by the solid angle of all normals that may have samples if this is larger, as for
        # a flat surface.
        absolute = request.normals is not None or request.angle is not None
        least = request.solid_angle if absolute else FLAT_SURFACE
        return FLOOR * max(space.integral, least) / space.area

    @property
    def _by_power(self) -> Space:
        """The space whose target density is "uniform", or a power of |K| with its floor.

        A power of |K| is replaced by a constant on pieces whose curvature is only the error of
        their spline.
        """
        if self.request.density == "uniform":
            return self.space.between(1.0)
        images = self.space.solid_angles((self.request.count or 0) / (4 * math.pi))
        flat = frozenset(np.flatnonzero(images <= LEAST_IMAGE).tolist())
        if len(flat) == len(images):
            return self.space.uniform
        space = replace(self.space, developable=flat, _held={})
        return space.between(space.integral / space.area / WIDEST_GAP**2)

    @property
    def _asked(self) -> float | None:
        """The requested coverage as a scaled length.

        It is at least the rounding error and at most the size of the surface. If the cells are on a
        spline and the samples on the surface, twice the distance between spline and surface is
        subtracted; at least half of the coverage remains.
        """
        asked, space = self.request.coverage, self.space
        if asked is None:
            return None
        asked = max(asked - 2.0 * space.distance, asked / 2.0)
        return min(max(asked * space.unit, LENGTH_ERROR * space.size), space.size)

    # --- covers -----------------------------------------------------------------------------------

    def _by_radius(self) -> Cover:
        """Return the cover for requested normals, a requested angle, or a requested coverage alone.

        It has samples at the requested normals, or, for an angle or a coverage, at lattices of
        normals; further samples fill the gaps.
        """
        request, asked = self.request, self._asked
        space = self.balanced(capped=request.angle is not None)
        if request.angle is not None:
            frequency_within(request.angle)  # or InputError
            radius = WIDER * math.radians(request.angle)
            _refuse_too_many(space, radius, request)
            given = self._at_lattices(radius, space)
        elif request.normals is not None:
            given = self._at_normals()
            radius = WIDER * spacing(given.samples_per_steradian)
        else:
            assert asked is not None
            radius = asked * math.sqrt(max(space.target.floor, space.smallest))
            space.parts(radius)  # or InputError, before the search
            given = self._at_lattices(radius, space)
        if asked is not None:
            floor = (radius / asked) ** 2
            most = MOST_CURVED**2 * floor
            is_free = request.angle is None and request.normals is None
            space = space.between(floor, most if is_free else max(most, space.target.ceiling))
        return self._to_radius(space, given, radius)

    def _to_radius(self, space: Space, given: Given, radius: float) -> Cover:
        """Return a cover with the covering radius `radius` and with a sample on each piece.

        If there are too many pieces (see SAMPLES_A_PIECE), some may have no sample.
        """
        cover = self._new(space, given)
        cover.to_radius(radius)
        missing = cover.missing()
        if SAMPLES_A_PIECE * len(space.pieces) <= cover.count + len(missing):
            cover.add(missing)
        return cover

    def _by_count(self, space: Space, count: int) -> Cover:
        """Return a cover with a count of samples: samples at normals, and samples that fill gaps.

        If some of several pieces have no lattice of normals, a part of the filling samples is
        placed where the normals of the surface are farthest from the normals of all samples.
        """
        given, rest = Given(space), 0
        if self.request.density in BY_CURVATURE:
            given = self._for_count(space, count)
            if len(given.found) < len(space.pieces) > 1:
                rest = math.floor(FOR_NORMALS * count)
        cover = self._new(space, given)
        cover.spread(max(count - rest, cover.count))
        missing = cover.missing()
        if SAMPLES_A_PIECE * len(space.pieces) <= count and len(missing):
            room = count - cover.count
            if len(missing) > room:
                cover.remove_last(len(missing) - room)
            cover.add(missing[: count - cover.count])
        if cover.count < count and rest:
            _fill_normals(cover, count - cover.count)
        if cover.count < count:
            cover.renew_distances(cover.radius)
        cover.fill_up(count)
        return cover

    def _by_count_and_coverage(self, count: int) -> Cover:
        """Return a cover with `count` samples and the requested coverage, if `count` suffices.

        The radius is the smallest one, found by bisection, at which this coverage does not take
        more samples than the count.
        """
        asked, best = self._asked, None
        assert asked is not None
        high = math.log(count)
        low = high - WIDEST_RADIUS
        for _ in range(BISECTIONS):
            radius = WIDER * spacing(math.exp((low + high) / 2))
            floor = (radius / asked) ** 2
            space = self.space.between(floor, MOST_CURVED**2 * floor)
            cover = self._new(space, self._at_lattices(radius, space))
            cover.to_radius(radius, count + 1)
            if cover.count > count:
                high = (low + high) / 2
                continue
            low, best = (low + high) / 2, cover
            if cover.count > NEAR_ENOUGH * count:
                break
        if best is None:  # not possible even without samples at normals
            best = self._new(self.space.uniform, Given(self.space))
            best.to_count(count)
        best.fill_up(count)
        return best

    def _new(self, space: Space, given: Given) -> Cover:
        return Cover(space, given, self.show_count)

    # --- samples at normals -----------------------------------------------------------------------

    def _at_normals(self) -> Given:
        """Return samples at the requested normals or, if only a count is given, at lattices."""
        space, count = self.space, self.request.count
        if count is None:
            curved = np.flatnonzero(space.images > LEAST_IMAGE)
            found = at_normals(space, self.request.directions, curved, self.progress)
            return found if self.each_once is None else self.each_once(found)
        seen = space.solid_angles(count / (4 * math.pi))
        counts = apportioned(count, seen if seen.any() else space.areas)
        return at_count(space, counts, self.progress)

    def _for_count(self, space: Space, count: int) -> Given:
        """Return samples at lattices of normals that leave enough of `count` for filling gaps."""
        seen = space.solid_angles(count / (4 * math.pi))
        # If the lattice has one normal per steradian, this is the number of filling samples.
        filling = space.integral / (GREEDY * (WIDER * spacing(1.0)) ** 2)
        chosen, density = np.arange(len(seen)), 0.0
        for _ in range(2):  # with all pieces, then with pieces that have a lattice
            curved = float(seen[chosen].sum())
            density = count / (curved + max(filling - SAVED * curved, 0.0))
            chosen = np.flatnonzero((seen > 0.0) & (density * seen >= LATTICE * count))
        return at_lattices(space, density, chosen, self.progress, count)

    def _at_lattices(self, radius: float, space: Space) -> Given:
        """Return samples at lattices of normals whose density follows from a covering radius."""
        density = 2.0 / (HEXAGON * (radius / WIDER) ** 2)
        expected = density * space.solid_angles(density)
        least = max(LATTICE * space.integral / (GREEDY * radius**2), 0.5)
        return at_lattices(space, density, np.flatnonzero(expected >= least), self.progress)


def _refuse_too_many(space: Space, radius: float, request: Request) -> None:
    """Raise InputError if narrow faces make an angle take too many samples."""
    counts, angle = space.integrals / (GREEDY * radius**2), request.angle
    total = float(counts.sum())
    if angle is None or total <= MOST_FOR_ANGLE or space.integral <= SPHERES * request.solid_angle:
        return
    most, enough = int(counts.argmax()), angle * math.sqrt(total / MOST_FOR_ANGLE)
    raise InputError(
        f"{space.label} would take about {total / 1e6:,.1f} million samples for an angle of "
        f"{angle:g}, {counts[most] / total:.0%} of them on {space.pieces[most].label}, which is "
        f"narrow and sharply curved; ask for {enough:.2g} degrees or more, or for a count."
    )


def _fill_normals(cover: Cover, number: int) -> None:
    """Add `number` samples where normals of the surface are farthest from those of all samples."""
    chord = NORMALS_APART * spacing(max(cover.count + number, 1) / (4 * math.pi))
    most = CANDIDATES + cover.count
    cells, normals = list[Cells](), list[Array]()
    for block in cover.space.cut_by_normals(max(chord, LEAST_CHORD), most):
        normals.append(block.rows[:, 3:6].copy())
        cells.append(block.without_rows())  # rows take most of the memory
    known = np.unique(cover.points[:, 3:].round(DIGITS), axis=0)
    opposite, threads = 2.0, cover.space.threads  # the largest chord between normals
    chosen = choose_apart(np.concatenate(normals), chord, threads, opposite, number, known)
    cover.add(cover.space.known(joined(cells)[chosen]))


def spacing(density: float) -> float:
    """Return the covering radius of a hexagonal lattice of `density` points per area."""
    return math.sqrt(2.0 / (HEXAGON * density))
