"""A face of a part as what is sampled: its surface, the lines where that is cut, and its border."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...runtime.surface.surface import Surface
from .borders import Border
from .faces import own_parameters
from .part import Face
from .records import Geometry

__all__ = ["FacePiece", "pieces_of"]

Array = NDArray[np.float64]

# Angles are divided into parts of at most this, in radians.
ANGLE = 0.25
# The parts between two knots, at least: polynomials of higher degrees turn in between.
PARTS_OF_SPAN = 2
# Lines that are closer to one another than this part of the domain are one.
SAME_LINE = 1e-9
# The distance from the border of places beside it, relative to the domain.
BESIDE = 1e-6
# Which parameters of a kind of face are angles.
ANGLES = {
    "cylinder": (True, False),
    "cone": (True, False),
    "sphere": (True, True),
    "torus": (True, True),
    "revolution": (True, False),
}


@dataclass(frozen=True, eq=False)
class FacePiece:
    """A face, and its surface, whose normals point outward."""

    face: Face
    surface: Surface

    @property
    def sizes(self) -> Array:
        """The lengths (2,) of the domain."""
        low, high = np.array(self.surface.domain).T
        return high - low

    @property
    def middle(self) -> Array:
        """The parameters (2, 1) of the middle of the domain."""
        return np.array(self.surface.domain).mean(axis=1, keepdims=True)

    @cached_property
    def boxes(self) -> Array:
        """Boxes (M, 4) that the domain is made of, in each of which the surface is smooth."""
        lines = [_lines(self.face, axis, self.surface.domain[axis]) for axis in (0, 1)]
        low = np.stack(np.meshgrid(*(x[:-1] for x in lines), indexing="ij"), axis=-1)
        high = np.stack(np.meshgrid(*(x[1:] for x in lines), indexing="ij"), axis=-1)
        return np.concatenate([low, high], axis=-1).reshape(-1, 4)

    @property
    def polygons(self) -> list[Array]:
        """The closed polygons (k, 2) around it, the first point of which is not repeated.

        Loops of files leave the domain by rounding, or by the tolerance of the file: these do not.
        """
        (u0, v0), (u1, v1) = low, high = np.array(self.surface.domain).T
        if self.surface.trim is None:
            return [np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])]
        is_reversed = self.face.reversed
        loops = [own_parameters(self.surface, x, is_reversed=is_reversed) for x in self.face.loops]
        return [np.clip(x, low, high) for x in loops]

    def border(self, n: int) -> Border | None:
        """Return the border on a raster of n × n pixels, None if there is none."""
        trim = self.surface.trim
        if trim is None:
            return None
        held = self.__dict__.setdefault("_borders", {})
        if n not in held:
            held[n] = Border(trim, self.surface.domain, n)
        return held[n]

    def contains(self, places: Array) -> NDArray[np.bool_]:
        """Return which places (k, 2) are inside the trim."""
        trim = self.surface.trim
        return np.ones(len(places), np.bool_) if trim is None else trim.contains(places, 1)

    def beside_border(self, n: int) -> Array:
        """Return places (k, 2) inside, next to the border, 1/n of the domain apart at most."""
        found = [_beside(x, self.sizes, n) for x in self.polygons]
        places = np.concatenate([np.empty((0, 2)), *found])
        low, high = np.array(self.surface.domain).T
        places = places[((places > low) & (places < high)).all(axis=1)]
        return places[self.contains(places)]


def pieces_of(faces: tuple[Face, ...]) -> tuple[list[FacePiece], dict[int, str]]:
    """Return the faces that can be sampled, and by their index why others cannot."""
    from ...runtime.base.errors import GaussmapError

    pieces, reasons = [], {}
    for face in faces:
        try:
            piece = FacePiece(face, face.surface)
            usable = np.isfinite(piece.surface.jets(*piece.middle)).all()
        except GaussmapError as error:
            reasons[face.index] = str(error)
        else:
            if usable and face.area > 0.0:
                pieces.append(piece)
            else:
                lack = "it has no area" if usable else "its surface is not finite"
                reasons[face.index] = f"{face.label} cannot be used: {lack}."
    return pieces, reasons


def _lines(face: Face, axis: int, ends: tuple[float, float]) -> Array:
    """Return where the domain is cut along an axis: at knots, and into parts of them."""
    (knots, degree), geometry = _knots(face.geometry, axis), face.geometry
    while geometry.basis is not None:
        geometry = geometry.basis
    if axis == 0 and face.reversed:  # as u of its surface is
        knots = sum(ends) - knots
    period = face.periods[axis]
    if period > 0.0 and len(knots):
        turns = np.arange(-2, 3) * period
        knots = np.unique(knots + turns[:, None])
    slack = SAME_LINE * (ends[1] - ends[0])
    inside = np.sort(knots[(knots > ends[0] + slack) & (knots < ends[1] - slack)])
    inside = inside[np.diff(inside, prepend=-np.inf) > slack]
    lines = np.concatenate([[ends[0]], inside, [ends[1]]])
    parts = max(PARTS_OF_SPAN, math.ceil(degree / 2)) if len(knots) else 1
    if ANGLES.get(geometry.kind, (False, False))[axis]:
        parts = math.ceil((ends[1] - ends[0]) / ANGLE)
    between = [np.linspace(a, b, parts + 1)[:-1] for a, b in itertools.pairwise(lines)]
    return np.concatenate([*between, lines[-1:]])


def _knots(geometry: Geometry, axis: int) -> tuple[Array, int]:
    """Return the knots of a surface along an axis, and the degree between them; 0 if none."""
    if geometry.basis is not None:
        return _knots(geometry.basis, axis)
    net, of_curve = geometry.net, {"revolution": 1, "extrusion": 0}.get(geometry.kind)
    if net is None or of_curve not in (None, axis):
        return np.empty(0), 0
    place = axis if of_curve is None else 0
    return np.unique(net.knots[place]), net.degrees[place]


def _beside(polygon: Array, sizes: Array, n: int) -> Array:
    """Return places (k, 2) on both sides of a polygon, no farther apart than 1/n of the domain."""
    ends = np.roll(polygon, -1, axis=0)
    along = (ends - polygon) / sizes
    lengths = np.hypot(*along.T)
    parts = np.maximum(np.ceil(lengths * n), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(polygon)), parts)
    number = np.arange(len(owner)) - (np.cumsum(parts) - parts)[owner]
    places = polygon[owner] + ((number + 0.5) / parts[owner])[:, None] * (ends - polygon)[owner]
    unit = along / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    across = BESIDE * sizes * np.stack([-unit[:, 1], unit[:, 0]], axis=1)[owner]
    return np.concatenate([places + across, places - across])
