"""Samples of parts that Open CASCADE made, compared with what it says of them."""

# pyright: reportMissingImports=false

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.damaged_step import prepared
from gaussmap.tools.cad.faces import own_parameters
from gaussmap.tools.cad.opencascade.parts import part_record
from gaussmap.tools.cad.opencascade.shapes import parts_of
from gaussmap.tools.cad.part import part_of
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepClass3d import BRepClass3d_SolidClassifier
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Pnt2d, gp_Vec
from OCP.IntTools import IntTools_FClass2d
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum, TopAbs_State
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

from .conftest import written

IN, OUT = TopAbs_State.TopAbs_IN, TopAbs_State.TopAbs_OUT


def hole(*direction):
    axes = gp_Ax2(gp_Pnt(2.0, 1.5, -1.0), gp_Dir(*direction))
    return BRepPrimAPI_MakeCylinder(axes, 0.8, 6.0).Shape()


def box():
    """Return a box with a round edge and a round hole."""
    shape = BRepPrimAPI_MakeBox(4.0, 3.0, 2.0).Shape()
    fillet = BRepFilletAPI_MakeFillet(shape)
    fillet.Add(0.3, TopoDS.Edge(next(parts_of(shape, TopAbs_ShapeEnum.TopAbs_EDGE))))
    return BRepAlgoAPI_Cut(fillet.Shape(), hole(0.0, 0.0, 1.0)).Shape()


def sphere():
    """Return a sphere with a slanted hole: its borders are no simple curves."""
    ball = BRepPrimAPI_MakeSphere(gp_Pnt(2.2, 1.8, 1.0), 1.9).Shape()
    return BRepAlgoAPI_Cut(ball, hole(0.2, 0.1, 1.0)).Shape()


@pytest.fixture(scope="module", params=[box, sphere], ids=["box", "sphere"])
def made(request, tmp_path_factory):
    """Return a shape, its faces without their orientation, and the part that is read."""
    shape = request.param()
    folder = tmp_path_factory.mktemp("cad")
    path = written(shape, folder / "part.brep")
    part = part_of(part_record(prepared(path, folder), "part", None))
    faces = parts_of(shape, TopAbs_ShapeEnum.TopAbs_FACE)
    forward = TopAbs_Orientation.TopAbs_FORWARD
    return shape, [TopoDS.Face(x.Oriented(forward)) for x in faces], part


def xyz(p):
    return p.X(), p.Y(), p.Z()


def test_samples_lie_on_their_own_faces(made):
    _, faces, part = made
    samples = gm.sample(part, 150)
    assert (len(samples), samples.report.empty_faces) == (150, 0)
    least = 1e-9 * float(np.linalg.norm(np.ptp(samples.points, axis=0)))
    point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
    assert samples.face_index is not None
    for k, sampled, normal, uv in zip(
        samples.face_index, samples.points, samples.normals, samples.uv, strict=True
    ):
        face = part.faces[k]
        own = own_parameters(face.surface, uv[None], is_reversed=face.reversed)[0].tolist()
        BRepAdaptor_Surface(faces[k], False).D1(*own, point, along_u, along_v)
        normal_there = np.cross(xyz(along_u), xyz(along_v)) * (-1.0 if face.reversed else 1.0)
        normal_there /= np.linalg.norm(normal_there)
        assert np.linalg.norm(normal_there - normal) <= 1e-9
        assert np.linalg.norm(xyz(point) - sampled) <= least
        assert IntTools_FClass2d(faces[k], 1e-12).Perform(gp_Pnt2d(*own)) == IN
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*sampled.tolist())).Vertex()
        assert BRepExtrema_DistShapeShape(vertex, faces[k]).Value() <= least
    assert samples.weights().sum() == pytest.approx(part.area, rel=1e-6)


def test_normals_point_out_of_the_solid(made):
    shape, _, part = made
    samples = gm.sample(part, 40)
    assert part.oriented
    classifier = BRepClass3d_SolidClassifier(shape)
    for point, normal in zip(samples.points, samples.normals, strict=True):
        for side, state in ((5e-7, OUT), (-5e-7, IN)):  # some are as near to edges as that
            classifier.Perform(gp_Pnt(*(point + side * normal).tolist()), 1e-9)
            assert classifier.State() == state


def places_on(face, step: float) -> np.ndarray:
    """Return places (k, 3) inside of a face, several in each triangle of its mesh."""
    BRepMesh_IncrementalMesh(face, step, False, 0.3, False)
    mesh = BRep_Tool.Triangulation_s(face, TopLoc_Location())
    nodes = (mesh.UVNode(k) for k in range(1, mesh.NbNodes() + 1))
    uv = np.array([(p.X(), p.Y()) for p in nodes])
    corners = np.array([mesh.Triangle(k).Get() for k in range(1, mesh.NbTriangles() + 1)]) - 1
    shares = np.random.default_rng(5).dirichlet([0.7, 0.7, 0.7], max(2, 1000 // len(corners)))
    uv = np.concatenate([uv, np.einsum("sk,tkc->tsc", shares, uv[corners]).reshape(-1, 2)])
    classifier, surface = IntTools_FClass2d(face, 1e-9), BRepAdaptor_Surface(face, False)
    inside = [x for x in uv.tolist() if classifier.Perform(gp_Pnt2d(*x)) != OUT]
    return np.array([xyz(surface.Value(*x)) for x in inside])


@pytest.mark.parametrize("asked", [0.5, 0.2])
def test_coverage_is_that_of_places_of_open_cascade(made, asked):
    _, faces, part = made
    samples = gm.sample(part, coverage=asked)
    places = np.concatenate([places_on(x, 0.05) for x in faces])
    gaps = np.linalg.norm(places[:, None] - samples.points, axis=2).min(axis=1)
    said = samples.report.coverage
    assert said is not None
    assert 0.7 * asked < gaps.max() <= said <= asked
