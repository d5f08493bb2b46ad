"""Files to parts: trims, units, orientation, names, damage, sharp edges."""

# pyright: reportMissingImports=false

import itertools
import re

import gaussmap as gm
import numpy as np
import pytest
from scipy.special import ellipeinc, ellipkinc

pytest.importorskip("OCP")

from gaussmap.tools.cad.faces import face_surface
from gaussmap.tools.cad.inspection import UnusableError
from gaussmap.tools.cad.opencascade.shapes import sequence
from gaussmap.tools.cad.part import part_of
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_GTransform
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Dir, gp_GTrsf, gp_Pln, gp_Pnt, gp_Trsf, gp_Vec, gp_Vec2d
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from ....refusals import refused
from . import shapes
from .shapes import ball, box, compound, cut, cylinder, faces_of

SIZES, MIDDLE = (30.0, 20.0, 10.0), (15.0, 10.0, 5.0)


def points_of(face, uv):
    """Return points of a face that is read; the direction of its normals does not matter."""
    return face_surface(face.geometry, face.domain).evaluate(*uv.T)


def drilled_box():
    return cut(box(*SIZES), cylinder(4.0, 12.0, (10.0, 10.0, -1.0)))


def outward(face, centre) -> bool:
    """Return whether the normal of a plane face points away from a point."""
    o, x, y, _ = face.geometry.numbers.reshape(4, 3)
    uv = np.concatenate(face.loops).mean(axis=0)
    normal = np.cross(x, y) * (-1.0 if face.reversed else 1.0)
    return float((o + uv[0] * x + uv[1] * y - centre) @ normal) > 0.0


# --- trims ----------------------------------------------------------------------------------------


def ellipsoid(a, b, c):
    """Return an ellipsoid whose half axes are a > b > c, as one NURBS face."""
    stretched = gp_GTrsf()
    for k, length in enumerate((a, b, c), 1):
        stretched.SetValue(k, k, length)
    return BRepBuilderAPI_GTransform(ball(1.0), stretched, True).Shape()


def area_of_ellipsoid(a, b, c):
    phi, k = np.arccos(c / a), (a * a * (b * b - c * c)) / (b * b * (a * a - c * c))
    both = ellipeinc(phi, k) * np.sin(phi) ** 2 + ellipkinc(phi, k) * np.cos(phi) ** 2
    return 2 * np.pi * (c * c + a * b / np.sin(phi) * both)


@pytest.mark.parametrize(
    ("shape", "area", "volume", "rel"),
    [
        (drilled_box, 2200.0 + 48.0 * np.pi, 6000.0 - 160.0 * np.pi, 1e-12),
        (lambda: ellipsoid(3.0, 2.0, 1.0), area_of_ellipsoid(3.0, 2.0, 1.0), 8 * np.pi, 1e-6),
        (lambda: shapes.as_nurbs(cylinder(1.0, 2.0)), 6 * np.pi, 2 * np.pi, 1e-6),
        (lambda: shapes.as_nurbs(shapes.torus(2.0, 0.7)), 5.6 * np.pi**2, 1.96 * np.pi**2, 1e-6),
    ],
)
def test_areas_and_volumes_are_those_of_closed_forms(shape, area, volume, rel, write, read):
    part = part_of(read(write(shape())))
    assert part.area == pytest.approx(area, rel=rel)
    assert part.volume == pytest.approx(volume, rel=1e-6)
    assert gm.sample(part, 50).weights().sum() == pytest.approx(area, rel=1e-6)


# --- units ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("code", "unit", "length"), [("MM", "mm", 1.0), ("INCH", "in", 25.4),
                                                      ("M", "m", 1000.0)])  # fmt: skip
def test_boxes_have_sides_in_the_unit_of_the_file(code, unit, length, write, read):
    path = write(box(*SIZES), unit=code)
    part = read(path)
    assert (part.unit, part.metres) == (unit, pytest.approx(length / 1000.0))
    corners = np.concatenate([points_of(x, x.loops[0]) for x in part.faces])
    sides = np.ptp(corners, axis=0) * length
    np.testing.assert_allclose(sides, (30.0, 20.0, 10.0), rtol=1e-11)
    assert sum(x.area for x in part.faces) == pytest.approx(2200.0 / length**2)
    again = read(path, unit="cm")
    assert again.unit == "cm"
    corners = np.concatenate([points_of(x, x.loops[0]) for x in again.faces])
    np.testing.assert_allclose(np.ptp(corners, axis=0), (3.0, 2.0, 1.0), rtol=1e-11)


# --- orientation ----------------------------------------------------------------------------------


def some_reversed(shape):
    """Return the faces of a shape, every other one reversed, with edges of their own."""
    found = []
    for k, face in enumerate(faces_of(shape)):
        bounds = BRepTools.UVBounds_s(face)
        made = shapes.face(BRep_Tool.Surface_s(face), *bounds, 1e-7)
        found.append(made.Reversed() if k % 2 else made)
    return found


HOLLOW = box(4.0, 4.0, 4.0, at=(10.0, 5.0, 2.0))
LOOSE, INSIDE = some_reversed(box(*SIZES)), some_reversed(HOLLOW)


@pytest.mark.parametrize(
    ("shape", "is_outward"),
    [(compound(*LOOSE), 6 * [True]), (box(*SIZES).Reversed(), 6 * [True]),
     (compound(*LOOSE, *INSIDE), 6 * [True] + 6 * [False])],
    ids=["loose faces are sewn", "inside out", "a hollow has normals into itself"],
)  # fmt: skip
def test_normals_point_out_of_solids(shape, is_outward, write, read):
    part = read(write(shape, "part.brep"))
    assert part.oriented
    assert len(part.solid_names) == len(is_outward) // 6
    assert [x.solid_index for x in part.faces] == [k // 6 for k in range(len(is_outward))]
    assert [outward(x, (12.0, 7.0, 4.0)) for x in part.faces] == is_outward


def test_normals_of_an_open_shell_are_those_of_one_side(write, read):
    part = read(write(compound(*LOOSE[:5]), "open.brep"))
    assert not part.oriented
    assert {x.solid_index for x in part.faces} == {-1}
    assert len({outward(x, MIDDLE) for x in part.faces}) == 1


# --- assemblies -----------------------------------------------------------------------------------


def labelled(tool, shape, name):
    label = tool.AddShape(shape, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    return label


def test_assemblies_have_names_colours_and_placements(tmp_path, read, capfd):
    document = TDocStd_Document(TCollection_ExtendedString("test"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    frame, pin_shape = tool.NewShape(), box(2.0, 2.0, 8.0)
    TDataStd_Name.Set_s(frame, TCollection_ExtendedString("frame"))
    pin = labelled(tool, pin_shape, "pin")
    red, blue = ((0.8, 0.5, 0.25), (0.0, 0.0, 1.0))  # as the file has them
    rgb = Quantity_TypeOfColor.Quantity_TOC_sRGB
    colors.SetColor(pin, Quantity_Color(*red, rgb), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    top = tool.AddSubShape(pin, faces_of(pin_shape)[5])
    colors.SetColor(top, Quantity_Color(*blue, rgb), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
    for x in (0.0, 10.0):
        place = gp_Trsf()
        place.SetTranslation(gp_Vec(x, 0.0, 0.0))
        tool.AddComponent(frame, pin, TopLoc_Location(place))
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    writer.Transfer(document)
    writer.Write(str(tmp_path / "assembly.step"))
    capfd.readouterr()
    part = read(tmp_path / "assembly.step")
    assert part.solid_names == ["frame/pin", "frame/pin"]
    assert [x.solid_index for x in part.faces] == 6 * [0] + 6 * [1]
    assert sorted(x.color for x in part.faces) == 2 * [blue] + 10 * [red]
    lows = [
        min(points_of(x, x.loops[0])[:, 0].min() for x in part.faces if x.solid_index == k)
        for k in (0, 1)
    ]
    assert lows == pytest.approx([0.0, 10.0])


@pytest.fixture
def assembly(tmp_path, capfd):
    """Write an assembly in files of its own: two pins, and a frame with two more of them."""
    document = TDocStd_Document(TCollection_ExtendedString("test"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    top, frame = tool.NewShape(), tool.NewShape()
    pin, nut = (labelled(tool, box(*x), n) for x, n in (((1, 1, 8), "pin"), ((2, 2, 1), "nut")))
    for owner, owned, x in (
        (top, frame, 0.0), (top, pin, 10.0), (top, pin, 20.0),
        (frame, pin, 30.0), (frame, pin, 40.0), (frame, nut, 50.0),
    ):  # fmt: skip
        place = gp_Trsf()
        place.SetTranslation(gp_Vec(x, 0.0, 0.0))
        tool.AddComponent(owner, owned, TopLoc_Location(place))
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs, "of-")
    writer.Write(str(tmp_path / "top.step"))
    capfd.readouterr()
    return tmp_path / "top.step"


def test_assemblies_in_several_files_are_read(assembly, read):
    part = read(assembly)
    assert (len(part.faces), len(part.solid_names), part.warnings) == (30, 5, [])


@pytest.mark.parametrize("cut", [False, True])
def test_part_files_that_are_missing_or_cut_are_a_warning(cut, assembly, read):
    path = assembly.with_name("of-pin.stp")
    content = path.read_bytes()
    path.unlink()
    if cut:
        path.write_bytes(content[: len(content) // 2])
    part = read(assembly)
    assert (len(part.faces), len(part.solid_names)) == (6, 1)
    (said,) = part.warnings
    assert "1 of 2 part files cannot be read: 'of-pin.stp' " in said
    assert ("is truncated" if cut else "does not exist") in said
    assert said.endswith("; left out: 4 references to them.")


def test_the_top_file_alone_says_which_files_it_refers_to(assembly, read):
    for name in ("pin", "nut"):
        assembly.with_name(f"of-{name}.stp").unlink()
    said = refused("has no faces that can be read: 2 of 2", read, assembly, error=UnusableError)
    assert "'of-nut.stp' does not exist; 'of-pin.stp' does not exist" in said


# --- damage ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("found", "instead", "most"),
    [(r"(ADVANCED_FACE\('',\()(#\d+)", r"\g<1>#999999", 1),
     *((rf"\n#\d+ = {kind}\([^;]*;", "", 5) for kind in
       ("PLANE", "VERTEX_POINT", "EDGE_LOOP", "LINE"))],
)  # fmt: skip
def test_faces_that_lack_something_are_named_and_the_others_are_read(
    found, instead, most, write, read
):
    path = write(drilled_box())
    areas = [x.area for x in read(path).faces]
    path.write_text(re.sub(found, instead, path.read_text(), count=1))
    part = read(path)
    assert len(part.faces) == 7
    failed = [x for x in part.faces if x.reason]
    assert 1 <= len(failed) <= most
    assert all(re.search(r"refers to #\d+, which the file lacks$", x.reason) for x in failed)
    assert failed[0].name.startswith("#")
    assert not part.oriented
    good = [x.area for x in part.faces if not x.reason]
    assert all(min(abs(a - b) for b in areas) < 1e-9 for a in good)


@pytest.mark.parametrize("number", ["nan", "1.E+400", "'text'"])
def test_numbers_that_are_none_cost_only_their_faces(number, write, read):
    path = write(box(*SIZES))
    text = path.read_text()
    vertex = re.search(r"VERTEX_POINT\('',(#\d+)\)", text)
    point = rf"({vertex[1]} = CARTESIAN_POINT\('',\()[^,]*,"
    path.write_text(re.sub(point, rf"\g<1>{number},", text))
    part = read(path)
    assert [bool(x.reason) for x in part.faces] == 3 * [False] + 3 * [True]
    path.write_text(re.sub(r"(CARTESIAN_POINT\('',\()[^,]*,", rf"\g<1>{number},", text))
    refused("", read, path, error=UnusableError)


@pytest.mark.parametrize("suffix", ["step", "iges", "brep"])
@pytest.mark.parametrize(("joined", "points"), [(1, 0), (3, 2)])
def test_files_without_faces_say_what_they_have(joined, points, suffix, write, read):
    ends = [gp_Pnt(float(k), 2.0 * k, k**2) for k in range(joined + 1)]
    edges = [shapes.edge(*x) for x in itertools.pairwise(ends)]
    alone = [shapes.vertex(9.0, 9.0, k) for k in range(points)]
    path = write(compound(*edges, *alone) if alone else edges[0], f"wires.{suffix}")
    held = "3 edges, 2 points" if points else "1 edge"
    refused(f"has no faces: {held}; a part needs", read, path, error=UnusableError)


@pytest.mark.parametrize("suffix", ["step", "iges", "brep"])
def test_files_that_end_too_early_are_refused(suffix, write, read):
    path = write(drilled_box(), f"part.{suffix}")
    assert len(read(path).faces) == 7
    content = path.read_bytes().rstrip()
    for length in (*(len(content) * k // 10 for k in range(1, 10)), len(content) - 20):
        path.write_bytes(content[:length])
        refused(r"is (truncated|damaged|empty)", read, path, error=UnusableError)


def test_faces_that_open_cascade_leaves_out_are_told(write, read):
    path = write(drilled_box())
    text = path.read_text()
    path.write_text(text.replace("CYLINDRICAL_SURFACE(", "MYSTERIOUS_SURFACE(", 1))
    assert read(path).warnings == [
        "1 of 7 faces are missing: Open CASCADE cannot make them; export the file again."
    ]
    path.write_text(re.sub(r"(SOLID_BREP\('',)#\d+", r"\g<1>#99999", text))
    refused("can make none of its 7 faces", read, path, error=UnusableError)


PLANE = gp_Pln(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))


@pytest.mark.parametrize(
    ("ends", "reason"),
    [
        ((), "it has no boundary, and its surface has no end"),
        ((0.0, 1e-6, 0.0, 1e-7), "its area is zero"),
    ],
)
def test_planes_without_boundary_and_faces_of_no_area_fail(ends, reason, write, read):
    face = shapes.face(PLANE, *ends)
    part = read(write(compound(box(*SIZES), face), "part.brep"))
    assert [x.reason for x in part.faces if x.reason] == [reason]
    assert [x.geometry.kind for x in part.faces] == 6 * ["plane"] + ["unknown"]


@pytest.mark.parametrize(
    ("shift", "width"), [(0.0, 2.0), (1e-4, 2.0), (5e-3, 2.0), (9e-4, 1e-3), (9e-4, 1e-4)]
)
def test_edges_that_do_not_meet_are_told(shift, width, write, read):
    """Slivers may be narrower than what is between their edges, as far as these allow it."""
    face = shapes.face(PLANE, 0.0, 1.0, 0.0, width)
    edge = shapes.edges_of(face)[0]
    curve = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0).Translated(gp_Vec2d(shift, shift))
    BRep_Builder().UpdateEdge(edge, curve, face, 2.0 * shift + 1e-7)
    part = read(write(face, "part.brep"), unit="in")
    told = f"edges of 1 face are up to {np.sqrt(2.0) * shift / 25.4:.2g} in apart"
    assert [told in x for x in part.warnings] == [True] * (shift > 5e-4)
    (known,) = part.faces
    assert known.reason == ""
    beyond = np.abs(known.loops[0] - np.clip(known.loops[0], 0.0, [1.0, width]))
    assert beyond.max() <= shift * (1.0 + 1e-12)


def test_shapes_that_open_cascade_calls_invalid_are_told(write, read):
    corners = [gp_Pnt(*x, 0.0) for x in ((0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0))]
    crossed = shapes.wire(*(shapes.edge(*x) for x in itertools.pairwise([*corners, corners[0]])))
    part = read(write(compound(box(*SIZES), shapes.face(PLANE, crossed)), "part.brep"))
    assert part.warnings[0].startswith("Open CASCADE calls 1 face of it (6) invalid")


# --- edges ----------------------------------------------------------------------------------------


def test_edges_are_the_same_points_on_both_faces(write, read):
    part = read(write(drilled_box()), unit="in")
    assert len([x for x in part.edges if len(set(x.faces)) == 2]) == 14
    assert len(part.edges) == 15  # and a seam
    for edge in part.edges:
        first, second = (part.faces[k] for k in edge.faces)
        one = points_of(first, edge.parameters[:, :2])
        other = points_of(second, edge.parameters[:, 2:])
        np.testing.assert_allclose(one, other, atol=1e-6)
        ends = part.vertices[list(edge.vertices)]
        np.testing.assert_allclose(one[[0, -1]], ends, atol=1e-12)


def test_a_sphere_has_a_seam_and_two_poles(write, read):
    part = read(write(ball(5.0)))
    assert [x.faces for x in part.edges if not x.degenerate] == [(0, 0)]
    assert [x.faces for x in part.edges if x.degenerate] == [(0,), (0,)]
    assert np.abs(part.vertices[:, 2]).tolist() == [5.0, 5.0]
    assert len(part.faces[0].wires) == 1
    assert len(part.faces[0].wires[0]) == 4


def test_sequences_are_those_of_either_version():
    assert sequence("TDF.TDF_LabelSequence", "Sequence_TDF_Label").Length() == 0
