"""Discrete Voronoi cells of samples, on points finer than the candidates."""

import numpy as np

from ...runtime.base.aliases import Array, Indices
from .candidates import Block, Candidates
from .cells import Cells, Sides
from .kernels import voronoi as kernels
from .kernels.cells import FINER

Bounds = tuple[float, float, float]
# The number of centres that are searched at a time.
AT_ONCE = 1 << 12


class Voronoi:
    """The sample nearest to each point of a fine grid in the cells of candidates.

    Cell k belongs to candidate k. The fine points of a cell are defined in kernels/voronoi.py; they
    are linear in the parameters; in cells that a boundary intersects, only the place of the cell
    counts. For a candidate, the samples (N, 6) within radius/√w are considered, and some samples
    near them.
    """

    def __init__(
        self, candidates: Candidates, cells: Cells, sides: Sides, samples: Array, radius: float
    ) -> None:
        self._cells, self._each, parts = cells, candidates.each, candidates.parts
        samples = np.ascontiguousarray(samples)
        self._parts = self._each(lambda k: _Part(parts[k], sides, samples, radius), len(parts))

    def centres(self, samples: Array, first: int) -> tuple[Indices, Indices, Array]:
        """Return the indices (k,) of samples that move to the centres of their Voronoi cells.

        Samples before index `first` do not move. Also return the positions of the centres: the
        indices (k,) of cells of candidates, and parameters (k, 2).
        """
        parts, moments = self._parts, np.zeros((len(samples), 4))
        sums = self._each(lambda k: parts[k].moments(samples), len(parts))
        for part, own in zip(parts, sums, strict=True):
            moments[part.near] += own
        free = moments[:, 3] > 0.0
        free[:first] = False
        centres, squares = samples.copy(), np.where(free, np.inf, 0.0)
        centres[free, :3] = moments[free, :3] / moments[free, 3:]
        rows, steps = np.full(len(samples), -1), np.zeros((len(samples), 2))

        def search(k: int) -> None:
            some = [x[k * AT_ONCE : (k + 1) * AT_ONCE] for x in (centres, squares, rows, steps)]
            for part in parts:
                kernels.find_centres(part.grids, part.lists.sides, part.order, *some)

        self._each(search, -(-len(samples) // AT_ONCE))
        moved = np.flatnonzero(rows >= 0)
        return moved, rows[moved], self._parameters(rows[moved], steps[moved])

    def widest(self, samples: Array, bounds: Bounds) -> tuple[Indices, Array, Array]:
        """Return the indices (k,) of the cells with a point at least least/√w from all samples.

        Also return the parameters (k, 2) of the farthest point of each of these cells, and the gaps
        (k, 2): w, and w times the squared distance of this point. `find_widest` explains `bounds`,
        and where angles replace distances.
        """
        parts = self._parts
        found = self._each(lambda k: parts[k].widest(samples, bounds), len(parts))
        rows, numbers, gaps = (np.concatenate(x) for x in zip(*found, strict=True))
        steps = (np.stack(np.divmod(numbers, FINER), axis=1) + 0.5) / FINER - 0.5
        return rows, self._parameters(rows, np.where(numbers[:, None] < 0, 0.0, steps)), gaps

    def _parameters(self, rows: Indices, steps: Array) -> Array:
        """Return the parameters (k, 2) of points in the cells with the indices `rows` (k,).

        `steps` (k, 2) are the coordinates of the points in their cells, from −1/2 to 1/2.
        """
        cells = self._cells
        boxes, steps = cells.boxes[rows], np.where(cells.whole[rows, None], steps, 0.0)
        return cells.places[rows] + steps * (boxes[:, 2:] - boxes[:, :2])


class _Part:
    """The samples near a part of the candidates: `near` (n,) are their indices."""

    def __init__(self, part: Block, sides: Sides, samples: Array, radius: float) -> None:
        self.grids, self.order, sides = part.grids, part.order, sides[part.order]
        counts, near = np.zeros(len(part.grids.starts), np.int32), np.empty(len(samples), np.int32)
        last, entries = np.full(len(counts) - 1, -1, dtype=np.int32), np.empty(0, dtype=np.int32)
        lists = kernels.Lists(sides, counts[1:], entries, last)
        self.near = near[: kernels.list_samples(part.grids, lists, radius, samples, near)].copy()
        starts, longest = np.cumsum(counts, dtype=np.int32), int(counts.max())
        entries, last[:] = np.empty(starts[-1], dtype=np.int32), -1
        lists = kernels.Lists(sides, starts[:-1].copy(), entries, last)
        kernels.list_samples(part.grids, lists, radius, samples, near)
        self.lists = kernels.Lists(sides, starts, entries, last)
        numbers, squares = np.empty(longest, np.int32), np.empty(longest + 1, np.float32)
        self._room = kernels.Room(
            np.empty((6, longest), np.float32), squares, squares.view(np.int32), numbers,
            np.empty((longest, 4)), np.empty(FINER**2, np.float32), np.zeros(FINER**2, np.int32),
        )  # fmt: skip

    def moments(self, samples: Array) -> Array:
        """Return the moments (n, 4) of the Voronoi cells of `near`, given all samples (N, 6)."""
        moments = np.zeros((len(self.near), 4))
        kernels.add_moments(self.grids, self.lists, samples[self.near], self._room, moments)
        return moments

    def widest(self, samples: Array, bounds: Bounds) -> tuple[Indices, Indices, Array]:
        """Return rows of candidates, indices of fine points, and gaps; see `Voronoi.widest`."""
        found, gaps = np.empty(len(self.order), np.int64), np.empty((len(self.order), 2))
        near, room = samples[self.near], self._room
        kernels.find_widest(self.grids, self.lists, near, bounds, room, found, gaps)
        far = np.flatnonzero(found > -2)
        return self.order[far].astype(np.int64), found[far], gaps[far]
