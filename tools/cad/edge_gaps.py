"""Points with given normals in the gaps that rounded numbers leave between smoothly joined faces.

At a point of an edge with the tangent t, n can only be a normal if n·t = 0. Let s be the slope of
the height n·x from this point into a face. If both slopes s have the same sign, n is between the
normals of the two faces: the edge has a point with the normal n, like a crease. A face has a point
with the normal n near the edge if s and the second derivative of n·x in the direction into the face
have different signs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...runtime.base.aliases import Array, Flags, Indices
from ...runtime.base.kept import kept
from ...runtime.base.repeats import repeated
from ...runtime.base.trees import tree_of
from ...runtime.proof.grid_lines import creases_of
from ...runtime.surface.creases import CREASE_ANGLE
from ...runtime.surface.derivatives import normals_of_jets
from ..density.cells import grouped
from .edges import at_places, edges_of
from .face_indices import GAP, TURNED
from .part import Part
from .results import PartSpace, space_of

if TYPE_CHECKING:
    from scipy.spatial import KDTree

# Where normals differ by more than WIDEST, an edge is a crease and has no gap. An edge is straight
# in the parameters of a face if it is nowhere off a straight line by more than STRAIGHT times the
# domain.
WIDEST, STRAIGHT = math.radians(CREASE_ANGLE), 1e-12
# A face counts as developable where the larger radius of curvature exceeds FLAT times the extent of
# all edges: rounding coordinates to 7 digits bends a face less than that.
FLAT = 1e6
# Gaps are measured at MEASURED points of an edge. Normals along it are tabulated at PLACES points;
# if successive normals differ by more than JUMP, the edge has a pole or a corner between them.
MEASURED, PLACES, JUMP = 7, 257, 0.25
SHARES = (np.arange(MEASURED) + 0.5) / MEASURED
# The number of cells, per unit of each coordinate, of the grid of directions for normals of edges.
CELLS = 20
# STEPS steps of Newton's method lead to a position on an edge where |n·t| is at most SETTLED. Where
# the derivative of n·t vanishes, too, the error of the position is about the root of SETTLED.
# Positions closer than APART count as one, which is settled if they are closer than SAME.
STEPS, SETTLED, SAME = 4, 1e-12, 1e-9
APART = math.sqrt(SETTLED)
# A face lies on a side of an edge if points at this distance from the edge, relative to the domain,
# are inside the face.
BESIDE = 1e-6


class AtEdges(NamedTuple):
    """Points of edges where n·t = 0 for a given normal n, close to the normals of both faces.

    `numbers` (k,) are the indices of the normals n, and `pieces` (k, 2) those of both faces in the
    space of the part. For both faces: the parameters `uv` (k, 2, 2), the `normals` (k, 2, 3), the
    `slopes` (k, 2) of n·x into the face, the second derivatives (k, 2) of n·x `along` the edge, and
    the `curvatures` K and H (k, 2, 2). Where `settled` (k,) is False, Newton's method has not
    converged, as beside corners, where tangents jump.
    """

    numbers: Indices
    pieces: Indices
    points: Array
    uv: Array
    normals: Array
    slopes: Array
    along: Array
    curvatures: Array
    settled: Flags

    @property
    def has(self) -> Flags:
        """Whether the faces (k, 2) have a point with the normal next to the edge."""
        bend = self.along * self.curvatures[:, :, 0]  # the sign of the second derivative across
        return self._is_down == (bend > 0.0)

    @property
    def between(self) -> Flags:
        """Whether the normal is between the normals of both faces (k,)."""
        return self._is_down[:, 0] == self._is_down[:, 1]

    @property
    def signs(self) -> Array:
        """The index (k,) of the point of the edge: 1 for a maximum or a minimum of n·x, else -1."""
        return np.where(self._is_down[:, 0] == (self.along[:, 0] < 0.0), 1.0, -1.0)

    @property
    def _is_down(self) -> Flags:
        return self.slopes < 0.0

    @property
    def gaps(self) -> Array:
        """The angles (k,) between the normals of both faces."""
        return np.linalg.norm(self.normals[:, 1] - self.normals[:, 0], axis=1)


@dataclass(frozen=True, eq=False)
class EdgeGaps:
    """Edges of a part with gaps wider than `GAP`, straight in the parameters of both faces.

    Creases inside of a face are such edges, too, with the same piece twice; they are `exact`: since
    both sides are searched without a tolerance, gaps of all widths count. Neither face is
    developable. In the parameters of its two `pieces[i]`, edge i runs from `starts[i]` (2, 2) to
    `starts[i] + steps[i]`; it may be `closed`. `inward[i]` (2,) is 1 for a face on the side of
    N × t, else −1. The normals of the first face at PLACES points of each edge are in a `tree`, and
    `cells` marks the directions near them. At each of these points, `spread` (3,) is the change of
    the normal per step, and `bends` the length of its second difference. A normal in a gap is
    within `slack` of a normal of the edge, and within `reach` of a normal in the tree. Edges end or
    cross at `corners` (C, 3).
    """

    space: PartSpace
    pieces: Indices
    starts: Array
    steps: Array
    inward: Array
    exact: Flags
    closed: Flags
    normals: Array
    spread: Array
    bends: Array
    slack: float
    reach: float
    tree: KDTree
    cells: Flags
    corners: Array

    @classmethod
    def of(cls, part: Part) -> EdgeGaps | None:
        """Return the edges with gaps of a part, kept with it; None if there are none."""
        return kept(part, cls, lambda: cls._of(space_of(part, None)))

    @classmethod
    def _of(cls, space: PartSpace) -> EdgeGaps | None:
        lines = _Lines._make(
            map(np.concatenate, zip(_between_faces(space), *_inside_faces(space), strict=True))
        )
        if len(lines.pieces) == 0:
            return None
        sides = [
            at_places(
                space, np.repeat(lines.pieces[:, k], MEASURED), lines.places[:, :, k].reshape(-1, 2)
            )
            for k in (0, 1)
        ]
        gaps = np.linalg.norm(sides[1].normals - sides[0].normals, axis=1).reshape(-1, MEASURED)
        radii = np.maximum(*(largest_radius(*x.curvatures.T) for x in sides))
        size = float(np.ptp(sides[0].vectors[:, 0], axis=0).max())
        bent = radii.reshape(-1, MEASURED).min(axis=1) <= FLAT * size
        some = ((lines.exact[:, None] | (gaps > GAP)) & (gaps <= WIDEST)).any(axis=1) & bent
        lines, gaps = _Lines._make(x[some] for x in lines), gaps[some]
        inward = np.stack([_inward(space, lines, k) for k in (0, 1)], axis=1)
        known = (inward != 0.0).all(axis=1)
        if not known.any():
            return None
        lines = _Lines._make(x[known] for x in lines)
        # Gaps are measured at a few points, and may be wider at others.
        slack = min(4.0 * float(gaps[known].max()), WIDEST) + TURNED
        return cls._along(space, lines, inward[known], size, slack)

    @classmethod
    def _along(
        cls, space: PartSpace, lines: _Lines, inward: Array, size: float, slack: float
    ) -> EdgeGaps:
        """Return edges with the normals along them."""
        pieces, starts, steps = lines[:3]
        shares = np.linspace(0.0, 1.0, PLACES)[:, None]
        uv = starts[:, :1] + shares * steps[:, :1]
        places = at_places(space, np.repeat(pieces[:, 0], PLACES), uv.reshape(-1, 2))
        points, normals = (x.reshape(-1, PLACES, 3) for x in (places.vectors[:, 0], places.normals))
        closed = np.linalg.norm(points[:, -1] - points[:, 0], axis=1) <= SAME * size
        change = np.diff(normals, axis=1)
        change[np.linalg.norm(change, axis=2) > JUMP] = 0.0
        before, after = (
            np.pad(change, ((0, 0), x, (0, 0)), "edge").reshape(-1, 3) for x in ((1, 0), (0, 1))
        )
        spread, bends = (before + after) / 2.0, np.linalg.norm(after - before, axis=1)
        reach = np.linalg.norm(spread, axis=1) + bends + slack
        cells = np.zeros((2 * CELLS + 5,) * 3, np.bool_)
        around = np.array(_cell_of(places.normals))
        for step in np.indices((3, 3, 3)).reshape(3, -1, 1).swapaxes(0, 1) - 1:
            cells[tuple(around + step)] = True
        return cls(
            space, pieces, starts, steps, inward, lines.exact, closed, places.normals, spread,
            bends, slack, float(reach.max()), tree_of(places.normals), cells,
            _corners(space, lines),
        )  # fmt: skip

    def beside_corners(self, points: Array, reach: Array) -> Flags:
        """Return whether points (k, 3) of edges are within `reach` (k,) of a corner."""
        away = np.linalg.norm(points[:, None] - self.corners, axis=2)
        return away.min(axis=1) <= reach

    def at(self, normals: Array) -> AtEdges:
        """Return the points of edges with unit normals (S, 3)."""
        numbers, owner, shares = self._near(normals)
        given = normals[numbers]
        sides = np.repeat([0, 1], len(owner))
        found = self._solved(np.tile(owner, 2), sides, np.tile(shares, 2), np.tile(given, (2, 1)))
        one, other = (_Side._make(x[sides == k] for x in found) for k in (0, 1))
        gaps = np.linalg.norm(other.normals - one.normals, axis=1)
        near = (self.exact[owner] | (gaps > GAP)) & (gaps <= WIDEST)
        for x in (one, other):
            near &= np.linalg.norm(x.normals - given, axis=1) <= gaps + TURNED
        settled = np.maximum(one.off, other.off) <= SETTLED
        share = np.where(self.closed[owner] & (one.share >= 1.0 - SAME), 0.0, one.share)
        # Neighbouring starts lead to one position, as do both ends of a closed edge.
        order = np.lexsort((share, owner, numbers))
        order = order[near[order]]
        same = (np.diff(numbers[order]) == 0) & (np.diff(owner[order]) == 0)
        same &= np.diff(share[order]) <= APART
        firsts = np.flatnonzero(np.append(True, ~same)[: len(order)])
        rows, lasts = order[firsts], order[np.append(firsts, len(order))[1:] - 1]
        settled = np.logical_and.reduceat(settled[order], firsts)
        settled &= share[lasts] <= share[rows] + SAME

        def both(name: str) -> Array:
            return np.stack([getattr(x, name)[rows] for x in (one, other)], axis=1)

        return AtEdges(
            numbers[rows], self.pieces[owner[rows]], one.point[rows], both("uv"), both("normals"),
            both("slope"), both("along"), both("curvatures"), settled,
        )  # fmt: skip

    def _near(self, normals: Array) -> tuple[Indices, Indices, Array]:
        """Return indices of normals (S, 3), edges that may have them, and positions in [0, 1]."""
        (near,) = np.nonzero(self.cells[_cell_of(normals)])
        found = self.tree.query_ball_point(normals[near], self.reach)
        numbers = np.repeat(near, [len(x) for x in found])
        rows = np.concatenate([np.empty(0, np.int64), *found]).astype(np.int64)
        away, spread = normals[numbers] - self.normals[rows], self.spread[rows]
        size = np.maximum(np.einsum("kx,kx->k", spread, spread), 1e-300)
        steps = np.einsum("kx,kx->k", away, spread) / size
        away -= steps[:, None] * spread
        near = np.linalg.norm(away, axis=1) <= self.bends[rows] + self.slack
        near &= np.abs(steps) <= 1.0
        owner, place = np.divmod(rows[near], PLACES)
        shares = np.clip((place + steps[near]) / (PLACES - 1.0), 0.0, 1.0)
        return numbers[near], owner, shares

    def _solved(self, edges: Indices, side: Indices, shares: Array, normals: Array) -> _Side:
        """Return the points of edges, near the positions `shares` (k,), where n·t = 0.

        `side` (k,) are the sides of the edges, 0 or 1, on which n·t is computed.
        """
        pieces = self.pieces[edges, side]
        starts, steps = (x[edges, side] for x in (self.starts, self.steps))
        du, dv = steps.T[:, :, None]
        second = np.empty(0)
        for _ in range(STEPS):
            jets = _jets(self.space, pieces, starts + shares[:, None] * steps)
            tangents = jets[:, 1] * du + jets[:, 2] * dv
            bends = jets[:, 3] * du * du + 2.0 * jets[:, 4] * du * dv + jets[:, 5] * dv * dv
            first, second = (np.einsum("kx,kx->k", x, normals) for x in (tangents, bends))
            move = np.divide(first, second, out=np.zeros_like(first), where=second != 0.0)
            shares = np.clip(shares - move, 0.0, 1.0)
        at = at_places(self.space, pieces, starts + shares[:, None] * steps)
        tangents = np.einsum("ki,kix->kx", steps, at.vectors[:, 1:])
        tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
        inwards = self.inward[edges, side, None] * np.cross(at.normals, tangents)
        slope, off = (np.einsum("kx,kx->k", x, normals) for x in (inwards, tangents))
        return _Side(
            at.vectors[:, 0], at.uv, at.normals, slope, second, at.curvatures, np.abs(off), shares
        )


class _Side(NamedTuple):
    """One face at points of edges; see `AtEdges`. `off` (k,) are the values of |n·t|."""

    point: Array
    uv: Array
    normals: Array
    slope: Array
    along: Array
    curvatures: Array
    off: Array
    share: Array


def largest_radius(K: Array, H: Array) -> Array:
    """Return the larger radius of curvature, infinite where K is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(
            (np.abs(H) + np.sqrt(np.maximum(H * H - K, 0.0))) / np.abs(K), nan=np.inf
        )


def _jets(space: PartSpace, pieces: Indices, uv: Array) -> Array:
    """Return jets (k, 6, 3) of pieces (k,) at parameters (k, 2)."""
    found = np.empty((len(uv), 6, 3))
    for k, rows in grouped(pieces):
        found[rows] = space.pieces[k].jets(*uv[rows].T)
    return found


def _cell_of(normals: Array) -> tuple[Indices, Indices, Indices]:
    """Return the indices of the cells of directions (k, 3); the grid has a margin of two cells."""
    x, y, z = np.rint(CELLS * normals).astype(np.int64).T + CELLS + 2
    return x, y, z


class _Lines(NamedTuple):
    """Straight lines in parameters of two sides, see `EdgeGaps`, with some `places` on both.

    Inside of a face, `axes` (E,) is 0 for a line u = c, and 1 for v = c; it is −1 between faces.
    """

    pieces: Indices
    starts: Array
    steps: Array
    axes: Indices
    exact: Flags
    places: Array


def _between_faces(space: PartSpace) -> _Lines:
    """Return the edges that are straight in the parameters of both faces."""
    edges = edges_of(space)
    first, last = edges.starts[:-1], edges.starts[1:] - 1
    points = edges.points.reshape(-1, 2, 2)
    starts, steps = points[first], points[last] - points[first]
    owner = repeated(np.diff(edges.starts))[0]
    sizes = space.sizes[edges.pieces]
    along, away = steps / sizes, (points - starts[owner]) / sizes[owner]
    off = np.abs(away[..., 0] * along[owner, :, 1] - away[..., 1] * along[owner, :, 0])
    off = np.maximum.reduceat(off.max(axis=1), first) if len(first) else np.empty(0)
    length = np.linalg.norm(along, axis=2).min(axis=1)
    keep = (off <= STRAIGHT * length) & (length > 0.0)
    places = np.rint((last - first)[:, None] * SHARES).astype(np.int64) + first[:, None]
    inside = np.full(len(edges), -1), np.zeros(len(edges), np.bool_)
    found = edges.pieces, starts, steps, *inside, points[places]
    return _Lines._make(x[keep] for x in found)


def _inside_faces(space: PartSpace) -> Iterator[_Lines]:
    """Yield the knot lines of faces across which tangent planes jump, and seams of closed faces."""
    for k, piece in enumerate(space.pieces):
        surface = piece.surface
        if piece.face.geometry.net is None or surface.tape is None:
            continue
        for axis in (0, 1):
            low, high = surface.domain[1 - axis]
            for line in creases_of(surface.tape, axis, surface.domain, surface.boundary):
                starts, steps = np.zeros((2, 1, 2, 2))
                starts[..., axis], starts[..., 1 - axis], steps[..., 1 - axis] = (
                    line,
                    low,
                    high - low,
                )
                places = starts[:, None] + SHARES[:, None, None] * steps[:, None]
                # An open seam of a closed face is searched as an edge between two faces is.
                exact = line[0] < line[1] or surface.boundary[axis][0] == "periodic"
                found = starts, steps, np.array([axis]), np.array([exact]), places
                yield _Lines(np.array([[k, k]]), *found)


def _corners(space: PartSpace, lines: _Lines) -> Array:
    """Return the ends of lines, and the points where lines inside of a face cross (C, 3)."""
    pieces, ends = lines.pieces[:, 0], lines.starts[:, 0]
    uv = [ends, ends + lines.steps[:, 0]]
    one, other = np.nonzero(
        (lines.axes[:, None] == 0) & (lines.axes == 1) & (pieces[:, None] == pieces)
    )
    uv.append(np.stack([ends[one, 0], ends[other, 1]], axis=1))
    owner = np.concatenate([pieces, pieces, pieces[one]])
    return at_places(space, owner, np.concatenate(uv)).vectors[:, 0]


def _inward(space: PartSpace, lines: _Lines, side: int) -> Array:
    """Return 1 for edges whose face is on the side of N × t, −1 for a face on the other side.

    Return 0 if the face is on both sides, or on none.
    """
    owner, step = lines.pieces[:, side], lines.steps[:, side]
    uv, count = lines.starts[:, side] + 0.5 * step, np.arange(len(owner))
    jets = _jets(space, owner, uv)
    tangents = np.einsum("ki,kix->kx", step, jets[:, 1:3])
    across = np.einsum("kx,kix->ki", np.cross(normals_of_jets(jets), tangents), jets[:, 1:3])
    across /= np.maximum(np.einsum("kix,kix->ki", jets[:, 1:3], jets[:, 1:3]), 1e-300)
    across /= np.abs(across / space.sizes[owner]).max(axis=1, keepdims=True)
    found = (2 * side - 1) * np.sign(across[count, lines.axes])  # of the lines inside of faces
    edges = lines.axes < 0
    found[edges] = 0.0
    for k, rows in grouped(np.where(edges, owner, -1)):
        piece = space.pieces[k]
        for sign in (1.0, -1.0) if k >= 0 else ():
            places = uv[rows] + sign * BESIDE * across[rows]
            low, high = np.array(piece.surface.domain).T
            turned = [x[0] == "periodic" for x in piece.surface.boundary]
            inside = (((places >= low) & (places <= high)) | turned).all(axis=1)
            found[rows] += sign * (inside & piece.contains(places))
    return found
