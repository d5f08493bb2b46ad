"""Sampling by normals: every point of a spline that has one of the normals, exactly once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..generated import sampler as kernels
from .exact import decide
from .spline import Spline
from .threads import over_ranges

__all__ = ["Hits", "NormalBins", "fill", "find"]

PATCHES_AT_A_TIME = 4096
SAMPLES_AT_A_TIME = 1 << 16
NORMALS_PER_BIN = 8


@dataclass(frozen=True, eq=False)
class NormalBins:
    """Unit normals (S, 3), sorted into the squares of a cube round the sphere."""

    normals: NDArray[np.float64]

    @cached_property
    def grid(self) -> int:
        """The number of squares along an edge of the cube."""
        return max(1, min(2048, round(math.sqrt(len(self.normals) / (6 * NORMALS_PER_BIN)))))

    @cached_property
    def sorted(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """The start of each bin; the numbers of the normals in their order; the normals in it."""
        starts = np.empty(6 * self.grid**2 + 1, dtype=np.int64)
        order = np.empty(len(self.normals), dtype=np.int64)
        kernels.bin_normals(self.normals, self.grid, starts, order)
        return starts, order, self.normals[order]


@dataclass(frozen=True, eq=False)
class Hits:
    """Which patch has which normal, by patch and then by normal.

    `exact` are the numbers of the hits that had to be decided exactly, `local` what `Decision` says
    of them. `invisible` counts the patches that are flat or developable up to the
    rounding of their coordinates.
    """

    patch_index: NDArray[np.int64]
    normal_index: NDArray[np.int64]
    exact: NDArray[np.int64]
    local: NDArray[np.float64]
    invisible: int

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.patch_index)


@dataclass(frozen=True, eq=False)
class _Range:
    """What a range of patches yields: sure pairs, doubtful pairs, what is forgiven for these."""

    sure: tuple[NDArray[np.int64], NDArray[np.int64]]
    doubtful: tuple[NDArray[np.int64], NDArray[np.int64]]
    forgiven: NDArray[np.float64]
    invisible: int


def find(
    spline: Spline, bins: NormalBins, threads: int | None = None, progress: bool = False
) -> Hits:
    """Return which patch of a spline has which of the normals."""
    starts, order, normals = bins.sorted
    border = np.array([end == "none" for end in _sides(spline)])
    noise = kernels.DATA_ERROR * float(np.abs(spline.coefficients * spline.scale).max())

    def search(first: int, last: int) -> _Range:
        count = last - first
        kinds, sizes = np.empty(count, dtype=np.int8), np.empty(count, dtype=np.int64)
        bounds, windows = np.empty(count), np.empty((count, 6, 4), dtype=np.int32)
        kernels.bound_patches(
            spline.coefficients, spline.scale, noise, border, bins.grid, starts, first, last,
            kinds, bounds, windows, sizes,
        )  # fmt: skip
        offsets = np.concatenate([[0], np.cumsum(sizes)])
        found, doubtful = (np.empty(offsets[-1], dtype=np.int64) for _ in range(2))
        found_counts, doubtful_counts = (np.empty(count, dtype=np.int64) for _ in range(2))
        kernels.select_normals(
            spline.coefficients, spline.scale, bins.grid, starts, order, normals, first, last,
            kinds, bounds, windows, offsets, found, found_counts, doubtful, doubtful_counts,
        )  # fmt: skip
        patches = np.arange(first, last)
        open_ = np.repeat(patches, doubtful_counts)
        forgiven = np.where(_on_border(spline, border, open_), bounds[open_ - first], 0.0)
        return _Range(
            (np.repeat(patches, found_counts), _packed(found, offsets, found_counts)),
            (open_, _packed(doubtful, offsets, doubtful_counts)),
            forgiven,
            int(np.count_nonzero(kinds == kernels.INVISIBLE)),
        )

    ranges = list(over_ranges(search, spline.patches, PATCHES_AT_A_TIME, threads, progress))
    return _decided(spline, bins, ranges)


def fill(
    spline: Spline, normals: NDArray[np.float64], hits: Hits, threads: int | None = None
) -> dict[str, NDArray[np.float64]]:
    """Return points, normals, uv, support and curvatures of the hits."""
    count = len(hits)
    fields = {
        "points": np.empty((count, 3)),
        "normals": np.empty((count, 3)),
        "uv": np.empty((count, 2)),
        "support": np.empty(count),
        "gaussian_curvature": np.empty(count),
        "mean_curvature": np.empty(count),
    }
    indices = hits.patch_index, hits.normal_index

    def work(first: int, last: int) -> None:
        kernels.fill_samples(
            spline.coefficients, spline.scale, normals, spline.frame, first, last,
            *indices, *fields.values(),
        )  # fmt: skip

    for _ in over_ranges(work, count, SAMPLES_AT_A_TIME, threads):
        pass
    kernels.fill_known(
        spline.coefficients, spline.scale, normals, spline.frame, hits.exact, hits.local,
        *indices, *fields.values(),
    )  # fmt: skip
    return fields


def _decided(spline: Spline, bins: NormalBins, ranges: list[_Range]) -> Hits:
    """Decide the doubtful pairs and merge those that are samples with the sure ones."""
    patch, normal = (np.concatenate([r.sure[k] for r in ranges]) for k in (0, 1))
    open_patch, open_normal = (np.concatenate([r.doubtful[k] for r in ranges]) for k in (0, 1))
    invisible = sum(r.invisible for r in ranges)
    nothing = np.empty(0, dtype=np.int64)
    if len(open_patch) == 0:
        return Hits(patch, normal, nothing, np.empty((0, 5)), invisible)
    forgiven = np.concatenate([r.forgiven for r in ranges])
    decision = decide(spline, open_patch, bins.normals[open_normal], forgiven)
    new_patch, new_normal = open_patch[decision.which], open_normal[decision.which]
    places = _insertion_places(patch, normal, new_patch, new_normal, len(bins.normals))
    return Hits(
        np.insert(patch, places, new_patch),
        np.insert(normal, places, new_normal),
        places + np.arange(len(places)),
        decision.local,
        invisible,
    )


def _insertion_places(
    patch: NDArray[np.int64],
    normal: NDArray[np.int64],
    new_patch: NDArray[np.int64],
    new_normal: NDArray[np.int64],
    count: int,
) -> NDArray[np.int64]:
    """Return where the new pairs, sorted like the old ones, have to be inserted among them."""
    low, high = np.searchsorted(patch, new_patch), np.searchsorted(patch, new_patch, side="right")
    pairs = zip(low, high, new_normal, strict=True)
    return np.array([a + np.searchsorted(normal[a:b], n) for a, b, n in pairs], dtype=np.int64)


def _packed(
    values: NDArray[np.int64], offsets: NDArray[np.int64], counts: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the first counts[k] values of each stretch offsets[k] … offsets[k + 1], joined."""
    total = int(counts.sum())
    shifts = np.repeat(offsets[:-1] - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    return values[np.arange(total) + shifts]


def _sides(spline: Spline) -> tuple[str, str, str, str]:
    """Return the ends of the domain in the order of the triangles of a cell: s, e, n, w."""
    (west, east), (south, north) = spline.ends
    return south, east, north, west


def _on_border(
    spline: Spline, border: NDArray[np.bool_], patches: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Say which patches have their outer edge on the open border of the domain."""
    cell, turn = np.divmod(patches, 4)
    i, j = np.divmod(cell, spline.cells[1])
    outermost = np.stack([j == 0, i == spline.cells[0] - 1, j == spline.cells[1] - 1, i == 0])
    return border[turn] & np.take_along_axis(outermost, turn[None], axis=0)[0]
