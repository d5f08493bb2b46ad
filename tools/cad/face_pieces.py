"""A face of a part as a piece to sample: its surface, the lines that divide it, its boundary."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...runtime.base.errors import GaussmapError, GaussmapWarning
from ...runtime.base.kept import kept
from ...runtime.base.memory import check_memory
from ...runtime.base.scales import scale_to_one
from ...runtime.directions.regions import Reach
from ...runtime.domain.domain import Domain
from ...runtime.domain.loops import CORNERS
from ...runtime.domain.trim import Trim
from ...runtime.onto_surface.cut_components import components_in
from ...runtime.onto_surface.on_spline import OnSpline, on_grids
from ...runtime.onto_surface.on_surface import geometry_of
from ...runtime.onto_surface.proved import CODE, proof_of, with_components
from ...runtime.onto_surface.reach import in_reach
from ...runtime.onto_surface.tip_degrees import Fan, Tip, Tipped, tips_of_fans
from ...runtime.samples.fields import ARRAY_NAMES_OF_PART, Component, bytes_of, dtype_of
from ...runtime.samples.report import SamplingReport, UndecidedNormal
from ...runtime.samples.samples import Samples
from ...runtime.spline.kernels.jets import evaluate_jets
from ...runtime.surface.derivatives import normals_of_jets
from ...runtime.surface.sides import with_found_sides
from ...runtime.surface.surface import Surface
from ..density.piece import Piece, boxes_between
from .face_indices import GAP, face_index
from .face_places import FaceIndex, FacePlaces
from .faces import own_parameters
from .part import Face
from .records import KINDS, Geometry

Array, Indices = NDArray[np.float64], NDArray[np.int64]
Flags = NDArray[np.bool_]

# A parameter that is an angle is divided into parts of at most this size, in radians.
ANGLE = 0.25
# A span between two knots is divided into at least PARTS_OF_SPAN parts, since polynomials of higher
# degrees may turn in it, but into fewer parts if a parameter would have more than MOST_PARTS parts.
PARTS_OF_SPAN, MOST_PARTS = 2, 64
# Dividing lines closer to one another than this fraction of the domain count as one line.
SAME_LINE = 1e-9
# Points of faces within this distance, relative to the size of the largest face, are one tip.
SAME_TIP = 1e-6
# The number of parts along each parameter of a surface with an unknown function.
PARTS_OF_SURFACE = 16
# Curvatures at a pole are taken at this distance from it, relative to the domain.
BESIDE = 1e-6
CURVATURES = ("gaussian_curvature", "mean_curvature")
# A parameter pair outside the trim is in the gap between two faces if a step in one of the
# directions CORNERS leads into the trim. Steps are at most FAR times the domain.
FAR = 1e-5
# Without a proof, and for normals of lattices, points are searched on a spline. It has CELLS_A_PART
# cells for each part between dividing lines, but at least FEWEST and at most MOST cells along each
# parameter. Fewer cells would lose points near the boundary, because of the error of the spline.
CELLS_A_PART, FEWEST, MOST = 3, 64, 256
# A raster of a face has about RASTER² positions.
RASTER = 64


@dataclass(frozen=True, eq=False, kw_only=True)
class FacePiece(Piece):
    """A face of a part, restricted to a `reach`; its surface has the orientation of the face."""

    face: Face
    surface: Surface
    reach: Reach | None = None

    @classmethod
    def of(cls, face: Face, reach: Reach | None = None) -> FacePiece:
        """Return a face as a piece; GaussmapError if it has no surface."""
        surface, indices = face.surface, {"face_index": face.index, "solid_index": face.solid_index}
        trim = (in_reach(surface, reach) or surface).trim
        return cls(
            label=face.label, domain=surface.domain, trim=trim, indices=indices,
            face=face, surface=surface, reach=reach,
        )  # fmt: skip

    @cached_property
    def size(self) -> float:
        """The square root of the area, in L."""
        return math.sqrt(self.area)

    @property
    def area(self) -> float:
        """The area of the face inside the reach, in L²."""
        return self.face.area * self._share

    @cached_property
    def _share(self) -> float:
        """The fraction of the area of the face that is inside the reach, measured on a raster."""
        if self.reach is None:
            return 1.0
        jets = self.on_raster()
        areas = np.linalg.norm(np.cross(jets[:, 1], jets[:, 2]), axis=1)
        inside = self.reach._holds(jets[:, 0], normals_of_jets(jets))
        return float(areas[inside].sum() / areas.sum()) if inside.any() else 0.0

    def on_raster(self) -> Array:
        """Return the 2-jets (k, 6, 3) on a raster of the domain, inside the trim."""
        n = max(2, math.ceil(RASTER / math.sqrt(len(self.boxes))))
        shares = (np.indices((n, n)).reshape(2, -1).T + 0.5) / n
        low, sizes = self.boxes[:, None, :2], self.boxes[:, None, 2:] - self.boxes[:, None, :2]
        places = (low + shares * sizes).reshape(-1, 2)
        trim = self.surface.trim
        places = places if trim is None else places[trim.contains(places)]
        return self.surface.jets(*places.T.copy())

    @property
    def boxes(self) -> Array:
        """The boxes (M, 4) that partition the domain; the surface is smooth in each."""
        geometry, domain = self.face.geometry, self.surface.domain
        u, v = (_lines(self.face, geometry, axis, domain[axis]) for axis in (0, 1))
        return boxes_between(u, v)

    def lines(self, axis: int) -> Array:
        """Return the values of u (axis 0) or v (axis 1) between which the surface is smooth."""
        return np.unique(self.boxes[:, [axis, axis + 2]])

    @property
    def polygons(self) -> list[Array]:
        """The closed polygons (k, 2) that bound the face; the first point is not repeated.

        Loops in files exceed the domain by rounding, or by the tolerance of the file; these
        polygons do not.
        """
        (u0, v0), (u1, v1) = low, high = np.array(self.surface.domain).T
        if self.surface.trim is None:
            return [np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])]
        is_reversed = self.face.reversed
        loops = [own_parameters(self.surface, x, is_reversed=is_reversed) for x in self.face.loops]
        return [np.clip(x, low, high) for x in loops]

    def jets(self, u: Array, v: Array) -> Array:
        """Return 2-jets (k, 6, 3) at parameters."""
        return self.surface.unchecked_jets(*np.array([u, v]))  # checks are slow for few points

    def geometries(self, threads: int | None) -> list[OnSpline]:
        """Return the splines on which points are searched; GaussmapError if there is no spline."""
        found = kept(self.surface, FacePiece, self._geometries)
        return [x.used(np.float64, threads).within(self.reach) for x in found]

    def proved_at(self, normals: Array, threads: int | None) -> list[Samples] | None:
        """Return samples at all points with unit normals (S, 3), which are proved to be all.

        Return None if no proof is possible.
        """
        index = kept(self.surface, face_index, self._index)
        if index is None:
            return None
        found = index.query(normals, threads)
        nothing = not len(found.numbers) and not len(found.undecided.numbers) and not self.tips
        return [] if nothing else [self._samples(normals, found)]

    @property
    def tips(self) -> Sequence[Tip]:
        """The tips of the part that are counted with this face."""
        part = self.face.part
        return kept(part, Tip, lambda: _tips_of(part.faces)).get(self.face.index, ())

    def component_degrees(self, normals: Array) -> Indices:
        """Return, for each normal, the sum of the degrees of its components.

        The degrees are those of the Gauss map. Regular points, and components without a sample, do
        not count.
        """
        index, degrees = kept(self.surface, face_index, self._index), np.zeros(len(normals))
        for tip in self.tips:
            degrees += tip.degrees(normals)
        if index is not None:
            found = components_in(self.trim, index.query(normals).undecided, normals, self.jets)[0]
            degrees += np.bincount(found.numbers, np.nan_to_num(found.degree), len(normals))
        return degrees.astype(np.int64)

    def _samples(self, normals: Array, found: FacePlaces) -> Samples:
        """Return samples at the points `found` that are inside the trim, and at tips.

        `normals` (S, 3) are the normals of the search.
        """
        inside = self._owns(found.uv)
        places = np.column_stack([found.uv, found.radius, found.sign, 0.0 * found.sign])[inside]
        components, open_ = components_in(self.trim, found.undecided, normals, self.jets)
        numbers, places = with_components(found.numbers[inside], places, components)
        for tip in self.tips:  # tips come after the other points of a normal
            has = tip.degrees(normals) != 0
            if self.reach is not None:
                has &= self.reach._holds(tip.point + 0.0 * normals, normals)
            (rows,) = np.nonzero(has)
            row = [*tip.uv, 0.0, 0.0, 1.0, 0.0, Component.TIP]
            numbers = np.concatenate([numbers, rows])
            places = np.concatenate([places, np.tile(row, (len(rows), 1))])
            order = np.argsort(numbers, kind="stable")
            numbers, places = numbers[order], places[order]
        proof = proof_of(normals, open_, self.face.index)
        return self.samples_of(normals, numbers, places, proof.undecided)

    def samples_of(
        self, normals: Array, numbers: Indices, places: Array,
        undecided: Sequence[UndecidedNormal] = (),
    ) -> Samples:  # fmt: skip
        """Return samples at `places`; sample i has the normal with index numbers[i] in `normals`.

        `places` (k, 7) has the columns that `with_components` returns.
        """
        check_memory("stored", len(numbers), bytes_of(ARRAY_NAMES_OF_PART, np.float64))
        given, uv, codes = normals[numbers], places[:, :2], places[:, CODE].astype(np.uint8)
        fields = self.fields_at(uv, uv, ARRAY_NAMES_OF_PART, np.float64)
        lost = ~fields["normals"].any(axis=1)
        if lost.any():  # at a pole
            beside = uv[lost] + BESIDE * (self.middle.T - uv[lost])
            for name, values in self.fields_at(beside, beside, CURVATURES, np.float64).items():
                fields[name][lost] = values
        fields["gaussian_curvature"][codes != Component.REGULAR] = 0.0
        fields["mean_curvature"][codes == Component.TIP] = 0.0
        fields["gaussian_curvature"] = np.copysign(fields["gaussian_curvature"], places[:, 4])
        report = SamplingReport(
            self.label, len(normals), len(uv), None, None, None, undecided=tuple(undecided)
        )
        arrays: dict[str, Any] = {
            **fields,
            "normals": given,
            "support": np.einsum("kx,kx->k", fields["points"], given),
            "normal_index": numbers,
            "uv_radius": places[:, 2:4],
            "component": codes,
        }
        return Samples(**arrays, report=report)

    def _owns(self, uv: Array) -> Flags:
        """Return a mask (k,) of the parameter pairs (k, 2) that belong to the face.

        They are inside its trim or, on faces of files, in the gap beside it: a step in one of four
        directions leads into the trim. The step is a sum of two parts: one turns the normal by
        about `GAP`, and is at most `FAR` times the domain; the other is `GAP` times the domain.
        """
        trim, inside = self.surface.trim, self.contains(uv)
        if trim is None or inside.all() or self.face.geometry.surface is not None:
            return inside
        (out,) = np.nonzero(~inside)
        out = out[_any_inside(trim, uv[out, None] + FAR * self.sizes * CORNERS)]
        if len(out) == 0:
            return inside
        jets = self.jets(*uv[out].T.copy())
        normals, lengths = normals_of_jets(jets), np.linalg.norm(jets[:, 1:3], axis=2)
        a, b, c = np.einsum("kjx,kx->jk", jets[:, 3:], normals)[:, :, None]
        p, q = GAP * np.moveaxis(CORNERS * lengths[:, None], 2, 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = np.stack([c * p - b * q, a * q - b * p]) / (a * c - b * b)
        most = FAR * self.sizes
        steps = np.clip(np.nan_to_num(np.moveaxis(steps, 0, 2)), -most, most)
        near = _any_inside(trim, uv[out, None] + GAP * self.sizes * CORNERS + steps)
        if self.reach is not None:
            near &= self.reach._contains(normals)
        inside[out] = near
        return inside

    def _index(self) -> FaceIndex | None:
        face = self.face
        return face_index(face.geometry, self.surface, face.domain, is_reversed=face.reversed)

    def _geometries(self) -> list[OnSpline]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", GaussmapWarning)  # the spline gives only first guesses
            pieces = self.surface.pieces()
            return on_grids([geometry_of(x, self._cells(x.domain), "surface") for x in pieces])

    def _cells(self, domain: Domain) -> tuple[int, int]:
        """Return the numbers of cells of a spline over a domain, from the number of `lines` in it.

        A choice by `fit`, which compares splines, would take longer than everything else.
        """
        along_u, along_v = (
            min(max(CELLS_A_PART * (1 + int(((lines > low) & (lines < high)).sum())), FEWEST), MOST)
            for lines, (low, high) in zip((self.lines(0), self.lines(1)), domain, strict=True)
        )
        return along_u, along_v

    def fields_at(
        self, uv: Array, rows: Array, fields: Sequence[str], dtype: DTypeLike
    ) -> dict[str, NDArray[Any]]:
        """Return the requested fields of samples at parameters (k, 2)."""
        jets, count = self.jets(*uv.T.copy()), len(uv)
        normals, K, H = np.empty((count, 3)), np.empty(count), np.empty(count)
        scales = np.array([scale_to_one(self.size), *self.sizes])
        evaluate_jets(jets, scales, normals, K, H)
        found = {
            "points": jets[:, 0],
            "normals": normals,
            "support": np.einsum("ij,ij->i", jets[:, 0], normals),
            "uv": uv,
            "gaussian_curvature": K,
            "mean_curvature": H,
            "normal_index": np.full(count, -1),
            "on_surface": np.ones(count, dtype=np.bool_),
        }
        return {
            x: y.astype(dtype_of(x, dtype), copy=False) for x, y in found.items() if x in fields
        }


def _tips_of(faces: tuple[Face, ...]) -> dict[int, list[Tip]]:
    """Return the tips at collapsed sides of faces, by the index of the first face around each."""
    fans, owners, size = list[Fan](), list[int](), 0.0
    for face in faces:
        with suppress(GaussmapError):  # a face that cannot be used
            if any(face.surface.assumed_open):
                surface = with_found_sides(face.surface)[0]
                tipped = Tipped(
                    lambda u, v, x=surface: x.unchecked_jets(*np.array([u, v])),
                    surface.domain, surface.boundary, surface.trim,
                )  # fmt: skip
                fans += tipped.fans(tipped.sides())
                owners += [face.index] * (len(fans) - len(owners))
                size = max(size, face.area)
    found: dict[int, list[Tip]] = {}
    for around, tip in tips_of_fans(fans, SAME_TIP * math.sqrt(size)):
        found.setdefault(owners[around[0]], []).append(tip)
    return found


def _any_inside(trim: Trim, places: Array) -> Flags:
    """Return a mask (n,) of the rows of parameter pairs (n, k, 2) with a pair inside a trim."""
    inside = trim.contains(places.reshape(-1, 2), 1)
    return np.any(inside.reshape(places.shape[:2]), axis=1)


def pieces_of(
    faces: tuple[Face, ...], reach: Reach | None = None
) -> tuple[list[FacePiece], dict[int, str]]:
    """Return the pieces of all faces that can be sampled, and the reasons why others cannot be.

    The reasons are a dict by face index. Faces without points in the `reach` are in neither.
    """
    pieces, reasons = [], {}
    for face in faces:
        try:
            piece = FacePiece.of(face, reach)
            usable = np.isfinite(piece.surface.jets(*piece.middle)).all()
        except GaussmapError as error:
            reasons[face.index] = str(error)
        else:
            if usable and face.area > 0.0:
                pieces += [piece] if piece.size > 0.0 else []
            else:
                lack = "it has no area" if usable else "its surface is not finite"
                reasons[face.index] = f"{face.label} cannot be used: {lack}."
    return pieces, reasons


def _lines(face: Face, geometry: Geometry, axis: int, ends: tuple[float, float]) -> Array:
    """Return the values of a parameter that divide the domain, from one end to the other.

    They are knots, and further values between knots. `axis` is 0 for u, 1 for v.
    """
    knots, degree = _knots(geometry, axis)
    while geometry.basis is not None:
        geometry = geometry.basis
    if axis == 0 and face.reversed:  # u of its surface is reversed, too
        knots = sum(ends) - knots
    lines, parts = np.array(ends), 1
    if len(knots):
        lines = _between(knots, ends, face.periods[axis])
        most = max(MOST_PARTS // (len(lines) - 1), 1)
        parts = min(max(PARTS_OF_SPAN, math.ceil(degree / 2)), most)
    if geometry.surface is not None:
        parts = PARTS_OF_SURFACE
    kind = KINDS[geometry.kind]
    if (kind.u, kind.v)[axis] == "angle":
        parts = math.ceil((ends[1] - ends[0]) / ANGLE)
    if parts == 1:
        return lines
    between = [np.linspace(a, b, parts + 1)[:-1] for a, b in itertools.pairwise(lines)]
    return np.concatenate([*between, lines[-1:]])


def _between(knots: Array, ends: tuple[float, float], period: float) -> Array:
    """Return both ends of an interval, and the knots between them, repeated with the period."""
    if period > 0.0:
        turns = np.arange(-2, 3) * period
        knots = np.unique(knots + turns[:, None])
    slack = SAME_LINE * (ends[1] - ends[0])
    inside = np.sort(knots[(knots > ends[0] + slack) & (knots < ends[1] - slack)])
    inside = inside[np.diff(inside, prepend=-np.inf) > slack]
    return np.concatenate([[ends[0]], inside, [ends[1]]])


def _knots(geometry: Geometry, axis: int) -> tuple[Array, int]:
    """Return the knots in u (axis 0) or v (axis 1), and the degree; 0 if there are no knots."""
    if geometry.basis is not None:
        return _knots(geometry.basis, axis)
    net, of_curve = geometry.net, {"revolution": 1, "extrusion": 0}.get(geometry.kind)
    if net is None or of_curve not in (None, axis):
        return np.empty(0), 0
    place = axis if of_curve is None else 0
    return np.unique(net.knots[place]), net.degrees[place]
