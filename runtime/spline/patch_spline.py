"""What splines on a grid of cells and splines of nets have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..base.georeference import Georeference
from ..base.kept import Immutable
from ..base.scales import scale_to_one
from ..base.tolerances import DATA_ERROR

if TYPE_CHECKING:
    from ..domain.trim import Trim
    from .misfit import Misfit


class PatchSpline(Immutable, ABC):
    """Quadratic patches: a `Spline` on a grid of cells, or a `NetSpline`.

    Both also have `patches`, `control_nets`, `extent` and `measure`.
    """

    name: str
    misfit: Misfit | None = None
    trim: Trim | None = None
    apexes: int = 0
    georeference: Georeference | None = None

    @property
    @abstractmethod
    def _points(self) -> NDArray[np.float64]:
        """The control points, whose coordinates are in the last axis."""

    @abstractmethod
    def _largest_step(self) -> float:
        """Return the largest modulus of the differences of neighbouring control points."""

    @cached_property
    def scale(self) -> float:
        """A power of two that brings the differences of neighbouring control points to about 1."""
        return scale_to_one(self._largest_step())

    @cached_property
    def _largest(self) -> float:
        """The largest modulus of the coordinates of control points."""
        return float(np.abs(self._points).max())

    @property
    def noise(self) -> float:
        """A bound of the rounding errors of coordinates, times `scale`."""
        return DATA_ERROR * (self._largest * self.scale)
