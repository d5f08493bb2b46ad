"""Meshes that follow curvature, with the exact normals of their nodes: Gmsh and Open CASCADE.

The torus is their own; the other two surfaces are given to them as the B-spline of a 61 × 61 net.
"""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .forms import ClosedForm, Torus
from .peer import Points, Work, tuned
from .splines import NET, net

__all__ = [
    "gmsh_by_curvature",
    "gmsh_mesher",
    "opencascade_by_angle",
    "opencascade_face",
    "opencascade_mesher",
]

Mesher = Callable[[float], Points]

MULTIPLICITIES = [4, *[1] * (NET - 4), 4]
# Large enough that the angle decides; without any bound Open CASCADE leaves out whole turns.
LINEAR_DEFLECTION = 0.1


def gmsh_by_curvature(form: ClosedForm, count: int) -> Work:
    """Prepare a model and the number of elements per full turn of the normal that gives `count`."""
    meshed = gmsh_mesher(form)
    elements = tuned(meshed, 40.0, count, 2.0)
    return lambda: meshed(elements)


def gmsh_mesher(form: ClosedForm) -> Mesher:
    """Return what makes a mesh of so many elements per full turn the mesh of Gmsh's model."""
    import gmsh

    if gmsh.isInitialized():
        gmsh.finalize()
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    tag = _gmsh_face(gmsh.model.occ, form)
    gmsh.model.occ.synchronize()

    def meshed(elements: float) -> Points:
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", elements)
        gmsh.model.mesh.generate(2)
        _, points, parameters = gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)
        normals = gmsh.model.getNormal(tag, parameters)
        return np.reshape(points, (-1, 3)), np.reshape(normals, (-1, 3))

    return meshed


def _gmsh_face(occ: Any, form: ClosedForm) -> int:
    """Make the surface and return its tag."""
    if isinstance(form, Torus):
        solid = occ.addTorus(0.0, 0.0, 0.0, form.major, form.minor)
        return int(occ.getSurfaceLoops(solid)[1][0][0])
    spline = net(form)
    points = [occ.addPoint(*x) for x in np.swapaxes(spline.controlpoints, 0, 1).reshape(-1, 3)]
    knots = [np.unique(x.knots) for x in spline.bases]
    return occ.addBSplineSurface(
        points, NET, degreeU=3, degreeV=3, knotsU=knots[0], knotsV=knots[1],
        multiplicitiesU=MULTIPLICITIES, multiplicitiesV=MULTIPLICITIES,
    )  # fmt: skip


def opencascade_by_angle(form: ClosedForm, count: int) -> Work:
    """Prepare a face and the angular deflection that gives `count` nodes."""
    meshed = opencascade_mesher(opencascade_face(form))
    angle = tuned(meshed, 0.2, count, -2.0)
    return lambda: meshed(angle)


def opencascade_face(form: ClosedForm) -> Any:
    """Return the surface as a face of Open CASCADE."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace

    return BRepBuilderAPI_MakeFace(_opencascade_surface(form), 1e-7).Face()


def opencascade_mesher(face: Any) -> Mesher:
    """Return what makes a mesh of some angular deflection the mesh of a face."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepLib import BRepLib_ToolTriangulatedShape
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopLoc import TopLoc_Location

    def meshed(angle: float) -> Points:
        BRepTools.Clean_s(face)
        BRepMesh_IncrementalMesh(face, LINEAR_DEFLECTION, False, angle, True)
        mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
        BRepLib_ToolTriangulatedShape.ComputeNormals_s(face, mesh)
        numbers = range(1, mesh.NbNodes() + 1)
        points = [(p.X(), p.Y(), p.Z()) for p in map(mesh.Node, numbers)]
        normals = [(n.X(), n.Y(), n.Z()) for n in map(mesh.Normal, numbers)]
        return np.array(points), np.array(normals)

    return meshed


def _opencascade_surface(form: ClosedForm) -> Any:
    from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface, Geom_ToroidalSurface
    from OCP.gp import gp_Ax3, gp_Pnt

    def filled(array: Any, values: Any) -> Any:
        for place, value in enumerate(values, start=1):
            array.SetValue(place, value)
        return array

    if isinstance(form, Torus):
        return Geom_ToroidalSurface(gp_Ax3(), form.major, form.minor)
    spline = net(form)
    poles = Array2_gp_Pnt(1, NET, 1, NET)
    for i, j in np.ndindex(NET, NET):
        poles.SetValue(i + 1, j + 1, gp_Pnt(*spline.controlpoints[i, j].tolist()))
    size = len(MULTIPLICITIES)
    knots = [filled(Array1_double(1, size), np.unique(x.knots).tolist()) for x in spline.bases]
    multiplicities = filled(Array1_int(1, size), MULTIPLICITIES)
    return Geom_BSplineSurface(poles, *knots, multiplicities, multiplicities, 3, 3)
