"""All points of a surface with given normals, each exactly once, with a proof.

If the coordinates of a surface are a tape (`runtime.tape.kernels.points`), its derivatives have
bounds over boxes of parameters. An index cuts the domain into cells, each with a cone that contains
its normals. For a given normal, either bounds exclude a cell, or a contraction proves that it has
one point or none, or the cell is cut. Small boxes that remain undecided are listed. A solution is a
point with the given normal.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array
from ..base.threads import over_ranges
from ..domain.domain import Boundary, Domain
from ..search.kernels.lists import NUMBER, Lists
from ..search.kernels.pieces import CHORD, CONE, EVERYTHING, WIDTH, Pieces
from ..search.kernels.search import CELLS as KIND
from ..search.kernels.search import Memory, Pairs, search
from ..search.patch_index import listed, ordered
from ..tape.kernels.points import LANES, Tape
from ..tape.tapes import jets_of
from .apexes import Apex, apexes_of
from .components import Undecided, boxes_of, components_of, with_kinds
from .curves import are_thin, separated
from .discs import PoleDisc
from .grid_lines import joints_and_creases, lines_of
from .kernels.answers import (
    BORDER,
    BOX,
    CURVE,
    Answers,
    Sorted,
    count_places,
    merge_places,
    order_places,
    put_places,
    start_normals,
)
from .kernels.cell_bounds import OPEN, REACH, WIDE, CellBounds, Work, cut_cells
from .kernels.components import indices_around
from .kernels.degree import LARGEST
from .kernels.discs import decide_discs
from .kernels.evaluated_pairs import Index, Lines, Outcome, Tiles, evaluate_pairs
from .kernels.places import Boxes, decide_normals
from .poles import Cap, poles_of

# Cells that are not regular (`is_done` in kernels/cell_bounds.py) are cut into four, at most LEVELS
# times. Then cells without a narrow cone of normals are cut into four, in at most ROUNDS rounds, as
# long as all rounds together add at most MOST · max(k, FEWEST) cells, where the grid has k cells.
# FEWEST is for the coarse grids of NURBS, whose cells may be knot spans: there is one more round
# for grids with fewer cells.
LEVELS, ROUNDS, MOST, FEWEST = 2, 3, 8, 256
CELLS = (64, 64)
# Whether a surface has normals at all is tested on PROBES cells, shrunk by the factor SMALL.
PROBES, SMALL = 16, 2.0**-5
# The numbers of grid cells, of normals, and of normals that need bisection in one batch.
CELLS_AT_A_TIME, NORMALS_AT_A_TIME, HARD_AT_A_TIME = 512, 1 << 13, 1 << 8
# The initial lengths of arrays: of cells, of pairs of a normal and a cell, and of answers.
CELL_ROOM, PAIRS, ROOM = 2048, 1 << 15, 1 << 12
# Cells without a cone of normals are listed in all bins. There is no index if they cover more than
# this share of the domain.
MOST_OPEN = 0.25
# The domain of a mirrored parameter is extended beyond its upper end, by this share of its length.
# A point in this strip is found twice: in the strip and at the lower end. In the first half of the
# strip, the solution in the strip is kept, otherwise the one at the lower end. The strip is far
# wider than rounding errors, so that exactly one of the two is kept.
BEYOND = 2.0**-30
NO_PAIRS = np.empty((0, 2), np.int64)


class ProvedPlaces(NamedTuple):
    """The points with given normals, sorted by normal, then by u and v.

    `numbers` (k,) are the indices of the normals. The columns of `places` (k, 6) are u, v, an error
    bound of each, a number with the sign of the Gaussian curvature, and 1 if the exact parameters
    may be outside the domain (by at most the error bounds), else 0. All other points with these
    normals are in the boxes `undecided`, or in the boxes `unbounded` of the index.
    """

    numbers: NDArray[np.int64]
    places: NDArray[np.float64]
    undecided: Undecided

    def only(self, normals: NDArray[np.bool_]) -> ProvedPlaces:
        """Return the points and boxes of the normals selected by a mask (S,)."""
        rows, left = normals[self.numbers], normals[self.undecided.numbers]
        undecided = Undecided._make(x[left] for x in self.undecided)
        return ProvedPlaces(self.numbers[rows], self.places[rows], undecided)

    @property
    def uv(self) -> NDArray[np.float64]:
        """The parameters (k, 2)."""
        return self.places[:, :2]

    @property
    def radius(self) -> NDArray[np.float64]:
        """Error bounds (k, 2) of the parameters."""
        return self.places[:, 2:4]

    @property
    def sign(self) -> NDArray[np.int8]:
        """The signs (k,) of the Gaussian curvature."""
        return np.where(self.places[:, 4] > 0.0, 1, -1).astype(np.int8)

    @property
    def border(self) -> NDArray[np.bool_]:
        """A mask (k,) of the points whose exact parameters may be outside the domain."""
        return self.places[:, 5] > 0.0


class Places(NamedTuple):
    """Unsorted solutions: rows (k, 6) as in `ProvedPlaces.places`, and the indices of normals."""

    rows: NDArray[np.float64]
    numbers: NDArray[np.int64]


class Rooms(NamedTuple):
    """Work arrays of one thread."""

    work: Work
    memory: Memory
    tiles: Tiles
    boxes: Boxes
    pairs: list[Pairs]
    found: list[Outcome]
    answers: list[Answers]


@dataclass(frozen=True, eq=False)
class ProvedIndex:
    """The index of a surface: immutable, and shared by threads.

    `domain` (6,) is u₀, u₁, v₀, v₁, and the periods of u and v, 0 if there is none. A parameter
    with a mirrored seam, whose axis is in `seams`, has no period here, since the oriented normal
    is reversed across the seam. The upper end of its interval is moved outwards by BEYOND times the
    length. In the boxes `unbounded` (m, 4), derivatives have no bounds, and no point is known or
    excluded.
    """

    tape: Tape
    domain: NDArray[np.float64]
    index: Index
    pieces: Pieces
    lists: Lists
    discs: tuple[PoleDisc, ...]
    caps: tuple[Cap, ...]
    apexes: tuple[Apex, ...]
    unbounded: NDArray[np.float64]
    seams: tuple[int, ...]
    _rooms: deque[Rooms] = field(default_factory=deque, repr=False)

    @classmethod
    def of(
        cls,
        tape: Tape,
        domain: Domain,
        boundary: Boundary,
        cells: tuple[int, int] = CELLS,
        threads: int | None = None,
    ) -> ProvedIndex | None:
        """Return the index of a surface; None if the surface has no normals, such as a curve.

        Parameters
        ----------
        tape : Tape
            The coordinates as functions of the parameters.
        domain : ((u0, u1), (v0, v1)) of float
            The rectangle of the parameters.
        boundary : pair of pairs of str
            The boundary conditions of u and of v, see `Surface`.
        cells : (int, int), default (64, 64)
            The numbers of cells along u and v before cuts; they only influence which normals are
            undecided.
        threads : int, optional
            The number of threads. By default one for each core.

        Returns
        -------
        ProvedIndex or None
            The index; None if the surface has no normals, or if the cells without a cone of normals
            cover more than the share MOST_OPEN of the domain.

        """
        seams = tuple(k for k in (0, 1) if boundary[k][0] == "mirrored")
        u, v = (
            (low, high + BEYOND * (high - low)) if k in seams else (low, high)
            for k, (low, high) in enumerate(domain)
        )
        domain = u, v
        periods = (
            high - low if ends[0] == "periodic" else 0.0
            for (low, high), ends in zip(domain, boundary, strict=True)
        )
        box = np.array([*domain[0], *domain[1], *periods])
        poles = poles_of(tape, domain, boundary, cells)
        lines = [lines_of(tape, k, poles.inside[k], cells[k]) for k in (0, 1)]
        grid = _grid(*lines)
        if _has_no_normals(tape, grid):
            return None
        cut = _cut(tape, grid, LEVELS, threads)
        rounds = ROUNDS + (len(grid) < FEWEST)
        cut = _narrowed(tape, cut, rounds, len(cut.place) + MOST * max(len(grid), FEWEST), threads)
        blind = cut.noise[:, REACH] == 0.0
        u, v, h_u, h_v = cut.place[blind].T
        unbounded = np.vstack(
            [poles.unknown, np.column_stack([u - h_u, u + h_u, v - h_v, v + h_v])]
        )
        cut = CellBounds(*(x[~blind] for x in cut))
        sizes = cut.place[:, 2] * cut.place[:, 3]
        if sizes[cut.cone[:, 3] >= OPEN].sum() > MOST_OPEN * sizes.sum():
            return None
        of_discs = (x.cell for x in poles.discs)
        both = CellBounds(*map(np.concatenate, zip(cut, *of_discs, strict=True)))
        jumps = [joints_and_creases(tape, k, domain, boundary) for k in (0, 1)]
        joints, creases = (Lines(*x) for x in zip(*jumps, strict=True))
        index = Index(both, len(cut.place), joints, creases)
        pieces = _pieces_of(index)
        lists = listed(pieces.cones)
        apexes = apexes_of(tape, domain, box[4:])
        return cls(
            tape, box, index, pieces, lists, poles.discs, poles.caps, apexes, unbounded, seams
        )

    def query(self, normals: NDArray[np.float64], threads: int | None = None) -> ProvedPlaces:
        """Return all points with unit normals (S, 3).

        The answer for a normal depends neither on the other normals nor on the number of threads.
        """
        normals = np.ascontiguousarray(normals, np.float64)
        parts, hard = self._search(normals, threads)
        answers: list[Answers] = []
        if len(hard) > 0:
            answers = self._decide(normals, hard, threads)
            slow, unknown = self._merged(answers, parts, len(normals))
            parts.append(slow)
            answers.extend(unknown)
        answers += [cap.answers(normals) for cap in self.caps]
        open_ = boxes_of(answers)
        for apex in self.apexes if len(open_.numbers) > 0 else ():
            open_, rows, numbers = apex.at_pole(apex.decided(open_, normals), normals)
            parts.append(Places(rows, numbers))
        places = _sorted(parts, len(normals))
        if len(open_.numbers) > 0:
            open_ = self._separated(components_of(open_, self.domain), normals)
            open_ = with_kinds(open_, self._around(open_, normals), places, self.domain)
        if self.seams:
            places = self._once_at_seams(places)
        return ProvedPlaces(*places, open_)

    def _once_at_seams(self, places: Sorted) -> Sorted:
        """Return the solutions, with each point at a mirrored seam only once.

        A point at the lower end of a mirrored parameter is also in the strip beyond the upper end,
        with the opposite normal. Solutions in the first half of the strip are moved to the upper
        end, and solutions for the same points at the lower end are left out.
        """
        keep, rows = np.ones(len(places.numbers), np.bool_), places.places
        for axis in self.seams:
            low, high = self.domain[2 * axis : 2 * axis + 2]
            beyond = BEYOND / (1.0 + BEYOND) * (high - low)
            u = rows[:, axis]
            keep &= (u >= low + beyond / 2.0) & (u < high - beyond / 2.0)
            out = np.maximum(u - (high - beyond), 0.0)
            rows[:, axis], rows[:, 2 + axis] = u - out, rows[:, 2 + axis] + out
        return Sorted(places.numbers[keep], rows[keep])

    def _separated(self, open_: Undecided, normals: NDArray[np.float64]) -> Undecided:
        """Return the components, with a row for each of several curves in one box.

        A thin box has one curve only, and a small box at most one component.
        """
        sizes = np.ptp(self.domain[:4].reshape(2, 2), axis=1)
        small = (np.ptp(open_.boxes.reshape(-1, 2, 2), axis=2) <= LARGEST * sizes).all(axis=1)
        thin = are_thin(open_.boxes, sizes).any(axis=1)
        wide = np.flatnonzero((open_.kinds == CURVE) & ~small & ~thin)
        if len(wide) == 0:
            return open_
        known = dict[bytes, Undecided]()  # queries may repeat normals
        found = [Undecided._make(x[[k]] for x in open_) for k in range(len(open_.numbers))]
        jets = partial(jets_of, self.tape)
        for k in wide.tolist():
            one, normal = found[k], normals[open_.numbers[k]]
            if (key := normal.tobytes() + one.boxes.tobytes()) not in known:
                boxes = self._small_boxes(normal)
                known[key] = separated(one, boxes, self.domain[4:], normal, jets)
            rows = known[key]
            found[k] = rows._replace(numbers=np.repeat(one.numbers, len(rows.numbers)))
        return Undecided._make(np.concatenate(x) for x in zip(*found, strict=True))

    def _small_boxes(self, normal: NDArray[np.float64]) -> Array:
        """Return the middles and half the widths (k, 2, 2) of the boxes that bisection leaves."""
        hard = self._search(normal[None], 1)[1]
        hard = hard[np.argsort(hard[:, 1])]
        groups = np.array([0, np.searchsorted(hard[:, 1], self.index.discs)])
        with self.room() as rooms:
            rooms.boxes.on_curve[:] = 0.0
            decide_normals(
                self.tape, rooms.work, self.index, normal[None], hard, groups, 0, 1, self.domain,
                rooms.boxes, rooms.answers[0],
            )  # fmt: skip
            rows = rooms.boxes.on_curve[rooms.boxes.on_curve[:, 3] > 0.0]
        sizes = self.index.cells.place[rows[:, 2].astype(int), 2:4]
        return np.stack([rows[:, :2], rows[:, 3:] * sizes], axis=1)

    def _around(self, open_: Undecided, normals: NDArray[np.float64]) -> Array:
        """For each undecided box, return the winding number around it and the box of its path.

        The columns of the result (k, 5) are the winding number, NaN if unknown, and four bounds of
        the parameters.
        """
        around, points = np.empty((len(open_.numbers), 5)), np.zeros(4)
        for x in self.apexes:
            if not x.inside:
                points[2 * x.axis + (x.end == self.domain[2 * x.axis + 1])] = 1.0
        with self.room() as rooms:
            indices_around(
                self.tape, rooms.work, rooms.boxes.tile, self.index.joints, self.domain, points,
                open_.boxes, open_.numbers, normals, rooms.boxes.ends, rooms.boxes.path, around,
            )  # fmt: skip
        return around

    def _search(
        self, normals: NDArray[np.float64], threads: int | None
    ) -> tuple[list[Places], NDArray[np.int64]]:
        """Return the solutions found without bisection, and the pairs (k, 2) that need bisection.

        A pair is the index of a normal and that of a cell.
        """
        order = ordered(normals, self.lists, threads)

        def work(first: int, last: int) -> list[tuple[Places, NDArray[np.int64]]]:
            numbers, count, parts, start = order[first:last] & NUMBER, last - first, [], 0
            # A copy with the normals of a bin side by side is faster: each is read for many cells.
            some = np.take(normals, numbers, axis=0)
            keys = (order[first:last] & ~NUMBER) | np.arange(count)
            with self.room() as rooms:
                while start < count:
                    start, needed = search(
                        KIND, self.pieces, self.lists, some, keys, start, count, rooms.memory,
                        rooms.pairs[0],
                    )  # fmt: skip
                    parts.append(self._evaluated(some, numbers, rooms))
                    if needed > len(rooms.pairs[0].certain):
                        rooms.pairs[0] = Pairs.new(needed)
            return parts

        ranges = over_ranges(work, len(order), NORMALS_AT_A_TIME, threads)
        found = [x for parts in ranges for x in parts]
        hard = [pairs for _, pairs in found if len(pairs) > 0]
        return [x for x, _ in found], np.concatenate(hard) if hard else NO_PAIRS

    def _evaluated(
        self, normals: NDArray[np.float64], numbers: NDArray[np.int64], rooms: Rooms
    ) -> tuple[Places, NDArray[np.int64]]:
        """Return solutions and hard pairs for the pairs of normals and cells in `rooms.pairs`.

        The results are as in `_search`. `numbers` (k,) are the indices of the normals (k, 3) in the
        query.
        """
        certain, undecided = rooms.pairs[0].counts
        keys = rooms.pairs[0].certain[:certain]
        while not evaluate_pairs(
            self.index.cells, self.tape, rooms.work, normals, keys, rooms.tiles, rooms.found[0]
        ):
            room = rooms.found[0]
            rooms.found[0] = Outcome.new(2 * len(room.numbers), 2 * len(room.hard))
        found = rooms.found[0]
        places, hard = found.counts
        close = Places(found.places[:places].copy(), numbers[found.numbers[:places]])
        if hard + undecided == 0:
            return close, NO_PAIRS
        others = rooms.pairs[0].undecided[:undecided]
        left = np.concatenate(
            [found.hard[:hard], np.stack([others >> 32, others & NUMBER], axis=1)]
        )
        left[:, 0] = numbers[left[:, 0]]
        return close, left

    def _decide(
        self, normals: NDArray[np.float64], hard: NDArray[np.int64], threads: int | None
    ) -> list[Answers]:
        """Return the answers of bisection for the pairs (k, 2) of a normal and a cell in `hard`."""
        hard = hard[np.lexsort((hard[:, 1], hard[:, 0]))]
        in_discs = hard[hard[:, 1] >= self.index.discs]
        hard = hard[hard[:, 1] < self.index.discs]
        which, groups = np.unique(hard[:, 0], return_index=True)
        groups = np.append(groups, len(hard))

        def decide(room: Answers, rooms: Rooms, first: int, last: int) -> np.int64:
            return decide_normals(
                self.tape, rooms.work, self.index, normals, hard, groups, first, last,
                self.domain, rooms.boxes, room,
            )  # fmt: skip

        answers = self._answered(decide, len(which), threads)
        for k, pole in enumerate(self.discs):
            numbers = in_discs[in_discs[:, 1] == self.index.discs + k, 0]
            work = Work.new(len(pole.tape.operations))

            def of_disc(
                room: Answers, _: Rooms, first: int, last: int, pole: PoleDisc = pole,
                work: Work = work, numbers: NDArray[np.int64] = numbers,
            ) -> np.int64:  # fmt: skip
                return decide_discs(
                    pole.tape, work, pole.disc, normals, numbers, first, last, self.domain, room
                )

            answers += self._answered(of_disc, len(numbers), 1)
        return answers

    def _merged(
        self, answers: list[Answers], parts: list[Places], count: int
    ) -> tuple[Places, list[Answers]]:
        """Return the solutions of `answers` that are not in `parts`, each once, and more answers.

        `parts` are the solutions found without bisection, and `count` is the number of normals. If
        it is unknown whether a solution is the same as another one, it is left out, and its box is
        an undecided box of the answers that are returned.
        """
        slow = np.concatenate([x.places for x in answers])
        of_slow = np.concatenate([x.numbers for x in answers])
        order = np.lexsort((slow[:, 1], slow[:, 0], of_slow))
        slow, of_slow = slow[order], of_slow[order]
        which, groups = np.unique(of_slow, return_index=True)
        groups = np.append(groups, len(slow))
        asked = np.zeros(count, np.bool_)
        asked[which] = True
        near = [Places(x.rows[asked[x.numbers]], x.numbers[asked[x.numbers]]) for x in parts]
        fast, of_fast = (np.concatenate(x) for x in zip(*near, strict=True))
        order = np.argsort(of_fast, kind="stable")
        fast, of_fast = fast[order], of_fast[order]
        starts = np.append(np.searchsorted(of_fast, which), len(fast))
        keep = np.zeros(len(slow), np.bool_)

        def merge(room: Answers, _: Rooms, first: int, last: int) -> np.int64:
            return merge_places(
                slow, of_slow, groups, first, last, fast, starts, self.domain, keep, room
            )

        unknown = self._answered(merge, len(which), 1)
        columns = np.append(np.arange(BOX), BORDER)
        return Places(np.take(slow[keep], columns, axis=1), of_slow[keep]), unknown

    def _answered(
        self, step: Callable[[Answers, Rooms, int, int], np.int64], count: int, threads: int | None
    ) -> list[Answers]:
        """Return the answers of `step` for all of [0, count).

        `step` works on a range [first, last), and returns the first number that was not processed.
        """

        def work(first: int, last: int) -> list[Answers]:
            answers = []
            with self.room() as rooms:
                while first < last:
                    room = rooms.answers[0]
                    after = int(step(room, rooms, first, last))
                    if after == first:
                        rooms.answers[0] = Answers.new(2 * len(room.kinds))
                    else:
                        answers.append(_taken(room))
                    first = after
            return answers

        return [x for part in over_ranges(work, count, HARD_AT_A_TIME, threads) for x in part]

    @contextmanager
    def room(self) -> Iterator[Rooms]:
        """Yield work arrays that no other thread uses."""
        try:
            rooms = self._rooms.pop()
        except IndexError:
            rooms = Rooms(
                Work.new(len(self.tape.operations)),
                Memory.new(int(np.diff(self.lists.starts).max())), Tiles.new(),
                Boxes.new(len(self.index.cells.place)), [Pairs.new(PAIRS)],
                [Outcome.new(ROOM, ROOM)], [Answers.new(ROOM)],
            )  # fmt: skip
        yield rooms
        self._rooms.append(rooms)


def _has_no_normals(tape: Tape, grid: Array) -> bool:
    """Return whether the surface seems to be a curve: no small probe cell has a cone of normals.

    Without this test, all cells of such a surface would be cut as often as allowed, which takes
    seconds.
    """
    few = grid[np.linspace(0, len(grid) - 1, PROBES).round().astype(int)]
    few[:, 2:] *= SMALL
    cells = _cut(tape, few, 0, 1)
    return bool(((cells.cone[:, 3] >= OPEN) & (cells.noise[:, REACH] > 0.0)).all())


def _grid(lines_u: Array, lines_v: Array) -> Array:
    """Return the midpoints and half sizes (k, 4) of the cells between grid lines."""
    (u, h_u), (v, h_v) = ((0.5 * (x[1:] + x[:-1]), 0.5 * np.diff(x)) for x in (lines_u, lines_v))
    columns = [*np.meshgrid(u, v, indexing="ij"), *np.meshgrid(h_u, h_v, indexing="ij")]
    return np.column_stack([x.ravel() for x in columns])


def _cut(tape: Tape, places: Array, levels: int, threads: int | None) -> CellBounds:
    """Return bounds for the cells with midpoints and half sizes (k, 4).

    Irregular cells are cut into four, at most `levels` times.
    """
    deepest = 3 * levels + 2

    def work(first: int, last: int) -> list[CellBounds]:
        state = np.array([first, 0, 0])
        tile, room = CellBounds.new(LANES), CellBounds.new(CELL_ROOM)
        stack = np.empty((LANES * deepest, 5))
        arrays, parts = Work.new(len(tape.operations)), []
        while state[0] < last or state[1] > 0:
            cut_cells(tape, arrays, places, state, last, levels, stack, tile, room)
            parts.append(CellBounds(*(x[: state[2]].copy() for x in room)))
        return parts

    parts = [x for y in over_ranges(work, len(places), CELLS_AT_A_TIME, threads) for x in y]
    return _joined(parts)


def _narrowed(
    tape: Tape, cells: CellBounds, rounds: int, most: int, threads: int | None
) -> CellBounds:
    """Return at most `most` cells, after cutting those without a narrow cone of normals."""
    done = list[CellBounds]()
    for _ in range(rounds):
        wide = cells.cone[:, 3] >= WIDE
        parts = _quarters(cells.place[wide])
        most -= len(cells.place) - wide.sum()
        if not 0 < len(parts) <= most:
            break
        done.append(CellBounds(*(x[~wide] for x in cells)))
        cells = _cut(tape, parts, 0, threads)
    return _joined([*done, cells])


def _quarters(places: Array) -> Array:
    """Return the midpoints and half sizes (4 k, 4) of the quarters of cells (k, 4)."""
    half = 0.5 * places[:, 2:]
    sides = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    return np.concatenate([np.hstack([places[:, :2] + x * half, half]) for x in sides])


def _joined(parts: list[CellBounds]) -> CellBounds:
    """Return the cells of all parts."""
    return CellBounds(*(np.concatenate(x) for x in zip(*parts, strict=True)))


def _pieces_of(index: Index) -> Pieces:
    """Return the cells as pieces of a search.

    The cones of discs, and wide cones, do not exclude the opposites of their normals.
    """
    cells = index.cells
    cones = np.zeros((len(cells.cone), CONE))
    cones[:, : CHORD + 1], cones[:, WIDTH] = cells.cone, 1.0
    cones[cells.cone[:, CHORD] >= WIDE, WIDTH] = EVERYTHING
    cones[index.discs :, WIDTH] = EVERYTHING
    return Pieces(cones, cells.hot)


def _taken(room: Answers) -> Answers:
    """Return a copy of the used rows of an array of answers."""
    places, boxes = room.counts
    return Answers(
        room.places[:places].copy(), room.numbers[:places].copy(), room.open_boxes[:boxes].copy(),
        room.kinds[:boxes].copy(), room.open_numbers[:boxes].copy(), room.counts.copy(),
    )  # fmt: skip


def _sorted(parts: list[Places], count: int) -> Sorted:
    """Return solutions sorted by normal, then by u and v; `count` is the number of normals."""
    starts = np.zeros(count + 1, np.int64)
    room = Sorted.new(sum(len(x.numbers) for x in parts))
    for part in parts:
        count_places(part.numbers, starts)
    start_normals(starts)
    for part in parts:
        put_places(part.rows, part.numbers, starts, room)
    order_places(room)
    return room
