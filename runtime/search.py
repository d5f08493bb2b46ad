"""Sampling by normals: every point of a spline that has one of the normals, exactly once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .bins import NormalBins
from .exact import decide
from .fields import ARRAY_NAMES, FLOAT_NAMES, INDEX_NAMES, new_field
from .kernels.developable import count_developable, first_curved
from .kernels.fill import fill_samples
from .kernels.runs import LONGEST, SIZE, fill_runs
from .kernels.scan import scan_in
from .kernels.search import Bins, Coefficients, Found, search_in
from .kernels.sort import merge_hits
from .kernels.tile import STEP, fill_known, new_tile
from .spline import Spline
from .threads import over_ranges, thread_count

__all__ = ["Hits", "Notes", "Pairs", "Search", "fill", "fill_notes", "find", "merged"]

# A range of patches is searched by one thread. There are several for each, but for small surfaces.
FEWEST_PATCHES, MOST_PATCHES = 64, 4096
RANGES_PER_THREAD = 4
SAMPLES_AT_A_TIME = 1 << 16
# Room for so many notes at first, and at most; a patch that needs more gets it.
ROOM, MOST_ROOM = 1 << 15, 1 << 20


@dataclass(frozen=True, eq=False)
class Notes:
    """Samples by patch and then by normal, as kernels note them: rows (k, 2) of patch and note.

    A note is one sample, normal << 32 | place of the normal in the order of the bins; or, if they
    are `runs`, one or more with consecutive normals (see kernels/runs.py).
    """

    rows: NDArray[np.int64]
    runs: bool

    @cached_property
    def ends(self) -> NDArray[np.int64]:
        """The number of samples up to the end of each note (k,)."""
        if not self.runs:
            return np.arange(1, len(self.rows) + 1)
        return np.cumsum(self.rows[:, 1] >> SIZE & LONGEST)

    def __len__(self) -> int:
        """Return the number of samples."""
        return int(self.ends[-1]) if self.runs and len(self.rows) else len(self.rows)

    @property
    def indices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The patches and the normals of the samples."""
        if not self.runs:
            return self.rows[:, 0], self.rows[:, 1] >> 32
        sizes = np.diff(self.ends, prepend=0)
        firsts = np.repeat((self.rows[:, 1] >> 32) - (self.ends - sizes), sizes)
        return np.repeat(self.rows[:, 0], sizes), firsts + np.arange(len(self))

    def part(self, first: int, last: int) -> Notes:
        """Return the samples first, …, last − 1, at least one."""
        if (first, last) == (0, len(self)):
            return self
        if not self.runs:
            return Notes(self.rows[first:last], self.runs)
        low, high = np.searchsorted(self.ends, (first, last - 1), side="right")
        rows = self.rows[low : high + 1].copy()
        rows[-1, 1] -= (int(self.ends[high]) - last) << SIZE
        skipped = first - (int(self.ends[low - 1]) if low else 0)
        rows[0, 1] += (skipped << 32) - (skipped << SIZE)
        return Notes(rows, self.runs)


@dataclass(frozen=True, eq=False)
class Hits:
    """Which patch has which normal, by patch and then by normal: notes that follow each other.

    `exact` are the numbers of the hits that had to be decided exactly, `pairs` (k, 2) their patches
    and normals, `local` what `Decision` says of them. `developable` counts the patches that are
    so, up to the rounding of their coordinates.
    """

    notes: tuple[Notes, ...]
    exact: NDArray[np.int64]
    pairs: NDArray[np.int64]
    local: NDArray[np.float64]
    developable: int

    @classmethod
    def none(cls, developable: int) -> Hits:
        """Return no hits."""
        empty = np.empty(0, dtype=np.int64)
        return cls((), empty, empty.reshape(0, 2), np.empty((0, 5)), developable)

    @classmethod
    def joined(cls, parts: Sequence[Hits]) -> Hits:
        """Return the hits of consecutive ranges of patches."""
        starts = np.cumsum([0, *(len(part) for part in parts[:-1])])
        exact = [part.exact + start for part, start in zip(parts, starts, strict=True)]
        return cls(
            tuple(x for part in parts for x in part.notes),
            np.concatenate(exact),
            np.concatenate([part.pairs for part in parts]),
            np.concatenate([part.local for part in parts]),
            sum(part.developable for part in parts),
        )

    def __len__(self) -> int:
        """Return the number of samples."""
        return sum(map(len, self.notes))

    @cached_property
    def patch_index(self) -> NDArray[np.int64]:
        """The patches of the hits."""
        return np.concatenate([np.empty(0, np.int64), *(x.indices[0] for x in self.notes)])

    @cached_property
    def normal_index(self) -> NDArray[np.int64]:
        """The normals of the hits."""
        return np.concatenate([np.empty(0, np.int64), *(x.indices[1] for x in self.notes)])

    def __getitem__(self, key: slice) -> Hits:
        """Return consecutive hits; the developable patches are counted with the first of all."""
        first, last, _ = key.indices(len(self))
        low, high = np.searchsorted(self.exact, (first, last))
        return Hits(
            tuple(x for _, x in self.pieces(first, last)),
            self.exact[low:high] - first,
            self.pairs[low:high],
            self.local[low:high],
            self.developable if first == 0 else 0,
        )

    def pieces(self, first: int, last: int, size: int | None = None) -> list[tuple[int, Notes]]:
        """Return the notes of the hits first, …, last − 1, `size` at most, and where they begin."""
        found, start = [], 0
        for notes in self.notes:
            low, high = max(first - start, 0), min(last - start, len(notes))
            for begin in range(low, high, size or max(high, 1)):
                end = min(begin + size, high) if size else high
                found.append((start + begin, notes.part(begin, end)))
            start += len(notes)
        return found


@dataclass(frozen=True, eq=False)
class Pairs:
    """What some patches yield: rows (…, 2) of patch and note, see `Notes`.

    Some are sure; rounding leaves the others open, with the error `bounds` of their forms. `last`
    is the patch after the last one.
    """

    last: int
    sure: NDArray[np.int64]
    doubtful: NDArray[np.int64]
    bounds: NDArray[np.float64]
    developable: int


@dataclass(frozen=True, eq=False)
class Search:
    """The search for the normals that the patches of a spline have, range by range."""

    spline: Spline
    bins: NormalBins

    @cached_property
    def border(self) -> NDArray[np.bool_]:
        """Which sides of the domain are open, in the order of a cell's triangles: s, e, n, w."""
        (west, east), (south, north) = self.spline.boundary
        return np.array([end == "open" for end in (south, east, north, west)])

    @cached_property
    def hopeless(self) -> bool:
        """Whether all patches are developable, up to the rounding of their coordinates."""
        spline, net = self.spline, np.empty((6, 3))
        if first_curved(spline.coefficients, spline.scale, spline.noise, net) < spline.patches:
            return False
        return self.developable(np.arange(spline.patches)) == spline.patches

    def developable(self, patches: NDArray[np.int64]) -> int:
        """Return how many of the patches, which may be developable, are."""
        if len(patches) == 0:
            return 0
        spline, net = self.spline, np.empty((6, 3))
        return count_developable(spline.coefficients, spline.scale, spline.noise, patches, net)

    @cached_property
    def coefficients(self) -> Coefficients:
        """What kernels read of the spline."""
        spline = self.spline
        return Coefficients(spline.coefficients, spline.scale, spline.noise, self.border)

    def kernel(self) -> Callable[[int, int, Found], tuple[int, int]]:
        """Return what searches patches for these normals, with memory of its own."""
        bins = self.bins
        if bins.frequency > 0:
            return scan_in(self.coefficients, bins.normals, bins.frequency)
        ordered = Bins(bins.frame, bins.stretch, bins.grid, *bins.sorted)
        return search_in(self.coefficients, ordered)

    def pairs(self, first: int, last: int) -> list[Pairs]:
        """Return what the patches first, …, last − 1 yield, in one or more parts."""
        search = self.kernel()
        parts, room, begin = [], ROOM, first
        while begin < last:
            found = Found.new(room, last - begin)
            end, needed = search(begin, last, found)
            sure, open_, flat = found.counts.tolist()
            developable = self.developable(found.flat[:flat])
            rows = found.certain[:sure] if 2 * sure > room else found.certain[:sure].copy()
            doubts = found.undecided[:open_].copy(), found.bounds[:open_].copy()
            parts.append(Pairs(end, rows, *doubts, developable))
            # What is left will have about as many, and some more.
            rate = 1.2 * (sure / (end - begin)) if end > begin else 0.0
            room = max(ROOM, needed, min(int(rate * (last - end)), MOST_ROOM) + needed)
            begin = end
        return parts

    def range_size(self, threads: int | None) -> int:
        """Return how many patches one range has."""
        count = self.spline.patches // (RANGES_PER_THREAD * thread_count(threads))
        return min(max(count, FEWEST_PATCHES), MOST_PATCHES)

    def decided(
        self, doubtful: NDArray[np.int64], bounds: NDArray[np.float64], threads: int | None
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return those of the doubtful pairs that are samples, and what `Decision` says of them."""
        if len(doubtful) == 0:
            return doubtful, np.empty((0, 5))
        patches, numbers = doubtful[:, 0].copy(), doubtful[:, 1] >> 32
        forgiven = np.where(_on_border(self.spline, self.border, patches), bounds, 0.0)
        normals = self.bins.normals[numbers]
        decision = decide(self.spline, patches, normals, numbers, bounds, forgiven, threads)
        return doubtful[decision.which], decision.local


def find(
    spline: Spline, bins: NormalBins, threads: int | None = None, progress: bool = False
) -> Hits:
    """Return which patch of a spline has which of the normals."""
    search = Search(spline, bins)
    if search.hopeless:
        return Hits.none(spline.patches)
    size = search.range_size(threads)
    ranges = over_ranges(search.pairs, spline.patches, size, threads, progress)
    parts = [part for found in ranges for part in found]
    doubtful = np.concatenate([part.doubtful for part in parts])
    bounds = np.concatenate([part.bounds for part in parts])
    return merged(parts, *search.decided(doubtful, bounds, threads), bins.frequency > 0)


def fill(
    spline: Spline,
    bins: NormalBins,
    hits: Hits,
    threads: int | None = None,
    fields: Sequence[str] = ARRAY_NAMES,
    dtype: DTypeLike = np.float64,
) -> dict[str, NDArray[Any]]:
    """Return fields of the hits: see `Samples`. Numbers are rounded to `dtype` when stored."""
    count = len(hits)
    types = dict.fromkeys(FLOAT_NAMES, dtype) | dict.fromkeys(INDEX_NAMES, np.int64)
    filled = {x: new_field(x, count, types[x]) for x in ARRAY_NAMES if x in fields}
    arrays = [filled.get(name) for name in (*FLOAT_NAMES, *INDEX_NAMES)]
    pieces = hits.pieces(0, count, SAMPLES_AT_A_TIME)

    def work(first: int, last: int) -> None:
        for start, notes in pieces[first:last]:
            fill_notes(spline, bins, notes, start, arrays)

    for _ in over_ranges(work, len(pieces), 1, threads):
        pass
    if len(hits.exact) and any(name in filled for name in FLOAT_NAMES):
        fill_known(
            spline.coefficients, spline.scale, bins.normals, spline.frame,
            hits.exact, hits.pairs, hits.local, *arrays[: len(FLOAT_NAMES)],
        )  # fmt: skip
    return filled


def fill_notes(
    spline: Spline,
    bins: NormalBins,
    notes: Notes,
    start: int,
    arrays: Sequence[NDArray[Any] | None],
) -> None:
    """Fill arrays, in the order of FLOAT_NAMES and INDEX_NAMES, from number `start` on."""
    patches = spline.coefficients, spline.scale
    tile, indices = new_tile()
    if notes.runs:
        fill_runs(
            *patches, bins.normals, spline.frame, bins.frequency, notes.rows, start,
            tile, indices, np.zeros(2 * STEP, np.int64), *arrays,
        )  # fmt: skip
    else:
        fill_samples(
            *patches, bins.sorted[1], spline.frame, notes.rows, start, tile, indices, *arrays
        )


def merged(
    parts: Sequence[Pairs], decided: NDArray[np.int64], local: NDArray[np.float64], runs: bool
) -> Hits:
    """Return the sure pairs of consecutive ranges and those that were decided, sorted, as hits."""
    ends = np.searchsorted(decided[:, 0], [0, *(part.last for part in parts)])
    found, exact, start = [], [], 0
    for part, first, last in zip(parts, ends[:-1], ends[1:], strict=True):
        notes = Notes(part.sure, runs)
        if last > first:
            rows = np.empty((len(part.sure) + last - first, 2), dtype=np.int64)
            places = np.empty(last - first, dtype=np.int64)
            merge_hits(part.sure, decided[first:last], rows, places)
            notes = Notes(rows, runs)
            exact.append(start + notes.ends[places] - 1)
        found.append(notes)
        start += len(notes)
    numbers = np.concatenate(exact) if exact else np.empty(0, dtype=np.int64)
    pairs = decided >> np.array([0, 32])
    return Hits(tuple(found), numbers, pairs, local, sum(part.developable for part in parts))


def _on_border(
    spline: Spline, border: NDArray[np.bool_], patches: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Say which patches have their outer edge on the open border of the domain."""
    cell, turn = np.divmod(patches, 4)
    i, j = np.divmod(cell, spline.cells[1])
    outermost = np.stack([j == 0, i == spline.cells[0] - 1, j == spline.cells[1] - 1, i == 0])
    return border[turn] & np.take_along_axis(outermost, turn[None], axis=0)[0]
