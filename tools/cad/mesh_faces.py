"""The triangles of one face of a part, between vertices on its edges and in its interior."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...runtime.base.aliases import Array, Indices
from ...runtime.base.extras import from_extra
from .face_pieces import FacePiece
from .mesh_edges import SampledEdges

# Shapely's constrained triangulations have no interior points; SciPy's have no constraints; the
# library `triangle` is not free for all uses. The predicates of pythoncdt are exact.
EXTRA = "pythoncdt", "mesh", "a mesh of a CAD part"
# Parameter pairs closer than this, relative to the face, count as equal.
SAME = 1e-11


class Crossing(Exception):  # noqa: N818 - a finding, not an error
    """The boundary of a face crosses itself, or encloses nothing.

    `face` is the index of the face, −1 if it is not known.
    """

    face = -1


@dataclass(frozen=True, eq=False)
class FaceBorder:
    """The boundary of a face: positions `uv` (k, 2), and their vertex indices `numbers` (k,).

    `segments` (k, 2) are pairs of indices of positions, and `edges` (k,) the indices of the edges
    of the part that contain the segments.
    """

    uv: Array
    numbers: Indices
    segments: Indices
    edges: Indices

    @classmethod
    def of(cls, piece: FacePiece, sampled: SampledEdges) -> FaceBorder:
        """Return the boundary of a piece whose wires are known."""
        uv, numbers, segments, edges, first = [], [], [], [], 0
        for wire in piece.face.wires:
            start = first
            for side, backwards in wire:
                edge = sampled.edges[side]
                way = slice(None, None, -1 if backwards else 1)
                uv.append(sampled.uv[side][way][:-1])
                numbers.append(sampled.numbers[edge][way][:-1])
                edges.append(np.full(len(uv[-1]), edge))
                first += len(uv[-1])
            around = np.arange(start, first)
            segments.append(np.stack([around, np.roll(around, -1)], axis=1))
        low, high = np.array(piece.domain).T
        places = np.clip(np.concatenate(uv), low, high)
        return cls(places, np.concatenate(numbers), np.concatenate(segments), np.concatenate(edges))


def triangles_of(border: FaceBorder, places: Array) -> tuple[Indices, Indices]:
    """Return triangles (k, 3), as indices of positions (n, 2) in a plane, inside a boundary.

    The positions on the boundary come first. Triangles run counterclockwise. Also return the
    constrained segments (m, 2). Of equal positions, only the first is a vertex. Raises Crossing if
    the boundary crosses itself, or encloses nothing.
    """
    cdt = from_extra(*EXTRA)
    low = places.min(axis=0)
    size = float(np.ptp(places, axis=0).max())
    keys = np.round((places - low) / (SAME * size))
    # Complex numbers are sorted much faster than rows.
    _, firsts, same = np.unique(keys @ [1.0, 1.0j], return_index=True, return_inverse=True)
    order = np.argsort(firsts)  # vertices in the order of their first positions
    firsts, rank = firsts[order], np.argsort(order)
    segments = np.sort(rank[same[border.segments]], axis=1)
    segments = segments[segments[:, 0] != segments[:, 1]] @ [len(firsts), 1]
    segments = np.stack(np.divmod(np.unique(segments), len(firsts)), axis=1)
    made = cdt.Triangulation(
        cdt.VertexInsertionOrder.AUTO, cdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
    )
    try:
        made.insert_vertices(np.ascontiguousarray(places[firsts] - low))
        made.insert_edges(segments.astype(np.uint32))
        made.erase_outer_triangles_and_holes()
    except RuntimeError as error:
        raise Crossing("the border crosses itself") from error
    found = np.asarray(made.triangles_array()["vertices"]).astype(np.int64).reshape(-1, 3)
    if not len(found):
        raise Crossing("the border has nothing inside")
    return firsts[found], firsts[segments]
