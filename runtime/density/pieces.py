"""Cutting the patches of a spline into triangles, in whose middles samples may be put."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...generated import cover as kernels
from ..errors import InputError
from ..threads import over_ranges
from .law import Wanted

__all__ = ["Array", "Indices", "Pieces", "cut_patches", "parts_of_patches"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

PIECES_AT_A_TIME = 1 << 13
PATCHES_AT_A_TIME = 1 << 11
# Patches are not cut into more triangles than have this part of the square of the reach as area:
# of long and narrow ones there would be too many.
NARROW = 0.5
# Places are numbered by 32 bits.
MOST = 2e9
# The four quarters of a triangle: where their middles are, in sides from its own, and which is
# turned over.
QUARTERS = np.array([[0.0, 0.0], [1 / 3, -1 / 6], [-1 / 6, 1 / 3], [-1 / 6, -1 / 6]])
TURNS = np.array([-0.5, 0.5, 0.5, 0.5])


@dataclass(frozen=True, eq=False)
class Pieces:
    """Triangles of patches: `triangles` (M, 3) has u, v of the middles, and the sizes.

    A size is the length of the sides in (u, v), negative if the triangle is turned over.
    """

    wanted: Wanted
    patches: Indices
    triangles: Array

    def __len__(self) -> int:
        return len(self.patches)

    def __getitem__(self, chosen: Indices | NDArray[np.bool_]) -> Pieces:
        """Return some of them."""
        return Pieces(self.wanted, self.patches[chosen], self.triangles[chosen])

    def __add__(self, other: Pieces) -> Pieces:
        """Return these and then the others, of the same spline."""
        return Pieces(
            self.wanted,
            np.concatenate([self.patches, other.patches]),
            np.concatenate([self.triangles, other.triangles]),
        )

    @property
    def extents(self) -> Array:
        """How far the points of each triangle (M,) are from its middle, at most."""
        return self.wanted.reaches[self.patches] * np.abs(self.triangles[:, 2])

    @property
    def areas(self) -> Array:
        """About the areas of the triangles (M,): their parts of those of the patches."""
        return self.wanted.areas[self.patches] * self.triangles[:, 2] ** 2

    @property
    def quarters(self) -> Pieces:
        """The quarters of all triangles (4 M), those of each together."""
        middles = self.triangles[:, None, :2] + self.triangles[:, None, 2:] * QUARTERS
        sizes = self.triangles[:, 2:] * TURNS
        return Pieces(
            self.wanted,
            np.repeat(self.patches, 4),
            np.concatenate([middles, sizes[:, :, None]], axis=2).reshape(-1, 3),
        )

    def middles(self) -> Array:
        """Return point, unit normal, weight and K (M, 8) in the middles.

        Points are relative to the first coefficient; all lengths are those of the spline times
        `wanted.unit`. The normal is zero where there is none.
        """
        rows, wanted, spline = np.empty((len(self), 8)), self.wanted, self.wanted.spline

        def work(first: int, last: int) -> None:
            kernels.middles(
                spline.coefficients, spline.scale, wanted.law.numbers, wanted.reaches,
                self.patches, self.triangles, first, last, rows,
            )  # fmt: skip

        for _ in over_ranges(work, len(self), PIECES_AT_A_TIME, wanted.threads):
            pass
        return rows

    def turns(self, rows: Array) -> Array:
        """Return how far normals of each triangle (M,) are from that in its middle, at most.

        That is as the chord between unit vectors: 2 if they may turn by 90 degrees or more. `rows`
        are what `middles` returns.
        """
        turns, spline = np.empty(len(self)), self.wanted.spline

        def work(first: int, last: int) -> None:
            kernels.turns(
                spline.coefficients, spline.scale, self.patches, self.triangles, first, last, rows,
                turns,
            )  # fmt: skip

        for _ in over_ranges(work, len(self), PIECES_AT_A_TIME, self.wanted.threads):
            pass
        return turns


def cut_patches(wanted: Wanted, radius: float) -> Pieces:
    """Cut all patches until every place is within radius / √weight of the middle of its triangle.

    That is by the largest weight of the patch, and long and narrow triangles may reach farther.
    Raises what `parts_of_patches` raises.
    """
    parts = parts_of_patches(wanted, radius)
    ends = np.cumsum(parts * parts)
    patches, triangles = np.empty(ends[-1], dtype=np.int64), np.empty((ends[-1], 3))

    def work(first: int, last: int) -> None:
        kernels.cut_patches(parts, ends, first, last, patches, triangles)

    for _ in over_ranges(work, len(parts), PATCHES_AT_A_TIME, wanted.threads):
        pass
    return Pieces(wanted, patches, triangles)


def parts_of_patches(wanted: Wanted, radius: float) -> Indices:
    """Return in how many parts `cut_patches` cuts the sides of each patch (patches,).

    Raises InputError if there were more than MOST triangles.
    """
    reaches = np.minimum(wanted.reaches, np.sqrt(wanted.areas / NARROW))
    with np.errstate(divide="ignore", over="ignore"):
        asked = np.maximum(np.ceil(reaches * np.sqrt(wanted.largest) / radius), 1.0)
        total = float((asked * asked).sum())
    if not total <= MOST:
        raise InputError(
            f"surface {wanted.spline.name!r} would have to be searched in more than {MOST:.0e} "
            "places; ask for a larger coverage or angle, or for fewer samples or normals."
        )
    return asked.astype(np.int64)
