"""The edges of all faces, as parameters on each of them, and the loops that they make."""

# pyright: reportMissingImports=false

from __future__ import annotations

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
from .shapes import Key, parts_of
from .solids import PlacedFace

__all__ = ["Topology", "topology_of"]

Array = NDArray[np.float64]
Wires = list[Wire]

# The points of a p-curve that is not straight: an angle between those of circles, a number for each
# piece of others, and the least and the largest number.
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
    """An edge: the faces at its sides, the p-curves there, and the edge as each face has it."""

    edge: Any
    faces: list[int] = field(default_factory=list)
    curves: list[PCurve | None] = field(default_factory=list)
    turns: list[Any] = field(default_factory=list)

    def side(self, face: int, turn: Any) -> int:  # noqa: ANN401
        """Return the place of a side among those of the edge."""
        pairs = zip(self.faces, self.turns, strict=True)
        return next(k for k, pair in enumerate(pairs) if pair == (face, turn))


def topology_of(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord], factor: float, reader: FaceReader
) -> Topology:
    """Return all edges of faces, and how they follow one another around each.

    What the file says of their smoothness is often wrong, and is not asked. Faces that failed, and
    those of whose edges one has no p-curve, have no wires. Parameters that are lengths are
    multiplied by `factor`, as those of the faces will be.
    """
    known: dict[Key, Known] = {}
    ordered = []
    for k, (face, record) in enumerate(zip(placed, faces, strict=True)):
        forward = face.sewn.Oriented(FORWARD)
        ordered.append([] if record.reason else _ordered(forward, reader))
        curves = {(Key(x), x.Orientation()): curve for wire in ordered[-1] for x, curve in wire}
        for edge in parts_of(forward, EDGE):
            key, turn = Key(edge), edge.Orientation()
            at = known.setdefault(key, Known(TopoDS.Edge(edge.Oriented(FORWARD))))
            at.faces.append(k)
            at.turns.append(turn)
            at.curves.append(curves.get((key, turn)))
    scales = [np.tile(scaled_parameters(x.geometry, factor), 2) for x in faces]
    vertices = _Vertices()
    edges = [_record(x, scales, vertices) for x in known.values()]
    places = {key: place for place, key in enumerate(known)}
    wires = [
        [
            [
                (places[Key(x)], known[Key(x)].side(k, x.Orientation()), curve.reversed)
                for x, curve in wire
            ]
            for wire in found
        ]
        for k, found in enumerate(ordered)
    ]
    return Topology(edges, factor * vertices.points, wires)


def _ordered(face: Any, reader: FaceReader) -> EdgeCurves:  # noqa: ANN401
    """Return the edges of each wire of a face, in turn, with their p-curves."""
    try:
        return reader.wires(face)
    except Exception:  # of Open CASCADE: without p-curves there is nothing to say
        return []


def _record(known: Known, scales: list[Array], vertices: _Vertices) -> EdgeRecord:
    """Return an edge; places on a side are NaN where there is no p-curve."""
    shares = np.linspace(0.0, 1.0, max((_points(x) for x in known.curves if x), default=2))
    nothing = np.full((len(shares), 4), np.nan)
    sides = [nothing if x is None else _uv(x, shares) for x in known.curves]
    sides = [x * scales[k] for k, x in zip(known.faces, sides, strict=True)]
    return EdgeRecord(
        tuple(known.faces),
        np.concatenate([x[:, :2] for x in sides], axis=1),
        np.concatenate([x[:, 2:] for x in sides], axis=1),
        (vertices.place(TopExp.FirstVertex_s(known.edge)),
         vertices.place(TopExp.LastVertex_s(known.edge))),
        bool(BRep_Tool.Degenerated_s(known.edge)),
    )  # fmt: skip


class _Vertices:
    """The vertices that edges have, each once."""

    def __init__(self) -> None:
        self._places: dict[Key, int] = {}
        self._points: list[tuple[float, float, float]] = []

    @property
    def points(self) -> Array:
        return np.array(self._points, dtype=np.float64).reshape(-1, 3)

    def place(self, vertex: Any) -> int:  # noqa: ANN401
        """Return the place of a vertex; −1 for none."""
        if vertex.IsNull():
            return -1
        key = Key(vertex)
        if key not in self._places:
            self._places[key] = len(self._points)
            point = BRep_Tool.Pnt_s(vertex)
            self._points.append((point.X(), point.Y(), point.Z()))
        return self._places[key]


def _points(curve: PCurve) -> int:
    """Return how many points stand for a curve."""
    if not curve.pieces:
        return 2
    if curve.radius:
        number = math.ceil((curve.ends[-1] - curve.ends[0]) / ANGLE)
    else:
        number = POINTS_A_PIECE * curve.pieces * (len(curve.ends) - 1)
    return min(max(number + 1, LEAST), MOST)


def _uv(curve: PCurve, shares: Array) -> Array:
    """Return u, v and their derivatives (k, 4) by shares (k,) of a curve, 0 to 1 in its range."""
    first, last = curve.ends[0], curve.ends[-1]
    if curve.pieces:
        found = curve.evaluate(first + (last - first) * shares)
        found[:, 2:] *= last - first
        return found
    ends = curve.evaluate(np.array([first, last]))[:, :2]
    found = np.empty((len(shares), 4))
    found[:, 2:] = ends[1] - ends[0]
    found[:, :2] = ends[0] + shares[:, None] * found[:, 2:]
    return found
