"""The coverage: the largest distance of a point of the surface from the nearest sample."""

import math

import numpy as np

from ...runtime.base.aliases import Array
from ...runtime.base.threads import thread_count
from ...runtime.base.trees import tree_of
from .candidates import Candidates
from .kernels.greedy import SAME_SIDE
from .space import Space

# The search ends when the bound is within the factor TIGHT of the largest distance found, or after
# MOST_CUTS rounds.
TIGHT = 1.1
MOST_CUTS = 40
# Along boundaries, distances are measured at steps of this part of the mean spacing of samples.
ON_BORDERS = 0.025


def coverage(space: Space, samples: Array, asked: float = math.inf) -> float:
    """Return a bound of the distance from any point of the surface to the nearest sample.

    Samples are points (N, 3), or points and unit normals (N, 6). With normals, only samples on the
    same side of the surface count for a point, judged by the normal at the place of its cell; if
    there is no such sample, all samples count.

    Points and the distance are scaled as in `Space`. The method is branch and bound: a cell is cut
    if it may contain a point farther than a limit from all samples. Let d be the largest distance
    of a place from the nearest sample. The limit is the requested coverage `asked` if d ≤ asked <
    TIGHT d, otherwise TIGHT d. If the cells are on a spline and the samples on the surface, twice
    the distance between spline and surface is added. The bound is infinite if there are no samples.
    """
    if len(samples) == 0:
        return math.inf
    apart, space = 2.0 * space.distance * space.unit, space.uniform
    asked -= apart
    distances_of = _Distances(space, samples)
    spacing = math.sqrt(space.area / len(samples)) or 1.0
    cells, borders = space.cut(spacing), space.along_borders(ON_BORDERS * spacing)
    largest = found = float(distances_of(borders.rows).max(initial=0.0))
    widest = 0.0
    for _ in range(MOST_CUTS):
        distances = distances_of(cells.rows)
        bounds, found = distances + cells.radii, max(found, float(distances.max(initial=0.0)))
        far = bounds > (asked if found <= asked < TIGHT * found else TIGHT * found)
        largest = max(largest, float(bounds[~far].max(initial=0.0)))
        if not far.any():
            break
        widest, cells = float(bounds.max()), space.halves(space.halves(cells[far]))
    else:
        largest = max(largest, widest)
    return apart + largest


class _Distances:
    """Distances from the nearest samples: points (N, 3), or points with normals (N, 6)."""

    def __init__(self, space: Space, samples: Array) -> None:
        self.space, self.samples = space, samples
        self.tree = tree_of(np.ascontiguousarray(samples[:, :3]))

    def __call__(self, rows: Array) -> Array:
        """Return the distances (M,) of the points in rows (M, 8) of cells from samples."""
        workers = thread_count(self.space.threads)
        distances, nearest = self.tree.query(rows[:, :3], workers=workers)
        if self.samples.shape[1] == 3:
            return distances
        normals = rows[:, 3:6]
        cosines = np.einsum("mx,mx->m", normals, self.samples[nearest, 3:])
        left = np.flatnonzero((cosines < SAME_SIDE) & normals.any(axis=1))
        # For these points, the nearest sample is on the other side of a wall or of an edge.
        radius = math.sqrt(self.space.area / len(self.samples)) or 1.0
        while len(left) and radius < 2.0 * self.space.size:
            candidates = Candidates(rows[left], radius, self.space.threads)
            candidates.update_distances(self.samples, radius)
            found = candidates.distances
            near = found <= radius
            distances[left[near]] = found[near]
            left, radius = left[~near], 2.0 * radius
        return distances
