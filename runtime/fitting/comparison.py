"""The misfit of a spline: its distance from the surface, or from the data, that it approximates."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..base.aliases import Array
from ..domain.domain import Boundary, cells_between
from ..spline.misfit import Misfit
from ..spline.spline import Spline

__all__ = [
    "Comparison",
    "angles_between",
    "compare_with_data",
    "evaluated",
    "squared_lengths",
]


POINTS_AT_A_TIME = 1 << 16


@dataclass(frozen=True, eq=False)
class Comparison:
    """A misfit, with the parameters where it is largest.

    Attributes
    ----------
    misfit : Misfit
        The misfit of a spline.
    angle_away : float or None
        The largest angle away from collapsed sides of the domain, such as poles: next to these it
        falls only slowly with the size of the cells.
    farthest, steepest : (2,) float64 array
        The parameters, as fractions of the domain, of the largest distance, and of the largest
        angle (of `angle_away` if that is known).

    """

    misfit: Misfit
    angle_away: float | None
    farthest: Array
    steepest: Array


def compare_with_data(spline: Spline, data: Array, boundary: Boundary) -> Comparison:
    """Return the misfit of a spline to a grid of points (m, n, 3); those with NaN do not count."""
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
        squares[~known] = 0.0
        worst = int(squares.argmax())
        if squares[worst] > largest:
            largest, place = float(squares[worst]), np.array([u[worst], v[worst]])
        total, count = total + float(squares.sum()), count + int(known.sum())
    rms = math.sqrt(total / max(count, 1))
    misfit = Misfit(math.sqrt(largest) / spline.scale, rms / spline.scale, None)
    return Comparison(misfit, None, place, place)


def evaluated(spline: Spline, u: Array, v: Array) -> tuple[Array, Array]:
    """Return points and unnormalized normals of a spline at fractions of the domain."""
    return spline._evaluated(np.stack([u * spline.cells[0], v * spline.cells[1]], axis=1))


def squared_lengths(differences: Array, scale: float) -> Array:
    """Return the squares of lengths times `scale`."""
    differences *= scale
    return np.einsum("ij,ij->i", differences, differences)


def angles_between(vectors: Array, normals: Array) -> Array:
    """Return the angles, in degrees, between vectors and unit normals.

    At a singular point of the spline its vector vanishes, and the angle counts as 90°.
    """
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    scaled = vectors / np.where(largest > 0.0, largest, 1.0)
    sines = np.linalg.norm(np.cross(scaled, normals), axis=1)
    cosines = np.einsum("ij,ij->i", scaled, normals)
    return np.degrees(np.where(largest[:, 0] > 0.0, np.arctan2(sines, cosines), math.pi / 2))
