"""Which part of each patch of a spline is inside its trim."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..base.errors import SurfaceError
from ..base.threads import over_ranges
from ..domain.domain import Domain
from ..domain.trim import Trim
from ..kernels.trim import to_cells
from .developable import widened

__all__ = [
    "FINEST",
    "Inside",
    "count_of",
    "parameters_of",
    "samples_inside",
    "subcentroids",
    "with_uv",
]

Array = NDArray[np.float64]

# A patch is tested at the centroids of this number of triangles squared: COARSE for all, where it
# is not known which cells the border of the trim passes, and FINEST for those it may pass.
COARSE, FINEST = 4, 8
POINTS_AT_A_TIME, PLACES_AT_A_TIME = 1 << 20, 1 << 16


class Trimmed(Protocol):
    """A spline with a trim, as far as it is needed here."""

    @property
    def name(self) -> str: ...
    @property
    def domain(self) -> Domain: ...
    @property
    def trim(self) -> Trim | None: ...
    @property
    def cells(self) -> tuple[int, int]: ...
    @property
    def patches(self) -> int: ...
    @property
    def frame(self) -> Array: ...


@dataclass(frozen=True, eq=False)
class Inside:
    """The shares (patches,) of the patches inside a trim, from 0 to 1, by their parameters.

    `reached` (patches,) says which patches may have a part inside, however small.
    """

    shares: Array
    reached: NDArray[np.bool_]

    @classmethod
    def of(cls, spline: Trimmed) -> Inside:
        """Measure the patches of a spline; SurfaceError if its trim leaves nothing."""
        assert spline.trim is not None
        passed, all_known = spline.trim.cells_of_border(spline.domain, spline.cells)
        number = np.arange(spline.patches)
        shares = _shares(spline, number, 1 if all_known else COARSE)
        if not all_known:
            by_cell = shares.reshape(*spline.cells, 4)
            least, most = -widened(-by_cell.min(axis=2)), widened(by_cell.max(axis=2))
            passed |= (least < 1.0) & (most > 0.0)
        cut = np.repeat(passed.ravel(), 4)
        shares[cut] = _shares(spline, number[cut], FINEST)
        if not shares.any():
            raise SurfaceError(
                f"the trim of surface {spline.name!r} leaves nothing of it, or less than a part of "
                "a cell of its spline; is it inside the domain?"
            )
        return cls(shares, cut | (shares > 0.0))


def with_uv(spline: Trimmed, fields: Sequence[str]) -> tuple[str, ...]:
    """Return fields of samples, and uv too if the spline has a trim, which needs it."""
    return (*fields, "uv") if spline.trim is not None and "uv" not in fields else tuple(fields)


def samples_inside(
    spline: Trimmed, arrays: dict[str, NDArray[Any]], fields: Sequence[str]
) -> dict[str, NDArray[Any]]:
    """Return fields of the samples that are inside the trim of a spline; `arrays` have uv, too."""
    if spline.trim is None:
        return arrays
    inside = spline.trim.contains(arrays["uv"].astype(np.float64))
    return {name: x[inside] for name, x in arrays.items() if name in fields}


def count_of(arrays: dict[str, NDArray[Any]]) -> int:
    """Return the number of samples that have these fields."""
    return len(next(iter(arrays.values())))


def parameters_of(spline: Trimmed, patches: NDArray[np.int64], places: Array) -> Array:
    """Return the parameters (k, 2) of the surface at parameters (k, 2) of patches (k,)."""
    uv, places = np.empty((len(patches), 2)), np.ascontiguousarray(places)

    def work(first: int, last: int) -> None:
        to_cells(patches, places, spline.cells[1], first, last, uv)

    list(over_ranges(work, len(patches), PLACES_AT_A_TIME, None))
    uv *= spline.frame[2:]
    uv += spline.frame[:2]
    return uv


def subcentroids(parts: int) -> Array:
    """Return the centroids (parts², 2) of the equal parts of the triangle (0, 0), (1, 0), (0, 1).

    They lie on no line through points with binary fractions as coordinates.
    """
    i, j = (x.ravel() for x in np.indices((parts, parts)))
    upright, inverted = i + j < parts, i + j < parts - 1
    places = [np.stack([i, j], axis=1)[upright] + 1 / 3, np.stack([i, j], axis=1)[inverted] + 2 / 3]
    return np.concatenate(places) / parts


def _shares(spline: Trimmed, patches: NDArray[np.int64], parts: int) -> Array:
    """Return the shares of patches (k,) by the centroids of their parts."""
    assert spline.trim is not None
    places, shares = subcentroids(parts), np.empty(len(patches))
    step = max(POINTS_AT_A_TIME // len(places), 1)
    for first in range(0, len(patches), step):
        some = np.repeat(patches[first : first + step], len(places))
        uv = parameters_of(spline, some, np.tile(places, (len(some) // len(places), 1)))
        inside = spline.trim.contains(uv)
        shares[first : first + step] = inside.reshape(-1, len(places)).mean(axis=1)
    return shares
