"""Indices that find all points of faces with given normals, by a proof or in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...generated.faces import offset_side
from ...generated.vectors import Patch, Vector
from ...runtime.base.formula_calls import python_function, vector
from ...runtime.domain.domain import Domain
from ...runtime.onto_surface.proved import index_of
from ...runtime.proof.ball import Ball
from ...runtime.proof.index import KINDS, ProvedIndex, ProvedPlaces, Undecided
from ...runtime.surface.collapsed import with_found_sides
from ...runtime.surface.surface import Surface
from ...runtime.tape.kernels.points import Tape
from ...runtime.tape.tapes import bounds_over_boxes
from .face_places import FaceIndex, FacePlaces, joined, undecided
from .faces import face_surface, simplest
from .records import Geometry
from .round_faces import ROUND, RoundFace

__all__ = ["GAP", "face_index"]

Array = NDArray[np.float64]

# The cells of an index before bisection: faces are simple and numerous.
CELLS = (4, 4)
# A side of the domain may be one point if the distance of its ends is below this part of the
# largest such distance.
CLOSE = 1e-3
# A side is measured at this number of places.
PLACES = 5
OPEN_BOX = KINDS.index("open")
# Where faces of a file meet smoothly, rounded numbers leave a small gap between their normals. So
# their surfaces are searched beyond open sides and trims, by this part of the domain.
GAP = 1e-9
# The indices of Taylor coefficients in bounds.
U1, V1, U2, U1V1, V2 = range(1, 6)


def face_index(
    geometry: Geometry, surface: Surface, domain: Domain, *, is_reversed: bool
) -> FaceIndex | None:
    """Return the index of the surface of a face over a domain; None if no proof is possible."""
    simple = simplest(geometry, domain)
    if simple.kind in ROUND:
        return RoundFace.of(simple, surface.domain, is_reversed=is_reversed)
    if simple.kind != "offset" or simple.basis is None:
        return SmoothPieces.of(surface, 0.0 if simple.surface is not None else GAP)
    basis = face_surface(simple.basis, domain, is_reversed=is_reversed)
    index = face_index(simple.basis, basis, domain, is_reversed=is_reversed)
    if index is None or basis.tape is None:
        return None
    distance = float(simple.numbers[0])
    return Offset(index, basis.tape, -distance if is_reversed else distance)


@dataclass(frozen=True, eq=False)
class SmoothPieces:
    """The indices of the smooth pieces of a surface."""

    pieces: Sequence[tuple[ProvedIndex, Surface]]

    @classmethod
    def of(cls, surface: Surface, gap: float) -> SmoothPieces | None:
        """Return the indices of a surface; None if one of its pieces has none.

        The search extends beyond open sides by the part `gap` of the domain, except at points.
        """
        found = []
        for piece in surface.pieces():
            if _has_corners_that_meet(piece):
                piece = with_found_sides(piece)[0]
            index = index_of(_wider(piece, gap), cells=CELLS)
            if index is None:
                return None
            found.append((index, piece))
        return cls(found)

    def query(self, normals: Array, threads: int | None = None) -> FacePlaces:
        """Return all points with unit normals (S, 3)."""
        return joined([_inside(x.query(normals, threads), piece) for x, piece in self.pieces])


@dataclass(frozen=True, eq=False)
class Offset:
    """The index of an offset of a surface, by the index of that surface (the basis).

    Both have the same parameters. Their normals are opposite where the offset has passed exactly
    one centre of principal curvature: there (1 + d κ₁) (1 + d κ₂) is negative.
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
        """Return the points of the basis at which the normal of the offset is `sign` times its own.

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
        """Return enclosures (k,) of numbers with the sign of the dot product of both normals.

        Somewhere within the radii (k, 2), the normal of the basis is exactly that of normals
        (k, 3).
        """
        bounds = bounds_over_boxes(self.tape, uv, radius)
        factors = zip((U2, U1V1, V2, U1, V1), (2.0, 1.0, 2.0, 1.0, 1.0), strict=True)
        vectors = [
            Vector._make(factor * Ball(bounds[:, 0, k, x], bounds[:, 1, k, x]) for x in range(3))
            for k, factor in factors
        ]
        patch = Patch._make([*vectors, Vector(0.0, 0.0, 0.0)])
        return python_function(offset_side)(patch, vector(normals), self.distance)


def _wider(surface: Surface, gap: float) -> Surface:
    """Return a surface over a domain that is larger at open sides, unless they are points."""
    sides = list(np.ndindex(2, 2)) if gap > 0.0 else []
    sizes = [np.ptp(_on_side(surface, *x), axis=0).max() for x in sides]
    domain = [list(x) for x in surface.domain]
    for (axis, end), size in zip(sides, sizes, strict=True):
        if surface.boundary[axis][end] == "open" and size > CLOSE * max(sizes):
            domain[axis][end] += (-gap, gap)[end] * float(np.ptp(surface.domain[axis]))
    (u0, u1), (v0, v1) = domain
    return replace(surface, domain=((u0, u1), (v0, v1)), trim=None)


def _on_side(surface: Surface, axis: int, end: int) -> Array:
    """Return some points (PLACES, 3) on a side."""
    low, high = surface.domain[1 - axis]
    places = np.full(PLACES, surface.domain[axis][end]), np.linspace(low, high, PLACES)
    return surface.jets(*(places if axis == 0 else places[::-1]))[:, 0]


def _inside(found: ProvedPlaces, piece: Surface) -> FacePlaces:
    """Return points and boxes moved into the domain of a piece, at its open sides.

    The radius of a point grows by the distance that it moved. Boxes outside are left out.
    """
    is_open = np.array(piece.boundary) == "open"
    low, high = np.where(is_open, piece.domain, [-np.inf, np.inf]).T
    uv, open_ = np.clip(found.uv, low, high), found.undecided
    sides = open_.boxes.reshape(-1, 2, 2)
    within = ((sides[:, :, 0] < high) & (sides[:, :, 1] > low)).all(axis=1)
    open_, sides = Undecided._make(x[within] for x in open_), sides[within]
    boxes = np.clip(sides, low[:, None], high[:, None])
    return FacePlaces(
        found.numbers, uv, found.radius + np.abs(found.uv - uv), found.sign.astype(np.float64),
        open_._replace(boxes=boxes.reshape(-1, 4), uv=np.clip(open_.uv, low, high)),
    )  # fmt: skip


def _has_corners_that_meet(surface: Surface) -> bool:
    """Return whether a side of the domain may be one point: two corners are close together."""
    (u0, u1), (v0, v1) = surface.domain
    places = np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)]).T.copy()
    points = surface.jets(*places)[:, 0]
    gaps = np.linalg.norm(np.roll(points, 1, axis=0) - points, axis=1)
    return bool(gaps.min() <= CLOSE * gaps.max())
