"""Samples of a part that Open CASCADE made, compared with what it says of them."""

# pyright: reportMissingImports=false

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")


@pytest.fixture(scope="module")
def drilled(tmp_path_factory):
    """Return a box with a round hole and a round edge, as a shape and as a part."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.BRepTools import BRepTools
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    box = BRepPrimAPI_MakeBox(4.0, 3.0, 2.0).Shape()
    fillet = BRepFilletAPI_MakeFillet(box)
    fillet.Add(0.3, TopoDS.Edge(TopExp_Explorer(box, TopAbs_EDGE).Current()))
    axis = gp_Ax2(gp_Pnt(2.0, 1.5, -1.0), gp_Dir(0.0, 0.0, 1.0))
    hole = BRepPrimAPI_MakeCylinder(axis, 0.8, 4.0).Shape()
    shape = BRepAlgoAPI_Cut(fillet.Shape(), hole).Shape()
    path = tmp_path_factory.mktemp("cad") / "drilled.brep"
    BRepTools.Write_s(shape, str(path))
    return shape, gm.read_cad(path)


def test_samples_lie_on_the_solid_and_point_out_of_it(drilled):
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_IN, TopAbs_OUT

    shape, part = drilled
    samples = gm.sample(part, 120)
    assert (len(samples), samples.report.empty_faces, part.oriented) == (120, 0, True)
    classifier = BRepClass3d_SolidClassifier(shape)
    for point, normal in zip(samples.points, samples.normals, strict=True):
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point.tolist())).Vertex()
        assert BRepExtrema_DistShapeShape(vertex, shape).Value() < 1e-9
        for side, state in ((1e-4, TopAbs_OUT), (-1e-4, TopAbs_IN)):
            classifier.Perform(gp_Pnt(*(point + side * normal).tolist()), 1e-9)
            assert classifier.State() == state
    assert samples.weights().sum() == pytest.approx(part.area, rel=1e-6)


def test_command_line(drilled, tmp_path, monkeypatch, capsys):
    from gaussmap.runtime.cli import main
    from OCP.BRepTools import BRepTools

    monkeypatch.chdir(tmp_path)
    BRepTools.Write_s(drilled[0], "part.brep")
    assert main(["sample", "part.brep", "--count", "50", "-o", "part.ply"]) == 0
    samples = gm.read_samples("part.ply")
    assert len(samples) == 50
    assert np.isfinite(samples.points).all()
    capsys.readouterr()
    assert main(["faces", "part.brep"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(drilled[1])
