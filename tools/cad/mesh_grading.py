"""Sizes that grow slowly from the edges of a part into its faces, for well-shaped triangles.

An edge is as fine as the finest adjacent face requires. A plane beside a fillet would have long
triangles at their common edge if its vertices followed its own curvature only.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.trees import tree_of
from ..density.along_borders import BorderLines
from ..density.cells import Cells, grouped, merged
from .edge_sampling import step_of
from .mesh_edges import MeshEdges
from .results import PartSpace

if TYPE_CHECKING:
    from scipy.spatial import KDTree

__all__ = ["graded"]

# The size grows by at most this much for each unit of distance from an edge.
GROWTH = 0.55
# Cells are halved until the sizes in each differ by about this fraction of the smallest.
UNEVEN = 0.5


@dataclass(frozen=True, eq=False)
class Sources:
    """Prescribed sizes at tree nodes; the last, inf, is for queries with no node within `reach`.

    At other points the size is that of the nearest node plus `growth` times its distance. Beyond
    `reach` of all nodes it is too large to matter.
    """

    tree: KDTree
    sizes: Array
    growth: float
    reach: float

    def sizes_at(self, points: Array, reach: float) -> Array:
        """Return bounds (M,) of the size at points (M, 3); inf with no node within `reach`."""
        distances, rows = self.tree.query(points, distance_upper_bound=reach)
        return self.sizes[rows] + self.growth * distances


@dataclass(frozen=True, eq=False)
class GradedSpace(PartSpace):
    """A space whose sizes are bounded by the `sources` of each piece that has some.

    Sizes are 1/√w, where w is the target density.
    """

    sources: Mapping[int, Sources] = field(default_factory=dict)

    def known(self, cells: Cells, *, keep: bool = False) -> Cells:
        """Return the value of `Space.known`, graded."""
        found = super().known(cells, keep=keep)
        self.grade(found.pieces, found.rows)
        return found

    def grade(self, pieces: Indices, rows: Array, *, far: bool = False) -> Array:
        """Raise densities in rows (M, 8) of pieces (M,); return bounds (M,) of the size.

        Bounds that are too large to matter are inf, unless `far`.
        """
        sizes = np.full(len(rows), np.inf)
        for k, here in grouped(pieces):
            if sources := self.sources.get(k):
                sizes[here] = sources.sizes_at(rows[here, :3], math.inf if far else sources.reach)
        rows[:, 6] = np.maximum(rows[:, 6], np.minimum(sizes**-2.0, self.target.ceiling))
        return sizes


def graded(edges: MeshEdges, count: int) -> PartSpace:
    """Return the space of edges, with sizes that grow slowly from their steps in a mesh.

    Steps that are hardly smaller than the largest size of the face do not change it.
    """
    space, sampled = edges.space, edges.sampled(count)
    step, points = step_of(space, count), space.scaled_points(sampled.points)
    largest, sources = np.zeros(len(space.pieces)), dict[int, Sources]()
    np.maximum.at(largest, space.first.pieces, space.densities**-0.5)
    for k, sides in grouped(edges.pieces):
        most = float(largest[k])
        lines = [sampled.numbers[x] for x in np.unique(edges.owner[sides]).tolist()]
        ends = np.concatenate([np.stack([x[:-1], x[1:]], axis=1) for x in lines])
        sizes = np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1) / step
        small = (sizes > 0.0) & (sizes < (1.0 - GROWTH) * most)
        if small.any():
            tree, sizes = tree_of(points[ends[small]].mean(axis=1)), sizes[small]
            reach = (most - sizes.min()) * step / GROWTH
            sources[k] = Sources(tree, np.append(sizes, np.inf), GROWTH / step, reach)
    if not sources:
        return space
    made = GradedSpace(
        space.label, space.pieces, space.target, space.threads, space.developable,
        failed=space.failed, sources=sources,
    )  # fmt: skip
    made._held.update(borders=_borders(made, space.borders), first=_first(made, space.first))
    return made


def _borders(space: GradedSpace, lines: BorderLines) -> BorderLines:
    """Return the boundaries of a space, graded."""
    lines = replace(lines, rows=lines.rows.copy())
    space.grade(np.repeat(lines.pieces, np.diff(lines.starts)), lines.rows)
    return lines


def _first(space: GradedSpace, first: Cells) -> Cells:
    """Return the first cells of a space, graded, and halved until sizes are even in each."""
    cells, done, bare = replace(first, rows=first.rows.copy()), list[Cells](), space.between(0.0)
    growth = np.zeros(len(space.pieces))
    for k, sources in space.sources.items():
        growth[k] = sources.growth
    while len(cells):
        bounds = space.grade(cells.pieces, cells.rows, far=True)
        sizes = np.clip(cells.rows[:, 6], space.target.floor, space.target.ceiling) ** -0.5
        change = growth[cells.pieces] * cells.radii
        uneven = (change > UNEVEN * sizes) & (bounds - change < sizes) & ~space.deepest(cells)
        done.append(cells[~uneven])
        cells = bare.halves(cells[uneven])
    return merged(done)
