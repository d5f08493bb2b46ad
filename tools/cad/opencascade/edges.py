"""Sharp edges: where two faces meet at an angle, as parameters on both of them."""

# pyright: reportMissingImports=false

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.GeomAbs import GeomAbs_SurfaceType
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from ..records import SHARP, EdgeRecord, FaceRecord
from ..units import scaled_parameters
from .p_curves import PCurve, curve_of
from .shapes import Key, parts_of
from .solids import PlacedFace

__all__ = ["sharp_edges"]

Array = NDArray[np.float64]

# The points of a p-curve that is not straight: an angle between those of circles, a number for each
# piece of others, and the least and the largest number.
ANGLE, POINTS_A_PIECE, LEAST, MOST = 0.15, 4, 9, 1025
# Where normals are compared: at first, and along edges that are not sharp there.
FIRST = np.array([0.25, 0.5, 0.75])
ALL = np.linspace(0.0, 1.0, 17)
# There is no normal where the area of x_u and x_v is less than this part of the square of the
# longer one: at poles it is rounding.
NO_AREA = 1e-12
CHORD = 2.0 * math.sin(math.radians(SHARP) / 2.0)
FORWARD, REVERSED = TopAbs_Orientation.TopAbs_FORWARD, TopAbs_Orientation.TopAbs_REVERSED
PLANE = GeomAbs_SurfaceType.GeomAbs_Plane


def sharp_edges(
    placed: Sequence[PlacedFace], faces: Sequence[FaceRecord], factor: float
) -> list[EdgeRecord]:
    """Return the edges at which the normals of two faces differ somewhere.

    What the file says of their smoothness is often wrong, and is not asked. Borders, edges of three
    faces or more, and those that a face has on both sides, such as seams, are left out. Parameters
    that are lengths are multiplied by `factor`, as those of the faces will be.
    """
    found = []
    for (i, first), (k, second) in _shared(placed, faces):
        if BRep_Tool.Degenerated_s(first):
            continue
        try:
            sides = _Side(first, placed[i].sewn), _Side(second, placed[k].sewn)
            parameters = _parameters(*sides) if _is_sharp(*sides) else None
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


class _Side:
    """A face at one of its edges."""

    def __init__(self, edge: Any, face: Any) -> None:  # noqa: ANN401
        whole = TopoDS.Face(face.Oriented(FORWARD))
        self.curve: PCurve = curve_of(edge, whole)
        self.surface = BRepAdaptor_Surface(whole, False)
        # The normal of a plane is the same everywhere.
        self.is_plane = self.surface.GetType() == PLANE
        self._sign = 1.0 if face.Orientation() == FORWARD else -1.0

    @property
    def points(self) -> int:
        """How many points stand for its curve."""
        curve = self.curve
        if not curve.pieces:
            return 2
        if curve.radius:
            number = math.ceil((curve.ends[-1] - curve.ends[0]) / ANGLE)
        else:
            number = POINTS_A_PIECE * curve.pieces * (len(curve.ends) - 1)
        return min(max(number + 1, LEAST), MOST)

    def uv(self, shares: Array) -> Array:
        """Return u and v (k, 2) at shares (k,) of the curve, from 0 to 1 in its own range."""
        first, last = self.curve.ends[0], self.curve.ends[-1]
        if self.curve.pieces:
            return self.curve.evaluate(first + (last - first) * shares)[:, :2]
        ends = self.curve.evaluate(np.array([first, last]))[:, :2]
        return ends[0] + shares[:, None] * (ends[1] - ends[0])

    def normals(self, shares: Array) -> Array:
        """Return the unit normals (k, 3) of the oriented face; NaN where there are none."""
        point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
        rows = np.empty((len(shares), 3))
        for k, (u, v) in enumerate(self.uv(shares[:1] if self.is_plane else shares).tolist()):
            self.surface.D1(u, v, point, along_u, along_v)
            normal = along_u.Crossed(along_v)
            longer = max(along_u.SquareMagnitude(), along_v.SquareMagnitude())
            area = normal.Magnitude()
            scale = self._sign / area if area > NO_AREA * longer else math.nan
            rows[k] = normal.X() * scale, normal.Y() * scale, normal.Z() * scale
        if self.is_plane:
            rows[1:] = rows[0]
        return rows


def _is_sharp(one: _Side, other: _Side) -> bool:
    """Return whether the normals of the faces differ somewhere along their edge."""
    if one.is_plane and other.is_plane:
        return _differ(one, other, FIRST[1:2])
    return _differ(one, other, FIRST) or _differ(one, other, ALL)


def _differ(one: _Side, other: _Side, shares: Array) -> bool:
    chords = np.linalg.norm(one.normals(shares) - other.normals(shares), axis=1)
    return bool((chords > CHORD).any())


def _parameters(one: _Side, other: _Side) -> Array:
    """Return u and v on both faces at points (k, 4) along their edge."""
    shares = np.linspace(0.0, 1.0, max(one.points, other.points))
    return np.concatenate([one.uv(shares), other.uv(shares)], axis=1)
