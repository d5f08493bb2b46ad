"""A reach as a trim: the part of a surface whose normals and points satisfy given conditions."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..directions.regions import Cap, Condition, Reach
from ..domain.domain import Domain, places_in_cells
from ..domain.trim import trimmed
from ..spline.spline import Spline
from ..surface.derivatives import normals_of_jets
from ..surface.surface import Surface

Whole = TypeVar("Whole", Spline, Surface)
Evaluated = Callable[[Array, Array], Array]

# The boundary of a condition is searched in a cell if it may come close to the centre of the cell:
# closer than AROUND times the distance between the centre and the farthest corner.
AROUND = 1.25


@dataclass(frozen=True, eq=False)
class InReach:
    """The condition that the normal is in a cap.

    `normals` returns the unit normals (k, 3) at parameters (k, 2), and 0 or NaN at singular points;
    `said` are the conditions of the whole reach, in words.
    """

    normals: Callable[[Array], Array]
    cap: Cap
    said: str

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether the normals at points (k, 2) are in the cap."""
        return self.cap.contains(self.normals(uv))

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags:
        """Return the cells (m, n) whose normals may enter the cap, or leave it.

        The cosine of the angle between normal and axis is evaluated at the corners and the centre
        of each cell. Its range in the cell is assumed to be that of these values, extended on both
        sides by the length of this range.
        """
        nodes, middles = (
            self._cosines(places_in_cells(domain, cells, shift)) for shift in (0.0, 0.5)
        )
        nodes = [nodes[i : i + cells[0], j : j + cells[1]] for i in (0, 1) for j in (0, 1)]
        known = np.stack([*nodes, middles[: cells[0], : cells[1]]])
        low, high = known.min(axis=0), known.max(axis=0)
        limit = math.cos(math.radians(self.cap.angle))
        # Comparisons with NaN are false: cells with a point without a normal are included.
        return ~((2.0 * low - high > limit) | (2.0 * high - low < limit))

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Return 1 for boxes (k, 4) whose normals (k, 3) are in the cap, −1 for others."""
        return np.where(self.cap.contains(normals), 1, -1).astype(np.int8)

    def _cosines(self, places: Array) -> Array:
        """Return the cosines (…) of the angles between the axis and the normals.

        The normals are those at the parameters `places` (…, 2); cosines are NaN at singular points.
        """
        normals = self.normals(places.reshape(-1, 2))
        normals[~normals.any(axis=1)] = np.nan
        return (normals @ self.cap.axis).reshape(places.shape[:-1])


@dataclass(frozen=True, eq=False)
class OnPoints:
    """A condition on points of a surface, as a condition on parameters.

    `jets` returns the 2-jets (k, 6, 3) of the surface at u and v (k,). `said` is as in `InReach`.
    """

    jets: Evaluated
    condition: Condition
    said: str

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether the condition holds at the points of parameters (k, 2)."""
        jets = self.jets(*uv.T.copy())
        return self.condition.holds(jets[:, 0], normals_of_jets(jets))

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags | None:
        """Return the cells (m, n) in which the condition may begin or end, None if unknown."""
        nodes, middles = (
            self._points(places_in_cells(domain, cells, shift)) for shift in (0.0, 0.5)
        )
        corners = [nodes[i : i + cells[0], j : j + cells[1]] for i in (0, 1) for j in (0, 1)]
        radii = np.max([np.linalg.norm(x - middles, axis=-1) for x in corners], axis=0)
        found = self.condition.may_change(middles.reshape(-1, 3), AROUND * radii.ravel())
        return None if found is None else found.reshape(cells)

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Return 0 for all boxes (k, 4): nothing is proved."""
        return np.zeros(len(boxes), np.int8)

    def _points(self, places: Array) -> Array:
        return self.jets(*places.reshape(-1, 2).T.copy())[:, 0].reshape(*places.shape[:-1], 3)


def reached(
    whole: Whole, normals: Callable[[Array], Array], jets: Evaluated, reach: Reach
) -> Whole:
    """Return the part of a spline or a surface that is in a reach."""
    caps = (InReach(normals, cap, reach._said()) for cap in reach._caps)
    whole = replace(whole, trim=trimmed(whole.trim, whole.domain, whole.boundary, *caps))
    return with_conditions(whole, jets, reach)


def with_conditions(whole: Whole, jets: Evaluated, reach: Reach) -> Whole:
    """Return the part of a spline or a surface whose points satisfy the conditions of a reach.

    The caps of the reach, which are conditions on normals, are ignored.
    """
    conditions = [OnPoints(jets, x, reach._said()) for x in reach._conditions]
    if not conditions:
        return whole
    return replace(whole, trim=trimmed(whole.trim, whole.domain, whole.boundary, *conditions))


def without_reach(surface: Surface) -> Surface:
    """Return a surface, trimmed to the part in a reach, without the conditions of the reach."""
    if surface.trim is None:
        return surface
    given = tuple(x for x in surface.trim.parts if not isinstance(x, InReach | OnPoints))
    return replace(surface, trim=replace(surface.trim, parts=given) if given else None)


def in_reach(surface: Surface | None, reach: Reach | None) -> Surface | None:
    """Return a surface of several pieces, trimmed to the part in a reach."""
    if surface is None or reach is None:
        return surface

    def normals(uv: Array) -> Array:
        return normals_of_jets(surface.jets(*uv.T.copy()))

    return reached(surface, normals, surface.jets, reach)
