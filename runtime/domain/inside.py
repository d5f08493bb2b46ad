"""The part of each patch of a spline that is inside its trim."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..base.errors import SurfaceError
from .domain import widened
from .kernels.trim import to_cells
from .trim import Trim

__all__ = ["FINEST", "Inside", "extremes_around", "subcentroids"]


# A patch is tested at the centroids of COARSE² triangles, if the cells at the boundary of the trim
# are unknown, and a patch at the boundary at those of FINEST² triangles.
COARSE, FINEST = 4, 8
POINTS_AT_A_TIME = 1 << 20


@dataclass(frozen=True, eq=False)
class Inside:
    """The shares (patches,), from 0 to 1, of each patch inside a trim, by area in the parameters.

    `reached` (patches,) is True for patches that may have a part inside, however small.
    """

    shares: Array
    reached: Flags

    @classmethod
    def of(cls, trim: Trim, frame: Array, cells: tuple[int, int], name: str) -> Inside:
        """Measure the patches of a spline; SurfaceError if its trim leaves nothing."""
        passed, all_known = trim.cells_of_border(trim.domain, cells)
        number = np.arange(4 * cells[0] * cells[1])

        def shares_of(patches: Indices, parts: int) -> Array:
            return _shares(trim, frame, cells[1], patches, parts)

        shares = shares_of(number, 1 if all_known else COARSE)
        if not all_known:
            least, most = extremes_around(shares.reshape(*cells, 4))
            passed |= (least < 1.0) & (most > 0.0)
        cut = np.repeat(passed.ravel(), 4)
        shares[cut] = shares_of(number[cut], FINEST)
        if not shares.any():
            raise SurfaceError(
                f"the trim of surface {name!r}, or the reach, leaves nothing of it, or "
                "less than a part of a cell of its spline; is it inside the domain?"
            )
        return cls(shares, cut | (shares > 0.0))


def subcentroids(parts: int) -> Array:
    """Return the centroids (parts², 2) of the equal parts of the triangle (0, 0), (1, 0), (0, 1).

    No centroid lies on a line through points whose coordinates are binary fractions.
    """
    i, j = (x.ravel() for x in np.indices((parts, parts)))
    upright, inverted = i + j < parts, i + j < parts - 1
    places = [np.stack([i, j], axis=1)[upright] + 1 / 3, np.stack([i, j], axis=1)[inverted] + 2 / 3]
    return np.concatenate(places) / parts


def _shares(trim: Trim, frame: Array, columns: int, patches: Indices, parts: int) -> Array:
    """Return the shares of patches (k,) inside a trim, by the centroids of their parts."""
    places, shares = subcentroids(parts), np.empty(len(patches))
    step = max(POINTS_AT_A_TIME // len(places), 1)
    for first in range(0, len(patches), step):
        some = np.repeat(patches[first : first + step], len(places))
        uv, count = np.empty((len(some), 2)), len(some) // len(places)
        to_cells(some, np.tile(places, (count, 1)), columns, 0, len(some), uv)
        inside = trim.contains(uv * frame[2:] + frame[:2])
        shares[first : first + step] = inside.reshape(count, -1).mean(axis=1)
    return shares


def extremes_around(values: Array) -> tuple[Array, Array]:
    """Return minima and maxima (m, n) of the values (m, n, 4) of each cell and its neighbours."""
    return -widened(-values.min(axis=2)), widened(values.max(axis=2))
