"""The sides of the domain: collapsed ones, which are poles or apexes, and seams that close.

A disk in polar coordinates has one collapsed side, a sphere has two. If boundary conditions are not
declared, poles are detected from a few points: the side is collapsed, the other parameter is
smoothly periodic, and each meridian continues the opposite one smoothly. Any other collapsed side
is an apex: the tip of a cone, the corner of a triangle.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TypeVar, cast

import numpy as np

from ...generated import spline as formulas
from ..base.aliases import Array
from ..base.errors import SurfaceError
from ..base.evaluation import returned
from ..base.formula_calls import python_function
from ..base.scales import ROUNDING, SAME_POINT, apart, extent_of, not_too_large
from ..domain.domain import Assumed, Boundary, broken_poles, closes
from .surface_values import SurfaceValues

Values = TypeVar("Values", bound=SurfaceValues)

# The number of intervals between points along a side, an even number.
STEPS = 16
# The distance between the parameter lines next to a side, relative to the domain: the cube root of
# the rounding error of coordinates relative to the size of the surface, within these bounds. (The
# rounding error is large for a surface far from the origin.)
LEAST_STEP, MOST_STEP = 1e-4, 1e-2
# A line continues smoothly if extrapolation from three of its points misses the next point by at
# most this part of the step. The relative error of the extrapolation is of second order in the
# step. KINK_OF_DATA is for grids of points, whose steps are larger.
KINK, KINK_OF_DATA = 1e-2, 0.3

# If the surface has different points at the two bounds of a parameter, the difference is compared
# with the change of the points if the parameter changes by this many units in the last place.
ROUNDINGS = 2.0


def with_found_sides(surface: Values) -> tuple[Values, int]:
    """Return a surface with the poles that are detected at its sides, and the number of apexes.

    A surface that cannot be evaluated next to its sides keeps its boundary conditions; if that is
    an error, the fit reports it.
    """
    boundary, apexes = surface.boundary, 0
    if any(surface.assumed_open):
        with np.errstate(all="ignore"), suppress(SurfaceError):
            if surface.grid is None:
                sides = _Sides.of_surface(surface)
            else:
                sides = _Sides.of_grid(surface.grid, surface.boundary, surface.assumed_open)
            boundary, apexes = sides.found()
    if boundary == surface.boundary:
        return surface, apexes
    trim = surface.trim and surface.trim.with_boundary(boundary)
    return replace(surface, boundary=boundary, trim=trim), apexes


def closed_grid(points: Array, boundary: Boundary, assumed: Assumed) -> tuple[Array, Boundary]:
    """Return a grid (m, n, 3) and its boundary conditions, with detected poles.

    If a parameter turns out to be periodic, the last row or column of points is dropped, since it
    repeats the first one.
    """
    if not any(assumed) or min(points.shape[:2]) < 4:
        return points, boundary
    with np.errstate(all="ignore"):
        found = _Sides.of_grid(points, boundary, assumed).found()[0]
    for axis in (0, 1):
        if boundary[axis][0] != "periodic" == found[axis][0]:
            points = points[:-1] if axis == 0 else points[:, :-1]
    return points, found


@dataclass(frozen=True)
class _Sides:
    """The four sides of a surface, from which poles and apexes are detected.

    `lines(axis, end)` returns k points on a side, and k points on each of the two parameter lines
    next to it: an array (3, k, 3). The side is u = const for axis 0, v = const for axis 1, at the
    lower bound for end 0 and the upper one for end 1. `repeated` is True if closed lines repeat
    their first point. `kink` is KINK or KINK_OF_DATA. Points within a distance of `same` count as
    equal; `rounding` is the rounding error of a linear combination of a few points.
    """

    lines: Callable[[int, int], Array]
    boundary: Boundary
    assumed: Assumed
    repeated: bool
    kink: float
    same: float
    rounding: float

    @classmethod
    def of_surface(cls, surface: SurfaceValues) -> _Sides:
        """Return the sides of a surface; `lines` evaluates the surface."""
        parts = [low + (high - low) * np.linspace(0.0, 1.0, 5) for low, high in surface.domain]
        size, last_place = extent_of(surface.evaluate(parts[0][:, None], parts[1]))
        part = np.clip(np.cbrt(last_place / (size or 1.0)), LEAST_STEP, MOST_STEP)

        def lines(axis: int, end: int) -> Array:
            low, high = surface.domain[1 - axis]
            along = np.append(low + (high - low) * (np.arange(STEPS) / STEPS), high)
            low, high = surface.domain[axis]
            step = part * ((high - low) if end == 0 else (low - high))
            across = (low, high)[end] + step * np.arange(3)[:, None]
            return surface.evaluate(*((across, along) if axis == 0 else (along, across)))

        same, rounding = SAME_POINT * size + ROUNDING * last_place, ROUNDING * last_place
        return cls(lines, surface.boundary, surface.assumed_open, True, KINK, same, rounding)

    @classmethod
    def of_grid(cls, points: Array, boundary: Boundary, assumed: Assumed) -> _Sides:
        """Return the sides of a grid of points; a side with NaN never counts as collapsed."""

        def lines(axis: int, end: int) -> Array:
            rows = np.swapaxes(points, 0, axis)
            return rows[:3] if end == 0 else rows[:-4:-1]

        size, last_place = extent_of(points)
        same, rounding = SAME_POINT * size + ROUNDING * last_place, ROUNDING * last_place
        return cls(lines, boundary, assumed, False, KINK_OF_DATA, same, rounding)

    def found(self) -> tuple[Boundary, int]:
        """Return the boundary conditions with detected poles, and the number of apexes."""
        kinds, apexes = [list(ends) for ends in self.boundary], 0
        for axis, end in ((0, 0), (0, 1), (1, 0), (1, 1)):
            if self.assumed[axis] and self.boundary[axis][end] == "open":
                near = self.lines(axis, end)
                if not float(np.ptp(near[0], axis=0).max()) <= self.same:
                    continue
                if self._is_pole(1 - axis, near):
                    kinds[axis][end] = "pole"
                    kinds[1 - axis] = ["periodic", "periodic"]
                else:
                    apexes += 1
        boundary = (kinds[0][0], kinds[0][1]), (kinds[1][0], kinds[1][1])
        return cast(Boundary, boundary), apexes

    def _is_pole(self, around: int, near: Array) -> bool:
        """Return whether a collapsed side is a pole.

        At a pole the parameter with the index `around` is periodic, and each meridian continues the
        opposite one. `near` (3, k, 3) are points on the side and on two lines next to it. Meridians
        that have no tangent at the side (x_u = x_v = 0) may end in a cusp: then their second
        differences are not smaller than their first differences.
        """
        repeated = self.repeated
        if self.boundary[around][0] != "periodic":
            if not self.assumed[around] or not self._closes(around):
                return False
            repeated = True
        if repeated:
            near = near[:, :-1]
        half, odd = divmod(near.shape[1], 2)
        opposite = (np.roll(near[1], half, axis=0) + np.roll(near[1], half + odd, axis=0)) / 2.0
        step, bend = (np.abs(np.diff(near, k, axis=0)[0]).max() for k in (1, 2))
        return bool(bend < step) and self._goes_on(near, opposite)

    def _closes(self, axis: int) -> bool:
        """Return whether a parameter is periodic: points and tangents are the same at both ends."""
        low, high = self.lines(axis, 0), self.lines(axis, 1)
        is_same = bool(np.abs(low[0] - high[0]).max() <= self.same)
        return is_same and self._goes_on(low, high[1])

    def _goes_on(self, near: Array, beyond: Array) -> bool:
        """Return whether extrapolation of three lines of points gives the next line.

        `near` (3, k, 3) are points on the lines at 0, 1 and 2 steps from a side, `beyond` (k, 3)
        the points on the line at −1.
        """
        step = float(np.abs(near[1] - near[0]).max())
        predicted = python_function(formulas.extrapolation)(*near)
        return bool(np.abs(predicted - beyond).max() <= self.kink * step + self.rounding)


# --- seams ----------------------------------------------------------------------------------------


def closed_points(surface: SurfaceValues, cells: tuple[int, int]) -> Array:
    """Return points (m + 1, n + 1, 3) of a surface at the corners of m × n cells of its domain.

    Raises the SurfaceErrors of `close_seams`, and one if coordinates are too large to compute with.
    """
    u, v = (
        np.linspace(*ends, count + 1) for ends, count in zip(surface.domain, cells, strict=True)
    )
    points = not_too_large(surface.evaluate(u[:, None], v), surface.name)
    close_seams(surface, points)
    return points


def close_seams(surface: SurfaceValues, vertices: Array) -> None:
    """Make the two rows of `vertices` (m + 1, n + 1, 3) at a seam equal: the spline then closes.

    Raises SurfaceError if the rows differ by more than rounding, or if a pole is not collapsed.
    """
    for axis, (along, ends) in enumerate(zip("uv", surface.boundary, strict=True)):
        rows = np.swapaxes(vertices, 0, axis)
        if closes(ends):
            first = rows[0] if ends[0] == "periodic" else rows[0, ::-1].copy()
            if apart(rows[-1], first, vertices):
                how, other = "the same", "the same, mirrored"
                if ends[0] == "mirrored":
                    how, other = other, how
                if apart(rows[-1], first[::-1], vertices):
                    why = _by_rounding(surface, axis, rows, float(np.abs(rows[-1] - first).max()))
                else:
                    word = "mirrored" if ends[0] == "periodic" else "periodic"
                    why = f'; they are {other}: "{word}" in periodic=(...) says so'
                raise SurfaceError(
                    f"surface {surface.name!r} does not close along {along}: its two ends must be "
                    f"{how}{why}."
                )
            rows[-1] = first
        for end in broken_poles(vertices, surface.boundary, axis):
            raise SurfaceError(
                f"surface {surface.name!r} has no pole at {along} = {surface.domain[axis][end]}: "
                "this side of its domain is not one point."
            )


def _by_rounding(surface: SurfaceValues, axis: int, rows: Array, far: float) -> str:
    """Return the clause of a message on the distance `far` between the points at both bounds.

    The clause says whether the rounding error of a bound explains this distance: 2π, for example,
    is not a float64 number.
    """
    low, high = surface.domain[axis]
    first, last = rows[0], rows[-1]
    other = np.linspace(*surface.domain[1 - axis], len(last))
    moved = 0.0
    step = ROUNDINGS * float(np.spacing(max(abs(low), abs(high))))
    for end, row in ((low + step, first), (high - step, last), (high + step, last)):
        near = np.full(len(last), end)
        places = (near, other) if axis == 0 else (other, near)
        points = returned(surface.function, places, (3,), f"surface {surface.name!r}")
        moved = max(moved, float(np.nanmax(np.abs(points - row))))
    along = "uv"[axis]
    if not moved >= 0.5 * far:
        return f"; they differ by {far:.3g}"
    return (
        f"; they differ by {far:.3g}, as much as its rounding changes the points there: "
        f"compute them at {along} = {low!r} in place of {high!r}"
    )
