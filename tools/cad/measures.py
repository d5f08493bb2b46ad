"""The bounding box of a part, the volume of its solids, and the gaps between its faces."""

from __future__ import annotations

import itertools
import warnings

import numpy as np

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.errors import GaussmapWarning, SurfaceError
from ...runtime.base.wording import plural
from ..density.cells import RADIUS, by_piece
from .edges import edges_of, sides_at
from .face_pieces import FacePiece
from .part import Part
from .records import NO_AREA
from .results import space_of

__all__ = ["bounds_of", "gap_of", "integrals_of", "signs_of", "volume_of"]

# Nodes and weights of Gauss's rule on [0, 1], for each span of a surface and each segment of a
# boundary.
NODES, WEIGHTS = (x / 2.0 for x in np.polynomial.legendre.leggauss(5))
NODES = NODES + 0.5
# The number of steps of Newton's method.
STEPS = 8
# A point this far to the left of a boundary, relative to the domain, decides on which side the
# face is.
BESIDE = 1e-6


# --- volume ---------------------------------------------------------------------------------------


def volume_of(part: Part) -> float:
    """Return the volume of the closed solids, in L³; SurfaceError if there are none."""
    closed = _closed_faces(part)
    failed = [x.index for x in part.failed if x.reason != NO_AREA]
    if not closed.any() or closed[failed].any() or part.about.get("source_indices"):
        lack = "some of its faces cannot be used" if failed else "its faces enclose no solids"
        raise SurfaceError(f"the volume of part {part.name!r} is not known: {lack}.")
    if not closed.all():
        warnings.warn(
            f"the volume of part {part.name!r} is that of its closed solids: "
            f"{plural(int((~closed).sum()), 'face')} of {len(part):,} belong to none.",
            GaussmapWarning,
            stacklevel=4,
        )
    space = space_of(part, None)
    for k, why in space.failed.items():
        if closed[k] and k not in {x.index for x in part.failed}:
            raise SurfaceError(why)
    centre, pieces = space.centre, [x for x in space.pieces if closed[x.face.index]]
    return sum(x.face.area * _mean_height(x, centre) for x in pieces) / 3.0


def _closed_faces(part: Part) -> Flags:
    """Return which faces belong to closed solids: all, if the part is oriented."""
    solids = part.arrays["solid_index"]
    if part.oriented:
        return np.ones(len(part), np.bool_)
    faces, starts = part.arrays["side_faces"], part.arrays["edge_side_starts"]
    owner = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    open_ = (np.diff(starts) != 2) & ~part.arrays["edge_degenerate"]
    lacking = np.union1d(solids[faces[open_[owner]]], solids[[x.index for x in part.failed]])
    return (solids >= 0) & ~np.isin(solids, lacking)


def _mean_height(piece: FacePiece, centre: Array) -> float:
    """Return the mean of (x − c)·n over a face.

    The area comes from the CAD library, so that the area of the boundary polygons need not be
    exact.
    """
    heights, area = integrals_of(piece, centre)
    return heights / area


def integrals_of(piece: FacePiece, centre: Array) -> tuple[float, float]:
    """Return the integral of (x − c)·n over a face, in L³, and its area, in L².

    By Green's theorem, ∫∫ g du dv over the face is ∮ G dv around it, with G the integral of g along
    u.
    """
    lines = piece.lines(0), piece.lines(1)
    total = np.zeros(2)
    for polygon, sign in zip(piece.polygons, signs_of(piece), strict=True):
        places, steps = _divided(polygon, lines)
        # Segments of constant v have dv = 0.
        places, steps = (x[steps[:, 1] != 0.0] for x in (places, steps))
        ends = (places[:, None] + NODES[:, None] * steps[:, None]).reshape(-1, 2)
        weights = sign * (WEIGHTS * steps[:, 1:]).ravel()
        total += weights @ _along_u(piece, ends, lines[0], centre)
    return float(total[0]), float(total[1])


def _along_u(piece: FacePiece, ends: Array, lines: Array, centre: Array) -> Array:
    """Return the integrals (k, 2) of (x − c)·N and |N| along u, from the first line to `ends`."""
    found = np.zeros((len(ends), 2))
    for low, high in itertools.pairwise(lines):
        rows = np.flatnonzero(ends[:, 0] > low)
        if not len(rows):
            break
        widths = np.minimum(ends[rows, 0], high) - low
        u = (low + NODES * widths[:, None]).ravel()
        jets = piece.surface.jets(u, np.repeat(ends[rows, 1], len(NODES)))
        N = np.cross(jets[:, 1], jets[:, 2])
        values = np.stack(
            [np.einsum("ij,ij->i", jets[:, 0] - centre, N), np.linalg.norm(N, axis=1)], axis=1
        ).reshape(len(rows), len(NODES), 2)
        found[rows] += widths[:, None] * np.einsum("k,ikj->ij", WEIGHTS, values)
    return found


def signs_of(piece: FacePiece) -> Array:
    """Return for each polygon 1 if the face lies to its left, else −1."""
    places = []
    for x in piece.polygons:
        steps = (np.roll(x, -1, axis=0) - x) / piece.sizes
        k = int(np.hypot(*steps.T).argmax())
        left = np.array([-steps[k, 1], steps[k, 0]]) / np.hypot(*steps[k])
        middle = (x[k] + x[(k + 1) % len(x)]) / 2.0
        places.append(middle + BESIDE * left * piece.sizes)
    low, high = np.array(piece.surface.domain).T
    found = np.array(places)
    in_domain = ((found > low) & (found < high)).all(axis=1)
    return np.where(in_domain & piece.contains(np.clip(found, low, high)), 1.0, -1.0)


def _divided(polygon: Array, lines: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return points (k, 2) that divide a polygon at lines, and steps (k, 2) to the next ones."""
    steps = np.roll(polygon, -1, axis=0) - polygon
    owners, shares = [np.arange(len(polygon))], [np.zeros(len(polygon))]
    for axis in (0, 1):
        with np.errstate(divide="ignore", invalid="ignore"):
            crossed = (lines[axis] - polygon[:, [axis]]) / steps[:, [axis]]
        owner, k = np.nonzero((crossed > 0.0) & (crossed < 1.0))
        owners.append(owner)
        shares.append(crossed[owner, k])
    owner, share = np.concatenate(owners), np.concatenate(shares)
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    following = np.where(np.diff(owner, append=-1) == 0, np.roll(share, -1), 1.0)
    return polygon[owner] + share[:, None] * steps[owner], (following - share)[:, None] * steps[
        owner
    ]


# --- bounds ---------------------------------------------------------------------------------------


def bounds_of(part: Part) -> Array:
    """Return the smallest and the largest coordinates (2, 3); SurfaceError if no face is usable.

    A coordinate is extremal on a boundary, or where its derivatives are 0: Newton's method starts
    in all cells, and on all boundary segments, that may reach beyond the points known so far.
    """
    space, found = space_of(part, None), []
    for k, rows in by_piece(space.first):
        piece, places = space.pieces[k], space.first.places[rows]
        points = _points(piece, places)
        found.append((piece, places, None, points, space.first.numbers[rows, RADIUS] / space.unit))
        lines = piece.lines(0), piece.lines(1)
        for polygon in piece.polygons:
            starts, steps = _divided(polygon, lines)
            points, ends = _points(piece, starts), _points(piece, starts + steps)
            # A segment that turns by less than half a turn stays within this radius of its start.
            reach = np.linalg.norm(ends - points, axis=1)
            found.append((piece, starts, steps, points, reach))
    directions = np.concatenate([-np.eye(3), np.eye(3)])
    best = np.max([(x[3] @ directions.T).max(axis=0) for x in found], axis=0)
    for piece, places, steps, points, reach in found:
        for k, direction in enumerate(directions):
            far = points @ direction + reach > best[k]
            if far.any():
                if steps is None:
                    highest = _highest_inside(piece, places[far], direction)
                else:
                    highest = _highest_on_border(piece, places[far], steps[far], direction)
                values = _points(piece, highest) @ direction
                best[k] = max(best[k], float(values.max(initial=-np.inf)))
    return best.reshape(2, 3) * [[-1.0], [1.0]] + 0.0


def _points(piece: FacePiece, places: Array) -> Array:
    return piece.surface.jets(*places.T.copy())[:, 0]


def _highest_inside(piece: FacePiece, places: Array, direction: Array) -> Array:
    """Return parameter pairs (m, 2) where a coordinate may be largest, from starts (k, 2)."""
    low, high = np.array(piece.surface.domain).T
    for _ in range(STEPS):
        jets = piece.surface.jets(*places.T.copy()) @ direction
        _, fu, fv, fuu, fuv, fvv = jets.T
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            moved = np.stack([fuv * fv - fvv * fu, fuv * fu - fuu * fv], axis=1)
            moved /= (fuu * fvv - fuv**2)[:, None]
        places = np.clip(places + np.where(np.isfinite(moved), moved, 0.0), low, high)
    return places[piece.contains(places)]


def _highest_on_border(piece: FacePiece, starts: Array, steps: Array, direction: Array) -> Array:
    """Return the parameter pairs (k, 2) on boundary segments where a coordinate is largest."""
    share = np.full((len(starts), 1), 0.5)
    for _ in range(STEPS):
        jets = piece.surface.jets(*(starts + share * steps).T.copy()) @ direction
        slope = np.einsum("ij,ij->i", jets[:, 1:3], steps)
        squares = np.stack([steps[:, 0] ** 2, 2.0 * steps[:, 0] * steps[:, 1], steps[:, 1] ** 2])
        bend = np.einsum("ij,ji->i", jets[:, 3:], squares)
        with np.errstate(divide="ignore", invalid="ignore"):
            moved = np.where(bend < 0.0, -slope / bend, np.sign(slope))
        share = np.clip(share + moved[:, None], 0.0, 1.0)
    return starts + share * steps


# --- gaps -----------------------------------------------------------------------------------------


def gap_of(part: Part) -> float:
    """Return the largest distance between both sides of an edge, in L."""
    edges = edges_of(space_of(part, None), seams=True)
    owner = np.repeat(np.arange(len(edges)), np.diff(edges.starts))
    sides = sides_at(edges.space, edges.pieces[owner], edges.points)
    return float(sides.apart.max(initial=0.0))
