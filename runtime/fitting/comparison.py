"""The misfit of a spline: its distance from the surface, or from the data, that it approximates.

A surface is compared at test points that the fit does not use, data at all points.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from ..base.aliases import Array, Flags, Indices
from ..base.errors import SurfaceError
from ..domain.domain import Boundary, Domain, cells_between
from ..domain.trim import Trim
from ..spline.misfit import Misfit
from ..spline.spline import Spline
from ..surface.surface import Surface

POINTS_AT_A_TIME = 1 << 16


class Counts(NamedTuple):
    """The numbers of test points on a line, of inner lines along u (or v), and of scattered points.

    Inner lines are those that are not near the sides of the domain.
    """

    steps: int
    lines: int
    spread: int


# Test points are on lines along u and along v, and scattered over the domain. Each line has three
# test points in any strip of 1 % of the domain that it crosses.
MANY = Counts(steps=301, lines=4, spread=2048)
# The counts for a spline with fewer cells than FEW_CELLS: a surface is evaluated at most 8,000
# times to compare it with one spline.
FEW_CELLS, FEW = 2048, Counts(steps=202, lines=1, spread=512)
# Further lines of test points run along the sides, at these distances relative to the domain: at
# poles and open sides the spline is least accurate in the first cell.
NEAR_ENDS = (0.002, 0.015)
# A side of the domain counts as collapsed if the line of test points next to it is shorter than
# COLLAPSED times the diagonal of the bounding box. Within a distance of NEXT_TO_POLE of such a
# side, relative to the domain, normals converge more slowly.
COLLAPSED, NEXT_TO_POLE = 0.01, 1.0 / 16.0
# Normals take four evaluations, points one: normals are compared at every third test point on
# lines, and at every fourth of the scattered ones.
EACH_ON_LINES, EACH_SPREAD = 3, 4
# Multiples of irrational numbers, modulo 1, are evenly spread: those of 1/g in one dimension, where
# g is the golden ratio, and those of 1/ρ and 1/ρ² in two, where ρ³ = ρ + 1 (Roberts' R2 sequence).
# They are never parameters of fits, which are rational.
GOLDEN = 0.6180339887498949
PLASTIC = 0.7548776662466927
# Normals are computed from central differences over ± a step, relative to the domain: their errors
# are of second order in the step, and rounding errors of order −1. The step is the cube root of the
# rounding error of coordinates relative to the size of the surface, within these bounds.
SHORTEST_STEP, LONGEST_STEP = 2.0**-17, 2.0**-11
# Normals of the surface with a larger error than this (radians), near singular points, are ignored.
NORMAL_ERROR = 1e-4
# The rounding error of a difference of two coordinates, relative to the largest coordinate: 8
# roundings.
DIFFERENCE = 2.0**-49
# The surface is evaluated again at AROUND points around each of the WORST test points, within a
# cell, and its normal at every EACH_AROUND-th of them. At most one of the WORST is in each of
# GROUPS groups of consecutive test points.
AROUND, WORST, GROUPS, EACH_AROUND = 30, 16, 100, 4
# The number of points on each line of a cross around a test point, within a cell on either side.
CROSS = 17


@dataclass(frozen=True, eq=False)
class Comparison:
    """A misfit, with the parameters where it is largest.

    Attributes
    ----------
    misfit : Misfit
        The misfit of a spline.
    angle_away : float or None
        The largest angle between normals, away from collapsed sides of the domain, such as poles:
        next to these sides angles decrease only slowly with the size of the cells.
    farthest, steepest : (2,) float64 array
        The parameters, as fractions of the domain, of the largest distance and of `angle_away`.
        If `angle_away` is None, both are those of the largest distance.

    """

    misfit: Misfit
    angle_away: float | None
    farthest: Array
    steepest: Array


def compare_with_data(
    spline: Spline, data: Array, boundary: Boundary, trim: Trim | None
) -> Comparison:
    """Return the misfit of a spline to a grid of points (m, n, 3).

    Points with NaN, and points outside of the trim, are left out.
    """
    cells = cells_between(data.shape, boundary)
    parts = [np.arange(k) / count for k, count in zip(data.shape, cells, strict=False)]
    rows = max(POINTS_AT_A_TIME // len(parts[1]), 1)
    largest, total, count, place = 0.0, 0.0, 0, np.array([0.5, 0.5])
    for first in range(0, len(parts[0]), rows):
        u, v = (
            x.ravel() for x in np.meshgrid(parts[0][first : first + rows], parts[1], indexing="ij")
        )
        points = evaluated(spline, u, v)[0]
        squares = squared_lengths(points - data[first : first + rows].reshape(-1, 3), spline.scale)
        known = ~np.isnan(squares)
        if trim is not None:
            low, high = np.array(spline.domain).T
            known &= trim.contains(low + np.stack([u, v], axis=1) * (high - low))
        squares[~known] = 0.0
        worst = int(squares.argmax())
        if squares[worst] > largest:
            largest, place = float(squares[worst]), np.array([u[worst], v[worst]])
        total, count = total + float(squares.sum()), count + int(known.sum())
    rms = math.sqrt(total / max(count, 1))
    misfit = Misfit(math.sqrt(largest) / spline.scale, rms / spline.scale, None)
    return Comparison(misfit, None, place, place)


def evaluated(spline: Spline, u: Array, v: Array) -> tuple[Array, Array]:
    """Return points and unnormalized normals (k, 3) of a spline at fractions u, v of its domain."""
    return spline._evaluated(np.stack([u * spline.cells[0], v * spline.cells[1]], axis=1))


def squared_lengths(differences: Array, scale: float) -> Array:
    """Multiply vectors (k, 3) by `scale`, in place; return their squared lengths."""
    differences *= scale
    return np.einsum("ij,ij->i", differences, differences)


def angles_between(vectors: Array, normals: Array) -> Array:
    """Return the angles, in degrees, between vectors and unit normals.

    At a singular point of the spline the vector vanishes, and the angle counts as 90°.
    """
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    scaled = vectors / np.where(largest > 0.0, largest, 1.0)
    sines = np.linalg.norm(np.cross(scaled, normals), axis=1)
    cosines = np.einsum("ij,ij->i", scaled, normals)
    return np.degrees(np.where(largest[:, 0] > 0.0, np.arctan2(sines, cosines), math.pi / 2))


# --- a surface ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Known:
    """Points of a surface, and normals at some of these points.

    `parts` (2, k) are the parameters of the `points` (k, 3), as fractions of the domain. The unit
    `normals` (l, 3) are at the points with the indices `with_normals` (l,).
    """

    parts: Array
    points: Array
    with_normals: Indices
    normals: Array

    def errors(self, spline: Spline) -> tuple[Array, Array]:
        """Return the errors of a spline at the points of the surface.

        They are the squared scaled distances (k,), and the angles (l,) of normals, in degrees.
        """
        points, vectors = evaluated(spline, *self.parts)
        squares = squared_lengths(points - self.points, spline.scale)
        return squares, angles_between(vectors[self.with_normals], self.normals)


@dataclass(frozen=True, eq=False)
class Probe:
    """Values of a surface at test points, with which its splines are compared.

    Attributes
    ----------
    surface : Surface
        The surface.
    known : Known
        Its values at the test points.
    spread : int
        The number of scattered test points, which come last.
    sides : tuple of (int, int)
        The axis and the end of each collapsed side of the domain.
    diagonal, extent, largest : float
        The length of the diagonal of the bounding box of all points, of its longest side, and the
        largest coordinate.

    """

    surface: Surface
    known: Known
    spread: int
    sides: tuple[tuple[int, int], ...]
    diagonal: float
    extent: float
    largest: float

    def compare(self, spline: Spline) -> Comparison:
        """Return the misfit of a spline of the surface.

        The surface is evaluated again around the worst test points, to find narrow maxima.
        """
        squares, angles = self.known.errors(spline)
        rms = math.sqrt(float(squares[len(squares) - self.spread :].mean())) / spline.scale
        worst = np.concatenate([worst_of(squares), self.known.with_normals[worst_of(angles)]])
        near = self._around(self.known.parts[:, worst], spline.cells)
        more = near.errors(spline)
        parts = np.concatenate([self.known.parts, near.parts], axis=1)
        numbers = [self.known.with_normals, near.with_normals + len(squares)]
        squares, angles = (np.concatenate(x) for x in zip((squares, angles), more, strict=True))
        angle = float(angles.max()) if len(angles) else None
        misfit = Misfit(math.sqrt(float(squares.max())) / spline.scale, rms, angle)
        farthest = parts[:, squares.argmax()]
        of_angles = parts[:, np.concatenate(numbers)]
        there = np.where(self._away(of_angles), angles, -1.0)
        if there.max(initial=-1.0) < 0.0:
            return Comparison(misfit, None, farthest, farthest)
        return Comparison(misfit, float(there.max()), farthest, of_angles[:, there.argmax()])

    def _around(self, places: Array, cells: tuple[int, int]) -> Known:
        """Evaluate the surface around test points, within a cell on either side."""
        half = 1.0 / np.array(cells)[:, None]
        low = np.clip(places - half, LONGEST_STEP, 1.0 - LONGEST_STEP)
        high = np.clip(places + half, LONGEST_STEP, 1.0 - LONGEST_STEP)
        around = low[..., None] + (high - low)[..., None] * _even(AROUND)[:, None]
        parts = np.concatenate([around.reshape(2, -1), places], axis=1)
        parts = parts[:, _belonging(self.surface, parts)]
        points = _points(self.surface, parts)
        some = np.arange(0, len(points), EACH_AROUND)
        return _known(self.surface, parts, points, some, (self.extent, self.largest))

    def _away(self, parts: Array) -> Flags:
        """Return a mask of the test points (2, k) that are away from collapsed sides."""
        away = np.ones(parts.shape[1], dtype=np.bool_)
        for axis, end in self.sides:
            away &= (parts[axis] if end == 0 else 1.0 - parts[axis]) > NEXT_TO_POLE
        return away


def probe_of(surface: Surface, cells: tuple[int, int]) -> Probe:
    """Return the values of a surface at test points, to compare splines with them.

    The numbers of `cells` of a spline decide how many test points there are. Raises SurfaceError if
    the surface cannot be evaluated at one of them or, with a trim, is finite at fewer than two.
    """
    counts = FEW if cells[0] * cells[1] < FEW_CELLS else MANY
    parts = _places(counts)
    points = _points(surface, parts)
    finite = points[np.isfinite(points).all(axis=1)]
    if len(finite) < 2:
        raise SurfaceError(
            f"surface {surface.name!r} is finite at {len(finite)} of {len(points):,} places of its "
            "domain; choose a smaller domain around its trim."
        )
    sizes = np.array([np.ptp(x) for x in finite.T])
    extent, largest = float(sizes.max()), float(np.abs(finite).max())
    first = len(points) - counts.spread
    diagonal = float(np.hypot.reduce(sizes))
    lines = points[:first].reshape(2, -1, counts.steps, 3)
    sides = tuple(
        (axis, end)
        for axis, end in ((0, 0), (0, 1), (1, 0), (1, 1))
        if np.hypot.reduce(np.ptp(lines[1 - axis, end], axis=0)) <= COLLAPSED * diagonal
    )
    numbers = _belonging(surface, parts)
    on_line, spread = numbers < first, int((numbers >= first).sum())
    each = np.where(on_line, numbers % EACH_ON_LINES, numbers % EACH_SPREAD)
    some = np.flatnonzero(each == 0)
    known = _known(surface, parts[:, numbers], points[numbers], some, (extent, largest))
    return Probe(surface, known, spread or len(numbers), sides, diagonal, extent, largest)


def variation(
    surface: Surface, spline: Spline, comparison: Comparison, slopes: bool
) -> tuple[float, float]:
    """Return how much the error of a spline varies along u, and along v, where it is largest.

    If cells are too long along u, the error varies along u between the middle and the ends of a
    cell; if cells are too long along v only, the error varies less along u. By default the
    variation is measured where the distance is largest. With `slopes`, it is measured where the
    angle between normals is largest, and divided by the length of the tangent x_u or x_v: errors
    along the shorter tangent turn normals more.
    """
    found, place = [], comparison.steepest if slopes else comparison.farthest
    for axis in (0, 1):
        parts = np.repeat(place[:, None], CROSS, axis=1)
        half = 0.5 / spline.cells[axis]
        middle = min(max(place[axis], half), 1.0 - half)
        parts[axis] = np.linspace(middle - half, middle + half, CROSS)
        points = _points(surface, parts)
        errors = (evaluated(spline, *parts)[0] - points) * spline.scale
        ways = np.linalg.norm(np.diff(points * spline.scale, axis=0), axis=1)
        way = float(ways.sum()) / half if slopes else 1.0
        found.append(float(np.linalg.norm(np.ptp(errors, axis=0))) / (way or 1.0))
    return found[0], found[1]


# --- test points ----------------------------------------------------------------------------------


@cache
def _places(counts: Counts) -> Array:
    """Return test points (2, k) as fractions of the domain: on lines along u and v, and scattered.

    The first two lines along u, and along v, are next to the sides. The number of steps on a line
    is one more than a multiple of EACH_ON_LINES, so that the test points with normals are at other
    positions on the next line.
    """
    along = (np.arange(counts.steps, dtype=np.float64) + GOLDEN) / counts.steps
    numbers = np.arange(1, counts.lines + 1, dtype=np.float64)
    ends, inside = np.array(NEAR_ENDS), numbers * GOLDEN % 1.0
    across = np.concatenate([np.stack([ends, 1.0 - ends], axis=1).ravel(), inside])
    y, x = (array.ravel() for array in np.meshgrid(across, along, indexing="ij"))
    even = _even(counts.spread)
    return np.concatenate([np.stack([x, y]), np.stack([y, x]), even], axis=1)


def _even(count: int) -> Array:
    """Return points (2, k) of a low-discrepancy sequence in the unit square."""
    k = np.arange(1, count + 1, dtype=np.float64)
    return np.stack([k * PLASTIC % 1.0, k * PLASTIC**2 % 1.0])


def worst_of(errors: Array) -> Indices:
    """Return the indices of the WORST largest errors, at most one in each of GROUPS groups."""
    length = max(-(-len(errors) // GROUPS), 1)
    starts = range(0, len(errors), length)
    largest = np.array([k + int(errors[k : k + length].argmax()) for k in starts], dtype=np.int64)
    return largest[np.argsort(errors[largest])[-WORST:]]


# --- the surface ----------------------------------------------------------------------------------


def _points(surface: Surface, parts: Array) -> Array:
    """Return the points of a surface at fractions (2, …) of its domain."""
    return surface.evaluate(*_in_domain(parts, surface.domain))


def _belonging(surface: Surface, parts: Array) -> Indices:
    """Return the indices of the test points inside the trim, or of all if none is inside."""
    if surface.trim is None:
        return np.arange(parts.shape[1])
    inside = surface.trim.contains(np.stack(_in_domain(parts, surface.domain), axis=1))
    return np.flatnonzero(inside if inside.any() else ~inside)


def _known(
    surface: Surface, parts: Array, points: Array, some: Indices, size: tuple[float, float]
) -> Known:
    """Evaluate a surface at test points, with normals at some of them; see `_normals`."""
    normals = _normals(surface, parts[:, some], *size)
    regular = np.isfinite(normals[:, 0])
    return Known(parts, points, some[regular], normals[regular])


def _in_domain(parts: Array, domain: Domain) -> list[Array]:
    """Return parameters u, v from fractions (2, …) of the domain."""
    return [low + (high - low) * part for part, (low, high) in zip(parts, domain, strict=True)]


def _normals(surface: Surface, parts: Array, extent: float, largest: float) -> Array:
    """Return unit normals of a surface by central differences; NaN where they are inaccurate.

    `extent` is the size of the surface, `largest` its largest coordinate.
    """
    rounding = DIFFERENCE * largest
    step = np.cbrt(rounding / extent) if extent > 0.0 else LONGEST_STEP
    step = min(max(float(step), SHORTEST_STEP), LONGEST_STEP)
    around = np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]])
    places = parts[:, None] + step * around[..., None]
    points = _points(surface, places)
    with np.errstate(all="ignore"):
        x_u, x_v = (points[k] - points[k + 1] for k in (0, 2))
        size_u, size_v = (np.abs(x).max(axis=1) for x in (x_u, x_v))
        normals = np.cross(x_u / size_u[:, None], x_v / size_v[:, None])
        lengths = np.linalg.norm(normals, axis=1)
        accurate = rounding / size_u + rounding / size_v < NORMAL_ERROR * lengths
        return np.where(accurate[:, None], normals / lengths[:, None], np.nan)
