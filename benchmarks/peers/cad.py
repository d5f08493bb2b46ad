"""Meshes that follow curvature, with the exact normals of their nodes: Gmsh and Open CASCADE.

The torus is one of their primitives, and the boss is a solid of revolution; the other surfaces are
given to them as B-splines of a 61 × 61 net.
"""

# Only `make bench-peers` installs these packages.
# pyright: reportMissingImports=false

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from .forms import Array, ClosedForm, Torus
from .peer import Points, Work, tuned
from .splines import NET, net
from .untuned import Boss

Mesher = Callable[[float], Points]

MULTIPLICITIES = [4, *[1] * (NET - 4), 4]
# Large enough that the angle decides; without a bound Open CASCADE leaves out full turns.
LINEAR_DEFLECTION = 0.1


def gmsh_by_curvature(form: ClosedForm, count: int) -> Work:
    """Prepare a model, and the number of elements per full turn that gives `count` nodes."""
    meshed = gmsh_mesher(form)
    elements = tuned(meshed, 40.0, count, 2.0)
    return lambda: meshed(elements)


def gmsh_mesher(form: ClosedForm) -> Mesher:
    """Return a function: the mesh by Gmsh for a number of elements per full turn of the normal."""
    import gmsh

    if gmsh.isInitialized():
        gmsh.finalize()
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    tags = _gmsh_faces(gmsh.model.occ, form)
    gmsh.model.occ.synchronize()

    def meshed(elements: float) -> Points:
        gmsh.model.mesh.clear()
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", elements)
        gmsh.model.mesh.generate(2)
        parts = []
        for tag in tags:
            nodes, points, parameters = gmsh.model.mesh.getNodes(2, tag, includeBoundary=True)
            normals = np.reshape(gmsh.model.getNormal(tag, parameters), (-1, 3))
            parts.append((nodes, *outwards(form, np.reshape(points, (-1, 3)), normals)))
        nodes, points, normals = (np.concatenate(x) for x in zip(*parts, strict=True))
        once = np.unique(nodes, return_index=True)[1]  # faces share the nodes of their edges
        return points[once], normals[once]

    return meshed


def outwards(form: ClosedForm, points: Array, normals: Array) -> Points:
    """Return the points of a face, and its normals on the side that the closed form has."""
    theirs = form.evaluate(*form.parameters(points))[1]
    return points, normals * np.sign(np.einsum("nx,nx->n", theirs, normals).mean())


def _gmsh_faces(occ: Any, form: ClosedForm) -> list[int]:
    """Make the surface and return the tags of its faces."""
    if isinstance(form, Torus):
        solid = occ.addTorus(0.0, 0.0, 0.0, form.major, form.minor)
        return [int(occ.getSurfaceLoops(solid)[1][0][0])]
    if isinstance(form, Boss):
        ends, centres = boss_outline(form)
        points, middles = ([occ.addPoint(r, 0.0, z) for r, z in x] for x in (ends, centres))
        lines = [(1, occ.addLine(points[k], points[k + 1])) for k in (0, 2, 4)]
        arcs = [(1, occ.addCircleArc(points[k], middles[k // 2], points[k + 1])) for k in (1, 3)]
        made = occ.revolve([*lines, *arcs], *[0.0] * 5, 1.0, 2.0 * np.pi)
        made = occ.fragment([x for x in made if x[0] == 2], [])[0]  # neighbours share their edges
        return [tag for dimension, tag in made if dimension == 2]
    spline = net(form)
    points = [occ.addPoint(*x) for x in np.swapaxes(spline.controlpoints, 0, 1).reshape(-1, 3)]
    knots = [np.unique(x.knots) for x in spline.bases]
    tag = occ.addBSplineSurface(
        points, NET, degreeU=3, degreeV=3, knotsU=knots[0], knotsV=knots[1],
        multiplicitiesU=MULTIPLICITIES, multiplicitiesV=MULTIPLICITIES,
    )  # fmt: skip
    return [tag]


def boss_outline(form: Boss) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Return radius and height of the ends of the parts of the meridian, and of its two centres."""
    radius, height, _ = form.meridian(np.array([0.0, *form.joints]))
    wall_end = form.fillet + form.wall
    centres = [(form.foot, form.fillet), (form.top, wall_end)]
    return list(zip(radius.tolist(), height.tolist(), strict=True)), centres


def opencascade_by_angle(form: ClosedForm, count: int) -> Work:
    """Prepare a face and the angular deflection that gives `count` nodes."""
    meshed = opencascade_mesher(form, opencascade_shape(form))
    angle = tuned(meshed, 0.2, count, -2.0)
    return lambda: meshed(angle)


def opencascade_mesher(form: ClosedForm, shape: Any) -> Mesher:
    """Return a function: the mesh of a shape for an angular deflection in radians."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepLib import BRepLib_ToolTriangulatedShape
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools
    from OCP.TopLoc import TopLoc_Location

    def meshed(angle: float) -> Points:
        BRepTools.Clean_s(shape)
        BRepMesh_IncrementalMesh(shape, LINEAR_DEFLECTION, False, angle, True)
        parts = []
        for face in opencascade_faces(shape):
            mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
            BRepLib_ToolTriangulatedShape.ComputeNormals_s(face, mesh)
            numbers = range(1, mesh.NbNodes() + 1)
            points = np.array([(p.X(), p.Y(), p.Z()) for p in map(mesh.Node, numbers)])
            normals = np.array([(n.X(), n.Y(), n.Z()) for n in map(mesh.Normal, numbers)])
            parts.append(outwards(form, points, normals))
        points, normals = (np.concatenate(x) for x in zip(*parts, strict=True))
        # Nodes on seams and edges occur twice.
        once = np.unique(points.round(9), axis=0, return_index=True)[1]
        return points[once], normals[once]

    return meshed


def opencascade_faces(shape: Any) -> Iterator[Any]:
    """Yield the faces of a shape."""
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    faces = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    while faces.More():
        yield TopoDS.Face(faces.Current())
        faces.Next()


def opencascade_shape(form: ClosedForm) -> Any:
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    if not isinstance(form, Boss):
        return BRepBuilderAPI_MakeFace(_opencascade_surface(form), 1e-7).Face()
    ends, centres = ([gp_Pnt(r, 0.0, z) for r, z in x] for x in boss_outline(form))
    wire = BRepBuilderAPI_MakeWire()
    for k in range(5):
        curve = ()
        if k in (1, 3):
            across = gp_Dir(0.0, 1.0 if k == 1 else -1.0, 0.0)
            curve = (gp_Circ(gp_Ax2(centres[k // 2], across), (form.fillet, form.edge)[k // 2]),)
        wire.Add(BRepBuilderAPI_MakeEdge(*curve, ends[k], ends[k + 1]).Edge())
    axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
    return BRepPrimAPI_MakeRevol(wire.Wire(), axis).Shape()


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
