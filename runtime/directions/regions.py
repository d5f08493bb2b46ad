"""Regions: caps and polygons on the sphere, and the part of a surface that is in reach."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.checks import finite_array, finite_number, positive_number, yes_or_no
from ..base.errors import InputError, shown
from ..base.memory import check_memory
from ..base.tolerances import TRIPLE_PRODUCT_ERROR
from .unit import as_normals, unit_vector

UP = np.array([0.0, 0.0, 1.0])
# A row of `Reach._numbers` with this number in place of an angle or a distance is the condition of
# unobstructed rays.
FREE = -1.0
# Texts name the error of edges if it is larger than this part of the distance from edges.
WORTH_NAMING = 1e-9


class Cap(NamedTuple):
    """The directions whose angle with the unit vector `axis` is at most `angle` degrees."""

    axis: NDArray[np.float64]
    angle: float

    @property
    def solid_angle(self) -> float:
        """The solid angle of the cap."""
        return 4.0 * math.pi * math.sin(math.radians(self.angle) / 2.0) ** 2

    def contains(self, normals: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether unit normals (N, 3) are in the cap; False for rows of NaN or 0."""
        return normals.any(axis=1) & (angles_between(normals, self.axis) <= self.angle)


class Condition(Protocol):
    """A condition on points of a surface that does not depend on the normals alone."""

    @property
    def error(self) -> float:
        """The error of the arcs that stand for edges, in L; 0 without edges.

        The condition is stricter by this distance.
        """
        ...

    def holds(self, points: NDArray[np.float64], normals: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether the condition holds at points (k, 3) with unit normals (k, 3)."""
        ...

    def may_change(
        self, points: NDArray[np.float64], radii: NDArray[np.float64]
    ) -> NDArray[np.bool_] | None:
        """Return for each ball whether the condition may hold in one part and fail in another.

        The k balls have the centres `points` (k, 3) and the `radii` (k,). None means unknown.
        """
        ...


class Reach:
    """Where samples may lie: conditions on normals, on the distance from edges, and on free rays.

    Parameters
    ----------
    axis : (3,) array_like, default (0, 0, 1)
        The direction of a probe, a camera or a printer.
    angle : float, default 180
        The largest angle between a normal and the axis, in degrees.
    slope : (float, float), optional
        The least and the largest angle between a normal and +z, in degrees.
    aspect : (float, float), optional
        For terrain: the direction that a slope faces, in degrees clockwise from north, and the
        largest difference from it to either side, at most 90. Level ground is included.
    from_edges : float, optional
        The least distance, in L, from all edges and boundaries of faces of a part, or from the
        boundary of a surface: the boundary of its trim, and the open sides of its domain. A smooth
        seam of one face is not an edge. Creases between the pieces of a surface are edges.
    unobstructed : bool, default False
        For CAD parts and closed surfaces: only points from which the ray in the direction of the
        axis does not enter the part or surface. This is tested with a mesh, as in
        `Samples.unobstructed`. Faces that were selected from a part are tested with the whole part.
    clearance : float, optional
        The least free length, in L, along the normal of the point: only points for which
        `Samples.unobstructed` of this distance is true. With infinity, the whole ray is free.

    Raises
    ------
    InputError
        For an unusable axis, angles out of range, and distances that are not positive.

    Examples
    --------
    >>> import gaussmap as gm
    >>> south = gm.Reach(slope=(5, 20), aspect=(180, 45))
    >>> samples = gm.sample("wavy_graph", 200, reach=south)
    >>> bool((samples.normals[:, 1] < 0).all()), samples.slope.max().round(1)
    (True, np.float64(20.0))
    >>> from gaussmap.tools.cad.examples import box
    >>> probed = gm.sample(box(3, 2, 1), 50, reach=gm.Reach((0, 0, 1), 30, from_edges=0.5))
    >>> len(probed), bool((abs(probed.points - [1.5, 1, 1]).max(axis=0) <= [1, 0.5, 0]).all())
    (50, True)

    """

    def __init__(
        self,
        axis: ArrayLike = (0.0, 0.0, 1.0),
        angle: float = 180.0,
        *,
        slope: Sequence[float] | None = None,
        aspect: Sequence[float] | None = None,
        from_edges: float | None = None,
        unobstructed: bool = False,
        clearance: float | None = None,
    ) -> None:
        degrees = positive_number(angle, "the angle of reach", " degrees", most=180.0)
        caps = [Cap(unit_vector(axis, "the axis of reach"), degrees)]
        if slope is not None:
            least, most = _pair(slope, "slope", 180.0)
            caps += [Cap(UP, most), Cap(-UP, 180.0 - least)]
        if aspect is not None:
            middle, half = _pair(aspect, "aspect", 90.0)
            turned = np.radians([middle + half - 90.0, middle - half + 90.0])
            sides = np.stack([np.sin(turned), np.cos(turned), 0.0 * turned], axis=1)
            caps += [Cap(side, 90.0) for side in sides]
        # Caps of 180° are the whole sphere; they are left out if there are other caps.
        self._caps = tuple(x for x in caps if x.angle < 180.0 or len(caps) == 1)
        self._from_edges = None if from_edges is None else positive_number(from_edges, "from_edges")
        self._along = caps[0].axis if yes_or_no(unobstructed, "unobstructed") else None
        self._clearance = (
            None if clearance is None else positive_number(clearance, "clearance", infinite=True)
        )
        # Conditions that depend on the whole surface; see `_on`.
        self._conditions: tuple[Condition, ...] = ()

    @classmethod
    def _of(cls, numbers: Sequence[float]) -> Reach:
        """Return the reach that has the given `_numbers`."""
        rows = np.array(numbers, dtype=np.float64).reshape(-1, 4)
        lengths = rows[~rows[:, :3].any(axis=1), 3].tolist()
        axes = rows[rows[:, :3].any(axis=1)]
        found = cls(
            from_edges=max((x for x in lengths if x > 0.0), default=None),
            clearance=max((-x or math.inf for x in lengths if x <= 0.0), default=None),
        )
        caps, along = axes[axes[:, 3] != FREE], axes[axes[:, 3] == FREE]
        found._along = unit_vector(along[0, :3], "the axis of reach") if len(along) else None
        found._caps = tuple(cap for x in caps for cap in cls(x[:3], float(x[3]))._caps)
        return found

    @property
    def _numbers(self) -> tuple[float, ...]:
        """Four numbers for each condition.

        These are the unit vector of the axis and the angle of each cap, then 0, 0, 0 and the
        distance from edges, then the axis of unobstructed rays and `FREE`, then 0, 0, 0 and the
        clearance, as a negative number; 0 if it is infinite, since JSON has no infinity.
        """
        numbers = [x for cap in self._caps for x in (*cap.axis.tolist(), cap.angle)]
        away = () if self._from_edges is None else (0.0, 0.0, 0.0, self._from_edges)
        free = () if self._along is None else (*self._along.tolist(), FREE)
        if (clear := self._clearance) is None:
            return *numbers, *away, *free
        return *numbers, *away, *free, 0.0, 0.0, 0.0, 0.0 if math.isinf(clear) else -clear

    @property
    def _rays(self) -> list[tuple[NDArray[np.float64] | None, float]]:
        """The axes and the lengths of rays that have to be free; for rays along normals, None."""
        found = list[tuple[NDArray[np.float64] | None, float]]()
        found += [] if self._along is None else [(self._along, math.inf)]
        found += [] if self._clearance is None else [(None, self._clearance)]
        return found

    def _on(self, conditions: Sequence[Condition]) -> Reach:
        """Return a copy of the reach with conditions on the points of one surface or part."""
        found = copy(self)
        found._conditions = tuple(conditions)
        return found

    @property
    def _smallest(self) -> Cap:
        """The smallest of the caps whose intersection is the reach."""
        return min(self._caps, key=lambda cap: cap.angle)

    def _contains(self, normals: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return whether unit normals (N, 3) are in all caps; False for rows of NaN or 0."""
        return np.logical_and.reduce([cap.contains(normals) for cap in self._caps])

    def _holds(
        self, points: NDArray[np.float64], normals: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """Return whether points (N, 3) with unit normals (N, 3) are in reach."""
        found = self._contains(normals)
        for x in self._conditions:
            found[found] = x.holds(points[found], normals[found])
        return found

    @property
    def _reported(self) -> dict[str, Any]:
        """The entries of a report on the reach: its `_numbers`, and the error of edges in L."""
        error = max((x.error for x in self._conditions), default=0.0)
        return {"reach": self._numbers, "edge_error": error if self._from_edges else None}

    def _said(self, unit: str | None = None, error: float | None = None) -> str:
        """Return the conditions in words, with the `error` of edges if it exceeds rounding."""
        said = [
            f"normals within {cap.angle:g}° of ({', '.join(f'{x + 0.0:.3g}' for x in cap.axis)})"
            for cap in self._caps
            if cap.angle < 180.0
        ]
        unit = f" {unit or ''}".rstrip()
        if distance := self._from_edges:
            more = error is not None and error > WORTH_NAMING * distance
            plus = f" + {error:.2g}{unit} (their error)" if more else ""
            said.append(f"at least {distance:g}{unit}{plus} from edges")
        said += [] if self._along is None else ["unobstructed"]
        if length := self._clearance:
            free = "" if math.isinf(length) else f" for {length:g}{unit}"
            said.append(f"free along the normal{free}")
        return ", ".join(said) or "all normals"

    def __repr__(self) -> str:
        return f"Reach({self._said()})"


def _pair(values: Sequence[float], name: str, most: float) -> tuple[float, float]:
    """Return a pair of angles in degrees; InputError if it is out of range or of order.

    The second angle must be positive and at most `most`. If `name` is "slope", the pair must be the
    least and the largest angle.
    """
    first, second = finite_array(values, (2,), name).tolist()
    if not 0.0 < second <= most or (name == "slope" and not 0.0 <= first < second):
        form = "the least and the largest angle" if name == "slope" else "a direction and an angle"
        raise InputError(f"{name} must be {form}, at most {most:g} degrees, not {shown(values)}.")
    return first, second


def checked_reach(reach: Any) -> Reach | None:  # noqa: ANN401
    """Return the `Reach` that a user gives, as a Reach or as a pair of an axis and an angle.

    Returns None for None, and raises InputError for any other value.
    """
    if reach is None or isinstance(reach, Reach):
        return reach
    try:
        axis, angle = reach
    except Exception:  # iteration may raise anything
        raise InputError(
            f"reach must be an axis and an angle in degrees, such as ((0, 0, 1), 60.0), or a "
            f"Reach, not {shown(reach)}."
        ) from None
    return Reach(axis, angle)


def cap(normals: ArrayLike, axis: ArrayLike, angle: float) -> NDArray[np.float64]:
    """Return the normals, among given ones, that are within an angle of an axis.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.
    axis : (3,) array_like
        The direction of the middle of the cap.
    angle : float
        The radius of the cap in degrees, from 0 to 180: 90 gives the closed hemisphere, 180 all
        normals.

    Returns
    -------
    (k, 3) float64 array
        Unit normals in the order of `normals`; there may be none.

    Raises
    ------
    InputError
        For unusable normals (see `sample`), an axis that is zero or not three finite numbers, or an
        angle out of range.

    See Also
    --------
    polygon : the normals in a convex polygon on the sphere.

    Notes
    -----
    Any other region is a mask on the array, such as ``normals[normals[:, 2] > 0.5]``.

    Examples
    --------
    >>> import gaussmap as gm
    >>> upper = gm.directions.cap(gm.icosphere(8), axis=(0, 0, 1), angle=60)
    >>> bool((upper[:, 2] >= 0.5 - 1e-15).all())
    True

    """
    directions, middle = as_normals(normals), unit_vector(axis, "axis")
    degrees = finite_number(angle, "angle")
    if not 0.0 <= degrees <= 180.0:
        raise InputError(f"angle must lie between 0 and 180 degrees, and is {degrees:g}.")
    check_memory("cap", len(directions))
    return directions[Cap(middle, degrees).contains(directions)]


def polygon(normals: ArrayLike, corners: ArrayLike) -> NDArray[np.float64]:
    """Return the normals, among given ones, that lie in a convex polygon on the sphere.

    Parameters
    ----------
    normals : (S, 3) array_like
        Directions of any length but 0.
    corners : (c, 3) array_like
        At least three directions of any length, anticlockwise as seen from outside. The edges are
        arcs of great circles, each shorter than half of one; the boundary belongs to the polygon.

    Returns
    -------
    (k, 3) float64 array
        Unit normals in the order of `normals`; there may be none.

    Raises
    ------
    InputError
        For unusable normals or corners, neighbouring corners that are equal or opposite, or corners
        that are not in anticlockwise order round a convex polygon.

    See Also
    --------
    cap : the normals within an angle of an axis.

    Examples
    --------
    >>> import gaussmap as gm
    >>> octant = gm.directions.polygon(gm.icosphere(8), [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> bool((octant >= -1e-15).all())
    True

    """
    directions, around = as_normals(normals), as_normals(corners)
    if len(around) < 3:
        raise InputError(f"a polygon needs at least 3 corners, not {len(around)}.")
    following = np.roll(around, -1, axis=0)
    inwards = np.cross(around, following)
    lengths = np.linalg.norm(inwards, axis=1)
    if (lengths <= TRIPLE_PRODUCT_ERROR).any():
        k = int(np.argmax(lengths <= TRIPLE_PRODUCT_ERROR))
        raise InputError(
            f"corners {k} and {(k + 1) % len(around)} are equal or opposite: no arc joins them."
        )
    if (around @ inwards.T < -TRIPLE_PRODUCT_ERROR).any():
        raise InputError(
            "the corners must go round a convex polygon anticlockwise, as seen from outside."
        )
    check_memory("polygon", len(directions), 9.0 * len(around))  # a number and a boolean each
    return directions[(directions @ inwards.T >= -TRIPLE_PRODUCT_ERROR).all(axis=1)]


def angles_between(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angles in degrees between unit vectors (…, 3), accurate also near 0 and 180."""
    apart = np.linalg.norm(first - second, axis=-1)
    together = np.linalg.norm(first + second, axis=-1)
    return np.degrees(2.0 * np.arctan2(apart, together))
