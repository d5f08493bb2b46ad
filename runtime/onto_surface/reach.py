"""The reach, a part of a surface that is given by its normals, as a trim."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..directions.regions import Cap, Reach
from ..domain.domain import Domain
from ..domain.trim import trimmed
from ..spline.spline import Spline
from ..surface.derivatives import normals_of_jets
from ..surface.surface import Surface

__all__ = ["in_reach", "reached"]

Whole = TypeVar("Whole", Spline, Surface)


@dataclass(frozen=True, eq=False)
class InReach:
    """The condition that the normal is in a cap.

    `normals` returns unit normals (k, 3) at parameters (k, 2), 0 or NaN at singular points.
    """

    normals: Callable[[Array], Array]
    cap: Cap

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether the normals at points (k, 2) are in the cap."""
        return self.cap.contains(self.normals(uv))

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags:
        """Return the cells (m, n) whose normals may enter the cap, or leave it.

        The cosine of the angle is evaluated at the corners and the centre of each cell. Its range
        in the cell is assumed to exceed that of these values by at most their spread on each side.
        """
        nodes, middles = (self._cosines(domain, cells, shift) for shift in (0.0, 0.5))
        nodes = [nodes[i : i + cells[0], j : j + cells[1]] for i in (0, 1) for j in (0, 1)]
        known = np.stack([*nodes, middles[: cells[0], : cells[1]]])
        low, high = known.min(axis=0), known.max(axis=0)
        limit = math.cos(math.radians(self.cap.angle))
        # Comparisons with NaN are false: cells with a point without a normal are included.
        return ~((2.0 * low - high > limit) | (2.0 * high - low < limit))

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Return 1 for boxes (k, 4) whose normals (k, 3) are in the cap, −1 for others."""
        return np.where(self.cap.contains(normals), 1, -1).astype(np.int8)

    def _cosines(self, domain: Domain, cells: tuple[int, int], shift: float) -> Array:
        """Return cosines (m + 1, n + 1), or (m, n) with a shift; NaN at points without a normal."""
        u, v = (
            low + (high - low) * ((np.arange(count + (shift == 0.0)) + shift) / count)
            for (low, high), count in zip(domain, cells, strict=True)
        )
        places = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1)
        normals = self.normals(places.reshape(-1, 2))
        normals[~normals.any(axis=1)] = np.nan
        return (normals @ self.cap.axis).reshape(len(u), len(v))


def reached(whole: Whole, normals: Callable[[Array], Array], reach: Reach) -> Whole:
    """Return the part of a spline or a surface whose `normals` are in a reach."""
    conditions = [InReach(normals, cap) for cap in reach._caps]
    return replace(whole, trim=trimmed(whole.trim, whole.domain, whole.boundary, *conditions))


def in_reach(surface: Surface | None, reach: Reach | None) -> Surface | None:
    """Return a surface of several pieces, trimmed to the points with normals in a reach."""
    if surface is None or reach is None:
        return surface

    def normals(uv: Array) -> Array:
        return normals_of_jets(surface.jets(*uv.T.copy()))

    return reached(surface, normals, reach)
