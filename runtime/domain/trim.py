"""The trim of a surface: the part of its domain that belongs to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..base.aliases import Array, Flags
from ..base.errors import InputError, SurfaceError, shown
from ..base.evaluation import called
from .domain import Boundary, Domain, brought_inside, domain_text, places_in_cells
from .loops import Loops, checked_loops

POINTS_AT_A_TIME = 1 << 20


class TrimPart(Protocol):
    """One condition of a trim."""

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether points (k, 2) of the domain fulfil the condition, as booleans (k,)."""
        ...

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags | None:
        """Return a mask (m, n) of the cells of a grid that the boundary may intersect, or None.

        The boundary is that of the region where the condition holds. None means that it is unknown.
        """
        ...

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Classify boxes (k, 4), u₀, u₁, v₀, v₁, by their points with a given normal.

        Row i of `normals` (k, 3) belongs to box i. Return 1 if all points of the box with this
        normal fulfil the condition, −1 if none does, and 0 if some do or if it is unknown.
        """
        ...


@dataclass(frozen=True, eq=False, repr=False)
class Trim:
    """The part of a domain that belongs to a surface: where all conditions hold.

    `Surface.trimmed` makes a trim, and the surface of a grid with missing points has a trim. A trim
    can be pickled if its predicates can.

    Attributes
    ----------
    domain : ((u0, u1), (v0, v1)) of float
        The rectangle of the parameters.
    boundary : pair of pairs of str
        The boundary conditions, see `Surface`.
    parts : tuple
        The conditions: closed polygons, predicates, and the region of a grid without missing
        points.

    Examples
    --------
    >>> import gaussmap as gm
    >>> half = gm.surfaces.torus().trimmed(within=lambda u, v: u < 3)
    >>> len(half.trim.parts), half.trim.domain == half.domain, half.trim.boundary == half.boundary
    (1, True, True)

    """

    domain: Domain
    boundary: Boundary
    parts: tuple[TrimPart, ...]

    def __repr__(self) -> str:
        kinds = ", ".join(type(part).__name__ for part in self.parts)
        return f"Trim({kinds} in {domain_text(self.domain, self.boundary)})"

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether points belong to the surface.

        Parameters
        ----------
        uv : (k, 2) float64 array
            Parameters u, v in the domain; periodic ones are taken modulo the period.
        threads : int, optional
            The number of threads, by default one for each core.

        Returns
        -------
        (k,) bool array
            Whether all conditions hold.

        Raises
        ------
        SurfaceError
            If a predicate raises, or returns anything but booleans.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> triangle = gm.surfaces.torus().trimmed([[(1, 1), (2, 1), (1, 2)]])
        >>> triangle.trim.contains(np.array([[1.2, 1.2], [1.8, 1.8]]))
        array([ True, False])

        """
        u, v = uv.T
        wrapped = np.stack(brought_inside(u, v, self.domain, self.boundary), axis=1)
        inside = np.ones(len(uv), dtype=np.bool_)
        for part in self.parts:
            if inside.any():
                inside[inside] = part.contains(wrapped[inside], threads)
        return inside

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> tuple[Flags, Flags]:
        """Return the cells that known boundaries may intersect, and those with unknown boundaries.

        Parameters
        ----------
        domain : ((u0, u1), (v0, v1)) of float
            The rectangle of the cells.
        cells : (int, int)
            The numbers (m, n) of cells.

        Returns
        -------
        (m, n) bool array
            True for each cell that the boundary of a polygon, or another known one, may intersect.
        (m, n) bool array
            True for each other cell in which a predicate may change its value: for all cells whose
            centres are inside the known boundaries.

        Examples
        --------
        >>> import gaussmap as gm
        >>> corner = gm.surfaces.sphere().trimmed([[(1, 1), (1.1, 1), (1, 1.1)]])
        >>> passed, unknown = corner.trim.cells_of_border(corner.domain, (20, 20))
        >>> int(passed.sum()), int(unknown.sum())
        (9, 0)

        """
        found = [part.cells_of_border(domain, cells) for part in self.parts]
        known = [x for x in found if x is not None]
        passed = np.logical_or.reduce([np.zeros(cells, dtype=np.bool_), *known])
        if len(known) == len(found):
            return passed, np.zeros(cells, dtype=np.bool_)
        parts = [x for x, y in zip(self.parts, found, strict=True) if y is not None]
        inside = replace(self, parts=tuple(parts)).contains(
            places_in_cells(domain, cells, 0.5).reshape(-1, 2)
        )
        return passed, inside.reshape(cells) & ~passed

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Return whether boxes are inside the trim (1), outside (−1), or undecided (0).

        Parameters
        ----------
        boxes : (k, 4) float64 array
            Rectangles u₀, u₁, v₀, v₁ of parameters.
        normals : (k, 3) float64 array
            A unit normal for each box: only points of the box with this normal count.

        Returns
        -------
        (k,) int8 array
            1 and −1 are proved up to rounding. The result is 0 for boxes that may meet the
            boundary, and for predicates that are not inequalities between NumPy functions.

        Examples
        --------
        >>> import gaussmap as gm
        >>> import numpy as np
        >>> square = gm.surfaces.sphere().trimmed([[(1, 1), (2, 1), (2, 2), (1, 2)]])
        >>> boxes = np.array([[1.1, 1.2, 1.1, 1.2], [0.9, 1.2, 1.1, 1.2], [3.0, 3.1, 1.1, 1.2]])
        >>> square.trim.sides(boxes, np.zeros((3, 3))).tolist()
        [1, 0, -1]

        """
        return np.min([part.sides(boxes, normals) for part in self.parts], axis=0)

    def with_boundary(self, boundary: Boundary) -> Trim:
        """Return the trim with the given boundary conditions of its surface."""
        if boundary == self.boundary:
            return self
        parts = [replace(x, boundary=boundary) if isinstance(x, Loops) else x for x in self.parts]
        return Trim(self.domain, boundary, tuple(parts))

    def turned(self, boundary: Boundary) -> Trim:
        """Return the trim after a reversal of u, with the new boundary conditions `boundary`."""
        low, high = self.domain[0]
        parts = tuple(Turned.of(part, low + high) for part in self.parts)
        return replace(self, boundary=boundary, parts=parts)


class OnBoxes(Protocol):
    """A condition on u and v that can be evaluated on boxes."""

    def sides(self, boxes: Array) -> NDArray[np.int8]:
        """Return 1 for boxes (k, 4) where the condition holds, −1 where it fails, 0 if unknown."""
        ...


Traced = Callable[[Callable[[Array, Array], Any], Domain], OnBoxes | None]


@dataclass(frozen=True, eq=False)
class Predicate:
    """A vectorized callable f(u, v) → booleans as a condition, on the domain of a surface.

    `traced` returns the condition in a form that can be evaluated on boxes, or None. `name` is the
    name of the surface, for messages.
    """

    function: Callable[[Array, Array], Any]
    name: str
    domain: Domain
    traced: Traced

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return the booleans of the callable at points (k, 2)."""
        starts = range(0, len(uv), POINTS_AT_A_TIME)
        found = [self._part(uv[first : first + POINTS_AT_A_TIME]) for first in starts]
        return np.concatenate([np.empty(0, dtype=np.bool_), *found])

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> None:
        """Return None: the boundary of the condition is unknown."""

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Classify boxes (k, 4), see `Trim.sides`: 0 for all if the callable cannot be traced."""
        condition = self.traced(self.function, self.domain)
        return np.zeros(len(boxes), np.int8) if condition is None else condition.sides(boxes)

    def _part(self, uv: Array) -> Flags:
        label = f"the predicate within=... of surface {self.name!r}"
        found = called(self.function, (uv[:, 0], uv[:, 1]), label)
        if not isinstance(found, np.ndarray) or found.dtype != np.bool_:
            kind = found.dtype if isinstance(found, np.ndarray) else type(found).__name__
            raise SurfaceError(f"{label} must return an array of booleans, not {kind}.")
        if found.shape != (len(uv),):
            raise SurfaceError(
                f"{label} returned the shape {found.shape} for parameters of shape {(len(uv),)}; "
                "it must return a boolean for each."
            )
        return found


@dataclass(frozen=True, eq=False)
class Turned:
    """One condition of a trim after u → total - u."""

    part: TrimPart
    total: float

    @staticmethod
    def of(part: TrimPart, total: float) -> TrimPart:
        """Return a condition after the reversal of u; two reversals give the original condition."""
        return part.part if isinstance(part, Turned) else Turned(part, total)

    def contains(self, uv: Array, threads: int | None = None) -> Flags:
        """Return whether points (k, 2) fulfil the condition."""
        own = np.stack([self.total - uv[:, 0], uv[:, 1]], axis=1)
        return self.part.contains(own, threads)

    def cells_of_border(self, domain: Domain, cells: tuple[int, int]) -> Flags | None:
        """Return a mask (m, n) of the cells of a grid that the boundary may intersect, or None."""
        (low, high), along_v = domain
        found = self.part.cells_of_border(((self.total - high, self.total - low), along_v), cells)
        return None if found is None else found[::-1]

    def sides(self, boxes: Array, normals: Array) -> NDArray[np.int8]:
        """Classify boxes (k, 4) as inside (1), outside (−1) or undecided (0)."""
        own = np.column_stack([self.total - boxes[:, 1::-1], boxes[:, 2:]])
        return self.part.sides(own, normals)


def polygons_of(part: TrimPart) -> tuple[Array, ...]:
    """Return the closed polygons (k, 2) of a condition; none if it is not given by loops."""
    if isinstance(part, Turned):
        own = polygons_of(part.part)
        return tuple(np.stack([part.total - x[:, 0], x[:, 1]], axis=1) for x in own)
    return part.polygons if isinstance(part, Loops) else ()


def trimmed_by(
    trim: Trim | None, loops: object, within: object, domain: Domain, boundary: Boundary,
    name: str, traced: Traced,
) -> Trim:  # fmt: skip
    """Return `trim` with the conditions `loops` and `within`; InputError if they are unusable.

    See `Surface.trimmed` for the conditions.
    """
    parts: list[TrimPart] = []
    if loops is not None:
        polygons = checked_loops(loops, domain, boundary)
        if polygons.overlap():
            raise InputError(
                "the loops run over more than one period, and overlap their copies beyond the "
                "seam; cut them at the seam."
            )
        parts.append(polygons)
    if within is not None:
        if not callable(within):
            raise InputError(f"within must be callable as f(u, v), not {shown(within)}.")
        parts.append(Predicate(within, name, domain, traced))
    if not parts:
        raise InputError("trimmed needs loops, within=..., or both.")
    return trimmed(trim, domain, boundary, *parts)


def trimmed(trim: Trim | None, domain: Domain, boundary: Boundary, *parts: TrimPart) -> Trim:
    """Return `trim`, or the whole domain if it is None, with further conditions."""
    whole = Trim(domain, boundary, ()) if trim is None else trim
    return replace(whole, parts=(*whole.parts, *parts))


# --- samples of a surface that may have a trim ----------------------------------------------------


def with_uv(trim: Trim | None, fields: Sequence[str]) -> tuple[str, ...]:
    """Return the names of `fields`; if there is a trim, "uv" is added."""
    return (*fields, "uv") if trim is not None and "uv" not in fields else tuple(fields)


def samples_inside(
    trim: Trim | None, arrays: dict[str, NDArray[Any]], fields: Sequence[str]
) -> dict[str, NDArray[Any]]:
    """Return the arrays named in `fields`, for the samples that are inside a trim.

    `arrays` includes "uv". Without a trim, all arrays are returned unchanged.
    """
    if trim is None:
        return arrays
    inside = trim.contains(arrays["uv"].astype(np.float64))
    return {name: x[inside] for name, x in arrays.items() if name in fields}
