"""What splines on a grid of cells and splines of nets have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...generated import patch as formulas
from ...generated.vectors import Patch
from ..base.aliases import Array, Flags, Indices
from ..base.formula_calls import python_function
from ..base.georeference import Georeference
from ..base.kept import Immutable
from ..base.scales import scale_to_one
from ..base.tolerances import DATA_ERROR, SINGULAR_POINT

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

    @abstractmethod
    def _patch(self, rows: Indices | slice = slice(None)) -> Patch:
        """Return the vectors of the patches `rows` times `scale`, for formulas."""

    @abstractmethod
    def _origins(self, rows: Indices) -> Array:
        """Return the points (k, 3) to which the vectors p₀ of the patches `rows` are relative."""

    def _points_in_patches(self, patches: Indices, places: Array) -> Array:
        """Return the points (k, 3) of patches (k,) at parameters u, v (k, 2)."""
        x = python_function(formulas.envelope)(self._patch(patches), *places.T)
        return np.stack(x, axis=1) / self.scale + self._origins(patches)

    @abstractmethod
    def _cross_products(self, patches: Indices, places: Array) -> Array:
        """Return p_u × p_v (k, 3) of patches (k,) at parameters u, v (k, 2)."""

    def _regular_places(self, patches: Indices, places: Array) -> tuple[Flags, Array, Array]:
        """Return a mask of singular points, parameters that are regular, and p_u × p_v there.

        Point i has the parameters places[i] in the patch patches[i]. It is singular if |p_u × p_v|
        is negligible relative to its value at the centre of the patch. The second array (k, 2) has
        the parameters of all points, those of singular points moved slightly towards the centre.
        The third array (k, 3) is p_u × p_v at these parameters.
        """
        centre = np.full_like(places, 1.0 / 3.0)
        here, there = (self._cross_products(patches, x) for x in (places, centre))
        singular = np.less_equal(
            np.linalg.norm(here, axis=1), SINGULAR_POINT * np.linalg.norm(there, axis=1)
        )
        moved = places + SINGULAR_POINT * (centre - places)
        places = np.where(singular[:, None], moved, places)
        return singular, places, self._cross_products(patches, places)

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
