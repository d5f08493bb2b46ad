"""The boundaries of a part, the volume of its solids, and the gaps between its faces."""

import itertools
import warnings

import numpy as np

from ...runtime.base.aliases import Array, Flags
from ...runtime.base.errors import GaussmapWarning, SurfaceError
from ...runtime.base.wording import plural
from ..support_points import Segments
from .edges import edges_of, sides_at
from .face_pieces import FacePiece
from .part import Part
from .records import NO_AREA
from .results import space_of

# Nodes and weights of Gauss's rule on [0, 1], for each span of a surface and each segment of a
# boundary.
NODES, WEIGHTS = (x / 2.0 for x in np.polynomial.legendre.leggauss(5))
NODES = NODES + 0.5
# A point this far to the left of a boundary, relative to the domain, decides on which side the face
# lies.
BESIDE = 1e-6


# --- volume ---------------------------------------------------------------------------------------


def volume_of(part: Part) -> float:
    """Return the volume of the closed solids, in L³; SurfaceError if it is not known."""
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
    pieces = [x for x in space.pieces if closed[x.face.index]]
    # The area of a face is exact to about 1e-6; that inside of its boundary polygons need not be.
    integrals = (integrals_of(x, space.centre) for x in pieces)
    means = (heights / area for heights, area in integrals)
    return sum(x.face.area * mean for x, mean in zip(pieces, means, strict=True)) / 3.0


def _closed_faces(part: Part) -> Flags:
    """Return a mask of the faces that belong to closed solids; all do if the part is oriented."""
    solids = part.arrays["solid_index"]
    if part.oriented:
        return np.ones(len(part), np.bool_)
    faces, starts = part.arrays["side_faces"], part.arrays["edge_side_starts"]
    owner = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    open_ = (np.diff(starts) != 2) & ~part.arrays["edge_degenerate"]
    lacking = np.union1d(solids[faces[open_[owner]]], solids[[x.index for x in part.failed]])
    return (solids >= 0) & ~np.isin(solids, lacking)


def integrals_of(piece: FacePiece, centre: Array) -> tuple[float, float]:
    """Return the integral of (x − c)·n over a face, in L³, and its area, in L²; c is `centre`.

    By Green's theorem, ∫∫ g du dv over the face is ∮ G dv around it, where G is the integral of g
    along u.
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
    """Return the integrals (k, 2) of (x − c)·N and |N| along u, for N = x_u × x_v and c = `centre`.

    They run from the first of the values `lines` of u to each of the parameter pairs `ends` (k, 2).
    """
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
    """Divide a polygon at lines u = const and v = const.

    Return its vertices and crossings with the lines in order (k, 2), and the steps (k, 2) from each
    to the next.
    """
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


# --- boundaries -----------------------------------------------------------------------------------


def boundaries_of(part: Part) -> list[Segments]:
    """Return the boundary polygons of all faces, divided at the lines between smooth patches."""
    return [
        Segments(piece, *_divided(polygon, (piece.lines(0), piece.lines(1))), piece.face.index)
        for piece in space_of(part, None).pieces
        for polygon in piece.polygons
    ]


# --- gaps -----------------------------------------------------------------------------------------


def gap_of(part: Part) -> float:
    """Return the largest distance between the two faces of an edge, in L."""
    edges = edges_of(space_of(part, None), seams=True)
    owner = np.repeat(np.arange(len(edges)), np.diff(edges.starts))
    sides = sides_at(edges.space, edges.pieces[owner], edges.points)
    return float(sides.apart.max(initial=0.0))
