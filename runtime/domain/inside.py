"""The share of each patch of a spline that is inside the trim of its surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..base.errors import SurfaceError
from .domain import widened
from .kernels.trim import to_cells
from .trim import Trim

# The share of a patch that is inside is estimated by the centroids of equal triangles: FINEST²
# triangles if the boundary of the trim may pass through the cell of the patch, COARSE² if this is
# unknown, and otherwise one.
COARSE, FINEST = 4, 8
POINTS_AT_A_TIME = 1 << 20


@dataclass(frozen=True, eq=False)
class Inside:
    """The share of each patch of a spline that is inside a trim, by area in the parameters.

    `shares` (patches,) are from 0 to 1. `reached` (patches,) is True for each patch that may have
    a part inside, however small.
    """

    shares: Array
    reached: Flags

    @classmethod
    def of(cls, trim: Trim, frame: Array, cells: tuple[int, int], name: str) -> Inside:
        """Measure the patches of a spline; SurfaceError if all of them are outside the trim.

        `frame` is the lower corner u₀, v₀ of the domain, and the size of a cell along u and v.
        """
        passed, unknown = trim.cells_of_border(trim.domain, cells)
        number = np.arange(4 * cells[0] * cells[1])

        def shares_of(patches: Indices, parts: int) -> Array:
            return _shares(trim, frame, cells[1], patches, parts)

        unsure, shares = np.repeat(unknown.ravel(), 4), shares_of(number, 1)
        if unsure.any():
            shares[unsure] = shares_of(number[unsure], COARSE)
            least, most = extremes_around(shares.reshape(*cells, 4))
            passed |= (least < 1.0) & (most > 0.0)
        cut = np.repeat(passed.ravel(), 4)
        shares[cut] = shares_of(number[cut], FINEST)
        if not shares.any():
            reach = next(filter(None, (getattr(part, "said", None) for part in trim.parts)), None)
            raise SurfaceError(
                f"the trim of surface {name!r} leaves nothing of it, or less than a part of a cell "
                "of its spline; is it inside the domain?"
                if reach is None
                else f"surface {name!r} has no point in reach, or only within a part of a cell of "
                f"its spline: {reach}."
            )
        return cls(shares, cut | (shares > 0.0))


def subcentroids(parts: int) -> Array:
    """Return the centroids (parts², 2) of equal parts of the triangle (0, 0), (1, 0), (0, 1)."""
    i, j = (x.ravel() for x in np.indices((parts, parts)))
    upright, inverted = i + j < parts, i + j < parts - 1
    places = [np.stack([i, j], axis=1)[upright] + 1 / 3, np.stack([i, j], axis=1)[inverted] + 2 / 3]
    return np.concatenate(places) / parts


def _shares(trim: Trim, frame: Array, columns: int, patches: Indices, parts: int) -> Array:
    """Return the share (k,) of each of the `patches` (k,) that is inside a trim.

    A share is the fraction of the parts² centroids of a patch that are inside.
    """
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
    """Return the least and the largest value (m, n) around each cell, from values (m, n, 4).

    Both are taken over the four patches of the cell and of each of its neighbours.
    """
    return -widened(-values.min(axis=2)), widened(values.max(axis=2))
