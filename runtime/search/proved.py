"""All points of a surface with given normals, each exactly once, with a proof.

A surface whose coordinates are a tape (`runtime.kernels.tape`) has bounds of its derivatives over
boxes of its parameters. An index cuts its domain into cells with a cone of normals each. For a
normal, cells are excluded by bounds, or have one point by a contraction, or are cut. What stays
open lies in small boxes, which are listed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..base.threads import over_ranges
from ..domain.domain import Boundary, Domain
from ..kernels.proved_bins import count_members, list_members
from ..kernels.proved_cells import Cells, Work, cut_cells
from ..kernels.proved_places import BORDER, BOX, KINDS, Answers, Boxes, decide_normals
from ..kernels.proved_search import PLACE, Found, Index, Tiles, search_normals
from ..kernels.proved_sorting import sort_places
from ..kernels.tape import LANES, Tape
from .bins import sorted_normals

__all__ = ["KINDS", "ProvedIndex", "ProvedPlaces", "Undecided"]

# How often irregular cells are cut into four, and cells without a narrow cone of normals.
LEVELS = (2, 5)
CELLS = (64, 64)
# Base cells, normals and hard normals that are worked on at a time.
CELLS_AT_A_TIME, NORMALS_AT_A_TIME, HARD_AT_A_TIME = 512, 1 << 13, 1 << 8
# Room for cells, and for what is found at a time, in the beginning.
CELL_ROOM, ROOM = 2048, 1 << 12
# Normals of a tile are close to one another if there are so many in a bin; fewer are not sorted.
NORMALS_PER_BIN, SORTED = 24, 64
FINEST = 1024


class Undecided(NamedTuple):
    """Boxes of parameters in which the points with a normal are not known.

    numbers (k,) int64 are those of normals; boxes (k, 4) are u₀, u₁, v₀, v₁; kinds (k,) int64 are
    positions in `KINDS`; border (k,) bool says whether a box touches an open side of the domain.
    """

    numbers: NDArray[np.int64]
    boxes: NDArray[np.float64]
    kinds: NDArray[np.int64]
    border: NDArray[np.bool_]


class ProvedPlaces(NamedTuple):
    """The points with given normals, in the order of the normals, then of u and v.

    numbers (k,) int64 are those of normals; uv (k, 2) the parameters, and radius (k, 2) how far the
    exact ones may be from them, each; sign (k,) int8 that of the Gaussian curvature; border (k,)
    bool says whether the exact parameters may be outside of the domain, by at most the radius. All
    other points with these normals are in the boxes of `undecided`.
    """

    numbers: NDArray[np.int64]
    uv: NDArray[np.float64]
    radius: NDArray[np.float64]
    sign: NDArray[np.int8]
    border: NDArray[np.bool_]
    undecided: Undecided


class Rooms(NamedTuple):
    """Work arrays of one thread."""

    work: Work
    tiles: Tiles
    boxes: Boxes
    found: list[Found]
    answers: list[Answers]


@dataclass(frozen=True, eq=False)
class ProvedIndex:
    """The index of a surface: immutable, and shared by threads.

    `domain` (6,) is u₀, u₁, v₀, v₁, and the periods of u and v, 0 if there is none. A mirrored
    parameter has no period here: normals change their sides at its ends.
    """

    tape: Tape
    domain: NDArray[np.float64]
    index: Index
    grid: int  # of the bins
    _rooms: deque[Rooms] = field(default_factory=deque, repr=False)

    @classmethod
    def of(
        cls,
        tape: Tape,
        domain: Domain,
        boundary: Boundary,
        cells: tuple[int, int] = CELLS,
        threads: int | None = None,
    ) -> ProvedIndex:
        """Return the index of a surface.

        Parameters
        ----------
        tape : Tape
            The coordinates as functions of the parameters.
        domain : ((u0, u1), (v0, v1)) of float
            The rectangle of the parameters.
        boundary : pair of pairs of str
            The boundary conditions of u and of v, as those of `Surface`.
        cells : (int, int), default (64, 64)
            How many cells there are along u and v before they are cut; the answers do not depend
            on it, but for what is undecided.
        threads : int, optional
            The number of threads. By default one for each core.

        Returns
        -------
        ProvedIndex
            The index.

        """
        periods = (
            high - low if ends[0] == "periodic" else 0.0
            for (low, high), ends in zip(domain, boundary, strict=True)
        )
        box = np.array([*domain[0], *domain[1], *periods])
        cut = _cut(tape, box, cells, threads)
        # Cells of a bin are near one another in memory.
        levels = max(2, round(np.log2(np.sqrt(len(cut.place) / 24.0))))
        return cls(tape, box, _listed(cut, levels), 1 << levels)

    def query(self, normals: NDArray[np.float64], threads: int | None = None) -> ProvedPlaces:
        """Return all points with unit normals (S, 3).

        The answer for a normal depends neither on the other ones nor on the number of threads.
        """
        normals = np.ascontiguousarray(normals, np.float64)
        places, numbers, hard = self._search(normals, threads)
        if len(hard) == 0:
            rows = np.zeros((len(places), PLACE + 1))
            rows[:, :PLACE] = places
            return _result(rows, numbers, len(normals), [])
        answers = self._decide(normals, places, numbers, hard, threads)
        rows = np.zeros((len(places) + sum(len(x.places) for x in answers), PLACE + 1))
        rows[: len(places), :PLACE] = places
        found = [np.column_stack([x.places[:, :BOX], x.places[:, BORDER]]) for x in answers]
        rows[len(places) :] = np.concatenate(found)
        all_numbers = np.concatenate([numbers, *(x.numbers for x in answers)])
        return _result(rows, all_numbers, len(normals), answers)

    def _search(
        self, normals: NDArray[np.float64], threads: int | None
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Return places (k, 5), the numbers of their normals, and hard pairs (m, 2)."""
        ordered = self._ordered(normals, threads)

        def work(
            first: int, last: int
        ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
            with self._room() as rooms:
                while not search_normals(
                    self.index, self.tape, rooms.work, ordered, self.grid, first, last,
                    rooms.tiles, rooms.found[0],
                ):  # fmt: skip
                    room = rooms.found[0]
                    rooms.found[0] = Found.new(2 * len(room.numbers), 2 * len(room.hard))
                found = rooms.found[0]
                places, hard = found.counts
                return (
                    found.places[:places].copy(),
                    found.numbers[:places].copy(),
                    found.hard[:hard].copy(),
                )

        parts = list(over_ranges(work, len(normals), NORMALS_AT_A_TIME, threads))
        if len(parts) == 1:
            return parts[0]
        if not parts:
            return np.empty((0, PLACE)), np.empty(0, np.int64), np.empty((0, 2), np.int64)
        places, numbers, hard = (np.concatenate(x) for x in zip(*parts, strict=True))
        return places, numbers, hard

    def _ordered(self, normals: NDArray[np.float64], threads: int | None) -> NDArray[np.float64]:
        """Return normals with their numbers (S, 4), those of a bin together."""
        if len(normals) < SORTED:
            return np.column_stack([normals, np.arange(len(normals))])
        grid = self.grid
        while 6 * (2 * grid) ** 2 * NORMALS_PER_BIN <= len(normals) and grid < FINEST:
            grid *= 2
        return sorted_normals(normals, np.eye(3), grid, threads)[1]

    def _decide(
        self,
        normals: NDArray[np.float64],
        places: NDArray[np.float64],
        numbers: NDArray[np.int64],
        hard: NDArray[np.int64],
        threads: int | None,
    ) -> list[Answers]:
        """Return what is found about normals with hard pairs."""
        hard = hard[np.lexsort((hard[:, 1], hard[:, 0]))]
        which, groups = np.unique(hard[:, 0], return_index=True)
        groups = np.append(groups, len(hard))
        asked = np.zeros(len(normals), np.bool_)
        asked[which] = True
        near = np.flatnonzero(asked[numbers])
        near = near[np.argsort(numbers[near], kind="stable")]
        fast, starts = places[near], np.append(np.searchsorted(numbers[near], which), len(near))

        def work(first: int, last: int) -> list[Answers]:
            answers = []
            with self._room() as rooms:
                while first < last:
                    room = rooms.answers[0]
                    after = decide_normals(
                        self.index, self.tape, rooms.work, normals, hard, groups, first, last,
                        fast, starts, self.domain, rooms.boxes, room,
                    )  # fmt: skip
                    if after == first:
                        rooms.answers[0] = Answers.new(2 * len(room.kinds))
                    else:
                        answers.append(_taken(room))
                    first = after
            return answers

        return [x for part in over_ranges(work, len(which), HARD_AT_A_TIME, threads) for x in part]

    @contextmanager
    def _room(self) -> Iterator[Rooms]:
        """Yield work arrays that no other thread uses."""
        try:
            rooms = self._rooms.pop()
        except IndexError:
            rooms = Rooms(
                Work.new(len(self.tape.operations)), Tiles.new(), Boxes.new(len(self.index.cells.place)),
                [Found.new(ROOM, ROOM)], [Answers.new(ROOM)],
            )  # fmt: skip
        yield rooms
        self._rooms.append(rooms)


def _cut(
    tape: Tape, box: NDArray[np.float64], cells: tuple[int, int], threads: int | None
) -> Cells:
    """Return the cells of a domain."""
    base, levels = np.array(cells), np.array(LEVELS)
    deepest = 3 * max(LEVELS) + 2

    def work(first: int, last: int) -> list[Cells]:
        state = np.array([first, 0, 0])
        stack, tile, room = np.empty((LANES * deepest, 5)), Cells.new(LANES), Cells.new(CELL_ROOM)
        arrays, parts = Work.new(len(tape.operations)), []
        while state[0] < last or state[1] > 0:
            cut_cells(tape, arrays, box, base, state, last, levels, stack, tile, room)
            parts.append(Cells(*(x[: state[2]].copy() for x in room)))
        return parts

    parts = [x for y in over_ranges(work, cells[0] * cells[1], CELLS_AT_A_TIME, threads) for x in y]
    return Cells(*(np.concatenate(x) for x in zip(*parts, strict=True)))


def _listed(cells: Cells, levels: int) -> Index:
    """Return the cells with the lists of those that may have the normals of bins."""
    starts, stack = np.zeros(6 * 4**levels + 1, np.int64), np.empty((4 + 3 * levels, 3), np.int64)
    count_members(cells.cone, levels, stack, starts, np.empty(0, np.int32))
    members = np.empty(starts.sum(), np.int32)
    list_members(cells.cone, levels, stack, starts, members)
    return Index(cells, starts, members)


def _taken(room: Answers) -> Answers:
    """Return a copy of the answers in a room."""
    places, boxes = room.counts
    return Answers(
        room.places[:places].copy(), room.numbers[:places].copy(), room.open_boxes[:boxes].copy(),
        room.kinds[:boxes].copy(), room.open_numbers[:boxes].copy(), room.counts.copy(),
    )  # fmt: skip


def _result(
    rows: NDArray[np.float64], numbers: NDArray[np.int64], count: int, answers: list[Answers]
) -> ProvedPlaces:
    """Return places (k, 6) and undecided boxes, sorted by their normals."""
    starts = np.zeros(count + 1, np.int64)
    uv, radius = np.empty((len(rows), 2)), np.empty((len(rows), 2))
    sign, border = np.empty(len(rows), np.int8), np.empty(len(rows), np.bool_)
    in_order = np.empty(len(rows), np.int64)
    sort_places(rows, numbers, starts, in_order, uv, radius, sign, border)

    def joined(values: Callable[[Answers], NDArray], empty: NDArray) -> NDArray:
        return np.concatenate([empty, *map(values, answers)])

    integers = np.empty(0, np.int64)
    of, kinds = joined(lambda x: x.open_numbers, integers), joined(lambda x: x.kinds, integers)
    boxes = joined(lambda x: x.open_boxes, np.empty((0, 5)))
    undecided = Undecided(of, boxes[:, :4].copy(), kinds, boxes[:, 4] > 0.0)
    return ProvedPlaces(in_order, uv, radius, sign, border, undecided)
