"""Positions on the sharp edges of a part, as parameters on both adjacent faces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.spline.kernels.jets import evaluate_jets
from ..density.cells import grouped
from .faces import own_parameters
from .part import Part
from .results import PartSpace

# Edges are sharp where the normals of the two faces differ by more than this, in degrees.
SHARP = 1.0
# Newton's method stops when the points on both faces are closer than SAME, relative to the size of
# the part, or after MOST_ROUNDS rounds. It has succeeded if they are closer than FOUND × SAME.
SAME, FOUND, MOST_ROUNDS = 1e-14, 1e3, 12
# Newton's method may move a point by at most TIMES_APART d / sin φ, where d is the distance between
# the two faces and φ the angle between their normals.
TIMES_APART = 3.0
# If the two faces are farther apart than this at a point of the file, relative to the size of the
# part, then the point is on no edge.
APART = 1e-4
# A surface counts as collapsed where one of |x_u|, |x_v| is at least COLLAPSED times the other.
# Parameters outside the domain by less than the fraction BEYOND of its size are moved to its
# boundary.
COLLAPSED, BEYOND = 1e10, 1e-12


@dataclass(frozen=True, eq=False)
class Edges:
    """E edges of a part, each between two faces, as polylines of parameters.

    `pieces` (E, 2) are the indices of the two pieces of the space beside each edge. The points of
    edge i are the rows `starts[i]:starts[i + 1]` of `points` (k, 4): u, v on the surface of its
    first piece, and u, v on the surface of its second piece.
    """

    space: PartSpace
    pieces: Indices
    points: Array
    starts: Indices

    def __len__(self) -> int:
        return len(self.pieces)

    def at(self, edges: Indices, places: Array) -> Array:
        """Return parameters (M, 4) at positions `places` (M,) on edges with indices `edges` (M,).

        Position k is point k of an edge; between two points, parameters are interpolated linearly.
        """
        last = np.diff(self.starts)[edges] - 1
        before = np.minimum(np.floor(places).astype(np.int64), last - 1)
        first = self.starts[:-1][edges] + before
        share = (places - before)[:, None]
        return self.points[first] + share * (self.points[first + 1] - self.points[first])


def edges_of(space: PartSpace, *, seams: bool = False) -> Edges:
    """Return the edges between two different pieces of a space.

    With `seams`, return also the seams, which have the same piece on both sides.
    """
    part = space.part
    known = np.full(len(part), -1)
    known[[x.face.index for x in space.pieces]] = np.arange(len(space.pieces))
    faces, points, starts = between_two(part, seams=seams)
    pieces, counts = known[faces], np.diff(starts)
    owner = np.repeat(np.arange(len(counts)), counts)
    finite = np.bincount(owner, np.isfinite(points).all(axis=1), len(counts)) == counts
    usable = (pieces >= 0).all(axis=1) & (counts >= 2) & finite
    starts = np.concatenate([[0], np.cumsum(counts[usable])])
    return Edges(
        space, pieces[usable], _of_surfaces(space, pieces[owner], points)[usable[owner]], starts
    )


def between_two(part: Part, *, seams: bool = False) -> tuple[Indices, Array, Indices]:
    """Return the edges between two faces: face indices (E, 2), points (k, 4) and starts (E + 1,).

    The points of edge i are the rows starts[i]:starts[i + 1]: u, v on the first face, and u, v on
    the second face. With `seams`, both faces may be the same.
    """
    arrays = part.arrays
    first, faces = arrays["edge_side_starts"], arrays["side_faces"]
    both = first[:-1][(np.diff(first) == 2) & ~arrays["edge_degenerate"]]
    both = both[seams | (faces[both] != faces[both + 1])]
    starts = arrays["side_point_starts"]
    counts = np.diff(starts)[both]
    ends = np.cumsum(counts)
    number = np.arange(counts.sum()) - np.repeat(ends - counts, counts)
    points = [
        arrays["side_points"][np.repeat(starts[both + side], counts) + number, :2]
        for side in (0, 1)
    ]
    return (
        np.stack([faces[both], faces[both + 1]], axis=1),
        np.concatenate(points, axis=1),
        np.concatenate([[0], ends]),
    )


def _of_surfaces(space: PartSpace, pieces: Indices, points: Array) -> Array:
    """Convert the parameters of the file (k, 4) to parameters on the surfaces of pieces (k, 2).

    They differ on reversed faces.
    """
    found = points.copy()
    for side in (0, 1):
        columns = slice(2 * side, 2 * side + 2)
        for k, rows in grouped(pieces[:, side]):
            if k >= 0 and (face := space.pieces[k].face).reversed:
                uv = found[rows, columns]
                found[rows, columns] = own_parameters(face.surface, uv, is_reversed=True)
    return found


# --- both sides -----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Sides:
    """Both faces of edges at M positions: `pieces` (M, 2), and u, v (M, 4) on their surfaces.

    For both faces: points (M, 2, 3) in L, tangents x_u, x_v (M, 2, 2, 3), unit normals (M, 2, 3), 0
    where undefined, and the curvatures K, H (M, 2, 2). `collapsed` (M, 2) marks positions on a side
    of the domain that is collapsed to a point, such as a pole; a normal is defined there only on a
    sphere.
    """

    pieces: Indices
    uv: Array
    points: Array
    tangents: Array
    normals: Array
    curvatures: Array
    collapsed: Flags

    def __len__(self) -> int:
        return len(self.uv)

    def __getitem__(self, rows: Indices | Flags) -> Sides:
        """Return a selection of the positions."""
        return Sides(*(x[rows] for x in vars(self).values()))

    @property
    def chords(self) -> Array:
        """The chords (M,) of the angles between both normals, 0 where a normal is undefined."""
        chords = np.linalg.norm(self.normals[:, 0] - self.normals[:, 1], axis=1)
        return np.where(np.all(np.any(self.normals, axis=2), axis=1), chords, 0.0)

    @property
    def sharp(self) -> Flags:
        """A mask of the positions whose normals differ by more than `SHARP` degrees."""
        return self.chords > 2.0 * math.sin(math.radians(SHARP) / 2.0)

    @property
    def apart(self) -> Array:
        """The distances (M,) between the points of the two faces, in L."""
        return np.linalg.norm(self.points[:, 0] - self.points[:, 1], axis=1)


def sides_at(space: PartSpace, pieces: Indices, uv: Array) -> Sides:
    """Evaluate both faces of edges at M positions.

    `pieces` (M, 2) are the indices of the faces' pieces, and `uv` (M, 4) the parameters on both.
    """
    found = at_places(space, pieces.ravel(), uv.reshape(-1, 2))
    return Sides(
        pieces,
        found.uv.reshape(-1, 4),
        found.vectors[:, 0].reshape(-1, 2, 3),
        found.vectors[:, 1:].reshape(-1, 2, 2, 3),
        found.normals.reshape(-1, 2, 3),
        found.curvatures.reshape(-1, 2, 2),
        found.collapsed.reshape(-1, 2),
    )


class Places(NamedTuple):
    """The fields of `Sides` for one face at M positions; `vectors` (M, 3, 3) are x, x_u, x_v."""

    uv: Array
    vectors: Array
    normals: Array
    curvatures: Array
    collapsed: Flags


def at_places(space: PartSpace, owner: Indices, uv: Array) -> Places:
    """Evaluate the surfaces of the pieces with indices `owner` (M,) at parameters `uv` (M, 2)."""
    places, scales = _inside(space, owner, uv), np.array([space.unit, 1.0, 1.0])
    vectors, normals = np.empty((len(owner), 3, 3)), np.empty((len(owner), 3))
    curvatures = np.empty((len(owner), 2))
    for k, rows in grouped(owner):
        jets = space.pieces[k].jets(*places[rows].T)
        scales[1:] = space.sizes[k]
        n, K, H = np.empty((len(rows), 3)), np.empty(len(rows)), np.empty(len(rows))
        evaluate_jets(jets, scales, n, K, H)
        vectors[rows], normals[rows] = jets[:, :3], n
        curvatures[rows] = np.stack([K, H], axis=1)
    lengths = np.linalg.norm(vectors[:, 1:], axis=2) * space.sizes[owner]
    collapsed = lengths.min(axis=1) * COLLAPSED <= lengths.max(axis=1)
    for k in np.flatnonzero(collapsed):
        if space.pieces[owner[k]].face.kind != "sphere":
            normals[k] = 0.0
    return Places(places, vectors, normals, curvatures, collapsed)


def _inside(space: PartSpace, owner: Indices, places: Array) -> Array:
    """Return parameters (k, 2); those outside the domain by rounding are moved to its boundary."""
    low, high = np.array([x.surface.domain for x in space.pieces])[owner].transpose(2, 0, 1)
    slack = BEYOND * (high - low)
    places = np.where((places < low) & (places >= low - slack), low, places)
    return np.where((places > high) & (places <= high + slack), high, places)


# --- exact positions ------------------------------------------------------------------------------


def exact_places(edges: Edges, owner: Indices, places: Array) -> tuple[Sides, Indices]:
    """Return both faces at the positions where edges are sharp, and the indices of these positions.

    `places` (M,) are positions on the edges with indices `owner` (M,), as in `Edges.at`.

    Newton's method finds the intersection of the faces, in the plane across the edge. If the faces
    do not intersect, but meet within a tolerance, the nearest point of the edge in the file is
    taken. Positions where the faces are farther apart than `APART` are left out.
    """
    space, pieces = edges.space, edges.pieces[owner]
    starts = sides_at(space, pieces, edges.at(owner, places))
    of_file = sides_at(space, pieces, edges.at(owner, places.round()))
    near = of_file.apart <= APART * _size(space)
    rows = np.flatnonzero(starts.sharp & near & ~starts.collapsed.any(axis=1))
    uv = of_file.uv.copy()
    solved, found = _intersections(space, starts[rows])
    uv[rows[found]] = solved[found]
    sides = sides_at(space, pieces, uv)
    kept = np.flatnonzero(near & sides.sharp)
    return sides[kept], kept


def _size(space: PartSpace) -> float:
    """Return the size of the part in L."""
    return space.size / space.unit


def _intersections(space: PartSpace, starts: Sides) -> tuple[Array, Flags]:
    """Return parameters (M, 4) where two faces intersect near `starts`, and a mask of successes.

    The points of both faces move in the plane across the edge.
    """
    along = np.cross(starts.normals[:, 0], starts.normals[:, 1])
    least = math.sin(math.radians(SHARP) / 2.0)  # not smaller at cusps, where normals are opposite
    sines = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), least)
    along /= sines
    same = SAME * _size(space)
    most = TIMES_APART * starts.apart / sines[:, 0] + same
    rows, uv, found = np.arange(len(starts)), starts.uv.copy(), starts.uv.copy()
    best = np.full(len(starts), np.inf)
    for _ in range(MOST_ROUNDS):
        sides = sides_at(space, starts.pieces[rows], uv[rows])
        moved = sides.points[:, 0] - starts.points[rows, 0]
        ahead = np.einsum("ij,ij->i", moved, along[rows])
        errors = np.hypot(sides.apart, ahead)
        better = (errors < best[rows]) & (np.linalg.norm(moved, axis=1) <= most[rows])
        best[rows[better]], found[rows[better]] = errors[better], uv[rows[better]]
        again = better & (errors > same)
        if not again.any():
            break
        rows = rows[again]
        uv[rows] -= _step(sides[again], along[rows], ahead[again])
    return found, best <= FOUND * same


def _step(sides: Sides, along: Array, ahead: Array) -> Array:
    """Return steps (M, 4) of Newton's method, to be subtracted from the parameters u, v, u, v.

    To first order, both points then coincide in the plane perpendicular to `along`.
    """
    one, other = sides.tangents[:, 0], sides.tangents[:, 1]
    matrices = np.zeros((len(sides), 4, 4))
    matrices[:, :3, :2] = one.transpose(0, 2, 1)
    matrices[:, :3, 2:] = -other.transpose(0, 2, 1)
    matrices[:, 3, :2] = np.einsum("ikx,ix->ik", one, along)
    errors = np.column_stack([sides.points[:, 0] - sides.points[:, 1], ahead])
    scales = np.linalg.norm(matrices[:, :3], axis=1)
    scales[scales == 0.0] = 1.0
    matrices /= scales[:, None, :]
    regular = np.abs(np.linalg.det(matrices)) > np.finfo(np.float64).eps
    steps = np.zeros((len(sides), 4))
    steps[regular] = np.linalg.solve(matrices[regular], errors[regular, :, None])[..., 0]
    return steps / scales
