"""The edges of all faces, as parameters on each face, and the wires that they form."""

# pyright: reportMissingImports=false

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS

from ..records import EdgeRecord, FaceRecord, Wire
from ..units import scaled_parameters
from .faces import FaceReader
from .loops import EdgeCurves
from .p_curves import PCurve
from .shapes import indexed_shapes, parts_of
from .solids import PlacedFace

Array = NDArray[np.float64]
Wires = list[Wire]

# P-curves are the curves of edges in the parameter planes of faces. A p-curve that is not straight
# has one point per ANGLE, in radians, if it is a circle, and POINTS_A_PIECE points per piece
# otherwise; it has LEAST to MOST points in all.
ANGLE, POINTS_A_PIECE, LEAST, MOST = 0.15, 4, 9, 1025
FORWARD, REVERSED = TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED
EDGE = TopAbs_ShapeEnum.TopAbs_EDGE


@dataclass(frozen=True)
class Topology:
    """The edges between faces, the vertices (V, 3) at their ends, and the wires of each face."""

    edges: list[EdgeRecord]
    vertices: Array
    wires: list[Wires]


@dataclass
class Known:
    """An edge, the indices of its adjacent faces, and its p-curve on each of these faces."""

    edge: Any
    faces: list[int] = field(default_factory=list)
    curves: list[PCurve | None] = field(default_factory=list)


def topology_of(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord], factor: float, reader: FaceReader
) -> Topology:
    """Return all edges of faces, and their order around each face.

    The smoothness that a file claims is often wrong, and is ignored. Faces that failed, or have an
    edge without p-curve, have no wires. Parameters that are lengths are multiplied by `factor`; the
    parameters of the faces themselves are multiplied later.
    """
    numbers, known, wires = indexed_shapes(), list[Known](), list[Wires]()
    for k, (face, record) in enumerate(zip(placed, faces, strict=True)):
        forward = face.sewn.Oriented(FORWARD)
        found = [] if record.reason else _ordered(forward, reader)
        sides = [(numbers.Add(x) - 1, x) for x in parts_of(forward, EDGE)]
        steps = [
            [((numbers.FindIndex(x) - 1, x.Orientation()), curve) for x, curve in wire]
            for wire in found
        ]
        curves, places = dict(itertools.chain(*steps)), dict[tuple[int, Any], int]()
        for number, edge in sides:
            if number == len(known):
                known.append(Known(TopoDS.Edge(edge.Oriented(FORWARD))))
            side = number, edge.Orientation()
            places.setdefault(side, len(known[number].faces))
            known[number].faces.append(k)
            known[number].curves.append(curves.get(side))
        wires.append([[(x[0], places[x], curve.reversed) for x, curve in wire] for wire in steps])
    scales = [np.tile(scaled_parameters(x.geometry, factor), 2) for x in faces]
    vertices = _Vertices()
    edges = [_record(x, scales, vertices) for x in known]
    return Topology(edges, factor * vertices.points, wires)


def _ordered(face: Any, reader: FaceReader) -> EdgeCurves:  # noqa: ANN401
    """Return the edges of each wire of a face, in order, with their p-curves."""
    try:
        return reader.wires(face)
    except Exception:  # of Open CASCADE: without p-curves there are no wires
        return []


def _record(known: Known, scales: list[Array], vertices: _Vertices) -> EdgeRecord:
    """Return the record of an edge; parameters are NaN on faces where it has no p-curve."""
    shares = np.linspace(0.0, 1.0, max((_points(x) for x in known.curves if x), default=2))
    sides = np.full((len(shares), len(known.faces), 4), np.nan)
    for k, (face, curve) in enumerate(zip(known.faces, known.curves, strict=True)):
        if curve is not None:
            sides[:, k] = _uv(curve, shares) * scales[face]
    return EdgeRecord(
        tuple(known.faces),
        sides[:, :, :2].reshape(len(shares), -1),
        sides[:, :, 2:].reshape(len(shares), -1),
        (vertices.place(TopExp.FirstVertex_s(known.edge)),
         vertices.place(TopExp.LastVertex_s(known.edge))),
        bool(BRep_Tool.Degenerated_s(known.edge)),
    )  # fmt: skip


class _Vertices:
    """The vertices of all edges, each once."""

    def __init__(self) -> None:
        self._numbers = indexed_shapes()
        self._points: list[tuple[float, float, float]] = []

    @property
    def points(self) -> Array:
        return np.array(self._points, dtype=np.float64).reshape(-1, 3)

    def place(self, vertex: Any) -> int:  # noqa: ANN401
        """Return the index of a vertex, appending it if it is new; −1 for a null vertex."""
        if vertex.IsNull():
            return -1
        place = self._numbers.Add(vertex) - 1
        if place == len(self._points):
            self._points.append(BRep_Tool.Pnt_s(vertex).Coord())
        return place


def _points(curve: PCurve) -> int:
    """Return the number of points that represent a p-curve."""
    if not curve.pieces:
        return 2
    if curve.radius:
        number = math.ceil((curve.ends[-1] - curve.ends[0]) / ANGLE)
    else:
        number = POINTS_A_PIECE * curve.pieces * (len(curve.ends) - 1)
    return min(max(number + 1, LEAST), MOST)


def _uv(curve: PCurve, shares: Array) -> Array:
    """Return u, v and their derivatives (k, 4) at positions `shares` (k,) on a p-curve, 0 to 1."""
    first, last = curve.ends[0], curve.ends[-1]
    if curve.pieces:
        found = curve.evaluate(first + (last - first) * shares)
        found[:, 2:] *= last - first
        return found
    ends = curve.chord
    found = np.empty((len(shares), 4))
    found[:, 2:] = ends[1] - ends[0]
    found[:, :2] = ends[0] + shares[:, None] * found[:, 2:]
    return found
