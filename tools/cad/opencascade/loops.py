"""The trim of a face: the polygons in u and v that its p-curves form."""

# pyright: reportMissingImports=false

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from ..records import NO_AREA
from .curves import UnusableError
from .p_curves import CONFUSION, PCurve, curve_of
from .shapes import parts_of

Array = NDArray[np.float64]
# The edges of each wire of a face with their p-curves, in order.
EdgeCurves = list[list[tuple[Any, PCurve]]]

# Polygons deviate from the p-curves by at most OF_BOX times the bounding box of the face in u and
# v, and by at most OF_WIDTH times the mean width of the face. A deviation of LEAST times the
# bounding box is always allowed.
OF_BOX, OF_WIDTH, LEAST = 1e-4, 1e-3, 1e-7
# Wider gaps between consecutive curves, relative to the box, are errors unless the tolerances of
# the edges allow them.
GAP = 1e-2
# Points count as equal up to this distance, relative to the box.
SAME = 1e-12
# Numbers of at least this modulus stand for infinity in Open CASCADE.
INFINITE = 1e50
FORWARD, REVERSED = TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED
EDGE, WIRE = TopAbs_ShapeEnum.TopAbs_EDGE, TopAbs_ShapeEnum.TopAbs_WIRE


def loops_of(face: Any, wires_of: Callable[[Any], EdgeCurves]) -> tuple[list[Array], float]:  # noqa: ANN401
    """Return the closed polygons of a face, and the largest gap that they close, in mm.

    Raises UnusableError with the reason if there are none. The face is oriented forward, so that it
    lies to the left of its curves.
    """
    u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
    bounds = np.array([(u0, v0), (u1, v1)])
    if not (np.isfinite(bounds).all() and np.abs(bounds).max() < INFINITE):
        raise UnusableError("it has no boundary, and its surface has no end")
    size = bounds[1] - bounds[0]
    if not (size > 0.0).all():
        raise UnusableError(NO_AREA)
    edges = wires_of(face)
    wires = [[curve for _, curve in wire] for wire in edges]
    if not wires:
        return [np.array([(u0, v0), (u1, v0), (u1, v1), (u0, v1)])], 0.0
    gap = _gap_of(BRep_Tool.Surface_s(face), edges, size)
    loops = _polygons(wires, size, OF_BOX)
    width = _mean_width(loops, size)
    if width * OF_WIDTH < OF_BOX:
        loops = _polygons(wires, size, max(width * OF_WIDTH, LEAST))
    if not loops:
        raise UnusableError(NO_AREA)
    return loops, gap


def _polygons(wires: list[list[PCurve]], size: Array, tolerance: float) -> list[Array]:
    polygons = []
    for curves in wires:
        lines = [x.polyline(tolerance * size) for x in curves]
        polygon = np.concatenate(lines)
        step = np.abs(polygon - np.concatenate([polygon[-1:], polygon[:-1]]))
        polygon = polygon[(step > SAME * size).any(axis=1)]
        if len(polygon) >= 3:
            polygons.append(polygon)
    return polygons


def _gap_of(surface: Any, wires: EdgeCurves, size: Array) -> float:  # noqa: ANN401
    """Return the largest gap between consecutive p-curves of wires, as a distance in space.

    Raises UnusableError if a gap is wider than the tolerances of its edges allow, and large
    relative to the bounding box.
    """
    gap = 0.0
    for wire in wires:
        ends = [x.chord[::-1] if x.reversed else x.chord for _, x in wire]
        for k, (first, _) in enumerate(ends):
            last = ends[k - 1][1]
            if (last != first).any():
                distance = surface.Value(*last.tolist()).Distance(surface.Value(*first.tolist()))
                allowed = CONFUSION + sum(BRep_Tool.Tolerance_s(wire[n][0]) for n in (k - 1, k))
                is_wide = (np.abs(last - first) > GAP * size).any()
                if is_wide and distance > allowed:
                    raise UnusableError("its boundary is not closed")
                gap = max(gap, distance)
    return gap


def _mean_width(loops: list[Array], size: Array) -> float:
    """Return the area of polygons divided by half their perimeter, in units of the bounding box."""
    area = length = 0.0
    for loop in loops:
        scaled = (loop - loop[0]) / size
        steps = np.concatenate([scaled[1:], scaled[:1]]) - scaled
        area += float(scaled[:, 0] @ steps[:, 1] - scaled[:, 1] @ steps[:, 0])
        length += float(np.hypot(*steps.T).sum())
    return abs(area) / length if length else 0.0


def wires_of(face: Any) -> EdgeCurves:  # noqa: ANN401
    """Return the edges of each wire of a face, in order, with their p-curves.

    The face is oriented forward.
    """
    return [_edges_of(TopoDS.Wire(x), face) for x in parts_of(face, WIRE)]


def _edges_of(wire: Any, face: Any) -> list[tuple[Any, PCurve]]:  # noqa: ANN401
    """Return the edges of a wire and their p-curves, in order."""
    explorer, edges = BRepTools_WireExplorer(wire, face), []
    while explorer.More():
        edges.append(explorer.Current())
        explorer.Next()
    if len(edges) == wire.NbChildren():
        return [(x, curve_of(x, face)) for x in edges]
    every = [x for x in parts_of(wire, EDGE) if x.Orientation() in (FORWARD, REVERSED)]
    if len(edges) == len(every):
        return [(x, curve_of(x, face)) for x in edges]
    # Where edges do not share their vertices, the explorer stops.
    edges = [TopoDS.Edge(x) for x in every]
    curves = [curve_of(x, face) for x in edges]
    return [(edges[k], curves[k]) for k in _chained(curves)]


def _chained(curves: list[PCurve]) -> list[int]:
    """Return the indices of curves as a chain: each is the next one that begins nearest."""
    ends = [x.evaluate(np.array(x.ends))[:, :2] for x in curves]
    ends = [x[::-1] if curve.reversed else x for x, curve in zip(ends, curves, strict=True)]
    order, left = [0], set(range(1, len(curves)))
    while left:
        here = ends[order[-1]][1]
        order.append(min(sorted(left), key=lambda k: float(np.abs(ends[k][0] - here).max())))
        left.remove(order[-1])
    return order
