"""Sharp edges: where two faces meet at an angle, as parameters on both of them."""

# pyright: reportMissingImports=false

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_CurveType as Curves
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from ..records import EdgeRecord, FaceRecord
from ..units import scaled_parameters
from .p_curves import curve_of
from .shapes import Table, parts_of
from .solids import PlacedFace

__all__ = ["sharp_edges"]

Array = NDArray[np.float64]

# The normals of the faces of a sharp edge differ by more than this somewhere, in degrees.
SHARP = 1.0
# The number of points of a curved edge: for each span of a spline, and for other curves.
POINTS_A_SPAN, POINTS = 8, 65
FORWARD = TopAbs_Orientation.TopAbs_FORWARD


def sharp_edges(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord], factor: float
) -> list[EdgeRecord]:
    """Return the edges at which the normals of two faces differ.

    Parameters that are lengths are multiplied by `factor`, as those of the faces will be.
    """
    found = []
    for (i, first), (k, second) in _shared(placed, faces):
        edge = _Edge(first, second, placed[i].sewn, placed[k].sewn)
        try:
            parameters = edge.parameters() if edge.is_sharp() else None
        except Exception:  # of Open CASCADE: without a p-curve, there is nothing to say
            continue
        if parameters is not None and np.isfinite(parameters).all():
            scales = [scaled_parameters(faces[x].geometry, factor) for x in (i, k)]
            found.append(EdgeRecord((i, k), parameters * np.concatenate(scales)))
    return found


def _shared(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord]
) -> Iterator[list[tuple[int, Any]]]:
    """Yield the edges that two usable faces share: of each face its place, and its edge."""
    users: Table[list[tuple[int, Any]]] = Table()
    every = []
    for k, (face, record) in enumerate(zip(placed, faces, strict=True)):
        if record.reason:
            continue
        for edge in parts_of(face.sewn.Oriented(FORWARD), TopAbs_ShapeEnum.TopAbs_EDGE):
            known = users.get(edge)
            if known is None:
                known = []
                users.set(edge, known)
                every.append(known)
            known.append((k, TopoDS.Edge(edge)))
    for known in every:
        if len(known) == 2 and known[0][0] != known[1][0]:
            yield known


class _Edge:
    """An edge with the two faces that it lies between."""

    def __init__(self, first: Any, second: Any, one: Any, other: Any) -> None:  # noqa: ANN401
        self._edge = first
        faces = [TopoDS.Face(x.Oriented(FORWARD)) for x in (one, other)]
        self._curves = [
            curve_of(edge, face) for edge, face in zip((first, second), faces, strict=True)
        ]
        self._surfaces = [BRepAdaptor_Surface(x, False) for x in faces]
        self._signs = [1.0 if x.Orientation() == FORWARD else -1.0 for x in (one, other)]

    def is_sharp(self) -> bool:
        """Return whether the normals of the faces differ somewhere along it."""
        if BRep_Tool.Degenerated_s(self._edge):
            return False
        first, last = self._curves[0].ends[0], self._curves[0].ends[-1]
        t = first + (last - first) * np.array([0.25, 0.5, 0.75])
        normals = [
            sign * _normals(surface, curve.evaluate(t)[:, :2])
            for sign, surface, curve in zip(self._signs, self._surfaces, self._curves, strict=True)
        ]
        cosines = (normals[0] * normals[1]).sum(axis=1)
        return bool((cosines < math.cos(math.radians(SHARP))).any())

    def parameters(self) -> Array:
        """Return u and v on the first and on the second face at points (k, 4) along it."""
        first, last = self._curves[0].ends[0], self._curves[0].ends[-1]
        curve = BRepAdaptor_Curve(self._edge)
        kind, count = curve.GetType(), POINTS
        if kind == Curves.GeomAbs_Line:
            count = 2
        elif kind == Curves.GeomAbs_BSplineCurve:
            count = max(count, POINTS_A_SPAN * (curve.BSpline().NbKnots() - 1) + 1)
        t = np.linspace(first, last, count)
        return np.concatenate([x.evaluate(t)[:, :2] for x in self._curves], axis=1)


def _normals(surface: Any, uv: Array) -> Array:  # noqa: ANN401
    point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    rows = []
    for u, v in uv.tolist():
        surface.D1(u, v, point, along_u, along_v)
        normal = along_u.Crossed(along_v)
        rows.append((normal.X(), normal.Y(), normal.Z()))
    normals = np.array(rows)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)
