"""The normals for a requested number of samples: a Fibonacci lattice around the mean normal."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...runtime.directions.regions import Reach
from ...runtime.directions.sets import part_of_fibonacci, spiral_angle
from ...runtime.directions.unit import in_pieces, perpendicular
from ...runtime.search.kernels.pieces import least_cosine
from ...runtime.spline.nets import AnySpline, NetSpline


@dataclass(frozen=True, eq=False)
class Lattice:
    """A Fibonacci lattice on the cap of directions n with n · `axis` ≥ `cosine`.

    Caps larger than a hemisphere are replaced by the whole sphere around +z.
    """

    axis: NDArray[np.float64]
    cosine: float

    @classmethod
    def around(cls, spline: AnySpline, reach: Reach | None = None) -> Lattice:
        """Return the lattice on the smallest cap around the mean normal that contains every normal.

        If the smallest of the caps of a `reach` is smaller, the lattice is on that cap.
        """
        found = cls._around_all(spline)
        if reach is not None and (cap := reach._smallest).angle < 90.0:
            cosine = math.cos(math.radians(cap.angle)) - 1e-12
            return cls(cap.axis, cosine) if cosine > found.cosine else found
        return found

    @classmethod
    def _around_all(cls, spline: AnySpline) -> Lattice:
        if isinstance(spline, NetSpline):
            axis, cosine = spline.cap
            return cls(axis, cosine - 1e-12) if cosine > 0.0 else cls.everywhere()
        u, v = (
            low + (high - low) * (np.arange(count) + 0.5) / count
            for (low, high), count in zip(spline.domain, spline.cells, strict=True)
        )
        mean = np.nansum(spline.normals(u[:, None], v), axis=(0, 1))
        length = float(np.linalg.norm(mean))
        if length > 0.0:
            axis = mean / length
            cosine = least_cosine(spline.coefficients, spline.scale, axis)
            if cosine > 0.0:
                return cls(axis, cosine - 1e-12)
        return cls.everywhere()

    @classmethod
    def everywhere(cls) -> Lattice:
        """Return the lattice on the whole sphere."""
        return cls(np.array([0.0, 0.0, 1.0]), -1.0)

    @property
    def solid_angle(self) -> float:
        """The solid angle of the cap."""
        return 2 * math.pi * (1.0 - self.cosine)

    def density_of(self, count: int) -> float:
        """Return the density, in normals per steradian, at which the cap holds `count` normals."""
        return count / self.solid_angle

    def size(self, density: float) -> int:
        """Return the number of normals for a `density` per steradian."""
        if self.cosine == -1.0:
            return max(1, round(4 * math.pi * density))
        return max(1, math.floor(max(density, self.density_of(1)) * self.solid_angle))

    def normals(
        self, density: float, first: int = 0, last: int | None = None, threads: int | None = None
    ) -> NDArray[np.float64]:
        """Return unit normals (N, 3), `density` of them per steradian, but at least one.

        With `first` and `last`, return only the rows [first, last).
        """
        last = self.size(density) if last is None else last
        if self.cosine == -1.0:
            return part_of_fibonacci(self.size(density), first, last, threads)
        density = max(density, self.density_of(1))
        across, along = perpendicular(self.axis)

        def rows(begin: int, end: int) -> NDArray[np.float64]:
            k = np.arange(begin, end)
            depth = (k + 0.5) / (2 * math.pi * density)  # 1 − cosine to the axis
            angle = spiral_angle(k)
            radius = np.sqrt(np.maximum(depth * (2.0 - depth), 0.0))
            vectors = (1.0 - depth)[:, None] * self.axis
            vectors += (radius * np.cos(angle))[:, None] * across
            vectors += (radius * np.sin(angle))[:, None] * along
            return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)

        return in_pieces(rows, first, last, threads)
