"""The boundary of a trim on a raster of the parameters, to find the boxes that it may intersect."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.domain.domain import Domain
from ...runtime.domain.trim import Trim


@dataclass(frozen=True, eq=False)
class Border:
    """The boundary of a trim on a raster of n × n pixels over the domain."""

    trim: Trim
    domain: Domain
    n: int

    def passes(self, boxes: Array) -> Flags:
        """Return whether the boundary may intersect each box (M, 4), given as u0, v0, u1, v1."""
        i, j, k, m = self._pixels(boxes)
        sums = self._sums
        return sums[k + 1, m + 1] - sums[i, m + 1] - sums[k + 1, j] + sums[i, j] > 0

    def near(self, boxes: Array, places: Array) -> Flags:
        """Return whether parameters (k, 2) are in a pixel that one of the boxes (M, 4) meets."""
        marks = np.zeros((self.n + 1, self.n + 1), dtype=np.int64)
        i, j, k, m = self._pixels(boxes)
        np.add.at(marks, (i, j), 1)
        np.add.at(marks, (k + 1, m + 1), 1)
        np.add.at(marks, (i, m + 1), -1)
        np.add.at(marks, (k + 1, j), -1)
        covered = marks.cumsum(axis=0).cumsum(axis=1) > 0
        i, j = self._pixels(places)
        return covered[i, j]

    def _pixels(self, places: Array) -> Indices:
        """Return the indices of pixels (2, k) that contain points (k, 2).

        For boxes (k, 4), return the indices (4, k) of the pixels of their two corners.
        """
        low, rates = self._frame
        found = np.floor((places.reshape(-1, 2) - low) * rates).astype(np.int64)
        return found.clip(0, self.n - 1).reshape(places.shape).T

    @cached_property
    def _frame(self) -> tuple[Array, Array]:
        """The smallest u and v of the domain (2,), and the pixels per unit of u and of v (2,)."""
        low, high = np.array(self.domain).T
        return low, self.n / (high - low)

    @cached_property
    def _sums(self) -> NDArray[np.signedinteger]:
        """(n + 1, n + 1): the number of boundary pixels below and left of each corner of a pixel.

        Pixels where the trim does not know its boundary count as boundary pixels.
        """
        passed, unknown = self.trim.cells_of_border(self.domain, (self.n, self.n))
        dtype = np.int16 if self.n**2 <= np.iinfo(np.int16).max else np.int32
        sums = np.zeros((self.n + 1, self.n + 1), dtype=dtype)
        np.cumsum(passed | unknown, axis=0, out=sums[1:, 1:])
        np.cumsum(sums[1:, 1:], axis=1, out=sums[1:, 1:])
        return sums
