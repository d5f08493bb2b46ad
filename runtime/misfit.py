"""The misfit of a spline: its distance from the surface, or from the data, that it approximates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from .domain import Boundary, Domain
from .kernels import spline as kernels
from .spline import Spline
from .surface import Surface

__all__ = ["Misfit", "Probe", "misfit_to_data", "probe_of"]

Array = NDArray[np.float64]

# Places where a spline is compared with its surface, as parts of the domain: values on a line along
# u or v, lines in either direction inside the domain, and places that are spread over all of it.
# A strip of 1 % of the domain has three values of each line that crosses it.
STEPS, LINES, SPREAD = 301, 4, 2048
# The same for a spline of fewer cells than FEW_CELLS: so the surface is evaluated at most twice as
# often as for the fit, and 8,000 times.
FEW_CELLS, FEW_STEPS, FEW_LINES, FEW_SPREAD = 2048, 201, 1, 1024
# Lines more in either direction are this near to the ends: at poles and open sides the spline is
# worst, in the first cell.
NEAR_ENDS = (0.001, 0.005, 0.02)
# Normals are compared at each of so many places: they take four evaluations instead of one.
EACH = 4
# The multiples of irrational numbers are spread evenly, modulo 1: those of 1/g in one dimension, g
# the golden ratio, those of 1/ρ and 1/ρ² in two, ρ³ = ρ + 1 (Roberts' R2 sequence). Parameters of
# fits are rational.
GOLDEN = 0.6180339887498949
PLASTIC = 0.7548776662466927
# Central differences of positions over ± this part of the domain: the error of a direction falls
# with the square of it, and its rounding grows with its inverse. On surfaces that are far from the
# origin, relative to their size, it is the cube root of the rounding.
SHORTEST_STEP, LONGEST_STEP = 2.0**-17, 2.0**-11
# Surface normals with a larger error than this (radians) are left out: at singular points.
NORMAL_ERROR = 1e-4
# Of the difference of two coordinates, relative to the largest: eight roundings.
DIFFERENCE = 2.0**-49
POINTS_AT_A_TIME = 1 << 16


@dataclass(frozen=True, slots=True)
class Misfit:
    """How far a spline is from the surface or the data that it approximates.

    Both are compared at equal parameters. So `distance` bounds the distance of the two surfaces at
    these places from above, and rather well: the spline slides little along the surface.

    Attributes
    ----------
    distance : float
        The largest distance, in L: over thousands of places that the fit did not use, lines of
        hundreds of them among these; over all points of data.
    rms : float
        The root mean square of the distance, in L, over places that are spread evenly over the
        domain of the parameters; over all points of data.
    angle : float or None
        The largest angle, in degrees, between the normals of spline and surface, without the poles
        and singular points themselves; None for data, which have no normals.

    Examples
    --------
    >>> import gaussmap as gm
    >>> misfit = gm.fit("torus", (64, 64)).misfit
    >>> misfit.rms < misfit.distance < 1.1e-5
    True
    >>> f"{misfit.angle:.2f}°"
    '0.03°'
    >>> finer = gm.fit("torus", (128, 128)).misfit  # order 3, and order 2 for normals
    >>> bool(7 < misfit.distance / finer.distance < 9), bool(3.5 < misfit.angle / finer.angle < 4.5)
    (True, True)

    """

    distance: float
    rms: float
    angle: float | None


@dataclass(frozen=True, eq=False)
class Probe:
    """Points and normals of a surface at places, with which splines of it are compared.

    Attributes
    ----------
    parts : (2, k) float64 array
        The places, as parts of the domain.
    points : (k, 3) float64 array
        Points of the surface.
    spread : int
        The number of the last places, which are spread evenly.
    with_normals : (l,) int64 array
        The places with normals.
    normals : (l, 3) float64 array
        Unit normals there.
    diagonal : float
        The length of the diagonal of the bounding box of all points.

    """

    parts: Array
    points: Array
    spread: int
    with_normals: NDArray[np.int64]
    normals: Array
    diagonal: float

    def misfit(self, spline: Spline) -> Misfit:
        """Return the misfit of a spline of the surface."""
        points, vectors = _evaluated(spline, *self.parts)
        squares = _squares(points - self.points, spline.scale)
        distance = math.sqrt(float(squares.max())) / spline.scale
        rms = math.sqrt(float(squares[len(squares) - self.spread :].mean())) / spline.scale
        return Misfit(distance, rms, _largest_angle(vectors[self.with_normals], self.normals))


def probe_of(surface: Surface, cells: tuple[int, int]) -> Probe:
    """Return the places for splines of a surface with so many cells, or more of them.

    Raises SurfaceError if the surface cannot be evaluated there.
    """
    few = cells[0] * cells[1] < FEW_CELLS
    parts, spread = _places(*(FEW_STEPS, FEW_LINES, FEW_SPREAD) if few else (STEPS, LINES, SPREAD))
    points = surface.evaluate(*_in_domain(parts, surface.domain))
    extent = np.array([np.ptp(x) for x in points.T])
    normals = _normals(surface, parts[:, ::EACH], float(np.abs(points).max()), float(extent.max()))
    known = np.isfinite(normals[:, 0])
    chosen = EACH * np.flatnonzero(known)
    return Probe(parts, points, spread, chosen, normals[known], float(np.hypot.reduce(extent)))


def misfit_to_data(spline: Spline, data: Array, boundary: Boundary) -> Misfit:
    """Return the misfit of a spline to a grid of points (m, n, 3); those with NaN do not count."""
    parts = [
        np.arange(count) / (count if "periodic" in ends or "mirrored" in ends else count - 1)
        for count, ends in zip(data.shape, boundary, strict=False)
    ]
    rows = max(POINTS_AT_A_TIME // len(parts[1]), 1)
    largest, total, count = 0.0, 0.0, 0
    for first in range(0, len(parts[0]), rows):
        u, v = np.meshgrid(parts[0][first : first + rows], parts[1], indexing="ij")
        points = _evaluated(spline, u.ravel(), v.ravel())[0]
        squares = _squares(points - data[first : first + rows].reshape(-1, 3), spline.scale)
        known = squares[~np.isnan(squares)]
        largest, total = max(largest, float(known.max(initial=0.0))), total + float(known.sum())
        count += len(known)
    rms = math.sqrt(total / max(count, 1))
    return Misfit(math.sqrt(largest) / spline.scale, rms / spline.scale, None)


# --- places and normals of the surface ------------------------------------------------------------


@cache
def _places(steps: int, lines: int, spread: int) -> tuple[Array, int]:
    """Return places (2, k) as parts of the domain, and how many of them, the last ones, are spread.

    `steps` is one more than a multiple of EACH: normals are at other places on each line.
    """
    along = (np.arange(steps) + GOLDEN) / steps
    ends, inside = np.array(NEAR_ENDS), np.arange(1, lines + 1) * GOLDEN % 1.0
    across = np.concatenate([ends, 1.0 - ends, inside])
    y, x = (array.ravel() for array in np.meshgrid(across, along, indexing="ij"))
    k = np.arange(1, spread + 1)
    even = k * PLASTIC % 1.0, k * PLASTIC**2 % 1.0
    return np.stack([np.concatenate([x, y, even[0]]), np.concatenate([y, x, even[1]])]), spread


def _in_domain(parts: Array, domain: Domain) -> list[Array]:
    """Return parameters u, v from parts (2, …) of the domain."""
    return [low + (high - low) * part for part, (low, high) in zip(parts, domain, strict=True)]


def _normals(surface: Surface, parts: Array, largest: float, extent: float) -> Array:
    """Return unit normals of a surface by central differences; NaN where they are inaccurate.

    `largest` is the largest coordinate, `extent` the size of the surface.
    """
    rounding = DIFFERENCE * largest
    step = np.cbrt(rounding / extent) if extent > 0.0 else LONGEST_STEP
    step = min(max(float(step), SHORTEST_STEP), LONGEST_STEP)
    around = np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]])
    places = parts[:, None] + step * around[..., None]
    points = surface.evaluate(*_in_domain(places, surface.domain))
    with np.errstate(all="ignore"):
        x_u, x_v = (points[k] - points[k + 1] for k in (0, 2))
        size_u, size_v = (np.abs(x).max(axis=1) for x in (x_u, x_v))
        normals = np.cross(x_u / size_u[:, None], x_v / size_v[:, None])
        lengths = np.linalg.norm(normals, axis=1)
        accurate = rounding / size_u + rounding / size_v < NORMAL_ERROR * lengths
        return np.where(accurate[:, None], normals / lengths[:, None], np.nan)


# --- comparison -----------------------------------------------------------------------------------


def _evaluated(spline: Spline, u: Array, v: Array) -> tuple[Array, Array]:
    """Return points and unnormalized normals of a spline at places as parts of the domain."""
    cells = np.stack([u * spline.cells[0], v * spline.cells[1]], axis=1)
    points, normals = np.empty((len(cells), 3)), np.empty((len(cells), 3))
    kernels.evaluate(spline.coefficients, spline.scale, cells, points, normals)
    return points, normals


def _squares(differences: Array, scale: float) -> Array:
    """Return the squares of lengths times `scale`."""
    differences *= scale
    return np.einsum("ij,ij->i", differences, differences)


def _largest_angle(vectors: Array, normals: Array) -> float | None:
    """Return the largest angle, in degrees, between vectors and unit normals.

    Where the spline is singular, its vector vanishes, and every direction is 90° off.
    """
    if not len(normals):
        return None
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    scaled = vectors / np.where(largest > 0.0, largest, 1.0)
    sines = np.linalg.norm(np.cross(scaled, normals), axis=1)
    cosines = np.einsum("ij,ij->i", scaled, normals)
    angles = np.where(largest[:, 0] > 0.0, np.arctan2(sines, cosines), math.pi / 2)
    return math.degrees(float(angles.max()))
