"""Normals sorted by direction into bins, so that neighbouring normals are close in memory."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...generated.icosahedron import FRAMES, STRETCHES
from ..base.memory import check_memory
from ..base.threads import over_ranges, thread_count
from ..directions.sets import PARTS, PARTS_AT_A_TIME
from ..directions.unit import perpendicular
from ..kernels import bins as kernels
from ..kernels.icosphere import is_icosphere, new_line
from ..kernels.runs import MOST_FREQUENT
from ..kernels.strips import Polyhedron

__all__ = ["NormalBins", "icosahedron", "sorted_normals"]

# On average, for speed only: samples do not depend on it.
NORMALS_PER_BIN = 2
# The least and the largest number of squares along an edge: few normals may be close together.
COARSEST, FINEST = 32, 2048
# The least number of normals for each thread that sorts them, and the largest number of threads.
FEWEST_NORMALS, MOST_COUNTS = 1 << 16, 8
# The least radius of a cap of normals, as the tangent of half its opening angle.
NARROWEST = 2.0**-20
# The least height of a unit vector on a face of the cube, 1/√3, and of the icosahedron, that of a
# corner, both rounded down. Vectors in a cone with an angle θ of at most 37° are not farther from
# its axis than 2 sin(θ/2) < 1.1 sin θ.
CUBE_HEIGHT, ICOSAHEDRON_HEIGHT, SLOPE = 0.577, 0.525, 1.1


def icosahedron(frequency: int) -> Polyhedron:
    """Return the icosahedron with the points of `icosphere`."""
    stretch = float(STRETCHES.max())
    return Polyhedron(FRAMES, stretch, frequency, float(frequency), ICOSAHEDRON_HEIGHT, SLOPE, 1.0)


@dataclass(frozen=True, eq=False)
class NormalBins:
    """Unit normals (S, 3), sorted into the squares of a grid on a cube around the sphere.

    If all normals lie in a cap, a linear map first spreads the cap over a face of the cube.
    The points of an icosphere need no bins: their positions follow from their numbers.
    """

    normals: NDArray[np.float64]
    threads: int | None = None

    @cached_property
    def frequency(self) -> int:
        """The frequency of `icosphere` if the normals equal its points bit for bit, else 0."""
        frequency = math.isqrt(max(len(self.normals) - 2, 0) // 10)
        known = 0 < frequency <= MOST_FREQUENT
        if not known or 10 * frequency**2 + 2 != len(self.normals):
            return 0

        def work(first: int, last: int) -> bool:
            return is_icosphere(self.normals, frequency, first, last, *new_line())

        threads = 1 if len(self.normals) < FEWEST_NORMALS else self.threads
        return frequency if all(over_ranges(work, PARTS, PARTS_AT_A_TIME, threads)) else 0

    @cached_property
    def frame(self) -> NDArray[np.float64]:
        """The linear map (3, 3) of a cap to a face; the identity if the normals fill no cap."""
        mean = self._sum() / len(self.normals)
        length = float(np.linalg.norm(mean))
        if length < 0.8:
            return np.eye(3)
        axis = mean / length
        across, along = perpendicular(axis)
        directions = np.stack([across, along, axis])
        x, y, z = directions @ self.normals.T
        if not (z > 0.5).all():
            return np.eye(3)
        tangent = max(float(np.hypot(x, y).max() / z.min()), NARROWEST)
        return directions / [[tangent], [tangent], [1.0]] if tangent < 0.8 else np.eye(3)

    def _sum(self) -> NDArray[np.float64]:
        """Return the sum (3,) of all normals, in an order that is independent of the threads."""
        parts = over_ranges(
            lambda first, last: np.ones(last - first) @ self.normals[first:last],
            len(self.normals), FEWEST_NORMALS, self.threads,
        )  # fmt: skip
        return np.sum(list(parts), axis=0)

    @cached_property
    def stretch(self) -> float:
        """The norm of the frame: its longest row."""
        return float(np.linalg.norm(self.frame, axis=1).max())

    @property
    def faces(self) -> int:
        """The number of faces of the cube with normals."""
        return 6 if self.stretch < 1.1 else 1

    @cached_property
    def grid(self) -> int:
        """The number of squares along an edge of the cube."""
        grid = round(math.sqrt(len(self.normals) / (self.faces * NORMALS_PER_BIN)))
        return max(COARSEST, min(grid, FINEST))

    @cached_property
    def cube(self) -> Polyhedron:
        """The six faces of the cube, in the order +x, −x, +y, −y, +z, −z."""
        x, y, z = self.frame
        frames = np.array([[y, z, x], [y, z, -x], [z, x, y], [z, x, -y], [x, y, z], [x, y, -z]])
        least = CUBE_HEIGHT if self.faces == 6 else -math.inf
        density = len(self.normals) / (self.faces * self.grid**2)
        return Polyhedron(frames, self.stretch, self.grid, 2.0 * self.grid, least, SLOPE, density)

    @cached_property
    def sorted(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The starts of bins (B + 1,); normals and their numbers (S, 4), in the order of bins."""
        check_memory("search", len(self.normals))
        return sorted_normals(self.normals, self.frame, self.grid, self.threads)


def sorted_normals(
    normals: NDArray[np.float64], frame: NDArray[np.float64], grid: int, threads: int | None
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the starts of bins (6 grid² + 1,); normals and their numbers (S, 4), in their order.

    The bins are those of a linear map (3, 3), the frame, on the faces of a cube.
    """
    total, count = len(normals), 6 * grid**2
    size = max(FEWEST_NORMALS, -(-total // min(thread_count(threads), MOST_COUNTS)))
    bins = np.empty(total, dtype=np.int32)
    counts = np.empty((-(-total // size), count), dtype=np.int64)
    starts, ordered = np.empty(count + 1, dtype=np.int64), np.empty((total, 4))

    def count_bins(first: int, last: int) -> None:
        kernels.count_bins(normals, frame, grid, first, last, bins, counts[first // size])

    def place(first: int, last: int) -> None:
        kernels.place_normals(normals, bins, first, last, counts[first // size], ordered)

    list(over_ranges(count_bins, total, size, threads))
    kernels.start_bins(counts, starts)
    list(over_ranges(place, total, size, threads))
    return starts, ordered
