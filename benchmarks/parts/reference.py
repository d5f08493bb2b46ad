"""What parts are judged by: many places on their faces, evaluated by Open CASCADE."""

# Only `make parts-quality` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..peers.cad import opencascade_faces
from ..peers.forms import Array
from ..peers.peer import Points

__all__ = ["Reference", "read_shape", "reference"]

# Of the triangles on which places are drawn: their distance from the faces, relative to the size
# of the part, and the angle in radians that they span.
NEAR, ANGLE = 1e-4, 0.1
PLACES, ON_A_FACE = 150_000, 200


@dataclass(frozen=True)
class Reference:
    """Places on a part in millimetres, their unit normals, and the areas that they stand for.

    The corners of triangles are among them, which reach the borders of all faces; they stand for
    no area.
    """

    points: Array
    normals: Array
    areas: Array
    diagonal: float


def reference(shape: Any, places: int = PLACES, seed: int = 7) -> Reference:
    """Return places that are uniform by area on each face, and corners of triangles."""
    faces = _triangulated(shape)
    areas = [_areas(points[triangles]) for _, _, points, triangles in faces]
    total, random, found = sum(x.sum() for x in areas), np.random.default_rng(seed), []
    for (face, uv, _, triangles), sizes in zip(faces, areas, strict=True):
        if not (area := sizes.sum()) > 0.0:
            continue
        number = max(round(places * area / total), ON_A_FACE)
        chosen = random.choice(len(sizes), number, p=sizes / area)
        drawn = (uv[triangles[chosen]] * random.dirichlet(np.ones(3), number)[..., None]).sum(1)
        weights = np.concatenate([np.full(number, area / number), np.zeros(len(uv))])
        found.append((*evaluated(face, np.concatenate([drawn, uv])), weights))
    points, normals, weights = (np.concatenate(x) for x in zip(*found, strict=True))
    regular = np.isfinite(normals).all(axis=1)
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    return Reference(points[regular], normals[regular], weights[regular], diagonal)


def evaluated(face: Any, uv: Array) -> Points:
    """Return points and unit normals of a face at parameters (N, 2); NaN where it has no normal."""
    from OCP.BRepGProp import BRepGProp_Face
    from OCP.gp import gp_Pnt, gp_Vec

    surface, point, normal, rows = BRepGProp_Face(face), gp_Pnt(), gp_Vec(), []
    for u, v in uv.tolist():
        surface.Normal(u, v, point, normal)
        rows.append((point.X(), point.Y(), point.Z(), normal.X(), normal.Y(), normal.Z()))
    both = np.array(rows)
    lengths = np.linalg.norm(both[:, 3:], axis=1, keepdims=True)
    regular = lengths > 1e-9 * lengths.max(initial=0.0)
    return both[:, :3], both[:, 3:] / np.where(regular, lengths, np.nan)


def read_shape(path: Path) -> Any:
    """Read a STEP, IGES or BREP file, in millimetres."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.IGESControl import IGESControl_Reader
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopoDS import TopoDS_Shape

    if path.suffix == ".brep":
        shape = TopoDS_Shape()
        BRepTools.Read_s(shape, str(path), BRep_Builder())
        return shape
    reader = (IGESControl_Reader if path.suffix == ".iges" else STEPControl_Reader)()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def _triangulated(shape: Any) -> list[tuple[Any, Array, Array, np.ndarray]]:
    """Return each face, parameters and points of its corners, and its triangles."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopLoc import TopLoc_Location

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    distance = NEAR * box.CornerMin().Distance(box.CornerMax())
    BRepMesh_IncrementalMesh(shape, distance, False, ANGLE, False)
    found = []
    for face in opencascade_faces(shape):
        mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
        places = map(mesh.UVNode, range(1, mesh.NbNodes() + 1))
        uv = np.array([(x.X(), x.Y()) for x in places])
        corners = map(mesh.Triangle, range(1, mesh.NbTriangles() + 1))
        triangles = np.array([[x.Value(k) - 1 for k in (1, 2, 3)] for x in corners])
        found.append((face, uv, evaluated(face, uv)[0], triangles))
    return found


def _areas(corners: Array) -> Array:
    """Return the areas of triangles (N, 3, 3)."""
    sides = corners[:, 1:] - corners[:, :1]
    return np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
