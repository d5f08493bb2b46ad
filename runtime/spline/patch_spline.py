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

    def _normals_in_patches(self, patches: Indices, places: Array) -> tuple[Array, Flags]:
        """Return unnormalized normals (k, 3) of patches (k,) at parameters u, v (k, 2).

        At a singular point, which has no normal, the result is the normal of a nearby point towards
        the centre of the patch. The second array (k,) is True for singular points.
        """
        patch = self._patch(patches)

        def normals_at(at: Array) -> Array:
            return np.stack(python_function(formulas.tangents)(patch, *at.T)[2], axis=1)

        here, centre = normals_at(places), normals_at(np.full_like(places, 1.0 / 3.0))
        lengths = (np.linalg.norm(x, axis=1) for x in (here, centre))
        singular = np.less_equal(next(lengths), SINGULAR_POINT * next(lengths))
        beside = normals_at(places + SINGULAR_POINT * (1.0 / 3.0 - places))
        return np.where(singular[:, None], beside, here), singular

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
