"""Samples on sharp edges against what Open CASCADE says of both faces."""

# pyright: reportMissingImports=false, reportOptionalSubscript=false, reportOptionalOperand=false
# pyright: reportArgumentType=false, reportOptionalMemberAccess=false

import gaussmap as gm
import numpy as np
import pytest

pytest.importorskip("OCP")

from gaussmap.tools.cad.edges import between_two, edges_of, sides_at
from gaussmap.tools.cad.faces import own_parameters
from gaussmap.tools.cad.opencascade.shapes import parts_of
from gaussmap.tools.cad.part import part_of
from gaussmap.tools.cad.results import space_of
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex, BRepBuilderAPI_NurbsConvert
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeSphere,
)
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS

from .conftest import compound

FACE, EDGE = TopAbs_ShapeEnum.TopAbs_FACE, TopAbs_ShapeEnum.TopAbs_EDGE


def box():
    return BRepPrimAPI_MakeBox(3.0, 2.0, 1.0).Shape()


def rounded(most=None):
    """Return a box whose first edges are rounded."""
    whole = box()
    fillet, seen = BRepFilletAPI_MakeFillet(whole), []
    for edge in parts_of(whole, EDGE):
        if not any(edge.IsSame(x) for x in seen):
            seen.append(edge)
    for edge in seen[:most]:
        fillet.Add(0.2, TopoDS.Edge(edge))
    return fillet.Shape()


def cut_ball():
    """Return a ball from which a cylinder off its axis is cut: curves within a tolerance."""
    axis = gp_Ax2(gp_Pnt(0.7, 0.2, -5.0), gp_Dir(0.0, 0.1, 1.0))
    ball = BRepPrimAPI_MakeSphere(2.0).Shape()
    return BRepAlgoAPI_Cut(ball, BRepPrimAPI_MakeCylinder(axis, 0.8, 10.0).Shape()).Shape()


def cone_and_cylinder():
    axis = gp_Ax2(gp_Pnt(-3.0, 0.0, 1.0), gp_Dir(1.0, 0.0, 0.0))
    cone = BRepPrimAPI_MakeCone(1.5, 0.0, 4.0).Shape()
    return BRepAlgoAPI_Fuse(cone, BRepPrimAPI_MakeCylinder(axis, 0.4, 6.0).Shape()).Shape()


def eighth():
    """Return an eighth of a ball, with a corner at its pole."""
    return BRepPrimAPI_MakeSphere(gp_Pnt(1.0, 2.0, 3.0), 1.0, 0.0, np.pi / 2, np.pi / 2).Shape()


# The numbers of sharp edges: seams cut closed curves into two.
SHAPES = {
    "box": (box, 12),
    "cylinder": (lambda: BRepPrimAPI_MakeCylinder(1.0, 2.0).Shape(), 2),
    "cone": (lambda: BRepPrimAPI_MakeCone(1.0, 0.0, 2.0).Shape(), 1),
    "one edge rounded": (lambda: rounded(1), 13),
    "all edges rounded": (rounded, 0),
    "cut ball": (cut_ball, 4),
    "as NURBS": (lambda: BRepBuilderAPI_NurbsConvert(cut_ball(), True).Shape(), 4),
    "cone and cylinder": (cone_and_cylinder, 6),
    "eighth": (eighth, 6),
}
# Curves of intersection that Open CASCADE computed are borders within its default tolerance.
COMPUTED = {"cut ball": 1e-7, "as NURBS": 1e-7, "cone and cylinder": 1e-7}


def checked(samples, part, shape, tolerance):
    """Compare samples on edges with both of their faces, whose borders have this tolerance."""
    faces = [TopoDS.Face(x) for x in parts_of(shape, FACE)]
    size = np.linalg.norm(np.ptp(samples.points, axis=0))
    edge = samples[samples.kind == "edge"]
    sides = (
        (edge.face_index, edge.uv, edge.normals),
        (edge.other_face_index, edge.other_uv, edge.other_normals),
    )
    for indices, uv, normals in sides:
        assert np.isfinite(normals).all()
        for k, (index, place, normal) in enumerate(zip(indices, uv, normals, strict=True)):
            face, known = faces[index], part.faces[index]
            (own,) = own_parameters(known.surface, place[None], is_reversed=known.reversed)
            point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
            BRepAdaptor_Surface(face, False).D1(*own.tolist(), point, along_u, along_v)
            found = np.array([point.X(), point.Y(), point.Z()])
            assert np.linalg.norm(found - edge.points[k]) <= 1e-9 * size
            cross = along_u.Crossed(along_v)
            if face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED:
                cross.Reverse()
            truth = np.array([cross.X(), cross.Y(), cross.Z()]) / cross.Magnitude()
            assert np.linalg.norm(truth - normal) <= 1e-9
            vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*edge.points[k].tolist())).Vertex()
            assert BRepExtrema_DistShapeShape(vertex, face).Value() <= 1e-9 * size + tolerance


def sharp_edges(part):
    """Return the edges at which the normals of their faces differ somewhere."""
    edges = edges_of(space_of(part, None))
    found = []
    for k in range(len(edges)):
        places = np.linspace(0.0, np.diff(edges.starts)[k] - 1.0, 33)
        owner = np.full(len(places), k)
        sides = sides_at(edges.space, edges.pieces[owner], edges.at(owner, places))
        found += [k] * bool(sides.sharp.any())
    return found


@pytest.mark.parametrize("name", SHAPES)
def test_samples_lie_on_both_faces(name, write, read):
    make, count = SHAPES[name]
    shape = make()
    part = part_of(read(write(shape, "part.brep")))
    samples = gm.sample(part, 40, edges=True)
    edge = samples[samples.kind == "edge"]
    pairs = set(zip(edge.face_index, edge.other_face_index, strict=True))
    sharp = sharp_edges(part)
    assert len(sharp) == count
    assert pairs == {tuple(between_two(part)[0][k]) for k in sharp}
    assert (samples.report.edge_samples > 0) == (count > 0)
    checked(samples, part, shape, COMPUTED.get(name, 0.0))


@pytest.mark.parametrize("name", SHAPES)
def test_wires_close_and_lie_on_their_faces(name, write, read):
    """Each edge has the same points on all of its faces, and loops are those of wires."""
    part = part_of(read(write(SHAPES[name][0](), "part.brep")))
    arrays, size = part.arrays, np.linalg.norm(np.ptp(part.bounds, axis=0))
    owner = np.repeat(np.arange(len(arrays["edge_vertices"])), np.diff(arrays["edge_side_starts"]))
    assert sorted(arrays["wire_sides"].tolist()) == list(range(len(owner)))  # each side once
    tolerance = max(COMPUTED.get(name, 0.0), 1e-9 * size)
    for face in part.faces:
        assert len(face.wires) == len(face.loops)
        for wire, loop in zip(face.wires, face.loops, strict=True):
            ends, area = [], 0.0
            for side, backwards in wire:
                first, last = arrays["side_point_starts"][side : side + 2]
                uv = arrays["side_points"][first:last, :2]
                points = uv[::-1] if backwards else uv
                nearest = np.linalg.norm(points[:, None] - loop, axis=2).min(axis=1)
                assert nearest[[0, -1]].max() <= 1e-9 * np.ptp(loop, axis=0).max()
                vertices = arrays["edge_vertices"][owner[side]]
                own = own_parameters(face.surface, uv[[0, -1]], is_reversed=face.reversed)
                low, high = np.array(face.surface.domain).T
                found = face.surface.jets(*np.clip(own, low, high).T.copy())[:, 0]
                assert np.abs(found - arrays["vertices"][vertices]).max() <= tolerance
                ends.append(vertices[::-1] if backwards else vertices)
                x, y = (points - loop[0]).T
                area += (x[:-1] * np.diff(y) - y[:-1] * np.diff(x)).sum() / 2.0
            assert all(x[1] == y[0] for x, y in zip(ends, [*ends[1:], ends[0]], strict=True))
            x, y = (loop - loop[0]).T
            wanted = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0
            assert area == pytest.approx(wanted, rel=0.05)  # the same way around
    degenerate = arrays["edge_vertices"][arrays["edge_degenerate"]]
    assert (degenerate[:, 0] == degenerate[:, 1]).all()


def test_units_scale_vertices_and_parameters(write, read):
    path = write(BRepPrimAPI_MakeCylinder(10.0, 20.0).Shape(), "part.brep")
    in_mm, in_cm = part_of(read(path)), part_of(read(path, "cm"))
    assert np.allclose(in_cm.arrays["vertices"], in_mm.arrays["vertices"] / 10.0, rtol=1e-15)
    for name in ("in_mm", "in_cm"):
        part, factor = (in_mm, 1.0) if name == "in_mm" else (in_cm, 10.0)
        points = part.arrays["side_points"]
        side = part.arrays["side_faces"]
        counts = np.diff(part.arrays["side_point_starts"])
        on_side = np.repeat(side, counts) == [x.kind for x in part.faces].index("cylinder")
        assert np.abs(points[on_side, 1]).max() * factor == pytest.approx(20.0, rel=1e-14)
        assert np.abs(points[on_side, 2]).max() == pytest.approx(2 * np.pi, rel=1e-14)


def test_loose_faces_are_sewn_and_borders_are_no_edges(write, read):
    faces = [x.Moved(x.Location()) for x in parts_of(box(), FACE)]
    part = part_of(read(write(compound(*faces[:5]), "open.brep")))
    assert len(sharp_edges(part)) == 8
    assert gm.sample(part, 40, edges=True).report.edge_samples > 8
    single = part_of(read(write(faces[0], "face.brep")))
    assert gm.sample(single, 10, edges=True).report.edge_samples == 0
