"""Sampling by normals: every point of a spline that has one of the normals, exactly once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ..generated import sampler as kernels
from .exact import decide
from .fields import ARRAY_NAMES, FLOAT_NAMES, INDEX_NAMES, new_field
from .sphere import perpendicular
from .spline import Spline
from .threads import over_ranges, thread_count

__all__ = ["Hits", "NormalBins", "fill", "find"]

# A range of patches is searched by one thread. There are several for each, but for small surfaces.
FEWEST_PATCHES, MOST_PATCHES = 64, 4096
RANGES_PER_THREAD = 4
SAMPLES_AT_A_TIME = 1 << 16
NORMALS_PER_BIN = 4
# A cap of normals is not taken for narrower than this, the tangent of half its angle.
NARROWEST = 2.0**-20
# Room for so many hits at first; a patch that needs more gets it.
ROOM = 1 << 15


@dataclass(frozen=True, eq=False)
class NormalBins:
    """Unit normals (S, 3), sorted into the squares of a cube round the sphere.

    Normals that all lie in a cap are first mapped linearly, so that they fill a face of the cube.
    """

    normals: NDArray[np.float64]

    @cached_property
    def frame(self) -> NDArray[np.float64]:
        """The linear map (3, 3), the identity unless there is such a cap."""
        mean = self.normals.mean(axis=0)
        length = float(np.linalg.norm(mean))
        if length < 0.8:
            return np.eye(3)
        axis = mean / length
        across, along = perpendicular(axis)
        directions = np.stack([across, along, axis])
        x, y, z = directions @ self.normals.T
        if not (z > 0.5).all():
            return np.eye(3)
        tangent = max(float(np.hypot(x, y).max() / z.min()), NARROWEST)
        return directions / [[tangent], [tangent], [1.0]] if tangent < 0.8 else np.eye(3)

    @cached_property
    def stretch(self) -> float:
        """The norm of the frame."""
        return float(np.linalg.norm(self.frame, axis=1).max())

    @cached_property
    def grid(self) -> int:
        """The number of squares along an edge of the cube."""
        faces = 6 if self.stretch < 1.1 else 1
        return max(1, min(2048, round(math.sqrt(len(self.normals) / (faces * NORMALS_PER_BIN)))))

    @cached_property
    def sorted(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """The start of each bin; the numbers of the normals in their order; the normals (3, S)."""
        starts = np.empty(6 * self.grid**2 + 1, dtype=np.int64)
        order = np.empty(len(self.normals), dtype=np.int64)
        components = np.empty((3, len(self.normals)))
        kernels.bin_normals(self.normals, self.frame, self.grid, starts, order, components)
        return starts, order, components


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

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.patch_index)


@dataclass(frozen=True, eq=False)
class _Range:
    """What a range of patches yields: pairs (3, …) of patch, normal and place of the normal.

    Some are sure; rounding leaves the others open, with the error `bounds` of their forms.
    """

    sure: NDArray[np.int64]
    doubtful: NDArray[np.int64]
    bounds: NDArray[np.float64]
    developable: int


def find(
    spline: Spline, bins: NormalBins, threads: int | None = None, progress: bool = False
) -> Hits:
    """Return which patch of a spline has which of the normals."""
    border = np.array([end == "none" for end in _sides(spline)])
    noise = kernels.DATA_ERROR * float(np.abs(spline.coefficients * spline.scale).max())
    if kernels.all_developable(spline.coefficients, spline.scale, noise):
        return _hits(np.empty((3, 0), dtype=np.int64), spline.patches)

    def search(first: int, last: int) -> list[_Range]:
        parts, room = [], ROOM
        while first < last:
            found, doubtful = np.empty((2, 3, room), dtype=np.int64)
            bounds, counts = np.empty(room), np.zeros(3, dtype=np.int64)
            first, needed = kernels.search_patches(
                spline.coefficients, spline.scale, noise, border,
                bins.frame, bins.stretch, bins.grid, *bins.sorted,
                first, last, found, doubtful, bounds, counts,
            )  # fmt: skip
            sure, open_, developable = counts.tolist()
            parts.append(
                _Range(
                    found[:, :sure].copy(),
                    doubtful[:, :open_].copy(),
                    bounds[:open_].copy(),
                    developable,
                )
            )
            room = max(ROOM, needed)
        return parts

    count = spline.patches // (RANGES_PER_THREAD * thread_count(threads))
    size = min(max(count, FEWEST_PATCHES), MOST_PATCHES)
    ranges = [
        x for part in over_ranges(search, spline.patches, size, threads, progress) for x in part
    ]
    return _decided(spline, bins, border, ranges)


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
    normals = bins.sorted[2]
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


def _decided(
    spline: Spline, bins: NormalBins, border: NDArray[np.bool_], ranges: list[_Range]
) -> Hits:
    """Decide the doubtful pairs and merge those that are samples with the sure ones."""
    sure = np.concatenate([r.sure for r in ranges], axis=1)
    doubtful = np.concatenate([r.doubtful for r in ranges], axis=1)
    developable = sum(r.developable for r in ranges)
    if doubtful.shape[1] == 0:
        return _hits(sure, developable)
    bounds = np.concatenate([r.bounds for r in ranges])
    forgiven = np.where(_on_border(spline, border, doubtful[0]), bounds, 0.0)
    decision = decide(spline, doubtful[0], bins.normals[doubtful[1]], forgiven)
    patch, normal, place = doubtful[:, decision.which]
    places = _insertion_places(sure[0], sure[1], patch, normal)
    merged = np.insert(sure, places, (patch, normal, place), axis=1)
    return _hits(merged, developable, places + np.arange(len(places)), decision.local)


def _hits(
    pairs: NDArray[np.int64],
    developable: int,
    exact: NDArray[np.int64] | None = None,
    local: NDArray[np.float64] | None = None,
) -> Hits:
    patch, normal, place = pairs
    exact = np.empty(0, dtype=np.int64) if exact is None else exact
    return Hits(
        patch, normal, place, exact, np.empty((0, 5)) if local is None else local, developable
    )


def _insertion_places(
    patch: NDArray[np.int64],
    normal: NDArray[np.int64],
    new_patch: NDArray[np.int64],
    new_normal: NDArray[np.int64],
) -> NDArray[np.int64]:
    """Return where the new pairs, sorted like the old ones, have to be inserted among them."""
    low, high = np.searchsorted(patch, new_patch), np.searchsorted(patch, new_patch, side="right")
    pairs = zip(low, high, new_normal, strict=True)
    return np.array([a + np.searchsorted(normal[a:b], n) for a, b, n in pairs], dtype=np.int64)


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
