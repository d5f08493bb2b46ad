"""The search for all points of a spline with given normals, each found exactly once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..base.kept import kept
from ..base.threads import over_ranges, thread_count
from ..kernels.developable import count_developable, first_curved
from ..kernels.fill import fill_samples
from ..kernels.runs import LONGEST, SIZE, fill_runs
from ..kernels.scan import scan_in
from ..kernels.search import Bins, Coefficients, Found, search_in
from ..kernels.sort import merge_hits
from ..kernels.tile import STEP, fill_known, new_tile
from ..samples.fields import ARRAY_NAMES, FLOAT_NAMES, INDEX_NAMES, new_field
from ..spline.nets import NetSpline
from ..spline.spline import Spline
from .bins import NormalBins, icosahedron
from .cone_tree import ConeTree
from .exact import decide
from .in_nets import Found as FoundInNets
from .in_nets import cones_of, fields_in_nets, find_in_nets

__all__ = [
    "Hits",
    "PackedHits",
    "Search",
    "SearchResult",
    "developable_patches",
    "fill",
    "fill_packed",
    "find",
    "merged",
]

# The number of patches of a range, which one thread searches. Each thread gets several ranges,
# except on small surfaces.
FEWEST_PATCHES, MOST_PATCHES = 128, 4096
RANGES_PER_THREAD = 4
SAMPLES_AT_A_TIME = 1 << 16
# The initial and the largest capacity for packed hits; a patch that needs more gets it.
ROOM, MOST_ROOM = 1 << 15, 1 << 20
# With more patches than this number for each normal, patches are looked up in the tree of cones.
PATCHES_PER_NORMAL = 4
# A key is number of a patch << 32 | number of a normal; a packed hit has the latter in both places.
NUMBER, REPEATED = (1 << 32) - 1, (1 << 32) + 1


@dataclass(frozen=True, eq=False)
class PackedHits:
    """Packed hits, sorted by patch and then by normal: rows (k, 2) of a patch and a packed hit.

    A packed hit is number of the normal << 32 | its row in `normals` (S, 3 or more). If these are
    None, it is a packed run: one or more consecutive points of an icosphere (see kernels/runs.py).
    """

    rows: NDArray[np.int64]
    normals: NDArray[np.float64] | None

    @cached_property
    def ends(self) -> NDArray[np.int64]:
        """The cumulative number of samples (k,) at the end of each row."""
        if self.normals is not None:
            return np.arange(1, len(self.rows) + 1)
        return np.cumsum(self.rows[:, 1] >> SIZE & LONGEST)

    def __len__(self) -> int:
        """Return the number of samples."""
        return int(self.ends[-1]) if self.normals is None and len(self.rows) else len(self.rows)

    @property
    def indices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The patches and the normals of the samples."""
        if self.normals is not None:
            return self.rows[:, 0], self.rows[:, 1] >> 32
        sizes = np.diff(self.ends, prepend=0)
        firsts = np.repeat((self.rows[:, 1] >> 32) - (self.ends - sizes), sizes)
        return np.repeat(self.rows[:, 0], sizes), firsts + np.arange(len(self))

    def part(self, first: int, last: int) -> PackedHits:
        """Return the samples first, …, last − 1; there must be at least one."""
        if (first, last) == (0, len(self)):
            return self
        if self.normals is not None:
            return PackedHits(self.rows[first:last], self.normals)
        low, high = np.searchsorted(self.ends, (first, last - 1), side="right")
        rows = self.rows[low : high + 1].copy()
        rows[-1, 1] -= (int(self.ends[high]) - last) << SIZE
        skipped = first - (int(self.ends[low - 1]) if low else 0)
        rows[0, 1] += (skipped << 32) - (skipped << SIZE)
        return PackedHits(rows, None)


@dataclass(frozen=True, eq=False)
class Hits:
    """The hits, a patch and one of its normals each, sorted by patch and then by normal.

    `packed` holds them in consecutive parts. `exact` (k,) are the numbers of the hits that were
    decided exactly, `exact_indices` (k, 2) their patches and normals, `local` (k, 5) that of
    `Decision`. `developable` is the number of patches that are developable up to the rounding of
    their coordinates.
    """

    packed: tuple[PackedHits, ...]
    exact: NDArray[np.int64]
    exact_indices: NDArray[np.int64]
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
            tuple(x for part in parts for x in part.packed),
            np.concatenate(exact),
            np.concatenate([part.exact_indices for part in parts]),
            np.concatenate([part.local for part in parts]),
            sum(part.developable for part in parts),
        )

    def __len__(self) -> int:
        """Return the number of samples."""
        return sum(map(len, self.packed))

    @cached_property
    def patch_index(self) -> NDArray[np.int64]:
        """The patch number of each hit."""
        return np.concatenate([np.empty(0, np.int64), *(x.indices[0] for x in self.packed)])

    @cached_property
    def normal_index(self) -> NDArray[np.int64]:
        """The number of the normal of each hit."""
        return np.concatenate([np.empty(0, np.int64), *(x.indices[1] for x in self.packed)])

    def __getitem__(self, key: slice) -> Hits:
        """Return consecutive hits; developable patches count only for a slice from 0 on."""
        first, last, _ = key.indices(len(self))
        low, high = np.searchsorted(self.exact, (first, last))
        return Hits(
            tuple(x for _, x in self.pieces(first, last)),
            self.exact[low:high] - first,
            self.exact_indices[low:high],
            self.local[low:high],
            self.developable if first == 0 else 0,
        )

    def pieces(
        self, first: int, last: int, size: int | None = None
    ) -> list[tuple[int, PackedHits]]:
        """Return the hits first, …, last − 1 in pieces, with the number of the first hit of each.

        A piece has at most `size` hits.
        """
        found, start = [], 0
        for packed in self.packed:
            low, high = max(first - start, 0), min(last - start, len(packed))
            for begin in range(low, high, size or max(high, 1)):
                end = min(begin + size, high) if size else high
                found.append((start + begin, packed.part(begin, end)))
            start += len(packed)
        return found


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The hits of consecutive patches up to `last` − 1: rows (…, 2) as in `PackedHits`.

    Hits are certain, or undecided because of rounding; `bounds` (…) are the error bounds of the
    forms of the undecided ones. `developable` is the number of developable patches.
    """

    last: int
    certain: NDArray[np.int64]
    undecided: NDArray[np.int64]
    bounds: NDArray[np.float64]
    developable: int


@dataclass(frozen=True, eq=False)
class Search:
    """The search for the patches of a spline that have given normals, by ranges of patches."""

    spline: Spline
    bins: NormalBins

    @cached_property
    def border(self) -> NDArray[np.bool_]:
        """Whether the sides of the domain are open (4,), in the order south, east, north, west."""
        (west, east), (south, north) = self.spline.boundary
        return np.array([end == "open" for end in (south, east, north, west)])

    @cached_property
    def in_tree(self) -> bool:
        """Whether the normals are few, and patches are looked up in the tree of their cones."""
        return PATCHES_PER_NORMAL * len(self.bins.normals) < self.spline.patches

    @property
    def order(self) -> NDArray[np.float64] | None:
        """The normals in the order to which packed hits refer."""
        if self.in_tree:
            return self.bins.normals
        return None if self.bins.frequency > 0 else self.bins.sorted[1]

    def tree(self, threads: int | None) -> ConeTree:
        """Return the tree of cones; it is kept with the spline."""
        return kept(self.spline, ConeTree, lambda: ConeTree.of(self.coefficients, threads))

    def result_in_tree(self, threads: int | None) -> SearchResult:
        """Return the hits of all patches, by the tree of cones."""
        tree = self.tree(threads)
        certain, undecided = tree.search(self.bins.normals, threads)
        developable = developable_patches(self.spline, threads)
        bounds = tree.bounds[undecided >> 32]

        def rows(keys: NDArray[np.int64]) -> NDArray[np.int64]:
            return np.stack([keys >> 32, (keys & NUMBER) * REPEATED], axis=1)

        return SearchResult(
            self.spline.patches, rows(certain), rows(undecided), bounds, developable
        )

    @property
    def all_developable(self) -> bool:
        """Whether all patches are developable, up to the rounding of their coordinates."""
        return kept(self.spline, "all developable", self._all_developable)

    def _all_developable(self) -> bool:
        spline = self.spline
        if first_curved(spline.coefficients, spline.scale, spline.noise) < spline.patches:
            return False
        return self.developable(np.arange(spline.patches)) == spline.patches

    def developable(self, patches: NDArray[np.int64]) -> int:
        """Return how many of some patches are developable, up to the rounding of coordinates."""
        if len(patches) == 0:
            return 0
        spline = self.spline
        return count_developable(spline.coefficients, spline.scale, spline.noise, patches)

    @cached_property
    def coefficients(self) -> Coefficients:
        """The coefficients of the spline in the form that kernels take."""
        spline = self.spline
        return Coefficients(spline.coefficients, spline.scale, spline.noise, self.border)

    def kernel(self) -> Callable[[int, int, Found], tuple[int, int]]:
        """Return a function that searches a range of patches, with its own work arrays."""
        bins = self.bins
        if bins.frequency > 0:
            return scan_in(self.coefficients, icosahedron(bins.frequency), bins.normals)
        ordered = Bins(bins.frame, bins.stretch, bins.grid, *bins.sorted)
        return search_in(self.coefficients, bins.cube, ordered)

    def results(self, first: int, last: int) -> list[SearchResult]:
        """Search the patches first, …, last − 1; return the result in one or more parts."""
        search = self.kernel()
        parts, room, begin = [], ROOM, first
        while begin < last:
            found = Found.new(room, last - begin)
            end, needed = search(begin, last, found)
            certain, undecided, flat = found.counts.tolist()
            developable = self.developable(found.flat[:flat])
            rows = found.certain[:certain]
            if 2 * certain <= room:
                rows = rows.copy()  # a view would keep the whole array in memory
            open_ = found.undecided[:undecided].copy(), found.bounds[:undecided].copy()
            parts.append(SearchResult(end, rows, *open_, developable))
            # The remaining patches are expected to have about as many hits each, and 20 % more.
            rate = 1.2 * (certain / (end - begin)) if end > begin else 0.0
            room = max(ROOM, needed, min(int(rate * (last - end)), MOST_ROOM) + needed)
            begin = end
        return parts

    def range_size(self, threads: int | None) -> int:
        """Return how many patches one range has."""
        count = self.spline.patches // (RANGES_PER_THREAD * thread_count(threads))
        return min(max(count, FEWEST_PATCHES), MOST_PATCHES)

    def decided(
        self, undecided: NDArray[np.int64], bounds: NDArray[np.float64], threads: int | None
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Decide undecided hits exactly; return the rows that are hits, and `Decision.local`."""
        if len(undecided) == 0:
            return undecided, np.empty((0, 5))
        patches, numbers = undecided[:, 0].copy(), undecided[:, 1] >> 32
        forgiven = np.where(_on_border(self.spline, self.border, patches), bounds, 0.0)
        normals = self.bins.normals[numbers]
        decision = decide(self.spline, patches, normals, numbers, forgiven, threads)
        return undecided[decision.which], decision.local


def developable_patches(spline: Spline, threads: int | None) -> int:
    """Return how many patches are developable, up to the rounding of their coordinates."""
    if isinstance(spline, NetSpline):
        return int(np.count_nonzero(cones_of(spline).flat))
    search = Search(spline, NormalBins(np.eye(3)))
    return kept(spline, "developable", lambda: search.developable(search.tree(threads).flat))


def find(
    spline: Spline, bins: NormalBins, threads: int | None = None, progress: bool = False
) -> Hits:
    """Return all hits: which patch of a spline has which of the normals."""
    if isinstance(spline, NetSpline):
        return _hits_in_nets(spline, find_in_nets(spline, bins.normals, threads))
    search = Search(spline, bins)
    if search.all_developable:
        return Hits.none(spline.patches)
    if search.in_tree:
        parts = [search.result_in_tree(threads)]
    else:
        size = search.range_size(threads)
        ranges = over_ranges(search.results, spline.patches, size, threads, progress)
        parts = [part for found in ranges for part in found]
    undecided = np.concatenate([part.undecided for part in parts])
    bounds = np.concatenate([part.bounds for part in parts])
    return merged(parts, *search.decided(undecided, bounds, threads), search.order)


def fill(
    spline: Spline,
    bins: NormalBins,
    hits: Hits,
    threads: int | None = None,
    fields: Sequence[str] = ARRAY_NAMES,
    dtype: DTypeLike = np.float64,
    memory: Mapping[str, NDArray[Any]] = MappingProxyType({}),
) -> dict[str, NDArray[Any]]:
    """Return fields of samples at the hits, see `Samples`; floats are stored as `dtype`.

    They are written to the fields in `memory` that are large enough.
    """
    if isinstance(spline, NetSpline):
        found = FoundInNets(hits.patch_index, hits.normal_index, hits.exact, hits.local[:, :3])
        return fields_in_nets(spline, bins.normals, found, fields, dtype)
    count = len(hits)
    types = dict.fromkeys(FLOAT_NAMES, dtype) | dict.fromkeys(INDEX_NAMES, np.int64)
    filled = {x: new_field(x, count, types[x], memory) for x in ARRAY_NAMES if x in fields}
    arrays = [filled[x] if x in filled else new_field(x, 0, types[x]) for x in types]
    pieces = hits.pieces(0, count, SAMPLES_AT_A_TIME)

    def work(first: int, last: int) -> None:
        for start, packed in pieces[first:last]:
            fill_packed(spline, bins, packed, start, arrays)

    list(over_ranges(work, len(pieces), 1, threads))
    if len(hits.exact) and any(name in filled for name in FLOAT_NAMES):
        fill_known(
            spline.coefficients, spline.scale, bins.normals, spline.frame,
            hits.exact, hits.exact_indices, hits.local, *arrays[: len(FLOAT_NAMES)],
        )  # fmt: skip
    return filled


def fill_packed(
    spline: Spline,
    bins: NormalBins,
    packed: PackedHits,
    start: int,
    arrays: Sequence[NDArray[Any]],
) -> None:
    """Fill arrays from row `start` on with the samples at packed hits.

    The arrays are in the order of FLOAT_NAMES and INDEX_NAMES; absent fields are empty.
    """
    patches = spline.coefficients, spline.scale
    tile, indices = new_tile()
    if packed.normals is None:
        fill_runs(
            *patches, bins.normals, spline.frame, bins.frequency, packed.rows, start,
            tile, indices, np.zeros(2 * STEP, np.int64), *arrays,
        )  # fmt: skip
    else:
        fill_samples(
            *patches, packed.normals, spline.frame, packed.rows, start, tile, indices, *arrays
        )


def merged(
    parts: Sequence[SearchResult],
    decided: NDArray[np.int64],
    local: NDArray[np.float64],
    normals: NDArray[np.float64] | None,
) -> Hits:
    """Return the certain hits of consecutive ranges, merged with those that were decided exactly.

    `decided` (k, 2) and `normals` are those of `PackedHits`, `local` (k, 5) that of `Decision`.
    """
    ends = np.searchsorted(decided[:, 0], [0, *(part.last for part in parts)])
    found, exact, start = [], [], 0
    for part, first, last in zip(parts, ends[:-1], ends[1:], strict=True):
        packed = PackedHits(part.certain, normals)
        if last > first:
            rows = np.empty((len(part.certain) + last - first, 2), dtype=np.int64)
            places = np.empty(last - first, dtype=np.int64)
            merge_hits(part.certain, decided[first:last], rows, places)
            packed = PackedHits(rows, normals)
            exact.append(start + packed.ends[places] - 1)
        found.append(packed)
        start += len(packed)
    numbers = np.concatenate(exact) if exact else np.empty(0, dtype=np.int64)
    indices = decided >> np.array([0, 32])
    return Hits(tuple(found), numbers, indices, local, sum(part.developable for part in parts))


def _hits_in_nets(spline: NetSpline, found: FoundInNets) -> Hits:
    """Return hits of a spline of nets as those of others."""
    rows = np.stack([found.patches, found.normals * REPEATED], axis=1)
    packed = (PackedHits(rows, np.empty((0, 3))),) if len(rows) else ()
    local = np.concatenate([found.local, found.local[:, :2]], axis=1)
    indices = np.stack([found.patches, found.normals], axis=1)[found.exact]
    developable = developable_patches(spline, None)
    return Hits(packed, found.exact, indices, local, developable)


def _on_border(
    spline: Spline, border: NDArray[np.bool_], patches: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return which patches have their outer edge on the open border of the domain."""
    cell, turn = np.divmod(patches, 4)
    i, j = np.divmod(cell, spline.cells[1])
    outermost = np.stack([j == 0, i == spline.cells[0] - 1, j == spline.cells[1] - 1, i == 0])
    return border[turn] & np.take_along_axis(outermost, turn[None], axis=0)[0]
