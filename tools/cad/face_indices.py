"""Search indices of faces: they find all points with given normals, proved or in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...generated.faces import offset_side
from ...generated.vectors import Patch, Vector
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.domain.domain import Domain
from ...runtime.onto_surface.proved import index_of
from ...runtime.proof.ball import Ball
from ...runtime.proof.index import ProvedIndex, ProvedPlaces, Undecided
from ...runtime.proof.kernels.answers import KINDS
from ...runtime.surface.derivatives import normals_of_jets
from ...runtime.surface.sides import with_found_sides
from ...runtime.surface.surface import Surface
from ...runtime.tape.kernels.points import Tape
from ...runtime.tape.tapes import bounds_over_boxes
from .face_places import FaceIndex, FacePlaces, joined, undecided
from .faces import face_surface, simplest
from .records import Geometry
from .round_faces import ROUND, RoundFace

Array = NDArray[np.float64]

# The numbers of cells of an index along u and v before bisection. They are small, since faces are
# simple and numerous.
CELLS = (4, 4)
# A side of the domain may be collapsed to a point if its length, or the distance between its ends,
# is below this fraction of the largest one.
CLOSE = 1e-3
# The length of a side is measured at this number of points.
PLACES = 5
OPEN_BOX = KINDS.index("open")
# Where faces of a file meet smoothly, rounded coordinates leave gaps between their normals. Because
# of gaps up to GAP, surfaces are searched beyond their open sides, by the fraction BEYOND of the
# domain; `edge_gaps` is for wider gaps. A point beyond a side counts if its normal differs by at
# most TURNED from that at the side.
GAP, BEYOND = 1e-9, 1e-6
TURNED = 1.5 * GAP
# The indices of the Taylor coefficients of order 1 and 2 in arrays of bounds.
U1, V1, U2, U1V1, V2 = range(1, 6)


def face_index(
    geometry: Geometry, surface: Surface, domain: Domain, *, is_reversed: bool
) -> FaceIndex | None:
    """Return the search index of a face over a domain; None if no proof is possible."""
    simple = simplest(geometry, domain)
    if simple.kind in ROUND:
        return RoundFace.of(simple, surface.domain, is_reversed=is_reversed)
    if simple.kind != "offset" or simple.basis is None:
        return SmoothPieces.of(surface, 0.0 if simple.surface is not None else BEYOND)
    basis = face_surface(simple.basis, domain, is_reversed=is_reversed)
    index = face_index(simple.basis, basis, domain, is_reversed=is_reversed)
    if index is None or basis.tape is None:
        return None
    distance = float(simple.numbers[0])
    return Offset(index, basis.tape, -distance if is_reversed else distance)


@dataclass(frozen=True, eq=False)
class SmoothPieces:
    """The smooth pieces of a surface, each with its search index."""

    pieces: Sequence[tuple[ProvedIndex, Surface]]

    @classmethod
    def of(cls, surface: Surface, gap: float) -> SmoothPieces | None:
        """Return the pieces of a surface with their search indices; None if a piece has no index.

        The search extends beyond open sides by `gap` times the domain, except at sides that are
        collapsed to a point.
        """
        found = []
        for piece in surface.pieces():
            if _has_corners_that_meet(piece):
                piece = with_found_sides(piece)[0]
            index = index_of(piece, CELLS, _wider(piece, gap))
            if index is None:
                return None
            found.append((index, piece))
        return cls(found)

    def query(self, normals: Array, threads: int | None = None) -> FacePlaces:
        """Return all points with unit normals (S, 3)."""
        return joined(
            [_inside(x.query(normals, threads), piece, normals) for x, piece in self.pieces]
        )


@dataclass(frozen=True, eq=False)
class Offset:
    """The search index of an offset of a surface, the basis; it queries the index of the basis.

    Both surfaces have the same parameters. Their normals are opposite where the offset has passed
    exactly one centre of principal curvature: (1 + d κ₁)(1 + d κ₂) is negative for the distance d.
    """

    basis: FaceIndex
    tape: Tape  # of the basis
    distance: float

    def query(self, normals: Array, threads: int | None = None) -> FacePlaces:
        """Return all points with unit normals (S, 3)."""
        return joined([
            self._turned(self.basis.query(sign * normals, threads), sign * normals, sign)
            for sign in (1.0, -1.0)
        ])  # fmt: skip

    def _turned(self, found: FacePlaces, normals: Array, sign: float) -> FacePlaces:
        """Return the found points at which the offset has `sign` times the normal of the basis.

        Points and components become undecided if the sign may change inside their boxes.
        """
        sides, open_ = self._sides(found.uv, found.radius, normals[found.numbers]), found.undecided
        is_known = np.abs(sides.middle) > sides.radius
        keep, lost = is_known & (sign * sides.middle > 0.0), ~is_known
        u, v, of_u, of_v = np.concatenate([found.uv, found.radius], axis=1)[lost].T
        small = np.stack([u - of_u, u + of_u, v - of_v, v + of_v], axis=1)
        singular = undecided(found.numbers[lost], small, OPEN_BOX, border=False)
        low, high = open_.boxes[:, 0::2], open_.boxes[:, 1::2]
        sides = self._sides((low + high) / 2.0, (high - low) / 2.0, normals[open_.numbers])
        is_known = np.abs(sides.middle) > sides.radius
        open_ = open_._replace(
            kinds=np.where(is_known, open_.kinds, OPEN_BOX),
            degree=np.where(is_known, sign * open_.degree, np.nan),
        )
        own = ~is_known | (sign * sides.middle > 0.0)
        both = Undecided._make(
            np.concatenate([x[own], y]) for x, y in zip(open_, singular, strict=True)
        )
        return FacePlaces(
            found.numbers[keep], found.uv[keep], found.radius[keep], sign * found.sign[keep], both
        )

    def _sides(self, uv: Array, radius: Array, normals: Array) -> Ball:
        """Return enclosures (k,) of numbers with the sign of (normal of basis)·(normal of offset).

        Enclosure i holds at the one point in the box uv[i] ± radius[i] where the normal of the
        basis is exactly normals[i].
        """
        bounds = bounds_over_boxes(self.tape, uv, radius)
        factors = zip((U2, U1V1, V2, U1, V1), (2.0, 1.0, 2.0, 1.0, 1.0), strict=True)
        vectors = [
            Vector._make(factor * Ball(bounds[:, 0, k, x], bounds[:, 1, k, x]) for x in range(3))
            for k, factor in factors
        ]
        patch = Patch._make([*vectors, Vector(0.0, 0.0, 0.0)])
        return python_function(offset_side)(patch, vector(normals), self.distance)


def _wider(surface: Surface, gap: float) -> Domain:
    """Return the domain of a surface, extended beyond open sides by `gap` times its size.

    Sides that are collapsed to a point stay.
    """
    sides = list(np.ndindex(2, 2)) if gap > 0.0 else []
    sizes = [np.ptp(_on_side(surface, *x), axis=0).max() for x in sides]
    domain = [list(x) for x in surface.domain]
    for (axis, end), size in zip(sides, sizes, strict=True):
        if surface.boundary[axis][end] == "open" and size > CLOSE * max(sizes):
            domain[axis][end] += (-gap, gap)[end] * float(np.ptp(surface.domain[axis]))
    (u0, u1), (v0, v1) = domain
    return (u0, u1), (v0, v1)


def _on_side(surface: Surface, axis: int, end: int) -> Array:
    """Return points (PLACES, 3) at equally spaced parameters on a side of the domain."""
    low, high = surface.domain[1 - axis]
    places = np.full(PLACES, surface.domain[axis][end]), np.linspace(low, high, PLACES)
    return surface.jets(*(places if axis == 0 else places[::-1]))[:, 0]


def _inside(found: ProvedPlaces, piece: Surface, normals: Array) -> FacePlaces:
    """Move points and undecided boxes from beyond open sides into the domain of a piece.

    The radius of a point grows by the distance that it moved. A point is left out if its normal
    differs from that of the side to which it moved. Boxes are left out if they are farther outside
    than `GAP` times the domain.
    """
    is_open = np.array(piece.boundary) == "open"
    low, high = np.where(is_open, piece.domain, [-np.inf, np.inf]).T
    uv, open_ = np.clip(found.uv, low, high), found.undecided
    keep = np.ones(len(uv), np.bool_)
    (out,) = np.nonzero((uv != found.uv).any(axis=1))
    at_side = normals_of_jets(piece.unchecked_jets(*uv[out].T.copy()))
    keep[out] = np.linalg.norm(at_side - normals[found.numbers[out]], axis=1) <= TURNED
    sides, gap = open_.boxes.reshape(-1, 2, 2), GAP * np.ptp(piece.domain, axis=1)
    within = ((sides[:, :, 0] < high + gap) & (sides[:, :, 1] > low - gap)).all(axis=1)
    open_, sides = Undecided._make(x[within] for x in open_), sides[within]
    boxes = np.clip(sides, low[:, None], high[:, None])
    return FacePlaces(
        found.numbers[keep], uv[keep], (found.radius + np.abs(found.uv - uv))[keep],
        found.sign[keep].astype(np.float64),
        open_._replace(boxes=boxes.reshape(-1, 4), uv=np.clip(open_.uv, low, high)),
    )  # fmt: skip


def _has_corners_that_meet(surface: Surface) -> bool:
    """Return whether a side of the domain may be collapsed: its two corners are close together."""
    (u0, u1), (v0, v1) = surface.domain
    places = np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)]).T.copy()
    points = surface.jets(*places)[:, 0]
    gaps = np.linalg.norm(np.roll(points, 1, axis=0) - points, axis=1)
    return bool(gaps.min() <= CLOSE * gaps.max())
