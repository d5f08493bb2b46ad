"""Shapes that Open CASCADE makes, and what it says of them."""

# pyright: reportMissingImports=false

import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.faces import own_parameters
from gaussmap.tools.cad.opencascade.shapes import parts_of
from OCP import BRepBuilderAPI, BRepPrimAPI
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IntTools import IntTools_FClass2d
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum, TopAbs_State
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound

ORIGIN, UP = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def axes(at=ORIGIN, direction=UP):
    return gp_Ax2(gp_Pnt(*at), gp_Dir(*direction))


def box(*sizes, at=ORIGIN):
    return BRepPrimAPI.BRepPrimAPI_MakeBox(gp_Pnt(*at), *sizes).Shape()


def cylinder(radius, height, at=ORIGIN, direction=UP):
    return BRepPrimAPI.BRepPrimAPI_MakeCylinder(axes(at, direction), radius, height).Shape()


def cone(radius=1.0, height=2.0, at=ORIGIN, top=0.0):
    return BRepPrimAPI.BRepPrimAPI_MakeCone(axes(at), radius, top, height).Shape()


def ball(radius=1.0, at=ORIGIN):
    return BRepPrimAPI.BRepPrimAPI_MakeSphere(gp_Pnt(*at), radius).Shape()


def eighth(at=ORIGIN):
    """Return an eighth of a ball, with a corner at its pole."""
    return BRepPrimAPI.BRepPrimAPI_MakeSphere(gp_Pnt(*at), 1.0, 0.0, np.pi / 2, np.pi / 2).Shape()


def torus(radius, tube):
    return BRepPrimAPI.BRepPrimAPI_MakeTorus(radius, tube).Shape()


def cut(shape, *tools):
    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool).Shape()
    return shape


def common(shape, *tools):
    for tool in tools:
        shape = BRepAlgoAPI_Common(shape, tool).Shape()
    return shape


def fused(shape, other):
    return BRepAlgoAPI_Fuse(shape, other).Shape()


def as_nurbs(shape):
    return BRepBuilderAPI.BRepBuilderAPI_NurbsConvert(shape, True).Shape()


def compound(*shapes):
    made, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(made)
    for shape in shapes:
        builder.Add(made, shape)
    return made


def vertex(*at):
    return BRepBuilderAPI.BRepBuilderAPI_MakeVertex(gp_Pnt(*at)).Vertex()


def edge(*given):
    return BRepBuilderAPI.BRepBuilderAPI_MakeEdge(*given).Edge()


def wire(*edges):
    return BRepBuilderAPI.BRepBuilderAPI_MakeWire(*edges).Wire()


def face(*given):
    return BRepBuilderAPI.BRepBuilderAPI_MakeFace(*given).Face()


def faces_of(shape):
    return [TopoDS.Face(x) for x in parts_of(shape, TopAbs_ShapeEnum.TopAbs_FACE)]


def edges_of(shape):
    return [TopoDS.Edge(x) for x in parts_of(shape, TopAbs_ShapeEnum.TopAbs_EDGE)]


def loose_faces(shape):
    """Return the faces of a shape, which share no edges in a compound."""
    return [x.Moved(x.Location()) for x in faces_of(shape)]


def rounded(shape, *radii, most=None):
    """Return a shape whose first edges are rounded."""
    fillet, seen = BRepFilletAPI_MakeFillet(shape), []
    for found in edges_of(shape):
        if not any(found.IsSame(x) for x in seen):
            seen.append(found)
    for chosen in seen[:most]:
        fillet.Add(*radii, chosen)
    return fillet.Shape()


def cut_ball():
    """Return a ball from which a cylinder off its axis is cut: curves within a tolerance."""
    return cut(ball(2.0), cylinder(0.8, 10.0, (0.7, 0.2, -5.0), (0.0, 0.1, 1.0)))


def pierced(shape):
    """Return a shape with a cylinder through it."""
    return fused(shape, cylinder(0.4, 6.0, (-3.0, 0.0, 1.0), (1.0, 0.0, 0.0)))


# Their Euler characteristics, two for each ball, less two for each handle, and their sharp edges:
# seams cut closed curves into two.
SOLIDS = {
    "box": (lambda: box(3.0, 2.0, 1.0), 2, 12),
    "cylinder": (lambda: cylinder(1.0, 2.0), 2, 2),
    "cone": (cone, 2, 1),
    "sphere": (lambda: ball(2.0), 2, 0),
    "torus": (lambda: torus(2.0, 0.6), 0, 0),
    "eighth": (lambda: eighth((1.0, 2.0, 3.0)), 2, 6),
    "one edge rounded": (lambda: rounded(box(3.0, 2.0, 1.0), 0.2, most=1), 2, 13),
    "all edges rounded": (lambda: rounded(box(3.0, 2.0, 1.0), 0.2), 2, 0),
    "drilled": (lambda: cut(box(3.0, 2.0, 1.0), cylinder(0.4, 3.0, (1.5, 1.0, -1.0))), 0, 14),
    "cut ball": (cut_ball, 0, 4),
    "as NURBS": (lambda: as_nurbs(cut_ball()), 0, 4),
    "cone and cylinder": (lambda: pierced(cone(1.5, 4.0)), 2, 6),
    "crossed cylinders": (lambda: pierced(cylinder(1.0, 2.0)), 2, 7),
    "two": (lambda: compound(box(3.0, 2.0, 1.0), cylinder(0.3, 1.0, (9.0, 0.0, 0.0))), 4, 14),
}


# --- what Open CASCADE says -----------------------------------------------------------------------


def xyz(p):
    return p.X(), p.Y(), p.Z()


def volume_of(shape) -> float:
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    return properties.Mass()


def forward(face):
    return TopoDS.Face(face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))


def states_of(face, uv, tolerance=1e-9, *, periodic=True) -> np.ndarray:
    """Return which parameters are inside of a face (1), on its border (0), and outside (-1)."""
    values = {TopAbs_State.TopAbs_IN: 1, TopAbs_State.TopAbs_OUT: -1}
    classifier = IntTools_FClass2d(forward(face), tolerance)
    found = (classifier.Perform(gp_Pnt2d(*x), periodic) for x in np.asarray(uv).tolist())
    return np.array([values.get(x, 0) for x in found])


def evaluated(face, uv) -> tuple[np.ndarray, ...]:
    """Return x, x_u, x_v, and x_u × x_v to the outer side."""
    surface, vectors = BRepAdaptor_Surface(face, False), (gp_Pnt(), gp_Vec(), gp_Vec())
    rows = []
    for u, v in np.asarray(uv).tolist():
        surface.D1(u, v, *vectors)
        rows.append([xyz(x) for x in vectors])
    x, x_u, x_v = np.array(rows).swapaxes(0, 1)
    sign = -1.0 if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED else 1.0
    return x, x_u, x_v, sign * np.cross(x_u, x_v)


def distance(face, point) -> float:
    return BRepExtrema_DistShapeShape(vertex(*point), face).Value()


def on_triangles(face, step: float, random, *, turn: float = 0.1, count: int = 400) -> np.ndarray:
    """Return parameters (k, 2) of the corners of the triangles of a face, and of places in them."""
    BRepMesh_IncrementalMesh(face, step, False, turn, False)
    mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
    nodes = np.array([(p.X(), p.Y()) for p in map(mesh.UVNode, range(1, mesh.NbNodes() + 1))])
    corners = np.array([mesh.Triangle(k).Get() for k in range(1, mesh.NbTriangles() + 1)]) - 1
    shares = random.dirichlet([0.7, 0.7, 0.7], max(2, count // len(corners)))
    inner = np.einsum("sk,tkc->tsc", shares, nodes[corners]).reshape(-1, 2)
    return np.concatenate([nodes, inner[states_of(face, inner) >= 0]])


def lie_on_faces(samples, part, shape, *, other="", rows=..., tolerance=0.0, inside=False) -> None:
    """Check samples, or the other sides of some on edges, against their faces.

    Borders of faces have a tolerance; samples that are `inside` are on none.
    """
    indices, uv, normals = (
        getattr(samples, f"{other}{name}")[rows] for name in ("face_index", "uv", "normals")
    )
    faces, points = faces_of(shape), samples.points[rows]
    least = 1e-9 * np.linalg.norm(np.ptp(samples.points, axis=0))
    for k in np.unique(indices):
        here, known = indices == k, part.faces[k]
        own = own_parameters(known.surface, uv[here], is_reversed=known.reversed)
        x, _, _, N = evaluated(faces[k], own)
        n = N / np.linalg.norm(N, axis=1, keepdims=True)
        assert np.linalg.norm(x - points[here], axis=1).max() <= least
        assert np.linalg.norm(n - normals[here], axis=1).max() <= 1e-9
        assert max(distance(faces[k], p) for p in points[here].tolist()) <= least + tolerance
        assert not inside or (states_of(faces[k], own, 1e-12) == 1).all()
