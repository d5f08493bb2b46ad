"""Edges between two faces, as parameters on both of them; which are sharp is found by sampling."""

# pyright: reportMissingImports=false

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from ..records import EdgeRecord, FaceRecord
from ..units import scaled_parameters
from .p_curves import PCurve, curve_of
from .shapes import Key, parts_of
from .solids import PlacedFace

__all__ = ["shared_edges"]

Array = NDArray[np.float64]

# The points of a p-curve that is not straight: an angle between those of circles, a number for each
# piece of others, and the least and the largest number.
ANGLE, POINTS_A_PIECE, LEAST, MOST = 0.15, 4, 9, 1025
FORWARD, REVERSED = TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED


def shared_edges(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord], factor: float
) -> list[EdgeRecord]:
    """Return the edges between two faces.

    What the file says of their smoothness is often wrong, and is not asked. Borders, edges of three
    faces or more, and those that a face has on both sides, such as seams, are left out. Parameters
    that are lengths are multiplied by `factor`, as those of the faces will be.
    """
    found = []
    for sides in _shared(placed, faces):
        if BRep_Tool.Degenerated_s(sides[0][1]):
            continue
        try:
            curves = [
                curve_of(edge, TopoDS.Face(placed[k].sewn.Oriented(FORWARD))) for k, edge in sides
            ]
        except Exception:  # of Open CASCADE: without a p-curve, there is nothing to say
            continue
        shares = np.linspace(0.0, 1.0, max(map(_points, curves)))
        parameters = np.concatenate([_uv(x, shares) for x in curves], axis=1)
        if np.isfinite(parameters).all():
            (i, _), (k, _) = sides
            scales = [scaled_parameters(faces[x].geometry, factor) for x in (i, k)]
            found.append(EdgeRecord((i, k), parameters * np.concatenate(scales)))
    return found


def _shared(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord]
) -> Iterator[list[tuple[int, Any]]]:
    """Yield the edges that two usable faces share: of each face its place, and its edge."""
    users: dict[Key, list[tuple[int, Any]]] = {}
    for k, (face, record) in enumerate(zip(placed, faces, strict=True)):
        for edge in parts_of(face.sewn.Oriented(FORWARD), TopAbs_ShapeEnum.TopAbs_EDGE):
            user = -1 if record.reason else k, TopoDS.Edge(edge)
            users.setdefault(Key(edge), []).append(user)
    for known in users.values():
        if len(known) != 2 or known[0][0] == known[1][0] or min(known[0][0], known[1][0]) < 0:
            continue
        # Edges inside of a face, which bound nothing, have other orientations.
        if all(x.Orientation() in (FORWARD, REVERSED) for _, x in known):
            yield known


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
    """Return u and v (k, 2) at shares (k,) of a curve, from 0 to 1 in its own range."""
    first, last = curve.ends[0], curve.ends[-1]
    if curve.pieces:
        return curve.evaluate(first + (last - first) * shares)[:, :2]
    ends = curve.evaluate(np.array([first, last]))[:, :2]
    return ends[0] + shares[:, None] * (ends[1] - ends[0])
