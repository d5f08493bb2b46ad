"""Triangles of the patches of a spline, as places need to know them; densities make them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..kernels.sizing import TargetDensity

__all__ = ["Triangles"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Sizing(Protocol):
    """What has a target density."""

    @property
    def target(self) -> TargetDensity: ...


class Triangles(Protocol):
    """Triangles with a place each, as in `density/triangles.py`."""

    @property
    def sizing(self) -> Sizing:
        """What has their target density."""
        ...

    @property
    def patches(self) -> Indices:
        """The patches (M,)."""
        ...

    @property
    def corners(self) -> Array:
        """Parameters (M, 3, 2) of the corners."""
        ...

    @property
    def uv(self) -> Array:
        """The parameters (M, 2) of the places in their patches."""
        ...

    def __len__(self) -> int: ...

    def __getitem__(self, chosen: Indices | NDArray[np.bool_] | slice, /) -> Triangles: ...

    def at_places(self) -> Array:
        """Return the rows (M, 8) of candidates."""
        ...

    def on_spline(self) -> Array:
        """Return the rows (M, 8) of candidates on the spline."""
        ...

    def normal_chords(self, rows: Array, /) -> Array:
        """Return how far normals of triangles (M,) are from those of their rows, at most."""
        ...
