"""Sizes of triangles that grow slowly from the edges of a part into its faces.

An edge is as fine as the finest adjacent face requires. Without grading, a plane beside a fillet
would therefore have badly shaped, long triangles at their common edge.
"""

import numpy as np

from ...runtime.base.trees import tree_of
from ..density.cells import Cells, grouped, merged
from ..density.grading import Sources
from .edge_sampling import step_of
from .mesh_edges import MeshEdges
from .results import PartSpace

# The size grows by at most this much per unit of distance from an edge.
GROWTH = 0.55
# Cells are halved until the sizes in a cell differ by about this fraction of its smallest size.
UNEVEN = 0.5


def graded(edges: MeshEdges) -> PartSpace:
    """Return the space of `edges` with sizes that grow slowly from the edges into the faces.

    At an edge, the size is the length of its segments in a mesh. Segments longer than 1 − GROWTH
    times the largest size on a face do not change the sizes on that face.
    """
    space, sampled = edges.space, edges.sampled()
    step, points = step_of(space, edges.spacing.count), space.scaled_points(sampled.points)
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
    made = space.with_sources(sources)
    made._held["first"] = _halved(made, made.first)
    return made


def _halved(space: PartSpace, cells: Cells) -> Cells:
    """Return the graded initial cells of a space, halved until sizes vary little in each cell."""
    done, bare = list[Cells](), space.between(0.0)
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
