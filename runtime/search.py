"""Sampling by normals: every point of a spline that has one of the normals, exactly once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..generated import icosphere
from ..generated import sampler as kernels
from .bins import NormalBins
from .exact import decide
from .fields import ARRAY_NAMES, FLOAT_NAMES, INDEX_NAMES, new_field
from .spline import Spline
from .threads import over_ranges, thread_count

__all__ = ["Hits", "Pairs", "Search", "fill", "find", "merged"]

# A range of patches is searched by one thread. There are several for each, but for small surfaces.
FEWEST_PATCHES, MOST_PATCHES = 64, 4096
RANGES_PER_THREAD = 4
SAMPLES_AT_A_TIME = 1 << 16
# Room for so many hits at first; a patch that needs more gets it.
ROOM = 1 << 15


@dataclass(frozen=True, eq=False)
class Hits:
    """Which patch has which normal, by patch and then by normal.

    `place` is the place of the normal in the order of the bins. `exact` are the numbers of the hits
    that had to be decided exactly, `local` what `Decision` says of them. `developable` counts the
    patches that are so, up to the rounding of their coordinates.
    """

    patch_index: NDArray[np.int64]
    normal_index: NDArray[np.int64]
    place: NDArray[np.int64]
    exact: NDArray[np.int64]
    local: NDArray[np.float64]
    developable: int

    @classmethod
    def none(cls, developable: int) -> Hits:
        """Return no hits."""
        empty = np.empty(0, dtype=np.int64)
        return cls(empty, empty, empty, empty, np.empty((0, 5)), developable)

    @classmethod
    def joined(cls, parts: Sequence[Hits], threads: int | None = 1) -> Hits:
        """Return the hits of consecutive ranges of patches."""
        if len(parts) == 1:
            return parts[0]
        starts = np.cumsum([0, *(len(part) for part in parts)])
        rows = np.empty((3, starts[-1]), dtype=np.int64)

        def copy(k: int, _: int) -> None:
            here = slice(starts[k], starts[k + 1])
            rows[0, here] = parts[k].patch_index
            rows[1, here] = parts[k].normal_index
            rows[2, here] = parts[k].place

        list(over_ranges(copy, len(parts), 1, threads))
        exact = [part.exact + start for part, start in zip(parts, starts[:-1], strict=True)]
        local = np.concatenate([part.local for part in parts])
        developable = sum(part.developable for part in parts)
        return cls(rows[0], rows[1], rows[2], np.concatenate(exact), local, developable)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.patch_index)

    def __getitem__(self, key: slice) -> Hits:
        """Return consecutive hits; the developable patches are counted with the first of all."""
        first, last, _ = key.indices(len(self))
        low, high = np.searchsorted(self.exact, (first, last))
        return Hits(
            self.patch_index[first:last],
            self.normal_index[first:last],
            self.place[first:last],
            self.exact[low:high] - first,
            self.local[low:high],
            self.developable if first == 0 else 0,
        )


@dataclass(frozen=True, eq=False)
class Pairs:
    """What a range of patches yields: pairs (3, …) of patch, normal and place of the normal.

    Some are sure; rounding leaves the others open, with the error `bounds` of their forms. `last`
    is the patch after the last one.
    """

    last: int
    sure: NDArray[np.int64]
    doubtful: NDArray[np.int64]
    bounds: NDArray[np.float64]
    developable: int

    @classmethod
    def joined(cls, parts: Sequence[Pairs]) -> Pairs:
        """Return the pairs of consecutive ranges."""
        if len(parts) == 1:
            return parts[0]
        return cls(
            parts[-1].last,
            np.concatenate([part.sure for part in parts], axis=1),
            np.concatenate([part.doubtful for part in parts], axis=1),
            np.concatenate([part.bounds for part in parts]),
            sum(part.developable for part in parts),
        )


@dataclass(frozen=True, eq=False)
class Search:
    """The search for the normals that the patches of a spline have, range by range."""

    spline: Spline
    bins: NormalBins

    @cached_property
    def border(self) -> NDArray[np.bool_]:
        """Which sides of the domain are open, in the order of a cell's triangles: s, e, n, w."""
        (west, east), (south, north) = self.spline.ends
        return np.array([end == "none" for end in (south, east, north, west)])

    @cached_property
    def noise(self) -> float:
        """The rounding of the scaled coordinates."""
        return kernels.DATA_ERROR * float(
            np.abs(self.spline.coefficients * self.spline.scale).max()
        )

    @cached_property
    def hopeless(self) -> bool:
        """Whether all patches are developable, up to the rounding of their coordinates."""
        return kernels.all_developable(self.spline.coefficients, self.spline.scale, self.noise)

    @cached_property
    def kernel(self) -> tuple[Callable[..., tuple[int, int]], tuple[Any, ...]]:
        """What searches patches, and what it is told of the normals."""
        bins = self.bins
        if bins.frequency > 0:
            return icosphere.scan_patches, (bins.normals, bins.frequency)
        return kernels.search_patches, (bins.frame, bins.stretch, bins.grid, *bins.sorted)

    def pairs(self, first: int, last: int) -> Pairs:
        """Return what the patches first, …, last − 1 yield."""
        patches_with, arguments = self.kernel
        parts, room = [], ROOM
        while first < last:
            found, doubtful = np.empty((2, 3, room), dtype=np.int64)
            bounds, counts = np.empty(room), np.zeros(3, dtype=np.int64)
            first, needed = patches_with(
                self.spline.coefficients, self.spline.scale, self.noise, self.border, *arguments,
                first, last, found, doubtful, bounds, counts,
            )  # fmt: skip
            sure, open_, developable = counts.tolist()
            parts.append(
                Pairs(
                    first,
                    found[:, :sure].copy(),
                    doubtful[:, :open_].copy(),
                    bounds[:open_].copy(),
                    developable,
                )
            )
            room = max(ROOM, needed)
        return Pairs.joined(parts)

    def range_size(self, threads: int | None) -> int:
        """Return how many patches one range has."""
        count = self.spline.patches // (RANGES_PER_THREAD * thread_count(threads))
        return min(max(count, FEWEST_PATCHES), MOST_PATCHES)

    def decided(
        self, doubtful: NDArray[np.int64], bounds: NDArray[np.float64], threads: int | None
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return those of the doubtful pairs that are samples, and what `Decision` says of them."""
        if doubtful.shape[1] == 0:
            return doubtful, np.empty((0, 5))
        forgiven = np.where(_on_border(self.spline, self.border, doubtful[0]), bounds, 0.0)
        normals = self.bins.normals[doubtful[1]]
        decision = decide(self.spline, doubtful[0], normals, doubtful[1], bounds, forgiven, threads)
        return doubtful[:, decision.which], decision.local


def find(
    spline: Spline, bins: NormalBins, threads: int | None = None, progress: bool = False
) -> Hits:
    """Return which patch of a spline has which of the normals."""
    search = Search(spline, bins)
    if search.hopeless:
        return Hits.none(spline.patches)
    size = search.range_size(threads)
    parts = [*over_ranges(search.pairs, spline.patches, size, threads, progress)]
    doubtful = np.concatenate([part.doubtful for part in parts], axis=1)
    bounds = np.concatenate([part.bounds for part in parts])
    return merged(parts, *search.decided(doubtful, bounds, threads), threads)


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
    filled = {x: new_field(x, count, dtype) for x in FLOAT_NAMES if x in fields}
    normals = bins.ordered
    indices = hits.patch_index, hits.place
    arrays = [filled.get(name) for name in FLOAT_NAMES]

    def work(first: int, last: int) -> None:
        kernels.fill_samples(
            spline.coefficients, spline.scale, normals, spline.frame, first, last,
            *indices, *arrays,
        )  # fmt: skip

    if filled:
        for _ in over_ranges(work, count, SAMPLES_AT_A_TIME, threads):
            pass
        kernels.fill_known(
            spline.coefficients, spline.scale, normals, spline.frame, hits.exact, hits.local,
            *indices, *arrays,
        )  # fmt: skip
    return filled | {x: getattr(hits, x) for x in INDEX_NAMES if x in fields}


def merged(
    parts: Sequence[Pairs],
    decided: NDArray[np.int64],
    local: NDArray[np.float64],
    threads: int | None,
) -> Hits:
    """Return the sure pairs of consecutive ranges and those that were decided, sorted, as hits."""
    ends = np.searchsorted(decided[0], [0, *(part.last for part in parts)])
    starts = np.cumsum([0, *(part.sure.shape[1] for part in parts)]) + ends
    pairs = np.empty((3, starts[-1]), dtype=np.int64)
    exact, decided = np.empty(len(local), dtype=np.int64), np.ascontiguousarray(decided)

    def work(first: int, last: int) -> None:
        for k in range(first, last):
            kernels.merge_pairs(
                parts[k].sure, decided, ends[k], ends[k + 1], starts[k], pairs, exact
            )

    list(over_ranges(work, len(parts), 1, threads))
    patch, normal, place = pairs
    return Hits(patch, normal, place, exact, local, sum(part.developable for part in parts))


def _on_border(
    spline: Spline, border: NDArray[np.bool_], patches: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Say which patches have their outer edge on the open border of the domain."""
    cell, turn = np.divmod(patches, 4)
    i, j = np.divmod(cell, spline.cells[1])
    outermost = np.stack([j == 0, i == spline.cells[0] - 1, j == spline.cells[1] - 1, i == 0])
    return border[turn] & np.take_along_axis(outermost, turn[None], axis=0)[0]
