"""Cutting the patches of a spline into triangles, in whose middles samples may be put."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..kernels import triangles as kernels
from ..threads import over_ranges
from .law import Wanted

__all__ = ["Array", "Indices", "Pieces", "cut_patches", "parts_of_patches", "refuse_more"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

PIECES_AT_A_TIME = 1 << 13
PATCHES_AT_A_TIME = 1 << 11
# Patches are not cut into more triangles than have this part of the square of the reach as area:
# of long and narrow ones there would be too many. Where all of a patch has less than the smaller
# part of the square of its own reach, triangles are cut across instead of into similar ones.
NARROW, ACROSS = 0.5, 0.1
# Places are numbered by 32 bits.
MOST = 2e9


@dataclass(frozen=True, eq=False)
class Pieces:
    """Triangles of patches: `corners` (M, 3, 2) are their corners in u, v of the patch."""

    wanted: Wanted
    patches: Indices
    corners: Array

    def __len__(self) -> int:
        return len(self.patches)

    def __getitem__(self, chosen: Indices | NDArray[np.bool_]) -> Pieces:
        """Return some of them."""
        return Pieces(self.wanted, self.patches[chosen], self.corners[chosen])

    def __add__(self, other: Pieces) -> Pieces:
        """Return these and then the others, of the same spline."""
        return Pieces(
            self.wanted,
            np.concatenate([self.patches, other.patches]),
            np.concatenate([self.corners, other.corners]),
        )

    @property
    def uv(self) -> Array:
        """The parameters (M, 2) of the middles."""
        return self.corners.sum(axis=1) / 3.0

    @property
    def extents(self) -> Array:
        """How far the points of each triangle (M,) are from its middle, at most."""
        return self._for_each(kernels.radii, np.empty(len(self)))

    @property
    def quarters(self) -> Pieces:
        """The quarters of all triangles (4 M), those of each together, similar to it in u, v."""
        sides = (self.corners + np.roll(self.corners, 1, axis=1)) / 2.0
        places = np.concatenate([self.corners, sides], axis=1)
        corners = places[:, [[0, 4, 3], [4, 1, 5], [3, 5, 2], [5, 3, 4]]].reshape(-1, 3, 2)
        return Pieces(self.wanted, np.repeat(self.patches, 4), corners)

    @property
    def halves(self) -> Pieces:
        """The halves of all triangles (2 M), cut across their longest sides."""
        corners = self._for_each(kernels.bisect, np.empty((2 * len(self), 3, 2)))
        return Pieces(self.wanted, np.repeat(self.patches, 2), corners)

    def middles(self) -> Array:
        """Return point, unit normal, weight and K (M, 8) in the middles.

        Points are relative to the first coefficient; all lengths are those of the spline times
        `wanted.unit`. The normal is zero where there is none.
        """
        law = self.wanted.law, self.wanted.reaches
        return self._for_each(kernels.evaluate_centroids, *law, np.empty((len(self), 8)))

    def turns(self, rows: Array) -> Array:
        """Return how far normals of each triangle (M,) are from that in its middle, at most.

        That is as the chord between unit vectors: 2 if they may turn by 90 degrees or more. `rows`
        are what `middles` returns.
        """
        return self._for_each(kernels.normal_chords, rows, np.empty(len(self)))

    def _for_each(self, kernel: Callable[..., None], *arguments: object) -> Array:
        """Return the last of the arguments of a kernel, an array that it writes."""
        spline = self.wanted.spline

        def work(first: int, last: int) -> None:
            kernel(
                spline.coefficients,
                spline.scale,
                self.patches,
                self.corners,
                first,
                last,
                *arguments,
            )

        for _ in over_ranges(work, len(self), PIECES_AT_A_TIME, self.wanted.threads):
            pass
        return cast(Array, arguments[-1])


def cut_patches(wanted: Wanted, radius: float) -> Pieces:
    """Cut all patches until every place is within radius / √weight of the middle of its triangle.

    That is by the largest weight of the patch, and triangles of long and narrow ones may reach
    farther. Raises InputError if there were more than MOST triangles.
    """
    parts, across = parts_of_patches(wanted, radius)
    ends = np.cumsum(parts * parts)
    patches, corners = np.empty(ends[-1], dtype=np.int64), np.empty((ends[-1], 3, 2))

    def work(first: int, last: int) -> None:
        kernels.cut_patches(parts, ends, first, last, patches, corners)

    for _ in over_ranges(work, len(parts), PATCHES_AT_A_TIME, wanted.threads):
        pass
    pieces = Pieces(wanted, patches, corners)
    return _cut_across(pieces, across, radius) if across.any() else pieces


def _cut_across(pieces: Pieces, across: NDArray[np.bool_], radius: float) -> Pieces:
    """Cut pieces of some patches until they are short enough, or small enough."""
    wanted, left = pieces.wanted, across[pieces.patches]
    rates, share = np.sqrt(wanted.largest) / radius, 1.0
    large = wanted.areas * rates * rates
    done, pieces = pieces[~left], pieces[left]
    while len(pieces):
        here = pieces.patches
        left = (pieces.extents * rates[here] > 1.0) & (share * large[here] > NARROW)
        done, pieces, share = done + pieces[~left], pieces[left].halves, share / 2.0
    return done


def parts_of_patches(wanted: Wanted, radius: float) -> tuple[Indices, NDArray[np.bool_]]:
    """Return in how many parts `cut_patches` cuts the sides of each patch (patches,).

    And which patches are cut across instead. Raises InputError if there were more than MOST.
    """
    with np.errstate(divide="ignore", over="ignore"):
        rates = np.sqrt(wanted.largest) / radius
        small = np.sqrt(wanted.areas / NARROW) * rates
        asked = np.maximum(np.ceil(np.minimum(wanted.reaches * rates, small)), 1.0)
        total = float((asked * asked).sum())
    refuse_more(wanted, total, MOST)
    across = wanted.areas < ACROSS * wanted.reaches**2
    return np.where(across, 1, asked.astype(np.int64)), across


def refuse_more(wanted: Wanted, number: float, most: float) -> None:
    """Raise InputError if the number of places to be searched is larger than what is possible."""
    if not number <= most:
        raise InputError(
            f"surface {wanted.spline.name!r} would have to be searched in more than {most:.0e} "
            "places; ask for a larger coverage or angle, or for fewer samples or normals."
        )
