"""Edges and vertices of a part in a mesh: sampled once, for all adjacent faces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ..density.cells import grouped
from .edges import at_places
from .faces import own_parameters
from .mesh_spacing import Spacing, least_enough
from .part import Face
from .results import PartSpace

# The spacing along an edge is measured in this many steps of equal length in its parameter.
PLACES = 64
# The least number of steps of a closed edge.
CLOSED = 3
# The ends of an edge without vertices in the file count as one point if they are closer than this,
# relative to the size of the part.
SAME = 1e-7


@dataclass(frozen=True, eq=False)
class SampledEdges:
    """The vertices of a mesh on edges of a part: `points` (M, 3), in the unit L of the part.

    `numbers` and `shares` give, by index of an edge, the indices of its vertices and their
    positions in [0, 1]. `uv` and `edges` give, by index of a side of an edge, the parameters (k, 2)
    of the same vertices on the face of this side, in the direction of the edge, and the index of
    the edge.
    """

    points: Array
    numbers: dict[int, Indices]
    shares: dict[int, Array]
    uv: dict[int, Array]
    edges: dict[int, int]


@dataclass(eq=False)
class MeshEdges:
    """All edges around the pieces of a space, and their division into steps.

    `sides` (S,) are indices of sides of edges in the part, `owner` (S,) the indices of their edges,
    and `pieces` (S,) the indices of their pieces. `more` are the positions in [0, 1] of additional
    vertices, by index of the edge.
    """

    spacing: Spacing
    sides: Indices
    owner: Indices
    pieces: Indices
    more: dict[int, Array]

    @classmethod
    def of(cls, spacing: Spacing) -> MeshEdges:
        """Return the edges that have known parameters on a piece."""
        space = spacing.space
        arrays = space.part.arrays
        edges = len(arrays["edge_vertices"])
        owner = np.repeat(np.arange(edges), np.diff(arrays["edge_side_starts"]))
        piece_of = np.full(len(arrays["area"]), -1)
        piece_of[[x.face.index for x in space.pieces]] = np.arange(len(space.pieces))
        pieces = piece_of[arrays["side_faces"]]
        counts = np.diff(arrays["side_point_starts"])
        rows = np.repeat(np.arange(len(counts)), counts)
        finite = np.isfinite(arrays["side_points"]).all(axis=1)
        known = np.bincount(rows, finite, len(counts)) == counts
        in_wire = np.isin(np.arange(len(owner)), arrays["wire_sides"])
        sides = np.flatnonzero((pieces >= 0) & known & (counts >= 2) & in_wire)
        sides = sides[np.argsort(pieces[sides], kind="stable")]
        return cls(spacing, sides, owner[sides], pieces[sides], {})

    @property
    def space(self) -> PartSpace:
        """The space whose pieces are meshed."""
        return self.spacing.space

    @property
    def arrays(self) -> dict[str, Indices]:
        """The arrays of the part."""
        return self.space.part.arrays

    def is_known(self, face: Face) -> bool:
        """Return whether a face has wires, and known parameters along all their edges."""
        sides = [side for wire in face.wires for side, _ in wire]
        return bool(sides) and bool(np.isin(sides, self.sides).all())

    # --- numbers of vertices ----------------------------------------------------------------------

    @property
    def least(self) -> int:
        """The least number of vertices on edges that a mesh can have."""
        return self._count(self._steps(math.inf))

    def _count(self, steps: Indices) -> int:
        """Return the number of vertices on edges that have `steps` (E,) steps."""
        more = sum(map(len, self.more.values()))
        return len(self._vertices[0]) + int((steps - 1)[self._divided].sum()) + more

    @cached_property
    def _divided(self) -> Flags:
        """A mask of the edges (E,) that may have vertices between their ends."""
        return self.used & (self.arrays["edge_degenerate"] == 0)

    def _steps_for_count(self) -> Indices:
        """Return the numbers of steps (E,) of edges in a mesh; see `sampled`.

        The step length is the smallest one that leaves enough vertices for the interior of faces.
        If no face needs interior vertices, all vertices are on edges: edges with the longest steps
        get further steps.
        """
        costs, count = self._costs[:, -1], self.spacing.count
        low = max(self.spacing.smallest_step, costs.sum() / (count + len(costs)))
        steps = self._steps(low) if low > 0.0 else self._steps(math.inf)
        if low > 0.0 and self._total(steps, low) > count:
            step = least_enough(
                lambda x: self._total(self._steps(x), x) <= count, low, max(costs.max(), low)
            )
            steps = self._steps(step)
            steps = steps if self._count(steps) <= count else self._steps(math.inf)
        if len(self.spacing.covered[1]):
            return steps
        at = np.flatnonzero(self._divided)
        for _ in range(count - self._count(steps)):
            steps[at[np.argmax(costs[at] / steps[at])]] += 1
        return steps

    def _total(self, steps: Indices, step: float) -> float:
        """Return the number of all vertices, on edges and inside faces.

        Edges are divided into `steps` (E,) steps; vertices inside faces are spaced by `step`.
        """
        around = np.bincount(self.pieces, steps[self.owner], len(self.space.pieces))
        return self._count(steps) + self.spacing.inside(step, around)

    @cached_property
    def used(self) -> Flags:
        """A mask of the edges (E,) of the part that bound a piece of the space."""
        return self.around > 0

    @cached_property
    def around(self) -> Indices:
        """For each edge, the number of its sides that are on pieces of the space, (E,)."""
        return np.bincount(self.owner, minlength=len(self.arrays["edge_vertices"]))

    def _steps(self, step: float) -> Indices:
        """Return the numbers of steps (E,) of edges for a step length."""
        ends = self._vertices[1]
        least = np.where(ends[:, 0] == ends[:, 1], CLOSED, 1)
        wanted = np.ceil(self._costs[:, -1] / step).astype(np.int64)
        return np.where(self.arrays["edge_degenerate"], 1, np.maximum(wanted, least))

    @cached_property
    def _vertices(self) -> tuple[Array, Indices]:
        """The points (V, 3) at the ends of edges, and their indices (E, 2) for each edge."""
        points, ends = list(self.arrays["vertices"]), self.arrays["edge_vertices"].copy()
        for row in np.flatnonzero(self.used & (ends < 0).any(axis=1)).tolist():
            side = int(np.flatnonzero(self.owner == row)[0])
            both = np.array([side, side])
            uv = self._uv(both, np.array([0.0, 1.0]))
            there = at_places(self.space, self.pieces[both], uv).vectors[:, 0]
            closed = np.linalg.norm(there[1] - there[0]) <= SAME * self.space.size / self.space.unit
            ends[row] = len(points), len(points) + (not closed)
            points += list(there[: 2 - closed])
        numbers, places = np.unique(ends[self.used], return_inverse=True)
        ends[self.used] = places.reshape(-1, 2)
        return np.array(points).reshape(-1, 3)[numbers], ends

    def refine(self, sampled: SampledEdges, segments: dict[int, Flags]) -> None:
        """Add a vertex in the middle of the chosen segments of edges."""
        for edge, chosen in segments.items():
            if not self.arrays["edge_degenerate"][edge]:
                at = sampled.shares[edge]
                middles = (at[1:] + at[:-1])[chosen] / 2.0
                self.more[edge] = np.concatenate([self.more.get(edge, at[:0]), middles])

    # --- positions --------------------------------------------------------------------------------

    @cached_property
    def _costs(self) -> Array:
        """The cumulative lengths (E, PLACES + 1) along edges, relative to the spacing of vertices.

        If the lengths on the faces of an edge differ, the largest length counts.
        """
        shares = np.linspace(0.0, 1.0, PLACES + 1)
        sides = np.repeat(np.arange(len(self.sides)), len(shares))
        uv = self._uv(sides, np.tile(shares, len(self.sides)))
        places = at_places(self.space, self.pieces[sides], uv).uv
        found = np.zeros((len(self.around), PLACES))
        costs = self.spacing.costs(self.pieces, places.reshape(-1, len(shares), 2))
        np.maximum.at(found, self.owner, costs)
        return np.pad(np.cumsum(found, axis=1), ((0, 0), (1, 0)))

    def _uv(self, sides: Indices, shares: Array) -> Array:
        """Return parameters (M, 2) on sides of edges, at positions `shares` (M,) in [0, 1].

        `sides` (M,) are indices in `self.sides`. Between the points of the part, which have
        derivatives, interpolation is cubic.
        """
        starts, points = self.arrays["side_point_starts"], self.arrays["side_points"]
        first, last = (starts[self.sides[sides] + k] for k in (0, 1))
        steps = last - first - 1
        before = np.minimum((shares * steps).astype(np.int64), steps - 1)
        t = (shares * steps - before)[:, None]
        one, other = points[first + before], points[first + before + 1]
        slopes = (1.0 - t) * one[:, 2:] - t * other[:, 2:]
        found = one[:, :2] + t**2 * (3.0 - 2.0 * t) * (other - one)[:, :2]
        found += t * (1.0 - t) * slopes / steps[:, None]
        for k, rows in grouped(self.pieces[sides]):
            face = self.space.pieces[k].face
            if face.reversed:
                found[rows] = own_parameters(face.surface, found[rows], is_reversed=True)
        return found

    def sampled(self) -> SampledEdges:
        """Return the vertices on edges in a mesh of `spacing.count` vertices, at least `least`.

        Edges are coarser than the interior of faces if equally fine edges would take too many
        vertices.
        """
        points, ends = self._vertices
        steps, first = self._steps_for_count(), len(points)
        shares, numbers = {}, {}
        even = np.linspace(0.0, 1.0, PLACES + 1)
        for edge in np.flatnonzero(self.used).tolist():
            costs, at = self._costs[edge], np.linspace(0.0, 1.0, int(steps[edge]) + 1)
            at[1:-1] = np.interp(at * costs[-1], costs, even)[1:-1] if costs[-1] > 0.0 else at[1:-1]
            shares[edge] = np.sort(np.concatenate([at, self.more.get(edge, at[:0])]))
            inner = np.arange(first, first + len(shares[edge]) - 2)
            numbers[edge] = np.concatenate([ends[edge, :1], inner, ends[edge, 1:]])
            first += len(inner)
        edges = dict(zip(self.sides.tolist(), self.owner.tolist(), strict=True))
        along = [shares[edge] for edge in edges.values()]
        counts = [len(x) for x in along]
        found = self._uv(np.repeat(np.arange(len(along)), counts), np.concatenate(along))
        uv = dict(zip(edges, np.split(found, np.cumsum(counts)[:-1]), strict=True))
        return SampledEdges(self._points(points, first, numbers, uv), numbers, shares, uv, edges)

    def _points(
        self, vertices: Array, count: int, numbers: dict[int, Indices], uv: dict[int, Array]
    ) -> Array:
        """Return the points (count, 3) of all vertices on edges.

        `vertices` are the points at the ends of edges; the other vertices are computed on the first
        face of their edge.
        """
        found = np.concatenate([vertices, np.empty((count - len(vertices), 3))])
        firsts = np.sort(np.unique(self.owner, return_index=True)[1])
        rows = [numbers[int(self.owner[k])][1:-1] for k in firsts]
        inner = [uv[int(self.sides[k])][1:-1] for k in firsts]
        owner = np.repeat(self.pieces[firsts], [len(x) for x in rows])
        if len(owner):
            places = at_places(self.space, owner, np.concatenate(inner))
            found[np.concatenate(rows)] = places.vectors[:, 0]
        return found
